"""Motion of straight legs from rest to rest in closed form: distance and speed at any time.

The legs are those of `planning.timing.rest_to_rest_s`: the speed rises to its peak u within the ramp time r, is held,
and falls again. With the acceleration a' = min(a, sqrt(u j)) and the jerk j it takes a' / j until the acceleration is
reached, so r = u / a' + a' / j, and the ramp is u r / 2 long. Without a limit of jerk a' = a and r = u / a.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Ramps:
    """Motion of legs from rest to rest, shapes (k,) and broadcast together.

    Parameters
    ----------
    peak_m_s, ramp_s
        Highest speed, and the time to reach it from rest; 0 on legs that do not move.
    acceleration_m_s2, jerk_m_s3
        Highest acceleration reached on each leg, 0 where it does not move; the limit of jerk, may be infinite.
    duration_s
        From rest to rest.
    """

    peak_m_s: Array
    ramp_s: Array
    acceleration_m_s2: Array
    jerk_m_s3: float
    duration_s: Array

    def at(self, leg: NDArray[np.int64], t_s: Array) -> tuple[Array, Array]:
        """Distance flown and speed at times since the legs' departures, clipped to the legs; shape of `t_s`."""
        duration = self.duration_s[leg]
        t = np.clip(t_s, 0.0, duration)
        until_end = duration - t
        braking = until_end < t
        climbed_m, speed = self._ramp(leg, np.minimum(t, until_end))
        length = self.length_m[leg]
        return np.where(braking, length - climbed_m, climbed_m), speed

    @property
    def length_m(self) -> Array:
        """Of the legs, shape (k,)."""
        return self.peak_m_s * np.maximum(self.duration_s - self.ramp_s, 0.0)

    def _ramp(self, leg: NDArray[np.int64], t: Array) -> tuple[Array, Array]:
        """Distance and speed at time t after rest, up to the middle of the leg."""
        peak, ramp, a = self.peak_m_s[leg], self.ramp_s[leg], self.acceleration_m_s2[leg]
        moving = ramp > 0.0
        jerk = self.jerk_m_s3 if math.isfinite(self.jerk_m_s3) else 0.0
        jerking = a / self.jerk_m_s3
        t_ramp = np.minimum(t, ramp)
        until_peak = ramp - t_ramp
        rising, easing = t_ramp < jerking, (until_peak < jerking) & (t_ramp >= jerking)
        speed = a * (t_ramp - 0.5 * jerking)
        # With jerk j the speed at the end of the rise is a'^2 / (2 j), and the distance a'^3 / (6 j^2).
        steady = t_ramp - jerking
        distance = steady * (0.5 * a * jerking + 0.5 * a * steady) + a * jerking**2 / 6.0
        speed = np.where(rising, 0.5 * jerk * t_ramp**2, speed)
        distance = np.where(rising, jerk * t_ramp**3 / 6.0, distance)
        speed = np.where(easing, peak - 0.5 * jerk * until_peak**2, speed)
        distance = np.where(easing, 0.5 * peak * ramp - peak * until_peak + jerk * until_peak**3 / 6.0, distance)
        cruising = np.maximum(t - ramp, 0.0)
        distance = distance + cruising * peak
        return np.where(moving, distance, 0.0), np.where(moving, speed, 0.0)


def rest_to_rest_ramps(
    length_m: ArrayLike, speed_m_s: ArrayLike, acceleration_m_s2: float, jerk_m_s3: float = math.inf
) -> Ramps:
    """Motion behind `planning.timing.rest_to_rest_s`: legs of these lengths and highest speeds, shapes (k,).

    A leg too short for its speed v, L < v r(v), peaks at the u with u r(u) = L: (sqrt(l^2 + 4 a L) - l) / 2 with
    l = a^2 / j where it reaches the acceleration a, the cube root of L^2 j / 4 where it does not.
    """
    length, speed = np.broadcast_arrays(np.asarray(length_m, float), np.asarray(speed_m_s, float))
    a, j = acceleration_m_s2, jerk_m_s3
    least = a**2 / j
    finite_jerk = j if math.isfinite(j) else 1.0  # without a limit the second branch is never taken
    short = np.where(
        length >= 2.0 * a * least / j,
        (np.sqrt(least**2 + 4.0 * a * length) - least) / 2.0,
        np.cbrt(length**2 * finite_jerk / 4.0),
    )
    peak = np.minimum(speed, short)
    reached = np.minimum(a, np.sqrt(peak * j)) if math.isfinite(j) else np.where(peak > 0.0, a, 0.0)
    moving = (peak > 0.0) & (length > 0.0)
    safe = np.where(moving, reached, 1.0)
    ramp = np.where(moving, peak / safe + reached / j, 0.0)
    duration = np.where(moving, length / np.where(moving, peak, 1.0) + ramp, 0.0)
    return Ramps(np.where(moving, peak, 0.0), ramp, np.where(moving, reached, 0.0), j, duration)
