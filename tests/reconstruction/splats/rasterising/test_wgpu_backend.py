"""The rasteriser for graphics cards against the definition, in values and gradients; by lavapipe where no card is."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch import Tensor

from reconstruction.gpu.device import Device, DeviceFailed, open_device, why_no_gpu
from reconstruction.splats.rasterising import wgpu_backend
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.rasteriser import rasterise
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.rasterising.wgpu_backend import rasterise_wgpu
from tests.reconstruction.splats.drawn_splats import (
    Drawn,
    MadeSplats,
    draw,
    level_view,
    one_splat,
    random_ellipsoids,
    random_splats,
    relative_error,
    rounded,
    seeded,
    together,
    turned_view,
)


@pytest.fixture(autouse=True)
def _card() -> None:
    if reason := why_no_gpu():
        pytest.skip(f"no graphics card: {reason}")


PLAIN, ANTIALIASED = RasterSettings(), RasterSettings(antialiased=True)
VALUE_ERROR = 1e-4
"""Of float32 all the way against float64, relative: 1e-6 was measured, and 4e-5 edge-on."""
GRADIENT_ERROR = 1e-4

NAMES = ("means", "quats", "scales", "opacities", "features", "offsets")


def compare(found: Drawn, truth: Drawn, error: float = GRADIENT_ERROR) -> None:
    for name in ("features", "alphas", "depths", "weights"):
        values = getattr(found.raster, name)
        assert values.isfinite().all(), name
        assert relative_error(values, getattr(truth.raster, name)) < VALUE_ERROR, name
    for name, gradient, true_gradient in zip(NAMES, found.gradients, truth.gradients, strict=True):
        assert gradient.isfinite().all(), name
        assert relative_error(gradient, true_gradient) < error, name


def by_card(splats: MadeSplats, settings: RasterSettings = PLAIN, error: float = GRADIENT_ERROR) -> Drawn:
    """Draw with the card, and compare with the definition."""
    view, given = level_view(), rounded(splats)
    found = draw(given, view, "wgpu", settings=settings)
    compare(found, draw(given, view, "torch", settings=settings), error)
    return found


@pytest.mark.long
@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("made", "settings"),
    [
        (random_splats, PLAIN),
        (random_ellipsoids, ANTIALIASED),
        (random_splats, ANTIALIASED),
        (random_ellipsoids, PLAIN),
    ],
)
def test_the_raster_is_the_defined_one_in_values_and_gradients(
    made: Callable[..., MadeSplats], settings: RasterSettings
) -> None:
    view = turned_view()
    splats = made(300, view, 3)
    labels = torch.randint(-1, 5, (300,), generator=seeded(3), dtype=torch.int32)
    truth = draw(splats, view, "torch", labels=labels, settings=settings)
    found = draw(splats, view, "wgpu", labels=labels, settings=settings)
    compare(found, truth)
    assert torch.equal(found.raster.labels, truth.raster.labels)
    is_drawn = found.raster.radii_px > 0
    assert 90 < int(is_drawn.sum()) < 270
    assert not (truth.raster.weights[~is_drawn] > 0).any()
    assert all(not gradient[~is_drawn].any() for gradient in found.gradients)


def hard_cases() -> Iterator[tuple[str, MadeSplats]]:
    """As in `test_raster_types_hard_cases`."""
    for tilt_deg in (0.0, 60.0, 89.0, 89.9, 89.9999, 90.0, 180.0):
        yield f"tilted by {tilt_deg}", one_splat(tilt_deg=tilt_deg, x_m=0.02, y_m=0.01)
    for tilt_deg in (75.0, 89.5, -85.0):
        yield f"cut at near {tilt_deg}", one_splat(tilt_deg=tilt_deg, depth_m=1.0, scale_m=(2.0, 0.5), x_m=0.3)
    for depth_m in (-4.0, 0.0, 0.0999):
        yield f"behind or too near {depth_m}", one_splat(depth_m=depth_m)
    for scale_m in (1e-12, 1e-3, 1e2, 1e6):
        yield f"sized {scale_m}", one_splat(scale_m=(scale_m, scale_m), opacity=0.7, x_m=0.03)
    for scale_m in (1e-12, 1e-3, 1e2, 1e4):
        yield f"ball of {scale_m}", one_splat(scale_m=(scale_m, scale_m, scale_m), opacity=0.7, x_m=0.03)
    yield "needle", one_splat(scale_m=(50.0, 1e-4), y_m=0.05)
    yield "opaque", together(one_splat(opacity=1.0), one_splat(depth_m=5.0, opacity=0.5))
    sheets = (one_splat(depth_m=4.0 + 0.01 * k, opacity=0.6, scale_m=(500.0, 500.0)) for k in range(60))
    yield "sheets", together(*sheets)
    yield "alike in depth", together(one_splat(opacity=0.9), one_splat(opacity=0.9, x_m=0.1))
    turned = one_splat(tilt_deg=40.0)
    for length in (0.0, 1e-6, 1e6):
        yield f"turn of length {length}", turned.changed(quats=turned.quats * length)
    yield "dead", one_splat(opacity=0.99 / 255.0)
    yield "faint", one_splat(opacity=1.2 / 255.0)


@pytest.mark.long
@pytest.mark.few(8)
@pytest.mark.parametrize(
    ("name", "splats"), list(hard_cases()), ids=lambda value: value if isinstance(value, str) else ""
)
def test_hard_splats_are_the_defined_ones(name: str, splats: MadeSplats) -> None:
    for settings in (PLAIN, ANTIALIASED):
        by_card(splats, settings)


@pytest.mark.long
@given(
    tilt_deg=st.floats(0.0, 180.0),
    turned_deg=st.floats(-180.0, 180.0),
    sizes_px=st.tuples(st.floats(-2.0, 3.0), st.floats(-2.0, 3.0), st.floats(-2.0, 3.0)),
    place_px=st.tuples(st.floats(-4.0, 36.0), st.floats(-4.0, 28.0)),
    depth_m=st.floats(0.11, 1000.0),
    opacity=st.floats(0.005, 1.0),
    is_flat=st.booleans(),
    antialiased=st.booleans(),
)
def test_any_splat_is_the_defined_one(
    tilt_deg: float,
    turned_deg: float,
    sizes_px: tuple[float, float, float],
    place_px: tuple[float, float],
    depth_m: float,
    opacity: float,
    is_flat: bool,
    antialiased: bool,
) -> None:
    view = level_view()
    metres = depth_m / view.fx_px
    splat = one_splat(
        depth_m=depth_m,
        tilt_deg=tilt_deg,
        scale_m=tuple(metres * 10.0**size for size in sizes_px[: 2 if is_flat else 3]),
        opacity=opacity,
        x_m=metres * (place_px[0] - view.cx_px),
        y_m=metres * (place_px[1] - view.cy_px),
    )
    half = math.radians(0.5 * turned_deg)
    w, x, y, z = splat.quats[0].tolist()
    turn = torch.tensor([math.cos(half), math.sin(half)], dtype=torch.float64)
    quat = torch.tensor([[w, -z], [x, y], [y, -x], [z, w]], dtype=torch.float64) @ turn
    given_splat, chosen = rounded(splat.changed(quats=quat[None])), ANTIALIASED if antialiased else PLAIN
    truth, found = (draw(given_splat, view, backend, settings=chosen) for backend in ("torch", "wgpu"))
    # Where a splat ends is a step: a pixel may be on either side of it.
    is_step = (truth.raster.alphas > 0.0) != (found.raster.alphas > 0.0)
    assert int(is_step.sum()) <= 2
    apart = (found.raster.alphas - truth.raster.alphas).abs()[~is_step]
    assert float(apart.max()) < 2e-3
    for name, gradient, true_gradient in zip(NAMES, found.gradients, truth.gradients, strict=True):
        assert gradient.isfinite().all(), name
        if not is_step.any():
            assert relative_error(gradient, true_gradient) < 1e-3, name


@pytest.mark.long
def test_what_is_no_number_is_not_drawn_and_spoils_nothing() -> None:
    good, view = one_splat(), level_view()
    alone = draw(good, view, "wgpu", seed=None).raster.features
    spoilt = []
    for name in ("means", "quats", "scales", "opacities"):
        for value in (math.nan, math.inf, -math.inf):
            bad = one_splat(depth_m=3.0)
            values = getattr(bad, name).clone()
            values[0, ...] = value
            spoilt.append(bad.changed(**{name: values}))
    drawn = draw(together(*spoilt, good), view, "wgpu")
    torch.testing.assert_close(drawn.raster.features, alone, atol=1e-6, rtol=1e-5)
    assert all(gradient.isfinite().all() and not gradient[:-1].any() for gradient in drawn.gradients)


def test_nothing_to_draw_is_an_empty_picture_with_gradients() -> None:
    drawn = draw(random_splats(0, turned_view()), turned_view(), "wgpu", labels=torch.zeros(0, dtype=torch.int32))
    assert drawn.raster.features.shape == (28, 40, 5)
    assert not drawn.raster.alphas.any()
    assert (drawn.raster.labels == -1).all()


def test_thousands_of_splats_on_one_pixel_are_blended_in_order() -> None:
    n = 4096
    g = seeded(2)
    one = one_splat(scale_m=(0.02, 0.02))
    depths = 4.0 + 0.001 * torch.arange(n, dtype=torch.float64)[torch.randperm(n, generator=g)]
    means = torch.stack([torch.zeros(n), torch.zeros(n), depths], dim=1).double()
    opacities = 0.005 + 0.002 * torch.rand(n, generator=g, dtype=torch.float64)
    features = torch.randn(n, 2, generator=g, dtype=torch.float64)
    splats = MadeSplats(means, one.quats.expand(n, 4), one.scales.expand(n, 2), opacities, features)
    view, settings = level_view(), replace(PLAIN, min_transmittance=1e-6)
    compare(draw(splats, view, "wgpu", settings=settings), draw(splats, view, "numba", settings=settings))


@pytest.mark.parametrize("across", [128, pytest.param(330, marks=pytest.mark.slow)])
def test_more_patches_or_bins_than_one_axis_of_workgroups_has_are_drawn(across: int) -> None:
    # 128 x 65 bins have 66560 patches; 330 x 200 are 66000 bins.
    down = 65 if across == 128 else 200
    view = level_view(16 * across, 16 * down, 3000.0)
    x, y = (7.9 * number / 3000.0 * 4.0 for number in (across, down))
    corners = [one_splat(x_m=a, y_m=b, scale_m=(0.004, 0.004)) for a in (-x, x) for b in (-y, y)]
    splats = [t.float() for t in together(*corners, one_splat(depth_m=5.0, scale_m=(9.0, 9.0), opacity=0.3)).tensors]
    found, compared = (rasterise(*splats, view, backend=backend) for backend in ("wgpu", "numba"))
    assert float(found.weights[:4].min()) > 5.0
    torch.testing.assert_close(found.weights, compared.weights, rtol=2e-3, atol=0.1)
    torch.testing.assert_close(found.alphas, compared.alphas, atol=2e-3, rtol=0.0)


def drawn_by(device: Device, splats: MadeSplats, view: View, settings: RasterSettings = PLAIN) -> Drawn:
    """As `draw`, by one device."""
    inputs = [t.float().requires_grad_() for t in splats.tensors]
    offsets = torch.zeros(len(splats.means), 2, requires_grad=True)
    raster = rasterise_wgpu(*inputs, view, offsets, None, settings, device)
    g = seeded(1)
    total = torch.zeros(())
    for values in (raster.features, raster.alphas, raster.depths):
        total = total + (values * torch.randn(values.shape, generator=g)).sum()
    total.backward()
    return Drawn(raster, tuple(t.grad if t.grad is not None else torch.zeros_like(t) for t in (*inputs, offsets)))


def test_windows_of_cards_with_small_buffers_give_the_same_raster(monkeypatch: pytest.MonkeyPatch) -> None:
    view, card = turned_view(60, 40, 50.0), open_device()
    splats = random_splats(400, view, 4)
    whole = drawn_by(card, splats, view)
    # First buffers hold too few pixels and the sums of 312 splats; then there are too few rows of sums.
    for holder, name, value in ((card, "most_bytes", 40_000), (wgpu_backend, "MOST_SUMS", 300)):
        with monkeypatch.context() as changed:
            changed.setattr(holder, name, value)
            found = drawn_by(card, splats, view)
        for name in ("features", "alphas", "depths", "weights", "radii_px"):
            torch.testing.assert_close(getattr(found.raster, name), getattr(whole.raster, name), atol=1e-6, rtol=1e-5)
        for gradient, other in zip(found.gradients, whole.gradients, strict=True):
            assert relative_error(gradient, other) < 1e-5


def test_what_does_not_fit_even_bin_by_bin_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(wgpu_backend, "MOST_SUMS", 100)
    sheets = together(*(one_splat(scale_m=(9.0, 9.0), depth_m=4.0 + 0.01 * k) for k in range(20)))
    with pytest.raises(DeviceFailed, match="20 splats lie over one another in 256 pixels"):
        draw(sheets, level_view(), "wgpu", seed=None)
    monkeypatch.setattr(wgpu_backend, "GEOMETRY_QUADS", 1 << 22)
    with pytest.raises(DeviceFailed, match="20 splats are more than the 16 that graphics cards are given"):
        draw(sheets, level_view(), "wgpu", seed=None)


@pytest.mark.slow
def test_more_channels_than_lanes_keep_are_drawn_in_parts() -> None:
    view = turned_view()
    splats = random_splats(100, view, 4, channels=23)
    compare(draw(splats, view, "wgpu"), draw(splats, view, "torch"))


def test_lanes_without_subgroups_and_atomic_sums_give_the_same_raster() -> None:
    view = turned_view(60, 40, 50.0)
    splats = random_splats(200, view, 5)
    usual = drawn_by(open_device(), splats, view)
    shared = drawn_by(open_device(subgroups=False), splats, view)
    atomic = drawn_by(open_device(), splats, view, replace(PLAIN, deterministic=False))
    for found in (shared, atomic):
        torch.testing.assert_close(found.raster.features, usual.raster.features, atol=1e-6, rtol=1e-5)
        torch.testing.assert_close(found.raster.weights, usual.raster.weights, atol=1e-4, rtol=1e-5)
        for gradient, other in zip(found.gradients, usual.gradients, strict=True):
            assert relative_error(gradient, other) < 1e-5


def test_sums_in_a_fixed_order_have_the_same_bits_each_time_and_in_any_order_of_splats() -> None:
    view = turned_view(60, 40, 50.0)
    splats = random_splats(200, view, 5)
    order = torch.randperm(200, generator=seeded(0))
    first, again = (draw(splats, view, "wgpu") for _ in range(2))
    mixed = draw(splats.picked(order), view, "wgpu")
    assert torch.equal(first.raster.features, again.raster.features)
    assert torch.equal(first.raster.features, mixed.raster.features)
    for a, b, c in zip(first.gradients, again.gradients, mixed.gradients, strict=True):
        assert torch.equal(a, b)
        assert torch.equal(a[order], c)


def test_places_far_off_the_axis_and_the_origin_are_nearly_as_exact() -> None:
    # Float32 knows a place in a picture of 5000 pixels to 3e-4 of one.
    view = level_view(32, 24, 3000.0).cropped(5000, 3000, 32, 24)
    splats = random_splats(40, view, 3)
    splats = rounded(splats.changed(scales=0.05 * splats.scales))
    matrix = view.cam_from_world.clone()
    shift = torch.tensor([512.0, -256.0, 64.0], dtype=torch.float64)
    matrix[:3, 3] = -matrix[:3, :3] @ shift
    moved = rounded(splats.changed(means=splats.means + shift))
    for each, seen in ((splats, view), (moved, replace(view, cam_from_world=matrix))):
        truth, found = draw(each, seen, "torch"), draw(each, seen, "wgpu")
        assert float(truth.raster.alphas.mean()) > 0.1
        assert relative_error(found.raster.features, truth.raster.features) < 1e-3
        for gradient, true_gradient in zip(found.gradients, truth.gradients, strict=True):
            assert relative_error(gradient, true_gradient) < 3e-3


def test_the_settings_say_who_draws() -> None:
    view = turned_view()
    inputs = [t.float() for t in random_splats(40, view, 1).tensors]
    usual = rasterise(*inputs, view)
    found = rasterise(*inputs, view, settings=RasterSettings(on_gpu=True))
    named = rasterise(*inputs, view, backend="wgpu")
    assert torch.equal(found.features, named.features)
    assert not torch.equal(found.features, usual.features)
    with pytest.raises(ValueError, match="wgpu: expected float32"):
        rasterise(*(t.double() for t in inputs), view, backend="wgpu")


def test_a_card_that_is_lost_is_said_and_the_next_picture_is_drawn() -> None:
    view = turned_view()
    inputs = [t.float() for t in random_splats(40, view, 1).tensors]
    own = open_device(most_bytes=1 << 23)
    own.raw.destroy()
    with pytest.raises(DeviceFailed, match="on the processor"):
        rasterise_wgpu(*inputs, view, None, None, PLAIN, own)
    raster = rasterise_wgpu(*inputs, view, None, None, PLAIN, open_device(most_bytes=1 << 23))
    assert float(raster.alphas.max()) > 0.1


def test_losses_of_one_picture_alone_have_its_gradients() -> None:
    view = turned_view()
    splats = random_splats(30, view, 12)
    found: list[Tensor] = []
    for backend, dtype in (("wgpu", torch.float32), ("torch", torch.float64)):
        means = splats.means.to(dtype).clone().requires_grad_()
        others = [t.to(dtype) for t in splats.tensors[1:]]
        rasterise(means, *others, view, backend=backend).depths.sum().backward()
        found.append(means.grad)
    assert relative_error(*found) < GRADIENT_ERROR
