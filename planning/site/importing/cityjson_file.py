"""CityJSON 1.0, 1.1 and 2.0: buildings with their windows."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.json_file import read_json
from planning.base.progress import Monitor
from planning.base.step_physical_file import real_name
from planning.site.importing.city_model import MIN_RING_POINTS, CityBuilding, Rings, city_source
from planning.site.importing.options import ImportOptions
from planning.site.importing.source import SourceModel

Array = NDArray[np.float64]

VERSIONS = ("1.0", "1.1", "2.0")

DEPTHS = {"MultiSurface": 1, "CompositeSurface": 1, "Solid": 2, "MultiSolid": 3, "CompositeSolid": 3}
"""How many lists a surface lies deep in the boundaries of each geometry type."""

FLAT = ("MultiPoint", "MultiLineString")
"""Geometry types without surfaces."""

NOT_OF_THE_WORLD = ("ClosureSurface", "InteriorWallSurface", "CeilingSurface", "FloorSurface")
"""Surfaces that exist on paper, or only indoors."""

BROKEN = (KeyError, TypeError, ValueError, IndexError, AttributeError, RecursionError, OverflowError)
"""What reading something of another shape than expected raises."""

PARTS = ("Building", "BuildingPart", "BuildingInstallation")
"""Types of city objects that make up a building; rooms and furniture are left out."""


def read_cityjson(path: Path, options: ImportOptions, monitor: Monitor) -> SourceModel:
    """Model of one building of a CityJSON file.

    Raises
    ------
    InputError
        The file is not CityJSON of a version known here, is broken, or see `city_source`.
    """
    content = read_json(path)
    if not isinstance(content, dict) or content.get("type") != "CityJSON":
        raise InputError.say('expected a CityJSON file (with "type": "CityJSON")', place=path)
    version = str(content.get("version", ""))
    if not version.startswith(VERSIONS):
        raise InputError.say("expected CityJSON version {}, got '{}'", ", ".join(VERSIONS), version, place=path)
    try:
        vertices = _vertices(content)
        objects = dict(content["CityObjects"].items())
        crs = (content.get("metadata") or {}).get("referenceSystem")
    except BROKEN as error:
        raise InputError.say(
            "this CityJSON file is broken ({}: {})", type(error).__name__, error, place=path
        ) from error
    buildings = [_building(name, objects, vertices) for name in objects if _is_root(objects[name])]
    return city_source(path, buildings, None if crs is None else str(crs), options, monitor)


def _vertices(content: dict[str, Any]) -> Array:
    """Coordinates of all vertices, shape (n, 3); NaN for what is no point in space."""
    listed = content["vertices"]
    try:
        vertices = np.array(listed, np.float64).reshape(-1, 3)
    except (ValueError, TypeError):
        vertices = np.array([_point(vertex) for vertex in listed], np.float64).reshape(-1, 3)
    transform = content.get("transform")
    if transform is None:
        return vertices
    return np.asarray(vertices * np.array(transform["scale"], float) + np.array(transform["translate"], float))


def _point(vertex: Any) -> list[float]:
    try:
        x, y, z = (float(value) for value in vertex)
    except BROKEN:
        return [np.nan] * 3
    return [x, y, z]


def _is_root(city_object: Any) -> bool:
    """Whether the object is a building, or a part that has lost its building."""
    return isinstance(city_object, dict) and city_object.get("type") in PARTS and not city_object.get("parents")


def _building(root: str, objects: dict[str, Any], vertices: Array) -> CityBuilding:
    """A building with all its parts, each in its highest level of detail; what is broken is left out."""
    attributes = objects[root].get("attributes")
    name = attributes.get("name") if isinstance(attributes, dict) else None
    building = CityBuilding(root, real_name(name, root))
    waiting, seen = [root], set()
    while waiting:
        name = waiting.pop()
        city_object = objects.get(name)
        if name in seen or not isinstance(city_object, dict) or city_object.get("type") not in PARTS:
            continue
        seen.add(name)
        waiting.extend(str(child) for child in _listed(city_object.get("children")))
        levels: list[tuple[float, dict[str, Any]]] = []
        for geometry in _listed(city_object.get("geometry")):
            level = _level(geometry)
            if level is not None:
                levels.append((level, geometry))
            elif not isinstance(geometry, dict) or geometry.get("type") not in FLAT:
                building.left_out.append(f"{name}: {geometry['type']}" if _has_type(geometry) else name)
        finest = max((lod for lod, _ in levels), default=0.0)
        for lod, geometry in levels:
            if lod == finest:
                _add_geometry(building, name, geometry, vertices)
    building.part_ids = tuple(sorted(seen - {root}))
    return building


def _listed(value: Any) -> list[Any]:
    """A list, or nothing where there should be one."""
    return value if isinstance(value, list) else []


def _has_type(geometry: Any) -> bool:
    return isinstance(geometry, dict) and isinstance(geometry.get("type"), str)


def _level(geometry: Any) -> float | None:
    """Level of detail as a number; indoors (LoD 4 of old files) comes last. None where the geometry is not read."""
    try:
        lod = float(geometry.get("lod", 0))
        return (lod if lod < 4.0 else 0.5) if geometry["type"] in DEPTHS else None
    except BROKEN:
        return None


def _add_geometry(building: CityBuilding, owner: str, geometry: dict[str, Any], vertices: Array) -> None:
    """Add the surfaces of a geometry; those that are broken are left out."""
    depth = DEPTHS[geometry["type"]]
    surfaces = list(_flatten(geometry.get("boundaries"), depth))
    semantics = geometry.get("semantics")
    semantics = semantics if isinstance(semantics, dict) else {}
    meanings, values = _listed(semantics.get("surfaces")), list(_flatten(semantics.get("values"), depth))
    if values and len(values) != len(surfaces):
        building.left_out.append(f"{owner}: semantics")
        values = []
    for surface, value in zip(surfaces, values or [None] * len(surfaces), strict=True):
        rings = _rings(surface, vertices)
        if len(rings) < max(1, len(surface) if isinstance(surface, list) else 1):
            building.left_out.append(owner)
        if not rings:
            continue
        meaning = meanings[value] if isinstance(value, int) and 0 <= value < len(meanings) else {}
        kind = meaning.get("type") if isinstance(meaning, dict) else None
        if kind == "Window":
            building.windows.setdefault(_window_id(meaning, owner, value), []).append(rings)
        elif kind not in NOT_OF_THE_WORLD:
            building.faces.append(rings)
            if kind == "GroundSurface":
                building.ground.append(rings)


def _window_id(meaning: dict[str, Any], owner: str, index: int | None) -> str:
    """The identifier that the surface carries, else its owner's with the surface's number."""
    carried = meaning.get("id") or meaning.get("gml:id") or (meaning.get("attributes") or {}).get("id")
    return str(carried) if carried else f"{owner}#{index}"


def _flatten(nested: Any, depth: int) -> Iterator[Any]:
    """Surfaces of nested boundaries, or their semantic values; a null stands for no value at all."""
    for part in _listed(nested):
        if depth == 1 or part is None:
            yield part
        else:
            yield from _flatten(part, depth - 1)


def _rings(surface: Any, vertices: Array) -> Rings:
    """Rings of a surface: none where the outer one is broken, and without those holes that are."""
    rings = [_ring(ring, vertices) for ring in _listed(surface)]
    if not rings or rings[0] is None:
        return ()
    return tuple(ring for ring in rings if ring is not None)


def _ring(indices: Any, vertices: Array) -> Array | None:
    """Points of a ring, shape (k, 3); None where it is no outline in space."""
    try:
        numbers = np.array(indices, np.int64)
    except (ValueError, TypeError, OverflowError):
        return None
    if numbers.ndim != 1 or len(numbers) < MIN_RING_POINTS or numbers.min() < 0 or numbers.max() >= len(vertices):
        return None
    points = vertices[numbers]
    return points if np.isfinite(points).all() else None
