"""PX4's own logs (ULog, .ulg), read with PX4's library pyulog.

Topics and fields as PX4's message definitions have them (v1.4 to v1.16). A log to which data was appended after the
end, as PX4 does with what it still has in memory after a crash, is read to its end.
"""

from __future__ import annotations

import contextlib
import io
import math
import struct
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from missions.flight.logs.raw import RawLog, RawPhoto, Row
from missions.flight.record import FlightEvent
from missions.mavlink.autopilots import Autopilot
from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor

if TYPE_CHECKING:
    from pyulog import ULog

Columns = dict[str, NDArray[np.float64]]

MAGIC = b"ULog\x01\x12\x35"

MESSAGES_READ = (
    "vehicle_global_position",
    "vehicle_gps_position",
    "sensor_gps",
    "vehicle_local_position",
    "vehicle_attitude",
    "gimbal_device_attitude_status",
    "mount_orientation",
    "battery_status",
    "camera_capture",
    "camera_trigger",
    "home_position",
    "vehicle_status",
    "actuator_armed",
)

MAX_FIELDS = 2000
"""A topic is unfolded into single fields; the largest of PX4 has some hundred. Nested types of a hostile log would
unfold into billions."""

ARMED_STATE = 2
"""vehicle_status.arming_state."""

NAVIGATION_STATES = {
    0: "MANUAL", 1: "ALTCTL", 2: "POSCTL", 3: "MISSION", 4: "LOITER", 5: "RTL", 10: "ACRO", 12: "DESCEND",
    13: "TERMINATION", 14: "OFFBOARD", 15: "STABILIZED", 17: "TAKEOFF", 18: "LAND", 19: "FOLLOW_ME",
    20: "PRECISION_LAND", 21: "ORBIT", 22: "VTOL_TAKEOFF",
}  # fmt: skip
"""vehicle_status.nav_state."""

HAS_FIX = 3


def looks_like_ulog(head: bytes) -> bool:
    """Whether a file begins as a ULog."""
    return head.startswith(MAGIC)


def read_ulog(content: bytes, label: str, monitor: Monitor = QUIET) -> RawLog:
    """Everything a ULog says of the vehicle.

    Raises
    ------
    InputError
        The log is damaged beyond reading.
    """
    from pyulog import core

    monitor.report(say("reading the log"), 0, 1)
    log = RawLog("PX4, ULog", autopilot=Autopilot.PX4)
    try:
        # pyulog prints what it finds wrong; the standard output belongs to --json.
        with contextlib.redirect_stdout(io.StringIO()):
            _check_formats(core.ULog(_BoundedFile(content, label), parse_header_only=True))
            source = core.ULog(_BoundedFile(content, label), list(MESSAGES_READ))
    except (core.ULogException, struct.error, ValueError, KeyError, IndexError, TypeError, OverflowError) as error:
        raise InputError.say(
            "the ULog cannot be read ({}); copy it from the vehicle again", error, place=label
        ) from error
    topics = _topics(source)
    if source.file_corruption:
        log.note("log-damaged", say("parts of the log are damaged and were skipped"))
    if source.dropouts:
        lost_s = sum(dropout.duration for dropout in source.dropouts) / 1e3
        log.note("log-gaps", say("the log has {} gaps, {:.1f} s together", len(source.dropouts), lost_s), lost_s)
    _positions(log, topics)
    _attitude(log, topics)
    log.battery = [row for row in _rows(topics, "battery_status", "remaining") if 0.0 <= row[1] <= 1.0]
    _photos(log, topics)
    _events(log, topics, source)
    return log


class _BoundedFile(io.BytesIO):
    """A log in memory that ends endless reading: pyulog steps back over damage, in some logs for ever.

    A message takes two reads and has some 50 bytes, a byte of damage takes two reads as well.
    """

    def __init__(self, content: bytes, label: str) -> None:
        super().__init__(content)
        self._label = label
        self._n_left = len(content) // 2 + 10_000

    def read(self, size: int | None = -1) -> bytes:
        """Read, but not without end.

        Raises
        ------
        InputError
            A healthy log would have been read long ago.
        """
        self._n_left -= 1
        if self._n_left < 0:
            raise InputError.say(
                "the ULog is damaged beyond reading; copy it from the vehicle again", place=self._label
            )
        return super().read(size)


def _check_formats(header: ULog) -> None:
    """Raise ValueError where a topic would unfold into more than `MAX_FIELDS` fields, or into itself."""
    formats = header.message_formats
    sizes: dict[str, int] = {}

    def size(name: str, depth: int) -> int:
        if name not in formats:
            return 1
        if depth > 16:
            raise ValueError(f"the type '{name}' contains itself")
        if name not in sizes:
            sizes[name] = sum(max(1, count) * size(kind, depth + 1) for kind, count, _ in formats[name].fields)
        return sizes[name]

    for name in MESSAGES_READ:
        if size(name, 0) > MAX_FIELDS:
            raise ValueError(f"the topic '{name}' has more than {MAX_FIELDS} fields")


def _topics(source: ULog) -> dict[str, Columns]:
    """Columns of the first instance of each topic as float64, with the time in seconds; appended parts joined."""
    topics: dict[str, Columns] = {}
    first_us = int(source.start_timestamp)
    for data in source.data_list:
        if data.multi_id != 0 or "timestamp" not in data.data:
            continue
        with np.errstate(invalid="ignore"):  # damaged numbers may be signalling NaN, which stay NaN
            columns = {name: np.asarray(values, np.float64) for name, values in data.data.items()}
        # Microseconds may count from 1970 in a simulation: subtracted as integers, before any precision is lost.
        past_us = data.data["timestamp"].astype(np.uint64) - np.uint64(first_us % 2**64)
        columns["time_s"] = past_us.view(np.int64) / 1e6
        known = topics.get(data.name)
        if known is None:
            topics[data.name] = columns
        else:
            topics[data.name] = {n: np.concatenate([known[n], columns[n]]) for n in known if n in columns}
    return topics


def _rows(topics: dict[str, Columns], topic: str, *names: str) -> list[Row]:
    """Rows of time and the named fields; empty where the topic or one of them is missing."""
    columns = topics.get(topic, {})
    if not all(name in columns for name in ("time_s", *names)):
        return []
    return [tuple(row) for row in np.column_stack([columns[name] for name in ("time_s", *names)]).tolist()]


def _positions(log: RawLog, topics: dict[str, Columns]) -> None:
    home = [alt for _, alt in _rows(topics, "home_position", "alt") if math.isfinite(alt) and alt != 0.0]
    home_amsl_m = home[-1] if home else math.nan
    fused = _rows(topics, "vehicle_global_position", "lat", "lon", "alt")
    log.positions = [(*row, row[3] - home_amsl_m) for row in fused]
    if not log.positions and (receiver := _receiver_rows(topics)):
        log.positions = [(*row, row[3] - home_amsl_m) for row in receiver]
        log.note("raw-positions", say("the log has no fused positions; those of the GNSS receiver are taken"))
    log.velocities = _rows(topics, "vehicle_local_position", "vx", "vy", "vz")


def _receiver_rows(topics: dict[str, Columns]) -> list[Row]:
    """Positions of the GNSS receiver: 1e-7 degrees and millimetres, since 2024 degrees and metres."""
    for topic in ("vehicle_gps_position", "sensor_gps"):
        for names, scale, metre in (
            (("latitude_deg", "longitude_deg", "altitude_msl_m"), 1.0, 1.0),
            (("lat", "lon", "alt"), 1e-7, 1e-3),
        ):
            rows = _rows(topics, topic, *names, "fix_type")
            if rows:
                return [(t, lat * scale, lon * scale, alt * metre) for t, lat, lon, alt, fix in rows if fix >= HAS_FIX]
    return []


def _attitude(log: RawLog, topics: dict[str, Columns]) -> None:
    quaternion = ("q[0]", "q[1]", "q[2]", "q[3]")
    for time_s, *q in _rows(topics, "vehicle_attitude", *quaternion):
        w, x, y, z = q
        log.headings.append((time_s, math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))))
    for time_s, *q, flags in _rows(topics, "gimbal_device_attitude_status", *quaternion, "device_flags"):
        if math.isfinite(flags):
            log.gimbal(time_s, q, int(flags))
    if not log.gimbal_pitches:
        angle = "attitude_euler_angle"
        for time_s, pitch, yaw in _rows(topics, "mount_orientation", f"{angle}[1]", f"{angle}[2]"):
            log.gimbal_pitches.append((time_s, pitch))
            log.gimbal_yaws.append((time_s, yaw))


def _photos(log: RawLog, topics: dict[str, Columns]) -> None:
    fields = ("seq", "lat", "lon", "alt", "q[0]", "q[1]", "q[2]", "q[3]", "result")
    for time_s, number, lat, lon, alt, *q, result in _rows(topics, "camera_capture", *fields):
        if result == 0:
            log.camera_failed(time_s, int(number))
            continue
        w, x, y, z = q
        log.photos.append(RawPhoto(int(number), time_s, lat, lon, alt, q_wxyz=(w, x, y, z)))
    triggers = _rows(topics, "camera_trigger", "seq", "feedback") or [
        (*row, 0.0) for row in _rows(topics, "camera_trigger", "seq")
    ]
    for time_s, number, is_feedback in triggers:
        if not is_feedback:  # the same topic tells of the camera's answer, too
            log.triggers.append(RawPhoto(int(number), time_s))


def _events(log: RawLog, topics: dict[str, Columns], source: ULog) -> None:
    for message in source.logged_messages:
        time_s = (int(message.timestamp) - int(source.start_timestamp)) / 1e6
        log.events.append(FlightEvent(time_s, "text", message.message.strip()))
    for time_s, state in _rows(topics, "vehicle_status", "nav_state"):
        log.mode(time_s, NAVIGATION_STATES.get(int(state), say("mode {:g}", state)))
    armed = [(t, value > 0) for t, value in _rows(topics, "actuator_armed", "armed")]
    states = [(t, value == ARMED_STATE) for t, value in _rows(topics, "vehicle_status", "arming_state")]
    for time_s, is_armed in armed or states:
        log.arm(time_s, is_armed)
