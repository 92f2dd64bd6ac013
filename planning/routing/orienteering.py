"""The most worth that fits into a battery, or several: which stops to make, and in which order (team orienteering).

Stops are put in one after the other where they add most worth for the time they take; then some are taken out and put
back differently, over and over (ruin and recreate), and routes are shortened so that more fits in. The worth may be a
plain sum of prizes or overlap, as coverage does (`planning.routing.insertion`).
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, Trace, never
from planning.routing import insertion, tour
from planning.routing.insertion import CoverageGain
from planning.routing.sorties import FIT, Sorties
from planning.routing.tour import check_costs, improve_tour

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

PATIENCE = 4000
"""Rounds without a better selection before a search ends by itself."""

TOLERANCE = 0.02
"""A round may lose this part of the worth at first; after `RETURN` rounds without a better selection the search goes
back to the best."""

RETURN = 200

EXPONENTS = (0.5, 1.0, 2.0, 50.0)
"""Stops are put in by worth to one of these powers, divided by the time they add: one is drawn for each round.
Small powers suit tight budgets; where the number of stops is what is tight, only the worth counts."""

NOISE = (0.0, 0.1, 0.3, 1.0)
"""Spread of the random factors on that score (standard deviation of their logarithm): one is drawn for each round."""

LARGEST_SHARE = 1.0
"""A round takes out up to this share of the stops."""

GROWN = 0.1
"""Part by which stops must grow in number, once it is late, for their worth to be looked at again."""

WORTHLESS = 1e-9
"""Stops that add less than this part of what the best adds are left out: it is rounding."""

ROUTE_KICKS = 20
"""Kicks a stop for putting the routes of a new best selection in order."""


@dataclass(frozen=True, slots=True)
class Selection:
    """Stops worth making.

    Parameters
    ----------
    sorties
        Stops of each sortie in the order flown, numbered from 0; sorties without stops are left out.
    durations_s
        From start to end of each sortie.
    value
        Worth of all stops together.
    bound
        No selection within the budget is worth more.
    """

    sorties: Sorties
    durations_s: tuple[float, ...]
    value: float
    bound: float


def solve_orienteering(
    travel_s: Floats,
    service_s: Floats,
    budget_s: float,
    n_sorties: int,
    gain: CoverageGain,
    *,
    max_stops: int | None = None,
    required: Sorties = (),
    seed: int = 0,
    max_rounds: int | None = None,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> Selection:
    """Choose and order stops so that the worth of all is as large as can be found.

    Parameters
    ----------
    travel_s
        Shape (n + 1, n + 1), seconds from row to column. Row 0 holds the times from the start of a sortie, column 0
        those to its end; the two may be different places. Infinite where there is no way.
    service_s
        Shape (n,), seconds spent at each stop.
    budget_s
        Longest duration of a sortie.
    n_sorties
        Most sorties that may be flown.
    gain
        Worth of a set of stops, empty at first; holds the result's stops afterwards.
    max_stops
        Most stops in one sortie.
    required
        Stops that the selection must make, as sorties within all limits; they may end in other sorties.
    max_rounds
        Rounds of ruin and recreate; by default until `PATIENCE` brought nothing. With the seed they determine the
        result.
    trace
        Gets the worth whenever it rises.

    Returns
    -------
    selection
        Without sorties where no stop fits or none is worth anything.
    """
    check_costs(travel_s)
    n = len(travel_s) - 1
    if service_s.shape != (n,) or not (np.isfinite(service_s).all() and (service_s >= 0.0).all()):
        raise ValueError(f"service_s: expected {n} finite numbers, none negative, got {service_s!r}")
    if n_sorties < 1:
        raise ValueError(f"n_sorties: expected 1 or more, got {n_sorties}")
    if not (math.isfinite(budget_s) and budget_s > 0.0):
        raise ValueError(f"budget_s: expected a positive number, got {budget_s}")
    if len(required) > n_sorties:
        raise ValueError(f"required: expected at most {n_sorties} sorties, got {len(required)}")
    search = _Search(travel_s, service_s, budget_s, n_sorties, n if max_stops is None else max_stops, gain, seed, stop)
    search.require(required)
    trace = Trace() if trace is None else trace
    bound = search.bound()
    search.fill(1.0, np.ones(n), is_first=True)
    search.keep_if_best()
    trace.record(search.best.value)
    last_success = 0
    for rounds in itertools.count():
        monitor.report(say("orienteering"), rounds, max_rounds or 0)
        limit = last_success + PATIENCE if max_rounds is None else max_rounds
        if rounds >= limit or search.best.value >= bound or stop():
            break
        value = search.best.value
        search.change()
        if search.keep_if_best():
            last_success = rounds
            if search.best.value > value:
                trace.record(search.best.value)
        elif (rounds - last_success) % RETURN == RETURN - 1:
            search.go_back()
    search.go_back()
    return search.selection(max(search.best.value, min(bound, search.bound())))


class _Snapshot(NamedTuple):
    """Routes as they were, their worth and the time they take."""

    routes: tuple[Ints, ...]
    value: float
    time_s: float


class _Search:
    """Routes being changed, with what they are worth. Places are stops counted from 1; place 0 is start and end."""

    def __init__(
        self,
        travel_s: Floats,
        service_s: Floats,
        budget_s: float,
        n_sorties: int,
        max_stops: int,
        gain: CoverageGain,
        seed: int,
        stop: Stop,
    ) -> None:
        n = len(service_s)
        self.travel_s = np.ascontiguousarray(travel_s, np.float64)
        self.service_s = np.concatenate([[0.0], service_s])
        self.budget_s = budget_s * (1.0 + FIT)
        self.max_stops = max_stops
        self.gain = gain
        self.rng = np.random.default_rng(seed)
        self.stop = stop
        alone_s = travel_s[0] + self.service_s + travel_s[:, 0]
        self.is_open = alone_s <= self.budget_s
        self.is_open[0] = False
        self.routes: list[Ints] = [np.zeros(0, np.int64) for _ in range(n_sorties)]
        self.spare_s = np.full(n_sorties, self.budget_s)
        self.added_s = np.empty((n_sorties, n + 1))
        self.position = np.empty((n_sorties, n + 1), np.int64)
        for i in range(n_sorties):
            self._set_route(i, self.routes[i])
        self.is_required = np.zeros(n + 1, np.bool_)
        self.best = self._snapshot()

    def require(self, sorties: Sorties) -> None:
        """Begin with these sorties, and never take their stops out again."""
        for i, sortie in enumerate(sorties):
            route = np.array(sortie, np.int64) + 1
            for place in route:
                self.gain.add(int(place) - 1)
            self.is_open[route] = False
            self.is_required[route] = True
            self._set_route(i, route)
        self.best = self._snapshot()

    def duration_s(self, route: Ints) -> float:
        """Time from start to end; 0 for a sortie that is not flown."""
        if len(route) == 0:
            return 0.0
        legs = self.travel_s[np.concatenate([[0], route]), np.concatenate([route, [0]])]
        return math.fsum([*legs, *self.service_s[route]])

    def _set_route(self, i: int, route: Ints, last: int | None = None) -> None:
        """Replace a route by one with the same stops, or whose stops the caller adds to or takes from the gain.

        Or by itself with one stop put in, its stop number `last`, which is quicker.
        """
        self.routes[i] = route
        self.spare_s[i] = self.budget_s - self.duration_s(route) if len(route) < self.max_stops else -math.inf
        if last is None:
            insertion.insertion_costs(self.travel_s, route, self.added_s[i], self.position[i])
        else:
            insertion.insertion_costs_with(self.travel_s, route, last, self.added_s[i], self.position[i])

    def _snapshot(self) -> _Snapshot:
        time_s = math.fsum(self.duration_s(route) for route in self.routes)
        return _Snapshot(tuple(route for route in self.routes), self.gain.value, time_s)

    def fill(self, exponent: float, noise: Floats, *, is_first: bool = False) -> None:
        """Put in stops while any fits that adds worth, the best by worth^exponent / time * noise first.

        Broken off when an end is asked for. The first time it goes on all the same, and looks again at what stops are
        worth only once there are more by the part `GROWN`.
        """
        worth, n_then, n_now = np.zeros(0), 0, 0
        while True:
            is_late = n_now > 0 and self.stop()
            if is_late and not is_first:
                return
            if not is_late or n_now >= (1.0 + GROWN) * n_then:
                worth, n_then = np.concatenate([[0.0], self.gain.marginals()]), n_now
            needed_s = self.added_s + self.service_s
            needed_s[needed_s > self.spare_s[:, None]] = math.inf
            route = np.argmin(needed_s, axis=0)
            needed_s = needed_s[route, np.arange(len(worth))]
            is_candidate = self.is_open & np.isfinite(needed_s) & (worth > WORTHLESS * worth.max())
            candidates = np.flatnonzero(is_candidate)
            if len(candidates) == 0:
                return
            # An added time of zero, or below where the way by a stop is shorter, must not divide.
            shortest_s = FIT * self.budget_s
            share = (worth[candidates] / worth.max()) ** exponent
            score = share / np.maximum(needed_s[candidates], shortest_s) * noise[candidates - 1]
            place = int(candidates[np.argmax(score)])
            i = int(route[place])
            self.gain.add(place - 1)
            self.is_open[place] = False
            at = int(self.position[i, place])
            self._set_route(i, np.insert(self.routes[i], at, place), at)
            n_now += 1

    def take_out(self, i: int, is_out: NDArray[np.bool_]) -> None:
        """Take stops out of one route and put the others in a shorter order."""
        route = self.routes[i]
        for place in route[is_out]:
            self.gain.remove(int(place) - 1)
            self.is_open[place] = True
        left = route[~is_out]
        insertion.shorten(self.travel_s, left, FIT * self.budget_s)
        self._set_route(i, left)

    def change(self) -> None:
        """One round: take some stops out, put in others, and keep the outcome or go back to where the round began."""
        before = self._snapshot()
        if not any(len(route) for route in before.routes):
            return
        self._ruin()
        noise = np.exp(self.rng.choice(NOISE) * self.rng.standard_normal(len(self.service_s) - 1))
        exponent = float(self.rng.choice(EXPONENTS))
        self.fill(exponent, noise)
        if self.stop():
            return
        for i, route in enumerate(self.routes):
            self.take_out(i, np.zeros(len(route), np.bool_))
        self.fill(exponent, noise)
        after = self._snapshot()
        least = before.value - TOLERANCE * self.rng.random() * self.best.value
        if after.value < least:
            self._restore(before)

    def _ruin(self) -> None:
        """Take out a stretch of one route, or stops near each other, or stops anywhere."""
        places = np.concatenate(self.routes)
        share = LARGEST_SHARE * self.rng.random() ** 2
        n_out = 1 + int(share * len(places))
        kind = self.rng.integers(3)
        if kind == 0:
            first = self.rng.integers(len(places))
            out = places[first : first + n_out]
        elif kind == 1:
            out = places[np.argsort(self.travel_s[self.rng.choice(places), places], kind="stable")[:n_out]]
        else:
            out = self.rng.choice(places, n_out, replace=False)
        for i, route in enumerate(self.routes):
            is_out = np.isin(route, out) & ~self.is_required[route]
            if is_out.any():
                self.take_out(i, is_out)

    def keep_if_best(self) -> bool:
        """Remember the routes if they are worth more than any before, or the same in less time; try to fit in more."""
        if not self._is_better(self._snapshot()):
            return False
        while True:
            self.best = self._snapshot()
            if self.stop():
                return True
            for i, route in enumerate(self.routes):
                self._set_route(i, self._reordered(route))
            self.fill(1.0, np.ones(len(self.service_s) - 1))
            if not self._is_better(self._snapshot()):
                return True

    def _is_better(self, snapshot: _Snapshot) -> bool:
        least = FIT * max(abs(self.best.value), abs(snapshot.value))
        if abs(snapshot.value - self.best.value) > least:
            return snapshot.value > self.best.value
        return snapshot.time_s < self.best.time_s - FIT * self.budget_s

    def _reordered(self, route: Ints) -> Ints:
        """The same stops in a shorter order, where one is found."""
        if len(route) < 4:
            return route
        places = np.concatenate([[0], route, [0]])
        cost = self.travel_s[np.ix_(places, places)]
        cost[0, 1:-1], cost[-1, 1:-1] = self.travel_s[0, route], self.travel_s[route, 0]
        cost[1:-1, 0], cost[1:-1, -1] = cost[0, 1:-1], cost[-1, 1:-1]
        inner = cost[1:-1, 1:-1]
        cost[1:-1, 1:-1] = (inner + inner.T) / 2.0
        cost[0, -1] = cost[-1, 0] = 0.0
        order = improve_tour(
            cost, np.arange(len(cost)), closed=False, max_kicks=ROUTE_KICKS * len(cost), stop=self.stop
        )
        shorter = places[order[1:-1]]
        return min(route, shorter, key=self.duration_s)

    def _restore(self, snapshot: _Snapshot) -> None:
        """Go back to routes as they were."""
        now = {int(place) for route in self.routes for place in route}
        then = {int(place) for route in snapshot.routes for place in route}
        for place in now - then:
            self.gain.remove(place - 1)
        for place in then - now:
            self.gain.add(place - 1)
        self.is_open[list(now - then)] = True
        self.is_open[list(then - now)] = False
        for i, route in enumerate(snapshot.routes):
            if route is not self.routes[i]:
                self._set_route(i, route)

    def go_back(self) -> None:
        """Go back to the best routes."""
        self._restore(self.best)

    def bound(self) -> float:
        """No selection is worth more.

        Worth is monotone and submodular, so any stops together add no more to the present ones than the sum of what
        each adds alone. Of those, the budgets admit no more than a fractional knapsack does in which a stop takes its
        service and half of the shortest leg to it and from it.
        """
        worth = self.gain.marginals().copy()
        present = np.concatenate(self.routes)
        worth[present - 1] = 0.0
        reachable = np.flatnonzero(self.is_open)
        places = np.concatenate([[0], reachable, present])
        legs = self.travel_s[np.ix_(places, places)]
        np.fill_diagonal(legs, np.inf)
        half_s = (legs.min(axis=0) + legs.min(axis=1)) / 2.0
        room_s = len(self.routes) * (self.budget_s - half_s[0])
        worth = worth[reachable - 1]
        size_s = self.service_s[reachable] + half_s[1 : 1 + len(reachable)]
        first = np.argsort(-worth / np.maximum(size_s, FIT * self.budget_s), kind="stable")
        before_s = np.cumsum(size_s[first]) - size_s[first]
        share = np.clip((room_s - before_s) / np.maximum(size_s[first], FIT * self.budget_s), 0.0, 1.0)
        n_most = len(self.routes) * self.max_stops
        most = np.sort(worth)[::-1][:n_most].sum()
        return self.gain.value + min(float(worth[first] @ share), float(most))

    def selection(self, bound: float) -> Selection:
        """The routes as they are, without those that have no stops."""
        flown = [route for route in self.routes if len(route) > 0]
        sorties = tuple(tuple(int(place) - 1 for place in route) for route in flown)
        return Selection(sorties, tuple(self.duration_s(route) for route in flown), self.gain.value, bound)


def compile_kernels() -> None:
    """Compile what this module runs."""
    tour.compile_kernels()
    insertion.compile_kernels()
