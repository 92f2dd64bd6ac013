"""Colour of splats by viewing direction: spherical harmonics of display values, turned into linear light.

Harmonics add up values as a display has them (sRGB) and not light: what a photo shows is compared as such, so a dark
wall and a bright one learn equally fast, and the coefficients are those that other programs' splats have.
"""

from __future__ import annotations

import math
from typing import Any, cast

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from planning.base.jit import chunks, inline, kernel, run_chunks
from reconstruction.light.harmonics import harmonics, n_harmonics
from reconstruction.light.shading import DARKEST

Floats = NDArray[np.float32]

N_HARMONICS = 16
"""Of degree 3, which is stored always."""

MIDDLE = 0.5
"""Display value of splats whose coefficients are all 0, as in 3-D Gaussian splatting (Kerbl et al., 2023)."""

FLAT = math.sqrt(1.0 / (4.0 * math.pi))
"""The harmonic of degree 0, the same in all directions."""

AT_ONCE = 16_384
"""Splats of one piece of work: about a millisecond."""

RIDGE = 1e-3
"""Weight of fitted harmonics' squares, against the mean square over the directions: holds those that these do not tell
apart."""

NEAREST_M = 1e-6
"""A camera this near to a splat's middle sees it from nowhere in particular."""


def display_colours(means: Tensor, sh: Tensor, position: Tensor, degree: int) -> Tensor:
    """Display values, shape (n, 3), of splats seen from a place; below 0 and above 1, too.

    On the processor in float32 by a compiled kernel (a quarter of torch's time), else by `display_colours_reference`.

    Parameters
    ----------
    means
        Shape (n, 3), metres; gradients reach them through the viewing direction.
    sh
        Coefficients, shape (n, 16, 3), in the order of `reconstruction.light.harmonics`.
    position
        Of the camera, shape (3,), metres, in the frame of the means; it gets no gradient.
    degree
        Up to which harmonics are added up, 0 to 3; the others' gradients are 0.
    """
    n_used = n_harmonics(degree)
    if means.device.type == "cpu" and means.dtype == sh.dtype == torch.float32:
        found = _Colours.apply(means, sh, position.detach().to(means), n_used, False)  # type: ignore[no-untyped-call]
        return cast(Tensor, found)
    return display_colours_reference(means, sh, position, degree)


def seen_light(means: Tensor, sh: Tensor, position: Tensor, degree: int) -> Tensor:
    """`light_of_display` of `display_colours`; on the processor in float32 by the same kernel, in half the time."""
    if means.device.type == "cpu" and means.dtype == sh.dtype == torch.float32:
        found = _Colours.apply(means, sh, position.detach().to(means), n_harmonics(degree), True)  # type: ignore[no-untyped-call]
        return cast(Tensor, found)
    return light_of_display(display_colours_reference(means, sh, position, degree))


def display_colours_reference(means: Tensor, sh: Tensor, position: Tensor, degree: int) -> Tensor:
    """What `display_colours` says, in plain torch, of any type on any device."""
    n_used = n_harmonics(degree)
    towards = means - position.detach().to(means)
    directions = towards / towards.norm(dim=-1, keepdim=True).clamp(min=NEAREST_M)
    return MIDDLE + (harmonics(directions)[:, :n_used, None] * sh[:, :n_used]).sum(dim=1)


def light_of_display(display: Tensor) -> Tensor:
    """Linear light, 0 or more, of display values: 0 below 0, and above 1 along the sRGB curve's last slope.

    The inverse of `reconstruction.light.shading.display_from_linear`.
    """
    within = display.clamp(0.0, 1.0)
    curved = ((within.clamp(min=12.92 * DARKEST) + 0.055) / 1.055) ** 2.4
    beyond = (display - 1.0).clamp(min=0.0) * (2.4 / 1.055)
    return torch.where(within <= 12.92 * DARKEST, within / 12.92, curved) + beyond


def flat_harmonics(display: Tensor) -> Tensor:
    """Coefficients, shape (n, 16, 3), of splats that show the same display values, shape (n, 3), to all sides."""
    sh = torch.zeros(len(display), N_HARMONICS, 3, dtype=display.dtype, device=display.device)
    sh[:, 0] = (display - MIDDLE) / FLAT
    return sh


def fitted_harmonics(directions: Tensor, display: Tensor, degree: int) -> Tensor:
    """Coefficients, shape (n, 16, 3), float32, whose colours come nearest to display values in some directions.

    Parameters
    ----------
    directions
        From the camera, unit, shape (k, 3).
    display
        Shape (n, k, 3).
    degree
        Of the harmonics that are fitted, 0 to 3; the others' coefficients are 0.
    """
    k = len(directions)
    basis = harmonics(directions)[:, : n_harmonics(degree)].double()
    penalty = RIDGE * torch.eye(basis.shape[1], dtype=torch.float64)
    # The mean is not held back, only what changes with direction.
    penalty[0, 0] = 0.0
    solution = torch.linalg.solve(basis.T @ basis / k + penalty, basis.T / k)
    found = torch.zeros(len(display), N_HARMONICS, 3)
    found[:, : basis.shape[1]] = torch.einsum("bk,nkc->nbc", solution, display.double() - MIDDLE).float()
    return found


class _Colours(torch.autograd.Function):
    """Display values, or light."""

    @staticmethod
    def forward(ctx: Any, means: Tensor, sh: Tensor, position: Tensor, n_used: int, is_light: bool) -> Tensor:
        ctx.save_for_backward(means, sh, position)
        ctx.n_used, ctx.is_light = n_used, is_light
        out = torch.empty(len(means), 3)
        places, table, eye = _array(means), _array(sh), _array(position)
        filled = out.numpy()

        def work(start: int, stop: int) -> None:
            _colours(places, table, eye, n_used, is_light, start, stop, filled)

        run_chunks(work, chunks(len(means), AT_ONCE))
        return out

    @staticmethod
    def backward(ctx: Any, *gradients: Any) -> tuple[Tensor, Tensor, None, None, None]:
        means, sh, position = ctx.saved_tensors
        # The kernel fills what is used; unused harmonics have no part in the colour.
        of_means, of_sh = torch.empty(means.shape), torch.zeros(sh.shape)
        places, table, eye, gradient = _array(means), _array(sh), _array(position), _array(gradients[0])
        filled, sh_filled = of_means.numpy(), of_sh.numpy()

        def work(start: int, stop: int) -> None:
            _gradients(places, table, eye, gradient, ctx.n_used, ctx.is_light, start, stop, filled, sh_filled)

        run_chunks(work, chunks(len(means), AT_ONCE))
        return of_means, of_sh, None, None, None


def _array(tensor: Tensor) -> Floats:
    return np.asarray(tensor.detach().contiguous().numpy())


@inline
def _direction(means: Any, position: Any, i: Any) -> Any:
    x, y, z = means[i, 0] - position[0], means[i, 1] - position[1], means[i, 2] - position[2]
    length = max(np.sqrt(x * x + y * y + z * z), np.float32(NEAREST_M))
    return x / length, y / length, z / length, length


C0, C1 = np.float32(FLAT), np.float32(math.sqrt(3 / (4 * math.pi)))
C2 = np.float32(math.sqrt(15 / (4 * math.pi)))
C20, C22 = np.float32(math.sqrt(5 / (16 * math.pi))), np.float32(math.sqrt(15 / (16 * math.pi)))
C33, C32 = np.float32(math.sqrt(35 / (32 * math.pi))), np.float32(math.sqrt(105 / (4 * math.pi)))
C31, C30 = np.float32(math.sqrt(21 / (32 * math.pi))), np.float32(math.sqrt(7 / (16 * math.pi)))
C34 = np.float32(math.sqrt(105 / (16 * math.pi)))
ONE, TWO, THREE, FIVE = np.float32(1), np.float32(2), np.float32(3), np.float32(5)


@inline
def _fill_basis(x: Any, y: Any, z: Any, n_used: Any, basis: Any) -> None:
    """The harmonics of `reconstruction.light.harmonics`, as far as they are used."""
    basis[0] = C0
    if n_used > 1:
        basis[1], basis[2], basis[3] = C1 * y, C1 * z, C1 * x
    if n_used > 4:
        xx, yy, zz = x * x, y * y, z * z
        basis[4], basis[5], basis[6] = C2 * x * y, C2 * y * z, C20 * (THREE * zz - ONE)
        basis[7], basis[8] = C2 * x * z, C22 * (xx - yy)
        if n_used > 9:
            basis[9], basis[10] = C33 * y * (THREE * xx - yy), C32 * x * y * z
            basis[11], basis[12] = C31 * y * (FIVE * zz - ONE), C30 * z * (FIVE * zz - THREE)
            basis[13], basis[14] = C31 * x * (FIVE * zz - ONE), C34 * z * (xx - yy)
            basis[15] = C33 * x * (xx - THREE * yy)


@inline
def _slopes(x: Any, y: Any, z: Any, n_used: Any, w: Any) -> Any:
    """Gradient of sum_k w_k Y_k with respect to x, y and z, each taken as free."""
    gx, gy, gz = C1 * w[3], C1 * w[1], C1 * w[2]
    if n_used > 4:
        gx += C2 * (y * w[4] + z * w[7]) + TWO * C22 * x * w[8]
        gy += C2 * (x * w[4] + z * w[5]) - TWO * C22 * y * w[8]
        gz += C2 * (y * w[5] + x * w[7]) + TWO * THREE * C20 * z * w[6]
    if n_used > 9:
        xx, yy, zz, xy = x * x, y * y, z * z, TWO * THREE * x * y
        five, ten = FIVE * zz - ONE, TWO * FIVE * z
        gx += C33 * (xy * w[9] + THREE * (xx - yy) * w[15]) + C32 * y * z * w[10]
        gx += C31 * five * w[13] + TWO * C34 * x * z * w[14]
        gy += C33 * (THREE * (xx - yy) * w[9] - xy * w[15]) + C32 * x * z * w[10]
        gy += C31 * five * w[11] - TWO * C34 * y * z * w[14]
        gz += C32 * x * y * w[10] + C31 * ten * (y * w[11] + x * w[13])
        gz += C30 * (THREE * FIVE * zz - THREE) * w[12] + C34 * (xx - yy) * w[14]
    return gx, gy, gz


@inline
def _summed(sh: Any, basis: Any, n_used: Any, i: Any) -> Any:
    """Display values of a splat."""
    red = green = blue = np.float32(MIDDLE)
    for k in range(n_used):
        red += basis[k] * sh[i, k, 0]
        green += basis[k] * sh[i, k, 1]
        blue += basis[k] * sh[i, k, 2]
    return red, green, blue


STRAIGHT, POWER, OFFSET = np.float32(12.92 * DARKEST), np.float32(2.4), np.float32(0.055)
OF_CURVE, OF_LINE, OF_BEYOND = np.float32(1.0 / 1.055), np.float32(1.0 / 12.92), np.float32(2.4 / 1.055)


@inline
def _light(value: Any) -> Any:
    """`light_of_display` of one value."""
    if value <= STRAIGHT:
        return max(value, np.float32(0.0)) * OF_LINE
    curved = ((min(value, ONE) + OFFSET) * OF_CURVE) ** POWER
    return curved + max(value - ONE, np.float32(0.0)) * OF_BEYOND


@inline
def _slope(value: Any) -> Any:
    """Of `light_of_display`."""
    if value <= STRAIGHT:
        return OF_LINE if value >= np.float32(0.0) else np.float32(0.0)
    return OF_BEYOND * ((min(value, ONE) + OFFSET) * OF_CURVE) ** (POWER - ONE)


@kernel
def _colours(means: Any, sh: Any, position: Any, n_used: int, is_light: bool, start: int, stop: int, out: Any) -> None:
    basis = np.zeros(N_HARMONICS, np.float32)
    for i in range(start, stop):
        x, y, z, _ = _direction(means, position, i)
        _fill_basis(x, y, z, n_used, basis)
        red, green, blue = _summed(sh, basis, n_used, i)
        if is_light:
            red, green, blue = _light(red), _light(green), _light(blue)
        out[i, 0], out[i, 1], out[i, 2] = red, green, blue


@kernel
def _gradients(
    means: Any,
    sh: Any,
    position: Any,
    gradient: Any,
    n_used: int,
    is_light: bool,
    start: int,
    stop: int,
    of_means: Any,
    of_sh: Any,
) -> None:
    basis, weights = np.zeros(N_HARMONICS, np.float32), np.zeros(N_HARMONICS, np.float32)
    for i in range(start, stop):
        x, y, z, length = _direction(means, position, i)
        _fill_basis(x, y, z, n_used, basis)
        red, green, blue = gradient[i, 0], gradient[i, 1], gradient[i, 2]
        if is_light:
            found = _summed(sh, basis, n_used, i)
            red, green, blue = red * _slope(found[0]), green * _slope(found[1]), blue * _slope(found[2])
        for k in range(n_used):
            of_sh[i, k, 0], of_sh[i, k, 1], of_sh[i, k, 2] = basis[k] * red, basis[k] * green, basis[k] * blue
            weights[k] = sh[i, k, 0] * red + sh[i, k, 1] * green + sh[i, k, 2] * blue
        if n_used == 1 or length <= np.float32(NEAREST_M):
            of_means[i, 0] = of_means[i, 1] = of_means[i, 2] = np.float32(0.0)
            continue
        gx, gy, gz = _slopes(x, y, z, n_used, weights)
        # A direction keeps its length: only what is across it counts.
        along = gx * x + gy * y + gz * z
        of_means[i, 0] = (gx - along * x) / length
        of_means[i, 1] = (gy - along * y) / length
        of_means[i, 2] = (gz - along * z) / length
