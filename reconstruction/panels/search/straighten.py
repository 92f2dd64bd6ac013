"""Taking the last rotation and perspective out of a rectified view whose pose was slightly wrong.

Lines that should run along the columns then meet in a point far away instead of at infinity, and lines along the rows
in another. In coordinates shifted to the picture's middle, the homography whose columns are these two points and the
middle takes them back to the axes: four numbers, a rotation and a perspective for each direction. Degrees are found
from line segments, before there is a grid; the rest from the lines of the grid, which are long and known to be
straight.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from reconstruction.panels.search.edges import EdgeMap, measured_edge
from reconstruction.panels.search.record import GridLine
from reconstruction.panels.search.segments import Grey, find_segments
from reconstruction.panels.search.vanishing import VanishingPoint, meeting_point
from reconstruction.panels.search.views import mapped

Array = NDArray[np.float64]

LEAST_LENGTH_SHARE = 0.03
"""Shortest segment that counts, as a share of the picture's longer side: long lines know their direction."""

LEAST_MEMBERS = 12
"""Segments that a direction needs before the view is bent after it."""

COARSE_PX = 6.0
"""What segments must say that the picture's corners move before they are believed. Their own error is up to 4 px, where
strong reflections are tilted with their panes; less is left to the lines of the grid."""

FINE_PX = 0.4
"""Corrections from the grid that move nothing by more are left out: edges are found to that accuracy anyway."""

REACH_PX = 3.0
"""Around a line in which its course is followed."""

PIECES = 12
"""Of a line, each with a position of its own."""

LEAST_LINES = 3


def straightening(grey: Grey, max_tilt_deg: float, seed: int = 0) -> Array | None:
    """Homography, shape (3, 3), from the straightened picture to a rectified one; None where none is called for.

    Parameters
    ----------
    grey
        The rectified picture, shape (h, w), 8 bit.
    max_tilt_deg
        Lines tilted by more against rows or columns are of something else.
    """
    height, width = grey.shape
    segments = find_segments(grey, "lsd", max(12.0, LEAST_LENGTH_SHARE * max(grey.shape)))
    if len(segments) == 0:
        return None
    dx, dy = np.abs(segments[:, 2] - segments[:, 0]), np.abs(segments[:, 3] - segments[:, 1])
    steep = float(np.tan(np.radians(max_tilt_deg)))
    across = meeting_point(segments[dy <= steep * dx], width, height, seed)
    down = meeting_point(segments[dx <= steep * dy], width, height, seed)
    columns = np.eye(3)
    for axis, found in enumerate((across, down)):
        if found is not None:
            columns[:, axis] = _as_column(found, axis, width, height, steep)
    return _worthwhile(columns, width, height, COARSE_PX)


def straightening_of_grid(
    down: EdgeMap, across: EdgeMap, rows: tuple[GridLine, ...], columns: tuple[GridLine, ...]
) -> Array | None:
    """As `straightening`, from the courses of the lines of a grid; `across` holds the transposed picture's edges."""
    height, width = down.is_edge.shape
    x_extent, y_extent = _span(columns), _span(rows)
    points = np.eye(3)
    points[:, 1] = _course_point(down, columns, y_extent, width, height)
    swapped = _course_point(across, rows, x_extent, height, width)
    points[:, 0] = swapped[[1, 0, 2]]
    return _worthwhile(points, width, height, FINE_PX)


def _span(lines: tuple[GridLine, ...]) -> slice:
    return slice(int(lines[0].position_px), int(lines[-1].position_px) + 1)


def _course_point(edges: EdgeMap, lines: tuple[GridLine, ...], rows: slice, width: int, height: int) -> Array:
    """Where lines along the columns meet, as (b, 1, q) in pixels from the picture's middle; (0, 1, 0) if not known.

    A line through (x, y) towards (b, 1, q) has the slope dx/dy = s = (b - q x) / (1 - q y), so that
    s = b - q (x - s y): linear in b and q.
    """
    courses = [
        course
        for line in lines
        for side in (-0.5, 0.5)
        if (course := _course(edges, line.position_px + side * line.width_px, rows)) is not None
    ]
    if len(courses) < 2 * LEAST_LINES:
        return np.array([0.0, 1.0, 0.0])
    x, y, s = np.array(courses).T
    x, y = x - width / 2.0, y - height / 2.0
    scale = float(max(width, height))
    design = np.column_stack([np.ones_like(x), -(x - s * y) / scale])
    weights = np.ones_like(s)
    found = np.zeros(2)
    for _ in range(10):
        root = np.sqrt(weights)
        found = np.linalg.lstsq(design * root[:, None], s * root, rcond=None)[0]
        off = np.abs(s - design @ found)
        weights = 1.0 / np.maximum(off, 1.4826 * float(np.median(off)) + 1e-9)
    return np.array([found[0], 1.0, found[1] / scale])


def _course(edges: EdgeMap, x_px: float, rows: slice) -> tuple[float, float, float] | None:
    """Middle (x, y) and slope dx/dy of the edge near a column, by the median slope of pairs of its pieces."""
    borders = np.linspace(rows.start, rows.stop, PIECES + 1).astype(int)
    pieces = [measured_edge(edges, x_px, slice(a, b), REACH_PX) for a, b in pairwise(borders)]
    x = np.array([piece[0] for piece in pieces])
    y = 0.5 * (borders[:-1] + borders[1:])
    known = np.array([piece[2] for piece in pieces]) >= np.maximum(3, np.diff(borders) // 4)
    if known.sum() < PIECES // 2:
        return None
    x, y = x[known], y[known]
    i, j = np.triu_indices(len(x), 1)
    slope = float(np.median((x[j] - x[i]) / (y[j] - y[i])))
    middle = float(np.mean(y))
    return float(np.median(x - slope * (y - middle))), middle, slope


def _as_column(found: VanishingPoint, axis: int, width: int, height: int, steep: float) -> Array:
    """The point in pixels from the picture's middle, 1 along its axis; the axis itself where it is doubtful."""
    straight = np.eye(3)[:, axis]
    x, y, w = found.point
    point = np.array([x - 0.5 * width * w, y - 0.5 * height * w, w])
    if found.members.size < LEAST_MEMBERS or abs(point[1 - axis]) > steep * abs(point[axis]) or point[axis] == 0.0:
        return straight
    return np.asarray(point / point[axis])


def _worthwhile(columns: Array, width: int, height: int, tolerance_px: float) -> Array | None:
    """The homography in the picture's pixels, if it moves a corner by more than the tolerance."""
    middle = np.array([[1.0, 0.0, width / 2.0], [0.0, 1.0, height / 2.0], [0.0, 0.0, 1.0]])
    homography = np.asarray(middle @ columns @ np.linalg.inv(middle))
    corners = np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])
    moved = float(np.abs(mapped(homography, corners) - corners).max())
    return homography if np.isfinite(moved) and moved > tolerance_px else None
