"""Hears a vehicle while no sortie of ours is under way, and passes the pilot's orders on, as a state machine."""

from __future__ import annotations

import math
from collections import deque

from groundstation.vehicle.commands import CommandCall, CommandOutcome
from groundstation.vehicle.modes import set_mode_command
from groundstation.vehicle.run_records import ORDER_MODES, PilotOrder
from groundstation.vehicle.setup import message_requests
from groundstation.vehicle.state import VehicleState
from groundstation.vehicle.telemetry import LocalFrame, folded
from missions.mavlink.drive import GROUND_HEARTBEAT, HEARTBEAT_EVERY_S
from missions.mavlink.link import GROUND_STATION
from missions.mavlink.messages import Address, Message, Received

ASK_EVERY_S = 10.0
"""How often telemetry is asked for while no position comes: nobody acknowledges that here, and radios lose messages."""


class Listener:
    """Folds what is heard into a state.

    Parameters
    ----------
    state
        What is known already, as from a sortie that ended.
    """

    def __init__(self, frame: LocalFrame, state: VehicleState, own: Address = GROUND_STATION) -> None:
        self.state, self._frame, self._own = state, frame, own
        self.answers: tuple[CommandOutcome, ...] = ()
        self._orders: deque[PilotOrder] = deque()
        self._call: CommandCall | None = None
        self._heartbeat_s = self._asked_s = -math.inf

    def order(self, order: PilotOrder) -> None:
        """Queue an order; it goes out with the next `receive` or `tick`."""
        self._orders.append(order)

    def receive(self, received: Received) -> list[Message]:
        """Take a message."""
        self.state = folded(self.state, received, self._frame)
        sent = [] if self._call is None else self._call.receive(received)
        return [*sent, *self._advance(received.time_s)]

    def tick(self, now_s: float) -> list[Message]:
        """Let time pass."""
        sent = [] if self._call is None else self._call.tick(now_s)
        return [*sent, *self._advance(now_s)]

    def _advance(self, now_s: float) -> list[Message]:
        sent: list[Message] = []
        if self._call is not None and self._call.outcome is not None:
            self.answers = (*self.answers, self._call.outcome)
            self._call = None
        if self._call is None and self._orders:
            sent += self._begin(self._orders.popleft(), now_s)
        if now_s >= self._heartbeat_s + HEARTBEAT_EVERY_S:
            self._heartbeat_s = now_s
            sent.append(GROUND_HEARTBEAT)
            sent += self._ask(now_s)
        return sent

    def _begin(self, order: PilotOrder, now_s: float) -> list[Message]:
        autopilot, address = self.state.autopilot, self.state.address
        if autopilot is None or address is None:
            return []
        command = set_mode_command(autopilot, ORDER_MODES[order][autopilot], address.system, address.component)
        self._call = CommandCall(order.value, command, self._own)
        return self._call.start(now_s)

    def _ask(self, now_s: float) -> list[Message]:
        autopilot, address, motion = self.state.autopilot, self.state.address, self.state.motion
        is_told = motion is not None and motion.age_s(now_s) < ASK_EVERY_S
        if autopilot is None or address is None or is_told or now_s < self._asked_s + ASK_EVERY_S:
            return []
        self._asked_s = now_s
        return list(message_requests(autopilot, address))
