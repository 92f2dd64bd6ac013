"""What really happened in a simulated flight: sampled from its airframe, as a record like that of any other flight."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from groundstation.vehicle.orders import SortieOrders
from groundstation.vehicle.recorder import Recorder
from missions.flight.logs.flights import flights_of
from missions.flight.logs.raw import RawPhoto
from missions.flight.record import FlightRecord
from missions.simulator.airframe.state import Pose
from missions.simulator.vehicle import SimulatedVehicle
from planning.base.errors import InputError
from planning.geo.enu import geodetic_from_enu
from planning.geo.frames import Origin, Vec3, wrap_heading_deg


class TruthRecorder:
    """Collects the true poses of a simulated vehicle, and its photos as they were really taken."""

    def __init__(self, vehicle: SimulatedVehicle) -> None:
        self._vehicle = vehicle
        self._poses: list[tuple[float, Pose]] = []

    def sample(self) -> None:
        """Note where it is now."""
        now_s = self._vehicle.now_s
        if not self._poses or now_s > self._poses[-1][0]:
            self._poses.append((now_s, self._vehicle.gimbal.turned(self._vehicle.airframe.truth)))

    def record(self, recorder: Recorder, orders: SortieOrders) -> FlightRecord | None:
        """The flight, with the battery and the events that telemetry told; None where nothing flew.

        The recorder's positions, angles and photos are replaced by the true ones.
        """
        log, origin = recorder.log, orders.site.origin
        if not self._poses:
            return None
        times = [time_s for time_s, _ in self._poses]
        places = _rows(origin, orders.home_enu_m, [pose.position_enu_m for _, pose in self._poses])
        log.positions = [(time_s, *row) for time_s, row in zip(times, places, strict=True)]
        log.velocities = [
            (t, p.velocity_enu_m_s[1], p.velocity_enu_m_s[0], -p.velocity_enu_m_s[2]) for t, p in self._poses
        ]
        log.headings = [(time_s, pose.heading_rad) for time_s, pose in self._poses]
        log.gimbal_pitches = [(time_s, pose.gimbal_pitch_rad) for time_s, pose in self._poses]
        log.gimbal_headings = [(time_s, pose.gimbal_heading_rad) for time_s, pose in self._poses]
        log.gimbal_yaws = []
        shots = self._vehicle.shots
        taken = _rows(origin, orders.home_enu_m, [shot.pose.position_enu_m for shot in shots])
        log.photos = [
            RawPhoto(
                shot.number,
                shot.time_s,
                *row,
                heading_deg=wrap_heading_deg(math.degrees(shot.pose.gimbal_heading_rad)),
                gimbal_pitch_deg=math.degrees(shot.pose.gimbal_pitch_rad),
                source="simulation",
            )
            for shot, row in zip(shots, taken, strict=True)
        ]
        try:
            flights = flights_of(log, orders.site, "simulation")
        except InputError:
            return None
        return replace(flights.records[-1], sortie=orders.number)


def _rows(origin: Origin, home_enu_m: Vec3, points: list[Vec3]) -> list[tuple[float, float, float, float]]:
    """Latitude, longitude, altitude (0: nobody asks for it) and height above home of local points."""
    lat, lon, height = geodetic_from_enu(origin, np.array([home_enu_m, *points], np.float64))
    above = height - height[0]
    return [(float(a), float(b), 0.0, float(c)) for a, b, c in zip(lat[1:], lon[1:], above[1:], strict=True)]
