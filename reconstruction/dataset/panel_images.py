"""Panels drawn into a photo: at each pixel the number of the panel that is seen there (paper 3.3.1, Fig. 7).

A panel is a plane quadrilateral and the photo is straight, so that its edges are straight in the picture, too. A pixel
belongs to a panel if its middle lies inside, and to the nearest one if several cover it; what else may stand in front
is asked of the building's mesh, where the scene calls for it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from reconstruction.base.cameras import PosedPhoto
from reconstruction.base.ray_casting import RayCaster

Array = NDArray[np.float64]
Index = NDArray[np.uint16]

MAX_PANELS = 65535
NEAR_M = 0.05
"""Panels are cut off this close to the camera's plane."""

IN_FRONT_M = 0.15
"""What hides a panel stands at least this far in front of it: a coarse mesh bulges on glass, and frames stand out."""

CHUNK = 1 << 20
"""Rays cast at once: 24 MB."""


@dataclass(frozen=True, slots=True, eq=False)
class PanelImage:
    """Which panel each pixel shows, shape (h, w): its position in the list plus 1, 0 for none; and how far it is.

    `depth_m` is along the optical axis, float32, inf where no panel is.
    """

    index: Index
    depth_m: NDArray[np.float32]


def draw_panels(photo: PosedPhoto, corners_enu_m: Array) -> PanelImage:
    """Draw panels that nothing hides but other panels; those seen from behind are drawn, too, and hide.

    Parameters
    ----------
    photo
        Of a straight camera (see `Intrinsics.is_straight`).
    corners_enu_m
        Shape (n, 4, 3), n up to 65 535.

    Raises
    ------
    ValueError
        The camera is not straight, or there are more panels than 16 bits can number.
    """
    if not photo.intrinsics.is_straight:
        raise ValueError("expected a straight camera: take the photo's distortion away first")
    if len(corners_enu_m) > MAX_PANELS:
        raise ValueError(f"expected at most {MAX_PANELS} panels, got {len(corners_enu_m)}")
    if corners_enu_m.shape[1:] != (4, 3):
        raise ValueError(f"corners_enu_m: expected shape (n, 4, 3), got {corners_enu_m.shape}")
    camera = photo.intrinsics
    index = np.zeros((camera.height_px, camera.width_px), np.uint16)
    depth = np.full(index.shape, np.inf, np.float32)
    points = photo.pose.points_cam(corners_enu_m.reshape(-1, 3)).reshape(-1, 4, 3)
    lens = np.array([camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px])
    _draw(np.ascontiguousarray(points), lens, NEAR_M, index, depth)
    return PanelImage(index, depth)


@kernel
def _draw(points: Array, lens: Array, near: float, index: Index, depth: NDArray[np.float32]) -> None:
    """Every panel over its bounding box: inside by the signs of its edges, depth from its plane."""
    height, width = index.shape
    clipped = np.empty((8, 3))
    edges = np.empty((8, 3))
    pixels = np.empty((8, 2))
    for panel in range(points.shape[0]):
        n = _clip_near(points[panel], near, clipped)
        if n < 3:
            continue
        normal = np.cross(points[panel, 2] - points[panel, 0], points[panel, 3] - points[panel, 1])
        middle = 0.25 * (points[panel, 0] + points[panel, 1] + points[panel, 2] + points[panel, 3])
        offset = normal[0] * middle[0] + normal[1] * middle[1] + normal[2] * middle[2]
        low_x, high_x, low_y, high_y = np.inf, -np.inf, np.inf, -np.inf
        for i in range(n):
            pixels[i, 0] = lens[0] * clipped[i, 0] / clipped[i, 2] + lens[2]
            pixels[i, 1] = lens[1] * clipped[i, 1] / clipped[i, 2] + lens[3]
            low_x, high_x = min(low_x, pixels[i, 0]), max(high_x, pixels[i, 0])
            low_y, high_y = min(low_y, pixels[i, 1]), max(high_y, pixels[i, 1])
        if high_x <= 0.0 or high_y <= 0.0 or low_x >= width or low_y >= height:
            continue
        area = 0.0
        for i in range(n):
            j = (i + 1) % n
            area += pixels[i, 0] * pixels[j, 1] - pixels[j, 0] * pixels[i, 1]
        if area == 0.0:
            continue
        turn = 1.0 if area > 0.0 else -1.0
        for i in range(n):
            j = (i + 1) % n
            a = turn * (pixels[i, 1] - pixels[j, 1])
            b = turn * (pixels[j, 0] - pixels[i, 0])
            edges[i, 0], edges[i, 1] = a, b
            edges[i, 2] = -(a * pixels[i, 0] + b * pixels[i, 1])
        for y in range(max(0, int(np.floor(low_y - 0.5))), min(height, int(np.ceil(high_y + 0.5)))):
            middle_y = y + 0.5
            start, stop = max(low_x, 0.0), min(high_x, float(width))
            for i in range(n):
                rest = edges[i, 1] * middle_y + edges[i, 2]
                if edges[i, 0] > 0.0:
                    start = max(start, -rest / edges[i, 0])
                elif edges[i, 0] < 0.0:
                    stop = min(stop, -rest / edges[i, 0])
                elif rest < 0.0:
                    stop = -1.0
            ray_y = (middle_y - lens[3]) / lens[1]
            for x in range(max(0, int(np.ceil(start - 0.5))), min(width, int(np.ceil(stop - 0.5)))):
                ray_x = (x + 0.5 - lens[2]) / lens[0]
                along = normal[0] * ray_x + normal[1] * ray_y + normal[2]
                if along == 0.0:
                    continue
                z = offset / along
                if near <= z < depth[y, x]:
                    depth[y, x] = z
                    index[y, x] = panel + 1


@kernel
def _clip_near(corners: Array, near: float, clipped: Array) -> int:
    """Part of a quadrilateral beyond the near plane; the number of its corners."""
    n = 0
    for i in range(4):
        j = (i + 1) % 4
        a, b = corners[i, 2] - near, corners[j, 2] - near
        if a >= 0.0:
            clipped[n] = corners[i]
            n += 1
        if (a >= 0.0) != (b >= 0.0):
            share = a / (a - b)
            clipped[n] = corners[i] + share * (corners[j] - corners[i])
            n += 1
    return n


def without_hidden(photo: PosedPhoto, image: PanelImage, caster: RayCaster) -> Index:
    """Panel numbers with 0 where the building or an obstacle stands in front of the panel."""
    index = image.index.copy()
    rows, columns = np.nonzero(index)
    for start in range(0, len(rows), CHUNK):
        y, x = rows[start : start + CHUNK], columns[start : start + CHUNK]
        origins, directions = photo.rays(np.column_stack([x + 0.5, y + 0.5]))
        cosine = directions @ photo.pose.forward_enu
        distance = image.depth_m[y, x] / cosine
        hits = caster.cast(origins, directions)
        hidden = hits.distance_m < distance - IN_FRONT_M
        index[y[hidden], x[hidden]] = 0
    return index


def facing(photo: PosedPhoto, corners_enu_m: Array) -> NDArray[np.bool_]:
    """Which panels, shape (n, 4, 3), turn their outer side to the camera, shape (n,)."""
    normals = np.cross(corners_enu_m[:, 2] - corners_enu_m[:, 0], corners_enu_m[:, 3] - corners_enu_m[:, 1])
    towards = photo.pose.position_enu_m - corners_enu_m.mean(axis=1)
    return np.asarray((normals * towards).sum(axis=1) > 0.0)
