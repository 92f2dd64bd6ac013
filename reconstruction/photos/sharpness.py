"""How blurred a picture is, in pixels: the width of its sharpest edges, in each direction.

A step edge blurred by sigma and then by a Gaussian of s has a slope proportional to 1 / sqrt(sigma^2 + s^2) at its
middle, whatever its contrast. The ratio R of the slopes for two values of s gives the edge's own blur,

    sigma^2 = (s2^2 - R^2 s1^2) / (R^2 - 1) - 1/3

(after S. Zhuo and T. Sim, "Defocus map estimation from a single image", Pattern Recognition 44, 2011, Eq. 7, where
s1 = 0; the third is what the central difference smooths, a box of two pixels). So the measure has a unit and does not
depend on how much there is to see, unlike the variance of a Laplacian.

Edges along a movement stay sharp: the measure is taken per direction, and the worst direction counts. A movement makes
ramps, not Gaussian edges: on plain steps, movements of more than 5 px measure as more than their sigma.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from reconstruction.photos.edge_kernel import MARGIN, edge_blurs

NARROW, WIDE = 1.0, 2.0
"""s1 and s2, pixels: the first keeps noise down, the second is to differ well from it."""

N_DIRECTIONS = 4
"""Of edges: across 0, 45, 90 and 135 degrees."""

LEAST_EDGES = 60
"""Edge pixels that a direction must have to be judged: the median of so many is good to a sixth of their spread."""

QUANTILE = 0.5
"""Of the edges' blur in one direction: fine lines, which seem sharper than steps, and shadows, which are softer, even
out. On eleven real photos blurred by 2 px it gave 1.4 to 1.9, while the variance of their Laplacian differed 40-fold.
"""

DIFFERENCE = 1.0 / 3.0
"""Variance of the box that a central difference averages over, square pixels."""

LEAST_SLOPE = 4.0
"""Grey levels per pixel, after the narrow Gaussian; a step of 10 levels has that. Noise of 3 levels (high ISO) leaves
slopes of 0.6."""

N_TILES, TILE_PX = 4, 256
"""A grid of 4 x 4 tiles stands for a large picture: one megapixel of it, with thousands of edges."""

MOTION_TO_SIGMA = 1.0 / math.sqrt(12.0)
"""Standard deviation of a line's own length: blur by a movement as a sigma."""


@dataclass(frozen=True, slots=True)
class Sharpness:
    """Blur of a picture.

    Parameters
    ----------
    sigma_px
        Of the worst direction that has edges; None where there are too few edges to tell.
    direction_deg
        Across the edges it was measured on, from the picture's x axis towards y, in [0, 180).
    n_edges
        Edge pixels in all directions.
    """

    sigma_px: float | None
    direction_deg: float | None
    n_edges: int


def sharpness(grey: NDArray[np.uint8]) -> Sharpness:
    """Blur of a grey picture, shape (h, w)."""
    sigmas, angles = [], []
    for tile in _tiles(grey):
        sigma, angle = _edges(tile)
        sigmas.append(sigma)
        angles.append(angle)
    sigma, angle = np.concatenate(sigmas), np.concatenate(angles)
    bins = np.floor(np.remainder(angle / math.pi * N_DIRECTIONS + 0.5, N_DIRECTIONS)).astype(np.int64) % N_DIRECTIONS
    worst: tuple[float, int] | None = None
    for index in range(N_DIRECTIONS):
        own = sigma[bins == index]
        if len(own) >= LEAST_EDGES:
            found = float(np.quantile(own, QUANTILE))
            worst = (found, index) if worst is None or found > worst[0] else worst
    if worst is None:
        return Sharpness(None, None, len(sigma))
    return Sharpness(worst[0], worst[1] * 180.0 / N_DIRECTIONS, len(sigma))


def _tiles(grey: NDArray[np.uint8]) -> list[NDArray[np.uint8]]:
    """The picture, or a grid of tiles spread over it where it is larger than these."""
    height, width = grey.shape
    if height * width <= (N_TILES * TILE_PX) ** 2:
        return [grey]
    tops = np.linspace(0, max(0, height - TILE_PX), N_TILES).astype(int).tolist()
    lefts = np.linspace(0, max(0, width - TILE_PX), N_TILES).astype(int).tolist()
    return [grey[y : y + TILE_PX, x : x + TILE_PX] for y in tops for x in lefts]


def _edges(tile: NDArray[np.uint8]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Blur (px) and direction of the slope (rad) of edge pixels, each shape (n,)."""
    sigma, angle = np.empty(tile.size, np.float32), np.empty(tile.size, np.float32)
    if min(tile.shape) <= 2 * MARGIN:
        return sigma[:0], angle[:0]
    picture = tile.astype(np.float32)
    narrow, wide = (np.asarray(cv2.GaussianBlur(picture, (0, 0), s), np.float32) for s in (NARROW, WIDE))
    variances = NARROW**2, WIDE**2, DIFFERENCE
    n = edge_blurs(np.ascontiguousarray(tile), narrow, wide, variances, LEAST_SLOPE, sigma, angle)
    return sigma[:n].copy(), angle[:n].copy()
