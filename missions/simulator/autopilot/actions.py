"""What the vehicle does at once for a command, be it an item of a mission or sent by the ground station."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from pymavlink.dialects.v20 import common as mavlink

from missions.mavlink.autopilots import Autopilot
from missions.simulator.autopilot.camera import CameraControl
from missions.simulator.autopilot.gimbal import GimbalControl
from missions.simulator.autopilot.guidance import Guidance
from missions.simulator.autopilot.place import Place
from missions.simulator.autopilot.stored_item import StoredItem

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
