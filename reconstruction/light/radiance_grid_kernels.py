"""Marching rays through a grid of density and light, forward and backward, compiled.

All arrays are float32 and C-contiguous. A grid's vertices carry raw density and the square roots of red, green and blue
light. A ray visits the places `times` along it, the same for all rays but for a share of a step of its own. Gradients
are written to arrays that belong to a chunk of rays alone and are added up in the order of chunks, so that they do not
depend on the number of threads.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import types as numba_types
from numba.extending import intrinsic
from numpy.typing import NDArray

from planning.base.jit import kernel

Array = NDArray[np.float32]
Number = np.float32


# A picture of light by direction, an octahedron folded out: places of directions, light there, and its gradients.

Pixels = tuple[int, int, int, int]
Shares = tuple[Number, Number, Number, Number]

ONE, HALF, TWO, NONE = np.float32(1.0), np.float32(0.5), np.float32(2.0), np.float32(0.0)


@kernel
def unfolded(x: Number, y: Number, z: Number) -> tuple[Number, Number]:
    """Place of a direction, -1 to 1, in a square picture of all directions.

    The faces of an octahedron around the origin, the lower ones folded out.
    """
    length = abs(x) + abs(y) + abs(z)
    u, v = x / length, y / length
    if z < NONE:
        u, v = (
            (ONE - abs(v)) * (ONE if u >= NONE else -ONE),
            (ONE - abs(u)) * (ONE if v >= NONE else -ONE),
        )
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
    x_sign, y_sign, z_sign = (
        ONE if dx >= NONE else -ONE,
        ONE if dy >= NONE else -ONE,
        ONE if dz >= NONE else -ONE,
    )
    if dz < NONE:
        by_u, by_v = -x_sign * y_sign * by_v, -x_sign * y_sign * by_u
    along = by_u * u + by_v * v
    return (by_u - along * x_sign) / length, (by_v - along * y_sign) / length, -along * z_sign / length


# Blends of four channels at the eight vertices of a cell, each vertex's channels in one register of the processor.
#
# Numba's compiler takes such sums apart into single numbers, three times as slow; here they are put together for it.
# Arrays are float32, flat, C-contiguous, and hold four channels a vertex. A cell's first vertex begins at number
# `at`;
# its neighbours along x, y and z are 4, `over` and `up` numbers further on. Nothing is checked: callers stay inside.

CHANNELS, VERTICES = 4, 8
types: Any = numba_types
FLOAT, ALIGN = ir.FloatType(), 4
QUAD = ir.VectorType(FLOAT, CHANNELS)
FUSED = ("contract",)
"""Products and sums may be rounded once, together."""

Codegen = Callable[[Any, Any, Any, Any], Any]


@intrinsic  # type: ignore[untyped-decorator]
def blended(_context: Any, flat: Any, at: Any, over: Any, up: Any, weights: Any) -> tuple[Any, Codegen]:
    """Four channels between a cell's vertices, whose eight `weights` come in the order of x, y and z."""

    def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        corners = _corners(context, builder, signature, arguments)
        shares = [builder.extract_value(arguments[4], k) for k in range(VERTICES)]
        total = None
        for corner, share in zip(corners, shares, strict=True):
            part = builder.fmul(_filled(builder, share), builder.load(corner, align=ALIGN), flags=FUSED)
            total = part if total is None else builder.fadd(total, part, flags=FUSED)
        return _tuple_of(builder, [_lane(builder, total, k) for k in range(CHANNELS)])

    return types.UniTuple(types.float32, CHANNELS)(flat, at, over, up, weights), codegen


@intrinsic  # type: ignore[untyped-decorator]
def spread(_context: Any, flat: Any, at: Any, over: Any, up: Any, weights: Any, amounts: Any) -> tuple[Any, Codegen]:
    """Add four channels' `amounts` to a cell's vertices, by their eight `weights`."""

    def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        added = _quad(builder, arguments[5])
        for number, corner in enumerate(_corners(context, builder, signature, arguments)):
            share = _filled(builder, builder.extract_value(arguments[4], number))
            part = builder.fmul(share, added, flags=FUSED)
            builder.store(builder.fadd(builder.load(corner, align=ALIGN), part, flags=FUSED), corner, align=ALIGN)
        return context.get_dummy_value()

    return types.none(flat, at, over, up, weights, amounts), codegen


@intrinsic  # type: ignore[untyped-decorator]
def weighed(_context: Any, flat: Any, at: Any, over: Any, up: Any, amounts: Any) -> tuple[Any, Codegen]:
    """Of each of a cell's eight vertices, the sum of its four channels times `amounts`."""

    def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        factors = _quad(builder, arguments[4])
        sums = []
        for corner in _corners(context, builder, signature, arguments):
            part = builder.fmul(factors, builder.load(corner, align=ALIGN), flags=FUSED)
            a, b, c, d = (_lane(builder, part, k) for k in range(CHANNELS))
            sums.append(builder.fadd(builder.fadd(a, b), builder.fadd(c, d)))
        return _tuple_of(builder, sums)

    return types.UniTuple(types.float32, VERTICES)(flat, at, over, up, amounts), codegen


def _corners(context: Any, builder: Any, signature: Any, arguments: Any) -> list[Any]:
    """Pointers to the channels of a cell's vertices: x changes first, z last."""
    array = context.make_array(signature.args[0])(context, builder, arguments[0])
    at, over, up = arguments[1:4]
    beside = ir.Constant(at.type, CHANNELS)
    rows = [at, builder.add(at, over), builder.add(at, up)]
    rows.append(builder.add(rows[2], over))
    places = [place for row in rows for place in (row, builder.add(row, beside))]
    return [builder.bitcast(builder.gep(array.data, [place]), QUAD.as_pointer()) for place in places]


def _filled(builder: Any, value: Any) -> Any:
    """A register with a number in each lane."""
    return _joined(builder, [value] * CHANNELS)


def _quad(builder: Any, values: Any) -> Any:
    """A register with the numbers of a tuple."""
    return _joined(builder, [builder.extract_value(values, k) for k in range(CHANNELS)])


def _joined(builder: Any, values: list[Any]) -> Any:
    register = ir.Constant(QUAD, ir.Undefined)
    for k, value in enumerate(values):
        register = builder.insert_element(register, value, ir.Constant(ir.IntType(32), k))
    return register


def _lane(builder: Any, register: Any, number: int) -> Any:
    return builder.extract_element(register, ir.Constant(ir.IntType(32), number))


def _tuple_of(builder: Any, values: list[Any]) -> Any:
    found = ir.Constant(ir.ArrayType(FLOAT, len(values)), ir.Undefined)
    for k, value in enumerate(values):
        found = builder.insert_value(found, value, k)
    return found


Bytes = NDArray[np.uint8]
Numbers = NDArray[np.int64]
Weights = tuple[Number, Number, Number, Number, Number, Number, Number, Number]


DENSITY_SCALE = np.float32(10.0)
"""Of raw density to what vertices carry, so that density and light are learned at one rate."""

OPAQUE = np.float32(1e-3)
"""Share of the light of what lies behind below which a ray ends; what is left goes to what is far away."""


KEPT = 9
"""Numbers kept of a place where a ray lost light: when, where in the grid, the share lost, what its density is to raw
density, and square roots of its light."""


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
def first_of(place: Number, n: int) -> int:
    """Of the two of `n` vertices along an axis that a place, counted in cells, is between; of NaN, one that exists."""
    return max(min(int(place), n - 2), 0)


@kernel
def weights_of(a: Number, b: Number, c: Number) -> Weights:
    """Of the eight vertices around a place that is so far along each side of its cell."""
    d, e, f = ONE - a, ONE - b, ONE - c
    return d * e * f, a * e * f, d * b * f, a * b * f, d * e * c, a * e * c, d * b * c, a * b * c


@kernel
def rises(v: Weights, a: Number, b: Number, c: Number) -> tuple[Number, Number, Number]:
    """How fast a blend of values at the eight vertices changes along the three sides of a cell, per cell."""
    d, e, f = ONE - a, ONE - b, ONE - c
    return (
        (v[1] - v[0]) * e * f + (v[3] - v[2]) * b * f + (v[5] - v[4]) * e * c + (v[7] - v[6]) * b * c,
        (v[2] - v[0]) * d * f + (v[3] - v[1]) * a * f + (v[6] - v[4]) * d * c + (v[7] - v[5]) * a * c,
        (v[4] - v[0]) * d * e + (v[5] - v[1]) * a * e + (v[6] - v[2]) * d * b + (v[7] - v[3]) * a * b,
    )


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
    times: Array, steps: Array, unit: Number, first: int, last: int, light: Array, left: Array, passed: Array,
    ends: Numbers,
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
    passed, ends
        What `march_back` asks for, written: the places where these rays lost light, one ray after the other, shape
        (at least s (last - first), KEPT), and where each ray's end, shape (n,). None are wanted where `ends` is empty.
    """
    nz, ny, nx = cells.shape[0], cells.shape[1], cells.shape[2]
    outer, shortest, widest = box[6], box[7], ONE + box[6]
    scale = HALF / widest
    sx, sy, sz = np.float32(nx - 1) * scale, np.float32(ny - 1) * scale, np.float32(nz - 1) * scale
    flat, away, side = cells.reshape(-1), far.reshape(-1), far.shape[0]
    up, over = nx * ny * 4, nx * 4
    is_kept, end = len(ends) > 0, 0
    for ray in range(first, last):
        # Where a ray is in the inner box, -1 to 1 along each side, at a time t: p + t q.
        px, qx = (origins[ray, 0] - box[0]) * box[3], directions[ray, 0] * box[3]
        py, qy = (origins[ray, 1] - box[1]) * box[4], directions[ray, 1] * box[4]
        pz, qz = (origins[ray, 2] - box[2]) * box[5], directions[ray, 2] * box[5]
        through, red, green, blue = ONE, NONE, NONE, NONE
        number = 0
        while number < len(times):
            step = steps[number]
            time = times[number] + starts[ray] * step
            x = (contracted(px + time * qx, outer)[0] + widest) * sx
            y = (contracted(py + time * qy, outer)[0] + widest) * sy
            z = (contracted(pz + time * qz, outer)[0] + widest) * sz
            i, j, k = first_of(x, nx), first_of(y, ny), first_of(z, nz)
            skip = skips[k, j, i]
            if skip > 0:
                number = next_number(number, skip, shortest, times)
                continue
            number += 1
            w = weights_of(x - np.float32(i), y - np.float32(j), z - np.float32(k))
            raw, r0, r1, r2 = blended(flat, ((k * ny + j) * nx + i) * 4, over, up, w)
            raw *= DENSITY_SCALE
            if raw <= -ONE:
                continue
            density, slope = ramp(raw)
            share = through * (ONE - np.float32(math.exp(-density * unit * step)))
            red += share * r0 * r0
            green += share * r1 * r1
            blue += share * r2 * r2
            through -= share
            if is_kept:
                kept = passed[end]
                kept[0], kept[1], kept[2], kept[3] = time, x, y, z
                kept[4], kept[5] = share, DENSITY_SCALE * unit * step * slope
                kept[6], kept[7], kept[8] = r0, r1, r2
                end += 1
            if through < OPAQUE:
                break
        if is_kept:
            ends[ray] = end
        numbers, shares = around(directions[ray, 0], directions[ray, 1], directions[ray, 2], side)
        root = looked_up(away, numbers, shares, 0)
        light[ray, 0] = red + through * root * root
        root = looked_up(away, numbers, shares, 1)
        light[ray, 1] = green + through * root * root
        root = looked_up(away, numbers, shares, 2)
        light[ray, 2] = blue + through * root * root
        left[ray] = through


@kernel
def march_back(
    origins: Array, directions: Array, cells: Array, far: Array, box: Array, first: int, last: int, light: Array,
    left: Array, passed: Array, ends: Numbers, slopes: Array, cell_slopes: Array, far_slopes: Array,
    every: int, origin_slopes: Array, direction_slopes: Array,
) -> None:  # fmt: skip
    """Gradients of `light` that `march` wrote, with all else; arguments of the same names are the same.

    With c the light and s the density at a place, a step t long, and B the light that comes from behind it, the slope
    by s is t (T' c - B) for the share T' that is let through up to its end; B is the whole less what came before.

    Parameters
    ----------
    slopes
        Of the loss by `light`, shape (n, 3).
    cell_slopes, far_slopes
        By `cells` and `far`: added to.
    every
        Gradients of origins and directions are those of each `every`-th ray, so many times; 0 for all others.
    origin_slopes, direction_slopes
        Shape (n, 3), written; none are wanted where their length is 0.
    """
    nz, ny, nx = cells.shape[0], cells.shape[1], cells.shape[2]
    outer, widest = box[6], ONE + box[6]
    scale = HALF / widest
    sx, sy, sz = np.float32(nx - 1) * scale, np.float32(ny - 1) * scale, np.float32(nz - 1) * scale
    flat, away, side, grown = cells.reshape(-1), far.reshape(-1), far.shape[0], cell_slopes.reshape(-1)
    far_grown = far_slopes.reshape(-1)
    up, over = nx * ny * 4, nx * 4
    times_as_much = np.float32(every)
    number = 0
    for ray in range(first, last):
        is_moved = len(origin_slopes) > 0 and ray % every == 0
        ox, oy, oz = origins[ray, 0], origins[ray, 1], origins[ray, 2]
        dx, dy, dz = directions[ray, 0], directions[ray, 1], directions[ray, 2]
        g0, g1, g2 = slopes[ray, 0], slopes[ray, 1], slopes[ray, 2]
        behind = g0 * light[ray, 0] + g1 * light[ray, 1] + g2 * light[ray, 2]
        through = ONE
        mx, my, mz, tx, ty, tz = NONE, NONE, NONE, NONE, NONE, NONE
        while number < ends[ray]:
            kept = passed[number]
            number += 1
            time, x, y, z, share = kept[0], kept[1], kept[2], kept[3], kept[4]
            r0, r1, r2 = kept[6], kept[7], kept[8]
            here = g0 * r0 * r0 + g1 * r1 * r1 + g2 * r2 * r2
            through -= share
            behind -= share * here
            twice = TWO * share
            amounts = (kept[5] * (through * here - behind), twice * r0 * g0, twice * r1 * g1, twice * r2 * g2)
            i, j, k = first_of(x, nx), first_of(y, ny), first_of(z, nz)
            a, b, c = x - np.float32(i), y - np.float32(j), z - np.float32(k)
            at = ((k * ny + j) * nx + i) * 4
            spread(grown, at, over, up, weights_of(a, b, c), amounts)
            if is_moved:
                x, y, z = rises(weighed(flat, at, over, up, amounts), a, b, c)
                x *= sx * box[3] * contracted((ox + time * dx - box[0]) * box[3], outer)[1]
                y *= sy * box[4] * contracted((oy + time * dy - box[1]) * box[4], outer)[1]
                z *= sz * box[5] * contracted((oz + time * dz - box[2]) * box[5], outer)[1]
                mx, my, mz = mx + x, my + y, mz + z
                tx, ty, tz = tx + time * x, ty + time * y, tz + time * z
        through = left[ray]
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
        if len(origin_slopes) > 0:
            if is_moved:
                x, y, z = turned(dx, dy, dz, by_u, by_v)
                tx, ty, tz = tx + x, ty + y, tz + z
            origin_slopes[ray, 0], origin_slopes[ray, 1] = times_as_much * mx, times_as_much * my
            origin_slopes[ray, 2] = times_as_much * mz
            direction_slopes[ray, 0], direction_slopes[ray, 1] = times_as_much * tx, times_as_much * ty
            direction_slopes[ray, 2] = times_as_much * tz


@kernel
def pull(here: Array, there: Array, inverses: Array, factors: Array, slopes: Array) -> None:
    """Add the slopes of Huber's function of differences; the loop is one that Numba's compiler makes vectors of."""
    for number in range(len(here)):
        off = (here[number] - there[number]) * inverses[number]
        off = ONE if off > ONE else off
        off = -ONE if off < -ONE else off
        slopes[number] += factors[number] * off


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
    row, up = nx * 4, ny * nx * 4
    inverses, factors, added = np.empty(row, np.float32), np.empty(row, np.float32), np.zeros(row, np.float32)
    for number in range(row):
        inverses[number], factors[number] = ONE / corners[number % 4], amounts[number % 4]
    added[::4] = emptier
    for k in range(first, last):
        for j in range(ny):
            at = k * up + j * row
            here, slope = flat[at : at + row], grown[at : at + row]
            slope[:] = added
            pull(here[4:], here[:-4], inverses, factors, slope[4:])
            pull(here[:-4], here[4:], inverses, factors, slope[:-4])
            for other, is_there in ((at - row, j > 0), (at + row, j < ny - 1), (at - up, k > 0), (at + up, k < nz - 1)):
                if is_there:
                    pull(here, flat[other : other + row], inverses, factors, slope)
