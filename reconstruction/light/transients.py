"""Transients: parts of photos that other photos of the same place contradict, as people, vehicles and clouds are.

Photos are divided into blocks. The error of a block is that of its mean colour: fine frames that a model does not
resolve cancel out in it, somebody who walked by does not. It is compared with the errors of blocks of all photos at the
same place of the scene: what is hard to learn errs in every photo, what only one photo shows in that one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, median

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

LEAST_LOOKS = 6
"""Blocks at a place that tell what is usual there."""

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
    tolerance: float = 0.4

    def assess(self, scene: Seen) -> Assessment:
        """How much of the photos that is."""
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


def transients(errors: Array, places: Numbers) -> NDArray[np.bool_]:
    """Which blocks err far more than others at the same place.

    What counts as usual is the median of the place. It is no less than half of all blocks err by, or good looks would
    make all others transients. Where few blocks show a place it is no more than three quarters err by: a place in the
    air that splats were put to for a transient is shown by that alone.

    Parameters
    ----------
    errors
        Of blocks, shape (n,).
    places
        Where in the scene they are, any numbers, shape (n,).
    """
    if not len(errors):
        return np.zeros(0, np.bool_)
    which, numbers, counts = np.unique(places, return_inverse=True, return_counts=True)
    usual = np.asarray(median(errors, numbers, np.arange(len(which))))[numbers]
    middle, large = np.quantile(errors, (0.5, 0.75))
    usual = np.maximum(np.where(counts[numbers] < LEAST_LOOKS, np.minimum(usual, large), usual), middle)
    return np.asarray(errors > np.maximum(LEAST_ERROR, RATIO * usual))


def share_of_error(errors: Array, are: NDArray[np.bool_]) -> float:
    """Share of the squared errors of blocks that some of them make; 0 without errors."""
    squares = np.square(errors)
    return float(squares[are].sum() / max(float(squares.sum()), 1e-12))


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
    blocks: Blocks, of_values: Numbers, errors: NDArray[np.floating], panels: Numbers
) -> tuple[NDArray[np.bool_], float]:
    """Blocks of photos of glass that are transients, with neighbours, shape (n_blocks,), and their share of the error.

    Parameters
    ----------
    of_values
        Blocks that rays belong to, shape (n,).
    errors
        Found less true sRGB values, shape (n, 3).
    panels
        That rays show, shape (n,).
    """
    found, counts = mean_errors(of_values, errors, len(blocks))
    places = np.zeros(len(blocks), np.int64)
    places[of_values] = panels
    known, are = counts >= LEAST_VALUES, np.zeros(len(blocks), np.bool_)
    are[known] = transients(found[known], places[known])
    return blocks.with_neighbours(are), share_of_error(found[known], are[known])
