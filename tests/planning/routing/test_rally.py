"""Rally points: where aircraft can land, and how they return."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.base.errors import InputError
from planning.base.findings import Severity
from planning.checks import check_plan
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.routing.rally import clear_height_z_m, rally_findings, return_height, return_route, return_routes
from planning.site.file import is_planned_on, read_site, site_sha256, site_to_json, write_site
from planning.site.free_space import unchecked_space
from planning.site.records import Airspace, NoFlyZone, RallyPoint
from tests.planning.plan_cases import kiosk

DISTANCE_M = 8.0


def with_rally(*places, model=None):
    model = kiosk() if model is None else model
    points = tuple(RallyPoint(f"rally-{n}", place) for n, place in enumerate(places, 1))
    site = replace(model.site, rally_points=points)
    return replace(model, site=site, sha256=site_sha256(site))


def found(model):
    return list(rally_findings(model, unchecked_space(model, DISTANCE_M)))


def test_a_site_without_rally_points_has_the_file_that_it_always_had(tmp_path):
    model = kiosk()
    assert "rally_points" not in site_to_json(model.site)
    there = with_rally((20.0, -20.0, 0.0), model=kiosk(building_mesh=None))
    write_site(tmp_path / "site.json", there.site)
    assert read_site(tmp_path / "site.json").site == there.site
    assert site_to_json(replace(there.site, rally_points=())) == site_to_json(kiosk(building_mesh=None).site)


def test_a_rally_point_without_a_name_or_far_away_is_refused():
    with pytest.raises(ValueError, match="name"):
        RallyPoint("", (0.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="position_enu_m"):
        RallyPoint("a", (1e7, 0.0, 0.0))


def test_a_wrong_rally_point_in_a_file_is_named(tmp_path):
    path = tmp_path / "site.json"
    write_site(path, with_rally((20.0, -20.0, 0.0)).site)
    path.write_text(path.read_text().replace('"position_enu_m"', '"place"'))
    with pytest.raises(InputError, match="rally_points"):
        read_site(path)


def test_a_plan_stays_good_when_rally_points_are_marked_after_it_was_made():
    model = replace(kiosk(), sha256=site_sha256(kiosk().site))
    marked = with_rally((20.0, -20.0, 0.0))
    assert marked.sha256 != model.sha256
    assert is_planned_on(model.sha256, marked)
    moved = replace(marked.site, home_enu_m=(1.0, -25.0, 0.0))
    assert not is_planned_on(model.sha256, replace(marked, site=moved, sha256=site_sha256(moved)))
    assert is_planned_on("", marked)


LOW, HIGH = kiosk().site.airspace.min_enu_m, kiosk().site.airspace.max_enu_m
CENTRE = np.mean([corner for panel in kiosk().site.panels for corner in panel.corners_enu_m], axis=0)


@pytest.mark.parametrize(
    ("place", "words"),
    [
        ((HIGH[0] + 5.0, 0.0, 0.0), "is not below or inside the airspace"),
        ((LOW[0] + 1.0, LOW[1] + 1.0, HIGH[2] + 1.0), "is not below or inside the airspace"),
    ],
)
def test_a_rally_point_where_no_aircraft_may_fly_is_an_error(place, words):
    (finding,) = found(with_rally(place))
    assert finding.severity is Severity.ERROR
    assert words in finding.message
    assert finding.place == "rally/rally-1"


def test_a_rally_point_on_the_border_of_the_airspace_is_inside_it():
    for place in ((HIGH[0], LOW[1], 0.0), (HIGH[0], 0.0, 0.0), (0.0, LOW[1], 0.0)):
        assert [finding.severity for finding in found(with_rally(place))] == [Severity.OK]


def test_the_landing_column_keeps_the_distance_that_flights_keep():
    """Moved away from the facade, a point becomes good just where the distance is reached."""
    model = kiosk()
    corners = np.array([panel.corners_enu_m for panel in model.site.panels]).reshape(-1, 3)
    front_m = corners[:, 1].min()
    for beyond_m, is_good in ((-0.2, False), (0.2, True)):
        place = (float(CENTRE[0]), float(front_m - DISTANCE_M - beyond_m), 0.0)
        messages = [finding.message for finding in found(with_rally(place)) if finding.severity is Severity.ERROR]
        assert (not messages) is is_good, messages


def test_a_no_fly_volume_above_a_rally_point_is_an_error_and_below_ground_a_warning():
    model = kiosk()
    low = model.site.airspace.min_enu_m
    x, y = low[0] + 4.0, low[1] + 4.0
    square = ((x - 2.0, y - 2.0), (x + 2.0, y - 2.0), (x + 2.0, y + 2.0), (x - 2.0, y + 2.0))
    airspace = replace(model.site.airspace, no_fly=(NoFlyZone("road", square, 1.0, 50.0),))
    over = with_rally((x, y, 0.0), model=replace(model, site=replace(model.site, airspace=airspace)))
    assert "no-fly volume" in found(over)[0].message
    (below,) = found(with_rally((x, y, -3.0)))
    assert below.severity is Severity.WARNING
    assert "below the ground" in below.message


@pytest.mark.slow
def test_a_check_of_a_plan_tells_of_rally_points_only_where_there_are_some():
    model = kiosk()
    plan = plan_flight(model, PlanRequest(n_views=4, method="orbit")).plan
    assert not [finding for finding in check_plan(plan, model) if finding.code == "rally-point"]
    good = check_plan(plan, with_rally((float(CENTRE[0]) + 2.0, -25.0, 0.0)))
    assert [finding.severity for finding in good if finding.code == "rally-point"] == [Severity.OK]
    bad = check_plan(plan, with_rally((HIGH[0] + 5.0, 0.0, 0.0)))
    assert [finding.severity for finding in bad if finding.code == "rally-point"] == [Severity.ERROR]


def test_the_return_is_measured_on_the_whole_way():
    """From behind the building home lies through it, unless it is flown above."""
    model = kiosk(airspace=Airspace((-60.0, -60.0, 2.0), (60.0, 60.0, 60.0), 0.0), home_enu_m=(0.0, -40.0, 0.0))
    space = unchecked_space(model, DISTANCE_M)
    points = np.concatenate([np.array([p.corners_enu_m for p in model.site.panels]).reshape(-1, 3)])
    middle, top = points.mean(axis=0), points[:, 2].max()
    behind = np.array([[middle[0], middle[1] + 45.0, 5.0], [middle[0], middle[1] + 44.0, 5.0]])
    home = model.site.home_enu_m
    through = return_route(space, behind, (home,), min(5.0, top - 0.1))
    assert through.gap_m == 0.0
    clear = return_route(space, behind, (home,), clear_height_z_m(space, DISTANCE_M))
    assert clear.gap_m >= DISTANCE_M - 1e-6
    # A place to land on this side makes the way short, whatever stands on the other.
    near = (float(middle[0]), float(middle[1] + 45.0), 0.0)
    short = return_route(space, behind, (home, near), 5.0)
    assert short.gap_m > DISTANCE_M
    assert short.n_elsewhere == short.n_places == 2


def test_close_to_its_destination_it_climbs_no_higher_than_the_cone():
    model = kiosk()
    space = unchecked_space(model, DISTANCE_M)
    home = np.array(model.site.home_enu_m)
    path = home + np.array([[1.0, 0.0, 3.0], [2.0, 0.0, 3.0]])
    high = (float(home[0]), float(home[1]), float(home[2]))
    ceiling = NoFlyZone("lid", ((home[0] - 5, home[1] - 5), (home[0] + 5, home[1] - 5), (home[0], home[1] + 5)), 10, 20)
    lidded = replace(model, site=replace(model.site, airspace=replace(model.site.airspace, no_fly=(ceiling,))))
    space = unchecked_space(lidded, DISTANCE_M)
    assert return_route(space, path, (high,), 15.0).crosses_no_fly
    assert not return_route(space, path, (high,), 15.0, cone_slope=3.0).crosses_no_fly


def test_a_return_needs_a_destination():
    space = unchecked_space(kiosk(), DISTANCE_M)
    with pytest.raises(ValueError, match="home at least"):
        return_route(space, np.zeros((2, 3)), (), 10.0)


# The height of a return


def walled_off(ceiling_m):
    """Home on one side of the building, a path on the other; and where the airspace ends."""
    return kiosk(airspace=Airspace((-60.0, -60.0, 2.0), (60.0, 60.0, ceiling_m), 0.0), home_enu_m=(0.0, -40.0, 0.0))


BEHIND = np.array([[0.0, 30.0, 5.0], [4.0, 30.0, 5.0]])


@given(st.floats(9.0, 60.0), st.floats(5.0, 15.0))
def test_a_return_stays_in_the_airspace_and_is_as_high_as_wanted_where_there_is_room(ceiling_m, distance_m):
    model = walled_off(ceiling_m)
    space = unchecked_space(model, distance_m)
    found, (way,) = return_height(space), return_routes(space, [BEHIND])
    assert found.z_m <= ceiling_m + 1e-9
    assert found.above_home_m == pytest.approx(found.z_m - model.site.home_enu_m[2])
    if ceiling_m >= np.ceil(found.wanted_above_home_m):
        assert found.wanted_above_home_m <= found.above_home_m < found.wanted_above_home_m + 1.0
        assert way.gap_m >= distance_m - 1e-6
    else:
        assert ceiling_m - found.z_m < 0.1 + 1e-9


@pytest.mark.long
def test_where_the_airspace_ends_too_low_to_return_over_the_building_the_plan_is_not_ready():
    """45.0 m against 44.8 m was ready, and then a danger."""
    plan = plan_flight(walled_off(40.0), PlanRequest(n_views=4, method="orbit")).plan
    top_m = clear_height_z_m(unchecked_space(walled_off(40.0), DISTANCE_M), 0.0)

    def said(ceiling_m):
        findings = check_plan(plan, walled_off(ceiling_m))
        return next(finding for finding in findings if finding.code == "return-height")

    good = said(40.0)
    assert (good.severity, good.limit) == (Severity.OK, 40.0)
    assert good.value <= 40.0
    tight = said(top_m + plan.constraints.min_distance_m - 0.2)
    assert tight.severity is Severity.OK, "20 cm lower, and it still keeps its distance but for its tolerance"
    assert tight.value < top_m + plan.constraints.min_distance_m
    low = said(top_m + 3.0)
    assert low.severity is Severity.ERROR
    assert "raise its ceiling" in low.message
    assert low.value > low.limit


def test_ways_home_of_legs_are_those_of_their_path_one_by_one():
    """Measured together, each is what it is by itself, and together they are the path's."""
    model = walled_off(30.0)
    space = unchecked_space(model, DISTANCE_M)
    rng = np.random.default_rng(0)
    path = rng.uniform((-40.0, -40.0, 5.0), (40.0, 40.0, 25.0), (9, 3))
    legs = [path[k : k + 2] for k in range(8)]
    found = return_routes(space, legs)
    assert found == [return_routes(space, [leg])[0] for leg in legs]
    (whole,) = return_routes(space, [path])
    assert whole.gap_m == min(way.gap_m for way in found)
    assert whole.n_places == sum(way.n_places for way in found) - 7  # places where two legs meet
    assert return_routes(space, []) == []
