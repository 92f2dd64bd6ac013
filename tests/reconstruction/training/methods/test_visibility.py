"""Where mirrored rays meet the scene."""

import numpy as np

from planning.geo.mesh import TriangleMesh
from planning.geo.ray_casting import RayCaster
from reconstruction.training.methods.ref_gaussian import meets_scene, points_on_mesh


def square(corners):
    return np.asarray(corners, float), np.array([[0, 1, 2], [0, 2, 3]])


def facade_and_wall():
    """A facade in the plane y = 0, and a wall 5 m before it, west of x = 0, 10 m high."""
    facade = square([[-20, 0, 0], [20, 0, 0], [20, 0, 20], [-20, 0, 20]])
    wall = square([[-20, -5, 0], [0, -5, 0], [0, -5, 10], [-20, -5, 10]])
    return TriangleMesh(np.concatenate([facade[0], wall[0]]), np.concatenate([facade[1], wall[1] + 4]))


def test_rays_into_the_wall_are_met_and_rays_past_it_are_not():
    points = np.array([[-5.0, 0.0, 5.0], [5.0, 0.0, 5.0], [-5.0, 0.0, 15.0], [-1.0, 0.0, 5.0]])
    omega_o = np.array([[0.0, 1.0, 0.0]] * 3 + [[0.8, 0.6, 0.0]])
    normals = np.array([[0.0, -1.0, 0.0]] * 4)
    expected = [True, False, False, False]
    caster = RayCaster(facade_and_wall())
    assert meets_scene(caster, points, normals, omega_o).tolist() == expected
    assert meets_scene(caster, points, -normals, omega_o).tolist() == expected


def test_a_surface_does_not_meet_itself():
    generator = np.random.default_rng(0)
    points = np.column_stack([generator.uniform(1.0, 19.0, 500), np.zeros(500), generator.uniform(11.0, 19.0, 500)])
    omega_o = generator.normal(size=(500, 3))
    omega_o[:, 1] = np.abs(omega_o[:, 1]) + 0.02
    omega_o /= np.linalg.norm(omega_o, axis=1, keepdims=True)
    omega_o[:, 0] = np.abs(omega_o[:, 0])
    found = meets_scene(RayCaster(facade_and_wall()), points, np.tile([0.0, -1.0, 0.0], (500, 1)), omega_o)
    assert not found.any()


def test_no_points_meet_nothing():
    empty = np.zeros((0, 3))
    assert meets_scene(RayCaster(facade_and_wall()), empty, empty, empty).shape == (0,)


def test_points_on_the_mesh_are_right_where_blended_depths_are_not():
    caster, camera = RayCaster(facade_and_wall()), np.array([8.0, -12.0, 6.0])
    generator = np.random.default_rng(1)
    truth = np.column_stack([generator.uniform(1.0, 19.0, 50), np.zeros(50), generator.uniform(1.0, 19.0, 50)])
    omega_o = (truth - camera) / np.linalg.norm(truth - camera, axis=1, keepdims=True)
    blended = truth + 0.8 * omega_o
    found = points_on_mesh(caster, camera, omega_o, blended)
    assert np.abs(found - truth).max() < 1e-4
    normals = np.tile([0.0, -1.0, 0.0], (50, 1))
    assert meets_scene(caster, blended, normals, omega_o).all()
    assert not meets_scene(caster, found, normals, omega_o).all()
    away = points_on_mesh(caster, camera, -omega_o, blended)
    assert np.array_equal(away, blended)
