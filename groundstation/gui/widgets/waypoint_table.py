"""The waypoint table with what chooses its rows and references."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from enum import IntEnum, StrEnum, auto
from typing import Any

from PySide6.QtCore import (
    QAbstractTableModel,
    QItemSelectionModel,
    QModelIndex,
    QObject,
    QPersistentModelIndex,
    QSignalBlocker,
    QSortFilterProxyModel,
    Qt,
    Signal,
)
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

from groundstation.gui.widgets.inputs import ChoiceBox
from groundstation.services.mission.waypoints import HeightShown, WaypointRow
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.units import UnitSystem, length_unit, minutes_text

# The waypoints of a plan as a Qt item model.

Index = QModelIndex | QPersistentModelIndex

SORT_ROLE = Qt.ItemDataRole.UserRole
"""Role of the plain value of a cell: what rows are sorted by."""

NO_VALUE = "–"


class Column(IntEnum):
    """Columns of the table."""

    SORTIE = 0
    NUMBER = auto()
    VIEWPOINT = auto()
    FIRST = auto()
    SECOND = auto()
    HEIGHT = auto()
    ABOVE_TAKEOFF = auto()
    HEADING = auto()
    PITCH = auto()
    LEG = auto()
    ARRIVAL = auto()
    PANELS = auto()
    LOCKED = auto()


class PositionShown(StrEnum):
    """What the two horizontal coordinates are."""

    LOCAL = "local"
    GEODETIC = "geodetic"


LENGTHS = frozenset({Column.HEIGHT, Column.ABOVE_TAKEOFF, Column.LEG})


class WaypointModel(QAbstractTableModel):
    """Shows rows; edits nothing."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._rows: tuple[WaypointRow, ...] = ()
        self._items: tuple[tuple[int, Item], ...] = ()
        self._row_of: dict[Item, int] = {}
        self._panels: Mapping[str, int] = {}
        self._units = UnitSystem.METRIC
        self._position, self._height = PositionShown.LOCAL, HeightShown.LOCAL

    def set_rows(self, rows: Sequence[WaypointRow], panels_covered: Mapping[str, int] | None = None) -> None:
        """Show other waypoints; `panels_covered` by viewpoint, as before where it is not given.

        The same waypoints with other values, as after most edits, leave filter, order and selection as they are.
        """
        before, after = self._rows, tuple(rows)
        items = tuple((row.sortie, item_of_row(row)) for row in after)
        if items != self._items:
            self.beginResetModel()
            self._rows, self._items, self._row_of = after, items, {}
            for number, (_, item) in enumerate(items):
                self._row_of.setdefault(item, number)
            self.endResetModel()
        else:
            self._rows = after
            changed = [n for n, row in enumerate(after) if row is not before[n] and row != before[n]]
            self._rows_changed(changed, Column.SORTIE, Column.LOCKED)
        if panels_covered is not None:
            self.set_panels_covered(panels_covered)

    def set_panels_covered(self, panels_covered: Mapping[str, int]) -> None:
        """Fill the column of covered panels."""
        before, self._panels = self._panels, panels_covered
        changed = [
            number
            for number, row in enumerate(self._rows)
            if _covered_by(row, before) != _covered_by(row, panels_covered)
        ]
        self._rows_changed(changed, Column.PANELS, Column.PANELS)

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        self._column_changed(Column.FIRST, Column.LEG)

    def set_shown(self, position: PositionShown, height: HeightShown) -> None:
        """Show positions in another frame, heights above another reference."""
        self._position, self._height = position, height
        self._column_changed(Column.FIRST, Column.HEIGHT)

    def item(self, row: int) -> Item:
        """What a row stands for."""
        return item_of_row(self._rows[row])

    def row_of(self, item: Item) -> int | None:
        """The first row of a thing; None where there is none."""
        return self._row_of.get(item)

    def waypoint(self, row: int) -> WaypointRow:
        """The record behind a row."""
        return self._rows[row]

    def rowCount(self, parent: Index = QModelIndex()) -> int:  # noqa: N802, B008
        """Number of waypoints; none below a cell."""
        return 0 if parent.isValid() else len(self._rows)

    def columnCount(self, parent: Index = QModelIndex()) -> int:  # noqa: N802, B008
        """Number of columns; none below a cell."""
        return 0 if parent.isValid() else len(Column)

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """Text, plain value, or alignment of a cell."""
        if not index.isValid():
            return None
        row, column = self._rows[index.row()], Column(index.column())
        if role == Qt.ItemDataRole.TextAlignmentRole:
            is_text = column in (Column.VIEWPOINT, Column.LOCKED)
            side = Qt.AlignmentFlag.AlignLeft if is_text else Qt.AlignmentFlag.AlignRight
            return int(side | Qt.AlignmentFlag.AlignVCenter)
        if role == SORT_ROLE:
            value = self._value(row, column)
            # Qt compares by the type of the left value: all numbers are floats, or infinity would become a whole one.
            return value if isinstance(value, str) else -math.inf if value is None else float(value)
        if role == Qt.ItemDataRole.DisplayRole:
            return self._text(row, column)
        if role == Qt.ItemDataRole.ToolTipRole and column is Column.VIEWPOINT and row.viewpoint is None:
            return self.tr("The path turns here; no photo is taken.")
        return None

    def headerData(  # noqa: N802
        self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole
    ) -> Any:
        """Title of a column with its unit, and what it means as its tip."""
        if orientation != Qt.Orientation.Horizontal or not 0 <= section < len(Column):
            return None
        if role == Qt.ItemDataRole.DisplayRole:
            return self._title(Column(section))
        if role == Qt.ItemDataRole.ToolTipRole:
            return self._tip(Column(section))
        return None

    def _column_changed(self, first: Column, last: Column) -> None:
        """Cells and titles of some columns."""
        self._rows_changed(range(len(self._rows)), first, last)
        self.headerDataChanged.emit(Qt.Orientation.Horizontal, first, last)

    def _rows_changed(self, rows: Sequence[int], first: Column, last: Column) -> None:
        """Some columns of these rows, rising, and of those between them."""
        if rows:
            self.dataChanged.emit(self.index(rows[0], first), self.index(rows[-1], last))

    def _value(self, row: WaypointRow, column: Column) -> Any:
        view = row.viewpoint
        is_local = self._position is PositionShown.LOCAL
        match column:
            case Column.SORTIE:
                return row.sortie
            case Column.NUMBER:
                return row.vertex
            case Column.VIEWPOINT:
                return "" if view is None else view.id
            case Column.FIRST:
                return row.position_enu_m[0] if is_local else row.lat_deg
            case Column.SECOND:
                return row.position_enu_m[1] if is_local else row.lon_deg
            case Column.HEIGHT:
                return row.height_m(self._height)
            case Column.ABOVE_TAKEOFF:
                return row.height_above_takeoff_m
            case Column.HEADING:
                return None if view is None else view.heading_deg
            case Column.PITCH:
                return None if view is None else view.gimbal_pitch_deg
            case Column.LEG:
                return row.leg_m
            case Column.ARRIVAL:
                return row.arrival_s
            case Column.PANELS:
                return _covered_by(row, self._panels)
            case Column.LOCKED:
                return view is not None and view.locked

    def _text(self, row: WaypointRow, column: Column) -> str:
        value = self._value(row, column)
        if value is None:
            return NO_VALUE
        if column is Column.SORTIE:
            return str(value) if value else self.tr("none")
        if column is Column.LOCKED:
            return self.tr("locked") if value else ""
        if column in LENGTHS or (column in (Column.FIRST, Column.SECOND) and self._position is PositionShown.LOCAL):
            unit = length_unit(self._units)
            return unit.text(value).removesuffix(f" {unit.symbol}")
        if column in (Column.FIRST, Column.SECOND):
            return f"{value:.7f}"
        if column in (Column.HEADING, Column.PITCH):
            return f"{value:.1f}"
        return minutes_text(value) if column is Column.ARRIVAL else str(value)

    def _title(self, column: Column) -> str:
        symbol = length_unit(self._units).symbol
        is_local = self._position is PositionShown.LOCAL
        titles = {
            Column.SORTIE: self.tr("Sortie"),
            Column.NUMBER: self.tr("No."),
            Column.VIEWPOINT: self.tr("Viewpoint"),
            Column.FIRST: self.tr("East [{0}]").format(symbol) if is_local else self.tr("Latitude [°]"),
            Column.SECOND: self.tr("North [{0}]").format(symbol) if is_local else self.tr("Longitude [°]"),
            Column.HEIGHT: self._height_title().format(symbol),
            Column.ABOVE_TAKEOFF: self.tr("Above take-off [{0}]").format(symbol),
            Column.HEADING: self.tr("Heading [°]"),
            Column.PITCH: self.tr("Gimbal [°]"),
            Column.LEG: self.tr("Leg [{0}]").format(symbol),
            Column.ARRIVAL: self.tr("Arrival"),
            Column.PANELS: self.tr("Panels"),
            Column.LOCKED: self.tr("Locked"),
        }
        return titles[column]

    def _height_title(self) -> str:
        titles = {
            HeightShown.LOCAL: self.tr("Up, local [{0}]"),
            HeightShown.AMSL: self.tr("Above sea (EGM96) [{0}]"),
            HeightShown.ELLIPSOID: self.tr("Above ellipsoid [{0}]"),
        }
        return titles[self._height]

    def _tip(self, column: Column) -> str | None:
        tips = {
            Column.NUMBER: self.tr("Place on the path of its sortie: 0 is take-off, leg 5 ends at 5"),
            Column.HEADING: self.tr("Clockwise from true north"),
            Column.PITCH: self.tr("0 level, -90 straight down"),
            Column.LEG: self.tr("Length of the leg that ends here"),
            Column.ARRIVAL: self.tr("Minutes and seconds after lift-off, with a stop at every waypoint"),
            Column.PANELS: self.tr("Panels that this photo covers; known after a check"),
        }
        return tips.get(column)


def _covered_by(row: WaypointRow, panels_covered: Mapping[str, int]) -> int | None:
    """Panels that the photo of a row covers; None where none is taken, or it is not known."""
    return None if row.viewpoint is None else panels_covered.get(row.viewpoint.id)


def item_of_row(row: WaypointRow) -> Item:
    """The viewpoint of a row, or the leg that ends at it; home for take-off."""
    if row.viewpoint is not None:
        return Item(ItemKind.VIEWPOINT, row.viewpoint.id)
    return Item(ItemKind.LEG, f"{row.sortie}/{row.vertex}") if row.vertex else Item(ItemKind.HOME)


class WaypointFilter(QSortFilterProxyModel):
    """Sorts by plain values, and shows one sortie or all, with or without the vertices between photos."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._sortie: int | None = None
        self._photos_only = False
        self.setSortRole(SORT_ROLE)

    def set_filter(self, sortie: int | None, photos_only: bool) -> None:
        """Show one sortie (None: all); `photos_only` leaves out where none is taken."""
        self._sortie, self._photos_only = sortie, photos_only
        self.invalidate()

    def filterAcceptsRow(self, source_row: int, source_parent: Index) -> bool:  # noqa: N802
        """Whether a row is shown."""
        model: WaypointModel = self.sourceModel()  # type: ignore[assignment]
        row = model.waypoint(source_row)
        return self._sortie in (None, row.sortie) and not (self._photos_only and row.viewpoint is None)


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
