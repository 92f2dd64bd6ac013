"""Reading and writing `site.json` (format reflight-site/1, docs/reference/file-formats.md)."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path, PureWindowsPath
from typing import Any

import msgspec

from planning.base.errors import InputError
from planning.base.files import read_input_file
from planning.base.json_file import (
    JSON_FILE,
    encoded,
    expect_format,
    parse_json,
    plain_values,
    to_record,
    write_atomically,
)
from planning.geo.mesh import TriangleMesh, empty_mesh, ply_bytes, read_mesh
from planning.site.records import SITE_FORMAT, Obstacle, Site, SiteModel, box_geometry
from planning.site.zones.keep_out import read_site_zones
from planning.site.zones.records import ZoneFile


def read_site(path: Path) -> SiteModel:
    """Read a site, the meshes it names and its files of geo-zones, of which one that cannot be read is no error.

    Raises
    ------
    InputError
        The file or a mesh is missing or wrong; the message names the file, the field and what was expected.
    """
    return site_of(read_input_file(path, JSON_FILE), path)


def site_of(written: bytes, path: Path) -> SiteModel:
    """A site from the content of its file `path`, beside which its meshes lie; errors as `read_site`."""
    content = parse_json(written, path)
    expect_format(content, SITE_FORMAT, path)
    site = to_record(content, Site, path)
    folder = path.parent
    name = site.building_mesh
    building = empty_mesh() if name is None else _read_named_mesh(folder, name, f"{path}: building_mesh")
    obstacles = tuple(
        _obstacle_geometry(folder, obstacle, f"{path}: obstacles[{i}].mesh")
        for i, obstacle in enumerate(site.obstacles)
    )
    zones = tuple(read_site_zones(folder, source) for source in site.zones)
    return SiteModel(site, building, obstacles, hashlib.sha256(written).hexdigest(), zones)


def _read_named_mesh(folder: Path, name: str, place: str) -> TriangleMesh:
    try:
        return read_mesh(folder / name)
    except InputError as error:
        raise InputError.say("{}; mesh paths start from the folder of the site file", error, place=place) from error


def _obstacle_geometry(folder: Path, obstacle: Obstacle, place: str) -> TriangleMesh:
    if obstacle.box_enu_m is not None:
        return box_geometry(obstacle)
    assert obstacle.mesh is not None  # Obstacle's own check
    return _read_named_mesh(folder, obstacle.mesh, place)


def site_to_json(site: Site) -> dict[str, Any]:
    """Content of `site.json`; absent optional fields are left out."""
    content: dict[str, Any] = plain_values(site)
    content = {"format": content.pop("format"), **content}
    if content["building_mesh"] is None:
        del content["building_mesh"]
    for name in ("rally_points", "place_from", "is_bare", "terrain", "zones"):
        if not content[name]:
            del content[name]
    if content["airspace"]["min_height_above_ground_m"] is None:
        del content["airspace"]["min_height_above_ground_m"]
    for source in content.get("zones", ()):
        for name in ("permitted", "not_here"):
            if not source[name]:
                del source[name]
    content["obstacles"] = [_without_none(obstacle) for obstacle in content["obstacles"]]
    for facade in content["facades"]:
        facade["panels"] = [_without_none(panel) for panel in facade["panels"]]
    return content


def _without_none(fields: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in fields.items() if value is not None}


def site_bytes(site: Site) -> bytes:
    """The site file of a site, as `write_site` writes it."""
    return msgspec.json.format(encoded(site_to_json(site)), indent=1)


def site_sha256(site: Site) -> str:
    """SHA-256 of the site file that `write_site` would write, hexadecimal."""
    return hashlib.sha256(site_bytes(site)).hexdigest()


def zones_beside(model: SiteModel) -> tuple[Site, dict[str, bytes]]:
    """A site that names its files of geo-zones as they lie beside a copy of it in a folder of its own, and these files.

    A file whose content could not be had stays named, so that the copy says that it is missing.
    """
    sources: dict[ZoneFile, ZoneFile] = {}
    files: dict[str, bytes] = {}
    for number, each in enumerate(model.zones, 1):
        name, mark = PureWindowsPath(each.source.file).name, f"zones-{number}-"
        name = name if name.startswith(mark) else mark + name
        sources[each.source] = replace(each.source, file=name)
        if each.content:
            files[name] = each.content
    return replace(model.site, zones=tuple(sources.get(each, each) for each in model.site.zones)), files


def site_with_files(model: SiteModel, prefix: str = "") -> tuple[Site, dict[str, bytes]]:
    """A site as the first of a set of files of its own, and the others by name: meshes and geo-zones as they are open.

    Parameters
    ----------
    prefix
        Names of the files begin with it.
    """
    site, zones = zones_beside(model)
    files = {f"{prefix}{name}": content for name, content in zones.items()}
    building = None if site.building_mesh is None else f"{prefix}building.ply"
    if building is not None:
        files[building] = ply_bytes(model.building)
    obstacles = []
    for number, (obstacle, mesh) in enumerate(zip(site.obstacles, model.obstacles, strict=True), 1):
        if obstacle.mesh is not None:
            obstacle = replace(obstacle, mesh=f"{prefix}obstacle-{number}.ply")
            files[f"{prefix}obstacle-{number}.ply"] = ply_bytes(mesh)
        obstacles.append(obstacle)
    named = tuple(replace(each, file=f"{prefix}{each.file}") for each in site.zones)
    return replace(site, building_mesh=building, obstacles=tuple(obstacles), zones=named), files


def is_planned_on(planned_sha256: str, model: SiteModel) -> bool:
    """Whether a plan was made for a site, by the checksum that the plan states; True where one of them states none.

    Rally points that were marked since change no plan, nor do geo-zones that were added or tilts of panes that were
    measured: checks look at them anew.
    """
    if not (planned_sha256 and model.sha256) or planned_sha256 == model.sha256:
        return True
    site = model.site
    bare = (replace(site, rally_points=()), replace(site, zones=()), replace(site, rally_points=(), zones=()))
    without = (*bare, *(_without_tilts(each) for each in (site, *bare)))
    return any(each != site and planned_sha256 == site_sha256(each) for each in without)


def _without_tilts(site: Site) -> Site:
    if all(panel.tilt_deg is None for panel in site.panels):
        return site
    return replace(
        site,
        facades=tuple(
            replace(facade, panels=tuple(replace(panel, tilt_deg=None) for panel in facade.panels))
            for facade in site.facades
        ),
    )


def write_site(path: Path, site: Site) -> str:
    """Write a site file, whole or not at all; returns the SHA-256 of what was written.

    Files that it names, meshes and geo-zones, are not touched.
    """
    content = site_bytes(site)
    write_atomically(path, content)
    return hashlib.sha256(content).hexdigest()
