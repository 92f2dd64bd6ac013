"""Gives the buttons of a joystick to the flight: presses and releases, in whatever tab or dialog the window is."""

from __future__ import annotations

import sys
from pathlib import Path

from PySide6.QtCore import QObject, QSocketNotifier, QTimer, Signal
from PySide6.QtWidgets import QFormLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from groundstation.services.fly.joystick import (
    FOLDER,
    NO_BUTTON,
    ButtonEvent,
    Joystick,
    JoystickAction,
    JoystickButtons,
)

LOOK_MS = 2000
"""How often a joystick is looked for while there is none."""


class JoystickController(QObject):
    """One joystick at a time, which may come and go.

    Signals
    -------
    pressed(JoystickAction), released(JoystickAction)
    learned(int)
        The number of the button that was pressed while one was awaited.
    foundChanged(bool)
        Whether a joystick is there.
    """

    pressed = Signal(object)
    released = Signal(object)
    learned = Signal(int)
    foundChanged = Signal(bool)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QObject, folder: Path = FOLDER) -> None:
        super().__init__(parent)
        self._folder, self._buttons = folder, JoystickButtons()
        self._joystick: Joystick | None = None
        self._notifier: QSocketNotifier | None = None
        self._down: dict[int, JoystickAction] = {}
        self._is_learning = False
        self._look = QTimer(self, interval=LOOK_MS)
        self._look.timeout.connect(self.look)

    def is_found(self) -> bool:
        """Whether a joystick is there."""
        return self._joystick is not None

    def set_buttons(self, buttons: JoystickButtons) -> None:
        """What the buttons do from now on; a joystick is looked for only where one does anything."""
        self._buttons = buttons
        self._follow()

    def learn(self, *, is_learning: bool) -> None:
        """Await a button, which then does nothing else; or no more."""
        self._is_learning = is_learning
        self._follow()

    def look(self) -> None:
        """Look for a joystick now."""
        if self._joystick is None:
            self._joystick = Joystick.open_first(self._folder)
            if self._joystick is not None:
                self._look.stop()
                notifier = QSocketNotifier(self._joystick.descriptor, QSocketNotifier.Type.Read, self)
                notifier.activated.connect(self._read)
                self._notifier = notifier
                self.foundChanged.emit(True)

    def close(self) -> None:
        """Let go of the joystick, and of what it holds."""
        self._look.stop()
        if self._notifier is not None:
            self._notifier.setEnabled(False)
            self._notifier.deleteLater()
            self._notifier = None
        if self._joystick is not None:
            self._joystick.close()
            self._joystick = None
            self._let_go()
            self.foundChanged.emit(False)

    def _follow(self) -> None:
        if not (self._buttons.is_any or self._is_learning):
            self.close()
        elif self._joystick is None and not self._look.isActive():
            self._look.start()
            self.look()

    def _read(self) -> None:
        events = None if self._joystick is None else self._joystick.read()
        if events is None:
            # It was unplugged; what comes back at once has no events either, so that it is looked for later.
            self.close()
            self._look.start()
            return
        for event in events:
            self._take(event)

    def _take(self, event: ButtonEvent) -> None:
        if not event.is_down:
            action = self._down.pop(event.button, None)
            if action is not None:
                self.released.emit(action)
            return
        if self._is_learning:
            self._is_learning = False
            self.learned.emit(event.button)
            return
        action = self._buttons.action(event.button)
        if action is not None and event.button not in self._down:
            self._down[event.button] = action
            self.pressed.emit(action)

    def _let_go(self) -> None:
        held, self._down = tuple(self._down.values()), {}
        for action in held:
            self.released.emit(action)


# Which button does what: chosen by pressing it.


class JoystickBox(QWidget):
    """Edits `JoystickButtons`: one row for each action; its button is learned from the joystick.

    Signals
    -------
    valueChanged(JoystickButtons)
    learningChanged(bool)
        Whether a button of the joystick is awaited.
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)
    learningChanged = Signal(bool)  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._value = JoystickButtons()
        self._learning: JoystickAction | None = None
        self._state = QLabel()
        self._state.setWordWrap(True)
        self._state.setProperty("role", "muted")
        self.rows = {action: QPushButton() for action in JoystickAction}
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        title = QLabel(self.tr("Joystick"))
        title.setProperty("role", "heading")
        layout.addWidget(title)
        layout.addWidget(self._state)
        form = QFormLayout()
        texts = self._texts()
        for action, button in self.rows.items():
            button.clicked.connect(lambda _checked=False, action=action: self._clicked(action))
            form.addRow(texts[action], button)
        layout.addLayout(form)
        self.set_found(is_found=False)
        self._show()

    def value(self) -> JoystickButtons:
        """What was chosen."""
        return self._value

    def setValue(self, value: JoystickButtons) -> None:  # noqa: N802
        """Show another choice."""
        self._value = value
        self._show()

    def set_found(self, *, is_found: bool) -> None:
        """Say whether there is a joystick."""
        if not sys.platform.startswith("linux"):
            text = self.tr("Joysticks are read on Linux only.")
        elif is_found:
            text = self.tr("A joystick is there. Click a line, then press the button; click again for none.")
        else:
            text = self.tr("Click a line, then press a button of the joystick. Return and Land are held, too.")
        self._state.setText(text)

    def learn(self, button: int) -> None:
        """The button that was pressed."""
        if self._learning is not None:
            self._take(self._learning, button)

    def _texts(self) -> dict[JoystickAction, str]:
        return {
            JoystickAction.PAUSE: self.tr("Pause"),
            JoystickAction.RESUME: self.tr("Resume"),
            JoystickAction.RETURN: self.tr("Return, held"),
            JoystickAction.LAND: self.tr("Land, held"),
            JoystickAction.VIEW: self.tr("3-D or map"),
            JoystickAction.LISTS: self.tr("Lists"),
            JoystickAction.MUTE: self.tr("Mute"),
        }

    def _clicked(self, action: JoystickAction) -> None:
        if self._learning is action:
            self._take(action, NO_BUTTON)
        else:
            self._learning = action
            self._show()
            self.learningChanged.emit(True)

    def _take(self, action: JoystickAction, button: int) -> None:
        self._learning = None
        self._value = self._value.with_button(action, button)
        self._show()
        self.learningChanged.emit(False)
        self.valueChanged.emit(self._value)

    def _show(self) -> None:
        for action, button in self.rows.items():
            number = self._value.button(action)
            if self._learning is action:
                text = self.tr("Press it ...")
            else:
                text = self.tr("none") if number == NO_BUTTON else self.tr("button {0}").format(number)
            button.setText(text)
