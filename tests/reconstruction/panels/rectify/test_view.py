"""Rectified views with a pose: there and back, window, arc length against tangent plane."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.base.errors import InfeasibleError
from reconstruction.base.cameras import Intrinsics
from reconstruction.panels.rectify.view import TangentView, surface_view
from tests.reconstruction.panels.rectify.scenes import BENT, SMALL, looking_at
from tests.reconstruction.panels.rectify.test_surface import surface

CURVATURES = [0.0, 1e-9, 0.01, 0.06, -0.03]


@pytest.mark.parametrize("curvature", CURVATURES)
@pytest.mark.parametrize("intrinsics", [SMALL, BENT])
def test_points_of_both_pictures_come_back(curvature: float, intrinsics: Intrinsics) -> None:
    photo = looking_at(surface(curvature), aside_m=6.0, above_m=-4.0, intrinsics=intrinsics, roll_deg=2.0)
    for view in (unrolled := surface_view(photo, surface(curvature)), TangentView(unrolled)):
        x, y = np.meshgrid(np.linspace(0, view.width_px, 13)[1:-1], np.linspace(0, view.height_px, 9)[1:-1])
        points = np.column_stack([x.ravel(), y.ravel()])
        back = view.to_rectified(view.to_photo(points))
        seen = np.isfinite(back).all(axis=1)
        assert seen.mean() > 0.5
        assert np.abs(back - points)[seen].max() < 1e-4


@given(s=st.floats(-8.0, 8.0), t=st.floats(-6.0, 6.0), curvature=st.sampled_from(CURVATURES))
@settings(max_examples=50)
def test_a_point_of_the_facade_is_where_the_photo_sees_it(s: float, t: float, curvature: float) -> None:
    face = surface(curvature)
    photo = looking_at(face)
    view = surface_view(photo, face)
    here = np.array([[s, t]])
    assert np.allclose(view.to_photo(view.from_surface(here)), photo.pixels(face.to_enu(here)), atol=1e-6)


def test_a_photo_taken_squarely_keeps_its_scale() -> None:
    view = surface_view(looking_at(surface(0.0, lean_rad=0.0)), surface(0.0, lean_rad=0.0))
    assert view.px_per_m == pytest.approx(570.0 / 25.0, rel=0.01)
    assert abs(view.width_px - 800) < 10
    half = surface_view(looking_at(surface(0.0)), surface(0.0), scale=0.5)
    assert half.width_px == pytest.approx(view.width_px / 2, abs=10)


def test_unrolled_columns_are_equally_wide_and_flattened_ones_are_not() -> None:
    face = surface(0.06)
    view = surface_view(looking_at(face), face, np.array([-14.0, -5.0]), np.array([14.0, 5.0]))
    middle = 0.5 * (view.low_st_m[0] + view.high_st_m[0])
    edges = np.column_stack([middle + np.linspace(-9.0, 9.0, 13), np.zeros(13)])
    widths = np.diff(view.from_surface(edges)[:, 0])
    assert np.ptp(widths) < 1e-9
    flattened = np.diff(TangentView(view).to_rectified(view.to_photo(view.from_surface(edges)))[:, 0])
    assert flattened[0] / flattened[6] == pytest.approx(np.cos(0.06 * 8.25), abs=0.01)


def test_a_window_that_is_asked_for_is_not_exceeded() -> None:
    face = surface(0.02)
    low, high = np.array([-3.0, -2.0]), np.array([4.0, 2.5])
    view = surface_view(looking_at(face), face, low, high)
    assert (view.low_st_m >= low).all()
    assert (view.high_st_m <= high).all()
    assert (view.high_st_m - view.low_st_m > 0.9 * (high - low)).all()


def test_a_cylinder_seen_edge_on_shows_its_near_side_only() -> None:
    face = surface(0.1)
    photo = looking_at(face, distance_m=4.0, aside_m=30.0)
    view = surface_view(photo, face)
    cosine = face.normals_at(view.high_st_m[None]) @ (photo.pose.position_enu_m - face.to_enu(view.high_st_m[None])[0])
    assert cosine[0] > 0.0
    assert np.isnan(view.to_photo(view.from_surface(np.array([[-14.0, 0.0]])))).all()
    assert view.low_st_m[0] > 0.0


def test_a_facade_that_is_not_in_the_photo_is_refused() -> None:
    face = surface(0.0)
    behind = looking_at(face, distance_m=-25.0)
    with pytest.raises(InfeasibleError, match="does not show this facade"):
        surface_view(behind, face)
    with pytest.raises(InfeasibleError, match="does not show this facade"):
        surface_view(looking_at(face), face, np.array([100.0, 0.0]), np.array([101.0, 1.0]))
