"""The gimbal as the autopilot commands it: tilt, and pan where it has one.

The airframe turns the camera up and down. Pan, where there is any, is a servo that stands where it was sent at once.
"""

from __future__ import annotations

import math
from dataclasses import replace

from pymavlink.dialects.v20 import common as mavlink

from missions.mavlink.autopilots import Autopilot
from missions.simulator.airframe.state import Pose
from missions.simulator.autopilot.guidance import DEG, Guidance
from missions.simulator.autopilot.parameters import ParameterTable
from planning.geo.frames import Vec3

PAN_SERVO = 6
"""SERVO10_FUNCTION of a mount's yaw."""

SERVO_MOUNT = 1
"""MNT1_TYPE of a mount without feedback: it reports where it was sent, not where it stands."""

FOLLOWS_NOSE = (
    mavlink.GIMBAL_DEVICE_FLAGS_ROLL_LOCK
    | mavlink.GIMBAL_DEVICE_FLAGS_PITCH_LOCK
    | mavlink.GIMBAL_DEVICE_FLAGS_YAW_IN_VEHICLE_FRAME
)
LOCKED_TO_EARTH = FOLLOWS_NOSE | mavlink.GIMBAL_DEVICE_FLAGS_YAW_LOCK


class GimbalControl:
    """Angles that the gimbal was told; pan is against the nose, or against north while it is locked."""

    def __init__(self, autopilot: Autopilot, parameters: ParameterTable, guidance: Guidance) -> None:
        self._autopilot, self._parameters, self._guidance = autopilot, parameters, guidance
        self._pan_rad = 0.0
        self._is_locked = False
        self._obeys_autopilot = False

    @property
    def is_mounted(self) -> bool:
        """Whether there is one at all, by the parameters."""
        if self._autopilot is Autopilot.ARDUPILOT:
            return self._parameters["MNT1_TYPE"] > 0
        return self._parameters["MNT_MODE_IN"] >= 0

    @property
    def has_pan(self) -> bool:
        """Whether it turns sideways."""
        if self._autopilot is Autopilot.ARDUPILOT:
            return self._parameters["SERVO10_FUNCTION"] == PAN_SERVO
        return self._parameters["MNT_RANGE_YAW"] > 0.0

    def mount_control(self, pitch_deg: float, yaw_deg: float) -> None:
        """DO_MOUNT_CONTROL: without a pan axis ArduPilot turns the vehicle to the yaw, taken as a heading."""
        self.look_at(None)
        self._tilt_to(pitch_deg)
        self._is_locked = False
        if self.has_pan and math.isfinite(yaw_deg):
            self._pan_rad = yaw_deg * DEG
        elif self._autopilot is Autopilot.ARDUPILOT and self.is_mounted:
            self._guidance.face(yaw_deg * DEG)

    def pitch_yaw(self, pitch_deg: float, yaw_deg: float, flags: int) -> None:
        """DO_GIMBAL_MANAGER_PITCHYAW: never turns the vehicle; NaN leaves an angle as it is."""
        if self._autopilot is Autopilot.PX4 and not self._obeys_autopilot:
            return
        self.look_at(None)
        if math.isfinite(pitch_deg):
            self._tilt_to(pitch_deg)
        if math.isfinite(yaw_deg) and self.has_pan:
            self._pan_rad = yaw_deg * DEG
            self._is_locked = bool(flags & mavlink.GIMBAL_MANAGER_FLAGS_YAW_LOCK)

    def configure(self, system: float, component: float) -> None:
        """DO_GIMBAL_MANAGER_CONFIGURE: who controls it; -2 is whoever sends this, here the autopilot; -1 no change."""
        if (system, component) != (-1.0, -1.0):
            self._obeys_autopilot = (system, component) in ((-2.0, -2.0), (1.0, 1.0))

    def look_at(self, place_enu_m: Vec3 | None) -> None:
        """Keep looking at a place; None: keep the angles. A gimbal without pan takes the nose with it."""
        self._guidance.look_at_enu_m = place_enu_m
        self._guidance.nose_follows = not self.has_pan

    def turned(self, pose: Pose) -> Pose:
        """A pose of the airframe with the camera panned."""
        return replace(pose, gimbal_heading_rad=pose.heading_rad + self._pan(pose)) if self.has_pan else pose

    def attitude(self, pose: Pose) -> tuple[tuple[float, float, float, float], int]:
        """What GIMBAL_DEVICE_ATTITUDE_STATUS says: quaternion (w first; yaw against the nose), and flags."""
        is_servo = self._autopilot is Autopilot.ARDUPILOT and self._parameters["MNT1_TYPE"] == SERVO_MOUNT
        pitch_rad = self._guidance.tilt_rad if is_servo else pose.gimbal_pitch_rad
        half_pan, half_pitch = 0.5 * self._pan(pose), 0.5 * pitch_rad
        quaternion = (
            math.cos(half_pan) * math.cos(half_pitch),
            -math.sin(half_pan) * math.sin(half_pitch),
            math.cos(half_pan) * math.sin(half_pitch),
            math.sin(half_pan) * math.cos(half_pitch),
        )
        return quaternion, LOCKED_TO_EARTH if self._is_locked else FOLLOWS_NOSE

    def _tilt_to(self, pitch_deg: float) -> None:
        """Beyond its limits the pitch is clipped without a word."""
        if self._autopilot is Autopilot.ARDUPILOT:
            pitch_deg = min(max(pitch_deg, self._parameters["MNT1_PITCH_MIN"]), self._parameters["MNT1_PITCH_MAX"])
        if self.is_mounted:
            self._guidance.tilt(pitch_deg * DEG)

    def _pan(self, pose: Pose) -> float:
        if not self.has_pan:
            return 0.0
        place = self._guidance.look_at_enu_m
        if place is not None:
            (x, y, _), (px, py, _) = pose.position_enu_m, place
            return math.remainder(math.atan2(px - x, py - y) - pose.heading_rad, 2.0 * math.pi)
        pan_rad = self._pan_rad - pose.heading_rad if self._is_locked else self._pan_rad
        return math.remainder(pan_rad, 2.0 * math.pi)
