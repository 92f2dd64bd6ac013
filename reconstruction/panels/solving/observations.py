"""Lines of the grids found in photos, as observations on the facade's surface."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.rectify.surface import FacadeSurface
from reconstruction.panels.search.record import FacadeGrid, GridLine
from reconstruction.panels.solving.record import Axis, SeenLine

Array = NDArray[np.float64]

POINTS = 3
"""Along each line: its ends and its middle, enough for any pose and a cylinder; they share one line's information."""


def seen_lines(photo: PosedPhoto, number: int, grid: FacadeGrid, surface: FacadeSurface) -> tuple[SeenLine, ...]:
    """Lines of one facade's grid in one photo; lines that miss the surface are left out.

    Parameters
    ----------
    number
        Of the photo in its set.
    """
    if len(grid.rows) < 2 or len(grid.columns) < 2:
        return ()
    y0, y1 = grid.rows[0].position_px, grid.rows[-1].position_px
    x0, x1 = grid.columns[0].position_px, grid.columns[-1].position_px
    along_y, along_x = np.linspace(y0, y1, POINTS), np.linspace(x0, x1, POINTS)
    columns = (
        _seen(
            photo, number, grid, surface, "column", line, np.column_stack([np.full(POINTS, line.position_px), along_y])
        )
        for line in grid.columns
    )
    rows = (
        _seen(photo, number, grid, surface, "row", line, np.column_stack([along_x, np.full(POINTS, line.position_px)]))
        for line in grid.rows
    )
    return tuple(line for line in (*columns, *rows) if line is not None)


def _seen(
    photo: PosedPhoto, number: int, grid: FacadeGrid, surface: FacadeSurface, axis: Axis, line: GridLine, points: Array
) -> SeenLine | None:
    across, along = (0, 1) if axis == "column" else (1, 0)
    step = np.zeros(2)
    step[across] = 1.0
    pixels = grid.rectification.to_photo(points)
    here = surface.hits(*photo.rays(pixels))
    beside = surface.hits(*photo.rays(grid.rectification.to_photo(points + step)))
    m_per_px = float(np.abs(beside - here)[:, across].mean())
    if not (np.isfinite(here).all() and np.isfinite(m_per_px)):
        return None
    return SeenLine(
        photo=number,
        axis=axis,
        points_px=pixels,
        position_m=float(here[:, across].mean()),
        width_m=line.width_px * m_per_px,
        sigma_m=line.sigma_px * m_per_px,
        from_m=float(here[:, along].min()),
        to_m=float(here[:, along].max()),
        confidence=line.confidence,
    )


def coordinates(photo: PosedPhoto, surface: FacadeSurface, lines: Sequence[SeenLine]) -> Array:
    """Coordinate across each line, of each of its points, as the photo's pose and the surface put it, shape (n, k)."""
    if not lines:
        return np.zeros((0, POINTS))
    pixels = np.concatenate([line.points_px for line in lines])
    st = surface.hits(*photo.rays(pixels)).reshape(len(lines), -1, 2)
    is_column = np.array([line.axis == "column" for line in lines])
    return np.where(is_column[:, None], st[..., 0], st[..., 1])
