"""What all transfers share: between whom they go, how they may end, how long they wait; and the download of a list."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections import deque
from dataclasses import dataclass, field
from enum import Enum, IntEnum, auto

from missions.mavlink.messages import (
    Address,
    Message,
    MissionAck,
    MissionCount,
    MissionItemInt,
    MissionRequest,
    MissionRequestInt,
    MissionRequestList,
    Received,
)
from planning.base.messages import say

TransferMessage = MissionAck | MissionCount | MissionItemInt | MissionRequest | MissionRequestInt


class MissionType(IntEnum):
    """MAV_MISSION_TYPE."""

    MISSION = 0
    FENCE = 1
    RALLY = 2


class Result(IntEnum):
    """MAV_MISSION_RESULT."""

    ACCEPTED = 0
    ERROR = 1
    UNSUPPORTED_FRAME = 2
    UNSUPPORTED = 3
    NO_SPACE = 4
    INVALID = 5
    INVALID_PARAM1 = 6
    INVALID_PARAM2 = 7
    INVALID_PARAM3 = 8
    INVALID_PARAM4 = 9
    INVALID_PARAM5_X = 10
    INVALID_PARAM6_Y = 11
    INVALID_PARAM7 = 12
    INVALID_SEQUENCE = 13
    DENIED = 14
    OPERATION_CANCELLED = 15


NOT_YET = frozenset((Result.ERROR, Result.UNSUPPORTED))
"""What a vehicle that cannot do it yet says to the first question: UNSUPPORTED is ArduPilot's answer for some seconds
after power-up (4.7.0-dev), as long as its lists are not set up."""


class Ending(Enum):
    """How a transfer ended."""

    DONE = "done"
    """The vehicle acknowledged it (upload, clear), or all of it came (download)."""
    UNCONFIRMED = "unconfirmed"
    """Every item was sent, and no acknowledgement came: the vehicle may have all of it."""
    REFUSED = "refused"
    """The vehicle said no."""
    SILENT = "silent"
    """The vehicle stopped answering."""
    STALLED = "stalled"
    """The vehicle answered, but the transfer did not get on."""
    OUT_OF_STEP = "out-of-step"
    """The vehicle asked for items that there are not, or began anew again and again."""


@dataclass(frozen=True, slots=True)
class Route:
    """Between whom a transfer goes, and which list it is about."""

    own: Address
    vehicle: Address
    mission_type: MissionType = MissionType.MISSION

    def message_of(self, received: Received) -> TransferMessage | None:
        """The message, where it is the vehicle's, about this list, and meant for us.

        Another ground station may share the link, and another list may be on its way.
        """
        message = received.message
        if received.source != self.vehicle or not isinstance(message, TransferMessage):
            return None
        is_for_us = message.target_system in (0, self.own.system) and message.target_component in (
            0,
            self.own.component,
        )
        return message if is_for_us and message.mission_type == self.mission_type else None

    def ack(self, result: Result) -> MissionAck:
        """Acknowledgement to the vehicle."""
        return MissionAck(self.vehicle.system, self.vehicle.component, result, self.mission_type)


@dataclass(frozen=True, slots=True)
class Timing:
    """How long a transfer waits.

    MAVLink suggests 250 ms an item and 5 repeats, which ends at once where 30 % of the frames are lost each way: half
    of all questions stay without an answer there, and 5 in a row for every thirtieth item. So what ends a transfer
    here is silence, not a number of repeats.

    Parameters
    ----------
    first_wait_s
        Wait for an answer before the link's own delay is known.
    shortest_wait_s, longest_wait_s
        Bounds of that wait afterwards.
    wait_for_delay
        That wait as a multiple of the delay measured.
    growth, longest_pause_s
        Each repeat waits longer by this factor, up to this: ArduPilot asks again every second by itself.
    silence_s, silent_repeats
        The vehicle is given up when nothing came for so long: more than the 8 s after which ArduPilot, and the 5 s
        after which PX4, gives up a transfer itself and is free for a new one; and long enough for so many repeats.
    stall_s
        Given up when it answers, but no new item was asked for or came.
    repeat_gap_s
        A repeated question is not answered again within this, nor within the link's delay: two copies of one question
        must not become two streams.
    acknowledgement_repeats
        The last item is sent again so often where no acknowledgement comes; then only reading back can tell.
    busy_s
        A vehicle that says it is busy, in error, or not able to is asked again for so long: either of the first two may
        belong to a transfer before, and the last is said while it starts.
    restarts
        A transfer is begun anew at most so often.
    """

    first_wait_s: float = 0.5
    shortest_wait_s: float = 0.1
    longest_wait_s: float = 3.0
    wait_for_delay: float = 1.5
    growth: float = 1.25
    longest_pause_s: float = 1.0
    silence_s: float = 15.0
    silent_repeats: int = 15
    stall_s: float = 60.0
    repeat_gap_s: float = 0.1
    acknowledgement_repeats: int = 8
    busy_s: float = 10.0
    restarts: int = 5


DEFAULT_TIMING = Timing()

DELAYS_KEPT = 5


@dataclass(slots=True)
class RetryTimer:
    """When to repeat a question, and when to give up; learns the link's delay from questions that were not repeated."""

    timing: Timing
    repeats: int = 0
    """Of the question that is open."""
    _wait_s: float = field(init=False)
    _delays_s: deque[float] = field(init=False, default_factory=lambda: deque(maxlen=DELAYS_KEPT))
    _asked_s: float = field(init=False, default=-math.inf)
    _is_new: bool = field(init=False, default=False)
    _repeat_s: float = field(init=False, default=math.inf)
    _heard_s: float = field(init=False, default=math.inf)
    _advanced_s: float = field(init=False, default=math.inf)
    _busy_since_s: float = field(init=False, default=math.inf)

    def __post_init__(self) -> None:
        self._wait_s = self.timing.first_wait_s

    @property
    def next_deadline_s(self) -> float:
        """When to repeat or to give up."""
        return min(self._repeat_s, self._heard_s + self._silence_s, self._advanced_s + self.timing.stall_s)

    @property
    def _silence_s(self) -> float:
        return max(self.timing.silence_s, self.timing.silent_repeats * self._longest_pause_s)

    @property
    def _longest_pause_s(self) -> float:
        return max(self._wait_s, self.timing.longest_pause_s)

    @property
    def repeat_gap_s(self) -> float:
        """Within this a second copy of a question does not mean that the answer was lost."""
        return max(self.timing.repeat_gap_s, 1.2 * min(self._delays_s, default=0.0))

    def begin(self, now_s: float) -> None:
        """A transfer begins: from now on silence counts."""
        self._heard_s = self._advanced_s = now_s

    def ask(self, now_s: float, *, is_new: bool = True) -> None:
        """A new question is asked; not `is_new`: it went out before, so that its answer says nothing of the delay."""
        self.repeats = 0
        self._is_new = is_new
        self._plan(now_s)

    def repeat(self, now_s: float) -> None:
        """The open question is asked again."""
        self.repeats += 1
        self._plan(now_s)

    def _plan(self, now_s: float) -> None:
        self._asked_s = now_s
        # The exponent is bounded because a float's is.
        pause_s = self._wait_s * self.timing.growth ** min(self.repeats, 30)
        self._repeat_s = now_s + min(pause_s, self._longest_pause_s)

    def asks_again(self, now_s: float) -> bool:
        """Whether a vehicle that says it is busy should be asked again; plans that."""
        self._busy_since_s = min(self._busy_since_s, now_s)
        self._repeat_s = now_s + self.timing.longest_pause_s
        return now_s < self._busy_since_s + self.timing.busy_s

    def hear(self, now_s: float) -> None:
        """The vehicle said something about this transfer."""
        self._heard_s = now_s

    def advance(self, now_s: float) -> None:
        """The open question was answered, and the transfer got on."""
        self._heard_s = self._advanced_s = now_s
        if self.repeats == 0 and self._is_new:
            # Of late ones the shortest: what a vehicle asks again by itself, after a loss, comes a second late.
            self._delays_s.append(now_s - self._asked_s)
            self._wait_s = self.timing.wait_for_delay * min(self._delays_s)
        elif self.repeats > 0:
            # Which copy was answered is not known (Karn and Partridge, 1987): perhaps the link has become slower.
            self._wait_s *= self.timing.growth
        self._wait_s = min(max(self._wait_s, self.timing.shortest_wait_s), self.timing.longest_wait_s)

    def gave_up(self, now_s: float) -> Ending | None:
        """The ending that it comes to now, if it does."""
        if now_s >= self._heard_s + self._silence_s:
            return Ending.SILENT
        return Ending.STALLED if now_s >= self._advanced_s + self.timing.stall_s else None


@dataclass(slots=True)
class Transfer(ABC):
    """What downloads, uploads and clearing share: one question is open at a time, and repeated until time is up."""

    route: Route
    timing: Timing = field(default=DEFAULT_TIMING, kw_only=True)
    outcome: object = field(init=False, default=None)
    _retry: RetryTimer = field(init=False)

    def __post_init__(self) -> None:
        self._retry = RetryTimer(self.timing)

    @property
    def next_deadline_s(self) -> float:
        """When to repeat or to give up; never once it has ended."""
        return self._retry.next_deadline_s if self.outcome is None else math.inf

    def tick(self, now_s: float) -> list[Message]:
        """Ask again, or give up."""
        if now_s < self.next_deadline_s:
            return []
        ending = self._gives_up(now_s)
        if ending is not None:
            return self._end(ending)
        self._retry.repeat(now_s)
        return self._repeated(now_s)

    def _gives_up(self, now_s: float) -> Ending | None:
        """The ending that it comes to now, if it does."""
        return self._retry.gave_up(now_s)

    @abstractmethod
    def _repeated(self, now_s: float) -> list[Message]:
        """The open question, again."""

    @abstractmethod
    def _end(self, ending: Ending, result: int | None = None) -> list[Message]:
        """Note how it ended; the vehicle is told nothing."""


# Download of a list of items.
#
# | state | event | does | next |
# |---|---|---|---|
# | READY | start | REQUEST_LIST | LISTING |
# | LISTING | COUNT n | REQUEST_INT 0; ACK where n is 0 | FETCHING; ENDED: done where n is 0 |
# | LISTING | silence | REQUEST_LIST again | LISTING |
# | LISTING | ACK DENIED, ERROR, UNSUPPORTED | REQUEST_LIST after a pause, for some time: busy, or starting | LISTING |
# | LISTING | ACK INVALID_SEQUENCE, OPERATION_CANCELLED | nothing: it belongs to an upload before | LISTING |
# | FETCHING | item i, the one asked for | REQUEST_INT i + 1; ACK after the last | FETCHING; ENDED: done |
# | FETCHING | any other item | nothing: it is a copy, or belongs elsewhere | FETCHING |
# | FETCHING | silence | REQUEST_INT i again | FETCHING |
# | FETCHING | COUNT, another number | REQUEST_LIST: the list changed meanwhile | LISTING |
# | FETCHING | ACK INVALID_SEQUENCE, ERROR, OPERATION_CANCELLED | REQUEST_LIST | LISTING |
# | any | any other ACK but ACCEPTED | | ENDED: refused |
# | any | long silence, no progress | | ENDED: silent, stalled |
#
# One item is asked for at a time: PX4 refuses questions out of order.


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
class Download(Transfer):
    """Asks the vehicle for its items, one after the other."""

    state: DownloadState = field(init=False, default=DownloadState.READY)
    outcome: DownloadOutcome | None = field(init=False, default=None)
    _items: list[MissionItemInt] = field(init=False, default_factory=list)
    _count: int | None = field(init=False, default=None)
    _restarts: int = field(init=False, default=0)

    @property
    def progress(self) -> tuple[str, float, float]:
        """Items that came so far."""
        return say("reading back"), len(self._items), self._count or 0

    def start(self, now_s: float) -> list[Message]:
        """Ask how many there are."""
        if self.state is not DownloadState.READY:
            raise ValueError("a download starts once")
        self._retry.begin(now_s)
        return self._list(now_s)

    def _list(self, now_s: float) -> list[Message]:
        self.state = DownloadState.LISTING
        self._items.clear()
        self._count = None
        self._retry.ask(now_s)
        return self._repeated(now_s)

    def _repeated(self, now_s: float) -> list[Message]:
        vehicle, kind = self.route.vehicle, self.route.mission_type
        if self.state is DownloadState.LISTING:
            return [MissionRequestList(vehicle.system, vehicle.component, kind)]
        return [MissionRequestInt(vehicle.system, vehicle.component, len(self._items), kind)]

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
        self._retry.hear(now_s)
        if self.state is DownloadState.FETCHING:
            return [] if count == self._count else self._anew(now_s, Ending.OUT_OF_STEP)
        self._retry.advance(now_s)
        self._count = count
        self.state = DownloadState.FETCHING
        return self._next(now_s)

    def _came(self, item: MissionItemInt, now_s: float) -> list[Message]:
        if self.state is not DownloadState.FETCHING or item.seq != len(self._items):
            return []
        self._retry.advance(now_s)
        self._items.append(item)
        return self._next(now_s)

    def _next(self, now_s: float) -> list[Message]:
        if len(self._items) == self._count:
            self._end(Ending.DONE)
            return [self.route.ack(Result.ACCEPTED)]
        self._retry.ask(now_s)
        return self._repeated(now_s)

    def _acknowledged(self, result: int, now_s: float) -> list[Message]:
        if result == Result.ACCEPTED:
            return []
        self._retry.hear(now_s)
        is_fetching = self.state is DownloadState.FETCHING
        if is_fetching and result in (Result.INVALID_SEQUENCE, Result.ERROR, Result.OPERATION_CANCELLED):
            return self._anew(now_s, Ending.REFUSED, result)
        may_come = result in (Result.DENIED, Result.ERROR) or (not is_fetching and result in NOT_YET)
        if may_come and self._retry.asks_again(now_s):
            return []
        if result in (Result.INVALID_SEQUENCE, Result.OPERATION_CANCELLED):
            # Of an upload before this.
            return []
        return self._end(Ending.REFUSED, result)

    def _anew(self, now_s: float, ending: Ending, result: int | None = None) -> list[Message]:
        """Begin anew, or end so where that was tried often enough."""
        self._restarts += 1
        if self._restarts > self.timing.restarts:
            return self._end(ending, result)
        return self._list(now_s)

    def cancel(self) -> list[Message]:
        """Tell the vehicle that nothing more is asked for."""
        return [self.route.ack(Result.OPERATION_CANCELLED)]

    def _end(self, ending: Ending, result: int | None = None) -> list[Message]:
        self.state = DownloadState.ENDED
        self.outcome = DownloadOutcome(ending, tuple(self._items), self._count, result)
        return []
