"""The fence of a flight: the site's no-fly zones as polygons, and its bounds, as MAVLink fence items.

A fence has no height: the vehicle must stay out of its polygon at any altitude. A zone that the mission passes over or
under can therefore not become a fence, or the vehicle would refuse its own mission; it is left out, and said so.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missions.mavlink.items import MissionItem, Polygon
from missions.mission.model import GeoPoint, Mission
from planning.base.errors import MissionError
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.geo.enu import geodetic_from_enu
from planning.site.records import NoFlyZone, Site

# Fences and rally points as mission items, and back: what goes up as mission types 1 and 2.

MIN_CORNERS = 3

_POLYGONS = {
    mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION: True,
    mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION: False,
}
_CIRCLES = {
    mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION: True,
    mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION: False,
}


@dataclass(frozen=True, slots=True)
class FencePolygon:
    """Area to stay in, or out of; corners are latitude and longitude in degrees."""

    corners: Polygon
    is_inclusion: bool

    def __post_init__(self) -> None:
        if len(self.corners) < MIN_CORNERS:
            raise MissionError.say("a fence has {} corners; expected at least {}", len(self.corners), MIN_CORNERS)


@dataclass(frozen=True, slots=True)
class FenceCircle:
    """Circle to stay in, or out of."""

    lat_deg: float
    lon_deg: float
    radius_m: float
    is_inclusion: bool

    def __post_init__(self) -> None:
        if not self.radius_m > 0.0:
            raise MissionError.say("a fence has a radius of {:g} m; expected more than 0", self.radius_m)


Fence = FencePolygon | FenceCircle


def fence_items(fences: Sequence[Fence]) -> tuple[MissionItem, ...]:
    """Items of fences: one for each corner, which says how many its polygon has, or one for a circle."""
    return tuple(item for fence in fences for item in _fence_items(fence))


def _fence_items(fence: Fence) -> list[MissionItem]:
    frame = mavlink.MAV_FRAME_GLOBAL
    if isinstance(fence, FenceCircle):
        command = next(each for each, inside in _CIRCLES.items() if inside is fence.is_inclusion)
        place = (fence.lat_deg, fence.lon_deg)
        return [MissionItem(command, frame, (fence.radius_m, 0.0, 0.0, 0.0, *place, 0.0))]
    command = next(each for each, inside in _POLYGONS.items() if inside is fence.is_inclusion)
    n_corners = float(len(fence.corners))
    return [MissionItem(command, frame, (n_corners, 0.0, 0.0, 0.0, lat, lon, 0.0)) for lat, lon in fence.corners]


def rally_points(site: Site) -> tuple[GeoPoint, ...]:
    """The rally points of a site on the globe."""
    if not site.rally_points:
        return ()
    lat_deg, lon_deg, height_m = geodetic_from_enu(site.origin, [point.position_enu_m for point in site.rally_points])
    places = zip(lat_deg, lon_deg, height_m, strict=True)
    return tuple(GeoPoint(float(lat), float(lon), float(height)) for lat, lon, height in places)


def rally_items(points: Sequence[GeoPoint], home: GeoPoint) -> tuple[MissionItem, ...]:
    """Items of rally points; their heights count from home, and ArduPilot keeps whole metres."""
    return tuple(
        MissionItem(
            mavlink.MAV_CMD_NAV_RALLY_POINT,
            mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT,
            (0.0, 0.0, 0.0, 0.0, point.lat_deg, point.lon_deg, point.height_ellipsoid_m - home.height_ellipsoid_m),
        )
        for point in points
    )


FENCE_CLEARANCE_M = 2.0
"""ArduPilot's default FENCE_MARGIN: nearer than this to a fence the vehicle already brakes."""


def fence_polygons(mission: Mission, zones: tuple[NoFlyZone, ...]) -> tuple[tuple[Polygon, ...], tuple[Finding, ...]]:
    """Polygons of the zones that the mission keeps clear of at every height, and findings on the others."""
    import shapely

    from planning.geo.enu import enu_from_geodetic, geodetic_from_enu

    points = [mission.takeoff, *(waypoint.position for waypoint in mission.waypoints)]
    local = enu_from_geodetic(
        mission.origin,
        [point.lat_deg for point in points],
        [point.lon_deg for point in points],
        [point.height_ellipsoid_m for point in points],
    )
    track = shapely.LineString(local[:, :2])
    polygons: list[Polygon] = []
    findings: list[Finding] = []
    for zone in zones:
        away_m = float(track.distance(shapely.Polygon(zone.polygon_enu_m)))
        if away_m < FENCE_CLEARANCE_M:
            text = say(
                "the mission passes over or under this zone, and fences have no height: it is not in the file's fence"
            )
            findings.append(Finding(Severity.WARNING, "zone-not-fenced", text, zone.id, away_m, FENCE_CLEARANCE_M, "m"))
            continue
        corners = np.array([(x, y, 0.0) for x, y in zone.polygon_enu_m])
        lat_deg, lon_deg, _ = geodetic_from_enu(mission.origin, corners)
        pairs = zip(lat_deg, lon_deg, strict=True)
        polygons.append(tuple((round(float(lat), 9), round(float(lon), 9)) for lat, lon in pairs))
    return tuple(polygons), tuple(findings)
