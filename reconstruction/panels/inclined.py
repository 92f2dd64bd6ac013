"""Inclined profiles of a facade on its surface, from the photos that show them.

The grid's lines have been adjusted by then, and the poses with them: an inclined line is where the adjusted poses put
it, on the average of its photos. On a cylinder it is straight in the arc's length and the height, as it is built.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from reconstruction.cameras import PosedPhoto
from reconstruction.panels.adjustment import LEAST_SIGMA_M, Adjusted
from reconstruction.panels.association import FALSE_LINE, MISSED
from reconstruction.panels.record import SurfaceInclined
from reconstruction.segmentation.cutting import Cut
from reconstruction.segmentation.record import FacadeGrid, InclinedLine

Array = NDArray[np.float64]

TOGETHER = 0.3
"""Of the narrowest panel: lines of two photos whose ends are closer than this to one another are one."""

MOST_SURE = 0.99


@dataclass(frozen=True, slots=True, eq=False)
class _Seen:
    """One photo's line: ends from left to right (upright ones upwards), shape (2, 2)."""

    photo: int
    ends_st_m: Array
    width_m: float
    sigma_m: float
    confidence: float
    open_side: int


def surface_inclined(
    photos: Sequence[PosedPhoto], grids: Mapping[int, FacadeGrid], adjusted: Adjusted, narrowest_m: float
) -> tuple[SurfaceInclined, ...]:
    """Inclined profiles with a confidence of one half at least.

    Parameters
    ----------
    grids
        By the number of their photo.
    narrowest_m
        Narrowest panel of the grid.
    """
    seen: list[_Seen] = []
    for number, grid in grids.items():
        photo = replace(photos[number], pose=adjusted.poses.get(number, photos[number].pose))
        seen += [one for line in grid.inclined if (one := _seen(photo, number, grid, adjusted, line)) is not None]
    groups: list[list[_Seen]] = []
    for one in sorted(seen, key=lambda line: -line.confidence):
        for group in groups:
            if all(one.photo != other.photo for other in group) and _is_same(one, group[0], TOGETHER * narrowest_m):
                group.append(one)
                break
        else:
            groups.append([one])
    cast = {number: _covered(photos[number], grid, adjusted, number) for number, grid in grids.items()}
    found = (_joined(group, cast) for group in groups)
    return tuple(line for line in found if line.confidence >= 0.5)


def _seen(photo: PosedPhoto, number: int, grid: FacadeGrid, adjusted: Adjusted, line: InclinedLine) -> _Seen | None:
    ends = np.array([line.first_px, line.last_px])
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    across = np.array([-along[1], along[0]])
    middle = ends.mean(axis=0)
    points = np.array([ends[0], ends[1], middle - 0.5 * across, middle + 0.5 * across])
    st = adjusted.surface.hits(*photo.rays(grid.rectification.to_photo(points)))
    if not np.isfinite(st).all():
        return None
    m_per_px = float(np.linalg.norm(st[3] - st[2]))
    # t rises where y falls, so what is to the right of a walk along the line changes sides.
    first, last, side = st[0], st[1], -line.open_side
    if (last - first) @ (1.0, 1e-3) < 0.0:
        first, last, side = last, first, -side
    sigma = max(line.sigma_px * m_per_px, LEAST_SIGMA_M)
    return _Seen(number, np.array([first, last]), line.width_px * m_per_px, sigma, line.confidence, side)


def _is_same(one: _Seen, other: _Seen, tolerance_m: float) -> bool:
    """Whether each line's ends lie on the other's course, and their stretches have a part in common."""
    cut = Cut(other.ends_st_m[0], other.ends_st_m[1], 0.0)
    if np.abs(cut.signed(one.ends_st_m)).max() > tolerance_m:
        return False
    along = other.ends_st_m[1] - other.ends_st_m[0]
    places = (one.ends_st_m - other.ends_st_m[0]) @ along / (along @ along)
    return bool(places.max() > 0.0 and places.min() < 1.0)


def _covered(photo: PosedPhoto, grid: FacadeGrid, adjusted: Adjusted, number: int) -> Array:
    """Lowest and highest s and t of a photo's grid, shape (2, 2); NaN where it has none."""
    if len(grid.rows) < 2 or len(grid.columns) < 2:
        return np.full((2, 2), np.nan)
    x = [grid.columns[i].position_px for i in (0, -1)]
    y = [grid.rows[i].position_px for i in (0, -1)]
    posed = replace(photo, pose=adjusted.poses.get(number, photo.pose))
    corners = grid.rectification.to_photo(np.array([(a, b) for a in x for b in y]))
    st = adjusted.surface.hits(*posed.rays(corners))
    return np.array([st.min(axis=0), st.max(axis=0)])


def _joined(group: Sequence[_Seen], covered: Mapping[int, Array]) -> SurfaceInclined:
    """The mean line of several photos, from its outermost end to the other."""
    base = group[0].ends_st_m
    along = (base[1] - base[0]) / np.linalg.norm(base[1] - base[0])
    across = np.array([-along[1], along[0]])
    places = np.array([(one.ends_st_m - base[0]) @ along for one in group])
    low, high = float(places.min()), float(places.max())
    weights = np.array([one.sigma_m**-2 for one in group])
    offsets = np.array([_offsets_at(one, base[0], along, across, (low, high)) for one in group])
    mean = weights @ offsets / weights.sum()
    first, last = (base[0] + u * along + off * across for u, off in zip((low, high), mean, strict=True))
    middle = 0.5 * (first + last)
    covering = sum(bool((box[0] <= middle).all() and (middle <= box[1]).all()) for box in covered.values())
    sure = np.clip([one.confidence for one in group], 1.0 - MOST_SURE, MOST_SURE)
    odds = float(np.log(sure / (1.0 - sure)).sum())
    odds += max(0, covering - len(group)) * float(np.log(MISSED / (1.0 - FALSE_LINE)))
    return SurfaceInclined(
        (float(first[0]), float(first[1])),
        (float(last[0]), float(last[1])),
        float(np.median([one.width_m for one in group])),
        float(max(LEAST_SIGMA_M, weights.sum() ** -0.5)),
        float(1.0 / (1.0 + np.exp(-odds))),
        int(np.sign(sum(one.open_side for one in group))),
        len(group),
    )


def _offsets_at(one: _Seen, origin: Array, along: Array, across: Array, places: tuple[float, float]) -> Array:
    """Offsets of a photo's line from the base line at two places along it, shape (2,)."""
    u, off = (one.ends_st_m - origin) @ along, (one.ends_st_m - origin) @ across
    slope = (off[1] - off[0]) / (u[1] - u[0])
    return np.array([off[0] + slope * (place - u[0]) for place in places])
