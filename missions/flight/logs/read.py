"""Any flight log: what kind it is, by its content, and the flights in it."""

from __future__ import annotations

from pathlib import Path

from missions.flight.logs.dataflash import looks_binary, looks_like_text, read_dataflash
from missions.flight.logs.flights import HeightSource, LogFlights, flights_of
from missions.flight.logs.raw import RawLog
from missions.flight.logs.telemetry import looks_like_tlog, read_tlog
from missions.flight.logs.ulog import looks_like_ulog, read_ulog
from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, open_input_file, read_input_file
from planning.base.progress import QUIET, Monitor
from planning.site.records import Site

LOG_FILE = FileLimit("a flight log", 512 * MIB, "cut out the flight with a log tool")
"""Larger logs are refused: an hour of ArduPilot's full logging has about 200 MiB."""

HEAD_BYTES = 65536


def read_log(path: Path, site: Site, heights: HeightSource = "takeoff", monitor: Monitor = QUIET) -> LogFlights:
    """Flights of a log: telemetry (.tlog), ArduPilot (.BIN, .log) or PX4 (.ulg), whatever its name.

    Raises
    ------
    InputError
        The file is missing, unreadable, too large or no log, belongs to another site, or holds no flight.
    """
    return flights_of(_raw_log(_content(path), str(path), monitor), site, str(path), heights)


def is_log(path: Path) -> bool:
    """Whether a file begins like a flight log; False for one that cannot be read."""
    try:
        with open_input_file(path, LOG_FILE) as file:
            head = file.read(HEAD_BYTES)
    except InputError:
        return False
    return looks_like_ulog(head) or looks_binary(head) or looks_like_text(head) or looks_like_tlog(head)


def _content(path: Path) -> bytes:
    content = read_input_file(path, LOG_FILE)
    if not content:
        raise InputError.say("the log is empty; copy it from the vehicle again", place=path)
    return content


def _raw_log(content: bytes, label: str, monitor: Monitor) -> RawLog:
    head = content[:HEAD_BYTES]
    if looks_like_ulog(head):
        return read_ulog(content, label, monitor)
    if looks_binary(head) or looks_like_text(head):
        return read_dataflash(content, monitor)
    if looks_like_tlog(head):
        return read_tlog(content, monitor)
    raise InputError.say(
        "its content is no flight log; expected telemetry (.tlog), ArduPilot (.BIN, .log) or PX4 (.ulg)", place=label
    )
