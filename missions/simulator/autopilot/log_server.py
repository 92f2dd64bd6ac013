"""The vehicle's end of MAVLink's log protocol: its logs are listed and sent, some pieces with each control step.

ArduPilot counts its logs from 1 and sends nothing while it is armed; PX4 counts from 0.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.log_transfer import PIECE
from missions.mavlink.messages import LogData, LogEntry, LogRequestData, LogRequestEnd, LogRequestList, Message

PIECES_A_STEP = 20
"""At 50 control steps a second 90 kB/s."""


@dataclass(slots=True)
class LogServer:
    """Answers requests.

    Parameters
    ----------
    files
        Gives the content of each log by its path, as of now, the oldest first.
    is_busy
        Whether it sends nothing now.
    """

    autopilot: Autopilot
    files: Callable[[], Mapping[str, bytes]]
    unix_start_s: float
    is_busy: Callable[[], bool]
    _sending: tuple[int, bytes, int, int] | None = None

    def receive(self, message: LogRequestList | LogRequestData | LogRequestEnd) -> list[Message]:
        """Answer a request."""
        if self.autopilot is Autopilot.ARDUPILOT and self.is_busy():
            return []
        logs = list(self.files().values())
        first = 1 if self.autopilot is Autopilot.ARDUPILOT else 0
        match message:
            case LogRequestEnd():
                self._sending = None
            case LogRequestList():
                if not logs:
                    return [LogEntry(0, 0, 0, 0, 0)]
                return [
                    LogEntry(number, len(logs), first + len(logs) - 1, round(self.unix_start_s), len(content))
                    for number, content in enumerate(logs, first)
                    if message.start <= number <= message.end
                ]
            case LogRequestData() if 0 <= message.id - first < len(logs):
                content = logs[message.id - first]
                self._sending = message.id, content, message.ofs, min(message.ofs + message.count, len(content))
        return []

    def tick(self) -> list[Message]:
        """Pieces of this control step."""
        sent: list[Message] = []
        while self._sending is not None and len(sent) < PIECES_A_STEP:
            number, content, offset, end = self._sending
            piece = content[offset : min(offset + PIECE, end)]
            sent.append(LogData(number, offset, len(piece), tuple(piece.ljust(PIECE, b"\0"))))
            offset += PIECE
            self._sending = (number, content, offset, end) if offset < end else None
        return sent
