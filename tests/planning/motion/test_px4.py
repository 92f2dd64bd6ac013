"""How long PX4 takes for legs and turns: against its own law of speed, stepped through, and against real flights."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.motion.px4 import px4_legs_s, px4_turn_s, straight_s
from planning.motion.timing import MotionLimits

PX4 = MotionLimits(5.0, 3.0, 1.5, 3.0, math.radians(45.0), 1.0, 4.0)


def allowed_m_s(before_m, a, j):
    """PX4's computeMaxSpeedFromDistance for an arrival at rest."""
    b = 4.0 * a * a / j
    return 0.5 * (math.sqrt(b * b + 8.0 * a * before_m) - b)


def stepped_s(length_m, speed_m_s, a, j, radius_m, step_s=1e-3):
    """Slow twin: speed gained with limited acceleration and jerk up to the peak, then PX4's law, step by step."""

    def gained(peak):
        ramp_s = peak / a + a / j if peak >= a * a / j else 2.0 * math.sqrt(peak / j)
        return ramp_s, ramp_s * peak / 2.0

    peak = speed_m_s
    while allowed_m_s(max(0.0, length_m - gained(peak)[1]), a, j) < peak:
        peak *= 0.999
    time_s, here_m = gained(peak)
    while length_m - here_m > radius_m:
        here_m += step_s * min(peak, allowed_m_s(length_m - here_m, a, j))
        time_s += step_s
    return time_s


@pytest.mark.slow
@given(st.floats(1.0, 120.0), st.floats(0.5, 15.0), st.floats(1.0, 6.0), st.floats(2.0, 20.0), st.floats(0.1, 0.9))
@settings(max_examples=25, deadline=None)
def test_times_are_those_of_px4s_law_stepped_through(length, speed, a, j, radius):
    assert straight_s(length, speed, a, j, radius) == pytest.approx(stepped_s(length, speed, a, j, radius), rel=0.02)


@given(st.floats(0.0, 1e4), st.floats(0.0, 1e3), st.floats(0.01, 30.0), st.floats(0.5, 20.0), st.floats(0.5, 50.0))
def test_longer_legs_take_longer_and_no_time_is_none(length, more, speed, a, j):
    short_s, long_s = (straight_s(each, speed, a, j, 0.5) for each in (length, length + more))
    assert 0.0 <= short_s <= long_s * (1.0 + 1e-9) + 1e-9
    assert math.isfinite(long_s)


def test_smaller_radii_wait_for_more_of_the_approach():
    times_s = [straight_s(20.0, 5.0, 3.0, 4.0, 0.5 * 2.0**-k) for k in range(12)]
    steps_s = [b - a for a, b in itertools.pairwise(times_s)]
    # The approach is exponential, with the time constant 2 a / j: each half of the rest takes as long.
    assert steps_s[-1] == pytest.approx(1.5 * math.log(2.0), rel=1e-3)
    with pytest.raises(ValueError, match="radius_m"):
        straight_s(20.0, 5.0, 3.0, 4.0, 0.0)


FLOWN = {
    (16.5, 2.2): 6.97, (19.5, -2.0): 7.57, (30.6, 0.1): 10.25, (21.0, -0.3): 8.33, (13.4, 0.0): 6.22, (15.2, 0.1): 7.32,
    (9.4, 0.0): 6.42, (10.2, -0.2): 5.79, (8.8, 0.1): 5.86, (12.2, 0.0): 6.16, (20.4, -0.1): 8.14, (12.5, 17.2): 9.24,
    (41.0, -2.0): 12.10, (26.1, 7.2): 9.14, (24.7, -6.0): 9.39, (9.8, 9.5): 7.43, (15.7, 6.5): 7.78, (31.4, 0.3): 10.25,
    (14.6, 23.4): 11.10, (24.0, 0.0): 8.28, (25.9, 0.7): 9.19, (46.8, 1.3): 13.22, (11.4, -22.3): 16.30,
}  # fmt: skip
"""Metres across and up, seconds without the hold: PX4 main of 2025-08-18 (a70a558393) in its own simulation."""


def test_legs_of_a_real_px4_took_as_long():
    legs = np.array([(across_m, 0.0, up_m) for across_m, up_m in FLOWN])
    ratios = px4_legs_s(legs, PX4, 0.5) / list(FLOWN.values())
    assert ((ratios > 0.8) & (ratios < 1.2)).all(), ratios
    assert 0.95 < ratios.mean() < 1.05


def test_turns_gain_and_lose_speed():
    assert px4_turn_s(180.0, 45.0) == pytest.approx(4.0 + 45.0 / 20.0)
    assert px4_turn_s(20.0, 45.0) == pytest.approx(2.0)
    assert px4_turn_s(0.0, 45.0) == 0.0
    assert px4_turn_s(101.25 - 1e-9, 45.0) == pytest.approx(px4_turn_s(101.25, 45.0))
