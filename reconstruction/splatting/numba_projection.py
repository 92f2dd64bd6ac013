"""Splats as a camera sees them, compiled: geometry of each, the box it can touch, and the way back to its parameters.

The formulas are those of `projection`, in float64; what the tiles need is rounded to float32 only afterwards.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planning.jit import kernel
from reconstruction.splatting.projection import LEAST_NORM
from reconstruction.splatting.torch_twin import LEAST_AREA_PX2, LIMITS_WIDENED, MOST_CHANGE

Array = NDArray[np.float64]
Triple = tuple[float, float, float]
Quat = tuple[float, float, float, float, float]
"""Length, and w, x, y, z at length 1."""

J_XU, J_XV, J_YU, J_YV, E, F, DEPTH, OPACITY, LOWEST, HIGHEST = range(10)
"""Columns of a splat's geometry. J, and e, f with t = x e + y f, are divided by the area a, det J: then D = 1 + t, and
nothing leaves the range of float32 for tiny, huge and edge-on splats. The last two are the limits of t."""
N_GEOMETRY = 10
CENTRE_X, CENTRE_Y = 8, 9
"""Columns of gradients, in the place of the limits, which have none."""
N_GRADIENTS = 10

EDGE_ON_JACOBIAN = 1e6
"""Of a splat seen edge-on: with it and a flat plane the disc never wins against the low-pass filter."""

SLACK_PX = 1e-3
"""Of boxes: more than the rounding of float32 near them."""

N_CORNERS = 12
"""Of the polygon around a disc of which a part is too near: its box is at most 4 % too large."""


@kernel
def _rotation_columns(q: tuple[float, float, float, float]) -> tuple[Triple, Triple, Quat]:
    """First two columns of the rotation of a quaternion, and its length (0 where it says nothing)."""
    norm = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    if norm > LEAST_NORM:
        w, x, y, z = q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm
    else:
        norm, w, x, y, z = 0.0, 1.0, 0.0, 0.0, 0.0
    first = (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y))
    second = (2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x))
    return first, second, (norm, w, x, y, z)


@kernel
def _in_camera(camera: Array, x: float, y: float, z: float) -> Triple:
    """A direction of the model's frame in camera axes."""
    return (
        camera[0, 0] * x + camera[0, 1] * y + camera[0, 2] * z,
        camera[1, 0] * x + camera[1, 1] * y + camera[1, 2] * z,
        camera[2, 0] * x + camera[2, 1] * y + camera[2, 2] * z,
    )


@kernel
def _in_world(camera: Array, x: float, y: float, z: float) -> Triple:
    """A direction of camera axes in the model's frame."""
    return (
        camera[0, 0] * x + camera[1, 0] * y + camera[2, 0] * z,
        camera[0, 1] * x + camera[1, 1] * y + camera[2, 1] * z,
        camera[0, 2] * x + camera[1, 2] * y + camera[2, 2] * z,
    )


@kernel
def _clipped_box(jacobian: Array, slopes: Array, depth: float, reach: float, near_m: float, box: Array) -> None:
    """Widen `box` (left, right, top, bottom, from the middle) by the part of a disc that is not too near."""
    out = reach / math.cos(math.pi / N_CORNERS)
    for corner in range(N_CORNERS):
        first, second = 2.0 * math.pi * corner / N_CORNERS, 2.0 * math.pi * (corner + 1) / N_CORNERS
        u, v = out * math.cos(first), out * math.sin(first)
        du, dv = out * math.cos(second) - u, out * math.sin(second) - v
        here = depth * (1.0 + slopes[0] * u + slopes[1] * v) - near_m
        change = depth * (slopes[0] * du + slopes[1] * dv)
        for end in range(2):
            share = 0.0
            if end == 0:
                if here < 0.0:
                    continue
            else:
                if (here < 0.0) == (here + change < 0.0):
                    continue
                share = -here / change
            w = 1.0 + slopes[0] * (u + share * du) + slopes[1] * (v + share * dv)
            x = (jacobian[0, 0] * (u + share * du) + jacobian[0, 1] * (v + share * dv)) / w
            y = (jacobian[1, 0] * (u + share * du) + jacobian[1, 1] * (v + share * dv)) / w
            box[0], box[1] = min(box[0], x), max(box[1], x)
            box[2], box[3] = min(box[2], y), max(box[3], y)


@kernel
def _widen_box(jacobian: Array, slopes: Array, depth: float, reach: float, near_m: float, box: Array) -> None:
    """Widen `box` (left, right, top, bottom, from the middle) by a disc as far as it counts.

    The extremes of a circle's projection are the roots of a quadratic in its dual conic.
    """
    steepness = math.sqrt(slopes[0] * slopes[0] + slopes[1] * slopes[1])
    if depth * (1.0 - reach * steepness) < near_m:
        _clipped_box(jacobian, slopes, depth, reach, near_m, box)
        return
    r2 = reach * reach
    in_front = 1.0 - r2 * steepness * steepness
    for axis in range(2):
        ju, jv = jacobian[axis, 0], jacobian[axis, 1]
        middle = -r2 * (ju * slopes[0] + jv * slopes[1])
        half = math.sqrt(middle * middle + in_front * r2 * (ju * ju + jv * jv))
        box[2 * axis] = min(box[2 * axis], (middle - half) / in_front)
        box[2 * axis + 1] = max(box[2 * axis + 1], (middle + half) / in_front)


@kernel
def _pixels_between(low: float, high: float, size: int) -> tuple[int, int]:
    """Half-open range of the pixels, of `size`, whose middles lie between two places, empty where there are none."""
    first = math.ceil(min(max(low - 0.5 - SLACK_PX, -1.0), size + 1.0))
    last = math.floor(min(max(high - 0.5 + SLACK_PX, -2.0), size + 1.0))
    return max(int(first), 0), min(int(last) + 1, size)


@kernel
def _see(
    means: NDArray[np.float32],
    quats_wxyz: NDArray[np.float32],
    scales: NDArray[np.float32],
    camera: Array,
    lens: Array,
    i: int,
    tangents: Array,
    slopes: Array,
    jacobian: Array,
) -> tuple[Triple, Quat]:
    """Splat `i` in camera axes: its middle and rotation come back, tangents, slopes and Jacobian are filled in."""
    x, y, z = _in_camera(camera, np.float64(means[i, 0]), np.float64(means[i, 1]), np.float64(means[i, 2]))
    x, y, z = x + camera[0, 3], y + camera[1, 3], z + camera[2, 3]
    qw, qx = np.float64(quats_wxyz[i, 0]), np.float64(quats_wxyz[i, 1])
    qy, qz = np.float64(quats_wxyz[i, 2]), np.float64(quats_wxyz[i, 3])
    first, second, quat = _rotation_columns((qw, qx, qy, qz))
    tangents[0, 0], tangents[0, 1], tangents[0, 2] = _in_camera(camera, first[0], first[1], first[2])
    tangents[1, 0], tangents[1, 1], tangents[1, 2] = _in_camera(camera, second[0], second[1], second[2])
    for k in range(2):
        scale = np.float64(scales[i, k])
        slopes[k] = scale * tangents[k, 2] / z
        jacobian[0, k] = lens[0] * (scale * tangents[k, 0] - x * slopes[k]) / z
        jacobian[1, k] = lens[1] * (scale * tangents[k, 1] - y * slopes[k]) / z
    return (x, y, z), quat


@kernel
def project_splats(
    means: NDArray[np.float32],
    quats_wxyz: NDArray[np.float32],
    scales: NDArray[np.float32],
    opacities: NDArray[np.float32],
    offsets: NDArray[np.float32],
    camera: Array,
    lens: Array,
    size: tuple[int, int],
    limits: Array,
    start: int,
    stop: int,
    geometry: NDArray[np.float32],
    centres: Array,
    depths: Array,
    boxes: NDArray[np.int32],
    radii: NDArray[np.float32],
) -> None:
    """Fill the last five arrays for splats `start` to `stop`; those that are not drawn get an empty box and radius 0.

    Parameters
    ----------
    offsets
        Shape (n, 2), or (0, 2) for none.
    camera, lens, size
        Model's frame to camera axes, shape (4, 4); fx, fy, cx, cy; width, height.
    limits
        Nearest depth, least alpha, standard deviation of the low-pass filter, reach and least change of depth.
    geometry, centres, depths
        Shapes (n, 10), (n, 2), (n,).
    boxes
        Half-open ranges of columns and rows, shape (n, 4): left, right, top, bottom.
    """
    near_m, least, low_pass, far_reach, least_change = limits
    jacobian, slopes, box, tangents = np.empty((2, 2)), np.empty(2), np.empty(4), np.empty((2, 3))
    for i in range(start, stop):
        boxes[i, 0], boxes[i, 1], boxes[i, 2], boxes[i, 3] = 0, 0, 0, 0
        radii[i] = 0.0
        (x, y, z), _ = _see(means, quats_wxyz, scales, camera, lens, i, tangents, slopes, jacobian)
        su, sv, opacity = np.float64(scales[i, 0]), np.float64(scales[i, 1]), np.float64(opacities[i])
        # What is no number makes the sum one, and what is infinite the product.
        total = x + y + z + su + sv + opacity
        for k in range(4):
            total += quats_wxyz[i, k]
        is_finite = math.isfinite(0.0 * total)
        if not (is_finite and z > near_m and opacity >= least and su > 0.0 and sv > 0.0):
            continue
        cx, cy = lens[0] * x / z + lens[2], lens[1] * y / z + lens[3]
        if len(offsets) > 0:
            cx, cy = cx + offsets[i, 0], cy + offsets[i, 1]
        area = jacobian[0, 0] * jacobian[1, 1] - jacobian[0, 1] * jacobian[1, 0]
        has_disc = abs(area) >= LEAST_AREA_PX2
        reach = math.sqrt(max(2.0 * math.log(opacity / least), 0.0))
        box[0], box[1], box[2], box[3] = -low_pass * reach, low_pass * reach, -low_pass * reach, low_pass * reach
        if has_disc:
            _widen_box(jacobian, slopes, z, reach, near_m, box)
        left, right = _pixels_between(cx + box[0], cx + box[1], size[0])
        top, bottom = _pixels_between(cy + box[2], cy + box[3], size[1])
        if left >= right or top >= bottom:
            continue
        boxes[i, 0], boxes[i, 1], boxes[i, 2], boxes[i, 3] = left, right, top, bottom
        radii[i] = 0.5 * max(box[1] - box[0], box[3] - box[2])
        centres[i, 0], centres[i, 1], depths[i] = cx, cy, z
        geometry[i, DEPTH], geometry[i, OPACITY] = z, opacity
        steepness = math.sqrt(slopes[0] * slopes[0] + slopes[1] * slopes[1])
        change = min(max(far_reach * steepness, least_change) * LIMITS_WIDENED, MOST_CHANGE)
        nearest = z / near_m - 1.0
        geometry[i, LOWEST] = -change / (1.0 + change)
        geometry[i, HIGHEST] = min(change / (1.0 - change), nearest) if change < 1.0 else nearest
        if has_disc:
            geometry[i, J_XU], geometry[i, J_XV] = jacobian[0, 0] / area, jacobian[0, 1] / area
            geometry[i, J_YU], geometry[i, J_YV] = jacobian[1, 0] / area, jacobian[1, 1] / area
            geometry[i, E] = (jacobian[1, 0] * slopes[1] - jacobian[1, 1] * slopes[0]) / area
            geometry[i, F] = (jacobian[0, 1] * slopes[0] - jacobian[0, 0] * slopes[1]) / area
        else:
            geometry[i, J_XU], geometry[i, J_XV], geometry[i, J_YU] = EDGE_ON_JACOBIAN, 0.0, 0.0
            geometry[i, J_YV], geometry[i, E], geometry[i, F] = EDGE_ON_JACOBIAN, 0.0, 0.0


@kernel
def _back_through_disc(jacobian: Array, slopes: Array, g: Array, g_jacobian: Array, g_slopes: Array) -> None:
    """From the gradients of the geometry to those of the Jacobian and the slopes."""
    j_xu, j_xv, j_yu, j_yv = jacobian[0, 0], jacobian[0, 1], jacobian[1, 0], jacobian[1, 1]
    over_area = 1.0 / (j_xu * j_yv - j_xv * j_yu)
    e, f = j_yu * slopes[1] - j_yv * slopes[0], j_xv * slopes[0] - j_xu * slopes[1]
    g_xu, g_xv, g_yu, g_yv = g[J_XU] * over_area, g[J_XV] * over_area, g[J_YU] * over_area, g[J_YV] * over_area
    g_e, g_f = g[E] * over_area, g[F] * over_area
    g_area = -(g_xu * j_xu + g_xv * j_xv + g_yu * j_yu + g_yv * j_yv + g_e * e + g_f * f) * over_area
    g_jacobian[0, 0] = g_xu + g_area * j_yv - g_f * slopes[1]
    g_jacobian[0, 1] = g_xv - g_area * j_yu + g_f * slopes[0]
    g_jacobian[1, 0] = g_yu - g_area * j_xv + g_e * slopes[1]
    g_jacobian[1, 1] = g_yv + g_area * j_xu - g_e * slopes[0]
    g_slopes[0] = g_f * j_xv - g_e * j_yv
    g_slopes[1] = g_e * j_yu - g_f * j_xu


@kernel
def _back_to_quat(q: Quat, g: Array, out: NDArray[np.float32], i: int) -> None:
    """From the gradient of a rotation's first two columns, shape (2, 3), to the quaternion of any length."""
    norm, w, x, y, z = q
    if norm == 0.0:
        return
    unit = (w, x, y, z)
    g_unit = (
        2.0 * (z * g[0, 1] - y * g[0, 2] - z * g[1, 0] + x * g[1, 2]),
        2.0 * (y * g[0, 1] + z * g[0, 2] + y * g[1, 0] - 2.0 * x * g[1, 1] + w * g[1, 2]),
        2.0 * (x * g[0, 1] - 2.0 * y * g[0, 0] - w * g[0, 2] + x * g[1, 0] + z * g[1, 2]),
        2.0 * (w * g[0, 1] - 2.0 * z * g[0, 0] + x * g[0, 2] - w * g[1, 0] - 2.0 * z * g[1, 1] + y * g[1, 2]),
    )
    along = w * g_unit[0] + x * g_unit[1] + y * g_unit[2] + z * g_unit[3]
    for k in range(4):
        out[i, k] = (g_unit[k] - unit[k] * along) / norm


@kernel
def gradients_of_splats(
    means: NDArray[np.float32],
    quats_wxyz: NDArray[np.float32],
    scales: NDArray[np.float32],
    geometry: NDArray[np.float32],
    camera: Array,
    lens: Array,
    firsts: NDArray[np.int64],
    places: NDArray[np.int64],
    slots: NDArray[np.float32],
    start: int,
    stop: int,
    g_means: NDArray[np.float32],
    g_quats: NDArray[np.float32],
    g_scales: NDArray[np.float32],
    g_opacities: NDArray[np.float32],
    g_features: NDArray[np.float32],
    g_offsets: NDArray[np.float32],
) -> None:
    """Add up the slots of splats `start` to `stop`, and take them back to the parameters; the last six begin as 0."""
    n_features = g_features.shape[1]
    g, g_all = np.empty(N_GRADIENTS), np.empty(n_features)
    jacobian, slopes, tangents = np.empty((2, 2)), np.empty(2), np.empty((2, 3))
    g_jacobian, g_slopes, g_columns = np.empty((2, 2)), np.empty(2), np.empty((2, 3))
    for i in range(start, stop):
        if firsts[i] == firsts[i + 1]:
            continue
        for k in range(N_GRADIENTS):
            g[k] = 0.0
        for k in range(n_features):
            g_all[k] = 0.0
        for at in range(firsts[i], firsts[i + 1]):
            place = places[at]
            for k in range(N_GRADIENTS):
                g[k] += slots[place, k]
            for k in range(n_features):
                g_all[k] += slots[place, N_GRADIENTS + k]
        for k in range(n_features):
            g_features[i, k] = g_all[k]
        g_opacities[i] = g[OPACITY]
        g_offsets[i, 0], g_offsets[i, 1] = g[CENTRE_X], g[CENTRE_Y]
        (x, y, z), quat = _see(means, quats_wxyz, scales, camera, lens, i, tangents, slopes, jacobian)
        has_disc = geometry[i, J_XU] != EDGE_ON_JACOBIAN
        for k in range(2):
            g_jacobian[0, k], g_jacobian[1, k], g_slopes[k] = 0.0, 0.0, 0.0
        if has_disc:
            _back_through_disc(jacobian, slopes, g, g_jacobian, g_slopes)
        # x / z and y / z appear in the middle's pixel and in the Jacobian; the rest is divided by z.
        g_xz, g_yz, g_over_z = g[CENTRE_X] * lens[0], g[CENTRE_Y] * lens[1], 0.0
        for k in range(2):
            g_x, g_y = g_jacobian[0, k] * lens[0], g_jacobian[1, k] * lens[1]
            g_slope = g_slopes[k] - g_x * x / z - g_y * y / z
            g_xz -= g_x * slopes[k]
            g_yz -= g_y * slopes[k]
            scale = np.float64(scales[i, k])
            along = g_x * tangents[k, 0] + g_y * tangents[k, 1] + g_slope * tangents[k, 2]
            g_over_z += scale * along
            g_scales[i, k] = along / z
            r = _in_world(camera, g_x, g_y, g_slope)
            for axis in range(3):
                g_columns[k, axis] = scale * r[axis] / z
        g_over_z += g_xz * x + g_yz * y
        r = _in_world(camera, g_xz / z, g_yz / z, g[DEPTH] - g_over_z / (z * z))
        for axis in range(3):
            g_means[i, axis] = r[axis]
        _back_to_quat(quat, g_columns, g_quats, i)
