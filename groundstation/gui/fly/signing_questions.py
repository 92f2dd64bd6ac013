"""Questions about the key of signed links: its passphrase, and whether to hand it out, take it back or forget it."""

from __future__ import annotations

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QLabel, QLineEdit, QWidget

from groundstation.gui.inputs import Form
from groundstation.gui.questions import agrees
from groundstation.services.signing import MIN_PASSPHRASE


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
