"""From views to flights: everything flown once, in time by an independent integrator, within battery and waypoints."""

from __future__ import annotations

import functools
import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from planning.aircraft.catalogue import profile
from planning.base.errors import InfeasibleError, OperationCancelled
from planning.base.progress import TimeLimit
from planning.parameters import FlightRules
from planning.plan import Aircraft, ViewpointArrays
from planning.routing.flights import Flight, flight_times, plan_flights
from planning.routing.roadmap import Roadmap, build_roadmap
from planning.site.free_space import free_space
from tests.planning.plan_cases import dense_points, distances, kiosk, solid_triangles

Floats = NDArray[np.float64]

M3E = replace(profile("m3e").aircraft, max_jerk_m_s3=None)
DISTANCE_M = 5.0


@functools.cache
def roadmap() -> Roadmap:
    return build_roadmap(free_space(kiosk(), DISTANCE_M))


def some_views(n: int, seed: int = 0) -> ViewpointArrays:
    space, rng = roadmap().space, np.random.default_rng(seed)
    points = rng.uniform(space.low_enu_m, [40.0, 40.0, 25.0], (20 * n, 3)).round(4)
    points = points[space.is_allowed(points)][:n]
    points = points[roadmap().connected_to_home(points)]
    assert len(points) == n
    return ViewpointArrays(points, rng.uniform(-math.pi, math.pi, n), rng.uniform(-1.5, 0.6, n))


def fly(
    views: ViewpointArrays, aircraft: Aircraft = M3E, rules: FlightRules = FlightRules(), seconds: float = 1.0
) -> tuple[Flight, ...]:
    times = flight_times(roadmap(), views, aircraft, rules)
    return plan_flights(times, views, aircraft, rules, stop=TimeLimit(seconds))


def leg_by_steps_s(delta: Floats, aircraft: Aircraft, rules: FlightRules, n_steps: int = 4000) -> float:
    """Time over one leg from rest to rest: the speed that is reached at every point, from either end, summed up."""
    length = float(np.linalg.norm(delta))
    if length == 0.0:
        return 0.0
    level, up = float(np.hypot(*delta[:2])) / length, float(delta[2]) / length
    cap = rules.max_speed_m_s or math.inf
    fastest = math.inf
    if level > 0.0:
        fastest = min(aircraft.max_speed_m_s - rules.wind_m_s, cap) / level
    if up > 0.0:
        fastest = min(fastest, min(aircraft.max_ascent_m_s, cap) / up)
    if up < 0.0:
        fastest = min(fastest, min(aircraft.max_descent_m_s, cap) / -up)
    at = np.linspace(0.0, length, n_steps + 1)
    reached = np.sqrt(2.0 * aircraft.max_acceleration_m_s2 * np.minimum(at, length - at))
    speed = np.minimum(reached, fastest)
    return float((2.0 * np.diff(at) / (speed[:-1] + speed[1:])).sum())


def duration_by_steps_s(flight: Flight, views: ViewpointArrays, aircraft: Aircraft, rules: FlightRules) -> float:
    """Take-off and landing, all legs, and at each photo the turn, the settling and the shutter."""
    t = rules.takeoff_landing_s
    heading, pitch = None, 0.0
    for number, delta in enumerate(np.diff(flight.path_enu_m, axis=0), 1):
        t += leg_by_steps_s(delta, aircraft, rules)
        if number in flight.photo_vertices:
            view = flight.views[list(flight.photo_vertices).index(number)]
            turn = math.pi if heading is None else abs(math.remainder(views.heading_rad[view] - heading, 2 * math.pi))
            tilt = abs(float(views.pitch_rad[view]) - pitch)
            t += max(
                turn / math.radians(aircraft.max_yaw_rate_deg_s), tilt / math.radians(aircraft.max_gimbal_rate_deg_s)
            )
            t += max(rules.settle_s + rules.photo_s, aircraft.min_photo_interval_s)
            heading, pitch = float(views.heading_rad[view]), float(views.pitch_rad[view])
    return t


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "rules",
    [FlightRules(), FlightRules(max_speed_m_s=3.0, wind_m_s=5.0), FlightRules(settle_s=0.0, photo_s=0.1)],
    ids=["usual", "slow in wind", "hasty"],
)
def test_durations_are_those_of_an_independent_integrator(rules: FlightRules) -> None:
    views = some_views(7)
    for flight in fly(views, rules=rules):
        expected = duration_by_steps_s(flight, views, M3E, rules)
        assert flight.duration_s == pytest.approx(expected, rel=1e-3)


def test_every_view_is_flown_once_from_home_to_home_and_every_leg_is_clear() -> None:
    views, triangles = some_views(12, seed=1), solid_triangles(kiosk())
    flights = fly(views)
    assert sorted(np.concatenate([flight.views for flight in flights])) == list(range(12))
    for flight in flights:
        path = flight.path_enu_m
        np.testing.assert_array_equal(path[[0, -1]], np.array([kiosk().site.home_enu_m] * 2))
        np.testing.assert_array_equal(path[flight.photo_vertices], views.positions_enu_m[flight.views])
        assert (np.diff(flight.photo_vertices) > 0).all()
        assert flight.length_m == pytest.approx(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
        np.testing.assert_array_equal(path, path.round(4))
        assert distances(dense_points(path, 0.25), triangles).min() >= DISTANCE_M


def test_views_at_one_place_each_have_a_vertex_and_cost_no_way() -> None:
    one = some_views(1)
    three = ViewpointArrays(
        np.repeat(one.positions_enu_m, 3, axis=0), np.radians([10.0, 70.0, 130.0]), np.radians([-30.0, -30.0, -30.0])
    )
    (flight,), (alone,) = fly(three), fly(one)
    assert len(set(flight.photo_vertices.tolist())) == 3
    assert flight.length_m == pytest.approx(alone.length_m)
    stop_s = 3.0
    assert flight.duration_s == pytest.approx(alone.duration_s + 2 * stop_s + 2 * 1.0, abs=0.6)


@pytest.mark.long
def test_sorties_fit_into_the_battery_and_there_are_no_more_than_needed() -> None:
    views = some_views(14, seed=2)
    together = sum(flight.duration_s for flight in fly(views))
    for parts in (1.4, 1.8):
        rules = FlightRules(battery_reserve=1.0 - together / parts / M3E.endurance_s)
        flights = fly(views, rules=rules)
        usable_s = M3E.endurance_s * (1.0 - rules.battery_reserve)
        assert max(flight.duration_s for flight in flights) <= usable_s + 1e-6
        assert math.ceil(together / usable_s) <= len(flights) <= 3


@pytest.mark.parametrize("max_waypoints", [8, 12])
def test_sorties_keep_the_waypoint_limit_with_all_vertices_counted(max_waypoints: int) -> None:
    aircraft = replace(M3E, max_waypoints=max_waypoints)
    flights = fly(some_views(14, seed=3), aircraft)
    assert len(flights) >= 2
    assert max(len(flight.path_enu_m) - 2 for flight in flights) <= max_waypoints


def test_what_no_sortie_can_do_is_refused_with_the_reason() -> None:
    views = some_views(3, seed=4)
    with pytest.raises(InfeasibleError, match=r"viewpoint \d takes .* s on a sortie of its own, but a battery allows"):
        fly(views, rules=FlightRules(battery_reserve=0.98))
    with pytest.raises(InfeasibleError, match="cannot be shared out so that every sortie fits DJI M3E's battery and"):
        fly(views, replace(M3E, max_waypoints=1))


def test_table_and_flown_times_differ_little() -> None:
    """What the solver adds up is what comes out; but ways around are pulled tight, and up and down are averaged."""
    views = some_views(14, seed=5)
    rules = FlightRules()
    times = flight_times(roadmap(), views, M3E, rules)
    for flight in plan_flights(times, views, M3E, rules, stop=TimeLimit(1.0)):
        places = np.concatenate([[0], flight.views + 1, [0]])
        summed = times.travel_s[places[:-1], places[1:]].sum() + times.service_s[flight.views].sum()
        assert flight.duration_s - rules.takeoff_landing_s <= summed * 1.01
        assert flight.duration_s - rules.takeoff_landing_s >= summed * 0.93


def test_cancelling_comes_through() -> None:
    class Cancelling:
        def report(self, stage: str, done: float, total: float) -> None:
            raise OperationCancelled("cancelled")

    views = some_views(4)
    times = flight_times(roadmap(), views, M3E, FlightRules())
    with pytest.raises(OperationCancelled):
        flight_times(roadmap(), views, M3E, FlightRules(), Cancelling())
    with pytest.raises(OperationCancelled):
        plan_flights(times, views, M3E, FlightRules(), monitor=Cancelling())
