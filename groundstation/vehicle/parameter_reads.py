"""Several parameters read at once, as a state machine without a link.

ASKING -> ASKING    not all came in time: those that are missing are asked for again
       -> ended     all came, or nothing new comes any more: the vehicle does not know the others
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from groundstation.vehicle.parameters import ATTEMPT_S, decoded
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import Address, Message, ParamRequestRead, ParamValue, Received

N_ROUNDS = 5
"""Rounds in a row in which nothing new comes, before what is missing is taken for unknown to the vehicle."""


class ParameterReads:
    """Reads; `outcome` holds the values by name, without those that the vehicle does not know."""

    def __init__(self, names: Sequence[str], autopilot: Autopilot, target: Address) -> None:
        self._names, self._autopilot, self._target = tuple(names), autopilot, target
        self._values: dict[str, float] = {}
        self.outcome: dict[str, float] | None = None
        self._n_sent = 0
        self._deadline_s = math.inf

    @property
    def next_deadline_s(self) -> float:
        """When `tick` wants to be called; infinity once it has ended."""
        return self._deadline_s if self.outcome is None else math.inf

    def start(self, now_s: float) -> list[Message]:
        """Ask for all."""
        return self._send(now_s)

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

    def tick(self, now_s: float) -> list[Message]:
        """Ask again for what is missing, or give up on it."""
        if self.outcome is not None or now_s < self._deadline_s:
            return []
        if self._n_sent < N_ROUNDS:
            return self._send(now_s)
        self.outcome = self._values
        return []

    def _send(self, now_s: float) -> list[Message]:
        self._n_sent += 1
        self._deadline_s = now_s + ATTEMPT_S
        target = self._target
        missing = (name for name in self._names if name not in self._values)
        return [ParamRequestRead(target.system, target.component, name) for name in missing]
