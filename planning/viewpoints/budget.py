"""Best coverage within a number of batteries: views and route chosen together.

Which views to take depends on what flying to them costs, so candidates are chosen by worth per time on the routes
(`planning.routing.orienteering`, worth being the sections covered). The candidates are those that greedy would take
first, many times more than fit.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.base.messages import say
from planning.base.progress import Monitor, Stop, Trace
from planning.coverage.image_error import ImageErrorModel
from planning.coverage.model import CoverageModel, Elements, element_weights
from planning.motion.timing import motion_limits, round_trip_metric
from planning.parameters import FlightRules, GreedyParameters
from planning.plan import Aircraft, ViewpointArrays
from planning.routing.flights import Flight, FlightTimes, flight_times
from planning.routing.legs import n_stops_within
from planning.routing.orienteering import solve_orienteering
from planning.routing.sorties import Sorties, plan_sorties
from planning.viewpoints import cover_kernel as kernel
from planning.viewpoints.candidates import Pool, candidate_pool, join_pools, keep
from planning.viewpoints.greedy import Choice
from planning.viewpoints.improve import cover_state
from planning.viewpoints.least_error import ErrorGain, choose_for_least_error, error_state
from planning.viewpoints.problem import NONE_LOCKED, ViewProblem, ViewSet, covered_by, take
from planning.viewpoints.spacing import ANYWHERE, SpacingRule, rounding_spacing_m, spacing_rule

Array = NDArray[np.float64]

N_COMPARED, N_EACH, MOST_COMPARED, FEWEST_EACH = 700, 350, 3500, 200
"""Candidates whose routes are compared: 700, or 350 for each battery where that is more, since one lasts for 200 to 350
of them; at most 3500, whose legs take 1 GB. However late it is, 200 for each battery are, up to 700."""

LOOKING_SHARE, CHOOSING_SHARE, LEGS_SHARE, WAYS_SHARE = 0.3, 0.3, 0.3, 0.3
"""Parts of the time left each: how long candidates are looked at, how long some of them are chosen, and how long legs
between these, and ways where there are none, are looked for. So many are chosen as fit into the last two in a hurry.
The rest is for the search."""

CHOICE_DEPTHS = (1, 2, 3)
"""Candidates are the greedy choices for covering each section once, then twice and so on: variety to route by."""


REFRESH = 1000
"""Changes after which the marginal gains are summed up anew, so that rounding cannot build up."""


class CoverGain:
    """Worth of a set of candidates: the weight of the elements they cover (`CoverageGain` of the routing)."""

    def __init__(self, elements: Elements, weights: Array) -> None:
        self._elements = elements
        self._state = cover_state(elements, weights)
        self._n_changes = 0

    @property
    def value(self) -> float:
        """Weight covered."""
        return float(kernel.objective(self._state))

    @property
    def n_covered(self) -> int:
        """Number of elements covered."""
        return int(np.count_nonzero(self._state.counts))

    def marginals(self) -> Array:
        """What each candidate would add, shape (n,)."""
        return self._state.gains

    def add(self, candidate: int) -> None:
        """Put a candidate into the set."""
        kernel.add_elements(self._state, self._elements.of(candidate))
        self._count_change()

    def remove(self, candidate: int) -> None:
        """Take a candidate out of the set."""
        kernel.remove_elements(self._state, self._elements.of(candidate))
        self._count_change()

    def _count_change(self) -> None:
        self._n_changes += 1
        if self._n_changes % REFRESH == 0:
            kernel.refresh_gains(self._state)


def views_within_budget(
    problem: ViewProblem,
    aircraft: Aircraft,
    rules: FlightRules,
    n_batteries: int,
    parameters: GreedyParameters,
    *,
    seed: int,
    stop: Stop,
    trace: Trace,
    monitor: Monitor,
    locked: ViewpointArrays = NONE_LOCKED,
    error: ImageErrorModel | None = None,
    remaining_s: Callable[[], float] = lambda: math.inf,
) -> ViewSet:
    """Views that fit into `n_batteries` sorties and cover as much as could be found; with `error`, take most off it.

    The bound on that holds for the candidates that were compared: fewer where `remaining_s` says that time does not
    last for all. Views that are `locked` come first in the result, as they are.

    Raises
    ------
    InfeasibleError
        Nothing can be seen within one battery, or the locked views do not fit into as many as there are.
    """
    monitor.report(say("trying viewpoints"), 0, 1)
    weights = element_weights(problem.model, parameters.solid_angle_weights)
    n_locked = len(locked.heading_rad)
    covered = covered_by(problem.model, locked)
    spacing_m = rounding_spacing_m(aircraft.min_waypoint_spacing_m)
    choice = Choice(problem, weights, covered, locked, spacing_m, seed, stop, Trace(trace.clock), monitor)
    free = candidate_pool(problem, seed, parameters.n_candidates, stop)
    n_most = max(0, min(MOST_COMPARED, max(N_COMPARED, N_EACH * n_batteries)) - n_locked)
    n_fewest = min(N_COMPARED, FEWEST_EACH * n_batteries)
    apart = spacing_rule(free.views, locked, spacing_m)
    is_cut_short, n_known = stop(), len(free.views.heading_rad)

    def n_in_time() -> int:
        in_time = _n_routed_in_time(problem, free.views, aircraft, rules, (LEGS_SHARE + WAYS_SHARE) * remaining_s())
        return min(n_most, max(n_fewest, in_time))

    if error is None:
        n_free = n_in_time()
        is_cut_short = is_cut_short or n_free < min(n_most, n_known)
        free, _, _ = choice.greedily(free, n_free, np.inf)
        free = shortlist(free, weights, covered, n_free, spacing=spacing_rule(free.views, locked, spacing_m))
    else:
        looking = _part_of(LOOKING_SHARE, remaining_s, stop)
        state = error_state(error, free.views, locked, apart, monitor, looking, n_fewest)
        n_free = n_in_time()
        is_cut_short = is_cut_short or len(state.bounds) < n_known or n_free < min(n_most, n_known)
        kept = np.zeros(n_known, np.bool_)
        choosing = _part_of(CHOOSING_SHARE, remaining_s, stop)
        kept[choose_for_least_error(state, n_free, monitor, choosing)] = True
        free = keep(free, kept)
    pool = join_pools(Pool(locked, problem.model.elements(locked)), free)
    legs, ways = (_part_of(share, remaining_s, stop) for share in (LEGS_SHARE, LEGS_SHARE + WAYS_SHARE))
    times = flight_times(problem.roadmap, pool.views, aircraft, rules, monitor, stop=legs, hurry=ways)
    cover = CoverGain(pool.elements, weights)
    gain = cover if error is None else ErrorGain(error_state(error, pool.views))
    selection = solve_orienteering(
        times.travel_s,
        times.service_s,
        times.budget_s,
        n_batteries,
        gain,
        max_stops=max(1, aircraft.max_waypoints - 2),
        required=_required(times, n_locked, n_batteries, max(1, aircraft.max_waypoints - 2), seed, stop),
        seed=seed,
        stop=stop,
        trace=Trace(trace.clock, None if error is not None else lambda _worth: trace.record(cover.n_covered)),
        monitor=monitor,
    )
    chosen = np.array([stop_number for sortie in selection.sorties for stop_number in sortie], np.int64)
    if len(chosen) == 0:
        raise InfeasibleError.say(
            "no viewpoint that sees a panel can be reached and left again within {:.0f} s of one battery",
            times.budget_s,
        )
    chosen = np.concatenate([np.arange(n_locked), chosen[chosen >= n_locked]])
    found = ViewSet(
        take(pool.views, chosen),
        is_cut_short=is_cut_short,
        are_all_taken=len(chosen) == len(pool.views.heading_rad) < n_locked + n_known,
        legs=times.table,
    )
    if error is not None:
        trace.record(problem.model.covered_count(found.views))
        return replace(found, least_error=max(error.floor, error.most_error - selection.bound))
    everything = float(weights[np.unique(pool.elements.items)].sum())
    return replace(found, bound=min(selection.bound, everything))


def _n_routed_in_time(
    problem: ViewProblem, views: ViewpointArrays, aircraft: Aircraft, rules: FlightRules, seconds: float
) -> int:
    """Number of the views for which ways can be found in so many seconds."""
    if math.isinf(seconds):
        return len(views.heading_rad)
    metric = round_trip_metric(motion_limits(aircraft, rules))
    return n_stops_within(problem.roadmap, views.positions_enu_m, metric, seconds)


def _part_of(share: float, remaining_s: Callable[[], float], stop: Stop) -> Stop:
    """Asks for an end where `stop` does, and once a share of the time that is left now has passed."""
    left_s = (1.0 - share) * remaining_s()
    return lambda: stop() or remaining_s() < left_s


def _required(times: FlightTimes, n_locked: int, n_batteries: int, max_stops: int, seed: int, stop: Stop) -> Sorties:
    """Sorties through the locked views, which are the first of the table, with nothing else in them."""
    if n_locked == 0:
        return ()
    travel_s, service_s = times.travel_s[: n_locked + 1, : n_locked + 1], times.service_s[:n_locked]
    sorties = plan_sorties(travel_s, service_s, times.budget_s, max_stops, seed=seed, stop=stop)
    if len(sorties) > n_batteries:
        raise InfeasibleError.say(
            "the {} locked viewpoints alone take {} batteries, but {} are allowed; unlock some, or allow "
            "more batteries",
            n_locked,
            len(sorties),
            n_batteries,
        )
    return sorties


def best_flights(
    model: CoverageModel,
    views: ViewpointArrays,
    flights: tuple[Flight, ...],
    n_batteries: int,
    n_locked: int = 0,
    error: ImageErrorModel | None = None,
) -> tuple[Flight, ...]:
    """At most `n_batteries` of the flights, in order: those go without which least is lost.

    Views that just fitted into the batteries may need one more once they are rounded, moved together and routed anew.
    Flights with one of the first `n_locked` views stay, even where they are too many. What is lost is coverage, or with
    `error` how much more of that is left.
    """
    kept = list(flights)
    while len(kept) > n_batteries:
        if error is None:
            covered = np.array([model.covered(take(views, flight.views)) for flight in kept])
            lost = (covered & (covered.sum(axis=0) == 1)).sum(axis=1).tolist()
        else:
            others = (np.concatenate([f.views for f in kept if f is not flight]) for flight in kept)
            lost = [error.expected_error(take(views, each)) for each in others]
        spare = [number for number, flight in enumerate(kept) if (flight.views >= n_locked).all()]
        if not spare:
            break
        del kept[min(spare, key=lost.__getitem__)]
    return tuple(kept)


def with_fewer_views(model: CoverageModel, views: ViewpointArrays, n_locked: int) -> ViewpointArrays:
    """The views without the least useful tenth (at least one) of those after the first `n_locked`.

    Raises
    ------
    InfeasibleError
        Only locked views are left.
    """
    n_free = len(views.heading_rad) - n_locked
    if n_free == 0:
        raise InfeasibleError.say(
            "the {} locked viewpoints alone need more batteries than are allowed; unlock some, or allow more", n_locked
        )
    elements = model.elements(views)
    counts = np.bincount(elements.items, minlength=model.n_elements)
    losses = [int((counts[elements.of(view)] == 1).sum()) for view in range(n_locked, n_locked + n_free)]
    dropped = n_locked + np.argsort(losses, kind="stable")[: max(1, n_free // 10)]
    return take(views, np.setdiff1d(np.arange(n_locked + n_free), dropped))


def shortlist(
    pool: Pool,
    weights: Array,
    covered: NDArray[np.int32] | None,
    n_most: int,
    depths: Sequence[int] = CHOICE_DEPTHS,
    spacing: SpacingRule = ANYWHERE,
) -> Pool:
    """The candidates that greedy takes first, for several depths, beside what is `covered` all the same."""
    state = cover_state(pool.elements, weights, covered, spacing)
    chosen = np.zeros(min(n_most, len(state.gains)), np.int64)
    n_chosen = 0
    for depth in depths:
        state.depth[0] = depth
        kernel.refresh_gains(state)
        state.gains[chosen[:n_chosen]] = -np.inf
        n_chosen = int(kernel.greedy_steps(state, chosen, n_chosen, len(chosen), np.inf))
    kept = np.zeros(len(state.gains), np.bool_)
    kept[chosen[:n_chosen]] = True
    return keep(pool, kept)
