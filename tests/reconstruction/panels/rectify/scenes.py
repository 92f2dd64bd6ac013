"""A photo looking at a surface, for the tests of rectification."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planning.geo.frames import aim
from planning.geo.mesh import TriangleMesh
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.panels.rectify.surface import FacadeSurface

Array = NDArray[np.float64]

SMALL = Intrinsics(800, 600, 570.0, 570.0, 400.0, 300.0)
BENT = Intrinsics(800, 600, 570.0, 569.0, 403.0, 297.5, (-0.11, 0.015, 0.0004, -0.0003, -0.02))


def looking_at(
    surface: FacadeSurface,
    distance_m: float = 25.0,
    aside_m: float = 0.0,
    above_m: float = 0.0,
    intrinsics: Intrinsics = SMALL,
    roll_deg: float = 0.0,
) -> PosedPhoto:
    position = surface.anchor_enu_m + distance_m * surface.normal_enu + aside_m * surface.right_enu
    position = position + above_m * surface.up_enu
    heading, pitch = np.degrees(aim(surface.anchor_enu_m - position))
    return PosedPhoto("photo.jpg", Path("photo.jpg"), intrinsics, Pose.looking(position, heading, pitch, roll_deg))


def surface_mesh(
    surface: FacadeSurface, low: Array, high: Array, step_m: float = 0.5, noise_m: float = 0.0, seed: int = 0
) -> TriangleMesh:
    """Mesh of a window of a surface, its vertices moved along the normal by noise."""
    s, t = np.arange(low[0], high[0] + 1e-9, step_m), np.arange(low[1], high[1] + 1e-9, step_m)
    st = np.stack(np.meshgrid(s, t), axis=-1).reshape(-1, 2)
    height = np.random.default_rng(seed).normal(0.0, noise_m, len(st)) if noise_m else np.zeros(len(st))
    vertices = surface.to_enu(st) + height[:, None] * surface.normals_at(st)
    index = np.arange(len(st)).reshape(len(t), len(s))
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]))
    return TriangleMesh(vertices, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int64))
