"""Use cases after a flight: close what it left open by a top-up, or fly the rest of a sortie that was interrupted."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from groundstation.services.plan.planning import finding_summary
from groundstation.services.project.input_files import read_input_plan, read_input_site
from groundstation.services.project.project_file import check_not_index
from missions.flight.flight_file import Flight, flight_of, is_of_plan, read_flight
from missions.flight.logs.read import is_log, read_log
from missions.flight.matching import Matching, match_flight, taken_poses
from missions.flight.outcome import Reason
from missions.mission.resume import Resumed, resume_sortie
from planning.base.errors import InfeasibleError, InputError
from planning.base.findings import Finding, Severity
from planning.base.json_file import check_output
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, Trace, never
from planning.plan import Plan, Viewpoint, viewpoint_arrays, write_plan
from planning.revision.top_up import TopUp, TopUpRequest, WhyMissing, top_up
from planning.site.records import SiteModel
from planning.viewpoints.prepare import Prepared

WHY_TEXTS = {
    WhyMissing.UNREACHABLE: say("cannot be seen from any allowed place that was found on the site as it is now"),
    WhyMissing.BATTERY: say("can be seen, but the batteries allowed do not last for them; change the battery"),
    WhyMissing.SPACING: say("can only be seen from places closer together than aircraft accept"),
}


@dataclass(frozen=True, slots=True)
class FlownPlan:
    """A plan on its site with what was flown of it.

    Parameters
    ----------
    matching
        Which view has a photo.
    poses
        Of the photos, as they were taken.
    findings
        What the pilot should know about the flight before it goes on.
    """

    plan: Plan
    site_model: SiteModel
    matching: Matching
    poses: tuple[Viewpoint, ...]
    findings: tuple[Finding, ...]

    @property
    def photographed(self) -> frozenset[str]:
        """Views that have a photo."""
        return frozenset(match.view_id for match in self.matching.views if match.reason is Reason.TAKEN)

    def unfinished_sorties(self) -> tuple[int, ...]:
        """Sorties that were begun and have views without a photo, from 1, the one that was flown last in front."""
        photographed, plan = self.photographed, self.plan
        flown = dict.fromkeys(number for number in reversed(self.matching.sortie_of_record) if number > 0)
        return tuple(number for number in flown if not photographed.issuperset(plan.sorties[number - 1].viewpoint_ids))


def flown_plan(flight: Flight, plan: Plan, site_model: SiteModel) -> FlownPlan:
    """Tie the photos of a flight to the views of the plan that was flown.

    Raises
    ------
    InputError
        The flight belongs to another plan or another place.
    """
    site = site_model.site
    origins = (flight.origin, plan.origin or site.origin, site.origin)
    if len({flight.site, plan.site, site.name}) > 1 or len(set(origins)) > 1:
        raise InputError(
            say(
                "flight ('{}'), plan ('{}') and site ('{}') do not have the same name and origin; name the plan "
                "and the site file that this flight was flown with",
                flight.site,
                plan.site,
                site.name,
            )
        )
    matching = match_flight(plan, flight.sorties)
    n_photos = sum(len(record.photos) for record in flight.sorties)
    is_other = bool(flight.plan_sha256) and not is_of_plan(flight, plan)
    if is_other or (n_photos and not any(match.photo is not None for match in matching.views)):
        found = (
            say("its plan has another checksum")
            if is_other
            else say("none of its {} photos was taken near a view of it", n_photos)
        )
        raise InputError(
            say(
                "this is a flight of another plan: {}; name the plan file that it was flown with, as it was then", found
            )
        )
    poses = taken_poses(plan, flight.sorties, matching)
    findings = _flight_findings(plan, site_model, matching, n_photos - len(poses))
    return FlownPlan(plan, site_model, matching, tuple(poses.values()), tuple(findings))


def _flight_findings(
    plan: Plan, site_model: SiteModel, matching: Matching, n_without_direction: int
) -> Iterator[Finding]:
    if plan.site_sha256 and plan.site_sha256 != site_model.sha256:
        text = say(
            "the site file has changed since the plan was made; what is missing is planned on the site as it is now"
        )
        yield Finding(Severity.WARNING, "site-changed", text)
    n_lost = sum(match.reason is Reason.REPORT_LOST for match in matching.views)
    if n_lost:
        text = say(
            "{} views were photographed, but the camera's reports were lost on the radio; what they show "
            "counts as missing. The autopilot's log (.BIN, .ulg) tells of them: name it instead of the "
            "flight file",
            n_lost,
        )
        yield Finding(Severity.WARNING, "reports-lost", text, "", float(n_lost), 0.0, "views")
    if n_without_direction:
        text = say(
            "{} photos belong to no view, and nothing says where they look; what they show counts as missing",
            n_without_direction,
        )
        yield Finding(Severity.WARNING, "photo-direction", text, "", float(n_without_direction), 0.0, "photos")


def top_up_flight(
    flown: FlownPlan,
    request: TopUpRequest,
    prepared: Prepared | None = None,
    *,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> tuple[TopUp, tuple[Finding, ...]]:
    """The shortest flight that closes what the photos left open, and what the pilot should know about it.

    Raises
    ------
    InfeasibleError
        As `planning.revision.top_up.top_up`.
    """
    found = top_up(
        flown.site_model,
        flown.plan,
        viewpoint_arrays(flown.poses),
        request,
        prepared=prepared,
        stop=stop,
        trace=trace,
        monitor=monitor,
    )
    return found, (*flown.findings, *_missing_findings(found))


def _missing_findings(found: TopUp) -> Iterator[Finding]:
    if found.is_negligible:
        text = say(
            "{} of {} sections are missing, too few for a flight unasked; {}", found.wanted, found.aimed, _cost(found)
        )
        yield Finding(Severity.NOTE, "negligible-rest", text, "", float(found.wanted), float(found.aimed), "sections")
    panels = {why: {s.panel_id for s in found.missing if s.why is why} for why in WhyMissing}
    for why, n in sorted(Counter(section.why for section in found.missing).items()):
        text = say("{} of the {} missing sections (on {} panels) {}", n, found.wanted, len(panels[why]), WHY_TEXTS[why])
        yield Finding(Severity.WARNING, f"left-open-{why}", text, "", float(n), 0.0, "sections")


def _cost(found: TopUp) -> str:
    """What closing the rest would take."""
    plan = found.plan
    if plan is None:
        return say("none of them can be shown")
    return say(
        "showing {} of them takes {:.1f} min in the air (views: {}, batteries: {})",
        found.closed,
        plan.duration_s / 60.0,
        len(plan.viewpoints),
        len(plan.sorties),
    )


def resume_flight(
    flown: FlownPlan,
    number: int | None = None,
    battery: float | None = None,
    prepared: Prepared | None = None,
    monitor: Monitor = QUIET,
) -> Resumed:
    """The rest of a sortie that was interrupted.

    Parameters
    ----------
    number
        Of the sortie, from 1; None: the one that was flown last and is not complete.
    battery
        Charge of the battery that is to fly it, 0 to 1; None: a full one.

    Raises
    ------
    InputError
        There is no such sortie, or none was interrupted.
    InfeasibleError
        The battery does not last, or home cannot be used any more.
    MissionError
        As `missions.mission.resume.resume_sortie`.
    """
    plan = flown.plan
    if number is None:
        unfinished = flown.unfinished_sorties()
        if not unfinished:
            raise InputError(
                say(
                    "no sortie of this plan was interrupted: those that were flown are complete; the next one is "
                    "flown from the plan itself"
                )
            )
        number = unfinished[0]
    elif not 1 <= number <= len(plan.sorties):
        raise InputError(say("sortie: expected 1 to {}, got {}", len(plan.sorties), number))
    rest = resume_sortie(plan, flown.site_model, number, flown.photographed, prepared=prepared, monitor=monitor)
    duration_s = rest.plan.sorties[0].duration_s
    charge = 1.0 if battery is None else battery
    usable_s = plan.aircraft.endurance_s * (charge - plan.rules.battery_reserve)
    if duration_s > usable_s:
        raise InfeasibleError(
            say(
                "the rest of sortie {} takes {:.0f} s, but a battery at {:.0%} allows {:.0f} s above the "
                "reserve; change the battery, or plan a top-up, which fits it",
                number,
                duration_s,
                charge,
                max(0.0, usable_s),
            )
        )
    return rest


def top_up_files(
    flight_path: Path,
    plan_path: Path,
    site_path: Path,
    out: Path,
    request: TopUpRequest,
    *,
    everything: bool = False,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> tuple[TopUp, tuple[Finding, ...]]:
    """`top_up_flight` on files; the plan is written where `out` says, nothing where nothing is missing.

    A plan for a negligible rest is written only where `everything` is wanted.

    Raises
    ------
    InputError, InfeasibleError
        A file cannot be read or written, the flight is of another plan, or nothing can be closed.
    """
    flown = _flown_files(flight_path, plan_path, site_path, out)
    found, findings = top_up_flight(flown, request, stop=stop, trace=trace, monitor=monitor)
    if found.plan is not None and (everything or not found.is_negligible):
        write_plan(out, found.plan)
    return found, findings


def resume_files(
    flight_path: Path,
    plan_path: Path,
    site_path: Path,
    out: Path,
    number: int | None = None,
    battery: float | None = None,
    monitor: Monitor = QUIET,
) -> tuple[Resumed, tuple[Finding, ...]]:
    """`resume_flight` on files; the rest is written as a plan where `out` says.

    Raises
    ------
    InputError, InfeasibleError, MissionError
        A file cannot be read or written, the flight is of another plan, or as `resume_flight`.
    """
    flown = _flown_files(flight_path, plan_path, site_path, out)
    rest = resume_flight(flown, number, battery, monitor=monitor)
    write_plan(out, rest.plan)
    warnings = (finding for finding in rest.findings if finding.severity is Severity.WARNING)
    return rest, (*flown.findings, *warnings)


def _flown_files(flight_path: Path, plan_path: Path, site_path: Path, out: Path) -> FlownPlan:
    check_not_index(out)
    check_output(out, [flight_path, plan_path, site_path])
    plan, site_model = read_input_plan(plan_path), read_input_site(site_path)
    if is_log(flight_path):
        log = read_log(flight_path, site_model.site)
        # A log does not say which plan was flown: whether its photos are near the views decides.
        flight = replace(flight_of(plan, site_model, log.records), plan_sha256="")
        flown = flown_plan(flight, plan, site_model)
        return replace(flown, findings=(*log.findings, *flown.findings))
    return flown_plan(read_flight(flight_path), plan, site_model)


def top_up_summary(found: TopUp, findings: tuple[Finding, ...]) -> dict[str, Any]:
    """What `topup --json` prints."""
    why = Counter(section.why for section in found.missing)
    plan = found.plan
    return {
        "views": 0 if plan is None else len(plan.viewpoints),
        "sorties": 0 if plan is None else len(plan.sorties),
        "duration_s": 0.0 if plan is None else round(plan.duration_s, 1),
        "shortest_s": None if found.shortest_s is None else round(found.shortest_s, 1),
        "uses_battery_on_board": found.on_board,
        "promised": found.promised,
        "delivered": found.delivered,
        "wanted": found.wanted,
        "closed": found.closed,
        "bound": found.bound,
        "negligible": found.is_negligible,
        "left_open": {reason.value: why[reason] for reason in WhyMissing},
        "panels_left_open": sorted({section.panel_id for section in found.missing}),
        "covered_before": found.seen,
        "covered_together": found.together,
        "findings": [finding_summary(finding) for finding in findings],
        "seconds": round(found.seconds, 3),
        "durations": [{"t_s": round(p.t_s, 3), "duration_s": round(p.value, 1)} for p in found.durations],
    }


def resumed_summary(rest: Resumed, findings: tuple[Finding, ...]) -> dict[str, Any]:
    """What `topup --resume --json` prints."""
    sortie = rest.plan.sorties[0]
    return {
        "sortie": rest.mission.number,
        "views": len(sortie.viewpoint_ids),
        "first_view": sortie.viewpoint_ids[0],
        "length_m": sortie.length_m,
        "duration_s": round(sortie.duration_s, 1),
        "findings": [finding_summary(finding) for finding in findings],
    }
