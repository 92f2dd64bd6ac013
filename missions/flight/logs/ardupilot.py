"""What ArduPilot's logs say of a flight: which messages hold what, over the years of its firmware.

Messages and fields as ArduPilot's documentation of its log messages has them (Copter 3.3 to 4.6); event numbers from
libraries/AP_Logger/AP_Logger.h.
"""

from __future__ import annotations

import numpy as np

from missions.flight.logs.dataflash import Table, binary_tables, column, looks_binary, text_tables, texts, times_s
from missions.flight.logs.raw import NOT_KNOWN, RawLog, RawPhoto, Row
from missions.flight.record import FlightEvent
from missions.mavlink.autopilots import Autopilot
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor

WANTED = frozenset(
    "POS GPS ATT AHR2 XKF1 NKF1 EKF1 MNT BAT CURR CAM TRIG MODE MSG EV ARM ERR PARM".split()  # noqa: SIM905
)

ARMED_EVENT, DISARMED_EVENT = 10, 11

HAS_FIX = 3
"""GPS.Status from which a position is three-dimensional."""


def read_dataflash(content: bytes, monitor: Monitor = QUIET) -> RawLog:
    """Everything a dataflash log says of the vehicle."""
    log = RawLog("ArduPilot, dataflash log", autopilot=Autopilot.ARDUPILOT)
    is_binary = looks_binary(content[:2])
    tables, n_lost = (binary_tables if is_binary else text_tables)(content, WANTED, monitor)
    if n_lost > (512 if is_binary else 0):  # a page of memory may end a binary log
        unit = "bytes of the log are no records" if is_binary else "lines of the log make no sense"
        log.note("log-damaged", f"{n_lost} {unit} and were skipped", n_lost)
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
            log.note("raw-positions", "the log has no fused positions (POS); those of the GNSS receiver are taken")
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
