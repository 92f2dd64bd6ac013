"""Corrections of photos' poses that were found out while light was learned alone, put into the photos."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import torch
from scipy.spatial.transform import Rotation

from reconstruction.base.cameras import Pose, PosedPhoto
from reconstruction.light.glass_light import GlassLight

Move = tuple[float, float, float, float, float, float]
"""Metres along ENU, and a rotation vector, radians, ENU."""


@torch.no_grad()
def learned_moves(light: GlassLight | None, n_photos: int) -> tuple[Move, ...]:
    """Of each photo learned from, as the rays were moved by them; none where poses were not learned.

    What all photos have in common is taken away: surroundings move and turn with it.
    """
    if light is None or light.moves is None or len(light.moves) != n_photos:
        return ()
    moves = (light.moves - light.moves.mean(dim=0)).double().cpu()
    return tuple(tuple(row) for row in moves.tolist())


def moved(photos: Sequence[PosedPhoto], moves: Sequence[Move]) -> tuple[PosedPhoto, ...]:
    """Photos where their corrections put them; as they are where there are none."""
    if not moves:
        return tuple(photos)
    return tuple(_moved(photo, move) for photo, move in zip(photos, moves, strict=True))


def _moved(photo: PosedPhoto, move: Move) -> PosedPhoto:
    turn = Rotation.from_rotvec(move[3:]).as_matrix()
    pose = Pose(photo.pose.position_enu_m + np.array(move[:3]), photo.pose.cam_from_enu @ turn.T)
    return replace(photo, pose=pose)
