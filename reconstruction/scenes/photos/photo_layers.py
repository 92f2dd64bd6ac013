"""The files of one rendered photo: the picture as a camera writes it, and what is true of each of its pixels."""

from __future__ import annotations

import io
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks
from planning.geo.mesh import from_corners
from planning.geo.ray_casting import RayCaster
from planning.site.records import panel_triangles
from reconstruction.base.cameras import PosedPhoto
from reconstruction.dataset.layers import draw_panels, facing, normals_to_16_bit, unit_normals
from reconstruction.dataset.prepare import layer_path
from reconstruction.scenes.photos.renderer import RenderedPhoto

Array = NDArray[np.float64]
Image = NDArray[np.uint8] | NDArray[np.uint16]

ARRAYS, PICTURES = ("depth", "diffuse", "reflection"), ("panels", "masks", "normals", "glass")
"""Folders of layers: NumPy arrays, and PNG pictures."""

BYTES_PER_PIXEL = 18
"""Of all files of a photo at most: arrays take 16, pictures about 1 (measured on the bundled scenes)."""

FRAME_M = 0.3
"""Off a panel's plane its frames may stand out or lie back; what is further away is something else, and hides it."""

RAYS_AT_ONCE = 1 << 20

ROWS_AT_ONCE = 256
"""Bounds the memory of what is reckoned in double precision: 32 MB for three values a pixel of 5280 columns."""

BRIGHTEST = float(np.finfo(np.float16).max)


def layer_file(folder: Path, layer: str, name: str) -> Path:
    """Of a layer of the photo `name`."""
    return folder / layer / f"{name}.npy" if layer in ARRAYS else layer_path(folder, layer, name)


def layer_contents(rendered: RenderedPhoto, facade: NDArray[np.bool_]) -> dict[str, bytes]:
    """Content of each layer's file; docs/reference/file-formats.md says how they are coded.

    Parameters
    ----------
    facade
        Shape (h, w): panels and the frames between them.
    """
    return {
        "depth": _npy(rendered.depth_m.astype(np.float32)),
        "diffuse": _npy(np.clip(rendered.diffuse, 0.0, BRIGHTEST).astype(np.float16)),
        "reflection": _npy(np.clip(rendered.reflection, 0.0, BRIGHTEST).astype(np.float16)),
        "panels": _png(rendered.panel.astype(np.uint16)),
        "masks": _png(facade.astype(np.uint8) * 255),
        "normals": _png(_coded(rendered.normal_enu)),
        "glass": _png(rendered.is_glass.astype(np.uint8) * 255),
    }


def facade_mask(photo: PosedPhoto, grown_enu_m: Array, depth_m: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Where a photo shows panels or the frames between them, shape (h, w).

    Parameters
    ----------
    grown_enu_m
        Panels grown over their frames, shape (n, 4, 3).
    depth_m
        What the photo shows, shape (h, w), along the optical axis.
    """
    panels = grown_enu_m[facing(photo, grown_enu_m)]
    index = draw_panels(photo, panels).index if photo.intrinsics.is_straight else _drawn_by_rays(photo, panels)
    mask = (index > 0) & np.isfinite(depth_m)
    middles, normals = panels.mean(axis=1), unit_normals(panels)
    for start, stop in chunks(len(mask), ROWS_AT_ONCE):
        rows, columns = np.nonzero(mask[start:stop])
        rows += start
        rays = photo.pose.directions_enu(photo.intrinsics.rays(np.column_stack([columns + 0.5, rows + 0.5])))
        shown = photo.pose.position_enu_m + depth_m[rows, columns, None] * rays
        number = index[rows, columns].astype(np.int64) - 1
        off_plane_m = ((shown - middles[number]) * normals[number]).sum(axis=1)
        mask[rows, columns] = np.abs(off_plane_m) <= FRAME_M
    return np.asarray(mask)


def _drawn_by_rays(photo: PosedPhoto, corners_enu_m: Array) -> NDArray[np.int64]:
    """1 + number of the panel that the ray through each pixel's middle meets first, 0 for none, shape (h, w)."""
    lens = photo.intrinsics
    caster = RayCaster(from_corners(panel_triangles(corners_enu_m)))
    index = np.zeros(lens.height_px * lens.width_px, np.int64)
    for start in range(0, len(index), RAYS_AT_ONCE):
        pixels = np.arange(start, min(start + RAYS_AT_ONCE, len(index)))
        middles: Array = np.column_stack([pixels % lens.width_px, pixels // lens.width_px]) + np.float64(0.5)
        origins, directions = photo.rays(middles)
        # Each panel is two triangles in a row.
        index[pixels] = (caster.cast(origins, directions).triangles + 2) // 2
    return index.reshape(lens.height_px, lens.width_px)


def _coded(normals_enu: NDArray[np.float32]) -> NDArray[np.uint16]:
    """Normals as they are written, blue, green, red; 0 where there is none."""
    coded = np.zeros(normals_enu.shape, np.uint16)
    for start, stop in chunks(len(coded), ROWS_AT_ONCE):
        part = normals_enu[start:stop]
        coded[start:stop] = normals_to_16_bit(np.where(np.isfinite(part), part, np.float32(0.0)))[..., ::-1]
    return coded


def _npy(values: NDArray[np.float16] | NDArray[np.float32]) -> bytes:
    file = io.BytesIO()
    np.save(file, values, allow_pickle=False)
    return file.getvalue()


def _png(image: Image) -> bytes:
    return bytes(cv2.imencode(".png", image, [cv2.IMWRITE_PNG_COMPRESSION, 3])[1].tobytes())
