"""Dialogs with which the window asks: yes or no, files and folders, and whether to save before something is lost.

All of them are asked here. `QMessageBox` answers with a number or an enum, depending on how it is called, and file
dialogs with a text that is empty where none was chosen: whoever asks gets a bool, an `Answer` or a path.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection
from enum import Enum, auto
from pathlib import Path

from PySide6.QtCore import QCoreApplication, QObject
from PySide6.QtWidgets import QDialog, QFileDialog, QInputDialog, QMessageBox, QWidget

from planning.folders import FILE_ENDING

_Button = QMessageBox.StandardButton

_ENDING = re.compile(r"\.[a-z][a-z0-9]{0,9}")
"""What counts as the ending of a file's name."""


class Answer(Enum):
    """What the user said."""

    YES = auto()
    NO = auto()
    CANCEL = auto()


def agrees(parent: QWidget, title: str, text: str, *, is_usual: bool = False, warns: bool = False) -> bool:
    """Whether the user says yes; a cancel, Escape and a closed dialog are no.

    Parameters
    ----------
    parent, title, text
        As dialogs have them.
    is_usual
        Yes is what the Enter key says, and not no.
    warns
        Something can be lost or hurt: the dialog looks like a warning.
    """
    ask = QMessageBox.warning if warns else QMessageBox.question
    usual = _Button.Yes if is_usual else _Button.Cancel
    return _asked(ask, parent, title, text, _Button.Yes | _Button.Cancel, usual) == _Button.Yes


def choose_file(parent: QWidget, title: str, kinds: str) -> Path | None:
    """A file that exists; `kinds` as Qt has them, "Sites (*.json)"."""
    name, _ = QFileDialog.getOpenFileName(parent, title, "", kinds)
    return Path(name) if name else None


def choose_files(parent: QWidget, title: str, kinds: str, folder: Path) -> tuple[Path, ...]:
    """Files that exist, first looked for in a folder; none where the user thought better of it."""
    names, _ = QFileDialog.getOpenFileNames(parent, title, str(folder), kinds)
    return tuple(Path(name) for name in names)


def choose_new_file(
    parent: QWidget, title: str, proposed: Path, kinds: str, ending: str, others: Collection[str] = ()
) -> Path | None:
    """Where a file is to be written; for one that is there already, the user was asked.

    A name gets the `ending` (".city.json") where it has none, or one that says something else is in the file and is
    none of `others`, before it is looked whether such a file is there.
    """
    dialog = QFileDialog(parent, title, str(proposed.parent) if proposed.is_absolute() else "", kinds)
    dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
    dialog.setFileMode(QFileDialog.FileMode.AnyFile)
    dialog.setDefaultSuffix(ending.removeprefix("."))
    dialog.selectFile(proposed.name)
    is_chosen = dialog.exec() == QDialog.DialogCode.Accepted
    chosen = Path(dialog.selectedFiles()[0]) if is_chosen else None
    dialog.deleteLater()
    if chosen is None:
        return None
    found = chosen.suffix.lower()
    fits = chosen.name.lower().endswith(ending) or found in others or not FILE_ENDING.fullmatch(found)
    if fits and _ENDING.fullmatch(found):
        return chosen
    # Qt takes "No. 12" for a name with an ending.
    whole = chosen.with_name(chosen.name + ending)
    asks = QCoreApplication.translate("Questions", "{0} is there already. Replace it?").format(whole.name)
    return whole if not whole.exists() or agrees(parent, title, asks, warns=True) else None


def ask_text(parent: QWidget, title: str, label: str, text: str) -> str | None:
    """A line of text; None where the user thought better of it."""
    typed, is_given = QInputDialog.getText(parent, title, label, text=text)
    return typed if is_given else None


class Questions(QObject):
    """Questions of more than one place; a class, so that whoever drives the window without a user can answer them."""

    def save_first(self, parent: QWidget) -> Answer:
        """Whether to save before something else happens."""
        said = _asked(
            QMessageBox.question,
            parent,
            self.tr("Unsaved changes"),
            self.tr("This project has changes that are not saved. Save them first?"),
            _Button.Save | _Button.Discard | _Button.Cancel,
            _Button.Save,
        )
        return {_Button.Save: Answer.YES, _Button.Discard: Answer.NO}.get(said, Answer.CANCEL)

    def recover(self, parent: QWidget, when: str, changes: tuple[str, ...], is_of_saved_state: bool) -> Answer:
        """Whether unsaved work from before a crash is wanted."""
        listed = "\n".join(f"- {change}" for change in changes)
        text = self.tr("Reflight ended before this work was saved (copy of {0}):\n{1}\n\nTake it over?").format(
            when, listed
        )
        if not is_of_saved_state:
            text += "\n" + self.tr("The project was saved by others since then: their changes would be taken back.")
        buttons = _Button.Yes | _Button.Discard | _Button.Cancel
        said = _asked(QMessageBox.question, parent, self.tr("Unsaved work"), text, buttons, _Button.Yes)
        return {_Button.Yes: Answer.YES, _Button.Discard: Answer.NO}.get(said, Answer.CANCEL)

    def folder(self, parent: QWidget, title: str) -> Path | None:
        """A folder that exists."""
        name = QFileDialog.getExistingDirectory(parent, title)
        return Path(name) if name else None

    def new_folder(self, parent: QWidget, title: str) -> Path | None:
        """A folder to be made."""
        name, _ = QFileDialog.getSaveFileName(parent, title, "", options=QFileDialog.Option.ShowDirsOnly)
        return Path(name) if name else None

    def file(self, parent: QWidget, title: str, kinds: str) -> Path | None:
        """A file that exists."""
        return choose_file(parent, title, kinds)


def _asked(
    ask: Callable[..., object], parent: QWidget, title: str, text: str, buttons: _Button, usual: _Button
) -> _Button:
    """The button that was pressed, always as one of the enum: some ways of calling give its number."""
    said = ask(parent, title, text, buttons, usual)
    assert isinstance(said, int)
    return _Button(said)
