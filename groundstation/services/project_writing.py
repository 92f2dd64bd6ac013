"""Writing a project: what of it has changed, and what nothing uses any more afterwards."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from groundstation.services.project_file import (
    PLANS_FOLDER,
    SITE_FOLDER,
    ProjectIndex,
    ProjectRecord,
    index_bytes,
)
from groundstation.services.project_migration import VERSION, free_name
from groundstation.services.project_site import is_plain, mesh_names, site_files, spare_meshes
from groundstation.services.project_store import (
    PROJECT_FILE,
    digest,
    has_digest,
    holds,
    in_words,
    leftovers,
    may_replace,
    remove,
    replace_together,
)
from planning.files import read_given
from planning.json_file import JSON_FILE
from planning.site import SiteModel


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
        meshes=mesh_names(stored.content),
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
    with in_words(folder):
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
        old_meshes = mesh_names(read_given(old_site, JSON_FILE)) - meshes
        unused += [old_site.with_name(name) for name in sorted(old_meshes) if is_plain(name)]
    return unused
