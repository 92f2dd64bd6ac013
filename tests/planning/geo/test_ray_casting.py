"""Rays onto meshes: against the ray's own geometry, far from the origin, and with nothing to hit."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from planning.geo.mesh import box_mesh, empty_mesh
from planning.geo.ray_casting import RayCaster


def test_rays_hit_a_box_where_they_should_and_normals_face_them() -> None:
    caster = RayCaster(box_mesh(np.array([0.0, 0.0, 0.0]), np.array([4.0, 6.0, 8.0])))
    hits = caster.cast(
        np.array([[2.0, -10.0, 3.0], [2.0, 3.0, 3.0], [9.0, 9.0, 9.0]]),
        np.array([[0, 2.0, 0], [0, 0, 1.0], [0, 0, 1.0]]),
    )
    assert np.allclose(hits.distance_m, [5.0, 5.0, np.inf])
    assert np.allclose(hits.normals_enu[:2], [[0, -1, 0], [0, 0, -1]])
    assert np.isnan(hits.normals_enu[2]).all()
    assert hits.is_hit.tolist() == [True, True, False]


def test_a_site_far_from_its_origin_loses_nothing() -> None:
    shift = np.array([4.5e5, 5.1e6, 300.0])
    rng = np.random.default_rng(0)
    origins = rng.uniform(-20.0, -5.0, (200, 3)) * (1.0, 1.0, 0.0) + (0.0, 0.0, 4.0)
    directions = np.array([2.0, 3.0, 4.0]) - origins
    box = np.array([[0.0, 0.0, 0.0], [4.0, 6.0, 8.0]])
    near = RayCaster(box_mesh(*box)).cast(origins, directions)
    far = RayCaster(box_mesh(*(box + shift))).cast(origins + shift, directions)
    assert near.is_hit.all()
    assert np.abs(near.distance_m - far.distance_m).max() < 1e-6


def test_nothing_to_hit_and_nothing_to_cast() -> None:
    hits = RayCaster(empty_mesh()).cast(np.zeros((2, 3)), np.ones((2, 3)))
    assert not hits.is_hit.any()
    assert np.isinf(hits.distance_m).all()
    box = RayCaster(box_mesh(np.zeros(3), np.ones(3)))
    assert len(box.cast(np.zeros((0, 3)), np.zeros((0, 3))).distance_m) == 0


@pytest.mark.slow
def test_what_open3d_draws_with_is_not_loaded() -> None:
    script = (
        "import sys; from planning.geo.ray_casting import ray_types; ray_types()[1]();"
        "print(sorted({'open3d', 'dash', 'plotly', 'IPython'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "['open3d']"
