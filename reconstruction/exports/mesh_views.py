"""Straight-on views of panels: pictures that cover them as a texture does."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from planning.site_import.polygons import area_vector
from reconstruction.splatting.views import View

Array = NDArray[np.float64]

AWAY = 20.0
"""Distance of the camera, as a multiple of a panel's size: rays to its corners are within 2 degrees of its normal."""

EDGE_PX = 2
"""Around a panel, of what is there: textures are smoothed across their pixels."""


@dataclass(frozen=True, slots=True, eq=False)
class PanelView:
    """How a panel is looked at.

    Parameters
    ----------
    view
        Of a camera straight in front, whose picture has `EDGE_PX` more on all sides than the panel.
    distance_m
        Of the camera from the panel's plane.
    corners_px
        Of the panel in the picture, shape (4, 2): x to the right, y down.
    """

    view: View
    distance_m: float
    corners_px: Array


def panel_view(corners_m: Array, px_per_m: float) -> PanelView:
    """View of a panel that is `px_per_m` fine at least.

    Parameters
    ----------
    corners_m
        In the model's frame, counter-clockwise seen from outside, the lower left one first, shape (4, 3).

    Raises
    ------
    ValueError
        The panel has no area.
    """
    normal, right = area_vector(corners_m), corners_m[1] - corners_m[0]
    area = float(np.linalg.norm(normal))
    if not area > 0.0:
        raise ValueError("corners_m: expected a panel with an area")
    normal = normal / area
    right = right - (right @ normal) * normal
    right = right / np.linalg.norm(right)
    up = np.cross(normal, right)
    flat = (corners_m - corners_m[0]) @ np.stack([right, up], axis=1)
    low, size_m = flat.min(axis=0), np.ptp(flat, axis=0)
    size_px = np.maximum(1, np.ceil(size_m * px_per_m - 1e-6))
    distance_m = AWAY * float(size_m.max())
    middle = corners_m[0] + (low + 0.5 * size_m) @ np.stack([right, up])
    # What lies off the plane of the first corner: panels may be warped by centimetres.
    middle = middle + ((corners_m.mean(axis=0) - middle) @ normal) * normal
    world = np.eye(4)
    world[:3, :3] = np.stack([right, -up, -normal])
    world[:3, 3] = -world[:3, :3] @ (middle + distance_m * normal)
    focal_px = distance_m * size_px / size_m
    width_px, height_px = (int(size) + 2 * EDGE_PX for size in size_px)
    view = View(
        width_px,
        height_px,
        float(focal_px[0]),
        float(focal_px[1]),
        0.5 * width_px,
        0.5 * height_px,
        torch.tensor(world),
    )
    share = (flat - low) / size_m
    corners_px = EDGE_PX + np.column_stack([share[:, 0], 1.0 - share[:, 1]]) * size_px
    return PanelView(view, distance_m, corners_px)
