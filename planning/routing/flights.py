"""From viewpoints to sorties that can be flown: legs, shares of the batteries, polylines and durations."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, Trace, never
from planning.motion.timing import (
    flight_path,
    motion_limits,
    photo_stop_s,
    round_trip_metric,
    stopping_duration_s,
    usable_battery_s,
    with_turns_s,
)
from planning.parameters import FlightRules
from planning.plan import Aircraft, ViewpointArrays
from planning.routing.legs import LegTable, build_leg_table
from planning.routing.roadmap import Roadmap
from planning.routing.sorties import Sorties, plan_sorties

Array = NDArray[np.float64]

DECIMALS = 4
"""Path vertices are rounded to 0.1 mm, as viewpoints are."""

ATTEMPTS = 4
"""Times that sorties are planned again with a smaller share of the battery when exact durations do not fit."""


@dataclass(frozen=True, slots=True, eq=False)
class Flight:
    """One sortie.

    Parameters
    ----------
    views
        Numbers of its views, in order.
    path_enu_m
        Polyline from home on the ground back to it, shape (k, 3).
    photo_vertices
        Vertex of each view.
    duration_s
        From switching on to switching off, take-off and landing included.
    start_s, aircraft
        As of a plan's sortie.
    """

    views: NDArray[np.int64]
    path_enu_m: Array
    photo_vertices: NDArray[np.int64]
    duration_s: float
    start_s: float | None = None
    aircraft: int | None = None

    @property
    def length_m(self) -> float:
        """Length of the path."""
        return float(np.linalg.norm(np.diff(self.path_enu_m, axis=0), axis=1).sum())


@dataclass(frozen=True, slots=True, eq=False)
class FlightTimes:
    """Times between home and views, as solvers want them, and the table the legs are drawn from."""

    table: LegTable
    travel_s: Array
    service_s: Array
    budget_s: float


def flight_times(
    roadmap: Roadmap,
    views: ViewpointArrays,
    aircraft: Aircraft,
    rules: FlightRules,
    monitor: Monitor = QUIET,
    *,
    stop: Stop = never,
    hurry: Stop = never,
    known: LegTable | None = None,
) -> FlightTimes:
    """Travel times (with turns), time at each view, and what one battery allows.

    `stop` and `hurry` as in `build_leg_table`.
    Legs are those of the `known` table, which has all views as stops, where there is one.

    Raises
    ------
    InfeasibleError
        The wind is too strong, or nothing of the battery is left.
    """
    limits = motion_limits(aircraft, rules)
    if known is None:
        metric = round_trip_metric(limits)
        table = build_leg_table(roadmap, views.positions_enu_m, metric, monitor, stop=stop, hurry=hurry)
    else:
        table = known.part(views.positions_enu_m)
    travel_s = with_turns_s(table.cost, views.heading_rad, views.pitch_rad, limits, turn_in_flight=rules.turn_in_flight)
    service_s = np.full(len(views.heading_rad), photo_stop_s(aircraft, rules))
    return FlightTimes(table, travel_s, service_s, usable_battery_s(aircraft, rules))


def plan_flights(
    times: FlightTimes,
    views: ViewpointArrays,
    aircraft: Aircraft,
    rules: FlightRules,
    *,
    seed: int = 0,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> tuple[Flight, ...]:
    """Sorties through all views: as few as possible, then as short as possible; each within battery and file limits.

    Raises
    ------
    InfeasibleError
        A view is too far away for a battery, or cannot be reached.
    """
    budget_s, max_stops = times.budget_s, max(1, aircraft.max_waypoints - 2)
    for _ in range(ATTEMPTS):
        sorties = plan_sorties(
            times.travel_s,
            times.service_s,
            budget_s,
            max_stops,
            seed=seed,
            stop=stop,
            trace=trace,
            monitor=monitor,
        )
        flights = draw_flights(times, sorties, views, aircraft, rules, monitor)
        longest_s = max(flight.duration_s for flight in flights) - rules.takeoff_landing_s
        most_points = max(len(flight.path_enu_m) - 2 for flight in flights)
        if longest_s <= times.budget_s and most_points <= aircraft.max_waypoints:
            return flights
        if longest_s > times.budget_s:
            budget_s *= times.budget_s / longest_s * 0.995
        if most_points > aircraft.max_waypoints:
            max_stops = max(1, int(max_stops * aircraft.max_waypoints / most_points * 0.95))
    raise InfeasibleError.say(
        "the views cannot be shared out so that every sortie fits {}'s battery and waypoint limit; lower "
        "the reserve or the number of views",
        aircraft.name,
    )


def draw_flights(
    times: FlightTimes,
    sorties: Sorties,
    views: ViewpointArrays,
    aircraft: Aircraft,
    rules: FlightRules,
    monitor: Monitor = QUIET,
) -> tuple[Flight, ...]:
    """Polylines and durations of sorties given by the numbers of their views."""
    flights = []
    for number, sortie in enumerate(sorties):
        monitor.report(say("drawing legs"), number, len(sorties))
        flights.append(_draw(times.table, np.array(sortie, np.int64), views, aircraft, rules))
    return tuple(flights)


def reversed_flight(flight: Flight, views: ViewpointArrays, aircraft: Aircraft, rules: FlightRules) -> Flight:
    """The same way flown the other way round."""
    order, vertices = flight.views[::-1], flight.path_enu_m[::-1]
    at_photos = len(vertices) - 1 - flight.photo_vertices[::-1]
    timed = flight_path(vertices, at_photos, views.heading_rad[order], views.pitch_rad[order], aircraft, rules)
    return Flight(order, vertices, at_photos, stopping_duration_s(timed, aircraft, rules))


def _draw(
    table: LegTable, sortie: NDArray[np.int64], views: ViewpointArrays, aircraft: Aircraft, rules: FlightRules
) -> Flight:
    places = np.concatenate([[0], sortie + 1, [0]])
    path, photo_vertices = [table.points_enu_m[:1]], []
    for a, b in itertools.pairwise(places):
        path.append(table.polyline(int(a), int(b))[1:])
        photo_vertices.append(sum(len(part) for part in path) - 1)
    vertices = np.concatenate(path).round(DECIMALS)
    at_photos = np.array(photo_vertices[:-1])
    timed = flight_path(vertices, at_photos, views.heading_rad[sortie], views.pitch_rad[sortie], aircraft, rules)
    return Flight(sortie, vertices, at_photos, stopping_duration_s(timed, aircraft, rules))
