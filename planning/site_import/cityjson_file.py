"""CityJSON 1.0, 1.1 and 2.0: buildings with their windows."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.errors import InputError
from planning.json_file import read_json
from planning.progress import Monitor
from planning.site_import.city_model import CityBuilding, Rings, city_source
from planning.site_import.options import ImportOptions
from planning.site_import.source import SourceModel

Array = NDArray[np.float64]

VERSIONS = ("1.0", "1.1", "2.0")

DEPTHS = {"MultiSurface": 1, "CompositeSurface": 1, "Solid": 2, "MultiSolid": 3, "CompositeSolid": 3}
"""How many lists a surface lies deep in the boundaries of each geometry type."""

NOT_OF_THE_WORLD = ("ClosureSurface", "InteriorWallSurface", "CeilingSurface", "FloorSurface")
"""Surfaces that exist on paper, or only indoors."""

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
        raise InputError(f'{path}: expected a CityJSON file (with "type": "CityJSON")')
    version = str(content.get("version", ""))
    if not version.startswith(VERSIONS):
        raise InputError(f"{path}: expected CityJSON version {', '.join(VERSIONS)}, got '{version}'")
    try:
        vertices = _vertices(content)
        objects = dict(content["CityObjects"].items())
        buildings = [_building(name, objects, vertices) for name in objects if _is_root(objects[name])]
        crs = (content.get("metadata") or {}).get("referenceSystem")
    except (KeyError, TypeError, ValueError, IndexError, AttributeError, RecursionError) as error:
        raise InputError(f"{path}: this CityJSON file is broken ({type(error).__name__}: {error})") from error
    return city_source(path, buildings, None if crs is None else str(crs), options, monitor)


def _vertices(content: dict[str, Any]) -> Array:
    vertices = np.array(content["vertices"], np.float64).reshape(-1, 3)
    transform = content.get("transform")
    if transform is None:
        return vertices
    return np.asarray(vertices * np.array(transform["scale"], float) + np.array(transform["translate"], float))


def _is_root(city_object: dict[str, Any]) -> bool:
    """Whether the object is a building, or a part that has lost its building."""
    return city_object["type"] in PARTS and not city_object.get("parents")


def _building(root: str, objects: dict[str, Any], vertices: Array) -> CityBuilding:
    """A building with all its parts, each in its highest level of detail."""
    attributes = objects[root].get("attributes") or {}
    building = CityBuilding(root, str(attributes.get("name") or root))
    waiting, seen = [root], set()
    while waiting:
        name = waiting.pop()
        if name in seen or name not in objects or objects[name]["type"] not in PARTS:
            continue
        seen.add(name)
        waiting.extend(objects[name].get("children") or [])
        geometries = [g for g in objects[name].get("geometry") or [] if g["type"] in DEPTHS]
        if not geometries:
            continue
        finest = max(_lod(geometry) for geometry in geometries)
        for geometry in geometries:
            if _lod(geometry) == finest:
                _add_surfaces(building, name, geometry, vertices)
    building.part_ids = tuple(sorted(seen - {root}))
    return building


def _lod(geometry: dict[str, Any]) -> float:
    """Level of detail as a number; indoors (LoD 4 of old files) comes last."""
    lod = float(geometry.get("lod", 0))
    return lod if lod < 4.0 else 0.5


def _add_surfaces(building: CityBuilding, owner: str, geometry: dict[str, Any], vertices: Array) -> None:
    depth = DEPTHS[geometry["type"]]
    semantics = geometry.get("semantics") or {}
    meanings = semantics.get("surfaces") or []
    surfaces = list(_flatten(geometry["boundaries"], depth))
    values = list(_flatten_values(semantics.get("values"), depth)) or [None] * len(surfaces)
    if len(values) != len(surfaces):
        raise ValueError(f"'{owner}' has {len(surfaces)} surfaces, but {len(values)} semantic values")
    for surface, value in zip(surfaces, values, strict=True):
        rings: Rings = tuple(_ring(ring, vertices, owner) for ring in surface)
        meaning = {} if value is None else meanings[value]
        kind = meaning.get("type")
        if kind == "Window":
            building.windows.setdefault(_window_id(meaning, owner, value), []).append(rings)
        elif kind not in NOT_OF_THE_WORLD:
            building.faces.append(rings)


def _window_id(meaning: dict[str, Any], owner: str, index: int | None) -> str:
    """The identifier that the surface carries, else its owner's with the surface's number."""
    carried = meaning.get("id") or meaning.get("gml:id") or (meaning.get("attributes") or {}).get("id")
    return str(carried) if carried else f"{owner}#{index}"


def _flatten(boundaries: list[Any], depth: int) -> Iterator[list[list[int]]]:
    """Surfaces (lists of rings) of nested boundaries."""
    for part in boundaries:
        if depth == 1:
            yield part
        else:
            yield from _flatten(part, depth - 1)


def _flatten_values(values: Any, depth: int) -> Iterator[int | None]:
    """Semantic values in the order of the surfaces; a null stands for no value at all."""
    for value in values or []:
        if depth == 1 or value is None:
            yield value
        else:
            yield from _flatten_values(value, depth - 1)


def _ring(indices: list[int], vertices: Array, owner: str) -> Array:
    numbers = np.array(indices, np.int64)
    if numbers.ndim != 1 or len(numbers) < 3 or numbers.min() < 0 or numbers.max() >= len(vertices):
        raise ValueError(
            f"'{owner}' has a ring that is not a list of three or more vertex numbers below {len(vertices)}"
        )
    return np.asarray(vertices[numbers])
