"""PyVRP as a second solver for tours, sorties and prizes: the judge of our own, and a choice for the user.

N. Wouda, L. Lan and W. Kool, 2024, "PyVRP: a high-performance VRP solver package". It calculates in whole numbers:
times and lengths are handed over in thousandths, times rounded up and budgets down, so that what fits there fits here.
This is the only module that imports pyvrp; import it where it is needed, not at start-up.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pyvrp
from numpy.typing import NDArray
from pyvrp.stop import NoImprovement

from planning.base.errors import InfeasibleError
from planning.base.progress import QUIET, SLICE_S, Monitor, Stop, Trace, never
from planning.routing.tour import check_costs, tour_length

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FINEST = 1000.0
"""Whole numbers per unit of time or length, where they do not grow too large."""

LARGEST_TOTAL = 1e12
"""All legs of a solution together stay below this in whole numbers: PyVRP multiplies such sums by penalties of up to
1e5, in int64."""

PATIENCE = 150_000
"""Iterations without a better solution before a search ends by itself; PyVRP restarts from its best after as many."""


def solve_tour(
    cost: Floats,
    order: Ints,
    *,
    closed: bool = True,
    warm: bool = True,
    seed: int = 0,
    max_iterations: int | None = None,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> Ints:
    """PyVRP's tour through all points: `planning.routing.tour.improve_tour` for costs that may be asymmetric.

    Parameters
    ----------
    warm
        Start from `order`; otherwise only its first (and, of a path, its last) point are used.

    Raises
    ------
    InfeasibleError
        No tour without missing legs was found.
    """
    check_costs(cost)
    order = np.asarray(order, np.int64)
    n = len(cost)
    start, end = int(order[0]), int(order[0 if closed else -1])
    stops = np.sort(order[1:] if closed else order[1:-1])
    if len(stops) > 0:
        largest = float(np.max(cost, initial=0.0, where=np.isfinite(cost)))
        missing = (n + 1) * (largest or 1.0)
        scale = _scale((n + 1) * missing)
        data = _problem_data(
            distance=np.rint(scale * np.where(np.isinf(cost), missing, cost)),
            clients=[pyvrp.Client(int(stop)) for stop in stops],
            depots=[pyvrp.Depot(start), pyvrp.Depot(end)],
            vehicle=pyvrp.VehicleType(1, start_depot=0, end_depot=1),
        )
        between = order[1:] if closed else order[1:-1]
        routes = [[int(i) for i in np.searchsorted(stops, between)]] if warm else None
        record = _recorder(trace, lambda solution: solution.distance() / scale)
        best = _run(data, routes, seed, max_iterations, stop, record, monitor)
        visits = stops[_visits(best)[0]]
        order = np.concatenate([[start], visits, [] if closed else [end]]).astype(np.int64)
    length = tour_length(cost, order, closed=closed)
    if math.isinf(length):
        raise InfeasibleError.say("PyVRP found no tour of all {} points by existing legs; more time may help", n)
    if trace is not None:
        trace.record(length)
    return order


def _scale(largest_total: float) -> float:
    """Whole numbers per unit, so that no total overflows."""
    return min(FINEST, LARGEST_TOTAL / max(largest_total, 1e-9))


def _problem_data(
    clients: list[pyvrp.Client],
    depots: list[pyvrp.Depot],
    vehicle: pyvrp.VehicleType,
    distance: Floats | None = None,
    duration: Floats | None = None,
) -> pyvrp.ProblemData:
    stated = distance if distance is not None else duration
    assert stated is not None
    matrices: list[Any] = []  # PyVRP's annotations ask for a type that NumPy's arrays do not have
    for matrix in (distance, duration):
        whole = np.zeros(stated.shape, np.int64) if matrix is None else matrix.astype(np.int64)
        np.fill_diagonal(whole, 0)
        matrices.append(whole)
    locations = [pyvrp.Location(0.0, 0.0) for _ in stated]
    return pyvrp.ProblemData(locations, clients, depots, [vehicle], [matrices[0]], [matrices[1]])


def _visits(solution: pyvrp.Solution) -> list[list[int]]:
    """Clients of every route, in order."""
    return [[activity.idx for activity in route if activity.is_client()] for route in solution.routes()]


def _recorder(trace: Trace | None, quality: Callable[[pyvrp.Solution], float]) -> Callable[[pyvrp.Solution], None]:
    def record(solution: pyvrp.Solution) -> None:
        if trace is not None:
            trace.record(quality(solution))

    return record


class _Observer(pyvrp.IteratedLocalSearchCallbacks):
    """Records every new best solution."""

    def __init__(self, record: Callable[[pyvrp.Solution], None]) -> None:
        self._record = record

    def on_best(self, best: pyvrp.Solution) -> None:
        self._record(best)


def _run(
    data: pyvrp.ProblemData,
    routes: list[list[int]] | None,
    seed: int,
    max_iterations: int | None,
    stop: Stop,
    record: Callable[[pyvrp.Solution], None],
    monitor: Monitor,
) -> pyvrp.Solution:
    """Best solution found until `stop`, for so many iterations, or until nothing was found for long."""
    is_settled = NoImprovement(PATIENCE)
    iterations = 0
    next_report = time.perf_counter()

    def is_over(best_cost: int) -> bool:
        nonlocal iterations, next_report
        iterations += 1
        if time.perf_counter() >= next_report:
            monitor.report("PyVRP", iterations, max_iterations or 0)
            next_report = time.perf_counter() + SLICE_S
        return stop() or (is_settled(best_cost) if max_iterations is None else iterations > max_iterations)

    initial = None if routes is None else pyvrp.Solution(data, routes)
    search = pyvrp.IteratedLocalSearchParams(callbacks=_Observer(record))
    params = pyvrp.SolveParams(ils=search)
    # PyVRP's generator takes 32 bits.
    result = pyvrp.solve(data, is_over, seed % 2**32, collect_stats=False, params=params, initial_solution=initial)
    return result.best
