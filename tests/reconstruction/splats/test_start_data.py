from pathlib import Path

import numpy as np
import pytest

from planning.base.errors import InputError
from planning.geo.mesh import from_corners, write_mesh
from reconstruction.colmap.folder import write_model
from reconstruction.colmap.record import ColmapModel, ColmapPoints
from reconstruction.dataset.records import coloured_ply
from reconstruction.light.photo_set import PanelPlanes, PhotoSet
from reconstruction.splats.ply import write_blocks
from reconstruction.splats.surfels import KnownScene, known_scene, points_alone, read_points

XYZ = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
RGB = np.array([[10, 20, 30], [40, 50, 60]], np.uint8)
PANEL = np.array([[(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)]], float)


def photo_set(folder):
    return PhotoSet(folder, (), PanelPlanes(PANEL), 1.0, {})


def test_points_of_a_data_set_come_with_their_colours(tmp_path):
    (tmp_path / "points.ply").write_bytes(coloured_ply(XYZ, RGB))
    found = known_scene(photo_set(tmp_path))
    assert np.array_equal(found.points_enu_m, XYZ)
    assert np.array_equal(found.rgb, RGB)
    assert np.array_equal(found.corners_enu_m, PANEL)
    assert len(found.mesh.triangles) == 0
    assert found.ground_z_m is None


def test_the_refined_mesh_goes_before_the_building_and_stands_on_the_ground(tmp_path):
    corners = np.array([[[0, 0, -3], [1, 0, 0], [0, 0, 1]]], float)
    write_mesh(tmp_path / "building.ply", from_corners(np.repeat(corners, 2, axis=0)))
    assert len(known_scene(photo_set(tmp_path)).mesh.triangles) == 2
    write_mesh(tmp_path / "refined.ply", from_corners(corners))
    found = known_scene(photo_set(tmp_path))
    assert len(found.mesh.triangles) == 1
    assert found.ground_z_m == -3.0


def test_a_folder_without_points_or_mesh_still_has_its_panels(tmp_path):
    found = known_scene(photo_set(tmp_path))
    assert (len(found.points_enu_m), len(found.rgb), len(found.corners_enu_m)) == (0, 0, 1)


def test_points_without_colours_are_grey(tmp_path):
    row = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4")])
    write_blocks(tmp_path / "a.ply", 2, row, [], [np.zeros(2, row)])
    assert read_points(tmp_path / "a.ply")[1].tolist() == [[128] * 3] * 2


@pytest.mark.parametrize(
    ("names", "value", "message"), [(("x", "y"), 0.0, "have no 'z'"), (("x", "y", "z"), np.nan, "not finite numbers")]
)
def test_points_that_are_none_are_refused(tmp_path, names, value, message):
    row = np.dtype([(name, "<f4") for name in names])
    block = np.full(2, np.array([tuple([value] * len(names))], row))
    write_blocks(tmp_path / "points.ply", 2, row, [], [block])
    with pytest.raises(InputError, match=rf"points.ply.*{message}"):
        known_scene(photo_set(tmp_path))


def test_without_a_file_of_their_own_points_are_those_of_colmap_but_for_those_that_fit_badly(tmp_path):
    tracks = np.zeros(3, np.int64), np.zeros((0, 2), np.int64)
    points = ColmapPoints(np.array([1, 2]), XYZ, RGB, np.array([0.5, 9.0]), *tracks)
    write_model(tmp_path / "sparse" / "0", ColmapModel({}, {}, points))
    found = known_scene(photo_set(tmp_path))
    assert np.array_equal(found.points_enu_m, XYZ[:1])
    assert np.array_equal(found.rgb, RGB[:1])
    (tmp_path / "points.ply").write_bytes(coloured_ply(XYZ, RGB))
    assert len(known_scene(photo_set(tmp_path)).points_enu_m) == 2


@pytest.mark.parametrize("knows_panels", [False, True])
def test_a_start_at_points_leaves_out_what_photogrammetry_does_not_find(knows_panels):
    """Glass, the mesh and the ground; what is mirrored stands behind glass, where points stay."""
    on_glass, on_frame, behind = (0.5, 0.1, 0.5), (1.1, 0.0, 0.5), (0.5, 4.0, 0.5)
    mesh = from_corners(np.ones((1, 3, 3)))
    points, rgb = np.array([on_glass, on_frame, behind]), np.arange(9, dtype=np.uint8).reshape(3, 3)
    found = points_alone(KnownScene(PANEL, mesh, points, rgb, 0.0), Path("here"), knows_panels=knows_panels)
    assert found.points_enu_m.tolist() == [list(on_frame), list(behind)]
    assert np.array_equal(found.rgb, rgb[1:])
    assert (len(found.corners_enu_m), len(found.mesh.triangles), found.ground_z_m) == (int(knows_panels), 0, None)


@pytest.mark.parametrize("points", [np.zeros((0, 3)), np.array([[0.5, 0.0, 0.5]])])
def test_a_start_at_points_needs_some_away_from_glass(points):
    scene = KnownScene(PANEL, from_corners(np.ones((1, 3, 3))), points, np.zeros((len(points), 3), np.uint8), 0.0)
    with pytest.raises(InputError, match=f"here: of {len(points)} points of photogrammetry none is away from glass"):
        points_alone(scene, Path("here"), knows_panels=True)
