"""Scrambled Sobol points: SciPy's without scrambling, and the property that makes them even with it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.coverage.positions import SOBOL_BITS, sobol


class Unscrambled:
    """In place of random numbers."""

    def integers(self, low, high, shape):
        return np.zeros(shape, np.int64)


def test_unscrambled_points_are_those_of_scipy():
    from scipy.stats import qmc

    ours, theirs = sobol(1 << 12, Unscrambled()), qmc.Sobol(3, scramble=False).random_base2(12)
    for points in (ours, theirs):
        points[:] = points[np.lexsort(points.T)]
    np.testing.assert_array_equal(ours, theirs)


@given(st.integers(0, 9), st.integers(0, 2**32 - 1))
def test_each_axis_has_one_of_so_many_points_in_each_of_so_many_parts(exponent, seed):
    n = 1 << exponent
    points = sobol(n, np.random.default_rng(seed))
    assert ((points >= 0.0) & (points < 1.0)).all()
    np.testing.assert_array_equal(np.sort((points * n).astype(int), axis=0), np.arange(n)[:, None].repeat(3, axis=1))


@given(st.integers(2, 5), st.integers(0, 2**32 - 1))
def test_two_axes_have_a_point_in_each_part_of_a_square(half, seed):
    points = sobol(1 << 2 * half, np.random.default_rng(seed))
    x, y = (points[:, :2] * (1 << half)).astype(int).T
    assert len(np.unique(x << half | y)) == len(points)


@pytest.mark.parametrize("n", [0, 1, 5])
def test_few_points_are_the_first_of_more(n):
    few, more = (sobol(k, np.random.default_rng(3)) for k in (n, 64))
    np.testing.assert_array_equal(few, more[:n])


def test_seeds_scramble_differently_down_to_the_last_bit():
    one, other = (sobol(256, np.random.default_rng(seed)) for seed in (0, 1))
    assert (one != other).all(axis=1).mean() > 0.99
    lowest = (np.stack([one, other]) * (1 << SOBOL_BITS)).astype(np.int64) & 1
    assert 0.2 < lowest.mean() < 0.8
