"""A flight compared with its plan: every view, every sortie, the coverage, and what breaks a limit.

Coverage is counted again by the definition, for the poses at which photos were really taken. Distances are those to
panels, building and obstacles, exact along the whole track between its samples.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from missions.flight.matching import DEFAULT_GATES, Gates, Matching, PhotoRef, ViewMatch, match_flight, taken_poses
from missions.flight.outcome import Ending, FlightReport, Reason, SortieOutcome, Summary, ViewOutcome
from missions.flight.record import FlightEvent, FlightRecord, TakenPhoto, Track
from missions.flight.report_rules import DEFAULT_LIMITS, Limits, flight_findings, left_in_air_m
from planning.base.findings import Severity
from planning.base.json_file import plain_values
from planning.base.messages import Message, about, glue, joined, say
from planning.base.progress import QUIET, Monitor
from planning.checks.case import Case, pose_of
from planning.coverage.evaluate import Sight, section_counts, sights
from planning.geo.frames import Vec3, wrap_heading_deg
from planning.geo.solids import Solids
from planning.plan import Plan, Viewpoint
from planning.site.records import SiteModel

# The flight report for the command line: text for people, plain values for programs.


def report_to_json(report: FlightReport) -> dict[str, Any]:
    """The report as plain values: the summary's fields, then `views`, `sorties` and `findings`."""
    content: dict[str, Any] = plain_values(report)
    return {**content.pop("summary"), **content}


def report_text(report: FlightReport) -> Message:
    """The report in some lines: photos, coverage, errors at the shutter, distance, sorties, and what breaks a limit."""
    lines = [
        _photos_line(report.summary),
        _coverage_line(report.summary),
        *_shutter_lines(report),
        *(_sortie_line(outcome) for outcome in report.sorties),
        *(
            about(finding.severity.value, about(finding.place, finding.message))
            for finding in report.findings
            if finding.severity is not Severity.OK
        ),
    ]
    return joined("\n", lines)


def _photos_line(summary: Summary) -> Message:
    further = summary.n_photos - summary.n_taken
    text = say("photos: {} of {} views", summary.n_taken, summary.n_views)
    return text + say(", {} further", further) if further else text


def _coverage_line(summary: Summary) -> Message:
    share = f" ({summary.covered / summary.covered_planned:.1%})" if summary.covered_planned else ""
    text = say(
        "coverage: {} sections where {} were planned{}, {} in all",
        *(summary.covered, summary.covered_planned, share, summary.total),
    )
    return text + say("; {} panels lost", len(summary.lost_panels)) if summary.lost_panels else text


def _shutter_lines(report: FlightReport) -> Iterator[Message]:
    taken = [view for view in report.views if view.reason is Reason.TAKEN]
    parts = []
    for name, field, unit in (
        (say("position"), "position_error_m", "m"),
        (say("heading"), "heading_error_deg", "deg"),
        (say("pitch"), "gimbal_pitch_error_deg", "deg"),
        (say("speed"), "speed_m_s", "m/s"),
        (say("blur"), "blur_px", "px"),
    ):
        values = np.abs([value for view in taken if (value := getattr(view, field)) is not None])
        if len(values):
            parts.append(glue(name, f" {np.median(values):.2f} / {values.max():.2f} {unit}"))
    if parts:
        yield say("at the shutter (median / worst): {}", joined(", ", parts))


def _sortie_line(outcome: SortieOutcome) -> Message:
    record = outcome.record + 1
    name = say("sortie {}", outcome.sortie) if outcome.sortie else say("record {}, no sortie of the plan", record)
    parts = [say("{} of {} views", outcome.n_taken, outcome.n_views)]
    if outcome.duration_flown_s is not None:
        parts.append(say("{:.0f} s flown", outcome.duration_flown_s))
    if outcome.duration_predicted_s is not None:
        parts.append(say("{:.0f} s predicted", outcome.duration_predicted_s))
    if outcome.battery_used is not None:
        share = outcome.battery_predicted
        predicted = "" if share is None else say(" ({:.0%} predicted)", share)
        parts.append(say("{:.0%} of a battery{}", outcome.battery_used, predicted))
    if outcome.least_distance_m is not None:
        parts.append(say("{:.2f} m kept at least", outcome.least_distance_m))
    if outcome.least_height_m is not None:
        parts.append(say("down to {:.1f} m above the ground", outcome.least_height_m))
    return about(name, joined(", ", parts))


Floats = NDArray[np.float64]

GAP_S = 2.0
"""Where a track says nothing for longer, no straight line is drawn between its samples."""

TURN_WINDOW_S = 0.5
"""Rates of turn are differences over this time: shorter ones would be noise of the log's rounding."""


def report_flight(
    plan: Plan,
    site_model: SiteModel,
    records: Sequence[FlightRecord],
    limits: Limits = DEFAULT_LIMITS,
    gates: Gates = DEFAULT_GATES,
    monitor: Monitor = QUIET,
) -> FlightReport:
    """Compare a flight with its plan."""
    monitor.report(say("comparing the flight"), 0, 4)
    case = Case.of(plan, site_model)
    monitor.report(say("comparing the flight"), 1, 4)
    return report_case(case, records, limits, gates, monitor)


def report_case(
    case: Case,
    records: Sequence[FlightRecord],
    limits: Limits = DEFAULT_LIMITS,
    gates: Gates = DEFAULT_GATES,
    monitor: Monitor = QUIET,
) -> FlightReport:
    """Compare a flight with a plan that is measured already."""
    are_cut_off = [record.is_disarmed is False and left_in_air_m(case, record) is not None for record in records]
    matching = match_flight(case.plan, records, gates, are_cut_off)
    shots = _shots(case, records, matching)
    monitor.report(say("comparing the flight"), 2, 4)
    by_id = {view.id: view for view in case.plan.viewpoints}
    views = tuple(_view_outcome(case, by_id[m.view_id], m, records, shots, limits) for m in matching.views)
    monitor.report(say("comparing the flight"), 3, 4)
    sorties = tuple(_sortie_outcome(case, matching, index, record) for index, record in enumerate(records))
    summary = _summary(case, matching, records, sorties, shots)
    findings = flight_findings(case, records, summary, views, sorties, limits)
    return FlightReport(summary, views, sorties, findings)


@dataclass(frozen=True, slots=True)
class _Shot:
    """What a photo shows, and how far from everything it was taken."""

    sight: Sight
    distance_m: float


def _shots(case: Case, records: Sequence[FlightRecord], matching: Matching) -> dict[PhotoRef, _Shot]:
    """What every photo shows whose direction is known."""
    poses = taken_poses(case.plan, records, matching)
    if not poses:
        return {}
    seen = sights(case.model, tuple(poses.values()))
    distances = case.space.solids.clearance_m(np.array([pose.position_enu_m for pose in poses.values()]))
    return {ref: _Shot(sight, float(m)) for ref, sight, m in zip(poses, seen, distances, strict=True)}


def _view_outcome(
    case: Case,
    view: Viewpoint,
    match: ViewMatch,
    records: Sequence[FlightRecord],
    shots: Mapping[PhotoRef, _Shot],
    limits: Limits,
) -> ViewOutcome:
    n_planned = len(case.measures.seen[pose_of(view)].elements)
    about = match.photo or match.nearest
    if about is None:
        return ViewOutcome(match.view_id, match.sortie, match.reason, n_planned=n_planned)
    record = records[about.record]
    photo, shot = record.photos[about.photo], shots.get(about)
    speed_m_s = photo.speed_m_s if photo.speed_m_s is not None else _speed_m_s(record.track, photo.time_s)
    return ViewOutcome(
        view_id=match.view_id,
        sortie=match.sortie,
        reason=match.reason,
        record=about.record,
        photo=about.photo,
        n_planned=n_planned,
        n_flown=len(shot.sight.elements) if shot is not None and match.photo is not None else 0,
        position_error_m=math.dist(photo.position_enu_m, view.position_enu_m),
        heading_error_deg=_turned_deg(photo.heading_deg, view.heading_deg),
        gimbal_pitch_error_deg=_turned_deg(photo.gimbal_pitch_deg, view.gimbal_pitch_deg),
        speed_m_s=speed_m_s,
        blur_px=None if shot is None else _blur_px(case, record.track, photo, speed_m_s, shot, limits),
        distance_m=None if shot is None else shot.distance_m,
    )


def _turned_deg(flown_deg: float | None, planned_deg: float) -> float | None:
    return None if flown_deg is None else wrap_heading_deg(flown_deg - planned_deg)


def _speed_m_s(track: Track, time_s: float) -> float | None:
    speeds = np.linalg.norm(track.velocity_enu_m_s, axis=1)
    known = np.isfinite(speeds)
    return float(np.interp(time_s, track.time_s[known], speeds[known])) if known.any() else None


def _blur_px(
    case: Case, track: Track, photo: TakenPhoto, speed_m_s: float | None, shot: _Shot, limits: Limits
) -> float | None:
    """Smear during the exposure, in pixels: v t / GSD + w t / (angle of a pixel).

    An upper bound: all of the speed is taken as across the line of sight, at the distance of the nearest panel in the
    picture (of the nearest thing where there is none). The limits' exposure counts where the photo's is not known.
    """
    if speed_m_s is None:
        return None
    camera = case.plan.camera
    distance_m = max(shot.sight.nearest_m if math.isfinite(shot.sight.nearest_m) else abs(shot.distance_m), 0.1)
    turn_rad_s = math.hypot(
        _rate(track.time_s, track.gimbal_heading_rad, photo.time_s),
        _rate(track.time_s, track.gimbal_pitch_rad, photo.time_s),
    )
    exposure_s = limits.exposure_s if photo.exposure_s is None else photo.exposure_s
    return exposure_s * (speed_m_s / camera.gsd_m(distance_m) + turn_rad_s / camera.pixel_angle_rad)


def _rate(time_s: Floats, angle_rad: Floats, when_s: float) -> float:
    """How fast an angle changes around a time, rad/s; 0 where it is not known."""
    known = np.isfinite(angle_rad)
    if not known.any():
        return 0.0
    ends = np.array([when_s - TURN_WINDOW_S / 2.0, when_s + TURN_WINDOW_S / 2.0])
    before, after = np.interp(ends, time_s[known], np.unwrap(angle_rad[known]))
    return abs(float(after - before)) / TURN_WINDOW_S


def _sortie_outcome(case: Case, matching: Matching, index: int, record: FlightRecord) -> SortieOutcome:
    number = matching.sortie_of_record[index]
    of_sortie = [match for match in matching.views if match.sortie == number]
    least, low = closest(case.space.solids, record.track), lowest(case, record.track)
    motors_s = case.plan.sorties[number - 1].duration_s if number else None
    return SortieOutcome(
        record=index,
        sortie=number,
        n_views=len(of_sortie),
        n_taken=sum(match.photo is not None and match.photo.record == index for match in of_sortie),
        n_extra=sum(photo.record == index for photo in matching.extra),
        duration_predicted_s=None if motors_s is None else max(0.0, motors_s - case.plan.rules.takeoff_landing_s),
        duration_flown_s=record.duration_s,
        battery_predicted=None if motors_s is None else motors_s / case.plan.aircraft.endurance_s,
        battery_used=_battery_used(record.track),
        least_distance_m=None if least is None else least.distance_m,
        least_distance_time_s=None if least is None else least.time_s,
        least_distance_enu_m=None if least is None else least.position_enu_m,
        ending=_ending(case, record),
        least_height_m=None if low is None else low.height_m,
        least_height_time_s=None if low is None else low.time_s,
        unknown_ground=0.0 if low is None else low.unknown,
    )


MISSION_MODES = frozenset(("AUTO", "MISSION"))
RETURN_MODES = frozenset(("RTL", "SMART_RTL", "AUTO_RTL"))
LAND_MODES = frozenset(("LAND", "PRECISION_LAND", "DESCEND"))
HAND_MODES = frozenset(
    ("STABILIZE", "STABILIZED", "ALT_HOLD", "ALTCTL", "POSHOLD", "POSCTL", "LOITER", "MANUAL", "ACRO", "SPORT", "DRIFT")
)
"""As autopilots' logs call them. PX4's LOITER is a pause, but does not stand at the end of a flight that landed."""

CAUSES = (
    (Ending.BATTERY, re.compile(r"(?i)batter(y|ies)\b.*(failsafe|low|critical|emergency|dangerous)|low\sbattery")),
    (Ending.REMOTE, re.compile(r"(?i)(radio|rc)\sfailsafe|(manual\scontrol|\brc\b).*(lost|loss)")),
    (
        Ending.LINK,
        re.compile(r"(?i)gcs\sfailsafe(?!.*(cleared|continuing))|(ground\sstation|data\s?link|gcs).*los[st]"),
    ),
    (Ending.FENCE, re.compile(r"(?i)fence.*breach|geofence")),
)
"""What autopilots say when they change the mode by themselves: ArduPilot's and PX4's texts."""

CAUSE_BEFORE_S, CAUSE_AFTER_S = 4.0, 2.0
"""Around a change of mode: heartbeats tell of it once a second, and texts come before or after."""


def _ending(case: Case, record: FlightRecord) -> Ending:
    """How a record left its mission: by the first mode after it that returns or lands, else by one of the pilot's."""
    if record.is_disarmed and left_in_air_m(case, record) is not None:
        return Ending.MOTORS
    modes = [event for event in sorted(record.events, key=lambda event: event.time_s) if event.code == "mode"]
    last = max((n for n, event in enumerate(modes) if event.text in MISSION_MODES), default=len(modes))
    after = modes[last + 1 :]
    away = next((event for event in after if event.text in RETURN_MODES | LAND_MODES), None)
    if away is not None:
        by_itself = _cause(record, away)
        return by_itself or (Ending.RETURN if away.text in RETURN_MODES else Ending.LAND)
    return Ending.HAND if any(event.text in HAND_MODES for event in after) else Ending.UNKNOWN


def _cause(record: FlightRecord, change: FlightEvent) -> Ending | None:
    """Why an autopilot changed the mode by itself; None where the pilot ordered it or nothing was said."""
    from_s, to_s = change.time_s - CAUSE_BEFORE_S, change.time_s + CAUSE_AFTER_S
    near = [event for event in record.events if from_s <= event.time_s <= to_s]
    if any(event.code == "order" for event in near):
        return None
    texts = [event.text for event in near if event.code == "text"]
    if any(MISSION_DONE.search(text) for text in texts):
        return Ending.UNKNOWN
    return next((cause for cause, pattern in CAUSES if any(pattern.search(text) for text in texts)), None)


MISSION_DONE = re.compile(r"(?i)mission\s(finished|complete)")
"""Said where the way home is the mission's own."""


def _battery_used(track: Track) -> float | None:
    known = track.battery[np.isfinite(track.battery)]
    return float(known[0] - known[-1]) if len(known) > 1 else None


class Closest(NamedTuple):
    """Where a track comes closest to solids: distance (negative inside), time and place of the sample before."""

    distance_m: float
    time_s: float
    position_enu_m: Vec3


def closest(solids: Solids, track: Track) -> Closest | None:
    """Where a track comes closest to solids; None without any position.

    Between samples the aircraft is taken to fly straight, but not over gaps.
    """
    known = np.isfinite(track.position_enu_m).all(axis=1)
    points, time_s = track.position_enu_m[known], track.time_s[known]
    if len(points) == 0 or len(solids.part) == 0:
        return None
    at_points = solids.clearance_m(points)
    sample = int(np.argmin(at_points))
    distance_m = float(at_points[sample])
    length_m = np.linalg.norm(np.diff(points, axis=0), axis=1)
    # A leg comes no closer than its ends less the way that it has for coming closer; most cannot be the nearest.
    at_least = (at_points[:-1] + at_points[1:] - length_m) / 2.0
    legs = np.flatnonzero((np.diff(time_s) <= GAP_S) & (at_least < distance_m))
    if len(legs) and distance_m > 0.0:
        along = solids.segment_distances_m(points[legs], points[legs + 1], distance_m)
        leg = int(np.argmin(along))
        if along[leg] < distance_m:
            distance_m, sample = float(along[leg]), int(legs[leg])
    east, north, up = points[sample].tolist()
    return Closest(distance_m, float(time_s[sample]), (east, north, up))


BESIDE_M = 5.0
"""Around home, rally points, and where a track begins and ends, within which an aircraft climbs and lands."""


class Lowest(NamedTuple):
    """Where a track is lowest above the ground, and when; None where none below it is known.

    `unknown` is the share of its way, 0 to 1, below which the ground is not known.
    """

    height_m: float | None
    time_s: float | None
    unknown: float


def lowest(case: Case, track: Track) -> Lowest | None:
    """How low a track flies beside the places of take-off and landing; None where it does not leave them.

    Between samples the aircraft is taken to fly straight, but not over gaps. Heights are those of whole legs above the
    upper bound of the terrain where flights are held to one, else above the level ground.
    """
    known = np.isfinite(track.position_enu_m).all(axis=1)
    points, time_s = track.position_enu_m[known], track.time_s[known]
    if len(points) < 2:
        return None
    site = case.site_model.site
    landings = np.array([points[0], points[-1], site.home_enu_m, *(each.position_enu_m for each in site.rally_points)])
    away_m = np.linalg.norm(points[:, None, :2] - landings[None, :, :2], axis=2).min(axis=1)
    legs = np.flatnonzero((np.diff(time_s) <= GAP_S) & (away_m[:-1] > BESIDE_M) & (away_m[1:] > BESIDE_M))
    if not len(legs):
        return None
    heights = case.space.ground.least_m(points[legs], points[legs + 1])
    length_m = np.linalg.norm(points[legs + 1, :2] - points[legs, :2], axis=1)
    is_known = np.isfinite(heights)
    unknown = float(length_m[~is_known].sum() / length_m.sum()) if length_m.sum() > 0.0 else float((~is_known).mean())
    if not is_known.any():
        return Lowest(None, None, 1.0)
    at = int(np.argmin(np.where(is_known, heights, np.inf)))
    return Lowest(float(heights[at]), float(time_s[legs[at]]), unknown)


def _summary(
    case: Case,
    matching: Matching,
    records: Sequence[FlightRecord],
    sorties: Sequence[SortieOutcome],
    shots: dict[PhotoRef, _Shot],
) -> Summary:
    planned = case.measures.counts > 0
    flown = section_counts(case.model, [shot.sight for shot in shots.values()]) > 0
    is_lost = np.asarray(planned.any(axis=1)) & ~np.asarray(flown.any(axis=1))
    flights = [outcome for outcome in sorties if outcome.sortie]
    durations = [(outcome.duration_predicted_s, outcome.duration_flown_s) for outcome in flights]
    distances = [outcome.least_distance_m for outcome in sorties if outcome.least_distance_m is not None]
    heights = [outcome.least_height_m for outcome in sorties if outcome.least_height_m is not None]
    flown_s = [flown_s for _, flown_s in durations if flown_s is not None]
    by_sortie = {outcome.sortie: outcome.duration_predicted_s or 0.0 for outcome in flights}
    return Summary(
        n_views=len(matching.views),
        n_taken=sum(match.photo is not None for match in matching.views),
        n_photos=sum(len(record.photos) for record in records),
        covered_planned=int(planned.sum()),
        covered=int(flown.sum()),
        total=int(planned.size),
        lost_panels=tuple(p.id for p, lost in zip(case.site_model.site.panels, is_lost, strict=True) if lost),
        duration_predicted_s=sum(by_sortie.values()) if flights else None,
        duration_flown_s=sum(flown_s) if flights and len(flown_s) == len(flights) else None,
        least_distance_m=min(distances, default=None),
        least_height_m=min(heights, default=None),
    )
