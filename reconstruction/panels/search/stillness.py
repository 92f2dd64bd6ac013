"""Frames by their stillness: what glass mirrors changes along a line, a frame keeps its brightness.

A dark profile before dark glass that mirrors a bright grid shows hardly an edge in most panes, but nothing of the grid
either. Within a band of rows as long as a pane the brightness of a column of glass spreads by s_g, that of a profile by
s_f. Were the profile glass, its brightness would be drawn from a normal distribution of spread s_g; the logarithm of
the likelihood ratio is, for each independent value,

    log(s_g / s_f) + (s_f^2 / s_g^2 - 1) / 2,

and near none where the glass beside is itself as still as noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Picture = NDArray[np.float32]

N_BANDS = 12
"""Bands of a picture: as long as a pane, in which glass mirrors several things; in shorter ones it is still, too."""

STRIP_PX = (2.5, 9.0)
"""Glass beside a profile, from its edges: beyond the blur, and not yet the next profile."""

NOISE_GREY = 2.0
"""Spread below which nothing can be told: of pixels' noise and 8 bit."""

VALUES = 2.0
"""Independent values of brightness in a pane's length."""

MOST_OF_A_VALUE, OF_A_WITNESS = 1.5, (-0.4, 1.0)
"""Nats: most for a value, least and most for a pane. Between the edges of made profiles the sum over the panes is below
-0.2 once in fifty times, above 4.5 in three of four; between other edges below -1 every second time, above 1 once in
ten."""


@dataclass(frozen=True, slots=True, eq=False)
class Stillness:
    """Spread of brightness along the columns of a picture.

    Parameters
    ----------
    sums
        Shape (n_bands, w + 1): cumulative over the columns, of the spread within each band of rows, grey levels.
    """

    sums: Array

    @classmethod
    def of(cls, spread: Array) -> Stillness:
        """From the spread of each column in each band, shape (n_bands, w)."""
        return cls(np.pad(np.cumsum(spread, axis=1), ((0, 0), (1, 0))))

    def per_witness(self, first_px: Array, last_px: Array) -> Array:
        """Gain of a profile between each two edges, each shape (n,); shape (n,), nats for each pane along it."""
        thin = np.maximum(0.6 - 0.5 * (last_px - first_px), 0.0)
        frame = self._mean(first_px - thin + 0.4, last_px + thin - 0.4)
        glass = np.minimum(
            self._mean(first_px - STRIP_PX[1], first_px - STRIP_PX[0]),
            self._mean(last_px + STRIP_PX[0], last_px + STRIP_PX[1]),
        )
        ratio = np.hypot(frame, NOISE_GREY) / np.hypot(glass, NOISE_GREY)
        told = np.abs(np.log(ratio)) + 0.5 * (np.minimum(ratio, 1.0 / ratio) ** 2 - 1.0)
        signed = np.minimum(told, MOST_OF_A_VALUE) * np.sign(1.0 - ratio)
        return np.asarray(np.clip(VALUES * signed.mean(axis=0), *OF_A_WITNESS))

    def _mean(self, start_px: Array, stop_px: Array) -> Array:
        """Mean spread between places, shape (n_bands, n); of the nearest column where they are beyond the picture."""
        width = self.sums.shape[1] - 1
        start = np.clip(np.floor(start_px), 0, width - 1).astype(int)
        stop = np.clip(np.ceil(stop_px), start + 1, width).astype(int)
        return np.asarray((self.sums[:, stop] - self.sums[:, start]) / (stop - start))


def spread_in_bands(picture: Picture, n_bands: int = N_BANDS) -> Array:
    """Standard deviation of each column within bands of rows, shape (n_bands, w); fewer bands where rows are few."""
    height = picture.shape[0]
    borders = np.linspace(0, height, min(n_bands, height) + 1).astype(int)
    counts = np.diff(borders)[:, None]
    centred = picture - picture.mean(dtype=np.float64).astype(np.float32)
    means = np.add.reduceat(centred, borders[:-1], axis=0, dtype=np.float64) / counts
    squares = np.add.reduceat(centred * centred, borders[:-1], axis=0, dtype=np.float64) / counts
    return np.sqrt(np.maximum(squares - means**2, 0.0))
