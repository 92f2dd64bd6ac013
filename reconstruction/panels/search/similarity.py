"""How alike the rows or columns of a picture are (Eqs. 3 and 4), as one matrix product.

A row is the vector of its pixels; SSIM of two rows needs their means, variances and covariance only, and the
covariances of all pairs are the product of the centred rows with their transpose. Everything is computed in blocks of
rows, so that the whole matrix (16 million entries for 3956 rows) need not be held.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor

C1 = (0.01 * 255.0) ** 2
C2 = (0.03 * 255.0) ** 2
"""Constants of SSIM for 8 bit (Wang et al., 2004); they keep rows of one colour (no variance) finite."""

Floats = NDArray[np.floating[Any]]


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Rows of a picture, ready to be compared.

    Parameters
    ----------
    centred
        Shape (n, m): pixels less the mean of their row, divided by sqrt(m), so that products are covariances.
    means, variances
        Shape (n,).
    """

    centred: Floats
    means: Floats
    variances: Floats

    @classmethod
    def of(cls, picture: NDArray[Any], n_samples: int = 0, precision: type[np.floating[Any]] = np.float32) -> Rows:
        """Take the rows of a grey picture, shape (n, k), of values from 0 to 255.

        With `n_samples` > 0 that many pixels stand for a row: means of equal parts, so that no pixel is left out.
        Means are taken in float64 whatever the precision: cancellation between large equal values starts there.

        Raises
        ------
        ValueError
            Not a picture of at least one pixel, or values that are not finite.
        """
        if picture.ndim != 2 or picture.size == 0:
            raise ValueError(f"picture: expected shape (n, k) with n, k > 0, got {picture.shape}")
        values = picture.astype(np.float64)
        if not np.isfinite(values).all():
            raise ValueError("picture: expected finite values")
        if 0 < n_samples < values.shape[1]:
            borders = np.linspace(0, values.shape[1], n_samples + 1).astype(int)
            values = np.add.reduceat(values, borders[:-1], axis=1) / np.diff(borders)
        means = values.mean(axis=1)
        centred = values - means[:, None]
        variances = np.mean(centred * centred, axis=1)
        scaled = centred / np.sqrt(values.shape[1])
        return cls(scaled.astype(precision), means.astype(precision), variances.astype(precision))

    def similarity(self, start: int, stop: int) -> Floats:
        """SSIM of the rows from `start` to `stop` with all rows, shape (stop - start, n), from -1 to 1."""
        covariance = self.centred[start:stop] @ self.centred.T
        mu, var = self.means[start:stop, None], self.variances[start:stop, None]
        light = (2.0 * mu * self.means + C1) / (mu * mu + self.means * self.means + C1)
        ssim = light * (2.0 * covariance + C2) / (var + self.variances + C2)
        return np.asarray(np.clip(ssim, -1.0, 1.0, out=ssim))


def similarity_matrix(picture: NDArray[Any], n_samples: int = 0) -> Floats:
    """HSIM of a grey picture, shape (n, n) for n rows (Eq. 3); VSIM is that of its transpose (Eq. 4)."""
    rows = Rows.of(picture, n_samples)
    return rows.similarity(0, len(rows.means))


# Lines that look alike share their evidence: prior times similarity, summed (Eqs. 5 to 8).

Array = NDArray[np.float64]

BLOCK = 512
"""Rows compared at once: 10 MB for pictures of 5280 columns."""


def normalised_intensity(intensity: Array) -> Array:
    """NorHLI or NorVLI, shape (n,) (Eq. 7); a histogram without any line stays 0."""
    top = float(intensity.max(initial=0.0))
    return np.asarray(intensity / top) if top > 0.0 else np.zeros_like(intensity)


def softmax(similarities: NDArray[Any], beta: float) -> NDArray[Any]:
    """NorHSIM, shape (m, n) (Eq. 8); the largest value of each row is subtracted first, so that nothing overflows."""
    powers = np.exp(beta * (similarities - similarities.max(axis=1, keepdims=True)))
    return np.asarray(powers / powers.sum(axis=1, keepdims=True))


def posterior(rows: Rows, intensity: Array, beta: float, monitor: Monitor = QUIET) -> Array:
    """HPosterior or VPosterior, shape (n,), from 0 to 1 (Eqs. 5 and 6).

    Parameters
    ----------
    intensity
        HLI or VLI, shape (n,): length of detected line per row, not negative.

    Raises
    ------
    ValueError
        The histogram has another length than there are rows.
    """
    n = len(rows.means)
    if intensity.shape != (n,):
        raise ValueError(f"intensity: expected shape ({n},), got {intensity.shape}")
    prior = normalised_intensity(intensity)
    result = np.empty(n)
    for start, stop in chunks(n, BLOCK):
        monitor.report(say("compare rows"), start, n)
        result[start:stop] = softmax(rows.similarity(start, stop), beta) @ prior
    return result
