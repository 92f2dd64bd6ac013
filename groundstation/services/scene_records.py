"""The records that lie beside a scene of objects: which objects they are of, and the files that they keep."""

from __future__ import annotations

import getpass
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

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
        return RecordBook(path, True, who)
    scene = StoredScene(folder)
    make_book(path)
    book = RecordBook(path, True, who)
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
