"""Whether the link is signed, and what can be done with this computer's key; the key itself is never shown."""

from __future__ import annotations

from enum import Enum, auto

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QCheckBox, QHBoxLayout, QLabel, QMenu, QPushButton, QVBoxLayout, QWidget


class KeyAction(Enum):
    """What the pilot wants done with the key."""

    SET = auto()
    GIVE = auto()
    WITHDRAW = auto()
    FORGET = auto()


class SigningBox(QWidget):
    """Edits whether a link is signed.

    Signals
    -------
    valueChanged(bool)
    keyActionRequested(KeyAction)
    """

    valueChanged = Signal(bool)  # noqa: N815  (Qt's own way of naming)
    keyActionRequested = Signal(object)  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._has_key: bool | None = None
        self.signed, self.key = QCheckBox(self.tr("Signed")), QPushButton(self.tr("Key"))
        self.signed.setToolTip(self.tr("Sign what is sent, and hear nobody who does not sign with the same key"))
        self._says = QLabel()
        self._says.setWordWrap(True)
        self._says.setProperty("role", "muted")
        self._actions: dict[KeyAction, QAction] = {}
        self.key.setMenu(self._menu())
        row = QHBoxLayout()
        row.addWidget(self.signed, 1)
        row.addWidget(self.key)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(2)
        layout.addLayout(row)
        layout.addWidget(self._says)
        self.signed.toggled.connect(self._toggled)
        self.set_key(None)

    def value(self) -> bool:
        """Whether the link is signed."""
        return self.signed.isChecked()

    def setValue(self, value: bool) -> None:  # noqa: N802
        """Show another choice."""
        with QSignalBlocker(self.signed):
            self.signed.setChecked(value)
        self._show()

    def set_key(self, has_key: bool | None) -> None:
        """Show whether this computer keeps a key; None while that is not known."""
        self._has_key = has_key
        for action in (KeyAction.GIVE, KeyAction.WITHDRAW, KeyAction.FORGET):
            self._actions[action].setEnabled(bool(has_key))
        self._show()

    def action(self, action: KeyAction) -> QAction:
        """One entry of the menu."""
        return self._actions[action]

    def text(self) -> str:
        """What is said about the key."""
        return self._says.text()

    def _menu(self) -> QMenu:
        menu = QMenu(self)
        for action, text in (
            (KeyAction.SET, self.tr("Set passphrase...")),
            (KeyAction.GIVE, self.tr("Give it to the vehicle...")),
            (KeyAction.WITHDRAW, self.tr("Withdraw it from the vehicle...")),
            (KeyAction.FORGET, self.tr("Forget it on this computer...")),
        ):
            entry = QAction(text, menu)
            entry.triggered.connect(lambda _checked=False, action=action: self.keyActionRequested.emit(action))
            menu.addAction(entry)
            self._actions[action] = entry
        return menu

    def _show(self) -> None:
        if self._has_key is None:
            text = ""
        elif self._has_key:
            text = self.tr("This computer keeps a key.")
        else:
            text = self.tr("This computer keeps no key yet.")
        role = "warning" if self._has_key is False and self.signed.isChecked() else "muted"
        self._says.setText(text)
        self._says.setVisible(bool(text))
        if self._says.property("role") != role:
            self._says.setProperty("role", role)
            self._says.style().polish(self._says)

    def _toggled(self, is_on: bool) -> None:
        self._show()
        self.valueChanged.emit(is_on)
