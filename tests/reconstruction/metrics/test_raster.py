"""Polygons in pixels: every pixel by its middle, and found facades with their frames."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from reconstruction.metrics.metrics import score_overlaps
from reconstruction.metrics.overlaps import found_index, found_region, index_image, pixel_overlaps
from reconstruction.panels.search.cells import facade_grid
from reconstruction.panels.search.record import FacadeGrid, FoundPanel, GridLine, InclinedLine, Segmentation
from reconstruction.panels.search.views import WholePicture
from reconstruction.scenes.facades.cases import wide_camera
from reconstruction.scenes.facades.record import Layout
from reconstruction.scenes.facades.render import render_facade
from tests.reconstruction.synthetic_photos import simple_case

coordinates = st.floats(-20.0, 60.0, allow_subnormal=False)


@given(st.lists(st.tuples(coordinates, coordinates), min_size=3, max_size=3))
def test_triangle_holds_the_pixels_whose_middles_it_holds(corners) -> None:
    polygon = shapely.Polygon(corners)
    x, y = np.meshgrid(np.arange(40) + 0.5, np.arange(30) + 0.5)
    # A triangle may be a line or a point, at which Shapely's distance divides by zero.
    with np.errstate(all="ignore"):
        near_edge = shapely.distance(shapely.points(x, y), polygon.boundary) < 1e-6
        inside = shapely.contains_xy(polygon, x, y)
    painted = index_image([np.array(corners)], 40, 30) == 1
    np.testing.assert_array_equal(painted[~near_edge], inside[~near_edge])


@given(st.floats(0.0, 40.0), st.floats(0.0, 40.0))
def test_polygons_that_share_corners_cover_every_pixel_once(x: float, y: float) -> None:
    corners = np.array([[0.0, 0.0], [40.0, 0.0], [40.0, 40.0], [0.0, 40.0]])
    fan = [np.array([a, b, [x, y]]) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    total = sum((index_image([triangle], 40, 40) > 0).astype(int) for triangle in fan)
    np.testing.assert_array_equal(total, 1)


def test_polygons_out_of_sight_or_unknown_are_left_out() -> None:
    outside, unknown = np.array([[50.0, 5.0], [60.0, 5.0], [60.0, 9.0]]), np.array([[0.0, 0.0], [9.0, np.nan], [9, 9]])
    assert not index_image([outside, unknown, outside[:2]], 40, 30).any()
    assert index_image([], 3, 2).shape == (2, 3)


def grid(missing: tuple[tuple[int, int], ...] = ()) -> Segmentation:
    """Two rows of three panels of 20 px with profiles of 4 px."""
    rows = tuple(GridLine(10.0 + 24.0 * i, 4.0) for i in range(3))
    columns = tuple(GridLine(12.0 + 24.0 * i, 4.0) for i in range(4))
    panels = []
    for row in range(2):
        for column in range(3):
            if (row, column) not in missing:
                x, y = 14.0 + 24.0 * column, 12.0 + 24.0 * (1 - row)
                corners = np.array([[x, y + 20.0], [x + 20.0, y + 20.0], [x + 20.0, y], [x, y]])
                panels.append(FoundPanel(f"A-{row}-{column}", row, column, corners, 1.0))
    facade = FacadeGrid("A", WholePicture(100, 80), rows, columns, tuple(panels), missing)
    return Segmentation("photo", 100, 80, (facade,))


def test_region_has_the_frames_and_the_panels_do_not() -> None:
    assert (found_index(grid()) > 0).sum() == 6 * 400
    region = found_region(grid())
    assert region.sum() == (3 * 24 + 4) * (2 * 24 + 4)
    rows, columns = np.nonzero(region)
    assert (rows.min(), columns.min()) == (8, 10)


def test_missing_cell_is_a_hole_in_the_region() -> None:
    region = found_region(grid(missing=((1, 0),)))
    assert not region[20, 20]
    assert region[44, 20]
    assert region.sum() == 76 * 52 - 24 * 24


def test_region_runs_through_under_a_brace_and_ends_at_an_inclined_edge() -> None:
    facade = grid().facades[0]
    brace = InclinedLine((12.0, 10.0), (84.0, 58.0), 4.0)
    regions, panes = [], []
    for line in (brace, replace(brace, open_side=1)):
        cut = facade_grid("A", facade.rectification, facade.rows, facade.columns, (line,))
        found = Segmentation("photo", 100, 80, (cut,))
        regions.append(found_region(found))
        panes.append((found_index(found) > 0).sum())
    assert regions[0].sum() == 76 * 52
    assert panes[1] < panes[0] < 6 * 400
    # A right-angled triangle with sides of 72 and 48 px and the frames around it.
    assert 0.5 * 72 * 48 < regions[1].sum() < 0.5 * 78 * 54 + 4 * 80
    assert regions[0][20, 60]
    assert not regions[1][20, 60]


@pytest.mark.few(1)
@pytest.mark.parametrize("shift_px", [0.0, 0.5, 2.0])
def test_true_corners_score_nearly_one_and_shifted_ones_less(shift_px: float) -> None:
    made = render_facade(simple_case(Layout(6, 9), intrinsics=wide_camera(800, 600), oblique_deg=15.0))
    found = index_image([panel.corners_px + shift_px for panel in made.panels], 800, 600)
    scores = score_overlaps("", pixel_overlaps(made.index, found))
    sides_px = [np.ptp(panel.corners_px, axis=0) for panel in made.panels]
    expected = np.mean([np.prod(side - shift_px) / (2 * np.prod(side) - np.prod(side - shift_px)) for side in sides_px])
    assert scores.individual_miou == pytest.approx(expected, abs=0.01)
    assert (scores.individual_miou > 0.998) == (shift_px == 0.0)
