"""The vehicle's end of MAVLink's file transfer (MAVFTP): its logs can be listed and read, and nothing can be written.

One file is open at a time, as on both autopilots. A burst goes on with the control steps, some pieces each, and ends
after `BURST_PIECES`, or with a NAK at the end of the file. A repeated request is answered with the same answer.
"""

from __future__ import annotations

import errno
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from missions.mavlink.ftp import MAX_DATA, FtpError, FtpFrame, Opcode, file_checksum, frame_of
from missions.mavlink.messages import Address, FileTransferProtocol, Message

BURST_PIECES = 100
PIECES_A_STEP = 20
"""At 50 control steps a second 0.24 MB/s, about what USB and Wi-Fi give."""

NO_ENTRY = bytes([FtpError.FAIL_ERRNO, errno.ENOENT])


@dataclass(slots=True)
class Session:
    """A file that is open, and where a burst goes on; None while there is none."""

    number: int
    content: bytes
    reader: Address
    burst: FtpFrame | None = None
    burst_number: int = 0
    n_pieces: int = 0


@dataclass(slots=True)
class FileServer:
    """Answers requests.

    Parameters
    ----------
    files
        Gives the content of each file by its path, as of now.
    """

    files: Callable[[], Mapping[str, bytes]]
    _session: Session | None = None
    _last: dict[Address, tuple[FtpFrame, FtpFrame]] = field(default_factory=dict)
    _n_opened: int = 0

    def receive(self, message: FileTransferProtocol, source: Address) -> list[Message]:
        """Answer a request."""
        frame = frame_of(message)
        if frame is None or frame.opcode in (Opcode.ACK, Opcode.NAK):
            return []
        asked, answered = self._last.get(source, (None, None))
        if answered is not None and frame == asked and frame.opcode not in (Opcode.BURST, Opcode.READ):
            return [_message(answered, source)]
        if frame.opcode == Opcode.BURST:
            return self._begin_burst(frame, source)
        opcode, data, session = self._answer(frame, source)
        session = frame.session if opcode is Opcode.NAK else session
        answer = FtpFrame(
            frame.number + 1, session, opcode, len(data), frame.opcode, offset=frame.offset, data=data
        )  # fmt: skip
        self._last[source] = (frame, answer)
        return [_message(answer, source)]

    def _answer(self, frame: FtpFrame, source: Address) -> tuple[Opcode, bytes, int]:
        """Opcode, data and session of an answer."""
        path = frame.data.split(b"\0")[0].decode("utf-8", "replace")
        match frame.opcode:
            case Opcode.NONE:
                return Opcode.ACK, b"", frame.session
            case Opcode.RESET:
                self._session = None
                return Opcode.ACK, b"", 0
            case Opcode.TERMINATE:
                is_it = self._session is not None and self._session.number == frame.session
                self._session = None if is_it else self._session
                return (Opcode.ACK, b"", frame.session) if is_it else _nak(FtpError.INVALID_SESSION)
            case Opcode.LIST:
                return self._list(path, frame.offset)
            case Opcode.OPEN:
                return self._open(path, source)
            case Opcode.READ:
                return self._read(frame)
            case Opcode.CRC:
                content = self.files().get(path)
                checksum = b"" if content is None else file_checksum(content).to_bytes(4, "little")
                return (Opcode.NAK, NO_ENTRY, 0) if content is None else (Opcode.ACK, checksum, 0)
        return _nak(FtpError.UNKNOWN_COMMAND)

    def _list(self, path: str, first: int) -> tuple[Opcode, bytes, int]:
        folder = path.rstrip("/") + "/"
        files = self.files()
        below = {name[len(folder) :]: len(content) for name, content in files.items() if name.startswith(folder)}
        if not below:
            return Opcode.NAK, NO_ENTRY, 0
        folders = sorted({name.split("/")[0] for name in below if "/" in name})
        own = sorted((name, size) for name, size in below.items() if "/" not in name)
        entries = [f"D{name}\0".encode() for name in folders] + [f"F{name}\t{size}\0".encode() for name, size in own]
        if first >= len(entries):
            return _nak(FtpError.END_OF_FILE)
        data = b""
        for entry in entries[first:]:
            if len(data) + len(entry) > MAX_DATA:
                break
            data += entry
        return Opcode.ACK, data, 0

    def _open(self, path: str, source: Address) -> tuple[Opcode, bytes, int]:
        if self._session is not None:
            return _nak(FtpError.NO_SESSIONS)
        content = self.files().get(path)
        if content is None:
            return Opcode.NAK, NO_ENTRY, 0
        self._n_opened += 1
        self._session = Session(self._n_opened % 256, content, source)
        return Opcode.ACK, len(content).to_bytes(4, "little"), self._session.number

    def _read(self, frame: FtpFrame) -> tuple[Opcode, bytes, int]:
        session = self._session
        if session is None or session.number != frame.session:
            return _nak(FtpError.INVALID_SESSION)
        data = session.content[frame.offset : frame.offset + frame.size]
        return (Opcode.ACK, data, session.number) if data else _nak(FtpError.END_OF_FILE)

    def _begin_burst(self, frame: FtpFrame, source: Address) -> list[Message]:
        session = self._session
        if session is None or session.number != frame.session:
            nak = bytes([FtpError.INVALID_SESSION])
            refusal = FtpFrame(frame.number + 1, frame.session, Opcode.NAK, 1, Opcode.BURST, data=nak)
            return [_message(refusal, source)]
        session.burst, session.burst_number, session.n_pieces, session.reader = frame, frame.number, 0, source
        return []

    def tick(self) -> list[Message]:
        """The next pieces of a burst."""
        session = self._session
        if session is None or session.burst is None:
            return []
        sent: list[Message] = []
        while session.burst is not None and len(sent) < PIECES_A_STEP:
            asked = session.burst
            data = session.content[asked.offset : asked.offset + (asked.size or MAX_DATA)]
            session.n_pieces += 1
            session.burst_number += 1
            answer = FtpFrame(
                session.burst_number, session.number, Opcode.ACK, len(data), Opcode.BURST,
                session.n_pieces == BURST_PIECES, asked.offset, data,
            )  # fmt: skip
            if not data:
                end = bytes([FtpError.END_OF_FILE])
                answer = replace(answer, opcode=Opcode.NAK, size=1, is_burst_complete=False, data=end)
            session.burst = replace(asked, offset=asked.offset + len(data))
            if not data or answer.is_burst_complete:
                session.burst = None
            sent.append(_message(answer, session.reader))
        return sent

    def forget(self) -> None:
        """The vehicle was restarted."""
        self._session = None
        self._last.clear()


def _nak(error: FtpError) -> tuple[Opcode, bytes, int]:
    return Opcode.NAK, bytes([error]), 0


def _message(frame: FtpFrame, reader: Address) -> Message:
    return FileTransferProtocol(reader.system, reader.component, frame.payload())
