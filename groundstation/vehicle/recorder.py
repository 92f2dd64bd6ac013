"""What a flight that was watched leaves behind: its telemetry log, and the same record as from the log afterwards."""

from __future__ import annotations

import datetime
import math
import struct
from dataclasses import replace
from pathlib import Path
from typing import BinaryIO

from missions.flight.logs.flights import flights_of
from missions.flight.logs.raw import RawLog
from missions.flight.logs.telemetry import TelemetryReader
from missions.flight.record import FlightRecord
from missions.mavlink.messages import Address, Received
from planning.base.errors import InputError
from planning.base.files import make_folder
from planning.base.messages import say
from planning.site.records import Site

# Telemetry log (.tlog): every frame of a link, in and out, as Mission Planner, QGroundControl and pymavlink read it.
#
# Before each frame stands its time: microseconds since 1970 UTC, 64 bits, big-endian. Each is handed to the system at
# once, so that a crash of the program loses none. A disk that is full or gone ends no flight: the log says so in
# `problem` and tries again; what was cut off is taken back first, so that the rest stays readable.

RETRY_S = 5.0


class TelemetryLog:
    """A log that is being written; `problem` is empty while all is well.

    Parameters
    ----------
    path
        A new file; an existing one is never written over.

    Raises
    ------
    InputError
        The file exists, or cannot be made.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.problem = ""
        self.n_lost = 0
        self._n_bytes = 0
        self._retry_s = -math.inf
        try:
            self._file: BinaryIO = path.open("xb", buffering=0)
        except FileExistsError as error:
            raise InputError(say("this log exists already; name another file", place=path)) from error
        except OSError as error:
            raise InputError(
                say("the telemetry log cannot be made ({})", error.strerror or error, place=path)
            ) from error

    def write(self, frame: bytes, unix_time_s: float) -> None:
        """Add a frame; never raises because of the disk."""
        if self._file.closed:
            return
        if self.problem and unix_time_s < self._retry_s:
            self.n_lost += 1
            return
        content = struct.pack(">Q", round(unix_time_s * 1e6)) + frame
        try:
            if self.problem:
                self._file.truncate(self._n_bytes)
                self._file.seek(self._n_bytes)
            n_written = self._file.write(content)
        except OSError as error:
            self._failed(error.strerror or str(error), unix_time_s)
        else:
            if n_written != len(content):
                self._failed(say("the disk is full"), unix_time_s)
                return
            self._n_bytes += len(content)
            self.problem = ""

    def close(self) -> None:
        """End the log; a frame that was cut off is taken away. Safe to call twice."""
        if self._file.closed:
            return
        try:
            if self.problem:
                self._file.truncate(self._n_bytes)
            self._file.close()
        except OSError as error:
            self.problem = say("the telemetry log may lack its end ({})", error.strerror or error, place=self.path)

    def _failed(self, why: str, unix_time_s: float) -> None:
        self.n_lost += 1
        self._retry_s = unix_time_s + RETRY_S
        self.problem = say(
            "the telemetry log cannot be written ({}); free some space, and it goes on by itself", why, place=self.path
        )


def new_log_path(folder: Path, unix_time_s: float, name: str = "flight") -> Path:
    """Path for a log of now that does not exist yet: `flight-2026-11-21T12-30-05Z.tlog`.

    Raises
    ------
    InputError
        The folder cannot be made.
    """
    make_folder(folder)
    began = datetime.datetime.fromtimestamp(unix_time_s, datetime.UTC).strftime("%Y-%m-%dT%H-%M-%SZ")
    path, number = folder / f"{name}-{began}.tlog", 1
    while path.exists():
        number += 1
        path = folder / f"{name}-{began}-{number}.tlog"
    return path


class Recorder:
    """Gathers the messages of one vehicle, and what the ground station notes beside them.

    Parameters
    ----------
    vehicle
        Who flies, for the reader: autopilot and link.
    source
        The vehicle's autopilot.
    """

    def __init__(self, vehicle: str, source: Address | None) -> None:
        self._reader = TelemetryReader(vehicle, source)

    @property
    def log(self) -> RawLog:
        """Everything so far."""
        return self._reader.read()

    def note(self, code: str, text: str) -> None:
        """Add an event of the ground station, at the vehicle's time."""
        self._reader.note(code, text)

    def take(self, received: Received) -> None:
        """Take a message of the vehicle."""
        self._reader.take(received)

    def record(self, site: Site, sortie: int) -> FlightRecord | None:
        """The last flight that was recorded; None where nothing flew."""
        log = self.log
        if not log.positions or not all(map(math.isfinite, log.positions[-1])):
            return None
        try:
            flights = flights_of(log, site, "telemetry")
        except InputError:
            return None
        return replace(flights.records[-1], sortie=sortie)
