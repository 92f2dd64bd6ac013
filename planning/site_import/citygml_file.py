"""CityGML 1.0, 2.0 and 3.0: buildings with their windows, whatever prefixes the file gives its namespaces."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, ParseError

import numpy as np
from numpy.typing import NDArray

from planning.errors import InputError
from planning.json_file import MAX_FILE_BYTES
from planning.progress import Monitor
from planning.site_import.city_model import CityBuilding, Rings, city_source
from planning.site_import.options import ImportOptions
from planning.site_import.source import SourceModel

Array = NDArray[np.float64]

WINDOWS = ("Window", "WindowSurface")
"""CityGML 1 and 2, and CityGML 3."""

SKIPPED = frozenset(
    (
        *("ClosureSurface", "InteriorWallSurface", "CeilingSurface", "FloorSurface"),
        *("interiorRoom", "interiorBuildingInstallation", "interiorFurniture"),
        *("buildingRoom", "buildingFurniture", "buildingSubdivision", "buildingConstructiveElement"),
        *("appearance", "appearanceMember", "address"),
    )
)
"""Elements whose geometry does not exist in the world, or only indoors."""

POLYGONS = ("Polygon", "Triangle", "Rectangle", "PolygonPatch")

GML_ID = "id"


@dataclass(slots=True)
class _Reading:
    """Polygons of one building, by level of detail, while its elements are walked."""

    faces: dict[int, list[Rings]] = field(default_factory=dict)
    windows: dict[int, dict[str, list[Rings]]] = field(default_factory=dict)
    n_implicit: int = 0


def read_citygml(path: Path, options: ImportOptions, monitor: Monitor) -> SourceModel:
    """Model of one building of a CityGML file.

    Raises
    ------
    InputError
        The file is not CityGML, is broken or hostile (entities are refused), or see `city_source`.
    """
    root = _parse(path)
    if _local(root) != "CityModel":
        raise InputError(f"{path}: expected a CityGML file (root element CityModel), found '{_local(root)}'")
    crs = next((element.attrib["srsName"] for element in root.iter() if element.get("srsName")), None)
    buildings = []
    elements = list(_buildings(root))
    for done, element in enumerate(elements):
        monitor.report("reading buildings", done, len(elements))
        buildings.append(_building(path, element, f"building {done + 1}"))
    return city_source(path, buildings, crs, options, monitor)


def _parse(path: Path) -> Any:
    import defusedxml
    import defusedxml.ElementTree

    try:
        if path.stat().st_size > MAX_FILE_BYTES:
            raise InputError(
                f"{path}: the file has more than {MAX_FILE_BYTES // 2**20} MiB; cut out the buildings wanted"
            )
        return defusedxml.ElementTree.parse(path).getroot()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    except defusedxml.DefusedXmlException as error:
        raise InputError(f"{path}: the XML defines entities, which a CityGML file has no need of; refused") from error
    except (ParseError, LookupError, ValueError) as error:
        raise InputError(f"{path}: not valid XML ({error})") from error


def _local(element: Element) -> str:
    """Name without its namespace."""
    tag = element.tag
    return tag.rpartition("}")[2] if isinstance(tag, str) else ""


def _id(element: Element) -> str:
    """The gml:id, empty where there is none."""
    return next((value for key, value in element.attrib.items() if key.rpartition("}")[2] == GML_ID), "")


def _buildings(element: Element) -> Iterator[Element]:
    """Buildings below an element; parts stay with their building."""
    for child in element:
        if _local(child) == "Building":
            yield child
        else:
            yield from _buildings(child)


def _building(path: Path, element: Element, number: str) -> CityBuilding:
    """A building with all its parts, walls and windows each in their finest level of detail."""
    reading = _Reading()
    try:
        _walk(path, element, reading, lod=0, window_id=None)
    except RecursionError as error:
        raise InputError(f"{path}: nested too deeply for a CityGML file") from error
    return CityBuilding(
        id=_id(element) or number,
        name=_name(element) or _id(element),
        part_ids=tuple(_id(part) for part in element.iter() if _local(part) == "BuildingPart" and _id(part)),
        windows=reading.windows[max(reading.windows, key=_fineness)] if reading.windows else {},
        faces=reading.faces[max(reading.faces, key=_fineness)] if reading.faces else [],
        n_unread_windows=reading.n_implicit,
    )


def _fineness(lod: int) -> float:
    """Rank of a level of detail; the fourth is the third with its interior, so the third is preferred."""
    return lod if lod < 4 else 2.5


def _name(element: Element) -> str:
    return next((child.text.strip() for child in element if _local(child) == "name" and child.text), "")


def _walk(path: Path, element: Element, reading: _Reading, lod: int, window_id: str | None) -> None:
    """Collect the polygons below an element."""
    for child in element:
        name = _local(child)
        if name in SKIPPED:
            continue
        if name in POLYGONS:
            rings = tuple(_ring(path, ring) for ring in child.iter() if _local(ring) == "LinearRing")
            if not rings:
                continue
            if window_id is None:
                reading.faces.setdefault(lod, []).append(rings)
            else:
                reading.windows.setdefault(lod, {}).setdefault(window_id, []).append(rings)
        elif name.startswith("lod") and name[3:4].isdigit():
            if "Implicit" in name and window_id is not None:
                reading.n_implicit += 1
            _walk(path, child, reading, int(name[3]), window_id)
        elif name in WINDOWS:
            _walk(path, child, reading, lod, _id(child) or f"window-{sum(map(len, reading.windows.values()))}")
        else:
            _walk(path, child, reading, lod, window_id)


def _ring(path: Path, ring: Element) -> Array:
    """Points of a ring without the repeated last one, shape (k, 3)."""
    numbers: list[str] = []
    for element in ring.iter():
        text = element.text or ""
        if _local(element) in ("posList", "pos"):
            numbers += text.split()
        elif _local(element) == "coordinates":
            numbers += text.replace(",", " ").split()
    try:
        values = np.array(numbers, np.float64)
    except ValueError as error:
        raise InputError(f"{path}: ring '{_id(ring)}' holds something that is not a number ({error})") from error
    if len(values) % 3 or len(values) < 9 or not np.isfinite(values).all():
        raise InputError(
            f"{path}: ring '{_id(ring)}' has {len(values)} numbers; expected three finite ones for each of its points, "
            "of which there are at least three"
        )
    points = values.reshape(-1, 3)
    return points[:-1] if (points[0] == points[-1]).all() and len(points) > 3 else points
