"""Gaussians as other programs know them."""

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from reconstruction.exports.component_parts import THICKNESS_M, ellipsoids_of, ellipsoids_of_all, unit_quaternions
from reconstruction.splats.harmonic_colour import display_colours
from reconstruction.splats.splats import normals_of
from tests.reconstruction.objects.synthetic_scene import synthetic_scene


def standard_harmonics(directions):
    """Real harmonics to degree 3 with the phase, by their polynomials (Sloan, 2008)."""
    x, y, z = directions.T
    a = np.sqrt
    pi = np.pi
    return np.stack(
        [
            np.full_like(x, 0.5 / a(pi)),
            -a(3 / (4 * pi)) * y,
            a(3 / (4 * pi)) * z,
            -a(3 / (4 * pi)) * x,
            a(15 / (4 * pi)) * x * y,
            -a(15 / (4 * pi)) * y * z,
            a(5 / (16 * pi)) * (3 * z * z - 1),
            -a(15 / (4 * pi)) * x * z,
            a(15 / (16 * pi)) * (x * x - y * y),
            -a(35 / (32 * pi)) * y * (3 * x * x - y * y),
            a(105 / (4 * pi)) * x * y * z,
            -a(21 / (32 * pi)) * y * (5 * z * z - 1),
            a(7 / (16 * pi)) * (5 * z**3 - 3 * z),
            -a(21 / (32 * pi)) * x * (5 * z * z - 1),
            a(105 / (16 * pi)) * z * (x * x - y * y),
            -a(35 / (32 * pi)) * x * (x * x - 3 * y * y),
        ],
        axis=1,
    )


def test_colours_are_those_of_the_model_from_any_side():
    scene = synthetic_scene()
    for component in scene.components:
        found = ellipsoids_of(component)
        values = {name: torch.from_numpy(value.copy()) for name, value in component.gaussians.values.items()}
        eye = np.array([3.0, -4.0, 2.0], np.float32)
        directions = (found.means_m - eye).astype(float)
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        colours = 0.5 + np.einsum("nk,nkc->nc", standard_harmonics(directions), found.sh)
        expected = display_colours(values["means"], values["sh"], torch.from_numpy(eye), 3).numpy()
        np.testing.assert_allclose(np.maximum(colours, 0.0), np.maximum(expected, 0.0), atol=2e-6)


def test_discs_are_thin_along_their_normals_and_know_their_panels():
    scene = synthetic_scene()
    found = ellipsoids_of_all(scene.components)
    assert len(found) == scene.n_gaussians
    assert (found.scales_m[:, 2] == np.float32(THICKNESS_M)).all()
    quats = np.concatenate([component.gaussians.values["quats"] for component in scene.components])
    w, x, y, z = found.quats.T
    thin = np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=1)
    np.testing.assert_allclose(thin, normals_of(torch.from_numpy(quats)).numpy(), atol=1e-6)
    sizes = {element.panel: element.n_gaussians for _, element in scene.elements}
    assert {panel: int((found.panels == panel).sum()) for panel in sizes} == sizes
    assert (found.panels == -1).sum() == len(scene.components[-1].gaussians)
    some = found.chosen(found.panels == 0)
    assert len(some) == sizes[0]
    assert np.array_equal(some.means_m, scene.components[0].gaussians.values["means"][: sizes[0]])


@settings(max_examples=60, deadline=None)
@given(hnp.arrays(np.float32, (3, 4), elements=st.floats(-(2.0**127), 2.0**127, width=32)))
def test_quaternions_of_any_length_become_unit_ones(quats):
    found = unit_quaternions(quats)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1.0, atol=1e-6)
    assert (found[:, 0] >= 0.0).all()


@pytest.mark.parametrize("logit", [-1e4, -80.0, 0.0, 80.0, 1e4])
def test_opacities_of_any_logit_are_shares(logit):
    scene = synthetic_scene()
    scene.components[0].gaussians.values["opacity_logits"][:] = logit
    found = ellipsoids_of(scene.components[0]).opacities
    np.testing.assert_allclose(found, 0.5 * (1.0 + np.tanh(0.5 * logit)), atol=1e-7)
