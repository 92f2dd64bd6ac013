"""Property sets of an IFC file into a book: attributes, inspections, and what an export of ours brought there."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import msgspec

from planning.base.errors import InputError
from planning.base.files import read_input_file
from planning.base.json_file import check_output, encoded, write_atomically
from planning.base.messages import about, glue, packed, say, unpacked
from planning.base.progress import QUIET, Monitor
from planning.base.step_physical_file import END, IFC_FILE, check_ends, real_name
from reconstruction.records.book import RecordBook
from reconstruction.records.entries import Attribute, AttributeType, Entry, Inspection, global_id_of
from reconstruction.records.ifc.extract import (
    OUR_SETS,
    SET_OF,
    Element,
    Found,
    IfcProperties,
    Property,
    PropertySet,
    entry_of_property,
    extract,
    iso_date,
    latest_inspection,
    open_model,
    value_as,
)
from reconstruction.records.ifc.new import Extension, extension

# IfcOpenShell in a process of its own: a hostile file may crash it, but not the program.
#
# `python -m reconstruction.records.ifc.importing TASK FILE FOLDER` reads `wanted.json` in the folder and leaves
# `result.json` and a copy of the file, or `refused.json` there. What IfcOpenShell prints stays in that process.

# The text of a STEP file (ISO 10303-21): instances taken out, exchanged and added; all other bytes stay.

# Texts and comments are passed over whole: semicolons in them end nothing.
_TOKEN = re.compile(rb"'[^']*'|/\*.*?\*/|;", re.DOTALL)
_INSTANCE = re.compile(rb"(?:\s|/\*.*?\*/)*#([0-9]+)\s*=", re.DOTALL)


def edited(content: bytes, lines: Sequence[str], replaced: Mapping[int, str]) -> bytes:
    """Text with new instances at the end of its data.

    Parameters
    ----------
    lines
        New instances.
    replaced
        New text of instances, by their number; "" takes one out.

    Raises
    ------
    InputError
        There is no end of the data, or an instance to be replaced is not there.
    """
    end = content.rfind(b"ENDSEC", 0, content.rfind(END))
    if end < 0:
        raise InputError(say("the data of the file do not end (ENDSEC is missing)"))
    line_end = b"\r\n" if b"\r\n" in content[:2000] else b"\n"
    parts, position = [], 0
    for start, stop, number in _statements(content, end) if replaced else ():
        if number in replaced:
            text = replaced[number].encode("ascii")
            parts += [content[position:start], text]
            position = stop if text else _after_line(content, stop)
    if len(parts) != 2 * len(replaced):
        raise InputError(
            say("instances of the file that are to be replaced stand in it in a way that is not understood")
        )
    added = b"".join(line.encode("ascii") + line_end for line in lines)
    return b"".join((*parts, content[position:end], added, content[end:]))


def _after_line(content: bytes, stop: int) -> int:
    """The place after the line end that follows, if one follows at once."""
    for line_end in (b"\r\n", b"\n"):
        if content.startswith(line_end, stop):
            return stop + len(line_end)
    return stop


def _statements(content: bytes, end: int) -> list[tuple[int, int, int]]:
    """Start, end and number of all instances before a place."""
    found, start = [], 0
    for token in _TOKEN.finditer(content, 0, end):
        if token[0] != b";":
            continue
        instance = _INSTANCE.match(content, start, token.end())
        if instance is not None:
            found.append((instance.start(1) - 1, token.end(), int(instance[1])))
        start = token.end()
    return found


COPY = "copy.ifc"

POLL_S = 0.1
"""Time between two looks at whether the user has cancelled."""

EXIT_REFUSED = 3

Result = TypeVar("Result")


class _Sets(msgspec.Struct, frozen=True):
    sets: dict[str, tuple[PropertySet, ...]]
    known: frozenset[str]


def read_properties(path: Path, global_ids: frozenset[str], monitor: Monitor = QUIET) -> IfcProperties:
    """Properties of the elements with these GlobalIds, see `extract`.

    Raises
    ------
    InputError
        The file is wrong, or so broken that its reader died of it.
    """
    check_ends(path)
    with tempfile.TemporaryDirectory(prefix="reflight-ifc-") as folder:
        return _run("read", path, Path(folder), encoded(global_ids), IfcProperties, monitor)


def extend_copy(
    path: Path,
    out: Path,
    sets: dict[str, tuple[PropertySet, ...]],
    known: frozenset[str],
    monitor: Monitor = QUIET,
) -> Extension:
    """Write a copy of an IFC file with property sets of ours, whole or not at all; all else stays as it is.

    Raises
    ------
    InputError
        The file is wrong, the copy would replace it, or it cannot be written.
    """
    check_ends(path)
    check_output(out, [path])
    with tempfile.TemporaryDirectory(prefix="reflight-ifc-") as folder:
        found = _run("extend", path, Path(folder), encoded(_Sets(sets, known)), Extension, monitor)
        write_atomically(out, (Path(folder) / COPY).read_bytes())
    return found


def _run(task: str, path: Path, folder: Path, request: bytes, kind: type[Result], monitor: Monitor) -> Result:
    root = Path(__file__).resolve().parents[3]
    inherited = os.environ.get("PYTHONPATH")
    environment = {**os.environ, "PYTHONPATH": f"{root}{os.pathsep}{inherited}" if inherited else str(root)}
    (folder / "wanted.json").write_bytes(request)
    # -P: modules that lie about in the current folder are not ours.
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", "reconstruction.records.ifc.importing", task, str(path.absolute()), str(folder)],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL, env=environment,
    )  # fmt: skip
    try:
        while True:
            try:
                process.wait(POLL_S)
                break
            except subprocess.TimeoutExpired:
                monitor.report(say("reading the IFC file"), 0, 0)
    except BaseException:
        process.kill()
        process.wait()
        raise
    if process.returncode == EXIT_REFUSED:
        raise InputError(unpacked(json.loads((folder / "refused.json").read_bytes())))
    if process.returncode != 0:
        raise InputError(
            say(
                "the reader of IFC files crashed on this one (status {}), so something in it goes in circles or "
                "beyond all bounds; open and export it again in a BIM program",
                process.returncode,
                place=path,
            )
        )
    return msgspec.json.decode((folder / "result.json").read_bytes(), type=kind)


def main(arguments: list[str]) -> int:
    """Do one task, as the process of its own."""
    task, path, folder = arguments[0], Path(arguments[1]), Path(arguments[2])
    wanted = (folder / "wanted.json").read_bytes()
    result: object
    try:
        if task == "read":
            result = extract(path, msgspec.json.decode(wanted, type=frozenset[str]))
        else:
            result = _extend(path, folder / COPY, msgspec.json.decode(wanted, type=_Sets))
    except InputError as error:
        (folder / "refused.json").write_text(json.dumps(packed(str(error))), "utf-8")
        return EXIT_REFUSED
    (folder / "result.json").write_bytes(encoded(result))
    return 0


def _extend(path: Path, copy: Path, sets: _Sets) -> Extension:
    """Write the copy, and see that it has as many instances as it should."""
    found = extension(path, sets.sets, sets.known)
    try:
        copy.write_bytes(edited(read_input_file(path, IFC_FILE), found.lines, found.replaced))
    except InputError as error:
        raise InputError(about(path, error)) from error
    n_instances = len(list(open_model(copy)))
    if n_instances != found.n_instances:
        raise InputError(
            say(
                "with the records the file would have {} instances, {} were expected; it is written in a way "
                "that is not understood; save it anew in a BIM program",
                n_instances,
                found.n_instances,
                place=path,
            )
        )
    return found


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
class ImportedIfc:
    """What came of an IFC file: objects found in it, records added or changed, and what was left out."""

    n_objects: int
    n_changed: int
    notes: tuple[str, ...]


def read_ifc_records(book: RecordBook, path: Path, all_sets: bool = False, monitor: Monitor = QUIET) -> ImportedIfc:
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
        notes.append(say("none of the {} objects has its GlobalId in this file", len(names)))
    more = len(notes) - MAX_NOTES
    shown = (*notes[:MAX_NOTES], say("{} more values were left out", more)) if more > 0 else tuple(notes)
    return ImportedIfc(len(read.elements), n_changed, shown)


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
            notes.append(about(name, about(f"{found.set}.{found.property.name}", error)))
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
                notes.append(glue(name, ": ", set_name, ".", error))
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
        notes.append(about(name, about(SET_OF[Inspection], error)))
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
        notes.append(about(name, about("Pset_Condition", error)))


def _by_origin(found: Iterable[Found]) -> list[Found]:
    """Those that count most last."""
    return sorted(found, key=lambda each: -ORIGINS.index(each.origin))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
