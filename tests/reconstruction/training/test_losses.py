"""Losses of the joint training: their equations, and zeros with zero gradients where nothing counts."""

import math

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from reconstruction.light.config import HighFrequencyStage
from reconstruction.splats.rasterising.views import View
from reconstruction.training.config import LossWeights
from reconstruction.training.losses import (
    colour_loss,
    normal_consistency,
    normal_prior,
    surface_normals,
    unit,
    worst_pixels,
)


def view(width=40, height=30, turned=0.0):
    matrix = torch.eye(4, dtype=torch.float64)
    c, s = math.cos(turned), math.sin(turned)
    matrix[:3, :3] = torch.tensor([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]], dtype=torch.float64)
    return View(width, height, 36.0, 34.0, width / 2, height / 2, matrix)


def plane_depths(camera, normal, offset):
    """Depths of the plane n . p = offset in the world's axes, the camera in the origin."""
    rays = camera.directions(torch.float64)
    forward = camera.cam_from_world[2, :3]
    along = offset / (rays @ torch.tensor(normal, dtype=torch.float64))
    return along * (rays @ forward)


@pytest.mark.parametrize("tilt", [0.0, 0.3, 1.0, 1.3])
@pytest.mark.parametrize("turned", [0.0, 0.7])
def test_surface_normals_of_a_plane_are_its_own_and_face_the_camera(tilt, turned):
    camera = view(turned=turned)
    towards = camera.cam_from_world[:3, :3].T @ torch.tensor(
        [math.sin(tilt) * 0.6, math.sin(tilt) * 0.8, math.cos(tilt)], dtype=torch.float64
    )
    depths = plane_depths(camera, towards.tolist(), 8.0)
    seen = depths > 0.0
    alphas = torch.where(seen, 0.9, 0.0).double()
    normals, is_known = surface_normals(depths * alphas, alphas, camera)
    assert is_known.sum() > 200
    inner = is_known & (depths < 1e3)
    np.testing.assert_allclose(normals[inner].numpy(), np.broadcast_to(-towards, normals[inner].shape), atol=1e-6)
    assert not is_known[0].any()
    assert not is_known[:, -1].any()
    assert (normals[~is_known] == 0.0).all()


def test_normal_consistency_is_the_sum_of_eq_26():
    rng = torch.Generator().manual_seed(0)
    weights = 0.3 * torch.rand(5, 6, 3, generator=rng, dtype=torch.float64)
    of_splats = unit(torch.randn(5, 6, 3, 3, generator=rng, dtype=torch.float64))
    surface = unit(torch.randn(5, 6, 3, generator=rng, dtype=torch.float64))
    is_known = torch.rand(5, 6, generator=rng) > 0.3
    direct = (weights * (1.0 - (of_splats * surface[:, :, None]).sum(-1))).sum(-1)[is_known].mean()
    blended = (weights[..., None] * of_splats).sum(2)
    found = normal_consistency(blended, weights.sum(-1), surface, is_known)
    assert found.item() == pytest.approx(direct.item(), rel=1e-12)


def test_normal_consistency_of_a_flat_wall_is_zero_and_of_a_wrong_one_is_not():
    camera = view()
    depths = plane_depths(camera, [0.0, 0.0, 1.0], 5.0)
    alphas = torch.ones_like(depths)
    surface, is_known = surface_normals(depths, alphas, camera)
    right = torch.zeros(30, 40, 3, dtype=torch.float64)
    right[..., 2] = -1.0
    assert normal_consistency(right, alphas, surface, is_known).item() == pytest.approx(0.0, abs=1e-12)
    assert normal_consistency(-right, alphas, surface, is_known).item() == pytest.approx(2.0, abs=1e-12)


def test_depth_gradients_of_normal_consistency_are_those_of_differences():
    camera = view(7, 6)
    rng = torch.Generator().manual_seed(1)
    depths = (5.0 + torch.rand(6, 7, generator=rng, dtype=torch.float64)).requires_grad_()
    alphas = (0.6 + 0.3 * torch.rand(6, 7, generator=rng, dtype=torch.float64)).requires_grad_()
    normals = unit(torch.randn(6, 7, 3, generator=rng, dtype=torch.float64)).requires_grad_()

    def loss(z, a, n):
        return normal_consistency(n, a, *surface_normals(z, a, camera))

    assert torch.autograd.gradcheck(loss, (depths, alphas, normals))


def test_normal_prior_is_eq_23_over_pixels_that_have_a_reference():
    rng = torch.Generator().manual_seed(2)
    normals = torch.randn(4, 5, 3, generator=rng)
    reference = unit(torch.randn(4, 5, 3, generator=rng))
    reference[0] = 0.0
    mask = torch.rand(4, 5, generator=rng) > 0.4
    counted = mask.clone()
    counted[0] = False
    expected = (normals - reference).abs().sum(-1)[counted].mean()
    assert normal_prior(normals, reference, mask).item() == pytest.approx(expected.item(), rel=1e-6)


def test_where_nothing_counts_losses_and_gradients_are_zero():
    camera = view(12, 12)
    depths = torch.zeros(12, 12, requires_grad=True)
    alphas = torch.zeros(12, 12, requires_grad=True)
    normals = torch.zeros(12, 12, 3, requires_grad=True)
    colours = torch.full((12, 12, 3), 0.5, requires_grad=True)
    nowhere = torch.zeros(12, 12, dtype=torch.bool)
    everywhere = ~nowhere
    terms = [
        normal_consistency(normals, alphas, *surface_normals(depths, alphas, camera)),
        normal_prior(normals, torch.zeros(12, 12, 3), everywhere),
        normal_prior(normals, torch.ones(12, 12, 3), nowhere),
        worst_pixels(colours, torch.zeros(12, 12, 3), nowhere, 0.2),
        worst_pixels(colours, torch.full((12, 12, 3), 0.49), everywhere, 0.2),
        worst_pixels(colours, colours.detach(), everywhere, 0.0),
    ]
    assert [term.item() for term in terms] == [0.0] * len(terms)
    torch.stack(terms).sum().backward()
    for value in (depths, alphas, normals, colours):
        assert value.grad is None or (value.grad == 0.0).all()


numbers = st.floats(-1e3, 1e3, width=32)


@settings(max_examples=25, deadline=None)
@given(st.lists(st.tuples(numbers, numbers, numbers), min_size=1, max_size=4))
def test_unit_vectors_and_their_gradients_are_finite(vectors):
    tensor = torch.tensor(vectors, dtype=torch.float32, requires_grad=True)
    found = unit(tensor)
    found.sum().backward()
    assert torch.isfinite(found).all()
    assert torch.isfinite(tensor.grad).all()
    lengths = found.detach().norm(dim=-1)
    assert ((lengths == 0.0) | ((lengths - 1.0).abs() < 1e-5)).all()


def test_colour_loss_mixes_both_terms_and_leaves_dssim_out_of_tiny_windows():
    rng = torch.Generator().manual_seed(3)
    truth = 0.9 * torch.rand(16, 20, 3, generator=rng)
    found = truth + 0.05
    plain = colour_loss(found, truth, 0.0).item()
    assert plain == pytest.approx(0.05, rel=1e-5)
    assert colour_loss(truth, truth, 0.2).item() == pytest.approx(0.0, abs=1e-6)
    assert colour_loss(found, truth, 0.2).item() != pytest.approx(plain, rel=1e-3)
    assert colour_loss(found[:8], truth[:8], 0.2).item() == pytest.approx(0.05, rel=1e-5)


def test_what_is_brighter_than_an_overexposed_photo_is_no_error():
    truth = torch.ones(4, 4, 3)
    found = torch.full((4, 4, 3), 1.4, requires_grad=True)
    loss = colour_loss(found, truth, 0.2)
    loss.backward()
    assert loss.item() == 0.0
    assert (found.grad == 0.0).all()
    assert colour_loss(torch.full((4, 4, 3), 0.9), truth, 0.0).item() == pytest.approx(0.1, rel=1e-5)


def test_stages_of_the_high_frequency_loss_follow_each_other_evenly():
    stages = tuple(HighFrequencyStage(threshold, weight) for threshold, weight in ((0.2, 1.0), (0.1, 5.0)))
    weights = LossWeights(high_frequency=stages, high_frequency_from=0.2)
    assert weights.stage(0.1) is None
    assert weights.stage(0.2) == stages[0]
    assert weights.stage(0.59) == stages[0]
    assert weights.stage(0.61) == stages[1]
    assert weights.stage(1.0) == stages[1]
    assert LossWeights(high_frequency=()).stage(0.9) is None


def test_the_papers_schedule_runs_from_tau_02_to_009_and_weight_1_to_10():
    weights = LossWeights()
    first, last = weights.stage(weights.high_frequency_from), weights.stage(1.0)
    assert (first.threshold, first.weight) == (0.2, 1.0)
    assert (last.threshold, last.weight) == (0.09, 10.0)
    assert (weights.dssim, weights.normal_consistency) == (0.2, 0.05)
