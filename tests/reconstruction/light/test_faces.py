"""Cubes: texels where they belong, neighbours beside each other, averages by solid angle."""

import numpy as np
import pytest

from reconstruction.light.cube_lookup import (
    averages,
    directions_on,
    middles,
    padding,
    sides_from,
    solid_angles,
    texel_directions,
    texels_of,
)


@pytest.mark.parametrize("side", [1, 2, 8])
def test_directions_of_texels_fall_on_their_own_texels(side):
    assert texels_of(texel_directions(side), side).tolist() == list(range(6 * side * side))


@pytest.mark.parametrize("side", [1, 4, 16])
def test_solid_angles_add_up_to_the_sphere_and_shrink_towards_corners(side):
    found = solid_angles(side).reshape(6, side, side)
    assert found.sum() == pytest.approx(4.0 * np.pi, rel=1e-12)
    assert (found[:, side // 2, side // 2] >= found[:, 0, 0]).all()
    assert np.allclose(found, found[0])


def test_borders_hold_what_adjoins_a_face():
    side = 8
    made = padding(side)
    assert np.allclose(made.sum(axis=1), 1.0)
    seen = (made @ texel_directions(side)).reshape(6, side + 2, side + 2, 3)
    beyond = np.concatenate([[-1.0 - 1.0 / side], middles(side), [1.0 + 1.0 / side]])
    faces, v, u = np.meshgrid(np.arange(6), beyond, beyond, indexing="ij")
    straight_on = directions_on(faces, u, v)
    straight_on /= np.linalg.norm(straight_on, axis=-1, keepdims=True)
    apart = np.linalg.norm(seen - straight_on, axis=-1)
    assert apart[:, 1:-1, 1:-1].max() < 1e-12
    is_corner = np.zeros((side + 2, side + 2), bool)
    is_corner[[0, 0, -1, -1], [0, -1, 0, -1]] = True
    # Over an edge, planes turn by 90 degrees: the neighbour is half a texel from where the plane would go on.
    assert apart[:, ~is_corner].max() < 1.0 / side
    assert apart.max() < 2.0 / side


def test_a_texel_beyond_an_edge_is_that_of_the_other_face():
    side = 4
    numbers = np.arange(6 * side * side, dtype=float)
    seen = (padding(side) @ numbers).reshape(6, side + 2, side + 2)
    edge = np.array([1.0, 1.0 - 1e-6, middles(side)[1]])
    other = texels_of(edge - np.array([1e-3, 0.0, 0.0]) + np.array([0.0, 1e-3, 0.0]), side)
    # Face 0 looks along x, u is y, v is z: beyond u = 1 lies the face along y.
    assert seen[0, 1 + 1, side + 1] == float(other)
    assert other // (side * side) == 2


def test_averages_keep_the_light_of_the_whole_sphere():
    light = np.random.default_rng(0).random(6 * 16 * 16)
    for coarse in (16, 8, 1):
        assert (averages(16, coarse) @ light) @ solid_angles(coarse) == pytest.approx(
            light @ solid_angles(16), rel=1e-12
        )


def test_sides_halve_and_others_are_refused():
    assert sides_from(16, 4) == (16, 8, 4)
    for side, last in ((12, 1), (4, 8), (0, 1)):
        with pytest.raises(ValueError, match="power of 2"):
            sides_from(side, last)
