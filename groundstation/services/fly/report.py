"""Use case of looking back: a flight compared with its plan, from logs of the autopilot or from its photos alone."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from groundstation.services.project.input_files import read_given_plan, read_given_site
from groundstation.services.project.project_file import check_not_index
from groundstation.vehicle.duration import items_duration_s, timed_by_items
from groundstation.vehicle.orders import sortie_orders
from missions.flight.flight_file import Flight, flight_of, write_flight
from missions.flight.logs.flights import LogFlights
from missions.flight.logs.read import read_log
from missions.flight.photo_folder import read_photo_flights
from missions.flight.report import report_flight
from missions.mavlink.autopilots import Autopilot
from missions.mission.build import missions_from_plan
from planning.base.errors import InfeasibleError, InputError, MissionError
from planning.base.findings import Finding
from planning.base.json_file import check_output
from planning.base.progress import QUIET, Monitor
from planning.photos.places import PhotoHeights
from planning.plan import Plan
from planning.site.records import Site, SiteModel


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
    timed = plan if found.autopilot is None else _timed(plan, site_model, found.autopilot)
    report = report_flight(timed, site_model, found.records, monitor=monitor)
    flight = flight_of(plan, site_model, found.records, report)
    if out is not None:
        write_flight(out, flight)
    return ReportedFlight(flight, found.findings, time.perf_counter() - started_s)


def _of_logs(logs: Sequence[Path], site: Site, heights: PhotoHeights, monitor: Monitor) -> LogFlights:
    """Flights of all logs, one after the other."""
    found = [read_log(log, site, "sea-level" if heights == "absolute" else "takeoff", monitor) for log in logs]
    autopilots = {flights.autopilot for flights in found}
    return LogFlights(
        tuple(record for flights in found for record in flights.records),
        tuple(finding for flights in found for finding in flights.findings),
        autopilots.pop() if len(autopilots) == 1 else None,
    )


def _timed(plan: Plan, site_model: SiteModel, autopilot: Autopilot) -> Plan:
    """The plan with the durations of its items; as it is where no items can be made of it.

    Its own durations are those of an aircraft that turns at the waypoint, which MAVLink's do not.
    """
    try:
        missions = missions_from_plan(plan, site_model.site.origin, site_model.site.home_enu_m)
        orders = [sortie_orders(plan, site_model, mission) for mission in missions]
        return timed_by_items(plan, {each.number: items_duration_s(each, autopilot) for each in orders})
    except (InputError, MissionError, InfeasibleError):
        return plan  # It was flown all the same, in other items; the report on it must not be lost.
