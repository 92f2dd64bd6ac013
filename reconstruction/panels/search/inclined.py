"""Where a rectified picture shows inclined edges: its edge pixels with their directions, and lines that gather many.

A line is all points with x cos a + y sin a = r, in continuous pixels; a, from 0 to pi, is the direction of its normal,
0 for a line along the columns. Edge pixels are those of the search for the grid (`edges.py`): its two maps hold every
edge, steep ones the first and flat ones the second, so nothing is filtered a second time.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from reconstruction.panels.search.edges import BLUR_PX, EdgeMap
from reconstruction.panels.search.grid import Axes
from reconstruction.panels.search.record import GridLine

Array = NDArray[np.float64]

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
