"""Files of a project folder that are replaced together: all of them as they were, or all of them new.

Changed files are first written beside the old ones (`site.json.saving`), then `project.json` is replaced, which holds
the SHA-256 of each, then the new files take the place of the old. Whoever reads takes `site.json.saving` where its
checksum is the one that `project.json` holds, so a stop at any point leaves the old project or the new one, whole.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from planning.base.errors import InputError
from planning.base.files import read_input_file, sha256_of_file
from planning.base.json_file import JSON_FILE, write_atomically
from planning.base.messages import say

PROJECT_FILE = "project.json"

STAGED_ENDING = ".saving"


def digest(content: bytes) -> str:
    """SHA-256, hexadecimal."""
    return hashlib.sha256(content).hexdigest()


def has_digest(path: Path, sha256: str) -> bool:
    """Whether there is a file with this SHA-256."""
    try:
        return sha256_of_file(path) == sha256
    except InputError:
        return False


def holds(path: Path, content: bytes) -> bool:
    """Whether there is a file with this content."""
    return has_digest(path, digest(content))


def may_replace(path: Path, sha256: str, content: bytes) -> bool:
    """Whether a name can get new content: there is nothing but what the project wrote (`sha256`) or will write."""
    return not path.exists() or has_digest(path, sha256) or holds(path, content)


def current_path(folder: Path, file: str, sha256: str) -> Path:
    """Where the content of `file` with this checksum stands: under its name, or still beside it after a broken save.

    Parameters
    ----------
    file
        As in project.json, relative to the folder.
    sha256
        As in project.json; empty where it says nothing.
    """
    path = folder / file
    staged = _staged(path)
    return staged if sha256 and has_digest(staged, sha256) else path


def current_content(folder: Path, file: str, sha256: str) -> tuple[Path, bytes]:
    """Where the content of `file` stands, as `current_path`, and the content: what was looked at is what is read.

    A save that takes its place meanwhile is no harm: what no longer waits beside `file` is under its name.

    Raises
    ------
    InputError
        It cannot be read.
    """
    path = folder / file
    if sha256:
        with contextlib.suppress(InputError):
            content = read_input_file(_staged(path), JSON_FILE)
            if digest(content) == sha256:
                return _staged(path), content
    return path, read_input_file(path, JSON_FILE)


def finish_interrupted_save(folder: Path, checksums: Mapping[str, str]) -> None:
    """Finish a save that was broken off after `project.json` was replaced.

    Parameters
    ----------
    checksums
        SHA-256 by file, as in project.json.

    Raises
    ------
    InputError
        The folder cannot be written.
    """
    with system_errors_as_input_errors(folder):
        for file, sha256 in checksums.items():
            path = folder / file
            if current_path(folder, file, sha256) != path:
                _staged(path).replace(path)


def replace_together(
    folder: Path, files: Mapping[str, bytes], project: bytes, created: Mapping[str, bytes] | None = None
) -> None:
    """Replace files of a project and `project.json`, all or none.

    Parameters
    ----------
    files
        New content by path relative to the folder; `project` holds their checksums.
    project
        New content of project.json.
    created
        Files under names that nothing uses yet; they are written first.

    Raises
    ------
    InputError
        Something cannot be written; the project is as it was then.
    """
    written: list[Path] = []
    try:
        for file, content in (created or {}).items():
            written.append(folder / file)
            write_atomically(written[-1], content)
        for file, content in files.items():
            written.append(_staged(folder / file))
            write_atomically(written[-1], content)
        with system_errors_as_input_errors(folder):
            _sync(path.parent for path in written)
        write_atomically(folder / PROJECT_FILE, project)
    except BaseException:
        remove(written)
        raise
    # From here on the project is the new one; what cannot be renamed now is read where it is, and renamed at the next
    # save.
    with contextlib.suppress(InputError):
        finish_interrupted_save(folder, {file: digest(content) for file, content in files.items()})


def leftovers(folder: Path, parts: Iterable[str], checksums: Mapping[str, str]) -> list[Path]:
    """Files that broken-off saves have left behind: those that wait for their place in vain, and half-written ones.

    Parameters
    ----------
    parts
        Folders to look in, relative to the project's.
    checksums
        SHA-256 by file, as in project.json.
    """
    needed = {current_path(folder, file, sha256) for file, sha256 in checksums.items()}
    # The third and fourth: as older versions named what they were writing.
    half_done = (f"*{STAGED_ENDING}", ".*.????????.part*", f".*{STAGED_ENDING}.????????", ".*.ply.????????")
    found = [path for part in parts for pattern in half_done for path in (folder / part).glob(pattern)]
    for pattern in (".project.????????.part.json", f".{PROJECT_FILE}.????????"):
        found += folder.glob(pattern)
    return [path for path in found if path not in needed]


def remove(paths: Iterable[Path]) -> None:
    """Remove files that nothing uses any more; one that cannot be removed only takes room, so it stays."""
    for path in paths:
        with contextlib.suppress(OSError):
            path.unlink(missing_ok=True)


@contextlib.contextmanager
def system_errors_as_input_errors(place: Path) -> Iterator[None]:
    """Turn the system's refusal to write into an `InputError` that names file or folder."""
    try:
        yield
    except OSError as error:
        raise InputError(
            say("cannot be written ({})", error.strerror or error, place=error.filename or place)
        ) from error


def _staged(path: Path) -> Path:
    return path.with_name(path.name + STAGED_ENDING)


def _sync(folders: Iterable[Path]) -> None:
    """Let new names outlast a power cut; Windows cannot open folders, and writes names through by itself."""
    if os.name == "nt":
        return
    for folder in set(folders):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
