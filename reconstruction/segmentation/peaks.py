"""Peaks of a histogram over the rows or columns of a picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.signal import find_peaks

Array = NDArray[np.float64]


def local_maxima(values: Array, prominence: float, distance_px: float = 1.0) -> tuple[Array, Array]:
    """Positions in continuous pixels (to a fraction, by a parabola) and heights of the local maxima, each shape (k,).

    Parameters
    ----------
    values
        Shape (n,), finite; entry i belongs to the pixel whose middle is i + 0.5.
    prominence
        What a maximum must rise above the higher of the two saddles around it.
    distance_px
        Least distance of two maxima; the higher one stays.
    """
    padded = np.concatenate([[-np.inf], values, [-np.inf]])  # the ends may be maxima, too
    padded[[0, -1]] = values.min(initial=0.0) - 1.0
    index, _ = find_peaks(padded, prominence=prominence, distance=max(1.0, distance_px))
    index = index - 1
    return index + 0.5 + _vertex(values, index), np.asarray(values[index], float)


def _vertex(values: Array, index: NDArray[np.intp]) -> Array:
    """Vertex of the parabola through each maximum and its neighbours, -0.5 to 0.5 from its middle."""
    inner = (index > 0) & (index < values.size - 1)
    i = index[inner]
    left, middle, right = values[i - 1], values[i], values[i + 1]
    bend = left - 2.0 * middle + right
    vertex = np.zeros(index.size)
    with np.errstate(divide="ignore", invalid="ignore"):
        vertex[inner] = np.where(bend < 0.0, np.clip(0.5 * (left - right) / bend, -0.5, 0.5), 0.0)
    return vertex
