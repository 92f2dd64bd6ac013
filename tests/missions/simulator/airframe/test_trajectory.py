"""Trajectories reach their target within all limits, as fast as flight durations say, and at any step alike."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from missions.simulator.airframe.trajectory import JERK_RAMP_S, PASS_OVERSHOOT_M, State, Trajectory, plan_trajectory
from planning.geo.frames import Vec3
from planning.motion.timing import MotionLimits, leg_times_s

ORIGIN: Vec3 = (0.0, 0.0, 0.0)
AT_REST: State = (ORIGIN, ORIGIN, ORIGIN)
SPEEDS = (8.0, 3.0, 1.5)


def vectors(most: float) -> st.SearchStrategy[Vec3]:
    return st.tuples(*[st.floats(-most, most, allow_nan=False)] * 3)


accelerations = st.floats(0.01, 20.0)
jerks = st.one_of(st.floats(0.05, 200.0), st.just(math.inf))


def samples(trajectory: Trajectory, n: int = 40) -> list[tuple[float, State]]:
    """Times inside and at the ends of all pieces, with the motion there."""
    ends = [*trajectory.starts_s, trajectory.end_s + 1.0]
    times = sorted({t for a, b in itertools.pairwise(ends) for t in np.linspace(a, b, n).tolist()})
    return [(t, trajectory.at(t)) for t in times]


def assert_within_limits(trajectory: Trajectory, speeds: Vec3, acceleration: float, jerk: float) -> None:
    for _, (position, (vx, vy, vz), a) in samples(trajectory):
        assert all(map(math.isfinite, (*position, vx, vy, vz, *a)))
        slack = 1e-7 * (1.0 + speeds[0])
        assert math.hypot(vx, vy) <= speeds[0] * (1.0 + 1e-9) + slack
        assert -speeds[2] * (1.0 + 1e-9) - slack <= vz <= speeds[1] * (1.0 + 1e-9) + slack
        assert math.hypot(*a) <= acceleration * (1.0 + 1e-6) + 1e-9
    bound = jerk if math.isfinite(jerk) else acceleration / JERK_RAMP_S
    assert all(math.hypot(*piece[10:13]) <= bound * (1.0 + 1e-9) for piece in trajectory.pieces)


@given(vectors(2000.0), accelerations, jerks)
@example((0.0, 0.0, 1e-5), 2.5, 1.0)
@example((5.0, 0.0, 0.0), 0.01, math.inf)
def test_a_leg_from_rest_takes_as_long_as_durations_are_computed_with(
    delta: Vec3, acceleration: float, jerk: float
) -> None:
    found = plan_trajectory(AT_REST, delta, SPEEDS, acceleration, jerk)
    limits = MotionLimits(*SPEEDS, acceleration, 1.0, 1.0, jerk)
    predicted_s = float(leg_times_s(np.array([delta]), limits)[0])
    tolerance_s = 1e-6 if math.isfinite(jerk) else 4.0 * JERK_RAMP_S
    if math.hypot(*delta) > 1e-5:
        assert found.end_s == pytest.approx(predicted_s, rel=1e-9, abs=tolerance_s)
    assert found.at(found.end_s)[0] == delta
    assert found.at(found.end_s + 100.0) == (delta, ORIGIN, ORIGIN)
    assert_within_limits(found, SPEEDS, acceleration, jerk)


@given(vectors(100.0), vectors(100.0), st.floats(0.0, 1.0), accelerations, jerks, st.booleans())
@example((100.0, 0.0, 0.0), (-100.0, 0.0, 0.0), 0.3, 2.5, 1.0, False)  # back where it came from, at speed
@example((100.0, 0.0, 0.0), (10.0, 0.0, 0.0), 0.5, 2.5, 1.0, True)
@example((100.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.2, 2.5, 1.0, False)
@example((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 2.5, 1.0, True)
def test_a_new_target_on_the_way_is_reached_within_all_limits(
    first: Vec3, second: Vec3, share: float, acceleration: float, jerk: float, passes: bool
) -> None:
    leg = plan_trajectory(AT_REST, first, SPEEDS, acceleration, jerk)
    state = leg.at(share * leg.end_s)
    for _ in range(3):
        found = plan_trajectory(state, second, SPEEDS, acceleration, jerk, passes=passes)
        assert_within_limits(found, SPEEDS, acceleration, jerk)
        for (t0, (p0, v0, a0)), (t1, (p1, v1, a1)) in itertools.pairwise(samples(found)):
            # Continuous: positions, velocities and accelerations change by no more than their rates allow.
            dt = t1 - t0
            assert math.dist(p0, p1) <= dt * max(math.hypot(*v0), math.hypot(*v1)) * 1.5 + 1e-6 + dt * dt * 30.0
            assert math.dist(v0, v1) <= dt * acceleration * (1.0 + 1e-6) + 1e-7
            bound = jerk if math.isfinite(jerk) else acceleration / JERK_RAMP_S
            assert math.dist(a0, a1) <= dt * bound * (1.0 + 1e-6) + 1e-6
        state, passes = found.at(found.end_s), False
        if state[0] == second:
            break
    assert state == (second, ORIGIN, ORIGIN)


@given(vectors(200.0), st.floats(0.0, 1.0), accelerations, jerks)
@example((0.0, 0.0, 0.375), 0.3125, 0.0625, 0.0625)  # while it still accelerates
@example((0.0, 1.5, 0.5), 0.125, 1.0, 1.0)  # acceleration along the way but for rounding
def test_planning_anew_on_the_way_changes_nothing(delta: Vec3, share: float, acceleration: float, jerk: float) -> None:
    leg = plan_trajectory(AT_REST, delta, SPEEDS, acceleration, jerk)
    at_s = share * leg.end_s
    state = leg.at(at_s)
    again_s = at_s
    for _ in range(2):
        found = plan_trajectory(state, delta, SPEEDS, acceleration, jerk)
        again_s, state = again_s + found.end_s, found.at(found.end_s)
    assert state[0] == delta
    assert again_s <= leg.end_s * (1.0 + 1e-5) + (1e-4 if math.isfinite(jerk) else 5.0 * JERK_RAMP_S)


@given(st.floats(5.0, 500.0), accelerations, jerks)
@example(5.0, 16.0, 0.125)  # the jerk alone decides: braking from v takes v sqrt(v / jerk)
def test_a_target_that_is_passed_is_passed_at_a_speed_from_which_it_could_stop_nearby(
    length_m: float, acceleration: float, jerk: float
) -> None:
    found = plan_trajectory(AT_REST, (length_m, 0.0, 0.0), SPEEDS, acceleration, jerk, passes=True)
    motion = [(state[0][0], state[1][0]) for _, state in samples(found, 100)]
    x, speed = np.array(motion).T
    by_jerk = (PASS_OVERSHOOT_M * math.sqrt(jerk)) ** (2.0 / 3.0)
    assert float(np.interp(length_m, x, speed)) > 0.2 * min(SPEEDS[0], math.sqrt(acceleration), by_jerk)
    assert length_m < x[-1] <= length_m + PASS_OVERSHOOT_M + 1e-6
    assert speed[-1] == 0.0


def test_a_target_too_near_to_stop_at_is_overshot_and_come_back_to_in_the_shortest_time() -> None:
    """From 8 m/s, 1 m before the target: 3.2 s to stop 12.8 m on, and 2 sqrt(11.8 / 2.5) s back."""
    found = plan_trajectory((ORIGIN, (8.0, 0.0, 0.0), ORIGIN), (1.0, 0.0, 0.0), SPEEDS, 2.5, math.inf)
    assert found.at(found.end_s)[0] == (1.0, 0.0, 0.0)
    assert max(state[0][0] for _, state in samples(found)) == pytest.approx(12.8, abs=0.05)
    assert found.end_s == pytest.approx(3.2 + 2.0 * math.sqrt(11.8 / 2.5), abs=0.01)


def test_speed_that_is_there_is_kept() -> None:
    found = plan_trajectory((ORIGIN, (8.0, 0.0, 0.0), ORIGIN), (50.0, 0.0, 0.0), SPEEDS, 2.5, math.inf)
    assert found.end_s == pytest.approx(50.0 / 8.0 + 0.5 * 8.0 / 2.5, abs=0.01)


@pytest.mark.parametrize(
    ("target", "speeds", "acceleration", "jerk"),
    [
        ((math.nan, 0.0, 0.0), SPEEDS, 1.0, 1.0),
        ((math.inf, 0.0, 0.0), SPEEDS, 1.0, 1.0),
        (ORIGIN, (0.0, 1.0, 1.0), 1.0, 1.0),
        (ORIGIN, (1.0, 1.0, -1.0), 1.0, 1.0),
        (ORIGIN, SPEEDS, 0.0, 1.0),
        (ORIGIN, SPEEDS, 1.0, math.nan),
    ],
)
def test_what_cannot_be_flown_is_refused(target: Vec3, speeds: Vec3, acceleration: float, jerk: float) -> None:
    with pytest.raises(ValueError, match="expected"):
        plan_trajectory(AT_REST, target, speeds, acceleration, jerk)
