"""The logs on a vehicle's card: listed, and the newest ones fetched, as state machines without a link.

    LISTING  -> LISTING    another place where this autopilot may keep them, or a folder in it
             -> ended      all places are listed
    FETCHING -> FETCHING   a file came: the next one
             -> ended      all came, or one did not

ArduPilot numbers its logs, PX4 names them by date and time: the newest is the last by its path.

Vehicles without file transfer (MAVFTP) are asked by MAVLink's log protocol: their logs have numbers, and no checksums.
"""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.ftp import FTP_TIMING, FileOutcome, FileRead, FolderList, FolderOutcome, FtpError, error_text
from missions.mavlink.log_transfer import MAX_LOG, LogEntries, LogEntryList, LogOutcome, LogRead
from missions.mavlink.messages import LogEntry, Message, Received
from missions.mavlink.transfer.exchange import Ending, Route
from planning.base.messages import say

LOG_FOLDERS = {
    Autopilot.ARDUPILOT: ("/APM/LOGS", "/logs", "/var/APM/logs"),
    Autopilot.PX4: ("/fs/microsd/log", "/log"),
}
"""On flight controllers, in each autopilot's own simulation, and on Linux boards."""

LOG_ENDINGS = (".bin", ".ulg")

FIRST_TIMING = replace(FTP_TIMING, silence_s=6.0, silent_repeats=6)
"""Of the first question: a vehicle that leaves it without an answer is asked by the log protocol."""

MAX_FOLDERS = 400
"""PX4 makes one a day."""


@dataclass(frozen=True, slots=True)
class OnboardFile:
    """A log on the vehicle; `log_id` is its number in the log protocol, None where it is a file."""

    path: str
    n_bytes: int
    log_id: int | None = None

    @property
    def name(self) -> str:
        """Of the file; PX4's is that of its day, too, for there is one of the same time on other days."""
        if self.log_id is not None:
            return self.path
        *_, folder, name = self.path.split("/")
        return f"{folder}_{name}" if name.lower().endswith(".ulg") else name


@dataclass(frozen=True, slots=True)
class LogList:
    """What is on the card, the oldest first; `problem` says why there is nothing."""

    files: tuple[OnboardFile, ...]
    problem: str = ""


class LogListing:
    """Lists the logs.

    Parameters
    ----------
    route
        From us to the vehicle.
    """

    def __init__(self, route: Route, autopilot: Autopilot) -> None:
        self._route = route
        self._places = deque(LOG_FOLDERS[autopilot])
        self._folders: deque[str] = deque()
        self._files: list[OnboardFile] = []
        self._problem = ""
        self._n_listed = 0
        self._autopilot = autopilot
        self._list: FolderList | LogEntries = FolderList(route, self._places.popleft(), timing=FIRST_TIMING)
        self.outcome: LogList | None = None

    @property
    def next_deadline_s(self) -> float:
        """When `tick` wants to be called."""
        return math.inf if self.outcome is not None else self._list.next_deadline_s

    @property
    def progress(self) -> tuple[str, float, float]:
        """Logs that were found so far."""
        return say("listing logs"), len(self._files), 0

    def start(self, now_s: float) -> list[Message]:
        """Begin."""
        return self._list.start(now_s)

    def receive(self, received: Received) -> list[Message]:
        """Take a message."""
        sent = [] if self.outcome is not None else self._list.receive(received)
        return [*sent, *self._go_on(received.time_s)]

    def tick(self, now_s: float) -> list[Message]:
        """Let time pass."""
        sent = [] if self.outcome is not None else self._list.tick(now_s)
        return [*sent, *self._go_on(now_s)]

    def cancel(self) -> list[Message]:
        """Nothing is open."""
        return []

    def _go_on(self, now_s: float) -> list[Message]:
        listed = self._list.outcome
        if self.outcome is not None or listed is None:
            return []
        if isinstance(listed, LogEntryList):
            self._take_entries(listed)
            return []
        assert isinstance(self._list, FolderList)
        self._n_listed += 1
        self._note(listed, self._list.path)
        is_silent = listed.ending is not Ending.DONE and listed.ending is not Ending.REFUSED
        if self._folders and self._n_listed < MAX_FOLDERS and not is_silent:
            return self._begin(self._folders.popleft(), now_s)
        if self._places and not self._files and not is_silent:
            return self._begin(self._places.popleft(), now_s)
        if self._problem and not self._files:
            self._list = LogEntries(self._route)
            return self._list.start(now_s)
        files = tuple(sorted(self._files, key=lambda each: each.path))
        self.outcome = LogList(files, "" if files else self._problem or say("there are no logs on the vehicle"))
        return []

    def _take_entries(self, listed: LogEntryList) -> None:
        """Logs by the log protocol."""
        problem = self._problem
        if listed.ending is Ending.DONE:
            problem = say("there are no logs on the vehicle")
        ending = ".ulg" if self._autopilot is Autopilot.PX4 else ".BIN"
        files = tuple(OnboardFile(f"{_entry_name(each)}{ending}", each.size, each.id) for each in listed.entries)
        self.outcome = LogList(files, "" if files else problem)

    def _begin(self, folder: str, now_s: float) -> list[Message]:
        assert isinstance(self._list, FolderList)
        self._list = FolderList(self._route, folder, self._list.number)
        return self._list.start(now_s)

    def _note(self, listed: FolderOutcome, folder: str) -> None:
        if listed.ending is Ending.REFUSED and listed.error == FtpError.UNKNOWN_COMMAND:
            self._problem = say(
                "the vehicle knows neither file transfer (MAVFTP) nor the log protocol; take its card out"
            )
        elif listed.ending not in (Ending.DONE, Ending.REFUSED):
            self._problem = say(
                "the vehicle answers neither to file transfer (MAVFTP) nor to the log protocol; is it disarmed? Else "
                "take its card out"
            )
        is_top = folder in {place for places in LOG_FOLDERS.values() for place in places}
        for entry in listed.entries:
            path = f"{folder}/{entry.name}"
            if entry.n_bytes is None:
                self._folders.extend([path] if is_top else [])
            elif entry.name.lower().endswith(LOG_ENDINGS):
                self._files.append(OnboardFile(path, entry.n_bytes))


DATED_S = 1_000_000_000
"""UNIX times before 2001 are those of a vehicle without a clock."""


def _entry_name(entry: LogEntry) -> str:
    when = time.strftime("-%Y%m%d-%H%M%S", time.gmtime(entry.time_utc)) if entry.time_utc > DATED_S else ""
    return f"log-{entry.id:05d}{when}"


@dataclass(frozen=True, slots=True)
class FetchedLogs:
    """What came; `problem` says why the rest did not.

    Parameters
    ----------
    files
        Each log with its content, and whether the vehicle's checksum proved it.
    begun
        What came of the log that did not come whole, from its beginning on: another try goes on from there.
    """

    files: tuple[tuple[OnboardFile, bytes, bool], ...]
    problem: str = ""
    begun: tuple[OnboardFile, bytes] | None = None


class LogFetch:
    """Fetches logs that were listed.

    Parameters
    ----------
    begun
        What came of logs before, by their names, for those that the log protocol sends.
    """

    def __init__(self, route: Route, files: Sequence[OnboardFile], begun: Mapping[str, bytes] | None = None) -> None:
        self._route = route
        self._begun = begun or {}
        self._waiting = deque(files)
        self._total = sum(each.n_bytes for each in files)
        self._fetched: list[tuple[OnboardFile, bytes, bool]] = []
        self._read: FileRead | LogRead | None = None
        self.outcome: FetchedLogs | None = None

    @property
    def next_deadline_s(self) -> float:
        """When `tick` wants to be called."""
        return math.inf if self.outcome is not None or self._read is None else self._read.next_deadline_s

    @property
    def progress(self) -> tuple[str, float, float]:
        """Bytes that came so far."""
        done = float(sum(len(content) for _, content, _ in self._fetched))
        now = 0.0 if self._read is None or self._read.outcome is not None else self._read.progress[1]
        return say("fetching the log"), done + now, self._total

    def start(self, now_s: float) -> list[Message]:
        """Begin."""
        return self._next(now_s, 0)

    def receive(self, received: Received) -> list[Message]:
        """Take a message."""
        sent = [] if self._read is None else self._read.receive(received)
        return [*sent, *self._go_on(received.time_s)]

    def tick(self, now_s: float) -> list[Message]:
        """Let time pass."""
        sent = [] if self._read is None else self._read.tick(now_s)
        return [*sent, *self._go_on(now_s)]

    def cancel(self) -> list[Message]:
        """Give back what is open."""
        return [] if self._read is None else self._read.cancel()

    def _go_on(self, now_s: float) -> list[Message]:
        read = self._read
        if self.outcome is not None or read is None or read.outcome is None:
            return []
        file, came = self._waiting.popleft(), read.outcome
        if came.ending is not Ending.DONE:
            begun = (file, came.content) if isinstance(came, LogOutcome) and came.content else None
            self._end(say("{} did not come: {}", file.name, _why(came)), begun)
            return []
        self._fetched.append((file, came.content, isinstance(came, FileOutcome) and came.is_checked))
        return self._next(now_s, read.number if isinstance(read, FileRead) else 0)

    def _next(self, now_s: float, number: int) -> list[Message]:
        if not self._waiting:
            self._end("")
            return []
        file = self._waiting[0]
        if file.log_id is None:
            self._read = FileRead(self._route, file.path, number)
        elif file.n_bytes > MAX_LOG:
            self._end(say("{} did not come: {}", file.name, TOO_LARGE))
            return []
        else:
            self._read = LogRead(self._route, file.log_id, file.n_bytes, self._begun.get(file.name, b""))
        return self._read.start(now_s)

    def _end(self, problem: str, begun: tuple[OnboardFile, bytes] | None = None) -> None:
        self.outcome = FetchedLogs(tuple(self._fetched), problem, begun)


class NewestLog:
    """Lists the logs, and fetches the newest one that has something in it."""

    def __init__(self, route: Route, autopilot: Autopilot) -> None:
        self._route = route
        self._part: LogListing | LogFetch = LogListing(route, autopilot)
        self.outcome: FetchedLogs | None = None

    @property
    def next_deadline_s(self) -> float:
        """When `tick` wants to be called."""
        return math.inf if self.outcome is not None else self._part.next_deadline_s

    @property
    def progress(self) -> tuple[str, float, float]:
        """What it does, how much of it, and of how much."""
        return self._part.progress

    def start(self, now_s: float) -> list[Message]:
        """Begin."""
        return self._part.start(now_s)

    def receive(self, received: Received) -> list[Message]:
        """Take a message."""
        sent = [] if self.outcome is not None else self._part.receive(received)
        return [*sent, *self._go_on(received.time_s)]

    def tick(self, now_s: float) -> list[Message]:
        """Let time pass."""
        sent = [] if self.outcome is not None else self._part.tick(now_s)
        return [*sent, *self._go_on(now_s)]

    def cancel(self) -> list[Message]:
        """Give back what is open."""
        return self._part.cancel()

    def _go_on(self, now_s: float) -> list[Message]:
        part = self._part
        if self.outcome is not None or part.outcome is None:
            return []
        if isinstance(part, LogFetch):
            self.outcome = part.outcome
            return []
        chosen = newest(part.outcome.files, 1)
        if not chosen:
            self.outcome = FetchedLogs((), part.outcome.problem or say("the logs on the vehicle are empty"))
            return []
        self._part = LogFetch(self._route, chosen)
        return self._part.start(now_s)


def newest(files: Sequence[OnboardFile], n: int) -> tuple[OnboardFile, ...]:
    """The last `n` logs that have something in them, the oldest of them first."""
    return tuple(each for each in files if each.n_bytes > 0)[-n:] if n > 0 else ()


TOO_LARGE = say("it is larger than any log that can be read; take the card out")


def _why(came: FileOutcome | LogOutcome) -> str:
    if isinstance(came, LogOutcome):
        if came.differs:
            return say("what came twice was not the same: it is still being written, or is another log now")
        if came.is_shorter:
            return say("it ends before the size that the vehicle listed: list the logs again")
    elif came.ending is Ending.REFUSED and came.error == FtpError.INVALID_DATA_SIZE:
        return TOO_LARGE
    elif came.ending is Ending.REFUSED:
        return say("the vehicle refuses: {}", error_text(came.error or 0))
    elif came.differs:
        return say("its checksum is never the vehicle's: the link damages it, or it is still being written")
    return {
        Ending.SILENT: say("the vehicle no longer answers"),
        Ending.STALLED: say("the transfer does not get on; a vehicle that restarts again and again, or a bad link"),
    }.get(came.ending, say("what the vehicle sends makes no sense; take the card out"))
