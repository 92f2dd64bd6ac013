"""Marching rays through a grid of density and light, forward and backward, compiled; `radiance_grid_twin` is its twin.

All arrays are float32 and C-contiguous. A grid's vertices carry raw density and the square roots of red, green and blue
light. A ray visits the places `times` along it, the same for all rays but for a share of a step of its own. Gradients
are written to arrays that belong to a chunk of rays alone and are added up in the order of chunks, so that they do not
depend on the number of threads.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planning.jit import kernel

Array = NDArray[np.float32]
Bytes = NDArray[np.uint8]
Number = np.float32
Pixels = tuple[int, int, int, int]
Shares = tuple[Number, Number, Number, Number]
Weights = tuple[Number, Number, Number, Number, Number, Number, Number, Number]

ONE, HALF, TWO, NONE = np.float32(1.0), np.float32(0.5), np.float32(2.0), np.float32(0.0)

DENSITY_SCALE = np.float32(10.0)
"""Of raw density to what vertices carry, so that density and light are learned at one rate."""

OPAQUE = np.float32(1e-3)
"""Share of the light of what lies behind below which a ray ends; what is left goes to what is far away."""


@kernel
def ramp(raw: Number) -> tuple[Number, Number]:
    """0 up to -1, raw from 1 on, a parabola in between; and its slope. As soft as softplus, and quicker."""
    if raw >= ONE:
        return raw, ONE
    above = max(HALF * (raw + ONE), NONE)
    return above * above, above


@kernel
def contracted(value: Number, outer: Number) -> tuple[Number, Number]:
    """-1 to 1 stays; what is beyond, up to infinity, goes on to 1 + `outer`. With the slope."""
    if value > ONE:
        return ONE + outer * (ONE - ONE / value), outer / (value * value)
    if value < -ONE:
        return -ONE - outer * (ONE + ONE / value), outer / (value * value)
    return value, ONE


@kernel
def unfolded(x: Number, y: Number, z: Number) -> tuple[Number, Number]:
    """Place of a direction, -1 to 1, in a square picture of all directions.

    The faces of an octahedron around the origin, the lower ones folded out.
    """
    length = abs(x) + abs(y) + abs(z)
    u, v = x / length, y / length
    if z < NONE:
        u, v = ((ONE - abs(v)) * (ONE if u >= NONE else -ONE), (ONE - abs(u)) * (ONE if v >= NONE else -ONE))
    return u, v


@kernel
def wrapped(column: int, row: int, side: int) -> int:
    """First number of a pixel of the picture, also one step over its edges: each meets itself, turned about."""
    if column < 0 or column >= side:
        column = 0 if column < 0 else side - 1
        row = side - 1 - row
    if row < 0 or row >= side:
        row = 0 if row < 0 else side - 1
        column = side - 1 - column
    return (row * side + column) * 3


@kernel
def weights_of(a: Number, b: Number, c: Number) -> Weights:
    """Of the eight vertices around a place that is so far along each side of its cell."""
    d, e, f = ONE - a, ONE - b, ONE - c
    return d * e * f, a * e * f, d * b * f, a * b * f, d * e * c, a * e * c, d * b * c, a * b * c


@kernel
def blended(flat: Array, at: int, over: int, up: int, w: Weights) -> Number:
    """Of one channel's values at the vertices, the first of which is number `at`."""
    p, q = at + over, at + up
    r = q + over
    lower = (w[0] * flat[at] + w[1] * flat[at + 4]) + (w[2] * flat[p] + w[3] * flat[p + 4])
    value: Number = lower + ((w[4] * flat[q] + w[5] * flat[q + 4]) + (w[6] * flat[r] + w[7] * flat[r + 4]))
    return value


@kernel
def spread(flat: Array, at: int, over: int, up: int, w: Weights, d: Number, e: Number, f: Number, g: Number) -> None:
    """Add four channels' amounts to the vertices, the first of which is number `at`."""
    p, q = at + over, at + up
    r = q + over
    for number, (place, weight) in enumerate(((at, w[0]), (p, w[2]), (q, w[4]), (r, w[6]))):
        flat[place] += weight * d
        flat[place + 1] += weight * e
        flat[place + 2] += weight * f
        flat[place + 3] += weight * g
        beside = w[2 * number + 1]
        flat[place + 4] += beside * d
        flat[place + 5] += beside * e
        flat[place + 6] += beside * f
        flat[place + 7] += beside * g


@kernel
def rises(flat: Array, at: int, over: int, up: int, a: Number, b: Number, c: Number) -> tuple[Number, Number, Number]:
    """How fast one channel's blend changes along the three sides of a cell, per cell."""
    p, q = at + over, at + up
    r = q + over
    d, e, f = ONE - a, ONE - b, ONE - c
    v0, v1, v2, v3 = flat[at], flat[at + 4], flat[p], flat[p + 4]
    v4, v5, v6, v7 = flat[q], flat[q + 4], flat[r], flat[r + 4]
    return (
        (v1 - v0) * e * f + (v3 - v2) * b * f + (v5 - v4) * e * c + (v7 - v6) * b * c,
        (v2 - v0) * d * f + (v3 - v1) * a * f + (v6 - v4) * d * c + (v7 - v5) * a * c,
        (v4 - v0) * d * e + (v5 - v1) * a * e + (v6 - v2) * d * b + (v7 - v3) * a * b,
    )


@kernel
def looked_up(away: Array, n: Pixels, w: Shares, channel: int) -> Number:
    """Square root of light between four pixels of the picture of what is far away."""
    upper = w[0] * away[n[0] + channel] + w[1] * away[n[1] + channel]
    value: Number = upper + (w[2] * away[n[2] + channel] + w[3] * away[n[3] + channel])
    return value


@kernel
def around(
    dx: Number, dy: Number, dz: Number, side: int
) -> tuple[tuple[int, int, int, int], tuple[Number, Number, Number, Number]]:
    """First numbers and weights of the four pixels around a direction."""
    u, v = unfolded(dx, dy, dz)
    half = HALF * np.float32(side)
    u, v = u * half + half - HALF, v * half + half - HALF
    column, row = math.floor(u), math.floor(v)
    a, b = u - np.float32(column), v - np.float32(row)
    numbers = (
        wrapped(column, row, side),
        wrapped(column + 1, row, side),
        wrapped(column, row + 1, side),
        wrapped(column + 1, row + 1, side),
    )
    return numbers, ((ONE - a) * (ONE - b), a * (ONE - b), (ONE - a) * b, a * b)


@kernel
def turned(dx: Number, dy: Number, dz: Number, by_u: Number, by_v: Number) -> tuple[Number, Number, Number]:
    """Gradient by a direction of what has gradients by its place in the picture."""
    length = abs(dx) + abs(dy) + abs(dz)
    u, v = dx / length, dy / length
    x_sign, y_sign, z_sign = (ONE if dx >= NONE else -ONE, ONE if dy >= NONE else -ONE, ONE if dz >= NONE else -ONE)
    if dz < NONE:
        by_u, by_v = -x_sign * y_sign * by_v, -x_sign * y_sign * by_u
    along = by_u * u + by_v * v
    return (by_u - along * x_sign) / length, (by_v - along * y_sign) / length, -along * z_sign / length


@kernel
def next_number(number: int, skip: int, shortest: Number, times: Array) -> int:
    """Of the place after one in an empty cell, from which something is `skip` cells away at least."""
    reach = times[number] + np.float32(skip - 1) * shortest
    number += 1
    while number < len(times) and times[number] < reach:
        number += 1
    return number


@kernel
def march(
    origins: Array, directions: Array, starts: Array, cells: Array, skips: Bytes, far: Array, box: Array,
    times: Array, steps: Array, unit: Number, first: int, last: int, light: Array, left: Array,
) -> None:  # fmt: skip
    """Light that comes along rays `first` to `last`, and the share of it that comes from far away.

    Parameters
    ----------
    origins, directions
        Shape (n, 3), in the grid's axes; directions are unit.
    starts
        Share of a step, 0 to 1, by which each ray's places are further on, shape (n,).
    cells
        Shape (nz, ny, nx, 4).
    skips
        Shape (nz - 1, ny - 1, nx - 1): 0 where something may be, else how many cells away that is, at most 255.
    far
        Shape (side, side, 3), square roots of light.
    box
        Middle of the inner box, 1 over its half sides, `outer`, and the shortest side of a cell, shape (8,).
    times, steps
        Shape (s,), rising.
    unit
        Density, 1 over length, of a ramp of 1.
    light, left
        Shapes (n, 3) and (n,), written.
    """
    nz, ny, nx = cells.shape[0], cells.shape[1], cells.shape[2]
    outer, shortest, widest = box[6], box[7], ONE + box[6]
    scale = HALF / widest
    sx, sy, sz = np.float32(nx - 1) * scale, np.float32(ny - 1) * scale, np.float32(nz - 1) * scale
    flat, away, side = cells.reshape(-1), far.reshape(-1), far.shape[0]
    up, over = nx * ny * 4, nx * 4
    for ray in range(first, last):
        ox, oy, oz = origins[ray, 0], origins[ray, 1], origins[ray, 2]
        dx, dy, dz = directions[ray, 0], directions[ray, 1], directions[ray, 2]
        through, red, green, blue = ONE, NONE, NONE, NONE
        number = 0
        while number < len(times):
            step = steps[number]
            time = times[number] + starts[ray] * step
            x = (contracted((ox + time * dx - box[0]) * box[3], outer)[0] + widest) * sx
            y = (contracted((oy + time * dy - box[1]) * box[4], outer)[0] + widest) * sy
            z = (contracted((oz + time * dz - box[2]) * box[5], outer)[0] + widest) * sz
            i, j, k = min(int(x), nx - 2), min(int(y), ny - 2), min(int(z), nz - 2)
            skip = skips[k, j, i]
            if skip > 0:
                number = next_number(number, skip, shortest, times)
                continue
            number += 1
            w = weights_of(x - np.float32(i), y - np.float32(j), z - np.float32(k))
            at = ((k * ny + j) * nx + i) * 4
            raw = DENSITY_SCALE * blended(flat, at, over, up, w)
            if raw <= -ONE:
                continue
            share = through * (ONE - np.float32(math.exp(-ramp(raw)[0] * unit * step)))
            root = blended(flat, at + 1, over, up, w)
            red += share * root * root
            root = blended(flat, at + 2, over, up, w)
            green += share * root * root
            root = blended(flat, at + 3, over, up, w)
            blue += share * root * root
            through -= share
            if through < OPAQUE:
                break
        numbers, shares = around(dx, dy, dz, side)
        root = looked_up(away, numbers, shares, 0)
        light[ray, 0] = red + through * root * root
        root = looked_up(away, numbers, shares, 1)
        light[ray, 1] = green + through * root * root
        root = looked_up(away, numbers, shares, 2)
        light[ray, 2] = blue + through * root * root
        left[ray] = through


@kernel
def march_back(
    origins: Array, directions: Array, starts: Array, cells: Array, skips: Bytes, far: Array, box: Array,
    times: Array, steps: Array, unit: Number, first: int, last: int, light: Array, slopes: Array,
    cell_slopes: Array, far_slopes: Array, origin_slopes: Array, direction_slopes: Array,
) -> None:  # fmt: skip
    """Gradients of `light` that `march` wrote; its first arguments are the same.

    With c the light and s the density at a place, a step t long, and B the light that comes from behind it, the slope
    by s is t (T' c - B) for the share T' that is let through up to its end; B is the whole less what came before.

    Parameters
    ----------
    slopes
        Of the loss by `light`, shape (n, 3).
    cell_slopes, far_slopes
        By `cells` and `far`: added to.
    origin_slopes, direction_slopes
        Shape (n, 3), written; none are wanted where their length is 0.
    """
    nz, ny, nx = cells.shape[0], cells.shape[1], cells.shape[2]
    outer, shortest, widest = box[6], box[7], ONE + box[6]
    scale = HALF / widest
    sx, sy, sz = np.float32(nx - 1) * scale, np.float32(ny - 1) * scale, np.float32(nz - 1) * scale
    flat, away, side, grown = cells.reshape(-1), far.reshape(-1), far.shape[0], cell_slopes.reshape(-1)
    far_grown = far_slopes.reshape(-1)
    up, over = nx * ny * 4, nx * 4
    is_moved = len(origin_slopes) > 0
    for ray in range(first, last):
        ox, oy, oz = origins[ray, 0], origins[ray, 1], origins[ray, 2]
        dx, dy, dz = directions[ray, 0], directions[ray, 1], directions[ray, 2]
        g0, g1, g2 = slopes[ray, 0], slopes[ray, 1], slopes[ray, 2]
        behind = g0 * light[ray, 0] + g1 * light[ray, 1] + g2 * light[ray, 2]
        through = ONE
        mx, my, mz, tx, ty, tz = NONE, NONE, NONE, NONE, NONE, NONE
        number = 0
        while number < len(times):
            step = steps[number]
            time = times[number] + starts[ray] * step
            x, slope_x = contracted((ox + time * dx - box[0]) * box[3], outer)
            y, slope_y = contracted((oy + time * dy - box[1]) * box[4], outer)
            z, slope_z = contracted((oz + time * dz - box[2]) * box[5], outer)
            x, y, z = (x + widest) * sx, (y + widest) * sy, (z + widest) * sz
            i, j, k = min(int(x), nx - 2), min(int(y), ny - 2), min(int(z), nz - 2)
            skip = skips[k, j, i]
            if skip > 0:
                number = next_number(number, skip, shortest, times)
                continue
            number += 1
            a, b, c = x - np.float32(i), y - np.float32(j), z - np.float32(k)
            w = weights_of(a, b, c)
            at = ((k * ny + j) * nx + i) * 4
            raw = DENSITY_SCALE * blended(flat, at, over, up, w)
            if raw <= -ONE:
                continue
            density, slope = ramp(raw)
            share = through * (ONE - np.float32(math.exp(-density * unit * step)))
            r0 = blended(flat, at + 1, over, up, w)
            r1 = blended(flat, at + 2, over, up, w)
            r2 = blended(flat, at + 3, over, up, w)
            here = g0 * r0 * r0 + g1 * r1 * r1 + g2 * r2 * r2
            through -= share
            behind -= share * here
            by_raw = DENSITY_SCALE * unit * step * slope * (through * here - behind)
            by0, by1, by2 = TWO * share * r0 * g0, TWO * share * r1 * g1, TWO * share * r2 * g2
            spread(grown, at, over, up, w, by_raw, by0, by1, by2)
            if is_moved:
                x0, y0, z0 = rises(flat, at, over, up, a, b, c)
                x1, y1, z1 = rises(flat, at + 1, over, up, a, b, c)
                x2, y2, z2 = rises(flat, at + 2, over, up, a, b, c)
                x3, y3, z3 = rises(flat, at + 3, over, up, a, b, c)
                x = (by_raw * x0 + by0 * x1 + by1 * x2 + by2 * x3) * sx * slope_x * box[3]
                y = (by_raw * y0 + by0 * y1 + by1 * y2 + by2 * y3) * sy * slope_y * box[4]
                z = (by_raw * z0 + by0 * z1 + by1 * z2 + by2 * z3) * sz * slope_z * box[5]
                mx, my, mz = mx + x, my + y, mz + z
                tx, ty, tz = tx + time * x, ty + time * y, tz + time * z
            if through < OPAQUE:
                break
        numbers, shares = around(dx, dy, dz, side)
        n0, n1, n2, n3 = numbers
        by_u, by_v = NONE, NONE
        for channel, by_light in enumerate((g0, g1, g2)):
            by_root = TWO * through * by_light * looked_up(away, numbers, shares, channel)
            for pixel, weight in zip(numbers, shares):  # noqa: B905 - Numba knows no strict
                far_grown[pixel + channel] += weight * by_root
            by_root *= HALF * np.float32(side)
            v0, v1, v2, v3 = away[n0 + channel], away[n1 + channel], away[n2 + channel], away[n3 + channel]
            by_u += by_root * ((v1 - v0) * (shares[0] + shares[1]) + (v3 - v2) * (shares[2] + shares[3]))
            by_v += by_root * ((v2 - v0) * (shares[0] + shares[2]) + (v3 - v1) * (shares[1] + shares[3]))
        if is_moved:
            x, y, z = turned(dx, dy, dz, by_u, by_v)
            tx, ty, tz = tx + x, ty + y, tz + z
            origin_slopes[ray, 0], origin_slopes[ray, 1], origin_slopes[ray, 2] = mx, my, mz
            direction_slopes[ray, 0], direction_slopes[ray, 1], direction_slopes[ray, 2] = tx, ty, tz


@kernel
def rough(cells: Array, amounts: Array, corners: Array, emptier: Number, first: int, last: int, slopes: Array) -> None:
    """Gradient of the roughness of layers `first` to `last`: Huber's function of neighbours' differences, added up.

    Parameters
    ----------
    cells, slopes
        Shape (nz, ny, nx, 4); the slopes of these layers are written.
    amounts, corners
        Factor of each channel, and difference from which on its function is straight, shape (4,).
    emptier
        Factor of raw density, added up too.
    """
    nz, ny, nx = cells.shape[0], cells.shape[1], cells.shape[2]
    flat, grown = cells.reshape(-1), slopes.reshape(-1)
    up, over = nx * ny * 4, nx * 4
    inverses = ONE / corners
    for k in range(first, last):
        below, above = (-up if k > 0 else 0), (up if k < nz - 1 else 0)
        for j in range(ny):
            before, after = (-over if j > 0 else 0), (over if j < ny - 1 else 0)
            for i in range(nx):
                left, right = (-4 if i > 0 else 0), (4 if i < nx - 1 else 0)
                for channel in range(4):
                    at = k * up + j * over + i * 4 + channel
                    here, inverse = flat[at], inverses[channel]
                    slope = NONE
                    for other in (left, right, before, after, below, above):
                        slope += min(max((here - flat[at + other]) * inverse, -ONE), ONE)
                    grown[at] = amounts[channel] * slope
                grown[k * up + j * over + i * 4] += emptier
