"""Questions that the window asks before something is lost, and files and folders it asks for.

They are in a class of their own so that whoever drives the window without a user (tests, screenshots) can answer them.
"""

from __future__ import annotations

from enum import Enum, auto
from pathlib import Path

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QFileDialog, QMessageBox, QWidget


class Answer(Enum):
    """What the user said."""

    YES = auto()
    NO = auto()
    CANCEL = auto()


class Questions(QObject):
    """Asks by dialogs."""

    def save_first(self, parent: QWidget) -> Answer:
        """Whether to save before something else happens."""
        buttons = QMessageBox.StandardButton
        said = QMessageBox.question(
            parent,
            self.tr("Unsaved changes"),
            self.tr("This project has changes that are not saved. Save them first?"),
            buttons.Save | buttons.Discard | buttons.Cancel,
            buttons.Save,
        )
        return {buttons.Save: Answer.YES, buttons.Discard: Answer.NO}.get(said, Answer.CANCEL)

    def recover(self, parent: QWidget, when: str, changes: tuple[str, ...], is_of_saved_state: bool) -> Answer:
        """Whether unsaved work from before a crash is wanted."""
        buttons = QMessageBox.StandardButton
        listed = "\n".join(f"- {change}" for change in changes)
        text = self.tr("Reflight ended before this work was saved (copy of {0}):\n{1}\n\nTake it over?").format(
            when, listed
        )
        if not is_of_saved_state:
            text += "\n" + self.tr("The project was saved by others since then: their changes would be taken back.")
        said = QMessageBox.question(
            parent, self.tr("Unsaved work"), text, buttons.Yes | buttons.Discard | buttons.Cancel, buttons.Yes
        )
        return {buttons.Yes: Answer.YES, buttons.Discard: Answer.NO}.get(said, Answer.CANCEL)

    def folder(self, parent: QWidget, title: str) -> Path | None:
        """A folder that exists."""
        name = QFileDialog.getExistingDirectory(parent, title)
        return Path(name) if name else None

    def new_folder(self, parent: QWidget, title: str) -> Path | None:
        """A folder to be made."""
        name, _ = QFileDialog.getSaveFileName(parent, title, "", options=QFileDialog.Option.ShowDirsOnly)
        return Path(name) if name else None

    def file(self, parent: QWidget, title: str, kinds: str) -> Path | None:
        """A file that exists; `kinds` as Qt has them, "Sites (*.json)"."""
        name, _ = QFileDialog.getOpenFileName(parent, title, "", kinds)
        return Path(name) if name else None
