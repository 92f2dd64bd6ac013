"""Steps on single routes, against trying everything."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.routing.insertion import insertion_costs, insertion_costs_with, shorten
from tests.planning.routing_cases import random_distances


def cost_of(travel: np.ndarray, route: list[int]) -> float:
    if not route:
        return 0.0
    return float(sum(travel[a, b] for a, b in itertools.pairwise([0, *route, 0])))


@given(n=st.integers(1, 8), k=st.integers(0, 7), seed=st.integers(0, 1000))
def test_insertion_is_as_cheap_as_the_best_of_all_positions(n: int, k: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    travel = rng.random((n + 1, n + 1))
    route = rng.permutation(n)[: min(k, n - 1)] + 1
    added, position = np.zeros(n + 1), np.zeros(n + 1, np.int64)
    insertion_costs(travel, route, added, position)
    for place in set(range(1, n + 1)) - set(route.tolist()):
        longer = [np.insert(route, at, place).tolist() for at in range(len(route) + 1)]
        costs = [cost_of(travel, option) - cost_of(travel, route.tolist()) for option in longer]
        assert added[place] == pytest.approx(min(costs))
        assert costs[position[place]] == pytest.approx(min(costs))


@given(n=st.integers(1, 12), seed=st.integers(0, 1000), are_equal=st.booleans(), has_gaps=st.booleans())
def test_costs_after_a_stop_was_put_in_are_those_found_anew(n: int, seed: int, are_equal: bool, has_gaps: bool) -> None:
    rng = np.random.default_rng(seed)
    travel = rng.integers(0, 4, (n + 1, n + 1)).astype(float) if are_equal else rng.random((n + 1, n + 1))
    if has_gaps:
        travel[rng.random(travel.shape) < 0.2] = np.inf
    route, added, position = np.zeros(0, np.int64), np.zeros(n + 1), np.zeros(n + 1, np.int64)
    insertion_costs(travel, route, added, position)
    for place in rng.permutation(n) + 1:
        last = int(rng.integers(len(route) + 1))
        route = np.insert(route, last, place)
        insertion_costs_with(travel, route, last, added, position)
        anew, there = np.zeros(n + 1), np.zeros(n + 1, np.int64)
        insertion_costs(travel, route, anew, there)
        assert np.array_equal(added[1:], anew[1:])
        is_possible = np.isfinite(anew)
        assert np.array_equal(position[is_possible], there[is_possible])


def neighbours(route: list[int]) -> list[list[int]]:
    """Routes with one stretch reversed, or one stretch of up to three stops moved or moved and turned round."""
    k = len(route)
    found = [route[:i] + route[i:j][::-1] + route[j:] for i, j in itertools.combinations(range(k + 1), 2)]
    for i, j in itertools.combinations(range(k + 1), 2):
        if j - i <= 3:
            rest, stretch = route[:i] + route[j:], route[i:j]
            found += [rest[:at] + part + rest[at:] for at in range(len(rest) + 1) for part in (stretch, stretch[::-1])]
    return found


@given(k=st.integers(1, 9), seed=st.integers(0, 1000), flat=st.booleans())
def test_a_shortened_route_cannot_be_shortened_by_a_single_move(k: int, seed: int, flat: bool) -> None:
    rng = np.random.default_rng(seed)
    travel = random_distances(k + 1, seed) if flat else rng.random((k + 1, k + 1))
    start = (rng.permutation(k) + 1).tolist()
    route = np.array(start)
    shorten(travel, route, 1e-12)
    assert sorted(route.tolist()) == sorted(start)
    length = cost_of(travel, route.tolist())
    assert length <= cost_of(travel, start) + 1e-12
    assert min(cost_of(travel, other) for other in neighbours(route.tolist())) >= length - 1e-9


def test_equal_costs_do_not_keep_it_busy() -> None:
    route = np.arange(1, 40)
    shorten(np.zeros((40, 40)), route, 0.0)
    assert route.tolist() == list(range(1, 40))


def test_missing_legs_are_not_moved_into() -> None:
    travel = random_distances(12)
    travel[4, 7] = travel[7, 4] = np.inf
    route = np.array([1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11])
    shorten(travel, route, 1e-12)
    assert np.isfinite(cost_of(travel, route.tolist()))
