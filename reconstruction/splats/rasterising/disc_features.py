"""What discs add to a picture besides their colour, seen from a place, with gradients, in one go on a processor.

In plain torch (`Splats.features_twin`) each of a dozen steps goes through all splats again, which takes twice as long
and longer (`python -m tests.benchmarks --only modelling-parts`).
"""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from planning.base.jit import chunks, inline, kernel, run_chunks

Floats = NDArray[np.float32]
Panels = NDArray[np.int32]

N_COLUMNS = 11

AT_ONCE = 16_384
"""Splats of one piece of work."""

LEAST_SQUARE = 1e-12
"""Squared length of a quaternion below which it is no rotation; then nothing is turned, and it has no gradient."""


def disc_features(
    colours: Tensor,
    means: Tensor,
    quats: Tensor,
    reflectivity_logits: Tensor,
    f0_logits: Tensor,
    panels: Tensor,
    position: Tensor,
) -> Tensor:
    """`Splats.features` of discs, shape (n, 11), float32, on a processor; gradients flow through the first five.

    Parameters
    ----------
    colours, means, f0_logits
        Shape (n, 3).
    quats
        w, x, y, z of any length, shape (n, 4).
    reflectivity_logits, panels
        Shape (n,); panels below 0 mirror nothing.
    position
        Of the camera, shape (3,); it gets no gradient.
    """
    found = _Features.apply(colours, means, quats, reflectivity_logits, f0_logits, panels, position.detach())  # type: ignore[no-untyped-call]
    return cast(Tensor, found)


class _Features(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, *inputs: Tensor) -> Tensor:
        ctx.save_for_backward(*inputs[1:])
        arrays = _arrays(inputs)
        out = np.empty((len(arrays[0]), N_COLUMNS), np.float32)
        fill: Any = _fill
        run_chunks(lambda start, stop: fill(*arrays, start, stop, out), chunks(len(out), AT_ONCE))
        return torch.from_numpy(out)

    @staticmethod
    def backward(ctx: Any, *gradients: Any) -> tuple[Tensor | None, ...]:
        means, quats, reflectivity, f0, panels, eye = _arrays(ctx.saved_tensors)
        given = np.ascontiguousarray(gradients[0].numpy())
        found = [np.empty_like(part) for part in (means, quats, reflectivity, f0)]

        def work(start: int, stop: int) -> None:
            _fill_back(means, quats, reflectivity, f0, panels, eye, given, start, stop, *found)

        run_chunks(work, chunks(len(given), AT_ONCE))
        return gradients[0][:, :3], *map(torch.from_numpy, found), None, None


def _arrays(inputs: tuple[Tensor, ...]) -> Any:
    *values, panels, position = inputs
    floats = [np.ascontiguousarray(value.detach().numpy()) for value in values]
    return *floats, np.ascontiguousarray(panels.to(torch.int32).numpy()), position.double().numpy()


@inline
def _share(logit: Any) -> Any:
    return np.float32(1.0) / (np.float32(1.0) + np.exp(-logit))


@inline
def _normal(w: Any, x: Any, y: Any, z: Any) -> Any:
    """Third column of a quaternion's rotation, and 1 / its squared length; (0, 0, 1) and 0 where it says nothing."""
    square = w * w + x * x + y * y + z * z
    if not square > LEAST_SQUARE:
        return 0.0, 0.0, 1.0, 0.0
    over = 1.0 / square
    return 2.0 * over * (x * z + w * y), 2.0 * over * (y * z - w * x), over * (w * w - x * x - y * y + z * z), over


@inline
def _facing(means: Any, quats: Any, eye: Any, i: Any) -> Any:
    """From the camera to the middle, the normal turned to it, by which sign, and quaternion with 1 / squared length."""
    px, py, pz = means[i, 0] - eye[0], means[i, 1] - eye[1], means[i, 2] - eye[2]
    w, x, y, z = np.float64(quats[i, 0]), np.float64(quats[i, 1]), np.float64(quats[i, 2]), np.float64(quats[i, 3])
    nx, ny, nz, over = _normal(w, x, y, z)
    sign = -1.0 if nx * px + ny * py + nz * pz > 0.0 else 1.0
    return (px, py, pz), (sign * nx, sign * ny, sign * nz), sign, (w, x, y, z, over)


@kernel
def _fill(
    colours: Floats,
    means: Floats,
    quats: Floats,
    reflectivity: Floats,
    f0: Floats,
    panels: Panels,
    eye: NDArray[np.float64],
    start: int,
    stop: int,
    out: Floats,
) -> None:
    for i in range(start, stop):
        (px, py, pz), (nx, ny, nz), _, _ = _facing(means, quats, eye, i)
        out[i, 0], out[i, 1], out[i, 2] = colours[i, 0], colours[i, 1], colours[i, 2]
        out[i, 3] = _share(reflectivity[i]) if panels[i] >= 0 else np.float32(0.0)
        out[i, 4], out[i, 5], out[i, 6] = _share(f0[i, 0]), _share(f0[i, 1]), _share(f0[i, 2])
        out[i, 7], out[i, 8], out[i, 9] = nx, ny, nz
        out[i, 10] = nx * px + ny * py + nz * pz


@kernel
def _fill_back(
    means: Floats,
    quats: Floats,
    reflectivity: Floats,
    f0: Floats,
    panels: Panels,
    eye: NDArray[np.float64],
    given: Floats,
    start: int,
    stop: int,
    of_means: Floats,
    of_quats: Floats,
    of_reflectivity: Floats,
    of_f0: Floats,
) -> None:
    for i in range(start, stop):
        (px, py, pz), (nx, ny, nz), sign, (w, x, y, z, over) = _facing(means, quats, eye, i)
        of_reflectivity[i] = np.float32(0.0)
        if panels[i] >= 0:
            share = _share(reflectivity[i])
            of_reflectivity[i] = given[i, 3] * share * (np.float32(1.0) - share)
        for k in range(3):
            share = _share(f0[i, k])
            of_f0[i, k] = given[i, 4 + k] * share * (np.float32(1.0) - share)
        by_offset = np.float64(given[i, 10])
        of_means[i, 0], of_means[i, 1], of_means[i, 2] = by_offset * nx, by_offset * ny, by_offset * nz
        if over == 0.0:
            of_quats[i, 0] = of_quats[i, 1] = of_quats[i, 2] = of_quats[i, 3] = np.float32(0.0)
            continue
        gx, gy, gz = given[i, 7] + by_offset * px, given[i, 8] + by_offset * py, given[i, 9] + by_offset * pz
        # The normal is sign * t / square, t and the square being quadratic in the quaternion.
        along, twice = gx * nx + gy * ny + gz * nz, 2.0 * over
        gx, gy, gz = sign * gx, sign * gy, sign * gz
        of_quats[i, 0] = twice * (gx * y - gy * x + gz * w - along * w)
        of_quats[i, 1] = twice * (gx * z - gy * w - gz * x - along * x)
        of_quats[i, 2] = twice * (gx * w + gy * z - gz * y - along * y)
        of_quats[i, 3] = twice * (gx * x + gy * y + gz * z - along * z)
