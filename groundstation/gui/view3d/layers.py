"""What the view is made of: layers that are shown or hidden as a whole, and what is drawn in them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray


class Layer(StrEnum):
    """Parts of the picture that a user switches on and off."""

    GROUND = "ground"
    BUILDING = "building"
    PANELS = "panels"
    OBSTACLES = "obstacles"
    NO_FLY = "no-fly"
    AIRSPACE = "airspace"
    HOME = "home"
    VIEWPOINTS = "viewpoints"
    ROUTES = "routes"
    HEMISPHERES = "hemispheres"
    LABELS = "labels"


ON_TOP = -66_000.0
"""More steps than VTK's coincident shift can undo: in front of everything."""


@dataclass(frozen=True, slots=True, eq=False)
class Drawable:
    """Cells of one kind, each with its colour; drawn in one go.

    Parameters
    ----------
    points_enu_m
        Shape (n, 3).
    cells
        Indices of points, shape (k, c): c = 1 dots, 2 lines, 3 triangles, 4 quadrilaterals.
    colours
        Shape (k, 4), red, green, blue, opacity, 0 to 255.
    width_px
        Of dots and lines.
    edge_colour
        `#rrggbb` of the cells' outlines; empty for none. Outlines are dropped where cells are a few pixels in size.
    depth_shift
        Of lines and dots, in steps of the depth buffer: positive behind what lies at the same place, `ON_TOP` over
        everything.
    nearer
        Part of its distance by which it is drawn nearer to the eye, made smaller by the same part: it keeps its pixels
        and comes before what lies at the same place.
    """

    points_enu_m: NDArray[np.float64]
    cells: NDArray[np.int64]
    colours: NDArray[np.uint8]
    width_px: float = 1.0
    edge_colour: str = ""
    depth_shift: float = 0.0
    nearer: float = 0.0

    def __post_init__(self) -> None:
        n_cells, size = self.cells.shape
        if self.points_enu_m.ndim != 2 or self.points_enu_m.shape[1] != 3:
            raise ValueError(f"points_enu_m: expected shape (n, 3), got {self.points_enu_m.shape}")
        if not 1 <= size <= 4:
            raise ValueError(f"cells: expected shape (k, 1 to 4), got {self.cells.shape}")
        if self.colours.shape != (n_cells, 4) or self.colours.dtype != np.uint8:
            raise ValueError(f"colours: expected bytes of shape ({n_cells}, 4), got {self.colours.shape}")


@dataclass(frozen=True, slots=True)
class Label:
    """A text that stands at a point of the scene."""

    text: str
    point_enu_m: tuple[float, float, float]
    layer: Layer
    colour: str = ""
    """`#rrggbb` of a mark beside the text; empty for none."""
