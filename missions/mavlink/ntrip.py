"""NTRIP client without a socket: what is asked of a caster, and its answer taken apart, however hostile it is.

A request of version 2 (HTTP/1.1 with Ntrip-Version) is answered by casters of version 1, too: `ICY 200 OK`, then data.
Version 2 answers with headers, and sends the data in chunks or as it is (RTCM 10410.1).

| state | event | next |
|---|---|---|
| HEAD | `ICY 200 OK`, or status 200 with headers | DATA, CHUNKED |
| HEAD | `SOURCETABLE 200 OK`, or a list by its headers | TABLE |
| HEAD | a page, another status, headers without end | REFUSED |
| TABLE | its end, or more than any list has | REFUSED, with the names in it |
| DATA, CHUNKED | bytes | the same |
| CHUNKED | a size that is none, the last chunk | REFUSED, ENDED |
"""

from __future__ import annotations

import base64
import re
from dataclasses import dataclass, field
from enum import Enum, auto

from planning.base.errors import InputError
from planning.base.messages import first_few, say

MAX_HEAD = 16 * 1024
"""Bytes of headers: a caster that sends more sends without end."""

MAX_CHUNK = 1 << 20
MAX_TABLE = 256 * 1024
"""Of a list of mountpoints; those of large networks have some thousand lines of a hundred bytes."""

MAX_NAMES = 8
"""Mountpoints that a message names."""

MAX_LINE = 1024
DEFAULT_PORT, DEFAULT_TLS_PORT = 2101, 443
"""Registered for NTRIP; casters with TLS mostly answer at that of HTTPS."""

EXAMPLE_CASTER = "me@rtk.example.org:2101/VRS"

_PLACE = re.compile(
    r"(?:(?P<scheme>ntrips?|https?)://)?(?:(?P<user>[^/\s]+)@)?(?P<host>[^:/@\s]+)(?::(?P<port>\d{1,5}))?/(?P<mount>[^/\s]+)"
)


@dataclass(frozen=True, slots=True)
class Caster:
    """Where corrections come from: `USER@HOST:PORT/MOUNTPOINT`, with `ntrips://` before it over TLS.

    The password stands elsewhere.
    """

    host: str
    port: int
    mountpoint: str
    user: str = ""
    is_tls: bool = False

    @property
    def name(self) -> str:
        """For messages."""
        return f"{self.host}:{self.port}/{self.mountpoint}"

    def request(self, password: str = "", gga: bytes = b"") -> bytes:
        """What is asked of it."""
        lines = [
            f"GET /{self.mountpoint} HTTP/1.1",
            f"Host: {self.host}:{self.port}",
            "Ntrip-Version: Ntrip/2.0",
            "User-Agent: NTRIP Reflight/1",
            "Accept: */*",
            "Connection: close",
        ]
        if self.user:
            secret = base64.b64encode(f"{self.user}:{password}".encode()).decode()
            lines.append(f"Authorization: Basic {secret}")
        if gga:
            lines.append(f"Ntrip-GGA: {gga.decode().strip()}")
        return ("\r\n".join(lines) + "\r\n\r\n").encode()


def caster_of(text: str) -> Caster:
    """Where corrections come from, as it was typed.

    Raises
    ------
    InputError
        It is no such place, or holds a password.
    """
    found = _PLACE.fullmatch(text.strip())
    is_tls = found is not None and found["scheme"] in ("ntrips", "https")
    usual = DEFAULT_TLS_PORT if is_tls else DEFAULT_PORT
    port = int(found["port"] or usual) if found is not None else 0
    if found is None or not 0 < port < 65536 or not text.isascii():
        raise InputError.say(
            "corrections: expected USER@HOST:PORT/MOUNTPOINT, such as me@rtk.example.org:2101/VRS, over TLS with "
            "ntrips:// before it, got '{}'",
            text.rpartition("@")[2],
        )
    if found["user"] and ":" in found["user"]:
        raise InputError.say("corrections: a password is asked for, and not kept; leave it out of the address")
    return Caster(found["host"], port, found["mount"], found["user"] or "", is_tls)


class AnswerState(Enum):
    """Where an answer stands; see the module."""

    HEAD = auto()
    DATA = auto()
    CHUNKED = auto()
    TABLE = auto()
    REFUSED = auto()
    ENDED = auto()


@dataclass(slots=True)
class CasterAnswer:
    """Takes a caster's answer apart.

    Attributes
    ----------
    problem
        Why there is no data, in words; empty where there is.
    is_final
        To ask again changes nothing: a wrong password, an unknown mountpoint.
    """

    state: AnswerState = AnswerState.HEAD
    problem: str = ""
    is_final: bool = False
    _buffer: bytearray = field(default_factory=bytearray)
    _left: int = 0
    _n_table: int = 0
    _names: list[str] = field(default_factory=list)

    def feed(self, data: bytes) -> bytes:
        """What of these bytes is data of the stream."""
        if self.state is AnswerState.DATA:
            return data
        if self.state in (AnswerState.REFUSED, AnswerState.ENDED):
            return b""
        self._buffer += data
        state = self._head() if self.state is AnswerState.HEAD else self.state
        if state is AnswerState.TABLE:
            self._table()
            return b""
        if state is AnswerState.DATA:
            data = bytes(self._buffer)
            self._buffer.clear()
            return data
        return self._chunks() if state is AnswerState.CHUNKED else b""

    def _head(self) -> AnswerState:
        """Look at the head; where the answer stands then."""
        self._read_head()
        return self.state

    def _read_head(self) -> None:
        buffer = self._buffer
        line, end, _ = bytes(buffer[:MAX_LINE]).partition(b"\n")
        if not end:
            if len(buffer) >= MAX_LINE:
                self._refuse(say("what answers there is no NTRIP caster"))
            return
        status = line.strip().decode("latin-1")
        if status.startswith("ICY 200"):
            del buffer[: len(line) + 1]
            # Some end their answer with an empty line, some do not: it is no RTCM.
            self.state = AnswerState.DATA
            return
        if status.startswith("SOURCETABLE"):
            self._begin_table()
            return
        if not status.startswith("HTTP/1."):
            self._refuse(say("what answers there is no NTRIP caster"))
            return
        close = re.search(rb"\r?\n\r?\n", buffer)
        if close is None:
            if len(buffer) > MAX_HEAD:
                self._refuse(say("its headers have no end"))
            return
        head = bytes(buffer[: close.start()]).decode("latin-1").lower()
        del buffer[: close.end()]
        self._answered(status, head)

    def _answered(self, status: str, head: str) -> None:
        code = status.split(" ")[1] if " " in status else ""
        if code in ("401", "403"):
            self._refuse(say("it refuses user and password"), is_final=True)
        elif code == "404":
            self._refuse(say("it knows no mountpoint of this name"), is_final=True)
        elif code != "200":
            self._refuse(say("it answers with status {}", code or status[:20]))
        elif "gnss/sourcetable" in head:
            self._begin_table()
        elif re.search(r"content-type:\s*text/", head):
            self._refuse(say("it answers with a page and no data: is the address right?"), is_final=True)
        elif re.search(r"content-encoding:\s*(?!identity)\S", head):
            self._refuse(say("it packs its data in a way that was not asked for"), is_final=True)
        else:
            self.state = AnswerState.CHUNKED if re.search(r"transfer-encoding:.*chunked", head) else AnswerState.DATA

    def _begin_table(self) -> None:
        """The list of mountpoints comes: there is none of the name that was asked for, whatever the list says."""
        self.state, self.is_final = AnswerState.TABLE, True
        self.problem = say("it knows no mountpoint of this name")

    def _table(self) -> None:
        """Mountpoints of the list that are there so far (`STR;NAME;...`), as far as they are names."""
        *lines, rest = bytes(self._buffer).split(b"\n")
        self._n_table += len(self._buffer) - len(rest)
        # A line without end is longer than any that counts.
        self._buffer[:] = rest[:MAX_LINE]
        is_over = self._n_table > MAX_TABLE or len(rest) > MAX_LINE
        for line in lines:
            is_over |= line.startswith(b"ENDSOURCETABLE")
            fields = line.split(b";", 2)
            if len(fields) == 3 and fields[0] == b"STR" and re.fullmatch(rb"[\w.+-]{1,40}", fields[1]):
                self._names = [*self._names, fields[1].decode("ascii")][: MAX_NAMES + 1]
        if self._names:
            shown = first_few(self._names, MAX_NAMES)
            self.problem = say("it knows no mountpoint of this name; it has {}", shown)
        if is_over:
            self._refuse(self.problem, is_final=True)

    def _chunks(self) -> bytes:
        """Data of the chunks that are there."""
        buffer, data = self._buffer, bytearray()
        while True:
            if self._left > 0:
                piece = buffer[: self._left]
                data += piece
                del buffer[: len(piece)]
                self._left -= len(piece)
                if self._left > 0:
                    break
            # The end of a chunk's data is a line, too.
            line, end, _ = bytes(buffer[:MAX_LINE]).partition(b"\n")
            if not end:
                if len(buffer) >= MAX_LINE:
                    self._refuse(say("its data is not in chunks as it says"))
                break
            del buffer[: len(line) + 1]
            size = line.split(b";")[0].strip()
            if not size:
                continue
            if not re.fullmatch(rb"[0-9a-fA-F]{1,8}", size) or int(size, 16) > MAX_CHUNK:
                self._refuse(say("its data is not in chunks as it says"))
                break
            self._left = int(size, 16)
            if self._left == 0:
                self.state = AnswerState.ENDED
                self.problem = say("it ended the stream")
                break
        return bytes(data)

    def _refuse(self, problem: str, *, is_final: bool = False) -> None:
        self.state, self.problem, self.is_final = AnswerState.REFUSED, problem, is_final
        self._buffer.clear()
