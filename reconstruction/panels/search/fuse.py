"""Several views of one facade searched as one: reflections differ from view to view, frames do not.

Every row of the edges is taken from another view in turn, of those that show the place. Support along a line is a share
of its rows, so that a frame, which all views have in the same place, keeps its support, and a mirror image, which lies
elsewhere in each, is left with the share of one view. The median of the pictures themselves does less: where mirror
images of several views cross, it makes edges that no view has, and faint frames do not come out any clearer
(docs/concepts/segmentation.md has the figures).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from reconstruction.panels.search.edges import EdgeMap
from reconstruction.panels.search.grid import Axes, Axis
from reconstruction.panels.search.parameters import SegmentationParameters

Grey = NDArray[np.uint8]
Mask = NDArray[np.bool_]

LEAST_OVERLAP = 400
"""Pixels in common that the brightness of two views can be compared by."""

USUAL_RANGE = (0.4, 2.5)
"""Gains outside this are no exposure: the views show different things, and brightness is left alone."""


def fused(pictures: Sequence[Grey], valid: Sequence[Mask], parameters: SegmentationParameters) -> Axes:
    """Edges of several views as of one picture.

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
    first, first_mask = pictures[0], valid[0]
    views = [
        Axes.of(_levelled(picture, mask, first, first_mask), mask, parameters)
        for picture, mask in zip(pictures, valid, strict=True)
    ]
    shown, turned = np.stack(valid), np.stack([mask.T for mask in valid])
    down = _in_turn([view.down for view in views], shown, parameters.n_bands)
    return Axes(down, _in_turn([view.across for view in views], turned, parameters.n_bands))


def _in_turn(axes: Sequence[Axis], shown: Mask, n_bands: int) -> Axis:
    """One axis whose rows are of all axes in turn; `shown` is where each of them shows something, shape (n, h, w)."""
    so_far = shown.cumsum(axis=0, dtype=np.uint8)
    turn = np.arange(shown.shape[1])[:, None] % np.maximum(so_far[-1], 1)
    which = (so_far > turn).argmax(axis=0)[None]

    is_edge, offset_px, picture = (
        np.take_along_axis(np.stack(layers), which, axis=0)[0]
        for layers in (
            [axis.edges.is_edge for axis in axes],
            [axis.edges.offset_px for axis in axes],
            [axis.picture for axis in axes],
        )
    )
    return Axis.of(picture, EdgeMap(is_edge, offset_px), n_bands)


def _levelled(picture: Grey, mask: Mask, first: Grey, first_mask: Mask) -> Grey:
    """A view with the quartiles of the first one, over what both show: exposures differ."""
    both = mask & first_mask
    if both.sum() < LEAST_OVERLAP:
        return picture
    a, b = np.quantile(picture[both], [0.25, 0.5, 0.75]), np.quantile(first[both], [0.25, 0.5, 0.75])
    gain = float((b[2] - b[0]) / (a[2] - a[0])) if a[2] > a[0] else 1.0
    if not USUAL_RANGE[0] <= gain <= USUAL_RANGE[1]:
        return picture
    levelled = gain * (picture.astype(np.float32) - a[1]) + b[1]
    return np.asarray(np.clip(np.rint(levelled), 0, 255), np.uint8)
