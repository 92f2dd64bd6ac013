"""Ruin and recreate for several sorties, compiled: the engine behind `planning.routing.sorties`.

Short strings of neighbouring stops are taken out of sorties that pass near each other, and put back one by one where
they cost least (J. Christiaens and G. Vanden Berghe, 2020, "Slack induction by string removals for vehicle routing
problems"; its parameters are kept). Travel times may differ between the two directions.

Stops are numbered 1 to n, as in the matrix of travel times, where 0 is home. Sortie r is a ring of stops that begins
and ends at its own copy of home, number n + 1 + r.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import inline, kernel

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MEAN_REMOVED, LONGEST_STRING = 10, 10
"""Stops taken out in one round on average, and from one sortie at most (the paper's c and L max)."""

SPLIT_SHARE, KEEP_ON = 0.5, 0.01
"""Share of strings that leave some stops in their middle in place, and the chance of each more (alpha and beta)."""

BLINK = 0.01
"""Share of positions overlooked when a stop is put back, so that rounds differ."""


RECOMPUTE = 1000
"""Rounds after which durations and loads are summed up anew; until then rounding adds up to some 1e-13 of them."""


class Limits(NamedTuple):
    """What a sortie may hold, and what stops take.

    Parameters
    ----------
    travel
        Shape (n + 1, n + 1).
    service, load
        Shape (n + 1,), 0 for home.
    budget, capacity
        Limits of the duration and of the load of one sortie.
    near
        Shape (n + 1, k): the stops by rising distance from each stop, itself first.
    """

    travel: Floats
    service: Floats
    load: Floats
    budget: float
    capacity: float
    near: Ints


class Routes(NamedTuple):
    """Sorties as rings; the kernels change them.

    Parameters
    ----------
    after, before
        Shape (n + 1 + n_sorties,): next and previous stop.
    sortie
        Same shape; the sortie of each stop, -1 while it is in none.
    duration, load, size
        Shape (n_sorties,): time from home to home, load and number of stops of each sortie.
    """

    after: Ints
    before: Ints
    sortie: Ints
    duration: Floats
    load: Floats
    size: Ints


def empty_routes(n_stops: int, n_sorties: int) -> Routes:
    """`n_sorties` sorties without stops."""
    ring = np.arange(n_stops + 1 + n_sorties)
    sortie = np.full(len(ring), -1, np.int64)
    sortie[n_stops + 1 :] = np.arange(n_sorties)
    zeros = np.zeros(n_sorties)
    return Routes(ring, ring.copy(), sortie, zeros, zeros.copy(), np.zeros(n_sorties, np.int64))


@inline
def _place(limits: Limits, stop: int) -> int:
    """Row of a stop, or of a copy of home, in the matrix."""
    return stop if stop < len(limits.travel) else 0


@kernel
def insert(limits: Limits, routes: Routes, stop: int, previous: int) -> None:
    """Put a stop in behind `previous`."""
    travel = limits.travel
    following = routes.after[previous]
    a, b = _place(limits, previous), _place(limits, following)
    sortie = routes.sortie[previous]
    routes.after[previous] = routes.before[following] = stop
    routes.before[stop], routes.after[stop] = previous, following
    routes.sortie[stop] = sortie
    routes.duration[sortie] += travel[a, stop] + travel[stop, b] - travel[a, b] + limits.service[stop]
    routes.load[sortie] += limits.load[stop]
    routes.size[sortie] += 1


@kernel
def remove(limits: Limits, routes: Routes, stop: int) -> None:
    """Take a stop out."""
    travel = limits.travel
    previous, following = routes.before[stop], routes.after[stop]
    a, b = _place(limits, previous), _place(limits, following)
    sortie = routes.sortie[stop]
    routes.after[previous], routes.before[following] = following, previous
    routes.sortie[stop] = -1
    routes.duration[sortie] -= travel[a, stop] + travel[stop, b] - travel[a, b] + limits.service[stop]
    routes.load[sortie] -= limits.load[stop]
    routes.size[sortie] -= 1


@kernel
def recompute(limits: Limits, routes: Routes) -> None:
    """Sum up durations and loads anew: thousands of added differences drift."""
    n_places = len(limits.travel)
    for sortie in range(len(routes.size)):
        duration = load = 0.0
        home = n_places + sortie
        stop = home
        while True:
            following = routes.after[stop]
            duration += limits.travel[_place(limits, stop), _place(limits, following)]
            if following == home:
                break
            duration += limits.service[following]
            load += limits.load[following]
            stop = following
        routes.duration[sortie] = duration
        routes.load[sortie] = load


@kernel
def copy_routes(source: Routes, target: Routes) -> None:
    """Make `target` equal to `source`."""
    target.after[:] = source.after
    target.before[:] = source.before
    target.sortie[:] = source.sortie
    target.duration[:] = source.duration
    target.load[:] = source.load
    target.size[:] = source.size


@kernel
def _remove_string(
    limits: Limits, routes: Routes, stop: int, length: int, removed: Ints, n_removed: int, rng: np.random.Generator
) -> int:
    """Take out `length` stops around `stop`, from one string, or from two with a few stops left between them."""
    n_places = len(limits.travel)
    n_kept = 0
    spare = routes.size[routes.sortie[stop]] - length
    if length > 1 and spare > 0 and rng.random() < SPLIT_SHARE:
        n_kept = 1
        while n_kept < spare and rng.random() < KEEP_ON:
            n_kept += 1
    span = length + n_kept
    n_before, first = 0, stop
    while n_before < span - 1 and routes.before[first] < n_places:
        first = routes.before[first]
        n_before += 1
    n_behind, last = 0, stop
    while n_behind < span - 1 and routes.after[last] < n_places:
        last = routes.after[last]
        n_behind += 1
    n_back = rng.integers(max(0, span - 1 - n_behind), min(span - 1, n_before) + 1)
    first = stop
    for _ in range(n_back):
        first = routes.before[first]
    kept_from = rng.integers(1, length) if n_kept > 0 else span
    for at in range(span):
        following = routes.after[first]
        if not kept_from <= at < kept_from + n_kept:
            remove(limits, routes, first)
            removed[n_removed] = first
            n_removed += 1
        first = following
    return n_removed


@kernel
def _ruin(limits: Limits, routes: Routes, removed: Ints, n_removed: int, rng: np.random.Generator) -> int:
    """Take strings of stops out of sorties that pass near a random stop; appended to `removed`."""
    n_places = len(limits.travel)
    in_use = 0
    for size in routes.size:
        in_use += size > 0
    mean_size = (n_places - 1 - n_removed) / max(1, in_use)
    longest = min(LONGEST_STRING, max(1.0, mean_size))
    n_strings = int(rng.uniform(1.0, 4.0 * MEAN_REMOVED / (1.0 + longest)))
    is_ruined = np.zeros(len(routes.size), np.bool_)
    seed = rng.integers(1, n_places)
    for stop in limits.near[seed]:
        sortie = routes.sortie[stop]
        if sortie < 0 or is_ruined[sortie]:
            continue
        length = int(rng.uniform(1.0, min(float(routes.size[sortie]), longest) + 1.0))
        n_removed = _remove_string(limits, routes, stop, length, removed, n_removed, rng)
        is_ruined[sortie] = True
        n_strings -= 1
        if n_strings <= 0:
            break
    return n_removed


@kernel
def _sort(limits: Limits, removed: Ints, n_removed: int, rng: np.random.Generator) -> None:
    """Order in which stops are put back: at random, the most demanding, the furthest or the nearest first (4:4:2:1)."""
    draw = rng.integers(0, 11)
    key = np.empty(n_removed)
    for i in range(n_removed):
        stop = removed[i]
        if draw < 4:
            key[i] = rng.random()
        elif draw < 8:
            key[i] = -(limits.load[stop] / limits.capacity + limits.service[stop] / limits.budget)
        elif draw < 10:
            key[i] = -limits.travel[0, stop]
        else:
            key[i] = limits.travel[0, stop]
    removed[:n_removed] = removed[:n_removed][np.argsort(key)]


@kernel
def _cheapest_place(
    limits: Limits, routes: Routes, stop: int, n_blink: int, rng: np.random.Generator
) -> tuple[int, int]:
    """Stop behind which `stop` costs least, -1 where it fits nowhere; positions left until the next is overlooked."""
    travel = limits.travel
    n_places = len(travel)
    best, least = -1, np.inf
    empty = -1
    for sortie in range(len(routes.size)):
        home = n_places + sortie
        if routes.size[sortie] == 0:
            empty = home
            continue
        if routes.load[sortie] + limits.load[stop] > limits.capacity:
            continue
        spare = limits.budget - routes.duration[sortie] - limits.service[stop]
        if spare < 0.0:
            continue
        previous = home
        a = 0
        while True:
            following = routes.after[previous]
            b = _place(limits, following)
            added = travel[a, stop] + travel[stop, b] - travel[a, b]
            if added < least and added <= spare:
                n_blink -= 1
                if n_blink <= 0:
                    n_blink = rng.geometric(BLINK)
                else:
                    best, least = previous, added
            if following == home:
                break
            previous, a = following, b
    if best < 0 and empty >= 0:
        best = empty
    return best, n_blink


@kernel
def _recreate(limits: Limits, routes: Routes, removed: Ints, n_removed: int, rng: np.random.Generator) -> int:
    """Put stops back where they cost least; those that fit nowhere stay at the front of `removed` and are counted."""
    _sort(limits, removed, n_removed, rng)
    n_absent = 0
    n_blink = rng.geometric(BLINK)
    for i in range(n_removed):
        stop = removed[i]
        place, n_blink = _cheapest_place(limits, routes, stop, n_blink, rng)
        if place < 0:
            removed[n_absent] = stop
            n_absent += 1
        else:
            insert(limits, routes, stop, place)
    return n_absent


class Annealing(NamedTuple):
    """State of an annealing run; the kernels change it.

    Parameters
    ----------
    current, candidate, best
        Sorties as they are, as they are being changed, and the shortest complete ones so far.
    absent, removed
        Shape (n + 1,): stops that are in no current sortie, and those taken out in this round.
    absences
        Shape (n + 1,): how often each stop was left over; stops that are hard to place count more.
    status
        Total duration of `current` and of `best`, number of absent stops, temperature, rounds so far; shape (5,).
    """

    current: Routes
    candidate: Routes
    best: Routes
    absent: Ints
    removed: Ints
    absences: Floats
    status: Floats


@kernel
def _begin_round(limits: Limits, run: Annealing, cooling: float) -> None:
    run.status[3] *= cooling
    run.status[4] += 1.0
    if run.status[4] % RECOMPUTE == 0.0:
        recompute(limits, run.current)
        run.status[0] = run.current.duration.sum()
    copy_routes(run.current, run.candidate)


@kernel
def anneal(limits: Limits, run: Annealing, n_rounds: int, cooling: float, rng: np.random.Generator) -> None:
    """Ruin and recreate complete sorties `n_rounds` times; `best` is kept aside.

    A longer outcome is kept with probability exp(-excess / temperature); the temperature is multiplied by `cooling`
    after every round.
    """
    for _ in range(n_rounds):
        _begin_round(limits, run, cooling)
        n_removed = _ruin(limits, run.candidate, run.removed, 0, rng)
        if _recreate(limits, run.candidate, run.removed, n_removed, rng) > 0:
            continue
        total = run.candidate.duration.sum()
        if total < run.status[0] + run.status[3] * rng.standard_exponential():
            copy_routes(run.candidate, run.current)
            run.status[0] = total
            if total < run.status[1]:
                copy_routes(run.candidate, run.best)
                run.status[1] = total


@kernel
def place_absent(limits: Limits, run: Annealing, n_rounds: int, cooling: float, rng: np.random.Generator) -> bool:
    """Try `n_rounds` times to find a place for the absent stops; True, with `best` set, once all have one.

    Leaving a stop over costs more the more often it was left over before (the paper's fleet minimisation).
    """
    for _ in range(n_rounds):
        _begin_round(limits, run, cooling)
        n_absent = int(run.status[2])
        run.removed[:n_absent] = run.absent[:n_absent]
        n_removed = _ruin(limits, run.candidate, run.removed, n_absent, rng)
        n_left = _recreate(limits, run.candidate, run.removed, n_removed, rng)
        total = run.candidate.duration.sum()
        left, absent = run.removed[:n_left], run.absent[:n_absent]
        is_better = n_left < n_absent or run.absences[left].sum() < run.absences[absent].sum()
        if is_better or (n_left == n_absent and total < run.status[0] + run.status[3] * rng.standard_exponential()):
            copy_routes(run.candidate, run.current)
            run.absent[:n_left] = left
            run.status[0] = total
            run.status[2] = n_left
        for stop in left:
            run.absences[stop] += 1.0
        if n_left == 0:
            copy_routes(run.candidate, run.best)
            run.status[1] = total
            return True
    return False
