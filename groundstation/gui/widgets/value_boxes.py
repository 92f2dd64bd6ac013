"""Editors of places, extents and files: values of several parts, with room for the reason why one was refused."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from PySide6.QtCore import QCoreApplication, Qt, Signal
from PySide6.QtWidgets import (
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QSizePolicy,
    QStyleOptionButton,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.widgets.inputs import LengthBox
from groundstation.gui.widgets.questions import choose_file
from groundstation.gui.widgets.terms import label_of
from groundstation.services.units import UnitSystem
from planning.geo.frames import Vec3
from planning.geo.mesh import MAX_COORDINATE_M

DECIMALS = 2
"""Coordinates are shown to 1 cm, or a hundredth of a foot."""


LEAST_NAME_PX, BUTTON_EDGES_PX = 90, 20
"""Of the name of a file on its button, and what stands beside it there."""


class ErrorLine(QLabel):
    """Why a value was refused; takes no room while there is nothing to say."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setProperty("role", "error")
        self.setWordWrap(True)
        self.setTextFormat(Qt.TextFormat.PlainText)
        self.hide()

    def show_error(self, text: str) -> None:
        """Say it; an empty text takes it back."""
        self.setText(text)
        self.setVisible(bool(text))


def coordinate_box(units: UnitSystem) -> LengthBox:
    """Box for one local coordinate."""
    box = LengthBox(-MAX_COORDINATE_M, MAX_COORDINATE_M, 0.5, units, DECIMALS)
    box.setMinimumWidth(100)
    return box


class NameBox(QLineEdit):
    """Edits a name; a changed one is announced when Enter is pressed or the box is left."""

    valueChanged = Signal(str)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._value = ""
        self.editingFinished.connect(self._finish)

    def value(self) -> str:
        """The name as it was set or last announced."""
        return self._value

    def setValue(self, name: str) -> None:  # noqa: N802
        """Show a name."""
        self._value = name
        self.setText(name)

    def _finish(self) -> None:
        if self.text() != self._value:
            self._value = self.text()
            self.valueChanged.emit(self._value)


class _NameButton(QPushButton):
    """Shows as much of a name as it has room for: its beginning and its end."""

    def initStyleOption(self, option: QStyleOptionButton) -> None:  # noqa: N802
        """Leave the middle out."""
        super().initStyleOption(option)
        room = self.width() - BUTTON_EDGES_PX
        option.text = self.fontMetrics().elidedText(self.text(), Qt.TextElideMode.ElideMiddle, room)


class FileBox(QWidget):
    """Edits a file that may be named: a button with its name, and one that takes it away.

    Parameters
    ----------
    text
        What the button says while there is none.
    title, kinds
        Of the dialog; `kinds` as Qt has them, "Sites (*.json)".
    """

    valueChanged = Signal(object)  # noqa: N815

    def __init__(self, text: str, title: str, kinds: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._text, self._title, self._kinds = text, title, kinds
        self._value: Path | None = None
        self.choose, self.without = _NameButton(), QPushButton(self.tr("Without"))
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.choose, 1)
        layout.addWidget(self.without)
        self.choose.clicked.connect(self._ask)
        self.without.clicked.connect(lambda: self._take(None))
        self.setValue(None)

    def value(self) -> Path | None:
        """The file; None for none."""
        return self._value

    def setValue(self, path: Path | None) -> None:  # noqa: N802
        """Show a file, or none."""
        self._value = path
        self.choose.setText(self._text if path is None else path.name)
        self.choose.setAccessibleName("" if path is None else f"{self._text} {path.name}")
        # A long name makes nothing wider.
        wide = QSizePolicy.Policy.Minimum if path is None else QSizePolicy.Policy.Ignored
        self.choose.setSizePolicy(wide, QSizePolicy.Policy.Fixed)
        self.choose.setMinimumWidth(0 if path is None else LEAST_NAME_PX)
        self.without.setVisible(path is not None)

    def _ask(self) -> None:
        path = choose_file(self.window(), self._title, self._kinds)
        if path is not None:
            self._take(path)

    def _take(self, path: Path | None) -> None:
        self.setValue(path)
        self.valueChanged.emit(path)


class PointBox(QWidget):
    """Edits a point: metres east, north and up of the site origin."""

    valueChanged = Signal(object)  # noqa: N815

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._boxes = [coordinate_box(units) for _ in range(3)]
        layout = QGridLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.setColumnStretch(1, 1)
        for row, (title, box) in enumerate(zip(axis_titles(), self._boxes, strict=True)):
            layout.addWidget(QLabel(title), row, 0)
            layout.addWidget(box, row, 1)
            box.valueChanged.connect(self._edited)

    def value(self) -> Vec3:
        """The point."""
        east, north, up = (box.value() for box in self._boxes)
        return east, north, up

    def setValue(self, point: Vec3) -> None:  # noqa: N802
        """Show a point."""
        for box, value in zip(self._boxes, point, strict=True):
            box.setValue(value)

    def set_units(self, units: UnitSystem) -> None:
        """Show the same point in other units."""
        for box in self._boxes:
            box.set_units(units)

    def boxes(self) -> Sequence[LengthBox]:
        """East, north and up."""
        return self._boxes

    def _edited(self, _value: float) -> None:
        self.valueChanged.emit(self.value())


class ExtentBox(QWidget):
    """Edits an extent: from one corner to the opposite one."""

    valueChanged = Signal(object)  # noqa: N815

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._ends = [[coordinate_box(units) for _ in range(3)] for _ in range(2)]
        layout = QGridLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        for column, title in enumerate((self.tr("from"), self.tr("to")), start=1):
            layout.addWidget(muted(title), 0, column)
        for row, title in enumerate(axis_titles(), start=1):
            layout.addWidget(QLabel(title), row, 0)
            for column, end in enumerate(self._ends, start=1):
                layout.addWidget(end[row - 1], row, column)
                end[row - 1].valueChanged.connect(self._edited)
        layout.setColumnStretch(1, 1)
        layout.setColumnStretch(2, 1)

    def value(self) -> tuple[Vec3, Vec3]:
        """First and second corner; whether the first is the lower one is for others to judge."""
        (a, b, c), (d, e, f) = ([box.value() for box in end] for end in self._ends)
        return (a, b, c), (d, e, f)

    def setValue(self, extent: tuple[Vec3, Vec3]) -> None:  # noqa: N802
        """Show an extent."""
        for end, corner in zip(self._ends, extent, strict=True):
            for box, value in zip(end, corner, strict=True):
                box.setValue(value)

    def set_units(self, units: UnitSystem) -> None:
        """Show the same extent in other units."""
        for end in self._ends:
            for box in end:
                box.set_units(units)

    def boxes(self) -> Sequence[Sequence[LengthBox]]:
        """East, north and up of the first corner, then of the second."""
        return self._ends

    def _edited(self, _value: float) -> None:
        self.valueChanged.emit(self.value())


class FormColumn(QWidget):
    """Widgets one below the other, each under its title."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._layout = QVBoxLayout(self)
        self._layout.setContentsMargins(0, 0, 0, 0)
        self._layout.setSpacing(4)

    def add(self, *widgets: QWidget, title: str = "") -> None:
        """Put widgets below what is there, under a title of their own where one is given."""
        if title:
            label = label_of(title, widgets[0]) if widgets else QLabel(title)
            label.setProperty("role", "heading")
            self._layout.addWidget(label)
        for widget in widgets:
            self._layout.addWidget(widget)


def muted(text: str) -> QLabel:
    """A small explanation."""
    label = QLabel(text)
    label.setProperty("role", "muted")
    label.setWordWrap(True)
    return label


def axis_titles() -> tuple[str, str, str]:
    """Names of the axes of the local frame, in the user's language."""
    translate = QCoreApplication.translate
    return translate("Axes", "East"), translate("Axes", "North"), translate("Axes", "Up")


# Editor of a polygon's corners.

Polygon = tuple[tuple[float, float], ...]

LEAST_CORNERS = 3


class PolygonBox(QWidget):
    """Edits a polygon on the ground: corners, metres east and north of the site origin."""

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
            remove = self._button("−", self.tr("Delete this corner"), self.remove_corner, row)
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
