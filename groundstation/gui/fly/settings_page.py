"""What the pilot decides: whether RTK is needed."""

from __future__ import annotations

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QCheckBox, QLabel, QVBoxLayout, QWidget

from groundstation.services.live_settings import FlightSettings


class SettingsPage(QWidget):
    """Edits `FlightSettings`.

    Signals
    -------
    valueChanged(FlightSettings)
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.needs_rtk = QCheckBox(self.tr("RTK needed for take-off"))
        says = QLabel(self.tr("Start waits for RTK, and a warning comes when it is lost in flight."))
        says.setWordWrap(True)
        says.setProperty("role", "muted")
        layout = QVBoxLayout(self)
        layout.addWidget(self.needs_rtk)
        layout.addWidget(says)
        layout.addStretch(1)
        self.needs_rtk.toggled.connect(self._edited)

    def value(self) -> FlightSettings:
        """What was chosen."""
        return FlightSettings(self.needs_rtk.isChecked())

    def setValue(self, value: FlightSettings) -> None:  # noqa: N802
        """Show another choice."""
        blocker = QSignalBlocker(self.needs_rtk)
        self.needs_rtk.setChecked(value.needs_rtk)
        del blocker

    def _edited(self, _is_on: bool) -> None:
        self.valueChanged.emit(self.value())
