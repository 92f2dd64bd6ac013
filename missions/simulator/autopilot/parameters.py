"""The vehicle's parameters and the PARAM protocol: of whole numbers PX4 sends the bytes, taken for a float."""

from __future__ import annotations

import math
import struct
from collections.abc import Mapping

from pymavlink.dialects.v20 import common as mavlink

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import Message, ParamRequestList, ParamRequestRead, ParamSet, ParamValue
from missions.simulator.autopilot.mission_store import float32
from missions.simulator.autopilot.profiles import vehicle_profile

INT32, REAL32 = mavlink.MAV_PARAM_TYPE_INT32, mavlink.MAV_PARAM_TYPE_REAL32


def wire_value(value: int | float, autopilot: Autopilot) -> float:
    """A parameter as PARAM_VALUE carries it."""
    if isinstance(value, int) and autopilot is Autopilot.PX4:
        return float(struct.unpack("<f", struct.pack("<i", value))[0])
    return float32(value)


def from_wire_value(value: float, is_whole: bool, autopilot: Autopilot) -> int | float:
    """A parameter as PARAM_SET carried it."""
    if is_whole and autopilot is Autopilot.PX4:
        return int(struct.unpack("<i", struct.pack("<f", value))[0])
    return round(value) if is_whole else float(value)


class ParameterTable:
    """Values by name; `revision` counts changes.

    Parameters
    ----------
    changed
        Values that differ from the profile's, None for what this vehicle does not have; each name must be one of the
        profile's.
    """

    def __init__(self, autopilot: Autopilot, changed: Mapping[str, float | None] | None = None) -> None:
        self.revision = 0
        self._autopilot = autopilot
        self._values = dict(sorted(vehicle_profile(autopilot).parameters.items()))
        for name, value in (changed or {}).items():
            if name not in self._values:
                raise ValueError(f"expected a parameter of the simulated {autopilot.value}, got '{name}'")
            if value is None:
                del self._values[name]
            else:
                self._values[name] = type(self._values[name])(value)

    def values(self) -> dict[str, float]:
        """All of them by name, as they are now."""
        return dict(self._values)

    def __getitem__(self, name: str) -> float:
        return self._values[name]

    def receive(self, message: ParamSet | ParamRequestRead | ParamRequestList) -> list[Message]:
        """Answers to a message of the protocol; a name that the vehicle does not have is not answered."""
        match message:
            case ParamRequestList():
                return [self._message(name) for name in self._values]
            case ParamRequestRead():
                names = list(self._values)
                if 0 <= message.param_index < len(names):
                    return [self._message(names[message.param_index])]
                return [self._message(message.param_id)] if message.param_id in self._values else []
            case ParamSet():
                return self._set(message)

    def _set(self, message: ParamSet) -> list[Message]:
        name = message.param_id
        if name not in self._values:
            return []
        is_whole = isinstance(self._values[name], int)
        # PX4 refuses a value of the wrong type, ArduPilot converts it; both answer with what now holds.
        is_right_type = self._autopilot is Autopilot.ARDUPILOT or (message.param_type == INT32) == is_whole
        is_bytes = is_whole and self._autopilot is Autopilot.PX4
        if is_right_type and (is_bytes or math.isfinite(message.param_value)):
            self._values[name] = from_wire_value(message.param_value, is_whole, self._autopilot)
            self.revision += 1
        return [self._message(name)]

    def _message(self, name: str) -> ParamValue:
        value = self._values[name]
        kind = INT32 if isinstance(value, int) else REAL32
        index = list(self._values).index(name)
        return ParamValue(name, wire_value(value, self._autopilot), kind, len(self._values), index)
