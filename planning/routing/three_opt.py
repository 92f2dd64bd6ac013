"""Iterated 3-opt for symmetric costs, compiled: the engine behind `planning.routing.tour`.

A tour is improved by exchanging two or three of its legs, found from neighbour lists (S. Lin and B. Kernighan, 1973,
stopped at depth three; J. Bentley, 1992, for the queue of points that may still improve). Where no exchange helps, a
double bridge (O. Martin, S. Otto and E. Felten, 1991) shakes three short neighbouring stretches, only the points it
touched are looked at again, and the outcome is kept or undone: a kick costs some ten microseconds at any size.

Throughout, the legs (t1, t2), (t3, t4), (t5, t6) are removed and (t2, t3), (t4, t5), (t6, t1) are added.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import inline, kernel

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

N_NEAREST, N_SPREAD, SPREAD = 7, 5, 0.7
"""Legs to add are looked for among the nearest points and some spread out around (see `find_neighbours`).

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


def start_search(order: Ints, length: float) -> Search:
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
def find_neighbours(cost: Floats, first: int, last: int) -> tuple[Ints, Floats]:
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
