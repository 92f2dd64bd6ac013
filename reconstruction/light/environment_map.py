"""An environment map: light by direction alone, as if all that glass mirrors were infinitely far away."""

from __future__ import annotations

import math
from typing import Any, cast

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.autograd.function import once_differentiable

from planning.base.jit import chunks, inline, kernel, run_chunks, run_parallel

# Lookups in pictures of all directions and the way back, compiled, float32 in main memory.
#
# The formulas are those of `environment_map`; a direction's place is found once for all pictures. Rays are looked up
# on
# threads, and gradients taken back on one for each picture, one ray after the other: sums are the same bits always.

Floats = NDArray[np.float32]

LEVEL = 1e-12
"""Squared horizontal part of a direction below which it is up or down, and has no heading."""

RAYS_AT_ONCE = 4096
"""Of one call of a kernel: less than a millisecond, so that threads end together."""

ZERO, HALF, ONE = np.float32(0.0), np.float32(0.5), np.float32(1.0)
OVER_PI, LEAST = np.float32(1.0 / math.pi), np.float32(LEVEL)


@inline
def place_of(directions: Any, i: Any) -> Any:
    """Heading in turns clockwise from north, -0.5 to 0.5, and 0 at the zenith to 1 at the nadir."""
    east, north, up = directions[i, 0], directions[i, 1], directions[i, 2]
    square = east * east + north * north
    turns, level = ZERO, np.sqrt(LEAST)
    if square >= LEAST:
        turns, level = HALF * OVER_PI * np.arctan2(east, north), np.sqrt(square)
    return turns, HALF - OVER_PI * np.arctan2(up, level)


@kernel
def _find_places(directions: Floats, start: int, stop: int, places: Floats) -> None:
    for i in range(start, stop):
        places[i, 0], places[i, 1] = place_of(directions, i)


@inline
def _texels_around(places: Any, i: Any, height: Any) -> Any:
    """The upper left and right one of the four texels around, and shares of the right and the lower ones."""
    width = 2 * height
    x = places[i, 0] * np.float32(width) - HALF
    y = min(max(places[i, 1] * np.float32(height) - HALF, ZERO), np.float32(height - 1))
    left, top = np.floor(x), min(np.floor(y), np.float32(height - 2))
    column, row = int(left), int(top) * width
    column = column + width if column < 0 else column
    return row + column, row + (column + 1 if column + 1 < width else 0), x - left, y - top


@kernel
def _add_light(texels: Floats, height: int, places: Floats, start: int, stop: int, out: Floats) -> None:
    """Add what a picture shows, linear between the four texels around, shape (n, 3)."""
    width = 2 * height
    for i in range(start, stop):
        here, beside, a, b = _texels_around(places, i, height)
        for c in range(3):
            upper = texels[here, c] + a * (texels[beside, c] - texels[here, c])
            lower = texels[here + width, c] + a * (texels[beside + width, c] - texels[here + width, c])
            out[i, c] += upper + b * (lower - upper)


@kernel
def _give_back(gradient: Floats, height: int, places: Floats, of_texels: Floats) -> None:
    """Add the gradients of the light to those of a picture's texels."""
    width = 2 * height
    for i in range(len(places)):
        here, beside, a, b = _texels_around(places, i, height)
        for c in range(3):
            lower, upper = b * gradient[i, c], (ONE - b) * gradient[i, c]
            of_texels[here, c] += (ONE - a) * upper
            of_texels[beside, c] += a * upper
            of_texels[here + width, c] += (ONE - a) * lower
            of_texels[beside + width, c] += a * lower


@kernel
def _add_slopes(
    texels: Floats, gradient: Floats, height: int, places: Floats, start: int, stop: int, of_places: Floats
) -> None:
    """Add the gradients of the places, shape (n, 2); beyond the middles of the outermost rows they have none."""
    width = 2 * height
    for i in range(start, stop):
        here, beside, a, b = _texels_around(places, i, height)
        along, down = ZERO, ZERO
        for c in range(3):
            right = texels[beside, c] - texels[here, c]
            lower_right = texels[beside + width, c] - texels[here + width, c]
            below = texels[here + width, c] - texels[here, c]
            along += gradient[i, c] * (right + b * (lower_right - right))
            down += gradient[i, c] * (below + a * (lower_right - right))
        of_places[i, 0] += along * np.float32(width)
        if HALF <= places[i, 1] * np.float32(height) <= np.float32(height) - HALF:
            of_places[i, 1] += down * np.float32(height)


@kernel
def _turn_back(directions: Floats, of_places: Floats, start: int, stop: int, of_directions: Floats) -> None:
    """From the gradients of the places to those of the directions; see `environment_map.turns_and_rows`."""
    for i in range(start, stop):
        east, north, up = directions[i, 0], directions[i, 1], directions[i, 2]
        of_turns, of_rows = HALF * OVER_PI * of_places[i, 0], OVER_PI * of_places[i, 1]
        square = east * east + north * north
        is_level = square < LEAST
        level = np.sqrt(max(square, LEAST))
        of_rows /= up * up + level * level
        of_directions[i, 2] = -level * of_rows
        if is_level:
            of_directions[i, 0] = of_directions[i, 1] = ZERO
            continue
        of_directions[i, 0] = of_turns * north / square + of_rows * up * east / level
        of_directions[i, 1] = -of_turns * east / square + of_rows * up * north / level


def looked_up(directions: Tensor, levels: list[Tensor]) -> Tensor:
    """What pictures, shapes (height * 2 height, 3), show in unit directions, shape (n, 3), added up, shape (n, 3)."""
    return cast(Tensor, _LookedUp.apply(directions, *levels))  # type: ignore[no-untyped-call]


class _LookedUp(torch.autograd.Function):
    """Directions and pictures to light."""

    @staticmethod
    def forward(ctx: Any, directions: Tensor, *levels: Tensor) -> Tensor:
        ctx.save_for_backward(directions, *levels)
        rays, pictures = _array(directions), [(_array(level), _height(level)) for level in levels]
        places, out = np.empty((len(rays), 2), np.float32), np.zeros((len(rays), 3), np.float32)

        def look_up(start: int, stop: int) -> None:
            _find_places(rays, start, stop, places)
            for texels, height in pictures:
                _add_light(texels, height, places, start, stop, out)

        run_chunks(look_up, chunks(len(rays), RAYS_AT_ONCE))
        ctx.places = places
        return torch.from_numpy(out)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *gradients: Any) -> Any:
        directions, *levels = ctx.saved_tensors
        rays, gradient, places = _array(directions), _array(gradients[0]), ctx.places
        of_levels = [np.zeros(level.shape, np.float32) for level in levels]
        heights = [_height(level) for level in levels]
        if any(ctx.needs_input_grad[1:]):
            run_parallel(_give_back, [(gradient, h, places, of) for h, of in zip(heights, of_levels, strict=True)])
        of_directions = np.zeros(rays.shape, np.float32)
        if ctx.needs_input_grad[0]:
            of_places, pictures = np.zeros(places.shape, np.float32), [_array(level) for level in levels]

            def turn_back(start: int, stop: int) -> None:
                for texels, height in zip(pictures, heights, strict=True):
                    _add_slopes(texels, gradient, height, places, start, stop, of_places)
                _turn_back(rays, of_places, start, stop, of_directions)

            run_chunks(turn_back, chunks(len(rays), RAYS_AT_ONCE))
        return (torch.from_numpy(of_directions), *(torch.from_numpy(of) for of in of_levels))


def _height(texels: Tensor) -> int:
    return math.isqrt(len(texels) // 2)


def _array(tensor: Tensor) -> Floats:
    return np.asarray(tensor.detach().contiguous().numpy())


class EnvironmentMap(nn.Module):
    """Pictures of all directions, each twice as fine as the one before, added up.

    Coarse ones fill in what no ray has seen. Rows run from the zenith to the nadir, columns clockwise from north;
    lookups are linear between pixels, go round without a seam, and end at the poles.

    Parameters
    ----------
    rows
        Of the finest picture, which has twice as many columns: a power of 2, at least `COARSEST`.
    expected
        Light, 0 to 1, that it starts from.
    """

    COARSEST = 4

    def __init__(self, rows: int, expected: float) -> None:
        super().__init__()
        if rows < self.COARSEST or rows & (rows - 1):
            raise ValueError(f"rows: expected a power of 2 from {self.COARSEST} on, got {rows}")
        levels = [self.COARSEST << k for k in range((rows // self.COARSEST).bit_length())]
        self.levels = nn.ParameterList([nn.Parameter(torch.zeros(level * 2 * level, 3)) for level in levels])
        self.mean = nn.Parameter(torch.full((3,), math.log(expected / (1.0 - expected))))

    def forward(self, points: Tensor, omega_r: Tensor, panels: Tensor | None = None) -> Tensor:
        """Light, shape (n, 3), 0 to 1, from unit directions `omega_r`, shape (n, 3); the others are not asked for."""
        return torch.sigmoid(self.mean + self._looked_up(omega_r))

    def _looked_up(self, directions: Tensor) -> Tensor:
        levels = list(self.levels)
        if directions.device.type == "cpu" and directions.dtype == levels[0].dtype == torch.float32:
            return looked_up(directions, levels)
        return looked_up_reference(directions, levels)


def turns_and_rows(directions: Tensor) -> tuple[Tensor, Tensor]:
    """Heading in turns clockwise from north, -0.5 to 0.5, and 0 at the zenith to 1 at the nadir, each shape (n,).

    Straight up and down the heading is 0; gradients are finite everywhere.
    """
    east, north, up = directions.unbind(dim=-1)
    square = east * east + north * north
    is_level = square < LEVEL
    # Where there is no heading, one is put in before the arc tangent and the root, whose slopes have no end there.
    north = torch.where(is_level, torch.ones_like(north), north)
    east = torch.where(is_level, torch.zeros_like(east), east)
    level = torch.sqrt(torch.where(is_level, torch.full_like(square, LEVEL), square))
    return torch.atan2(east, north) / (2.0 * math.pi), 0.5 - torch.atan2(up, level) / math.pi


def looked_up_reference(directions: Tensor, levels: list[Tensor]) -> Tensor:
    """What pictures show in unit directions, added up, in plain torch, of any precision on any device, shape (n, 3)."""
    turns, rows = turns_and_rows(directions)
    return torch.stack([_looked_up(texels, turns, rows) for texels in levels]).sum(dim=0)


def _looked_up(texels: Tensor, turns: Tensor, rows: Tensor) -> Tensor:
    """Linear between the four pixels around, shape (n, 3); texels are shape (height * 2 height, 3)."""
    height = math.isqrt(len(texels) // 2)
    width = 2 * height
    x, y = turns * width - 0.5, (rows * height - 0.5).clamp(0.0, height - 1.0)
    left, top = torch.floor(x), torch.floor(y).clamp(max=height - 2.0)
    a, b = (x - left)[:, None], (y - top)[:, None]
    c0 = left.long() % width
    c1, r0 = (c0 + 1) % width, top.long() * width
    upper = torch.lerp(texels[r0 + c0], texels[r0 + c1], a)
    lower = torch.lerp(texels[r0 + width + c0], texels[r0 + width + c1], a)
    return torch.lerp(upper, lower, b)
