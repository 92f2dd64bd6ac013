"""Long compiled loops in slices short enough to be stopped between them."""

from __future__ import annotations

import time
from collections.abc import Iterator

from planning.base.progress import Clock

SLICE_S = 0.05
"""Aimed-at length of a slice: half of what a user notices after pressing "stop"."""


def slices(n_steps: int | None = None, *, first: int = 1, clock: Clock = time.perf_counter) -> Iterator[int]:
    """Numbers of steps to take one after the other, adding up to `n_steps` (endless where None).

    The first slice has `first` steps. The time until the next number is asked for is taken as the time that the steps
    took, and slices grow (at most to twice the last) or shrink so that one takes about `SLICE_S`.
    """
    taken, size = 0, first
    while n_steps is None or taken < n_steps:
        size = size if n_steps is None else min(size, n_steps - taken)
        begin = clock()
        yield size
        taken += size
        size = max(1, min(2 * size, int(size * SLICE_S / max(clock() - begin, 1e-6))))
