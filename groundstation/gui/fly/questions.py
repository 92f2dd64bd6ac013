"""Questions of a flight: before take-off, and before the window stops to watch an aircraft in the air."""

from __future__ import annotations

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QMessageBox, QWidget

from groundstation.services.live_sortie import TakeOff
from groundstation.services.units import UnitSystem, distance_unit, length_unit, minutes_text


class FlightQuestions(QObject):
    """Asks by dialogs; a class of its own so that whoever drives the window without a user can answer."""

    def start(self, parent: QWidget, take_off: TakeOff, units: UnitSystem) -> bool:
        """Whether to take off."""
        said = QMessageBox.question(
            parent,
            self.tr("Start the flight"),
            self.start_text(take_off, units),
            QMessageBox.StandardButton.Yes | QMessageBox.StandardButton.Cancel,
            QMessageBox.StandardButton.Cancel,
        )
        return said is QMessageBox.StandardButton.Yes

    def start_text(self, take_off: TakeOff, units: UnitSystem) -> str:
        """What will happen."""
        lines = [
            self.tr(
                "The motors will start. The aircraft climbs up to {0} above take-off, flies {1} in about {2}, "
            ).format(
                length_unit(units).text(take_off.highest_m),
                distance_unit(units).text(take_off.length_m),
                minutes_text(take_off.duration_s),
            )
            + self.tr("takes {0} photos, comes no closer than {1} to anything, returns and lands.").format(
                take_off.n_photos, length_unit(units).text(take_off.least_distance_m)
            ),
            self.tr("It uses about {0:.0%} of a full battery.").format(take_off.battery),
            self.tr("Is everybody clear of the aircraft?"),
        ]
        return "\n\n".join(lines)

    def leave_in_flight(self, parent: QWidget) -> bool:
        """Whether to stop watching an aircraft that is in the air."""
        said = QMessageBox.warning(
            parent,
            self.tr("The aircraft is in the air"),
            self.tr(
                "It goes on with what it does now, without this window: nothing will warn you, and you fly it by the "
                "remote control. What was recorded so far is kept. Leave it?"
            ),
            QMessageBox.StandardButton.Yes | QMessageBox.StandardButton.Cancel,
            QMessageBox.StandardButton.Cancel,
        )
        return said is QMessageBox.StandardButton.Yes
