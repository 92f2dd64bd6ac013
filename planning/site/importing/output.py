"""An imported site to files: the site file and its meshes beside it, none half-written, none over the source."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from planning.base.errors import InputError
from planning.base.json_file import write_together
from planning.geo.mesh import join, ply_bytes
from planning.site.file import site_bytes
from planning.site.importing.importer import ImportedSite
from planning.site.records import SiteModel


def write_imported_site(
    path: Path, imported: ImportedSite, source: Path, beside: Mapping[Path, bytes] | None = None
) -> SiteModel:
    """Write the site file and, beside it, its meshes; returns the model as it was written.

    Meshes are named after the site file; none is ever written over the file that was imported.

    Parameters
    ----------
    beside
        Content of further files that belong to the site.

    Raises
    ------
    InputError
        The folder is missing or cannot be written, or the site would replace the file it was imported from.
    """
    if path.exists() and path.samefile(source):
        raise InputError(f"{path}: the site would be written over the file it is imported from; name another file")
    model = imported.model
    site = model.site
    meshes: dict[Path, bytes] = {}
    if site.building_mesh is not None:
        name = _free_name(path, ".ply", "-building.ply", source)
        meshes[path.with_name(name)] = ply_bytes(model.building)
        site = replace(site, building_mesh=name)
    if site.obstacles:
        name = _free_name(path, "-neighbours.ply", "-other-buildings.ply", source)
        meshes[path.with_name(name)] = ply_bytes(join(list(model.obstacles)))
        site = replace(site, obstacles=(replace(site.obstacles[0], mesh=name),))
    content = site_bytes(site)
    write_together({path: content, **meshes, **(beside or {})})
    return replace(model, site=site, sha256=hashlib.sha256(content).hexdigest())


def _free_name(path: Path, ending: str, other_ending: str, source: Path) -> str:
    """Name of a mesh beside the site file, with the other ending where the first is the imported file's own."""
    name = path.stem + ending
    target = path.with_name(name)
    return path.stem + other_ending if target.exists() and target.samefile(source) else name
