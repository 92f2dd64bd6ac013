"""The way back through the blending of each square, compiled.

The splats of a block are drawn again front to back, which keeps what shone through in front of each; then, back to
front, what lies behind is added up. Nothing is divided by what is left of the light and nothing large cancels, as it
would in "all less what lies in front". Each splat in each square has a row of gradients of its own (its slot), so that
nothing depends on the order in which threads finish.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import inline, kernel
from reconstruction.splats.rasterising.numba_blend import (
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
    fetch,
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
    EDGE_ON_JACOBIAN,
    J_XU,
    J_XV,
    J_YU,
    J_YV,
    N_GEOMETRY,
    OPACITY,
    Array,
    E,
    F,
    Floats,
    Four,
    Pair,
    Quat,
    Slopes,
    Triple,
    blurred_disc,
    covariance_of,
    cross,
    dot,
    ellipse_covariance,
    planes_of,
    see,
    see_ellipsoid,
    slopes_of_shown,
)
from reconstruction.splats.rasterising.projection import SMALLEST

# The way back from each splat's geometry to its parameters, compiled.
#
# What the squares found is added up splat by splat in a fixed order; the formulas are those of `projection`, in
# float64.

CENTRE_X, CENTRE_Y, OF_FEATURES = 6, 7, 8
"""Columns of a slot behind those of J, e and f: of the middle's pixel and, up to two from the end, of the features; the
last two are of the depth and the opacity."""
N_OTHERS = 10
"""Columns of a slot that are not of features."""

AHEAD = 8
"""Slots that are fetched before they are needed: memory is slower than what is done with one."""


@inline
def _in_world(camera: Array, x: float, y: float, z: float) -> Triple:
    """A direction of camera axes in the model's frame."""
    return (
        camera[0, 0] * x + camera[1, 0] * y + camera[2, 0] * z,
        camera[0, 1] * x + camera[1, 1] * y + camera[2, 1] * z,
        camera[0, 2] * x + camera[1, 2] * y + camera[2, 2] * z,
    )


@inline
def _back_through_disc(jacobian: Four, slopes: Pair, g: Array) -> tuple[Four, Pair]:
    """From the gradients of the geometry to those of the Jacobian and the slopes."""
    j_xu, j_xv, j_yu, j_yv = jacobian
    q_u, q_v = slopes
    over_area = 1.0 / (j_xu * j_yv - j_xv * j_yu)
    e, f = j_yu * q_v - j_yv * q_u, j_xv * q_u - j_xu * q_v
    g_xu, g_xv, g_yu, g_yv = g[J_XU] * over_area, g[J_XV] * over_area, g[J_YU] * over_area, g[J_YV] * over_area
    g_e, g_f = g[E] * over_area, g[F] * over_area
    g_area = -(g_xu * j_xu + g_xv * j_xv + g_yu * j_yu + g_yv * j_yv + g_e * e + g_f * f) * over_area
    g_jacobian = (
        g_xu + g_area * j_yv - g_f * q_v,
        g_xv - g_area * j_yu + g_f * q_u,
        g_yu - g_area * j_xv + g_e * q_v,
        g_yv + g_area * j_xu - g_e * q_u,
    )
    return g_jacobian, (g_f * j_xv - g_e * j_yv, g_e * j_yu - g_f * j_xu)


@inline
def _back_through_blur(
    jacobian: Four, slopes: Pair, blur2: float, steepest: float, g_drawn: Four, g_slopes: Pair, g_share: float
) -> tuple[Four, Pair]:
    """From the gradients of J', q' and the share to those of J and q; `blurred_disc` has the formulas."""
    j_xu, j_xv, j_yu, j_yv = jacobian
    (xx, xy, yy), root, area = covariance_of(jacobian, blur2)
    square = root * root
    likely, plane, over, is_flat = planes_of(jacobian, slopes, (xx, xy, yy), square, area, steepest)
    rest, upper = 1.0 - over * area, math.sqrt(xx)
    p_x, p_y = rest * likely[0] + over * plane[0], rest * likely[1] + over * plane[1]
    beside, lower, over_upper = xy / upper, root / upper, 1.0 / upper
    # q' to p' and J'.
    g_px, g_py = -upper * g_slopes[0], -beside * g_slopes[0] - lower * g_slopes[1]
    g_upper, g_beside = g_drawn[0] - p_x * g_slopes[0], g_drawn[2] - p_y * g_slopes[0]
    g_lower = g_drawn[3] - p_y * g_slopes[1]
    # p' to its two parts.
    g_over = plane[0] * g_px + plane[1] * g_py - area * (likely[0] * g_px + likely[1] * g_py)
    g_rx, g_ry = over * g_px, over * g_py
    g_area = -over * (likely[0] * g_px + likely[1] * g_py)
    steepness2 = plane[0] * plane[0] + plane[1] * plane[1]
    if is_flat:
        g_area -= over * over * g_over
    elif steepness2 > SMALLEST * SMALLEST:
        g_area += steepest * steepest / steepness2 * g_over
        by_plane = 2.0 * over / steepness2 * g_over
        g_rx, g_ry = g_rx - by_plane * plane[0], g_ry - by_plane * plane[1]
    by_x, by_y = rest * g_px / square, rest * g_py / square
    x, y = j_xu * slopes[0] + j_xv * slopes[1], j_yu * slopes[0] + j_yv * slopes[1]
    g_x, g_y = by_y * xy - by_x * yy, by_x * xy - by_y * xx
    # C, its determinant, and the area.
    g_root = g_lower * over_upper - g_share * abs(area) / square
    g_square = 0.5 * g_root / root - by_x * likely[0] - by_y * likely[1]
    g_xx = 0.5 * over_upper * (g_upper - (g_beside * beside + g_lower * lower) * over_upper) - by_y * y
    g_xy, g_yy = g_beside * over_upper + by_x * y + by_y * x, -by_x * x
    g_area += 2.0 * g_square * area + g_share * math.copysign(1.0 / root, area)
    g_xx, g_yy = 2.0 * (g_xx + blur2 * g_square), 2.0 * (g_yy + blur2 * g_square)
    g_jacobian = (
        g_xx * j_xu + g_xy * j_yu + g_area * j_yv + g_x * slopes[0] - g_ry * slopes[1],
        g_xx * j_xv + g_xy * j_yv - g_area * j_yu + g_x * slopes[1] + g_ry * slopes[0],
        g_yy * j_yu + g_xy * j_xu - g_area * j_xv + g_y * slopes[0] + g_rx * slopes[1],
        g_yy * j_yv + g_xy * j_xv + g_area * j_xu + g_y * slopes[1] - g_rx * slopes[0],
    )
    g_u = g_x * j_xu + g_y * j_yu + g_ry * j_xv - g_rx * j_yv
    return g_jacobian, (g_u, g_x * j_xv + g_y * j_yv + g_rx * j_yu - g_ry * j_xu)


@inline
def _back_to_quat(q: Quat, g_u: Triple, g_v: Triple, out: Floats, i: int) -> None:
    """From the gradients of a rotation's first two columns to the quaternion of any length."""
    norm, w, x, y, z = q
    g_w = 2.0 * (z * g_u[1] - y * g_u[2] - z * g_v[0] + x * g_v[2])
    g_x = 2.0 * (y * g_u[1] + z * g_u[2] + y * g_v[0] - 2.0 * x * g_v[1] + w * g_v[2])
    g_y = 2.0 * (x * g_u[1] - 2.0 * y * g_u[0] - w * g_u[2] + x * g_v[0] + z * g_v[2])
    g_z = 2.0 * (w * g_u[1] - 2.0 * z * g_u[0] + x * g_u[2] - w * g_v[0] - 2.0 * z * g_v[1] + y * g_v[2])
    along = w * g_w + x * g_x + y * g_y + z * g_z
    over = 1.0 / norm if norm > 0.0 else 0.0
    out[i, 0], out[i, 1] = (g_w - w * along) * over, (g_x - x * along) * over
    out[i, 2], out[i, 3] = (g_y - y * along) * over, (g_z - z * along) * over


@inline
def _add_up(slots: Floats, places: NDArray[np.int32], first: int, last: int, sums: Floats) -> None:
    """Add up the slots at the places `first` to `last`, and have those fetched that come next."""
    width, n_lanes = slots.shape[1], slots.shape[1] - 2
    sums[:] = np.float32(0.0)
    for at in range(first, last):
        later = places[min(at + AHEAD, len(places) - 1)] * width
        for c in range(0, width, 2 * N_LANES):
            fetch(slots, later + c)
        place = places[at] * width
        for c in range(0, n_lanes, N_LANES):
            store_lanes(sums, c, load_lanes(sums, c) + load_lanes(slots, place + c))
        for c in range(n_lanes, width):
            sums[c] += slots[places[at], c]


@kernel
def gradients_of_splats(
    means: Floats,
    quats_wxyz: Floats,
    scales: Floats,
    opacities: Floats,
    camera: Array,
    lens: Array,
    geometry: Floats,
    least: float,
    blur_px: float,
    steepest: float,
    firsts: NDArray[np.int64],
    places: NDArray[np.int32],
    slots: Floats,
    start: int,
    stop: int,
    g_means: Floats,
    g_quats: Floats,
    g_scales: Floats,
    g_opacities: Floats,
    g_features: Floats,
    g_offsets: Floats,
) -> None:
    """Add up the slots of splats `start` to `stop`, and take them back to the parameters; the last six begin as 0.

    Parameters
    ----------
    least, blur_px, steepest
        The least alpha, and the last two of `project_splats`' limits.
    """
    n_features, width = g_features.shape[1], slots.shape[1]
    sums, g = np.empty(width, np.float32), np.empty(N_LANES)
    for i in range(start, stop):
        if firsts[i] == firsts[i + 1]:
            continue
        _add_up(slots, places, firsts[i], firsts[i + 1], sums)
        for k in range(N_LANES):
            g[k] = sums[k]
        for k in range(n_features):
            g_features[i, k] = sums[OF_FEATURES + k]
        g_depth, g_opacities[i] = np.float64(sums[width - 2]), sums[width - 1]
        g_offsets[i, 0], g_offsets[i, 1] = g[CENTRE_X], g[CENTRE_Y]
        (x, y, z), quat, first, second, (q_u, q_v), jacobian = see(means, quats_wxyz, scales, camera, lens, i)
        g_jacobian, g_slopes = (0.0, 0.0, 0.0, 0.0), (0.0, 0.0)
        if blur_px > 0.0:
            blur2 = blur_px * blur_px
            as_drawn, slopes, share = blurred_disc(jacobian, (q_u, q_v), blur2, steepest)
            by_opacity, by_share = slopes_of_shown(opacities[i], share, least)
            g_drawn, g_slopes = _back_through_disc(as_drawn, slopes, g)
            g_share = np.float64(sums[width - 1]) * by_share
            g_opacities[i] *= by_opacity
            g_jacobian, g_slopes = _back_through_blur(jacobian, (q_u, q_v), blur2, steepest, g_drawn, g_slopes, g_share)
        elif geometry[i, J_XU] != EDGE_ON_JACOBIAN:
            g_jacobian, g_slopes = _back_through_disc(jacobian, (q_u, q_v), g)
        # x / z and y / z appear in the middle's pixel and in the Jacobian; the rest is divided by z.
        over_z = 1.0 / z
        ux, vx = g_jacobian[0] * lens[0], g_jacobian[1] * lens[0]
        uy, vy = g_jacobian[2] * lens[1], g_jacobian[3] * lens[1]
        uz, vz = g_slopes[0] - (ux * x + uy * y) * over_z, g_slopes[1] - (vx * x + vy * y) * over_z
        g_xz, g_yz = g[CENTRE_X] * lens[0] - ux * q_u - vx * q_v, g[CENTRE_Y] * lens[1] - uy * q_u - vy * q_v
        along_u = ux * first[0] + uy * first[1] + uz * first[2]
        along_v = vx * second[0] + vy * second[1] + vz * second[2]
        s_u, s_v = np.float64(scales[i, 0]), np.float64(scales[i, 1])
        g_scales[i, 0], g_scales[i, 1] = along_u * over_z, along_v * over_z
        g_over_z = s_u * along_u + s_v * along_v + g_xz * x + g_yz * y
        s_u, s_v = s_u * over_z, s_v * over_z
        g_first = _in_world(camera, s_u * ux, s_u * uy, s_u * uz)
        g_second = _in_world(camera, s_v * vx, s_v * vy, s_v * vz)
        _back_to_quat(quat, g_first, g_second, g_quats, i)
        place = _in_world(camera, g_xz * over_z, g_yz * over_z, g_depth - g_over_z * over_z * over_z)
        g_means[i, 0], g_means[i, 1], g_means[i, 2] = place


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
        Shape (n_slots, 10 + c'), columns as `gradients_of_splats` has them.
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


# Ellipsoids.

LEAST_SQUARE = 1e-60
"""Of a picture's area without blur, px^4: far below what is ever drawn."""


@inline
def _back_through_covariance(
    row_x: Triple, row_y: Triple, blur2: float, g: Array, g_share: float
) -> tuple[Triple, Triple]:
    """From the gradients of the geometry, and of the share of what is drawn that is its own, to those of the two rows.

    The geometry is sqrt(xx / d), xy / sqrt(xx d) and 1 / sqrt(xx), d the determinant; the share is |a x b| / sqrt(d).
    """
    xx, xy, across, determinant = ellipse_covariance(row_x, row_y, blur2)
    square = max(dot(across, across), LEAST_SQUARE)
    g_square = 0.5 * g_share / math.sqrt(square * determinant)
    over_xx, over_d = 1.0 / xx, 1.0 / determinant
    by_xu, by_yv = g[J_XU] * math.sqrt(xx * over_d), g[J_YV] * math.sqrt(over_xx)
    g_xy = g[J_YU] * math.sqrt(over_xx * over_d)
    g_xx = 0.5 * over_xx * (by_xu - by_yv - g_xy * xy)
    g_d = -0.5 * over_d * (by_xu + g_xy * xy + g_share * math.sqrt(square * over_d))
    g_cross = g_d + g_square
    by_x, by_y = cross(row_y, across), cross(across, row_x)
    g_row_x = (
        2.0 * ((g_xx + g_d * blur2) * row_x[0] + g_cross * by_x[0]) + g_xy * row_y[0],
        2.0 * ((g_xx + g_d * blur2) * row_x[1] + g_cross * by_x[1]) + g_xy * row_y[1],
        2.0 * ((g_xx + g_d * blur2) * row_x[2] + g_cross * by_x[2]) + g_xy * row_y[2],
    )
    g_row_y = (
        2.0 * (g_d * blur2 * row_y[0] + g_cross * by_y[0]) + g_xy * row_x[0],
        2.0 * (g_d * blur2 * row_y[1] + g_cross * by_y[1]) + g_xy * row_x[1],
        2.0 * (g_d * blur2 * row_y[2] + g_cross * by_y[2]) + g_xy * row_x[2],
    )
    return g_row_x, g_row_y


@inline
def _back_to_axis(
    axis: Triple, slopes: Slopes, lens: Array, size: float, g_x: float, g_y: float
) -> tuple[float, float, float, Triple]:
    """From an axis' entries of the rows to its size, which is over z, to x / z and y / z, and to the axis itself."""
    across, down = g_x * lens[0], g_y * lens[1]
    forward = -across * slopes[0] - down * slopes[1]
    along = across * axis[0] + down * axis[1] + forward * axis[2]
    back = (size * across, size * down, size * forward)
    return along, -across * size * axis[2], -down * size * axis[2], back


@kernel
def gradients_of_ellipsoids(
    means: Floats,
    quats_wxyz: Floats,
    scales: Floats,
    opacities: Floats,
    camera: Array,
    lens: Array,
    least: float,
    blur_px: float,
    antialiased: bool,
    slope_limits: Array,
    firsts: NDArray[np.int64],
    places: NDArray[np.int32],
    slots: Floats,
    start: int,
    stop: int,
    g_means: Floats,
    g_quats: Floats,
    g_scales: Floats,
    g_opacities: Floats,
    g_features: Floats,
    g_offsets: Floats,
) -> None:
    """Add up the slots of ellipsoids `start` to `stop`, and take them back."""
    n_features, width = g_features.shape[1], slots.shape[1]
    sums, g = np.empty(width, np.float32), np.empty(N_LANES)
    for i in range(start, stop):
        if firsts[i] == firsts[i + 1]:
            continue
        _add_up(slots, places, firsts[i], firsts[i + 1], sums)
        for k in range(N_LANES):
            g[k] = sums[k]
        for k in range(n_features):
            g_features[i, k] = sums[OF_FEATURES + k]
        g_depth, g_opacities[i] = np.float64(sums[width - 2]), sums[width - 1]
        g_offsets[i, 0], g_offsets[i, 1] = g[CENTRE_X], g[CENTRE_Y]
        middle, quat, axes, slopes, row_x, row_y = see_ellipsoid(
            means, quats_wxyz, scales, camera, lens, slope_limits, i
        )
        x, y, z = middle
        _, _, across, determinant = ellipse_covariance(row_x, row_y, blur_px * blur_px)
        share = math.sqrt(dot(across, across) / determinant) if antialiased else 1.0
        by_opacity, by_share = slopes_of_shown(opacities[i], share, least)
        by_share *= antialiased
        g_opacities[i] *= by_opacity
        g_share = np.float64(sums[width - 1]) * by_share
        g_row_x, g_row_y = _back_through_covariance(row_x, row_y, blur_px * blur_px, g, g_share)
        over_z = 1.0 / z
        s_1, s_2, s_3 = scales[i, 0] * over_z, scales[i, 1] * over_z, scales[i, 2] * over_z
        along_1, across_1, down_1, g_1 = _back_to_axis(axes[0], slopes, lens, s_1, g_row_x[0], g_row_y[0])
        along_2, across_2, down_2, g_2 = _back_to_axis(axes[1], slopes, lens, s_2, g_row_x[1], g_row_y[1])
        along_3, across_3, down_3, g_3 = _back_to_axis(axes[2], slopes, lens, s_3, g_row_x[2], g_row_y[2])
        g_scales[i, 0], g_scales[i, 1], g_scales[i, 2] = along_1 * over_z, along_2 * over_z, along_3 * over_z
        # The third axis is the cross product of the others.
        turned_1, turned_2 = cross(axes[1], g_3), cross(g_3, axes[0])
        g_first = _in_world(camera, g_1[0] + turned_1[0], g_1[1] + turned_1[1], g_1[2] + turned_1[2])
        g_second = _in_world(camera, g_2[0] + turned_2[0], g_2[1] + turned_2[1], g_2[2] + turned_2[2])
        _back_to_quat(quat, g_first, g_second, g_quats, i)
        # x / z and y / z appear in the middle's pixel and, unless they are limited, in J; all of J is over z.
        g_xz, g_yz = g[CENTRE_X] * lens[0], g[CENTRE_Y] * lens[1]
        if slopes[2]:
            g_xz += across_1 + across_2 + across_3
        if slopes[3]:
            g_yz += down_1 + down_2 + down_3
        g_z = g_xz * x * over_z + g_yz * y * over_z + s_1 * along_1 + s_2 * along_2 + s_3 * along_3
        place = _in_world(camera, g_xz * over_z, g_yz * over_z, g_depth - g_z * over_z)
        g_means[i, 0], g_means[i, 1], g_means[i, 2] = place
