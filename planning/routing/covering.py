"""The shortest route that collects all there is to collect: which stops to make, and in which order (covering tour).

Stops overlap in what they are worth (`planning.routing.insertion`), so some can stand in for others nearby. Stops are
taken out and others put in until nothing is missing, over and over (ruin and recreate); the shortest route found is
kept.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, Trace, never
from planning.routing import insertion
from planning.routing.insertion import CoverageGain
from planning.routing.tour import check_costs

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

PATIENCE = 2000
"""Rounds without a shorter route before a search ends by itself."""

RETURN = 150
"""Rounds without a shorter route after which the search goes back to the shortest."""

TOLERANCE = 0.02
"""A round may make the route longer by up to this part."""

LARGEST_SHARE = 0.5
"""A round takes out up to this share of the stops."""

EXPONENTS, NOISE = (0.5, 1.0, 2.0), (0.0, 0.1, 0.3, 1.0)
"""Stops are put in by worth to one of these powers over the time they add, times random factors of one of these
spreads (standard deviation of the logarithm): one of each is drawn for a round."""

ROUNDING = 1e-9
"""Part of the whole worth, or of a duration, that is rounding."""


@dataclass(frozen=True, slots=True)
class Cover:
    """A route that collects everything.

    Parameters
    ----------
    route
        Its stops in order, numbered from 0.
    duration_s
        From the start over all stops to the end.
    """

    route: tuple[int, ...]
    duration_s: float


def shortest_cover(
    travel_s: Floats,
    service_s: Floats,
    gain: CoverageGain,
    first: Sequence[int] = (),
    *,
    seed: int = 0,
    max_rounds: int | None = None,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> Cover:
    """Shortest route found whose stops together are worth as much as all stops.

    Parameters
    ----------
    travel_s, service_s
        As in `planning.routing.orienteering.solve_orienteering`. All stops must be within reach of both ends.
    gain
        Worth of a set of stops, empty at first; holds the result's stops afterwards.
    first
        Stops to begin with, in order; none of the result's routes is longer than this one once it is complete.
    max_rounds
        Rounds of ruin and recreate; by default until `PATIENCE` brought nothing. With the seed they determine the
        result.
    trace
        Gets the duration whenever it falls.
    """
    check_costs(travel_s)
    n = len(travel_s) - 1
    if service_s.shape != (n,) or not (np.isfinite(service_s).all() and (service_s >= 0.0).all()):
        raise ValueError(f"service_s: expected {n} finite numbers, none negative, got {service_s!r}")
    if not np.isfinite(travel_s).all():
        raise ValueError("travel_s: expected a way between all stops")
    trace = Trace() if trace is None else trace
    search = _Search(travel_s, service_s, gain, seed)
    search.begin(first)
    trace.record(search.best_s)
    last_success = 0
    for rounds in itertools.count():
        monitor.report(say("shortening the flight"), rounds, max_rounds or 0)
        limit = last_success + PATIENCE if max_rounds is None else max_rounds
        if rounds >= limit or len(search.best) == 0 or stop():
            break
        if search.change():
            last_success = rounds
            trace.record(search.best_s)
        elif (rounds - last_success) % RETURN == RETURN - 1:
            search.set_route(search.best)
    search.set_route(search.best)
    return Cover(tuple(int(place) - 1 for place in search.best), search.best_s)


class _Search:
    """A route being changed. Places are stops counted from 1; place 0 is start and end."""

    def __init__(self, travel_s: Floats, service_s: Floats, gain: CoverageGain, seed: int) -> None:
        n = len(service_s)
        self.travel_s = np.ascontiguousarray(travel_s, np.float64)
        self.service_s = np.concatenate([[0.0], service_s])
        self.gain = gain
        self.rng = np.random.default_rng(seed)
        self.route: Ints = np.zeros(0, np.int64)
        self.is_in = np.zeros(n + 1, np.bool_)
        self.added_s, self.position = np.empty(n + 1), np.empty(n + 1, np.int64)
        self.best: Ints = self.route
        self.best_s = math.inf
        self.enough = self._worth_of_all() * (1.0 - ROUNDING)

    def _worth_of_all(self) -> float:
        """Worth of all stops together; leaves the set empty."""
        for place in range(1, len(self.is_in)):
            self.gain.add(place - 1)
        worth = self.gain.value
        for place in range(1, len(self.is_in)):
            self.gain.remove(place - 1)
        return worth

    def begin(self, first: Sequence[int]) -> None:
        """Complete the stops given, in their order."""
        self.set_route(np.array(first, np.int64) + 1)
        self._complete(1.0, np.ones(len(self.service_s)))
        self._keep_if_best()

    def duration_s(self, route: Ints) -> float:
        """Time from start to end."""
        if len(route) == 0:
            return 0.0
        legs = self.travel_s[np.concatenate([[0], route]), np.concatenate([route, [0]])]
        return math.fsum([*legs, *self.service_s[route]])

    def set_route(self, route: Ints) -> None:
        """Go to another route."""
        now, then = set(self.route.tolist()), set(route.tolist())
        for place in now - then:
            self.gain.remove(place - 1)
        for place in then - now:
            self.gain.add(place - 1)
        self.is_in[:] = False
        self.is_in[route] = True
        self.route = route

    def change(self) -> bool:
        """One round; whether it found the shortest route so far."""
        before = self.route
        before_s = self.duration_s(before)
        self.set_route(self.route[~self._ruined()])
        self._shorten()
        noise = np.exp(self.rng.choice(NOISE) * self.rng.standard_normal(len(self.service_s)))
        self._complete(float(self.rng.choice(EXPONENTS)), noise)
        if self._keep_if_best():
            return True
        if self.duration_s(self.route) > before_s * (1.0 + TOLERANCE * self.rng.random() ** 2):
            self.set_route(before)
        return False

    def _ruined(self) -> NDArray[np.bool_]:
        """Which stops of the route go: a stretch, stops near each other, or stops anywhere."""
        k = len(self.route)
        n_out = 1 + int(LARGEST_SHARE * self.rng.random() ** 2 * k)
        kind = self.rng.integers(3)
        if kind == 0:
            out = (self.rng.integers(k) + np.arange(n_out)) % k
        elif kind == 1:
            out = np.argsort(self.travel_s[self.rng.choice(self.route), self.route], kind="stable")[:n_out]
        else:
            out = self.rng.choice(k, n_out, replace=False)
        is_out = np.zeros(k, np.bool_)
        is_out[out] = True
        return is_out

    def _complete(self, exponent: float, noise: Floats) -> None:
        """Put in stops by worth^exponent / time * noise until nothing is missing, then do without the needless ones."""
        least_s = ROUNDING * max(float(self.travel_s.max()), 1.0)
        while self.gain.value < self.enough:
            worth = np.concatenate([[0.0], self.gain.marginals()])
            worth[self.is_in] = 0.0
            insertion.insertion_costs(self.travel_s, self.route, self.added_s, self.position)
            candidates = np.flatnonzero(worth > ROUNDING * worth.max())
            # An added time of zero, or below where the way by a stop is shorter, must not divide.
            needed_s = np.maximum(self.added_s[candidates] + self.service_s[candidates], least_s)
            score = (worth[candidates] / worth.max()) ** exponent / needed_s * noise[candidates]
            place = int(candidates[np.argmax(score)])
            self.set_route(np.insert(self.route, self.position[place], place))
        self._drop_needless()
        self._shorten()

    def _drop_needless(self) -> None:
        """Take out stops without which nothing is missing, in random order."""
        for place in self.rng.permutation(self.route):
            self.gain.remove(int(place) - 1)
            if self.gain.value >= self.enough:
                self.is_in[place] = False
            else:
                self.gain.add(int(place) - 1)
        self.route = self.route[self.is_in[self.route]]

    def _shorten(self) -> None:
        """Put the stops in a shorter order."""
        route = self.route.copy()
        insertion.shorten(self.travel_s, route, ROUNDING * max(float(self.travel_s.max()), 1.0))
        self.route = route

    def _keep_if_best(self) -> bool:
        """Remember the route if it is shorter than any before."""
        duration_s = self.duration_s(self.route)
        if duration_s >= self.best_s * (1.0 - ROUNDING):
            return False
        self.best, self.best_s = self.route, duration_s
        return True


def cover_bound_s(travel_s: Floats, service_s: Floats, covers: Sequence[NDArray[np.int32]], n_wanted: int) -> float:
    """No route that collects all of `n_wanted` things is shorter than this, seconds.

    Parameters
    ----------
    covers
        The things that each stop collects, numbered from 0; each is collected somewhere.

    Notes
    -----
    Two bounds, the larger counts. Every stop takes at least its service and half of the shortest leg to it and from it,
    and so do both ends of the route; a fractional choice of stops (a linear programme) that collects everything at that
    price is no dearer than any route. And some stop must be made for the thing that lies furthest away; that it takes
    at least as long as a flight there alone supposes travel times of shortest ways.
    """
    if n_wanted == 0:
        return 0.0
    from scipy.optimize import Bounds, LinearConstraint, milp
    from scipy.sparse import csr_array

    legs = np.array(travel_s, np.float64)
    np.fill_diagonal(legs, np.inf)
    half_s = (legs.min(axis=0) + legs.min(axis=1)) / 2.0
    starts = np.concatenate([[0], np.cumsum([len(items) for items in covers])])
    things = np.concatenate([np.zeros(0, np.int32), *covers])
    stops = np.repeat(np.arange(len(covers)), np.diff(starts))
    is_collected_by = csr_array((np.ones(len(things)), (things, stops)), shape=(n_wanted, len(covers)))
    price_s = service_s + half_s[1:]
    solved = milp(price_s, bounds=Bounds(0.0, 1.0), constraints=[LinearConstraint(is_collected_by, lb=1.0)])
    alone_s = travel_s[0, 1:] + service_s + travel_s[1:, 0]
    nearest_s = np.full(n_wanted, np.inf)
    np.minimum.at(nearest_s, things, alone_s[stops])
    fractional_s = float(half_s[0] + solved.fun) if solved.x is not None else 0.0
    return max(float(nearest_s.max()), fractional_s)
