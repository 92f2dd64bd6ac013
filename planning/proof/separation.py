"""Directions along which places, legs and lines of sight keep apart from triangles: what a proof says of distances.

Two convex sets are at least d apart where along some unit vector one ends d before the other begins, and the vector
between their nearest points is such a one. For each set, triangles are gone through from the nearest on: the first that
no vector so far separates gives the next one, which mostly separates many others, too.

The nearest points are those of Gilbert, Johnson and Keerthi (1988): the differences of corners span a polytope, and its
point of least norm is approached over simplices of its corners.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks, inline, kernel, run_parallel

Array = NDArray[np.float64]

SLACK_M = 4e-7
"""Kept beyond what is asked for: the verifier asks for 1e-7 m more, and coordinates have rounding."""

DECIMALS = 1e12
SHRINK = 1.0 - 1e-11
"""Directions are written with so many decimals, and so much shorter than 1: rounding makes none longer."""

MOST_DIRECTIONS = 64
SETS_PER_CHUNK = 64
MOST_STEPS = 64

BLOCK = 32
"""Triangles that are looked at together first: sites list neighbours one after the other."""


@kernel
def _affine_least(simplex: Array, size: int, weights: Array) -> bool:
    """Weights of the point of least norm in the affine hull of 1 to 4 points; False where they are not independent."""
    weights[0] = 1.0
    if size == 1:
        return True
    n = size - 1
    gram, right = np.zeros((3, 3)), np.zeros(3)
    for i in range(n):
        for axis in range(3):
            right[i] -= (simplex[i + 1, axis] - simplex[0, axis]) * simplex[0, axis]
            for j in range(n):
                gram[i, j] += (simplex[i + 1, axis] - simplex[0, axis]) * (simplex[j + 1, axis] - simplex[0, axis])
    scale = 1.0
    for i in range(n):
        scale *= gram[i, i]
    determinant = 1.0
    for k in range(n):
        pivot = gram[k, k]
        determinant *= pivot
        if not pivot > 0.0:
            return False
        for i in range(k + 1, n):
            factor = gram[i, k] / pivot
            right[i] -= factor * right[k]
            for j in range(k, n):
                gram[i, j] -= factor * gram[k, j]
    if not determinant > 1e-18 * scale:
        return False
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            right[k] -= gram[k, j] * weights[j + 1]
        weights[k + 1] = right[k] / gram[k, k]
        weights[0] -= weights[k + 1]
    return True


@kernel
def _least_of_simplex(simplex: Array, size: int, nearest: Array) -> int:
    """Point of least norm of the hull of 1 to 4 points; `simplex` is reduced to the corners that span it."""
    best, best_mask = np.inf, 0
    subset, weights, point = np.empty((4, 3)), np.empty(4), np.empty(3)
    for mask in range(1, 1 << size):
        n = 0
        for i in range(size):
            if mask >> i & 1:
                subset[n] = simplex[i]
                n += 1
        if not _affine_least(subset, n, weights) or weights[:n].min() < -1e-12:
            continue
        norm = 0.0
        for axis in range(3):
            point[axis] = 0.0
            for i in range(n):
                point[axis] += weights[i] * subset[i, axis]
            norm += point[axis] * point[axis]
        if norm < best:
            best, best_mask = norm, mask
            nearest[:] = point
    n = 0
    for i in range(size):
        if best_mask >> i & 1:
            simplex[n] = simplex[i]
            n += 1
    return n


@kernel
def _least_norm(points: Array, nearest: Array) -> None:
    """Point of least norm in the convex hull of points, shape (m, 3)."""
    simplex = np.empty((4, 3))
    simplex[0] = points[0]
    nearest[:] = points[0]
    size = 1
    for _ in range(MOST_STEPS):
        support, best = 0, np.inf
        for i in range(len(points)):
            along = nearest[0] * points[i, 0] + nearest[1] * points[i, 1] + nearest[2] * points[i, 2]
            if along < best:
                best, support = along, i
        norm2 = nearest[0] ** 2 + nearest[1] ** 2 + nearest[2] ** 2
        if norm2 - best <= 1e-14 * norm2 or size == 4:
            return
        simplex[size] = points[support]
        size = _least_of_simplex(simplex, size + 1, nearest)


@inline
def _away2(low: Array, high: Array, box_low: Array, box_high: Array) -> float:
    """Squared distance of two boxes."""
    x = max(low[0] - box_high[0], box_low[0] - high[0], 0.0)
    y = max(low[1] - box_high[1], box_low[1] - high[1], 0.0)
    z = max(low[2] - box_high[2], box_low[2] - high[2], 0.0)
    return float(x * x + y * y + z * z)


@kernel
def separate(
    points: Array,
    triangles: Array,
    low: Array,
    high: Array,
    block_low: Array,
    block_high: Array,
    gap: float,
    found: Array,
) -> int:
    """Fill `found` with directions that separate a convex set from all triangles by a gap.

    Triangles are looked at one by one only in blocks that are near, or that a direction does not close as a whole. No
    rounding makes a difference: a box is never farther, and never ends earlier along a direction, than what it holds.

    Parameters
    ----------
    points
        Corners of the set, shape (k, 3).
    triangles, low, high
        Shape (t, 3, 3), and their boxes, shape (t, 3).
    block_low, block_high
        Boxes of `BLOCK` triangles each, in their order, shape (b, 3).
    found
        Shape (most, 3).

    Returns
    -------
    n
        How many directions; -1 - k where triangle k is nearer, or where there were too many.
    """
    n_triangles, n_blocks, n, k_points = len(triangles), len(block_low), 0, len(points)
    is_open, away = np.ones(n_triangles, np.bool_), np.empty(n_triangles)
    is_block_open, is_looked_into = np.ones(n_blocks, np.bool_), np.zeros(n_blocks, np.bool_)
    block_away = np.empty(n_blocks)
    box_low, box_high = np.empty(3), np.empty(3)
    for axis in range(3):
        box_low[axis], box_high[axis] = points[:, axis].min(), points[:, axis].max()
    for block in range(n_blocks):
        block_away[block] = _away2(block_low[block], block_high[block], box_low, box_high)
    differences, way = np.empty((3 * k_points, 3)), np.empty(3)
    while True:
        nearest, best = -1, np.inf
        for block in range(n_blocks):
            if not is_block_open[block] or block_away[block] >= best:
                continue
            first, last = block * BLOCK, min((block + 1) * BLOCK, n_triangles)
            if not is_looked_into[block]:
                is_looked_into[block] = True
                for t in range(first, last):
                    away[t] = _away2(low[t], high[t], box_low, box_high)
            for t in range(first, last):
                if is_open[t] and away[t] < best:
                    nearest, best = t, away[t]
        if nearest < 0:
            return n
        if n == len(found):
            return -1 - nearest
        for i in range(k_points):
            for j in range(3):
                for axis in range(3):
                    differences[3 * i + j, axis] = points[i, axis] - triangles[nearest, j, axis]
        _least_norm(differences, way)
        length = np.sqrt(way[0] ** 2 + way[1] ** 2 + way[2] ** 2)
        if not length > 0.0:
            return -1 - nearest
        for axis in range(3):
            found[n, axis] = np.round(way[axis] / length * SHRINK * DECIMALS) / DECIMALS
        x, y, z = found[n, 0], found[n, 1], found[n, 2]
        level = np.inf
        for i in range(k_points):
            level = min(level, x * points[i, 0] + y * points[i, 1] + z * points[i, 2])
        level -= gap + SLACK_M
        n += 1
        for block in range(n_blocks):
            if not is_block_open[block]:
                continue
            most = (block_high[block, 0] if x > 0.0 else block_low[block, 0]) * x
            most += (block_high[block, 1] if y > 0.0 else block_low[block, 1]) * y
            most += (block_high[block, 2] if z > 0.0 else block_low[block, 2]) * z
            if most <= level:
                is_block_open[block] = False
                continue
            is_block_open[block] = False
            for t in range(block * BLOCK, min((block + 1) * BLOCK, n_triangles)):
                if is_open[t]:
                    most = -np.inf
                    for j in range(3):
                        most = max(most, x * triangles[t, j, 0] + y * triangles[t, j, 1] + z * triangles[t, j, 2])
                    is_open[t] = not most <= level
                    is_block_open[block] = is_block_open[block] or is_open[t]
        if is_block_open[nearest // BLOCK] and is_open[nearest]:
            return -1 - nearest


@kernel
def _separate_all(
    points: Array, counts: NDArray[np.int64], triangles: Array, boxes: tuple[Array, ...], gap: float, found: Array
) -> NDArray[np.int64]:
    n = np.empty(len(points), np.int64)
    for i in range(len(points)):
        n[i] = separate(points[i, : counts[i]], triangles, boxes[0], boxes[1], boxes[2], boxes[3], gap, found[i])
    return n


class Separator:
    """Triangles, and the table of all directions that were found."""

    def __init__(self, table: DirectionTable, triangles: Array) -> None:
        self._table = table
        self.triangles = np.ascontiguousarray(triangles, np.float64).reshape(-1, 3, 3)
        low, high = self.triangles.min(axis=1), self.triangles.max(axis=1)
        starts = np.arange(0, len(low), BLOCK)
        of_blocks = [
            f.reduceat(ends, starts) if len(starts) else ends for f, ends in ((np.minimum, low), (np.maximum, high))
        ]
        self._boxes = low, high, of_blocks[0], of_blocks[1]

    def directions(self, sets: Sequence[Array] | Array, gap_m: float) -> list[list[int] | None]:
        """For each convex set, corners of shape (k, 3), the numbers of directions; None where it is nearer.

        Sets that have equally many corners may come as one array, shape (n, k, 3).
        """
        if not len(self.triangles):
            return [[] for _ in sets]
        parts = chunks(len(sets), SETS_PER_CHUNK)
        return [each for part in run_parallel(self._part, [(sets[a:b], gap_m) for a, b in parts]) for each in part]

    def _part(self, sets: Sequence[Array] | Array, gap_m: float) -> list[list[int] | None]:
        counts = np.array([len(each) for each in sets], np.int64)
        if isinstance(sets, np.ndarray):
            points = np.ascontiguousarray(sets)
        else:
            points = np.zeros((len(sets), int(counts.max()), 3))
            for i, each in enumerate(sets):
                points[i, : len(each)] = each
        found = np.empty((len(sets), MOST_DIRECTIONS, 3))
        n = _separate_all(points, counts, self.triangles, self._boxes, gap_m, found)
        return [None if n[i] < 0 else self._table.numbers(found[i, : n[i]]) for i in range(len(sets))]


class DirectionTable:
    """Directions, each once."""

    def __init__(self, known: Iterable[Sequence[float]] = ()) -> None:
        self._numbers: dict[tuple[float, float, float], int] = {}
        for x, y, z in known:
            self._numbers[x, y, z] = len(self._numbers)

    def numbers(self, directions: Array) -> list[int]:
        """Their places in the table."""
        # Zeros have one sign, so that equal directions have one text.
        rows = (directions + 0.0).tolist()
        return [self._numbers.setdefault((x, y, z), len(self._numbers)) for x, y, z in rows]

    @property
    def rows(self) -> list[list[float]]:
        """The table."""
        return [list(each) for each in self._numbers]


def compile_kernels() -> None:
    """Run every kernel on small inputs."""
    triangle = np.eye(3)[None]
    Separator(DirectionTable(), triangle).directions([np.array([[5.0, 5.0, 5.0], [5.0, 5.0, 6.0]])], 1.0)
