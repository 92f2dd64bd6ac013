"""Which lines of several photos are the same line: on one facade, photos agree but for their poses' errors.

Every photo is first shifted as a whole onto those before it, by no more than its pose may be wrong; a regular grid
looks the same one panel further, and the nearest match is taken. Lines then belong together where they are close.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.rectify.surface import FacadeSurface
from reconstruction.panels.search.record import FacadeGrid, GridLine
from reconstruction.panels.solving.record import Axis, ObservedLine

Array = NDArray[np.float64]


# Lines of the grids found in photos, as observations on the facade's surface.

POINTS = 3
"""Along each line: its ends and its middle, enough for any pose and a cylinder; they share one line's information."""


def observed_lines(
    photo: PosedPhoto, number: int, grid: FacadeGrid, surface: FacadeSurface
) -> tuple[ObservedLine, ...]:
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
) -> ObservedLine | None:
    across, along = (0, 1) if axis == "column" else (1, 0)
    step = np.zeros(2)
    step[across] = 1.0
    pixels = grid.rectification.to_photo(points)
    here = surface.hits(*photo.rays(pixels))
    beside = surface.hits(*photo.rays(grid.rectification.to_photo(points + step)))
    m_per_px = float(np.abs(beside - here)[:, across].mean())
    if not (np.isfinite(here).all() and np.isfinite(m_per_px)):
        return None
    return ObservedLine(
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


def coordinates(photo: PosedPhoto, surface: FacadeSurface, lines: Sequence[ObservedLine]) -> Array:
    """Coordinate across each line, of each of its points, as the photo's pose and the surface put it, shape (n, k)."""
    if not lines:
        return np.zeros((0, POINTS))
    pixels = np.concatenate([line.points_px for line in lines])
    st = surface.hits(*photo.rays(pixels)).reshape(len(lines), -1, 2)
    is_column = np.array([line.axis == "column" for line in lines])
    return np.where(is_column[:, None], st[..., 0], st[..., 1])


TOGETHER = 0.3
"""Of the narrowest panel: lines closer than this are one."""

MISSED = 0.2
"""Chance that a photo does not find a line that is there. With it a line of average confidence (0.9) that one photo of
three shows is dropped, and one that two of three show is kept."""

FALSE_LINE = 0.02
"""Chance that a photo shows a false line at a given place."""


@dataclass(frozen=True, slots=True, eq=False)
class LineGroup:
    """Lines of several photos that are one line on the facade.

    `confidence` is the probability that there is one, given which of the photos that cover its place show it.
    """

    axis: Axis
    members: tuple[ObservedLine, ...]
    confidence: float


def associate(lines: Sequence[ObservedLine], reach_m: float) -> tuple[LineGroup, ...]:
    """Groups of lines with a confidence of one half at least, columns from left to right, then rows upwards.

    Parameters
    ----------
    reach_m
        How far a photo may be shifted on the surface, from the errors of the poses.
    """
    groups: list[LineGroup] = []
    for axis in ("column", "row"):
        of_axis = [line for line in lines if line.axis == axis]
        if of_axis:
            groups += _of_axis(of_axis, reach_m)
    return tuple(groups)


def _of_axis(lines: list[ObservedLine], reach_m: float) -> list[LineGroup]:
    photos = sorted({line.photo for line in lines}, key=lambda photo: -_weight(lines, photo))
    tolerance = TOGETHER * _narrowest(lines)
    placed: list[tuple[float, ObservedLine]] = []
    spans: list[tuple[float, float]] = []
    for photo in photos:
        own = sorted((line for line in lines if line.photo == photo), key=lambda line: line.position_m)
        positions = np.array([line.position_m for line in own])
        known = np.array([position for position, _ in placed])
        scale, shift = _alignment(positions, known, reach_m, tolerance)
        placed += [(scale * line.position_m + shift, line) for line in own]
        spans.append((scale * float(positions[0]) + shift, scale * float(positions[-1]) + shift))
    groups = (_group(cluster, spans, tolerance) for cluster in _clusters(placed, tolerance))
    return [group for group in groups if group.confidence >= 0.5]


def _weight(lines: list[ObservedLine], photo: int) -> float:
    return sum(line.confidence for line in lines if line.photo == photo)


def _narrowest(lines: list[ObservedLine]) -> float:
    """Usual narrowest distance of neighbouring lines within one photo."""
    gaps: list[float] = []
    for photo in {line.photo for line in lines}:
        positions = np.sort([line.position_m for line in lines if line.photo == photo])
        gaps += np.diff(positions).tolist()
    return float(np.percentile(gaps, 5.0)) if gaps else 1.0


def _alignment(positions: Array, known: Array, reach_m: float, tolerance: float) -> tuple[float, float]:
    """Scale and shift that bring most positions onto known ones.

    Shifts are tried one by one, of equally good ones the smallest wins; the scale, which a wrong distance to the facade
    changes, is then fitted to the pairs, within what the reach allows over the photo's width.
    """
    if not len(known):
        return 1.0, 0.0
    offsets = (known[:, None] - positions[None, :]).ravel()
    offsets = np.append(offsets[np.abs(offsets) <= reach_m], 0.0)
    best, least = 0.0, np.inf
    for offset in offsets[np.argsort(np.abs(offsets), kind="stable")]:
        distance = np.abs(positions[:, None] + offset - known[None, :]).min(axis=1)
        cost = float(np.minimum(distance / tolerance, 1.0).sum())
        if cost < least - 0.5:
            best, least = float(offset), cost
    scale, shift = 1.0, best
    width = max(float(np.ptp(positions)), tolerance)
    for _ in range(3):
        distance = np.abs(scale * positions[:, None] + shift - known[None, :])
        near, target = distance.min(axis=1) <= tolerance, known[distance.argmin(axis=1)]
        if near.sum() < 2:
            break
        middle = float(positions[near].mean())
        spread = float(((positions[near] - middle) ** 2).sum())
        slope = float(((positions[near] - middle) * (target[near] - target[near].mean())).sum()) / max(spread, 1e-12)
        scale = min(1.0 + reach_m / width, max(1.0 - reach_m / width, slope))
        shift = float(target[near].mean()) - scale * middle
    return scale, shift


def _clusters(placed: list[tuple[float, ObservedLine]], tolerance: float) -> list[list[tuple[float, ObservedLine]]]:
    """Neighbours no further apart than the tolerance, one line of each photo in each cluster."""
    clusters: list[list[tuple[float, ObservedLine]]] = []
    for position, line in sorted(placed, key=lambda item: item[0]):
        last = clusters[-1] if clusters else None
        middle = np.median([other for other, _ in last]) if last else 0.0
        if last is None or position - middle > tolerance or any(line.photo == other.photo for _, other in last):
            clusters.append([(position, line)])
        else:
            last.append((position, line))
    return clusters


def _confidence(cluster: list[tuple[float, ObservedLine]], spans: list[tuple[float, float]], tolerance: float) -> float:
    """Posterior of independent photos (log odds).

    Those that show the line speak for it, those that cover its place and do not show it against it.
    """
    middle = float(np.median([position for position, _ in cluster]))
    covering = sum(low - tolerance <= middle <= high + tolerance for low, high in spans)
    odds = sum(np.log(_inside(line.confidence) / (1.0 - _inside(line.confidence))) for _, line in cluster)
    odds += max(0, covering - len(cluster)) * np.log(MISSED / (1.0 - FALSE_LINE))
    return float(1.0 / (1.0 + np.exp(-odds)))


def _inside(confidence: float) -> float:
    return min(0.99, max(0.01, confidence))


def _group(cluster: list[tuple[float, ObservedLine]], spans: list[tuple[float, float]], tolerance: float) -> LineGroup:
    members = tuple(line for _, line in cluster)
    return LineGroup(members[0].axis, members, _confidence(cluster, spans, tolerance))
