"""Parameters of the vehicle: read, and set with the vehicle's own word that they are, as state machines without a link.

    READING -> READING    no answer in time: asked again
            -> ended      unknown to the vehicle (no answer to any attempt), as wanted already, or only to be read
            -> SETTING    another value is wanted: sent in the vehicle's own type
    SETTING -> SETTING    no answer in time: sent again
            -> ended      the vehicle names the value wanted, or another, or nothing

An autopilot that does not know a parameter says nothing. PX4 carries the bytes of whole numbers in the float field,
ArduPilot their value; a float32 cannot hold those bytes where they spell a signalling NaN (-8388607 to -4194305).
"""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from groundstation.vehicle.repeated_request import RepeatedRequest
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import Address, Message, ParamRequestRead, ParamSet, ParamValue, Received

ATTEMPT_S = 1.0
N_ATTEMPTS = 8
"""Where a quarter of all messages is lost each way, of a thousand parameters one stays without an answer to all."""


_INTEGERS = {1: "<Bxxx", 2: "<bxxx", 3: "<Hxx", 4: "<hxx", 5: "<I", 6: "<i"}
"""struct formats of MAV_PARAM_TYPE 1 (uint8) to 6 (int32), padded to the four bytes of the float field."""


class ParameterStatus(Enum):
    """How it ended."""

    READ = "read"
    SET = "set"
    UNCHANGED = "had that value already"
    UNKNOWN = "the vehicle does not know it"
    REFUSED = "the vehicle keeps another value"
    NO_ANSWER = "no answer"


@dataclass(frozen=True, slots=True)
class ParameterOutcome:
    """What the vehicle last said of a parameter; `value` is None where it said nothing."""

    name: str
    status: ParameterStatus
    value: float | None
    former: float | None = None

    @property
    def is_as_set(self) -> bool:
        """Whether it was read, or now has the value that it should have."""
        return self.status in (ParameterStatus.READ, ParameterStatus.SET, ParameterStatus.UNCHANGED)


def decoded(message: ParamValue, autopilot: Autopilot) -> float:
    """Value of a parameter."""
    layout = _INTEGERS.get(message.param_type)
    if layout is None or autopilot is Autopilot.ARDUPILOT:
        return message.param_value
    (value,) = struct.unpack(layout, struct.pack("<f", message.param_value))
    return float(value)


def encoded(value: float, param_type: int, autopilot: Autopilot) -> float:
    """What goes into the float field.

    Raises
    ------
    ValueError
        The type is of whole numbers, and the value is none or too large for it.
    """
    layout = _INTEGERS.get(param_type)
    if layout is None:
        return value
    if value != round(value):
        raise ValueError(f"expected a whole number, got {value:g}")
    try:
        content = struct.pack(layout, round(value))
    except struct.error as error:
        raise ValueError(f"{value:g} does not fit the parameter's type {param_type}") from error
    if autopilot is Autopilot.ARDUPILOT:
        return value
    (carried,) = struct.unpack("<f", content)
    return float(carried)


class ParameterCall(RepeatedRequest):
    """One parameter being read, or set.

    Parameters
    ----------
    new_value
        The value that it shall have; None: only read it.
    """

    def __init__(self, name: str, new_value: float | None, autopilot: Autopilot, target: Address) -> None:
        super().__init__(N_ATTEMPTS, ATTEMPT_S)
        self.name, self._new_value, self._autopilot, self._target = name, new_value, autopilot, target
        self.outcome: ParameterOutcome | None = None
        self._setting: ParamSet | None = None
        self._former: float | None = None

    def receive(self, received: Received) -> list[Message]:
        """Take a message; the first value leads to the setting of another."""
        message = received.message
        is_it = isinstance(message, ParamValue) and message.param_id == self.name
        if self.outcome is not None or not is_it or received.source.system != self._target.system:
            return []
        assert isinstance(message, ParamValue)
        value = decoded(message, self._autopilot)
        if self._setting is None:
            return self._heard(value, message.param_type, received.time_s)
        if self._is_wanted(value):
            self._end(ParameterStatus.SET, value)
        elif value != self._former or self._n_sent > 1:
            # The former value may still be on its way from the reading; a second one is an answer.
            self._end(ParameterStatus.REFUSED, value)
        return []

    def _heard(self, value: float, param_type: int, now_s: float) -> list[Message]:
        self._former = value
        if self._new_value is None:
            return self._end(ParameterStatus.READ, value)
        if self._is_wanted(value):
            return self._end(ParameterStatus.UNCHANGED, value)
        try:
            carried = encoded(self._new_value, param_type, self._autopilot)
        except ValueError:
            return self._end(ParameterStatus.REFUSED, value)
        target = self._target
        self._setting = ParamSet(target.system, target.component, self.name, carried, param_type)
        self._n_sent = 0
        return self._send(now_s)

    def _messages(self) -> list[Message]:
        target = self._target
        return [self._setting or ParamRequestRead(target.system, target.component, self.name)]

    def _give_up(self) -> None:
        self._end(ParameterStatus.UNKNOWN if self._setting is None else ParameterStatus.NO_ANSWER, self._former)

    def _is_wanted(self, value: float) -> bool:
        """Whether a value is the one wanted, to float32."""
        return self._new_value is not None and math.isclose(value, self._new_value, rel_tol=1e-6, abs_tol=1e-9)

    def _end(self, status: ParameterStatus, value: float | None) -> list[Message]:
        self.outcome = ParameterOutcome(self.name, status, value, self._former)
        return []


# Several parameters read at once, as a state machine without a link.
#
# ASKING -> ASKING    not all came in time: those that are missing are asked for again
#        -> ended     all came, or nothing new comes any more: the vehicle does not know the others

N_ROUNDS = 5
"""Rounds in a row in which nothing new comes, before what is missing is taken for unknown to the vehicle."""


class ParameterReads(RepeatedRequest):
    """Reads; `outcome` holds the values by name, without those that the vehicle does not know."""

    def __init__(self, names: Sequence[str], autopilot: Autopilot, target: Address) -> None:
        super().__init__(N_ROUNDS, ATTEMPT_S)
        self._names, self._autopilot, self._target = tuple(names), autopilot, target
        self._values: dict[str, float] = {}
        self.outcome: dict[str, float] | None = None

    def receive(self, received: Received) -> list[Message]:
        """Take a message; nothing is sent in answer."""
        message = received.message
        is_ours = isinstance(message, ParamValue) and message.param_id in self._names
        if self.outcome is None and is_ours and received.source.system == self._target.system:
            assert isinstance(message, ParamValue)
            if message.param_id not in self._values:
                self._n_sent = 1
            self._values[message.param_id] = decoded(message, self._autopilot)
            if len(self._values) == len(self._names):
                self.outcome = self._values
        return []

    def _messages(self) -> list[Message]:
        target = self._target
        missing = (name for name in self._names if name not in self._values)
        return [ParamRequestRead(target.system, target.component, name) for name in missing]

    def _give_up(self) -> None:
        self.outcome = self._values
