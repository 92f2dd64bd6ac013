"""Where places of the building are in a picture."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PySide6.QtCore import QPointF

from reconstruction.base.cameras import PosedPhoto

NEAR_M = 0.05
"""In front of the camera: what is nearer has no place in the picture."""


def places_in(camera: PosedPhoto, points_enu_m: Sequence[Sequence[float]]) -> list[QPointF] | None:
    """Pixels, continuous; None where a point is beside or behind the camera, or there is none."""
    if not len(points_enu_m):
        return None
    lens = camera.intrinsics
    inside = camera.pose.points_cam(np.array(points_enu_m, float))
    if (inside[:, 2] < NEAR_M).any():
        return None
    x = lens.cx_px + lens.fx_px * inside[:, 0] / inside[:, 2]
    y = lens.cy_px + lens.fy_px * inside[:, 1] / inside[:, 2]
    return [QPointF(*place) for place in zip(x.tolist(), y.tolist(), strict=True)]
