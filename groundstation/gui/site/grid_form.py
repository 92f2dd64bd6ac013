"""Form for a grid of equal panels on a wall: rows, columns, gap, and the rectangle that was picked for it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import Signal
from PySide6.QtWidgets import QLabel, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.widgets.inputs import Form, LengthBox, WholeBox
from groundstation.gui.widgets.scrolling import ButtonGrid
from groundstation.gui.widgets.value_boxes import ErrorLine, PointBox, muted
from groundstation.services.units import UnitSystem, length_unit
from planning.site.bundled import Rectangle
from planning.site.importing.options import ImportOptions
from planning.site.importing.panel_grid import GridField

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
    pickAsked(), accepted(), cancelled()
        The user wants to pick the rectangle in the view, to keep the grid, to give it up.
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)
    pickAsked = Signal()  # noqa: N815
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
        for box in (self._rows, self._columns, self._gap, self._tolerance, *self._corners):
            box.valueChanged.connect(self._edited)
        self._pick.clicked.connect(self.pickAsked)
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

    def setValue(self, wish: GridRequest) -> None:  # noqa: N802
        """Show a wish."""
        for box, count in ((self._rows, wish.n_rows), (self._columns, wish.n_columns)):
            box.blockSignals(True)
            box.setValue(count)
            box.blockSignals(False)
        self._gap.setValue(wish.gap_m)
        self._tolerance.setValue(wish.tolerance_m)
        self._has_rectangle = wish.rectangle_enu_m is not None
        for box, corner in zip(self._corners, wish.rectangle_enu_m or (), strict=False):
            box.setValue(corner)
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
        """Show the same wish in other units."""
        self._units = units
        for box in (self._gap, self._tolerance, *self._corners):
            box.set_units(units)
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
        wish = self.value()
        self._corner_rows.setVisible(wish.rectangle_enu_m is not None)
        if wish.rectangle_enu_m is None:
            self._size.setText(self.tr("Three clicks: lower left, lower right, upper edge, as seen from outside."))
            return
        width_m, height_m = rectangle_size_m(wish.rectangle_enu_m)
        unit = length_unit(self._units)
        self._size.setText(
            self.tr("Wall: {0} × {1}\nPanels: {2}, each {3} × {4}").format(
                unit.text(width_m),
                unit.text(height_m),
                wish.n_rows * wish.n_columns,
                unit.text(max(0.0, width_m / wish.n_columns - wish.gap_m)),
                unit.text(max(0.0, height_m / wish.n_rows - wish.gap_m)),
            )
        )


def rectangle_size_m(rectangle: Rectangle) -> tuple[float, float]:
    """Lengths of the lower and the left edge."""
    low, right, up = (np.array(corner) for corner in rectangle)
    return float(np.linalg.norm(right - low)), float(np.linalg.norm(up - low))


def _count_box() -> WholeBox:
    return WholeBox(1, MAX_COUNT)
