"""CSV tables into a book: all of a table or nothing, and every wrong cell named at once."""

from __future__ import annotations

import csv
import io
import json
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from pathlib import Path
from typing import Any

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, check_lines, make_folder, read_input_file
from planning.base.json_file import write_together
from planning.base.messages import joined, say
from reconstruction.records.book import RecordBook
from reconstruction.records.changes import Changes
from reconstruction.records.entries import (
    COMPUTED,
    KINDS,
    STANDARD,
    TYPES,
    Attribute,
    AttributeType,
    Entry,
    Kind,
    Value,
)
from reconstruction.records.limits import check_number
from reconstruction.records.objects import ObjectRow

# Cells of CSV tables: numbers, dates and texts to text and back, and nothing that a spreadsheet would compute.
#
# A text that begins like a formula gets an apostrophe in front, on its way in it loses it again; a text that has one
# there of its own gets another, so that every text reads back as it was.

_FORMULA = re.compile("'*[=+\\-@\t\r\n＝＋－＠]")
_GUARDED = re.compile("'+[=+\\-@\t\r\n＝＋－＠]")
_NUMBER = re.compile(r"[+-]?([0-9]+([.][0-9]*)?|[.][0-9]+)([eE][+-]?[0-9]{1,3})?")

YES, NO = "yes", "no"

_PLAIN = frozenset({"key", "inspection", "status", "sha256", "currency"})
"""Fields in which blanks at the ends mean nothing."""

_DAY_FIRST = re.compile(r"([0-9]{1,2})\.([0-9]{1,2})\.([0-9]{4})")
"""A date with points, which has the day first wherever it is written; with slashes it may be either."""


def escaped_formula(text: str) -> str:
    """Text that no spreadsheet takes for a formula."""
    return f"'{text}" if _FORMULA.match(text) else text


def unescaped_formula(text: str) -> str:
    """The text that `escaped_formula` was given."""
    return text[1:] if _GUARDED.match(text) else text


def number_cell(value: float, comma: bool = False) -> str:
    """The shortest text that reads back as the number; one below zero is no formula, spreadsheets read it.

    Parameters
    ----------
    comma
        The table is parted by semicolons, so that a comma is a decimal one: where spreadsheets want that, they take
        "1.44" for a month.
    """
    text = str(int(value)) if value == int(value) and abs(value) < 1e15 else repr(value)
    return text.replace(".", ",") if comma else text


def read_number(text: str, field: str, comma: bool) -> float:
    """Number of a cell.

    Parameters
    ----------
    comma
        The table is parted by semicolons, so that a comma is a decimal one.

    Raises
    ------
    InputError
        It is none.
    """
    plain = text.strip()
    if comma and plain.count(",") == 1 and "." not in plain:
        plain = plain.replace(",", ".")
    if not _NUMBER.fullmatch(plain):
        hint = " with a point (commas in tables parted by semicolons only)" if "," in plain and not comma else ""
        raise InputError(say("expected a number{}, got '{}'", hint, text[:40], place=field))
    value = float(plain)
    check_number(value, field)
    return value


def read_whole(text: str, field: str, comma: bool) -> int:
    """Whole number of a cell.

    Raises
    ------
    InputError
        It is none.
    """
    value = read_number(text, field, comma)
    if value != int(value):
        raise InputError(say("expected a whole number, got '{}'", text[:40], place=field))
    return int(value)


def read_truth(text: str, field: str) -> bool:
    """Truth of a cell.

    Raises
    ------
    InputError
        It is neither yes nor no.
    """
    word = text.strip().lower()
    if word in (YES, "true", "1"):
        return True
    if word in (NO, "false", "0"):
        return False
    raise InputError(say("expected yes or no, got '{}'", text[:40], place=field))


def read_outline(text: str, field: str) -> tuple[tuple[float, float], ...]:
    """Outline of a cell, `[[u, v], ...]`.

    Raises
    ------
    InputError
        It is none.
    """
    try:
        found: Any = json.loads(text)
        return tuple((float(u), float(v)) for u, v in found)
    except (ValueError, TypeError, RecursionError) as error:
        raise InputError(say("expected places such as [[0.1, 0.2], ...], got '{}'", text[:40], place=field)) from error


def read_date(text: str) -> str:
    """Date of a cell as ISO 8601 writes it, also where it stands as 31.03.2026; other texts as they are."""
    found = _DAY_FIRST.fullmatch(text.strip())
    return f"{found[3]}-{found[2]:0>2}-{found[1]:0>2}" if found else text.strip()


_READERS: dict[str, Callable[[str, str, bool], Any]] = {
    **dict.fromkeys(("date", "found_on", "repaired_on", "next_due"), lambda text, _field, _comma: read_date(text)),
    "severity": read_whole,
    "u": read_number,
    "v": read_number,
    "cost": read_number,
    "outline": lambda text, field, _: read_outline(text, field),
}


def read_field(field: str, text: str, comma: bool = False) -> Any:
    """Value of an entry's field; "" where the cell is empty.

    Raises
    ------
    InputError
        It is no such value.
    """
    plain = text.strip()
    if field in _READERS:
        return _READERS[field](plain, field, comma) if plain else ""
    return plain if field in _PLAIN else text


def read_value(type_name: AttributeType, text: str, field: str, comma: bool = False) -> Value:
    """Value of an attribute of a type; texts as they are.

    Raises
    ------
    InputError
        It is no such value.
    """
    if type_name == "number":
        return read_number(text, field, comma)
    if type_name == "date":
        return read_date(text)
    return read_truth(text, field) if type_name == "yes/no" else text


# Records as CSV tables, one for each kind of them, written so that reading them brings the same records back.

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
        Part cells by semicolons, and write decimal commas, as spreadsheets want both where numbers have them.

    Raises
    ------
    InputError
        The records are damaged, or a file cannot be written.
    """
    with book.database.snapshot():
        names = {row.global_id: row for row in book.objects(with_absent=True)}
        tables = [(kind, _table(book, kind, names, semicolon)) for kind in KINDS]
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
            say(
                "expected heads such as 'maker' or 'thickness [mm] (number)', found '{}'; types are {}",
                head[:60],
                ", ".join(TYPES),
            )
        )
    standard = STANDARD.get(found["name"])
    if standard is not None and found["type"] is None and found["unit"] in (None, standard[1]):
        return found["name"], *standard
    return found["name"], kind, found["unit"] or ""


def _bytes(head: Iterable[str], lines: Iterable[Iterable[str]], delimiter: str) -> bytes:
    text = io.StringIO(newline="")
    writer = csv.writer(text, delimiter=delimiter, lineterminator="\r\n")
    writer.writerow(escaped_formula(cell) for cell in head)
    writer.writerows(lines)
    # The mark at the start tells spreadsheets that it is UTF-8.
    return text.getvalue().encode("utf-8-sig")


def _table(
    book: RecordBook, kind: Kind, names: Mapping[str, ObjectRow], comma: bool
) -> tuple[list[str], list[list[str]]]:
    entries = book.entries(kind.record)
    if kind.record is Attribute:
        return _wide(entries, names, comma)
    columns = [field.name for field in fields(kind.record) if field.name != "global_id"]
    lines = [
        [
            entry.global_id,
            escaped_formula(names[entry.global_id].name),
            *(_cell(getattr(entry, column), comma) for column in columns),
        ]
        for entry in entries
    ]
    return [*OBJECT, *columns], lines


def _wide(
    entries: Iterable[Attribute], names: Mapping[str, ObjectRow], comma: bool
) -> tuple[list[str], list[list[str]]]:
    """A line for each object that is in the model or has attributes, a column for each attribute."""
    standard: list[Column] = [(name, kind, unit) for name, (kind, unit) in STANDARD.items()]
    free: set[Column] = set()
    values: dict[str, dict[Column, str]] = {}
    for entry in entries:
        column = (entry.name, entry.type, entry.unit)
        free.add(column)
        values.setdefault(entry.global_id, {})[column] = _cell(entry.value, comma)
    columns = [*standard, *sorted(free - set(standard))]
    lines = []
    for global_id, row in names.items():
        found = values.get(global_id, {})
        sizes = [_cell(row.width_m, comma), _cell(row.height_m, comma)]
        lines.append([global_id, escaped_formula(row.name), *sizes, *(found.get(column, "") for column in columns)])
    return [*OBJECT, *(f"{name} [m]" for name in COMPUTED), *map(column_head, columns)], lines


def _cell(value: Any, comma: bool) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return YES if value else NO
    if isinstance(value, (int, float)):
        return number_cell(value, comma)
    if isinstance(value, tuple):
        return json.dumps(value) if value else ""
    return escaped_formula(str(value))


class TableError(InputError):
    """A table that is not taken, with every place in it that is wrong.

    Parameters
    ----------
    problems
        Texts such as `line 3, column 'severity': expected 1, 2, 3, 4, 5, got 9`.
    """

    def __init__(self, path: Path, problems: tuple[str, ...], shown: int = 20) -> None:
        more = say("; and {} more", len(problems) - shown) if len(problems) > shown else ""
        super().__init__(say("nothing was taken over: {}", joined("; ", problems[:shown]) + more, place=path))
        self.path, self.problems = path, problems


TABLE_FILE, MAX_LINES = FileLimit("a CSV table", 256 * MIB), 2_000_000

_FIELD = re.compile(r"[a-z_][a-z0-9_, ]{0,60}")


@dataclass(frozen=True, slots=True)
class ImportedTable:
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
    raise InputError(say("expected a name of {}, or name the kind with --kind", names, place=path))


def read_tables(book: RecordBook, tables: Sequence[tuple[Path, Kind]]) -> tuple[ImportedTable, ...]:
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
    imported = []
    what = f"import of {', '.join(path.name for path, _ in tables)}"
    with book.changing(what[:200]) as changes:
        objects = _Objects(book)
        # Inspections before the defects that belong to them.
        for path, kind in sorted(tables, key=lambda table: table[1].code):
            imported.append(_take(_read(path), kind, objects, changes))
    return tuple(imported)


def _take(table: _Table, kind: Kind, objects: _Objects, changes: Changes) -> ImportedTable:
    problems, n_before = _Problems(), changes.n_changed
    read = _attributes if kind.record is Attribute else _entries
    entries = list(read(table, kind, objects, problems))
    seen: dict[tuple[str, ...], int] = {}
    for line, entry in entries:
        mark = (entry.global_id, entry.name) if isinstance(entry, Attribute) else (entry.key,)
        if mark[-1] and mark in seen:
            problems.add(line, "key", InputError(say("'{}' stands in line {} already", mark[-1], seen[mark])))
        seen[mark] = line
    for line, entry in () if problems.texts else entries:
        try:
            changes.put(entry)
        except InputError as error:
            problems.add(line, "key", error)
    if problems.texts:
        raise TableError(table.path, tuple(problems.texts))
    return ImportedTable(kind.name, len(table.lines), changes.n_changed - n_before)


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
                raise InputError(say("expected an object of the model, got '{}'", global_id[:40], place="global_id"))
            return global_id
        if not name:
            raise InputError(
                say("expected a GlobalId, or a name in the column 'name', found neither", place="global_id")
            )
        if name in self._ambiguous:
            raise InputError(say("name: several objects have the name '{}'; give the GlobalId", name[:40]))
        if name not in self._by_name:
            raise InputError(say("name: expected the name of an object of the model, got '{}'", name[:40]))
        return self._by_name[name]


def _read(path: Path) -> _Table:
    content = read_input_file(path, TABLE_FILE)
    check_lines(content, MAX_LINES, path)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise InputError(
            say("expected UTF-8, found other bytes; save it as CSV UTF-8", place=f"{path}: line {line}")
        ) from error
    delimiter = ";" if _is_headed(text, ";") and not _is_headed(text, ",") else ","
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, strict=True)
    lines: list[tuple[int, list[str]]] = []
    start = 1
    try:
        for cells in reader:
            if any(cell.strip() for cell in cells):
                if lines and len(cells) != len(lines[0][1]):
                    raise InputError(
                        say(
                            "expected {} cells parted by '{}', found {}",
                            len(lines[0][1]),
                            delimiter,
                            len(cells),
                            place=f"{path}: line {start}",
                        )
                    )
                lines.append((start, cells))
            start = reader.line_num + 1
    except csv.Error as error:
        raise InputError(say("is no CSV ({})", error, place=f"{path}: line {start}")) from error
    if not lines:
        raise InputError(say("the table is empty; expected a line with the names of its columns", place=path))
    head = tuple(unescaped_formula(cell).strip() for cell in lines[0][1])
    repeated = next((name for name in head if head.count(name) > 1), None) if len(set(head)) < len(head) else None
    if repeated is not None:
        raise InputError(say("line 1: the column '{}' occurs twice", repeated[:60], place=path))
    if not any(name in head for name in OBJECT):
        raise InputError(say("line 1: expected a column 'global_id' or 'name', found {}", _listed(head), place=path))
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
    return {name: unescaped_formula(cell) for name, cell in zip(table.head, cells, strict=True)}


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
        raise InputError(
            say("line 1: there is no column '{}'; known are {}", unknown[:60], ", ".join(known), place=table.path)
        )
    required = [f.name for f in fields(kind.record) if f.default is MISSING and f.name != "global_id"]
    missing = next((name for name in required if name not in table.head), None)
    if missing is not None:
        raise InputError(say("line 1: the column '{}' is missing", missing, place=table.path))
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
                    raise InputError(say("expected a value, found none", place=column))
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
        raise InputError(say("line 1: {}", error, place=table.path)) from error
