"""Property sets of an IFC file into a book: attributes, inspections, and what an export of ours brought there."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from planning.base.errors import InputError
from planning.base.messages import about
from planning.base.progress import QUIET, Monitor
from planning.base.step_physical_file import real_name
from reconstruction.records.book import RecordBook
from reconstruction.records.entries import Attribute, AttributeType, Entry, Inspection
from reconstruction.records.global_ids import global_id_of
from reconstruction.records.ifc.extract import Element, Found
from reconstruction.records.ifc.process import read_properties
from reconstruction.records.ifc.sets import (
    OUR_SETS,
    SET_OF,
    Property,
    entry_of_property,
    iso_date,
    latest_inspection,
    value_as,
)

NAMED: dict[tuple[str, str], tuple[str, AttributeType]] = {
    ("Pset_ManufacturerTypeInformation", "Manufacturer"): ("maker", "text"),
    ("Pset_ManufacturerTypeInformation", "ModelLabel"): ("product", "text"),
    ("Pset_ManufacturerOccurrence", "InstallationDate"): ("installed_on", "date"),
    ("Pset_Warranty", "WarrantyEndDate"): ("warranty_until", "date"),
}
"""Properties that are standard attributes of ours, buildingSMART's names first."""

INSPECTION_SETS = ("Pset_Condition",)

SETS = frozenset(
    {
        "Pset_PlateCommon",
        "Pset_WindowCommon",
        "Pset_CurtainWallCommon",
        "Pset_DoorWindowGlazingType",
        "Pset_ManufacturerTypeInformation",
        "Pset_ManufacturerOccurrence",
        "Pset_Warranty",
    }
)
"""Sets whose other properties become free attributes, `Pset_WindowCommon.FireRating`."""

FROM_WHOLE = ("material", "maker", "product", "installed_on", "warranty_until")
"""What holds for a curtain wall holds for its panes, unless they say otherwise."""

ORIGINS = ("own", "type", "part", "whole")
"""Whose word counts more."""

MAX_NOTES = 20


@dataclass(frozen=True, slots=True)
class IfcTaken:
    """What came of an IFC file: objects found in it, records added or changed, and what was left out."""

    n_objects: int
    n_changed: int
    notes: tuple[str, ...]


def read_ifc_records(book: RecordBook, path: Path, all_sets: bool = False, monitor: Monitor = QUIET) -> IfcTaken:
    """Take over what an IFC file says about the objects of a book; single values that do not fit are left out.

    Parameters
    ----------
    all_sets
        Also property sets of BIM programs' own, as free attributes.

    Raises
    ------
    InputError
        The file cannot be read, or the records cannot be written.
    """
    names = {row.global_id: row.name for row in book.objects(with_absent=True)}
    read = read_properties(path, frozenset(names), monitor)
    notes: list[str] = []
    with book.changing(f"import of {path.name}"[:200]) as changes:
        for element in read.elements:
            for entry in entries_of_element(element, names[element.global_id], all_sets, notes):
                try:
                    changes.put(entry)
                except InputError as error:
                    notes.append(about(names[element.global_id], error))
        n_changed = changes.n_changed
    if not read.elements:
        notes.append(f"none of the {len(names)} objects has its GlobalId in this file")
    more = len(notes) - MAX_NOTES
    shown = (*notes[:MAX_NOTES], f"{more} more values were left out") if more > 0 else tuple(notes)
    return IfcTaken(len(read.elements), n_changed, shown)


def entries_of_element(element: Element, name: str, all_sets: bool, notes: list[str]) -> Iterator[Entry]:
    """Entries that an element stands for; to `notes` comes what no entry can hold."""
    yield from _ours(element, name, notes)
    attributes: dict[str, Attribute] = {}
    for found in sorted(element.found, key=lambda found: ORIGINS.index(found.origin)):
        if found.set in OUR_SETS or found.set in INSPECTION_SETS or not (all_sets or found.set in SETS):
            continue
        try:
            attribute = _attribute(found, element.global_id)
        except InputError as error:
            notes.append(f"{name}: {found.set}.{found.property.name}: {error}")
            continue
        if attribute is not None and (found.origin != "whole" or attribute.name in FROM_WHOLE):
            attributes.setdefault(attribute.name, attribute)
    # A property of ours says the same, and more exactly.
    ours = {found.property.name for found in element.found if found.set == SET_OF[Attribute] and found.origin == "own"}
    for attribute in (*_material(element, name, notes), *attributes.values()):
        if attribute.name not in ours:
            yield attribute
    yield from _condition(element, name, notes)


def _ours(element: Element, name: str, notes: list[str]) -> Iterator[Entry]:
    for record, set_name in SET_OF.items():
        properties = {
            found.property.name: found.property
            for found in element.found
            if found.set == set_name and found.origin == "own"
        }
        n_found = 0
        for each in properties.values():
            try:
                entry = entry_of_property(each, record, element.global_id)
            except InputError as error:
                notes.append(f"{name}: {set_name}.{error}")
                continue
            if entry is not None:
                n_found += 1
                yield entry
        if record is Inspection and not n_found:
            yield from _latest(properties, element.global_id, name, notes)


def _latest(properties: Mapping[str, Property], global_id: str, name: str, notes: list[str]) -> Iterator[Entry]:
    """The latest inspection, where another program has left no more of our set."""
    try:
        found = latest_inspection(properties, global_id, global_id_of(global_id, SET_OF[Inspection]))
    except InputError as error:
        notes.append(f"{name}: {SET_OF[Inspection]}: {error}")
        return
    if found is not None:
        yield found


def _attribute(found: Found, global_id: str) -> Attribute | None:
    """A property as an attribute; None where its value is a placeholder of the program that wrote the file."""
    each = found.property
    named = NAMED.get((found.set, each.name))
    if named is not None and named[1] == "text" and not real_name(each.value):
        return None
    if named is not None:
        return Attribute(global_id, named[0], value_as(each.value, named[1]), named[1])
    name = f"{found.set}.{each.name}"[:100].translate(str.maketrans('[]();"', "      ")).strip()
    return Attribute(global_id, " ".join(name.split()), value_as(each.value, each.kind), each.kind, found.unit)


def _material(element: Element, name: str, notes: list[str]) -> Iterator[Attribute]:
    named = (tuple(filter(real_name, element.materials.get(origin, ()))) for origin in ORIGINS)
    found = next(filter(None, named), ())
    try:
        if found:
            yield Attribute(element.global_id, "material", ", ".join(found))
        if element.thickness_m is not None:
            yield Attribute(element.global_id, "thickness", round(1000.0 * element.thickness_m, 3), "number", "mm")
    except InputError as error:
        notes.append(about(name, error))


def _condition(element: Element, name: str, notes: list[str]) -> Iterator[Inspection]:
    """The assessment of a condition is an inspection; the same one read again is the same record."""
    values = {
        found.property.name: str(found.property.value)
        for found in _by_origin(element.found)
        if found.set in INSPECTION_SETS and found.origin in ("own", "type")
    }
    date = iso_date(values.get("AssessmentDate", ""))
    if not date:
        return
    try:
        yield Inspection(
            element.global_id,
            date,
            method=values.get("AssessmentMethod", ""),
            result=values.get("AssessmentCondition", ""),
            note=values.get("AssessmentDescription", ""),
            key=global_id_of(element.global_id, f"Pset_Condition {date}"),
        )
    except InputError as error:
        notes.append(f"{name}: Pset_Condition: {error}")


def _by_origin(found: Iterable[Found]) -> list[Found]:
    """Those that count most last."""
    return sorted(found, key=lambda each: -ORIGINS.index(each.origin))
