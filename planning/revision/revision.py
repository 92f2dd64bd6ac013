"""A plan in hand: measured, checked, and ready to be edited."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.base.findings import Finding
from planning.checks import check_case
from planning.checks.case import Case
from planning.checks.measures import flight_key, legs_of, pose_of
from planning.coverage.evaluate import coverage_of_sights
from planning.plan import Plan, Sortie, Viewpoint
from planning.revision.ways import Ways
from planning.viewpoints.prepare import Prepared, settled

LENGTH_DECIMALS, DURATION_DECIMALS = 3, 2
"""Of stated lengths (m) and durations (s), as the planner writes them."""


@dataclass(frozen=True, slots=True, eq=False)
class Revision:
    """A plan on its prepared site with everything measured on it; made by `revise` and by the edits.

    Parameters
    ----------
    findings
        Of all pre-flight rules: those of `planning.checks.check_plan`.
    """

    prepared: Prepared
    ways: Ways
    case: Case
    findings: tuple[Finding, ...]

    @property
    def plan(self) -> Plan:
        """The plan as it is now."""
        return self.case.plan

    @property
    def counts(self) -> NDArray[np.int64]:
        """Number of views of each section, shape (m, n_sections)."""
        return self.case.measures.counts

    def viewpoint(self, viewpoint_id: str) -> Viewpoint:
        """A viewpoint by its identifier.

        Raises
        ------
        ValueError
            There is none.
        """
        found = next((viewpoint for viewpoint in self.plan.viewpoints if viewpoint.id == viewpoint_id), None)
        if found is None:
            raise ValueError(f"viewpoint_id: there is no viewpoint '{viewpoint_id}'")
        return found

    def elements_of_pose(self, viewpoint: Viewpoint) -> NDArray[np.int32]:
        """Panel * n_sections + section of each panel that one of the plan's viewpoints covers, shape (k,), rising."""
        return self.case.measures.seen[pose_of(viewpoint)].elements

    def leg_clearances_m(self, sortie: Sortie) -> NDArray[np.float64]:
        """Distance of each leg of one of the plan's sorties to panels, building and obstacles, shape (k - 1,)."""
        return np.array([self.case.measures.solid_gaps.legs_m[leg] for leg in legs_of(sortie)], np.float64)


def revise(plan: Plan, prepared: Prepared, before: Revision | None = None) -> Revision:
    """Take a plan in hand.

    Parameters
    ----------
    prepared
        The plan's site, prepared for its camera and constraints.
    before
        Another plan on the same preparation, such as the one before an edit was undone: saves measuring what both have
        in common, and changes nothing else.

    Raises
    ------
    ValueError
        The site was prepared for another camera or other constraints.
    """
    if plan.camera != prepared.problem.model.camera:
        raise ValueError(f"prepared: is for the camera {prepared.problem.model.camera.name}, not {plan.camera.name}")
    wanted = replace(plan.constraints, occlusion=prepared.constraints.occlusion)
    wanted = settled(wanted, prepared.site_model, plan.camera)
    if wanted != prepared.constraints or plan.constraints.occlusion not in ("auto", wanted.occlusion):
        raise ValueError(f"prepared: is for {prepared.constraints}, not {plan.constraints}")
    if before is None or before.prepared is not prepared:
        case = Case.of(plan, prepared.site_model)
        ways = Ways.over(prepared.problem.roadmap, plan.aircraft, plan.rules)
    else:
        case, ways = before.case.with_plan(plan), before.ways
        if (plan.aircraft, plan.rules) != (before.plan.aircraft, before.plan.rules):
            ways = Ways.over(prepared.problem.roadmap, plan.aircraft, plan.rules)
    return Revision(prepared, ways, case, check_case(case))


def with_route(revision: Revision, viewpoints: Iterable[Viewpoint], sorties: Iterable[Sortie]) -> Revision:
    """The plan with other viewpoints and sorties; it states what they cover, and length and duration of new sorties."""
    known = {id(sortie) for sortie in revision.plan.sorties}
    case = revision.case.with_plan(replace(revision.plan, viewpoints=tuple(viewpoints), sorties=tuple(sorties)))
    plan = replace(
        case.plan,
        sorties=tuple(sortie if id(sortie) in known else _stated(case, sortie) for sortie in case.plan.sorties),
        coverage=coverage_of_sights(case.model, case.measures.seen.values(), revision.prepared.problem.reachability),
    )
    case = replace(case, plan=plan)
    return replace(revision, case=case, findings=check_case(case))


def _stated(case: Case, sortie: Sortie) -> Sortie:
    """A sortie with the length and the duration that were measured; as it is where nothing can be flown."""
    by_id = {viewpoint.id: viewpoint for viewpoint in case.plan.viewpoints}
    flight = case.measures.flights.get(flight_key(sortie, by_id))
    length_m = float(np.linalg.norm(np.diff(np.array(sortie.path_enu_m), axis=0), axis=1).sum())
    duration_s = sortie.duration_s if flight is None else round(flight.stopping_s, DURATION_DECIMALS)
    return replace(sortie, length_m=round(length_m, LENGTH_DECIMALS), duration_s=duration_s)
