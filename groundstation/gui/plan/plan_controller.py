"""What happens on the Plan tab: planning as a job, plans activated, edits by hand, effects. It shows nothing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QCoreApplication, QObject, QTimer, Signal

from groundstation.gui.application.context import ApplicationContext
from groundstation.services.jobs.runner import Job, JobContext, JobState
from groundstation.services.mission.camera import with_camera
from groundstation.services.plan.editing import KEEPING_METHODS, edit_effect, has_same_panels, with_edited_plan
from groundstation.services.plan.effects import EffectChoice, SceneEffects, plan_effects, scene_effects
from groundstation.services.plan.places import item_of_place
from groundstation.services.plan.plan_cache import ActivePlan, PlanCache, PreparedSite, activate
from groundstation.services.plan.planning import plan_document_site, with_local_site
from groundstation.services.project.document import Document, Item, ItemKind, PlanEntry
from groundstation.services.project.input_files import read_input_plan
from planning.base.errors import GroundStationError, InputError
from planning.base.findings import Severity
from planning.base.messages import say
from planning.parameters import CameraSettings
from planning.plan import Plan, Viewpoint
from planning.planner import Planned
from planning.request import PlanRequest
from planning.revision import edits
from planning.revision.edits import Revision
from planning.site.records import SiteModel, require_panels

# The methods of choosing views as the pilot knows them.


def method_name(method: str) -> str:
    """A method's name in the user's language; what is not known here stays."""
    names = {
        "greedy": QCoreApplication.translate("MethodNames", "Optimised (recommended)"),
        "pso": QCoreApplication.translate("MethodNames", "Particle swarm (paper)"),
        "noto": QCoreApplication.translate("MethodNames", "Nap-of-the-object grid"),
        "orbit": QCoreApplication.translate("MethodNames", "Orbits"),
        "random": QCoreApplication.translate("MethodNames", "Drawn by lot"),
    }
    return names.get(method, method)


# Finds out which effects the scene and the current plan call for, while somebody looks. It shows nothing.

AFTER_MS = 300
"""The request changes several times in a row while somebody types; the scene is looked at when that is over."""

Found = tuple[SceneEffects, Plan | None, tuple[EffectChoice, ...]]


class EffectsController(QObject):
    """Keeps the effects up to date; one job at a time, and none while nobody looks or a plan is being made.

    Signals
    -------
    effectsChanged(tuple of EffectChoice)
        Empty while nothing is known of the site.
    """

    effectsChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(
        self,
        context: ApplicationContext,
        is_wanted: Callable[[], bool],
        is_planning: Callable[[], bool],
        parent: QObject,
    ) -> None:
        super().__init__(parent)
        self._context, self._is_wanted, self._is_planning = context, is_wanted, is_planning
        self._scene: SceneEffects | None = None
        self._plan: Plan | None = None
        self._job: Job[Found] | None = None
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(AFTER_MS)
        self._timer.timeout.connect(self.look)
        context.documentChanged.connect(self._document_changed)
        context.jobsChanged.connect(self._forget_ended)

    def look(self) -> None:
        """Look at the scene and the plan, unless what is known still holds."""
        document = self._context.document
        site, request, plan = document.site, document.request, _plan_of(document)
        if site is None or self._job is not None or not self._is_wanted():
            return
        known = self._scene if self._scene is not None and self._scene.hold_for(site, request) else None
        if known is not None and self._plan is plan:
            return
        if self._is_planning():
            self._timer.start()  # it would wait behind the plan
            return

        def work(context: JobContext) -> Found:
            context.report(say("looking at the scene"), 0, 1)
            scene = scene_effects(site, request) if known is None else known
            return scene, plan, scene.choices + (() if plan is None else plan_effects(plan, site))

        self._job = self._context.start(self.tr("Look at the scene"), work, self._found)

    def _found(self, found: Found) -> None:
        scene, plan, choices = found
        if scene.site_model is self._context.document.site:
            self._scene, self._plan = scene, plan
            self.effectsChanged.emit(choices)
        self.look()

    def _forget_ended(self) -> None:
        """Also a job that failed or was cancelled is over."""
        if self._job is not None and self._job not in self._context.jobs():
            self._job = None

    def _document_changed(self, before: Document, after: Document) -> None:
        if before.site is not after.site:
            self._scene = None
            self.effectsChanged.emit(())
        if self._is_wanted():
            self._timer.start()


def _plan_of(document: Document) -> Plan | None:
    return None if document.current is None else document.current.plan


class PlanController(QObject):
    """Plans, and keeps the current plan active.

    Signals
    -------
    planned(PlanEntry)
        A plan has come into the document.
    planningStarted(Job, float), planningEnded()
        With the time budget in seconds.
    activePlanChanged(ActivePlan or None)
        The current plan can be looked at and edited; None while it is not active, or there is none.
    refused(str)
        Why an edit was not carried out, in the window's language.
    """

    planningStarted = Signal(object, float)  # noqa: N815  (Qt's own way of naming)
    planningEnded = Signal()  # noqa: N815
    planned = Signal(object)
    activePlanChanged = Signal(object)  # noqa: N815
    refused = Signal(object)

    def __init__(self, context: ApplicationContext, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._context = context
        self._plan_cache = PlanCache()
        self._active: ActivePlan | None = None
        self._planning: Job[Planned] | None = None
        self._activation: Job[ActivePlan] | None = None
        self._not_taken = ""
        context.documentChanged.connect(self._document_changed)
        self._take_current()

    @property
    def active(self) -> ActivePlan | None:
        """The current plan, when it can be looked at and edited."""
        return self._active

    @property
    def is_planning(self) -> bool:
        """Whether a plan is being made, or waits to be."""
        return self._planning is not None

    @property
    def why_not_active(self) -> str:
        """Why the current plan could not be activated; empty while it is, is about to be, or there is none."""
        return self._not_taken

    def set_request(self, request: PlanRequest) -> None:
        """What the next plan is wanted to be."""
        self._context.amend(replace(self._context.document, request=request))

    @property
    def camera_settings(self) -> CameraSettings:
        """Those of the current plan; without one those that the next will have."""
        current = self._context.document.current
        return self._context.document.request.camera if current is None else current.plan.camera_settings

    def set_camera(self, settings: CameraSettings) -> None:
        """Take photos otherwise: of the current plan, which stays as it is, and of the next ones."""
        document = self._context.document
        changed = replace(document, request=replace(document.request, camera=settings))
        entry, active = document.current, self._active
        if entry is None:
            self._context.amend(changed)
            return
        plan = with_camera(entry.plan, settings)
        if active is not None:
            revision = edits.revise(plan, active.revision.prepared, active.revision)
            self._plan_cache.keep(plan, active.with_revision(revision))
        self._context.change(self.tr("Camera settings"), changed.with_plan(replace(entry, plan=plan)))

    def plan(self) -> None:
        """Plan the site with what is wanted; locked viewpoints of the current plan are kept."""
        document = self._context.document
        site = document.site
        if site is None or self._planning is not None:
            return
        current = document.current
        locked = () if current is None else tuple(view for view in current.plan.viewpoints if view.locked)
        if locked and document.request.method not in KEEPING_METHODS:
            names = ", ".join(view.id for view in locked)
            text = self.tr("Only “Optimised (recommended)” can keep viewpoints. Choose it, or release those kept: {0}")
            self.refused.emit(text.format(names))
            return
        try:
            request = replace(document.request, locked=locked, camera=self.camera_settings)
        except ValueError as error:
            self.refused.emit(
                self.tr("{0}; release some, or ask for more views").format(self._context.localized(str(error)))
            )
            return
        prepared = self._plan_cache.prepared_for(request, site)

        def work(context: JobContext) -> Planned:
            return with_local_site(context.run_in_process(plan_document_site, site, request, prepared), site, prepared)

        def done(planned: Planned) -> None:
            self._planned(planned, request, site)

        job = self._context.start(self.tr("Plan"), work, done, lambda _error: self._planning_over())
        self._planning = job
        self._context.note(is_planning=True)
        self.planningStarted.emit(job, request.time_budget_s)

    def stop_here(self) -> None:
        """Good enough: keep the best so far."""
        if self._planning is not None:
            self._planning.stop()

    def job_ended(self) -> None:
        """A job ended: somebody may have cancelled one of these."""
        if self._planning is not None and self._planning.state is JobState.CANCELLED:
            self._planning_over()
        if self._activation is not None and self._activation.state is JobState.CANCELLED:
            self._give_up(self.tr("It was not looked at. Choose it in the list of plans to do so."))

    def choose(self, plan_id: str) -> None:
        """Look at another plan, or again at one that could not be activated."""
        if plan_id == self._context.document.current_plan_id and self._not_taken:
            self._take_current()
        if plan_id != self._context.document.current_plan_id:
            self._context.amend(replace(self._context.document, current_plan_id=plan_id))

    def rename(self, plan_id: str, title: str) -> None:
        """Give a plan another title."""
        document = self._context.document
        entry = document.entry(plan_id)
        if entry is not None and title != entry.title:
            current = document.current_plan_id
            changed = replace(document.with_plan(replace(entry, title=title)), current_plan_id=current)
            self._context.change(self.tr("Rename plan"), changed)

    def remove(self, plan_id: str) -> None:
        """Take a plan out of the project."""
        self._context.change(self.tr("Delete plan"), self._context.document.without_plan(plan_id))

    def open_plan(self, path: Path) -> None:
        """Bring a plan file into the project."""

        def opened(plan: Plan) -> None:
            document = self._context.document
            entry = PlanEntry(document.free_plan_id(), path.name.removesuffix(".json").removesuffix(".plan"), plan)
            self._context.change(self.tr("Open plan"), document.with_plan(entry))

        self._context.start(self.tr("Open plan"), lambda _context: read_input_plan(path), opened)

    def set_viewpoint(self, viewpoint: Viewpoint) -> None:
        """Move, turn, lock or unlock the viewpoint with this identifier, as it differs."""
        if self._active is None:
            self._refuse_all()
            return
        old = self._active.revision.viewpoint(viewpoint.id)
        if old == viewpoint:
            return
        if old.locked != viewpoint.locked:
            label = self.tr("Keep {0}") if viewpoint.locked else self.tr("Release {0}")
            self._edit(label, viewpoint.id, lambda revision: edits.lock(revision, [viewpoint.id], viewpoint.locked))
            return
        if self._refuse_locked(viewpoint.id):
            return
        pose = viewpoint.position_enu_m, viewpoint.heading_deg, viewpoint.gimbal_pitch_deg
        is_turn = old.position_enu_m == viewpoint.position_enu_m
        label = self.tr("Turn {0}") if is_turn else self.tr("Move {0}")
        self._edit(label, viewpoint.id, lambda revision: edits.move(revision, viewpoint.id, *pose))

    def add_viewpoint(self, viewpoint: Viewpoint) -> None:
        """Add a viewpoint where and as another one looks; it gets an identifier of its own, and is selected."""
        active = self._active
        if active is None:
            self._refuse_all()
            return
        new_id = edits.next_id(active.plan)
        pose = viewpoint.position_enu_m, viewpoint.heading_deg, viewpoint.gimbal_pitch_deg
        if self._edit(self.tr("Add {0}"), new_id, lambda revision: edits.add(revision, *pose)):
            self._context.select(Item(ItemKind.VIEWPOINT, new_id))

    def delete_viewpoint(self, viewpoint_id: str) -> None:
        """Delete a viewpoint."""
        if not self._refuse_locked(viewpoint_id):
            self._edit(self.tr("Delete {0}"), viewpoint_id, lambda revision: edits.delete(revision, [viewpoint_id]))

    def aim(self, viewpoint_id: str, panel_id: str) -> None:
        """Turn a viewpoint towards a panel."""

        def turned(revision: Revision) -> Revision:
            view = revision.viewpoint(viewpoint_id)
            heading, pitch = edits.aim_at(revision, view.position_enu_m, panel_id)
            return edits.move(revision, viewpoint_id, None, heading, pitch)

        if not self._refuse_locked(viewpoint_id):
            self._edit(self.tr("Aim {0}"), viewpoint_id, turned)

    def _edit(self, label: str, viewpoint_id: str, edit: Callable[[Revision], Revision]) -> bool:
        active, document = self._active, self._context.document
        if active is None or document.current is None:
            self._refuse_all()
            return False
        try:
            edited = active.with_revision(edit(active.revision))
        except (GroundStationError, ValueError) as error:
            self.refused.emit(self._context.localized(str(error)))
            return False
        self._plan_cache.keep(edited.plan, edited)
        done, effect = label.format(viewpoint_id), edit_effect(active.revision, edited.revision)
        self._context.change(done, with_edited_plan(document, edited.revision))
        text = self.tr("{0}: sections gained {1}, lost {2}; flight time {3:+.0f} s").format(
            done, effect.gained, effect.lost, effect.added_s
        )
        self._context.say(Severity.NOTE, text)
        for finding in effect.problems:
            self._context.say(
                finding.severity,
                self._context.localized(finding.message),
                item_of_place(finding.place, self._context.document),
                f"plan.{finding.code}.{finding.place}",
            )
        return True

    def _refuse_locked(self, viewpoint_id: str) -> bool:
        """Whether a viewpoint is to be left alone; says so, in the words of the window."""
        entry = self._context.document.current
        viewpoint = None if entry is None else entry.viewpoint(viewpoint_id)
        if viewpoint is None or not viewpoint.locked:
            return False
        self.refused.emit(
            self.tr("{0} stays as it is: switch off “Keep in the next plan” before you change it.").format(viewpoint_id)
        )
        return True

    def _refuse_all(self) -> None:
        if self._context.document.current is None:
            self.refused.emit(self.tr("There is no plan to change; plan a flight or open a plan first."))
        else:
            self.refused.emit(self._not_taken or self.tr("The plan is still being looked at; try again in a moment."))

    def _planned(self, planned: Planned, request: PlanRequest, site: SiteModel) -> None:
        self._planning_over()
        document, plan = self._context.document, planned.plan
        if not has_same_panels(site, document.site):
            text = self.tr("The plan is not kept: it was made for “{0}”, which is no longer open.")
            self._context.say(Severity.WARNING, text.format(site.site.name))
            return
        self._plan_cache.keep_prepared(PreparedSite(planned.prepared))
        title = self.tr("{0}, {1} views").format(method_name(plan.method), len(plan.viewpoints))
        entry = PlanEntry(document.free_plan_id(), title, plan, request, planned.bound_for_views)
        self._context.change(self.tr("Plan"), document.with_plan(entry))
        self.planned.emit(entry)
        coverage = plan.coverage
        self._context.say(
            Severity.OK,
            self.tr("Views: {0}, sorties: {1}; {2} of at most {3} directions of view seen").format(
                len(plan.viewpoints), len(plan.sorties), coverage.covered, coverage.reachable_upper_bound
            ),
        )
        for finding in planned.findings:
            about = f"plan.{finding.code}.{finding.place}"
            self._context.say(finding.severity, self._context.localized(finding.message), about=about)

    def _planning_over(self) -> None:
        self._planning = None
        self._context.note(is_planning=False)
        self.planningEnded.emit()

    def _document_changed(self, before: Document, after: Document) -> None:
        plan_before = None if before.current is None else before.current.plan
        plan_after = None if after.current is None else after.current.plan
        if plan_before is not plan_after or before.site is not after.site:
            self._context.withdraw("plan.")
            self._take_current()

    def _take_current(self) -> None:
        """Activate the current plan: at once where it was before, else by a job."""
        document = self._context.document
        entry, site = document.current, document.site
        if self._activation is not None:
            self._context.cancel(self._activation, quietly=True)
            self._activation = None
        self._not_taken = ""
        if entry is None or site is None:
            self._set_active(None)
            return
        try:
            require_panels(site.site)
        except InputError as error:  # said where the plan is judged: a mission that was imported flies without them
            self._active = None
            self._give_up(self._context.localized(str(error)))
            return
        plan = entry.plan
        found = self._plan_cache.find(plan, site)
        self._set_active(found)
        if found is not None:
            return
        prepared_site = self._plan_cache.prepared_site_for(plan, site)

        def taken(active: ActivePlan) -> None:
            self._activation = None
            self._plan_cache.keep(plan, active)
            if self._is_current(plan):
                self._set_active(active)

        self._activation = self._context.start(
            self.tr("Look at the plan"),
            lambda context: activate(site, plan, prepared_site, context),
            taken,
            lambda error: self._give_up(self._context.localized(str(error))) if self._is_current(plan) else None,
        )

    def _is_current(self, plan: Plan) -> bool:
        current = self._context.document.current
        return current is not None and current.plan is plan

    def _give_up(self, why: str) -> None:
        self._activation, self._not_taken = None, why
        self.activePlanChanged.emit(None)

    def _set_active(self, active: ActivePlan | None) -> None:
        if active is not self._active:
            self._active = active
            self.activePlanChanged.emit(active)
