"""Which splats lie together: cubes of space, each eight of the next finer ones, and what of them a picture calls for.

Where a cube is no larger than a pixel, one splat does for all that lie in it. A cut through the tree draws each splat
once, by itself or in the coarsest cube that is small enough: cubes lie within those of their parents, so what is small
enough above is so below.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from reconstruction.splats.rasterising.views import View

Array = NDArray[np.float64]
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
