"""Lines and panels of a made facade along its wall."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reconstruction.base.cameras import Array
from reconstruction.scenes.facades.record import BraceEnds, Layout

LEAST_PIECE = 0.04
"""Of a cell's area: smaller pieces that inclined profiles leave are closed, no panels. Nobody builds such panes."""

ALTERNATING = (1.0, 0.6)
RANDOM_WIDTHS = (0.6, 1.4)
"""Widths of columns as multiples of the nominal one."""


@dataclass(frozen=True, slots=True)
class Brace:
    """An inclined profile: where across_s s + across_h h = offset_m, to `half_m` on both sides; a unit normal."""

    across_s: float
    across_h: float
    offset_m: float
    half_m: float

    def signed_m(self, s_m: Array, h_m: Array) -> Array:
        """Distance of places along the wall from the profile's middle, positive on the side of the normal."""
        return np.asarray(self.across_s * s_m + self.across_h * h_m - self.offset_m)


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """A layout drawn up, metres along the wall from its middle and above its base.

    Parameters
    ----------
    columns_m, rows_m
        Middles of the lines, shapes (n_columns + 1,) and (n_rows + 1,), rising. Rows count spandrels.
    tops_m
        Height of the upper edge at the columns' lines, shape (n_columns + 1,); straight between them.
    half_mullions_m
        Half widths of the mullions' pieces, shape (n_rows, n_columns + 1); 0 where a piece is missing.
    half_transom_m
        Of all horizontal profiles, and of the one along the upper edge.
    spandrels
        Rows that are spandrels.
    panel_numbers
        Shape (n_rows, n_columns, n_parts): from 1, row by row from below; 0 for what is no panel. A cell without braces
        has only its part 0; bit k of a part's number says on which side of the cell's k-th brace it lies.
    braces, cell_braces
        Inclined profiles, and those that cross each cell, shape (n_rows, n_columns, k), -1 for none.
    """

    columns_m: Array
    rows_m: Array
    tops_m: Array
    half_mullions_m: Array
    half_transom_m: float
    spandrels: NDArray[np.bool_]
    panel_numbers: NDArray[np.int32]
    braces: tuple[Brace, ...]
    cell_braces: NDArray[np.int64]

    def corners(self, row: int, column: int, part: int = 0) -> Array:
        """Corners of a part of a cell's glass along the wall, shape (k, 2), counter-clockwise from its lower left."""
        polygon = self._glass(row, column)
        for bit, index in enumerate(self.cell_braces[row, column]):
            if index >= 0:
                brace = self.braces[index]
                side = 1.0 if part >> bit & 1 else -1.0
                polygon = clip(polygon, side * brace.signed_m(polygon[:, 0], polygon[:, 1]) - brace.half_m)
        return polygon

    def _glass(self, row: int, column: int) -> Array:
        """Of a whole cell, without its braces."""
        left = self.columns_m[column] + self.half_mullions_m[row, column]
        right = self.columns_m[column + 1] - self.half_mullions_m[row, column + 1]
        bottom, top = self.rows_m[row] + self.half_transom_m, self.rows_m[row + 1] - self.half_transom_m
        box = np.array([[left, bottom], [right, bottom], [right, top], [left, top]])
        (s0, s1), (t0, t1) = self.columns_m[column : column + 2], self.tops_m[column : column + 2]
        if self.rows_m[row + 1] < min(t0, t1):
            return box
        slope = (t1 - t0) / (s1 - s0)
        # The upper profile is as wide as the others across its own direction.
        edge = t0 - self.half_transom_m * np.hypot(1.0, slope)
        return clip(box, edge + slope * (box[:, 0] - s0) - box[:, 1])


def clip(polygon: Array, signed: Array) -> Array:
    """The part of a convex polygon, shape (k, 2), where a linear function, given at its corners, is not negative."""
    kept = []
    for a, b, at_a, at_b in zip(polygon, np.roll(polygon, -1, 0), signed, np.roll(signed, -1), strict=True):
        if at_a >= 0.0:
            kept.append(a)
        if (at_a > 0.0) != (at_b > 0.0) and at_a * at_b < 0.0:
            kept.append(a + (b - a) * at_a / (at_a - at_b))
    return np.array(kept).reshape(-1, 2)


def draw_up(layout: Layout, rng: np.random.Generator) -> Grid:
    """Draw up a layout; `rng` decides random widths and what is missing."""
    n_columns = layout.n_columns
    widths = np.full(n_columns, layout.panel_width_m)
    if layout.widths == "alternating":
        widths *= np.resize(ALTERNATING, n_columns)
    elif layout.widths == "random":
        widths *= rng.uniform(*RANDOM_WIDTHS, n_columns)
    columns = np.concatenate([[0.0], np.cumsum(widths)])
    heights, spandrels = [layout.panel_height_m], [False]
    if layout.spandrel_height_m > 0.0:
        heights, spandrels = [layout.spandrel_height_m, layout.panel_height_m], [True, False]
    rows = np.concatenate([[0.0], np.cumsum(heights * layout.n_rows)])
    n_rows = len(rows) - 1
    half_mullions = np.full((n_rows, n_columns + 1), 0.5 * layout.mullion_width_m)
    half_mullions[:, 1:-1][rng.random((n_rows, n_columns - 1)) < layout.missing_profiles] = 0.0
    n_missing = min(layout.n_missing_mullions, n_columns - 1)
    half_mullions[:, 1 + rng.choice(n_columns - 1, n_missing, replace=False) if n_missing else []] = 0.0
    is_panel = rng.random((n_rows, n_columns)) >= layout.missing_panels
    braces = tuple(
        _brace(ends, columns - 0.5 * columns[-1], rows, 0.5 * layout.brace_width_m) for ends in layout.braces
    )
    cell_braces = _crossing(layout, braces, columns - 0.5 * columns[-1], rows)
    n_parts = 2 ** cell_braces.shape[2]
    grid = Grid(
        columns - 0.5 * columns[-1],
        rows,
        _tops(layout, columns, rows),
        half_mullions,
        0.5 * layout.transom_width_m,
        np.array(spandrels * layout.n_rows),
        np.zeros((n_rows, n_columns, n_parts), np.int32),
        braces,
        cell_braces,
    )
    for row, column in np.argwhere(is_panel):
        (s0, s1), (h0, h1) = grid.columns_m[column : column + 2], rows[row : row + 2]
        for part in range(2 ** int((cell_braces[row, column] >= 0).sum())):
            is_pane = area(grid.corners(row, column, part)) >= LEAST_PIECE * (s1 - s0) * (h1 - h0)
            grid.panel_numbers[row, column, part] = is_pane
    made = grid.panel_numbers > 0
    grid.panel_numbers[made] = np.arange(1, made.sum() + 1)
    return grid


def area(polygon: Array) -> float:
    """Of a simple polygon, shape (k, 2), counter-clockwise; 0 for fewer than three corners."""
    x, y = polygon[:, 0], polygon[:, 1]
    return float(0.5 * (x * np.roll(y, -1) - y * np.roll(x, -1)).sum()) if len(polygon) > 2 else 0.0


def _brace(ends: BraceEnds, columns: Array, rows: Array, half_m: float) -> Brace:
    r0, c0, r1, c1 = ends
    s0, s1 = np.interp([c0, c1], np.arange(len(columns)), columns)
    h0, h1 = np.interp([r0, r1], np.arange(len(rows)), rows)
    across = np.array([h0 - h1, s1 - s0]) / np.hypot(s1 - s0, h1 - h0)
    return Brace(float(across[0]), float(across[1]), float(across @ (s0, h0)), half_m)


def _crossing(layout: Layout, braces: tuple[Brace, ...], columns: Array, rows: Array) -> NDArray[np.int64]:
    """Braces that cross each cell, shape (n_rows, n_columns, k): those with corners on both sides, between its ends."""
    found: list[list[list[int]]] = [[[] for _ in columns[1:]] for _ in rows[1:]]
    s, h = np.meshgrid(columns, rows)
    for index, (brace, (r0, c0, r1, c1)) in enumerate(zip(braces, layout.braces, strict=True)):
        signed = brace.signed_m(s, h)
        for row in range(max(0, int(min(r0, r1))), min(len(rows) - 1, math.ceil(max(r0, r1)))):
            for column in range(max(0, int(min(c0, c1))), min(len(columns) - 1, math.ceil(max(c0, c1)))):
                corners = signed[row : row + 2, column : column + 2]
                if corners.min() < -brace.half_m and corners.max() > brace.half_m:
                    found[row][column].append(index)
    most = max((len(cell) for row in found for cell in row), default=0)
    crossing = np.full((len(rows) - 1, len(columns) - 1, most), -1, np.int64)
    for i, j in np.ndindex(crossing.shape[:2]):
        crossing[i, j, : len(found[i][j])] = found[i][j]
    return crossing


def _tops(layout: Layout, columns: Array, rows: Array) -> Array:
    low, high = float(rows[-1 - layout.n_sloped_rows]), float(rows[-1])
    if layout.top == "sloped":
        return np.asarray(low + (high - low) * columns / columns[-1])
    if layout.top == "gable":
        away = np.abs(columns - columns[len(columns) // 2])
        return np.asarray(high + (low - high) * away / away.max())
    if layout.top == "triangles":
        low = float(rows[-2])
        return np.where(np.arange(len(columns)) % 2, high, low)
    return np.full(len(columns), float(high))
