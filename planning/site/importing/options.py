"""What the user may say about an import; everything left out has a default that is stated in a note."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from planning.geo.crs import AxisOrder, HeightReference
from planning.geo.frames import Origin, Vec3
from planning.site.records import check_min_height

UNITS_M = {"m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "in": 0.0254, "us-ft": 1200.0 / 3937.0}
"""Metres per unit, exact (the US survey foot is 1200/3937 m by definition)."""


@dataclass(frozen=True, slots=True)
class PanelGrid:
    """A facade rectangle with equal panels.

    Parameters
    ----------
    corners
        Lower left, lower right and upper left, seen from outside; in the file's coordinate reference system, or in
        metres east, north, up of the file's zero where it has none.
    n_rows, n_columns
        Panels one above the other and side by side.
    gap_m
        Width of the mullions between neighbouring panels.
    """

    corners: tuple[Vec3, Vec3, Vec3]
    n_rows: int
    n_columns: int
    gap_m: float = 0.0


@dataclass(frozen=True, slots=True)
class ImportOptions:
    """Options of one import.

    Parameters
    ----------
    name
        Of the site; default the building's or the file's.
    origin
        Where the file's (0, 0, 0) is, or the middle of the building's footprint if the coordinates are far from zero.
        Its height is above sea level where `height_reference` says so.
    crs, axis_order, height_reference
        Of the file's coordinates, instead of what the file says.
    up
        Axis that points up in a mesh file; default y for GLB, z for all others.
    unit
        Of a mesh file, a key of `UNITS_M`.
    panel_grids
        Rectangles of panels to add.
    grid_tolerance_m
        Distance that a grid may keep from the mesh.
    building
        Identifier of the one building wanted, in files with many.
    ground_z
        Third file coordinate of the ground.
    home_enu_m, airspace_margin_m, floor_m, ceiling_m
        Of the site: take-off place, distance of the airspace's sides from the building, and its lowest and highest z
        (default 2 m above ground, and 30 m above the building's top).
    min_height_m
        Lowest flight above the ground that the site is to state; None: the usual.
    deflection_m
        Largest distance between a curved IFC surface and its triangles: smaller is truer and slower.
    panels_required
        Refuse a file that has no windows while no grid is stated. Without, it becomes a site without panels.
    """

    name: str | None = None
    origin: Origin | None = None
    crs: str | None = None
    axis_order: AxisOrder = "auto"
    height_reference: HeightReference = "auto"
    up: Literal["y", "z"] | None = None
    unit: str = "m"
    panel_grids: tuple[PanelGrid, ...] = ()
    grid_tolerance_m: float = 2.0
    building: str | None = None
    ground_z: float | None = None
    home_enu_m: Vec3 | None = None
    airspace_margin_m: float = 40.0
    floor_m: float | None = None
    ceiling_m: float | None = None
    min_height_m: float | None = None
    deflection_m: float = 0.005
    panels_required: bool = True

    def __post_init__(self) -> None:
        check_min_height(self.min_height_m)
