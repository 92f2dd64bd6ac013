"""Cuboid replacement: bulges on glass go, frames stay, nothing else changes."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from planning.geo.mesh import TriangleMesh, empty_mesh
from planning.geo.ray_casting import RayCaster
from reconstruction.dataset.refined_mesh import RefineParameters, drawn_in, refine_mesh
from tests.reconstruction.panels.rectify.scenes import surface_mesh
from tests.reconstruction.panels.rectify.test_surface import surface

Array = NDArray[np.float64]
FACE = surface(0.0, lean_rad=0.0)


def panels() -> Array:
    """Three by two panels of 1.4 x 2.4 m between frames 0.1 m wide."""
    cells = [(s, t) for t in (-2.5, 0.0) for s in (-2.25, -0.75, 0.75)]
    return np.array([FACE.to_enu(np.array([[s, t], [s + 1.4, t], [s + 1.4, t + 2.4], [s, t + 2.4]])) for s, t in cells])


def bulging(noise_m: float = 0.15) -> TriangleMesh:
    return surface_mesh(FACE, (-4.0, -4.0), (4.0, 4.0), 0.21, noise_m)


def heights(mesh: TriangleMesh, st: Array) -> Array:
    """Of the mesh above the surface, seen from the front, shape (n,)."""
    origins = FACE.to_enu(st) + 5.0 * FACE.normal_enu
    return 5.0 - RayCaster(mesh).cast(origins, np.broadcast_to(-FACE.normal_enu, origins.shape)).distance_m


def area_m2(mesh: TriangleMesh) -> float:
    a, b, c = np.moveaxis(mesh.corners_enu_m, 1, 0)
    return float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


def test_glass_becomes_flat_and_frames_keep_their_shape() -> None:
    coarse = bulging()
    refined = refine_mesh(coarse, panels())
    rng = np.random.default_rng(0)
    glass = np.array([[-2.25, -2.5]]) + rng.uniform(0.03, (1.37, 2.37), (300, 2))
    assert np.abs(heights(refined.mesh, glass)).max() < 1e-5
    frames = np.column_stack([rng.uniform(-0.83, -0.77, 300), rng.uniform(-2.4, 2.3, 300)])
    assert np.abs(heights(refined.mesh, frames) - heights(coarse, frames)).max() < 1e-4
    around = np.column_stack([rng.uniform(2.5, 3.9, 300), rng.uniform(-3.9, 3.9, 300)])
    assert np.abs(heights(refined.mesh, around) - heights(coarse, around)).max() < 1e-4


def test_no_hole_and_no_second_skin_is_left() -> None:
    refined = refine_mesh(surface_mesh(FACE, (-4.0, -4.0), (4.0, 4.0), 0.21, 0.0), panels())
    assert area_m2(refined.mesh) == pytest.approx((0.21 * 38) ** 2, rel=1e-6)
    st = np.stack(np.meshgrid(np.linspace(-3.9, 3.9, 80), np.linspace(-3.9, 3.9, 80)), axis=-1).reshape(-1, 2)
    assert np.isfinite(heights(refined.mesh, st)).all()


def test_every_panel_is_two_triangles_of_its_number() -> None:
    refined = refine_mesh(bulging(), panels())
    numbers, counts = np.unique(refined.panel_of_triangle, return_counts=True)
    assert numbers.tolist() == [-1, 0, 1, 2, 3, 4, 5]
    assert (counts[1:] == 2).all()
    normals = np.cross(*np.moveaxis(np.diff(refined.mesh.corners_enu_m[refined.panel_of_triangle >= 0], axis=1), 1, 0))
    assert (normals @ FACE.normal_enu > 0.0).all()


def test_what_bulges_further_than_the_cuboid_stays() -> None:
    far = FACE.to_enu(np.array([[-2.0, -2.0], [-1.5, -2.0], [-1.5, -1.5]])) + 1.0 * FACE.normal_enu
    mesh = TriangleMesh(far, np.array([[0, 1, 2]]))
    refined = refine_mesh(mesh, panels(), RefineParameters(in_front_m=0.5))
    assert (refined.panel_of_triangle == -1).sum() == 1
    gone = refine_mesh(mesh, panels(), RefineParameters(in_front_m=1.5))
    assert (gone.panel_of_triangle == -1).sum() == 0


def test_without_a_mesh_the_panels_remain() -> None:
    assert len(refine_mesh(empty_mesh(), panels()).mesh.triangles) == 12
    assert len(refine_mesh(bulging(), np.zeros((0, 4, 3))).mesh.triangles) == len(bulging().triangles)


def test_drawing_in_moves_every_edge_by_the_same_distance() -> None:
    quad = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.5, 0.0]])
    inner = drawn_in(quad, 0.1)
    assert inner is not None
    for i in range(4):
        edge = quad[(i + 1) % 4] - quad[i]
        across = np.cross(np.array([0.0, 0.0, 1.0]), edge / np.linalg.norm(edge))
        assert (inner[i] - quad[i]) @ across == pytest.approx(0.1)
    assert drawn_in(quad, 0.6) is None
    assert drawn_in(np.zeros((4, 3)), 0.1) is None
    assert drawn_in(quad[[0, 1, 1, 0]], 0.0) is None
