"""Sharing viewpoints out among sorties: as few batteries as possible, then as little time in the air as possible.

One tour through home and all viewpoints is cut into sorties by dynamic programming (J. Beasley, 1983; C. Prins, 2004),
then stops are moved between sorties by ruin and recreate (`planning.routing.string_removal`), and the stops of each
sortie are put in order once more by `planning.routing.tour`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.base.jit import kernel
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, Trace, never, slices
from planning.routing import insertion, string_removal, tour
from planning.routing import tour as exact_tour
from planning.routing.lower_bound import held_karp_bound
from planning.routing.string_removal import Annealing, Limits, Routes
from planning.routing.tour import check_costs, improve_tour, nearest_neighbour

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Sorties = tuple[tuple[int, ...], ...]
"""The stops of every sortie in the order they are flown, numbered from 0."""

FIT = 1e-9
"""Part of the budget by which a sortie may exceed it: the rounding of summed times, under 3 microseconds an hour."""

TOUR_KICKS, ROUTE_KICKS = 200, 50
"""Kicks a point for the tour that is cut up, and for each sortie afterwards."""

ROUNDS, LEAST_STOPS = 1000, 20
"""Rounds of ruin and recreate a stop before a search ends by itself; fewer stops get as many rounds as these."""

FIRST_CYCLE = 100
"""Rounds a stop until the temperature has fallen for the first time; every cycle takes twice as long as the last."""

HOT, COLD = 1.0, 0.01
"""Temperature at the start and at the end of a cycle, in mean legs. On X-n134, X-n157 and X-n1001 0.3 to start with
and 0.001 or 0.03 to end with were worse after 5 s."""

FLEET_ROUNDS = 1000
"""Rounds a stop spent on doing with one sortie less, before it is given up."""

MAX_BOUND_STOPS = 1000
"""Stops up to which the travel counts for the lower bound on the number of sorties: shortest ways take n^3 steps, one
second for 1000."""

N_NEAR = 200
"""Stops around a random one among which strings are taken out."""


@dataclass(frozen=True, slots=True, eq=False)
class SortieProblem:
    """What is to be flown, and what one sortie may take.

    Parameters
    ----------
    travel_s
        Shape (n + 1, n + 1), seconds from row to column; row and column 0 are home. Infinite where there is no way.
    service_s
        Shape (n,), seconds spent at each stop.
    budget_s
        Longest duration of a sortie, from home to home.
    load, capacity
        Shape (n,): what each stop adds to a sortie, and how much a sortie takes; with loads of 1 the greatest number
        of stops.
    fewest_first
        Fly as few sorties as possible, whatever time that takes; otherwise only the total time counts.
    """

    travel_s: Floats
    service_s: Floats
    budget_s: float
    load: Floats
    capacity: float
    fewest_first: bool = True

    def __post_init__(self) -> None:
        check_costs(self.travel_s)
        n = len(self.travel_s) - 1
        for name in ("service_s", "load"):
            values = getattr(self, name)
            if values.shape != (n,) or not (np.isfinite(values).all() and (values >= 0.0).all()):
                raise ValueError(f"{name}: expected {n} finite numbers, none negative, got {values!r}")
        if not self.budget_s > 0.0:
            raise ValueError(f"budget_s: expected more than 0, got {self.budget_s}")
        if not self.capacity > 0.0:
            raise ValueError(f"capacity: expected more than 0, got {self.capacity}")

    @property
    def n_stops(self) -> int:
        """Number of stops, home not counted."""
        return len(self.service_s)


def plan_sorties(
    travel_s: Floats,
    service_s: Floats,
    budget_s: float,
    max_stops: int | None = None,
    *,
    names: Sequence[str] | None = None,
    seed: int = 0,
    max_rounds: int | None = None,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> Sorties:
    """Sorties that visit every viewpoint once, each within the budget.

    Parameters
    ----------
    travel_s, service_s, budget_s
        As in `SortieProblem`.
    max_stops
        Most viewpoints in one sortie (an aircraft's limit of waypoints, for example).
    names
        What to call the viewpoints in messages.
    max_rounds
        Rounds of improvement; by default `ROUNDS` times n. With the seed they determine the result.
    trace
        Gets the total duration of all sorties, seconds, whenever it falls; it may rise where a sortie is saved.

    Returns
    -------
    sorties
        As few as could be found, together as short as could be found.

    Raises
    ------
    InfeasibleError
        A viewpoint cannot be reached, or takes more than the budget on a sortie of its own. (Travel times must be those
        of shortest ways, so that no detour over another viewpoint can be any shorter.)
    """
    if max_stops is not None and max_stops < 1:
        raise ValueError(f"max_stops: expected 1 or more, got {max_stops}")
    n = len(service_s)
    problem = SortieProblem(travel_s, service_s, budget_s, np.ones(n), math.inf if max_stops is None else max_stops)
    check_single_sorties(problem, names)
    return solve_sorties(problem, seed=seed, max_rounds=max_rounds, stop=stop, trace=trace, monitor=monitor)


def check_single_sorties(problem: SortieProblem, names: Sequence[str] | None = None) -> None:
    """Raise `InfeasibleError` naming the worst stop that no sortie can take even alone."""
    alone_s = problem.travel_s[0, 1:] + problem.service_s + problem.travel_s[1:, 0]
    too_far = np.flatnonzero(alone_s > problem.budget_s * (1.0 + FIT))
    if len(too_far):
        worst = int(too_far[np.argmax(alone_s[too_far])])
        name = say("viewpoint {}", worst if names is None else names[worst])
        others = say(" ({} more are too far as well)", len(too_far) - 1) if len(too_far) > 1 else ""
        if math.isinf(alone_s[worst]):
            raise InfeasibleError.say("{} cannot be reached from home and left again{}; leave it out", name, others)
        raise InfeasibleError.say(
            "{} takes {:.1f} s on a sortie of its own, but a battery allows {:.1f} s{}; move home closer, "
            "raise the speed, lower the reserve or leave it out",
            name,
            alone_s[worst],
            problem.budget_s,
            others,
        )
    heavy = np.flatnonzero(problem.load > problem.capacity)
    if len(heavy):
        raise InfeasibleError.say(
            "stop {} has a load of {}, above {}", heavy[0], problem.load[heavy[0]], problem.capacity
        )


def sortie_durations_s(problem: SortieProblem, sorties: Sorties) -> tuple[float, ...]:
    """Duration of each sortie from home to home, seconds."""
    durations = []
    for sortie in sorties:
        places = np.array([0, *(stop + 1 for stop in sortie), 0])
        services = problem.service_s[list(sortie)]
        durations.append(math.fsum([*problem.travel_s[places[:-1], places[1:]], *services]))
    return tuple(durations)


def solve_sorties(
    problem: SortieProblem,
    *,
    seed: int = 0,
    max_rounds: int | None = None,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> Sorties:
    """`plan_sorties` for a problem whose stops all fit on a sortie of their own (`check_single_sorties`)."""
    if problem.n_stops == 0:
        return ()
    return _Solver(problem, seed, stop, Trace() if trace is None else trace, monitor).solve(max_rounds)


class _Solver:
    """The steps of `solve_sorties`, and what they share."""

    def __init__(self, problem: SortieProblem, seed: int, stop: Stop, trace: Trace, monitor: Monitor) -> None:
        self.problem = problem
        self.limits = _limits(problem)
        self.cost = _symmetric(problem.travel_s)
        self.is_symmetric = np.array_equal(problem.travel_s, problem.travel_s.T)
        self.n_busy = max(problem.n_stops, LEAST_STOPS)
        self.seed = seed
        self.rng = np.random.default_rng(seed)
        self.stop = stop
        self.trace = trace
        self.monitor = monitor

    def solve(self, max_rounds: int | None) -> Sorties:
        """Cut a tour, do with fewer sorties where possible, then shorten them."""
        sorties = self._record(self._cut_tour())
        with_fewer = self.problem.fewest_first and not self.stop()
        fewest = fewest_sorties(self.problem) if with_fewer else len(sorties)
        while len(sorties) > fewest and (fewer := self._with_one_less(sorties)) is not None:
            sorties = self._record(fewer)
        if len(sorties) > 1 or not self.is_symmetric:
            sorties = self._anneal(sorties, ROUNDS * self.n_busy if max_rounds is None else max_rounds)
        return self._record(self._reordered(sorties, None if len(sorties) == 1 else ROUTE_KICKS))

    def _total_s(self, sorties: Sorties) -> float:
        return math.fsum(sortie_durations_s(self.problem, sorties))

    def _record(self, sorties: Sorties) -> Sorties:
        self.trace.record(self._total_s(sorties))
        return sorties

    def _cut_tour(self) -> Sorties:
        """A short tour through everything, cut into sorties in the better of its two directions."""
        kicks = TOUR_KICKS * len(self.cost)
        start = nearest_neighbour(self.cost)
        order = improve_tour(self.cost, start, seed=self.seed, max_kicks=kicks, stop=self.stop, monitor=self.monitor)
        both = [self._cut(order[1:]), self._cut(order[:0:-1].copy())]
        fewest_first = self.problem.fewest_first
        return min(both, key=lambda sorties: (len(sorties) if fewest_first else 0, self._total_s(sorties)))

    def _cut(self, order: Ints) -> Sorties:
        """Best way to fly the stops in this order (places 1 to n), one sortie after the other."""
        cuts = _best_cuts(self.limits, order, self.problem.fewest_first)
        return tuple(tuple(int(place) - 1 for place in order[a:b]) for a, b in itertools.pairwise(cuts))

    def _with_one_less(self, sorties: Sorties) -> Sorties | None:
        """As many sorties less one, or None where no way was found."""
        durations = sortie_durations_s(self.problem, sorties)
        shortest = durations.index(min(durations))
        kept = sorties[:shortest] + sorties[shortest + 1 :]
        absent = np.array(sorties[shortest], np.int64) + 1
        run = self._annealing(kept, len(kept), absent)
        n_rounds = FLEET_ROUNDS * self.n_busy
        run.status[3] = HOT * self._mean_leg_s(sorties)
        cooling = (COLD / HOT) ** (1.0 / n_rounds)
        rounds = 0
        for some_rounds in slices(n_rounds, first=100):
            self.monitor.report(say("fewer sorties"), rounds, n_rounds)
            if string_removal.place_absent(self.limits, run, some_rounds, cooling, self.rng):
                return _as_sorties(run.best, self.problem.n_stops)
            if self.stop():
                break
            rounds += some_rounds
        return None

    def _anneal(self, sorties: Sorties, max_rounds: int) -> Sorties:
        """Shorten sorties in cycles of cooling, each twice as long as the last."""
        n_spare = 0 if self.problem.fewest_first else 1 + len(sorties) // 8
        rounds = 0
        cycle = FIRST_CYCLE * self.n_busy
        while rounds < max_rounds and not self.stop():
            sorties = self._reordered(sorties, ROUTE_KICKS)
            run = self._annealing(sorties, len(sorties) + n_spare)
            run.status[3] = HOT * self._mean_leg_s(sorties)
            cooling = (COLD / HOT) ** (1.0 / cycle)
            for some_rounds in slices(min(cycle, max_rounds - rounds), first=100):
                self.monitor.report(say("sorties"), rounds, max_rounds)
                string_removal.anneal(self.limits, run, some_rounds, cooling, self.rng)
                rounds += some_rounds
                if run.status[1] < self.trace.points[-1].value:
                    self.trace.record(float(run.status[1]))
                if self.stop():
                    break
            sorties = _as_sorties(run.best, self.problem.n_stops)
            cycle *= 2
        return sorties

    def _mean_leg_s(self, sorties: Sorties) -> float:
        travel_s = self._total_s(sorties) - math.fsum(self.problem.service_s)
        return travel_s / (self.problem.n_stops + len(sorties))

    def _annealing(self, sorties: Sorties, n_sorties: int, absent: Ints | None = None) -> Annealing:
        """State of a search that starts from `sorties` and may use `n_sorties`."""
        n = self.problem.n_stops
        current, candidate, best = (string_removal.empty_routes(n, n_sorties) for _ in range(3))
        for i, sortie in enumerate(sorties):
            previous = n + 1 + i
            for stop in sortie:
                string_removal.insert(self.limits, current, stop + 1, previous)
                previous = stop + 1
        string_removal.copy_routes(current, best)
        absent = np.zeros(0, np.int64) if absent is None else absent
        total_s = current.duration.sum()
        return Annealing(
            current=current,
            candidate=candidate,
            best=best,
            absent=np.concatenate([absent, np.zeros(n + 1 - len(absent), np.int64)]),
            removed=np.zeros(n + 1, np.int64),
            absences=np.zeros(n + 1),
            status=np.array([total_s, total_s, len(absent), 0.0, 0.0]),
        )

    def _reordered(self, sorties: Sorties, kicks: int | None) -> Sorties:
        """Same sorties, the stops of each in the best order that so many kicks a point find."""
        return tuple(self._shortest_order(sortie, kicks) for sortie in sorties)

    def _shortest_order(self, sortie: tuple[int, ...], kicks: int | None) -> tuple[int, ...]:
        places = np.array([0, *(stop + 1 for stop in sortie)])
        if len(places) <= exact_tour.MAX_POINTS:
            # Sums of what stands for a missing leg stay finite, and such an order is never the shortest below.
            order = exact_tour.exact_tour(np.minimum(self.problem.travel_s[np.ix_(places, places)], 1e100))
            tries = [places[order[1:]]]
        else:
            cost = self.cost[np.ix_(places, places)]
            max_kicks = None if kicks is None else kicks * len(places)
            order = improve_tour(cost, np.arange(len(places)), seed=self.seed, max_kicks=max_kicks, stop=self.stop)
            tries = [places[order[1:]], places[order[:0:-1]]]
            if not self.is_symmetric:
                for route in tries:
                    insertion.shorten(self.problem.travel_s, route, FIT * self.problem.budget_s)
        candidates = [sortie, *(tuple(int(place) - 1 for place in route) for route in tries)]
        return min(candidates, key=lambda stops: self._total_s((stops,)))


def _as_sorties(routes: Routes, n_stops: int) -> Sorties:
    """The sorties that have stops."""
    sorties = []
    for home in range(n_stops + 1, len(routes.after)):
        stops = []
        place = routes.after[home]
        while place != home:
            stops.append(int(place) - 1)
            place = routes.after[place]
        if stops:
            sorties.append(tuple(stops))
    return tuple(sorties)


@kernel
def _best_cuts(limits: Limits, order: Ints, fewest_first: bool) -> Ints:
    """Positions in `order` where sorties begin, and its end; shortest path over all sorties that keep the limits."""
    travel = limits.travel
    n = len(order)
    n_sorties = np.full(n + 1, n + 1, np.int64)
    duration = np.full(n + 1, np.inf)
    begin = np.zeros(n + 1, np.int64)
    n_sorties[0], duration[0] = 0, 0.0
    for first in range(n):
        out = load = 0.0
        place = 0
        for last in range(first, n):
            out += travel[place, order[last]] + limits.service[order[last]]
            load += limits.load[order[last]]
            place = order[last]
            if out > limits.budget or load > limits.capacity:
                break
            flown = out + travel[place, 0]
            total, count = duration[first] + flown, n_sorties[first] + 1
            is_fewer = fewest_first and count < n_sorties[last + 1]
            is_more = fewest_first and count > n_sorties[last + 1]
            if flown <= limits.budget and (is_fewer or (total < duration[last + 1] and not is_more)):
                n_sorties[last + 1], duration[last + 1], begin[last + 1] = count, total, first
    cuts = [n]
    while cuts[-1] > 0:
        cuts.append(begin[cuts[-1]])
    return np.array(cuts[::-1])


def fewest_sorties(problem: SortieProblem) -> int:
    """Proven lower bound on the number of sorties.

    Any sorties together visit everything, so they take at least as long as the shortest tour over shortest ways
    (bounded by `held_karp_bound`); none takes more than the budget, nor more than the capacity.
    """
    if problem.n_stops == 0:
        return 0
    tour_s = 0.0
    if problem.n_stops <= MAX_BOUND_STOPS:
        ways = _shortest_ways(np.minimum(problem.travel_s, problem.travel_s.T))
        tour_s = held_karp_bound(ways, 2.0 * float(ways[0].sum()))
    busy_s = math.fsum(problem.service_s) + tour_s
    by_time = math.ceil(busy_s / (problem.budget_s * (1.0 + FIT)) - FIT)
    by_load = math.ceil(math.fsum(problem.load) / problem.capacity - FIT)
    return max(1, by_time, by_load)


@kernel
def _shortest_ways(cost: Floats) -> Floats:
    """Lengths of the shortest ways over any other points (R. Floyd, 1962; S. Warshall, 1962)."""
    ways = cost.copy()
    n = len(ways)
    for via in range(n):
        for i in range(n):
            to_via = ways[i, via]
            for j in range(n):
                ways[i, j] = min(ways[i, j], to_via + ways[via, j])
    return ways


def _symmetric(travel_s: Floats) -> Floats:
    """Mean of the two directions; where there is no leg, the way by home."""
    cost = (travel_s + travel_s.T) / 2.0
    return np.where(np.isinf(cost), cost[:, :1] + cost[:1, :], cost)


def _limits(problem: SortieProblem) -> Limits:
    cost = _symmetric(problem.travel_s)
    np.fill_diagonal(cost, -1.0)  # each stop is the nearest to itself, also among others at the same place
    home = np.zeros(1)
    return Limits(
        travel=np.ascontiguousarray(problem.travel_s, np.float64),
        service=np.concatenate([home, problem.service_s]),
        load=np.concatenate([home, problem.load]),
        budget=problem.budget_s * (1.0 + FIT),
        capacity=problem.capacity * (1.0 + FIT),
        near=1 + np.argsort(cost[:, 1:], axis=1, kind="stable")[:, :N_NEAR],
    )


def compile_kernels() -> None:
    """Compile what this module runs."""
    tour.compile_kernels()
    insertion.compile_kernels()
    n = 8
    problem = SortieProblem(np.ones((n + 1, n + 1)), np.ones(n), 9.0, np.ones(n), 5.0)
    solve_sorties(problem, max_rounds=1)
    _Solver(problem, 0, lambda: True, Trace(), QUIET)._with_one_less(((0, 1, 2, 3), (4, 5, 6, 7)))
