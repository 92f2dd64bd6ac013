"""The way back through the blending of each square, compiled.

The squares' splats are drawn again front to back, which keeps what shone through in front of each; then, back to front,
what lies behind is added up. Nothing is divided by what is left of the light and nothing large cancels, as it would in
"all less what lies in front". Each splat in each square has a row of gradients of its own (its slot), so that nothing
depends on the order in which threads finish.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planning.jit import kernel
from reconstruction.splatting.numba_blend import (
    CLOSED_EVERY,
    DX,
    DY,
    LOW_PASS2,
    MAX_ALPHA,
    MIN_TRANSMITTANCE,
    ONE,
    ZERO,
    Array32,
    Index,
    draw_splat,
    gather,
    is_closed,
    open_pixels,
    pixel_numbers,
)
from reconstruction.splatting.numba_projection import (
    CENTRE_X,
    CENTRE_Y,
    DEPTH,
    HIGHEST,
    J_XU,
    J_XV,
    J_YU,
    J_YV,
    LOWEST,
    N_GRADIENTS,
    OPACITY,
    E,
    F,
)
from reconstruction.splatting.numba_tiles import lanes_kernel

HALF, TWO = np.float32(0.5), np.float32(2.0)


@lanes_kernel
def _weigh_again(
    first: int, last: int, shift: int, least: float, alpha: Array32, through: Array32, before: Array32
) -> float:
    """What shone through in front of a splat, and after it; alpha becomes 0 in closed pixels. Sum of the weights."""
    total = ZERO
    for i in range(first, last):
        a = alpha[i + shift] if through[i] >= least else ZERO
        before[i + shift] = through[i]
        alpha[i + shift] = a
        total += through[i] * a
        through[i] = through[i] * (ONE - a)
    return float(total)


@lanes_kernel
def _through_features(
    first: int,
    last: int,
    shift: int,
    alpha: Array32,
    before: Array32,
    features: Array32,
    k: int,
    wanted: Array32,
    wanted_more: Array32,
    weight: Array32,
    gain: Array32,
    slots: Array32,
    slot: int,
) -> None:
    """Gradients of a splat's features, from column `N_GRADIENTS` of its slot on, and what a unit of weight gains.

    Parameters
    ----------
    features, k
        Shape (m, c), c a multiple of four, and the row of the splat.
    wanted, wanted_more
        Gradients of the square's features, shape (c, n_pixels), and of its alphas and depths, shape (2, n_pixels).
    """
    for i in range(first, last):
        weight[i] = alpha[i + shift] * before[i + shift]
        gain[i] = wanted_more[0, i]
    for c in range(0, features.shape[1], 4):
        feature_0, feature_1 = features[k, c], features[k, c + 1]
        feature_2, feature_3 = features[k, c + 2], features[k, c + 3]
        sum_0, sum_1, sum_2, sum_3 = ZERO, ZERO, ZERO, ZERO
        for i in range(first, last):
            w, g_0, g_1, g_2, g_3 = weight[i], wanted[c, i], wanted[c + 1, i], wanted[c + 2, i], wanted[c + 3, i]
            gain[i] += feature_0 * g_0 + feature_1 * g_1 + feature_2 * g_2 + feature_3 * g_3
            sum_0, sum_1, sum_2, sum_3 = sum_0 + w * g_0, sum_1 + w * g_1, sum_2 + w * g_2, sum_3 + w * g_3
        column = N_GRADIENTS + c
        slots[slot, column], slots[slot, column + 1] = sum_0, sum_1
        slots[slot, column + 2], slots[slot, column + 3] = sum_2, sum_3


@lanes_kernel
def _through_geometry(
    first: int,
    last: int,
    shift: int,
    geometry: Array32,
    k: int,
    limits: Array32,
    x: Array32,
    y: Array32,
    alpha: Array32,
    before: Array32,
    gain: Array32,
    wanted_more: Array32,
    behind: Array32,
    slots: Array32,
    slot: int,
) -> None:
    """Gradients of a splat's geometry; `behind`, the gain of all that lies behind it, takes the splat in.

    With w = T alpha the change of the result with alpha is T gain - behind / (1 - alpha).
    """
    dx, dy = geometry[k, DX], geometry[k, DY]
    j_xu, j_xv, j_yu, j_yv = geometry[k, J_XU], geometry[k, J_XV], geometry[k, J_YU], geometry[k, J_YV]
    e, f, middle, opacity = geometry[k, E], geometry[k, F], geometry[k, DEPTH], geometry[k, OPACITY]
    lowest, highest = geometry[k, LOWEST], geometry[k, HIGHEST]
    most, low_pass2 = limits[MAX_ALPHA], limits[LOW_PASS2]
    s_u, s_v, s_t = ZERO, ZERO, ZERO
    xs_u, ys_u, xs_v, ys_v, xs_t, ys_t = ZERO, ZERO, ZERO, ZERO, ZERO, ZERO
    s_x, s_y, s_depth, s_alpha = ZERO, ZERO, ZERO, ZERO
    for i in range(first, last):
        xx, yy = x[i] + dx, y[i] + dy
        n_u, n_v, t = xx * j_yv - yy * j_xv, yy * j_xu - xx * j_yu, xx * e + yy * f
        within = min(max(t, lowest), highest)
        over_d = ONE / (ONE + within)
        disc, low = (n_u * n_u + n_v * n_v) * over_d * over_d, (xx * xx + yy * yy) * low_pass2
        is_disc = (t == within) & (disc <= low)
        depth = middle * over_d
        a, w, wanted_depth = alpha[i + shift], alpha[i + shift] * before[i + shift], wanted_more[1, i]
        gained = gain[i] + depth * wanted_depth
        g_a = before[i + shift] * gained - behind[i] / (ONE - a) if a > ZERO else ZERO
        behind[i] += w * gained
        g_a = g_a if a < most else ZERO
        s_alpha += g_a * a
        g_q = -HALF * g_a * a
        # The disc's exponent is (n_u^2 + n_v^2) / d^2, the depth middle / d, and d is 1 + t.
        g_disc, g_low = g_q if is_disc else ZERO, ZERO if is_disc else g_q
        g_z = w * wanted_depth
        s_depth += g_z * over_d
        g_t = -over_d * (TWO * g_disc * disc + g_z * depth) if t == within else ZERO
        g_n2 = g_disc * over_d * over_d
        g_u, g_v = TWO * n_u * g_n2, TWO * n_v * g_n2
        s_u, xs_u, ys_u = s_u + g_u, xs_u + xx * g_u, ys_u + yy * g_u
        s_v, xs_v, ys_v = s_v + g_v, xs_v + xx * g_v, ys_v + yy * g_v
        s_t, xs_t, ys_t = s_t + g_t, xs_t + xx * g_t, ys_t + yy * g_t
        s_x, s_y = s_x + xx * g_low, s_y + yy * g_low
    slots[slot, J_XU], slots[slot, J_XV], slots[slot, J_YU], slots[slot, J_YV] = ys_v, -ys_u, -xs_v, xs_u
    slots[slot, E], slots[slot, F], slots[slot, DEPTH], slots[slot, OPACITY] = xs_t, ys_t, s_depth, s_alpha / opacity
    slots[slot, CENTRE_X] = -(s_u * j_yv - s_v * j_yu + s_t * e + TWO * low_pass2 * s_x)
    slots[slot, CENTRE_Y] = -(s_v * j_xu - s_u * j_xv + s_t * f + TWO * low_pass2 * s_y)


@kernel
def _square_of(wanted: Array32, x0: int, y0: int, size: int, square: Array32) -> None:
    """Channels of a square, shape (c, size * size), out of a picture, shape (h, w, c); 0 beyond its edge."""
    square[:] = ZERO
    for row in range(min(size, wanted.shape[0] - y0)):
        for column in range(min(size, wanted.shape[1] - x0)):
            for c in range(wanted.shape[2]):
                square[c, row * size + column] = wanted[y0 + row, x0 + column, c]


@kernel
def gradients_of_tiles(
    geometry: Array32,
    centres: NDArray[np.float64],
    boxes: NDArray[np.int32],
    features: Array32,
    starts: Index,
    splats: NDArray[np.int32],
    limits: Array32,
    size: int,
    n_columns: int,
    wanted: Array32,
    wanted_more: Array32,
    first: int,
    last: int,
    slots: Array32,
) -> None:
    """Gradients of each splat in each of the squares `first` to `last`.

    Parameters
    ----------
    wanted, wanted_more
        Gradients of the features, shape (h, w, c), and of alphas and depths, shape (h, w, 2).
    slots
        Shape (n_slots, 10 + c): `numba_projection`'s columns, then the features.
    """
    n_channels, n = features.shape[1], size * size
    x, y = pixel_numbers(size)
    through, gain, behind = np.empty(n, np.float32), np.empty(n, np.float32), np.empty(n, np.float32)
    depth, weight = np.empty(n, np.float32), np.empty(n, np.float32)
    of_features, of_more = np.empty((n_channels, n), np.float32), np.empty((2, n), np.float32)
    alpha, before = np.empty(0, np.float32), np.empty(0, np.float32)
    for tile in range(first, last):
        x0, y0 = (tile % n_columns) * size, (tile // n_columns) * size
        start, stop = starts[tile], starts[tile + 1]
        g, f, runs = gather(geometry, centres, boxes, features, splats, start, stop, x0, y0, size)
        # Where each one's pixel 0 would lie in the scratch arrays; unsigned, it may be "below" their beginning.
        shifts, n_scratch = np.empty(stop - start, np.uint64), np.uint64(0)
        for k in range(stop - start):
            shifts[k] = n_scratch - runs[k, 0]
            n_scratch += runs[k, 1] - runs[k, 0]
        if n_scratch > len(alpha):
            alpha, before = np.empty(n_scratch, np.float32), np.empty(n_scratch, np.float32)
        _square_of(wanted, x0, y0, size, of_features)
        _square_of(wanted_more, x0, y0, size, of_more)
        open_pixels(through, size, wanted.shape[1] - x0, wanted.shape[0] - y0)
        behind[:] = ZERO
        is_hit = np.zeros(stop - start, np.bool_)
        for k in range(stop - start):
            if k % CLOSED_EVERY == CLOSED_EVERY - 1 and is_closed(through, limits[MIN_TRANSMITTANCE]):
                break
            a, b, shift = runs[k, 0], runs[k, 1], shifts[k]
            if draw_splat(g, k, limits, x, y, a, b, shift, alpha, depth) > ZERO:
                is_hit[k] = _weigh_again(a, b, shift, limits[MIN_TRANSMITTANCE], alpha, through, before) > ZERO
        for k in range(stop - start - 1, -1, -1):
            slot = start + k
            if not is_hit[k]:
                for column in range(slots.shape[1]):
                    slots[slot, column] = ZERO
                continue
            a, b, shift = runs[k, 0], runs[k, 1], shifts[k]
            _through_features(a, b, shift, alpha, before, f, k, of_features, of_more, weight, gain, slots, slot)
            _through_geometry(a, b, shift, g, k, limits, x, y, alpha, before, gain, of_more, behind, slots, slot)
