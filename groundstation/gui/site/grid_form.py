"""A grid of equal panels on a wall: its form, its rectangle, the check against the building, and the preview."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QObject, QTimer, Signal
from PySide6.QtWidgets import QLabel, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.shared_view import SharedView
from groundstation.gui.site.site_editor import SiteEditor
from groundstation.gui.site.site_tools import SiteTool, SiteTools
from groundstation.gui.widgets.inputs import Form, LengthBox, WholeBox
from groundstation.gui.widgets.scrolling import ButtonGrid
from groundstation.gui.widgets.value_boxes import ErrorLine, PointBox, muted
from groundstation.services.project.document import Document, Item, ItemKind
from groundstation.services.site.edits import AddedGrid, add_panel_grid
from groundstation.services.units import UnitSystem, length_unit
from planning.base.errors import InputError
from planning.site.bundled import Rectangle
from planning.site.importing.options import ImportOptions
from planning.site.importing.panel_grid import GridField, PanelGridError
from planning.site.records import SiteModel

MAX_COUNT = 500
"""Rows or columns of one grid; the tallest facades have some 160 storeys."""

MAX_GAP_M = 20.0


@dataclass(frozen=True, slots=True)
class GridRequest:
    """A grid as it is wanted; `rectangle_enu_m` is None until it was picked."""

    rectangle_enu_m: Rectangle | None = None
    n_rows: int = 10
    n_columns: int = 10
    gap_m: float = 0.0
    tolerance_m: float = ImportOptions().grid_tolerance_m


class GridForm(QWidget):
    """Edits one `GridRequest`.

    Signals
    -------
    valueChanged(GridRequest)
    pickRequested(), accepted(), cancelled()
        The user wants to pick the rectangle in the view, to keep the grid, to give it up.
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)
    pickRequested = Signal()  # noqa: N815
    accepted = Signal()
    cancelled = Signal()

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._units = units
        self._has_rectangle = False
        self._rows, self._columns = _count_box(), _count_box()
        self._gap = LengthBox(0.0, MAX_GAP_M, 0.05, units, 2)
        self._tolerance = LengthBox(0.05, MAX_GAP_M, 0.5, units, 2)
        self._tolerance.setToolTip(self.tr("How far the panels may lie from the building's mesh"))
        self._corners = [PointBox(units) for _ in range(3)]
        self._size, self._status, self._error = QLabel(), muted(""), ErrorLine()
        self._pick = QPushButton(self.tr("Pick the rectangle on the wall"))
        self._accept = QPushButton(self.tr("Add these panels"))
        self._accept.setProperty("primary", True)
        self._cancel = QPushButton(self.tr("Cancel"))
        self._lay_out()
        boxes = (self._rows, self._columns, self._gap, self._tolerance)
        for changed in (*(box.valueChanged for box in boxes), *(corner.valueChanged for corner in self._corners)):
            changed.connect(self._edited)
        self._pick.clicked.connect(self.pickRequested)
        self._accept.clicked.connect(self.accepted)
        self._cancel.clicked.connect(self.cancelled)
        self.setValue(GridRequest())

    def _lay_out(self) -> None:
        self._size.setWordWrap(True)
        form = Form()
        form.addRow(self.tr("Rows"), self._rows)
        form.addRow(self.tr("Columns"), self._columns)
        form.addRow(self.tr("Gap"), self._gap)
        form.addRow(self.tr("Off the wall by up to"), self._tolerance)
        self._corner_rows = QWidget()
        corners = QVBoxLayout(self._corner_rows)
        corners.setContentsMargins(0, 0, 0, 0)
        titles = (self.tr("Lower left"), self.tr("Lower right"), self.tr("Upper left"))
        for title, box in zip(titles, self._corners, strict=True):
            corners.addWidget(QLabel(title))
            corners.addWidget(box)
        buttons = ButtonGrid()
        buttons.addWidget(self._accept)
        buttons.addWidget(self._cancel)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._pick)
        layout.addLayout(form)
        layout.addWidget(self._size)
        layout.addWidget(self._error)
        layout.addWidget(self._status)
        layout.addLayout(buttons)
        layout.addWidget(self._corner_rows)

    def value(self) -> GridRequest:
        """The grid as it is wanted."""
        rectangle: Rectangle | None = None
        if self._has_rectangle:
            a, b, c = (box.value() for box in self._corners)
            rectangle = (a, b, c)
        return GridRequest(
            rectangle, self._rows.value(), self._columns.value(), self._gap.value(), self._tolerance.value()
        )

    def setValue(self, request: GridRequest) -> None:  # noqa: N802
        """Show a request."""
        for box, count in ((self._rows, request.n_rows), (self._columns, request.n_columns)):
            box.blockSignals(True)
            box.setValue(count)
            box.blockSignals(False)
        self._gap.setValue(request.gap_m)
        self._tolerance.setValue(request.tolerance_m)
        self._has_rectangle = request.rectangle_enu_m is not None
        for edit, corner in zip(self._corners, request.rectangle_enu_m or (), strict=False):
            edit.setValue(corner)
        self._show_size()
        self.show_state("", is_good=False)

    def set_rectangle(self, rectangle_enu_m: Rectangle) -> None:
        """Take over what was picked."""
        self.setValue(
            GridRequest(
                rectangle_enu_m, self._rows.value(), self._columns.value(), self._gap.value(), self._tolerance.value()
            )
        )
        self.valueChanged.emit(self.value())

    def set_units(self, units: UnitSystem) -> None:
        """Show the same request in other units."""
        self._units = units
        for length in (self._gap, self._tolerance):
            length.set_units(units)
        for corner in self._corners:
            corner.set_units(units)
        self._show_size()

    def show_state(self, text: str, *, is_good: bool) -> None:
        """Say how the check of the grid stands; it can be added once it is good."""
        self._status.setText(text)
        self._status.setVisible(bool(text))
        self._error.show_error("")
        self._accept.setEnabled(is_good)

    def show_error(self, field: GridField | None, text: str) -> None:
        """Say why the grid cannot be, beginning with what is to be put right."""
        self.show_state("", is_good=False)
        titles = {
            GridField.COUNTS: self.tr("Rows and columns"),
            GridField.GAP: self.tr("Gap"),
            GridField.CORNERS: self.tr("Rectangle"),
        }
        self._error.show_error(f"{titles[field]}: {text}" if field is not None and text else text)

    def can_accept(self) -> bool:
        """Whether the grid can be added."""
        return self._accept.isEnabled()

    def set_words(self, accept: str, cancel: str) -> None:
        """Texts of the buttons."""
        self._accept.setText(accept)
        self._cancel.setText(cancel)

    def _edited(self, _value: object) -> None:
        self._show_size()
        self.valueChanged.emit(self.value())

    def _show_size(self) -> None:
        request = self.value()
        self._corner_rows.setVisible(request.rectangle_enu_m is not None)
        if request.rectangle_enu_m is None:
            self._size.setText(self.tr("Three clicks: lower left, lower right, upper edge, as seen from outside."))
            return
        width_m, height_m = rectangle_size_m(request.rectangle_enu_m)
        unit = length_unit(self._units)
        self._size.setText(
            self.tr("Wall: {0} × {1}\nPanels: {2}, each {3} × {4}").format(
                unit.text(width_m),
                unit.text(height_m),
                request.n_rows * request.n_columns,
                unit.text(max(0.0, width_m / request.n_columns - request.gap_m)),
                unit.text(max(0.0, height_m / request.n_rows - request.gap_m)),
            )
        )


def rectangle_size_m(rectangle: Rectangle) -> tuple[float, float]:
    """Lengths of the lower and the left edge."""
    low, right, up = (np.array(corner) for corner in rectangle)
    return float(np.linalg.norm(right - low)), float(np.linalg.norm(up - low))


def _count_box() -> WholeBox:
    return WholeBox(1, MAX_COUNT)


# Makes a panel grid: picks its rectangle, checks it against the building while it is changed, shows it, adds it.

CHECK_AFTER_MS = 200


def checked_grid(model: SiteModel, request: GridRequest) -> AddedGrid | InputError:
    """The site with the grid that is wanted, or why it cannot be: an answer for the form, not a failure of a job."""
    if request.rectangle_enu_m is None:
        raise ValueError("rectangle_enu_m: expected a rectangle that was picked")
    try:
        return add_panel_grid(
            model, request.rectangle_enu_m, request.n_rows, request.n_columns, request.gap_m, request.tolerance_m
        )
    except InputError as error:
        return error


class GridController(QObject):
    """Connects the grid form with the rectangle tool, the checks and the document.

    Signals
    -------
    activeChanged(bool)
        A grid is being made, or no longer.
    """

    activeChanged = Signal(bool)  # noqa: N815  (Qt's own way of naming)

    def __init__(
        self, context: ApplicationContext, shared_view: SharedView, editor: SiteEditor, tools: SiteTools, form: GridForm
    ) -> None:
        super().__init__(form)
        self._context, self._shared_view, self._editor = context, shared_view, editor
        self._tools, self._form = tools, form
        self._base: SiteModel | None = None
        self._added: AddedGrid | None = None
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(CHECK_AFTER_MS)
        self._timer.timeout.connect(self._check)
        tools.gridRequested.connect(self.begin)
        tools.gridPicked.connect(self._picked)
        form.valueChanged.connect(self._changed)
        form.pickRequested.connect(self._pick)
        form.accepted.connect(self._accept)
        form.cancelled.connect(self.end)
        context.documentChanged.connect(self._document_changed)
        form.hide()

    def begin(self) -> None:
        """Show the form."""
        if self._form.isHidden():
            self._form.setValue(GridRequest())
            self._form.show()
            self.activeChanged.emit(True)

    def end(self) -> None:
        """Give the grid up, and show the site as it is."""
        self._timer.stop()
        if self._tools.active() is SiteTool.GRID:
            self._tools.cancel_drawing()
        self._leave()
        self._show_site(self._context.document.site)

    def _leave(self) -> None:
        self._form.hide()
        self.activeChanged.emit(False)

    def _pick(self) -> None:
        request = self._form.value()
        self._tools.use(SiteTool.GRID, request.n_rows, request.n_columns)

    def _picked(self, rectangle: Rectangle) -> None:
        self._form.set_rectangle(rectangle)

    def _changed(self, request: GridRequest) -> None:
        self._tools.set_grid(request.n_rows, request.n_columns)
        if request.rectangle_enu_m is not None:
            self._form.show_state(self.tr("Checking ..."), is_good=False)
            self._timer.start()

    def _check(self) -> None:
        model, request = self._context.document.site, self._form.value()
        if model is None or request.rectangle_enu_m is None or self._form.isHidden():
            return

        def checked(result: AddedGrid | InputError) -> None:
            if self._form.value() == request and self._context.document.site is model and not self._form.isHidden():
                self._show_result(model, result)

        self._context.start(self.tr("Check the facade grid"), lambda _context: checked_grid(model, request), checked)

    def _show_result(self, base: SiteModel, result: AddedGrid | InputError) -> None:
        if isinstance(result, InputError):
            self._added = None
            self._form.show_error(
                result.field if isinstance(result, PanelGridError) else None, self._context.localized(str(result))
            )
            self._show_site(base)
            return
        self._base, self._added = base, result
        text = "\n".join(map(self._context.localized, result.notes)) or self.tr(
            "The panels lie on the building and look outwards."
        )
        self._form.show_state(text, is_good=True)
        self._show_site(result.model)

    def _accept(self) -> None:
        added, base = self._added, self._base
        if added is None or base is None:
            return
        self._leave()
        self._editor.apply(
            self.tr("Add facade grid {0}").format(added.facade_id),
            lambda _model: added.model,
            Item(ItemKind.FACADE, added.facade_id),
        )

    def _show_site(self, model: SiteModel | None) -> None:
        scene = self._shared_view.scene()
        if scene is not None:
            scene.set_site(model, keep_camera=True)

    def _document_changed(self, before: Document, after: Document) -> None:
        # A grid that was checked fits the site of then; on another one it is checked anew.
        if after.site is not before.site and not self._form.isHidden():
            self._added = None
            self._changed(self._form.value())
