"""Flights that show wanted sections within given batteries: everything in the shortest time, or else the most.

Their candidates are the views of the plan that show what is missing, its witnesses, and places around both.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.base.jit import chunks
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, TimeLimit, Trace, any_of, never
from planning.coverage.model import Elements, codes_all_around
from planning.coverage.positions import aimed_views, spread_positions
from planning.coverage.reach_kernel import REACHABLE
from planning.parameters import FlightRules
from planning.plan import Aircraft, ViewpointArrays
from planning.planner import as_written
from planning.routing.covering import cover_bound_s, shortest_cover
from planning.routing.flights import ATTEMPTS, Flight, FlightTimes, draw_flights, flight_times, plan_flights
from planning.routing.orienteering import solve_orienteering
from planning.routing.tour import nearest_neighbour
from planning.viewpoints.budget import CoverGain, shortlist
from planning.viewpoints.candidates import Pool, join_pools, keep
from planning.viewpoints.greedy import choose_greedily, necessary_views
from planning.viewpoints.problem import NONE_LOCKED, ViewProblem, concatenate, take
from planning.viewpoints.spacing import merge_close_views

# Views from which wanted sections are seen: the views that were to show them, places around those, and others.
#
# Each place is aimed at what is wanted; views that are known to show some of it are kept as they are.

Array = NDArray[np.float64]

MAX_CANDIDATES = 400
"""Candidates whose routes are compared, beside those that were known before: their leg table takes 0.3 s."""

DEPTHS = range(1, 13)
"""They are the greedy choices for showing each wanted section once, then twice and so on: variety to route by. With
three depths top-ups of the library took 4 % longer after 5 s."""

N_SPREAD = 4000
MAX_NEIGHBOURS = 4000
"""Spread positions, and positions around known views and witnesses, per round."""

MAX_WITNESSES = 500
"""Witnesses of sections that known views show, about; those of the others are all tried."""

NEIGHBOUR_SCALES_M = (0.5, 12.0)
"""Positions around a known one are moved by 0.5 m, where waypoints may be that close, to 12 m."""

POINTS_PER_CHUNK = 4_000_000
"""Pairs of position and panel looked at at a time: bounds the memory to 16 MB."""


@dataclass(frozen=True, slots=True, eq=False)
class ClosingTask:
    """Sections that are to be seen, and how they may be flown to.

    Parameters
    ----------
    elements
        Panel * n_sections + section of each, shape (w,), rising.
    longest_s
        Time that a single flight may take between take-off and landing; views further away than that are left out.
    """

    problem: ViewProblem
    aircraft: Aircraft
    rules: FlightRules
    elements: NDArray[np.int64]
    longest_s: float

    def mask(self) -> NDArray[np.bool_]:
        """Whether each element is wanted, shape (n_elements,)."""
        task = np.zeros(self.problem.model.n_elements, np.bool_)
        task[self.elements] = True
        return task

    def pool(self, views: ViewpointArrays) -> Pool:
        """The views with the wanted sections that each shows, numbered as in `elements`."""
        number = np.full(self.problem.model.n_elements, -1, np.int32)
        number[self.elements] = np.arange(len(self.elements), dtype=np.int32)
        found = self.problem.model.elements(views)
        items = number[found.items]
        before = np.concatenate([[0], np.cumsum(items >= 0)])
        return Pool(views, Elements(before[found.starts].astype(np.int64), items[items >= 0]))


@dataclass(frozen=True, slots=True, eq=False)
class Candidates:
    """Candidates within reach of a single flight, and the times between them.

    Parameters
    ----------
    is_known
        Which of them were known before, shape (n,); they come first.
    in_sight
        Numbers of the wanted sections that these or candidates out of reach show, rising.
    """

    pool: Pool
    is_known: NDArray[np.bool_]
    times: FlightTimes
    in_sight: NDArray[np.int32]

    @property
    def shown(self) -> NDArray[np.int32]:
        """Numbers of the wanted sections that any of them shows, rising."""
        return np.unique(self.pool.elements.items)


def candidates(
    task: ClosingTask, known: ViewpointArrays, rng: np.random.Generator, monitor: Monitor = QUIET
) -> Candidates:
    """Views to choose from; those of the `known` ones that show anything wanted come first."""
    problem = task.problem
    monitor.report(say("trying viewpoints"), 0, 1)
    first = _useful(task.pool(as_written(problem, known)))
    found = as_written(problem, _aimed(task, _places(task, first, rng), rng))
    further = shortlist(_useful(task.pool(found)), np.ones(len(task.elements)), None, MAX_CANDIDATES, DEPTHS)
    pool = join_pools(first, _well_apart(task, first, further))
    in_sight = np.unique(pool.elements.items)
    is_known = np.arange(len(pool.views.heading_rad)) < len(first.views.heading_rad)
    times = flight_times(problem.roadmap, pool.views, task.aircraft, task.rules, monitor)
    alone_s = times.travel_s[0, 1:] + times.service_s + times.travel_s[1:, 0]
    within = alone_s <= task.longest_s
    if not within.all():
        pool, is_known = keep(pool, within), is_known[within]
        times = flight_times(problem.roadmap, pool.views, task.aircraft, task.rules, monitor)
    return Candidates(pool, is_known, times, in_sight)


def _useful(pool: Pool) -> Pool:
    return keep(pool, np.diff(pool.elements.starts) > 0)


def _well_apart(task: ClosingTask, first: Pool, further: Pool) -> Pool:
    """The further views, those nearer to earlier ones than waypoints may be moved onto them.

    Those without which a section is lost are kept where they were as well.
    """
    positions = np.concatenate([first.views.positions_enu_m, further.views.positions_enu_m])
    n_first = len(first.views.heading_rad)
    for i in range(n_first, len(positions)):
        away_m = np.linalg.norm(positions[:i] - positions[i], axis=1)
        if away_m.min(initial=np.inf) < task.aircraft.min_waypoint_spacing_m:
            positions[i] = positions[np.argmin(away_m)]
    moved = task.pool(further.views._replace(positions_enu_m=positions[n_first:]))
    is_lost = np.zeros(len(task.elements), np.bool_)
    is_lost[further.elements.items] = True
    is_lost[np.concatenate([first.elements.items, moved.elements.items])] = False
    needed_there = [bool(is_lost[further.elements.of(view)].any()) for view in range(len(further.views.heading_rad))]
    return join_pools(_useful(moved), keep(further, np.array(needed_there, np.bool_)))


def _places(task: ClosingTask, known: Pool, rng: np.random.Generator) -> Array:
    """Allowed positions to look from, shape (n, 3)."""
    problem = task.problem
    reachability = problem.reachability
    is_open = np.ones(len(task.elements), np.bool_)
    is_open[known.elements.items] = False
    # Witnesses of what the known views show are for variety only.
    is_asked = is_open | (rng.random(len(is_open)) < MAX_WITNESSES / max(1, len(is_open)))
    is_asked &= reachability.verdicts.reshape(-1)[task.elements] == REACHABLE
    witnesses = reachability.witnesses_enu_m.reshape(-1, 3)[task.elements[is_asked]]
    centres = np.concatenate([known.views.positions_enu_m, witnesses])
    around = np.zeros((0, 3))
    if len(centres):
        copies = max(1, MAX_NEIGHBOURS // len(centres))
        low, high = np.log(NEIGHBOUR_SCALES_M)
        scale = np.exp(rng.uniform(low, high, (len(centres) * copies, 1)))
        around = np.repeat(centres, copies, axis=0) + rng.normal(size=(len(scale), 3)) * scale / np.sqrt(3.0)
    spread = spread_positions(problem.space, problem.model.frames, N_SPREAD, rng)
    places = np.concatenate([centres, around, spread])
    return places[problem.space.is_allowed(places)]


def _aimed(task: ClosingTask, places_enu_m: Array, rng: np.random.Generator) -> ViewpointArrays:
    """Two views from each place that any wanted section can be seen from.

    One looks at the middle of the panels whose wanted sections the place lies in, one at one of them, drawn at random.
    """
    model, mask = task.problem.model, task.mask()
    views = []
    for start, end in chunks(len(places_enu_m), max(1, POINTS_PER_CHUNK // max(1, len(model.frames)))):
        places = places_enu_m[start:end]
        codes = codes_all_around(model, places)
        panel, place = np.nonzero(codes)
        is_wanted = mask[panel * model.grid.n_sections + codes[panel, place] - 1]
        order = rng.permutation(np.flatnonzero(is_wanted))
        panel, place = panel[order], place[order]
        targets = model.frames.centroids[panel]
        used, first, number = np.unique(place, return_index=True, return_inverse=True)
        middle = np.zeros((len(used), 3))
        np.add.at(middle, number, targets)
        middle /= np.bincount(number, minlength=len(used))[:, None]
        views += [
            aimed_views(places[used], middle, model.camera),
            aimed_views(places[used], targets[first], model.camera),
        ]
    return concatenate([NONE_LOCKED, *views])


# The shortest flight that shows all wanted sections, and what batteries allow of it otherwise.
#
# Which candidates are flown, and in which order, is settled together: the shortest route that shows everything
# (`planning.routing.covering`), or the most that fits into the sorties allowed (`planning.routing.orienteering`).

ROUND_S = 1.5
"""Longest time spent on one set of candidates before fresh ones are tried."""

IDLE_ROUNDS, LEAST_GAIN = 2, 0.002
"""The search ends by itself after this many rounds in a row that shortened the flight by less than this part."""


@dataclass(frozen=True, slots=True, eq=False)
class ShortestFlight:
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
class FlightsInBudget:
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


def shortest_covering_flight(
    task: ClosingTask,
    known: ViewpointArrays,
    *,
    seed: int = 0,
    stop: Stop = never,
    durations: Trace | None = None,
    monitor: Monitor = QUIET,
) -> ShortestFlight:
    """Shortest single flight found that shows all wanted sections that can be shown; anytime.

    It is no longer than one through those of the `known` views, in their order, that are needed, by the times that
    solvers use (`planning.routing.flights.flight_times`).

    Parameters
    ----------
    durations
        Gets the duration whenever it falls.
    """
    rng = np.random.default_rng(seed)
    search = _Shortening(task, known, Trace() if durations is None else durations)
    in_sight = np.zeros(0, np.int32)
    idle = 0
    for round_number in itertools.count():
        found = candidates(task, search.views, rng, monitor)
        in_sight = np.union1d(in_sight, found.in_sight)
        limit = any_of(stop, TimeLimit(ROUND_S))
        idle = 0 if search.among(found, seed + round_number, limit, monitor) else idle + 1
        if idle == IDLE_ROUNDS or len(found.shown) == 0 or stop():
            break
    monitor.report(say("bounding the optimum"), 0, 1)
    return ShortestFlight(search.views, found.shown, in_sight, search.duration_s, _bound_s(found))


class _Shortening:
    """The shortest flight so far, through the candidates of round after round."""

    def __init__(self, task: ClosingTask, known: ViewpointArrays, durations: Trace) -> None:
        self.views = known
        self.duration_s, self._n_shown = np.inf, 0
        self._wanted, self._durations = task, durations

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
        known = is_first[necessary_views(keep(found.pool, found.is_known).elements, weights)]
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


def most_covering_flights(
    task: ClosingTask,
    known: ViewpointArrays,
    budget_s: float,
    n_sorties: int,
    *,
    seed: int = 0,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> FlightsInBudget:
    """Views within `n_sorties` of `budget_s` that show as many wanted sections as could be found; anytime.

    `trace` gets the number of sections whenever it rises.
    """
    found = candidates(task, known, np.random.default_rng(seed), monitor)
    selection = solve_orienteering(
        found.times.travel_s,
        found.times.service_s,
        budget_s,
        n_sorties,
        CoverGain(found.pool.elements, np.ones(len(task.elements))),
        max_stops=max(1, task.aircraft.max_waypoints - 2),
        seed=seed,
        stop=stop,
        trace=trace,
        monitor=monitor,
    )
    groups = tuple(take(found.pool.views, np.array(sortie, np.int64)) for sortie in selection.sorties)
    return FlightsInBudget(groups, int(min(selection.bound + 1e-6, len(found.shown))))


SHARING_S = 1.0
"""Longest time for sharing views out among full batteries."""

TIGHTER = 0.995
"""Beyond the share by which a sortie was too long, the time allowed is shortened by this factor."""

FIRST_SHARE = 0.5
"""Part of the time for the shortest flight through everything where the batteries may not allow it."""


@dataclass(frozen=True, slots=True)
class Batteries:
    """What may be flown on.

    Parameters
    ----------
    on_board_s
        Time that the first sortie may take between take-off and landing, on a battery that was flown before; None
        where it has been changed, zero or less where it does not suffice.
    n_full
        Full batteries, beside the one on board; None: as many as it takes.
    full_s
        Time that each of these allows.
    """

    on_board_s: float | None
    n_full: int | None
    full_s: float

    @property
    def longest_s(self) -> float:
        """Longest sortie that any of them allows."""
        full_s = 0.0 if self.n_full == 0 else self.full_s
        return max(full_s, self.on_board_s or 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class ClosingFlights:
    """Flights and what is known about them.

    Parameters
    ----------
    flights
        Their views are numbers in `views`.
    on_board
        Whether the first of them is for the battery on board.
    in_sight, in_reach
        The wanted elements that some allowed place shows, and those of them that the batteries reach at all.
    shortest_s
        As `closing.ShortestFlight.bound_s`; None where the batteries do not allow all that is in reach.
    bound
        No flights within the batteries over the views compared show more wanted elements.
    """

    views: ViewpointArrays
    flights: tuple[Flight, ...]
    on_board: bool
    in_sight: NDArray[np.int64]
    in_reach: NDArray[np.int64]
    shortest_s: float | None
    bound: int


def closing_flights(
    task: ClosingTask,
    known: ViewpointArrays,
    batteries: Batteries,
    *,
    seed: int,
    limit: TimeLimit,
    stop: Stop,
    trace: Trace,
    durations: Trace,
    monitor: Monitor = QUIET,
) -> ClosingFlights:
    """Flights that show what is wanted; the shortest found, or those that show most within the batteries.

    Parameters
    ----------
    known
        Views that are worth trying first.
    limit, stop
        The end of the time there is, and a request to end earlier.
    trace
        Gets the number of wanted elements that are shown.
    durations
        Gets the duration of the shortest single flight whenever it falls.

    Returns
    -------
    flights
        Without any where nothing wanted is within reach.

    Raises
    ------
    InfeasibleError
        The wind is too strong for the aircraft, or no flight is short enough.
    """
    return _Search(known, batteries, seed, limit, stop, trace, durations, monitor).run(task)


@dataclass(frozen=True, slots=True, eq=False)
class _Part:
    """Flights over views of their own."""

    views: ViewpointArrays
    flights: tuple[Flight, ...]


@dataclass(slots=True, eq=False)
class _Search:
    known: ViewpointArrays
    batteries: Batteries
    seed: int
    limit: TimeLimit
    stop: Stop
    trace: Trace
    durations: Trace
    monitor: Monitor

    def run(self, task: ClosingTask) -> ClosingFlights:
        """On the battery on board where it allows all, else on as few full ones as do, else on all there are."""
        on_board_s, n_full = self.batteries.on_board_s or 0.0, self.batteries.n_full
        is_limited = self.batteries.on_board_s is not None or n_full is not None
        first = self._shortest(task, FIRST_SHARE if is_limited else 1.0, self.durations)
        everything = len(first.shown)
        if everything == 0:
            return self._result(task, first, [], None, 0)
        if on_board_s > 0.0:
            part = self._drawn(task, [first.views])
            if _fits(part, task, on_board_s, 1):
                return self._result(task, first, [part], first.bound_s, everything, on_board=True)
        if n_full == 0:
            part, bound = self._most(task, first, on_board_s, 1)
            return self._result(task, first, [part], None, bound, on_board=True)
        part = self._on_full(task, first)
        if n_full is None or len(part.flights) <= n_full:
            return self._result(task, first, [part], first.bound_s, everything)
        if on_board_s <= 0.0:
            part, bound = self._most(task, first, self.batteries.full_s, n_full)
            return self._result(task, first, [part], None, bound)
        parts = [self._most(task, first, on_board_s, 1)[0]]
        rest = replace(task, elements=_left(task, parts))
        if len(rest.elements):
            parts += self._rest(rest, n_full)
        return self._result(task, first, parts, None, everything, on_board=len(parts[0].flights) > 0)

    def _rest(self, task: ClosingTask, n_full: int) -> list[_Part]:
        """What the battery on board left, on full ones."""
        shortest = self._shortest(task, FIRST_SHARE, Trace(self.trace.clock))
        if len(shortest.shown) == 0:
            return []
        part = self._on_full(task, shortest)
        if len(part.flights) <= n_full:
            return [part]
        return [self._most(task, shortest, self.batteries.full_s, n_full)[0]]

    def _shortest(self, task: ClosingTask, share: float, durations: Trace) -> ShortestFlight:
        until = any_of(self.stop, TimeLimit(share * self.limit.remaining_s()))
        return shortest_covering_flight(
            task, self.known, seed=self.seed, stop=until, durations=durations, monitor=self.monitor
        )

    def _on_full(self, task: ClosingTask, shortest: ShortestFlight) -> _Part:
        """Sorties through all views, on as many full batteries as it takes."""
        part = self._drawn(task, [shortest.views])
        if _fits(part, task, self.batteries.full_s, 1):
            return part
        times = self._times(task, part.views)
        until = any_of(self.stop, TimeLimit(SHARING_S))
        flights = plan_flights(
            times, part.views, task.aircraft, task.rules, seed=self.seed, stop=until, monitor=self.monitor
        )
        return _Part(part.views, flights)

    def _drawn(self, task: ClosingTask, groups: Sequence[ViewpointArrays]) -> _Part:
        """One flight through each group of views, in order."""
        if not groups:
            return _Part(NONE_LOCKED, ())
        covered = np.where(task.mask(), 0, 1).astype(np.int32)
        spacing_m = task.aircraft.min_waypoint_spacing_m
        views = merge_close_views(task.problem, concatenate(list(groups)), spacing_m, covered=covered)
        ends = np.cumsum([len(group.heading_rad) for group in groups])
        sorties = tuple(
            tuple(range(end - len(group.heading_rad), end)) for end, group in zip(ends, groups, strict=True)
        )
        times = self._times(task, views)
        return _Part(views, draw_flights(times, sorties, views, task.aircraft, task.rules, self.monitor))

    def _times(self, task: ClosingTask, views: ViewpointArrays) -> FlightTimes:
        return flight_times(task.problem.roadmap, views, task.aircraft, task.rules, self.monitor)

    def _most(self, task: ClosingTask, shortest: ShortestFlight, budget_s: float, n_sorties: int) -> tuple[_Part, int]:
        """Sorties that show most, and the bound on that; tighter ones where exact durations do not fit."""
        known = concatenate([shortest.views, self.known])
        allowed_s, most = budget_s, 0
        for attempt in range(ATTEMPTS):
            until = any_of(self.stop, TimeLimit(self.limit.remaining_s() / (ATTEMPTS - attempt)))
            found = most_covering_flights(
                task, known, allowed_s, n_sorties, seed=self.seed, stop=until, trace=self.trace, monitor=self.monitor
            )
            most = max(most, found.bound)
            part = self._drawn(task, found.groups)
            if _fits(part, task, budget_s, n_sorties):
                return part, most
            allowed_s *= TIGHTER * budget_s / max(_longest_s(part, task), budget_s)
        raise InfeasibleError.say(
            "no flight through missing sections was found that fits {}'s waypoint limit and the {:.0f} s "
            "that the battery allows; change the battery",
            task.aircraft.name,
            budget_s,
        )

    def _result(
        self,
        task: ClosingTask,
        first: ShortestFlight,
        parts: Sequence[_Part],
        bound_s: float | None,
        bound: int,
        *,
        on_board: bool = False,
    ) -> ClosingFlights:
        self.trace.record(len(task.elements) - len(_left(task, parts)))
        offsets = np.cumsum([0, *(len(part.views.heading_rad) for part in parts)])
        flights = tuple(
            replace(flight, views=flight.views + offset)
            for part, offset in zip(parts, offsets[:-1], strict=True)
            for flight in part.flights
        )
        views = concatenate([NONE_LOCKED, *(part.views for part in parts)])
        in_sight, in_reach = task.elements[first.in_sight], task.elements[first.shown]
        return ClosingFlights(views, flights, on_board, in_sight, in_reach, bound_s, bound)


def _fits(part: _Part, task: ClosingTask, budget_s: float, n_sorties: int) -> bool:
    """Whether sorties are few enough, and each within its time and the aircraft's waypoints."""
    most_points = max((len(flight.path_enu_m) - 2 for flight in part.flights), default=0)
    is_short = _longest_s(part, task) <= budget_s and most_points <= task.aircraft.max_waypoints
    return len(part.flights) <= n_sorties and is_short


def _longest_s(part: _Part, task: ClosingTask) -> float:
    """Longest time between take-off and landing."""
    return max((flight.duration_s for flight in part.flights), default=0.0) - task.rules.takeoff_landing_s


def _left(task: ClosingTask, parts: Sequence[_Part]) -> NDArray[np.int64]:
    """Wanted elements that no part shows."""
    shown = np.zeros(task.problem.model.n_elements, np.bool_)
    for part in parts:
        shown[task.problem.model.elements(part.views).items] = True
    return task.elements[~shown[task.elements]]
