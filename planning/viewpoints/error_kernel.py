"""Greedy choice by expected error, compiled: a sum of w / (1 + amount) over what has to be learned.

With amounts a_ij >= 0 of what view i shows of element j and weights w_j, the sets S of views are worth

    f(S) = sum_j w_j A_j / (1 + A_j),   A_j = sum of a_ij over i in S,

monotone and submodular, since x / (1 + x) rises and is concave. Gains of views only fall while views are added, so an
old gain is an upper bound: greedy looks again at few of them (M. Minoux, 1978).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from planning.viewpoints.cover_kernel import is_too_close

NO_GAIN = 1e-12
"""Of all weights together: gains up to it are rounding."""


class ErrorState(NamedTuple):
    """Candidates, what they show, and what is chosen so far.

    Parameters
    ----------
    starts, items, amounts
        Elements that each candidate shows, `items[starts[i]:starts[i + 1]]`, and how much of each, above 0.
    weights
        Of each element.
    sums
        A: what is shown of each element.
    bounds
        Upper bounds of the candidates' gains.
    positions, taken, spacing
        As those of `cover_kernel.CoverState`.
    """

    starts: NDArray[np.int64]
    items: NDArray[np.int32]
    amounts: NDArray[np.float32]
    weights: NDArray[np.float64]
    sums: NDArray[np.float64]
    bounds: NDArray[np.float64]
    positions: NDArray[np.float64]
    taken: NDArray[np.float64]
    spacing: float


@kernel
def gain_of(state: ErrorState, candidate: int) -> float:
    """How much f grows with a candidate."""
    gain = 0.0
    for i in range(state.starts[candidate], state.starts[candidate + 1]):
        j, amount = state.items[i], float(state.amounts[i])
        before = 1.0 + state.sums[j]
        gain += state.weights[j] * amount / (before * (before + amount))
    return gain


@kernel
def change(state: ErrorState, candidate: int, sign: float) -> None:
    """Add a candidate (`sign` 1) or take it away (-1); bounds hold only while candidates are added."""
    for i in range(state.starts[candidate], state.starts[candidate + 1]):
        j = state.items[i]
        state.sums[j] = max(0.0, state.sums[j] + sign * float(state.amounts[i]))


@kernel
def value(state: ErrorState) -> float:
    """F of what is chosen."""
    total = 0.0
    for j in range(len(state.weights)):
        total += state.weights[j] * state.sums[j] / (1.0 + state.sums[j])
    return total


@kernel
def fill_gains(state: ErrorState, gains: NDArray[np.float64]) -> None:
    """Write the gains of all candidates; as the state's own bounds they are exact for a while."""
    for candidate in range(len(gains)):
        gains[candidate] = gain_of(state, candidate)


@kernel
def greedy_steps(state: ErrorState, chosen: NDArray[np.int64], n_chosen: int, n_wanted: int) -> int:
    """Add the candidate of the largest gain until `n_wanted` are chosen or nothing is gained.

    None is chosen twice: its bound is minus infinity from then on. So is that of one too close to another.
    """
    least = NO_GAIN * state.weights.sum()
    while n_chosen < n_wanted:
        best, looked_at = int(np.argmax(state.bounds)), -1
        while best != looked_at and state.bounds[best] > least:
            state.bounds[best] = gain_of(state, best)
            looked_at, best = best, int(np.argmax(state.bounds))
        if state.bounds[best] <= least:
            break
        state.bounds[best] = -np.inf
        if not is_too_close(state, best, chosen, n_chosen, -1):
            change(state, best, 1.0)
            chosen[n_chosen] = best
            n_chosen += 1
    return n_chosen
