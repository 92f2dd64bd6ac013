"""Motion from rest to rest: the limits are kept, the leg is flown, and it takes the time that planning charges."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.insight.flight_profile import rest_to_rest_ramps
from planning.motion.timing import rest_to_rest_s

lengths = st.floats(1e-3, 5000.0)
limits = st.tuples(st.floats(0.3, 20.0), st.floats(0.3, 8.0), st.sampled_from([math.inf, 0.2, 1.0, 4.0, 50.0]))


@given(lengths, limits)
def test_legs_take_the_time_and_cover_the_length_that_planning_charges(length, limit):
    ramps = rest_to_rest_ramps([length], *limit)
    assert ramps.duration_s[0] == pytest.approx(rest_to_rest_s(length, *limit), rel=1e-12)
    assert ramps.length_m[0] == pytest.approx(length, rel=1e-9)
    leg = np.zeros(3, np.int64)
    distance, speed = ramps.at(leg, np.array([-1.0, 0.0, ramps.duration_s[0]]))
    np.testing.assert_allclose(distance, [0.0, 0.0, length], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(speed, 0.0, atol=1e-9)


@given(lengths, limits)
def test_distance_speed_and_acceleration_are_derivatives_of_each_other_within_the_limits(length, limit):
    highest, acceleration, jerk = limit
    ramps = rest_to_rest_ramps([length], *limit)
    n = 4000
    t = np.linspace(0.0, ramps.duration_s[0], n + 1)
    distance, speed = ramps.at(np.zeros(n + 1, np.int64), t)
    step = t[1]
    assert (np.diff(distance) >= -1e-9).all()
    assert speed.max() <= highest * (1.0 + 1e-9)
    # Between samples the speed is at most piecewise quadratic: trapezia find the distance to second order.
    trapezia = 0.5 * (speed[1:] + speed[:-1]) * step
    bound = acceleration * step**2 + 1e-9 * length
    assert np.abs(np.diff(distance) - trapezia).max() <= bound
    gain = np.diff(speed) / step
    assert np.abs(gain).max() <= acceleration * (1.0 + 1e-6) + 1e-9 * highest / step
    if math.isfinite(jerk):
        assert np.abs(np.diff(gain)).max() / step <= jerk * (1.0 + 1e-3) + 1e-6 * highest / step**2
    np.testing.assert_allclose(speed, speed[::-1], atol=1e-6 * highest)


def test_a_worked_example_with_and_without_a_limit_of_jerk():
    # 100 m at 10 m/s and 2 m/s2: 5 s up over 25 m, 5 s at 10 m/s, 5 s down. With 1 m/s3 a ramp takes 2 s more.
    plain, soft = rest_to_rest_ramps([100.0], 10.0, 2.0), rest_to_rest_ramps([100.0], 10.0, 2.0, 1.0)
    at = np.zeros(4, np.int64)
    distance, speed = plain.at(at, np.array([2.5, 5.0, 7.5, 12.5]))
    np.testing.assert_allclose(distance, [6.25, 25.0, 50.0, 93.75])
    np.testing.assert_allclose(speed, [5.0, 10.0, 10.0, 5.0])
    assert (plain.duration_s[0], soft.duration_s[0]) == pytest.approx((15.0, 17.0))
    distance, speed = soft.at(at, np.array([1.0, 2.0, 3.5, 7.0]))
    # Jerk for 2 s: t^3 / 6 and t^2 / 2; then 2 m/s2 for 3 s; half the ramp's speed at half its time.
    np.testing.assert_allclose(distance, [1.0 / 6.0, 8.0 / 6.0, 8.0 / 6.0 + 2.0 * 1.5 + 1.5**2, 35.0])
    np.testing.assert_allclose(speed, [0.5, 2.0, 5.0, 10.0])


@pytest.mark.parametrize("jerk", [math.inf, 1.0])
def test_legs_of_no_length_do_not_move(jerk):
    ramps = rest_to_rest_ramps([0.0, 4.0], 5.0, 2.0, jerk)
    assert ramps.duration_s[0] == 0.0
    distance, speed = ramps.at(np.array([0, 0]), np.array([0.0, 1.0]))
    assert (distance == 0.0).all()
    assert (speed == 0.0).all()
    assert np.isfinite(ramps.peak_m_s).all()


@pytest.mark.parametrize("jerk", [math.inf, 1.0])
@pytest.mark.parametrize("length", [1e-12, 1e-9, 1e-4])
def test_tiny_legs_stay_finite(length, jerk):
    ramps = rest_to_rest_ramps([length], 15.0, 2.5, jerk)
    distance, speed = ramps.at(np.zeros(5, np.int64), np.linspace(0.0, ramps.duration_s[0], 5))
    np.testing.assert_allclose(distance[[0, 2, 4]], [0.0, length / 2, length], rtol=1e-6, atol=1e-18)
    assert np.isfinite(speed).all()
