"""CityJSON: small files built here, broken ones, and the real LOD2 blocks with a stated panel grid."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from planning.base.errors import InputError
from planning.geo.crs import crs_conversion
from planning.geo.enu import enu_from_geodetic
from planning.site.free_space import free_space
from planning.site.importing.importer import ImportedSite, import_site
from planning.site.importing.options import ImportOptions, PanelGrid
from planning.site.importing.polygons import unit_normals
from planning.site.records import panel_corners

DELFT = (84_990.0, 447_470.0, 1.5)
"""A place in Delft, EPSG:7415."""

VERTICES = [[x, y, z] for z in (0, 6000) for x, y in ((0, 0), (10000, 0), (10000, 8000), (0, 8000))]
WINDOW = [[2000, 0, 1000], [4000, 0, 1000], [4000, 0, 2500], [2000, 0, 2500]]

SURFACES = [
    [[0, 1, 5, 4]],
    [[1, 2, 6, 5]],
    [[2, 3, 7, 6]],
    [[3, 0, 4, 7]],
    [[4, 5, 6, 7]],
    [[3, 2, 1, 0]],
    [[8, 9, 10, 11]],
]
MEANINGS = [0, 0, 0, 0, 1, 2, 3]
KINDS: list[dict[str, Any]] = [
    {"type": "WallSurface"},
    {"type": "RoofSurface"},
    {"type": "GroundSurface"},
    {"type": "Window", "id": "win-1"},
]


def city(version: str = "2.0", geometry: str = "MultiSurface", lod: Any = "3.2") -> dict[str, Any]:
    """A house with one window; boundaries and semantic values nested as the geometry type asks."""
    boundaries: Any = copy.deepcopy(SURFACES)
    values: Any = list(MEANINGS)
    if geometry in ("Solid", "MultiSolid"):
        boundaries, values = [boundaries], [values]
    if geometry == "MultiSolid":
        boundaries, values = [boundaries], [values]
    shape = {"type": geometry, "lod": lod, "boundaries": boundaries, "semantics": {"surfaces": KINDS, "values": values}}
    return {
        "type": "CityJSON",
        "version": version,
        "transform": {"scale": [0.001] * 3, "translate": list(DELFT)},
        "metadata": {"referenceSystem": "https://www.opengis.net/def/crs/EPSG/0/7415"},
        "CityObjects": {"house": {"type": "Building", "geometry": [copy.deepcopy(shape)]}},
        "vertices": [*copy.deepcopy(VERTICES), *copy.deepcopy(WINDOW)],
    }


def imported(content: Any, folder: Path, options: ImportOptions | None = None) -> ImportedSite:
    path = folder / "block.city.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return import_site(path, options or ImportOptions())


def expected_window(site: ImportedSite) -> np.ndarray:
    points = np.array(WINDOW) * 0.001 + np.array(DELFT)
    return enu_from_geodetic(site.model.site.origin, *crs_conversion("EPSG:7415", points).geodetic(points))


@pytest.mark.few(6)
@pytest.mark.parametrize("geometry", ["MultiSurface", "CompositeSurface", "Solid", "MultiSolid"])
@pytest.mark.parametrize("version", ["1.0", "1.1", "2.0"])
def test_every_version_and_geometry_type_gives_the_window(tmp_path: Path, version: str, geometry: str) -> None:
    site = imported(city(version, geometry, lod=3 if version == "1.0" else "3.2"), tmp_path)
    (panel,) = site.model.site.panels
    assert panel.source_id == "win-1"
    np.testing.assert_allclose(panel.corners_enu_m, expected_window(site), atol=2e-4)
    assert unit_normals(panel_corners(site.model.site))[0][1] < -0.99
    assert len(site.model.building.triangles) == 14


def test_a_file_without_transform_has_plain_coordinates(tmp_path: Path) -> None:
    content = city("1.0")
    content["vertices"] = (np.array(content["vertices"]) * 0.001 + np.array(DELFT)).tolist()
    del content["transform"]
    site = imported(content, tmp_path)
    np.testing.assert_allclose(site.model.site.panels[0].corners_enu_m, expected_window(site), atol=2e-4)


def test_the_finest_geometry_is_read_and_parts_are_included(tmp_path: Path) -> None:
    content = city()
    house = content["CityObjects"]["house"]
    coarse = {"type": "Solid", "lod": "1", "boundaries": [SURFACES[:6]]}
    content["CityObjects"] = {
        "house": {"type": "Building", "children": ["part"], "attributes": {"name": "Rathaus"}},
        "part": {"type": "BuildingPart", "parents": ["house"], "geometry": [coarse, *house["geometry"]]},
        "room": {"type": "BuildingRoom", "parents": ["house"], "geometry": [coarse]},
    }
    site = imported(content, tmp_path)
    assert site.model.site.name == "Rathaus"
    assert len(site.model.building.triangles) == 14
    assert imported(content, tmp_path, ImportOptions(building="part")).model.site.n_panels == 1


def test_surfaces_without_an_identifier_are_numbered_within_their_object(tmp_path: Path) -> None:
    content = city()
    content["CityObjects"]["house"]["geometry"][0]["semantics"]["surfaces"][3] = {"type": "Window"}
    assert imported(content, tmp_path).model.site.panels[0].source_id == "house#3"


def test_null_values_are_plain_surfaces(tmp_path: Path) -> None:
    content = city(geometry="Solid")
    values = content["CityObjects"]["house"]["geometry"][0]["semantics"]["values"]
    values[0][:6] = [None] * 6
    assert imported(content, tmp_path).model.site.n_panels == 1


@pytest.mark.long
@pytest.mark.few(3)
@pytest.mark.parametrize(
    ("path", "value", "said"),
    [
        (["type"], "FeatureCollection", "expected a CityJSON file"),
        (["version"], "3.0", "expected CityJSON version 1.0, 1.1, 2.0, got '3.0'"),
        (["CityObjects"], 5, "is broken"),
        (["CityObjects"], {}, "no building with surfaces"),
        (["CityObjects", "house", "type"], "Bridge", "no building with surfaces"),
        (["metadata"], {}, "--crs EPSG:CODE"),
        (
            ["transform", "scale"],
            [1.0, 1.0, 1.0],
            r"the building would be \d+ x \d+ x 6000 m, .* the unit or the scale",
        ),
    ],
)
def test_broken_files_are_refused_with_the_reason(tmp_path: Path, path: list[Any], value: Any, said: str) -> None:
    content = city()
    target: Any = content
    for key in path[:-1]:
        target = target[key]
    target[path[-1]] = value
    with pytest.raises(InputError, match=said):
        imported(content, tmp_path)


def damaged(path: list[Any], value: Any) -> dict[str, Any]:
    content = city()
    target: Any = content
    for key in path[:-1]:
        target = target[key]
    if isinstance(target, list) and path[-1] == len(target):
        target.append(value)
    else:
        target[path[-1]] = value
    return content


SHAPE = ["CityObjects", "house", "geometry", 0]


@pytest.mark.few(6)
@pytest.mark.parametrize(
    ("path", "value", "n_triangles", "named"),
    [
        (["vertices", 0], [1, 2], 6 + 2, "3 (house)"),
        (["vertices", 0], ["a", 0, 0], 6 + 2, "3 (house)"),
        ([*SHAPE, "boundaries", 0], [[0, 1, 99]], 10 + 2, "1 (house)"),
        ([*SHAPE, "boundaries", 0], [[0, -1, 5]], 10 + 2, "1 (house)"),
        ([*SHAPE, "boundaries", 0], [[0, 1]], 10 + 2, "1 (house)"),
        ([*SHAPE, "boundaries", 0], None, 10 + 2, "1 (house)"),
        (["CityObjects", "shed"], {"type": "Building", "geometry": 7}, 14, ""),
        (["CityObjects", "shed"], "nothing", 14, ""),
        (["CityObjects", "house", "attributes"], [], 14, ""),
        ([*SHAPE, "semantics", "surfaces", 0], None, 14, ""),
        (["CityObjects", "house", "geometry", 1], {"type": "GeometryInstance", "template": 0}, 14, "GeometryInstance"),
        (["CityObjects", "house", "geometry", 1], {"type": "MultiPoint", "boundaries": [0]}, 14, ""),
        (["CityObjects", "house", "geometry", 1], "a roof", 14, "1 (house)"),
    ],
)
def test_what_is_broken_is_left_out_and_told(
    tmp_path: Path, path: list[Any], value: Any, n_triangles: int, named: str
) -> None:
    site = imported(damaged(path, value), tmp_path)
    assert site.model.site.n_panels == 1
    assert len(site.model.building.triangles) == n_triangles
    told = [note for note in site.notes if "left out, because they are broken" in note]
    assert len(told) == bool(named)
    assert all(named in note for note in told)


@pytest.mark.parametrize("values", [[0, 1], "walls"])
def test_meanings_that_do_not_fit_leave_surfaces_without_any(tmp_path: Path, values: Any) -> None:
    content = damaged([*SHAPE, "semantics", "values"], values)
    with pytest.raises(InputError, match="no building in this file has windows"):
        imported(content, tmp_path)
    site = imported(content, tmp_path, ImportOptions(panels_required=False))
    assert len(site.model.building.triangles) == 14
    assert any("house: semantics" in note for note in site.notes) == (values != "walls")


@pytest.mark.parametrize(
    "text", ["", "{", "[1, 2]", '{"type": "CityJSON", "version": "2.0", "vertices": [[NaN, 0, 0]]}']
)
def test_files_that_are_no_json_objects_are_refused(tmp_path: Path, text: str) -> None:
    with pytest.raises(InputError, match=r"block.city.json"):
        imported(text, tmp_path)


def test_stray_vertices_of_a_building_are_left_out_and_told(tmp_path: Path) -> None:
    content = city()
    content["vertices"][0] = [0, 30_000_000, 0]
    site = imported(content, tmp_path)
    assert site.model.site.n_panels == 1
    assert np.ptp(site.model.building.vertices_enu_m, axis=0).max() < 12.0
    assert any(note.startswith("left out as strays") and "triangles" in note for note in site.notes)


# --- real LOD2 blocks ---


@pytest.mark.parametrize("name", ["delft_1b", "multi_lod", "rotterdam_subset", "zurich_subset_lod2"])
def test_real_blocks_without_windows_say_what_to_do(shared_data: Path, name: str) -> None:
    path = shared_data / "buildings" / "cityjson" / f"{name}.json"
    with pytest.raises(InputError, match=r"no building in this file has windows; .*--panel-grid"):
        import_site(path, ImportOptions())


def largest_wall(path: Path) -> tuple[str, np.ndarray]:
    """The building with the largest vertical rectangle, and its lower left, lower right and upper left corner."""
    content = json.loads(path.read_text())
    vertices = np.array(content["vertices"]) * np.array(content["transform"]["scale"])
    vertices = vertices + np.array(content["transform"]["translate"])
    found: list[tuple[float, str, np.ndarray]] = []
    for name, item in content["CityObjects"].items():
        for geometry in item.get("geometry", []):
            shells = geometry["boundaries"] if geometry["type"] == "MultiSurface" else geometry["boundaries"][0]
            for ring, *_ in shells:
                points = vertices[ring]
                normal = 0.5 * np.cross(points - points[0], np.roll(points, -1, axis=0) - points[0]).sum(axis=0)
                area = float(np.linalg.norm(normal))
                if area < 10.0 or abs(normal[2]) > 0.01 * area:
                    continue
                right = np.array([-normal[1], normal[0], 0.0]) / np.hypot(normal[0], normal[1])
                along, low, high = points @ right, points[:, 2].min(), points[:, 2].max()
                if area < 0.45 * np.ptp(along) * (high - low):
                    continue
                start = points[0] + (along.min() - along[0]) * right
                end = start + np.ptp(along) * right
                owner = item.get("parents", [name])[0]
                found.append((area, owner, np.array([[*start[:2], low], [*end[:2], low], [*start[:2], high]])))
    _, name, corners = max(found, key=lambda wall: wall[0])
    return name, corners


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("name", "crs"), [("delft_1b", None), ("rotterdam_subset", "EPSG:7415"), ("zurich_subset_lod2", None)]
)
def test_real_blocks_take_a_panel_grid_on_a_wall_in_their_own_coordinates(
    shared_data: Path, name: str, crs: str | None
) -> None:
    path = shared_data / "buildings" / "cityjson" / f"{name}.json"
    building, wall = largest_wall(path)
    corners = tuple(tuple(float(v) for v in point) for point in wall)
    grid = PanelGrid(corners, 3, 5, gap_m=0.1)  # type: ignore[arg-type]
    site = import_site(path, ImportOptions(crs=crs, panel_grids=(grid,)))
    model = site.model
    assert model.site.n_panels == 15
    if name != "delft_1b":
        assert any(f"the facade grid is on building '{building}'" in note for note in site.notes)
    system = crs or json.loads(path.read_text())["metadata"]["referenceSystem"]
    low_left = enu_from_geodetic(model.site.origin, *crs_conversion(system, wall).geodetic(wall))[0]
    first = panel_corners(model.site)[0, 0]
    assert np.linalg.norm(first - low_left) == pytest.approx(0.05 * np.sqrt(2.0), abs=0.01)
    free_space(model, 10.0)  # home is 10 m and more from everything
