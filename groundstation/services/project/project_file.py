"""`project.json` (docs/guide/projects.md): which files of a folder are the project's, and what only it knows."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from groundstation.services.project.migration import FORMAT, VERSION, Content, Listing, migrate
from groundstation.services.project.store import PROJECT_FILE, digest
from planning.base.errors import InputError
from planning.base.files import read_input_file
from planning.base.json_file import JSON_FILE, parse_json, plain_values, read_json, to_record, wrong_format
from planning.base.messages import about, glue, say
from planning.plan import PLAN_FORMAT
from planning.site.records import SITE_FORMAT

SITE_FOLDER, PLANS_FOLDER = "site", "plans"

FOLDERS = (SITE_FOLDER, PLANS_FOLDER, "missions", "flights", "photos", "models")
"""Of every project."""

MAX_NAME_LENGTH = 200
"""Of one file or folder name; most file systems take 255 bytes."""


@dataclass(frozen=True, slots=True)
class PlanRecord:
    """A plan in project.json: see `groundstation.services.project.document.PlanEntry`.

    Parameters
    ----------
    title
        None where a script wrote the entry without one; the plan is called like its identifier then.
    sha256
        Of the plan file as it was saved; empty where a script wrote the entry.
    request
        A `PlanRequest` as plain JSON, so that one that cannot be read does not take its plan with it.
    """

    id: str
    file: str
    title: str | None = None
    sha256: str = ""
    request: dict[str, Any] | None = None
    bound_for_views: float | None = None

    def __post_init__(self) -> None:
        if not self.id:
            raise ValueError("id: expected a name, got an empty text")
        check_inside(self.file, "file")


@dataclass(frozen=True, slots=True)
class ProjectRecord:
    """The content of project.json.

    `site` is empty for a project that has no site yet, `facades` for one whose panels were not found in photos.
    """

    name: str = ""
    site: str = ""
    site_sha256: str = ""
    plans: tuple[PlanRecord, ...] = ()
    current_plan_id: str = ""
    request: dict[str, Any] | None = None
    facades: str = ""
    facades_sha256: str = ""

    def __post_init__(self) -> None:
        for file, name in ((self.site, "site"), (self.facades, "facades")):
            if file:
                check_inside(file, name)
        for values, what in (
            ([plan.id for plan in self.plans], "id"),
            ([plan.file.casefold() for plan in self.plans], "file"),
        ):
            twice = next((value for value in values if values.count(value) > 1), None)
            if twice is not None:
                raise ValueError(f"plans: the {what} '{twice}' occurs twice; take one of the two entries out")

    def plan(self, plan_id: str) -> PlanRecord | None:
        """An entry by its identifier."""
        return next((found for found in self.plans if found.id == plan_id), None)

    def checksums(self) -> dict[str, str]:
        """SHA-256 by file, of those that have one."""
        files = [(self.site, self.site_sha256), (self.facades, self.facades_sha256)]
        files += [(plan.file, plan.sha256) for plan in self.plans]
        return {file: sha256 for file, sha256 in files if file and sha256}


@dataclass(frozen=True, slots=True, eq=False)
class ProjectIndex:
    """A project.json as it was found.

    Parameters
    ----------
    record
        In the present shape.
    content
        All of it in the present shape, with the fields that this version does not know.
    version
        Before migration; 0 where there is no project.json.
    written
        The file's own bytes; empty where there is none.
    """

    record: ProjectRecord
    content: Content
    version: int
    written: bytes

    @property
    def sha256(self) -> str:
        """Of project.json as it was found."""
        return digest(self.written)


def project_folder(path: Path) -> Path:
    """The folder of a project that is named by its folder or its project.json.

    Raises
    ------
    InputError
        There is neither.
    """
    if path.is_dir():
        return path
    if path.name == PROJECT_FILE and path.is_file():
        return path.parent
    found = say("a file") if path.is_file() else say("nothing of that name")
    raise InputError(say("expected the folder of a project or its {}, found {}", PROJECT_FILE, found, place=path))


def is_project(path: Path) -> bool:
    """Whether this is the folder of a project, or its project.json; loose files are none before they are saved."""
    return (path / PROJECT_FILE).is_file() or (path.name == PROJECT_FILE and path.is_file())


def check_not_index(path: Path) -> None:
    """Refuse to write something else over the project.json of a project.

    Raises
    ------
    InputError
    """
    if path.name == PROJECT_FILE and path.is_file():
        raise InputError(say("would replace what holds a project together; name another file", place=path))


def project_name(path: Path) -> str:
    """Name of a project for a list: what its project.json says, or that of the folder.

    Raises
    ------
    InputError
        The folder or its project.json cannot be read.
    """
    folder = project_folder(path)
    if not is_project(folder):
        return folder.name
    content = read_json(folder / PROJECT_FILE, names_files=True)
    name = content.get("name") if isinstance(content, dict) else None
    return name if isinstance(name, str) and name else folder.name


def read_index(folder: Path) -> ProjectIndex:
    """What project.json says, or what it would say for a loose folder without one; nothing is written.

    Raises
    ------
    InputError
        There is no project, a newer version wrote it, or a field is missing or wrong; the message names the file.
    """
    file = folder / PROJECT_FILE
    try:
        written = read_input_file(file, JSON_FILE)
    except InputError:
        if is_project(folder):
            raise
        try:
            content = migrate({}, 0, _listing(folder))
        except InputError as error:
            raise InputError(about(folder, error)) from error
        return ProjectIndex(to_record(content, ProjectRecord, folder), content, 0, b"")
    content = parse_json(written, file, names_files=True)
    version = _version(content, file)
    try:
        content = migrate(content, version, {})
    except InputError as error:
        raise InputError(about(file, error)) from error
    return ProjectIndex(to_record(content, ProjectRecord, file), content, version, written)


def _version(content: Any, file: Path) -> int:
    found = content.get("format") if isinstance(content, dict) else None
    number = re.fullmatch(re.escape(FORMAT) + r"([1-9]\d{0,8})", found) if isinstance(found, str) else None
    if number is None:
        raise InputError(wrong_format(glue(FORMAT, VERSION), found, file))
    version = int(number[1])
    if version > VERSION:
        raise InputError(
            say(
                "a newer Reflight wrote this project (format '{}', this one knows up to '{}'); open it with that one",
                found,
                glue(FORMAT, VERSION),
                place=file,
            )
        )
    return version


def _listing(folder: Path) -> Listing:
    """Formats of the JSON files in a folder; files that cannot be read are told by their names."""
    listing = {}
    for path in sorted(folder.glob("*.json")):
        try:
            content = read_json(path, names_files=True)
        except InputError:
            kinds = {".site.json": SITE_FORMAT, ".plan.json": PLAN_FORMAT}
            listing[path.name] = next((kinds[end] for end in kinds if path.name.endswith(end)), "")
        else:
            listing[path.name] = str(content.get("format", "")) if isinstance(content, dict) else ""
    return listing


def index_bytes(record: ProjectRecord, present: Content) -> bytes:
    """Content of project.json; fields of the present one that this version does not know stay.

    Raises
    ------
    InputError
        A number is not finite, which JSON cannot hold.
    """
    unknown_of_plans = {plan["id"]: plan for plan in present.get("plans", ())}
    content = {**present, "format": f"{FORMAT}{VERSION}", **_fields(record)}
    content = {"format": content.pop("format"), **content}
    content["plans"] = [{**unknown_of_plans.get(plan.id, {}), **_fields(plan)} for plan in record.plans]
    return json_bytes(content, PROJECT_FILE)


def _fields(record: ProjectRecord | PlanRecord) -> Content:
    content: Content = plain_values(record)
    return content


def json_bytes(content: Content, what: str) -> bytes:
    """JSON as all files of a project are written.

    Raises
    ------
    InputError
        A number is not finite; `what` says where.
    """
    try:
        return json.dumps(content, indent=1, allow_nan=False).encode()
    except ValueError as error:
        raise InputError(say("cannot be saved: a number in it is NaN or infinite ({})", error, place=what)) from error


def check_inside(file: str, name: str) -> None:
    """Raise `ValueError` naming `name` unless `file` is a relative path that stays in the project's folder."""
    parts = file.split("/")
    wrong = (
        not all(part.strip() and part not in (".", "..") and len(part) <= MAX_NAME_LENGTH for part in parts)
        or re.search(r"[\\:\x00-\x1f\ud800-\udfff]", file) is not None
    )
    if wrong:
        raise ValueError(f"{name}: expected the path of a file in the project's folder, with '/', got {file!r}")
