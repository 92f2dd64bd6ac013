"""Gaussians in other axes look the same."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reconstruction.exports.component_parts import ellipsoids_of_all
from reconstruction.exports.gaussian_blocks import QUARTER_TURNS, harmonic_turns, rotation_about_x, turned
from tests.reconstruction.exports.spz.reading import turned_back
from tests.reconstruction.exports.test_ellipsoids import standard_harmonics
from tests.reconstruction.objects.synthetic_scene import synthetic_scene

TURNED = ("y-up", "y-down")


def colours(ellipsoids, directions):
    """Of each Gaussian along each direction, shape (n, m, 3)."""
    return np.einsum("mk,nkc->nmc", standard_harmonics(directions), ellipsoids.sh.astype(float))


def covariances(ellipsoids):
    w, x, y, z = ellipsoids.quats.astype(float).T
    turns = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    ).transpose(2, 0, 1)
    sized = turns * ellipsoids.scales_m[:, None, :].astype(float)
    return sized @ sized.transpose(0, 2, 1)


@pytest.mark.parametrize("axes", TURNED)
def test_colours_agree_from_any_direction(axes):
    ellipsoids = ellipsoids_of_all(synthetic_scene().components)
    directions = np.random.default_rng(1).normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    turn = rotation_about_x(QUARTER_TURNS[axes])
    found = colours(turned(ellipsoids, axes), directions @ turn.T)
    np.testing.assert_allclose(found, colours(ellipsoids, directions), atol=2e-6)


@pytest.mark.parametrize("axes", TURNED)
def test_shapes_turn_with_the_places(axes):
    ellipsoids = ellipsoids_of_all(synthetic_scene().components)
    turn = rotation_about_x(QUARTER_TURNS[axes])
    found = turned(ellipsoids, axes)
    assert np.array_equal(found.means_m, ellipsoids.means_m @ turn.T)
    np.testing.assert_allclose(covariances(found), turn @ covariances(ellipsoids) @ turn.T, atol=1e-8)
    assert (found.quats[:, 0] >= 0.0).all()


def test_up_is_where_each_says():
    ellipsoids = ellipsoids_of_all(synthetic_scene().components)
    x, y, z = ellipsoids.means_m.T
    assert np.array_equal(turned(ellipsoids, "y-up").means_m, np.stack([x, z, -y], axis=1))
    assert np.array_equal(turned(ellipsoids, "y-down").means_m, np.stack([x, -z, y], axis=1))
    assert turned(ellipsoids, "enu") is ellipsoids


@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_harmonics_turn_each_degree_by_itself_and_keep_lengths(quarters):
    turns = harmonic_turns(quarters)
    np.testing.assert_allclose(turns @ turns.T, np.eye(16), atol=1e-12)
    degrees = np.repeat([0, 1, 2, 3], [1, 3, 5, 7])
    assert not turns[degrees[:, None] != degrees].any()
    np.testing.assert_allclose(np.linalg.matrix_power(harmonic_turns(1), quarters), turns, atol=1e-12)


@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 999), axes=st.sampled_from(TURNED))
def test_turning_back_gives_the_same(seed, axes):
    ellipsoids = ellipsoids_of_all(synthetic_scene(((3,),), 2, seed).components)
    back = turned_back(turned(ellipsoids, axes), axes)
    for name in ("means_m", "sh"):
        np.testing.assert_allclose(getattr(back, name), getattr(ellipsoids, name), atol=2e-6)
    np.testing.assert_allclose(covariances(back), covariances(ellipsoids), atol=1e-8)
