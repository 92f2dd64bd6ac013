"""Lines that look alike share their evidence: prior times similarity, summed (Eqs. 5 to 8)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.jit import chunks
from planning.progress import QUIET, Monitor
from reconstruction.segmentation.similarity import Rows

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
        monitor.report("compare rows", start, n)
        result[start:stop] = softmax(rows.similarity(start, stop), beta) @ prior
    return result
