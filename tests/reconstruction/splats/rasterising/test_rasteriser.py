"""The rasterisers against their definition, in values and in gradients."""

from __future__ import annotations

from dataclasses import replace

import pytest
import torch

from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.rasteriser import rasterise
from tests.reconstruction.splats.drawn_splats import draw, random_splats, relative_error, seeded, turned_view

VALUE_ERROR = 2e-6
"""Of float32 against float64, relative: 1.3e-7 was measured."""
GRADIENT_ERROR = 1e-5
"""1.1e-6 was measured."""


@pytest.mark.few(2)
@pytest.mark.parametrize(("n", "seed"), [(1, 0), (2, 1), (30, 2), (300, 3)])
def test_compiled_raster_is_the_defined_one_in_values_and_gradients(n: int, seed: int) -> None:
    view = turned_view()
    splats = random_splats(n, view, seed)
    labels = torch.randint(-1, 5, (n,), generator=seeded(seed), dtype=torch.int32)
    truth = draw(splats, view, "torch", labels=labels)
    found = draw(splats, view, "numba", labels=labels)
    for name in ("features", "alphas", "depths", "weights"):
        assert relative_error(getattr(found.raster, name), getattr(truth.raster, name)) < VALUE_ERROR, name
    assert torch.equal(found.raster.labels, truth.raster.labels)
    for gradient, true_gradient in zip(found.gradients, truth.gradients, strict=True):
        assert relative_error(gradient, true_gradient) < GRADIENT_ERROR
    if n >= 30:
        is_drawn = found.raster.radii_px > 0
        assert 0.3 * n < int(is_drawn.sum()) < 0.9 * n
        assert all(not gradient[~is_drawn].any() for gradient in found.gradients)
        assert int((truth.raster.weights > 0).sum()) > 0.3 * n
        assert not (truth.raster.weights[~is_drawn] > 0).any()


def test_gradients_of_the_definition_are_differences_of_its_values() -> None:
    view = turned_view(10, 8, 9.0)
    splats = random_splats(12, view, 5, channels=2)
    # Without the cut, which is a step, and with splats that stay clear of the largest alpha.
    settings = RasterSettings(min_alpha=1e-4, min_transmittance=0.0)
    smooth = splats.changed(opacities=splats.opacities.clamp(max=0.9))
    inputs = [t.clone().requires_grad_() for t in smooth.tensors]

    def values(*tensors: torch.Tensor) -> torch.Tensor:
        raster = rasterise(*tensors, view, settings=settings, backend="torch")
        return torch.cat([raster.features.flatten(), raster.alphas.flatten(), raster.depths.flatten()])

    assert torch.autograd.gradcheck(values, inputs, eps=1e-7, atol=2e-3, rtol=1e-3, fast_mode=True)


def test_screen_offsets_move_a_splat_in_the_picture() -> None:
    view = turned_view()
    splats = random_splats(8, view, 11)
    inputs = [t.to(torch.float32) for t in splats.tensors]
    moved = rasterise(*inputs, view, screen_offsets=torch.tensor([[3.0, -2.0]]).expand(8, 2))
    still = rasterise(*inputs, view.cropped(-3, 2, view.width_px, view.height_px))
    assert still.alphas.max() > 0.1
    torch.testing.assert_close(moved.alphas, still.alphas, atol=1e-6, rtol=1e-5)
    torch.testing.assert_close(moved.features, still.features, atol=1e-6, rtol=1e-5)


@pytest.mark.parametrize("threads", [2, 3])
def test_any_number_of_threads_gives_the_same_bits(threads: int) -> None:
    view = turned_view(100, 80, 90.0)
    splats = random_splats(400, view, 4, channels=6)
    labels = torch.arange(400, dtype=torch.int32) % 7
    one = draw(splats, view, "numba", labels=labels, settings=RasterSettings(threads=1))
    many = draw(splats, view, "numba", labels=labels, settings=RasterSettings(threads=threads))
    for name in ("features", "alphas", "depths", "labels", "weights", "radii_px"):
        assert torch.equal(getattr(one.raster, name), getattr(many.raster, name)), name
    assert all(torch.equal(a, b) for a, b in zip(one.gradients, many.gradients, strict=True))


def test_squares_of_any_size_give_the_same_raster() -> None:
    view = turned_view(50, 37, 45.0)
    splats = random_splats(200, view, 6)
    usual = draw(splats, view, "numba")
    for size in (8, 24, 64):
        other = draw(splats, view, "numba", settings=RasterSettings(tile_px=size))
        for name in ("features", "alphas", "depths", "weights"):
            assert relative_error(getattr(other.raster, name), getattr(usual.raster, name)) < VALUE_ERROR, name
        for a, b in zip(other.gradients, usual.gradients, strict=True):
            assert relative_error(a, b) < GRADIENT_ERROR


def test_the_order_of_splats_does_not_matter() -> None:
    view = turned_view()
    splats = random_splats(200, view, 8)
    order = torch.randperm(200, generator=seeded(0))
    straight, mixed = draw(splats, view, "numba"), draw(splats.picked(order), view, "numba")
    assert torch.equal(straight.raster.features, mixed.raster.features)
    assert torch.equal(straight.raster.weights[order], mixed.raster.weights)
    for a, b in zip(straight.gradients, mixed.gradients, strict=True):
        assert torch.equal(a[order], b)


def test_a_window_is_cut_out_of_the_whole_picture() -> None:
    view = turned_view(64, 48, 50.0)
    splats = random_splats(200, view, 9)
    whole = draw(splats, view, "numba", seed=None).raster
    window = draw(splats, view.cropped(13, 9, 30, 21), "numba", seed=None).raster
    for name in ("features", "alphas", "depths"):
        cut = getattr(whole, name)[9:30, 13:43]
        torch.testing.assert_close(getattr(window, name), cut, atol=3e-6, rtol=1e-5)
    aligned = draw(splats, view.cropped(16, 16, 32, 16), "numba", seed=None).raster
    torch.testing.assert_close(aligned.features, whole.features[16:32, 16:48], atol=1e-6, rtol=1e-6)


def test_labels_and_weights_are_those_of_what_is_seen() -> None:
    view = turned_view()
    splats = random_splats(60, view, 10)
    labels = torch.randint(-1, 200, (60,), generator=seeded(3), dtype=torch.int32)
    with_labels = draw(splats, view, "numba", labels=labels, seed=None).raster
    without = draw(splats, view, "numba", seed=None).raster
    assert without.labels is None
    assert torch.equal(with_labels.features, without.features)
    torch.testing.assert_close(without.weights.sum(), without.alphas.sum(), rtol=1e-5, atol=1e-3)
    assert (with_labels.labels[with_labels.alphas == 0.0] == -1).all()
    assert set(with_labels.labels.unique().tolist()) <= {-1, *labels.tolist()}


def test_losses_of_one_picture_alone_have_its_gradients() -> None:
    view = turned_view()
    splats = random_splats(30, view, 12)
    found = []
    for backend, dtype in (("numba", torch.float32), ("torch", torch.float64)):
        means = splats.means.to(dtype).clone().requires_grad_()
        others = [t.to(dtype) for t in splats.tensors[1:]]
        rasterise(means, *others, view, backend=backend).depths.sum().backward()
        found.append(means.grad)
    assert relative_error(*found) < GRADIENT_ERROR


def test_tensors_may_lie_in_memory_in_any_way() -> None:
    view = turned_view()
    splats = [t.float() for t in random_splats(30, view, 13).tensors]
    scattered = [t.repeat_interleave(2, dim=-1)[..., ::2] for t in splats]
    matrix = view.cam_from_world.T.contiguous().T
    straight = rasterise(*splats, view)
    bent = rasterise(*scattered, replace(view, cam_from_world=matrix))
    assert torch.equal(straight.features, bent.features)


def test_nothing_to_draw_is_an_empty_picture() -> None:
    view = turned_view()
    for backend in ("numba", "torch"):
        drawn = draw(random_splats(0, view), view, backend, labels=torch.zeros(0, dtype=torch.int32))
        assert drawn.raster.features.shape == (view.height_px, view.width_px, 5)
        assert not drawn.raster.alphas.any()
        assert (drawn.raster.labels == -1).all()


def test_wrong_shapes_and_precisions_are_refused() -> None:
    view = turned_view()
    means, quats, scales, opacities, features = random_splats(4, view).tensors
    with pytest.raises(ValueError, match=r"scales: expected shape \(4, 2\) or \(4, 3\), got \(4, 4\)"):
        rasterise(means, quats, torch.ones(4, 4), opacities, features, view)
    with pytest.raises(ValueError, match=r"features: expected torch\.float64 on cpu as the means are"):
        rasterise(means, quats, scales, opacities, features.float(), view)
    with pytest.raises(ValueError, match="numba: expected float32"):
        rasterise(means, quats, scales, opacities, features, view, backend="numba")
    with pytest.raises(ValueError, match="gsplat: expected float32 on a CUDA device"):
        rasterise(means, quats, scales, opacities, features, view, backend="gsplat")
    with pytest.raises(ValueError, match="features: expected shape"):
        rasterise(means, quats, scales, opacities, features[:, :0], view)
    with pytest.raises(ValueError, match="min_alpha"):
        RasterSettings(min_alpha=0.0)
    with pytest.raises(ValueError, match="tile_px"):
        RasterSettings(tile_px=10)
