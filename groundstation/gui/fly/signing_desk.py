"""What becomes of the pilot's wishes for the signing key: asked about, done as jobs, and told."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QWidget

from groundstation.gui.fly.connection_box import ConnectionBox
from groundstation.gui.fly.signing_box import KeyAction
from groundstation.gui.fly.signing_questions import SigningQuestions
from groundstation.gui.workspace import Workspace
from groundstation.services.live_choice import ConnectionChoice
from groundstation.services.signing import forget_passphrase, give_key, has_key, set_passphrase, withdraw_key
from planning.findings import Severity


class SigningDesk(QObject):
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

    def __init__(self, workspace: Workspace, parent: QObject) -> None:
        super().__init__(parent)
        self._workspace = workspace
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
        return any(job.id == self._job_id for job in self._workspace.jobs())

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
        self._job_id = self._workspace.start(name, lambda _context: work(), done).id

    def _was_set(self, _result: object) -> None:
        self.keyChanged.emit(True)
        self._workspace.say(Severity.OK, self.tr("Key kept. Give it to the vehicle over a cable."))

    def _was_forgotten(self, _result: object) -> None:
        self.keyChanged.emit(False)
        self._workspace.say(Severity.OK, self.tr("There is no key on this computer any more."))

    def _was_given(self, url: str) -> None:
        self.vehicleChanged.emit(url, True)
        self._workspace.say(Severity.OK, self.tr("The vehicle at {0} has the key, and signs with it.").format(url))

    def _was_withdrawn(self, url: str) -> None:
        self.vehicleChanged.emit(url, False)
        self._workspace.say(Severity.OK, self.tr("The vehicle at {0} was told to sign no more.").format(url))
