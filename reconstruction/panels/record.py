"""A facade in 3-D: its surface, its lines in metres on it, its panels, and how good all of it is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from reconstruction.rectify.surface import FacadeSurface

Array = NDArray[np.float64]

Axis = Literal["column", "row"]
"""Vertical lines, at an s, or horizontal ones, at a t of the surface."""


@dataclass(frozen=True, slots=True, eq=False)
class SeenLine:
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


@dataclass(frozen=True, slots=True, eq=False)
class SolvedPanel:
    """A panel in 3-D.

    Parameters
    ----------
    row, column
        From the bottom row and the left column, from 0.
    corners_enu_m
        Shape (4, 3): lower left, lower right, upper right, upper left as seen from outside.
    covariance_m2
        Shape (4, 3, 3), of each corner, ENU.
    """

    id: str
    row: int
    column: int
    corners_enu_m: Array
    covariance_m2: Array
    confidence: float


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
    """

    id: str
    surface: FacadeSurface
    rows: tuple[SurfaceLine, ...]
    columns: tuple[SurfaceLine, ...]
    panels: tuple[SolvedPanel, ...]
    pose_changes: dict[int, Array]
