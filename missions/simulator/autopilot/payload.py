"""Camera and gimbal as the autopilot commands them, and what the vehicle does at once for a command.

The gimbal tilts, and pans where it can. The airframe turns the camera up and down. Pan, where there is any, is a servo
that stands where it was sent at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from pymavlink.dialects.v20 import common as mavlink

from missions.mavlink.autopilots import Autopilot
from missions.simulator.airframe.state import Pose
from missions.simulator.autopilot.guidance import DEG, Guidance, Place
from missions.simulator.autopilot.mission_store import StoredItem
from missions.simulator.autopilot.parameters import ParameterTable
from planning.geo.frames import Vec3

# The camera's trigger: which of the asked photos are really taken, and when.
#
# ArduPilot holds the shutter for CAM1_DURATION; what is asked meanwhile is lost without a word. With CAM1_INTRVAL_MIN
# one photo asked too early waits, the others are lost. PX4's camera takes each, but none within TRIG_ACT_TIME.

FOREVER = math.inf


class CameraControl:
    """Counts photos and asks for them; `shoot` opens the shutter.

    Parameters
    ----------
    shoot
        Called with the number of each photo that is taken, from 1.
    """

    def __init__(
        self,
        autopilot: Autopilot,
        parameters: ParameterTable,
        guidance: Guidance,
        shoot: Callable[[int], None],
    ) -> None:
        self._autopilot, self._parameters, self._guidance, self._shoot = autopilot, parameters, guidance, shoot
        self.n_photos = 0
        self.n_lost = 0
        self._busy_until_s = -FOREVER
        self._pending_s = FOREVER
        self._next_s, self._every_s, self._left = FOREVER, 0.0, 0.0
        self._every_m = 0.0
        self._last_xy_m = (0.0, 0.0)

    @property
    def is_fitted(self) -> bool:
        """Whether there is one, by the parameters; without, commands to it are accepted and do nothing."""
        return self._parameters["TRIG_MODE" if self._autopilot is Autopilot.PX4 else "CAM1_TYPE"] > 0

    def trigger(self) -> None:
        """Ask for one photo now."""
        if not self.is_fitted:
            return
        now_s = self._guidance.now_s
        if self._autopilot is Autopilot.PX4:
            held_s, waits = self._parameters["TRIG_ACT_TIME"] / 1000.0, False
        else:
            interval_s = self._parameters["CAM1_INTRVAL_MIN"]
            held_s, waits = max(self._parameters["CAM1_DURATION"], interval_s), interval_s > 0.0
        if now_s < self._busy_until_s - 1e-9:
            if waits and self._pending_s == FOREVER:
                self._pending_s = self._busy_until_s
            else:
                self.n_lost += 1
            return
        self._busy_until_s = now_s + held_s
        self.n_photos += 1
        self._shoot(self.n_photos)

    def start_series(self, every_s: float, count: int) -> None:
        """Take `count` photos (0: until stopped), the first now."""
        self.stop_series()
        self.trigger()
        if count != 1 and every_s > 0.0:
            self._every_s, self._left = every_s, count - 1 if count > 1 else FOREVER
            self._next_s = self._guidance.now_s + every_s

    def start_distance(self, every_m: float, at_once: bool) -> None:
        """Take a photo each time the aircraft moved so far over the ground; 0 stops it."""
        self._every_m = max(0.0, every_m)
        self._last_xy_m = self._guidance.here_enu_m[:2]
        if at_once and every_m > 0.0:
            self.trigger()

    def stop_series(self) -> None:
        """Take no more photos by time."""
        self._next_s = FOREVER

    def stop(self) -> None:
        """Take no more photos by time or distance."""
        self.stop_series()
        self._every_m = 0.0

    def tick(self) -> None:
        """Take what is due; asked once for every control step."""
        now_s = self._guidance.now_s
        if now_s >= self._pending_s - 1e-9:
            self._pending_s = FOREVER
            self.trigger()
        if now_s >= self._next_s - 1e-9:
            self._left -= 1
            self._next_s = self._next_s + self._every_s if self._left > 0 else FOREVER
            self.trigger()
        if self._every_m > 0.0:
            x, y, _ = self._guidance.here_enu_m
            if math.hypot(x - self._last_xy_m[0], y - self._last_xy_m[1]) >= self._every_m:
                self._last_xy_m = (x, y)
                self.trigger()


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


# What the vehicle does at once for a command, be it an item of a mission or sent by the ground station.

CLIMB_SPEED, DESCENT_SPEED = mavlink.SPEED_TYPE_CLIMB_SPEED, mavlink.SPEED_TYPE_DESCENT_SPEED


@dataclass(frozen=True, slots=True)
class Actions:
    """The parts of the vehicle that commands act upon."""

    autopilot: Autopilot
    guidance: Guidance
    gimbal: GimbalControl
    camera: CameraControl
    place: Place

    def do(self, item: StoredItem) -> bool:
        """Carry out a command; False where the vehicle does not know it."""
        handler = _HANDLERS.get(item.command)
        if handler is None:
            return False
        handler(self, item)
        return True

    def change_speed(self, item: StoredItem) -> None:
        """DO_CHANGE_SPEED."""
        kind, speed_m_s = item.param1, item.param2
        if not (math.isfinite(speed_m_s) and speed_m_s > 0.0):
            return
        if kind == CLIMB_SPEED:
            self.guidance.set_speeds(ascent_m_s=speed_m_s)
        elif kind == DESCENT_SPEED:
            self.guidance.set_speeds(descent_m_s=speed_m_s)
        else:
            self.guidance.set_speeds(horizontal_m_s=speed_m_s)

    def set_home(self, item: StoredItem) -> None:
        """DO_SET_HOME: param 1 is 1 for here, else the position."""
        here = self.guidance.here_enu_m
        self.place.set_home(here if item.param1 == 1.0 else self.place.item_enu(item, here))

    def set_roi(self, item: StoredItem) -> None:
        """DO_SET_ROI and its relatives: look at a place from now on; without one, no more."""
        is_none = item.command == mavlink.MAV_CMD_DO_SET_ROI_NONE or not item.has_place
        here = self.guidance.here_enu_m
        self.gimbal.look_at(None if is_none else self.place.item_enu(item, here))

    def mount_control(self, item: StoredItem) -> None:
        """DO_MOUNT_CONTROL."""
        self.gimbal.mount_control(item.param1, item.param3)

    def gimbal_pitch_yaw(self, item: StoredItem) -> None:
        """DO_GIMBAL_MANAGER_PITCHYAW."""
        self.gimbal.pitch_yaw(item.param1, item.param2, item.x)

    def gimbal_configure(self, item: StoredItem) -> None:
        """DO_GIMBAL_MANAGER_CONFIGURE."""
        self.gimbal.configure(item.param1, item.param2)

    def digicam(self, item: StoredItem) -> None:
        """DO_DIGICAM_CONTROL: a photo where param 5 is exactly 1."""
        if item.x == 1:
            self.camera.trigger()

    def image_start(self, item: StoredItem) -> None:
        """IMAGE_START_CAPTURE: param 2 interval, param 3 how many."""
        self.camera.start_series(item.param2, int(item.param3) if math.isfinite(item.param3) else 1)

    def image_stop(self, item: StoredItem) -> None:
        """IMAGE_STOP_CAPTURE."""
        self.camera.stop()

    def trigger_distance(self, item: StoredItem) -> None:
        """DO_SET_CAM_TRIGG_DIST: param 1 metres, param 3 one at once."""
        self.camera.start_distance(item.param1, item.param3 == 1.0)

    def nothing(self, item: StoredItem) -> None:
        """Accepted, and without anything to do on this vehicle."""


_HANDLERS: dict[int, Callable[[Actions, StoredItem], None]] = {
    mavlink.MAV_CMD_DO_CHANGE_SPEED: Actions.change_speed,
    mavlink.MAV_CMD_DO_SET_HOME: Actions.set_home,
    mavlink.MAV_CMD_DO_SET_ROI: Actions.set_roi,
    mavlink.MAV_CMD_DO_SET_ROI_LOCATION: Actions.set_roi,
    mavlink.MAV_CMD_DO_SET_ROI_NONE: Actions.set_roi,
    mavlink.MAV_CMD_DO_MOUNT_CONTROL: Actions.mount_control,
    mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW: Actions.gimbal_pitch_yaw,
    mavlink.MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE: Actions.gimbal_configure,
    mavlink.MAV_CMD_DO_DIGICAM_CONTROL: Actions.digicam,
    mavlink.MAV_CMD_IMAGE_START_CAPTURE: Actions.image_start,
    mavlink.MAV_CMD_IMAGE_STOP_CAPTURE: Actions.image_stop,
    mavlink.MAV_CMD_DO_SET_CAM_TRIGG_DIST: Actions.trigger_distance,
    mavlink.MAV_CMD_DO_MOUNT_CONFIGURE: Actions.nothing,
    mavlink.MAV_CMD_DO_LAND_START: Actions.nothing,
    mavlink.MAV_CMD_SET_CAMERA_MODE: Actions.nothing,
}
