"""Panes from what the network says at each place: places that name the same four corners are one pane.

Places that say they lie on a pane are gathered by the middle of the corners they name; where many meet, there is a
pane, its corners the median of what they name. How probably it is there is weighed in `confidence`.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]

STRIDE = 4
"""Pixels of the picture per place of the network's result."""

LEAST_PROBABILITY = 0.35
"""Of a place that may vote."""

LEAST_SIDE_PX, MOST_SIDE_PX = 6.5, 60.0
"""Sides, root of the area, of panes that are believed in one size of the picture; others show in another."""

NEAR, CORNERS_NEAR = 0.22, 0.35
"""Votes whose middles and corners differ by less, as shares of the pane's side, are for the same pane."""

LEAST_SHARE = 0.3
"""Of a pane's seen area that must agree on it."""

LEAST_PLACES = 3

LEAST_DENSITY = 0.2
"""Of a pane's places whose votes must meet nearly in one point for it to be looked at."""


@dataclass(frozen=True, slots=True, eq=False)
class Pane:
    """A pane in a photo.

    Parameters
    ----------
    corners_px
        Shape (4, 2): lower left, lower right, upper right, upper left; beyond the picture where it cuts the pane.
    share
        Of the places on it that name these corners, each counted by its probability, 0 to 1.
    scatter
        Median distance of the corners that are named from these, as a share of the pane's side.
    sigma_px
        Standard deviation of a corner, pixels of the photo.
    confidence
        How probably it is there, 0 to 1, from `confidence`.
    """

    corners_px: Array
    share: float
    scatter: float
    sigma_px: float
    confidence: float = 1.0


def places_px(height: int, width: int) -> NDArray[np.float32]:
    """Middles of the result's places in the picture, shape (height, width, 2)."""
    x, y = np.meshgrid(np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32))
    return STRIDE * (np.stack([x, y], axis=-1) + np.float32(0.5))


def gathered(probability: NDArray[np.float32], corners_px: NDArray[np.float32], size_px: tuple[int, int]) -> list[Pane]:
    """Panes of one size of a picture of `size_px`, width and height, from `pane_votes`."""
    height, width = probability.shape
    quads, places = corners_px.reshape(-1, 4, 2).astype(float), places_px(height, width).reshape(-1, 2).astype(float)
    weight = probability.reshape(-1).astype(float)
    sides = np.sqrt(np.maximum(signed_areas(quads), 0.0))
    votes = np.nonzero((weight > LEAST_PROBABILITY) & (sides > LEAST_SIDE_PX) & (sides < MOST_SIDE_PX))[0]
    quads, places, weight, sides = quads[votes], places[votes], weight[votes], sides[votes]
    middles = quads.mean(axis=1)
    density = _density(middles, weight, sides)
    order = np.argsort(-density)[: int((density > LEAST_DENSITY).sum())]
    free = np.ones(len(votes), bool)
    panes = []
    for seed in order:
        if not free[seed]:
            continue
        pane, agreeing = _pane_of(seed, quads, places, middles, weight, sides, size_px)
        free[agreeing] = False
        free[seed] = False
        if pane is not None:
            panes.append(pane)
    return panes


def _pane_of(
    seed: int, quads: Array, places: Array, middles: Array, weight: Array, sides: Array, size_px: tuple[int, int]
) -> tuple[Pane | None, NDArray[np.intp]]:
    """The pane that a place names, its corners by all that agree, and those that do."""
    quad, side = quads[seed], float(sides[seed])
    for _ in range(2):
        agreeing = _agreeing(quads, middles, quad, quad.mean(axis=0), NEAR * side, CORNERS_NEAR * side)
        if weight[agreeing].sum() * STRIDE**2 < LEAST_SHARE * seen_area(quad, size_px):
            return None, np.array([seed])
        quad = np.median(quads[agreeing], axis=0)
        side = float(np.sqrt(max(signed_areas(quad[None])[0], 1.0)))
    within = inside(quad, places[agreeing])
    seen = seen_area(quad, size_px) / STRIDE**2
    if within.sum() < LEAST_PLACES or seen < 1.0 or not cv2.isContourConvex(quad.astype(np.float32)):
        return None, agreeing
    share = float(min(1.0, weight[agreeing][within].sum() / seen))
    if share < LEAST_SHARE:
        return None, agreeing
    spread = np.median(np.abs(quads[agreeing] - quad), axis=0)
    scatter = float(spread.mean()) / side
    return Pane(quad.astype(float), share, scatter, 1.5 * float(spread.max()) + 0.01 * side), agreeing


@kernel
def _agreeing(
    quads: Array, middles: Array, quad: Array, middle: Array, reach: float, corners_reach: float
) -> NDArray[np.int64]:
    """Votes whose middle and corners lie within so much of a pane's, the larger of both coordinates."""
    found = np.empty(len(quads), np.int64)
    n = 0
    for i in range(len(quads)):
        if abs(middles[i, 0] - middle[0]) >= reach or abs(middles[i, 1] - middle[1]) >= reach:
            continue
        agrees = True
        for corner in range(4):
            for axis in range(2):
                agrees = agrees and abs(quads[i, corner, axis] - quad[corner, axis]) < corners_reach
        if agrees:
            found[n] = i
            n += 1
    return found[:n].copy()


def _density(middles: Array, weight: Array, sides: Array) -> Array:
    """How many votes meet at each vote's middle, as a share of the pane's places, shape (n,)."""
    if len(middles) == 0:
        return np.empty(0)
    low = middles.min(axis=0)
    cells = ((middles - low) / STRIDE).astype(int)
    total = np.zeros(cells.max(axis=0)[::-1] + 3, np.float32)
    np.add.at(total, (cells[:, 1] + 1, cells[:, 0] + 1), weight)
    total = np.asarray(cv2.blur(total, (3, 3), borderType=cv2.BORDER_CONSTANT), np.float32) * 9.0
    return np.asarray(np.minimum(total[cells[:, 1] + 1, cells[:, 0] + 1] * STRIDE**2 / sides**2, 1.0) * weight)


def signed_areas(quads: Array) -> Array:
    """Areas, positive for corners from the lower left one counter-clockwise as seen (y downwards), shape (n,)."""
    x, y = quads[..., 0], quads[..., 1]
    return np.asarray(0.5 * (np.roll(x, -1, axis=-1) * y - x * np.roll(y, -1, axis=-1)).sum(axis=-1))


def inside(quad: Array, points: Array) -> NDArray[np.bool_]:
    """Which points, shape (n, 2), lie within a convex quadrilateral."""
    sides = np.roll(quad, -1, axis=0) - quad
    to_points = points[:, None] - quad[None]
    return np.asarray((sides[:, 0] * to_points[..., 1] - sides[:, 1] * to_points[..., 0] <= 0.0).all(axis=1))


def seen_area(quad: Array, size_px: tuple[int, int]) -> float:
    """Of a convex quadrilateral within the picture, px²."""
    width, height = size_px
    frame = np.array([[0, 0], [width, 0], [width, height], [0, height]], np.float32)
    area, _ = cv2.intersectConvexConvex(quad.astype(np.float32), frame)
    return float(area)


def weighted_median(values: Array, weight: Array) -> float:
    """The value, shape (n,), below which half of the weight lies."""
    order = np.argsort(values)
    share = np.cumsum(weight[order])
    return float(values[order][np.searchsorted(share, 0.5 * share[-1])])
