"""Upload of a list of items, without reading back: part of `verified.VerifiedUpload`, which does.

| state | event | does | next |
|---|---|---|---|
| READY | start | COUNT | ANNOUNCED |
| ANNOUNCED | silence | COUNT again | ANNOUNCED |
| ANNOUNCED, SENDING, CLOSING | vehicle asks for item i | item i | SENDING, CLOSING once the last was sent |
| ANNOUNCED, SENDING, CLOSING | it asks for item 0 after others | item 0 | SENDING |
| SENDING | silence | item i again; from the second time on item i + 1 too | SENDING, CLOSING |
| SENDING | ACK INVALID_SEQUENCE | item i + 1, once for each repeat | SENDING, CLOSING |
| SENDING | ACK ERROR, OPERATION_CANCELLED | COUNT: the vehicle has given up | ANNOUNCED |
| ANNOUNCED | ACK ERROR, UNSUPPORTED, OPERATION_CANCELLED | COUNT after a pause, for some time: busy, starting | same |
| SENDING, ANNOUNCED | ACK ACCEPTED | nothing: it belongs to an earlier transfer | same |
| CLOSING | ACK ACCEPTED | | ENDED: done |
| CLOSING | silence | as in SENDING | CLOSING, after some times ENDED: unconfirmed |
| CLOSING | ACK ERROR, OPERATION_CANCELLED | | ENDED: unconfirmed |
| any | any other ACK | | ENDED: refused |
| any | it asks beyond the end, or begins anew, again and again | | ENDED: out of step |
| any | long silence, no progress | | ENDED: silent, stalled |

Item i + 1 without being asked for gets on where the item arrived and the next question was lost: the receiver takes it
if it waits for it and drops it otherwise. Nothing else than the vehicle's answers ever doubles a message.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import Enum, auto

from missions.mavlink.messages import (
    Message,
    MissionAck,
    MissionCount,
    MissionItemInt,
    MissionRequest,
    MissionRequestInt,
    Received,
)
from missions.mavlink.transfer.exchange import DEFAULT_TIMING, NOT_YET, Ending, Patience, Result, Route, Timing

STRAYS = 5
"""Requests beyond the end that are ignored: some may be left over from a longer list."""

MAX_COUNT = 65535


class UploadState(Enum):
    """Where an upload stands; see the module for the transitions."""

    READY = auto()
    ANNOUNCED = auto()
    SENDING = auto()
    CLOSING = auto()
    ENDED = auto()


@dataclass(frozen=True, slots=True)
class UploadOutcome:
    """How an upload ended.

    Parameters
    ----------
    result
        What the vehicle answered, where it did: a `Result`, or a number that is none.
    seq
        Item that was asked for last; None where none was, so that nothing on board has changed.
    """

    ending: Ending
    result: int | None = None
    seq: int | None = None


@dataclass(slots=True)
class Upload:
    """Sends items to the vehicle as it asks for them.

    Parameters
    ----------
    items
        In order; `seq`, target and mission type are filled in here.
    """

    route: Route
    items: Sequence[MissionItemInt]
    timing: Timing = DEFAULT_TIMING
    state: UploadState = field(init=False, default=UploadState.READY)
    outcome: UploadOutcome | None = field(init=False, default=None)
    _patience: Patience = field(init=False)
    _seq: int = field(init=False, default=-1)
    _answered_s: dict[int, float] = field(init=False, default_factory=dict)
    _may_guess: bool = field(init=False, default=False)
    _restarts: int = field(init=False, default=0)
    _strays: int = field(init=False, default=0)
    _furthest: int | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        if len(self.items) > MAX_COUNT:
            raise ValueError(f"items: expected at most {MAX_COUNT}, got {len(self.items)}")
        vehicle, kind = self.route.vehicle, self.route.mission_type
        self.items = tuple(
            replace(item, seq=seq, target_system=vehicle.system, target_component=vehicle.component, mission_type=kind)
            for seq, item in enumerate(self.items)
        )
        self._patience = Patience(self.timing)

    @property
    def next_deadline_s(self) -> float:
        """When to repeat or to give up; never once it has ended."""
        return self._patience.next_deadline_s if self.outcome is None else math.inf

    @property
    def progress(self) -> tuple[str, float, float]:
        """Items asked for so far."""
        return "uploading", self._seq + 1, len(self.items)

    def start(self, now_s: float) -> list[Message]:
        """Announce the items."""
        if self.state is not UploadState.READY:
            raise ValueError("an upload starts once")
        self._patience.begin(now_s)
        return self._announce(now_s)

    def _announce(self, now_s: float) -> list[Message]:
        # A count of 0 is acknowledged at once.
        self.state = UploadState.ANNOUNCED if self.items else UploadState.CLOSING
        self._seq = -1
        self._answered_s.clear()
        self._patience.ask(now_s)
        return [self._count()]

    def _count(self) -> MissionCount:
        vehicle = self.route.vehicle
        return MissionCount(vehicle.system, vehicle.component, len(self.items), self.route.mission_type)

    def receive(self, received: Received) -> list[Message]:
        """Answer the vehicle."""
        message = self.route.message_of(received)
        if self.outcome is not None or self.state is UploadState.READY:
            return []
        if isinstance(message, MissionRequest | MissionRequestInt):
            return self._asked_for(message.seq, received.time_s)
        if isinstance(message, MissionAck):
            return self._acknowledged(message.type, received.time_s)
        return []

    def _asked_for(self, seq: int, now_s: float) -> list[Message]:
        if seq >= len(self.items):
            self._strays += 1
            return self._end(Ending.OUT_OF_STEP) if self._strays > STRAYS else []
        self._patience.hear(now_s)
        is_anew = seq == 0 and self._seq > 0
        if is_anew:
            self._restarts += 1
            if self._restarts > self.timing.restarts:
                return self._end(Ending.OUT_OF_STEP)
            self._answered_s.clear()
        if seq > self._seq or is_anew:
            self._patience.advance(now_s)
            self._patience.ask(now_s, is_new=seq not in self._answered_s)
            self._seq = self._furthest = seq
            self.state = UploadState.SENDING
        is_copy = now_s < self._answered_s.get(seq, -math.inf) + self._patience.repeat_gap_s
        return [] if is_copy else self._send(seq, 1, now_s)

    def _send(self, first: int, n: int, now_s: float) -> list[Message]:
        """Up to n items from one on."""
        items = self.items[first : first + n]
        self._answered_s.update((item.seq, now_s) for item in items)
        if len(self.items) - 1 in self._answered_s:
            self.state = UploadState.CLOSING
        return list(items)

    def _acknowledged(self, result: int, now_s: float) -> list[Message]:
        if result == Result.ACCEPTED:
            return self._end(Ending.DONE, result) if self.state is UploadState.CLOSING else []
        if result == Result.INVALID_SEQUENCE:
            self._patience.hear(now_s)
            if self._may_guess and self.state is UploadState.SENDING:
                self._may_guess = False
                return self._send(self._seq + 1, 1, now_s)
            return []
        is_starting = self.state is UploadState.ANNOUNCED and result in NOT_YET
        if is_starting or result in (Result.ERROR, Result.OPERATION_CANCELLED):
            return self._given_up(result, now_s)
        return self._end(Ending.REFUSED, result)

    def _given_up(self, result: int, now_s: float) -> list[Message]:
        """The vehicle is not receiving any more: begin anew, unless it has had everything."""
        if self.state is UploadState.CLOSING:
            return self._end(Ending.UNCONFIRMED, result)
        if self.state is UploadState.ANNOUNCED and self._patience.asks_again(now_s):
            return []
        self._restarts += 1
        if self.state is UploadState.ANNOUNCED or self._restarts > self.timing.restarts:
            return self._end(Ending.REFUSED, result)
        self._patience.hear(now_s)
        return self._announce(now_s)

    def tick(self, now_s: float) -> list[Message]:
        """Repeat what is open, or give up."""
        if self.outcome is not None or now_s < self.next_deadline_s:
            return []
        ending = self._patience.gave_up(now_s)
        is_closing = self.state is UploadState.CLOSING
        if is_closing and (ending or self._patience.repeats >= self.timing.acknowledgement_repeats):
            return self._end(Ending.UNCONFIRMED)
        if ending is not None:
            return self._end(ending)
        self._patience.repeat(now_s)
        if self._seq < 0:
            return [self._count()]
        self._may_guess = True
        return self._send(self._seq, 2 if self._patience.repeats > 1 else 1, now_s)

    def cancel(self) -> list[Message]:
        """Tell the vehicle that no more items come."""
        return [self.route.ack(Result.OPERATION_CANCELLED)]

    def _end(self, ending: Ending, result: int | None = None) -> list[Message]:
        self.state = UploadState.ENDED
        self.outcome = UploadOutcome(ending, result, self._furthest)
        return []
