"""Structural similarity of two pictures and its gradient by rows: compiled, in double precision inside.

The window is separable, so a row of means is made by adding up weighted rows and then shifted copies of the sum; inner
loops run along the picture's rows, which compilers turn into vector instructions.
"""

from __future__ import annotations

import math
from functools import partial as bound
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks, kernel, run_chunks
from reconstruction.metrics.image_metrics import C1, C2, WINDOW_PX, window_weights

Array = NDArray[np.float64]

BAND_ROWS = 256
"""Rows that a thread does at once: 5 ms of work at 256 columns, against 0.1 ms to start threads."""


def dissimilarity(
    found: NDArray[Any], truth: NDArray[Any], channels: int, with_gradient: bool
) -> tuple[float, Array | None]:
    """1 less the mean structural similarity, and its gradient by `found` where it is wanted.

    Parameters
    ----------
    found, truth
        Shape (h, w * channels), h and w `WINDOW_PX` or more.
    """
    found, truth = np.ascontiguousarray(found, np.float64), np.ascontiguousarray(truth, np.float64)
    weights = window_weights()
    (height, width), n_rows = found.shape, len(found) - WINDOW_PX + 1
    sums = np.empty(n_rows)
    partial = np.empty((n_rows, 3, width) if with_gradient else (0, 3, 0))
    similar = bound(similarity_rows, found, truth, weights, channels, C1, C2)
    run_chunks(lambda start, stop: similar(start, stop, sums, partial), chunks(n_rows, BAND_ROWS))
    n_windows = n_rows * (width - (WINDOW_PX - 1) * channels)
    value = 1.0 - math.fsum(sums) / n_windows
    if not with_gradient:
        return value, None
    gradient = np.empty_like(found)
    spread = bound(gradient_rows, found, truth, weights, partial, -1.0 / n_windows)
    run_chunks(lambda start, stop: spread(start, stop, gradient), chunks(height, BAND_ROWS))
    return value, gradient


@kernel
def similarity_rows(
    found: Array,
    truth: Array,
    weights: Array,
    channels: int,
    c1: float,
    c2: float,
    start: int,
    stop: int,
    sums: Array,
    partial: Array,
) -> None:
    """Similarity summed over each row of windows, and what its gradient is made of.

    With a = found, b = truth, and E the mean over a window, similarity is a function of E a, E aa and E ab. Its
    derivatives by these three are spread back along the row to the pixels they depend on; along the columns that is
    left to `gradient_rows`, because it takes rows of other bands.

    Parameters
    ----------
    found, truth
        Shape (h, w * channels).
    weights
        Of the window, shape (k,), adding up to 1.
    c1, c2
        Constants of the index.
    start, stop
        Rows of windows: the first one covers the picture's rows 0 to k - 1.
    sums
        Written, shape (h - k + 1,).
    partial
        Written, shape (h - k + 1, 3, w * channels); shape (0, 3, 0) where no gradient is wanted.
    """
    size = len(weights)
    width = found.shape[1]
    inner = width - (size - 1) * channels
    by_rows, means = np.empty((5, width)), np.empty((5, inner))
    # Zeros on both sides, so that windows beyond the picture add nothing.
    spread = np.zeros((3, inner + 2 * (size - 1) * channels))
    left = (size - 1) * channels
    for row in range(start, stop):
        by_rows[:] = 0.0
        a1, b1, aa1, bb1, ab1 = by_rows[0], by_rows[1], by_rows[2], by_rows[3], by_rows[4]
        for k in range(size):
            weight, a, b = weights[k], found[row + k], truth[row + k]
            for i in range(width):
                a1[i] += weight * a[i]
            for i in range(width):
                b1[i] += weight * b[i]
            for i in range(width):
                aa1[i] += weight * a[i] * a[i]
            for i in range(width):
                bb1[i] += weight * b[i] * b[i]
            for i in range(width):
                ab1[i] += weight * a[i] * b[i]
        means[:] = 0.0
        for q in range(5):
            mean = means[q]
            for k in range(size):
                weight, shifted = weights[k], by_rows[q, k * channels : k * channels + inner]
                for i in range(inner):
                    mean[i] += weight * shifted[i]
        ma, mb, maa, mbb, mab = means[0], means[1], means[2], means[3], means[4]
        by_a, by_aa, by_ab = spread[0, left:], spread[1, left:], spread[2, left:]
        total = 0.0
        for i in range(inner):
            a_, b_ = ma[i], mb[i]
            # Rounding leaves variances of flat windows below 0, and covariances above what variances allow.
            variances = max(maa[i] - a_ * a_, 0.0) + max(mbb[i] - b_ * b_, 0.0)
            twice = min(max(2.0 * (mab[i] - a_ * b_), -variances), variances)
            over, under = 2.0 * a_ * b_ + c1, a_ * a_ + b_ * b_ + c1
            top, bottom = twice + c2, variances + c2
            light, contrast = over / under, top / bottom
            value = light * contrast
            total += value
            aa_, ab_ = -value / bottom, 2.0 * light / bottom
            by_a[i] = 2.0 * (b_ * contrast - a_ * value) / under - ab_ * b_ - 2.0 * aa_ * a_
            by_aa[i], by_ab[i] = aa_, ab_
        sums[row] = total
        if partial.shape[0] == 0:
            continue
        for q in range(3):
            target = partial[row, q]
            target[:] = 0.0
            for k in range(size):
                weight, shifted = weights[k], spread[q, k * channels : k * channels + width]
                for i in range(width):
                    target[i] += weight * shifted[i]


@kernel
def gradient_rows(
    found: Array,
    truth: Array,
    weights: Array,
    partial: Array,
    factor: float,
    start: int,
    stop: int,
    gradient: Array,
) -> None:
    """Gradient of `factor` times the sum of all similarities by `found`, for some of the picture's rows.

    Parameters
    ----------
    partial
        Of `similarity_rows`.
    gradient
        Written, shape (h, w * channels).
    """
    size, n_rows, width = len(weights), partial.shape[0], found.shape[1]
    spread = np.empty((3, width))
    for row in range(start, stop):
        spread[:] = 0.0
        for k in range(size):
            if not 0 <= row - k < n_rows:
                continue
            weight = weights[k]
            for q in range(3):
                source, target = partial[row - k, q], spread[q]
                for i in range(width):
                    target[i] += weight * source[i]
        by_a, by_aa, by_ab = spread[0], spread[1], spread[2]
        a, b, out = found[row], truth[row], gradient[row]
        for i in range(width):
            out[i] = factor * (by_a[i] + 2.0 * a[i] * by_aa[i] + b[i] * by_ab[i])
