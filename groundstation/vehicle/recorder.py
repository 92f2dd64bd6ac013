"""What a flight that was watched leaves behind: the same record as from its telemetry log afterwards."""

from __future__ import annotations

import math
from dataclasses import replace

from missions.flight.logs.flights import flights_of
from missions.flight.logs.raw import RawLog
from missions.flight.logs.telemetry import TelemetryReader
from missions.flight.record import FlightRecord
from missions.mavlink.messages import Address, Received
from planning.base.errors import InputError
from planning.site.records import Site


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
