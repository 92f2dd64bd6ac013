"""CSV tables into a book: all of a table or nothing, and every wrong cell named at once."""

from __future__ import annotations

import csv
import io
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from pathlib import Path
from typing import Any

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, check_lines, read_given
from reconstruction.records.book import RecordBook
from reconstruction.records.changes import Changes
from reconstruction.records.csv.cells import read_field, read_value, unguarded
from reconstruction.records.csv.tables import OBJECT, Column, TableError, column_of_head
from reconstruction.records.entries import COMPUTED, KINDS, Attribute, Entry, Kind
from reconstruction.records.objects import ObjectRow

TABLE_FILE, MAX_LINES = FileLimit("a CSV table", 256 * MIB), 2_000_000

_FIELD = re.compile(r"[a-z_][a-z0-9_, ]{0,60}")


@dataclass(frozen=True, slots=True)
class Taken:
    """What came of a table: lines read, and records that were added or changed by it."""

    kind: str
    n_lines: int
    n_changed: int


@dataclass(frozen=True, slots=True)
class _Table:
    path: Path
    comma: bool
    head: tuple[str, ...]
    lines: tuple[tuple[int, list[str]], ...]


class _Problems:
    """Collects what is wrong, by line and column."""

    def __init__(self) -> None:
        self.texts: list[str] = []

    def add(self, line: int, column: str, error: InputError) -> None:
        """One more; a record's own refusal names the field first, which is the column then."""
        field, colon, rest = str(error).partition(": ")
        is_named = bool(colon) and _FIELD.fullmatch(field) is not None
        self.texts.append(f"line {line}, column '{field if is_named else column[:60]}': {rest if is_named else error}")


def kind_of_table(path: Path) -> Kind:
    """Kind of entries that a file of this name holds, such as `defects.csv`.

    Raises
    ------
    InputError
        The name is none of ours.
    """
    for kind in KINDS:
        if path.stem.lower() == kind.table:
            return kind
    names = ", ".join(f"{kind.table}.csv" for kind in KINDS)
    raise InputError(f"{path}: expected a name of {names}, or name the kind with --kind")


def read_tables(book: RecordBook, tables: Sequence[tuple[Path, Kind]]) -> tuple[Taken, ...]:
    """Take tables over, all of all of them or nothing.

    A line with the key of an entry replaces it, one without key is a new entry; an attribute's empty cell leaves what
    the book has.

    Raises
    ------
    TableError
        Cells are wrong; all those of the first table with such are named.
    InputError
        A file cannot be read, is no table of its kind, or the records cannot be written.
    """
    taken = []
    what = f"import of {', '.join(path.name for path, _ in tables)}"
    with book.changing(what[:200]) as changes:
        objects = _Objects(book)
        # Inspections before the defects that belong to them.
        for path, kind in sorted(tables, key=lambda table: table[1].code):
            taken.append(_take(_read(path), kind, objects, changes))
    return tuple(taken)


def _take(table: _Table, kind: Kind, objects: _Objects, changes: Changes) -> Taken:
    problems, n_before = _Problems(), changes.n_changed
    read = _attributes if kind.record is Attribute else _entries
    entries = list(read(table, kind, objects, problems))
    seen: dict[tuple[str, ...], int] = {}
    for line, entry in entries:
        mark = (entry.global_id, entry.name) if isinstance(entry, Attribute) else (entry.key,)
        if mark[-1] and mark in seen:
            problems.add(line, "key", InputError(f"'{mark[-1]}' stands in line {seen[mark]} already"))
        seen[mark] = line
    for line, entry in () if problems.texts else entries:
        try:
            changes.put(entry)
        except InputError as error:
            problems.add(line, "key", error)
    if problems.texts:
        raise TableError(table.path, tuple(problems.texts))
    return Taken(kind.name, len(table.lines), changes.n_changed - n_before)


class _Objects:
    """Finds the object of a line."""

    def __init__(self, book: RecordBook) -> None:
        rows = book.objects(with_absent=True)
        self._by_id: Mapping[str, ObjectRow] = {row.global_id: row for row in rows}
        present = book.objects()
        counts = Counter(row.name for row in present)
        self._by_name = {row.name: row.global_id for row in present if counts[row.name] == 1}
        self._ambiguous = {name for name, count in counts.items() if count > 1}

    def find(self, global_id: str, name: str) -> str:
        """GlobalId of the object that a line is about; its GlobalId goes before its name."""
        if global_id:
            if global_id not in self._by_id:
                raise InputError(f"global_id: expected an object of the model, got '{global_id[:40]}'")
            return global_id
        if not name:
            raise InputError("global_id: expected a GlobalId, or a name in the column 'name', found neither")
        if name in self._ambiguous:
            raise InputError(f"name: several objects have the name '{name[:40]}'; give the GlobalId")
        if name not in self._by_name:
            raise InputError(f"name: expected the name of an object of the model, got '{name[:40]}'")
        return self._by_name[name]


def _read(path: Path) -> _Table:
    content = read_given(path, TABLE_FILE)
    check_lines(content, MAX_LINES, path)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise InputError(f"{path}: line {line}: expected UTF-8, found other bytes; save it as CSV UTF-8") from error
    delimiter = ";" if _is_headed(text, ";") and not _is_headed(text, ",") else ","
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, strict=True)
    lines: list[tuple[int, list[str]]] = []
    start = 1
    try:
        for cells in reader:
            if any(cell.strip() for cell in cells):
                if lines and len(cells) != len(lines[0][1]):
                    raise InputError(
                        f"{path}: line {start}: expected {len(lines[0][1])} cells parted by '{delimiter}', found "
                        f"{len(cells)}"
                    )
                lines.append((start, cells))
            start = reader.line_num + 1
    except csv.Error as error:
        raise InputError(f"{path}: line {start}: is no CSV ({error})") from error
    if not lines:
        raise InputError(f"{path}: the table is empty; expected a line with the names of its columns")
    head = tuple(unguarded(cell).strip() for cell in lines[0][1])
    repeated = next((name for name in head if head.count(name) > 1), None) if len(set(head)) < len(head) else None
    if repeated is not None:
        raise InputError(f"{path}: line 1: the column '{repeated[:60]}' occurs twice")
    if not any(name in head for name in OBJECT):
        raise InputError(f"{path}: line 1: expected a column 'global_id' or 'name', found {_listed(head)}")
    return _Table(path, delimiter == ";", head, tuple(lines[1:]))


def _is_headed(text: str, delimiter: str) -> bool:
    """Whether a table parted so has a column that says which object a line is about."""
    try:
        head = next(csv.reader(io.StringIO(text[:100_000], newline=""), delimiter=delimiter), [])
    except csv.Error:
        return False
    return any(name.strip() in OBJECT for name in head) and len(head) > 1


def _listed(names: Sequence[str]) -> str:
    return ", ".join(f"'{name[:40]}'" for name in names[:12])


def _cells(table: _Table, cells: list[str]) -> dict[str, str]:
    return {name: unguarded(cell) for name, cell in zip(table.head, cells, strict=True)}


def _object(objects: _Objects, cells: dict[str, str], line: int, problems: _Problems) -> str:
    """GlobalId of a line's object, "" where there is none."""
    try:
        return objects.find(cells.get("global_id", "").strip(), cells.get("name", "").strip())
    except InputError as error:
        problems.add(line, "global_id", error)
        return ""


def _entries(table: _Table, kind: Kind, objects: _Objects, problems: _Problems) -> Iterator[tuple[int, Entry]]:
    known = (*OBJECT, *kind.columns)
    unknown = next((name for name in table.head if name not in known), None)
    if unknown is not None:
        raise InputError(f"{table.path}: line 1: there is no column '{unknown[:60]}'; known are {', '.join(known)}")
    required = [f.name for f in fields(kind.record) if f.default is MISSING and f.name != "global_id"]
    missing = next((name for name in required if name not in table.head), None)
    if missing is not None:
        raise InputError(f"{table.path}: line 1: the column '{missing}' is missing")
    for line, texts in table.lines:
        cells, n_before = _cells(table, texts), len(problems.texts)
        values: dict[str, Any] = {"global_id": _object(objects, cells, line, problems)}
        for column in kind.columns:
            text = cells.get(column, "")
            try:
                value = read_field(column, text, table.comma)
                if value != "":
                    values[column] = value
                elif column in required:
                    raise InputError(f"{column}: expected a value, found none")
            except InputError as error:
                problems.add(line, column, error)
        if len(problems.texts) == n_before:
            try:
                yield line, kind.record(**values)
            except InputError as error:
                problems.add(line, table.head[0], error)


def _attributes(table: _Table, kind: Kind, objects: _Objects, problems: _Problems) -> Iterator[tuple[int, Entry]]:
    columns = _columns(table)
    for line, texts in table.lines:
        cells = _cells(table, texts)
        global_id = _object(objects, cells, line, problems)
        for head, (name, type_name, unit) in columns.items():
            text = cells[head] if type_name == "text" else cells[head].strip()
            if not text.strip() or name in COMPUTED or not global_id:
                continue
            try:
                yield line, Attribute(global_id, name, read_value(type_name, text, name, table.comma), type_name, unit)
            except InputError as error:
                problems.add(line, head, error)


def _columns(table: _Table) -> dict[str, Column]:
    """Attributes that the columns are about, by their heads."""
    try:
        return {head: column_of_head(head) for head in table.head if head not in OBJECT}
    except InputError as error:
        raise InputError(f"{table.path}: line 1: {error}") from error
