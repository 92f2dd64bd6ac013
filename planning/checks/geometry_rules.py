"""Rules about where the aircraft is: airspace, distances, no-fly volumes, altitude, leg lengths."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.checks.case import ROUNDING_M, Case, Rule, judge
from planning.checks.measures import Gaps, legs_of
from planning.motion.sortie_timing import SAME_PLACE_M, beside_column
from planning.plan import Sortie, viewpoint_arrays
from planning.routing.rally import rally_findings
from planning.site.records import MIN_HEIGHT_ABOVE_GROUND_M

MAX_ALTITUDE_M = 120.0
"""Height above ground that most civil aviation rules allow without a permit (EASA open category, FAA part 107)."""

LONG_LEG_M, MAX_LEG_M = 2000.0, 5000.0
"""Longest legs: DJI firmware refuses over 5 km, older ones over 2 km."""


def viewpoints_in_airspace(case: Case) -> Iterator[Finding]:
    """Viewpoints lie in the airspace box."""
    low, high = case.space.low_enu_m, case.space.high_enu_m
    positions = viewpoint_arrays(case.plan.viewpoints).positions_enu_m
    outside = np.maximum(low - positions, positions - high).max(axis=1)
    found = [(float(value), v.id) for value, v in zip(outside, case.plan.viewpoints, strict=True)]
    worst, where = max([(0.0, ""), *found])
    advice = say("move them inside or widen the airspace")
    yield judge(
        worst <= ROUNDING_M, "airspace", say("viewpoints outside the airspace by"), worst, 0.0, "m", where, advice
    )


def paths_in_airspace(case: Case) -> Iterator[Finding]:
    """Paths lie in the airspace box; only legs straight above home may be below its floor."""
    low, high = case.space.low_enu_m, case.space.high_enu_m
    home = np.array(case.site_model.site.home_enu_m)
    worst, where = 0.0, ""
    for place, _, path in case.sorties():
        outside = np.maximum(np.maximum(low - path, path - high)[:, :2].max(axis=1), path[:, 2] - high[2])
        floor = np.where(beside_column(path, home), low[2], min(low[2], home[2]))
        below = floor - np.minimum(path[:-1, 2], path[1:, 2])
        worst, where = max((worst, where), (float(max(outside.max(), below.max())), place))
    advice = say("only the column above home may lie below the airspace")
    yield judge(worst <= ROUNDING_M, "airspace", say("paths outside the airspace by"), worst, 0.0, "m", where, advice)


def lowest_heights(case: Case) -> Iterator[Finding]:
    """Viewpoints and paths keep the lowest height above the ground, but for the column above home."""
    airspace, home = case.site_model.site.airspace, np.array(case.site_model.site.home_enu_m)
    limit = airspace.lowest_height_m(case.plan.constraints.min_height_above_ground_m)
    advice = say("plan it again, or allow lower flights")
    subject = say("lowest height above the ground beside the take-off column")
    for place, _, path in case.sorties():
        heights = np.minimum(path[:-1, 2], path[1:, 2]) - airspace.ground_z_m
        heights = np.where(beside_column(path, home), heights, np.inf)
        leg = int(np.argmin(heights))
        value = float(heights[leg])
        if math.isfinite(value):
            where, kept = say("{}, leg {}", place, leg + 1), value >= limit - ROUNDING_M
            yield judge(kept, "low-flight", subject, value, limit, "m", where, advice, least=True)
    flown = {viewpoint_id for _, sortie, _ in case.sorties() for viewpoint_id in sortie.viewpoint_ids}
    for viewpoint in case.plan.viewpoints:
        value = viewpoint.position_enu_m[2] - airspace.ground_z_m
        if viewpoint.id not in flown and value < limit - ROUNDING_M:
            yield judge(False, "low-flight", subject, value, limit, "m", viewpoint.id, advice, least=True)
    if limit < MIN_HEIGHT_ABOVE_GROUND_M:
        yield low_flight_allowed(limit)


def low_flight_allowed(limit_m: float) -> Finding:
    """That lower flights than usual are allowed, which wants a decision."""
    usual_m = MIN_HEIGHT_ABOVE_GROUND_M
    text = say(
        "flights down to {:g} m above the ground are allowed, below the usual {:g} m: look for people, "
        "cars and cables on the whole way",
        limit_m,
        usual_m,
    )
    return Finding(Severity.WARNING, "low-flight-allowed", text, "", limit_m, usual_m, "m")


def distances_at_viewpoints(case: Case) -> Iterator[Finding]:
    """Viewpoints keep the minimum distance."""
    if not case.plan.viewpoints:
        return
    limit = case.plan.constraints.min_distance_m
    points_m = case.measures.solid_gaps.points_m
    nearest = min(case.plan.viewpoints, key=lambda viewpoint: points_m[viewpoint.position_enu_m])
    value, place = points_m[nearest.position_enu_m], nearest.id
    subject = say("smallest distance at a viewpoint (negative: inside a solid)")
    yield judge(
        value >= limit - ROUNDING_M, "distance", subject, value, limit, "m", place, say("move it away"), least=True
    )


def distances_along_paths(case: Case) -> Iterator[Finding]:
    """Every point of every leg keeps the minimum distance."""
    limit = case.plan.constraints.min_distance_m
    for place, sortie, _ in case.sorties():
        value, leg, inside = _nearest_leg(case.measures.solid_gaps, sortie)
        advice = say("the path runs inside a solid") if inside else say("plan the route again")
        where = say("{}, leg {}", place, leg + 1)
        subject = say("smallest distance along the path")
        kept = value > 0.0 and value >= limit - ROUNDING_M
        yield judge(kept, "leg-distance", subject, value, limit, "m", where, advice, least=True)


def _nearest_leg(gaps: Gaps, sortie: Sortie) -> tuple[float, int, bool]:
    """Smallest distance along a path, -1 where a vertex lies inside; on which leg; whether a vertex lies inside."""
    along = [gaps.legs_m[leg] for leg in legs_of(sortie)]
    nearest = min(range(len(along)), key=along.__getitem__)
    inside = any(gaps.points_m[vertex] < 0.0 for vertex in sortie.path_enu_m)
    return -1.0 if inside else along[nearest], nearest, inside


def no_fly_volumes(case: Case) -> Iterator[Finding]:
    """No leg enters a no-fly volume."""
    if not case.site_model.site.airspace.no_fly:
        yield Finding(Severity.OK, "no-fly", say("the site has no no-fly volumes"))
        return
    for place, sortie, _ in case.sorties():
        value, leg, _ = _nearest_leg(case.measures.no_fly_gaps, sortie)
        where, subject = (
            say("{}, leg {}", place, leg + 1),
            say("smallest distance to a no-fly volume (negative: inside)"),
        )
        yield judge(
            value > 0.0, "no-fly", subject, value, 0.0, "m", where, say("the path enters a no-fly volume"), least=True
        )


def rally_points(case: Case) -> Iterator[Finding]:
    """Aircraft can land where they may have to; nothing to say where a site has no rally points."""
    yield from rally_findings(case.site_model, case.space)


def altitude(case: Case) -> Iterator[Finding]:
    """Height above ground stays below what needs a permit."""
    ground = case.site_model.site.airspace.ground_z_m
    heights = [(float(path[:, 2].max()) - ground, place) for place, _, path in case.sorties()]
    if heights:
        value, place = max(heights)
        advice = say("most rules ask for a permit above it")
        subject, kept = say("greatest height above ground"), value <= MAX_ALTITUDE_M
        yield judge(kept, "altitude", subject, value, MAX_ALTITUDE_M, "m", place, advice, Severity.WARNING)


def leg_lengths(case: Case) -> Iterator[Finding]:
    """Waypoints are neither too close together nor too far apart for autopilots."""
    for place, _, path in case.sorties():
        lengths = np.linalg.norm(np.diff(path, axis=0), axis=1)
        flown = lengths[lengths > SAME_PLACE_M]
        if len(flown) == 0:
            continue
        shortest, longest = float(flown.min()), float(flown.max())
        least_m = case.plan.aircraft.min_waypoint_spacing_m
        advice = say("{} legs are shorter than DJI firmware likes", int((flown < least_m).sum()))
        judged = say("shortest leg"), shortest, least_m, "m", place, advice, Severity.WARNING
        yield judge(shortest >= least_m, "leg-spacing", *judged, least=True)
        severity = Severity.ERROR if longest > MAX_LEG_M else Severity.WARNING
        kept, advice = longest <= LONG_LEG_M, say("autopilots refuse it")
        yield judge(kept, "leg-spacing", say("longest leg"), longest, LONG_LEG_M, "m", place, advice, severity)


GEOMETRY_RULES: tuple[Rule, ...] = (
    viewpoints_in_airspace,
    paths_in_airspace,
    lowest_heights,
    distances_at_viewpoints,
    distances_along_paths,
    no_fly_volumes,
    rally_points,
    altitude,
    leg_lengths,
)
