from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from reconstruction.splats.initialise import SAME_SURFACE_M, _loose_points
from reconstruction.splats.surfels import (
    SPARSEST,
    panel_proximity,
    panel_surfels,
    plane_normals,
    spacings_of,
    surfels_between,
    thinned,
)

# A pane of 2 m x 1 m that leans, and one of 1 m x 3 m that stands.
LEANING = [(0, 0, 0), (2, 0, 0), (2, 0.6, 0.8), (0, 0.6, 0.8)]
STANDING = [(5, 0, 0), (6, 0, 0), (6, 0, 3), (5, 0, 3)]
CORNERS = np.array([LEANING, STANDING], float)


def test_panels_are_covered_by_even_grids_in_their_planes():
    found = panel_surfels(CORNERS, np.array([0.25, 0.5]))
    assert found.panels.tolist() == [0] * 32 + [1] * 12
    assert np.allclose(found.spacings_m[:32], 0.25)
    assert np.allclose(found.spacings_m[32:], 0.5)
    for number, corners in enumerate(CORNERS):
        mine = found.panels == number
        off = (found.points_enu_m[mine] - corners[0]) @ found.normals_enu[mine][0]
        assert np.abs(off).max() < 1e-12
        assert np.allclose(found.points_enu_m[mine].mean(axis=0), corners.mean(axis=0))
        nearest = cKDTree(found.points_enu_m[mine]).query(found.points_enu_m[mine], 2)[0][:, 1]
        assert np.allclose(nearest, found.spacings_m[mine][0, 0])


def test_tangents_follow_the_lower_edge_and_normals_look_outwards():
    found = panel_surfels(CORNERS, np.array([5.0, 5.0]))
    assert len(found) == 2
    assert np.allclose(found.tangents_enu, [[1, 0, 0], [1, 0, 0]])
    assert np.allclose(found.normals_enu, [[0, -0.8, 0.6], [0, -1, 0]])


def test_no_panels_have_no_surfels():
    assert len(panel_surfels(np.zeros((0, 4, 3)), np.zeros(0))) == 0


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 400), st.floats(0.02, 3.0), st.integers(0, 99))
def test_thinned_points_are_neither_crowded_nor_far_from_any_that_was_left_out(n, spacing, seed):
    points = np.random.default_rng(seed).random((n, 3)) * (3.0, 3.0, 0.01)
    kept = thinned(points, np.full(n, spacing), np.full(n, np.inf))
    assert 1 <= len(kept) <= n
    assert len(np.unique(kept)) == len(kept)
    if len(kept) > 1:
        assert cKDTree(points[kept]).query(points[kept], 2)[0][:, 1].min() >= 0.6 * spacing - 1e-12
    # A chain of points that each go for the next one is at most two spacings long.
    assert cKDTree(points[kept]).query(points)[0].max() <= 2.5 * spacing


def test_finer_places_keep_more_points():
    points = np.random.default_rng(0).random((20000, 3)) * (2.0, 1.0, 0.0)
    kept = thinned(points, np.where(points[:, 0] < 1.0, 0.04, 0.16), np.full(20000, np.inf))
    n_fine = (points[kept, 0] < 1.0).sum()
    assert 8.0 < n_fine / (len(kept) - n_fine) < 24.0


def test_no_points_are_thinned_to_none():
    assert len(thinned(np.zeros((0, 3)), np.zeros(0), np.zeros(0))) == 0


def test_points_on_glass_are_told_from_those_on_frames():
    points = np.array([[5.5, 0.0, 1.0], [5.5, -0.2, 1.0], [5.5, -0.4, 1.0], [6.05, 0.0, 1.0], [9.0, 0.0, 0.0]])
    found = panel_proximity(points, CORNERS, within_m=0.3, reach_m=1.0)
    assert found.panels.tolist() == [1, 1, -1, -1, -1]
    assert found.gaps_m[3] == pytest.approx(0.05)
    assert np.allclose(np.abs(found.edges_enu[3]), [0, 0, 1])
    assert np.isinf(found.gaps_m[4])


def test_without_panels_nothing_is_glass():
    found = panel_proximity(np.zeros((2, 3)), np.zeros((0, 4, 3)), 0.3, 1.0)
    assert found.panels.tolist() == [-1, -1]
    assert np.isinf(found.gaps_m).all()


def test_surfels_of_frames_lie_along_the_glass_and_end_there():
    points, normals = np.array([[6.05, 0.0, 1.0], [8.0, 0.0, 1.0]]), np.array([[0.0, -1.0, 0.0]] * 2)
    beside = panel_proximity(points, CORNERS, 0.3, 1.0)
    found = surfels_between(points, normals, np.array([0.4, 0.4]), beside.gaps_m, beside.edges_enu)
    assert np.allclose(np.abs(found.tangents_enu[0]), [0, 0, 1])
    assert found.spacings_m[0] == pytest.approx([0.4, 0.1])
    assert found.spacings_m[1] == pytest.approx([0.4, 0.4])
    assert np.allclose((found.tangents_enu * normals).sum(axis=1), 0.0)
    assert np.allclose(np.linalg.norm(found.tangents_enu, axis=1), 1.0)


def test_the_side_of_a_frame_has_tangents_too():
    # The normal of the frame's side is across the edge beside it; that of its end is the edge itself.
    points, normals = np.array([[6.05, 0.0, 1.0]] * 2), np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    beside = panel_proximity(points, CORNERS, 0.3, 1.0)
    found = surfels_between(points, normals, np.full(2, 0.4), beside.gaps_m, beside.edges_enu)
    assert np.allclose((found.tangents_enu * normals).sum(axis=1), 0.0)
    assert np.allclose(np.linalg.norm(found.tangents_enu, axis=1), 1.0)


def test_normals_of_loose_points_are_those_of_the_plane_around_them():
    rng = np.random.default_rng(0)
    u, v = rng.random((2, 200, 1))
    cloud = u * [1.0, 0.0, 0.0] + v * [0.0, 0.6, 0.8]
    assert np.allclose(np.abs(plane_normals(cloud[:9], cloud)), [[0.0, 0.8, 0.6]] * 9, atol=1e-6)


@pytest.mark.parametrize("cloud", [np.zeros((1, 3)), np.zeros((20, 3)), np.arange(20.0)[:, None] * [[1.0, 1.0, 0.0]]])
def test_points_without_a_plane_have_a_normal_all_the_same(cloud):
    normals = plane_normals(cloud, cloud)
    assert np.allclose(np.linalg.norm(normals, axis=1), 1.0)


def test_spacings_are_mean_distances_within_their_bounds():
    points = np.column_stack([np.arange(10.0), np.zeros(10), np.zeros(10)])
    found = spacings_of(points, np.full(10, 0.1), np.full(10, 1.5), np.zeros(10, bool))
    assert found[5] == pytest.approx(4.0 / 3.0)
    assert found[0] == pytest.approx(1.5)
    assert spacings_of(points[:2], np.full(2, 0.1), np.full(2, 1.5), np.zeros(2, bool)).tolist() == [1.5, 1.5]


def test_loose_points_reach_their_neighbours_however_finely_photos_see_them():
    """Of a cloud that is sparser than photos are fine, no dots are left with gaps between."""
    y, z = np.meshgrid(np.arange(12.0), np.arange(12.0))
    wall = np.column_stack([np.zeros(144), y.ravel(), z.ravel()])
    lost = np.array([[0.0, 500.0, 0.0]])
    points, finest = np.concatenate([wall, lost]), np.full(145, 0.01)
    found = spacings_of(points, 0.7 * finest, 1.5 * finest, np.ones(145, bool))
    assert found[:144].min() >= 1.0
    assert found[:144].max() < 1.5
    assert found[144] == pytest.approx(SPARSEST * np.median(found[:144]), rel=0.05)  # a mismatch far out stays small
    known = spacings_of(points, 0.7 * finest, 1.5 * finest, np.zeros(145, bool))
    assert known == pytest.approx(0.015)


@given(st.integers(0, 2**32 - 1), st.integers(0, 6), st.floats(0.01, 30.0))
@settings(max_examples=60, deadline=None)
def test_points_are_loose_that_are_further_from_hits_than_twice_their_spacing(seed, n_lonely, off_m):
    rng = np.random.default_rng(seed)
    wall = np.column_stack([rng.random(400) * 20.0, np.zeros(400), rng.random(400) * 10.0])
    hits = np.concatenate([wall, 40.0 * rng.normal(size=(n_lonely, 3))])
    near = np.column_stack([rng.random(60) * 20.0, off_m * rng.normal(size=60), rng.random(60) * 10.0])
    points = np.concatenate([near, 60.0 * rng.normal(size=(60, 3))])
    apart = np.linalg.norm(hits[:, None] - hits, axis=2)
    between = np.sort(apart, axis=1)[:, 1]
    to_hits = np.linalg.norm(points[:, None] - hits, axis=2)
    nearest = to_hits.argmin(axis=1)
    is_loose = to_hits.min(axis=1) > np.maximum(2.0 * between[nearest], SAME_SURFACE_M)
    scene = SimpleNamespace(points_enu_m=points)
    assert np.array_equal(_loose_points(scene, hits), points[is_loose])
