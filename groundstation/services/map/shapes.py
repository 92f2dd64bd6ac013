"""A site and a plan as seen from above, in world coordinates of the map (`web_mercator`), ready to be drawn."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from groundstation.services.map.web_mercator import MAX_LAT_DEG, world_from_enu
from groundstation.services.project.document import Item, ItemKind
from planning.checks.zones import zone_text
from planning.geo.frames import Origin
from planning.geo.mesh import TriangleMesh
from planning.plan import Plan
from planning.site.records import Site, SiteModel, panel_corners
from planning.site.zones.keep_out import near_zones
from planning.site.zones.records import Restriction

Floats = NDArray[np.float64]

SAME_M = 0.02
"""Details closer than this are one on a map: a point of the deepest tiles there are spans 3 to 7 cm."""

MIN_TRIANGLE_M2 = 1e-3
"""Triangles that are narrower seen from above are walls; what they stand on has other triangles."""


@dataclass(frozen=True, slots=True, eq=False)
class Area:
    """Something that covers ground: closed rings, each shape (k, 2), outer ones and holes (even-odd rule)."""

    item: Item
    rings: tuple[Floats, ...]


@dataclass(frozen=True, slots=True, eq=False)
class ZoneArea(Area):
    """A geo-zone, cut to the surroundings of the site.

    Parameters
    ----------
    what
        Name, restriction, reasons and heights, in words.
    is_kept
        Whether flights keep out of it.
    """

    name: str
    what: str
    restriction: Restriction
    is_kept: bool


@dataclass(frozen=True, slots=True, eq=False)
class SiteShapes:
    """What a map shows of a site.

    Parameters
    ----------
    origin
        Of the local frame.
    solids
        Building (where there is one) and obstacles.
    no_fly, airspace
        Zones, and the airspace's box.
    zones
        Geo-zones near the site, the smallest first.
    facades
        Panels by facade, shape (p, 4, 2); panels above one another are drawn once.
    home
        Shape (2,).
    rally
        Rally points, each shape (2,).
    """

    origin: Origin
    solids: tuple[Area, ...]
    no_fly: tuple[Area, ...]
    airspace: Area
    facades: tuple[tuple[Item, Floats], ...]
    home: Floats
    rally: tuple[tuple[Item, Floats], ...]
    zones: tuple[ZoneArea, ...] = ()

    @property
    def is_on_map(self) -> bool:
        """False near the poles, where Web Mercator ends."""
        return abs(self.origin.lat_deg) < MAX_LAT_DEG

    def landings(self) -> Floats:
        """Home and the rally points, shape (1 + n, 2)."""
        return np.array([self.home, *(place for _, place in self.rally)])

    def extent(self) -> Floats:
        """Points, shape (n, 2), that are in sight when the whole site is."""
        return np.concatenate([*self.airspace.rings, self.landings(), *(p.reshape(-1, 2) for _, p in self.facades)])


@dataclass(frozen=True, slots=True, eq=False)
class PlanShapes:
    """What a map shows of a plan.

    Parameters
    ----------
    routes
        Path of each sortie, shape (k, 2).
    viewpoint_ids, viewpoints, headings_deg
        n viewpoints, their places, shape (n, 2), and headings, shape (n,).
    sortie_of
        Number of each viewpoint's sortie from 1, 0 for none; shape (n,).
    """

    routes: tuple[Floats, ...]
    viewpoint_ids: tuple[str, ...]
    viewpoints: Floats
    headings_deg: Floats
    sortie_of: NDArray[np.int64]

    def without(self, sorties: Collection[int]) -> PlanShapes:
        """The plan without the viewpoints of some sorties, counted from 1, their routes empty."""
        if not sorties:
            return self
        kept = np.flatnonzero(~np.isin(self.sortie_of, list(sorties)))
        return PlanShapes(
            tuple(route[:0] if number in sorties else route for number, route in enumerate(self.routes, 1)),
            tuple(self.viewpoint_ids[i] for i in kept),
            self.viewpoints[kept],
            self.headings_deg[kept],
            self.sortie_of[kept],
        )


def site_shapes(model: SiteModel) -> SiteShapes:
    """A site seen from above. Takes up to a second for buildings of many triangles."""
    site, origin = model.site, model.site.origin
    items = [Item(ItemKind.BUILDING), *(Item(ItemKind.OBSTACLE, obstacle.id) for obstacle in site.obstacles)]
    solids = [
        Area(item, _footprint(mesh, origin))
        for item, mesh in zip(items, (model.building, *model.obstacles), strict=True)
        if len(mesh.triangles)
    ]
    zones = [
        Area(
            Item(ItemKind.NO_FLY, zone.id),
            (world_from_enu(origin, [(x, y, site.airspace.ground_z_m) for x, y in zone.polygon_enu_m]),),
        )
        for zone in site.airspace.no_fly
    ]
    return SiteShapes(
        origin=origin,
        solids=tuple(solids),
        no_fly=tuple(zones),
        airspace=Area(Item(ItemKind.AIRSPACE), (airspace_outline(site),)),
        facades=_facades(model),
        home=world_from_enu(origin, [site.home_enu_m])[0],
        rally=tuple(
            (Item(ItemKind.RALLY, point.id), world_from_enu(origin, [point.position_enu_m])[0])
            for point in site.rally_points
        ),
        zones=_zones(model),
    )


def _zones(model: SiteModel) -> tuple[ZoneArea, ...]:
    import shapely

    ground_z, found = model.site.airspace.ground_z_m, []
    for near in near_zones(model):
        if not near.local.volumes:
            continue
        union = shapely.union_all([volume.area for volume in near.local.volumes])
        rings = [
            shapely.get_coordinates(ring)
            for part in shapely.get_parts(union)
            if part.geom_type == "Polygon"
            for ring in (part.exterior, *part.interiors)
        ]
        world = tuple(world_from_enu(model.site.origin, np.c_[ring, np.full(len(ring), ground_z)]) for ring in rings)
        zone = near.local.zone
        area = ZoneArea(
            Item(ItemKind.ZONE, near.key), world, zone.name, zone_text(near), zone.restriction, near.is_kept
        )
        found.append((union.area, area))
    return tuple(area for _, area in sorted(found, key=lambda each: each[0]))


def airspace_outline(site: Site) -> Floats:
    """Corners of the airspace, shape (4, 2): known at once, and all of a site lies in it."""
    (x0, y0, z0), (x1, y1, _) = site.airspace.min_enu_m, site.airspace.max_enu_m
    return world_from_enu(site.origin, [(x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0)])


def _footprint(mesh: TriangleMesh, origin: Origin) -> tuple[Floats, ...]:
    """Outlines of what a mesh covers."""
    import shapely

    corners = mesh.corners_enu_m
    a, b = corners[:, 1, :2] - corners[:, 0, :2], corners[:, 2, :2] - corners[:, 0, :2]
    area_m2 = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2.0
    flat = corners[area_m2 > MIN_TRIANGLE_M2][..., :2]
    if not len(flat):
        return ()
    union = shapely.union_all(shapely.polygons(flat), grid_size=SAME_M).simplify(SAME_M)
    ground_z = float(mesh.vertices_enu_m[:, 2].min())
    rings = [
        shapely.get_coordinates(ring)
        for part in shapely.get_parts(union)
        if part.geom_type == "Polygon"
        for ring in (part.exterior, *part.interiors)
    ]
    return tuple(world_from_enu(origin, np.c_[ring, np.full(len(ring), ground_z)]) for ring in rings)


def _facades(model: SiteModel) -> tuple[tuple[Item, Floats], ...]:
    corners = panel_corners(model.site)
    found, first = [], 0
    for facade in model.site.facades:
        own = corners[first : first + len(facade.panels)]
        first += len(facade.panels)
        if len(own):
            _, once = np.unique(np.round(own[..., :2] / SAME_M).reshape(len(own), 8), axis=0, return_index=True)
            world = world_from_enu(model.site.origin, own[np.sort(once)].reshape(-1, 3))
            found.append((Item(ItemKind.FACADE, facade.id), world.reshape(-1, 4, 2)))
    return tuple(found)


def plan_shapes(plan: Plan, origin: Origin) -> PlanShapes:
    """A plan seen from above; `origin` is that of its site."""
    sortie_of = {
        viewpoint_id: number for number, sortie in enumerate(plan.sorties, 1) for viewpoint_id in sortie.viewpoint_ids
    }
    positions = np.array([view.position_enu_m for view in plan.viewpoints], np.float64).reshape(-1, 3)
    return PlanShapes(
        routes=tuple(
            world_from_enu(origin, np.array(sortie.path_enu_m, np.float64).reshape(-1, 3)) for sortie in plan.sorties
        ),
        viewpoint_ids=tuple(view.id for view in plan.viewpoints),
        viewpoints=world_from_enu(origin, positions),
        headings_deg=np.array([view.heading_deg for view in plan.viewpoints], np.float64),
        sortie_of=np.array([sortie_of.get(view.id, 0) for view in plan.viewpoints], np.int64),
    )


def round_length(longest: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is not above `longest` (> 0): for scale bars and grids."""
    power = 10.0 ** math.floor(math.log10(longest))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= longest * (1.0 + 1e-12))
