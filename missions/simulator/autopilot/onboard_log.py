"""The autopilot's own log of a flight, as it lies on its card: ArduPilot's dataflash (.BIN), PX4's ULog (.ulg).

From arming until the motors stop, five times a second what the autopilot believes, and every photo, mode and text. It
is kept as it was sampled, and becomes bytes when somebody asks for the file: nobody does after most flights.

Records as ArduPilot's AP_Logger/LogStructure.h and PX4's message definitions have them, those that tell of a flight.
"""

from __future__ import annotations

import math
import struct
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from missions.mavlink.autopilots import Autopilot, mode_numbers
from missions.simulator.airframe.state import Pose
from missions.simulator.autopilot.guidance import DEG, Place, WirePlace
from missions.simulator.autopilot.instruments import camera_quaternion
from planning.geo.frames import Vec3

SAMPLE_S = 0.2

AFTER_S = 1.0
"""A log goes on so long after the motors stopped."""

UNIX_WEEK_S, GPS_EPOCH_UNIX_S, LEAP_S = 604_800, 315_964_800, 18
"""GPS time: weeks since 6 January 1980; 18 leap seconds ahead of UTC since 2017."""


@dataclass(frozen=True, slots=True)
class Sample:
    """What the autopilot believes at one time."""

    time_s: float
    pose: Pose
    battery: float
    is_armed: bool


@dataclass(frozen=True, slots=True)
class Event:
    """A photo (its number), a mode (its name) or a text."""

    time_s: float
    kind: str
    text: str = ""
    number: int = 0
    pose: Pose | None = None


@dataclass(slots=True)
class Flight:
    """One log in the making."""

    home_enu_m: Vec3
    samples: list[Sample] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)


@dataclass(slots=True)
class OnboardLog:
    """Logs of all flights since power-up.

    Parameters
    ----------
    unix_start_s
        UNIX time of power-up, for the names of PX4's logs and the times of photos.
    """

    autopilot: Autopilot
    place: Place
    unix_start_s: float
    flights: list[Flight] = field(default_factory=list)
    _is_open: bool = False
    _next_s: float = 0.0
    _stopped_s: float = math.inf
    _mode: str = ""
    _encoded: dict[str, tuple[int, bytes]] = field(default_factory=dict)

    def update(self, now_s: float, is_armed: bool, mode: str, state: Callable[[], tuple[Pose, float]]) -> None:
        """Note what is so now; `state` gives pose of the estimate, camera turned, and the battery's charge."""
        if is_armed and not self._is_open:
            self._is_open, self._next_s, self._mode = True, now_s, ""
            self.flights.append(Flight(self.place.home_enu_m))
        if not self._is_open:
            return
        self._stopped_s = math.inf if is_armed else min(self._stopped_s, now_s)
        if mode != self._mode:
            self._mode = mode
            self.note(Event(now_s, "mode", mode))
        flight = self.flights[-1]
        is_turned = bool(flight.samples) and flight.samples[-1].is_armed is not is_armed
        if now_s >= self._next_s or is_turned:
            self._next_s = now_s + SAMPLE_S
            pose, battery = state()
            flight.samples.append(Sample(now_s, pose, battery, is_armed))
        if now_s > self._stopped_s + AFTER_S:
            self._is_open, self._stopped_s = False, math.inf

    def note(self, event: Event) -> None:
        """Something happened; without a log it is not kept."""
        if self._is_open:
            self.flights[-1].events.append(event)

    def files(self) -> dict[str, bytes]:
        """All logs by their path on the card; one that is still written has what was written so far."""
        found = {}
        for number, flight in enumerate(self.flights, 1):
            path = self._path(number, flight)
            size = len(flight.samples) + len(flight.events)
            if self._encoded.get(path, (-1, b""))[0] != size:
                encode = dataflash if self.autopilot is Autopilot.ARDUPILOT else ulog
                self._encoded[path] = (size, encode(flight, self.place, self.unix_start_s))
            found[path] = self._encoded[path][1]
        return found

    def _path(self, number: int, flight: Flight) -> str:
        if self.autopilot is Autopilot.ARDUPILOT:
            return f"/APM/LOGS/{number:08d}.BIN"
        began = time.gmtime(self.unix_start_s + flight.samples[0].time_s if flight.samples else self.unix_start_s)
        return time.strftime("/fs/microsd/log/%Y-%m-%d/%H_%M_%S.ulg", began)


def _in_order(flight: Flight) -> Iterator[Sample | Event]:
    together: list[Sample | Event] = [*flight.samples, *flight.events]
    return iter(sorted(together, key=lambda each: each.time_s))


# ArduPilot

_LETTERS = {
    "B": "B", "H": "H", "I": "I", "Q": "Q", "f": "f", "c": "h", "C": "H", "e": "i", "L": "i", "M": "B", "Z": "64s",
    "N": "16s", "n": "4s",
}  # fmt: skip
_SCALES = {"c": 100.0, "C": 100.0, "e": 100.0}
_DATAFLASH = {
    "MSG": (33, "QZ", "TimeUS,Message"),
    "MODE": (34, "QMBB", "TimeUS,Mode,ModeNum,Rsn"),
    "ARM": (35, "QBIBB", "TimeUS,ArmState,ArmChecks,Forced,Method"),
    "POS": (36, "QLLfff", "TimeUS,Lat,Lng,Alt,RelHomeAlt,RelOriginAlt"),
    "ATT": (37, "QccccCC", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw"),
    "XKF1": (38, "QBccCfff", "TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD"),
    "MNT": (39, "QBffffff", "TimeUS,I,DesPitch,Pitch,DesYawB,YawB,DesYawE,YawE"),
    "BAT": (40, "QBffffB", "TimeUS,Inst,Volt,Curr,CurrTot,EnrgTot,RemPct"),
    "CAM": (41, "QBHIHLLeeeccC", "TimeUS,I,Img,GPSTime,GPSWeek,Lat,Lng,Alt,RelAlt,GPSAlt,R,P,Y"),
}
_HEADER = b"\xa3\x95"


def _layout(letters: str) -> str:
    return "<" + "".join(_LETTERS[letter] for letter in letters)


def _record(name: str, *values: float | bytes) -> bytes:
    kind, letters, _ = _DATAFLASH[name]
    raw = [
        value if isinstance(value, bytes) else value if letter == "f" else round(value * _SCALES.get(letter, 1.0))
        for value, letter in zip(values, letters, strict=True)
    ]
    return _HEADER + bytes([kind]) + struct.pack(_layout(letters), *raw)


def _formats() -> bytes:
    rows = [("FMT", 128, 89, "BBnNZ", "Type,Length,Name,Format,Columns")]
    rows += [
        (name, kind, 3 + struct.calcsize(_layout(letters)), letters, labels)
        for name, (kind, letters, labels) in _DATAFLASH.items()
    ]
    return b"".join(
        _HEADER + b"\x80" + struct.pack("<BB4s16s64s", kind, size, name.encode(), letters.encode(), labels.encode())
        for name, kind, size, letters, labels in rows
    )


def dataflash(flight: Flight, place: Place, unix_start_s: float) -> bytes:
    """ArduPilot's log of a flight."""
    out = bytearray(_formats())
    numbers = mode_numbers(Autopilot.ARDUPILOT)
    was_armed = False
    begun_us = round(1e6 * flight.samples[0].time_s) if flight.samples else 0
    out += _record("MSG", begun_us, b"ArduCopter V4.5.6")
    for each in _in_order(flight):
        us = round(1e6 * each.time_s)
        if isinstance(each, Sample):
            if each.is_armed is not was_armed:
                was_armed = each.is_armed
                out += _record("ARM", us, was_armed, 1, 0, 4)
            out += _sampled(us, each, place.wire_place(each.pose.position_enu_m))
        elif each.kind == "mode":
            number = numbers.get(each.text, 0)
            out += _record("MODE", us, number, number, 0)
        elif each.kind == "text":
            out += _record("MSG", us, each.text.encode()[:64])
        elif each.pose is not None:
            out += _photo(us, each, each.pose, place.wire_place(each.pose.position_enu_m), unix_start_s)
    return bytes(out)


def _sampled(us: int, sample: Sample, here: WirePlace) -> bytes:
    pose = sample.pose
    roll, pitch, yaw = pose.roll_rad / DEG, pose.pitch_rad / DEG, pose.heading_rad / DEG % 360.0
    tilt, pan = pose.gimbal_pitch_rad / DEG, _turn_deg(pose)
    east, north, up = pose.velocity_enu_m_s
    above = here.above_home_m
    return b"".join(
        (
            _record("POS", us, here.lat_e7, here.lon_e7, here.altitude_amsl_m, above, above),
            _record("ATT", us, roll, roll, pitch, pitch, yaw, yaw),
            _record("XKF1", us, 0, roll, pitch, yaw, north, east, -up),
            _record("MNT", us, 0, tilt, tilt, pan, pan, *(2 * (pose.gimbal_heading_rad / DEG,))),
            _record("BAT", us, 0, 15.0, 10.0, 0.0, 0.0, 100.0 * max(0.0, min(1.0, sample.battery))),
        )
    )


def _turn_deg(pose: Pose) -> float:
    """Yaw of the camera against the nose, in (-180, 180]."""
    return math.remainder(pose.gimbal_heading_rad - pose.heading_rad, 2.0 * math.pi) / DEG


def _photo(us: int, event: Event, pose: Pose, here: WirePlace, unix_start_s: float) -> bytes:
    gps_s = unix_start_s + event.time_s - GPS_EPOCH_UNIX_S + LEAP_S
    week, in_week_s = divmod(gps_s, UNIX_WEEK_S)
    amsl, above = here.altitude_amsl_m, here.above_home_m
    angles = pose.roll_rad / DEG, pose.pitch_rad / DEG, pose.heading_rad / DEG % 360.0
    return _record(
        "CAM", us, 0, event.number, round(1e3 * in_week_s), week, here.lat_e7, here.lon_e7, amsl, above, amsl, *angles
    )


# PX4

_ULOG = {
    "vehicle_global_position": "uint64_t timestamp;double lat;double lon;float alt;",
    "vehicle_local_position": "uint64_t timestamp;float vx;float vy;float vz;",
    "vehicle_attitude": "uint64_t timestamp;float[4] q;",
    "gimbal_device_attitude_status": "uint64_t timestamp;float[4] q;uint16_t device_flags;",
    "battery_status": "uint64_t timestamp;float remaining;",
    "home_position": "uint64_t timestamp;float alt;",
    "actuator_armed": "uint64_t timestamp;bool armed;",
    "vehicle_status": "uint64_t timestamp;uint8_t nav_state;",
    "camera_capture": "uint64_t timestamp;double lat;double lon;float alt;float[4] q;uint32_t seq;int8_t result;",
}
_ULOG_IDS = {name: number for number, name in enumerate(_ULOG)}
_NAVIGATION = {"AUTO.MISSION": 3, "AUTO.LOITER": 4, "AUTO.RTL": 5, "AUTO.TAKEOFF": 17, "AUTO.LAND": 18, "POSCTL": 2}
"""vehicle_status.nav_state of modes."""

FROM_NORTH = 64
"""GIMBAL_DEVICE_FLAGS_YAW_IN_EARTH_FRAME."""

INFO_LEVEL = b"6"


def _message(kind: str, body: bytes) -> bytes:
    return struct.pack("<HB", len(body), ord(kind)) + body


def _data(name: str, us: int, layout: str, *values: float) -> bytes:
    return _message("D", struct.pack("<HQ" + layout, _ULOG_IDS[name], us, *values))


def ulog(flight: Flight, place: Place, _unix_start_s: float) -> bytes:
    """PX4's log of a flight."""
    start_us = round(1e6 * flight.samples[0].time_s) if flight.samples else 0
    out = bytearray(b"ULog\x01\x12\x35\x01" + struct.pack("<Q", start_us))
    out += _message("B", bytes(40))
    for name, fields in _ULOG.items():
        out += _message("F", f"{name}:{fields}".encode())
    for name, number in _ULOG_IDS.items():
        out += _message("A", struct.pack("<BH", 0, number) + name.encode())
    out += _data("home_position", start_us, "f", place.wire_place(flight.home_enu_m).altitude_amsl_m)
    was_armed = False
    for each in _in_order(flight):
        us = round(1e6 * each.time_s)
        if isinstance(each, Sample):
            if each.is_armed is not was_armed:
                was_armed = each.is_armed
                out += _data("actuator_armed", us, "?", was_armed)
            out += _topics(us, each, place.wire_place(each.pose.position_enu_m))
        elif each.kind == "mode":
            out += _data("vehicle_status", us, "B", _NAVIGATION.get(each.text, 0))
        elif each.kind == "text":
            out += _message("L", INFO_LEVEL + struct.pack("<Q", us) + each.text.encode())
        elif each.pose is not None:
            here = place.wire_place(each.pose.position_enu_m)
            where = here.lat_e7 * 1e-7, here.lon_e7 * 1e-7, here.altitude_amsl_m
            # Counted from 0, as in its messages.
            out += _data("camera_capture", us, "ddfffffIb", *where, *_camera(each.pose), each.number - 1, 1)
    return bytes(out)


def _topics(us: int, sample: Sample, here: WirePlace) -> bytes:
    pose = sample.pose
    east, north, up = pose.velocity_enu_m_s
    half = 0.5 * pose.heading_rad
    return b"".join(
        (
            _data("vehicle_global_position", us, "ddf", here.lat_e7 * 1e-7, here.lon_e7 * 1e-7, here.altitude_amsl_m),
            _data("vehicle_local_position", us, "fff", north, east, -up),
            _data("vehicle_attitude", us, "ffff", math.cos(half), 0.0, 0.0, math.sin(half)),
            _data("gimbal_device_attitude_status", us, "ffffH", *_camera(pose), FROM_NORTH),
            _data("battery_status", us, "f", max(0.0, min(1.0, sample.battery))),
        )
    )


def _camera(pose: Pose) -> tuple[float, float, float, float]:
    return camera_quaternion(pose.gimbal_heading_rad, pose.gimbal_pitch_rad)
