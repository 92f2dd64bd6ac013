"""What a set of stops is worth: prizes that add up, or any worth that overlaps, such as sections seen."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class CoverageGain(Protocol):
    """Worth of a set of candidates that grows and shrinks one by one.

    It must be monotone (more is never worth less) and submodular (the more is there, the less one more adds).
    """

    @property
    def value(self) -> float:
        """Worth of the set as it is."""

    def marginals(self) -> Floats:
        """What each candidate would add now, shape (n,); for those in the set the number means nothing."""

    def add(self, candidate: int) -> None:
        """Put a candidate into the set that is not in it."""

    def remove(self, candidate: int) -> None:
        """Take a candidate out of the set that is in it."""


class Prizes:
    """Each candidate is worth its own prize, whatever else is in the set; prizes of shape (n,), none negative."""

    def __init__(self, prizes: Floats) -> None:
        if prizes.ndim != 1 or not (np.isfinite(prizes).all() and (prizes >= 0.0).all()):
            raise ValueError(f"prizes: expected finite numbers, none negative, of shape (n,), got {prizes!r}")
        self._prizes = np.asarray(prizes, float)
        self._is_in = np.zeros(len(prizes), np.bool_)

    @property
    def value(self) -> float:
        """Sum of the prizes in the set."""
        return float(self._prizes[self._is_in].sum())

    def marginals(self) -> Floats:
        """The prizes, shape (n,)."""
        return self._prizes

    def add(self, candidate: int) -> None:
        """Put a candidate into the set."""
        self._is_in[candidate] = True

    def remove(self, candidate: int) -> None:
        """Take a candidate out of the set."""
        self._is_in[candidate] = False
