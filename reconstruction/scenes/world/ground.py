"""The ground of a scene: level, or the site's terrain where panes show the difference.

Terrain is taken over as a grid of triangles whose cells grow with their distance from the glass. Around it the ground
goes on as high as its border, and holes are filled from their borders: a picture needs some ground everywhere. Only
pictures use that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment, Decision, EffectSetting, decide
from planning.base.messages import say
from planning.geo.height_field import HeightField
from planning.geo.mesh import TriangleMesh
from planning.site.records import Site, SiteModel, panel_corners
from planning.site.terrain import surfaces

Array = NDArray[np.float64]

GROUND_HALF_M = 1500.0
"""Seen from 20 m above, its edge is 0.8 degrees below the horizon."""

GROWTH = 0.1
"""Size of the terrain's cells as a part of their distance from the glass: what is far away is seen small."""

CAMERA_M = 10.0
"""Usual distance of the camera from the glass: mirrored ground is so much farther away than it is from the glass."""

DRAPED_M = 1.0
"""Size of the pieces in which pavements follow the terrain."""


class MirroredTerrain:
    """The effect: how far terrain moves the ground, and its mirror image in the glass, against level ground.

    A point d higher at a distance D from a pane, mirrored to a camera b before the pane and h above the ground, is seen
    d (D + b) / ((D + b)^2 + h^2) higher. Panes are mounted to some 0.2 degrees, which moves mirror images by more.
    """

    name = "terrain"
    unit = "deg"
    tolerance = 0.2

    def assess(self, scene: SiteModel) -> Assessment:
        """The largest angle over all nodes around the building."""
        terrain = _terrain(scene.site)
        if terrain is None:
            return Assessment(0.0, say("the site has no terrain"), 0.0)
        corners = panel_corners(scene.site)
        around = _around(corners)
        part = _grid(terrain, corners, around)
        if part is None or not np.isfinite(part.z_m).any():
            return Assessment(0.0, say("the terrain has no heights around the glass"), 0.0)
        level_z_m = scene.site.airspace.ground_z_m
        x, y = np.meshgrid(part.x_m, part.y_m)
        low, high = corners.reshape(-1, 3)[:, :2].min(axis=0), corners.reshape(-1, 3)[:, :2].max(axis=0)
        beside = np.hypot(
            np.maximum(np.maximum(low[0] - x, x - high[0]), 0.0), np.maximum(np.maximum(low[1] - y, y - high[1]), 0.0)
        )
        away_m = beside + CAMERA_M
        above_m = max(float(corners[..., 2].mean()) - level_z_m, 0.0)
        up_m = np.abs(part.z_m - level_z_m)
        size_deg = float(np.degrees(np.nanmax(up_m * away_m / (away_m**2 + above_m**2))))
        reason = say(
            "the terrain around departs from level ground by up to {:.1f} m, which moves the ground in the glass by "
            "up to {:.2f} degrees",
            float(np.nanmax(up_m)),
            size_deg,
        )
        return Assessment(size_deg, reason, COST_S)


COST_S = 3.0
"""Light on 16 000 more triangles is gathered once; a photo of 640 x 480 then takes 0.60 s in place of 0.52 s (bundled
office on a slope, one core)."""


def decide_ground(model: SiteModel, setting: EffectSetting = "auto") -> Decision | None:
    """Whether pictures show a site's terrain, and why; None without any.

    Parameters
    ----------
    setting
        `auto`: as the site says that its terrain is used.
    """
    if model.site.terrain is None:
        return None
    use = model.site.terrain.use
    return decide(MirroredTerrain(), model, use if setting == "auto" else setting)


@dataclass(frozen=True, slots=True, eq=False)
class SceneGround:
    """Ground as a picture shows it.

    Parameters
    ----------
    level_z_m
        Of level ground, ENU z.
    x_m, y_m, z_m
        Lines of the grid, rising, shapes (k,) and (n,), and heights at their crossings, shape (n, k); None where the
        ground is level.
    """

    level_z_m: float
    x_m: Array | None = None
    y_m: Array | None = None
    z_m: Array | None = None

    def heights_m(self, points_xy: Array) -> Array:
        """Height, ENU z, at points of shape (n, 2), of the very triangles of `mesh`; beyond the grid as at its edge."""
        if self.x_m is None or self.y_m is None or self.z_m is None:
            return np.full(len(points_xy), self.level_z_m)
        x, y, z = self.x_m, self.y_m, self.z_m
        east, north = np.clip(points_xy[:, 0], x[0], x[-1]), np.clip(points_xy[:, 1], y[0], y[-1])
        column = np.clip(np.searchsorted(x, east, side="right") - 1, 0, len(x) - 2)
        row = np.clip(np.searchsorted(y, north, side="right") - 1, 0, len(y) - 2)
        u = (east - x[column]) / (x[column + 1] - x[column])
        v = (north - y[row]) / (y[row + 1] - y[row])
        a, b = z[row, column], z[row, column + 1]
        c, d = z[row + 1, column + 1], z[row + 1, column]
        return np.asarray(np.where(u >= v, a + u * (b - a) + v * (c - b), a + v * (d - a) + u * (c - d)))

    def lowest_m(self, outline_xy: Array) -> float:
        """Lowest height below the corners, sides and middle of a convex outline, shape (k, 2)."""
        return float(self.heights_m(_inside(outline_xy)).min())

    def highest_m(self, outline_xy: Array) -> float:
        """Highest height likewise."""
        return float(self.heights_m(_inside(outline_xy)).max())

    def mesh(self, square_xy: Array) -> TriangleMesh:
        """The ground as triangles that look upwards; level ground as the square, shape (4, 2), counter-clockwise."""
        if self.x_m is None or self.y_m is None or self.z_m is None:
            corners = np.c_[square_xy, np.full(4, self.level_z_m)]
            return TriangleMesh(corners, np.array([[0, 1, 2], [0, 2, 3]]))
        x, y = np.meshgrid(self.x_m, self.y_m)
        number = np.arange(x.size).reshape(x.shape)
        a, b, c, d = (each.ravel() for each in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]))
        triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
        return TriangleMesh(np.stack([x.ravel(), y.ravel(), self.z_m.ravel()], axis=1), triangles)

    def draped(self, rectangle_xy: Array, raised_m: float) -> TriangleMesh:
        """A rectangle, shape (4, 2), counter-clockwise, that lies `raised_m` or more above the ground."""
        if self.z_m is None:
            return SceneGround(self.level_z_m + raised_m).mesh(rectangle_xy)
        first, along, across = rectangle_xy[0], rectangle_xy[1] - rectangle_xy[0], rectangle_xy[3] - rectangle_xy[0]
        n, m = (max(1, int(np.ceil(np.linalg.norm(side) / DRAPED_M))) for side in (along, across))
        fine = np.linspace(0.0, 1.0, 4 * n + 1), np.linspace(0.0, 1.0, 4 * m + 1)
        u, v = np.meshgrid(*fine, indexing="ij")
        places = first + u[..., None] * along + v[..., None] * across
        below = self.heights_m(places.reshape(-1, 2)).reshape(u.shape)
        patch = SceneGround(self.level_z_m, fine[0][::4], fine[1][::4], below[::4, ::4].T)
        over = patch.heights_m(np.stack([u.ravel(), v.ravel()], axis=1)).reshape(u.shape)
        # Between its corners a piece would cut off what the terrain's edges raise.
        lift_m = raised_m + max(0.0, float((below - over).max()))
        flat = patch.mesh(rectangle_xy)
        u_of, v_of = flat.vertices_enu_m[:, 0], flat.vertices_enu_m[:, 1]
        corners = first + u_of[:, None] * along + v_of[:, None] * across
        return TriangleMesh(np.c_[corners, flat.vertices_enu_m[:, 2] + lift_m], flat.triangles)


def scene_ground(model: SiteModel, decision: Decision | None) -> SceneGround:
    """The ground of a site's pictures, as it was decided."""
    level_z_m = model.site.airspace.ground_z_m
    terrain = _terrain(model.site) if decision is not None and decision.on else None
    corners = panel_corners(model.site)
    part = None if terrain is None else _grid(terrain, corners, _around(corners))
    if part is None or not np.isfinite(part.z_m).any():
        return SceneGround(level_z_m)
    from scipy.ndimage import distance_transform_edt

    nearest = distance_transform_edt(np.isnan(part.z_m), return_distances=False, return_indices=True)
    z = part.z_m[tuple(nearest)]
    west, south, east, north = _around(corners)
    x, y = part.x_m, part.y_m
    if x[0] > west:
        x, z = np.r_[west, x], np.c_[z[:, 0], z]
    if x[-1] < east:
        x, z = np.r_[x, east], np.c_[z, z[:, -1]]
    if y[0] > south:
        y, z = np.r_[south, y], np.r_[z[:1], z]
    if y[-1] < north:
        y, z = np.r_[y, north], np.r_[z, z[-1:]]
    return SceneGround(level_z_m, x, y, z)


def _terrain(site: Site) -> HeightField | None:
    return None if site.terrain is None else surfaces(site.terrain).ground


@dataclass(frozen=True, slots=True, eq=False)
class _Grid:
    x_m: Array
    y_m: Array
    z_m: Array


def _grid(terrain: HeightField, corners: Array, around: tuple[float, float, float, float]) -> _Grid | None:
    """Heights of the terrain within a box, NaN where they are not known; None where it lies beside."""
    west, south, east, north = around
    points = corners.reshape(-1, 3)[:, :2]
    lines = []
    for axis, (first, n, low, high) in enumerate(
        (
            (terrain.west_m, terrain.z_m.shape[1], west, east),
            (terrain.south_m, terrain.z_m.shape[0], south, north),
        )
    ):
        start, end = max(first, low), min(first + terrain.step_m * (n - 1), high)
        if not start < end:
            return None
        glass = float(points[:, axis].min()), float(points[:, axis].max())
        lines.append(_lines(start, end, glass, terrain.step_m))
    x, y = np.meshgrid(*lines)
    heights = terrain.heights_m(np.stack([x.ravel(), y.ravel()], axis=1))
    return _Grid(lines[0], lines[1], heights.reshape(x.shape))


def _lines(start_m: float, end_m: float, glass_m: tuple[float, float], step_m: float) -> Array:
    """Places of grid lines from a start to an end: nodes of the terrain, sparser the farther from the glass."""
    nodes = start_m + step_m * np.arange(int(np.floor((end_m - start_m) / step_m + 1e-9)) + 1)
    away_m = np.maximum(np.maximum(glass_m[0] - nodes, nodes - glass_m[1]), 0.0)
    every = np.maximum(1, (GROWTH * away_m / step_m).astype(np.int64))
    kept, last = [], 0
    for number, stride in enumerate(every):
        if number == 0 or number - last >= min(stride, every[last]):
            kept.append(number)
            last = number
    found = np.asarray(nodes[kept], np.float64)
    return found if end_m - found[-1] < 1e-9 else np.asarray(np.append(found, end_m), np.float64)


def _around(corners: Array) -> tuple[float, float, float, float]:
    """West, south, east and north of the ground that pictures show, from panels' corners of shape (m, 4, 3)."""
    points = corners.reshape(-1, 3)[:, :2]
    x, y = 0.5 * (points.min(axis=0) + points.max(axis=0))
    return float(x) - GROUND_HALF_M, float(y) - GROUND_HALF_M, float(x) + GROUND_HALF_M, float(y) + GROUND_HALF_M


def _inside(outline_xy: Array) -> Array:
    """Corners of an outline, points along its sides, and its middle."""
    following = np.roll(outline_xy, -1, axis=0)
    sides = [outline_xy + share * (following - outline_xy) for share in (0.0, 0.25, 0.5, 0.75)]
    return np.concatenate([*sides, outline_xy.mean(axis=0)[None]])
