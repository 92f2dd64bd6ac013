"""ArduPilot's own logs (dataflash): binary (.BIN) and text (.log), as tables of one kind of message each.

A binary log is a row of records: 0xA3 0x95, a type, and fields without padding. FMT records (type 128) say what the
others hold: type, length, name, and a letter and a label for each field (ArduPilot, AP_Logger/LogStructure.h).
Text logs hold the same as lines of comma-separated values.

pymavlink's DFReader reads both, and our tables are tested against it. It is not used here because a record length of
zero in a damaged log keeps it in an endless loop, and because it turns every record into an object: a minute for a log
that takes a second here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from missions.flight.logs.raw import NOT_KNOWN, RawLog, RawPhoto, Row
from missions.flight.record import FlightEvent
from missions.mavlink.autopilots import Autopilot
from planning.base.jit import kernel
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor

Column = NDArray[np.generic]
Table = dict[str, Column]
"""Columns of one kind of message by label, all of one length; numbers are float64 in the units of the log."""

HEADER = b"\xa3\x95"
FMT_TYPE = 128
_FMT = np.dtype([("type", "u1"), ("length", "u1"), ("name", "S4"), ("letters", "S16"), ("labels", "S64")])

_KINDS: Mapping[str, tuple[str, float]] = {
    "b": ("i1", 1), "B": ("u1", 1), "M": ("u1", 1), "h": ("<i2", 1), "H": ("<u2", 1), "i": ("<i4", 1),
    "I": ("<u4", 1), "q": ("<i8", 1), "Q": ("<u8", 1), "f": ("<f4", 1), "d": ("<f8", 1), "g": ("<f2", 1),
    "c": ("<i2", 0.01), "C": ("<u2", 0.01), "e": ("<i4", 0.01), "E": ("<u4", 0.01), "L": ("<i4", 1e-7),
    "n": ("S4", 0), "N": ("S16", 0), "Z": ("S64", 0), "a": ("64V", 0),
}  # fmt: skip
"""NumPy type of each letter, and what its numbers are multiplied by; 0 for what is no number."""


@kernel
def _scan(data: NDArray[np.uint8], places: NDArray[np.int64]) -> tuple[int, int]:
    """Find all records: fill `places` with their offsets; how many there are, and how many bytes are no records."""
    lengths = np.zeros(256, np.int64)
    lengths[128] = 89
    at, found, lost = 0, 0, 0
    while at + 3 <= len(data):
        length = lengths[data[at + 2]] if data[at] == 0xA3 and data[at + 1] == 0x95 else 0
        if length < 3 or at + length > len(data):
            at += 1
            lost += 1
            continue
        if data[at + 2] == 128:
            lengths[data[at + 3]] = data[at + 4]
            lengths[128] = 89
        places[found] = at
        found += 1
        at += length
    return found, lost + len(data) - at


def looks_binary(head: bytes) -> bool:
    """Whether a file begins as a binary log."""
    return head.startswith(HEADER)


def looks_like_text(head: bytes) -> bool:
    """Whether a file begins as a text log."""
    return b"FMT," in head


def binary_tables(content: bytes, names: frozenset[str], monitor: Monitor = QUIET) -> tuple[dict[str, Table], int]:
    """Tables of the wanted messages of a binary log, and how many bytes of it are no records."""
    data = np.frombuffer(content, np.uint8)
    monitor.report(say("reading the log"), 0, 1)
    places = np.empty(len(data) // 3 + 1, np.int64)
    n_found, n_lost = _scan(data, places)
    places = places[:n_found]
    kinds = data[places + 2] if n_found else np.zeros(0, np.uint8)
    formats = _gather(data, places[kinds == FMT_TYPE], _FMT.itemsize).view(_FMT).reshape(-1)
    tables: dict[str, Table] = {}
    for record in formats:
        name = _text(record["name"])
        if name not in names or name in tables:
            continue
        layout = _layout(_text(record["letters"]), _text(record["labels"]))
        if layout is None or layout.itemsize + 3 != record["length"]:
            continue
        rows = _gather(data, places[kinds == record["type"]], layout.itemsize).view(layout).reshape(-1)
        letters = dict(zip(layout.names or (), _text(record["letters"]), strict=True))
        tables[name] = {label: _scaled(rows[label], letter) for label, letter in letters.items()}
    return tables, n_lost


def _gather(data: NDArray[np.uint8], places: NDArray[np.int64], size: int) -> NDArray[np.uint8]:
    """Bytes after the headers of records, shape (n, size)."""
    return np.ascontiguousarray(data[places[:, None] + 3 + np.arange(size)])


def _layout(letters: str, labels: str) -> np.dtype[np.void] | None:
    """NumPy type of a record without its header; None where the format makes no sense."""
    names = labels.split(",")
    if len(names) != len(letters) or len(set(names)) != len(names) or not all(names):
        return None
    if not all(letter in _KINDS for letter in letters):
        return None
    return np.dtype([(name, _KINDS[letter][0]) for name, letter in zip(names, letters, strict=True)])


def _scaled(values: Column, letter: str) -> Column:
    factor = _KINDS[letter][1]
    if factor == 0:
        return values
    with np.errstate(invalid="ignore"):  # damaged numbers may be signalling NaN, which stay NaN
        numbers = values.astype(np.float64)
    return np.asarray(numbers if factor == 1 else numbers * factor)


def text_tables(content: bytes, names: frozenset[str], monitor: Monitor = QUIET) -> tuple[dict[str, Table], int]:
    """Tables of the wanted messages of a text log, and how many of its lines make no sense."""
    letters: dict[str, str] = {}
    labels: dict[str, list[str]] = {}
    rows: dict[str, list[list[str]]] = {}
    lines = content.decode("utf-8", "replace").splitlines()
    n_lost = 0
    for number, line in enumerate(lines):
        if number % 65536 == 0:
            monitor.report(say("reading the log"), number, len(lines))
        name, _, rest = line.partition(",")
        if name == "FMT":
            parts = [part.strip() for part in rest.split(",")]
            if len(parts) >= 5 and parts[2] in names:
                letters[parts[2]], labels[parts[2]] = parts[3], parts[4:]
        elif name in labels:
            values = [value.strip() for value in rest.split(",", len(labels[name]) - 1)]
            if len(values) == len(labels[name]):
                rows.setdefault(name, []).append(values)
            else:
                n_lost += 1
    tables = {}
    for name, values_of in rows.items():
        if len(letters[name]) == len(labels[name]) == len(set(labels[name])):
            columns = zip(labels[name], letters[name], zip(*values_of, strict=True), strict=True)
            tables[name] = {label: _parsed(values, letter) for label, letter, values in columns}
    return tables, n_lost


def _parsed(values: tuple[str, ...], letter: str) -> Column:
    """A column of a text log; numbers stand in it as they are, mode names (M) as text."""
    if letter == "M" or _KINDS.get(letter, ("", 0))[1] == 0:
        return np.array([value.encode() for value in values])
    return np.array([_number(value) for value in values], np.float64)


def _number(value: str) -> float:
    try:
        return float(value)
    except ValueError:
        return math.nan


def _text(value: bytes) -> str:
    return bytes(value).split(b"\0")[0].decode("latin-1")


def column(table: Table, label: str) -> NDArray[np.float64] | None:
    """A column of numbers; None where there is none of that name."""
    values = table.get(label)
    return values.astype(np.float64) if values is not None and values.dtype.kind == "f" else None


def texts(table: Table, label: str) -> list[str]:
    """A column of texts; empty where there is none of that name."""
    values = table.get(label)
    if values is None or values.dtype.kind != "S":
        return []
    return [bytes(value).split(b"\0")[0].decode("utf-8", "replace") for value in values]


def times_s(table: Table) -> NDArray[np.float64] | None:
    """Seconds since boot of each row; None for messages of old firmware that have no time.

    Old GPS messages hold the milliseconds of the week in TimeMS, and those since boot in T.
    """
    for label, factor in (("TimeUS", 1e-6), ("T", 1e-3), ("TimeMS", 1e-3)):
        values = column(table, label)
        if values is not None:
            return np.asarray(values * factor)
    return None


# What ArduPilot's logs say of a flight: which messages hold what, over the years of its firmware.
#
# Messages and fields as ArduPilot's documentation of its log messages has them (Copter 3.3 to 4.6); event numbers from
# libraries/AP_Logger/AP_Logger.h.

MESSAGES_READ = frozenset(
    "POS GPS ATT AHR2 XKF1 NKF1 EKF1 MNT BAT CURR CAM TRIG MODE MSG EV ARM ERR PARM".split()  # noqa: SIM905
)

ARMED_EVENT, DISARMED_EVENT = 10, 11

HAS_FIX = 3
"""GPS.Status from which a position is three-dimensional."""


def read_dataflash(content: bytes, monitor: Monitor = QUIET) -> RawLog:
    """Everything a dataflash log says of the vehicle."""
    log = RawLog(say("ArduPilot, dataflash log"), autopilot=Autopilot.ARDUPILOT)
    is_binary = looks_binary(content[:2])
    tables, n_lost = (binary_tables if is_binary else text_tables)(content, MESSAGES_READ, monitor)
    if n_lost > (512 if is_binary else 0):  # a page of memory may end a binary log
        text = (
            say("{} bytes of the log are no records and were skipped", n_lost)
            if is_binary
            else say("{} lines of the log make no sense and were skipped", n_lost)
        )
        log.note("log-damaged", text, n_lost)
    _positions(log, tables)
    _attitude(log, tables)
    _battery(log, tables)
    log.photos = _photos(tables.get("CAM", {}))
    log.triggers = _photos(tables.get("TRIG", {}))
    _events(log, tables)
    return log


def _rows(table: Table, *labels: str, factor: float = 1.0) -> list[Row]:
    """Rows of time and the named columns; empty where one of them is missing."""
    time_s = times_s(table)
    columns = [column(table, label) for label in labels]
    if time_s is None or any(values is None for values in columns):
        return []
    numbers = np.column_stack([time_s, *(values * factor for values in columns if values is not None)])
    return [tuple(row) for row in numbers.tolist()]


def _positions(log: RawLog, tables: dict[str, Table]) -> None:
    """The fused position where it is logged, or else the receiver's."""
    log.positions = _rows(tables.get("POS", {}), "Lat", "Lng", "Alt", "RelHomeAlt")
    gps = _first_instance(tables.get("GPS", {}), "I")
    if not log.positions and gps:
        status = column(gps, "Status")
        rows = _rows(gps, "Lat", "Lng", "Alt", "RelAlt") or [
            (*row, NOT_KNOWN) for row in _rows(gps, "Lat", "Lng", "Alt")
        ]
        log.positions = rows if status is None else [r for r, s in zip(rows, status, strict=False) if s >= HAS_FIX]
        if log.positions:
            log.note("raw-positions", say("the log has no fused positions (POS); those of the GNSS receiver are taken"))
    for name in ("XKF1", "NKF1", "EKF1"):
        log.velocities = log.velocities or _rows(_first_instance(tables.get(name, {}), "C"), "VN", "VE", "VD")


def _first_instance(table: Table, label: str) -> Table:
    """Rows of the first receiver, estimator or mount where there are several."""
    number = column(table, label)
    if number is None or len(number) == 0:
        return table
    return {name: values[number == number.min()] for name, values in table.items()}


def _attitude(log: RawLog, tables: dict[str, Table]) -> None:
    to_rad = np.pi / 180.0
    log.headings = _rows(tables.get("ATT", {}), "Yaw", factor=to_rad) or _rows(
        tables.get("AHR2", {}), "Yaw", factor=to_rad
    )
    mount = _first_instance(tables.get("MNT", {}), "I")
    log.gimbal_pitches = _rows(mount, "Pitch", factor=to_rad)
    log.gimbal_headings = _rows(mount, "YawE", factor=to_rad)
    log.gimbal_yaws = _rows(mount, "YawB", factor=to_rad)


def _battery(log: RawLog, tables: dict[str, Table]) -> None:
    """Charge left as the autopilot says it, or else what was drawn from the capacity that it was told."""
    battery = _first_instance(tables.get("BAT", {}), "Inst") or tables.get("CURR", {})
    percent = [row for row in _rows(battery, "RemPct") if 0.0 <= row[1] <= 100.0]
    if percent:
        log.battery = [(time_s, value / 100.0) for time_s, value in percent]
        return
    parameters = dict(zip(texts(tables.get("PARM", {}), "Name"), tables.get("PARM", {}).get("Value", ()), strict=False))
    capacity_mah = float(parameters.get("BATT_CAPACITY", 0.0))
    if capacity_mah > 0.0:
        drawn = _rows(battery, "CurrTot")
        log.battery = [(time_s, max(0.0, 1.0 - mah / capacity_mah)) for time_s, mah in drawn]


def _photos(table: Table) -> list[RawPhoto]:
    """Photos of CAM (the camera's feedback) or TRIG; R, P and Y there are the vehicle's, never the gimbal's."""
    rows = _rows(table, "Lat", "Lng", "Alt", "RelAlt")
    numbers = column(table, "Img")
    if numbers is None:
        numbers = np.arange(1.0, len(rows) + 1.0)
    photos = []
    for number, (time_s, lat_deg, lon_deg, altitude_amsl_m, above_home_m) in zip(numbers, rows, strict=True):
        photos.append(RawPhoto(_index(number), time_s, lat_deg, lon_deg, altitude_amsl_m, above_home_m))
    return photos


def _index(number: float) -> int:
    return int(number) if np.isfinite(number) else 0


def _events(log: RawLog, tables: dict[str, Table]) -> None:
    for time_s, text in _timed_texts(tables.get("MSG", {}), "Message"):
        log.events.append(FlightEvent(time_s, "text", text))
    for time_s, subsystem, code in _rows(tables.get("ERR", {}), "Subsys", "ECode"):
        log.events.append(FlightEvent(time_s, "error", f"subsystem {subsystem:g}, code {code:g}"))
    for time_s, name in _modes(tables.get("MODE", {})):
        log.mode(time_s, name)
    armed = [(time_s, state > 0) for time_s, state in _rows(tables.get("ARM", {}), "ArmState")]
    events = [(t, code == ARMED_EVENT) for t, code in _rows(tables.get("EV", {}), "Id") if code in _ARMING]
    for time_s, is_armed in armed or events:
        log.arm(time_s, is_armed)


_ARMING = (ARMED_EVENT, DISARMED_EVENT)


def _timed_texts(table: Table, label: str) -> list[tuple[float, str]]:
    time_s = times_s(table)
    return [] if time_s is None else list(zip(time_s.tolist(), texts(table, label), strict=False))


def _modes(table: Table) -> list[tuple[float, str]]:
    """Names of modes: text logs have them, binary ones have Copter's numbers."""
    from pymavlink import mavutil

    if names := _timed_texts(table, "Mode"):
        return names
    rows = _rows(table, "ModeNum") or _rows(table, "Mode")
    known = mavutil.mode_mapping_acm
    return [
        (time_s, known.get(int(number), say("mode {:g}", number))) for time_s, number in rows if np.isfinite(number)
    ]
