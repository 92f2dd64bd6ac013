"""Compiled part of the sharpness measure: edge pixels of two smoothed pictures, and how blurred each is."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import inline, kernel

MARGIN = 4
"""Pixels at the borders that are left out, where smoothing knows no neighbours."""

CLIPPED = 3
"""Pixels around a clipped one where a slope says nothing."""

DARK, BRIGHT = 2, 253
"""Grey levels up to and from which a pixel is clipped."""

TANGENT = math.tan(math.pi / 8.0)

NO_STEP = 1e-3
"""Part by which the slope of a step must shrink at least; where it does not, the edge is as soft as can be told."""


@inline
def _slope2(smooth: Any, y: int, x: int) -> Any:
    """Square of the slope."""
    dx, dy = 0.5 * (smooth[y, x + 1] - smooth[y, x - 1]), 0.5 * (smooth[y + 1, x] - smooth[y - 1, x])
    return dx * dx + dy * dy


@kernel
def edge_blurs(
    grey: NDArray[np.uint8],
    narrow: NDArray[np.float32],
    wide: NDArray[np.float32],
    variances: tuple[float, float, float],
    least_slope: float,
    sigma: NDArray[np.float32],
    angle: NDArray[np.float32],
) -> int:
    """Fill `sigma` (px) and `angle` (rad) with the blur and the direction of the slope of edge pixels; their number.

    Parameters
    ----------
    grey, narrow, wide
        The picture, shape (h, w), and the same after the two Gaussians.
    variances
        Of both Gaussians, and of the central difference.
    """
    height, width = grey.shape
    n = 0
    for y in range(MARGIN, height - MARGIN):
        for x in range(MARGIN, width - MARGIN):
            dx, dy = 0.5 * (narrow[y, x + 1] - narrow[y, x - 1]), 0.5 * (narrow[y + 1, x] - narrow[y - 1, x])
            slope2 = dx * dx + dy * dy
            if slope2 < least_slope * least_slope:
                continue
            # The crest of the slope along its own direction, to the nearest of four.
            if abs(dy) <= TANGENT * abs(dx):
                step_x, step_y = 1, 0
            elif abs(dx) <= TANGENT * abs(dy):
                step_x, step_y = 0, 1
            elif dx * dy > 0.0:
                step_x, step_y = 1, 1
            else:
                step_x, step_y = 1, -1
            if slope2 <= _slope2(narrow, y - step_y, x - step_x) or slope2 < _slope2(narrow, y + step_y, x + step_x):
                continue
            is_clipped = False
            for v in range(y - CLIPPED, y + CLIPPED + 1):
                for u in range(x - CLIPPED, x + CLIPPED + 1):
                    is_clipped |= grey[v, u] <= DARK or grey[v, u] >= BRIGHT
            if is_clipped:
                continue
            ratio2 = max(slope2 / max(_slope2(wide, y, x), 1e-12), 1.0 + NO_STEP)
            found2 = (variances[1] - ratio2 * variances[0]) / (ratio2 - 1.0) - variances[2]
            sigma[n], angle[n] = math.sqrt(max(found2, 0.0)), math.atan2(dy, dx)
            n += 1
    return n
