"""Vectors of eight numbers in kernels, against NumPy's float32."""

import numpy as np
import pytest

from planning.base.jit import kernel
from reconstruction.splats.rasterising.numba_lanes import (
    N_LANES,
    any_of,
    bits_of,
    fetch,
    least_of,
    load_lanes,
    load_number,
    most_of,
    power_of_two,
    root_of,
    rounded,
    select,
    spread,
    store_lanes,
    sum_of,
    sums_of,
)

TWO, THREE = np.float32(2.0), np.float32(3.0)


@kernel
def work_out(given, out, bits):
    """Rows of `given`, shape (8, 8), put together in all ways there are; row 9 of `out` takes the sums of all rows."""
    fetch(given, 3)
    a, b = load_lanes(given, 0), load_lanes(given, N_LANES)
    store_lanes(out, 0 * N_LANES, a + b)
    store_lanes(out, 1 * N_LANES, TWO - a * b)
    store_lanes(out, 2 * N_LANES, (a + 1) / b)
    store_lanes(out, 3 * N_LANES, -a + load_number(given, 5))
    store_lanes(out, 4 * N_LANES, select((a < b) & (a > spread(TWO)), a, THREE))
    store_lanes(out, 5 * N_LANES, least_of(a, b) + most_of(TWO, a))
    store_lanes(out, 6 * N_LANES, root_of(b * b))
    store_lanes(out, 7 * N_LANES, rounded(a * THREE))
    store_lanes(out, 8 * N_LANES, power_of_two(rounded(a)))
    c, d, e = load_lanes(given, 2 * N_LANES), load_lanes(given, 3 * N_LANES), load_lanes(given, 4 * N_LANES)
    f, g, h = load_lanes(given, 5 * N_LANES), load_lanes(given, 6 * N_LANES), load_lanes(given, 7 * N_LANES)
    store_lanes(out, 9 * N_LANES, sums_of(a, b, c, d, e, f, g, h))
    bits[0], bits[1], bits[2] = bits_of(a <= b), bits_of(a >= b), bits_of(a == a)
    bits[3], bits[4] = any_of(a > b), any_of(a > a)
    return sum_of(a)


@pytest.fixture(scope="module")
def worked_out():
    given = np.random.default_rng(0).uniform(-4.0, 4.0, (N_LANES, N_LANES)).astype(np.float32)
    given[0, 0], given[1, 0] = 2.5, 3.0
    out, bits = np.zeros((10, N_LANES), np.float32), np.zeros(5, np.int64)
    total = work_out(given, out, bits)
    return given, out, bits, total


def test_numbers_in_all_lanes_are_worked_out_as_alone(worked_out):
    given, out, _, _ = worked_out
    a, b = given[0], given[1]
    chosen = np.where((a < b) & (a > 2.0), a, THREE)
    assert 0 < (chosen == a).sum() < N_LANES
    expected = [
        a + b, 2.0 - a * b, (a + 1.0) / b, given[0, 5] - a, chosen, np.minimum(a, b) + np.maximum(a, 2.0), np.abs(b),
        np.rint(a * THREE), np.exp2(np.rint(a)),
    ]  # fmt: skip
    # A product that is joined with a sum is rounded once.
    np.testing.assert_allclose(out[:9], expected, rtol=1e-6, atol=1e-6)


def test_sums_over_lanes_are_in_the_order_of_what_they_are_sums_of(worked_out):
    given, out, _, total = worked_out
    np.testing.assert_allclose(out[9], given.sum(axis=1), rtol=1e-5, atol=1e-5)
    assert total == pytest.approx(given[0].sum(), rel=1e-5)


def test_choices_are_bits_the_first_lane_lowest(worked_out):
    given, _, bits, _ = worked_out
    a, b = given[0], given[1]

    def number(choices):
        return sum(1 << k for k in range(N_LANES) if choices[k])

    assert bits.tolist() == [number(a <= b), number(a >= b), 255, int((a > b).any()), 0]


def test_what_is_no_number_is_neither_more_nor_less():
    given, out = np.full((N_LANES, N_LANES), np.nan, np.float32), np.zeros((10, N_LANES), np.float32)
    given[1] = 1.0
    bits = np.zeros(5, np.int64)
    work_out(given, out, bits)
    assert bits.tolist() == [0, 0, 0, 0, 0]
    # The second one is taken where one is no number.
    assert (out[4] == 3.0).all()
