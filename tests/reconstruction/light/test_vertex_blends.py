"""Four channels in one register, against sums written out."""

import numpy as np
import pytest

from planning.base.jit import kernel
from reconstruction.light import radiance_grid_kernels

OVER, UP = 4 * 5, 4 * 5 * 4
AT = UP + OVER + 4 * 2
CORNERS = [AT + x + y + z for z in (0, UP) for y in (0, OVER) for x in (0, 4)]


@kernel
def blended(flat, weights):
    return radiance_grid_kernels.blended(flat, AT, OVER, UP, weights)


@kernel
def spread(flat, weights, amounts):
    radiance_grid_kernels.spread(flat, AT, OVER, UP, weights, amounts)


@kernel
def weighed(flat, amounts):
    return radiance_grid_kernels.weighed(flat, AT, OVER, UP, amounts)


@pytest.fixture
def numbers():
    """A grid of 5 x 4 x 3 vertices, eight weights, and four amounts."""
    rng = np.random.default_rng(0)
    flat, weights, amounts = (rng.normal(size=size).astype(np.float32) for size in (4 * 5 * 4 * 3, 8, 4))
    return flat, tuple(weights), tuple(amounts)


def vertices(flat):
    return np.array([flat[at : at + 4] for at in CORNERS], float)


def test_a_blend_is_the_weighted_sum_of_the_eight_vertices(numbers):
    flat, weights, _ = numbers
    assert np.array(blended(flat, weights)) == pytest.approx(np.array(weights) @ vertices(flat), rel=1e-5)


def test_what_is_spread_is_added_to_the_eight_vertices_and_to_nothing_else(numbers):
    flat, weights, amounts = numbers
    expected = flat.astype(float)
    for at, weight in zip(CORNERS, weights, strict=True):
        expected[at : at + 4] += weight * np.array(amounts)
    spread(flat, weights, amounts)
    assert flat == pytest.approx(expected, rel=1e-5, abs=1e-6)


def test_each_vertex_is_weighed_by_its_channels(numbers):
    flat, _, amounts = numbers
    assert np.array(weighed(flat, amounts)) == pytest.approx(vertices(flat) @ np.array(amounts), rel=1e-5, abs=1e-6)
