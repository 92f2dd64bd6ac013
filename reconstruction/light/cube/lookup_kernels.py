"""Lookups in cubes of texels and the way back, compiled, float32 in main memory.

Cubes are padded (`cube_faces.padding`), so that a lookup's four texels lie in one face, and come finest first, one
below the other. The formulas are those of `cube_lookup.looked_up_twin`. Gradients of texels are added up ray by ray in
up to four parts, whose number depends on sizes alone: the same bits for any number of threads.
"""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.autograd.function import once_differentiable

from planning.base.jit import chunks, inline, kernel, run_chunks, run_parallel

Floats = NDArray[np.float32]
Integers = NDArray[np.int64]

SHORTEST, LONGEST = 1e-20, 1e20
"""Ends of the largest part of a direction; beyond, and where it is no number, it is none: the middle of a face."""

RAYS_AT_ONCE = 4096
"""Of one call of a kernel: less than a millisecond, so that threads end together."""

MOST_PARTS, RAYS_PER_TEXEL = 4, 0.25
"""Parts of the rays whose gradients are kept apart; fewer where clearing texels would take longer than the rays."""

ZERO, HALF, ONE = np.float32(0.0), np.float32(0.5), np.float32(1.0)
LEAST, MOST = np.float32(SHORTEST), np.float32(LONGEST)


@inline
def _place(directions: Any, i: Any) -> Any:
    """Face, u and v, and one over the major part; 0 for the last where there is no direction."""
    x, y, z = directions[i, 0], directions[i, 1], directions[i, 2]
    ax, ay, az = abs(x), abs(y), abs(z)
    axis, major, across, up = 2, z, x, y
    if ax >= ay and ax >= az:
        axis, major, across, up = 0, x, y, z
    elif ay >= az:
        axis, major, across, up = 1, y, z, x
    face = 2 * axis + (1 if major < ZERO else 0)
    u, v, scale = ZERO, ZERO, ZERO
    # What is no number fails every comparison: it must not become the number of a texel.
    if LEAST < abs(major) <= MOST and abs(across) <= MOST and abs(up) <= MOST:
        scale = ONE / abs(major)
        u, v = across * scale, up * scale
    return face, u, v, scale


@inline
def _level(levels: Any, i: Any, n_levels: Any) -> Any:
    """The finer one of two levels, and the share of the coarser one."""
    level = min(levels[i], np.float32(n_levels - 1)) if levels[i] > ZERO else ZERO
    fine = min(max(int(level), 0), max(n_levels - 2, 0))
    return fine, level - np.float32(fine)


@inline
def _corner(face: Any, u: Any, v: Any, side: Any, offset: Any) -> Any:
    """The first of four texels, and shares of the next column and row."""
    x, y = HALF * (u + ONE) * np.float32(side) + HALF, HALF * (v + ONE) * np.float32(side) + HALF
    column, row = min(max(int(x), 0), side), min(max(int(y), 0), side)
    wide = side + 2
    return offset + (face * wide + row) * wide + column, x - np.float32(column), y - np.float32(row)


@kernel
def _look_up(
    directions: Floats, levels: Floats, texels: Floats, sides: Integers, offsets: Integers, start: int, stop: int,
    out: Floats,
) -> None:  # fmt: skip
    n_levels, n_channels = len(sides), texels.shape[1]
    for i in range(start, stop):
        face, u, v, _ = _place(directions, i)
        fine, coarser = _level(levels, i, n_levels)
        for c in range(n_channels):
            out[i, c] = ZERO
        for k in range(min(2, n_levels)):
            weight = coarser if k == 1 else ONE - coarser
            if weight == ZERO:
                continue
            side = sides[fine + k]
            here, a, b = _corner(face, u, v, side, offsets[fine + k])
            below = here + side + 2
            w00, w01 = weight * (ONE - a) * (ONE - b), weight * a * (ONE - b)
            w10, w11 = weight * (ONE - a) * b, weight * a * b
            for c in range(n_channels):
                out[i, c] += (w00 * texels[here, c] + w01 * texels[here + 1, c]) + (
                    w10 * texels[below, c] + w11 * texels[below + 1, c]
                )


@kernel
def _give_back(
    directions: Floats, levels: Floats, gradient: Floats, sides: Integers, offsets: Integers, start: int, stop: int,
    of_texels: Floats,
) -> None:  # fmt: skip
    """Add the gradients of what was looked up to those of the texels."""
    n_levels, n_channels = len(sides), gradient.shape[1]
    for i in range(start, stop):
        face, u, v, _ = _place(directions, i)
        fine, coarser = _level(levels, i, n_levels)
        for k in range(min(2, n_levels)):
            weight = coarser if k == 1 else ONE - coarser
            if weight == ZERO:
                continue
            side = sides[fine + k]
            here, a, b = _corner(face, u, v, side, offsets[fine + k])
            below = here + side + 2
            w00, w01 = weight * (ONE - a) * (ONE - b), weight * a * (ONE - b)
            w10, w11 = weight * (ONE - a) * b, weight * a * b
            for c in range(n_channels):
                given = gradient[i, c]
                of_texels[here, c] += w00 * given
                of_texels[here + 1, c] += w01 * given
                of_texels[below, c] += w10 * given
                of_texels[below + 1, c] += w11 * given


@kernel
def _turn_back(
    directions: Floats, levels: Floats, texels: Floats, gradient: Floats, sides: Integers, offsets: Integers,
    start: int, stop: int, of_directions: Floats, of_levels: Floats,
) -> None:  # fmt: skip
    """Gradients of directions and levels; beyond the ends of the levels there is none."""
    n_levels, n_channels = len(sides), texels.shape[1]
    for i in range(start, stop):
        face, u, v, scale = _place(directions, i)
        fine, coarser = _level(levels, i, n_levels)
        of_u, of_v, of_level = ZERO, ZERO, ZERO
        for k in range(min(2, n_levels)):
            weight = coarser if k == 1 else ONE - coarser
            side = sides[fine + k]
            here, a, b = _corner(face, u, v, side, offsets[fine + k])
            below = here + side + 2
            along, down, value = ZERO, ZERO, ZERO
            for c in range(n_channels):
                t00, t01, t10, t11 = texels[here, c], texels[here + 1, c], texels[below, c], texels[below + 1, c]
                right, lower_right = t01 - t00, t11 - t10
                along += gradient[i, c] * (right + b * (lower_right - right))
                down += gradient[i, c] * ((t10 - t00) + a * (lower_right - right))
                upper, lower = t00 + a * right, t10 + a * lower_right
                value += gradient[i, c] * (upper + b * (lower - upper))
            of_u += weight * along * (HALF * np.float32(side))
            of_v += weight * down * (HALF * np.float32(side))
            of_level += value if k == 1 else -value
        axis = face // 2
        sign = -scale if face % 2 == 1 else scale
        of_directions[i, axis] = -sign * (u * of_u + v * of_v)
        of_directions[i, (axis + 1) % 3] = scale * of_u
        of_directions[i, (axis + 2) % 3] = scale * of_v
        is_within = n_levels > 1 and ZERO <= levels[i] <= np.float32(n_levels - 1)
        of_levels[i] = of_level if is_within else ZERO


def looked_up(directions: Tensor, levels: Tensor, texels: Tensor, sides: Integers, offsets: Integers) -> Tensor:
    """See `cube_lookup.looked_up_twin`; all tensors float32 in main memory."""
    return cast(Tensor, _LookedUp.apply(directions, levels, texels, sides, offsets))  # type: ignore[no-untyped-call]


class _LookedUp(torch.autograd.Function):
    """Directions, levels and texels to what they show."""

    @staticmethod
    def forward(
        ctx: Any, directions: Tensor, levels: Tensor, texels: Tensor, sides: Integers, offsets: Integers
    ) -> Tensor:
        ctx.save_for_backward(directions, levels, texels)
        ctx.sides, ctx.offsets = sides, offsets
        rays, of_rays, table = _array(directions), _array(levels), _array(texels)
        out = np.empty((len(rays), table.shape[1]), np.float32)
        run_chunks(
            lambda a, b: _look_up(rays, of_rays, table, sides, offsets, a, b, out), chunks(len(rays), RAYS_AT_ONCE)
        )
        return torch.from_numpy(out)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *gradients: Any) -> Any:
        directions, levels, texels = ctx.saved_tensors
        sides, offsets = ctx.sides, ctx.offsets
        rays, of_rays, table, given = _array(directions), _array(levels), _array(texels), _array(gradients[0])
        of_texels = of_directions = of_levels = None
        if ctx.needs_input_grad[2]:
            n_parts = int(min(max(len(rays) * RAYS_PER_TEXEL / len(table) * MOST_PARTS, 1), MOST_PARTS))
            ranges = chunks(len(rays), max(1, -(-len(rays) // n_parts)))
            parts = [np.zeros(table.shape, np.float32) for _ in ranges] or [np.zeros(table.shape, np.float32)]
            run_parallel(
                lambda a, b, part: _give_back(rays, of_rays, given, sides, offsets, a, b, part),
                [(a, b, part) for (a, b), part in zip(ranges, parts, strict=False)],
            )
            for part in parts[1:]:
                parts[0] += part
            of_texels = torch.from_numpy(parts[0])
        if ctx.needs_input_grad[0] or ctx.needs_input_grad[1]:
            turned, moved = np.empty(rays.shape, np.float32), np.empty(len(rays), np.float32)
            run_chunks(
                lambda a, b: _turn_back(rays, of_rays, table, given, sides, offsets, a, b, turned, moved),
                chunks(len(rays), RAYS_AT_ONCE),
            )
            of_directions, of_levels = torch.from_numpy(turned), torch.from_numpy(moved)
        return of_directions, of_levels, of_texels, None, None


def _array(tensor: Tensor) -> Floats:
    return np.asarray(tensor.detach().contiguous().numpy())
