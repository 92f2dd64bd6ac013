"""What looking at plans, editing them and planning again have in common, kept so that it is computed once.

Preparing a site takes seconds (what can be reached is proven), activating a plan a fraction of one; an edit then
takes milliseconds. A `PlanCache` is a value that lives in the window's thread; `activate` is for jobs and gives a
`ActivePlan` that the cache keeps.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import EffectSetting
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.checks.case import pose_of
from planning.coverage.sections import NOT_SEEN
from planning.insight.reasons import SectionReasons, section_reasons
from planning.insight.sections import PanelSampling, PlanInsight, assembled, panel_sampling
from planning.parameters import Constraints
from planning.plan import Camera, FlightWorth, Plan, viewpoint_arrays
from planning.planner import first_reusable
from planning.request import PlanRequest
from planning.revision.edits import Revision, revise
from planning.revision.top_up import METHOD as TOP_UP
from planning.site.records import SiteModel
from planning.viewpoints.least_error import MirroredSurroundings, flight_worth, image_error_model
from planning.viewpoints.prepare import Prepared, is_same_place, prepare, with_site_limits

MAX_ACTIVE = 40
"""Plans kept: undo goes back through so many edits without computing anything; each shares most with the others."""

MAX_PREPARED = 3


@dataclass(frozen=True, slots=True, eq=False)
class PreparedSite:
    """A prepared site and why parts of it cannot be seen; the same for all plans with one camera and constraints.

    Planning leaves it without the reasons; they are found when a plan is activated.
    """

    prepared: Prepared
    reasons: SectionReasons | None = None


@dataclass(frozen=True, slots=True, eq=False)
class ActivePlan:
    """A plan that can be looked at and edited."""

    prepared_site: PreparedSite
    revision: Revision
    insight: PlanInsight

    @property
    def plan(self) -> Plan:
        """The plan."""
        return self.revision.plan

    def with_revision(self, revision: Revision) -> ActivePlan:
        """After an edit."""
        return replace(self, revision=revision, insight=insight_of(revision, self.insight.reasons, self))


class PlanCache:
    """The plans that were active, the last ones first to be found."""

    def __init__(self) -> None:
        self._active: OrderedDict[int, tuple[Plan, ActivePlan]] = OrderedDict()
        self._prepared_sites: list[PreparedSite] = []

    def find(self, plan: Plan, site_model: SiteModel) -> ActivePlan | None:
        """The active plan of this site; None where it must be activated first.

        Plans are told apart by being one object, as the document's history keeps them; the record inside may be
        another one, equal to it.
        """
        found = self._active.get(id(plan))
        if found is None or not is_same_place(found[1].prepared_site.prepared.site_model, site_model):
            return None
        self._active.move_to_end(id(plan))
        return found[1]

    def keep(self, plan: Plan, active: ActivePlan) -> None:
        """Remember a plan, under the object that the document has."""
        self._active[id(plan)] = (plan, active)
        self._active.move_to_end(id(plan))
        while len(self._active) > MAX_ACTIVE:
            self._active.popitem(last=False)
        self.keep_prepared(active.prepared_site)

    def keep_prepared(self, prepared_site: PreparedSite) -> None:
        """Remember a prepared site."""
        others = [kept for kept in self._prepared_sites if kept.prepared is not prepared_site.prepared]
        self._prepared_sites = [prepared_site, *others][:MAX_PREPARED]

    def prepared_site_for(self, plan: Plan, site_model: SiteModel) -> PreparedSite | None:
        """Prepared site on which a plan can be made the active one."""
        return next((kept for kept in self._prepared_sites if _fits(kept.prepared, plan, site_model)), None)

    def prepared_for(self, request: PlanRequest, site_model: SiteModel) -> Prepared | None:
        """A prepared site with which a request can be planned."""
        return first_reusable((one.prepared for one in self._prepared_sites), site_model, request)


def activate(
    site_model: SiteModel, plan: Plan, prepared_site: PreparedSite | None, monitor: Monitor = QUIET
) -> ActivePlan:
    """Measure a plan and find out what it leaves unseen and why.

    Parameters
    ----------
    prepared_site
        What is known of the site, for this plan's camera and constraints; None where nothing is.

    Raises
    ------
    InfeasibleError
        Home cannot be used, or no allowed viewpoint sees any panel.
    """
    if prepared_site is None:
        prepared = prepare(site_model, plan.camera, plan.constraints, seed=plan.seed, monitor=monitor)
        prepared_site = PreparedSite(prepared)
    reasons = prepared_site.reasons
    if reasons is None:
        reasons = section_reasons(site_model, prepared_site.prepared, monitor=monitor)
    monitor.report(say("measuring the plan"), 0, 1)
    revision = revise(plan, prepared_site.prepared)
    return ActivePlan(PreparedSite(prepared_site.prepared, reasons), revision, insight_of(revision, reasons))


def worth_of(active: ActivePlan) -> FlightWorth | None:
    """What the photos of a plan are expected to bring, also of one that was edited, or comes from another program.

    None where that depends on photos that are there already, and as `flight_worth` has it.
    """
    prepared, plan = active.prepared_site.prepared, active.plan
    if plan.method == TOP_UP:
        return None
    is_on = next((decision.on for decision in plan.effects if decision.effect == MirroredSurroundings.name), None)
    setting: EffectSetting = "auto" if is_on is None else "on" if is_on else "off"
    error, _ = image_error_model(prepared.problem, prepared.site_model, setting, plan.seed)
    return flight_worth(prepared.problem, error, plan, plan.seed)


def insight_of(revision: Revision, reasons: SectionReasons, before: ActivePlan | None = None) -> PlanInsight:
    """What an active plan covers, from what is measured on it already; `before` is the same plan before an edit."""
    prepared, plan = revision.prepared, revision.plan
    if before is None:
        sections, sampling = _measured(revision)
    else:
        sections, sampling = _measured_since(revision, before)
    counts = revision.counts.astype(np.int32)
    return assembled(prepared.site_model, prepared, plan, sections, counts, sampling, reasons)


def _measured(revision: Revision) -> tuple[NDArray[np.int16], PanelSampling]:
    """What each view covers, and pixel sizes of all panels."""
    model, viewpoints = revision.prepared.problem.model, revision.plan.viewpoints
    sections = np.full((len(viewpoints), len(model.frames)), NOT_SEEN, np.int16)
    for number in range(len(viewpoints)):
        _fill_row(sections, number, revision)
    return sections, panel_sampling(model.frames, model.camera, viewpoint_arrays(viewpoints).positions_enu_m, sections)


def _fill_row(sections: NDArray[np.int16], number: int, revision: Revision) -> None:
    elements = revision.elements_of_pose(revision.plan.viewpoints[number])
    panel, section = np.divmod(elements, revision.prepared.problem.model.grid.n_sections)
    sections[number, panel] = section


def _measured_since(revision: Revision, before: ActivePlan) -> tuple[NDArray[np.int16], PanelSampling]:
    """As `_measured`, where only what an edit changed is computed: new views, and the panels that these see or saw."""
    model, viewpoints = revision.prepared.problem.model, revision.plan.viewpoints
    known = {pose_of(viewpoint): row for row, viewpoint in enumerate(before.plan.viewpoints)}
    rows = np.array([known.get(pose_of(viewpoint), -1) for viewpoint in viewpoints], np.int64)
    is_kept, is_gone = rows >= 0, np.ones(len(before.plan.viewpoints), bool)
    is_gone[rows[is_kept]] = False
    sections = np.full((len(viewpoints), len(model.frames)), NOT_SEEN, np.int16)
    sections[is_kept] = before.insight.sections[rows[is_kept]]
    for number in np.flatnonzero(~is_kept).tolist():
        _fill_row(sections, number, revision)
    seen = np.concatenate([sections[~is_kept], before.insight.sections[is_gone]]) != NOT_SEEN
    touched = np.flatnonzero(seen.any(axis=0))
    positions = viewpoint_arrays(viewpoints).positions_enu_m
    part = panel_sampling(model.frames, model.camera, positions, sections, touched)
    merged = {}
    for name in (field.name for field in fields(PanelSampling)):
        merged[name] = getattr(before.insight.sampling, name).copy()
        merged[name][touched] = getattr(part, name)
    return sections, PanelSampling(**merged)


def _fits(prepared: Prepared, plan: Plan, site_model: SiteModel) -> bool:
    camera: Camera = prepared.problem.model.camera
    wanted: Constraints = with_site_limits(
        replace(plan.constraints, occlusion=prepared.constraints.occlusion), site_model, camera
    )
    occlusion = plan.constraints.occlusion
    return (
        is_same_place(prepared.site_model, site_model)
        and plan.camera == camera
        and wanted == prepared.constraints
        and occlusion in ("auto", prepared.constraints.occlusion)
    )
