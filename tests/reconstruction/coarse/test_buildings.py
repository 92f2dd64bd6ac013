"""Made points on a building of two wings: its ground, walls, blocks and what is closed between them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from planning.geo.mesh import closed_parts
from planning.geo.ray_casting import RayCaster
from reconstruction.base.cameras import cam_from_enu
from reconstruction.coarse.buildings import Face, about_walls, make_buildings, moved, prism
from reconstruction.coarse.cloud import in_ring
from reconstruction.coarse.walls import BuildingParameters, find_ground
from tests.reconstruction.coarse.synthetic_clouds import LOW, TALL, cameras, made_cloud

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


@pytest.mark.long
def test_walls_lie_within_centimetres_and_blocks_close(plain):
    assert wall_errors(plain).max() < 0.05
    assert (closed_parts(plain.mesh.corners_enu_m) >= 0).all()
    assert all(face.seen_share > 0.5 for face in plain.faces if face.area_m2 > 20.0)


@pytest.mark.long
def test_each_wing_has_its_own_height(plain):
    (x, y), (u, v), top = TALL
    assert height_at(plain, (x + u) / 2, (y + v) / 2) == pytest.approx(top, abs=0.15)
    (x, y), (u, v), top = LOW
    assert height_at(plain, (x + u) / 2 + 1.0, (y + v) / 2) == pytest.approx(top, abs=0.15)
    assert not np.isfinite(height_at(plain, 13.0, 5.0))


@pytest.mark.slow
def test_houses_side_by_side_each_have_walls_and_a_roof():
    """One side of the row was flown along more often: from there the walls on the lane are behind the first house."""
    houses = (((-16.0, -6.0), (-4.0, 6.0), 15.0), ((4.0, -5.0), (14.0, 5.0), 12.0))
    cloud = made_cloud(blocks=houses)
    row = np.column_stack([np.full(60, -40.0), np.linspace(-8.0, 8.0, 60), np.full(60, 5.0)])
    found = make_buildings(replace(cloud, centres=np.concatenate([cloud.centres, row])), SIZES)
    for (x, y), (u, v), top in houses:
        assert height_at(found, (x + u) / 2, (y + v) / 2) == pytest.approx(top, abs=0.15)
        ends = np.array([face.ends_m for face in found.faces if face.top_m == pytest.approx(top, abs=0.15)])
        assert len(ends) == 4
        assert ends.min(axis=(0, 1)) == pytest.approx((x, y), abs=0.1)
        assert ends.max(axis=(0, 1)) == pytest.approx((u, v), abs=0.1)
    assert not np.isfinite(height_at(found, 0.0, 0.0))
    assert all(face.wall is not None for face in found.faces), "none is guessed"
    assert not found.others


@pytest.mark.slow
def test_glass_is_closed_by_its_frame_and_mirror_images_are_no_walls(glazed):
    hits = RayCaster(glazed.mesh).cast(np.array([[-2.0, -50.0, 7.0]]), np.array([[0.0, 1.0, 0.0]]))
    assert float(hits.distance_m[0]) == pytest.approx(44.0, abs=0.1)
    assert height_at(glazed, -2.0, -3.0) == pytest.approx(TALL[2], abs=0.15)
    southern = [wall.offset_m for wall in glazed.walls if wall.normal[1] < -0.9]
    assert southern == pytest.approx([6.0], abs=0.05)


@pytest.mark.long
def test_what_was_closed_is_told(plain, glazed):
    def seen_m2(buildings):
        return sum(face.area_m2 * face.seen_share for face in buildings.faces)

    assert seen_m2(glazed) < seen_m2(plain) - 40.0


@pytest.mark.long
@pytest.mark.parametrize("angle_deg", [0.05, 0.3, 31.0])
def test_two_walls_are_sides_of_the_block_whatever_way_it_stands(angle_deg):
    cloud = made_cloud()
    x, y, z = cloud.points.T
    is_seen = ((np.abs(y + 6.0) < 0.15) & (x < 8.0)) | ((np.abs(x + 12.0) < 0.15) & (np.abs(y) < 6.0))
    is_frame = np.random.default_rng(0).random(len(x)) < 0.15
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    few = cloud.of((is_seen & is_frame) | (np.abs(z) < 0.1))
    few = replace(few, points=few.points @ turn.T, centres=few.centres @ turn.T, towards=few.towards @ turn.T)
    found = make_buildings(few, SIZES)
    assert {face.wall for face in found.faces if face.wall is not None} == {0, 1}
    hits = RayCaster(found.mesh).cast((turn @ [-4.0, -50.0, 5.0])[None], (turn @ [0.0, 1.0, 0.0])[None])
    assert float(hits.distance_m[0]) == pytest.approx(44.0, abs=0.05)


@pytest.mark.long
def test_ground_is_the_lowest_wide_level(plain):
    cloud = made_cloud()
    strays = np.column_stack([np.random.default_rng(0).uniform(-20.0, 20.0, (10, 2)), np.full(10, -3.0)])
    ground = find_ground(np.concatenate([cloud.points, strays]), 0.35)
    assert ground.is_seen
    assert ground.z_m == pytest.approx(0.0, abs=0.05)
    assert ground.slope_deg < 0.5
    assert plain.ground.z_m == pytest.approx(0.0, abs=0.05)


def inwards(centres):
    level = -centres * [1.0, 1.0, 0.0]
    return level / np.linalg.norm(level, axis=1, keepdims=True)


def test_the_building_is_what_a_ring_of_cameras_looks_at():
    centres = cameras()
    points = np.array([[0.0, 0.0, 5.0], [20.0, -20.0, 0.0], [39.0, 0.0, 3.0], [0.0, 70.0, 9.0]])
    assert in_ring(points, centres, inwards(centres)).tolist() == [True, True, False, False]
    # Half a ring whose cameras all look at its middle is enough.
    half = centres[centres[:, 1] < 0.0]
    assert in_ring(points, half, inwards(half)).tolist() == [True, True, False, False]
    # Before one side only, or beside the middle, or looking out, or past the middle: all may be the building.
    quarter = half[half[:, 0] > 0.0]
    assert in_ring(points, quarter, inwards(quarter)).all()
    east, north, _ = inwards(half).T
    aside = np.radians(25.0) * (-1.0) ** np.arange(len(half))
    by_turns = np.column_stack(
        [np.cos(aside) * east - np.sin(aside) * north, np.sin(aside) * east + np.cos(aside) * north, 0.0 * east]
    )
    assert in_ring(points, half, by_turns).all()
    assert in_ring(points, centres, -inwards(centres)).all()
    assert in_ring(points, centres, inwards(centres)[:, [1, 0, 2]] * [1.0, -1.0, 1.0]).all()


@pytest.mark.long
def test_houses_opposite_are_obstacles_that_leave_the_site_free(plain):
    rng, cloud = np.random.default_rng(0), made_cloud()
    n = 3000
    row, side = rng.uniform(-55.0, 55.0, (2, n // 2))
    north = np.column_stack([row, np.full(n // 2, 55.0), rng.uniform(0.0, 12.0, n // 2)])
    east = np.column_stack([np.full(n // 2, 55.0), side, rng.uniform(0.0, 12.0, n // 2)])
    street = np.concatenate([north, east])
    whole = replace(
        cloud,
        points=np.concatenate([cloud.points, street]),
        starts=np.concatenate([cloud.starts, cloud.starts[-1] + np.arange(1, n + 1)]),
        cameras=np.concatenate([cloud.cameras, np.zeros(n, np.int64)]),
        **{
            name: np.concatenate([getattr(cloud, name), np.resize(getattr(cloud, name), (n, *shape))])
            for name, shape in (("rgb", (3,)), ("sigmas", ()), ("towards", (3,)), ("n_views", ()))
        },
    )
    looked_at = whole.of(in_ring(whole.points, whole.centres, inwards(whole.centres)))
    found = make_buildings(looked_at, SIZES, around=whole)
    assert wall_errors(found).max() < 0.05
    assert len(found.faces) == len(plain.faces)
    low, high = (np.array(corners) for corners in zip(*found.others, strict=True))
    for x, y, _ in street[::100]:
        assert ((low[:, :2] <= [x, y]) & (high[:, :2] >= [x, y])).all(axis=1).any()
    is_near = (low[:, :2] < 45.0).all(axis=1) & (high[:, :2] > -45.0).all(axis=1)
    assert not is_near.any()


@pytest.mark.long
def test_a_building_moves_as_a_whole(plain):
    shift = np.array([3.0, -2.0, 1.5])
    other = moved(plain, shift)
    np.testing.assert_allclose(other.mesh.vertices_enu_m, plain.mesh.vertices_enu_m + shift)
    np.testing.assert_allclose(other.walls[0].line, plain.walls[0].line + shift[:2])


@pytest.mark.long
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


@pytest.mark.long
@pytest.mark.parametrize(
    ("pitch_deg", "walls", "codes"),
    [
        (-90.0, (0, None, None), ["looks-down", "heights-by-lens", "walls-guessed"]),
        (-90.0, (0, 0, None), ["heights-by-lens", "walls-guessed"]),
        (-30.0, (0, None, None), ["walls-guessed"]),
        (-90.0, (0, 0, 0), ["heights-by-lens"]),
        (-30.0, (0, 0, 0), []),
    ],
)
def test_a_flight_that_looks_straight_down_is_told_why_its_walls_are_guessed(plain, pitch_deg, walls, codes):
    faces = tuple(Face(((0.0, 0.0), (5.0, 0.0)), 0.0, 4.0, 0.0 if wall is None else 1.0, wall) for wall in walls)
    buildings = replace(plain, faces=faces, notes=())
    forward = cam_from_enu(0.0, pitch_deg)[2]
    assert [finding.code for finding in about_walls(buildings, np.array([forward] * 3))] == codes
