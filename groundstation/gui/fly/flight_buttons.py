"""The list before take-off and the large buttons of a flight; Return and Land lie apart from the rest."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QSize, Qt, Signal
from PySide6.QtGui import QAction, QFont, QFontMetrics, QKeySequence, QMouseEvent, QResizeEvent
from PySide6.QtWidgets import QGridLayout, QLabel, QPushButton, QSizePolicy, QVBoxLayout, QWidget

from groundstation.gui.application.translate import shown_keys, translated
from groundstation.gui.widgets.hold_button import HoldButton
from groundstation.gui.widgets.icons import ICON_PX, icon
from groundstation.gui.widgets.tab_order import set_enabled
from groundstation.gui.widgets.theme import colours
from groundstation.services.fly.events import Request
from groundstation.services.units import UnitSystem
from groundstation.vehicle.preflight import OnBoard, PreflightCheck, Remedy, Verdict, remedies

# The list before take-off: each check with its state, what was measured, and what to do.

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
    remedyRequested(Mend, PreflightCheck)
    """

    remedyRequested = Signal(object, object)  # noqa: N815  (Qt's own way of naming)

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

    def button(self, code: str, remedy: Remedy) -> QPushButton | None:
        """The button with which something can be done about a check; None where there is none."""
        for check, row in zip(self._checks, self._rows, strict=False):
            if check.code == code:
                return row.buttons.get(remedy)
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
                shown_text = translated(check.text, self._units)
                row.mark.setText(sign)
                row.words.setText(self.tr("{0}: {1}").format(names.get(check.code, check.code), shown_text))
                for label in (row.mark, row.words):
                    wanted = role if label is row.mark or check.verdict is not Verdict.OK else ""
                    if label.property("role") != wanted:
                        label.setProperty("role", wanted)
                        label.style().polish(label)
                self._offer(row, check)

    def _offer(self, row: _Row, check: PreflightCheck) -> None:
        """Buttons for what can be done about a check; those that stay are not made anew under the pointer."""
        ways = remedies(check, self._on_board)
        row.check = check
        if tuple(row.buttons) == ways:
            return
        for button in row.buttons.values():
            row.line.removeWidget(button)
            button.deleteLater()
        row.buttons = {}
        texts = self._remedy_texts()
        for number, remedy in enumerate(ways):
            button = QPushButton(texts[remedy])
            button.clicked.connect(
                lambda _checked=False, remedy=remedy, row=row: self.remedyRequested.emit(remedy, row.check)
            )
            row.line.insertWidget(number, button)
            row.buttons[remedy] = button

    def _remedy_texts(self) -> dict[Remedy, str]:
        return {
            Remedy.SET_PARAMETERS: self.tr("Set parameters ..."),
            Remedy.RAISE: self.tr("Fly from this height ..."),
            Remedy.PLAN_FROM_HERE: self.tr("Home here ..."),
            Remedy.OVERRULE: self.tr("Overrule ..."),
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
            "remote-id": self.tr("Remote ID"),
            "corrections": self.tr("RTK corrections"),
            "wind": self.tr("Wind"),
            "low-flight": self.tr("Lowest flight"),
            "mission": self.tr("Mission on board"),
            "geofence": self.tr("Geofence on board"),
            "foreign-fence": self.tr("Geofence of others"),
            "fence-before": self.tr("Earlier geofence"),
            "fence-gaps": self.tr("Not in the geofence"),
            "fence-shape": self.tr("Drawn otherwise in the geofence"),
            "rally": self.tr("Rally points on board"),
            "parameters": self.tr("Parameters"),
            "link-loss": self.tr("Signal lost"),
            "rc-loss": self.tr("Remote control lost"),
            "battery-low": self.tr("Battery low"),
            "position-loss": self.tr("Position lost"),
            "return": self.tr("Return to home (RTH)"),
            "fence-action": self.tr("At the geofence"),
            "fence-height": self.tr("Height limit"),
            "fence-radius": self.tr("Circle around home"),
        }


class _Row:
    """Widgets of one check."""

    def __init__(self, number: int) -> None:
        self.check: PreflightCheck | None = None
        self.mark, self.words, self.side = QLabel(), QLabel(), QWidget()
        self.mark.setFixedWidth(max(self.mark.fontMetrics().horizontalAdvance(sign) for sign, _ in MARKS.values()))
        self.words.setWordWrap(True)
        self.side.setObjectName(f"check-{number}")
        self.buttons: dict[Remedy, QPushButton] = {}
        self.line = QVBoxLayout()
        self.line.setAlignment(Qt.AlignmentFlag.AlignLeft)
        layout = QVBoxLayout(self.side)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(2)
        layout.addWidget(self.words)
        layout.addLayout(self.line)


ASIDE_PX, LEAST_POINTS = 38, 8.0
"""What frame, padding and the space beside the icon take of a button's width; the smallest words."""

APART_PX = 16
"""Free space around Return and Land, in which a click that misses does nothing."""

ICONS = {
    Request.UPLOAD: "upload",
    Request.START: "take-off",
    Request.PAUSE: "pause",
    Request.RESUME: "resume",
    Request.RETURN: "return",
    Request.LAND: "land",
}

PLACES = {
    Request.UPLOAD: (0, 0, 1),
    Request.START: (0, 1, 1),
    Request.PAUSE: (1, 0, 1),
    Request.RESUME: (1, 1, 1),
    Request.RETURN: (3, 0, 2),
    Request.LAND: (5, 0, 2),
}
"""Row, column and width in columns; the rows between are empty."""


HELD = (Request.START, Request.RETURN, Request.LAND)
"""What the aircraft cannot be kept from any more once it is ordered. The shortcuts, three keys at once, act at once."""


class FlightButtons(QWidget):
    """One button for each request; which can be asked for is told to it.

    Buttons are never hidden and never change their place: what cannot be asked for is shown as such where it is. Return
    and Land are told apart by word, shape and colour.

    Signals
    -------
    requested(Request)
    """

    requested = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._actions: dict[Request, QAction] = {}
        self._buttons: dict[Request, QPushButton] = {}
        self._number: int | None = None
        layout = self._grid = QGridLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        for request, text, key, tip in self._rows():
            action = QAction(text, self)
            action.setShortcut(QKeySequence(key))
            action.setAutoRepeat(False)
            action.triggered.connect(lambda _checked=False, request=request: self._order(request))
            button = HoldButton(text) if request in HELD else _Button(text)
            # As wide as the column is: a button of a flight is never cut off at its side, see `_fit`.
            button.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
            button.setIconSize(QSize(ICON_PX, ICON_PX))
            button.setProperty("flight", request.name.lower())
            tip = self.tr("Hold: {0}").format(tip) if request in HELD else tip
            button.setToolTip(self.tr("{0} ({1})").format(tip, shown_keys(action.shortcut())))
            button.clicked.connect(action.trigger)
            self._actions[request], self._buttons[request] = action, button
            row, column, width = PLACES[request]
            layout.addWidget(button, row, column, 1, width)
        for row in (2, 4):
            layout.setRowMinimumHeight(row, APART_PX - layout.verticalSpacing())
        self.set_allowed(frozenset())
        self._draw_icons()

    def _rows(self) -> tuple[tuple[Request, str, str, str], ...]:
        return (
            (Request.UPLOAD, self.tr("Upload"), "Ctrl+Shift+U", self.tr("Send the mission, and read it back")),
            (Request.START, self.tr("Start"), "Ctrl+Shift+Return", self.tr("Take off and fly the mission; asks first")),
            (Request.PAUSE, self.tr("Pause"), "Ctrl+Shift+Space", self.tr("Stop on the spot and hover")),
            (Request.RESUME, self.tr("Resume"), "Ctrl+Shift+G", self.tr("Go on with the mission")),
            (Request.RETURN, self.tr("Return to home (RTH)"), "Ctrl+Shift+Home", self.tr("Fly home and land there")),
            # Not End, the neighbour of Home: one is no slip of the other.
            (Request.LAND, self.tr("Land"), "Ctrl+Shift+L", self.tr("Land here and now")),
        )

    def set_aircraft(self, number: int | None) -> None:
        """Say on Return and Land which of several aircraft they are for; None where there is one."""
        if number == self._number:
            return
        self._number = number
        for request, text, _, _ in self._rows():
            if request in (Request.RETURN, Request.LAND):
                button = self._buttons[request]
                button.setText(text if number is None else self.tr("{0}: {1}").format(number, text))
                button.setAccessibleName("" if number is None else self.tr("Aircraft {0}: {1}").format(number, text))
        self._fit()

    def set_allowed(self, allowed: frozenset[Request]) -> None:
        """Enable what can be asked for."""
        for request, action in self._actions.items():
            action.setEnabled(request in allowed)
            was_enabled = self._buttons[request].isEnabled()
            set_enabled(self._buttons[request], request in allowed)
            if was_enabled != (request in allowed):
                self._draw_icon(request)
        # What cannot be pressed is not stressed: some themes leave its text hard to read.
        wanted = next((request for request in (Request.START, Request.UPLOAD) if request in allowed), None)
        for request in (Request.UPLOAD, Request.START):
            button = self._buttons[request]
            if button.property("primary") != (request is wanted):
                button.setProperty("primary", request is wanted)
                button.style().polish(button)
                self._draw_icon(request)

    def _order(self, request: Request) -> None:
        """Ask for it; what is asked for once is not asked for again before the flight has told what it may do now."""
        if request in (Request.UPLOAD, Request.START):
            self._actions[request].setEnabled(False)
            set_enabled(self._buttons[request], False)
        self.requested.emit(request)

    def button(self, request: Request) -> QPushButton:
        """The button of a request."""
        return self._buttons[request]

    def held(self, request: Request) -> HoldButton:
        """The button of a request that is held."""
        button = self._buttons[request]
        assert isinstance(button, HoldButton)
        return button

    def emergency_actions(self) -> list[QAction]:
        """Return and Land."""
        return [self._actions[request] for request in (Request.RETURN, Request.LAND)]

    def flight_actions(self) -> list[QAction]:
        """For the tab's menu."""
        return list(self._actions.values())

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Fit the words to another width."""
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        """Write words that are too long for their button smaller."""
        self._grid.activate()
        for request, button in self._buttons.items():
            font = QFont(self.font())
            # The style sheet writes these bold.
            font.setBold(request in (Request.RETURN, Request.LAND))
            wide = QFontMetrics(font).horizontalAdvance(button.text())
            room = button.width() - ICON_PX - ASIDE_PX
            if wide > room > 0:
                font.setPointSizeF(max(LEAST_POINTS, font.pointSizeF() * room / wide))
            if button.font() != font:
                button.setFont(font)

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Draw the icons in the colours of another theme."""
        super().changeEvent(event)
        if event.type() in (QEvent.Type.PaletteChange, QEvent.Type.StyleChange) and self._buttons:
            self._draw_icons()
            self._fit()

    def _draw_icons(self) -> None:
        for request in self._buttons:
            self._draw_icon(request)

    def _draw_icon(self, request: Request) -> None:
        look, button = colours(), self._buttons[request]
        is_filled = request in (Request.RETURN, Request.LAND) and button.isEnabled()
        on = look.base if is_filled else look.accent_text if button.property("primary") else look.text
        button.setIcon(icon(ICONS[request], on, ICON_PX))


class _Button(QPushButton):
    """A button that takes a double click for one."""

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """The second press is no second order."""
        event.accept()
