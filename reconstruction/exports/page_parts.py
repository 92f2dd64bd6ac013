"""Large models in parts: a coarse model that a web page carries, and fine parts beside it that take its place near by.

Space is cut into cubes. Of those that lie in one cube, on one pane or on none, a single Gaussian is made, with their
middle, spread and mean colour, as `splats.merged_splats` does it; what is larger than a cube stays as it is. Cubes that
lie together are a part: a page shows a part's Gaussians, or the merged ones that stand for them, never both.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import torch
from numpy.typing import NDArray

from reconstruction.exports.component_parts import Ellipsoids
from reconstruction.light.shading import display_from_linear
from reconstruction.splats.harmonic_colour import FLAT as FLAT_HARMONIC
from reconstruction.splats.harmonic_colour import MIDDLE, light_of_display
from reconstruction.splats.merged_splats import FULL, MOST_LARGER, MOST_OPAQUE, SIGMAS, axes_of
from reconstruction.splats.rasterising.projection import rotations

Array = NDArray[np.float32]
Ints = NDArray[np.int64]

MOST_COARSE = 1 << 17
"""Gaussians of the coarse model, about: 8 MB of a page."""

PART = 1 << 15
"""Gaussians of a part at most, 2 MB of a file; a multiple of the 1024 in a row of textures that WebGL 2 draws from."""

FINEST_BITS = 16
"""Cubes along each side of what is around all Gaussians, as a power of 2, at most."""

AT_ONCE = 1 << 18
"""Gaussians whose spreads are worked out together."""


@dataclass(frozen=True, slots=True, eq=False)
class GlassValues:
    """What Gaussians are made of apart from what they mirror, n of them.

    Parameters
    ----------
    sh, reflectivity, f0
        As `PaneMirrors` has them, shapes (n, k, 3), (n,) and (n, 3).
    """

    sh: Array
    reflectivity: Array
    f0: Array

    def chosen(self, rows: Ints) -> GlassValues:
        """Some of them."""
        return GlassValues(self.sh[rows], self.reflectivity[rows], self.f0[rows])


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """Gaussians that lie together.

    Parameters
    ----------
    rows
        Of the fine model, shape (k,).
    middle_m, radius_m
        Of a sphere around the cubes.
    """

    rows: Ints
    middle_m: tuple[float, float, float]
    radius_m: float


@dataclass(frozen=True, slots=True, eq=False)
class TwoLevels:
    """A coarse model, and parts.

    Parameters
    ----------
    coarse, glass
        The model, and what its Gaussians on panes are made of.
    part_of
        Number of the part that takes each one's place, shape (n,); -1 for those that stay.
    side_m
        Of a cube.
    """

    coarse: Ellipsoids
    glass: GlassValues | None
    part_of: NDArray[np.int32]
    parts: tuple[Part, ...]
    side_m: float


def two_levels(fine: Ellipsoids, glass: GlassValues | None, most_coarse: int | None = None) -> TwoLevels:
    """Of a model that is too large for one piece.

    Parameters
    ----------
    glass
        By row of `fine`.
    most_coarse
        Gaussians of the coarse model, at most unless that many are larger than the largest cubes.
    """
    low = fine.means_m.min(axis=0).astype(np.float64)
    sizes = SIGMAS * fine.scales_m.max(axis=1)
    # Where all lie in one place, it is as large as nearly all of them.
    whole = max(float((fine.means_m.max(axis=0) - low).max()), float(np.quantile(sizes, 0.99)), 1e-6) * (1.0 + 1e-6)
    side, keys = _cubes(fine, sizes, low, whole, MOST_COARSE if most_coarse is None else most_coarse)
    order = np.argsort(keys, kind="stable")
    first = np.searchsorted(keys[order], 0)
    alone, order = order[:first], order[first:]
    starts = _starts(keys[order])
    counts = np.diff(np.append(starts, len(order)))
    is_single = counts == 1
    stays = np.concatenate([alone, order[starts[is_single]]])
    # What is left is merged, cube by cube in the order of a Morton curve, so that neighbours lie together.
    order = order[np.repeat(~is_single, counts)]
    counts = counts[~is_single]
    merged, merged_glass = _merged(fine, glass, order, counts, side)
    part_of_cube = _parts(counts)
    cuts = np.searchsorted(part_of_cube, np.arange(int(part_of_cube.max(initial=-1)) + 2))
    ends = np.concatenate([[0], np.cumsum(counts)])
    parts = tuple(_part(fine, order[ends[start] : ends[stop]], side) for start, stop in pairwise(cuts))
    coarse = _joined(fine.chosen(stays), merged)
    of_stays = np.full(len(stays), -1)
    together = None
    if glass is not None and merged_glass is not None:
        kept = glass.chosen(stays)
        names = ("sh", "reflectivity", "f0")
        together = GlassValues(*(np.concatenate([getattr(kept, k), getattr(merged_glass, k)]) for k in names))
    part_of = np.concatenate([of_stays, part_of_cube]).astype(np.int32)
    return TwoLevels(coarse, together, part_of, parts, side)


def _cubes(fine: Ellipsoids, sizes: Array, low: NDArray[np.float64], whole: float, most: int) -> tuple[float, Ints]:
    """Side of the finest cubes that are few enough, and a number of each Gaussian's cube and pane; -1 of large ones."""
    keys = np.zeros(0, np.int64)
    side = whole
    bits_of_panes = (int(fine.panels.max(initial=-1)) + 2).bit_length()
    for bits in range(min(FINEST_BITS, (62 - bits_of_panes) // 3) + 1):
        tried = whole / 2**bits
        found = _keys(fine, low, tried, bits)
        found[sizes > tried] = -1
        n_cubes = len(np.unique(found)) + int((found < 0).sum())
        if bits and n_cubes > most:
            break
        side, keys = tried, found
    return side, keys


def _keys(fine: Ellipsoids, low: NDArray[np.float64], side: float, bits: int) -> Ints:
    """Places of cubes along a Morton curve, and panes."""
    key = np.zeros(len(fine), np.int64)
    for axis in range(3):
        place = ((fine.means_m[:, axis] - low[axis]) / side).astype(np.int64).clip(0, 2**bits - 1)
        for bit in range(bits):
            key |= ((place >> bit) & 1) << (3 * bit + axis)
    return key * (int(fine.panels.max(initial=-1)) + 2) + fine.panels + 1


def _starts(keys: Ints) -> Ints:
    """Where runs of the same number begin, which are cut where they are longer than a part."""
    if not len(keys):
        return np.zeros(0, np.int64)
    starts = np.flatnonzero(np.diff(keys, prepend=keys[0] - 1))
    lengths = np.diff(np.append(starts, len(keys)))
    if lengths.max() <= PART:
        return starts
    cut = [np.arange(start, start + length, PART) for start, length in zip(starts, lengths, strict=True)]
    return np.concatenate(cut)


def _parts(counts: Ints) -> Ints:
    """Number of the part that each cube is in, in their order: as many as there is room for."""
    found, number, n = np.empty(len(counts), np.int64), 0, 0
    for place, count in enumerate(counts.tolist()):
        if n and n + count > PART:
            number, n = number + 1, 0
        found[place] = number
        n += count
    return found


def _part(fine: Ellipsoids, rows: Ints, side: float) -> Part:
    places = fine.means_m[rows].astype(np.float64)
    low, high = places.min(axis=0), places.max(axis=0)
    x, y, z = (float(value) for value in 0.5 * (low + high))
    return Part(rows, (x, y, z), float(np.linalg.norm(high - low)) / 2.0 + side)


def _joined(one: Ellipsoids, other: Ellipsoids) -> Ellipsoids:
    names = ("means_m", "quats", "scales_m", "opacities", "sh", "panels")
    return Ellipsoids(*(np.concatenate([getattr(one, name), getattr(other, name)]) for name in names))


def _merged(
    fine: Ellipsoids, glass: GlassValues | None, order: Ints, counts: Ints, side: float
) -> tuple[Ellipsoids, GlassValues | None]:
    """One Gaussian for each run of rows: see `splats.merged_splats`."""
    starts = np.cumsum(counts) - counts
    if not len(starts):
        return fine.chosen(order), None if glass is None else glass.chosen(order)
    across = np.sort(fine.scales_m, axis=1)[:, 1:].astype(np.float64).prod(axis=1)[order]
    covers = 2.0 * math.pi * fine.opacities[order] * across
    weights = covers + 1e-12 + 1e-6 * float(covers.max())
    weights /= np.repeat(np.add.reduceat(weights, starts), counts)

    def mean(values: NDArray[np.floating]) -> NDArray[np.float64]:
        flat = values.reshape(len(values), -1)
        columns = [np.add.reduceat(weights * column, starts) for column in flat[order].T]
        return np.stack(columns, axis=1).reshape(len(starts), *values.shape[1:])

    middles = mean(fine.means_m)
    spreads = np.zeros((len(starts), 9))
    for column, values in enumerate(_spreads(fine, order, np.repeat(middles, counts, axis=0))):
        spreads[:, column] = np.add.reduceat(weights * values, starts)
    sizes, turns = axes_of(spreads.reshape(-1, 3, 3), 3)
    covered = np.minimum(np.add.reduceat(covers, starts), FULL * side**2)
    natural = 2.0 * math.pi * MOST_OPAQUE * sizes[:, :2].prod(axis=1)
    larger = np.clip(np.sqrt(covered / natural), 1.0, MOST_LARGER)
    scales = np.column_stack([sizes[:, :2] * larger[:, None], sizes[:, 2]])
    opacities = MOST_OPAQUE * np.minimum(1.0, covered / (natural * larger**2))
    turned = np.where(turns[:, :1] < 0.0, -turns, turns)
    middles_m, quats, scales_m, alphas, sh = (
        np.asarray(each, np.float32)
        for each in (middles, turned, scales, opacities, _as_display(mean(_as_light(fine.sh))))
    )
    found = Ellipsoids(middles_m, quats, scales_m, alphas, sh, fine.panels[order[starts]])
    if glass is None:
        return found, None
    own = _as_display(mean(_as_light(glass.sh))), mean(glass.reflectivity), mean(glass.f0)
    return found, GlassValues(*(np.asarray(each, np.float32) for each in own))


def _spreads(fine: Ellipsoids, order: Ints, middles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Covariances about the middles of their runs, shape (9, n)."""
    found = np.empty((9, len(order)))
    for start in range(0, len(order), AT_ONCE):
        part = slice(start, start + AT_ONCE)
        rows = order[part]
        turns = rotations(torch.from_numpy(fine.quats[rows].astype(np.float64))).numpy()
        axes = turns * fine.scales_m[rows].astype(np.float64)[:, None]
        apart = fine.means_m[rows] - middles[part]
        both = axes @ axes.transpose(0, 2, 1) + apart[:, :, None] * apart[:, None, :]
        found[:, part] = both.reshape(-1, 9).T
    return found


def _as_light(sh: Array) -> Array:
    """With linear light in the place of colours of all directions: light is what adds up."""
    found = sh.copy()
    found[:, 0] = light_of_display(torch.from_numpy(MIDDLE + FLAT_HARMONIC * sh[:, 0])).numpy()
    return found


def _as_display(sh: NDArray[np.float64]) -> NDArray[np.float64]:
    sh[:, 0] = (display_from_linear(torch.from_numpy(sh[:, 0])).numpy() - MIDDLE) / FLAT_HARMONIC
    return sh
