"""The way back through the blending of each square, compiled.

The splats of a block are drawn again front to back, which keeps what shone through in front of each; then, back to
front, what lies behind is added up. Nothing is divided by what is left of the light and nothing large cancels, as it
would in "all less what lies in front". Each splat in each square has a row of gradients of its own (its slot), so that
nothing depends on the order in which threads finish.
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
    sums_of,
)
from reconstruction.splats.rasterising.numba_projection import (
    DEPTH,
    J_XU,
    J_XV,
    J_YU,
    J_YV,
    N_GEOMETRY,
    OPACITY,
    E,
    F,
    Floats,
)
from reconstruction.splats.rasterising.numba_splat_gradients import OF_FEATURES

ALPHA, BEFORE, WEIGHT, GAIN = 0, N_LANES, 2 * N_LANES, 3 * N_LANES
N_KEPT = 4 * N_LANES
"""What is kept of a splat in a block from the way there to the way back: its alpha, what shone through in front of it,
the product of the two, and by how much the result changes with it."""


@kernel
def _draw_again(
    g: Floats,
    listed: Numbers,
    n_listed: int,
    x: Any,
    y: Any,
    limits: Floats,
    through: Any,
    of_alpha: Any,
    kept: Floats,
) -> int:
    """Fill in what is kept, of the gain what comes by the picture's alpha; how many splats are taken comes back."""
    least, most, end, low_pass2 = limits[MIN_ALPHA], limits[MAX_ALPHA], limits[MIN_TRANSMITTANCE], limits[LOW_PASS2]
    n = 0
    for j in range(n_listed):
        at = listed[j] * N_GEOMETRY
        _, _, _, _, _, _, _, _, q = meet(g, at, x, y, low_pass2)
        alpha = alpha_of(load_number(g, at + OPACITY), q, least, most)
        alpha = select(through >= end, alpha, ZERO)
        place = n * N_KEPT
        store_lanes(kept, place + ALPHA, alpha)
        store_lanes(kept, place + BEFORE, through)
        store_lanes(kept, place + WEIGHT, through * alpha)
        store_lanes(kept, place + GAIN, of_alpha)
        through = through * (ONE - alpha)
        n += 1
        if not any_of(through >= end):
            break
    return n


@kernel
def _through_features(
    f: Floats, listed: Numbers, n: int, of_pixels: Floats, of_channels: Floats, kept: Floats, slots: Floats, start: int
) -> None:
    """Add the gradients of a block's features to the slots from `start` on, and what they are worth to the gains.

    Parameters
    ----------
    of_pixels, of_channels
        Gradients of the picture, shapes (8, c) and (c, 8).
    """
    n_channels, n_slot = f.shape[1], slots.shape[1]
    for c in range(0, n_channels, N_LANES):
        p0, p1 = load_lanes(of_pixels, c), load_lanes(of_pixels, c + n_channels)
        p2, p3 = load_lanes(of_pixels, c + 2 * n_channels), load_lanes(of_pixels, c + 3 * n_channels)
        p4, p5 = load_lanes(of_pixels, c + 4 * n_channels), load_lanes(of_pixels, c + 5 * n_channels)
        p6, p7 = load_lanes(of_pixels, c + 6 * n_channels), load_lanes(of_pixels, c + 7 * n_channels)
        at = c * N_LANES
        c0, c1 = load_lanes(of_channels, at), load_lanes(of_channels, at + N_LANES)
        c2, c3 = load_lanes(of_channels, at + 2 * N_LANES), load_lanes(of_channels, at + 3 * N_LANES)
        c4, c5 = load_lanes(of_channels, at + 4 * N_LANES), load_lanes(of_channels, at + 5 * N_LANES)
        c6, c7 = load_lanes(of_channels, at + 6 * N_LANES), load_lanes(of_channels, at + 7 * N_LANES)
        for j in range(n):
            gain, of = j * N_KEPT + GAIN, listed[j] * n_channels + c
            even = load_lanes(kept, gain) + c0 * load_number(f, of) + c2 * load_number(f, of + 2)
            odd = c1 * load_number(f, of + 1) + c3 * load_number(f, of + 3)
            even = even + c4 * load_number(f, of + 4) + c6 * load_number(f, of + 6)
            odd = odd + c5 * load_number(f, of + 5) + c7 * load_number(f, of + 7)
            store_lanes(kept, gain, even + odd)
            w, slot = j * N_KEPT + WEIGHT, (start + listed[j]) * n_slot + OF_FEATURES + c
            even = load_lanes(slots, slot) + p0 * load_number(kept, w) + p2 * load_number(kept, w + 2)
            odd = p1 * load_number(kept, w + 1) + p3 * load_number(kept, w + 3)
            even = even + p4 * load_number(kept, w + 4) + p6 * load_number(kept, w + 6)
            odd = odd + p5 * load_number(kept, w + 5) + p7 * load_number(kept, w + 7)
            store_lanes(slots, slot, even + odd)


@kernel
def _through_geometry(
    g: Floats,
    listed: Numbers,
    n: int,
    x: Any,
    y: Any,
    limits: Floats,
    of_depth: Any,
    kept: Floats,
    slots: Floats,
    start: int,
) -> None:
    """Add the gradients of a block's geometry to the slots from `start` on, back to front.

    With w = T alpha the change of the result with alpha is T gain - behind / (1 - alpha), `behind` being the gain of
    all that lies behind.
    """
    most, low_pass2, n_slot, behind = limits[MAX_ALPHA], limits[LOW_PASS2], slots.shape[1], spread(ZERO)
    for j in range(n - 1, -1, -1):
        k, place, at = listed[j], j * N_KEPT, listed[j] * N_GEOMETRY
        alpha, before = load_lanes(kept, place + ALPHA), load_lanes(kept, place + BEFORE)
        weight = load_lanes(kept, place + WEIGHT)
        xx, yy, n_u, n_v, over_d, is_within, disc, is_disc, _ = meet(g, at, x, y, low_pass2)
        depth = load_number(g, at + DEPTH) * over_d
        gain = load_lanes(kept, place + GAIN) + depth * of_depth
        g_alpha = before * gain - behind / (ONE - alpha)
        behind = behind + weight * gain
        # With the exponent q of alpha = o exp(-q / 2), the change with ln alpha is -2 times that with q.
        g_log = select((alpha > ZERO) & (alpha < most), g_alpha, ZERO) * alpha
        g_disc, g_low = select(is_disc, g_log, ZERO), select(is_disc, ZERO, g_log) * low_pass2
        # The disc's exponent is (n_u^2 + n_v^2) / d^2, the depth middle / d, and d is 1 + t.
        g_z = weight * of_depth
        g_t = select(is_within, (g_disc * disc - g_z * depth) * over_d, ZERO)
        g_n2 = g_disc * (over_d * over_d)
        u, v = n_u * g_n2, n_v * g_n2
        of_x = u * load_number(g, at + J_YV) - v * load_number(g, at + J_YU) - g_t * load_number(g, at + E) + xx * g_low
        of_y = v * load_number(g, at + J_XU) - u * load_number(g, at + J_XV) - g_t * load_number(g, at + F) + yy * g_low
        slot = (start + k) * n_slot
        sums = sums_of(-(yy * v), yy * u, xx * v, -(xx * u), xx * g_t, yy * g_t, of_x, of_y)
        store_lanes(slots, slot, load_lanes(slots, slot) + sums)
        slots[start + k, n_slot - 2] += sum_of(g_z * over_d)
        slots[start + k, n_slot - 1] += sum_of(g_log)


@kernel
def _block_of(
    wanted: Floats,
    wanted_alphas: Floats,
    wanted_depths: Floats,
    x0: int,
    y0: int,
    of_pixels: Floats,
    of_channels: Floats,
    of_more: Floats,
) -> None:
    """A block's part of the pictures into shapes (8, c), (c, 8), and (2, 8) for alpha and depth; 0 beyond the edge."""
    for p in range(N_LANES):
        r, c = y0 + p // BLOCK_COLUMNS, x0 + p % BLOCK_COLUMNS
        is_in = r < wanted.shape[0] and c < wanted.shape[1]
        of_more[0, p], of_more[1, p] = wanted_alphas[r, c] if is_in else ZERO, wanted_depths[r, c] if is_in else ZERO
        for channel in range(wanted.shape[2]):
            of_pixels[p, channel] = wanted[r, c, channel] if is_in else ZERO
    for channel in range(wanted.shape[2]):
        for p in range(N_LANES):
            of_channels[channel, p] = of_pixels[p, channel]


@kernel
def gradients_of_tiles(
    geometry: Floats,
    features: Floats,
    starts: NDArray[np.int64],
    splats: Numbers,
    limits: Floats,
    size: int,
    n_columns: int,
    reached: Reached,
    wanted: Floats,
    wanted_alphas: Floats,
    wanted_depths: Floats,
    first: int,
    last: int,
    slots: Floats,
) -> None:
    """Gradients of each splat in each of the squares `first` to `last`.

    Parameters
    ----------
    features, reached
        As `blend_tiles` took and filled them.
    wanted, wanted_alphas, wanted_depths
        Gradients of the features, shape (h, w, c), and of alphas and depths, shape (h, w).
    slots
        Shape (n_slots, 10 + c'), columns as `numba_splat_gradients` has them.
    """
    height, width = wanted.shape[:2]
    most, in_row, n_channels = most_splats(starts, first, last), size // BLOCK_COLUMNS, features.shape[1]
    g, f = np.empty((most, N_GEOMETRY), np.float32), np.empty((most, n_channels), np.float32)
    listed, kept = np.empty(most + 1, np.int32), np.empty(most * N_KEPT, np.float32)
    through, of_more, pixels = np.empty(N_LANES, np.float32), np.empty((2, N_LANES), np.float32), block_pixels()
    of_pixels, of_channels = np.zeros((N_LANES, n_channels), np.float32), np.zeros((n_channels, N_LANES), np.float32)
    for tile in range(first, last):
        x0, y0 = (tile % n_columns) * size, (tile // n_columns) * size
        start, stop = starts[tile], starts[tile + 1]
        slots[start:stop] = ZERO
        gather(geometry, features, splats, start, stop, x0, y0, g, f)
        own = reached_of(reached, start, stop, size)
        for block in range(in_row * (size // BLOCK_ROWS)):
            row, column = block // in_row * BLOCK_ROWS, block % in_row * BLOCK_COLUMNS
            if x0 + column >= width or y0 + row >= height:
                continue
            open_pixels(width - x0 - column, height - y0 - row, through)
            _block_of(wanted, wanted_alphas, wanted_depths, x0 + column, y0 + row, of_pixels, of_channels, of_more)
            x, y = load_lanes(pixels, 0) + np.float32(column), load_lanes(pixels, N_LANES) + np.float32(row)
            n = list_block(own, row // BLOCK_ROWS, column // BLOCK_COLUMNS, listed)
            n = _draw_again(g, listed, n, x, y, limits, load_lanes(through, 0), load_lanes(of_more, 0), kept)
            _through_features(f, listed, n, of_pixels, of_channels, kept, slots, start)
            _through_geometry(g, listed, n, x, y, limits, load_lanes(of_more, N_LANES), kept, slots, start)
        for k in range(stop - start):
            slots[start + k, slots.shape[1] - 1] /= g[k, OPACITY]
