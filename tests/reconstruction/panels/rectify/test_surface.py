"""Planes and cylinders as one formula: there and back, hits of rays, and the step from curved to flat."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp, mpf

from reconstruction.panels.rectify.surface import FacadeSurface


def surface(curvature_per_m: float, heading_rad: float = 0.3, lean_rad: float = 0.05) -> FacadeSurface:
    right = np.array([np.cos(heading_rad), np.sin(heading_rad), 0.0])
    inward = np.array([-np.sin(heading_rad), np.cos(heading_rad), 0.0])
    up = np.cos(lean_rad) * np.array([0.0, 0.0, 1.0]) + np.sin(lean_rad) * inward
    return FacadeSurface(np.array([12.0, -7.0, 20.0]), right, up, curvature_per_m)


curvatures = st.one_of(
    st.just(0.0),
    st.floats(-0.1, 0.1),
    st.floats(-15.0, -3.0).map(lambda exponent: 10.0**exponent),
    st.floats(-15.0, -3.0).map(lambda exponent: -(10.0**exponent)),
)


@given(curvature=curvatures, s=st.floats(-14.0, 14.0), t=st.floats(-30.0, 30.0), height=st.floats(-4.0, 9.0))
def test_coordinates_and_height_come_back(curvature: float, s: float, t: float, height: float) -> None:
    face = surface(curvature)
    here = np.array([[s, t]])
    if abs(curvature * s) > 3.0:
        return
    point = face.to_enu(here) + height * face.normals_at(here)
    assert np.allclose(face.to_surface(point), here, atol=1e-8)
    assert face.height_m(point)[0] == pytest.approx(height, abs=1e-9)


@given(curvature=curvatures, s=st.floats(-10.0, 10.0), distance=st.floats(0.5, 9.0), aside=st.floats(-0.7, 0.7))
def test_a_ray_aimed_at_a_point_of_the_surface_hits_it(
    curvature: float, s: float, distance: float, aside: float
) -> None:
    face = surface(curvature)
    target = np.array([[s, 3.0]])
    away = face.normals_at(target) + aside * face.right_at(target)
    origin = face.to_enu(target) + distance * away
    if face.height_m(origin)[0] <= 1e-6:
        return
    hit = face.hits(origin, -away)
    assert np.allclose(hit, target, atol=1e-6)
    reached = origin - face.distances(origin, -away)[:, None] * away
    assert abs(face.height_m(reached)[0]) < 1e-8


def test_rays_that_cannot_enter_miss() -> None:
    face = surface(0.05)
    outside = face.anchor_enu_m + 10.0 * face.normal_enu
    origins = np.stack([outside, outside, face.anchor_enu_m - face.normal_enu, outside])
    directions = np.stack([face.normal_enu, face.right_enu, -face.normal_enu, np.zeros(3)])
    assert np.isnan(face.distances(origins, directions)).all()
    assert np.isnan(face.hits(origins, directions)).all()


def test_a_hollow_facade_is_hit_on_the_far_side_of_its_axis_too() -> None:
    face = surface(-0.1)
    inside = face.anchor_enu_m + 4.0 * face.normal_enu
    hit = face.hits(inside[None], face.normal_enu[None])
    assert abs(hit[0, 0]) == pytest.approx(np.pi * 10.0)


def test_distances_lose_no_digits_at_a_radius_of_ten_thousand_kilometres() -> None:
    face = surface(1e-7, heading_rad=0.0, lean_rad=0.0)
    axes = np.stack([face.right_enu, face.normal_enu, face.up_enu])
    origin, direction = np.array([3.0, 25.0, -1.0]), np.array([0.2, -1.0, 0.1])
    found = face.distances((face.anchor_enu_m + origin @ axes)[None], (direction @ axes)[None])[0]
    mp.dps = 50
    x, z, u, w = (mpf(float(value)) for value in (origin[0], origin[1], direction[0], direction[1]))
    k = mpf("1e-7")
    a, b, c = k * (u * u + w * w), k * (x * u + z * w) + w, k * (x * x + z * z) + 2 * z
    exact = float((-b - mp.sqrt(b * b - a * c)) / a)
    assert found == pytest.approx(exact, rel=1e-12)


def test_the_step_from_curved_to_flat_is_smooth() -> None:
    here = np.array([[8.0, 2.0], [-5.0, 1.0]])
    flat = surface(0.0)
    for curvature in (1e-6, 1e-9, 1e-12, 1e-15):
        curved = surface(curvature)
        sag = 0.5 * curvature * here[:, 0] ** 2
        off = np.linalg.norm(curved.to_enu(here) - flat.to_enu(here), axis=1)
        assert np.allclose(off, sag, rtol=1e-4, atol=1e-12)


@given(curvature=curvatures, s=st.floats(-8.0, 8.0), t=st.floats(-5.0, 5.0))
def test_a_moved_anchor_shifts_the_coordinates_only(curvature: float, s: float, t: float) -> None:
    face = surface(curvature)
    moved = face.moved(s, t)
    here = np.array([[1.5, -2.0]])
    assert np.allclose(moved.to_enu(here), face.to_enu(here + np.array([s, t])), atol=1e-9)


def test_wrong_axes_are_refused() -> None:
    with pytest.raises(ValueError, match="right angle"):
        FacadeSurface(np.zeros(3), np.array([1.0, 0, 0]), np.array([0.6, 0.8, 0]))
    with pytest.raises(ValueError, match="finite"):
        FacadeSurface(np.zeros(3), np.array([1.0, 0, 0]), np.array([0, 0, 1.0]), float("nan"))
