"""A plan before the flight: every finding, and what each photo shows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from groundstation.services.mission.readiness import UNKNOWN_DAY, FlightDay, readiness_findings
from planning.base.findings import Finding
from planning.base.progress import QUIET, Monitor
from planning.checks.case import Case, pose_of
from planning.plan import Plan
from planning.site.records import SiteModel


@dataclass(frozen=True, slots=True, eq=False)
class Preflight:
    """What a check found.

    Parameters
    ----------
    plan, site_model
        What was checked: findings are as fresh as these are the ones in the window.
    panels_covered
        Number of panels by viewpoint.
    day
        What was known of the day of the flight.
    """

    plan: Plan
    site_model: SiteModel
    findings: tuple[Finding, ...]
    panels_covered: Mapping[str, int]
    day: FlightDay = UNKNOWN_DAY

    def is_of(self, plan: Plan | None, site_model: SiteModel | None) -> bool:
        """Whether this is about these very values."""
        return self.plan is plan and self.site_model is site_model


def preflight(plan: Plan, site_model: SiteModel, day: FlightDay = UNKNOWN_DAY, monitor: Monitor = QUIET) -> Preflight:
    """Check a plan on its site, for a day of which something is known or not."""
    monitor.report("measuring", 0, 1)
    case = Case.of(plan, site_model)
    seen = case.measures.seen
    # A view sees a panel in one section only: as many elements, as many panels.
    covered = {view.id: len(seen[pose_of(view)].elements) for view in plan.viewpoints}
    return Preflight(plan, site_model, readiness_findings(case, day, monitor), covered, day)
