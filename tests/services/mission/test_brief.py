"""The flight brief holds what the pilot needs, from the plan's own numbers, in the user's units."""

import html
import re
from dataclasses import replace
from datetime import datetime, timedelta, timezone
from html.parser import HTMLParser
from xml.etree import ElementTree

import numpy as np
import pytest

from groundstation.services.map.shapes import plan_shapes, site_shapes
from groundstation.services.mission.brief import flight_brief
from groundstation.services.mission.brief_html import (
    MAP,
    brief_html,
    brief_pictures,
    map_svg,
    profile_name,
    sources_in_page,
)
from groundstation.services.mission.readiness import FlightDay, preflight
from groundstation.services.units import UnitSystem
from missions.formats.options import ExportOptions
from missions.mission.build import missions_from_plan
from missions.mission.export_choices import LinkLoss
from missions.mission.model import altitude_amsl_m
from planning.base.findings import Finding, Severity
from planning.geo.frames import Origin
from planning.insight.flight_profile import low_flight, lowest_flight
from planning.insight.ground_risk_request import GroundRiskRequest
from planning.routing.rally import CLEARANCE_M, clear_height_z_m
from planning.site.free_space import unchecked_space
from planning.site.ground import Ground, ground_of
from tests.missions.plans import HONG_KONG, example_plan
from tests.planning.plan_cases import kiosk
from tests.planning.site.test_terrain import hill_site, slope
from tests.planning.site.zones.zone_files import ed269, ed269_feature, ed269_volume, polygon, square, with_zones

MODEL = kiosk(home_enu_m=(3.0, -40.0, 1.5))
METRIC, IMPERIAL = UnitSystem.METRIC, UnitSystem.IMPERIAL


@pytest.fixture(scope="module")
def plan():
    return replace(example_plan(), site="kiosk")


@pytest.fixture(scope="module")
def brief(plan):
    return flight_brief(MODEL, plan, preflight(plan, MODEL).findings, "21 November 2026", "By hand")


def page_text(html):
    class Reader(HTMLParser):
        def __init__(self):
            super().__init__()
            self.parts, self.open = [], []

        def handle_starttag(self, tag, attrs):
            if tag not in ("meta", "img"):
                self.open.append(tag)

        def handle_endtag(self, tag):
            assert self.open.pop() == tag

        def handle_data(self, data):
            self.parts.append(data)

    reader = Reader()
    reader.feed(html)
    assert reader.open == []
    return " ".join(" ".join(reader.parts).split())


def test_take_off_is_where_the_mission_takes_off(brief, plan):
    takeoff = missions_from_plan(plan)[0].takeoff
    assert brief.takeoff.lat_deg == pytest.approx(takeoff.lat_deg, abs=1e-9)
    assert brief.takeoff.lon_deg == pytest.approx(takeoff.lon_deg, abs=1e-9)
    assert brief.takeoff.height_ellipsoid_m == pytest.approx(takeoff.height_ellipsoid_m, abs=1e-4)
    assert brief.takeoff.altitude_amsl_m == pytest.approx(altitude_amsl_m(takeoff), abs=1e-4)
    assert brief.takeoff.above_ground_m == 1.5


def test_sorties_are_those_of_the_plan(brief, plan):
    assert brief.n_batteries == 2
    for told, sortie, mission in zip(brief.sorties, plan.sorties, missions_from_plan(plan), strict=True):
        assert told.n_photos == len(sortie.viewpoint_ids)
        assert told.duration_s == sortie.duration_s
        assert told.battery_share == pytest.approx(sortie.duration_s / 2520.0)
        highest = max(mission.height_above_takeoff_m(w.position) for w in mission.waypoints)
        assert told.max_above_takeoff_m == pytest.approx(highest, abs=0.01)


def test_how_low_each_sortie_flies_and_how_long_below_ten_metres_is_told(brief, plan):
    ground_m, home = MODEL.site.airspace.ground_z_m, MODEL.site.home_enu_m
    for told, sortie in zip(brief.sorties, plan.sorties, strict=True):
        assert told.low == low_flight(plan, sortie, home, Ground(ground_m))
    assert brief.low.lowest_m == min(told.low.lowest_m for told in brief.sorties)
    assert brief.min_height_m == 5.0
    above = page_text(brief_html(brief, METRIC, {}))
    heights = f"{brief.low.lowest_m:.1f} m to {brief.max_above_ground_m:.1f} m"
    assert f"Height above ground {heights}, at least 5.0 m to be kept but at take-off" in above
    assert "Nobody walks" not in above
    dip = replace(
        plan.sorties[1],
        path_enu_m=(*plan.sorties[1].path_enu_m[:2], (0.0, -36.0, 6.0), *plan.sorties[1].path_enu_m[2:]),
    )
    low = flight_brief(MODEL, replace(plan, sorties=(plan.sorties[0], dip)), (), "today")
    assert low.low.lowest_m == 6.0
    text = page_text(brief_html(low, METRIC, {}))
    assert "at least 5.0 m to be kept but at take-off; " in text
    assert "below 10.0 m" in text
    assert "Nobody walks and nothing stands or hangs where the paths come down to 6.0 m above the ground" in text


def test_smallest_distances_are_those_of_the_check_by_sortie(brief, plan):
    measured = [f for f in preflight(plan, MODEL).findings if f.code == "leg-distance"]
    assert [s.smallest_clearance_m for s in brief.sorties] == [f.value for f in measured]


def test_return_height_is_what_the_mission_file_says_or_the_pilot_chose(brief, plan):
    top_m = clear_height_z_m(unchecked_space(MODEL, 10.0), CLEARANCE_M) - MODEL.site.home_enu_m[2]
    assert top_m <= brief.return_height_m < top_m + 1.0
    options = ExportOptions(site=MODEL, rth_height_m=80.0, link_loss=LinkLoss.GO_HOME)
    chosen = flight_brief(MODEL, plan, (), "today", options=options)
    assert chosen.return_height_m == 80.0
    assert "return home straight" in page_text(brief_html(chosen, METRIC, {}))
    low = flight_brief(MODEL, plan, (), "today", options=replace(options, rth_height_m=3.0))
    assert [finding.code for finding in low.findings] == ["return-height"]


def test_findings_that_are_not_ok_are_all_told_the_gravest_first(plan):
    findings = [
        Finding(Severity.OK, "a", "kept"),
        Finding(Severity.NOTE, "b", "a note <b>"),
        Finding(Severity.ERROR, "c", "an error", "sortie 1", 3.0, 10.0, "m"),
    ]
    brief = flight_brief(MODEL, plan, findings, "today")
    assert [finding.code for finding in brief.findings] == ["c", "b"]
    text = page_text(brief_html(brief, METRIC, {}))
    assert "NOT ready to fly" in text
    assert "a note <b>" in text
    assert "3.0 m sortie 1" in text
    assert "kept" not in text.split("Findings")[1].split("Before take-off")[0]


def test_a_flight_with_warnings_is_not_said_to_keep_every_rule(plan):
    warning = Finding(Severity.WARNING, "altitude", "above what the law allows")
    for findings, verdict in (((warning,), "but read the warnings"), ((), "All pre-flight rules are kept")):
        text = page_text(brief_html(flight_brief(MODEL, plan, findings, "today"), METRIC, {}))
        assert verdict in text


def test_what_is_known_of_the_day_stands_on_the_page(plan):
    day = FlightDay(datetime(2027, 6, 21, 10, 30, tzinfo=timezone(timedelta(hours=2))), -5.0)
    text = page_text(brief_html(flight_brief(MODEL, plan, (), "today", day=day), METRIC, {}))
    assert "Planned for 2027-06-21 10:30" in text
    assert "Temperature -5 \u00b0C" in text
    unknown = page_text(brief_html(flight_brief(MODEL, plan, (), "today"), METRIC, {}))
    assert "Planned for" not in unknown
    assert "Temperature" not in unknown


def test_the_buffer_and_who_may_be_inside_stand_on_the_page_where_the_pilot_stated_it(plan):
    def text(**stated):
        request = GroundRiskRequest(speed_m_s=5.0, wind_m_s=4.0, **stated)
        known = replace(plan, profile="m3e")
        return page_text(brief_html(flight_brief(MODEL, known, (), "today", ground_risk=request), METRIC, {}))

    controlled = text(population="controlled")
    assert "contingency volume 23.2 m to each side" in controlled
    assert "ground-risk buffer" in controlled
    assert "Intrinsic ground risk class 1: 0.62 m and 21 m/s: column up to 1 m and 25 m/s; row controlled" in controlled
    assert "[SORA 2.5, step 2, Table 2 (AMC1 Article 11, Table 1)]" in controlled
    lessened = text(population="suburban", restrictions="medium", impact="medium")
    assert "Final ground risk class 3: 5 - 1 (M1(B) medium) - 1 (M2 medium) = 3 [SORA 2.5, step 3" in lessened
    assert "ground risk class" not in text()
    assert "Uninvolved people inside the buffer none: controlled ground area" in controlled
    assert "fewer than 500 per square kilometre" in text(population="sparsely")
    assert "not stated how many: keep everybody out" in text()
    assert "an assembly of people" in text(population="assembly")
    nobody = replace(plan, profile="")
    refused = flight_brief(MODEL, nobody, (), "today", ground_risk=GroundRiskRequest())
    assert refused.ground_risk is None
    assert "cannot be assessed" in next(each.message for each in refused.findings if each.code == "ground-risk")
    assert "Ground risk" not in page_text(brief_html(flight_brief(MODEL, plan, (), "today"), METRIC, {}))


def test_the_sun_of_the_day_stands_on_the_page_in_words_and_as_a_bar(plan):
    at = datetime(2027, 6, 21, 10, 30, tzinfo=timezone(timedelta(hours=8)))
    found = preflight(plan, MODEL, FlightDay(at))
    brief = flight_brief(MODEL, plan, found.findings, "today", day=found.day, sun=found.sun)
    pictures = brief_pictures(MODEL, plan, METRIC, sun=found.sun)
    page = brief_html(brief, METRIC, dict.fromkeys(pictures, "x"))
    text = page_text(page)
    assert "sun over 'kiosk' on 2027-06-21 (UTC+08:00): up 05:40-19:10" in html.unescape(text)
    assert "sortie 1: take off at" in text
    assert 'alt="Sun"' in page
    assert 'alt="Sun"' not in brief_html(brief, METRIC, {"map": "x"})
    bar = ElementTree.fromstring(pictures["sun"])
    words = [each.text for each in bar.iter() if each.tag.endswith("text")]
    assert {"sun", "facade 'A'", "facade 'B'", "sortie 1", "00:00", "24:00"} <= set(words)
    assert not flight_brief(MODEL, plan, (), "today").sun


def test_page_names_every_height_reference_and_uses_the_users_units(brief):
    # The sentences of findings are metric; what they measured stands beside them in the user's units.
    bare = replace(brief, findings=())
    metric, imperial = (page_text(brief_html(bare, units, {})) for units in (METRIC, IMPERIAL))
    for text in (metric, imperial):
        for name in ("above take-off", "sea level (EGM96)", "ellipsoid (WGS 84)", "above ground"):
            assert name in text
    assert not re.search(r"\d (ft|mi|mph)\b", metric)
    assert not re.search(r"\d (m|km|m/s)\b", imperial)


def test_paper_goes_by_the_units_or_by_what_is_asked(brief):
    assert "size: A4" in brief_html(brief, METRIC, {})
    assert "size: letter" in brief_html(brief, IMPERIAL, {})
    assert "size: letter" in brief_html(brief, METRIC, {}, is_letter=True)


def test_page_carries_its_pictures_and_they_are_sound(brief, plan):
    pictures = brief_pictures(MODEL, plan, METRIC)
    assert set(pictures) == {MAP, profile_name(1), profile_name(2)}
    for svg in pictures.values():
        assert ElementTree.fromstring(svg).tag.endswith("svg")
        assert "nan" not in svg
        assert "inf" not in svg
    html = brief_html(brief, METRIC, sources_in_page(pictures))
    assert html.count("data:image/svg+xml;base64,") == 3
    page_text(html)


def test_map_shows_every_viewpoint_and_zone_inside_its_frame(plan):
    svg = map_svg(site_shapes(MODEL), plan_shapes(plan, HONG_KONG), METRIC)
    root = ElementTree.fromstring(svg)
    circles = [e for e in root.iter() if e.tag.endswith("circle")]
    assert len(circles) == len(plan.viewpoints) + 1
    assert all(0 < float(c.get("cx")) < 720 and 0 < float(c.get("cy")) < 520 for c in circles)
    assert ">road<" in svg


def test_names_with_markup_stay_text(plan):
    model = kiosk(name="<script>alert(1)</script>", home_enu_m=(3.0, -40.0, 1.5))
    brief = flight_brief(model, replace(plan, site=model.site.name), (), "today", '"&<')
    html = brief_html(brief, METRIC, {})
    assert "<script" not in html
    assert "<script>alert(1)</script>" in page_text(html)


@pytest.mark.parametrize("origin", [Origin(-16.5, 180.0, 55.0), Origin(90.0, 0.0, 0.0), Origin(31.5, 35.5, -395.0)])
def test_briefs_are_made_anywhere(plan, origin):
    model = kiosk(origin=origin, home_enu_m=(3.0, -40.0, 1.5))
    there = replace(plan, origin=origin)
    for svg in brief_pictures(model, there, METRIC).values():
        assert "nan" not in svg
    page_text(brief_html(flight_brief(model, there, (), "today"), METRIC, {}))


def test_a_plan_that_is_no_mission_still_has_a_brief_that_says_so(plan):
    empty = replace(plan, viewpoints=(), sorties=())
    brief = flight_brief(MODEL, empty, (), "today")
    assert brief.return_height_m is None
    assert [finding.code for finding in brief.findings] == ["no-mission"]
    text = page_text(brief_html(brief, METRIC, sources_in_page(brief_pictures(MODEL, empty, METRIC))))
    assert "The plan has no sorties." in text
    assert "not known" in text


def test_geo_zones_are_listed_with_what_the_path_does_and_drawn(plan):
    ring = square(0.0, 0.0, 30.0, MODEL.site.origin)
    other = square(400.0, 0.0, 30.0, MODEL.site.origin)
    zones = ed269(
        ed269_feature(ed269_volume(polygon(ring)), name="Market"),
        ed269_feature(ed269_volume(polygon(other)), name="Park", identifier="Z2"),
    )
    model = with_zones(zones, MODEL)
    text = page_text(brief_html(flight_brief(model, plan, preflight(plan, model).findings, "today"), METRIC, {}))
    assert "Geo-zones" in text
    assert "Market: flights prohibited (SENSITIVE), 0 m AGL - 120 m AGL: the path enters it" in text
    assert "Park: flights prohibited" in text
    assert "'zones.json' (ED-269, Test, added on 2026-11-28)" in text
    shapes, routes = site_shapes(model), plan_shapes(plan, model.site.origin)
    with_both, without = map_svg(shapes, routes, METRIC), map_svg(site_shapes(MODEL), routes, METRIC)
    assert with_both.count("<polygon") + with_both.count("<path") > without.count("<polygon") + without.count("<path")


def test_over_terrain_heights_count_from_it_and_the_profile_draws_it(plan):
    site = hill_site(slope)
    over = flight_brief(site, plan, (), "2026-11-28")
    assert over.low == lowest_flight(plan, site.site.home_enu_m, ground_of(site.site))
    assert over.low.lowest_m != flight_brief(kiosk(), plan, (), "2026-11-28").low.lowest_m
    assert over.takeoff.above_ground_m == pytest.approx(0.0, abs=2e-3)
    pictures, level = brief_pictures(site, plan, METRIC), brief_pictures(kiosk(), plan, METRIC)
    assert pictures["profile-1"].count("<polyline") == level["profile-1"].count("<polyline")
    assert "stroke-dasharray" in level["profile-1"]
    terrain = [line for line in pictures["profile-1"].split("<polyline")[1:] if 'stroke="#8a5300" stroke-width' in line]
    assert len(terrain) == 1
    assert terrain[0].count(",") > 20
    holed = hill_site(lambda x, y: np.where(np.abs(y + 22.0) < 3.0, np.nan, slope(x, y)))
    assert "nan" not in brief_pictures(holed, plan, METRIC)["profile-1"]
