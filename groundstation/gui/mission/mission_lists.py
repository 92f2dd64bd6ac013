"""Below the shared view on the Mission tab: waypoints, profile and comparison. Only what is in sight is filled."""

from __future__ import annotations

from collections.abc import Mapping

from PySide6.QtCore import QTimer, Signal
from PySide6.QtWidgets import QStackedWidget, QTabWidget, QWidget

from groundstation.gui.mission.comparison_view import ComparisonView
from groundstation.gui.mission.profile_chart import ProfileChart
from groundstation.gui.mission.waypoint_table import WaypointTable
from groundstation.services.document import Item
from groundstation.services.mission_compare import MissionComparison
from groundstation.services.profiles import height_limits, plan_profiles
from groundstation.services.units import UnitSystem
from groundstation.services.waypoints import waypoint_rows
from planning.plan import Plan
from planning.site import SiteModel


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
