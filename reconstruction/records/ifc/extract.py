"""What an IFC file says about elements that are objects of ours, as plain values: runs in a process of its own."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Literal

import msgspec

from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.records.book import RecordBook
from reconstruction.records.database import as_json
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

# Records as IFC property sets of ours: what people read stands in the values, what brings a record back beside them.
#
# A property's Description holds its record as JSON. BIM programs show it and keep it.

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
        raise InputError(say("its description is not as it was written ({})", error, place=found.name)) from error


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


MAX_PARTS = 200
"""Parts of an element that are looked at."""

MAX_NESTING = 5

MAX_TEXT = 20_000

LENGTHS = ("IfcLengthMeasure", "IfcPositiveLengthMeasure", "IfcNonNegativeLengthMeasure")
UNITS = {
    "IfcThermalTransmittanceMeasure": "W/m²K",
    "IfcMassMeasure": "kg",
    "IfcPlaneAngleMeasure": "",
    "IfcThermodynamicTemperatureMeasure": "K",
}
"""Of measures whose unit is nearly never another one."""


class Found(msgspec.Struct, frozen=True):
    """A property of an element.

    Parameters
    ----------
    origin
        Whose it is: the element's own, its type's, of a part of it, or of the whole that it is a part of.
    unit
        Of a number; "" where not known.
    """

    set: str
    property: Property
    origin: str
    unit: str = ""


class Element(msgspec.Struct, frozen=True):
    """An element that is an object of ours.

    Parameters
    ----------
    materials
        Names by origin, see `Found`.
    thickness_m
        Of its layers of material, or None.
    """

    global_id: str
    kind: str
    found: tuple[Found, ...]
    materials: dict[str, tuple[str, ...]]
    thickness_m: float | None = None


class IfcProperties(msgspec.Struct, frozen=True):
    """What was read of a file."""

    schema: str
    elements: tuple[Element, ...]


def open_model(path: Path) -> Any:
    """An IFC model.

    Raises
    ------
    InputError
        The file cannot be parsed.
    """
    import ifcopenshell

    try:
        return ifcopenshell.open(str(path))
    except Exception as error:  # the parser raises whatever goes wrong in it
        raise InputError(
            say("this IFC file cannot be read ({}); IFC 2x3, IFC 4 and IFC 4.3 are read", error, place=path)
        ) from error


def extract(path: Path, global_ids: frozenset[str]) -> IfcProperties:
    """Properties and materials of the elements that have one of the GlobalIds.

    Raises
    ------
    InputError
        The file cannot be parsed, or a reference in it leads nowhere.
    """
    model = open_model(path)
    try:
        from ifcopenshell.util.unit import calculate_unit_scale

        unit_m = float(calculate_unit_scale(model))
        products = {
            product.GlobalId: product for product in model.by_type("IfcObject") if product.GlobalId in global_ids
        }
        return IfcProperties(model.schema, tuple(_element(each, unit_m, global_ids) for each in products.values()))
    except (RuntimeError, AttributeError, TypeError, ValueError, KeyError, IndexError) as error:
        raise InputError(say("this IFC file is broken ({}: {})", type(error).__name__, error, place=path)) from error


def _element(product: Any, unit_m: float, known: frozenset[str]) -> Element:
    found: list[Found] = []
    materials: dict[str, tuple[str, ...]] = {}
    for origin, element in _around(product, known):
        found += [Found(name, *each[:1], origin, each[1]) for name, each in _properties(element, unit_m)]
        names = _materials(element)
        if names and origin not in materials:
            materials[origin] = names
    return Element(product.GlobalId, product.is_a(), tuple(found), materials, _layers_m(product, unit_m))


def _around(product: Any, known: frozenset[str]) -> Iterator[tuple[str, Any]]:
    """An element, its type, its parts with their types, and the wholes that it is a part of.

    Parts and wholes that are objects themselves speak for themselves alone.
    """
    yield from _with_type("own", product)
    parts = [part for relation in getattr(product, "IsDecomposedBy", ()) for part in relation.RelatedObjects]
    for part in [part for part in parts if part.GlobalId not in known][:MAX_PARTS]:
        yield from _with_type("part", part)
    whole = product
    for _ in range(MAX_NESTING):
        wholes = [relation.RelatingObject for relation in getattr(whole, "Decomposes", ())]
        if not wholes or not wholes[0].is_a("IfcElement"):
            return
        whole = wholes[0]
        if whole.GlobalId in known:
            continue
        yield from _with_type("whole", whole)


def _with_type(origin: str, element: Any) -> Iterator[tuple[str, Any]]:
    from ifcopenshell.util.element import get_type

    yield origin, element
    kind = get_type(element)
    if kind is not None and kind != element:
        yield ("type" if origin == "own" else origin), kind


def _properties(element: Any, unit_m: float) -> Iterator[tuple[str, tuple[Property, str]]]:
    """Properties of an element's own sets, or of a type's, with the unit of each."""
    relations = [r for r in getattr(element, "IsDefinedBy", ()) if r.is_a("IfcRelDefinesByProperties")]
    sets = [relation.RelatingPropertyDefinition for relation in relations]
    sets += list(getattr(element, "HasPropertySets", None) or ())
    for each in sets:
        if each.is_a("IfcPropertySet") and each.Name:
            for found in each.HasProperties or ():
                value = _value(found, unit_m)
                if value is not None and found.Name:
                    content, kind, unit = value
                    # By its place: IFC 4.3 calls the description a specification.
                    description = str(found[1] or "")[:MAX_TEXT]
                    yield str(each.Name), (Property(str(found.Name), content, kind, description), unit)


def _value(found: Any, unit_m: float) -> tuple[str | float | bool, PropertyKind, str] | None:
    """Value, kind and unit of a property; None where it has none that is plain."""
    if found.is_a("IfcPropertyEnumeratedValue") and found.EnumerationValues:
        return ", ".join(str(value.wrappedValue) for value in found.EnumerationValues)[:MAX_TEXT], "text", ""
    if found.is_a("IfcPropertyReferenceValue"):
        day = found.PropertyReference
        if day is not None and day.is_a("IfcCalendarDate"):  # of IFC 2x3
            return f"{day.YearComponent:04d}-{day.MonthComponent:02d}-{day.DayComponent:02d}", "date", ""
        return None
    if not found.is_a("IfcPropertySingleValue") or found.NominalValue is None:
        return None
    value, measure = found.NominalValue.wrappedValue, found.NominalValue.is_a()
    if isinstance(value, bool):
        return value, "yes/no", ""
    if isinstance(value, str):
        is_date = measure in ("IfcDate", "IfcDateTime")
        return (value[:MAX_TEXT], "date" if is_date else "text", "") if value.strip() else None
    if isinstance(value, (int, float)) and math.isfinite(value):
        if measure in LENGTHS and found.Unit is None:
            return float(value) * unit_m, "number", "m"
        return float(value), "number", UNITS.get(measure, "") if found.Unit is None else ""
    return None


def _materials(element: Any) -> tuple[str, ...]:
    from ifcopenshell.util.element import get_materials

    names = [getattr(material, "Name", None) for material in get_materials(element, should_inherit=False)]
    return tuple(dict.fromkeys(str(name) for name in names if name))


def _layers_m(product: Any, unit_m: float) -> float | None:
    """Thickness of all layers of material."""
    from ifcopenshell.util.element import get_material

    found = get_material(product, should_skip_usage=True)
    if found is None or not found.is_a("IfcMaterialLayerSet"):
        return None
    total = sum(float(layer.LayerThickness) for layer in found.MaterialLayers) * unit_m
    return total if math.isfinite(total) and total > 0.0 else None
