"""Grids found in photos, as a hand meets them: which line is near, which cell is here, how far a line can go."""

from __future__ import annotations

from bisect import bisect_right

import numpy as np

from reconstruction.panels.search.record import FacadeGrid, FoundPanel, GridLine
from reconstruction.panels.solving.record import Axis

LinePlace = tuple[Axis, int]
"""A line of a grid: its direction and its number."""

LEAST_APART_PX = 3.0
"""Between two lines in the rectified view: no panel is narrower in a photo that shows it as one."""


def lines_of(grid: FacadeGrid, axis: Axis) -> tuple[GridLine, ...]:
    """Lines of one direction, in the order of the rectified view's pixels."""
    return grid.columns if axis == "column" else grid.rows


def line_near(grid: FacadeGrid, point_px: tuple[float, float], reach_px: float) -> LinePlace | None:
    """The line within reach of a point of the rectified view that is nearest to it."""
    x, y = point_px
    offers: list[tuple[float, Axis, int]] = [
        *((abs(line.position_px - x), "column", index) for index, line in enumerate(grid.columns)),
        *((abs(line.position_px - y), "row", index) for index, line in enumerate(grid.rows)),
    ]
    distance, axis, index = min(offers, default=(np.inf, "row", 0))
    return (axis, index) if distance <= reach_px else None


def cell_at(grid: FacadeGrid, point_px: tuple[float, float]) -> tuple[int, int] | None:
    """Row (from the bottom) and column of the cell that holds a point of the rectified view."""
    x, y = point_px
    column = bisect_right([line.position_px for line in grid.columns], x) - 1
    from_top = bisect_right([line.position_px for line in grid.rows], y) - 1
    if not (0 <= column < len(grid.columns) - 1 and 0 <= from_top < len(grid.rows) - 1):
        return None
    return len(grid.rows) - 2 - from_top, column


def cell_bounds(grid: FacadeGrid, row: int, column: int) -> tuple[float, float, float, float]:
    """Left, right, upper and lower line of a cell, by their positions in the rectified view."""
    top = len(grid.rows) - 2 - row
    return (
        grid.columns[column].position_px,
        grid.columns[column + 1].position_px,
        grid.rows[top].position_px,
        grid.rows[top + 1].position_px,
    )


def cell_middle(grid: FacadeGrid, row: int, column: int) -> tuple[float, float]:
    """Middle of a cell in the rectified view."""
    left, right, above, below = cell_bounds(grid, row, column)
    return 0.5 * (left + right), 0.5 * (above + below)


def panels_in(grid: FacadeGrid, cell: tuple[int, int]) -> tuple[FoundPanel, ...]:
    """Panels of a cell: one as a rule, several where it is divided, none where it is no panel."""
    return tuple(panel for panel in grid.panels if (panel.row, panel.column) == cell)


def room_for_line(grid: FacadeGrid, axis: Axis, index: int) -> tuple[float, float]:
    """Between which positions a line may be moved: it stays between its neighbours, and in the picture."""
    lines = lines_of(grid, axis)
    end = grid.rectification.width_px if axis == "column" else grid.rectification.height_px
    low = lines[index - 1].position_px + LEAST_APART_PX if index > 0 else 0.0
    high = lines[index + 1].position_px - LEAST_APART_PX if index + 1 < len(lines) else float(end)
    return low, high


def following_line(grid: FacadeGrid, line: LinePlace | None, step: int) -> LinePlace | None:
    """The next line (`step` 1) or the one before (-1): upright lines from left to right, then level ones downwards.

    The first one, or the last, where none is given; None behind either end.
    """
    order: list[LinePlace] = [("column", index) for index in range(len(grid.columns))]
    order += [("row", index) for index in range(len(grid.rows))]
    at = (-1 if step > 0 else len(order)) if line is None else order.index(line)
    return order[at + step] if 0 <= at + step < len(order) else None


def place_beside(grid: FacadeGrid, line: LinePlace) -> float:
    """Where a line beside this one is added: halfway to the next, or back to the one before where it is the last."""
    axis, index = line
    positions = [one.position_px for one in lines_of(grid, axis)]
    other = index + 1 if index + 1 < len(positions) else max(index - 1, 0)
    return 0.5 * (positions[index] + positions[other])


def cell_beside(
    grid: FacadeGrid, cell: tuple[int, int] | None, upwards: int, rightwards: int
) -> tuple[int, int] | None:
    """The cell so many rows and columns away, within the grid; its lower left one where none is given."""
    n_rows, n_columns = len(grid.rows) - 1, len(grid.columns) - 1
    if n_rows < 1 or n_columns < 1:
        return None
    row, column = (0, 0) if cell is None else (cell[0] + upwards, cell[1] + rightwards)
    return min(max(row, 0), n_rows - 1), min(max(column, 0), n_columns - 1)
