"""Use case of looking back: a flight compared with its plan, from logs of the autopilot or from its photos alone."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from groundstation.services.given_files import read_given_plan, read_given_site
from groundstation.services.project_file import check_not_index
from missions.flight.flight_file import Flight, flight_of, write_flight
from missions.flight.logs.flights import LogFlights
from missions.flight.logs.read import read_log
from missions.flight.photo_folder import read_photo_flights
from missions.flight.report import report_flight
from planning.errors import InputError
from planning.findings import Finding
from planning.json_file import check_output
from planning.photo_files.places import PhotoHeights
from planning.progress import QUIET, Monitor
from planning.site import Site


@dataclass(frozen=True, slots=True, eq=False)
class ReportedFlight:
    """A flight with its report, and what there is to say of the files it is from."""

    flight: Flight
    findings: tuple[Finding, ...]
    seconds: float


def report_files(
    plan_path: Path,
    site_path: Path,
    logs: Sequence[Path] = (),
    photos: Path | None = None,
    out: Path | None = None,
    heights: PhotoHeights = "auto",
    monitor: Monitor = QUIET,
) -> ReportedFlight:
    """Compare a flight with the plan in a file over the site in another; write it where `out` is given.

    Parameters
    ----------
    logs
        Of one flight, in the order of flight: .tlog, .BIN, .log or .ulg.
    photos
        Folder of its photos; instead of logs.
    heights
        What heights are counted from; with logs, `auto` is above take-off.

    Raises
    ------
    InputError
        A file cannot be read or written, or does not belong to the site; nothing is written then.
    ValueError
        Both logs and photos are given, or neither.
    """
    if bool(logs) == (photos is not None):
        raise ValueError("expected either logs or photos")
    started_s = time.perf_counter()
    if out is not None:
        check_not_index(out)
        check_output(out, [plan_path, site_path, *logs])
    plan, site_model = read_given_plan(plan_path), read_given_site(site_path)
    if plan.origin is not None and plan.origin != site_model.site.origin:
        raise InputError(
            f"{site_path}: the origin of '{site_model.site.name}' is not the one of the plan, which is for "
            f"'{plan.site}'; name the site file that the plan was made for"
        )
    if photos is not None:
        found = read_photo_flights(photos, site_model.site, heights, monitor)
    else:
        found = _of_logs(logs, site_model.site, heights, monitor)
    report = report_flight(plan, site_model, found.records, monitor=monitor)
    flight = flight_of(plan, site_model, found.records, report)
    if out is not None:
        write_flight(out, flight)
    return ReportedFlight(flight, found.findings, time.perf_counter() - started_s)


def _of_logs(logs: Sequence[Path], site: Site, heights: PhotoHeights, monitor: Monitor) -> LogFlights:
    """Flights of all logs, one after the other."""
    found = [read_log(log, site, "sea-level" if heights == "absolute" else "takeoff", monitor) for log in logs]
    return LogFlights(
        tuple(record for flights in found for record in flights.records),
        tuple(finding for flights in found for finding in flights.findings),
    )
