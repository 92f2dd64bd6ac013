"""By how much true and found panels overlap: counted in pixels in one pass, or exactly between polygons."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from planning.base.jit import chunks, kernel

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

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
    given = [picture for picture in (found_index, true_region, found_region) if picture is not None]
    if any(picture.shape != true_index.shape for picture in given):
        raise ValueError(f"expected pictures of one size, got {[picture.shape for picture in (true_index, *given)]}")
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


def polygon_overlaps(
    true_polygons: Sequence[Array], found_polygons: Sequence[Array], width_px: int, height_px: int
) -> Overlaps:
    """Exact areas of polygons, each shape (k, 2), inside a picture; regions are the unions of the panels.

    As in `pixel_overlaps`, polygons with no area inside the picture do not count.
    """
    frame = shapely.box(0.0, 0.0, width_px, height_px)
    true, found = (_inside(polygons, frame) for polygons in (true_polygons, found_polygons))
    joint = np.zeros((len(true), len(found)))
    if len(true) and len(found):
        first, second = shapely.STRtree(found).query(true, predicate="intersects")
        joint[first, second] = shapely.area(shapely.intersection(true[first], found[second]))
    true_region, found_region = shapely.union_all(true), shapely.union_all(found)
    return Overlaps(
        joint,
        np.asarray(shapely.area(true), float),
        np.asarray(shapely.area(found), float),
        np.asarray(shapely.area(shapely.intersection(true, found_region)), float),
        float(true_region.area),
        float(found_region.area),
        float(true_region.intersection(found_region).area),
        float(frame.area),
    )


def _inside(polygons: Sequence[Array], frame: Any) -> NDArray[Any]:
    """Shapely's polygons, cut at a frame."""
    shapes = shapely.make_valid(np.array([shapely.Polygon(polygon) for polygon in polygons], object))
    cut = shapely.intersection(shapes, frame)
    return np.asarray(cut[shapely.area(cut) > 0.0])
