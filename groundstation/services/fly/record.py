"""What a live flight leaves behind: its telemetry log, and the flight file with record and report."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from groundstation.services.fly.connection import OpenedLink
from groundstation.services.fly.events import FlightEnded
from groundstation.services.settings import data_folder
from groundstation.vehicle.duration import items_duration_s, timed_by_items
from groundstation.vehicle.sortie.flight_run import FlightRun
from groundstation.vehicle.telemetry_log import TelemetryLog, new_log_path
from missions.flight.flight_file import flight_of, write_flight
from missions.flight.outcome import FlightReport
from missions.flight.record import FlightRecord
from missions.flight.report import report_case
from missions.mavlink.autopilots import Autopilot
from planning.base.errors import GroundStationError, InputError
from planning.checks.case import Case

FLIGHTS = "flights"
"""Folder of a project, or of the user's data where there is no project."""


def flights_folder(project: Path | None) -> Path:
    """Where flights are kept."""
    return (data_folder() if project is None else project) / FLIGHTS


def open_log(folder: Path, unix_time_s: float) -> tuple[TelemetryLog | None, str]:
    """A new telemetry log: in the folder, else in the user's data folder; and what went wrong, else empty."""
    problem = ""
    for place in dict.fromkeys((folder, flights_folder(None))):
        try:
            return TelemetryLog(new_log_path(place, unix_time_s)), problem
        except InputError as error:
            problem = problem or str(error)
    return None, problem


class FlightRecordings:
    """Keeps the sorties of a plan as they end, each time with the report on all of them.

    Parameters
    ----------
    records
        Of the same plan from before.
    """

    def __init__(self, case: Case, folder: Path, records: tuple[FlightRecord, ...]) -> None:
        self._case, self._folder, self._records = case, folder, records
        self._expected_s: dict[int, float] = {}

    def ended(
        self,
        run: FlightRun,
        record: FlightRecord,
        error: GroundStationError | None,
        opened: OpenedLink | None,
        name: str,
    ) -> FlightEnded:
        """A sortie is over: write what was flown, under this name.

        A simulated one is recorded as it truly was.
        """
        orders = run.orders
        if opened is not None and opened.simulated is not None and run.recorder is not None:
            true = opened.simulated.true_record(run.recorder, orders)
            record = replace(record if true is None else true, vehicle=record.vehicle, effects=opened.effects)
        self._records = (*self._records, record)
        autopilot = run.state.autopilot or Autopilot.ARDUPILOT
        self._expected_s[orders.number] = items_duration_s(orders, autopilot)
        path = self._folder / f"{name}.json"
        report, kept, problem = keep_flight(self._case, self._records, self._expected_s, path)
        return FlightEnded(orders.number, error, record, report, kept, problem)


def keep_flight(
    case: Case, records: tuple[FlightRecord, ...], expected_s: Mapping[int, float], path: Path
) -> tuple[FlightReport, Path | None, str]:
    """Report on what was flown, and write both; returns where, and why not where it could not be.

    Parameters
    ----------
    expected_s
        How long the items of sorties take by their number; plans reckon with an aircraft that turns at its waypoints.
    """
    report = report_case(case.with_plan(timed_by_items(case.plan, expected_s)), records)
    problem = ""
    for place in dict.fromkeys((path, flights_folder(None) / path.name)):
        try:
            place.parent.mkdir(parents=True, exist_ok=True)
            write_flight(place, flight_of(case.plan, case.site_model, records, report))
        except (InputError, OSError) as error:
            problem = problem or str(error)
        else:
            return report, place, problem
    return report, None, problem
