"""The airframe flies as durations are computed, keeps its limits whatever it is told, and is exact at any step."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from missions.simulator.airframe.multirotor import GRAVITY_M_S2, Multirotor
from missions.simulator.airframe.state import Airframe, ExactReceiver, Fix, Parts, RateGimbal, SteadyPack, Target
from missions.simulator.build import make_airframe
from missions.simulator.fly_away import SteadyAir
from planning.geo.frames import Vec3
from planning.motion.timing import MotionLimits, rest_to_rest_s
from tests.missions.simulator.flying import bundled, fly, planned

LIMITS = MotionLimits(8.0, 3.0, 1.5, 2.5, math.radians(60.0), math.radians(30.0), 4.0)
HOME: Vec3 = (1.0, 2.0, 5.0)
TOP = Target((1.0, 2.0, 25.0), 8.0, 3.0, 1.5, 0.0, 1.0, 0.0)


def aircraft(
    limits: MotionLimits = LIMITS,
    heading_rad: float = 0.0,
    terrain_z_m: Callable[[float, float], float] | None = None,
) -> Multirotor:
    parts = Parts(
        gimbal=RateGimbal(limits.gimbal_rate_rad_s),
        pack=SteadyPack(5000.0, 15.4, 1500.0),
        receiver=ExactReceiver(Fix(6, 24, 0.01, 0.015)),
    )
    return Multirotor(
        limits, (math.radians(-90.0), math.radians(20.0)), HOME, parts, heading_rad, terrain_z_m=terrain_z_m
    )


def flown_to(target: Target, limits: MotionLimits = LIMITS) -> Multirotor:
    flown = aircraft(limits)
    flown.step(600.0, target)
    return flown


def test_it_is_an_airframe_that_stands_at_home() -> None:
    made: Airframe = aircraft()
    assert made.truth.position_enu_m == HOME
    assert made.estimate is made.truth
    assert made.wind_enu_m_s == (0.0, 0.0, 0.0)
    assert (made.battery.remaining, made.battery.current_a) == (1.0, 0.0)


@pytest.mark.few(1)
@pytest.mark.parametrize("profile_id", ["m3e", "ardupilot", "px4", "as planned"])
def test_a_sortie_takes_as_long_as_planned_and_photos_are_where_they_are_planned(profile_id: str) -> None:
    if profile_id == "as planned":
        model, plan = planned("office", 10)
    else:
        model, plan = bundled("canyon", profile_id=profile_id)
    sortie = plan.sorties[0]
    off = {"battery sag": "off"}
    made, _ = make_airframe(plan, model, sortie, settings=off)  # type: ignore[arg-type]
    shots, flown_s = fly(made, plan, sortie, step_s=0.02)
    predicted_s = sortie.duration_s - plan.rules.takeoff_landing_s
    # The plan charges half a turn before the first photo.
    assert 0.96 * predicted_s <= flown_s <= 1.02 * predicted_s
    assert len(shots) == len(sortie.viewpoint_ids)
    assert max(shot.error_m for shot in shots) < 1e-6
    assert max(shot.pitch_error_deg for shot in shots) < 1e-6
    turns = [
        math.remainder(shot.pose.gimbal_heading_rad - math.radians(shot.view.heading_deg), math.tau) for shot in shots
    ]
    assert max(map(abs, turns)) < 1e-9
    used = flown_s / plan.aircraft.endurance_s
    assert made.battery.remaining == pytest.approx(1.0 - used, abs=1e-9)


@pytest.mark.parametrize("step_s", [0.001, 0.013, 0.02, 0.2, 7.0])
def test_the_step_does_not_change_the_flight(step_s: float) -> None:
    """Targets change at the same times; in between every step gives the same motion, to less than a micrometre."""
    targets = [
        TOP,
        replace(TOP, position_enu_m=(30.0, -4.0, 12.0), heading_rad=3.0),
        replace(TOP, gimbal_pitch_rad=-1.0),
    ]
    stepped, whole = aircraft(), aircraft()
    for target in targets:
        left_s = 4.2
        while left_s > 1e-12:
            now_s = min(step_s, left_s)
            stepped.step(now_s, target)
            left_s -= now_s
        whole.step(4.2, target)
        assert stepped.truth.position_enu_m == pytest.approx(whole.truth.position_enu_m, abs=1e-6)
        assert stepped.truth.velocity_enu_m_s == pytest.approx(whole.truth.velocity_enu_m_s, abs=1e-6)
        assert stepped.truth.heading_rad == pytest.approx(whole.truth.heading_rad, abs=1e-9)
        assert stepped.truth.gimbal_pitch_rad == pytest.approx(whole.truth.gimbal_pitch_rad, abs=1e-9)
        assert stepped.battery.remaining == pytest.approx(whole.battery.remaining, abs=1e-12)


places = st.tuples(st.floats(-80.0, 80.0), st.floats(-80.0, 80.0), st.floats(-10.0, 60.0))
angles = st.floats(-20.0, 20.0)


@st.composite
def orders(draw: st.DrawFn) -> tuple[Target, float]:
    target = Target(
        draw(places),
        draw(st.floats(0.1, 50.0)),
        draw(st.floats(0.1, 50.0)),
        draw(st.floats(0.1, 50.0)),
        draw(angles),
        draw(st.floats(0.0, 10.0)),
        draw(st.floats(-4.0, 4.0)),
        passes=draw(st.booleans()),
        motors_on=draw(st.sampled_from((True, True, True, False))),
    )
    return target, draw(st.sampled_from((0.0, 0.001, 0.02, 0.2, 1.0, 5.0, 300.0)))


@given(st.lists(orders(), min_size=1, max_size=8), st.sampled_from((math.inf, 1.0, 30.0)))
def test_whatever_it_is_told_it_keeps_its_limits_and_stays_finite(
    told: list[tuple[Target, float]], jerk_m_s3: float
) -> None:
    flown = aircraft(replace(LIMITS, jerk_m_s3=jerk_m_s3))
    before = flown.truth
    has_fallen = False
    for target, duration_s in told:
        for _ in range(3):
            flown.step(duration_s / 3.0, target)
            pose = flown.truth
            numbers = (*pose.position_enu_m, *pose.velocity_enu_m_s, pose.heading_rad, pose.pitch_rad, pose.roll_rad)
            assert all(map(math.isfinite, (*numbers, pose.gimbal_pitch_rad, pose.yaw_rate_rad_s)))
            assert pose.position_enu_m[2] >= HOME[2]
            assert -math.pi < pose.heading_rad <= math.pi
            assert math.radians(-90.0) <= pose.gimbal_pitch_rad <= math.radians(20.0)
            turn = abs(math.remainder(pose.heading_rad - before.heading_rad, math.tau))
            assert turn <= LIMITS.yaw_rate_rad_s * duration_s / 3.0 + 1e-9
            tilt = abs(pose.gimbal_pitch_rad - before.gimbal_pitch_rad)
            assert tilt <= LIMITS.gimbal_rate_rad_s * duration_s / 3.0 + 1e-9
            # After a fall it is faster than it could fly.
            has_fallen = has_fallen or not target.motors_on
            if not has_fallen:
                vx, vy, vz = pose.velocity_enu_m_s
                assert math.hypot(vx, vy) <= LIMITS.horizontal_m_s * (1.0 + 1e-7) + 1e-6
                assert -LIMITS.descent_m_s - 1e-6 <= vz <= LIMITS.ascent_m_s + 1e-6
            assert 0.0 <= flown.battery.remaining <= 1.0
            before = pose
    flown.step(3600.0, replace(TOP, position_enu_m=(5.0, 5.0, 20.0)))
    assert flown.truth.position_enu_m == (5.0, 5.0, 20.0)
    assert flown.truth.velocity_enu_m_s == (0.0, 0.0, 0.0)


def test_a_leg_takes_the_time_of_rest_to_rest() -> None:
    flown = flown_to(TOP)
    predicted_s = float(rest_to_rest_s(40.0, 8.0, LIMITS.acceleration_m_s2, LIMITS.jerk_m_s3))
    goal = replace(TOP, position_enu_m=(41.0, 2.0, 25.0))
    flown.step(predicted_s - 0.05, goal)
    assert flown.truth.velocity_enu_m_s != (0.0, 0.0, 0.0)
    flown.step(0.05 + 1e-6, goal)
    assert flown.truth.position_enu_m == goal.position_enu_m


def test_it_turns_the_shorter_way_and_half_a_turn_clockwise() -> None:
    flown = aircraft(heading_rad=math.radians(170.0))
    flown.step(0.1, replace(TOP, heading_rad=math.radians(-170.0)))
    assert math.degrees(flown.truth.heading_rad) == pytest.approx(170.0 + math.degrees(0.1))
    assert flown.truth.yaw_rate_rad_s == pytest.approx(1.0)
    flown.step(10.0, replace(TOP, heading_rad=math.radians(-170.0)))
    assert math.degrees(flown.truth.heading_rad) == pytest.approx(-170.0)
    half = aircraft(heading_rad=math.radians(90.0))
    half.step(1.0, replace(TOP, heading_rad=math.radians(270.0), yaw_rate_rad_s=9.0))
    assert math.degrees(half.truth.heading_rad) == pytest.approx(150.0)


def test_it_leans_into_its_acceleration() -> None:
    flown = flown_to(TOP)
    # Off to the east with the nose to the north: right side down, 2.5 m/s2 against gravity.
    flown.step(1.0, replace(TOP, position_enu_m=(200.0, 2.0, 25.0)))
    assert flown.truth.roll_rad == pytest.approx(math.atan(2.5 / GRAVITY_M_S2))
    assert flown.truth.pitch_rad == pytest.approx(0.0, abs=1e-12)
    north = flown_to(TOP)
    north.step(1.0, replace(TOP, position_enu_m=(1.0, 200.0, 25.0)))
    assert north.truth.pitch_rad == pytest.approx(-math.atan(2.5 / GRAVITY_M_S2))


def test_the_gimbal_stops_at_its_limit() -> None:
    flown = aircraft()
    flown.step(60.0, replace(TOP, gimbal_pitch_rad=math.radians(45.0)))
    assert math.degrees(flown.truth.gimbal_pitch_rad) == pytest.approx(20.0)


def test_without_motors_it_falls_and_then_stands() -> None:
    flown = flown_to(TOP)
    off = replace(TOP, motors_on=False)
    flown.step(1.0, off)
    assert flown.truth.position_enu_m[2] == pytest.approx(25.0 - 0.5 * GRAVITY_M_S2)
    assert flown.truth.velocity_enu_m_s[2] == pytest.approx(-GRAVITY_M_S2)
    flown.step(60.0, off)
    assert flown.truth.position_enu_m == HOME
    assert flown.truth.velocity_enu_m_s == (0.0, 0.0, 0.0)
    assert flown.battery.current_a == 0.0


def test_a_fall_with_drag_takes_as_long_as_the_closed_form_says_and_drifts_with_the_wind() -> None:
    """Straight down from rest z(t) = ln cosh(t sqrt(g k)) / k; level, the body comes to fly with the air."""
    k, height_m, wind = 0.05, 80.0, (6.0, 0.0, 0.0)
    for air in (None, SteadyAir(wind)):
        parts = replace(aircraft()._parts, fall_drag_per_m=k, air=air)
        falls = Multirotor(LIMITS, (0.0, 0.0), (0.0, 0.0, height_m), parts, ground_z_m=0.0)
        off = replace(TOP, motors_on=False)
        ground_s = math.acosh(math.exp(k * height_m)) / math.sqrt(GRAVITY_M_S2 * k)
        falls.step(ground_s - 0.05, off)
        x, _, z = falls.truth.position_enu_m
        if air is None:
            fallen_m = math.log(math.cosh((ground_s - 0.05) * math.sqrt(GRAVITY_M_S2 * k))) / k
            assert z == pytest.approx(height_m - fallen_m, abs=0.01)
            assert x == 0.0
        else:
            assert 0.7 * 6.0 < falls.truth.velocity_enu_m_s[0] < 6.0
        falls.step(10.0, off)
        assert falls.truth.position_enu_m[2] == 0.0
        assert falls.truth.velocity_enu_m_s == (0.0, 0.0, 0.0)


def test_it_begins_with_a_velocity_and_falls_on_from_it() -> None:
    thrown = Multirotor(
        LIMITS, (0.0, 0.0), (0.0, 0.0, 20.0), aircraft()._parts, velocity_enu_m_s=(5.0, 0.0, 2.0), ground_z_m=0.0
    )
    thrown.step(60.0, replace(TOP, motors_on=False))
    fall_s = (2.0 + math.sqrt(4.0 + 2.0 * GRAVITY_M_S2 * 20.0)) / GRAVITY_M_S2
    assert thrown.truth.position_enu_m == pytest.approx((5.0 * fall_s, 0.0, 0.0))


def test_it_lands_on_the_ground_and_not_in_it() -> None:
    flown = flown_to(TOP)
    flown.step(600.0, replace(TOP, position_enu_m=(1.0, 2.0, -100.0)))
    assert flown.truth.position_enu_m == HOME


def test_a_photo_with_latency_is_taken_where_the_aircraft_then_is() -> None:
    ahead_s = 0.1 + 0.5 * 0.02
    parts = replace(aircraft()._parts, latency_s=0.1, exposure_s=0.02)
    flown = Multirotor(LIMITS, (-1.5, 0.3), HOME, parts)
    goal = replace(TOP, heading_rad=2.0, gimbal_pitch_rad=-1.0)
    flown.step(0.8, goal)
    pose, exposure_s = flown.shutter()
    assert exposure_s == 0.02
    flown.step(ahead_s, goal)
    assert pose.time_s == pytest.approx(flown.truth.time_s)
    assert pose.position_enu_m == pytest.approx(flown.truth.position_enu_m, abs=1e-12)
    assert (pose.heading_rad, pose.gimbal_pitch_rad) == pytest.approx(
        (flown.truth.heading_rad, flown.truth.gimbal_pitch_rad)
    )


@pytest.mark.parametrize(
    "wrong",
    [{"heading_rad": math.nan}, {"gimbal_pitch_rad": math.inf}, {"yaw_rate_rad_s": -1.0}, {"horizontal_m_s": 0.0}],
)
def test_a_target_that_makes_no_sense_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="expected"):
        aircraft().step(0.1, replace(TOP, **wrong))  # type: ignore[arg-type]


@pytest.mark.parametrize("duration_s", [-0.1, math.nan, math.inf])
def test_a_step_that_makes_no_sense_is_refused(duration_s: float) -> None:
    with pytest.raises(ValueError, match="duration_s"):
        aircraft().step(duration_s, TOP)


@pytest.mark.benchmark
def test_an_hour_of_flight_takes_seconds() -> None:
    model, plan = bundled("office", 40)
    made, _ = make_airframe(plan, model, plan.sorties[0], settings={"battery sag": "off"})
    started = time.perf_counter()
    _, flown_s = fly(made, plan, plan.sorties[0], step_s=0.02)
    assert (time.perf_counter() - started) / flown_s * 3600.0 < 10.0


@pytest.mark.parametrize(
    ("east_m", "wanted_m", "stands_m"), [(80.0, -5.0, -5.0), (-80.0, 2.0, 8.0), (80.0, -20.0, -8.0)]
)
def test_over_terrain_it_flies_below_home_and_not_into_the_slope(
    east_m: float, wanted_m: float, stands_m: float
) -> None:
    x, y, z = HOME
    # The ground falls by a tenth to the east and rises to the west.
    flown = aircraft(terrain_z_m=lambda at_x, _y: z - 0.1 * (at_x - x))
    for place in ((x, y, z + 20.0), (x + east_m, y, z + 20.0), (x + east_m, y, z + wanted_m)):
        flown.step(120.0, replace(TOP, position_enu_m=place))
    assert flown.truth.position_enu_m[2] - z == pytest.approx(stands_m, abs=1e-6)
