"""What the autopilot wants of its airframe: where to fly, how fast, where to look; and how far it has come."""

from __future__ import annotations

import math
from dataclasses import dataclass

from missions.mission.model import GeoPoint, altitude_amsl_m, point_at_amsl
from missions.simulator.airframe.state import Airframe, Target
from missions.simulator.autopilot.mission_store import DEGREES_E7, StoredItem
from planning.geo.frames import Origin, Vec3

# Between the site's local frame, in which the airframe flies, and the positions of MAVLink.
#
# Latitude and longitude are 1e-7 degrees; altitudes are above mean sea level (EGM96) or above the vehicle's home.

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


BRAKING_M_S2 = 2.5
"""ArduPilot's default WPNAV_ACCEL: an aircraft that is told to stop stands so far ahead as this needs."""

SLOWEST_M_S, SLOWEST_RAD_S = 0.01, 0.01
"""Speeds that parameters and commands set lower, 0 and less among them, are taken for this."""

DEG = math.pi / 180.0


class Guidance:
    """Steers an airframe. Positions are local ENU, as the autopilot believes them; angles are radians.

    `look_at_enu_m` is a place that the camera looks at, also while the aircraft moves, and with `nose_follows` the
    nose too; None leaves heading and tilt as they were set.
    """

    def __init__(self, airframe: Airframe) -> None:
        pose = airframe.estimate
        self.airframe = airframe
        self.now_s = 0.0
        self.horizontal_m_s = self.ascent_m_s = self.descent_m_s = 1.0
        self.yaw_rate_rad_s = 1.0
        self.look_at_enu_m: Vec3 | None = None
        self.nose_follows = True
        self.heading_rad = pose.heading_rad
        self.tilt_rad = 0.0
        self.motors_on = False
        self._turn_rate_rad_s: float | None = None
        self._descent_m_s: float | None = None
        self._goal_enu_m = pose.position_enu_m
        self._passes = False
        self._target: Target | None = None

    # Orders

    def set_speeds(
        self, horizontal_m_s: float | None = None, ascent_m_s: float | None = None, descent_m_s: float | None = None
    ) -> None:
        """Change cruise speeds; None leaves one as it is."""
        self.horizontal_m_s = horizontal_m_s or self.horizontal_m_s
        self.ascent_m_s = ascent_m_s or self.ascent_m_s
        self.descent_m_s = descent_m_s or self.descent_m_s
        self._target = None

    def fly_to(self, goal_enu_m: Vec3, *, passes: bool = False, descent_m_s: float | None = None) -> None:
        """Fly there; `descent_m_s` holds for this leg only."""
        self._goal_enu_m, self._passes, self._descent_m_s = goal_enu_m, passes, descent_m_s
        self._target = None

    def stop(self) -> None:
        """Brake, and stay where that ends."""
        pose = self.airframe.estimate
        (x, y, z), (vx, vy, vz) = pose.position_enu_m, pose.velocity_enu_m_s
        ahead_s = 0.5 * math.hypot(vx, vy, vz) / BRAKING_M_S2
        self.fly_to((x + ahead_s * vx, y + ahead_s * vy, z + ahead_s * vz))

    def face(self, heading_rad: float, rate_rad_s: float | None = None) -> None:
        """Turn the nose there; None is the autopilot's usual rate. What is no number is not obeyed."""
        if not (math.isfinite(heading_rad) and (rate_rad_s is None or math.isfinite(rate_rad_s))):
            return
        self.heading_rad, self._turn_rate_rad_s = heading_rad, rate_rad_s
        self._target = None

    def tilt(self, pitch_rad: float) -> None:
        """Turn the camera up or down. What is no number is not obeyed."""
        if not math.isfinite(pitch_rad):
            return
        self.tilt_rad = pitch_rad
        self._target = None

    def set_motors(self, motors_on: bool) -> None:
        """Start or stop the motors."""
        self.motors_on = motors_on
        self._target = None

    # State

    @property
    def goal_enu_m(self) -> Vec3:
        """Where it flies to."""
        return self._goal_enu_m

    @property
    def here_enu_m(self) -> Vec3:
        """Where it believes to be."""
        return self.airframe.estimate.position_enu_m

    @property
    def speed_m_s(self) -> float:
        """Over the ground and up or down."""
        return math.hypot(*self.airframe.estimate.velocity_enu_m_s)

    @property
    def distance_m(self) -> float:
        """From here to where it flies."""
        return math.dist(self.here_enu_m, self._goal_enu_m)

    def turn_left_rad(self, heading_rad: float) -> float:
        """Angle between the nose and a heading, 0 to pi."""
        return abs(math.remainder(heading_rad - self.airframe.estimate.heading_rad, 2.0 * math.pi))

    def step(self, duration_s: float) -> None:
        """Let the airframe fly on for a time."""
        if self.look_at_enu_m is not None:
            self._look_at(self.look_at_enu_m)
        if self._target is None:
            self._target = self._new_target()
        self.airframe.step(duration_s, self._target)

    def _look_at(self, place_enu_m: Vec3) -> None:
        x, y, z = self.here_enu_m
        east, north, up = place_enu_m[0] - x, place_enu_m[1] - y, place_enu_m[2] - z
        away_m = math.hypot(east, north)
        # Straight above or below it there is no direction to turn to.
        if self.nose_follows and away_m > 0.1:
            self.heading_rad, self._turn_rate_rad_s = math.atan2(east, north), None
        self.tilt_rad = math.atan2(up, away_m)
        self._target = None

    def _new_target(self) -> Target:
        return Target(
            self._goal_enu_m,
            max(self.horizontal_m_s, SLOWEST_M_S),
            max(self.ascent_m_s, SLOWEST_M_S),
            max(self._descent_m_s or self.descent_m_s, SLOWEST_M_S),
            self.heading_rad,
            max(self._turn_rate_rad_s or self.yaw_rate_rad_s, SLOWEST_RAD_S),
            self.tilt_rad,
            self._passes,
            self.motors_on,
        )
