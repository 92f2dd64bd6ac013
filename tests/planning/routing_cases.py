"""Points, costs and slow twins that several tests of routing share."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from planning.coverage.model import Elements
from planning.viewpoints.budget import CoverGain

Floats = NDArray[np.float64]


def distances(points: Floats) -> Floats:
    """Euclidean distances between points of shape (n, d)."""
    return np.linalg.norm(points[:, None] - points[None], axis=-1)


def random_distances(n: int, seed: int = 0, dimensions: int = 2) -> Floats:
    return distances(np.random.default_rng(seed).random((n, dimensions)) * 100.0)


def symmetric_costs(least: int = 1, most: int = 8) -> st.SearchStrategy[Floats]:
    """Small whole costs with many ties, zeros and missing legs."""

    def build(numbers: list[float], n: int) -> Floats:
        cost = np.zeros((n, n))
        cost[np.triu_indices(n, 1)] = numbers[: n * (n - 1) // 2]
        return cost + cost.T

    leg = st.one_of(st.integers(0, 6).map(float), st.just(math.inf))
    size = most * (most - 1) // 2
    return st.builds(build, st.lists(leg, min_size=size, max_size=size), st.integers(least, most))


def shortest_by_force(cost: Floats, closed: bool) -> float:
    """Length of the shortest tour from 0, or path from 0 to the last point, trying every order."""
    n = len(cost)
    inner = range(1, n if closed else n - 1)
    end = (0,) if closed else (n - 1,) if n > 1 else ()
    orders = ((0, *order, *end) for order in itertools.permutations(inner))
    return min(sum(cost[a, b] for a, b in itertools.pairwise(order)) for order in orders)


def fewest_by_force(travel_s: Floats, service_s: Floats, budget_s: float, max_stops: int) -> tuple[int, float] | None:
    """Number and total duration of the best sorties, trying every order of every subset; None where there are none."""
    n = len(service_s)
    alone: dict[int, float] = {}
    for size in range(1, min(n, max_stops) + 1):
        for stops in itertools.permutations(range(n), size):
            places = [0, *(stop + 1 for stop in stops), 0]
            duration = sum(travel_s[a, b] for a, b in itertools.pairwise(places)) + sum(service_s[list(stops)])
            subset = sum(1 << stop for stop in stops)
            if duration <= budget_s and duration < alone.get(subset, math.inf):
                alone[subset] = duration
    best: list[tuple[int, float] | None] = [(0, 0.0)] + [None] * ((1 << n) - 1)
    for subset in range(1, 1 << n):
        last = subset & -subset
        rest_of = [part for part in alone if part & last and part & subset == part]
        options = [
            (rest[0] + 1, rest[1] + alone[part]) for part in rest_of if (rest := best[subset ^ part]) is not None
        ]
        best[subset] = min(options, default=None)
    return best[-1]


class Counting:
    """Stop criterion that holds from the n-th time it is asked."""

    def __init__(self, n: int) -> None:
        self.left = n

    def __call__(self) -> bool:
        self.left -= 1
        return self.left < 0


class Cancelling:
    """Monitor that cancels at the n-th report."""

    def __init__(self, n: int, error: Callable[[], BaseException]) -> None:
        self.left, self.error = n, error

    def report(self, stage: str, done: float, total: float) -> None:
        self.left -= 1
        if self.left < 0:
            raise self.error()


def cover_gain(sees: np.ndarray, weights: np.ndarray | None = None) -> CoverGain:
    """Worth of candidates by the elements they see: `sees` of shape (n, m)."""
    starts = np.concatenate([[0], np.cumsum(sees.sum(axis=1))]).astype(np.int64)
    elements = Elements(starts, np.nonzero(sees)[1].astype(np.int32))
    return CoverGain(elements, np.ones(sees.shape[1]) if weights is None else weights)


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
