"""What the autopilot wants of its airframe: where to fly, how fast, where to look; and how far it has come."""

from __future__ import annotations

import math

from missions.simulator.airframe.state import Airframe, Target
from planning.geo.frames import Vec3

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
        pose = airframe.believed
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
        pose = self.airframe.believed
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
        return self.airframe.believed.position_enu_m

    @property
    def speed_m_s(self) -> float:
        """Over the ground and up or down."""
        return math.hypot(*self.airframe.believed.velocity_enu_m_s)

    @property
    def distance_m(self) -> float:
        """From here to where it flies."""
        return math.dist(self.here_enu_m, self._goal_enu_m)

    def turn_left_rad(self, heading_rad: float) -> float:
        """Angle between the nose and a heading, 0 to pi."""
        return abs(math.remainder(heading_rad - self.airframe.believed.heading_rad, 2.0 * math.pi))

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
