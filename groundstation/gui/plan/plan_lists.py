"""Below the view: viewpoints, what is not covered, clearance along the route, and all plans, also side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QItemSelectionModel, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QColor, QFont, QShowEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QDialog,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSplitter,
    QTableWidget,
    QTableWidgetItem,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.charts.profile_chart import ClearanceChart
from groundstation.gui.plan.plan_controller import PlanController, method_name
from groundstation.gui.view3d.orbit import Orbit
from groundstation.gui.view3d.paint import ColourScale, ValueKind
from groundstation.gui.view3d.scene_view import SceneView
from groundstation.gui.widgets.inputs import ChoiceBox
from groundstation.gui.widgets.questions import ask_text, choose_file
from groundstation.gui.widgets.scrolling import TabsCorner
from groundstation.gui.widgets.table_view import Column, RowModel, table_of
from groundstation.gui.widgets.theme import colours
from groundstation.gui.widgets.waypoint_table import WaypointTable
from groundstation.services.jobs.runner import Job
from groundstation.services.mission.waypoints import waypoint_rows
from groundstation.services.plan.comparison import compare, distinct_titles, marked_as_best
from groundstation.services.plan.plan_cache import ActivePlan
from groundstation.services.plan.reach_summary import ReachGroup, reach_groups
from groundstation.services.project.document import Document, Item, ItemKind, PlanEntry
from groundstation.services.units import UnitSystem, distance_unit, length_unit, minutes_text, sampling_unit
from planning.base.findings import Severity
from planning.geo.frames import Origin
from planning.insight.clearance import RouteClearance, route_clearance
from planning.insight.comparison import Comparison, Row
from planning.insight.obstructions import obstructions_of
from planning.insight.reasons import Rule
from planning.insight.sections import PlanInsight, SectionState
from planning.plan import Plan
from planning.site.records import SiteModel

# Plans side by side: two 3-D pictures that move together, and a table of all measures.


class CompareWindow(QDialog):
    """Two of the plans as pictures, all of them in a table."""

    def __init__(
        self,
        context: ApplicationContext,
        site: SiteModel,
        entries: tuple[PlanEntry, ...],
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Compare plans"))
        self.setWindowFlag(Qt.WindowType.WindowMaximizeButtonHint)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.resize(1200, 680)
        self._context, self._site, self._entries = context, site, entries
        self._comparison: Comparison | None = None
        self._choices, self._scenes = (ChoiceBox(), ChoiceBox()), (SceneView(self), SceneView(self))
        self._paint = ChoiceBox()
        self._paint.addItems([self.tr("coverage"), self.tr("difference in coverage"), self.tr("GSD")])
        self._words = QLabel()
        self._words.setWordWrap(True)
        self._table = QTableWidget()
        self._lay_out()
        names = distinct_titles(entries)
        for number, (choice, scene) in enumerate(zip(self._choices, self._scenes, strict=True)):
            choice.addItems(names)
            choice.setCurrentIndex(number)
            scene.set_units(context.units)
            scene.set_site(site)
            choice.currentIndexChanged.connect(self._show_pictures)
        first, second = self._scenes
        first.orbitChanged.connect(second.set_orbit)
        second.orbitChanged.connect(first.set_orbit)
        self._paint.currentIndexChanged.connect(self._show_pictures)
        self._show_pictures()
        plans = tuple(entry.plan for entry in entries)
        self._job = context.start(
            self.tr("Compare plans"),
            lambda context: compare(site, plans, names, monitor=context),
            self._compared,
            lambda error: self._words.setText(context.localized(str(error))),
        )

    def _lay_out(self) -> None:
        pictures = QSplitter(Qt.Orientation.Horizontal)
        for choice, scene in zip(self._choices, self._scenes, strict=True):
            side = QWidget()
            layout = QVBoxLayout(side)
            layout.setContentsMargins(0, 0, 0, 0)
            layout.addWidget(choice)
            layout.addWidget(scene, 1)
            pictures.addWidget(side)
        above = QHBoxLayout()
        above.addWidget(QLabel(self.tr("Panels by")))
        above.addWidget(self._paint)
        above.addWidget(self._words, 1)
        self._table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self._table.setTabKeyNavigation(False)
        self._table.setAccessibleName(self.tr("Plans compared"))
        self._table.horizontalHeader().setStretchLastSection(True)
        whole = QSplitter(Qt.Orientation.Vertical)
        whole.addWidget(pictures)
        whole.addWidget(self._table)
        whole.setStretchFactor(0, 3)
        whole.setStretchFactor(1, 2)
        layout = QVBoxLayout(self)
        layout.addLayout(above)
        layout.addWidget(whole, 1)

    def table(self) -> QTableWidget:
        """The table, for tests and screenshots."""
        return self._table

    def orbits(self) -> tuple[Orbit, Orbit]:
        """Where the two pictures are looked at from."""
        first, second = self._scenes
        return first.orbit(), second.orbit()

    def scenes(self) -> tuple[SceneView, SceneView]:
        """The two pictures."""
        return self._scenes

    def _compared(self, comparison: Comparison) -> None:
        self._comparison = comparison
        constraints = comparison.constraints
        settings = {"auto": self.tr("auto"), "on": self.tr("on"), "off": self.tr("off")}
        words = self.tr(
            "All plans judged with {0:g} degree sections, {1}, occlusion {2}. A star marks the better."
        ).format(
            constraints.section_step_deg,
            length_unit(self._context.units).text(constraints.min_distance_m),
            settings[constraints.occlusion],
        )
        self._words.setText(" ".join([words, *map(self._context.localized, comparison.notes)]))
        self._fill_table(comparison)
        self._show_pictures()

    def _fill_table(self, comparison: Comparison) -> None:
        table = self._table
        table.setRowCount(len(comparison.rows))
        table.setColumnCount(len(comparison.names))
        table.setHorizontalHeaderLabels(list(comparison.names))
        table.setVerticalHeaderLabels([self._label(row) for row in comparison.rows])
        bold = QFont()
        bold.setBold(True)
        for number, row in enumerate(comparison.rows):
            texts = [self._value_text(value, row.unit) for value in row.values]
            for column, (text, is_best) in enumerate(zip(texts, marked_as_best(texts, row.best), strict=True)):
                cell = QTableWidgetItem(text + (" ★" if is_best else ""))
                cell.setTextAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
                if is_best:
                    cell.setFont(bold)
                    cell.setForeground(QColor(colours().ok))
                table.setItem(number, column, cell)
        table.resizeColumnsToContents()

    def _value_text(self, value: float | None, unit: str) -> str:
        units: UnitSystem = self._context.units
        if value is None:
            return "-"
        match unit:
            case "share":
                return f"{100.0 * value:.2f} %"
            case "s":
                return minutes_text(value) if value >= 60.0 else self.tr("{0:.1f} s").format(value)
            case "m/px":
                return sampling_unit(units).text(value)
            case "m":
                return length_unit(units).text(value)
            case _:
                return f"{value:g}"

    def _label(self, row: Row) -> str:
        texts = {
            "views": self.tr("Views"),
            "sorties": self.tr("Sorties"),
            "duration": self.tr("Time in the air"),
            "length": self.tr("Distance"),
            "found-after": self.tr("Views found after"),
            "covered": self.tr("Sections covered"),
            "covered-share": self.tr("of all sections"),
            "possible-share": self.tr("of what can be covered"),
            "facade-share": self.tr("Facade {0}, of what can be covered"),
            "only-here": self.tr("Sections no other plan covers"),
            "depth": self.tr("Covered at least {0} times"),
            "gsd-best": self.tr("Finest pixel"),
            "gsd-worst": self.tr("Coarsest GSD"),
            "gsd-worst-panel": self.tr("Finest pixel on the worst panel"),
            "clearance": self.tr("Smallest clearance"),
            "findings": self.tr("Findings: {0}"),
        }
        return texts.get(row.code, row.label).format(row.subject)

    def _show_pictures(self) -> None:
        chosen = [choice.currentIndex() for choice in self._choices]
        for number, scene in enumerate(self._scenes):
            scene.set_plan(self._entries[chosen[number]].plan)
            scene.set_panel_values(*self._panel_values(chosen[number], chosen[1 - number]))

    def _panel_values(self, own: int, other: int) -> tuple[ColourScale | None, np.ndarray | None]:
        found = self._comparison
        if found is None:
            return None, None
        possible = found.is_possible.sum(axis=1)
        match self._paint.currentIndex():
            case 0:
                covered = ((found.counts[own] > 0) & found.is_possible).sum(axis=1)
                share = np.where(possible > 0, 100.0 * covered / np.maximum(possible, 1), np.nan)
                return ColourScale(self.tr("Covered of what is possible"), "%", 0.0, 100.0), share
            case 1:
                more = found.more_covered_per_panel(own, other).astype(np.float64)
                reach = max(1.0, float(np.abs(more).max()))
                return ColourScale(self.tr("Sections more than the other"), "", -reach, reach), more
            case _:
                unit = sampling_unit(self._context.units)
                values = unit.factor * np.stack([found.sampling[own].best_m, found.sampling[other].best_m])
                known = values[np.isfinite(values)]
                if len(known) == 0:
                    return None, None
                low, high = float(known.min()), max(float(known.max()), 1.01 * float(known.min()) + 1e-9)
                title, kind = self.tr("Finest pixel"), ValueKind.LOW_IS_GOOD
                return ColourScale(title, unit.symbol, low, high, kind), values[0]

    def setVisible(self, visible: bool) -> None:  # noqa: N802
        """Both pictures choose their view once they have a size."""
        super().setVisible(visible)
        if visible:
            with QSignalBlocker(self._scenes[0]):
                self._scenes[0].look_at_all()
            self._scenes[1].set_orbit(self._scenes[0].orbit())

    def done(self, result: int) -> None:
        """Free the pictures, and do not wait for the table."""
        self._context.cancel(self._job, quietly=True)
        for scene in self._scenes:
            scene.close_view()
        super().done(result)


# The plans of a project: which is looked at, which two are compared; rename, remove, bring in another.


class PlansList(QWidget):
    """A table of plans with what can be done to them.

    Signals
    -------
    chosen(str), renamed(str, str), removed(str), compareRequested(tuple of str), openRequested()
        Identifiers of plans.
    """

    chosen = Signal(str)
    renamed = Signal(str, str)
    removed = Signal(str)
    compareRequested = Signal(object)  # noqa: N815  (Qt's own way of naming)
    openRequested = Signal()  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._units = UnitSystem.METRIC
        self._current = ""
        self._model: RowModel[PlanEntry] = RowModel(self._columns(), self)
        self._view = table_of(self._model, self.tr("Plans"))
        self._view.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        buttons = QGridLayout()
        self._use = QPushButton(self.tr("Make current"))
        self._use.setToolTip(self.tr("Look at this plan, edit, export and fly it; a double click does so too"))
        self._compare = QPushButton(self.tr("Compare"))
        self._compare.setToolTip(self.tr("Show the selected plans side by side (two or more)"))
        self._rename = QPushButton(self.tr("Rename ..."))
        self._remove = QPushButton(self.tr("Delete"))
        self._open = QPushButton(self.tr("Open plan ..."))
        made = (self._use, self._compare, self._rename, self._remove, self._open)
        for number, button in enumerate(made):
            buttons.addWidget(button, number // 2, number % 2)
        buttons.setRowStretch(len(made), 1)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(4, 4, 4, 4)
        layout.addWidget(self._view, 1)
        layout.addLayout(buttons)
        self._use.clicked.connect(lambda: self.chosen.emit(self.selected()[0]))
        self._compare.clicked.connect(lambda: self.compareRequested.emit(self.selected()))
        self._rename.clicked.connect(self._ask_name)
        self._remove.clicked.connect(lambda: self.removed.emit(self.selected()[0]))
        self._open.clicked.connect(lambda: self.openRequested.emit())
        self._view.selectionModel().selectionChanged.connect(lambda *_: self._update())
        for signal in (self._view.activated, self._view.doubleClicked):
            signal.connect(lambda index: self.chosen.emit(self._model.row(index).id))
        self._update()

    def set_document(self, document: Document) -> None:
        """Show the plans of a document."""
        self._current = document.current_plan_id
        if self._model.rows() != document.plans:
            chosen = self.selected()
            has_same_titles = [entry.title for entry in self._model.rows()] == [entry.title for entry in document.plans]
            self._model.set_rows(document.plans)
            self.select(chosen)
            # An edit of a plan changes no width that matters, and measuring takes longer than the edit.
            if not has_same_titles:
                self._view.resizeColumnsToContents()
        else:
            self._view.viewport().update()
        self._update()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        chosen = self.selected()
        self._model.set_columns(self._columns())
        self.select(chosen)

    def select(self, plan_ids: tuple[str, ...]) -> None:
        """Select plans."""
        selection = self._view.selectionModel()
        selection.clear()
        flags = QItemSelectionModel.SelectionFlag
        for number, entry in enumerate(self._model.rows()):
            if entry.id in plan_ids:
                selection.select(self._model.index(number, 0), flags.Select | flags.Rows)

    def selected(self) -> tuple[str, ...]:
        """Identifiers of the selected plans, in the order of the table."""
        rows = sorted(index.row() for index in self._view.selectionModel().selectedRows())
        return tuple(self._model.rows()[row].id for row in rows)

    def _columns(self) -> tuple[Column[PlanEntry], ...]:
        unit = distance_unit(self._units)
        return (
            Column("", lambda entry: "●" if entry.id == self._current else ""),
            Column(self.tr("Plan"), lambda entry: entry.title),
            Column(self.tr("Method"), lambda entry: method_name(entry.plan.method)),
            Column(self.tr("Views"), lambda entry: str(len(entry.plan.viewpoints)), is_number=True),
            Column(self.tr("Covered"), lambda entry: str(entry.plan.coverage.covered), is_number=True),
            Column(self.tr("of at most"), lambda entry: str(entry.plan.coverage.reachable_upper_bound), is_number=True),
            Column(self.tr("Sorties"), lambda entry: str(len(entry.plan.sorties)), is_number=True),
            Column(self.tr("Duration"), lambda entry: minutes_text(entry.plan.duration_s), is_number=True),
            Column(
                self.tr("Length"),
                lambda entry: unit.text(sum(sortie.length_m for sortie in entry.plan.sorties)),
                is_number=True,
            ),
        )

    def _update(self) -> None:
        selected = self.selected()
        n = len(selected)
        # A click selects, to compare or rename: it must not change which plan is flown.
        self._use.setEnabled(n == 1 and selected[0] != self._current)
        self._compare.setEnabled(n >= 2)
        self._rename.setEnabled(n == 1)
        self._remove.setEnabled(n == 1)

    def _ask_name(self) -> None:
        entry = next(entry for entry in self._model.rows() if entry.id == self.selected()[0])
        name = ask_text(self, self.tr("Rename plan"), self.tr("Name"), entry.title)
        if name is not None and name.strip():
            self.renamed.emit(entry.id, name.strip())


# Sections that the plan does not cover: why nobody can see them, or that more views would.


@dataclass(frozen=True, slots=True)
class ReasonRow:
    """Sections with the same reason: how many, on how many panels, the one that lacks least, and where that is."""

    reason: str
    n_sections: int
    n_panels: int
    example: str
    panel_id: str
    section: int


class ReachTable(QWidget):
    """One line per reason.

    Signals
    -------
    picked(str, int)
        Panel and section of the example in the line that was clicked.
    """

    picked = Signal(str, int)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._summary = QLabel()
        self._summary.setWordWrap(True)
        self._model: RowModel[ReasonRow] = RowModel(
            (
                Column(self.tr("Why not"), lambda row: row.reason),
                Column(self.tr("Sections"), lambda row: str(row.n_sections), is_number=True),
                Column(self.tr("Panels"), lambda row: str(row.n_panels), is_number=True),
                Column(self.tr("What lacks least"), lambda row: ": ".join(filter(None, (row.panel_id, row.example)))),
            ),
            self,
        )
        self._view = table_of(self._model, self.tr("Sections that are not covered"))
        layout = QVBoxLayout(self)
        layout.setContentsMargins(4, 4, 4, 4)
        layout.addWidget(self._summary)
        layout.addWidget(self._view, 1)
        self._view.clicked.connect(lambda index: self._pick(self._model.row(index)))
        self._view.activated.connect(lambda index: self._pick(self._model.row(index)))

    def set_rows(self, summary: str, rows: Sequence[ReasonRow]) -> None:
        """Show reasons below a sentence about all of them."""
        self._summary.setText(summary)
        self._model.set_rows(rows)
        self._view.resizeColumnsToContents()

    def rows(self) -> tuple[ReasonRow, ...]:
        """What is shown."""
        return self._model.rows()

    def _pick(self, row: ReasonRow) -> None:
        self.picked.emit(row.panel_id, row.section)


class PlanLists(QTabWidget):
    """Four pages.

    Signals
    -------
    sectionPicked(str, int)
        Panel and section.
    """

    sectionPicked = Signal(str, int)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, context: ApplicationContext, controller: PlanController) -> None:
        super().__init__()
        self._context, self._controller = context, controller
        self._measuring: Job[object] | None = None
        self._listed: tuple[Plan | None, Origin | None] = (None, None)
        self._counted: ActivePlan | None = None
        self._explained: ActivePlan | None = None
        self._measured: tuple[ActivePlan | None, int] = (None, 0)
        self.compare_window: QWidget | None = None
        self.waypoints = WaypointTable()
        self.reach, self.clearance, self.plans = ReachTable(), ClearanceChart(), PlansList()
        self._make_pages()
        self._connect()
        self._show_document(context.document)

    def _make_pages(self) -> None:
        self.addTab(self.waypoints, self.tr("Viewpoints"))
        self.addTab(self.reach, self.tr("Not covered"))
        self.addTab(self.clearance, self.tr("Clearance"))
        self.addTab(self.plans, self.tr("Plans"))
        # What the table lets choose takes no height beside the titles.
        beside = TabsCorner(self)
        beside.addWidget(self.waypoints.bar)
        self.currentChanged.connect(lambda page: beside.setVisible(page == 0))

    def _connect(self) -> None:
        controller, context = self._controller, self._context
        self.waypoints.picked.connect(context.select)
        self.waypoints.activated.connect(context.jump_to)
        self.reach.picked.connect(self.sectionPicked)
        self.clearance.sortieChosen.connect(lambda _number: self._measure_clearance())
        self.clearance.legPicked.connect(lambda sortie, leg: context.jump_to(Item(ItemKind.LEG, f"{sortie}/{leg}")))
        self.currentChanged.connect(lambda _page: self._fill_page())
        plans = self.plans
        plans.chosen.connect(controller.choose)
        plans.renamed.connect(controller.rename)
        plans.removed.connect(controller.remove)
        plans.openRequested.connect(self._ask_plan)
        plans.compareRequested.connect(self.compare)
        controller.activePlanChanged.connect(lambda _active: self._fill_page())
        context.documentChanged.connect(self._document_changed)
        context.selectionChanged.connect(self._show_selection)

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        for widget in (self.waypoints, self.clearance, self.plans):
            widget.set_units(units)

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802
        """Catch up with what changed meanwhile."""
        super().showEvent(event)
        self._fill_page()

    # What changes

    def _document_changed(self, _before: Document, after: Document) -> None:
        self._show_document(after)

    def _show_document(self, document: Document) -> None:
        self.plans.set_document(document)
        entry = document.current
        self.clearance.set_sorties(0 if entry is None else len(entry.plan.sorties))
        self._fill_page()

    def _fill_page(self) -> None:
        """Bring the page that is seen up to date; rows of a thousand viewpoints take longer than an edit."""
        if not self.isVisible():
            return
        page = self.currentWidget()
        if page is self.waypoints:
            self._list_viewpoints()
        elif page is self.reach:
            self._explain()
        elif page is self.clearance:
            self._measure_clearance()

    def _list_viewpoints(self) -> None:
        document, active = self._context.document, self._controller.active
        plan = None if document.current is None else document.current.plan
        origin = None if document.site is None else document.site.site.origin
        if self._listed[0] is not plan or self._listed[1] is not origin:
            self._listed = (plan, origin)
            self.waypoints.set_rows(() if plan is None else waypoint_rows(plan, origin))
        if self._counted is not active:
            self._counted = active
            self.waypoints.set_panels_covered(_panels_covered(active))
        self._show_selection()

    def _show_selection(self, _item: Item | None = None) -> None:
        if self.waypoints.isVisible():
            self.waypoints.set_selection(self._context.selection)

    def _explain(self) -> None:
        """What is not covered, and why."""
        active = self._controller.active
        if active is None:
            self._explained = None
            self.reach.set_rows(self.tr("Plan a flight, and what it does not cover stands here."), ())
            return
        if active is self._explained:
            return
        self._explained = active
        insight = active.insight
        groups = reach_groups(insight)
        n_missed = sum(group.n_sections for group in groups if group.state is not SectionState.UNREACHABLE)
        n_hidden = sum(group.n_sections for group in groups if group.state is SectionState.UNREACHABLE)
        summary = self.tr("{0} sections could still be covered, {1} cannot be covered from anywhere allowed").format(
            n_missed, n_hidden
        )
        self.reach.set_rows(summary, [self._reason_row(group, insight) for group in groups])

    def _reason_row(self, group: ReachGroup, insight: PlanInsight) -> ReasonRow:
        words = {
            SectionState.MISSED: self.tr("more views would cover them"),
            SectionState.UNDECIDED: self.tr("not known whether anything could"),
            SectionState.UNREACHABLE: self.tr("not known why"),
        }[group.state]
        if group.rules:
            words = self.tr(" and ").join(self._rule_text(rule) for rule in group.rules)
        example = "" if group.reason is None else self._context.localized(str(group.reason))
        panel_id = insight.panel_ids[group.panel]
        return ReasonRow(words, group.n_sections, group.n_panels, example, panel_id, group.section)

    def _rule_text(self, rule: Rule) -> str:
        return {
            Rule.GIMBAL_UP: self.tr("the gimbal cannot look up so far"),
            Rule.GIMBAL_DOWN: self.tr("the gimbal cannot look down so far"),
            Rule.FLOOR: self.tr("below the lowest flight allowed"),
            Rule.CEILING: self.tr("above the airspace"),
            Rule.SIDES: self.tr("beyond the sides of the airspace"),
            Rule.RANGE: self.tr("too far away for the GSD wanted"),
            Rule.DISTANCE: self.tr("too close to building or obstacle"),
            Rule.NO_FLY: self.tr("in a no-fly volume"),
            Rule.GROUND: self.tr("below the ground"),
            Rule.HIDDEN: self.tr("hidden by something"),
            Rule.UNFLYABLE: self.tr("cannot be flown to"),
        }[rule]

    # Clearance and other plans

    def _measure_clearance(self) -> None:
        """Measure the chosen sortie, unless it is measured already."""
        active, number = self._controller.active, self.clearance.sortie()
        if self._measured == (active, number):
            return
        self._measured = (active, number)
        if self._measuring is not None:
            self._context.cancel(self._measuring, quietly=True)
            self._measuring = None
        self.clearance.set_clearance(None)
        if active is None or not 1 <= number <= len(active.plan.sorties):
            return
        site_model = active.prepared_site.prepared.site_model
        space = active.prepared_site.prepared.problem.space
        sortie, limit_m = active.plan.sorties[number - 1], active.plan.constraints.min_distance_m

        def done(found: RouteClearance) -> None:
            self._measuring = None
            if self._measured == (active, number):
                self.clearance.set_clearance(found, limit_m)

        self._measuring = self._context.start(
            self.tr("Measure clearance"),
            lambda _context: route_clearance(sortie, space, obstructions_of(site_model, space)),
            done,
        )

    def _ask_plan(self) -> None:
        path = choose_file(self, self.tr("Open plan"), self.tr("Plans (*.json)"))
        if path is not None:
            self._controller.open_plan(path)

    def compare(self, plan_ids: tuple[str, ...]) -> None:
        """Show plans side by side."""
        document = self._context.document
        entries = [entry for entry in document.plans if entry.id in plan_ids]
        if document.site is None or len(entries) < 2:
            self._context.say(Severity.NOTE, self.tr("Select two or more plans in the list of plans to compare."))
            return

        self.compare_window = CompareWindow(self._context, document.site, tuple(entries), self.window())
        self.compare_window.show()


def _panels_covered(active: ActivePlan | None) -> dict[str, int]:
    """Number of panels that each view covers, by its identifier; empty where that is not known."""
    if active is None:
        return {}
    return dict(zip(active.insight.view_ids, active.insight.panels_per_view.tolist(), strict=True))
