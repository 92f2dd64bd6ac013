"""The ways to find a tour, side by side: the paper's greedy, our local search, and PyVRP."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.base.progress import QUIET, Monitor, Stop, TimeLimit, Trace, any_of, never
from planning.routing.tour import improve_tour, nearest_neighbour, tour_bound, tour_length

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

TourMethod = Literal["local-search", "pyvrp", "pyvrp-cold", "nearest-neighbour"]
"""`pyvrp` starts from a tour that 3-opt has made in milliseconds, `pyvrp-cold` from one of its own."""

PATIENCE = 10_000
"""Kicks a point without a shorter tour before local search gives up: about 5 s for 50 points, 80 s for 700."""

BOUND_SHARE, BOUND_MAX_S = 0.2, 5.0
"""Time for the lower bound: this share of the time there is, but no longer. 724 points take 0.3 s."""


@dataclass(frozen=True, slots=True, eq=False)
class TourResult:
    """A closed tour, its length, and how far from the shortest it can be.

    Parameters
    ----------
    order
        Shape (n,).
    lower_bound
        No tour is shorter; rounded up where all costs are whole numbers.
    gap
        Length above the lower bound, as a part of it: the tour is at most so much longer than the shortest.
    """

    order: Ints
    length: float
    lower_bound: float
    gap: float


def find_tour(
    cost: Floats,
    method: TourMethod,
    *,
    seed: int = 0,
    target_length: float = -math.inf,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> Ints:
    """Closed tour by one of the methods; see `planning.routing.tour.improve_tour` for the arguments.

    Only PyVRP and the nearest neighbour take asymmetric costs.

    Raises
    ------
    InfeasibleError
        No tour without missing legs was found.
    """
    start = nearest_neighbour(cost)
    if method == "local-search":
        return improve_tour(
            cost,
            start,
            seed=seed,
            patience=PATIENCE,
            target_length=target_length,
            stop=stop,
            trace=trace,
            monitor=monitor,
        )
    if method == "nearest-neighbour":
        length = tour_length(cost, start)
        if math.isinf(length):
            raise InfeasibleError.say("the nearest neighbour ends where there is no leg back; take another method")
        if trace is not None:
            trace.record(length)
        return start
    from planning.routing import vrp

    is_warm = method == "pyvrp"
    if is_warm and np.array_equal(cost, cost.T):
        start = improve_tour(cost, start, max_kicks=0, trace=trace)
    return vrp.solve_tour(cost, start, warm=is_warm, seed=seed, stop=stop, trace=trace, monitor=monitor)


def solve_tour(
    cost: Floats,
    method: TourMethod,
    time_limit: TimeLimit,
    *,
    seed: int = 0,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> TourResult:
    """Tour and lower bound in a given time; less where the tour is proven to be the shortest."""
    least = np.minimum(cost, cost.T)
    start = improve_tour(least, nearest_neighbour(least), max_kicks=0)
    bound_s = min(BOUND_SHARE * time_limit.remaining_s(), BOUND_MAX_S)
    bound = tour_bound(least, start, stop=any_of(time_limit, TimeLimit(bound_s)), monitor=monitor)
    if (cost == np.floor(cost)).all():
        bound = math.ceil(bound)
    order = find_tour(cost, method, seed=seed, target_length=bound, stop=time_limit, trace=trace, monitor=monitor)
    length = tour_length(cost, order)
    return TourResult(order, length, bound, length / bound - 1.0 if bound > 0.0 else 0.0)


def tour_curves(
    cost: Floats,
    seconds: float,
    *,
    methods: Sequence[TourMethod] = ("nearest-neighbour", "local-search", "pyvrp", "pyvrp-cold"),
    seed: int = 0,
    monitor: Monitor = QUIET,
) -> dict[TourMethod, Trace]:
    """Length against time of several methods, one after the other, each for so many seconds.

    Making the tour a method starts from counts as its time.
    """
    curves: dict[TourMethod, Trace] = {}
    for method in methods:
        curves[method] = Trace()
        find_tour(cost, method, seed=seed, stop=TimeLimit(seconds), trace=curves[method], monitor=monitor)
    return curves
