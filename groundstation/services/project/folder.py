"""Projects: a folder with a site, the plans made for it and what belongs to them (docs/guide/projects.md)."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePosixPath
from typing import Any

from groundstation.services.project.document import Document, PlanEntry
from groundstation.services.project.input_files import read_input_plan
from groundstation.services.project.migration import FORMAT, VERSION, free_name, title_of
from groundstation.services.project.project_file import (
    FOLDERS,
    PLANS_FOLDER,
    SITE_FOLDER,
    PlanRecord,
    ProjectIndex,
    ProjectRecord,
    index_bytes,
    is_project,
    json_bytes,
    project_folder,
    read_index,
)
from groundstation.services.project.site import file_stem, is_plain, named_files, site_files, spare_meshes
from groundstation.services.project.store import (
    PROJECT_FILE,
    current_content,
    digest,
    finish_interrupted_save,
    has_digest,
    holds,
    leftovers,
    may_replace,
    remove,
    replace_together,
    system_errors_as_input_errors,
)
from planning.base.errors import InputError
from planning.base.files import read_input_file, real_path
from planning.base.findings import Finding, Severity
from planning.base.json_file import JSON_FILE, plain_values, to_record
from planning.base.messages import glue, say
from planning.plan import plan_of, plan_to_json
from planning.request import PlanRequest
from planning.site.file import is_planned_on, site_of
from planning.site.records import SiteModel
from reconstruction.panels.solving.accuracy import FoundFacades, facades_of, facades_path, read_facades

# The facades file of a project: how good the panels are that were found in photos, beside its site file.


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


# The plans of a project as files, one each, and what project.json knows of them.


def read_entry(folder: Path, record: PlanRecord) -> tuple[PlanEntry | None, list[Finding]]:
    """A plan with what the project knows of it, and notes; None where its file cannot be read."""
    title = record.id if record.title is None else record.title
    try:
        path, written = current_content(folder, record.file, record.sha256)
        plan = plan_of(written, path)
    except InputError as error:
        text = say("{}; the plan '{}' was left out", error, title)
        return None, [Finding(Severity.WARNING, "plan-left-out", text, record.id)]
    if record.sha256 and digest(written) != record.sha256:
        # What was asked for and the bound belong to the plan that was there before.
        text = say("another program has changed the plan '{}' since the project was saved", title, place=path)
        return PlanEntry(record.id, title, plan), [Finding(Severity.NOTE, "plan-changed", text, record.id)]
    request, notes = read_request(record.request, say("the plan '{}'", title))
    return PlanEntry(record.id, title, plan, request, record.bound_for_views), notes


def read_request(content: dict[str, Any] | None, what: str) -> tuple[PlanRequest | None, list[Finding]]:
    """A request as project.json holds it; None with a note where it cannot be read. `what` says whose it is."""
    if content is None:
        return None, []
    try:
        return to_record(content, PlanRequest, Path(PROJECT_FILE)), []
    except InputError as error:
        text = say("{}; what was asked of {} was left out", error, what)
        return None, [Finding(Severity.WARNING, "request-left-out", text)]


def plan_file(folder: Path, entry: PlanEntry, before: ProjectRecord, used: set[str]) -> tuple[PlanRecord, bytes | None]:
    """Entry of project.json for a plan, and the content to write; None where the file holds the plan already.

    A file that another program wrote stays as it is, with fields that this version does not know, while the plan in it
    is the same. One that holds something else is never replaced: the plan gets another file then.

    Parameters
    ----------
    before
        The project as it is in the folder.
    used
        Files of other plans.

    Raises
    ------
    InputError
        A number in the plan is not finite.
    """
    content = json_bytes(plan_to_json(entry.plan), say("plan '{}'", entry.title))
    known = before.plan(entry.id)
    if known is not None:
        with contextlib.suppress(InputError):  # what cannot be read does not hold the plan
            found = read_input_file(folder / known.file, JSON_FILE)
            if found != content and plan_of(found, folder / known.file) == entry.plan:
                content = found
    if (
        known is not None
        and known.file.rpartition("/")[0] == PLANS_FOLDER
        and known.file not in used
        and may_replace(folder / known.file, known.sha256, content)
    ):
        file = known.file
    else:
        file = _free_file(folder, entry.id, {*used, *(plan.file for plan in before.plans)})
    record = PlanRecord(
        id=entry.id,
        file=file,
        title=entry.title,
        sha256=digest(content),
        request=None if entry.request is None else plain_values(entry.request),
        bound_for_views=entry.bound_for_views,
    )
    return record, None if holds(folder / file, content) else content


def _free_file(folder: Path, plan_id: str, taken: set[str]) -> str:
    """Name for a new plan file, other than all that there are, in whatever case they are written."""
    there = {f"{PLANS_FOLDER}/{path.name}" for path in (folder / PLANS_FOLDER).glob("*")}
    used = {file.casefold() for file in taken | there}
    stem, number = file_stem(plan_id) or "plan", 1
    while _numbered(stem, number).casefold() in used:
        number += 1
    return _numbered(stem, number)


def _numbered(stem: str, number: int) -> str:
    return f"{PLANS_FOLDER}/{stem}{'' if number == 1 else f'-{number}'}.plan.json"


def add_plans(document: Document, paths: Sequence[Path]) -> tuple[Document, tuple[Finding, ...]]:
    """A document with the plans of some files; the last becomes the current one. They are called like their files.

    Raises
    ------
    InputError
        A file cannot be read, or the project holds its plan already.
    """
    notes = []
    for path in paths:
        plan = read_input_plan(path)
        same = next((entry for entry in document.plans if entry.plan == plan), None)
        if same is not None:
            raise InputError(say("the project holds this plan already, as '{}'; leave it out", same.title, place=path))
        site = document.site
        is_ours = site is not None and bool(site.sha256) and is_planned_on(plan.site_sha256, site)
        if site is not None and plan.site_sha256 and not is_ours:
            text = say(
                "this plan was made for another state of the site, or for another site ('{}')", plan.site, place=path
            )
            notes.append(Finding(Severity.WARNING, "site-changed", text))
        title = title_of(path.name)
        plan_id = free_name(title, {entry.id for entry in document.plans})
        document = document.with_plan(PlanEntry(plan_id, title, plan))
    return document, tuple(notes)


# Writing a project: what of it has changed, and what nothing uses any more afterwards.


@dataclass(frozen=True, slots=True, eq=False)
class SiteToWrite:
    """The site of a project as it will be written.

    Parameters
    ----------
    file, sha256
        Of the site file, as in project.json.
    model
        As a reader will find it.
    meshes
        Names of all meshes.
    files
        Content of the site file, where it is not there yet.
    created
        Content of mesh files that are not there yet; both by path relative to the project.
    """

    file: str
    sha256: str
    model: SiteModel
    meshes: set[str]
    files: Mapping[str, bytes]
    created: Mapping[str, bytes]


def site_to_write(folder: Path, site: SiteModel, before: ProjectRecord, sources: Sequence[Path]) -> SiteToWrite:
    """What to write for a site; nothing where the project holds it already.

    Parameters
    ----------
    before
        The project as it is in the folder.
    sources
        Site files outside the project that the site may come from.
    """
    known = [folder / before.site] if before.site else []
    stored = site_files(site, folder / SITE_FOLDER, [*known, *sources])
    file = _site_file(folder, before, stored.content)
    return SiteToWrite(
        file=file,
        sha256=digest(stored.content),
        model=stored.model,
        meshes=named_files(stored.content),
        files={} if holds(folder / file, stored.content) else {file: stored.content},
        created={f"{SITE_FOLDER}/{name}": content for name, content in stored.meshes.items()},
    )


def _site_file(folder: Path, before: ProjectRecord, content: bytes) -> str:
    """Where the site file goes: where it is, or to a name in its proper folder that nothing has."""
    is_in_place = before.site.rpartition("/")[0] == SITE_FOLDER
    if is_in_place and may_replace(folder / before.site, before.site_sha256, content):
        return before.site
    number = 1
    while (folder / (file := f"{SITE_FOLDER}/site{'' if number == 1 else f'-{number}'}.json")).exists():
        number += 1
    return file


def write_project(
    folder: Path,
    present: ProjectIndex | None,
    record: ProjectRecord,
    files: Mapping[str, bytes],
    site: SiteToWrite | None,
) -> None:
    """Write what has changed, keep a project.json of an older version, then remove what only the old project used.

    Parameters
    ----------
    present
        The project as it is in the folder.
    files
        Content of site and plan files that changes, by path relative to the project.

    Raises
    ------
    InputError
        Something cannot be written; the project is as it was then.
    """
    meshes = set() if site is None else site.meshes
    created = {} if site is None else dict(site.created)
    content = index_bytes(record, {} if present is None else present.content)
    if present is not None and present.written == content and not files and not created:
        return
    unused = [] if present is None else _unused(folder, present, record, meshes)
    if present is not None and 0 < present.version < VERSION:
        created[_backup_name(folder, present)] = present.written
    with system_errors_as_input_errors(folder):
        for file in (*files, *created):
            (folder / file).parent.mkdir(parents=True, exist_ok=True)
    replace_together(folder, files, content, created)
    with contextlib.suppress(OSError):  # the project is saved; what cannot be cleared away only takes room
        remove(unused)
        remove(spare_meshes(folder / SITE_FOLDER, meshes))
        remove(leftovers(folder, (SITE_FOLDER, PLANS_FOLDER), record.checksums()))


def _backup_name(folder: Path, present: ProjectIndex) -> str:
    taken = {path.name.removesuffix(".json") for path in folder.iterdir()}
    return free_name(f"{PROJECT_FILE.removesuffix('.json')}.v{present.version}", taken) + ".json"


def _unused(folder: Path, present: ProjectIndex, record: ProjectRecord, meshes: set[str]) -> list[Path]:
    """Files that the project wrote itself and will not use any more.

    Files that are not as the project wrote them (damaged, changed by another program) and all outside its own folders
    are not its to remove; nor is anything of an older version.
    """
    if present.version != VERSION:
        return []
    kept = {record.site, record.facades, *(plan.file for plan in record.plans)}
    own = {
        file: folder / file
        for file, sha256 in present.record.checksums().items()
        if file.startswith((f"{SITE_FOLDER}/", f"{PLANS_FOLDER}/")) and has_digest(folder / file, sha256)
    }
    unused = [path for file, path in own.items() if file not in kept]
    old_site = own.get(present.record.site)
    if old_site is not None:
        old_meshes = named_files(read_input_file(old_site, JSON_FILE)) - meshes
        unused += [old_site.with_name(name) for name in sorted(old_meshes) if is_plain(name)]
    return unused


ATTEMPTS = 30
"""To read a project that is being saved meanwhile; a save takes tenths of a second, and the next is seconds later."""


@dataclass(frozen=True, slots=True, eq=False)
class OpenedProject:
    """A project as it was read.

    Parameters
    ----------
    record
        What its project.json says, in the present shape: the files it consists of.
    notes
        What the user should know: plans left out, migration, a folder that cannot be written.
    version
        Format of the folder; see `groundstation.services.project.migration`.
    """

    folder: Path
    name: str
    document: Document
    record: ProjectRecord
    notes: tuple[Finding, ...]
    version: int


def open_project(path: Path) -> OpenedProject:
    """Read a project; nothing is written.

    Parameters
    ----------
    path
        Its folder, or its project.json.

    Raises
    ------
    InputError
        There is no project, a newer version wrote it, project.json is wrong or the site cannot be read; the message
        names the file. A plan that cannot be read is left out, with a note.
    """
    folder = project_folder(path)
    for _ in range(ATTEMPTS - 1):
        index = read_index(folder)
        try:
            opened = _opened(folder, index)
        except InputError:
            if read_index(folder).written == index.written:
                raise
        else:
            if read_index(folder).written == index.written:
                return opened
        # It was saved while it was being read: what was read may be half of each.
    return _opened(folder, read_index(folder))


def _opened(folder: Path, index: ProjectIndex) -> OpenedProject:
    record = index.record
    notes = [*_migration_notes(folder, index)]
    if not os.access(folder, os.W_OK):
        text = say("this folder cannot be written; changes can only be saved as another project", place=folder)
        notes.append(Finding(Severity.WARNING, "read-only", text))
    site = None if not record.site else _read_site(folder, record)
    entries = []
    for plan in record.plans:
        entry, found = read_entry(folder, plan)
        notes += found
        entries += [] if entry is None else [entry]
    ids = [entry.id for entry in entries]
    current = record.current_plan_id if record.current_plan_id in ids else (ids[-1] if ids else "")
    request, found = read_request(record.request, say("the next plan"))
    notes += found
    facades, found = read_project_facades(folder, record)
    notes += found
    document = Document(
        site, tuple(entries), current, PlanRequest() if request is None else request, found_facades=facades
    )
    return OpenedProject(folder, record.name or real_path(folder).name, document, record, tuple(notes), index.version)


def _migration_notes(folder: Path, index: ProjectIndex) -> Iterator[Finding]:
    if index.version == 0:
        text = say(
            "there is no {} here, so '{}' and the plans beside it (found: {}) were taken as a project; "
            "saving makes it one, with copies of its own",
            PROJECT_FILE,
            index.record.site,
            len(index.record.plans),
            place=folder,
        )
        yield Finding(Severity.NOTE, "loose-files", text)
    elif index.version < VERSION:
        text = say(
            "this project is in format '{}'; saving brings it to '{}' and keeps the old {} beside it",
            glue(FORMAT, index.version),
            glue(FORMAT, VERSION),
            PROJECT_FILE,
            place=folder,
        )
        yield Finding(Severity.NOTE, "old-format", text)


def _read_site(folder: Path, record: ProjectRecord) -> SiteModel:
    try:
        path, written = current_content(folder, record.site, record.site_sha256)
        return site_of(written, path)
    except InputError as error:
        raise InputError(
            say(
                "{}; a project cannot be opened without its site: put the file back from a copy, or make a new "
                "project with 'project new' and add the plans to it",
                error,
            )
        ) from error


def create_project(folder: Path, document: Document, *, name: str = "", site_source: Path | None = None) -> Document:
    """Make a new project; returns the document as `save_project` does.

    Parameters
    ----------
    folder
        Made where it is missing. Other files in it stay untouched.
    site_source
        As for `save_project`.

    Raises
    ------
    InputError
        There is a project already, or the folder cannot be made or written.
    """
    if is_project(folder):
        raise InputError(say("there is a project here already; open it, or name another folder", place=folder))
    if folder.exists() and not folder.is_dir():
        raise InputError(say("expected a folder for the project, found a file; name another folder", place=folder))
    new_folders = [path for path in (folder, *(folder / part for part in FOLDERS)) if not path.exists()]
    try:
        with system_errors_as_input_errors(folder):
            for path in new_folders:
                path.mkdir(parents=True, exist_ok=True)
        return save_project(folder, document, name=name, site_source=site_source)
    except BaseException:
        for path in reversed(new_folders):
            with contextlib.suppress(OSError):  # what cannot be removed holds something, or was never made
                path.rmdir()
        raise


def save_project(folder: Path, document: Document, *, name: str = "", site_source: Path | None = None) -> Document:
    """Write a document as a project, whole or not at all; only files that have changed are written.

    A file that another program has changed since the last save is not replaced: what belongs there gets another name.

    Parameters
    ----------
    folder
        Of the project; exists.
    name
        Of the project; empty to leave it as it is (a new project is called like its folder).
    site_source
        Site file that the document's site was read from, where it is neither the project's own nor the document's
        `site_source`. While the site has not changed, its file is taken over byte for byte, so that plans made for it
        still know it by its checksum.

    Returns
    -------
    document
        As it was written: the site has the checksum of its file, and names and coordinates of its meshes as the mesh
        files hold them. The very same object where nothing of it is different.

    Raises
    ------
    InputError
        Something cannot be written (the project is as it was then), holds NaN or infinity, or the project in the
        folder cannot be read or is of a newer version.
    """
    present = _present(folder)
    if present is not None:
        finish_interrupted_save(folder, present.record.checksums())
    before = ProjectRecord() if present is None else present.record
    sources = [source for source in (site_source, document.site_source) if source is not None]
    site = None if document.site is None else site_to_write(folder, document.site, before, sources)
    files = {} if site is None else dict(site.files)
    facades = facades_to_write(folder, "" if site is None else site.file, document.found_facades, before)
    files |= facades.files
    plans: list[PlanRecord] = []
    for entry in document.plans:
        plan, content = plan_file(folder, entry, before, {plan.file for plan in plans})
        plans.append(plan)
        if content is not None:
            files[plan.file] = content
    record = ProjectRecord(
        name=name or before.name or real_path(folder).name,
        site="" if site is None else site.file,
        site_sha256="" if site is None else site.sha256,
        plans=tuple(plans),
        current_plan_id=document.current_plan_id,
        request=plain_values(document.request),
        facades=facades.file,
        facades_sha256=facades.sha256,
    )
    write_project(folder, present, record, files, site)
    return document if site is None or site.model is document.site else replace(document, site=site.model)


def _present(folder: Path) -> ProjectIndex | None:
    """The project in a folder as it is now: also loose files, which a first save takes over; None for neither."""
    try:
        return read_index(folder)
    except InputError:
        if is_project(folder):
            raise
        return None
