"""Planning a second flight from a site to a plan: prepare, choose views, share them out among sorties, certify.

Three ways to say how much is wanted: a number of views; a share of what can be covered, with as few views as possible
(0.99 when nothing is said); or a number of batteries, within which views and route are chosen together.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from planning.catalogue import DEFAULT_PROFILE, Profile, profile
from planning.coverage.model import Precision
from planning.errors import InputError
from planning.evaluate import DepthCount, coverage, depth
from planning.findings import Finding
from planning.frames import wrap_heading_rad
from planning.methods import method_named
from planning.optimise.budget import best_flights, views_within_budget
from planning.optimise.greedy import GreedyParameters, greedy
from planning.optimise.problem import DEFAULT_SHARE, Goal, Optimiser, ViewProblem, nothing_to_see, take
from planning.optimise.spacing import merge_close_views
from planning.plan import (
    ANGLE_DECIMALS,
    POSITION_DECIMALS,
    Constraints,
    FlightRules,
    HistoryPoint,
    Plan,
    Sortie,
    Viewpoint,
    ViewpointArrays,
    viewpoint_arrays,
)
from planning.prepare import Prepared, prepare
from planning.progress import QUIET, Monitor, Stop, TimeLimit, Trace, any_of, never
from planning.routing.flights import Flight, flight_times, plan_flights
from planning.routing.roadmap import build_roadmap
from planning.site import SiteModel
from planning.space import LEG_MARGIN_M, free_space

DEFAULT_VIEWS = 560
"""For methods that need a number of views when none is given: the paper's for its planar case."""

REACHABILITY_SHARE, ROUTING_SHARE = 0.5, 0.3
"""Parts of the time budget: what proofs of what can be reached may take at most, and what is kept for routing."""

SHORTEST_ROUTING_S = 1.0
LONGEST_ROUTING_S = 4.0
"""Routing gets at least and at most this long; 560 views gain nothing more after 1 s (docs/benchmarks.md)."""


@dataclass(frozen=True, slots=True)
class PlanRequest:
    """What is wanted. At most one of `n_views`, `share` and `n_batteries` is set.

    Parameters
    ----------
    share
        Of what can be covered, 0 to 1, with as few views as possible.
    n_batteries
        Best coverage within so many sorties.
    profile_id
        Aircraft and camera: see `planning.catalogue.profile`.
    time_budget_s
        Wall time for the whole plan; the search ends earlier when it finds nothing more.
    """

    method: str = "greedy"
    n_views: int | None = None
    share: float | None = None
    n_batteries: int | None = None
    profile_id: str = DEFAULT_PROFILE
    constraints: Constraints = Constraints()
    rules: FlightRules = FlightRules()
    greedy: GreedyParameters = GreedyParameters()
    precision: Precision = "f32"
    seed: int = 0
    time_budget_s: float = 60.0

    def __post_init__(self) -> None:
        if sum(value is not None for value in (self.n_views, self.share, self.n_batteries)) > 1:
            raise ValueError("expected at most one of a number of views, a share and a number of batteries")
        if self.n_views is not None and not 1 <= self.n_views <= 20_000:
            raise ValueError(f"views: expected 1 to 20000, got {self.n_views}")
        if self.share is not None and not 0.0 < self.share <= 1.0:
            raise ValueError(f"coverage: expected more than 0 and at most 1, got {self.share}")
        if self.n_batteries is not None and not 1 <= self.n_batteries <= 100:
            raise ValueError(f"batteries: expected 1 to 100, got {self.n_batteries}")
        if not 0 <= self.seed < 2**32:
            raise ValueError(f"seed: expected 0 to {2**32 - 1}, got {self.seed}")
        if not self.time_budget_s > 0.0:
            raise ValueError(f"time budget: expected more than 0 s, got {self.time_budget_s}")


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
    seconds
        Wall time by stage, in order.
    """

    plan: Plan
    findings: tuple[Finding, ...]
    bound_for_views: float | None
    n_undecided: int
    depth: tuple[DepthCount, ...]
    seconds: dict[str, float] = field(hash=False)


def plan_flight(
    site_model: SiteModel,
    request: PlanRequest,
    *,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> Planned:
    """Plan a flight. When `stop` asks for an end, the best views so far are routed and returned.

    Raises
    ------
    InputError
        There is no such method or profile, or the method cannot do what is asked.
    InfeasibleError
        The site, the aircraft or the battery does not allow any flight; the message says what does not.
    """
    trace = Trace() if trace is None else trace
    chosen_profile, optimiser = profile(request.profile_id), _optimiser(request)
    limit = TimeLimit(request.time_budget_s)
    watch = _StopWatch()
    prepared = prepare(
        site_model,
        chosen_profile.camera,
        request.constraints,
        precision=request.precision,
        seed=request.seed,
        stop=any_of(stop, TimeLimit(REACHABILITY_SHARE * request.time_budget_s)),
        monitor=monitor,
    )
    watch.lap("reachability")
    routing_s = float(np.clip(ROUTING_SHARE * request.time_budget_s, SHORTEST_ROUTING_S, LONGEST_ROUTING_S))
    choosing = any_of(stop, TimeLimit(max(0.1, limit.remaining_s() - routing_s)))
    problem = prepared.problem
    bound: float | None
    if request.n_batteries is not None:
        views, bound = views_within_budget(
            problem,
            chosen_profile.aircraft,
            request.rules,
            request.n_batteries,
            request.greedy,
            seed=request.seed,
            stop=choosing,
            trace=trace,
            monitor=monitor,
        )
    else:
        found = optimiser(problem, _goal(request), seed=request.seed, stop=choosing, trace=trace, monitor=monitor)
        views, bound = found.views, found.bound
    if request.greedy.solid_angle_weights:
        bound = None
    views = merge_close_views(problem, as_written(problem, views))
    if len(views.heading_rad) == 0:
        raise nothing_to_see()
    watch.lap("views")
    flights = _route(problem, views, request, chosen_profile, routing_s, stop, monitor)
    if request.n_batteries is not None:
        flights = best_flights(problem.model, views, flights, request.n_batteries)
    watch.lap("routing")
    plan = _plan(site_model, request, chosen_profile, prepared, views, flights, trace)
    watch.lap("certificate")
    reachability = problem.reachability
    return Planned(
        plan, prepared.findings, bound, reachability.n_undecided, depth(problem.model, plan.viewpoints), watch.seconds
    )


def _optimiser(request: PlanRequest) -> Optimiser:
    optimiser = method_named(request.method)
    if request.method != "greedy" and request.n_batteries is not None:
        raise InputError(f"method '{request.method}' cannot plan for a number of batteries; 'greedy' can")
    if request.method == "greedy":
        return partial(greedy, parameters=request.greedy)
    return optimiser


def _goal(request: PlanRequest) -> Goal:
    if request.n_views is not None:
        return Goal(n_views=request.n_views)
    if request.method == "pso":
        if request.share is not None:
            raise InputError("method 'pso' needs a number of views (--views N); it cannot look for the fewest")
        return Goal(n_views=DEFAULT_VIEWS)
    return Goal(share=DEFAULT_SHARE if request.share is None else request.share)


def as_written(problem: ViewProblem, views: ViewpointArrays) -> ViewpointArrays:
    """Views as a plan file holds them: rounded, pitch within the gimbal's range, none twice, all flyable."""
    low, high = np.array(problem.model.camera.gimbal_pitch_deg)
    positions = views.positions_enu_m.round(POSITION_DECIMALS)
    heading_deg = np.degrees(wrap_heading_rad(views.heading_rad)).round(ANGLE_DECIMALS)
    heading_deg = np.where(heading_deg <= -180.0, 180.0, heading_deg)
    pitch_deg = np.clip(np.degrees(views.pitch_rad).round(ANGLE_DECIMALS), low, high)
    _, first = np.unique(np.column_stack([positions, heading_deg, pitch_deg]), axis=0, return_index=True)
    rounded = ViewpointArrays(positions, np.radians(heading_deg), np.radians(pitch_deg))
    kept: NDArray[np.int64] = np.sort(first)
    kept = kept[problem.flyable(positions[kept], LEG_MARGIN_M)]
    return take(rounded, kept)


def _route(
    problem: ViewProblem,
    views: ViewpointArrays,
    request: PlanRequest,
    chosen_profile: Profile,
    routing_s: float,
    stop: Stop,
    monitor: Monitor,
) -> tuple[Flight, ...]:
    aircraft, rules = chosen_profile.aircraft, request.rules
    times = flight_times(problem.roadmap, views, aircraft, rules, monitor)
    return plan_flights(
        times,
        views,
        aircraft,
        rules,
        seed=request.seed,
        stop=any_of(stop, TimeLimit(routing_s)),
        monitor=monitor,
    )


def _plan(
    site_model: SiteModel,
    request: PlanRequest,
    chosen_profile: Profile,
    prepared: Prepared,
    views: ViewpointArrays,
    flights: tuple[Flight, ...],
    trace: Trace,
) -> Plan:
    viewpoints, sorties = plan_records(views, flights)
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
        coverage=coverage(problem.model, viewpoints, problem.reachability),
        history=tuple(points),
        origin=site.origin,
        home_enu_m=site.home_enu_m,
        rules=request.rules,
        effects=prepared.effects,
        profile=chosen_profile.id,
    )


def plan_records(
    views: ViewpointArrays, flights: tuple[Flight, ...]
) -> tuple[tuple[Viewpoint, ...], tuple[Sortie, ...]]:
    """Viewpoints in the order of flight, named v0000 and on, and sorties."""
    viewpoints: list[Viewpoint] = []
    sorties = []
    for flight in flights:
        ids = []
        for view in flight.views:
            ids.append(f"v{len(viewpoints):04d}")
            x, y, z = (float(value) for value in views.positions_enu_m[view])
            heading = round(float(np.degrees(views.heading_rad[view])), ANGLE_DECIMALS)
            pitch = round(float(np.degrees(views.pitch_rad[view])), ANGLE_DECIMALS)
            viewpoints.append(Viewpoint(ids[-1], (x, y, z), heading, pitch))
        path = tuple((float(x), float(y), float(z)) for x, y, z in flight.path_enu_m)
        sorties.append(Sortie(tuple(ids), path, round(flight.length_m, 3), round(flight.duration_s, 2)))
    return tuple(viewpoints), tuple(sorties)


def share_out_anew(plan: Plan, site_model: SiteModel, max_views: int, monitor: Monitor = QUIET) -> Plan:
    """The same viewpoints in sorties of at most `max_views`.

    Raises
    ------
    InfeasibleError
        Home cannot be used, or a viewpoint cannot be reached from it.
    """
    space = free_space(site_model, plan.constraints.min_distance_m)
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
    return replace(plan, sorties=sorties)


class _StopWatch:
    """Wall time by stage."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._last_s = time.perf_counter()

    def lap(self, stage: str) -> None:
        """The stage that just ended."""
        now = time.perf_counter()
        self.seconds[stage] = now - self._last_s
        self._last_s = now
