"""Settings of a camera that speaks MAVLink's camera protocol: set, acknowledged and read back, without any link.

    READING   -> READING    no answer in time: asked again
              -> ended      unknown to the camera (no answer to any attempt), or as wanted already
              -> SETTING    another value is wanted: sent in the camera's own type
    SETTING   -> SETTING    no acknowledgement in time, or the camera is still at it: sent again
              -> ended      the camera refuses the value, or does not answer
              -> VERIFYING  the camera accepts it
    VERIFYING -> VERIFYING  no answer in time: asked again
              -> ended      the camera names the value wanted, or another, or nothing

The camera is a component of the vehicle; which one it is, its first answer says.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import Enum
from functools import cache
from pathlib import Path

from groundstation.vehicle.parameters import ParameterOutcome, ParameterStatus
from groundstation.vehicle.repeated_request import RepeatedRequest
from missions.mavlink.messages import (
    Message,
    ParamExtAck,
    ParamExtRequestRead,
    ParamExtSet,
    ParamExtValue,
    Received,
)
from missions.mission.model import Mission
from planning.base.json_file import read_toml
from planning.base.messages import joined, say
from planning.optics import shutter_text

DATA_PATH = Path(__file__).parent / "data" / "camera.toml"

ATTEMPT_S, N_ATTEMPTS = 1.0, 4
ANY_COMPONENT = 0

ACCEPTED, IN_PROGRESS = 0, 3
"""PARAM_ACK; all others refuse."""

_LAYOUTS = {1: "<B", 2: "<b", 3: "<H", 4: "<h", 5: "<I", 6: "<i", 7: "<Q", 8: "<q", 9: "<f", 10: "<d"}
"""struct formats of MAV_PARAM_EXT_TYPE; 11 is a value of the camera's own kind."""

FIELD_BYTES = 128


@dataclass(frozen=True, slots=True)
class CameraNames:
    """What the data file holds; it explains the fields."""

    mode: str
    shutter: str
    aperture: str
    iso: str
    compensation: str
    white_balance: str
    modes: dict[str, float]
    white_balances: dict[str, float]


@cache
def names() -> CameraNames:
    """Names of the parameters, and their numbers."""
    return read_toml(DATA_PATH, CameraNames)


def decoded(value: bytes, param_type: int) -> float | None:
    """A value as a number; None where it is of the camera's own kind."""
    layout = _LAYOUTS.get(param_type)
    return None if layout is None else float(struct.unpack_from(layout, value.ljust(FIELD_BYTES, b"\0"))[0])


def encoded(value: float, param_type: int) -> bytes:
    """A number in the camera's type.

    Raises
    ------
    ValueError
        The type does not hold it.
    """
    layout = _LAYOUTS.get(param_type)
    is_whole = layout is not None and layout[-1] not in "fd"
    if layout is None or not math.isfinite(value) or (is_whole and value != round(value)):
        raise ValueError(f"{value:g} does not fit the type {param_type} of the camera's parameter")
    try:
        return struct.pack(layout, round(value) if is_whole else value).ljust(FIELD_BYTES, b"\0")
    except (struct.error, OverflowError) as error:
        raise ValueError(f"{value:g} does not fit the type {param_type} of the camera's parameter") from error


def wanted_settings(mission: Mission) -> dict[str, float]:
    """Parameters for a mission's camera settings, as far as there are names for them; none where it has no such camera.

    The mode comes first: cameras take the others in their mode only.
    """
    controls, settings, known = mission.camera_controls, mission.camera_settings, names()
    if controls is None or "parameters" not in controls.mavlink:
        return {}
    wanted = {known.mode: known.modes[settings.exposure]}
    if settings.exposure == "manual":
        is_fixed = controls.aperture[0] == controls.aperture[1]
        values = (
            (known.shutter, settings.shutter_s),
            (known.aperture, None if is_fixed else mission.f_number),
            (known.iso, settings.iso),
        )
        wanted |= {name: float(value) for name, value in values if value is not None}
    else:
        wanted[known.compensation] = settings.compensation_ev
    if settings.white_balance in known.white_balances:
        wanted[known.white_balance] = known.white_balances[settings.white_balance]
    return wanted


class _Step(Enum):
    READING = "reading"
    SETTING = "setting"
    VERIFYING = "verifying"


class CameraSettingCall(RepeatedRequest):
    """One setting of a camera being made.

    Parameters
    ----------
    system
        The vehicle's.
    """

    def __init__(self, name: str, value: float, system: int) -> None:
        super().__init__(N_ATTEMPTS, ATTEMPT_S)
        self.name, self._wanted, self._system = name, value, system
        self.outcome: ParameterOutcome | None = None
        self._step, self._component = _Step.READING, ANY_COMPONENT
        self._content, self._type = b"", 0
        self._former: float | None = None

    def receive(self, received: Received) -> list[Message]:
        """Take a message."""
        message, source = received.message, received.source
        if self.outcome is not None or source.system != self._system:
            return []
        if self._component not in (ANY_COMPONENT, source.component):
            return []
        if isinstance(message, ParamExtValue) and message.param_id == self.name and self._step is not _Step.SETTING:
            self._component = source.component
            return self._heard(decoded(message.param_value, message.param_type), message.param_type, received.time_s)
        if isinstance(message, ParamExtAck) and message.param_id == self.name and self._step is _Step.SETTING:
            return self._acknowledged(message, received.time_s)
        return []

    def _heard(self, value: float | None, param_type: int, now_s: float) -> list[Message]:
        is_wanted = value is not None and math.isclose(value, self._wanted, rel_tol=1e-5, abs_tol=1e-6)
        if self._step is _Step.VERIFYING:
            return self._end(ParameterStatus.SET if is_wanted else ParameterStatus.REFUSED, value)
        self._former = value
        if is_wanted:
            return self._end(ParameterStatus.UNCHANGED, value)
        try:
            self._content, self._type = encoded(self._wanted, param_type), param_type
        except ValueError:
            return self._end(ParameterStatus.REFUSED, value)
        return self._go(_Step.SETTING, now_s)

    def _acknowledged(self, ack: ParamExtAck, now_s: float) -> list[Message]:
        if ack.param_result == IN_PROGRESS:
            self._deadline_s = now_s + self._attempt_s
            return []
        if ack.param_result != ACCEPTED:
            return self._end(ParameterStatus.REFUSED, self._former)
        return self._go(_Step.VERIFYING, now_s)

    def _go(self, step: _Step, now_s: float) -> list[Message]:
        self._step, self._n_sent = step, 0
        return self._send(now_s)

    def _messages(self) -> list[Message]:
        if self._step is _Step.SETTING:
            return [ParamExtSet(self._system, self._component, self.name, self._content, self._type)]
        return [ParamExtRequestRead(self._system, self._component, self.name)]

    def _give_up(self) -> None:
        is_unknown = self._step is _Step.READING
        self._end(ParameterStatus.UNKNOWN if is_unknown else ParameterStatus.NO_ANSWER, self._former)

    def _end(self, status: ParameterStatus, value: float | None) -> list[Message]:
        self.outcome = ParameterOutcome(self.name, status, value, self._former)
        return []


def setting_texts(values: Iterable[tuple[str, float]]) -> Iterator[str]:
    """Settings in words."""
    known = names()
    modes = {number: name for name, number in known.modes.items() if name != "locked"}
    balances = {number: name for name, number in known.white_balances.items()}
    for name, value in values:
        if name == known.mode:
            yield say("manual exposure") if modes.get(value) == "manual" else say("automatic exposure")
        elif name == known.shutter:
            yield shutter_text(value)
        elif name == known.aperture:
            yield f"f/{value:g}"
        elif name == known.iso:
            yield f"ISO {value:g}"
        elif name == known.compensation:
            yield say("exposure compensation {} EV", f"{value:+g}" if value else "0")
        else:
            words = {
                "sunny": say("white balance for sun"),
                "cloudy": say("white balance for clouds"),
                "auto": say("automatic white balance"),
            }
            yield words[balances[value]]


def settings_text(values: Iterable[tuple[str, float]]) -> str:
    """Settings in words, in one line."""
    return joined(", ", setting_texts(values))
