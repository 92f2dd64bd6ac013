"""Height fields: a surface over a regular grid, bilinear in each cell, and what flights over it keep above it.

Between its four nodes a cell is z = z00 + a u + b v + k u v, with u and v from 0 to 1 across it. A straight leg crosses
cell after cell; in each, its height above the surface is a polynomial of second degree in the way flown, so its least
and greatest values are known in closed form, at an end of the stretch or at the vertex of the parabola. The result is
that of the whole leg, not of samples. It costs as much as there are cells below the leg; whether a leg keeps a height
is told from the highest nodes of blocks of cells, where it passes well above them.

A cell with a node that is not known is not known, nor is anything beyond the grid. Nothing can be kept above what is
not known: the least height there is minus infinity, the greatest plus infinity.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks, inline, kernel, run_chunks

Array = NDArray[np.float64]

LEGS_PER_CHUNK = 2048

BLOCK = 16
"""Cells on a side of the blocks whose highest points are kept: most legs pass above most of them."""


@kernel
def heights_below(z: Array, x0: float, y0: float, step: float, xy: Array, result: Array) -> None:
    """Fill `result`, shape (n,), with heights at points, shape (n, 2 or more), as `HeightField.heights_m`."""
    n_rows, n_columns = z.shape
    for i in range(len(xy)):
        u, v = (xy[i, 0] - x0) / step, (xy[i, 1] - y0) / step
        result[i] = np.nan
        if not (0.0 <= u <= n_columns - 1.0 and 0.0 <= v <= n_rows - 1.0):
            continue
        column, row = min(int(u), n_columns - 2), min(int(v), n_rows - 2)
        u, v = u - column, v - row
        south = (1.0 - u) * z[row, column] + u * z[row, column + 1]
        north = (1.0 - u) * z[row + 1, column] + u * z[row + 1, column + 1]
        result[i] = (1.0 - v) * south + v * north


@kernel
def _stretch_extremes(
    z: Array, u0: float, v0: float, z0: float, way: Array, first_t: float, last_t: float
) -> tuple[float, float]:
    """Least and greatest height above the surface of (u0, v0, z0) + t way, u and v in cells, for t in a stretch."""
    n_rows, n_columns = z.shape
    du, dv, dz = way[0], way[1], way[2]
    lowest, highest, t = np.inf, -np.inf, first_t
    # Next grid lines ahead, counted in whole numbers, so that no error adds up.
    u, v = u0 + t * du, v0 + t * dv
    line_u = np.floor(u) + 1.0 if du > 0.0 else np.ceil(u) - 1.0
    line_v = np.floor(v) + 1.0 if dv > 0.0 else np.ceil(v) - 1.0
    while True:
        t_u = (line_u - u0) / du if du != 0.0 else np.inf
        t_v = (line_v - v0) / dv if dv != 0.0 else np.inf
        until = max(min(t_u, t_v, last_t), t)
        middle = 0.5 * (t + until)
        column = min(max(int(np.floor(u0 + middle * du)), 0), n_columns - 2)
        row = min(max(int(np.floor(v0 + middle * dv)), 0), n_rows - 2)
        z00, z10 = z[row, column], z[row, column + 1]
        z01, z11 = z[row + 1, column], z[row + 1, column + 1]
        east, north, twist = z10 - z00, z01 - z00, z11 - z10 - z01 + z00
        u, v = u0 + t * du - column, v0 + t * dv - row
        # Height above the surface at t + s, s from 0: first + slope s + bend s^2.
        first = z0 + t * dz - (z00 + east * u + north * v + twist * u * v)
        slope = dz - (east * du + north * dv + twist * (u * dv + v * du))
        bend = -twist * du * dv
        s = until - t
        last = first + s * (slope + bend * s)
        if not first - last <= np.inf:  # a node is not known
            return -np.inf, np.inf
        lowest, highest = min(lowest, first, last), max(highest, first, last)
        if bend != 0.0:
            vertex = -0.5 * slope / bend
            if 0.0 < vertex < s:
                between = first + 0.5 * vertex * slope
                lowest, highest = min(lowest, between), max(highest, between)
        if until >= last_t:
            return lowest, highest
        if t_u <= until:
            line_u += 1.0 if du > 0.0 else -1.0
        if t_v <= until:
            line_v += 1.0 if dv > 0.0 else -1.0
        t = until


@inline
def _is_over(u0: float, v0: float, way: Array, n_rows: int, n_columns: int) -> bool:
    """Whether both ends of a leg lie over the grid, and so all of it."""
    last_u, last_v = u0 + way[0], v0 + way[1]
    over_columns = 0.0 <= u0 <= n_columns - 1.0 and 0.0 <= last_u <= n_columns - 1.0
    return bool(over_columns and 0.0 <= v0 <= n_rows - 1.0 and 0.0 <= last_v <= n_rows - 1.0)


@kernel
def _leg_extremes(z: Array, x0: float, y0: float, step: float, a: Array, b: Array, least: Array, most: Array) -> None:
    """Least and greatest height of legs from a to b, shape (n, 3), above the surface."""
    way = np.empty(3)
    for i in range(len(a)):
        u0, v0 = (a[i, 0] - x0) / step, (a[i, 1] - y0) / step
        way[0], way[1], way[2] = (b[i, 0] - x0) / step - u0, (b[i, 1] - y0) / step - v0, b[i, 2] - a[i, 2]
        least[i], most[i] = -np.inf, np.inf
        if _is_over(u0, v0, way, z.shape[0], z.shape[1]):
            least[i], most[i] = _stretch_extremes(z, u0, v0, a[i, 2], way, 0.0, 1.0)


@kernel
def _legs_keep(
    z: Array,
    tops: Array,
    x0: float,
    y0: float,
    step: float,
    a: Array,
    b: Array,
    height: float,
    result: NDArray[np.bool_],
) -> None:
    """Whether legs keep a height above the surface: cell by cell only in blocks whose top comes too near."""
    way = np.empty(3)
    for i in range(len(a)):
        u0, v0 = (a[i, 0] - x0) / step, (a[i, 1] - y0) / step
        way[0], way[1], way[2] = (b[i, 0] - x0) / step - u0, (b[i, 1] - y0) / step - v0, b[i, 2] - a[i, 2]
        result[i] = _is_over(u0, v0, way, z.shape[0], z.shape[1])
        if not result[i]:
            continue
        du, dv, t = way[0], way[1], 0.0
        line_u = np.floor(u0 / BLOCK) + 1.0 if du > 0.0 else np.ceil(u0 / BLOCK) - 1.0
        line_v = np.floor(v0 / BLOCK) + 1.0 if dv > 0.0 else np.ceil(v0 / BLOCK) - 1.0
        while True:
            t_u = (line_u * BLOCK - u0) / du if du != 0.0 else np.inf
            t_v = (line_v * BLOCK - v0) / dv if dv != 0.0 else np.inf
            until = max(min(t_u, t_v, 1.0), t)
            middle = 0.5 * (t + until)
            column = min(max(int(np.floor((u0 + middle * du) / BLOCK)), 0), tops.shape[1] - 1)
            row = min(max(int(np.floor((v0 + middle * dv) / BLOCK)), 0), tops.shape[0] - 1)
            lower = a[i, 2] + min(t * way[2], until * way[2])
            if not lower - tops[row, column] >= height:
                least, _ = _stretch_extremes(z, u0, v0, a[i, 2], way, t, until)
                if not least >= height:
                    result[i] = False
                    break
            if until >= 1.0:
                break
            if t_u <= until:
                line_u += 1.0 if du > 0.0 else -1.0
            if t_v <= until:
                line_v += 1.0 if dv > 0.0 else -1.0
            t = until


@kernel
def _spread_departures(
    z: Array, x0: float, y0: float, step: float, points: Array, above: Array, below: Array, highest: Array
) -> None:
    """Raise `above` and lower `below` at the four nodes around each point by how far it lies off the surface.

    `highest` of its cell is raised to the point itself.
    """
    n_rows, n_columns = z.shape
    height = np.empty(1)
    for i in range(len(points)):
        heights_below(z, x0, y0, step, points[i : i + 1], height)
        off = points[i, 2] - height[0]
        if not abs(off) < np.inf:
            continue
        column = min(int((points[i, 0] - x0) / step), n_columns - 2)
        row = min(int((points[i, 1] - y0) / step), n_rows - 2)
        highest[row, column] = max(highest[row, column], points[i, 2])
        for j in range(row, row + 2):
            for k in range(column, column + 2):
                above[j, k] = max(above[j, k], off)
                below[j, k] = min(below[j, k], off)


@dataclass(frozen=True, slots=True, eq=False)
class HeightField:
    """A surface over a grid of square cells in the local frame.

    Parameters
    ----------
    west_m, south_m
        Where node (0, 0) lies, ENU x and y.
    step_m
        Between neighbouring nodes.
    z_m
        Heights of the nodes, ENU z, shape (rows, columns), rows from south to north, columns from west to east; at
        least two of each. NaN where the height is not known.
    """

    west_m: float
    south_m: float
    step_m: float
    z_m: Array

    def __post_init__(self) -> None:
        if self.z_m.ndim != 2 or min(self.z_m.shape) < 2:
            raise ValueError(f"expected heights of shape (2 or more, 2 or more), got {self.z_m.shape}")
        if not (math.isfinite(self.step_m) and self.step_m > 0.0):
            raise ValueError(f"step_m: expected more than 0, got {self.step_m}")

    @property
    def east_m(self) -> float:
        """Where the last column lies."""
        return float(self.west_m + self.step_m * (self.z_m.shape[1] - 1))

    @property
    def north_m(self) -> float:
        """Where the last row lies."""
        return float(self.south_m + self.step_m * (self.z_m.shape[0] - 1))

    def triangles(self, most_nodes: int) -> Array:
        """Two triangles for each cell that is known, shape (t, 3, 3), of so many nodes at most, evenly chosen."""
        every = max(1, math.ceil(math.sqrt(self.z_m.size / most_nodes)))
        nodes = np.concatenate([self.nodes_xy_m(), self.z_m[..., None]], axis=2)[::every, ::every]
        a, b, c, d = nodes[:-1, :-1], nodes[:-1, 1:], nodes[1:, 1:], nodes[1:, :-1]
        found = np.stack([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)], axis=2).reshape(-1, 3, 3)
        return np.asarray(found[np.isfinite(found).all(axis=(1, 2))])

    def nodes_xy_m(self) -> Array:
        """Where the nodes lie, shape (rows, columns, 2)."""
        rows, columns = self.z_m.shape
        x, y = self.west_m + self.step_m * np.arange(columns), self.south_m + self.step_m * np.arange(rows)
        return np.stack(np.meshgrid(x, y), axis=-1)

    def heights_m(self, points_xy_m: Array) -> Array:
        """Height of the surface, ENU z, at points of shape (n, 2) or (n, 3); NaN where it is not known."""
        points = np.ascontiguousarray(points_xy_m, np.float64)
        result = np.empty(len(points))
        heights_below(self.z_m, self.west_m, self.south_m, self.step_m, points, result)
        return result

    def first_met(self, from_enu_m: Array, to_enu_m: Array, n_steps: int = 2000) -> Array | None:
        """Where a line from above comes down to the surface first, shape (3,); None where it does not, or not known.

        Looked for in steps where the line is at heights that the surface has, and then halved: for pointing at things.
        """
        known = self.z_m[np.isfinite(self.z_m)]
        way = to_enu_m - from_enu_m
        if len(known) == 0 or way[2] >= 0.0:
            return None
        low, high = (float((z - from_enu_m[2]) / way[2]) for z in (known.max() + 1e-3, known.min() - 1e-3))
        t = np.linspace(min(max(low, 0.0), 1.0), min(max(high, 0.0), 1.0), n_steps)
        points = from_enu_m + t[:, None] * way
        above = points[:, 2] - self.heights_m(points)
        below = np.flatnonzero((above[1:] <= 0.0) & (above[:-1] > 0.0))
        if len(below) == 0:
            return None
        first, last = t[below[0]], t[below[0] + 1]
        for _ in range(30):
            middle = 0.5 * (first + last)
            point = (from_enu_m + middle * way)[None]
            if point[0, 2] > self.heights_m(point)[0]:
                first = middle
            else:
                last = middle
        return np.asarray(from_enu_m + last * way)

    def leg_heights_m(self, a_enu_m: Array, b_enu_m: Array) -> tuple[Array, Array]:
        """Least and greatest height above the surface along whole legs, ends of shape (n, 3), which may coincide.

        Minus and plus infinity where a leg passes over what is not known. Exact but for rounding, some 1e-12 of the
        heights.
        """
        a, b = (np.ascontiguousarray(ends, np.float64) for ends in (a_enu_m, b_enu_m))
        least, most = np.empty(len(a)), np.empty(len(a))
        grid = self.z_m, self.west_m, self.south_m, self.step_m

        def work(start: int, stop: int) -> None:
            _leg_extremes(*grid, a[start:stop], b[start:stop], least[start:stop], most[start:stop])

        run_chunks(work, chunks(len(a), LEGS_PER_CHUNK))
        return least, most

    def legs_keep(self, a_enu_m: Array, b_enu_m: Array, height_m: float) -> NDArray[np.bool_]:
        """Whether `leg_heights_m` is at least a height; legs far above the surface are told block by block."""
        a, b = (np.ascontiguousarray(ends, np.float64) for ends in (a_enu_m, b_enu_m))
        result, tops = np.empty(len(a), np.bool_), _block_tops(self)
        grid = self.west_m, self.south_m, self.step_m

        def work(start: int, stop: int) -> None:
            _legs_keep(self.z_m, tops, *grid, a[start:stop], b[start:stop], height_m, result[start:stop])

        run_chunks(work, chunks(len(a), LEGS_PER_CHUNK))
        return result

    def spread_departures(self, points_enu_m: Array, above_m: Array, below_m: Array, highest_m: Array) -> None:
        """Widen bounds so that the surfaces `z_m + above_m` and `z_m + below_m` enclose points of shape (n, 3).

        Points over what is not known change nothing.

        Parameters
        ----------
        above_m, below_m
            Of the shape of `z_m`, changed in place.
        highest_m
            Of the cells, shape (rows - 1, columns - 1), changed in place: the highest point over each.
        """
        points = np.ascontiguousarray(points_enu_m, np.float64)
        grid = self.z_m, self.west_m, self.south_m, self.step_m
        _spread_departures(*grid, points, above_m, below_m, highest_m)

    def cells_m(self, combine: np.ufunc) -> Array:
        """A value of each cell from its four nodes, shape (rows - 1, columns - 1)."""
        z = self.z_m
        return np.asarray(combine(combine(z[:-1, :-1], z[:-1, 1:]), combine(z[1:, :-1], z[1:, 1:])))

    def part_m(self, low_xy_m: Array, high_xy_m: Array) -> Array:
        """Heights of the nodes of all cells that a box touches, one value NaN where it reaches beyond the grid."""
        shape = np.array(self.z_m.shape[::-1])
        first = np.floor((np.asarray(low_xy_m[:2]) - [self.west_m, self.south_m]) / self.step_m).astype(np.int64)
        last = np.ceil((np.asarray(high_xy_m[:2]) - [self.west_m, self.south_m]) / self.step_m).astype(np.int64)
        inside = self.z_m[max(first[1], 0) : last[1] + 1, max(first[0], 0) : last[0] + 1].ravel()
        return np.append(inside, np.nan) if (first < 0).any() or (last >= shape).any() else inside


@lru_cache(maxsize=8)
def _block_tops(field: HeightField) -> Array:
    """Highest node of each block of cells; infinite where one is not known."""
    cells = np.nan_to_num(field.cells_m(np.maximum), nan=np.inf)
    rows, columns = (-(-n // BLOCK) for n in cells.shape)
    padded = np.full((rows * BLOCK, columns * BLOCK), -np.inf)
    padded[: cells.shape[0], : cells.shape[1]] = cells
    return np.asarray(padded.reshape(rows, BLOCK, columns, BLOCK).max(axis=(1, 3)))
