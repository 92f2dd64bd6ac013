"""Below the shared view on the Mission tab: waypoints, profile and comparison. Only what is in sight is filled."""

from __future__ import annotations

from collections.abc import Mapping

from PySide6.QtCore import QModelIndex, Qt, QTimer, Signal
from PySide6.QtGui import QStandardItem, QStandardItemModel
from PySide6.QtWidgets import QAbstractItemView, QHeaderView, QStackedWidget, QTableView, QTabWidget, QWidget

from groundstation.gui.charts.profile_chart import ProfileChart
from groundstation.gui.map.map_paint import sortie_colour
from groundstation.gui.mission.comparison_view import ComparisonView
from groundstation.gui.widgets.waypoint_table import WaypointTable
from groundstation.services.mission.compare import MissionComparison
from groundstation.services.mission.waypoints import height_limits, plan_profiles, waypoint_rows
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.units import UnitSystem, distance_unit, minutes_text
from planning.plan import Plan
from planning.site.records import SiteModel

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
        self._rows.setHorizontalHeaderLabels(titles)
        if self._plan is not None:
            extra_s = self._plan.rules.takeoff_landing_s
            text = self.tr("With {0:.0f} s for take-off and landing, which the height profile does not show")
            self._rows.horizontalHeaderItem(2).setToolTip(text.format(extra_s))
        self._rows.horizontalHeaderItem(3).setToolTip(self.tr("Length of the flight"))
        self._rows.horizontalHeaderItem(4).setToolTip(self.tr("Part of the battery's endurance that the sortie takes"))
        plan = self._plan
        for number, sortie in enumerate(() if plan is None else plan.sorties, 1):
            texts = [
                str(number),
                str(len(sortie.viewpoint_ids)),
                minutes_text(sortie.duration_s),
                f"{unit.shown(sortie.length_m):.{unit.decimals}f}",
                f"{sortie.duration_s / plan.aircraft.endurance_s:.0%}",
            ]
            cells = [QStandardItem(text) for text in texts]
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
        self._unfilled: set[QWidget] = set()
        # After an edit the 3-D view draws, too: each in a turn of its own keeps the window answering.
        self._fill_soon = QTimer(self, interval=0, singleShot=True)
        self._fill_soon.timeout.connect(self._fill)
        self._bars = QStackedWidget()
        for view, title in (
            (self.waypoints, self.tr("Waypoints")),
            (self.profile, self.tr("Profile")),
            (self.comparison, self.tr("Comparison")),
        ):
            self.addTab(view, title)
            self._bars.addWidget(view.bar)
        self.setCornerWidget(self._bars)
        self.currentChanged.connect(self._list_changed)
        self.waypoints.picked.connect(self.picked)
        for looked_at in (self.waypoints.activated, self.profile.picked, self.comparison.picked):
            looked_at.connect(self.activated)

    def set_plan(self, plan: Plan | None, site_model: SiteModel | None) -> None:
        """Show another plan, or none; a comparison with the one before goes."""
        self._plan, self._site_model, self._panels_covered = plan, site_model, {}
        self._unfilled = {self.waypoints, self.profile}
        self.comparison.set_comparison(None)
        self._fill_soon.start()

    def set_panels_covered(self, panels_covered: Mapping[str, int]) -> None:
        """Say how many panels each viewpoint of the plan covers."""
        self._panels_covered = panels_covered
        self.waypoints.set_panels_covered(panels_covered)

    def set_selection(self, item: Item | None) -> None:
        """Mark a thing; no signal comes from it."""
        self._selection = item
        for view in {self.waypoints, self.profile} - self._unfilled:
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
        view, plan, site_model = self.currentWidget(), self._plan, self._site_model
        if view not in self._unfilled:
            return
        self._unfilled.remove(view)
        has_both = plan is not None and site_model is not None
        if view is self.waypoints:
            self.waypoints.set_rows(waypoint_rows(plan, site_model.site.origin) if has_both else ())
            self.waypoints.set_panels_covered(self._panels_covered)
        else:
            limits = None if site_model is None else height_limits(site_model)
            self.profile.set_curves(plan_profiles(plan) if has_both else (), limits)
        view.set_selection(self._selection)
