"""Where a frame profile really begins and ends, from how the picture across it follows the glass beside it.

The steepest places of a blurred picture lie outside of a profile only two or three pixels wide, by up to a pixel: two
opposite edges push each other apart. What does not move under blur is the sum of a row of pixels across the profile.
For a profile of one colour F from a to b, in a window from -T to T around it, with glass of brightness L before it and
R behind it,

    sum = (a + T) L + F (b - a) + (T - b) R.

L and R differ from row to row, because glass mirrors something else everywhere, while a, b and F (b - a) stay: the
slopes of a linear regression over the rows are the lengths of glass inside the window, whatever F and the blur are.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Picture = NDArray[np.float32]

MARGIN_PX = 2.5
"""Glass on both sides inside the window: the blur of a photo (1 px) fades within it."""

BESIDE_PX = 2
"""Width of the strips of glass that L and R are taken from."""

PRIOR_SIGMA_PX = 0.6
"""Of the edges as the gradient shows them; decides where glass is too even for the regression."""

ROUNDS = 5
OUTLIER = 4.7
"""Residuals beyond so many standard deviations have no weight (Tukey's biweight)."""

SAME_WIDTH_PX = 0.8
LEAST_ALIKE = 3
"""Profiles of one width, to this tolerance, that tell their common bias."""

MOST_BIAS_PX = 2.0
"""Two edges push each other apart by twice the blur at most, and the blur of photos is about a pixel."""

LEAST_ROWS = 12

BLOCK_ROWS = 40
"""Rows that are compared with one another only: less than a panel's height, more than a few reflected edges."""


def unbiased_edges(edges_px: Array, regressed_px: Array) -> Array:
    """Edges of profiles, shape (n, 2), without the bias of their blur.

    One profile's regression is good to half a pixel, its gradients to a tenth but with a bias that all profiles of its
    width share. So the bias is the median over those, and every profile keeps its own middle.

    Parameters
    ----------
    edges_px
        Shape (n, 2): start and end of each profile as its gradients show them.
    regressed_px
        Shape (n,): widths from `regressed_width`, NaN where not known.
    """
    widths = edges_px[:, 1] - edges_px[:, 0]
    bias = widths - regressed_px
    known = np.isfinite(bias) & (widths > 0.0)
    corrected = edges_px.copy()
    for index in np.nonzero(widths > 0.0)[0]:
        alike = known & (np.abs(widths - widths[index]) <= SAME_WIDTH_PX)
        if alike.sum() >= LEAST_ALIKE:
            shrink = float(np.clip(np.median(bias[alike]), 0.0, min(MOST_BIAS_PX, widths[index]))) / 2.0
            corrected[index] += [shrink, -shrink]
    return corrected


def regressed_width(picture: Picture, first_px: float, last_px: float, rows: slice) -> float:
    """Width of the vertical profile near `first_px` to `last_px`, NaN where the picture does not tell."""
    start, stop = round(first_px - MARGIN_PX), round(last_px + MARGIN_PX)
    if start - BESIDE_PX < 0 or stop + BESIDE_PX > picture.shape[1]:
        return float("nan")
    strip = picture[rows, start - BESIDE_PX : stop + BESIDE_PX].astype(np.float64)
    if strip.shape[0] < LEAST_ROWS:
        return float("nan")
    left, right = strip[:, :BESIDE_PX].mean(axis=1), strip[:, -BESIDE_PX:].mean(axis=1)
    sums = strip[:, BESIDE_PX:-BESIDE_PX].sum(axis=1)
    values = _less_block_means(np.column_stack([left, right, sums]))
    glass = _robust_slopes(values[:, :2], values[:, 2], np.array([first_px - start, stop - last_px]))
    return float(stop - start - glass.sum())


def _less_block_means(values: Array) -> Array:
    """Columns less the mean of their block of rows: F differs where a shadow falls, but hardly within a block."""
    borders = np.arange(0, values.shape[0], BLOCK_ROWS)
    counts = np.diff(np.append(borders, values.shape[0]))
    means = np.add.reduceat(values, borders, axis=0) / counts[:, None]
    return np.asarray(values - np.repeat(means, counts, axis=0))


def _robust_slopes(design: Array, values: Array, prior: Array) -> Array:
    """Slopes, shape (2,), by iteratively reweighted least squares with a prior that decides where glass is even."""
    weights = np.ones_like(values)
    found = prior
    for _ in range(ROUNDS):
        residuals = values - design @ found
        spread = max(1.4826 * float(np.median(np.abs(residuals))), 0.5)
        off = residuals / (OUTLIER * spread)
        weights = np.where(np.abs(off) < 1.0, (1.0 - off * off) ** 2, 0.0) + 1e-9
        weighted = (design * weights[:, None]).T / spread**2
        pull = np.eye(2) / PRIOR_SIGMA_PX**2
        found = np.asarray(np.linalg.solve(weighted @ design + pull, weighted @ values + pull @ prior), float)
    return found
