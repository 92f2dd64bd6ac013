"""Cameras that splats are rendered from, against those of photos."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from planning.base.errors import InputError
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.splats.rasterising.projection import project
from reconstruction.splats.rasterising.views import View

LENS = Intrinsics(40, 30, 36.0, 37.0, 18.0, 16.0)
PHOTO = PosedPhoto("a.jpg", Path("a.jpg"), LENS, Pose.looking(np.array([3.0, -20.0, 12.0]), 15.0, -20.0, 4.0))
ORIGIN = np.array([2.0, -1.0, 8.0])


def test_a_view_sees_what_its_photo_sees() -> None:
    view = View.of(PHOTO, ORIGIN)
    points = np.array([[4.0, 3.0, 6.0], [0.0, 5.0, 9.0]])
    means = torch.from_numpy(points - ORIGIN)
    ones = torch.ones(2, 2, dtype=torch.float64)
    found = project(means, torch.eye(4, dtype=torch.float64)[:1].expand(2, 4), ones, view)
    np.testing.assert_allclose(found.centres_px.numpy(), PHOTO.pixels(points), atol=1e-9)
    np.testing.assert_allclose(view.position_m.numpy(), PHOTO.pose.position_enu_m - ORIGIN, atol=1e-5)


def test_directions_are_the_photo_s_rays() -> None:
    directions = View.of(PHOTO, ORIGIN).directions(torch.float64)
    rows, columns = np.mgrid[:30, :40]
    _, rays = PHOTO.rays(np.column_stack([columns.ravel(), rows.ravel()]) + 0.5)
    assert directions.shape == (30, 40, 3)
    np.testing.assert_allclose(directions.reshape(-1, 3).numpy(), rays, atol=1e-12)
    assert View.of(PHOTO, ORIGIN).directions().dtype == torch.float32


def test_a_window_has_the_directions_of_its_part_of_the_picture() -> None:
    view = View.of(PHOTO, ORIGIN)
    window = view.cropped(7, 3, 12, 20)
    torch.testing.assert_close(window.directions(torch.float64), view.directions(torch.float64)[3:23, 7:19])


def test_a_window_of_a_window_knows_the_whole_picture() -> None:
    view = View.of(PHOTO, ORIGIN)
    assert view.of_picture_px == (0, 40, 0, 30)
    assert view.cropped(7, 3, 12, 20).of_picture_px == (-7, 33, -3, 27)
    assert view.cropped(7, 3, 12, 20).cropped(-2, 1, 5, 5).of_picture_px == (-5, 35, -4, 26)


def test_distorted_photos_are_refused_with_what_to_do() -> None:
    bent = replace(PHOTO, intrinsics=replace(LENS, distortion=(0.1, 0.0, 0.0, 0.0, 0.0)))
    with pytest.raises(InputError, match=r"a\.jpg: the picture is distorted.*prepare"):
        View.of(bent, ORIGIN)


def test_a_motion_in_single_precision_is_refused() -> None:
    with pytest.raises(ValueError, match="cam_from_world: expected shape"):
        View(4, 4, 1.0, 1.0, 2.0, 2.0, torch.eye(4))
