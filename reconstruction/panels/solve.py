"""From the grids of one facade in several photos to its panels in 3-D."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from planning.errors import InfeasibleError
from reconstruction.cameras import PosedPhoto
from reconstruction.panels.adjustment import UNKNOWN_POSE, Adjusted, adjust
from reconstruction.panels.association import LineGroup, associate
from reconstruction.panels.cells import facade_panels
from reconstruction.panels.inclined import surface_inclined
from reconstruction.panels.observations import seen_lines
from reconstruction.panels.record import SolvedFacade, SurfaceLine
from reconstruction.rectify.fit import SurfaceFit
from reconstruction.rectify.surface import FacadeSurface
from reconstruction.segmentation.record import FacadeGrid

Array = NDArray[np.float64]

REACH_SIGMAS = 3.0
"""How far a photo's grid may lie off, in standard deviations of its pose; two photos may lie off to opposite sides."""


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
    seen = [line for number, grid in grids.items() for line in seen_lines(photos[number], number, grid, fit.surface)]
    groups = associate(seen, 2.0 * max((reach_m(photos[number], fit.surface) for number in grids), default=0.0))
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
    narrowest = min(float(np.diff([line.position_m for line in lines]).min()) for lines in (columns, rows))
    inclined = surface_inclined(photos, grids, adjusted, narrowest)
    panels = facade_panels(facade_id, adjusted, columns, rows, missing, inclined)
    return SolvedFacade(facade_id, adjusted.surface, rows, columns, panels, adjusted.pose_changes, inclined)


def reach_m(photo: PosedPhoto, surface: FacadeSurface) -> float:
    """How far the grid of a photo may lie off on a surface, metres, by the covariance of its pose."""
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
