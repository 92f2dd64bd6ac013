"""Distances, clearance and line of sight against dense sampling, closed forms and each other."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.geo.bvh import (
    build_bvh,
    first_hits,
    line_of_sight,
    nearest_d2,
    point_triangle_d2,
    segment_d2,
    segment_hits_triangle,
    segment_segment_d2,
    segment_triangle_d2,
)
from planning.geo.mesh import box_mesh, closed_parts, extrude
from planning.geo.solids import Solids
from planning.site.bundled import SCENES
from planning.site.records import panel_corners, panel_triangles

coordinate = st.one_of(st.floats(-10, 10), st.sampled_from([0.0, 1.0, -1.0, 1e-9]))
point = st.tuples(coordinate, coordinate, coordinate).map(np.array)
triangle = st.tuples(point, point, point).map(np.array)


def grid_on_triangle(corners, n=60):
    a, b = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n))
    inside = a + b <= 1.0
    return corners[0] + a[inside][:, None] * (corners[1] - corners[0]) + b[inside][:, None] * (corners[2] - corners[0])


@given(p=point, corners=triangle)
def test_distance_to_triangle_is_at_most_and_close_to_that_of_a_fine_grid_on_it(p, corners):
    exact = np.sqrt(point_triangle_d2(p, corners))
    sampled = np.linalg.norm(grid_on_triangle(corners) - p, axis=1).min()
    size = np.ptp(corners, axis=0).max()
    assert exact <= sampled + 1e-9
    assert exact >= sampled - size / 30 - 1e-9


@given(a=point, b=point, corners=triangle)
def test_distance_of_segment_and_triangle_is_at_most_and_close_to_sampled(a, b, corners):
    exact = np.sqrt(segment_triangle_d2(a, b, corners))
    along = a + np.linspace(0, 1, 100)[:, None] * (b - a)
    sampled = np.sqrt(min(point_triangle_d2(q, corners) for q in along))
    assert exact <= sampled + 1e-7
    assert exact >= sampled - np.linalg.norm(b - a) / 150 - 1e-7


@given(a=point, b=point, c=point, d=point)
def test_distance_of_segments_is_symmetric_and_never_above_that_of_their_ends(a, b, c, d):
    there = segment_segment_d2(a, b, c, d)
    assert there == pytest.approx(segment_segment_d2(c, d, a, b), abs=1e-7)
    assert there == pytest.approx(segment_segment_d2(b, a, d, c), abs=1e-7)
    ends = min(((x - y) ** 2).sum() for x in (a, b) for y in (c, d))
    assert 0.0 <= there <= ends + 1e-9


@pytest.mark.parametrize(
    ("a", "b", "c", "d", "expected"),
    [
        ((0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), 1.0),  # parallel
        ((0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0), 1.0),  # on one line
        ((0, 0, 0), (1, 0, 0), (0.5, 0, 0), (3, 0, 0), 0.0),  # on one line, overlapping
        ((0, 0, 0), (0, 0, 0), (3, 4, 0), (3, 4, 0), 25.0),  # two points
        ((-1, 0, 0), (1, 0, 0), (0, -1, 2), (0, 1, 2), 4.0),  # crossing
    ],
)
def test_distance_of_segments_in_worked_examples(a, b, c, d, expected):
    points = [np.array(x, dtype=float) for x in (a, b, c, d)]
    assert segment_segment_d2(*points) == pytest.approx(expected)


def test_triangle_without_area_is_as_far_as_the_segment_it_is():
    corners = np.array([[0.0, 0, 0], [2.0, 0, 0], [1.0, 0, 0]])
    assert point_triangle_d2(np.array([1.0, 3.0, 0.0]), corners) == pytest.approx(9.0)
    assert point_triangle_d2(np.array([5.0, 0.0, 0.0]), np.zeros((3, 3))) == pytest.approx(25.0)


@given(seed=st.integers(0, 10_000), n=st.integers(0, 60))
def test_tree_finds_what_looking_at_all_triangles_finds(seed, n):
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-5, 5, (n, 1, 3)) + rng.normal(size=(n, 3, 3)) * rng.choice([0.0, 0.1, 2.0])
    bvh = build_bvh(corners)
    assert sorted(bvh.source) == list(range(n))
    for _ in range(5):
        p, q = rng.uniform(-8, 8, (2, 3))
        expected = min([point_triangle_d2(p, c) for c in corners], default=np.inf)
        assert nearest_d2(bvh, p, np.inf) == pytest.approx(expected, rel=1e-12)
        expected = min([segment_triangle_d2(p, q, c) for c in corners], default=np.inf)
        assert segment_d2(bvh, p, q, np.inf) == pytest.approx(expected, rel=1e-12)
        assert nearest_d2(bvh, p, 0.01) <= 0.01


@given(p=st.tuples(*[st.floats(-9, 9)] * 3))
def test_signed_clearance_of_a_box_equals_the_closed_form(p):
    low, high = np.array([-3.0, -2.0, -1.0]), np.array([3.0, 2.0, 4.0])
    solids = Solids.of(box_mesh(low, high).corners_enu_m)
    q = np.array(p)
    outside = np.linalg.norm(np.maximum(np.maximum(low - q, q - high), 0.0))
    inside = np.minimum(q - low, high - q).min()
    expected = -inside if inside > 0 else outside
    assert solids.clearance_m(q[None])[0] == pytest.approx(expected, abs=1e-9)


def test_overlapping_and_inverted_solids_are_solid_and_open_skins_are_not():
    first, second = box_mesh(np.zeros(3), np.full(3, 4.0)), box_mesh(np.full(3, 2.0), np.full(3, 6.0))
    inverted = second.corners_enu_m[:, ::-1]
    both = Solids.of(np.concatenate([first.corners_enu_m, inverted]))
    points = np.array([[1.0, 1.1, 1.2], [3.0, 3.1, 3.2], [5.0, 5.1, 5.2], [1.0, 5.0, 1.0]])
    assert (both.clearance_m(points) < 0).tolist() == [True, True, True, False]
    opened = Solids.of(first.corners_enu_m[2:])
    assert (closed_parts(first.corners_enu_m[2:]) == -1).all()
    assert opened.clearance_m(points[:1])[0] > 0


def test_concave_footprint_is_solid_in_its_wings_and_open_in_its_court():
    outline = np.array([[0.0, 0.0], [30.0, 0.0], [30.0, 10.0], [10.0, 10.0], [10.0, 30.0], [0.0, 30.0]])
    solids = Solids.of(extrude(outline, 0.0, 20.0).corners_enu_m)
    points = np.array([[5.0, 25.0, 3.0], [25.0, 5.0, 3.0], [20.0, 20.0, 3.0], [5.0, 5.0, 21.0]])
    assert np.sign(solids.clearance_m(points)).tolist() == [-1, -1, 1, 1]
    assert solids.clearance_m(points[2:3])[0] == pytest.approx(10.0)


@pytest.mark.long
@pytest.mark.parametrize("scene", ["library", "court"])
def test_segments_said_to_be_clear_are_clear_at_every_sampled_point_and_the_others_are_not(scene):
    model = SCENES[scene]()
    solids = Solids.of(np.concatenate([panel_triangles(panel_corners(model.site)), model.building.corners_enu_m]))
    rng = np.random.default_rng(5)
    low, high = np.array(model.site.airspace.min_enu_m), np.array(model.site.airspace.max_enu_m)
    a, b = rng.uniform(low, high, (2, 300, 3))
    clear = solids.segments_clear(a, b, 10.0)
    measured = solids.segment_distances_m(a, b)
    np.testing.assert_array_equal(clear, measured >= 10.0)
    assert 0.2 < clear.mean() < 0.9
    steps = np.linspace(0.0, 1.0, 400)
    for i in range(0, 300, 3):
        sampled = np.abs(solids.clearance_m(a[i] + steps[:, None] * (b[i] - a[i]))).min()
        assert measured[i] <= sampled + 1e-9
        assert measured[i] >= sampled - 0.5 * np.linalg.norm(b[i] - a[i]) / 399 - 1e-9


def test_segment_exactly_at_the_distance_is_clear_and_a_micrometre_closer_is_not():
    solids = Solids.of(box_mesh(np.zeros(3), np.ones(3)).corners_enu_m)
    a, b = np.array([[-5.0, 3.0, 0.5]]), np.array([[5.0, 3.0, 0.5]])
    assert solids.segments_clear(a, b, 2.0)[0]
    assert not solids.segments_clear(a - [0, 1e-6, 0], b - [0, 1e-6, 0], 2.0)[0]


def test_embree_line_of_sight_agrees_with_the_float64_twin_but_for_grazing_lines():
    model = SCENES["court"]()
    corners = np.concatenate([panel_triangles(panel_corners(model.site)), model.building.corners_enu_m])
    rng = np.random.default_rng(6)
    low, high = np.array(model.site.airspace.min_enu_m), np.array(model.site.airspace.max_enu_m)
    a, b = rng.uniform(low, high, (2, 20_000, 3))
    fast, exact = line_of_sight(corners)(a, b), Solids.of(corners).lines_free(a, b)
    assert 0.5 < exact.mean() < 0.95
    assert (fast != exact).mean() < 5e-4


def test_line_of_sight_without_anything_in_the_way_is_free():
    assert line_of_sight(np.zeros((0, 3, 3)))(np.zeros((3, 3)), np.ones((3, 3))).all()


def test_rays_meet_the_first_triangle_on_their_way_as_trying_each_says_also_far_from_the_origin() -> None:
    rng = np.random.default_rng(3)
    near = np.concatenate([rng.normal(0, 6, (60, 1, 3)) + rng.normal(0, 2, (60, 3, 3)), np.full((1, 3, 3), 2.0)])
    origins, directions = rng.normal(0, 8, (200, 3)), rng.normal(0, 1, (200, 3))
    directions[:20, :2] = 0.0
    ends = origins + 100.0 * directions
    for shift_m in (0.0, 5e6):
        way, hit = np.empty(200), np.empty(200, np.int64)
        first_hits(build_bvh(near + shift_m), origins + shift_m, directions, 100.0, way, hit)
        for i in range(200):
            along = [segment_hits_triangle(origins[i], ends[i], triangle) for triangle in near]
            tried = 100.0 * min((each for each in along if each >= 0.0), default=np.inf)
            assert way[i] == pytest.approx(tried, abs=1e-6)
            assert along[hit[i]] == pytest.approx(tried / 100.0, abs=1e-7) if hit[i] >= 0 else np.isinf(tried)
    nothing = np.empty(200), np.empty(200, np.int64)
    first_hits(build_bvh(np.empty((0, 3, 3))), origins, directions, 100.0, *nothing)
    assert (nothing[1] == -1).all()
    assert np.isinf(nothing[0]).all()
