"""Short tours and paths through all points, for symmetric costs.

`nearest_neighbour` is the paper's greedy tour; `improve_tour` shortens any tour for as long as it is let. Costs are
lengths or times in any unit. An infinite cost means that there is no leg between two points.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.base.jit import chunks, inline, kernel, run_chunks
from planning.base.messages import glue, say
from planning.base.progress import QUIET, Monitor, Stop, Trace, never, slices
from planning.routing import lower_bound

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


# The shortest tour of a few points, by dynamic programming over subsets (M. Held and R. Karp, 1962).

MAX_POINTS = 12
"""Time and memory double with every point more; 12 points take about 10 ms and 0.4 MB."""


@kernel
def exact_tour(cost: NDArray[np.float64]) -> NDArray[np.int64]:
    """Shortest closed tour, shape (n,), from point 0; `cost` has shape (n, n), is finite, and may be asymmetric."""
    n = len(cost)
    last = n - 1  # point 0 is where every tour starts; the subsets are of the others
    n_subsets = 1 << last
    length = np.full((n_subsets, last), np.inf)
    before = np.full((n_subsets, last), -1, np.int64)
    for j in range(last):
        length[1 << j, j] = cost[0, j + 1]
    for subset in range(n_subsets):
        for j in range(last):
            if not subset >> j & 1 or length[subset, j] == np.inf:
                continue
            for k in range(last):
                if subset >> k & 1:
                    continue
                larger = subset | 1 << k
                candidate = length[subset, j] + cost[j + 1, k + 1]
                if candidate < length[larger, k]:
                    length[larger, k] = candidate
                    before[larger, k] = j
    order = np.zeros(n, np.int64)
    if last == 0:
        return order
    subset = n_subsets - 1
    j = 0
    for k in range(last):
        if length[subset, k] + cost[k + 1, 0] < length[subset, j] + cost[j + 1, 0]:
            j = k
    for at in range(last, 0, -1):
        order[at] = j + 1
        subset, j = subset ^ 1 << j, before[subset, j]
    return order


# Iterated 3-opt for symmetric costs, compiled: the engine behind `planning.routing.tour`.
#
# A tour is improved by exchanging two or three of its legs, found from neighbour lists (S. Lin and B. Kernighan, 1973,
# stopped at depth three; J. Bentley, 1992, for the queue of points that may still improve). Where no exchange helps, a
# double bridge (O. Martin, S. Otto and E. Felten, 1991) shakes three short neighbouring stretches, only the points it
# touched are looked at again, and the outcome is kept or undone: a kick costs some ten microseconds at any size.
#
# Throughout, the legs (t1, t2), (t3, t4), (t5, t6) are removed and (t2, t3), (t4, t5), (t6, t1) are added.

N_NEAREST, N_SPREAD, SPREAD = 7, 5, 0.7
"""Legs to add are looked for among the nearest points and some spread out around (see `_find_neighbours`).

Measured on six sets of 318 to 1000 points: with the 10 nearest alone, tours of evenly spread points are as good, of
clustered points 7 % and of repeated points 9 % longer. 5 to 10 nearest, 4 to 6 others and 0.5 to 0.8 are all alike.
"""

LONGEST_STRETCH = 30
"""Points in each of the three stretches that a kick exchanges, at most. 10 and 50 were no better, 100 was worse."""

LOG_LENGTH = 10_000
"""Reversals remembered for undoing one kick; some ten are usual."""


class Legs(NamedTuple):
    """Costs, shape (n, n), symmetric and finite, and each point's neighbours by rising cost, both shape (n, k)."""

    cost: Floats
    neighbours: Ints
    neighbour_cost: Floats


class Search(NamedTuple):
    """State of a search; the kernels change it.

    Parameters
    ----------
    order, position
        The current tour, shape (n,), and where in it each point stands.
    best
        The best tour so far, shape (n,).
    length
        Lengths of the current and of the best tour, shape (2,).
    queue, is_queued
        Points to look at, shape (n,).
    reversals
        What was done since the last kick, shape (`LOG_LENGTH`, 2): first and last position reversed.
    """

    order: Ints
    position: Ints
    best: Ints
    length: Floats
    queue: Ints
    is_queued: NDArray[np.bool_]
    reversals: Ints


def _start_search(order: Ints, length: float) -> Search:
    """State of a search that starts from `order`."""
    n = len(order)
    position = np.empty(n, np.int64)
    position[order] = np.arange(n)
    return Search(
        order=order.astype(np.int64),
        position=position,
        best=order.astype(np.int64),
        length=np.array([length, length]),
        queue=np.empty(n, np.int64),
        is_queued=np.zeros(n, np.bool_),
        reversals=np.empty((LOG_LENGTH, 2), np.int64),
    )


@kernel
def _find_neighbours(cost: Floats, first: int, last: int) -> tuple[Ints, Floats]:
    """Neighbours of the points from `first` to before `last`, and their costs.

    The nearest few alone would all lie in the same cluster (20 photos at one spot, say), and no exchange could be
    found between clusters. The others are therefore spread out: each is the nearest point that is not closer to a
    neighbour already taken than `SPREAD` times its distance from here.
    """
    n = len(cost)
    k = min(N_NEAREST + N_SPREAD, n - 1)
    neighbours = np.empty((last - first, k), np.int64)
    is_out = np.empty(n, np.bool_)
    for i in range(first, last):
        is_out[:] = False
        is_out[i] = True
        found = neighbours[i - first]
        for m in range(k):
            if m == N_NEAREST:
                for taken in found[:m]:
                    _leave_out_behind(cost, i, taken, is_out)
            elif m > N_NEAREST:
                _leave_out_behind(cost, i, found[m - 1], is_out)
            found[m] = _nearest(cost[i], is_out)
            if found[m] < 0:
                found[m:] = found[m - 1]
                break
            is_out[found[m]] = True
    neighbour_cost = np.empty((last - first, k))
    for i in range(first, last):
        for m in range(k):
            neighbour_cost[i - first, m] = cost[i, neighbours[i - first, m]]
    return neighbours, neighbour_cost


@inline
def _nearest(cost: Floats, is_out: NDArray[np.bool_]) -> int:
    nearest = -1
    least = np.inf
    for j in range(len(cost)):
        if not is_out[j] and cost[j] < least:
            nearest, least = j, cost[j]
    return nearest


@inline
def _leave_out_behind(cost: Floats, i: int, taken: int, is_out: NDArray[np.bool_]) -> None:
    for j in range(len(cost)):
        if cost[taken, j] <= SPREAD * cost[i, j]:
            is_out[j] = True


@inline
def _next(order: Ints, position: Ints, point: int, forward: bool) -> int:
    """The point that follows in the tour, or precedes."""
    n = len(order)
    at = position[point] + (1 if forward else -1)
    if at == n:
        at = 0
    elif at < 0:
        at = n - 1
    return int(order[at])


@kernel
def _reverse(order: Ints, position: Ints, reversals: Ints, first: int, last: int, n_logged: int) -> int:
    """Reverse the tour from position `first` on to `last`, or the rest of it, whichever is shorter; log it."""
    n = len(order)
    count = last - first + 1 if last >= first else last - first + 1 + n
    if 2 * count > n:
        first, last, count = last + 1, first - 1, n - count
        first = first if first < n else 0
        last = last if last >= 0 else n - 1
    if n_logged < len(reversals):
        reversals[n_logged, 0] = first
        reversals[n_logged, 1] = last
    for _ in range(count // 2):
        a, b = order[first], order[last]
        order[first], position[b] = b, first
        order[last], position[a] = a, last
        first = first + 1 if first + 1 < n else 0
        last = last - 1 if last > 0 else n - 1
    return n_logged + 1


@kernel
def _exchange(order: Ints, position: Ints, reversals: Ints, t1: int, t2: int, t3: int, t4: int, n_logged: int) -> int:
    """Replace legs (t1, t2), (t4, t3) by (t1, t4), (t2, t3); t2 follows t1 as t3 follows t4, in either direction."""
    if _next(order, position, t1, True) == t2:
        return _reverse(order, position, reversals, position[t2], position[t4], n_logged)
    return _reverse(order, position, reversals, position[t4], position[t2], n_logged)


class Move(NamedTuple):
    """An exchange of legs and what it saves; `kind` says how the stretches are put together (see `_apply`)."""

    gain: float
    kind: int
    t2: int
    t3: int
    t4: int
    t5: int
    t6: int


@inline
def _steps(position: Ints, start: int, point: int, forward: bool) -> int:
    """How many steps along the tour lead from position `start` to `point`."""
    steps = position[point] - start if forward else start - position[point]
    return int(steps if steps >= 0 else steps + len(position))


@kernel
def _best_move(legs: Legs, order: Ints, position: Ints, t1: int, forward: bool, least_gain: float) -> Move:
    """Best exchange that removes the leg from t1 onwards; kind 0 where none saves more than `least_gain`.

    With s(x) the steps from t2 to x, four ways of closing the tour are looked at: (1) two legs only; with t4 before
    t3, (2) t5 anywhere, t6 on the side that a second two-leg exchange needs; with t4 behind t3, t5 between t2 and t3
    with t6 (3) behind it or (4) before it.
    """
    cost, neighbours, neighbour_cost = legs
    t2 = _next(order, position, t1, forward)
    start = position[t2]
    best = Move(least_gain, 0, t2, t1, t1, t1, t1)
    for k in range(neighbours.shape[1]):
        gain_1 = cost[t1, t2] - neighbour_cost[t2, k]
        if gain_1 <= least_gain:
            break
        t3 = neighbours[t2, k]
        steps_3 = _steps(position, start, t3, forward)
        if t3 == t1 or steps_3 == 1:
            continue
        for is_behind in range(2):
            t4 = _next(order, position, t3, forward == (is_behind == 1))
            gain_2 = gain_1 + cost[t3, t4]
            if is_behind == 0 and gain_2 - cost[t4, t1] > best.gain:
                best = Move(gain_2 - cost[t4, t1], 1, t2, t3, t4, t1, t1)
            for m in range(neighbours.shape[1]):
                gain_3 = gain_2 - neighbour_cost[t4, m]
                if gain_3 <= best.gain:
                    break
                t5 = neighbours[t4, m]
                steps_5 = _steps(position, start, t5, forward)
                if t5 == t3 or (is_behind == 1 and steps_5 > steps_3):
                    continue
                if is_behind == 0:
                    t6 = _next(order, position, t5, forward == (steps_5 < steps_3))
                    gain = gain_3 + cost[t5, t6] - cost[t6, t1]
                    if gain > best.gain and t6 != t4:
                        best = Move(gain, 2, t2, t3, t4, t5, t6)
                    continue
                t6 = _next(order, position, t5, forward)
                gain = gain_3 + cost[t5, t6] - cost[t6, t1]
                if gain > best.gain:
                    best = Move(gain, 3, t2, t3, t4, t5, t6)
                t6 = _next(order, position, t5, not forward)
                gain = gain_3 + cost[t5, t6] - cost[t6, t1]
                if gain > best.gain and steps_5 > 0:
                    best = Move(gain, 4, t2, t3, t4, t5, t6)
    return best


@kernel
def _apply(search: Search, t1: int, move: Move, n_logged: int) -> int:
    """Make an exchange by reversals; the comments show the tour from t1 on after each."""
    _, kind, t2, t3, t4, t5, t6 = move
    order, position, reversals = search.order, search.position, search.reversals
    if kind == 1:
        return _exchange(order, position, reversals, t1, t2, t3, t4, n_logged)
    if kind == 2:
        n_logged = _exchange(order, position, reversals, t1, t2, t3, t4, n_logged)
        return _exchange(order, position, reversals, t1, t4, t5, t6, n_logged)
    if kind == 3:  # t1 [t2 .. t5] [t6 .. t3] t4
        n_logged = _exchange(order, position, reversals, t1, t2, t4, t3, n_logged)  # t1 [t3 .. t6] [t5 .. t2] t4
        n_logged = _exchange(order, position, reversals, t1, t3, t5, t6, n_logged)  # t1 [t6 .. t3] [t5 .. t2] t4
        return _exchange(order, position, reversals, t3, t5, t4, t2, n_logged)  # t1 [t6 .. t3] [t2 .. t5] t4
    # t1 [t2 .. t6] [t5 .. t3] t4
    n_logged = _exchange(order, position, reversals, t1, t2, t5, t6, n_logged)  # t1 [t6 .. t2] [t5 .. t3] t4
    return _exchange(order, position, reversals, t2, t5, t4, t3, n_logged)  # t1 [t6 .. t2] [t3 .. t5] t4


@kernel
def _descend(legs: Legs, search: Search, n_queued: int, least_gain: float, n_logged: int) -> tuple[float, int]:
    """Improve around the queued points until none of them does; returns what was saved."""
    n = len(search.order)
    head = 0
    saved = 0.0
    while n_queued > 0:
        t1 = search.queue[head]
        head = head + 1 if head + 1 < n else 0
        n_queued -= 1
        search.is_queued[t1] = False
        while True:
            move = _best_move(legs, search.order, search.position, t1, True, least_gain)
            backward = _best_move(legs, search.order, search.position, t1, False, move.gain)
            if backward.kind > 0:
                move = backward
            if move.kind == 0:
                break
            n_logged = _apply(search, t1, move, n_logged)
            saved += move.gain
            for point in (move.t2, move.t3, move.t4, move.t5, move.t6):
                if point != t1 and not search.is_queued[point]:
                    search.is_queued[point] = True
                    tail = head + n_queued
                    search.queue[tail if tail < n else tail - n] = point
                    n_queued += 1
    return saved, n_logged


@kernel
def descend(legs: Legs, search: Search, least_gain: float) -> None:
    """Improve the whole tour until no exchange of two or three legs saves more than `least_gain`."""
    search.queue[:] = search.order
    search.is_queued[:] = True
    saved, _ = _descend(legs, search, len(search.order), least_gain, 0)
    search.length[:] = search.length[0] - saved
    search.best[:] = search.order


@kernel
def _double_bridge(legs: Legs, search: Search, rng: np.random.Generator) -> tuple[float, int]:
    """Swap the outer two of three neighbouring stretches [a .. b] [c .. d] [e .. f]; returns cost and points queued."""
    cost = legs.cost
    order, position, reversals = search.order, search.position, search.reversals
    n = len(order)
    longest = min(LONGEST_STRETCH, (n - 2) // 3)
    first = rng.integers(0, n)
    second = first + rng.integers(1, longest + 1)
    third = second + rng.integers(1, longest + 1)
    behind = third + rng.integers(1, longest + 1)
    before, a, b, c = order[first - 1], order[first], order[(second - 1) % n], order[second % n]
    d, e, f, after = order[(third - 1) % n], order[third % n], order[(behind - 1) % n], order[behind % n]
    _exchange(order, position, reversals, before, a, after, f, 0)  # [f .. e] [d .. c] [b .. a]
    _exchange(order, position, reversals, before, f, d, e, 1)  # [e .. f] [d .. c] [b .. a]
    _exchange(order, position, reversals, f, d, b, c, 2)  # [e .. f] [c .. d] [b .. a]
    _exchange(order, position, reversals, d, b, after, a, 3)  # [e .. f] [c .. d] [a .. b]
    n_queued = 0
    for point in (before, a, b, c, d, e, f, after):
        if not search.is_queued[point]:
            search.is_queued[point] = True
            search.queue[n_queued] = point
            n_queued += 1
    removed = cost[before, a] + cost[b, c] + cost[d, e] + cost[f, after]
    return cost[before, e] + cost[f, c] + cost[d, a] + cost[b, after] - removed, n_queued


@kernel
def kick(
    legs: Legs, search: Search, n_kicks: int, tolerance: float, least_gain: float, rng: np.random.Generator
) -> int:
    """Shake and repair the tour `n_kicks` times; the best tour is kept aside.

    A repaired tour that is longer is kept with probability exp(-excess / tolerance), otherwise undone.

    Returns
    -------
    last_success
        After how many kicks the best tour was found; 0 if none was better than before.
    """
    last_success = 0
    for i in range(n_kicks):
        added, n_queued = _double_bridge(legs, search, rng)
        saved, n_logged = _descend(legs, search, n_queued, least_gain, 4)
        excess = added - saved
        if excess > least_gain + tolerance * rng.standard_exponential() and n_logged <= LOG_LENGTH:
            for at in range(n_logged - 1, -1, -1):
                first, last = search.reversals[at]
                _reverse(search.order, search.position, search.reversals, first, last, LOG_LENGTH)
            continue
        search.length[0] += excess
        if search.length[0] < search.length[1] - least_gain:
            search.length[1] = search.length[0]
            search.best[:] = search.order
            last_success = i + 1
    return last_success


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
    first_length = tour_length(cost, order, closed=closed)
    trace.record(first_length)
    if n <= 3:
        best = order
    elif n <= MAX_POINTS:
        finite, _ = _without_infinities(cost, order, closed)
        best = _as_ordered(exact_tour(finite), order, closed)
    else:
        search = _LocalSearch(cost, order, closed, seed, monitor)
        best = _run(search, max_kicks, patience * n, target_length, stop, trace, monitor)
    length = tour_length(cost, best, closed=closed)
    if math.isinf(length):
        reason = say("every order needs a leg that does not exist") if n <= MAX_POINTS else say("none was found")
        raise InfeasibleError.say("no tour visits all {} points by existing legs: {}", n, reason)
    if length >= first_length:
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
        monitor.report(say("tour"), kicks, max_kicks or 0)
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
        self._state = _start_search(order, tour_length(finite, order))
        self._rng = np.random.default_rng(seed)
        # Six costs are added to compare two tours: rounding stays below 1e-15 of the largest.
        self._least_gain = 1e-12 * missing
        descend(self._legs, self._state, self._least_gain)
        taken = finite[self._state.order, np.roll(self._state.order, -1)]
        self._tolerance = TOLERANCE * float(np.sum(taken, where=np.abs(taken) < missing)) / len(taken)

    @property
    def tour(self) -> Ints:
        """The shortest tour so far, shape (n,), as the one it began with starts (and, as a path, ends)."""
        return _as_ordered(self._state.best, self._order, self._closed)

    @property
    def length(self) -> float:
        """Its length, summed up anew, where the search adds up differences; infinite with a missing leg."""
        return tour_length(self._cost, self.tour, closed=self._closed)

    def kick(self, n_kicks: int) -> int:
        """Shake and repair the tour `n_kicks` times; after how many of them the best tour was found, 0 for none."""
        return kick(self._legs, self._state, n_kicks, self._tolerance, self._least_gain, self._rng)


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


def _legs(cost: Floats, monitor: Monitor) -> Legs:
    """Costs with every point's neighbours, found on all cores."""
    n = len(cost)

    def find(first: int, last: int) -> tuple[Ints, Floats]:
        monitor.report(say("neighbours"), first, n)
        return _find_neighbours(cost, first, last)

    parts = run_chunks(find, chunks(n, max(1, 1_000_000 // n)))
    return Legs(cost, *(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def _as_ordered(tour: Ints, order: Ints, closed: bool) -> Ints:
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
        raise InfeasibleError.say(
            "no tour visits all {} points: there is no way from point {} to {}", n, order[0], lost
        )
    needed = np.full(n, min(2, n - 1))
    if not closed:
        needed[order[[0, -1]]] = 1
    lone = np.flatnonzero(has_leg.sum(axis=1) < needed)
    if len(lone):
        raise InfeasibleError.say("no tour visits all {} points: there is only one leg at {}", n, _listed(lone))


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
    exact_tour(np.ones((3, 3)))
    lower_bound.compile_kernels()
    points = np.arange(16.0)
    improve_tour(np.abs(points[:, None] - points), np.arange(16), max_kicks=1)
