"""Sorties through the views of a plan: ours against the nearest neighbour and PyVRP."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pyvrp

from planning.aircraft.catalogue import profile
from planning.base.progress import QUIET, Monitor, Stop, TimeLimit, Trace, never
from planning.parameters import FlightRules
from planning.planner import as_written
from planning.routing.flights import flight_times
from planning.routing.sorties import SortieProblem, Sorties, plan_sorties, solve_sorties, sortie_durations_s
from planning.routing.vrp import _problem_data, _recorder, _run, _scale, _visits
from planning.viewpoints.greedy import greedy
from tests.benchmarks.harness import Benchmark, Context, Row, timer
from tests.benchmarks.problems import PLANAR_VIEWS, choose, prepared


def measure(context: Context) -> Iterator[Row]:
    """Number of sorties and time in the air of each method, in the same time."""
    seconds = 2.0 if context.is_quick else 8.0
    problem, aircraft = prepared("office").problem, profile("m3e").aircraft
    views = as_written(problem, choose(greedy, problem, PLANAR_VIEWS, 0)[0])
    with timer() as elapsed:
        times = flight_times(problem.roadmap, views, aircraft, FlightRules())
    n = len(views.heading_rad)
    yield Row("office", f"table of legs around the building, {n} views", elapsed(), "s")
    asked = SortieProblem(times.travel_s, times.service_s, times.budget_s, np.ones(n), math.inf)
    greedy_s, n_greedy = _total_s(asked, nearest_sorties(asked)), len(nearest_sorties(asked))
    yield Row("office", f"nearest neighbour: {n_greedy} sorties", greedy_s / 60.0, "min")
    limits = (0.3, 1.0, seconds) if not context.is_quick else (seconds,)
    ours: Sorties = ()
    for limit in limits:
        ours = plan_sorties(times.travel_s, times.service_s, times.budget_s, stop=TimeLimit(limit))
        total = _total_s(asked, ours)
        what = f"ours, {limit:g} s: {len(ours)} sorties"
        yield Row("office", what, total / 60.0, "min", total / greedy_s, "nearest neighbour")
    start = solve_sorties(asked, max_rounds=0, stop=lambda: True)
    for is_warm in (True, False):
        found = improve_sorties(asked, start, warm=is_warm, stop=TimeLimit(seconds))
        total = _total_s(asked, found)
        what = f"PyVRP {'from a 3-opt tour' if is_warm else 'from its own'}, {seconds:g} s: {len(found)} sorties"
        yield Row("office", what, total / 60.0, "min", total / _total_s(asked, ours), "ours")


def _total_s(problem: SortieProblem, sorties: Sorties) -> float:
    return math.fsum(sortie_durations_s(problem, sorties))


def nearest_sorties(problem: SortieProblem) -> Sorties:
    """Always on to the nearest stop from which home can still be reached; else home, and out again."""
    left = set(range(1, problem.n_stops + 1))
    sorties: list[tuple[int, ...]] = []
    while left:
        sortie: list[int] = []
        here, spent_s = 0, 0.0
        while True:
            step_s = {
                stop: problem.travel_s[here, stop] + problem.service_s[stop - 1]
                for stop in left
                if spent_s + problem.travel_s[here, stop] + problem.service_s[stop - 1] + problem.travel_s[stop, 0]
                <= problem.budget_s
            }
            if not step_s:
                break
            here = min(step_s, key=lambda stop: (step_s[stop], stop))
            spent_s += step_s[here]
            sortie.append(here - 1)
            left.remove(here)
        sorties.append(tuple(sortie))
    return tuple(sorties)


BENCHMARK = Benchmark(
    "plan-routing",
    "Sorties of a plan",
    "The views of a plan with 560 views on the office, shared out among batteries (75 % of 42 min each). Times are "
    "those of flying, turning and taking photos, without take-off and landing.",
    measure,
)


def improve_sorties(
    problem: SortieProblem,
    sorties: Sorties,
    *,
    warm: bool = True,
    seed: int = 0,
    max_iterations: int | None = None,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> Sorties:
    """PyVRP's sorties, with no more of them than those given (cold: with any number).

    Parameters
    ----------
    sorties
        Sorties that keep the limits, for example from `planning.routing.sorties.solve_sorties`.
    warm
        Start from them; otherwise they only serve to tell whether the result is any better.

    Returns
    -------
    sorties
        The better ones: fewer, if that is asked for, or shorter.
    """
    n = problem.n_stops
    if n == 0:
        return sorties
    worst = float(np.max(problem.travel_s, initial=0.0, where=np.isfinite(problem.travel_s)))
    total_s = (2 * n) * worst + float(problem.service_s.sum())
    scale = _scale(max(total_s, problem.budget_s if math.isfinite(problem.budget_s) else 0.0))
    budget_s = min(problem.budget_s, total_s)
    n_vehicles = n if not warm else len(sorties) if problem.fewest_first else min(n, 2 * len(sorties))
    load_scale = _scale(float(problem.load.sum()))
    capacity = min(problem.capacity, float(problem.load.sum()))
    data = _problem_data(
        duration=np.ceil(scale * np.where(np.isinf(problem.travel_s), 2.0 * budget_s, problem.travel_s)),
        clients=[
            pyvrp.Client(i + 1, delivery=[math.ceil(load_scale * load)], service_duration=math.ceil(scale * service))
            for i, (load, service) in enumerate(zip(problem.load, problem.service_s, strict=True))
        ],
        depots=[pyvrp.Depot(0)],
        vehicle=pyvrp.VehicleType(
            n_vehicles,
            capacity=[math.floor(load_scale * capacity)],
            shift_duration=math.floor(scale * budget_s),
            # One sortie less outweighs any time: together they take no more than this.
            fixed_cost=math.ceil(scale * min(total_s, n_vehicles * budget_s)) if problem.fewest_first else 0,
            unit_distance_cost=0,
            unit_duration_cost=1,
        ),
    )
    record = _recorder(trace, lambda solution: solution.duration() / scale)
    routes = [list(sortie) for sortie in sorties] if warm else None
    best = _run(data, routes, seed, max_iterations, stop, record, monitor)
    if not best.is_feasible():
        return sorties
    found = tuple(tuple(visits) for visits in _visits(best))

    def quality(candidate: Sorties) -> tuple[int, float]:
        return len(candidate) if problem.fewest_first else 0, math.fsum(sortie_durations_s(problem, candidate))

    return min(sorties, found, key=quality)
