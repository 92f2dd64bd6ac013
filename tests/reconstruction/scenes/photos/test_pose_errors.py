"""Errors of positions and angles: drawn as stated, told by the photos, and the camera stays where it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.effects.registry import decide_effects
from reconstruction.scenes.parameters import GIMBAL_ERROR, POSITION_ERROR, RenderSettings
from reconstruction.scenes.photos.camera_model import CameraModel, GimbalErrors, Moment, PositionErrors
from reconstruction.scenes.photos.pose_errors import reported_poses
from tests.reconstruction.scenes.small_scenes import photo, scene

N = 400
PHOTOS = [photo((0.1 * k, -10.0, 10.0), 0.0, -5.0) for k in range(N)]
MOMENTS = [Moment(sortie=k % 40) for k in range(N)]
CAMERA_MODEL = CameraModel(
    position=PositionErrors("rtk", 0.02, 0.05, 0.1, 0.3), gimbal=GimbalErrors(0.1, 0.2, 0.3, 1.0, 2.0, 3.0)
)


def errors(camera_model: CameraModel, seed: int = 0, **which: bool) -> np.ndarray:
    """East, north, up in metres and heading, pitch, roll in degrees, shape (N, 6)."""
    told = reported_poses(PHOTOS, MOMENTS, camera_model, seed, **which)
    return np.array(
        [
            [
                *(one.pose.position_enu_m - true.pose.position_enu_m),
                *np.subtract(one.pose.angles_deg, true.pose.angles_deg),
            ]
            for one, true in zip(told, PHOTOS, strict=True)
        ]
    )


def test_errors_have_a_part_of_the_sortie_and_a_part_of_the_photo() -> None:
    drawn = errors(CAMERA_MODEL).reshape(-1, 40, 6)
    biases, deviations = drawn.mean(axis=0), drawn - drawn.mean(axis=0)
    # Forty sorties know a standard deviation to a tenth, four hundred photos to a thirtieth: four times that.
    assert biases.std(axis=0) == pytest.approx([0.1, 0.1, 0.3, 1.0, 2.0, 3.0], rel=0.45)
    assert deviations.std(axis=(0, 1)) * np.sqrt(10 / 9) == pytest.approx([0.02, 0.02, 0.05, 0.1, 0.2, 0.3], rel=0.15)
    assert np.abs(np.corrcoef(deviations.reshape(-1, 6).T) - np.eye(6)).max() < 0.25


@pytest.mark.slow
def test_leaving_one_kind_out_does_not_change_the_other() -> None:
    both = errors(CAMERA_MODEL)
    assert errors(CAMERA_MODEL, angles=False) == pytest.approx(both * [1, 1, 1, 0, 0, 0], abs=1e-9)
    assert errors(CAMERA_MODEL, positions=False) == pytest.approx(both * [0, 0, 0, 1, 1, 1], abs=1e-9)
    assert errors(CAMERA_MODEL, positions=False, angles=False) == pytest.approx(np.zeros((N, 6)), abs=1e-12)
    assert np.abs(errors(CAMERA_MODEL, seed=1) - both).min() > 0.0
    assert (errors(CAMERA_MODEL) == both).all()


def test_heights_above_take_off_share_the_sorties_error() -> None:
    deviation_m = replace(CAMERA_MODEL, position=replace(CAMERA_MODEL.position, vertical_m=0.0))
    told = reported_poses(PHOTOS, MOMENTS, deviation_m, 0)
    for one, true in zip(told, PHOTOS, strict=True):
        assert one.pose.position_enu_m[2] - one.higher_m == pytest.approx(true.pose.position_enu_m[2])
    assert {one.higher_m for one in reported_poses(PHOTOS, MOMENTS, CAMERA_MODEL, 0, positions=False)} == {0.0}


def test_a_camera_that_looks_straight_down_gets_its_errors_too() -> None:
    down = [photo((0.0, 0.0, 30.0), 0.0, -90.0)]
    (told,) = reported_poses(down, [Moment()], CAMERA_MODEL, 0)
    assert np.isfinite(told.pose.cam_from_enu).all()
    assert not np.allclose(told.pose.cam_from_enu, down[0].pose.cam_from_enu)


def moved_px(camera: PosedPhoto, camera_model: CameraModel, *, positions: bool) -> float:
    """How far the pane's corners are from where the told pose has them, on the whole."""
    made = scene()
    (told,) = reported_poses([camera], [Moment()], camera_model, made.seed, positions=positions, angles=not positions)
    corners = made.panes.corners_enu_m.reshape(-1, 3)
    return float(np.linalg.norm(replace(camera, pose=told.pose).pixels(corners) - camera.pixels(corners), axis=1).max())


@pytest.mark.parametrize(
    ("effect", "camera_model", "used"),
    [
        (POSITION_ERROR, CameraModel(position=PositionErrors("rtk", 0.001, 0.001, 0.001, 0.001)), False),
        (POSITION_ERROR, CameraModel(position=PositionErrors("rtk", 0.1, 0.1, 0.0, 0.0)), True),
        (POSITION_ERROR, CameraModel(position=PositionErrors("single")), True),
        (GIMBAL_ERROR, CameraModel(gimbal=GimbalErrors(*[0.01] * 6)), False),
        (GIMBAL_ERROR, CameraModel(gimbal=GimbalErrors(*[0.5] * 6)), True),
    ],
)
def test_the_scene_decides_by_how_far_the_facade_is_from_where_the_photo_tells(
    effect: str, camera_model: CameraModel, used: bool
) -> None:
    camera = photo()
    decided = decide_effects(scene(), [camera], RenderSettings(), camera_model)[effect]
    moved = moved_px(camera, camera_model, positions=effect == POSITION_ERROR)
    assert decided.on == used == (moved > decided.tolerance)
    assert decided.size == pytest.approx(moved, rel=0.35)


def test_errors_may_be_as_wrong_as_they_like() -> None:
    wild = CameraModel(position=PositionErrors("rtk", *[100.0] * 4), gimbal=GimbalErrors(*[45.0] * 6))
    for effect in (POSITION_ERROR, GIMBAL_ERROR):
        decided = decide_effects(scene(), PHOTOS[:3], RenderSettings(), wild)[effect]
        assert decided.on
        assert np.isfinite(decided.size)
    with pytest.raises(ValueError, match="horizontal_m: expected 0 to 100"):
        PositionErrors(horizontal_m=101.0)
