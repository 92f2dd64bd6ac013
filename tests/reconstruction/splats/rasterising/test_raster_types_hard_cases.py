"""Splats that are hard to draw: edge-on, behind, too near, huge, tiny, opaque, equally deep, not numbers."""

from __future__ import annotations

import math

import pytest
import torch

from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.rasteriser import USUAL, Backend, rasterise
from tests.reconstruction.splats.drawn_splats import (
    both,
    draw,
    level_view,
    one_splat,
    random_splats,
    relative_error,
    rounded,
    tilted_plane,
    together,
)

BACKENDS: tuple[Backend, ...] = ("numba", "torch")


@pytest.mark.parametrize("tilt_deg", [0.0, 30.0, 60.0, 80.0, 89.0, 89.9, 89.99, 89.9999, 90.0, 90.01, 120.0, 180.0])
def test_edge_on_splats_are_drawn_alike_with_finite_gradients(tilt_deg: float) -> None:
    # Off the pixels' grid: a line of pixels that lies exactly in the plane of the splat sees all of it at any tilt.
    found = both(one_splat(tilt_deg=tilt_deg, x_m=0.02, y_m=0.01))
    assert float(found.raster.alphas.max()) > 0.4


def test_a_splat_that_turns_away_fades_into_the_low_pass_disc_without_jumps() -> None:
    view = level_view()
    pictures = []
    for tilt_deg in torch.linspace(0.0, 90.0, 361).tolist():
        inputs = [t.float() for t in one_splat(tilt_deg=tilt_deg, x_m=0.033).tensors]
        pictures.append(rasterise(*inputs, view).alphas)
    stack = torch.stack(pictures)
    sums = stack.sum(dim=(1, 2))
    # Steps of the cut itself are 1/255; a quarter of a degree moves the edge of the disc by less than 0.03.
    assert float((stack[1:] - stack[:-1]).abs().max()) < 0.03
    assert (sums[1:] - sums[:-1] < 0.05).all()
    low_pass = 2.0 * math.pi * 0.8 * 0.5
    assert low_pass * 0.8 < float(sums[-1]) < low_pass * 1.05


def test_depth_is_where_the_ray_meets_the_splat() -> None:
    view = level_view(48, 24, 60.0)
    for tilt_deg, sigma_m, centre_is_off_m in ((45.0, 0.1, 0.03), (45.0, 0.32, 0.1), (60.0, 0.2, 0.1)):
        splats, depths = tilted_plane(view, tilt_deg, sigma_m)
        raster = draw(splats, view, "numba", seed=None).raster
        found = raster.depths / raster.alphas
        assert float((found - depths).abs().max()) < 1e-4
        centres = splats.changed(features=splats.means[:, 2:])
        blended = draw(centres, view, "numba", seed=None).raster
        assert float((blended.features[..., 0] / blended.alphas - depths).abs().max()) > centre_is_off_m


def test_depth_where_the_low_pass_filter_draws_stays_on_the_plane_and_within_the_splat() -> None:
    # Seen at 70 degrees and more, splats of this size are thinner than a pixel.
    view = level_view(48, 24, 60.0)
    splats, depths = tilted_plane(view, 70.0, 0.1)
    raster = draw(splats, view, "numba", seed=None).raster
    # Where it is seen flatter than 80 degrees, which is far off to one side, the depth is limited.
    is_steep = (depths < 15.0) & (raster.alphas > 0.5)
    assert float(is_steep.float().mean()) > 0.5
    assert float((raster.depths / raster.alphas - depths)[is_steep].abs().max()) < 1e-3
    for tilt_deg in (85.0, 89.0, 89.9, 90.0):
        alone = draw(one_splat(tilt_deg=tilt_deg, x_m=0.4), level_view(), "numba", seed=None).raster
        is_seen = alone.alphas > 0.0
        off_m = (alone.depths / alone.alphas - 4.0)[is_seen].abs()
        assert float(off_m.max()) <= 1.01 * max(USUAL.reach * 0.3, 4.0 * USUAL.least_depth_change(30.0))


def test_where_the_low_pass_filter_draws_the_position_takes_the_gradient() -> None:
    tiny = both(one_splat(scale_m=(1e-5, 1e-5), x_m=0.03))
    assert float(tiny.gradients[5].norm()) > 1e-3
    assert float(tiny.gradients[2].norm()) < 1e-6 * float(tiny.gradients[5].norm())
    wide = both(one_splat(scale_m=(0.5, 0.5), x_m=0.03))
    assert float(wide.gradients[2].norm()) > 0.1


def test_two_splats_at_one_depth_are_drawn_in_their_order() -> None:
    red, blue = one_splat(opacity=0.9), one_splat(opacity=0.9)
    red = red.changed(features=torch.tensor([[1.0, 0.0]], dtype=torch.float64))
    blue = blue.changed(features=torch.tensor([[0.0, 1.0]], dtype=torch.float64))
    found = both(together(red, blue)).raster
    middle = found.features[12, 16]
    torch.testing.assert_close(middle, torch.tensor([0.9, 0.09]), atol=1e-5, rtol=0.0)


@pytest.mark.parametrize("opacity", [0.99, 0.995, 1.0])
def test_opaque_splats_keep_a_hundredth_of_what_is_behind(opacity: float) -> None:
    found = both(together(one_splat(opacity=opacity), one_splat(depth_m=5.0, opacity=0.5))).raster
    weights = found.features[12, 16]
    assert float(weights[0]) == pytest.approx(0.99 + 0.01 * 0.5, abs=1e-5)


def test_a_hundred_layers_end_by_the_stop_rule_there_and_back() -> None:
    sheets = [one_splat(depth_m=4.0 + 0.01 * k, opacity=0.6, scale_m=(500.0, 500.0)) for k in range(100)]
    found = both(together(*sheets))
    # 0.4^10 is above the limit and still taken from; 0.4^11 is below.
    n_taken = math.floor(math.log(1e-4) / math.log(0.4)) + 1
    assert (found.raster.weights[:n_taken] > 0.0).all()
    assert not found.raster.weights[n_taken:].any()
    assert not any(gradient[n_taken:].any() for gradient in found.gradients)
    torch.testing.assert_close(1.0 - found.raster.alphas, torch.full((24, 32), 0.4**n_taken), atol=1e-6, rtol=0.0)


def test_splats_behind_the_camera_or_nearer_than_near_are_not_drawn() -> None:
    for depth_m in (-4.0, 0.0, 0.05, 0.0999):
        found = both(one_splat(depth_m=depth_m))
        assert not found.raster.alphas.any()
        assert float(found.raster.radii_px[0]) == 0.0
        assert not any(gradient.any() for gradient in found.gradients)


@pytest.mark.parametrize("tilt_deg", [75.0, 88.0, 89.5, -85.0])
def test_a_splat_that_reaches_behind_the_camera_is_cut_at_near(tilt_deg: float) -> None:
    found = both(one_splat(tilt_deg=tilt_deg, depth_m=1.0, scale_m=(2.0, 0.5), x_m=0.3))
    is_seen = found.raster.alphas > 0.0
    assert is_seen.any()
    assert float((found.raster.depths / found.raster.alphas)[is_seen].min()) >= 0.1 * (1.0 - 1e-5)


def test_huge_splats_fill_the_picture_and_tiny_ones_a_pixel() -> None:
    for scale_m in (1e2, 1e4, 1e6):
        huge = both(one_splat(scale_m=(scale_m, scale_m), opacity=0.7))
        torch.testing.assert_close(huge.raster.alphas, torch.full_like(huge.raster.alphas, 0.7), atol=1e-3, rtol=0.0)
    for scale_m in (1e-3, 1e-6, 1e-12):
        tiny = both(one_splat(scale_m=(scale_m, scale_m), opacity=0.7))
        assert float(tiny.raster.alphas[12, 16]) == pytest.approx(0.7, abs=1e-5)
        assert int((tiny.raster.alphas > 0.0).sum()) <= 21
    # The filter keeps a needle's middle only: of the rest is seen what happens to meet the middle of a pixel.
    on_row, between_rows = both(one_splat(scale_m=(50.0, 1e-4))), both(one_splat(scale_m=(50.0, 1e-4), y_m=0.05))
    assert int((on_row.raster.alphas > 0.0).sum()) >= 32
    assert 0 < int((between_rows.raster.alphas > 0.0).sum()) <= 21


def test_places_far_off_the_axis_are_as_exact_as_in_the_middle() -> None:
    view = level_view(32, 24, 3000.0).cropped(5000, 3000, 32, 24)
    splats = random_splats(40, view, 3)
    splats = splats.changed(scales=0.05 * splats.scales)
    truth, found = draw(rounded(splats), view, "torch"), draw(rounded(splats), view, "numba")
    assert float(truth.raster.alphas.mean()) > 0.1
    assert relative_error(found.raster.features, truth.raster.features) < 5e-6
    for gradient, true_gradient in zip(found.gradients, truth.gradients, strict=True):
        assert relative_error(gradient, true_gradient) < 5e-5


def test_what_is_no_number_is_not_drawn_and_spoils_nothing() -> None:
    good, view = one_splat(), level_view()
    alone = draw(good, view, "numba", seed=None).raster.features
    for backend in BACKENDS:
        for name in ("means", "quats", "scales", "opacities"):
            for value in (math.nan, math.inf, -math.inf):
                bad = one_splat(depth_m=3.0)
                spoiled = getattr(bad, name).clone()
                spoiled[0, ...] = value
                drawn = draw(together(bad.changed(**{name: spoiled}), good), view, backend)
                assert drawn.raster.features.isfinite().all()
                torch.testing.assert_close(drawn.raster.features.float(), alone, atol=1e-6, rtol=1e-5)
                assert all(gradient.isfinite().all() for gradient in drawn.gradients)


def test_quaternions_of_any_length_turn_alike_and_zero_stands_for_none() -> None:
    splat = one_splat(tilt_deg=40.0)
    for length in (1e-6, 1.0, 1e6):
        both(splat.changed(quats=splat.quats * length))
    none = both(splat.changed(quats=torch.zeros(1, 4, dtype=torch.float64)))
    flat = draw(one_splat(), level_view(), "numba").raster
    torch.testing.assert_close(none.raster.alphas, flat.alphas)
    assert not none.gradients[1].any()


def test_below_the_cut_a_splat_is_dead_and_just_above_it_lives() -> None:
    cut = RasterSettings().min_alpha
    dead, alive = both(one_splat(opacity=0.99 * cut)), both(one_splat(opacity=1.2 * cut))
    assert not any(gradient.any() for gradient in dead.gradients)
    assert float(alive.gradients[3].abs().max()) > 0.0
    assert float(alive.raster.weights[0]) > 0.0


def test_a_view_without_width_or_focal_length_is_refused() -> None:
    view = level_view()
    for values in ({"width_px": 0}, {"height_px": -1}, {"fx_px": 0.0}, {"fy_px": math.nan}, {"cx_px": math.inf}):
        arguments = {name: getattr(view, name) for name in view.__slots__} | values
        with pytest.raises(ValueError, match="expected"):
            type(view)(**arguments)
