"""Lines and panels of a made facade along its wall."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reconstruction.cameras import Array
from reconstruction.made_facades.record import Layout

ALTERNATING = (1.0, 0.6)
RANDOM_WIDTHS = (0.6, 1.4)
"""Widths of columns as multiples of the nominal one."""


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
        Shape (n_rows, n_columns): from 1, row by row from below; 0 for cells that are no panels.
    """

    columns_m: Array
    rows_m: Array
    tops_m: Array
    half_mullions_m: Array
    half_transom_m: float
    spandrels: NDArray[np.bool_]
    panel_numbers: NDArray[np.int32]

    def corners(self, row: int, column: int) -> Array:
        """Corners of a cell's glass along the wall, shape (k, 2), counter-clockwise from the lower left one."""
        left = self.columns_m[column] + self.half_mullions_m[row, column]
        right = self.columns_m[column + 1] - self.half_mullions_m[row, column + 1]
        bottom, top = self.rows_m[row] + self.half_transom_m, self.rows_m[row + 1] - self.half_transom_m
        box = np.array([[left, bottom], [right, bottom], [right, top], [left, top]])
        if row < len(self.rows_m) - 2:
            return box
        (s0, s1), (t0, t1) = self.columns_m[column : column + 2], self.tops_m[column : column + 2]
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
    grid = Grid(
        columns - 0.5 * columns[-1],
        rows,
        _tops(layout, columns, rows),
        half_mullions,
        0.5 * layout.transom_width_m,
        np.array(spandrels * layout.n_rows),
        np.where(is_panel, 1, 0).astype(np.int32),
    )
    for row, column in np.argwhere(is_panel):
        if len(grid.corners(row, column)) < 3:
            grid.panel_numbers[row, column] = 0
    made = grid.panel_numbers > 0
    grid.panel_numbers[made] = np.arange(1, made.sum() + 1)
    return grid


def _tops(layout: Layout, columns: Array, rows: Array) -> Array:
    low, high = float(rows[-2]), float(rows[-1])
    if layout.top == "sloped":
        return np.asarray(low + (high - low) * columns / columns[-1])
    if layout.top == "triangles":
        return np.where(np.arange(len(columns)) % 2, high, low)
    return np.full(len(columns), float(high))
