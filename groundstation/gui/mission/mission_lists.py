"""Below the shared view on the Mission tab: waypoints, profile and comparison. Only what is in sight is filled."""

from __future__ import annotations

from collections.abc import Mapping

from PySide6.QtCore import QModelIndex, QSortFilterProxyModel, Qt, QTimer, Signal
from PySide6.QtGui import QStandardItem, QStandardItemModel
from PySide6.QtWidgets import (
    QAbstractItemView,
    QCheckBox,
    QHeaderView,
    QLabel,
    QTableView,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.charts.profile_chart import ProfileChart
from groundstation.gui.map.map_paint import sortie_colour
from groundstation.gui.widgets.findings_list import severity_icon
from groundstation.gui.widgets.scrolling import TabsCorner
from groundstation.gui.widgets.theme import colours
from groundstation.gui.widgets.waypoint_table import WaypointTable
from groundstation.services.mission.compare import Difference, MissionComparison, PhotoComparison
from groundstation.services.mission.waypoints import height_limits, plan_profiles, waypoint_rows
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.units import UnitSystem, distance_unit, length_unit, minutes_text
from planning.base.findings import Severity
from planning.plan import Plan
from planning.site.ground import ground_of
from planning.site.records import SiteModel

# Is this mission file the plan? The answer, and the photos that differ.

ID_ROLE = Qt.ItemDataRole.UserRole
SORT_ROLE = Qt.ItemDataRole.UserRole + 1

SEVERITY_OF = {
    Difference.SAME: Severity.OK,
    Difference.CHANGED: Severity.WARNING,
    Difference.MISSING: Severity.ERROR,
    Difference.EXTRA: Severity.ERROR,
}


class ComparisonView(QWidget):
    """Shows one comparison. `bar` chooses what is listed; put it where there is room.

    Signals
    -------
    picked(Item)
        The user went to a photo of the plan.
    """

    picked = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._comparison: MissionComparison | None = None
        self._names = ""
        self._units = UnitSystem.METRIC
        self._answer = QLabel()
        self._answer.setWordWrap(True)
        self._all = QCheckBox(self.tr("Also what is the same"), self)
        self._rows = QStandardItemModel(self)
        self._sorted = QSortFilterProxyModel(self)
        self._sorted.setSourceModel(self._rows)
        self._sorted.setSortRole(SORT_ROLE)
        self._table = QTableView()
        self._table.setModel(self._sorted)
        self._table.setSortingEnabled(True)
        self._table.horizontalHeader().setSortIndicatorClearable(True)
        self._table.sortByColumn(-1, Qt.SortOrder.AscendingOrder)
        self._table.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self._table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self._table.setTabKeyNavigation(False)
        self._table.verticalHeader().hide()
        self._table.setAccessibleName(self.tr("Differences"))
        self.bar = self._all
        layout = QVBoxLayout(self)
        layout.setContentsMargins(4, 4, 4, 0)
        layout.addWidget(self._answer)
        layout.addWidget(self._table, 1)
        self._all.toggled.connect(self._fill)
        self._table.clicked.connect(self._row_picked)
        self._fill()

    def set_comparison(self, comparison: MissionComparison | None, names: str = "") -> None:
        """Show a comparison with the files of these names; None for none."""
        if comparison is self._comparison:
            return
        self._comparison, self._names = comparison, names
        self._fill()

    def set_units(self, units: UnitSystem) -> None:
        """Show distances in other units."""
        self._units = units
        self._fill()

    def answer(self) -> str:
        """The answer as it is read."""
        return self._answer.text()

    def table(self) -> QTableView:
        """The table, for focus and tests."""
        return self._table

    def _fill(self) -> None:
        symbol = length_unit(self._units).symbol
        self._rows.clear()
        self._rows.setHorizontalHeaderLabels(
            [
                self.tr("Photo"),
                self.tr("Viewpoint"),
                self.tr("Sortie"),
                self.tr("In the file"),
                self.tr("Moved [{0}]").format(symbol),
                self.tr("Turned [°]"),
                self.tr("Tilted [°]"),
                self.tr("Order"),
            ]
        )
        self._say_answer()
        for photo in () if self._comparison is None else self._comparison.photos:
            is_plain = photo.difference is Difference.SAME and not photo.is_out_of_order
            if self._all.isChecked() or not is_plain:
                self._rows.appendRow(self._row(photo))
        self._table.resizeColumnsToContents()

    def _row(self, photo: PhotoComparison) -> list[QStandardItem]:
        words = {
            Difference.SAME: self.tr("the same"),
            Difference.CHANGED: self.tr("changed"),
            Difference.MISSING: self.tr("missing in the file"),
            Difference.EXTRA: self.tr("not planned"),
        }
        in_file = f"{photo.file_sortie}/{photo.file_number}" if photo.file_sortie else ""
        first = QStandardItem(severity_icon(SEVERITY_OF[photo.difference], colours()), words[photo.difference])
        first.setData(photo.viewpoint_id, ID_ROLE)
        first.setData(list(Difference).index(photo.difference), SORT_ROLE)
        unit = length_unit(self._units)
        return [
            first,
            _cell(photo.viewpoint_id, photo.viewpoint_id),
            _cell(str(photo.sortie or ""), float(photo.sortie)),
            _cell(in_file, photo.file_sortie * 1e6 + photo.file_number),
            _number(None if photo.distance_m is None else unit.shown(photo.distance_m), 2),
            _number(photo.heading_deg, 1),
            _number(photo.pitch_deg, 1),
            _cell(self.tr("out of order") if photo.is_out_of_order else "", float(photo.is_out_of_order)),
        ]

    def _say_answer(self) -> None:
        found = self._comparison
        if found is None:
            role, text = "muted", self.tr('"Compare with file" reads a mission file back and shows what differs.')
        elif found.is_the_plan:
            role = "ok"
            text = self.tr("{0} is the plan: all {1} photos, in order, along the same path.").format(
                self._names, len(found.photos)
            )
            if found.path_deviation_m is None:
                text = self.tr("{0} has all {1} photos of the plan, in order. It holds no path to compare.").format(
                    self._names, len(found.photos)
                )
        elif found.missing_sorties:
            role = "warning"
            text = self.tr(
                "{0} is only a part of the plan, as planned. Sorties without a file: {1}. Choose the files of all "
                "sorties together."
            ).format(self._names, ", ".join(map(str, found.missing_sorties)))
        else:
            role, text = self._objection(found)
            if found.path_deviation_m is not None:
                away = length_unit(self._units).text(found.path_deviation_m)
                text = self.tr("{0}; the paths are up to {1} apart.").format(text, away)
        self._answer.setProperty("role", role)
        self._answer.style().polish(self._answer)
        self._answer.setText(text)

    def _objection(self, found: MissionComparison) -> tuple[str, str]:
        """How the files differ from the plan, and the role of that text."""
        if found.has_the_photos:
            text = self.tr("{0} takes all {1} photos of the plan, but flies otherwise: {2} out of order")
            return "warning", text.format(self._names, len(found.photos), found.n_out_of_order)
        text = self.tr(
            "{0} is NOT the plan: {1} photos the same, {2} changed, {3} missing, {4} not planned, {5} out of order"
        )
        counts = (found.count(difference) for difference in Difference)
        return "error", text.format(self._names, *counts, found.n_out_of_order)

    def _row_picked(self, index: QModelIndex) -> None:
        viewpoint_id = index.siblingAtColumn(0).data(ID_ROLE)
        if viewpoint_id:
            self.picked.emit(Item(ItemKind.VIEWPOINT, viewpoint_id))


def _cell(text: str, value: object) -> QStandardItem:
    cell = QStandardItem(text)
    cell.setData(value, SORT_ROLE)
    return cell


def _number(value: float | None, decimals: int) -> QStandardItem:
    cell = _cell("" if value is None else f"{value:.{decimals}f}", -1.0 if value is None else abs(value))
    cell.setTextAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
    return cell


# The sorties of a plan in numbers: what each takes of a battery.


class SortieTable(QTableView):
    """One row a sortie.

    Signals
    -------
    picked(Item)
        The user went to a sortie.
    """

    picked = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._plan: Plan | None = None
        self._units = UnitSystem.METRIC
        self._rows = QStandardItemModel(self)
        self.setModel(self._rows)
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setTabKeyNavigation(False)
        self.verticalHeader().hide()
        # Large type leaves no room for columns of equal width.
        self.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        self.horizontalHeader().setStretchLastSection(True)
        self.setAccessibleName(self.tr("Sorties"))
        self.clicked.connect(self._row_picked)

    def set_plan(self, plan: Plan | None) -> None:
        """Show the sorties of another plan."""
        self._plan = plan
        self._fill()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        self._fill()

    def _fill(self) -> None:
        self._rows.clear()
        unit = distance_unit(self._units)
        titles = [
            self.tr("No."),
            self.tr("Photos"),
            self.tr("Time"),
            unit.symbol,
            self.tr("Used"),
        ]
        if self._plan is not None and self._plan.landed_s is not None:
            titles.insert(1, self.tr("Start"))
        self._rows.setHorizontalHeaderLabels(titles)
        tips = {len(titles) - 2: self.tr("Length of the flight")}
        tips[len(titles) - 1] = self.tr("Part of the battery's endurance that the sortie takes")
        if self._plan is not None:
            text = self.tr("With {0:.0f} s for take-off and landing, which the height profile does not show")
            tips[len(titles) - 3] = text.format(self._plan.rules.takeoff_landing_s)
        for column, tip in tips.items():
            # Not by `horizontalHeaderItem`: PySide takes what lies later where such an item lay for the item still.
            self._rows.setHeaderData(column, Qt.Orientation.Horizontal, tip, Qt.ItemDataRole.ToolTipRole)
        if self._plan is None:
            return
        for number, sortie in enumerate(self._plan.sorties, 1):
            texts = [
                str(number),
                str(len(sortie.viewpoint_ids)),
                minutes_text(sortie.duration_s),
                f"{unit.shown(sortie.length_m):.{unit.decimals}f}",
                f"{sortie.duration_s / self._plan.aircraft.endurance_s:.0%}",
            ]
            cells = [QStandardItem(text) for text in texts]
            if sortie.start_s is not None:
                start = minutes_text(sortie.start_s)
                cells.insert(1, QStandardItem(f"{sortie.aircraft}: {start}"))
                cells[1].setToolTip(self.tr("Aircraft {0} starts at {1}").format(sortie.aircraft, start))
            for cell in cells:
                cell.setTextAlignment(Qt.AlignmentFlag.AlignCenter)
            cells[0].setForeground(sortie_colour(number))
            self._rows.appendRow(cells)

    def _row_picked(self, index: QModelIndex) -> None:
        self.picked.emit(Item(ItemKind.SORTIE, str(index.row() + 1)))


class MissionLists(QTabWidget):
    """Shows one plan; what each list lets choose stands beside the tabs, where it takes no height.

    Signals
    -------
    picked(Item), activated(Item)
        The user went to a thing; the user wants to look at it.
    """

    picked = Signal(object)
    activated = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._plan: Plan | None = None
        self._site_model: SiteModel | None = None
        self._panels_covered: Mapping[str, int] = {}
        self._selection: Item | None = None
        self.waypoints, self.profile, self.comparison = WaypointTable(), ProfileChart(), ComparisonView()
        self._filled_late: frozenset[WaypointTable | ProfileChart] = frozenset((self.waypoints, self.profile))
        self._unfilled: set[WaypointTable | ProfileChart] = set()
        # After an edit the 3-D view draws, too: each in a turn of its own keeps the window answering.
        self._fill_soon = QTimer(self, interval=0, singleShot=True)
        self._fill_soon.timeout.connect(self._fill)
        self._bars = TabsCorner(self)
        for view, title in (
            (self.waypoints, self.tr("Waypoints")),
            (self.profile, self.tr("Profile")),
            (self.comparison, self.tr("Comparison")),
        ):
            self.addTab(view, title)
            self._bars.addWidget(view.bar)
        self.currentChanged.connect(self._list_changed)
        self.waypoints.picked.connect(self.picked)
        for looked_at in (self.waypoints.activated, self.profile.picked, self.comparison.picked):
            looked_at.connect(self.activated)

    def set_plan(self, plan: Plan | None, site_model: SiteModel | None) -> None:
        """Show another plan, or none; a comparison with the one before goes."""
        self._plan, self._site_model, self._panels_covered = plan, site_model, {}
        self._unfilled = set(self._filled_late)
        self.comparison.set_comparison(None)
        self._fill_soon.start()

    def set_panels_covered(self, panels_covered: Mapping[str, int]) -> None:
        """Say how many panels each viewpoint of the plan covers."""
        self._panels_covered = panels_covered
        self.waypoints.set_panels_covered(panels_covered)

    def set_selection(self, item: Item | None) -> None:
        """Mark a thing; no signal comes from it."""
        self._selection = item
        for view in self._filled_late - self._unfilled:
            view.set_selection(item)

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths and speeds in other units."""
        for view in (self.waypoints, self.profile, self.comparison):
            view.set_units(units)

    def show_comparison(self, comparison: MissionComparison, names: str) -> None:
        """Show a comparison with the files of these names, in front."""
        self.comparison.set_comparison(comparison, names)
        self.setCurrentWidget(self.comparison)

    def _list_changed(self, index: int) -> None:
        self._bars.setCurrentIndex(index)
        self._fill()

    def _fill(self) -> None:
        """Fill the list in sight, where it still shows another plan."""
        plan, site_model = self._plan, self._site_model
        for view in tuple(self._unfilled):
            if view is not self.currentWidget():
                continue
            self._unfilled.remove(view)
            if view is self.waypoints:
                origin = None if site_model is None else site_model.site.origin
                self.waypoints.set_rows(() if plan is None or origin is None else waypoint_rows(plan, origin))
                self.waypoints.set_panels_covered(self._panels_covered)
            else:
                if plan is None or site_model is None:
                    self.profile.set_curves((), None)
                else:
                    self.profile.set_curves(plan_profiles(plan, ground_of(site_model.site)), height_limits(site_model))
            view.set_selection(self._selection)
