"""Allowed positions and legs, and homes that cannot be."""

import math
from dataclasses import replace

import numpy as np
import pytest

from planning.base.errors import InfeasibleError
from planning.base.findings import is_flyable
from planning.checks import check_plan
from planning.parameters import Constraints, GreedyParameters
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.routing.roadmap import COLUMN_SPACING_M
from planning.site.bundled import SCENES
from planning.site.free_space import LEG_MARGIN_M, SAFETY_MARGIN_M, free_space
from planning.site.records import Airspace, NoFlyZone
from tests.slow import slow


def office_with(**changes):
    model = SCENES["office"]()
    return replace(model, site=replace(model.site, **changes))


def test_viewpoint_at_exactly_the_minimum_distance_is_refused_only_for_the_rounding_margin():
    space = free_space(SCENES["office"](), 10.0)
    points = np.array([[0.0, -10.0 - d, 20.0] for d in (-1e-6, 0.0, 0.9 * SAFETY_MARGIN_M, 1.1 * SAFETY_MARGIN_M)])
    assert space.is_allowed(points).tolist() == [False, False, False, True]
    rounded = np.round(points[3], 4)
    assert space.solids.clearance_m(rounded[None])[0] >= 10.0


def test_viewpoints_chosen_at_the_limit_stay_flyable_when_they_are_rounded():
    space = free_space(SCENES["library"](), 10.0)
    rng = np.random.default_rng(2)
    angle = rng.uniform(-2.5, -0.7, 4000)
    radius = 30.0 + 10.0 + rng.uniform(-0.2, SAFETY_MARGIN_M + 1e-4, 4000)
    points = np.c_[radius * np.cos(angle), radius * np.sin(angle), rng.uniform(5, 20, 4000)]
    points = points[space.is_allowed(points)]
    assert len(points) > 200
    assert space.is_allowed(points.round(4), LEG_MARGIN_M).all()


def test_positions_outside_the_airspace_inside_the_building_and_not_finite_are_refused():
    space = free_space(SCENES["office"](), 1.0)
    points = np.array([[0, -20, 80], [0, -20, 1], [0, 9, 20], [np.nan, -20, 20], [0, -np.inf, 20], [0, -20, 20.0]])
    assert space.is_allowed(points).tolist() == [False] * 5 + [True]


def test_leg_through_the_building_is_not_clear_and_leg_along_the_facade_is():
    space = free_space(SCENES["office"](), 10.0)
    a = np.array([[0.0, -20.0, 20.0], [-40.0, -11.0, 20.0]])
    b = np.array([[0.0, 40.0, 20.0], [40.0, -11.0, 20.0]])
    assert space.legs_clear(a, b).tolist() == [False, True]


@pytest.mark.parametrize(
    ("home", "message"),
    [
        ((0.0, 9.0, 0.0), "inside a building"),
        ((0.0, -4.0, 0.0), "comes within 4.00 m"),
        ((0.0, -200.0, 0.0), "not below or inside the airspace"),
        ((0.0, -45.0, 80.0), "not below or inside the airspace"),
    ],
)
def test_impossible_homes_are_refused_with_what_was_measured(home, message):
    with pytest.raises(InfeasibleError, match=message):
        free_space(office_with(home_enu_m=home), 10.0)


LOW_CORNER, HIGH_CORNER = (-60.0, -70.0, 3.0), (60.0, 50.0, 75.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    "home", [slow((-60.0, -45.0, 0.0)), slow((0.0, -70.0, 0.0)), (60.0, 50.0, 0.0), (-60.0, -70.0, 72.9)]
)
def test_home_on_the_border_of_the_airspace_is_inside_it(home):
    model = office_with(home_enu_m=home)
    assert model.site.airspace.min_enu_m == LOW_CORNER
    assert model.site.airspace.max_enu_m == HIGH_CORNER
    planned = plan_flight(model, PlanRequest(n_views=6, greedy=GreedyParameters(400, improve=False, certify=False)))
    assert is_flyable(check_plan(planned.plan, model))
    space = planned.prepared.problem.space
    n_column = planned.prepared.problem.roadmap.n_column
    assert n_column == max(1, math.ceil((HIGH_CORNER[2] - space.column_top_enu_m[2]) / COLUMN_SPACING_M)), "all the way"


@pytest.mark.parametrize("home", [(-60.001, -45.0, 0.0), (0.0, 50.001, 0.0), (0.0, -45.0, 73.0)])
def test_home_just_outside_the_airspace_or_without_room_for_the_climb_is_refused(home):
    with pytest.raises(InfeasibleError, match="not below or inside the airspace"):
        free_space(office_with(home_enu_m=home), 10.0)


def test_home_in_a_no_fly_zone_or_below_one_is_refused():
    airspace = SCENES["office"]().site.airspace
    square = ((-10.0, -50.0), (10.0, -50.0), (10.0, -40.0), (-10.0, -40.0))
    for floor, message in ((0.0, "inside a no-fly"), (2.0, "crosses a no-fly")):
        zone = NoFlyZone("zone", square, floor - 0.5, 50.0)
        with pytest.raises(InfeasibleError, match=message):
            free_space(office_with(airspace=replace(airspace, no_fly=(zone,))), 10.0)


def test_home_close_to_a_no_fly_zone_lowers_the_distance_kept_from_it_and_nothing_else():
    airspace = SCENES["office"]().site.airspace
    zone = NoFlyZone("road", ((4.0, -60.0), (60.0, -60.0), (60.0, -30.0), (4.0, -30.0)), 0.0, 120.0)
    space = free_space(office_with(airspace=replace(airspace, no_fly=(zone,))), 10.0)
    assert space.no_fly_distance_m == pytest.approx(4.0, abs=0.01)
    assert space.min_distance_m == 10.0
    points = np.array([[30.0, -29.0 + 4.0, 20.0], [30.0, -26.1, 20.0], [30.0, -45.0, 20.0], [30.0, -12.0, 20.0]])
    assert space.is_allowed(points).tolist() == [True, False, False, True]


def test_nothing_is_allowed_below_the_lowest_height_but_the_column_above_home():
    model = office_with(airspace=replace(SCENES["office"]().site.airspace, ground_z_m=1.0))
    points = np.array([[0.0, -30.0, z] for z in (4.0, 6.0, 6.003, 9.003)])
    assert free_space(model, 10.0).is_allowed(points).tolist() == [False, False, True, True], "5 m above the ground"
    assert free_space(model, 10.0, 8.0).is_allowed(points).tolist() == [False, False, False, True]
    assert free_space(model, 10.0, 2.5).is_allowed(points).tolist() == [True, True, True, True]
    own = replace(model.site.airspace, min_height_above_ground_m=8.0)
    assert free_space(replace(model, site=replace(model.site, airspace=own)), 10.0).low_enu_m[2] == 9.0
    with pytest.raises(InfeasibleError, match=r"ceiling lies 74 m above the ground, .* keep 80 m"):
        free_space(model, 10.0, 80.0)


@pytest.mark.parametrize("height_m", [-1.0, float("nan"), float("inf")])
def test_a_lowest_height_that_is_none_is_refused(height_m):
    with pytest.raises(ValueError, match="min_height_above_ground_m: expected 0 m or more"):
        Constraints(min_height_above_ground_m=height_m)
    with pytest.raises(ValueError, match="min_height_above_ground_m: expected 0 m or more"):
        replace(SCENES["office"]().site.airspace, min_height_above_ground_m=height_m)


def test_column_runs_from_home_to_the_airspace_floor_and_at_least_two_metres_up():
    assert free_space(SCENES["office"](), 10.0).column_top_enu_m[2] == pytest.approx(5.0 + SAFETY_MARGIN_M)
    low = free_space(SCENES["office"](), 10.0, 0.0)
    assert low.column_top_enu_m[2] == pytest.approx(3.0 + SAFETY_MARGIN_M), "the airspace begins there"
    airspace = Airspace((-60.0, -70.0, 3.0), (60.0, 50.0, 75.0), ground_z_m=0.0)
    high = free_space(office_with(airspace=airspace, home_enu_m=(0.0, -45.0, 12.0)), 10.0)
    assert high.column_top_enu_m[2] == 14.0
