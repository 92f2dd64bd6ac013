"""The facades that were found, one line each, with how good they are."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QAbstractItemView, QHeaderView, QTableWidget, QTableWidgetItem, QWidget

from groundstation.services.photo_desk import PanelDraft
from groundstation.services.photo_tradeoff import corner_sigma_m
from groundstation.services.units import UnitSystem, sampling_unit


class FacadeTable(QTableWidget):
    """Shows a draft.

    Signals
    -------
    chosen(str)
        Identifier of a facade.
    """

    chosen = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(0, 4, parent)
        self._units = UnitSystem.METRIC
        self._draft: PanelDraft | None = None
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.verticalHeader().hide()
        self.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        self.horizontalHeader().setSectionResizeMode(1, QHeaderView.ResizeMode.Stretch)
        self.setAccessibleName(self.tr("Facades found"))
        self.cellClicked.connect(self._choose)
        self._fill()

    def set_draft(self, draft: PanelDraft | None) -> None:
        """Show other facades."""
        self._draft = draft
        self._fill()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        self._fill()

    def _choose(self, row: int, _column: int) -> None:
        if self._draft is not None:
            self.chosen.emit(self._draft.found.facades[row].id)

    def _fill(self) -> None:
        unit = sampling_unit(self._units)
        self.setHorizontalHeaderLabels(
            [self.tr("Facade"), self.tr("Panels"), self.tr("Photos"), f"\u00b1 {unit.symbol}"]
        )
        facades = () if self._draft is None else self._draft.found.facades
        self.setRowCount(len(facades))
        for row, facade in enumerate(facades):
            is_old = self._draft is not None and facade.id in self._draft.unsolved
            sigma_m = corner_sigma_m(facade)
            texts = (
                facade.id,
                "\u2026"
                if is_old
                else f"{len(facade.panels)} ({len(facade.rows) - 1} \u00d7 {len(facade.columns) - 1})",
                str(len(facade.pose_changes)),
                "\u2026" if is_old else "\u2013" if sigma_m is None else f"{unit.shown(sigma_m):.3g}",
            )
            for column, text in enumerate(texts):
                item = QTableWidgetItem(text)
                item.setTextAlignment(Qt.AlignmentFlag.AlignCenter)
                self.setItem(row, column, item)
