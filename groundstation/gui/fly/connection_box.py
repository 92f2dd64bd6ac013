"""How to reach the vehicle, the embedded simulation or a link, and whether that link is signed."""

from __future__ import annotations

from dataclasses import replace
from enum import Enum, auto

from PySide6.QtCore import QSignalBlocker, QSize, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import (
    QCheckBox,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QMenu,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.widgets.inputs import ChoiceBox, Form, NumberBox
from groundstation.gui.widgets.tab_order import set_enabled
from groundstation.services.fly.options import USUAL_ADDRESS, ConnectionChoice, LinkKind
from missions.mavlink.autopilots import Autopilot

# Whether the link is signed, and what can be done with this computer's key; the key itself is never shown.


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


MAX_SPEED_UP = 50.0


class _AddressLine(QLineEdit):
    """Has room for each of the usual addresses; its title goes above it before it has less."""

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        """A letter wider than the longest, for the cursor."""
        hint = super().minimumSizeHint()
        longest = max(map(self.fontMetrics().horizontalAdvance, USUAL_ADDRESS.values()))
        return QSize(longest + hint.width(), hint.height())


class ConnectionBox(QWidget):
    """Edits a `ConnectionChoice`.

    Signals
    -------
    valueChanged(ConnectionChoice)
    connectRequested(), disconnectRequested()
    keyActionRequested(KeyAction, str)
        Something is to be done with the signing key, for the vehicle at a url.
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)
    connectRequested = Signal()  # noqa: N815
    disconnectRequested = Signal()  # noqa: N815
    keyActionRequested = Signal(object, str)  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._value = ConnectionChoice()
        self._addresses = dict(USUAL_ADDRESS)
        self._is_connected = False
        self.kind, self.autopilot, self.address = ChoiceBox(), ChoiceBox(), _AddressLine()
        self.signing = SigningBox()
        self.speed_up = NumberBox(1.0, MAX_SPEED_UP, 1.0, " x", 0)
        self.button = QPushButton()
        self._says = QLabel()
        self._says.setWordWrap(True)
        self._says.setProperty("role", "muted")
        for kind, text in (
            (LinkKind.SIMULATION, self.tr("Simulation")),
            (LinkKind.UDP, self.tr("UDP")),
            (LinkKind.TCP, self.tr("TCP")),
            (LinkKind.SERIAL, self.tr("Serial port")),
        ):
            self.kind.addItem(text, kind)
        self.autopilot.addItem("ArduPilot", Autopilot.ARDUPILOT)
        self.autopilot.addItem("PX4", Autopilot.PX4)
        self._fields = QWidget()
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Minimum)
        self._fields.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Minimum)
        self._form = Form(self._fields)
        self._form.setContentsMargins(0, 0, 0, 0)
        self._form.addRow(self.tr("Vehicle"), self.kind)
        self._form.addRow(self.tr("Autopilot"), self.autopilot)
        self._form.addRow(self.tr("Speed-up"), self.speed_up)
        self._form.addRow(self.tr("Address"), self.address)
        self._form.addRow(self.tr("Link"), self.signing)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        # The button stands above what it is for: the fields below fold away, and it must not move under the pointer.
        layout.addWidget(self.button)
        layout.addWidget(self._says)
        layout.addWidget(self._fields)
        self.kind.currentIndexChanged.connect(self._kind_chosen)
        self.autopilot.currentIndexChanged.connect(self._edited)
        self.speed_up.valueChanged.connect(self._edited)
        self.address.editingFinished.connect(self._edited)
        self.signing.valueChanged.connect(self._signed)
        self.signing.keyActionRequested.connect(lambda action: self.keyActionRequested.emit(action, self._value.url))
        self.button.clicked.connect(self._pressed)
        self._show()

    def value(self) -> ConnectionChoice:
        """What is chosen."""
        return self._value

    def setValue(self, value: ConnectionChoice) -> None:  # noqa: N802
        """Show another choice."""
        self._value = value
        if value.address:
            self._addresses[value.kind] = value.address
        self._show()

    def set_signed(self, url: str, is_signed: bool) -> None:
        """The vehicle at a url signs from now on, or no longer: so does the link to it, as if it was chosen."""
        self._take(self._value.with_signed(url, is_signed=is_signed))

    def set_connected(self, *, is_connected: bool, says: str) -> None:
        """Show that a connection is open, so that only closing it is offered; `says` stands below."""
        self._is_connected = is_connected
        self._says.setText(says)
        self._show()

    def set_possible(self, *, is_possible: bool) -> None:
        """Whether there is a sortie to connect for."""
        set_enabled(self.button, is_possible or self._is_connected)

    def _show(self) -> None:
        value = self._value
        boxes = (self.kind, self.autopilot, self.speed_up, self.address)
        blockers = [QSignalBlocker(box) for box in boxes]
        self.kind.setCurrentIndex(self.kind.findData(value.kind))
        self.autopilot.show_value(value.autopilot, value.autopilot.value)
        self.speed_up.setValue(value.speed_up)
        self.address.setText(value.address or self._addresses[value.kind])
        del blockers
        self.signing.setValue(value.is_signed)
        is_simulation = value.kind is LinkKind.SIMULATION
        for box, is_shown in (
            (self.kind, True),
            (self.autopilot, is_simulation),
            (self.speed_up, is_simulation),
            (self.address, not is_simulation),
            (self.signing, not is_simulation),
        ):
            self._form.setRowVisible(box, is_shown)
            set_enabled(box, not self._is_connected)
        # Connected, nothing can be chosen, and the list before take-off needs the room.
        self._fields.setVisible(not self._is_connected)
        self._says.setVisible(bool(self._says.text()))
        self.button.setText(self.tr("Disconnect") if self._is_connected else self.tr("Connect"))
        self.button.setProperty("primary", not self._is_connected)
        self.button.style().polish(self.button)

    def _kind_chosen(self) -> None:
        kind = LinkKind(self.kind.currentData())
        self._take(replace(self._value, kind=kind, address=self._addresses[kind]))

    def _edited(self) -> None:
        kind = self._value.kind
        address = "" if kind is LinkKind.SIMULATION else self.address.text().strip()
        self._addresses[kind] = address or self._addresses[kind]
        autopilot = Autopilot(self.autopilot.currentData())
        self._take(replace(self._value, address=address, autopilot=autopilot, speed_up=self.speed_up.value()))

    def _signed(self, is_signed: bool) -> None:
        self._take(self._value.with_signed(self._value.url, is_signed=is_signed))

    def _take(self, value: ConnectionChoice) -> None:
        if value != self._value:
            self._value = value
            self._show()
            self.valueChanged.emit(value)

    def _pressed(self) -> None:
        (self.disconnectRequested if self._is_connected else self.connectRequested).emit()
