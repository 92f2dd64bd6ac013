"""Panels that the user states as equal rectangles on a facade, checked against the building."""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import about, glue, say
from planning.geo.bvh import OCCLUSION_OFFSET_M, line_of_sight
from planning.geo.mesh import TriangleMesh
from planning.geo.solids import Solids
from planning.site.bundled import panel_grid
from planning.site.importing.options import PanelGrid
from planning.site.importing.panes import MIN_OPEN_SHARE, UNDECIDED, open_shares
from planning.site.importing.polygons import MIN_SIDE_M, unit_normals
from planning.site.importing.source import SourceModel

Array = NDArray[np.float64]

MAX_SKEW = 0.05
"""Cosine of the largest deviation of the corner from a right angle: 2.9 degrees, or 1.8 m over 36 m."""

MAX_PANELS = 100_000


class GridField(StrEnum):
    """What the user stated about a grid."""

    COUNTS = "counts"
    CORNERS = "corners"
    GAP = "gap"


class PanelGridError(InputError):
    """A grid that cannot be, or does not fit its building.

    Attributes
    ----------
    field
        What is wrong.
    is_off_building
        The grid lies too far from the building, so that units or axes may be to blame as well.
    """

    def __init__(self, field: GridField, message: str, *, is_off_building: bool = False) -> None:
        super().__init__(message)
        self.field, self.is_off_building = field, is_off_building


class GridPanels(NamedTuple):
    """Corners of shape (m, 4, 3), ENU metres, counter-clockwise from outside, and what is worth knowing about them."""

    corners: Array
    notes: tuple[str, ...]


def grid_panels(grid: PanelGrid, source: SourceModel, tolerance_m: float) -> GridPanels:
    """Panels of a grid on a building that is imported.

    Raises
    ------
    InputError
        As `panels_on_building`; the message names the option that is wrong.
    """
    try:
        return panels_on_building(
            source.placement.enu(np.array(grid.corners)),
            (grid.n_rows, grid.n_columns),
            grid.gap_m,
            source.building,
            tolerance_m,
        )
    except PanelGridError as error:
        options = {
            GridField.COUNTS: f"--rows {grid.n_rows} --columns {grid.n_columns}",
            GridField.CORNERS: f"--panel-grid {_text(grid)}",
            GridField.GAP: f"--gap {grid.gap_m:g}",
        }
        advice = say("; check the corners, --units and --up, or allow more with --grid-tolerance")
        raise InputError(about(options[error.field], glue(error, advice if error.is_off_building else ""))) from error


def panels_on_building(
    rectangle_enu_m: Array, counts: tuple[int, int], gap_m: float, building: TriangleMesh, tolerance_m: float
) -> GridPanels:
    """Equal panels in a rectangle on a building.

    Parameters
    ----------
    rectangle_enu_m
        Lower left, lower right and upper left corner as seen from outside, shape (3, 3).
    counts
        Rows, one above the other, and columns.
    gap_m
        Width of the mullions between neighbouring panels.
    tolerance_m
        Largest distance of the panels from the building, in the median.

    Raises
    ------
    PanelGridError
        The counts or the gap are impossible, the three corners make no rectangle, the grid is not on the building or
        looks into it; the message tells the angle or the distance measured.
    """
    corners = _rectangle_panels(rectangle_enu_m, counts, gap_m)
    if len(building.triangles) == 0:
        return GridPanels(corners, ())
    _check_distance(corners, building, tolerance_m)
    return GridPanels(corners, _check_side(corners, building))


def _rectangle_panels(rectangle: Array, counts: tuple[int, int], gap_m: float) -> Array:
    """Panels of the grid, shape (m, 4, 3), from its lower left, lower right and upper left corner."""
    n_rows, n_columns = counts
    if n_rows < 1 or n_columns < 1 or n_rows * n_columns > MAX_PANELS:
        raise PanelGridError(
            GridField.COUNTS,
            say("expected 1 to {} panels in all, got {} rows and {} columns", MAX_PANELS, n_rows, n_columns),
        )
    low, right, up = rectangle
    across, along = right - low, up - low
    width_m, height_m = float(np.linalg.norm(across)), float(np.linalg.norm(along))
    if min(width_m, height_m) < MIN_SIDE_M:
        raise PanelGridError(
            GridField.CORNERS,
            say("the rectangle is {:.2f} x {:.2f} m, no facade; place its corners apart", width_m, height_m),
        )
    cosine = float(across @ along) / (width_m * height_m)
    if abs(cosine) > MAX_SKEW:
        angle_deg = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
        raise PanelGridError(
            GridField.CORNERS,
            say(
                "the angle at the lower left corner is {:.0f} degrees; expected a rectangle, given by its lower "
                "left, lower right and upper left corner as seen from outside",
                angle_deg,
            ),
        )
    cell_m = (width_m / n_columns, height_m / n_rows)
    if not 0.0 <= gap_m <= min(cell_m) - MIN_SIDE_M:
        raise PanelGridError(
            GridField.GAP,
            say(
                "a gap of {:g} m leaves no glass between the mullions: the grid's cells measure {:.2f} x {:.2f} m",
                gap_m,
                cell_m[0],
                cell_m[1],
            ),
        )
    # Exactly at right angles, so that panels are rectangles: the lower edge stays, the side is straightened.
    along = along - across * (along @ across) / (across @ across)
    a, b, c = ((float(p[0]), float(p[1]), float(p[2])) for p in (low, right, low + along))
    return np.array([p.corners_enu_m for p in panel_grid("grid", (a, b, c), n_rows, n_columns, gap_m).panels])


def _check_distance(corners: Array, building: TriangleMesh, tolerance_m: float) -> None:
    """The panels must lie on the building, by the median of their distances: scans have holes where there is glass."""
    centres = corners.mean(axis=1)
    distance = np.abs(Solids.of(building.corners_enu_m).clearance_m(centres))
    median_m = float(np.median(distance))
    if median_m > tolerance_m:
        points = building.corners_enu_m.reshape(-1, 3)
        raise PanelGridError(
            GridField.CORNERS,
            say(
                "its panels lie {:.1f} m from the building (median; nearest {:.1f} m, allowed {:g} m). In local "
                "metres the grid's middle is {} and the building reaches from {} to {}",
                median_m,
                distance.min(),
                tolerance_m,
                _point(centres.mean(axis=0)),
                _point(points.min(axis=0)),
                _point(points.max(axis=0)),
            ),
            is_off_building=True,
        )


def _check_side(corners: Array, building: TriangleMesh) -> tuple[str, ...]:
    """The panels must look outdoors."""
    normals, sight = unit_normals(corners), line_of_sight(building.corners_enu_m)
    front = corners.mean(axis=1) + OCCLUSION_OFFSET_M * normals
    ahead = open_shares(front, normals, sight)
    n_blind = int((ahead < MIN_OPEN_SHARE).sum())
    if n_blind == 0:
        return ()
    behind = open_shares(corners.mean(axis=1) - OCCLUSION_OFFSET_M * normals, -normals, sight)
    if 2 * n_blind > len(corners) and np.median(behind) > np.median(ahead) + UNDECIDED:
        raise PanelGridError(
            GridField.CORNERS,
            say(
                "{} of {} panels look into the building, and their backs look out; name the corners as seen from "
                "outside (lower left, lower right, upper left)",
                n_blind,
                len(corners),
            ),
        )
    return (
        say(
            "{} of {} panels of the grid see nothing of the open, as the mesh covers them: move the grid "
            "outwards, or they cannot be photographed with occlusion on",
            n_blind,
            len(corners),
        ),
    )


def _text(grid: PanelGrid) -> str:
    return "'" + " ".join(",".join(f"{value:g}" for value in corner) for corner in grid.corners) + "'"


def _point(point: Array) -> str:
    return "(" + ", ".join(f"{value:.1f}" for value in point) + ")"
