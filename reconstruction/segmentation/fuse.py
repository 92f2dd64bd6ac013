"""One picture of a facade from several photos: reflections differ from view to view, frames do not.

The median of what several rectified views show at a pixel keeps what most of them agree on. A frame is there in every
view; a mirror image lies somewhere else in each. Views differ in exposure, so each is first brought to the brightness
of the first one by a gain and an offset that most pixels agree on.

What it is for: facades whose frames are hardly seen in one photo (docs/segmentation.md has the figures). Where one
photo shows the grid, its edges are sharper than those of several laid on one another.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from planning.errors import InputError
from planning.jit import chunks, run_chunks

Grey = NDArray[np.uint8]

ROWS_AT_ONCE = 256
"""Bounds the memory of the median: a dozen views of 4000 columns take 48 MB."""

LEAST_OVERLAP = 400
"""Pixels in common that the brightness of two views can be compared by."""

USUAL_RANGE = (0.4, 2.5)
"""Gains outside this are no exposure: the views show different things, and brightness is left alone."""


def fused(pictures: Sequence[Grey], valid: Sequence[NDArray[np.bool_]]) -> tuple[Grey, NDArray[np.bool_]]:
    """Median over views, and where any of them shows something.

    Parameters
    ----------
    pictures
        Grey rectified views of one size, shape (h, w), of the same window of the facade.
    valid
        Where each shows something, shape (h, w).

    Raises
    ------
    InputError
        No views, or views of different sizes.
    """
    if not pictures:
        raise InputError("fusing views: expected at least one rectified view, found none")
    shapes = {picture.shape for picture in pictures} | {mask.shape for mask in valid}
    if len(shapes) > 1 or len(valid) != len(pictures):
        raise InputError(
            f"fusing views: expected rectified views of one size with a mask each, found sizes {sorted(shapes)}; "
            "rectify them all onto the same window of the facade"
        )
    if len(pictures) == 1:
        return pictures[0], valid[0]
    levels = [_level(picture, mask, pictures[0], valid[0]) for picture, mask in zip(pictures, valid, strict=True)]
    height, width = pictures[0].shape
    result = np.zeros((height, width), np.uint8)

    def work(start: int, stop: int) -> None:
        stack = np.stack(
            [
                np.where(mask[start:stop], gain * picture[start:stop].astype(np.float32) + offset, np.nan)
                for picture, mask, (gain, offset) in zip(pictures, valid, levels, strict=True)
            ]
        ).astype(np.float32)
        result[start:stop] = np.clip(np.rint(_median_of_known(stack)), 0, 255).astype(np.uint8)

    run_chunks(work, chunks(height, ROWS_AT_ONCE))
    return result, np.any(valid, axis=0)


def _median_of_known(stack: NDArray[np.float32]) -> NDArray[np.float32]:
    """Median over the first axis without the NaN, 0 where there is nothing else."""
    ordered = np.sort(stack, axis=0)  # NaN go last
    known = np.isfinite(ordered).sum(axis=0)
    low, high = np.maximum(known - 1, 0) // 2, known // 2
    high = np.minimum(high, np.maximum(known - 1, 0))
    pair = np.take_along_axis(ordered, np.stack([low, high]), axis=0)
    return np.asarray(np.where(known > 0, 0.5 * (pair[0] + pair[1]), 0.0), np.float32)


def _level(picture: Grey, mask: NDArray[np.bool_], first: Grey, first_mask: NDArray[np.bool_]) -> tuple[float, float]:
    """Gain and offset that bring a view's quartiles to those of the first one, over what both show."""
    both = mask & first_mask
    if both.sum() < LEAST_OVERLAP:
        return 1.0, 0.0
    a, b = np.quantile(picture[both], [0.25, 0.5, 0.75]), np.quantile(first[both], [0.25, 0.5, 0.75])
    gain = float((b[2] - b[0]) / (a[2] - a[0])) if a[2] > a[0] else 1.0
    if not USUAL_RANGE[0] <= gain <= USUAL_RANGE[1]:
        return 1.0, 0.0
    return gain, float(b[1] - gain * a[1])
