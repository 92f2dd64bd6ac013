"""Scores: known answers, their range, and what happens where there is nothing to divide by."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from reconstruction.metrics.metrics import PhotoScores, score_overlaps, summarise
from reconstruction.metrics.overlaps import pixel_overlaps

indices = arrays.arrays(np.uint16, (8, 8), elements=st.integers(0, 5))


def score(true: np.ndarray, found: np.ndarray | None, **regions: np.ndarray) -> PhotoScores:
    return score_overlaps("photo", pixel_overlaps(true, found, **regions), found is not None)


def two_panels(shift_px: int = 0) -> np.ndarray:
    index = np.zeros((20, 40), np.uint16)
    index[5:15, 5 + shift_px : 15 + shift_px] = 1
    index[5:15, 20 + shift_px : 30 + shift_px] = 2
    return index


def test_perfect_answer_scores_one_whatever_the_numbers() -> None:
    true = two_panels()
    scores = score(true, np.choose(true, [0, 7, 3]).astype(np.uint16))
    assert scores.individual_miou == scores.one_to_one_miou == scores.overall_iou == scores.overall_miou == 1.0
    assert scores.coverage_percentile(5) == 1.0
    assert (scores.n_true, scores.n_found, scores.n_missed, scores.n_false) == (2, 2, 0, 0)


def test_shifted_panels_have_the_iou_of_shifted_squares() -> None:
    scores = score(two_panels(), two_panels(1))
    assert scores.individual_miou == pytest.approx(90 / 110)
    assert scores.overall_iou == pytest.approx(180 / 220)
    assert scores.overall_miou == pytest.approx(0.5 * (180 / 220 + (800 - 220) / (800 - 180)))
    assert scores.coverage_percentile(20) == pytest.approx(0.9)


def test_two_panels_found_as_one_have_the_same_partner_unless_it_may_serve_once() -> None:
    merged = np.zeros((20, 40), np.uint16)
    merged[5:15, 5:30] = 1
    scores = score(two_panels(), merged)
    assert scores.individual_miou == pytest.approx(0.4)
    assert scores.one_to_one_miou == pytest.approx(0.2)
    assert (scores.n_missed, scores.n_false) == (2, 1)
    assert scores.coverage_percentile(5) == 1.0


def test_frames_count_in_the_regions_alone() -> None:
    facade = np.zeros((20, 40), bool)
    facade[4:16, 4:31] = True
    scores = score(two_panels(), two_panels(), true_region=facade, found_region=facade)
    assert scores.overall_iou == 1.0
    assert score(two_panels(), two_panels(), true_region=facade).overall_iou == pytest.approx(200 / 324)


def test_masks_alone_have_no_individual_scores() -> None:
    scores = score(two_panels(), None, found_region=two_panels() == 1)
    assert scores.individual_miou is None
    assert scores.n_missed is None
    np.testing.assert_array_equal(scores.coverages, [1.0, 0.0])
    assert scores.overall_iou == 0.5


def test_nothing_found_and_nothing_there() -> None:
    empty = np.zeros((20, 40), np.uint16)
    nothing = score(two_panels(), empty)
    assert (nothing.individual_miou, nothing.overall_iou, nothing.coverage_percentile(20)) == (0.0, 0.0, 0.0)
    assert nothing.n_missed == 2
    blank = score(empty, empty)
    assert (blank.individual_miou, blank.overall_iou, blank.overall_miou) == (1.0, 1.0, 1.0)
    assert score(empty, two_panels()).n_false == 2
    full = np.ones((4, 4), np.uint16)
    assert score(full, full).overall_miou == 1.0


@given(indices, indices)
def test_scores_are_shares_and_strict_matching_never_scores_more(true: np.ndarray, found: np.ndarray) -> None:
    scores = score(true, found)
    values = [scores.overall_iou, scores.overall_miou, scores.individual_miou, scores.one_to_one_miou]
    values += [scores.coverage_percentile(percent) for percent in (20, 10, 5)]
    assert all(0.0 <= value <= 1.0 for value in values)
    assert scores.one_to_one_miou <= scores.individual_miou + 1e-12
    assert scores.coverage_percentile(5) <= scores.coverage_percentile(20)


@given(indices, indices)
def test_overall_score_is_symmetric(true: np.ndarray, found: np.ndarray) -> None:
    assert score(true, found).overall_iou == score(found, true).overall_iou


def test_sets_pool_coverage_over_panels_and_average_the_rest_over_photos() -> None:
    good, bad = score(two_panels(), two_panels()), score(two_panels(), np.zeros((20, 40), np.uint16))
    many = summarise([good] * 9 + [bad])
    assert many.overall_iou.mean == pytest.approx(0.9)
    assert many.individual_miou.worst == 0.0
    assert many.n_panels == 20
    assert many.n_missed == 2
    assert many.coverage == {20: 1.0, 10: pytest.approx(0.9), 5: 0.0}


def test_set_without_single_panels_has_no_individual_score() -> None:
    mask = score(two_panels(), None, found_region=two_panels() > 0)
    assert summarise([mask, mask]).individual_miou is None
    with pytest.raises(ValueError, match="at least one"):
        summarise([])
