"""Panels between the lines of a grid: its cells, and the pieces of those that inclined profiles cut."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from reconstruction.panels.rectify.rectification import Rectification
from reconstruction.panels.search.cutting import Cut, cut_pieces
from reconstruction.panels.search.inclined import BESIDE_GRID_PX
from reconstruction.panels.search.parameters import SegmentationParameters
from reconstruction.panels.search.record import FacadeGrid, FoundPanel, GridLine, InclinedLine

Array = NDArray[np.float64]


# The panes of a grid that an inclined line runs through: its pieces between their frames.

LEAST_WITNESSES = 2.5
"""Panes that a line must run through: less is a triangle of sky as often as a profile."""

LEAST_NEAR_GRID = 1.0
"""Of them, those of the grid or the next row or column to it: a gable may rise from its last row, and go on above."""

LEAST_PANES, LONGEST_PIECE = 6, 1.5
"""A grid of fewer cells in one direction does not tell how long panes are: its lines are divided as if it had so many,
and longer pieces than so many diagonals of a pane count as several."""

LEAST_PER_PX = 1e-3
"""Of a line's run across grid lines: flatter, it crosses none of them within a picture."""

SHORT_PX = 6.0
"""Shorter pieces of a line within a pane say nothing."""

WIDER, WIDER_PX = 3.0, 4.0
"""Inclined profiles carry loads: up to so many times as wide as the grid's, and so much more for blur."""


@dataclass(frozen=True, slots=True, eq=False)
class Pieces:
    """The parts of a line within panes: from and to, px along the line, shape (k,) each.

    Which of them lie in the grid, and in it with one more row and column around it.
    """

    start: Array
    stop: Array
    in_grid: NDArray[np.bool_]
    near_grid: NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Panes:
    """Panes of the grid, through which lines are followed: what is the same for all candidates.

    Parameters
    ----------
    rows, columns
        Lines of the grid, and more of them beyond it in usual steps: the rows of a gable grow too short for the grid's
        own search.
    box_px, steps_px
        The grid's span and usual step, across the columns and across the rows.
    pane_px, longest_px
        Usual shorter side of a pane, and the longest piece of a line that counts as one witness.
    widest_px
        The widest profile.
    """

    rows: tuple[GridLine, ...]
    columns: tuple[GridLine, ...]
    box_px: tuple[tuple[float, float], tuple[float, float]]
    steps_px: tuple[float, float]
    pane_px: float
    longest_px: float
    widest_px: float

    @classmethod
    def of(
        cls,
        rows: tuple[GridLine, ...],
        columns: tuple[GridLine, ...],
        size_px: tuple[int, int],
        parameters: SegmentationParameters,
    ) -> Panes:
        """Of a grid in a picture of `size_px`, width and height."""
        box = _span(columns), _span(rows)
        steps = [float(np.median(np.diff([line.position_px for line in lines]))) for lines in (columns, rows)]
        sizes = [min(step, (span[1] - span[0]) / LEAST_PANES) for step, span in zip(steps, box, strict=True)]
        usual = float(np.median([line.width_px for line in (*rows, *columns)]))
        more_columns, more_rows = _continued(columns, size_px[0]), _continued(rows, size_px[1])
        widest = min(parameters.max_frame_px, WIDER * usual + WIDER_PX)
        return cls(
            more_rows,
            more_columns,
            box,
            (steps[0], steps[1]),
            min(sizes),
            LONGEST_PIECE * float(np.hypot(sizes[0], sizes[1])),
            widest,
        )

    @property
    def least_votes(self) -> float:
        """Edge pixels without which no candidate can be worth its price: half of both edges in two panes and a half."""
        return LEAST_WITNESSES * self.pane_px

    def span_at(self, angle_rad: float) -> tuple[float, float]:
        """Least and largest distance from the origin of lines of a direction that cross the grid."""
        cos, sin = np.cos(angle_rad), np.sin(angle_rad)
        corners = [x * cos + y * sin for x in self.box_px[0] for y in self.box_px[1]]
        return float(min(corners)), float(max(corners))

    def is_node(self, point_px: Array, reach_px: float) -> bool:
        """Whether a column and a row cross near a point, shape (2,)."""
        return all(
            any(abs(line.position_px - place) <= 0.5 * line.width_px + reach_px for line in lines)
            for lines, place in zip((self.columns, self.rows), point_px, strict=True)
        )

    def pieces(self, angle: float, distance: float) -> Pieces:
        """Parts of a line within the panes of the grid, and within those that would go on from it."""
        cos, sin = np.cos(angle), np.sin(angle)
        zones = []
        low, high, in_grid, near_grid = -np.inf, np.inf, (-np.inf, np.inf), (-np.inf, np.inf)
        # The point at u along the line is distance (cos, sin) + u (-sin, cos).
        for lines, span, step, at_zero, per_px in (
            (self.columns, self.box_px[0], self.steps_px[0], distance * cos, -sin),
            (self.rows, self.box_px[1], self.steps_px[1], distance * sin, cos),
        ):
            if abs(per_px) < LEAST_PER_PX:
                continue
            here = (np.array([line.position_px for line in lines]) - at_zero) / per_px
            half = (0.5 * np.array([line.width_px for line in lines]) + BESIDE_GRID_PX) / abs(per_px)
            zones += list(zip(here - half, here + half, strict=True))
            low, high = max(low, here.min()), min(high, here.max())
            in_grid = _shortened(in_grid, span, 0.0, at_zero, per_px)
            near_grid = _shortened(near_grid, span, step, at_zero, per_px)
        start, stop = [], []
        reached = low
        for zone_start, zone_stop in sorted(zones):
            if low <= reached < zone_start <= high and zone_start - reached >= SHORT_PX:
                parts = np.linspace(reached, zone_start, 1 + int(np.ceil((zone_start - reached) / self.longest_px)))
                start += parts[:-1].tolist()
                stop += parts[1:].tolist()
            reached = max(reached, zone_stop)
        begins, ends = np.array(start), np.array(stop)
        middles = 0.5 * (begins + ends)
        inside, near = ((middles > first) & (middles < last) for first, last in (in_grid, near_grid))
        return Pieces(begins, ends, inside, near)


def _shortened(
    stretch: tuple[float, float], span: tuple[float, float], beyond_px: float, at_zero: float, per_px: float
) -> tuple[float, float]:
    """The part of a stretch of a line within a span of one coordinate, which is at_zero + per_px u along the line."""
    first, last = sorted(((span[0] - beyond_px - at_zero) / per_px, (span[1] + beyond_px - at_zero) / per_px))
    return max(stretch[0], first), min(stretch[1], last)


def _span(lines: tuple[GridLine, ...]) -> tuple[float, float]:
    return lines[0].position_px, lines[-1].position_px


def _continued(lines: tuple[GridLine, ...], length_px: int) -> tuple[GridLine, ...]:
    """Lines with more of them in usual steps up to the picture's ends."""
    places = [line.position_px for line in lines]
    step = float(np.median(np.diff(places)))
    before = np.arange(places[0] - step, 0.0, -step)
    after = np.arange(places[-1] + step, length_px, step)
    width = float(np.median([line.width_px for line in lines]))
    return (
        *(GridLine(float(place), width) for place in before[::-1]),
        *lines,
        *(GridLine(float(place), width) for place in after),
    )


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
