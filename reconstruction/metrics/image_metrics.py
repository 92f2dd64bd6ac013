"""How like a rendered picture is to its photo: PSNR and structural similarity, of all of it or of a mask.

Values are those that photos have (sRGB), 0 to 1; what was rendered is clipped to that range, as a screen would, and not
rounded to 8 bit. Everything is reckoned in double precision.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

WINDOW_PX, SIGMA_PX = 11, 1.5
"""Side and standard deviation of the window of structural similarity (Wang et al., 2004, 3.C)."""

C1, C2 = 0.01**2, 0.03**2
"""(K1 L)^2 and (K2 L)^2 of Wang et al., Eqs. 7 and 9, for values whose range L is 1."""

BEST_DB = 100.0
"""PSNR of equal pictures, and of all whose mean square error is below 1e-10."""

STRIP_ROWS = 256
"""Rows at once: 90 MB for pictures of 5280 columns."""


@dataclass(frozen=True, slots=True)
class PictureScore:
    """Scores of a picture, or of what a mask shows of it.

    Parameters
    ----------
    psnr_db
        None where the mask is empty.
    ssim
        None where the mask has no pixel whose window lies whole in the picture.
    n_pixels
        That were scored by PSNR.
    """

    psnr_db: float | None
    ssim: float | None
    n_pixels: int


@dataclass(frozen=True, slots=True)
class Quality:
    """PSNR of several views in one number, see `mean_quality`.

    Parameters
    ----------
    n_views
        That it is the mean of.
    is_of_facades
        False: no view shows a facade, and it is of whole pictures.
    """

    psnr_db: float
    n_views: int
    is_of_facades: bool


def mean_quality(views: Iterable[tuple[float | None, float | None]]) -> Quality | None:
    """Mean of the views' own PSNR on facades, over those that show a facade, as papers report it.

    Of views among which none shows a facade it is that of whole pictures; None where there is nothing to score. A mean
    of squared errors over all views would be another number, which the worst views decide.

    Parameters
    ----------
    views
        Of each view the PSNR, dB, of its facade and of all of it; None where it shows none.
    """
    found = list(views)
    facades = [facade for facade, _ in found if facade is not None]
    counted = facades or [whole for _, whole in found if whole is not None]
    return Quality(statistics.fmean(counted), len(counted), bool(facades)) if counted else None


def score_picture(
    found: NDArray[Any], truth: NDArray[Any], mask: Mask | None = None, *, with_ssim: bool = True
) -> PictureScore:
    """Score a picture against its photo.

    PSNR is that of the mean square error over all values of the mask's pixels. Structural similarity is that of Wang et
    al. (2004): a Gaussian window of 11 x 11 and sigma 1.5 with weights that add up to 1 (so variances are those of the
    window itself, not estimates of a larger population's), each channel by itself. It is the mean of the map over
    pixels whose window lies whole in the picture, and, with a mask, over those of them that are in the mask; windows of
    pixels near the mask's edge reach beyond it.

    Parameters
    ----------
    found, truth
        Shape (h, w, c); floating point as 0 to 1, or uint8 as 0 to 255. NaN counts as 0.
    mask
        Shape (h, w).
    with_ssim
        False leaves structural similarity out, which takes nearly all of the time.
    """
    _check(found, truth, mask)
    height, width = found.shape[:2]
    n_pixels = height * width if mask is None else int(mask.sum())
    squares, likeness, n_windows = [0.0], [0.0], 0
    edge = WINDOW_PX // 2
    for start, stop in chunks(height, STRIP_ROWS):
        first, last = max(start - edge, 0), min(stop + edge, height)
        a, b = _values(found[first:last]), _values(truth[first:last])
        inside = slice(start - first, stop - first)
        error = np.square(a[inside] - b[inside]).mean(axis=2)
        squares.append(float(error.sum() if mask is None else error[mask[start:stop]].sum()))
        counted = None if mask is None else mask[first:last][edge:-edge, edge:-edge]
        if with_ssim and min(a.shape[:2]) >= WINDOW_PX and (counted is None or counted.any()):
            values = ssim_map(a, b)
            values = values if counted is None else values[counted]
            likeness.append(float(values.sum()))
            n_windows += values.size
    return PictureScore(
        psnr_db(math.fsum(squares) / n_pixels) if n_pixels else None,
        math.fsum(likeness) / n_windows if n_windows else None,
        n_pixels,
    )


def psnr_db(mean_square: float) -> float:
    """Peak signal-to-noise ratio of a mean square error of values 0 to 1; `BEST_DB` at most."""
    return -10.0 * math.log10(max(mean_square, 10.0 ** (-BEST_DB / 10.0)))


def ssim_map(a: Array, b: Array) -> Array:
    """Structural similarity of each window that lies whole in both pictures, mean of the channels.

    Parameters
    ----------
    a, b
        Shape (h, w, c), 0 to 1, both sides `WINDOW_PX` or more.

    Returns
    -------
    Shape (h - 10, w - 10), -1 to 1.
    """
    if a.shape != b.shape or a.ndim != 3 or min(a.shape[:2]) < WINDOW_PX:
        raise ValueError(f"expected two pictures of {WINDOW_PX} pixels or more a side, got {a.shape} and {b.shape}")
    return np.asarray(np.mean([_channel_map(a[..., k], b[..., k]) for k in range(a.shape[2])], axis=0))


def _channel_map(a: Array, b: Array) -> Array:
    mean_a, mean_b, aa, bb, ab = (_window_means(plane) for plane in (a, b, a * a, b * b, a * b))
    # Rounding leaves variances of flat windows below 0, and covariances above what variances allow.
    variances = np.maximum(aa - mean_a * mean_a, 0.0) + np.maximum(bb - mean_b * mean_b, 0.0)
    twice = np.clip(2.0 * (ab - mean_a * mean_b), -variances, variances)
    light = (2.0 * mean_a * mean_b + C1) / (mean_a * mean_a + mean_b * mean_b + C1)
    return np.asarray(light * (twice + C2) / (variances + C2))


def _window_means(plane: Array) -> Array:
    weights, edge = window_weights(), WINDOW_PX // 2
    means = cv2.sepFilter2D(np.ascontiguousarray(plane), cv2.CV_64F, weights, weights)
    return np.asarray(means[edge:-edge, edge:-edge])


@cache
def window_weights() -> Array:
    """Weights along one side of the window, shape (11,), adding up to 1; not to be written to."""
    weights = np.exp(-0.5 * np.square((np.arange(WINDOW_PX) - WINDOW_PX // 2) / SIGMA_PX))
    weights /= weights.sum()
    weights.flags.writeable = False
    return np.asarray(weights)


def _values(picture: NDArray[Any]) -> Array:
    if picture.dtype == np.uint8:
        return np.asarray(picture / 255.0)
    return np.clip(np.nan_to_num(picture.astype(np.float64), nan=0.0), 0.0, 1.0)


def _check(found: NDArray[Any], truth: NDArray[Any], mask: Mask | None) -> None:
    if found.shape != truth.shape or found.ndim != 3 or not found.size:
        raise ValueError(f"expected two pictures of one shape (h, w, c), got {found.shape} and {truth.shape}")
    if mask is not None and (mask.shape != found.shape[:2] or mask.dtype != np.bool_):
        raise ValueError(f"mask: expected bool of shape {found.shape[:2]}, got {mask.dtype} of {mask.shape}")
