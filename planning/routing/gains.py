"""What a set of stops is worth: prizes that add up, and sections seen, which overlap."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from planning.jit import kernel

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

REFRESH = 1000
"""Changes after which the marginal gains are summed up anew, so that rounding cannot build up."""


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


class SectionCoverage:
    """Weighted sections (or any elements) that count until they have been seen `depth` times.

    Adding or removing a candidate takes time in proportion to the sections it sees and to who else sees them.

    Parameters
    ----------
    sees
        Shape (n, m), true where candidate i sees section j.
    weights
        Shape (m,), none negative; by default 1.
    depth
        How often a section counts: 1 is plain coverage.
    """

    def __init__(self, sees: NDArray[np.bool_], weights: Floats | None = None, depth: int = 1) -> None:
        if sees.ndim != 2:
            raise ValueError(f"sees: expected shape (n, m), got {sees.shape}")
        weights = np.ones(sees.shape[1]) if weights is None else np.asarray(weights, float)
        if weights.shape != sees.shape[1:] or not (np.isfinite(weights).all() and (weights >= 0.0).all()):
            raise ValueError(f"weights: expected {sees.shape[1]} finite numbers, none negative, got {weights!r}")
        if depth < 1:
            raise ValueError(f"depth: expected 1 or more, got {depth}")
        self._sections, self._seen_by = _rows(sees), _rows(sees.T)
        self._weights = weights
        self._depth = depth
        self._count = np.zeros(sees.shape[1], np.int64)
        self._marginals = np.zeros(len(sees))
        self._changes = 0
        _sum_marginals(self._sections, self._weights, self._count, self._depth, self._marginals)

    @property
    def value(self) -> float:
        """Weight of all sections, each as often as it is seen but no more than `depth` times."""
        return float(self._weights @ np.minimum(self._count, self._depth))

    def marginals(self) -> Floats:
        """Weight of the sections that each candidate would add, shape (n,)."""
        return self._marginals

    def add(self, candidate: int) -> None:
        """Count the sections of a candidate once more."""
        self._change(candidate, 1)

    def remove(self, candidate: int) -> None:
        """Count the sections of a candidate once less."""
        self._change(candidate, -1)

    def _change(self, candidate: int, step: int) -> None:
        data = self._sections, self._seen_by, self._weights, self._count, self._depth, self._marginals
        _count_sections(*data, candidate, step)
        self._changes += 1
        if self._changes % REFRESH == 0:
            _sum_marginals(self._sections, self._weights, self._count, self._depth, self._marginals)


Rows = tuple[Ints, Ints]
"""Columns of the true entries row by row, and where each row begins and the last ends."""


def _rows(table: NDArray[np.bool_]) -> Rows:
    begins = np.concatenate([[0], np.cumsum(table.sum(axis=1))]).astype(np.int64)
    return np.nonzero(table)[1].astype(np.int64), begins


@kernel
def _count_sections(
    sections: Rows,
    seen_by: Rows,
    weights: Floats,
    count: Ints,
    depth: int,
    marginals: Floats,
    candidate: int,
    step: int,
) -> None:
    """Change the counts of a candidate's sections by `step`, and all marginal gains with them."""
    columns, begins = sections
    viewers, viewer_begins = seen_by
    for section in columns[begins[candidate] : begins[candidate + 1]]:
        was_wanted = count[section] < depth
        count[section] += step
        is_wanted = count[section] < depth
        if was_wanted != is_wanted:
            change = weights[section] if is_wanted else -weights[section]
            for viewer in viewers[viewer_begins[section] : viewer_begins[section + 1]]:
                marginals[viewer] += change


@kernel
def _sum_marginals(sections: Rows, weights: Floats, count: Ints, depth: int, marginals: Floats) -> None:
    columns, begins = sections
    for candidate in range(len(marginals)):
        total = 0.0
        for section in columns[begins[candidate] : begins[candidate + 1]]:
            if count[section] < depth:
                total += weights[section]
        marginals[candidate] = total


def compile_kernels() -> None:
    """Compile what this module runs."""
    SectionCoverage(np.ones((2, 2), np.bool_)).add(0)
