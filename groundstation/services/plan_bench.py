"""What looking at plans, editing them and planning again have in common, kept so that it is computed once.

Preparing a site takes seconds (what can be reached is proven), taking a plan in hand a fraction of one; an edit then
takes milliseconds. A `Bench` is a value that lives in the window's thread; `take_in_hand` is for jobs and gives a
`PlanInHand` that the bench keeps.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from planning.catalogue import profile
from planning.coverage.sections import NOT_SEEN, PanelFrames
from planning.insight.reasons import SectionReasons, section_reasons
from planning.insight.sampling import PanelSampling, panel_sampling
from planning.insight.sections import PlanInsight, assembled
from planning.plan import Camera, Constraints, Plan, viewpoint_arrays
from planning.prepare import Prepared, is_same_place, prepare
from planning.progress import QUIET, Monitor
from planning.request import PlanRequest
from planning.revision import Revision, revise
from planning.site import SiteModel

MAX_IN_HAND = 40
"""Plans kept: undo goes back through so many edits without computing anything; each shares most with the others."""

MAX_GROUNDWORKS = 3


@dataclass(frozen=True, slots=True, eq=False)
class Groundwork:
    """A prepared site and why parts of it cannot be seen; the same for all plans with one camera and constraints.

    Planning leaves it without the reasons; they are found when a plan is taken in hand.
    """

    prepared: Prepared
    reasons: SectionReasons | None = None


@dataclass(frozen=True, slots=True, eq=False)
class PlanInHand:
    """A plan that can be looked at and edited."""

    groundwork: Groundwork
    revision: Revision
    insight: PlanInsight

    @property
    def plan(self) -> Plan:
        """The plan."""
        return self.revision.plan

    def with_revision(self, revision: Revision) -> PlanInHand:
        """After an edit."""
        return replace(self, revision=revision, insight=insight_of(revision, self.insight.reasons, self))


class Bench:
    """The plans that were in hand, the last ones first to be found."""

    def __init__(self) -> None:
        self._in_hand: OrderedDict[int, tuple[Plan, PlanInHand]] = OrderedDict()
        self._groundworks: list[Groundwork] = []

    def find(self, plan: Plan, site_model: SiteModel) -> PlanInHand | None:
        """A plan that is in hand on this site; None where it must be taken first.

        Plans are told apart by being one object, as the document's history keeps them; the record inside may be
        another one, equal to it.
        """
        found = self._in_hand.get(id(plan))
        if found is None or not is_same_place(found[1].groundwork.prepared.site_model, site_model):
            return None
        self._in_hand.move_to_end(id(plan))
        return found[1]

    def keep(self, plan: Plan, in_hand: PlanInHand) -> None:
        """Remember a plan, under the object that the document has."""
        self._in_hand[id(plan)] = (plan, in_hand)
        self._in_hand.move_to_end(id(plan))
        while len(self._in_hand) > MAX_IN_HAND:
            self._in_hand.popitem(last=False)
        self.keep_groundwork(in_hand.groundwork)

    def keep_groundwork(self, groundwork: Groundwork) -> None:
        """Remember a prepared site."""
        others = [kept for kept in self._groundworks if kept.prepared is not groundwork.prepared]
        self._groundworks = [groundwork, *others][:MAX_GROUNDWORKS]

    def groundwork_for(self, plan: Plan, site_model: SiteModel) -> Groundwork | None:
        """Groundwork on which a plan can be taken in hand."""
        return next((kept for kept in self._groundworks if _fits(kept.prepared, plan, site_model)), None)

    def prepared_for(self, request: PlanRequest, site_model: SiteModel) -> Prepared | None:
        """A prepared site with which a request can be planned."""
        camera = profile(request.profile_id).camera
        wanted = (site_model, camera, request.constraints, request.precision, request.seed)
        return next((kept.prepared for kept in self._groundworks if not kept.prepared.unfit_for(*wanted)), None)


def take_in_hand(
    site_model: SiteModel, plan: Plan, groundwork: Groundwork | None, monitor: Monitor = QUIET
) -> PlanInHand:
    """Measure a plan and find out what it leaves unseen and why.

    Parameters
    ----------
    groundwork
        What is known of the site, for this plan's camera and constraints; None where nothing is.

    Raises
    ------
    InfeasibleError
        Home cannot be used, or no allowed viewpoint sees any panel.
    """
    if groundwork is None:
        prepared = prepare(site_model, plan.camera, plan.constraints, seed=plan.seed, monitor=monitor)
        groundwork = Groundwork(prepared)
    reasons = groundwork.reasons
    if reasons is None:
        reasons = section_reasons(site_model, groundwork.prepared, monitor=monitor)
    monitor.report("measuring the plan", 0, 1)
    revision = revise(plan, groundwork.prepared)
    return PlanInHand(Groundwork(groundwork.prepared, reasons), revision, insight_of(revision, reasons))


def insight_of(revision: Revision, reasons: SectionReasons, before: PlanInHand | None = None) -> PlanInsight:
    """What a plan in hand covers, from what is measured on it already; `before` is the same plan before an edit."""
    prepared, plan = revision.prepared, revision.plan
    model = prepared.problem.model
    n_sections = model.grid.n_sections
    sections = np.full((len(plan.viewpoints), len(model.frames)), NOT_SEEN, np.int16)
    for number, viewpoint in enumerate(plan.viewpoints):
        panel, section = np.divmod(revision.elements_of_pose(viewpoint), n_sections)
        sections[number, panel] = section
    counts = revision.counts.astype(np.int32)
    sampling = _sampling(revision, sections, before)
    return assembled(prepared.site_model, prepared, plan, sections, counts, sampling, reasons)


def _sampling(revision: Revision, sections: NDArray[np.int16], before: PlanInHand | None) -> PanelSampling:
    """Pixel sizes of all panels; after an edit only those are computed that a view sees or saw which it changed."""
    model, viewpoints = revision.prepared.problem.model, revision.plan.viewpoints
    frames, positions = model.frames, viewpoint_arrays(viewpoints).positions_enu_m
    if before is None:
        return panel_sampling(frames, model.camera, positions, sections)
    old, new = set(before.plan.viewpoints), set(viewpoints)
    is_new = np.array([view not in old for view in viewpoints], bool)
    is_old = np.array([view not in new for view in before.plan.viewpoints], bool)
    touched = (sections[is_new] != NOT_SEEN).any(axis=0) | (before.insight.sections[is_old] != NOT_SEEN).any(axis=0)
    some = PanelFrames(*(getattr(frames, part.name)[touched] for part in fields(frames)))
    part = panel_sampling(some, model.camera, positions, sections[:, touched])
    kept = before.insight.sampling
    merged = {}
    for name in (field.name for field in fields(PanelSampling)):
        merged[name] = getattr(kept, name).copy()
        merged[name][touched] = getattr(part, name)
    return PanelSampling(**merged)


def _fits(prepared: Prepared, plan: Plan, site_model: SiteModel) -> bool:
    camera: Camera = prepared.problem.model.camera
    wanted: Constraints = replace(plan.constraints, occlusion=prepared.constraints.occlusion)
    occlusion = plan.constraints.occlusion
    return (
        is_same_place(prepared.site_model, site_model)
        and plan.camera == camera
        and wanted == prepared.constraints
        and occlusion in ("auto", prepared.constraints.occlusion)
    )
