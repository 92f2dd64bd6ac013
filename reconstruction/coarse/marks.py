"""Marks of control points in photos: whether they fit one another, and where their rays meet.

Files of control points have slips: a mark on the wrong target, or pixels of photos that were reduced before.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reconstruction.base.cameras import PosedPhoto

Array = NDArray[np.float64]

MARK_SHARE, LEAST_MARK_PX = 0.005, 3.0
"""Of a photo's longer side: a mark that is further from where the others put the point is of something else."""

Mark = tuple[PosedPhoto, float, float]

MOST_FACTOR, FACTOR_STEP, LEAST_MARKED = 5.0, 1.02, 3
"""Of sizes of photos that are tried for marks, largest and ratio; and how many points have to fit."""


def is_in(photo: PosedPhoto, x: float, y: float) -> bool:
    """Whether pixels are in the picture."""
    return 0.0 <= x <= photo.intrinsics.width_px and 0.0 <= y <= photo.intrinsics.height_px


def scaled_marks(seen: Sequence[Mark], factor: float) -> list[Mark]:
    """Marks in pixels of another size of photos."""
    return [(photo, factor * x, factor * y) for photo, x, y in seen]


def factor_of_marks(marks: Sequence[Sequence[Mark]]) -> float | None:
    """What pixels have to be multiplied with to fit, where they were measured in smaller photos; None where they fit.

    Programs that work on reduced photos want pixels of these. They are believed where hardly a point fits as it is, and
    nearly all fit with one factor.
    """
    marks = [seen for seen in marks if len(seen) >= 2]
    if len(marks) < LEAST_MARKED or sum(_worst_mark(seen) <= 1.0 for seen in marks) > len(marks) // 3:
        return None

    def miss(factor: float) -> float:
        return float(np.median([_worst_mark(scaled_marks(seen, factor)) for seen in marks]))

    n_steps = int(math.log(MOST_FACTOR) / math.log(FACTOR_STEP))
    best = min((FACTOR_STEP**step for step in range(n_steps)), key=miss)
    best = min(np.geomspace(best / FACTOR_STEP, best * FACTOR_STEP, 41).tolist(), key=miss)
    n_fitting = sum(_worst_mark(scaled_marks(seen, best)) <= 1.0 for seen in marks)
    return best if n_fitting >= max(LEAST_MARKED, math.ceil(0.75 * len(marks))) else None


def agreeing_marks(seen: Sequence[Mark]) -> list[Mark]:
    """Marks of a point that fit one another, at least two; none where no two do."""
    kept = list(seen)
    while len(kept) >= 2:
        # The mark is left out without which the others meet best.
        off = _worst_mark(kept)
        if off <= 1.0:
            return kept
        if len(kept) == 2:
            break
        without = [kept[:number] + kept[number + 1 :] for number in range(len(kept))]
        kept = min(without, key=_worst_mark)
    return []


def _worst_mark(seen: Sequence[Mark]) -> float:
    """The largest distance of a mark from where rays meet, in parts of what is allowed; infinite behind a camera."""
    place = meeting_place(seen)[None]
    worst = 0.0
    for photo, x, y in seen:
        pixel = photo.pixels(place)[0]
        longer = max(photo.intrinsics.width_px, photo.intrinsics.height_px)
        off = float(np.hypot(pixel[0] - x, pixel[1] - y)) / max(LEAST_MARK_PX, MARK_SHARE * longer)
        worst = max(worst, off if math.isfinite(off) else math.inf)
    return worst


def meeting_place(seen: Sequence[tuple[PosedPhoto, float, float]]) -> Array:
    """Where rays come nearest to each other, shape (3,)."""
    normal, pull = np.zeros((3, 3)), np.zeros(3)
    for photo, x, y in seen:
        origins, directions = photo.rays(np.array([[x, y]]))
        across = np.eye(3) - np.outer(directions[0], directions[0])
        normal += across
        pull += across @ origins[0]
    return np.asarray(np.linalg.lstsq(normal, pull, rcond=None)[0], np.float64)
