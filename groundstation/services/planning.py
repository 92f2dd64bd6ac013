"""Use cases around plans: plan a flight over a site and write it, check a plan against its site."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec

from planning.checks import check_plan
from planning.findings import Finding, Severity
from planning.json_file import check_output
from planning.plan import Plan
from planning.plan_file import read_plan, write_plan
from planning.planner import Planned, PlanRequest, plan_flight
from planning.progress import QUIET, Monitor, Stop, Trace, never
from planning.site_file import read_site


def plan_site(
    site_path: Path,
    request: PlanRequest,
    out: Path | None,
    *,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> Planned:
    """Plan a flight over the site in a file, and write the plan where `out` says.

    A finding says so where the plan has less than was asked for.

    Raises
    ------
    InputError, InfeasibleError
        As `planning.planner.plan_flight`, or the plan cannot be written where it should go; nothing is written then.
    """
    if out is not None:
        check_output(out, [site_path])
    planned = plan_flight(read_site(site_path), request, stop=stop, trace=trace, monitor=monitor)
    if out is not None:
        write_plan(out, planned.plan)
    return replace(planned, findings=(*planned.findings, *_shortfalls(request, planned.plan)))


def _shortfalls(request: PlanRequest, plan: Plan) -> Iterator[Finding]:
    n_views = len(plan.viewpoints)
    if request.n_views is not None and n_views < request.n_views:
        text = (
            f"{n_views} views instead of the {request.n_views} asked for: more would show nothing new or could not be "
            "flown"
        )
        yield Finding(Severity.NOTE, "fewer-views", text, "", float(n_views), float(request.n_views), "views")
    if request.share is None:
        return
    share = plan.coverage.covered / max(plan.coverage.reachable_upper_bound, 1)
    if share < request.share:
        advice = "allow it more time" if request.method == "greedy" else "the method flies a pattern of its own"
        text = (
            f"covers {100.0 * share:.2f} % of what is possible at most, {100.0 * request.share:g} % were asked for; "
            f"{advice}"
        )
        yield Finding(Severity.WARNING, "less-coverage", text, "", share, request.share)


def check_files(plan_path: Path, site_path: Path, monitor: Monitor = QUIET) -> tuple[Finding, ...]:
    """All findings on a plan file and its site file."""
    return check_plan(read_plan(plan_path), read_site(site_path), monitor)


def planned_summary(planned: Planned, seconds: float) -> dict[str, Any]:
    """What `plan --json` prints."""
    plan = planned.plan
    return {
        "views": len(plan.viewpoints),
        "covered": plan.coverage.covered,
        "total": plan.coverage.total,
        "reachable_upper_bound": plan.coverage.reachable_upper_bound,
        "undecided": planned.n_undecided,
        "bound_for_views": planned.bound_for_views,
        "occlusion": plan.constraints.occlusion,
        "method": plan.method,
        "sorties": len(plan.sorties),
        "duration_s": round(plan.duration_s, 1),
        "length_m": round(sum(sortie.length_m for sortie in plan.sorties), 1),
        "depth": msgspec.to_builtins(planned.depth),
        "effects": msgspec.to_builtins(plan.effects),
        "findings": [finding_summary(finding) for finding in planned.findings],
        "seconds": round(seconds, 3),
        "seconds_by_stage": {stage: round(value, 3) for stage, value in planned.seconds.items()},
    }


def finding_summary(finding: Finding) -> dict[str, Any]:
    """A finding as JSON."""
    content: dict[str, Any] = msgspec.to_builtins(finding)
    return content
