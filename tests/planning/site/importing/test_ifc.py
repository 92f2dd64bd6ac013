"""IFC: small models built here, one for each way a real one differs, and the two real files."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import ifcopenshell
import ifcopenshell.guid
import numpy as np
import pytest

from planning.base.errors import InputError, OperationCancelled
from planning.base.progress import QUIET
from planning.base.step_physical_file import repaired_file
from planning.geo.crs import crs_conversion
from planning.geo.enu import enu_from_geodetic
from planning.geo.frames import Origin
from planning.geo.geoid import undulation_m
from planning.site.importing.ifc_content import IfcContent, extract
from planning.site.importing.ifc_file import ifc_georeference, ifc_source, read_ifc
from planning.site.importing.importer import ImportedSite, assemble, import_site
from planning.site.importing.options import ImportOptions, PanelGrid
from planning.site.importing.polygons import quad_areas, unit_normals
from planning.site.records import panel_corners

Point = tuple[float, float, float]

HERE = ImportOptions(origin=Origin(48.7, 11.4, 450.0))


class Building:
    """A model in the making: boxes of any class, lengths in metres whatever the file's unit is."""

    def __init__(self, schema: str = "IFC4", unit_m: float = 1.0, true_north: tuple[float, float] = (0.0, 1.0)) -> None:
        self.file = ifcopenshell.file(schema=schema)
        self.unit_m = unit_m
        make = self.make
        if unit_m in (1.0, 0.001):
            prefix = "MILLI" if unit_m == 0.001 else None
            self.length = make("IfcSIUnit", UnitType="LENGTHUNIT", Prefix=prefix, Name="METRE")
        else:
            metre = make("IfcSIUnit", UnitType="LENGTHUNIT", Name="METRE")
            ratio = make("IfcMeasureWithUnit", self.file.create_entity("IfcLengthMeasure", unit_m), metre)
            size = make("IfcDimensionalExponents", 1, 0, 0, 0, 0, 0, 0)
            self.length = make("IfcConversionBasedUnit", size, "LENGTHUNIT", "FOOT", ratio)
        self.context = make(
            "IfcGeometricRepresentationContext",
            ContextType="Model",
            CoordinateSpaceDimension=3,
            Precision=1e-5,
            WorldCoordinateSystem=self.axes(),
            TrueNorth=make("IfcDirection", true_north),
        )
        self.project = self.rooted(
            "IfcProject",
            RepresentationContexts=[self.context],
            UnitsInContext=make("IfcUnitAssignment", [self.length]),
        )
        self.site = self.rooted("IfcSite", ObjectPlacement=make("IfcLocalPlacement", None, self.axes()))
        self.building = self.rooted("IfcBuilding", Name="Haus")
        self.aggregate(self.project, self.site)
        self.aggregate(self.site, self.building)

    def make(self, kind: str, *values: Any, **fields: Any) -> Any:
        return self.file.create_entity(kind, *values, **{k: v for k, v in fields.items() if v is not None})

    def measure(self, value: float | str) -> Any:
        return self.file.create_entity("IfcLabel" if isinstance(value, str) else "IfcReal", value)

    def rooted(self, kind: str, **fields: Any) -> Any:
        return self.make(kind, GlobalId=ifcopenshell.guid.new(), **fields)

    def point(self, at_m: Point) -> Any:
        return self.make("IfcCartesianPoint", tuple(v / self.unit_m for v in at_m))

    def axes(self, at_m: Point = (0.0, 0.0, 0.0), heading_rad: float = 0.0) -> Any:
        return self.make(
            "IfcAxis2Placement3D",
            self.point(at_m),
            self.make("IfcDirection", (0.0, 0.0, 1.0)),
            self.make("IfcDirection", (math.cos(heading_rad), math.sin(heading_rad), 0.0)),
        )

    def aggregate(self, whole: Any, *parts: Any) -> None:
        self.rooted("IfcRelAggregates", RelatingObject=whole, RelatedObjects=list(parts))

    def locate(self, lat: tuple[int, ...], lon: tuple[int, ...], elevation_m: float = 0.0) -> Building:
        self.site.RefLatitude, self.site.RefLongitude = lat, lon
        self.site.RefElevation = elevation_m / self.unit_m
        return self

    def solid(self, size_m: Point, at_m: Point = (0.0, 0.0, 0.0)) -> Any:
        """Box from its lower corner."""
        width, depth, height = (v / self.unit_m for v in size_m)
        corner = self.make("IfcCartesianPoint", (width / 2.0, depth / 2.0))
        profile = self.make(
            "IfcRectangleProfileDef",
            ProfileType="AREA",
            Position=self.make("IfcAxis2Placement2D", corner),
            XDim=width,
            YDim=depth,
        )
        up = self.make("IfcDirection", (0.0, 0.0, 1.0))
        return self.make("IfcExtrudedAreaSolid", profile, self.axes(at_m), up, height)

    def prism(self, outline_m: list[tuple[float, float]], depth_m: float) -> Any:
        """Prism across y from an outline in the x-z plane."""
        points = [self.make("IfcCartesianPoint", (x / self.unit_m, z / self.unit_m)) for x, z in outline_m]
        profile = self.make(
            "IfcArbitraryClosedProfileDef", "AREA", None, self.make("IfcPolyline", [*points, points[0]])
        )
        placement = self.make(
            "IfcAxis2Placement3D",
            self.point((0.0, depth_m, 0.0)),
            self.make("IfcDirection", (0.0, -1.0, 0.0)),
            self.make("IfcDirection", (1.0, 0.0, 0.0)),
        )
        up = self.make("IfcDirection", (0.0, 0.0, 1.0))
        return self.make("IfcExtrudedAreaSolid", profile, placement, up, depth_m / self.unit_m)

    def shaded(self, solid: Any, transparency: float | None) -> Any:
        if transparency is not None:
            colour = self.make("IfcColourRgb", None, 0.5, 0.5, 0.5)
            fields = {"SurfaceColour": colour, "Transparency": transparency, "ReflectanceMethod": "NOTDEFINED"}
            shading = self.make("IfcSurfaceStyleRendering", **fields)
            style: Any = self.make("IfcSurfaceStyle", None, "BOTH", [shading])
            if self.file.schema == "IFC2X3":
                style = self.make("IfcPresentationStyleAssignment", [style])
            self.make("IfcStyledItem", solid, [style], None)
        return solid

    def element(self, kind: str, solids: list[Any], at_m: Point = (0.0, 0.0, 0.0), **fields: Any) -> Any:
        heading_rad = fields.pop("heading_rad", 0.0)
        body = self.make("IfcShapeRepresentation", self.context, "Body", "SweptSolid", solids)
        return self.rooted(
            kind,
            ObjectPlacement=self.make("IfcLocalPlacement", self.site.ObjectPlacement, self.axes(at_m, heading_rad)),
            Representation=self.make("IfcProductDefinitionShape", None, None, [body]),
            **fields,
        )

    def box(self, kind: str, size_m: Point, at_m: Point, transparency: float | None = None, **fields: Any) -> Any:
        return self.element(kind, [self.shaded(self.solid(size_m), transparency)], at_m, **fields)

    def wall(self, size_m: Point, at_m: Point, *openings: tuple[Point, Point], **fields: Any) -> Any:
        """Wall with openings, each by size and place in the model."""
        wall = self.box("IfcWall", size_m, at_m, **fields)
        for size, place in openings:
            hole = self.box("IfcOpeningElement", size, place)
            self.rooted("IfcRelVoidsElement", RelatingBuildingElement=wall, RelatedOpeningElement=hole)
        return wall

    def room(self, openings: dict[str, list[tuple[Point, Point]]] | None = None, roof: bool = True) -> Building:
        """Room of 10 x 6 x 3 m with walls 0.3 m thick, standing on z = 0; openings by wall (south, north ...)."""
        holes = openings or {}
        self.wall((10.0, 0.3, 3.0), (0.0, 0.0, 0.0), *holes.get("south", []))
        self.wall((10.0, 0.3, 3.0), (0.0, 5.7, 0.0), *holes.get("north", []))
        self.wall((0.3, 5.4, 3.0), (0.0, 0.3, 0.0), *holes.get("west", []))
        self.wall((0.3, 5.4, 3.0), (9.7, 0.3, 0.0), *holes.get("east", []))
        self.box("IfcSlab", (10.0, 6.0, 0.2), (0.0, 0.0, -0.2))
        if roof:
            self.box("IfcSlab", (10.0, 6.0, 0.2), (0.0, 0.0, 3.0))
        return self

    def window(self, width_m: float, height_m: float, at_m: Point, depth_m: float = 0.06, **fields: Any) -> Any:
        """Window across y: a frame 5 cm wide, and a pane 2 cm thick in its middle."""
        glass = self.solid((width_m - 0.1, 0.02, height_m - 0.1), (0.05, depth_m / 2.0 - 0.01, 0.05))
        bars = [
            self.solid((width_m, depth_m, 0.05)),
            self.solid((width_m, depth_m, 0.05), (0.0, 0.0, height_m - 0.05)),
            self.solid((0.05, depth_m, height_m), (0.0, 0.0, 0.0)),
            self.solid((0.05, depth_m, height_m), (width_m - 0.05, 0.0, 0.0)),
        ]
        solids = [self.shaded(glass, 0.8), *(self.shaded(bar, 0.0) for bar in bars)]
        return self.element("IfcWindow", solids, at_m, **fields)

    def save(self, folder: Path, name: str = "model.ifc") -> Path:
        path = folder / name
        self.file.write(str(path))
        return path


def south_window(building: Building) -> Building:
    """Room with one window of 2 x 1.5 m in the middle of its south wall."""
    building.room({"south": [((2.0, 0.4, 1.5), (4.0, -0.05, 1.0))]})
    building.window(2.0, 1.5, (4.0, 0.12, 1.0))
    return building


def contents(building: Building, folder: Path) -> tuple[IfcContent, np.ndarray]:
    return extract(building.save(folder), 0.005, 1, lambda _done: None)


def imported(building: Building, folder: Path, options: ImportOptions = HERE) -> ImportedSite:
    """Imported as `import_site` does, but read in this process, which saves starting a worker."""
    path = building.save(folder)
    source = ifc_source(path, *extract(path, options.deflection_m, 1, lambda _done: None), options)
    return assemble(path, source, options)


def corners_of(site: ImportedSite) -> np.ndarray:
    return panel_corners(site.model.site)


@pytest.mark.parametrize("schema", ["IFC2X3", "IFC4"])
@pytest.mark.parametrize("unit_m", [1.0, 0.001, 0.3048])
def test_units_and_schemas_give_the_same_pane(tmp_path: Path, schema: str, unit_m: float) -> None:
    content, triangles = contents(south_window(Building(schema, unit_m)), tmp_path)
    assert content.schema == schema
    assert content.unit_m == pytest.approx(unit_m)
    outline = np.array(content.outlines[0])
    np.testing.assert_allclose(outline.min(axis=0), [4.05, 0.15, 1.05], atol=1e-6)
    np.testing.assert_allclose(outline.max(axis=0), [5.95, 0.15, 2.45], atol=1e-6)
    assert content.thicknesses_m[0] == pytest.approx(0.02)
    np.testing.assert_allclose(triangles.min(axis=(0, 1)), [0.0, 0.0, -0.2], atol=1e-6)
    np.testing.assert_allclose(triangles.max(axis=(0, 1)), [10.0, 6.0, 3.2], atol=1e-6)


def test_the_panel_lies_on_the_outer_face_of_the_glass_and_looks_out(tmp_path: Path) -> None:
    site = imported(south_window(Building()), tmp_path)
    corners = corners_of(site)
    np.testing.assert_allclose(
        corners, [[[4.05, 0.14, 1.05], [5.95, 0.14, 1.05], [5.95, 0.14, 2.45], [4.05, 0.14, 2.45]]], atol=1e-3
    )
    np.testing.assert_allclose(unit_normals(corners), [[0.0, -1.0, 0.0]], atol=1e-6)


def test_windows_on_all_sides_face_their_own_way(tmp_path: Path) -> None:
    building = Building()
    holes = {
        "south": [((2.0, 0.4, 1.5), (4.0, -0.05, 1.0))],
        "north": [((2.0, 0.4, 1.5), (4.0, 5.65, 1.0))],
        "west": [((0.4, 2.0, 1.5), (-0.05, 2.0, 1.0))],
        "east": [((0.4, 2.0, 1.5), (9.65, 2.0, 1.0))],
    }
    building.room(holes)
    building.window(2.0, 1.5, (4.0, 0.12, 1.0), Tag="0,-1")
    building.window(2.0, 1.5, (4.0, 5.82, 1.0), Tag="0,1")
    building.window(2.0, 1.5, (0.18, 2.0, 1.0), Tag="-1,0", heading_rad=math.pi / 2.0)
    building.window(2.0, 1.5, (9.88, 2.0, 1.0), Tag="1,0", heading_rad=math.pi / 2.0)
    site = imported(building, tmp_path)
    tags = {window.GlobalId: window.Tag for window in building.file.by_type("IfcWindow")}
    assert len(site.model.site.facades) == 4
    for panel, normal in zip(site.model.site.panels, unit_normals(corners_of(site)), strict=True):
        assert panel.source_id is not None
        np.testing.assert_allclose(normal[:2], [float(v) for v in tags[panel.source_id].split(",")], atol=1e-6)


def test_a_window_between_two_rooms_is_left_out_and_counted(tmp_path: Path) -> None:
    building = south_window(Building())
    building.wall((0.2, 5.4, 3.0), (5.0, 0.3, 0.0), ((0.3, 1.0, 1.0), (4.95, 2.0, 1.0)))
    inner = building.window(1.0, 1.0, (5.07, 2.0, 1.0), heading_rad=math.pi / 2.0)
    site = imported(building, tmp_path)
    assert [panel.source_id for panel in site.model.site.panels].count(inner.GlobalId) == 0
    assert site.model.site.n_panels == 1
    assert any("windows left out as indoor ones, which see nothing of the open: 1" in note for note in site.notes)


def test_a_window_between_rooms_without_a_roof_is_left_out_too(tmp_path: Path) -> None:
    building = Building().room(
        {"south": [((2.0, 0.4, 1.5), (1.0 + 3.0 * i, -0.05, 1.0)) for i in range(3)]}, roof=False
    )
    for i in range(3):
        building.window(2.0, 1.5, (1.0 + 3.0 * i, 0.12, 1.0))
    building.wall((9.4, 0.2, 3.0), (0.3, 3.0, 0.0), ((1.0, 0.3, 1.0), (4.0, 2.95, 1.0)))
    inner = building.window(1.0, 1.0, (4.0, 3.07, 1.0))
    site = imported(building, tmp_path)
    assert inner.GlobalId not in [panel.source_id for panel in site.model.site.panels]
    assert site.model.site.n_panels == 3


def test_a_wall_that_stands_alone_keeps_its_windows(tmp_path: Path) -> None:
    building = Building()
    building.wall((10.0, 0.3, 3.0), (0.0, 0.0, 0.0), ((2.0, 0.4, 1.5), (4.0, -0.05, 1.0)))
    building.window(2.0, 1.5, (4.0, 0.12, 1.0))
    site = imported(building, tmp_path)
    assert site.model.site.n_panels == 1
    assert any("windows open on both sides, taken to face away from the building: 1" in note for note in site.notes)


def test_a_window_without_glass_faces_lies_across_the_thin_side_of_its_box(tmp_path: Path) -> None:
    # A lining as deep as the wall: most of its area faces sideways.
    building = Building().room({"south": [((0.8, 0.4, 1.2), (4.0, -0.05, 1.0))]})
    bars = [
        building.solid((0.8, 0.3, 0.04)),
        building.solid((0.8, 0.3, 0.04), (0.0, 0.0, 1.16)),
        building.solid((0.04, 0.3, 1.2)),
        building.solid((0.04, 0.3, 1.2), (0.76, 0.0, 0.0)),
    ]
    building.element("IfcWindow", bars, (4.0, 0.0, 1.0))
    corners = corners_of(imported(building, tmp_path))
    np.testing.assert_allclose(unit_normals(corners), [[0.0, -1.0, 0.0]], atol=1e-6)
    assert quad_areas(corners)[0] == pytest.approx(0.8 * 1.2, abs=1e-3)
    assert corners[0, 0, 1] == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize(
    ("outline", "is_exact"),
    [
        ([(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.8)], True),  # a trapezoid under a roof
        ([(0.0, 0.0), (2.0, 0.0), (1.0, 1.5)], False),  # a gable
        ([(math.cos(t) + 1.0, math.sin(t) + 1.0) for t in np.linspace(0.0, 2.0 * math.pi, 25)[:-1]], False),
    ],
)
def test_windows_of_other_shapes_keep_area_and_centre(
    tmp_path: Path, outline: list[tuple[float, float]], is_exact: bool
) -> None:
    building = Building().room({"south": [((2.4, 0.4, 2.4), (3.8, -0.05, 0.4))]})
    pane = building.shaded(building.prism(outline, 0.02), 0.8)
    building.element("IfcWindow", [pane], (4.0, 0.1, 0.5))
    site = imported(building, tmp_path)
    x, z = np.array(outline).T
    area = 0.5 * abs(x @ np.roll(z, -1) - z @ np.roll(x, -1))
    assert quad_areas(corners_of(site))[0] == pytest.approx(area, rel=1e-3)
    assert any("stands in" in note for note in site.notes) is not is_exact


def curtain_wall(building: Building, transparency: float | None = 0.7, name: str = "Panel") -> list[Any]:
    """South wall of 4 x 2 glazed plates with posts between, in front of an open room; returns the plates."""
    building.room({"south": [((9.0, 0.4, 3.0), (0.5, -0.05, 0.0))]})
    wall = building.rooted("IfcCurtainWall")
    plates = [
        building.box("IfcPlate", (2.2, 0.02, 1.45), (0.52 + 2.25 * i, 0.1, 1.5 * j), transparency, Name=name)
        for i in range(4)
        for j in range(2)
    ]
    posts = [building.box("IfcMember", (0.05, 0.15, 3.0), (0.48 + 2.25 * i, 0.0, 0.0), 0.0) for i in range(5)]
    building.aggregate(wall, *plates, *posts)
    return plates


def test_plates_of_a_curtain_wall_are_panels_and_its_posts_are_mesh(tmp_path: Path) -> None:
    building = Building()
    plates = curtain_wall(building)
    site = imported(building, tmp_path)
    assert {panel.source_id for panel in site.model.site.panels} == {plate.GlobalId for plate in plates}
    assert [len(facade.panels) for facade in site.model.site.facades] == [8]
    assert site.model.building.vertices_enu_m[:, 1].min() == pytest.approx(0.0, abs=1e-6)  # the posts' outer face


@pytest.mark.parametrize(("transparency", "name"), [(None, "Panel"), (0.0, "Panel"), (0.0, "Verglasung")])
def test_plates_of_a_curtain_wall_are_glass_unless_the_file_tells_glass_from_others(
    tmp_path: Path, transparency: float | None, name: str
) -> None:
    building = Building()
    curtain_wall(building, transparency, name)
    content, _ = contents(building, tmp_path)
    assert len(content.pane_ids) == 8


def test_opaque_plates_beside_glazed_ones_are_no_panels(tmp_path: Path) -> None:
    building = Building()
    plates = curtain_wall(building)
    spandrel = building.box("IfcPlate", (2.2, 0.02, 0.5), (0.5, 0.1, 3.0), 0.0, Name="Panel")
    named = building.box("IfcPlate", (2.2, 0.02, 0.5), (2.8, 0.1, 3.0), None, Name="Spandrel glass")
    building.aggregate(building.rooted("IfcCurtainWall"), spandrel, named)
    content, _ = contents(building, tmp_path)
    assert set(content.pane_ids) == {plate.GlobalId for plate in plates}
    assert any("plates: 10, of which glazed: 8" in note for note in content.notes)


def test_steel_plates_are_no_panels_and_glass_plates_outside_walls_are(tmp_path: Path) -> None:
    building = south_window(Building())
    building.box("IfcPlate", (0.3, 0.02, 0.3), (1.0, -0.1, 1.0), 0.0, Name="PL20 S235")
    glass = building.box("IfcPlate", (1.0, 0.02, 1.0), (7.0, -0.1, 1.0), 0.6, Name="PL20")
    content, _ = contents(building, tmp_path)
    assert len(content.pane_ids) == 2
    assert glass.GlobalId in content.pane_ids


def test_a_window_within_a_curtain_wall_panel_is_one_panel(tmp_path: Path) -> None:
    building = Building()
    plates = curtain_wall(building)
    window = building.window(2.1, 1.4, (0.55, 0.05, 0.02))
    building.aggregate(plates[0].Decomposes[0].RelatingObject, window)
    site = imported(building, tmp_path)
    assert site.model.site.n_panels == 8
    assert any("windows left out because another one shows the same pane: 1" in note for note in site.notes)


@pytest.mark.few(1)
@pytest.mark.parametrize("cavity_m", [0.03, 0.3, 1.0])
def test_two_skins_of_glass_are_one_facade_the_outer_one(tmp_path: Path, cavity_m: float) -> None:
    building = Building()
    inner = curtain_wall(building)
    wall = building.rooted("IfcCurtainWall")
    outer = [
        building.box("IfcPlate", (2.25, 0.02, 1.5), (0.5 + 2.25 * i, 0.1 - cavity_m, 1.5 * j), 0.7)
        for i in range(4)
        for j in range(2)
    ]
    building.aggregate(wall, *outer)
    # The cavity is closed all around, as a real one is.
    depth = cavity_m + 0.02
    for size, at in [
        ((9.2, depth, 0.05), (0.4, 0.1 - cavity_m, 3.0)),
        ((9.2, depth, 0.05), (0.4, 0.1 - cavity_m, -0.05)),
        ((0.05, depth, 3.0), (0.45, 0.1 - cavity_m, 0.0)),
        ((0.05, depth, 3.0), (9.5, 0.1 - cavity_m, 0.0)),
    ]:
        building.box("IfcMember", size, at, 0.0)
    site = imported(building, tmp_path)
    assert {panel.source_id for panel in site.model.site.panels} == {plate.GlobalId for plate in outer}
    assert not {panel.source_id for panel in site.model.site.panels} & {plate.GlobalId for plate in inner}


def test_a_curtain_wall_that_is_one_body_gives_a_panel_for_each_pane(tmp_path: Path) -> None:
    building = Building().room({"south": [((9.0, 0.4, 3.0), (0.5, -0.05, 0.0))]})
    panes = [building.shaded(building.solid((2.0, 0.02, 2.8), (2.2 * i, 0.0, 0.1)), 0.7) for i in range(4)]
    posts = [building.shaded(building.solid((0.1, 0.1, 3.0), (2.2 * i - 0.15, 0.0, 0.0)), 0.0) for i in range(5)]
    wall = building.element("IfcCurtainWall", [*panes, *posts], (0.7, 0.1, 0.0))
    site = imported(building, tmp_path)
    assert [panel.source_id for panel in site.model.site.panels] == [f"{wall.GlobalId}#{k}" for k in range(4)]


def test_a_window_made_of_parts_is_one_panel(tmp_path: Path) -> None:
    building = Building().room({"south": [((2.0, 0.4, 1.5), (4.0, -0.05, 1.0))]})
    window = building.rooted("IfcWindow")
    glass = building.box("IfcPlate", (1.9, 0.02, 1.4), (4.05, 0.14, 1.05), 0.8)
    frame = building.box("IfcMember", (2.0, 0.06, 0.05), (4.0, 0.12, 1.0), 0.0)
    building.aggregate(window, glass, frame)
    site = imported(building, tmp_path)
    assert [panel.source_id for panel in site.model.site.panels] == [window.GlobalId]
    assert quad_areas(corners_of(site))[0] == pytest.approx(1.9 * 1.4, rel=1e-3)


def test_windows_without_geometry_are_counted(tmp_path: Path) -> None:
    building = south_window(Building())
    building.rooted("IfcWindow")
    content, _ = contents(building, tmp_path)
    assert any("windows left out because they have no geometry: 1" in note for note in content.notes)


def test_spaces_openings_furniture_and_terrain_are_no_mesh(tmp_path: Path) -> None:
    plain, _ = contents(south_window(Building()), tmp_path)
    building = south_window(Building())
    building.box("IfcSpace", (9.0, 5.0, 2.8), (0.5, 0.5, 0.0))
    building.box("IfcFurnishingElement", (1.0, 1.0, 1.0), (2.0, 2.0, 0.0))
    building.box("IfcGeographicElement", (100.0, 100.0, 1.0), (-50.0, -50.0, -1.0))
    building.site.Representation = building.box("IfcBuildingElementProxy", (1, 1, 1), (0, 0, 0)).Representation
    building.file.remove(building.file.by_type("IfcBuildingElementProxy")[0])
    content, triangles = contents(building, tmp_path)
    np.testing.assert_allclose(triangles.min(axis=(0, 1)), [0.0, 0.0, -0.2], atol=1e-6)
    np.testing.assert_allclose(triangles.max(axis=(0, 1)), [10.0, 6.0, 3.2], atol=1e-6)
    assert content.pane_ids != plain.pane_ids  # other GlobalIds, the same panes
    np.testing.assert_allclose(content.outlines, plain.outlines, atol=1e-9)


def test_curved_walls_come_finer_with_a_smaller_deflection(tmp_path: Path) -> None:
    building = south_window(Building())
    circle = building.make("IfcCircleProfileDef", ProfileType="AREA", Radius=2.0)
    up = building.make("IfcDirection", (0.0, 0.0, 1.0))
    column = building.make("IfcExtrudedAreaSolid", circle, building.axes(), up, 3.0)
    building.element("IfcColumn", [column], (20.0, 0.0, 0.0))
    path = building.save(tmp_path)
    volumes = []
    for deflection_m in (0.1, 0.01, 0.001):
        _, triangles = extract(path, deflection_m, 1, lambda _done: None)
        far = triangles[triangles[:, :, 0].min(axis=1) > 15.0] - np.array([20.0, 0.0, 0.0])
        volumes.append(float(np.einsum("ij,ij->i", far[:, 0], np.cross(far[:, 1], far[:, 2])).sum() / 6.0))
    errors = math.pi * 4.0 * 3.0 - np.array(volumes)
    assert (np.diff(errors) < 0.0).all()
    assert 0.0 < errors[2] < 2.0 * math.pi * 2.0 * 3.0 * 0.001


# --- where it is ---


def test_latitude_and_longitude_carry_their_signs_in_every_part(tmp_path: Path) -> None:
    building = south_window(Building()).locate((-33, -51, -24, -500000), (-151, -12, -36), 12.0)
    content, _ = contents(building, tmp_path)
    assert content.site is not None
    assert content.site.lat_deg == pytest.approx(-(33 + 51 / 60 + 24.5 / 3600), abs=1e-12)
    assert content.site.lon_deg == pytest.approx(-(151 + 12 / 60 + 36 / 3600), abs=1e-12)
    assert content.site.altitude_amsl_m == pytest.approx(12.0)


@pytest.mark.parametrize("unit_m", [1.0, 0.001])
def test_elevation_of_the_site_is_above_sea_level_and_in_the_files_unit(tmp_path: Path, unit_m: float) -> None:
    building = south_window(Building(unit_m=unit_m)).locate((48, 42, 0), (11, 24, 0), 415.0)
    site = imported(building, tmp_path, ImportOptions())
    origin = site.model.site.origin
    assert origin.ellipsoid_height_m == pytest.approx(415.0 + float(undulation_m(48.7, 11.4)), abs=0.01)
    assert any("above sea level" in note for note in site.notes)


def test_the_origin_is_below_the_middle_of_the_building_and_the_site_point_keeps_its_place(tmp_path: Path) -> None:
    building = south_window(Building()).locate((48, 42, 0), (11, 24, 0))
    site = imported(building, tmp_path, ImportOptions())
    height = float(undulation_m(48.7, 11.4))
    reference = enu_from_geodetic(site.model.site.origin, 48.7, 11.4, height)[0]
    np.testing.assert_allclose(reference, [-5.0, -3.0, 0.0], atol=1e-3)
    np.testing.assert_allclose(corners_of(site)[0, 0], [-0.95, 0.14 - 3.0, 1.05], atol=2e-3)


@pytest.mark.parametrize("degrees", [30.0, -75.0, 180.0])
def test_true_north_turns_the_building(tmp_path: Path, degrees: float) -> None:
    # North lies `degrees` counter-clockwise of the y axis, so the south window looks `degrees` clockwise of south.
    turn = math.radians(degrees)
    building = south_window(Building(true_north=(-math.sin(turn), math.cos(turn)))).locate((48, 42, 0), (11, 24, 0))
    normal = unit_normals(corners_of(imported(building, tmp_path, ImportOptions())))[0]
    heading_deg = math.degrees(math.atan2(normal[0], normal[1])) % 360.0
    assert heading_deg == pytest.approx((180.0 + degrees) % 360.0, abs=0.01)


def test_a_cellar_does_not_lower_the_ground(tmp_path: Path) -> None:
    building = south_window(Building()).locate((48, 42, 0), (11, 24, 0))
    building.box("IfcWall", (10.0, 0.3, 4.0), (0.0, 0.0, -4.0))
    site = imported(building, tmp_path, ImportOptions()).model.site
    assert site.airspace.ground_z_m == 0.0
    assert site.home_enu_m[2] == 0.0
    assert site.origin.ellipsoid_height_m == pytest.approx(float(undulation_m(48.7, 11.4)), abs=1e-3)


def test_no_place_at_all_asks_for_one(tmp_path: Path) -> None:
    for building in (Building(), Building().locate((0, 0, 0), (0, 0, 0))):
        with pytest.raises(InputError, match="--origin LAT,LON,HEIGHT"):
            imported(south_window(building), tmp_path, ImportOptions())


def test_a_place_that_is_nowhere_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="nowhere on earth"):
        imported(south_window(Building()).locate((148, 42, 0), (11, 24, 0)), tmp_path, ImportOptions())


UTM32 = (678_052.0, 5_403_685.0, 415.0)


def with_map(
    building: Building, scale: float | None = None, name: str | None = "EPSG:25832", **fields: Any
) -> Building:
    """Model with IfcMapConversion (IFC 4) or its property sets (IFC 2x3), its zero at UTM32."""
    unit = fields.pop("map_unit", None)
    vertical = fields.pop("vertical", None)
    east, north, height = fields.pop("at", UTM32)
    turn = fields.pop("turn_rad", 0.0)
    values = {"Eastings": east, "Northings": north, "OrthogonalHeight": height}
    values |= {"XAxisAbscissa": math.cos(turn), "XAxisOrdinate": math.sin(turn)}
    if scale is not None:
        values["Scale"] = scale
    if building.file.schema == "IFC2X3":
        for target, title, entries in (
            (building.site, "ePset_MapConversion", values),
            (building.project, "ePSet_ProjectedCRS", {"Name": name, "MapUnit": unit or "METRE"}),
        ):
            properties = [
                building.make("IfcPropertySingleValue", Name=key, NominalValue=building.measure(value))
                for key, value in entries.items()
            ]
            sets = building.rooted("IfcPropertySet", Name=title, HasProperties=properties)
            building.rooted("IfcRelDefinesByProperties", RelatedObjects=[target], RelatingPropertyDefinition=sets)
    else:
        metre = building.make("IfcSIUnit", UnitType="LENGTHUNIT", Name="METRE") if unit == "METRE" else None
        crs = building.make("IfcProjectedCRS", Name=name, VerticalDatum=vertical, MapUnit=metre)
        building.make("IfcMapConversion", SourceCRS=building.context, TargetCRS=crs, **values)
    return building


@pytest.mark.parametrize("schema", ["IFC2X3", "IFC4"])
def test_a_map_conversion_puts_every_vertex_on_the_map(tmp_path: Path, schema: str) -> None:
    turn = math.radians(25.0)
    building = with_map(south_window(Building(schema)), scale=0.9998, turn_rad=turn)
    building.locate((40, 0, 0), (-3, 0, 0))  # the map conversion goes before the site's own place
    site = imported(building, tmp_path, ImportOptions())
    conversion = crs_conversion("EPSG:25832", np.array([UTM32]))
    panel = np.array([[4.05, 0.14, 1.05], [5.95, 0.14, 1.05], [5.95, 0.14, 2.45], [4.05, 0.14, 2.45]])
    x, y = 0.9998 * panel[:, 0], 0.9998 * panel[:, 1]
    on_map = np.stack(
        [
            UTM32[0] + math.cos(turn) * x - math.sin(turn) * y,
            UTM32[1] + math.sin(turn) * x + math.cos(turn) * y,
            UTM32[2] + 0.9998 * panel[:, 2],
        ],
        axis=-1,
    )
    expected = enu_from_geodetic(site.model.site.origin, *conversion.geodetic(on_map))
    np.testing.assert_allclose(corners_of(site)[0], expected, atol=1e-3)
    assert site.notes[0] == "place and rotation from IfcMapConversion"


@pytest.mark.few(3)
@pytest.mark.parametrize(
    ("unit_m", "scale", "map_unit", "at"),
    [
        (0.001, 0.001, "METRE", UTM32),  # as the standard has it
        (0.001, None, "METRE", UTM32),  # the change of units forgotten
        (0.001, 1.0, None, UTM32),  # the map's unit forgotten as well
        (0.001, 0.001, None, UTM32),
        (0.001, 1.0, None, tuple(1000.0 * v for v in UTM32)),  # the map in the drawing's millimetres
        (0.3048, 0.3048, "METRE", UTM32),
        (1.0, None, None, UTM32),
    ],
)
def test_units_of_map_and_drawing_are_sorted_out(
    tmp_path: Path, unit_m: float, scale: float | None, map_unit: str | None, at: Point
) -> None:
    building = with_map(south_window(Building(unit_m=unit_m)), scale, map_unit=map_unit, at=at)
    site = imported(building, tmp_path, ImportOptions())
    zero = crs_conversion("EPSG:25832", np.array([UTM32])).geodetic(np.array([UTM32]))
    reference = enu_from_geodetic(site.model.site.origin, *zero)[0]
    assert np.hypot(*reference[:2]) == pytest.approx(math.hypot(5.0, 3.0), abs=0.01)
    assert reference[2] == pytest.approx(0.0, abs=0.01)
    widths = np.linalg.norm(corners_of(site)[0, 1] - corners_of(site)[0, 0])
    assert widths == pytest.approx(1.9, abs=2e-3)


def test_heights_on_the_map_are_orthometric_unless_the_file_says_ellipsoidal(tmp_path: Path) -> None:
    heights = {}
    for vertical in (None, "DHHN2016", "EPSG:7837", "Ellipsoid GRS80"):
        building = with_map(south_window(Building()), vertical=vertical)
        site = imported(building, tmp_path, ImportOptions())
        heights[vertical] = site.model.site.origin.ellipsoid_height_m
    assert heights["Ellipsoid GRS80"] == pytest.approx(415.0, abs=0.01)
    for vertical in (None, "DHHN2016", "EPSG:7837"):
        assert heights[vertical] == pytest.approx(415.0 + 46.47, abs=0.05)


def test_a_senseless_map_conversion_gives_way_to_the_sites_place(tmp_path: Path) -> None:
    building = with_map(south_window(Building()), at=(0.0, 0.0, 0.0)).locate((48, 42, 0), (11, 24, 0))
    site = imported(building, tmp_path, ImportOptions())
    assert site.model.site.origin.lat_deg == pytest.approx(48.7, abs=1e-3)
    assert "left aside" in site.notes[0]


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"name": "Gauss-Whatever"}, "not a coordinate reference system"),
        ({"at": (0.0, 0.0, 0.0)}, "far outside the area of use"),
        ({"scale": 25.4}, "neither near 1 nor the change of units"),
    ],
)
def test_a_senseless_map_conversion_alone_is_refused(tmp_path: Path, fields: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        imported(with_map(south_window(Building()), **fields), tmp_path, ImportOptions())


def test_the_user_names_the_map_that_the_file_does_not(tmp_path: Path) -> None:
    building = with_map(south_window(Building()), name="UTM nach Plan")
    content, _ = contents(building, tmp_path)
    frame = ifc_georeference(content, ImportOptions(crs="EPSG:25832"))
    assert frame is not None
    place = frame.geodetic(np.zeros((1, 3)))
    assert place.lat_deg[0] == pytest.approx(48.76069, abs=1e-4)
    assert ifc_georeference(content, HERE) is None


def test_models_drawn_in_map_coordinates_are_refused_until_the_map_is_named(tmp_path: Path) -> None:
    building = Building()
    building.site.ObjectPlacement.RelativePlacement = building.axes(UTM32)
    building.locate((48, 45, 38), (11, 25, 22))
    south_window(building)
    assert imported(building, tmp_path, ImportOptions()).model.site.n_panels == 1  # the site's own place goes with it
    for placement in building.file.by_type("IfcLocalPlacement"):
        if placement.PlacementRelTo == building.site.ObjectPlacement:
            placement.PlacementRelTo = building.make("IfcLocalPlacement", None, building.axes(UTM32))
    building.site.ObjectPlacement = building.make("IfcLocalPlacement", None, building.axes())
    with pytest.raises(InputError, match=r"5446 km from the point whose place the file gives.*--crs"):
        imported(building, tmp_path, ImportOptions())
    site = imported(building, tmp_path, ImportOptions(crs="EPSG:25832")).model.site
    zero = crs_conversion("EPSG:25832", np.array([UTM32])).geodetic(np.array([UTM32]))
    reference = enu_from_geodetic(site.origin, *zero)[0]
    assert np.hypot(*reference[:2]) == pytest.approx(math.hypot(5.0, 3.0), abs=0.01)
    assert quad_areas(np.array([site.panels[0].corners_enu_m]))[0] == pytest.approx(1.9 * 1.4, rel=1e-3)


# --- what is wrong with it ---


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "expected an IFC file"),
        (b"hello", "expected an IFC file"),
        (bytes(range(256)) * 10, "expected an IFC file"),
        (b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n", "cut off"),
        (b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n", "cannot be read"),
    ],
)
def test_files_that_are_not_ifc_or_cut_off_are_refused(tmp_path: Path, content: bytes, said: str) -> None:
    path = tmp_path / "bad.ifc"
    path.write_bytes(content)
    with pytest.raises(InputError, match=said):
        read_ifc(path, HERE, QUIET)


@pytest.mark.slow
def test_a_file_that_kills_the_geometry_kernel_is_refused_and_we_live_on(tmp_path: Path) -> None:
    path = south_window(Building()).save(tmp_path)
    text = path.read_text()
    site_placement = next(line for line in text.splitlines() if "IFCLOCALPLACEMENT($" in line)
    number = site_placement.split("=")[0]
    path.write_text(text.replace(site_placement, site_placement.replace("($,", f"({number},")))  # goes in circles
    with pytest.raises(InputError, match="the geometry kernel crashed"):
        read_ifc(path, HERE, QUIET)


@pytest.mark.slow
def test_an_element_that_kills_the_geometry_kernel_is_left_out_and_told(tmp_path: Path) -> None:
    building = south_window(Building())
    path = building.save(tmp_path)
    whole = read_ifc(path, HERE, QUIET)
    wall = building.file.by_type("IfcWall")[0]
    number = f"#{wall.ObjectPlacement.id()}"
    line = next(line for line in path.read_text().splitlines() if line.startswith(f"{number}="))
    circle = re.sub(r"IFCLOCALPLACEMENT\([^,]*,", f"IFCLOCALPLACEMENT({number},", line)
    path.write_text(path.read_text().replace(line, circle))
    source = read_ifc(path, HERE, QUIET)
    assert len(source.windows) == len(whole.windows) == 1
    assert 0 < len(source.building.triangles) < len(whole.building.triangles)
    assert any(note.endswith(f"not read: 1 ({wall.GlobalId})") for note in source.notes)


DAMAGES = {
    "garbage": lambda line: line.split("=")[0] + "= @@@ nonsense;",
    "no bracket": lambda line: line.replace("(", "", 1),
    "text without end": lambda line: line.replace(");", "'x);"),
    "too large a number": lambda line: re.sub(r"-?\d+\.\d*", "1.E400", line, count=1),
}


@pytest.mark.slow
@pytest.mark.parametrize("damage", DAMAGES)
def test_a_broken_line_is_left_out_and_told_and_takes_no_other_with_it(tmp_path: Path, damage: str) -> None:
    path = south_window(Building()).save(tmp_path)
    lines = path.read_text().splitlines()
    place = [k for k, line in enumerate(lines) if re.match(r"#\d+=IFCCARTESIANPOINT\(\(-?\d+\.", line)][-1]
    number = lines[place].split("=")[0]
    lines[place] = DAMAGES[damage](lines[place])
    path.write_text("\n".join(lines))
    found = repaired_file(path)
    assert found is not None
    assert found.broken == (number,)
    assert found.content.decode().splitlines() == [line for line in lines if not line.startswith(f"{number}=")]
    source = read_ifc(path, HERE, QUIET)
    assert len(source.windows) == 1
    assert any(f" {number}" in note.replace("(", " ") and "left out" in note for note in source.notes)


@pytest.mark.parametrize("text", ["Halle 'A'", "a;b);(", "ends /* here", "(((", "line\nbreak"])
def test_texts_may_hold_anything(tmp_path: Path, text: str) -> None:
    building = south_window(Building())
    building.building.LongName = text
    assert repaired_file(building.save(tmp_path)) is None


@pytest.mark.parametrize("name", ["Unnamed", "Default", "$", "Project Number"])
def test_placeholders_do_not_name_the_site(tmp_path: Path, name: str) -> None:
    building = south_window(Building())
    building.building.LongName, building.building.Name = name, name
    assert contents(building, tmp_path)[0].name == ""
    building.building.Name = "Haus 7"
    assert contents(building, tmp_path)[0].name == "Haus 7"


@pytest.mark.few(1)
@pytest.mark.parametrize("name", ["office_a", "curtain_wall_small"])
def test_real_files_are_whole(shared_data: Path, name: str) -> None:
    assert repaired_file(shared_data / "bim" / f"{name}.ifc") is None


def test_references_to_something_else_are_refused(tmp_path: Path) -> None:
    path = south_window(Building()).save(tmp_path)
    path.write_text(path.read_text().replace("IFCUNITASSIGNMENT", "IFCPOLYLOOP"))
    with pytest.raises(InputError, match="this IFC file is broken"):
        extract(path, 0.005, 1, lambda _done: None)


@pytest.mark.slow
def test_a_model_without_glass_says_what_to_do_and_takes_a_grid(tmp_path: Path) -> None:
    path = Building().room().save(tmp_path)
    with pytest.raises(InputError, match=r"neither a window nor a glazed plate with geometry; .*--panel-grid"):
        import_site(path, HERE)
    grid = PanelGrid(((1.0, 0.0, 0.5), (9.0, 0.0, 0.5), (1.0, 0.0, 2.5)), 2, 4)
    site = import_site(path, ImportOptions(origin=HERE.origin, panel_grids=(grid,))).model.site
    assert site.n_panels == 8


def test_a_model_without_geometry_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no building element in this file has geometry"):
        imported(Building(), tmp_path)


def test_a_deflection_that_is_no_length_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--deflection 0: expected a positive length"):
        read_ifc(south_window(Building()).save(tmp_path), ImportOptions(deflection_m=0.0), QUIET)


def test_cancelling_ends_the_worker(tmp_path: Path) -> None:
    class Cancelling:
        def report(self, stage: str, done: float, total: float) -> None:
            raise OperationCancelled

    with pytest.raises(OperationCancelled):
        read_ifc(south_window(Building()).save(tmp_path), HERE, Cancelling())


# --- the real ones ---


@pytest.mark.slow
def test_the_real_office_has_69_windows_on_four_facades(shared_data: Path) -> None:
    site = import_site(shared_data / "bim" / "office_a.ifc", ImportOptions())
    model = site.model
    assert model.site.n_panels == 69
    assert [len(facade.panels) for facade in model.site.facades] == [29, 15, 14, 11]
    assert model.site.origin.lat_deg == pytest.approx(42.0 + 21.0 / 60.0 + 30.344238 / 3600.0, abs=2e-4)
    assert model.site.origin.lon_deg == pytest.approx(-(71.0 + 3.0 / 60.0 + 35.194702 / 3600.0), abs=4e-4)
    corners = corners_of(site)
    low, high = model.building.vertices_enu_m.min(axis=0), model.building.vertices_enu_m.max(axis=0)
    normals, centres = unit_normals(corners), corners.mean(axis=1)
    # The building is a box of 50 x 37 m: each pane lies within 0.1 m of the side it looks to.
    for normal, centre in zip(normals, centres, strict=True):
        axis = int(np.argmax(np.abs(normal)))
        assert abs(normal[axis]) > 0.9999
        assert abs(centre[axis] - (high if normal[axis] > 0.0 else low)[axis]) < 0.1
    assert any("hides 0 % of the directions" in note for note in site.notes)


@pytest.mark.slow
def test_the_real_curtain_wall_has_twelve_panes_and_nine_windows(shared_data: Path) -> None:
    site = import_site(shared_data / "bim" / "curtain_wall_small.ifc", ImportOptions())
    facades = site.model.site.facades
    assert [len(facade.panels) for facade in facades] == [12, 9]
    normals = unit_normals(corners_of(site))
    np.testing.assert_allclose(normals[:12], np.tile([0.0, -1.0, 0.0], (12, 1)), atol=1e-6)
    np.testing.assert_allclose(normals[12:], np.tile([1.0, 0.0, 0.0], (9, 1)), atol=1e-6)
