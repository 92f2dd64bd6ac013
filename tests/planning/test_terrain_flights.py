"""Flights over terrain: plans, their checks, returns and exports against dense sampling of the slope itself."""

from dataclasses import replace

import numpy as np
import pytest

from missions.formats.encode import _security_height_m
from missions.formats.options import ExportOptions
from planning.base.findings import Severity
from planning.checks import check_plan
from planning.coverage.positions import aimed_views, spread_positions
from planning.coverage.reach_kernel import REACHABLE, UNREACHABLE
from planning.insight.flight_profile import highest_above_ground_m, lowest_flight
from planning.plan import Sortie
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.routing.rally import return_height, return_routes
from planning.site.bundled import panel_grid
from planning.site.free_space import free_space, unchecked_space
from planning.site.ground import ground_of
from tests.planning.revision.cases import QUICK
from tests.planning.site.test_terrain import hill_site, slope


def request():
    return PlanRequest(n_views=8, greedy=QUICK, time_budget_s=30.0)


@pytest.fixture(scope="module")
def hill():
    model = hill_site(lambda x, y: 2.0 * slope(x, y))
    south = panel_grid("A", ((-6.0, 0.0, 6.0), (6.0, 0.0, 6.0), (-6.0, 0.0, 9.0)), 1, 2)
    return replace(model, site=replace(model.site, facades=(south,)))


@pytest.fixture(scope="module")
def planned(hill):
    return plan_flight(hill, request())


def along(path, n=400):
    path = np.array(path)
    t = np.linspace(0.0, 1.0, n)[:, None, None]
    return (path[:-1] + t * (path[1:] - path[:-1])).reshape(-1, 3)


def findings(plan, model, code):
    return [found for found in check_plan(plan, model) if found.code == code]


def test_a_plan_on_a_slope_keeps_its_height_above_the_slope_on_its_whole_way(hill, planned):
    plan = planned.plan
    home = np.array(hill.site.home_enu_m)
    for sortie in plan.sorties:
        points = along(sortie.path_enu_m)
        beside = np.linalg.norm(points[:, :2] - home[:2], axis=1) > 1e-6
        above = points[:, 2] - 2.0 * slope(points[:, 0], points[:, 1])
        assert above[beside].min() >= 5.0 - 1e-3
    assert not [found for found in check_plan(plan, hill) if found.severity is Severity.ERROR]
    low = lowest_flight(plan, hill.site.home_enu_m, ground_of(hill.site))
    (judged,) = findings(plan, hill, "low-flight")
    assert low.lowest_m == pytest.approx(judged.value, abs=1e-9)
    greatest = max(
        float((p[:, 2] - 2.0 * slope(p[:, 0], p[:, 1])).max()) for p in (along(s.path_enu_m) for s in plan.sorties)
    )
    assert highest_above_ground_m(plan, ground_of(hill.site)) == pytest.approx(greatest, abs=5e-3)
    (altitude,) = findings(plan, hill, "altitude")
    assert altitude.value == pytest.approx(greatest, abs=5e-3)


def test_the_plan_says_that_the_terrain_counts_and_a_plan_on_level_ground_says_nothing(hill, planned):
    (decision,) = [effect for effect in planned.plan.effects if effect.effect == "terrain"]
    assert decision.on
    assert decision.size == pytest.approx(14.0, abs=0.01)
    (found,) = findings(planned.plan, hill, "terrain")
    assert found.severity is Severity.OK
    plain = replace(hill, site=replace(hill.site, terrain=None), sha256="")
    assert findings(planned.plan, plain, "terrain") == []
    off = replace(hill, site=replace(hill.site, terrain=replace(hill.site.terrain, use="off")), sha256="")
    (found,) = findings(planned.plan, off, "terrain")
    assert found.severity is Severity.WARNING


def test_witnesses_of_what_can_be_covered_stand_above_the_slope(hill, planned):
    reach = planned.prepared.problem.reachability
    found = reach.witnesses_enu_m[reach.verdicts == REACHABLE]
    assert (found[:, 2] - 2.0 * slope(found[:, 0], found[:, 1])).min() >= 5.0


@pytest.mark.slow
def test_what_is_proven_out_of_reach_over_terrain_is_seen_from_nowhere_allowed(hill, planned):
    problem = planned.prepared.problem
    places = spread_positions(problem.space, problem.model.frames, 20_000, np.random.default_rng(5))
    targets = problem.model.frames.centroids[
        np.random.default_rng(6).integers(0, len(problem.model.frames), len(places))
    ]
    seen = np.unique(problem.model.elements(aimed_views(places, targets, problem.model.camera)).items)
    assert (problem.reachability.verdicts.ravel()[seen] != UNREACHABLE).all()
    assert (problem.reachability.verdicts == UNREACHABLE).any()


def test_a_path_into_the_slope_is_found_by_the_check(hill, planned):
    plan = planned.plan
    sortie = plan.sorties[0]
    # Level flight uphill at 6 m above home: at y = 20 the slope is 10 m high.
    path = (*sortie.path_enu_m[:2], (14.0, -30.0, 6.0), (14.0, 30.0, 6.0), *sortie.path_enu_m[1:])
    low = replace(plan, sorties=(replace(sortie, path_enu_m=path), *plan.sorties[1:]))
    (found,) = [found for found in findings(low, hill, "low-flight") if found.severity is Severity.ERROR]
    assert found.value == pytest.approx(6.0 - 12.0, abs=5e-3)


def test_a_path_over_ground_of_which_nothing_is_known_is_an_error(planned):
    holed = hill_site(lambda x, y: np.where((x > 25.0) & (np.abs(y) < 5.0), np.nan, 2.0 * slope(x, y)))
    up, down = ((0.0, -30.0, 0.0), (0.0, -30.0, 35.0)), ((0.0, -30.0, 35.0), (0.0, -30.0, 0.0))
    path = (*up, (30.0, -30.0, 35.0), (30.0, 30.0, 35.0), (20.0, 30.0, 35.0), *down)
    over = replace(planned.plan, sorties=(replace(planned.plan.sorties[0], path_enu_m=path),))
    (found,) = findings(over, holed, "terrain-unknown")
    assert (found.severity, found.value) == (Severity.ERROR, 1.0)
    assert "what is not known is not clear" in found.message
    assert lowest_flight(over, holed.site.home_enu_m, ground_of(holed.site)).lowest_m == 0.0


def test_an_aircraft_returns_above_the_highest_ground(hill):
    space = free_space(hill, 5.0)
    # The slope is 14 m high at the northern side, the tree 11 m.
    found = return_height(space)
    assert found.wanted_above_home_m == pytest.approx(14.0 + 10.0, abs=0.1)
    (way,) = return_routes(space, [np.array([[0.0, 38.0, 20.0], [0.0, 20.0, 20.0]])])
    assert way.above_ground_m == pytest.approx(found.z_m - 2.0 * slope(0.0, 38.0), abs=0.01)


def test_a_return_that_the_ceiling_keeps_too_near_the_ground_is_an_error(hill, planned):
    airspace = replace(hill.site.airspace, max_enu_m=(40.0, 40.0, 16.0))
    low = replace(hill, site=replace(hill.site, airspace=airspace, obstacles=()), obstacles=(), sha256="")
    plan = planned.plan
    path = ((0.0, -30.0, 0.0), (0.0, -30.0, 15.0), (0.0, 38.0, 15.9), (0.0, -30.0, 15.0), (0.0, -30.0, 0.0))
    over = replace(plan, viewpoints=(), sorties=(Sortie((), path, 160.0, 60.0),))
    low = replace(low, building=replace(low.building, vertices_enu_m=low.building.vertices_enu_m * [1.0, 1.0, 0.2]))
    found = [each for each in findings(over, low, "return-height") if each.severity is Severity.ERROR]
    assert found


def test_dji_climbs_above_the_ground_on_the_way_to_the_first_waypoint(hill, planned):
    options = ExportOptions(site=hill)
    assert _security_height_m(planned.plan, options) == pytest.approx(5.0, abs=0.41)
    first = (20.0, 20.0, 30.0)
    sortie = replace(planned.plan.sorties[0], path_enu_m=((0.0, -30.0, 0.0), first, (0.0, -30.0, 0.0)))
    away = replace(planned.plan, sorties=(sortie,))
    assert _security_height_m(away, options) == pytest.approx(5.0 + 10.0, abs=0.41)


def test_measuring_a_plan_does_not_ask_for_a_home_that_can_be_used(hill):
    assert unchecked_space(hill, 5.0).min_height_m is None
