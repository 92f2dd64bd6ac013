"""Pictures and documents beside the records, each under the SHA-256 of its content: the same file is kept once."""

from __future__ import annotations

import hashlib
import re
import time
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, make_folder, read_input_file, sha256_of_file
from planning.base.json_file import write_atomically
from planning.base.messages import say
from reconstruction.records.book import RecordBook
from reconstruction.records.entries import check_stored_name
from reconstruction.records.limits import SHA256

PICTURE_FILE = FileLimit(say("a picture"), 64 * MIB)
"""The largest JPEG of a drone has 30 MB."""

DOCUMENT_FILE = FileLimit(say("a document"), 256 * MIB)

STARTS = {".png": b"\x89PNG\r\n\x1a\n", ".jpg": b"\xff\xd8\xff", ".webp": b"RIFF"}
"""First bytes of pictures, by the ending they are stored under."""

STRAY_S = 3600.0

_STORED = re.compile(r"[0-9a-f]{64}(?:\.[a-z0-9]{1,8})?")

_ENDING = re.compile(r"\.[a-z0-9]{1,8}")


@dataclass(frozen=True, slots=True)
class StoredFile:
    """A file in the folder beside a book: its name there, and its checksum."""

    name: str
    sha256: str


def store_picture(book: RecordBook, picture: Path | bytes) -> StoredFile:
    """Copy a picture beside the records; its `name` goes into `Defect.picture`.

    Raises
    ------
    InputError
        It cannot be read, is no PNG, JPEG or WebP, is too large, or cannot be written.
    """
    content = picture if isinstance(picture, bytes) else read_input_file(picture, PICTURE_FILE)
    where = say("the picture") if isinstance(picture, bytes) else str(picture)
    if len(content) > PICTURE_FILE.max_bytes:
        raise InputError(say("has {} bytes; pictures may have {}", len(content), PICTURE_FILE.max_bytes, place=where))
    ending = next((ending for ending, start in STARTS.items() if content.startswith(start)), None)
    if ending is None or (ending == ".webp" and content[8:12] != b"WEBP"):
        raise InputError(say("expected a PNG, JPEG or WebP picture, found other content", place=where))
    return _stored(book, content, ending)


def store_document(book: RecordBook, path: Path) -> StoredFile:
    """Copy a document beside the records; name and checksum go into `Document`.

    Raises
    ------
    InputError
        It cannot be read, is too large, or cannot be written.
    """
    ending = path.suffix.lower()
    return _stored(book, read_input_file(path, DOCUMENT_FILE), ending if _ENDING.fullmatch(ending) else "")


def display_place(place: str) -> str:
    """Where a document is, for people: its address or name; of a file that is kept under its checksum, what it is."""
    stem, _, ending = place.partition(".")
    return ending.upper() if SHA256.fullmatch(stem) else place


def download_name(title: str, stored: str) -> str:
    """What a stored document is called when somebody gets it: its title, with the ending of its file."""
    ending = Path(stored).suffix
    stem = "".join("_" if character in '<>:"/\\|?*' or character < " " else character for character in title)
    stem = stem.removesuffix(ending).strip(" .")[:100].strip(" .")
    return f"{stem or 'document'}{ending}"


def stored_path(book: RecordBook, name: str) -> Path:
    """Where a stored file lies; its content is checked against its name.

    Raises
    ------
    InputError
        The name leads elsewhere, or the file is missing or not the one that was stored.
    """
    check_stored_name(name, "name")
    path = book.files / name
    if path.is_symlink() or not path.is_file():
        raise InputError(say("the file is missing; copy it back beside the records", place=path))
    digest = sha256_of_file(path, DOCUMENT_FILE)
    if digest != path.name.partition(".")[0]:
        raise InputError(say("is not the file that was stored; copy it back", place=path))
    return path


def clear_strays(book: RecordBook, least_age_s: float = STRAY_S) -> None:
    """Remove stored files that no entry refers to, nor any of before: a program ended before it had put its entry.

    Parameters
    ----------
    least_age_s
        Newer ones stay: another program may be about to refer to them.
    """
    for path in book.files.glob("*"):
        is_old = time.time() - path.lstat().st_mtime > least_age_s
        if is_old and _STORED.fullmatch(path.name) and not _is_known(book, path):
            path.unlink(missing_ok=True)


def discard_stored(book: RecordBook, names: Iterable[str]) -> None:
    """Remove files that were stored just now for an entry which could not be put, and which no other refers to."""
    for name in names:
        is_known = False
        with suppress(InputError):  # the disk that could not take the entry may not answer at all
            is_known = _is_known(book, book.files / name)
        if _STORED.fullmatch(name) and not is_known:
            with suppress(OSError):
                (book.files / name).unlink(missing_ok=True)


def _is_known(book: RecordBook, path: Path) -> bool:
    """Whether an entry refers to a file, or did so, and may do so again when changes are taken back."""
    now = "SELECT 1 FROM defects WHERE picture = ?1 UNION SELECT 1 FROM documents WHERE place = ?1"
    before = "SELECT 1 FROM changes WHERE instr(old, ?1) OR instr(new, ?1) LIMIT 1"
    return any(book.database.rows(sql, (path.name,)) for sql in (now, before))


def _stored(book: RecordBook, content: bytes, ending: str) -> StoredFile:
    digest = hashlib.sha256(content).hexdigest()
    make_folder(book.files)
    clear_strays(book)
    path = book.files / f"{digest}{ending}"
    # A link of this name could lead anywhere.
    if path.is_symlink() or not path.is_file() or sha256_of_file(path) != digest:
        path.unlink(missing_ok=True)
        write_atomically(path, content)
    else:
        path.touch()  # it is wanted again: see `clear_strays`
    return StoredFile(path.name, digest)
