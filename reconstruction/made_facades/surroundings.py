"""What stands behind and across the street of a made facade, painted on a picture that hangs upright there."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from reconstruction.made_facades.record import Opposite

HALF_WIDTH_M, BOTTOM_M, TOP_M = 90.0, -20.0, 70.0
"""Extent of a picture: to both sides of the wall's middle, and above its base. Beyond, its rim goes on."""

SCALE_PX_PER_M = 16.0
"""6 cm: the size of a pixel of the photo, as seen in the glass."""


@dataclass(frozen=True, slots=True, eq=False)
class Backdrop:
    """A painted upright picture, shape (height, width, 3), uint8, parallel to the wall."""

    picture: NDArray[np.uint8]

    def at(self, x_m: NDArray[np.float32], z_m: NDArray[np.float32]) -> NDArray[np.float32]:
        """Colours, shape (n, 3), 0 to 255, at places in the wall frame, each shape (n,) with n below 32 767."""
        scale = np.float32(SCALE_PX_PER_M)
        u = (x_m + np.float32(HALF_WIDTH_M)) * scale - np.float32(0.5)
        v = (np.float32(TOP_M) - z_m) * scale - np.float32(0.5)
        found = cv2.remap(self.picture, u[None], v[None], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(found[0], np.float32)


def paint(rng: np.random.Generator, ground_m: float, is_empty: bool = False) -> Backdrop:
    """Sky with clouds above `ground_m`, and, unless it is to be empty, buildings with windows and trees before them."""
    picture = _sky_and_ground(rng, ground_m)
    if not is_empty:
        x = -HALF_WIDTH_M
        while x < HALF_WIDTH_M:
            width = rng.uniform(9.0, 24.0)
            _building(picture, rng, x, width, ground_m, rng.uniform(12.0, 52.0))
            x += width + rng.choice([0.0, 0.0, rng.uniform(1.0, 8.0)])
        _trees(picture, rng, ground_m)
    return Backdrop(picture)


def paint_grid(rng: np.random.Generator, ground_m: float, spacing_m: tuple[float, float]) -> Backdrop:
    """Across the street stands one long building whose bright bars, `spacing_m` apart, look like frames when mirrored.

    It begins in the middle of the wall with the same bars to both sides, so its mirror image is symmetric.
    """
    picture = _sky_and_ground(rng, ground_m)
    x0, x1 = _columns(-60.0, 60.0)
    y0, y1 = _rows(ground_m + 45.0, ground_m)
    picture[y0:y1, x0:x1] = (62, 58, 52)
    bar = 0.18
    for x in np.arange(0.0, 60.0, spacing_m[0]):
        for side in (-x, x):
            a, b = _columns(side - bar, side + bar)
            picture[y0:y1, a:b] = (225, 230, 232)
    for z in np.arange(ground_m, ground_m + 45.0, spacing_m[1]):
        a, b = _rows(z + bar, z - bar)
        picture[a:b, x0:x1] = (225, 230, 232)
    return Backdrop(picture)


def paint_roofs(rng: np.random.Generator, ground_m: float) -> Backdrop:
    """A row of tall gabled houses: long straight edges, inclined alike, between dark roofs and the sky."""
    picture = _sky_and_ground(rng, ground_m)
    pitch, x = rng.uniform(0.5, 1.2), -HALF_WIDTH_M
    while x < HALF_WIDTH_M:
        width, eaves = rng.uniform(14.0, 30.0), ground_m + rng.uniform(8.0, 25.0)
        a, b = _columns(x, x + width)
        _, low = _rows(eaves, ground_m)
        high, _ = _rows(eaves, ground_m)
        picture[high:low, a:b] = rng.uniform(110.0, 220.0)
        top, _ = _rows(eaves + 0.5 * pitch * width, ground_m)
        cv2.fillPoly(picture, [np.array([(a, high), (b, high), ((a + b) // 2, top)], np.int32)], (58, 60, 78))
        x += width
    return Backdrop(picture)


def backdrop_across(
    opposite: Opposite, rng: np.random.Generator, ground_m: float, spacing_m: tuple[float, float]
) -> Backdrop:
    """What is mirrored."""
    if opposite == "grid":
        return paint_grid(rng, ground_m, spacing_m)
    return paint_roofs(rng, ground_m) if opposite == "roofs" else paint(rng, ground_m)


def _columns(left_m: float, right_m: float) -> tuple[int, int]:
    a, b = (round((x + HALF_WIDTH_M) * SCALE_PX_PER_M) for x in (left_m, right_m))
    return max(a, 0), max(b, 0)


def _rows(top_m: float, bottom_m: float) -> tuple[int, int]:
    a, b = (round((TOP_M - z) * SCALE_PX_PER_M) for z in (top_m, bottom_m))
    return max(a, 0), max(b, 0)


def _sky_and_ground(rng: np.random.Generator, ground_m: float) -> NDArray[np.uint8]:
    height, width = round((TOP_M - BOTTOM_M) * SCALE_PX_PER_M), round(2 * HALF_WIDTH_M * SCALE_PX_PER_M)
    # Nothing in the sky is sharp, so an eighth of the size is enough to paint it.
    small = (width // 8, height // 8)
    rise = np.linspace(0.0, 1.0, small[1], dtype=np.float32)[:, None, None]
    zenith, horizon = np.array([215, 160, 105], np.float32), np.array([240, 228, 214], np.float32)
    clouds = cv2.resize(rng.random((9, 18), np.float32), small, interpolation=cv2.INTER_CUBIC)[..., None]
    clouds = np.clip(3.0 * clouds - 1.6, 0.0, 1.0)
    sky = zenith + rise * (horizon - zenith)
    sky = np.asarray(sky + clouds * (250.0 - sky), np.float32).astype(np.uint8)
    picture = np.asarray(cv2.resize(sky, (width, height), interpolation=cv2.INTER_LINEAR), np.uint8)
    first, _ = _rows(ground_m, BOTTOM_M)
    picture[first:] = (98, 102, 104)
    return picture


def _building(
    picture: NDArray[np.uint8], rng: np.random.Generator, x_m: float, width_m: float, ground_m: float, height_m: float
) -> None:
    x0, x1 = _columns(x_m, x_m + width_m)
    y0, y1 = _rows(ground_m + height_m, ground_m)
    wall = rng.uniform(60.0, 235.0) * np.array([0.92, 0.97, 1.0]) * rng.uniform(0.9, 1.0, 3)
    picture[y0:y1, x0:x1] = wall.astype(np.uint8)
    bay, storey = rng.uniform(1.6, 4.0), rng.uniform(2.8, 3.8)
    opening = rng.uniform(0.45, 0.85, 2)
    dark = wall.mean() > 110.0
    for z in np.arange(ground_m + 0.8, ground_m + height_m - storey, storey):
        for x in np.arange(x_m + 0.5, x_m + width_m - bay, bay):
            a, b = _columns(x, x + opening[0] * bay)
            c, d = _rows(z + opening[1] * storey, z)
            grey = rng.uniform(25.0, 70.0) if dark else rng.uniform(150.0, 255.0)
            picture[c:d, a:b] = (grey, grey, 0.92 * grey)


def _trees(picture: NDArray[np.uint8], rng: np.random.Generator, ground_m: float) -> None:
    for _ in range(14):
        x, radius = rng.uniform(-HALF_WIDTH_M, HALF_WIDTH_M), rng.uniform(1.5, 3.5)
        middle = ground_m + 3.0 + radius
        green = np.array([48.0, 95.0, 62.0]) * rng.uniform(0.6, 1.2)
        for _ in range(60):
            dx, dz = rng.normal(0.0, 0.45 * radius, 2)
            u, v = (x + dx + HALF_WIDTH_M) * SCALE_PX_PER_M, (TOP_M - middle - dz) * SCALE_PX_PER_M
            size = rng.uniform(0.12, 0.35) * radius * SCALE_PX_PER_M
            colour = tuple(float(value) for value in green * rng.uniform(0.7, 1.3))
            cv2.circle(picture, (round(u), round(v)), max(1, round(size)), colour, -1)
