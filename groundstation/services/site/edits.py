"""Edits of a site: each takes a `SiteModel` and returns the new one, with the checksum of the file it would make.

The model given stays as it was. Values that no site may have are refused with an `InputError` that begins with the
field; what makes a site merely useless for a flight is left to `site_findings`, so that drawing is never interrupted.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from enum import StrEnum

import numpy as np

from groundstation.services.project.document import first_free
from planning.base.errors import InputError
from planning.base.messages import say
from planning.geo.frames import Origin, Vec3
from planning.geo.geoid import amsl_from_ellipsoid_m, ellipsoid_from_amsl_m
from planning.geo.mesh import TriangleMesh
from planning.site.file import site_sha256
from planning.site.records import NoFlyZone, Obstacle, RallyPoint, Site, SiteModel, box_geometry

COORDINATE_DECIMALS = 3
"""Of what is drawn by hand: 1 mm."""

HEIGHT_DECIMALS = 4
"""Of heights converted between references, as in imported sites."""


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
    """Same building, and the same obstacle meshes unless others are given, with another site record."""
    meshes = model.obstacles if obstacles is None else obstacles
    return SiteModel(site, model.building, meshes, site_sha256(site))


def _rounded(point: Sequence[float]) -> Vec3:
    x, y, z = (round(float(value), COORDINATE_DECIMALS) + 0.0 for value in point)
    return x, y, z


def index_of(ids: Iterable[str], wanted: str, kind: str) -> int:
    """Where an identifier stands; `ValueError` where it does not."""
    for index, found in enumerate(ids):
        if found == wanted:
            return index
    raise ValueError(f"there is no {kind} '{wanted}' on this site")


def check_new_name(name: str, taken: Iterable[str], kind: str) -> None:
    """Raise `InputError` unless `name` says something and is free."""
    if not name.strip():
        raise InputError(say("name: expected a name for the {}, got an empty text", kind))
    if name in taken:
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
    taken = set(obstacle_ids(model))
    obstacle_id = name if name not in taken else first_free(lambda number: f"{name}-{number + 1}", taken)
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
        site = replace(
            model.site, home_enu_m=_rounded((east, north, model.site.airspace.ground_z_m if on_ground else up))
        )
    return with_site(model, site)


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
        place = _rounded((east, north, model.site.airspace.ground_z_m if on_ground else up))
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
        There is no such place.
    """
    origin = origin_at(lat_deg, lon_deg, height_m, reference)
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
