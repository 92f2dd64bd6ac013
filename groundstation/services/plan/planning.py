"""Use cases around plans: plan a flight over a site and write it, check a plan against its site."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Any

from groundstation.services.mission.proof import no_proof, proof_of_files, refused_unless_proved, write_plan_proof
from groundstation.services.mission.readiness import UNKNOWN_DAY, FlightDay, preflight
from groundstation.services.project.input_files import read_input_plan, read_input_site
from groundstation.services.project.project_file import check_not_index
from groundstation.services.units import per_cent
from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.base.jit import is_compiled
from planning.base.json_file import check_output, is_device, plain_values
from planning.base.messages import glue, say
from planning.base.progress import COMPILING, QUIET, Monitor, Stop, Trace, never
from planning.checks.rules import low_flight_allowed, sharpness
from planning.checks.zones import source_text
from planning.insight.flight_profile import lowest_flight
from planning.parameters import GreedyParameters
from planning.plan import Plan, Viewpoint, write_plan
from planning.planner import MOST_BATTERIES, OpenReason, Planned, plan_flight
from planning.proof.make import proof_path
from planning.proof.separation import separate
from planning.request import PlanRequest
from planning.routing.tour import kick
from planning.site.bundled import SCENES
from planning.site.ground import ground_of
from planning.site.records import MIN_HEIGHT_ABOVE_GROUND_M, SiteModel
from planning.site.zones.keep_out import at_time, known_files, near_zones
from planning.site.zones.times import State
from planning.viewpoints.prepare import Prepared

PLANNED_WITHIN_S = 7200.0
"""Time after take-off that a flight may take: how long it will take is not known before it is planned."""


def plan_site(
    site_path: Path,
    request: PlanRequest,
    out: Path | None,
    *,
    at: datetime | None = None,
    started_s: float | None = None,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> Planned:
    """Plan a flight over the site in a file, and write the plan where `out` says, with its proof beside it.

    A finding says so where the plan has less than was asked for. `started_s` is as in `planning.planner.plan_flight`.

    Parameters
    ----------
    at
        Take-off: geo-zones that do not apply in the two hours after it do not count. None: all count.

    Raises
    ------
    InputError, InfeasibleError
        As `planning.planner.plan_flight`, or the plan cannot be written where it should go; nothing is written then.
    """
    if out is not None:
        check_not_index(out)
        check_output(out, [site_path])
    site_model = at_time(read_input_site(site_path), at, PLANNED_WITHIN_S)
    planned = plan_document_site(site_model, request, started_s=started_s, stop=stop, trace=trace, monitor=monitor)
    if out is not None:
        write_plan(out, planned.plan)
        if not is_device(out):
            write_plan_proof(out, site_path, site_model, planned.prepared.problem.reachability, monitor)
    return planned


def plan_document_site(
    site_model: SiteModel,
    request: PlanRequest,
    prepared: Prepared | None = None,
    *,
    started_s: float | None = None,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> Planned:
    """Plan a flight over an open site; a finding says so where the plan has less than was asked for.

    Parameters
    ----------
    prepared
        What an earlier plan left; used where it serves the request and was not cut short.

    Raises
    ------
    InputError, InfeasibleError
        As `planning.planner.plan_flight`.
    """
    if prepared is not None and prepared.is_cut_short:
        prepared = None
    compiled_s = compile_once(monitor)
    if started_s is not None:
        started_s += compiled_s
    planned = plan_flight(
        site_model, request, prepared=prepared, started_s=started_s, stop=stop, trace=trace, monitor=monitor
    )
    findings = [*planned.findings, *_shortfalls(request, planned), *_zones(site_model)]
    if compiled_s > 0.0:
        text = say("compiled for this computer in {:.0f} s, once; the time budget began behind it", compiled_s)
        findings.append(Finding(Severity.NOTE, "compiled", text, "", compiled_s, None, "s"))
    return replace(planned, findings=tuple(findings))


def compile_once(monitor: Monitor) -> float:
    """Compile the kernels of planning where this computer has none yet; returns how long that took, s.

    `make setup` does it for who works on the sources. Who installs the program has it done with the first plan: it
    takes longer than many a time budget.
    """
    if is_compiled(kick) and is_compiled(separate):
        return 0.0
    from planning.warm_up import compile_kernels

    monitor.report(COMPILING, 0, 1)
    started_s = time.perf_counter()
    compile_kernels()
    return time.perf_counter() - started_s


def load_planning() -> None:
    """Load the modules and the compiled kernels that most plans need, by planning a very small one."""
    compile_once(QUIET)
    few = GreedyParameters(n_candidates=200)
    plan_flight(SCENES["roof"](), PlanRequest(n_views=3, greedy=few, time_budget_s=2.0))


def with_local_site(planned: Planned, site_model: SiteModel, prepared: Prepared | None) -> Planned:
    """What another process planned, with the site and the preparation of this one in place of their copies.

    The window tells sites and preparations apart by being one object, which spares it comparing them.
    """
    if prepared is None or prepared.is_cut_short:
        prepared = replace(planned.prepared, site_model=site_model)
    return replace(planned, prepared=prepared)


def locked_viewpoints(plan_path: Path) -> tuple[Viewpoint, ...]:
    """The locked viewpoints of a plan file.

    Raises
    ------
    InputError
        The file cannot be read, or none of its viewpoints is locked.
    """
    locked = tuple(viewpoint for viewpoint in read_input_plan(plan_path).viewpoints if viewpoint.locked)
    if not locked:
        raise InputError(
            say(
                'none of the viewpoints is locked; expected some with "locked": true, which the Plan tab\'s lock sets',
                place=plan_path,
            )
        )
    return locked


def _shortfalls(request: PlanRequest, planned: Planned) -> Iterator[Finding]:
    plan = planned.plan
    lowest_m = plan.constraints.min_height_above_ground_m
    if lowest_m is not None and lowest_m < MIN_HEIGHT_ABOVE_GROUND_M:
        yield low_flight_allowed(lowest_m)
    yield from _too_coarse(plan)
    if planned.n_left_out:
        n_left_out = planned.n_left_out
        text = say(
            "{} views were left out, since the time did not last for ways to them; allow it more time", n_left_out
        )
        yield Finding(Severity.WARNING, "time-budget", text, "", float(n_left_out), 0.0, "views")
    if planned.n_too_many:
        text = say("{} views were left out, since their sorties took more batteries than there are", planned.n_too_many)
        yield Finding(Severity.NOTE, "too-many-views", text, "", float(planned.n_too_many), 0.0, "views")
    n_views = len(plan.viewpoints)
    is_late = planned.is_cut_short or planned.n_left_out > 0
    if planned.is_cut_short:
        text = say("the time did not last to compare as many viewpoints as usual; allow it more time")
        yield Finding(Severity.NOTE, "few-compared", text)
    no_more = say("more views would show nothing new or could not be flown")
    reason = say("the time did not last for more; allow it more time") if is_late else no_more
    severity = Severity.WARNING if is_late else Severity.NOTE
    if request.n_views is not None and n_views < request.n_views and not planned.n_left_out:
        text = say("{} views instead of the {} asked for: {}", n_views, request.n_views, reason)
        yield Finding(severity, "fewer-views", text, "", float(n_views), float(request.n_views), "views")
    n_sorties, n_batteries = len(plan.sorties), request.n_batteries
    if n_batteries is not None and n_sorties < n_batteries:
        if planned.are_all_taken and not is_late:
            reason = say("no more viewpoints are compared for so many; ask for a number of views to fly more")
        text = say("takes {} of {} batteries: {}", n_sorties, n_batteries, reason)
        yield Finding(severity, "fewer-sorties", text, "", float(n_sorties), float(n_batteries), "sorties")
    yield from _not_good_enough(request, planned, is_late)
    wanted = request.wanted_share
    if wanted is None:
        return
    share = plan.coverage.covered / max(plan.coverage.reachable_upper_bound, 1)
    if share < wanted:
        found = per_cent(plan.coverage.covered, plan.coverage.reachable_upper_bound, 2)
        text = say("covers {:.2f} % of what is possible at most, {:g} % were asked for", found, 100.0 * wanted)
        if request.method != "greedy":
            advice = say("the method flies a pattern of its own")
            text = glue(text, "; ", advice)
        yield Finding(Severity.WARNING, "less-coverage", text, "", share, wanted)
        if request.method == "greedy":
            yield from why_open(planned)


def _not_good_enough(request: PlanRequest, planned: Planned, is_late: bool) -> Iterator[Finding]:
    """Where a plan that was to stop at a gain could gain more: batteries are decided on before their routes are."""
    worth, least_db = planned.plan.worth, request.least_gain_db
    if worth is None or least_db is None or round(worth.gain_db, 1) <= round(least_db, 1):
        return
    n_batteries = len(worth.batteries)
    if is_late:
        reason = say("the time did not last for more; allow it more time")
    elif n_batteries >= MOST_BATTERIES:
        reason = say("no more batteries than {} are taken without being asked for", MOST_BATTERIES)
    else:
        reason = say("fewer photos fit into a battery than expected; ask for {} batteries", n_batteries + 1)
    text = say(
        "another battery would bring {:.1f} dB, more than the {:g} to stop at: {}", worth.gain_db, least_db, reason
    )
    yield Finding(Severity.WARNING, "not-good-enough", text, "", worth.gain_db, least_db, "dB")


def _zones(site_model: SiteModel) -> Iterator[Finding]:
    """What planning does not know about geo-zones."""
    for known in known_files(site_model):
        if known.content is None:
            text = say("no zone of {} was kept out of: {}", source_text(known), known.problem)
            yield Finding(Severity.WARNING, "zones-file", text, known.source.file)
    scheduled = [
        near.local.zone.id for near in near_zones(site_model) if near.state is State.UNDECIDED and near.is_kept
    ]
    if scheduled and site_model.zones_at is None:
        text = say(
            "{} geo-zones that apply at some times only count as if they always did (the first is '{}'): no time "
            "is planned (--at)",
            len(scheduled),
            scheduled[0],
        )
        yield Finding(Severity.NOTE, "zones-time", text, scheduled[0])


def _too_coarse(plan: Plan) -> Iterator[Finding]:
    found, wanted_mm = plan.coverage, plan.constraints.wanted_gsd_mm
    if found.sharp is not None and found.coarsest_gsd_mm is not None and wanted_mm and found.sharp < found.covered:
        yield sharpness(found.covered - found.sharp, found.covered, found.coarsest_gsd_mm, wanted_mm)


def why_open(planned: Planned) -> Iterator[Finding]:
    """Which sections stay open, by what keeps them from being covered."""
    plan, panels = planned.plan, planned.prepared.site_model.site.panels
    time_helps = say("allow it more time") if planned.prepared.is_cut_short else say("more time does not help")
    texts = {
        OpenReason.UNDECIDED: say(
            "have no place from which they are known to be seen, and no proof that there is none, so that "
            "they count as possible; {}",
            time_helps,
        ),
        OpenReason.CUT_OFF: say(
            "are only seen from places to which no way from home was found that keeps {:g} m from "
            "everything; move home, or lower the minimum distance",
            plan.constraints.min_distance_m,
        ),
        OpenReason.SPACING: say(
            "are only seen from places less than {:g} m from other viewpoints, which {} refuses; more time "
            "does not help",
            plan.aircraft.min_waypoint_spacing_m,
            plan.aircraft.name,
        ),
        OpenReason.SEARCH: say("can be covered; allow it more time"),
        OpenReason.LATE: say("stay open, and the time did not last to find out why; allow it more time"),
    }
    for why, text in texts.items():
        on = [panels[each.panel].id for each in planned.open_sections if each.why is why]
        if on:
            message = say("{} sections (on {} panels, the first is '{}') {}", len(on), len(set(on)), on[0], text)
            yield Finding(Severity.WARNING, f"open-{why}", message, on[0], float(len(on)), 0.0, "sections")


def check_files(
    plan_path: Path,
    site_path: Path,
    day: FlightDay = UNKNOWN_DAY,
    monitor: Monitor = QUIET,
    *,
    is_to_be_proved: bool = False,
) -> tuple[Finding, ...]:
    """All findings on a plan file and its site file, for a day of which something is known or not.

    Where a proof lies beside the plan, an independent check says of what it is one. `is_to_be_proved` makes an error of
    what is not proved.
    """
    findings = preflight(read_input_plan(plan_path), read_input_site(site_path), day, monitor).findings
    monitor.report(say("checking the proof"), 0, 1)
    proved = proof_of_files(plan_path, site_path)
    if is_to_be_proved:
        proved = refused_unless_proved(no_proof(proof_path(plan_path)) if proved is None else proved)
    return findings if proved is None else (*findings, proved)


def planned_summary(planned: Planned, seconds: float) -> dict[str, Any]:
    """What `plan --json` prints."""
    plan, site = planned.plan, planned.prepared.site_model.site
    panels, low = site.panels, lowest_flight(plan, site.home_enu_m, ground_of(site))
    return {
        "views": len(plan.viewpoints),
        "covered": plan.coverage.covered,
        "total": plan.coverage.total,
        "reachable_upper_bound": plan.coverage.reachable_upper_bound,
        "sharp": plan.coverage.sharp,
        "wanted_gsd_mm": plan.constraints.wanted_gsd_mm,
        "coarsest_gsd_mm": plan.coverage.coarsest_gsd_mm,
        "undecided": planned.n_undecided,
        "bound_for_views": planned.bound_for_views,
        "occlusion": plan.constraints.occlusion,
        "method": plan.method,
        "sorties": len(plan.sorties),
        "duration_s": round(plan.duration_s, 1),
        "landed_s": plan.landed_s,
        "length_m": round(sum(sortie.length_m for sortie in plan.sorties), 1),
        "lowest_height_m": None if low is None else round(low.lowest_m, 2),
        "below_10_m_s": None if low is None or low.below_s is None else round(low.below_s, 1),
        "depth": plain_values(planned.depth),
        "worth": plain_values(plan.worth),
        "most_psnr_db": planned.most_psnr_db,
        "effects": plain_values(plan.effects),
        "open": [
            {"panel": panels[each.panel].id, "section": each.section, "why": each.why.value}
            for each in planned.open_sections
        ],
        "findings": [finding_summary(finding) for finding in planned.findings],
        "seconds": round(seconds, 3),
        "seconds_by_stage": {stage: round(value, 3) for stage, value in planned.seconds.items()},
    }


def finding_summary(finding: Finding) -> dict[str, Any]:
    """A finding as JSON."""
    content: dict[str, Any] = plain_values(finding)
    return content
