"""Filters by lobes: the same as sums over all texels, on every face alike."""

import numpy as np
import pytest

from reconstruction.light.cube_lookup import solid_angles, texel_directions, texels_of
from reconstruction.light.cube_map import GGX_WIDTH, cosine_lobe, ggx_lobe, lobe_filter, pyramid
from tests.reconstruction.training.methods.synthetic_ball import environment

SIDE = 16


def ggx_by_half_vectors(cosines, roughness):
    """D (n . l) with D as in B. Walter et al., Microfacet models for refraction, 2007, Eq. 33, h between n and l."""
    half = np.sqrt(0.5 + 0.5 * cosines)
    alpha = roughness**2
    return alpha**2 / (np.pi * (half**2 * (alpha**2 - 1.0) + 1.0) ** 2) * np.maximum(cosines, 0.0)


def summed(light, towards, weight, finer=4):
    """Light that lobes take, added up over the sphere, from texels that are alike all over; shape (n,)."""
    places, areas = texel_directions(SIDE * finer), solid_angles(SIDE * finer)
    weights = weight(np.clip(towards @ places.T, -1.0, 1.0)) * areas
    return weights @ light[texels_of(places, SIDE)] / weights.sum(axis=1)


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize(("roughness", "square", "share"), [(0.3, 0.7, 0.012), (0.5, 0.5, 0.008), (1.0, 0.35, 0.012)])
def test_ggx_filters_are_sums_over_the_sphere(roughness, square, share):
    light = environment(texel_directions(SIDE))[:, 1]
    made = lobe_filter(SIDE, 8, ggx_lobe(roughness), min(GGX_WIDTH * roughness**2, 0.6), square)
    found = made @ (pyramid(SIDE) @ light)
    truth = summed(light, texel_directions(8), lambda cosines: ggx_by_half_vectors(cosines, roughness))
    assert np.sqrt(np.mean((found - truth) ** 2)) < share * light.std()
    assert np.abs(found - truth).max() < 6.0 * share * light.std()
    assert made.nnz < 0.25 * made.shape[0] * 6 * SIDE * SIDE


def test_light_on_matt_surfaces_is_the_cosine_weighted_mean():
    light = environment(texel_directions(SIDE))[:, 0]
    found = lobe_filter(SIDE, 4, cosine_lobe, 0.6, 0.35) @ (pyramid(SIDE) @ light)
    truth = summed(light, texel_directions(4), lambda cosines: np.maximum(cosines, 0.0))
    assert np.abs(found - truth).max() < 0.02 * light.std()


def test_even_light_stays_even():
    made = lobe_filter(SIDE, 8, ggx_lobe(0.4), 0.2, 0.7)
    assert np.allclose(made.sum(axis=1), 1.0)
    assert made.data.min() > 0.0


def test_lobes_do_not_depend_on_the_face():
    """Light turned round the axes, or mirrored, gives what turning the filtered light gives."""
    made, built = lobe_filter(SIDE, 8, ggx_lobe(0.3), 0.12, 0.7), pyramid(SIDE)
    for change in (lambda d: np.roll(d, 1, axis=1), lambda d: np.roll(d, 2, axis=1), lambda d: d * [-1.0, 1.0, 1.0],
                   lambda d: d * [1.0, -1.0, -1.0]):  # fmt: skip
        there = made @ (built @ environment(change(texel_directions(SIDE)))[:, 0])
        here = made @ (built @ environment(texel_directions(SIDE))[:, 0])
        assert np.allclose(there, here[texels_of(change(texel_directions(8)), 8)], atol=1e-12)


def test_the_narrowest_lobe_is_no_division_by_nothing():
    chords = np.array([0.0, 1e-30, 1e-8, 2.0, 4.0])
    for roughness in (1e-3, 0.05, 1.0):
        found = ggx_lobe(roughness)(chords)
        assert np.isfinite(found).all()
        assert (found >= 0.0).all()
