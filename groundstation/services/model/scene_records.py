"""The records that lie beside a scene of objects: which objects they are of, and the files that they keep."""

from __future__ import annotations

import getpass
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from planning.base.errors import InputError
from planning.base.files import read_given
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor

if TYPE_CHECKING:
    from reconstruction.objects.store import StoredScene
    from reconstruction.records.book import RecordBook
    from reconstruction.records.entries import Entry
    from reconstruction.records.objects import ObjectRow


def user_name() -> str:
    """Who is at the computer, for the history."""
    try:
        return getpass.getuser()[:200] or "unknown"
    except (OSError, KeyError, ImportError):
        return "unknown"


def book_of_scene(folder: Path, who: str) -> RecordBook:
    """The records of a scene, opened for writing; a new book where there was none.

    Raises
    ------
    InputError
        The scene or the book cannot be read or written.
    """
    from reconstruction.objects.store import StoredScene
    from reconstruction.records.book import FILE, RecordBook, make_book

    path = folder / FILE
    if path.exists():
        book = RecordBook(path, True, who)
        if book.objects(with_absent=True):
            return book
        # A program ended between making the book and telling it of the objects.
    else:
        StoredScene(folder)
        make_book(path)
        book = RecordBook(path, True, who)
    scene = StoredScene(folder)
    book.set_objects(object_rows(scene), scene.origin)
    return book


def with_file(book: RecordBook, entry: Entry, file: Path | None) -> Entry:
    """A defect with its picture, or a document with its file, of which the records keep a copy.

    Raises
    ------
    InputError
        The file cannot be read or kept, or is no picture.
    """
    from reconstruction.records.entries import Defect, Document
    from reconstruction.records.stored_files import store_document, store_picture

    if file is not None and isinstance(entry, Defect):
        return replace(entry, picture=store_picture(book, file).name)
    if file is not None and isinstance(entry, Document):
        stored = store_document(book, file)
        return replace(entry, place=stored.name, sha256=stored.sha256)
    return entry


@dataclass(frozen=True, slots=True)
class Attachment:
    """A file that a record names, as far as it is there.

    Parameters
    ----------
    n_bytes
        0 where it is missing, or not the one that was stored.
    picture
        A small JPEG of it, where it is a picture that can be read.
    """

    n_bytes: int = 0
    picture: bytes | None = None


def attachments_of(
    folder: Path, entries: Iterable[Entry], longest_px: int, monitor: Monitor = QUIET
) -> dict[str, Attachment]:
    """Stored files of defects and documents, by their names beside the records.

    Parameters
    ----------
    longest_px
        Side of the pictures.

    Raises
    ------
    InputError
        The records cannot be read.
    """
    from reconstruction.exports.web.pictures import PICTURES, small_jpeg
    from reconstruction.records.book import FILE, RecordBook
    from reconstruction.records.entries import Defect, Document, is_address
    from reconstruction.records.stored_files import DOCUMENT_FILE, stored_path

    names = {each.picture for each in entries if isinstance(each, Defect) and each.picture}
    names |= {each.place for each in entries if isinstance(each, Document) and not is_address(each.place)}
    found: dict[str, Attachment] = {}
    if not names:
        return found
    with RecordBook(folder / FILE) as book:
        for number, name in enumerate(sorted(names)):
            monitor.report(say("reading what is attached"), number, len(names))
            found[name] = Attachment()
            with suppress(InputError):
                content = read_given(stored_path(book, name), DOCUMENT_FILE)
                found[name] = Attachment(len(content))
                if name.endswith(PICTURES):
                    found[name] = Attachment(len(content), small_jpeg(name, content, longest_px))
    return found


def keep_objects(folder: Path, who: str) -> None:
    """Tell the records of a scene, where there are any, which objects it has now.

    Raises
    ------
    InputError
        The scene or the book cannot be read or written.
    """
    from reconstruction.objects.store import StoredScene
    from reconstruction.records.book import FILE, RecordBook

    if (folder / FILE).exists():
        scene = StoredScene(folder)
        with RecordBook(folder / FILE, True, who) as book:
            book.set_objects(object_rows(scene), scene.origin)


def object_rows(scene: StoredScene) -> tuple[ObjectRow, ...]:
    """Objects of a scene as records know them."""
    from reconstruction.records.objects import ObjectRow

    rows = [ObjectRow(scene.global_id, "scene", None, scene.name)]
    for head in scene.heads:
        rows.append(ObjectRow(head.global_id, "component", scene.global_id, head.name))
        rows += [
            ObjectRow(element.global_id, "element", head.global_id, element.name, element.corners_enu_m)
            for element in head.elements
        ]
    return tuple(rows)
