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

from dataclasses import dataclass, field
from enum import Enum, auto

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import Message, MissionItemInt, Received
from missions.mavlink.transfer.clear import Clear
from missions.mavlink.transfer.download import Download, DownloadOutcome
from missions.mavlink.transfer.exchange import DEFAULT_TIMING, Ending, MissionType, Result, Route, Timing
from missions.mavlink.transfer.rounding import Difference, compare
from missions.mavlink.transfer.upload import Upload, UploadOutcome

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
            return "what is on the vehicle now could not be read: do not fly before it was"
        if not self.on_board:
            return "nothing is on the vehicle now"
        listed = "; ".join(map(str, self.differences[:3]))
        more = f"; and {len(self.differences) - 3} more" if len(self.differences) > 3 else ""
        return f"{len(self.on_board)} items are on the vehicle, and not those that were sent ({listed}{more})"


def _why(upload: UploadOutcome | None) -> str:
    if upload is None:
        return "the list could not be cleared"
    place = "" if upload.seq is None else f" at item {upload.seq}"
    match upload.ending:
        case Ending.REFUSED:
            known = {result.value: result.name for result in Result}
            return f"the vehicle refused the upload{place} ({known.get(upload.result or 0, upload.result)})"
        case Ending.DONE:
            return "the vehicle accepted every item"
        case Ending.UNCONFIRMED:
            return "every item was sent, but the vehicle did not confirm them"
        case Ending.SILENT:
            return f"the vehicle stopped answering{place}"
        case Ending.STALLED:
            return f"the upload did not get on{place}"
        case Ending.OUT_OF_STEP:
            return f"the vehicle did not keep to the items{place}"


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
        return Upload(self.route, self.items, self.timing) if self.items else Clear(self.route, self.timing)

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
        return self._begin(VerifiedState.READING, Download(self.route, self.timing), now_s)

    def _clear(self, now_s: float) -> list[Message]:
        return self._begin(VerifiedState.CLEARING, Clear(self.route, self.timing), now_s)

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
