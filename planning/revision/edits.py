"""Edits of a plan by hand. Each makes a new revision; the old one stays as it was, which is what undo goes back to.

An edit that breaks a rule is carried out all the same: the findings of the new revision name what is wrong.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from planning.base.errors import InfeasibleError, InputError
from planning.base.findings import Finding
from planning.checks import check_case
from planning.checks.case import Case, TimedFlight, flight_key, legs_of, pose_of
from planning.coverage.evaluate import coverage_of_sights
from planning.coverage.positions import aimed_views
from planning.geo.frames import Vec3, heading_difference_rad, wrap_heading_deg
from planning.motion.timing import (
    UNKNOWN_TURN_RAD,
    MotionLimits,
    leg_times_s,
    motion_limits,
    photo_stop_s,
    photo_vertices,
    round_trip_metric,
    sortie_flight_path,
    stopping_duration_s,
    turn_times_s,
)
from planning.parameters import FlightRules
from planning.plan import (
    ANGLE_DECIMALS,
    POSITION_DECIMALS,
    Aircraft,
    Plan,
    Sortie,
    Viewpoint,
    ViewpointArrays,
    viewpoint_arrays,
)
from planning.routing.at_once import flown_at_once
from planning.routing.legs import joined_nodes, pull_tight
from planning.routing.roadmap import LegMetric, Roadmap, leg_length
from planning.site.free_space import LEG_MARGIN_M
from planning.viewpoints.prepare import Prepared, with_site_limits

Array = NDArray[np.float64]


# Ways between single places: straight where the leg is clear, else around obstacles, else straight all the same.
#
# `planning.routing.legs` makes a table of all legs for a planner. An edit needs two or three of them, so each is found
# for itself here, over the same roadmap and pulled tight in the same way.

HOME = None

Place = Vec3 | None
"""Position of a stop, or `HOME`."""


@dataclass(frozen=True, slots=True, eq=False)
class RoadmapPaths:
    """Ways over one roadmap.

    Parameters
    ----------
    metric
        What is kept small: flight time, or length where nothing can fly.
    edges
        (first node, second node), and weight, of the roadmap's edges.
    """

    roadmap: Roadmap
    metric: LegMetric
    edges: tuple[NDArray[np.int64], Array]

    @classmethod
    def over(cls, roadmap: Roadmap, aircraft: Aircraft, rules: FlightRules) -> RoadmapPaths:
        """Ways for an aircraft; the shortest instead of the fastest where the wind allows no flight."""
        try:
            metric = round_trip_metric(motion_limits(aircraft, rules))
        except InfeasibleError:
            metric = leg_length
        nodes, edges = roadmap.nodes_enu_m, roadmap.edges
        return cls(roadmap, metric, (edges, metric(nodes[edges[:, 1]] - nodes[edges[:, 0]])))

    def between(self, pairs: Sequence[tuple[Place, Place]]) -> list[tuple[Vec3, ...]]:
        """The way of each pair of places, both ends included; what lies between is rounded as in plan files.

        Where an end is no allowed position, or no way is found, the way is straight: checks say what it comes too close
        to. From and to home it leads through the column above.
        """
        space = self.roadmap.space
        top = space.column_top_enu_m
        ends = np.array([[top if place is HOME else place for place in pair] for pair in pairs], np.float64)
        ends = ends.reshape(-1, 2, 3)
        is_clear = space.legs_clear(ends[:, 0], ends[:, 1])
        is_allowed = space.is_allowed(ends.reshape(-1, 3), LEG_MARGIN_M).reshape(-1, 2)
        # Home may stand on the border of the airspace, where viewpoints may not; it was checked when it was prepared.
        is_allowed |= np.array([[place is HOME for place in pair] for pair in pairs], np.bool_).reshape(-1, 2)
        found = []
        for (start, end), straight, clear, allowed in zip(pairs, ends, is_clear, is_allowed, strict=True):
            if clear and start is not HOME and end is not HOME:
                way: Array | None = straight
            else:
                way = self._around(start, end) if allowed.all() else None
            vertices = _rounded(self._straight(start, end) if way is None else way)
            first, last = (vertices[0] if start is HOME else start), (vertices[-1] if end is HOME else end)
            found.append((first, *vertices[1:-1], last))
        return found

    def _straight(self, start: Place, end: Place) -> Array:
        """Straight, but for the column above home."""
        column = [self.roadmap.space.home_enu_m, self.roadmap.space.column_top_enu_m]
        first = column if start is HOME else [np.array(start)]
        last = column[::-1] if end is HOME else [np.array(end)]
        return np.array([*first, *last])

    def _around(self, start: Place, end: Place) -> Array | None:
        """Shortest way over the roadmap, pulled tight, shape (k, 3); None where there is none."""
        if end is HOME and start is not HOME:
            from_home = self._around(end, start)
            return None if from_home is None else from_home[::-1]
        nodes = self.roadmap.nodes_enu_m
        n = len(nodes)
        points = np.array([self.roadmap.space.home_enu_m if place is HOME else place for place in (start, end)])
        joined = joined_nodes(self.roadmap, points)
        if start is HOME:
            column = np.arange(self.roadmap.n_column)
            joined = np.concatenate([joined[joined[:, 0] == 1], np.stack([np.zeros_like(column), column], axis=1)])
        joined = np.unique(joined, axis=0)  # a sparse matrix adds up what it is given twice
        weight = self.metric(nodes[joined[:, 1]] - points[joined[:, 0]])
        rows = np.concatenate([self.edges[0][:, 0], n + joined[:, 0]])
        columns = np.concatenate([self.edges[0][:, 1], joined[:, 1]])
        weights = np.maximum(np.concatenate([self.edges[1], weight]), 1e-9)
        graph = csr_array(coo_array((weights, (rows, columns)), shape=(n + 2, n + 2)))
        _, previous = dijkstra(graph, directed=False, indices=[n], return_predecessors=True)
        if previous[0, n + 1] < 0:
            return None
        way = [n + 1]
        while way[-1] != n:
            way.append(int(previous[0, way[-1]]))
        along = np.concatenate([nodes, points])[way[::-1]]
        n_kept = 1 if start is HOME else 0  # the vertical part above home
        return np.concatenate([along[:n_kept], pull_tight(self.roadmap, along[n_kept:], self.metric)])


def _rounded(way: Array) -> tuple[Vec3, ...]:
    return tuple((float(x), float(y), float(z)) for x, y, z in way.round(POSITION_DECIMALS))


# The active plan: measured, checked, and ready to be edited.

LENGTH_DECIMALS, DURATION_DECIMALS = 3, 2
"""Of stated lengths (m) and durations (s), as the planner writes them."""


@dataclass(frozen=True, slots=True, eq=False)
class Revision:
    """A plan on its prepared site with everything measured on it; made by `revise` and by the edits.

    Parameters
    ----------
    findings
        Of all pre-flight rules: those of `planning.checks.check_plan`.
    """

    prepared: Prepared
    paths: RoadmapPaths
    case: Case
    findings: tuple[Finding, ...]

    @property
    def plan(self) -> Plan:
        """The plan as it is now."""
        return self.case.plan

    @property
    def counts(self) -> NDArray[np.int64]:
        """Number of views of each section, shape (m, n_sections)."""
        return self.case.measures.counts

    def viewpoint(self, viewpoint_id: str) -> Viewpoint:
        """A viewpoint by its identifier.

        Raises
        ------
        ValueError
            There is none.
        """
        found = next((viewpoint for viewpoint in self.plan.viewpoints if viewpoint.id == viewpoint_id), None)
        if found is None:
            raise ValueError(f"viewpoint_id: there is no viewpoint '{viewpoint_id}'")
        return found

    def elements_of_pose(self, viewpoint: Viewpoint) -> NDArray[np.int32]:
        """Panel * n_sections + section of each panel that one of the plan's viewpoints covers, shape (k,), rising."""
        return self.case.measures.seen[pose_of(viewpoint)].elements

    def leg_clearances_m(self, sortie: Sortie) -> NDArray[np.float64]:
        """Distance of each leg of one of the plan's sorties to panels, building and obstacles, shape (k - 1,)."""
        return np.array([self.case.measures.solid_gaps.legs_m[leg] for leg in legs_of(sortie)], np.float64)


def revise(plan: Plan, prepared: Prepared, before: Revision | None = None) -> Revision:
    """Activate a plan.

    Parameters
    ----------
    prepared
        The plan's site, prepared for its camera and constraints.
    before
        Another plan on the same preparation, such as the one before an edit was undone: saves measuring what both have
        in common, and changes nothing else.

    Raises
    ------
    ValueError
        The site was prepared for another camera or other constraints.
    """
    if plan.camera != prepared.problem.model.camera:
        raise ValueError(f"prepared: is for the camera {prepared.problem.model.camera.name}, not {plan.camera.name}")
    wanted = replace(plan.constraints, occlusion=prepared.constraints.occlusion)
    wanted = with_site_limits(wanted, prepared.site_model, plan.camera)
    if wanted != prepared.constraints or plan.constraints.occlusion not in ("auto", wanted.occlusion):
        raise ValueError(f"prepared: is for {prepared.constraints}, not {plan.constraints}")
    if before is None or before.prepared is not prepared:
        case = Case.of(plan, prepared.site_model)
        paths = RoadmapPaths.over(prepared.problem.roadmap, plan.aircraft, plan.rules)
    else:
        case, paths = before.case.with_plan(plan), before.paths
        if (plan.aircraft, plan.rules) != (before.plan.aircraft, before.plan.rules):
            paths = RoadmapPaths.over(prepared.problem.roadmap, plan.aircraft, plan.rules)
    return Revision(prepared, paths, case, check_case(case))


def _with_route(revision: Revision, viewpoints: Iterable[Viewpoint], sorties: Iterable[Sortie]) -> Revision:
    """The plan with other viewpoints and sorties; it states what they cover, and length and duration of new sorties."""
    known = {id(sortie) for sortie in revision.plan.sorties}
    case = revision.case.with_plan(replace(revision.plan, viewpoints=tuple(viewpoints), sorties=tuple(sorties)))
    plan = replace(
        case.plan,
        sorties=tuple(sortie if id(sortie) in known else _stated(case, sortie) for sortie in case.plan.sorties),
        coverage=coverage_of_sights(case.model, case.measures.seen.values(), revision.prepared.problem.reachability),
    )
    if plan.rules.at_once > 1:
        with suppress(InfeasibleError):  # no flying in this wind, as the check says
            plan = flown_at_once(plan)
    case = replace(case, plan=plan)
    return replace(revision, case=case, findings=check_case(case))


def _stated(case: Case, sortie: Sortie) -> Sortie:
    """A sortie with the length and the duration that were measured; as it is where nothing can be flown."""
    by_id = {viewpoint.id: viewpoint for viewpoint in case.plan.viewpoints}
    flight = case.measures.flights.get(flight_key(sortie, by_id))
    length_m = float(np.linalg.norm(np.diff(np.array(sortie.path_enu_m), axis=0), axis=1).sum())
    duration_s = sortie.duration_s if flight is None else round(flight.stopping_s, DURATION_DECIMALS)
    return replace(sortie, length_m=round(length_m, LENGTH_DECIMALS), duration_s=duration_s)


Viewpoints = Mapping[str, Viewpoint]
"""By identifier."""

Neighbours = tuple[str, str]
"""Identifiers of two stops in a row; home has `AT_HOME`."""

AT_HOME = ""


def legs_between_stops(sortie: Sortie, by_id: Viewpoints) -> dict[Neighbours, tuple[Vec3, ...]]:
    """Vertices from each stop of a sortie to the next, both included; empty where its path misses a viewpoint."""
    vertices = stop_vertices(sortie, by_id)
    if vertices is None:
        return {}
    return {
        pair: sortie.path_enu_m[start : end + 1]
        for pair, (start, end) in zip(neighbours(sortie.viewpoint_ids), itertools.pairwise(vertices), strict=True)
    }


def stop_vertices(sortie: Sortie, by_id: Viewpoints) -> list[int] | None:
    """Vertices of a sortie's path at which it is at a stop, its ends included; None where it misses a viewpoint."""
    vertices = photo_vertices(sortie, by_id)
    if vertices is None or len(sortie.path_enu_m) < 2:
        return None
    return [0, *vertices.tolist(), len(sortie.path_enu_m) - 1]


def neighbours(viewpoint_ids: Sequence[str]) -> list[Neighbours]:
    """Pairs of stops in a row, from home to home."""
    return list(itertools.pairwise((AT_HOME, *viewpoint_ids, AT_HOME)))


def place_of(stop: str, by_id: Viewpoints) -> Place:
    """Where a stop is."""
    return HOME if stop == AT_HOME else by_id[stop].position_enu_m


def with_other_stops(
    sortie: Sortie, before: Viewpoints, viewpoint_ids: tuple[str, ...], after: Viewpoints, paths: RoadmapPaths
) -> Sortie:
    """A sortie with other stops, or with stops elsewhere; length and duration are still those it had.

    Parameters
    ----------
    before, after
        Viewpoints as they were and as they are.
    """
    pairs = neighbours(viewpoint_ids)
    known = legs_between_stops(sortie, before)
    is_moved = {
        stop
        for stop in viewpoint_ids
        if stop not in before or before[stop].position_enu_m != after[stop].position_enu_m
    }
    missing = [pair for pair in pairs if pair not in known or not is_moved.isdisjoint(pair)]
    found = paths.between([(place_of(a, after), place_of(b, after)) for a, b in missing])
    legs = {**known, **dict(zip(missing, found, strict=True))}
    path = [*legs[pairs[0]], *itertools.chain.from_iterable(legs[pair][1:] for pair in pairs[1:])]
    passing = tuple(each for each in sortie.in_passing_ids if each in viewpoint_ids and each not in is_moved)
    return Sortie(viewpoint_ids, tuple(path), sortie.length_m, sortie.duration_s, passing)


# Where a new viewpoint goes: into a sortie with room, at the place where it costs least time.


MAX_LOOKED_AT = 64
"""Cheapest places that are looked at; the first of them to which clear legs lead is nearly always among the first 3."""

MAX_AROUND = 3
"""Places with a leg around something that are drawn, at about 10 ms each, before one with clear legs is taken."""

FIT_S = 0.01
"""Durations are stated to hundredths of a second."""


class _Gap(NamedTuple):
    """A place in a sortie, after so many stops, and the time (or length) that a stop there adds to its legs."""

    added: float
    sortie: int
    place: int


@dataclass(frozen=True, slots=True, eq=False)
class _Costs:
    """Seconds of legs and turns; metres, and no turns, where the wind allows no flight."""

    plan: Plan
    limits: MotionLimits | None

    @classmethod
    def of(cls, plan: Plan) -> _Costs:
        try:
            return cls(plan, motion_limits(plan.aircraft, plan.rules))
        except InfeasibleError:
            return cls(plan, None)

    def legs(self, vectors_enu_m: Array) -> Array:
        """Of straight legs, shape (n, 3), to shape (n,)."""
        return leg_length(vectors_enu_m) if self.limits is None else leg_times_s(vectors_enu_m, self.limits)

    def turns(self, heading_change_rad: Array, pitch_change_rad: Array) -> Array:
        """Of turns, shape (n,)."""
        if self.limits is None:
            return np.zeros(len(heading_change_rad))
        return turn_times_s(heading_change_rad, pitch_change_rad, self.limits)

    def together(self, legs: Array, turns: Array) -> Array:
        """Of legs with the turns that belong to them."""
        return np.maximum(legs, turns) if self.plan.rules.turn_in_flight else legs + turns

    def room_s(self, sortie: Sortie, flight: TimedFlight | None) -> float:
        """Time that a sortie can take more; without a bound where the wind allows no flight."""
        if self.limits is None:
            return np.inf
        now_s = sortie.duration_s if flight is None else flight.stopping_s
        return self.usable_s() - now_s - photo_stop_s(self.plan.aircraft, self.plan.rules)

    def usable_s(self) -> float:
        """Longest duration of a sortie."""
        return self.plan.aircraft.endurance_s * (1.0 - self.plan.rules.battery_reserve)


def with_stop(revision: Revision, new: Viewpoint) -> tuple[Sortie, ...]:
    """The plan's sorties with a new viewpoint in one of them, or in one of its own where none has room."""
    plan, before = revision.plan, {viewpoint.id: viewpoint for viewpoint in revision.plan.viewpoints}
    after = {**before, new.id: new}
    costs = _Costs.of(plan)
    gaps = sorted(_gaps(revision, before, new, costs))
    full: set[int] = set()
    while gap := _cheapest([gap for gap in gaps if gap.sortie not in full], revision.paths, plan, after, new, costs):
        old = plan.sorties[gap.sortie]
        ids = (*old.viewpoint_ids[: gap.place], new.id, *old.viewpoint_ids[gap.place :])
        changed = with_other_stops(old, before, ids, after, revision.paths)
        if _fits(changed, after, costs):
            return (*plan.sorties[: gap.sortie], changed, *plan.sorties[gap.sortie + 1 :])
        full.add(gap.sortie)
    return (*plan.sorties, with_other_stops(Sortie((), (), 0.0, 0.0), before, (new.id,), after, revision.paths))


def _fits(sortie: Sortie, by_id: Mapping[str, Viewpoint], costs: _Costs) -> bool:
    """Whether battery and aircraft allow a sortie as it is drawn."""
    aircraft, rules = costs.plan.aircraft, costs.plan.rules
    if len(sortie.path_enu_m) - 2 > aircraft.max_waypoints:
        return False
    timed = None if costs.limits is None else sortie_flight_path(sortie, by_id, aircraft, rules)
    return timed is None or stopping_duration_s(timed[0], aircraft, rules) <= costs.usable_s() + FIT_S


def _gaps(revision: Revision, before: Mapping[str, Viewpoint], new: Viewpoint, costs: _Costs) -> Iterator[_Gap]:
    """All places in sorties that have room, with straight legs to and from the new stop."""
    plan, flights = revision.plan, revision.case.measures.flights
    added = viewpoint_arrays((new,))
    home = _home_legs(revision.paths.roadmap, added.positions_enu_m[0], costs)
    for number, sortie in enumerate(plan.sorties):
        if len(sortie.path_enu_m) - 1 > plan.aircraft.max_waypoints:
            continue
        views = viewpoint_arrays(tuple(before[viewpoint_id] for viewpoint_id in sortie.viewpoint_ids))
        more = _added(views, added, home, _present_legs(sortie, before, views, costs), costs)
        room = costs.room_s(sortie, flights.get(flight_key(sortie, before))) + FIT_S
        yield from (_Gap(float(more[place]), number, place) for place in np.flatnonzero(more <= room).tolist())


def _home_legs(roadmap: Roadmap, place_enu_m: Array, costs: _Costs) -> tuple[float, float]:
    """Cost of flying from home to a place and back, up or down the column above home and straight on."""
    home, column = roadmap.space.home_enu_m, roadmap.nodes_enu_m[: roadmap.n_column]
    out = costs.legs(column - home) + costs.legs(place_enu_m - column)
    back = costs.legs(column - place_enu_m) + costs.legs(home - column)
    return float(out.min()), float(back.min())


def _present_legs(sortie: Sortie, by_id: Mapping[str, Viewpoint], views: ViewpointArrays, costs: _Costs) -> Array:
    """Cost of the legs between neighbours, from home to home, shape (m + 1,), as they are drawn."""
    at = stop_vertices(sortie, by_id)
    if at is None:  # its path misses a viewpoint and will be drawn anew
        return np.concatenate([np.zeros(1), costs.legs(np.diff(views.positions_enu_m, axis=0)), np.zeros(1)])
    legs = costs.legs(np.diff(np.array(sortie.path_enu_m, np.float64), axis=0))
    return np.diff(np.concatenate([[0.0], np.cumsum(legs)])[at])


def _added(
    views: ViewpointArrays, new: ViewpointArrays, home: tuple[float, float], present: Array, costs: _Costs
) -> Array:
    """What a new stop adds at each place of a sortie, shape (m + 1,)."""
    to_new = np.concatenate([[home[0]], costs.legs(new.positions_enu_m - views.positions_enu_m)])
    from_new = np.concatenate([costs.legs(views.positions_enu_m - new.positions_enu_m), [home[1]]])
    turns = costs.turns(heading_difference_rad(views.heading_rad, new.heading_rad), views.pitch_rad - new.pitch_rad)
    between = costs.turns(
        heading_difference_rad(views.heading_rad[:-1], views.heading_rad[1:]), np.diff(views.pitch_rad)
    )
    unknown = np.array([UNKNOWN_TURN_RAD])
    first, nothing = costs.turns(unknown, new.pitch_rad), np.zeros(1)
    present_turns = nothing
    if len(views.heading_rad):
        present_turns = np.concatenate([costs.turns(unknown, views.pitch_rad[:1]), between, nothing])
    return (
        costs.together(to_new, np.concatenate([first, turns]))
        + costs.together(from_new, np.concatenate([turns, nothing]))
        - costs.together(present, present_turns)
    )


def _cheapest(
    gaps: Sequence[_Gap],
    paths: RoadmapPaths,
    plan: Plan,
    by_id: Mapping[str, Viewpoint],
    new: Viewpoint,
    costs: _Costs,
) -> _Gap | None:
    """The gap that costs least with its legs as they will be flown; None where there is none.

    Straight legs are the shortest, so the first gap in order with clear ones is not beaten by any after it.
    """
    looked_at = gaps[:MAX_LOOKED_AT]
    if not looked_at:
        return None
    space, position = paths.roadmap.space, np.array(new.position_enu_m)
    if not space.is_allowed(position[None], LEG_MARGIN_M)[0]:
        return looked_at[0]
    best, least, n_around = looked_at[0], np.inf, 0
    pairs = [neighbours(plan.sorties[gap.sortie].viewpoint_ids)[gap.place] for gap in looked_at]
    ends = np.array([[place_of(stop, by_id) or position for stop in pair] for pair in pairs], np.float64)
    clear = space.legs_clear(ends.reshape(-1, 3), np.broadcast_to(position, (2 * len(ends), 3))).reshape(-1, 2)
    for gap, pair, is_clear in zip(looked_at, pairs, clear[:, 0] & clear[:, 1], strict=True):
        if gap.added >= least:
            break
        if is_clear and AT_HOME not in pair:
            return gap
        if n_around < MAX_AROUND:
            n_around += 1
            more = gap.added + _detour(pair, paths, by_id, new, costs)
            best, least = (gap, more) if more < least else (best, least)
    return best


def _detour(
    pair: tuple[str, str], paths: RoadmapPaths, by_id: Mapping[str, Viewpoint], new: Viewpoint, costs: _Costs
) -> float:
    """What the ways to and from a new stop cost more than straight ones."""
    drawn = paths.between(
        [(place_of(pair[0], by_id), new.position_enu_m), (new.position_enu_m, place_of(pair[1], by_id))]
    )
    flown = sum(float(costs.legs(np.diff(np.array(way), axis=0)).sum()) for way in drawn)
    home = _home_legs(paths.roadmap, np.array(new.position_enu_m), costs)
    straight = 0.0
    for stop, sign, from_home in zip(pair, (1.0, -1.0), home, strict=True):
        place = place_of(stop, by_id)
        straight += (
            from_home if place is None else float(costs.legs(sign * np.subtract(new.position_enu_m, place)[None])[0])
        )
    return flown - straight


def move(
    revision: Revision,
    viewpoint_id: str,
    position_enu_m: Vec3 | None = None,
    heading_deg: float | None = None,
    gimbal_pitch_deg: float | None = None,
) -> Revision:
    """Move or turn a viewpoint; what is None or as before stays. Any heading will do, it is wrapped into (-180, 180].

    Raises
    ------
    InputError
        The viewpoint is locked.
    ValueError
        There is no such viewpoint, or it cannot be where or look where it should (not finite, out of range).
    """
    old = revision.viewpoint(viewpoint_id)
    _check_unlocked([old], "moved")
    new = old
    if position_enu_m is not None and tuple(position_enu_m) != old.position_enu_m:
        new = replace(new, position_enu_m=_rounded_m(position_enu_m))
    if heading_deg is not None:
        is_same = heading_deg == old.heading_deg
        new = replace(new, heading_deg=wrap_heading_deg(heading_deg) if is_same else _rounded_heading_deg(heading_deg))
    if gimbal_pitch_deg is not None and gimbal_pitch_deg != old.gimbal_pitch_deg:
        new = replace(new, gimbal_pitch_deg=round(float(gimbal_pitch_deg), ANGLE_DECIMALS))
    before = {viewpoint.id: viewpoint for viewpoint in revision.plan.viewpoints}
    after = {**before, viewpoint_id: new}
    sorties = [
        with_other_stops(sortie, before, sortie.viewpoint_ids, after, revision.paths)
        if viewpoint_id in sortie.viewpoint_ids
        else sortie
        for sortie in revision.plan.sorties
    ]
    return _with_route(revision, after.values(), sorties)


def add(revision: Revision, position_enu_m: Vec3, heading_deg: float, gimbal_pitch_deg: float) -> Revision:
    """Add a viewpoint, the last of the new plan's, where it costs least time in a sortie that has room for it.

    Where none has, it gets a sortie of its own. Its identifier is `next_id` of the plan.

    Raises
    ------
    ValueError
        A viewpoint cannot be there or look there (not finite, out of range).
    """
    pitch_deg = round(float(gimbal_pitch_deg), ANGLE_DECIMALS)
    heading_deg = _rounded_heading_deg(heading_deg)
    new = Viewpoint(next_id(revision.plan), _rounded_m(position_enu_m), heading_deg, pitch_deg)
    return _with_route(revision, (*revision.plan.viewpoints, new), with_stop(revision, new))


def delete(revision: Revision, viewpoint_ids: Collection[str]) -> Revision:
    """Delete viewpoints, and the sorties that have none left.

    Raises
    ------
    InputError
        One of them is locked.
    ValueError
        There is no such viewpoint.
    """
    gone = set(viewpoint_ids)
    _check_unlocked([revision.viewpoint(viewpoint_id) for viewpoint_id in viewpoint_ids], "deleted")
    before = {viewpoint.id: viewpoint for viewpoint in revision.plan.viewpoints}
    after = {viewpoint_id: viewpoint for viewpoint_id, viewpoint in before.items() if viewpoint_id not in gone}
    sorties: list[Sortie] = []
    for sortie in revision.plan.sorties:
        left = tuple(viewpoint_id for viewpoint_id in sortie.viewpoint_ids if viewpoint_id not in gone)
        if left == sortie.viewpoint_ids:
            sorties.append(sortie)
        elif left:
            sorties.append(with_other_stops(sortie, before, left, after, revision.paths))
    return _with_route(revision, after.values(), sorties)


def lock(revision: Revision, viewpoint_ids: Collection[str], locked: bool = True) -> Revision:
    """Lock viewpoints, so that planning again keeps them, or unlock them.

    Raises
    ------
    ValueError
        There is no such viewpoint.
    """
    changed = {viewpoint_id: replace(revision.viewpoint(viewpoint_id), locked=locked) for viewpoint_id in viewpoint_ids}
    viewpoints = [changed.get(viewpoint.id, viewpoint) for viewpoint in revision.plan.viewpoints]
    return _with_route(revision, viewpoints, revision.plan.sorties)


def unlock(revision: Revision, viewpoint_ids: Collection[str]) -> Revision:
    """Unlock viewpoints; see `lock`."""
    return lock(revision, viewpoint_ids, locked=False)


def aim_at(revision: Revision, position_enu_m: Vec3, panel_id: str) -> tuple[float, float]:
    """Heading and gimbal pitch, degrees, that look from a position at a panel's middle, as far as the gimbal turns.

    Raises
    ------
    ValueError
        There is no such panel.
    """
    model = revision.case.model
    ids = [panel.id for panel in revision.prepared.site_model.site.panels]
    if panel_id not in ids:
        raise ValueError(f"panel_id: there is no panel '{panel_id}'")
    target = model.frames.centroids[ids.index(panel_id)]
    aimed = aimed_views(np.array([position_enu_m], np.float64), target[None], model.camera)
    low, high = model.camera.gimbal_pitch_deg
    heading_deg = _rounded_heading_deg(float(np.degrees(aimed.heading_rad[0])))
    return heading_deg, min(max(round(float(np.degrees(aimed.pitch_rad[0])), ANGLE_DECIMALS), low), high)


def next_id(plan: Plan) -> str:
    """Identifier for a new viewpoint: one higher than the highest of the form v0000."""
    numbers = (re.fullmatch(r"v(\d+)", viewpoint.id) for viewpoint in plan.viewpoints)
    highest = max((int(number[1]) for number in numbers if number is not None), default=-1)
    return f"v{highest + 1:04d}"


def _rounded_m(position_enu_m: Vec3) -> Vec3:
    """As plan files hold positions."""
    x, y, z = (round(float(value), POSITION_DECIMALS) for value in position_enu_m)
    return x, y, z


def _rounded_heading_deg(heading_deg: float) -> float:
    if not math.isfinite(heading_deg):
        raise ValueError(f"heading_deg: expected a finite number, got {heading_deg}")
    return wrap_heading_deg(round(wrap_heading_deg(heading_deg), ANGLE_DECIMALS))


def _check_unlocked(viewpoints: Iterable[Viewpoint], verb: str) -> None:
    for viewpoint in viewpoints:
        if viewpoint.locked:
            raise InputError.say(
                "viewpoint '{}' is locked and stays as it is; unlock it before it is {}", viewpoint.id, verb
            )
