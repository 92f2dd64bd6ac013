"""An imported site to files: the site file and its meshes beside it, none half-written, none over the source."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

from planning.errors import InputError
from planning.mesh import TriangleMesh, join, write_mesh
from planning.site import SiteModel
from planning.site_file import write_site
from planning.site_import.importer import ImportedSite


def write_imported_site(path: Path, imported: ImportedSite, source: Path) -> SiteModel:
    """Write the site file and, beside it, its meshes; returns the model as it was written.

    Meshes are named after the site file; none is ever written over the file that was imported.

    Raises
    ------
    InputError
        The folder is missing or cannot be written, or the site would replace the file it was imported from.
    """
    if path.exists() and path.samefile(source):
        raise InputError(f"{path}: the site would be written over the file it is imported from; name another file")
    model = imported.model
    site = model.site
    if site.building_mesh is not None:
        name = _free_name(path, ".ply", "-building.ply", source)
        _write_mesh(path.with_name(name), model.building)
        site = replace(site, building_mesh=name)
    if site.obstacles:
        name = _free_name(path, "-neighbours.ply", "-other-buildings.ply", source)
        _write_mesh(path.with_name(name), join(list(model.obstacles)))
        site = replace(site, obstacles=(replace(site.obstacles[0], mesh=name),))
    sha256 = write_site(path, site)
    return replace(model, site=site, sha256=sha256)


def _free_name(path: Path, ending: str, other_ending: str, source: Path) -> str:
    """Name of a mesh beside the site file, with the other ending where the first is the imported file's own."""
    name = path.stem + ending
    target = path.with_name(name)
    return path.stem + other_ending if target.exists() and target.samefile(source) else name


def _write_mesh(path: Path, mesh: TriangleMesh) -> None:
    """Write a mesh whole or not at all."""
    temporary = path.with_name(f".{path.stem}.{os.getpid()}.ply")
    try:
        write_mesh(temporary, mesh)
        temporary.replace(path)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror or error})") from error
    finally:
        temporary.unlink(missing_ok=True)
