"""Terrain for the site that is open: files of heights, what they do not say themselves, and what came of them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import cast

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QCheckBox, QDialog, QHBoxLayout, QLabel, QPlainTextEdit, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.widgets.inputs import ChoiceBox, Form, LengthBox
from groundstation.gui.widgets.job_bar import DialogFoot
from groundstation.gui.widgets.questions import choose_files
from groundstation.gui.widgets.scrolling import ButtonGrid, resize_on_screen, scrolled
from groundstation.gui.widgets.value_boxes import ErrorLine, NameBox, muted
from groundstation.services.jobs.runner import Job, JobContext
from groundstation.services.site.terrain import attached_facts
from groundstation.services.units import UnitSystem, length_unit
from planning.base.errors import InputError
from planning.base.findings import Severity
from planning.site.importing.attach_terrain import Attached, TerrainRequest, attach_terrain, without_terrain
from planning.site.importing.elevation import HEIGHT_FILES, HeightOptions, HeightUnit
from planning.site.importing.geoid_file import GEOID_FILES
from planning.site.records import SiteModel

OTHER = "other"
HEIGHT_SYSTEM, COORDINATE_SYSTEM = "EPSG:7837", "EPSG:25832"
"""Shown where a code may stand."""

STEPS_M = (0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0)
ACCURACIES_M = (0.0, 0.25, 0.5, 1.0, 2.0, 4.0, 9.0, 16.0)
WIDTH_PX, HEIGHT_PX, NOTES_HEIGHT_PX = 620, 700, 100


class FilesBox(QWidget):
    """Some files, by their names.

    Signals
    -------
    valueChanged(tuple of Path)
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, title: str, endings: tuple[str, ...] = HEIGHT_FILES, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._endings = endings
        self._title, self._files = title, tuple[Path, ...]()
        self._names = QLabel()
        self._names.setWordWrap(True)
        self.choose, self.clear = QPushButton(self.tr("Choose...")), QPushButton(self.tr("None"))
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._names, 1)
        layout.addWidget(self.choose)
        layout.addWidget(self.clear)
        self.choose.clicked.connect(self._ask)
        self.clear.clicked.connect(lambda: self.setValue(()))
        self.setValue(())

    def value(self) -> tuple[Path, ...]:
        """The files."""
        return self._files

    def setValue(self, files: tuple[Path, ...]) -> None:  # noqa: N802
        """Show files."""
        self._files = files
        self._names.setText(", ".join(path.name for path in files) or self.tr("no file"))
        self.clear.setVisible(bool(files))
        self.valueChanged.emit(files)

    def _ask(self) -> None:
        kinds = " ".join(f"*{ending}" for ending in self._endings)
        folder = self._files[0].parent if self._files else Path.home()
        files = choose_files(self.window(), self._title, self.tr("Heights ({0});;All files (*)").format(kinds), folder)
        if files:
            self.setValue(files)


class TerrainForm(QWidget):
    """Edits one `TerrainRequest`.

    Signals
    -------
    valueChanged(TerrainRequest)
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        length = length_unit(units)
        self.ground, self.surface = FilesBox(self.tr("Heights of the ground")), FilesBox(self.tr("Heights with trees"))
        self.vertical, self.unit, self.step, self.accuracy = ChoiceBox(), ChoiceBox(), ChoiceBox(), ChoiceBox()
        self.geoid = FilesBox(self.tr("Grid of the geoid"), GEOID_FILES)
        self.geoid.setToolTip(
            self.tr("EGM2008 of GeographicLib (.pgm) or PROJ (.gtx, .tif); without one EGM96 stands in")
        )
        self.system, self.crs = NameBox(), NameBox()
        for text, value in (
            (self.tr("As the files say"), ""),
            (self.tr("Sea level, EGM96"), "egm96"),
            (self.tr("Sea level, EGM2008"), "egm2008"),
            (self.tr("The ellipsoid"), "ellipsoid"),
            (self.tr("A national height system"), OTHER),
        ):
            self.vertical.addItem(text, value)
        for text, value in (
            (self.tr("As the files say"), "auto"),
            (self.tr("metres"), "m"),
            (self.tr("feet"), "ft"),
            (self.tr("US survey feet"), "us-ft"),
        ):
            self.unit.addItem(text, value)
        self.step.addItem(self.tr("As fine as the files"), None)
        for step_m in STEPS_M:
            self.step.addItem(length.text(step_m), step_m)
        self.accuracy.addItem(self.tr("As known of the files"), None)
        for accuracy_m in ACCURACIES_M:
            self.accuracy.addItem(length.text(accuracy_m), accuracy_m)
        self.accuracy.setToolTip(self.tr("How far the ground may lie off the files' heights; kept on top of them"))
        self.system.setPlaceholderText(HEIGHT_SYSTEM)
        self.crs.setPlaceholderText(COORDINATE_SYSTEM)
        self.taller = LengthBox(0.5, 50.0, 0.5, units)
        self.taller.setValue(TerrainRequest(()).taller_than_m)
        self.to_home = QCheckBox(self.tr("Shift the terrain up or down to home"))
        self._form = Form(self)
        self._form.setContentsMargins(0, 0, 0, 0)
        self._form.addRow(self.tr("Ground"), self.ground)
        self._form.addRow(self.tr("Surface with trees"), self.surface)
        self._form.addRow(self.tr("Obstacles taller than"), self.taller)
        self._form.addRow(self.tr("Heights are above"), self.vertical)
        self._form.addRow(self.tr("Code of the system"), self.system)
        self._form.addRow(self.tr("Grid of the geoid"), self.geoid)
        self._form.addRow(self.tr("Unit of heights"), self.unit)
        self._form.addRow(self.tr("Coordinate system"), self.crs)
        self._form.addRow(self.tr("Step of the grid"), self.step)
        self._form.addRow(self.tr("Accuracy"), self.accuracy)
        self._form.addRow(self.to_home)
        for files in (self.ground, self.surface, self.geoid):
            files.valueChanged.connect(self._edited)
        self.vertical.currentIndexChanged.connect(self._edited)
        self._edited()

    def value(self) -> TerrainRequest:
        """What is to be attached."""
        vertical = self.vertical.currentData()
        return TerrainRequest(
            ground=self.ground.value(),
            surface=self.surface.value(),
            options=HeightOptions(
                self.crs.value().strip() or None,
                (self.system.value().strip() if vertical == OTHER else vertical) or None,
                cast("HeightUnit", self.unit.currentData()),
                next(iter(self.geoid.value()), None),
            ),
            step_m=self.step.currentData(),
            accuracy_m=self.accuracy.currentData(),
            shift_m="home" if self.to_home.isChecked() else 0.0,
            taller_than_m=self.taller.value(),
        )

    def _edited(self, _value: object = None) -> None:
        self._form.setRowVisible(self.taller, bool(self.surface.value()))
        self._form.setRowVisible(self.geoid, self.vertical.currentData() != "ellipsoid")
        self._form.setRowVisible(self.system, self.vertical.currentData() == OTHER)
        self.valueChanged.emit(self.value())


class TerrainDialog(QDialog):
    """Attaches terrain to the open site, or takes it off; each is one step that can be undone."""

    def __init__(self, context: ApplicationContext, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._context = context
        self._job: Job[Attached | InputError] | None = None
        self.setWindowTitle(self.tr("Terrain"))
        self.form, self.error = TerrainForm(context.units), ErrorLine()
        self.found, self.notes = QLabel(), QPlainTextEdit()
        self.found.setWordWrap(True)
        self.notes.setReadOnly(True)
        self.notes.setFixedHeight(NOTES_HEIGHT_PX)
        self.notes.setVisible(False)
        self.attach, self.remove = QPushButton(self.tr("Attach terrain")), QPushButton(self.tr("Take terrain off"))
        self.attach.setProperty("primary", True)
        self.attach.setDefault(True)
        self._close = QPushButton(self.tr("Close"))
        buttons = ButtonGrid()
        for button in (self.attach, self.remove, self._close):
            buttons.addWidget(button)
        upper = QWidget()
        column = QVBoxLayout(upper)
        column.addWidget(
            muted(
                self.tr(
                    "Heights above the ground count from the terrain, home is put on it, and where it has no heights "
                    "nothing is planned. Trees and neighbours of a surface become obstacles."
                )
            )
        )
        column.addWidget(self.form)
        column.addStretch(1)
        layout = QVBoxLayout(self)
        layout.addWidget(scrolled(upper), 1)
        for widget in (self.found, self.error, self.notes, DialogFoot(context)):
            layout.addWidget(widget)
        layout.addLayout(buttons)
        self.attach.clicked.connect(self._attach)
        self.remove.clicked.connect(self._remove)
        self._close.clicked.connect(self.reject)
        self.form.valueChanged.connect(self._show_buttons)
        resize_on_screen(self, WIDTH_PX, HEIGHT_PX)
        self._show_buttons()

    def done(self, result: int) -> None:
        """Stop reading files."""
        if self._job is not None:
            self._context.cancel(self._job, quietly=True)
            self._job = None
        super().done(result)

    def _show_buttons(self, _request: object = None) -> None:
        model = self._context.document.site
        self.attach.setEnabled(self._job is None and model is not None and bool(self.form.value().ground))
        self.remove.setEnabled(self._job is None and model is not None and model.site.terrain is not None)

    def _attach(self) -> None:
        model, request = self._context.document.site, self.form.value()
        if model is None:
            return
        self.error.show_error("")
        self.notes.setVisible(False)
        self.found.setText(self.tr("Reading heights ..."))

        def work(context: JobContext) -> Attached | InputError:
            try:
                return attach_terrain(model, request, "terrain", context)
            except InputError as error:  # an answer for this dialog, not a failure for the message area
                return error

        self._job = self._context.start(
            self.tr("Attach terrain"), work, lambda found: self._done(model, found), lambda _error: self._ended()
        )
        self._show_buttons()

    def _done(self, before: SiteModel, found: Attached | InputError) -> None:
        self._ended()
        if isinstance(found, InputError):
            self.error.show_error(self._context.localized(str(found)))
            return
        if self._context.document.site is not before:
            self.error.show_error(self.tr("The site was changed meanwhile: attach the terrain again."))
            return
        self._take(self.tr("Attach terrain"), found.model)
        self.found.setText("\n".join(map(self._context.localized, attached_facts(found))))
        self.notes.setPlainText("\n".join("• " + self._context.localized(note) for note in found.notes))
        self.notes.setVisible(bool(found.notes))

    def _remove(self) -> None:
        model = self._context.document.site
        if model is not None:
            self._take(self.tr("Take terrain off"), without_terrain(model))
            self.found.setText(self.tr("The ground is level again."))
            self.notes.setVisible(False)

    def _take(self, label: str, model: SiteModel) -> None:
        self._context.change(label, replace(self._context.document, site=model))
        self._context.say(Severity.OK, label)
        self._show_buttons()

    def _ended(self) -> None:
        self._job = None
        self.found.setText("")
        self._show_buttons()
