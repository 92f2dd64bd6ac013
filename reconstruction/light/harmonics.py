"""Spherical harmonics of degree 3 at places on each panel: light that changes slowly with direction, at every place."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from planning.base.jit import kernel

# Harmonics at places on panels, blended, forward and backward, compiled; `HarmonicTexture` has them in plain torch.
#
# All arrays but `panels` are float32 and C-contiguous.

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


MAX_DEGREE = 3


def n_harmonics(degree: int) -> int:
    """Up to a degree, 0 to `MAX_DEGREE`."""
    if not 0 <= degree <= MAX_DEGREE:
        raise ValueError(f"degree: expected 0 to {MAX_DEGREE}, got {degree}")
    return (degree + 1) ** 2


def harmonics(directions: Tensor) -> Tensor:
    """Real spherical harmonics up to degree 3, orthonormal over the sphere, shape (n, 16), of unit directions (n, 3).

    In the order (0, 0), (1, -1), (1, 0), (1, 1), (2, -2) and so on, without the phase (-1)^m (P.-P. Sloan, Stupid
    spherical harmonics tricks, 2008, appendix A2).
    """
    x, y, z = directions.unbind(dim=-1)
    xx, yy, zz = x * x, y * y, z * z
    one, pi = torch.ones_like(x), math.pi
    return torch.stack(
        [
            math.sqrt(1 / (4 * pi)) * one,
            math.sqrt(3 / (4 * pi)) * y,
            math.sqrt(3 / (4 * pi)) * z,
            math.sqrt(3 / (4 * pi)) * x,
            math.sqrt(15 / (4 * pi)) * x * y,
            math.sqrt(15 / (4 * pi)) * y * z,
            math.sqrt(5 / (16 * pi)) * (3 * zz - 1),
            math.sqrt(15 / (4 * pi)) * x * z,
            math.sqrt(15 / (16 * pi)) * (xx - yy),
            math.sqrt(35 / (32 * pi)) * y * (3 * xx - yy),
            math.sqrt(105 / (4 * pi)) * x * y * z,
            math.sqrt(21 / (32 * pi)) * y * (5 * zz - 1),
            math.sqrt(7 / (16 * pi)) * z * (5 * zz - 3),
            math.sqrt(21 / (32 * pi)) * x * (5 * zz - 1),
            math.sqrt(105 / (16 * pi)) * z * (xx - yy),
            math.sqrt(35 / (32 * pi)) * x * (xx - 3 * yy),
        ],
        dim=-1,
    )


class HarmonicTexture(nn.Module):
    """A grid of places on every panel, harmonics at each, linear in between.

    Parameters
    ----------
    corners
        Of all panels, rescaled as the points are, shape (m, 4, 3), counter-clockwise from the lower left one.
    side
        Places along each side of a panel, at least 2: the first and last lie on its edges.
    means
        Light of each panel that it starts from, shape (m, 3), above 0 and below 1.
    degree
        Of the harmonics; with 0, light is the same in all directions.
    """

    corners: Tensor

    def __init__(self, corners: Tensor, side: int, means: Tensor, degree: int = MAX_DEGREE) -> None:
        super().__init__()
        if side < 2:
            raise ValueError(f"side: expected at least 2 places, got {side}")
        self.side = side
        self.n_harmonics = n_harmonics(degree)
        self.register_buffer("corners", corners.float().clone())
        self.coefficients = nn.Parameter(torch.zeros(len(corners) * side * side, self.n_harmonics * 3))
        self.means = nn.Parameter(torch.logit(means.float()))

    def forward(self, points: Tensor, omega_r: Tensor, panels: Tensor) -> Tensor:
        """Light, shape (n, 3), 0 to 1.

        Parameters
        ----------
        points
            Places on the glass, rescaled to [-1, 1], shape (n, 3).
        omega_r
            Unit directions that mirrored rays go, shape (n, 3).
        panels
            Which panels the places are on, from 0, shape (n,).
        """
        is_compiled = points.device.type == "cpu" and self.coefficients.dtype == torch.float32
        if is_compiled and not (points.requires_grad or omega_r.requires_grad):
            found: Tensor = _Blend.apply(self.coefficients, self.means, points, omega_r, panels, self)  # type: ignore[no-untyped-call]
            return found
        # Values move with places, not with directions: harmonics are blended before they meet the direction.
        blended = self._at(points, panels).reshape(-1, self.n_harmonics, 3)
        values = harmonics(omega_r)[:, : self.n_harmonics, None]
        # No matrix product, which autocast would shorten to half precision.
        return torch.sigmoid(self.means[panels] + (values * blended).sum(dim=1))

    def _at(self, points: Tensor, panels: Tensor) -> Tensor:
        origin = self.corners[panels, 0]
        last = self.side - 1
        u, v = (
            (_share(points - origin, self.corners[panels, corner] - origin) * last).clamp(0.0, float(last))
            for corner in (1, 3)
        )
        column, row = (torch.floor(value).clamp(max=last - 1.0) for value in (u, v))
        a, b = (u - column)[:, None], (v - row)[:, None]
        first = (panels * self.side + row.long()) * self.side + column.long()
        table = self.coefficients
        lower = torch.lerp(table[first], table[first + 1], a)
        upper = torch.lerp(table[first + self.side], table[first + self.side + 1], a)
        return torch.lerp(lower, upper, b)


class _Blend(torch.autograd.Function):
    @staticmethod
    def forward(
        ctx: Any, coefficients: Tensor, means: Tensor, points: Tensor, omega_r: Tensor, panels: Tensor,
        texture: HarmonicTexture,
    ) -> Tensor:  # fmt: skip
        values = (points.float(), omega_r.float(), panels.long(), texture.corners)
        fixed: Any = (*(np.ascontiguousarray(value.detach().numpy()) for value in values), texture.side)
        light = np.empty((len(points), 3), np.float32)
        table = coefficients.detach().numpy().reshape(len(coefficients), -1, 3)
        run: Any = blend
        run(*fixed, table, means.detach().numpy(), light)
        ctx.fixed, ctx.light, ctx.shapes = fixed, light, (table.shape, means.shape)
        return torch.from_numpy(light)

    @staticmethod
    def backward(ctx: Any, slopes: Tensor) -> tuple[Tensor | None, ...]:
        fixed: Any = ctx.fixed
        by_table, by_means = (np.zeros(shape, np.float32) for shape in ctx.shapes)
        run: Any = blend_back
        run(*fixed, ctx.light, np.ascontiguousarray(slopes.numpy()), by_table, by_means)
        by_coefficients = torch.from_numpy(by_table.reshape(len(by_table), -1))
        return by_coefficients, torch.from_numpy(by_means), None, None, None, None


def _share(offsets: Tensor, edges: Tensor) -> Tensor:
    """How far along an edge, 0 to 1, shape (n,)."""
    return (offsets * edges).sum(dim=-1) / (edges * edges).sum(dim=-1).clamp(min=1e-20)
