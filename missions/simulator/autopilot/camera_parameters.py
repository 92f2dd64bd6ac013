"""A camera that speaks MAVLink's camera protocol: its parameters, by the names and in the types of the guide's example.

Exposure goes by the mode: shutter time, aperture and ISO can be set while it is manual, compensation while it is
automatic, as the guide's example excludes one by the other. A shutter time is one of the camera's list.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, field

from pymavlink.dialects.v20 import common as mavlink

from missions.mavlink.messages import (
    CameraInformation,
    Message,
    ParamExtAck,
    ParamExtRequestRead,
    ParamExtSet,
    ParamExtValue,
)
from missions.mission.model import Mission

CAMERA_COMPONENT = 100
"""MAV_COMP_ID_CAMERA; the simulated vehicle speaks for its camera, as autopilots do for cameras without a link."""

UINT32, REAL32 = mavlink.MAV_PARAM_EXT_TYPE_UINT32, mavlink.MAV_PARAM_EXT_TYPE_REAL32
LAYOUTS = {
    mavlink.MAV_PARAM_EXT_TYPE_UINT8: "<B",
    mavlink.MAV_PARAM_EXT_TYPE_INT8: "<b",
    mavlink.MAV_PARAM_EXT_TYPE_UINT16: "<H",
    mavlink.MAV_PARAM_EXT_TYPE_INT16: "<h",
    UINT32: "<I",
    mavlink.MAV_PARAM_EXT_TYPE_INT32: "<i",
    REAL32: "<f",
}
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


DEFINITION_PATH = "/camera/definition.xml"


@dataclass(slots=True)
class CameraParameters:
    """Values by name.

    Parameters
    ----------
    kinds
        MAV_PARAM_EXT_TYPE by name; of others, whole numbers are UINT32, and the rest REAL32.
    definition
        Its definition file, which the vehicle serves; empty: it has none.
    takes_all
        Every value is taken that the type holds.
    uri
        Where it says that the file is.
    """

    values: dict[str, float] = field(default_factory=_usual)
    definition: bytes = b""
    takes_all: bool = False
    kinds: dict[str, int] = field(default_factory=dict)
    uri: str = f"mftp://{DEFINITION_PATH}"

    @property
    def information(self) -> CameraInformation:
        """Who it is."""
        name = tuple(b"simulated".ljust(32, b"\0"))
        uri = self.uri if self.definition else ""
        return CameraInformation(0, name, name, 1, 12.29, 17.3, 13.0, 5280, 3956, 0, 0, 1, uri)

    @property
    def files(self) -> dict[str, bytes]:
        """What it has to be fetched, by path."""
        return {DEFINITION_PATH: self.definition} if self.definition else {}

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
        kind = self.kinds.get(name, UINT32 if isinstance(value, int) else REAL32)
        return struct.pack(LAYOUTS[kind], value).ljust(FIELD_BYTES, b"\0"), kind

    def _set(self, message: ParamExtSet) -> ParamExtAck:
        name = message.param_id
        content, kind = self._content(name)
        if message.param_type != kind:
            return ParamExtAck(name, content, kind, mavlink.PARAM_ACK_FAILED)
        (value,) = struct.unpack_from(LAYOUTS[kind], message.param_value)
        if not self._takes(name, value):
            return ParamExtAck(name, content, kind, mavlink.PARAM_ACK_VALUE_UNSUPPORTED)
        self.values[name] = value
        content, kind = self._content(name)
        return ParamExtAck(name, content, kind, mavlink.PARAM_ACK_ACCEPTED)

    def _takes(self, name: str, value: float) -> bool:
        if self.takes_all:
            return True
        is_manual = self.values["CAM_EXPMODE"] == MANUAL
        if name in (IN_AUTOMATIC if is_manual else IN_MANUAL):
            return False
        if name == "CAM_SHUTTERSPD":
            return any(abs(value - each) < 1e-6 for each in SHUTTERS_S)
        if name in OPTIONS:
            return value in OPTIONS[name]
        low, high = RANGES[name]
        return low - 1e-6 <= value <= high + 1e-6
