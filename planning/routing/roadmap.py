"""A graph of certified legs through the free space: what can be flown to from home, and shortest ways around obstacles.

Nodes are the points above home, well-spread positions, and points just outside the forbidden zone, where shortest ways
run. Edges are straight legs whose whole length keeps every distance (`FreeSpace.legs_clear`); their weight is the time
or length that a leg metric gives.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from planning.coverage.positions import sobol
from planning.site.free_space import SAFETY_MARGIN_M, FreeSpace

Array = NDArray[np.float64]

LegMetric = Callable[[Array], Array]
"""Cost of straight legs from their vectors, shape (n, 3) metres, to shape (n,): metres or seconds."""

N_SPREAD = 800
N_SHELL = 1600
"""Nodes of each kind asked for; the shell keeps fewer where the building fills its surroundings."""

SHELL_GAPS_M = (0.05, 0.5, 2.0)
"""How far shell nodes lie outside the minimum distance."""

NEIGHBOURS = 12
MOST_NEIGHBOURS = 64
"""Nodes around a point that are tried at most before it counts as out of reach."""

COLUMN_SPACING_M = 4.0


def leg_length(vectors_enu_m: Array) -> Array:
    """Euclidean length, the simplest metric."""
    return np.asarray(np.linalg.norm(vectors_enu_m, axis=1))


@dataclass(frozen=True, slots=True, eq=False)
class Roadmap:
    """Nodes, shape (k, 3), and certified edges between them, all connected to home.

    The first `n_column` nodes stand above home, from the lowest up; node 0 is `FreeSpace.column_top_enu_m`.
    """

    space: FreeSpace
    nodes_enu_m: Array
    edges: NDArray[np.int64]
    n_column: int
    tree: cKDTree

    def connected_to_home(self, points_enu_m: Array) -> NDArray[np.bool_]:
        """Whether a clear leg joins each allowed point, shape (n, 3), to a node. No means "not found"."""
        connected = np.zeros(len(points_enu_m), np.bool_)
        for n_tried in (4, 16, MOST_NEIGHBOURS):
            to_check = np.flatnonzero(~connected)
            pairs = self.nearest_clear(points_enu_m[to_check], n_tried)
            connected[to_check[pairs[:, 0]]] = True
        return connected

    def nearest_clear(self, points_enu_m: Array, n_nearest: int) -> NDArray[np.int64]:
        """(point, node) pairs, shape (p, 2), of each point's nearest nodes that a clear leg leads to."""
        n_nearest = min(n_nearest, len(self.nodes_enu_m))
        if len(points_enu_m) == 0:
            return np.zeros((0, 2), np.int64)
        _, node = self.tree.query(points_enu_m, n_nearest)
        node = node.reshape(len(points_enu_m), n_nearest)
        pairs = np.stack([np.repeat(np.arange(len(points_enu_m)), n_nearest), node.ravel()], axis=1)
        clear = self.space.legs_clear(points_enu_m[pairs[:, 0]], self.nodes_enu_m[pairs[:, 1]])
        return pairs[clear]


def build_roadmap(space: FreeSpace, seed: int = 0, n_spread: int = N_SPREAD, n_shell: int = N_SHELL) -> Roadmap:
    """Roadmap of a free space; it holds at least the points above home."""
    rng = np.random.default_rng(seed)
    column = _column(space)
    spread = _allowed_part(space, _spread(space, 4 * n_spread, rng))[:n_spread]
    shell = _allowed_part(space, _shell(space, 8 * n_shell, rng))[:n_shell]
    nodes = np.concatenate([column, spread, shell])
    edges = _clear_edges(space, nodes, len(column))
    graph = _graph(nodes, edges, leg_length)
    _, label = connected_components(graph, directed=False)
    kept = label == label[0]
    kept[: len(column)] = True
    number = np.cumsum(kept) - 1
    edges = number[edges[kept[edges].all(axis=1)]]
    nodes = nodes[kept]
    return Roadmap(space, nodes, edges, len(column), cKDTree(nodes))


def _column(space: FreeSpace) -> Array:
    """Points above home, from the airspace floor up, as far as the way up is clear."""
    low = space.column_top_enu_m
    top = space.high_enu_m[2] - 2 * SAFETY_MARGIN_M
    heights = np.arange(low[2], max(top, low[2]) + 1e-9, COLUMN_SPACING_M)
    points = np.stack([np.full(len(heights), low[0]), np.full(len(heights), low[1]), heights], axis=1)
    clear = space.keeps_distances(points)  # home may stand on the border of the airspace, where viewpoints may not
    clear[1:] &= space.legs_clear(points[:-1], points[1:])
    return points[: max(1, int(np.argmin(clear)) if not clear.all() else len(points))]


def _spread(space: FreeSpace, n: int, rng: np.random.Generator) -> Array:
    return space.low_enu_m + sobol(n, rng) * (space.high_enu_m - space.low_enu_m)


def _shell(space: FreeSpace, n: int, rng: np.random.Generator) -> Array:
    """Points a little outside the minimum distance, on both sides of random triangles and around their edges."""
    corners = space.solids.bvh.corners
    if len(corners) == 0:
        return np.zeros((0, 3))
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normals, axis=1)
    chosen = rng.choice(len(corners), n, p=(area + 1e-12) / (area + 1e-12).sum())
    a, b = np.sort(rng.random((2, n, 1)), axis=0)
    on_surface = a * corners[chosen, 0] + (b - a) * corners[chosen, 1] + (1.0 - b) * corners[chosen, 2]
    # Half the points leave along the normal, the others in any direction, so that corners get theirs.
    direction = normals[chosen] * rng.choice([-1.0, 1.0], (n, 1))
    direction[::2] = rng.normal(size=direction[::2].shape)
    direction /= np.maximum(np.linalg.norm(direction, axis=1, keepdims=True), 1e-12)
    distance = space.min_distance_m + 2 * SAFETY_MARGIN_M + rng.choice(SHELL_GAPS_M, (n, 1))
    return np.asarray(on_surface + distance * direction)


def _allowed_part(space: FreeSpace, points: Array) -> Array:
    return points[space.is_allowed(points)]


def _clear_edges(space: FreeSpace, nodes: Array, n_column: int) -> NDArray[np.int64]:
    """Certified edges between neighbouring nodes, and along the column; shape (e, 2)."""
    n_nearest = min(NEIGHBOURS + 1, len(nodes))
    _, near = cKDTree(nodes).query(nodes, n_nearest)
    near = near.reshape(len(nodes), n_nearest)
    pairs = np.stack([np.repeat(np.arange(len(nodes)), n_nearest), near.ravel()], axis=1)
    upwards = np.stack([np.arange(n_column - 1), np.arange(1, n_column)], axis=1)
    pairs = np.concatenate([upwards, np.sort(pairs[pairs[:, 0] != pairs[:, 1]], axis=1)])
    pairs = unique_pairs(pairs, len(nodes))
    return pairs[space.legs_clear(nodes[pairs[:, 0]], nodes[pairs[:, 1]])]


def unique_pairs(pairs: NDArray[np.int64], n: int) -> NDArray[np.int64]:
    """Pairs of numbers below n, shape (p, 2), each once and in order; as one number each, sorted ten times as fast."""
    return np.stack(np.divmod(np.unique(pairs @ np.array([n, 1])), n), axis=1)


def _graph(nodes: Array, edges: NDArray[np.int64], metric: LegMetric) -> csr_array:
    weight = np.maximum(metric(nodes[edges[:, 1]] - nodes[edges[:, 0]]), 1e-9)
    return csr_array(coo_array((weight, (edges[:, 0], edges[:, 1])), shape=(len(nodes), len(nodes))))
