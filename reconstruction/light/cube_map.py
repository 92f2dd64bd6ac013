"""An environment map on a cube: light by direction alone, and how rough or matt surfaces mirror it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import torch
from numpy.typing import NDArray
from scipy import sparse
from torch import Tensor, nn
from torch.nn.functional import softplus

from reconstruction.light.cube_lookup import (
    FACES,
    Levels,
    LinearMap,
    averages,
    directions_on,
    padding,
    sides_from,
    texel_directions,
)

# Filters of a cube by the lobes that surfaces mirror light with: GGX for rough ones, the cosine for matt ones.
#
# A lobe of roughness r around a direction n takes light from l with the weight D(n . h) (n . l), h between n and l,
# as
# it is for n = v (B. Karis, Real shading in Unreal Engine 4, 2013), D of GGX with alpha = r^2. GGX has long tails: of
# r = 0.2 a hundredth lies beyond 44 degrees. So each lobe is put together from averages of the cube over squares that
# grow with the distance from its middle, as far fields are in N-body sums: hundreds of weights in place of thousands.

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Lobe = Callable[[Array], Array]
"""Weight by the squared chord |n - l|^2, 0 to 4, of two unit directions."""

SAMPLES = 4
"""Along the side of a square, at which its weight is measured."""

ROWS_AT_ONCE = 128
"""Lobes that are put together at once: some ten megabytes."""

GGX_WIDTH = 1.29
"""Angle from the middle of a GGX lobe to half of its height, in alphas."""


def ggx_lobe(roughness: float) -> Lobe:
    """D (n . l) of roughness above 0, up to a factor."""
    square = roughness**4

    def lobe(chord: Array) -> Array:
        # 1 - (n . h)^2 is a quarter of the squared chord: nothing cancels, however narrow the lobe.
        spread = square * (1.0 - 0.25 * chord) + 0.25 * chord
        return np.asarray(square * np.maximum(1.0 - 0.5 * chord, 0.0) / spread**2)

    return lobe


def cosine_lobe(chord: Array) -> Array:
    """Cosine n . l above the horizon, 0 below."""
    return np.maximum(1.0 - 0.5 * chord, 0.0)


@lru_cache(maxsize=8)
def pyramid(side: int) -> sparse.csr_array:
    """A cube and its averages of half, a quarter ... of the side, down to 1, one below the other."""
    return sparse.csr_array(sparse.vstack([averages(side, coarse) for coarse in sides_from(side)], format="csr"))


def lobe_filter(side: int, coarse: int, lobe: Lobe, width: float, square: float) -> sparse.csr_array:
    """What lobes around the texels of a coarser cube take of a `pyramid`; rows add up to 1.

    Parameters
    ----------
    side, coarse
        Of the finest cube of the pyramid, and of what comes out; shape (6 coarse^2, rows of the pyramid).
    width
        About the angle from the middle of the lobe to half its height.
    square
        Half diagonal of a square at most, as a share of its distance from the middle, or of the width if that is more.
    """
    sides = sides_from(side)
    offsets = np.concatenate([[0], np.cumsum([FACES * each * each for each in sides])])
    middle = texel_directions(coarse)[: coarse * coarse]
    rows, columns, weights = [], [], []
    for start in range(0, len(middle), ROWS_AT_ONCE):
        here = _squares(middle[start : start + ROWS_AT_ONCE], sides, offsets, lobe, width, square)
        rows.append(here[0] + start)
        columns.append(here[1])
        weights.append(here[2])
    one = (np.concatenate(rows), np.concatenate(columns), np.concatenate(weights))
    return _for_all_faces(one, coarse, sides, offsets)


def _squares(
    middle: Array, sides: tuple[int, ...], offsets: Integers, lobe: Lobe, width: float, square: float
) -> tuple[Integers, Integers, Array]:
    """Rows, numbers in the pyramid and weights of the squares that lobes around `middle` are put together from."""
    row, node = (part.ravel() for part in np.meshgrid(np.arange(len(middle)), np.arange(FACES), indexing="ij"))
    found: list[tuple[Integers, Integers, Array]] = []
    for level in range(len(sides) - 1, -1, -1):
        side = sides[level]
        distance = np.linalg.norm(texel_directions(side)[node] - middle[row], axis=1)
        radius = np.sqrt(2.0) / side
        # Half diagonals are overestimated off the middle of a face: never below what they are.
        is_fine = (radius <= square * np.maximum(distance, width)) | (level == 0)
        weights = _weights(middle[row[is_fine]], node[is_fine], side, lobe)
        has = weights > 0.0
        found.append((row[is_fine][has], node[is_fine][has] + offsets[level], weights[has]))
        row, node = row[~is_fine], node[~is_fine]
        face, v, u = node // (side * side), node // side % side, node % side
        quarters = [((face * 2 * side + 2 * v + dv) * 2 * side + 2 * u + du) for dv in (0, 1) for du in (0, 1)]
        row, node = np.tile(row, 4), np.concatenate(quarters)
    return (
        np.concatenate([each[0] for each in found]),
        np.concatenate([each[1] for each in found]),
        np.concatenate([each[2] for each in found]),
    )


def _weights(middle: Array, node: Integers, side: int, lobe: Lobe) -> Array:
    """Integrals of lobes around `middle`, shape (n, 3), over one square each."""
    inner = (2.0 * np.arange(SAMPLES) + 1.0) / SAMPLES - 1.0
    dv, du = (part.ravel() / side for part in np.meshgrid(inner, inner, indexing="ij"))
    face, v, u = node // (side * side), node // side % side, node % side
    places_u = ((2.0 * u + 1.0) / side - 1.0)[:, None] + du
    places_v = ((2.0 * v + 1.0) / side - 1.0)[:, None] + dv
    towards = directions_on(np.broadcast_to(face[:, None], places_u.shape), places_u, places_v)
    length = np.linalg.norm(towards, axis=-1)
    off = towards / length[..., None] - middle[:, None, :]
    chord = np.einsum("nsk,nsk->ns", off, off)
    return np.asarray((lobe(chord) / length**3).sum(axis=1) * (2.0 / (side * SAMPLES)) ** 2)


def _for_all_faces(
    one: tuple[Integers, Integers, Array], coarse: int, sides: tuple[int, ...], offsets: Integers
) -> sparse.csr_array:
    """The filter of all faces from that of the first one: the axes are mirrored, and counted on."""
    row, column, weight = one
    row_v, row_u = row // coarse, row % coarse
    level = np.searchsorted(offsets, column, side="right") - 1
    side = np.asarray(sides)[level]
    inside = column - offsets[level]
    face, v, u = inside // (side * side), inside // side % side, inside % side
    rows, columns = [], []
    for turned in range(FACES):
        axis, is_mirrored = turned // 2, turned % 2
        # Mirroring x swaps its own faces, turns over v of those along y (whose v is x) and u of those along z.
        other = np.where(face < 2, face ^ is_mirrored, face)
        other_v = np.where((face // 2 == 1) & bool(is_mirrored), side - 1 - v, v)
        other_u = np.where((face // 2 == 2) & bool(is_mirrored), side - 1 - u, u)
        other = (other + 2 * axis) % FACES
        rows.append((turned * coarse + row_v) * coarse + row_u)
        columns.append(offsets[level] + (other * side + other_v) * side + other_u)
    shape = (FACES * coarse * coarse, int(offsets[-1]))
    matrix = sparse.csr_array((np.tile(weight, FACES), (np.concatenate(rows), np.concatenate(columns))), shape)
    sums: Array = np.asarray(matrix.sum(axis=1)).ravel()
    return sparse.csr_array(sparse.diags_array(1.0 / sums) @ matrix)


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
