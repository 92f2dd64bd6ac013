"""What is read from an IFC file with IfcOpenShell, as plain numbers and texts: runs in a process of its own."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.step_physical_file import real_name, repaired_file
from planning.geo.mesh import row_numbers
from planning.site.importing.polygons import area_vector
from planning.site.importing.source import left_out_notes
from planning.site.importing.window_faces import MIN_GLASS_SHARE, Pane, covered_area, facing_axis, pane_of

# What an IFC file says about its place: map conversion, latitude and longitude of the site, true north. Plain data.


@dataclass(frozen=True, slots=True)
class SitePlace:
    """Place of IfcSite.

    Parameters
    ----------
    zero_m
        Origin of the site's placement, model coordinates, metres: the point whose place is given.
    """

    lat_deg: float
    lon_deg: float
    altitude_amsl_m: float
    zero_m: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class MapParameters:
    """IfcMapConversion and IfcProjectedCRS in the file's own units; None where it says nothing.

    Parameters
    ----------
    crs, vertical
        Name of the projected system, and of the vertical datum.
    map_unit_m
        Metres per unit of the map's numbers.
    eastings, northings, height
        Of the model's zero, in map units.
    abscissa, ordinate
        Direction of the model's x axis on the map.
    scale, scale_z
        From file units to map units.
    """

    crs: str | None
    vertical: str | None
    map_unit_m: float | None
    eastings: float
    northings: float
    height: float
    abscissa: float
    ordinate: float
    scale: float
    scale_z: float


def _map_parameters(model: Any) -> MapParameters | None:
    """From IfcMapConversion and IfcProjectedCRS, or the property sets that stand for them in IFC 2x3."""
    if model.schema == "IFC2X3":
        sets = _property_sets(model)
        conversion, crs = sets.get("epset_mapconversion"), sets.get("epset_projectedcrs", {})
        map_unit_m = _named_unit_m(str(crs.get("MapUnit")))
    else:
        conversions = model.by_type("IfcMapConversion")
        conversion = conversions[0].get_info() if conversions else None
        target = conversions[0].TargetCRS if conversions else None
        crs = {} if target is None else target.get_info()
        map_unit_m = _entity_unit_m(crs.get("MapUnit"))
    if not conversion:
        return None

    def number(key: str, default: float) -> float:
        value = conversion.get(key)
        return default if value is None else float(value)

    scale = number("Scale", 1.0) or 1.0
    abscissa, ordinate = number("XAxisAbscissa", 0.0), number("XAxisOrdinate", 0.0)
    return MapParameters(
        crs=crs.get("Name") or None,
        vertical=crs.get("VerticalDatum") or None,
        map_unit_m=map_unit_m,
        eastings=number("Eastings", 0.0),
        northings=number("Northings", 0.0),
        height=number("OrthogonalHeight", 0.0),
        abscissa=abscissa if abscissa or ordinate else 1.0,
        ordinate=ordinate,
        scale=scale * number("FactorX", 1.0),
        scale_z=scale * number("FactorZ", 1.0),
    )


def _property_sets(model: Any) -> dict[str, dict[str, Any]]:
    """Property sets of site and project by name in lower case."""
    from ifcopenshell.util.element import get_psets

    found: dict[str, dict[str, Any]] = {}
    for item in (*model.by_type("IfcSite"), *model.by_type("IfcProject")):
        found |= {name.lower(): values for name, values in get_psets(item).items()}
    return found


def _entity_unit_m(unit: Any) -> float | None:
    if unit is None:
        return None
    from ifcopenshell.util.unit import get_unit_scale

    return float(get_unit_scale(unit))


def _named_unit_m(name: str) -> float | None:
    return {"METRE": 1.0, "METER": 1.0, "M": 1.0, "MILLIMETRE": 0.001, "FOOT": 0.3048}.get(name.upper())


def _site_place(model: Any, unit_m: float) -> SitePlace | None:
    """Place of the first IfcSite that has one; zero latitude and longitude together stand for none."""
    from ifcopenshell.util.placement import get_local_placement

    for site in model.by_type("IfcSite"):
        lat_deg, lon_deg = _angle_deg(site.RefLatitude), _angle_deg(site.RefLongitude)
        if lat_deg is None or lon_deg is None or (lat_deg == 0.0 and lon_deg == 0.0):
            continue
        if abs(lat_deg) > 90.0 or abs(lon_deg) > 180.0:
            raise InputError.say(
                "IfcSite lies at latitude {:g}, longitude {:g}, which is nowhere on earth; give --origin",
                lat_deg,
                lon_deg,
            )
        x, y, z = (float(v) * unit_m for v in get_local_placement(site.ObjectPlacement)[:3, 3])
        return SitePlace(lat_deg, lon_deg, float(site.RefElevation or 0.0) * unit_m, (x, y, z))
    return None


def _angle_deg(parts: Any) -> float | None:
    """Degrees from whole degrees, minutes, seconds and millionths of seconds, which all carry the sign."""
    if not parts:
        return None
    return sum(float(part) / size for part, size in zip(parts, (1.0, 60.0, 3600.0, 3.6e9), strict=False))


def _true_north_rad(model: Any) -> float:
    """Direction of true north in the model's plane, counter-clockwise from its y axis; 0 if the file says nothing."""
    for context in model.by_type("IfcGeometricRepresentationContext", include_subtypes=False):
        north = context.TrueNorth
        if north is not None and context.ContextType == "Model":
            x, y = (float(v) for v in north.DirectionRatios[:2])
            return math.atan2(-x, y) if math.hypot(x, y) > 0.0 else 0.0
    return 0.0


Array = NDArray[np.float64]


# Which parts of an IFC model are glass to be photographed, and where their panes lie.

MIN_TRANSPARENCY = 0.05

MAX_NESTING = 10
"""Parts of parts are followed so far: a file may go in circles."""

GLASS_WORDS = re.compile(
    r"gla[sz]|verre|vitr|vidri|cristal|acrist|vetr[oai]|szyb|szk[lł]|sklo|üveg|lasi\b|стекл|玻璃|ガラス|유리",
    re.IGNORECASE,
)
"""Glass in names of plates and materials, in the languages BIM programs speak."""

NOT_GLASS_WORDS = re.compile(r"wool|fib(er|re)|faser|wolle|laine|lana|opaque|opak|spandrel|brüstung", re.IGNORECASE)


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """Triangles of one element, metres, in model coordinates.

    Parameters
    ----------
    guid, kind
        GlobalId and class (IfcWindow).
    triangles
        Shape (t, 3, 3).
    transparency
        Of the surface style of each triangle, shape (t,); NaN where it has none.
    """

    guid: str
    kind: str
    triangles: Array
    transparency: Array

    @property
    def glass(self) -> Array:
        """Triangles that one can see through."""
        return np.asarray(self.triangles[self.transparency >= MIN_TRANSPARENCY])


def glass_names(element: Any) -> bool | None:
    """What the names of an element, its type and its materials say: glass, not glass, or nothing."""
    from ifcopenshell.util.element import get_materials, get_type

    kind = get_type(element)
    names = [element.Name, element.ObjectType, getattr(kind, "Name", None)]
    names += [getattr(material, "Name", None) for material in get_materials(element)]
    text = " ".join(str(name) for name in names if name)
    if NOT_GLASS_WORDS.search(text):
        return False
    return True if GLASS_WORDS.search(text) else None


def window_pane(shape: Shape, axes: Array) -> Pane:
    """Pane of a window: its transparent faces where they fill it, else its whole body.

    Parameters
    ----------
    axes
        Of the window's own placement, rows of shape (3, 3); a body without glass is thinnest along one of them.
    """
    glass = shape.glass
    if len(glass):
        axis = facing_axis(glass)
        if covered_area(glass, axis) >= MIN_GLASS_SHARE * covered_area(shape.triangles, axis):
            return pane_of(glass, axis)
    points = shape.triangles.reshape(-1, 3)
    return pane_of(shape.triangles, axes[int(np.argmin(np.ptp(points @ axes.T, axis=0)))])


def plate_pane(shape: Shape) -> Pane:
    """Pane of a plate."""
    return pane_of(shape.triangles, facing_axis(shape.triangles))


def joined(guid: str, parts: list[Shape]) -> Shape:
    """A window made of parts, as one shape."""
    return Shape(
        guid,
        "IfcWindow",
        np.concatenate([part.triangles for part in parts]),
        np.concatenate([part.transparency for part in parts]),
    )


def glazed_plates(plates: dict[str, Any], shapes: dict[str, Shape]) -> list[str]:
    """GlobalIds of the plates that are glass.

    A plate of a curtain wall is glass unless the file says otherwise: by its names, or by an opaque surface where other
    plates of the walls are recognised as glass. A plate elsewhere (steelwork, cladding) must be recognised as glass.
    """
    known = {guid: _is_glass(element, shapes[guid]) for guid, element in plates.items()}
    in_wall = {guid for guid, element in plates.items() if is_in_curtain_wall(element)}
    tells_glass_apart = any(known[guid] for guid in in_wall)
    glazed = []
    for guid in plates:
        is_opaque = np.isfinite(shapes[guid].transparency).all()
        if known[guid] or (known[guid] is None and guid in in_wall and not (tells_glass_apart and is_opaque)):
            glazed.append(guid)
    return glazed


def _is_glass(element: Any, shape: Shape) -> bool | None:
    """Whether a plate is glass by its surface or its names; None where neither tells."""
    if 2 * len(shape.glass) >= len(shape.triangles):
        return True
    return glass_names(element)


def is_in_curtain_wall(element: Any) -> bool:
    """Whether an element is a part of a curtain wall, at any depth, or a curtain wall panel by its own type."""
    if getattr(element, "PredefinedType", None) == "CURTAIN_PANEL":
        return True
    for _ in range(MAX_NESTING):
        wholes = [relation.RelatingObject for relation in element.Decomposes]
        if not wholes:
            return False
        element = wholes[0]
        if element.is_a("IfcCurtainWall"):
            return True
    return False


def skin_panes(shape: Shape) -> list[Pane]:
    """Panes of a curtain wall that is one body: one for each connected piece of its glass."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    glass = shape.glass
    vertex = row_numbers(glass.reshape(-1, 3).round(4))
    triangle = np.repeat(np.arange(len(glass)), 3)
    n = len(glass) + int(vertex.max()) + 1
    graph = coo_array((np.ones(len(vertex)), (triangle, len(glass) + vertex)), shape=(n, n))
    label = connected_components(graph, directed=False)[1][: len(glass)]
    pieces = [glass[label == piece] for piece in np.unique(label)]
    return [pane_of(piece, facing_axis(piece)) for piece in pieces]


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

BROKEN = (RuntimeError, AttributeError, TypeError, ValueError, KeyError, IndexError, np.linalg.LinAlgError)
"""What IfcOpenShell raises where a reference leads nowhere, in a circle, or to something of another kind."""

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


def extract(
    path: Path,
    deflection_m: float,
    n_threads: int,
    report: Callable[[int], None],
    fatal: Sequence[str] = (),
    announce: Callable[[str], None] | None = None,
) -> tuple[IfcContent, Array]:
    """Content of an IFC file, and the triangles of all its building elements, shape (t, 3, 3), metres.

    Parameters
    ----------
    deflection_m
        Largest distance between a curved surface and its triangles.
    n_threads
        Threads that compute geometry.
    report
        Takes the per cent of the geometry that is done.
    fatal
        Identifiers of elements that the geometry kernel dies of; they are left out.
    announce
        Takes the identifier of each element before the kernel does, which then takes one after the other.

    Raises
    ------
    InputError
        The file cannot be parsed, or a reference in it leads nowhere or to something of another kind.
    """
    import ifcopenshell

    better = repaired_file(path)
    try:
        model = ifcopenshell.open(str(path)) if better is None else _model_of(better.content)
    except Exception as error:  # the parser raises whatever goes wrong in it
        raise InputError.say(
            "this IFC file cannot be read ({}); IFC 2x3, IFC 4 and IFC 4.3 are read", error, place=path
        ) from error
    try:
        shapes = _one_by_one(announce) if announce is not None else _shapes(n_threads, report)
        return _extract(model, deflection_m, shapes, fatal, () if better is None else better.broken)
    except BROKEN as error:
        raise InputError.say("this IFC file is broken ({}: {})", type(error).__name__, error, place=path) from error


def _model_of(content: bytes) -> Any:
    import ifcopenshell

    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    return ifcopenshell.file.from_string(text)


def _extract(
    model: Any, deflection_m: float, shapes_of: Shaping, fatal: Sequence[str], broken: Sequence[str]
) -> tuple[IfcContent, Array]:
    from ifcopenshell.util.unit import calculate_unit_scale

    unit_m = float(calculate_unit_scale(model))
    elements = _elements(model)
    tried = [element for element in elements.all if element.GlobalId not in fatal]
    shapes = {shape.guid: shape for shape in shapes_of(model, tried, deflection_m)}
    panes, notes, left_out = _panes(elements, shapes)
    outwards = _outwards(model)
    panes = {guid: _facing(pane, outwards.get(guid)) for guid, pane in panes.items()}
    left_out += [e.GlobalId for e in elements.all if e.GlobalId not in shapes and _has_body(e)]
    content = IfcContent(
        name=_name(model),
        schema=model.schema,
        pane_ids=tuple(panes),
        outlines=tuple(tuple((float(x), float(y), float(z)) for x, y, z in pane.outline) for pane in panes.values()),
        thicknesses_m=tuple(pane.thickness_m for pane in panes.values()),
        are_oriented=tuple(pane.is_oriented for pane in panes.values()),
        unit_m=unit_m,
        site_z_m=_site_z_m(model, unit_m),
        site=_site_place(model, unit_m),
        map=_map_parameters(model),
        north_rad=_true_north_rad(model),
        notes=(*notes, *left_out_notes([*broken, *dict.fromkeys(left_out)])),
    )
    return content, np.concatenate([np.zeros((0, 3, 3)), *(shape.triangles for shape in shapes.values())])


def _has_body(element: Any) -> bool:
    """Whether an element has a shape of its own that should have become triangles."""
    representation = element.Representation
    return representation is not None and any(
        each.RepresentationIdentifier == "Body" and each.Items for each in representation.Representations or ()
    )


def _site_z_m(model: Any, unit_m: float) -> float | None:
    from ifcopenshell.util.placement import get_local_placement

    sites = model.by_type("IfcSite")
    try:
        return float(get_local_placement(sites[0].ObjectPlacement)[2, 3]) * unit_m if sites else None
    except BROKEN:
        return None


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


Shaping = Callable[[Any, list[Any], float], Iterator[Shape]]
"""Triangles of all elements of a model that have any, with a deflection in metres."""


def _settings(deflection_m: float) -> Any:
    import ifcopenshell.geom

    settings = ifcopenshell.geom.settings()
    settings.set("use-world-coords", True)
    settings.set("mesher-linear-deflection", deflection_m)
    settings.set("apply-default-materials", False)  # they make every window transparent, frames included
    return settings


def _shapes(n_threads: int, report: Callable[[int], None]) -> Shaping:
    """All elements at once.

    The geometry kernel is Open Cascade: Manifold is ten times faster, but it cuts 2 of the 796 elements of a real
    office wrongly and leaves pieces of wall in the air.
    """

    def shapes(model: Any, elements: list[Any], deflection_m: float) -> Iterator[Shape]:
        import ifcopenshell.geom

        iterator = ifcopenshell.geom.iterator(_settings(deflection_m), model, n_threads, include=elements)
        if not elements or not iterator.initialize():
            return
        while True:
            report(iterator.progress())
            shape = _shape(iterator.get())
            if shape is not None:
                yield shape
            if not iterator.next():
                return

    return shapes


def _one_by_one(announce: Callable[[str], None]) -> Shaping:
    """One element after the other, each announced before, so that the last one is known if the kernel dies of it."""

    def shapes(_model: Any, elements: list[Any], deflection_m: float) -> Iterator[Shape]:
        import ifcopenshell.geom

        settings = _settings(deflection_m)
        for element in elements:
            if element.Representation is None:
                continue
            announce(element.GlobalId)
            try:
                shape = _shape(ifcopenshell.geom.create_shape(settings, element))
            except RuntimeError:  # it has no geometry that can be made
                continue
            if shape is not None:
                yield shape

    return shapes


def _shape(tessellated: Any) -> Shape | None:
    """Triangles of an element; None without any."""
    vertices = np.array(tessellated.geometry.verts, np.float64).reshape(-1, 3)
    faces = np.array(tessellated.geometry.faces, np.int64).reshape(-1, 3)
    if not len(faces) or not np.isfinite(vertices).all():
        return None
    # The last entry is that of faces without a style (number -1).
    styles = np.array([*(style.transparency for style in tessellated.geometry.materials), np.nan], np.float64)
    numbers = np.array(tessellated.geometry.material_ids, np.int64)
    return Shape(tessellated.guid, tessellated.type, vertices[faces], styles[numbers])


def _panes(elements: _Elements, shapes: dict[str, Shape]) -> tuple[dict[str, Pane], list[str], list[str]]:
    """Panes of windows and of glazed plates by their identifiers, notes, and the identifiers of broken windows."""
    panes: dict[str, Pane] = {}
    broken: list[str] = []
    parts: dict[str, list[Shape]] = {}
    for part, window in elements.window_of_part.items():
        if part in shapes:
            parts.setdefault(window, []).append(shapes[part])
    for guid, window in elements.windows.items():
        shape = shapes.get(guid) or (joined(guid, parts[guid]) if guid in parts else None)
        if shape is None:
            continue
        try:
            panes[guid] = window_pane(shape, _axes(window))
        except BROKEN:
            broken.append(guid)
    n_windows = len(panes)
    plates = {guid: element for guid, element in elements.plates.items() if guid in shapes}
    glazed = glazed_plates(plates, shapes)
    panes |= {guid: plate_pane(shapes[guid]) for guid in glazed}
    for shape in shapes.values():
        if shape.kind == "IfcCurtainWall" and len(shape.glass):
            panes |= {f"{shape.guid}#{k}": pane for k, pane in enumerate(skin_panes(shape))}
    notes: list[str] = [say("windows: {}; plates: {}, of which glazed: {}", n_windows, len(plates), len(glazed))]
    if n_windows < len(elements.windows):
        notes.append(say("windows left out because they have no geometry: {}", len(elements.windows) - n_windows))
    return panes, notes, broken


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
