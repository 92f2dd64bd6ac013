"""How long flying takes: legs from rest to rest, turns, photos, and what a battery allows. All in closed form.

The aircraft accelerates up to the highest speed that the leg's direction allows, holds it, and brakes, within limits of
acceleration and, where the aircraft has one, of jerk. Horizontal and vertical speed have limits of their own, as
autopilots have them. Wind is taken from the worst direction on every leg: it is subtracted from the horizontal
airspeed, never added.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planning.base.errors import InfeasibleError
from planning.geo.frames import Vec3, heading_difference_rad
from planning.parameters import FlightRules
from planning.plan import Aircraft, Plan, Sortie, Viewpoint, viewpoint_arrays

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

STRAIGHT_COSINE = math.cos(0.02)
"""Of the turn at a place on a straight leg: what rounding to 0.1 mm makes of places 1 cm apart."""

UNKNOWN_TURN_RAD = math.pi
"""Turn charged before the first photo of a sortie: the heading after take-off is not known."""


@dataclass(frozen=True, slots=True)
class MotionLimits:
    """How fast an aircraft moves over the ground and turns, under given rules and wind; all positive.

    Only the jerk may be infinite: acceleration then changes at once.
    """

    horizontal_m_s: float
    ascent_m_s: float
    descent_m_s: float
    acceleration_m_s2: float
    yaw_rate_rad_s: float
    gimbal_rate_rad_s: float
    jerk_m_s3: float = math.inf

    def __post_init__(self) -> None:
        for field in self.__slots__:
            value = getattr(self, field)
            if not (value > 0.0 and (math.isfinite(value) or field == "jerk_m_s3")):
                raise ValueError(f"{field}: expected a positive number, got {value}")


def motion_limits(aircraft: Aircraft, rules: FlightRules) -> MotionLimits:
    """Limits of an aircraft in the wind that the rules expect.

    Raises
    ------
    InfeasibleError
        The wind reaches the aircraft's limit, or leaves no speed over the ground.
    """
    if rules.wind_m_s >= aircraft.max_wind_m_s:
        raise InfeasibleError.say(
            "{} may fly in wind below {:g} m/s, but {:g} m/s are expected; wait for less wind or take another aircraft",
            aircraft.name,
            aircraft.max_wind_m_s,
            rules.wind_m_s,
        )
    upwind_m_s = aircraft.max_speed_m_s - rules.wind_m_s
    if upwind_m_s <= 0.0:
        raise InfeasibleError.say(
            "{} flies {:g} m/s and makes no headway against {:g} m/s of wind; wait for less wind or take "
            "another aircraft",
            aircraft.name,
            aircraft.max_speed_m_s,
            rules.wind_m_s,
        )
    return MotionLimits(
        horizontal_m_s=min(upwind_m_s, rules.max_speed_m_s or math.inf),
        ascent_m_s=min(aircraft.max_ascent_m_s, rules.max_speed_m_s or math.inf),
        descent_m_s=min(aircraft.max_descent_m_s, rules.max_speed_m_s or math.inf),
        acceleration_m_s2=aircraft.max_acceleration_m_s2,
        yaw_rate_rad_s=math.radians(aircraft.max_yaw_rate_deg_s),
        gimbal_rate_rad_s=math.radians(aircraft.max_gimbal_rate_deg_s),
        jerk_m_s3=math.inf if aircraft.max_jerk_m_s3 is None else aircraft.max_jerk_m_s3,
    )


def usable_battery_s(aircraft: Aircraft, rules: FlightRules) -> float:
    """Time that a sortie may take from the start of its first leg to the end of its last, seconds.

    The endurance less the reserve, less what take-off and landing take. Makers state endurance for flight without wind
    at a moderate speed; hovering takes about as much power, so time is what counts, not distance.

    Raises
    ------
    InfeasibleError
        Nothing is left.
    """
    usable_s = aircraft.endurance_s * (1.0 - rules.battery_reserve) - rules.takeoff_landing_s
    if usable_s <= 0.0:
        raise InfeasibleError.say(
            "a battery of {} lasts {:g} s; a reserve of {:.0%} and {:g} s for take-off and landing leave "
            "nothing; lower the reserve",
            aircraft.name,
            aircraft.endurance_s,
            rules.battery_reserve,
            rules.takeoff_landing_s,
        )
    return usable_s


def photo_stop_s(aircraft: Aircraft, rules: FlightRules) -> float:
    """Hover at a viewpoint apart from turning, seconds; no shorter than the camera's shortest interval."""
    return max(rules.settle_s + rules.photo_s, aircraft.min_photo_interval_s)


def speed_limits_m_s(delta_enu_m: Floats, limits: MotionLimits) -> Floats:
    """Highest speed along straight legs.

    Parameters
    ----------
    delta_enu_m
        Shape (n, 3), leg vectors; a leg of length zero is taken as horizontal.

    Returns
    -------
    speed_m_s
        Shape (n,): the speed at which the horizontal or the vertical part reaches its limit first.
    """
    delta = np.asarray(delta_enu_m, float)
    horizontal = np.hypot(delta[..., 0], delta[..., 1])
    length = np.hypot(horizontal, delta[..., 2])
    vertical_m_s = np.where(delta[..., 2] > 0.0, limits.ascent_m_s, limits.descent_m_s)
    # The slowness that each part asks for, relative to the length: no division by a part that is zero.
    slowness = np.maximum(horizontal / limits.horizontal_m_s, np.abs(delta[..., 2]) / vertical_m_s)
    is_leg = slowness > 0.0
    return np.where(is_leg, length / np.where(is_leg, slowness, 1.0), limits.horizontal_m_s)


def rest_to_rest_s(
    length_m: ArrayLike, speed_m_s: ArrayLike, acceleration_m_s2: float, jerk_m_s3: float = math.inf
) -> Floats:
    """Shortest time over a straight leg from rest to rest, broadcast shape.

    With L the length and v, a, j the limits, r(v) is the time to reach v from rest: v / a + a / j where v reaches a,
    2 sqrt(v / j) where it does not (v < a^2 / j). The leg takes L / v + r(v) where it is long enough to reach v
    (L >= v r(v)); otherwise 2 r of the highest speed that it does reach. Without a limit of jerk: 2 sqrt(L / a), and
    L / v + v / a where v is reached.
    """
    length, speed = np.asarray(length_m, float), np.asarray(speed_m_s, float)
    a, j = acceleration_m_s2, jerk_m_s3
    ramp_s = np.where(speed * j >= a**2, speed / a + a / j, 2.0 * np.sqrt(speed / j))
    cruising_s = length / speed + ramp_s
    # The highest speed u of a shorter leg: u r(u) = L.
    least = a**2 / j
    highest = (np.sqrt(least**2 + 4.0 * a * length) - least) / 2.0
    peaked_s = np.where(length >= 2.0 * a * least / j, 2.0 * (highest / a + a / j), 4.0 * np.cbrt(length / (2.0 * j)))
    return np.where(length < speed * ramp_s, peaked_s, cruising_s)


def leg_times_s(delta_enu_m: Floats, limits: MotionLimits) -> Floats:
    """Times of straight legs from rest to rest, shape (n,), from their vectors, shape (n, 3)."""
    length = np.linalg.norm(np.asarray(delta_enu_m, float), axis=-1)
    return rest_to_rest_s(length, speed_limits_m_s(delta_enu_m, limits), limits.acceleration_m_s2, limits.jerk_m_s3)


def round_trip_metric(limits: MotionLimits) -> Callable[[Floats], Floats]:
    """Leg times for tables that need the same cost in both directions: the mean of the two.

    Climbing and descending differ; over a flight that ends where it began the means add up to what is flown, but for
    legs that are both steep and sloped differently up and down.
    """

    def mean_times_s(delta_enu_m: Floats) -> Floats:
        return np.asarray((leg_times_s(delta_enu_m, limits) + leg_times_s(-delta_enu_m, limits)) / 2.0)

    return mean_times_s


def turn_times_s(heading_change_rad: ArrayLike, pitch_change_rad: ArrayLike, limits: MotionLimits) -> Floats:
    """Time to turn heading and gimbal together, broadcast shape.

    Both turn at their full rate from the start; what they take to reach it is part of the settling time that follows.
    """
    heading = np.abs(np.asarray(heading_change_rad, float)) / limits.yaw_rate_rad_s
    pitch = np.abs(np.asarray(pitch_change_rad, float)) / limits.gimbal_rate_rad_s
    return np.asarray(np.maximum(heading, pitch))


def with_turns_s(
    leg_s: Floats, heading_rad: Floats, pitch_rad: Floats, limits: MotionLimits, *, turn_in_flight: bool
) -> Floats:
    """Travel times between photos: flying and turning.

    Parameters
    ----------
    leg_s
        Shape (n + 1, n + 1), leg times from rest to rest; row and column 0 are home.
    heading_rad, pitch_rad
        Shape (n,), of the photos.
    turn_in_flight
        Turn evenly along the leg instead of after it.

    Returns
    -------
    travel_s
        Shape (n + 1, n + 1). From home `UNKNOWN_TURN_RAD` is turned, towards home nothing. In flight a leg is slowed
        down until the turn keeps pace, L / v <= turn: t + leg^2 / (4 t) for a turn of t > leg / 2. That is exact for a
        leg that does not reach its highest speed, and a little long (never short) for one that does. With a limit of
        jerk, r(v) grows no slower than sqrt(v) and t + (leg / 2) sqrt(leg / (2 t)) is never short. For legs around
        obstacles see `flight_path`.
    """
    n = len(heading_rad)
    if leg_s.shape != (n + 1, n + 1):
        raise ValueError(f"leg_s: expected shape {(n + 1, n + 1)}, got {leg_s.shape}")
    turn_s = np.zeros((n + 1, n + 1))
    change = heading_difference_rad(heading_rad[:, None], heading_rad[None, :])
    turn_s[1:, 1:] = turn_times_s(change, pitch_rad[:, None] - pitch_rad[None, :], limits)
    turn_s[0, 1:] = turn_times_s(UNKNOWN_TURN_RAD, pitch_rad, limits)
    if not turn_in_flight:
        return leg_s + turn_s
    half_s = leg_s / 2.0
    is_slowed = turn_s > half_s
    slower = half_s / np.where(is_slowed, turn_s, 1.0)
    if math.isfinite(limits.jerk_m_s3):
        slower = np.sqrt(slower)
    return np.where(is_slowed, turn_s + half_s * slower, leg_s)


@dataclass(frozen=True, slots=True, eq=False)
class FlightPath:
    """A polyline to be flown, where it pauses, and how much is turned on the way.

    Parameters
    ----------
    vertices_enu_m
        Shape (k, 3), k >= 1.
    is_stop
        Shape (k,), whether the aircraft comes to rest there; always at both ends.
    hover_s
        Shape (k,), time at rest; 0 where it does not stop.
    turn_s
        Shape (k - 1,): what turning heading and gimbal at their full rates takes of each leg's turn. The turn is
        spread evenly along the leg, so the leg takes no less at any part of it.
    is_passed
        Shape (k,), places on a straight leg where a photo is taken in passing: no stop even for an aircraft that stops
        at every vertex. None where there is no such place.
    """

    vertices_enu_m: Floats
    is_stop: NDArray[np.bool_]
    hover_s: Floats
    turn_s: Floats
    is_passed: NDArray[np.bool_] | None = None

    def __post_init__(self) -> None:
        k = len(self.vertices_enu_m)
        if self.vertices_enu_m.shape != (k, 3) or k < 1 or not np.isfinite(self.vertices_enu_m).all():
            raise ValueError(f"vertices_enu_m: expected finite, shape (k, 3), k >= 1, got {self.vertices_enu_m!r}")
        for name, size in (("is_stop", k), ("hover_s", k), ("turn_s", k - 1)):
            if getattr(self, name).shape != (size,):
                raise ValueError(f"{name}: expected shape ({size},), got {getattr(self, name).shape}")
        if not (self.is_stop[0] and self.is_stop[-1]):
            raise ValueError("is_stop: expected a stop at both ends")
        if not (np.isfinite(self.turn_s).all() and (self.turn_s >= 0.0).all()):
            raise ValueError("turn_s: expected finite times, none negative")
        if not (np.isfinite(self.hover_s).all() and (self.hover_s >= 0.0).all()):
            raise ValueError("hover_s: expected finite times, none negative")
        if (self.hover_s[~self.is_stop] > 0.0).any():
            raise ValueError("hover_s: expected no hover where the aircraft does not stop")
        if self.is_passed is not None and (self.is_passed.shape != (k,) or (self.is_passed & self.is_stop).any()):
            raise ValueError(f"is_passed: expected shape ({k},) and no stop, got {self.is_passed!r}")

    def without_passed(self) -> FlightPath:
        """The same path without the places that are passed."""
        if self.is_passed is None or not self.is_passed.any():
            return self
        kept = np.flatnonzero(~self.is_passed)
        turn_s = np.add.reduceat(self.turn_s, kept[:-1]) if len(kept) > 1 else np.zeros(0)
        return FlightPath(self.vertices_enu_m[kept], self.is_stop[kept], self.hover_s[kept], turn_s)

    @property
    def deltas_enu_m(self) -> Floats:
        """Leg vectors, shape (k - 1, 3)."""
        return np.diff(self.vertices_enu_m, axis=0)


def flight_path(
    vertices_enu_m: Floats,
    photo_vertices: Ints,
    heading_rad: Floats,
    pitch_rad: Floats,
    aircraft: Aircraft,
    rules: FlightRules,
    *,
    stop_at_corners: bool = True,
    in_passing: NDArray[np.bool_] | None = None,
) -> FlightPath:
    """Flight path of a sortie: pauses and turns of its photos, laid onto its polyline.

    Parameters
    ----------
    vertices_enu_m
        Shape (k, 3), from take-off to landing.
    photo_vertices
        Shape (m,), rising: the vertices at which photos are taken.
    heading_rad, pitch_rad
        Shape (m,), of the photos.
    stop_at_corners
        Come to rest at vertices without a photo, too, as waypoint missions of the formats written here do.
    in_passing
        Photos that are taken without a stop, shape (m,); heading and gimbal turn for them on the way.
    """
    limits = motion_limits(aircraft, rules)
    k, m = len(vertices_enu_m), len(photo_vertices)
    if not (heading_rad.shape == pitch_rad.shape == (m,) and (np.diff(photo_vertices) > 0).all()):
        raise ValueError("expected as many headings and pitches as photos, and photo vertices in rising order")
    is_photo = np.zeros(k, np.bool_)
    is_photo[photo_vertices] = True
    passes = np.zeros(m, np.bool_) if in_passing is None else in_passing
    is_passing = np.zeros(k, np.bool_)
    is_passing[photo_vertices] = passes
    is_photo &= ~is_passing
    hover_s = np.where(is_photo, photo_stop_s(aircraft, rules), 0.0)
    heading_change = np.concatenate([[UNKNOWN_TURN_RAD], heading_difference_rad(heading_rad[:-1], heading_rad[1:])])
    needed_s = turn_times_s(heading_change[:m], np.diff(pitch_rad, prepend=0.0), limits)
    # Legs up to a photo turn for it; the last ones, towards home, belong to no photo.
    length_m = np.linalg.norm(np.diff(vertices_enu_m, axis=0), axis=1)
    photo_of_leg = np.searchsorted(photo_vertices, np.arange(k - 1), side="right")
    stretch_m = np.bincount(photo_of_leg, length_m, minlength=m + 1)[:m]
    in_flight = (rules.turn_in_flight | passes) & (stretch_m > 0.0)
    hover_s[photo_vertices] += np.where(in_flight | passes, 0.0, needed_s)
    pace_s_m = np.append(np.where(in_flight, needed_s, 0.0) / np.where(in_flight, stretch_m, 1.0), 0.0)
    turn_s = pace_s_m[photo_of_leg] * length_m
    ends = np.isin(np.arange(k), [0, k - 1])
    vertices = np.asarray(vertices_enu_m, float)
    is_passed = is_passing & ~ends & _is_straight(vertices)
    is_stop = (is_photo | ends | stop_at_corners) & ~is_passed
    return FlightPath(vertices, is_stop, hover_s, turn_s, is_passed if is_passed.any() else None)


def _is_straight(vertices_enu_m: Floats) -> NDArray[np.bool_]:
    """Which vertices, shape (k, 3), lie on a straight leg between their neighbours, shape (k,)."""
    deltas = np.diff(vertices_enu_m, axis=0)
    lengths = np.linalg.norm(deltas, axis=1)
    products = lengths[:-1] * lengths[1:]
    is_straight = np.zeros(len(vertices_enu_m), np.bool_)
    cosines = np.einsum("ij,ij->i", deltas[:-1], deltas[1:]) / np.where(products > 0.0, products, 1.0)
    is_straight[1:-1] = (products > 0.0) & (cosines > STRAIGHT_COSINE)
    return is_straight


def slowed_by_turns_m_s(path: FlightPath, limits: MotionLimits) -> Floats:
    """Highest speed on each leg, shape (k - 1,): by its direction, and so that the turn on it keeps pace."""
    length = np.linalg.norm(path.deltas_enu_m, axis=1)
    speed = speed_limits_m_s(path.deltas_enu_m, limits)
    is_slowed = path.turn_s * speed > length
    return np.where(is_slowed, length / np.where(is_slowed, path.turn_s, 1.0), speed)


def stopping_times_s(path: FlightPath, limits: MotionLimits) -> Floats:
    """Arrival at every vertex when the aircraft comes to rest at each, shape (k,), seconds from the first departure.

    The sortie is over `path.hover_s[-1]` after the last arrival; the hover at the first vertex counts before it leaves.
    At places that are passed it does not rest; when they are reached is taken evenly along their leg.
    """
    if path.is_passed is not None and path.is_passed.any():
        return _with_passed(path, limits)
    length = np.linalg.norm(path.deltas_enu_m, axis=1)
    speed = slowed_by_turns_m_s(path, limits)
    moves = (length > 0.0) & (speed > 0.0)
    flying_s = rest_to_rest_s(length, np.where(moves, speed, 1.0), limits.acceleration_m_s2, limits.jerk_m_s3)
    leg_s = np.where(moves, flying_s, path.turn_s)
    return np.concatenate([[0.0], np.cumsum(path.hover_s[:-1] + leg_s)])


def _with_passed(path: FlightPath, limits: MotionLimits) -> Floats:
    """Arrivals, shape (k,), of a path with places that are passed."""
    assert path.is_passed is not None
    kept = np.flatnonzero(~path.is_passed)
    arrival = stopping_times_s(path.without_passed(), limits)
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(path.deltas_enu_m, axis=1))])
    before = np.maximum(np.searchsorted(kept, np.arange(len(along)), side="left") - 1, 0)
    start, length = along[kept[before]], along[kept[before + 1]] - along[kept[before]]
    share = np.where(length > 0.0, (along - start) / np.where(length > 0.0, length, 1.0), 1.0)
    left = arrival[before] + path.hover_s[kept[before]]
    found = left + share * (arrival[before + 1] - left)
    found[kept] = arrival
    return np.asarray(found)


# How a sortie of a plan is flown and how long it takes, from its record.

SAME_PLACE_M = 1e-3
"""Vertices and viewpoints this close together are one place: coordinates in files are rounded to 0.1 mm."""


def beside_column(path_enu_m: NDArray[np.float64], home_enu_m: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether each leg of a path, shape (k, 3), leaves the vertical column above home; shape (k - 1,)."""
    in_column = np.linalg.norm(path_enu_m[:, :2] - home_enu_m[:2], axis=1) <= SAME_PLACE_M
    return np.asarray(~(in_column[:-1] & in_column[1:]))


def photo_vertices(sortie: Sortie, by_id: Mapping[str, Viewpoint]) -> NDArray[np.int64] | None:
    """Vertex of each of a sortie's viewpoints, in order, shape (m,); None where one is missing.

    Viewpoints at one place have a vertex each where the path has as many there, else they share one.
    """
    positions = tuple(by_id[viewpoint_id].position_enu_m for viewpoint_id in sortie.viewpoint_ids)
    found = _vertices_of(sortie.path_enu_m, positions)
    return None if found is None else np.array(found, np.int64)


@lru_cache(maxsize=64)  # check, times, lists and pictures of a plan all ask for those of the same sorties
def _vertices_of(path: tuple[Vec3, ...], positions: tuple[Vec3, ...]) -> list[int] | None:
    found = [-1]
    for position in positions:
        last = found[-1]
        vertex = last + 1
        while vertex < len(path) and math.dist(path[vertex], position) > SAME_PLACE_M:
            vertex += 1
        is_next = vertex == last + 1 < len(path)
        if not is_next and last >= 0 and math.dist(path[last], position) <= SAME_PLACE_M:
            vertex = last
        if vertex == len(path):
            return None
        found.append(vertex)
    return found[1:]


def sortie_flight_path(
    sortie: Sortie,
    by_id: Mapping[str, Viewpoint],
    aircraft: Aircraft,
    rules: FlightRules,
    *,
    stop_at_corners: bool = True,
) -> tuple[FlightPath, NDArray[np.int64]] | None:
    """Flight path of a sortie and the vertices of its photos; None where the path is none or misses a viewpoint.

    A vertex that several photos share is repeated, so that each has one.

    Raises
    ------
    InfeasibleError
        The aircraft cannot fly in the expected wind.
    """
    vertices = photo_vertices(sortie, by_id)
    if vertices is None or len(sortie.path_enu_m) < 2:
        return None
    views = viewpoint_arrays(tuple(by_id[viewpoint_id] for viewpoint_id in sortie.viewpoint_ids))
    repeats = np.maximum(1, np.bincount(vertices, minlength=len(sortie.path_enu_m)))
    path = np.repeat(np.array(sortie.path_enu_m, np.float64), repeats, axis=0)
    first = np.cumsum(repeats) - repeats
    vertices = first[vertices] + np.arange(len(vertices)) - np.searchsorted(vertices, vertices)
    angles = views.heading_rad, views.pitch_rad
    passing = frozenset(sortie.in_passing_ids)
    in_passing = np.array([viewpoint_id in passing for viewpoint_id in sortie.viewpoint_ids], np.bool_)
    flown = flight_path(
        path, vertices, *angles, aircraft, rules, stop_at_corners=stop_at_corners, in_passing=in_passing
    )
    return flown, vertices


def with_stops(plan: Plan) -> Plan:
    """The plan as aircraft that stop for every photo fly it: what an imported mission takes in passing is a stop, too.

    Raises
    ------
    InfeasibleError
        The aircraft cannot fly in the expected wind.
    """
    if not any(sortie.in_passing_ids for sortie in plan.sorties):
        return plan
    by_id = {viewpoint.id: viewpoint for viewpoint in plan.viewpoints}
    sorties = []
    for sortie in plan.sorties:
        stopping = replace(sortie, in_passing_ids=())
        timed = sortie_flight_path(stopping, by_id, plan.aircraft, plan.rules) if sortie.in_passing_ids else None
        if timed is not None:
            stopping = replace(stopping, duration_s=stopping_duration_s(timed[0], plan.aircraft, plan.rules))
        sorties.append(stopping)
    return replace(plan, sorties=tuple(sorties))


def stopping_duration_s(flown: FlightPath, aircraft: Aircraft, rules: FlightRules) -> float:
    """Duration of a sortie that stops at every vertex, take-off and landing included, seconds.

    Raises
    ------
    InfeasibleError
        The aircraft cannot fly in the expected wind.
    """
    arrival_s = stopping_times_s(flown, motion_limits(aircraft, rules))
    return rules.takeoff_landing_s + float(arrival_s[-1] + flown.hover_s[-1])
