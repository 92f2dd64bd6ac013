"""Tours: the shortest where it can be known, near it where it is published, and what hard input does."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.base.errors import InfeasibleError, OperationCancelled
from planning.base.progress import Trace
from planning.routing import lower_bound, tour
from planning.routing import tour as exact_tour
from planning.routing.tour import improve_tour, nearest_neighbour, tour_bound, tour_length
from planning.routing.tsplib import read_instance
from tests.planning.routing_cases import (
    Cancelling,
    Counting,
    distances,
    random_distances,
    shortest_by_force,
    symmetric_costs,
)
from tests.slow import slow


@given(cost=symmetric_costs(), closed=st.booleans())
def test_few_points_give_the_shortest_tour_or_none_where_there_is_none(cost: np.ndarray, closed: bool) -> None:
    shortest = shortest_by_force(cost, closed)
    given_order = np.arange(len(cost))
    if math.isinf(shortest):
        with pytest.raises(InfeasibleError, match="no tour visits all"):
            improve_tour(cost, given_order, closed=closed)
        return
    order = improve_tour(cost, given_order, closed=closed)
    assert np.array_equal(np.sort(order), given_order)
    assert order[0] == 0
    assert closed or order[-1] == len(cost) - 1
    assert tour_length(cost, order, closed=closed) == shortest
    bound = tour_bound(cost, order, closed=closed)
    assert bound <= shortest
    assert bound >= 0.0


@given(n=st.integers(13, 60), seed=st.integers(0, 100), closed=st.booleans())
@settings(max_examples=30)
def test_no_tour_gets_longer_and_none_is_below_the_bound(n: int, seed: int, closed: bool) -> None:
    cost = random_distances(n, seed, dimensions=3)
    start = np.random.default_rng(seed).permutation(n)
    order = improve_tour(cost, start, closed=closed, max_kicks=200)
    assert np.array_equal(np.sort(order), np.arange(n))
    assert order[0] == start[0]
    assert closed or order[-1] == start[-1]
    length = tour_length(cost, order, closed=closed)
    assert length <= tour_length(cost, start, closed=closed)
    bound = tour_bound(cost, order, closed=closed)
    assert 0.85 * length <= bound <= length * (1.0 + 1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_local_search_finds_what_dynamic_programming_proves(seed: int) -> None:
    # One point more than is solved exactly, twice at the same place: the optimum is that of the points without it.
    points = np.random.default_rng(seed).random((exact_tour.MAX_POINTS, 2))
    shortest = tour_length(distances(points), improve_tour(distances(points), np.arange(len(points))))
    twice = distances(np.concatenate([points, points[:1]]))
    found = tour_length(twice, improve_tour(twice, np.arange(len(twice)), max_kicks=2000))
    assert found == pytest.approx(shortest, rel=1e-12)


def reconnections(order: list[int]) -> list[list[int]]:
    """Every tour that differs from `order` in two or three legs."""
    n = len(order)
    found = []
    for i, j, k in itertools.combinations(range(n + 1), 3):
        a, b, c, d = order[:i], order[i:j], order[j:k], order[k:]
        found += [a + x + y + d for x, y in itertools.product((b, b[::-1]), (c, c[::-1]))]
        found += [a + y + x + d for x, y in itertools.product((b, b[::-1]), (c, c[::-1]))]
    return found


@pytest.mark.parametrize("seed", range(6))
def test_a_descended_tour_is_optimal_among_all_exchanges_of_three_legs(seed: int) -> None:
    # With 13 points every point is a neighbour of every other, so nothing may be missed.
    n = exact_tour.MAX_POINTS + 1
    cost = random_distances(n, seed)
    start = np.random.default_rng(seed).permutation(n)
    order = improve_tour(cost, start, max_kicks=0)
    length = tour_length(cost, order)
    others = [tour_length(cost, np.array(other)) for other in reconnections(order.tolist())]
    assert min(others) >= length - 1e-9


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "optimum"), [("kroA100", 21282), ("lin318", 42029), ("pcb442", 50778), slow("u724", 41910)]
)
def test_published_optima_are_met_within_half_a_percent(shared_data: Path, name: str, optimum: int) -> None:
    cost = read_instance(shared_data / "routing" / "tsplib" / f"{name}.tsp").cost
    start = nearest_neighbour(cost)
    order = improve_tour(cost, start, max_kicks=30_000)
    length = tour_length(cost, order)
    assert optimum <= length <= 1.005 * optimum
    assert tour_length(cost, start) > 1.15 * optimum
    assert 0.98 * optimum <= tour_bound(cost, order) <= optimum


@pytest.mark.slow
@pytest.mark.parametrize("name", ["eil51", "berlin52", "ch130", "a280", "u574"])
def test_every_other_instance_is_met_within_half_a_percent(shared_data: Path, name: str) -> None:
    folder = shared_data / "routing" / "tsplib"
    lines = (folder / "solutions").read_text().splitlines()
    optimum = int(next(line.split(":")[1] for line in lines if line.split(":")[0].strip() == name))
    cost = read_instance(folder / f"{name}.tsp").cost
    length = tour_length(cost, improve_tour(cost, nearest_neighbour(cost), max_kicks=100_000))
    assert optimum <= length <= 1.005 * optimum


def test_the_same_seed_and_kicks_give_the_same_tour() -> None:
    cost = random_distances(400)
    start = np.arange(400)
    first = improve_tour(cost, start, seed=3, max_kicks=1000)
    assert np.array_equal(first, improve_tour(cost, start, seed=3, max_kicks=1000))
    assert not np.array_equal(first, improve_tour(cost, start, seed=4, max_kicks=1000))


def test_slices_of_kicks_make_no_difference() -> None:
    cost = random_distances(150)
    whole = tour._LocalSearch(cost, np.arange(150), True, 0, tour.QUIET)
    sliced = tour._LocalSearch(cost, np.arange(150), True, 0, tour.QUIET)
    last = whole.kick(2000)
    found = [(done, sliced.kick(size)) for done, size in ((0, 1), (1, 7), (8, 992), (1000, 1000))]
    assert np.array_equal(whole.tour, sliced.tour)
    assert max(done + success for done, success in found if success) == last


def test_stopped_at_once_the_tour_is_descended_all_the_same() -> None:
    cost = random_distances(300)
    start = nearest_neighbour(cost)
    order = improve_tour(cost, start, stop=lambda: True)
    assert np.array_equal(order, improve_tour(cost, start, max_kicks=0))
    assert tour_length(cost, order) < 0.95 * tour_length(cost, start)


def test_a_target_ends_the_search() -> None:
    cost = random_distances(100)
    target = 1.05 * tour_length(cost, improve_tour(cost, np.arange(100), max_kicks=2000))
    stop = Counting(1000)
    assert tour_length(cost, improve_tour(cost, np.arange(100), target_length=target, stop=stop)) <= target
    assert stop.left > 900


def test_cancelling_comes_through() -> None:
    with pytest.raises(OperationCancelled):
        improve_tour(random_distances(200), np.arange(200), monitor=Cancelling(3, OperationCancelled))


def test_the_trace_falls_and_ends_with_the_result() -> None:
    cost = random_distances(200)
    trace = Trace()
    order = improve_tour(cost, np.arange(200), max_kicks=5000, trace=trace)
    values = [point.value for point in trace.points]
    assert values == sorted(values, reverse=True)
    assert values[0] == tour_length(cost, np.arange(200))
    assert values[-1] == tour_length(cost, order)
    assert len(values) > 3


def test_points_at_the_same_place_cost_nothing() -> None:
    cost = np.zeros((40, 40))
    assert tour_length(cost, improve_tour(cost, np.arange(40), max_kicks=500)) == 0.0
    assert tour_bound(cost, np.arange(40)) == 0.0


def test_many_photos_at_few_spots_are_visited_spot_by_spot() -> None:
    # 20 at each of 15 spots: all nearest neighbours of a point lie at its own spot.
    spots = np.random.default_rng(1).random((15, 2))
    shortest = tour_length(distances(spots), improve_tour(distances(spots), np.arange(15)))
    cost = distances(np.repeat(spots, 20, axis=0))
    start = np.random.default_rng(2).permutation(300)
    assert tour_length(cost, improve_tour(cost, start, max_kicks=5000)) == pytest.approx(shortest, rel=0.02)


def ring(n: int, seed: int) -> np.ndarray:
    """Costs with hardly more legs than one hidden tour needs; all others are missing."""
    rng = np.random.default_rng(seed)
    cost = np.full((n, n), np.inf)
    hidden = rng.permutation(n)
    chords = rng.integers(0, n, (n // 2, 2))
    for a, b in [*zip(hidden, np.roll(hidden, 1), strict=True), *chords]:
        cost[a, b] = cost[b, a] = rng.random()
    return cost


@pytest.mark.few(1)
@pytest.mark.parametrize("n", [13, 40, 120])
def test_missing_legs_are_avoided_where_a_tour_without_them_is_hidden(n: int) -> None:
    cost = ring(n, seed=n)
    start = nearest_neighbour(cost)
    order = improve_tour(cost, start, max_kicks=50_000)
    assert math.isfinite(tour_length(cost, order))


def test_a_point_without_a_way_to_it_is_named() -> None:
    cost = random_distances(20)
    cost[7, :] = cost[:, 7] = np.inf
    with pytest.raises(InfeasibleError, match="no way from point 0 to point 7"):
        improve_tour(cost, np.arange(20))


def test_a_dead_end_is_named() -> None:
    cost = random_distances(20)
    cost[7, :] = cost[:, 7] = np.inf
    cost[7, 3] = cost[3, 7] = 1.0
    with pytest.raises(InfeasibleError, match="only one leg at point 7"):
        improve_tour(cost, np.arange(20))
    path = np.array([7, *range(7), *range(8, 20)])
    assert improve_tour(cost, path, closed=False, max_kicks=500)[1] == 3


def test_no_tour_through_a_bottleneck_is_reported() -> None:
    # Triangles that share point 0 only: connected, two legs everywhere, but no tour.
    cost = np.full((21, 21), np.inf)
    for a in range(1, 21, 2):
        for i, j in ((0, a), (0, a + 1), (a, a + 1)):
            cost[i, j] = cost[j, i] = 1.0
    with pytest.raises(InfeasibleError, match="none was found"):
        improve_tour(cost, np.arange(21), max_kicks=2000)


@pytest.mark.parametrize("scale", [1e-9, 1e9])
def test_the_unit_of_cost_makes_no_difference(scale: float) -> None:
    cost = np.round(random_distances(100))
    start = np.arange(100)
    order = improve_tour(cost, start, max_kicks=3000)
    scaled = improve_tour(cost * scale, start, max_kicks=3000)
    assert tour_length(cost, scaled) == pytest.approx(tour_length(cost, order), rel=0.01)
    bound = tour_bound(cost * scale, scaled)
    assert bound == pytest.approx(scale * tour_bound(cost, order), rel=0.01)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ((0, 1, np.nan), "the leg from 0 to 1 is NaN"),
        ((0, 1, -1.0), "the leg from 0 to 1 has -1"),
        ((0, 1, 1e-3), "same cost in both directions"),
    ],
)
def test_wrong_costs_are_refused(change: tuple[int, int, float], message: str) -> None:
    cost = random_distances(20)
    i, j, value = change
    cost[i, j] = value
    with pytest.raises(ValueError, match=message):
        improve_tour(cost, np.arange(20))


def test_rounding_between_the_two_directions_is_allowed() -> None:
    cost = random_distances(20)
    cost[3, 4] *= 1.0 + 1e-12
    assert len(improve_tour(cost, np.arange(20), max_kicks=10)) == 20


@pytest.mark.parametrize("order", [[0, 1, 1], [0, 1], [1, 2, 3]])
def test_an_order_that_is_no_permutation_is_refused(order: list[int]) -> None:
    with pytest.raises(ValueError, match="expected a permutation of 3 points"):
        improve_tour(random_distances(3), np.array(order))


@given(n=st.integers(1, 12), seed=st.integers(0, 50))
def test_the_nearest_neighbour_is_always_the_nearest(n: int, seed: int) -> None:
    cost = random_distances(n, seed)
    order = nearest_neighbour(cost, start=n - 1).tolist()
    assert sorted(order) == list(range(n))
    assert order[0] == n - 1
    for at in range(1, n):
        assert cost[order[at - 1], order[at]] == min(cost[order[at - 1], j] for j in order[at:])
    if n > 1:
        assert nearest_neighbour(cost, end=n - 1)[-1] == n - 1


@given(n=st.integers(1, 8), seed=st.integers(0, 100))
@settings(max_examples=30)
def test_dynamic_programming_agrees_with_trying_every_order(n: int, seed: int) -> None:
    cost = np.random.default_rng(seed).random((n, n))  # asymmetric
    order = exact_tour.exact_tour(cost)
    assert np.array_equal(np.sort(order), np.arange(n))
    shortest = shortest_by_force(cost, closed=True) if n > 1 else cost[0, 0]
    assert tour_length(cost, order) + (cost[0, 0] if n == 1 else 0.0) == pytest.approx(shortest)


def test_the_bound_of_a_ring_is_its_length() -> None:
    angle = np.linspace(0.0, 2.0 * math.pi, 30, endpoint=False)
    cost = distances(np.stack([np.cos(angle), np.sin(angle)], axis=1))
    circumference = 60.0 * math.sin(math.pi / 30.0)
    assert lower_bound.held_karp_bound(cost, 1.2 * circumference) == pytest.approx(circumference, rel=1e-3)


def test_the_bound_holds_however_early_it_is_stopped() -> None:
    cost = random_distances(100)
    length = tour_length(cost, improve_tour(cost, np.arange(100), max_kicks=3000))
    bounds = [lower_bound.held_karp_bound(cost, length, max_rounds=n) for n in (1, 3, 10, 100, 1000)]
    assert bounds == sorted(bounds)
    assert bounds[-1] <= length
    assert bounds[-1] > 0.97 * length
    assert lower_bound.held_karp_bound(cost, length, stop=lambda: True) == bounds[0]
