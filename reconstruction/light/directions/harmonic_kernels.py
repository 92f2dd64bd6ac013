"""Harmonics at places on panels, blended, forward and backward, compiled; `HarmonicTexture` has them in plain torch.

All arrays but `panels` are float32 and C-contiguous.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel

Array = NDArray[np.float32]
Index = NDArray[np.int64]
Number = np.float32
Shares = tuple[Number, Number, Number, Number]

ONE, NONE, LEAST = np.float32(1.0), np.float32(0.0), np.float32(1e-20)
ZEROTH = np.float32(math.sqrt(1 / (4 * math.pi)))
FIRST = np.float32(math.sqrt(3 / (4 * math.pi)))
SECOND = np.float32(math.sqrt(15 / (4 * math.pi)))
SECOND_MIDDLE, SECOND_LAST = np.float32(math.sqrt(5 / (16 * math.pi))), np.float32(math.sqrt(15 / (16 * math.pi)))
THIRD_OUTER = np.float32(math.sqrt(35 / (32 * math.pi)))
THIRD_XYZ = np.float32(math.sqrt(105 / (4 * math.pi)))
THIRD_INNER = np.float32(math.sqrt(21 / (32 * math.pi)))
THIRD_MIDDLE, THIRD_LAST = np.float32(math.sqrt(7 / (16 * math.pi))), np.float32(math.sqrt(105 / (16 * math.pi)))
TWO, THREE, FIVE = np.float32(2.0), np.float32(3.0), np.float32(5.0)


@kernel
def write_harmonics(x: Number, y: Number, z: Number, values: Array) -> None:
    """As many as there is room for, 1, 4, 9 or 16, in the order of `harmonics`."""
    values[0] = ZEROTH
    if len(values) > 1:
        values[1], values[2], values[3] = FIRST * y, FIRST * z, FIRST * x
    if len(values) > 4:
        xx, yy, zz = x * x, y * y, z * z
        values[4], values[5], values[7] = SECOND * x * y, SECOND * y * z, SECOND * x * z
        values[6], values[8] = SECOND_MIDDLE * (THREE * zz - ONE), SECOND_LAST * (xx - yy)
        if len(values) > 9:
            values[9], values[10] = THIRD_OUTER * y * (THREE * xx - yy), THIRD_XYZ * x * y * z
            values[11], values[13] = THIRD_INNER * y * (FIVE * zz - ONE), THIRD_INNER * x * (FIVE * zz - ONE)
            values[12] = THIRD_MIDDLE * z * (FIVE * zz - THREE)
            values[14], values[15] = THIRD_LAST * z * (xx - yy), THIRD_OUTER * x * (xx - THREE * yy)


@kernel
def place_of(points: Array, ray: int, corners: Array, panel: int, side: int) -> tuple[int, Shares]:
    """First of the four places around a point on a panel, and the weights of the four."""
    u, v = NONE, NONE
    for number in range(2):
        along, square = NONE, NONE
        for axis in range(3):
            edge = corners[panel, 1 + 2 * number, axis] - corners[panel, 0, axis]
            along += (points[ray, axis] - corners[panel, 0, axis]) * edge
            square += edge * edge
        share = min(max(along / max(square, LEAST) * np.float32(side - 1), NONE), np.float32(side - 1))
        if number == 0:
            u = share
        else:
            v = share
    # Numbers that are no numbers must not lead out of the table.
    column, row = max(min(int(u), side - 2), 0), max(min(int(v), side - 2), 0)
    a, b = u - np.float32(column), v - np.float32(row)
    first = (panel * side + row) * side + column
    return first, ((ONE - a) * (ONE - b), a * (ONE - b), (ONE - a) * b, a * b)


@kernel
def blend(
    points: Array, omega_r: Array, panels: Index, corners: Array, side: int, coefficients: Array, means: Array,
    light: Array,
) -> None:  # fmt: skip
    """Light of `HarmonicTexture`, shape (n, 3), written.

    Parameters
    ----------
    coefficients
        Shape (m side side, h, 3).
    means
        Logits, shape (m, 3).
    """
    values = np.empty(coefficients.shape[1], np.float32)
    for ray in range(len(panels)):
        first, w = place_of(points, ray, corners, panels[ray], side)
        write_harmonics(omega_r[ray, 0], omega_r[ray, 1], omega_r[ray, 2], values)
        red, green, blue = means[panels[ray]]
        for number in range(4):
            place = coefficients[first + number % 2 + (number // 2) * side]
            for k in range(len(values)):
                share = w[number] * values[k]
                red += share * place[k, 0]
                green += share * place[k, 1]
                blue += share * place[k, 2]
        light[ray, 0] = ONE / (ONE + np.float32(math.exp(-red)))
        light[ray, 1] = ONE / (ONE + np.float32(math.exp(-green)))
        light[ray, 2] = ONE / (ONE + np.float32(math.exp(-blue)))


@kernel
def blend_back(
    points: Array, omega_r: Array, panels: Index, corners: Array, side: int, light: Array, slopes: Array,
    by_coefficients: Array, by_means: Array,
) -> None:  # fmt: skip
    """Gradients of `light` that `blend` wrote, added to `by_coefficients` and `by_means`; `slopes` are those by it."""
    values = np.empty(by_coefficients.shape[1], np.float32)
    for ray in range(len(panels)):
        panel = panels[ray]
        first, w = place_of(points, ray, corners, panel, side)
        write_harmonics(omega_r[ray, 0], omega_r[ray, 1], omega_r[ray, 2], values)
        red, green, blue = light[ray]
        red *= slopes[ray, 0] * (ONE - red)
        green *= slopes[ray, 1] * (ONE - green)
        blue *= slopes[ray, 2] * (ONE - blue)
        by_means[panel, 0] += red
        by_means[panel, 1] += green
        by_means[panel, 2] += blue
        for number in range(4):
            place = by_coefficients[first + number % 2 + (number // 2) * side]
            for k in range(len(values)):
                share = w[number] * values[k]
                place[k, 0] += share * red
                place[k, 1] += share * green
                place[k, 2] += share * blue
