"""3-D Gaussians: the compiled raster against its definition, and the definition against what it says of itself."""

from __future__ import annotations

import math

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from reconstruction.splats.rasterising.projection import depths_of, project_ellipsoids, rotations, slope_limits
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.rasteriser import rasterise
from tests.reconstruction.splats.drawn_splats import (
    both,
    draw,
    level_view,
    one_splat,
    random_ellipsoids,
    relative_error,
    rounded,
    seeded,
    together,
    turned_view,
)

VALUE_ERROR = 2e-6
"""Of float32 against float64, relative: 2.2e-7 was measured."""
GRADIENT_ERROR = 1e-5
"""1.8e-6 was measured."""
BLUR2 = 0.3


@pytest.mark.parametrize(("n", "seed"), [(1, 0), (2, 1), (30, 2), (300, 3)])
def test_compiled_raster_is_the_defined_one_in_values_and_gradients(n: int, seed: int) -> None:
    view = turned_view()
    splats = random_ellipsoids(n, view, seed)
    labels = torch.randint(-1, 5, (n,), generator=seeded(seed), dtype=torch.int32)
    truth = draw(splats, view, "torch", labels=labels)
    found = draw(splats, view, "numba", labels=labels)
    for name in ("features", "alphas", "depths", "weights"):
        assert relative_error(getattr(found.raster, name), getattr(truth.raster, name)) < VALUE_ERROR, name
    assert torch.equal(found.raster.labels, truth.raster.labels)
    for gradient, true_gradient in zip(found.gradients, truth.gradients, strict=True):
        assert gradient.shape == true_gradient.shape
        assert relative_error(gradient, true_gradient) < GRADIENT_ERROR
    if n >= 30:
        is_drawn = found.raster.radii_px > 0
        assert 0.3 * n < int(is_drawn.sum()) < 0.9 * n
        assert all(not gradient[~is_drawn].any() for gradient in found.gradients)
        assert not (truth.raster.weights[~is_drawn] > 0).any()
        assert (found.gradients[2][truth.raster.weights > 1.0].abs() > 0.0).all()


def test_gradients_of_the_definition_are_differences_of_its_values() -> None:
    view = turned_view(10, 8, 9.0)
    splats = random_ellipsoids(12, view, 5, channels=2)
    smooth = splats.changed(opacities=splats.opacities.clamp(max=0.9))
    inputs = [t.clone().requires_grad_() for t in smooth.tensors]
    # Without the cut, which is a step.
    without_end = RasterSettings(min_alpha=1e-4, min_transmittance=0.0)

    def values(*tensors: Tensor) -> Tensor:
        raster = rasterise(*tensors, view, settings=without_end, backend="torch")
        return torch.cat([raster.features.flatten(), raster.alphas.flatten(), raster.depths.flatten()])

    assert torch.autograd.gradcheck(values, inputs, eps=1e-7, atol=2e-3, rtol=1e-3, fast_mode=True)


def test_discs_are_the_covariance_carried_through_the_derivative_of_the_camera() -> None:
    view = turned_view()
    splats = random_ellipsoids(60, view, 4)
    inside = splats.picked(depths_of(splats.means, view) > 0.1)
    found = project_ellipsoids(inside.means, inside.quats, inside.scales, view, math.sqrt(BLUR2))
    left, right, top, bottom = slope_limits(view)
    camera = view.cam_from_world

    def pixel(point: Tensor) -> Tensor:
        x, y, z = camera[:3, :3] @ point + camera[:3, 3]
        return torch.stack([view.fx_px * x / z + view.cx_px, view.fy_px * y / z + view.cy_px])

    n_compared = 0
    for i in range(len(inside.means)):
        torch.testing.assert_close(found.centres_px[i], pixel(inside.means[i]))
        x, y, z = (camera[:3, :3] @ inside.means[i] + camera[:3, 3]).tolist()
        if not (left < x / z < right and top < y / z < bottom):
            continue
        n_compared += 1
        change = torch.autograd.functional.jacobian(pixel, inside.means[i])
        turned = rotations(inside.quats[i])
        covariance = turned @ torch.diag(inside.scales[i] ** 2) @ turned.T
        expected = change @ covariance @ change.T + BLUR2 * torch.eye(2, dtype=torch.float64)
        torch.testing.assert_close(found.jacobians_px[i] @ found.jacobians_px[i].T, expected)
    assert n_compared > 30


@pytest.mark.parametrize("sigma_m", [1e-6, 0.02, 0.1, 0.4])
def test_a_ball_before_the_camera_is_the_blurred_gaussian(sigma_m: float) -> None:
    view, depth_m, opacity = level_view(), 4.0, 0.8
    ball = one_splat(depth_m=depth_m, scale_m=(sigma_m,) * 3, opacity=opacity, tilt_deg=35.0)
    found = both(ball).raster
    x = torch.arange(view.width_px) + 0.5 - view.cx_px
    y = torch.arange(view.height_px) + 0.5 - view.cy_px
    variance = (view.fx_px * sigma_m / depth_m) ** 2 + BLUR2
    expected = opacity * torch.exp(-0.5 * (x**2 + y[:, None] ** 2) / variance)
    expected = torch.where(expected >= 1.0 / 255.0, expected, torch.zeros_like(expected))
    torch.testing.assert_close(found.alphas, expected.float(), atol=2e-6, rtol=1e-5)
    torch.testing.assert_close(found.depths, depth_m * found.alphas)


def test_a_flat_ellipsoid_seen_face_on_is_a_flat_splat_of_its_blurred_size() -> None:
    view, depth_m = level_view(), 4.0
    sizes = (0.5, 0.25)
    blur_m = math.sqrt(BLUR2) * depth_m / view.fx_px
    for x_m, y_m in ((0.0, 0.0), (0.7, -0.4)):
        wide = tuple(math.hypot(size, blur_m) for size in sizes)
        flat = draw(one_splat(depth_m=depth_m, scale_m=wide, x_m=x_m, y_m=y_m), view, "numba")
        solid = draw(one_splat(depth_m=depth_m, scale_m=(*sizes, 1e-9), x_m=x_m, y_m=y_m), view, "numba")
        for name in ("features", "alphas", "depths", "weights", "radii_px"):
            torch.testing.assert_close(getattr(solid.raster, name), getattr(flat.raster, name), atol=1e-5, rtol=1e-5)
        for place in (3, 4, 5):
            torch.testing.assert_close(solid.gradients[place], flat.gradients[place], atol=1e-4, rtol=1e-4)
        share = torch.tensor([[a / b for a, b in zip(sizes, wide, strict=True)]])
        torch.testing.assert_close(solid.gradients[2][:, :2], share * flat.gradients[2], atol=1e-3, rtol=1e-4)


def test_naming_the_axes_in_another_order_changes_nothing() -> None:
    view = turned_view()
    splats = random_ellipsoids(40, view, 6)
    # A third of a turn about (1, 1, 1) takes x to y, y to z and z to x.
    w, x, y, z = splats.quats.unbind(1)
    turned = 0.5 * torch.stack([w - x - y - z, w + x + y - z, w - x + y + z, w + x - y + z], dim=1)
    renamed = splats.changed(quats=turned, scales=splats.scales[:, [1, 2, 0]])
    one, other = draw(splats, view, "torch", seed=None).raster, draw(renamed, view, "torch", seed=None).raster
    torch.testing.assert_close(one.features, other.features)
    assert float(one.alphas.mean()) > 0.03


def test_screen_offsets_move_an_ellipsoid_in_the_picture() -> None:
    view = turned_view()
    inputs = [t.float() for t in random_ellipsoids(20, view, 11).tensors]
    offsets = torch.tensor([[16.0, 0.0]]).expand(20, 2)
    moved = rasterise(*inputs, view, screen_offsets=offsets).features
    still = rasterise(*inputs, view).features
    torch.testing.assert_close(moved[:, 16:], still[:, :-16], atol=2e-6, rtol=1e-5)
    assert float(still[:, :-16].abs().mean()) > 0.01


@pytest.mark.parametrize("threads", [2, 3])
def test_any_number_of_threads_gives_the_same_bits(threads: int) -> None:
    view = turned_view(100, 80, 90.0)
    splats = random_ellipsoids(400, view, 4, channels=6)
    labels = torch.arange(400, dtype=torch.int32) % 7
    one = draw(splats, view, "numba", labels=labels, settings=RasterSettings(threads=1))
    many = draw(splats, view, "numba", labels=labels, settings=RasterSettings(threads=threads))
    for name in ("features", "alphas", "depths", "labels", "weights", "radii_px"):
        assert torch.equal(getattr(one.raster, name), getattr(many.raster, name)), name
    assert all(torch.equal(a, b) for a, b in zip(one.gradients, many.gradients, strict=True))


def test_squares_of_any_size_and_any_order_give_the_same_raster() -> None:
    view = turned_view(50, 37, 45.0)
    splats = random_ellipsoids(200, view, 6)
    usual = draw(splats, view, "numba")
    other = draw(splats, view, "numba", settings=RasterSettings(tile_px=24))
    for name in ("features", "alphas", "depths", "weights"):
        assert relative_error(getattr(other.raster, name), getattr(usual.raster, name)) < VALUE_ERROR, name
    for a, b in zip(other.gradients, usual.gradients, strict=True):
        assert relative_error(a, b) < GRADIENT_ERROR
    order = torch.randperm(200, generator=seeded(0))
    mixed = draw(splats.picked(order), view, "numba")
    assert torch.equal(usual.raster.features, mixed.raster.features)
    assert all(torch.equal(a[order], b) for a, b in zip(usual.gradients, mixed.gradients, strict=True))


def test_a_window_is_cut_out_of_the_whole_picture() -> None:
    view = turned_view(64, 48, 50.0)
    splats = random_ellipsoids(200, view, 9)
    wide = splats.changed(scales=splats.scales * torch.tensor([1.0, 1.0, 8.0], dtype=torch.float64))
    whole = draw(wide, view, "numba").raster
    again = view.cropped(10, 5, 40, 30).cropped(3, 4, 30, 21)
    for window in (view.cropped(13, 9, 30, 21), again):
        part = draw(wide, window, "numba", seed=None).raster
        for name in ("features", "alphas", "depths"):
            torch.testing.assert_close(getattr(part, name), getattr(whole, name)[9:30, 13:43], atol=3e-6, rtol=1e-5)
        torch.testing.assert_close(slope_limits(window), slope_limits(view))


HARD = {
    "tiny": one_splat(scale_m=(1e-9, 1e-12, 1e-10), x_m=0.03),
    "below a pixel": one_splat(scale_m=(0.01, 0.03, 0.02), x_m=0.03, y_m=0.02),
    "huge": one_splat(scale_m=(1e4, 1e6, 1e5), opacity=0.7),
    "needle across": one_splat(scale_m=(20.0, 1e-5, 1e-5), tilt_deg=20.0, y_m=0.01),
    "needle along the line of sight": one_splat(scale_m=(1e-5, 1e-5, 20.0), x_m=0.2, y_m=0.1),
    "needle askew": one_splat(scale_m=(30.0, 1e-4, 1e-4)).changed(
        quats=torch.tensor([[math.cos(0.4), 0.0, 0.0, math.sin(0.4)]], dtype=torch.float64)
    ),
    "pancake edge-on": one_splat(scale_m=(0.5, 0.4, 1e-7), tilt_deg=90.0, x_m=0.01),
    "pancake nearly edge-on": one_splat(scale_m=(0.5, 0.4, 1e-7), tilt_deg=89.99, x_m=0.3),
    "pancake face on": one_splat(scale_m=(0.5, 0.4, 1e-7)),
    "before the lens": one_splat(depth_m=0.11, scale_m=(0.05, 0.02, 0.3), x_m=0.01),
    "far away": one_splat(depth_m=1e6, scale_m=(1e5, 3e4, 1e5)),
    "at the border": one_splat(x_m=2.2, y_m=-1.6, scale_m=(0.3, 0.2, 0.4)),
    "beyond the border": one_splat(x_m=3.5, scale_m=(0.8, 0.2, 0.4)),
    "far beyond the border": one_splat(x_m=30.0, y_m=-5.0, scale_m=(16.0, 6.0, 20.0), tilt_deg=40.0),
    "opaque": together(one_splat(opacity=1.0, scale_m=(0.3,) * 3), one_splat(depth_m=5.0, scale_m=(0.4,) * 3)),
    "equally deep": together(*(one_splat(x_m=0.1 * k, scale_m=(0.3, 0.2, 0.1 * k + 0.1)) for k in range(4))),
}


@pytest.mark.parametrize("name", HARD)
def test_hard_ones_are_drawn_alike_with_finite_gradients(name: str) -> None:
    assert float(both(HARD[name]).raster.alphas.max()) > 0.1


def test_none_falls_between_pixels() -> None:
    for x_m, y_m in ((0.0, 0.0), (0.05, 0.03), (0.0667, 0.0667)):
        found = both(one_splat(scale_m=(1e-6,) * 3, x_m=x_m, y_m=y_m)).raster
        assert float(found.alphas.sum()) == pytest.approx(0.8 * 2.0 * math.pi * BLUR2, rel=0.03)


def test_behind_the_camera_or_nearer_than_near_none_is_drawn() -> None:
    for depth_m in (-4.0, 0.0, 0.05, 0.0999):
        found = both(one_splat(depth_m=depth_m, scale_m=(0.3, 0.3, 3.0)))
        assert not found.raster.alphas.any()
        assert float(found.raster.radii_px[0]) == 0.0
        assert not any(gradient.any() for gradient in found.gradients)


def test_what_is_beside_the_camera_does_not_smear_over_the_picture() -> None:
    # Its derivative at x / z = 20 is 20 times that in the middle, and would carry it 80 pixels into the picture.
    view = level_view()
    beside = one_splat(depth_m=0.2, x_m=4.0, scale_m=(0.01, 0.01, 0.3))
    assert not both(beside).raster.alphas.any()
    z = 0.2
    unlimited_px = 3.3 * view.fx_px * 0.3 * (4.0 / z) / z
    assert unlimited_px > view.fx_px * 4.0 / z


def test_what_is_no_number_is_not_drawn_and_spoils_nothing() -> None:
    good, view = one_splat(scale_m=(0.3, 0.3, 0.3)), level_view()
    alone = draw(good, view, "numba", seed=None).raster.features
    for name in ("means", "quats", "scales", "opacities"):
        for value in (math.nan, math.inf, -math.inf):
            bad = one_splat(depth_m=3.0, scale_m=(0.3, 0.3, 0.3))
            spoiled = getattr(bad, name).clone()
            spoiled[0, ...] = value
            for backend in ("numba", "torch"):
                drawn = draw(together(bad.changed(**{name: spoiled}), good), view, backend)
                torch.testing.assert_close(drawn.raster.features.float(), alone, atol=1e-6, rtol=1e-5)
                assert all(gradient.isfinite().all() for gradient in drawn.gradients)


def test_numbers_at_the_end_of_float32_give_numbers() -> None:
    view = level_view()
    far = one_splat(scale_m=(0.3,) * 3)
    for means in ((1e38, 0.0, 1.0), (0.0, -1e30, 1e30), (3e38, 3e38, 0.2), (1e20, 0.0, 5.0)):
        for scale in (1e-38, 1e15, 1e30, 3e38):
            extreme = far.changed(
                means=torch.tensor([means], dtype=torch.float64),
                scales=torch.full((1, 3), scale, dtype=torch.float64),
            )
            found = draw(extreme, view, "numba")
            assert all(t.isfinite().all() for t in (found.raster.features, found.raster.depths, *found.gradients))


def test_quaternions_of_any_length_turn_alike_and_zero_stands_for_none() -> None:
    splat = one_splat(tilt_deg=40.0, scale_m=(0.4, 0.2, 0.1))
    pictures = [both(splat.changed(quats=splat.quats * length)).raster.alphas for length in (1e-6, 1.0, 1e6)]
    torch.testing.assert_close(pictures[0], pictures[1])
    torch.testing.assert_close(pictures[2], pictures[1])
    none = both(splat.changed(quats=torch.zeros(1, 4, dtype=torch.float64)))
    torch.testing.assert_close(none.raster.alphas, both(one_splat(scale_m=(0.4, 0.2, 0.1))).raster.alphas)
    assert not none.gradients[1].any()


def test_nothing_to_draw_is_an_empty_picture() -> None:
    view = turned_view()
    for backend in ("numba", "torch"):
        drawn = draw(random_ellipsoids(0, view), view, backend, labels=torch.zeros(0, dtype=torch.int32))
        assert drawn.raster.features.shape == (view.height_px, view.width_px, 5)
        assert not drawn.raster.alphas.any()
        assert drawn.gradients[2].shape == (0, 3)


def test_sizes_are_two_or_three() -> None:
    view = turned_view()
    means, quats, _, opacities, features = random_ellipsoids(4, view).tensors
    for shape in ((4, 1), (4, 4), (3, 3), (4,)):
        with pytest.raises(ValueError, match=r"scales: expected shape \(4, 2\) or \(4, 3\), got"):
            rasterise(means, quats, torch.ones(shape, dtype=torch.float64), opacities, features, view)
    with pytest.raises(ValueError, match="blur_px: expected more than 0"):
        RasterSettings(blur_px=0.0)


sizes_m = st.floats(-16.0, 8.0).map(math.exp)
turns = st.floats(-1.0, 1.0)


@settings(max_examples=60, deadline=None)
@given(
    st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(-1.0, 30.0)),
    st.tuples(sizes_m, sizes_m, sizes_m),
    st.tuples(turns, turns, turns, turns),
    st.floats(0.003, 1.0),
)
def test_any_ellipsoid_is_drawn_as_it_is_defined(
    place: tuple[float, ...], sizes: tuple[float, ...], turn: tuple[float, ...], opacity: float
) -> None:
    view = level_view(16, 12, 15.0)
    splat = rounded(
        one_splat(opacity=opacity).changed(
            means=torch.tensor([place], dtype=torch.float64),
            scales=torch.tensor([sizes], dtype=torch.float64),
            quats=torch.tensor([turn], dtype=torch.float64),
        )
    )
    found, truth = draw(splat, view, "numba"), draw(splat, view, "torch", seed=None).raster
    # A step of the cut is as large as the cut.
    off = (found.raster.alphas.double() - truth.alphas).abs()
    assert bool(((off < 2e-4) | ((off < 0.0041) & (truth.alphas < 0.0041))).all())
    assert float(found.raster.alphas.max()) <= 0.99 + 1e-6
    assert all(gradient.isfinite().all() for gradient in found.gradients)
    seen = found.raster.alphas > 0
    assert bool(((found.raster.depths / found.raster.alphas)[seen] / place[2] - 1.0).abs().lt(1e-5).all())


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 12), st.integers(0, 1000))
def test_a_scene_that_is_larger_and_further_away_looks_the_same(doublings: int, seed: int) -> None:
    view, times = level_view(16, 12, 15.0), 2.0**doublings
    splats = random_ellipsoids(12, view, seed)
    far = splats.changed(means=times * splats.means, scales=times * splats.scales)
    near, away = draw(splats, view, "numba").raster, draw(far, view, "numba", seed=None).raster
    torch.testing.assert_close(away.alphas, near.alphas, atol=1e-6, rtol=1e-6)
    torch.testing.assert_close(away.depths, times * near.depths, atol=1e-6 * times, rtol=1e-6)
