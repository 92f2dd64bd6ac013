"""What is made from channels where gsplat lacks it, with the rasteriser for processors; gsplat itself on CUDA only."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest
import torch
from torch import Tensor

from planning.base.errors import InputError
from reconstruction.splats.rasterising.gsplat_backend import (
    accumulated_weights,
    boxes_of,
    filled_up,
    heaviest_labels,
    plane_channels,
    plane_depths,
    rasterise_gsplat,
    ray_transforms,
    why_not_gsplat,
)
from reconstruction.splats.rasterising.projection import blurred, depths_of, project
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.rasteriser import rasterise
from reconstruction.splats.rasterising.views import View
from tests.reconstruction.splats.drawn_splats import (
    MadeSplats,
    draw,
    level_view,
    one_splat,
    random_ellipsoids,
    random_splats,
    relative_error,
    seeded,
    tilted_plane,
    turned_view,
)

NEAR_M = 0.1
REACH = 3.0

on_cuda = pytest.mark.skipif(why_not_gsplat() != "", reason=f"no gsplat: {why_not_gsplat()}")


def blend_of(splats: MadeSplats, view: View) -> Callable[[Tensor], Tensor]:
    means, quats, scales, opacities, _ = (t.float() for t in splats.tensors)

    def blend(channels: Tensor) -> Tensor:
        return rasterise(means, quats, scales, opacities, channels, view).features

    return blend


@pytest.mark.parametrize("tilt_deg", [0.0, 45.0, 60.0])
def test_depths_from_plane_channels_are_exact_on_a_plane(tilt_deg: float) -> None:
    view = level_view(48, 24, 60.0)
    splats, depths = tilted_plane(view, tilt_deg, 0.2)
    raster = draw(splats, view, "numba", seed=None).raster
    planes = blend_of(splats, view)(plane_channels(splats.means, splats.quats, view).float())
    found = plane_depths(planes, raster.alphas, view, NEAR_M) / raster.alphas
    assert float((found - depths).abs().max()) < 1e-4


def test_normals_of_plane_channels_face_the_camera() -> None:
    view = turned_view()
    splats = random_splats(100, view, 1)
    channels = plane_channels(splats.means, splats.quats, view)
    assert (channels[:, 3] <= 0.0).all()
    torch.testing.assert_close(channels[:, :3].norm(dim=1), torch.ones(100, dtype=torch.float64))


def test_depths_where_nothing_is_met_are_numbers_with_finite_gradients() -> None:
    view = level_view(8, 6)
    planes = torch.zeros(6, 8, 4, requires_grad=True)
    depths = plane_depths(planes, torch.zeros(6, 8), view, NEAR_M)
    depths.sum().backward()
    assert not depths.any()
    assert planes.grad is not None
    assert planes.grad.isfinite().all()


def test_weights_and_labels_from_channels_are_those_of_the_rasteriser() -> None:
    view = turned_view()
    splats = random_splats(80, view, 2)
    labels = torch.randint(-1, 70, (80,), generator=seeded(2), dtype=torch.int32)
    raster = draw(splats, view, "numba", labels=labels, seed=None).raster
    blend = blend_of(splats, view)
    torch.testing.assert_close(accumulated_weights(blend, splats.means.float()), raster.weights, atol=1e-4, rtol=1e-4)
    assert torch.equal(heaviest_labels(blend, labels), raster.labels)


@pytest.mark.parametrize("blur_px", [0.0, 0.5])
def test_ray_transforms_and_boxes_are_those_of_the_discs(blur_px: float) -> None:
    view = turned_view(64, 48, 50.0)
    splats = random_splats(60, view, 4)
    seen = project(*(t[depths_of(splats.means, view) > NEAR_M] for t in splats.tensors[:3]), view)
    seen = blurred(seen, blur_px, 0.1) if blur_px else seen
    angles = torch.linspace(0.0, 2.0 * math.pi, 1000, dtype=torch.float64)
    rim = REACH * torch.stack([angles.cos(), angles.sin(), torch.full_like(angles, 1.0 / REACH)])
    across, down, depths = (ray_transforms(seen) @ rim).unbind(dim=1)
    further = 1.0 + seen.slopes @ rim[:2]
    torch.testing.assert_close(depths, seen.depths_m[:, None] * further)
    places = seen.centres_px[..., None] + seen.jacobians_px @ rim[:2] / further[:, None]
    is_before = further.min(dim=1).values > 0.0
    assert is_before.sum() > 0
    torch.testing.assert_close(torch.stack([across / depths, down / depths], dim=1), places)
    middles, halves = boxes_of(seen, REACH, view)
    low, high = places.min(dim=2).values, places.max(dim=2).values
    torch.testing.assert_close((middles - halves)[is_before], low[is_before], atol=1e-2, rtol=1e-4)
    torch.testing.assert_close((middles + halves)[is_before], high[is_before], atol=1e-2, rtol=1e-4)


def test_boxes_of_discs_that_reach_behind_the_camera_are_the_whole_picture() -> None:
    view = level_view(48, 24, 60.0)
    near = one_splat(depth_m=0.5, tilt_deg=60.0, scale_m=(3.0, 0.1))
    middles, halves = boxes_of(project(*near.tensors[:3], view), REACH, view)
    assert (middles - halves <= 0.0).all()
    assert (middles + halves >= torch.tensor([48.0, 24.0])).all()


@pytest.mark.parametrize(("n_channels", "n_filled"), [(1, 1), (2, 2), (3, 4), (15, 16), (16, 16), (33, 64)])
def test_channels_are_filled_up_with_zeros_to_a_power_of_two(n_channels: int, n_filled: int) -> None:
    channels = torch.rand(5, n_channels, requires_grad=True)
    filled = filled_up(channels)
    assert filled.shape == (5, n_filled)
    assert torch.equal(filled[:, :n_channels], channels)
    assert not filled[:, n_channels:].any()
    filled.sum().backward()
    assert channels.grad is not None
    assert torch.equal(channels.grad, torch.ones_like(channels))


@pytest.mark.skipif(why_not_gsplat() == "", reason="gsplat works here")
def test_without_cuda_or_gsplat_the_message_says_so() -> None:
    view = turned_view()
    tensors = [t.float() for t in random_splats(3, view).tensors]
    with pytest.raises(InputError, match=r"splats on CUDA are drawn by gsplat, and .*; or compute on the processor"):
        rasterise_gsplat(*tensors, view, None, None, RasterSettings())


@on_cuda
@pytest.mark.parametrize("is_antialiased", [False, True])
@pytest.mark.parametrize("made", [random_splats, random_ellipsoids])
def test_gsplat_s_raster_is_the_defined_one(made: Callable[..., MadeSplats], is_antialiased: bool) -> None:
    settings = RasterSettings(antialiased=is_antialiased)
    view = turned_view(64, 48, 50.0)
    splats = made(200, view, 3, channels=7)
    splats = splats.changed(opacities=splats.opacities.clamp(max=0.9))
    labels = torch.arange(200, dtype=torch.int32) % 40
    inputs = [t.float().cuda().requires_grad_() for t in splats.tensors]
    offsets = torch.zeros(200, 2, device="cuda", requires_grad=True)
    shared: dict[str, Any] = {"screen_offsets": offsets, "labels": labels.cuda(), "settings": settings}
    raster = rasterise(*inputs, view, **shared, backend="gsplat")
    g = seeded(1)
    total = (raster.features * torch.randn(raster.features.shape, generator=g).cuda()).sum()
    (total + (raster.alphas * torch.randn(raster.alphas.shape, generator=g).cuda()).sum()).backward()
    truth_inputs = [t.clone().requires_grad_() for t in splats.tensors]
    truth_offsets = torch.zeros(200, 2, dtype=torch.float64, requires_grad=True)
    shared = {"screen_offsets": truth_offsets, "labels": labels, "settings": settings}
    truth = rasterise(*truth_inputs, view, **shared, backend="torch")
    g = seeded(1)
    total = (truth.features * torch.randn(truth.features.shape, generator=g)).sum()
    (total + (truth.alphas * torch.randn(truth.alphas.shape, generator=g)).sum()).backward()
    # The rims differ: gsplat's low-pass filter lies in the middle of the box, and its stop rule is another.
    assert relative_error(raster.features.cpu(), truth.features) < 0.02
    assert relative_error(raster.alphas.cpu(), truth.alphas) < 0.02
    assert relative_error(raster.weights.cpu(), truth.weights) < 0.05
    assert float((raster.labels.cpu() != truth.labels).float().mean()) < 0.02
    for a, b in zip((*inputs, offsets), (*truth_inputs, truth_offsets), strict=True):
        assert relative_error(a.grad.cpu(), b.grad) < 0.1


@on_cuda
@pytest.mark.parametrize("n_channels", [3, 11])
def test_what_memory_held_before_does_not_reach_gradients(n_channels: int) -> None:
    view = turned_view(64, 48, 50.0)
    inputs = [t.float().cuda().requires_grad_() for t in random_splats(200, view, 3, channels=n_channels).tensors]
    for size in (200, 1600, 3200, 1 << 22):
        held = [torch.full((size,), math.nan, device="cuda") for _ in range(20)]
        del held
    raster = rasterise(*inputs, view)
    (raster.features.sum() + raster.alphas.sum() + raster.depths.sum()).backward()
    assert all(bool(t.grad.isfinite().all()) for t in inputs if t.grad is not None)


@on_cuda
def test_gsplat_s_depth_is_exact_on_a_plane() -> None:
    view = level_view(48, 24, 60.0)
    splats, depths = tilted_plane(view, 45.0, 0.2)
    raster = rasterise(*(t.float().cuda() for t in splats.tensors), view)
    assert float((raster.depths / raster.alphas - depths.cuda()).abs().max()) < 1e-3


@on_cuda
def test_gsplat_s_depth_of_an_ellipsoid_is_that_of_its_middle() -> None:
    tensors = [t.float().cuda() for t in one_splat(depth_m=4.0, tilt_deg=40.0, scale_m=(0.3, 0.4, 0.1)).tensors]
    raster = rasterise(*tensors, level_view())
    is_seen = raster.alphas > 0.01
    assert is_seen.any()
    assert float(((raster.depths / raster.alphas)[is_seen] - 4.0).abs().max()) < 1e-4
