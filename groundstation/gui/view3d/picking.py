"""What lies under a pixel: rays against the triangles of a site, and viewpoints and routes by their pixels."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from groundstation.gui.view3d.drawables import Layer, shown_panels
from groundstation.gui.view3d.orbit import Pinhole
from groundstation.gui.view3d.site_scene import PlanScene, SiteScene, landing_pad
from groundstation.services.project.document import Item, ItemKind
from planning.geo.bvh import build_bvh, first_hits, segment_hits, segment_hits_triangle
from planning.site.ground import drawn_terrain
from planning.site.records import panel_triangles

Array = NDArray[np.float64]


REACH_M = 50_000.0
"""Length of a picking ray."""

VIEWPOINT_PX, ROUTE_PX = 10.0, 6.0
"""How near to a viewpoint or a route the pointer must be: a mouse is steadier than that, a finger nearly so."""

MAX_HITS = 4096

_LAYERS = {
    ItemKind.BUILDING: Layer.BUILDING,
    ItemKind.PANEL: Layer.PANELS,
    ItemKind.OBSTACLE: Layer.OBSTACLES,
    ItemKind.NO_FLY: Layer.NO_FLY,
    ItemKind.ZONE: Layer.ZONES,
    ItemKind.HOME: Layer.HOME,
    ItemKind.RALLY: Layer.HOME,
    ItemKind.VIEWPOINT: Layer.VIEWPOINTS,
    ItemKind.LEG: Layer.ROUTES,
}


VOLUMES = frozenset((ItemKind.NO_FLY, ItemKind.ZONE))
SEE_THROUGH = frozenset((Layer.NO_FLY, Layer.ZONES))
"""Translucent volumes and their layers: they hide nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class Hit:
    """A place on something that can be pointed at.

    Parameters
    ----------
    point_enu_m
        Shape (3,).
    normal
        Unit normal on the side of the eye, shape (3,); zero where the thing has none (a viewpoint, a route).
    depth_m
        Distance from the eye.
    """

    item: Item
    point_enu_m: Array
    normal: Array
    depth_m: float


class PickIndex:
    """Answers what a ray meets. Made once per site; viewpoints and routes are looked up by their pixels."""

    def __init__(self, scene: SiteScene) -> None:
        load_kernels()
        site, model = scene.model.site, scene.model
        parts: list[tuple[Item | None, Array]] = [(None, panel_triangles(shown_panels(scene.frames)))]
        parts.append((Item(ItemKind.BUILDING), model.building.corners_enu_m))
        for obstacle, mesh in zip(site.obstacles, model.obstacles, strict=True):
            parts.append((Item(ItemKind.OBSTACLE, obstacle.id), mesh.corners_enu_m))
        for zone in site.airspace.no_fly:
            parts.append((Item(ItemKind.NO_FLY, zone.id), zone.prism().corners_enu_m))
        parts += [(zone.item, zone.triangles_enu_m()) for zone in scene.zones]
        parts.append((Item(ItemKind.HOME), landing_pad(site.home_enu_m).corners_enu_m))
        for point in site.rally_points:
            parts.append((Item(ItemKind.RALLY, point.id), landing_pad(point.position_enu_m).corners_enu_m))
        self._panels = tuple(Item(ItemKind.PANEL, panel.id) for panel in site.panels)
        self._items = [item for item, _ in parts]
        self._starts = np.cumsum([0, *(len(corners) for _, corners in parts)])
        n_bodies = 2 + len(model.obstacles)  # behind the panels and the building
        self._bodies, self._others = (
            build_bvh(np.concatenate([corners for _, corners in some])) for some in (parts[:n_bodies], parts[n_bodies:])
        )
        self._leaf_of_body = np.argsort(self._bodies.source)
        self._widths_m2 = {zone.item: zone.width_m2 for zone in scene.zones}
        self._ground_z_m = site.airspace.ground_z_m
        self._terrain = drawn_terrain(site)

    def surface(self, eye_enu_m: Array, direction: Array, hidden: frozenset[Layer] = frozenset()) -> Hit | None:
        """The first thing that a ray from the eye meets.

        A no-fly volume is transparent: what lies in it or behind it comes first, unless that is only the building.
        Geo-zones come last, for a site may lie in one, and the smaller before those around it.
        """
        found = np.empty(MAX_HITS, np.int64)
        end = eye_enu_m + REACH_M * direction
        hits = []
        for bvh, first_triangle in ((self._bodies, 0), (self._others, len(self._bodies.source))):
            n = min(segment_hits(bvh, eye_enu_m, end, found), MAX_HITS)
            for k in found[:n]:
                item = self._item(first_triangle + int(bvh.source[k]))
                if _LAYERS[item.kind] not in hidden:
                    depth = REACH_M * segment_hits_triangle(eye_enu_m, end, bvh.corners[k])
                    hits.append((depth, bvh.corners[k], item))
        if not hits:
            return None
        hits.sort(key=lambda hit: hit[0])
        solid = next((hit for hit in hits if hit[2].kind not in VOLUMES), None)
        volume = next((hit for hit in hits if hit[2].kind is ItemKind.NO_FLY), None)
        if volume is not None and (solid is None or (solid[2].kind is ItemKind.BUILDING and volume[0] < solid[0])):
            first = volume
        elif solid is not None:
            first = solid
        else:
            first = min(hits, key=lambda hit: self._widths_m2[hit[2]])
        depth, corners, item = first
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        normal /= max(float(np.linalg.norm(normal)), 1e-12)
        if normal @ direction > 0.0:
            normal = -normal
        return Hit(item, eye_enu_m + depth * direction, normal, depth)

    def bodies(self, eye_enu_m: Array, directions: Array) -> tuple[Array, Array]:
        """Where rays from the eye first meet a panel, the building or an obstacle, and the normals there.

        Parameters
        ----------
        directions
            Unit vectors, shape (n, 3).

        Returns
        -------
        depth_m, normals
            Shape (n,), infinite where nothing is met; unit vectors towards the eye, shape (n, 3), zero there.
        """
        depth_m, found = np.empty(len(directions)), np.empty(len(directions), np.int64)
        origins = np.tile(np.asarray(eye_enu_m, np.float64), (len(directions), 1))
        first_hits(self._bodies, origins, np.ascontiguousarray(directions), REACH_M, depth_m, found)
        normals, is_met = np.zeros((len(directions), 3)), found >= 0
        corners = self._bodies.corners[self._leaf_of_body[found[is_met]]]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-12)
        away = np.einsum("nk,nk->n", across, directions[is_met]) > 0.0
        normals[is_met] = np.where(away[:, None], -across, across)
        return depth_m, normals

    def ground(self, eye_enu_m: Array, direction: Array) -> Array | None:
        """Where a ray from the eye meets terrain, or the level of the ground, shape (3,); None for rays that rise."""
        if direction[2] >= -1e-6:
            return None
        if self._terrain is not None:
            met = self._terrain.first_met(eye_enu_m, eye_enu_m + REACH_M * direction)
            if met is not None:
                return met
        along = (self._ground_z_m - eye_enu_m[2]) / direction[2]
        return np.asarray(eye_enu_m + along * direction) if 0.0 < along < REACH_M else None

    def _item(self, triangle: int) -> Item:
        part = int(np.searchsorted(self._starts, triangle, side="right")) - 1
        item = self._items[part]
        return self._panels[triangle // 2] if item is None else item


def nearest_viewpoint(
    plan: PlanScene, view: Pinhole, x_px: float, y_px: float, depth_m: float, without: frozenset[int] = frozenset()
) -> Hit | None:
    """The viewpoint whose dot lies nearest to a pixel, no deeper than the surface there and within `VIEWPOINT_PX`."""
    positions = plan.views.positions_enu_m
    if len(positions) == 0:
        return None
    pixels, depths = view.project(positions)
    distance_px = np.hypot(pixels[:, 0] - x_px, pixels[:, 1] - y_px)
    away_m = np.linalg.norm(positions - view.eye_enu_m, axis=1)
    is_shown = ~np.isin(plan.sortie, list(without))
    distance_px = np.where((depths > 0.0) & (away_m <= depth_m) & is_shown, distance_px, np.inf)
    i = int(np.argmin(distance_px))
    if not distance_px[i] <= VIEWPOINT_PX:
        return None
    item = Item(ItemKind.VIEWPOINT, plan.plan.viewpoints[i].id)
    return Hit(item, positions[i], np.zeros(3), float(away_m[i]))


def nearest_leg(
    plan: PlanScene, view: Pinhole, x_px: float, y_px: float, depth_m: float, without: frozenset[int] = frozenset()
) -> Hit | None:
    """The leg of a route that passes a pixel within `ROUTE_PX`, no deeper than the surface there."""
    best: tuple[float, Hit] | None = None
    deepest = depth_m * float(view.ray(x_px, y_px) @ view.forward)
    for number, path in enumerate(plan.paths, start=1):
        if len(path) < 2 or number - 1 in without:
            continue
        pixels, depths = view.project(path)
        a, b = pixels[:-1], pixels[1:]
        along = b - a
        squared = np.maximum(np.einsum("ij,ij->i", along, along), 1e-12)
        share = np.clip(np.einsum("ij,ij->i", np.array([x_px, y_px]) - a, along) / squared, 0.0, 1.0)
        distance_px = np.linalg.norm(a + share[:, None] * along - [x_px, y_px], axis=1)
        # In perspective the depth runs evenly in 1 / depth along the pixels of a line.
        with np.errstate(divide="ignore", invalid="ignore"):
            leg_depth = 1.0 / ((1.0 - share) / depths[:-1] + share / depths[1:])
        in_front = (depths[:-1] > 0.0) & (depths[1:] > 0.0) & (leg_depth <= deepest)
        distance_px = np.where(in_front, distance_px, np.inf)
        i = int(np.argmin(distance_px))
        if distance_px[i] <= ROUTE_PX and (best is None or distance_px[i] < best[0]):
            point = path[i] + share[i] * leg_depth[i] / depths[i + 1] * (path[i + 1] - path[i])
            away_m = float(np.linalg.norm(point - view.eye_enu_m))
            best = float(distance_px[i]), Hit(Item(ItemKind.LEG, f"{number}/{i + 1}"), point, np.zeros(3), away_m)
    return None if best is None else best[1]


def pick(
    index: PickIndex | None,
    plan: PlanScene | None,
    view: Pinhole,
    x_px: float,
    y_px: float,
    hidden: frozenset[Layer] = frozenset(),
    without: frozenset[int] = frozenset(),
) -> Hit | None:
    """What lies under a pixel: viewpoints before routes before surfaces, as far as no surface hides them.

    Parameters
    ----------
    without
        Sorties, counted from 0, that are not shown.
    """
    surface = None if index is None else index.surface(view.eye_enu_m, view.ray(x_px, y_px), hidden)
    hides = surface is not None and surface.item.kind not in VOLUMES
    depth_m = surface.depth_m + 0.5 if surface is not None and hides else np.inf
    if plan is not None:
        if Layer.VIEWPOINTS not in hidden:
            viewpoint = nearest_viewpoint(plan, view, x_px, y_px, depth_m, without)
            if viewpoint is not None:
                return viewpoint
        if Layer.ROUTES not in hidden:
            leg = nearest_leg(plan, view, x_px, y_px, depth_m, without)
            if leg is not None:
                return leg
    return surface


@cache
def load_kernels() -> None:
    """Load the compiled code, and Numba with it, on whatever thread a site comes from; not at the first mouse move."""
    triangle = np.eye(3)
    segment_hits(build_bvh(triangle[None]), np.zeros(3), np.ones(3), np.empty(1, np.int64))
    segment_hits_triangle(np.zeros(3), np.ones(3), triangle)
    first_hits(build_bvh(triangle[None]), triangle[:1], triangle[1:2], 1.0, np.empty(1), np.empty(1, np.int64))


# What a picture covers: where the border of a photo falls on the surfaces of a site.

RAYS_PER_SIDE = 12
"""Enough to follow corners of a building."""

LIFT_M = 0.06
"""The line is drawn this far in front of the surfaces."""

MAX_STEP = 0.2
"""Neighbouring rays whose depths differ by a larger part meet different surfaces: no line is drawn between them."""


def footprint(index: PickIndex, view: Pinhole) -> list[Array]:
    """Pieces of the border of a picture on the surfaces it meets, polylines of shape (k, 3), k >= 2."""
    along = np.arange(RAYS_PER_SIDE) / RAYS_PER_SIDE
    zeros = np.zeros(RAYS_PER_SIDE)
    x = np.concatenate([along, zeros + 1.0, 1.0 - along, zeros, [0.0]]) * view.width_px
    y = np.concatenate([zeros, along, zeros + 1.0, 1.0 - along, [0.0]]) * view.height_px
    pieces: list[list[Array]] = [[]]
    last_m = np.inf
    rays = np.array([view.ray(float(x_px), float(y_px)) for x_px, y_px in zip(x, y, strict=True)])
    for ray, met_m, normal in zip(rays, *index.bodies(view.eye_enu_m, rays), strict=True):
        is_met = np.isfinite(met_m)
        point = view.eye_enu_m + met_m * ray + LIFT_M * normal if is_met else index.ground(view.eye_enu_m, ray)
        depth_m = met_m if is_met or point is None else float(np.linalg.norm(point - view.eye_enu_m))
        if point is None or abs(depth_m - last_m) > MAX_STEP * depth_m:
            pieces.append([])
        if point is not None:
            pieces[-1].append(point)
        last_m = depth_m
    return [np.array(piece) for piece in pieces if len(piece) > 1]
