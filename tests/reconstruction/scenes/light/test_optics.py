"""Light on glass: against known figures, energy, slow sums of the light's own paths, and grazing angles."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reconstruction.scenes.light.pane_surfaces import fresnel, mirrored, pane_light
from reconstruction.scenes.record import Glass

CLEAR = (1.0, 1.0, 1.0)
ANGLES = np.concatenate([np.linspace(1.0, 0.0, 500), 10.0 ** -np.arange(2.0, 320.0)])


def by_snell(angle_rad: float, index: float) -> tuple[float, float]:
    """Fresnel's equations as sines and tangents of both angles."""
    inner = math.asin(math.sin(angle_rad) / index)
    across = (math.sin(angle_rad - inner) / math.sin(angle_rad + inner)) ** 2
    along = (math.tan(angle_rad - inner) / math.tan(angle_rad + inner)) ** 2
    return across, along


def test_reflectance_at_normal_incidence_is_known() -> None:
    assert fresnel(np.ones(1), 1.5)[0] == pytest.approx(0.04, abs=1e-15)
    assert fresnel(np.ones(1), 1.0)[0] == 0.0
    assert fresnel(np.zeros(1), 1.52)[0] == 1.0


def test_light_polarised_along_the_plane_of_incidence_vanishes_at_brewsters_angle() -> None:
    cosine = np.array([math.cos(math.atan(1.52))])
    # The other polarisation reflects ((n^2 - 1) / (n^2 + 1))^2 there.
    across = ((1.52**2 - 1.0) / (1.52**2 + 1.0)) ** 2
    assert fresnel(cosine, 1.52)[0] == pytest.approx(0.5 * across, rel=1e-12)


@given(st.floats(1e-3, 1.55), st.floats(1.01, 3.0))
def test_fresnel_agrees_with_its_trigonometric_form(angle_rad: float, index: float) -> None:
    assert fresnel(np.array([math.cos(angle_rad)]), index)[0] == pytest.approx(
        0.5 * sum(by_snell(angle_rad, index)), rel=1e-7
    )


@settings(max_examples=60, deadline=None)
@given(st.floats(1.0, 3.0), st.floats(0.0, 0.99), st.tuples(*[st.floats(0.0, 1.0)] * 3), st.sampled_from([1, 2]))
def test_a_pane_never_gives_more_light_than_it_got(
    index: float, coating: float, tint: tuple[float, float, float], sheets: int
) -> None:
    parts = np.array(pane_light(ANGLES, Glass(index, coating, tint, sheets)))
    assert np.isfinite(parts).all()
    assert parts.min() >= 0.0
    assert parts.sum(axis=0).max() <= 1.0 + 1e-12


@pytest.mark.parametrize("sheets", [1, 2])
def test_clear_glass_swallows_nothing(sheets: int) -> None:
    parts = np.array(pane_light(ANGLES[:500], Glass(1.52, 0.2, CLEAR, sheets)))
    assert np.allclose(parts.sum(axis=0), 1.0, atol=1e-12)
    assert np.allclose(parts[:, -1].sum(axis=0), 1.0)


def test_a_pane_is_the_sum_over_all_paths_of_the_light() -> None:
    angle, index, tint = 1.1, 1.52, 0.7
    inside = (tint**0.5) ** (1.0 / math.cos(math.asin(math.sin(angle) / index)))
    back = through = 0.0
    for face in by_snell(angle, index):
        # Four faces and the light in the five spaces between and around them, step by step.
        down, up = np.zeros(5), np.zeros(5)
        down[0], passes = 1.0, np.array([1.0, inside, 1.0, inside, 1.0])
        for _ in range(400):
            new_down, new_up = np.zeros(5), np.zeros(5)
            for i in range(4):
                new_down[i + 1] += (1.0 - face) * down[i] * passes[i]
                new_up[i] += face * down[i] * passes[i]
                new_up[i] += (1.0 - face) * up[i + 1] * passes[i + 1]
                new_down[i + 1] += face * up[i + 1] * passes[i + 1]
            back, through = back + 0.5 * new_up[0], through + 0.5 * new_down[4]
            new_up[0] = new_down[4] = 0.0
            down, up = new_down, new_up
    first, behind, on = pane_light(np.array([math.cos(angle)]), Glass(index, 0.0, (tint, tint, tint), 2))
    assert first[0, 0] + behind[0, 0] == pytest.approx(back, rel=1e-9)
    assert on[0, 0] == pytest.approx(through, rel=1e-9)


def test_a_coating_adds_what_it_says_and_all_is_reflected_at_grazing_angles() -> None:
    plain = sum(pane_light(np.ones(1), Glass())[:2])
    coated = sum(pane_light(np.ones(1), Glass(coating=0.3))[:2])
    assert np.allclose(coated - plain, 0.3)
    grazing = pane_light(np.array([0.0, 1e-12]), Glass(coating=0.3))
    assert np.allclose(grazing[0], 1.0, atol=1e-10)
    assert np.allclose(grazing[2], 0.0, atol=1e-10)


def test_mirrored_directions_keep_their_length_and_their_part_in_the_plane() -> None:
    rng = np.random.default_rng(0)
    d, n = rng.normal(size=(50, 3)), rng.normal(size=(50, 3))
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    r = mirrored(d, n)
    assert np.allclose(np.linalg.norm(r, axis=1), np.linalg.norm(d, axis=1))
    assert np.allclose(np.einsum("nk,nk->n", r + d, n), 0.0)
    assert np.allclose(mirrored(d, -n), r)
    assert np.allclose(np.cross(r - d, n), 0.0)
