"""Views from vanishing points alone: rows and columns come out straight, proportions where the lens allows."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.base.errors import InfeasibleError
from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.rectify.surface import FacadeSurface
from reconstruction.panels.rectify.view import VanishingView, vanishing_view
from tests.reconstruction.panels.rectify.scenes import SMALL, looking_at
from tests.reconstruction.panels.rectify.test_surface import surface

FACE = surface(0.0, lean_rad=0.0)


def points_at_infinity(photo: PosedPhoto, face: FacadeSurface) -> tuple[np.ndarray, np.ndarray]:
    k, rotation = photo.intrinsics.matrix, photo.pose.cam_from_enu
    return k @ rotation @ face.right_enu, k @ rotation @ face.up_enu


def of(photo: PosedPhoto, focal_px: float | None = None) -> VanishingView:
    horizontal, vertical = points_at_infinity(photo, FACE)
    return vanishing_view(horizontal, vertical, SMALL.width_px, SMALL.height_px, focal_px)


@given(aside=st.floats(-25.0, 25.0), above=st.floats(-12.0, 12.0), roll=st.floats(-10.0, 10.0), known=st.booleans())
@settings(max_examples=60)
def test_rows_and_columns_become_straight_and_level(aside: float, above: float, roll: float, known: bool) -> None:
    photo = looking_at(FACE, 25.0, aside, above, roll_deg=roll)
    view = of(photo, SMALL.fx_px if known else None)
    s, t = np.meshgrid(np.linspace(-6.0, 6.0, 7), np.linspace(-5.0, 5.0, 6))
    places = view.to_rectified(photo.pixels(FACE.to_enu(np.column_stack([s.ravel(), t.ravel()])))).reshape(6, 7, 2)
    assert np.ptp(places[..., 0], axis=0).max() < 1e-6 * view.width_px
    assert np.ptp(places[..., 1], axis=1).max() < 1e-6 * view.height_px
    assert (np.diff(places[..., 0], axis=1) > 0.0).all()
    assert (np.diff(places[..., 1], axis=0) < 0.0).all()
    if view.is_metric:
        across, up = np.diff(places[0, :, 0]).mean() / 2.0, -np.diff(places[:, 0, 1]).mean() / 2.0
        assert across == pytest.approx(up, rel=1e-6)


def test_the_focal_length_is_found_where_both_points_are_finite() -> None:
    view = of(looking_at(FACE, 25.0, 15.0, 12.0))
    assert view.is_metric
    assert view.focal_px == pytest.approx(SMALL.fx_px, rel=1e-6)


def test_a_photo_taken_squarely_has_both_points_at_infinity_and_is_left_as_it_is() -> None:
    view = vanishing_view(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]), 800, 600)
    assert not view.is_metric
    corners = np.array([[0.0, 0.0], [800.0, 600.0], [400.0, 300.0]])
    assert np.allclose(view.to_rectified(corners), corners, atol=1e-6)


def test_points_come_back_and_the_far_end_of_the_plane_is_left_out() -> None:
    photo = looking_at(FACE, 6.0, 30.0)
    view = of(photo, SMALL.fx_px)
    points = np.array([[100.0, 100.0], [0.5 * view.width_px, 0.5 * view.height_px]])
    assert np.allclose(view.to_rectified(view.to_photo(points)), points, atol=1e-6)
    assert max(view.width_px, view.height_px) <= 8192


@pytest.mark.parametrize("signs", [(1, 1), (-1, 1), (1, -1), (-1, -1)])
def test_signs_of_homogeneous_points_mean_nothing(signs: tuple[int, int]) -> None:
    horizontal, vertical = points_at_infinity(looking_at(FACE, 25.0, 10.0, 5.0), FACE)
    view = vanishing_view(signs[0] * horizontal, signs[1] * 1e6 * vertical, 800, 600)
    usual = vanishing_view(horizontal, vertical, 800, 600)
    assert np.allclose(view.to_rectified(np.array([[300.0, 200.0]])), usual.to_rectified(np.array([[300.0, 200.0]])))


def test_a_region_is_the_window() -> None:
    photo = looking_at(FACE, 25.0, 10.0)
    horizontal, vertical = points_at_infinity(photo, FACE)
    region = np.array([[200.0, 150.0], [500.0, 150.0], [500.0, 450.0], [200.0, 450.0]])
    places = vanishing_view(horizontal, vertical, 800, 600, SMALL.fx_px, region).to_rectified(region)
    assert np.allclose(places.min(axis=0), 0.0, atol=1e-6)


def test_points_that_make_no_plane_are_refused() -> None:
    with pytest.raises(InfeasibleError, match="nearly the same"):
        vanishing_view(np.array([4000.0, 300.0, 1.0]), np.array([4000.0, 301.0, 1.0]), 800, 600)
    with pytest.raises(ValueError, match="finite"):
        vanishing_view(np.zeros(3), np.array([0.0, 1.0, 0.0]), 800, 600)
    with pytest.raises(InfeasibleError, match="edge-on"):
        vanishing_view(np.array([401.0, 300.0, 1.0]), np.array([0.0, 1.0, 0.0]), 800, 600)
