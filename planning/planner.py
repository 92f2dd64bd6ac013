"""Planning a second flight from a site to a plan: prepare, choose views, share them out among sorties, certify.

Three ways to say how much is wanted: a number of views; a share of what can be covered, with as few views as possible
(0.99 when nothing is said); or a number of batteries, within which views and route are chosen together.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from planning.aircraft.catalogue import Profile, profile
from planning.base.effects import Decision
from planning.base.errors import InputError
from planning.base.findings import Finding
from planning.base.jit import chunks
from planning.base.progress import QUIET, Monitor, Stop, TimeLimit, Trace, any_of, never
from planning.coverage.evaluate import DepthCount, Sight, coverage_of_sights, depth, section_counts, sights
from planning.coverage.image_error import ImageErrorModel
from planning.coverage.positions import rounded
from planning.coverage.reach_kernel import REACHABLE, UNREACHABLE
from planning.coverage.sections import SectionGrid
from planning.geo.frames import wrap_heading_deg
from planning.motion.timing import motion_limits, round_trip_metric
from planning.parameters import DEFAULT_SHARE, DEFAULT_VIEWS
from planning.plan import ANGLE_DECIMALS, HistoryPoint, Plan, Sortie, Viewpoint, ViewpointArrays, viewpoint_arrays
from planning.request import PlanRequest
from planning.routing.at_once import flown_at_once, share_out
from planning.routing.flights import Flight, flight_times, plan_flights
from planning.routing.legs import LegTable, n_stops_within
from planning.routing.roadmap import build_roadmap
from planning.site.free_space import LEG_MARGIN_M, free_space
from planning.site.records import SiteModel
from planning.viewpoints.budget import best_flights, views_within_budget, with_fewer_views
from planning.viewpoints.candidates import candidate_pool, places_around
from planning.viewpoints.greedy import greedy, most_covering
from planning.viewpoints.least_error import (
    FEW_CANDIDATES,
    choose_for_least_error,
    error_state,
    expected_psnr_db,
    flight_worth,
    image_error_model,
)
from planning.viewpoints.methods import method_named
from planning.viewpoints.prepare import Prepared, prepare
from planning.viewpoints.problem import (
    NONE_LOCKED,
    Goal,
    Optimiser,
    ViewProblem,
    ViewSet,
    locked_views,
    nothing_to_see,
    take,
)
from planning.viewpoints.spacing import SpacingRule, merge_close_views

# Chosen views and flights as the records of a plan: rounded as in files, named, in the order of flight.


def as_written(problem: ViewProblem, views: ViewpointArrays, n_fixed: int = 0) -> ViewpointArrays:
    """Views as a plan file holds them: rounded, pitch within the gimbal's range, none twice, all flyable.

    The first `n_fixed` views stay as they are.
    """
    written = rounded(views, problem.model.camera)
    is_fixed = np.arange(len(views.heading_rad)) < n_fixed
    _, first = np.unique(np.column_stack(written), axis=0, return_index=True)
    kept = is_fixed.copy()
    kept[first] = True
    to_check = np.flatnonzero(kept & ~is_fixed)
    kept[to_check] = problem.flyable(written.positions_enu_m[to_check], LEG_MARGIN_M)
    both = ViewpointArrays(
        np.where(is_fixed[:, None], views.positions_enu_m, written.positions_enu_m),
        np.where(is_fixed, views.heading_rad, written.heading_rad),
        np.where(is_fixed, views.pitch_rad, written.pitch_rad),
    )
    return take(both, kept)


def plan_records(
    views: ViewpointArrays, flights: tuple[Flight, ...], locked: tuple[Viewpoint, ...] = ()
) -> tuple[tuple[Viewpoint, ...], tuple[Sortie, ...]]:
    """Viewpoints in the order of flight, named v0000 and on, and sorties.

    The first views are the `locked` ones, which keep their names; no other gets one of these.
    """
    viewpoints: list[Viewpoint] = []
    sorties = []
    used_ids = {viewpoint.id for viewpoint in locked}
    names = (name for number in itertools.count() if (name := f"v{number:04d}") not in used_ids)
    for flight in flights:
        flown = [
            replace(locked[view], locked=True) if view < len(locked) else _record(next(names), views, int(view))
            for view in flight.views
        ]
        viewpoints += flown
        path = [(float(x), float(y), float(z)) for x, y, z in flight.path_enu_m]
        for vertex, viewpoint in zip(flight.photo_vertices, flown, strict=True):
            path[vertex] = viewpoint.position_enu_m  # locked ones may have more decimals
        ids = tuple(viewpoint.id for viewpoint in flown)
        times = round(flight.length_m, 3), round(flight.duration_s, 2)
        sorties.append(Sortie(ids, tuple(path), *times, start_s=flight.start_s, aircraft=flight.aircraft))
    return tuple(viewpoints), tuple(sorties)


def _record(viewpoint_id: str, views: ViewpointArrays, view: int) -> Viewpoint:
    x, y, z = (float(value) for value in views.positions_enu_m[view])
    heading_deg = wrap_heading_deg(round(float(np.degrees(views.heading_rad[view])), ANGLE_DECIMALS))
    pitch_deg = round(float(np.degrees(views.pitch_rad[view])), ANGLE_DECIMALS)
    return Viewpoint(viewpoint_id, (x, y, z), heading_deg, pitch_deg)


# Why sections that may be seen stay open: no viewpoint of a plan covers them, and none is proven not to see them.


class OpenReason(StrEnum):
    """What keeps a section from being covered."""

    UNDECIDED = "undecided"
    """No place is known from which it is seen, and none is proven not to exist."""
    CUT_OFF = "cut-off"
    """Places are known, but no way from home to one of them was found."""
    SPACING = "spacing"
    """Only places closer to other viewpoints than the aircraft accepts were found."""
    SEARCH = "search"
    """Nothing: more viewpoints, or a longer search, would cover it."""
    LATE = "late"
    """It was not found out, since the time was up."""


@dataclass(frozen=True, slots=True)
class OpenSection:
    """A section that stays open; `panel` is its number on the site."""

    panel: int
    section: int
    why: OpenReason


OPEN_PER_BLOCK = 2000
"""Sections that are looked at between two looks at the clock; the first so many however late it is."""


def open_sections(
    problem: ViewProblem,
    covered: NDArray[np.bool_],
    positions_enu_m: NDArray[np.float64],
    spacing_m: float,
    stop: Stop = never,
) -> tuple[OpenSection, ...]:
    """All sections that may be seen and are not covered, and why, as far as that is found before `stop`.

    Parameters
    ----------
    covered
        Whether each section is, shape (m, n_sections).
    positions_enu_m
        Of the plan's viewpoints, shape (n, 3).
    spacing_m
        How far apart the aircraft wants waypoints; 0: no matter.
    """
    reachability = problem.reachability
    elements = np.flatnonzero((reachability.verdicts != UNREACHABLE) & ~covered)
    is_known = reachability.verdicts.reshape(-1)[elements] == REACHABLE
    known = elements[is_known]
    of_known, rng = len(known) * [OpenReason.LATE], np.random.default_rng(0)
    for start, end in chunks(len(known), OPEN_PER_BLOCK):
        if start > 0 and stop():
            break
        block = known[start:end]
        places, number = places_around(problem, block, reachability.witnesses_enu_m.reshape(-1, 3)[block], rng)
        kept = problem.flyable(places)
        places, number = places[kept], number[kept]
        is_apart = ~SpacingRule(places, positions_enu_m, spacing_m).are_too_close(places)
        flyable, apart = set(number.tolist()), set(number[is_apart].tolist())
        of_known[start:end] = (
            OpenReason.SEARCH if k in apart else OpenReason.SPACING if k in flyable else OpenReason.CUT_OFF
            for k in range(len(block))
        )
    why = iter(of_known)
    panel, section = np.divmod(elements, problem.model.grid.n_sections)
    return tuple(
        OpenSection(int(panel[k]), int(section[k]), next(why) if is_known[k] else OpenReason.UNDECIDED)
        for k in range(len(elements))
    )


REACHABILITY_SHARE, ROUTING_SHARE, REROUTING_SHARE, FINISHING_SHARE = 0.3, 0.3, 0.1, 0.1
"""Parts of the time budget: what proofs of what can be reached may take at most; what is kept for routing, less where
views were chosen by their routes; and what a choice of views takes to come to its end once it was asked to."""

ENDING_SHARE, SECTIONS_FOR_AS_LONG, TRIANGLES_FOR_AS_LONG = 0.6, 150_000, 75_000
"""Of the time that a program spent before it planned, which grows with the slowness of a computer, kept for what it
does behind it: worth, proof and writing. As long again for so many sections of the site, and for so many triangles."""

LEAST_CHOOSING_S = 0.5
"""A choice of views that would get less is made from few candidates."""

LOOKING_SHARE = 0.5
"""Of the time for ways to views: how long straight legs between these are looked at."""

SHORTEST_ROUTING_S = 1.0
LONGEST_ROUTING_S = 4.0
DRAWING_S = 0.3
FEWEST_ROUTED = 700
"""Routing gets at least and at most this long; 560 views gain nothing more after 1 s (docs/benchmarks.md). `DRAWING_S`
of the budget is kept for what comes after the search, and is the least that it gets, and that routing does of views
that were chosen by their routes. So many views are routed however late it is."""


@dataclass(frozen=True, slots=True)
class Planned:
    """A plan and what is known about it.

    Parameters
    ----------
    findings
        What the pilot should know about the site.
    bound_for_views
        Upper bound on the sections that as many views of the same candidates could cover; None where the method has
        none, and where sections are weighted.
    n_undecided
        Sections that count as reachable although no viewpoint that sees them was found.
    depth
        Sections covered once, twice and so on.
    open_sections
        Why sections that may be seen are not, where a share was wanted and is not reached.
    n_left_out
        Views chosen but left out, since the time budget did not last for ways to them.
    n_too_many
        Views chosen but left out, since their sorties were more than there are batteries.
    seconds
        Wall time by stage, in order.
    prepared
        The site as it was prepared: planning again with it saves that time.
    most_psnr_db
        Expected PSNR of unseen views that no choice as large, of the same candidates, exceeds; None where views were
        chosen for something else.
    before_db
        The same with the photos alone that were there already; None without any.
    is_cut_short
        Fewer candidates were compared than there are, since the time budget did not last for all.
    are_all_taken
        All candidates that were compared are flown, although there are more.
    """

    plan: Plan
    findings: tuple[Finding, ...]
    bound_for_views: float | None
    n_undecided: int
    depth: tuple[DepthCount, ...]
    seconds: dict[str, float] = field(hash=False)
    prepared: Prepared = field(repr=False, compare=False)
    open_sections: tuple[OpenSection, ...] = ()
    n_left_out: int = 0
    n_too_many: int = 0
    most_psnr_db: float | None = None
    before_db: float | None = None
    is_cut_short: bool = False
    are_all_taken: bool = False


def plan_flight(
    site_model: SiteModel,
    request: PlanRequest,
    *,
    prepared: Prepared | None = None,
    photos: ViewpointArrays = NONE_LOCKED,
    started_s: float | None = None,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> Planned:
    """Plan a flight. When `stop` asks for an end, the best views so far are routed and returned.

    Parameters
    ----------
    prepared
        The site as an earlier plan left it; used where it serves the request, else the site is prepared anew.
    photos
        Poses of photos that are there already: views are chosen, and their worth is told, for what those lack.
    started_s
        When the time budget began, by `time.perf_counter`, where that was before this call: a program that is started
        for one plan spends some of it on itself.

    Raises
    ------
    InputError
        There is no such method or profile, the method cannot do what is asked, or a locked viewpoint cannot be flown.
    InfeasibleError
        The site, the aircraft or the battery does not allow any flight; the message says what does not.
    """
    trace = Trace() if trace is None else trace
    chosen_profile = profile(request.profile_id)
    _check_method(request)
    spent_s = 0.0 if started_s is None else time.perf_counter() - started_s
    limit = TimeLimit(request.time_budget_s - spent_s - _ending_share(site_model, request) * spent_s)
    watch = _Timer()
    prepared = first_reusable(() if prepared is None else (prepared,), site_model, request)
    if prepared is None:
        proving = any_of(stop, TimeLimit(REACHABILITY_SHARE * limit.remaining_s()))
        prepared = _prepared(site_model, request, chosen_profile, proving, monitor)
    watch.lap("reachability")
    trace.record_bound(prepared.problem.reachability.upper_bound)
    routing_share, routing_s = _time_of_routing(request)
    choosing_s = limit.remaining_s() - routing_s - FINISHING_SHARE * request.time_budget_s
    choosing = TimeLimit(choosing_s if choosing_s > LEAST_CHOOSING_S else 0.0, also=stop)
    problem = prepared.problem
    judged = cache(partial(image_error_model, problem, site_model, request.greedy.surroundings, request.seed, photos))
    request = _with_numbers(problem, lambda: judged()[0], request, chosen_profile, choosing, monitor)
    chosen_for = judged()[0] if request.is_for_least_error and judged()[0].n_elements else None
    found = _choose(problem, request, chosen_profile, chosen_for, choosing, trace, monitor)
    n_locked = len(request.locked)
    views = as_written(problem, found.views, n_locked)
    spacing_m = chosen_profile.aircraft.min_waypoint_spacing_m
    if request.method != "greedy" and spacing_m > 0.0:  # greedy keeps it while it chooses
        views = merge_close_views(problem, views, spacing_m)
    if len(views.heading_rad) == 0:
        raise nothing_to_see()
    n_chosen = len(views.heading_rad)
    if found.legs is None and limit.remaining_s() < routing_s + routing_share * request.time_budget_s:
        views = _that_can_be_routed(
            problem, views, chosen_for, request, chosen_profile, limit.remaining_s() - DRAWING_S
        )
    n_routed = len(views.heading_rad)
    watch.lap("views")
    with ThreadPoolExecutor(1) as beside:  # neither depends on ways between views
        about_views = beside.submit(lambda: (_seen(problem, views, request.locked), judged()))
        flights = _route(problem, views, found.legs, request, chosen_profile, limit, routing_s, stop, monitor)
    seen, (error, decision) = about_views.result()
    while request.n_batteries is not None and len(flights) > request.n_batteries:
        flights = best_flights(problem.model, views, flights, request.n_batteries, n_locked, chosen_for)
        if len(flights) > request.n_batteries:  # all of them have locked views
            views = with_fewer_views(problem.model, views, n_locked)
            seen = _seen(problem, views, request.locked)
            flights = _route(problem, views, found.legs, request, chosen_profile, limit, routing_s, stop, monitor)
    watch.lap("routing")
    seen = tuple(seen[view] for flight in flights for view in flight.views)
    effects = (*prepared.effects, decision)
    plan = _plan(site_model, request, chosen_profile, prepared, effects, views, flights, seen, trace)
    plan = replace(plan, worth=flight_worth(problem, error, plan, request.seed))
    counts = section_counts(problem.model, seen)
    watch.lap("certificate")
    return Planned(
        plan,
        prepared.findings,
        None if request.greedy.solid_angle_weights else found.bound,
        problem.reachability.n_undecided,
        depth(problem.model, counts),
        watch.seconds,
        prepared,
        _open_sections(problem, plan, counts > 0, request, any_of(stop, limit)),
        n_chosen - n_routed,
        n_routed - len(plan.viewpoints),
        None if found.least_error is None else expected_psnr_db(found.least_error, error.near_share),
        expected_psnr_db(error.most_error, error.near_share) if len(photos.heading_rad) else None,
        found.is_cut_short,
        found.are_all_taken,
    )


def _ending_share(site_model: SiteModel, request: PlanRequest) -> float:
    """Of the time before a plan, what is kept for that behind it."""
    n_sections = site_model.site.n_panels * SectionGrid(request.constraints.section_step_deg).n_sections
    n_triangles = sum(len(mesh.triangles) for mesh in (site_model.building, *site_model.obstacles))
    return ENDING_SHARE + n_sections / SECTIONS_FOR_AS_LONG + n_triangles / TRIANGLES_FOR_AS_LONG


def _time_of_routing(request: PlanRequest) -> tuple[float, float]:
    """Share of the time budget, and seconds of it, in which ways are shortened."""
    has_routes = request.n_batteries is not None or request.least_gain_db is not None
    share, shortest_s = (REROUTING_SHARE, DRAWING_S) if has_routes else (ROUTING_SHARE, SHORTEST_ROUTING_S)
    return share, float(np.clip(share * request.time_budget_s, shortest_s, LONGEST_ROUTING_S))


def _that_can_be_routed(
    problem: ViewProblem,
    views: ViewpointArrays,
    error: ImageErrorModel | None,
    request: PlanRequest,
    chosen_profile: Profile,
    seconds: float,
) -> ViewpointArrays:
    """The most telling of the views, by what they were chosen for, as many as ways can be found for in time."""
    metric = round_trip_metric(motion_limits(chosen_profile.aircraft, request.rules))
    n_locked = len(request.locked)
    n_views = max(FEWEST_ROUTED, n_locked, n_stops_within(problem.roadmap, views.positions_enu_m, metric, seconds))
    if error is None or len(views.heading_rad) <= n_views:
        return most_covering(problem.model, views, n_views, n_locked)
    is_locked = np.arange(len(views.heading_rad)) < n_locked
    free = take(views, ~is_locked)
    chosen = choose_for_least_error(error_state(error, free, take(views, is_locked)), n_views - n_locked, QUIET)
    return take(views, np.concatenate([np.flatnonzero(is_locked), n_locked + np.sort(chosen)]))


def _seen(problem: ViewProblem, views: ViewpointArrays, locked: tuple[Viewpoint, ...]) -> tuple[Sight, ...]:
    """What each of the views covers as it is written; the first are the `locked` ones."""
    n_views = len(views.heading_rad)
    written = [locked[view] if view < len(locked) else _record("-", views, view) for view in range(n_views)]
    return sights(problem.model, written)


def _open_sections(
    problem: ViewProblem, plan: Plan, covered: NDArray[np.bool_], request: PlanRequest, stop: Stop
) -> tuple[OpenSection, ...]:
    wanted = (request.wanted_share or 0.0) * plan.coverage.reachable_upper_bound
    if plan.coverage.covered >= wanted:
        return ()
    positions_enu_m = viewpoint_arrays(plan.viewpoints).positions_enu_m
    return open_sections(problem, covered, positions_enu_m, plan.aircraft.min_waypoint_spacing_m, stop)


def _prepared(
    site_model: SiteModel, request: PlanRequest, chosen_profile: Profile, stop: Stop, monitor: Monitor
) -> Prepared:
    return prepare(
        site_model,
        chosen_profile.camera,
        request.constraints,
        precision=request.precision,
        seed=request.seed,
        stop=stop,
        monitor=monitor,
    )


def first_reusable(known: Iterable[Prepared], site_model: SiteModel, request: PlanRequest) -> Prepared | None:
    """The first prepared site that serves a request, under the site's present checksum; None where none does."""
    camera = profile(request.profile_id).camera
    wanted = (site_model, camera, request.constraints, request.precision, request.seed)
    found = next((prepared for prepared in known if prepared.serves(*wanted)), None)
    if found is None or found.site_model is site_model:
        return found
    return replace(found, site_model=site_model)


def _choose(
    problem: ViewProblem,
    request: PlanRequest,
    chosen_profile: Profile,
    error: ImageErrorModel | None,
    limit: TimeLimit,
    trace: Trace,
    monitor: Monitor,
) -> ViewSet:
    """Views, the locked ones first, and bounds on what as many could bring."""
    locked = locked_views(problem, request.locked)
    if request.n_batteries is not None:
        return views_within_budget(
            problem,
            chosen_profile.aircraft,
            request.rules,
            request.n_batteries,
            request.greedy,
            seed=request.seed,
            stop=limit,
            trace=trace,
            monitor=monitor,
            locked=locked,
            error=error,
            remaining_s=limit.remaining_s,
        )
    optimiser = _optimiser(request, locked, chosen_profile.aircraft.min_waypoint_spacing_m, error)
    return optimiser(problem, _goal(request), seed=request.seed, stop=limit, trace=trace, monitor=monitor)


def _with_numbers(
    problem: ViewProblem,
    judged: Callable[[], ImageErrorModel],
    request: PlanRequest,
    chosen_profile: Profile,
    choosing: TimeLimit,
    monitor: Monitor,
) -> PlanRequest:
    """A request whose goal is a number of views or batteries, where those are to be found out."""
    if request.is_as_many_as_sections:
        return replace(request, n_views=_n_for_sections(problem, request, chosen_profile, choosing, monitor))
    if request.least_gain_db is None:
        return request
    n_batteries = _batteries_worth(problem, judged(), request, chosen_profile, choosing, monitor)
    return replace(request, n_batteries=n_batteries, least_gain_db=None)


COUNTING_SHARE, COUNTED_CANDIDATES = 0.3, 2000
"""Of the time for choosing views, that may be spent on learning how many; and the candidates that tell."""


def _n_for_sections(
    problem: ViewProblem, request: PlanRequest, chosen_profile: Profile, choosing: TimeLimit, monitor: Monitor
) -> int:
    """How many views cover `DEFAULT_SHARE` of the sections, the locked ones among them."""
    stop = TimeLimit(COUNTING_SHARE * choosing.remaining_s(), also=choosing)
    few = min(COUNTED_CANDIDATES, request.greedy.n_candidates)
    quick = replace(request.greedy, n_candidates=few, improve=False, certify=False)
    locked, spacing_m = locked_views(problem, request.locked), chosen_profile.aircraft.min_waypoint_spacing_m
    optimiser = partial(greedy, parameters=quick, locked=locked, spacing_m=spacing_m)
    goal = Goal(share=DEFAULT_SHARE)
    found = optimiser(problem, goal, seed=request.seed, stop=stop, trace=Trace(), monitor=monitor)
    return max(1, len(found.views.heading_rad))


PROBED_VIEWS, PROBE_S, MOST_BATTERIES = 120, 1.0, 10
"""Views that are routed, for so long, to learn how many photos a battery lasts for, and the most batteries that a plan
takes of its own accord."""


def _batteries_worth(
    problem: ViewProblem,
    error: ImageErrorModel,
    request: PlanRequest,
    chosen_profile: Profile,
    stop: Stop,
    monitor: Monitor,
) -> int:
    """The fewest batteries beside which another would bring less than the gain asked for."""
    pool = candidate_pool(problem, request.seed, FEW_CANDIDATES, stop)
    state = error_state(error, pool.views, locked_views(problem, request.locked))
    probed = take(pool.views, choose_for_least_error(state, PROBED_VIEWS, monitor))
    times = flight_times(problem.roadmap, probed, chosen_profile.aircraft, request.rules, monitor)
    limit = any_of(stop, TimeLimit(PROBE_S))
    flights = plan_flights(times, probed, chosen_profile.aircraft, request.rules, stop=limit, monitor=monitor)
    n_routed = sum(len(flight.views) for flight in flights)
    in_time = int(times.budget_s * n_routed / max(1.0, sum(flight.duration_s for flight in flights)))
    n_each = max(1, min(in_time, chosen_profile.aircraft.max_waypoints - 2))
    state = error_state(error, pool.views, locked_views(problem, request.locked))
    before = None
    for n_batteries in range(1, MOST_BATTERIES + 1):
        n_chosen = len(choose_for_least_error(state, n_each, monitor))
        now = expected_psnr_db(error.error_of(state.sums), error.near_share)
        if before is not None and (n_chosen == 0 or now - before < (request.least_gain_db or 0.0)):
            return n_batteries - 1
        before = now
    return MOST_BATTERIES


def _check_method(request: PlanRequest) -> None:
    method_named(request.method)
    if request.method != "greedy" and (request.n_batteries is not None or request.least_gain_db is not None):
        raise InputError.say("method '{}' cannot plan for a number of batteries; 'greedy' can", request.method)
    if request.method != "greedy" and request.locked:
        raise InputError.say("method '{}' cannot keep locked viewpoints; 'greedy' can, or unlock them", request.method)


def _optimiser(
    request: PlanRequest, locked: ViewpointArrays, spacing_m: float, error: ImageErrorModel | None
) -> Optimiser:
    if request.method == "greedy":
        return partial(greedy, parameters=request.greedy, locked=locked, spacing_m=spacing_m, error=error)
    return method_named(request.method)


def _goal(request: PlanRequest) -> Goal:
    if request.n_views is not None:
        return Goal(n_views=request.n_views)
    if request.method == "pso":
        if request.share is not None:
            raise InputError.say("method 'pso' needs a number of views (--views N); it cannot look for the fewest")
        return Goal(n_views=DEFAULT_VIEWS)
    return Goal(share=DEFAULT_SHARE if request.share is None else request.share)


def _route(
    problem: ViewProblem,
    views: ViewpointArrays,
    legs: LegTable | None,
    request: PlanRequest,
    chosen_profile: Profile,
    limit: TimeLimit,
    routing_s: float,
    stop: Stop,
    monitor: Monitor,
) -> tuple[Flight, ...]:
    aircraft, rules = chosen_profile.aircraft, request.rules
    left_s = limit.remaining_s() - min(routing_s, SHORTEST_ROUTING_S)
    looking, hurry = any_of(stop, TimeLimit(LOOKING_SHARE * left_s)), TimeLimit(left_s)
    times = flight_times(problem.roadmap, views, aircraft, rules, monitor, stop=looking, hurry=hurry, known=legs)
    searching_s = float(np.clip(limit.remaining_s() - DRAWING_S, DRAWING_S, routing_s))

    until = any_of(stop, TimeLimit(searching_s))
    flights = plan_flights(times, views, aircraft, rules, seed=request.seed, stop=until, monitor=monitor)
    if rules.at_once == 1:
        return flights
    sharing = any_of(stop, TimeLimit(limit.remaining_s()))
    return share_out(times, views, aircraft, rules, flights, request.n_batteries, request.seed, sharing)


def _plan(
    site_model: SiteModel,
    request: PlanRequest,
    chosen_profile: Profile,
    prepared: Prepared,
    effects: tuple[Decision, ...],
    views: ViewpointArrays,
    flights: tuple[Flight, ...],
    seen: tuple[Sight, ...],
    trace: Trace,
) -> Plan:
    viewpoints, sorties = plan_records(views, flights, request.locked)
    site, problem = site_model.site, prepared.problem
    points = [HistoryPoint(round(point.t_s, 4), int(point.value)) for point in trace.points]
    return Plan(
        site=site.name,
        site_sha256=site_model.sha256,
        method=request.method,
        seed=request.seed,
        camera=chosen_profile.camera,
        aircraft=chosen_profile.aircraft,
        constraints=prepared.constraints,
        viewpoints=viewpoints,
        sorties=sorties,
        coverage=coverage_of_sights(problem.model, seen, problem.reachability),
        history=tuple(points),
        origin=site.origin,
        home_enu_m=site.home_enu_m,
        rules=request.rules,
        effects=effects,
        profile=chosen_profile.id,
        camera_settings=request.camera,
        camera_controls=chosen_profile.controls,
    )


def resplit_sorties(plan: Plan, site_model: SiteModel, max_views: int, monitor: Monitor = QUIET) -> Plan:
    """The same viewpoints in sorties of at most `max_views`.

    Raises
    ------
    InfeasibleError
        Home cannot be used, or a viewpoint cannot be reached from it.
    """
    space = free_space(site_model, plan.constraints.min_distance_m, plan.constraints.min_height_above_ground_m)
    views = viewpoint_arrays(plan.viewpoints)
    aircraft = replace(plan.aircraft, max_waypoints=min(plan.aircraft.max_waypoints, max_views + 2))
    times = flight_times(build_roadmap(space, plan.seed), views, aircraft, plan.rules, monitor)
    limit = TimeLimit(LONGEST_ROUTING_S)
    flights = plan_flights(times, views, aircraft, plan.rules, seed=plan.seed, stop=limit, monitor=monitor)
    ids = [viewpoint.id for viewpoint in plan.viewpoints]
    sorties = tuple(
        replace(sortie, viewpoint_ids=tuple(ids[view] for view in flight.views))
        for sortie, flight in zip(plan_records(views, flights)[1], flights, strict=True)
    )
    return flown_at_once(replace(plan, sorties=sorties))


class _Timer:
    """Wall time by stage."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._last_s = time.perf_counter()

    def lap(self, stage: str) -> None:
        """The stage that just ended."""
        now = time.perf_counter()
        self.seconds[stage] = now - self._last_s
        self._last_s = now
