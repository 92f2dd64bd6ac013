"""From the grids of one facade in several photos to its panels in 3-D."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from planning.errors import InfeasibleError
from reconstruction.cameras import PosedPhoto
from reconstruction.panels.adjustment import UNKNOWN_POSE, Adjusted, adjust
from reconstruction.panels.association import LineGroup, associate
from reconstruction.panels.observations import seen_lines
from reconstruction.panels.record import SolvedFacade, SolvedPanel, SurfaceLine
from reconstruction.rectify.fit import SurfaceFit, changed
from reconstruction.rectify.surface import FacadeSurface
from reconstruction.segmentation.record import FacadeGrid

Array = NDArray[np.float64]

REACH_SIGMAS = 3.0
"""How far a photo's grid may lie off, in standard deviations of its pose; two photos may lie off to opposite sides."""

STEP = 1e-5


def solve_facade(
    facade_id: str, photos: Sequence[PosedPhoto], grids: Mapping[int, FacadeGrid], fit: SurfaceFit
) -> SolvedFacade:
    """Panels of one facade.

    Parameters
    ----------
    grids
        By the number of their photo.
    fit
        The facade's surface: its plane or its cylinder, as the scene calls for.

    Raises
    ------
    InfeasibleError
        No photo shows a grid of at least one panel on this surface.
    """
    lines = [line for number, grid in grids.items() for line in seen_lines(photos[number], number, grid, fit.surface)]
    groups = associate(lines, 2.0 * max((_reach_m(photos[number], fit.surface) for number in grids), default=0.0))
    n_columns = sum(group.axis == "column" for group in groups)
    if min(n_columns, len(groups) - n_columns) < 2:
        raise InfeasibleError(f"facade {facade_id}: no photo shows a grid with at least one panel")
    adjusted = adjust(photos, fit, groups)
    is_row = np.array([group.axis == "row" for group in groups])
    order = np.lexsort((adjusted.positions_m, is_row))
    groups = tuple(groups[i] for i in order)
    adjusted = _ordered(adjusted, order)
    columns, rows = (_surface_lines(groups, adjusted, axis) for axis in ("column", "row"))
    missing = _missing(photos, grids, adjusted, groups)
    panels = _panels(facade_id, adjusted, columns, rows, missing)
    return SolvedFacade(facade_id, adjusted.surface, rows, columns, panels, adjusted.pose_changes)


def _reach_m(photo: PosedPhoto, surface: FacadeSurface) -> float:
    covariance = UNKNOWN_POSE if photo.pose.covariance is None else photo.pose.covariance
    distance = abs(float(surface.height_m(photo.pose.position_enu_m[None])[0]))
    position = float(np.linalg.eigvalsh(covariance[:3, :3]).max())
    turn = float(np.linalg.eigvalsh(covariance[3:, 3:]).max())
    return REACH_SIGMAS * float(np.sqrt(max(0.0, position) + max(0.0, turn) * distance**2))


def _ordered(adjusted: Adjusted, order: NDArray[np.int64]) -> Adjusted:
    n = len(order)
    full = np.concatenate([order, np.arange(n, len(adjusted.covariance))])
    return Adjusted(
        adjusted.surface,
        adjusted.positions_m[order],
        adjusted.covariance[np.ix_(full, full)],
        adjusted.poses,
        adjusted.pose_changes,
        adjusted.residual,
    )


def _surface_lines(groups: Sequence[LineGroup], adjusted: Adjusted, axis: str) -> tuple[SurfaceLine, ...]:
    return tuple(
        SurfaceLine(
            position_m=float(adjusted.positions_m[i]),
            width_m=float(np.median([line.width_m for line in group.members])),
            sigma_m=float(np.sqrt(max(0.0, adjusted.covariance[i, i]))),
            confidence=group.confidence,
            n_photos=len(group.members),
        )
        for i, group in enumerate(groups)
        if group.axis == axis
    )


def _missing(
    photos: Sequence[PosedPhoto], grids: Mapping[int, FacadeGrid], adjusted: Adjusted, groups: Sequence[LineGroup]
) -> set[tuple[int, int]]:
    """Cells that most of the photos which show them say are no panels."""
    columns = np.array([adjusted.positions_m[i] for i, group in enumerate(groups) if group.axis == "column"])
    rows = np.array([adjusted.positions_m[i] for i, group in enumerate(groups) if group.axis == "row"])
    votes: Counter[tuple[int, int]] = Counter()
    for number, grid in grids.items():
        photo = photos[number]
        for sign, cells in ((-1, [panel.corners_px.mean(axis=0) for panel in grid.panels]), (1, _middles(grid))):
            if not cells:
                continue
            st = adjusted.surface.hits(*photo.rays(np.array(cells)))
            for s, t in st[np.isfinite(st).all(axis=1)]:
                votes[int(np.searchsorted(rows, t)) - 1, int(np.searchsorted(columns, s)) - 1] += sign
    return {cell for cell, count in votes.items() if count > 0}


def _middles(grid: FacadeGrid) -> list[Array]:
    """Middles, in the photo, of the cells that are no panels."""
    n = len(grid.rows)
    points = [
        (
            0.5 * (grid.columns[column].position_px + grid.columns[column + 1].position_px),
            0.5 * (grid.rows[n - 2 - row].position_px + grid.rows[n - 1 - row].position_px),
        )
        for row, column in grid.missing
    ]
    found = grid.rectification.to_photo(np.array(points)) if points else np.zeros((0, 2))
    return [point for point in found if np.isfinite(point).all()]


def _panels(
    facade_id: str,
    adjusted: Adjusted,
    columns: Sequence[SurfaceLine],
    rows: Sequence[SurfaceLine],
    missing: set[tuple[int, int]],
) -> tuple[SolvedPanel, ...]:
    cells, corners, lines = [], [], []
    for row, (below, above) in enumerate(pairwise(rows)):
        for column, (left, right) in enumerate(pairwise(columns)):
            s0, s1 = left.position_m + 0.5 * left.width_m, right.position_m - 0.5 * right.width_m
            t0, t1 = below.position_m + 0.5 * below.width_m, above.position_m - 0.5 * above.width_m
            if (row, column) in missing or s1 <= s0 or t1 <= t0:
                continue
            cells.append((row, column, min(line.confidence for line in (below, above, left, right))))
            corners += [(s0, t0), (s1, t0), (s1, t1), (s0, t1)]
            first, low = column, len(columns) + row
            lines += [(first, low), (first + 1, low), (first + 1, low + 1), (first, low + 1)]
    if not cells:
        return ()
    st = np.array(corners)
    points = adjusted.surface.to_enu(st).reshape(-1, 4, 3)
    covariances = _corner_covariances(adjusted, st, np.array(lines)).reshape(-1, 4, 3, 3)
    return tuple(
        SolvedPanel(f"{facade_id}-{row + 1:02d}-{column + 1:02d}", row, column, points[i], covariances[i], confidence)
        for i, (row, column, confidence) in enumerate(cells)
    )


def _corner_covariances(adjusted: Adjusted, st: Array, lines: NDArray[np.int64]) -> Array:
    """Covariances of corners, shape (n, 3, 3), ENU, from those of the surface and of their two lines, shape (n, 2)."""
    surface = adjusted.surface
    n_lines, n_all = len(adjusted.positions_m), len(adjusted.covariance)
    design = np.zeros((len(st), 3, n_all))
    each = np.arange(len(st))
    design[each, :, lines[:, 0]] = surface.right_at(st)
    design[each, :, lines[:, 1]] = surface.up_enu
    for i in range(n_all - n_lines):
        step = np.zeros(n_all - n_lines)
        step[i] = STEP
        ahead, behind = changed(surface, step).to_enu(st), changed(surface, -step).to_enu(st)
        design[:, :, n_lines + i] = (ahead - behind) / (2.0 * STEP)
    return np.asarray(design @ adjusted.covariance @ design.transpose(0, 2, 1), float)
