"""Pre-flight checks of a plan on its site: every rule with its measured value and limit, all findings at once.

Each rule gives at least one finding, `OK` where it is kept. Distances along legs are exact minima over whole segments,
not samples. The plan's own numbers (coverage, lengths, durations) are computed again and compared.
"""

from __future__ import annotations

from planning.base.findings import Finding
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.checks.camera import CAMERA_RULES
from planning.checks.case import Case
from planning.checks.rules import FLIGHT_RULES, GEOMETRY_RULES
from planning.checks.zones import geo_zones
from planning.plan import Plan
from planning.site.records import SiteModel

RULES = (*GEOMETRY_RULES, geo_zones, *FLIGHT_RULES, *CAMERA_RULES)


def check_plan(plan: Plan, site_model: SiteModel, monitor: Monitor = QUIET) -> tuple[Finding, ...]:
    """All findings of all rules, in the order of the rules."""
    monitor.report(say("checking"), 0, len(RULES))
    return check_case(Case.of(plan, site_model), monitor)


def check_case(case: Case, monitor: Monitor = QUIET) -> tuple[Finding, ...]:
    """All findings of all rules on a plan that is measured already."""
    findings: list[Finding] = []
    for number, rule in enumerate(RULES):
        monitor.report(say("checking"), number, len(RULES))
        findings += rule(case)
    return tuple(findings)
