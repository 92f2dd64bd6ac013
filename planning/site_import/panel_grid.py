"""Panels that the user states as equal rectangles on a facade, checked against the building."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.coverage.model import OCCLUSION_OFFSET_M
from planning.errors import InputError
from planning.geometry.solids import Solids
from planning.mesh import TriangleMesh
from planning.occlusion import line_of_sight
from planning.scenes import panel_grid
from planning.site_import.openness import MIN_OPEN_SHARE, UNDECIDED, open_shares
from planning.site_import.options import PanelGrid
from planning.site_import.polygons import unit_normals
from planning.site_import.quads import MIN_SIDE_M
from planning.site_import.source import SourceModel

Array = NDArray[np.float64]

MAX_SKEW = 0.05
"""Cosine of the largest deviation of the corner from a right angle: 2.9 degrees, or 1.8 m over 36 m."""

MAX_PANELS = 100_000


class GridPanels(NamedTuple):
    """Corners of shape (m, 4, 3), ENU metres, counter-clockwise from outside, and what is worth knowing about them."""

    corners: Array
    notes: tuple[str, ...]


def grid_panels(grid: PanelGrid, source: SourceModel, tolerance_m: float) -> GridPanels:
    """Panels of a grid on a building.

    Raises
    ------
    InputError
        The counts or the gap are impossible, the three corners make no rectangle, the grid is not on the building or
        looks into it; the message tells the angle or the distance measured.
    """
    corners = _rectangle_panels(grid, source.placement.enu(np.array(grid.corners)))
    if len(source.building.triangles) == 0:
        return GridPanels(corners, ())
    _check_distance(grid, corners, source.building, tolerance_m)
    return GridPanels(corners, _check_side(grid, corners, source.building))


def _rectangle_panels(grid: PanelGrid, rectangle: Array) -> Array:
    """Panels of the grid, shape (m, 4, 3), from its lower left, lower right and upper left corner."""
    if grid.n_rows < 1 or grid.n_columns < 1 or grid.n_rows * grid.n_columns > MAX_PANELS:
        raise InputError(f"--rows {grid.n_rows} --columns {grid.n_columns}: expected 1 to {MAX_PANELS} panels in all")
    low, right, up = rectangle
    across, along = right - low, up - low
    width_m, height_m = float(np.linalg.norm(across)), float(np.linalg.norm(along))
    if min(width_m, height_m) < MIN_SIDE_M:
        raise InputError(f"--panel-grid {_text(grid)}: the rectangle is {width_m:.2f} x {height_m:.2f} m, no facade")
    cosine = float(across @ along) / (width_m * height_m)
    if abs(cosine) > MAX_SKEW:
        angle_deg = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
        raise InputError(
            f"--panel-grid {_text(grid)}: the angle at the lower left corner is {angle_deg:.0f} degrees; expected a "
            "rectangle, given by its lower left, lower right and upper left corner as seen from outside"
        )
    cell_m = (width_m / grid.n_columns, height_m / grid.n_rows)
    if not 0.0 <= grid.gap_m <= min(cell_m) - MIN_SIDE_M:
        raise InputError(
            f"--gap {grid.gap_m:g} leaves no glass between the mullions: the grid's cells measure {cell_m[0]:.2f} x "
            f"{cell_m[1]:.2f} m"
        )
    # Exactly at right angles, so that panels are rectangles: the lower edge stays, the side is straightened.
    along = along - across * (along @ across) / (across @ across)
    a, b, c = ((float(p[0]), float(p[1]), float(p[2])) for p in (low, right, low + along))
    return np.array(
        [p.corners_enu_m for p in panel_grid("grid", (a, b, c), grid.n_rows, grid.n_columns, grid.gap_m).panels]
    )


def _check_distance(grid: PanelGrid, corners: Array, building: TriangleMesh, tolerance_m: float) -> None:
    """The panels must lie on the building, by the median of their distances: scans have holes where there is glass."""
    centres = corners.mean(axis=1)
    distance = np.abs(Solids.of(building.corners_enu_m).clearance_m(centres))
    median_m = float(np.median(distance))
    if median_m > tolerance_m:
        points = building.corners_enu_m.reshape(-1, 3)
        raise InputError(
            f"--panel-grid {_text(grid)}: its panels lie {median_m:.1f} m from the building (median; nearest "
            f"{distance.min():.1f} m, allowed {tolerance_m:g} m). In local metres the grid's middle is "
            f"{_point(centres.mean(axis=0))} and the building reaches from {_point(points.min(axis=0))} to "
            f"{_point(points.max(axis=0))}; check the corners, --units and --up, or allow more with --grid-tolerance"
        )


def _check_side(grid: PanelGrid, corners: Array, building: TriangleMesh) -> tuple[str, ...]:
    """The panels must look outdoors."""
    normals, sight = unit_normals(corners), line_of_sight(building.corners_enu_m)
    front = corners.mean(axis=1) + OCCLUSION_OFFSET_M * normals
    ahead = open_shares(front, normals, sight)
    n_blind = int((ahead < MIN_OPEN_SHARE).sum())
    if n_blind == 0:
        return ()
    behind = open_shares(corners.mean(axis=1) - OCCLUSION_OFFSET_M * normals, -normals, sight)
    if 2 * n_blind > len(corners) and np.median(behind) > np.median(ahead) + UNDECIDED:
        raise InputError(
            f"--panel-grid {_text(grid)}: {n_blind} of {len(corners)} panels look into the building, and their backs "
            "look out; name the corners as seen from outside (lower left, lower right, upper left)"
        )
    return (
        f"{n_blind} of {len(corners)} panels of the grid see nothing of the open, as the mesh covers them: move the "
        "grid outwards, or they cannot be photographed with occlusion on",
    )


def _text(grid: PanelGrid) -> str:
    return "'" + " ".join(",".join(f"{value:g}" for value in corner) for corner in grid.corners) + "'"


def _point(point: Array) -> str:
    return "(" + ", ".join(f"{value:.1f}" for value in point) + ")"
