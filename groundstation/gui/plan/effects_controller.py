"""Finds out which effects the scene and the current plan call for, while somebody looks. It shows nothing."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject, QTimer, Signal

from groundstation.gui.application.context import ApplicationContext
from groundstation.services.jobs.runner import Job, JobContext
from groundstation.services.plan.effects import EffectChoice, SceneEffects, plan_effects, scene_effects
from groundstation.services.project.document import Document
from planning.plan import Plan

AFTER_MS = 300
"""Wishes change several times in a row while somebody types; the scene is looked at when that is over."""

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
        workspace: ApplicationContext,
        is_wanted: Callable[[], bool],
        is_planning: Callable[[], bool],
        parent: QObject,
    ) -> None:
        super().__init__(parent)
        self._workspace, self._is_wanted, self._is_planning = workspace, is_wanted, is_planning
        self._scene: SceneEffects | None = None
        self._plan: Plan | None = None
        self._job: Job[Found] | None = None
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(AFTER_MS)
        self._timer.timeout.connect(self.look)
        workspace.documentChanged.connect(self._document_changed)
        workspace.jobsChanged.connect(self._forget_ended)

    def look(self) -> None:
        """Look at the scene and the plan, unless what is known still holds."""
        document = self._workspace.document
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
            context.report("looking at the scene", 0, 1)
            scene = scene_effects(site, request) if known is None else known
            return scene, plan, scene.choices + (() if plan is None else plan_effects(plan))

        self._job = self._workspace.start(self.tr("Look at the scene"), work, self._found)

    def _found(self, found: Found) -> None:
        scene, plan, choices = found
        if scene.site_model is self._workspace.document.site:
            self._scene, self._plan = scene, plan
            self.effectsChanged.emit(choices)
        self.look()

    def _forget_ended(self) -> None:
        """Also a job that failed or was cancelled is over."""
        if self._job is not None and self._job not in self._workspace.jobs():
            self._job = None

    def _document_changed(self, before: Document, after: Document) -> None:
        if before.site is not after.site:
            self._scene = None
            self.effectsChanged.emit(())
        if self._is_wanted():
            self._timer.start()


def _plan_of(document: Document) -> Plan | None:
    return None if document.current is None else document.current.plan
