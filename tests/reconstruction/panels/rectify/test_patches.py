"""Facades found in the coarse model behind a photo: one, two at a corner, a round tower, and none."""

from __future__ import annotations

import numpy as np
import pytest

from planning.geo.mesh import TriangleMesh, box_mesh, empty_mesh, join
from reconstruction.panels.rectify.fit import facades_in_photo
from reconstruction.panels.rectify.surface import FacadeSurface
from tests.reconstruction.panels.rectify.scenes import looking_at, surface_mesh
from tests.reconstruction.panels.rectify.test_surface import surface
from tests.slow import slow

UP = np.array([0.0, 0.0, 1.0])


def wall(heading_deg: float, anchor: tuple[float, float, float], curvature: float = 0.0) -> FacadeSurface:
    """Facing a heading, clockwise from north."""
    angle = np.radians(heading_deg)
    right = np.array([-np.cos(angle), np.sin(angle), 0.0])
    return FacadeSurface(np.array(anchor), right, UP, curvature)


def ground() -> TriangleMesh:
    return box_mesh(np.array([-200.0, -200.0, -1.0]), np.array([200.0, 200.0, 0.0]))


@pytest.mark.slow
@pytest.mark.parametrize("curvature", [0.0, slow(0.02), 0.06, slow(-0.03)])
def test_one_dented_facade_above_the_ground_is_found(curvature: float) -> None:
    truth = wall(180.0, (0.0, 0.0, 12.0), curvature)
    model = join([surface_mesh(truth, (-14.0, -12.0), (14.0, 10.0), noise_m=0.08), ground()])
    found = facades_in_photo(looking_at(truth, 22.0), model)
    assert len(found) == 1
    grid = np.stack(np.meshgrid(np.linspace(-10, 10, 9), np.linspace(-8, 8, 9)), axis=-1).reshape(-1, 2)
    assert np.abs(found[0].cylinder.surface.height_m(truth.to_enu(grid))).max() < 0.1
    assert found[0].cylinder.surface.normal_enu @ truth.normal_enu > 0.9


@pytest.mark.slow
def test_two_facades_of_a_corner_are_two() -> None:
    model = join([box_mesh(np.array([0.0, 0.0, 0.0]), np.array([20.0, 24.0, 18.0])), ground()])
    corner = FacadeSurface(np.array([0.0, 0.0, 9.0]), np.array([np.sqrt(0.5), -np.sqrt(0.5), 0.0]), UP)
    found = facades_in_photo(looking_at(corner, 30.0), model)
    normals = sorted(tuple(np.round(patch.plane.surface.normal_enu, 2) + 0.0) for patch in found)
    assert normals == [(-1.0, 0.0, 0.0), (0.0, -1.0, 0.0)]
    for patch in found:
        assert patch.cylinder.curvature_significance < 5.0 or abs(patch.cylinder.surface.curvature_per_m) < 1e-4


@pytest.mark.slow
def test_a_facade_and_a_round_tower_behind_it_are_told_apart() -> None:
    front = wall(180.0, (-12.0, 0.0, 10.0))
    tower = wall(180.0, (14.0, 12.0, 12.0), 0.1)
    model = join(
        [surface_mesh(front, (-10.0, -10.0), (10.0, 10.0)), surface_mesh(tower, (-12.0, -12.0), (12.0, 12.0)), ground()]
    )
    found = facades_in_photo(looking_at(wall(180.0, (0.0, 4.0, 10.0)), 30.0), model)
    assert len(found) == 2
    curvatures = sorted(abs(patch.cylinder.surface.curvature_per_m) for patch in found)
    assert curvatures[0] < 0.005
    assert curvatures[1] == pytest.approx(0.1, rel=0.05)


def test_nothing_is_found_where_nothing_stands() -> None:
    photo = looking_at(surface(0.0))
    assert facades_in_photo(photo, empty_mesh()) == ()
    assert facades_in_photo(photo, ground()) == ()


@pytest.mark.slow
def test_the_same_seed_finds_the_same_facades() -> None:
    truth = wall(180.0, (0.0, 0.0, 12.0))
    model = surface_mesh(truth, (-14.0, -12.0), (14.0, 10.0), noise_m=0.08)
    photo = looking_at(truth, 22.0)
    once, again = facades_in_photo(photo, model)[0], facades_in_photo(photo, model)[0]
    assert np.array_equal(once.plane.surface.anchor_enu_m, again.plane.surface.anchor_enu_m)
    assert np.array_equal(once.outline_px, again.outline_px)
