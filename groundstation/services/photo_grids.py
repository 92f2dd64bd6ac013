"""Grids found in photos, as a hand meets them: which line is near, which cell is here, how far a line can go."""

from __future__ import annotations

from bisect import bisect_right

import numpy as np

from reconstruction.panels.record import Axis
from reconstruction.segmentation.record import FacadeGrid, GridLine

LEAST_APART_PX = 3.0
"""Between two lines in the rectified view: no panel is narrower in a photo that shows it as one."""


def lines_of(grid: FacadeGrid, axis: Axis) -> tuple[GridLine, ...]:
    """Lines of one direction, in the order of the rectified view's pixels."""
    return grid.columns if axis == "column" else grid.rows


def line_near(grid: FacadeGrid, point_px: tuple[float, float], reach_px: float) -> tuple[Axis, int] | None:
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


def cell_middle(grid: FacadeGrid, row: int, column: int) -> tuple[float, float]:
    """Middle of a cell in the rectified view."""
    top = len(grid.rows) - 2 - row
    return (
        0.5 * (grid.columns[column].position_px + grid.columns[column + 1].position_px),
        0.5 * (grid.rows[top].position_px + grid.rows[top + 1].position_px),
    )


def room_for_line(grid: FacadeGrid, axis: Axis, index: int) -> tuple[float, float]:
    """Between which positions a line may be moved: it stays between its neighbours, and in the picture."""
    lines = lines_of(grid, axis)
    end = grid.rectification.width_px if axis == "column" else grid.rectification.height_px
    low = lines[index - 1].position_px + LEAST_APART_PX if index > 0 else 0.0
    high = lines[index + 1].position_px - LEAST_APART_PX if index + 1 < len(lines) else float(end)
    return low, high
