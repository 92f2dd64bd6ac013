"""What the window asks: latest inspections, worst defects, one attribute of all objects, objects by filter, search."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.searching import folded
from reconstruction.records.book import RecordBook
from reconstruction.records.changes import FIELD_BITS, KIND_BITS, OBJECT_CODE, decoded, query_of
from reconstruction.records.database import OBJECT_COLUMNS, OBJECTS, entry_of, joined, object_of, selected
from reconstruction.records.entries import (
    COMPUTED,
    KIND_NAMED,
    KINDS,
    TYPES,
    AttributeType,
    Defect,
    Inspection,
    Kind,
    Value,
)
from reconstruction.records.limits import MAX_TEXT, check_date, check_number, check_text
from reconstruction.records.objects import Layer, ObjectRow

MAX_HITS = 1000


@dataclass(frozen=True, slots=True)
class AttributeValue:
    """Value of an attribute of one object."""

    value: Value
    unit: str


@dataclass(frozen=True, slots=True)
class Hit:
    """A text that was found.

    Parameters
    ----------
    kind, field
        Such as `defect` and `note`; `object` and `name` for the name of an object.
    key
        Of the entry; "" for an object.
    text
        All of the field, as it is stored: not to be written into HTML as it is.
    rank
        Less is better.
    """

    global_id: str
    name: str
    kind: str
    field: str
    key: str
    text: str
    rank: float


@dataclass(frozen=True, slots=True)
class Change:
    """One change of one row.

    Parameters
    ----------
    number
        Of all that were changed together.
    undoes
        Number of the changes that these took back, or None.
    old, new
        Fields before and after; None where there was, or is, no row.
    """

    number: int
    at_utc: str
    who: str
    what: str
    undoes: int | None
    global_id: str
    name: str
    kind: str
    old: dict[str, Any] | None
    new: dict[str, Any] | None


@dataclass(frozen=True, slots=True)
class ObjectFilter:
    """Which objects are wanted; what is None or left out does not matter.

    Parameters
    ----------
    parent
        GlobalId.
    name_part
        Text in the name, small and capital letters alike.
    attribute, value
        Name of an attribute that they have, and its value.
    min_open_severity
        They have an open defect of at least this severity.
    not_inspected_since
        Date, `2026-03-31`: their latest inspection was before it, or never.
    with_absent
        Also objects that the model lacks by now.
    """

    layer: Layer | None = None
    parent: str | None = None
    name_part: str = ""
    attribute: str | None = None
    value: Value | None = None
    min_open_severity: int | None = None
    not_inspected_since: str | None = None
    with_absent: bool = False


def latest_inspections(book: RecordBook) -> dict[str, Inspection]:
    """The latest inspection of each object that has one, by GlobalId."""
    return _one_each(book, "inspection", "", "date DESC, id DESC")


def worst_open_defects(book: RecordBook) -> dict[str, Defect]:
    """The most severe open defect of each object that has one, by GlobalId; of equal ones the oldest."""
    return _one_each(book, "defect", "AND status = 'open'", "severity DESC, found_on, id")


def inspection_dates(book: RecordBook) -> dict[str, str]:
    """Date of the latest inspection of each object that has one, by GlobalId."""
    sql = "SELECT o.global_id, max(i.date) FROM inspections i JOIN objects o ON o.id = i.object_id GROUP BY i.object_id"
    found = {row[0]: str(row[1]) for row in book.database.rows(sql)}
    for date in set(found.values()):
        _ask(book, "inspections", check_date, date, "date")
    return found


def open_severities(book: RecordBook) -> dict[str, int]:
    """Severity of the worst open defect of each object that has one, by GlobalId."""
    sql = (
        "SELECT o.global_id, max(d.severity) FROM defects d JOIN objects o ON o.id = d.object_id "
        "WHERE d.status = 'open' GROUP BY d.object_id"
    )
    found = {row[0]: int(row[1]) for row in book.database.rows(sql)}
    for severity in set(found.values()):
        _ask(book, "defects", check_number, severity, "severity", 1, 5)
    return found


def _ask(book: RecordBook, table: str, check: Callable[..., None], *values: Any) -> None:
    """Refuse a value of the file that a check refuses."""
    try:
        check(*values)
    except InputError as error:
        raise InputError(say("{}; the file is damaged", error, place=f"{book.path}: {table}")) from error


def attributes_by_object(book: RecordBook) -> dict[str, dict[str, Value]]:
    """All attributes of all objects by GlobalId and name, with `last_inspection` and `worst_open_severity`.

    Plain values for files of other formats; objects that have none are left out.
    """
    found: dict[str, dict[str, Value]] = {}
    with book.database.snapshot():
        names = [*attribute_names(book)]
        columns: list[tuple[str, dict[str, Value]]] = [
            (name, {key: each.value for key, each in attribute_values(book, name).items()}) for name in names
        ]
        columns.append(("last_inspection", {**inspection_dates(book)}))
        columns.append(("worst_open_severity", {**open_severities(book)}))
    for name, values in columns:
        for global_id, value in values.items():
            found.setdefault(global_id, {})[name] = value
    return found


def _one_each(book: RecordBook, name: str, where: str, order: str) -> dict[str, Any]:
    kind = KIND_NAMED[name]
    best = f"SELECT id FROM {kind.table} WHERE object_id = o.id {where} ORDER BY {order} LIMIT 1"
    sql = f"SELECT {selected(kind)} FROM objects o JOIN {kind.table} e ON e.id = ({best}) ORDER BY o.id"
    return {row[1]: entry_of(row, kind, book.database) for row in book.database.rows(sql)}


def attribute_names(book: RecordBook) -> tuple[str, ...]:
    """Names of all attributes that some object has, and of the computed ones."""
    rows = book.database.rows("SELECT DISTINCT name FROM attributes ORDER BY name")
    return (*COMPUTED, *(str(row[0]) for row in rows))


def attribute_type(book: RecordBook, name: str) -> AttributeType | None:
    """Type of an attribute, of the first object that has it; None where none has."""
    rows = book.database.rows("SELECT type FROM attributes WHERE name = ? ORDER BY object_id LIMIT 1", (name,))
    return next((kind for kind in TYPES if rows and rows[0][0] == kind), None)


def attribute_values(book: RecordBook, name: str) -> dict[str, AttributeValue]:
    """Values of one attribute, by GlobalId of the objects that have it: what colours panes."""
    if name in COMPUTED:
        column = f"{name}_m"
        rows = book.database.rows(f"SELECT global_id, {column} FROM objects WHERE {column} IS NOT NULL ORDER BY id")
        return {row[0]: AttributeValue(_checked(book, name, row[1], "number"), "m") for row in rows}
    sql = (
        "SELECT o.global_id, a.value, a.type, a.unit FROM attributes a JOIN objects o ON o.id = a.object_id "
        "WHERE a.name = ? ORDER BY a.object_id"
    )
    rows = book.database.rows(sql, (name,))
    return {row[0]: AttributeValue(_checked(book, name, row[1], row[2]), row[3]) for row in rows}


def _checked(book: RecordBook, name: str, value: Any, kind: str) -> Value:
    """Value of a row, where the file holds one that an attribute may have."""
    if kind == "number":
        _ask(book, "attributes", check_number, value, name)
        return float(value)
    if kind == "yes/no" and value in (0, 1):
        return bool(value)
    _ask(book, "attributes", check_text, value, name, MAX_TEXT)
    return str(value)


def find_objects(book: RecordBook, object_filter: ObjectFilter) -> tuple[ObjectRow, ...]:
    """Objects that a filter lets through, in the order of the model.

    Raises
    ------
    InputError
        `not_inspected_since` is no date.
    """
    wheres, values = ["(o.is_present OR ?)"], [object_filter.with_absent]
    for sql, value in _conditions(object_filter):
        wheres.append(sql)
        values += value
    sql = f"SELECT {OBJECT_COLUMNS} FROM {OBJECTS} WHERE {' AND '.join(wheres)} ORDER BY o.id"
    objects = (object_of(row, book.database) for row in book.database.rows(sql, values))
    # SQLite knows the case of ASCII letters only.
    part = folded(object_filter.name_part)
    return tuple(each for each in objects if part in folded(each.name))


def _conditions(object_filter: ObjectFilter) -> list[tuple[str, list[Any]]]:
    found: list[tuple[str, list[Any]]] = []
    if object_filter.layer is not None:
        found.append(("o.layer = ?", [object_filter.layer]))
    if object_filter.parent is not None:
        found.append(("p.global_id = ?", [object_filter.parent]))
    if object_filter.attribute in COMPUTED:
        found.append(
            (
                f"(? IS NULL OR o.{object_filter.attribute}_m = ?) AND o.{object_filter.attribute}_m NOTNULL",
                [object_filter.value] * 2,
            )
        )
    elif object_filter.attribute is not None:
        sql = "SELECT 1 FROM attributes a WHERE a.object_id = o.id AND a.name = ? AND (? IS NULL OR a.value = ?)"
        found.append((f"EXISTS ({sql})", [object_filter.attribute, object_filter.value, object_filter.value]))
    if object_filter.min_open_severity is not None:
        sql = "SELECT 1 FROM defects d WHERE d.object_id = o.id AND d.status = 'open' AND d.severity >= ?"
        found.append((f"EXISTS ({sql})", [object_filter.min_open_severity]))
    if object_filter.not_inspected_since is not None:
        check_date(object_filter.not_inspected_since, "not_inspected_since")
        sql = "SELECT 1 FROM inspections i WHERE i.object_id = o.id AND i.date >= ?"
        found.append((f"NOT EXISTS ({sql})", [object_filter.not_inspected_since]))
    return found


def search(book: RecordBook, words: str, limit: int = 50) -> tuple[Hit, ...]:
    """Texts that hold all the words, the best first; the words may be anything at all."""
    query = query_of(words)
    if query is None:
        return ()
    sql = "SELECT rowid, rank FROM search WHERE search MATCH ? ORDER BY rank, rowid LIMIT ?"
    found: dict[int, list[tuple[int, int, float]]] = {}
    with book.database.snapshot():
        for number, rank in book.database.rows(sql, (query, max(1, min(limit, MAX_HITS)))):
            code, index = (number >> FIELD_BITS) & ((1 << KIND_BITS) - 1), number & ((1 << FIELD_BITS) - 1)
            found.setdefault(code, []).append((number >> (KIND_BITS + FIELD_BITS), index, float(rank)))
        hits = [hit for code, places in found.items() for hit in _hits(book, code, places)]
    return tuple(sorted(hits, key=lambda hit: (hit.rank, hit.name, hit.kind, hit.key, hit.field)))


def _hits(book: RecordBook, code: int, places: list[tuple[int, int, float]]) -> list[Hit]:
    ids = sorted({row_id for row_id, _, _ in places})
    marks = ", ".join("?" * len(ids))
    if code == OBJECT_CODE:
        rows = book.database.rows(f"SELECT id, global_id, name FROM objects WHERE id IN ({marks})", ids)
        names = {row[0]: row for row in rows}
        return [
            Hit(names[i][1], names[i][2], "object", "name", "", names[i][2], rank)
            for i, _, rank in places
            if i in names
        ]
    kind = next((kind for kind in KINDS if kind.code == code), None)
    if kind is None:
        raise InputError(say("the search index is damaged; take a copy of the file back", place=book.path))
    sql = f"SELECT {selected(kind)}, o.name FROM {joined(kind)} WHERE e.id IN ({marks})"
    entries = {row[0]: (entry_of(row[:-1], kind, book.database), str(row[-1])) for row in book.database.rows(sql, ids)}
    return [
        _hit(kind, *entries[i], index, rank) for i, index, rank in places if i in entries and index < len(kind.texts)
    ]


def _hit(kind: Kind, entry: Any, name: str, index: int, rank: float) -> Hit:
    field = kind.texts[index]
    return Hit(entry.global_id, name, kind.name, field, entry.key, str(getattr(entry, field)), rank)


def history(book: RecordBook, global_id: str | None = None, limit: int = 100) -> tuple[Change, ...]:
    """The last changes, newest first, of one object or of all."""
    where, values = ("", [limit]) if global_id is None else ("WHERE o.global_id = ?", [global_id, limit])
    sql = (
        "SELECT s.id, s.at_utc, s.who, s.what, s.undoes, o.global_id, o.name, c.kind, c.old, c.new FROM changes c "
        f"JOIN change_sets s ON s.id = c.change_set JOIN objects o ON o.id = c.object_id {where} "
        "ORDER BY c.id DESC LIMIT ?"
    )
    rows = book.database.rows(sql, values)
    return tuple(Change(*row[:8], *(None if text is None else decoded(text) for text in row[8:])) for row in rows)
