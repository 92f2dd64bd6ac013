"""What happens on the Plan tab: planning as a job, plans taken in hand, edits by hand, effects. It shows nothing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QObject, QTimer, Signal

from groundstation.gui.workspace import Workspace
from groundstation.services.document import Document, Item, ItemKind, PlanEntry
from groundstation.services.effects import planning_effects
from groundstation.services.jobs import Job, JobContext
from groundstation.services.plan_bench import Bench, Groundwork, PlanInHand, take_in_hand
from groundstation.services.plan_editing import with_edited_plan
from groundstation.services.planning import plan_document_site
from planning import revision as edits
from planning.errors import GroundStationError
from planning.findings import Severity
from planning.plan import Plan, Viewpoint
from planning.plan_file import read_plan
from planning.planner import Planned
from planning.request import PlanRequest
from planning.revision import Revision

EFFECTS_AFTER_MS = 300
"""Wishes change several times in a row while somebody types; the scene is looked at when that is over."""


class PlanDesk(QObject):
    """Plans, and keeps the current plan in hand.

    Signals
    -------
    planningStarted(Job, float), planningEnded()
        With the time budget in seconds.
    inHandChanged(PlanInHand or None)
        The current plan can be looked at and edited; None while it is not in hand, or there is none.
    effectsChanged(tuple of EffectChoice)
    refused(str)
        Why an edit was not carried out.
    """

    planningStarted = Signal(object, float)  # noqa: N815  (Qt's own way of naming)
    planningEnded = Signal()  # noqa: N815
    inHandChanged = Signal(object)  # noqa: N815
    effectsChanged = Signal(object)  # noqa: N815
    refused = Signal(str)

    def __init__(self, workspace: Workspace, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._workspace = workspace
        self._bench = Bench()
        self._in_hand: PlanInHand | None = None
        self._planning: Job[Planned] | None = None
        self._taking: Job[PlanInHand] | None = None
        self._looking: Job[object] | None = None
        self._effects_timer = QTimer(self)
        self._effects_timer.setSingleShot(True)
        self._effects_timer.setInterval(EFFECTS_AFTER_MS)
        self._effects_timer.timeout.connect(self._look_at_effects)
        workspace.documentChanged.connect(self._document_changed)
        self._take_current()
        self._effects_timer.start()

    @property
    def in_hand(self) -> PlanInHand | None:
        """The current plan, when it can be looked at and edited."""
        return self._in_hand

    @property
    def is_planning(self) -> bool:
        """Whether a plan is being made, or waits to be."""
        return self._planning is not None

    def set_request(self, request: PlanRequest) -> None:
        """What the next plan is wanted to be."""
        self._workspace.amend(replace(self._workspace.document, request=request))

    def plan(self) -> None:
        """Plan the site with what is wanted; locked viewpoints of the current plan are kept."""
        document = self._workspace.document
        site = document.site
        if site is None or self._planning is not None:
            return
        current = document.current
        locked = () if current is None else tuple(view for view in current.plan.viewpoints if view.locked)
        try:
            request = replace(document.request, locked=locked)
        except ValueError as error:
            self.refused.emit(self.tr("{0}; release some, or ask for more views").format(error))
            return
        prepared = self._bench.prepared_for(request, site)

        def work(context: JobContext) -> Planned:
            return plan_document_site(
                site, request, prepared=prepared, stop=context.stop, trace=context.trace, monitor=context
            )

        def done(planned: Planned) -> None:
            self._planned(planned, request)

        job = self._workspace.start(self.tr("Plan"), work, done, lambda _error: self._planning_over())
        self._planning = job
        self.planningStarted.emit(job, request.time_budget_s)

    def stop_here(self) -> None:
        """Good enough: keep the best so far."""
        if self._planning is not None:
            self._planning.stop()

    def job_ended(self) -> None:
        """A job ended; when it was the planning one and nobody else said so, it was cancelled."""
        if self._planning is not None and self._planning not in self._workspace.jobs():
            self._planning_over()

    def choose(self, plan_id: str) -> None:
        """Look at another plan."""
        if plan_id != self._workspace.document.current_plan_id:
            self._workspace.amend(replace(self._workspace.document, current_plan_id=plan_id))

    def rename(self, plan_id: str, title: str) -> None:
        """Give a plan another title."""
        document = self._workspace.document
        entry = document.entry(plan_id)
        if entry is not None and title != entry.title:
            current = document.current_plan_id
            changed = replace(document.with_plan(replace(entry, title=title)), current_plan_id=current)
            self._workspace.change(self.tr("Rename plan"), changed)

    def remove(self, plan_id: str) -> None:
        """Take a plan out of the project."""
        self._workspace.change(self.tr("Remove plan"), self._workspace.document.without_plan(plan_id))

    def open_plan(self, path: Path) -> None:
        """Bring a plan file into the project."""

        def opened(plan: Plan) -> None:
            document = self._workspace.document
            entry = PlanEntry(document.free_plan_id(), path.name.removesuffix(".json").removesuffix(".plan"), plan)
            self._workspace.change(self.tr("Open plan"), document.with_plan(entry))

        self._workspace.start(self.tr("Open plan"), lambda _context: read_plan(path), opened)

    def set_viewpoint(self, viewpoint: Viewpoint) -> None:
        """Move, turn, lock or unlock the viewpoint with this identifier, as it differs."""
        in_hand = self._in_hand
        old = None if in_hand is None else in_hand.revision.viewpoint(viewpoint.id)
        if old is None or old == viewpoint:
            return
        if old.locked != viewpoint.locked:
            label = self.tr("Keep {0}") if viewpoint.locked else self.tr("Release {0}")
            self._edit(label, viewpoint.id, lambda revision: edits.lock(revision, [viewpoint.id], viewpoint.locked))
            return
        pose = viewpoint.position_enu_m, viewpoint.heading_deg, viewpoint.gimbal_pitch_deg
        is_turn = old.position_enu_m == viewpoint.position_enu_m
        label = self.tr("Turn {0}") if is_turn else self.tr("Move {0}")
        self._edit(label, viewpoint.id, lambda revision: edits.move(revision, viewpoint.id, *pose))

    def add_viewpoint(self, viewpoint: Viewpoint) -> None:
        """Add a viewpoint where and as another one looks; it gets an identifier of its own, and is selected."""
        in_hand = self._in_hand
        if in_hand is None:
            return
        new_id = edits.next_id(in_hand.plan)
        pose = viewpoint.position_enu_m, viewpoint.heading_deg, viewpoint.gimbal_pitch_deg
        if self._edit(self.tr("Add {0}"), new_id, lambda revision: edits.add(revision, *pose)):
            self._workspace.select(Item(ItemKind.VIEWPOINT, new_id))

    def delete_viewpoint(self, viewpoint_id: str) -> None:
        """Delete a viewpoint."""
        self._edit(self.tr("Delete {0}"), viewpoint_id, lambda revision: edits.delete(revision, [viewpoint_id]))

    def aim(self, viewpoint_id: str, panel_id: str) -> None:
        """Turn a viewpoint towards a panel."""

        def turned(revision: Revision) -> Revision:
            view = revision.viewpoint(viewpoint_id)
            heading, pitch = edits.aim_at(revision, view.position_enu_m, panel_id)
            return edits.move(revision, viewpoint_id, None, heading, pitch)

        self._edit(self.tr("Aim {0}"), viewpoint_id, turned)

    def preview(self, viewpoint: Viewpoint) -> PlanInHand | None:
        """What moving a viewpoint would give, without doing it; None where it cannot be done."""
        in_hand = self._in_hand
        if in_hand is None:
            return None
        pose = viewpoint.position_enu_m, viewpoint.heading_deg, viewpoint.gimbal_pitch_deg
        try:
            return in_hand.with_revision(edits.move(in_hand.revision, viewpoint.id, *pose))
        except (GroundStationError, ValueError):
            return None

    def _edit(self, label: str, viewpoint_id: str, edit: Callable[[Revision], Revision]) -> bool:
        in_hand, document = self._in_hand, self._workspace.document
        if in_hand is None or document.current is None:
            return False
        try:
            edited = in_hand.with_revision(edit(in_hand.revision))
        except (GroundStationError, ValueError) as error:
            self.refused.emit(str(error))
            return False
        self._bench.keep(edited.plan, edited)
        self._workspace.change(label.format(viewpoint_id), with_edited_plan(document, edited.revision))
        return True

    def _planned(self, planned: Planned, request: PlanRequest) -> None:
        self._planning_over()
        document, plan = self._workspace.document, planned.plan
        self._bench.keep_groundwork(Groundwork(planned.prepared))
        title = self.tr("{0}, {1} views").format(plan.method, len(plan.viewpoints))
        entry = PlanEntry(document.free_plan_id(), title, plan, request, planned.bound_for_views)
        self._workspace.change(self.tr("Plan"), document.with_plan(entry))
        coverage = plan.coverage
        self._workspace.say(
            Severity.OK,
            self.tr("Views: {0}, sorties: {1}; covered {2} of at most {3} sections").format(
                len(plan.viewpoints), len(plan.sorties), coverage.covered, coverage.reachable_upper_bound
            ),
        )
        for finding in planned.findings:
            self._workspace.say(finding.severity, finding.message)

    def _planning_over(self) -> None:
        self._planning = None
        self.planningEnded.emit()

    def _document_changed(self, before: Document, after: Document) -> None:
        plan_before = None if before.current is None else before.current.plan
        plan_after = None if after.current is None else after.current.plan
        if plan_before is not plan_after or before.site is not after.site:
            self._take_current()
        if before.site is not after.site or before.request != after.request or plan_before is not plan_after:
            self._effects_timer.start()

    def _take_current(self) -> None:
        """Take the current plan in hand: at once where it was before, else by a job."""
        document = self._workspace.document
        entry, site = document.current, document.site
        if self._taking is not None:
            self._workspace.cancel(self._taking)
            self._taking = None
        if entry is None or site is None:
            self._set_in_hand(None)
            return
        plan = entry.plan
        found = self._bench.find(plan, site)
        self._set_in_hand(found)
        if found is not None:
            return
        groundwork = self._bench.groundwork_for(plan, site)

        def taken(in_hand: PlanInHand) -> None:
            self._taking = None
            self._bench.keep(plan, in_hand)
            now = self._workspace.document
            if now.current is not None and now.current.plan is plan:
                self._set_in_hand(in_hand)

        self._taking = self._workspace.start(
            self.tr("Look at the plan"),
            lambda context: take_in_hand(site, plan, groundwork, context),
            taken,
        )

    def _set_in_hand(self, in_hand: PlanInHand | None) -> None:
        if in_hand is not self._in_hand:
            self._in_hand = in_hand
            self.inHandChanged.emit(in_hand)

    def _look_at_effects(self) -> None:
        document = self._workspace.document
        site, request = document.site, document.request
        plan = None if document.current is None else document.current.plan
        if self._looking is not None:
            self._workspace.cancel(self._looking)
            self._looking = None
        if site is None:
            self.effectsChanged.emit(())
            return
        if self._planning is not None:
            self._effects_timer.start()  # it would wait behind the plan
            return

        def found(choices: object) -> None:
            self._looking = None
            self.effectsChanged.emit(choices)

        self._looking = self._workspace.start(
            self.tr("Look at the scene"), lambda context: planning_effects(site, request, plan, context), found
        )
