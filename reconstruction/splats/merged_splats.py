"""Splats in the place of many: for pictures in which these are finer than a pixel.

A merged splat has the middle, the spread and the mean colour of those it stands for, weighed by what each covers
(opacity times area). Colours are averaged as light; Gaussian mixtures are brought together by their first two moments,
as in hierarchies of 3-D Gaussians (Kerbl et al., 2024). There opacities above 1 keep surfaces closed; here sizes do.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.spatial.transform import Rotation
from torch import Tensor

from reconstruction.light.shading import display_from_linear, linear_from_display
from reconstruction.splats.detail_tree import DetailTree, Level, detail_tree
from reconstruction.splats.harmonic_colour import FLAT as FLAT_HARMONIC
from reconstruction.splats.harmonic_colour import MIDDLE
from reconstruction.splats.rasterising.projection import rotations
from reconstruction.splats.rasterising.raster_types import FLAT
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.splats import Splats, logit

Array = NDArray[np.float64]

MOST_OPAQUE = 0.99
"""Opacity of merged splats, at most; where they would cover more, they become larger."""

MOST_LARGER = 1.8
"""Times, along each axis: Gaussians a cube apart, as wide as what lies evenly in a cube, cover a surface then."""

FULL = 4.0
"""Times a cube's side squared, that a merged splat covers at most, however many lie over each other in the cube: a
surface covered so often is closed."""

THINNEST = 1e-3
"""Size of a merged splat across, against along: what lies on a line has none."""

SIGMAS = 2.0
"""Standard deviations of a splat that must fit into a cube that it is in."""


@dataclass(frozen=True, slots=True, eq=False)
class SplatsOfDetail:
    """Splats, and merged ones in which they are left out.

    Parameters
    ----------
    all
        Rows as the tree has them.
    """

    tree: DetailTree
    all: Splats

    def for_view(self, view: View, finest_px: float) -> Splats:
        """Those that a picture calls for: merged where cubes are as fine as `finest_px` in it."""
        return self.all.some(torch.from_numpy(self.tree.rows_for(view, finest_px)))


@torch.no_grad()
def splats_of_detail(splats: Splats) -> SplatsOfDetail:
    """Merge splats of one panel, and those of none, cube by cube; takes seconds for a million.

    Parameters
    ----------
    splats
        In main memory.
    """
    means, scales = splats.means.double().numpy(), splats.scales.double().numpy()
    tree = detail_tree(means, SIGMAS * scales.max(axis=1, initial=0.0), splats.panels.numpy())
    n, n_all = tree.n_splats, len(tree.parents)
    across = np.sort(scales, axis=1)[:, -FLAT:].prod(axis=1)
    covers, shares = _covers(tree, 2.0 * math.pi * splats.opacities.double().numpy() * across)
    middles, spreads = _moments(shares, _with_room(means, n_all), _with_room(_covariances(splats), n_all))
    sizes, turns = _axes(spreads[n:], scales.shape[1])
    natural = 2.0 * math.pi * MOST_OPAQUE * sizes[:, :FLAT].prod(axis=1)
    larger = np.clip(np.sqrt(covers[n:] / natural), 1.0, MOST_LARGER)
    own = {
        "means": torch.from_numpy(middles[n:]),
        "quats": torch.from_numpy(turns),
        "log_scales": torch.from_numpy(np.log(sizes * larger[:, None])),
        "opacity_logits": logit(torch.from_numpy(MOST_OPAQUE * np.minimum(1.0, covers[n:] / (natural * larger**2)))),
    }
    values = {}
    for name in splats.names:
        before = splats.get_parameter(name).detach()
        merged = own.get(name)
        if merged is None:
            mixed = _with_room(_mixable(name, before).flatten(1).numpy(), n_all)
            for share in shares:
                share.mix(mixed)
            merged = _unmixed(name, torch.from_numpy(mixed[n:]).reshape(-1, *before.shape[1:]))
        values[name] = torch.cat([before, merged.to(before)])
    panels = _with_room(splats.panels.numpy(), n_all)
    for share in shares:
        panels[share.level.start + share.cubes] = panels[share.rows]
    return SplatsOfDetail(tree, Splats(values, torch.from_numpy(panels)))


@dataclass(frozen=True, slots=True, eq=False)
class _Shares:
    """What of a level's cubes each of their parts is.

    Parameters
    ----------
    rows, cubes
        Of the parts, and which cube of the level each is in.
    weights
        1 in all for each cube.
    """

    level: Level
    rows: NDArray[np.int64]
    cubes: NDArray[np.int64]
    weights: Array

    def mix(self, values: NDArray[Any]) -> None:
        """Write the means of its cubes' parts into their rows, shape (n, k)."""
        level = self.level
        shape = level.stop - level.start, level.start
        mixing = csr_array((self.weights.astype(values.dtype), (self.cubes, self.rows)), shape)
        values[level.start : level.stop] = np.asarray(mixing @ values[: level.start])


def _covers(tree: DetailTree, of_splats: Array) -> tuple[Array, list[_Shares]]:
    """Area that each row covers, square metres, and what of its cube each is by that."""
    covers = _with_room(of_splats, len(tree.parents))
    # Of parts that cover nothing, each counts as much as another.
    least = 1e-12 + 1e-6 * float(of_splats.max(initial=0.0))
    shares = []
    for level in tree.levels:
        rows, cubes = tree.members(level)
        weights = covers[rows] + least
        shares.append(_Shares(level, rows, cubes, weights / np.bincount(cubes, weights)[cubes]))
        covers[level.start : level.stop] = np.minimum(np.bincount(cubes, covers[rows]), FULL * level.side_m**2)
    return covers, shares


def _moments(shares: list[_Shares], middles: Array, spreads: Array) -> tuple[Array, Array]:
    """Middles, shape (n, 3), and covariances, shape (n, 3, 3), of all, from those of splats."""
    for share in shares:
        share.mix(middles)
        apart = middles[share.rows] - middles[share.level.start + share.cubes]
        around = spreads[: share.level.stop].reshape(-1, 9).copy()
        around[share.rows] += (apart[:, :, None] * apart[:, None, :]).reshape(-1, 9)
        share.mix(around)
        spreads[share.level.start : share.level.stop] = around[share.level.start :].reshape(-1, 3, 3)
    return middles, spreads


def _with_room(values: NDArray[Any], n: int) -> NDArray[Any]:
    """With zeros behind them, n rows in all."""
    found = np.zeros((n, *values.shape[1:]), values.dtype)
    found[: len(values)] = values
    return found


def _mixable(name: str, values: Tensor) -> Tensor:
    """Shape (n, ...), at least two axes: what may be averaged of a parameter."""
    if name in ("reflectivity_logits", "f0_logits"):
        values = torch.sigmoid(values)
    if name == "sh":
        values = values.clone()
        values[:, 0] = linear_from_display(MIDDLE + FLAT_HARMONIC * values[:, 0])
    return values[:, None] if values.ndim == 1 else values


def _unmixed(name: str, values: Tensor) -> Tensor:
    """Inverse of `_mixable`, of averages."""
    if name in ("reflectivity_logits", "f0_logits"):
        return logit(values)
    if name == "sh":
        values[:, 0] = (display_from_linear(values[:, 0]) - MIDDLE) / FLAT_HARMONIC
    return values


def _covariances(splats: Splats) -> Array:
    """Shape (n, 3, 3), square metres."""
    axes = rotations(splats.quats.double())[:, :, : splats.log_scales.shape[1]] * splats.scales.double()[:, None]
    return np.asarray((axes @ axes.transpose(1, 2)).numpy())


def _axes(spreads: Array, n_sizes: int) -> tuple[Array, Array]:
    """Standard deviations, largest first, shape (n, n_sizes), and quaternions (w, x, y, z) of their axes."""
    squares, axes = np.linalg.eigh(spreads)
    sizes = np.sqrt(np.maximum(squares[:, ::-1], 0.0))
    sizes = np.maximum(sizes, THINNEST * sizes[:, :1])[:, :n_sizes]
    axes = axes[:, :, ::-1].copy()
    axes[np.linalg.det(axes) < 0.0, :, 2] *= -1.0
    return sizes, Rotation.from_matrix(axes).as_quat(scalar_first=True)
