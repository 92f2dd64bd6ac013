"""Ellipsoids as a camera sees them, compiled, forward and backward.

The formulas are those of `projection.project_ellipsoids`, in float64. An ellipsoid is drawn as a disc of one depth
(e = f = 0), so that squares, blending and gradients are those of flat splats. The low-pass filter never counts: the
blur is in the disc.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import inline, kernel
from reconstruction.splats.rasterising.numba_gradients import (
    CENTRE_X,
    CENTRE_Y,
    OF_FEATURES,
    add_up,
    back_to_quat,
    in_world,
)
from reconstruction.splats.rasterising.numba_lanes import N_LANES
from reconstruction.splats.rasterising.numba_projection import (
    HIGHEST,
    J_XU,
    J_XV,
    J_YU,
    J_YV,
    LARGEST_OUTLINE_PX,
    LOWEST,
    WIDEST_PX,
    Array,
    E,
    F,
    Floats,
    Quat,
    Triple,
    in_camera,
    outline_of,
    place_disc,
    rotation_columns,
    shown_opacity,
    slopes_of_shown,
)

LEAST_SQUARE = 1e-60
"""Of a picture's area without blur, px^4: far below what is ever drawn."""

Axes = tuple[Triple, Triple, Triple]
Slopes = tuple[float, float, bool, bool]
"""x / z and y / z as they are in J, and whether they are those of the middle."""


@inline
def _dot(a: Triple, b: Triple) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inline
def _cross(a: Triple, b: Triple) -> Triple:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inline
def _see(
    means: Floats, quats_wxyz: Floats, scales: Floats, camera: Array, lens: Array, slope_limits: Array, i: int
) -> tuple[Triple, Quat, Axes, Slopes, Triple, Triple]:
    """Ellipsoid `i` in camera axes: middle, rotation, unit axes, slopes, and the two rows of J W R S."""
    x, y, z = in_camera(camera, np.float64(means[i, 0]), np.float64(means[i, 1]), np.float64(means[i, 2]))
    x, y, z = x + camera[0, 3], y + camera[1, 3], z + camera[2, 3]
    first, second, quat = rotation_columns(
        np.float64(quats_wxyz[i, 0]), np.float64(quats_wxyz[i, 1]),
        np.float64(quats_wxyz[i, 2]), np.float64(quats_wxyz[i, 3]),
    )  # fmt: skip
    third = _cross(first, second)
    first = in_camera(camera, first[0], first[1], first[2])
    second = in_camera(camera, second[0], second[1], second[2])
    third = in_camera(camera, third[0], third[1], third[2])
    over_z = 1.0 / z
    across = min(max(x * over_z, slope_limits[0]), slope_limits[1])
    down = min(max(y * over_z, slope_limits[2]), slope_limits[3])
    s_1, s_2, s_3 = scales[i, 0] * over_z, scales[i, 1] * over_z, scales[i, 2] * over_z
    row_x = (
        lens[0] * s_1 * (first[0] - across * first[2]),
        lens[0] * s_2 * (second[0] - across * second[2]),
        lens[0] * s_3 * (third[0] - across * third[2]),
    )
    row_y = (
        lens[1] * s_1 * (first[1] - down * first[2]),
        lens[1] * s_2 * (second[1] - down * second[2]),
        lens[1] * s_3 * (third[1] - down * third[2]),
    )
    slopes = (across, down, across == x * over_z, down == y * over_z)
    return (x, y, z), quat, (first, second, third), slopes, row_x, row_y


@inline
def _covariance(row_x: Triple, row_y: Triple, blur2: float) -> tuple[float, float, Triple, float]:
    """Of Sigma' the first two entries; the cross product of its rows, and its determinant."""
    xx, across = _dot(row_x, row_x), _cross(row_x, row_y)
    determinant = _dot(across, across) + blur2 * (xx + _dot(row_y, row_y) + blur2)
    return xx + blur2, _dot(row_x, row_y), across, determinant


@kernel
def project_ellipsoids(
    means: Floats,
    quats_wxyz: Floats,
    scales: Floats,
    opacities: Floats,
    offsets: Floats,
    camera: Array,
    lens: Array,
    size: tuple[int, int],
    limits: Array,
    slope_limits: Array,
    start: int,
    stop: int,
    geometry: Floats,
    depths: Array,
    boxes: NDArray[np.int32],
    radii: Floats,
) -> None:
    """Fill the last four arrays for ellipsoids `start` to `stop`, as `numba_projection.project_splats` does for discs.

    Parameters
    ----------
    scales
        Shape (n, 3).
    limits
        Nearest depth, least alpha, the blur's standard deviation, and 1 where what the blur makes larger is as much
        more transparent.
    slope_limits
        Of x / z and y / z in J, shape (4,).
    """
    near_m, least, blur2, antialiased = limits[0], limits[1], limits[2] * limits[2], limits[3] > 0.0
    for i in range(start, stop):
        boxes[i, 0], boxes[i, 1], boxes[i, 2], boxes[i, 3] = 0, 0, 0, 0
        radii[i] = 0.0
        (x, y, z), _, _, _, row_x, row_y = _see(means, quats_wxyz, scales, camera, lens, slope_limits, i)
        s_1, s_2, s_3 = np.float64(scales[i, 0]), np.float64(scales[i, 1]), np.float64(scales[i, 2])
        opacity = np.float64(opacities[i])
        # What is no number makes the sum one, and what is infinite the product.
        total = x + y + z + s_1 + s_2 + s_3 + opacity
        total += quats_wxyz[i, 0] + quats_wxyz[i, 1] + quats_wxyz[i, 2] + quats_wxyz[i, 3]
        is_finite = math.isfinite(0.0 * total)
        if not (is_finite and z > near_m and opacity >= least and min(s_1, s_2, s_3) > 0.0):
            continue
        cx, cy = lens[0] * x / z + lens[2], lens[1] * y / z + lens[3]
        if len(offsets) > 0:
            cx, cy = cx + offsets[i, 0], cy + offsets[i, 1]
        if max(abs(cx), abs(cy)) > WIDEST_PX:
            continue
        xx, xy, across, determinant = _covariance(row_x, row_y, blur2)
        share = math.sqrt(_dot(across, across) / determinant) if antialiased else 1.0
        shown = shown_opacity(opacity, share, least)
        j_xu, root = math.sqrt(xx), math.sqrt(determinant)
        j_yu, j_yv = xy / j_xu, root / j_xu
        reach = math.sqrt(max(2.0 * math.log(shown / least), 0.0))
        box, outline = outline_of((j_xu, 0.0, j_yu, j_yv), (0.0, 0.0), reach)
        if max(box[1] - box[0], box[3] - box[2]) >= LARGEST_OUTLINE_PX:
            outline = (0.0, 0.0, 0.0, WIDEST_PX, 0.0)
        if not place_disc((cx, cy, z), box, outline, 0.0, shown, size, i, geometry, depths, boxes, radii):
            continue
        geometry[i, J_XU], geometry[i, J_XV] = 1.0 / j_yv, 0.0
        geometry[i, J_YU], geometry[i, J_YV] = j_yu / root, 1.0 / j_xu
        geometry[i, E], geometry[i, F], geometry[i, LOWEST], geometry[i, HIGHEST] = 0.0, 0.0, 0.0, 0.0


@inline
def _back_through_covariance(
    row_x: Triple, row_y: Triple, blur2: float, g: Array, g_share: float
) -> tuple[Triple, Triple]:
    """From the gradients of the geometry, and of the share of what is drawn that is its own, to those of the two rows.

    The geometry is sqrt(xx / d), xy / sqrt(xx d) and 1 / sqrt(xx), d the determinant; the share is |a x b| / sqrt(d).
    """
    xx, xy, across, determinant = _covariance(row_x, row_y, blur2)
    square = max(_dot(across, across), LEAST_SQUARE)
    g_square = 0.5 * g_share / math.sqrt(square * determinant)
    over_xx, over_d = 1.0 / xx, 1.0 / determinant
    by_xu, by_yv = g[J_XU] * math.sqrt(xx * over_d), g[J_YV] * math.sqrt(over_xx)
    g_xy = g[J_YU] * math.sqrt(over_xx * over_d)
    g_xx = 0.5 * over_xx * (by_xu - by_yv - g_xy * xy)
    g_d = -0.5 * over_d * (by_xu + g_xy * xy + g_share * math.sqrt(square * over_d))
    g_cross = g_d + g_square
    by_x, by_y = _cross(row_y, across), _cross(across, row_x)
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
    """Add up the slots of ellipsoids `start` to `stop`, and take them back; see `numba_gradients`."""
    n_features, width = g_features.shape[1], slots.shape[1]
    sums, g = np.empty(width, np.float32), np.empty(N_LANES)
    for i in range(start, stop):
        if firsts[i] == firsts[i + 1]:
            continue
        add_up(slots, places, firsts[i], firsts[i + 1], sums)
        for k in range(N_LANES):
            g[k] = sums[k]
        for k in range(n_features):
            g_features[i, k] = sums[OF_FEATURES + k]
        g_depth, g_opacities[i] = np.float64(sums[width - 2]), sums[width - 1]
        g_offsets[i, 0], g_offsets[i, 1] = g[CENTRE_X], g[CENTRE_Y]
        (x, y, z), quat, axes, slopes, row_x, row_y = _see(means, quats_wxyz, scales, camera, lens, slope_limits, i)
        _, _, across, determinant = _covariance(row_x, row_y, blur_px * blur_px)
        share = math.sqrt(_dot(across, across) / determinant) if antialiased else 1.0
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
        turned_1, turned_2 = _cross(axes[1], g_3), _cross(g_3, axes[0])
        g_first = in_world(camera, g_1[0] + turned_1[0], g_1[1] + turned_1[1], g_1[2] + turned_1[2])
        g_second = in_world(camera, g_2[0] + turned_2[0], g_2[1] + turned_2[1], g_2[2] + turned_2[2])
        back_to_quat(quat, g_first, g_second, g_quats, i)
        # x / z and y / z appear in the middle's pixel and, unless they are limited, in J; all of J is over z.
        g_xz, g_yz = g[CENTRE_X] * lens[0], g[CENTRE_Y] * lens[1]
        if slopes[2]:
            g_xz += across_1 + across_2 + across_3
        if slopes[3]:
            g_yz += down_1 + down_2 + down_3
        g_z = g_xz * x * over_z + g_yz * y * over_z + s_1 * along_1 + s_2 * along_2 + s_3 * along_3
        place = in_world(camera, g_xz * over_z, g_yz * over_z, g_depth - g_z * over_z)
        g_means[i, 0], g_means[i, 1], g_means[i, 2] = place
