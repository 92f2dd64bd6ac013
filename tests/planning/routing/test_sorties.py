"""Sorties: the fewest and shortest where trying everything can tell, known best ones otherwise, and limits kept."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.base.errors import InfeasibleError, OperationCancelled
from planning.base.progress import QUIET, Trace
from planning.routing import string_removal
from planning.routing.sorties import (
    SortieProblem,
    _limits,
    _shortest_ways,
    _Solver,
    fewest_sorties,
    plan_sorties,
    solve_sorties,
    sortie_durations_s,
)
from planning.routing.tsplib import read_instance
from tests.planning.routing_cases import Cancelling, Counting, distances, fewest_by_force, random_distances
from tests.slow import slow


def facade_problem(n: int, budget_s: float, seed: int = 0) -> SortieProblem:
    """Photos in front of a facade of 120 x 40 m, flown from rest to rest at up to 5 m/s; climbing takes longer."""
    rng = np.random.default_rng(seed)
    points = np.concatenate([np.zeros((1, 3)), rng.random((n, 3)) * [120.0, 20.0, 40.0] + [-60.0, 15.0, 2.0]])
    travel_s = 2.0 + distances(points) / 5.0 + 0.1 * np.maximum(points[:, 2] - points[:, 2, None], 0.0)
    np.fill_diagonal(travel_s, 0.0)
    return SortieProblem(travel_s, rng.uniform(3.0, 6.0, n), budget_s, np.ones(n), math.inf)


def check(problem: SortieProblem, sorties: tuple[tuple[int, ...], ...]) -> float:
    """Total duration of sorties that keep every limit."""
    assert sorted(itertools.chain(*sorties)) == list(range(problem.n_stops))
    assert all(sorties)
    durations = sortie_durations_s(problem, sorties)
    assert max(durations) <= problem.budget_s * (1.0 + 1e-9)
    assert all(problem.load[list(sortie)].sum() <= problem.capacity for sortie in sorties)
    assert len(sorties) >= fewest_sorties(problem)
    return math.fsum(durations)


@pytest.mark.slow
@given(
    n=st.integers(1, 6),
    seed=st.integers(0, 10_000),
    budget=st.integers(10, 40),
    max_stops=st.integers(1, 6),
    flat=st.booleans(),
)
@settings(max_examples=60)
def test_few_stops_are_shared_out_as_trying_everything_does(
    n: int, seed: int, budget: int, max_stops: int, flat: bool
) -> None:
    rng = np.random.default_rng(seed)
    travel_s = np.round(distances(rng.random((n + 1, 2)) * 10.0))
    if not flat:
        travel_s += rng.integers(0, 4, travel_s.shape)
        np.fill_diagonal(travel_s, 0.0)
    travel_s = _shortest_ways(travel_s)
    service_s = rng.integers(0, 4, n).astype(float)
    best = fewest_by_force(travel_s, service_s, float(budget), max_stops)
    if best is None:
        with pytest.raises(InfeasibleError, match="on a sortie of its own"):
            plan_sorties(travel_s, service_s, float(budget), max_stops)
        return
    problem = SortieProblem(travel_s, service_s, float(budget), np.ones(n), max_stops)
    sorties = plan_sorties(travel_s, service_s, float(budget), max_stops)
    assert (len(sorties), check(problem, sorties)) == best
    assert fewest_sorties(problem) <= best[0]


@given(n=st.integers(1, 7), seed=st.integers(0, 1000), fewest_first=st.booleans())
@settings(max_examples=40)
def test_a_tour_is_cut_where_trying_every_cut_would_cut_it(n: int, seed: int, fewest_first: bool) -> None:
    rng = np.random.default_rng(seed)
    problem = SortieProblem(
        rng.integers(1, 9, (n + 1, n + 1)).astype(float),
        rng.integers(0, 4, n).astype(float),
        25.0,
        np.ones(n),
        3.0,
        fewest_first,
    )
    order = rng.permutation(n)
    options = []
    for cuts in itertools.product([False, True], repeat=n - 1):
        parts, begin = [], 0
        for at, is_cut in enumerate([*cuts, True], 1):
            if is_cut:
                parts.append(tuple(order[begin:at].tolist()))
                begin = at
        durations = sortie_durations_s(problem, tuple(parts))
        if max(durations) <= 25.0 and max(map(len, parts)) <= 3:
            options.append((len(parts) if fewest_first else 0, sum(durations)))
    solver = _Solver(problem, 0, lambda: True, Trace(), QUIET)
    cut = solver._cut(order + 1)
    assert tuple(itertools.chain(*cut)) == tuple(order)
    assert (len(cut) if fewest_first else 0, sum(sortie_durations_s(problem, cut))) == min(options)


@pytest.mark.parametrize(("n", "budget_s"), [(60, 300.0), slow(150, 600.0)])
def test_sorties_keep_the_battery_and_hardly_need_more_than_the_proven_fewest(n: int, budget_s: float) -> None:
    problem = facade_problem(n, budget_s)
    sorties = solve_sorties(problem, max_rounds=10_000)
    check(problem, sorties)
    assert fewest_sorties(problem) <= len(sorties) <= fewest_sorties(problem) + 1


@pytest.mark.slow
@pytest.mark.parametrize(("name", "best_known"), [("X-n101-k25", 27591), slow("X-n157-k13", 16876)])
def test_published_best_routes_are_met_within_one_percent(shared_data: Path, name: str, best_known: int) -> None:
    instance = read_instance(shared_data / "routing" / "cvrp_x" / f"{name}.vrp")
    assert f"Cost {best_known}" in (shared_data / "routing" / "cvrp_x" / f"{name}.sol").read_text()
    assert instance.demand is not None
    assert instance.capacity is not None
    n = len(instance.ids) - 1
    problem = SortieProblem(
        instance.cost, np.zeros(n), math.inf, instance.demand[1:], instance.capacity, fewest_first=False
    )
    total = check(problem, solve_sorties(problem, max_rounds=150_000))
    assert best_known <= total <= 1.01 * best_known


def test_a_sortie_less_is_flown_even_if_that_takes_longer() -> None:
    # Three stops around home, 3 away from it and 5.2 from each other: alone 6 s each, together 16.4 s.
    angle = np.radians([0.0, 120.0, 240.0])
    points = np.concatenate([np.zeros((1, 2)), 3.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1)])
    travel_s = distances(points) + 0.5 * (1.0 - np.eye(4)) * (np.arange(4) > 0)[:, None] * (np.arange(4) > 0)
    fewest = SortieProblem(travel_s, np.zeros(3), 20.0, np.ones(3), 3.0)
    assert [len(sortie) for sortie in solve_sorties(fewest)] == [3]
    assert len(solve_sorties(SortieProblem(travel_s, np.zeros(3), 20.0, np.ones(3), 1.0))) == 3


def test_fewer_sorties_are_found_than_cutting_one_tour_gives() -> None:
    # Services of 6, 6, 6 and 4, 4, 4 at one spot fill sorties of 10 in pairs of 6 and 4 only; a tour mixes them up.
    service_s = np.array([6.0, 6.0, 6.0, 4.0, 4.0, 4.0])
    problem = SortieProblem(np.zeros((7, 7)), service_s, 10.0, np.ones(6), math.inf)
    assert len(solve_sorties(problem)) == 3 == fewest_sorties(problem)


def test_a_viewpoint_too_far_away_is_named_with_its_time_and_the_budget() -> None:
    travel_s = random_distances(5)
    travel_s[0, 3] = travel_s[3, 0] = 500.0
    names = ["v0000", "v0001", "v0002", "v0003"]
    message = r"viewpoint v0002 takes 1004\.5 s on a sortie of its own, but a battery allows 900\.0 s"
    with pytest.raises(InfeasibleError, match=message):
        plan_sorties(travel_s, np.full(4, 4.5), 900.0, names=names)


def test_a_viewpoint_that_cannot_be_reached_is_named() -> None:
    travel_s = random_distances(4)
    travel_s[0, 2] = np.inf
    with pytest.raises(InfeasibleError, match="viewpoint 1 cannot be reached from home"):
        plan_sorties(travel_s, np.zeros(3), 900.0)


def test_missing_legs_between_stops_are_not_flown() -> None:
    # Two groups with no way between them but by home.
    travel_s = np.full((21, 21), np.inf)
    travel_s[:11, :11] = random_distances(11, 1)
    far = random_distances(11, 2)
    travel_s[11:, 11:] = far[1:, 1:]
    travel_s[0, 11:] = travel_s[11:, 0] = far[0, 1:]
    problem = SortieProblem(travel_s, np.ones(20), 1000.0, np.ones(20), math.inf)
    sorties = solve_sorties(problem, max_rounds=20_000)
    assert math.isfinite(check(problem, sorties))
    assert [sorted(sortie) for sortie in sorted(sorties)] in ([[*range(10)], [*range(10, 20)]],)


@pytest.mark.few(1)
@pytest.mark.parametrize("max_stops", [1, 7, 30])
def test_no_sortie_has_more_stops_than_allowed(max_stops: int) -> None:
    problem = facade_problem(30, 2000.0)
    sorties = plan_sorties(problem.travel_s, problem.service_s, 2000.0, max_stops, max_rounds=5000)
    assert max(map(len, sorties)) <= max_stops
    assert len(sorties) == math.ceil(30 / max_stops)


def test_nothing_to_visit_needs_no_sortie() -> None:
    assert plan_sorties(np.zeros((1, 1)), np.zeros(0), 100.0) == ()
    assert plan_sorties(np.zeros((2, 2)), np.zeros(1), 100.0) == ((0,),)


def test_stops_at_one_place_are_shared_out_by_their_service() -> None:
    sorties = plan_sorties(np.zeros((51, 51)), np.full(50, 2.0), 20.0, max_rounds=5000)
    assert len(sorties) == 5


@pytest.mark.slow
def test_the_same_seed_and_rounds_give_the_same_sorties() -> None:
    problem = facade_problem(60, 300.0)
    first = solve_sorties(problem, seed=5, max_rounds=20_000)
    assert first == solve_sorties(problem, seed=5, max_rounds=20_000)


@pytest.mark.slow
def test_stopped_at_once_the_sorties_keep_their_limits_all_the_same() -> None:
    problem = facade_problem(100, 400.0)
    early = check(problem, solve_sorties(problem, stop=lambda: True))
    late = check(problem, solve_sorties(problem, stop=Counting(60)))
    assert late <= early


def test_cancelling_comes_through() -> None:
    for n_reports in (1, 30):
        with pytest.raises(OperationCancelled):
            solve_sorties(facade_problem(60, 300.0), monitor=Cancelling(n_reports, OperationCancelled))


@pytest.mark.slow
def test_the_trace_ends_with_the_result() -> None:
    problem = facade_problem(60, 300.0)
    trace = Trace()
    sorties = solve_sorties(problem, max_rounds=20_000, trace=trace)
    assert trace.points[-1].value == math.fsum(sortie_durations_s(problem, sorties))
    assert trace.points[-1].value <= trace.points[0].value


def test_durations_kept_by_adding_differences_match_summing_up() -> None:
    problem = facade_problem(40, math.inf)
    limits = _limits(problem)
    routes, rng = string_removal.empty_routes(40, 3), np.random.default_rng(0)
    for _ in range(3000):
        stop = int(rng.integers(1, 41))
        if routes.sortie[stop] >= 0:
            string_removal.remove(limits, routes, stop)
        else:
            places = [*range(41, 44), *(place for place in range(1, 41) if routes.sortie[place] >= 0)]
            string_removal.insert(limits, routes, stop, int(rng.choice(places)))
    kept = routes.duration.copy(), routes.load.copy()
    string_removal.recompute(limits, routes)
    np.testing.assert_allclose(routes.duration, kept[0], rtol=1e-11)
    np.testing.assert_allclose(routes.load, kept[1], rtol=1e-11)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"budget_s": 0.0}, "budget_s: expected more than 0"),
        ({"budget_s": math.nan}, "budget_s: expected more than 0"),
        ({"service_s": np.array([1.0, -1.0])}, "service_s: expected 2 finite numbers"),
        ({"service_s": np.zeros(3)}, "service_s: expected 2 finite numbers"),
        ({"travel_s": np.full((3, 3), np.nan)}, "is NaN"),
        ({"capacity": 0.0}, "capacity: expected more than 0"),
    ],
)
def test_wrong_arguments_are_refused(change: dict[str, object], message: str) -> None:
    arguments: dict[str, object] = {
        "travel_s": np.ones((3, 3)),
        "service_s": np.ones(2),
        "budget_s": 10.0,
        "load": np.ones(2),
        "capacity": 2.0,
    }
    with pytest.raises(ValueError, match=message):
        SortieProblem(**{**arguments, **change})  # type: ignore[arg-type]
