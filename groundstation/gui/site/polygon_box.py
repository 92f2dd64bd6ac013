"""Editor of a polygon's corners."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QGridLayout, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.inputs import LengthBox
from groundstation.gui.site.value_boxes import axis_titles, coordinate_box, muted
from groundstation.services.units import UnitSystem

Polygon = tuple[tuple[float, float], ...]

LEAST_CORNERS = 3


class PolygonBox(QWidget):
    """Edits a polygon on the ground: corners, metres east and north of the site's zero."""

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._units = units
        self._rows: list[tuple[LengthBox, LengthBox]] = []
        self._layout = QVBoxLayout(self)
        self._layout.setContentsMargins(0, 0, 0, 0)
        self._grid = QWidget()
        self._layout.addWidget(self._grid)

    def value(self) -> Polygon:
        """The corners in order."""
        return tuple((east.value(), north.value()) for east, north in self._rows)

    def setValue(self, polygon: Polygon) -> None:  # noqa: N802
        """Show a polygon."""
        if len(polygon) != len(self._rows):
            self._build(len(polygon))
        for (east, north), (x, y) in zip(self._rows, polygon, strict=True):
            east.setValue(x)
            north.setValue(y)

    def set_units(self, units: UnitSystem) -> None:
        """Show the same corners in other units."""
        self._units = units
        for row in self._rows:
            for box in row:
                box.set_units(units)

    def add_corner(self, row: int) -> None:
        """Put a corner half-way between one and the next."""
        corners = list(self.value())
        (x0, y0), (x1, y1) = corners[row], corners[(row + 1) % len(corners)]
        corners.insert(row + 1, (0.5 * (x0 + x1), 0.5 * (y0 + y1)))
        self._take(tuple(corners))

    def remove_corner(self, row: int) -> None:
        """Take a corner away."""
        corners = self.value()
        self._take(corners[:row] + corners[row + 1 :])

    def boxes(self) -> list[tuple[LengthBox, LengthBox]]:
        """East and north of every corner."""
        return self._rows

    def _take(self, polygon: Polygon) -> None:
        self.setValue(polygon)
        self.valueChanged.emit(self.value())

    def _build(self, n_corners: int) -> None:
        old, self._grid, self._rows = self._grid, QWidget(), []
        grid = QGridLayout(self._grid)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setSpacing(4)
        for column, title in enumerate(axis_titles()[:2]):
            grid.addWidget(muted(title), 0, column)
        for row in range(n_corners):
            boxes = coordinate_box(self._units), coordinate_box(self._units)
            self._rows.append(boxes)
            for column, box in enumerate(boxes):
                grid.addWidget(box, row + 1, column)
                box.valueChanged.connect(self._edited)
            grid.addWidget(self._button("+", self.tr("Add a corner after this one"), self.add_corner, row), row + 1, 2)
            remove = self._button("−", self.tr("Remove this corner"), self.remove_corner, row)
            remove.setEnabled(n_corners > LEAST_CORNERS)
            grid.addWidget(remove, row + 1, 3)
        self._layout.replaceWidget(old, self._grid)
        old.hide()
        # A button of the old rows may be the one that was just pressed.
        old.deleteLater()

    def _button(self, text: str, tip: str, slot: Callable[[int], None], row: int) -> QPushButton:
        button = QPushButton(text)
        button.setToolTip(tip)
        button.setFixedWidth(40)
        button.clicked.connect(lambda _checked=False: slot(row))
        return button

    def _edited(self, _value: float) -> None:
        self.valueChanged.emit(self.value())
