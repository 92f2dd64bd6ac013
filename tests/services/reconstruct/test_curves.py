"""Curves of a training that stay short, and means of what goes up and down."""

import numpy as np
import pytest

from groundstation.services.reconstruct.curves import MOST_POINTS, ThinCurve, smoothed


@pytest.mark.parametrize("n", [1, 2, MOST_POINTS, MOST_POINTS + 1, 10 * MOST_POINTS + 7])
def test_a_curve_keeps_its_ends_and_stays_short(n):
    curve = ThinCurve()
    for number in range(n):
        curve.add(float(number), 2.0 * number)
    x, y = curve.arrays()
    assert len(x) <= MOST_POINTS
    assert len(x) >= min(n, MOST_POINTS // 2)
    assert x[0] == 0.0
    assert x[-1] == n - 1
    assert (np.diff(x) > 0.0).all()
    np.testing.assert_array_equal(y, 2.0 * x)


def test_the_last_value_is_there_though_it_is_thinned_out_later():
    curve = ThinCurve()
    for number in range(3 * MOST_POINTS):
        curve.add(float(number), 0.0)
        assert curve.x[-1] == number


def test_means_are_of_the_last_values():
    np.testing.assert_allclose(smoothed(np.array([1.0, 3.0, 5.0, 7.0]), 2), [1.0, 2.0, 4.0, 6.0])
    assert len(smoothed(np.zeros(0), 5)) == 0
