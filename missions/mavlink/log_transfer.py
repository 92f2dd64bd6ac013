"""MAVLink's log protocol: the logs of vehicles without file transfer (MAVFTP), as state machines without a link.

    LogEntries  ASKING  -> ASKING   an entry came; entries that are missing are asked for again
                        -> ended    as many came as the vehicle says, or it says no more
    LogRead     READING -> READING  pieces came; gaps are asked for again, then the next window
                        -> ended    all came and nothing differs, or the vehicle says no more

A log is asked for in windows of some hundred pieces of 90 bytes. The vehicle sends a window without waiting; pieces
that a radio loses are gaps, and asked for again, each run of them at once. Each frame has its checksum, but there is
none of the whole log: what proves it is that every piece came, that what came twice was the same, and the listed size.

MAVLink, common.xml: LOG_REQUEST_LIST, LOG_ENTRY, LOG_REQUEST_DATA, LOG_DATA, LOG_REQUEST_END.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from missions.mavlink.messages import (
    LogData,
    LogEntry,
    LogRequestData,
    LogRequestEnd,
    LogRequestList,
    Message,
    Received,
)
from missions.mavlink.transfer.exchange import Ending, Route
from planning.base.messages import say

PIECE = 90
"""Bytes of a LOG_DATA."""

WINDOW = 512
"""Pieces that are asked for at once: 46 kB, half a second over USB and ten seconds over a telemetry radio."""

MAX_LOG = 1 << 30
"""Bytes; the largest logs of an hour at full rate are some hundred megabytes."""

REPEAT_S = 1.0
"""Silence after which what is missing is asked for again; ArduPilot sends each control step, radios delay by 0.5 s."""

SILENCE_S, STALL_S = 20.0, 60.0
"""Silence, and answers that bring nothing new, after which the vehicle is given up."""

LAST = 0xFFFF


@dataclass(frozen=True, slots=True)
class LogEntryList:
    """Entries by the vehicle's numbers, the oldest first."""

    ending: Ending
    entries: tuple[LogEntry, ...] = ()


@dataclass(frozen=True, slots=True)
class LogOutcome:
    """How the reading of a log ended.

    Parameters
    ----------
    content
        All of it where it is done; else what came from its beginning on without a gap.
    differs
        A piece came twice, and not the same: the log is still being written, or is another one.
    is_shorter
        The vehicle says that the log ends before the size that it listed.
    """

    ending: Ending
    content: bytes = b""
    differs: bool = False
    is_shorter: bool = False


class LogEntries:
    """Asks which logs there are."""

    def __init__(self, route: Route) -> None:
        self._route = route
        self._entries: dict[int, LogEntry] = {}
        self._numbers: range | None = None
        self._heard_s = self._grown_s = self._asked_s = 0.0
        self.outcome: LogEntryList | None = None

    @property
    def next_deadline_s(self) -> float:
        """When `tick` wants to be called."""
        return math.inf if self.outcome is not None else min(self._asked_s + REPEAT_S, self._grown_s + STALL_S)

    @property
    def progress(self) -> tuple[str, float, float]:
        """Entries that came, of how many."""
        return say("listing logs"), len(self._entries), 0 if self._numbers is None else len(self._numbers)

    def start(self, now_s: float) -> list[Message]:
        """Ask for all."""
        self._heard_s = self._grown_s = now_s
        return self._ask(now_s, 0, LAST)

    def receive(self, received: Received) -> list[Message]:
        """Take an entry."""
        entry = received.message
        if self.outcome is not None or received.source != self._route.vehicle or not isinstance(entry, LogEntry):
            return []
        self._heard_s = self._asked_s = received.time_s
        if entry.num_logs == 0:
            self.outcome = LogEntryList(Ending.DONE)
            return []
        # ArduPilot counts from 1, PX4 from 0: the last number says which.
        self._numbers = range(max(0, entry.last_log_num - entry.num_logs + 1), entry.last_log_num + 1)
        if entry.id in self._numbers and entry.id not in self._entries:
            self._entries[entry.id] = entry
            self._grown_s = received.time_s
        if all(number in self._entries for number in self._numbers):
            self._end(Ending.DONE)
        return []

    def tick(self, now_s: float) -> list[Message]:
        """Ask again for what is missing, or give up."""
        if self.outcome is not None or now_s < self.next_deadline_s:
            return []
        if now_s - self._heard_s > SILENCE_S or now_s - self._grown_s > STALL_S:
            self._end(Ending.SILENT if now_s - self._heard_s > SILENCE_S else Ending.STALLED)
            return []
        if now_s < self._asked_s + REPEAT_S:
            return []
        missing = [number for number in self._numbers or () if number not in self._entries]
        first, last = next(_runs(missing), (0, LAST + 1))
        return self._ask(now_s, first, last - 1)

    def cancel(self) -> list[Message]:
        """Let the vehicle stop."""
        return [_end_of(self._route)]

    def _ask(self, now_s: float, first: int, last: int) -> list[Message]:
        self._asked_s = now_s
        vehicle = self._route.vehicle
        return [LogRequestList(vehicle.system, vehicle.component, first, last)]

    def _end(self, ending: Ending) -> None:
        numbers = self._numbers or ()
        found = tuple(self._entries[number] for number in numbers if number in self._entries)
        self.outcome = LogEntryList(ending, found if ending is Ending.DONE else ())


class LogRead:
    """Reads one log.

    Parameters
    ----------
    begun
        What came of it before, from its beginning on: it goes on from there, and reads its end once more to see that it
        is the same log.
    """

    def __init__(self, route: Route, log_id: int, n_bytes: int, begun: bytes = b"") -> None:
        if not 0 <= n_bytes <= MAX_LOG:
            raise ValueError(f"n_bytes: expected 0 to {MAX_LOG}, got {n_bytes}")
        self._route, self._id, self._n_bytes = route, log_id, n_bytes
        self._content = bytearray(n_bytes)
        self._came = bytearray(-(-n_bytes // PIECE))
        n_begun = min(len(begun), n_bytes) // PIECE
        self._content[: n_begun * PIECE] = begun[: n_begun * PIECE]
        self._came[:n_begun] = b"\1" * n_begun
        # The last of what came before is asked for again and compared.
        self._unproved = {n_begun - 1} if n_begun else set[int]()
        self._first = max(0, n_begun - 1)
        self._asked = (0, 0)
        self._heard_s = self._grown_s = self._asked_s = 0.0
        self._n_came = n_begun
        self.outcome: LogOutcome | None = None

    @property
    def next_deadline_s(self) -> float:
        """When `tick` wants to be called."""
        return math.inf if self.outcome is not None else min(self._asked_s + REPEAT_S, self._grown_s + STALL_S)

    @property
    def progress(self) -> tuple[str, float, float]:
        """Bytes that came, of how many."""
        return say("fetching the log"), min(self._n_came * PIECE, self._n_bytes), self._n_bytes

    def start(self, now_s: float) -> list[Message]:
        """Ask for the first window."""
        self._heard_s = self._grown_s = now_s
        return self._go_on(now_s)

    def receive(self, received: Received) -> list[Message]:
        """Take a piece."""
        piece = received.message
        if self.outcome is not None or received.source != self._route.vehicle or not isinstance(piece, LogData):
            return []
        if piece.id != self._id:
            return []
        now_s = received.time_s
        self._heard_s = self._asked_s = now_s
        if piece.ofs % PIECE or not 0 <= piece.count <= PIECE or piece.ofs + piece.count > self._n_bytes:
            return []
        number, due = piece.ofs // PIECE, min(PIECE, self._n_bytes - piece.ofs)
        if piece.count < due:
            return self._end(Ending.OUT_OF_STEP, is_shorter=True)
        content = bytes(piece.data[:due])
        is_same = self._content[piece.ofs : piece.ofs + due] == content
        if number in self._unproved:
            self._unproved.clear()
            self._grown_s = now_s
            if not is_same:  # what came before was of another log
                self._came[:] = bytes(len(self._came))
                self._first = self._n_came = 0
                return self._go_on(now_s)
        elif not self._came[number]:
            self._content[piece.ofs : piece.ofs + due] = content
            self._came[number] = 1
            self._n_came += 1
            self._grown_s = now_s
        elif not is_same:
            return self._end(Ending.OUT_OF_STEP, differs=True)
        # The last piece of what was asked for has come: gaps are seen now.
        return self._go_on(now_s) if number >= self._asked[1] - 1 else []

    def tick(self, now_s: float) -> list[Message]:
        """Ask for gaps again, or give up."""
        if self.outcome is not None or now_s < self.next_deadline_s:
            return []
        if now_s - self._heard_s > SILENCE_S:
            return self._end(Ending.SILENT)
        if now_s - self._grown_s > STALL_S:
            return self._end(Ending.STALLED)
        return self._go_on(now_s) if now_s >= self._asked_s + REPEAT_S else []

    def cancel(self) -> list[Message]:
        """Let the vehicle stop."""
        return [_end_of(self._route)]

    def _go_on(self, now_s: float) -> list[Message]:
        """Ask for the first run that is missing, at most a window of it; end where nothing is."""
        while self._first < len(self._came) and self._came[self._first] and self._first not in self._unproved:
            self._first += 1
        if self._first == len(self._came):
            return self._end(Ending.DONE)
        last = self._first + 1
        stop = min(len(self._came), self._first + WINDOW)
        while last < stop and not self._came[last]:
            last += 1
        self._asked, self._asked_s = (self._first, last), now_s
        vehicle = self._route.vehicle
        offset = self._first * PIECE
        count = min(last * PIECE, self._n_bytes) - offset
        return [LogRequestData(vehicle.system, vehicle.component, self._id, offset, count)]

    def _end(self, ending: Ending, *, differs: bool = False, is_shorter: bool = False) -> list[Message]:
        if ending is Ending.DONE:
            self.outcome = LogOutcome(ending, bytes(self._content))
        else:
            whole = self._came.find(b"\0")
            n = len(self._came) if whole < 0 else whole
            begun = b"" if differs else bytes(self._content[: n * PIECE])
            self.outcome = LogOutcome(ending, begun, differs, is_shorter)
        return [_end_of(self._route)]


def _end_of(route: Route) -> Message:
    return LogRequestEnd(route.vehicle.system, route.vehicle.component)


def _runs(numbers: list[int]) -> Iterator[tuple[int, int]]:
    """Runs of numbers that follow one another, ends excluded."""
    start = None
    for i, number in enumerate(numbers):
        start = number if start is None else start
        if i + 1 == len(numbers) or numbers[i + 1] != number + 1:
            yield start, number + 1
            start = None
