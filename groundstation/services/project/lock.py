"""One window at a time for each project folder.

The lock is the operating system's, on the file `.lock` in the folder: it ends with the process that holds it, however
that ends, so no lock is ever left to be cleared away. `.lock.json` beside it says who has it.
"""

from __future__ import annotations

import contextlib
import os
import platform
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING

from groundstation.services.project.project_file import json_bytes
from planning.base.errors import InputError
from planning.base.json_file import plain_values, read_json, to_record, write_atomically
from planning.base.messages import say

if TYPE_CHECKING:
    from filelock import BaseFileLock

LOCK_FILE, HOLDER_FILE = ".lock", ".lock.json"

WAIT_S = 0.3
"""Before a lock counts as taken: whoever only looks who has it holds it for a moment."""


@dataclass(frozen=True, slots=True)
class Holder:
    """A running Reflight: its process, the computer it runs on, and since when it has a project open (ISO 8601)."""

    process: int
    computer: str
    since: str

    @property
    def is_this_process(self) -> bool:
        """Whether it is the program that asks."""
        return (self.process, self.computer) == (os.getpid(), platform.node())


UNKNOWN_HOLDER = Holder(0, "", "")


class ProjectInUse(InputError):  # noqa: N818  (the name says what happened)
    """Another window has the project open."""

    def __init__(self, folder: Path, holder: Holder) -> None:
        who = (
            say("process {} on {} since {}", holder.process, holder.computer, holder.since)
            if holder.process
            else "unknown"
        )
        super().__init__(
            say(
                "this project is open in another Reflight ({}); close it there first, or copy the folder",
                who,
                place=folder,
            )
        )
        self.holder = holder


class ProjectLock:
    """A lock that is held, until `release` or the end of a `with`; see `lock_project`."""

    def __init__(self, folder: Path, lock: BaseFileLock) -> None:
        self.folder = folder
        self._lock = lock

    def release(self) -> None:
        """Let others have the project; once is enough, more does nothing."""
        if self._lock.is_locked:
            with contextlib.suppress(OSError):  # the folder may have gone, or its disk
                (self.folder / HOLDER_FILE).unlink(missing_ok=True)
            self._lock.release()

    def __enter__(self) -> ProjectLock:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.release()


def lock_project(folder: Path) -> ProjectLock:
    """Take a project for this window; one of a process that has died is taken over.

    Raises
    ------
    ProjectInUse
        Another window has it.
    InputError
        The folder is missing or cannot be written, so that it cannot be locked (nor saved to).
    """
    from filelock import Timeout

    if not folder.is_dir():
        raise InputError(say("expected the folder of a project, found nothing of that name", place=folder))
    lock = _file_lock(folder, WAIT_S)
    try:
        lock.acquire()
    except Timeout as error:
        raise ProjectInUse(folder, _read_holder(folder)) from error
    except OSError as error:
        raise InputError(
            say(
                "this project cannot be locked for editing ({}); it can be looked at, and saved as another project",
                error.strerror or error,
                place=folder,
            )
        ) from error
    holder = Holder(os.getpid(), platform.node(), datetime.now(UTC).isoformat(timespec="seconds"))
    with contextlib.suppress(InputError):  # a full disk: the lock is held, others only cannot tell by whom
        # After the power has failed nobody holds it any more: the window's thread need not wait for the disk.
        write_atomically(folder / HOLDER_FILE, json_bytes(plain_values(holder), HOLDER_FILE), is_lasting=False)
    return ProjectLock(folder, lock)


def lock_holder(folder: Path) -> Holder | None:
    """Who has a project open, this process included; None where nobody has."""
    from filelock import Timeout

    if not (folder / LOCK_FILE).exists():
        return None
    lock = _file_lock(folder, 0.0)
    try:
        lock.acquire()
    except Timeout:
        return _read_holder(folder)
    except OSError:
        return None  # who cannot write here cannot edit the project either
    lock.release()
    return None


def _file_lock(folder: Path, wait_s: float) -> BaseFileLock:
    from filelock import FileLock

    return FileLock(folder / LOCK_FILE, timeout=wait_s, thread_local=False)


def _read_holder(folder: Path) -> Holder:
    try:
        return to_record(read_json(folder / HOLDER_FILE, names_files=True), Holder, folder / HOLDER_FILE)
    except InputError:
        return UNKNOWN_HOLDER  # it is just being written, or was never complete
