"""Geo-zones of a site: plans keep out of them, and checks say of each what it is and how near the path comes."""

import functools
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
import shapely

from planning.base.errors import InfeasibleError
from planning.base.findings import Severity
from planning.checks import check_plan
from planning.checks.zones import source_ages
from planning.insight.obstructions import obstructions_of
from planning.parameters import Constraints, GreedyParameters
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.file import is_planned_on, read_site, site_sha256, write_site
from planning.site.free_space import free_space, unchecked_space
from planning.site.zones.keep_out import at_time, near_zones, no_fly_volumes
from tests.planning.site.zones.zone_files import (
    aixm,
    aixm_ring,
    ed269,
    ed269_feature,
    ed269_volume,
    ed318,
    geojson,
    kml,
    lon_lat,
    openair,
    openair_ring,
    polygon,
    site,
    square,
    with_zones,
)

REQUEST = PlanRequest(n_views=6, constraints=Constraints(min_distance_m=5.0), greedy=GreedyParameters(400, False))

WAY = square(0.0, -25.0, 3.0)
"""In front of the south side, on the way of every flight from home that looks at it."""

ASIDE = square(30.0, -60.0, 10.0)

NIGHT = [{"permanent": "NO", "schedule": [{"day": ["ANY"], "startTime": "20:00Z", "endTime": "04:00Z"}]}]

NOON = datetime(2026, 11, 28, 12, tzinfo=UTC)


@functools.cache
def flight():
    """A plan of a site without zones."""
    return plan_flight(site(), REQUEST).plan


def zone_findings(content, plan=None, at=None, not_here=None, **permitted):
    """Findings about zones alone."""
    model = at_time(with_zones(content, not_here=not_here, **permitted), at, 600.0)
    findings = check_plan(flight() if plan is None else plan, model)
    return [finding for finding in findings if finding.code.startswith("zone")]


def one(findings, code="zone"):
    (found,) = (finding for finding in findings if finding.code == code)
    return found


def around(x0, y0, x1, y1, lower=0, upper=500):
    ring = square(0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.5 * (x1 - x0))
    return ed269(ed269_feature(ed269_volume(polygon(ring), lower, upper)))


@pytest.mark.long
def test_a_site_without_zones_says_that_nobody_looked():
    (note,) = source_ages(site(), NOON)
    assert note.severity is Severity.NOTE
    assert not [finding for finding in check_plan(flight(), site()) if finding.code.startswith("zone")]


FORMATS = {
    "ed269": lambda ring: ed269(ed269_feature(ed269_volume(polygon(ring)))),
    "ed318": lambda ring: ed318(polygon(ring)),
    "geojson": lambda ring: geojson(polygon(ring)),
    "kml": kml,
    "openair": lambda ring: openair(*openair_ring(ring)),
}


@pytest.mark.long
@pytest.mark.parametrize("name", FORMATS)
def test_each_format_says_what_the_path_enters_and_how_far_it_stays_away(name):
    low = min(point[1] for point in flight().sorties[0].path_enu_m)
    inside = one(zone_findings(FORMATS[name](square(0.0, 0.0, 90.0))))
    assert inside.severity is Severity.ERROR
    assert "School" in inside.message
    assert "sortie 1, leg 1" in inside.place
    aside = one(zone_findings(FORMATS[name](square(0.0, low - 40.0, 10.0))))
    assert aside.severity is Severity.NOTE
    assert aside.value == pytest.approx(30.0, abs=0.3)
    assert one(zone_findings(FORMATS[name](square(0.0, -400.0, 10.0)))).severity is Severity.OK
    assert not [f for f in zone_findings(FORMATS[name](square(0.0, -4000.0, 10.0))) if f.code == "zone"]


@pytest.mark.long
def test_zones_above_and_below_the_path_are_clear_by_their_heights():
    top = max(point[2] for point in flight().sorties[0].path_enu_m)
    above = one(zone_findings(around(-90, -90, 90, 90, lower=top + 12.0)))
    assert above.severity is Severity.NOTE
    assert above.value == pytest.approx(12.0, abs=1e-3)
    assert "site's ground" in above.message
    assert one(zone_findings(around(-90, -90, 90, 90, lower=top - 0.5))).severity is Severity.ERROR


def test_a_zone_counts_in_its_time_and_always_where_no_time_is_planned():
    content = ed269(ed269_feature(ed269_volume(polygon(square(0.0, 0.0, 90.0))), applicability=NIGHT))
    unplanned = one(zone_findings(content))
    assert unplanned.severity is Severity.ERROR
    assert "--at" in unplanned.message
    assert one(zone_findings(content, at=NOON)).severity is Severity.NOTE
    assert one(zone_findings(content, at=NOON + timedelta(hours=12))).severity is Severity.ERROR
    assert one(zone_findings(content, at=NOON + timedelta(hours=7, minutes=40))).severity is Severity.ERROR


def test_a_permission_opens_its_own_zone_and_names_its_reference():
    feature = ed269_feature(ed269_volume(polygon(square(0.0, 0.0, 90.0))))
    content = ed269(feature, {**feature, "identifier": "Z2"})
    found = {finding.place.partition(",")[0]: finding for finding in zone_findings(content, Z1="No. 4711")}
    assert found["Z1"].severity is Severity.NOTE
    assert "No. 4711" in found["Z1"].message
    assert found["Z2"].severity is Severity.ERROR


def test_a_zone_of_which_the_place_is_open_is_never_clear_unless_the_pilot_has_the_answer():
    lost = ed269(ed269_feature(ed269_volume({"type": "Ellipse"})))
    question = one(zone_findings(lost), "zone-question")
    assert question.severity is Severity.ERROR
    for words in ("School", "'zones.json'", "'type' cannot be read: it is 'Ellipse'", "ask Town", "--permit"):
        assert words in question.message
    told = {"Z1": "asked by phone"}
    for answered, words in (
        (zone_findings(lost, not_here=told), "it is not here according to 'asked by phone'"),
        (zone_findings(lost, **told), "the authorisation 'asked by phone' opens all of it"),
    ):
        assert not [f for f in answered if f.code == "zone-question"]
        assert one(answered).severity is Severity.NOTE
        assert words in one(answered).message


AWAY = square(0.0, -400.0, 10.0)
"""Well away from the path: only the lost corner may reach it."""


def spoilt():
    """Zones beside the path, each with one corner, outline or element lost, by name."""
    lines = openair_ring(AWAY)
    yield "openair-corner", openair(*lines[:2], "DP 47:0x:00 N 008:00:00 E", *lines[3:])
    far = openair(*openair_ring(square(0.0, -4000.0, 10.0)))
    yield "openair-type", openair(*lines).replace(b"AC P\n", b"") + far
    yield "geojson", geojson(polygon([*AWAY[:2], [8.0, "47.0"], *AWAY[3:]]))
    yield "ed318", ed318(polygon([*AWAY[:2], [8.0, 97.0], *AWAY[3:]]))
    yield "ed269", ed269(ed269_feature(ed269_volume(polygon([*AWAY[:2], [None, 47.0], *AWAY[3:]]))))
    yield "ed269-two-corners", ed269(ed269_feature(ed269_volume(polygon(AWAY[:2]))))
    yield "kml", kml(AWAY).replace(kml(AWAY).split(b"coordinates>")[1].split()[2], b"8,?")
    overlay = b"<GroundOverlay><name>Map</name></GroundOverlay>"
    yield "kml-overlay", kml(square(0.0, -4000.0, 10.0)).replace(b"</Document>", overlay + b"</Document>")
    yield (
        "kml-point",
        kml(AWAY)
        .replace(b"<Polygon><outerBoundaryIs><LinearRing>", b"<LineString>")
        .replace(b"</LinearRing></outerBoundaryIs></Polygon>", b"</LineString>"),
    )
    yield "aixm", aixm(aixm_ring(AWAY)).replace(b"GeodesicString>", b"ArcString>")


@pytest.mark.parametrize("name", [name for name, _ in spoilt()])
def test_a_zone_of_which_a_corner_is_lost_is_an_open_question_however_far_the_others_are(name):
    content = dict(spoilt())[name]
    question = one(zone_findings(content), "zone-question")
    assert question.severity is Severity.ERROR
    assert "'zones.json'" in question.message
    assert all(f.severity is not Severity.OK for f in zone_findings(content) if f.code == "zone")
    (near,) = (near for near in near_zones(with_zones(content)) if near.open_places)
    told = {near.local.zone.id: "M. Muster, 28 November"}
    for answered in (zone_findings(content, not_here=told), zone_findings(content, **told)):
        assert [f.severity for f in answered if f.code in ("zone", "zone-question")] == [Severity.NOTE]
        assert "'M. Muster, 28 November'" in one(answered).message


OVER = square(0.0, 0.0, 90.0)
"""Over all of the flight; a corner more may be lost."""


@pytest.mark.parametrize(
    "content",
    [
        ed269(ed269_feature(ed269_volume(polygon([*OVER[:4], [None, 47.0], OVER[4]])))),
        ed318(polygon([*OVER[:4], [8.0, 97.0], OVER[4]])),
        geojson({"type": "LineString", "coordinates": OVER[:2] + OVER[2:]}),
        geojson(polygon([OVER[0], OVER[2], OVER[1], OVER[3], OVER[0]])),
    ],
    ids=["lost corner", "impossible corner", "no width", "crossed outline"],
)
def test_the_answer_that_a_zone_is_not_here_leaves_closed_what_can_be_read_of_it_and_a_permission_opens_it(content):
    (near,) = near_zones(with_zones(content))
    told = {near.local.zone.id: "Town, by phone"}
    answered = with_zones(content, not_here=told)
    assert no_fly_volumes(answered) == no_fly_volumes(with_zones(content)) != ()
    entered = one(zone_findings(content, not_here=told))
    assert entered.severity is Severity.ERROR
    for words in ("the path enters it", "is not here according to 'Town, by phone'", "state the authorisation"):
        assert words in entered.message
    assert no_fly_volumes(with_zones(content, **told)) == ()
    inside = one(zone_findings(content, **told))
    assert inside.severity is Severity.NOTE
    assert "the path runs inside, by the authorisation 'Town, by phone'" in inside.message


@pytest.mark.parametrize("upper", ["4000 bananas", "?"])
def test_an_authorisation_says_what_stays_open_of_heights_and_times(upper):
    content = openair(*openair_ring(OVER), upper=upper)
    assert one(zone_findings(content)).severity is Severity.ERROR
    inside = one(zone_findings(content, School="No. 4711"))
    assert inside.severity is Severity.NOTE
    assert f"'{upper}'" in inside.message
    # Answers about places answer nothing about heights.
    assert one(zone_findings(content, not_here={"School": "Town"})).severity is Severity.ERROR


def test_corners_in_the_wrong_order_are_asked_about_where_the_path_may_lie_between_them():
    a, b, c, d, _ = square(0.0, 0.0, 90.0)
    crossed = geojson(polygon([a, c, b, d, a]))
    findings = zone_findings(crossed)
    assert {f.severity for f in findings if f.code in ("zone", "zone-question")} == {Severity.ERROR}
    a, b, c, d, _ = square(0.0, -400.0, 10.0)
    assert one(zone_findings(geojson(polygon([a, c, b, d, a])))).severity is Severity.OK


@pytest.mark.parametrize("upper", ["GND", "0", "-400ft AGL"])
def test_heights_that_leave_no_room_count_as_every_height(upper):
    found = one(zone_findings(openair(*openair_ring(square(0.0, 0.0, 90.0)), upper=upper)))
    assert found.severity is Severity.ERROR
    assert "every height counts" in found.message


def test_a_zone_that_ends_below_the_ground_asks_for_its_upper_limit():
    found = one(zone_findings(openair(*openair_ring(square(0.0, 0.0, 90.0)), upper="12ft AMSL")))
    assert found.severity is Severity.NOTE
    assert "upper limit" in found.message


def test_a_zone_far_above_is_away_by_its_height_in_metres():
    top = max(point[2] for point in flight().sorties[0].path_enu_m)
    found = one(zone_findings(around(-90, -90, 90, 90, lower=top + 4000.0, upper=9000)))
    assert (found.severity, found.value) == (Severity.OK, pytest.approx(4000.0, abs=1e-3))


def test_points_and_lines_some_kilometres_away_are_a_warning_that_names_the_distance():
    content = geojson({"type": "Point", "coordinates": lon_lat([(0.0, -5000.0)])[0]})
    question = one(zone_findings(content), "zone-question")
    assert question.severity is Severity.WARNING
    assert "inf" not in question.message
    for answered in (zone_findings(content, School="a label"), zone_findings(content, not_here={"School": "a label"})):
        assert not [f for f in answered if f.code == "zone-question"]


def test_files_that_changed_or_are_missing_ground_the_flight(tmp_path):
    content = FORMATS["ed269"](ASIDE)
    model = with_zones(content)
    write_site(tmp_path / "site.json", replace(model.site, building_mesh=None))
    for written, word in ((None, "no such file"), (content + b" ", "has changed")):
        if written is not None:
            (tmp_path / "zones.json").write_bytes(written)
        finding = one(check_plan(flight(), read_site(tmp_path / "site.json")), "zones-file")
        assert finding.severity is Severity.ERROR
        assert word in finding.message
    (tmp_path / "zones.json").write_bytes(content)
    again = read_site(tmp_path / "site.json")
    assert again.site.zones == model.site.zones
    assert one(check_plan(flight(), again), "zones-file").severity is Severity.OK
    assert one(check_plan(flight(), replace(again, zones=())), "zones-file").severity is Severity.ERROR


def test_a_file_of_another_place_asks_whether_it_is_the_right_one():
    assert one(zone_findings(around(200_000, 0, 200_100, 100)), "zones-far").severity is Severity.WARNING
    swapped = [[lat, lon] for lon, lat in square(0.0, 0.0, 90.0)]
    assert "exchanged" in one(zone_findings(FORMATS["ed269"](swapped)), "zones-far").message


def test_one_zone_of_a_file_with_latitude_and_longitude_exchanged_is_an_open_question_and_far_ones_are_not():
    good, swapped = ed269_volume(polygon(ASIDE)), ed269_volume(polygon([[lat, lon] for lon, lat in square(0, 0, 90)]))
    elsewhere = ed269_volume(polygon([[lat, lon] for lon, lat in square(9000.0, 0.0, 90.0)]))
    content = ed269(
        ed269_feature(good),
        ed269_feature(swapped, identifier="Z2"),
        ed269_feature(elsewhere, identifier="Z3"),
        ed269_feature({**swapped, "horizontalProjection": {"type": "Circle", "center": [47.0, 8.0], "radius": 90}},
                      identifier="Z4"),
    )  # fmt: skip
    asked = [f for f in zone_findings(content) if f.code == "zone-question"]
    assert [(f.place, f.severity) for f in asked] == [("Z2", Severity.ERROR), ("Z4", Severity.ERROR)]
    assert "here if its latitude and longitude are exchanged" in asked[0].message
    assert not [f for f in zone_findings(content, not_here={"Z2": "Town", "Z4": "Town"}) if f.code == "zone-question"]


def test_old_sources_and_those_that_ended_are_warnings():
    model = with_zones(FORMATS["ed318"](ASIDE))
    assert not list(source_ages(model, NOON))
    assert [f.severity for f in source_ages(model, NOON + timedelta(days=31))] == [Severity.WARNING]


@pytest.mark.long
def test_plans_keep_out_of_zones_and_those_of_another_time_do_not_count():
    content = ed269(
        ed269_feature(ed269_volume(polygon(square(-20.0, 10.0, 12.0)))),
        ed269_feature(ed269_volume(polygon(square(0.0, 0.0, 95.0))), identifier="Z2", applicability=NIGHT),
    )
    model = at_time(with_zones(content), NOON, 600.0)
    plan = plan_flight(model, REQUEST).plan
    zone = shapely.box(-32.0, -2.0, -8.0, 22.0)
    for sortie in plan.sorties:
        assert shapely.LineString(np.array(sortie.path_enu_m)[:, :2]).distance(zone) >= 4.99
    assert {f.severity for f in check_plan(plan, model) if f.code == "zone"} <= {Severity.NOTE, Severity.OK}
    with pytest.raises(InfeasibleError, match=r"geo-zone 'School'.*--permit"):
        free_space(with_zones(content), 5.0)
    assert free_space(with_zones(content, Z2="4711"), 5.0).no_fly_distance_m == 5.0


def test_what_stands_in_the_way_is_named_zone_by_zone():
    model = with_zones(ed269(ed269_feature(ed269_volume(polygon(square(0, 50, 40), square(0, 50, 20))))))
    named = obstructions_of(model, unchecked_space(model, 5.0))
    assert {each.id for each in named.all if each.kind == "no-fly"} == {"Z1"}
    assert len(no_fly_volumes(model)) > 1


def test_zones_that_were_added_since_leave_a_plan_the_site_s_own():
    model = with_zones(FORMATS["ed269"](ASIDE))
    changed = replace(model, sha256=site_sha256(model.site))
    assert is_planned_on(site_sha256(site().site), changed)
    assert not is_planned_on("1" * 64, changed)
