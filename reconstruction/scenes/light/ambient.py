"""Light that reaches matt surfaces from all directions but the sun's: what of the sky they see, and what stands around.

It is gathered at nodes of a grid over each plane of the scene, when a ray first asks for it there, and is linear
between them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import inline, kernel
from reconstruction.scenes.light.geometry import Geometry, texture_axes

Array = NDArray[np.float64]
Index = NDArray[np.int64]

Gather = Callable[[Array, Array], tuple[Array, NDArray[np.bool_]]]
"""Light along rays from surfaces (starts and unit directions, shape (n, 3)), and whether it comes from a back."""

MOST_NODES = 512
"""Along a side of a plane; the grid of a longer one is wider."""

AMBIENT_BEAM_RAD = math.sqrt(math.pi / 64.0)
"""How wide each of 64 rays is that together are all light on a surface."""

INSIDE = 0.3
"""Share of rays that meet the backs of surfaces above which a node lies inside of something, and is not asked."""

ALIKE, ALIKE_M = 1e-3, 0.01
"""Triangles whose normals and distances from the origin differ by less are of one plane."""

PLACES = ((0.5, 0.5), (0.2, 0.3), (0.8, 0.7), (0.3, 0.8), (0.7, 0.2))
"""In a cell, where its light is gathered: the first of them that is not inside of something."""

ALWAYS = 1e-3
"""Weight of the furthest of four nodes, which counts where the others are inside of something."""

RIM_M = 0.05
"""Of triangles, where no light is gathered: walls and ground meet there, and edges that do not quite fit."""

MOST_IN_ALL = 1 << 24
"""Nodes; a scene that has more gets a wider grid."""

AT_ONCE = 1 << 11
"""Nodes that are gathered for together."""


@dataclass(frozen=True, slots=True)
class Spacing:
    """How densely light is gathered.

    Parameters
    ----------
    node_m
        Between nodes.
    n_rays
        From each of them, spread so that each counts alike on a matt surface.
    """

    node_m: float
    n_rays: int


FINE = Spacing(1.0, 64)
COARSE = Spacing(4.0, 16)
"""For what is seen, and for the light of what that is lit by."""


class Ambient:
    """Grids over all planes of a geometry.

    Parameters
    ----------
    geometry
        Whose triangles are asked for.
    gather
        Into the scene.
    """

    def __init__(self, geometry: Geometry, gather: Gather, spacing: Spacing = FINE) -> None:
        self._n_rays = spacing.n_rays
        self._gather, self._above = gather, geometry.above
        self._group, self._frames, self._grids, n = _grids(geometry, spacing.node_m)
        self._triangles = np.argsort(self._group, kind="stable")
        self._first = np.searchsorted(self._group[self._triangles], np.arange(len(self._grids) + 1))
        self._corners = _shrunk(geometry.corners_enu_m)
        self._middles = self._corners.mean(axis=1)
        self._reaches_m = np.linalg.norm(self._corners - self._middles[:, None], axis=2).max(axis=1)
        # Each node twice: for the side that its plane's normal points to, and for the other.
        self._light = np.zeros((2 * n, 3), np.float32)
        self._is_inside, self._is_known = np.zeros(2 * n, np.bool_), np.zeros(2 * n, np.bool_)

    @property
    def n_places(self) -> int:
        """Nodes that light was gathered for so far."""
        return int(self._is_known.sum())

    def on(self, points_enu_m: Array, normals_enu: Array, triangles: Index) -> Array:
        """Light, shape (n, 3), on points of triangles, on the side that the unit normals, shape (n, 3), point to."""
        nodes, weights = _nodes(points_enu_m, normals_enu, self._group[triangles], self._frames, self._grids)
        # Threads that ask for the same node at the same time both write the same.
        unknown = np.unique(nodes[~self._is_known[nodes]])
        for start in range(0, len(unknown), AT_ONCE):
            self._fill(unknown[start : start + AT_ONCE])
        return np.asarray(_mixed(nodes, weights, self._light, self._is_inside))

    def _fill(self, nodes: Index) -> None:
        """From the middles of the nodes' cells; where these are inside of something, from elsewhere in the cells."""
        light, is_inside = np.zeros((len(nodes), 3)), np.ones(len(nodes), np.bool_)
        for u, v in PLACES:
            left = np.flatnonzero(is_inside)
            if not len(left):
                break
            light[left], is_inside[left] = self._gathered(nodes[left], u, v)
        # Only once it is settled: another thread that fills the same nodes may be read from already.
        self._light[nodes], self._is_inside[nodes] = light, is_inside
        self._is_known[nodes] = True

    def _gathered(self, nodes: Index, u: float, v: float) -> tuple[Array, NDArray[np.bool_]]:
        """Light on nodes at a place in their cells, shape (n, 3), and whether that is inside of something, (n,)."""
        groups = np.searchsorted(self._grids[:, 7], nodes // 2, side="right") - 1
        places, normals, rights, ups = _places(nodes, u, v, groups, self._frames, self._grids)
        shapes = self._corners, self._middles, self._reaches_m
        places = _snapped(places, groups, self._first, self._triangles, *shapes)
        n_rays = self._n_rays
        k = np.arange(n_rays)
        # Evenly over the disc below the hemisphere (H. Vogel, 1979), so evenly in light that falls on the surface.
        radius, turn = np.sqrt((k + 0.5) / n_rays), k * math.pi * (3.0 - math.sqrt(5.0))
        parts = np.stack([radius * np.cos(turn), radius * np.sin(turn), np.sqrt(1.0 - radius**2)])
        directions = np.einsum("ck,cnx->nkx", parts, np.stack([rights, ups, normals]))
        starts = np.repeat(self._above(places, normals), n_rays, axis=0)
        light, is_behind = self._gather(starts, directions.reshape(-1, 3))
        return light.reshape(-1, n_rays, 3).mean(axis=1), is_behind.reshape(-1, n_rays).mean(axis=1) > INSIDE


def _grids(geometry: Geometry, node_m: float) -> tuple[Index, Array, Array, int]:
    """Plane of each triangle, shape (t,); of each plane, its normal and axes, shape (g, 3, 3); its grids; all nodes.

    A grid, shape (8,), is the distance of its plane from the origin, its lowest u and v, its steps along both, how many
    nodes there are along both, and its first node.
    """
    normals, corners = geometry.normals_enu, geometry.corners_enu_m
    offsets = np.einsum("tk,tk->t", normals, corners[:, 0])
    keys = np.column_stack([np.rint(normals / ALIKE), np.rint(offsets / ALIKE_M)]).astype(np.int64)
    _, first, group = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    group = group.ravel()
    rights, ups = texture_axes(normals[first])
    frames = np.stack([normals[first], rights, ups], axis=1)
    spans = []
    for axis in (1, 2):
        along = np.einsum("tck,tk->tc", corners, frames[group, axis])
        low, high = np.full(len(first), np.inf), np.full(len(first), -np.inf)
        np.minimum.at(low, group, along.min(axis=1))
        np.maximum.at(high, group, along.max(axis=1))
        spans.append((low, high))
    (low_u, high_u), (low_v, high_v) = spans
    while True:
        n_u, n_v = (np.clip(np.ceil((high - low) / node_m), 1, MOST_NODES) for low, high in spans)
        if (n_u * n_v).sum() <= max(MOST_IN_ALL, len(first)):
            break
        node_m *= 2.0
    ends = np.cumsum(n_u * n_v)
    grids = np.column_stack(
        [offsets[first], low_u, low_v, (high_u - low_u) / n_u, (high_v - low_v) / n_v, n_u, n_v, ends - n_u * n_v]
    )
    return group, frames, grids, int(ends[-1]) if len(ends) else 0


def _places(
    nodes: Index, at_u: float, at_v: float, groups: Index, frames: Array, grids: Array
) -> tuple[Array, Array, Array, Array]:
    """Places at shares of nodes' cells, their normals, and axes to the right and upwards, each shape (n, 3)."""
    normal, right, up = (frames[groups, k] for k in range(3))
    offset, low_u, low_v, step_u, step_v, n_u, _, first = grids[groups].T
    row, column = np.divmod(nodes // 2 - first, n_u)
    u, v = low_u + (column + at_u) * step_u, low_v + (row + at_v) * step_v
    places = offset[:, None] * normal + u[:, None] * right + v[:, None] * up
    return places, np.where(nodes % 2 == 0, 1.0, -1.0)[:, None] * normal, right, up


def _shrunk(corners: Array) -> Array:
    """Triangles, shape (t, 3, 3), without a rim of `RIM_M`, or of half their size."""
    inwards = corners.mean(axis=1, keepdims=True) - corners
    lengths = np.linalg.norm(inwards, axis=2, keepdims=True)
    return np.asarray(corners + np.minimum(0.5, RIM_M / np.maximum(lengths, RIM_M)) * inwards)


@kernel
def _snapped(
    places: Array, groups: Index, first: Index, triangles: Index, corners: Array, middles: Array, reaches: Array
) -> Array:
    """The points of their planes' triangles next to places, each shape (n, 3); C. Ericson, 2005, section 5.1.5."""
    found = np.empty_like(places)
    for i in range(len(places)):
        least = np.inf
        for t in triangles[first[groups[i]] : first[groups[i] + 1]]:
            far = 0.0
            for k in range(3):
                far += (places[i, k] - middles[t, k]) ** 2
            if far > (reaches[t] + math.sqrt(least)) ** 2:
                continue
            a, b, c = corners[t]
            ab, ac, ap, bp, cp = b - a, c - a, places[i] - a, places[i] - b, places[i] - c
            d1, d2, d3, d4 = _dot(ab, ap), _dot(ac, ap), _dot(ab, bp), _dot(ac, bp)
            d5, d6 = _dot(ab, cp), _dot(ac, cp)
            of_a, of_b, of_c = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
            if d1 <= 0.0 and d2 <= 0.0:
                v, w = 0.0, 0.0
            elif d3 >= 0.0 and d4 <= d3:
                v, w = 1.0, 0.0
            elif d6 >= 0.0 and d5 <= d6:
                v, w = 0.0, 1.0
            elif of_c <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
                v, w = d1 / (d1 - d3), 0.0
            elif of_b <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
                v, w = 0.0, d2 / (d2 - d6)
            elif of_a <= 0.0 and d4 >= d3 and d5 >= d6:
                w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
                v = 1.0 - w
            else:
                v, w = of_b / (of_a + of_b + of_c), of_c / (of_a + of_b + of_c)
            point = a + v * ab + w * ac
            away = _dot(point - places[i], point - places[i])
            if away < least:
                least = away
                found[i] = point
    return found


@inline
def _dot(a: Array, b: Array) -> float:
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@kernel
def _nodes(points: Array, normals: Array, groups: Index, frames: Array, grids: Array) -> tuple[Index, Array]:
    """The four nodes around each point, and their weights, each shape (n, 4)."""
    nodes, weights = np.empty((len(points), 4), np.int64), np.empty((len(points), 4))
    at = np.zeros(3)
    for i in range(len(points)):
        group = groups[i]
        facing = 0.0
        for axis in range(3):
            at[axis] = 0.0
            for k in range(3):
                at[axis] += points[i, k] * frames[group, axis, k]
        for k in range(3):
            facing += normals[i, k] * frames[group, 0, k]
        side = 0 if facing >= 0.0 else 1
        n_u, n_v, first = int(grids[group, 5]), int(grids[group, 6]), int(grids[group, 7])
        u = (at[1] - grids[group, 1]) / grids[group, 3] - 0.5 if n_u > 1 else 0.0
        v = (at[2] - grids[group, 2]) / grids[group, 4] - 0.5 if n_v > 1 else 0.0
        u, v = min(max(u, 0.0), n_u - 1.0), min(max(v, 0.0), n_v - 1.0)
        left, low = min(int(u), max(n_u - 2, 0)), min(int(v), max(n_v - 2, 0))
        a, b = u - left, v - low
        right, high = min(left + 1, n_u - 1), min(low + 1, n_v - 1)
        nodes[i, 0] = 2 * (first + low * n_u + left) + side
        nodes[i, 1] = 2 * (first + low * n_u + right) + side
        nodes[i, 2] = 2 * (first + high * n_u + left) + side
        nodes[i, 3] = 2 * (first + high * n_u + right) + side
        weights[i, 0], weights[i, 1] = (1.0 - a) * (1.0 - b), a * (1.0 - b)
        weights[i, 2], weights[i, 3] = (1.0 - a) * b, a * b
    return nodes, weights


@kernel
def _mixed(nodes: Index, weights: Array, light: NDArray[np.float32], is_inside: NDArray[np.bool_]) -> Array:
    """Weighted mean of the nodes that are not inside of something; of all where all are."""
    mixed = np.zeros((len(nodes), 3))
    for i in range(len(nodes)):
        outside = 0.0
        for j in range(4):
            if not is_inside[nodes[i, j]]:
                outside += weights[i, j] + ALWAYS
        for j in range(4):
            node, weight = nodes[i, j], weights[i, j]
            if outside > 0.0:
                weight += ALWAYS
                weight = 0.0 if is_inside[node] else weight / outside
            for k in range(3):
                mixed[i, k] += weight * light[node, k]
    return mixed
