"""Areas of GeoJSON (RFC 7946) with the layers and circles of ED-318, and plain GeoJSON files, which say only where.

Plain files name no restriction: their areas count as prohibited from the ground up until the pilot says otherwise.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from planning.base.errors import InputError
from planning.base.messages import say
from planning.geo.crs import names_wgs84
from planning.site.zones.fields import Asked, Fields, quoted
from planning.site.zones.heights import EVERYWHERE_BELOW, limit
from planning.site.zones.records import (
    UNLIMITED,
    Circle,
    Limit,
    LonLat,
    Outline,
    Restriction,
    Volume,
    Zone,
    ZoneSet,
)

MAX_NESTED = 8
"""Collections in collections; RFC 7946 advises against any."""

POINT_WIDTH_M = 50.0
"""Half the width that points and lines are given, which have none: the narrowest zones along roads and rails."""

MAX_RADIUS_M = 5_000_000.0
"""Larger circles are no zones but mistakes."""

NOT_AREAS = ("Point", "MultiPoint", "LineString", "MultiLineString")

_GEOMETRY_FIELDS = ("type", "coordinates", "geometries", "layer", "extent", "bbox", "crs")
_LAYER_FIELDS = ("upper", "upperReference", "lower", "lowerReference", "uom")

NO_MEANING = say("the file says where this is, but not what it means; until you say, it counts as prohibited")


def position(value: Any) -> LonLat | None:
    """A position of GeoJSON; None where it is none on earth. Longitudes may go on beyond 180 degrees."""
    if not (isinstance(value, list) and len(value) >= 2):
        return None
    lon, lat = value[0], value[1]
    if isinstance(lon, bool) or isinstance(lat, bool):
        return None
    if not (isinstance(lon, int | float) and isinstance(lat, int | float)):
        return None
    if not (math.isfinite(lon) and math.isfinite(lat) and abs(lon) <= 360.0 and abs(lat) <= 90.0):
        return None
    return float(lon), float(lat)


def ring(value: Any, questions: list[str]) -> tuple[LonLat, ...]:
    """Positions of a list, without those that are none, which are asked about."""
    values = value if isinstance(value, list) else []
    found = [position(each) for each in values]
    n_wrong = sum(each is None for each in found)
    swapped = [position([each[1], each[0], *each[2:]]) for each in values if isinstance(each, list) and len(each) >= 2]
    if n_wrong and len(swapped) == len(values) and None not in swapped:
        questions.append(say("an outline lies on earth only if latitude and longitude are exchanged"))
    elif n_wrong:
        questions.append(say("{} of {} corners of an outline are no places on earth", n_wrong, len(found)))
    return tuple(each for each in found if each is not None)


def circle(centre: Any, radius: float | None, questions: list[str]) -> Circle | None:
    """A circle from a position and a radius in metres; None, with a question, where it is none."""
    at = position(centre)
    if at is None or radius is None or not 0.0 < radius <= MAX_RADIUS_M:
        questions.append(say("a circle has no centre or no radius that can be used"))
        return None
    return Circle(at, radius)


def outlines(kind: str, coordinates: Any, questions: list[str]) -> list[Outline]:
    """Areas of the coordinates of a `Polygon` or `MultiPolygon`; what is none is asked about."""
    polygons = coordinates if kind == "MultiPolygon" else [coordinates]
    found = []
    for polygon in polygons if isinstance(polygons, list) else []:
        before = len(questions)
        rings = [ring(each, questions) for each in polygon] if isinstance(polygon, list) else []
        if rings and rings[0]:
            # A hole of which a corner is missing may be too large.
            holes = tuple(each for each in rings[1:] if len(each) > 3) if len(questions) == before else ()
            found.append(Outline(rings[0], holes, 0.0 if len(questions) == before else POINT_WIDTH_M))
        else:
            questions.append(say("an area has no outline that can be read"))
    if not found and len(questions) == 0:
        questions.append(say("an area has no outline that can be read"))
    return found


def volumes(geometry: Any, asked: Asked, layer: Any = None, nested: int = 0) -> list[Volume]:
    """Volumes of a geometry of GeoJSON, with the layers and circles of ED-318.

    Parameters
    ----------
    asked
        What cannot be read is added.
    layer
        That of the collection it stands in, for geometries without one.
    """
    places = asked.places
    fields = Fields(geometry, "geometry", places)
    fields.ask_about_others(_GEOMETRY_FIELDS)
    layer, kind = fields.values.get("layer", layer), fields.text("type")
    if kind == "GeometryCollection":
        if nested >= MAX_NESTED:
            places.append(say("collections of areas are nested too deeply"))
            return []
        parts = fields.items("geometries")
        if not parts:
            places.append(say("an area has no outline that can be read"))
        return [volume for part in parts for volume in volumes(part, asked, layer, nested + 1)]
    lower, upper = _layer(layer, asked.questions)
    areas: list[Outline | Circle] = []
    coordinates = fields.values.get("coordinates")
    if kind in ("Polygon", "MultiPolygon"):
        areas += outlines(kind, coordinates, places)
    elif kind == "Point" and fields.has("extent"):
        extent = Fields(fields.values["extent"], "extent", places)
        if extent.text("subType") != "Circle" or extent.ask_about_others(("subType", "radius")):
            extent.ask("extent", extent.values)
        found = circle(coordinates, extent.number("radius"), places)
        areas += [] if found is None else [found]
    elif kind in NOT_AREAS:
        points = _flat(coordinates, places)
        asked.widths.append(say("a {} has no width; it counts with {:.0f} m to each side", kind, POINT_WIDTH_M))
        areas += [Outline(points, tolerance_m=POINT_WIDTH_M)] if points else []
    elif isinstance(geometry, dict):
        fields.ask("type", kind)
    return [Volume(area, lower, upper) for area in areas]


def _flat(coordinates: Any, questions: list[str]) -> tuple[LonLat, ...]:
    """All positions in lists of lists."""
    level, found = [coordinates], list[LonLat]()
    for _ in range(4):
        deeper: list[Any] = []
        for value in level:
            at = position(value)
            if at is not None:
                found.append(at)
            elif isinstance(value, list) and value and isinstance(value[0], list):
                deeper += value
            else:
                questions.append(say("{} of {} corners of an outline are no places on earth", 1, len(level)))
        level = deeper
    return tuple(found)


def _layer(value: Any, questions: list[str]) -> tuple[Limit, Limit]:
    """Lower and upper limit of a layer; without one an area reaches from the ground to the sky."""
    if value is None:
        return EVERYWHERE_BELOW, UNLIMITED
    fields = Fields(value, "layer", questions)
    unit = fields.text("uom") or "m"
    if fields.ask_about_others(_LAYER_FIELDS):
        return EVERYWHERE_BELOW, UNLIMITED
    lower = limit(
        fields.number("lower"),
        unit,
        fields.text("lowerReference"),
        questions,
        is_lower=True,
        is_stated="lower" in fields.values,
    )
    upper = limit(
        fields.number("upper"),
        unit,
        fields.text("upperReference"),
        questions,
        is_lower=False,
        is_stated="upper" in fields.values,
    )
    return lower, upper


def check_reference_system(content: Any, path: Path) -> None:
    """Refuse numbers that are no degrees of WGS 84: read as such, their zones would lie elsewhere, and count as clear.

    Older GeoJSON (2008) may name another system by `crs`, of the whole, of a feature or of a geometry.

    Raises
    ------
    InputError
        Another system is named, or one by what is no name.
    """
    level = [content]
    for _ in range(MAX_NESTED + 3):
        level = [each for each in level if isinstance(each, dict)]
        for each in level:
            system = each.get("crs")
            if system is None:
                continue
            properties = system.get("properties") if isinstance(system, dict) else None
            name = properties.get("name") if isinstance(properties, dict) else None
            if not (isinstance(name, str) and names_wgs84(name)):
                raise InputError.say(
                    "its coordinates are in the reference system {}; export it in WGS 84 (EPSG:4326)",
                    quoted(name if isinstance(name, str) else system),
                    place=path,
                )
        parts = [each.get(name) for each in level for name in ("features", "geometries")]
        level = [each.get("geometry") for each in level]
        level += [part for several in parts if isinstance(several, list) for part in several]


def features_of(content: Any) -> list[Any]:
    """Features of a GeoJSON object: a collection's, one alone, or a bare geometry as one."""
    if not isinstance(content, dict):
        return []
    if content.get("type") == "FeatureCollection" or isinstance(content.get("features"), list):
        features = content.get("features")
        return features if isinstance(features, list) else []
    if content.get("type") == "Feature":
        return [content]
    return [{"type": "Feature", "geometry": content, "properties": None}] if "type" in content else []


def recognises(content: Any) -> bool:
    """Whether parsed JSON is GeoJSON."""
    kinds = (*NOT_AREAS, "Polygon", "MultiPolygon", "GeometryCollection", "Feature", "FeatureCollection")
    return isinstance(content, dict) and content.get("type") in kinds


def read(content: Any, path: Path) -> ZoneSet:
    """Zones of plain GeoJSON, parsed; `path` names zones that have no name.

    Raises
    ------
    InputError
        Its coordinates are no degrees of WGS 84.
    """
    check_reference_system(content, path)
    zones = []
    for number, feature in enumerate(features_of(content), 1):
        asked = Asked([NO_MEANING])
        fields = Fields(feature, "feature", asked.questions)
        properties = fields.values.get("properties")
        named = Fields(properties if isinstance(properties, dict) else {}, "properties", [])
        name = named.text("name") or named.text("title") or named.text("Name") or f"{path.stem} {number}"
        found = volumes(fields.values.get("geometry"), asked)
        zones.append(
            Zone(
                id=fields.text("id") or named.text("id") or name,
                name=name,
                restriction=Restriction.UNKNOWN,
                message=named.text("description"),
                volumes=tuple(found),
                **asked.of_zone(),
            )
        )
    return ZoneSet("GeoJSON", tuple(zones))
