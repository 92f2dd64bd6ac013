"""Sorties that are in the air at the same time, each with an aircraft of its own, and keep apart in space and time.

While an aircraft is on a leg, it counts as being all along it, from its arrival at the leg's start until it leaves the
leg's end. When that is depends on the autopilot, which a plan does not know: one that limits jerk takes half as long
again for short legs. So a sortie has times at several paces, and the aircraft of one plan fly at the same pace or at
any mixture of them, each of them besides up to `TIMING_S` and a share of its time early or late. Two sorties keep apart
if no two legs nearer than the distance asked for are flown at times that may coincide at any mixture. The time between
two legs is linear in the mixture's weights, so for each pair of sorties the differences of starts that are forbidden
are intervals whose ends belong to single paces, and starts are found among their ends; that no two legs meet is exact,
not sampled.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.aircraft.catalogue import profile
from planning.base.jit import kernel
from planning.base.progress import Stop, TimeLimit, any_of, never
from planning.geo.bvh import segment_segment_d2
from planning.motion.px4 import px4_legs_s
from planning.motion.timing import (
    FlightPath,
    MotionLimits,
    flight_path,
    motion_limits,
    photo_stop_s,
    sortie_flight_path,
    stopping_times_s,
)
from planning.parameters import FlightRules
from planning.plan import Aircraft, Plan, Sortie, ViewpointArrays
from planning.routing.flights import Flight, FlightTimes, draw_flights, reversed_flight
from planning.routing.sorties import plan_sorties

Array = NDArray[np.float64]

TIMING_S, TIMING_SHARE = 15.0, 0.05
"""How early or late an aircraft may be beside its pace: so much in any case (a pilot's hand on the button), and a share
of the time since its start. Photos of both autopilots in simulation stay within two thirds of it."""

ARDUPILOT_LATE_S, ARDUPILOT_PHOTO_S, PX4_PHOTO_S, PASS_S = 0.7, 3.0, 2.0, 1.0
"""What an autopilot takes longer for a leg than the fastest way, its shortest stops for a photo, and that of both at a
vertex without one (`missions.mavlink.items`)."""

PX4_RADIUS_M = 0.5
"""Within which PX4's waypoints count as reached, as missions are written."""

CHANGE_S = 120.0
"""Between a landing and the next take-off of the same aircraft: time for the battery."""

REGION_S = 0.5
"""Longest time for the way through one region."""

SWEPT = (2, 3, 4, 5, 6, 7, 8)
"""Numbers of stripes of a swept region that are tried."""

MOST_ORDERS = 720
"""Orders of sorties that starts are looked for in: all of up to six, else some drawn at random."""


@dataclass(frozen=True, slots=True, eq=False)
class LegTimes:
    """The legs of a sortie and when it may be on them.

    Parameters
    ----------
    starts_enu_m, ends_enu_m
        Shape (k, 3).
    from_s, until_s
        Since the motors were switched on, at each pace, shape (p, k); the first pace is as planned.
    """

    starts_enu_m: Array
    ends_enu_m: Array
    from_s: Array
    until_s: Array

    @property
    def earliest_s(self) -> Array:
        """When the aircraft is there at the earliest, shape (p, k)."""
        return np.asarray(self.from_s - TIMING_S - TIMING_SHARE * self.from_s)

    @property
    def latest_s(self) -> Array:
        """When it has left at the latest, shape (p, k)."""
        return np.asarray(self.until_s + TIMING_S + TIMING_SHARE * self.until_s)

    @property
    def longer_s(self) -> float:
        """How much longer than planned the sortie takes at the slowest pace."""
        return float((self.until_s[:, -1] - self.until_s[0, -1]).max())


def leg_times(path: FlightPath, aircraft: Aircraft, rules: FlightRules) -> LegTimes:
    """Of an aircraft that comes to rest at every vertex.

    Raises
    ------
    InfeasibleError
        The aircraft cannot fly in the expected wind.
    """
    path = path.without_passed()
    arrival_s, hover_s = _paces(path, aircraft, rules)
    # Take-off and landing, together as long as the rules say, may each take all of it.
    ground_s = rules.takeoff_landing_s
    from_s, until_s = arrival_s[:, :-1] + ground_s, arrival_s[:, 1:] + hover_s[:, 1:] + ground_s
    from_s[:, 0], until_s[:, -1] = 0.0, until_s[:, -1] + ground_s
    return LegTimes(path.vertices_enu_m[:-1], path.vertices_enu_m[1:], from_s, until_s)


def _paces(path: FlightPath, aircraft: Aircraft, rules: FlightRules) -> tuple[Array, Array]:
    """Arrival at every vertex and time at rest there, each shape (p, k): as planned, without turning, ArduPilot, PX4.

    Both autopilots turn on the way as far as they can, each by its own rule: with the pace that needs no time for turns
    mixtures have any part of them.
    """
    limits, photo_s = motion_limits(aircraft, rules), photo_stop_s(aircraft, rules)
    is_photo, n_legs = path.hover_s > 0.0, len(path.turn_s)
    plain = replace(path, hover_s=np.minimum(path.hover_s, photo_s), turn_s=np.zeros(n_legs))

    def jerky(autopilot: str) -> MotionLimits:
        own = profile(autopilot).aircraft.max_jerk_m_s3
        return limits if aircraft.max_jerk_m_s3 or own is None else replace(limits, jerk_m_s3=own)

    stops_s = np.where(is_photo, np.maximum(path.hover_s, ARDUPILOT_PHOTO_S), PASS_S) + ARDUPILOT_LATE_S
    smooth = replace(path, hover_s=np.where(path.is_stop, stops_s, 0.0))
    px4_s = np.where(is_photo, np.maximum(path.hover_s, PX4_PHOTO_S), PASS_S)
    legs_s = np.maximum(px4_legs_s(path.deltas_enu_m, jerky("px4"), PX4_RADIUS_M), path.turn_s)
    hover_s = np.stack([path.hover_s, plain.hover_s, smooth.hover_s, px4_s])
    arrival_s = [stopping_times_s(path, limits), stopping_times_s(plain, limits)]
    arrival_s += [stopping_times_s(smooth, jerky("ardupilot"))]
    arrival_s += [np.concatenate([[0.0], np.cumsum(px4_s[:-1] + legs_s)])]
    return np.stack(arrival_s), hover_s


def sortie_leg_times(plan: Plan, sortie: Sortie) -> LegTimes | None:
    """Of one of a plan's sorties; None where its path is none or misses a viewpoint. Errors as `leg_times`."""
    by_id = {viewpoint.id: viewpoint for viewpoint in plan.viewpoints}
    timed = sortie_flight_path(sortie, by_id, plan.aircraft, plan.rules)
    return None if timed is None else leg_times(timed[0], plan.aircraft, plan.rules)


@kernel
def _distances_m(a: Array, b: Array, c: Array, d: Array, found: Array) -> None:
    for i in range(len(a)):
        for j in range(len(c)):
            found[i, j] = np.sqrt(segment_segment_d2(a[i], b[i], c[j], d[j]))


def leg_distances_m(one: LegTimes, other: LegTimes) -> Array:
    """Distance of each leg of one sortie to each of another, shape (k, l), exact."""
    found = np.empty((len(one.starts_enu_m), len(other.starts_enu_m)))
    a, b, c, d = (
        np.ascontiguousarray(ends, np.float64)
        for ends in (one.starts_enu_m, one.ends_enu_m, other.starts_enu_m, other.ends_enu_m)
    )
    _distances_m(a, b, c, d, found)
    return found


def forbidden_s(is_near: NDArray[np.bool_], one: LegTimes, other: LegTimes) -> Array:
    """Differences, start of `other` less start of `one`, that could bring them nearer: open intervals, shape (q, 2).

    Sorted, and none meets another.

    Parameters
    ----------
    is_near
        Whether legs of one are nearer to legs of the other than they may be, shape (k, l).
    """
    i, j = np.nonzero(is_near)
    low = (one.earliest_s[:, i] - other.latest_s[:, j]).min(axis=0)
    high = (one.latest_s[:, i] - other.earliest_s[:, j]).max(axis=0)
    merged: list[list[float]] = []
    for first, last in sorted(zip(low.tolist(), high.tolist(), strict=True)):
        if merged and first < merged[-1][1]:
            merged[-1][1] = max(merged[-1][1], last)
        else:
            merged.append([first, last])
    return np.array(merged, np.float64).reshape(-1, 2)


@dataclass(frozen=True, slots=True, eq=False)
class Ways:
    """A sortie in both directions of flight."""

    durations_s: tuple[float, float]
    legs: tuple[LegTimes, LegTimes]


@dataclass(frozen=True, slots=True)
class Start:
    """When a sortie starts, by which aircraft, from 1, and whether it is flown the other way round."""

    start_s: float
    aircraft: int
    is_reversed: bool


def earliest_starts(sorties: Sequence[Ways], n_aircraft: int, apart_m: float, seed: int = 0) -> tuple[Start, ...]:
    """Starts after which the last sortie has landed as early as could be found.

    Sorties are taken in some order, each by the aircraft that is ready first, in the direction in which it has landed
    first at the earliest start that keeps it apart from all before it; the best of all orders of few sorties, or of
    many orders.
    """
    n = len(sorties)
    forbidden: dict[tuple[int, int, int, int], Array] = {}
    for one, other in itertools.combinations(range(n), 2):
        is_near = leg_distances_m(sorties[one].legs[0], sorties[other].legs[0]) < apart_m
        for a, b in itertools.product((0, 1), repeat=2):
            flipped = is_near[:: 1 - 2 * a, :: 1 - 2 * b]
            spans = forbidden_s(flipped, sorties[one].legs[a], sorties[other].legs[b])
            forbidden[one, a, other, b], forbidden[other, b, one, a] = spans, -spans[::-1, ::-1]
    orders = [tuple(sorted(range(n), key=lambda k: -sorties[k].durations_s[0])), tuple(range(n))]
    if math.factorial(n) <= MOST_ORDERS:
        orders += itertools.permutations(range(n))
    else:
        rng = np.random.default_rng(seed)
        orders += [tuple(rng.permutation(n).tolist()) for _ in range(MOST_ORDERS)]
    fleets = range(1, n_aircraft + 1)  # where they would only wait for each other, fewer fly
    found = (_in_order(order, sorties, forbidden, n) for n, order in itertools.product(fleets, orders))
    return min(found, key=lambda starts: landed_s(sorties, starts))


def landed_s(sorties: Sequence[Ways], starts: Sequence[Start]) -> float:
    """When the last one has landed."""
    return max(start.start_s + ways.durations_s[start.is_reversed] for ways, start in zip(sorties, starts, strict=True))


def _in_order(
    order: Sequence[int], sorties: Sequence[Ways], forbidden: dict[tuple[int, int, int, int], Array], n_aircraft: int
) -> tuple[Start, ...]:
    ready_s = [0.0] * n_aircraft
    found: dict[int, Start] = {}
    for sortie in order:
        own = min(range(n_aircraft), key=ready_s.__getitem__)
        others = [(other, start) for other, start in found.items() if start.aircraft != own + 1]
        ways = []
        for way in (0, 1):
            spans = [start.start_s + forbidden[other, int(start.is_reversed), sortie, way] for other, start in others]
            start_s = ready_s[own]
            for first, last in sorted(itertools.chain.from_iterable(span.tolist() for span in spans)):
                if first < start_s < last:
                    start_s = float(math.ceil(last))  # whole seconds, as pilots read them
            ways.append((start_s + sorties[sortie].durations_s[way], way, start_s))
        landed, way, start_s = min(ways)
        found[sortie] = Start(start_s, own + 1, bool(way))
        ready_s[own] = float(math.ceil(landed + sorties[sortie].legs[way].longer_s + CHANGE_S))
    return tuple(found[k] for k in range(len(order)))


def share_out(
    times: FlightTimes,
    views: ViewpointArrays,
    aircraft: Aircraft,
    rules: FlightRules,
    flights: tuple[Flight, ...],
    most: int | None = None,
    seed: int = 0,
    stop: Stop = never,
) -> tuple[Flight, ...]:
    """Sorties through the same views for as many aircraft as the rules say, with starts; the first to have all landed.

    Tried are the sorties given, and as many for each aircraft, in regions side by side and one above the other, on the
    shortest way or in stripes, which keep apart more easily.

    Parameters
    ----------
    most
        Batteries that there are.
    """
    wanted = rules.at_once * -(-len(flights) // rules.at_once)
    wanted = min(wanted, most or wanted, len(views.heading_rad))
    options = [flights]
    middle = views.positions_enu_m - views.positions_enu_m.mean(axis=0)
    east, north = np.linalg.svd(middle[:, :2], full_matrices=False)[2][0]
    beside, above = np.array([east, north, 0.0]), np.array([0.0, 0.0, 1.0])
    for axis, other in ((beside, above), (above, beside)):
        if stop() and axis is above:  # regions side by side are tried in any case
            break
        regions = np.array_split(np.argsort(middle @ axis, kind="stable"), wanted)
        along, across = middle @ axis, middle @ other
        for orders in (
            tuple(_shortest(times, region, aircraft, seed, stop) for region in regions),
            tuple(_swept(times, region, along, across) for region in regions),
        ):
            option = draw_flights(times, orders, views, aircraft, rules)
            if all(_fits(flight, times, aircraft, rules) for flight in option):
                options.append(option)
    best, best_s = flights, np.inf
    for option in options:
        backwards = tuple(reversed_flight(flight, views, aircraft, rules) for flight in option)
        ways = [
            Ways(
                (one.duration_s, other.duration_s if _fits(other, times, aircraft, rules) else math.inf),
                (_flown(one, views, aircraft, rules), _flown(other, views, aircraft, rules)),
            )
            for one, other in zip(option, backwards, strict=True)
        ]
        starts = earliest_starts(ways, rules.at_once, rules.apart_m, seed)
        if landed_s(ways, starts) < best_s:
            best_s = landed_s(ways, starts)
            best = tuple(
                replace(other if start.is_reversed else one, start_s=start.start_s, aircraft=start.aircraft)
                for one, other, start in zip(option, backwards, starts, strict=True)
            )
    return best


def _flown(flight: Flight, views: ViewpointArrays, aircraft: Aircraft, rules: FlightRules) -> LegTimes:
    angles = views.heading_rad[flight.views], views.pitch_rad[flight.views]
    return leg_times(flight_path(flight.path_enu_m, flight.photo_vertices, *angles, aircraft, rules), aircraft, rules)


def _shortest(
    times: FlightTimes, region: NDArray[np.int64], aircraft: Aircraft, seed: int, stop: Stop
) -> tuple[int, ...]:
    """Some of the views in the order of the shortest flight; of several, one after the other, which is too long."""
    places = np.concatenate([[0], region + 1])
    travel_s, max_stops = times.travel_s[np.ix_(places, places)], max(1, aircraft.max_waypoints - 2)
    until = any_of(stop, TimeLimit(REGION_S))
    found = plan_sorties(travel_s, times.service_s[region], times.budget_s, max_stops, seed=seed, stop=until)
    return tuple(region[list(itertools.chain.from_iterable(found))].tolist())


def _fits(flight: Flight, times: FlightTimes, aircraft: Aircraft, rules: FlightRules) -> bool:
    within = flight.duration_s - rules.takeoff_landing_s <= times.budget_s
    return within and len(flight.path_enu_m) - 2 <= aircraft.max_waypoints


def _travel_s(times: FlightTimes, order: NDArray[np.int64]) -> float:
    places = np.concatenate([[0], order + 1, [0]])
    return float(times.travel_s[places[:-1], places[1:]].sum())


def _swept(times: FlightTimes, region: NDArray[np.int64], along: Array, across: Array) -> tuple[int, ...]:
    """Some of the views stripe by stripe along an axis, in the quickest number of stripes.

    Longer than the shortest of all, but aircraft that sweep regions side by side stay a region apart.
    """
    rank, beside = np.argsort(np.argsort(along[region])), across[region]
    orders = []
    for n_stripes in SWEPT:
        stripe = rank * n_stripes // len(region)
        orders.append(region[np.lexsort((np.where(stripe % 2, -beside, beside), stripe))])
    return tuple(min(orders, key=lambda order: _travel_s(times, order)).tolist())


def flown_at_once(plan: Plan) -> Plan:
    """A plan with new starts for its sorties as they are; without any where one aircraft flies.

    Raises
    ------
    InfeasibleError
        The aircraft cannot fly in the expected wind.
    """
    several = plan.rules.at_once > 1
    legs = [sortie_leg_times(plan, sortie) for sortie in plan.sorties] if several else []
    known = [each for each in legs if each is not None]
    if not legs or len(known) < len(legs):
        return replace(plan, sorties=tuple(replace(each, start_s=None, aircraft=None) for each in plan.sorties))
    ways = [Ways((sortie.duration_s, math.inf), (each, each)) for sortie, each in zip(plan.sorties, known, strict=True)]
    starts = earliest_starts(ways, plan.rules.at_once, plan.rules.apart_m, plan.seed)
    timed = (
        replace(sortie, start_s=start.start_s, aircraft=start.aircraft)
        for sortie, start in zip(plan.sorties, starts, strict=True)
    )
    return replace(plan, sorties=tuple(timed))


def nearest_at_once_m(first: LegTimes, first_s: float, second: LegTimes, second_s: float) -> float:
    """Smallest distance of legs of two sorties that may be flown at the same time; inf where none may."""
    low = (first.earliest_s[:, :, None] - second.latest_s[:, None, :]).min(axis=0)
    high = (first.latest_s[:, :, None] - second.earliest_s[:, None, :]).max(axis=0)
    meets = (low < second_s - first_s) & (second_s - first_s < high)
    return float(np.where(meets, leg_distances_m(first, second), np.inf).min())


def compile_kernels() -> None:
    """Compile what this module runs."""
    leg = LegTimes(np.zeros((1, 3)), np.ones((1, 3)), np.zeros((1, 1)), np.ones((1, 1)))
    leg_distances_m(leg, leg)
