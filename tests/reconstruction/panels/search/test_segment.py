"""Whole pictures: synthetic facades with truth, the hard cases, and pictures that are none."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from planning.base.errors import InputError
from reconstruction.panels.search.parameters import DETECTORS, Detector, SegmentationParameters
from reconstruction.panels.search.record import FacadeGrid
from reconstruction.panels.search.vanishing import straightening
from reconstruction.panels.search.views import CorrectedView, WholePicture
from reconstruction.panels.segment import segment_image, segment_rectified
from tests.reconstruction.panels.search.pictures import Drawn, draw, spans

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

FRAME_PX = 5.0


def made(
    n_columns: int = 9, n_rows: int = 6, seed: int = 0, widths: Array | None = None, clutter: bool = True
) -> Drawn:
    """Panels of 72 x 80 px with reflections, before a background with edges of its own."""
    columns = spans(np.full(n_columns, 72.0) if widths is None else widths, FRAME_PX, 60.0)
    rows = spans(np.full(n_rows, 80.0), FRAME_PX, 50.0)
    size = int(columns[-1, 1] + 65.0), int(rows[-1, 1] + 55.0)
    return draw(columns, rows, size, FRAME_PX, seed, clutter=clutter)


def found_spans(grid: FacadeGrid) -> tuple[Array, Array]:
    """(start, end) of the panels between columns and between rows."""
    both = []
    for lines in (grid.columns, grid.rows):
        ends = np.array(
            [[line.position_px - line.width_px / 2, line.position_px + line.width_px / 2] for line in lines]
        )
        both.append(np.column_stack([ends[:-1, 1], ends[1:, 0]]) if len(ends) else np.empty((0, 2)))
    return both[0], both[1]


def check(grid: FacadeGrid, truth: Drawn, tolerance_px: float = 0.3) -> None:
    columns, rows = found_spans(grid)
    assert columns == pytest.approx(truth.columns, abs=tolerance_px)
    assert rows == pytest.approx(truth.rows, abs=tolerance_px)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_reflecting_facades_are_found_to_a_third_of_a_pixel(seed: int) -> None:
    truth = made(seed=seed)
    check(segment_rectified(truth.picture), truth)


@pytest.mark.slow
@pytest.mark.parametrize(
    "widths", [np.tile([90.0, 50.0], 4), np.array([61.0, 95.0, 48.0, 120.0, 77.0, 55.0])], ids=["alternating", "random"]
)
def test_columns_of_other_widths_are_found(widths: Array) -> None:
    truth = made(seed=4, widths=widths)
    check(segment_rectified(truth.picture), truth)


@pytest.mark.long
def test_panels_are_numbered_from_below_with_corners_counter_clockwise() -> None:
    truth = made()
    grid = segment_rectified(truth.picture)
    assert len(grid.panels) == 54
    first = next(panel for panel in grid.panels if (panel.row, panel.column) == (0, 0))
    (x0, x1), (y0, y1) = truth.columns[0], truth.rows[-1]
    assert first.corners_px == pytest.approx(np.array([[x0, y1], [x1, y1], [x1, y0], [x0, y0]]), abs=0.4)
    assert all(0.0 <= panel.confidence <= 1.0 for panel in grid.panels)
    assert len({panel.id for panel in grid.panels}) == 54


@pytest.mark.long
def test_a_single_panel_is_found() -> None:
    truth = made(1, 1, seed=2, clutter=False)
    check(segment_rectified(truth.picture), truth, 1.0)


@pytest.mark.slow
def test_one_row_of_panels_is_found() -> None:
    truth = made(8, 1, seed=1)
    check(segment_rectified(truth.picture), truth, 0.5)


@pytest.mark.slow
def test_two_hundred_columns_are_found() -> None:
    columns, rows = spans(np.full(200, 14.0), 4.0, 20.0), spans(np.full(3, 40.0), 4.0, 20.0)
    truth = draw(columns, rows, (3650, 180), 4.0, seed=1)
    check(segment_rectified(truth.picture, SegmentationParameters(long_side_px=3650)), truth, 0.5)


@pytest.mark.slow
@pytest.mark.parametrize("turn_deg", [-3.0, 3.0])
def test_a_picture_turned_by_three_degrees_gives_the_same_panels(turn_deg: float) -> None:
    truth = made(seed=3)
    height, width = truth.picture.shape
    turn = cv2.getRotationMatrix2D((width / 2 - 0.5, height / 2 - 0.5), turn_deg, 1.0)
    turned = np.asarray(cv2.warpAffine(truth.picture, turn, (width, height), borderMode=cv2.BORDER_REFLECT), np.uint8)
    grid = segment_rectified(turned)
    assert (len(grid.columns), len(grid.rows)) == (10, 7)
    corner = next(panel for panel in grid.panels if (panel.row, panel.column) == (0, 0)).corners_px[0]
    straight = np.array([truth.columns[0, 0], truth.rows[-1, 1]])
    middle = np.array([width / 2, height / 2])
    assert corner == pytest.approx(middle + turn[:, :2] @ (straight - middle), abs=0.7)


@pytest.mark.slow
def test_a_slightly_wrong_view_is_straightened() -> None:
    """As a yaw error of a degree does: a perspective that nobody told."""
    truth = made(seed=5)
    height, width = truth.picture.shape
    middle = np.array([[1.0, 0.0, width / 2], [0.0, 1.0, height / 2], [0.0, 0.0, 1.0]])
    wrong = middle @ np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [5e-5, 0.0, 1.0]]) @ np.linalg.inv(middle)
    view = CorrectedView(WholePicture(width, height), wrong, width, height)
    grid = segment_image(truth.picture, [view]).facades[0]
    assert (len(grid.columns), len(grid.rows)) == (10, 7)
    for panel in grid.panels:
        x0, x1 = truth.columns[panel.column]
        y0, y1 = truth.rows[len(truth.rows) - 1 - panel.row]
        assert panel.corners_px == pytest.approx(np.array([[x0, y1], [x1, y1], [x1, y0], [x0, y0]]), abs=0.6)


def test_straight_pictures_are_not_bent() -> None:
    assert straightening(made(seed=1).picture, 6.0) is None


@pytest.mark.slow
def test_a_mirrored_facade_that_fakes_a_grid_is_not_taken_for_frames() -> None:
    truth = made(8, 6, seed=6)
    picture = truth.picture.copy()
    rng = np.random.default_rng(0)
    for y0, y1 in np.round(truth.rows).astype(int):
        for x0, x1 in np.round(truth.columns).astype(int):
            glass = picture[y0:y1, x0:x1]
            # A bright bar across and one down the pane, mirror images of a facade across the street, displaced by the
            # tilt of the pane.
            shift = rng.normal(0.0, 4.0, 2)
            x, y = (int(np.clip(s + side / 2, 4, side - 8)) for s, side in zip(shift, glass.shape[::-1], strict=True))
            glass[:, x : x + 4] = 230
            glass[y : y + 4, :] = 230
    check(segment_rectified(picture), truth, 0.5)


@pytest.mark.few(1)
@pytest.mark.parametrize("grey", [0, 128, 255])
def test_even_pictures_hold_no_panels(grey: int) -> None:
    grid = segment_rectified(np.full((300, 400), grey, np.uint8))
    assert grid.panels == ()
    assert grid.rows == grid.columns == ()


def test_noise_holds_no_panels() -> None:
    noise = np.random.default_rng(0).integers(0, 256, (400, 500)).astype(np.uint8)
    assert segment_rectified(noise).panels == ()


@pytest.mark.parametrize("shape", [(1, 1), (1, 500), (500, 1), (2, 2), (17, 3)])
def test_tiny_pictures_hold_no_panels(shape: tuple[int, int]) -> None:
    assert segment_rectified(np.zeros(shape, np.uint8)).panels == ()


@pytest.mark.long
def test_strong_noise_leaves_the_grid() -> None:
    truth = made(seed=7)
    noisy = truth.picture + np.random.default_rng(0).normal(0.0, 12.0, truth.picture.shape)
    check(segment_rectified(np.clip(noisy, 0, 255).astype(np.uint8)), truth, 0.6)


@pytest.mark.slow
def test_saturated_panes_leave_the_grid() -> None:
    truth = made(seed=8)
    picture = truth.picture.copy()
    picture[150:330, 200:460] = 255  # the sun's mirror image drowns frames and all
    columns, rows = found_spans(segment_rectified(picture))
    assert columns.shape == truth.columns.shape
    assert rows.shape == truth.rows.shape


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize("detector", DETECTORS)
def test_every_detector_finds_the_grid(detector: Detector) -> None:
    truth = made(seed=9)
    check(segment_rectified(truth.picture, SegmentationParameters(detector=detector)), truth, 1.5)


@pytest.mark.slow
def test_colour_pictures_and_grey_ones_give_the_same() -> None:
    truth = made(seed=2)
    grey, colour = (segment_rectified(p) for p in (truth.picture, cv2.cvtColor(truth.picture, cv2.COLOR_GRAY2BGR)))
    for a, b in zip(grey.panels, colour.panels, strict=True):
        assert np.allclose(a.corners_px, b.corners_px)


@pytest.mark.slow
def test_the_same_picture_gives_the_same_panels() -> None:
    truth = made(seed=2)
    first, second = (segment_rectified(truth.picture) for _ in range(2))
    assert [p.corners_px.tolist() for p in first.panels] == [p.corners_px.tolist() for p in second.panels]


@pytest.mark.slow
def test_large_pictures_are_searched_small_and_measured_large() -> None:
    truth = made(6, 4, seed=1)
    factor = 3
    large = np.asarray(cv2.resize(truth.picture, None, fx=factor, fy=factor, interpolation=cv2.INTER_CUBIC), np.uint8)
    coarse = SegmentationParameters(long_side_px=600, refined_long_side_px=600)
    grid = segment_rectified(large, SegmentationParameters(long_side_px=600))
    rough = segment_rectified(large, coarse)

    def worst(found: FacadeGrid) -> float:
        k = large.shape[1] / found.rectification.width_px
        columns, rows = found_spans(found)
        return float(
            max(np.abs(columns * k - truth.columns * factor).max(), np.abs(rows * k - truth.rows * factor).max())
        )

    assert worst(grid) < 1.5
    assert worst(grid) <= worst(rough)


@pytest.mark.parametrize(
    "bad", [np.zeros((4, 4), np.float32), np.zeros((4, 4, 4), np.uint8), np.zeros((0, 4), np.uint8)]
)
def test_pictures_of_other_kinds_are_refused_in_words(bad: NDArray[np.generic]) -> None:
    with pytest.raises(InputError, match="8 bit"):
        segment_image(bad)


@pytest.mark.slow
def test_the_papers_posterior_finds_the_same_grid() -> None:
    truth = made(seed=3)
    check(segment_rectified(truth.picture, SegmentationParameters(use_posterior=True)), truth)
