"""Tables and pictures of scores."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from reconstruction.metrics.metrics import summarise
from reconstruction.metrics.run import (
    COLUMNS,
    MISSED_BGR,
    Answer,
    ScoredAnswer,
    photo_row,
    picture,
    score_answer,
    summary,
    write_pictures,
    write_table,
)
from reconstruction.metrics.sets import ScoredPhoto


@pytest.fixture
def case() -> ScoredAnswer:
    """One panel found, one missed, on a grey photo."""
    index = np.zeros((60, 100), np.uint16)
    index[10:50, 10:40], index[10:50, 60:90] = 3, 8
    found = np.where(index == 3, 1, 0).astype(np.uint16)
    photo = ScoredPhoto("street/house 1", np.full((60, 100, 3), 40, np.uint8), index)
    answer = Answer(found, None, 1.25)
    return ScoredAnswer(photo, answer, score_answer(photo, answer))


def test_table_has_a_row_a_photo_and_empty_cells_where_nothing_applies(case: ScoredAnswer, tmp_path: Path) -> None:
    masks = Answer(None, case.answer.index > 0, 0.0)
    write_table([case.scores, score_answer(case.photo, masks)], tmp_path / "t.csv")
    with (tmp_path / "t.csv").open(newline="") as file:
        full, bare = csv.DictReader(file)
    assert tuple(full) == COLUMNS
    assert (full["photo"], full["panels"], full["found"], full["missed"]) == ("street/house 1", "2", "1", "1")
    assert float(full["individual_miou"]) == 0.5
    assert float(full["seconds"]) == 1.25
    assert bare["individual_miou"] == bare["missed"] == ""
    assert float(bare["overall_iou"]) == 0.5


def test_summary_is_plain_json(case: ScoredAnswer) -> None:
    content = json.loads(json.dumps(summary(summarise([case.scores])), allow_nan=False))
    assert content["overall_iou"] == {"mean": 0.5, "worst": 0.5, "worst_photo": "street/house 1"}
    assert content["coverage_percentiles"] == {"20": 0.2, "10": 0.1, "5": 0.05}
    assert content["missed"] == 1


def test_missed_panels_are_red_and_others_show_the_photo(case: ScoredAnswer) -> None:
    drawn = picture(case)
    red, other = drawn[30, 75].astype(int), drawn[30, 25].astype(int)
    assert red[2] > red[0] + 40
    assert np.ptp(other) == 0
    assert tuple(drawn[30, 75]) != MISSED_BGR


def test_photo_that_may_not_be_shown_leaves_no_trace(case: ScoredAnswer) -> None:
    rng = np.random.default_rng(0)
    pictures = []
    for _ in range(2):
        image = rng.integers(0, 256, (60, 100, 3), np.uint8)
        photo = replace(case.photo, image=image, may_be_shown=False)
        pictures.append(picture(replace(case, photo=photo)))
    np.testing.assert_array_equal(*pictures)
    assert (pictures[0][0, 0] == 255).all()


def test_large_pictures_are_made_smaller(case: ScoredAnswer) -> None:
    photo = replace(
        case.photo,
        image=np.zeros((600, 3000, 3), np.uint8),
        index=cv2.resize(case.photo.index, (3000, 600), interpolation=cv2.INTER_NEAREST),
    )
    answer = Answer(photo.index, None, 0.0)
    assert picture(ScoredAnswer(photo, answer, score_answer(photo, answer))).shape == (280, 1400, 3)


def test_pictures_have_names_that_stay_in_their_folder(case: ScoredAnswer, tmp_path: Path) -> None:
    (path,) = write_pictures([case], tmp_path)
    assert path == tmp_path / "worst-1-street-house-1.jpg"
    assert cv2.imread(str(path)).shape == (60, 100, 3)


def test_row_of_a_photo_without_panels_has_numbers(case: ScoredAnswer) -> None:
    empty = replace(case.photo, index=np.zeros((60, 100), np.uint16))
    row = photo_row(score_answer(empty, Answer(empty.index, None, 0.0)))
    assert row["individual_miou"] == row["coverage_p5"] == 1.0
