"""Panels between the lines of a grid: its cells, and the pieces of those that inclined profiles cut."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from reconstruction.segmentation.cutting import Cut, cut_pieces
from reconstruction.segmentation.record import FacadeGrid, FoundPanel, GridLine, InclinedLine, Rectification

Array = NDArray[np.float64]

PARTS = "abcdefghijklmnopqrstuvwxyz"


def facade_grid(
    facade_id: str,
    view: Rectification,
    rows: tuple[GridLine, ...],
    columns: tuple[GridLine, ...],
    inclined: tuple[InclinedLine, ...] = (),
) -> FacadeGrid:
    """Panels between lines; cells beyond the facade's edge or out of the photo's reach are missing."""
    panels, missing = [], []
    cuts = cuts_of(inclined)
    for from_top, (above, below) in enumerate(pairwise(rows)):
        row = len(rows) - 2 - from_top
        for column, (left, right) in enumerate(pairwise(columns)):
            box = _corners(left, right, below, above)
            found = _panels(
                f"{facade_id}-r{row}c{column}", row, column, box, cuts, view, (above, below, left, right), inclined
            )
            panels += found
            if not found:
                missing.append((row, column))
    return FacadeGrid(facade_id, view, rows, columns, tuple(panels), tuple(missing), inclined)


def cuts_of(inclined: Sequence[InclinedLine]) -> list[Cut]:
    """Inclined lines as profiles that cut cells of the rectified view."""
    return [
        Cut(np.array(line.first_px), np.array(line.last_px), 0.5 * line.width_px, line.open_side) for line in inclined
    ]


def from_lower_left(corners_px: Array, upward: Array) -> Array:
    """Corners of a polygon, shape (k, 2), from the lower left one on; `upward` is (0, -1) in pictures."""
    lowest = corners_px @ (np.array([1.0, 0.0]) + upward)
    return np.roll(corners_px, -int(np.argmin(lowest)), axis=0)


def _panels(
    name: str,
    row: int,
    column: int,
    box: Array,
    cuts: Sequence[Cut],
    view: Rectification,
    lines: tuple[GridLine, ...],
    inclined: Sequence[InclinedLine],
) -> list[FoundPanel]:
    """The panel of one cell, or its parts."""
    pieces = cut_pieces(box, cuts) if cuts else [box]
    sure = [line.confidence for line in lines]
    is_cut = any(piece is not box for piece in pieces)
    if is_cut:
        sure += [line.confidence for line, cut in zip(inclined, cuts, strict=True) if cut.crosses(box)]
    panels = []
    for number, piece in enumerate(pieces):
        corners = view.to_photo(from_lower_left(piece, np.array([0.0, -1.0])) if is_cut else piece)
        if np.isfinite(corners).all():
            part = number + 1 if is_cut else 0
            letter = PARTS[number % len(PARTS)] if is_cut else ""
            panels.append(FoundPanel(name + letter, row, column, corners, min(sure), part))
    return panels


def _corners(left: GridLine, right: GridLine, below: GridLine, above: GridLine) -> Array:
    x0, x1 = left.position_px + left.width_px / 2, right.position_px - right.width_px / 2
    y0, y1 = above.position_px + above.width_px / 2, below.position_px - below.width_px / 2
    return np.array([[x0, y1], [x1, y1], [x1, y0], [x0, y0]])
