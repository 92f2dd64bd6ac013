"""Surfels to start from: even grids on panels, even samples of what rays hit, and loose points, in ENU metres."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from reconstruction.dataset.layers import unit_normals

Array = NDArray[np.float64]

NEIGHBOURS = 3
"""Whose mean distance is a surfel's spacing, as in 3-D Gaussian splatting (Kerbl et al., 2023)."""

PLANE_NEIGHBOURS = 12
"""That a loose point's normal is told from."""

NARROWEST = 0.1
"""Of its spacing: a frame's surfel is not narrower, or it would be a needle."""

LEVELS = 4
"""Grids for each doubling of the spacing."""

TOO_NEAR = 0.6
"""Of its spacing: a sample nearer to a finer one than this is dropped."""


@dataclass(frozen=True, slots=True, eq=False)
class Surfels:
    """n pieces of surface.

    Parameters
    ----------
    points_enu_m, normals_enu, tangents_enu
        Shape (n, 3); normals and tangents unit and at right angles.
    spacings_m
        Distance to the next ones along the tangent and across it, shape (n, 2).
    panels
        Which panel, from 0, or -1, shape (n,).
    """

    points_enu_m: Array
    normals_enu: Array
    tangents_enu: Array
    spacings_m: Array
    panels: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.points_enu_m)


def joined(parts: Sequence[Surfels]) -> Surfels:
    """All surfels of several."""
    return Surfels(
        np.concatenate([part.points_enu_m for part in parts]),
        np.concatenate([part.normals_enu for part in parts]),
        np.concatenate([part.tangents_enu for part in parts]),
        np.concatenate([part.spacings_m for part in parts]),
        np.concatenate([part.panels for part in parts]),
    )


def surfels_between(points_enu_m: Array, normals_enu: Array, spacings_m: Array, gaps_m: Array, edges: Array) -> Surfels:
    """Of no panel; beside glass they lie along its edge and are so narrow that they end there.

    Parameters
    ----------
    gaps_m, edges
        Of `beside_panels`.
    """
    helper = np.zeros_like(normals_enu)
    helper[np.arange(len(helper)), np.abs(normals_enu).argmin(axis=1)] = 1.0
    along = edges - (edges * normals_enu).sum(axis=1, keepdims=True) * normals_enu
    # Of a frame's side, the edge may be the normal; away from glass there is no edge.
    is_along = (np.linalg.norm(along, axis=1) > 0.5) & (gaps_m < spacings_m)
    tangents = np.where(is_along[:, None], along, np.cross(normals_enu, helper))
    tangents /= np.maximum(np.linalg.norm(tangents, axis=1, keepdims=True), 1e-12)
    across = np.where(is_along, np.clip(2.0 * gaps_m, NARROWEST * spacings_m, spacings_m), spacings_m)
    none = np.full(len(points_enu_m), -1, np.int32)
    return Surfels(points_enu_m, normals_enu, tangents, np.column_stack([spacings_m, across]), none)


def n_on_panel(corners_enu_m: Array, spacings_m: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Columns and rows of the grids on panels, each shape (m,), at least 1."""
    width, height = _sides(corners_enu_m)
    return tuple(np.maximum(1, np.rint(side / spacings_m)).astype(np.int64) for side in (width, height))  # type: ignore[return-value]


def panel_surfels(corners_enu_m: Array, spacings_m: Array) -> Surfels:
    """Even grids in the panels' planes, tangents along their lower edges.

    Parameters
    ----------
    corners_enu_m
        Shape (m, 4, 3), counter-clockwise from outside, the lower left one first.
    spacings_m
        Wanted on each panel, shape (m,).
    """
    if not len(corners_enu_m):
        blank = np.zeros((0, 3))
        return Surfels(blank, blank, blank, np.zeros((0, 2)), np.zeros(0, np.int32))
    columns, rows = n_on_panel(corners_enu_m, spacings_m)
    width, height = _sides(corners_enu_m)
    panels = np.repeat(np.arange(len(corners_enu_m)), columns * rows)
    within = np.arange(len(panels)) - np.repeat(np.cumsum(columns * rows) - columns * rows, columns * rows)
    a = ((within % columns[panels] + 0.5) / columns[panels])[:, None]
    b = ((within // columns[panels] + 0.5) / rows[panels])[:, None]
    first, second, third, fourth = np.moveaxis(corners_enu_m[panels], 1, 0)
    points = (1 - b) * ((1 - a) * first + a * second) + b * ((1 - a) * fourth + a * third)
    normals = unit_normals(corners_enu_m)
    edges = corners_enu_m[:, 1] - corners_enu_m[:, 0] + corners_enu_m[:, 2] - corners_enu_m[:, 3]
    edges -= (edges * normals).sum(axis=1, keepdims=True) * normals
    edges /= np.maximum(np.linalg.norm(edges, axis=1, keepdims=True), 1e-12)
    spacings = np.column_stack([width / columns, height / rows])
    return Surfels(points, normals[panels], edges[panels], spacings[panels], panels.astype(np.int32))


def _sides(corners_enu_m: Array) -> tuple[Array, Array]:
    """Mean width and height of panels, each shape (m,)."""
    sides = np.linalg.norm(np.roll(corners_enu_m, -1, axis=1) - corners_enu_m, axis=2)
    return 0.5 * (sides[:, 0] + sides[:, 2]), 0.5 * (sides[:, 1] + sides[:, 3])


@dataclass(frozen=True, slots=True, eq=False)
class Beside:
    """Where points lie as the panels see it.

    Parameters
    ----------
    panels
        Panel that a point is in front of or behind, shape (n,); -1 for none.
    gaps_m
        Distance to the next panel's outline, shape (n,); inf beyond the reach that was asked for.
    edges_enu
        Unit direction of that piece of outline, shape (n, 3).
    """

    panels: NDArray[np.int32]
    gaps_m: Array
    edges_enu: Array


def beside_panels(points_enu_m: Array, corners_enu_m: Array, within_m: float, reach_m: float) -> Beside:
    """Which points are a panel's, and how far the others are from glass.

    Parameters
    ----------
    within_m
        Off a panel's plane a point still is the panel's.
    reach_m
        To which gaps are told.
    """
    n = len(points_enu_m)
    found = Beside(np.full(n, -1, np.int32), np.full(n, np.inf), np.zeros((n, 3)))
    if not n or not len(corners_enu_m):
        return found
    tree = cKDTree(points_enu_m)
    middles = corners_enu_m.mean(axis=1)
    reaches = np.linalg.norm(corners_enu_m - middles[:, None], axis=2).max(axis=1) + max(within_m, reach_m)
    normals = unit_normals(corners_enu_m)
    for number, (corners, normal) in enumerate(zip(corners_enu_m, normals, strict=True)):
        near = np.array(tree.query_ball_point(middles[number], reaches[number]), np.int64)
        if not len(near):
            continue
        points = points_enu_m[near]
        inside = np.abs((points - corners[0]) @ normal) <= within_m
        for first, second in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            edge = second - first
            inside &= (points - first) @ np.cross(normal, edge) >= 0.0
            share = np.clip((points - first) @ edge / max(edge @ edge, 1e-20), 0.0, 1.0)
            gaps = np.linalg.norm(points - first - share[:, None] * edge, axis=1)
            nearer = near[gaps < np.minimum(found.gaps_m[near], reach_m)]
            found.gaps_m[nearer] = gaps[gaps < np.minimum(found.gaps_m[near], reach_m)]
            found.edges_enu[nearer] = edge / max(float(np.linalg.norm(edge)), 1e-12)
        found.panels[near[inside]] = number
    return found


def thinned(points_enu_m: Array, spacings_m: Array, gaps_m: Array) -> NDArray[np.int64]:
    """Which of the points to keep so that they are about as far apart as told, finer ones first.

    First one point of each cell of a grid about as fine as told is kept: the one furthest from glass where that is near
    (the middle of a frame), else the one nearest to the cell's middle. Then those go that are too near to a finer one
    in the next cell.

    Parameters
    ----------
    gaps_m
        To the next panel, shape (n,).
    """
    if not len(points_enu_m):
        return np.zeros(0, np.int64)
    # Counted from the finest, so that cells grow as spacings do, and not by leaps.
    finest_m = spacings_m.min()
    levels = np.floor(LEVELS * np.log2(spacings_m / finest_m)).astype(np.int64)
    sides = (finest_m * np.exp2(levels / LEVELS))[:, None]
    cells = np.floor(points_enu_m / sides)
    off = np.abs(points_enu_m / sides - cells - 0.5).max(axis=1)
    off -= 2.0 * np.minimum(gaps_m / spacings_m, 1.0)
    keys = np.column_stack([levels, cells.astype(np.int64)])
    order = np.lexsort([off, *keys.T])
    is_first = np.ones(len(order), bool)
    is_first[1:] = (keys[order[1:]] != keys[order[:-1]]).any(axis=1)
    kept = order[is_first]
    rank = np.empty(len(kept), np.int64)
    rank[np.argsort(spacings_m[kept], kind="stable")] = np.arange(len(kept))
    # Asked for a list of neighbours, the tree gives columns for one point, too.
    order_of_near = np.arange(1, min(8, len(kept)) + 1)
    distances, near = (
        np.asarray(part) for part in cKDTree(points_enu_m[kept]).query(points_enu_m[kept], order_of_near)
    )
    crowded = (distances < TOO_NEAR * spacings_m[kept, None]) & (rank[near] < rank[:, None])
    return np.sort(kept[~crowded.any(axis=1)])


def spacings_of(points_enu_m: Array, least_m: Array, most_m: Array) -> Array:
    """Mean distance to the next `NEIGHBOURS` points, kept between two bounds, shape (n,)."""
    if len(points_enu_m) <= NEIGHBOURS:
        return most_m.copy()
    distances = np.asarray(cKDTree(points_enu_m).query(points_enu_m, NEIGHBOURS + 1)[0])
    return np.asarray(np.clip(distances[:, 1:].mean(axis=1), least_m, most_m))


def plane_normals(points_enu_m: Array, cloud_enu_m: Array) -> Array:
    """Unit normals of the planes that a cloud has around points, shape (n, 3); upwards where it has none."""
    n_near = min(PLANE_NEIGHBOURS, len(cloud_enu_m))
    normals = np.tile([0.0, 0.0, 1.0], (len(points_enu_m), 1))
    if n_near < 3 or not len(points_enu_m):
        return normals
    _, near = cKDTree(cloud_enu_m).query(points_enu_m, n_near)
    around = cloud_enu_m[near]
    around = around - around.mean(axis=1, keepdims=True)
    values, vectors = np.linalg.eigh(np.einsum("nki,nkj->nij", around, around))
    # On a line, or with all points in one place, any direction across is as good.
    known = values[:, 1] > 1e-12
    normals[known] = vectors[known, :, 0]
    return normals
