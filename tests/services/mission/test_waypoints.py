"""Rows of the waypoint table: order, legs, arrivals, heights."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.mission import waypoints
from groundstation.services.mission.waypoints import HeightShown, waypoint_rows
from missions.mission.build import missions_from_plan
from missions.mission.model import altitude_amsl_m
from planning.plan import Viewpoint
from tests.missions.plans import HOME, HONG_KONG, example_plan, make_plan, plans


def test_rows_follow_the_path_and_name_every_photo_once():
    plan = example_plan()
    rows = waypoint_rows(plan)
    for number, sortie in enumerate(plan.sorties, 1):
        own = [row for row in rows if row.sortie == number]
        assert [row.position_enu_m for row in own] == list(sortie.path_enu_m)
        assert [row.viewpoint.id for row in own if row.viewpoint] == list(sortie.viewpoint_ids)
        assert [row.vertex for row in own] == list(range(len(sortie.path_enu_m)))


@pytest.mark.slow
@given(plans(), st.integers(0, 5))
def test_legs_add_up_to_the_length_and_arrivals_rise_to_the_duration(plan, seed):
    for number, sortie in enumerate(plan.sorties, 1):
        own = [row for row in waypoint_rows(plan) if row.sortie == number]
        assert sum(row.leg_m for row in own) == pytest.approx(sortie.length_m, abs=1e-6)
        arrivals = [row.arrival_s for row in own]
        assert arrivals[0] == 0.0
        assert all(math.isfinite(t) for t in arrivals)
        assert arrivals == sorted(arrivals)


@given(plans())
def test_heights_are_those_of_the_mission_that_is_flown(plan):
    rows = {row.viewpoint.id: row for row in waypoint_rows(plan) if row.viewpoint}
    for mission in missions_from_plan(plan):
        for waypoint in mission.waypoints:
            for photo in waypoint.photos:
                row = rows[photo.viewpoint_id]
                assert row.height_above_takeoff_m == pytest.approx(
                    mission.height_above_takeoff_m(waypoint.position), abs=2e-3
                )
                assert row.altitude_amsl_m == pytest.approx(altitude_amsl_m(waypoint.position), abs=2e-3)
                assert row.lat_deg == pytest.approx(waypoint.position.lat_deg, abs=2e-8)


def test_plan_without_origin_takes_the_sites_or_does_without():
    plan = replace(example_plan(), origin=None)
    row = waypoint_rows(plan)[3]
    assert row.lat_deg is None
    assert row.height_m(HeightShown.AMSL) is None
    assert row.height_above_takeoff_m == pytest.approx(row.position_enu_m[2] - HOME[2])
    assert waypoint_rows(plan, HONG_KONG) == waypoint_rows(example_plan())


def test_photos_at_one_place_share_their_vertex_and_follow_each_other():
    place = (10.0, 0.0, 25.0)
    views = [Viewpoint("a", place, 10.0, 0.0), Viewpoint("b", place, 80.0, -20.0)]
    rows = [row for row in waypoint_rows(make_plan([(views, {})])) if row.viewpoint]
    assert [row.leg_m for row in rows][1] == 0.0
    assert rows[1].arrival_s > rows[0].arrival_s


def test_viewpoints_off_the_path_or_in_no_sortie_are_listed_without_times():
    plan = example_plan()
    path = [p for p in plan.sorties[0].path_enu_m if p != plan.viewpoints[3].position_enu_m]
    broken = replace(plan, sorties=(replace(plan.sorties[0], path_enu_m=tuple(path)),))
    rows = waypoint_rows(broken)
    assert len(rows) == len(plan.viewpoints)
    assert {row.arrival_s for row in rows} == {None}
    assert {row.sortie for row in rows} == {0, 1}


def test_empty_plan_has_no_rows():
    assert waypoint_rows(replace(example_plan(), viewpoints=(), sorties=())) == ()


def test_wind_that_cannot_be_flown_in_leaves_arrivals_open():
    plan = example_plan()
    stormy = replace(plan, rules=replace(plan.rules, wind_m_s=50.0))
    assert {row.arrival_s for row in waypoint_rows(stormy)} == {None}


def test_after_an_edit_rows_of_other_sorties_are_those_that_were_there():
    plan = example_plan()
    assert len(plan.sorties) > 1
    before, edited = waypoint_rows(plan), plan.sorties[-1].viewpoint_ids[0]
    views = tuple(replace(view, heading_deg=17.0) if view.id == edited else view for view in plan.viewpoints)
    after = waypoint_rows(replace(plan, viewpoints=views))
    own = [number for number, row in enumerate(after) if row.viewpoint and row.viewpoint.id == edited]
    assert [after[number].viewpoint.heading_deg for number in own] == [17.0]
    assert all((new is old) == (new.sortie != len(plan.sorties)) for old, new in zip(before, after, strict=True))
    waypoints._sortie_rows.cache_clear()
    assert waypoint_rows(replace(plan, viewpoints=views)) == after
