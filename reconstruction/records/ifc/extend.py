"""Property sets of ours into an IFC file: lines for its end, and lines that go. Runs in a process of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import msgspec

from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.records.global_ids import global_id_of
from reconstruction.records.ifc.extract import open_model
from reconstruction.records.ifc.sets import OUR_SETS, Property, PropertySet


class Extension(msgspec.Struct, frozen=True):
    """What makes a file with our sets of one without, or with older ones.

    Parameters
    ----------
    lines
        New instances, for the end of the data.
    replaced
        Instances that change, by their number; "" takes one out.
    n_instances
        That the file has then.
    extended
        GlobalIds that got property sets.
    missing
        GlobalIds with records that no element has.
    """

    lines: tuple[str, ...]
    replaced: dict[int, str]
    n_instances: int
    extended: tuple[str, ...]
    missing: tuple[str, ...]


def extension(path: Path, sets: dict[str, tuple[PropertySet, ...]], known: frozenset[str]) -> Extension:
    """Lines that bring property sets to the elements with these GlobalIds; older ones of ours go.

    Parameters
    ----------
    known
        GlobalIds of all objects, also of those without records by now.

    Raises
    ------
    InputError
        The file cannot be parsed, or a reference in it leads nowhere.
    """
    model = open_model(path)
    try:
        elements = {each.GlobalId: each for each in model.by_type("IfcObject") if each.GlobalId in known}
        replaced = _without_ours(model, frozenset(elements))
        lines: list[str] = []
        for global_id, element in elements.items():
            for each in sets.get(global_id, ()):
                lines += [new.to_string() for new in added_set(model, element, each)]
        missing = tuple(global_id for global_id in sets if global_id not in elements)
        extended = tuple(global_id for global_id in elements if sets.get(global_id))
        return Extension(tuple(f"{line};" for line in lines), replaced, len(list(model)), extended, missing)
    except (RuntimeError, AttributeError, TypeError, ValueError, KeyError, IndexError) as error:
        raise InputError(say("this IFC file is broken ({}: {})", type(error).__name__, error, place=path)) from error


def added_set(model: Any, element: Any, wanted: PropertySet) -> list[Any]:
    """New instances that give an element a property set; their GlobalIds follow from the element's."""
    properties = [_property(model, each) for each in wanted.properties]
    key, history = f"{element.GlobalId} {wanted.name}", element.OwnerHistory
    added = model.create_entity(
        "IfcPropertySet",
        GlobalId=global_id_of(key, "set"),
        OwnerHistory=history,
        Name=wanted.name,
        HasProperties=properties,
    )
    relation = model.create_entity(
        "IfcRelDefinesByProperties",
        GlobalId=global_id_of(key, "relation"),
        OwnerHistory=history,
        RelatedObjects=[element],
        RelatingPropertyDefinition=added,
    )
    return [*properties, added, relation]


def _property(model: Any, wanted: Property) -> Any:
    # By their places: IFC 4.3 calls the description a specification.
    values = (wanted.name, wanted.description or None, _value(model, wanted))
    return model.create_entity("IfcPropertySingleValue", *values)


def _value(model: Any, wanted: Property) -> Any:
    if wanted.kind == "yes/no":
        return model.create_entity("IfcBoolean", bool(wanted.value))
    if wanted.kind == "number":
        return model.create_entity("IfcReal", float(wanted.value))
    # IFC 2x3 knows no plain dates.
    kind = "IfcDate" if wanted.kind == "date" and model.schema != "IFC2X3" else "IfcText"
    return model.create_entity(kind, str(wanted.value))


def _without_ours(model: Any, elements: frozenset[str]) -> dict[int, str]:
    """Take older property sets of ours out of a model; the lines that go or change."""
    replaced: dict[int, str] = {}
    for each in [found for found in model.by_type("IfcPropertySet") if found.Name in OUR_SETS]:
        is_used = False
        for relation in model.get_inverse(each):
            others = (
                [other for other in relation.RelatedObjects if other.GlobalId not in elements]
                if relation.is_a("IfcRelDefinesByProperties")
                else [relation]
            )
            if not others:
                replaced[relation.id()] = ""
                model.remove(relation)
            elif relation.is_a("IfcRelDefinesByProperties") and len(others) < len(relation.RelatedObjects):
                relation.RelatedObjects = others
                replaced[relation.id()] = f"{relation.to_string()};"
            is_used = is_used or bool(others)
        if not is_used:
            properties = [found for found in each.HasProperties if model.get_total_inverses(found) == 1]
            replaced |= dict.fromkeys((each.id(), *(found.id() for found in properties)), "")
            for gone in (each, *properties):
                model.remove(gone)
    return replaced
