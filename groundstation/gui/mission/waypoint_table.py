"""The waypoint table with what chooses its rows and references."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from PySide6.QtCore import QItemSelectionModel, QModelIndex, QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import (
    QAbstractItemView,
    QCheckBox,
    QComboBox,
    QHBoxLayout,
    QHeaderView,
    QTableView,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.inputs import ChoiceBox
from groundstation.gui.mission.waypoint_model import PositionShown, WaypointFilter, WaypointModel
from groundstation.services.document import Item
from groundstation.services.units import UnitSystem
from groundstation.services.waypoints import HeightShown, WaypointRow


class WaypointTable(QWidget):
    """Waypoints of a plan; sorted and filtered, never edited. `bar` chooses what is shown; put it where there is room.

    Signals
    -------
    picked(Item)
        The user went to a row: a viewpoint, a leg (for vertices without a photo) or home.
    activated(Item)
        The user wants to look at it: double click or Enter.
    """

    picked = Signal(object)
    activated = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._model = WaypointModel(self)
        self._filter = WaypointFilter(self)
        self._filter.setSourceModel(self._model)
        self._view = QTableView()
        self._is_being_told = False
        self._sortie, self._position, self._height = ChoiceBox(), ChoiceBox(), ChoiceBox()
        self._photos_only = QCheckBox(self.tr("Photos only"))
        self._photos_only.setToolTip(self.tr("Leave out where the path only turns"))
        for box in (self._sortie, self._position, self._height):
            box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
            box.setMinimumContentsLength(6)
        self._fill_choices()
        self._dress_view()
        self.bar = QWidget(self)
        row = QHBoxLayout(self.bar)
        row.setContentsMargins(0, 0, 0, 0)
        for widget in (self._sortie, self._photos_only, self._position, self._height):
            row.addWidget(widget)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._view, 1)
        self._sortie.currentIndexChanged.connect(self._filter_rows)
        self._photos_only.toggled.connect(self._filter_rows)
        self._position.currentIndexChanged.connect(self._choose_references)
        self._height.currentIndexChanged.connect(self._choose_references)
        self._view.selectionModel().currentRowChanged.connect(self._row_changed)
        self._view.activated.connect(self._row_activated)

    def set_rows(self, rows: Sequence[WaypointRow]) -> None:
        """Show the waypoints of another plan; filter, order and references stay."""
        was_empty = self._model.rowCount() == 0
        self._model.set_rows(rows)
        numbers = sorted({row.sortie for row in rows})
        if numbers != [self._sortie.itemData(index) for index in range(1, self._sortie.count())]:
            self._offer_sorties(numbers)
            self._filter_rows()
        if was_empty:  # after an edit the columns are as wide as they must be
            self._view.resizeColumnsToContents()

    def _offer_sorties(self, numbers: Sequence[int]) -> None:
        chosen = self._sortie.currentData()
        with QSignalBlocker(self._sortie):
            self._sortie.clear()
            self._sortie.addItem(self.tr("All sorties"), None)
            for number in numbers:
                text = self.tr("Sortie {0}").format(number) if number else self.tr("In no sortie")
                self._sortie.addItem(text, number)
            self._sortie.setCurrentIndex(max(0, self._sortie.findData(chosen)))

    def set_panels_covered(self, panels_covered: Mapping[str, int]) -> None:
        """Say how many panels each viewpoint covers."""
        self._model.set_panels_covered(panels_covered)

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._model.set_units(units)
        self._view.resizeColumnsToContents()

    def set_selection(self, item: Item | None) -> None:
        """Mark the row of a thing and bring it into sight; no signal comes from it."""
        row = None if item is None else self._model.row_of(item)
        shown = QModelIndex() if row is None else self._filter.mapFromSource(self._model.index(row, 0))
        selection = self._view.selectionModel()
        if shown.isValid() and selection.currentIndex().row() == shown.row():
            return
        # Blocking the signals would keep the view from painting the row.
        self._is_being_told = True
        if shown.isValid():
            flags = QItemSelectionModel.SelectionFlag
            selection.setCurrentIndex(shown, flags.ClearAndSelect | flags.Rows)
            self._view.scrollTo(shown, QAbstractItemView.ScrollHint.EnsureVisible)
        else:
            selection.clear()
        self._is_being_told = False

    def view(self) -> QTableView:
        """The table itself, for focus and tests."""
        return self._view

    def model(self) -> WaypointModel:
        """The unsorted rows."""
        return self._model

    def _fill_choices(self) -> None:
        for box in (self._sortie, self._position, self._height):
            box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToContents)
        self._position.setToolTip(self.tr("Frame of the positions; east and north count from the site's origin"))
        self._height.setToolTip(self.tr("What heights are counted from; heights above take-off are always shown, too"))
        self._sortie.addItem(self.tr("All sorties"), None)
        self._position.addItem(self.tr("East, north"), PositionShown.LOCAL)
        self._position.addItem(self.tr("Lat, lon (WGS 84)"), PositionShown.GEODETIC)
        self._height.addItem(self.tr("Heights: local"), HeightShown.LOCAL)
        self._height.addItem(self.tr("Heights: sea level (EGM96)"), HeightShown.AMSL)
        self._height.addItem(self.tr("Heights: ellipsoid (WGS 84)"), HeightShown.ELLIPSOID)

    def _dress_view(self) -> None:
        view = self._view
        view.setModel(self._filter)
        view.setSortingEnabled(True)
        # Unsorted at first: the order of flight.
        view.horizontalHeader().setSortIndicatorClearable(True)
        view.sortByColumn(-1, Qt.SortOrder.AscendingOrder)
        view.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        view.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        view.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        view.setTabKeyNavigation(False)
        view.setAlternatingRowColors(True)
        view.setWordWrap(False)
        view.verticalHeader().hide()
        view.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Interactive)
        # Every row that is measured for the widths of the columns takes half a millisecond.
        view.horizontalHeader().setResizeContentsPrecision(8)
        view.setAccessibleName(self.tr("Waypoints"))

    def _filter_rows(self) -> None:
        self._filter.set_filter(self._sortie.currentData(), self._photos_only.isChecked())

    def _choose_references(self) -> None:
        # Qt keeps the values of an enum as plain text.
        self._model.set_shown(PositionShown(self._position.currentData()), HeightShown(self._height.currentData()))
        self._view.resizeColumnsToContents()

    def _row_changed(self, current: QModelIndex, _previous: QModelIndex) -> None:
        if current.isValid() and not self._is_being_told:
            self.picked.emit(self._item_at(current))

    def _row_activated(self, index: QModelIndex) -> None:
        self.activated.emit(self._item_at(index))

    def _item_at(self, index: QModelIndex) -> Item:
        return self._model.item(self._filter.mapToSource(index).row())
