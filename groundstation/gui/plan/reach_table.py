"""Sections that the plan does not cover: why nobody can see them, or that more views would."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QLabel, QVBoxLayout, QWidget

from groundstation.gui.plan.table_view import Column, RowModel, table_of


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
