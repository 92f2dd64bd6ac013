"""The flight brief on screen, to be printed or saved as PDF."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QDate, QLocale
from PySide6.QtGui import QImage
from PySide6.QtWidgets import (
    QDialog,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QTextBrowser,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.application.translate import translated_finding
from groundstation.gui.mission.brief_printer import (
    BriefDocument,
    page_size,
    painted_map,
    print_pages,
    translate,
    write_pdf,
)
from groundstation.gui.widgets.inputs import ChoiceBox
from groundstation.gui.widgets.job_bar import DialogFoot
from groundstation.gui.widgets.questions import choose_new_file, file_name
from groundstation.services.jobs.runner import JobContext
from groundstation.services.map.shapes import plan_shapes, site_shapes
from groundstation.services.mission.brief import flight_brief
from groundstation.services.mission.brief_html import MAP, brief_html, brief_pictures
from groundstation.services.mission.readiness import Preflight
from groundstation.services.units import UnitSystem
from planning.base.errors import InputError
from planning.base.findings import Severity
from planning.plan import Plan
from planning.site.records import SiteModel


class BriefDialog(QDialog):
    """The brief of a plan that was checked; `tiles` is the map file that lies under its map."""

    def __init__(
        self,
        workspace: ApplicationContext,
        checked: Preflight,
        tiles: Path | None,
        folder: Path,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self._is_closed = False
        self.finished.connect(self._let_go)
        self.setWindowTitle(self.tr("Flight brief"))
        plan, site_model = checked.plan, checked.site_model
        self._workspace, self._folder, self._name = workspace, folder, site_model.site.name
        self._units = workspace.units
        self._html = ""
        self._pictures: dict[str, str | QImage] = {}
        self._document: BriefDocument | None = None
        entry = workspace.document.current
        today = QLocale().toString(QDate.currentDate(), QLocale.FormatType.LongFormat)
        title = entry.title if entry is not None and entry.plan is plan else ""
        found = flight_brief(site_model, plan, checked.findings, today, title, day=checked.day)
        told = tuple(translated_finding(finding, self._units) for finding in found.findings)
        self._brief = replace(found, findings=told)
        self._page, self._paper = QTextBrowser(), ChoiceBox()
        # Paper is white in every theme.
        self._page.setStyleSheet("QTextBrowser { background: #ffffff; color: #000000; }")
        self._paper.addItem(self.tr("A4"), False)
        self._paper.addItem(self.tr("US Letter"), True)
        self._paper.setCurrentIndex(int(is_letter_usual(workspace.units)))
        self._save = QPushButton(self.tr("Save as PDF ..."))
        self._save.setProperty("primary", True)
        self._print = QPushButton(self.tr("Print ..."))
        close = QPushButton(self.tr("Close"))
        bar = QHBoxLayout()
        bar.addWidget(QLabel(self.tr("Paper")))
        bar.addWidget(self._paper)
        bar.addStretch(1)
        for button in (close, self._print, self._save):
            bar.addWidget(button)
        layout = QVBoxLayout(self)
        layout.addWidget(self._page, 1)
        layout.addWidget(DialogFoot(workspace))
        layout.addLayout(bar)
        self.resize(760, 620)
        self._paper.currentIndexChanged.connect(self._lay_out)
        self._save.clicked.connect(self._choose_pdf)
        self._print.clicked.connect(self._choose_printer)
        close.clicked.connect(self.reject)
        self._set_ready(False)
        self._page.setPlainText(self.tr("Drawing the map and the profiles ..."))
        self._draw(site_model, plan, tiles)

    def is_ready(self) -> bool:
        """Whether the brief is laid out."""
        return self._document is not None

    def page_text(self) -> str:
        """What the page says."""
        return self._page.toPlainText()

    def save_pdf(self, path: Path) -> bool:
        """Write the brief; False where that is not possible, which is told."""
        try:
            write_pdf(self._fresh(), path, bool(self._paper.currentData()))
        except InputError as error:
            self._workspace.say(Severity.ERROR, self._workspace.words(str(error)))
            return False
        self._workspace.say(Severity.OK, self.tr("Written: {0}").format(path))
        return True

    def _draw(self, site_model: SiteModel, plan: Plan, tiles: Path | None) -> None:
        units = self._units

        def work(_context: JobContext) -> tuple[dict[str, str | QImage], str]:
            pictures: dict[str, str | QImage] = {**brief_pictures(site_model, plan, units, translate)}
            try:
                if tiles is not None:
                    shapes = site_shapes(site_model), plan_shapes(plan, site_model.site.origin)
                    pictures[MAP] = painted_map(*shapes, tiles, units)
            except InputError as error:
                return pictures, str(error)
            return pictures, ""

        self._workspace.start(self.tr("Flight brief"), work, self._when_drawn)

    def _when_drawn(self, result: tuple[dict[str, str | QImage], str]) -> None:
        if self._is_closed:
            return
        self._pictures, objection = result
        if objection:
            self._workspace.say(Severity.WARNING, self._workspace.words(objection))
        self._lay_out()

    def _let_go(self) -> None:
        """Closed: nothing more is drawn, and nothing is left in the window."""
        self._is_closed = True
        self.deleteLater()

    def _lay_out(self) -> None:
        if not self._pictures:
            return
        names = {name: name for name in self._pictures}
        is_letter = bool(self._paper.currentData())
        self._html = brief_html(self._brief, self._units, names, translate, is_letter=is_letter)
        self._document = self._fresh()
        self._document.setDocumentMargin(12.0)
        self._page.setDocument(self._document)
        self._set_ready(True)

    def _fresh(self) -> BriefDocument:
        """A document for one device: a layout for paper does not fit the screen."""
        return BriefDocument(self._html, self._pictures)

    def _set_ready(self, is_ready: bool) -> None:
        for button in (self._save, self._print):
            button.setEnabled(is_ready)

    def _choose_pdf(self) -> None:
        proposed, kinds = self._folder / f"{file_name(self._name)}.pdf", self.tr("PDF (*.pdf)")
        path = choose_new_file(self, self.tr("Save the flight brief"), proposed, kinds, ".pdf")
        if path is not None:
            self.save_pdf(path)

    def _choose_printer(self) -> None:
        from PySide6.QtPrintSupport import QPrintDialog, QPrinter

        printer = QPrinter(QPrinter.PrinterMode.HighResolution)
        printer.setPageSize(page_size(bool(self._paper.currentData())))
        if QPrintDialog(printer, self).exec() == QDialog.DialogCode.Accepted:
            try:
                print_pages(self._fresh(), printer, printer.printerName())
            except InputError as error:
                self._workspace.say(Severity.ERROR, self._workspace.words(str(error)))


def is_letter_usual(units: UnitSystem) -> bool:
    """Whether people who read these units here print on US Letter."""
    usual = QLocale().measurementSystem() == QLocale.MeasurementSystem.ImperialUSSystem
    return usual or units is UnitSystem.IMPERIAL
