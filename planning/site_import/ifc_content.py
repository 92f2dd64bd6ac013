"""What is read from an IFC file with IfcOpenShell, as plain numbers and texts: runs in a process of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.errors import InputError
from planning.site_import.ifc_place import MapParameters, SitePlace, map_parameters, site_place, true_north_rad
from planning.site_import.ifc_windows import Shape, glazed_plates, joined, plate_pane, skin_panes, window_pane
from planning.site_import.polygons import area_vector
from planning.site_import.window_faces import Pane
from planning.step_file import real_name

Array = NDArray[np.float64]

NOT_IN_MESH = (
    "IfcFeatureElement",  # openings and projections act on other elements
    "IfcFurnishingElement",
    "IfcVirtualElement",
    "IfcGeographicElement",  # terrain: home stands on it
    "IfcReinforcingElement",
    "IfcFastener",
    "IfcMechanicalFastener",
)
"""Elements that are no part of what a drone can meet outside. Spaces, grids, annotations and sites are no elements."""

OUTSIDE_SET, OUTSIDE_NORMAL = "Pset_ReflightPane", ("OutwardX", "OutwardY", "OutwardZ")
"""Property set of a pane of ours: which way is outside, in the coordinates of its placement."""


@dataclass(frozen=True, slots=True)
class IfcContent:
    """An IFC file without its triangles. Lengths are metres, coordinates those of the model.

    Parameters
    ----------
    name
        Of the building; may be empty.
    schema
        IFC2X3, IFC4 ...
    pane_ids, outlines, thicknesses_m, are_oriented
        Of windows and glazed plates; outlines are lists of points, see `SourceWindow`.
    unit_m
        Metres per length unit of the file.
    site_z_m
        Height of the site's zero, None without a site.
    site
        Place of the site, if the file has it.
    map
        Map conversion, if the file has one.
    north_rad
        Direction of true north, counter-clockwise from the model's y axis.
    notes
        What was read and what was left out.
    """

    name: str
    schema: str
    pane_ids: tuple[str, ...]
    outlines: tuple[tuple[tuple[float, float, float], ...], ...]
    thicknesses_m: tuple[float, ...]
    are_oriented: tuple[bool, ...]
    unit_m: float
    site_z_m: float | None
    site: SitePlace | None
    map: MapParameters | None
    north_rad: float
    notes: tuple[str, ...]


class _Elements(NamedTuple):
    """Elements of the mesh, the glass among them by GlobalId, and the windows that parts belong to."""

    all: list[Any]
    windows: dict[str, Any]
    plates: dict[str, Any]
    window_of_part: dict[str, str]


def extract(path: Path, deflection_m: float, n_threads: int, report: Callable[[int], None]) -> tuple[IfcContent, Array]:
    """Content of an IFC file, and the triangles of all its building elements, shape (t, 3, 3), metres.

    Parameters
    ----------
    deflection_m
        Largest distance between a curved surface and its triangles.
    n_threads
        Threads that compute geometry.
    report
        Takes the per cent of the geometry that is done.

    Raises
    ------
    InputError
        The file cannot be parsed, or a reference in it leads nowhere or to something of another kind.
    """
    import ifcopenshell

    try:
        model = ifcopenshell.open(str(path))
    except Exception as error:  # the parser raises whatever goes wrong in it
        raise InputError(
            f"{path}: this IFC file cannot be read ({error}); IFC 2x3, IFC 4 and IFC 4.3 are read"
        ) from error
    try:
        return _extract(model, deflection_m, n_threads, report)
    except (RuntimeError, AttributeError, TypeError, ValueError, KeyError, IndexError) as error:
        raise InputError(f"{path}: this IFC file is broken ({type(error).__name__}: {error})") from error


def _extract(
    model: Any, deflection_m: float, n_threads: int, report: Callable[[int], None]
) -> tuple[IfcContent, Array]:
    from ifcopenshell.util.placement import get_local_placement
    from ifcopenshell.util.unit import calculate_unit_scale

    unit_m = float(calculate_unit_scale(model))
    elements = _elements(model)
    shapes = {shape.guid: shape for shape in _shapes(model, elements.all, deflection_m, n_threads, report)}
    panes, notes = _panes(elements, shapes)
    outwards = _outwards(model)
    panes = {guid: _facing(pane, outwards.get(guid)) for guid, pane in panes.items()}
    sites = model.by_type("IfcSite")
    content = IfcContent(
        name=_name(model),
        schema=model.schema,
        pane_ids=tuple(panes),
        outlines=tuple(tuple((float(x), float(y), float(z)) for x, y, z in pane.outline) for pane in panes.values()),
        thicknesses_m=tuple(pane.thickness_m for pane in panes.values()),
        are_oriented=tuple(pane.is_oriented for pane in panes.values()),
        unit_m=unit_m,
        site_z_m=float(get_local_placement(sites[0].ObjectPlacement)[2, 3]) * unit_m if sites else None,
        site=site_place(model, unit_m),
        map=map_parameters(model),
        north_rad=true_north_rad(model),
        notes=tuple(notes),
    )
    return content, np.concatenate([np.zeros((0, 3, 3)), *(shape.triangles for shape in shapes.values())])


def _elements(model: Any) -> _Elements:
    excluded: set[int] = set()
    for kind in NOT_IN_MESH:
        try:
            excluded |= {element.id() for element in model.by_type(kind)}
        except RuntimeError:  # a class that this schema does not have
            continue
    windows = {window.GlobalId: window for window in model.by_type("IfcWindow")}
    window_of_part = {
        part.GlobalId: guid
        for guid, window in windows.items()
        for relation in window.IsDecomposedBy
        for part in relation.RelatedObjects
    }
    return _Elements(
        [element for element in model.by_type("IfcElement") if element.id() not in excluded],
        windows,
        {plate.GlobalId: plate for plate in model.by_type("IfcPlate") if plate.GlobalId not in window_of_part},
        window_of_part,
    )


def _shapes(
    model: Any, elements: list[Any], deflection_m: float, n_threads: int, report: Callable[[int], None]
) -> Iterator[Shape]:
    """Triangles of all elements that have any.

    The geometry kernel is Open Cascade: Manifold is ten times faster, but it cuts 2 of the 796 elements of a real
    office wrongly and leaves pieces of wall in the air.
    """
    import ifcopenshell.geom

    settings = ifcopenshell.geom.settings()
    settings.set("use-world-coords", True)
    settings.set("mesher-linear-deflection", deflection_m)
    settings.set("apply-default-materials", False)  # they make every window transparent, frames included
    iterator = ifcopenshell.geom.iterator(settings, model, n_threads, include=elements)
    if not elements or not iterator.initialize():
        return
    while True:
        report(iterator.progress())
        shape = iterator.get()
        vertices = np.array(shape.geometry.verts, np.float64).reshape(-1, 3)
        faces = np.array(shape.geometry.faces, np.int64).reshape(-1, 3)
        # The last entry is that of faces without a style (number -1).
        styles = np.array([*(style.transparency for style in shape.geometry.materials), np.nan], np.float64)
        numbers = np.array(shape.geometry.material_ids, np.int64)
        if len(faces) and np.isfinite(vertices).all():
            yield Shape(shape.guid, shape.type, vertices[faces], styles[numbers])
        if not iterator.next():
            return


def _panes(elements: _Elements, shapes: dict[str, Shape]) -> tuple[dict[str, Pane], list[str]]:
    """Panes of windows and of glazed plates by their identifiers, and what was left out."""
    panes: dict[str, Pane] = {}
    parts: dict[str, list[Shape]] = {}
    for part, window in elements.window_of_part.items():
        if part in shapes:
            parts.setdefault(window, []).append(shapes[part])
    for guid, window in elements.windows.items():
        shape = shapes.get(guid) or (joined(guid, parts[guid]) if guid in parts else None)
        if shape is not None:
            panes[guid] = window_pane(shape, _axes(window))
    n_windows = len(panes)
    plates = {guid: element for guid, element in elements.plates.items() if guid in shapes}
    glazed = glazed_plates(plates, shapes)
    panes |= {guid: plate_pane(shapes[guid]) for guid in glazed}
    for shape in shapes.values():
        if shape.kind == "IfcCurtainWall" and len(shape.glass):
            panes |= {f"{shape.guid}#{k}": pane for k, pane in enumerate(skin_panes(shape))}
    notes = [f"windows: {n_windows}; plates: {len(plates)}, of which glazed: {len(glazed)}"]
    if n_windows < len(elements.windows):
        notes.append(f"windows left out because they have no geometry: {len(elements.windows) - n_windows}")
    return panes, notes


def _axes(element: Any) -> Array:
    """Axes of an element's placement in model coordinates, rows of shape (3, 3)."""
    from ifcopenshell.util.placement import get_local_placement

    return np.asarray(get_local_placement(element.ObjectPlacement), np.float64)[:3, :3].T


def _name(model: Any) -> str:
    """Name of the building, where it has a real one."""
    return real_name(
        *(name for building in model.by_type("IfcBuilding") for name in (building.LongName, building.Name))
    )


def _outwards(model: Any) -> dict[str, Array]:
    """Directions in which elements say that outside is, by their identifiers, in model coordinates."""
    found: dict[str, Array] = {}
    for properties in model.by_type("IfcPropertySet"):
        if properties.Name != OUTSIDE_SET:
            continue
        values = {each.Name: each.NominalValue for each in properties.HasProperties if hasattr(each, "NominalValue")}
        try:
            local = np.array([float(values[name].wrappedValue) for name in OUTSIDE_NORMAL])
        except (KeyError, AttributeError, TypeError, ValueError):
            continue
        for element in properties.DefinesOccurrence[0].RelatedObjects if properties.DefinesOccurrence else ():
            found[element.GlobalId] = local @ _axes(element)
    return found


def _facing(pane: Pane, outwards: Array | None) -> Pane:
    """A pane whose outline turns as seen from outside, where that is known."""
    if outwards is None:
        return pane
    along = float(area_vector(pane.outline) @ outwards)
    return Pane(pane.outline if along >= 0.0 else pane.outline[::-1], pane.thickness_m, is_oriented=along != 0.0)
