"""CityGML 1.0, 2.0 and 3.0: buildings with their windows, whatever prefixes the file gives its namespaces."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, HostileXml, local_name, parse_xml, read_input_file
from planning.base.messages import say
from planning.base.progress import Monitor
from planning.base.step_physical_file import real_name
from planning.site.importing.city_model import MIN_RING_POINTS, CityBuilding, Rings, city_source
from planning.site.importing.options import ImportOptions
from planning.site.importing.source import SourceModel

Array = NDArray[np.float64]

CITYGML_FILE = FileLimit(say("a CityGML file"), 512 * MIB, say("cut out the buildings wanted"))

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
    """Polygons of a building or of one of its parts, by level of detail, while its elements are walked."""

    faces: dict[int, list[Rings]] = field(default_factory=dict)
    ground: dict[int, list[Rings]] = field(default_factory=dict)
    windows: dict[int, dict[str, list[Rings]]] = field(default_factory=dict)
    parts: list[_Reading] = field(default_factory=list)
    n_implicit: int = 0
    left_out: list[str] = field(default_factory=list)

    def every(self) -> Iterator[_Reading]:
        """The building's own, and those of all parts."""
        yield self
        for part in self.parts:
            yield from part.every()


def read_citygml(path: Path, options: ImportOptions, monitor: Monitor) -> SourceModel:
    """Model of one building of a CityGML file.

    Raises
    ------
    InputError
        The file is not CityGML, is broken or hostile (entities are refused), or see `city_source`.
    """
    root = _parse(path)
    if local_name(root) != "CityModel":
        raise InputError.say(
            "expected a CityGML file (root element CityModel), found '{}'", local_name(root), place=path
        )
    crs = next((element.attrib["srsName"] for element in root.iter() if element.get("srsName")), None)
    buildings = []
    elements = list(_buildings(root))
    for done, element in enumerate(elements):
        monitor.report(say("reading buildings"), done, len(elements))
        buildings.append(_building(path, element, say("building {}", done + 1)))
    return city_source(path, buildings, crs, options, monitor)


def _parse(path: Path) -> Any:
    try:
        return parse_xml(read_input_file(path, CITYGML_FILE), path, forbid_dtd=False)
    except HostileXml as error:
        raise InputError.say("the XML {}, which a CityGML file has no need of; refused", error, place=path) from error
    except ValueError as error:
        raise InputError.say("not valid XML ({})", error, place=path) from error


def _id(element: Element) -> str:
    """The gml:id, empty where there is none."""
    return next((value for key, value in element.attrib.items() if key.rpartition("}")[2] == GML_ID), "")


def _buildings(element: Element) -> Iterator[Element]:
    """Buildings below an element; parts stay with their building."""
    for child in element:
        if local_name(child) == "Building":
            yield child
        else:
            yield from _buildings(child)


def _building(path: Path, element: Element, number: str) -> CityBuilding:
    """A building with all its parts, walls and windows each in their finest level of detail."""
    reading = _Reading()
    try:
        _walk(element, reading, _Place())
    except RecursionError as error:
        raise InputError.say("nested too deeply for a CityGML file", place=path) from error
    building = CityBuilding(
        id=_id(element) or number,
        name=real_name(_name(element), _id(element)),
        part_ids=tuple(_id(part) for part in element.iter() if local_name(part) == "BuildingPart" and _id(part)),
    )
    for number_of_part, part in enumerate(reading.every()):
        for window_id, faces in part.windows[max(part.windows, key=_fineness)].items() if part.windows else ():
            is_new = window_id not in building.windows
            building.windows[window_id if is_new else f"{number_of_part}/{window_id}"] = faces
        if part.faces:
            finest = max(part.faces, key=_fineness)
            building.faces += part.faces[finest]
            building.ground += part.ground.get(finest, [])
        building.n_unread_windows += part.n_implicit
        building.left_out += part.left_out
    return building


def _fineness(lod: int) -> float:
    """Rank of a level of detail; the fourth is the third with its interior, so the third is preferred."""
    return lod if lod < 4 else 2.5


def _name(element: Element) -> str:
    return next((child.text.strip() for child in element if local_name(child) == "name" and child.text), "")


class _Place(NamedTuple):
    """Where in a building a walk has come to: level of detail, window, whether it stands on the ground, nearest id."""

    lod: int = 0
    window_id: str | None = None
    is_ground: bool = False
    id: str = ""


def _walk(element: Element, reading: _Reading, place: _Place) -> None:
    """Collect the polygons below an element; those that are no outlines are left out."""
    place = place._replace(id=_id(element) or place.id)
    for child in element:
        name = local_name(child)
        if name in SKIPPED:
            continue
        if name in POLYGONS:
            _add_polygon(child, reading, place)
        elif name == "BuildingPart":
            reading.parts.append(_Reading())
            _walk(child, reading.parts[-1], place)
        elif name.startswith("lod") and name[3:4].isdigit():
            if "Implicit" in name and place.window_id is not None:
                reading.n_implicit += 1
            _walk(child, reading, place._replace(lod=int(name[3])))
        elif name in WINDOWS:
            window_id = _id(child) or f"window-{sum(map(len, reading.windows.values()))}"
            _walk(child, reading, place._replace(window_id=window_id))
        else:
            _walk(child, reading, place._replace(is_ground=place.is_ground or name == "GroundSurface"))


def _add_polygon(element: Element, reading: _Reading, place: _Place) -> None:
    rings = []
    for ring in (ring for ring in element.iter() if local_name(ring) == "LinearRing"):
        points = _ring(ring)
        if points is not None:
            rings.append(points)
            continue
        reading.left_out.append(_id(ring) or _id(element) or place.id)
        if not rings:  # the outer one: without it there is no face
            return
    if not rings:
        return
    polygon = tuple(rings)
    if place.window_id is not None:
        reading.windows.setdefault(place.lod, {}).setdefault(place.window_id, []).append(polygon)
        return
    reading.faces.setdefault(place.lod, []).append(polygon)
    if place.is_ground:
        reading.ground.setdefault(place.lod, []).append(polygon)


def _ring(ring: Element) -> Array | None:
    """Points of a ring without the repeated last one, shape (k, 3); None where it is no outline in space."""
    numbers: list[str] = []
    for element in ring.iter():
        text = element.text or ""
        if local_name(element) in ("posList", "pos"):
            numbers += text.split()
        elif local_name(element) == "coordinates":
            numbers += text.replace(",", " ").split()
    try:
        values = np.array(numbers, np.float64)
    except ValueError:
        return None
    if len(values) % 3 or not np.isfinite(values).all():
        return None
    points = values.reshape(-1, 3)
    if len(points) > 1 and (points[0] == points[-1]).all():
        points = points[:-1]
    return points if len(points) >= MIN_RING_POINTS else None
