"""Files of geo-zones about a site, in every format, and what a flight on it finds; all made here, none is real."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from planning.geo.enu import geodetic_from_enu
from planning.geo.frames import Origin
from planning.site.records import Airspace, Site, SiteModel
from planning.site.zones.keep_out import site_zones
from planning.site.zones.records import LonLat, ZoneFile
from tests.planning.plan_cases import kiosk

ORIGIN = Origin(47.0, 8.0, 500.0)

ALWAYS = [{"permanent": "YES"}]


def lon_lat(points: list[tuple[float, float]], origin: Origin = ORIGIN) -> list[list[float]]:
    """Longitudes and latitudes of local places."""
    found = geodetic_from_enu(origin, [(x, y, 0.0) for x, y in points])
    return [[float(lon), float(lat)] for lon, lat in zip(found.lon_deg, found.lat_deg, strict=True)]


def square(x: float, y: float, half_m: float, origin: Origin = ORIGIN) -> list[list[float]]:
    """Closed ring of a square about a local place."""
    corners = [(x - half_m, y - half_m), (x + half_m, y - half_m), (x + half_m, y + half_m), (x - half_m, y + half_m)]
    return lon_lat([*corners, corners[0]], origin)


def ed269_volume(projection: dict[str, Any], lower: Any = 0, upper: Any = 120, above: str = "AGL") -> dict[str, Any]:
    """A volume."""
    return {
        "uomDimensions": "M",
        "lowerLimit": lower,
        "lowerVerticalReference": above,
        "upperLimit": upper,
        "upperVerticalReference": above,
        "horizontalProjection": projection,
    }


def polygon(*rings: list[list[float]]) -> dict[str, Any]:
    """A polygon of GeoJSON and ED-269."""
    return {"type": "Polygon", "coordinates": list(rings)}


def ed269_feature(*volumes: dict[str, Any], identifier: str = "Z1", **changes: Any) -> dict[str, Any]:
    """A zone."""
    fields = {
        "identifier": identifier,
        "country": "CHE",
        "name": "School",
        "type": "COMMON",
        "restriction": "PROHIBITED",
        "reason": ["SENSITIVE"],
        "applicability": ALWAYS,
        "zoneAuthority": [{"name": "Town", "email": "town@example.org", "purpose": "AUTHORIZATION"}],
        "geometry": list(volumes),
    }
    return {**fields, **changes}


def ed269(*features: dict[str, Any]) -> bytes:
    """An ED-269 file."""
    return json.dumps({"title": "Test", "features": list(features)}).encode()


def ed318(geometry: dict[str, Any], layer: dict[str, Any] | None = None, **properties: Any) -> bytes:
    """An ED-318 file of one zone."""
    fields = {
        "identifier": "Z1",
        "country": "CHE",
        "name": [{"text": "Schule", "lang": "de-CH"}, {"text": "School", "lang": "en-GB"}],
        "type": "PROHIBITED",
        "variant": "COMMON",
        "reason": ["SENSITIVE"],
        "zoneAuthority": [{"name": [{"text": "Town", "lang": "en-GB"}], "purpose": "AUTHORIZATION"}],
    }
    usual = {"upper": 120, "upperReference": "AGL", "lower": 0, "lowerReference": "AGL", "uom": "m"}
    feature = {
        "type": "Feature",
        "geometry": {**geometry, "layer": usual if layer is None else layer},
        "properties": {**fields, **properties},
    }
    metadata = {"issued": "2026-11-20T00:00:00Z", "provider": [{"text": "Authority", "lang": "en-GB"}]}
    return json.dumps({"type": "FeatureCollection", "metadata": metadata, "features": [feature]}).encode()


def geojson(geometry: dict[str, Any]) -> bytes:
    """A plain GeoJSON file."""
    feature = {"type": "Feature", "geometry": geometry, "properties": {"name": "School"}}
    return json.dumps({"type": "FeatureCollection", "features": [feature]}).encode()


def kml(ring: list[list[float]]) -> bytes:
    """A KML file of one polygon."""
    places = " ".join(f"{lon!r},{lat!r},0" for lon, lat in ring)
    return (
        '<?xml version="1.0" encoding="UTF-8"?><kml xmlns="http://www.opengis.net/kml/2.2"><Document><Placemark>'
        "<name>School</name><Polygon><outerBoundaryIs><LinearRing><coordinates>"
        f"{places}</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark></Document></kml>"
    ).encode()


def dms(place: list[float] | LonLat) -> str:
    """A place as OpenAir has it, to a thousandth of a second: 3 cm."""
    lon, lat = place
    parts = []
    for value, width, names in ((lat, 2, "NS"), (lon, 3, "EW")):
        seconds = round(abs(value) * 3600.0, 3)
        degrees, rest = divmod(seconds, 3600.0)
        minutes, seconds = divmod(rest, 60.0)
        parts.append(f"{int(degrees):0{width}d}:{int(minutes):02d}:{seconds:06.3f}{names[value < 0]}")
    return " ".join(parts)


def openair(*lines: str, kind: str = "P", lower: str = "GND", upper: str = "400ft AGL") -> bytes:
    """An OpenAir file of one airspace."""
    return "\n".join([f"AC {kind}", "AN School", f"AH {upper}", f"AL {lower}", *lines, ""]).encode()


def openair_ring(ring: list[list[float]]) -> list[str]:
    """Lines of an outline."""
    return [f"DP {dms(place)}" for place in ring]


def aixm(segments: str, kind: str = "P", lower: str = "", upper: str = "", more: str = "") -> bytes:
    """An AIXM 5.1 message of one airspace whose outline is made of some segments."""
    lower = lower or "<aixm:lowerLimit>GND</aixm:lowerLimit><aixm:lowerLimitReference>SFC</aixm:lowerLimitReference>"
    upper = upper or (
        '<aixm:upperLimit uom="FT">400</aixm:upperLimit><aixm:upperLimitReference>SFC</aixm:upperLimitReference>'
    )
    return (
        '<?xml version="1.0"?><m:AIXMBasicMessage xmlns:m="http://www.aixm.aero/schema/5.1/message" '
        'xmlns:aixm="http://www.aixm.aero/schema/5.1" xmlns:gml="http://www.opengis.net/gml/3.2" '
        'xmlns:xlink="http://www.w3.org/1999/xlink"><m:hasMember><aixm:Airspace gml:id="A1"><aixm:timeSlice>'
        "<aixm:AirspaceTimeSlice><aixm:interpretation>BASELINE</aixm:interpretation>"
        f"<aixm:type>{kind}</aixm:type><aixm:designator>ZZ1</aixm:designator><aixm:name>School</aixm:name>{more}"
        "<aixm:geometryComponent><aixm:AirspaceGeometryComponent><aixm:theAirspaceVolume><aixm:AirspaceVolume>"
        f'{upper}{lower}<aixm:horizontalProjection><aixm:Surface srsName="urn:ogc:def:crs:EPSG::4326"><gml:patches>'
        f"<gml:PolygonPatch><gml:exterior><gml:Ring><gml:curveMember><gml:Curve><gml:segments>{segments}"
        "</gml:segments></gml:Curve></gml:curveMember></gml:Ring></gml:exterior></gml:PolygonPatch></gml:patches>"
        "</aixm:Surface></aixm:horizontalProjection></aixm:AirspaceVolume></aixm:theAirspaceVolume>"
        "</aixm:AirspaceGeometryComponent></aixm:geometryComponent></aixm:AirspaceTimeSlice></aixm:timeSlice>"
        "</aixm:Airspace></m:hasMember></m:AIXMBasicMessage>"
    ).encode()


def aixm_ring(ring: list[list[float]]) -> str:
    """A string of places, latitude first."""
    places = " ".join(f"{lat!r} {lon!r}" for lon, lat in ring)
    return f"<gml:GeodesicString><gml:posList>{places}</gml:posList></gml:GeodesicString>"


AIRSPACE = Airspace((-100.0, -100.0, 3.0), (100.0, 100.0, 80.0), ground_z_m=0.0)


def with_zones(
    content: bytes,
    model: SiteModel | None = None,
    file: str = "zones.json",
    not_here: Mapping[str, str] | None = None,
    **permitted: str,
) -> SiteModel:
    """A site with one file of zones."""
    base = site() if model is None else model
    source = ZoneFile(file, hashlib.sha256(content).hexdigest(), "2026-11-28", permitted, not_here or {})
    return replace(base, site=replace(base.site, zones=(source,)), zones=(site_zones(source, content),))


def site(origin: Origin = ORIGIN, airspace: Airspace = AIRSPACE) -> SiteModel:
    """The kiosk at another place, without no-fly volumes of its own."""
    base = kiosk(origin=origin, airspace=airspace)
    assert isinstance(base.site, Site)
    return base
