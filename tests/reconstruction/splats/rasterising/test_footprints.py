"""Splats finer than a pixel: as much light as they send, in all rasterisers, with gradients that stay numbers."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from torch import Tensor

from reconstruction.splats.rasterising.projection import (
    Projected,
    areas_of,
    blurred,
    blurred_areas2,
    footprint_shares,
    shown_opacities,
)
from reconstruction.splats.rasterising.raster_types import RasterSettings, steepest
from reconstruction.splats.rasterising.rasteriser import rasterise
from reconstruction.splats.rasterising.views import View
from tests.reconstruction.splats.drawn_splats import (
    MadeSplats,
    both,
    draw,
    level_view,
    one_splat,
    random_ellipsoids,
    random_splats,
    relative_error,
    rounded,
    together,
    turned_view,
)

PLAIN, ANTIALIASED = RasterSettings(), RasterSettings(antialiased=True)
TO_THE_END = RasterSettings(antialiased=True, min_alpha=1e-4, min_transmittance=0.0)


@pytest.mark.few(1)
@pytest.mark.parametrize("made", [random_splats, random_ellipsoids])
@pytest.mark.parametrize("size", [1.0, 0.2, 0.02])
def test_compiled_rasters_are_the_defined_ones_in_values_and_gradients(
    made: Callable[..., MadeSplats], size: float
) -> None:
    view = turned_view()
    splats = made(200, view, 5)
    splats = rounded(splats.changed(scales=size * splats.scales))
    truth = draw(splats, view, "torch", settings=ANTIALIASED)
    found = draw(splats, view, "numba", settings=ANTIALIASED)
    for name in ("features", "alphas", "depths", "weights"):
        assert relative_error(getattr(found.raster, name), getattr(truth.raster, name)) < 5e-6, name
    for gradient, true_gradient in zip(found.gradients, truth.gradients, strict=True):
        assert relative_error(gradient, true_gradient) < 1e-5
    if size < 1.0:
        assert float(draw(splats, view, "numba").raster.alphas.sum()) > 1.2 * float(found.raster.alphas.sum()) > 0.0


@pytest.mark.parametrize("made", [random_splats, random_ellipsoids])
def test_gradients_of_the_definition_are_differences_of_its_values(made: Callable[..., MadeSplats]) -> None:
    view = turned_view(10, 8, 9.0)
    splats = made(12, view, 5, channels=2)
    smooth = splats.changed(opacities=splats.opacities.clamp(max=0.9), scales=0.6 * splats.scales)
    inputs = [t.clone().requires_grad_() for t in smooth.tensors]

    def values(*tensors: Tensor) -> Tensor:
        return rasterise(*tensors, view, settings=TO_THE_END, backend="torch").features

    assert torch.autograd.gradcheck(values, inputs, eps=1e-7, atol=2e-3, rtol=1e-3, fast_mode=True)


def test_discs_many_pixels_wide_are_drawn_as_without_antialiasing() -> None:
    view = turned_view(64, 48, 200.0)
    splats = random_splats(50, view, 4)
    wide = splats.changed(scales=splats.scales.clamp(min=0.2))

    def difference(factor: float) -> float:
        larger = rounded(wide.changed(scales=factor * wide.scales))
        plain, found = (draw(larger, view, "numba", settings=s, seed=None).raster for s in (PLAIN, ANTIALIASED))
        assert float(plain.alphas.mean()) > 0.1
        return relative_error(found.features, plain.features)

    # Those that are seen from the side stay thin, however large they are.
    assert difference(8.0) < 0.5 * difference(1.0) < 0.05


BLURRED_AT = 8
"""Times as finely as the picture."""


def _blurred_picture(splats: MadeSplats, view: View) -> Tensor:
    """Alphas as a picture blurred by `blur_px` shows them: drawn far more finely, blurred by sums, and looked up."""
    by, n = BLURRED_AT, BLURRED_AT * view.width_px
    fine = replace(
        view,
        width_px=n,
        height_px=by * view.height_px,
        fx_px=by * view.fx_px,
        fy_px=by * view.fy_px,
        cx_px=by * view.cx_px,
        cy_px=by * view.cy_px,
    )
    alphas = draw(splats, fine, "torch", settings=replace(TO_THE_END, antialiased=False), seed=None).raster.alphas

    def spread(n_fine: int) -> Tensor:
        """Of a fine row or column to a coarse one."""
        at = (torch.arange(n_fine, dtype=torch.float64) + 0.5) / by
        middles = torch.arange(n_fine // by, dtype=torch.float64) + 0.5
        weights = torch.exp(-0.5 * ((at - middles[:, None]) / TO_THE_END.blur_px) ** 2)
        return weights / (by * TO_THE_END.blur_px * math.sqrt(2.0 * math.pi))

    return spread(fine.height_px) @ alphas @ spread(n).T


@settings(max_examples=40, deadline=None)
@given(
    across_px=st.floats(0.15, 0.6),
    along_px=st.floats(0.15, 4.0),
    turned_deg=st.floats(-180.0, 180.0),
    tilt_deg=st.floats(0.0, 70.0),
    x_px=st.floats(-0.5, 0.5),
    y_px=st.floats(-0.5, 0.5),
)
def test_a_disc_is_drawn_as_a_blurred_picture_shows_it(
    across_px: float, along_px: float, turned_deg: float, tilt_deg: float, x_px: float, y_px: float
) -> None:
    view, depth_m, half = level_view(), 10.0, math.radians(0.5 * turned_deg)
    metres = depth_m / view.fx_px
    splat = one_splat(
        depth_m=depth_m,
        tilt_deg=tilt_deg,
        scale_m=(across_px * metres, along_px * metres),
        x_m=x_px * metres,
        y_m=y_px * metres,
        opacity=0.5,
    )
    w, x, y, z = splat.quats[0].tolist()
    turn = torch.tensor([math.cos(half), math.sin(half)], dtype=torch.float64)
    quat = torch.tensor([[w, -z], [x, y], [y, -x], [z, w]], dtype=torch.float64) @ turn
    splat = splat.changed(quats=quat[None])
    truth = _blurred_picture(splat, view)
    found = draw(splat, view, "torch", settings=TO_THE_END, seed=None).raster.alphas
    # The fine picture has a low-pass filter of its own, a twelfth of a pixel wide.
    assert float((found - truth).abs().max()) < 0.05 * float(truth.max()) + 2e-3


def test_a_long_thin_disc_has_no_gaps_other_than_without_antialiasing() -> None:
    view, depth_m = level_view(64, 64, 60.0), 10.0
    metres, half = depth_m / view.fx_px, math.radians(12.0)
    bar = one_splat(depth_m=depth_m, scale_m=(12.0 * metres, 0.1 * metres), opacity=0.9)
    bar = bar.changed(quats=torch.tensor([[math.cos(half), 0.0, 0.0, math.sin(half)]], dtype=torch.float64))

    def unevenness(settings_: RasterSettings) -> float:
        """Of what the columns beside the middle show: of a bar that is twelve pixels long they show nearly the same."""
        by_column = draw(bar, view, "numba", settings=settings_, seed=None).raster.alphas[:, 28:37].sum(dim=0)
        return float(by_column.std() / by_column.mean())

    assert unevenness(ANTIALIASED) < 0.1
    assert unevenness(PLAIN) > 0.5


@settings(max_examples=30, deadline=None)
@given(
    sigma_px=st.floats(0.05, 3.0),
    x_px=st.floats(-0.5, 0.5),
    y_px=st.floats(-0.5, 0.5),
    is_flat=st.booleans(),
    depth_m=st.floats(0.5, 500.0),
)
def test_a_round_splat_covers_its_own_area_however_small_and_wherever_in_the_pixel(
    sigma_px: float, x_px: float, y_px: float, is_flat: bool, depth_m: float
) -> None:
    view, opacity = level_view(), 0.6
    metres = depth_m / view.fx_px
    scale_m = (sigma_px * metres,) * (2 if is_flat else 3)
    splat = one_splat(depth_m=depth_m, scale_m=scale_m, opacity=opacity, x_m=x_px * metres, y_m=y_px * metres)
    found = draw(splat, view, "torch", settings=TO_THE_END, seed=None).raster
    area_px = 2.0 * math.pi * sigma_px * sigma_px
    # A ball off the axis is drawn a little longer; the cut at an alpha of 1e-4 takes some, of faint ones more.
    share = float(found.alphas.sum()) / (opacity * area_px)
    assert share == pytest.approx(1.0, abs=0.07 if sigma_px > 0.2 else 0.15)
    plain = draw(splat, view, "torch", settings=replace(TO_THE_END, antialiased=False), seed=None).raster
    if sigma_px < 0.3:
        assert float(plain.alphas.sum()) > 3.0 * opacity * area_px


def _bar(distance_m: float) -> MadeSplats:
    """A bar 2 cm wide and 2 m high, of discs side by side."""
    return together(*(one_splat(depth_m=distance_m, scale_m=(0.01, 0.01), y_m=0.02 * k, opacity=0.9)
                      for k in range(-50, 51)))  # fmt: skip


def test_a_bar_finer_than_a_pixel_fades_with_its_distance_and_does_not_grow() -> None:
    near, far = 2.0, 8.0
    view = level_view(64, 64, 60.0)

    def light(distance_m: float, settings_: RasterSettings) -> float:
        """Of a row of the picture across the bar's middle, as a share of what its width in pixels sends."""
        alphas = draw(_bar(distance_m), view, "numba", settings=settings_, seed=None).raster.alphas
        return float(alphas[32].sum()) / (view.fx_px * 0.02 / distance_m)

    assert light(far, PLAIN) > 3.0 * light(near, PLAIN)
    # What lies below the cut is missing: of the faintest splats almost half.
    assert light(far, ANTIALIASED) == pytest.approx(light(near, ANTIALIASED), rel=0.5)


HARD = {
    "tiny": one_splat(scale_m=(1e-12, 1e-12)),
    "below a pixel": one_splat(scale_m=(0.01, 0.02), x_m=0.03),
    "needle": one_splat(scale_m=(50.0, 1e-4), y_m=0.05),
    "edge-on": one_splat(tilt_deg=90.0),
    "almost edge-on": one_splat(tilt_deg=89.99, scale_m=(0.5, 0.2)),
    "huge": one_splat(scale_m=(1e6, 1e6)),
    "behind": one_splat(depth_m=-3.0),
    "ball of no size": one_splat(scale_m=(1e-12, 1e-12, 1e-12)),
    "thin ball": one_splat(scale_m=(0.3, 0.3, 1e-9), tilt_deg=90.0),
    "thread": one_splat(scale_m=(2.0, 1e-9, 1e-9), tilt_deg=30.0),
    "huge ball": one_splat(scale_m=(1e4, 1e4, 1e4)),
}


@pytest.mark.parametrize("name", HARD)
def test_hard_ones_are_drawn_alike_with_finite_gradients(name: str) -> None:
    both(HARD[name], ANTIALIASED)


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.floats(-9.0, 4.0), min_size=3, max_size=3),
    st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4),
    st.floats(0.11, 1e4),
    st.booleans(),
)
def test_shares_are_between_0_and_1_and_alike_in_float32_and_float64(
    log10_sizes: list[float], quat: list[float], depth_m: float, is_flat: bool
) -> None:
    view = level_view()
    means = torch.tensor([[0.02 * depth_m, -0.03 * depth_m, depth_m]], dtype=torch.float32)
    quats = torch.tensor([quat], dtype=torch.float32)
    scales = torch.tensor([[10.0**size for size in log10_sizes[: 2 if is_flat else 3]]], dtype=torch.float32)
    exact = footprint_shares(means.double(), quats.double(), scales.double(), view, ANTIALIASED)
    assert 0.0 <= float(exact) <= 1.0
    rough = footprint_shares(means, quats, scales, view, ANTIALIASED)
    # Float32 alone loses thin ones seen from the side: rasterisers compute in float64.
    assert float(rough) == pytest.approx(float(exact), abs=2e-3)
    opacity = torch.tensor([0.7])
    assert torch.equal(shown_opacities(means, quats, scales, opacity, view, PLAIN), opacity)
    assert ANTIALIASED.faintest <= float(shown_opacities(means, quats, scales, opacity, view, ANTIALIASED)) <= 0.7


def test_shares_of_things_in_the_way_hide_as_much_less() -> None:
    front = one_splat(depth_m=2.0, scale_m=(0.004, 0.004), opacity=0.99)
    behind = one_splat(depth_m=4.0, scale_m=(3.0, 3.0), opacity=0.99)
    view = level_view()
    seen = [
        draw(together(front, behind), view, "numba", settings=s, seed=None).raster.weights for s in (PLAIN, ANTIALIASED)
    ]
    assert float(seen[0][0]) > 10.0 * float(seen[1][0])
    assert float(seen[1][1]) > float(seen[0][1]) + 0.8 * float(seen[0][0] - seen[1][0])


@st.composite
def _projections(draw_: st.DrawFn) -> Projected:
    """A disc of any size that is seen from anywhere, from the front or from behind, and exactly from the side."""
    sizes = [10.0 ** draw_(st.floats(-6.0, 4.0)) for _ in range(2)]
    tilt, turn = draw_(st.floats(-math.pi / 2.0, math.pi / 2.0)), draw_(st.floats(-math.pi, math.pi))
    tilt = draw_(st.sampled_from([tilt, 0.5 * math.pi]))
    across = torch.tensor([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]], dtype=torch.float64)
    sizes_px = torch.diag(torch.tensor(sizes, dtype=torch.float64))
    jacobian = across @ torch.diag(torch.tensor([math.cos(tilt), 1.0], dtype=torch.float64)) @ sizes_px
    slopes = torch.tensor([[math.sin(tilt) * sizes[0] / FOCAL_PX, 0.0]], dtype=torch.float64)
    place = torch.zeros(1, 2, dtype=torch.float64)
    return Projected(place, torch.ones(1, dtype=torch.float64), jacobian[None], slopes)


FOCAL_PX = 60.0


def _planes(projected: Projected) -> Tensor:
    """p of discs that are not seen from the side, shape (n, 2)."""
    return -torch.linalg.solve(projected.jacobians_px.mT, projected.slopes[..., None])[..., 0]


@settings(max_examples=200, deadline=None)
@given(_projections(), st.floats(0.1, 1.0))
def test_a_blurred_disc_has_the_covariance_and_as_long_as_it_is_flat_enough_the_plane(
    disc: Projected, blur_px: float
) -> None:
    found = blurred(disc, blur_px, steepest(FOCAL_PX))
    jacobians = disc.jacobians_px
    covariance = jacobians @ jacobians.mT + blur_px**2 * torch.eye(2, dtype=torch.float64)
    torch.testing.assert_close(found.jacobians_px @ found.jacobians_px.mT, covariance, rtol=1e-9, atol=1e-9)
    root = float(torch.sqrt(blurred_areas2(jacobians, blur_px))[0])
    assert float(areas_of(found.jacobians_px)[0]) == pytest.approx(root, rel=1e-9)
    assert root >= blur_px**2
    is_flat = abs(float(areas_of(jacobians)[0])) > 1e-6 * float(jacobians.square().sum())
    limit, planes = steepest(FOCAL_PX), _planes(found)
    assert planes.isfinite().all()
    if is_flat and float(_planes(disc).norm()) < 0.999 * limit:
        torch.testing.assert_close(planes, _planes(disc), rtol=1e-6, atol=1e-9)
    # What is likely is never steeper than the disc is deep over how wide it is drawn.
    assert float(planes.norm()) <= limit + float(disc.slopes.norm()) / blur_px


@settings(max_examples=100, deadline=None)
@given(_projections(), st.floats(-1e-7, 1e-7))
def test_a_blurred_disc_changes_little_where_it_turns_over_from_front_to_back(disc: Projected, by_rad: float) -> None:
    def turned(tilt_rad: float) -> Projected:
        """Of a size that shows, seen nearly from the side."""
        jacobian = torch.tensor([[math.cos(tilt_rad), 0.0], [0.0, 1.0]], dtype=torch.float64)
        slopes = torch.tensor([[math.sin(tilt_rad) / FOCAL_PX, 0.0]], dtype=torch.float64)
        return blurred(replace(disc, jacobians_px=jacobian[None], slopes=slopes), 0.3, steepest(FOCAL_PX))

    one, other = turned(0.5 * math.pi), turned(0.5 * math.pi + by_rad)
    torch.testing.assert_close(one.jacobians_px, other.jacobians_px, rtol=0.0, atol=1e-6)
    torch.testing.assert_close(one.slopes, other.slopes, rtol=0.0, atol=1e-6)
