"""What the view is made of: layers, what is drawn in them, and the arrays of points and cells it is drawn from."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from planning.coverage.positions import picture_corners
from planning.coverage.sections import PanelFrames
from planning.geo.frames import camera_axes
from planning.geo.mesh import TriangleMesh
from planning.plan import Camera, ViewpointArrays

# Shapes as arrays: points and the cells between them, for triangles, panels, frusta, arrows and outlines.

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Shape = tuple[Array, Ints]
"""Points, shape (n, 3), ENU metres, and cells, shape (k, c), indices into them."""

PANEL_OFFSET_M = 0.05
"""Panels are drawn this far in front of their place. Less, and the depth buffer cannot tell panel and wall apart from
100 m away."""

FRUSTUM_LINES = np.array([[0, 1], [0, 2], [0, 3], [0, 4], [1, 2], [2, 3], [3, 4], [4, 1]])
"""Pyramid of an eye (0) and the corners of its picture (1 to 4, from the lower left, anti-clockwise)."""

BOX_LINES = np.array([[0, 1], [1, 3], [3, 2], [2, 0], [4, 5], [5, 7], [7, 6], [6, 4], [0, 4], [1, 5], [2, 6], [3, 7]])


def repeated(pattern: Ints, n: int, points_each: int) -> Ints:
    """Cells of n equal shapes, shape (n k, c), from the cells (k, c) of one that has `points_each` points."""
    return np.asarray((pattern[None] + points_each * np.arange(n)[:, None, None]).reshape(-1, pattern.shape[1]))


def quads(corners_enu_m: Array) -> Shape:
    """Quadrilaterals from corners of shape (m, 4, 3)."""
    return corners_enu_m.reshape(-1, 3), np.arange(4 * len(corners_enu_m)).reshape(-1, 4)


def shown_panels(frames: PanelFrames) -> Array:
    """Corners of panels as they are drawn, a little in front of the walls on which they lie, shape (m, 4, 3)."""
    return np.asarray(frames.corners + PANEL_OFFSET_M * frames.normals[:, None])


def outlines(corners_enu_m: Array) -> Shape:
    """Edges of polygons of equal size, corners of shape (m, c, 3), as lines."""
    c = corners_enu_m.shape[1]
    ring = np.stack([np.arange(c), (np.arange(c) + 1) % c], axis=1)
    return corners_enu_m.reshape(-1, 3), repeated(ring, len(corners_enu_m), c)


def polyline(points_enu_m: Array) -> Shape:
    """Lines from point to point, shape (n, 3)."""
    n = len(points_enu_m)
    return points_enu_m, np.stack([np.arange(n - 1), np.arange(1, n)], axis=1) if n > 1 else np.zeros((0, 2), np.int64)


def box_edges(low_enu_m: Array, high_enu_m: Array) -> Shape:
    """The twelve edges of an axis-aligned box."""
    upper = np.array([[i >> 2 & 1, i >> 1 & 1, i & 1] for i in range(8)], bool)
    return np.where(upper, high_enu_m, low_enu_m).astype(np.float64), BOX_LINES


def frusta(views: ViewpointArrays, camera: Camera, length_m: float) -> Shape:
    """A pyramid of lines per viewpoint, 8 lines each, that opens as the camera sees."""
    corners = picture_corners(views, camera, length_m)
    points = np.concatenate([views.positions_enu_m[:, None], corners], axis=1)
    return points.reshape(-1, 3), repeated(FRUSTUM_LINES, len(points), 5)


def sight_lines(views: ViewpointArrays, length_m: float) -> Shape:
    """A line per viewpoint along its line of sight."""
    ahead, _, _ = camera_axes(views.heading_rad, views.pitch_rad)
    n = len(views.positions_enu_m)
    points = np.concatenate([views.positions_enu_m, views.positions_enu_m + length_m * ahead])
    return points, np.stack([np.arange(n), np.arange(n, 2 * n)], axis=1)


def shadow(mesh: TriangleMesh, towards_sun: Array, ground_z_m: float, low: Array, high: Array) -> Shape:
    """The shadow of a mesh on level ground, as triangles, brought into the rectangle from `low` to `high`, shape (2,).

    Triangles overlap, so that it can only be drawn opaque.
    """
    vertices = mesh.vertices_enu_m
    height = np.maximum(vertices[:, 2] - ground_z_m, 0.0)
    places = vertices[:, :2] - height[:, None] * (towards_sun[:2] / towards_sun[2])
    return np.c_[np.clip(places, low, high), np.full(len(places), ground_z_m)], mesh.triangles


def triangle_normals(mesh: TriangleMesh) -> Array:
    """Unit normals of a mesh's triangles, shape (t, 3); zero for triangles without area."""
    a, b, c = (mesh.vertices_enu_m[mesh.triangles[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    unit: Array = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0.0)
    return unit


def arrows(path_enu_m: Array, length_m: float) -> Shape:
    """Arrowheads along a polyline, shape (n, 3), that point the way it is flown, as triangles.

    Two crossed triangles each, so that one is seen from every side; on legs of at least twice their length, at the
    middle, and no nearer to one another than four times their length.
    """
    legs = np.diff(path_enu_m, axis=0)
    lengths = np.linalg.norm(legs, axis=1)
    middle_s = np.cumsum(lengths) - 0.5 * lengths
    kept, last_s = [], -np.inf
    for i in np.flatnonzero(lengths >= 2.0 * length_m):
        if middle_s[i] - last_s >= 4.0 * length_m:
            kept.append(i)
            last_s = middle_s[i]
    if not kept:
        return np.zeros((0, 3)), np.zeros((0, 3), np.int64)
    along = legs[kept] / lengths[kept, None]
    aside = np.cross(along, [0.0, 0.0, 1.0])
    width = np.linalg.norm(aside, axis=1, keepdims=True)
    aside = np.where(width > 1e-6, aside / np.maximum(width, 1e-6), [1.0, 0.0, 0.0])
    above = np.cross(aside, along)
    tip = 0.5 * (path_enu_m[:-1] + path_enu_m[1:])[kept] + 0.5 * length_m * along
    tail = tip - length_m * along
    half = 0.35 * length_m
    points = np.stack([tip, tail - half * aside, tail + half * aside, tail - half * above, tail + half * above], axis=1)
    return points.reshape(-1, 3), repeated(np.array([[0, 1, 2], [0, 3, 4]]), len(kept), 5)


def joined(shapes: list[Shape]) -> Shape:
    """All shapes, of cells of one kind, in one."""
    starts = np.cumsum([0, *(len(points) for points, _ in shapes[:-1])])
    points = np.concatenate([points for points, _ in shapes])
    return points, np.concatenate([cells + start for (_, cells), start in zip(shapes, starts, strict=True)])


class Layer(StrEnum):
    """Parts of the picture that a user switches on and off."""

    GROUND = "ground"
    BUILDING = "building"
    PANELS = "panels"
    OBSTACLES = "obstacles"
    NO_FLY = "no-fly"
    ZONES = "zones"
    AIRSPACE = "airspace"
    HOME = "home"
    SHADOWS = "shadows"
    VIEWPOINTS = "viewpoints"
    FRUSTA = "frusta"
    ROUTES = "routes"
    HEMISPHERES = "hemispheres"
    LABELS = "labels"
    SURROUNDINGS = "surroundings"
    PHOTOS = "photos"


ON_TOP = -66_000.0
"""More steps than VTK's coincident shift can undo: in front of everything."""


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """A picture on cells, which multiplies their colours and repeats.

    Parameters
    ----------
    pixels
        Shape (h, w, 3), the first row uppermost.
    uv
        Place of each corner of each cell, shape (k, c, 2): 1 is the width or height, from the lower left corner.
    """

    pixels: NDArray[np.uint8]
    uv: NDArray[np.float32]


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
    picture
        On triangles and quadrilaterals; None for colours alone.
    """

    points_enu_m: NDArray[np.float64]
    cells: NDArray[np.int64]
    colours: NDArray[np.uint8]
    width_px: float = 1.0
    edge_colour: str = ""
    depth_shift: float = 0.0
    nearer: float = 0.0
    picture: Picture | None = None

    def __post_init__(self) -> None:
        n_cells, size = self.cells.shape
        if self.points_enu_m.ndim != 2 or self.points_enu_m.shape[1] != 3:
            raise ValueError(f"points_enu_m: expected shape (n, 3), got {self.points_enu_m.shape}")
        if not 1 <= size <= 4:
            raise ValueError(f"cells: expected shape (k, 1 to 4), got {self.cells.shape}")
        if self.colours.shape != (n_cells, 4) or self.colours.dtype != np.uint8:
            raise ValueError(f"colours: expected bytes of shape ({n_cells}, 4), got {self.colours.shape}")
        if self.picture is not None and self.picture.uv.shape != (n_cells, size, 2):
            raise ValueError(f"uv: expected shape ({n_cells}, {size}, 2), got {self.picture.uv.shape}")


@dataclass(frozen=True, slots=True)
class Label:
    """A text that stands at a point of the scene."""

    text: str
    point_enu_m: tuple[float, float, float]
    layer: Layer
    colour: str = ""
    """`#rrggbb` of a mark beside the text; empty for none."""
