"""Splats as a camera sees them, compiled: the geometry of each, its outline, and the box that it can touch.

The formulas are those of `projection`, in float64; what the tiles need is rounded to float32 only afterwards.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import inline, kernel
from reconstruction.splats.rasterising.projection import LEAST_NORM, SMALLEST
from reconstruction.splats.rasterising.raster_types import FAINTEST
from reconstruction.splats.rasterising.torch_reference import LEAST_AREA_PX2, LIMITS_WIDENED, MOST_CHANGE

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Pair = tuple[float, float]
Triple = tuple[float, float, float]
Four = tuple[float, float, float, float]
Quat = tuple[float, float, float, float, float]
"""Length, and w, x, y, z at length 1."""
Outline = tuple[float, float, float, float, float]
"""Of a disc, in the order of its columns below."""

J_XU, J_XV, J_YU, J_YV, E, F, DEPTH, OPACITY, LOWEST, HIGHEST = range(10)
"""Columns of a splat's geometry. J, and e, f with t = x e + y f, are divided by the area a, det J: then D = 1 + t, and
nothing leaves the range of float32 for tiny, huge and edge-on splats. The last two are the limits of t."""
WHOLE_X, WHOLE_Y, REST_X, REST_Y = range(10, 14)
"""Its middle, in pixels: whole ones and what is left, so that nothing is lost in float32."""
LEFT, RIGHT, TOP, BOTTOM = range(14, 18)
"""Half-open ranges of the columns and rows that it can touch."""
DISC_X, DISC_Y, OVER_HALF_HEIGHT, HALF_WIDTH, SHEAR, DOT_RADIUS2 = range(18, 24)
"""Its outline as far as it counts, in pixels: of the disc, an ellipse, the middle from the splat's own, 1 / half its
height, half the width of the row through its middle, and by how much rows move sideways from row to row; of the
low-pass filter's circle the squared radius."""
N_GEOMETRY = 24

EDGE_ON_JACOBIAN = 1e6
"""Of a splat seen edge-on: with it and a flat plane the disc never wins against the low-pass filter."""

SLACK_PX = 1e-3
"""Of boxes and outlines: more than the rounding of float32 near them."""

LARGEST_OUTLINE_PX = 1e4
"""Half-axes and distances up to which an outline is exact enough in float32; what is larger is as wide as its box."""
WIDEST_PX = 1e30

ROUNDING = 1e-5
"""Of outlines: as a share of their size, more than that of float32."""

N_CORNERS = 12
"""Of the polygon around a disc of which a part is too near: its box is at most 4 % too large."""


@inline
def rotation_columns(w: float, x: float, y: float, z: float) -> tuple[Triple, Triple, Quat]:
    """First two columns of the rotation of a quaternion, and its length (0 where it says nothing)."""
    norm = math.sqrt(w * w + x * x + y * y + z * z)
    if norm > LEAST_NORM:
        over = 1.0 / norm
        w, x, y, z = w * over, x * over, y * over, z * over
    else:
        norm, w, x, y, z = 0.0, 1.0, 0.0, 0.0, 0.0
    first = (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y))
    second = (2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x))
    return first, second, (norm, w, x, y, z)


@inline
def in_camera(camera: Array, x: float, y: float, z: float) -> Triple:
    """A direction of the model's frame in camera axes."""
    return (
        camera[0, 0] * x + camera[0, 1] * y + camera[0, 2] * z,
        camera[1, 0] * x + camera[1, 1] * y + camera[1, 2] * z,
        camera[2, 0] * x + camera[2, 1] * y + camera[2, 2] * z,
    )


@inline
def see(
    means: Floats, quats_wxyz: Floats, scales: Floats, camera: Array, lens: Array, i: int
) -> tuple[Triple, Quat, Triple, Triple, Pair, Four]:
    """Splat `i` in camera axes: middle, rotation, two tangents, slopes, Jacobian (xu, xv, yu, yv); see `projection`."""
    x, y, z = in_camera(camera, np.float64(means[i, 0]), np.float64(means[i, 1]), np.float64(means[i, 2]))
    x, y, z = x + camera[0, 3], y + camera[1, 3], z + camera[2, 3]
    first, second, quat = rotation_columns(
        np.float64(quats_wxyz[i, 0]), np.float64(quats_wxyz[i, 1]),
        np.float64(quats_wxyz[i, 2]), np.float64(quats_wxyz[i, 3]),
    )  # fmt: skip
    first = in_camera(camera, first[0], first[1], first[2])
    second = in_camera(camera, second[0], second[1], second[2])
    over_z = 1.0 / z
    s_u, s_v, across, down = scales[i, 0] * over_z, scales[i, 1] * over_z, x * over_z, y * over_z
    q_u, q_v = s_u * first[2], s_v * second[2]
    jacobian = (
        lens[0] * (s_u * first[0] - across * q_u), lens[0] * (s_v * second[0] - across * q_v),
        lens[1] * (s_u * first[1] - down * q_u), lens[1] * (s_v * second[1] - down * q_v),
    )  # fmt: skip
    return (x, y, z), quat, first, second, (q_u, q_v), jacobian


@kernel
def _clipped_box(jacobian: Four, slopes: Pair, depth: float, reach: float, near_m: float) -> Four:
    """Box (left, right, top, bottom, from the middle) of the part of a disc that is not too near."""
    left, right, top, bottom = 0.0, 0.0, 0.0, 0.0
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
            x = (jacobian[0] * (u + share * du) + jacobian[1] * (v + share * dv)) / w
            y = (jacobian[2] * (u + share * du) + jacobian[3] * (v + share * dv)) / w
            left, right, top, bottom = min(left, x), max(right, x), min(top, y), max(bottom, y)
    return left, right, top, bottom


@inline
def outline_of(jacobian: Four, slopes: Pair, reach: float) -> tuple[Four, Outline]:
    """Box (left, right, top, bottom, from the middle) and outline of a disc that is in front of the camera altogether.

    The extremes of a circle's projection are the roots of a quadratic in its dual conic.
    """
    j_xu, j_xv, j_yu, j_yv = jacobian
    q_u, q_v = slopes
    share = reach * reach / (1.0 - reach * reach * (q_u * q_u + q_v * q_v))
    x, y = -share * (j_xu * q_u + j_xv * q_v), -share * (j_yu * q_u + j_yv * q_v)
    xx = x * x + share * (j_xu * j_xu + j_xv * j_xv)
    yy = y * y + share * (j_yu * j_yu + j_yv * j_yv)
    half_width, half_height = math.sqrt(xx), math.sqrt(yy)
    box = (x - half_width, x + half_width, y - half_height, y + half_height)
    shear = (x * y + share * (j_xu * j_yu + j_xv * j_yv)) / yy
    in_row = math.sqrt(max(xx - shear * shear * yy, 0.0)) * (1.0 + ROUNDING) + SLACK_PX
    return box, (x, y, 1.0 / (half_height * (1.0 + ROUNDING) + SLACK_PX), in_row, shear)


@inline
def covariance_of(jacobian: Four, blur2: float) -> tuple[Triple, float, float]:
    """C of a disc that is blurred: xx, xy and yy, and the roots of its determinant and of that without blur."""
    j_xu, j_xv, j_yu, j_yv = jacobian
    area = j_xu * j_yv - j_xv * j_yu
    xx, yy = j_xu * j_xu + j_xv * j_xv, j_yu * j_yu + j_yv * j_yv
    root = math.sqrt(area * area + blur2 * (xx + yy + blur2))
    return (xx + blur2, j_xu * j_yu + j_xv * j_yv, yy + blur2), root, area


@inline
def planes_of(
    jacobian: Four, slopes: Pair, covariance: Triple, square: float, area: float, steepest: float
) -> tuple[Pair, Pair, float, bool]:
    """-C^-1 J q, the disc's own plane p times the area, what of the latter p' has, and whether that is all of p."""
    j_xu, j_xv, j_yu, j_yv = jacobian
    xx, xy, yy = covariance
    x, y = j_xu * slopes[0] + j_xv * slopes[1], j_yu * slopes[0] + j_yv * slopes[1]
    likely = (xy * y - yy * x) / square, (xy * x - xx * y) / square
    plane = j_yu * slopes[1] - j_yv * slopes[0], j_xv * slopes[0] - j_xu * slopes[1]
    steepness2, limit = plane[0] * plane[0] + plane[1] * plane[1], steepest * steepest
    if limit * area * area >= steepness2 and abs(area) >= SMALLEST:
        return likely, plane, 1.0 / area, True
    return likely, plane, limit * area / max(steepness2, SMALLEST * SMALLEST), False


@inline
def blurred_disc(jacobian: Four, slopes: Pair, blur2: float, steepest: float) -> tuple[Four, Pair, float]:
    """J' and q' of a disc that is blurred, and the share of what is drawn that is its own; see `projection.blurred`."""
    covariance, root, area = covariance_of(jacobian, blur2)
    likely, plane, over, _ = planes_of(jacobian, slopes, covariance, root * root, area, steepest)
    rest, upper = 1.0 - over * area, math.sqrt(covariance[0])
    p_x, p_y = rest * likely[0] + over * plane[0], rest * likely[1] + over * plane[1]
    beside, lower = covariance[1] / upper, root / upper
    return (upper, 0.0, beside, lower), (-upper * p_x - beside * p_y, -lower * p_y), abs(area) / root


@inline
def shown_opacity(opacity: float, share: float, least: float) -> float:
    """That a splat is drawn with, by the opacity below which it does not count."""
    return min(opacity, max(opacity * share, FAINTEST * least))


@inline
def slopes_of_shown(opacity: float, share: float, least: float) -> Pair:
    """Changes of `shown_opacity` with the opacity and with the share."""
    if opacity * share > FAINTEST * least:
        return share, opacity
    return (1.0 if opacity <= FAINTEST * least else 0.0), 0.0


@inline
def _first_pixel(low: float, size: int) -> int:
    """The first pixel, of `size`, whose middle is not before a place."""
    return max(math.ceil(min(max(low - 0.5 - SLACK_PX, -1.0), size + 1.0)), 0)


@inline
def _behind_last(high: float, size: int) -> int:
    """Of the pixels, of `size`, whose middles are not behind a place the last, and one more."""
    return min(math.floor(min(max(high - 0.5 + SLACK_PX, -2.0), size + 1.0)) + 1, size)


@inline
def place_disc(
    centre: Triple,
    box: Four,
    outline: Outline,
    dot: float,
    opacity: float,
    size: tuple[int, int],
    i: int,
    geometry: Floats,
    depths: Array,
    boxes: NDArray[np.int32],
    radii: Floats,
) -> bool:
    """Fill in all of splat `i` but J, e, f and the limits of t; whether it reaches into the picture comes back.

    Parameters
    ----------
    centre
        Pixel and depth of its middle.
    box, outline
        From there; the box holds the low-pass filter's circle, too.
    dot
        Radius of that circle.
    """
    cx, cy, z = centre
    left, right = _first_pixel(cx + box[0], size[0]), _behind_last(cx + box[1], size[0])
    top, bottom = _first_pixel(cy + box[2], size[1]), _behind_last(cy + box[3], size[1])
    is_in = left < right and top < bottom
    if is_in:
        boxes[i, 0], boxes[i, 1], boxes[i, 2], boxes[i, 3] = left, right, top, bottom
        radii[i] = 0.5 * max(box[1] - box[0], box[3] - box[2])
        depths[i] = z
        whole_x, whole_y = np.float32(math.floor(cx)), np.float32(math.floor(cy))
        geometry[i, WHOLE_X], geometry[i, REST_X] = whole_x, cx - np.float64(whole_x)
        geometry[i, WHOLE_Y], geometry[i, REST_Y] = whole_y, cy - np.float64(whole_y)
        geometry[i, LEFT], geometry[i, RIGHT], geometry[i, TOP], geometry[i, BOTTOM] = left, right, top, bottom
        geometry[i, DISC_X], geometry[i, DISC_Y], geometry[i, OVER_HALF_HEIGHT] = outline[0], outline[1], outline[2]
        geometry[i, HALF_WIDTH], geometry[i, SHEAR] = outline[3], outline[4]
        geometry[i, DOT_RADIUS2] = (dot + SLACK_PX) * (dot + SLACK_PX)
        geometry[i, DEPTH], geometry[i, OPACITY] = z, opacity
    return is_in


@kernel
def project_splats(
    means: Floats,
    quats_wxyz: Floats,
    scales: Floats,
    opacities: Floats,
    offsets: Floats,
    camera: Array,
    lens: Array,
    size: tuple[int, int],
    limits: Array,
    start: int,
    stop: int,
    geometry: Floats,
    depths: Array,
    boxes: NDArray[np.int32],
    radii: Floats,
) -> None:
    """Fill the last four arrays for splats `start` to `stop`; those that are not drawn get an empty box and radius 0.

    Parameters
    ----------
    offsets
        Shape (n, 2), or (0, 2) for none.
    camera, lens, size
        Model's frame to camera axes, shape (4, 4); fx, fy, cx, cy; width, height.
    limits
        Nearest depth, least alpha, standard deviation of the low-pass filter, reach, least change of depth; the
        standard deviation of a blur in the place of that filter, 0 where there is none, and `raster.steepest`.
    geometry, depths
        Shapes (n, 24) and (n,).
    boxes
        Half-open ranges of columns and rows, shape (n, 4): left, right, top, bottom.
    """
    near_m, least, low_pass, far_reach, least_change, blur_px, steepest = limits
    low_pass = low_pass if blur_px == 0.0 else 0.0
    for i in range(start, stop):
        boxes[i, 0], boxes[i, 1], boxes[i, 2], boxes[i, 3] = 0, 0, 0, 0
        radii[i] = 0.0
        (x, y, z), _, _, _, slopes, jacobian = see(means, quats_wxyz, scales, camera, lens, i)
        su, sv, opacity = np.float64(scales[i, 0]), np.float64(scales[i, 1]), np.float64(opacities[i])
        # What is no number makes the sum one, and what is infinite the product.
        total = x + y + z + su + sv + opacity
        total += quats_wxyz[i, 0] + quats_wxyz[i, 1] + quats_wxyz[i, 2] + quats_wxyz[i, 3]
        is_finite = math.isfinite(0.0 * total)
        if not (is_finite and z > near_m and opacity >= least and su > 0.0 and sv > 0.0):
            continue
        cx, cy = lens[0] * x / z + lens[2], lens[1] * y / z + lens[3]
        if len(offsets) > 0:
            cx, cy = cx + offsets[i, 0], cy + offsets[i, 1]
        share = 1.0
        if blur_px > 0.0:
            jacobian, slopes, share = blurred_disc(jacobian, slopes, blur_px * blur_px, steepest)
        shown = shown_opacity(opacity, share, least)
        j_xu, j_xv, j_yu, j_yv = jacobian
        area = j_xu * j_yv - j_xv * j_yu
        has_disc = abs(area) >= LEAST_AREA_PX2
        steepness = math.sqrt(slopes[0] * slopes[0] + slopes[1] * slopes[1])
        reach = math.sqrt(max(2.0 * math.log(shown / least), 0.0))
        box, outline = (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, WIDEST_PX, 0.0, 0.0)
        if has_disc:
            outline = (0.0, 0.0, 0.0, WIDEST_PX, 0.0)
            if z * (1.0 - reach * steepness) < near_m:
                box = _clipped_box(jacobian, slopes, z, reach, near_m)
            else:
                box, exact = outline_of(jacobian, slopes, reach)
                if max(box[1] - box[0], box[3] - box[2]) < LARGEST_OUTLINE_PX:
                    outline = exact
        dot = low_pass * reach
        box = (min(box[0], -dot), max(box[1], dot), min(box[2], -dot), max(box[3], dot))
        if not place_disc((cx, cy, z), box, outline, dot, shown, size, i, geometry, depths, boxes, radii):
            continue
        change = min(max(far_reach * steepness, least_change) * LIMITS_WIDENED, MOST_CHANGE)
        nearest = z / near_m - 1.0
        geometry[i, LOWEST] = -change / (1.0 + change)
        geometry[i, HIGHEST] = min(change / (1.0 - change), nearest) if change < 1.0 else nearest
        if has_disc:
            over = 1.0 / area
            geometry[i, J_XU], geometry[i, J_XV] = j_xu * over, j_xv * over
            geometry[i, J_YU], geometry[i, J_YV] = j_yu * over, j_yv * over
            geometry[i, E] = (j_yu * slopes[1] - j_yv * slopes[0]) * over
            geometry[i, F] = (j_xv * slopes[0] - j_xu * slopes[1]) * over
        else:
            geometry[i, J_XU], geometry[i, J_XV], geometry[i, J_YU] = EDGE_ON_JACOBIAN, 0.0, 0.0
            geometry[i, J_YV], geometry[i, E], geometry[i, F] = EDGE_ON_JACOBIAN, 0.0, 0.0


# Ellipsoids, by `projection.project_ellipsoids`: drawn as discs of one depth (e = f = 0), so that squares, blending and
# gradients are those of flat splats. The low-pass filter never counts: the blur is in the disc.

Axes = tuple[Triple, Triple, Triple]
Slopes = tuple[float, float, bool, bool]
"""x / z and y / z as they are in J, and whether they are those of the middle."""


@inline
def dot(a: Triple, b: Triple) -> float:
    """Dot product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inline
def cross(a: Triple, b: Triple) -> Triple:
    """Cross product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inline
def see_ellipsoid(
    means: Floats, quats_wxyz: Floats, scales: Floats, camera: Array, lens: Array, slope_limits: Array, i: int
) -> tuple[Triple, Quat, Axes, Slopes, Triple, Triple]:
    """Ellipsoid `i` in camera axes: middle, rotation, unit axes, slopes, and the two rows of J W R S."""
    x, y, z = in_camera(camera, np.float64(means[i, 0]), np.float64(means[i, 1]), np.float64(means[i, 2]))
    x, y, z = x + camera[0, 3], y + camera[1, 3], z + camera[2, 3]
    first, second, quat = rotation_columns(
        np.float64(quats_wxyz[i, 0]), np.float64(quats_wxyz[i, 1]),
        np.float64(quats_wxyz[i, 2]), np.float64(quats_wxyz[i, 3]),
    )  # fmt: skip
    third = cross(first, second)
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
def ellipse_covariance(row_x: Triple, row_y: Triple, blur2: float) -> tuple[float, float, Triple, float]:
    """Of Sigma' the first two entries; the cross product of its rows, and its determinant."""
    xx, across = dot(row_x, row_x), cross(row_x, row_y)
    determinant = dot(across, across) + blur2 * (xx + dot(row_y, row_y) + blur2)
    return xx + blur2, dot(row_x, row_y), across, determinant


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
    """Fill the last four arrays for ellipsoids `start` to `stop`, as `project_splats` does for discs.

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
        (x, y, z), _, _, _, row_x, row_y = see_ellipsoid(means, quats_wxyz, scales, camera, lens, slope_limits, i)
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
        xx, xy, across, determinant = ellipse_covariance(row_x, row_y, blur2)
        share = math.sqrt(dot(across, across) / determinant) if antialiased else 1.0
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
