"""What is being worked on: the document with its history, the folder it is kept in, and whether it is saved.

Used from one thread, the window's. Long work runs as jobs beside it, on a document as it was when they began; what they
return is put into the document as it is when they end.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from groundstation.services.project.document import Document, has_content_of
from groundstation.services.project.folder import OpenedProject, open_project
from groundstation.services.project.lock import ProjectLock, lock_project
from groundstation.services.project.recovery import Autosave, lock_unsaved_folder, remove_unsaved_folder
from planning.base.errors import GroundStationError

# Undo and redo over frozen values: a list of labelled states and the place in it.

Value = TypeVar("Value")

MAX_STEPS = 200
"""Steps that can be undone; a document shares what it did not change, so a step costs kilobytes."""


@dataclass(frozen=True, slots=True, eq=False)
class _Step(Generic[Value]):
    label: str
    value: Value


class History(Generic[Value]):
    """States of one value, from the oldest that can be reached by undo to the newest that can be reached by redo."""

    def __init__(self, value: Value) -> None:
        self._steps: list[_Step[Value]] = [_Step("", value)]
        self._at = 0

    @property
    def value(self) -> Value:
        """The present state."""
        return self._steps[self._at].value

    @property
    def undo_label(self) -> str:
        """What `undo` would take back; empty where there is nothing."""
        return self._steps[self._at].label if self._at > 0 else ""

    @property
    def redo_label(self) -> str:
        """What `redo` would do again; empty where there is nothing."""
        return self._steps[self._at + 1].label if self._at + 1 < len(self._steps) else ""

    def change(self, label: str, value: Value) -> None:
        """Go on to a new state; what could have been done again is forgotten."""
        if not label:
            raise ValueError("label: expected what the user did, got an empty text")
        del self._steps[self._at + 1 :]
        self._steps.append(_Step(label, value))
        del self._steps[: max(0, len(self._steps) - 1 - MAX_STEPS)]
        self._at = len(self._steps) - 1

    def amend(self, value: Value) -> None:
        """Replace the present state without a step of its own."""
        self._steps[self._at] = _Step(self._steps[self._at].label, value)

    def undo(self) -> Value:
        """Go back one state; stays where there is none before it."""
        self._at = max(0, self._at - 1)
        return self.value

    def redo(self) -> Value:
        """Go forward one state; stays where there is none after it."""
        self._at = min(len(self._steps) - 1, self._at + 1)
        return self.value


DocumentListener = Callable[[Document, Document], None]
"""Called with the document as it was and as it is."""


class Session:
    """One open project, or an unnamed one (`folder` None) that was never saved."""

    def __init__(self, document: Document | None = None, folder: Path | None = None) -> None:
        self._history = History(Document() if document is None else document)
        self._saved = self._history.value
        self._folder = folder
        self._listeners: tuple[DocumentListener, ...] = ()

    @property
    def document(self) -> Document:
        """As it is now."""
        return self._history.value

    @property
    def folder(self) -> Path | None:
        """Where the project is kept."""
        return self._folder

    @property
    def is_saved(self) -> bool:
        """Whether the folder holds the document as it is."""
        return self._saved is self.document

    @property
    def undo_label(self) -> str:
        """What `undo` would take back; empty where there is nothing."""
        return self._history.undo_label

    @property
    def redo_label(self) -> str:
        """What `redo` would do again; empty where there is nothing."""
        return self._history.redo_label

    def subscribe(self, listener: DocumentListener) -> None:
        """Call `listener` after every change from now on."""
        self._listeners += (listener,)

    def open(self, document: Document, folder: Path | None, *, saved: bool = True) -> None:
        """Go on with another document; the history of the old one is forgotten. `saved`: the folder holds it."""
        before, self._folder = self.document, folder
        self._history = History(document)
        self._saved = document if saved else Document()
        self._publish(before)

    def change(self, label: str, document: Document) -> None:
        """Take an edit over as one step that can be undone; `label` says what the user did."""
        before = self.document
        self._history.change(label, document)
        self._publish(before)

    def amend(self, document: Document) -> None:
        """Take over what is no step of its own: the plan that is looked at, the wishes in a form."""
        before, was_saved = self.document, self.is_saved
        self._history.amend(document)
        if was_saved and has_content_of(document.site, before.site) and document.plans == before.plans:
            self._saved = document
        self._publish(before)

    def undo(self) -> None:
        """Take the last step back."""
        before = self.document
        self._history.undo()
        self._publish(before)

    def redo(self) -> None:
        """Do again what was taken back."""
        before = self.document
        self._history.redo()
        self._publish(before)

    def saved(self, requested: Document, written: Document, folder: Path) -> None:
        """Note that `requested` was saved in `folder`, where it is `written`, with the checksum of its site file.

        Does nothing to a document that has been changed since but for noting the folder.
        """
        self._folder = folder
        if self.document is requested:
            before = self.document
            self._history.amend(written)
            self._saved = written
            self._publish(before)

    def _publish(self, before: Document) -> None:
        if before is not self.document:
            for listener in self._listeners:
                listener(before, self.document)


# What a window holds besides the document: the lock on its project, and the copy of work that is not saved.


@dataclass(frozen=True, slots=True, eq=False)
class LockedProject:
    """A project that was read, and the lock on it, or why there is none."""

    project: OpenedProject
    lock: ProjectLock | None
    problem: str


class ProjectSession:
    """Keeps one project for one window.

    Parameters
    ----------
    report
        Called with a message for the user when a copy cannot be written, on another thread.
    """

    def __init__(self, report: Callable[[str], None]) -> None:
        self._report = report
        self._writer = ThreadPoolExecutor(1, thread_name_prefix="autosave")
        self._lock: ProjectLock | None = None
        self._place: ProjectLock | None = None
        self._autosave: Autosave | None = None

    @property
    def may_save(self) -> bool:
        """Whether the project is locked for this window, so that it may be written."""
        return self._lock is not None

    def opening_job(self, folder: Path) -> Callable[[], LockedProject]:
        """Work for a job: lock a project and read it. Without the lock it can still be looked at.

        Raises
        ------
        InputError
            The project cannot be read (when the work is done).
        """
        held = self._lock if self._lock is not None and self._lock.folder.samefile(folder) else None
        return lambda: _take(folder, held)

    def switch_to(self, lock: ProjectLock | None) -> None:
        """Go on with another project, locked or not, or with none."""
        if lock is None or lock is not self._lock:
            self.release()
            self._lock = lock
            if lock is not None:
                self._autosave = self._copies(lock.folder)

    def switch_to_saved(self, folder: Path) -> None:
        """Go on with a project that was just written.

        Raises
        ------
        InputError
            It cannot be locked.
        """
        self.release()
        self.switch_to(lock_project(folder))

    def switch_to_recovered(self, folder: Path) -> None:
        """Go on with work that never had a project, whose copy is in this folder; it stays there.

        Raises
        ------
        InputError
            Another window has it.
        """
        self.release()
        self._place = lock_project(folder)
        self._autosave = self._copies(folder)

    def copy(self, session: Session) -> None:
        """Have a copy written of what is not saved.

        A project that is not locked for this window gets none: the user was told when it was opened.

        Raises
        ------
        InputError
            There is no place for work without a project.
        """
        if session.is_saved:
            return
        if self._autosave is None:
            if session.folder is not None:
                return
            self._place = lock_unsaved_folder()
            self._autosave = self._copies(self._place.folder)
        self._autosave.keep(session.document)

    def drop_copy(self) -> None:
        """The work is saved, or not wanted: its copy goes."""
        if self._autosave is not None:
            self._autosave.discard()

    def release(self) -> None:
        """Let go of the project, and of the copy of work on it."""
        self.drop_copy()
        self._autosave = None
        if self._place is not None:
            remove_unsaved_folder(self._place)
        if self._lock is not None:
            self._lock.release()
        self._place = self._lock = None

    def close(self) -> None:
        """Release, and end the thread that writes."""
        self.release()
        self._writer.shutdown(wait=True)

    def place(self) -> Path | None:
        """Where work without a project is copied to; None before there is any."""
        return None if self._place is None else self._place.folder

    def _copies(self, folder: Path) -> Autosave:
        return Autosave(folder, self._writer, self._report)


def _take(folder: Path, held: ProjectLock | None) -> LockedProject:
    lock, problem = held, ""
    if lock is None:
        try:
            lock = lock_project(folder)
        except GroundStationError as error:
            problem = str(error)
    try:
        return LockedProject(open_project(folder), lock, problem)
    except BaseException:
        if lock is not None and lock is not held:
            lock.release()
        raise
