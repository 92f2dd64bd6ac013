"""Pictures and documents beside the records, each under the SHA-256 of its content: the same file is kept once."""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass
from pathlib import Path

from planning.errors import InputError
from planning.folders import make_folder
from planning.json_file import write_atomically
from reconstruction.records.book import RecordBook
from reconstruction.records.entries import check_stored_name
from reconstruction.records.limits import SHA256

MAX_PICTURE_BYTES = 64 * 2**20
"""The largest JPEG of a drone has 30 MB."""

MAX_DOCUMENT_BYTES = 256 * 2**20

STARTS = {".png": b"\x89PNG\r\n\x1a\n", ".jpg": b"\xff\xd8\xff", ".webp": b"RIFF"}
"""First bytes of pictures, by the ending they are stored under."""

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
    content = picture if isinstance(picture, bytes) else _read(picture, MAX_PICTURE_BYTES)
    where = "the picture" if isinstance(picture, bytes) else str(picture)
    if len(content) > MAX_PICTURE_BYTES:
        raise InputError(f"{where}: has {len(content)} bytes; pictures may have {MAX_PICTURE_BYTES}")
    ending = next((ending for ending, start in STARTS.items() if content.startswith(start)), None)
    if ending is None or (ending == ".webp" and content[8:12] != b"WEBP"):
        raise InputError(f"{where}: expected a PNG, JPEG or WebP picture, found other content")
    return _stored(book, content, ending)


def store_document(book: RecordBook, path: Path) -> StoredFile:
    """Copy a document beside the records; name and checksum go into `Document`.

    Raises
    ------
    InputError
        It cannot be read, is too large, or cannot be written.
    """
    ending = path.suffix.lower()
    return _stored(book, _read(path, MAX_DOCUMENT_BYTES), ending if _ENDING.fullmatch(ending) else "")


def shown_place(place: str) -> str:
    """Where a document is, for people: its address or name; of a file that is kept under its checksum, what it is."""
    stem, _, ending = place.partition(".")
    return ending.upper() if SHA256.fullmatch(stem) else place


def told_name(title: str, stored: str) -> str:
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
        raise InputError(f"{path}: the file is missing; copy it back beside the records")
    digest = hashlib.sha256(_read(path, MAX_DOCUMENT_BYTES)).hexdigest()
    if digest != path.name.partition(".")[0]:
        raise InputError(f"{path}: is not the file that was stored; copy it back")
    return path


def _stored(book: RecordBook, content: bytes, ending: str) -> StoredFile:
    digest = hashlib.sha256(content).hexdigest()
    make_folder(book.files)
    path = book.files / f"{digest}{ending}"
    # A link of this name could lead anywhere.
    if path.is_symlink() or not path.is_file() or path.read_bytes() != content:
        path.unlink(missing_ok=True)
        write_atomically(path, content)
    return StoredFile(path.name, digest)


def _read(path: Path, limit: int) -> bytes:
    try:
        if not path.is_file():
            raise InputError(f"{path}: there is no such file")
        with path.open("rb") as file:
            content = file.read(limit + 1)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    if len(content) > limit:
        raise InputError(f"{path}: has more than {limit // 2**20} MiB")
    return content
