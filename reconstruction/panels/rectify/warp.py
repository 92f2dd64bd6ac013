"""The rectified picture itself: a photo seen through a map, as exactly as asked and no slower than that."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from reconstruction.panels.rectify.rectification import Rectification

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

FIRST_STEP_PX = 32
"""Spacing of the first grid on which a map is computed; between its points it is interpolated."""

TOLERANCE_PX = 0.05
"""Largest error of the interpolated map, pixels of the photo: a twentieth of what the finest feature spans."""

COARSER = 1.5
"""Photo pixels per rectified pixel from which on the photo is averaged first, so that nothing aliases."""


def warp(image: Image, view: Rectification, tolerance_px: float = TOLERANCE_PX) -> tuple[Image, NDArray[np.bool_]]:
    """Rectified picture of a photo, and where it shows something.

    Parameters
    ----------
    image
        Shape (h, w) or (h, w, 3): the photo, of the size that the view's coordinates are for.
    tolerance_px
        0 computes the map at every pixel.

    Returns
    -------
    tuple
        The picture, shape (view.height_px, view.width_px) or with 3 channels, and a mask of its pixels that lie inside
        the photo.
    """
    places = photo_places(view, tolerance_px)
    height, width = image.shape[:2]
    with np.errstate(invalid="ignore"):
        inside = (places >= 0.0).all(axis=2) & (places[..., 0] <= width) & (places[..., 1] <= height)
    shrink = _photo_px_per_rectified(places, inside)
    if shrink > COARSER:
        size = max(1, round(width / shrink)), max(1, round(height / shrink))
        image = np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.uint8)
        places = np.asarray(places * (np.array(size) / np.array([width, height])), np.float32)
    places = np.where(inside[..., None], places - np.float32(0.5), np.float32(-10.0))
    x, y = np.ascontiguousarray(places[..., 0]), np.ascontiguousarray(places[..., 1])
    picture = np.asarray(cv2.remap(image, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE), np.uint8)
    picture[~inside] = 0
    return picture, inside


def photo_places(view: Rectification, tolerance_px: float = TOLERANCE_PX) -> NDArray[np.float32]:
    """Photo coordinates of the centres of all rectified pixels, shape (h, w, 2), NaN where there are none."""
    step = FIRST_STEP_PX if tolerance_px > 0.0 else 1
    while step > 1:
        places = _interpolated(view, step)
        if _error_px(view, places, step) <= tolerance_px:
            return _completed(view, places)
        step //= 4
    x, y = np.meshgrid(np.arange(view.width_px) + 0.5, np.arange(view.height_px) + 0.5)
    exact = view.to_photo(np.column_stack([x.ravel(), y.ravel()]))
    return np.asarray(exact.reshape(view.height_px, view.width_px, 2), np.float32)


def _interpolated(view: Rectification, step: int) -> NDArray[np.float32]:
    """Map on the centres of blocks of `step` pixels and one block around, enlarged."""
    nx, ny = -(-view.width_px // step), -(-view.height_px // step)
    x, y = np.meshgrid((np.arange(-1, nx + 1) + 0.5) * step, (np.arange(-1, ny + 1) + 0.5) * step)
    nodes = view.to_photo(np.column_stack([x.ravel(), y.ravel()])).reshape(ny + 2, nx + 2, 2).astype(np.float32)
    large = cv2.resize(nodes, ((nx + 2) * step, (ny + 2) * step), interpolation=cv2.INTER_LINEAR)
    return np.asarray(large[step : step + view.height_px, step : step + view.width_px], np.float32)


def _error_px(view: Rectification, places: NDArray[np.float32], step: int) -> float:
    """Largest error at the corners between blocks, where interpolation is worst; NaN there are not counted."""
    rows, columns = np.arange(step, view.height_px, step), np.arange(step, view.width_px, step)
    if not len(rows) or not len(columns):
        return 0.0 if step == 1 else float("inf")
    x, y = np.meshgrid(columns, rows)
    exact = view.to_photo(np.column_stack([x.ravel() + 0.5, y.ravel() + 0.5]))
    off = np.abs(places[y.ravel(), x.ravel()] - exact).max(axis=1)
    off = off[np.isfinite(off)]
    return float(off.max()) if len(off) else 0.0


def _completed(view: Rectification, places: NDArray[np.float32]) -> NDArray[np.float32]:
    """Pixels whose block touches the rim of the map, computed one by one."""
    row, column = np.nonzero(~np.isfinite(places).all(axis=2))
    if len(row):
        places[row, column] = view.to_photo(np.column_stack([column + 0.5, row + 0.5]))
    return places


def _photo_px_per_rectified(places: NDArray[np.float32], inside: NDArray[np.bool_]) -> float:
    """Smallest usual spacing in the photo of neighbouring rectified pixels, along rows and columns."""
    across = np.linalg.norm(places[::16, 1:, :] - places[::16, :-1, :], axis=2)[inside[::16, 1:] & inside[::16, :-1]]
    down = np.linalg.norm(places[1:, ::16, :] - places[:-1, ::16, :], axis=2)[inside[1:, ::16] & inside[:-1, ::16]]
    spacings = [float(np.nanmedian(part)) for part in (across, down) if len(part)]
    return min(spacings, default=1.0)
