"""The vehicle's module for remote identification, as ArduPilot with an ArduRemoteID module behaves; where it has one.

DID_ENABLE 1 is a vehicle with such a module, DID_OPTIONS 1 one that does not arm before the module is content. The
order of the reasons is AP_OpenDroneID's, the module's words are ArduRemoteID's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from missions.mavlink.messages import (
    Message,
    OpenDroneIdArmStatus,
    OpenDroneIdBasicId,
    OpenDroneIdOperatorId,
    OpenDroneIdSelfId,
    OpenDroneIdSystem,
)
from missions.simulator.autopilot.parameters import ParameterTable

FRESH_S, LASTS_S, KEPT_S = 3.0, 22.0, 1e9
"""How old the operator's place may be, and all else; the aircraft's number is kept (ArduRemoteID)."""

EVERY_S = 1.0
GOOD, REFUSED = 0, 1
ENFORCES = 1
"""Bit of DID_OPTIONS."""

RemoteIdMessage = OpenDroneIdBasicId | OpenDroneIdOperatorId | OpenDroneIdSelfId | OpenDroneIdSystem


@dataclass(slots=True)
class RemoteIdModule:
    """Hears what the ground station sends, and says whether it is content."""

    parameters: ParameterTable
    heard: dict[type[Message], tuple[Message, float]] = field(default_factory=dict)
    _told_s: float = -math.inf

    @property
    def is_there(self) -> bool:
        """Whether the vehicle has one."""
        return "DID_ENABLE" in self.parameters.values() and self.parameters["DID_ENABLE"] == 1

    def receive(self, message: RemoteIdMessage, now_s: float) -> None:
        """Note a message."""
        if self.is_there:
            self.heard[type(message)] = (message, now_s)

    def tick(self, now_s: float, has_position: bool) -> list[Message]:
        """Say once a second how it is."""
        if now_s < self._told_s + EVERY_S or not self.is_there:
            return []
        self._told_s = now_s
        missing = self.missing(now_s, has_position)
        return [OpenDroneIdArmStatus(REFUSED if missing else GOOD, missing)]

    def missing(self, now_s: float, has_position: bool) -> str:
        """What the module lacks, in its words; empty where it is content."""
        found = [] if has_position else ["LOC"]
        for kind, word, lasts_s in (
            (OpenDroneIdBasicId, "ID", KEPT_S),
            (OpenDroneIdSelfId, "SELF_ID", LASTS_S),
            (OpenDroneIdOperatorId, "OP_ID", LASTS_S),
            (OpenDroneIdSystem, "SYS", FRESH_S),
        ):
            found += [] if self._age_s(kind, now_s) <= lasts_s else [word]
        if not self._knows_operator:
            found.append("OP_LOC")
        return " ".join(found)

    def arming_refusal(self, now_s: float, has_position: bool) -> str | None:
        """Why the autopilot does not arm; None where it may."""
        if not self.is_there or not int(self.parameters["DID_OPTIONS"]) & ENFORCES:
            return None
        if OpenDroneIdBasicId not in self.heard:
            return "OpenDroneID: UA_TYPE required in BasicID"
        if not self._knows_operator:
            return "OpenDroneID: operator location must be set"
        if self._age_s(OpenDroneIdSystem, now_s) > FRESH_S:
            return "OpenDroneID: SYSTEM not available"
        missing = self.missing(now_s, has_position)
        return f"OpenDroneID: {missing}" if missing else None

    @property
    def _knows_operator(self) -> bool:
        system = self.heard.get(OpenDroneIdSystem, (None, 0.0))[0]
        return isinstance(system, OpenDroneIdSystem) and (system.operator_latitude, system.operator_longitude) != (0, 0)

    def _age_s(self, kind: type[Message], now_s: float) -> float:
        return now_s - self.heard[kind][1] if kind in self.heard else math.inf
