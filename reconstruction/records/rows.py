"""Entries as rows of their tables, as JSON in the history, and back; nothing is believed that comes from a file."""

from __future__ import annotations

import json
from typing import Any

import msgspec

from planning.base.errors import InputError
from planning.base.json_file import encoded, to_record
from planning.base.messages import say
from reconstruction.records.database import Database
from reconstruction.records.entries import Attribute, Defect, Entry, Kind
from reconstruction.records.objects import ObjectRow

OBJECT_COLUMNS = "o.id, o.global_id, o.layer, p.global_id, o.name, o.corners, o.is_present"
OBJECTS = "objects o LEFT JOIN objects p ON p.id = o.parent_id"


def selected(kind: Kind) -> str:
    """Columns of a query for entries, with the object as `o` and the entry as `e`: what `entry_of` takes."""
    return "e.id, o.global_id, " + ", ".join(f"e.{column}" for column in kind.columns)


def joined(kind: Kind) -> str:
    """Tables of such a query."""
    return f"{kind.table} e JOIN objects o ON o.id = e.object_id"


def values_of(entry: Entry, kind: Kind) -> list[Any]:
    """Values of an entry's columns."""
    return [_stored(entry, column) for column in kind.columns]


def _stored(entry: Entry, column: str) -> Any:
    value = getattr(entry, column)
    if column == "outline":
        return json.dumps(value)
    if column == "inspection":
        return value or None
    if isinstance(entry, Attribute) and column == "value":
        return float(value) if entry.type == "number" else int(value) if isinstance(value, bool) else value
    return value


def entry_of(row: Any, kind: Kind, book: Database) -> Entry:
    """Entry of a row of `selected` columns.

    Raises
    ------
    InputError
        The row holds what no entry may hold.
    """
    content = dict(zip(("global_id", *kind.columns), row[1:], strict=True))
    if kind.record is Attribute and content["type"] == "yes/no" and content["value"] in (0, 1):
        content["value"] = bool(content["value"])
    try:
        if kind.record is Defect:
            content["outline"] = tuple(tuple(place) for place in json.loads(content["outline"]))
            content["inspection"] = content["inspection"] or ""
        return kind.record(**content)
    except (InputError, ValueError, TypeError, RecursionError) as error:
        raise InputError(
            say("{}, row {}: {}; the file is damaged", kind.table, row[0], error, place=book.path)
        ) from error


def object_of(row: Any, book: Database) -> ObjectRow:
    """Object of a row of `OBJECT_COLUMNS`.

    Raises
    ------
    InputError
        The row holds what no object may hold.
    """
    try:
        corners = None if row[5] is None else msgspec.json.decode(row[5], type=tuple[tuple[float, float, float], ...])
        return ObjectRow(row[1], row[2], row[3], row[4], corners)  # type: ignore[arg-type]  # it checks them
    except (InputError, ValueError, TypeError, RecursionError) as error:
        raise InputError(say("objects, row {}: {}; the file is damaged", row[0], error, place=book.path)) from error


def as_json(entry: Entry) -> str:
    """An entry in the history."""
    return encoded(entry).decode()


def from_json(text: str, kind: Kind, book: Database) -> Entry:
    """An entry from the history.

    Raises
    ------
    InputError
        It holds what no entry may hold.
    """
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(say("changes: holds no {}; the file is damaged", kind.name, place=book.path)) from error
    return to_record(content, kind.record, book.path)


def searched_texts(entry: Entry, kind: Kind) -> list[tuple[int, str]]:
    """Texts of an entry that are searched, with the numbers of their fields."""
    found = [(index, getattr(entry, field)) for index, field in enumerate(kind.texts)]
    return [(index, text) for index, text in found if isinstance(text, str) and text]
