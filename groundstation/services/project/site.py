"""The site of a project as files: site.json, meshes and geo-zones, left as they are where they hold the site already.

Plans name the site they were made for by the checksum of its file, so a site that has not changed keeps its file byte
for byte, whoever wrote it. A mesh that has changed gets a new name: site.json names its meshes, and so the old site
stays whole until project.json names the new one.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path, PurePath

import msgspec
import numpy as np

from groundstation.services.project.project_file import MAX_NAME_LENGTH
from groundstation.services.project.store import digest, holds
from planning.base.errors import InputError
from planning.base.files import read_input_file, real_path, sha256_of_file
from planning.base.json_file import JSON_FILE, parse_json, to_record
from planning.base.messages import say
from planning.geo.mesh import MESH_FILE, TriangleMesh, empty_mesh, ply_bytes, read_mesh
from planning.site.file import site_bytes
from planning.site.records import Obstacle, Site, SiteModel
from planning.site.zones.records import SiteZones

SITE_NAME = "site.json"

DIGEST_ENDING = re.compile(r"-[0-9a-f]{12}$")
"""Of the names of meshes that have changed."""


@dataclass(frozen=True, slots=True, eq=False)
class SiteFiles:
    """A site as files of one folder.

    Parameters
    ----------
    model
        As a reader will find it: names of meshes, coordinates as a mesh file holds them, checksum.
    content
        Of site.json.
    meshes
        Content by name of the files of meshes and geo-zones that are not there yet.
    """

    model: SiteModel
    content: bytes
    meshes: Mapping[str, bytes]


def site_files(model: SiteModel, folder: Path, sources: Sequence[Path]) -> SiteFiles:
    """Files that hold a site.

    Parameters
    ----------
    folder
        Where they will lie.
    sources
        Site files the model may come from; one that holds it is taken over as it is.

    Raises
    ------
    InputError
        A text in the site is no valid Unicode.
    ValueError
        An obstacle that is no box has no triangles.
    """
    if any(o.mesh is not None and not len(mesh.triangles) for o, mesh in _with_meshes(model)):
        raise ValueError("expected obstacles with triangles, got an empty mesh")
    for source in sources:
        content = _unchanged(source, model)
        meshes = None if content is None else _copies(source.parent, content, folder, model)
        if content is not None and meshes is not None:
            return SiteFiles(model, content, meshes)
    stored, new_meshes = _stored(model, folder)
    content = _site_bytes(stored.site)
    return SiteFiles(_with_checksum(model, stored, digest(content)), content, new_meshes)


def same_site(one: SiteModel | None, other: SiteModel | None) -> bool:
    """Whether two sites are the same in all that a file holds, their checksums and the names of meshes aside."""
    if one is None or other is None:
        return one is other
    return _nameless(one.site) == _nameless(other.site) and all(
        same_mesh(a, b) for a, b in zip((one.building, *one.obstacles), (other.building, *other.obstacles), strict=True)
    )


def same_mesh(one: TriangleMesh, other: TriangleMesh) -> bool:
    """Whether two meshes are the same to the single precision of mesh files (4 um at 50 m from the origin)."""
    return (
        one.triangles.shape == other.triangles.shape
        and one.vertices_enu_m.shape == other.vertices_enu_m.shape
        and bool((one.triangles == other.triangles).all())
        and bool((one.vertices_enu_m.astype(np.float32) == other.vertices_enu_m.astype(np.float32)).all())
    )


@dataclass(frozen=True, slots=True)
class _ObstacleMesh:
    mesh: str | None = None


@dataclass(frozen=True, slots=True)
class _NamedZones:
    file: str


@dataclass(frozen=True, slots=True)
class _NamedMeshes:
    """The part of site.json that names files; the panels of a tower alone take tenths of a second to read."""

    building_mesh: str | None = None
    obstacles: tuple[_ObstacleMesh, ...] = ()
    zones: tuple[_NamedZones, ...] = ()


def named_files(content: bytes) -> set[str]:
    """Paths of all meshes and files of geo-zones that the content of a site.json names."""
    site = _named(content)
    return _mesh_names(site) | {source.file for source in site.zones}


def _named(content: bytes) -> _NamedMeshes:
    return msgspec.convert(parse_json(content, Path(SITE_NAME)), _NamedMeshes)


def _mesh_names(site: _NamedMeshes) -> set[str]:
    return {name for name in (site.building_mesh, *(obstacle.mesh for obstacle in site.obstacles)) if name is not None}


def spare_meshes(folder: Path, used: set[str]) -> list[Path]:
    """Meshes with a checksum in their names, and that content, which no site uses: saves left them that broke off."""
    named = {path: DIGEST_ENDING.search(path.stem) for path in folder.glob("*.ply") if path.name not in used}
    return [path for path, ending in named.items() if ending and _begins(path, ending[0][1:])]


def _begins(path: Path, start: str) -> bool:
    try:
        return sha256_of_file(path).startswith(start)
    except InputError:
        return False


def _nameless(site: Site) -> Site:
    obstacles = tuple(replace(o, mesh=None if o.mesh is None else "mesh") for o in site.obstacles)
    zones = tuple(replace(source, file=f"{number}") for number, source in enumerate(site.zones))
    return replace(site, building_mesh=None, obstacles=obstacles, zones=zones)


def _with_meshes(model: SiteModel) -> Iterator[tuple[Obstacle, TriangleMesh]]:
    return zip(model.site.obstacles, model.obstacles, strict=True)


def _site_bytes(site: Site) -> bytes:
    try:
        return site_bytes(site)
    except ValueError as error:
        raise InputError(
            say("site '{}': cannot be saved: a text in it is no valid Unicode ({})", site.name, error)
        ) from error


def _unchanged(source: Path, model: SiteModel) -> bytes | None:
    """Content of a site file that the model was read from and still is the same as."""
    try:
        content = read_input_file(source, JSON_FILE)
        if digest(content) != model.sha256:
            return None
        if content != _site_bytes(model.site) and to_record(parse_json(content, source), Site, source) != model.site:
            return None
        meshes = [(model.site.building_mesh, model.building)]
        meshes += [(obstacle.mesh, mesh) for obstacle, mesh in _with_meshes(model)]
    except InputError:
        return None  # what cannot be read holds no site, so all of it is written anew
    same = all(_holds(source.parent / name, mesh) for name, mesh in meshes if name is not None)
    return content if same else None


def _copies(source: Path, content: bytes, folder: Path, model: SiteModel) -> dict[str, bytes] | None:
    """Files to copy beside a site file that is taken over as it is; None where their names do not allow it."""
    if real_path(source) == real_path(folder):
        return {}
    files = {name: read_input_file(source / name, MESH_FILE) for name in sorted(_mesh_names(_named(content)))}
    files |= {each.source.file: each.content for each in model.zones if each.content}
    copies = {}
    for name, written in files.items():
        target = folder / name
        if not is_plain(name) or (target.exists() and not holds(target, written)):
            return None
        if not target.exists():
            copies[name] = written
    return copies


def _stored_zones(model: SiteModel, folder: Path) -> tuple[tuple[SiteZones, ...], dict[str, bytes]]:
    """Files of geo-zones under the names that they have in a folder, and those to write; lost ones stay named."""
    new: dict[str, bytes] = {}
    stored = []
    for each in model.zones:
        name = each.source.file
        if each.content:
            path = PurePath(name.replace(chr(92), "/"))
            name = name if is_plain(name) else f"{file_stem(path.stem) or 'zones'}{path.suffix}"
            if new.get(name, each.content) != each.content or (
                (folder / name).exists() and not holds(folder / name, each.content)
            ):
                name = f"{file_stem(path.stem) or 'zones'}-{digest(each.content)[:12]}{path.suffix}"
            if not holds(folder / name, each.content):
                new[name] = each.content
        stored.append(replace(each, source=replace(each.source, file=name)))
    return tuple(stored), new


def _stored(model: SiteModel, folder: Path) -> tuple[SiteModel, dict[str, bytes]]:
    """The model with the names and coordinates of its meshes as files, and the files to write."""
    names = _MeshNames(folder)
    zones, new_zones = _stored_zones(model, folder)
    site, building = model.site, model.building
    building_mesh = None
    if len(building.triangles):
        building = _rounded(building)
        building_mesh = names.take(site.building_mesh or "building.ply", building)
    obstacles, meshes = [], []
    for obstacle, mesh in _with_meshes(model):
        if obstacle.mesh is None:
            obstacles.append(obstacle)
            meshes.append(mesh)
        else:
            meshes.append(_rounded(mesh))
            obstacles.append(replace(obstacle, mesh=names.take(obstacle.mesh, meshes[-1])))
    if building_mesh is None:
        building = empty_mesh()
    sources = {each.source: new.source for each, new in zip(model.zones, zones, strict=True)}
    named = replace(
        site,
        building_mesh=building_mesh,
        obstacles=tuple(obstacles),
        zones=tuple(sources.get(source, source) for source in site.zones),
    )
    stored = SiteModel(named, building, tuple(meshes), zones=zones, zones_at=model.zones_at)
    return stored, {**names.new, **new_zones}


def _with_checksum(model: SiteModel, stored: SiteModel, sha256: str) -> SiteModel:
    """The stored model with its checksum; the very object where it is the same, so that views need not draw it anew."""
    kept = all(
        a is b
        for a, b in zip((model.building, *model.obstacles), (stored.building, *stored.obstacles), strict=True)
        if len(a.triangles)
    )
    if kept and model.sha256 == sha256 and model.site == stored.site:
        return model
    return replace(stored, sha256=sha256)


class _MeshNames:
    """Names of meshes in a folder: the wanted one, or one with the mesh's checksum where the wanted one is taken."""

    def __init__(self, folder: Path) -> None:
        self.new: dict[str, bytes] = {}
        self._folder = folder
        self._taken: dict[str, TriangleMesh] = {}

    def take(self, wanted: str, mesh: TriangleMesh) -> str:
        name = wanted if is_plain(wanted) and wanted.lower().endswith(".ply") else _plain_name(wanted)
        if self._is_free(name, mesh):
            return name
        stem = DIGEST_ENDING.sub("", PurePath(name).stem)
        name = f"{stem}-{digest(ply_bytes(mesh))[:12]}.ply"
        if not self._is_free(name, mesh):
            self.new[name] = ply_bytes(mesh)  # a damaged copy of this very mesh stands there
        return name

    def _is_free(self, name: str, mesh: TriangleMesh) -> bool:
        """Whether the name can stand for the mesh; notes the file to write where there is none."""
        taken = self._taken.get(name.casefold())
        if taken is not None:
            return same_mesh(taken, mesh)
        path = self._folder / name
        if not path.exists():
            self.new[name] = ply_bytes(mesh)
        elif not _holds(path, mesh):
            return False
        self._taken[name.casefold()] = mesh
        return True


def _holds(path: Path, mesh: TriangleMesh) -> bool:
    """Whether a file holds a mesh; one that we wrote is told by its bytes, ten times as fast as by reading it."""
    try:
        return holds(path, ply_bytes(mesh)) or same_mesh(read_mesh(path), mesh)
    except InputError:
        return False


def is_plain(name: str) -> bool:
    """Whether a name can stand in the folder itself on every system."""
    forbidden = re.search(r'[\\/:*?"<>|\x00-\x1f\ud800-\udfff]', name)
    return forbidden is None and 0 < len(name) <= MAX_NAME_LENGTH and not name.startswith(".")


def _plain_name(name: str) -> str:
    return f"{file_stem(PurePath(name.replace(chr(92), '/')).stem) or 'mesh'}.ply"


def file_stem(name: str) -> str:
    """A name as part of a file name on every system; empty where nothing is left of it."""
    return re.sub(r"[^A-Za-z0-9._-]+", "-", name)[:80].strip(".-")


def _rounded(mesh: TriangleMesh) -> TriangleMesh:
    """The mesh with coordinates as a mesh file holds them; the very object where they are so already."""
    single = mesh.vertices_enu_m.astype(np.float32).astype(np.float64)
    return mesh if bool((single == mesh.vertices_enu_m).all()) else TriangleMesh(single, mesh.triangles)
