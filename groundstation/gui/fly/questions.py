"""Questions of a flight: before take-off, and before the window stops to watch an aircraft in the air."""

from __future__ import annotations

import math
from collections.abc import Sequence

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.widgets.questions import agrees, ask_text
from groundstation.services.fly.sortie import TakeOff
from groundstation.services.mission.readiness import TooLong, duration_text
from groundstation.services.units import UnitSystem, distance_unit, length_unit, minutes_text
from groundstation.vehicle.setup import ParameterChange
from planning.insight.flight_profile import LOW_M, LowFlight
from planning.revision.top_up import TopUp


class FlightQuestions(QObject):
    """Asks by dialogs; a class of its own so that whoever drives the window without a user can answer."""

    def start(self, parent: QWidget, take_off: TakeOff, units: UnitSystem, wait_s: float = 0.0) -> bool:
        """Whether to take off; `wait_s` until it keeps apart from aircraft in the air, infinity where nobody knows."""
        text = self.start_text(take_off, units)
        if wait_s > 0.0:
            when = minutes_text(wait_s) if math.isfinite(wait_s) else self.tr("until the others have landed")
            early = self.tr("TOO EARLY: now it may come too near to an aircraft in the air. Wait {0}.").format(when)
            text = f"{early}\n\n{text}"
        return agrees(parent, self.tr("Start the flight"), text, warns=wait_s > 0.0 or bool(take_off.warnings))

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
            *([] if take_off.low is None else [self._low_text(take_off.low, units)]),
            self._battery_text(take_off),
            *self._warnings(take_off, units),
            self.tr("Is everybody clear of the aircraft?"),
        ]
        return "\n\n".join(lines)

    def _warnings(self, take_off: TakeOff, units: UnitSystem) -> list[str]:
        """What the list before take-off warns of: it is read once more where it is agreed to."""
        if not take_off.warnings:
            return []
        told = "\n".join(f"\u2022 {translated(text, units)}" for text in take_off.warnings)
        return [self.tr("The list before take-off warns; by starting you confirm:\n{0}").format(told)]

    def _battery_text(self, take_off: TakeOff) -> str:
        text = self.tr("It uses about {0:.0%} of a full battery.").format(take_off.battery)
        takes, reckons = minutes_text(take_off.duration_s), minutes_text(take_off.planned_s)
        if take_off.autopilot is None or takes == reckons:
            return text
        why = self.tr("{0} is slower than the plan, which reckons with {1}.")
        return f"{text} {why.format(take_off.autopilot.product, duration_text(take_off.planned_s))}"

    def _low_text(self, low: LowFlight, units: UnitSystem) -> str:
        length = length_unit(units)
        if low.below_s is None or low.lowest_m >= LOW_M:
            text = self.tr("Away from home it flies {0} above the ground or higher.")
            return text.format(length.text(low.lowest_m))
        return self.tr(
            "Away from home it flies down to {0} above the ground, {1} of it below {2}: nobody may be there."
        ).format(length.text(low.lowest_m), duration_text(low.below_s), length.text(LOW_M))

    def share_out(self, parent: QWidget, found: TooLong) -> bool:
        """Whether to share the views of a plan out among more sorties."""
        return agrees(
            parent,
            self.tr("Too many photos for one sortie"),
            self.tr(
                "{0} keeps the items of about {1} photos, and a sortie of this plan has {2}: the vehicle would refuse "
                "it. Share the same views out among more sorties, as a plan of its own, and connect for that?"
            ).format(found.autopilot.product, found.limit, found.longest),
            is_usual=True,
        )

    def set_parameters(self, parent: QWidget, changes: Sequence[ParameterChange]) -> bool:
        """Whether to set parameters of a real vehicle."""
        title, text = self.tr("Set parameters of the vehicle"), self.parameters_text(changes)
        return agrees(parent, title, text, warns=True)

    def parameters_text(self, changes: Sequence[ParameterChange]) -> str:
        """What would be set: each with its value of now and the new one."""
        set_now = [_change_line(change) for change in changes if not change.needs_reboot]
        lines = []
        if set_now:
            lines += [self.tr("These parameters of the vehicle are set, and they stay so:"), "\n".join(set_now)]
        rebooted = [_change_line(change) for change in changes if change.needs_reboot]
        if rebooted:
            lines += [self.tr("These are set, and the autopilot is restarted after it:"), "\n".join(rebooted)]
        lines.append(self.tr("Set them?"))
        return "\n\n".join(lines)

    def raise_flight(self, parent: QWidget, by_m: float, units: UnitSystem) -> bool:
        """Whether to fly from where the aircraft stands, higher or lower than planned."""
        text = self.tr(
            "The aircraft stands {0} {1} than planned. Its heights above take-off are made as much {2}, so that it "
            "flies through the same places, and have to be uploaded again. Do so only where you know that it really "
            "stands there: a GNSS height can be wrong by metres. Fly from this height?"
        )
        sides = (self.tr("lower"), self.tr("larger")) if by_m > 0.0 else (self.tr("higher"), self.tr("smaller"))
        return agrees(
            parent, self.tr("Fly from this height"), text.format(length_unit(units).text(abs(by_m)), *sides), warns=True
        )

    def plan_from_here(self, parent: QWidget) -> bool:
        """Whether to make the place where the aircraft stands the site's home."""
        text = self.tr(
            "The site's home moves to where the aircraft stands (Undo takes it back). Plans start at home, so the "
            "flight has to be planned again. Move it?"
        )
        return agrees(parent, self.tr("Home here"), text)

    def overrule(self, parent: QWidget, check: str, confirmation: str) -> bool:
        """Whether to fly though a check grounds the flight: the pilot types the word."""
        text = self.tr("{0}\n\nTo fly all the same, type {1}:").format(check, confirmation)
        typed = ask_text(parent, self.tr("Overrule"), text, "")
        return typed is not None and typed.strip().casefold() == confirmation.casefold()

    def confirm_closing_flight(self, parent: QWidget, found: TopUp) -> bool:
        """Whether to plan a flight for the little that is missing."""
        plan = found.plan
        if plan is None:
            return False
        text = self.tr(
            "{0} of {1} sections are missing. Showing {2} of them takes {3} in the air (photos: {4}, batteries: {5}). "
            "Plan this flight?"
        ).format(
            found.wanted,
            found.aimed,
            found.closed,
            minutes_text(plan.duration_s),
            len(plan.viewpoints),
            len(plan.sorties),
        )
        return agrees(parent, self.tr("Hardly anything is missing"), text)

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


def _change_line(change: ParameterChange) -> str:
    return f"{change.name}: {change.old:g} \u2192 {change.new:g}"
