"""A facade in 3-D: its surface, its lines in metres on it, its panels, and how good all of it is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from reconstruction.panels.rectify.surface import FacadeSurface
from reconstruction.panels.search.cutting import Cut

Array = NDArray[np.float64]

Axis = Literal["column", "row"]
"""Vertical lines, at an s, or horizontal ones, at a t of the surface."""


@dataclass(frozen=True, slots=True, eq=False)
class ObservedLine:
    """One line of the grid as one photo shows it.

    Parameters
    ----------
    photo
        Number of the photo in its set.
    points_px
        Shape (k, 2): points along it, in the photo.
    position_m, width_m
        Middle and width on the surface, by the stated pose.
    sigma_m
        Standard deviation of the position from the picture alone.
    from_m, to_m
        What the photo's grid spans along the line.
    confidence
        That there is a line, 0 to 1.
    """

    photo: int
    axis: Axis
    points_px: Array
    position_m: float
    width_m: float
    sigma_m: float
    from_m: float
    to_m: float
    confidence: float


@dataclass(frozen=True, slots=True)
class SurfaceLine:
    """One line of the grid on the surface, out of all photos.

    Parameters
    ----------
    sigma_m
        Standard deviation of `position_m` within the facade's plane, poses and surface included.
    n_photos
        That show it.
    """

    position_m: float
    width_m: float
    sigma_m: float
    confidence: float
    n_photos: int


@dataclass(frozen=True, slots=True)
class SurfaceInclined:
    """An inclined profile on the surface, out of all photos.

    Parameters
    ----------
    first_st_m, last_st_m
        Ends of its middle.
    sigma_m
        Standard deviation of its place across its direction, against the lines of the grid.
    open_side
        As in `cutting.Cut`, on the surface.
    n_photos
        That show it.
    """

    first_st_m: tuple[float, float]
    last_st_m: tuple[float, float]
    width_m: float
    sigma_m: float
    confidence: float
    open_side: int
    n_photos: int

    def cut(self) -> Cut:
        """As cells see it."""
        return Cut(np.array(self.first_st_m), np.array(self.last_st_m), 0.5 * self.width_m, self.open_side)


@dataclass(frozen=True, slots=True, eq=False)
class SolvedPanel:
    """A panel in 3-D.

    Parameters
    ----------
    row, column
        From the bottom row and the left column, from 0.
    corners_enu_m
        Shape (4, 3): lower left, lower right, upper right, upper left as seen from outside. Of a triangle the fourth
        lies in the middle of the longest side; with five corners and more it is the largest quadrilateral among them.
    covariance_m2
        Shape (4, 3, 3), of each corner, ENU.
    outline_enu_m
        Shape (k, 3): all corners of a panel that has not four.
    """

    id: str
    row: int
    column: int
    corners_enu_m: Array
    covariance_m2: Array
    confidence: float
    outline_enu_m: Array | None = None


@dataclass(frozen=True, slots=True, eq=False)
class SolvedFacade:
    """One facade in 3-D.

    Parameters
    ----------
    rows
        From bottom to top.
    columns
        From left to right.
    pose_changes
        By the number of a photo: shape (6,), what the adjustment added to its pose, in the order of its covariance.
    inclined
        Profiles that cut cells of the grid.
    """

    id: str
    surface: FacadeSurface
    rows: tuple[SurfaceLine, ...]
    columns: tuple[SurfaceLine, ...]
    panels: tuple[SolvedPanel, ...]
    pose_changes: dict[int, Array]
    inclined: tuple[SurfaceInclined, ...] = ()
