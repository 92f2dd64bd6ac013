"""Upload that believes only what it reads back.

| state | event | does | next |
|---|---|---|---|
| READY | start | upload; clear where there are no items | UPLOADING, CLEARING |
| UPLOADING | it ended, whatever the vehicle said | reads back | READING |
| UPLOADING | refused at an item, and the vehicle is left with a mix | clears | CLEARING |
| READING | equal, field by field | | ENDED: `Verified` |
| READING | not equal, not refused, attempts left | clears a mix that may be there, or uploads | CLEARING, UPLOADING |
| READING | not equal | | ENDED: `NotVerified`, with what is on board |
| READING | the vehicle fell silent, for the first time | reads back from the start | READING |
| READING | could not be read, the vehicle still speaks, attempts left | uploads | UPLOADING |
| READING | could not be read | | ENDED: `NotVerified`, what is on board is not known |
| CLEARING | it ended | uploads again; reads back where the vehicle had refused | UPLOADING, READING |

A mix of the old mission and the new is what ArduPilot keeps of a broken upload: it cuts its mission at the announced
count and writes each item where it belongs as it comes. An empty mission cannot be started by mistake, a mix can.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import Enum, auto

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import (
    Message,
    MissionAck,
    MissionClearAll,
    MissionCount,
    MissionItemInt,
    MissionRequest,
    MissionRequestInt,
    Received,
)
from missions.mavlink.transfer.exchange import (
    DEFAULT_TIMING,
    NOT_YET,
    Download,
    DownloadOutcome,
    Ending,
    MissionType,
    Result,
    Route,
    Timing,
    Transfer,
)
from missions.mavlink.transfer.wire_items import Difference, compare
from planning.base.messages import glue, joined, say

# Clearing a list on the vehicle.
#
# | state | event | does | next |
# |---|---|---|---|
# | READY | start | CLEAR_ALL | ASKED |
# | ASKED | silence | CLEAR_ALL again | ASKED |
# | ASKED | ACK ACCEPTED | | ENDED: done |
# | ASKED | ACK DENIED, ERROR, UNSUPPORTED | CLEAR_ALL after a pause, for some time: busy, or starting | ASKED |
# | ASKED | ACK INVALID_SEQUENCE, OPERATION_CANCELLED | nothing: it belongs to an upload before | ASKED |
# | ASKED | any other ACK | | ENDED: refused |
# | ASKED | long silence | | ENDED: silent |
#
# Whether the list is empty then, only reading it back tells: `verified.VerifiedUpload` with no items.


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
class Clear(Transfer):
    """Asks the vehicle to forget its items."""

    state: ClearState = field(init=False, default=ClearState.READY)
    outcome: ClearOutcome | None = field(init=False, default=None)

    @property
    def progress(self) -> tuple[str, float, float]:
        """All or nothing."""
        return say("clearing"), float(self.state is ClearState.ENDED), 1

    def start(self, now_s: float) -> list[Message]:
        """Ask."""
        if self.state is not ClearState.READY:
            raise ValueError("clearing starts once")
        self.state = ClearState.ASKED
        self._retry.begin(now_s)
        self._retry.ask(now_s)
        return self._repeated(now_s)

    def _repeated(self, now_s: float) -> list[Message]:
        vehicle = self.route.vehicle
        return [MissionClearAll(vehicle.system, vehicle.component, self.route.mission_type)]

    def receive(self, received: Received) -> list[Message]:
        """Take the acknowledgement."""
        message = self.route.message_of(received)
        if self.state is ClearState.ASKED and isinstance(message, MissionAck):
            if message.type == Result.ACCEPTED:
                return self._end(Ending.DONE, message.type)
            if message.type in (Result.INVALID_SEQUENCE, Result.OPERATION_CANCELLED):
                self._retry.hear(received.time_s)
            elif message.type not in {Result.DENIED, *NOT_YET} or not self._retry.asks_again(received.time_s):
                return self._end(Ending.REFUSED, message.type)
        return []

    def cancel(self) -> list[Message]:
        """Nothing to say: the question is out."""
        return []

    def _end(self, ending: Ending, result: int | None = None) -> list[Message]:
        self.state = ClearState.ENDED
        self.outcome = ClearOutcome(ending, result)
        return []


# Upload of a list of items, without reading back: part of `verified.VerifiedUpload`, which does.
#
# | state | event | does | next |
# |---|---|---|---|
# | READY | start | COUNT | ANNOUNCED |
# | ANNOUNCED | silence | COUNT again | ANNOUNCED |
# | ANNOUNCED, SENDING, CLOSING | vehicle asks for item i | item i | SENDING, CLOSING once the last was sent |
# | ANNOUNCED, SENDING, CLOSING | it asks for item 0 after others | item 0 | SENDING |
# | SENDING | silence | item i again; from the second time on item i + 1 too | SENDING, CLOSING |
# | SENDING | ACK INVALID_SEQUENCE | item i + 1, once for each repeat | SENDING, CLOSING |
# | SENDING | ACK ERROR, OPERATION_CANCELLED | COUNT: the vehicle has given up | ANNOUNCED |
# | ANNOUNCED | ACK ERROR, UNSUPPORTED, OPERATION_CANCELLED | COUNT after a pause, for some time: busy, starting |
# same |
# | SENDING, ANNOUNCED | ACK ACCEPTED | nothing: it belongs to an earlier transfer | same |
# | CLOSING | ACK ACCEPTED | | ENDED: done |
# | CLOSING | silence | as in SENDING | CLOSING, after some times ENDED: unconfirmed |
# | CLOSING | ACK ERROR, OPERATION_CANCELLED | | ENDED: unconfirmed |
# | any | any other ACK | | ENDED: refused |
# | any | it asks beyond the end, or begins anew, again and again | | ENDED: out of step |
# | any | long silence, no progress | | ENDED: silent, stalled |
#
# Item i + 1 without being asked for gets on where the item arrived and the next question was lost: the receiver takes
# it
# if it waits for it and drops it otherwise. Nothing else than the vehicle's answers ever doubles a message.

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
class Upload(Transfer):
    """Sends items to the vehicle as it asks for them.

    Parameters
    ----------
    items
        In order; `seq`, target and mission type are filled in here.
    """

    items: Sequence[MissionItemInt]
    state: UploadState = field(init=False, default=UploadState.READY)
    outcome: UploadOutcome | None = field(init=False, default=None)
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
        Transfer.__post_init__(self)

    @property
    def progress(self) -> tuple[str, float, float]:
        """Items asked for so far."""
        return say("uploading"), self._seq + 1, len(self.items)

    def start(self, now_s: float) -> list[Message]:
        """Announce the items."""
        if self.state is not UploadState.READY:
            raise ValueError("an upload starts once")
        self._retry.begin(now_s)
        return self._announce(now_s)

    def _announce(self, now_s: float) -> list[Message]:
        # A count of 0 is acknowledged at once.
        self.state = UploadState.ANNOUNCED if self.items else UploadState.CLOSING
        self._seq = -1
        self._answered_s.clear()
        self._retry.ask(now_s)
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
        self._retry.hear(now_s)
        is_anew = seq == 0 and self._seq > 0
        if is_anew:
            self._restarts += 1
            if self._restarts > self.timing.restarts:
                return self._end(Ending.OUT_OF_STEP)
            self._answered_s.clear()
        if seq > self._seq or is_anew:
            self._retry.advance(now_s)
            self._retry.ask(now_s, is_new=seq not in self._answered_s)
            self._seq = self._furthest = seq
            self.state = UploadState.SENDING
        is_copy = now_s < self._answered_s.get(seq, -math.inf) + self._retry.repeat_gap_s
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
            self._retry.hear(now_s)
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
        if self.state is UploadState.ANNOUNCED and self._retry.asks_again(now_s):
            return []
        self._restarts += 1
        if self.state is UploadState.ANNOUNCED or self._restarts > self.timing.restarts:
            return self._end(Ending.REFUSED, result)
        self._retry.hear(now_s)
        return self._announce(now_s)

    def _gives_up(self, now_s: float) -> Ending | None:
        ending = self._retry.gave_up(now_s)
        if self.state is not UploadState.CLOSING:
            return ending
        is_over = ending is not None or self._retry.repeats >= self.timing.acknowledgement_repeats
        return Ending.UNCONFIRMED if is_over else None

    def _repeated(self, now_s: float) -> list[Message]:
        if self._seq < 0:
            return [self._count()]
        self._may_guess = True
        return self._send(self._seq, 2 if self._retry.repeats > 1 else 1, now_s)

    def cancel(self) -> list[Message]:
        """Tell the vehicle that no more items come."""
        return [self.route.ack(Result.OPERATION_CANCELLED)]

    def _end(self, ending: Ending, result: int | None = None) -> list[Message]:
        self.state = UploadState.ENDED
        self.outcome = UploadOutcome(ending, result, self._furthest)
        return []


ATTEMPTS = 3
READS = 2
"""Reading changes nothing, so that it may be tried again: PX4 forgets a download after 5 s without a question."""


class VerifiedState(Enum):
    """Where it stands; see the module for the transitions."""

    READY = auto()
    UPLOADING = auto()
    READING = auto()
    CLEARING = auto()
    ENDED = auto()


@dataclass(frozen=True, slots=True)
class Verified:
    """The items are on the vehicle: they were read back, and are those that were sent but for known rounding."""

    items: tuple[MissionItemInt, ...]
    n_uploads: int


@dataclass(frozen=True, slots=True)
class NotVerified:
    """The items are not, or not surely, on the vehicle.

    Parameters
    ----------
    upload
        How the last upload ended; None where there was none.
    on_board
        Items read back; None where what is on the vehicle is not known.
    differences
        Where these are not what was sent; empty where that is not known.
    n_uploads
        Uploads tried.
    """

    upload: UploadOutcome | None
    on_board: tuple[MissionItemInt, ...] | None
    differences: tuple[Difference, ...]
    n_uploads: int

    def __str__(self) -> str:
        return f"{_why(self.upload)}; {self._what_is_on_board()}"

    def _what_is_on_board(self) -> str:
        if self.on_board is None:
            return say("what is on the vehicle now could not be read: do not fly before it was")
        if not self.on_board:
            return say("nothing is on the vehicle now")
        listed = joined("; ", map(str, self.differences[:3]))
        more = say("; and {} more", len(self.differences) - 3) if len(self.differences) > 3 else ""
        return say(
            "{} items are on the vehicle, and not those that were sent ({})", len(self.on_board), glue(listed, more)
        )


def _why(upload: UploadOutcome | None) -> str:
    if upload is None:
        return say("the list could not be cleared")
    place = "" if upload.seq is None else say(" at item {}", upload.seq)
    match upload.ending:
        case Ending.REFUSED:
            known = {result.value: result.name for result in Result}
            return say("the vehicle refused the upload{} ({})", place, known.get(upload.result or 0, upload.result))
        case Ending.DONE:
            return say("the vehicle accepted every item")
        case Ending.UNCONFIRMED:
            return say("every item was sent, but the vehicle did not confirm them")
        case Ending.SILENT:
            return say("the vehicle stopped answering{}", place)
        case Ending.STALLED:
            return say("the upload did not get on{}", place)
        case Ending.OUT_OF_STEP:
            return say("the vehicle did not keep to the items{}", place)


@dataclass(slots=True)
class VerifiedUpload:
    """Puts items on the vehicle and proves it; without items it clears the list and proves that.

    Parameters
    ----------
    items
        From `wire_items.to_wire`, home among them where the autopilot wants it.
    """

    route: Route
    items: tuple[MissionItemInt, ...]
    autopilot: Autopilot
    timing: Timing = DEFAULT_TIMING
    attempts: int = ATTEMPTS
    state: VerifiedState = field(init=False, default=VerifiedState.READY)
    outcome: Verified | NotVerified | None = field(init=False, default=None)
    _step: Upload | Download | Clear = field(init=False)
    _upload: UploadOutcome | None = field(init=False, default=None)
    _n_tries: int = field(init=False, default=0)
    _n_uploads: int = field(init=False, default=0)
    _n_reads: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        self._step = self._writing()

    @property
    def next_deadline_s(self) -> float:
        """When to repeat or to give up."""
        return self._step.next_deadline_s

    @property
    def progress(self) -> tuple[str, float, float]:
        """Of what it does now."""
        return self._step.progress

    def start(self, now_s: float) -> list[Message]:
        """Begin."""
        if self.state is not VerifiedState.READY:
            raise ValueError("an upload starts once")
        return self._put(now_s)

    def receive(self, received: Received) -> list[Message]:
        """Hand a message to what is going on."""
        if self.outcome is not None or self.state is VerifiedState.READY:
            return []
        return [*self._step.receive(received), *self._go_on(received.time_s)]

    def tick(self, now_s: float) -> list[Message]:
        """Let time pass."""
        if self.outcome is not None or self.state is VerifiedState.READY:
            return []
        return [*self._step.tick(now_s), *self._go_on(now_s)]

    def cancel(self) -> list[Message]:
        """Tell the vehicle; what is on board afterwards is not known."""
        return self._step.cancel()

    def _writing(self) -> Upload | Clear:
        return (
            Upload(self.route, self.items, timing=self.timing) if self.items else Clear(self.route, timing=self.timing)
        )

    def _put(self, now_s: float) -> list[Message]:
        self._n_tries += 1
        self._n_uploads += bool(self.items)
        self._n_reads = 0
        state = VerifiedState.UPLOADING if self.items else VerifiedState.CLEARING
        return self._begin(state, self._writing(), now_s)

    def _begin(self, state: VerifiedState, step: Upload | Download | Clear, now_s: float) -> list[Message]:
        self.state, self._step = state, step
        return step.start(now_s)

    def _read(self, now_s: float) -> list[Message]:
        self._n_reads += 1
        return self._begin(VerifiedState.READING, Download(self.route, timing=self.timing), now_s)

    def _clear(self, now_s: float) -> list[Message]:
        return self._begin(VerifiedState.CLEARING, Clear(self.route, timing=self.timing), now_s)

    def _go_on(self, now_s: float) -> list[Message]:
        """What follows where the step has ended."""
        outcome = self._step.outcome
        if outcome is None:
            return []
        if isinstance(outcome, UploadOutcome):
            self._upload = outcome
            return self._clear(now_s) if self._is_refused and self._leaves_mix else self._read(now_s)
        if isinstance(outcome, DownloadOutcome):
            return self._compare(outcome, now_s)
        return self._read(now_s) if self._is_refused or not self.items else self._put(now_s)

    def _compare(self, read: DownloadOutcome, now_s: float) -> list[Message]:
        may_try = self._n_tries < self.attempts and not self._is_refused
        if read.ending is not Ending.DONE:
            if read.ending is Ending.SILENT:
                return self._read(now_s) if self._n_reads < READS else self._fail(None, ())
            return self._put(now_s) if may_try else self._fail(None, ())
        differences = compare(self.items, read.items, self.autopilot, self.route.mission_type)
        if not differences:
            self.state = VerifiedState.ENDED
            self.outcome = Verified(read.items, self._n_uploads)
            return []
        if may_try:
            return self._clear(now_s) if self._leaves_mix and self.items else self._put(now_s)
        return self._fail(read.items, differences)

    def _fail(self, on_board: tuple[MissionItemInt, ...] | None, differences: tuple[Difference, ...]) -> list[Message]:
        self.state = VerifiedState.ENDED
        self.outcome = NotVerified(self._upload, on_board, differences, self._n_uploads)
        return []

    @property
    def _is_refused(self) -> bool:
        """Whether the vehicle said no for good, so that the same items need not be sent again."""
        return self._upload is not None and self._upload.ending is Ending.REFUSED

    @property
    def _leaves_mix(self) -> bool:
        """Whether a broken upload changed what was on board; ArduPilot checks a fence as a whole, PX4 everything."""
        is_written_at_once = self.autopilot is Autopilot.ARDUPILOT and self.route.mission_type is not MissionType.FENCE
        return is_written_at_once and self._upload is not None and self._upload.seq is not None
