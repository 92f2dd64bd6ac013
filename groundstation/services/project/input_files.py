"""Files that the user names: read, or refused with what was expected, what was found and what to do.

The readers of the formats tell which field of a file is wrong. Here a whole file is in the wrong place: a mission where
a plan is wanted, a project where one of its files is wanted. A file is looked at once more only after it was refused.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from enum import Enum
from pathlib import Path

from groundstation.services.project.migration import FORMAT as PROJECT_FORMAT
from groundstation.services.project.project_file import ProjectRecord, is_project, project_folder, read_index
from groundstation.services.project.store import PROJECT_FILE
from missions.formats.registry import HEAD_BYTES, is_mission
from planning.base.errors import InputError, MissionError
from planning.base.files import ANY_FILE, open_input_file
from planning.base.json_file import read_json
from planning.base.messages import say
from planning.plan import PLAN_FORMAT, Plan, read_plan
from planning.site.file import read_site
from planning.site.records import SITE_FORMAT, SiteModel

TSPLIB_SUFFIXES = (".tsp", ".atsp")

PHOTO_STARTS = (b"\xff\xd8\xff", b"\x89PNG\r\n\x1a\n", b"II*\x00", b"MM\x00*", b"BM")
"""First bytes of JPEG, PNG, TIFF (two kinds) and BMP files."""


KML_OF_MISSIONS = (b"/wpmz/", b'"sortie"')
"""What stands in a mission's KML: the name space of DJI's WPML, or data that Reflight writes."""


class FileKind(Enum):
    """What can be found under a name; the value is what a message calls it."""

    PLAN = "a plan"
    SITE = "a site"
    PROJECT = "a project"
    MISSION = "a mission file"
    BUILDING = "a building model"
    PLACES = "a KML of places and outlines"
    TSPLIB = "a TSPLIB instance"
    PHOTO = "a photo"
    FOLDER = "a folder"
    EMPTY = "an empty file"
    NOTHING = "nothing of that name"
    OTHER = "a file of another kind"


EXPECTED = {
    FileKind.PLAN: say("a plan file (such as office.plan.json)"),
    FileKind.SITE: say("a site file (such as office.site.json)"),
    FileKind.PROJECT: say("the folder of a project or its {}", PROJECT_FILE),
    FileKind.MISSION: say("a mission file (.kmz, .plan, .waypoints, .kml or .csv)"),
    FileKind.BUILDING: say("a building model (.ifc, .gml, .xml, .json, .obj, .ply, .glb or .stl)"),
    FileKind.TSPLIB: say("a TSPLIB instance (.tsp or .atsp)"),
    FileKind.PHOTO: say("a photo (JPEG, PNG, TIFF or BMP)"),
}
"""Kinds that are asked for."""

ADVICE = {
    (FileKind.PLAN, FileKind.SITE): say("'plan' makes a plan of it"),
    (FileKind.PLAN, FileKind.MISSION): say("import it first ('import', or Mission > Import mission files)"),
    (
        FileKind.PLAN,
        FileKind.BUILDING,
    ): say("import it first ('site import', or Site > Import), and plan a flight over that"),
    (FileKind.SITE, FileKind.PLAN): say("name the site file that it was made for"),
    (FileKind.SITE, FileKind.MISSION): say("it knows no building; name the site file that it is flown at"),
    (FileKind.SITE, FileKind.BUILDING): say("import it first ('site import', or Site > Import)"),
    (FileKind.PROJECT, FileKind.SITE): say("'project new' makes a project of it"),
    (FileKind.PROJECT, FileKind.PLAN): say("'project add' puts it into a project"),
    (FileKind.MISSION, FileKind.PLAN): say("it needs no import; 'export' makes a mission of it"),
    (FileKind.MISSION, FileKind.SITE): say("it goes behind --site; name the mission file as well"),
    (FileKind.BUILDING, FileKind.SITE): say("it needs no import; 'plan' takes it as it is"),
    (FileKind.BUILDING, FileKind.PLACES): say(
        "it has no walls that could be measured: save the model itself as .ifc, .glb or .obj in the program that made "
        "it; areas to keep out of are geo-zones: add them to the site as zones"
    ),
    (FileKind.TSPLIB, FileKind.PLAN): say("'tradeoff route' takes plans"),
}
"""What to do, by what was expected and what was found."""

READERS_KNOW_BETTER = (
    (FileKind.MISSION, FileKind.OTHER),
    (FileKind.MISSION, FileKind.FOLDER),
    (FileKind.MISSION, FileKind.PLACES),
    (FileKind.PROJECT, FileKind.FOLDER),
    (FileKind.BUILDING, FileKind.OTHER),
    (FileKind.PHOTO, FileKind.OTHER),
)
"""Where the reader's own message says more: it lists all formats, or what the folder lacks."""

ADVICE_FOR_ALL = {
    FileKind.FOLDER: say("name a file in it"),
    FileKind.EMPTY: say("copy it again or make it anew"),
    FileKind.NOTHING: say("check the path"),
}


def read_input_plan(path: Path) -> Plan:
    """Read a plan file that the user named.

    Raises
    ------
    InputError
        As `planning.plan.read_plan`; where the file is of another kind, the message says which and what to do.
    """
    with expecting(FileKind.PLAN, path):
        return read_plan(path)


def read_input_site(path: Path) -> SiteModel:
    """Read a site file that the user named.

    Raises
    ------
    InputError
        As `planning.site.file.read_site`; where the file is of another kind, the message says which and what to do.
    """
    with expecting(FileKind.SITE, path):
        return read_site(path)


@contextmanager
def expecting(expected: FileKind, path: Path) -> Iterator[None]:
    """Turn the refusal of a file into one that says what was found instead, where that is another kind of file.

    Raises
    ------
    InputError
        As it was raised inside, or in other words.
    """
    if expected not in EXPECTED:
        raise ValueError(f"expected a kind of file that can be asked for, got {expected}")
    try:
        yield
    except (InputError, MissionError) as error:
        found = kind_of(path)
        if found is None or found is expected or (expected, found) in READERS_KNOW_BETTER:
            raise
        raise InputError(
            say(
                "expected {}, found {}; {}", EXPECTED[expected], found.value, _advice(expected, found, path), place=path
            )
        ) from error


def kind_of(path: Path) -> FileKind | None:
    """What lies under a name, by its content; None for what cannot be read, and for JSON that does not say."""
    if path.is_dir():
        return FileKind.PROJECT if _project_record(path) is not None else FileKind.FOLDER
    if not os.path.lexists(path):
        return FileKind.NOTHING
    try:
        with open_input_file(path, ANY_FILE) as file:
            head = file.read(HEAD_BYTES)
    except InputError:
        return None
    text = head.removeprefix(b"\xef\xbb\xbf").lstrip()
    if not text:
        return FileKind.EMPTY
    if text.startswith((b"{", b"[")):
        return _kind_of_json(path)
    if head.startswith(PHOTO_STARTS):
        return FileKind.PHOTO
    if b"<kml" in head and not any(mark in head for mark in KML_OF_MISSIONS):
        return FileKind.PLACES
    if is_mission(head):
        return FileKind.MISSION
    if _is_building(path):
        return FileKind.BUILDING
    is_tsplib = b"DIMENSION" in head or path.suffix.lower() in TSPLIB_SUFFIXES
    return FileKind.TSPLIB if is_tsplib else FileKind.OTHER


def _kind_of_json(path: Path) -> FileKind | None:
    try:
        content = read_json(path)
    except InputError:
        return None
    if not isinstance(content, dict):
        return FileKind.OTHER
    if content.get("type") == "CityJSON":
        return FileKind.BUILDING
    if content.get("fileType") == "Plan":
        return FileKind.MISSION
    file_format = str(content.get("format", ""))
    if file_format.startswith(PROJECT_FORMAT):
        return FileKind.PROJECT if is_project(path) else None
    return {PLAN_FORMAT: FileKind.PLAN, SITE_FORMAT: FileKind.SITE}.get(file_format)


def _is_building(path: Path) -> bool:
    from planning.site.importing.importer import CITYJSON_SUFFIXES, SUFFIXES

    return path.suffix.lower() in SUFFIXES and path.suffix.lower() not in CITYJSON_SUFFIXES


def _project_record(path: Path) -> ProjectRecord | None:
    """What a project holds, also one of loose files; None where there is none that can be read."""
    try:
        return read_index(project_folder(path)).record
    except InputError:
        return None


def _advice(expected: FileKind, found: FileKind, path: Path) -> str:
    if found is FileKind.PROJECT:
        return _advice_on_project(expected, path)
    return ADVICE.get((expected, found), ADVICE_FOR_ALL.get(found, say("name another file")))


def _advice_on_project(expected: FileKind, path: Path) -> str:
    """Which file of a project can be named instead."""
    folder, record = project_folder(path), _project_record(path)
    if record is None:
        return say("name a file in it")
    if expected is FileKind.SITE and record.site:
        return say("its site is {}", folder / record.site)
    if expected is FileKind.PLAN and record.plans:
        return say("name one of its plans: ") + ", ".join(str(folder / plan.file) for plan in record.plans)
    if expected is FileKind.PLAN and record.site:
        return say("it has no plan yet; 'plan {} -o PLAN' makes one", folder / record.site)
    return say("name a file in it")
