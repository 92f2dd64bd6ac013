"""Meshes with a stated panel grid: formats, axes, units, far-off coordinates, and grids that do not fit."""

from __future__ import annotations

import io
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from planning.base.errors import InputError
from planning.geo.crs import crs_conversion
from planning.geo.enu import enu_from_geodetic, geodetic_from_enu
from planning.geo.frames import Origin
from planning.geo.geoid import undulation_m
from planning.geo.mesh import TriangleMesh, _as_written, box_mesh, ply_bytes
from planning.site.importing.importer import ImportedSite, import_site
from planning.site.importing.options import ImportOptions, PanelGrid
from planning.site.importing.polygons import unit_normals
from planning.site.records import panel_corners

TOWER = box_mesh(np.array([-18.0, 0.0, 0.0]), np.array([18.0, 20.0, 42.0]))
SOUTH = ((-18.0, 0.0, 0.0), (18.0, 0.0, 0.0), (-18.0, 0.0, 42.0))
GRID = PanelGrid(SOUTH, 14, 20, 0.1)
HERE = Origin(22.3372, 114.2636, 62.0)


def written(folder: Path, name: str, mesh: TriangleMesh = TOWER) -> Path:
    path = folder / name
    trimesh.Trimesh(mesh.vertices_enu_m, mesh.triangles, process=False).export(path)
    return path


def moved(mesh: TriangleMesh, shift: tuple[float, float, float], scale: float = 1.0) -> TriangleMesh:
    return TriangleMesh(mesh.vertices_enu_m * scale + np.array(shift), mesh.triangles)


def y_up(mesh: TriangleMesh) -> TriangleMesh:
    """Mesh as glTF has it: x east, y up, z south."""
    x, y, z = mesh.vertices_enu_m.T
    return TriangleMesh(np.stack([x, z, -y], axis=-1), mesh.triangles)


def check_tower(site: ImportedSite) -> None:
    model = site.model
    assert model.site.n_panels == 280
    corners = panel_corners(model.site)
    np.testing.assert_allclose(unit_normals(corners), np.tile([0.0, -1.0, 0.0], (280, 1)), atol=1e-6)
    low, high = model.building.vertices_enu_m.min(axis=0), model.building.vertices_enu_m.max(axis=0)
    np.testing.assert_allclose(high - low, [36.0, 20.0, 42.0], atol=1e-4)
    np.testing.assert_allclose(corners[0, 0] - low, [0.05, 0.0, 0.05], atol=2e-4)
    np.testing.assert_allclose(corners[-1, 2] - low, [35.95, 0.0, 41.95], atol=2e-4)


@pytest.mark.few(2)
@pytest.mark.parametrize("name", ["tower.obj", "tower.ply", "tower.stl", "TOWER.OBJ"])
def test_obj_ply_and_stl_are_z_up_metres(tmp_path: Path, name: str) -> None:
    site = import_site(written(tmp_path, name), ImportOptions(origin=HERE, panel_grids=(GRID,)))
    check_tower(site)
    assert site.model.site.origin == HERE
    assert any("z is up" in note for note in site.notes)


def test_glb_is_y_up(tmp_path: Path) -> None:
    path = written(tmp_path, "tower.glb", y_up(TOWER))
    site = import_site(path, ImportOptions(origin=HERE, panel_grids=(GRID,)))
    check_tower(site)
    assert any("y is up (glTF's rule)" in note for note in site.notes)


def test_the_user_overrules_the_axis(tmp_path: Path) -> None:
    check_tower(import_site(written(tmp_path, "a.glb"), ImportOptions(origin=HERE, up="z", panel_grids=(GRID,))))
    check_tower(
        import_site(written(tmp_path, "a.obj", y_up(TOWER)), ImportOptions(origin=HERE, up="y", panel_grids=(GRID,)))
    )


@pytest.mark.few(2)
@pytest.mark.parametrize(("unit", "unit_m"), [("mm", 0.001), ("cm", 0.01), ("ft", 0.3048), ("in", 0.0254)])
def test_units_are_those_of_the_file_and_the_grid_is_metres(tmp_path: Path, unit: str, unit_m: float) -> None:
    path = written(tmp_path, "a.obj", moved(TOWER, (0.0, 0.0, 0.0), 1.0 / unit_m))
    check_tower(import_site(path, ImportOptions(origin=HERE, unit=unit, panel_grids=(GRID,))))


UTM = (678_052.0, 5_403_685.0, 415.0)


def shifted(grid: PanelGrid, shift: tuple[float, float, float]) -> PanelGrid:
    corners = tuple(tuple(a + b for a, b in zip(corner, shift, strict=True)) for corner in grid.corners)
    return PanelGrid(corners, grid.n_rows, grid.n_columns, grid.gap_m)  # type: ignore[arg-type]


def test_projected_coordinates_are_converted_point_by_point(tmp_path: Path) -> None:
    path = written(tmp_path, "a.obj", moved(TOWER, UTM))
    site = import_site(path, ImportOptions(crs="EPSG:25832", panel_grids=(shifted(GRID, UTM),)))
    assert np.abs(site.model.building.vertices_enu_m).max() < 60.0
    points = np.array(SOUTH) + np.array(UTM)
    place = crs_conversion("EPSG:25832", points).geodetic(points)
    expected = enu_from_geodetic(site.model.site.origin, *place)
    corners = panel_corners(site.model.site)
    # The grid's frame is 5 cm inside, and true north is 1.8 degrees from grid north.
    assert np.linalg.norm(corners[0, 0] - expected[0]) == pytest.approx(0.05 * np.sqrt(2.0), abs=2e-3)
    turn = np.degrees(np.arctan2(*(expected[1] - expected[0])[[1, 0]]))
    assert abs(turn) == pytest.approx(1.8, abs=0.1)
    normal = unit_normals(corners)[0]
    assert np.degrees(np.arctan2(normal[0], -normal[1])) == pytest.approx(turn, abs=1e-3)


def test_projected_coordinates_with_only_an_origin_are_shifted_never_kept(tmp_path: Path) -> None:
    path = written(tmp_path, "a.obj", moved(TOWER, UTM))
    site = import_site(path, ImportOptions(origin=HERE, panel_grids=(shifted(GRID, UTM),)))
    check_tower(site)
    assert site.model.site.origin == HERE
    np.testing.assert_allclose(site.model.building.vertices_enu_m.min(axis=0), [-18.0, -10.0, 0.0], atol=1e-4)
    assert any("5404 km from zero" in note for note in site.notes)


def test_single_precision_far_from_zero_is_named(tmp_path: Path) -> None:
    path = written(tmp_path, "a.stl", moved(TOWER, UTM))
    site = import_site(path, ImportOptions(crs="EPSG:25832", panel_grids=(shifted(GRID, UTM),)))
    assert any("in steps of 0.5 m (single precision)" in note for note in site.notes)


@pytest.mark.few(2)
@pytest.mark.parametrize(
    "origin", [Origin(-17.0, 179.9999, 5.0), Origin(75.0, -60.0, 10.0), Origin(31.5, 35.4, -430.0), Origin(90, 0, 0)]
)
def test_hard_places_work_and_keep_the_coordinates_of_the_file(tmp_path: Path, origin: Origin) -> None:
    site = import_site(written(tmp_path, "a.obj"), ImportOptions(origin=origin, panel_grids=(GRID,)))
    check_tower(site)
    np.testing.assert_allclose(site.model.building.vertices_enu_m, TOWER.vertices_enu_m, atol=1e-6)
    place = geodetic_from_enu(site.model.site.origin, panel_corners(site.model.site).reshape(-1, 3))
    assert ((place.lon_deg >= -180.0) & (place.lon_deg < 180.0)).all()
    assert place.ellipsoid_height_m.min() == pytest.approx(origin.ellipsoid_height_m + 0.05, abs=1e-3)


def test_the_height_of_a_named_origin_may_be_above_sea_level(tmp_path: Path) -> None:
    options = ImportOptions(origin=HERE, panel_grids=(GRID,), height_reference="orthometric")
    site = import_site(written(tmp_path, "a.obj"), options)
    height_m = 62.0 + float(undulation_m(HERE.lat_deg, HERE.lon_deg))
    assert site.model.site.origin.ellipsoid_height_m == pytest.approx(height_m, abs=1e-3)
    assert height_m < 61.0  # the geoid is below the ellipsoid here
    assert any("above sea level is" in note for note in site.notes)


def test_several_grids_become_facades_by_plane(tmp_path: Path) -> None:
    east = PanelGrid(((18.0, 0.0, 0.0), (18.0, 20.0, 0.0), (18.0, 0.0, 42.0)), 3, 2)
    upper = PanelGrid(((-18.0, 0.0, 21.0), (18.0, 0.0, 21.0), (-18.0, 0.0, 42.0)), 2, 4)
    lower = PanelGrid(((-18.0, 0.0, 0.0), (18.0, 0.0, 0.0), (-18.0, 0.0, 21.0)), 2, 4)
    options = ImportOptions(origin=HERE, panel_grids=(upper, east, lower))
    facades = import_site(written(tmp_path, "a.obj"), options).model.site.facades
    assert [len(facade.panels) for facade in facades] == [16, 6]
    assert facades[0].panels[0].corners_enu_m[0] == (-18.0, 0.0, 0.0)
    assert facades[0].panels[-1].corners_enu_m[2] == (18.0, 0.0, 42.0)
    assert [panel.id for panel in facades[1].panels][:2] == ["B-0000", "B-0001"]


@pytest.mark.few(4)
@pytest.mark.parametrize(
    ("grid", "said"),
    [
        (
            PanelGrid(((-18.0, -9.0, 0.0), (18.0, -9.0, 0.0), (-18.0, -9.0, 42.0)), 4, 4),
            r"lie 9\.0 m from the building",
        ),
        (PanelGrid(((0.0, 0.0, 0.0), (36.0, 0.0, 0.0), (0.0, 0.0, 4200.0)), 4, 4), "from the building"),
        (PanelGrid((SOUTH[1], SOUTH[0], (18.0, 0.0, 42.0)), 4, 4), "look into the building, and their backs"),
        (PanelGrid((SOUTH[0], SOUTH[1], (0.0, 0.0, 42.0)), 4, 4), "angle at the lower left corner is 67 degrees"),
        (PanelGrid((SOUTH[0], SOUTH[0], SOUTH[2]), 4, 4), r"0\.00 x 42\.00 m, no facade"),
        (PanelGrid(SOUTH, 0, 4), "--rows 0 --columns 4"),
        (PanelGrid(SOUTH, 1000, 1000), "expected 1 to 100000 panels"),
        (PanelGrid(SOUTH, 14, 20, 1.8), "leaves no glass between the mullions"),
        (PanelGrid(SOUTH, 14, 20, -0.1), "leaves no glass"),
    ],
)
def test_grids_that_do_not_fit_are_refused_with_what_was_measured(tmp_path: Path, grid: PanelGrid, said: str) -> None:
    with pytest.raises(InputError, match=said):
        import_site(written(tmp_path, "a.obj"), ImportOptions(origin=HERE, panel_grids=(grid,)))


def test_a_grid_off_the_mesh_is_kept_when_the_user_allows_it(tmp_path: Path) -> None:
    grid = PanelGrid(((-18.0, -3.0, 0.0), (18.0, -3.0, 0.0), (-18.0, -3.0, 42.0)), 4, 4)
    options = ImportOptions(origin=HERE, panel_grids=(grid,), grid_tolerance_m=5.0)
    assert import_site(written(tmp_path, "a.obj"), options).model.site.n_panels == 16


def test_panels_covered_by_the_mesh_are_counted(tmp_path: Path) -> None:
    porch = box_mesh(np.array([-18.0, -2.0, 0.0]), np.array([18.0, 0.0, 4.0]))
    mesh = TriangleMesh(
        np.concatenate([TOWER.vertices_enu_m, porch.vertices_enu_m]),
        np.concatenate([TOWER.triangles, porch.triangles + 8]),
    )
    site = import_site(written(tmp_path, "a.obj", mesh), ImportOptions(origin=HERE, panel_grids=(GRID,)))
    assert any("20 of 280 panels of the grid see nothing of the open" in note for note in site.notes)


def test_a_scan_with_holes_where_the_glass_is_takes_a_grid(tmp_path: Path) -> None:
    # Photogrammetry fails on glass: the south wall is missing but for a rim.
    south = (TOWER.corners_enu_m[:, :, 1] == 0.0).all(axis=1)
    rim = [box_mesh(np.array([x, 0.0, 0.0]), np.array([x + 1.0, 0.1, 42.0])) for x in (-18.0, -6.5, 5.5, 17.0)]
    parts = [TOWER.corners_enu_m[~south], *(part.corners_enu_m for part in rim)]
    corners = np.concatenate(parts)
    mesh = TriangleMesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    options = ImportOptions(origin=HERE, panel_grids=(GRID,), grid_tolerance_m=3.0)
    check_tower(import_site(written(tmp_path, "a.ply", mesh), options))


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.ply", b"not a mesh", "cannot be read"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\n", "no triangles"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n", "no triangles that are whole"),
        ("a.obj", b"v 0 0 0\nf 1 2 3\n", "no triangles that are whole"),
        ("a.glb", b"glTF\x02\x00\x00\x00", "is no GLB file, or cut off"),
        ("a.stl", b"", "cannot be read|no triangles"),
    ],
)
def test_meshes_that_cannot_be_read_are_refused(tmp_path: Path, name: str, content: bytes, said: str) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InputError, match=said):
        import_site(path, ImportOptions(origin=HERE, panel_grids=(GRID,)))


def test_a_point_cloud_is_no_mesh(shared_data: Path) -> None:
    path = shared_data / "buildings" / "pointclouds" / "city3d_12.ply"
    with pytest.raises(InputError, match="a point cloud cannot serve as a building"):
        import_site(path, ImportOptions(origin=HERE, panel_grids=(GRID,)))


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (ImportOptions(origin=HERE), "--panel-grid '0,0,0 36,0,0 0,0,42'"),
        (ImportOptions(panel_grids=(GRID,)), "--origin LAT,LON,HEIGHT"),
        (ImportOptions(panel_grids=(GRID,), origin=HERE, crs="EPSG:25832"), "give one of them"),
        (ImportOptions(panel_grids=(GRID,), crs="EPSG:25832"), "far outside the area of use"),
        (ImportOptions(panel_grids=(GRID,), crs="EPSG:25832", unit="mm"), "--units and --crs both"),
        (ImportOptions(panel_grids=(GRID,), origin=HERE, unit="in"), "from the building"),
    ],
)
def test_missing_or_contradicting_wishes_are_refused(tmp_path: Path, options: ImportOptions, said: str) -> None:
    with pytest.raises(InputError, match=said):
        import_site(written(tmp_path, "a.obj"), options)


def test_written_meshes_are_those_of_trimesh_to_the_last_bit() -> None:
    rng = np.random.default_rng(0)
    rough = TriangleMesh(rng.normal(0.0, 1e4, (50, 3)), rng.integers(0, 50, (80, 3)))
    for mesh in (TOWER, rough, TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), np.int64))):
        known = trimesh.Trimesh(mesh.vertices_enu_m, mesh.triangles, process=False).export(file_type="ply")
        assert ply_bytes(mesh) == known


@given(st.data())
def test_written_meshes_are_read_as_trimesh_reads_them_and_damaged_ones_as_before(data: st.DataObject) -> None:
    rng = np.random.default_rng(data.draw(st.integers(0, 2**32 - 1)))
    n_vertices = int(rng.integers(3, 9))
    triangles = rng.integers(0, n_vertices, (int(rng.integers(1, 9)), 3))
    content = bytearray(ply_bytes(TriangleMesh(rng.normal(size=(n_vertices, 3)), triangles)))
    damage = data.draw(st.sampled_from(["none", "byte", "cut", "more"]))
    if damage == "byte":
        content[int(rng.integers(len(content)))] ^= int(rng.integers(1, 256))
    elif damage == "cut":
        del content[len(content) - int(rng.integers(1, 30)) :]
    elif damage == "more":
        content += bytes(int(rng.integers(1, 30)))
    found = _as_written(bytes(content))
    if damage in ("cut", "more"):
        assert found is None
    if damage == "none":
        assert found is not None
    if found is not None:
        expected = trimesh.load_mesh(
            io.BytesIO(bytes(content)), file_type="ply", process=False, maintain_order=True, skip_materials=True
        )
        np.testing.assert_array_equal(found[0], np.asarray(expected.vertices))
        np.testing.assert_array_equal(found[1], np.asarray(expected.faces))


def test_a_site_is_read_without_trimesh(tmp_path: Path) -> None:
    """It takes half as long to load as all else that planning needs."""
    path = tmp_path / "building.ply"
    path.write_bytes(ply_bytes(box_mesh((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))))
    program = (
        "import sys; from pathlib import Path; from planning.geo.mesh import read_mesh; "
        "read_mesh(Path(sys.argv[1])); sys.exit('trimesh' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", program, str(path)], check=False).returncode == 0
