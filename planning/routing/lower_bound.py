"""A proven lower bound on the length of every tour: Held and Karp's 1-trees.

A 1-tree is a spanning tree of all points but one, plus that one's two cheapest legs. Every tour is a 1-tree, so the
cheapest 1-tree is no longer than the shortest tour. Adding a price to all legs at a point lengthens every tour alike
but changes which 1-tree is cheapest: prices are raised where a point has more than two legs and lowered where it has
fewer (M. Held and R. Karp, 1971; step lengths after M. Held, P. Wolfe and H. Crowder, 1974). On the instances of
TSPLIB the bound ends about 0.7 % below the optimum.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import inline, kernel
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, Trace, never, slices

Floats = NDArray[np.float64]

FIRST_STEP, LAST_STEP = 2.0, 1e-3
"""Step length, relative to the one that would close the gap at once: halved down to the last when nothing improves."""

PATIENCE = 20
"""Rounds without a better bound before the step is halved."""

ROUNDING = 1e-9
"""Part of the bound taken off for rounding errors; n sums of float64 stay far below."""


class _Ascent(NamedTuple):
    """Prices now, of the best bound, and how they last changed, shape (n,); step, best bound, rounds since it."""

    prices: Floats
    best_prices: Floats
    change: Floats
    status: Floats


def held_karp_bound(
    cost: Floats,
    upper: float,
    *,
    max_rounds: int | None = None,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> float:
    """Proven lower bound on the length of every closed tour.

    Parameters
    ----------
    cost
        Shape (n, n), symmetric, finite.
    upper
        Length of some tour; the better it is, the faster the bound rises. It does not enter the proof.
    max_rounds
        Rounds to take at most; by default until the steps have become too small to matter.

    Returns
    -------
    bound
        In the unit of `cost`; for fewer than three points the length of the only tour.
    """
    n = len(cost)
    if n < 3:
        return float(2.0 * cost[0, n - 1])
    ascent = _Ascent(np.zeros(n), np.zeros(n), np.zeros(n), np.array([FIRST_STEP, -math.inf, 0.0]))
    rounds = 0
    for n_rounds in slices(max_rounds):
        is_settled = _ascend(cost, ascent, upper, n_rounds)
        rounds += n_rounds
        if trace is not None:
            trace.record(float(ascent.status[1]))
        monitor.report(say("lower bound"), rounds, max_rounds or 0)
        if is_settled or stop():
            break
    bound = float(ascent.status[1])
    return bound - ROUNDING * abs(bound)


@kernel
def _ascend(cost: Floats, ascent: _Ascent, upper: float, n_rounds: int) -> bool:
    """Take some rounds; True once the steps are too small or the bound has met `upper`."""
    prices, best_prices, change, status = ascent
    n = len(cost)
    degree = np.empty(n, np.int64)
    for _ in range(n_rounds):
        bound = _cheapest_one_tree(cost, prices, degree)
        if bound > status[1]:
            if bound > status[1] + 1e-6 * abs(upper - bound):
                status[2] = 0.0
            status[1] = bound
            best_prices[:] = prices
        status[2] += 1.0
        if status[2] > PATIENCE:
            status[0] *= 0.5
            status[2] = 0.0
            prices[:] = best_prices
        excess = 0
        for i in range(n):
            excess += (degree[i] - 2) ** 2
        if excess == 0 or status[0] < LAST_STEP or status[1] >= upper:
            return True
        step = status[0] * (upper - bound) / excess
        for i in range(n):
            change[i] = 0.7 * step * (degree[i] - 2) + 0.3 * change[i]
            prices[i] += change[i]
    return False


@inline
def _cheapest_one_tree(cost: Floats, prices: Floats, degree: NDArray[np.int64]) -> float:
    """Length of the cheapest 1-tree under `prices`, less twice their sum; `degree` becomes its points' legs.

    Point 0 is the one outside the tree; the tree is grown by Prim's algorithm.
    """
    n = len(cost)
    outside = np.arange(1, n)
    nearest = np.full(n, np.inf)
    parent = np.zeros(n, np.int64)
    degree[:] = 0
    length = 0.0
    newest = outside[n - 2]
    for n_outside in range(n - 2, 0, -1):
        closest = 0
        for at in range(n_outside):
            j = outside[at]
            reduced = cost[newest, j] + prices[newest] + prices[j]
            if reduced < nearest[j]:
                nearest[j] = reduced
                parent[j] = newest
            if nearest[j] < nearest[outside[closest]]:
                closest = at
        newest = outside[closest]
        outside[closest] = outside[n_outside - 1]
        length += nearest[newest]
        degree[newest] += 1
        degree[parent[newest]] += 1
    first = second = -1
    for j in range(1, n):
        reduced = cost[0, j] + prices[j]
        if first < 0 or reduced < cost[0, first] + prices[first]:
            first, second = j, first
        elif second < 0 or reduced < cost[0, second] + prices[second]:
            second = j
    degree[0] = 2
    degree[first] += 1
    degree[second] += 1
    length += cost[0, first] + prices[first] + cost[0, second] + prices[second] + 2.0 * prices[0]
    return float(length - 2.0 * prices.sum())


def compile_kernels() -> None:
    """Compile what this module runs."""
    held_karp_bound(np.ones((4, 4)) - np.eye(4), 4.0)
