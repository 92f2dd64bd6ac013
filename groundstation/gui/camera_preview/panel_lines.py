"""Outlines of panels as lines in a picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from groundstation.gui.view3d.pinhole import Pinhole

Array = NDArray[np.float64]

NEAREST_M = 0.05
"""Depth at which lines that run past the camera are cut off."""


def panel_lines(corners_enu_m: Array, view: Pinhole) -> Array:
    """Edges of panels, corners of shape (m, 4, 3), in a view: x and y of both ends, pixels, shape (n, 4).

    What is behind the camera is cut off; n is at most 4 m.
    """
    starts = corners_enu_m.reshape(-1, 3) - view.eye_enu_m
    ends = np.roll(corners_enu_m, -1, axis=1).reshape(-1, 3) - view.eye_enu_m
    depths = np.stack([starts @ view.forward, ends @ view.forward])
    is_before = (depths > NEAREST_M).any(axis=0)
    starts, ends, depths = starts[is_before], ends[is_before], depths[:, is_before]
    # Share of the way from start to end at which the depth is the nearest one.
    change = depths[1] - depths[0]
    cut = np.divide(NEAREST_M - depths[0], change, out=np.zeros_like(change), where=change != 0.0)[:, None]
    along = ends - starts
    first = np.where(depths[0][:, None] < NEAREST_M, starts + cut * along, starts)
    last = np.where(depths[1][:, None] < NEAREST_M, starts + cut * along, ends)
    pixels = [view.project(points + view.eye_enu_m)[0] for points in (first, last)]
    return np.concatenate(pixels, axis=1)
