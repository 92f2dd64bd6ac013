"""Ground, walls and roofs in sparse points.

Walls are upright planes, found in the plan as lines that most thinned points lie near; directions that nearly agree
with the building's main axes are made to.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.coarse.cloud import Cloud, FoundPlane, find_planes, thinned

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class BuildingParameters:
    """Sizes, metres.

    Parameters
    ----------
    cell_m
        Of the thinned cloud and the maps; smaller for small scenes.
    tolerance_m
        Distance from a plane up to which a point is on it, at least.
    relief_m
        Depth of reveals, sills and cornices: planes so near to each other are one wall.
    gap_m
        Along a wall, between points of one wall: panes and gates.
    least_wall_m
        Length and height of the smallest wall.
    depth_m
        Of a building of which one side was seen.
    """

    cell_m: float = 0.3
    tolerance_m: float = 0.08
    relief_m: float = 0.5
    gap_m: float = 5.0
    least_wall_m: float = 2.0
    depth_m: float = 8.0
    n_walls: int = 30
    n_roofs: int = 12
    seed: int = 0


@dataclass(frozen=True, slots=True)
class Ground:
    """Level of the ground at the building, and how steep it is.

    Parameters
    ----------
    is_seen
        Whether points lie on it; else it is where the lowest points are.
    """

    z_m: float
    slope_deg: float
    gradient: tuple[float, float]
    area_m2: float
    is_seen: bool


@dataclass(frozen=True, slots=True, eq=False)
class Wall:
    """An upright rectangle that points lie on.

    Parameters
    ----------
    normal
        Outwards, level, shape (2,); points p of the wall have normal . p[:2] = offset_m.
    ends_m
        Along the wall's axis, which is the normal turned left by a right angle.
    bottom_m, top_m
        Heights between which points lie.
    rms_m
        Of the points' distances.
    seen_share
        Of the rectangle, by cells with a point.
    """

    normal: Array
    offset_m: float
    ends_m: tuple[float, float]
    bottom_m: float
    top_m: float
    rms_m: float
    seen_share: float
    n_points: int

    @property
    def along(self) -> Array:
        """Unit vector, shape (2,)."""
        return np.array([-self.normal[1], self.normal[0]])

    @property
    def line(self) -> Array:
        """Ends in the plan, shape (2, 2)."""
        return self.normal * self.offset_m + np.outer(self.ends_m, self.along)

    @property
    def length_m(self) -> float:
        """Of the wall."""
        return self.ends_m[1] - self.ends_m[0]


# The ground.

LEVEL_SHARE = 0.2
"""Of the best level's cells that another level needs to be the ground below it."""

STEEPEST = math.tan(math.radians(10.0))


def find_ground(points: Array, cell: float) -> Ground:
    """The lowest wide level of a cloud; its plane by least squares among what lies near that.

    Parameters
    ----------
    points
        Shape (n, 3), z up, at least one.
    cell
        Of the map; the unit of everything.
    """
    wide = 3.0 * cell
    keys = np.floor((points[:, :2] - points[:, :2].min(axis=0)) / wide).astype(np.int64)
    order = np.lexsort((points[:, 2], keys[:, 1], keys[:, 0]))
    keys, sorted_points = keys[order], points[order]
    first = np.ones(len(keys), bool)
    first[1:] = (keys[1:] != keys[:-1]).any(axis=1)
    lowest = sorted_points[first]
    heights = np.sort(lowest[:, 2])
    levels = np.arange(heights[0], heights[-1] + wide, 0.5 * cell)
    counts = np.searchsorted(heights, levels + cell) - np.searchsorted(heights, levels - cell)
    below = np.searchsorted(heights, levels - 2.0 * cell) / len(heights)
    fitting = (counts >= LEVEL_SHARE * counts.max()) & (below >= 0.0)
    # The lowest of the wide levels, at its own best height.
    low = int(np.argmax(fitting))
    while low + 1 < len(levels) and counts[low + 1] >= counts[low]:
        low += 1
    z, slope = float(levels[low]), np.zeros(2)
    middle = np.median(lowest[:, :2], axis=0)
    for reach in (6.0, 3.0, 1.5):
        predicted = z + (lowest[:, :2] - middle) @ slope
        near = np.abs(lowest[:, 2] - predicted) <= reach * cell
        if near.sum() < 8:
            break
        system = np.column_stack([np.ones(near.sum()), lowest[near, :2] - middle])
        spread = np.sqrt(np.linalg.eigvalsh(np.cov(lowest[near, :2].T))[0])
        if spread < 3.0 * cell:
            z = float(np.median(lowest[near, 2]))
            continue
        found = np.linalg.lstsq(system, lowest[near, 2], rcond=None)[0]
        if float(np.linalg.norm(found[1:])) > STEEPEST:
            # A flight of steps, or a wall's foot: no ground.
            z, slope = float(np.median(lowest[near, 2])), np.zeros(2)
            break
        z, slope = float(found[0]), np.asarray(found[1:], np.float64)
    on = np.abs(lowest[:, 2] - z - (lowest[:, :2] - middle) @ slope) <= cell
    spread = float(np.sqrt(np.linalg.eigvalsh(np.cov(lowest[on, :2].T))[0])) if on.sum() > 2 else 0.0
    slope_deg = math.degrees(math.atan(float(np.linalg.norm(slope))))
    area = float(on.sum()) * wide**2
    gradient = (float(slope[0]), float(slope[1]))
    return Ground(z, slope_deg, gradient, area, bool(spread >= 3.0 * cell and on.sum() >= 20))


# Walls.

_Line = tuple[Array, float, NDArray[np.int64]]
"""Normal and offset of a line in the plan, and the rows of the points on it."""

N_SAMPLES = 600
MANHATTAN_DEG = 3.0
"""Walls whose directions are this near the main axes are made to have them."""

NEIGHBOURS = 60
LEVEL_NEIGHBOURS = 12

LEAST_SHARE = 0.08
"""Of a wall that has to be seen: frames of panes are a tenth of a facade, and mirror images line up by chance."""


def find_walls(cloud: Cloud, ground: Ground, parameters: BuildingParameters, monitor: Monitor = QUIET) -> list[Wall]:
    """Upright planes in what stands on the ground, those with most area first."""
    cell = parameters.cell_m
    standing = cloud.of(_height(cloud.points, ground) > 0.3)
    rows = thinned(standing.points, cell)
    points, towards = standing.points[rows], standing.towards[rows]
    sigmas = standing.sigmas[rows]
    if len(points) < 12:
        return []
    tolerance = float(np.clip(3.0 * np.median(sigmas), parameters.tolerance_m, 3.0 * parameters.tolerance_m))
    rng = np.random.default_rng(parameters.seed)
    left = np.flatnonzero(~_is_level(points))
    lines: list[_Line] = []
    misses = 0
    while len(lines) < parameters.n_walls and len(left) >= 12 and misses < 3:
        monitor.report(say("finding walls"), len(lines), parameters.n_walls)
        found = _best_line(points[left], tolerance, rng)
        if found is None:
            break
        normal, offset = found
        on = np.abs(points[left, :2] @ normal - offset) <= tolerance
        parts = _parts(points[left[on]], normal, parameters)
        if not parts:
            misses += 1
            left = np.setdiff1d(left, left[on][: max(1, on.sum() // 2)])
            continue
        for part in parts:
            own = left[on][part]
            turned, at = _upright_fit(points[own], tolerance)
            if float((towards[own, :2] @ turned).sum()) < 0.0:
                turned, at = -turned, -at
            lines.append((turned, at, own))
        left = np.setdiff1d(left, np.concatenate([left[on][part] for part in parts]))
    lines = _joined(_snapped(lines, points, tolerance), points, parameters)
    walls = [
        wall for normal, offset, rows in lines if (wall := _wall(normal, offset, points[rows], parameters)) is not None
    ]
    return sorted(walls, key=lambda wall: -wall.length_m * (wall.top_m - wall.bottom_m))


def _is_level(points: Array) -> NDArray[np.bool_]:
    """Which points lie on a floor or a roof, by the planes of their neighbours: a wall could cut across those."""
    from scipy.spatial import cKDTree

    k = min(LEVEL_NEIGHBOURS, len(points))
    near = points[np.asarray(cKDTree(points).query(points, k)[1]).reshape(len(points), k)]
    off = near - near.mean(axis=1, keepdims=True)
    values, axes = np.linalg.eigh(np.einsum("nki,nkj->nij", off, off))
    is_plane = values[:, 0] < 0.1 * values[:, 1]
    return np.asarray(is_plane & (np.abs(axes[:, 2, 0]) > 0.7))


def _height(points: Array, ground: Ground) -> Array:
    """Above the level of the ground, shape (n,)."""
    return np.asarray(points[:, 2] - ground.z_m)


def _best_line(points: Array, tolerance: float, rng: np.random.Generator) -> tuple[Array, float] | None:
    """The line in the plan that most points lie near; samples are of neighbours that are apart in the plan."""
    from scipy.spatial import cKDTree

    k = min(NEIGHBOURS, len(points))
    firsts = rng.integers(0, len(points), N_SAMPLES)
    near = np.asarray(cKDTree(points).query(points[firsts], k)[1]).reshape(N_SAMPLES, k)
    seconds = near[np.arange(N_SAMPLES), rng.integers(k // 3, k, N_SAMPLES)]
    along = points[seconds, :2] - points[firsts, :2]
    lengths = np.linalg.norm(along, axis=1)
    good = lengths > 4.0 * tolerance
    if not good.any():
        return None
    along = along[good] / lengths[good, None]
    normals = np.column_stack([along[:, 1], -along[:, 0]])
    offsets = (normals * points[firsts[good], :2]).sum(axis=1)
    counts = [int((np.abs(points[:, :2] @ n - d) <= tolerance).sum()) for n, d in zip(normals, offsets, strict=True)]
    best = int(np.argmax(counts))
    return normals[best], float(offsets[best])


def _parts(points: Array, normal: Array, parameters: BuildingParameters) -> list[NDArray[np.int64]]:
    """Rows of the points of each wall on a line: cut where nothing is seen for longer than a gap."""
    along = points[:, :2] @ np.array([-normal[1], normal[0]])
    order = np.argsort(along, kind="stable")
    cuts = np.flatnonzero(np.diff(along[order]) > parameters.gap_m) + 1
    parts = []
    for rows in np.split(order, cuts):
        length = np.ptp(along[rows])
        low, high = np.percentile(points[rows, 2], (2.0, 98.0))
        if length >= parameters.least_wall_m and high - low >= parameters.least_wall_m and len(rows) >= 12:
            parts.append(np.asarray(rows, np.int64))
    return parts


def _upright_fit(points: Array, tolerance: float) -> tuple[Array, float]:
    """Normal and offset of the line in the plan, by least squares that outliers hardly pull."""
    weights = np.ones(len(points))
    normal, offset = np.array([1.0, 0.0]), 0.0
    for _ in range(5):
        middle = np.average(points[:, :2], axis=0, weights=weights)
        off = points[:, :2] - middle
        _, axes = np.linalg.eigh((weights[:, None] * off).T @ off)
        normal, offset = axes[:, 0], float(axes[:, 0] @ middle)
        weights = 1.0 / (1.0 + ((points[:, :2] @ normal - offset) / (0.3 * tolerance)) ** 2)
    return normal, offset


def _snapped(lines: Sequence[_Line], points: Array, tolerance: float) -> list[_Line]:
    """Lines whose directions nearly agree with the main axes have exactly these."""
    if not lines:
        return []
    weights = np.array([len(rows) for _, _, rows in lines], float)
    angles = np.array([math.atan2(normal[1], normal[0]) for normal, _, _ in lines])
    main = float(np.angle(np.sum(weights * np.exp(4j * angles)))) / 4.0
    for _ in range(3):
        off = _off_axes(angles, main)
        near = np.abs(off) <= math.radians(2.0 * MANHATTAN_DEG)
        if near.any():
            main += float(np.average(off[near], weights=weights[near]))
    snapped = []
    for (normal, offset, rows), angle, off in zip(lines, angles, _off_axes(angles, main), strict=True):
        if abs(off) > math.radians(MANHATTAN_DEG):
            snapped.append((normal, offset, rows))
            continue
        turned = np.array([math.cos(angle - off), math.sin(angle - off)])
        distances = points[rows, :2] @ turned
        at = float(np.median(distances))
        on = np.abs(distances - at) <= tolerance
        if on.sum() < 0.8 * len(rows):
            snapped.append((normal, offset, rows))
        else:
            snapped.append((turned, float(distances[on].mean()), rows))
    return snapped


def _joined(lines: Sequence[_Line], points: Array, parameters: BuildingParameters) -> list[_Line]:
    """Lines with the smaller ones on the same wall taken into the larger: sills, cornices and reveals of one wall."""
    kept: list[_Line] = []
    for normal, offset, rows in sorted(lines, key=lambda line: -len(line[2])):
        along = np.array([-normal[1], normal[0]])
        own = np.sort(points[rows, :2] @ along)[[0, -1]]
        for place, (other, at, others) in enumerate(kept):
            middle = points[rows, :2].mean(axis=0)
            reach = np.sort(points[others, :2] @ along)[[0, -1]]
            near = own[0] < reach[1] + parameters.gap_m and own[1] > reach[0] - parameters.gap_m
            is_along = float(normal @ other) > math.cos(math.radians(MANHATTAN_DEG))
            if near and is_along and abs(float(middle @ other) - at) < parameters.relief_m:
                kept[place] = (other, at, np.concatenate([others, rows]))
                break
        else:
            kept.append((normal, offset, rows))
    return kept


def _off_axes(angles: Array, main: float) -> Array:
    """By how much directions are off the nearest of four axes, radians."""
    quarter = math.pi / 2.0
    return np.asarray((angles - main + quarter / 2.0) % quarter - quarter / 2.0)


def _wall(normal: Array, offset: float, points: Array, parameters: BuildingParameters) -> Wall | None:
    along = points[:, :2] @ np.array([-normal[1], normal[0]])
    start, stop = np.percentile(along, (0.5, 99.5))
    bottom, top = np.percentile(points[:, 2], (1.0, 99.0))
    if stop - start < parameters.least_wall_m or top - bottom < parameters.least_wall_m:
        return None
    cell = 3.0 * parameters.cell_m
    seen = {(int((u - start) // cell), int((z - bottom) // cell)) for u, z in zip(along, points[:, 2], strict=True)}
    n_all = math.ceil((stop - start) / cell) * math.ceil((top - bottom) / cell)
    rms = float(np.sqrt(np.mean((points[:, :2] @ normal - offset) ** 2)))
    share = min(1.0, len(seen) / max(1, n_all))
    if share < LEAST_SHARE:
        return None
    return Wall(normal, offset, (float(start), float(stop)), float(bottom), float(top), rms, share, len(points))


# Roofs.

LEAST_ROOF_M2 = 6.0


def find_roofs(
    cloud: Cloud, walls: Sequence[Wall], ground: Ground, parameters: BuildingParameters
) -> tuple[list[FoundPlane], Array]:
    """Planes above the ground that are no walls, and the thinned points, shape (m, 3), that they number."""
    cell = parameters.cell_m
    lowest = ground.z_m + 2.0
    high = cloud.of((cloud.points[:, 2] > lowest) & ~_on_walls(cloud.points, walls, 2.0 * parameters.tolerance_m))
    rows = thinned(high.points, cell)
    points, towards = high.points[rows], high.towards[rows]
    least = max(12, int(LEAST_ROOF_M2 / cell**2 * 0.15))
    planes = find_planes(points, towards, 1.5 * parameters.tolerance_m, parameters.n_roofs, least, parameters.seed)
    return [plane for plane in planes if abs(plane.normal[2]) > 0.35], points


def _on_walls(points: Array, walls: Sequence[Wall], tolerance: float) -> Mask:
    on = np.zeros(len(points), bool)
    for wall in walls:
        along = points[:, :2] @ wall.along
        near = np.abs(points[:, :2] @ wall.normal - wall.offset_m) <= tolerance
        on |= near & (along >= wall.ends_m[0]) & (along <= wall.ends_m[1]) & (points[:, 2] <= wall.top_m)
    return on
