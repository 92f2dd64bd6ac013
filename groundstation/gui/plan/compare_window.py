"""Plans side by side: two 3-D pictures that move together, and a table of all measures."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QSignalBlocker, Qt
from PySide6.QtGui import QColor, QFont
from PySide6.QtWidgets import (
    QAbstractItemView,
    QDialog,
    QHBoxLayout,
    QLabel,
    QSplitter,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.view3d.orbit import Orbit
from groundstation.gui.view3d.paint import ColourScale, ValueKind
from groundstation.gui.view3d.scene_view import SceneView
from groundstation.gui.widgets.inputs import ChoiceBox
from groundstation.gui.widgets.theme import colours
from groundstation.services.plan.comparison import compare, marked_as_best, told_apart
from groundstation.services.project.document import PlanEntry
from groundstation.services.units import UnitSystem, length_unit, minutes_text, sampling_unit
from planning.insight.comparison import Comparison, Row
from planning.site.records import SiteModel


class CompareWindow(QDialog):
    """Two of the plans as pictures, all of them in a table."""

    def __init__(
        self,
        workspace: ApplicationContext,
        site: SiteModel,
        entries: tuple[PlanEntry, ...],
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Compare plans"))
        self.setWindowFlag(Qt.WindowType.WindowMaximizeButtonHint)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.resize(1200, 680)
        self._workspace, self._site, self._entries = workspace, site, entries
        self._comparison: Comparison | None = None
        self._choices, self._scenes = (ChoiceBox(), ChoiceBox()), (SceneView(self), SceneView(self))
        self._paint = ChoiceBox()
        self._paint.addItems([self.tr("coverage"), self.tr("difference in coverage"), self.tr("pixel size")])
        self._words = QLabel()
        self._words.setWordWrap(True)
        self._table = QTableWidget()
        self._lay_out()
        names = told_apart(entries)
        for number, (choice, scene) in enumerate(zip(self._choices, self._scenes, strict=True)):
            choice.addItems(names)
            choice.setCurrentIndex(number)
            scene.set_units(workspace.units)
            scene.set_site(site)
            choice.currentIndexChanged.connect(self._show_pictures)
        first, second = self._scenes
        first.orbitChanged.connect(second.set_orbit)
        second.orbitChanged.connect(first.set_orbit)
        self._paint.currentIndexChanged.connect(self._show_pictures)
        self._show_pictures()
        plans = tuple(entry.plan for entry in entries)
        self._job = workspace.start(
            self.tr("Compare plans"),
            lambda context: compare(site, plans, names, monitor=context),
            self._compared,
            lambda error: self._words.setText(workspace.words(str(error))),
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
        wishes = {"auto": self.tr("auto"), "on": self.tr("on"), "off": self.tr("off")}
        words = self.tr(
            "All plans judged with {0:g} degree sections, {1}, occlusion {2}. A star marks the better."
        ).format(
            constraints.section_step_deg,
            length_unit(self._workspace.units).text(constraints.min_distance_m),
            wishes[constraints.occlusion],
        )
        self._words.setText(" ".join([words, *map(self._workspace.words, comparison.notes)]))
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
        units: UnitSystem = self._workspace.units
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
            "length": self.tr("Way flown"),
            "found-after": self.tr("Views found after"),
            "covered": self.tr("Sections covered"),
            "covered-share": self.tr("of all sections"),
            "possible-share": self.tr("of what can be covered"),
            "facade-share": self.tr("Facade {0}, of what can be covered"),
            "only-here": self.tr("Sections no other plan covers"),
            "depth": self.tr("Covered at least {0} times"),
            "gsd-best": self.tr("Finest pixel"),
            "gsd-worst": self.tr("Coarsest pixel"),
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
                unit = sampling_unit(self._workspace.units)
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
        self._workspace.cancel(self._job, quietly=True)
        for scene in self._scenes:
            scene.close_view()
        super().done(result)
