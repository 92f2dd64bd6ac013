"""Rectified pictures: straight lines become straight rows and columns, and interpolation stays within its tolerance."""

from __future__ import annotations

import numpy as np
import pytest

from reconstruction.panels.rectify.surface import polynomial_view
from reconstruction.panels.rectify.view import TangentView, photo_places, surface_view, warp
from tests.reconstruction.panels.rectify.scenes import BENT, SMALL, looking_at
from tests.reconstruction.panels.rectify.test_surface import surface
from tests.slow import slow


def drawn(photo, face) -> np.ndarray:  # type: ignore[no-untyped-def]
    """The photo of a facade whose brightness is a wave across s and along t, drawn through exact rays."""
    h, w = photo.intrinsics.height_px, photo.intrinsics.width_px
    x, y = np.meshgrid(np.arange(w) + 0.5, np.arange(h) + 0.5)
    st = face.hits(*photo.rays(np.column_stack([x.ravel(), y.ravel()])))
    value = 127.5 + 60.0 * np.cos(np.pi * st[:, 0]) + 60.0 * np.cos(np.pi * st[:, 1] / 1.5)
    return np.nan_to_num(value, nan=0.0).round().astype(np.uint8).reshape(h, w)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("intrinsics", "curvature"),
    [(SMALL, 0.0), (SMALL, 0.04), (SMALL, -0.03), (BENT, 0.04), slow(BENT, 0.0), slow(BENT, -0.03)],
)
def test_a_wave_on_the_facade_is_found_where_it_is(curvature, intrinsics) -> None:  # type: ignore[no-untyped-def]
    face = surface(curvature)
    photo = looking_at(face, aside_m=5.0, above_m=3.0, intrinsics=intrinsics)
    view = surface_view(photo, face)
    picture, inside = warp(drawn(photo, face), view)
    assert inside.mean() > 0.6
    x, y = np.meshgrid(np.arange(view.width_px) + 0.5, np.arange(view.height_px) + 0.5)
    st = view.to_surface(np.column_stack([x.ravel(), y.ravel()]))
    expected = 127.5 + 60.0 * np.cos(np.pi * st[:, 0]) + 60.0 * np.cos(np.pi * st[:, 1] / 1.5)
    off = np.abs(picture - expected.reshape(picture.shape))[inside]
    assert np.percentile(off, 99.0) < 3.0


@pytest.mark.slow
@pytest.mark.parametrize("tolerance_px", [slow(0.01), 0.2])
def test_interpolated_maps_keep_their_tolerance(tolerance_px: float) -> None:
    face = surface(0.05)
    for view in (
        exact := surface_view(looking_at(face, aside_m=8.0, intrinsics=BENT), face),
        polynomial_view(TangentView(exact)),
    ):
        every, few = photo_places(view, 0.0), photo_places(view, tolerance_px)
        both = np.isfinite(every).all(axis=2) & np.isfinite(few).all(axis=2)
        assert np.abs(every - few)[both].max() <= 1.5 * tolerance_px + 1e-3
        assert (np.isfinite(every) == np.isfinite(few)).mean() > 0.999


def test_a_coarser_picture_is_averaged_not_sampled() -> None:
    face = surface(0.0)
    photo = looking_at(face)
    noise = np.random.default_rng(0).integers(0, 256, (600, 800, 3)).astype(np.uint8)
    picture, inside = warp(noise, surface_view(photo, face, scale=0.125))
    assert picture[inside].std() < 25.0
    assert picture.ndim == 3


def test_what_the_photo_does_not_show_is_black_and_said_so() -> None:
    face = surface(0.0)
    view = surface_view(looking_at(face, aside_m=20.0), face)
    picture, inside = warp(np.full((600, 800), 255, np.uint8), view)
    assert 0.3 < inside.mean() < 1.0
    assert (picture[~inside] == 0).all()
    assert (picture[inside] == 255).all()
