"""A wall that has no points, in synthetic photos: found where it stands, and not where photos say nothing."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from planning.base.effects import decide
from planning.geo.mesh import box_mesh
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.coarse.buildings import Buildings, Face
from reconstruction.coarse.cloud import Cloud
from reconstruction.coarse.plane_sweep import DenseDepth, joined, swept
from reconstruction.coarse.walls import Ground

LENS = Intrinsics(640, 480, 520.0, 520.0, 320.0, 240.0)
WALL_Y, WIDTH_M, HEIGHT_M = -6.0, 16.0, 9.0
STEP_M = 0.06


def flown() -> list[PosedPhoto]:
    """Photos from south of the wall, at two heights."""
    places = [np.array([2.5 * k - 8.0, WALL_Y - 14.0, 3.0 + 4.0 * (k % 2)]) for k in range(7)]
    poses = [Pose.looking(place, -8.0 + 3.0 * k, -4.0 * (k % 2)) for k, place in enumerate(places)]
    return [PosedPhoto(f"{k}.jpg", Path(f"{k}.jpg"), LENS, pose) for k, pose in enumerate(poses)]


def seen_by(photo: PosedPhoto, texture: np.ndarray, slope: float = 0.0) -> np.ndarray:
    """What a photo shows of the plane y = WALL_Y + slope x, 5 cm a pixel."""
    columns, rows = np.meshgrid(np.arange(LENS.width_px) + 0.5, np.arange(LENS.height_px) + 0.5)
    origins, rays = photo.rays(np.column_stack([columns.ravel(), rows.ravel()]))
    far = (WALL_Y + slope * origins[:, 0] - origins[:, 1]) / (rays[:, 1] - slope * rays[:, 0])
    met = origins + np.where(far > 0.0, far, 1e3)[:, None] * rays
    at = [(20.0 * met[:, k] + 500.0).astype(np.float32).reshape(LENS.height_px, -1) for k in (0, 2)]
    return cv2.remap(texture, *at, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT_101)


def plaster(seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    fine, coarse = (cv2.GaussianBlur(rng.random((1000, 1000), np.float32), (0, 0), sigma) for sigma in (2.0, 8.0))
    return np.clip(120.0 + 300.0 * (fine - 0.5) + 600.0 * (coarse - 0.5), 0.0, 255.0).astype(np.uint8)


def site_with(guess_y: float, wall: int | None = None) -> tuple[Buildings, Cloud]:
    """A box whose south side is where it was guessed; without any points."""
    mesh = box_mesh(np.array([-WIDTH_M / 2, guess_y, 0.0]), np.array([WIDTH_M / 2, 6.0, HEIGHT_M]))
    ends = ((-WIDTH_M / 2, guess_y), (WIDTH_M / 2, guess_y))
    face = Face(ends, 0.0, HEIGHT_M, 0.0, wall)
    ground = Ground(0.0, 0.0, (0.0, 0.0), 100.0, True)
    centres = np.array([photo.pose.position_enu_m for photo in flown()])
    none = np.zeros(0, np.int64)
    flat, space = np.zeros((0, 3), np.uint8), np.zeros((0, 3))
    cloud = Cloud(space, flat, np.zeros(0), space, none, np.zeros(1, np.int64), none, centres)
    return Buildings(ground, (), (), mesh, (face,), ()), cloud


def look(texture, guess_y, wall=None, slope=0.0):
    buildings, cloud = site_with(guess_y, wall)
    return swept(flown(), lambda photo: seen_by(photo, texture, slope), buildings, cloud, STEP_M)


@pytest.mark.long
@pytest.mark.parametrize("guess_y", [-6.0, -4.6, -8.1])
def test_a_guessed_side_is_found_where_photos_agree(guess_y):
    found = look(plaster(), guess_y)
    assert len(found) > 60
    assert np.abs(found.points[:, 1] - WALL_Y).max() < 0.04
    assert np.ptp(found.points[:, 0]) > 0.6 * WIDTH_M
    assert (found.towards[:, 1] < -0.5).all()
    assert (np.diff(found.starts) == found.n_views).all()
    assert found.n_views.min() >= 2


@pytest.mark.long
def test_a_side_that_is_a_little_askew_stays_so():
    found = look(plaster(), -5.5, slope=0.012)
    line = np.polyfit(found.points[:, 0], found.points[:, 1], 1)
    assert line[0] == pytest.approx(0.012, abs=0.003)


@pytest.mark.long
@pytest.mark.parametrize("noise", [0.0, 4.0])
def test_plain_walls_say_nothing(noise):
    buildings, cloud = site_with(-5.0)
    rng = np.random.default_rng(0)
    plain = np.full((1000, 1000), 120, np.uint8)

    def noisy(photo):
        shown = seen_by(photo, plain)
        return np.clip(shown + rng.normal(0.0, noise, shown.shape), 0.0, 255.0).astype(np.uint8)

    assert len(swept(flown(), noisy, buildings, cloud, STEP_M)) == 0


@pytest.mark.long
def test_bare_concrete_is_enough():
    faint = (118.0 + plaster() / 255.0 * 20.0).astype(np.uint8)
    found = look(faint, -5.0)
    assert len(found) > 60
    assert np.abs(found.points[:, 1] - WALL_Y).max() < 0.08


@pytest.mark.long
def test_photos_that_show_other_things_say_nothing():
    buildings, cloud = site_with(-5.0)
    textures = {photo.name: plaster(number) for number, photo in enumerate(flown())}
    found = swept(flown(), lambda photo: seen_by(photo, textures[photo.name]), buildings, cloud, STEP_M)
    assert len(found) == 0


@pytest.mark.long
def test_a_side_with_points_is_not_led_away_from_them():
    assert len(look(plaster(), WALL_Y + 1.5, wall=0)) == 0
    assert len(look(plaster(), WALL_Y + 0.1, wall=0)) > 60


def test_photos_in_another_order_are_refused():
    buildings, cloud = site_with(-5.0)
    with pytest.raises(ValueError, match="in their order"):
        swept(flown()[::-1], lambda photo: seen_by(photo, plaster()), buildings, cloud, STEP_M)


@pytest.mark.long
def test_points_are_added_to_those_of_the_cloud():
    found = look(plaster(), -5.0)
    both = joined(found, found)
    assert len(both) == 2 * len(found)
    row = len(found)
    np.testing.assert_array_equal(
        both.cameras[both.starts[row] : both.starts[row + 1]], found.cameras[: found.starts[1]]
    )


def test_it_is_decided_by_the_share_of_walls_without_points():
    ground = Ground(0.0, 0.0, (0.0, 0.0), 100.0, True)
    mesh = box_mesh(np.zeros(3), np.ones(3))

    def sides(*shares):
        faces = tuple(Face(((0.0, 0.0), (10.0, 0.0)), 0.0, 5.0, share, 0) for share in shares)
        return Buildings(ground, (), (), mesh, faces, ())

    assert decide(DenseDepth(), sides(0.9, 0.5)).on
    assert decide(DenseDepth(), sides(0.9, 0.5)).size == pytest.approx(30.0)
    assert not decide(DenseDepth(), sides(0.95, 0.95)).on
    assert decide(DenseDepth(), sides(0.95, 0.95), "on").on
    assert not decide(DenseDepth(), sides(0.0, 0.0), "off").on
    nothing = decide(DenseDepth(), sides())
    assert not nothing.on
    assert str(nothing.reason) == "no wall was found"
