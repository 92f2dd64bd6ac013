"""Files that others wrote, and folders that we write.

Foreign files are opened only where they are regular files of a size that the kind has, parsed within bounds.

Whatever a name stands for is looked at before it is opened (a device or a pipe may be endless, or never answer), and
once more when it is open. No more is read than the limit of the kind, whatever the file says of its size. What a parser
would make of a text is estimated before it starts: a few bytes of JSON or XML can become a hundred times as many.
"""

from __future__ import annotations

import hashlib
import os
import re
import stat
import struct
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fnmatch import fnmatch
from io import BufferedReader
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from planning.base.errors import InputError
from planning.base.messages import say

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element


# Folders for results, and names of files and folders that say what is in them.

FILE_ENDING = re.compile(
    r"\.(avi|bin|bmp|csv|docx?|exr|gif|glb|gltf|gml|html?|ifc|jpe?g|json|kml|kmz|las|laz|log|md|mp4|npy|obj|ods|odt|pdf|"
    r"plan|ply|png|pptx?|rtf|safetensors|sog|splat|spz|sqlite|stl|svg|tar|tiff?|tlog|toml|tsv|txt|ulg|usd[acz]?|waypoints|"
    r"webp|xls[mx]?|xml|ya?ml|zip)"
)
"""Endings that everybody knows: a name with one of them says what is in a file, and that it is a file."""

PLAIN_ENDINGS = frozenset({".bin", ".log", ".txt", ".zip"})
"""That say little: a KMZ file is a ZIP, and any text may be called a text."""


def is_empty(folder: Path) -> bool:
    """Whether there is no file in a folder that exists, nor in those within it; of what is in the making none counts.

    So a run that ended before it wrote anything leaves an empty folder.
    """
    return all(path.is_dir() or fnmatch(path.name, ".*.????????.part*") for path in folder.rglob("*"))


def make_folder(folder: Path) -> None:
    """Make a folder, and those above it, where it is missing.

    Raises
    ------
    InputError
        It cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError.say(
            "cannot be made ({}); name another folder", error.strerror or error, place=folder
        ) from error


def check_ending(path: Path, endings: Sequence[str], others: Collection[str] = PLAIN_ENDINGS) -> None:
    """Refuse to write a file under a name that says something else is in it.

    Parameters
    ----------
    endings
        Of such files, in lower case.
    others
        That are borne with.

    Raises
    ------
    InputError
        The name ends as files of another kind do.
    """
    ending = path.suffix.lower()
    is_known = FILE_ENDING.fullmatch(ending) is not None and ending not in others
    if is_known and not path.name.lower().endswith(tuple(endings)):
        expected_endings = " or ".join(endings)
        if path.exists():
            raise InputError.say(
                "would replace a {} file by what is {}; name another file", ending, expected_endings, place=path
            )
        raise InputError.say(
            "not written: the name ends in {}, and what would be in the file is {}; name it so, or choose "
            "another format",
            ending,
            expected_endings,
            place=path,
        )


def check_folder_name(path: Path) -> None:
    """Refuse to make a folder under a name that says it is a file.

    Raises
    ------
    InputError
        The name ends as files do, and there is no such folder.
    """
    ending = path.suffix.lower()
    if FILE_ENDING.fullmatch(ending) and not path.is_dir():
        raise InputError.say(
            "not written: the name ends in {} as files do, and this is written as a folder; name one",
            ending,
            place=path,
        )


MIB = 2**20

MAX_PARSED_BYTES = 2 * 2**30
"""Of memory for the content of one file of text: ten million values or elements, more than any building's."""

MAX_XML_DEPTH = 500
"""Levels of elements; CityGML and WPML have under 40, and the readers of both go down by recursion."""

_LIST_BYTES, _OBJECT_BYTES, _VALUE_BYTES, _KEY_BYTES, _QUOTE_BYTES = 64, 160, 36, 30, 15
"""What CPython 3.11 takes for an empty list, an object, a value in a list, and a key, and half of what it takes for a
text besides its characters (measured with tracemalloc)."""

_TAG_BYTES, _ATTRIBUTE_BYTES = 90, 250
"""As above, for ElementTree: an element of one tag, and an attribute with its dictionary."""

_WIDEST_CHARACTER_BYTES = 4
"""One character beyond ASCII makes all characters of a Python text wider."""


@dataclass(frozen=True, slots=True)
class FileLimit:
    """What kind of file is expected, and how large it may be.

    Parameters
    ----------
    what
        With its article, for messages: `a mission file`.
    max_bytes
        Larger ones are refused.
    advice
        What to do about a larger one, behind a semicolon; empty for nothing more than what is expected.
    """

    what: str
    max_bytes: int
    advice: str = ""


ANY_FILE = FileLimit(say("a file"), 2**62)
"""For those who only look how it begins."""


def real_path(path: Path) -> Path:
    """An absolute path without links; one that leads in circles stays as it is, to be refused when it is opened."""
    return Path(os.path.realpath(path))


def check_input_file(path: Path, limit: FileLimit) -> os.stat_result:
    """See that a name stands for a regular file of a size that is expected, for readers that open it by themselves.

    Raises
    ------
    InputError
        There is none, it is a folder, a device or a pipe, or it is too large.
    """
    try:
        status = path.stat()
    except (OSError, ValueError) as error:
        raise _not_read(path, error) from error
    _check_status(path, status, limit)
    return status


@contextmanager
def open_input_file(path: Path, limit: FileLimit) -> Iterator[BufferedReader]:
    """A file that others wrote, open for reading.

    Raises
    ------
    InputError
        As `check_input_file`; it cannot be opened, or reading it inside fails.
    """
    check_input_file(path, limit)
    # Without blocking: the name may have become a pipe's meanwhile, which waits for its other end for ever.
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    try:
        file = open(path, "rb", opener=lambda name, _: os.open(name, flags))  # noqa: SIM115  (closed below)
    except (OSError, ValueError) as error:
        raise _not_read(path, error) from error
    with file:
        _check_status(path, os.fstat(file.fileno()), limit)
        try:
            yield file
        except OSError as error:
            raise _not_read(path, error) from error


def read_input_file(path: Path, limit: FileLimit) -> bytes:
    """Content of a file that others wrote.

    Raises
    ------
    InputError
        As `open_input_file`, or it holds more than it says.
    """
    with open_input_file(path, limit) as file:
        # To read takes memory for all that is asked for: what is there, one more byte, and further pieces only where
        # that byte was there (the file grows, or is one of the system's, which say that they are empty).
        size = os.fstat(file.fileno()).st_size
        content = file.read(size + 1)
        if len(content) <= size:
            return content
        pieces, n_bytes = [content], len(content)
        while n_bytes <= limit.max_bytes and (piece := file.read(MIB)):
            pieces.append(piece)
            n_bytes += len(piece)
    if n_bytes > limit.max_bytes:
        raise _too_large(path, limit)
    return b"".join(pieces)


def sha256_of_file(path: Path, limit: FileLimit = ANY_FILE) -> str:
    """SHA-256 of a file's content, hexadecimal; it is read piece by piece.

    Raises
    ------
    InputError
        As `open_input_file`.
    """
    with open_input_file(path, limit) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _check_status(path: Path, status: os.stat_result, limit: FileLimit) -> None:
    if stat.S_ISDIR(status.st_mode):
        raise InputError.say("expected {}, found a folder; name a file", limit.what, place=path)
    if not stat.S_ISREG(status.st_mode):
        raise InputError.say("expected {}, found a device or a pipe; name a file", limit.what, place=path)
    if status.st_size > limit.max_bytes:
        raise _too_large(path, limit)


def _too_large(path: Path, limit: FileLimit) -> InputError:
    return InputError(
        say("the file has more than {}; expected {}", size_text(limit.max_bytes), limit.what, place=path)
        + (f"; {limit.advice}" if limit.advice else "")
    )


def size_text(n_bytes: int) -> str:
    """A limit in words: whole MiB, or KiB below one."""
    return say("{} MiB", n_bytes // MIB) if n_bytes >= MIB else say("{} KiB", n_bytes // 1024)


def _not_read(path: Path, error: Exception) -> InputError:
    if isinstance(error, FileNotFoundError):
        return InputError.say("cannot be read: there is no such file", place=path)
    return InputError.say("cannot be read ({})", getattr(error, "strerror", None) or error, place=path)


def check_lines(content: bytes, most: int, place: object) -> None:
    """Refuse a table of more lines than any of its kind has, before each becomes a text of its own.

    Raises
    ------
    InputError
        As said.
    """
    n_lines = content.count(b"\n") + content.count(b"\r")
    if n_lines > 2 * most:
        raise InputError.say("has more than {} lines; cut out the part that is wanted", most, place=place)


def check_json_size(content: bytes, path: Path) -> None:
    """Refuse JSON whose values would take more memory than there may be.

    Raises
    ------
    InputError
        As said.
    """
    n_bytes = _json_bytes(content)
    if n_bytes > MAX_PARSED_BYTES:
        raise _too_rich(path, n_bytes)


def _json_bytes(content: bytes) -> int:
    """Memory for the values of a JSON text, from the marks that begin or part them."""
    return (
        _text_bytes(content)
        + _LIST_BYTES * content.count(b"[")
        + _OBJECT_BYTES * content.count(b"{")
        + _VALUE_BYTES * content.count(b",")
        + _KEY_BYTES * content.count(b":")
        + _QUOTE_BYTES * content.count(b'"')
    )


def _xml_bytes(content: bytes) -> int:
    """Memory for the elements of an XML text."""
    return len(content) + _TAG_BYTES * content.count(b"<") + _ATTRIBUTE_BYTES * content.count(b"=")


def _text_bytes(content: bytes) -> int:
    return len(content) * (1 if content.isascii() else 1 + _WIDEST_CHARACTER_BYTES)


def _too_rich(place: object, n_bytes: int) -> InputError:
    return InputError.say(
        "its content would take about {:.0f} GiB of memory; expected at most {} GiB; cut out the part that is wanted",
        n_bytes / 2**30,
        MAX_PARSED_BYTES // 2**30,
        place=place,
    )


ZIP_END, ZIP_TAIL_BYTES = struct.Struct("<4s4H2LH"), 65535
"""Record at the end of a zip archive (APPNOTE.TXT, 4.3.16), and the longest comment behind it."""

MAX_ZIP_DIRECTORY_BYTES = 2 * MIB
"""Ten thousand files with long names; Python's module makes ten times as much of it before it can be asked."""


def check_zip_directory(file: BinaryIO, place: object) -> None:
    """Refuse a zip archive whose list of files is longer than any of ours; what is no archive passes.

    Raises
    ------
    InputError
        As said.
    """
    file.seek(max(0, file.seek(0, os.SEEK_END) - ZIP_END.size - ZIP_TAIL_BYTES))
    tail = file.read()
    at = tail.rfind(b"PK\x05\x06", 0, len(tail) - ZIP_END.size + 4)
    if at < 0:
        return
    *_, n_bytes, _, _ = ZIP_END.unpack_from(tail, at)
    if n_bytes > MAX_ZIP_DIRECTORY_BYTES:
        raise InputError.say(
            "the list of its files has more than {}; pack it again with what is needed",
            size_text(MAX_ZIP_DIRECTORY_BYTES),
            place=place,
        )


def local_name(element: Element) -> str:
    """Name of an XML element without its namespace; empty for comments and the like."""
    return element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""


class HostileXml(ValueError):  # noqa: N818  (the name says what happened)
    """XML that does what no file of its kind needs: it declares a document type, entities or endless depth."""


def parse_xml(content: bytes, place: object, *, forbid_dtd: bool = True) -> Element:
    """Root of an XML text, within bounds of memory and depth.

    Parameters
    ----------
    place
        File it is from, for messages.
    forbid_dtd
        Refuse document types, too; entities are refused either way.

    Raises
    ------
    HostileXml
        It declares a document type or entities, or is nested too deeply.
    ValueError
        It is not XML (also in an encoding that is not known).
    InputError
        It would take too much memory.
    """
    from xml.etree.ElementTree import ParseError

    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import fromstring

    n_bytes = _xml_bytes(content)
    if n_bytes > MAX_PARSED_BYTES:
        raise _too_rich(place, n_bytes)
    try:
        root: Element = fromstring(content, forbid_dtd=forbid_dtd)
    except DefusedXmlException as error:
        raise HostileXml(say("declares a document type or entities")) from error
    except (ParseError, LookupError) as error:
        raise ValueError(str(error)) from error
    level, depth = [root], 0
    while level:
        level, depth = [child for element in level for child in element], depth + 1
        if depth > MAX_XML_DEPTH:
            raise HostileXml(say("is nested more than {} levels deep", MAX_XML_DEPTH))
    return root
