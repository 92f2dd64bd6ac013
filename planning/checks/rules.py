"""The rules of pre-flight checks.

First distances and places of what is flown, then sorties, gimbal, waypoints, wind, endurance, photos and coverage.
"""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterator

import numpy as np

from planning.base.errors import InfeasibleError
from planning.base.findings import Finding, Severity
from planning.base.messages import glue, say
from planning.checks.case import ROUNDING_M, Array, Case, Gaps, Rule, judge, legs_of, pose_of
from planning.coverage.evaluate import nearest_views_m
from planning.motion.timing import SAME_PLACE_M, beside_column, motion_limits, photo_stop_s, photo_vertices
from planning.plan import Sortie, Viewpoint, viewpoint_arrays
from planning.routing.at_once import nearest_at_once_m, sortie_leg_times
from planning.routing.rally import RETURN_TOLERANCE_M, rally_findings, return_height
from planning.site.file import is_planned_on
from planning.site.ground import decide_terrain, terrain_text
from planning.site.records import MIN_HEIGHT_ABOVE_GROUND_M, SiteModel, panel_corners
from planning.site.terrain import Terrain, surfaces

# Rules about where the aircraft is: airspace, distances, no-fly volumes, altitude, leg lengths.

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
    ground = case.space.ground
    for place, _, path in case.sorties():
        heights = ground.least_m(path[:-1], path[1:])
        heights = np.where(beside_column(path, home), heights, np.inf)
        leg = int(np.argmin(heights))
        value, where = float(heights[leg]), say("{}, leg {}", place, leg + 1)
        if math.isinf(value) and value < 0.0:
            yield ground_unknown(int(np.isneginf(heights).sum()), where)
            heights = np.where(np.isneginf(heights), np.inf, heights)
            leg = int(np.argmin(heights))
            value, where = float(heights[leg]), say("{}, leg {}", place, leg + 1)
        if math.isfinite(value):
            kept = value >= limit - ROUNDING_M
            yield judge(kept, "low-flight", subject, value, limit, "m", where, advice, least=True)
    flown = {viewpoint_id for _, sortie, _ in case.sorties() for viewpoint_id in sortie.viewpoint_ids}
    for viewpoint in case.plan.viewpoints:
        if viewpoint.id in flown:
            continue
        position = np.array([viewpoint.position_enu_m])
        value = float(ground.least_m(position, position)[0])
        if math.isinf(value):
            yield ground_unknown(1, viewpoint.id)
        elif value < limit - ROUNDING_M:
            yield judge(False, "low-flight", subject, value, limit, "m", viewpoint.id, advice, least=True)
    if limit < MIN_HEIGHT_ABOVE_GROUND_M:
        yield low_flight_allowed(limit)


def ground_unknown(n_legs: int, place: str) -> Finding:
    """That a path leads over ground of which nothing is known."""
    text = say(
        "the terrain has no heights below the path (legs concerned: {}): what is not known is not clear; attach "
        "terrain that covers it, or plan it again",
        n_legs,
    )
    return Finding(Severity.ERROR, "terrain-unknown", text, place, float(n_legs), 0.0, "legs")


def terrain_in_use(case: Case) -> Iterator[Finding]:
    """Whether heights count from terrain, and why, and whether it fits the site; nothing to say where it has none."""
    terrain = case.site_model.site.terrain
    if terrain is None:
        return
    decision = decide_terrain(case.site_model.site)
    if decision.on:
        yield from _terrain_apart(case.site_model, terrain)
    is_ignored = not decision.on and decision.size > decision.tolerance
    severity = Severity.WARNING if is_ignored else Severity.OK
    yield Finding(severity, "terrain", terrain_text(decision), "", decision.size, decision.tolerance, "m")


def terrain_unknown(model: SiteModel) -> Iterator[Finding]:
    """That nobody gave terrain, so that the ground counts as level."""
    if model.site.terrain is None:
        text = say(
            "no terrain was given, so the ground counts as level at {:g} m all around: where it rises, flights are "
            "lower above it than it says here; attach its heights to the site",
            model.site.airspace.ground_z_m,
        )
        yield Finding(Severity.NOTE, "terrain", text)


def _terrain_apart(model: SiteModel, terrain: Terrain) -> Iterator[Finding]:
    """Where the terrain does not fit home or the building's foot, by more than its accuracy and `APART_M`.

    The building may stand in a slope, from its lowest ground to its highest; home may stand on it.
    """
    ground, limit_m = surfaces(terrain).ground, terrain.accuracy_m + APART_M
    home = np.array([model.site.home_enu_m])
    off_m = float((home[:, 2] - ground.heights_m(home))[0])
    solids, foot = model.building.vertices_enu_m, panel_corners(model.site).reshape(-1, 3)
    points = solids if len(solids) else foot
    over = len(points) > 0 and bool(((home[0] >= points.min(axis=0)) & (home[0] <= points.max(axis=0)))[:2].all())
    advice = say("one of them is wrong: attach the right terrain, or shift it to home")
    if abs(off_m) > limit_m and not (over and off_m > 0.0):
        text = say(
            "home lies {:+.1f} m off the terrain, which is good to {:g} m; {}", off_m, terrain.accuracy_m, advice
        )
        yield Finding(Severity.WARNING, "terrain-apart", text, "home", abs(off_m), limit_m, "m")
    below = ground.heights_m(solids) if len(solids) else np.array([])
    known = below[np.isfinite(below)]
    if not len(known):
        return
    foot_m = float(solids[:, 2].min())
    # Above all of the ground it hangs in the air; all of the ground above it, it is buried.
    off_m = max(foot_m - float(known.max()), 0.0) - max(float(known.min()) - foot_m, 0.0)
    if abs(off_m) > limit_m:
        text = say(
            "the foot of the building lies {:+.1f} m off the terrain, which is good to {:g} m; {}",
            off_m,
            terrain.accuracy_m,
            advice,
        )
        yield Finding(Severity.WARNING, "terrain-apart", text, "building", abs(off_m), limit_m, "m")


APART_M = 2.0
"""Worth a word if terrain and site differ by more, beyond the accuracy: foundations, slopes in front of a door."""


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
    # Over ground that is not known there is no greatest height either; `lowest_heights` says so.
    of_legs = [(case.space.ground.greatest_m(path[:-1], path[1:]), place) for place, _, path in case.sorties()]
    heights = [(float(each[np.isfinite(each)].max(initial=-math.inf)), place) for each, place in of_legs]
    if heights and math.isfinite(max(heights)[0]):
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
    terrain_in_use,
    lowest_heights,
    distances_at_viewpoints,
    distances_along_paths,
    no_fly_volumes,
    rally_points,
    altitude,
    leg_lengths,
)


LENGTH_TOLERANCE = 0.01
DURATION_TOLERANCE = 0.05
"""Part by which lengths and durations in the file may differ from ours (other programs round and model otherwise)."""

FEW_COARSE = 0.01
"""Part of the covered sections that may be seen too coarsely without a warning: plans leave as much out by default."""

SHORT_SETTLE_S = 1.0
"""Less hover before a photo blurs it or catches the gimbal on its way (DJI and PX4 users report it again and again)."""


def site_file(case: Case) -> Iterator[Finding]:
    """The plan was made for this very site file; without checksums, for a site of this name."""
    plan, model = case.plan, case.site_model
    if plan.site_sha256 and model.sha256 and is_planned_on(plan.site_sha256, model):
        yield Finding(Severity.OK, "site", say("the plan was made for this site file"))
    elif plan.site != model.site.name:
        text = say("the plan was made for site '{}', this is '{}'; take its own site file", plan.site, model.site.name)
        yield Finding(Severity.ERROR, "site", text)
    elif plan.site_sha256 and model.sha256:
        text = say(
            "the site file has changed since this plan was made; what follows is measured on the file as it is now"
        )
        yield Finding(Severity.WARNING, "site", text)
    else:
        text = say(
            "the plan was made for a site of this name, '{}'; it does not say for which state of its file", plan.site
        )
        yield Finding(Severity.OK, "site", text)


def sorties(case: Case) -> Iterator[Finding]:
    """Each viewpoint in exactly one sortie, on its path and in order; paths run from home to home."""
    plan = case.plan
    times = Counter(viewpoint_id for sortie in plan.sorties for viewpoint_id in sortie.viewpoint_ids)
    wrong = [v.id for v in plan.viewpoints if times[v.id] != 1]
    if wrong:
        yield Finding(
            Severity.ERROR,
            "sorties",
            say(
                "{} viewpoints are not in exactly one sortie (the first is '{}'); plan the route again",
                len(wrong),
                wrong[0],
            ),
            wrong[0],
            float(len(wrong)),
            0.0,
            "viewpoints",
        )
    by_id = {viewpoint.id: viewpoint for viewpoint in plan.viewpoints}
    home = np.array(case.site_model.site.home_enu_m)
    for number, sortie in enumerate(plan.sorties, 1):
        yield from _sortie_path(say("sortie {}", number), sortie, by_id, home)
    if not plan.sorties:
        yield Finding(Severity.ERROR, "sorties", say("the plan has no sorties; plan the route first"))
    elif not wrong:
        yield Finding(
            Severity.OK,
            "sorties",
            say("{} viewpoints, each in one of {} sorties", len(plan.viewpoints), len(plan.sorties)),
        )


def _sortie_path(place: str, sortie: Sortie, by_id: dict[str, Viewpoint], home: Array) -> Iterator[Finding]:
    path = np.array(sortie.path_enu_m, np.float64).reshape(-1, 3)
    if len(path) < 2:
        yield Finding(
            Severity.ERROR, "path", say("the path has {} points; expected one from home to home", len(path)), place
        )
        return
    vertices = photo_vertices(sortie, by_id)
    if vertices is None:
        yield Finding(
            Severity.ERROR,
            "path",
            say("not all viewpoints are vertices of the path, in order; plan the route again"),
            place,
        )
    for end, verb in ((path[0], "starts"), (path[-1], "ends")):
        away = float(np.linalg.norm(end - home))
        if away > SAME_PLACE_M:
            message = say(
                "the path {} {:.2f} m from home; expected it to run from take-off to landing at home", verb, away
            )
            yield Finding(Severity.ERROR, "path", message, place, away, 0.0, "m")


def gimbal_and_heading(case: Case) -> Iterator[Finding]:
    """Pitches are within the gimbal's range, headings as mission files want them."""
    low, high = case.plan.camera.gimbal_pitch_deg
    pitches = [(v.gimbal_pitch_deg, v.id) for v in case.plan.viewpoints]
    if pitches:
        (lowest, first), (highest, last) = min(pitches), max(pitches)
        advice = say("the camera would stop at its limit and look elsewhere")
        yield judge(
            lowest >= low - 1e-6, "gimbal", say("lowest gimbal pitch"), lowest, low, "deg", first, advice, least=True
        )
        yield judge(highest <= high + 1e-6, "gimbal", say("highest gimbal pitch"), highest, high, "deg", last, advice)
    odd = [v.id for v in case.plan.viewpoints if not -180.0 < v.heading_deg <= 180.0]
    yield judge(
        not odd,
        "heading",
        say("viewpoints whose heading is not in (-180, 180]"),
        float(len(odd)),
        0.0,
        "viewpoints",
        odd[0] if odd else "",
        say("mission files need it there"),
    )


def waypoint_counts(case: Case) -> Iterator[Finding]:
    """Sorties have no more waypoints than the aircraft takes."""
    limit = case.plan.aircraft.max_waypoints
    for place, _, path in case.sorties():
        yield judge(
            len(path) <= limit + 2,
            "waypoints",
            say("waypoints of {}", case.plan.aircraft.name),
            float(len(path) - 2),
            float(limit),
            "",
            place,
            say("split the flight into more sorties"),
        )


def durations(case: Case) -> Iterator[Finding]:
    """Endurance with reserve, by the longer of the plan's duration and ours; lengths and durations as stated.

    Ours stops at every waypoint; a stated duration may be shorter by what flying through the corners saves.
    """
    plan = case.plan
    try:
        motion_limits(plan.aircraft, plan.rules)
    except InfeasibleError as error:
        yield Finding(Severity.ERROR, "wind", str(error), "", plan.rules.wind_m_s, plan.aircraft.max_wind_m_s, "m/s")
        return
    yield judge(True, "wind", say("expected wind"), plan.rules.wind_m_s, plan.aircraft.max_wind_m_s, "m/s")
    usable = plan.aircraft.endurance_s * (1.0 - plan.rules.battery_reserve)
    for place, sortie, flight in case.timed_sorties():
        ours, length = flight.stopping_s, flight.length_m
        least = (ours - flight.corner_saving_s) * (1.0 - DURATION_TOLERANCE)
        yield judge(
            max(ours, sortie.duration_s) <= usable + 0.01,
            "endurance",
            say("duration with the battery reserve kept"),
            max(ours, sortie.duration_s),
            usable,
            "s",
            place,
            say("fly fewer views per sortie"),
        )
        yield judge(
            sortie.duration_s >= least,
            "duration",
            say("stated duration"),
            sortie.duration_s,
            least,
            "s",
            place,
            say("it is too optimistic for this path"),
            Severity.WARNING,
            least=True,
        )
        yield judge(
            abs(sortie.length_m - length) <= LENGTH_TOLERANCE * max(length, 1.0),
            "length",
            say("stated length off by"),
            abs(sortie.length_m - length),
            LENGTH_TOLERANCE * max(length, 1.0),
            "m",
            place,
            "",
            Severity.WARNING,
        )


def aircraft_apart(case: Case) -> Iterator[Finding]:
    """Sorties in the air at once keep apart, early or late as they may be; those of one aircraft follow each other."""
    plan, rules = case.plan, case.plan.rules
    if rules.at_once == 1:
        return
    if plan.landed_s is None:
        text = say("the sorties of several aircraft have no starts any more; plan the flight again")
        yield Finding(Severity.ERROR, "at-once", text)
        return
    try:
        legs = [sortie_leg_times(plan, sortie) for sortie in plan.sorties]
    except InfeasibleError:  # `durations` says it
        return
    timed = [
        (number, sortie, sortie.start_s, leg)
        for number, (sortie, leg) in enumerate(zip(plan.sorties, legs, strict=True), 1)
        if leg is not None and sortie.start_s is not None  # `sorties` says which path misses its viewpoints
    ]
    nearest_m, nearest = math.inf, ""
    for (first, one, one_s, leg), (second, other, other_s, another) in itertools.combinations(timed, 2):
        if one.aircraft != other.aircraft:
            gap_m = nearest_at_once_m(leg, one_s, another, other_s)
            if gap_m < nearest_m:
                nearest_m, nearest = gap_m, say("sorties {} and {}", first, second)
        elif one_s < other_s + other.duration_s + another.longer_s and other_s < one_s + one.duration_s + leg.longer_s:
            text = say("sorties {} and {} need one aircraft at the same time; plan the flight again", first, second)
            yield Finding(Severity.ERROR, "at-once", text, say("sortie {}", second))
    if math.isinf(nearest_m):
        yield Finding(Severity.OK, "at-once", say("no two aircraft are in the air at the same time"))
        return
    yield judge(
        nearest_m >= rules.apart_m - ROUNDING_M,
        "at-once",
        say("distance of aircraft in the air at the same time"),
        nearest_m,
        rules.apart_m,
        "m",
        nearest,
        say("plan the flight again"),
        least=True,
    )


def _between_photos(case: Case) -> Iterator[tuple[float, str]]:
    """Shortest time between two photos of each sortie as it is commanded, and before which viewpoint.

    Planned stops last at least the camera's interval; missions command the settling time only, so that what planning
    adds to it is taken off here.
    """
    aircraft, rules = case.plan.aircraft, case.plan.rules
    added_s = photo_stop_s(aircraft, rules) - (rules.settle_s + rules.photo_s)
    for place, sortie, flight in case.timed_sorties():
        between_s = np.diff(flight.photos_done_s)
        if len(between_s):
            shortest = int(np.argmin(between_s))
            yield float(between_s[shortest]) - added_s, glue(place, ", ", sortie.viewpoint_ids[shortest + 1])


def photo_times(case: Case) -> Iterator[Finding]:
    """The camera has time for each photo, and the aircraft time to settle before it."""
    plan = case.plan
    shortest = min(_between_photos(case), default=None)
    if shortest is not None:
        (between, place), limit = shortest, plan.aircraft.min_photo_interval_s
        subject, advice = (
            say("shortest time between photos"),
            say("the camera would miss photos; hover longer before each"),
        )
        yield judge(between >= limit, "photo-interval", subject, between, limit, "s", place, advice, least=True)
    yield judge(
        plan.rules.settle_s >= SHORT_SETTLE_S,
        "settle",
        say("hover before each photo"),
        plan.rules.settle_s,
        SHORT_SETTLE_S,
        "s",
        advice=say("1 to 2 s keep photos sharp"),
        severity=Severity.WARNING,
        least=True,
    )


def ground_sampling(case: Case) -> Iterator[Finding]:
    """Each photo shows a panel with pixels as fine as the constraints ask; others cover nothing."""
    furthest, viewpoints = case.plan.constraints.max_distance_m, case.plan.viewpoints
    measures = case.measures
    worst = case.plan.camera.gsd_m(max((sight.furthest_m for sight in measures.seen.values()), default=0.0))
    text = say("coarsest pixel on a covered panel: {:.2f} mm", 1000.0 * worst)
    if furthest is None:
        yield Finding(Severity.OK, "gsd", say("{}, no limit set", text), "", 1e3 * worst, None, "mm")
        return
    nearest = [(measures.nearest_m[pose_of(viewpoint)], viewpoint.id) for viewpoint in viewpoints]
    seen = [(distance, viewpoint_id) for distance, viewpoint_id in nearest if distance < math.inf]
    distance, place = max(seen, default=(0.0, ""))
    value, limit = 1e3 * case.plan.camera.gsd_m(distance), 1e3 * case.plan.camera.gsd_m(furthest)
    subject, advice = (
        say("finest pixel on a panel, of the coarsest photo"),
        say("it covers nothing; take it closer or drop it"),
    )
    yield judge(value <= limit * (1.0 + 1e-9), "gsd", subject, value, limit, "mm", place, advice, Severity.WARNING)


def sharp_views(case: Case) -> Iterator[Finding]:
    """Covered sections of which no view is sharp."""
    nearest_m = nearest_views_m(case.model, case.measures.seen.values())
    covered = np.isfinite(nearest_m)
    if not covered.any() or case.model.sharp_m is None:
        return
    n_coarse = int(np.count_nonzero(nearest_m[covered] > case.model.sharp_m))
    worst = int(np.argmax(np.where(covered, nearest_m, 0.0)))
    panel = case.site_model.site.panels[worst // case.model.grid.n_sections].id
    camera = case.model.camera
    coarsest_mm, wanted_mm = 1e3 * camera.gsd_m(float(nearest_m[worst])), 1e3 * camera.gsd_m(case.model.sharp_m)
    yield sharpness(n_coarse, int(covered.sum()), coarsest_mm, wanted_mm, panel)


def sharpness(n_coarse: int, n_covered: int, coarsest_mm: float, wanted_mm: float, panel: str = "") -> Finding:
    """A finding on the sections that are covered by views with too large pixels only."""
    text = say("sections seen only with pixels larger than {:.1f} mm: {} of {} covered", wanted_mm, n_coarse, n_covered)
    text = say("{}, the coarsest with {:.1f} mm", text, coarsest_mm)
    if n_coarse == 0:
        return Finding(Severity.OK, "sharpness", text, panel, 0.0, 0.0, "sections")
    severity = Severity.WARNING if n_coarse > FEW_COARSE * n_covered else Severity.NOTE
    text = say("{}; allow more views, or a larger pixel", text)
    return Finding(severity, "sharpness", text, panel, float(n_coarse), 0.0, "sections")


def stated_coverage(case: Case) -> Iterator[Finding]:
    """The coverage that the plan states is what its viewpoints cover."""
    stated, total = case.plan.coverage, case.model.n_elements
    covered = int(np.count_nonzero(case.measures.counts))
    if covered == 0:
        text = say("no panel is seen from any viewpoint")
        yield Finding(Severity.ERROR, "coverage", text, "", 0.0, float(total), "sections")
    if (covered, total) == (stated.covered, stated.total):
        text = say("{} of {} sections are covered, as the plan states", covered, total)
        yield Finding(Severity.OK, "coverage", text, "", float(covered), float(stated.covered), "sections")
    else:
        text = say(
            "{} of {} sections are covered, but the plan states {} of {}", covered, total, stated.covered, stated.total
        )
        yield Finding(Severity.WARNING, "coverage", text, "", float(covered), float(stated.covered), "sections")


def duplicates(case: Case) -> Iterator[Finding]:
    """No photo is taken twice."""
    poses = Counter(pose_of(viewpoint) for viewpoint in case.plan.viewpoints)
    again = sum(count - 1 for count in poses.values())
    yield judge(
        again == 0,
        "duplicates",
        say("viewpoints that repeat another"),
        float(again),
        0.0,
        "viewpoints",
        advice=say("they cost time and show nothing new"),
        severity=Severity.WARNING,
    )


def return_home(case: Case) -> Iterator[Finding]:
    """An aircraft that returns by itself stays inside the airspace, and keeps the minimum distance on its way.

    Where the airspace ends too low for that, no height is right: one leads into the building, the other out of it. What
    the path itself does wrong is not said of the return again.
    """
    gaps = case.measures
    ways = gaps.return_routes.values()
    if not ways:
        return
    found, gap_m = return_height(case.space), min(way.gap_m for way in ways)
    limit_m = min(case.space.min_distance_m, *gaps.solid_gaps.legs_m.values())
    above_ground_m = min(way.above_ground_m for way in ways)
    airspace = case.site_model.site.airspace
    lowest_m = airspace.lowest_height_m(case.plan.constraints.min_height_above_ground_m)
    path_crosses = min(gaps.no_fly_gaps.legs_m.values(), default=math.inf) <= 0.0
    crosses_by_itself = not path_crosses and any(way.crosses_no_fly for way in ways)
    is_capped = found.above_home_m < found.wanted_above_home_m
    if gap_m < limit_m - RETURN_TOLERANCE_M and is_capped:
        what = say("through the building or an obstacle") if gap_m <= 0.0 else say("{:.1f} m from something", gap_m)
        text = say(
            "an aircraft that returns by itself would fly {}: at {:.1f} m above take-off it clears "
            "everything, and the airspace ends at {:.1f} m; raise its ceiling, or move home to the side of "
            "the building that is flown",
            what,
            found.wanted_above_home_m,
            found.ceiling_above_home_m,
        )
        yield Finding(
            Severity.ERROR,
            "return-height",
            text,
            "",
            found.wanted_above_home_m,
            found.ceiling_above_home_m,
            "m",
        )
    elif gap_m < limit_m - RETURN_TOLERANCE_M:
        text = say("an aircraft that returns by itself climbs within {:.1f} m of the building or an obstacle", gap_m)
        yield Finding(Severity.WARNING, "return-height", text, "", gap_m, limit_m, "m")
    elif above_ground_m < lowest_m - ROUNDING_M and case.space.ground.terrain is not None:
        text = (
            say("{:.1f} m above the terrain", above_ground_m)
            if math.isfinite(above_ground_m)
            else say("over terrain of which no heights are known")
        )
        text = say("an aircraft that returns by itself would fly {}; raise the ceiling of the airspace", text)
        value = above_ground_m if math.isfinite(above_ground_m) else None
        yield Finding(Severity.ERROR, "return-height", text, "", value, lowest_m, "m")
    elif crosses_by_itself:
        text = say(
            "an aircraft that returns by itself, {:g} m above take-off, crosses a no-fly zone; fly it back by hand",
            found.above_home_m,
        )
        yield Finding(Severity.WARNING, "return-height", text, "", found.above_home_m, found.ceiling_above_home_m, "m")
    else:
        text = say(
            "an aircraft that returns by itself flies {:g} m above take-off, {:.1f} m are allowed",
            found.above_home_m,
            found.ceiling_above_home_m,
        )
        yield Finding(Severity.OK, "return-height", text, "", found.above_home_m, found.ceiling_above_home_m, "m")


FLIGHT_RULES: tuple[Rule, ...] = (
    site_file,
    sorties,
    gimbal_and_heading,
    waypoint_counts,
    durations,
    aircraft_apart,
    photo_times,
    ground_sampling,
    sharp_views,
    duplicates,
    stated_coverage,
    return_home,
)
