"""Polygons, quads, panes and outdoor sides: the geometry that every format shares."""

from __future__ import annotations

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given

from planning.geo.bvh import line_of_sight
from planning.geo.mesh import box_mesh
from planning.geo.solids import Solids
from planning.site.importing.panes import MIN_OPEN_SHARE, hemisphere_directions, open_shares, turn_outwards
from planning.site.importing.polygons import (
    area_vector,
    fit_quad,
    plane_axes,
    quad_areas,
    start_lower_left,
    triangulate,
    unit_normals,
)
from planning.site.importing.window_faces import facing_axis, pane_of, pane_of_polygons

SQUARE = np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 0.0, 3.0], [0.0, 0.0, 3.0]])

angles = st.floats(0.0, 2.0 * np.pi)


def turned(points: np.ndarray, yaw: float, tilt: float) -> np.ndarray:
    """Points turned about z after being tilted about x, and moved away."""
    cy, sy, ct, st_ = np.cos(yaw), np.sin(yaw), np.cos(tilt), np.sin(tilt)
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, ct, -st_], [0.0, st_, ct]])
    about_z = np.array([[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]])
    return points @ (about_z @ about_x).T + np.array([30.0, -20.0, 10.0])


def total_area(triangles: np.ndarray) -> float:
    edges = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return 0.5 * float(np.linalg.norm(edges, axis=1).sum())


# --- polygons ---


@given(yaw=angles, tilt=angles, turn=st.sampled_from([1, -1]))
def test_triangles_of_a_polygon_with_holes_keep_area_and_sense(yaw: float, tilt: float, turn: int) -> None:
    window = np.array([[1.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 0.0, 2.0], [1.0, 0.0, 2.0]])
    notch = np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 0.0, 3.0], [2.0, 0.0, 2.5], [0.0, 0.0, 3.0]])
    outer, hole = turned(notch, yaw, tilt)[::turn], turned(window, yaw, tilt)
    triangles = triangulate([outer, hole])
    assert total_area(triangles) == pytest.approx(12.0 - 1.0 - 1.0, abs=1e-9)
    sense = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]) @ area_vector(outer)
    assert (sense > 0.0).all()
    vertices = {tuple(v) for v in np.concatenate([outer, hole]).round(9)}
    assert {tuple(v) for v in triangles.reshape(-1, 3).round(9)} <= vertices


@given(st.lists(st.tuples(st.floats(0.5, 3.0), st.floats(0.01, 1.0)), min_size=3, max_size=12), angles)
def test_star_shaped_polygons_have_the_area_of_their_triangles(spokes: list[tuple[float, float]], tilt: float) -> None:
    steps = np.array([step for _, step in spokes])
    turns = np.cumsum(steps) / steps.sum() * 2.0 * np.pi
    radii = np.array([radius for radius, _ in spokes])
    ring = turned(np.c_[radii * np.cos(turns), np.zeros(len(radii)), radii * np.sin(turns)], 0.7, tilt)
    if np.diff(np.r_[turns[-1] - 2.0 * np.pi, turns]).max() < np.pi - 0.01:  # star-shaped about the middle
        expected = float(np.linalg.norm(area_vector(ring)))
        assert total_area(triangulate([ring])) == pytest.approx(expected, rel=1e-6, abs=1e-6)


def test_holes_that_touch_or_leave_the_outline_are_cut_off() -> None:
    touching = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, 2.0], [0.0, 0.0, 2.0]])
    leaving = np.array([[3.0, 0.0, 1.0], [5.0, 0.0, 1.0], [5.0, 0.0, 2.0], [3.0, 0.0, 2.0]])
    assert total_area(triangulate([SQUARE, touching, leaving])) == pytest.approx(12.0 - 1.0 - 1.0)


def test_a_ring_that_crosses_itself_gives_its_two_lobes() -> None:
    bow_tie = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.5], [2.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    triangles = triangulate([bow_tie])
    assert np.isfinite(triangles).all()
    assert total_area(triangles) > float(np.linalg.norm(area_vector(bow_tie)))


@pytest.mark.parametrize("ring", [np.zeros((4, 3)), SQUARE[:2], np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]])])
def test_rings_without_area_have_no_triangles(ring: np.ndarray) -> None:
    assert triangulate([ring]).shape == (0, 3, 3)


def test_warped_polygons_keep_their_vertices() -> None:
    warped = SQUARE + np.array([[0.0, 0.05, 0.0], [0.0, 0.0, 0.0], [0.0, 0.05, 0.0], [0.0, 0.0, 0.0]])
    hole = np.array([[1.0, 0.02, 1.0], [2.0, 0.02, 1.0], [2.0, 0.02, 2.0]])
    points = {tuple(p) for p in triangulate([warped, hole]).reshape(-1, 3).round(9)}
    assert points == {tuple(p) for p in np.concatenate([warped, hole]).round(9)}


@given(angles, st.floats(-1.57, 1.57))
def test_plane_axes_are_right_and_up_seen_from_outside(yaw: float, pitch: float) -> None:
    normal = np.array([np.cos(yaw) * np.cos(pitch), np.sin(yaw) * np.cos(pitch), np.sin(pitch)])
    right, up = plane_axes(normal)
    np.testing.assert_allclose(np.cross(right, up), normal, atol=1e-12)
    assert right[2] == 0.0
    assert up[2] >= 0.0


# --- quads ---


@given(yaw=angles, tilt=st.floats(-1.5, 1.5), turn=st.sampled_from([1, -1]), start=st.integers(0, 3))
def test_rectangles_stay_as_they_are(yaw: float, tilt: float, turn: int, start: int) -> None:
    corners = np.roll(turned(SQUARE, yaw, tilt), start, axis=0)[::turn]
    quad = fit_quad(np.insert(corners, 1, 0.5 * (corners[0] + corners[1]), axis=0))  # a split edge adds no corner
    assert quad is not None
    assert quad.is_exact
    assert {tuple(p) for p in quad.corners.round(6)} == {tuple(p) for p in corners.round(6)}
    assert area_vector(quad.corners) @ area_vector(corners) > 0.0


@given(n=st.sampled_from([3, 5, 6, 7, 12, 40]), yaw=angles, tilt=st.floats(-1.5, 1.5), squeeze=st.floats(0.3, 1.0))
def test_other_shapes_become_a_rectangle_of_their_area_centre_and_plane(
    n: int, yaw: float, tilt: float, squeeze: float
) -> None:
    t = np.linspace(0.0, 2.0 * np.pi, n + 1)[:-1] + 0.3
    ring = turned(np.c_[2.0 * np.cos(t), np.zeros(n), 2.0 * squeeze * np.sin(t)], yaw, tilt)
    quad = fit_quad(ring)
    assert quad is not None
    assert not quad.is_exact
    np.testing.assert_allclose(area_vector(quad.corners), area_vector(ring), rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(quad.corners.mean(axis=0), ring.mean(axis=0), atol=1e-6)
    sides = np.roll(quad.corners, -1, axis=0) - quad.corners
    assert abs(sides[0] @ sides[1]) < 1e-6


def test_an_arrow_is_no_quad_though_it_has_four_corners() -> None:
    arrow = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 2.0], [0.0, 0.0, 0.8], [-2.0, 0.0, 2.0]])
    quad = fit_quad(arrow)
    assert quad is not None
    assert not quad.is_exact


@pytest.mark.parametrize(
    "outline", [np.zeros((4, 3)), SQUARE[:2], SQUARE * np.array([1.0, 1.0, 0.01]), SQUARE * 0.01, SQUARE[[0, 1, 1, 0]]]
)
def test_slivers_are_no_panes(outline: np.ndarray) -> None:
    assert fit_quad(outline) is None


def test_a_warped_quad_is_flattened() -> None:
    quad = fit_quad(SQUARE + np.array([[0.0, 0.2, 0.0], [0.0, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.0]]))
    assert quad is not None
    normal = area_vector(quad.corners) / quad_areas(quad.corners[None])[0]
    assert np.abs((quad.corners - quad.corners.mean(axis=0)) @ normal).max() < 1e-9


@given(yaw=angles, tilt=st.floats(-1.5, 1.5), start=st.integers(0, 3))
def test_corners_start_at_the_lower_left_seen_from_outside(yaw: float, tilt: float, start: int) -> None:
    corners = start_lower_left(np.roll(turned(SQUARE, yaw, tilt), start, axis=0))
    right, up = plane_axes(unit_normals(corners[None])[0])
    u, v = (corners - corners.mean(axis=0)) @ right, (corners - corners.mean(axis=0)) @ up
    assert (np.sign(u) == [-1, 1, 1, -1]).all()
    assert (np.sign(v) == [-1, -1, 1, 1]).all()


# --- panes ---


@given(yaw=angles, tilt=st.floats(-1.5, 1.5), thickness=st.floats(0.001, 0.2))
def test_a_pane_is_found_in_its_box(yaw: float, tilt: float, thickness: float) -> None:
    box = box_mesh(np.array([-1.0, 0.0, -0.7]), np.array([1.0, thickness, 0.7])).corners_enu_m
    triangles = turned(box.reshape(-1, 3), yaw, tilt).reshape(-1, 3, 3)
    pane = pane_of(triangles, facing_axis(triangles))
    assert pane.thickness_m == pytest.approx(thickness, abs=1e-9)
    quad = fit_quad(pane.outline)
    assert quad is not None
    assert quad_areas(quad.corners[None])[0] == pytest.approx(2.0 * 1.4, rel=1e-6)
    middle = turned(np.array([[0.0, 0.5 * thickness, 0.0]]), yaw, tilt)[0]
    np.testing.assert_allclose(quad.corners.mean(axis=0), middle, atol=1e-6)


def test_a_pane_in_a_deep_lining_is_found_among_the_polygons_of_the_window() -> None:
    # 0.9 x 0.9 m in a lining 0.6 m deep, as in real LOD3 models: the lining has more area than the pane.
    def face(y: float, inset: float) -> np.ndarray:
        low, high = inset, 0.9 - inset
        return np.array([[low, y, low], [high, y, low], [high, y, high], [low, y, high]])

    outer, inner = face(0.0, 0.0), face(0.0, 0.02)
    sides = []
    for a, b in zip(outer, np.roll(outer, -1, axis=0), strict=True):
        back = np.array([0.0, 0.6, 0.0])
        sides += [(np.array([a, b, b + back, a + back]),), (np.array([b, a, a + back, b + back]),)]
    polygons = [(outer, inner), (outer + np.array([0.0, 0.6, 0.0]), inner), (face(0.4, 0.02),), *sides]
    pane = pane_of_polygons(polygons)
    assert pane is not None
    assert pane.thickness_m == pytest.approx(0.0)
    np.testing.assert_allclose(np.ptp(pane.outline, axis=0), [0.86, 0.0, 0.86], atol=1e-9)
    np.testing.assert_allclose(pane.outline[:, 1], 0.4, atol=1e-9)


def test_a_window_of_frames_only_is_its_whole_body_and_one_without_area_is_none() -> None:
    ring = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    hole = 0.1 + 0.8 * ring + np.array([0.0, -0.1, 0.0])
    pane = pane_of_polygons([(ring, hole), (ring + np.array([0.0, 0.05, 0.0]), hole + np.array([0.0, 0.05, 0.0]))])
    assert pane is not None
    assert pane.thickness_m == pytest.approx(0.05)
    np.testing.assert_allclose(np.ptp(pane.outline, axis=0), [1.0, 0.0, 1.0], atol=1e-9)
    assert pane_of_polygons([(np.zeros((4, 3)),)]) is None


def test_an_ornate_frame_is_outlined_by_its_hull() -> None:
    posts = [box_mesh(np.array([0.01 * k, 0.0, 0.0]), np.array([0.01 * k + 0.005, 0.03, 1.0])) for k in range(100)]
    triangles = np.concatenate([post.corners_enu_m for post in posts])
    pane = pane_of(triangles, np.array([0.0, 1.0, 0.0]))
    np.testing.assert_allclose(np.ptp(pane.outline, axis=0), [0.995, 0.0, 1.0], atol=1e-9)


# --- outdoors ---


def test_hemisphere_directions_have_equal_solid_angles() -> None:
    directions = hemisphere_directions(256)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0)
    assert (directions[:, 2] > 0.0).all()
    # The mean of a uniform hemisphere is half a radius up; a cap of height h holds the share h.
    np.testing.assert_allclose(directions.mean(axis=0), [0.0, 0.0, 0.5], atol=0.01)
    for height in (0.1, 0.5, 0.9):
        assert (directions[:, 2] > height).mean() == pytest.approx(1.0 - height, abs=0.01)


def test_open_share_in_front_of_a_wall_opposite_is_its_solid_angle() -> None:
    # A square wall of 20 m, 10 m ahead, is one face of a cube: it fills 4 pi / 6, a third of the hemisphere.
    wall = box_mesh(np.array([-10.0, -11.0, -10.0]), np.array([10.0, -10.0, 10.0])).corners_enu_m
    share = open_shares(np.zeros((1, 3)), np.array([[0.0, -1.0, 0.0]]), line_of_sight(wall))
    assert share[0] == pytest.approx(2.0 / 3.0, abs=0.02)
    exact = open_shares(np.zeros((1, 3)), np.array([[0.0, -1.0, 0.0]]), Solids.of(wall).lines_free)
    assert share[0] == exact[0]


@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize("thickness_m", [0.0, 0.04])
def test_the_outer_side_of_a_room_is_found_and_the_outer_face_taken(turn: int, thickness_m: float) -> None:
    room = box_mesh(np.array([-5.0, 0.0, 0.0]), np.array([5.0, 6.0, 3.0])).corners_enu_m
    window = (SQUARE * 0.5 + np.array([0.0, 0.02, 0.5]))[::turn]
    sides = turn_outwards(
        window[None], np.array([thickness_m]), np.array([0.0, 3.0, 1.5]), line_of_sight(np.concatenate([room, room]))
    )
    assert sides.is_decided[0]
    assert sides.open_share[0] > 0.9
    np.testing.assert_allclose(unit_normals(sides.corners), [[0.0, -1.0, 0.0]], atol=1e-12)
    np.testing.assert_allclose(sides.corners[0, :, 1], 0.02 - 0.5 * thickness_m, atol=1e-12)


def test_a_pane_open_on_both_sides_faces_away_from_the_building() -> None:
    far = np.zeros((0, 3, 3))
    for y in (-4.0, 4.0):
        sides = turn_outwards(SQUARE[None] + np.array([0.0, y, 0.0]), np.zeros(1), np.zeros(3), line_of_sight(far))
        assert not sides.is_decided[0]
        assert unit_normals(sides.corners)[0, 1] * y > 0.0


def test_a_pane_in_a_closed_room_sees_nothing() -> None:
    room = box_mesh(np.array([-5.0, -5.0, -1.0]), np.array([5.0, 5.0, 5.0])).corners_enu_m
    sides = turn_outwards(SQUARE[None], np.zeros(1), np.zeros(3), line_of_sight(room))
    assert sides.open_share[0] < MIN_OPEN_SHARE
