"""The facades file of a project: how good the panels are that were found in photos, beside its site file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

from groundstation.services.project.project_file import ProjectRecord
from groundstation.services.project.store import current_content, digest, holds, may_replace
from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from reconstruction.panels.solving.accuracy import FoundFacades, facades_of, facades_path, read_facades


@dataclass(frozen=True, slots=True)
class FacadesToWrite:
    """What project.json says of the facades file, and its content where it is not there yet; empty without one."""

    file: str = ""
    sha256: str = ""
    files: Mapping[str, bytes] = field(default_factory=dict)


def facades_to_write(folder: Path, site: str, found: FoundFacades | None, before: ProjectRecord) -> FacadesToWrite:
    """What to write for the facades of a project.

    Parameters
    ----------
    site
        The site file as project.json will name it; empty for none.
    before
        The project as it is in the folder. A file that another program has changed is not replaced.
    """
    if found is None or not site:
        return FacadesToWrite()
    known = before.checksums()
    wanted = facades_path(Path(PurePosixPath(site))).as_posix()
    file, number = wanted, 1
    while not may_replace(folder / file, known.get(file, ""), found.content):
        number += 1
        file = f"{wanted.removesuffix('.facades.json')}-{number}.facades.json"
    is_there = holds(folder / file, found.content)
    return FacadesToWrite(file, digest(found.content), {} if is_there else {file: found.content})


def read_project_facades(folder: Path, record: ProjectRecord) -> tuple[FoundFacades | None, list[Finding]]:
    """The facades of a project; None with a note where their file cannot be read."""
    if not record.facades:
        return None, []
    try:
        path, written = current_content(folder, record.facades, record.facades_sha256)
        return facades_of(written, path), []
    except InputError as error:
        text = say("{}; how good the panels are was left out", error)
        return None, [Finding(Severity.WARNING, "facades-left-out", text)]


def facades_beside(site: Path) -> FoundFacades | None:
    """The facades of a site file that lies outside a project, as `panels` writes them beside it.

    None where there are none, and where their file cannot be read: the site is whole without it.
    """
    path = facades_path(site)
    try:
        return read_facades(path) if path.is_file() else None
    except InputError:
        return None
