"""Flight records written as logs of autopilots and ground stations, byte by byte from the formats' descriptions."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from missions.flight.record import FlightRecord
from planning.geo.enu import geodetic_from_enu
from planning.geo.geoid import amsl_from_ellipsoid_m
from planning.site.records import Airspace, Facade, Panel, Site
from tests.missions.plans import HOME, HONG_KONG

BOOT_S = 12.5
"""Time since boot when a log starts."""

UNIX_S = 1_790_000_000.0

GROUND_S = 5.0
"""Motors off before and after each flight."""


def log_site() -> Site:
    """The site of the example plan."""
    panel = Panel("p", ((0.0, 0.0, 20.0), (1.0, 0.0, 20.0), (1.0, 0.0, 21.0), (0.0, 0.0, 21.0)))
    airspace = Airspace((-200.0, -200.0, 0.0), (200.0, 200.0, 120.0), 0.0)
    return Site("office", HONG_KONG, (Facade("A", (panel,)),), airspace, HOME)


@dataclass(frozen=True)
class Moment:
    """What a log says of one time; `photo` is the photo's number where one was taken then."""

    time_s: float
    armed: bool
    lat_deg: float
    lon_deg: float
    amsl_m: float
    above_home_m: float
    velocity_ned: tuple[float, float, float]
    heading_rad: float
    gimbal_pitch_rad: float
    battery: float
    photo: int | None


def moments(records: Sequence[FlightRecord], site: Site) -> Iterator[Moment]:
    """Flights one after the other, each armed at its start and disarmed at its end, times since boot."""
    home_m = float(geodetic_from_enu(site.origin, [site.home_enu_m]).ellipsoid_height_m[0])
    start_s = BOOT_S
    for record in records:
        track = record.track
        photo_at = {photo.time_s: photo.index for photo in record.photos}
        ends = [(start_s + 0.5 * k, False, 0) for k in range(int(2 * GROUND_S))] + [
            (start_s + GROUND_S + float(t), True, i) for i, t in enumerate(track.time_s)
        ]
        last_s = ends[-1][0]
        ends += [(last_s + 0.5 * k, False, len(track.time_s) - 1) for k in range(1, int(2 * GROUND_S))]
        start_s = last_s + GROUND_S
        lat, lon, height_m = geodetic_from_enu(site.origin, track.position_enu_m)
        amsl_m = amsl_from_ellipsoid_m(lat, lon, height_m)
        for time_s, armed, i in ends:
            east, north, up = track.velocity_enu_m_s[i]
            yield Moment(
                time_s,
                armed,
                float(lat[i]),
                float(lon[i]),
                float(amsl_m[i]),
                float(height_m[i]) - home_m,
                (float(north), float(east), -float(up)),
                float(track.heading_rad[i]),
                float(track.gimbal_pitch_rad[i]),
                float(track.battery[i]),
                photo_at.get(float(track.time_s[i])) if armed else None,
            )


def tlog(records: Sequence[FlightRecord], site: Site, *, captured: bool = False, speedup: float = 1.0) -> bytes:
    """A telemetry log; photos as CAMERA_FEEDBACK, or CAMERA_IMAGE_CAPTURED. `speedup`: of the simulation's clock."""
    from pymavlink.dialects.v20 import ardupilotmega as mavlink

    sender = mavlink.MAVLink(None, 1, 1)
    station = mavlink.MAVLink(None, 255, 190)
    out = bytearray()

    def put(moment: Moment, message: Any, source: Any = sender) -> None:
        received_us = int((UNIX_S + moment.time_s / speedup) * 1e6)
        out.extend(struct.pack(">Q", received_us) + message.pack(source))

    for number, moment in enumerate(moments(records, site)):
        boot_ms = round(moment.time_s * 1e3)
        lat, lon = round(moment.lat_deg * 1e7), round(moment.lon_deg * 1e7)
        if number % 5 == 0:
            put(moment, mavlink.MAVLink_heartbeat_message(6, 8, 192, 0, 4, 3), station)
            put(moment, mavlink.MAVLink_heartbeat_message(2, 3, 129 if moment.armed else 1, 3, 4, 3))
            put(moment, mavlink.MAVLink_system_time_message(int((UNIX_S + moment.time_s) * 1e6), boot_ms))
            percent = round(moment.battery * 100)
            put(moment, mavlink.MAVLink_sys_status_message(0, 0, 0, 0, 12000, -1, percent, 0, 0, 0, 0, 0, 0))
        cm_s = [round(v * 100) for v in moment.velocity_ned]
        put(
            moment,
            mavlink.MAVLink_global_position_int_message(
                boot_ms, lat, lon, round(moment.amsl_m * 1e3), round(moment.above_home_m * 1e3), *cm_s, 0
            ),
        )
        put(moment, mavlink.MAVLink_attitude_message(boot_ms, 0.0, 0.0, moment.heading_rad, 0.0, 0.0, 0.0))
        # A gimbal without pan: yaw 0 in the vehicle's frame.
        q = [math.cos(moment.gimbal_pitch_rad / 2), 0.0, math.sin(moment.gimbal_pitch_rad / 2), 0.0]
        put(
            moment,
            mavlink.MAVLink_gimbal_device_attitude_status_message(0, 0, boot_ms, 44, q, 0.0, 0.0, 0.0, 0),
        )
        if moment.photo is None:
            continue
        if captured:
            cos_h, sin_h = math.cos(moment.heading_rad / 2), math.sin(moment.heading_rad / 2)
            q_camera = [q[0] * cos_h, -q[2] * sin_h, q[2] * cos_h, q[0] * sin_h]
            heights = round(moment.amsl_m * 1e3), round(moment.above_home_m * 1e3)
            message = mavlink.MAVLink_camera_image_captured_message(
                boot_ms, 0, 1, lat, lon, *heights, q_camera, moment.photo, 1, b"mftp://DCIM/1.jpg"
            )
            put(moment, message)
            put(moment, message)  # cameras repeat it until somebody asks no more
        else:
            put(
                moment,
                mavlink.MAVLink_camera_feedback_message(
                    int((UNIX_S + moment.time_s) * 1e6), 0, 0, moment.photo, lat, lon, moment.amsl_m,
                    moment.above_home_m, 0.0, 0.0, math.degrees(moment.heading_rad), 0.0, 0,
                ),
            )  # fmt: skip
    return bytes(out)


DATAFLASH = {
    "POS": (10, "QLLfff", "TimeUS,Lat,Lng,Alt,RelHomeAlt,RelOriginAlt"),
    "ATT": (11, "QccccCCCC", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw,ErrRP,ErrYaw"),
    "XKF1": (12, "QBccCfff", "TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD"),
    "MNT": (13, "QBfffffffff", "TimeUS,I,DesR,R,DesPitch,Pitch,DesYawB,YawB,DesYawE,YawE,Dst"),
    "BAT": (14, "QBfffB", "TimeUS,Inst,Volt,Curr,CurrTot,RemPct"),
    "CAM": (15, "QBIHLLeeeccC", "TimeUS,I,GPSTime,GPSWeek,Lat,Lng,Alt,RelAlt,GPSAlt,R,P,Y"),
    "EV": (16, "QB", "TimeUS,Id"),
    "MODE": (17, "QMBB", "TimeUS,Mode,ModeNum,Rsn"),
    "MSG": (18, "QZ", "TimeUS,Message"),
}  # fmt: skip
LETTERS = {
    "Q": "Q", "L": "i", "f": "f", "c": "h", "C": "H", "B": "B", "I": "I", "H": "H", "e": "i", "M": "B", "Z": "64s",
}  # fmt: skip
SCALES = {"L": 1e7, "c": 100.0, "C": 100.0, "e": 100.0}


def dataflash_record(name: str, *values: Any) -> bytes:
    """One record of a binary ArduPilot log."""
    kind, letters, _ = DATAFLASH[name]
    raw = [round(v * SCALES[x]) if x in SCALES else v for v, x in zip(values, letters, strict=True)]
    return bytes([0xA3, 0x95, kind]) + struct.pack("<" + "".join(LETTERS[x] for x in letters), *raw)


def dataflash_formats() -> bytes:
    """The records that say what the others hold."""
    out = b""
    own = ("FMT", 128, 89, "BBnNZ", "Type,Length,Name,Format,Columns")
    rows = [own]
    for name, (kind, letters, labels) in DATAFLASH.items():
        rows.append((name, kind, 3 + struct.calcsize("<" + "".join(LETTERS[x] for x in letters)), letters, labels))
    for name, kind, length, letters, labels in rows:
        fields = name.encode(), letters.encode(), labels.encode()
        out += bytes([0xA3, 0x95, 128]) + struct.pack("<BB4s16s64s", kind, length, *fields)
    return out


def dataflash(records: Sequence[FlightRecord], site: Site) -> bytes:
    """A binary ArduPilot log."""
    out = bytearray(dataflash_formats())
    out += dataflash_record("MSG", int(BOOT_S * 1e6), b"ArduCopter V4.5.6")
    out += dataflash_record("MODE", int(BOOT_S * 1e6), 3, 3, 0)
    armed = False
    for m in moments(records, site):
        us = round(m.time_s * 1e6)
        if m.armed != armed:
            armed = m.armed
            out += dataflash_record("EV", us, 10 if armed else 11)
        heading_deg = math.degrees(m.heading_rad) % 360.0
        out += dataflash_record("POS", us, m.lat_deg, m.lon_deg, m.amsl_m, m.above_home_m, m.above_home_m)
        out += dataflash_record("ATT", us, 0, 0, 0, 0, heading_deg, heading_deg, 0, 0)
        for core in (0, 1):
            out += dataflash_record("XKF1", us, core, 0, 0, heading_deg, *(v + core for v in m.velocity_ned))
        pitch_deg = math.degrees(m.gimbal_pitch_rad)
        out += dataflash_record("MNT", us, 0, 0, 0, pitch_deg, pitch_deg, 0, 0, math.nan, math.nan, math.nan)
        out += dataflash_record("BAT", us, 0, 12.0, 9.0, 100.0, round(m.battery * 100))
        if m.photo is not None:
            heights = m.amsl_m, m.above_home_m, m.amsl_m
            out += dataflash_record("CAM", us, 0, 1000, 2000, m.lat_deg, m.lon_deg, *heights, 0, 0, heading_deg)
    return bytes(out)


def dataflash_text(records: Sequence[FlightRecord], site: Site) -> bytes:
    """The same as lines of text, with the fields that matter."""
    lines = ["FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns"]
    for name, letters, labels in (
        ("POS", "QLLff", "TimeUS,Lat,Lng,Alt,RelHomeAlt"),
        ("ATT", "Qc", "TimeUS,Yaw"),
        ("CAM", "QLLff", "TimeUS,Lat,Lng,Alt,RelAlt"),
        ("EV", "QB", "TimeUS,Id"),
        ("MODE", "QM", "TimeUS,Mode"),
    ):
        lines.append(f"FMT, {len(lines)}, 40, {name}, {letters}, {labels}")
    lines.append(f"MODE, {int(BOOT_S * 1e6)}, AUTO")
    armed = False
    for m in moments(records, site):
        us = round(m.time_s * 1e6)
        if m.armed != armed:
            armed = m.armed
            lines.append(f"EV, {us}, {10 if armed else 11}")
        place = f"{us}, {m.lat_deg:.7f}, {m.lon_deg:.7f}, {m.amsl_m:.3f}, {m.above_home_m:.3f}"
        lines.append(f"POS, {place}")
        lines.append(f"ATT, {us}, {math.degrees(m.heading_rad) % 360.0:.2f}")
        if m.photo is not None:
            lines.append(f"CAM, {place}")
    return "\r\n".join(lines).encode()


ULOG = {
    "vehicle_global_position": "uint64_t timestamp;double lat;double lon;float alt;",
    "vehicle_local_position": "uint64_t timestamp;float vx;float vy;float vz;",
    "vehicle_attitude": "uint64_t timestamp;float[4] q;",
    "gimbal_device_attitude_status": "uint64_t timestamp;float[4] q;uint16_t device_flags;",
    "battery_status": "uint64_t timestamp;float remaining;",
    "home_position": "uint64_t timestamp;float alt;",
    "actuator_armed": "uint64_t timestamp;bool armed;",
    "vehicle_status": "uint64_t timestamp;uint8_t nav_state;",
    "camera_capture": "uint64_t timestamp;double lat;double lon;float alt;float[4] q;uint32_t seq;int8_t result;",
    "camera_trigger": "uint64_t timestamp;uint32_t seq;bool feedback;",
}


def ulog_message(kind: str, body: bytes) -> bytes:
    """One message of a ULog."""
    return struct.pack("<HB", len(body), ord(kind)) + body


def ulog(records: Sequence[FlightRecord], site: Site, *, triggers_only: bool = False) -> bytes:
    """A PX4 log."""
    start_us = int(BOOT_S * 1e6)
    out = bytearray(b"ULog\x01\x12\x35\x01" + struct.pack("<Q", start_us))
    out += ulog_message("B", bytes(40))
    for name, fields in ULOG.items():
        out += ulog_message("F", f"{name}:{fields}".encode())
    ids = {name: i for i, name in enumerate(ULOG)}
    for name, i in ids.items():
        out += ulog_message("A", struct.pack("<BH", 0, i) + name.encode())

    def put(name: str, us: int, layout: str, *values: Any) -> None:
        out.extend(ulog_message("D", struct.pack("<HQ" + layout, ids[name], us, *values)))

    home_m = float(geodetic_from_enu(site.origin, [site.home_enu_m]).ellipsoid_height_m[0])
    home_amsl_m = float(amsl_from_ellipsoid_m(site.origin.lat_deg, site.origin.lon_deg, home_m))
    put("home_position", start_us, "f", home_amsl_m)
    put("vehicle_status", start_us, "B", 3)
    out += ulog_message("L", struct.pack("<BQ", ord("6"), start_us) + b"[commander] Takeoff detected")
    for m in moments(records, site):
        us = round(m.time_s * 1e6)
        h, p = m.heading_rad / 2.0, m.gimbal_pitch_rad / 2.0
        put("actuator_armed", us, "?", m.armed)
        put("vehicle_global_position", us, "ddf", m.lat_deg, m.lon_deg, m.amsl_m)
        put("vehicle_local_position", us, "fff", *m.velocity_ned)
        put("vehicle_attitude", us, "ffff", math.cos(h), 0.0, 0.0, math.sin(h))
        put("gimbal_device_attitude_status", us, "ffffH", math.cos(p), 0.0, math.sin(p), 0.0, 44)
        put("battery_status", us, "f", m.battery)
        if m.photo is not None:
            put("camera_trigger", us, "I?", m.photo, False)
            if not triggers_only:
                nan4 = (math.nan,) * 4
                put("camera_capture", us + 100, "ddfffffIb", m.lat_deg, m.lon_deg, m.amsl_m, *nan4, m.photo, 1)
    return bytes(out)


def damaged(content: bytes, rng: np.random.Generator) -> bytes:
    """A log with bytes changed, a piece cut out, repeated or cut off."""
    data = bytearray(content)
    how = rng.integers(0, 5)
    start, stop = sorted(int(i) for i in rng.integers(0, len(data), 2))
    stop = min(stop, start + 4096)
    if how == 0:
        for place in rng.integers(0, len(data), rng.integers(1, 200)):
            data[place] = int(rng.integers(0, 256))
    elif how == 1:
        del data[start:stop]
    elif how == 2:
        data[start:start] = data[start:stop]
    elif how == 3:
        del data[start:]
    else:
        data[start:stop] = rng.bytes(stop - start)
    return bytes(data)
