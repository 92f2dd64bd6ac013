"""Telemetry logs (.tlog): MAVLink frames, each after the time at which it was received.

A record is eight bytes, big-endian microseconds since 1970, and one frame of MAVLink 1 or 2 (as Mission Planner,
QGroundControl and MAVProxy write them). Frames are found by their own length and checksum; after damage the next good
one is looked for. Only messages that tell something of the flight are decoded; `telemetry.py` reads them.
"""

from __future__ import annotations

import re
import struct
from typing import Any

from missions.flight.logs.raw import RawLog
from missions.flight.logs.telemetry import TelemetryReader
from missions.mavlink.messages import Address, Received
from planning.base.progress import QUIET, Monitor

TIME_BYTES = 8
HEADER_BYTES = {0xFE: 6, 0xFD: 10}
"""Bytes before the payload in MAVLink 1 and 2, by the first of them."""

_RECORD = re.compile(rb"(?s)\x00[\x00-\x0e].{6}[\xfd\xfe]")
"""How a record begins: microseconds of the years 1970 to 2100 start with these two bytes."""

CHECKSUM_BYTES, SIGNATURE_BYTES, SIGNED = 2, 13, 0x01

VEHICLES = {3: "ArduPilot", 12: "PX4"}
"""MAV_AUTOPILOT."""


def looks_like_tlog(head: bytes) -> bool:
    """Whether a file begins with a time and a frame, possibly after some other bytes."""
    return any(_frame_bytes(head, at) > 0 for at in range(max(0, len(head) - TIME_BYTES - 12)))


def read_tlog(content: bytes, monitor: Monitor = QUIET) -> RawLog:
    """Everything a telemetry log says of one vehicle, the first that flies in it."""
    from pymavlink.dialects.v20 import ardupilotmega

    from missions.mavlink.wire import message_id, message_of

    decoder = ardupilotmega.MAVLink(None)
    reader = TelemetryReader()
    wanted = frozenset(map(message_id, reader.wanted))
    at = n_lost = 0
    while at + TIME_BYTES < len(content):
        size = _frame_bytes(content, at)
        packet = _decoded(decoder, content, at, size, wanted) if size else None
        if packet is None:
            following = _RECORD.search(content, at + 1)
            following_at = len(content) if following is None else following.start()
            at, n_lost = following_at, n_lost + following_at - at
            monitor.report("reading the log", at, len(content))
            continue
        if packet is not _SKIPPED and (message := message_of(packet)) is not None:
            source = Address(packet.get_srcSystem(), packet.get_srcComponent())
            reader.take(Received(message, source, struct.unpack_from(">Q", content, at)[0] / 1e6))
        at += TIME_BYTES + size
        if at % 4096 < size:
            monitor.report("reading the log", at, len(content))
    log = reader.read()
    log.vehicle = f"{VEHICLES.get(reader.autopilot, 'MAVLink')}, telemetry log"
    if n_lost:
        log.note("log-damaged", f"{n_lost} bytes of the log are no messages and were skipped", n_lost)
    return log


_SKIPPED = object()


def _frame_bytes(content: bytes, at: int) -> int:
    """Size of the frame that follows a time, 0 where there is none."""
    start = at + TIME_BYTES
    if start + 8 > len(content) or _RECORD.match(content, at) is None:
        return 0
    signature = SIGNATURE_BYTES if content[start] == 0xFD and content[start + 2] & SIGNED else 0
    size = HEADER_BYTES[content[start]] + content[start + 1] + CHECKSUM_BYTES + signature
    return size if start + size <= len(content) else 0


def _decoded(decoder: Any, content: bytes, at: int, size: int, wanted: frozenset[int]) -> Any:
    """The message of a frame; `_SKIPPED` for one that is not used, None for one that is damaged."""
    from pymavlink.dialects.v20.ardupilotmega import MAVError

    start = at + TIME_BYTES
    is_first = content[start] == 0xFE
    number = content[start + 5] if is_first else int.from_bytes(content[start + 7 : start + 10], "little")
    if number not in wanted:
        # Its checksum is not worth the time; but it must end where another record or the log does.
        end = start + size
        return (
            _SKIPPED if end == len(content) or _frame_bytes(content, end) or end + TIME_BYTES > len(content) else None
        )
    try:
        return decoder.decode(bytearray(content[start : start + size]))
    except (MAVError, struct.error, ValueError, IndexError):
        return None
