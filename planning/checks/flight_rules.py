"""Rules about what is flown: sorties, gimbal, waypoints, wind, endurance, photos, and what they cover."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import numpy as np

from planning.checks.case import SAME_PLACE_M, Array, Case, Rule, judge, photo_vertices
from planning.errors import InfeasibleError
from planning.evaluate import coverage_counts, ground_sampling_m
from planning.findings import Finding, Severity
from planning.plan import Sortie, Viewpoint, viewpoint_arrays
from planning.speed_profile import corner_saving_s
from planning.timing import flight_path, motion_limits, photo_stop_s, stopping_times_s

LENGTH_TOLERANCE = 0.01
DURATION_TOLERANCE = 0.05
"""Part by which lengths and durations in the file may differ from ours (other programs round and model otherwise)."""

SHORT_SETTLE_S = 1.0
"""Less hover before a photo blurs it or catches the gimbal on its way (DJI and PX4 users report it again and again)."""


def site_file(case: Case) -> Iterator[Finding]:
    """The plan was made for this very site file."""
    if case.plan.site_sha256 and case.site_model.sha256 and case.plan.site_sha256 != case.site_model.sha256:
        text = "the site file has changed since this plan was made; what follows is measured on the file as it is now"
        yield Finding(Severity.WARNING, "site", text)
    else:
        yield Finding(Severity.OK, "site", "the plan was made for this site file")


def sorties(case: Case) -> Iterator[Finding]:
    """Each viewpoint in exactly one sortie, on its path and in order; paths run from home to home."""
    plan = case.plan
    times = Counter(viewpoint_id for sortie in plan.sorties for viewpoint_id in sortie.viewpoint_ids)
    wrong = [v.id for v in plan.viewpoints if times[v.id] != 1]
    if wrong:
        yield Finding(
            Severity.ERROR,
            "sorties",
            f"{len(wrong)} viewpoints are not in exactly one sortie (the first is '{wrong[0]}'); plan the route again",
            wrong[0],
            float(len(wrong)),
            0.0,
            "viewpoints",
        )
    by_id = {viewpoint.id: viewpoint for viewpoint in plan.viewpoints}
    home = np.array(case.site_model.site.home_enu_m)
    for number, sortie in enumerate(plan.sorties, 1):
        yield from _sortie_path(f"sortie {number}", sortie, by_id, home)
    if not plan.sorties:
        yield Finding(Severity.ERROR, "sorties", "the plan has no sorties; plan the route first")
    elif not wrong:
        yield Finding(
            Severity.OK, "sorties", f"{len(plan.viewpoints)} viewpoints, each in one of {len(plan.sorties)} sorties"
        )


def _sortie_path(place: str, sortie: Sortie, by_id: dict[str, Viewpoint], home: Array) -> Iterator[Finding]:
    path = np.array(sortie.path_enu_m, np.float64).reshape(-1, 3)
    if len(path) < 2:
        yield Finding(Severity.ERROR, "path", f"the path has {len(path)} points; expected one from home to home", place)
        return
    vertices = photo_vertices(sortie, by_id)
    if vertices is None:
        yield Finding(
            Severity.ERROR, "path", "not all viewpoints are vertices of the path, in order; plan the route again", place
        )
    for end, verb in ((path[0], "starts"), (path[-1], "ends")):
        away = float(np.linalg.norm(end - home))
        if away > SAME_PLACE_M:
            message = f"the path {verb} {away:.2f} m from home; expected it to run from take-off to landing at home"
            yield Finding(Severity.ERROR, "path", message, place, away, 0.0, "m")


def gimbal_and_heading(case: Case) -> Iterator[Finding]:
    """Pitches are within the gimbal's range, headings as mission files want them."""
    low, high = case.plan.camera.gimbal_pitch_deg
    pitches = [(v.gimbal_pitch_deg, v.id) for v in case.plan.viewpoints]
    if pitches:
        (lowest, first), (highest, last) = min(pitches), max(pitches)
        advice = "the camera would stop at its limit and look elsewhere"
        yield judge(lowest >= low - 1e-6, "gimbal", "lowest gimbal pitch", lowest, low, "deg", first, advice)
        yield judge(highest <= high + 1e-6, "gimbal", "highest gimbal pitch", highest, high, "deg", last, advice)
    odd = [v.id for v in case.plan.viewpoints if not -180.0 < v.heading_deg <= 180.0]
    yield judge(
        not odd,
        "heading",
        "viewpoints whose heading is not in (-180, 180]",
        float(len(odd)),
        0.0,
        "viewpoints",
        odd[0] if odd else "",
        "mission files need it there",
    )


def waypoint_counts(case: Case) -> Iterator[Finding]:
    """Sorties have no more waypoints than the aircraft takes."""
    limit = case.plan.aircraft.max_waypoints
    for place, path in case.paths():
        yield judge(
            len(path) <= limit + 2,
            "waypoints",
            f"waypoints of {case.plan.aircraft.name}",
            float(len(path) - 2),
            float(limit),
            "",
            place,
            "split the flight into more sorties",
        )


def durations(case: Case) -> Iterator[Finding]:
    """Endurance with reserve, by the longer of the plan's duration and ours; lengths and durations as stated.

    Ours stops at every waypoint; a stated duration may be shorter by what flying through the corners saves.
    """
    plan = case.plan
    try:
        limits = motion_limits(plan.aircraft, plan.rules)
    except InfeasibleError as error:
        yield Finding(Severity.ERROR, "wind", str(error), "", plan.rules.wind_m_s, plan.aircraft.max_wind_m_s, "m/s")
        return
    yield judge(True, "wind", "expected wind", plan.rules.wind_m_s, plan.aircraft.max_wind_m_s, "m/s")
    usable = plan.aircraft.endurance_s * (1.0 - plan.rules.battery_reserve)
    by_id = {viewpoint.id: viewpoint for viewpoint in plan.viewpoints}
    for number, sortie in enumerate(plan.sorties, 1):
        place = f"sortie {number}"
        vertices = photo_vertices(sortie, by_id)
        if vertices is None or len(sortie.path_enu_m) < 2:
            continue
        views = viewpoint_arrays(tuple(by_id[i] for i in sortie.viewpoint_ids))
        path = np.array(sortie.path_enu_m, np.float64)
        through = flight_path(
            path,
            np.array(vertices, np.int64),
            views.heading_rad,
            views.pitch_rad,
            plan.aircraft,
            plan.rules,
            stop_at_corners=False,
        )
        stopping_s = float(stopping_times_s(through, limits)[-1] + through.hover_s[-1])
        ours = plan.rules.takeoff_landing_s + stopping_s
        least = (ours - corner_saving_s(through, limits)[0]) * (1.0 - DURATION_TOLERANCE)
        length = float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
        yield judge(
            max(ours, sortie.duration_s) <= usable + 0.01,
            "endurance",
            "duration with the battery reserve kept",
            max(ours, sortie.duration_s),
            usable,
            "s",
            place,
            "fly fewer views per sortie",
        )
        yield judge(
            sortie.duration_s >= least,
            "duration",
            "stated duration",
            sortie.duration_s,
            least,
            "s",
            place,
            "it is too optimistic for this path",
            Severity.WARNING,
        )
        yield judge(
            abs(sortie.length_m - length) <= LENGTH_TOLERANCE * max(length, 1.0),
            "length",
            "stated length off by",
            abs(sortie.length_m - length),
            LENGTH_TOLERANCE * max(length, 1.0),
            "m",
            place,
            "",
            Severity.WARNING,
        )


def photo_times(case: Case) -> Iterator[Finding]:
    """The camera has time for each photo, and the aircraft time to settle before it."""
    plan = case.plan
    between = photo_stop_s(plan.aircraft, plan.rules)
    yield judge(
        between >= plan.aircraft.min_photo_interval_s,
        "photo-interval",
        "shortest time between photos",
        between,
        plan.aircraft.min_photo_interval_s,
        "s",
        advice="the camera would miss photos",
    )
    settle, text = plan.rules.settle_s, "hover before each photo"
    advice = "1 to 2 s keep photos sharp"
    yield judge(
        settle >= SHORT_SETTLE_S, "settle", text, settle, SHORT_SETTLE_S, "s", advice=advice, severity=Severity.WARNING
    )


def ground_sampling(case: Case) -> Iterator[Finding]:
    """Pixels on covered panels are as fine as the constraints ask."""
    _, worst = ground_sampling_m(case.model, case.plan.viewpoints)
    furthest = case.plan.constraints.max_distance_m
    if furthest is None:
        yield Finding(
            Severity.OK,
            "gsd",
            f"coarsest pixel on a covered panel: {1e3 * worst:.2f} mm, no limit set",
            "",
            1e3 * worst,
            None,
            "mm",
        )
        return
    limit = case.plan.camera.gsd_m(furthest)
    yield judge(
        worst <= limit * (1.0 + 1e-9),
        "gsd",
        "coarsest pixel on a covered panel",
        1e3 * worst,
        1e3 * limit,
        "mm",
    )


def stated_coverage(case: Case) -> Iterator[Finding]:
    """The coverage that the plan states is what its viewpoints cover."""
    stated, total = case.plan.coverage, case.model.n_elements
    covered = int(np.count_nonzero(coverage_counts(case.model, case.plan.viewpoints)))
    if covered == 0:
        text = "no panel is seen from any viewpoint"
        yield Finding(Severity.ERROR, "coverage", text, "", 0.0, float(total), "sections")
    if (covered, total) == (stated.covered, stated.total):
        text = f"{covered} of {total} sections are covered, as the plan states"
        yield Finding(Severity.OK, "coverage", text, "", float(covered), float(stated.covered), "sections")
    else:
        text = f"{covered} of {total} sections are covered, but the plan states {stated.covered} of {stated.total}"
        yield Finding(Severity.WARNING, "coverage", text, "", float(covered), float(stated.covered), "sections")


def duplicates(case: Case) -> Iterator[Finding]:
    """No photo is taken twice."""
    poses = Counter((v.position_enu_m, v.heading_deg, v.gimbal_pitch_deg) for v in case.plan.viewpoints)
    again = sum(count - 1 for count in poses.values())
    yield judge(
        again == 0,
        "duplicates",
        "viewpoints that repeat another",
        float(again),
        0.0,
        "viewpoints",
        advice="they cost time and show nothing new",
        severity=Severity.WARNING,
    )


FLIGHT_RULES: tuple[Rule, ...] = (
    site_file,
    sorties,
    gimbal_and_heading,
    waypoint_counts,
    durations,
    photo_times,
    ground_sampling,
    duplicates,
    stated_coverage,
)
