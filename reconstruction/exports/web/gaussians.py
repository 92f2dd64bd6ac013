"""Gaussians as a web page has them: 32 bytes each and a byte per coefficient of direction, the most visible ones first.

Little-endian words of 32 bits, as `shaders.js` reads them:

| word | holds |
| --- | --- |
| 0 to 2 | mean, float32, metres, ENU less the scene's `origin_enu_m` |
| 3, 4 | quaternion w, x, y, z, half floats |
| 5, 6 | three sizes in metres, half floats; then the pane's number + 1 on 16 bits, 0 for none |
| 7 | red, green, blue of all directions, and opacity, 8 bits each |

Coefficients of higher degrees follow a chunk's words: signed bytes, by Gaussian, coefficient and channel.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reconstruction.exports.ellipsoids import Ellipsoids

Words = NDArray[np.uint32]

N_AT_ONCE = 16_384
"""Gaussians of a chunk: 16 rows of the page's texture, some 0.7 MB of text."""

MAX_GAUSSIANS = 4_000_000
"""Textures of 4096 rows of 1024 Gaussians are what nearly every device bears."""

MAX_PANES = 65_535

N_WORDS = 8

COLOUR_RANGE = (-0.25, 1.25)
"""Of the colour of all directions, display values: others are added to it, so it may lie a little outside 0 to 1."""

FLAT = 0.28209479177387814
"""The harmonic of degree 0."""

LARGEST_HALF = 65_504.0

FAINTEST = 1.0 / 255.0
"""Opacity below which nothing is drawn, as in 3-D Gaussian splatting."""


@dataclass(frozen=True, slots=True, eq=False)
class PackedGaussians:
    """What the page gets, the most visible first.

    Parameters
    ----------
    words
        Shape (n, 8), uint32.
    rest
        Coefficients from degree 1 on, shape (n, (degree + 1)^2 - 1, 3), int8.
    rest_steps
        What 1 stands for in each coefficient, shape ((degree + 1)^2 - 1,).
    """

    words: Words
    rest: NDArray[np.int8]
    rest_steps: NDArray[np.float32]

    def __len__(self) -> int:
        return len(self.words)

    def chunks(self) -> Iterator[bytes]:
        """Words of up to `N_AT_ONCE` Gaussians, then their coefficients."""
        for start in range(0, len(self), N_AT_ONCE):
            part = slice(start, start + N_AT_ONCE)
            yield self.words[part].astype("<u4").tobytes() + self.rest[part].tobytes()


def packed(gaussians: Ellipsoids, panes: NDArray[np.int32], degree: int, most: int | None = None) -> PackedGaussians:
    """Gaussians for a page; those too faint to be drawn are left out.

    Parameters
    ----------
    panes
        Number of the page's pane that each lies on, -1 for none, shape (n,).
    degree
        Of the harmonics kept, 0 to 3.
    most
        So many of the most visible are kept; None: all.
    """
    seen = np.flatnonzero(gaussians.opacities >= FAINTEST)
    order = seen[np.argsort(-_visibilities(gaussians)[seen], kind="stable")][:most]
    chosen = gaussians.chosen(order)
    words = np.empty((len(chosen), N_WORDS), np.uint32)
    words[:, 0:3] = np.ascontiguousarray(chosen.means_m, np.float32).view(np.uint32)
    halves = np.zeros((len(chosen), 4, 2), np.uint16)
    halves[:, 0:2] = chosen.quats.astype(np.float16).view(np.uint16).reshape(-1, 2, 2)
    sizes = np.minimum(chosen.scales_m, np.float32(LARGEST_HALF)).astype(np.float16).view(np.uint16)
    halves[:, 2] = sizes[:, :2]
    halves[:, 3, 0] = sizes[:, 2]
    halves[:, 3, 1] = panes[order] + 1
    words[:, 3:7] = halves[..., 0] | halves[..., 1].astype(np.uint32) << 16
    words[:, 7] = _colours(chosen)
    rest, steps = _rest(chosen.sh[:, 1 : (degree + 1) ** 2])
    return PackedGaussians(words, rest, steps)


def _visibilities(gaussians: Ellipsoids) -> NDArray[np.float32]:
    """About how much of a picture each covers: opacity times the two larger sizes."""
    sizes = np.sort(gaussians.scales_m, axis=1)
    return np.asarray(gaussians.opacities * sizes[:, 1] * sizes[:, 2], np.float32)


def _colours(gaussians: Ellipsoids) -> Words:
    low, high = COLOUR_RANGE
    shares = (0.5 + np.float32(FLAT) * gaussians.sh[:, 0] - low) / (high - low)
    values = np.column_stack([shares, gaussians.opacities])
    bytes_ = np.rint(np.clip(values, 0.0, 1.0) * 255.0).astype(np.uint32)
    return np.asarray((bytes_ << np.array([0, 8, 16, 24], np.uint32)).sum(axis=1, dtype=np.uint32))


def _rest(coefficients: NDArray[np.float32]) -> tuple[NDArray[np.int8], NDArray[np.float32]]:
    """Bytes of coefficients, and their steps: the outermost 0.1 % are cut, or a few stray ones would coarsen all."""
    if not len(coefficients) or not coefficients.shape[1]:
        return np.zeros(coefficients.shape, np.int8), np.zeros(coefficients.shape[1], np.float32)
    largest = np.quantile(np.abs(coefficients), 0.999, axis=(0, 2), method="higher")
    steps = np.maximum(largest / 127.0, 1e-12).astype(np.float32)
    return np.clip(np.rint(coefficients / steps[:, None]), -127.0, 127.0).astype(np.int8), steps
