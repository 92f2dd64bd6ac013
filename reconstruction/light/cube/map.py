"""An environment map on a cube: light by direction alone, and how rough or matt surfaces mirror it."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from functools import lru_cache

import torch
from scipy import sparse
from torch import Tensor, nn
from torch.nn.functional import softplus

from reconstruction.light.cube.faces import FACES, padding
from reconstruction.light.cube.linear_map import LinearMap
from reconstruction.light.cube.lobes import GGX_WIDTH, cosine_lobe, ggx_lobe, lobe_filter, pyramid
from reconstruction.light.cube.lookup import Levels


@dataclass(frozen=True, slots=True)
class Level:
    """Light of one roughness.

    Parameters
    ----------
    roughness
        0 to 1; alpha of GGX is its square.
    side
        Texels along an edge at most: half of a lobe's height is one texel wide at roughness 0.15, and two to four
        above.
    square
        Of the filter (`lobe_filter`).
    """

    roughness: float
    side: int
    square: float


ROUGH_LEVELS = (
    Level(0.15, 32, 0.9), Level(0.3, 16, 0.7), Level(0.5, 16, 0.5), Level(0.75, 8, 0.35), Level(1.0, 8, 0.35)
)  # fmt: skip
"""After the finest one, which is a mirror's. Against sums over the sphere, light of a sky with windows and a sun is off
by 1 to 5 % of its spread at any roughness, also between these. Plain averages of texels, each at whichever level is
best, are off by 6 to 19 % from roughness 0.15 on: GGX has longer tails."""

WIDEST = 0.6
"""rad; of a lobe as squares of the filter go by it: at 90 degrees it ends, however rough the surface."""

MATT_SIDE = 8
"""Of the light on matt surfaces, which has no details."""


@dataclass(frozen=True, slots=True, eq=False)
class Filters:
    """What takes a cube's texels to levels of rough light and to the light on matt surfaces.

    Parameters
    ----------
    finest
        The texels with their borders.
    averages
        Of texels, from fine to coarse.
    rough, matt
        Of `averages`: levels with their borders.
    finest_level, rough_levels, matt_levels
        Where these lie.
    """

    finest: LinearMap
    averages: LinearMap
    rough: LinearMap
    matt: LinearMap
    finest_level: Levels
    rough_levels: Levels
    matt_levels: Levels


@lru_cache(maxsize=4)
def filters(side: int) -> Filters:
    """For cubes of one side, made once: in 0.7 s for 64, which then take 40 MB."""
    averages = pyramid(side)
    finest = sparse.eye_array(FACES * side * side, averages.shape[0], format="csr")
    sides, parts = [side], [padding(side) @ finest]
    for level in ROUGH_LEVELS:
        sides.append(min(side, level.side))
        width = min(GGX_WIDTH * level.roughness**2, WIDEST)
        parts.append(padding(sides[-1]) @ lobe_filter(side, sides[-1], ggx_lobe(level.roughness), width, level.square))
    matt_side = min(side, MATT_SIDE)
    matt = padding(matt_side) @ lobe_filter(side, matt_side, cosine_lobe, WIDEST, ROUGH_LEVELS[-1].square)
    rough = sparse.csr_array(sparse.vstack(parts, format="csr"))
    return Filters(
        LinearMap(padding(side)), LinearMap(averages), LinearMap(rough), LinearMap(sparse.csr_array(matt)),
        Levels((side,)), Levels(tuple(sides)), Levels((matt_side,)),
    )  # fmt: skip


class CubeMap(nn.Module):
    """Light from all directions on the faces of a cube.

    Texels are what light is the softplus of: never below 0, with no upper end, as suns are brighter than photos can
    show, and nowhere without a gradient. Rough light is filtered by GGX anew whenever texels change, linearly, so that
    gradients reach all texels that a lobe covers.

    Parameters
    ----------
    side
        Texels along an edge: a power of 2, at least `COARSEST`.
    expected
        Light above 0 that it starts from.
    """

    COARSEST = 8

    def __init__(self, side: int = 64, expected: float = 0.3) -> None:
        super().__init__()
        if side < self.COARSEST or side & (side - 1):
            raise ValueError(f"side: expected a power of 2 from {self.COARSEST} on, got {side}")
        if not (math.isfinite(expected) and expected > 0.0):
            raise ValueError(f"expected: expected light above 0, got {expected}")
        self.side = side
        self.texels = nn.Parameter(torch.full((FACES * side * side, 3), math.log(math.expm1(expected))))
        self._kept: tuple[tuple[object, ...], Tensor] | None = None

    def forward(self, directions: Tensor, roughness: Tensor | None = None) -> Tensor:
        """Linear light, 0 or more, that surfaces mirror, shape (n, 3).

        Parameters
        ----------
        directions
            Mirrored, shape (n, 3), unit.
        roughness
            Shape (n,), 0 to 1 (clamped), alpha of GGX its square; a mirror's light where there is none.
        """
        kept = filters(self.side)
        if roughness is None:
            light = kept.finest(softplus(self.texels))
            return kept.finest_level.look_up(directions, torch.zeros_like(directions[:, 0]), light)
        return kept.rough_levels.look_up(directions, level_of(roughness), self.rough_light())

    def on_matt(self, normals: Tensor) -> Tensor:
        """Light that a white matt surface gives back, irradiance over pi, shape (n, 3), by unit normals (n, 3)."""
        kept = filters(self.side)
        light = kept.matt(kept.averages(softplus(self.texels)))
        return kept.matt_levels.look_up(normals, torch.zeros_like(normals[:, 0]), light)

    def rough_light(self) -> Tensor:
        """All levels with their borders; in `no_grad` kept until the texels change, as pictures are drawn in strips."""
        if torch.is_grad_enabled():
            self._kept = None
            return self._filtered()
        made_of = (id(self.texels), self.texels._version, self.texels.device, self.texels.dtype)
        if self._kept is None or self._kept[0] != made_of:
            self._kept = (made_of, self._filtered())
        return self._kept[1]

    def _filtered(self) -> Tensor:
        kept = filters(self.side)
        return kept.rough(kept.averages(softplus(self.texels)))


def level_of(roughness: Tensor) -> Tensor:
    """Level of a roughness, 0 for a mirror: up to the first of `ROUGH_LEVELS` as alpha grows, from there on evenly."""
    first = ROUGH_LEVELS[0].roughness
    level = (roughness.clamp(0.0, first) / first) ** 2
    for below, above in itertools.pairwise(ROUGH_LEVELS):
        level = level + (roughness.clamp(below.roughness, above.roughness) - below.roughness) / (
            above.roughness - below.roughness
        )
    return level
