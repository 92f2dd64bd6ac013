"""The ground by photos of it: walked past a wall whose points end above the ground, in changing exposures."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.coarse.ground_level import level_of_ground

LENS = Intrinsics(320, 240, 260.0, 260.0, 160.0, 120.0)
GROUND_Z, FOOT_Z, EYES_Z, WALL_Y = -0.9, 0.2, 1.0, 20.0
"""Points begin at the wall's foot: cameras seem 0.8 m above the ground, and are 1.9 m."""


def walked(n: int = 8) -> list[PosedPhoto]:
    """Photos of a wall, from along it."""
    places = [np.array([2.5 * k, 0.4 * (k % 2), EYES_Z + 0.05 * (k % 3)]) for k in range(n)]
    poses = [Pose.looking(place, 8.0 * (k % 3 - 1), -6.0) for k, place in enumerate(places)]
    return [PosedPhoto(f"{k}.jpg", Path(f"{k}.jpg"), LENS, pose) for k, pose in enumerate(poses)]


def speckled(rng: np.random.Generator) -> np.ndarray:
    """Gravel and grass, 0 to 1, 5 cm a pixel."""
    fine, coarse = (cv2.GaussianBlur(rng.random((2000, 2000), np.float32), (0, 0), sigma) for sigma in (2.0, 12.0))
    return 0.5 + 4.0 * (fine - 0.5) + 8.0 * (coarse - 0.5)


def taken(photos: list[PosedPhoto], slope: float = 0.0, seed: int = 0) -> dict[str, np.ndarray]:
    """What they show of ground and wall, each exposed for itself; ground that falls away from the wall."""
    rng = np.random.default_rng(seed)
    ground, wall = speckled(rng), speckled(rng)
    columns, rows = np.meshgrid(np.arange(LENS.width_px) + 0.5, np.arange(LENS.height_px) + 0.5)
    pixels = np.column_stack([columns.ravel(), rows.ravel()])
    found = {}
    for photo in photos:
        origins, rays = photo.rays(pixels)
        with np.errstate(divide="ignore"):
            down = (GROUND_Z + slope * (origins[:, 1] - WALL_Y) - origins[:, 2]) / (rays[:, 2] - slope * rays[:, 1])
            ahead = (WALL_Y - origins[:, 1]) / rays[:, 1]
        down, ahead = (np.where(way > 0.0, way, np.inf) for way in (down, ahead))
        is_ground = down < ahead
        met = origins + np.where(is_ground, down, np.where(np.isfinite(ahead), ahead, 1e3))[:, None] * rays
        shown = [_looked_up(ground, met[:, 0], met[:, 1]), _looked_up(wall, met[:, 0], met[:, 2])]
        picture = 120.0 * np.exp(rng.normal(0.0, 0.2)) * np.where(is_ground, *shown)
        picture = picture.reshape(LENS.height_px, LENS.width_px)
        found[photo.name] = np.clip(picture, 0.0, 255.0).astype(np.uint8)
    return found


def _looked_up(texture: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    at = [(20.0 * values + 1000.0).astype(np.float32).reshape(LENS.height_px, -1) for values in (x, y)]
    return cv2.remap(texture, *at, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT_101).ravel()


def wall_points() -> np.ndarray:
    x, z = np.meshgrid(np.linspace(-15.0, 35.0, 120), np.linspace(FOOT_Z, 10.0, 40))
    return np.column_stack([x.ravel(), np.full(x.size, WALL_Y), z.ravel()])


@pytest.mark.long
@pytest.mark.parametrize("scale", [1.0, 0.03])
def test_the_ground_is_where_photos_agree_and_not_where_points_end(scale):
    photos = walked()
    pictures = taken(photos)
    small = [replace(photo, pose=Pose(scale * photo.pose.position_enu_m, photo.pose.cam_from_enu)) for photo in photos]
    points = scale * wall_points()
    found = level_of_ground(small, lambda photo: pictures[photo.name], points, scale * FOOT_Z)
    assert found == pytest.approx(scale * GROUND_Z, abs=scale * 0.02 * (EYES_Z - GROUND_Z))


@pytest.mark.long
def test_of_gentle_slopes_a_height_between_foot_and_cameras_is_told():
    photos = walked()
    sloping = taken(photos, slope=0.02)
    found = level_of_ground(photos, lambda photo: sloping[photo.name], wall_points(), FOOT_Z)
    assert GROUND_Z - 0.02 * WALL_Y < found < GROUND_Z


@pytest.mark.long
def test_ground_that_is_steep_or_shows_nothing_is_left_to_the_points():
    photos = walked()
    steep = taken(photos, slope=0.12)
    assert level_of_ground(photos, lambda photo: steep[photo.name], wall_points(), FOOT_Z) is None
    rng = np.random.default_rng(1)
    noise = {photo.name: rng.integers(0, 255, (240, 320)).astype(np.uint8) for photo in photos}
    assert level_of_ground(photos, lambda photo: noise[photo.name], wall_points(), FOOT_Z) is None


@pytest.mark.long
def test_cameras_below_the_lowest_points_tell_no_ground():
    photos = walked()
    pictures = taken(photos)
    assert level_of_ground(photos, lambda photo: pictures[photo.name], wall_points(), EYES_Z + 1.0) is None
