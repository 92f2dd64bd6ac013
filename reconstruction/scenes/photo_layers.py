"""The files of one rendered photo: the picture as a camera writes it, and what is true of each of its pixels."""

from __future__ import annotations

import io
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from reconstruction.cameras import PosedPhoto
from reconstruction.dataset.layers import normals_to_16_bit, unit_normals
from reconstruction.dataset.panel_images import draw_panels, facing
from reconstruction.dataset.prepare import layer_path
from reconstruction.scenes.renderer import Photograph

Array = NDArray[np.float64]
Image = NDArray[np.uint8] | NDArray[np.uint16]

ARRAYS, PICTURES = ("depth", "diffuse", "reflection"), ("panels", "masks", "normals", "glass")
"""Folders of layers: NumPy arrays, and PNG pictures."""

BYTES_PER_PIXEL = 18
"""Of all files of a photo at most: arrays take 16, pictures about 1 (measured on the bundled scenes)."""

FRAME_M = 0.3
"""Off a panel's plane its frames may stand out or lie back; what is further away is something else, and hides it."""

BRIGHTEST = float(np.finfo(np.float16).max)


def layer_file(folder: Path, layer: str, name: str) -> Path:
    """Of a layer of the photo `name`."""
    return folder / layer / f"{name}.npy" if layer in ARRAYS else layer_path(folder, layer, name)


def layer_contents(taken: Photograph, facade: NDArray[np.bool_]) -> dict[str, bytes]:
    """Content of each layer's file; docs/file-formats.md says how they are coded.

    Parameters
    ----------
    facade
        Shape (h, w): panels and the frames between them.
    """
    normals = np.where(np.isfinite(taken.normal_enu), taken.normal_enu, 0.0).astype(np.float32)
    return {
        "depth": _npy(taken.depth_m.astype(np.float32)),
        "diffuse": _npy(np.clip(taken.diffuse, 0.0, BRIGHTEST).astype(np.float16)),
        "reflection": _npy(np.clip(taken.reflection, 0.0, BRIGHTEST).astype(np.float16)),
        "panels": _png(taken.panel.astype(np.uint16)),
        "masks": _png(facade.astype(np.uint8) * 255),
        "normals": _png(np.ascontiguousarray(normals_to_16_bit(normals)[..., ::-1])),
        "glass": _png(taken.is_glass.astype(np.uint8) * 255),
    }


def facade_mask(photo: PosedPhoto, grown_enu_m: Array, depth_m: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Where a straight photo shows panels or the frames between them, shape (h, w).

    Parameters
    ----------
    grown_enu_m
        Panels grown over their frames, shape (n, 4, 3).
    depth_m
        What the photo shows, shape (h, w), along the optical axis.
    """
    panels = grown_enu_m[facing(photo, grown_enu_m)]
    index = draw_panels(photo, panels).index
    mask = (index > 0) & np.isfinite(depth_m)
    rows, columns = np.nonzero(mask)
    rays = photo.pose.directions_enu(photo.intrinsics.rays(np.column_stack([columns + 0.5, rows + 0.5])))
    shown = photo.pose.position_enu_m + depth_m[rows, columns, None] * rays
    number = index[rows, columns].astype(np.int64) - 1
    off_plane_m = ((shown - panels.mean(axis=1)[number]) * unit_normals(panels)[number]).sum(axis=1)
    mask[rows, columns] = np.abs(off_plane_m) <= FRAME_M
    return np.asarray(mask)


def _npy(values: NDArray[np.float16] | NDArray[np.float32]) -> bytes:
    file = io.BytesIO()
    np.save(file, values, allow_pickle=False)
    return file.getvalue()


def _png(image: Image) -> bytes:
    return bytes(cv2.imencode(".png", image, [cv2.IMWRITE_PNG_COMPRESSION, 3])[1].tobytes())
