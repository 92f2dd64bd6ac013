"""Telemetry logs (.tlog): MAVLink frames, each after the time at which it was received.

A record is eight bytes, big-endian microseconds since 1970, and one frame of MAVLink 1 or 2 (as Mission Planner,
QGroundControl and MAVProxy write them). Frames are found by their own length and checksum; after damage the next good
one is looked for. Only messages that are used here are decoded.

Times are the vehicle's own since boot where messages have them: a ground station's clock jumps, and a simulation runs
faster than it.
"""

from __future__ import annotations

import math
import re
import struct
from typing import Any

from missions.flight.logs.raw import NOT_KNOWN, RawLog, RawPhoto, camera_angles_rad
from missions.flight.record import FlightEvent
from planning.progress import QUIET, Monitor

TIME_BYTES = 8
HEADER_BYTES = {0xFE: 6, 0xFD: 10}
"""Bytes before the payload in MAVLink 1 and 2, by the first of them."""

_RECORD = re.compile(rb"(?s)\x00[\x00-\x0e].{6}[\xfd\xfe]")
"""How a record begins: microseconds of the years 1970 to 2100 start with these two bytes."""

CHECKSUM_BYTES, SIGNATURE_BYTES, SIGNED = 2, 13, 0x01

REBOOT_S = 5.0
"""A time since boot that falls by more than this began again."""

ARMED = 128
GROUND_STATION, NO_AUTOPILOT = 6, 8
"""MAV_MODE_FLAG_SAFETY_ARMED, MAV_TYPE_GCS, MAV_AUTOPILOT_INVALID."""

NO_LATITUDE = 2**31 - 1


def looks_like_tlog(head: bytes) -> bool:
    """Whether a file begins with a time and a frame, possibly after some other bytes."""
    return any(_frame_bytes(head, at) > 0 for at in range(max(0, len(head) - TIME_BYTES - 12)))


def read_tlog(content: bytes, monitor: Monitor = QUIET) -> RawLog:
    """Everything a telemetry log says of one vehicle, the first that flies in it."""
    from pymavlink.dialects.v20 import ardupilotmega

    decoder = ardupilotmega.MAVLink(None)
    reader = _Reader()
    at = n_lost = 0
    while at + TIME_BYTES < len(content):
        size = _frame_bytes(content, at)
        message = _decoded(decoder, content, at, size, reader.wanted) if size else None
        if message is None:
            following = _RECORD.search(content, at + 1)
            following_at = len(content) if following is None else following.start()
            at, n_lost = following_at, n_lost + following_at - at
            monitor.report("reading the log", at, len(content))
            continue
        if message is not _SKIPPED:
            reader.take(message, struct.unpack_from(">Q", content, at)[0] / 1e6)
        at += TIME_BYTES + size
        if at % 4096 < size:
            monitor.report("reading the log", at, len(content))
    if n_lost:
        reader.log.note("log-damaged", f"{n_lost} bytes of the log are no messages and were skipped", n_lost)
    return reader.finished()


_SKIPPED = object()


def _frame_bytes(content: bytes, at: int) -> int:
    """Size of the frame that follows a time, 0 where there is none."""
    start = at + TIME_BYTES
    if start + 8 > len(content) or _RECORD.match(content, at) is None:
        return 0
    signature = SIGNATURE_BYTES if content[start] == 0xFD and content[start + 2] & SIGNED else 0
    size = HEADER_BYTES[content[start]] + content[start + 1] + CHECKSUM_BYTES + signature
    return size if start + size <= len(content) else 0


def _decoded(decoder: Any, content: bytes, at: int, size: int, wanted: dict[int, Any]) -> Any:
    """The message of a frame; `_SKIPPED` for one that is not used, None for one that is damaged."""
    from pymavlink.dialects.v20.ardupilotmega import MAVError

    start = at + TIME_BYTES
    is_first = content[start] == 0xFE
    number = content[start + 5] if is_first else int.from_bytes(content[start + 7 : start + 10], "little")
    if number not in wanted:
        # Its checksum is not worth the time; but it must end where another record or the log does.
        end = start + size
        return (
            _SKIPPED if end == len(content) or _frame_bytes(content, end) or end + TIME_BYTES > len(content) else None
        )
    try:
        return decoder.decode(bytearray(content[start : start + size]))
    except (MAVError, struct.error, ValueError, IndexError):
        return None


class _Reader:
    """Takes messages in the order of the log."""

    def __init__(self) -> None:
        self.log = RawLog()
        self.system: int | None = None
        self.boot_s: float | None = None
        self.base_s = 0.0
        self.received_s = 0.0
        self.unix_less_boot_s: float | None = None
        self.captured: dict[tuple[int, int, int], RawPhoto] = {}
        self.fed_back: dict[tuple[int, int, int], RawPhoto] = {}
        self.chunks: dict[int, str] = {}
        self.wanted: dict[int, Any] = {
            0: self._heartbeat,
            1: self._sys_status,
            2: self._system_time,
            30: self._attitude,
            33: self._global_position_int,
            147: self._battery_status,
            158: self._mount_status,
            180: self._camera_feedback,
            253: self._statustext,
            263: self._camera_image_captured,
            265: self._mount_orientation,
            285: self._gimbal_device_attitude_status,
        }

    def take(self, message: Any, received_s: float) -> None:
        number, system = message.get_msgId(), message.get_srcSystem()
        if self.system is None and number == 0:
            self.system = None if _is_no_vehicle(message) else system
        if system != self.system or (number == 0 and _is_no_vehicle(message)):
            return
        if getattr(message, "time_boot_ms", 0):
            self._boot(message.time_boot_ms / 1e3, received_s)
        self.received_s = received_s
        if self.boot_s is not None:
            self.wanted[number](message, self.base_s + self.boot_s)

    def _boot(self, boot_s: float, received_s: float) -> None:
        if self.boot_s is not None and boot_s < self.boot_s - REBOOT_S:
            pause_s = min(max(0.0, received_s - self.received_s), 86400.0)
            self.base_s += self.boot_s + pause_s - boot_s
            self.unix_less_boot_s = None
            self.log.events.append(FlightEvent(self.base_s + boot_s, "reboot", "the time since boot began again"))
        self.boot_s = boot_s

    def _heartbeat(self, message: Any, time_s: float) -> None:
        from pymavlink import mavutil

        names = {3: "ArduPilot", 12: "PX4"}
        self.log.vehicle = f"{names.get(message.autopilot, 'MAVLink')}, telemetry log"
        self.log.arm(time_s, bool(message.base_mode & ARMED))
        self.log.mode(time_s, mavutil.mode_string_v10(message))

    def _system_time(self, message: Any, time_s: float) -> None:
        if message.time_unix_usec > 0:
            self.unix_less_boot_s = message.time_unix_usec / 1e6 - time_s

    def _sys_status(self, message: Any, time_s: float) -> None:
        if 0 <= message.battery_remaining <= 100:
            self.log.battery.append((time_s, message.battery_remaining / 100.0))

    def _battery_status(self, message: Any, time_s: float) -> None:
        if message.id == 0:
            self._sys_status(message, time_s)

    def _attitude(self, message: Any, time_s: float) -> None:
        self.log.headings.append((time_s, message.yaw))

    def _global_position_int(self, message: Any, time_s: float) -> None:
        place = message.lat / 1e7, message.lon / 1e7, message.alt / 1e3, message.relative_alt / 1e3
        self.log.positions.append((time_s, *place))
        self.log.velocities.append((time_s, message.vx / 100.0, message.vy / 100.0, message.vz / 100.0))

    def _mount_status(self, message: Any, time_s: float) -> None:
        self.log.gimbal_pitches.append((time_s, math.radians(message.pointing_a / 100.0)))
        self.log.gimbal_yaws.append((time_s, math.radians(message.pointing_c / 100.0)))

    def _mount_orientation(self, message: Any, time_s: float) -> None:
        self.log.gimbal_pitches.append((time_s, math.radians(message.pitch)))
        self.log.gimbal_headings.append((time_s, math.radians(message.yaw_absolute)))

    def _gimbal_device_attitude_status(self, message: Any, time_s: float) -> None:
        self.log.gimbal(time_s, message.q, message.flags)

    def _statustext(self, message: Any, time_s: float) -> None:
        text, number = message.text, getattr(message, "id", 0)
        if number:
            text = self.chunks.pop(number, "") + text
            if len(message.text) == 50:  # full: another part follows
                self.chunks[number] = text
                return
        self.log.events.append(FlightEvent(time_s, "text", text))

    def _shutter_s(self, unix_s: float, time_s: float) -> float:
        """When a photo was taken: by the camera's UNIX time where it fits, or else when the message came."""
        if self.unix_less_boot_s is not None and abs(unix_s - self.unix_less_boot_s - time_s) < REBOOT_S:
            return unix_s - self.unix_less_boot_s
        return time_s

    def _camera_feedback(self, message: Any, time_s: float) -> None:
        photo = RawPhoto(
            message.img_idx,
            self._shutter_s(message.time_usec / 1e6, time_s),
            message.lat / 1e7,
            message.lng / 1e7,
            message.alt_msl,
            message.alt_rel,
            source="camera-feedback",
        )
        self.fed_back.setdefault((message.cam_idx, message.img_idx, message.time_usec), photo)

    def _camera_image_captured(self, message: Any, time_s: float) -> None:
        if message.capture_result != 1:
            self.log.camera_failed(time_s, message.image_index)
            return
        angles = camera_angles_rad(*message.q)
        is_placed = NO_LATITUDE not in (abs(message.lat), abs(message.lon))
        photo = RawPhoto(
            message.image_index,
            time_s,
            message.lat / 1e7 if is_placed else NOT_KNOWN,
            message.lon / 1e7 if is_placed else NOT_KNOWN,
            message.alt / 1e3,
            message.relative_alt / 1e3,
            None if angles is None else math.degrees(angles[0]),
            None if angles is None else math.degrees(angles[1]),
            "image-captured",
            message.file_url,
        )
        self.captured.setdefault((message.camera_id, message.image_index, message.time_boot_ms), photo)

    def finished(self) -> RawLog:
        """The log; of two messages about each photo, those of which there are more."""
        photos = max(self.captured, self.fed_back, key=len)
        self.log.photos = list(photos.values())
        return self.log


def _is_no_vehicle(heartbeat: Any) -> bool:
    return bool(heartbeat.type == GROUND_STATION or heartbeat.autopilot == NO_AUTOPILOT)
