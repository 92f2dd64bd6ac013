"""What a vehicle's messages tell of its flight: one reader, for a flight that is watched and for its telemetry log.

So both become the same record. Times are the vehicle's own since boot where messages have them: a ground station's
clock jumps, and a simulation runs ahead of it. Only the autopilot's messages set that clock; cameras and gimbals that
are components of their own may count from when they were switched on.
"""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Callable
from typing import Any

from missions.flight.logs.raw import NOT_KNOWN, PhotoClock, RawLog, RawPhoto
from missions.flight.record import FlightEvent
from missions.mavlink import messages
from missions.mavlink.autopilots import Autopilot, facts, mode_name
from missions.mavlink.messages import Address, Message, Received
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor

REBOOT_S = 5.0
"""A time since boot that falls by more than this began again, and another clock is off by more than this."""

MAX_PAUSE_S = 86400.0

ARMED_FLAG = 128
"""MAV_MODE_FLAG_SAFETY_ARMED of HEARTBEAT's base_mode."""

GROUND_STATION, NO_AUTOPILOT = 6, 8
"""MAV_TYPE_GCS, MAV_AUTOPILOT_INVALID."""

MULTIROTORS = frozenset({2, 3, 4, 13, 14, 15, 29, 35})
"""MAV_TYPE of what flies ArduCopter: 4, 6, 8, 3, 10 and 12 rotors, two on one axis, helicopters."""

NO_LATITUDE = 2**31 - 1
FULL_TEXT = 50
"""Letters of a STATUSTEXT of which another part follows."""


class TelemetryReader:
    """Takes the messages of a link in their order; those of other vehicles are passed over.

    Parameters
    ----------
    vehicle
        Who flies, for the reader of the record.
    source
        The vehicle's autopilot; None: the first that is heard.

    Attributes
    ----------
    now_s
        Time of the last message by the vehicle's clock, None before it is known; what comes before is passed over.
    autopilot
        MAV_AUTOPILOT, as HEARTBEAT tells it; 0 before one came.
    """

    def __init__(self, vehicle: str = "", source: Address | None = None) -> None:
        self.now_s: float | None = None
        self.autopilot = 0
        self._log = RawLog(vehicle)
        self._source = source
        self._boot_s: float | None = None
        self._base_s = 0.0
        self._received_s = self._silent_s = 0.0
        self._is_own = self._is_camera_on_time = False
        self._photo_clock = PhotoClock()
        self._home_amsl_m: float | None = None
        self._captured: dict[tuple[int, int, int], RawPhoto] = {}
        self._fed_back: dict[tuple[int, int, int], RawPhoto] = {}
        self._chunks: dict[int, str] = {}
        self._handlers: dict[type[Message], Callable[..., None]] = {
            messages.Heartbeat: self._heartbeat,
            messages.SystemTime: self._system_time,
            messages.SysStatus: self._battery,
            messages.BatteryStatus: self._battery_status,
            messages.Attitude: self._attitude,
            messages.GlobalPositionInt: self._position,
            messages.MountStatus: self._mount_status,
            messages.MountOrientation: self._mount_orientation,
            messages.GimbalDeviceAttitudeStatus: self._gimbal,
            messages.Statustext: self._text,
            messages.CameraCaptureStatus: self._capture_status,
            messages.CameraFeedback: self._camera_feedback,
            messages.CameraImageCaptured: self._camera_image_captured,
        }

    @property
    def message_names(self) -> frozenset[type[Message]]:
        """Messages that tell something."""
        return frozenset(self._handlers)

    def take(self, received: Received) -> None:
        """Take a message."""
        message, source = received.message, received.source
        if isinstance(message, messages.Heartbeat):
            if message.type == GROUND_STATION or message.autopilot == NO_AUTOPILOT:
                return
            self._source = self._source or source
        handler = self._handlers.get(type(message))
        if handler is None or self._source is None or source.system != self._source.system:
            return
        self._is_own = source == self._source
        if self._is_own and not isinstance(message, messages.CameraImageCaptured):
            self._tell_time(getattr(message, "time_boot_ms", 0), received.time_s)
        self._silent_s = received.time_s - self._received_s
        if self.now_s is not None:
            handler(message, self.now_s)

    def note(self, code: str, text: str) -> None:
        """Add an event of the ground station, at the vehicle's time."""
        self._log.events.append(FlightEvent(self.now_s or 0.0, code, text))

    def read(self) -> RawLog:
        """Everything that was told so far; of two kinds of messages about photos, the one of which there are more."""
        photos = max(self._captured, self._fed_back, key=len)
        self._log.photos = list(photos.values())
        self._log.autopilot = next((each for each in Autopilot if facts(each).firmware_type == self.autopilot), None)
        return self._log

    def _tell_time(self, time_boot_ms: int, received_s: float) -> None:
        if time_boot_ms:
            boot_s = time_boot_ms / 1e3
            if self._boot_s is not None and boot_s < self._boot_s - REBOOT_S:
                self._base_s += self._boot_s + min(max(0.0, received_s - self._received_s), MAX_PAUSE_S) - boot_s
                self._photo_clock, self._is_camera_on_time = PhotoClock(), False
                self._log.events.append(
                    FlightEvent(self._base_s + boot_s, "reboot", say("the time since boot began again"))
                )
            self._boot_s, self._received_s = boot_s, received_s
            self.now_s = self._base_s + boot_s

    def _heartbeat(self, message: messages.Heartbeat, now_s: float) -> None:
        self.autopilot = message.autopilot
        self._log.arm(now_s, bool(message.base_mode & ARMED_FLAG))
        self._log.mode(now_s, _mode_name(message))

    def _system_time(self, message: messages.SystemTime, now_s: float) -> None:
        if self._is_own:
            self._photo_clock = self._photo_clock.after_system_time(message.time_unix_usec, now_s)

    def _battery(self, message: messages.SysStatus | messages.BatteryStatus, now_s: float) -> None:
        if 0 <= message.battery_remaining <= 100:
            self._log.battery.append((now_s, message.battery_remaining / 100.0))

    def _battery_status(self, message: messages.BatteryStatus, now_s: float) -> None:
        if message.id == 0:
            self._battery(message, now_s)

    def _attitude(self, message: messages.Attitude, now_s: float) -> None:
        self._log.headings.append((now_s, message.yaw))

    def _position(self, message: messages.GlobalPositionInt, now_s: float) -> None:
        place = message.lat / 1e7, message.lon / 1e7, message.alt / 1e3, message.relative_alt / 1e3
        self._home_amsl_m = (message.alt - message.relative_alt) / 1e3
        self._log.positions.append((now_s, *place))
        self._log.velocities.append((now_s, message.vx / 100.0, message.vy / 100.0, message.vz / 100.0))

    def _mount_status(self, message: messages.MountStatus, now_s: float) -> None:
        self._log.gimbal_pitches.append((now_s, math.radians(message.pointing_a / 100.0)))
        self._log.gimbal_yaws.append((now_s, math.radians(message.pointing_c / 100.0)))

    def _mount_orientation(self, message: messages.MountOrientation, now_s: float) -> None:
        self._log.gimbal_pitches.append((now_s, math.radians(message.pitch)))
        self._log.gimbal_headings.append((now_s, math.radians(message.yaw_absolute)))

    def _gimbal(self, message: messages.GimbalDeviceAttitudeStatus, now_s: float) -> None:
        self._log.gimbal(now_s, message.q, message.flags)

    def _text(self, message: messages.Statustext, now_s: float) -> None:
        text = message.text
        if message.id:
            text = self._chunks.pop(message.id, "") + text
            if len(message.text) == FULL_TEXT:
                self._chunks[message.id] = text
                return
        self._log.events.append(FlightEvent(now_s, "text", text))

    def _capture_status(self, message: messages.CameraCaptureStatus, now_s: float) -> None:
        if message.image_count >= 0:
            self._log.counted.append((now_s, message.image_count))

    def _camera_feedback(self, message: messages.CameraFeedback, now_s: float) -> None:
        """The angles in it are the vehicle's: they count for nothing."""
        self._photo_clock = self._photo_clock.after_photo(message.time_usec, now_s, self._silent_s)
        photo = RawPhoto(
            message.img_idx,
            self._photo_clock.taken_s(message.time_usec, now_s, self._silent_s),
            message.lat / 1e7,
            message.lng / 1e7,
            message.alt_msl,
            message.alt_rel,
            source="camera-feedback",
        )
        self._fed_back.setdefault((message.cam_idx, message.img_idx, message.time_usec), photo)

    def _camera_image_captured(self, message: messages.CameraImageCaptured, now_s: float) -> None:
        """Heights above home come from those above sea level: `relative_alt` counts from the ground below."""
        if message.capture_result != 1:
            self._log.camera_failed(now_s, message.image_index)
            return
        is_placed = NO_LATITUDE not in (abs(message.lat), abs(message.lon))
        amsl_m, home_amsl_m = message.alt / 1e3, self._home_amsl_m
        photo = RawPhoto(
            message.image_index,
            self._shutter_s(message.time_boot_ms, now_s),
            message.lat / 1e7 if is_placed else NOT_KNOWN,
            message.lon / 1e7 if is_placed else NOT_KNOWN,
            amsl_m,
            message.relative_alt / 1e3 if home_amsl_m is None else amsl_m - home_amsl_m,
            source="image-captured",
            file=message.file_url,
            q_wxyz=message.q,
        )
        self._captured.setdefault((message.camera_id, message.image_index, message.time_boot_ms), photo)

    def _shutter_s(self, time_boot_ms: int, now_s: float) -> float:
        """When a photo was taken; a report that was lost and asked for again comes late.

        The autopilot's own clock always counts, that of a camera once it has fitted.
        """
        shutter_s = self._base_s + time_boot_ms / 1e3
        self._is_camera_on_time = self._is_camera_on_time or abs(shutter_s - now_s) < REBOOT_S
        is_known = self._is_own or self._is_camera_on_time
        return shutter_s if is_known and self._base_s < shutter_s < now_s + REBOOT_S else now_s


def _mode_name(heartbeat: messages.Heartbeat) -> str:
    """Name of the flight mode, as the autopilots' own logs have it."""
    if heartbeat.autopilot == facts(Autopilot.PX4).firmware_type:
        return mode_name(Autopilot.PX4, heartbeat.custom_mode).removeprefix("AUTO.")
    if heartbeat.autopilot == facts(Autopilot.ARDUPILOT).firmware_type and heartbeat.type in MULTIROTORS:
        return mode_name(Autopilot.ARDUPILOT, heartbeat.custom_mode)
    from pymavlink import mavutil

    names = mavutil.mode_mapping_bynumber(heartbeat.type) or {}
    return str(names.get(heartbeat.custom_mode, say("mode {}", heartbeat.custom_mode)))


# Telemetry logs (.tlog): MAVLink frames, each after the time at which it was received.
#
# A record is eight bytes, big-endian microseconds since 1970, and one frame of MAVLink 1 or 2 (as Mission Planner,
# QGroundControl and MAVProxy write them). Frames are found by their own length and checksum; after damage the next good
# one is looked for. Only messages that tell something of the flight are decoded; `telemetry.py` reads them.

TIME_BYTES = 8
HEADER_BYTES = {0xFE: 6, 0xFD: 10}
"""Bytes before the payload in MAVLink 1 and 2, by the first of them."""

_RECORD = re.compile(rb"(?s)\x00[\x00-\x0e].{6}[\xfd\xfe]")
"""How a record begins: microseconds of the years 1970 to 2100 start with these two bytes."""

CHECKSUM_BYTES, SIGNATURE_BYTES, SIGNED = 2, 13, 0x01

VEHICLES = {3: "ArduPilot", 12: "PX4"}
"""MAV_AUTOPILOT."""


def looks_like_tlog(head: bytes) -> bool:
    """Whether a file begins with a time and a frame, possibly after some other bytes."""
    return any(_frame_bytes(head, at) > 0 for at in range(max(0, len(head) - TIME_BYTES - 12)))


def read_tlog(content: bytes, monitor: Monitor = QUIET) -> RawLog:
    """Everything a telemetry log says of one vehicle, the first that flies in it."""
    from pymavlink.dialects.v20 import ardupilotmega

    from missions.mavlink.wire import message_id, message_of

    decoder = ardupilotmega.MAVLink(None)
    reader = TelemetryReader()
    wanted = frozenset(map(message_id, reader.message_names))
    at = n_lost = 0
    while at + TIME_BYTES < len(content):
        size = _frame_bytes(content, at)
        packet = _decoded(decoder, content, at, size, wanted) if size else None
        if packet is None:
            following = _RECORD.search(content, at + 1)
            following_at = len(content) if following is None else following.start()
            at, n_lost = following_at, n_lost + following_at - at
            monitor.report(say("reading the log"), at, len(content))
            continue
        if packet is not _SKIPPED and (message := message_of(packet)) is not None:
            source = Address(packet.get_srcSystem(), packet.get_srcComponent())
            reader.take(Received(message, source, struct.unpack_from(">Q", content, at)[0] / 1e6))
        at += TIME_BYTES + size
        if at % 4096 < size:
            monitor.report(say("reading the log"), at, len(content))
    log = reader.read()
    log.vehicle = say("{}, telemetry log", VEHICLES.get(reader.autopilot, "MAVLink"))
    if n_lost:
        log.note("log-damaged", say("{} bytes of the log are no messages and were skipped", n_lost), n_lost)
    return log


_SKIPPED = object()


def _frame_bytes(content: bytes, at: int) -> int:
    """Size of the frame that follows a time, 0 where there is none."""
    start = at + TIME_BYTES
    if start + 8 > len(content) or _RECORD.match(content, at) is None:
        return 0
    signature = SIGNATURE_BYTES if content[start] == 0xFD and content[start + 2] & SIGNED else 0
    size = HEADER_BYTES[content[start]] + content[start + 1] + CHECKSUM_BYTES + signature
    return size if start + size <= len(content) else 0


def _decoded(decoder: Any, content: bytes, at: int, size: int, wanted: frozenset[int]) -> Any:
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
