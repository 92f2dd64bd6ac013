"""By how much true and found panels overlap: counted in pixels in one pass, or exactly between polygons."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks, kernel
from reconstruction.panels.search.cells import cuts_of
from reconstruction.panels.search.cutting import cut_pieces
from reconstruction.panels.search.record import FacadeGrid, GridLine, Segmentation

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


# Polygons and found facades as index images: a pixel belongs to the polygon that holds its middle.

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


MOST_PANELS = 20_000
"""Of a photo, true or found: a table of both then takes up to 3 GB; more are a picture of something else."""


@dataclass(frozen=True, slots=True, eq=False)
class Overlaps:
    """Areas, px².

    Parameters
    ----------
    joint
        Of every true panel with every found one, shape (n_true, n_found).
    true_areas, found_areas
        Of the panels, shapes (n_true,) and (n_found,).
    covered
        Of each true panel's part inside the found region, shape (n_true,).
    true_region, found_region, joint_region
        Of the regions of glass, and of what they share.
    picture
        Of the whole photo.
    """

    joint: Array
    true_areas: Array
    found_areas: Array
    covered: Array
    true_region: float
    found_region: float
    joint_region: float
    picture: float


def pixel_overlaps(
    true_index: NDArray[Any],
    found_index: NDArray[Any] | None,
    true_region: Mask | None = None,
    found_region: Mask | None = None,
) -> Overlaps:
    """Count pixels in one pass over index images.

    Parameters
    ----------
    true_index, found_index
        Shape (h, w), whole numbers: 0 for no panel. None for a method that finds no single panels.
    true_region, found_region
        Shape (h, w): everything that counts as glass; without them, what belongs to a panel.

    Raises
    ------
    ValueError
        Shapes differ, or neither found panels nor a found region are given.
    """
    if found_index is None and found_region is None:
        raise ValueError("expected found panels or a found region")
    present = [picture for picture in (found_index, true_region, found_region) if picture is not None]
    if any(picture.shape != true_index.shape for picture in present):
        raise ValueError(f"expected pictures of one size, got {[picture.shape for picture in (true_index, *present)]}")
    true_index = _numbers(true_index)
    found_index = np.zeros_like(true_index) if found_index is None else _numbers(found_index)
    in_true = true_index > 0 if true_region is None else true_region
    in_found = found_index > 0 if found_region is None else found_region
    n_true, n_found = int(true_index.max(initial=0)) + 1, int(found_index.max(initial=0)) + 1
    joint, covered = np.zeros((n_true, n_found), np.int64), np.zeros(n_true, np.int64)
    regions = np.zeros((2, 2), np.int64)
    for start, stop in chunks(len(true_index), 512):
        part = slice(start, stop)
        _count(true_index[part], found_index[part], in_true[part], in_found[part], joint, covered, regions)
    areas = joint.sum(axis=1)[1:]
    is_seen, is_found = areas > 0, joint.sum(axis=0)[1:] > 0
    return Overlaps(
        joint[1:, 1:][is_seen][:, is_found].astype(float),
        areas[is_seen].astype(float),
        joint.sum(axis=0)[1:][is_found].astype(float),
        covered[1:][is_seen].astype(float),
        float(regions[1].sum()),
        float(regions[:, 1].sum()),
        float(regions[1, 1]),
        float(true_index.size),
    )


@kernel
def _count(
    true_index: NDArray[np.int32],
    found_index: NDArray[np.int32],
    in_true: Mask,
    in_found: Mask,
    joint: NDArray[np.int64],
    covered: NDArray[np.int64],
    regions: NDArray[np.int64],
) -> None:
    for y in range(true_index.shape[0]):
        for x in range(true_index.shape[1]):
            number, is_in_found = true_index[y, x], in_found[y, x]
            joint[number, found_index[y, x]] += 1
            regions[int(in_true[y, x]), int(is_in_found)] += 1
            if is_in_found:
                covered[number] += 1


def _numbers(index: NDArray[Any]) -> NDArray[np.int32]:
    """An index image as 32-bit numbers, checked."""
    lowest, highest = int(index.min(initial=0)), int(index.max(initial=0))
    if lowest < 0 or highest > MOST_PANELS:
        raise ValueError(f"expected panel numbers from 0 to {MOST_PANELS}, got {lowest} to {highest}")
    return np.asarray(index, np.int32)
