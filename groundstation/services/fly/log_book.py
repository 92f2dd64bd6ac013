"""The log book: every flight with aircraft, battery, times, place and what was found, and the cycles of batteries.

One file for all flights of this user, and one in each project for its own. A flight is entered when it ends, also one
that ended badly. Simulated flights are entered as such, and count for no battery.
"""

from __future__ import annotations

import csv
import io
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from groundstation.services.fly.events import FlightEnded
from groundstation.services.settings import data_folder
from missions.flight.record import FlightRecord
from missions.mission.model import GeoPoint
from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, make_folder
from planning.base.findings import Severity
from planning.base.json_file import encoded, expect_format, read_json, to_record, write_atomically
from planning.base.messages import plain, say
from planning.plan import Plan
from planning.site.records import Site

FORMAT = "reflight-log-book/1"
FILE = "log-book.json"

LOG_BOOK_FILE = FileLimit(say("a log book"), 64 * MIB)
"""A hundred thousand flights."""

LOCK_S = 5.0
"""Longest wait for another window that writes."""

MAX_FINDINGS = 20


@dataclass(frozen=True, slots=True)
class BookEntry:
    """One flight.

    Parameters
    ----------
    started_unix_s, ended_unix_s
        From lift-off to touch-down, seconds since 1970 UTC, by this computer's clock.
    lat_deg, lon_deg
        Of the take-off.
    vehicle
        Autopilot and link.
    battery
        What the pilot calls it; empty where nobody said.
    battery_used
        Part of a full charge; None where it is not known.
    ended
        Why it ended badly; empty where it did not.
    findings
        Errors and warnings of the report.
    operator
        Public part of the operator's number.
    file
        Flight file.
    """

    started_unix_s: float
    ended_unix_s: float
    site: str
    lat_deg: float
    lon_deg: float
    aircraft: str
    vehicle: str
    sortie: int
    battery: str = ""
    battery_used: float | None = None
    n_photos: int = 0
    n_planned: int = 0
    least_distance_m: float | None = None
    ended: str = ""
    findings: tuple[str, ...] = ()
    operator: str = ""
    is_simulated: bool = False
    file: str = ""

    @property
    def duration_s(self) -> float:
        """How long it flew."""
        return self.ended_unix_s - self.started_unix_s


@dataclass(frozen=True, slots=True)
class _Book:
    format: str
    flights: tuple[BookEntry, ...] = ()


def entry_of(
    ended: FlightEnded,
    plan: Plan,
    site: Site,
    home: GeoPoint,
    now_unix_s: float,
    *,
    battery: str = "",
    operator: str = "",
    is_simulated: bool = False,
) -> BookEntry | None:
    """A flight that ended now as an entry; None where nothing flew."""
    record, report = ended.record, ended.report
    if record is None or not len(record.track.time_s):
        return None
    duration_s = record.duration_s
    if duration_s is None:
        duration_s = float(record.track.time_s[-1] - record.track.time_s[0])
    own = None if report is None else next((each for each in report.sorties if each.sortie == ended.sortie), None)
    found = () if report is None else report.findings
    worst = [each.message for each in found if each.severity in (Severity.ERROR, Severity.WARNING)]
    return BookEntry(
        started_unix_s=round(now_unix_s - duration_s, 1),
        ended_unix_s=round(now_unix_s, 1),
        site=site.name,
        lat_deg=round(home.lat_deg, 7),
        lon_deg=round(home.lon_deg, 7),
        aircraft=plan.aircraft.name,
        vehicle=plain(record.vehicle),
        sortie=ended.sortie,
        battery=battery,
        battery_used=_charge_used(record),
        n_photos=len(record.photos),
        n_planned=len(plan.sorties[ended.sortie - 1].viewpoint_ids),
        least_distance_m=None if own is None else own.least_distance_m,
        ended="" if ended.error is None else plain(str(ended.error)),
        findings=tuple(plain(text) for text in worst[:MAX_FINDINGS]),
        operator=operator,
        is_simulated=is_simulated,
        file="" if ended.path is None else str(ended.path),
    )


def _charge_used(record: FlightRecord) -> float | None:
    """Part of a full charge that a flight took."""
    known = record.track.battery[np.isfinite(record.track.battery)]
    return round(max(0.0, float(known[0] - known[-1])), 4) if len(known) > 1 else None


def book_path(folder: Path | None = None) -> Path:
    """The book of a folder of flights; None: that of all flights of this user."""
    return (data_folder() / "flights" if folder is None else folder) / FILE


def read_book(path: Path) -> tuple[BookEntry, ...]:
    """Flights of a book, the oldest first; none where there is no book yet.

    Raises
    ------
    InputError
        It cannot be read, or is none.
    """
    if not path.exists():
        return ()
    content = read_json(path, LOG_BOOK_FILE)
    expect_format(content, FORMAT, path)
    return tuple(sorted(to_record(content, _Book, path).flights, key=lambda each: each.started_unix_s))


def enter(entry: BookEntry, paths: Iterable[Path]) -> None:
    """Enter a flight in books; each is written whole, or stays as it was.

    Raises
    ------
    InputError
        One of them cannot be read or written; the others have it.
    """
    from filelock import FileLock, Timeout

    problems: list[InputError] = []
    for path in dict.fromkeys(paths):
        try:
            make_folder(path.parent)
            with FileLock(path.with_suffix(".lock"), timeout=LOCK_S):
                write_atomically(path, encoded(_Book(FORMAT, (*read_book(path), entry))))
        except Timeout:
            problems.append(
                InputError.say("another window writes it for too long; the flight is not in it", place=path)
            )
        except InputError as error:
            problems.append(error)
        except OSError as error:
            problems.append(InputError.say("cannot be written ({})", error.strerror or error, place=path))
    if problems:
        raise problems[0]


@dataclass(frozen=True, slots=True)
class BatteryUse:
    """What a battery has done.

    Parameters
    ----------
    cycles
        Full charges that all its flights took together.
    n_unknown
        Flights of which the charge is not known; they count for no cycle.
    """

    name: str
    n_flights: int
    cycles: float
    flown_s: float
    last_unix_s: float
    n_unknown: int = 0


def battery_uses(entries: Iterable[BookEntry]) -> tuple[BatteryUse, ...]:
    """Use of each battery that was named, by name; simulated flights use none."""
    by_name: dict[str, list[BookEntry]] = {}
    for entry in entries:
        if entry.battery and not entry.is_simulated:
            by_name.setdefault(entry.battery, []).append(entry)
    return tuple(
        BatteryUse(
            name,
            len(flown),
            sum(each.battery_used or 0.0 for each in flown),
            sum(each.duration_s for each in flown),
            max(each.ended_unix_s for each in flown),
            sum(each.battery_used is None for each in flown),
        )
        for name, flown in sorted(by_name.items())
    )


COLUMNS = (
    *("date", "start_utc", "end_utc", "minutes", "site", "latitude", "longitude", "aircraft", "vehicle", "sortie"),
    *("battery", "battery_used_percent", "photos", "photos_planned", "least_distance_m", "ended", "findings"),
    *("operator", "simulated", "flight_file"),
)

FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""What a spreadsheet takes for a formula when a text begins so: names and findings come from files of others."""


def book_csv(entries: Sequence[BookEntry]) -> str:
    """The book as a table for spreadsheets."""
    out = io.StringIO()
    table = csv.writer(out, lineterminator="\r\n")
    table.writerow(COLUMNS)
    for each in entries:
        table.writerow([_cell(value) for value in _row(each)])
    return out.getvalue()


def _row(entry: BookEntry) -> tuple[Any, ...]:
    start, end = time.gmtime(entry.started_unix_s), time.gmtime(entry.ended_unix_s)
    used = None if entry.battery_used is None else round(100.0 * entry.battery_used, 1)
    distance_m = None if entry.least_distance_m is None else round(entry.least_distance_m, 2)
    return (
        time.strftime("%Y-%m-%d", start),
        time.strftime("%H:%M:%S", start),
        time.strftime("%H:%M:%S", end),
        round(entry.duration_s / 60.0, 2),
        *(entry.site, entry.lat_deg, entry.lon_deg, entry.aircraft, entry.vehicle, entry.sortie, entry.battery),
        *(used, entry.n_photos, entry.n_planned, distance_m, entry.ended, " | ".join(entry.findings)),
        *(entry.operator, int(entry.is_simulated), entry.file),
    )


def _cell(value: Any) -> Any:
    if value is None:
        return ""
    return f"'{value}" if isinstance(value, str) and value.startswith(FORMULA) else value


def write_book_csv(path: Path, entries: Sequence[BookEntry]) -> None:
    """Write the table; with a mark at its beginning, by which spreadsheets know UTF-8.

    Raises
    ------
    InputError
        It cannot be written.
    """
    write_atomically(path, b"\xef\xbb\xbf" + book_csv(entries).encode())
