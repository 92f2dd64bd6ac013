"""Panes from what the network says at each place: places that name the same four corners are one pane.

A picture is looked at in several sizes, because the network knows panes of 8 to 48 pixels. In each size the places
that say they lie on a pane are gathered by the middle of the corners they name; where many meet, there is a pane, its
corners the median of what they name. How probably it is there is weighed in `belief`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.panels.rectify.surface import Rectification

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]

STRIDE = 4
"""Pixels of the picture per place of the network's result."""

LONG_SIDES_PX = (64, 96, 144, 216, 324, 486, 729, 1094)
"""Sizes in which a picture is looked at, those above its own and the parameters' limit left out."""

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
        How probably it is there, 0 to 1: `belief` tells.
    """

    corners_px: Array
    share: float
    scatter: float
    sigma_px: float
    confidence: float = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """What the network says of one size of a photo.

    Parameters
    ----------
    size_px
        Width and height in which it was looked at.
    scale
        Pixels of that size per pixel of the photo.
    probability
        Shape (h, w): that a place lies on a pane.
    corners_px
        Shape (h, w, 4, 2), in that size: where that pane's corners are.
    """

    size_px: tuple[int, int]
    scale: float
    probability: NDArray[np.float32]
    corners_px: NDArray[np.float32]

    def panes(self) -> list[Pane]:
        """All that places agree on, in the photo, whatever other sizes show."""
        found = gathered(self.probability, self.corners_px, self.size_px)
        return [
            replace(pane, corners_px=pane.corners_px / self.scale, sigma_px=pane.sigma_px / self.scale)
            for pane in found
        ]


@dataclass(frozen=True, slots=True, eq=False)
class Looks:
    """What the network says of a photo, by the longer side in which it was looked at, px."""

    by_size: Mapping[int, Look] = field(default_factory=dict)

    def probability_at(self, points_px: Array) -> Array:
        """How probably places of the photo, shape (n, 2), lie on a pane, shape (n,): by the size that says it most."""
        best = np.zeros(len(points_px))
        for look in self.by_size.values():
            last = np.array(look.probability.shape[::-1]) - 1
            column, row = np.clip(points_px * look.scale / STRIDE, 0, last).astype(int).T
            best = np.maximum(best, look.probability[row, column])
        return best


@dataclass(frozen=True, slots=True, eq=False)
class FoundPanes:
    """Panes of a photo, none of which covers another, the most probable first, and what they were found in."""

    panes: tuple[Pane, ...]
    looks: Looks = field(default_factory=Looks)

    def within(self, view: Rectification) -> FoundPanes:
        """Only the panes whose middle a rectified view shows, from its front."""
        if not self.panes:
            return self
        middles = view.to_rectified(np.stack([pane.corners_px.mean(axis=0) for pane in self.panes]))
        corners = view.to_rectified(np.concatenate([pane.corners_px for pane in self.panes])).reshape(-1, 4, 2)
        shown = (middles >= 0.0).all(axis=1) & (middles <= [view.width_px, view.height_px]).all(axis=1)
        shown &= np.isfinite(corners).all(axis=(1, 2)) & (signed_areas(corners) > 0.0)
        return FoundPanes(tuple(pane for pane, is_in in zip(self.panes, shown, strict=True) if is_in), self.looks)


def look_at(image: Picture, long_side_px: int, seen: Looks | None = None, monitor: Monitor = QUIET) -> Looks:
    """Look at a photo, shape (h, w, 3), blue, green, red, in sizes up to `long_side_px`.

    Parameters
    ----------
    seen
        What smaller sizes of the same photo showed: they are not looked at again.
    """
    from reconstruction.panels.network.network import pane_votes  # torch is heavy, and not always wanted

    longest = max(image.shape[:2])
    most = min(long_side_px, longest, LONG_SIDES_PX[-1])
    looks = {} if seen is None else dict(seen.by_size)
    sizes = sorted({min(size, most) for size in LONG_SIDES_PX} - set(looks))
    for number, size in enumerate(sizes):
        monitor.report(say("look for panes"), number, len(sizes))
        scale = size / longest
        width, height = max(1, round(image.shape[1] * scale)), max(1, round(image.shape[0] * scale))
        smaller = np.asarray(cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA), np.uint8)
        looks[size] = Look((width, height), scale, *pane_votes(smaller))
    return Looks(looks)


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
