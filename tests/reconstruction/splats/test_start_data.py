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
from reconstruction.splats.surfels import KnownScene, known_scene, points_only, read_points, scene_of_points

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
    found = points_only(KnownScene(PANEL, mesh, points, rgb, 0.0), Path("here"), knows_panels=knows_panels)
    assert found.points_enu_m.tolist() == [list(on_frame), list(behind)]
    assert np.array_equal(found.rgb, rgb[1:])
    assert (len(found.corners_enu_m), len(found.mesh.triangles), found.ground_z_m) == (int(knows_panels), 0, None)


@pytest.mark.parametrize("points", [np.zeros((0, 3)), np.array([[0.5, 0.0, 0.5]])])
def test_a_start_at_points_needs_some_away_from_glass(points):
    scene = KnownScene(PANEL, from_corners(np.ones((1, 3, 3))), points, np.zeros((len(points), 3), np.uint8), 0.0)
    with pytest.raises(InputError, match=f"here: of {len(points)} points of photogrammetry none is away from glass"):
        points_only(scene, Path("here"), knows_panels=True)


CAMERAS = np.array([[2.0, -10.0, 1.6], [8.0, -10.0, 1.6]])


def wall_with_niche(share, n=2000, panels=PANEL[:0]):
    """A wall of 10 x 4 m as a mesh, points spread over it, and points of photos, a share of them 0.8 m behind it."""
    rng = np.random.default_rng(0)
    a, b, c, d = [0.0, 0, 0], [10.0, 0, 0], [10.0, 0, 4], [0.0, 0, 4]
    mesh = from_corners(np.array([[a, b, c], [a, c, d]]))
    x, z = rng.uniform(0.0, 10.0, 2 * n), rng.uniform(0.0, 4.0, 2 * n)
    depths = np.where(rng.random(2 * n) < share, 0.8, np.clip(np.abs(rng.normal(0.0, 0.01, 2 * n)), 0.002, 0.04))
    depths[n:] = 0.0
    points = np.column_stack([x, depths, z])
    return KnownScene(panels, mesh, points, np.full(points.shape, 90, np.uint8), 0.0)


def test_splats_begin_on_points_where_these_do_not_lie_on_the_mesh():
    scene, decision = scene_of_points(wall_with_niche(0.6), CAMERAS)
    assert decision.on
    assert decision.size == pytest.approx(0.6, abs=0.03)
    assert len(scene.mesh.triangles) == 0
    assert len(scene.points_enu_m) == len(scene.rgb) == 2000
    assert scene.points_enu_m[:, 1].min() > 0.0  # none that was spread over the mesh
    assert scene.ground_z_m == 0.0


@pytest.mark.parametrize(("share", "n"), [(0.1, 2000), (0.6, 300)])
def test_a_mesh_that_points_lie_on_is_kept_and_one_that_few_contradict(share, n):
    given = wall_with_niche(share, n)
    scene, decision = scene_of_points(given, CAMERAS)
    assert not decision.on
    assert scene is given
    asked, decision = scene_of_points(given, CAMERAS, "on")
    assert decision.on
    assert decision.decided_by == "user"
    assert len(asked.mesh.triangles) == 0


def test_where_glass_is_known_its_mesh_hides_mirror_images():
    given = wall_with_niche(0.6, panels=PANEL)
    assert scene_of_points(given, CAMERAS, "on") == (given, None)
    alone = KnownScene(PANEL[:0], from_corners(np.zeros((0, 3, 3))), given.points_enu_m, given.rgb)
    assert scene_of_points(alone, CAMERAS) == (alone, None)


def test_an_asked_for_mesh_is_begun_on_whatever_points_say():
    given = wall_with_niche(0.9)
    scene, decision = scene_of_points(given, CAMERAS, "off")
    assert scene is given
    assert not decision.on
