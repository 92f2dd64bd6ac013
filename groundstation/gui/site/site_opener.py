"""Brings a site into the document: from a site file, from the sites that come with the program, or by import."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import cast

import numpy as np
from PySide6.QtCore import QCoreApplication, QLocale, QObject, Qt, Signal
from PySide6.QtGui import QAction, QDoubleValidator
from PySide6.QtWidgets import (
    QComboBox,
    QDialog,
    QHBoxLayout,
    QLabel,
    QMenu,
    QPlainTextEdit,
    QPushButton,
    QSplitter,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.site.grid_form import GridForm, GridRequest
from groundstation.gui.site.pages import OriginBox
from groundstation.gui.site.site_tree import size_text
from groundstation.gui.view3d.drawables import Layer
from groundstation.gui.view3d.drawing_tools import PickedRectangle, RectangleTool
from groundstation.gui.view3d.scene_view import SceneView
from groundstation.gui.widgets.inputs import ChoiceBox, Form, LengthBox
from groundstation.gui.widgets.job_bar import DialogFoot
from groundstation.gui.widgets.questions import choose_file
from groundstation.gui.widgets.scrolling import scrolled
from groundstation.gui.widgets.value_boxes import ErrorLine, NameBox
from groundstation.services.jobs.runner import Job, JobContext, JobProgress
from groundstation.services.project.folder import facades_beside
from groundstation.services.site.edits import height_above_sea_m
from groundstation.services.site.sources import (
    ImportPreview,
    SiteSummary,
    bundled_site,
    grid_in_file,
    holds_many_buildings,
    open_site,
    preview_import,
    shown_site,
    site_summary,
    with_new_site,
)
from groundstation.services.units import UnitSystem, area_unit, length_unit
from planning.base.errors import InputError
from planning.base.findings import Severity
from planning.base.messages import without_place
from planning.geo.crs import AxisOrder, HeightReference
from planning.geo.frames import Origin
from planning.geo.mesh import MESH_SUFFIXES
from planning.site.bundled import SCENES, Rectangle
from planning.site.importing.importer import SUFFIXES
from planning.site.importing.options import UNITS_M, ImportOptions
from planning.site.importing.panel_grid import PanelGridError, panels_on_building
from planning.site.importing.source import BuildingChoice
from planning.site.records import SiteModel
from reconstruction.panels.solving.accuracy import FoundFacades

# The import dialog: options on the left, what would come of them on the right, nothing taken over before "Import".

# What the user may say about an import: only what matters for the file's format.

FILE_SAYS, ZERO_POINT, SYSTEM = "file", "zero", "system"

MARGIN_M = (5.0, 500.0)
"""Least and largest distance of the airspace's sides from the building."""


class ImportForm(QWidget):
    """Edits one `ImportOptions`, but for the panel grids, which are kept as they were set.

    Signals
    -------
    valueChanged(ImportOptions)
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, path: Path, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._units = units
        self._rest = ImportOptions()
        self._has_map = holds_many_buildings(path)
        is_mesh = path.suffix.lower() in MESH_SUFFIXES
        self._building = _combo((("", self.tr("As the file suggests")),))
        self._building.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self._name, self._crs = NameBox(), NameBox()
        self._name.setPlaceholderText(self.tr("as the file says"))
        self._crs.setPlaceholderText("EPSG:25832")
        self._unit = _combo((name, name) for name in UNITS_M)
        self._up = _combo((("", self.tr("As usual for the format")), ("z", "z"), ("y", "y")))
        places = ((ZERO_POINT, self.tr("Site origin")), (SYSTEM, self.tr("Coordinate system")))
        self._place = _combo(places if is_mesh else ((FILE_SAYS, self.tr("As the file says")), *places))
        self._origin = OriginBox(units)
        self._has_origin = False
        self._axis_order = _combo(
            (("auto", self.tr("Found out")), ("xy", self.tr("East first")), ("yx", self.tr("North first")))
        )
        self._heights = _combo(
            (
                ("auto", self.tr("As the system says")),
                ("orthometric", self.tr("Above sea level")),
                ("ellipsoid", self.tr("Above the ellipsoid")),
            )
        )
        self._ground = NameBox()
        self._ground.setPlaceholderText(self.tr("found around the building"))
        self._ground.setValidator(_numbers(self._ground))
        self._margin = LengthBox(*MARGIN_M, 5.0, units)
        self._lay_out(is_mesh)
        self._connect()
        self.setValue(ImportOptions())

    def _lay_out(self, is_mesh: bool) -> None:
        self._form = Form(self)
        self._form.setContentsMargins(0, 0, 0, 0)
        if self._has_map:
            self._form.addRow(self.tr("Building"), self._building)
        if is_mesh:
            self._form.addRow(self.tr("Unit of lengths"), self._unit)
            self._form.addRow(self.tr("Axis that points up"), self._up)
        self._form.addRow(self.tr("Place on earth"), self._place)
        self._form.addRow(self._origin)
        self._form.addRow(self.tr("Code of the system"), self._crs)
        self._form.addRow(self.tr("Order of coordinates"), self._axis_order)
        self._form.addRow(self.tr("Heights are"), self._heights)
        self._form.addRow(self.tr("Height of the ground in the file"), self._ground)
        self._form.addRow(self.tr("Airspace around the building"), self._margin)
        self._form.addRow(self.tr("Name of the site"), self._name)

    def _connect(self) -> None:
        for box in (self._building, self._unit, self._up, self._place, self._axis_order, self._heights):
            box.activated.connect(self._edited)
        for edit in (self._name, self._crs, self._ground, self._margin):
            edit.valueChanged.connect(self._edited)
        self._origin.valueChanged.connect(self._origin_edited)

    def value(self) -> ImportOptions:
        """The options."""
        place = self._place.currentData()
        return replace(
            self._rest,
            name=self._name.value().strip() or None,
            origin=self._origin.value() if place == ZERO_POINT and self._has_origin else None,
            crs=(self._crs.value().strip() or None) if place == SYSTEM else None,
            axis_order=cast("AxisOrder", self._axis_order.currentData()),
            height_reference=cast("HeightReference", "auto" if place == ZERO_POINT else self._heights.currentData()),
            up=self._up.currentData() or None,
            unit=self._unit.currentData(),
            building=self._building.currentData() or None,
            ground_z=_number(self._ground.value()),
            airspace_margin_m=self._margin.value(),
        )

    def setValue(self, options: ImportOptions) -> None:  # noqa: N802
        """Show options."""
        self._rest = options
        self._name.setValue(options.name or "")
        self._crs.setValue(options.crs or "")
        self._ground.setValue("" if options.ground_z is None else repr(float(options.ground_z)))
        self._margin.setValue(options.airspace_margin_m)
        self._has_origin = options.origin is not None
        if options.origin is not None:
            self._origin.setValue(options.origin)
        place = ZERO_POINT if options.origin is not None else SYSTEM if options.crs is not None else FILE_SAYS
        for choice, wanted in (
            (self._unit, options.unit),
            (self._up, options.up or ""),
            (self._building, options.building or ""),
            (self._axis_order, options.axis_order),
            (self._heights, options.height_reference),
        ):
            choice.show_value(wanted)
        # A mesh says nothing itself.
        self._place.setCurrentIndex(max(0, self._place.findData(place)))
        self._show_place()

    def set_choices(self, choices: tuple[BuildingChoice, ...]) -> None:
        """List the buildings of the file, those with most windows first, then the highest."""
        chosen = self._building.currentData()
        while self._building.count() > 1:
            self._building.removeItem(1)
        for choice in sorted(choices, key=lambda found: (-found.n_windows, -found.size_m[2])):
            text = self.tr("{0}: windows {1}, {2}").format(
                choice.name or choice.id, choice.n_windows, size_text(list(choice.size_m), self._units)
            )
            self._building.addItem(text, choice.id)
        self._building.setCurrentIndex(max(0, self._building.findData(chosen)))

    def origin_box(self) -> OriginBox:
        """Editor of the zero point; there is none until the user has put one in."""
        return self._origin

    def _origin_edited(self, origin: object) -> None:
        self._has_origin = True
        self._edited(origin)

    def _edited(self, _value: object) -> None:
        self._show_place()
        self.valueChanged.emit(self.value())

    def _show_place(self) -> None:
        place = self._place.currentData()
        self._form.setRowVisible(self._origin, place == ZERO_POINT)
        self._form.setRowVisible(self._crs, place == SYSTEM)
        # City models come in coordinates of a map; other files have such only where the user names the system.
        self._form.setRowVisible(self._axis_order, place == SYSTEM or (place == FILE_SAYS and self._has_map))
        self._form.setRowVisible(self._heights, place != ZERO_POINT)


def _numbers(parent: QWidget) -> QDoubleValidator:
    """Lets numbers through, with a decimal point as in all texts of the window."""
    validator = QDoubleValidator(parent)
    validator.setLocale(QLocale.c())
    return validator


def _number(text: str) -> float | None:
    return float(text) if text.strip() else None


def _combo(entries: Iterable[tuple[str, str]]) -> ChoiceBox:
    """Box to choose from (value, text) pairs."""
    box = ChoiceBox()
    for value, text in entries:
        box.addItem(text, value)
    return box


# What the import dialog says about a preview.

MAX_LISTED = 8
"""Facades listed one by one."""


def preview_text(model: SiteModel, units: UnitSystem) -> str:
    """Panels by facade, size, and place on earth, a line each."""
    summary = site_summary(model)
    size = QCoreApplication.translate("ImportTexts", "Size {0} (east × north × up); triangles: {1}").format(
        size_text(list(summary.size_m), units), summary.n_triangles
    )
    return "\n".join((_panels_text(summary, units), size, place_text(model.site.origin, units)))


def place_text(origin: Origin, units: UnitSystem) -> str:
    """A place with its height in both references."""
    unit = length_unit(units)
    return QCoreApplication.translate(
        "ImportTexts", "Zero at {0:.6f}°, {1:.6f}°, {2} above the ellipsoid, {3} above sea level (EGM96)"
    ).format(
        origin.lat_deg,
        origin.lon_deg,
        unit.text(origin.ellipsoid_height_m),
        unit.text(height_above_sea_m(origin)),
    )


def _panels_text(summary: SiteSummary, units: UnitSystem) -> str:
    if summary.n_panels == 0:
        return QCoreApplication.translate(
            "ImportTexts", "No panels yet: find them in photos after the import, or pick a facade grid here."
        )
    listed = ", ".join(f"{facade.id} {facade.n_panels}" for facade in summary.facades[:MAX_LISTED])
    if len(summary.facades) > MAX_LISTED:
        more = QCoreApplication.translate("ImportTexts", "{0} smaller ones")
        listed += ", " + more.format(len(summary.facades) - MAX_LISTED)
    return QCoreApplication.translate("ImportTexts", "Panels: {0}, {1} of glass; by facade: {2}").format(
        summary.n_panels, area_unit(units).text(summary.area_m2), listed
    )


FORM_WIDTH_PX = 340
NOTES_HEIGHT_PX = 130


class ImportDialog(QDialog):
    """Looks at a file before it becomes the site.

    Signals
    -------
    imported(SiteModel)
        The user took the site over; the dialog is closed.
    """

    imported = Signal(object)

    def __init__(self, context: ApplicationContext, path: Path, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._context, self._path = context, path
        self._job: Job[ImportPreview | InputError] | None = None
        self._preview: ImportPreview | None = None
        self._is_done = False
        self.setWindowTitle(self.tr("Import {0}").format(path.name))
        self.form = ImportForm(path, context.units)
        self.grid = GridForm(context.units)
        self.grid.set_words(self.tr("Use these panels"), self.tr("Clear"))
        self.scene = SceneView(self)
        self.scene.set_units(context.units)
        self._summary, self._error = QLabel(), ErrorLine()
        self._summary.setWordWrap(True)
        self._notes = QPlainTextEdit()
        self._notes.setReadOnly(True)
        self._notes.setFixedHeight(NOTES_HEIGHT_PX)
        self._again = QPushButton(self.tr("Preview again"))
        self._accept = QPushButton(self.tr("Import"))
        self._accept.setDefault(True)
        self._accept.setProperty("primary", True)
        self._cancel = QPushButton(self.tr("Cancel"))
        self._lay_out()
        self._connect()
        self.resize(1180, 660)
        self.preview()

    def _lay_out(self) -> None:
        left = QWidget()
        column = QVBoxLayout(left)
        column.addWidget(self.form)
        heading = QLabel(self.tr("Facade grid"))
        heading.setProperty("role", "heading")
        column.addWidget(heading)
        column.addWidget(self.grid)
        column.addStretch(1)
        area = scrolled(left)
        area.setMinimumWidth(FORM_WIDTH_PX)
        right = QWidget()
        column = QVBoxLayout(right)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.scene, 1)
        for widget in (self._summary, self._error, self._notes):
            column.addWidget(widget)
        splitter = QSplitter(Qt.Orientation.Horizontal)
        splitter.addWidget(area)
        splitter.addWidget(right)
        splitter.setStretchFactor(1, 1)
        splitter.setChildrenCollapsible(False)
        buttons = QHBoxLayout()
        buttons.addWidget(self._again)
        buttons.addStretch(1)
        buttons.addWidget(self._accept)
        buttons.addWidget(self._cancel)
        layout = QVBoxLayout(self)
        layout.addWidget(splitter, 1)
        layout.addWidget(DialogFoot(self._context))
        layout.addLayout(buttons)

    def _connect(self) -> None:
        self.form.valueChanged.connect(self._options_changed)
        self._again.clicked.connect(self.preview)
        self._accept.clicked.connect(self.accept)
        self._cancel.clicked.connect(self.reject)
        self.grid.valueChanged.connect(self._check_grid)
        self.grid.pickRequested.connect(self._pick)
        self.grid.accepted.connect(self._use_grid)
        self.grid.cancelled.connect(self._clear_grids)
        self.scene.toolFinished.connect(self._picked)
        self._context.bridge.progressed.connect(self._show_progress)

    def preview(self) -> None:
        """Import into memory with the options as they are, and show what comes of it."""
        self._stop_job()
        path, options = self._path, self.form.value()
        self._say(self.tr("Reading {0} ...").format(path.name))
        self._error.show_error("")
        self._accept.setEnabled(False)

        def work(context: JobContext) -> ImportPreview | InputError:
            try:
                return preview_import(path, options, context)
            except InputError as error:  # an answer for this dialog, not a failure for the message area
                return error

        self._job = self._context.start(
            self.tr("Preview {0}").format(path.name), work, self._show_result, lambda _error: self._failed()
        )

    def is_busy(self) -> bool:
        """Whether the file is being read."""
        return self._job is not None

    def shown(self) -> ImportPreview | None:
        """The preview that is shown; None while there is none."""
        return self._preview

    def can_import(self) -> bool:
        """Whether what is shown can be taken over."""
        return self._accept.isEnabled()

    def error(self) -> str:
        """Why nothing can be taken over."""
        return self._error.text()

    def accept(self) -> None:
        """Take the site over, where what is shown is what the options say."""
        if self._preview is None or self._preview.model is None or not self.can_import():
            return
        model = self._preview.model
        super().accept()
        self.imported.emit(model)

    def done(self, result: int) -> None:
        """Stop reading, and free the view; asked again, there is nothing left to do."""
        if not self._is_done:
            self._is_done = True
            self._stop_job()
            self.scene.close_view()
        super().done(result)

    def _stop_job(self) -> None:
        if self._job is not None:
            self._context.cancel(self._job, quietly=True)
            self._job = None

    def _failed(self) -> None:
        self._job = None
        self._say(self.tr("Reading failed; the reason stands below."))

    def _show_progress(self, event: JobProgress) -> None:
        if self._job is not None and event.job_id == self._job.id:
            self._say(self.tr("Reading {0}: {1} ...").format(self._path.name, self._context.localized(event.stage)))

    def _show_result(self, result: ImportPreview | InputError) -> None:
        self._job = None
        if self._is_done:
            return
        if isinstance(result, InputError):
            self._preview = None
            self._say("")
            self._notes.setPlainText("")
            self._error.show_error(self._words(str(result)))
            self.scene.set_site(None)
            return
        has_same_view = self._preview is not None and _without_grids(self._preview) == _without_grids(result)
        self._preview = result
        self.form.set_choices(result.source.choices)
        self.scene.set_site(shown_site(result), keep_camera=has_same_view)
        for layer in (Layer.HOME, Layer.AIRSPACE, Layer.LABELS):
            self.scene.set_layer_visible(layer, result.model is not None)
        self._notes.setPlainText("\n".join("• " + self._words(note) for note in result.notes))
        self._error.show_error(self._words(result.problem))
        self._accept.setEnabled(result.model is not None)
        self._say("" if result.model is None else preview_text(result.model, self._context.units))

    def _options_changed(self, _options: ImportOptions) -> None:
        self._accept.setEnabled(False)
        self._error.show_error(self.tr("The options were changed: press “Preview again”."))

    def _say(self, text: str) -> None:
        self._summary.setText(text)
        self._summary.setVisible(bool(text))

    def _words(self, text: str) -> str:
        """A message of the import in words of the window, without the folder."""
        return self._context.localized(without_place(text, self._path))

    def _pick(self) -> None:
        request = self.grid.value()
        self.scene.start_tool(RectangleTool(request.n_rows, request.n_columns))

    def _picked(self, picked: PickedRectangle) -> None:
        self.grid.set_rectangle((picked.lower_left_enu_m, picked.lower_right_enu_m, picked.upper_left_enu_m))

    def _check_grid(self, request: GridRequest) -> None:
        preview, rectangle = self._preview, request.rectangle_enu_m
        tool = self.scene.tool()
        if isinstance(tool, RectangleTool):
            tool.set_grid(request.n_rows, request.n_columns)
        if preview is None or rectangle is None:
            return
        self.grid.show_state(self.tr("Checking ..."), is_good=False)

        def work(_context: JobContext) -> PanelGridError | tuple[str, ...]:
            return _grid_notes(preview, rectangle, request)

        def checked(result: PanelGridError | tuple[str, ...]) -> None:
            if self._is_done or self.grid.value() != request or self._preview is not preview:
                return
            if isinstance(result, PanelGridError):
                self.grid.show_error(result.field, self._context.localized(str(result)))
            else:
                good = self.tr("The panels lie on the building and look outwards.")
                self.grid.show_state("\n".join(map(self._context.localized, result)) or good, is_good=True)

        self._context.start(self.tr("Check the facade grid"), work, checked)

    def _use_grid(self) -> None:
        request = self.grid.value()
        if self._preview is None or request.rectangle_enu_m is None:
            return
        grid = grid_in_file(self._preview, request.rectangle_enu_m, request.n_rows, request.n_columns, request.gap_m)
        options = self.form.value()
        self.form.setValue(
            replace(options, panel_grids=(*options.panel_grids, grid), grid_tolerance_m=request.tolerance_m)
        )
        self.grid.setValue(replace(request, rectangle_enu_m=None))
        self.preview()

    def _clear_grids(self) -> None:
        """Forget the rectangle that was picked, and all grids before it."""
        self.scene.cancel_tool()
        self.grid.setValue(replace(self.grid.value(), rectangle_enu_m=None))
        if self.form.value().panel_grids:
            self.form.setValue(replace(self.form.value(), panel_grids=()))
            self.preview()


def _without_grids(preview: ImportPreview) -> ImportOptions:
    """What decides where the building stands."""
    return replace(preview.options, panel_grids=(), grid_tolerance_m=0.0)


def _grid_notes(preview: ImportPreview, rectangle: Rectangle, request: GridRequest) -> PanelGridError | tuple[str, ...]:
    """What is worth knowing about a grid on the building that is looked at, or why it cannot be."""
    counts = (request.n_rows, request.n_columns)
    try:
        return panels_on_building(
            np.array(rectangle), counts, request.gap_m, preview.source.building, request.tolerance_m
        ).notes
    except PanelGridError as error:
        return error


class SiteOpener(QObject):
    """The three ways to a site; each is one step that can be undone."""

    def __init__(self, context: ApplicationContext, window: QWidget) -> None:
        super().__init__(window)
        self._context, self._window = context, window

    def choose_site(self) -> None:
        """Ask for a site file and open it."""
        path = choose_file(self._window, self.tr("Open site"), self.tr("Sites (*.json);;All files (*)"))
        if path is not None:
            self.open_site(path)

    def choose_import(self) -> None:
        """Ask for a building model and look at it."""
        kinds = " ".join(f"*{suffix}" for suffix in SUFFIXES)
        kinds = self.tr("Building models ({0});;All files (*)").format(kinds)
        path = choose_file(self._window, self.tr("Import building model"), kinds)
        if path is not None:
            self.import_site(path)

    def open_site(self, path: Path) -> None:
        """Open a site file."""
        label = self.tr("Open {0}").format(path.name)
        self._context.start(
            label,
            lambda context: (open_site(path, context), facades_beside(path)),
            lambda found: self._take(label, *found),
        )

    def open_bundled(self, name: str) -> None:
        """Open one of the sites that come with the program."""
        label = self.tr("Open {0}").format(name)
        self._context.start(label, lambda _context: bundled_site(name), lambda model: self._take(label, model))

    def import_site(self, path: Path) -> ImportDialog:
        """Look at a building model, and import it if the user wants that."""
        dialog = ImportDialog(self._context, path, self._window.window())
        dialog.imported.connect(lambda model: self._take(self.tr("Import {0}").format(path.name), model))
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()
        return dialog

    def bundled_menu(self, parent: QWidget) -> QMenu:
        """The sites that come with the program, each with what it is."""
        menu = QMenu(parent)
        texts = {
            "office": self.tr("Office: one flat facade of 280 panels"),
            "library": self.tr("Library: one curved facade of 300 panels"),
            "court": self.tr("Court: two wings that hide each other"),
            "canyon": self.tr("Canyon: a facade on a narrow street"),
            "roof": self.tr("Roof: horizontal skylights"),
            "tower": self.tr("Tower: 3 640 panels on four sides"),
            "single-panel": self.tr("A single panel"),
        }
        for name in SCENES:
            action = QAction(texts.get(name, name), menu)
            action.triggered.connect(lambda _checked=False, name=name: self.open_bundled(name))
            menu.addAction(action)
        return menu

    def _take(self, label: str, model: SiteModel, facades: FoundFacades | None = None) -> None:
        before = self._context.document
        self._context.change(label, with_new_site(before, model, facades))
        self._context.select(None)
        site = model.site
        self._context.say(
            Severity.OK, self.tr("{0}: panels {1}, facades {2}").format(site.name, site.n_panels, len(site.facades))
        )
        if before.plans:
            self._context.say(
                Severity.NOTE,
                self.tr("The plans of the site before are removed with it: {0}. Undo brings them back.").format(
                    len(before.plans)
                ),
            )
