"""Maximum coverage on candidates and elements with exact gains, kept up to date by an inverse index; compiled.

With counts c_e of chosen views per element, weights w_e and a wanted depth k, the objective is f = sum w_e min(c_e, k):
monotone and submodular. Adding or removing a view touches only the candidates that share one of its elements, so
greedy steps and exchanges cost microseconds.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import inline, kernel

FOREVER = 2**62


class CoverState(NamedTuple):
    """Candidates, elements, and what is chosen so far.

    Parameters
    ----------
    starts, items
        Elements of each candidate: `items[starts[i]:starts[i + 1]]`.
    inverse_starts, inverse_items
        Candidates of each element.
    weights
        Weight of each element.
    counts
        Chosen views per element.
    gains
        How much f grows when a candidate is added, exact.
    depth
        k, shape (1,).
    positions
        Where each candidate stands, shape (n, 3); any shape where `spacing` is 0.
    taken
        Places of views that are there in any case, shape (k, 3).
    spacing
        Two chosen candidates stand at one place or at least this far apart, and so from what is taken; 0: no matter.
    """

    starts: NDArray[np.int64]
    items: NDArray[np.int32]
    inverse_starts: NDArray[np.int64]
    inverse_items: NDArray[np.int32]
    weights: NDArray[np.float64]
    counts: NDArray[np.int32]
    gains: NDArray[np.float64]
    depth: NDArray[np.int64]
    positions: NDArray[np.float64]
    taken: NDArray[np.float64]
    spacing: float


@kernel
def invert(
    starts: NDArray[np.int64], items: NDArray[np.int32], n_elements: int
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Candidates of each element, from the elements of each candidate."""
    inverse_starts = np.zeros(n_elements + 1, np.int64)
    for e in items:
        inverse_starts[e + 1] += 1
    for e in range(n_elements):
        inverse_starts[e + 1] += inverse_starts[e]
    place = inverse_starts[:-1].copy()
    inverse_items = np.empty(len(items), np.int32)
    for c in range(len(starts) - 1):
        for i in range(starts[c], starts[c + 1]):
            e = items[i]
            inverse_items[place[e]] = c
            place[e] += 1
    return inverse_starts, inverse_items


@kernel
def refresh_gains(state: CoverState) -> None:
    """Compute all gains from the counts."""
    for c in range(len(state.gains)):
        gain = 0.0
        for i in range(state.starts[c], state.starts[c + 1]):
            e = state.items[i]
            if state.counts[e] < state.depth[0]:
                gain += state.weights[e]
        state.gains[c] = gain


@kernel
def add_elements(state: CoverState, elements: NDArray[np.int32]) -> None:
    """Count one more view that covers `elements`, and update the gains."""
    for e in elements:
        state.counts[e] += 1
        if state.counts[e] == state.depth[0]:
            for i in range(state.inverse_starts[e], state.inverse_starts[e + 1]):
                state.gains[state.inverse_items[i]] -= state.weights[e]


@kernel
def remove_elements(state: CoverState, elements: NDArray[np.int32]) -> None:
    """Undo `add_elements`."""
    for e in elements:
        if state.counts[e] == state.depth[0]:
            for i in range(state.inverse_starts[e], state.inverse_starts[e + 1]):
                state.gains[state.inverse_items[i]] += state.weights[e]
        state.counts[e] -= 1


@kernel
def loss_of(state: CoverState, elements: NDArray[np.int32]) -> float:
    """How much f shrinks when a chosen view that covers `elements` is removed."""
    loss = 0.0
    for e in elements:
        if state.counts[e] <= state.depth[0]:
            loss += state.weights[e]
    return loss


@kernel
def objective(state: CoverState) -> float:
    """The objective f of what is chosen."""
    total = 0.0
    for e in range(len(state.counts)):
        total += state.weights[e] * min(state.counts[e], state.depth[0])
    return total


@inline
def _is_close(places: NDArray[np.float64], i: int, point: NDArray[np.float64], spacing: float) -> bool:
    """Whether place i is another one than `point`, and closer to it than `spacing`."""
    dx, dy, dz = places[i, 0] - point[0], places[i, 1] - point[1], places[i, 2] - point[2]
    return bool(0.0 < dx * dx + dy * dy + dz * dz < spacing * spacing)


class HasPlaces(Protocol):
    """What says where candidates stand: `CoverState`, or any other tuple with these of its fields."""

    @property
    def positions(self) -> NDArray[np.float64]:
        """Of the candidates."""

    @property
    def taken(self) -> NDArray[np.float64]:
        """By views that are there in any case."""

    @property
    def spacing(self) -> float:
        """Between two places."""


@kernel
def is_too_close(state: HasPlaces, candidate: int, chosen: NDArray[np.int64], n_chosen: int, but: int) -> bool:
    """Whether a candidate is too close to what is taken or to a chosen one; number `but` of these does not count."""
    if state.spacing <= 0.0:
        return False
    point = state.positions[candidate]
    for i in range(len(state.taken)):
        if _is_close(state.taken, i, point, state.spacing):
            return True
    for place in range(n_chosen):
        if place != but and _is_close(state.positions, chosen[place], point, state.spacing):
            return True
    return False


@kernel
def greedy_steps(state: CoverState, chosen: NDArray[np.int64], n_chosen: int, n_wanted: int, enough: float) -> int:
    """Add the candidate of the largest gain until `n_wanted` are chosen, f reaches `enough` or no gain is left.

    `chosen` takes the candidates' numbers; returns how many there are now. Beyond depth 1 a candidate that is chosen
    could still gain by being chosen again; its gain is set to minus infinity, since a second photo from the same place
    is no second view. So is that of a candidate too close to one that is chosen or taken.
    """
    f = objective(state)
    while n_chosen < n_wanted and f < enough:
        best = int(np.argmax(state.gains))
        gain = state.gains[best]
        if gain <= 1e-9:
            break
        if is_too_close(state, best, chosen, n_chosen, -1):
            state.gains[best] = -np.inf
            continue
        add_elements(state, state.items[state.starts[best] : state.starts[best + 1]])
        if state.depth[0] > 1:
            state.gains[best] = -np.inf
        chosen[n_chosen] = best
        n_chosen += 1
        f += gain
    return n_chosen


@kernel
def exchange_steps(
    state: CoverState, chosen: NDArray[np.int64], tabu: NDArray[np.int64], clock: int, n_steps: int, seed: int
) -> float:
    """Swap chosen candidates against others for `n_steps` steps; returns how much f grew (never negative).

    Each step drops a chosen candidate (the one of least loss among a few drawn at random), adds the best other one, and
    undoes both when that makes f smaller. Candidates rest until step `tabu` (counted from `clock`): dropped ones for a
    while, so that steps of equal value do not go in circles, chosen ones for ever, so that none is chosen twice. None
    is taken that stands too close to another.
    """
    np.random.seed(seed)  # noqa: NPY002  (Numba's own generator, per thread)
    grown = 0.0
    n = len(chosen)
    for step in range(clock, clock + n_steps):
        worst, least = -1, np.inf
        for _ in range(4):
            place = np.random.randint(n)  # noqa: NPY002
            c = chosen[place]
            loss = loss_of(state, state.items[state.starts[c] : state.starts[c + 1]])
            if loss < least:
                worst, least = place, loss
        dropped = chosen[worst]
        remove_elements(state, state.items[state.starts[dropped] : state.starts[dropped + 1]])
        tabu[dropped] = step + 1 + n // 4 + np.random.randint(n + 1)  # noqa: NPY002
        best, gain = -1, -1.0
        for c in range(len(state.gains)):
            if state.gains[c] > gain and tabu[c] <= step and not is_too_close(state, c, chosen, n, worst):
                best, gain = c, state.gains[c]
        if best < 0 or gain < least - 1e-9:
            best, gain = dropped, least
        add_elements(state, state.items[state.starts[best] : state.starts[best + 1]])
        chosen[worst] = best
        tabu[best] = FOREVER
        grown += gain - least
    return grown


@kernel
def eject_steps(
    state: CoverState,
    chosen: NDArray[np.int64],
    n_chosen: int,
    open_elements: NDArray[np.int64],
    rests_until: NDArray[np.int64],
    n_steps: int,
    seed: int,
) -> int:
    """Put candidates in whose places are too near to chosen ones, which go for it; returns how many are chosen then.

    Each step takes one of `open_elements` that is still open and a candidate that covers it, takes out what is chosen
    too close to that, and fills up with the best others, as many as `chosen` has room for. All is undone where f falls.
    What was taken out rests for some steps, so that steps of equal value do not go in circles.
    """
    np.random.seed(seed)  # noqa: NPY002  (Numba's own generator, per thread)
    removed, added = np.empty(len(chosen), np.int64), np.empty(len(chosen) + 1, np.int64)
    for step in range(n_steps):
        e = open_elements[np.random.randint(len(open_elements))]  # noqa: NPY002
        if state.counts[e] > 0:
            continue
        candidate = _to_put_in(state, chosen, n_chosen, e, rests_until, step)
        if candidate < 0:
            continue
        before, n_removed, n_added = objective(state), 0, 0
        point, place = state.positions[candidate], 0
        while place < n_chosen:
            if _is_close(state.positions, chosen[place], point, state.spacing):
                removed[n_removed] = chosen[place]
                n_removed += 1
                remove_elements(state, state.items[state.starts[chosen[place]] : state.starts[chosen[place] + 1]])
                n_chosen -= 1
                chosen[place] = chosen[n_chosen]
            else:
                place += 1
        while n_chosen < len(chosen):
            if n_added > 0:
                candidate = _best_apart(state, chosen, n_chosen, rests_until, step)
                if candidate < 0:
                    break
            add_elements(state, state.items[state.starts[candidate] : state.starts[candidate + 1]])
            chosen[n_chosen] = added[n_added] = candidate
            n_chosen += 1
            n_added += 1
        if n_added == 0 or objective(state) < before - 1e-9:
            for i in range(n_added):
                remove_elements(state, state.items[state.starts[added[i]] : state.starts[added[i] + 1]])
            n_chosen -= n_added
            for i in range(n_removed):
                add_elements(state, state.items[state.starts[removed[i]] : state.starts[removed[i] + 1]])
                chosen[n_chosen] = removed[i]
                n_chosen += 1
            continue
        for i in range(n_removed):
            rests_until[removed[i]] = step + 10 + np.random.randint(20)  # noqa: NPY002
    return n_chosen


@kernel
def _to_put_in(
    state: CoverState,
    chosen: NDArray[np.int64],
    n_chosen: int,
    element: int,
    rests_until: NDArray[np.int64],
    step: int,
) -> int:
    """The one of some random candidates that cover an element whose place costs least; -1 where there is none."""
    first, last = state.inverse_starts[element], state.inverse_starts[element + 1]
    best, most = -1, -np.inf
    for _ in range(min(12, last - first)):
        candidate = state.inverse_items[first + np.random.randint(last - first)]  # noqa: NPY002
        if rests_until[candidate] > step:
            continue
        value, point, is_taken = state.gains[candidate], state.positions[candidate], False
        for i in range(len(state.taken)):
            is_taken |= _is_close(state.taken, i, point, state.spacing)
        if is_taken:
            continue
        for place in range(n_chosen):
            if _is_close(state.positions, chosen[place], point, state.spacing):
                c = chosen[place]
                value -= loss_of(state, state.items[state.starts[c] : state.starts[c + 1]])
        if value > most:
            best, most = candidate, value
    return best


@kernel
def _best_apart(
    state: CoverState, chosen: NDArray[np.int64], n_chosen: int, rests_until: NDArray[np.int64], step: int
) -> int:
    """The candidate of the largest gain that is not too close to others; -1 where none gains."""
    best, gain = -1, 1e-9
    for c in range(len(state.gains)):
        if state.gains[c] > gain and rests_until[c] <= step and not is_too_close(state, c, chosen, n_chosen, -1):
            best, gain = c, state.gains[c]
    return best
