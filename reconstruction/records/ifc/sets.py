"""Records as IFC property sets of ours: what people read stands in the values, what brings a record back beside them.

A property's Description holds its record as JSON. BIM programs show it and keep it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Literal

import msgspec

from planning.base.errors import InputError
from reconstruction.records.book import RecordBook
from reconstruction.records.entries import (
    KINDS,
    Attribute,
    AttributeType,
    Defect,
    Document,
    Entry,
    Inspection,
    Maintenance,
    Value,
)
from reconstruction.records.rows import as_json

SET_OF = {
    Attribute: "Pset_ReflightAttributes",
    Inspection: "Pset_ReflightInspection",
    Defect: "Pset_ReflightDefects",
    Maintenance: "Pset_ReflightMaintenance",
    Document: "Pset_ReflightDocuments",
}
OUR_SETS = frozenset(SET_OF.values())

PropertyKind = Literal["text", "number", "date", "yes/no"]

LATEST = ("LatestDate", "LatestInspector", "LatestMethod", "LatestResult", "LatestNote")
"""Of the latest inspection, each a property of its own, before the properties of all of them."""


class Property(msgspec.Struct, frozen=True):
    """One property: a name, a value, and a description that may be empty."""

    name: str
    value: str | float | bool
    kind: PropertyKind = "text"
    description: str = ""


class PropertySet(msgspec.Struct, frozen=True):
    """Properties of one name."""

    name: str
    properties: tuple[Property, ...]


def property_sets(book: RecordBook) -> dict[str, tuple[PropertySet, ...]]:
    """Property sets of all objects that have records, by GlobalId."""
    by_object: dict[str, list[Entry]] = {}
    for kind in KINDS:
        for entry in book.entries(kind.record):
            by_object.setdefault(entry.global_id, []).append(entry)
    return {global_id: sets_of(entries) for global_id, entries in by_object.items()}


def sets_of(entries: Iterable[Entry]) -> tuple[PropertySet, ...]:
    """Property sets of one object's entries."""
    by_set: dict[str, list[Property]] = {}
    entries = list(entries)
    inspections = sorted((entry for entry in entries if isinstance(entry, Inspection)), key=lambda entry: entry.date)
    if inspections:
        by_set[SET_OF[Inspection]] = _latest(inspections[-1])
    for entry in entries:
        properties = by_set.setdefault(SET_OF[type(entry)], [])
        properties.append(_property(entry, len(properties) + 1))
    return tuple(PropertySet(name, tuple(found)) for name, found in by_set.items())


def entry_of_property(found: Property, record: type[Entry], global_id: str) -> Entry | None:
    """The entry that a property of ours stands for; None where it is one of `LATEST` or has lost its description.

    Raises
    ------
    InputError
        Its description holds what no entry may hold.
    """
    if not found.description.startswith("{"):
        return None
    try:
        content = msgspec.json.decode(found.description, type=dict[str, object])
        content["global_id"] = global_id
        if record is Attribute:
            content["value"] = found.value  # it may have been changed in a BIM program
        return msgspec.convert(content, record)
    except (msgspec.MsgspecError, RecursionError) as error:
        raise InputError(f"{found.name}: its description is not as it was written ({error})") from error


def latest_inspection(properties: Mapping[str, Property], global_id: str, key: str) -> Inspection | None:
    """Inspection from the properties of the latest one alone; None without its date.

    Raises
    ------
    InputError
        The date is none.
    """
    date, inspector, method, result, note = (
        str(properties[name].value) if name in properties else "" for name in LATEST
    )
    return Inspection(global_id, date, inspector, method, result, note, key) if date else None


def iso_date(text: str) -> str:
    """Date of a text that begins with one, such as a time stamp; other texts as they are."""
    found = re.match(r"[0-9]{4}-[0-9]{2}-[0-9]{2}(?=T|$)", text.strip())
    return found[0] if found else text.strip()


def _latest(entry: Inspection) -> list[Property]:
    values = (entry.date, entry.inspector, entry.method, entry.result, entry.note)
    named = zip(LATEST, values, strict=True)
    return [Property(name, value, "date" if name == "LatestDate" else "text") for name, value in named if value]


def _property(entry: Entry, number: int) -> Property:
    if isinstance(entry, Attribute):
        return Property(entry.name, entry.value, entry.type, as_json(entry))
    return Property(f"{type(entry).__name__} {number:04d}", _words(entry), "text", as_json(entry))


def _words(entry: Entry) -> str:
    """What people read of an entry."""
    if isinstance(entry, Inspection):
        parts = [entry.date, entry.inspector, entry.method, entry.result, entry.note]
    elif isinstance(entry, Defect):
        place = "" if entry.u is None else f"at u {entry.u:.3f}, v {entry.v:.3f}"
        state = f"{entry.status} {entry.repaired_on or ''}".strip()
        picture = f"picture {entry.picture}" if entry.picture else ""
        parts = [entry.kind, f"severity {entry.severity}", f"found {entry.found_on}", state, place, picture, entry.note]
    elif isinstance(entry, Maintenance):
        cost = "" if entry.cost is None else f"{entry.cost:g} {entry.currency}"
        due = f"next {entry.next_due}" if entry.next_due else ""
        parts = [entry.date, entry.work, entry.done_by, cost, due, entry.note]
    else:
        assert isinstance(entry, Document)
        parts = [entry.title, entry.kind, entry.place]
    return "; ".join(part for part in parts if part)


def value_as(value: Value, kind: AttributeType) -> Value:
    """Value of an IFC property as an attribute of a type takes it; what does not fit is refused by the attribute."""
    if kind == "date" and isinstance(value, str):
        return iso_date(value)
    if kind == "text" and not isinstance(value, str):
        return ("yes" if value else "no") if isinstance(value, bool) else f"{value:g}"
    return value
