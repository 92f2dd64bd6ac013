"""What the pilot decides: whether RTK is needed, and whether an upload may set parameters of a real vehicle."""

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
        self.sets_parameters = QCheckBox(self.tr("Upload sets parameters"))
        layout = QVBoxLayout(self)
        for box, text in (
            (self.needs_rtk, self.tr("Start waits for RTK, and a warning comes when it is lost in flight.")),
            (
                self.sets_parameters,
                self.tr(
                    "Camera, gimbal and speeds of a real vehicle are set as the plan needs them. Each upload names the "
                    "parameters and asks first. Without it they are only compared. Those of a simulation are always "
                    "set."
                ),
            ),
        ):
            says = QLabel(text)
            says.setWordWrap(True)
            says.setProperty("role", "muted")
            layout.addWidget(box)
            layout.addWidget(says)
            box.toggled.connect(self._edited)
        layout.addStretch(1)

    def value(self) -> FlightSettings:
        """What was chosen."""
        return FlightSettings(self.needs_rtk.isChecked(), self.sets_parameters.isChecked())

    def setValue(self, value: FlightSettings) -> None:  # noqa: N802
        """Show another choice."""
        blockers = [QSignalBlocker(box) for box in (self.needs_rtk, self.sets_parameters)]
        self.needs_rtk.setChecked(value.needs_rtk)
        self.sets_parameters.setChecked(value.sets_parameters)
        del blockers

    def _edited(self, _is_on: bool) -> None:
        self.valueChanged.emit(self.value())
