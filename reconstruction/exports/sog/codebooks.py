"""Few values that stand for many: codebooks of numbers, and palettes of vectors, by Lloyd's k-means.

A palette is found in two steps, groups and then colours within each group: of k colours a vector is compared with about
2 sqrt(k), so that 65 536 of them for a million vectors take seconds and not hours. What that costs is measured in
`tests.benchmarks --only model-size`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from planning.base.progress import Monitor

Floats = NDArray[np.float32]

CODES = 256

NUMBER_STEPS = 64
"""Of Lloyd's method for numbers, which are sorted: each step takes microseconds."""

STEPS = 8

ROUNDS = 8
"""In which colours are shared out: groups that have enough leave theirs to the others."""

AT_ONCE = 16_384
"""Vectors compared at a time: 16 MB of distances to 256 others."""


def codebook(values: NDArray[np.floating]) -> NDArray[np.float64]:
    """Numbers that values, of any shape but empty, are told by, rising, shape (256,).

    It begins half with evenly spaced ones and half with as many values between any two, so that rare values far out
    count, too.
    """
    sorted_values = np.sort(np.asarray(values, np.float64), axis=None)
    n = len(sorted_values)
    sums = np.concatenate([[0.0], np.cumsum(sorted_values)])
    even = np.linspace(sorted_values[0], sorted_values[-1], CODES // 2)
    often = sorted_values[np.linspace(0, n - 1, CODES // 2).astype(np.int64)]
    found = np.sort(np.concatenate([even, often]))
    for _ in range(NUMBER_STEPS):
        ends = np.searchsorted(sorted_values, 0.5 * (found[1:] + found[:-1]))
        edges = np.concatenate([[0], ends, [n]])
        counts = np.diff(edges)
        means = np.diff(sums[edges]) / np.maximum(counts, 1)
        moved = np.sort(np.where(counts > 0, means, found))
        if np.array_equal(moved, found):
            break
        found = moved
    return found


def nearest_codes(values: NDArray[np.floating], codes: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Number of the nearest of rising codes for each value."""
    return np.searchsorted(0.5 * (codes[1:] + codes[:-1]), values).astype(np.uint8)


@dataclass(frozen=True, slots=True, eq=False)
class Palette:
    """Vectors that stand for others.

    Parameters
    ----------
    groups
        Middles, shape (g, d).
    starts
        First colour of each group and the end, shape (g + 1,).
    colours
        Shape (k, d).
    """

    groups: Floats
    starts: NDArray[np.int64]
    colours: Floats

    def labels(self, vectors: Floats) -> NDArray[np.int64]:
        """Number of the colour for each vector, shape (n,): the nearest of those of the nearest group."""
        groups = _nearest(vectors, self.groups)
        found = np.zeros(len(vectors), np.int64)
        for group, rows in _by_group(groups, len(self.groups)):
            own = slice(int(self.starts[group]), int(self.starts[group + 1]))
            found[rows] = own.start + _nearest(vectors[rows], self.colours[own])
        return found


def palette(vectors: Floats, size: int, seed: int, monitor: Monitor) -> Palette:
    """At most `size` colours for vectors, shape (n, d), n > 0.

    Groups get colours by how much their vectors differ.
    """
    rng = np.random.default_rng(seed)
    size = min(size, len(vectors))
    groups = _lloyd(vectors, min(math.isqrt(size - 1) + 1, size), rng)
    numbers = _nearest(vectors, groups)
    members = list(_by_group(numbers, len(groups)))
    spread = np.array([float(((vectors[rows] - groups[group]) ** 2).sum()) for group, rows in members])
    counts = _shared_out(spread, np.array([len(rows) for _, rows in members]), size)
    colours, sizes = [], np.zeros(len(groups), np.int64)
    for (group, rows), count in zip(members, counts, strict=True):
        monitor.report(say("finding colours"), group, len(groups))
        own = _lloyd(vectors[rows], int(count), rng)
        colours.append(own)
        sizes[group] = len(own)
    # Groups that nothing is in have no colour, and nothing may come to them.
    kept = sizes > 0
    starts = np.concatenate([[0], np.cumsum(sizes[kept])])
    return Palette(groups[kept], starts, np.concatenate(colours))


def _shared_out(spread: NDArray[np.float64], members: NDArray[np.int64], size: int) -> NDArray[np.int64]:
    """How many of `size` colours each group gets: one, and of the rest by its spread, but not more than members."""
    if size >= members.sum():
        return members
    counts = np.ones(len(spread), np.int64)
    for _ in range(ROUNDS):
        left = size - int(counts.sum())
        shares = np.where(counts < members, spread, 0.0)
        total = float(shares.sum())
        if left <= 0 or total == 0.0:
            break
        counts = np.minimum(counts + np.floor(left * shares / total).astype(np.int64), members)
    return counts


def _lloyd(vectors: Floats, k: int, rng: np.random.Generator) -> Floats:
    """Middles, shape (k, d), k <= n; those that nothing is nearest to stay where they began."""
    if k >= len(vectors):
        return vectors.copy()
    found = vectors[np.sort(rng.choice(len(vectors), k, replace=False))]
    for _ in range(STEPS):
        labels = _nearest(vectors, found)
        order = np.argsort(labels, kind="stable")
        counts = np.bincount(labels, minlength=k)
        is_used = counts > 0
        starts = np.concatenate([[0], np.cumsum(counts)[:-1]])[is_used]
        sums = np.add.reduceat(vectors[order], starts, axis=0)
        moved = found.copy()
        moved[is_used] = sums / counts[is_used, None].astype(np.float32)
        if np.array_equal(moved, found):
            break
        found = moved
    return found


def _nearest(vectors: Floats, middles: Floats) -> NDArray[np.int64]:
    """Number of the nearest middle for each vector, shape (n,)."""
    squares = (middles**2).sum(axis=1)
    found = np.empty(len(vectors), np.int64)
    for start in range(0, len(vectors), AT_ONCE):
        rows = slice(start, start + AT_ONCE)
        found[rows] = (squares - 2.0 * (vectors[rows] @ middles.T)).argmin(axis=1)
    return found


def _by_group(numbers: NDArray[np.int64], n_groups: int) -> list[tuple[int, NDArray[np.int64]]]:
    """Rows of each group that has any."""
    order = np.argsort(numbers, kind="stable")
    ends = np.searchsorted(numbers[order], np.arange(n_groups + 1))
    return [(group, order[ends[group] : ends[group + 1]]) for group in range(n_groups) if ends[group + 1] > ends[group]]
