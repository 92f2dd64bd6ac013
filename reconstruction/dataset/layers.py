"""The layers of one photo: the straight picture, panel numbers, facade mask and normals."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from planning.geo.ray_casting import RayCaster
from reconstruction.base.cameras import Intrinsics, PosedPhoto

Array = NDArray[np.float64]


# Panels drawn into a photo: at each pixel the number of the panel that is seen there (paper 3.3.1, Fig. 7).
#
# A panel is a plane quadrilateral and the photo is straight, so that its edges are straight in the picture, too. A
# pixel
# belongs to a panel if its middle lies inside, and to the nearest one if several cover it; what else may stand in
# front
# is asked of the building's mesh, where the scene calls for it.

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
        Shape (h, w): panels and the frames between them; all of the photo where there are no panels.
    normals_enu
        Shape (h / step, w / step, 3), float32, of what the pixel shows; 0 where that is nothing.
    """

    panels: NDArray[np.uint16]
    facade: NDArray[np.bool_]
    normals_enu: NDArray[np.float32]


def straightened(
    photo: PosedPhoto, image: Image, valid: NDArray[np.bool_] | None = None
) -> tuple[PosedPhoto, Image, NDArray[np.bool_]]:
    """Photo and picture with the lens's distortion taken away, and which of its pixels are valid, shape (h, w).

    Those are that are made of valid pixels of the photo alone; all of these are where `valid` is None.
    """
    lens = photo.intrinsics
    maps = straightening_maps(lens)
    picture = cv2.remap(image, *maps, cv2.INTER_CUBIC, borderMode=cv2.BORDER_CONSTANT, borderValue=0)
    straight = replace(photo, intrinsics=lens.straight())
    return straight, np.asarray(picture, np.uint8), straightened_mask(maps, image.shape[:2], valid)


def straightened_mask(maps: Maps, shape: tuple[int, ...], valid: NDArray[np.bool_] | None = None) -> NDArray[np.bool_]:
    """Pixels of a straight picture that cubic interpolation makes of valid ones alone.

    Parameters
    ----------
    maps
        Of `straightening_maps`.
    shape
        Rows and columns of the photo.
    valid
        Which of its pixels are, of that shape; None for all.
    """
    x, y = maps
    inside = (x >= 1.0) & (x < shape[1] - 2.0) & (y >= 1.0) & (y < shape[0] - 2.0)
    if valid is None:
        return np.asarray(inside)
    whole = cv2.erode(valid.astype(np.uint8), np.ones((CUBIC_PX, CUBIC_PX), np.uint8))
    return np.asarray(inside & (cv2.remap(whole, x, y, cv2.INTER_NEAREST, borderMode=cv2.BORDER_CONSTANT) > 0))


CUBIC_PX = 5
"""Side of a square around the nearest pixel that holds the four by four which cubic interpolation takes."""

NOWHERE_PX = -10.0
"""Column and row of what a fisheye does not show: beside the picture, whatever interpolation takes."""

Maps = tuple[NDArray[np.float32], NDArray[np.float32]]


def straightening_maps(lens: Intrinsics) -> Maps:
    """Column and row in the photo of each pixel of the straight picture, shape (h, w), as `cv2.remap` counts them."""
    straight = lens.straight()
    if lens.fisheye is not None:
        maps = np.empty((2, straight.height_px, straight.width_px), np.float32)
        for start in range(0, straight.height_px, ROWS):
            part = maps[:, start : start + ROWS]
            rows, columns = np.indices(part.shape[1:]) + 0.5
            places = np.column_stack([columns.ravel(), start + rows.ravel()])
            part[:] = (lens.pixels(straight.rays(places)) - 0.5).T.reshape(part.shape)
        # Where the lens shows nothing.
        np.nan_to_num(maps, copy=False, nan=NOWHERE_PX)
        return maps[0], maps[1]
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
    if not len(scene.corners_enu_m):
        size = photo.intrinsics.height_px, photo.intrinsics.width_px
        normals = normal_map(photo, scene.refined, normal_step)
        return Layers(np.zeros(size, np.uint16), np.ones(size, np.bool_), normals)
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
