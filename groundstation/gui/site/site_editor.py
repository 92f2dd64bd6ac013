"""Takes the user's edits to the document, one step of Undo each, and has the site checked after them."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QObject, QTimer, Signal

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.site.pages import Edit
from groundstation.services.jobs.runner import ENDED, Job
from groundstation.services.project.document import Document, Item
from groundstation.services.site.edits import flip_facade, remove_item
from groundstation.services.site.findings import site_findings
from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.site.records import SiteModel

CHECK_AFTER_MS = 300
"""After the last edit: several in a row, as with the arrows of a box, are checked once."""


class SiteEditor(QObject):
    """Edits of the site that is open.

    Signals
    -------
    findingsChanged(tuple of Finding or None)
        What the last check found; None while the site as it is was not checked.
    """

    findingsChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, context: ApplicationContext, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._context = context
        self._job: Job[tuple[Finding, ...]] | None = None
        self._checked: tuple[SiteModel | None, float] = (None, 0.0)
        self._is_active = False
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(CHECK_AFTER_MS)
        self._timer.timeout.connect(self._check)
        context.documentChanged.connect(self._document_changed)

    def set_active(self, active: bool) -> None:
        """Check the site after edits from now on, or no longer."""
        self._is_active = active
        if active:
            self._timer.start()

    def apply(self, label: str, edit: Edit, select: Item | None = None) -> str:
        """Make an edit; returns why it cannot be made, in the user's words, or an empty text."""
        document = self._context.document
        if document.site is None:
            return ""
        try:
            model = edit(document.site)
        except InputError as error:
            return self._context.localized(str(error))
        if model is not document.site:
            self._context.change(label, replace(document, site=model))
        if select is not None:
            self._context.select(select)
        return ""

    def remove(self, item: Item) -> None:
        """Remove a thing; tells where it cannot be."""
        self._apply_or_say(self.tr("Delete {0}").format(item.id), lambda model: remove_item(model, item))

    def flip(self, item: Item) -> None:
        """Turn a facade to its other side."""
        self._apply_or_say(self.tr("Turn facade {0}").format(item.id), lambda model: flip_facade(model, item.id))

    def _apply_or_say(self, label: str, edit: Edit) -> None:
        error = self.apply(label, edit)
        if error:
            self._context.say(Severity.ERROR, f"{label}: {error}")

    def _document_changed(self, before: Document, after: Document) -> None:
        if after.site is not before.site:
            self.findingsChanged.emit(None)
            if self._is_active:
                self._timer.start()

    def _to_check(self) -> tuple[SiteModel | None, float]:
        """The site, and the distance that the next plan is to keep."""
        document = self._context.document
        return document.site, document.request.constraints.min_distance_m

    def _is_checking(self) -> bool:
        return self._job is not None and self._job.state not in ENDED

    def _check(self) -> None:
        wanted = model, distance_m = self._to_check()
        if model is None or wanted == self._checked or self._is_checking():
            return

        def checked(findings: tuple[Finding, ...]) -> None:
            if self._to_check() == wanted:
                self._checked = wanted
                self.findingsChanged.emit(findings)
            elif self._is_active:
                self._timer.start()

        self._job = self._context.start(
            self.tr("Check the site"), lambda context: site_findings(model, distance_m, context), checked
        )
