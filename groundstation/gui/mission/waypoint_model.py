"""The waypoints of a plan as a Qt item model."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from enum import IntEnum, StrEnum, auto
from typing import Any

from PySide6.QtCore import QAbstractTableModel, QModelIndex, QObject, QPersistentModelIndex, QSortFilterProxyModel, Qt

from groundstation.services.document import Item, ItemKind
from groundstation.services.units import UnitSystem, length_unit, minutes_text
from groundstation.services.waypoints import HeightShown, WaypointRow

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
            changed = [number for number, row in enumerate(after) if row != before[number]]
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
