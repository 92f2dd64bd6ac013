"""Download of a list of items.

| state | event | does | next |
|---|---|---|---|
| READY | start | REQUEST_LIST | LISTING |
| LISTING | COUNT n | REQUEST_INT 0; ACK where n is 0 | FETCHING; ENDED: done where n is 0 |
| LISTING | silence | REQUEST_LIST again | LISTING |
| LISTING | ACK DENIED, ERROR, UNSUPPORTED | REQUEST_LIST after a pause, for some time: busy, or starting | LISTING |
| LISTING | ACK INVALID_SEQUENCE, OPERATION_CANCELLED | nothing: it belongs to an upload before | LISTING |
| FETCHING | item i, the one asked for | REQUEST_INT i + 1; ACK after the last | FETCHING; ENDED: done |
| FETCHING | any other item | nothing: it is a copy, or belongs elsewhere | FETCHING |
| FETCHING | silence | REQUEST_INT i again | FETCHING |
| FETCHING | COUNT, another number | REQUEST_LIST: the list changed meanwhile | LISTING |
| FETCHING | ACK INVALID_SEQUENCE, ERROR, OPERATION_CANCELLED | REQUEST_LIST | LISTING |
| any | any other ACK but ACCEPTED | | ENDED: refused |
| any | long silence, no progress | | ENDED: silent, stalled |

One item is asked for at a time: PX4 refuses questions out of order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum, auto

from missions.mavlink.messages import (
    Message,
    MissionAck,
    MissionCount,
    MissionItemInt,
    MissionRequestInt,
    MissionRequestList,
    Received,
)
from missions.mavlink.transfer.exchange import DEFAULT_TIMING, NOT_YET, Ending, Patience, Result, Route, Timing
from planning.base.messages import say


class DownloadState(Enum):
    """Where a download stands; see the module for the transitions."""

    READY = auto()
    LISTING = auto()
    FETCHING = auto()
    ENDED = auto()


@dataclass(frozen=True, slots=True)
class DownloadOutcome:
    """How a download ended.

    Parameters
    ----------
    items
        All of the list where it is done; else what came before the end, which is no list.
    count
        How many the vehicle announced; None where it did not.
    result
        What the vehicle answered where it refused.
    """

    ending: Ending
    items: tuple[MissionItemInt, ...] = ()
    count: int | None = None
    result: int | None = None


@dataclass(slots=True)
class Download:
    """Asks the vehicle for its items, one after the other."""

    route: Route
    timing: Timing = DEFAULT_TIMING
    state: DownloadState = field(init=False, default=DownloadState.READY)
    outcome: DownloadOutcome | None = field(init=False, default=None)
    _patience: Patience = field(init=False)
    _items: list[MissionItemInt] = field(init=False, default_factory=list)
    _count: int | None = field(init=False, default=None)
    _restarts: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        self._patience = Patience(self.timing)

    @property
    def next_deadline_s(self) -> float:
        """When to repeat or to give up; never once it has ended."""
        return self._patience.next_deadline_s if self.outcome is None else math.inf

    @property
    def progress(self) -> tuple[str, float, float]:
        """Items that came so far."""
        return say("reading back"), len(self._items), self._count or 0

    def start(self, now_s: float) -> list[Message]:
        """Ask how many there are."""
        if self.state is not DownloadState.READY:
            raise ValueError("a download starts once")
        self._patience.begin(now_s)
        return self._list(now_s)

    def _list(self, now_s: float) -> list[Message]:
        self.state = DownloadState.LISTING
        self._items.clear()
        self._count = None
        self._patience.ask(now_s)
        return [self._question()]

    def _question(self) -> Message:
        vehicle, kind = self.route.vehicle, self.route.mission_type
        if self.state is DownloadState.LISTING:
            return MissionRequestList(vehicle.system, vehicle.component, kind)
        return MissionRequestInt(vehicle.system, vehicle.component, len(self._items), kind)

    def receive(self, received: Received) -> list[Message]:
        """Take what comes."""
        message, now_s = self.route.message_of(received), received.time_s
        if self.outcome is not None or self.state is DownloadState.READY:
            return []
        if isinstance(message, MissionCount):
            return self._counted(message.count, now_s)
        if isinstance(message, MissionItemInt):
            return self._came(message, now_s)
        if isinstance(message, MissionAck):
            return self._acknowledged(message.type, now_s)
        return []

    def _counted(self, count: int, now_s: float) -> list[Message]:
        self._patience.hear(now_s)
        if self.state is DownloadState.FETCHING:
            return [] if count == self._count else self._anew(now_s, Ending.OUT_OF_STEP)
        self._patience.advance(now_s)
        self._count = count
        self.state = DownloadState.FETCHING
        return self._next(now_s)

    def _came(self, item: MissionItemInt, now_s: float) -> list[Message]:
        if self.state is not DownloadState.FETCHING or item.seq != len(self._items):
            return []
        self._patience.advance(now_s)
        self._items.append(item)
        return self._next(now_s)

    def _next(self, now_s: float) -> list[Message]:
        if len(self._items) == self._count:
            self._end(Ending.DONE)
            return [self.route.ack(Result.ACCEPTED)]
        self._patience.ask(now_s)
        return [self._question()]

    def _acknowledged(self, result: int, now_s: float) -> list[Message]:
        if result == Result.ACCEPTED:
            return []
        self._patience.hear(now_s)
        is_fetching = self.state is DownloadState.FETCHING
        if is_fetching and result in (Result.INVALID_SEQUENCE, Result.ERROR, Result.OPERATION_CANCELLED):
            return self._anew(now_s, Ending.REFUSED, result)
        may_come = result in (Result.DENIED, Result.ERROR) or (not is_fetching and result in NOT_YET)
        if may_come and self._patience.asks_again(now_s):
            return []
        if result in (Result.INVALID_SEQUENCE, Result.OPERATION_CANCELLED):
            # Of an upload before this.
            return []
        self._end(Ending.REFUSED, result)
        return []

    def _anew(self, now_s: float, ending: Ending, result: int | None = None) -> list[Message]:
        """Begin anew, or end so where that was tried often enough."""
        self._restarts += 1
        if self._restarts > self.timing.restarts:
            self._end(ending, result)
            return []
        return self._list(now_s)

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
        """Tell the vehicle that nothing more is asked for."""
        return [self.route.ack(Result.OPERATION_CANCELLED)]

    def _end(self, ending: Ending, result: int | None = None) -> None:
        self.state = DownloadState.ENDED
        self.outcome = DownloadOutcome(ending, tuple(self._items), self._count, result)
