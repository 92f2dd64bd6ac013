"""Panels between the lines of a grid: its cells, and the pieces of those that inclined profiles cut."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from reconstruction.panels.rectify.surface import Rectification
from reconstruction.panels.search.cutting import Cut, cut_pieces
from reconstruction.panels.search.edges import BLUR_PX, EdgeMap
from reconstruction.panels.search.grid import Axes
from reconstruction.panels.search.parameters import SegmentationParameters
from reconstruction.panels.search.record import FacadeGrid, FoundPanel, GridLine, InclinedLine

Array = NDArray[np.float64]


# Where a rectified picture shows inclined edges: its edge pixels with their directions, and lines that gather many.
#
# A line is all points with x cos a + y sin a = r, in continuous pixels; a, from 0 to pi, is the direction of its
# normal,
# 0 for a line along the columns. Edge pixels are those of the search for the grid (`edges.py`): its two maps hold
# every
# edge, steep ones the first and flat ones the second, so nothing is filtered a second time.

LEAST_TILT_RAD = np.radians(1.5)
"""Lines nearer to a row's or column's direction are the grid's own, or their reflections bent by the glass."""

LEAST_OWN_TILT_RAD = np.radians(0.5)
"""Of an edge pixel, whose direction is good to 3 degrees; more than half of those of mirrored uprights are left out."""

BESIDE_GRID_PX = 1.5
"""Edge pixels so near to a profile of the grid are its own: at crossings directions are mixed."""

OWN_RAD = np.radians(20.0)
"""Only pixels whose direction is so near to that of the profile; others may be of a line that crosses it."""

ANGLE_STEP_RAD = np.radians(0.5)
VOTE_REACH = 8
"""Steps of angle to both sides of a pixel's own direction that it votes for: 4 degrees, twice the error of a gradient's
direction under noise."""

NEAR_ANGLE, NEAR_PX = 5, 8
"""Two peaks closer than this, in steps of angle and in pixels, are the edges of one profile."""

MOST_CANDIDATES = 150
"""Of a picture; a diagrid of forty lines and its clutter need half of it."""


@dataclass(frozen=True, slots=True, eq=False)
class EdgePoints:
    """Inclined edge pixels: places, shape (n, 2), px, and directions of their normals, shape (n,), 0 to pi, rising."""

    places_px: Array
    angles_rad: Array

    def along(self, angle_rad: float, within_rad: float) -> Array:
        """Places of those whose normal has this direction, shape (m, 2)."""
        low, high = angle_rad - within_rad, angle_rad + within_rad
        # Beyond half a turn directions begin again.
        spans = ((low, high), (low + np.pi, np.inf), (-np.inf, high - np.pi))
        ends = np.searchsorted(self.angles_rad, np.array(spans))
        return np.concatenate([self.places_px[first:last] for first, last in ends])

    def without(self, is_taken: NDArray[np.bool_]) -> EdgePoints:
        """Those that are not taken, shape (n,)."""
        return EdgePoints(self.places_px[~is_taken], self.angles_rad[~is_taken])


@dataclass(frozen=True, slots=True)
class Candidate:
    """A line on which `votes` edge pixels lie, roughly: to 0.25 degrees and a pixel."""

    angle_rad: float
    distance_px: float
    votes: int


def inclined_points(
    axes: Axes, rows: tuple[GridLine, ...], columns: tuple[GridLine, ...], box_px: tuple[int, int, int, int]
) -> EdgePoints:
    """Edge pixels within a box (left, top, right, bottom) that are neither of the grid nor along its directions."""
    steep = _points(axes.down.edges, axes.down.picture, columns, box_px)
    left, top, right, bottom = box_px
    flat = _points(axes.across.edges, axes.across.picture, rows, (top, left, bottom, right))
    places = np.concatenate([steep.places_px, flat.places_px[:, ::-1]])
    angles = np.concatenate([steep.angles_rad, np.mod(0.5 * np.pi - flat.angles_rad, np.pi)])
    order = np.argsort(angles, kind="stable")
    return EdgePoints(places[order], angles[order])


def _points(
    edges: EdgeMap, picture: NDArray[np.float32], lines: tuple[GridLine, ...], box_px: tuple[int, int, int, int]
) -> EdgePoints:
    """Of one map, whose edges are steep; `lines` along its columns."""
    left, top, right, bottom = box_px
    part = np.ascontiguousarray(picture[top:bottom, left:right])
    smooth = np.asarray(cv2.GaussianBlur(part, (0, 0), BLUR_PX, borderType=cv2.BORDER_REPLICATE), np.float32)
    row, column = np.nonzero(edges.is_edge[top:bottom, left:right])
    across, along = (
        np.asarray(cv2.Sobel(smooth, cv2.CV_32F, dx, 1 - dx, ksize=3, borderType=cv2.BORDER_REPLICATE))[row, column]
        for dx in (1, 0)
    )
    angles = np.mod(np.arctan2(along, across), np.float32(np.pi))
    tilt = np.minimum(angles, np.pi - angles)
    x = left + column + 0.5 + edges.offset_px[row + top, column + left]
    own = np.zeros(right - left, bool)
    for line in lines:
        reach = 0.5 * line.width_px + BESIDE_GRID_PX
        first, last = int(line.position_px - reach) - left, int(np.ceil(line.position_px + reach)) - left
        own[max(0, first) : max(0, last)] = True
    keep = (tilt > LEAST_OWN_TILT_RAD) & ~(own[column] & (tilt < OWN_RAD))
    return EdgePoints(np.column_stack([x, row + top + 0.5])[keep], angles[keep])


def tilt_rad(angle_rad: float) -> float:
    """Between a line and the nearer one of the grid's directions."""
    off = angle_rad % (0.5 * np.pi)
    return float(min(off, 0.5 * np.pi - off))


def candidates(points: EdgePoints, least_votes: float) -> tuple[Candidate, ...]:
    """Lines with so many edge pixels at least, the strongest first; a Hough transform in which directions vote."""
    if len(points.angles_rad) == 0:
        return ()
    origin = points.places_px.min(axis=0)
    n_angles = round(np.pi / ANGLE_STEP_RAD)
    reach = float(np.linalg.norm(np.ptp(points.places_px, axis=0))) + 2.0
    votes = np.zeros((n_angles, 2 * int(np.ceil(reach)) + 1), np.int32)
    _vote(points.places_px - origin, points.angles_rad, votes, ANGLE_STEP_RAD, VOTE_REACH)
    blurred = votes + np.roll(votes, 1, axis=1) + np.roll(votes, -1, axis=1)
    found: list[Candidate] = []
    half = votes.shape[1] // 2
    places = np.argwhere(blurred >= least_votes)
    order = np.argsort(-blurred[places[:, 0], places[:, 1]], kind="stable")
    free = np.ones(votes.shape, bool)
    free[[tilt_rad(i * ANGLE_STEP_RAD) < LEAST_TILT_RAD - ANGLE_STEP_RAD for i in range(n_angles)]] = False
    for i, j in places[order]:
        if not free[i, j]:
            continue
        angle = i * ANGLE_STEP_RAD
        distance = j - half + 0.5 + float(origin @ (np.cos(angle), np.sin(angle)))
        found.append(Candidate(float(angle), distance, int(blurred[i, j])))
        if len(found) == MOST_CANDIDATES:
            break
        for step in range(-NEAR_ANGLE, NEAR_ANGLE + 1):
            # Beyond half a turn the same line has its distance the other way round.
            row, middle = (i + step) % n_angles, j if 0 <= i + step < n_angles else 2 * half - j
            free[row, max(0, middle - NEAR_PX) : middle + NEAR_PX + 1] = False
    return tuple(found)


@kernel
def _vote(places: Array, angles: Array, votes: NDArray[np.int32], step_rad: float, reach: int) -> None:
    n_angles, half = votes.shape[0], votes.shape[1] // 2
    for k in range(len(angles)):
        middle = int(np.rint(angles[k] / step_rad))
        for near in range(middle - reach, middle + reach + 1):
            i = near % n_angles
            distance = places[k, 0] * np.cos(i * step_rad) + places[k, 1] * np.sin(i * step_rad)
            votes[i, int(np.floor(distance)) + half] += 1


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
