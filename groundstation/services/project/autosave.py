"""Copies of unsaved work, for after a crash; `groundstation.services.project.recovery` finds them again.

A copy is a project of its own in the folder `.autosave` of the project it belongs to; work that has no project yet has
a place in the user's data folder. A save or an orderly close removes it.
"""

from __future__ import annotations

import contextlib
import os
import platform
import shutil
import threading
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from groundstation.services.project.document import Document
from groundstation.services.project.folder import save_project
from groundstation.services.project.lock import ProjectLock, lock_project
from groundstation.services.project.project_file import is_project, json_bytes, project_name, read_index
from groundstation.services.project.store import in_words
from groundstation.services.settings import data_folder
from planning.base.errors import GroundStationError
from planning.base.json_file import plain_values, write_atomically
from planning.base.messages import say

AUTOSAVE_FOLDER, HEADER_FILE = ".autosave", "autosave.json"

UNSAVED_FOLDER = "unsaved"

AUTOSAVE_FORMAT = "reflight-autosave/1"


@dataclass(frozen=True, slots=True)
class AutosaveHeader:
    """What is known of a copy besides the work itself.

    Parameters
    ----------
    based_on
        SHA-256 of the project.json that the work began from; empty where there is none.
    saved_at
        ISO 8601, UTC.
    process, computer
        Of the Reflight that wrote it.
    """

    based_on: str
    saved_at: str
    process: int
    computer: str
    format: str = AUTOSAVE_FORMAT

    def __post_init__(self) -> None:
        if self.format != AUTOSAVE_FORMAT:
            raise ValueError(f"format: expected '{AUTOSAVE_FORMAT}', got '{self.format}'")
        datetime.fromisoformat(self.saved_at)


def utc_now() -> datetime:
    """The time."""
    return datetime.now(UTC)


def unsaved_place() -> ProjectLock:
    """A folder in the user's data folder for work that has no project yet, locked as long as its window is open.

    Raises
    ------
    InputError
        It cannot be made.
    """
    folder = data_folder() / UNSAVED_FOLDER / f"{utc_now():%Y%m%d-%H%M%S-%f}-{os.getpid()}"
    with in_words(folder):
        folder.mkdir(parents=True)
    return lock_project(folder)


def give_up_place(place: ProjectLock) -> None:
    """Remove what `unsaved_place` made, after a save as a project or an orderly close."""
    clear_copy(place.folder / AUTOSAVE_FOLDER)
    place.release()
    shutil.rmtree(place.folder, ignore_errors=True)


def clear_copy(place: Path) -> None:
    """Remove a copy; what is left of one when the program ends meanwhile counts as none."""
    with contextlib.suppress(OSError):
        (place / HEADER_FILE).unlink(missing_ok=True)
    shutil.rmtree(place, ignore_errors=True)


class Autosave:
    """Keeps a copy of the work on one project.

    The copy is written by an executor of the caller's, one thread is enough: a copy of a large site takes tenths of a
    second, too long for the window's thread, and the queue of jobs would let it wait for a plan to be finished. A
    document is frozen, so it may be written while the user goes on.

    Parameters
    ----------
    folder
        Of the project, or the folder of an `unsaved_place`.
    report
        Called with a message for the user when a copy cannot be written, on the executor's thread; not again until a
        copy could be written in between. The work itself is not touched by that.
    """

    def __init__(
        self,
        folder: Path,
        executor: Executor,
        report: Callable[[str], None],
        clock: Callable[[], datetime] = utc_now,
    ) -> None:
        self._folder, self._place = folder, folder / AUTOSAVE_FOLDER
        self._executor, self._report, self._clock = executor, report, clock
        self._state, self._disk = threading.Lock(), threading.Lock()
        self._wanted: Document | None = None
        self._last: Document | None = None
        self._is_writing = self._has_failed = False

    def keep(self, document: Document) -> None:
        """Have a copy written soon; of several that wait only the last is."""
        with self._state:
            if document is self._last:
                return
            self._last = self._wanted = document
            if self._is_writing:
                return
            self._is_writing = True
        self._executor.submit(self._write_all)

    def discard(self) -> None:
        """Remove the copy: the work is saved, or the user does not want it. Waits for one that is being written."""
        with self._state:
            self._wanted = self._last = None
        with self._disk:
            clear_copy(self._place)

    def _write_all(self) -> None:
        while True:
            with self._disk:
                with self._state:
                    document, self._wanted = self._wanted, None
                    if document is None:
                        self._is_writing = False
                        return
                self._write(document)

    def _write(self, document: Document) -> None:
        try:
            self._write_copy(document)
        except Exception as error:  # nobody stands above a thread of an executor, so everything is told here
            with self._state:
                told, self._has_failed, self._last = self._has_failed, True, None
            if not told:
                cause = str(error) if isinstance(error, (GroundStationError, OSError)) else repr(error)
                self._report(
                    say(
                        "unsaved work could not be copied for after a crash: {}. Nothing is lost while this window is "
                        "open; make room or save the project in another folder",
                        cause,
                    )
                )
        else:
            self._has_failed = False

    def _write_copy(self, document: Document) -> None:
        source, based_on, name = None, "", self._folder.name
        if is_project(self._folder):
            index = read_index(self._folder)
            source = self._folder / index.record.site if index.record.site else None
            based_on, name = index.sha256, project_name(self._folder)
        with in_words(self._place):
            self._place.mkdir(exist_ok=True)
        save_project(self._place, document, name=name, site_source=source)
        header = AutosaveHeader(based_on, self._clock().isoformat(timespec="seconds"), os.getpid(), platform.node())
        write_atomically(self._place / HEADER_FILE, json_bytes(plain_values(header), HEADER_FILE))
