"""Transients: parts of photos that other photos of the same place contradict, as people, vehicles and clouds are.

Photos are divided into blocks. The error of a block is that of its mean colour: fine frames that a model does not
resolve cancel out in it, somebody who walked by does not. It is compared with the errors of blocks of all photos at the
same place of the scene: what is hard to learn errs in every photo, what only one photo shows in that one.

Whether there are transients at all is told by less: by places that several photos show, by errors beyond what is usual
in the place and in the photo, and without the photo that errs most, whose pose may be wrong.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from planning.base.effects import Assessment
from planning.base.messages import say

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]

BLOCK_PX, MOST_BLOCKS = 8, 64
"""Side of a block, at least, and blocks along the longer side of a photo, at most."""

RATIO, LEAST_ERROR = 3.0, 0.03
"""A transient's error is more than so many times the usual one at its place, and more than so much, of 0 to 1."""

TRIED = 0.4
"""Share of a training after which transients are looked for: before, all places err."""

COST = 0.03
"""Share of a training's time that looking for them takes."""

UNSEEN = -1.0
"""Of a share or an error that is not known, or not yet."""

LEAST_PHOTOS = 6
"""Of a place, that tell what is usual there."""

USUAL = 0.75
"""Share of a place's blocks, and of a photo's, that do not err by more than what counts as usual for evidence."""

SEEN_WELL = 0.75
"""Share of the blocks that are to lie at places of enough photos."""

FINEST, COARSEST, N_SIDES = 1.0 / 256.0, 1.0 / 8.0, 11
"""Sides of places, of the scene's: the first is taken with which so many do."""

FAR = 1e6
"""Places: what is further is the sky."""

LEAST_VALUES = 8
"""That the error of a block is told by: means of fewer are mostly noise."""


@dataclass(frozen=True, slots=True)
class Seen:
    """What was found: share of the error that transients make, or `UNSEEN`, and seconds that leaving them out costs."""

    share: float
    cost_s: float


@dataclass(frozen=True, slots=True)
class LeaveTransientsOut:
    """Leave out of photos what others contradict."""

    name: str = say("what only single photos show")
    unit: str = say("share of the error")
    tolerance: float = 0.2

    def assess(self, scene: Seen) -> Assessment:
        """How much of the photos that is: synthetic ones have 0.02, with passers-by 0.38; those of a real wall 0.11."""
        if scene.share == UNSEEN:
            return Assessment(0.0, say("it was not looked for"), scene.cost_s)
        return Assessment(
            scene.share,
            say("{:.0f} % of the error is where one photo contradicts the others", 100.0 * scene.share),
            scene.cost_s,
        )


class Blocks:
    """How photos are divided: blocks of all photos are numbered one after the other, row by row.

    Parameters
    ----------
    sizes_px
        Width and height of each photo, shape (p, 2).
    """

    def __init__(self, sizes_px: Sequence[tuple[int, int]]) -> None:
        sizes = np.array(sizes_px, np.int64).reshape(-1, 2)
        self.sides_px = np.maximum(BLOCK_PX, -(-sizes.max(axis=1) // MOST_BLOCKS))
        self.shapes = -(-sizes[:, ::-1] // self.sides_px[:, None])
        self.starts = np.concatenate([[0], np.cumsum(self.shapes.prod(axis=1))])
        self.photos = np.repeat(np.arange(len(sizes)), np.diff(self.starts))

    def __len__(self) -> int:
        return int(self.starts[-1])

    def at(self, photos: Numbers, columns: Numbers, rows: Numbers) -> Numbers:
        """Blocks that pixels of photos lie in."""
        sides = self.sides_px[photos]
        return np.asarray(self.starts[photos] + rows // sides * self.shapes[photos, 1] + columns // sides)

    def of_window(self, photo: int, x_px: int, y_px: int, width_px: int, height_px: int) -> Numbers:
        """Blocks of the pixels of a window, shape (h, w)."""
        rows, columns = np.arange(height_px) + y_px, np.arange(width_px) + x_px
        return self.at(np.array([photo]), columns[None, :], rows[:, None])

    def with_neighbours(self, are: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Some blocks, and those above, below and beside them: transients end within blocks."""
        found = np.empty_like(are)
        for shape, first, last in zip(self.shapes, self.starts[:-1], self.starts[1:], strict=True):
            found[first:last] = binary_dilation(are[first:last].reshape(shape)).ravel()
        return found


def places_of(points: Array, kinds: Numbers, photos: Numbers) -> Numbers:
    """Places of the scene, as numbers: cubes as small as may be that still several photos show.

    Parameters
    ----------
    points
        That blocks show, shape (n, 3), in any unit.
    kinds
        Of surfaces, shape (n,): where they differ, so do places.
    photos
        Of the blocks, shape (n,).
    """
    if not len(points):
        return np.zeros(0, np.int64)
    low, high = np.quantile(points, (0.05, 0.95), axis=0)
    size, found = max(float((high - low).max()), 1e-9), np.zeros(len(points), np.int64)
    for side in np.geomspace(FINEST, COARSEST, N_SIDES):
        cubes = np.floor(np.clip((points - low) / (side * size), -FAR, FAR)).astype(np.int64)
        _, found = np.unique(np.column_stack([cubes, kinds]), axis=0, return_inverse=True)
        found = found.ravel()
        if (_n_photos(found, photos)[found] >= LEAST_PHOTOS).mean() >= SEEN_WELL:
            break
    return found


def transients(errors: Array, places: Numbers, photos: Numbers) -> NDArray[np.bool_]:
    """Which blocks err far more than others at the same place.

    What counts as usual is the median of the place. It is no less than half of all blocks err by, or good looks would
    make all others transients. Where few photos show a place it is no more than three quarters err by: a place in the
    air that splats were put to for a transient is shown by that alone.

    Parameters
    ----------
    errors
        Of blocks, shape (n,).
    places
        Where in the scene they are, any numbers, shape (n,).
    photos
        That they are of, shape (n,).
    """
    if not len(errors):
        return np.zeros(0, np.bool_)
    numbers, usual = _at_places(errors, places, 0.5)
    middle, large = np.quantile(errors, (0.5, USUAL))
    is_told = _n_photos(numbers, photos)[numbers] >= LEAST_PHOTOS
    usual = np.maximum(np.where(is_told, usual, np.minimum(usual, large)), middle)
    return np.asarray(errors > np.maximum(LEAST_ERROR, RATIO * usual))


def evidence(errors: Array, places: Numbers, photos: Numbers) -> float:
    """Share of the squared errors that is surely of transients, 0 to 1.

    Of places that several photos show, blocks count that err far more than three quarters of those of the place, and of
    those of the photo, do. The photo with the most of that is left out: one with a wrong pose contradicts all others.
    """
    if not len(errors):
        return 0.0
    numbers, of_place = _at_places(errors, places, USUAL)
    of_which, of_photo = _at_places(errors, photos, USUAL)
    usual = np.maximum(np.maximum(of_place, of_photo), np.median(errors))
    is_told = _n_photos(numbers, photos)[numbers] >= LEAST_PHOTOS
    are = is_told & (errors > np.maximum(LEAST_ERROR, RATIO * usual))
    squares = np.square(errors)
    by_photo = np.bincount(of_which, np.where(are, squares, 0.0))
    return float((by_photo.sum() - by_photo.max()) / max(float(squares[is_told].sum()), 1e-12))


def _at_places(errors: Array, places: Numbers, share: float) -> tuple[Numbers, Array]:
    """Numbers of places from 0 on, and what a share of all that is at the same place is no larger than; shape (n,)."""
    _, numbers, counts = np.unique(places, return_inverse=True, return_counts=True)
    order = np.lexsort((errors, numbers))
    at = np.cumsum(counts) - counts + np.rint(share * (counts - 1)).astype(np.int64)
    return numbers, errors[order][at][numbers]


def _n_photos(numbers: Numbers, photos: Numbers) -> Numbers:
    """Of each place, how many photos show it."""
    n = int(photos.max()) + 1
    return np.bincount(np.unique(numbers * n + photos) // n, minlength=int(numbers.max()) + 1)


def mean_errors(blocks: Numbers, errors: NDArray[np.floating], n_blocks: int) -> tuple[Array, Numbers]:
    """Errors of blocks, shape (n_blocks,), by signed errors of values in them, and numbers of values.

    Parameters
    ----------
    blocks
        Of each value, shape (n,).
    errors
        Found less true sRGB values, shape (n, 3).
    """
    counts = np.bincount(blocks, minlength=n_blocks)
    sums = np.stack([np.bincount(blocks, errors[:, channel], minlength=n_blocks) for channel in range(3)])
    return np.abs(sums).mean(axis=0) / np.maximum(counts, 1), counts


def transient_blocks(
    blocks: Blocks, of_values: Numbers, errors: NDArray[np.floating], points: Array
) -> tuple[NDArray[np.bool_], float]:
    """Blocks of photos of glass that are transients, with neighbours, shape (n_blocks,), and the evidence for any.

    Parameters
    ----------
    of_values
        Blocks that rays belong to, shape (n,).
    errors
        Found less true sRGB values, shape (n, 3).
    points
        On glass that rays show, shape (n, 3).
    """
    found, counts = mean_errors(of_values, errors, len(blocks))
    known = np.flatnonzero(counts >= LEAST_VALUES)
    sums = [np.bincount(of_values, points[:, axis], minlength=len(blocks))[known] for axis in range(3)]
    photos = blocks.photos[known]
    places = places_of(np.stack(sums, axis=1) / counts[known, None], np.zeros(len(known), np.int64), photos)
    are = np.zeros(len(blocks), np.bool_)
    are[known] = transients(found[known], places, photos)
    return blocks.with_neighbours(are), evidence(found[known], places, photos)
