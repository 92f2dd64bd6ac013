"""Reading and writing `flight.json` (format reflight-flight/1, docs/reference/file-formats.md)."""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from missions.flight.outcome import FlightReport
from missions.flight.record import FlightEvent, FlightRecord, TakenPhoto, Track
from planning.base.effects import Decision
from planning.base.errors import InputError
from planning.base.json_file import expect_format, plain_values, read_json, to_record, write_atomically
from planning.geo.frames import Origin
from planning.plan import Plan, plan_to_json
from planning.site.records import SiteModel

FLIGHT_FORMAT = "reflight-flight/1"


@dataclass(frozen=True, slots=True)
class Flight:
    """The content of `flight.json`.

    Parameters
    ----------
    site, site_sha256, plan_sha256
        What was flown: name of the site, and SHA-256 of both files; empty where it is not known.
    origin
        Of the site, so that the file stands by itself.
    sorties
        Records in the order of flight; a sortie that was interrupted may have several.
    report
        Comparison with the plan, where it was made.
    """

    site: str
    site_sha256: str
    plan_sha256: str
    origin: Origin
    sorties: tuple[FlightRecord, ...]
    report: FlightReport | None = None
    format: str = FLIGHT_FORMAT


def flight_of(
    plan: Plan, site_model: SiteModel, records: tuple[FlightRecord, ...], report: FlightReport | None = None
) -> Flight:
    """The flight file of records that were made on a site with a plan."""
    site = site_model.site
    return Flight(site.name, site_model.sha256, plan_sha256(plan), site.origin, records, report)


def plan_sha256(plan: Plan) -> str:
    """SHA-256 of the plan file that `write_plan` would write, hexadecimal."""
    return hashlib.sha256(json.dumps(plan_to_json(plan), indent=1, allow_nan=False).encode()).hexdigest()


SAME_M = 1e-3
"""Files keep more digits of positions and errors."""


def is_of_plan(flight: Flight, plan: Plan) -> bool:
    """Whether a flight was flown with a plan: by its checksum, or by its photos being as far from the plan's views.

    A later version of the program may write the same plan in other words. The report says how far each photo was from
    its view: another plan's views are elsewhere.
    """
    if flight.plan_sha256 and flight.plan_sha256 == plan_sha256(plan):
        return True
    views = () if flight.report is None else flight.report.views
    planned = {view.id: view.position_enu_m for view in plan.viewpoints}
    if [view.view_id for view in views] != [name for sortie in plan.sorties for name in sortie.viewpoint_ids]:
        return False
    off_m = []
    for view in views:
        if view.record is not None and view.photo is not None and view.position_error_m is not None:
            photos = flight.sorties[view.record].photos if 0 <= view.record < len(flight.sorties) else ()
            if not 0 <= view.photo < len(photos):
                return False  # a file that was edited by hand
            off_m.append(math.dist(photos[view.photo].position_enu_m, planned[view.view_id]) - view.position_error_m)
    return bool(off_m) and max(map(abs, off_m)) <= SAME_M


Point = tuple[float | None, float | None, float | None]


@dataclass(frozen=True, slots=True)
class _TrackColumns:
    """A track as it stands in the file: a list for each column, null where a value is not known."""

    time_s: tuple[float, ...]
    position_enu_m: tuple[Point, ...]
    velocity_enu_m_s: tuple[Point, ...]
    heading_rad: tuple[float | None, ...]
    gimbal_pitch_rad: tuple[float | None, ...]
    gimbal_heading_rad: tuple[float | None, ...]
    battery: tuple[float | None, ...]


@dataclass(frozen=True, slots=True)
class _RecordContent:
    sortie: int
    vehicle: str
    track: _TrackColumns
    photos: tuple[TakenPhoto, ...]
    events: tuple[FlightEvent, ...] = ()
    duration_s: float | None = None
    effects: tuple[Decision, ...] = ()
    counted_before: int | None = None
    counted_after: int | None = None
    is_disarmed: bool | None = None


@dataclass(frozen=True, slots=True)
class _FlightContent:
    format: str
    site: str
    origin: Origin
    sorties: tuple[_RecordContent, ...]
    site_sha256: str = ""
    plan_sha256: str = ""
    report: FlightReport | None = None


def read_flight(path: Path) -> Flight:
    """Read a flight.

    Raises
    ------
    InputError
        The file is missing or wrong; the message names the file, the field and what was expected.
    """
    content = read_json(path, names_files=True)
    expect_format(content, FLIGHT_FORMAT, path)
    flight = to_record(content, _FlightContent, path)
    records = tuple(_record(record, f"{path}: sorties[{i}]") for i, record in enumerate(flight.sorties))
    return Flight(flight.site, flight.site_sha256, flight.plan_sha256, flight.origin, records, flight.report)


def _record(content: _RecordContent, place: str) -> FlightRecord:
    columns = {}
    for field in fields(Track):
        values = np.array(getattr(content.track, field.name), np.float64)
        columns[field.name] = values.reshape(-1, 3) if field.name.endswith(("enu_m", "enu_m_s")) else values
    try:
        track = Track(**columns)
    except ValueError as error:
        raise InputError(f"{place}.track.{error}") from error
    for i, photo in enumerate(content.photos):
        if not all(map(math.isfinite, (photo.time_s, *photo.position_enu_m))):
            raise InputError.say("expected a finite time and position", place=f"{place}.photos[{i}]")
    return FlightRecord(
        content.sortie,
        content.vehicle,
        track,
        content.photos,
        content.events,
        content.duration_s,
        content.effects,
        content.counted_before,
        content.counted_after,
        content.is_disarmed,
    )


def flight_to_json(flight: Flight) -> dict[str, Any]:
    """Content of `flight.json`: plain values, null for what is not known."""
    content: dict[str, Any] = {
        "format": flight.format,
        "site": flight.site,
        "site_sha256": flight.site_sha256,
        "plan_sha256": flight.plan_sha256,
        "origin": plain_values(flight.origin),
        "sorties": [_record_to_json(record) for record in flight.sorties],
    }
    if flight.report is not None:
        content["report"] = plain_values(flight.report)
    return content


def _record_to_json(record: FlightRecord) -> dict[str, Any]:
    return {
        "sortie": record.sortie,
        "vehicle": record.vehicle,
        "duration_s": record.duration_s,
        "photos": plain_values(record.photos),
        "events": plain_values(record.events),
        "effects": plain_values(record.effects),
        "counted_before": record.counted_before,
        "counted_after": record.counted_after,
        "is_disarmed": record.is_disarmed,
        "track": {field.name: _with_nulls(getattr(record.track, field.name)) for field in fields(Track)},
    }


def _with_nulls(values: np.ndarray[Any, np.dtype[np.float64]]) -> list[Any]:
    """Nested lists of an array, None for what is not finite."""
    listed: list[Any] = np.where(np.isfinite(values), values, np.nan).astype(object).tolist()
    if np.isfinite(values).all():
        return listed
    if values.ndim == 1:
        return [None if math.isnan(value) else value for value in listed]
    return [[None if math.isnan(value) else value for value in row] for row in listed]


def write_flight(path: Path, flight: Flight) -> None:
    """Write a flight, whole or not at all.

    Raises
    ------
    InputError
        The folder is missing or cannot be written, or the disk is full.
    ValueError
        A photo, event or report holds NaN or Infinity.
    """
    write_atomically(path, _in_pieces(flight_to_json(flight)).encode())


def _in_pieces(content: Any) -> str:
    """JSON of nested objects, each of their values by itself.

    The encoder holds the interpreter until it is done: a tenth of a second for all of a flight of five minutes, in
    which the window stood still.
    """
    if isinstance(content, dict):
        return "{" + ",".join(f"{json.dumps(key)}:{_in_pieces(value)}" for key, value in content.items()) + "}"
    if isinstance(content, list) and content and isinstance(content[0], dict):
        return "[" + ",".join(map(_in_pieces, content)) + "]"
    return json.dumps(content, allow_nan=False, separators=(",", ":"))
