"""Records as CSV tables, one for each kind of them, written so that reading them brings the same records back."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from planning.base.errors import InputError
from planning.base.files import make_folder
from planning.base.json_file import write_together
from planning.base.messages import say
from reconstruction.records.book import RecordBook
from reconstruction.records.csv.cells import NO, YES, guarded, number_cell
from reconstruction.records.entries import COMPUTED, KINDS, STANDARD, TYPES, Attribute, AttributeType, Kind
from reconstruction.records.objects import ObjectRow

OBJECT = ("global_id", "name")
"""First two columns of each table: either says which object a line is about."""

Column = tuple[str, AttributeType, str]
"""Name, type and unit of an attribute, which together make a column's head."""

_HEAD = re.compile(r"(?P<name>[^\[\]()]*[^\[\]() ])(?: \[(?P<unit>[^\[\]()]+)\])?(?: \((?P<type>[a-z/]+)\))?")


def table_name(kind: Kind) -> str:
    """Name of a kind's file."""
    return f"{kind.table}.csv"


def write_tables(book: RecordBook, folder: Path, semicolon: bool = False) -> tuple[Path, ...]:
    """Write a table of each kind of entries into a folder; the files written.

    Parameters
    ----------
    semicolon
        Part cells by semicolons, as spreadsheets want them where numbers have a decimal comma.

    Raises
    ------
    InputError
        The records are damaged, or a file cannot be written.
    """
    with book.database.snapshot():
        names = {row.global_id: row for row in book.objects(with_absent=True)}
        tables = [(kind, _table(book, kind, names)) for kind in KINDS]
    make_folder(folder)
    delimiter = ";" if semicolon else ","
    files = {folder / table_name(kind): _bytes(head, lines, delimiter) for kind, (head, lines) in tables}
    write_together(files)
    return tuple(files)


def column_head(column: Column) -> str:
    """Head of an attribute's column: `thickness [mm] (number)`."""
    name, kind, unit = column
    return f"{name}{f' [{unit}]' if unit else ''}{'' if kind == 'text' else f' ({kind})'}"


def column_of_head(head: str) -> Column:
    """The attribute of a column; standard ones have their type and unit also where the head leaves them out.

    Raises
    ------
    InputError
        It is no head of such a column.
    """
    found = _HEAD.fullmatch(head)
    kind = next((kind for kind in TYPES if found and kind == (found["type"] or "text")), None)
    if found is None or kind is None:
        raise InputError(
            f"expected heads such as 'maker' or 'thickness [mm] (number)', found '{head[:60]}'; types are "
            f"{', '.join(TYPES)}"
        )
    standard = STANDARD.get(found["name"])
    if standard is not None and found["type"] is None and found["unit"] in (None, standard[1]):
        return found["name"], *standard
    return found["name"], kind, found["unit"] or ""


def _bytes(head: Iterable[str], lines: Iterable[Iterable[str]], delimiter: str) -> bytes:
    text = io.StringIO(newline="")
    writer = csv.writer(text, delimiter=delimiter, lineterminator="\r\n")
    writer.writerow(guarded(cell) for cell in head)
    writer.writerows(lines)
    # The mark at the start tells spreadsheets that it is UTF-8.
    return text.getvalue().encode("utf-8-sig")


def _table(book: RecordBook, kind: Kind, names: Mapping[str, ObjectRow]) -> tuple[list[str], list[list[str]]]:
    entries = book.entries(kind.record)
    if kind.record is Attribute:
        return _wide(entries, names)
    columns = [field.name for field in fields(kind.record) if field.name != "global_id"]
    lines = [
        [entry.global_id, guarded(names[entry.global_id].name), *(_cell(getattr(entry, column)) for column in columns)]
        for entry in entries
    ]
    return [*OBJECT, *columns], lines


def _wide(entries: Iterable[Attribute], names: Mapping[str, ObjectRow]) -> tuple[list[str], list[list[str]]]:
    """A line for each object that is in the model or has attributes, a column for each attribute."""
    standard: list[Column] = [(name, kind, unit) for name, (kind, unit) in STANDARD.items()]
    free: set[Column] = set()
    values: dict[str, dict[Column, str]] = {}
    for entry in entries:
        column = (entry.name, entry.type, entry.unit)
        free.add(column)
        values.setdefault(entry.global_id, {})[column] = _cell(entry.value)
    columns = [*standard, *sorted(free - set(standard))]
    lines = []
    for global_id, row in names.items():
        found = values.get(global_id, {})
        sizes = [_cell(row.width_m), _cell(row.height_m)]
        lines.append([global_id, guarded(row.name), *sizes, *(found.get(column, "") for column in columns)])
    return [*OBJECT, *(f"{name} [m]" for name in COMPUTED), *map(column_head, columns)], lines


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return YES if value else NO
    if isinstance(value, (int, float)):
        return number_cell(value)
    if isinstance(value, tuple):
        return json.dumps(value) if value else ""
    return guarded(str(value))


class TableError(InputError):
    """A table that is not taken, with every place in it that is wrong.

    Parameters
    ----------
    problems
        Texts such as `line 3, column 'severity': expected 1, 2, 3, 4, 5, got 9`.
    """

    def __init__(self, path: Path, problems: tuple[str, ...], shown: int = 20) -> None:
        more = say("; and {} more", len(problems) - shown) if len(problems) > shown else ""
        super().__init__(f"{path}: nothing was taken over: {'; '.join(problems[:shown])}{more}")
        self.path, self.problems = path, problems
