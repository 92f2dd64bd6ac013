"""The large buttons of a flight, and their actions with shortcuts that no slip of a finger hits."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QGridLayout, QPushButton, QSizePolicy, QWidget

from groundstation.services.live_events import Request

HEIGHT_PX = 48
"""More than other buttons have: they are hit in a hurry."""


class FlightButtons(QWidget):
    """One button for each request; which can be asked for is told to it.

    Signals
    -------
    requested(Request)
    """

    requested = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._actions: dict[Request, QAction] = {}
        self._buttons: dict[Request, QPushButton] = {}
        layout = QGridLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        for number, (request, text, key, tip) in enumerate(self._rows()):
            action = QAction(text, self)
            action.setShortcut(QKeySequence(key))
            action.triggered.connect(lambda _checked=False, request=request: self.requested.emit(request))
            button = QPushButton(text)
            button.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
            layout.setRowMinimumHeight(number // 2, HEIGHT_PX)
            button.setToolTip(self.tr("{0} ({1})").format(tip, key))
            button.clicked.connect(action.trigger)
            self._actions[request], self._buttons[request] = action, button
            layout.addWidget(button, number // 2, number % 2)
        self.set_allowed(frozenset())

    def _rows(self) -> tuple[tuple[Request, str, str, str], ...]:
        return (
            (Request.UPLOAD, self.tr("Upload"), "Ctrl+Shift+U", self.tr("Send the mission, and read it back")),
            (Request.START, self.tr("Start"), "Ctrl+Shift+Return", self.tr("Take off and fly the mission; asks first")),
            (Request.PAUSE, self.tr("Pause"), "Ctrl+Shift+Space", self.tr("Stop on the spot and hover")),
            (Request.RESUME, self.tr("Resume"), "Ctrl+Shift+G", self.tr("Go on with the mission")),
            (Request.RETURN, self.tr("Return"), "Ctrl+Shift+Home", self.tr("Fly home and land there")),
            (Request.LAND, self.tr("Land"), "Ctrl+Shift+End", self.tr("Land here and now")),
        )

    def set_allowed(self, allowed: frozenset[Request]) -> None:
        """Enable what can be asked for."""
        for request, action in self._actions.items():
            action.setEnabled(request in allowed)
            self._buttons[request].setEnabled(request in allowed)
        # What cannot be pressed is not stressed: some themes leave its text hard to read.
        wanted = next((request for request in (Request.START, Request.UPLOAD) if request in allowed), None)
        for request in (Request.UPLOAD, Request.START):
            button = self._buttons[request]
            if button.property("primary") != (request is wanted):
                button.setProperty("primary", request is wanted)
                button.style().polish(button)

    def button(self, request: Request) -> QPushButton:
        """The button of a request."""
        return self._buttons[request]

    def flight_actions(self) -> list[QAction]:
        """For the tab's menu."""
        return list(self._actions.values())
