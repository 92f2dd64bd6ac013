"""What a window holds besides the document: the lock on its project, and the copy of work that is not saved."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from groundstation.services.project.autosave import Autosave, give_up_place, unsaved_place
from groundstation.services.project.folder import OpenedProject, open_project
from groundstation.services.project.lock import ProjectLock, lock_project
from groundstation.services.project.session import Session
from planning.base.errors import GroundStationError


@dataclass(frozen=True, slots=True, eq=False)
class TakenProject:
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

    def taking(self, folder: Path) -> Callable[[], TakenProject]:
        """Work for a job: lock a project and read it. Without the lock it can still be looked at.

        Raises
        ------
        InputError
            The project cannot be read (when the work is done).
        """
        held = self._lock if self._lock is not None and self._lock.folder.samefile(folder) else None
        return lambda: _take(folder, held)

    def hold(self, lock: ProjectLock | None) -> None:
        """Go on with another project, locked or not, or with none."""
        if lock is None or lock is not self._lock:
            self.release()
            self._lock = lock
            if lock is not None:
                self._autosave = self._copies(lock.folder)

    def take_saved(self, folder: Path) -> None:
        """Go on with a project that was just written.

        Raises
        ------
        InputError
            It cannot be locked.
        """
        self.release()
        self.hold(lock_project(folder))

    def adopt(self, folder: Path) -> None:
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
            self._place = unsaved_place()
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
            give_up_place(self._place)
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


def _take(folder: Path, held: ProjectLock | None) -> TakenProject:
    lock, problem = held, ""
    if lock is None:
        try:
            lock = lock_project(folder)
        except GroundStationError as error:
            problem = str(error)
    try:
        return TakenProject(open_project(folder), lock, problem)
    except BaseException:
        if lock is not None and lock is not held:
            lock.release()
        raise
