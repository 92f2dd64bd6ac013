"""Vanishing points of the line segments in a photo, by RANSAC and weighted least squares.

Everything is done with homogeneous coordinates on the unit sphere, in pixels shifted to the picture's middle and
divided by its longer side. A line is the unit normal of its plane through the centre, a vanishing point a unit vector
on all the planes of its lines, and a point at infinity is no special case. The error of a segment is the angle between
it and the line from its middle to the vanishing point, weighted by its length: long segments know their direction
better.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from reconstruction.panels.search.edges import EdgeMap, Grey, find_segments, lengths, measured_edge
from reconstruction.panels.search.record import GridLine
from reconstruction.panels.search.views import mapped

Array = NDArray[np.float64]


HYPOTHESES = 600
"""Pairs of segments tried for each point: with a fifth of the length on it, 600 pairs, drawn by length, miss it once in
40 billion."""

INLIER_RAD = np.radians(1.5)
"""Largest angle between a segment and the direction to its vanishing point: detectors are good to 0.5 px at both ends
of 30 px."""

REFINEMENTS = 8

END_SIGMA_PX = 0.5
"""Standard deviation across a segment of each of its ends."""

LEAST_SEGMENTS = 6
"""That a vanishing point needs."""

VERTICAL_WITHIN_RAD = np.radians(35.0)
"""Direction, seen from the picture's middle, within which a vanishing point counts as that of verticals: cameras of
aircraft have little roll."""

APART_RAD = np.radians(3.0)
"""Two vanishing points nearer than this, on the unit sphere of the normalised picture, are one."""


@dataclass(frozen=True, slots=True, eq=False)
class VanishingPoint:
    """Where parallel lines of the scene meet in the picture.

    Parameters
    ----------
    point
        Homogeneous, shape (3,), in the picture's continuous pixels, of unit length; the last number is 0 at infinity.
    covariance
        Shape (3, 3), of the unit vector in normalised coordinates; singular along the vector itself.
    members
        Indices of its segments.
    is_vertical
        Whether the lines are verticals of the scene.
    """

    point: Array
    covariance: Array
    members: NDArray[np.intp]
    is_vertical: bool


def vanishing_points(
    segments: Array, width_px: int, height_px: int, seed: int = 0, most: int = 4
) -> tuple[VanishingPoint, ...]:
    """Vanishing points of segments, shape (n, 4), the one with most length of line first.

    The same seed gives the same points. Segments of one point are not used for the next, so that every segment belongs
    to one at most.
    """
    rng = np.random.default_rng(seed)
    frame = _Frame.of(width_px, height_px)
    normalised = frame.normalised(segments)
    weights = lengths(segments)
    free = np.arange(len(segments))
    found: list[VanishingPoint] = []
    while len(found) < most and free.size >= LEAST_SEGMENTS:
        hypothesis = _best_hypothesis(normalised[free], weights[free], rng)
        if hypothesis is None:
            break
        point, covariance = _refined(normalised[free], weights[free], hypothesis, frame.scale)
        members = free[np.abs(_angles(normalised[free], point)) <= INLIER_RAD]
        if members.size < LEAST_SEGMENTS:
            break
        free = np.setdiff1d(free, members)
        if any(_between(point, frame.to_sphere(other.point)) < APART_RAD for other in found):
            continue
        found.append(VanishingPoint(frame.to_pixels(point), covariance, members, _is_vertical(point)))
    return tuple(found)


def meeting_point(segments: Array, width_px: int, height_px: int, seed: int = 0) -> VanishingPoint | None:
    """The one point that most length of line runs through; None for too few segments."""
    found = vanishing_points(segments, width_px, height_px, seed, most=1)
    return found[0] if found else None


@dataclass(frozen=True, slots=True)
class _Frame:
    """Pixels to normalised coordinates: the middle of the picture is 0, its longer side 1."""

    x: float
    y: float
    scale: float

    @classmethod
    def of(cls, width_px: int, height_px: int) -> _Frame:
        return cls(width_px / 2.0, height_px / 2.0, float(max(width_px, height_px)))

    def normalised(self, segments: Array) -> Array:
        return np.asarray((segments - np.array([self.x, self.y, self.x, self.y])) / self.scale)

    def to_pixels(self, point: Array) -> Array:
        pixel = np.array(
            [self.scale * point[0] + self.x * point[2], self.scale * point[1] + self.y * point[2], point[2]]
        )
        return np.asarray(pixel / np.linalg.norm(pixel), float)

    def to_sphere(self, point_px: Array) -> Array:
        x, y, w = point_px
        point = np.array([(x - self.x * w) / self.scale, (y - self.y * w) / self.scale, w])
        return np.asarray(point / np.linalg.norm(point))


def _planes(segments: Array) -> Array:
    """Unit normals, shape (n, 3), of the planes through the centre and each segment."""
    ones = np.ones(len(segments))
    normals = np.cross(np.column_stack([segments[:, :2], ones]), np.column_stack([segments[:, 2:], ones]))
    return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300))


def _angles(segments: Array, point: Array) -> Array:
    """Signed angle from each segment to the direction from its middle to a point, shape (n,), -pi/2 to pi/2."""
    middle = 0.5 * (segments[:, :2] + segments[:, 2:])
    along = segments[:, 2:] - segments[:, :2]
    towards = point[:2] - point[2] * middle
    cross = along[:, 0] * towards[:, 1] - along[:, 1] * towards[:, 0]
    dot = (along * towards).sum(axis=1)
    return np.asarray(np.arctan2(np.where(dot < 0.0, -cross, cross), np.abs(dot)))


def _best_hypothesis(segments: Array, weights: Array, rng: np.random.Generator) -> Array | None:
    """Meeting point of the pair of segments that most length of line agrees with."""
    planes = _planes(segments)
    pairs = rng.choice(len(segments), size=(HYPOTHESES, 2), p=weights / weights.sum())
    points = np.cross(planes[pairs[:, 0]], planes[pairs[:, 1]])
    sizes = np.linalg.norm(points, axis=1)
    points = points[sizes > 1e-6] / sizes[sizes > 1e-6, None]
    best, most = None, 0.0
    for point in points:
        agreeing = float(weights[np.abs(_angles(segments, point)) <= INLIER_RAD].sum())
        if agreeing > most:
            best, most = point, agreeing
    return best


def _refined(segments: Array, weights: Array, start: Array, scale: float) -> tuple[Array, Array]:
    """Weighted least squares on the planes of the inliers, and the covariance of the unit vector.

    The distance of a plane to the point is turned into the angle at the segment's middle, and that into the offset of
    the segment's ends, which has a known standard deviation.
    """
    point = start
    covariance = np.full((3, 3), np.inf)
    planes = _planes(segments)
    half = 0.5 * np.maximum(weights, 1e-9) / scale
    sigma = END_SIGMA_PX / scale / np.sqrt(2.0)
    for _ in range(REFINEMENTS):
        angles = _angles(segments, point)
        inside = np.abs(angles) <= INLIER_RAD
        if inside.sum() < 2:
            break
        # Angle per unit of plane distance, at the present point; offset of the ends = half length times angle.
        middle = 0.5 * (segments[inside, :2] + segments[inside, 2:])
        reach = np.linalg.norm(point[:2] - point[2] * middle, axis=1)
        along = np.linalg.norm(segments[inside, 2:] - segments[inside, :2], axis=1)
        size = np.linalg.norm(np.cross(_lifted(segments[inside, :2]), _lifted(segments[inside, 2:])), axis=1)
        per_distance = size / np.maximum(reach * along, 1e-12)
        factor = half[inside] * per_distance / sigma
        robust = 1.0 / (1.0 + (half[inside] * angles[inside] / (3.0 * sigma)) ** 2)
        rows = planes[inside] * (factor * np.sqrt(robust))[:, None]
        values, vectors = np.linalg.eigh(rows.T @ rows)
        new = vectors[:, 0] * np.sign(vectors[:, 0] @ point + 1e-300)
        spread = [np.outer(v, v) / max(value, 1e-12) for value, v in zip(values[1:], vectors.T[1:], strict=True)]
        covariance = np.asarray(sum(spread))
        moved = _between(new, point)
        point = new
        if moved < 1e-9:
            break
    return point, covariance


def _lifted(points: Array) -> Array:
    return np.column_stack([points, np.ones(len(points))])


def _between(a: Array, b: Array) -> float:
    """Angle between two directions, whichever way they point, radians."""
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), abs(float(a @ b))))


def _is_vertical(point: Array) -> bool:
    return bool(np.arctan2(abs(point[0]), abs(point[1])) <= VERTICAL_WITHIN_RAD)


# Taking the last rotation and perspective out of a rectified view whose pose was slightly wrong.
#
# Lines that should run along the columns then meet in a point far away instead of at infinity, and lines along the
# rows
# in another. In coordinates shifted to the picture's middle, the homography whose columns are these two points and
# the
# middle takes them back to the axes: four numbers, a rotation and a perspective for each direction. Degrees are found
# from line segments, before there is a grid; the rest from the lines of the grid, which are long and known to be
# straight.

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
