"""Made points on a building of two wings: its ground, walls, blocks and what is closed between them."""

from __future__ import annotations

import numpy as np
import pytest

from planning.geo.mesh import closed_parts
from reconstruction.base.ray_casting import RayCaster
from reconstruction.coarse.buildings import make_buildings, moved, prism
from reconstruction.coarse.walls import BuildingParameters, find_ground
from tests.reconstruction.coarse.made_clouds import LOW, TALL, made_cloud

SIZES = BuildingParameters(cell_m=0.35, tolerance_m=0.08)


@pytest.fixture(scope="module")
def plain():
    return make_buildings(made_cloud(), SIZES)


@pytest.fixture(scope="module")
def glazed():
    return make_buildings(made_cloud(glass_m=14.0, mirrored=150), SIZES)


def height_at(buildings, x, y):
    """Of the mesh, by a ray from above."""
    hits = RayCaster(buildings.mesh).cast(np.array([[x, y, 100.0]]), np.array([[0.0, 0.0, -1.0]]))
    return 100.0 - float(hits.distance_m[0])


def wall_errors(buildings):
    """How far the south, north and west walls of the tall wing are off, by rays from outside."""
    starts = np.array([[-8.0, -50.0, 5.0], [-4.0, 50.0, 8.0], [-50.0, 0.0, 4.0]])
    ways = np.array([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]])
    hits = RayCaster(buildings.mesh).cast(starts, ways)
    return np.abs(hits.distance_m - [44.0, 44.0, 38.0])


def test_walls_lie_within_centimetres_and_blocks_close(plain):
    assert wall_errors(plain).max() < 0.05
    assert (closed_parts(plain.mesh.corners_enu_m) >= 0).all()
    assert all(face.seen_share > 0.5 for face in plain.faces if face.area_m2 > 20.0)


def test_each_wing_has_its_own_height(plain):
    (x, y), (u, v), top = TALL
    assert height_at(plain, (x + u) / 2, (y + v) / 2) == pytest.approx(top, abs=0.15)
    (x, y), (u, v), top = LOW
    assert height_at(plain, (x + u) / 2 + 1.0, (y + v) / 2) == pytest.approx(top, abs=0.15)
    assert not np.isfinite(height_at(plain, 13.0, 5.0))


def test_glass_is_closed_by_its_frame_and_mirror_images_are_no_walls(glazed):
    hits = RayCaster(glazed.mesh).cast(np.array([[-2.0, -50.0, 7.0]]), np.array([[0.0, 1.0, 0.0]]))
    assert float(hits.distance_m[0]) == pytest.approx(44.0, abs=0.1)
    assert height_at(glazed, -2.0, -3.0) == pytest.approx(TALL[2], abs=0.15)
    southern = [wall.offset_m for wall in glazed.walls if wall.normal[1] < -0.9]
    assert southern == pytest.approx([6.0], abs=0.05)


def test_what_was_closed_is_told(plain, glazed):
    def seen_m2(buildings):
        return sum(face.area_m2 * face.seen_share for face in buildings.faces)

    assert seen_m2(glazed) < seen_m2(plain) - 40.0


def test_ground_is_the_lowest_wide_level(plain):
    cloud = made_cloud()
    strays = np.column_stack([np.random.default_rng(0).uniform(-20.0, 20.0, (10, 2)), np.full(10, -3.0)])
    ground = find_ground(np.concatenate([cloud.points, strays]), 0.35)
    assert ground.is_seen
    assert ground.z_m == pytest.approx(0.0, abs=0.05)
    assert ground.slope_deg < 0.5
    assert plain.ground.z_m == pytest.approx(0.0, abs=0.05)


def test_a_building_moves_as_a_whole(plain):
    shift = np.array([3.0, -2.0, 1.5])
    other = moved(plain, shift)
    np.testing.assert_allclose(other.mesh.vertices_enu_m, plain.mesh.vertices_enu_m + shift)
    np.testing.assert_allclose(other.walls[0].line, plain.walls[0].line + shift[:2])


def test_no_points_on_walls_give_no_blocks_and_a_note():
    cloud = made_cloud()
    flat = cloud.of(cloud.points[:, 2] < 0.2)
    found = make_buildings(flat, SIZES)
    assert len(found.mesh.triangles) == 0
    assert len(found.notes) == 1


def test_a_prism_with_a_court_is_closed():
    import shapely

    ring = shapely.Polygon([(0, 0), (10, 0), (10, 10), (0, 10)], [[(3, 3), (7, 3), (7, 7), (3, 7)]])
    mesh = prism(ring, 0.0, np.array([0.1, 0.0, 5.0]))
    assert (closed_parts(mesh.corners_enu_m) >= 0).all()
    hits = RayCaster(mesh).cast(np.array([[5.0, 5.0, 50.0], [9.0, 5.0, 50.0]]), np.array([[0.0, 0.0, -1.0]] * 2))
    assert not np.isfinite(hits.distance_m[0])
    assert float(hits.distance_m[1]) == pytest.approx(50.0 - 5.9)
