"""Corrections of poses: a photo that is moved has the rays that light was learned with."""

import numpy as np
import torch

from reconstruction.light.photo_set import PanelPlanes
from reconstruction.light.ray_table import RayTable
from reconstruction.training.photos.exposures import moved
from tests.reconstruction.light.made_folder import cameras, corners_of

MOVE = (0.2, -0.1, 0.05, 0.004, -0.006, 0.003)


def test_a_moved_photo_has_the_rays_of_its_correction(tmp_path):
    photos, planes = cameras(tmp_path, 2), PanelPlanes(corners_of())
    moves = torch.tensor([MOVE, (0.0,) * 6], dtype=torch.float64)
    numbers = torch.tensor([0, 0, 1])
    places, panels = torch.tensor([[3.0, 4.0], [30.0, 20.0], [10.0, 10.0]]).double(), torch.tensor([0, 4, 2])
    corrected = RayTable.of(photos, planes, {}).meet(numbers, places, panels, moves)
    there = RayTable.of(moved(photos, [tuple(row) for row in moves.tolist()]), planes, {}).meet(numbers, places, panels)
    # Rays are turned to first order, photos wholly: a turn of 8 milliradians differs by its square.
    np.testing.assert_allclose(there.directions, corrected.directions, atol=4e-5)
    np.testing.assert_allclose(there.points_m, corrected.points_m, atol=1e-3)
    here = RayTable.of(photos, planes, {}).meet(numbers, places, panels)
    assert (here.directions - there.directions)[:2].norm(dim=1).min() > 4e-3
    np.testing.assert_array_equal(here.points_m[2], there.points_m[2])


def test_without_corrections_photos_are_as_they_are(tmp_path):
    photos = cameras(tmp_path, 2)
    assert moved(photos, ()) == photos
