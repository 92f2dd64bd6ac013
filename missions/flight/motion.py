"""How the aircraft moved at the shutter of each photo of a flight."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from missions.flight.record import FlightRecord, Track
from planning.geo.frames import Vec3

Array = NDArray[np.float64]

WITHIN_S = 1.0
"""A track says nothing of moments that are further from its samples."""

STANDSTILL_M_S = 0.05
"""Below this speed, a velocity has no direction to speak of."""


def shutter_velocities(record: FlightRecord) -> tuple[Vec3, ...]:
    """Velocities at the shutters of a record's photos, ENU, m/s; 0 where nothing is known.

    By the track, with the speed over ground that the photo has itself. A photo with a speed, of which the track does
    not say the direction, flies from the photo before towards the one after.
    """
    times = np.array([photo.time_s for photo in record.photos], np.float64)
    velocities = _by_track(record.track, times)
    places = np.array([photo.position_enu_m for photo in record.photos], np.float64).reshape(-1, 3)
    last = max(len(times) - 1, 0)
    for number, photo in enumerate(record.photos):
        if photo.speed_m_s is None:
            continue
        way = velocities[number, :2]
        if np.hypot(*way) < STANDSTILL_M_S:
            way = (places[min(number + 1, last)] - places[max(number - 1, 0)])[:2]
        length = float(np.hypot(*way))
        velocities[number, :2] = way / length * photo.speed_m_s if length > 0.0 else 0.0
    return tuple((east, north, up) for east, north, up in velocities.tolist())


def _by_track(track: Track, times_s: Array) -> Array:
    """Velocities between the samples that have one, shape (n, 3)."""
    known = np.isfinite(track.velocity_enu_m_s).all(axis=1)
    if not known.any():
        return np.zeros((len(times_s), 3))
    at_s, velocities = track.time_s[known], track.velocity_enu_m_s[known]
    found = np.column_stack([np.interp(times_s, at_s, velocities[:, axis]) for axis in range(3)])
    after = np.clip(np.searchsorted(at_s, times_s), 0, len(at_s) - 1)
    away_s = np.minimum(np.abs(at_s[after] - times_s), np.abs(at_s[np.maximum(after - 1, 0)] - times_s))
    found[away_s > WITHIN_S] = 0.0
    return np.asarray(found)
