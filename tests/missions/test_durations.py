"""How long missions of other programs take, by what they tell the aircraft to do, and by what their files state."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from missions.formats.registry import encode, read_missions
from missions.mavlink.items import MavlinkFile, MissionItem, plain
from missions.mavlink.read import read_mavlink
from missions.mission.build import missions_from_plan
from missions.mission.export_choices import FileFormat
from missions.mission.model import ReadMission, Stay
from missions.mission.to_plan import CORNER_SHARE, PlanParts, flown_s, timed_route, viewpoints_and_sorties
from planning.aircraft.catalogue import profile
from planning.checks import check_plan
from planning.geo.frames import Origin
from planning.motion.timing import MotionLimits, leg_times_s
from planning.parameters import FlightRules
from planning.plan import Plan, read_plan, write_plan
from planning.site.bundled import SCENES
from tests.missions.mavlink.test_fly import EAST_100_M, FIRST, HOME, NORTH_100_M, SECOND, TAKEOFF, at, read
from tests.missions.plans import make_plan

M3E = profile("m3e").aircraft
LIMITS = MotionLimits(15.0, 6.0, 6.0, 2.5, 1.0, 1.0)

STATED = {
    "djisdk_psdk_m3e_waypoint_v3_test.kmz": 0.15,
    "geoyee_m3d_curtainwall_slope_mapping2d.kmz": 0.15,
    "traitlab_m3e_pilot2_Waypoint2_rtk": 0.15,
    "tum_m4td_fh2_waypoint_rotateyaw_photo": 0.15,
    # States 35.8 s for 192 m at 5 m/s, which take 38.5 s without a stop.
    "djisdk_msdk_m30_waypointsample.kmz": 0.25,
    # Leaves out what turning nose and gimbal for 16 aimed photos takes, most of them at waypoints that it passes.
    "geoyee_m3t_waypoint.kmz": 0.90,
}
"""Files that state a time, and by how much ours may differ."""


def parts_of(mission: ReadMission) -> PlanParts:
    """A mission on a site whose home lies below its first waypoint."""
    first = mission.waypoints[0]
    height_m = 100.0 if first.height_ellipsoid_m is None else first.height_ellipsoid_m - 50.0
    return viewpoints_and_sorties([mission], Origin(first.lat_deg, first.lon_deg, height_m), (0.0, 0.0, 0.0))


@pytest.mark.parametrize("name", STATED)
def test_real_routes_take_about_as_long_as_their_files_state(shared_data: Path, name: str) -> None:
    (mission,) = read_missions(shared_data / "missions" / name)
    told = [finding for finding in parts_of(mission).findings if finding.code == "stated-time"]
    assert len(told) == 1
    stated_s, ours_s = told[0].value, told[0].limit
    assert stated_s is not None
    assert ours_s is not None
    assert abs(ours_s / stated_s - 1.0) <= STATED[name]


@pytest.mark.parametrize(
    "trigger",
    [plain(206, 7.0, 0, 1), plain(206, 2.0), plain(214, 700.0), plain(2000, 0, 1.0, 0), plain(2000, 0, 2.0, 4)],
    ids=["distance", "short distance", "interval", "capture", "four captures"],
)
def test_photos_by_time_or_distance_cost_no_time(trigger: MissionItem) -> None:
    items = (TAKEOFF, FIRST, SECOND, at(16, 52.0, EAST_100_M))
    without = parts_of(read(*items, speed=8.0)).sorties[0]
    parts = parts_of(read(items[0], items[1], trigger, *items[2:], speed=8.0))
    (sortie,) = parts.sorties
    assert len(parts.viewpoints) >= 3
    assert set(sortie.in_passing_ids) == set(sortie.viewpoint_ids)
    assert sortie.duration_s == pytest.approx(without.duration_s, abs=0.01)


def test_photos_at_waypoints_stop_only_where_the_vehicle_does() -> None:
    shoot = plain(203, 0, 0, 0, 0, 1)
    passing = parts_of(read(TAKEOFF, FIRST, shoot, SECOND, shoot, at(16, 52.0, EAST_100_M), speed=8.0)).sorties[0]
    holding = parts_of(
        read(TAKEOFF, at(16, NORTH_100_M, 5.0, 30.0, 4.0), shoot, SECOND, shoot, at(16, 52.0, EAST_100_M), speed=8.0)
    ).sorties[0]
    assert len(passing.in_passing_ids) == 2
    assert len(holding.in_passing_ids) == 1
    assert holding.duration_s > passing.duration_s + 3.0


def test_a_delay_is_a_stop_and_lasts_as_long_as_it_says() -> None:
    delay = [parts_of(read(TAKEOFF, FIRST, plain(93, s), SECOND, speed=8.0)).sorties[0].duration_s for s in (5.0, 25.0)]
    assert delay[1] - delay[0] == pytest.approx(20.0)


def test_speeds_changed_on_the_way_hold_from_there_on() -> None:
    times = {}
    for speed in (None, 2.0):
        change = () if speed is None else (plain(178, 1, speed),)
        mission = read(TAKEOFF, FIRST, *change, SECOND, at(16, NORTH_100_M, 5.0 + 2.0 * (EAST_100_M - 5.0)), speed=8.0)
        assert mission.speed_m_s == 8.0
        times[speed] = parts_of(mission).sorties[0].duration_s
    # 200 m at 2 instead of 8 m/s, but for what braking from 8 m/s took.
    assert times[2.0] - times[None] == pytest.approx(200.0 / 2.0 - 200.0 / 8.0, abs=4.0)


# --- the model of time ---

PLACES = st.lists(
    st.tuples(st.floats(-80.0, 80.0), st.floats(-80.0, 80.0), st.floats(0.0, 40.0)), min_size=2, max_size=8
)


def lengths(places: list[tuple[float, float, float]]) -> np.ndarray:
    return np.linalg.norm(np.diff(np.array(places), axis=0), axis=1)


@given(places=PLACES, speed=st.floats(0.5, 15.0), cut=st.floats(0.0, 20.0))
def test_flying_through_is_hardly_slower_than_stopping_and_no_faster_than_the_speed_allows(
    places: list[tuple[float, float, float]], speed: float, cut: float
) -> None:
    stops = flown_s(timed_route(places, [Stay()] * len(places), speed), LIMITS)
    through = flown_s(timed_route(places, [Stay(cut)] * len(places), speed), LIMITS)
    # A narrow arc may take a little longer than stopping, as it is flown with half of the acceleration.
    assert through <= 1.1 * stops + 0.1
    # A corner saves at most the difference between twice its cut and nothing.
    shortest = float((lengths(places)).sum()) - 2.0 * cut * max(0, len(places) - 2)
    assert through >= max(0.0, shortest) / speed - 0.02


@given(places=PLACES)
def test_stopping_everywhere_is_what_plans_reckon_with(places: list[tuple[float, float, float]]) -> None:
    legs = leg_times_s(np.diff(np.array(places), axis=0), LIMITS)
    assert flown_s(timed_route(places, [Stay()] * len(places), 1000.0), LIMITS) == pytest.approx(
        float(legs.sum()), abs=1e-3 * len(places)
    )


@given(places=PLACES, shares=st.lists(st.floats(0.05, 0.95), min_size=1, max_size=5))
def test_places_on_a_leg_change_nothing(places: list[tuple[float, float, float]], shares: list[float]) -> None:
    stays = [Stay(3.0)] * len(places)
    plain_s = flown_s(timed_route(places, stays, 6.0), LIMITS)
    start, end = np.array(places[0]), np.array(places[1])
    if np.linalg.norm(end - start) < 1.0:
        return
    between = [tuple((start + share * (end - start)).tolist()) for share in sorted(shares)]
    more = [places[0], *between, *places[1:]]
    dense = [Stay(3.0), *[Stay(math.inf)] * len(between), *stays[1:]]
    assert flown_s(timed_route(more, dense, 6.0), LIMITS) == pytest.approx(plain_s, abs=0.05)


@given(speed=st.floats(1.0, 12.0), radius=st.floats(0.5, 10.0))
def test_a_corner_takes_as_long_as_a_slow_integration_says(speed: float, radius: float) -> None:
    """A right angle cut by an arc: accelerate, brake to the arc's speed, around it, accelerate, brake; step by step."""
    a, length = LIMITS.acceleration_m_s2, 60.0
    corner = min(speed, math.sqrt(CORNER_SHARE * a * radius))
    straight = length - radius
    steps = np.linspace(0.0, straight, 20_001)
    middle = (steps[1:] + steps[:-1]) / 2.0
    reached = np.minimum(np.sqrt(2.0 * a * middle), np.sqrt(corner**2 + 2.0 * a * (straight - middle)))
    one_s = float((np.diff(steps) / np.minimum(reached, speed)).sum())
    expected = 2.0 * one_s + radius * math.pi / 2.0 / corner
    places = [(0.0, 0.0, 10.0), (length, 0.0, 10.0), (length, length, 10.0)]
    found = flown_s(timed_route(places, [Stay(), Stay(radius), Stay()], speed), LIMITS)
    assert found == pytest.approx(expected, rel=2e-3)


# --- what becomes of photos in passing ---


def survey() -> Plan:
    """Photos in passing, every 10 m along 100 m, as a plan."""
    model = SCENES["roof"]()
    items = (TAKEOFF, FIRST, plain(206, 10.0, 0, 1), SECOND, plain(206, 0.0), plain(20))
    mission = read_mavlink(Path("m.plan"), MavlinkFile(items, HOME, None, 5.0), FileFormat.MAVLINK_PLAN)
    site = replace(model.site, origin=Origin(HOME.lat_deg, HOME.lon_deg, HOME.height_ellipsoid_m), home_enu_m=(0, 0, 0))
    parts = viewpoints_and_sorties([mission], site.origin, site.home_enu_m, FlightRules(), M3E)
    plan = make_plan([])
    return replace(plan, viewpoints=parts.viewpoints, sorties=parts.sorties, origin=site.origin, home_enu_m=(0, 0, 0))


def test_plans_keep_which_photos_are_taken_in_passing(tmp_path: Path) -> None:
    plan = survey()
    assert 10 <= len(plan.sorties[0].in_passing_ids) == len(plan.viewpoints)
    write_plan(tmp_path / "p.json", plan)
    assert read_plan(tmp_path / "p.json").sorties == plan.sorties


def test_the_check_of_a_plan_reckons_no_stop_for_them() -> None:
    plan, model = survey(), SCENES["roof"]()
    model = replace(model, site=replace(model.site, origin=plan.origin, home_enu_m=(0.0, 0.0, 0.0)))
    stopping = replace(plan, sorties=(replace(plan.sorties[0], in_passing_ids=()),))
    needed = []
    for each in (plan, stopping):
        (found,) = [f for f in check_plan(each, model) if f.code == "endurance"]
        needed.append(found.value)
    assert needed[0] == pytest.approx(plan.sorties[0].duration_s)
    assert needed[1] > needed[0] + 10 * 2.5


def test_files_of_ours_stop_for_them_and_say_so() -> None:
    plan = survey()
    (mission,) = missions_from_plan(plan, plan.origin, plan.home_enu_m)
    assert mission.duration_s > plan.sorties[0].duration_s + 10 * 2.5
    encoded = encode(plan, plan.origin, plan.home_enu_m, FileFormat.CSV)
    (told,) = [finding for finding in encoded.findings if finding.code == "in-passing"]
    assert f"{len(plan.viewpoints)} photos" in told.message
    assert told.value == pytest.approx(mission.duration_s)
