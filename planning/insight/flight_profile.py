"""How a sortie is flown: where the aircraft is, how high and how fast at any time, and when it takes photos."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planning.base.errors import InfeasibleError
from planning.geo.frames import Vec3
from planning.motion.timing import (
    SAME_PLACE_M,
    beside_column,
    motion_limits,
    photo_stop_s,
    slowed_by_turns_m_s,
    sortie_flight_path,
    stopping_times_s,
)
from planning.plan import Plan, Sortie
from planning.site.ground import Ground

Array = NDArray[np.float64]


# Motion of straight legs from rest to rest in closed form: distance and speed at any time.
#
# The legs are those of `planning.motion.timing.rest_to_rest_s`: the speed rises to its peak u within the ramp time r,
# is held,
# and falls again. With the acceleration a' = min(a, sqrt(u j)) and the jerk j it takes a' / j until the acceleration
# is
# reached, so r = u / a' + a' / j, and the ramp is u r / 2 long. Without a limit of jerk a' = a and r = u / a.


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
    """Motion behind `planning.motion.timing.rest_to_rest_s`: legs of these lengths and highest speeds, shapes (k,).

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


RAMP_PARTS = np.array([0.25, 0.5, 0.75, 1.0])
"""Samples of a ramp: straight lines between them stay within 4 % of the peak speed."""


@dataclass(frozen=True, slots=True, eq=False)
class FlightProfile:
    """One sortie over time: a path of k vertices, at each of which the aircraft comes to rest, and p photos.

    Time counts from the moment at which the aircraft hangs above home, ready to go; starting motors, take-off checks
    and landing (`FlightRules.takeoff_landing_s`) come on top.

    Parameters
    ----------
    vertices_enu_m
        Shape (k, 3).
    arrival_s, departure_s
        At each vertex, shape (k,).
    ramps
        Motion of the k - 1 legs.
    photo_s
        Moments of the photos, shape (p,), and their viewpoints, `photo_ids`.
    """

    vertices_enu_m: Array
    arrival_s: Array
    departure_s: Array
    ramps: Ramps
    photo_s: Array
    photo_ids: tuple[str, ...]

    @property
    def duration_s(self) -> float:
        """Until the last hover is over."""
        return float(self.departure_s[-1])

    def at(self, t_s: Array) -> ProfileSamples:
        """Where the aircraft is at times of shape (q,); before the start and after the end it rests."""
        t = np.asarray(t_s, np.float64)
        leg = np.clip(np.searchsorted(self.departure_s[:-1], t, side="right") - 1, 0, len(self.arrival_s) - 2)
        flown_m, speed = self.ramps.at(leg, t - self.departure_s[leg])
        legs = np.diff(self.vertices_enu_m, axis=0)
        lengths = np.linalg.norm(legs, axis=1)
        part = np.clip(flown_m / np.where(lengths > 0.0, lengths, 1.0)[leg], 0.0, 1.0)
        positions = self.vertices_enu_m[leg] + part[:, None] * legs[leg]
        before_m = np.cumsum(lengths) - lengths
        return ProfileSamples(t, before_m[leg] + part * lengths[leg], positions, speed)

    def samples(self) -> ProfileSamples:
        """Enough for a chart: every change of motion, and points along the ramps; times rising."""
        ramp = self.ramps.ramp_s[:, None] * RAMP_PARTS
        start, end = self.departure_s[:-1, None], self.departure_s[:-1, None] + self.ramps.duration_s[:, None]
        times = [self.arrival_s, self.departure_s, (start + ramp).ravel(), (end - ramp).ravel(), end.ravel()]
        return self.at(np.unique(np.concatenate([*times, self.photo_s])))


LOW_M = 10.0
"""Below this height above the ground, lamp posts, trees and cables are to be expected that no site file has."""


@dataclass(frozen=True, slots=True)
class LowFlight:
    """How low a sortie flies beside the vertical column above home, above the ground that the site knows.

    Over terrain that has no heights it counts as flying on the ground: the check of a plan says so.

    Parameters
    ----------
    lowest_m
        Height of the lowest point.
    below_s
        Time below `LOW_M`, hovering included; None where the sortie cannot be timed.
    duration_s
        Of the whole sortie without motors running on the ground, for comparison; None likewise.
    """

    lowest_m: float
    below_s: float | None
    duration_s: float | None


def low_flight(plan: Plan, sortie: Sortie, home_enu_m: Vec3, ground: Ground) -> LowFlight | None:
    """How low one of a plan's sorties flies; None where its path never leaves the column above home."""
    path, home = np.array(sortie.path_enu_m, np.float64).reshape(-1, 3), np.array(home_enu_m)
    beside = beside_column(path, home)
    if not beside.any():
        return None
    lowest_m = float(_known(ground.least_m(path[:-1][beside], path[1:][beside])).min())
    try:
        profile = sortie_profile(plan, sortie)
    except InfeasibleError:  # no flying in this wind
        profile = None
    if profile is None:
        return LowFlight(lowest_m, None, None)
    samples = profile.samples()
    heights = _known(ground.least_m(samples.positions_enu_m, samples.positions_enu_m))
    # A sample stands for the way to the next one; along it the height is taken as linear.
    away_m = np.linalg.norm(samples.positions_enu_m[:, :2] - home[:2], axis=1)
    counts = np.maximum(away_m[:-1], away_m[1:]) > SAME_PLACE_M
    low, high = np.minimum(heights[:-1], heights[1:]), np.maximum(heights[:-1], heights[1:])
    part = np.clip((LOW_M - low) / np.maximum(high - low, 1e-9), 0.0, 1.0)
    below_s = float((np.diff(samples.t_s) * part * counts).sum())
    return LowFlight(lowest_m, below_s, profile.duration_s)


def _known(heights_m: Array) -> Array:
    return np.where(np.isfinite(heights_m), heights_m, 0.0)


def highest_above_ground_m(plan: Plan, ground: Ground) -> float:
    """Greatest height above the ground of a plan's paths, as far as it is known; 0 where none is."""
    paths = [np.array(sortie.path_enu_m, np.float64).reshape(-1, 3) for sortie in plan.sorties]
    heights = [ground.greatest_m(path[:-1], path[1:]) for path in paths if len(path) > 1]
    known = np.concatenate([each[np.isfinite(each)] for each in heights]) if heights else np.zeros(0)
    return float(known.max(initial=0.0))


def lowest_flight(plan: Plan, home_enu_m: Vec3, ground: Ground) -> LowFlight | None:
    """Of all sorties together: the lowest point, and the times' sums; None where none leaves the column above home."""
    found = [low_flight(plan, sortie, home_enu_m, ground) for sortie in plan.sorties]
    flown = [each for each in found if each is not None]
    if not flown:
        return None
    below_s = [each.below_s for each in flown if each.below_s is not None]
    duration_s = [each.duration_s for each in flown if each.duration_s is not None]
    is_timed = len(below_s) == len(flown)
    return LowFlight(
        min(each.lowest_m for each in flown), sum(below_s) if is_timed else None, sum(duration_s) if is_timed else None
    )


@dataclass(frozen=True, slots=True, eq=False)
class ProfileSamples:
    """Samples of a flight, q of them.

    Parameters
    ----------
    t_s, distance_m, speed_m_s
        Time, way along the path and speed along it, shape (q,).
    positions_enu_m
        Shape (q, 3).
    """

    t_s: Array
    distance_m: Array
    positions_enu_m: Array
    speed_m_s: Array

    def heights_m(self, base_z_m: float) -> Array:
        """Heights above a level, ENU z: the ground's, or home's for height above take-off."""
        return self.positions_enu_m[:, 2] - base_z_m


def sortie_profile(plan: Plan, sortie: Sortie) -> FlightProfile | None:
    """Profile of one of a plan's sorties; None where its path has no leg or misses one of its viewpoints.

    Raises
    ------
    InfeasibleError
        The aircraft cannot fly in the expected wind.
    """
    limits = motion_limits(plan.aircraft, plan.rules)
    timed = sortie_flight_path(
        sortie, {viewpoint.id: viewpoint for viewpoint in plan.viewpoints}, plan.aircraft, plan.rules
    )
    if timed is None:
        return None
    passing, at_photos = timed
    photos_s = (stopping_times_s(passing, limits) + passing.hover_s)[at_photos]
    flown = passing.without_passed()
    arrival = stopping_times_s(flown, limits)
    lengths = np.linalg.norm(flown.deltas_enu_m, axis=1)
    ramps = rest_to_rest_ramps(lengths, slowed_by_turns_m_s(flown, limits), limits.acceleration_m_s2, limits.jerk_m_s3)
    departure = arrival + flown.hover_s
    # Of a photo stop, turning comes first, then settling, the photo, and waiting for the camera.
    stop_s = photo_stop_s(plan.aircraft, plan.rules) - plan.rules.settle_s
    photo_s = photos_s - np.where(passing.hover_s[at_photos] > 0.0, stop_s, 0.0)
    return FlightProfile(flown.vertices_enu_m, arrival, departure, ramps, photo_s, sortie.viewpoint_ids)
