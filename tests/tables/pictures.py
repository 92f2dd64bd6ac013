"""A picture for each table and scene: the unseen photo that shows most glass, and how each model shows it."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from reconstruction.light.photo_set import read_photo_set
from tests.tables.definitions import Table
from tests.tables.scales import Scale
from tests.tables.trainings import Case, shown_photo

WIDE_PX, LABEL_PX = 256, 18
"""Of each part, and of the line below it."""

COLUMNS = 4

LEAST_CASES = 2
"""One alone compares nothing."""


def picture_of(work: Path, scene: str, scale: Scale, case: Case) -> Path:
    """Where the view of a case goes, until all are drawn beside each other."""
    return work / f"{scene}-{case.made_with(scene, scale)}-most-glass.png"


def draw(table: Table, scene: str, scale: Scale, truth: Path, work: Path, folder: Path) -> None:
    """Write the picture of a table and scene, of the cases that were trained here; an older one stays for one alone."""
    parts = []
    for case in table.cases:
        path = picture_of(work, scene, scale, case)
        if path.is_file():
            parts.append(_labelled(_read(path), case.title))
    if len(parts) < LEAST_CASES:
        return
    parts.insert(0, _labelled(_photo(truth), "photo"))
    blank = np.full_like(parts[0], 255)
    parts += [blank] * (-len(parts) % COLUMNS)
    rows = [np.hstack(parts[start : start + COLUMNS]) for start in range(0, len(parts), COLUMNS)]
    cv2.imwrite(str(folder / f"{table.number}-{scene}-{scale.name}.png"), np.vstack(rows))


def _photo(folder: Path) -> NDArray[np.uint8]:
    source = read_photo_set(folder)
    return np.ascontiguousarray(source.picture(shown_photo(source))[..., ::-1])


def _read(path: Path) -> NDArray[np.uint8]:
    found = cv2.imread(str(path))
    if found is None:
        raise ValueError(f"{path}: expected a picture")
    return np.asarray(found, np.uint8)


def _labelled(picture: NDArray[np.uint8], text: str) -> NDArray[np.uint8]:
    height = round(picture.shape[0] * WIDE_PX / picture.shape[1])
    enlarged = cv2.resize(picture, (WIDE_PX, height), interpolation=cv2.INTER_NEAREST)
    label = np.full((LABEL_PX, WIDE_PX, 3), 255, np.uint8)
    cv2.putText(label, text, (4, LABEL_PX - 5), cv2.FONT_HERSHEY_SIMPLEX, 0.4, (0, 0, 0), 1, cv2.LINE_AA)
    return np.vstack([enlarged, label])
