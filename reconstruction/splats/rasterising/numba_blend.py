"""Blending the splats of each square of the picture block by block, front to back, compiled.

What a block of eight pixels adds up stays in registers, and it ends where none of its pixels takes any more.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import inline, kernel
from reconstruction.splats.rasterising.numba_lanes import (
    N_LANES,
    any_of,
    bits_of,
    fetch,
    least_of,
    load_lanes,
    load_number,
    most_of,
    power_of_two,
    root_of,
    rounded,
    select,
    spread,
    store_lanes,
    sum_of,
)
from reconstruction.splats.rasterising.numba_projection import (
    BOTTOM,
    DEPTH,
    DISC_X,
    DISC_Y,
    DOT_RADIUS2,
    HALF_WIDTH,
    HIGHEST,
    J_XU,
    J_XV,
    J_YU,
    J_YV,
    LEFT,
    LOWEST,
    N_GEOMETRY,
    OPACITY,
    OVER_HALF_HEIGHT,
    REST_X,
    REST_Y,
    RIGHT,
    SHEAR,
    TOP,
    WHOLE_X,
    WHOLE_Y,
    E,
    F,
    Floats,
)
from reconstruction.splats.rasterising.raster_types import RasterSettings

# Squares of the picture in blocks of eight pixels, which are one vector: which splats reach each, and what one
# covers.
#
# A square's splats are laid next to each other; of each the blocks that its outline reaches are found once, so that
# more
# than half of the pixels that are worked on count.

Reached = NDArray[np.uint8]
Numbers = NDArray[np.int32]

MIN_ALPHA, MAX_ALPHA, MIN_TRANSMITTANCE, LOW_PASS2 = range(4)
"""Entries of `limits_of`; the last is the low-pass filter's 1 / sigma^2."""

DX, DY = WHOLE_X, WHOLE_Y
"""Columns of a gathered splat: from its middle to the middle of the square's first pixel."""

BLOCK_COLUMNS, BLOCK_ROWS = 4, 2
"""Pixels of a block, which are counted row by row: the shape of eight that is least often reached for one of them."""

AHEAD = 8
"""Splats that are fetched before they are needed: memory is slower than what is done with one."""

ZERO, HALF, ONE = np.float32(0.0), np.float32(0.5), np.float32(1.0)
FAR = np.float32(1e30)

MAX_EXPONENT = np.float32(40.0)
EXP_SCALE = np.float32(-0.5 / math.log(2.0))
C1, C2, C3, C4, C5, C6 = np.array(
    [0.693147206, 0.240226485, 0.0555032904, 0.00961837325, 0.00133998483, 0.000153707048], np.float32
)
"""Of 2^t for t from -0.5 to 0.5: the polynomial with the least squares of relative errors, 2e-9 at most."""


def limits_of(settings: RasterSettings) -> Floats:
    """What kernels need of the settings."""
    s = settings
    return np.array([s.min_alpha, s.max_alpha, s.min_transmittance, s.over_low_pass2], np.float32)


def bytes_a_splat(size: int) -> int:
    """What `find_blocks` needs for each splat of a square of `size` pixels."""
    return -(-size // (N_LANES * BLOCK_ROWS)) * (size // BLOCK_COLUMNS)


@kernel
def most_splats(starts: NDArray[np.int64], first: int, last: int) -> int:
    """Splats of the fullest of the squares `first` to `last`."""
    most = 0
    for tile in range(first, last):
        most = max(most, starts[tile + 1] - starts[tile])
    return most


@kernel
def gather(
    geometry: Floats, features: Floats, splats: Numbers, start: int, stop: int, x0: int, y0: int, g: Floats, f: Floats
) -> None:
    """Lay the splats `start` to `stop` of the square that begins at pixel `x0`, `y0` one after the other.

    Boxes are counted from there, too.
    """
    n_channels, left, top = features.shape[1], np.float32(x0), np.float32(y0)
    for k in range(stop - start):
        later = splats[min(start + k + AHEAD, stop - 1)]
        fetch(geometry, later * N_GEOMETRY)
        fetch(geometry, later * N_GEOMETRY + N_GEOMETRY - 1)
        for c in range(0, n_channels, 2 * N_LANES):
            fetch(features, later * n_channels + c)
        i = splats[start + k]
        for c in range(0, N_GEOMETRY, N_LANES):
            store_lanes(g, k * N_GEOMETRY + c, load_lanes(geometry, i * N_GEOMETRY + c))
        g[k, DX] = (left + HALF - g[k, WHOLE_X]) - g[k, REST_X]
        g[k, DY] = (top + HALF - g[k, WHOLE_Y]) - g[k, REST_Y]
        g[k, LEFT], g[k, RIGHT] = g[k, LEFT] - left, g[k, RIGHT] - left
        g[k, TOP], g[k, BOTTOM] = g[k, TOP] - top, g[k, BOTTOM] - top
        for c in range(0, n_channels, N_LANES):
            store_lanes(f, k * n_channels + c, load_lanes(features, i * n_channels + c))


@inline
def _columns_between(g: Any, at: Any, rows: Any) -> Any:
    """First column of a square that a splat's outline reaches in some rows, and the one behind the last."""
    from_middle = rows + load_number(g, at + DY)
    along = from_middle - load_number(g, at + DISC_Y)
    share = along * load_number(g, at + OVER_HALF_HEIGHT)
    inside = ONE - share * share
    half = load_number(g, at + HALF_WIDTH) * root_of(most_of(inside, ZERO))
    middle = load_number(g, at + DISC_X) + load_number(g, at + SHEAR) * along
    left, right = select(inside >= ZERO, middle - half, FAR), select(inside >= ZERO, middle + half, -FAR)
    inside = load_number(g, at + DOT_RADIUS2) - from_middle * from_middle
    half = select(inside >= ZERO, root_of(most_of(inside, ZERO)), -FAR)
    # Column c begins half a pixel before its middle, which is c + DX from that of the splat.
    shift = HALF - load_number(g, at + DX)
    first = rounded(most_of(least_of(left, -half) + shift, load_number(g, at + LEFT)))
    behind = rounded(least_of(most_of(right, half) + shift, load_number(g, at + RIGHT)))
    is_row = (rows >= load_number(g, at + TOP)) & (rows < load_number(g, at + BOTTOM)) & (first < behind)
    return first, select(is_row, behind, -FAR)


@kernel
def reached_of(reached: Reached, start: int, stop: int, size: int) -> Reached:
    """A square's part of the bytes of all squares: shape (eights of block rows, block columns, splats)."""
    part = reached.reshape(-1)[start * reached.shape[1] : stop * reached.shape[1]]
    return part.reshape((-(-size // (N_LANES * BLOCK_ROWS)), size // BLOCK_COLUMNS, stop - start))


@kernel
def find_blocks(g: Floats, reached: Reached) -> None:
    """Fill in which blocks of a square its splats reach: a bit for each of eight blocks below each other."""
    every_other = load_lanes(np.arange(0.0, 2.0 * N_LANES, 2.0).astype(np.float32), 0)
    for k in range(reached.shape[2]):
        at = k * N_GEOMETRY
        for eight in range(reached.shape[0]):
            upper = every_other + np.float32(eight * BLOCK_ROWS * N_LANES)
            upper_first, upper_behind = _columns_between(g, at, upper)
            lower_first, lower_behind = _columns_between(g, at, upper + ONE)
            for column in range(reached.shape[1]):
                edge, end = np.float32(column * BLOCK_COLUMNS), np.float32((column + 1) * BLOCK_COLUMNS)
                by_upper = bits_of((upper_first < end) & (upper_behind > edge))
                by_lower = bits_of((lower_first < end) & (lower_behind > edge))
                reached[eight, column, k] = by_upper | by_lower


@kernel
def list_block(reached: Reached, row: int, column: int, listed: Numbers) -> int:
    """Number the splats that reach a block, nearest first; how many they are comes back."""
    n, eight, bit = 0, row // N_LANES, row % N_LANES
    for k in range(reached.shape[2]):
        listed[n] = k
        n += (reached[eight, column, k] >> bit) & 1
    return n


@kernel
def block_pixels() -> Floats:
    """Columns and then rows of a block's pixels."""
    places = np.empty(2 * N_LANES, np.float32)
    for p in range(N_LANES):
        places[p], places[N_LANES + p] = p % BLOCK_COLUMNS, p // BLOCK_COLUMNS
    return places


@kernel
def open_pixels(n_columns: int, n_rows: int, through: Floats) -> None:
    """Let everything through the first columns and rows of a block, and nothing through what is outside."""
    for p in range(N_LANES):
        through[p] = ONE if p % BLOCK_COLUMNS < n_columns and p // BLOCK_COLUMNS < n_rows else ZERO


@inline
def meet(g: Any, at: Any, x: Any, y: Any, low_pass2: Any) -> Any:
    """Where the rays of a block's pixels meet the splat whose geometry begins at `at`; see `projection`.

    Returns
    -------
    xx, yy, n_u, n_v
        Pixels from its middle; u and v times D, all over the area.
    over_d, is_within
        1 / D with t limited, and whether it is not.
    disc, is_disc, q
        u^2 + v^2, whether it counts and not the low-pass filter, and what counts.
    """
    xx, yy = x + load_number(g, at + DX), y + load_number(g, at + DY)
    n_u = xx * load_number(g, at + J_YV) - yy * load_number(g, at + J_XV)
    n_v = yy * load_number(g, at + J_XU) - xx * load_number(g, at + J_YU)
    t = xx * load_number(g, at + E) + yy * load_number(g, at + F)
    within = least_of(most_of(t, load_number(g, at + LOWEST)), load_number(g, at + HIGHEST))
    is_within, over_d = t == within, ONE / (ONE + within)
    disc, low = (n_u * n_u + n_v * n_v) * (over_d * over_d), (xx * xx + yy * yy) * low_pass2
    is_disc = is_within & (disc <= low)
    return xx, yy, n_u, n_v, over_d, is_within, disc, is_disc, select(is_disc, disc, low)


@inline
def exp_half(factor: Any, q: Any) -> Any:
    """A factor times exp(-q / 2) for 0 <= q <= 40, to 5e-7; what is larger is taken for 40.

    The polynomial is put together so that as little as possible waits for what comes before.
    """
    t = least_of(q, MAX_EXPONENT) * EXP_SCALE
    whole = rounded(t)
    f = t - whole
    ff = f * f
    low, high = (ONE + f * C1) + ff * (C2 + f * C3), (C4 + f * C5) + ff * C6
    return (factor * power_of_two(whole)) * (low + (ff * ff) * high)


@inline
def alpha_of(opacity: Any, q: Any, least: Any, most: Any) -> Any:
    """What a splat covers, `most` at most, and nothing below `least`."""
    alpha = least_of(exp_half(opacity, q), most)
    return select(alpha >= least, alpha, ZERO)


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
