"""Warnings of now, above everything that was noted in the flight: answers, warnings, texts of the autopilot."""

from __future__ import annotations

from PySide6.QtGui import QColor
from PySide6.QtWidgets import QLabel, QListWidget, QListWidgetItem, QVBoxLayout, QWidget

from groundstation.gui.own_words import own_words
from groundstation.gui.theme import colours
from groundstation.services.units import UnitSystem
from groundstation.vehicle.watch import FlightWarning
from planning.findings import Severity

MAX_NOTES = 300


class WarningsView(QWidget):
    """Shows the warnings that hold; the most severe first."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._warnings: tuple[FlightWarning, ...] = ()
        self._units = UnitSystem.METRIC
        self._labels: list[QLabel] = []
        self._layout = QVBoxLayout(self)
        self._layout.setContentsMargins(4, 0, 4, 0)
        self._calm = QLabel(self.tr("No warnings."))
        self._calm.setProperty("role", "muted")
        self._layout.addWidget(self._calm)
        self._layout.addStretch(1)

    def set_warnings(self, warnings: tuple[FlightWarning, ...]) -> None:
        """Show these."""
        if warnings != self._warnings:
            self._warnings = warnings
            self._fill()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        self._fill()

    def text(self) -> str:
        """All warnings, a line each."""
        return "\n".join(label.text() for label in self._labels[: len(self._warnings)])

    def _fill(self) -> None:
        ordered = sorted(self._warnings, key=lambda warning: warning.severity is not Severity.ERROR)
        while len(self._labels) < len(ordered):
            label = QLabel()
            label.setWordWrap(True)
            self._layout.insertWidget(1 + len(self._labels), label)
            self._labels.append(label)
        for number, label in enumerate(self._labels):
            label.setVisible(number < len(ordered))
            if number < len(ordered):
                warning = ordered[number]
                label.setText(self._said(warning))
                role = warning.severity.value
                if label.property("role") != role:
                    label.setProperty("role", role)
                    label.style().polish(label)
        self._calm.setVisible(not ordered)

    def _said(self, warning: FlightWarning) -> str:
        told = own_words(warning.text, self._units)
        if warning.severity is Severity.ERROR:
            return self.tr("Danger: {0}").format(told)
        return self.tr("Warning: {0}").format(told)


class FlightNotes(QListWidget):
    """What happened, the latest at the end."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWordWrap(True)
        self.setAccessibleName(self.tr("What happened in the flight"))
        self.setToolTip(self.tr("Minutes and seconds after take-off, as in the plan and the report"))

    def add(self, time_s: float | None, severity: Severity, text: str) -> None:
        """Note something; `time_s` after take-off."""
        minutes, tenths = divmod(round(10.0 * (time_s or 0.0)), 600)
        when = "" if time_s is None else f"{minutes}:{tenths / 10.0:04.1f}  "
        row = QListWidgetItem(f"{when}{text}")
        colour = {Severity.ERROR: colours().error, Severity.WARNING: colours().warning}.get(severity)
        if colour:
            row.setForeground(QColor(colour))
        self.addItem(row)
        while self.count() > MAX_NOTES:
            self.takeItem(0)
        self.scrollToBottom()

    def texts(self) -> str:
        """All notes, a line each."""
        return "\n".join(self.item(row).text() for row in range(self.count()))
