"""Rules of the flight report: what was measured on a flight, against its limits; all findings at once."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from missions.flight.matching import counts_by_more, n_lost
from missions.flight.outcome import Ending, Reason, SortieOutcome, Summary, ViewOutcome
from missions.flight.record import FlightRecord, Track
from planning.base.findings import Finding, Severity
from planning.base.messages import joined, say
from planning.checks.case import Case, judge

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Limits:
    """What a flight is judged by.

    Parameters
    ----------
    position_m, heading_deg, gimbal_pitch_deg
        Largest errors at the shutter.
    coverage
        Least part of the planned sections to be covered.
    duration
        Part by which a duration may differ from the predicted one.
    blur_px
        Largest smear; more than a pixel takes sharpness that the camera has.
    exposure_s
        Shutter time that blur is computed with: 1/500 s, a bright day.
    """

    position_m: float = 0.5
    heading_deg: float = 3.0
    gimbal_pitch_deg: float = 2.0
    coverage: float = 0.97
    duration: float = 0.10
    blur_px: float = 1.0
    exposure_s: float = 0.002

    def __post_init__(self) -> None:
        for name in self.__slots__:
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) > 0.0):
                raise ValueError(f"{name}: expected a positive number, got {getattr(self, name)}")


DEFAULT_LIMITS = Limits()


REASONS = {
    Reason.NOT_FLOWN: say("in sorties that were not flown"),
    Reason.NOT_REACHED: say("not reached"),
    Reason.NO_PHOTO: say("reached, but the camera did not answer"),
    Reason.REPORT_LOST: say("photographed, but the camera's report was lost"),
    Reason.TOO_FAR: say("photographed from too far away"),
    Reason.WRONG_ANGLE: say("where the photo looks elsewhere"),
    Reason.FLIGHT_ENDED: say("not reached before the flight ended"),
    Reason.NOT_RECORDED: say("after the end of the record in the air"),
    Reason.NO_TRACK: say("where the record does not tell the aircraft's place"),
}
"""Why views have no photo, to be read after their number."""

ENDINGS = {
    Ending.UNKNOWN: REASONS[Reason.FLIGHT_ENDED],
    Ending.RETURN: say("not reached because the flight was broken off by Return"),
    Ending.LAND: say("not reached because the flight was broken off by Land"),
    Ending.BATTERY: say("not reached because the flight was broken off for low battery"),
    Ending.LINK: say("not reached because the flight was broken off for the lost link"),
    Ending.REMOTE: say("not reached because the flight was broken off for the lost remote control"),
    Ending.FENCE: say("not reached because the flight was broken off at the fence"),
    Ending.HAND: say("not reached because the pilot took over by hand"),
    Ending.MOTORS: say("not reached because the motors stopped in the air"),
}
"""The same for views that come after the end of the flight, by how it ended."""


def flight_findings(
    case: Case,
    records: Sequence[FlightRecord],
    summary: Summary,
    views: Sequence[ViewOutcome],
    sorties: Sequence[SortieOutcome],
    limits: Limits,
) -> tuple[Finding, ...]:
    """All findings of all rules."""
    return (
        *_sorties_known(records, sorties),
        *_endings(case, records, sorties),
        *_views_taken(views, sorties),
        *_reports_lost(records, views),
        *_poses(views, limits),
        *_coverage(summary, limits),
        *_distances(case, sorties),
        *_heights(case, sorties),
        *_aircraft_apart(case, records, sorties),
        *_durations(sorties, limits),
        *_batteries(case, records, sorties),
    )


def _sorties_known(records: Sequence[FlightRecord], sorties: Sequence[SortieOutcome]) -> Iterator[Finding]:
    if not records:
        yield Finding(Severity.ERROR, "no-flight", say("there is no record of any flight"))
    for record, outcome in zip(records, sorties, strict=True):
        place = _place(outcome)
        if outcome.sortie == 0:
            text = say("this flight is none of the plan's sorties: no photo and no view of them is near its track")
            yield Finding(Severity.WARNING, "sortie-unknown", text, place)
        elif record.sortie not in (0, outcome.sortie):
            text = say(
                "recorded as sortie {}, but it flew sortie {}; it counts as what it flew", record.sortie, outcome.sortie
            )
            yield Finding(Severity.WARNING, "sortie-swapped", text, place)


ENDED_BADLY = frozenset(("motors-off", "ends-in-air", "battery-empty"))
"""Codes of findings that say that a flight did not end as flights should."""

UP_M = 2.0
"""An aircraft higher than this above the ground and away from everything has not landed."""

EMPTY = 0.01
"""Charge at or below which a battery was flown empty."""


def _endings(case: Case, records: Sequence[FlightRecord], sorties: Sequence[SortieOutcome]) -> Iterator[Finding]:
    """Motors that stopped in the air, records that end there, and batteries that were flown empty."""
    for record, outcome in zip(records, sorties, strict=True):
        up_m = left_in_air_m(case, record)
        if up_m is not None and record.is_disarmed:
            text = say(
                "the motors stopped {:.0f} m above take-off: the aircraft fell; look for it, and for the cause", up_m
            )
            yield Finding(Severity.ERROR, "motors-off", text, _place(outcome), up_m, UP_M, "m")
        elif up_m is not None:
            text = say(
                "the record ends {:.0f} m above take-off with the motors running; what came after is not in it: "
                "take the autopilot's own log",
                up_m,
            )
            yield Finding(Severity.ERROR, "ends-in-air", text, _place(outcome), up_m, UP_M, "m")
        known = record.track.battery[record.track.battery >= 0.0]
        if len(known) and known[-1] <= EMPTY:
            text = say("the battery was empty at the end ({:.0%}): the aircraft could have fallen", known[-1])
            yield Finding(Severity.ERROR, "battery-empty", text, _place(outcome), 100.0 * float(known[-1]), 0.0, "%")


def left_in_air_m(case: Case, record: FlightRecord) -> float | None:
    """Height above take-off at which a record leaves an aircraft in the air; None where it landed, or it does not say.

    It has landed on the ground, on something of the site, or beside home or a rally point. A height that is older than
    `FRESH_S` when the motors stop says nothing: the aircraft may have landed unheard.
    """
    is_known = np.isfinite(record.track.position_enu_m).all(axis=1)
    points = record.track.position_enu_m[is_known]
    if record.is_disarmed is None or len(points) == 0:
        return None
    stopped_s = next((event.time_s for event in reversed(record.events) if event.code == "disarmed"), None)
    if record.is_disarmed and stopped_s is not None and stopped_s - record.track.time_s[is_known][-1] > FRESH_S:
        return None
    site, last = case.site_model.site, points[-1]
    places = np.array([site.home_enu_m, points[0], *(point.position_enu_m for point in site.rally_points)])
    lowest_z = min(float(places[:, 2].min()), site.airspace.ground_z_m)
    is_low = last[2] - lowest_z <= UP_M
    is_at_place = bool(((np.abs(places[:, 2] - last[2]) <= UP_M) & (_level_m(places, last) <= LANDED_NEAR_M)).any())
    on_something = bool(record.is_disarmed) and float(case.space.solids.clearance_m(last[None])[0]) <= UP_M
    return None if is_low or is_at_place or on_something else float(last[2] - site.home_enu_m[2])


FRESH_S = 2.0
"""Age of a height that still tells where motors stopped: autopilots take longer to land from 2 m (0.5 to 0.7 m/s)."""

LANDED_NEAR_M = 10.0
"""Around home and rally points, within which a landing at their height is one there."""


def _level_m(places: Floats, point: Floats) -> Floats:
    return np.asarray(np.linalg.norm(places[:, :2] - point[:2], axis=1))


def _place(outcome: SortieOutcome) -> str:
    return say("sortie {}", outcome.sortie) if outcome.sortie else say("record {}", outcome.record + 1)


def _views_taken(views: Sequence[ViewOutcome], sorties: Sequence[SortieOutcome]) -> Iterator[Finding]:
    missing = [view for view in views if view.reason is not Reason.TAKEN]
    n_taken = len(views) - len(missing)
    if missing:
        endings = {outcome.sortie: outcome.ending for outcome in sorties}
        counts = Counter(_why(view, endings) for view in missing)
        why = joined(", ", (say(f"{{}} {words}", n) for words, n in counts.most_common()))
        is_lost = {view.reason for view in missing} == {Reason.REPORT_LOST}
        advice = (
            say("look through the photos before planning a top-up flight")
            if is_lost
            else say("plan a top-up flight for them")
        )
        text = say("{} of {} views have no photo that is known of: {}; {}", len(missing), len(views), why, advice)
        if len(missing) == 1:
            text = say("1 of {} views has no photo that is known of: {}; {}", len(views), why, advice)
        severity = Severity.WARNING if is_lost else Severity.ERROR
        first = missing[0].view_id
        yield Finding(severity, "views-taken", text, first, float(n_taken), float(len(views)), "views")
    else:
        text = say("all {} views have a photo", len(views))
        yield Finding(Severity.OK, "views-taken", text, "", float(n_taken), float(len(views)), "views")
    n_extra = sum(outcome.n_extra for outcome in sorties)
    if n_extra:
        text = (
            say("1 photo belongs to no view, or to one that has a better photo; it counts for coverage, too")
            if n_extra == 1
            else say(
                "{} photos belong to no view, or to one that has a better photo; they count for coverage, too", n_extra
            )
        )
        yield Finding(Severity.NOTE, "photos-extra", text, "", float(n_extra), 0.0, "photos")


def _why(view: ViewOutcome, endings: Mapping[int, Ending]) -> str:
    """Why a view has no photo, to be read after a number."""
    is_after = view.reason is Reason.FLIGHT_ENDED
    return ENDINGS[endings.get(view.sortie, Ending.UNKNOWN)] if is_after else REASONS[view.reason]


def _reports_lost(records: Sequence[FlightRecord], views: Sequence[ViewOutcome]) -> Iterator[Finding]:
    silent = any(view.reason in (Reason.REPORT_LOST, Reason.NO_PHOTO) for view in views)
    # A camera that keeps two files of each photo counts by two, and none of them was lost.
    n = sum(n_lost(record) for record in records if silent or not counts_by_more(record))
    if n:
        n_of_views = sum(view.reason is Reason.REPORT_LOST for view in views)
        text = say(
            "the camera counted {} photos whose reports did not arrive; {} of them are of views that are "
            "known; the autopilot's own log (.BIN, .ulg) tells of all",
            n,
            n_of_views,
        )
        yield Finding(Severity.WARNING, "reports-lost", text, "", float(n), 0.0, "photos")


def _poses(views: Sequence[ViewOutcome], limits: Limits) -> Iterator[Finding]:
    taken = [view for view in views if view.reason is Reason.TAKEN]
    rules = (
        ("position", "position_error_m", limits.position_m, "m", say("position error at the shutter"), Severity.ERROR),
        (
            "heading",
            "heading_error_deg",
            limits.heading_deg,
            "deg",
            say("heading error at the shutter"),
            Severity.ERROR,
        ),
        ("gimbal", "gimbal_pitch_error_deg", limits.gimbal_pitch_deg, "deg", say("gimbal pitch error"), Severity.ERROR),
        ("blur", "blur_px", limits.blur_px, "px", say("motion blur"), Severity.WARNING),
    )
    for code, field, limit, unit, what, severity in rules:
        known = [(abs(getattr(view, field)), view.view_id) for view in taken if getattr(view, field) is not None]
        if len(known) < len(taken):
            n = len(taken) - len(known)
            as_planned = (
                "" if code in ("position", "blur") else say("; coverage is counted as if they looked as planned")
            )
            text = say("the {} of {} of {} photos is not known{}", what, n, len(taken), as_planned)
            yield Finding(Severity.WARNING, f"{code}-unknown", text, "", float(n), 0.0, "photos")
        if not known:
            continue
        worst, where = max(known)
        n_over = sum(value > limit for value, _ in known)
        cure = (
            say("fly with RTK, hover longer, or in less wind")
            if code == "position"
            else say("hover longer, or fly in less wind")
        )
        advice = say("{} of {} photos are over it; {}", n_over, len(known), cure)
        yield judge(worst <= limit, code, say("largest {}", what), worst, limit, unit, where, advice, severity)


def _coverage(summary: Summary, limits: Limits) -> Iterator[Finding]:
    if summary.covered_planned:
        share = summary.covered / summary.covered_planned
        subject = say("sections covered, {} where {} were planned", summary.covered, summary.covered_planned)
        advice = say("plan a top-up flight")
        yield judge(
            share >= limits.coverage, "coverage", subject, 100.0 * share, 100.0 * limits.coverage, "%", "", advice,
            least=True,
        )  # fmt: skip
    if summary.lost_panels:
        n = len(summary.lost_panels)
        first = summary.lost_panels[0]
        many = say("{} panels of the plan are on no photo, the first is '{}'", n, first)
        text = say("the panel '{}' of the plan is on no photo", first) if n == 1 else many
        yield Finding(Severity.WARNING, "panels-lost", text, summary.lost_panels[0], float(n), 0.0, "panels")


def _distances(case: Case, sorties: Sequence[SortieOutcome]) -> Iterator[Finding]:
    """The minimum distance; where it was missed by no more than positions may err, it is a warning only."""
    limit = case.plan.constraints.min_distance_m
    for outcome in sorties:
        if outcome.least_distance_m is None or outcome.least_distance_time_s is None:
            yield Finding(Severity.WARNING, "distance-unknown", say("the distance kept is not known"), _place(outcome))
            continue
        short_m = limit - outcome.least_distance_m
        severity = Severity.ERROR if short_m > DISTANCE_TOLERANCE_M else Severity.WARNING
        subject = say("smallest distance flown, {:.1f} s after the start", outcome.least_distance_time_s)
        advice = say("see where, and keep further away")
        judged = subject, outcome.least_distance_m, limit, "m", _place(outcome), advice, severity
        yield judge(short_m <= RECORDED_M, "distance", *judged, least=True)


def _heights(case: Case, sorties: Sequence[SortieOutcome]) -> Iterator[Finding]:
    """The least height above the ground; where the terrain says nothing of it, that is said."""
    airspace = case.site_model.site.airspace
    limit = airspace.lowest_height_m(case.plan.constraints.min_height_above_ground_m)
    over = say("the terrain") if case.space.ground.terrain is not None else say("level ground")
    for outcome in sorties:
        if outcome.unknown_ground > 0.0:
            share = 100.0 * outcome.unknown_ground
            text = say(
                "below {:.0f} % of the way the terrain has no heights: how high it was there is not known", share
            )
            yield Finding(Severity.WARNING, "height-unknown", text, _place(outcome), share, 0.0, "%")
        if outcome.least_height_m is None or outcome.least_height_time_s is None:
            continue
        short_m = limit - outcome.least_height_m
        severity = Severity.ERROR if short_m > HEIGHT_TOLERANCE_M else Severity.WARNING
        subject = say("smallest height above {}, {:.1f} s after the start", over, outcome.least_height_time_s)
        advice = say("see where, and fly higher")
        judged = subject, outcome.least_height_m, limit, "m", _place(outcome), advice, severity
        yield judge(short_m <= RECORDED_M, "height", *judged, least=True)


RECORDED_M = 0.01
"""Records tell places no finer than that: plans go right up to a limit, and flights along it miss it by less."""

HEIGHT_TOLERANCE_M = 2.0
"""Barometers and GNSS wander by this much in height during a flight."""

DISTANCE_TOLERANCE_M = 0.5
"""Plans go right up to the minimum distance, and positions may be off by this much at views."""


def nearest_in_time_m(one: Track, other: Track, later_s: float) -> tuple[float, float] | None:
    """Smallest distance of two aircraft in the air at the same time, and when, in seconds of the first track.

    Both fly straight and evenly between their samples, so that the smallest distance between two times at which either
    has one has a closed form. Of samples at one time the last counts. None where they are never recorded at the same
    time.

    Parameters
    ----------
    later_s
        When the other's record starts, less when the first's does.
    """
    known, other_known = (_last_known(track) for track in (one, other))
    time_s, other_s = one.time_s[known], other.time_s[other_known] + later_s
    if len(time_s) == 0 or len(other_s) == 0:
        return None
    times_s = np.union1d(time_s, other_s)
    times_s = times_s[(times_s >= max(time_s[0], other_s[0])) & (times_s <= min(time_s[-1], other_s[-1]))]
    if len(times_s) == 0:
        return None
    between = np.stack(
        [
            np.interp(times_s, other_s, other.position_enu_m[other_known, axis])
            - np.interp(times_s, time_s, one.position_enu_m[known, axis])
            for axis in range(3)
        ],
        axis=1,
    )
    start, moved = between[:-1], np.diff(between, axis=0)
    squared = np.einsum("ij,ij->i", moved, moved)
    part = np.clip(-np.einsum("ij,ij->i", start, moved) / np.where(squared > 0.0, squared, 1.0), 0.0, 1.0)
    distances_m = np.linalg.norm(np.vstack([start + part[:, None] * moved, between[-1:]]), axis=1)
    at = int(np.argmin(distances_m))
    moments_s = np.append(times_s[:-1] + part * np.diff(times_s), times_s[-1])
    return float(distances_m[at]), float(moments_s[at])


def _last_known(track: Track) -> NDArray[np.int64]:
    """Samples that have a place, the last one of each time."""
    known = np.flatnonzero(np.isfinite(track.position_enu_m).all(axis=1))
    return known[np.diff(track.time_s[known], append=np.inf) > 0.0]


def _aircraft_apart(case: Case, records: Sequence[FlightRecord], sorties: Sequence[SortieOutcome]) -> Iterator[Finding]:
    """How far apart aircraft that fly at the same time were, each from the start that the plan gives it."""
    planned = {number: sortie for number, sortie in enumerate(case.plan.sorties, 1) if sortie.start_s is not None}
    flown = [
        (planned[outcome.sortie], outcome, record)
        for record, outcome in zip(records, sorties, strict=True)
        if outcome.sortie in planned
    ]
    found = []
    for (one, first, record), (other, second, beside) in itertools.combinations(flown, 2):
        assert one.start_s is not None
        assert other.start_s is not None
        if one.aircraft != other.aircraft:
            nearest = nearest_in_time_m(record.track, beside.track, other.start_s - one.start_s)
            if nearest is not None:
                place = say("sorties {} and {}", first.sortie, second.sortie)
                found.append((nearest[0], one.start_s + nearest[1], place))
    if found:
        value, at_s, place = min(found)
        subject = say("smallest distance between aircraft that start as planned, {:.0f} s after the first start", at_s)
        limit, advice = case.plan.rules.apart_m, say("plan them further apart, or one after the other")
        yield judge(value >= limit, "aircraft-apart", subject, value, limit, "m", place, advice, least=True)


def _durations(sorties: Sequence[SortieOutcome], limits: Limits) -> Iterator[Finding]:
    """Predicted durations, where a sortie was flown in full."""
    for outcome in sorties:
        predicted, flown = outcome.duration_predicted_s, outcome.duration_flown_s
        if not predicted or flown is None or outcome.n_taken < outcome.n_views:
            continue
        off = abs(flown / predicted - 1.0)
        subject = say("difference between the {:.0f} s flown and the {:.0f} s predicted", flown, predicted)
        advice = say("check the speeds and hover times of the aircraft's profile")
        judged = subject, 100.0 * off, 100.0 * limits.duration, "%", _place(outcome), advice, Severity.WARNING
        yield judge(off <= limits.duration, "duration", *judged)


def _batteries(case: Case, records: Sequence[FlightRecord], sorties: Sequence[SortieOutcome]) -> Iterator[Finding]:
    """The reserve at landing."""
    reserve = case.plan.rules.battery_reserve
    for record, outcome in zip(records, sorties, strict=True):
        known = record.track.battery[record.track.battery >= 0.0]
        if outcome.battery_used is None or len(known) == 0:
            continue
        left = float(known[-1])
        subject = say("battery left at the end, {:.0%} used", outcome.battery_used)
        if outcome.battery_predicted is not None:
            subject += say(" where {:.0%} was predicted", outcome.battery_predicted)
        advice = say("lower the endurance of the aircraft's profile")
        judged = subject, 100.0 * left, 100.0 * reserve, "%", _place(outcome), advice
        yield judge(left >= reserve, "battery", *judged, Severity.WARNING, least=True)
