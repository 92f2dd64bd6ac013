"""A picture of light by direction, an octahedron folded out: places of directions, light there, and its gradients."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel

Array = NDArray[np.float32]
Number = np.float32
Pixels = tuple[int, int, int, int]
Shares = tuple[Number, Number, Number, Number]

ONE, HALF, NONE = np.float32(1.0), np.float32(0.5), np.float32(0.0)


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
