"""How high the ground lies by what photos show of it: seen at its own height, it looks alike from everywhere.

Gravel and grass give few points, and those at a building's foot lie on steps and beds. But pixels say where the ground
is: rays of one photo are followed to a level plane, and the places where they meet it are looked at in the next photo.
At the right height both show the same. This is a plane sweep (R. T. Collins, A space-sweep approach to true
multi-image matching, 1996) of one plane whose direction is known. Nothing is seen below the ground, so only heights
below the lowest wide level of the points are tried.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.base.cameras import PosedPhoto

Array = NDArray[np.float64]

PICTURE_PX = 480
"""Longer side of pictures, about, that are compared."""

LOWEST, HIGHEST, STEP = 6.0, 0.9, 1.015
"""Heights of the usual camera above the ground that are tried, as multiples of the expected one, and their ratio."""

N_RAYS = 1500
"""Of each photo."""

LEAST_RAYS = 60
"""Of a pair of photos that both show the ground."""

LEAST_SLOPE = 0.06
"""Of rays: flatter ones meet ground that is seen too finely from one place and not at all from the next."""

CELLS = 24
"""Along each side of a photo, for what points hide."""

HIDDEN = 1.1
"""Times the distance of the nearest point in a cell, from which on ground is hidden there."""

MOST_DIFFERENCE = 0.5
"""Of logarithms of light: more is something that moved, or hides the ground."""

MOST_PAIRS = 40

LEAST_PAIRS, LEAST_LEVELS = 4, 20

AGREED, WITHIN = 0.5, 1.08
"""Share of pairs of photos whose own best height is this near to the best of all; by chance it is a twelfth."""

CLEARER = 0.6
"""What differs at the best height has to be less than this part of what differs at the usual one: ground that
slopes by 4 degrees and more is level nowhere."""


def level_of_ground(
    photos: Sequence[PosedPhoto],
    picture: Callable[[PosedPhoto], NDArray[np.uint8]],
    points: Array,
    expected_z: float,
    seed: int = 0,
    monitor: Monitor = QUIET,
) -> float | None:
    """Height of the level ground that photos agree on; None where they do not.

    Parameters
    ----------
    photos
        In a frame whose z is up, of any unit.
    picture
        Of a photo, grey, reduced to any size.
    points
        That hide what is behind them, shape (n, 3).
    expected_z
        The lowest wide level of points: the ground is there or lower.
    """
    centres = np.array([photo.pose.position_enu_m for photo in photos])
    height = float(np.median(centres[:, 2])) - expected_z
    if len(photos) < 2 or height <= 0.0:
        return None
    n_levels = int(np.log(LOWEST / HIGHEST) / np.log(STEP)) + 1
    factors = HIGHEST * STEP ** np.arange(n_levels)
    levels = float(np.median(centres[:, 2])) - height * factors
    shown: dict[int, _Shown] = {}
    pairs = list(_pairs(centres))
    curves = []
    for done, pair in enumerate(pairs):
        monitor.report(say("finding the ground"), done, len(pairs))
        for number in pair:
            if number not in shown:
                shown[number] = _Shown(photos[number], picture(photos[number]), points, seed + number)
        one, other = (shown[number] for number in pair)
        curve = np.array([one.difference(other, level) for level in levels])
        if np.isfinite(curve).sum() >= LEAST_LEVELS:
            curves.append(curve / np.nanmedian(curve))
    seen = np.flatnonzero(np.isfinite(np.reshape(curves, (-1, n_levels))).sum(axis=0) >= LEAST_PAIRS)
    if len(seen) < LEAST_LEVELS:
        return None
    together = np.nanmean(np.array(curves)[:, seen], axis=0)
    best = int(np.argmin(together))
    own = factors[np.nanargmin(curves, axis=1)]
    agree = np.abs(np.log(own / factors[seen[best]])) <= np.log(WITHIN)
    is_inside = 0 < best < len(seen) - 1
    if not is_inside or agree.mean() < AGREED or together[best] > CLEARER:
        return None
    left, middle, right = together[best - 1 : best + 2]
    shift = 0.5 * (left - right) / max(left - 2.0 * middle + right, 1e-12)
    return float(np.median(centres[:, 2])) - height * HIGHEST * float(STEP ** (seen[best] + np.clip(shift, -0.5, 0.5)))


def _pairs(centres: Array) -> Iterator[tuple[int, int]]:
    """Photos with the two nearest to each, evenly chosen."""
    found = []
    for one, centre in enumerate(centres):
        distances = np.linalg.norm(centres - centre, axis=1)
        found += [(one, int(other)) for other in np.argsort(distances)[1:3]]
    chosen = np.unique(np.linspace(0, len(found) - 1, min(MOST_PAIRS, len(found))).round().astype(int))
    yield from (found[number] for number in chosen)


class _Shown:
    """A photo, and rays that may meet the ground."""

    def __init__(self, photo: PosedPhoto, picture: NDArray[np.uint8], points: Array, seed: int) -> None:
        height, width = picture.shape
        self._photo = photo
        self._scale = np.array([width, height]) / (photo.intrinsics.width_px, photo.intrinsics.height_px)
        self._light = cv2.GaussianBlur(np.log(picture.astype(np.float32) + 10.0), (0, 0), 1.0)
        size = np.array([photo.intrinsics.width_px, photo.intrinsics.height_px], float)
        pixels = np.random.default_rng(seed).random((N_RAYS, 2)) * size
        origins, rays = photo.rays(pixels)
        free = _free(photo, points, pixels, size)
        down = rays[:, 2] < -LEAST_SLOPE
        self._pixels, self._origins, self._rays, self._free = pixels[down], origins[down], rays[down], free[down]

    def difference(self, other: _Shown, level: float) -> float:
        """Mean difference of light on the plane at that height; NaN where too little of it is seen by both."""
        distances = (level - self._origins[:, 2]) / self._rays[:, 2]
        met = np.flatnonzero((distances > 0.0) & (distances < self._free))
        places = self._origins[met] + distances[met, None] * self._rays[met]
        there = other._photo.sees(places)
        if there.sum() < LEAST_RAYS:
            return float("nan")
        difference = self._at(self._pixels[met[there]]) - other._at(other._photo.pixels(places[there]))
        difference -= np.median(difference)
        return float(np.minimum(np.abs(difference), MOST_DIFFERENCE).mean())

    def _at(self, pixels: Array) -> Array:
        x, y = (self._scale * pixels - 0.5).astype(np.float32).T
        found = cv2.remap(self._light, x[:, None], y[:, None], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(found[:, 0], np.float64)


def _free(photo: PosedPhoto, points: Array, pixels: Array, size: Array) -> Array:
    """How far rays go before a point is near them, shape (n,); infinite where none is."""
    nearest = np.full((CELLS + 2, CELLS + 2), np.inf)
    seen = points[photo.sees(points)] if len(points) else points
    if len(seen):
        x, y = np.minimum((CELLS * photo.pixels(seen) / size).astype(int), CELLS - 1).T + 1
        np.minimum.at(nearest, (y, x), np.linalg.norm(seen - photo.pose.position_enu_m, axis=1))
    beside = [nearest[i : i + CELLS, j : j + CELLS] for i in range(3) for j in range(3)]
    x, y = np.minimum((CELLS * pixels / size).astype(int), CELLS - 1).T
    return np.asarray(HIDDEN * np.min(beside, axis=0)[y, x])
