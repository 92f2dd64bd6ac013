from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings

from missions.mission.build import missions_from_plan
from planning.base.errors import InputError, MissionError
from planning.geo.enu import enu_from_geodetic
from planning.geo.frames import Origin
from planning.plan import Plan, Sortie, Viewpoint
from tests.missions.plans import HOME, HONG_KONG, example_plan, make_plan, plans, ring


def with_path(plan: Plan, path: list[tuple[float, float, float]]) -> Plan:
    return replace(plan, sorties=(replace(plan.sorties[0], path_enu_m=tuple(path)), *plan.sorties[1:]))


@pytest.mark.slow
@given(plan=plans())
@settings(max_examples=40)
def test_waypoints_are_the_vertices_between_the_ground_points_and_hold_every_photo_once(plan: Plan) -> None:
    missions = missions_from_plan(plan)
    assert len(missions) == len(plan.sorties)
    taken = []
    for mission, sortie in zip(missions, plan.sorties, strict=True):
        points = [mission.takeoff, *(w.position for w in mission.waypoints)]
        local = enu_from_geodetic(
            mission.origin,
            [p.lat_deg for p in points],
            [p.lon_deg for p in points],
            [p.height_ellipsoid_m for p in points],
        )
        vertices = np.array(sortie.path_enu_m[:-1])
        kept = np.r_[True, np.linalg.norm(np.diff(vertices, axis=0), axis=1) > 1e-3]
        np.testing.assert_allclose(local, vertices[kept], atol=1e-6)
        for waypoint, position in zip(mission.waypoints, local[1:], strict=True):
            for photo in waypoint.photos:
                view = next(v for v in plan.viewpoints if v.id == photo.viewpoint_id)
                assert math.dist(view.position_enu_m, position) < 2e-3
                assert photo.heading_deg == view.heading_deg
                assert photo.gimbal_pitch_deg == view.gimbal_pitch_deg
                taken.append(photo.viewpoint_id)
    assert taken == [i for sortie in plan.sorties for i in sortie.viewpoint_ids]


def test_two_views_of_one_place_become_two_photos_of_one_waypoint() -> None:
    place = (10.0, 0.0, 25.0)
    views = [Viewpoint("a", place, 10.0, 0.0), Viewpoint("b", place, 80.0, -20.0)]
    (mission,) = missions_from_plan(make_plan([(views, {})]))
    assert [[p.viewpoint_id for p in w.photos] for w in mission.waypoints] == [[], ["a", "b"], []]


def test_heading_of_a_plan_in_0_to_360_is_brought_to_the_formats_range() -> None:
    (mission,) = missions_from_plan(make_plan([([Viewpoint("a", (10.0, 0.0, 25.0), 350.0, 0.0)], {})]))
    assert mission.waypoints[1].photos[0].heading_deg == pytest.approx(-10.0)


def test_speed_is_the_lower_of_the_aircrafts_and_the_pilots() -> None:
    plan = example_plan()
    assert missions_from_plan(plan)[0].speed_m_s == 15.0
    slow = replace(plan, rules=replace(plan.rules, max_speed_m_s=4.0))
    assert missions_from_plan(slow)[0].speed_m_s == 4.0


def test_plan_without_origin_or_home_asks_for_the_site_and_takes_it_as_argument() -> None:
    plan = replace(example_plan(), origin=None, home_enu_m=None)
    with pytest.raises(InputError, match=r"no origin.*--site SITE"):
        missions_from_plan(plan)
    with pytest.raises(InputError, match=r"no home_enu_m.*--site SITE"):
        missions_from_plan(plan, HONG_KONG)
    assert missions_from_plan(plan, HONG_KONG, HOME) == missions_from_plan(example_plan())


def test_site_that_contradicts_the_plan_is_refused() -> None:
    with pytest.raises(InputError, match="plan again"):
        missions_from_plan(example_plan(), Origin(22.0, 114.0, 0.0))


def test_plan_without_profile_is_given_the_one_whose_aircraft_and_camera_it_names() -> None:
    plan = replace(example_plan(), profile="")
    assert missions_from_plan(plan)[0].profile == "m3e"
    other = replace(plan, aircraft=replace(plan.aircraft, name="Homemade"))
    assert missions_from_plan(other)[0].profile == ""


def test_viewpoint_off_its_path_is_refused_because_its_photo_would_be_lost() -> None:
    plan = example_plan()
    path = [p for p in plan.sorties[0].path_enu_m if p != plan.viewpoints[3].position_enu_m]
    with pytest.raises(MissionError, match="sortie 1: viewpoint 'v0003' is not on the path"):
        missions_from_plan(with_path(plan, path))


def test_viewpoint_in_no_sortie_or_in_two_is_refused() -> None:
    plan = example_plan()
    with pytest.raises(MissionError, match="4 viewpoints are in no sortie"):
        missions_from_plan(replace(plan, sorties=plan.sorties[:1]))
    with pytest.raises(MissionError, match="in sortie 1 and again in sortie 2"):
        missions_from_plan(replace(plan, sorties=(plan.sorties[0], plan.sorties[0])))
    with pytest.raises(MissionError, match="no sorties"):
        missions_from_plan(replace(plan, viewpoints=(), sorties=()))


def test_path_that_does_not_start_at_home_is_refused_because_heights_count_from_there() -> None:
    plan = example_plan()
    path = list(plan.sorties[0].path_enu_m)
    with pytest.raises(MissionError, match=r"starts 30.0 m from home"):
        missions_from_plan(with_path(plan, [(HOME[0], HOME[1], HOME[2] + 30.0), *path[1:]]))
    with pytest.raises(MissionError, match="ends"):
        missions_from_plan(with_path(plan, path[:-1]))


def test_slanted_leg_at_home_is_refused_because_no_aircraft_flies_it() -> None:
    plan = example_plan()
    path = list(plan.sorties[0].path_enu_m)
    with pytest.raises(MissionError, match="starts with a slanted leg"):
        missions_from_plan(with_path(plan, [path[0], *path[2:]]))
    with pytest.raises(MissionError, match="ends with a slanted leg"):
        missions_from_plan(with_path(plan, [*path[:-2], path[-1]]))
    with pytest.raises(MissionError, match="2 points"):
        missions_from_plan(with_path(plan, path[:2]))


def test_pitch_that_the_camera_cannot_reach_is_refused() -> None:
    views = ring(3)
    views[1] = replace(views[1], gimbal_pitch_deg=36.0)
    with pytest.raises(MissionError, match=r"viewpoint 'v0001' needs a gimbal pitch of 36.0 deg.*-90 to 35"):
        missions_from_plan(make_plan([(views, {})]))


def test_sortie_without_views_is_a_mission_without_photos() -> None:
    plan = make_plan([(ring(3), {})])
    empty = Sortie((), plan.sorties[0].path_enu_m, 1.0, 1.0)
    assert missions_from_plan(replace(plan, sorties=(plan.sorties[0], empty)))[1].n_photos == 0
