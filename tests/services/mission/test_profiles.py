"""Profiles count from take-off and fit the plan's times and paths."""

from dataclasses import replace

import numpy as np
import pytest

from groundstation.services.mission.waypoints import height_limits, nearest_photo, plan_profiles, waypoint_rows
from planning.site.ground import ground_of
from tests.missions.plans import HOME, example_plan
from tests.planning.plan_cases import kiosk
from tests.planning.site.test_terrain import hill_site, slope


def test_curves_pass_every_waypoint_at_its_time_and_height():
    plan = example_plan()
    for curves in plan_profiles(plan):
        rows = [row for row in waypoint_rows(plan) if row.sortie == curves.sortie]
        heights = np.interp([row.arrival_s for row in rows], curves.t_s, curves.height_m)
        assert heights == pytest.approx([row.position_enu_m[2] - HOME[2] for row in rows], abs=0.01)
        assert curves.distance_m[-1] == pytest.approx(plan.sorties[curves.sortie - 1].length_m, rel=1e-6)
        assert curves.photo_ids == plan.sorties[curves.sortie - 1].viewpoint_ids
        assert curves.speed_m_s.min() >= 0.0


def test_nearest_photo_is_the_one_nearest_in_time():
    curves = plan_profiles(example_plan())[0]
    for viewpoint_id, t_s in zip(curves.photo_ids, curves.photo_t_s, strict=True):
        assert nearest_photo(curves, t_s + 0.01) == viewpoint_id
    assert nearest_photo(curves, -100.0) == curves.photo_ids[0]
    assert nearest_photo(replace(curves, photo_ids=()), 0.0) is None


def test_limits_count_from_take_off():
    limits = height_limits(kiosk(home_enu_m=(0.0, -30.0, 2.0)))
    assert (limits.ground_m, limits.floor_m, limits.ceiling_m, limits.legal_m) == (-2.0, 1.0, 38.0, 118.0)


def test_terrain_is_drawn_below_the_flight_and_limits_follow_it():
    model = hill_site(slope)
    plan = example_plan()
    for curves in plan_profiles(plan, ground_of(model.site)):
        assert curves.ground.t_s[[0, -1]] == pytest.approx(curves.t_s[[0, -1]])
        assert (np.diff(curves.ground.t_s) >= 0.0).all()
        path = np.array(plan.sorties[curves.sortie - 1].path_enu_m)
        way = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1)))
        north = np.interp(curves.ground.distance_m, way, path[:, 1])
        assert curves.ground.height_m == pytest.approx(slope(0.0, north) - path[0, 2], abs=2e-3)
    assert [curves.ground for curves in plan_profiles(plan)] == [None, None]
    limits = height_limits(model)
    assert not limits.is_level
    assert limits.ground_m == pytest.approx(-1.0, abs=2e-3)
    assert limits.legal_m == pytest.approx(119.0, abs=2e-3)


def test_plans_that_cannot_be_flown_have_no_profile():
    plan = example_plan()
    assert plan_profiles(replace(plan, sorties=(), viewpoints=())) == ()
    assert plan_profiles(replace(plan, rules=replace(plan.rules, wind_m_s=50.0))) == ()
    without_path = replace(plan, sorties=(replace(plan.sorties[0], path_enu_m=()), plan.sorties[1]))
    assert [curves.sortie for curves in plan_profiles(without_path)] == [2]
