"""Between the site's local frame, in which the airframe flies, and the positions of MAVLink.

Latitude and longitude are 1e-7 degrees; altitudes are above mean sea level (EGM96) or above the vehicle's home.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from missions.mission.model import GeoPoint, altitude_amsl_m, point_at_amsl
from missions.simulator.autopilot.stored_item import DEGREES_E7, StoredItem
from planning.geo.frames import Origin, Vec3

ABOVE_SEA = (0, 2, 5)
FARTHEST_M = 100_000.0
"""Heights beyond this are taken for it: nothing flies there, and numbers stay numbers."""


@dataclass(frozen=True, slots=True)
class WirePlace:
    """A position as messages carry it."""

    lat_e7: int
    lon_e7: int
    altitude_amsl_m: float
    above_home_m: float
    ellipsoid_height_m: float


class Place:
    """The local frame of a site, and the vehicle's home in it."""

    def __init__(self, origin: Origin, home_enu_m: Vec3) -> None:
        self.origin = origin
        self.set_home(home_enu_m)

    def set_home(self, home_enu_m: Vec3) -> None:
        """Move home; heights above home count from there."""
        self.home_enu_m = home_enu_m
        self._home = self.geo_point(home_enu_m)
        # Over a site the geoid is a plane: its height changes by centimetres in a kilometre.
        self._home_amsl_m = altitude_amsl_m(self._home)
        self._geoid_m = self._home.height_ellipsoid_m - self._home_amsl_m

    def geo_point(self, position_enu_m: Vec3) -> GeoPoint:
        """WGS 84 position of a local point."""
        from planning.geo.enu import geodetic_from_enu

        lat_deg, lon_deg, height_m = geodetic_from_enu(self.origin, [position_enu_m])
        return GeoPoint(float(lat_deg[0]), float(lon_deg[0]), float(height_m[0]))

    def wire_place(self, position_enu_m: Vec3) -> WirePlace:
        """A local point as messages carry it."""
        point = self.geo_point(position_enu_m)
        return WirePlace(
            round(point.lat_deg * DEGREES_E7),
            round(point.lon_deg * DEGREES_E7),
            point.height_ellipsoid_m - self._geoid_m,
            point.height_ellipsoid_m - self._home.height_ellipsoid_m,
            point.height_ellipsoid_m,
        )

    def enu(self, x: int, y: int, z: float, frame: int) -> Vec3:
        """Local point of a latitude, longitude and altitude in a MAVLink frame.

        PX4 takes items that are not on the globe; they are flown to as the nearest place that is.
        """
        from planning.geo.enu import enu_from_geodetic

        lat_deg, lon_deg = min(max(x / DEGREES_E7, -90.0), 90.0), y / DEGREES_E7
        z = min(max(z, -FARTHEST_M), FARTHEST_M)
        if frame in ABOVE_SEA:
            height_m = point_at_amsl(lat_deg, lon_deg, z).height_ellipsoid_m
        else:
            height_m = self._home.height_ellipsoid_m + z
        east, north, up = enu_from_geodetic(self.origin, lat_deg, lon_deg, height_m)[0]
        return float(east), float(north), float(up)

    def item_enu(self, item: StoredItem, here_enu_m: Vec3) -> Vec3:
        """Where an item is: what it leaves open (no place, no altitude) is where the vehicle is."""
        here = self.wire_place(here_enu_m)
        x, y = (item.x, item.y) if item.has_place else (here.lat_e7, here.lon_e7)
        z, frame = (item.z, item.frame) if math.isfinite(item.z) else (here.above_home_m, 3)
        east, north, up = self.enu(x, y, z, frame)
        return (east, north, up) if item.has_place else (here_enu_m[0], here_enu_m[1], up)

    def home_item(self) -> StoredItem:
        """Home as ArduPilot's item 0."""
        home = self.wire_place(self.home_enu_m)
        return StoredItem(16, 0, 0.0, 0.0, 0.0, 0.0, home.lat_e7, home.lon_e7, home.altitude_amsl_m)
