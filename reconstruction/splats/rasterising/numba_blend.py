"""Blending the splats of each square of the picture block by block, front to back, compiled.

What a block of eight pixels adds up stays in registers, and it ends where none of its pixels takes any more.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from reconstruction.splats.rasterising.numba_blocks import (
    BLOCK_COLUMNS,
    BLOCK_ROWS,
    LOW_PASS2,
    MAX_ALPHA,
    MIN_ALPHA,
    MIN_TRANSMITTANCE,
    ONE,
    ZERO,
    Numbers,
    Reached,
    alpha_of,
    block_pixels,
    find_blocks,
    gather,
    list_block,
    meet,
    most_splats,
    open_pixels,
    reached_of,
)
from reconstruction.splats.rasterising.numba_lanes import (
    N_LANES,
    any_of,
    load_lanes,
    load_number,
    select,
    spread,
    store_lanes,
    sum_of,
)
from reconstruction.splats.rasterising.numba_projection import DEPTH, N_GEOMETRY, OPACITY, Floats

THROUGH, DEPTH_SUM = 0, N_LANES
"""Places in a block's state: what shines through its pixels, and their blended depth."""


@kernel
def _weigh(
    g: Floats,
    listed: Numbers,
    n_listed: int,
    x: Any,
    y: Any,
    limits: Floats,
    state: Floats,
    weights: Floats,
    slot_weights: Floats,
    start: int,
) -> int:
    """Weights of a block's splats, which are added to the slots from `start` on; how many are taken comes back."""
    least, most, end, low_pass2 = limits[MIN_ALPHA], limits[MAX_ALPHA], limits[MIN_TRANSMITTANCE], limits[LOW_PASS2]
    through, depth_sum, n = load_lanes(state, THROUGH), spread(ZERO), 0
    for j in range(n_listed):
        at = listed[j] * N_GEOMETRY
        _, _, _, _, over_d, _, _, _, q = meet(g, at, x, y, low_pass2)
        alpha = alpha_of(load_number(g, at + OPACITY), q, least, most)
        alpha = select(through >= end, alpha, ZERO)
        weight = through * alpha
        store_lanes(weights, n * N_LANES, weight)
        depth_sum = depth_sum + weight * (load_number(g, at + DEPTH) * over_d)
        slot_weights[start + listed[j]] += sum_of(weight)
        through = through * (ONE - alpha)
        n += 1
        if not any_of(through >= end):
            break
    store_lanes(state, THROUGH, through)
    store_lanes(state, DEPTH_SUM, depth_sum)
    return n


@kernel
def _add_features(f: Floats, listed: Numbers, n: int, weights: Floats, sums: Floats) -> None:
    """Blend the features of a block's first `n` splats, eight of them at once, into shape (8, c)."""
    n_channels = f.shape[1]
    for c in range(0, n_channels, N_LANES):
        s0, s1, s2, s3 = spread(ZERO), spread(ZERO), spread(ZERO), spread(ZERO)
        s4, s5, s6, s7 = spread(ZERO), spread(ZERO), spread(ZERO), spread(ZERO)
        for j in range(n):
            feature, w = load_lanes(f, listed[j] * n_channels + c), j * N_LANES
            s0, s1 = s0 + feature * load_number(weights, w), s1 + feature * load_number(weights, w + 1)
            s2, s3 = s2 + feature * load_number(weights, w + 2), s3 + feature * load_number(weights, w + 3)
            s4, s5 = s4 + feature * load_number(weights, w + 4), s5 + feature * load_number(weights, w + 5)
            s6, s7 = s6 + feature * load_number(weights, w + 6), s7 + feature * load_number(weights, w + 7)
        store_lanes(sums, c, s0)
        store_lanes(sums, c + n_channels, s1)
        store_lanes(sums, c + 2 * n_channels, s2)
        store_lanes(sums, c + 3 * n_channels, s3)
        store_lanes(sums, c + 4 * n_channels, s4)
        store_lanes(sums, c + 5 * n_channels, s5)
        store_lanes(sums, c + 6 * n_channels, s6)
        store_lanes(sums, c + 7 * n_channels, s7)


@kernel
def _distinct(labels: Numbers, splats: Numbers, start: int, stop: int, places: Numbers) -> Numbers:
    """Labels of the splats `start` to `stop`, each once, and in `places` where each splat's own is among them."""
    found, n, last = np.empty(stop - start, np.int32), 0, 0
    for j in range(stop - start):
        label = labels[splats[start + j]]
        if n == 0 or found[last] != label:
            last = 0
            while last < n and found[last] != label:
                last += 1
            if last == n:
                found[n] = label
                n += 1
        places[j] = last
    return found[:n]


@kernel
def _vote(listed: Numbers, n: int, weights: Floats, places: Numbers, votes: Floats) -> None:
    """Add up the weights of a block's first `n` splats by label, shape (n_labels, 8)."""
    votes[:] = ZERO
    for j in range(n):
        at = places[listed[j]] * N_LANES
        store_lanes(votes, at, load_lanes(votes, at) + load_lanes(weights, j * N_LANES))


@kernel
def _heaviest(known: Numbers, votes: Floats, pixel: int) -> int:
    best, found = ZERO, np.int32(-1)
    for k in range(len(known)):
        vote = votes[k, pixel]
        if vote > best or (vote == best and vote > ZERO and known[k] < found):
            best, found = vote, known[k]
    return int(found)


@kernel
def blend_tiles(
    geometry: Floats,
    features: Floats,
    starts: NDArray[np.int64],
    splats: Numbers,
    limits: Floats,
    size: int,
    n_columns: int,
    labels: Numbers,
    first: int,
    last: int,
    picture: Floats,
    alphas: Floats,
    depths: Floats,
    heaviest: Numbers,
    slot_weights: Floats,
    reached: Reached,
) -> None:
    """Blend squares `first` to `last` into the last six arrays.

    Parameters
    ----------
    features
        Shape (n, c'), c' the next multiple of eight.
    labels
        Shape (n,), or (0,) where `heaviest` is not wanted.
    slot_weights, reached
        A number and `bytes_a_splat` for each of `splats`: its weight in its square, and the blocks that it reaches.
    """
    height, width, n_wanted = picture.shape
    most, in_row, has_labels = most_splats(starts, first, last), size // BLOCK_COLUMNS, len(labels) > 0
    g, f = np.empty((most, N_GEOMETRY), np.float32), np.empty((most, features.shape[1]), np.float32)
    # One more than there can be, because a splat is written down before it is known whether it counts.
    listed, places = np.empty(most + 1, np.int32), np.empty(most if has_labels else 0, np.int32)
    weights, state = np.empty(most * N_LANES, np.float32), np.empty(2 * N_LANES, np.float32)
    sums, pixels = np.empty((N_LANES, features.shape[1]), np.float32), block_pixels()
    for tile in range(first, last):
        x0, y0 = (tile % n_columns) * size, (tile // n_columns) * size
        start, stop = starts[tile], starts[tile + 1]
        slot_weights[start:stop] = ZERO
        known = _distinct(labels, splats, start, stop, places) if has_labels else labels
        votes = np.empty((len(known), N_LANES), np.float32)
        gather(geometry, features, splats, start, stop, x0, y0, g, f)
        own = reached_of(reached, start, stop, size)
        find_blocks(g, own)
        for block in range(in_row * (size // BLOCK_ROWS)):
            row, column = block // in_row * BLOCK_ROWS, block % in_row * BLOCK_COLUMNS
            if x0 + column >= width or y0 + row >= height:
                continue
            open_pixels(width - x0 - column, height - y0 - row, state)
            x, y = load_lanes(pixels, 0) + np.float32(column), load_lanes(pixels, N_LANES) + np.float32(row)
            n = list_block(own, row // BLOCK_ROWS, column // BLOCK_COLUMNS, listed)
            n = _weigh(g, listed, n, x, y, limits, state, weights, slot_weights, start)
            _add_features(f, listed, n, weights, sums)
            if has_labels:
                _vote(listed, n, weights, places, votes)
            for p in range(N_LANES):
                r, c = y0 + row + p // BLOCK_COLUMNS, x0 + column + p % BLOCK_COLUMNS
                if r >= height or c >= width:
                    continue
                alphas[r, c], depths[r, c] = ONE - state[THROUGH + p], state[DEPTH_SUM + p]
                for channel in range(n_wanted):
                    picture[r, c, channel] = sums[p, channel]
                if has_labels:
                    heaviest[r, c] = _heaviest(known, votes, p)
