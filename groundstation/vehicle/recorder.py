"""What a flight leaves behind: every message that matters, gathered as a log reader gathers them from a file.

So a flight that was watched and one whose telemetry log is read afterwards become the same record.
"""

from __future__ import annotations

import math

from groundstation.vehicle.modes import mode_name
from groundstation.vehicle.telemetry import ARMED_FLAG
from missions.flight.logs.flights import flights_of
from missions.flight.logs.raw import RawLog, RawPhoto
from missions.flight.record import FlightEvent, FlightRecord
from missions.mavlink import messages
from missions.mavlink.autopilots import Autopilot
from planning.errors import InputError
from planning.site import Site

PHOTO_KINDS = {messages.CameraFeedback: "camera-feedback", messages.CameraImageCaptured: "image-captured"}


class Recorder:
    """Gathers the messages of one vehicle.

    Times are the vehicle's own since it was switched on: in a simulation they run ahead of the receiver's.
    """

    def __init__(self, vehicle: str, autopilot: Autopilot) -> None:
        self._autopilot = autopilot
        self.log = RawLog(vehicle)
        self.now_s: float | None = None
        self._seen: set[tuple[str, int, int]] = set()

    def note(self, code: str, text: str) -> None:
        """Add an event of the ground station, at the vehicle's time."""
        self.log.events.append(FlightEvent(self.now_s or 0.0, code, text))

    def take(self, message: messages.Message) -> None:
        """Take a message of the vehicle; what comes before its first time stamp is passed over."""
        boot_ms = getattr(message, "time_boot_ms", 0)
        if boot_ms:
            self.now_s = boot_ms / 1000.0
        if self.now_s is None:
            return
        log, now_s = self.log, self.now_s
        match message:
            case messages.GlobalPositionInt():
                place = message.lat * 1e-7, message.lon * 1e-7, message.alt / 1e3, message.relative_alt / 1e3
                log.positions.append((now_s, *place))
                log.velocities.append((now_s, message.vx / 100.0, message.vy / 100.0, message.vz / 100.0))
            case messages.Attitude():
                log.headings.append((now_s, message.yaw))
            case messages.GimbalDeviceAttitudeStatus():
                log.gimbal(now_s, message.q, message.flags)
            case messages.SysStatus() if message.battery_remaining >= 0:
                log.battery.append((now_s, message.battery_remaining / 100.0))
            case messages.Heartbeat():
                log.arm(now_s, bool(message.base_mode & ARMED_FLAG))
                log.mode(now_s, mode_name(self._autopilot, message.custom_mode))
            case messages.Statustext():
                log.events.append(FlightEvent(now_s, "text", message.text))
            case messages.CameraFeedback():
                self._photo(message, message.img_idx, message.lat, message.lng, message.alt_rel, message.time_usec)
            case messages.CameraImageCaptured() if message.capture_result != 1:
                log.camera_failed(now_s, message.image_index)
            case messages.CameraImageCaptured():
                above_m = message.relative_alt / 1000.0
                self._photo(message, message.image_index, message.lat, message.lon, above_m, message.time_boot_ms)

    def _photo(
        self, message: messages.Message, index: int, lat_e7: int, lon_e7: int, above_home_m: float, stamp: int
    ) -> None:
        kind = PHOTO_KINDS[type(message)]
        if self.now_s is None or (kind, index, stamp) in self._seen:
            return
        self._seen.add((kind, index, stamp))
        place = lat_e7 * 1e-7, lon_e7 * 1e-7
        photo = RawPhoto(index, self.now_s, *place, altitude_amsl_m=0.0, above_home_m=above_home_m, source=kind)
        self.log.photos.append(photo)

    def record(self, site: Site, sortie: int) -> FlightRecord | None:
        """The last flight that was recorded; None where nothing flew."""
        from dataclasses import replace

        if not self.log.positions or not all(map(math.isfinite, self.log.positions[-1])):
            return None
        try:
            flights = flights_of(self.log, site, "telemetry")
        except InputError:
            return None
        return replace(flights.records[-1], sortie=sortie)
