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

from planning.base.jit import kernel
from reconstruction.light.shading import display_from_linear, linear_from_display
from reconstruction.splats.harmonic_colour import FLAT as FLAT_HARMONIC
from reconstruction.splats.harmonic_colour import MIDDLE
from reconstruction.splats.rasterising.projection import rotations
from reconstruction.splats.rasterising.raster_types import FLAT
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.splats import Splats, logit

Array = NDArray[np.float64]


# Which splats lie together: cubes of space, each eight of the next finer ones, and what of them a picture calls for.
#
# Where a cube is no larger than a pixel, one splat does for all that lie in it. A cut through the tree draws each
# splat
# once, by itself or in the coarsest cube that is small enough: cubes lie within those of their parents, so what is
# small
# enough above is so below.

Ints = NDArray[np.int64]

HALVINGS = 20
"""From the cube around everything to the finest there may be: of 2 km, 2 mm."""

FEWEST = 512
"""Items of a level; fewer are drawn so quickly that they need no coarser one."""

MOST_LEFT = 0.75
"""Of the items of a level, that a coarser one may have: with more it is not worth its memory."""

ALONE = -1
"""Parent of what lies in no cube."""

REACH = 2.0
"""Times a cube's side, that what is in it is drawn beyond: middles are within, and sizes at most half of it."""

OPEN, SMALL, HIDDEN = 0, 1, 2
"""Cubes whose parts are drawn; that are drawn themselves; and of which nothing is drawn, or something coarser is."""


@dataclass(frozen=True, slots=True, eq=False)
class Level:
    """Cubes of one size.

    Parameters
    ----------
    start, stop
        Rows of its cubes.
    side_m
        Of a cube.
    """

    start: int
    stop: int
    side_m: float


@dataclass(frozen=True, slots=True, eq=False)
class DetailTree:
    """Rows: splats first, then cubes, finer ones before those that they lie in.

    Parameters
    ----------
    parents
        Row of the cube that each lies in, or `ALONE`.
    corners_m
        Lowest corner of each cube, in the frame of the splats.
    levels
        From fine to coarse.
    """

    n_splats: int
    parents: Ints
    corners_m: Array
    levels: tuple[Level, ...]

    def members(self, level: Level) -> tuple[Ints, Ints]:
        """Rows that lie in the cubes of a level, and which of its cubes each lies in, from 0."""
        below = self.parents[: level.start]
        rows = np.flatnonzero((below >= level.start) & (below < level.stop))
        return rows, below[rows] - level.start

    def finest_cut(self, at_most: int) -> tuple[Ints, float] | None:
        """What is drawn where all cubes up to some size are, and that size in metres; None where no cut is so small.

        Parameters
        ----------
        at_most
            Rows of it.
        """
        for level in self.levels:
            above = self.parents[: level.stop]
            rows = np.flatnonzero((above == ALONE) | (above >= level.stop))
            if len(rows) <= at_most:
                return rows, level.side_m
        return None

    def rows_for(self, view: View, finest_px: float) -> Ints:
        """What is to be drawn in a view, ascending: nothing of cubes that are out of sight with all that is in them.

        Parameters
        ----------
        finest_px
            Side of a cube in the middle of the picture, at most, in pixels.
        """
        from_world = np.ascontiguousarray(view.cam_from_world.numpy())
        states = np.zeros(len(self.parents) - self.n_splats, np.uint8)
        place, sides = view.position_m.double().numpy(), _sides_of_sight(view)
        ratio = finest_px / max(view.fx_px, view.fy_px)
        for level in reversed(self.levels):
            first, last = level.start - self.n_splats, level.stop - self.n_splats
            _look_at(
                from_world,
                place,
                sides,
                ratio,
                level.side_m,
                self.corners_m[first:last],
                self.parents[level.start : level.stop],
                self.n_splats,
                states,
                first,
            )
        return _drawn(self.parents, self.n_splats, states)


def _sides_of_sight(view: View) -> Array:
    """Planes through the camera that bound what a view sees, inward unit normals in camera axes, shape (4, 3)."""
    left, right = -view.cx_px / view.fx_px, (view.width_px - view.cx_px) / view.fx_px
    top, bottom = -view.cy_px / view.fy_px, (view.height_px - view.cy_px) / view.fy_px
    normals = np.array([[1.0, 0.0, -left], [-1.0, 0.0, right], [0.0, 1.0, -top], [0.0, -1.0, bottom]])
    return np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True))


@kernel
def _look_at(
    from_world: Array,
    place: Array,
    sides: Array,
    ratio: float,
    side_m: float,
    corners_m: Array,
    parents: Ints,
    n_splats: int,
    states: NDArray[np.uint8],
    first: int,
) -> None:
    """Give the cubes of a level their states; those of coarser levels have theirs."""
    turn = from_world[:3, :3]
    radius = 0.5 * math.sqrt(3.0) * side_m + REACH * side_m
    for i in range(len(corners_m)):
        state = OPEN
        if parents[i] != ALONE:
            state = states[parents[i] - n_splats]
        if state != OPEN:
            # What lies in a cube that is drawn is not drawn; in one that is out of sight, neither.
            states[first + i] = HIDDEN
            continue
        x, y, z = corners_m[i, 0] - place[0], corners_m[i, 1] - place[1], corners_m[i, 2] - place[2]
        gap_x, gap_y, gap_z = max(x, -x - side_m, 0.0), max(y, -y - side_m, 0.0), max(z, -z - side_m, 0.0)
        if (gap_x * gap_x + gap_y * gap_y + gap_z * gap_z) * ratio * ratio >= side_m * side_m:
            state = SMALL
        x, y, z = x + 0.5 * side_m, y + 0.5 * side_m, z + 0.5 * side_m
        a = turn[0, 0] * x + turn[0, 1] * y + turn[0, 2] * z
        b = turn[1, 0] * x + turn[1, 1] * y + turn[1, 2] * z
        c = turn[2, 0] * x + turn[2, 1] * y + turn[2, 2] * z
        if c < -radius:
            state = HIDDEN
        for k in range(4):
            if sides[k, 0] * a + sides[k, 1] * b + sides[k, 2] * c < -radius:
                state = HIDDEN
        states[first + i] = state


@kernel
def _drawn(parents: Ints, n_splats: int, states: NDArray[np.uint8]) -> Ints:
    """Splats whose cube is open, or that have none, and cubes that are small."""
    found, n = np.empty(len(parents), np.int64), 0
    for i in range(n_splats):
        parent = parents[i]
        if parent == ALONE or states[parent - n_splats] == OPEN:
            found[n] = i
            n += 1
    for i in range(len(states)):
        if states[i] == SMALL:
            found[n] = n_splats + i
            n += 1
    return found[:n].copy()


def detail_tree(means_m: Array, sizes_m: Array, groups: NDArray[np.integer]) -> DetailTree:
    """Cubes of splats that lie together.

    Parameters
    ----------
    means_m
        Middles, shape (n, 3), finite.
    sizes_m
        Of splats, shape (n,): none is in a cube that is smaller.
    groups
        Shape (n,), -1 or more: splats of different ones are in no cube together.
    """
    n = len(means_m)
    if n < FEWEST:
        return DetailTree(n, np.full(n, ALONE), np.zeros((0, 3)), ())
    low = means_m.min(axis=0)
    whole = max(float((means_m - low).max()), float(np.median(sizes_m)), 1e-6)
    finest = whole / 2**HALVINGS
    coordinates = np.clip(((means_m - low) / finest).astype(np.int64), 0, 2**HALVINGS - 1)
    enters = np.clip(np.ceil(np.log2(np.maximum(sizes_m, finest) / finest)), 0, HALVINGS + 1).astype(np.int64)
    first = int(np.median(enters))
    order = np.argsort(enters, kind="stable")
    cuts = np.searchsorted(enters[order], np.arange(first, HALVINGS + 1), side="right")
    rows, parents, corners, levels = np.zeros(0, np.int64), [np.full(n, ALONE)], [], []
    n_rows, entered = n, 0
    group = groups.astype(np.int64) + 1
    n_groups = int(group.max()) + 1
    for halved, cut in zip(range(first, HALVINGS + 1), cuts, strict=True):
        rows = np.concatenate([rows, order[entered:cut]])
        entered = int(cut)
        cells = coordinates[rows] >> halved
        keys = _joined(cells, group[rows], n_groups, HALVINGS - halved)
        _, one, cube, count = np.unique(keys, return_index=True, return_inverse=True, return_counts=True)
        if len(rows) < FEWEST or len(one) > MOST_LEFT * len(rows):
            continue
        is_shared = count > 1
        number = n_rows - 1 + np.cumsum(is_shared)
        is_in = is_shared[cube]
        together = np.concatenate(parents)
        together[rows[is_in]] = number[cube[is_in]]
        shared = one[is_shared]
        parents = [together, np.full(len(shared), ALONE)]
        side = finest * 2**halved
        corners.append(low + cells[shared] * side)
        levels.append(Level(n_rows, n_rows + len(shared), side))
        coordinates = np.concatenate([coordinates, coordinates[rows[shared]]])
        group = np.concatenate([group, group[rows[shared]]])
        rows = np.concatenate([rows[~is_in], np.arange(n_rows, n_rows + len(shared))])
        n_rows += len(shared)
    return DetailTree(n, np.concatenate(parents), np.concatenate([np.zeros((0, 3)), *corners]), tuple(levels))


def _joined(cells: Ints, group: Ints, n_groups: int, bits: int) -> Ints:
    """One number for each cube of each group, small enough for 64 bits: groups are numbered anew if they must be."""
    if 3 * bits + max(1, n_groups - 1).bit_length() <= 63:
        return ((group << bits | cells[:, 0]) << bits | cells[:, 1]) << bits | cells[:, 2]
    plan = np.unique(cells[:, 0] << bits | cells[:, 1], return_inverse=True)[1]
    column = np.unique(plan << bits | cells[:, 2], return_inverse=True)[1]
    return column * n_groups + group


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
    sizes, turns = axes_of(spreads[n:], scales.shape[1])
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


def axes_of(spreads: Array, n_sizes: int) -> tuple[Array, Array]:
    """Standard deviations, largest first, shape (n, n_sizes), and quaternions (w, x, y, z) of their axes."""
    squares, axes = np.linalg.eigh(spreads)
    sizes = np.sqrt(np.maximum(squares[:, ::-1], 0.0))
    sizes = np.maximum(sizes, THINNEST * sizes[:, :1])[:, :n_sizes]
    axes = axes[:, :, ::-1].copy()
    axes[np.linalg.det(axes) < 0.0, :, 2] *= -1.0
    return sizes, Rotation.from_matrix(axes).as_quat(scalar_first=True)
