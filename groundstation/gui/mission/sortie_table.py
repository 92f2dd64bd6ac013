"""The sorties of a plan in numbers: what each takes of a battery."""

from __future__ import annotations

from PySide6.QtCore import QModelIndex, Qt, Signal
from PySide6.QtGui import QStandardItem, QStandardItemModel
from PySide6.QtWidgets import QAbstractItemView, QHeaderView, QTableView, QWidget

from groundstation.gui.mission.map_paint import sortie_colour
from groundstation.services.document import Item, ItemKind
from groundstation.services.units import UnitSystem, distance_unit, minutes_text
from planning.plan import Plan


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
