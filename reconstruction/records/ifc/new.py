"""A new IFC 4 file of a building's panes: curtain walls, plates with thin bodies, and the records as property sets.

Coordinates are the ENU frame's, in metres. No IfcMapConversion is written: a map's plane is not the frame's, which is
level at its origin; latitude, longitude and elevation of IfcSite, with true north along y, say where it is exactly.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.json_file import check_output, write_atomically
from planning.base.messages import say
from planning.geo.frames import Origin
from planning.geo.geoid import undulation_m
from planning.geo.mesh import TriangleMesh
from planning.site.importing.ifc_content import OUTSIDE_NORMAL, OUTSIDE_SET
from reconstruction.records.book import RecordBook
from reconstruction.records.entries import Attribute, global_id_of
from reconstruction.records.ifc.extract import OUR_SETS, Property, PropertySet, open_model, property_sets
from reconstruction.records.objects import Corners, ObjectRow

# Property sets of ours into an IFC file: lines for its end, and lines that go. Runs in a process of its own.


class Extension(msgspec.Struct, frozen=True):
    """What makes a file with our sets of one without, or with older ones.

    Parameters
    ----------
    lines
        New instances, for the end of the data.
    replaced
        Instances that change, by their number; "" takes one out.
    n_instances
        That the file has then.
    extended
        GlobalIds that got property sets.
    missing
        GlobalIds with records that no element has.
    """

    lines: tuple[str, ...]
    replaced: dict[int, str]
    n_instances: int
    extended: tuple[str, ...]
    missing: tuple[str, ...]


def extension(path: Path, sets: dict[str, tuple[PropertySet, ...]], known: frozenset[str]) -> Extension:
    """Lines that bring property sets to the elements with these GlobalIds; older ones of ours go.

    Parameters
    ----------
    known
        GlobalIds of all objects, also of those without records by now.

    Raises
    ------
    InputError
        The file cannot be parsed, or a reference in it leads nowhere.
    """
    model = open_model(path)
    try:
        elements = {each.GlobalId: each for each in model.by_type("IfcObject") if each.GlobalId in known}
        replaced = _without_ours(model, frozenset(elements))
        lines: list[str] = []
        for global_id, element in elements.items():
            for each in sets.get(global_id, ()):
                lines += [new.to_string() for new in added_set(model, element, each)]
        missing = tuple(global_id for global_id in sets if global_id not in elements)
        extended = tuple(global_id for global_id in elements if sets.get(global_id))
        return Extension(tuple(f"{line};" for line in lines), replaced, len(list(model)), extended, missing)
    except (RuntimeError, AttributeError, TypeError, ValueError, KeyError, IndexError) as error:
        raise InputError(say("this IFC file is broken ({}: {})", type(error).__name__, error, place=path)) from error


def added_set(model: Any, element: Any, property_set: PropertySet) -> list[Any]:
    """New instances that give an element a property set; their GlobalIds follow from the element's."""
    properties = [_property(model, each) for each in property_set.properties]
    key, history = f"{element.GlobalId} {property_set.name}", element.OwnerHistory
    added = model.create_entity(
        "IfcPropertySet",
        GlobalId=global_id_of(key, "set"),
        OwnerHistory=history,
        Name=property_set.name,
        HasProperties=properties,
    )
    relation = model.create_entity(
        "IfcRelDefinesByProperties",
        GlobalId=global_id_of(key, "relation"),
        OwnerHistory=history,
        RelatedObjects=[element],
        RelatingPropertyDefinition=added,
    )
    return [*properties, added, relation]


def _property(model: Any, stated: Property) -> Any:
    # By their places: IFC 4.3 calls the description a specification.
    values = (stated.name, stated.description or None, _value(model, stated))
    return model.create_entity("IfcPropertySingleValue", *values)


def _value(model: Any, stated: Property) -> Any:
    if stated.kind == "yes/no":
        return model.create_entity("IfcBoolean", bool(stated.value))
    if stated.kind == "number":
        return model.create_entity("IfcReal", float(stated.value))
    # IFC 2x3 knows no plain dates.
    kind = "IfcDate" if stated.kind == "date" and model.schema != "IFC2X3" else "IfcText"
    return model.create_entity(kind, str(stated.value))


def _without_ours(model: Any, elements: frozenset[str]) -> dict[int, str]:
    """Take older property sets of ours out of a model; the lines that go or change."""
    replaced: dict[int, str] = {}
    for each in [found for found in model.by_type("IfcPropertySet") if found.Name in OUR_SETS]:
        is_used = False
        for relation in model.get_inverse(each):
            others = (
                [other for other in relation.RelatedObjects if other.GlobalId not in elements]
                if relation.is_a("IfcRelDefinesByProperties")
                else [relation]
            )
            if not others:
                replaced[relation.id()] = ""
                model.remove(relation)
            elif relation.is_a("IfcRelDefinesByProperties") and len(others) < len(relation.RelatedObjects):
                relation.RelatedObjects = others
                replaced[relation.id()] = f"{relation.to_string()};"
            is_used = is_used or bool(others)
        if not is_used:
            properties = [found for found in each.HasProperties if model.get_total_inverses(found) == 1]
            replaced |= dict.fromkeys((each.id(), *(found.id() for found in properties)), "")
            for gone in (each, *properties):
                model.remove(gone)
    return replaced


Array = NDArray[np.float64]

THICKNESS_M = 0.024
"""Of a pane whose thickness is not recorded: double glazing of 4 + 16 + 4 mm."""

THICKNESSES_M = (0.001, 0.3)
"""Of bodies: what the records say beyond is a mistake in its unit."""

TRANSPARENCY = 0.7

STANDARD_SETS = {
    "maker": ("Pset_ManufacturerTypeInformation", "Manufacturer"),
    "product": ("Pset_ManufacturerTypeInformation", "ModelLabel"),
    "warranty_until": ("Pset_Warranty", "WarrantyEndDate"),
}
"""Where buildingSMART has a place for an attribute of ours, it stands there too."""

BOX_FACES = np.array(
    [[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]]
    + [[a, a + 4, b + 4] for a, b in ((0, 1), (1, 2), (2, 3), (3, 0))]
    + [[a, b + 4, b] for a, b in ((0, 1), (1, 2), (2, 3), (3, 0))]
)
"""Triangles of a pane's body: corners 0 to 3 outside, 4 to 7 inside, seen from outside the body counter-clockwise."""


def write_new_ifc(book: RecordBook, out: Path, mesh: TriangleMesh | None = None) -> tuple[str, ...]:
    """Write the objects that the model has, with their records, whole or not at all.

    Parameters
    ----------
    mesh
        The building behind the panes, ENU metres; it tells readers which side of them is outside.

    Returns
    -------
    notes
        What the file lacks.

    Raises
    ------
    InputError
        There is no panel, the records are damaged, or the file cannot be written.
    """
    check_output(out, [book.path])
    with book.database.snapshot():
        rows, origin = book.objects(), book.origin
        sets = property_sets(book)
        attributes = {(each.global_id, each.name): each.value for each in book.entries(Attribute)}
    if not rows:
        raise InputError(say("holds no objects yet; 'records FOLDER make' takes them from a site", place=book.path))
    if not any(row.layer == "element" for row in rows):
        raise InputError(say("not written: there are no panels; choose other components", place=out))
    building = _Building(rows, origin)
    for row in rows:
        building.add(row, attributes)
    if mesh is not None and len(mesh.triangles):
        building.add_mesh(mesh)
    building.relate()
    for row in rows:
        for wanted in (*sets.get(row.global_id, ()), *_standard_sets(row.global_id, attributes), *_outside(row)):
            added_set(building.model, building.elements[row.global_id], wanted)
    write_atomically(out, building.model.to_string().encode("ascii", "replace"))
    notes = () if origin is not None else (say("the place on earth is not known to the records: IfcSite has none"),)
    return (*notes, *(() if mesh is not None else (say("the building behind the panes is not in the file"),)))


class _Building:
    """A model in the making."""

    def __init__(self, rows: Sequence[ObjectRow], origin: Origin | None) -> None:
        import ifcopenshell

        self.model = ifcopenshell.file(schema="IFC4")
        scene = next((row for row in rows if row.layer == "scene"), None)
        self._name = scene.name if scene is not None else "building"
        self._walls = {row.parent for row in rows if row.layer == "element"}
        self._background: Any = None
        self._key = scene.global_id if scene is not None else rows[0].global_id
        self.elements: dict[str, Any] = {}
        self._parts: dict[str, list[Any]] = {}
        self._contained: list[Any] = []
        self._materials: dict[str, list[Any]] = {}
        make = self._make
        self._placement = make("IfcLocalPlacement", RelativePlacement=self._axes())
        self._context = make(
            "IfcGeometricRepresentationContext", ContextType="Model", CoordinateSpaceDimension=3, Precision=1e-5,
            WorldCoordinateSystem=self._axes(), TrueNorth=make("IfcDirection", DirectionRatios=(0.0, 1.0)),
        )  # fmt: skip
        self._glass = self._style()
        self._frame(scene, origin)

    def _make(self, kind: str, **values: Any) -> Any:
        return self.model.create_entity(kind, **{name: value for name, value in values.items() if value is not None})

    def _rooted(self, kind: str, name: str, **values: Any) -> Any:
        return self._make(kind, GlobalId=global_id_of(self._key, f"{kind} {name}"), Name=name, **values)

    def _axes(self) -> Any:
        return self._make("IfcAxis2Placement3D", Location=self._make("IfcCartesianPoint", Coordinates=(0.0, 0.0, 0.0)))

    def _style(self) -> Any:
        colour = self._make("IfcColourRgb", Red=0.6, Green=0.75, Blue=0.8)
        shading = self._make("IfcSurfaceStyleShading", SurfaceColour=colour, Transparency=TRANSPARENCY)
        return self._make("IfcSurfaceStyle", Name="glass", Side="BOTH", Styles=[shading])

    def _frame(self, scene: ObjectRow | None, origin: Origin | None) -> None:
        """Project, site and building."""
        units = [
            self._make("IfcSIUnit", UnitType=kind, Name=name)
            for kind, name in (
                ("LENGTHUNIT", "METRE"), ("AREAUNIT", "SQUARE_METRE"), ("VOLUMEUNIT", "CUBIC_METRE"),
                ("PLANEANGLEUNIT", "RADIAN"),
            )
        ]  # fmt: skip
        project = self._rooted(
            "IfcProject", self._name, RepresentationContexts=[self._context],
            UnitsInContext=self._make("IfcUnitAssignment", Units=units),
        )  # fmt: skip
        place: dict[str, Any] = {}
        if origin is not None:
            geoid_m = float(undulation_m(origin.lat_deg, origin.lon_deg))
            place = {
                "RefLatitude": _angle(origin.lat_deg),
                "RefLongitude": _angle(origin.lon_deg),
                "RefElevation": origin.ellipsoid_height_m - geoid_m,
            }
        common = {"ObjectPlacement": self._placement, "CompositionType": "ELEMENT"}
        site = self._rooted("IfcSite", self._name, **common, **place)
        self.building = self._make(
            "IfcBuilding",
            GlobalId=scene.global_id if scene is not None else global_id_of(self._key, "IfcBuilding"),
            Name=self._name,
            **common,
        )
        if scene is not None:
            self.elements[scene.global_id] = self.building
        for whole, part in ((project, site), (site, self.building)):
            self._rooted("IfcRelAggregates", part.is_a(), RelatingObject=whole, RelatedObjects=[part])

    def add(self, row: ObjectRow, attributes: Mapping[tuple[str, str], Any]) -> None:
        """Add one object; parents come before their parts."""
        if row.layer == "scene":
            return
        # A component without panes is what stands behind them.
        whole = "IfcCurtainWall" if row.global_id in self._walls else "IfcBuildingElementProxy"
        kind = "IfcPlate" if row.layer == "element" else whole
        element = self._make(
            kind,
            GlobalId=row.global_id,
            Name=row.name,
            ObjectPlacement=self._placement,
            PredefinedType="CURTAIN_PANEL" if kind == "IfcPlate" else None,
        )
        self.elements[row.global_id] = element
        if kind == "IfcBuildingElementProxy" and self._background is None:
            self._background = element
        if row.corners_enu_m is not None:
            thickness_mm = attributes.get((row.global_id, "thickness"))
            element.Representation = self._body(*_pane_body(row.corners_enu_m, thickness_mm), glass=True)
        parent = self.elements.get(row.parent or "")
        if parent is not None and parent.is_a("IfcCurtainWall"):
            self._parts.setdefault(parent.GlobalId, []).append(element)
        else:
            self._contained.append(element)
        material = attributes.get((row.global_id, "material"))
        if material is not None:
            self._materials.setdefault(str(material), []).append(element)

    def add_mesh(self, mesh: TriangleMesh) -> None:
        """Add the building behind the panes."""
        shape = self._body(mesh.vertices_enu_m, np.asarray(mesh.triangles), glass=False)
        if self._background is not None:
            self._background.Representation = shape
            return
        proxy = self._rooted(
            "IfcBuildingElementProxy", "building", ObjectPlacement=self._placement, Representation=shape
        )
        self._contained.append(proxy)

    def relate(self) -> None:
        """Put parts into wholes, and materials to elements."""
        for global_id, parts in self._parts.items():
            whole = self.elements[global_id]
            self._rooted("IfcRelAggregates", global_id, RelatingObject=whole, RelatedObjects=parts)
        if self._contained:
            self._rooted(
                "IfcRelContainedInSpatialStructure", "content", RelatedElements=self._contained,
                RelatingStructure=self.building,
            )  # fmt: skip
        for name, elements in self._materials.items():
            material = self._make("IfcMaterial", Name=name[:255])
            self._rooted("IfcRelAssociatesMaterial", name[:200], RelatedObjects=elements, RelatingMaterial=material)

    def _body(self, points: Array, triangles: NDArray[Any], glass: bool) -> Any:
        faces = self._make(
            "IfcTriangulatedFaceSet",
            Coordinates=self._make("IfcCartesianPointList3D", CoordList=points.tolist()),
            Closed=True if glass else None,
            CoordIndex=(triangles + 1).tolist(),
        )
        if glass:
            self._make("IfcStyledItem", Item=faces, Styles=[self._glass])
        shape = self._make(
            "IfcShapeRepresentation", ContextOfItems=self._context, RepresentationIdentifier="Body",
            RepresentationType="Tessellation", Items=[faces],
        )  # fmt: skip
        return self._make("IfcProductDefinitionShape", Representations=[shape])


def _pane_body(corners: Corners, thickness_mm: Any) -> tuple[Array, NDArray[Any]]:
    """Points and triangles of a pane whose outer face has the corners."""
    outer = np.array(corners)
    normal = np.cross(outer[2] - outer[0], outer[3] - outer[1])
    thickness_m = THICKNESS_M if thickness_mm is None else float(thickness_mm) / 1000.0
    if not THICKNESSES_M[0] <= thickness_m <= THICKNESSES_M[1]:
        thickness_m = THICKNESS_M
    length = float(np.linalg.norm(normal))
    inner = outer - thickness_m * normal / length if length > 0.0 else outer
    return np.concatenate([outer, inner]), BOX_FACES


def _standard_sets(global_id: str, attributes: Mapping[tuple[str, str], Any]) -> tuple[PropertySet, ...]:
    found: dict[str, list[Property]] = {}
    for name, (set_name, property_name) in STANDARD_SETS.items():
        value = attributes.get((global_id, name))
        if value is not None:
            kind = "date" if name == "warranty_until" else "text"
            found.setdefault(set_name, []).append(Property(property_name, value, kind))  # type: ignore[arg-type]
    return tuple(PropertySet(name, tuple(properties)) for name, properties in found.items())


def _outside(row: ObjectRow) -> tuple[PropertySet, ...]:
    """Which way is outside, as no body of a pane tells it and the building behind may not be in the file."""
    if row.layer != "element" or row.corners_enu_m is None:
        return ()
    corners = np.array(row.corners_enu_m)
    normal = np.cross(corners[2] - corners[0], corners[3] - corners[1])
    length = float(np.linalg.norm(normal))
    if not 0.0 < length < np.inf:
        return ()
    values = (normal / length).round(9).tolist()
    properties = (Property(name, value, "number") for name, value in zip(OUTSIDE_NORMAL, values, strict=True))
    return (PropertySet(OUTSIDE_SET, tuple(properties)),)


def _angle(degrees: float) -> tuple[int, int, int, int]:
    """Whole degrees, minutes, seconds and millionths of seconds, all with the sign."""
    sign = -1 if degrees < 0.0 else 1
    seconds, millionths = divmod(round(abs(degrees) * 3.6e9), 1_000_000)
    minutes, seconds = divmod(seconds, 60)
    whole, minutes = divmod(minutes, 60)
    return sign * whole, sign * minutes, sign * seconds, sign * millionths
