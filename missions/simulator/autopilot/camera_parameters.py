"""A camera that speaks MAVLink's camera protocol: its parameters, by the names and in the types of the guide's example.

Exposure goes by the mode: shutter time, aperture and ISO can be set while it is manual, compensation while it is
automatic, as the guide's example excludes one by the other. A shutter time is one of the camera's list.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, field

from pymavlink.dialects.v20 import common as mavlink

from missions.mavlink.messages import Message, ParamExtAck, ParamExtRequestRead, ParamExtSet, ParamExtValue
from missions.mission.model import Mission

CAMERA_COMPONENT = 100
"""MAV_COMP_ID_CAMERA; the simulated vehicle speaks for its camera, as autopilots do for cameras without a link."""

UINT32, REAL32 = mavlink.MAV_PARAM_EXT_TYPE_UINT32, mavlink.MAV_PARAM_EXT_TYPE_REAL32
FIELD_BYTES = 128
MANUAL = 1

SHUTTERS_S = (1 / 30, 1 / 60, 1 / 120, 1 / 240, 1 / 250, 1 / 500, 1 / 1000, 1 / 2000, 1 / 4000)
RANGES = {"CAM_APERTURE": (2.8, 22.0), "CAM_ISO": (100, 6400), "CAM_EV": (-3.0, 3.0)}
OPTIONS = {"CAM_EXPMODE": (0, 1), "CAM_WBMODE": (0, 1, 3, 4, 5, 7)}
IN_MANUAL, IN_AUTOMATIC = ("CAM_SHUTTERSPD", "CAM_APERTURE", "CAM_ISO"), ("CAM_EV",)


def _usual() -> dict[str, float]:
    return {
        "CAM_EXPMODE": 0,
        "CAM_WBMODE": 0,
        "CAM_SHUTTERSPD": 1 / 60,
        "CAM_APERTURE": 5.6,
        "CAM_ISO": 100,
        "CAM_EV": 0.0,
    }


def simulated_camera(mission: Mission) -> CameraParameters | None:
    """The camera of a simulated vehicle for a mission: one that speaks the protocol where the profile says so."""
    controls = mission.camera_controls
    return CameraParameters() if controls is not None and "parameters" in controls.mavlink else None


@dataclass(slots=True)
class CameraParameters:
    """Values by name; whole numbers are UINT32, others REAL32."""

    values: dict[str, float] = field(default_factory=_usual)

    def receive(self, message: ParamExtSet | ParamExtRequestRead) -> list[Message]:
        """The answer; none for a name that it does not have."""
        if message.param_id not in self.values:
            return []
        if isinstance(message, ParamExtRequestRead):
            return [self._value(message.param_id)]
        return [self._set(message)]

    def _value(self, name: str) -> ParamExtValue:
        content, kind = self._content(name)
        return ParamExtValue(name, content, kind, len(self.values), list(self.values).index(name))

    def _content(self, name: str) -> tuple[bytes, int]:
        value = self.values[name]
        kind = UINT32 if isinstance(value, int) else REAL32
        return struct.pack("<I" if kind == UINT32 else "<f", value).ljust(FIELD_BYTES, b"\0"), kind

    def _set(self, message: ParamExtSet) -> ParamExtAck:
        name = message.param_id
        content, kind = self._content(name)
        if message.param_type != kind:
            return ParamExtAck(name, content, kind, mavlink.PARAM_ACK_FAILED)
        (value,) = struct.unpack_from("<I" if kind == UINT32 else "<f", message.param_value)
        if not self._takes(name, value):
            return ParamExtAck(name, content, kind, mavlink.PARAM_ACK_VALUE_UNSUPPORTED)
        self.values[name] = value
        content, kind = self._content(name)
        return ParamExtAck(name, content, kind, mavlink.PARAM_ACK_ACCEPTED)

    def _takes(self, name: str, value: float) -> bool:
        is_manual = self.values["CAM_EXPMODE"] == MANUAL
        if name in (IN_AUTOMATIC if is_manual else IN_MANUAL):
            return False
        if name == "CAM_SHUTTERSPD":
            return any(abs(value - each) < 1e-6 for each in SHUTTERS_S)
        if name in OPTIONS:
            return value in OPTIONS[name]
        low, high = RANGES[name]
        return low - 1e-6 <= value <= high + 1e-6
