"""What a site and a plan look like: drawables by layer, and labels. Plain arrays; nothing is drawn here."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from groundstation.gui.view3d.drawables import (
    PANEL_OFFSET_M,
    Drawable,
    Label,
    Layer,
    Picture,
    Shape,
    arrows,
    box_edges,
    frusta,
    joined,
    polyline,
    quads,
    shadow,
    shown_panels,
    sight_lines,
    triangle_normals,
)
from groundstation.gui.view3d.paint import SUN, ColourScale, flat, rgba, shaded
from groundstation.gui.widgets.theme import FACADES, SORTIES, Colours, zone_colour
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.scenes.surfaces import Surface
from groundstation.services.site.zones import zone_lines
from planning.coverage.sections import NOT_SEEN, PanelFrames, SectionGrid, panel_frames, sections_seen
from planning.geo.frames import Vec3
from planning.geo.height_field import HeightField
from planning.geo.mesh import TriangleMesh, box_mesh
from planning.plan import Plan, ViewpointArrays, viewpoint_arrays
from planning.site.ground import drawn_terrain
from planning.site.records import NoFlyZone, SiteModel, panel_corners
from planning.site.zones.keep_out import NearZone, near_zones
from planning.site.zones.local import prisms

Array = NDArray[np.float64]


# What a plan looks like: viewpoints with frusta, routes by sortie with arrows, and labels. Nothing is drawn here.

Bytes = NDArray[np.uint8]

FRUSTUM_M = 1.5
ARROW_M = 1.8
"""Lengths of a viewpoint's pyramid and of arrowheads, metres: about the size of the aircraft."""

SIGHT_M = 1.2
"""Length of the line that shows where a viewpoint looks."""


TERRAIN_CELLS = 150
"""Of drawn terrain on a side: 45 000 triangles, as many as a small building model."""

CASING_SHIFT = 4.0
"""Outlines of lines lie this many steps of the depth buffer behind the lines themselves."""


@dataclass(frozen=True, slots=True, eq=False)
class PlanScene:
    """A plan ready to be drawn.

    Parameters
    ----------
    views
        All viewpoints, shape (n, ...).
    sortie
        Number of each viewpoint's sortie, shape (n,); -1 where it is in none.
    paths
        Polyline of each sortie, shape (k, 3).
    routes
        By sortie.
    marks
        Viewpoints by number of their sortie, -1 for those in none.
    """

    plan: Plan
    views: ViewpointArrays
    sortie: NDArray[np.int64]
    paths: tuple[Array, ...]
    viewpoint_index: dict[str, int]
    routes: tuple[tuple[Drawable, ...], ...]
    marks: dict[int, tuple[Drawable, ...]]


def plan_scene(
    plan: Plan,
    look: Colours,
    locked: frozenset[str] = frozenset(),
    values: tuple[ColourScale, tuple[Array, ...]] | None = None,
) -> PlanScene:
    """Everything of a plan.

    Parameters
    ----------
    locked
        Identifiers of viewpoints that are kept as they are; they get a filled mark.
    values
        A scale and, for each sortie, a value per vertex of its path: routes are coloured by it instead of by sortie.
    """
    views = viewpoint_arrays(plan.viewpoints)
    paths = tuple(np.array(sortie.path_enu_m, np.float64).reshape(-1, 3) for sortie in plan.sorties)
    number = {found: i for i, sortie in enumerate(plan.sorties) for found in sortie.viewpoint_ids}
    sortie = np.array([number.get(viewpoint.id, -1) for viewpoint in plan.viewpoints], np.int64)
    is_locked = np.array([viewpoint.id in locked for viewpoint in plan.viewpoints], bool)
    marks = {
        int(number): _marks(views, np.flatnonzero(sortie == number), sortie, is_locked, look)
        for number in np.unique(sortie)
    }
    routes = tuple(_route(number, path, values, look) for number, path in enumerate(paths))
    index = {viewpoint.id: i for i, viewpoint in enumerate(plan.viewpoints)}
    return PlanScene(plan, views, sortie, paths, index, routes, marks)


def views_of(plan: PlanScene, numbers: NDArray[np.int64]) -> ViewpointArrays:
    """Some of a plan's viewpoints."""
    return ViewpointArrays(*(part[numbers] for part in plan.views))


def plan_frusta(plan: PlanScene, numbers: NDArray[np.int64], look: Colours) -> tuple[Drawable, ...]:
    """Pyramids of some viewpoints."""
    if len(numbers) == 0:
        return ()
    points, cells = frusta(views_of(plan, numbers), plan.plan.camera, FRUSTUM_M)
    colours = np.repeat(sortie_colours(plan.sortie[numbers], look), len(cells) // len(numbers), axis=0)
    return (Drawable(points, cells, colours, width_px=1.5),)


def views_that_cover(plan: PlanScene, frames: PanelFrames, panel: int) -> NDArray[np.int64]:
    """Numbers of the viewpoints that cover a section of a panel, whatever stands between."""
    one = PanelFrames(
        frames.centroids[[panel]],
        frames.normals[[panel]],
        frames.tangents[[panel]],
        frames.bitangents[[panel]],
        frames.corners[[panel]],
    )
    rules = plan.plan.constraints
    grid = SectionGrid(rules.section_step_deg)
    seen = sections_seen(plan.views, one, plan.plan.camera, grid, rules.whole_panel, rules.max_distance_m)
    return np.flatnonzero(seen[:, 0] != NOT_SEEN)


def sortie_colours(sortie: NDArray[np.int64], look: Colours) -> Bytes:
    """Colours by number of sortie, shape (n, 4); the text's colour for -1."""
    table = np.stack([*(rgba(colour) for colour in SORTIES), rgba(look.text)])
    return np.asarray(table[np.where(sortie < 0, len(SORTIES), sortie % len(SORTIES))])


def _marks(
    views: ViewpointArrays,
    numbers: NDArray[np.int64],
    sortie: NDArray[np.int64],
    is_locked: NDArray[np.bool_],
    look: Colours,
) -> tuple[Drawable, ...]:
    """A dot for each of some viewpoints, and a short line to where it looks."""
    own = ViewpointArrays(*(part[numbers] for part in views))
    colours = sortie_colours(sortie[numbers], look)
    dots = np.arange(len(numbers))[:, None]
    parts = [
        Drawable(*sight_lines(own, SIGHT_M), colours, width_px=1.5),
        Drawable(own.positions_enu_m, dots, colours, width_px=5.0),
    ]
    held = np.flatnonzero(is_locked[numbers])
    if len(held):
        parts.append(Drawable(own.positions_enu_m, held[:, None], flat(look.text, len(held)), width_px=9.0))
    return tuple(parts)


def _route(
    number: int, path: Array, values: tuple[ColourScale, tuple[Array, ...]] | None, look: Colours
) -> tuple[Drawable, ...]:
    """The path of a sortie with arrowheads, in its colour or by values."""
    points, cells = polyline(path)
    if len(cells) == 0:
        return ()
    parts = []
    colours = flat(SORTIES[number % len(SORTIES)], len(cells))
    heads, triangles = arrows(path, ARROW_M)
    head_colours = flat(SORTIES[number % len(SORTIES)], len(triangles))
    if values is not None:
        scale, by_sortie = values
        if by_sortie[number].shape != (len(path),):
            raise ValueError(f"sortie {number + 1}: expected {len(path)} values, got {by_sortie[number].shape}")
        # The worse end decides a leg's colour: a leg is as near to something as its nearest end.
        legs = np.fmin(by_sortie[number][:-1], by_sortie[number][1:])
        colours = scale.colours(legs)
        # Some colours of a scale are as dark or as bright as the background.
        casing = flat(look.text, len(cells))
        parts.append(Drawable(points, cells, casing, width_px=5.0, depth_shift=CASING_SHIFT))
    parts.append(Drawable(points, cells, colours, width_px=2.5))
    if len(triangles):
        parts.append(Drawable(heads, triangles, head_colours))
    return tuple(parts)


def ends_of_sorties(paths: tuple[Array, ...]) -> list[tuple[Array, list[int], list[int]]]:
    """Places where sorties start or land: point, numbers of those that start there, of those that land there."""
    places: list[tuple[Array, list[int], list[int]]] = []
    for number, path in enumerate(paths, start=1):
        for end, role in ((0, 1), (-1, 2)):
            if len(path) == 0:
                continue
            point = path[end]
            place = next((known for known in places if np.linalg.norm(known[0] - point) < 1.0), None)
            if place is None:
                place = (point, [], [])
                places.append(place)
            (place[1] if role == 1 else place[2]).append(number)
    return places


BUILDING, OBSTACLE, NO_FLY, HOME, RALLY = "#aeb6bf", "#c98f5a", "#d64545", "#1d7a3c", "#7a4fa3"
"""Paler than panels; brown for what stands in the way, red for what is forbidden, green for home, violet for rally
points."""

GROUND_LIGHT, GROUND_DARK = "#dfe6d8", "#2e3630"
SHADOW_LIGHT, SHADOW_DARK = "#c6cec0", "#262c28"

SHADOW_NEARER = 5e-4
"""Part of its distance by which a shadow comes before the ground that it lies on: 5 cm at 100 m."""

MAX_SHADOW_TRIANGLES = 50_000
"""Of a mesh that casts one: a second drawing of more costs a processor in place of a graphics card too much."""

GLASS_DARKER, GLASS_LIGHTER = 0.88, 1.1
"""Brightness of panes at the foot and at the top of a facade, which mirror ground and sky."""

PANEL_EDGE = "#23415a"

LANDING_LABEL_M = 1.5
"""Height of the label above home and rally points."""

HOME_PAD_M = (1.2, 1.2, 0.25)
"""Half the width and the height of the pad that marks home: room for the aircraft with its propellers."""


ZONE_REACH_M = 300.0
"""Geo-zones are drawn so far beside the airspace: farther ones are on the map, and would only cost depth here."""

ZONE_SKY_M = 60.0
"""Zones that end higher than this above the airspace, and above where they begin, are drawn open at the top."""

KEPT_OPACITY, FREE_OPACITY = 0.16, 0.05
"""Of the faces of geo-zones that flights keep out of, and of the others."""

MAX_UPRIGHTS = 24
"""Outlines with more corners are curves, which have no upright edges."""


@dataclass(frozen=True, slots=True, eq=False)
class ZoneShape:
    """A geo-zone as it is drawn: cut to the surroundings of the airspace, open where it goes on.

    Parameters
    ----------
    lines
        What is said of it beside the pointer.
    volumes
        Between the heights that are drawn.
    """

    near: NearZone
    item: Item
    lines: tuple[str, ...]
    volumes: tuple[NoFlyZone, ...]

    @property
    def width_m2(self) -> float:
        """Area that it covers near the site."""
        return sum(float(each.area.area) for each in self.near.local.volumes)

    def triangles_enu_m(self) -> Array:
        """Faces, shape (t, 3, 3): walls, and lids where the zone ends."""
        parts = [np.zeros((0, 3, 3))]
        ends = {limit_m for each in self.near.local.volumes for limit_m in (each.floor_m, each.ceiling_m)}
        for volume in self.volumes:
            corners = volume.prism().corners_enu_m
            z = corners[..., 2]
            open_ends = [end_m for end_m in (volume.floor_m, volume.ceiling_m) if end_m not in ends]
            is_open = np.any([(z == end_m).all(axis=1) for end_m in open_ends], axis=0) if open_ends else False
            parts.append(corners[~np.broadcast_to(is_open, len(corners))])
        return np.concatenate(parts)

    def outline(self) -> Shape:
        """Lines around its volumes where they end or stand on the ground, and upright ones at corners."""
        pieces, tops = [], {each.ceiling_m for each in self.near.local.volumes}
        for volume in self.volumes:
            ring = np.array([*volume.polygon_enu_m, volume.polygon_enu_m[0]])
            low, high = (np.c_[ring, np.full(len(ring), z)] for z in (volume.floor_m, volume.ceiling_m))
            pieces += [polyline(low), *([polyline(high)] if volume.ceiling_m in tops else [])]
            if len(ring) <= MAX_UPRIGHTS:
                pieces += [polyline(np.stack(pair)) for pair in zip(low[:-1], high[:-1], strict=True)]
        return joined(pieces)


@dataclass(frozen=True, slots=True, eq=False)
class SiteScene:
    """A site ready to be drawn.

    Parameters
    ----------
    frames
        Of all panels.
    facade
        Number of the facade of each panel, shape (m,).
    drawables
        By layer; panels are separate because their colours change.
    zones
        Geo-zones that are drawn.
    """

    model: SiteModel
    frames: PanelFrames
    facade: NDArray[np.int64]
    panel_index: dict[str, int]
    drawables: dict[Layer, tuple[Drawable, ...]]
    labels: tuple[Label, ...]
    zones: tuple[ZoneShape, ...] = ()

    def extent(self) -> Array:
        """Points between which everything worth looking at lies, shape (n, 3): panels, building, obstacles, home."""
        places = [self.model.site.home_enu_m, *(point.position_enu_m for point in self.model.site.rally_points)]
        parts = [self.frames.corners.reshape(-1, 3), np.array(places)]
        for mesh in (self.model.building, *self.model.obstacles):
            if len(mesh.triangles):
                parts.append(mesh.vertices_enu_m[np.unique(mesh.triangles)])
        points = np.concatenate(parts)
        low, high = points.min(axis=0), points.max(axis=0)
        return box_edges(low, high)[0]


def site_scene(model: SiteModel, look: Colours) -> SiteScene:
    """Everything of a site but its panels' colours."""
    site = model.site
    frames, zones = panel_frames(panel_corners(site)), tuple(_zones(model))
    facade = np.repeat(np.arange(len(site.facades)), np.array([len(found.panels) for found in site.facades], np.int64))
    drawables = {
        Layer.GROUND: (_ground(model, look),),
        Layer.BUILDING: _solid(model.building, BUILDING),
        Layer.OBSTACLES: tuple(part for mesh in model.obstacles for part in _solid(mesh, OBSTACLE)),
        Layer.NO_FLY: tuple(_prism(zone.prism()) for zone in site.airspace.no_fly),
        Layer.ZONES: tuple(part for zone in zones for part in _zone_drawables(zone, look)),
        Layer.AIRSPACE: (_airspace(model, look),),
        Layer.HOME: _home(model),
        Layer.SHADOWS: _shadows(model, look),
    }
    panel_index = {panel.id: i for i, panel in enumerate(site.panels)}
    labels = (*_labels(model), *(_zone_label(zone, look) for zone in zones))
    return SiteScene(model, frames, facade, panel_index, drawables, labels, zones)


def surface_drawables(surfaces: Sequence[Surface]) -> tuple[Drawable, ...]:
    """What a virtual scene shows of walls or surroundings."""
    return tuple(map(_surface, surfaces))


def lifted(drawable: Drawable, share: float) -> Drawable:
    """Triangles on walls or panels, lifted off by a share of the way by which panels are drawn before walls."""
    normals = np.repeat(triangle_normals(TriangleMesh(drawable.points_enu_m, drawable.cells)), 3, axis=0)
    return replace(drawable, points_enu_m=drawable.points_enu_m + share * PANEL_OFFSET_M * normals)


def _surface(surface: Surface) -> Drawable:
    corners = surface.corners_enu_m
    mesh = TriangleMesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    colours = np.column_stack([surface.colours, np.full(len(corners), 255, np.uint8)])
    picture = None
    if surface.uv is not None and surface.picture is not None:
        picture = Picture(surface.picture, surface.uv)
    shades = shaded(colours, triangle_normals(mesh))
    return Drawable(mesh.vertices_enu_m, mesh.triangles, shades, picture=picture)


def facade_colours(facade: NDArray[np.int64]) -> NDArray[np.uint8]:
    """Colours of panels by the number of their facade, shape (m, 4)."""
    table = np.concatenate([flat(colour, 1) for colour in FACADES])
    return np.asarray(table[facade % len(FACADES)])


def glass_colours(frames: PanelFrames, facade: NDArray[np.int64]) -> NDArray[np.uint8]:
    """Colours of panes by facade, brighter upwards as glass is that mirrors the sky, shape (m, 4)."""
    colours = facade_colours(facade)
    if not len(frames):
        return colours
    heights = frames.centroids[:, 2]
    share = (heights - heights.min()) / max(float(np.ptp(heights)), 1e-9)
    brightness = GLASS_DARKER + (GLASS_LIGHTER - GLASS_DARKER) * share
    result = colours.copy()
    result[:, :3] = np.clip(np.rint(colours[:, :3] * brightness[:, None]), 0.0, 255.0).astype(np.uint8)
    return result


def panels_drawable(frames: PanelFrames, colours: NDArray[np.uint8]) -> Drawable:
    """All panels in one go, with colours of shape (m, 4)."""
    points, cells = quads(shown_panels(frames))
    return Drawable(points, cells, shaded(colours, frames.normals), edge_colour=PANEL_EDGE)


def _solid(mesh: TriangleMesh, colour: str) -> tuple[Drawable, ...]:
    n = len(mesh.triangles)
    if n == 0:
        return ()
    return (Drawable(mesh.vertices_enu_m, mesh.triangles, shaded(flat(colour, n), triangle_normals(mesh))),)


def _prism(mesh: TriangleMesh) -> Drawable:
    return Drawable(mesh.vertices_enu_m, mesh.triangles, flat(NO_FLY, len(mesh.triangles), 0.3))


def _zones(model: SiteModel) -> Iterator[ZoneShape]:
    """Geo-zones around the airspace, with what they are between its ground and its sky."""
    zones = tuple(near_zones(model))
    if not zones:
        return  # the window need not load what zones are cut with

    import shapely

    airspace = model.site.airspace
    (x0, y0, z0), (x1, y1, z1) = airspace.min_enu_m, airspace.max_enu_m
    around = shapely.box(x0 - ZONE_REACH_M, y0 - ZONE_REACH_M, x1 + ZONE_REACH_M, y1 + ZONE_REACH_M)
    ground_z_m = min(z0, airspace.ground_z_m)
    for near in zones:
        cut = []
        for each in near.local.volumes:
            area = each.area.intersection(around)
            floor_m = max(each.floor_m, ground_z_m)
            ceiling_m = min(each.ceiling_m, max(z1, floor_m) + ZONE_SKY_M)
            if not area.is_empty and floor_m < ceiling_m:
                cut.append(replace(each, area=area, floor_m=floor_m, ceiling_m=ceiling_m))
        volumes = prisms(replace(near.local, volumes=tuple(cut)), airspace)
        if volumes:
            yield ZoneShape(near, Item(ItemKind.ZONE, near.key), zone_lines(near, model), volumes)


def _zone_drawables(zone: ZoneShape, look: Colours) -> Iterator[Drawable]:
    colour = zone_colour(zone.near.local.zone.restriction, look)
    faces = zone.triangles_enu_m()
    n, opacity = len(faces), KEPT_OPACITY if zone.near.is_kept else FREE_OPACITY
    if n:
        yield Drawable(faces.reshape(-1, 3), np.arange(3 * n).reshape(n, 3), flat(colour, n, opacity))
    points, cells = zone.outline()
    yield Drawable(points, cells, flat(colour, len(cells)), width_px=2.0 if zone.near.is_kept else 1.0)


def _zone_label(zone: ZoneShape, look: Colours) -> Label:
    """Its name over the part of it that is nearest to the middle of the site."""
    import shapely

    middle = shapely.Point(0.0, 0.0)
    nearest = min(zone.volumes, key=lambda volume: float(shapely.Polygon(volume.polygon_enu_m).distance(middle)))
    area = shapely.Polygon(nearest.polygon_enu_m)
    place = area.representative_point() if area.area < ZONE_REACH_M**2 else shapely.ops.nearest_points(area, middle)[0]
    colour = zone_colour(zone.near.local.zone.restriction, look)
    return Label(zone.near.local.zone.name, (place.x, place.y, nearest.ceiling_m), Layer.ZONES, colour)


def _ground(model: SiteModel, look: Colours) -> Drawable:
    airspace, terrain = model.site.airspace, drawn_terrain(model.site)
    if terrain is not None:
        return _terrain(terrain, look)
    (x0, y0, _), (x1, y1, _), z = airspace.min_enu_m, airspace.max_enu_m, airspace.ground_z_m
    # A hand's breadth lower than the ground, so that floors that lie on it do not flicker.
    corners = np.array([[[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]]]) - [0.0, 0.0, 0.1]
    return Drawable(*quads(corners), flat(GROUND_DARK if look.is_dark else GROUND_LIGHT, 1))


def _terrain(terrain: HeightField, look: Colours) -> Drawable:
    """The surface with at most some `TERRAIN_CELLS` cells a side; nothing where it is not known."""
    every = max(1, -(-max(terrain.z_m.shape) // TERRAIN_CELLS))
    rows, columns = (np.unique(np.append(np.arange(0, n, every), n - 1)) for n in terrain.z_m.shape)
    part = np.ix_(rows, columns)
    points = np.concatenate([terrain.nodes_xy_m()[part], terrain.z_m[part][..., None]], axis=2)
    number = np.arange(len(rows) * len(columns)).reshape(len(rows), len(columns))
    a, b, c, d = (each.ravel() for each in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]))
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    points = points.reshape(-1, 3)
    triangles = triangles[np.isfinite(points[triangles]).all(axis=(1, 2))]
    # A hand's breadth lower, as level ground.
    surface = TriangleMesh(np.nan_to_num(points) - [0.0, 0.0, 0.1], triangles)
    colours = flat(GROUND_DARK if look.is_dark else GROUND_LIGHT, len(triangles))
    return Drawable(surface.vertices_enu_m, triangles, shaded(colours, triangle_normals(surface)))


def _shadows(model: SiteModel, look: Colours) -> tuple[Drawable, ...]:
    """Shadows of what stands on level ground, in the light that faces are shaded by: they show where things stand."""
    airspace = model.site.airspace
    if drawn_terrain(model.site) is not None:
        return ()
    low, high = np.array(airspace.min_enu_m[:2]), np.array(airspace.max_enu_m[:2])
    parts = []
    for mesh in (model.building, *model.obstacles):
        n = len(mesh.triangles)
        if 0 < n <= MAX_SHADOW_TRIANGLES:
            points, cells = shadow(mesh, SUN, airspace.ground_z_m - 0.1, low, high)
            colour = SHADOW_DARK if look.is_dark else SHADOW_LIGHT
            parts.append(Drawable(points, cells, flat(colour, n), nearer=SHADOW_NEARER))
    return tuple(parts)


def _airspace(model: SiteModel, look: Colours) -> Drawable:
    airspace = model.site.airspace
    points, cells = box_edges(np.array(airspace.min_enu_m), np.array(airspace.max_enu_m))
    return Drawable(points, cells, flat(look.muted, len(cells)))


def landing_pad(place_enu_m: Vec3) -> TriangleMesh:
    """The pad that marks home or a rally point."""
    x, y, z = place_enu_m
    width, depth, height = HOME_PAD_M
    return box_mesh(np.array([x - width, y - depth, z]), np.array([x + width, y + depth, z + height]))


def _home(model: SiteModel) -> tuple[Drawable, ...]:
    """Home and the rally points."""
    points = model.site.rally_points
    rally = (part for point in points for part in _landing(model, point.position_enu_m, RALLY))
    return (*_landing(model, model.site.home_enu_m, HOME), *rally)


def _landing(model: SiteModel, place_enu_m: Vec3, colour: str) -> tuple[Drawable, ...]:
    """A pad on the ground, and the column in which the aircraft climbs to the airspace or comes down from it."""
    x, y, z = place_enu_m
    pad, ends = landing_pad(place_enu_m), np.array([[x, y, z], [x, y, max(model.site.airspace.min_enu_m[2], z + 2.0)]])
    mark = Drawable(pad.vertices_enu_m, pad.triangles, shaded(flat(colour, len(pad.triangles)), triangle_normals(pad)))
    return mark, Drawable(ends, np.array([[0, 1]]), flat(colour, 1), width_px=3.0)


def _labels(model: SiteModel) -> tuple[Label, ...]:
    """Names of obstacles, zones and rally points; home is labelled by the view, in the user's language."""
    site, labels = model.site, []
    for obstacle, mesh in zip(site.obstacles, model.obstacles, strict=True):
        if len(mesh.triangles):
            labels.append(Label(obstacle.id, _top(mesh.vertices_enu_m), Layer.OBSTACLES, OBSTACLE))
    for zone in site.airspace.no_fly:
        x, y = np.mean(zone.polygon_enu_m, axis=0)
        labels.append(Label(zone.id, (float(x), float(y), zone.ceiling_m), Layer.NO_FLY, NO_FLY))
    for point in site.rally_points:
        x, y, z = point.position_enu_m
        labels.append(Label(point.id, (x, y, z + LANDING_LABEL_M), Layer.HOME, RALLY))
    return tuple(labels)


def _top(vertices_enu_m: Array) -> tuple[float, float, float]:
    low, high = vertices_enu_m.min(axis=0), vertices_enu_m.max(axis=0)
    x, y = 0.5 * (low + high)[:2]
    return float(x), float(y), float(high[2])
