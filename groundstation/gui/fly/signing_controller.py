"""What the pilot does with the signing key: asked about, done as jobs, and told."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QLabel, QLineEdit, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.fly.connection_box import ConnectionBox, KeyAction
from groundstation.gui.widgets.inputs import Form
from groundstation.gui.widgets.questions import agrees
from groundstation.services.fly.options import ConnectionChoice
from groundstation.services.fly.signing import (
    MIN_PASSPHRASE,
    forget_passphrase,
    give_key,
    has_key,
    set_passphrase,
    withdraw_key,
)
from planning.base.findings import Severity

# Questions about the key of signed links: its passphrase, and whether to hand it out, take it back or forget it.


class PassphraseDialog(QDialog):
    """Asks for a passphrase, twice and unseen."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Set the signing passphrase"))
        says = QLabel(
            self.tr(
                "The key is made of the passphrase, as other ground stations make it: the same passphrase is the same "
                "key there. It is kept for you alone on this computer, never in a project, and replaces the one before."
            )
        )
        says.setWordWrap(True)
        self.first, self.second = QLineEdit(), QLineEdit()
        for box in (self.first, self.second):
            box.setEchoMode(QLineEdit.EchoMode.Password)
            box.setMinimumWidth(280)
            box.textChanged.connect(self._show)
        self._problem = QLabel()
        self._problem.setWordWrap(True)
        self._problem.setProperty("role", "warning")
        buttons = QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel
        self.buttons = QDialogButtonBox(buttons)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        layout = Form(self)
        layout.addRow(says)
        layout.addRow(self.tr("Passphrase"), self.first)
        layout.addRow(self.tr("Once more"), self.second)
        layout.addRow(self._problem)
        layout.addRow(self.buttons)
        self._show()

    def value(self) -> str:
        """What was typed."""
        return self.first.text()

    def problem(self) -> str:
        """Why it cannot be taken yet; empty where it can."""
        if len(self.first.text()) < MIN_PASSPHRASE:
            return self.tr("It needs {0} characters or more: short ones are guessed.").format(MIN_PASSPHRASE)
        if self.first.text() != self.second.text():
            return self.tr("The two are not the same yet.")
        return ""

    def _show(self) -> None:
        problem = self.problem()
        self._problem.setText(problem)
        self.buttons.button(QDialogButtonBox.StandardButton.Ok).setEnabled(not problem)


class SigningQuestions(QObject):
    """Asks by dialogs; a class of its own so that whoever drives the window without a user can answer."""

    def passphrase(self, parent: QWidget) -> str | None:
        """The passphrase that the pilot wants; None where he thought better of it."""
        dialog = PassphraseDialog(parent)
        is_taken = dialog.exec() == QDialog.DialogCode.Accepted
        typed = dialog.value() if is_taken else None
        dialog.deleteLater()
        return typed

    def give(self, parent: QWidget, url: str) -> bool:
        """Whether to give the vehicle the key."""
        return agrees(
            parent,
            self.tr("Give the vehicle the key"),
            self.tr(
                "The key goes to the vehicle at {0} as it is: whoever listens to that link learns it. Use a cable. "
                "From then on the vehicle obeys signed links only. Give it the key?"
            ).format(url),
            warns=True,
        )

    def withdraw(self, parent: QWidget, url: str) -> bool:
        """Whether to take the key back."""
        return agrees(
            parent,
            self.tr("Withdraw the key from the vehicle"),
            self.tr(
                "The vehicle at {0} forgets the key, and obeys everybody who reaches it from then on. Withdraw the key?"
            ).format(url),
            warns=True,
        )

    def forget(self, parent: QWidget) -> bool:
        """Whether to keep no key on this computer."""
        return agrees(
            parent,
            self.tr("Forget the key"),
            self.tr(
                "Vehicles that know the key keep it, and obey this computer again only when the same passphrase is set "
                "once more. Forget the key on this computer?"
            ),
            warns=True,
        )


class SigningController(QObject):
    """The key of this computer, and the vehicles that are given it.

    Signals
    -------
    keyChanged(bool)
        Whether this computer keeps a key.
    vehicleChanged(str, bool)
        The vehicle at a url signs from now on, or no longer.
    """

    keyChanged = Signal(bool)  # noqa: N815  (Qt's own way of naming)
    vehicleChanged = Signal(str, bool)  # noqa: N815

    def __init__(self, context: ApplicationContext, parent: QObject) -> None:
        super().__init__(parent)
        self._context = context
        self._job_id = 0
        self.questions = SigningQuestions(self)

    def serve(self, box: ConnectionBox, window: QWidget) -> None:
        """Do what is asked for beside the address, and show what became of it there."""
        box.keyActionRequested.connect(lambda action, url: self.do(action, url, window))
        self.keyChanged.connect(box.signing.set_key)
        self.vehicleChanged.connect(box.set_signed)

    @property
    def is_busy(self) -> bool:
        """Whether something is being done with the key."""
        return any(job.id == self._job_id for job in self._context.jobs())

    def look(self, choice: ConnectionChoice) -> None:
        """Find out whether there is a key, where one counts: the system's key store may take its time."""
        if choice.url and not self.is_busy:
            self._start(self.tr("Look for the signing key"), has_key, self.keyChanged.emit)

    def do(self, action: KeyAction, url: str, parent: QWidget) -> None:
        """Ask, and do it; `url` is the address that is chosen."""
        if self.is_busy:
            return
        match action:
            case KeyAction.SET:
                passphrase = self.questions.passphrase(parent)
                if passphrase is not None:
                    self._start(self.tr("Set the signing key"), lambda: set_passphrase(passphrase), self._was_set)
            case KeyAction.FORGET:
                if self.questions.forget(parent):
                    self._start(self.tr("Forget the signing key"), forget_passphrase, self._was_forgotten)
            case KeyAction.GIVE:
                if self.questions.give(parent, url):
                    self._start(
                        self.tr("Give the vehicle the key"), lambda: give_key(url), lambda _: self._was_given(url)
                    )
            case KeyAction.WITHDRAW:
                if self.questions.withdraw(parent, url):
                    self._start(
                        self.tr("Withdraw the key"), lambda: withdraw_key(url), lambda _: self._was_withdrawn(url)
                    )

    def _start(self, name: str, work: Callable[[], object], done: Callable[[object], None]) -> None:
        self._job_id = self._context.start(name, lambda _context: work(), done).id

    def _was_set(self, _result: object) -> None:
        self.keyChanged.emit(True)
        self._context.say(Severity.OK, self.tr("Key kept. Give it to the vehicle over a cable."))

    def _was_forgotten(self, _result: object) -> None:
        self.keyChanged.emit(False)
        self._context.say(Severity.OK, self.tr("There is no key on this computer any more."))

    def _was_given(self, url: str) -> None:
        self.vehicleChanged.emit(url, True)
        self._context.say(Severity.OK, self.tr("The vehicle at {0} has the key, and signs with it.").format(url))

    def _was_withdrawn(self, url: str) -> None:
        self.vehicleChanged.emit(url, False)
        self._context.say(Severity.OK, self.tr("The vehicle at {0} was told to sign no more.").format(url))
