"""Which rays a pixel of a moving camera needs: more places of the camera, the further the picture moves meanwhile.

Rays are sent from where the camera is during the exposure, so that mirror images move as they do in glass: less than
the glass itself.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from reconstruction.base.cameras import PosedPhoto

Array = NDArray[np.float64]
Picture = NDArray[np.float32]

PX_PER_TIME = 2.0
"""Way in the picture for each place of the camera. With the nine parts of a pixel in turn, an edge gets 4.5 steps a
pixel; in pictures that are held still it gets 3."""

MOST_TIMES = 32
"""For each part of a pixel. With nine parts an edge is spread over 288 steps: less than a grey level each."""

NEAREST_M = 1e-3
"""What is nearer to the camera moves no further."""


def moved_px(photo: PosedPhoto, moved_enu_m: Array, depth_m: Picture) -> tuple[Picture, Picture]:
    """How far what each pixel shows moves in the picture, to the right and down, each shape (h, w).

    Parameters
    ----------
    moved_enu_m
        Way of the camera, shape (3,). To first order, and as if the lens were straight.
    depth_m
        Shape (h, w), along the optical axis.
    """
    lens = photo.intrinsics
    right, down, ahead = (float(part) for part in photo.pose.cam_from_enu @ moved_enu_m)
    x = np.arange(lens.width_px, dtype=np.float32) + np.float32(0.5 - lens.cx_px)
    y = np.arange(lens.height_px, dtype=np.float32)[:, None] + np.float32(0.5 - lens.cy_px)
    near = 1.0 / np.maximum(depth_m, np.float32(NEAREST_M))
    return (
        np.asarray((x * ahead - lens.fx_px * right) * near, np.float32),
        np.asarray((y * ahead - lens.fy_px * down) * near, np.float32),
    )


def windows(right_px: Picture, down_px: Picture) -> tuple[int, int]:
    """Half sizes, across and along the columns, of a window that holds all that a pixel shows meanwhile."""
    height, width = right_px.shape
    across = math.ceil(0.5 * float(np.abs(right_px).max())) + 1
    along = math.ceil(0.5 * float(np.abs(down_px).max())) + 1
    return min(across, width), min(along, height)


def varies(linear: Picture, panel: NDArray[np.uint16], window: tuple[int, int], detail: float) -> NDArray[np.bool_]:
    """Pixels that differ from others in the window by more than `detail` in the light's square root, or in the panel.

    Shape (h, w).
    """
    eye = np.sqrt(np.maximum(linear, 0.0))
    differs = (_most(eye, window) - _least(eye, window) > detail).any(axis=2)
    return np.asarray(differs | (_most(panel, window) != _least(panel, window)))


def _most(values: NDArray[Any], window: tuple[int, int]) -> NDArray[Any]:
    """The largest value in each window; takes as long for wide ones as for narrow ones."""
    across, along = window
    return np.asarray(maximum_filter1d(maximum_filter1d(values, 2 * across + 1, 1), 2 * along + 1, 0))


def _least(values: NDArray[Any], window: tuple[int, int]) -> NDArray[Any]:
    across, along = window
    return np.asarray(minimum_filter1d(minimum_filter1d(values, 2 * across + 1, 1), 2 * along + 1, 0))


def n_times(right_px: Picture, down_px: Picture, window: tuple[int, int]) -> NDArray[np.int64]:
    """Places of the camera that each pixel needs, by what moves furthest in its window; powers of two, shape (h, w)."""
    # What is near moves over what is behind it.
    longest = _most(np.hypot(right_px, down_px), window)
    steps = np.ceil(np.log2(np.clip(longest / PX_PER_TIME, 1.0, MOST_TIMES)))
    return np.asarray(np.exp2(steps), np.int64)


def times(side: int, n: int) -> Array:
    """When, from -0.5 to 0.5 of the exposure, the rays through the parts of a pixel are sent, shape (side * side, n).

    Each part gets times evenly spread, and the parts take turns, so that together they are side * side * n times. No
    row or column of an odd number of parts is before another on average: their turns are a magic square.
    """
    row, column = np.indices((side, side)).reshape(2, -1, 1)
    turns = side * ((row + column) % side) + (row + 2 * column) % side
    return np.asarray((np.arange(n) + (turns + 0.5) / (side * side)) / n - 0.5)
