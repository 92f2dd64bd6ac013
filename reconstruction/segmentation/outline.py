"""The inclined edge of a facade: on which side of it there are panels, and the lines that it leaves room for.

Beyond the edge of a gable no line of the grid goes on. And its upper rows, and its outer columns, are so short that the
search for the grid, which asks for lines that most of the others cross, ends before them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.effects import Decision
from reconstruction.segmentation.arrangement import inclined_lines
from reconstruction.segmentation.cells import cuts_of
from reconstruction.segmentation.extent import seen_along
from reconstruction.segmentation.grid import Axes, Axis, find_lines
from reconstruction.segmentation.parameters import SegmentationParameters
from reconstruction.segmentation.record import GridLine, InclinedLine

Array = NDArray[np.float64]
Lines = tuple[GridLine, ...]

LEAST_SHARE = 0.4
"""Of what is seen of the grid's lines on one side of an inclined one, that the other side must show to hold panels,
too: as for the grid's own borders (`extent.py`)."""

LEAST_USUAL = 0.5
"""Of what is usually seen of the grid's lines, that the side with panels shows."""

MARGIN_PX = 4.0
"""Off the profile, where its own edges would be taken for those of the lines that meet it."""

LEAST_PIECES = 2
"""Of grid lines on each side, to tell."""

LEAST_ROOM = 0.15
"""Of the usual row: what remains above the last one and is lower holds no panels."""

MOST_OF_POINT = 0.3
"""Of the facade's width, that may reach as far as its point: where more does, a line of the grid ends it."""

MOST_NEW = 12
"""Rounds of looking for rows in the part of the width that reaches higher than those found."""


@dataclass(frozen=True, slots=True)
class Arrangement:
    """Lines of the grid, with those that an inclined edge leaves room for, and all inclined lines.

    `decision` says why inclined lines were looked for, or not; None where there is no grid.
    """

    rows: Lines
    columns: Lines
    inclined: tuple[InclinedLine, ...]
    decision: Decision | None


def arranged(axes: Axes, rows: Lines, columns: Lines, parameters: SegmentationParameters) -> Arrangement:
    """What inclined lines there are beside those of a grid, and what they make of it."""
    found, decision = inclined_lines(axes, rows, columns, parameters)
    if not found:
        return Arrangement(rows, columns, (), decision)
    sides = _Sides(axes, rows, columns)
    found = tuple(replace(line, open_side=sides.open_side(line)) for line in found)
    found = _within(found)
    for is_after in (False, True):
        rows = _with_lines_beyond(axes.across, rows, columns, _transposed(found), parameters, is_after)
        columns = _with_lines_beyond(axes.down, columns, rows, found, parameters, is_after)
    return Arrangement(rows, columns, found, decision)


def _within(inclined: tuple[InclinedLine, ...]) -> tuple[InclinedLine, ...]:
    """Lines that do not lie beyond the facade's edge, as the far side of a wall beside it does."""
    cuts = cuts_of(inclined)
    return tuple(
        line
        for line, cut in zip(inclined, cuts, strict=True)
        if not any(other.closes(0.5 * (cut.first + cut.last)) for other in cuts if other is not cut)
    )


class _Sides:
    """What is seen of the grid's lines beside inclined ones."""

    def __init__(self, axes: Axes, rows: Lines, columns: Lines) -> None:
        self._directions = [
            (columns, [_seen(axes.down, line) for line in columns], _step(rows), 0),
            (rows, [_seen(axes.across, line) for line in rows], _step(columns), 1),
        ]
        spans = [slice(int(lines[0].position_px), int(lines[-1].position_px)) for lines in (rows, columns)]
        shares = [
            picture[span].mean()
            for (_, pictures, _, _), span in zip(self._directions, spans, strict=True)
            for picture in pictures
        ]
        self._usual = float(np.median(shares))

    def open_side(self, line: InclinedLine) -> int:
        """As in `InclinedLine`."""
        seen: dict[int, list[float]] = {1: [], -1: []}
        (cut,) = cuts_of([line])
        along = cut.last - cut.first
        for lines, pictures, step_px, across in self._directions:
            if abs(along[across]) < 1e-9:
                continue
            slant = float(np.hypot(*along) / abs(along[across]))
            margin = cut.half_width * slant + MARGIN_PX
            for grid_line, picture in zip(lines, pictures, strict=True):
                share = (grid_line.position_px - cut.first[across]) / along[across]
                place = cut.first[1 - across] + share * along[1 - across]
                for ahead in (-1.0, 1.0):
                    ends = np.sort([place + ahead * margin, place + ahead * (margin + 0.8 * step_px)])
                    if not (0.0 <= share <= 1.0 and ends[0] >= 0.0 and ends[1] <= len(picture)):
                        continue
                    point = np.zeros(2)
                    point[across], point[1 - across] = grid_line.position_px, ends.mean()
                    side = 1 if float(cut.signed(point[None])[0]) > 0.0 else -1
                    seen[side].append(float(picture[int(ends[0]) : int(ends[1]) + 1].mean()))
        if min(map(len, seen.values())) < LEAST_PIECES:
            return 0
        right, left = (float(np.mean(seen[side])) for side in (1, -1))
        if max(right, left) < LEAST_USUAL * self._usual or min(right, left) >= LEAST_SHARE * max(right, left):
            return 0
        return 1 if right > left else -1


def _seen(axis: Axis, line: GridLine) -> NDArray[np.bool_]:
    """Whether an edge of a line along the columns of an axis is seen in each of its rows."""
    return np.asarray(seen_along(axis.edges.is_edge, line).any(axis=0))


def _with_lines_beyond(
    axis: Axis,
    lines: Lines,
    crossing: Lines,
    inclined: Sequence[InclinedLine],
    parameters: SegmentationParameters,
    is_after: bool,
) -> Lines:
    """Lines with those beyond the first (the last, where `is_after`) that lie within the facade's inclined edge.

    Everything as the axis has it: its lines run along its columns, and points are (across them, along them).
    """
    along = np.arange(crossing[0].position_px, crossing[-1].position_px)
    sign = 1.0 if is_after else -1.0
    edge = _edge(along, inclined, sign)
    if edge is None:
        return lines
    usual, limit = _step(lines), float((sign * edge).max())
    for _ in range(MOST_NEW):
        outermost = lines[-1 if is_after else 0].position_px
        reaches = sign * (edge - outermost) > 0.5 * usual
        if reaches.sum() < _step(crossing):
            break
        strip = float(along[reaches].min()), float(along[reaches].max())
        found = find_lines(axis, strip, parameters)
        new = tuple(
            one for one in found if 0.3 * usual < sign * (one.position_px - outermost) < limit - sign * outermost
        )
        if not new:
            break
        lines = (*lines, *new) if is_after else (*new, *lines)
    outermost = lines[-1 if is_after else 0].position_px
    is_point = float((sign * edge > limit - LEAST_ROOM * usual).mean()) < MOST_OF_POINT
    if is_point and limit - sign * outermost > LEAST_ROOM * usual:
        # A little further out than the inclined edges were followed: it is they that cut the cells below it.
        tip = GridLine(sign * (limit + LEAST_ROOM * usual), 0.0, 1.0, 1.0, is_inferred=True)
        lines = (*lines, tip) if is_after else (tip, *lines)
    return lines


def _edge(along: Array, inclined: Sequence[InclinedLine], sign: float) -> Array | None:
    """How far the facade reaches across an axis at each place along it, by its inclined edges on one side.

    Beyond their ends, and between two of them, it goes on straight. None where there are no such edges.
    """
    places, reaches = [], []
    for line, cut in zip(inclined, cuts_of(inclined), strict=True):
        run = abs(cut.last[1] - cut.first[1])
        inwards = 0.5 * (cut.first + cut.last) - np.array([sign, 0.0])
        if line.open_side and run >= 1.0 and line.open_side * float(cut.signed(inwards[None])[0]) > 0.0:
            places += [float(cut.first[1]), float(cut.last[1])]
            reaches += [float(cut.first[0]), float(cut.last[0])]
    if not places:
        return None
    order = np.argsort(places, kind="stable")
    return np.asarray(np.interp(along, np.array(places)[order], np.array(reaches)[order]))


def _transposed(inclined: Sequence[InclinedLine]) -> list[InclinedLine]:
    """As the transposed picture shows them."""
    return [
        replace(line, first_px=line.first_px[::-1], last_px=line.last_px[::-1], open_side=-line.open_side)
        for line in inclined
    ]


def _step(lines: Lines) -> float:
    return float(np.median(np.diff([line.position_px for line in lines])))
