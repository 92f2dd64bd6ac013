"""The list before take-off: each check with its state, what was measured, and what to do."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QGridLayout, QLabel, QWidget

from groundstation.gui.own_words import own_words
from groundstation.services.units import UnitSystem
from groundstation.vehicle.preflight import PreflightCheck, Verdict

MARKS = {
    Verdict.OK: ("\u2713", "ok"),
    Verdict.WAIT: ("\u2026", "warning"),
    Verdict.WARN: ("!", "warning"),
    Verdict.BAD: ("\u2717", "error"),
}
"""Sign and role of each verdict: none is told by colour alone."""


class PreflightList(QWidget):
    """One row for each check; shows what it gets."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._checks: tuple[PreflightCheck, ...] = ()
        self._units = UnitSystem.METRIC
        self._rows: list[tuple[QLabel, QLabel]] = []
        self._note = QLabel()
        self._note.setWordWrap(True)
        self._note.setProperty("role", "muted")
        self._layout = QGridLayout(self)
        self._layout.setContentsMargins(0, 0, 0, 0)
        self._layout.setVerticalSpacing(3)
        self._layout.setColumnStretch(1, 1)
        self._layout.addWidget(self._note, 0, 0, 1, 2)

    def set_checks(self, checks: tuple[PreflightCheck, ...], note: str = "") -> None:
        """Show checks; `note` stands above them."""
        self._note.setText(note)
        self._note.setVisible(bool(note))
        # What is not well comes first: the list is longer than a small screen.
        checks = tuple(sorted(checks, key=lambda check: check.verdict is Verdict.OK))
        if checks == self._checks:
            return
        self._checks = checks
        self._fill()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        self._fill()

    def text(self) -> str:
        """Everything that is shown, a line for each check."""
        rows = self._rows[: len(self._checks)]
        return "\n".join(f"{mark.text()} {words.text()}" for mark, words in rows)

    def _fill(self) -> None:
        while len(self._rows) < len(self._checks):
            self._add_row()
        names = self._names()
        for number, (mark, words) in enumerate(self._rows):
            is_used = number < len(self._checks)
            mark.setVisible(is_used)
            words.setVisible(is_used)
            if is_used:
                check = self._checks[number]
                sign, role = MARKS[check.verdict]
                told = own_words(check.text, self._units)
                mark.setText(sign)
                words.setText(self.tr("{0}: {1}").format(names.get(check.code, check.code), told))
                for label in (mark, words):
                    wanted = role if label is mark or check.verdict is not Verdict.OK else ""
                    if label.property("role") != wanted:
                        label.setProperty("role", wanted)
                        label.style().polish(label)

    def _add_row(self) -> None:
        mark, words = QLabel(), QLabel()
        mark.setFixedWidth(16)
        words.setWordWrap(True)
        row = len(self._rows) + 1
        self._layout.addWidget(mark, row, 0, Qt.AlignmentFlag.AlignTop)
        self._layout.addWidget(words, row, 1)
        self._rows.append((mark, words))

    def _names(self) -> dict[str, str]:
        return {
            "link": self.tr("Link"),
            "position": self.tr("Position"),
            "gnss": self.tr("GNSS"),
            "home": self.tr("Home"),
            "battery": self.tr("Battery"),
            "sensors": self.tr("Sensors"),
            "wind": self.tr("Wind"),
            "mission": self.tr("Mission on board"),
            "geofence": self.tr("Geofence on board"),
            "rally": self.tr("Rally points on board"),
            "link-loss": self.tr("Link lost"),
            "return": self.tr("Return"),
            "fence-action": self.tr("At the geofence"),
            "fence-height": self.tr("Height limit"),
            "fence-radius": self.tr("Circle around home"),
        }
