"""Scores as a table, as one summary, and as pictures of truth against what was found."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.json_file import write_atomically
from reconstruction.metrics.metrics import FOUND_IOU, PERCENTILES, PhotoScores, SetScores, Spread
from reconstruction.metrics.pictures import write_picture
from reconstruction.metrics.run import ScoredAnswer

COLUMNS = (
    "photo", "panels", "found", "overall_iou", "overall_miou", *(f"coverage_p{percent}" for percent in PERCENTILES),
    "coverage_least", "individual_miou", "one_to_one_miou", "missed", "false", "seconds",
)  # fmt: skip

TRUE_BGR, FOUND_BGR, MISSED_BGR = (178, 114, 0), (0, 159, 230), (60, 20, 220)
"""Blue, orange, red: told apart by people who see no difference between red and green."""

DIMMED = 0.55
"""How far a photo is faded towards white below the lines."""

LARGEST_PICTURE_PX = 1400


def photo_row(scores: PhotoScores) -> dict[str, Any]:
    """One photo as a row of the table; empty where a score does not apply."""
    values = (
        scores.name,
        scores.n_true,
        scores.n_found,
        _round(scores.overall_iou),
        _round(scores.overall_miou),
        *(_round(scores.coverage_percentile(percent)) for percent in PERCENTILES),
        _round(scores.coverage_percentile(0)),
        _round(scores.individual_miou),
        _round(scores.one_to_one_miou),
        scores.n_missed,
        scores.n_false,
        _round(scores.seconds, 3),
    )
    return dict(zip(COLUMNS, values, strict=True))


def write_table(photos: Sequence[PhotoScores], path: Path) -> None:
    """Write a CSV with a row for each photo."""
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, COLUMNS)
    writer.writeheader()
    writer.writerows(photo_row(photo) for photo in photos)
    write_atomically(path, text.getvalue().encode())


def summary(scores: SetScores) -> dict[str, Any]:
    """Scores of a set for `--json`."""
    return {
        "photos": len(scores.photos),
        "panels": scores.n_panels,
        "missed": scores.n_missed,
        "false": scores.n_false,
        "overall_iou": _spread(scores.overall_iou),
        "overall_miou": _spread(scores.overall_miou),
        "coverage_percentiles": {str(percent): _round(value) for percent, value in scores.coverage.items()},
        "individual_miou": _spread(scores.individual_miou),
        "one_to_one_miou": _spread(scores.one_to_one_miou),
        "seconds": _spread(scores.seconds),
    }


def _spread(spread: Spread | None) -> dict[str, Any] | None:
    if spread is None:
        return None
    return {"mean": _round(spread.mean), "worst": _round(spread.worst), "worst_photo": spread.worst_photo}


def _round(value: float | None, digits: int = 4) -> float | None:
    return None if value is None else round(value, digits)


def picture(case: ScoredAnswer) -> NDArray[np.uint8]:
    """Truth in blue, found in orange, true panels without a partner filled with red.

    Under it lies the photo, faded, or white where its licence does not let it be shown.
    """
    photo, answer = case.photo, case.answer
    if photo.may_be_shown:
        drawn = np.asarray(photo.image * (1.0 - DIMMED) + 255.0 * DIMMED, np.uint8)
    else:
        drawn = np.full_like(photo.image, 255)
    ious = case.scores.ious
    if ious is not None:
        numbers = np.unique(photo.index)
        missed = numbers[numbers > 0][ious <= FOUND_IOU]
        is_missed = np.isin(photo.index, missed)
        drawn[is_missed] = (0.5 * drawn[is_missed] + 0.5 * np.array(MISSED_BGR)).astype(np.uint8)
    thickness = max(1, round(max(photo.image.shape) / LARGEST_PICTURE_PX))
    drawn[_outlines(photo.index, thickness + 1)] = TRUE_BGR
    found = answer.index if answer.index is not None else answer.region
    if found is not None:
        drawn[_outlines(np.asarray(found, np.uint16), thickness)] = FOUND_BGR
    scale = LARGEST_PICTURE_PX / max(photo.image.shape)
    if scale >= 1.0:
        return drawn
    return np.asarray(cv2.resize(drawn, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA), np.uint8)


def _outlines(index: NDArray[np.uint16], thickness: int) -> NDArray[np.bool_]:
    """Inner borders of the panels of an index image."""
    kernel = np.ones((2 * thickness + 1, 2 * thickness + 1), np.uint8)
    return np.asarray((cv2.dilate(index, kernel) != index) | (cv2.erode(index, kernel) != index)) & (index > 0)


def write_pictures(cases: Sequence[ScoredAnswer], folder: Path, suffix: str = ".jpg") -> list[Path]:
    """Write a picture of each case, numbered from the first; returns the paths."""
    paths = []
    for rank, case in enumerate(cases, 1):
        path = folder / f"worst-{rank}-{_file_name(case.photo.name)}{suffix}"
        write_picture(path, picture(case))
        paths.append(path)
    return paths


def _file_name(name: str) -> str:
    """The name with nothing in it that a file system could take for a folder."""
    return "".join(letter if letter.isalnum() or letter in "-_." else "-" for letter in name)
