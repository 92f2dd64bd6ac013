"""Pre-flight checks of a plan on its site: every rule with its measured value and limit, all findings at once.

Each rule gives at least one finding, `OK` where it is kept. Distances along legs are exact minima over whole segments,
not samples. The plan's own numbers (coverage, lengths, durations) are computed again and compared.
"""

from __future__ import annotations

from dataclasses import replace

from planning.checks.case import Case
from planning.checks.flight_rules import FLIGHT_RULES
from planning.checks.geometry_rules import GEOMETRY_RULES
from planning.findings import Finding
from planning.plan import Plan
from planning.prepare import coverage_model, decide_occlusion
from planning.progress import QUIET, Monitor
from planning.site import SiteModel
from planning.space import unchecked_space

RULES = (*GEOMETRY_RULES, *FLIGHT_RULES)


def check_plan(plan: Plan, site_model: SiteModel, monitor: Monitor = QUIET) -> tuple[Finding, ...]:
    """All findings of all rules, in the order of the rules."""
    monitor.report("checking", 0, len(RULES))
    space = unchecked_space(site_model, plan.constraints.min_distance_m)
    constraints = plan.constraints
    if constraints.occlusion == "auto":
        on = decide_occlusion(site_model, space, "auto").on
        constraints = replace(constraints, occlusion="on" if on else "off")
    case = Case(plan, site_model, space, coverage_model(site_model, space, plan.camera, constraints))
    findings: list[Finding] = []
    for number, rule in enumerate(RULES):
        monitor.report("checking", number, len(RULES))
        findings += rule(case)
    return tuple(findings)
