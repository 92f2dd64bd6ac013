"""The shortest flight that shows all wanted sections, and what batteries allow of it otherwise.

Which candidates are flown, and in which order, is settled together: the shortest route that shows everything
(`planning.routing.covering`), or the most that fits into the sorties allowed (`planning.routing.orienteering`).
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.optimise.budget import CoverGain
from planning.optimise.candidates import keep
from planning.optimise.closing_candidates import Candidates, Wanted, candidates
from planning.optimise.greedy import choose_greedily, needed
from planning.optimise.problem import take
from planning.plan import ViewpointArrays
from planning.progress import QUIET, Monitor, Stop, TimeLimit, Trace, any_of, never
from planning.routing.covering import cover_bound_s, shortest_cover
from planning.routing.orienteering import solve_orienteering
from planning.routing.tour import nearest_neighbour

ROUND_S = 1.5
"""Longest time spent on one set of candidates before fresh ones are tried."""

IDLE_ROUNDS, LEAST_GAIN = 2, 0.002
"""The search ends by itself after this many rounds in a row that shortened the flight by less than this part."""


@dataclass(frozen=True, slots=True, eq=False)
class Shortest:
    """Views in the order of flight that show all wanted sections that can be shown.

    Parameters
    ----------
    shown
        Numbers of these sections, rising.
    in_sight
        Likewise of all that any allowed place was found to show, however far away.
    duration_s
        Time of a single flight through all, take-off and landing apart; it may be longer than a battery lasts.
    bound_s
        No single flight over the candidates that were compared last is shorter and shows as much.
    """

    views: ViewpointArrays
    shown: NDArray[np.int32]
    in_sight: NDArray[np.int32]
    duration_s: float
    bound_s: float


@dataclass(frozen=True, slots=True, eq=False)
class Most:
    """Views that fit into the sorties allowed.

    Parameters
    ----------
    groups
        Views of each sortie in the order of flight.
    bound
        No such sorties over the candidates that were compared show more wanted sections.
    """

    groups: tuple[ViewpointArrays, ...]
    bound: int


def show_all(
    wanted: Wanted,
    known: ViewpointArrays,
    *,
    seed: int = 0,
    stop: Stop = never,
    durations: Trace | None = None,
    monitor: Monitor = QUIET,
) -> Shortest:
    """Shortest single flight found that shows all wanted sections that can be shown; anytime.

    It is no longer than one through those of the `known` views, in their order, that are needed, by the times that
    solvers use (`planning.routing.flights.flight_times`).

    Parameters
    ----------
    durations
        Gets the duration whenever it falls.
    """
    rng = np.random.default_rng(seed)
    search = _Shortening(wanted, known, Trace() if durations is None else durations)
    in_sight = np.zeros(0, np.int32)
    idle = 0
    for round_number in itertools.count():
        found = candidates(wanted, search.views, rng, monitor)
        in_sight = np.union1d(in_sight, found.in_sight)
        limit = any_of(stop, TimeLimit(ROUND_S))
        idle = 0 if search.among(found, seed + round_number, limit, monitor) else idle + 1
        if idle == IDLE_ROUNDS or len(found.shown) == 0 or stop():
            break
    monitor.report("bounding the optimum", 0, 1)
    return Shortest(search.views, found.shown, in_sight, search.duration_s, _bound_s(found))


class _Shortening:
    """The shortest flight so far, through the candidates of round after round."""

    def __init__(self, wanted: Wanted, known: ViewpointArrays, durations: Trace) -> None:
        self.views = known
        self.duration_s, self._n_shown = np.inf, 0
        self._wanted, self._durations = wanted, durations

    def among(self, found: Candidates, seed: int, stop: Stop, monitor: Monitor) -> bool:
        """Look for a flight among candidates that shows more or is shorter; whether there was one.

        The first candidates are the views at hand, so none shows less.
        """
        n_known = int(np.count_nonzero(found.is_known))
        gain = CoverGain(found.pool.elements, np.ones(len(self._wanted.elements)))
        starts = [np.arange(n_known)] if np.isfinite(self.duration_s) else self._starts(found)
        travel_s, service_s = found.times.travel_s, found.times.service_s
        covers = []
        for start in starts:
            covers.append(shortest_cover(travel_s, service_s, gain, start.tolist(), max_rounds=0))
            for number in covers[-1].route:
                gain.remove(number)
        first = min(covers, key=lambda cover: cover.duration_s)
        trace = Trace(self._durations.clock, lambda point: self._record(point.value))
        cover = shortest_cover(
            travel_s, service_s, gain, first.route, seed=seed, stop=stop, trace=trace, monitor=monitor
        )
        shows_more = len(found.shown) > self._n_shown
        is_shorter = cover.duration_s < self.duration_s * (1.0 - LEAST_GAIN)
        if shows_more or cover.duration_s < self.duration_s:
            self._n_shown = len(found.shown)
            self.views, self.duration_s = take(found.pool.views, np.array(cover.route, np.int64)), cover.duration_s
        return shows_more or is_shorter

    def _starts(self, found: Candidates) -> list[NDArray[np.int64]]:
        """Two routes to begin with: the known views that are needed, and the fewest views, from each to the nearest."""
        weights = np.ones(len(self._wanted.elements))
        is_first = np.flatnonzero(found.is_known)
        known = is_first[needed(keep(found.pool, found.is_known).elements, weights)]
        fewest, _ = choose_greedily(found.pool, weights, len(found.is_known), np.inf, Trace(), QUIET)
        places = np.concatenate([[0], fewest + 1])
        order = nearest_neighbour(found.times.travel_s[np.ix_(places, places)])
        return [known, fewest[order[1:] - 1]]

    def _record(self, duration_s: float) -> None:
        points = self._durations.points
        if not points or duration_s < points[-1].value:
            self._durations.record(duration_s)


def _bound_s(found: Candidates) -> float:
    elements, shown = found.pool.elements, found.shown
    number = np.zeros(int(shown.max(initial=0)) + 1, np.int32)
    number[shown] = np.arange(len(shown), dtype=np.int32)
    covers = [number[elements.of(view)] for view in range(len(found.is_known))]
    return cover_bound_s(found.times.travel_s, found.times.service_s, covers, len(shown))


def show_most(
    wanted: Wanted,
    known: ViewpointArrays,
    budget_s: float,
    n_sorties: int,
    *,
    seed: int = 0,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> Most:
    """Views within `n_sorties` of `budget_s` that show as many wanted sections as could be found; anytime.

    `trace` gets the number of sections whenever it rises.
    """
    found = candidates(wanted, known, np.random.default_rng(seed), monitor)
    selection = solve_orienteering(
        found.times.travel_s,
        found.times.service_s,
        budget_s,
        n_sorties,
        CoverGain(found.pool.elements, np.ones(len(wanted.elements))),
        max_stops=max(1, wanted.aircraft.max_waypoints - 2),
        seed=seed,
        stop=stop,
        trace=trace,
        monitor=monitor,
    )
    groups = tuple(take(found.pool.views, np.array(sortie, np.int64)) for sortie in selection.sorties)
    return Most(groups, int(min(selection.bound + 1e-6, len(found.shown))))
