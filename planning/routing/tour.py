"""Short tours and paths through all points, for symmetric costs.

`nearest_neighbour` is the paper's greedy tour; `improve_tour` shortens any tour for as long as it is let. Costs are
lengths or times in any unit. An infinite cost means that there is no leg between two points.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.base.jit import chunks, run_chunks
from planning.base.messages import glue, say
from planning.base.progress import QUIET, Monitor, Stop, Trace, never
from planning.routing import exact_tour, lower_bound, three_opt
from planning.routing.slices import slices

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

PATIENCE = 1000
"""Kicks without a shorter tour, for every point, before a search ends by itself."""

TOLERANCE = 0.2
"""How much longer a kick may leave the tour, in mean legs, to be kept about one time in three. On 442 to 1000 points
0.1 to 0.3 gave the shortest tours after 3 to 30 s; with 0 they stay 0.2 % longer, with 1 0.5 %."""

SYMMETRY = 1e-9
"""Largest difference between the costs of the two directions, relative to the largest cost, taken as rounding."""


def tour_length(cost: Floats, order: Ints, *, closed: bool = True) -> float:
    """Sum of the legs in `order`, back to the first point where `closed`; infinite where a leg is missing."""
    legs = cost[order[:-1], order[1:]]
    closing = float(cost[order[-1], order[0]]) if closed and len(order) > 1 else 0.0
    return math.fsum(legs) + closing


def nearest_neighbour(cost: Floats, *, start: int = 0, end: int | None = None) -> Ints:
    """Tour that always goes on to the nearest point not yet visited (the paper's greedy, section 3.2).

    Parameters
    ----------
    cost
        Shape (n, n); infinite where there is no leg. The greedy tour may still be forced to use such a leg at last:
        `tour_length` is then infinite.
    end
        Point to visit last, where there is one.

    Returns
    -------
    order
        Shape (n,).
    """
    check_costs(cost)
    n = len(cost)
    order = np.empty(n, np.int64)
    is_left = np.ones(n, np.bool_)
    order[0] = start
    is_left[start] = False
    if end is not None and n > 1:
        is_left[end] = False
        order[-1] = end
    for at in range(1, n if end is None else n - 1):
        left = np.flatnonzero(is_left)
        order[at] = left[np.argmin(cost[order[at - 1], left])]
        is_left[order[at]] = False
    return order


def improve_tour(
    cost: Floats,
    order: Ints,
    *,
    closed: bool = True,
    seed: int = 0,
    max_kicks: int | None = None,
    patience: int = PATIENCE,
    target_length: float = -math.inf,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> Ints:
    """Shorten a tour by iterated 3-opt until `stop`, or until nothing has been found for long.

    Up to twelve points the result is proven to be the shortest. The result depends on the seed and the number of kicks
    alone, not on how fast the machine is.

    Parameters
    ----------
    cost
        Shape (n, n), symmetric, none negative; infinite where there is no leg. The diagonal is ignored.
    order
        Shape (n,), a permutation: the tour to start from.
    closed
        Return to the first point; otherwise the first and the last point of `order` stay where they are.
    max_kicks
        End after so many.
    patience
        Without `max_kicks`, end when so many times n in a row brought nothing.
    target_length
        End as soon as the tour is no longer than this (a proven lower bound, for example).

    Returns
    -------
    order
        Shape (n,), no longer than the one given and starting at the same point.

    Raises
    ------
    InfeasibleError
        No tour without missing legs exists, or none was found.
    ValueError
        The costs are not square, not symmetric, negative or NaN, or `order` is not a permutation.
    """
    check_costs(cost, symmetric=True)
    n = len(cost)
    order = np.asarray(order, np.int64)
    if order.shape != (n,) or not np.array_equal(np.sort(order), np.arange(n)):
        raise ValueError(f"order: expected a permutation of {n} points, got {order!r}")
    _check_connected(cost, order, closed)
    trace = Trace() if trace is None else trace
    given_length = tour_length(cost, order, closed=closed)
    trace.record(given_length)
    if n <= 3:
        best = order
    elif n <= exact_tour.MAX_POINTS:
        finite, _ = _without_infinities(cost, order, closed)
        best = _as_given(exact_tour.exact_tour(finite), order, closed)
    else:
        search = _LocalSearch(cost, order, closed, seed, monitor)
        best = _run(search, max_kicks, patience * n, target_length, stop, trace, monitor)
    length = tour_length(cost, best, closed=closed)
    if math.isinf(length):
        reason = (
            say("every order needs a leg that does not exist") if n <= exact_tour.MAX_POINTS else say("none was found")
        )
        raise InfeasibleError(say("no tour visits all {} points by existing legs: {}", n, reason))
    if length >= given_length:
        return order
    trace.record(length)
    return best


def _run(
    search: _LocalSearch,
    max_kicks: int | None,
    patience: int,
    target_length: float,
    stop: Stop,
    trace: Trace,
    monitor: Monitor,
) -> Ints:
    """Let a search go on until it should end; its tour may still use missing legs."""
    kicks = last_success = 0
    length = trace.points[-1].value
    for n_kicks in slices(first=100):
        if search.length < length:
            length = search.length
            trace.record(length)
        monitor.report("tour", kicks, max_kicks or 0)
        limit = last_success + patience if max_kicks is None else max_kicks
        if kicks >= limit or search.length <= target_length or stop():
            break
        n_kicks = min(n_kicks, limit - kicks)
        success = search.kick(n_kicks)
        last_success = kicks + success if success else last_success
        kicks += n_kicks
    return search.tour


class _LocalSearch:
    """Iterated 3-opt; what it finds depends on the kicks, not on how they are divided among calls."""

    def __init__(self, cost: Floats, order: Ints, closed: bool, seed: int, monitor: Monitor) -> None:
        self._cost, self._order, self._closed = cost, order, closed
        finite, missing = _without_infinities(cost, order, closed)
        self._legs = _legs(finite, monitor)
        self._state = three_opt.start_search(order, tour_length(finite, order))
        self._rng = np.random.default_rng(seed)
        # Six costs are added to compare two tours: rounding stays below 1e-15 of the largest.
        self._least_gain = 1e-12 * missing
        three_opt.descend(self._legs, self._state, self._least_gain)
        taken = finite[self._state.order, np.roll(self._state.order, -1)]
        self._tolerance = TOLERANCE * float(np.sum(taken, where=np.abs(taken) < missing)) / len(taken)

    @property
    def tour(self) -> Ints:
        """The shortest tour so far, shape (n,), as the one it began with starts (and, as a path, ends)."""
        return _as_given(self._state.best, self._order, self._closed)

    @property
    def length(self) -> float:
        """Its length, summed up anew, where the search adds up differences; infinite with a missing leg."""
        return tour_length(self._cost, self.tour, closed=self._closed)

    def kick(self, n_kicks: int) -> int:
        """Shake and repair the tour `n_kicks` times; after how many of them the best tour was found, 0 for none."""
        return three_opt.kick(self._legs, self._state, n_kicks, self._tolerance, self._least_gain, self._rng)


def check_costs(cost: Floats, *, symmetric: bool = False) -> None:
    """Raise `ValueError` unless costs are square, neither negative nor NaN, and symmetric where asked for."""
    if cost.ndim != 2 or cost.shape[0] != cost.shape[1] or len(cost) == 0:
        raise ValueError(f"cost: expected shape (n, n) with n >= 1, got {cost.shape}")
    if np.isnan(cost).any():
        i, j = np.argwhere(np.isnan(cost))[0]
        raise ValueError(f"cost: expected numbers, the leg from {i} to {j} is NaN")
    if (cost < 0.0).any():
        i, j = np.argwhere(cost < 0.0)[0]
        raise ValueError(f"cost: expected no negative cost, the leg from {i} to {j} has {cost[i, j]}")
    if symmetric and not (np.array_equal(cost, cost.T) or _is_nearly_symmetric(cost)):
        raise ValueError("cost: expected the same cost in both directions of every leg")


def _is_nearly_symmetric(cost: Floats) -> bool:
    return bool(np.allclose(cost, cost.T, rtol=SYMMETRY, atol=SYMMETRY * _largest(cost)))


def _largest(cost: Floats) -> float:
    """Largest finite cost, 0 where there is none."""
    return float(np.max(cost, initial=0.0, where=np.isfinite(cost)))


def _without_infinities(cost: Floats, order: Ints, closed: bool) -> tuple[Floats, float]:
    """Costs that the search can add and subtract, and the price of a missing leg.

    A missing leg costs more than all others together, so the shortest tour has the fewest. A path is closed by a leg
    that saves as much, which is therefore never given up.
    """
    finite = cost if np.array_equal(cost, cost.T) else (cost + cost.T) / 2.0
    missing = (len(cost) + 1) * (_largest(cost) or 1.0)
    if np.isinf(cost).any():
        finite = np.where(np.isinf(cost), missing, finite)
    if not closed:
        finite = finite.copy()
        finite[order[0], order[-1]] = finite[order[-1], order[0]] = -missing
    return np.ascontiguousarray(finite, np.float64), missing


def _legs(cost: Floats, monitor: Monitor) -> three_opt.Legs:
    """Costs with every point's neighbours, found on all cores."""
    n = len(cost)

    def find(first: int, last: int) -> tuple[Ints, Floats]:
        monitor.report("neighbours", first, n)
        return three_opt.find_neighbours(cost, first, last)

    parts = run_chunks(find, chunks(n, max(1, 1_000_000 // n)))
    return three_opt.Legs(cost, *(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def _as_given(tour: Ints, order: Ints, closed: bool) -> Ints:
    """A copy of a closed tour, starting where `order` does and, as a path, ending where it does."""
    turned = np.roll(tour, -int(np.flatnonzero(tour == order[0])[0]))
    return turned if closed or turned[-1] == order[-1] else np.roll(turned[::-1], 1)


def _check_connected(cost: Floats, order: Ints, closed: bool) -> None:
    """Raise `InfeasibleError` where missing legs plainly forbid every tour."""
    n = len(cost)
    if np.isfinite(cost).all():
        return
    has_leg = np.isfinite(cost) & ~np.eye(n, dtype=np.bool_)
    from scipy.sparse.csgraph import connected_components

    n_parts, part = connected_components(has_leg, directed=False)
    if n_parts > 1:
        lost = _listed(np.flatnonzero(part != part[order[0]]))
        raise InfeasibleError(
            say("no tour visits all {} points: there is no way from point {} to {}", n, order[0], lost)
        )
    needed = np.full(n, min(2, n - 1))
    if not closed:
        needed[order[[0, -1]]] = 1
    lone = np.flatnonzero(has_leg.sum(axis=1) < needed)
    if len(lone):
        raise InfeasibleError(say("no tour visits all {} points: there is only one leg at {}", n, _listed(lone)))


def _listed(points: Ints) -> str:
    shown = ", ".join(str(point) for point in points[:5])
    more = say(" and {} more", len(points) - 5) if len(points) > 5 else ""
    return say("points {}", glue(shown, more)) if len(points) > 1 else say("point {}", glue(shown, more))


def tour_bound(
    cost: Floats, order: Ints, *, closed: bool = True, stop: Stop = never, monitor: Monitor = QUIET
) -> float:
    """Proven lower bound on the length of every tour, or of every path with the ends of `order`.

    Parameters
    ----------
    cost
        As for `improve_tour`.
    order
        Shape (n,), a good tour without missing legs: the shorter it is, the sooner the bound is found.

    Returns
    -------
    bound
        Typically 0.5 to 1.5 % below the optimum for points in space (`planning.routing.lower_bound`).
    """
    check_costs(cost, symmetric=True)
    if len(cost) <= 3:
        return tour_length(cost, order, closed=closed)
    finite, missing = _without_infinities(cost, order, closed)
    bound = lower_bound.held_karp_bound(finite, tour_length(finite, order), stop=stop, monitor=monitor)
    return max(0.0, bound if closed else bound + missing)


def compile_kernels() -> None:
    """Compile what this module runs."""
    exact_tour.compile_kernels()
    lower_bound.compile_kernels()
    points = np.arange(16.0)
    improve_tour(np.abs(points[:, None] - points), np.arange(16), max_kicks=1)
