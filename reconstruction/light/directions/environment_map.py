"""An environment map: light by direction alone, as if all that glass mirrors were infinitely far away."""

from __future__ import annotations

import math

import torch
from torch import Tensor, nn

from reconstruction.light.directions.environment_map_kernels import LEVEL, looked_up


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
        return looked_up_twin(directions, levels)


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


def looked_up_twin(directions: Tensor, levels: list[Tensor]) -> Tensor:
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
