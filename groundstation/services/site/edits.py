"""Edits of a site: each takes a `SiteModel` and returns the new one, with the checksum of the file it would make.

The model given stays as it was. Values that no site may have are refused with an `InputError` that begins with the
field; what makes a site merely useless for a flight is left to `site_findings`, so that drawing is never interrupted.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from enum import StrEnum
from typing import NamedTuple, TypeVar

import numpy as np

from groundstation.services.project.document import Item, ItemKind, first_free
from planning.base.errors import InputError
from planning.base.messages import say
from planning.geo.enu import enu_from_geodetic
from planning.geo.frames import Origin, Vec3
from planning.geo.geoid import amsl_from_ellipsoid_m, ellipsoid_from_amsl_m
from planning.geo.mesh import TriangleMesh
from planning.site.bundled import Rectangle
from planning.site.file import site_sha256
from planning.site.ground import height_at
from planning.site.importing.facades import facade_name
from planning.site.importing.options import ImportOptions
from planning.site.importing.panel_grid import panels_on_building
from planning.site.records import Facade, NoFlyZone, Obstacle, Panel, RallyPoint, Site, SiteModel, box_geometry

COORDINATE_DECIMALS = 3
"""Of what is drawn by hand: 1 mm."""

HEIGHT_DECIMALS = 4
"""Of heights converted between references, as in imported sites."""


FARTHEST_PICK_M = 20_000.0
"""From the site origin to a place that is picked on the map: sites have no coordinates beyond."""


class HeightReference(StrEnum):
    """What a height is measured from: the WGS 84 ellipsoid, or mean sea level by EGM96."""

    ELLIPSOID = "ellipsoid"
    SEA_LEVEL = "sea level"


@contextmanager
def input_checked() -> Iterator[None]:
    """Turn the records' own refusals into the user's mistakes, which they are here."""
    try:
        yield
    except ValueError as error:
        raise InputError(str(error)) from error


def _check_extent(low_enu_m: Sequence[float], high_enu_m: Sequence[float]) -> None:
    for axis, low, high in zip(("east", "north", "up"), low_enu_m, high_enu_m, strict=True):
        if not low < high:
            raise InputError(
                say("expected the first value below the second, got {:g} m and {:g} m", low, high, place=axis)
            )


def with_site(model: SiteModel, site: Site, obstacles: tuple[TriangleMesh, ...] | None = None) -> SiteModel:
    """Same building and geo-zones, and the same obstacle meshes unless others are given, with another site record."""
    meshes = model.obstacles if obstacles is None else obstacles
    return replace(model, site=site, obstacles=meshes, sha256=site_sha256(site))


def _rounded(point: Sequence[float]) -> Vec3:
    x, y, z = (round(float(value), COORDINATE_DECIMALS) + 0.0 for value in point)
    return x, y, z


def index_of(ids: Iterable[str], identifier: str, kind: str) -> int:
    """Where an identifier stands; `ValueError` where it does not."""
    for index, found in enumerate(ids):
        if found == identifier:
            return index
    raise ValueError(f"there is no {kind} '{identifier}' on this site")


def check_new_name(name: str, used: Iterable[str], kind: str) -> None:
    """Raise `InputError` unless `name` says something and is free."""
    if not name.strip():
        raise InputError(say("name: expected a name for the {}, got an empty text", kind))
    if name in used:
        raise InputError(say("name: there is a {} '{}' already; choose another name", kind, name))


def obstacle_ids(model: SiteModel) -> list[str]:
    """Identifiers of all obstacles, in order."""
    return [obstacle.id for obstacle in model.site.obstacles]


def add_box(model: SiteModel, low_enu_m: Vec3, high_enu_m: Vec3) -> tuple[SiteModel, str]:
    """With one more obstacle, a box between two opposite corners in any order; returns its name as well.

    Raises
    ------
    InputError
        The box has no volume, or is too far away.
    """
    name = first_free(lambda number: f"box-{number}", set(obstacle_ids(model)))
    low, high = np.minimum(low_enu_m, high_enu_m), np.maximum(low_enu_m, high_enu_m)
    with input_checked():
        obstacle = Obstacle(name, box_enu_m=(_rounded(low.tolist()), _rounded(high.tolist())))
    return _with_obstacle(model, obstacle, box_geometry(obstacle)), name


def add_mesh_obstacle(model: SiteModel, name: str, mesh: TriangleMesh) -> tuple[SiteModel, str]:
    """With one more obstacle from a mesh in local ENU metres, called `name` or like it; returns its name as well."""
    used = set(obstacle_ids(model))
    obstacle_id = name if name not in used else first_free(lambda number: f"{name}-{number + 1}", used)
    files = {found for found in (model.site.building_mesh, *(o.mesh for o in model.site.obstacles)) if found}
    file = first_free(lambda number: f"{name}.ply" if number == 1 else f"{name}-{number}.ply", files)
    return _with_obstacle(model, Obstacle(obstacle_id, mesh=file), mesh), obstacle_id


def _with_obstacle(model: SiteModel, obstacle: Obstacle, mesh: TriangleMesh) -> SiteModel:
    site = replace(model.site, obstacles=(*model.site.obstacles, obstacle))
    return with_site(model, site, (*model.obstacles, mesh))


def set_box(model: SiteModel, obstacle_id: str, low_enu_m: Vec3, high_enu_m: Vec3) -> SiteModel:
    """With another box for an obstacle that is one; `low_enu_m` is its minimum corner.

    Raises
    ------
    InputError
        The box has no volume, or is too far away.
    """
    index = index_of(obstacle_ids(model), obstacle_id, "obstacle")
    if model.site.obstacles[index].box_enu_m is None:
        raise ValueError(f"obstacle '{obstacle_id}' is a mesh, not a box")
    _check_extent(low_enu_m, high_enu_m)
    with input_checked():
        obstacle = Obstacle(obstacle_id, box_enu_m=(low_enu_m, high_enu_m))
    obstacles, meshes = list(model.site.obstacles), list(model.obstacles)
    obstacles[index], meshes[index] = obstacle, box_geometry(obstacle)
    return with_site(model, replace(model.site, obstacles=tuple(obstacles)), tuple(meshes))


def with_zones(model: SiteModel, zones: Iterable[NoFlyZone]) -> SiteModel:
    """With other no-fly zones."""
    airspace = replace(model.site.airspace, no_fly=tuple(zones))
    return with_site(model, replace(model.site, airspace=airspace))


def add_zone(model: SiteModel, polygon_enu_m: Sequence[tuple[float, float]]) -> tuple[SiteModel, str]:
    """With one more no-fly zone, from the ground to the airspace's ceiling; returns its name as well.

    Raises
    ------
    InputError
        The polygon has fewer than three corners, crosses itself or has no area.
    """
    airspace = model.site.airspace
    name = first_free(lambda number: f"no-fly-{number}", {zone.id for zone in airspace.no_fly})
    corners = tuple(_rounded((x, y, 0.0))[:2] for x, y in polygon_enu_m)
    with input_checked():
        zone = NoFlyZone(name, corners, min(airspace.ground_z_m, airspace.min_enu_m[2]), airspace.max_enu_m[2])
    return with_zones(model, (*airspace.no_fly, zone)), name


def set_zone(
    model: SiteModel, zone_id: str, polygon_enu_m: tuple[tuple[float, float], ...], floor_m: float, ceiling_m: float
) -> SiteModel:
    """With another shape for a no-fly zone.

    Raises
    ------
    InputError
        As `add_zone`, or the ceiling is not above the floor.
    """
    zones = list(model.site.airspace.no_fly)
    index = index_of((zone.id for zone in zones), zone_id, say("no-fly zone"))
    with input_checked():
        zones[index] = NoFlyZone(zone_id, polygon_enu_m, floor_m, ceiling_m)
    return with_zones(model, zones)


def set_airspace(model: SiteModel, min_enu_m: Vec3, max_enu_m: Vec3, ground_z_m: float) -> SiteModel:
    """With another airspace box and ground height; the no-fly zones stay.

    Raises
    ------
    InputError
        The box is empty, or too far away.
    """
    _check_extent(min_enu_m, max_enu_m)
    with input_checked():
        airspace = replace(model.site.airspace, min_enu_m=min_enu_m, max_enu_m=max_enu_m, ground_z_m=ground_z_m)
    return with_site(model, replace(model.site, airspace=airspace))


def move_home(model: SiteModel, home_enu_m: Vec3, *, on_ground: bool = False) -> SiteModel:
    """With another take-off place, put on the ground where wanted.

    Raises
    ------
    InputError
        The place is too far away.
    """
    east, north, up = home_enu_m
    with input_checked():
        height_m = height_at(model.site, east, north) if on_ground else up
        site = replace(model.site, home_enu_m=_rounded((east, north, height_m)))
    return with_site(model, site)


def ground_at(model: SiteModel, lat_deg: float, lon_deg: float) -> Vec3:
    """Local point on the site's ground at a place on earth.

    Raises
    ------
    InputError
        The place is further from the site origin than anything on a site.
    """
    origin, ground_z_m = model.site.origin, model.site.airspace.ground_z_m
    with input_checked():
        height_m = origin.ellipsoid_height_m + ground_z_m
        east_m, north_m, _ = enu_from_geodetic(origin, lat_deg, lon_deg, height_m)[0]
    if math.hypot(east_m, north_m) > FARTHEST_PICK_M:
        raise InputError.say(
            "this place is {:.0f} km from the site; move the site origin there first",
            math.hypot(east_m, north_m) / 1000.0,
        )
    return float(east_m), float(north_m), ground_z_m


def rally_ids(model: SiteModel) -> list[str]:
    """Identifiers of all rally points, in order."""
    return [point.id for point in model.site.rally_points]


def with_rally_points(model: SiteModel, points: Iterable[RallyPoint]) -> SiteModel:
    """With other rally points."""
    return with_site(model, replace(model.site, rally_points=tuple(points)))


def add_rally_point(model: SiteModel, position_enu_m: Vec3) -> tuple[SiteModel, str]:
    """With one more rally point; returns its name as well.

    Raises
    ------
    InputError
        The place is too far away.
    """
    name = first_free(lambda number: f"rally-{number}", set(rally_ids(model)))
    with input_checked():
        point = RallyPoint(name, _rounded(position_enu_m))
    return with_rally_points(model, (*model.site.rally_points, point)), name


def move_rally_point(model: SiteModel, point_id: str, position_enu_m: Vec3, *, on_ground: bool = False) -> SiteModel:
    """With a rally point elsewhere, put on the ground where wanted.

    Raises
    ------
    InputError
        The place is too far away.
    """
    points = list(model.site.rally_points)
    index = index_of(rally_ids(model), point_id, say("rally point"))
    east, north, up = position_enu_m
    with input_checked():
        place = _rounded((east, north, height_at(model.site, east, north) if on_ground else up))
        points[index] = RallyPoint(point_id, place)
    return with_rally_points(model, points)


def rename_site(model: SiteModel, name: str) -> SiteModel:
    """With another name.

    Raises
    ------
    InputError
        The name is empty.
    """
    if name.strip() == model.site.name:
        return model
    check_new_name(name, (), "site")
    return with_site(model, replace(model.site, name=name.strip()))


def set_origin(
    model: SiteModel, lat_deg: float, lon_deg: float, height_m: float, reference: HeightReference
) -> SiteModel:
    """With the local frame's zero at another place on earth; everything on the site moves along.

    Raises
    ------
    InputError
        There is no such place, or the site has terrain, which would not move along.
    """
    origin = origin_at(lat_deg, lon_deg, height_m, reference)
    if model.site.terrain is not None and origin != model.site.origin:
        raise InputError.say(
            "the terrain of the site was made for the place where it is, and would lie wrong elsewhere; take it off "
            "first ('site terrain --remove'), and attach it again after the move"
        )
    return with_site(model, replace(model.site, origin=origin, place_from=""))


def origin_at(lat_deg: float, lon_deg: float, height_m: float, reference: HeightReference) -> Origin:
    """Origin from a height in either reference; see `set_origin`."""
    with input_checked():
        ellipsoid = height_m
        if reference is HeightReference.SEA_LEVEL:
            ellipsoid = round(float(ellipsoid_from_amsl_m(lat_deg, lon_deg, height_m)), HEIGHT_DECIMALS)
        return Origin(lat_deg, lon_deg, ellipsoid)


def height_above_sea_m(origin: Origin) -> float:
    """Height of an origin above mean sea level (EGM96), metres."""
    altitude = amsl_from_ellipsoid_m(origin.lat_deg, origin.lon_deg, origin.ellipsoid_height_m)
    return round(float(altitude), HEIGHT_DECIMALS)


# Edits of a site's glass: a grid of panels on the building, a facade turned round.


class AddedGrid(NamedTuple):
    """A site with one facade more, the facade's name, and what is worth knowing about its panels."""

    model: SiteModel
    facade_id: str
    notes: tuple[str, ...]


def add_panel_grid(
    model: SiteModel,
    rectangle_enu_m: Rectangle,
    n_rows: int,
    n_columns: int,
    gap_m: float = 0.0,
    tolerance_m: float = ImportOptions().grid_tolerance_m,
) -> AddedGrid:
    """With one facade more, of equal panels in a rectangle on the building.

    Parameters
    ----------
    rectangle_enu_m
        Lower left, lower right and upper left corner as seen from outside.
    gap_m
        Width of the mullions between neighbouring panels.
    tolerance_m
        Largest distance of the panels from the building.

    Raises
    ------
    PanelGridError
        As `planning.site.importing.panel_grid.panels_on_building`.
    InputError
        A panel would be no panel, such as one too far away.
    """
    found = panels_on_building(np.array(rectangle_enu_m), (n_rows, n_columns), gap_m, model.building, tolerance_m)
    name = _free_facade_name(model.site)
    with input_checked():
        panels = tuple(
            Panel(f"{name}-{number:04d}", (_corner(a), _corner(b), _corner(c), _corner(d)))
            for number, (a, b, c, d) in enumerate(found.corners.tolist())
        )
        site = replace(model.site, facades=(*model.site.facades, Facade(name, panels)))
    return AddedGrid(with_site(model, site), name, found.notes)


def _corner(point: Sequence[float]) -> Vec3:
    """A corner rounded to 0.1 mm, as in imported sites."""
    x, y, z = (round(value, 4) for value in point)
    return x, y, z


def _free_facade_name(site: Site) -> str:
    """The first letter that neither a facade nor the panels of a renamed one use."""
    used = {facade.id for facade in site.facades} | {panel.id.rpartition("-")[0] for panel in site.panels}
    return first_free(lambda number: facade_name(number - 1), used)


def with_facades(model: SiteModel, facades: Iterable[Facade]) -> SiteModel:
    """With other facades.

    Raises
    ------
    InputError
        No panel is left, and there is no building on which others could be found.
    """
    kept = tuple(facades)
    if model.site.building_mesh is None and not any(facade.panels for facade in kept):
        raise InputError(
            say("panels: a site without a building needs at least one panel; add the new ones first, then remove these")
        )
    with input_checked():
        site = replace(model.site, facades=kept)
    return with_site(model, site)


def flip_facade(model: SiteModel, facade_id: str) -> SiteModel:
    """With a facade that looks the other way; each panel still begins at its lower left corner seen from outside."""

    def flipped(panel: Panel) -> Panel:
        a, b, c, d = panel.corners_enu_m
        return replace(panel, corners_enu_m=(b, a, d, c))

    index = index_of((facade.id for facade in model.site.facades), facade_id, "facade")
    facades = list(model.site.facades)
    facades[index] = replace(facades[index], panels=tuple(flipped(panel) for panel in facades[index].panels))
    return with_facades(model, facades)


# Removing and renaming what a user points at on a site.

Named = TypeVar("Named", Obstacle, NoFlyZone, Panel, RallyPoint)

REMOVABLE = frozenset({ItemKind.OBSTACLE, ItemKind.NO_FLY, ItemKind.FACADE, ItemKind.PANEL, ItemKind.RALLY})
"""Kinds of things that have a name of their own and that a site can do without."""


def remove_item(model: SiteModel, item: Item) -> SiteModel:
    """Without a facade, panel, obstacle, no-fly zone or rally point.

    Raises
    ------
    InputError
        The site would be left without panels and building.
    ValueError
        The site has no such thing, or it is of a kind that cannot be removed.
    """
    site = model.site
    match item.kind:
        case ItemKind.OBSTACLE:
            index = index_of(obstacle_ids(model), item.id, "obstacle")
            obstacles = site.obstacles[:index] + site.obstacles[index + 1 :]
            return with_site(
                model, replace(site, obstacles=obstacles), model.obstacles[:index] + model.obstacles[index + 1 :]
            )
        case ItemKind.NO_FLY:
            index = index_of((zone.id for zone in site.airspace.no_fly), item.id, say("no-fly zone"))
            return with_zones(model, site.airspace.no_fly[:index] + site.airspace.no_fly[index + 1 :])
        case ItemKind.FACADE:
            index = index_of((facade.id for facade in site.facades), item.id, "facade")
            return with_facades(model, site.facades[:index] + site.facades[index + 1 :])
        case ItemKind.PANEL:
            index = _facade_of(site, item.id)
            rest = tuple(panel for panel in site.facades[index].panels if panel.id != item.id)
            facade = (replace(site.facades[index], panels=rest),) if rest else ()
            return with_facades(model, site.facades[:index] + facade + site.facades[index + 1 :])
        case ItemKind.RALLY:
            index = index_of(rally_ids(model), item.id, say("rally point"))
            return with_rally_points(model, site.rally_points[:index] + site.rally_points[index + 1 :])
        case _:
            raise ValueError(f"a site always has its {item.kind}")


def rename_item(model: SiteModel, item: Item, name: str) -> SiteModel:
    """With another name for what has one; panels called after their facade follow it.

    Raises
    ------
    InputError
        The name is empty or taken.
    ValueError
        The site has no such thing, or it is of a kind that has no name.
    """
    name, site = name.strip(), model.site
    if name == item.id:
        return model
    match item.kind:
        case ItemKind.OBSTACLE:
            check_new_name(name, obstacle_ids(model), "obstacle")
            return with_site(model, replace(site, obstacles=_renamed(site.obstacles, item.id, name, "obstacle")))
        case ItemKind.NO_FLY:
            check_new_name(name, (zone.id for zone in site.airspace.no_fly), say("no-fly zone"))
            return with_zones(model, _renamed(site.airspace.no_fly, item.id, name, say("no-fly zone")))
        case ItemKind.FACADE:
            check_new_name(name, (facade.id for facade in site.facades), "facade")
            index = index_of((facade.id for facade in site.facades), item.id, "facade")
            facade = Facade(name, tuple(_following(panel, item.id, name) for panel in site.facades[index].panels))
            return with_facades(model, (*site.facades[:index], facade, *site.facades[index + 1 :]))
        case ItemKind.PANEL:
            check_new_name(name, (panel.id for panel in site.panels), "panel")
            index = _facade_of(site, item.id)
            panels = _renamed(site.facades[index].panels, item.id, name, "panel")
            facade = replace(site.facades[index], panels=panels)
            return with_facades(model, (*site.facades[:index], facade, *site.facades[index + 1 :]))
        case ItemKind.RALLY:
            check_new_name(name, rally_ids(model), say("rally point"))
            return with_rally_points(model, _renamed(site.rally_points, item.id, name, say("rally point")))
        case _:
            raise ValueError(f"the {item.kind} of a site has no name")


def _renamed(things: tuple[Named, ...], old: str, new: str, kind: str) -> tuple[Named, ...]:
    index = index_of((thing.id for thing in things), old, kind)
    return things[:index] + (replace(things[index], id=new),) + things[index + 1 :]  # noqa: RUF005  (mypy)


def _following(panel: Panel, old: str, new: str) -> Panel:
    """The panel with its facade's new name, where it bears the old one."""
    rest = panel.id.removeprefix(f"{old}-")
    return panel if rest == panel.id else replace(panel, id=f"{new}-{rest}")


def _facade_of(site: Site, panel_id: str) -> int:
    for index, facade in enumerate(site.facades):
        if any(panel.id == panel_id for panel in facade.panels):
            return index
    raise ValueError(f"there is no panel '{panel_id}' on this site")
