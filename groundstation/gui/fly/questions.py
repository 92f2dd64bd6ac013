"""Questions of a flight: before take-off, and before the window stops to watch an aircraft in the air."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QWidget

from groundstation.gui.questions import agrees
from groundstation.services.live_limit import TooLong
from groundstation.services.live_settings import SetParameter
from groundstation.services.live_sortie import TakeOff
from groundstation.services.units import UnitSystem, distance_unit, length_unit, minutes_text


class FlightQuestions(QObject):
    """Asks by dialogs; a class of its own so that whoever drives the window without a user can answer."""

    def start(self, parent: QWidget, take_off: TakeOff, units: UnitSystem) -> bool:
        """Whether to take off."""
        return agrees(parent, self.tr("Start the flight"), self.start_text(take_off, units))

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

    def share_out(self, parent: QWidget, found: TooLong) -> bool:
        """Whether to share the views of a plan out among more sorties."""
        return agrees(
            parent,
            self.tr("Too many photos for one sortie"),
            self.tr(
                "{0} keeps the items of about {1} photos, and a sortie of this plan has {2}: the vehicle would refuse "
                "it. Share the same views out among more sorties, as a plan of its own, and connect for that?"
            ).format(found.autopilot.value, found.limit, found.longest),
            is_usual=True,
        )

    def set_parameters(self, parent: QWidget, parameters: Sequence[SetParameter]) -> bool:
        """Whether to set parameters of a real vehicle."""
        title, text = self.tr("Set parameters of the vehicle"), self.parameters_text(parameters)
        return agrees(parent, title, text, warns=True)

    def parameters_text(self, parameters: Sequence[SetParameter]) -> str:
        """What would be set."""
        set_now = [one for one in parameters if not one.needs_reboot]
        lines = [
            self.tr("The upload sets these parameters of the vehicle where they differ, and they stay so:"),
            "\n".join(f"{one.name} = {one.value:g}" for one in set_now),
        ]
        rebooted = [one for one in parameters if one.needs_reboot]
        if rebooted:
            lines.append(self.tr("and these, after which the autopilot is restarted:"))
            lines.append("\n".join(f"{one.name} = {one.value:g}" for one in rebooted))
        lines.append(self.tr("Set them, and upload?"))
        return "\n\n".join(lines)

    def leave_in_flight(self, parent: QWidget) -> bool:
        """Whether to stop watching an aircraft that is in the air."""
        return agrees(
            parent,
            self.tr("The aircraft is in the air"),
            self.tr(
                "It goes on with what it does now, without this window: nothing will warn you, and you fly it by the "
                "remote control. What was recorded so far is kept. Leave it?"
            ),
            warns=True,
        )
