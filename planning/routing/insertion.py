"""Compiled steps on single routes: where a stop costs least, and how a route gets shorter. Costs may be asymmetric.

A route is the row of places it visits between two visits to place 0. As row 0 of the matrix holds the costs from the
start and column 0 those to the end, the two may be different points.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import inline, kernel

Floats = NDArray[np.float64]


# What a set of stops is worth: prizes that add up, or any worth that overlaps, such as sections seen.


class CoverageGain(Protocol):
    """Worth of a set of candidates that grows and shrinks one by one.

    It must be monotone (more is never worth less) and submodular (the more is there, the less one more adds).
    """

    @property
    def value(self) -> float:
        """Worth of the set as it is."""

    def marginals(self) -> Floats:
        """What each candidate would add now, shape (n,); for those in the set the number means nothing."""

    def add(self, candidate: int) -> None:
        """Put a candidate into the set that is not in it."""

    def remove(self, candidate: int) -> None:
        """Take a candidate out of the set that is in it."""


Ints = NDArray[np.int64]


@kernel
def insertion_costs(travel: Floats, route: Ints, added: Floats, position: Ints) -> None:
    """Travel that each place would add to the route at its best position.

    Parameters
    ----------
    travel
        Shape (n + 1, n + 1).
    route
        Shape (k,), places 1 to n.
    added, position
        Shape (n + 1,): results; how many stops of the route come before the place.
    """
    added[:] = np.inf
    previous = 0
    for at in range(len(route) + 1):
        following = route[at] if at < len(route) else 0
        leg = travel[previous, following] if len(route) > 0 else 0.0
        for place in range(1, len(travel)):
            cost = travel[previous, place] + travel[place, following] - leg
            if cost < added[place]:
                added[place] = cost
                position[place] = at
        previous = following


@inline
def _at(route: Ints, at: int) -> int:
    return route[at] if 0 <= at < len(route) else 0


@kernel
def insertion_costs_with(travel: Floats, route: Ints, last: int, added: Floats, position: Ints) -> None:
    """What `insertion_costs` says of a route from what it said before the route's stop number `last` was put in.

    Only places that would have come where that stop is now are looked at anew.
    """
    before, stop, behind = _at(route, last - 1), route[last], _at(route, last + 1)
    first_leg, second_leg = travel[before, stop], travel[stop, behind]
    for place in range(1, len(travel)):
        if position[place] == last or len(route) == 1:
            added[place] = np.inf
            previous = 0
            for at in range(len(route) + 1):
                following = _at(route, at)
                cost = travel[previous, place] + travel[place, following] - travel[previous, following]
                if cost < added[place]:
                    added[place], position[place] = cost, at
                previous = following
            continue
        if position[place] > last:
            position[place] += 1
        for at in range(2):
            if at == 0:
                cost = travel[before, place] + travel[place, stop] - first_leg
            else:
                cost = travel[stop, place] + travel[place, behind] - second_leg
            if cost < added[place] or (cost == added[place] and last + at < position[place]):
                added[place], position[place] = cost, last + at


@kernel
def shorten(travel: Floats, route: Ints, least_gain: float) -> None:
    """Reverse stretches of the route, and move stretches of up to three stops, until neither saves any more."""
    k = len(route)
    forward, backward = np.zeros(k), np.zeros(k)
    at = 0
    is_new = True
    while True:
        if is_new:
            for i in range(1, k):
                forward[i] = forward[i - 1] + travel[route[i - 1], route[i]]
                backward[i] = backward[i - 1] + travel[route[i], route[i - 1]]
            quiet = 0
            is_new = False
        if quiet >= k:
            break
        is_new = _reverse_from(travel, route, at, forward, backward, least_gain) or _move_from(
            travel, route, at, forward, backward, least_gain
        )
        quiet += 1
        at = at + 1 if at + 1 < k else 0


@inline
def _reverse_from(
    travel: Floats, route: Ints, first: int, forward: Floats, backward: Floats, least_gain: float
) -> bool:
    """Reverse the stretch from `first` to wherever saves most."""
    k = len(route)
    before = _at(route, first - 1)
    best, best_last = least_gain, -1
    for last in range(first + 1, k):
        behind = _at(route, last + 1)
        now = travel[before, route[first]] + forward[last] - forward[first] + travel[route[last], behind]
        then = travel[before, route[last]] + backward[last] - backward[first] + travel[route[first], behind]
        if now - then > best:
            best, best_last = now - then, last
    if best_last < 0:
        return False
    route[first : best_last + 1] = route[first : best_last + 1][::-1].copy()
    return True


@inline
def _move_from(travel: Floats, route: Ints, first: int, forward: Floats, backward: Floats, least_gain: float) -> bool:
    """Move one to three stops from `first` on to where that saves most, turned round or not."""
    k = len(route)
    best, best_last, best_to, is_turned = least_gain, -1, -1, False
    for last in range(first, min(first + 3, k)):
        before, behind = _at(route, first - 1), _at(route, last + 1)
        head, tail = route[first], route[last]
        freed = travel[before, head] + travel[tail, behind] - travel[before, behind]
        turn = backward[last] - backward[first] - (forward[last] - forward[first])
        for to in range(k + 1):
            if first <= to <= last + 1:
                continue
            a, b = _at(route, to - 1), _at(route, to)
            leg = travel[a, b]
            straight = freed - (travel[a, head] + travel[tail, b] - leg)
            turned = freed - (travel[a, tail] + travel[head, b] - leg) - turn
            if straight > best:
                best, best_last, best_to, is_turned = straight, last, to, False
            if turned > best:
                best, best_last, best_to, is_turned = turned, last, to, True
    if best_last < 0:
        return False
    stretch = route[first : best_last + 1].copy()
    if is_turned:
        stretch = stretch[::-1].copy()
    if best_to < first:
        route[best_to + len(stretch) : best_last + 1] = route[best_to:first].copy()
        route[best_to : best_to + len(stretch)] = stretch
    else:
        route[first : best_to - len(stretch)] = route[best_last + 1 : best_to].copy()
        route[best_to - len(stretch) : best_to] = stretch
    return True


def compile_kernels() -> None:
    """Compile what this module runs."""
    travel, route = np.ones((3, 3)), np.array([1, 2])
    insertion_costs(travel, route, np.zeros(3), np.zeros(3, np.int64))
    insertion_costs_with(travel, route, 0, np.zeros(3), np.zeros(3, np.int64))
    shorten(travel, route, 1e-9)
