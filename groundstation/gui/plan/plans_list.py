"""The plans of a project: which is looked at, which two are compared; rename, remove, bring in another."""

from __future__ import annotations

from PySide6.QtCore import QItemSelectionModel, Signal
from PySide6.QtWidgets import QAbstractItemView, QGridLayout, QHBoxLayout, QPushButton, QWidget

from groundstation.gui.plan.method_names import method_name
from groundstation.gui.plan.table_view import Column, RowModel, table_of
from groundstation.gui.questions import ask_text
from groundstation.services.document import Document, PlanEntry
from groundstation.services.units import UnitSystem, distance_unit, minutes_text


class PlansList(QWidget):
    """A table of plans with what can be done to them.

    Signals
    -------
    chosen(str), renamed(str, str), removed(str), compareWanted(tuple of str), openWanted()
        Identifiers of plans.
    """

    chosen = Signal(str)
    renamed = Signal(str, str)
    removed = Signal(str)
    compareWanted = Signal(object)  # noqa: N815  (Qt's own way of naming)
    openWanted = Signal()  # noqa: N815

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
        self._remove = QPushButton(self.tr("Remove"))
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
        self._compare.clicked.connect(lambda: self.compareWanted.emit(self.selected()))
        self._rename.clicked.connect(self._ask_name)
        self._remove.clicked.connect(lambda: self.removed.emit(self.selected()[0]))
        self._open.clicked.connect(lambda: self.openWanted.emit())
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
