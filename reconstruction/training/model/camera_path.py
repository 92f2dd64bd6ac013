"""A smooth flight through cameras: many views along the way from one to the next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.spatial.transform import Rotation, Slerp

from planning.base.errors import InputError
from reconstruction.base.cameras import Pose, PosedPhoto

Array = NDArray[np.float64]

SAME_PLACE_M = 1e-3
"""Cameras nearer to each other than this are one stop: turning there takes as long as flying this far."""


def cameras_between(photos: Sequence[PosedPhoto], n_frames: int) -> tuple[PosedPhoto, ...]:
    """Views along a path through the cameras of photos, in their order, at an even speed; the lens is the first one's.

    Positions follow a curve without overshoot (monotone cubic along each axis), so the path stays in the box around the
    cameras it lies between; views turn along the shortest way.

    Parameters
    ----------
    n_frames
        2 or more; the first and the last are the first and last photo's.

    Raises
    ------
    InputError
        There is only one camera.
    """
    if n_frames < 2:
        raise ValueError(f"n_frames: expected 2 or more, got {n_frames}")
    if len(photos) < 2:
        raise InputError("a path needs two views or more to go through; leave --frames out")
    places = np.array([photo.pose.position_enu_m for photo in photos])
    steps = np.maximum(np.linalg.norm(np.diff(places, axis=0), axis=1), SAME_PLACE_M)
    way_m: Array = np.concatenate([[0.0], np.cumsum(steps)])
    asked_m = np.linspace(0.0, way_m[-1], n_frames)
    positions = PchipInterpolator(way_m, places)(asked_m)
    turns = _turns(photos, way_m, asked_m)
    lens = photos[0].intrinsics
    return tuple(
        replace(photos[0], name=name, path=Path(name), intrinsics=lens, pose=Pose(position, turn), taken_at=None)
        for name, position, turn in zip(frame_names(n_frames), positions, turns, strict=True)
    )


def _turns(photos: Sequence[PosedPhoto], way_m: Array, asked_m: Array) -> Array:
    """Rotations cam_from_enu along the way, shape (n, 3, 3)."""
    stops = Rotation.from_matrix(np.stack([photo.pose.cam_from_enu for photo in photos]))
    return np.asarray(Slerp(way_m, stops)(asked_m).as_matrix())


def frame_names(n_frames: int) -> list[str]:
    """Names that sort in their order: `frame-0001` and so on."""
    digits = max(4, len(str(n_frames)))
    return [f"frame-{number:0{digits}d}" for number in range(1, n_frames + 1)]
