"""FLIP: how much two pictures differ to somebody who flips between them on a screen.

P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström and M. D. Fairchild, "FLIP: a difference evaluator
for alternating images", HPG 2020, for pictures of 8 bit (LDR-FLIP). Both are blurred as an eye does that looks from a
stated distance, colours are compared where the eye tells them apart evenly, and edges and points that only one of them
has raise the difference. 0 is best, 1 most.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

PIXELS_PER_DEGREE = 0.7 * 3840 / 0.7 * math.pi / 180.0
"""Of a screen of 3840 pixels and 0.7 m width, seen from 0.7 m: the authors' default."""

CONTRAST = (
    ((1.0, 0.0047), (0.0, 1e-5)),
    ((1.0, 0.0053), (0.0, 1e-5)),
    ((34.1, 0.04), (13.5, 0.025)),
)
"""a and b (degrees squared) of the two Gaussians of contrast sensitivity of brightness, red-green, and blue-yellow
(Table 1)."""

STRIP_ROWS, MARGIN_PX = 256, 16
"""Rows at once, and rows around them that they depend on (10 at the default distance)."""

WIDEST = 0.04
"""The largest b."""

COLOUR_POWER, COLOUR_SHARE, COLOUR_TARGET = 0.7, 0.4, 0.95
"""q_c, p_c and p_t: how differences of colour are spread over 0 to 1 (4.1.4)."""

FEATURE_DEG, FEATURE_POWER = 0.082, 0.5
"""w, width of the edge detector, and q_f (4.2)."""

XYZ_OF_RGB = np.array(
    [[10135552, 8788810, 4435075], [2613072, 8788810, 887015], [1425312, 8788810, 70074375]]
) / np.array([[24577794], [12288897], [73733382]])
"""CIE XYZ of linear sRGB, as fractions."""

WHITE = XYZ_OF_RGB.sum(axis=1)

LAB_KNEE = 6.0 / 29.0


def flip_map(found: NDArray[Any], truth: NDArray[Any], pixels_per_degree: float = PIXELS_PER_DEGREE) -> Array:
    """Difference at each pixel, shape (h, w), 0 to 1.

    Parameters
    ----------
    found, truth
        sRGB, shape (h, w, 3); floating point as 0 to 1, clipped to it, or uint8 as 0 to 255. NaN counts as 0.
    pixels_per_degree
        Of the eye's field of view.
    """
    if found.shape != truth.shape or found.ndim != 3 or found.shape[2] != 3 or not found.size:
        raise ValueError(f"expected two pictures of one shape (h, w, 3), got {found.shape} and {truth.shape}")
    one, other = (_opponent(_linear(_values(picture))) for picture in (found, truth))
    colour = _colour_difference(_perceived(one, pixels_per_degree), _perceived(other, pixels_per_degree))
    grey, other_grey = ((picture[..., 0] + 16.0) / 116.0 for picture in (one, other))
    feature = _feature_difference(grey, other_grey, pixels_per_degree)
    return np.asarray(np.power(colour, 1.0 - feature))


def flip(found: NDArray[Any], truth: NDArray[Any], mask: Mask | None = None) -> float | None:
    """Mean of the map, or of what a mask shows of it; None where the mask is empty."""
    return flip_of_masks(found, truth, (mask,))[0]


def flip_of_masks(found: NDArray[Any], truth: NDArray[Any], masks: Sequence[Mask | None]) -> tuple[float | None, ...]:
    """`flip` of several masks, None for all of the pictures, for the work of one, strip by strip.

    Parameters
    ----------
    masks
        Shape (h, w) each.
    """
    sums = np.zeros((len(masks), 2))
    for start, stop in chunks(len(found), STRIP_ROWS):
        first, last = max(start - MARGIN_PX, 0), stop + MARGIN_PX
        values = flip_map(found[first:last], truth[first:last])[start - first : stop - first]
        for number, mask in enumerate(masks):
            counted = values if mask is None else values[mask[start:stop]]
            sums[number] += counted.sum(), counted.size
    return tuple(float(total / n) if n else None for total, n in sums)


def _values(picture: NDArray[Any]) -> Array:
    if picture.dtype == np.uint8:
        return np.asarray(picture / 255.0)
    return np.clip(np.nan_to_num(picture.astype(np.float64), nan=0.0), 0.0, 1.0)


def _linear(display: Array) -> Array:
    return np.where(display > 0.04045, np.power((display + 0.055) / 1.055, 2.4), display / 12.92)


def _opponent(linear: Array) -> Array:
    """YCxCz of linear RGB: brightness, red-green, blue-yellow."""
    x, y, z = np.moveaxis(linear @ XYZ_OF_RGB.T / WHITE, -1, 0)
    return np.stack([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)], axis=-1)


def _linear_of_opponent(opponent: Array) -> Array:
    y = (opponent[..., 0] + 16.0) / 116.0
    x, z = y + opponent[..., 1] / 500.0, y - opponent[..., 2] / 200.0
    return np.asarray((np.stack([x, y, z], axis=-1) * WHITE) @ np.linalg.inv(XYZ_OF_RGB).T)


def _perceived(opponent: Array, pixels_per_degree: float) -> Array:
    """L*a*b* of what the eye sees, a* and b* weaker where it is dark (the effect of Hunt)."""
    blurred = [_sum_of_blurs(opponent[..., k], _sensitivity(k, pixels_per_degree)) for k in range(3)]
    return _hunt(_lab(np.clip(_linear_of_opponent(np.stack(blurred, axis=-1)), 0.0, 1.0)))


@cache
def _sensitivity(channel: int, pixels_per_degree: float) -> tuple[tuple[float, Array], ...]:
    """Weights of Gaussians that add up to the contrast sensitivity function, and each along one side."""
    radius = math.ceil(3.0 * math.sqrt(WIDEST / (2.0 * math.pi**2)) * pixels_per_degree)
    x_deg = np.arange(-radius, radius + 1) / pixels_per_degree
    sides = [np.exp(-(math.pi**2) * x_deg**2 / b) for _, b in CONTRAST[channel]]
    weights = [a * math.sqrt(math.pi / b) for a, b in CONTRAST[channel]]
    total = sum(weight * float(side.sum()) ** 2 for weight, side in zip(weights, sides, strict=True))
    return tuple((weight / total, side) for weight, side in zip(weights, sides, strict=True) if weight > 0.0)


def _sum_of_blurs(plane: Array, parts: tuple[tuple[float, Array], ...]) -> Array:
    return np.asarray(sum(weight * _filtered(plane, side, side) for weight, side in parts))


def _filtered(plane: Array, across: Array, down: Array) -> Array:
    plane = np.ascontiguousarray(plane)
    return np.asarray(cv2.sepFilter2D(plane, cv2.CV_64F, across, down, borderType=cv2.BORDER_REPLICATE))


def _lab(linear: Array) -> Array:
    t = linear @ XYZ_OF_RGB.T / WHITE
    x, y, z = np.moveaxis(np.where(t > LAB_KNEE**3, np.cbrt(t), t / (3.0 * LAB_KNEE**2) + 4.0 / 29.0), -1, 0)
    return np.stack([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)], axis=-1)


def _hunt(lab: Array) -> Array:
    return np.concatenate([lab[..., :1], 0.01 * lab[..., :1] * lab[..., 1:]], axis=-1)


def _distance(one: Array, other: Array) -> Array:
    """HyAB: difference of brightness and distance of hues, added up."""
    off = one - other
    return np.asarray(np.abs(off[..., 0]) + np.hypot(off[..., 1], off[..., 2]))


def _colour_difference(one: Array, other: Array) -> Array:
    """Differences of colour spread over 0 to 1: the smaller ones, which are more frequent, over most of it."""
    green, blue = _hunt(_lab(np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])))
    most = float(_distance(green, blue)) ** COLOUR_POWER
    found, knee = np.power(_distance(one, other), COLOUR_POWER), COLOUR_SHARE * most
    above = COLOUR_TARGET + (found - knee) / (most - knee) * (1.0 - COLOUR_TARGET)
    return np.asarray(np.where(found < knee, COLOUR_TARGET / knee * found, above))


def _feature_difference(one: Array, other: Array, pixels_per_degree: float) -> Array:
    """By how much more of an edge or a point a pixel is in one of the pictures; 0 to 1."""
    smooth, slope, bend = _detectors(pixels_per_degree)
    strengths = []
    for side in (slope, bend):
        a, b = (np.hypot(_filtered(each, side, smooth), _filtered(each, smooth, side)) for each in (one, other))
        strengths.append(np.abs(a - b))
    return np.asarray(np.power(np.maximum(*strengths) / math.sqrt(2.0), FEATURE_POWER))


@cache
def _detectors(pixels_per_degree: float) -> tuple[Array, Array, Array]:
    """A Gaussian, and its first and second derivative with positive and negative weights that add up to 1 each."""
    deviation = 0.5 * FEATURE_DEG * pixels_per_degree
    x = np.arange(-math.ceil(3.0 * deviation), math.ceil(3.0 * deviation) + 1, dtype=np.float64)
    gauss = np.exp(-0.5 * np.square(x / deviation))
    return gauss / gauss.sum(), _balanced(-x * gauss), _balanced((np.square(x / deviation) - 1.0) * gauss)


def _balanced(weights: Array) -> Array:
    below, above = -weights[weights < 0.0].sum(), weights[weights > 0.0].sum()
    return np.asarray(np.where(weights < 0.0, weights / below, weights / above))
