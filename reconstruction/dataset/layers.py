"""The layers of one photo: the straight picture, panel numbers, facade mask and normals."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from reconstruction.base.cameras import Intrinsics, PosedPhoto
from reconstruction.base.ray_casting import RayCaster
from reconstruction.dataset.panel_images import draw_panels, facing, without_hidden

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

ROWS = 256
"""Rows of rays cast at once."""


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """What is drawn into every photo.

    Parameters
    ----------
    corners_enu_m
        Of all panels, shape (n, 4, 3).
    grown_enu_m
        The same, grown to cover the frames between them, shape (n, 4, 3).
    refined
        The refined mesh, whose normals are rendered.
    surroundings
        What may hide panels; None where nothing does.
    """

    corners_enu_m: Array
    grown_enu_m: Array
    refined: RayCaster
    surroundings: RayCaster | None


@dataclass(frozen=True, slots=True, eq=False)
class Layers:
    """Layers of one photo; all of its size but `normals`, which is coarser by the step asked for.

    Parameters
    ----------
    panels
        Shape (h, w), uint16: position of the panel plus 1, 0 for none.
    facade
        Shape (h, w): panels and the frames between them.
    normals_enu
        Shape (h / step, w / step, 3), float32, of what the pixel shows; 0 where that is nothing.
    """

    panels: NDArray[np.uint16]
    facade: NDArray[np.bool_]
    normals_enu: NDArray[np.float32]


def straightened(photo: PosedPhoto, image: Image) -> tuple[PosedPhoto, Image]:
    """Photo and picture with the lens's distortion taken away, by the same camera matrix and size.

    Where the straight picture reaches beyond the photo it is black.
    """
    lens = photo.intrinsics
    x, y = straightening_maps(lens)
    picture = cv2.remap(image, x, y, cv2.INTER_CUBIC, borderMode=cv2.BORDER_CONSTANT, borderValue=0)
    return replace(photo, intrinsics=lens.straight()), np.asarray(picture, np.uint8)


def straightening_maps(lens: Intrinsics) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Column and row in the photo of each pixel of the straight picture, shape (h, w), as `cv2.remap` counts them."""
    shifted = lens.matrix.copy()
    shifted[:2, 2] -= 0.5
    size = lens.width_px, lens.height_px
    x, y = cv2.initUndistortRectifyMap(shifted, np.array(lens.distortion), np.eye(3), shifted, size, cv2.CV_32FC1)
    return np.asarray(x, np.float32), np.asarray(y, np.float32)


def draw_layers(photo: PosedPhoto, scene: Scene, normal_step: int = 1) -> Layers:
    """Layers of a straight photo.

    Parameters
    ----------
    normal_step
        Pixels of the photo, along each side, per pixel of the normal map.
    """
    front = facing(photo, scene.corners_enu_m)
    numbers = np.concatenate([[0], np.flatnonzero(front) + 1]).astype(np.uint16)
    drawn = draw_panels(photo, scene.corners_enu_m[front])
    grown = draw_panels(photo, scene.grown_enu_m[front])
    index, facade = drawn.index, grown.index > 0
    if scene.surroundings is not None:
        index = without_hidden(photo, drawn, scene.surroundings)
        facade = without_hidden(photo, grown, scene.surroundings) > 0
    panels = numbers[index]
    return Layers(
        panels, np.asarray(facade), normal_map(photo, scene.refined, normal_step, panels, scene.corners_enu_m)
    )


def normal_map(
    photo: PosedPhoto,
    mesh: RayCaster,
    step: int = 1,
    panels: NDArray[np.uint16] | None = None,
    corners_enu_m: Array | None = None,
) -> NDArray[np.float32]:
    """Normals of what a straight photo shows, turned to the camera, shape (h / step, w / step, 3), ENU; 0 for nothing.

    Every ray goes through the middle of its block of pixels. Where a panel is seen its normal is known, and no ray is
    cast.

    Parameters
    ----------
    panels, corners_enu_m
        Panel numbers of the photo's pixels, and the panels.
    """
    lens = photo.intrinsics
    width, height = -(-lens.width_px // step), -(-lens.height_px // step)
    x, y = (np.arange(width) + 0.5) * step, (np.arange(height) + 0.5) * step
    normals = np.zeros((height, width, 3), np.float32)
    open_ = np.ones((height, width), bool)
    if panels is not None and corners_enu_m is not None and len(corners_enu_m):
        rows, columns = np.minimum(y.astype(int), lens.height_px - 1), np.minimum(x.astype(int), lens.width_px - 1)
        seen = panels[np.ix_(rows, columns)]
        open_ = seen == 0
        normals[~open_] = unit_normals(corners_enu_m)[seen[~open_].astype(np.int64) - 1]
    for start in range(0, height, ROWS):
        row, column = np.nonzero(open_[start : start + ROWS])
        hits = mesh.cast(*photo.rays(np.column_stack([x[column], y[start + row]])))
        normals[start + row, column] = np.where(hits.is_hit[:, None], hits.normals_enu, 0.0)
    return normals


def unit_normals(corners_enu_m: Array) -> Array:
    """Outward normals of panels, shape (n, 3)."""
    normals = np.cross(corners_enu_m[:, 2] - corners_enu_m[:, 0], corners_enu_m[:, 3] - corners_enu_m[:, 1])
    return np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True))


def normals_to_16_bit(normals_enu: NDArray[np.float32]) -> NDArray[np.uint16]:
    """Components from -1..1 to 1..65535, shape kept; all three 0 where there is no normal."""
    known = (normals_enu != 0.0).any(axis=-1, keepdims=True)
    coded = np.round((normals_enu.astype(float) + 1.0) * 32767.0 + 1.0)
    return np.where(known, coded, 0.0).astype(np.uint16)


def normals_from_16_bit(coded: NDArray[np.uint16]) -> NDArray[np.float32]:
    """Unit normals, or 0, from their coded form."""
    known = (coded != 0).any(axis=-1, keepdims=True)
    normals = (coded.astype(float) - 1.0) / 32767.0 - 1.0
    length = np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-9)
    return np.where(known, normals / length, 0.0).astype(np.float32)
