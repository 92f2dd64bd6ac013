"""Where a mission item is: latitude, longitude and a height in the reference that its frame says."""

from __future__ import annotations

import math

from missions.mavlink.items import MissionItem
from missions.mission.build import SAME_POINT_M
from missions.mission.legs import distance_m
from missions.mission.model import GeoPoint, ReadWaypoint, point_at_amsl
from planning.base.errors import MissionError
from planning.base.findings import Finding, Severity
from planning.base.messages import say

ABSOLUTE_FRAMES, RELATIVE_FRAMES, TERRAIN_FRAMES = (0, 5), (3, 6), (10, 11)


def has_place(item: MissionItem) -> bool:
    """Whether an item says a latitude and longitude; 0, 0 and NaN mean "here"."""
    lat_deg, lon_deg = item.params[4:6]
    return (lat_deg, lon_deg) != (0.0, 0.0) and not (math.isnan(lat_deg) or math.isnan(lon_deg))


def position_of(item: MissionItem, here: ReadWaypoint | GeoPoint | None, place: str) -> ReadWaypoint:
    """Position of an item.

    Parameters
    ----------
    here
        Where the vehicle is, for items that do not say a place.
    place
        Name of the item, for messages.

    Raises
    ------
    MissionError
        The position is not on the globe, or counts from something that is not in the file.
    """
    lat_deg, lon_deg, altitude_m = item.params[4:]
    if not has_place(item):
        if here is None:
            raise MissionError(say("its position means here, but nothing says where that is", place=place))
        lat_deg, lon_deg = here.lat_deg, here.lon_deg
    if not (abs(lat_deg) <= 90.0 and abs(lon_deg) <= 180.0 and math.isfinite(altitude_m)):
        raise MissionError(
            say("the position {:g}, {:g}, {:g} m is not on the globe", lat_deg, lon_deg, altitude_m, place=place)
        )
    if item.frame in RELATIVE_FRAMES:
        return ReadWaypoint(lat_deg, lon_deg, height_above_takeoff_m=altitude_m)
    if item.frame in ABSOLUTE_FRAMES:
        point = point_at_amsl(lat_deg, lon_deg, altitude_m)
        return ReadWaypoint(lat_deg, lon_deg, height_ellipsoid_m=point.height_ellipsoid_m)
    if item.frame in TERRAIN_FRAMES:
        raise MissionError(
            say(
                "its height counts from the terrain, which is not in the file; save the mission with heights "
                "above take-off or sea level",
                place=place,
            )
        )
    raise MissionError(say("frame {} does not place it on the globe", item.frame, place=place))


def is_same_place(a: ReadWaypoint, b: ReadWaypoint) -> bool:
    """Whether two points with heights of the same kind are one."""
    heights = (a.height_above_takeoff_m, b.height_above_takeoff_m)
    if heights == (None, None):
        heights = (a.height_ellipsoid_m, b.height_ellipsoid_m)
    low, high = heights
    if low is None or high is None or abs(high - low) > SAME_POINT_M:
        return False
    return distance_m(a.lat_deg, a.lon_deg, b.lat_deg, b.lon_deg) <= SAME_POINT_M


def home_of(lat_deg: float, lon_deg: float, altitude_amsl_m: float) -> tuple[GeoPoint | None, tuple[Finding, ...]]:
    """The home position that a file names; None where it names none, or one that cannot be, which is told."""
    if (lat_deg, lon_deg) == (0.0, 0.0):
        return None, ()
    if abs(lat_deg) <= 90.0 and abs(lon_deg) <= 180.0 and abs(altitude_amsl_m) < 1e5:
        return point_at_amsl(lat_deg, lon_deg, altitude_amsl_m), ()
    text = say(
        "its home position {:g}, {:g}, {:g} m is not on the globe and is not used", lat_deg, lon_deg, altitude_amsl_m
    )
    return None, (Finding(Severity.WARNING, "home", text),)
