"""What a synthetic facade is: its layout, what disturbs the photo of it, the camera, and the photo with its truth."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from reconstruction.base.cameras import Array, PosedPhoto

# The wall of a synthetic facade: a vertical plane or cylinder with coordinates along it.
#
# Two frames are used. ENU is the site's. The *wall frame* has its origin on the wall, in its middle and at its base:
# x to
# the right as seen from outside, y into the wall, z up. On the wall, s is the length along it from its middle to the
# right and h the height above its base, metres.

Array32 = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class Wall:
    """Where a wall stands and how it is bent.

    Parameters
    ----------
    base_enu_m
        Middle of the wall at its base.
    outward_heading_deg
        Of the outward normal in the middle, clockwise from north; -180 faces south.
    curvature_per_m
        1 / radius: positive for a wall that bulges outwards, negative for a hollow one, 0 for a plane.
    """

    base_enu_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    outward_heading_deg: float = 180.0
    curvature_per_m: float = 0.0

    @property
    def wall_from_enu(self) -> Array:
        """Rotation, shape (3, 3), from ENU to the wall frame."""
        heading = math.radians(self.outward_heading_deg)
        sin, cos = math.sin(heading), math.cos(heading)
        return np.array([[-cos, sin, 0.0], [-sin, -cos, 0.0], [0.0, 0.0, 1.0]])

    def to_wall(self, points_enu_m: Array) -> Array:
        """Points, shape (n, 3), ENU to wall frame."""
        return (np.atleast_2d(points_enu_m) - self.base_enu_m) @ self.wall_from_enu.T

    def points_enu_m(self, s_m: Array, h_m: Array) -> Array:
        """Points on the wall, shape (n, 3), from their coordinates along it, each shape (n,)."""
        s, h = np.asarray(s_m, float), np.asarray(h_m, float)
        angle = self.curvature_per_m * s
        # sin(ks)/k and (1 - cos(ks))/k, both good for k = 0.
        x = s * np.sinc(angle / np.pi)
        y = 0.5 * self.curvature_per_m * s**2 * np.sinc(0.5 * angle / np.pi) ** 2
        return np.stack([x, y, h], axis=-1) @ self.wall_from_enu + self.base_enu_m

    def outward_enu(self, s_m: Array) -> Array:
        """Unit outward normals, shape (n, 3), at places along the wall, shape (n,)."""
        angle = self.curvature_per_m * np.asarray(s_m, float)
        normals = np.stack([np.sin(angle), -np.cos(angle), np.zeros_like(angle)], axis=-1)
        return np.asarray(normals @ self.wall_from_enu)


def first_hits(
    origin: Array, x: Array32, y: Array32, z: Array32, curvature_per_m: float
) -> tuple[Array32, Array32, Array32]:
    """Where rays from one point fall on the outside of a wall of any height, everything in the wall frame.

    Parameters
    ----------
    origin
        Shape (3,), outside the wall.
    x, y, z
        Directions, each shape (n,), any length.

    Returns
    -------
    t, s_m, h_m
        Multiples of the direction, place along the wall and height, each shape (n,); NaN where the ray misses.
    """
    k = np.float32(curvature_per_m)
    ox, oy, oz = (np.float32(value) for value in origin)
    # k (x² + y²) = 2 y is the wall: a cylinder that touches the x axis, and for k = 0 the plane itself. The root is
    # written so that it stays exact as k goes to 0.
    a = k * (x * x + y * y)
    b = y - k * (ox * x + oy * y)
    c = k * (ox * ox + oy * oy) - 2 * oy
    with np.errstate(divide="ignore", invalid="ignore"):
        root = c / (b + np.sqrt(b * b - a * c))
        is_hit = (root > 0) & (b > 0)
    t = np.where(is_hit, root, np.nan).astype(np.float32)
    hit_x, hit_y = ox + t * x, oy + t * y
    s = np.arctan2(k * hit_x, 1 - k * hit_y) / k if k else hit_x
    return t, np.asarray(s, np.float32), np.asarray(oz + t * z, np.float32)


Widths = Literal["uniform", "alternating", "random"]
Top = Literal["straight", "sloped", "triangles", "gable"]
Opposite = Literal["skyline", "grid", "roofs"]

BraceEnds = tuple[float, float, float, float]
"""Row and column of one end, row and column of the other, in lines of the grid from below and from the left. Columns
may lie between lines: then both ends are on lines of rows."""


@dataclass(frozen=True, slots=True)
class Layout:
    """Rows and columns of a curtain wall.

    Parameters
    ----------
    widths
        Columns all alike, alternating 1 : 0.6, or each between 0.6 and 1.4 of `panel_width_m`.
    spandrel_height_m
        Height of a low row of panels between two storeys (opaque glass in front of the slab); 0 for none.
    mullion_width_m, transom_width_m
        Of the vertical and horizontal profiles; panels end at their edges.
    frame_depth_m
        How far the profiles stand out from the glass.
    missing_profiles
        Share of the mullion pieces, one a row, that are not there: the panes meet in a joint too thin to be seen.
    n_missing_mullions
        Inner mullions not there from bottom to top.
    missing_panels
        Share of the cells that hold something else: a louvre, a solid wall.
    top
        Upper edge: straight; rising from left to right over the highest rows; teeth, each panel of the highest row a
        triangle; or a gable that falls from the middle to both sides over the highest rows.
    n_sloped_rows
        Rows, spandrels counted, that a sloped edge or a gable cuts through.
    braces
        Inclined profiles through the grid, which cut the panels that they cross.
    brace_width_m
        Of those profiles, across their own direction.
    """

    n_rows: int = 8
    n_columns: int = 12
    panel_width_m: float = 1.5
    panel_height_m: float = 2.4
    widths: Widths = "uniform"
    spandrel_height_m: float = 0.0
    mullion_width_m: float = 0.06
    transom_width_m: float = 0.06
    frame_depth_m: float = 0.0
    missing_profiles: float = 0.0
    n_missing_mullions: int = 0
    missing_panels: float = 0.0
    top: Top = "straight"
    n_sloped_rows: int = 1
    braces: tuple[BraceEnds, ...] = ()
    brace_width_m: float = 0.08

    def __post_init__(self) -> None:
        if self.n_rows < 1 or self.n_columns < 1:
            raise ValueError(f"expected at least one row and column, got {self.n_rows} x {self.n_columns}")
        sizes = (self.panel_width_m, self.panel_height_m)
        if min(sizes) <= 0.0 or min(self.mullion_width_m, self.transom_width_m, self.frame_depth_m) < 0.0:
            raise ValueError("expected positive panels, and profiles of no negative size")
        if max(self.mullion_width_m / 0.6, self.transom_width_m) >= min(sizes):
            raise ValueError("expected profiles narrower than the panels")
        _check_shares(missing_profiles=self.missing_profiles, missing_panels=self.missing_panels)
        if not 1 <= self.n_sloped_rows <= self.n_rows:
            raise ValueError(f"n_sloped_rows: expected 1 to {self.n_rows}, got {self.n_sloped_rows}")
        if self.braces and self.brace_width_m <= 0.0:
            raise ValueError(f"brace_width_m: expected more than 0, got {self.brace_width_m}")


@dataclass(frozen=True, slots=True)
class Disturbances:
    """What makes a photo of a facade hard to read; every one is off by default.

    Parameters
    ----------
    reflection
        Share of the light that glass mirrors at normal incidence (coated solar glass: 0.3 to 0.6); more at grazing
        angles (Schlick). 0: nothing is mirrored at any angle.
    opposite
        What stands across the street and is mirrored: a skyline, a bright grid whose image looks like frames, or houses
        with inclined roof edges.
    street_m
        Distance to it.
    tilt_deg
        Standard deviation of each pane's tilt, about both axes: its mirror image is displaced against its neighbour's.
    pillow_deg
        Tilt that grows from the middle of a pane to its edges (insulating glass under pressure): lines are bent.
    blinds
        Share of panes with a bright blind, pulled down by a random part.
    glare
        Strength of the sun's mirror image, 0 to 1: a saturated spot with a halo.
    shadow
        Share of light that a shadow with a slanted edge takes.
    clutter
        Other buildings, with windows of their own, and trees around the facade instead of an empty sky.
    blur_px, noise_grey
        Standard deviations of the lens's blur and of the sensor's noise, grey levels of 255.
    yaw_error_deg
        The stated pose is turned by this against the true one.
    """

    reflection: float = 0.0
    opposite: Opposite = "skyline"
    street_m: float = 30.0
    tilt_deg: float = 0.0
    pillow_deg: float = 0.0
    blinds: float = 0.0
    glare: float = 0.0
    shadow: float = 0.0
    clutter: bool = False
    blur_px: float = 0.0
    noise_grey: float = 0.0
    yaw_error_deg: float = 0.0

    def __post_init__(self) -> None:
        _check_shares(reflection=self.reflection, blinds=self.blinds, glare=self.glare, shadow=self.shadow)
        if min(self.blur_px, self.noise_grey, self.tilt_deg) < 0.0 or self.street_m <= 0.0:
            raise ValueError("expected a street of some width, and no negative blur, noise or tilt")


def _check_shares(**shares: float) -> None:
    for name, share in shares.items():
        if not 0.0 <= share <= 1.0:
            raise ValueError(f"{name}: expected a share from 0 to 1, got {share}")


@dataclass(frozen=True, slots=True)
class Case:
    """Everything that a synthetic photo depends on.

    Parameters
    ----------
    frame_bgr, glass_bgr
        Colours of the profiles and of what is seen through the glass, 0 to 255 in OpenCV's order.
    truth
        The true camera; the photo's stated one differs by `Disturbances.yaw_error_deg`.
    """

    name: str
    layout: Layout
    wall: Wall
    truth: PosedPhoto
    disturbances: Disturbances = field(default_factory=Disturbances)
    frame_bgr: tuple[float, float, float] = (70.0, 66.0, 62.0)
    glass_bgr: tuple[float, float, float] = (88.0, 78.0, 60.0)
    seed: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class TruePanel:
    """A panel as it was made.

    Parameters
    ----------
    row, column
        From the bottom row and the left column, from 0.
    corners_enu_m, corners_px
        Shapes (k, 3) and (k, 2), k from 3 to 5, in the order of `FoundPanel`: lower left, lower right, upper right,
        upper left. Corners outside the picture are kept.
    """

    row: int
    column: int
    corners_enu_m: Array
    corners_px: Array


@dataclass(frozen=True, slots=True, eq=False)
class SyntheticFacade:
    """A synthetic photo and the truth about it.

    Parameters
    ----------
    image
        Shape (height, width, 3), uint8, blue, green, red.
    index
        Shape (height, width), uint16: position in `panels` plus 1, or 0 where the middle of the pixel is not glass.
    facade
        Shape (height, width): glass and frames; not what fills missing cells.
    columns_m, rows_m
        Middles of the vertical lines along the wall, from left to right, and of the horizontal ones, upwards.
    missing
        Cells (row, column) that are no panels.
    photo
        The photo with its stated camera.
    """

    case: Case
    image: NDArray[np.uint8]
    index: NDArray[np.uint16]
    facade: NDArray[np.bool_]
    panels: tuple[TruePanel, ...]
    columns_m: Array
    rows_m: Array
    missing: tuple[tuple[int, int], ...]
    photo: PosedPhoto
