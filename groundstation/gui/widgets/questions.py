"""Dialogs with which the window asks: yes or no, files and folders, and whether to save before something is lost.

All of them are asked here. `QMessageBox` answers with a number or an enum, depending on how it is called, and file
dialogs with a text that is empty where none was chosen: whoever asks gets a bool, an `Answer` or a path.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Collection, Mapping
from enum import Enum, auto
from pathlib import Path

from PySide6.QtCore import QCoreApplication, QObject
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QHeaderView,
    QInputDialog,
    QLineEdit,
    QMessageBox,
    QTreeView,
    QWidget,
)

from planning.base.files import FILE_ENDING

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
    icon = QMessageBox.Icon.Warning if warns else QMessageBox.Icon.Question
    usual = _Button.Yes if is_usual else _Button.Cancel
    return _answer(icon, parent, title, text, _Button.Yes | _Button.Cancel, usual) == _Button.Yes


def choose_file(parent: QWidget, title: str, kinds: str) -> Path | None:
    """A file that exists; `kinds` as Qt has them, "Sites (*.json)"."""
    found = _PathDialog(parent, title, _PathKind.FILE, kinds=kinds).ask()
    return found[0] if found else None


def choose_files(parent: QWidget, title: str, kinds: str, folder: Path) -> tuple[Path, ...]:
    """Files that exist, first looked for in a folder; none where the user thought better of it."""
    return _PathDialog(parent, title, _PathKind.FILES, folder, kinds=kinds).ask()


def choose_new_file(
    parent: QWidget, title: str, proposed: Path, kinds: str, ending: str, others: Collection[str] = ()
) -> Path | None:
    """Where a file is to be written; for one that is there already, the user was asked.

    A name gets the `ending` (".city.json") where it has none, or one that says something else is in the file and is
    none of `others`, before it is looked whether such a file is there.
    """

    def whole(path: Path) -> Path:
        found = path.suffix.lower()
        fits = path.name.lower().endswith(ending) or found in others or not FILE_ENDING.fullmatch(found)
        # "No. 12" has no ending.
        return path if fits and _ENDING.fullmatch(found) else path.with_name(path.name + ending)

    folder = proposed.parent if proposed.is_absolute() else None
    chosen = _PathDialog(parent, title, _PathKind.NEW_FILE, folder, proposed.name, kinds, whole).ask()
    return chosen[0] if chosen else None


def ask_text(parent: QWidget, title: str, label: str, text: str) -> str | None:
    """A line of text; None where the user thought better of it."""
    typed, is_given = QInputDialog.getText(parent, title, label, text=text)
    return typed if is_given else None


class Questions(QObject):
    """Questions of more than one place; a class, so that whoever drives the window without a user can answer them."""

    def save_first(self, parent: QWidget) -> Answer:
        """Whether to save before something else happens."""
        answer = _answer(
            QMessageBox.Icon.Question,
            parent,
            self.tr("Unsaved changes"),
            self.tr("This project has changes that are not saved. Save them first?"),
            _Button.Save | _Button.Discard | _Button.Cancel,
            _Button.Save,
        )
        return {_Button.Save: Answer.YES, _Button.Discard: Answer.NO}.get(answer, Answer.CANCEL)

    def recover(self, parent: QWidget, when: str, changes: tuple[str, ...], is_of_saved_state: bool) -> Answer:
        """Whether unsaved work from before a crash is wanted; without `changes` it was never saved at all."""
        if changes:
            text = self.tr(
                "Nothing is lost: Reflight ended before this work was saved, and kept a copy of it at {0}. In the "
                "copy, and not in what was saved:\n{1}\n\nGo on with it? What was saved stays as it is until you save "
                "again."
            ).format(when, "\n".join(f"- {change}" for change in changes))
        else:
            text = self.tr(
                "Nothing is lost: Reflight ended before this work was saved, and kept a copy of it at {0}. All of it "
                "is in the copy: it was never saved as a project.\n\nGo on with it?"
            ).format(when)
        if changes and not is_of_saved_state:
            text += "\n\n" + self.tr(
                "The project was saved by others since then: what they changed is not in the copy."
            )
        answer = _answer(
            QMessageBox.Icon.Question,
            parent,
            self.tr("Restore?"),
            text,
            _Button.Yes | _Button.Discard | _Button.Cancel,
            _Button.Yes,
            {
                _Button.Yes: self.tr("Restore"),
                _Button.Discard: self.tr("Delete the copy"),
                _Button.Cancel: self.tr("Decide later"),
            },
        )
        return {_Button.Yes: Answer.YES, _Button.Discard: Answer.NO}.get(answer, Answer.CANCEL)

    def go_on(self, parent: QWidget, title: str, text: str, anew: str) -> Answer:
        """Whether work that was begun goes on, or is done anew, as the button `anew` says."""
        answer = _answer(
            QMessageBox.Icon.Question,
            parent,
            title,
            text,
            _Button.Yes | _Button.No | _Button.Cancel,
            _Button.Yes,
            {_Button.Yes: self.tr("Go on"), _Button.No: anew},
        )
        return {_Button.Yes: Answer.YES, _Button.No: Answer.NO}.get(answer, Answer.CANCEL)

    def folder(self, parent: QWidget, title: str, *places: Path | None) -> Path | None:
        """A folder that exists; the dialog begins at the first of the `places` that is there."""
        begin = next((place for place in places if place is not None and place.is_dir()), None)
        found = _PathDialog(parent, title, _PathKind.FOLDER, begin).ask()
        return found[0] if found else None

    def new_folder(self, parent: QWidget, title: str, proposed: Path) -> Path | None:
        """A folder to be made; the `proposed` one stands in the dialog, under a name that is free."""
        free = free_name(proposed)
        dialog = _PathDialog(parent, title, _PathKind.NEW_FOLDER, free.parent, free.name)
        dialog.setLabelText(QFileDialog.DialogLabel.FileName, self.tr("New folder:"))
        found = dialog.ask()
        return found[0] if found else None

    def file(self, parent: QWidget, title: str, kinds: str) -> Path | None:
        """A file that exists."""
        return choose_file(parent, title, kinds)


class _PathKind(Enum):
    """What a path is asked for."""

    FILE = auto()
    FILES = auto()
    NEW_FILE = auto()
    FOLDER = auto()
    NEW_FOLDER = auto()


NEW = (_PathKind.NEW_FILE, _PathKind.NEW_FOLDER)

MODES = {
    _PathKind.FILE: QFileDialog.FileMode.ExistingFile,
    _PathKind.FILES: QFileDialog.FileMode.ExistingFiles,
    _PathKind.FOLDER: QFileDialog.FileMode.Directory,
}


class _PathDialog(QFileDialog):
    """Asks for paths, and takes what stands in the line.

    Qt's own dialog takes what happens to be selected in its list, such as a folder on the way to a path that is typed,
    and goes into a folder that exists without a name for what is new. Dialogs of the desktop do it their own way.

    Parameters
    ----------
    name
        Of what is new, as it is proposed.
    whole
        The path that is meant by one that was typed: with an ending.
    """

    def __init__(
        self,
        parent: QWidget,
        title: str,
        wanted: _PathKind,
        folder: Path | None = None,
        name: str = "",
        kinds: str = "",
        whole: Callable[[Path], Path] = lambda path: path,
    ) -> None:
        super().__init__(parent, title, "" if folder is None else str(folder), kinds)
        self._wanted, self._name, self._whole = wanted, name, whole
        self._typed: tuple[Path, ...] = ()
        self.setFileMode(MODES.get(wanted, QFileDialog.FileMode.AnyFile))
        self.setOption(QFileDialog.Option.ShowDirsOnly, wanted in (_PathKind.FOLDER, _PathKind.NEW_FOLDER))
        if wanted in NEW:
            self.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
            # It is asked here, for the name with its ending.
            self.setOption(QFileDialog.Option.DontConfirmOverwrite)
            self.selectFile(name)
        table = self.findChild(QTreeView)
        if table is not None:  # Qt's widths are those of small letters
            table.header().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        line = self.findChild(QLineEdit, "fileNameEdit")
        if line is not None:
            line.textChanged.connect(self._may_be_taken)

    def ask(self) -> tuple[Path, ...]:
        """The paths; none where the user thought better of it."""
        is_chosen = self.exec() == QDialog.DialogCode.Accepted
        chosen = self._typed
        if is_chosen and not chosen:
            chosen = tuple(self._whole(Path(name)) for name in self.selectedFiles())
            chosen = chosen if self._may_replace(chosen[0]) else ()
        self.deleteLater()
        return chosen if is_chosen else ()

    def accept(self) -> None:
        """Take what stands in the line; a folder is gone into where a file, or something new, is wanted."""
        line = self.findChild(QLineEdit, "fileNameEdit")
        if line is None:
            super().accept()
            return
        text = line.text().strip()
        names = re.findall(r'"([^"]*)"', text) if '"' in text else [text]
        paths = tuple(Path(self.directory().absolutePath(), Path(name).expanduser()) for name in names)
        if self._wanted is not _PathKind.FOLDER and len(paths) == 1 and paths[0].is_dir():
            self.setDirectory(str(paths[0]))
            self.selectFile(self._name)
            return
        paths = tuple(map(self._whole, paths))
        if self._is_wanted(paths) and self._may_replace(paths[0]):
            self._typed = paths
            self.done(QDialog.DialogCode.Accepted)

    def _may_be_taken(self, text: str) -> None:
        """Qt 6.11 lets nothing be taken any more once the line was empty, whatever is typed then."""
        buttons = self.findChild(QDialogButtonBox)
        if buttons is None:
            return
        for button in buttons.buttons():
            if buttons.buttonRole(button) == QDialogButtonBox.ButtonRole.AcceptRole:
                button.setEnabled(bool(text.strip()))

    def _is_wanted(self, paths: tuple[Path, ...]) -> bool:
        match self._wanted:
            case _PathKind.NEW_FOLDER:
                return not paths[0].exists()
            case _PathKind.NEW_FILE:
                return True
            case _PathKind.FOLDER:
                there = paths[0].is_dir()
            case _:
                there = all(path.is_file() for path in paths)
        if not there:
            text = QCoreApplication.translate("Questions", "{0}: there is nothing of that name.")
            missing = next(path for path in paths if not path.exists() or self._wanted is _PathKind.FOLDER)
            _answer(QMessageBox.Icon.Warning, self, self.windowTitle(), text.format(missing), _Button.Ok, _Button.Ok)
        return there

    def _may_replace(self, path: Path) -> bool:
        if self._wanted is not _PathKind.NEW_FILE or not path.exists():
            return True
        text = QCoreApplication.translate("Questions", "{0} is there already. Replace it?").format(path.name)
        return agrees(self, self.windowTitle(), text, warns=True)


def file_name(text: str) -> str:
    """A name of something as one that every system takes for a file."""
    return re.sub(r'[\\/:*?"<>|\x00-\x1f]+', "-", text).strip(". ")[:80] or "-"


def free_name(path: Path) -> Path:
    """A path at which nothing is yet: the one given, or with a number behind its name."""
    numbers = itertools.count(2)
    free = path
    while free.exists():
        free = path.with_name(f"{path.name} {next(numbers)}")
    return free


def _answer(
    icon: QMessageBox.Icon,
    parent: QWidget,
    title: str,
    text: str,
    buttons: _Button,
    usual: _Button,
    labels: Mapping[_Button, str] | None = None,
) -> _Button:
    """The button that was pressed, always as one of the enum: Qt gives its number."""
    box = QMessageBox(icon, title, text, buttons, parent)
    box.setDefaultButton(usual)
    for kind, label in (labels or {}).items():
        box.button(kind).setText(label)
    answer = _Button(box.exec())
    box.deleteLater()
    return answer
