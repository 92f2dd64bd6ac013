"""Inclined lines of synthetic facades: found where there are profiles, and nowhere else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from reconstruction.metrics.metrics import PhotoScores
from reconstruction.metrics.overlaps import found_index, found_region
from reconstruction.metrics.run import Answer, score_answer
from reconstruction.metrics.sets import scored
from reconstruction.panels.search.parameters import SegmentationParameters
from reconstruction.panels.search.record import FacadeGrid
from reconstruction.panels.segment import segment_image, segment_rectified
from reconstruction.scenes.facades.cases import random_case, wide_camera
from reconstruction.scenes.facades.record import Case, Disturbances, Layout
from reconstruction.scenes.facades.render import render_facade
from tests.reconstruction.panels.search.pictures import draw, spans
from tests.reconstruction.synthetic_photos import STRONG, simple_case
from tests.slow import slow

Array = NDArray[np.float64]

CAMERA = wide_camera(1000, 750)


def found_in(layout: Layout, disturbances: Disturbances = STRONG, seed: int = 0) -> tuple[FacadeGrid, PhotoScores]:
    return searched(simple_case(layout, disturbances, intrinsics=CAMERA, seed=seed))


def searched(case: Case) -> tuple[FacadeGrid, PhotoScores]:
    photo = scored(render_facade(case))
    found = segment_image(photo.image, photo.views)
    return found.facades[0], score_answer(photo, Answer(found_index(found), found_region(found), 0.0))


def tilts_deg(grid: FacadeGrid) -> list[float]:
    """Of the inclined lines against the horizon, rising to the right."""
    runs = [np.subtract(line.last_px, line.first_px) for line in grid.inclined]
    return sorted(round(float(np.degrees(np.arctan2(-run[1], run[0]) % np.pi)), 1) for run in runs)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("braces", "n_lines"),
    [
        (((0, 0, 8, 12),), 1),
        slow(((2, 3, 6, 9),), 1),
        slow(((0, 0, 8, 12), (8, 0, 0, 12)), 2),
        (((0, 0, 8, 6), (0, 12, 8, 6)), 2),
    ],
    ids=["one", "one that ends at nodes", "both ways", "two that meet"],
)
def test_braces_cut_the_panels_that_they_cross(braces: tuple[tuple[float, ...], ...], n_lines: int) -> None:
    layout = Layout(braces=braces)  # type: ignore[arg-type]
    grid, scores = found_in(layout)
    assert len(grid.inclined) == n_lines
    assert (scores.n_missed, scores.n_false) == (0, 0)
    assert scores.individual_miou is not None
    assert scores.individual_miou > 0.985
    assert all(line.open_side == 0 and line.confidence > 0.9 for line in grid.inclined)


@pytest.mark.slow
def test_a_gable_ends_the_facade_and_its_short_rows_and_columns_are_found() -> None:
    grid, scores = found_in(Layout(top="gable", n_sloped_rows=6))
    assert (len(grid.rows), len(grid.columns), len(grid.inclined)) == (9, 13, 2)
    assert all(line.open_side != 0 for line in grid.inclined)
    assert (scores.n_missed, scores.n_false) == (0, 0)
    assert scores.overall_iou > 0.98
    assert {3, 4} <= {len(panel.corners_px) for panel in grid.panels}
    assert {(panel.row, panel.column) for panel in grid.panels}.isdisjoint(grid.missing)


@pytest.mark.slow
def test_the_slope_of_a_single_row_is_found_though_the_grid_ends_below_it() -> None:
    grid, scores = found_in(Layout(top="sloped"))
    assert len(grid.rows) == 9
    assert (scores.n_missed, scores.n_false) == (0, 0)


@pytest.mark.slow
def test_triangles_of_a_diagrid_without_mullions_are_faces_of_its_lines() -> None:
    ends = [(0.0, 0.5), (1 / 6, 4 / 6), (2 / 6, 5 / 6), (0.5, 1.0)]
    braces = tuple((0, a, 6, b) for a, b in ends) + tuple((0, b, 6, a) for a, b in ends)
    layout = Layout(6, 1, panel_width_m=24.0, braces=braces)
    grid, scores = searched(simple_case(layout, STRONG, intrinsics=wide_camera(1200, 900)))
    assert len(grid.inclined) == 8
    assert scores.n_missed == 0
    assert scores.individual_miou is not None
    assert scores.individual_miou > 0.98


@pytest.mark.slow
@pytest.mark.parametrize("tilt_deg", [2.0, slow(5.0)])
def test_nearly_upright_profiles_are_not_straightened_away(tilt_deg: float) -> None:
    run = 8 * 2.4 * np.tan(np.radians(tilt_deg)) / 1.5
    grid, scores = found_in(Layout(braces=((0, 2, 8, 2 + run), (0, 6, 8, 6 + run))))
    assert tilts_deg(grid) == pytest.approx([90.0 - tilt_deg] * 2, abs=0.3)
    assert scores.n_missed == 0


@pytest.mark.slow
@pytest.mark.parametrize("tilt_deg", [slow(0.0), 0.35])
def test_mirrored_roofs_and_shadows_cut_nothing(tilt_deg: float) -> None:
    roofs = replace(STRONG, opposite="roofs", tilt_deg=tilt_deg, pillow_deg=0.0)
    grid, _ = found_in(Layout(), roofs, seed=3)
    assert grid.inclined == ()
    assert all(panel.part == 0 for panel in grid.panels)


@pytest.mark.slow
def test_without_inclined_lines_nothing_changes_and_the_reason_is_told() -> None:
    photo = scored(render_facade(random_case("planar", 1, CAMERA)))
    with_search, without = (
        segment_image(photo.image, photo.views, SegmentationParameters(inclined=setting)).facades[0]
        for setting in ("auto", "off")
    )
    assert with_search.inclined == ()
    assert (with_search.rows, with_search.columns) == (without.rows, without.columns)
    for one, other in zip(with_search.panels, without.panels, strict=True):
        np.testing.assert_array_equal(one.corners_px, other.corners_px)
    assert without.decision is not None
    assert (without.decision.on, without.decision.decided_by) == (False, "user")


@pytest.mark.long
def test_an_empty_facade_calls_for_no_search_and_says_why() -> None:
    columns, rows = spans(np.full(8, 70.0), 6.0, 50.0), spans(np.full(6, 70.0), 6.0, 50.0)
    plain = draw(columns, rows, (720, 570), 6.0, reflection=0.0, clutter=False).picture
    decision = segment_rectified(plain).decision
    assert decision is not None
    assert not decision.on
    assert "no inclined line has edges enough" in decision.reason


@pytest.mark.slow
@pytest.mark.parametrize("width_px", [600, slow(1600)])
def test_braces_are_found_at_any_scale(width_px: int) -> None:
    layout = Layout(braces=((0, 0, 8, 12), (8, 0, 0, 12)))
    grid, scores = searched(simple_case(layout, STRONG, intrinsics=wide_camera(width_px, 3 * width_px // 4)))
    assert len(grid.inclined) == 2
    assert scores.n_missed == 0
    assert grid.inclined[0].width_px == pytest.approx(0.08 / 0.06 * grid.rows[3].width_px, rel=0.35)


def test_the_wish_must_be_one_of_three() -> None:
    with pytest.raises(ValueError, match="inclined: expected auto, on or off, got 'maybe'"):
        SegmentationParameters(inclined="maybe")  # type: ignore[arg-type]
