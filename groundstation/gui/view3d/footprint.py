"""What a picture covers: where the border of a photo falls on the surfaces of a site."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from groundstation.gui.view3d.layers import Layer
from groundstation.gui.view3d.picking import PickIndex
from groundstation.gui.view3d.pinhole import Pinhole

Array = NDArray[np.float64]

RAYS_PER_SIDE = 12
"""Enough to follow corners of a building; 48 rays take about 2 ms."""

LIFT_M = 0.06
"""The line is drawn this far in front of the surfaces."""

MAX_STEP = 0.2
"""Neighbouring rays whose depths differ by a larger part meet different surfaces: no line is drawn between them."""

SEEN_THROUGH = frozenset({Layer.NO_FLY, Layer.HOME})


def footprint(index: PickIndex, view: Pinhole) -> list[Array]:
    """Pieces of the border of a picture on the surfaces it meets, polylines of shape (k, 3), k >= 2."""
    along = np.arange(RAYS_PER_SIDE) / RAYS_PER_SIDE
    zeros = np.zeros(RAYS_PER_SIDE)
    x = np.concatenate([along, zeros + 1.0, 1.0 - along, zeros, [0.0]]) * view.width_px
    y = np.concatenate([zeros, along, zeros + 1.0, 1.0 - along, [0.0]]) * view.height_px
    pieces: list[list[Array]] = [[]]
    last_m = np.inf
    for x_px, y_px in zip(x, y, strict=True):
        ray = view.ray(float(x_px), float(y_px))
        point, depth_m = _first(index, view.eye_enu_m, ray)
        if point is None or abs(depth_m - last_m) > MAX_STEP * depth_m:
            pieces.append([])
        if point is not None:
            pieces[-1].append(point)
        last_m = depth_m
    return [np.array(piece) for piece in pieces if len(piece) > 1]


def _first(index: PickIndex, eye_enu_m: Array, ray: Array) -> tuple[Array | None, float]:
    """Where a ray ends: on a surface, else on the ground."""
    hit = index.surface(eye_enu_m, ray, SEEN_THROUGH)
    if hit is not None:
        return hit.point_enu_m + LIFT_M * hit.normal, hit.depth_m
    ground = index.ground(eye_enu_m, ray)
    if ground is None:
        return None, np.inf
    return ground, float(np.linalg.norm(ground - eye_enu_m))
