"""Copies of unsaved work; after a crash: finding the one that was left, and taking it over."""

from __future__ import annotations

import contextlib
import os
import platform
import shutil
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

from groundstation.services.project.document import Document, PlanEntry
from groundstation.services.project.folder import OpenedProject, open_project, save_project
from groundstation.services.project.lock import ProjectInUse, ProjectLock, lock_holder, lock_project
from groundstation.services.project.project_file import is_project, json_bytes, project_name, read_index
from groundstation.services.project.site import same_site
from groundstation.services.project.store import system_errors_as_input_errors
from groundstation.services.settings import data_folder
from planning.base.errors import GroundStationError, InputError
from planning.base.json_file import plain_values, read_json, to_record, write_atomically
from planning.base.messages import say

# Copies of unsaved work, for after a crash.
#
# A copy is a project of its own in the folder `.autosave` of the project it belongs to; work that has no project yet
# has a place in the user's data folder. A save or an orderly close removes it.

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


def lock_unsaved_folder() -> ProjectLock:
    """A folder in the user's data folder for work that has no project yet, locked as long as its window is open.

    Raises
    ------
    InputError
        It cannot be made.
    """
    folder = data_folder() / UNSAVED_FOLDER / f"{utc_now():%Y%m%d-%H%M%S-%f}-{os.getpid()}"
    with system_errors_as_input_errors(folder):
        folder.mkdir(parents=True)
    return lock_project(folder)


def remove_unsaved_folder(place: ProjectLock) -> None:
    """Remove what `lock_unsaved_folder` made, after a save as a project or an orderly close."""
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
        Of the project, or the folder of an `lock_unsaved_folder`.
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
                had_failed, self._has_failed, self._last = self._has_failed, True, None
            if not had_failed:
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
        with system_errors_as_input_errors(self._place):
            self._place.mkdir(exist_ok=True)
        save_project(self._place, document, name=name, site_source=source)
        header = AutosaveHeader(based_on, self._clock().isoformat(timespec="seconds"), os.getpid(), platform.node())
        write_atomically(self._place / HEADER_FILE, json_bytes(plain_values(header), HEADER_FILE))


REMAINS_S = 3600.0
"""A place that was made so long ago is in use, or never will be."""

DAMAGED_FOLDER = ".autosave-damaged"


@dataclass(frozen=True, slots=True, eq=False)
class Recovery:
    """A copy of work that was not saved when Reflight ended.

    Parameters
    ----------
    folder
        Of the project, or the place of work that never had one.
    saved_at
        When the copy was written; None where that cannot be read.
    changes
        What is different from the project as it is saved, for the user.
    is_of_saved_state
        Whether the project has stayed as it was when the work began; recovering takes other changes back where not.
    copy
        The copy as it was read; None where it is damaged.
    problem
        What is wrong with a damaged copy; empty for one that is whole.
    """

    folder: Path
    saved_at: datetime | None
    changes: tuple[str, ...]
    is_of_saved_state: bool
    copy: OpenedProject | None
    problem: str = ""

    @property
    def was_saved(self) -> bool:
        """Whether there is a project that the work was to be saved in."""
        return is_project(self.folder)


def find_recovery(folder: Path) -> Recovery | None:
    """The copy of unsaved work in a project's folder, damaged or not; never raises for one that is damaged.

    None where there is none, where it differs in nothing from the project, and where another Reflight that is running
    has the project open: the copy is its own then.
    """
    place = folder / AUTOSAVE_FOLDER
    if not (place / HEADER_FILE).exists():
        return None
    holder = lock_holder(folder)
    if holder is not None and not holder.is_this_process:
        return None
    try:
        header, copy = _read(place)
    except InputError:
        return _looked_at_again(folder)
    return _recovery(folder, header, copy)


def _read(place: Path) -> tuple[AutosaveHeader, OpenedProject]:
    header = to_record(read_json(place / HEADER_FILE, names_files=True), AutosaveHeader, place / HEADER_FILE)
    return header, open_project(place)


def _looked_at_again(folder: Path) -> Recovery | None:
    """What to say of a copy that could not be read: another Reflight may just have been writing or clearing it."""
    place = folder / AUTOSAVE_FOLDER
    try:
        with _held(folder):
            if not (place / HEADER_FILE).exists():
                return None
            header, copy = _read(place)
    except ProjectInUse:
        return None
    except InputError as error:
        problem = say("{}; this copy of unsaved work is damaged and cannot be taken over", error)
        return Recovery(folder, None, (), False, None, problem)
    return _recovery(folder, header, copy)


@contextlib.contextmanager
def _held(folder: Path) -> Iterator[None]:
    """Nobody else writes here meanwhile; where nothing can be written at all, nobody does.

    Raises
    ------
    ProjectInUse
        Another Reflight has it open.
    """
    lock = None
    try:
        lock = lock_project(folder)
    except ProjectInUse as error:
        if not error.holder.is_this_process:
            raise
    except InputError:
        pass
    try:
        yield
    finally:
        if lock is not None:
            lock.release()


def _recovery(folder: Path, header: AutosaveHeader, copy: OpenedProject) -> Recovery | None:
    changes = _changes(folder, copy)
    if not changes:
        return None
    saved_at = datetime.fromisoformat(header.saved_at)
    return Recovery(folder, saved_at, changes, header.based_on == _saved_state(folder), copy)


def find_unsaved() -> tuple[Recovery, ...]:
    """Copies of work that never had a project, from the user's data folder, oldest first."""
    places = [place for place in sorted((data_folder() / UNSAVED_FOLDER).glob("*")) if place.is_dir()]
    for place in places:
        _clear_remains(place)
    found = [find_recovery(place) for place in places]
    return tuple(recovery for recovery in found if recovery is not None)


def recover(recovery: Recovery) -> OpenedProject:
    """The unsaved work, to be opened as changes of its project that are not saved yet. The copy stays where it is.

    Raises
    ------
    InputError
        The copy is damaged.
    """
    if recovery.copy is None:
        raise InputError(recovery.problem)
    return replace(recovery.copy, folder=recovery.folder)


def discard_recovery(recovery: Recovery) -> None:
    """Clear a copy away that is not wanted; a damaged one is kept aside as `.autosave-damaged`, in place of the last.

    Raises
    ------
    InputError
        The folder cannot be written.
    """
    place = recovery.folder / AUTOSAVE_FOLDER
    with _held(recovery.folder), system_errors_as_input_errors(place):
        if recovery.problem:
            shutil.rmtree(recovery.folder / DAMAGED_FOLDER, ignore_errors=True)
            place.replace(recovery.folder / DAMAGED_FOLDER)
        elif recovery.folder.parent == data_folder() / UNSAVED_FOLDER:
            (place / HEADER_FILE).unlink(missing_ok=True)
            shutil.rmtree(recovery.folder)
        else:
            (place / HEADER_FILE).unlink(missing_ok=True)
            shutil.rmtree(place)


def _clear_remains(place: Path) -> None:
    """Remove what is left of a place without a copy, of a Reflight that ended while it made or cleared it."""
    with contextlib.suppress(OSError, InputError):
        is_old = time.time() - place.stat().st_mtime > REMAINS_S
        if is_old and not (place / AUTOSAVE_FOLDER / HEADER_FILE).exists() and not (place / DAMAGED_FOLDER).exists():
            with lock_project(place):
                shutil.rmtree(place)


def _saved_state(folder: Path) -> str:
    try:
        return read_index(folder).sha256
    except InputError:
        return ""


def _changes(folder: Path, copy: OpenedProject) -> tuple[str, ...]:
    try:
        saved = open_project(folder).document
    except InputError as error:
        if copy.document.site is None and not copy.document.plans:
            return ()
        if not is_project(folder):
            return (say("all of it: it was never saved as a project"),)
        return (say("all of it: the project that was saved cannot be opened ({})", error),)
    left_out = {note.place for note in copy.notes if note.code == "plan-left-out"}
    return tuple(_differences(saved, copy.document, left_out))


def _differences(before: Document, after: Document, left_out: set[str]) -> list[str]:
    found: list[str] = [] if same_site(before.site, after.site) else [say("the site")]
    for entry in after.plans:
        known = before.entry(entry.id)
        if known is None:
            found.append(say("plan '{}' is new", entry.title))
        elif not _same_entry(known, entry):
            found.append(say("plan '{}' was changed", entry.title))
    for entry in before.plans:
        if after.entry(entry.id) is None and entry.id not in left_out:
            found.append(say("plan '{}' was removed", entry.title))
    return found if before.request == after.request else [*found, say("what is asked of the next plan")]


def _same_entry(one: PlanEntry, other: PlanEntry) -> bool:
    return (one.title, one.plan, one.request, one.bound_for_views) == (
        other.title,
        other.plan,
        other.request,
        other.bound_for_views,
    )
