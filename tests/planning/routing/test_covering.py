"""Covering tours against brute force, and the bound on them."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from planning.base.progress import Trace
from planning.coverage.model import Elements
from planning.routing.covering import cover_bound_s, shortest_cover
from planning.viewpoints.budget import CoverGain
from tests.planning.routing_cases import distances

Floats = NDArray[np.float64]
Covers = list[NDArray[np.int32]]


def instance(seed: int, n: int, n_things: int, density: float = 0.35) -> tuple[Floats, Floats, Covers]:
    """Points in a square, service times, and which things each stop collects; every thing is collected somewhere."""
    rng = np.random.default_rng(seed)
    travel_s = distances(rng.random((n + 1, 2)) * 100.0)
    collects = rng.random((n, n_things)) < density
    collects[rng.integers(0, n, n_things), np.arange(n_things)] = True
    return travel_s, rng.uniform(0.0, 20.0, n), [np.flatnonzero(row).astype(np.int32) for row in collects]


def gain_of(covers: Covers, n_things: int) -> CoverGain:
    starts = np.concatenate([[0], np.cumsum([len(items) for items in covers])]).astype(np.int64)
    return CoverGain(Elements(starts, np.concatenate(covers)), np.ones(n_things))


def duration_s(travel_s: Floats, service_s: Floats, route: tuple[int, ...]) -> float:
    places = [0, *(stop + 1 for stop in route), 0]
    return sum(travel_s[a, b] for a, b in itertools.pairwise(places)) + sum(service_s[stop] for stop in route)


def brute_force(travel_s: Floats, service_s: Floats, covers: Covers, n_things: int) -> float:
    """Duration of the shortest route of all that collect everything."""
    best = math.inf
    for size in range(len(covers) + 1):
        for route in itertools.permutations(range(len(covers)), size):
            if set().union(*(covers[stop].tolist() for stop in route)) == set(range(n_things)):
                best = min(best, duration_s(travel_s, service_s, route))
    return best


@pytest.mark.slow
@settings(max_examples=40)
@given(seed=st.integers(0, 10_000), n=st.integers(1, 6), n_things=st.integers(1, 8))
def test_the_route_is_the_shortest_of_all_on_small_instances(seed: int, n: int, n_things: int) -> None:
    travel_s, service_s, covers = instance(seed, n, n_things)
    gain = gain_of(covers, n_things)
    found = shortest_cover(travel_s, service_s, gain, seed=1, max_rounds=200)
    assert found.duration_s == pytest.approx(brute_force(travel_s, service_s, covers, n_things))
    assert found.duration_s == pytest.approx(duration_s(travel_s, service_s, found.route))
    assert gain.value == n_things
    assert cover_bound_s(travel_s, service_s, covers, n_things) <= found.duration_s + 1e-9


def test_the_result_is_never_longer_than_the_route_it_began_with() -> None:
    travel_s, service_s, covers = instance(3, 40, 60)
    everything = tuple(range(40))
    found = shortest_cover(travel_s, service_s, gain_of(covers, 60), everything, max_rounds=0)
    assert found.duration_s < duration_s(travel_s, service_s, everything)
    further = shortest_cover(travel_s, service_s, gain_of(covers, 60), found.route, max_rounds=300)
    assert further.duration_s <= found.duration_s


@pytest.mark.slow
def test_the_trace_falls_and_the_seed_decides_the_result() -> None:
    travel_s, service_s, covers = instance(5, 60, 80, 0.06)
    trace = Trace()
    first = shortest_cover(travel_s, service_s, gain_of(covers, 80), seed=7, max_rounds=300, trace=trace)
    again = shortest_cover(travel_s, service_s, gain_of(covers, 80), seed=7, max_rounds=300)
    values = [point.value for point in trace.points]
    assert first == again
    assert values == sorted(values, reverse=True)
    assert len(values) > 1
    assert values[-1] == first.duration_s


def test_the_bound_is_exact_for_one_stop_and_not_trivial_for_many() -> None:
    travel_s, service_s, covers = instance(2, 1, 3)
    assert cover_bound_s(travel_s, service_s, covers, 3) == pytest.approx(2.0 * travel_s[0, 1] + service_s[0])
    travel_s, service_s, covers = instance(5, 60, 80)
    found = shortest_cover(travel_s, service_s, gain_of(covers, 80), max_rounds=300)
    assert 0.3 * found.duration_s < cover_bound_s(travel_s, service_s, covers, 80) <= found.duration_s


def test_nothing_to_collect_makes_no_stop() -> None:
    nothing = [np.zeros(0, np.int32)] * 3
    travel_s = distances(np.random.default_rng(0).random((4, 2)))
    found = shortest_cover(travel_s, np.ones(3), gain_of(nothing, 2))
    assert found.route == ()
    assert found.duration_s == 0.0
    assert cover_bound_s(travel_s, np.ones(3), nothing, 0) == 0.0


def test_stops_at_one_place_and_without_service_are_no_trouble() -> None:
    covers = [np.array([thing], np.int32) for thing in range(5)]
    found = shortest_cover(np.zeros((6, 6)), np.zeros(5), gain_of(covers, 5), max_rounds=50)
    assert sorted(found.route) == [0, 1, 2, 3, 4]
    assert found.duration_s == 0.0


def test_wrong_service_times_and_missing_ways_are_refused() -> None:
    covers = [np.array([0], np.int32)]
    with pytest.raises(ValueError, match="service_s: expected 1"):
        shortest_cover(np.zeros((2, 2)), np.array([-1.0]), gain_of(covers, 1))
    with pytest.raises(ValueError, match="expected a way"):
        shortest_cover(np.array([[0.0, np.inf], [np.inf, 0.0]]), np.ones(1), gain_of(covers, 1))
