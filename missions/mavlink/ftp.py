"""Files of the vehicle by MAVLink's file transfer protocol (MAVFTP), as state machines without a link.

Only what is needed to fetch logs: lists of folders, files read as a whole, and their checksums. Nothing is written on
the vehicle. As the protocol's page has it (mavlink.io, "File Transfer Protocol"): every request has a number, and its
answer the next one; a repeated request keeps its number, so that the vehicle repeats its answer. A burst answers one
request with many pieces.

List of a folder (`FolderList`):

| state | event | does | next |
|---|---|---|---|
| READY | start | LIST from entry 0 | ASKED |
| ASKED | entries | LIST from the entry after them | ASKED |
| ASKED | silence | the same LIST | ASKED |
| ASKED | NAK end of file | | ENDED: done |
| ASKED | any other NAK | | ENDED: refused |
| ASKED | entries without end | | ENDED: out of step |

A file (`FileRead`):

| state | event | does | next |
|---|---|---|---|
| READY | start | OPEN | OPENING |
| OPENING | its size | BURST from the first byte that is missing | READING |
| OPENING | NAK no sessions left, once | RESET, which ends those that were forgotten | RESETTING |
| RESETTING | answer, or silence for some time | OPEN | OPENING |
| OPENING | any other NAK | | ENDED: refused |
| READING | a piece | keeps it, wherever it belongs | READING |
| READING | end of a burst or of the file, silence | BURST or READ of what is missing | READING |
| READING | NAK unknown command to BURST | READ from now on | READING |
| READING | NAK invalid session: the vehicle was restarted, or has given it up | OPEN; what came is kept | OPENING |
| READING | all came | CRC | CHECKING |
| READING | answers that bring nothing, again and again | | ENDED: out of step |
| CHECKING | the same checksum | TERMINATE | ENDED: done |
| CHECKING | NAK: it knows none | TERMINATE | ENDED: done, unchecked |
| CHECKING | another checksum | OPEN: what was written meanwhile is read, all where nothing was | OPENING |
| any | long silence, no progress, too many beginnings | | ENDED: silent, stalled, or out of step where it differs |
"""

from __future__ import annotations

import struct
import zlib
from abc import abstractmethod
from bisect import bisect_right
from dataclasses import dataclass, field
from enum import Enum, IntEnum, auto

from missions.mavlink.messages import FileTransferProtocol, Message, Received
from missions.mavlink.transfer.exchange import Ending, Timing, Transfer
from planning.base.messages import say

PAYLOAD_BYTES = 251
_HEADER = struct.Struct("<HBBBBBBI")
MAX_DATA = PAYLOAD_BYTES - _HEADER.size
"""Bytes of data in one message: 239."""

MAX_FILE_BYTES = 512 * 2**20
"""Larger files are not fetched: those who read logs refuse them."""

MAX_ENTRIES = 10_000
"""Of one folder; a vehicle that lists more lists without end."""

WINDOW = 5
"""Pieces that are asked for one by one at a time; ArduPilot keeps five requests."""

WORTH_A_BURST = 20 * MAX_DATA
"""A smaller hole before what came is asked for piece by piece: a burst would bring what is there, too."""

FRUITLESS = 8
"""Answers in a row that bring nothing new, before the vehicle is taken to be out of step."""

RESTARTS = 5
RESET_REPEATS = 3
"""A vehicle without sessions may not answer a reset: some only do it."""


FTP_TIMING = Timing(shortest_wait_s=0.5, longest_pause_s=2.0)
"""On a slow radio the pieces of a burst come far apart: what is asked for again too early comes twice."""


class Opcode(IntEnum):
    """MAV_FTP_OPCODE, as far as it is used."""

    NONE = 0
    TERMINATE = 1
    RESET = 2
    LIST = 3
    OPEN = 4
    READ = 5
    CRC = 14
    BURST = 15
    ACK = 128
    NAK = 129


class FtpError(IntEnum):
    """MAV_FTP_ERR."""

    NONE = 0
    FAIL = 1
    FAIL_ERRNO = 2
    INVALID_DATA_SIZE = 3
    INVALID_SESSION = 4
    NO_SESSIONS = 5
    END_OF_FILE = 6
    UNKNOWN_COMMAND = 7
    FILE_EXISTS = 8
    FILE_PROTECTED = 9
    FILE_NOT_FOUND = 10


ERROR_TEXTS = {
    FtpError.FAIL: say("it cannot"),
    FtpError.FAIL_ERRNO: say("its file system cannot"),
    FtpError.NO_SESSIONS: say("somebody else reads its files"),
    FtpError.UNKNOWN_COMMAND: say("it knows no file transfer"),
    FtpError.FILE_PROTECTED: say("the file is protected"),
    FtpError.FILE_NOT_FOUND: say("there is no such file or folder"),
}


def error_text(code: int) -> str:
    """Why a vehicle refused, in words."""
    return next((text for error, text in ERROR_TEXTS.items() if error == code), say("error {}", code))


@dataclass(frozen=True, slots=True)
class FtpFrame:
    """What a FILE_TRANSFER_PROTOCOL message carries.

    Parameters
    ----------
    number
        Of the request; answers have the next one.
    size
        Bytes of data, or bytes wanted.
    request
        Opcode that an answer answers.
    """

    number: int
    session: int
    opcode: int
    size: int = 0
    request: int = 0
    is_burst_complete: bool = False
    offset: int = 0
    data: bytes = b""

    def payload(self) -> tuple[int, ...]:
        """As it stands in the message.

        Raises
        ------
        ValueError
            There is more data than one message holds.
        """
        if len(self.data) > MAX_DATA:
            raise ValueError(f"data: expected at most {MAX_DATA} bytes, got {len(self.data)}")
        head = _HEADER.pack(
            self.number % 2**16,
            self.session,
            self.opcode,
            self.size,
            self.request,
            self.is_burst_complete,
            0,
            self.offset,
        )
        return tuple((head + self.data).ljust(PAYLOAD_BYTES, b"\0"))


def frame_of(message: FileTransferProtocol) -> FtpFrame | None:
    """What a message carries; None where it says that it holds more than there is room for."""
    content = bytes(message.payload)
    number, session, opcode, size, request, is_complete, _, offset = _HEADER.unpack_from(content)
    if size > MAX_DATA:
        return None
    data = content[_HEADER.size : _HEADER.size + size]
    return FtpFrame(number, session, opcode, size, request, bool(is_complete), offset, data)


def file_checksum(content: bytes | bytearray) -> int:
    """Checksum of a file as autopilots count it: CRC-32 of IEEE 802.3, begun with 0 and not inverted at the end.

    `zlib.crc32` begins with all ones and inverts: both are undone by handing it the inverse and inverting the result.
    """
    return zlib.crc32(content, 0xFFFFFFFF) ^ 0xFFFFFFFF


@dataclass(slots=True)
class FtpTransfer(Transfer):
    """What both machines share: numbered requests, one open question, and whose answers count.

    Parameters
    ----------
    path
        On the vehicle.
    number
        Of the first request; one that goes on from the transfer before, so that late answers to that are known as such.
    """

    path: str
    number: int = 0
    timing: Timing = field(default=FTP_TIMING, kw_only=True)
    _question: FtpFrame | None = field(init=False, default=None)

    def _ask(
        self, opcode: Opcode, now_s: float, *, session: int = 0, offset: int = 0, size: int = 0, data: bytes = b""
    ) -> list[Message]:
        """Ask a new question."""
        self.number = (self.number + 1) % 2**16
        self._question = FtpFrame(self.number, session, opcode, size or len(data), offset=offset, data=data)
        self._retry.ask(now_s)
        return [self._message(self._question)]

    def _message(self, frame: FtpFrame) -> Message:
        vehicle = self.route.vehicle
        return FileTransferProtocol(vehicle.system, vehicle.component, frame.payload())

    def _repeated(self, now_s: float) -> list[Message]:
        return [] if self._question is None else [self._message(self._question)]

    def _heard(self, received: Received) -> FtpFrame | None:
        """An answer of the vehicle to us, to a request that was made; no older one."""
        message, own = received.message, self.route.own
        if received.source != self.route.vehicle or not isinstance(message, FileTransferProtocol):
            return None
        if message.target_system not in (0, own.system) or message.target_component not in (0, own.component):
            return None
        frame = frame_of(message)
        return frame if frame is not None and frame.opcode in (Opcode.ACK, Opcode.NAK) else None

    def _is_answer(self, frame: FtpFrame) -> bool:
        """Whether a frame answers the open question, and no earlier one."""
        asked = self._question
        is_next = asked is not None and frame.number == (asked.number + 1) % 2**16
        return asked is not None and is_next and frame.request == asked.opcode

    def cancel(self) -> list[Message]:
        """Nothing to say: no session is open, or it is closed by `_end`."""
        return []

    @abstractmethod
    def start(self, now_s: float) -> list[Message]:
        """Messages that begin it."""

    @abstractmethod
    def receive(self, received: Received) -> list[Message]:
        """Take what comes."""


def _error_of(frame: FtpFrame) -> int:
    return frame.data[0] if frame.data else int(FtpError.FAIL)


# List of a folder


@dataclass(frozen=True, slots=True)
class FolderEntry:
    """A file, or a folder (size None), in a folder of the vehicle."""

    name: str
    n_bytes: int | None


@dataclass(frozen=True, slots=True)
class FolderOutcome:
    """How a list ended; `error` is an `FtpError`, or a number that is none, where the vehicle refused."""

    ending: Ending
    entries: tuple[FolderEntry, ...] = ()
    error: int | None = None


@dataclass(slots=True)
class FolderList(FtpTransfer):
    """Asks for the entries of a folder."""

    outcome: FolderOutcome | None = field(init=False, default=None)
    _entries: list[FolderEntry] = field(init=False, default_factory=list)
    _n_listed: int = field(init=False, default=0)

    @property
    def progress(self) -> tuple[str, float, float]:
        """Entries that came so far, of a number that nobody knows."""
        return say("listing logs"), self._n_listed, 0

    def start(self, now_s: float) -> list[Message]:
        """Ask for the first entries."""
        if self._question is not None:
            raise ValueError("a list starts once")
        self._retry.begin(now_s)
        return self._list(now_s)

    def _list(self, now_s: float) -> list[Message]:
        return self._ask(Opcode.LIST, now_s, offset=self._n_listed, data=self.path.encode()[:MAX_DATA])

    def receive(self, received: Received) -> list[Message]:
        """Take entries, or the end of them."""
        frame = self._heard(received)
        if self.outcome is not None or frame is None or not self._is_answer(frame):
            return []
        now_s = received.time_s
        self._retry.advance(now_s)
        if frame.opcode == Opcode.NAK:
            error = _error_of(frame)
            return self._end(Ending.DONE) if error == FtpError.END_OF_FILE else self._end(Ending.REFUSED, error)
        entries = [entry for entry in frame.data.split(b"\0") if entry]
        self._n_listed += len(entries)
        self._entries += [found for entry in entries if (found := _entry(entry)) is not None]
        if not entries or self._n_listed > MAX_ENTRIES:
            return self._end(Ending.OUT_OF_STEP)
        return self._list(now_s)

    def _end(self, ending: Ending, result: int | None = None) -> list[Message]:
        entries = tuple(self._entries) if ending is Ending.DONE else ()
        self.outcome = FolderOutcome(ending, entries, result)
        return []


def _entry(content: bytes) -> FolderEntry | None:
    """An entry: `F` name, tab, size; `D` name; what is skipped (`S`) or makes no sense is none."""
    kind, rest = content[:1], content[1:].decode("utf-8", "replace")
    name, _, size = rest.partition("\t")
    # Names become names of files here.
    if not name or name in (".", "..") or not name.isprintable() or set(name) & set("/\\:"):
        return None
    if kind == b"D":
        return FolderEntry(name, None)
    is_number = size.isascii() and size.isdecimal() and len(size) < 19
    return FolderEntry(name, int(size)) if kind == b"F" and is_number else None


# A file


class ReadState(Enum):
    """Where the reading of a file stands; see the module for the transitions."""

    READY = auto()
    OPENING = auto()
    RESETTING = auto()
    READING = auto()
    CHECKING = auto()
    ENDED = auto()


@dataclass(frozen=True, slots=True)
class FileOutcome:
    """How the reading of a file ended.

    Parameters
    ----------
    content
        All of it where it is done; else empty.
    is_checked, differs
        Its checksum is the vehicle's; all came again and again, and its checksum never was.
    error
        An `FtpError`, or a number that is none, where the vehicle refused.
    """

    ending: Ending
    content: bytes = b""
    is_checked: bool = False
    error: int | None = None
    differs: bool = False


@dataclass(slots=True)
class Pieces:
    """Bytes that came so far, wherever they belong."""

    content: bytearray = field(default_factory=bytearray)
    _starts: list[int] = field(default_factory=list)
    _ends: list[int] = field(default_factory=list)
    _n_there: int = 0

    @property
    def size(self) -> int:
        """Of the whole file."""
        return len(self.content)

    @property
    def n_missing(self) -> int:
        """Bytes that did not come yet."""
        return self.size - self._n_there

    def resize(self, size: int) -> None:
        """Another size: what is longer has holes at the end, what is shorter begins anew."""
        if size < self.size:
            self.content = bytearray(size)
            self.forget()
        else:
            self.content.extend(bytes(size - self.size))

    def forget(self) -> None:
        """Everything is missing again."""
        self._starts, self._ends, self._n_there = [], [], 0

    def put(self, offset: int, data: bytes) -> bool:
        """Keep a piece, as far as it lies in the file; False where it brought nothing."""
        data = data[: max(0, self.size - offset)]
        start, end = offset, offset + len(data)
        if not data:
            return False
        first = bisect_right(self._ends, start - 1)
        last = bisect_right(self._starts, end)
        if first < last and self._starts[first] <= start and self._ends[first] >= end:
            return False
        self.content[start:end] = data
        if first < last:
            start, end = min(start, self._starts[first]), max(end, self._ends[last - 1])
        self._n_there += end - start - sum(self._ends[first:last]) + sum(self._starts[first:last])
        self._starts[first:last] = [start]
        self._ends[first:last] = [end]
        return True

    def holes(self, most: int) -> list[tuple[int, int]]:
        """The first holes, as start and end."""
        found: list[tuple[int, int]] = []
        at = 0
        for start, end in zip(
            (*self._starts[: most + 1], self.size), (*self._ends[: most + 1], self.size), strict=True
        ):
            if at < start and len(found) < most:
                found.append((at, start))
            at = end
        return found


@dataclass(slots=True)
class FileRead(FtpTransfer):
    """Reads a file, and proves it by the vehicle's checksum.

    Parameters
    ----------
    most_bytes
        A larger file is refused.
    doing
        What is done, for the pilot.
    """

    most_bytes: int = field(default=MAX_FILE_BYTES, kw_only=True)
    doing: str = field(default=say("fetching the log"), kw_only=True)

    state: ReadState = field(init=False, default=ReadState.READY)
    outcome: FileOutcome | None = field(init=False, default=None)
    _pieces: Pieces = field(init=False, default_factory=Pieces)
    _session: int = field(init=False, default=0)
    _opened: int = field(init=False, default=0)
    _first_asked: int = field(init=False, default=0)
    _may_burst: bool = field(init=False, default=True)
    _may_reset: bool = field(init=False, default=True)
    _differed: bool = field(init=False, default=False)
    _asked: dict[int, int] = field(init=False, default_factory=dict)
    _n_fruitless: int = field(init=False, default=0)
    _n_restarts: int = field(init=False, default=0)

    @property
    def progress(self) -> tuple[str, float, float]:
        """Bytes that came so far."""
        return self.doing, self._pieces.size - self._pieces.n_missing, self._pieces.size

    def start(self, now_s: float) -> list[Message]:
        """Open it."""
        if self.state is not ReadState.READY:
            raise ValueError("a file is read once")
        self._retry.begin(now_s)
        return self._open(now_s)

    def _open(self, now_s: float) -> list[Message]:
        self.state = ReadState.OPENING
        self._asked.clear()
        sent = self._ask(Opcode.OPEN, now_s, data=self.path.encode()[:MAX_DATA])
        self._opened = self.number
        return sent

    def receive(self, received: Received) -> list[Message]:
        """Take what comes."""
        frame = self._heard(received)
        if frame is None or self.state in (ReadState.READY, ReadState.ENDED):
            return []
        if self.state is ReadState.READING:
            return self._came(frame, received.time_s)
        if not self._is_answer(frame):
            return []
        self._retry.advance(received.time_s)
        if self.state is ReadState.RESETTING:
            return self._open(received.time_s)
        return (self._opening if self.state is ReadState.OPENING else self._checking)(frame, received.time_s)

    def _opening(self, frame: FtpFrame, now_s: float) -> list[Message]:
        if frame.opcode == Opcode.NAK:
            error = _error_of(frame)
            if error == FtpError.NO_SESSIONS and self._may_reset:
                self._may_reset = False
                self.state = ReadState.RESETTING
                return self._ask(Opcode.RESET, now_s)
            return self._end(Ending.REFUSED, error)
        if len(frame.data) != 4:
            return self._end(Ending.OUT_OF_STEP)
        size, pieces = int.from_bytes(frame.data, "little"), self._pieces
        if size > self.most_bytes:
            return self._end(Ending.REFUSED, FtpError.INVALID_DATA_SIZE)
        if self._differed and size == pieces.size:
            pieces.forget()
        pieces.resize(size)
        self._session, self._differed = frame.session, False
        return self._go_on(now_s)

    def _go_on(self, now_s: float) -> list[Message]:
        """Ask for what is missing, or for the checksum."""
        self.state = ReadState.READING
        self._asked.clear()
        pieces, self._first_asked = self._pieces, self.number + 1
        holes = pieces.holes(WINDOW)
        if not holes:
            self.state = ReadState.CHECKING
            return self._ask(Opcode.CRC, now_s, data=self.path.encode()[:MAX_DATA])
        start, end = holes[0]
        if self._may_burst and (end == pieces.size or end - start >= WORTH_A_BURST):
            return self._ask(Opcode.BURST, now_s, session=self._session, offset=start, size=MAX_DATA)
        sent: list[Message] = []
        for start, end in holes:
            for offset in range(start, end, MAX_DATA):
                if len(sent) < WINDOW:
                    size = min(MAX_DATA, end - offset)
                    self._asked[offset] = size
                    sent += self._ask(Opcode.READ, now_s, session=self._session, offset=offset, size=size)
        return sent

    def _came(self, frame: FtpFrame, now_s: float) -> list[Message]:
        """A piece, or the end of what was asked for."""
        is_refusal = frame.opcode == Opcode.NAK
        # A refusal may name no session, or the one that the vehicle does not know; pieces count from the opening on.
        first = self._first_asked if is_refusal else self._opened
        is_new = 0 < (frame.number - first) % 2**16 < 2**15
        is_ours = is_refusal or frame.session == self._session
        if not (is_new and is_ours) or frame.request not in (Opcode.BURST, Opcode.READ):
            return []
        self._retry.hear(now_s)
        if is_refusal:
            return self._refused(_error_of(frame), frame.request, now_s)
        if self._pieces.put(frame.offset, frame.data):
            self._n_fruitless = 0
            self._retry.advance(now_s)
            # The next pieces of a burst come without being asked for: silence counts from this one on.
            self._retry.ask(now_s, is_new=False)
        self._asked.pop(frame.offset, None)
        is_burst = frame.request == Opcode.BURST
        is_over = frame.is_burst_complete if is_burst else not self._asked
        if self._pieces.n_missing == 0 or is_over:
            return self._next(now_s)
        return []

    def _next(self, now_s: float) -> list[Message]:
        """What was asked for is over; asking again and again for what never comes ends."""
        self._n_fruitless += 1
        if self._n_fruitless > FRUITLESS:
            return self._end(Ending.OUT_OF_STEP)
        return self._go_on(now_s)

    def _refused(self, error: int, request: int, now_s: float) -> list[Message]:
        if error == FtpError.END_OF_FILE:
            return self._next(now_s)
        if error == FtpError.INVALID_SESSION:
            # There is none that could be closed.
            return self._anew(now_s, closes=False)
        if error == FtpError.UNKNOWN_COMMAND and request == Opcode.BURST:
            self._may_burst = False
            return self._next(now_s)
        return self._end(Ending.REFUSED, error)

    def _checking(self, frame: FtpFrame, now_s: float) -> list[Message]:
        if frame.opcode == Opcode.NAK or len(frame.data) != 4:
            return self._end(Ending.DONE)
        if int.from_bytes(frame.data, "little") == file_checksum(self._pieces.content):
            return self._end(Ending.DONE, is_checked=True)
        self._differed = True
        return self._anew(now_s)

    def _anew(self, now_s: float, *, closes: bool = True) -> list[Message]:
        """Open it again, or end where that was tried often enough."""
        self._n_restarts += 1
        if self._n_restarts > RESTARTS:
            return self._end(Ending.OUT_OF_STEP if self._differed else Ending.STALLED)
        return [*(self._closing() if closes else []), *self._open(now_s)]

    def _repeated(self, now_s: float) -> list[Message]:
        if self.state is ReadState.READING:
            repeats = self._retry.repeats
            sent = self._go_on(now_s)
            # A new question, but for the same: each waits longer than the one before.
            self._retry.repeats = repeats - 1
            self._retry.repeat(now_s)
            return sent
        if self.state is ReadState.RESETTING and self._retry.repeats > RESET_REPEATS:
            return self._open(now_s)
        # Named, because a class with slots is made anew by its decorator.
        return FtpTransfer._repeated(self, now_s)

    def _closing(self) -> list[Message]:
        """Give the session back; nobody waits for an answer."""
        if self.state in (ReadState.READY, ReadState.OPENING, ReadState.RESETTING):
            return []
        self.number = (self.number + 1) % 2**16
        return [self._message(FtpFrame(self.number, self._session, Opcode.TERMINATE))]

    def cancel(self) -> list[Message]:
        """Give the session back."""
        return self._closing() if self.outcome is None else []

    def _end(self, ending: Ending, result: int | None = None, *, is_checked: bool = False) -> list[Message]:
        sent = self._closing()
        self.state = ReadState.ENDED
        content = bytes(self._pieces.content) if ending is Ending.DONE else b""
        self.outcome = FileOutcome(ending, content, is_checked, result, self._differed)
        return sent
