"""Made facades: the truth fits the picture, and every disturbance does what it says and nothing else."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from reconstruction.scenes.facades.cases import area, clip, grid_of_layout, photo_of, random_case, wide_camera
from reconstruction.scenes.facades.record import Case, Disturbances, Layout, Wall, first_hits
from reconstruction.scenes.facades.render import render_facade
from tests.reconstruction.synthetic_photos import STRONG, simple_case

SMALL = wide_camera(400, 300)
SOFTLY = replace(STRONG, blur_px=0.0, noise_grey=0.0)

curvatures = st.sampled_from([0.0, 1e-9, 1e-6, -1e-6, 0.02, 0.06, -0.02])


@given(curvatures, st.floats(-12.0, 12.0), st.floats(0.0, 30.0), st.floats(-180.0, 180.0))
def test_ray_towards_a_place_on_the_wall_falls_on_that_place(
    curvature: float, s_m: float, h_m: float, heading_deg: float
) -> None:
    wall = Wall((3.0, -4.0, 2.0), heading_deg, curvature)
    place = wall.points_enu_m(np.array([s_m]), np.array([h_m]))
    origin = wall.to_wall(place.mean(axis=0) + 15.0 * wall.outward_enu(np.array([s_m]))[0])[0]
    x, y, z = (wall.to_wall(place)[0] - origin).astype(np.float32)[:, None]
    t, s, h = first_hits(origin, x, y, z, curvature)
    assert t[0] == pytest.approx(1.0, abs=1e-4)
    assert s[0] == pytest.approx(s_m, abs=2e-4)
    assert h[0] == pytest.approx(h_m, abs=2e-4)


@given(st.floats(-0.05, 0.05), st.floats(-10.0, 10.0))
def test_lengths_along_a_bent_wall_are_arc_lengths(curvature: float, s_m: float) -> None:
    wall = Wall(curvature_per_m=curvature)
    s = np.linspace(0.0, s_m, 4001)
    points = wall.points_enu_m(s, np.zeros_like(s))
    assert np.linalg.norm(np.diff(points, axis=0), axis=1).sum() == pytest.approx(abs(s_m), rel=1e-6, abs=1e-9)


def test_rays_that_miss_or_look_away_hit_nothing() -> None:
    one = np.ones(1, np.float32)
    for x, y in ((1.0, 0.1), (0.0, -1.0), (1.0, 0.0)):
        t, s, h = first_hits(np.array([0.0, -20.0, 1.0]), x * one, y * one, 0 * one, 0.05)
        assert np.isnan([t, s, h]).all()


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("layout", "curvature"),
    [
        (Layout(4, 6, widths="random", spandrel_height_m=0.7), 0.0),
        (Layout(4, 6, missing_profiles=0.3, missing_panels=0.2), 0.0),
        (Layout(3, 6, top="triangles"), 0.0),
        (Layout(3, 6, top="sloped"), 0.0),
        (Layout(6, 6, top="gable", n_sloped_rows=4), 0.0),
        (Layout(4, 6, widths="alternating", braces=((0, 0, 4, 6), (4, 1, 0, 5)), brace_width_m=0.2), 0.0),
        (Layout(3, 6, frame_depth_m=0.0, braces=tuple((0, c, 3, c + 3) for c in range(4))), 0.0),
        (Layout(4, 24, panel_width_m=0.4), 0.05),
    ],
)
def test_index_image_shows_the_polygons_of_the_panels(layout: Layout, curvature: float) -> None:
    case = simple_case(
        layout, wall=Wall(curvature_per_m=curvature), intrinsics=SMALL, oblique_deg=12.0, from_below_deg=8.0
    )
    made = render_facade(case)
    x, y = np.meshgrid(np.arange(400) + 0.5, np.arange(300) + 0.5)
    expected = np.zeros((300, 400), int)
    doubtful = np.zeros((300, 400), bool)
    # Panes are rendered bent: the middle of an edge lies off its chord by this much.
    sag_px = 0.02 + curvature * 0.25**2 / 8.0 * 400.0
    for number, panel in enumerate(made.panels, 1):
        polygon = shapely.Polygon(panel.corners_px)
        shapely.prepare(polygon)
        expected[shapely.contains_xy(polygon, x, y)] = number
        doubtful |= shapely.contains_xy(polygon.boundary.buffer(sag_px), x, y)
    assert expected.any()
    assert doubtful.mean() < 0.05
    np.testing.assert_array_equal(made.index[~doubtful], expected[~doubtful])


@pytest.mark.slow
def test_picture_is_the_mean_of_what_a_finer_one_shows() -> None:
    layout = Layout(5, 9, frame_depth_m=0.05)
    case = simple_case(layout, SOFTLY, intrinsics=SMALL, oblique_deg=20.0)
    fine_camera = wide_camera(1200, 900)
    fine = render_facade(replace(case, truth=replace(case.truth, intrinsics=fine_camera)))
    expected = cv2.resize(fine.image, (400, 300), interpolation=cv2.INTER_AREA).astype(float)
    made = render_facade(case)
    on_facade = made.facade
    difference = np.abs(made.image - expected).mean(axis=2)
    assert difference[on_facade].mean() < 4.0
    plain = replace(case, disturbances=Disturbances())
    fine_plain = render_facade(replace(plain, truth=replace(case.truth, intrinsics=fine_camera))).image
    expected = cv2.resize(fine_plain, (400, 300), interpolation=cv2.INTER_AREA).astype(float)
    difference = np.abs(render_facade(plain).image - expected).mean(axis=2)
    assert difference[on_facade].mean() < 0.7


@pytest.mark.slow
def test_same_case_gives_the_same_photo_and_another_seed_another() -> None:
    first, again = (render_facade(random_case("curved", 4, SMALL)) for _ in range(2))
    np.testing.assert_array_equal(first.image, again.image)
    np.testing.assert_array_equal(first.index, again.index)
    assert (render_facade(random_case("curved", 5, SMALL)).image != first.image).mean() > 0.5


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("name", "value", "changes_glass", "changes_frames"),
    [
        ("reflection", 0.4, True, False),
        ("blinds", 0.5, True, False),
        ("shadow", 0.4, True, True),
        ("noise_grey", 3.0, True, True),
        ("blur_px", 1.0, True, True),
        ("clutter", True, False, False),
        ("yaw_error_deg", 1.0, False, False),
        ("tilt_deg", 1.0, False, False),
    ],
)
def test_a_disturbance_changes_what_it_should_and_never_the_truth(
    name: str, value: float, changes_glass: bool, changes_frames: bool
) -> None:
    case = simple_case(Layout(4, 6, mullion_width_m=0.2, transom_width_m=0.2), intrinsics=SMALL)
    before = render_facade(case)
    after = render_facade(replace(case, disturbances=replace(case.disturbances, **{name: value})))
    np.testing.assert_array_equal(before.index, after.index)
    np.testing.assert_array_equal(before.facade, after.facade)
    # Well inside a surface: the picture's pixels on edges are mixed.
    glass = cv2.erode((before.index > 0).astype(np.uint8), np.ones((5, 5))) > 0
    frames = cv2.erode((before.facade & (before.index == 0)).astype(np.uint8), np.ones((3, 3))) > 0
    difference = (before.image != after.image).any(axis=2)
    assert difference[glass].any() == changes_glass
    assert difference[frames].any() == changes_frames
    assert difference[~before.facade].any() == (name in ("shadow", "noise_grey", "blur_px", "clutter"))


@pytest.mark.slow
def test_tilt_pillow_and_glare_show_in_what_is_mirrored() -> None:
    case = simple_case(Layout(4, 6), Disturbances(reflection=0.5), intrinsics=SMALL)
    before = render_facade(case)
    for name, value in (("tilt_deg", 0.5), ("pillow_deg", 0.5), ("glare", 1.0), ("opposite", "grid")):
        after = render_facade(replace(case, disturbances=replace(case.disturbances, **{name: value})))
        changed = (before.image != after.image).any(axis=2)
        assert changed[before.index > 0].mean() > 0.1, name
        assert not changed[~before.facade].any()


def test_glare_saturates_glass() -> None:
    case = simple_case(Layout(4, 6), Disturbances(reflection=0.4, glare=1.0), intrinsics=SMALL)
    made = render_facade(case)
    assert (made.image.min(axis=2) == 255)[made.index > 0].any()


def colours_at(case: Case, places_m: list[tuple[float, float]]) -> np.ndarray:
    s_m, h_m = np.array(places_m).T
    columns, rows = case.truth.pixels(case.wall.points_enu_m(s_m, h_m)).astype(int).T
    return render_facade(case).image[rows, columns].astype(float)


@pytest.mark.slow
def test_glass_looks_different_from_another_side_only_because_it_mirrors() -> None:
    layout = Layout(4, 6)
    places = [(s, h) for s in (-3.8, -2.3, -0.8, 0.8, 2.3) for h in (1.2, 3.6, 6.0)]
    for reflection, differs in ((0.0, False), (0.5, True)):
        cases = [
            simple_case(layout, Disturbances(reflection=reflection), intrinsics=SMALL, oblique_deg=side)
            for side in (-20.0, 20.0)
        ]
        left, right = (colours_at(case, places) for case in cases)
        assert (np.abs(left - right).max() > 20.0) == differs


def test_stated_heading_is_wrong_by_the_yaw_error() -> None:
    case = simple_case(disturbances=Disturbances(yaw_error_deg=2.0), intrinsics=SMALL, from_below_deg=10.0)
    stated = render_facade(case).photo
    assert stated.pose.heading_deg - case.truth.pose.heading_deg == pytest.approx(2.0)
    assert stated.pose.pitch_deg == pytest.approx(case.truth.pose.pitch_deg)


def test_corners_go_round_as_those_of_a_site_do() -> None:
    wall = Wall(outward_heading_deg=70.0, curvature_per_m=0.04)
    for panel in render_facade(simple_case(wall=wall, intrinsics=SMALL)).panels:
        a, b, c, d = panel.corners_enu_m
        normal = np.cross(c - a, d - b)
        middle = panel.corners_enu_m.mean(axis=0)
        assert normal @ (np.array([30.0, 10.0, 8.0]) - middle) > 0.0
        assert a[2] < d[2]
        assert b[2] < c[2]


def test_rows_and_columns_count_from_the_lower_left() -> None:
    panels = render_facade(simple_case(Layout(3, 4), intrinsics=SMALL)).panels
    assert [(panel.row, panel.column) for panel in panels] == [(row, column) for row in range(3) for column in range(4)]
    middles = {(panel.row, panel.column): panel.corners_px.mean(axis=0) for panel in panels}
    assert middles[0, 1][0] > middles[0, 0][0]
    assert middles[1, 0][1] < middles[0, 0][1]


def test_teeth_are_triangles_and_a_slope_begins_with_one() -> None:
    teeth = render_facade(simple_case(Layout(2, 4, top="triangles"), intrinsics=SMALL)).panels
    assert [len(panel.corners_px) for panel in teeth] == [4] * 4 + [3] * 4
    slope = render_facade(simple_case(Layout(2, 4, top="sloped"), intrinsics=SMALL)).panels
    assert [len(panel.corners_px) for panel in slope] == [4] * 4 + [3] + [4] * 3


def test_braces_and_their_pieces_fill_the_cells_that_they_cut() -> None:
    plain, braced = (
        grid_of_layout(Layout(4, 6, widths="random", braces=braces, brace_width_m=0.1), np.random.default_rng(3))
        for braces in ((), ((0, 0, 4, 6), (4, 0, 0, 6)))
    )
    for row, column in np.ndindex(4, 6):
        whole = area(plain.corners(row, column))
        parts = [braced.corners(row, column, part) for part in range(braced.panel_numbers.shape[2])]
        kept = sum(
            area(piece) for piece, number in zip(parts, braced.panel_numbers[row, column], strict=True) if number
        )
        n_braces = (braced.cell_braces[row, column] >= 0).sum()
        assert kept == whole if n_braces == 0 else 0.7 * whole < kept < whole


def test_a_brace_of_no_width_and_a_slope_of_more_rows_than_there_are_cannot_be_made() -> None:
    with pytest.raises(ValueError, match="brace_width_m: expected more than 0"):
        Layout(braces=((0, 0, 1, 1),), brace_width_m=0.0)
    with pytest.raises(ValueError, match="n_sloped_rows: expected 1 to 4, got 5"):
        Layout(4, 6, n_sloped_rows=5)


def test_missing_panels_belong_neither_to_the_panels_nor_to_the_facade() -> None:
    made = render_facade(simple_case(Layout(4, 6, missing_panels=0.4), intrinsics=SMALL))
    assert 0 < len(made.missing) < 24
    assert len(made.panels) == 24 - len(made.missing)
    row, column = made.missing[0]
    s, h = (0.5 * (lines[i] + lines[i + 1]) for lines, i in ((made.columns_m, column), (made.rows_m, row)))
    u, v = made.case.truth.pixels(made.case.wall.points_enu_m(np.array([s]), np.array([h])))[0]
    assert not made.facade[int(v), int(u)]


@pytest.mark.slow
def test_profiles_that_stand_out_hide_more_glass_the_more_oblique_the_view() -> None:
    shares = []
    for oblique in (0.0, 40.0):
        flat, deep = (
            render_facade(simple_case(Layout(4, 6, frame_depth_m=depth), intrinsics=SMALL, oblique_deg=oblique))
            for depth in (0.0, 0.2)
        )
        shares.append((deep.index > 0).sum() / (flat.index > 0).sum())
    # A pane of 1.44 m loses 0.2 m x tan(40 deg) = 12 % of its width.
    assert 0.9 < shares[0] < 1.0
    assert 0.80 < shares[1] < 0.92


def test_a_mullion_that_is_missing_leaves_two_panels_that_touch() -> None:
    grid = grid_of_layout(Layout(2, 3, n_missing_mullions=2), np.random.default_rng(0))
    assert grid.panel_numbers.max() == 6
    assert grid.corners(0, 0)[1, 0] == grid.corners(0, 1)[0, 0]


@given(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(-1.5, 1.5))
def test_clipping_cuts_as_shapely_does(a: float, b: float, c: float) -> None:
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    kept = clip(square, a * square[:, 0] + b * square[:, 1] + c)
    corners = np.array([[-4.0, -4.0], [4.0, -4.0], [4.0, 4.0], [-4.0, 4.0]])
    half_plane = clip(corners, a * corners[:, 0] + b * corners[:, 1] + c)
    area = shapely.Polygon(kept).area if len(kept) > 2 else 0.0
    expected = shapely.Polygon(half_plane) if len(half_plane) > 2 else shapely.Polygon()
    assert area == pytest.approx(shapely.Polygon(square).intersection(expected).area, abs=1e-9)


@pytest.mark.slow
def test_photo_shows_the_whole_facade_at_the_asked_size() -> None:
    for wall in (Wall(), Wall(curvature_per_m=0.05)):
        layout = Layout(8, 14)
        photo = photo_of(wall, layout, SMALL, oblique_deg=15.0, fill=0.8)
        case = simple_case(layout, wall=wall, intrinsics=SMALL, oblique_deg=15.0, fill=0.8)
        made = render_facade(replace(case, truth=photo))
        rows, columns = np.nonzero(made.facade)
        reach = max(np.abs(columns + 0.5 - 200).max() / 200, np.abs(rows + 0.5 - 150).max() / 150)
        assert 0.77 < reach < 0.83


def test_wrong_calls_are_refused() -> None:
    case = simple_case(intrinsics=SMALL)
    behind = replace(case.wall, outward_heading_deg=0.0)
    with pytest.raises(ValueError, match="outside the wall"):
        render_facade(replace(case, wall=behind))
    bent = replace(case.truth, intrinsics=replace(SMALL, distortion=(0.1, 0.0, 0.0, 0.0, 0.0)))
    with pytest.raises(ValueError, match="without distortion"):
        render_facade(replace(case, truth=bent))
    with pytest.raises(ValueError, match="at least one"):
        Layout(0, 3)
    with pytest.raises(ValueError, match="narrower"):
        Layout(mullion_width_m=1.2)
    with pytest.raises(ValueError, match="missing_panels: expected a share"):
        Layout(missing_panels=1.5)
    with pytest.raises(ValueError, match="reflection: expected a share"):
        Disturbances(reflection=-0.1)
    with pytest.raises(ValueError, match="street"):
        Disturbances(street_m=0.0)
