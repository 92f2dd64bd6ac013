"""What photos tell wrong of their cameras' positions and angles: the camera is where it is, its metadata are not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reconstruction.base.cameras import Pose, PosedPhoto
from reconstruction.scenes.photos.camera_model import CameraModel, Moment

Array = NDArray[np.float64]

OF_SORTIE, OF_PHOTO = 1, 2
"""Streams of random numbers, apart from those that make a scene and its noise."""


@dataclass(frozen=True, slots=True, eq=False)
class ReportedPose:
    """What metadata say of a camera.

    Parameters
    ----------
    higher_m
        How much too high they tell the place of take-off as well, so that heights above it are less wrong.
    """

    pose: Pose
    higher_m: float = 0.0


def reported_poses(
    photos: Sequence[PosedPhoto],
    moments: Sequence[Moment],
    camera_model: CameraModel,
    seed: int,
    *,
    positions: bool = True,
    angles: bool = True,
) -> tuple[ReportedPose, ...]:
    """What photos tell of their poses, with errors of positions and of angles, or without.

    Errors are normal, a part of each sortie and a part of each photo. Leaving one kind out, or other photos, does not
    change what is drawn for the rest.
    """
    reported = []
    for number, (photo, moment) in enumerate(zip(photos, moments, strict=True)):
        of_sortie, of_photo = _drawn(seed, OF_SORTIE, moment.sortie), _drawn(seed, OF_PHOTO, number)
        pose, higher_m = photo.pose, 0.0
        if positions:
            bias_m, deviation_m = (
                np.array([h, h, v]) for h, v in (camera_model.position.bias_m, camera_model.position.deviation_m)
            )
            shift = bias_m * of_sortie[:3] + deviation_m * of_photo[:3]
            pose = Pose(pose.position_enu_m + shift, pose.cam_from_enu)
            higher_m = float(bias_m[2] * of_sortie[2])
        if angles:
            bias_deg, deviation_deg = (
                np.array(camera_model.gimbal.bias_deg),
                np.array(camera_model.gimbal.deviation_deg),
            )
            turn = bias_deg * of_sortie[3:] + deviation_deg * of_photo[3:]
            heading, pitch, roll = (np.array(pose.angles_deg) + turn).tolist()
            pose = Pose.looking(pose.position_enu_m, heading, pitch, roll)
        reported.append(ReportedPose(pose, higher_m))
    return tuple(reported)


def _drawn(seed: int, stream: int, number: int) -> Array:
    """Six standard normal numbers: east, north, up, heading, pitch, roll."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(stream, number))).standard_normal(6)
