"""Polygons and found facades as index images: a pixel belongs to the polygon that holds its middle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from reconstruction.panels.search.cells import cuts_of
from reconstruction.panels.search.cutting import cut_pieces
from reconstruction.panels.search.record import FacadeGrid, GridLine, Segmentation

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

SIDE_POINTS = 8
"""Points along each side of a cell: on a curved facade a side is an arc in the photo."""


def index_image(polygons: Sequence[Array], width_px: int, height_px: int) -> NDArray[np.uint16]:
    """Paint polygons, each shape (k, 2), px, with 1, 2, ...: later ones over earlier ones, shape (height, width).

    A polygon may cross itself (even-odd rule) and lie outside the picture; one with a NaN is left out. Polygons that
    share an edge share no pixel.
    """
    index = np.zeros((height_px, width_px), np.uint16)
    if len(polygons) > np.iinfo(np.uint16).max:
        raise ValueError(f"expected at most {np.iinfo(np.uint16).max} polygons, got {len(polygons)}")
    for number, polygon in enumerate(polygons, 1):
        points = np.asarray(polygon, float)
        if len(points) >= 3 and np.isfinite(points).all():
            _fill(index, np.ascontiguousarray(points), number)
    return index


@kernel
def _fill(index: NDArray[np.uint16], points: Array, number: int) -> None:
    height, width = index.shape
    n = len(points)
    first = max(0, int(np.ceil(max(points[:, 1].min(), 0.0) - 0.5)))
    last = min(height - 1, int(np.floor(min(points[:, 1].max(), float(height)) - 0.5)))
    crossings = np.empty(n)
    for row in range(first, last + 1):
        y = row + 0.5
        found = 0
        for i in range(n):
            x0, y0 = points[i - 1]
            x1, y1 = points[i]
            # Half-open, so that a corner on the row counts for one of its two sides.
            if (y0 <= y) != (y1 <= y):
                if y0 > y1:
                    # Always from the upper end, so that neighbours find the same crossing to the last bit.
                    x0, y0, x1, y1 = x1, y1, x0, y0
                crossings[found] = x0 + (y - y0) / (y1 - y0) * (x1 - x0)
                found += 1
        ordered = np.sort(crossings[:found])
        for pair in range(0, found - 1, 2):
            left, right = max(ordered[pair], 0.0), min(ordered[pair + 1], float(width))
            for column in range(int(np.ceil(left - 0.5)), int(np.ceil(right - 0.5))):
                index[row, column] = number


def found_index(found: Segmentation) -> NDArray[np.uint16]:
    """Found panels as an index image, numbered in their order."""
    return index_image([panel.corners_px for panel in found.panels], found.width_px, found.height_px)


def found_region(found: Segmentation) -> Mask:
    """Panels and the frames around them: each cell that is a panel, out to the far edges of its lines."""
    cells = [cell for facade in found.facades for cell in _cells(facade)]
    return index_image(cells, found.width_px, found.height_px) > 0


def _cells(facade: FacadeGrid) -> list[Array]:
    cells, cuts = [], cuts_of(facade.inclined)
    for panel in facade.panels:
        from_top = len(facade.rows) - 2 - panel.row
        is_cell = len(panel.corners_px) == 4 or panel.part > 0
        if not is_cell or from_top < 0 or panel.column > len(facade.columns) - 2:
            # A panel that is not a cell of the grid; its frames are not known.
            cells.append(panel.corners_px)
            continue
        top, bottom = _outer(facade.rows[from_top], facade.rows[from_top + 1])
        left, right = _outer(facade.columns[panel.column], facade.columns[panel.column + 1])
        outline = _outline(left, right, top, bottom)
        pieces = cut_pieces(outline, cuts, is_outer=True) if panel.part else [outline]
        cells += [facade.rectification.to_photo(piece) for piece in pieces]
    return cells


def _outer(low: GridLine, high: GridLine) -> tuple[float, float]:
    return low.position_px - 0.5 * low.width_px, high.position_px + 0.5 * high.width_px


def _outline(left: float, right: float, top: float, bottom: float) -> Array:
    """A rectangle's outline with points along its sides, shape (4 SIDE_POINTS, 2)."""
    step = np.arange(SIDE_POINTS)[:, None] / SIDE_POINTS
    corners = np.array([[left, bottom], [right, bottom], [right, top], [left, top]])
    return np.concatenate([a + step * (b - a) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)])
