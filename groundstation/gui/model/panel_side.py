"""The left side: which model, its panels as a list that can be searched, and what they are coloured by."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import date

from PySide6.QtCore import QAbstractListModel, QModelIndex, QPersistentModelIndex, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QColor, QIcon, QPixmap
from PySide6.QtWidgets import QGridLayout, QLabel, QLineEdit, QListView, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.widgets.inputs import ChoiceBox
from groundstation.services.model.panel_colours import Colouring, Computed, LegendLine
from groundstation.services.model.scene_card import PanelRow

Index = QModelIndex | QPersistentModelIndex

SWATCH_PX = 14
MOST_LINES = 7


class _Rows(QAbstractListModel):
    """Panels, each with its colour."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.panels: tuple[PanelRow, ...] = ()
        self._icons: dict[str, QIcon] = {}
        self._notes: dict[str, str] = {}

    def set_panels(self, panels: Sequence[PanelRow], notes: dict[str, str]) -> None:
        """Show others; `notes` stand behind their names, by GlobalId."""
        self.beginResetModel()
        self.panels, self._notes = tuple(panels), notes
        self.endResetModel()

    def set_colours(self, found: Colouring) -> None:
        """Colour them."""
        icons = {colour: _swatch(colour) for colour in set(found.colours.values())}
        self._icons = {each: icons[colour] for each, colour in found.colours.items()}
        if self.panels:
            self.dataChanged.emit(self.index(0), self.index(len(self.panels) - 1))

    def rowCount(self, parent: Index = QModelIndex()) -> int:  # noqa: B008, N802
        """How many there are."""
        return 0 if parent.isValid() else len(self.panels)

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> object:
        """Name, colour, GlobalId."""
        panel = self.panels[index.row()]
        note = self._notes.get(panel.global_id, "")
        if role == Qt.ItemDataRole.DisplayRole:
            return f"{panel.name}: {note}" if note else panel.name
        if role == Qt.ItemDataRole.DecorationRole:
            return self._icons.get(panel.global_id)
        if role == Qt.ItemDataRole.ToolTipRole:
            return panel.global_id
        return None


class PanelSide(QWidget):
    """Shows panels, and edits which one is looked at and what they are coloured by.

    Signals
    -------
    chosen(str)
        GlobalId of a panel.
    colourChanged(str), searched(str)
    """

    chosen = Signal(str)
    colourChanged = Signal(str)  # noqa: N815  (Qt's own way of naming)
    searched = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.open, self.title = QPushButton(self.tr("Open a model ...")), QLabel()
        self.export = QPushButton(self.tr("Export ..."))
        self.export.setToolTip(self.tr("Write the model for other programs"))
        self.search, self.list, self.colour = QLineEdit(), QListView(), ChoiceBox()
        self.rows = _Rows(self)
        self._is_told = False
        self._lines: list[tuple[QLabel, QLabel]] = []
        self.without = QLabel()
        self.list.setModel(self.rows)
        self.list.setUniformItemSizes(True)
        self.list.setSelectionMode(QListView.SelectionMode.ExtendedSelection)
        self.list.setToolTip(self.tr("Several can be marked, with Ctrl or Shift, for a report"))
        self.list.setAccessibleName(self.tr("Panels"))
        self.search.setPlaceholderText(self.tr("Search panels and records"))
        self.search.setClearButtonEnabled(True)
        self.search.setAccessibleName(self.tr("Search panels and records"))
        self.title.setWordWrap(True)
        self.without.setProperty("role", "muted")
        self.without.setWordWrap(True)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 6, 0)
        for widget in (self.open, self.title, self.export, self.search):
            layout.addWidget(widget)
        layout.addWidget(self.list, 1)
        label = QLabel(self.tr("Colour panels by"))
        label.setBuddy(self.colour)
        layout.addWidget(label)
        layout.addWidget(self.colour)
        self._legend = QGridLayout()
        self._legend.setColumnStretch(1, 1)
        layout.addLayout(self._legend)
        layout.addWidget(self.without)
        self.set_attributes(())
        self.search.textChanged.connect(self.searched)
        self.colour.currentIndexChanged.connect(self._colour_chosen)
        self.list.selectionModel().currentChanged.connect(self._row_chosen)

    def set_panels(self, panels: Sequence[PanelRow], notes: dict[str, str], selected: str) -> None:
        """Show these panels."""
        self.rows.set_panels(panels, notes)
        self.select(selected)

    def select(self, global_id: str) -> None:
        """Show which one is looked at."""
        number = next((row for row, panel in enumerate(self.rows.panels) if panel.global_id == global_id), -1)
        self._is_told = True
        if number >= 0:
            self.list.setCurrentIndex(self.rows.index(number))
        else:
            self.list.clearSelection()
            self.list.setCurrentIndex(QModelIndex())
        self._is_told = False

    def marked(self) -> tuple[PanelRow, ...]:
        """Panels that are marked in the list, in its order."""
        rows = sorted(index.row() for index in self.list.selectionModel().selectedIndexes())
        return tuple(self.rows.panels[row] for row in rows)

    def set_attributes(self, names: Sequence[str]) -> None:
        """Offer attributes to colour by."""
        before = self.value()
        with QSignalBlocker(self.colour):
            self.colour.clear()
            for name, text in (
                ("", self.tr("nothing")),
                (Computed.INSPECTED, self.tr("last inspection")),
                (Computed.DEFECTS, self.tr("worst open defect")),
                (Computed.FACADE, self.tr("facade")),
            ):
                self.colour.addItem(text, str(name))
            for name in names:
                self.colour.addItem(name, name)
            self.colour.setCurrentIndex(max(0, self.colour.findData(before)))

    def value(self) -> str:
        """What panels are coloured by."""
        return str(self.colour.currentData() or "")

    def show_colours(self, found: Colouring) -> None:
        """Colour the list, and say what colours stand for."""
        self.rows.set_colours(found)
        while len(self._lines) < min(len(found.legend), MOST_LINES):
            line = QLabel(), QLabel()
            for column, label in enumerate(line):
                self._legend.addWidget(label, len(self._lines), column)
            self._lines.append(line)
        for number, (swatch, text) in enumerate(self._lines):
            is_shown = number < len(found.legend)
            swatch.setVisible(is_shown)
            text.setVisible(is_shown)
            if is_shown:
                swatch.setPixmap(_swatch(found.legend[number].colour).pixmap(SWATCH_PX, SWATCH_PX))
                text.setText(_words(found.legend[number], found.unit))
        self.without.setText(self.tr("{0} without a value").format(found.n_without))
        self.without.setVisible(bool(self.value()) and found.n_without > 0)
        self.list.scrollTo(self.list.currentIndex())

    def _row_chosen(self, current: QModelIndex) -> None:
        if current.isValid() and not self._is_told:
            self.chosen.emit(self.rows.panels[current.row()].global_id)

    def _colour_chosen(self) -> None:
        self.colourChanged.emit(self.value())


def _swatch(colour: tuple[int, int, int]) -> QIcon:
    picture = QPixmap(SWATCH_PX, SWATCH_PX)
    picture.fill(QColor(*colour))
    return QIcon(picture)


def _words(line: LegendLine, unit: str) -> str:
    value = line.value
    if isinstance(value, date):
        return value.isoformat()
    if isinstance(value, float):
        return f"{value:.4g} {unit}".strip()
    return value
