"""Times of legs and turns: worked by hand, against small steps of time, and at the edges."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linprog

from planning.aircraft.catalogue import profile
from planning.base.errors import InfeasibleError
from planning.motion.timing import (
    FlightPath,
    MotionLimits,
    flight_path,
    leg_times_s,
    motion_limits,
    photo_stop_s,
    rest_to_rest_s,
    round_trip_metric,
    slowed_by_turns_m_s,
    speed_limits_m_s,
    stopping_times_s,
    turn_times_s,
    usable_battery_s,
    with_turns_s,
)
from planning.parameters import FlightRules
from planning.plan import Aircraft

M3E = profile("m3e").aircraft
LIMITS = MotionLimits(10.0, 4.0, 3.0, 2.5, math.radians(60.0), math.radians(30.0))

metres = st.floats(-2000.0, 2000.0)


def stepped_s(length: float, speed: float, acceleration: float, step_s: float = 2e-5) -> float:
    """Time over a leg by small steps: accelerate unless too fast to brake in time or at the highest speed."""
    at = now = t = 0.0
    while at < length:
        braking = now * now / (2.0 * acceleration) >= length - at
        now = max(now - acceleration * step_s, 1e-6) if braking else min(now + acceleration * step_s, speed)
        at += now * step_s
        t += step_s
    return t


@pytest.mark.parametrize(
    ("delta", "seconds"),
    [
        ((10.0, 0.0, 0.0), 4.0),  # 2 sqrt(10 / 2.5): 5 m/s is the highest speed reached
        ((40.0, 0.0, 0.0), 8.0),  # 10 m/s is just reached
        ((60.0, 80.0, 0.0), 14.0),  # 100 / 10 + 10 / 2.5
        ((0.0, 0.0, 8.0), 3.6),  # 8 / 4 + 4 / 2.5
        ((0.0, 0.0, -8.0), 8.0 / 3.0 + 3.0 / 2.5),
        ((0.0, 0.0, 0.0), 0.0),
        ((30.0, 0.0, 40.0), 50.0 / 5.0 + 5.0 / 2.5),  # climbing at 4 m/s allows 5 m/s along the slope
        ((-80.0, 0.0, -6.0), math.hypot(80.0, 6.0) / (10.0 * math.hypot(1.0, 0.075)) + 4.0 * math.hypot(1.0, 0.075)),
    ],
)
def test_legs_take_what_is_worked_out_by_hand(delta: tuple[float, float, float], seconds: float) -> None:
    assert leg_times_s(np.array([delta]), LIMITS) == pytest.approx([seconds])


@pytest.mark.few(2)
@pytest.mark.parametrize(("length", "speed"), [(0.05, 5.0), (3.0, 5.0), (10.0, 5.0), (50.0, 5.0), (30.0, 12.0)])
def test_the_closed_form_agrees_with_small_steps_of_time(length: float, speed: float) -> None:
    assert rest_to_rest_s(length, speed, 2.5) == pytest.approx(stepped_s(length, speed, 2.5), rel=1e-2)


def furthest_m(seconds: float, speed: float, acceleration: float, jerk: float, n_steps: int = 120) -> float:
    """How far one gets from rest to rest in a given time: a linear program over jerks that change `n_steps` times."""
    step_s = seconds / n_steps
    accelerations = np.tri(n_steps) * step_s
    speeds = (np.cumsum(accelerations, axis=0) - accelerations / 2.0) * step_s
    path = speeds.sum(axis=0) * step_s
    limits = np.concatenate([np.full(2 * n_steps, acceleration), np.full(2 * n_steps, speed)])
    found = linprog(
        -path,
        A_ub=np.vstack([accelerations, -accelerations, speeds, -speeds]),
        b_ub=limits,
        A_eq=np.vstack([accelerations[-1], speeds[-1]]),
        b_eq=[0.0, 0.0],
        bounds=(-jerk, jerk),
    )
    return float(-found.fun)


@pytest.mark.parametrize(("speed", "jerk"), [(10.0, 1.0), (1.0, 1.0), (5.0, 4.0), (10.0, 40.0)])
@pytest.mark.parametrize("seconds", [1.0, 4.0, 9.0, 20.0])
def test_with_limited_jerk_no_program_gets_further(speed: float, jerk: float, seconds: float) -> None:
    length = furthest_m(seconds, speed, 2.5, jerk)
    assert rest_to_rest_s(length, speed, 2.5, jerk) == pytest.approx(seconds, rel=6e-3)


@pytest.mark.parametrize(
    ("length", "speed", "seconds"),
    [
        (2.0, 10.0, 4.0),  # neither limit is reached: 4 (2 / 2)^(1/3)
        (31.25, 10.0, 10.0),  # the acceleration is just reached: 2 a^3 / j^2, four times 2.5 s
        (100.0, 10.0, 16.5),  # 100 / 10 + 10 / 2.5 + 2.5
        (20.0, 4.0, 9.0),  # the speed is reached, the acceleration not: 20 / 4 + 2 sqrt(4)
        (0.0, 10.0, 0.0),
    ],
)
def test_limited_jerk_takes_what_is_worked_out_by_hand(length: float, speed: float, seconds: float) -> None:
    assert rest_to_rest_s(length, speed, 2.5, 1.0) == pytest.approx(seconds)


@given(length=st.floats(0.0, 2000.0), speed=st.floats(0.01, 20.0), jerk=st.floats(0.1, 1e6))
def test_jerk_only_ever_costs_time_and_the_less_the_higher_it_may_be(length: float, speed: float, jerk: float) -> None:
    at_once, limited, looser = (rest_to_rest_s(length, speed, 2.5, j) for j in (math.inf, jerk, 2.0 * jerk))
    assert at_once <= looser * (1.0 + 1e-12)
    assert looser <= limited * (1.0 + 1e-12)
    # All forms meet: a little more of anything takes a little more time.
    assert rest_to_rest_s(length * (1.0 + 1e-9), speed, 2.5, jerk) == pytest.approx(limited, rel=1e-8)
    assert rest_to_rest_s(length, speed * (1.0 + 1e-9), 2.5, jerk) == pytest.approx(limited, rel=1e-8)


def test_both_forms_meet_where_the_highest_speed_is_just_reached() -> None:
    length = 10.0**2 / 2.5
    nearby = rest_to_rest_s(length * (1.0 + np.array([-1e-9, 0.0, 1e-9])), 10.0, 2.5)
    assert nearby == pytest.approx(8.0, rel=1e-8)


@given(x=metres, y=metres, z=metres)
def test_a_leg_is_never_faster_than_its_limits(x: float, y: float, z: float) -> None:
    delta = np.array([[x, y, z]])
    speed, seconds = speed_limits_m_s(delta, LIMITS)[0], leg_times_s(delta, LIMITS)[0]
    length = math.hypot(x, y, z)
    assert np.isfinite(seconds)
    assert seconds >= length / speed - 1e-9
    assert seconds >= 2.0 * math.sqrt(length / 2.5) - 1e-9
    if length > 0.0:
        assert speed * math.hypot(x, y) / length <= 10.0 * (1.0 + 1e-12)
        assert -3.0 * (1.0 + 1e-12) <= speed * z / length <= 4.0 * (1.0 + 1e-12)
        # One of the limits is reached.
        used = max(speed * math.hypot(x, y) / length / 10.0, speed * z / length / 4.0, -speed * z / length / 3.0)
        assert used == pytest.approx(1.0)


@pytest.mark.parametrize("delta", [(1e-300, 0.0, 0.0), (0.0, 0.0, 5e-324), (1e-3, 0.0, 0.0), (0.0, 1e-12, 1e5)])
def test_tiny_and_lopsided_legs_stay_finite(delta: tuple[float, float, float]) -> None:
    assert np.isfinite(leg_times_s(np.array([delta]), LIMITS)).all()
    assert (speed_limits_m_s(np.array([delta]), LIMITS) > 0.0).all()


def test_no_legs_take_no_time() -> None:
    assert leg_times_s(np.zeros((0, 3)), LIMITS).shape == (0,)


def test_the_table_metric_is_the_same_in_both_directions() -> None:
    deltas = np.random.default_rng(0).normal(size=(50, 3)) * 30.0
    metric = round_trip_metric(LIMITS)
    assert np.array_equal(metric(deltas), metric(-deltas))
    assert metric(deltas) + metric(-deltas) == pytest.approx(leg_times_s(deltas, LIMITS) + leg_times_s(-deltas, LIMITS))


def test_wind_slows_level_legs_and_not_climbs() -> None:
    calm, windy = (motion_limits(M3E, FlightRules(wind_m_s=wind)) for wind in (0.0, 8.0))
    assert calm.horizontal_m_s == 15.0
    assert windy.horizontal_m_s == 7.0
    level, up = np.array([[500.0, 0.0, 0.0]]), np.array([[0.0, 0.0, 50.0]])
    assert leg_times_s(level, windy) > leg_times_s(level, calm)
    assert leg_times_s(up, windy) == leg_times_s(up, calm)


def test_a_lower_speed_holds_in_all_directions_and_leaves_room_for_wind() -> None:
    slow = motion_limits(M3E, FlightRules(max_speed_m_s=3.0, wind_m_s=8.0))
    assert (slow.horizontal_m_s, slow.ascent_m_s, slow.descent_m_s) == (3.0, 3.0, 3.0)


@pytest.mark.parametrize("wind_m_s", [12.0, 13.0])
def test_wind_at_the_limit_is_refused(wind_m_s: float) -> None:
    with pytest.raises(InfeasibleError, match=r"DJI M3E may fly in wind below 12 m/s, but 1[23] m/s are expected"):
        motion_limits(M3E, FlightRules(wind_m_s=wind_m_s))


def test_wind_that_leaves_no_headway_is_refused() -> None:
    kite = Aircraft("kite", 1000.0, 5.0, max_wind_m_s=12.0)
    with pytest.raises(InfeasibleError, match="makes no headway against 5 m/s"):
        motion_limits(kite, FlightRules(wind_m_s=5.0))


def test_the_usable_battery_is_endurance_less_reserve_and_take_off() -> None:
    assert usable_battery_s(M3E, FlightRules(battery_reserve=0.25, takeoff_landing_s=30.0)) == 2520.0 * 0.75 - 30.0
    with pytest.raises(InfeasibleError, match=r"a reserve of 99% and 30 s for take-off and landing leave nothing"):
        usable_battery_s(M3E, FlightRules(battery_reserve=0.99))


def test_a_photo_stop_lasts_at_least_the_shortest_interval() -> None:
    assert photo_stop_s(M3E, FlightRules(settle_s=2.0, photo_s=1.0)) == 3.0
    assert photo_stop_s(M3E, FlightRules(settle_s=0.0, photo_s=0.1)) == 0.7


def test_heading_and_gimbal_turn_together() -> None:
    seconds = turn_times_s(np.radians([90.0, -90.0, 10.0]), np.radians([0.0, 60.0, -45.0]), LIMITS)
    assert seconds == pytest.approx([1.5, 2.0, 1.5])


def test_turns_go_the_short_way_round() -> None:
    heading, pitch = np.radians([170.0, -170.0]), np.zeros(2)
    travel = with_turns_s(np.zeros((3, 3)), heading, pitch, LIMITS, turn_in_flight=False)
    assert travel[1, 2] == travel[2, 1] == pytest.approx(20.0 / 60.0)
    assert travel[0, 1] == pytest.approx(3.0)  # half a turn: the heading after take-off is not known
    assert travel[1, 0] == 0.0


@given(length=st.floats(0.0, 200.0), turn_deg=st.floats(0.0, 180.0), jerk=st.sampled_from([1.0, 4.0, math.inf]))
def test_turning_in_flight_is_never_underrated_and_exact_on_short_legs(
    length: float, turn_deg: float, jerk: float
) -> None:
    limits = dataclasses.replace(LIMITS, jerk_m_s3=jerk)
    vertices = np.array([[0.0, 0.0, 50.0], [length, 0.0, 50.0]])
    turn_s = turn_deg / 60.0
    path = FlightPath(vertices, np.ones(2, np.bool_), np.zeros(2), np.array([turn_s]))
    exact = stopping_times_s(path, limits)[-1]
    leg = np.zeros((3, 3))
    leg[1, 2] = leg[2, 1] = leg_times_s(np.array([[length, 0.0, 0.0]]), limits)[0]
    table = with_turns_s(leg, np.radians([0.0, turn_deg]), np.zeros(2), limits, turn_in_flight=True)[1, 2]
    assert exact <= table * (1.0 + 1e-9) + 1e-9
    assert max(turn_s, leg[1, 2]) <= exact * (1.0 + 1e-9) + 1e-9
    if length <= 40.0 and math.isinf(jerk):
        assert table == pytest.approx(exact, rel=1e-9, abs=1e-9)
    assert table <= 1.25 * exact + 1e-9


def sortie(turn_in_flight: bool, *, stop_at_corners: bool = True) -> FlightPath:
    """Home, a corner, two photos facing opposite ways, home."""
    vertices = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 20.0], [30.0, 0.0, 20.0], [30.0, 10.0, 20.0], [0.0, 0.0, 0.0]])
    rules = FlightRules(settle_s=2.0, photo_s=1.0, turn_in_flight=turn_in_flight)
    return flight_path(
        vertices,
        np.array([2, 3]),
        np.radians([0.0, 180.0]),
        np.radians([-30.0, 0.0]),
        M3E,
        rules,
        stop_at_corners=stop_at_corners,
    )


def test_a_sortie_hovers_and_turns_at_its_photos() -> None:
    path = sortie(turn_in_flight=False)
    assert path.is_stop.all()
    assert path.hover_s == pytest.approx([0.0, 0.0, 3.0 + 3.0, 3.0 + 3.0, 0.0])
    assert path.turn_s.tolist() == [0.0, 0.0, 0.0, 0.0]
    limits = motion_limits(M3E, FlightRules())
    arrival = stopping_times_s(path, limits)
    legs = leg_times_s(path.deltas_enu_m, limits)
    assert arrival == pytest.approx([0.0, legs[0], legs[:2].sum(), legs[:3].sum() + 6.0, legs.sum() + 12.0])


def test_a_turn_in_flight_is_spread_along_all_legs_before_the_photo() -> None:
    path = sortie(turn_in_flight=True)
    assert path.hover_s == pytest.approx([0.0, 0.0, 3.0, 3.0, 0.0])
    assert path.turn_s == pytest.approx([3.0 * 20.0 / 50.0, 3.0 * 30.0 / 50.0, 3.0, 0.0])
    limits = motion_limits(M3E, FlightRules())
    assert slowed_by_turns_m_s(path, limits)[2] == pytest.approx(10.0 / 3.0)
    at_photos, in_flight = (stopping_times_s(sortie(turn), limits)[-1] for turn in (False, True))
    assert in_flight < at_photos


def test_corners_are_flown_through_only_where_no_photo_is_taken() -> None:
    assert sortie(False, stop_at_corners=False).is_stop.tolist() == [True, False, True, True, True]


def test_photos_at_one_place_turn_on_the_spot() -> None:
    vertices = np.array([[0.0, 0.0, 0.0], [5.0, 0.0, 0.0], [5.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    rules = FlightRules(settle_s=0.0, photo_s=1.0, turn_in_flight=True)
    path = flight_path(vertices, np.array([1, 2]), np.radians([0.0, 120.0]), np.zeros(2), M3E, rules)
    assert path.hover_s == pytest.approx([0.0, 1.0, 3.0, 0.0])
    assert np.isfinite(stopping_times_s(path, motion_limits(M3E, rules))).all()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"vertices_enu_m": np.full((2, 3), np.nan)}, "vertices_enu_m: expected finite"),
        ({"is_stop": np.array([True, False])}, "expected a stop at both ends"),
        ({"hover_s": np.array([-1.0, 0.0])}, "hover_s: expected finite times"),
        ({"turn_s": np.array([np.inf])}, "turn_s: expected finite times"),
        ({"turn_s": np.zeros(2)}, r"turn_s: expected shape \(1,\)"),
    ],
)
def test_wrong_paths_are_refused(change: dict[str, np.ndarray], message: str) -> None:
    good = {
        "vertices_enu_m": np.zeros((2, 3)),
        "is_stop": np.ones(2, np.bool_),
        "hover_s": np.zeros(2),
        "turn_s": np.zeros(1),
    }
    with pytest.raises(ValueError, match=message):
        FlightPath(**{**good, **change})


def test_limits_must_be_positive() -> None:
    with pytest.raises(ValueError, match="yaw_rate_rad_s: expected a positive number"):
        dataclasses.replace(LIMITS, yaw_rate_rad_s=0.0)
