"""Clearing a list on the vehicle.

| state | event | does | next |
|---|---|---|---|
| READY | start | CLEAR_ALL | ASKED |
| ASKED | silence | CLEAR_ALL again | ASKED |
| ASKED | ACK ACCEPTED | | ENDED: done |
| ASKED | ACK DENIED, ERROR, UNSUPPORTED | CLEAR_ALL after a pause, for some time: busy, or starting | ASKED |
| ASKED | ACK INVALID_SEQUENCE, OPERATION_CANCELLED | nothing: it belongs to an upload before | ASKED |
| ASKED | any other ACK | | ENDED: refused |
| ASKED | long silence | | ENDED: silent |

Whether the list is empty then, only reading it back tells: `verified.VerifiedUpload` with no items.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum, auto

from missions.mavlink.messages import Message, MissionAck, MissionClearAll, Received
from missions.mavlink.transfer.exchange import DEFAULT_TIMING, NOT_YET, Ending, Patience, Result, Route, Timing


class ClearState(Enum):
    """Where it stands; see the module for the transitions."""

    READY = auto()
    ASKED = auto()
    ENDED = auto()


@dataclass(frozen=True, slots=True)
class ClearOutcome:
    """How it ended, and what the vehicle answered where it did."""

    ending: Ending
    result: int | None = None


@dataclass(slots=True)
class Clear:
    """Asks the vehicle to forget its items."""

    route: Route
    timing: Timing = DEFAULT_TIMING
    state: ClearState = field(init=False, default=ClearState.READY)
    outcome: ClearOutcome | None = field(init=False, default=None)
    _patience: Patience = field(init=False)

    def __post_init__(self) -> None:
        self._patience = Patience(self.timing)

    @property
    def next_deadline_s(self) -> float:
        """When to repeat or to give up; never once it has ended."""
        return self._patience.next_deadline_s if self.outcome is None else math.inf

    @property
    def progress(self) -> tuple[str, float, float]:
        """All or nothing."""
        return "clearing", float(self.state is ClearState.ENDED), 1

    def start(self, now_s: float) -> list[Message]:
        """Ask."""
        if self.state is not ClearState.READY:
            raise ValueError("clearing starts once")
        self.state = ClearState.ASKED
        self._patience.begin(now_s)
        self._patience.ask(now_s)
        return [self._question()]

    def _question(self) -> Message:
        vehicle = self.route.vehicle
        return MissionClearAll(vehicle.system, vehicle.component, self.route.mission_type)

    def receive(self, received: Received) -> list[Message]:
        """Take the acknowledgement."""
        message = self.route.message_of(received)
        if self.state is ClearState.ASKED and isinstance(message, MissionAck):
            if message.type == Result.ACCEPTED:
                self._end(Ending.DONE, message.type)
            elif message.type in (Result.INVALID_SEQUENCE, Result.OPERATION_CANCELLED):
                self._patience.hear(received.time_s)
            elif message.type not in {Result.DENIED, *NOT_YET} or not self._patience.asks_again(received.time_s):
                self._end(Ending.REFUSED, message.type)
        return []

    def tick(self, now_s: float) -> list[Message]:
        """Ask again, or give up."""
        if self.outcome is not None or now_s < self.next_deadline_s:
            return []
        ending = self._patience.gave_up(now_s)
        if ending is not None:
            self._end(ending)
            return []
        self._patience.repeat(now_s)
        return [self._question()]

    def cancel(self) -> list[Message]:
        """Nothing to say: the question is out."""
        return []

    def _end(self, ending: Ending, result: int | None = None) -> None:
        self.state = ClearState.ENDED
        self.outcome = ClearOutcome(ending, result)
