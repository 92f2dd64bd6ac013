"""Points that reconstruction starts from: spread over the refined mesh, coloured by the photos that see them."""

from __future__ import annotations

import threading

import numpy as np
from numpy.typing import NDArray

from planning.geo.mesh import TriangleMesh
from reconstruction.base.cameras import PosedPhoto
from reconstruction.base.ray_casting import RayCaster

Array = NDArray[np.float64]

IN_FRONT_M = 0.05
"""A point is hidden if the mesh is hit this much before it."""

UNSEEN = 128
"""Grey of points that no photo sees."""


class ColouredPoints:
    """Points, shape (n, 3), ENU, whose colours are the means of what the photos added so far show there.

    Safe to add to from several threads.
    """

    def __init__(self, points_enu_m: Array) -> None:
        self.points_enu_m = points_enu_m
        self._sums = np.zeros((len(points_enu_m), 3))
        self._counts = np.zeros(len(points_enu_m), np.int64)
        self._lock = threading.Lock()

    def add(self, photo: PosedPhoto, image: NDArray[np.uint8], mesh: RayCaster) -> None:
        """Take in a straight photo's picture, shape (h, w, 3), blue, green, red."""
        seen = np.flatnonzero(photo.sees(self.points_enu_m))
        towards = self.points_enu_m[seen] - photo.pose.position_enu_m
        distance = np.linalg.norm(towards, axis=1)
        hits = mesh.cast(
            np.broadcast_to(photo.pose.position_enu_m, towards.shape), towards / np.maximum(distance, 1e-9)[:, None]
        )
        seen = seen[hits.distance_m >= distance - IN_FRONT_M]
        pixels = photo.pixels(self.points_enu_m[seen]).astype(np.int64)
        x = np.minimum(pixels[:, 0], image.shape[1] - 1)
        y = np.minimum(pixels[:, 1], image.shape[0] - 1)
        colours = image[y, x, ::-1].astype(float)
        with self._lock:
            self._sums[seen] += colours
            self._counts[seen] += 1

    @property
    def rgb(self) -> NDArray[np.uint8]:
        """Shape (n, 3)."""
        mean = self._sums / np.maximum(self._counts, 1)[:, None]
        return np.where(self._counts[:, None] > 0, np.round(mean), UNSEEN).astype(np.uint8)


def start_points(mesh: TriangleMesh, n: int, seed: int = 0) -> ColouredPoints:
    """Points spread evenly, by area, over a mesh."""
    if not len(mesh.triangles) or n == 0:
        return ColouredPoints(np.zeros((0, 3)))
    rng = np.random.default_rng(seed)
    a, b, c = np.moveaxis(mesh.corners_enu_m, 1, 0)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    if not areas.sum() > 0.0:
        return ColouredPoints(np.zeros((0, 3)))
    chosen = rng.choice(len(areas), n, p=areas / areas.sum())
    u, v = rng.random((2, n, 1))
    flip = u + v > 1.0
    u, v = np.where(flip, 1.0 - u, u), np.where(flip, 1.0 - v, v)
    return ColouredPoints(a[chosen] + u * (b[chosen] - a[chosen]) + v * (c[chosen] - a[chosen]))
