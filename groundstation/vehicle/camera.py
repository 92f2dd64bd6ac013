"""Settings of a camera that speaks MAVLink's camera protocol: set, acknowledged and read back, without any link.

    READING   -> READING    no answer in time: asked again
              -> ended      unknown to the camera (no answer to any attempt), or as wanted already
              -> SETTING    another value is wanted: sent in the camera's own type
    SETTING   -> SETTING    no acknowledgement in time, or the camera is still at it: sent again
              -> ended      the camera refuses the value, or does not answer
              -> VERIFYING  the camera accepts it
    VERIFYING -> VERIFYING  no answer in time: asked again
              -> ended      the camera names the value wanted, or another, or nothing

The camera is a component of the vehicle; which one it is, its first answer says. A camera that tells of its own
definition file (`CameraInformationCall`) is set by the names and options in it.
"""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cache
from pathlib import Path
from typing import Literal

from groundstation.vehicle.parameters import ParameterOutcome, ParameterStatus
from groundstation.vehicle.repeated_request import RepeatedRequest
from missions.mavlink.camera_definition import SAME_EV, CameraDefinition, find_parameter, value_of
from missions.mavlink.messages import (
    Address,
    CameraInformation,
    CommandLong,
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
    others: dict[str, tuple[str, ...]]
    described: dict[str, tuple[str, ...]]


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


Role = Literal["mode", "shutter", "aperture", "iso", "compensation", "white_balance"]
"""What a parameter sets; a field of `CameraNames`."""


@dataclass(frozen=True, slots=True)
class WantedSetting:
    """A parameter that has to have a value.

    Parameters
    ----------
    text
        What that means, for the pilot.
    value
        None where the camera has none such.
    """

    name: str
    text: str
    value: float | None


NO_VALUES: Mapping[str, float] = {}


def speaks_parameters(mission: Mission) -> bool:
    """Whether the camera of a mission's profile takes parameters."""
    return mission.camera_controls is not None and "parameters" in mission.camera_controls.mavlink


def _wanted(mission: Mission) -> Iterator[tuple[Role, float | str]]:
    """What a mission's camera settings set, as numbers and words; the mode first: it decides what else is taken."""
    controls, settings, known = mission.camera_controls, mission.camera_settings, names()
    if controls is None:
        return
    yield "mode", "manual" if settings.exposure == "manual" else "auto"
    if settings.exposure == "manual":
        if settings.shutter_s is not None:
            yield "shutter", settings.shutter_s
        if controls.aperture[0] != controls.aperture[1] and mission.f_number is not None:
            yield "aperture", mission.f_number
        if settings.iso is not None:
            yield "iso", float(settings.iso)
    else:
        yield "compensation", settings.compensation_ev
    if settings.white_balance in known.white_balances:
        yield "white_balance", settings.white_balance


def wanted_settings(
    mission: Mission, definition: CameraDefinition | None = None, values: Mapping[str, float] = NO_VALUES
) -> tuple[WantedSetting, ...]:
    """Parameters for a mission's camera settings, as far as there are names for them; none where it has no such camera.

    Parameters
    ----------
    definition
        Of the camera; None: it has the names and numbers of the guide's example.
    values
        What its parameters have now, by name; those that are not told have the definition's defaults. What a value of
        one leaves of another's options, as the mode does, counts in the order of setting.
    """
    if definition is None and not speaks_parameters(mission):
        return ()
    known = names()
    found = []
    state = {} if definition is None else definition.defaults | dict(values)
    for role, wanted in _wanted(mission):
        text, standard = setting_text(role, wanted), getattr(known, role)
        if definition is None:
            numbers = known.modes if role == "mode" else known.white_balances
            value = numbers[wanted] if isinstance(wanted, str) else wanted
            found.append(WantedSetting(standard, text, value))
            continue
        parameter = find_parameter(definition, (standard, *known.others[role]), known.described[role])
        if parameter is None:
            found.append(WantedSetting("", text, None))
            continue
        left = definition.left_of(parameter, state)
        option = None if left is None else value_of(left, wanted, SAME_EV if role == "compensation" else 0.0)
        if option is not None:
            state[parameter.name] = option.value
        found.append(WantedSetting(parameter.name, text, None if option is None else option.value))
    return tuple(found)


class _Step(Enum):
    READING = "reading"
    SETTING = "setting"
    VERIFYING = "verifying"


class CameraSettingCall(RepeatedRequest):
    """One setting of a camera being made.

    Parameters
    ----------
    wanted
        None: whatever it is now, which is read alone.
    system
        The vehicle's.
    """

    def __init__(self, name: str, wanted: float | None, system: int) -> None:
        super().__init__(N_ATTEMPTS, ATTEMPT_S)
        self.name, self._wanted, self._system = name, wanted, system
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
        if self._wanted is None:
            return self._end(ParameterStatus.READ, value)
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


def setting_text(role: Role, wanted: float | str) -> str:
    """A setting in words."""
    if isinstance(wanted, str):
        balances = {
            "sunny": say("white balance for sun"),
            "cloudy": say("white balance for clouds"),
            "auto": say("automatic white balance"),
        }
        if role == "white_balance":
            return balances[wanted]
        return say("manual exposure") if wanted == "manual" else say("automatic exposure")
    if role == "shutter":
        return shutter_text(wanted)
    if role == "compensation":
        return say("exposure compensation {} EV", f"{wanted:+g}" if wanted else "0")
    return f"f/{wanted:g}" if role == "aperture" else f"ISO {wanted:g}"


def settings_text(settings: Iterable[WantedSetting]) -> str:
    """Settings in words, in one line."""
    return joined(", ", (setting.text for setting in settings))


# The camera's own definition file: asked for once, and fetched from the camera itself, never from anywhere else.

MAV_CMD_REQUEST_MESSAGE, CAMERA_INFORMATION, ALL_COMPONENTS = 512, 259.0, 0

_ON_BOARD = re.compile(
    r"(?:mftp|mavlinkftp)://(?:\[;comp=(?P<component>\d{1,3})\])?(?P<path>[^\[\]\0]{1,200})", re.ASCII
)


class CameraInformationCall(RepeatedRequest):
    """Asks the vehicle's cameras who they are; `outcome` holds who answered first, and what: None where none did.

    Parameters
    ----------
    system
        The vehicle's.
    """

    def __init__(self, system: int) -> None:
        super().__init__(N_ATTEMPTS, ATTEMPT_S)
        self._system = system
        self.outcome: tuple[Address, CameraInformation | None] | None = None

    def receive(self, received: Received) -> list[Message]:
        """Take a message."""
        message = received.message
        if self.outcome is None and isinstance(message, CameraInformation) and received.source.system == self._system:
            self.outcome = (received.source, message)
        return []

    def _messages(self) -> list[Message]:
        return [CommandLong(self._system, ALL_COMPONENTS, MAV_CMD_REQUEST_MESSAGE, CAMERA_INFORMATION)]

    def _give_up(self) -> None:
        self.outcome = (Address(self._system, ALL_COMPONENTS), None)


def definition_place(information: CameraInformation, source: Address) -> tuple[Address, str] | None:
    """Component and path of a camera's definition file on board; None where it has none there."""
    found = _ON_BOARD.fullmatch(information.cam_definition_uri.strip())
    if found is None:
        return None
    component = source.component if found["component"] is None else int(found["component"])
    return Address(source.system, component), found["path"]
