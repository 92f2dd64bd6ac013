"""The aircraft that fly at once, a row each, of which one is selected, and the button that brings all of them home."""

from __future__ import annotations

import math
from dataclasses import dataclass

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QKeySequence, QResizeEvent, QShortcut
from PySide6.QtWidgets import QButtonGroup, QPushButton, QSizePolicy, QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.application.translate import shown_keys
from groundstation.gui.fly.flight_buttons import APART_PX
from groundstation.gui.fly.fly_controller import FlyController
from groundstation.gui.fly.live_aircraft import LiveAircraft
from groundstation.gui.widgets.hold_button import HoldButton
from groundstation.gui.widgets.tab_order import set_enabled
from groundstation.gui.widgets.theme import colours
from groundstation.services.fly.events import LinkState, LiveView, ViewState
from groundstation.services.fly.fleet import distances_m, is_in_air
from groundstation.services.units import length_unit, minutes_text
from groundstation.vehicle.sortie.run_records import Phase
from planning.base.findings import Severity

MARKS = {"error": "\u2717", "warning": "!"}
"""Sign beside the name of an aircraft with a warning: none is told by colour alone."""

N_KEYS = 9
MOST_TALL, LARGEST_TALL_PX, LINE_ASIDE_PX = 2, 22, 14
"""So many aircraft have two lines each of so high a text at most, else one, so that all buttons keep their room on a
small screen; what frame and padding take of a button's height."""


@dataclass(frozen=True, slots=True)
class FleetRow:
    """An aircraft: what it is called, what it does, what a pilot compares, and the severity of its worst warning."""

    number: int
    name: str
    state: str
    details: str
    role: str = ""
    is_in_air: bool = False


WORST = (Severity.ERROR, Severity.WARNING, Severity.NOTE, Severity.OK)


class FleetTexts(QObject):
    """Says what each aircraft of a controller is doing."""

    def __init__(self, context: ApplicationContext, controller: FlyController, parent: QObject) -> None:
        super().__init__(parent)
        self._context, self._controller = context, controller

    def rows(self) -> tuple[FleetRow, ...]:
        """Each aircraft with where it stands, and what a pilot compares; the worst of its warnings colours it."""
        found = self._controller.aircraft
        states = {each.number: each.view.state for each in found if each.view is not None}
        away = distances_m(states)
        return tuple(self._row(each, away.get(each.number)) for each in found)

    def _row(self, each: LiveAircraft, away: tuple[float, int] | None) -> FleetRow:
        view, name = each.view, self.tr("Aircraft {0}").format(each.number)
        if view is None:
            return FleetRow(each.number, name, self.tr("not connected"), self._sortie(each))
        parts = [self._sortie(each)]
        if view.readouts.battery is not None:
            parts.append(f"{view.readouts.battery:.0%}")
        following = next((n for n, (_, s) in enumerate(view.view_states, 1) if s is ViewState.NEXT), None)
        if following is not None:
            parts.append(self.tr("photo {0}/{1}").format(following, len(view.view_states)))
        if away is not None:
            apart = length_unit(self._context.units).text(away[0])
            both = len(self._controller.aircraft) == 2
            parts.append(self.tr("{0} apart").format(apart) if both else self.tr("{0} to {1}").format(apart, away[1]))
        wait_s = self._controller.wait_s(each)
        if math.isinf(wait_s):
            parts.append(self.tr("start apart from the others"))
        elif wait_s > 0.0:
            parts.append(self.tr("start in {0}").format(minutes_text(wait_s)))
        worst = min((warning.severity for warning in view.warnings), key=WORST.index, default=None)
        role = Severity.ERROR.value if view.link is LinkState.LOST else "" if worst is None else worst.value
        state = self._short(view, has_landed=each.active is not None and each.active.ended is not None)
        return FleetRow(each.number, name, state, ", ".join(parts), role, is_in_air(view.state))

    def _sortie(self, each: LiveAircraft) -> str:
        return self.tr("sortie {0}").format(each.sortie_number)

    def _short(self, view: LiveView, *, has_landed: bool) -> str:
        if view.link is LinkState.LOST:
            return self.tr("signal lost")
        if view.state.is_armed:
            return self.tr("in flight") if view.state.mode is None else view.state.mode.value
        idle = self.tr("landed") if has_landed else self.tr("connected")
        texts = {Phase.READY: self.tr("ready"), Phase.ENDED: self.tr("landed"), None: idle}
        return texts.get(view.phase, self.tr("being prepared"))


class FleetBox(QWidget):
    """Shows what it gets; hidden where there is one aircraft.

    Signals
    -------
    selected(int)
        Number of the aircraft that is pressed.
    returnAllRequested()
    """

    selected = Signal(int)
    returnAllRequested = Signal()  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName(self.tr("Aircraft"))
        self._rows: tuple[FleetRow, ...] = ()
        self._buttons: list[QPushButton] = []
        self._group = QButtonGroup(self)
        self.return_all = HoldButton(self.tr("All return, one by one"))
        self.return_all.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.return_all.setToolTip(
            self.tr("Hold: one after the other returns and lands, the lowest battery first; the rest hover meanwhile")
        )
        self.return_all.clicked.connect(self.returnAllRequested)
        self._layout = QVBoxLayout(self)
        self._layout.setContentsMargins(0, 0, 0, APART_PX)
        self._layout.addSpacing(APART_PX - self._layout.spacing())
        self._layout.addWidget(self.return_all)
        for number in range(1, N_KEYS + 1):
            keys = QShortcut(QKeySequence(aircraft_keys(number)), self)
            keys.activated.connect(lambda number=number: self.selected.emit(number))
        self.hide()

    def set_rows(self, rows: tuple[FleetRow, ...], selected: int) -> None:
        """Show these aircraft; none: hide."""
        self._rows = rows
        while len(self._buttons) < len(rows):
            self._add()
        self._write()
        for button, row in zip(self._buttons, rows, strict=False):
            button.setChecked(row.number == selected)
        for button in self._buttons[len(rows) :]:
            button.hide()
        set_enabled(self.return_all, any(row.is_in_air for row in rows))
        self.setVisible(bool(rows))

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Fit the words to another width."""
        super().resizeEvent(event)
        self._write()

    def _write(self) -> None:
        for button, row in zip(self._buttons, self._rows, strict=False):
            self._fill(button, row)

    def button(self, number: int) -> QPushButton:
        """The button of an aircraft, from 1."""
        return self._buttons[number - 1]

    def text(self) -> str:
        """All that is shown, two lines for each aircraft."""
        return "\n".join(button.text() for button in self._buttons[: len(self._rows)])

    def _add(self) -> None:
        number = len(self._buttons) + 1
        button = QPushButton()
        button.setCheckable(True)
        button.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        if number <= N_KEYS:
            keys = shown_keys(QKeySequence(aircraft_keys(number)))
            button.setToolTip(self.tr("Show this aircraft; the buttons below are for it ({0})").format(keys))
        button.clicked.connect(lambda _checked=False: self.selected.emit(number))
        self._group.addButton(button)
        self._layout.insertWidget(number - 1, button)
        self._buttons.append(button)

    def _fill(self, button: QPushButton, row: FleetRow) -> None:
        mark = MARKS.get(row.role, "")
        title = f"{mark} {row.name}: {row.state}" if mark else f"{row.name}: {row.state}"
        wide = max(40, self.width() - 2 * APART_PX)
        metrics, cut = button.fontMetrics(), Qt.TextElideMode.ElideRight
        is_tall = len(self._rows) <= MOST_TALL and metrics.height() <= LARGEST_TALL_PX
        lines = (title, row.details) if is_tall else (f"{title}, {row.details}",)
        button.setMinimumHeight(len(lines) * metrics.height() + LINE_ASIDE_PX)
        text = "\n".join(metrics.elidedText(each, cut, wide) for each in lines)
        if button.text() != text:
            button.setText(text)
            button.setAccessibleName(f"{title}, {row.details}")
        look = colours()
        edge = {"error": look.error, "warning": look.warning}.get(row.role)
        style = "text-align: left;" + (f" border: 3px solid {edge};" if edge else "")
        if button.styleSheet() != style:
            button.setStyleSheet(style)
        button.show()


def aircraft_keys(number: int) -> str:
    """Keys that select an aircraft."""
    return f"Ctrl+Shift+{number}"
