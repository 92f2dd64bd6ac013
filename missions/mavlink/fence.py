"""The site's no-fly zones as fence polygons.

A fence has no height: the vehicle must stay out of its polygon at any altitude. A zone that the mission passes over or
under can therefore not become a fence, or the vehicle would refuse its own mission; it is left out, and said so.
"""

from __future__ import annotations

import numpy as np

from missions.mavlink.items import Polygon
from missions.mission.model import Mission
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.site.records import NoFlyZone

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
