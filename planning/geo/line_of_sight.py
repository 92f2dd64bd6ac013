"""Lines of sight past triangles, with Embree (through Open3D, in float32 relative to the scene's centre).

`planning.geo.solids.Solids.lines_free` is the slow float64 reference.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks

Array = NDArray[np.float64]

LineOfSight = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.bool_]]
"""(from, to), both shape (k, 3) ENU metres, to shape (k,): True where the straight line between them is free."""


OCCLUSION_OFFSET_M = 0.15
"""Lines of sight end this far in front of the centroid, so that the pane's own frame does not hide it (contract)."""


RAYS_PER_BATCH = 2_000_000
"""Bounds the memory of one batch to 50 MB."""


class _TrianglesBetween:
    """Line of sight past triangles; to another process go the triangles, which builds the scene anew."""

    def __init__(self, corners_enu_m: Array) -> None:
        from open3d.core import Tensor
        from open3d.t.geometry import RaycastingScene

        self._corners_enu_m = corners_enu_m
        self._centre = corners_enu_m.reshape(-1, 3).mean(axis=0)
        self._tensor, self._scene = Tensor, RaycastingScene()
        vertices = (corners_enu_m.reshape(-1, 3) - self._centre).astype(np.float32)
        self._scene.add_triangles(Tensor(vertices), Tensor(np.arange(len(vertices), dtype=np.uint32).reshape(-1, 3)))

    def __reduce__(self) -> tuple[type[_TrianglesBetween], tuple[Array]]:
        return _TrianglesBetween, (self._corners_enu_m,)

    def __call__(self, a_enu_m: Array, b_enu_m: Array) -> NDArray[np.bool_]:
        free = np.empty(len(a_enu_m), np.bool_)
        for start, stop in chunks(len(a_enu_m), RAYS_PER_BATCH):
            a, b = a_enu_m[start:stop] - self._centre, b_enu_m[start:stop] - self._centre
            # From the panel outwards: the short end at the pane is where float32 must be exact.
            rays = np.concatenate([b, a - b], axis=1).astype(np.float32)
            free[start:stop] = ~self._scene.test_occlusions(self._tensor(rays), 0.0, 1.0).numpy()
        return free


def _nothing_between(a_enu_m: Array, _b_enu_m: Array) -> NDArray[np.bool_]:
    return np.ones(len(a_enu_m), np.bool_)


def line_of_sight(corners_enu_m: Array) -> LineOfSight:
    """Fast line-of-sight test against triangles of shape (t, 3, 3)."""
    return _TrianglesBetween(corners_enu_m) if len(corners_enu_m) else _nothing_between
