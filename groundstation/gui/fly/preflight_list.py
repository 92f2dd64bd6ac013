"""The list before take-off: each check with its state, what was measured, and what to do."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.application.translate import translated
from groundstation.services.units import UnitSystem
from groundstation.vehicle.preflight import Mend, OnBoard, PreflightCheck, Verdict, mends

MARKS = {
    Verdict.OK: ("\u2713", "ok"),
    Verdict.WAIT: ("\u2026", "warning"),
    Verdict.WARN: ("!", "warning"),
    Verdict.BAD: ("\u2717", "error"),
}
"""Sign and role of each verdict: none is told by colour alone."""


ORDER = (Verdict.BAD, Verdict.WAIT, Verdict.WARN, Verdict.OK)
NOTHING_ON_BOARD = OnBoard()


class PreflightList(QWidget):
    """One row for each check, with what can be done about it; shows what it gets.

    Signals
    -------
    mendRequested(Mend, PreflightCheck)
    """

    mendRequested = Signal(object, object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._checks: tuple[PreflightCheck, ...] = ()
        self._units = UnitSystem.METRIC
        self._on_board = NOTHING_ON_BOARD
        self._rows: list[_Row] = []
        self._note = QLabel()
        self._note.setWordWrap(True)
        self._note.setProperty("role", "muted")
        self._layout = QGridLayout(self)
        self._layout.setContentsMargins(0, 0, 0, 0)
        self._layout.setVerticalSpacing(3)
        self._layout.setColumnStretch(1, 1)
        self._layout.addWidget(self._note, 0, 0, 1, 2)

    def set_checks(
        self, checks: tuple[PreflightCheck, ...], on_board: OnBoard = NOTHING_ON_BOARD, note: str = ""
    ) -> None:
        """Show checks, of a vehicle with this on board; `note` stands above them."""
        self._note.setText(note)
        self._note.setVisible(bool(note))
        # What is not well comes first: the list is longer than a small screen.
        checks = tuple(sorted(checks, key=lambda check: ORDER.index(check.verdict)))
        if checks == self._checks and on_board.changes == self._on_board.changes:
            return
        self._checks, self._on_board = checks, on_board
        self._fill()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        self._fill()

    def text(self) -> str:
        """Everything that is shown, a line for each check."""
        rows = self._rows[: len(self._checks)]
        return "\n".join(f"{row.mark.text()} {row.words.text()}" for row in rows)

    def button(self, code: str, mend: Mend) -> QPushButton | None:
        """The button with which something can be done about a check; None where there is none."""
        for check, row in zip(self._checks, self._rows, strict=False):
            if check.code == code:
                return row.buttons.get(mend)
        return None

    def _fill(self) -> None:
        while len(self._rows) < len(self._checks):
            self._add_row()
        names = self._names()
        for number, row in enumerate(self._rows):
            is_used = number < len(self._checks)
            row.mark.setVisible(is_used)
            row.side.setVisible(is_used)
            if is_used:
                check = self._checks[number]
                sign, role = MARKS[check.verdict]
                told = translated(check.text, self._units)
                row.mark.setText(sign)
                row.words.setText(self.tr("{0}: {1}").format(names.get(check.code, check.code), told))
                for label in (row.mark, row.words):
                    wanted = role if label is row.mark or check.verdict is not Verdict.OK else ""
                    if label.property("role") != wanted:
                        label.setProperty("role", wanted)
                        label.style().polish(label)
                self._offer(row, check)

    def _offer(self, row: _Row, check: PreflightCheck) -> None:
        """Buttons for what can be done about a check; those that stay are not made anew under the pointer."""
        ways = mends(check, self._on_board)
        row.check = check
        if tuple(row.buttons) == ways:
            return
        for button in row.buttons.values():
            row.line.removeWidget(button)
            button.deleteLater()
        row.buttons = {}
        texts = self._mend_texts()
        for number, mend in enumerate(ways):
            button = QPushButton(texts[mend])
            button.clicked.connect(lambda _checked=False, mend=mend, row=row: self.mendRequested.emit(mend, row.check))
            row.line.insertWidget(number, button)
            row.buttons[mend] = button

    def _mend_texts(self) -> dict[Mend, str]:
        return {
            Mend.SET_PARAMETERS: self.tr("Set parameters ..."),
            Mend.RAISE: self.tr("Fly from this height ..."),
            Mend.PLAN_FROM_HERE: self.tr("Home here ..."),
            Mend.OVERRULE: self.tr("Overrule ..."),
        }

    def _add_row(self) -> None:
        row = _Row(len(self._rows))
        self._layout.addWidget(row.mark, len(self._rows) + 1, 0, Qt.AlignmentFlag.AlignTop)
        self._layout.addWidget(row.side, len(self._rows) + 1, 1)
        self._rows.append(row)

    def _names(self) -> dict[str, str]:
        return {
            "link": self.tr("Link"),
            "position": self.tr("Position"),
            "gnss": self.tr("GNSS"),
            "home": self.tr("Home"),
            "home-height": self.tr("Height of home"),
            "battery": self.tr("Battery"),
            "sensors": self.tr("Sensors"),
            "wind": self.tr("Wind"),
            "low-flight": self.tr("Lowest flight"),
            "mission": self.tr("Mission on board"),
            "geofence": self.tr("Geofence on board"),
            "rally": self.tr("Rally points on board"),
            "parameters": self.tr("Parameters"),
            "link-loss": self.tr("Link lost"),
            "rc-loss": self.tr("Remote control lost"),
            "battery-low": self.tr("Battery low"),
            "position-loss": self.tr("Position lost"),
            "return": self.tr("Return"),
            "fence-action": self.tr("At the geofence"),
            "fence-height": self.tr("Height limit"),
            "fence-radius": self.tr("Circle around home"),
        }


class _Row:
    """Widgets of one check."""

    def __init__(self, number: int) -> None:
        self.check: PreflightCheck | None = None
        self.mark, self.words, self.side = QLabel(), QLabel(), QWidget()
        self.mark.setFixedWidth(16)
        self.words.setWordWrap(True)
        self.side.setObjectName(f"check-{number}")
        self.buttons: dict[Mend, QPushButton] = {}
        self.line = QVBoxLayout()
        self.line.setAlignment(Qt.AlignmentFlag.AlignLeft)
        layout = QVBoxLayout(self.side)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(2)
        layout.addWidget(self.words)
        layout.addLayout(self.line)
