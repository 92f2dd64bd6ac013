"""A bounding volume hierarchy over triangles, and the queries that planning asks of it; compiled, float64.

The tree is a binary tree of axis-aligned boxes, split at the median of the longest side. All queries are exact up to
float64 rounding: they skip only what cannot matter.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import inline, kernel
from planning.geo.distance import point_triangle_d2, segment_hits_triangle, segment_triangle_d2

Array = NDArray[np.float64]

LEAF_SIZE = 4
MAX_DEPTH = 64


class Bvh(NamedTuple):
    """The tree. Node 0 is the root; an inner node's children are `child` and `child + 1`, a leaf has `child` -1.

    Parameters
    ----------
    corners
        Triangles in leaf order, shape (t, 3, 3), metres.
    source
        Index of each of them in the array the tree was built from, shape (t,).
    low, high
        Boxes of the nodes, shape (k, 3).
    child, first, size
        Shape (k,): first child, first triangle, number of triangles.
    """

    corners: Array
    source: NDArray[np.int64]
    low: Array
    high: Array
    child: NDArray[np.int64]
    first: NDArray[np.int64]
    size: NDArray[np.int64]


@kernel
def _select(order: NDArray[np.int64], key: Array, start: int, stop: int, middle: int) -> None:
    """Reorder `order[start:stop]` so that the `middle` smallest keys come first (Hoare's selection)."""
    low, high = start, stop - 1
    while low < high:
        pivot = key[order[(low + high) // 2]]
        i, j = low, high
        while i <= j:
            while key[order[i]] < pivot:
                i += 1
            while key[order[j]] > pivot:
                j -= 1
            if i <= j:
                order[i], order[j] = order[j], order[i]
                i += 1
                j -= 1
        if middle <= j:
            high = j
        elif middle >= i:
            low = i
        else:
            return


@kernel
def _build(
    corners: Array,
) -> tuple[NDArray[np.int64], Array, Array, NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    n = len(corners)
    room = max(1, 2 * n)
    order = np.arange(n)
    centres = np.empty((3, n))
    for i in range(n):
        for axis in range(3):
            centres[axis, i] = (corners[i, 0, axis] + corners[i, 1, axis] + corners[i, 2, axis]) / 3.0
    low, high = np.empty((room, 3)), np.empty((room, 3))
    child, first, size = np.full(room, -1), np.zeros(room, np.int64), np.zeros(room, np.int64)
    size[0] = n
    n_nodes, node = 1, 0
    while node < n_nodes:
        start, stop = first[node], first[node] + size[node]
        spread, split_axis = 0.0, 0
        for axis in range(3):
            box_low, box_high, centre_low, centre_high = np.inf, -np.inf, np.inf, -np.inf
            for k in range(start, stop):
                i = order[k]
                for corner in range(3):
                    value = corners[i, corner, axis]
                    box_low, box_high = min(box_low, value), max(box_high, value)
                centre_low, centre_high = min(centre_low, centres[axis, i]), max(centre_high, centres[axis, i])
            low[node, axis], high[node, axis] = box_low, box_high
            if centre_high - centre_low > spread:
                spread, split_axis = centre_high - centre_low, axis
        if stop - start > LEAF_SIZE:
            middle = (start + stop) // 2
            _select(order, centres[split_axis], start, stop, middle)
            child[node] = n_nodes
            first[n_nodes], size[n_nodes] = start, middle - start
            first[n_nodes + 1], size[n_nodes + 1] = middle, stop - middle
            n_nodes += 2
        node += 1
    return order, low[:n_nodes], high[:n_nodes], child[:n_nodes], first[:n_nodes], size[:n_nodes]


def build_bvh(corners_enu_m: Array) -> Bvh:
    """Tree over triangles, shape (t, 3, 3); t = 0 gives a tree that is infinitely far from everything."""
    corners = np.ascontiguousarray(corners_enu_m, dtype=np.float64)
    order, low, high, child, first, size = _build(corners)
    return Bvh(corners[order], order, low, high, child, first, size)


@inline
def _box_d2(p: Array, low: Array, high: Array) -> float:
    """Squared distance of a point and a box."""
    total = 0.0
    for axis in range(3):
        gap = max(low[axis] - p[axis], p[axis] - high[axis], 0.0)
        total += gap * gap
    return total


@inline
def _segment_near_box(a: Array, b: Array, low: Array, high: Array, margin: float) -> bool:
    """False only where segment ab is further than `margin` from the box (slab test on the widened box)."""
    enter, leave = 0.0, 1.0
    for axis in range(3):
        near, far = low[axis] - margin - a[axis], high[axis] + margin - a[axis]
        d = b[axis] - a[axis]
        if d == 0.0:
            if near > 0.0 or far < 0.0:
                return False
        else:
            t0, t1 = near / d, far / d
            enter, leave = max(enter, min(t0, t1)), min(leave, max(t0, t1))
    return enter <= leave * (1.0 + 1e-12) + 1e-12


@kernel
def nearest_d2(bvh: Bvh, p: Array, upper_d2: float) -> float:
    """Squared distance of point p and the nearest triangle, or `upper_d2` where none is nearer."""
    best = upper_d2
    if len(bvh.corners) == 0:
        return best
    stack = np.empty(MAX_DEPTH, np.int64)
    stack[0] = 0
    depth = 1
    while depth > 0:
        depth -= 1
        node = stack[depth]
        if _box_d2(p, bvh.low[node], bvh.high[node]) >= best:
            continue
        child = bvh.child[node]
        if child < 0:
            for k in range(bvh.first[node], bvh.first[node] + bvh.size[node]):
                best = min(best, point_triangle_d2(p, bvh.corners[k]))
        else:
            left = _box_d2(p, bvh.low[child], bvh.high[child])
            right = _box_d2(p, bvh.low[child + 1], bvh.high[child + 1])
            nearer = child if left <= right else child + 1
            stack[depth] = 2 * child + 1 - nearer
            stack[depth + 1] = nearer
            depth += 2
    return best


@kernel
def segment_d2(bvh: Bvh, a: Array, b: Array, upper_d2: float) -> float:
    """Squared distance of segment ab and the nearest triangle, or `upper_d2` where none is nearer."""
    best = min(upper_d2, nearest_d2(bvh, a, upper_d2), nearest_d2(bvh, b, upper_d2))
    if len(bvh.corners) == 0:
        return best
    margin = np.sqrt(best)
    stack = np.empty(MAX_DEPTH, np.int64)
    stack[0] = 0
    depth = 1
    while depth > 0:
        depth -= 1
        node = stack[depth]
        if not _segment_near_box(a, b, bvh.low[node], bvh.high[node], margin):
            continue
        child = bvh.child[node]
        if child < 0:
            for k in range(bvh.first[node], bvh.first[node] + bvh.size[node]):
                d2 = segment_triangle_d2(a, b, bvh.corners[k])
                if d2 < best:
                    best, margin = d2, np.sqrt(d2)
        else:
            stack[depth], stack[depth + 1] = child, child + 1
            depth += 2
    return best


@kernel
def segment_is_clear(bvh: Bvh, a: Array, b: Array, distance: float) -> bool:
    """True where every point of segment ab is at least `distance` from every triangle."""
    limit = distance * distance
    if len(bvh.corners) == 0:
        return True
    stack = np.empty(MAX_DEPTH, np.int64)
    stack[0] = 0
    depth = 1
    while depth > 0:
        depth -= 1
        node = stack[depth]
        if not _segment_near_box(a, b, bvh.low[node], bvh.high[node], distance):
            continue
        child = bvh.child[node]
        if child < 0:
            for k in range(bvh.first[node], bvh.first[node] + bvh.size[node]):
                if segment_triangle_d2(a, b, bvh.corners[k]) < limit:
                    return False
        else:
            stack[depth], stack[depth + 1] = child, child + 1
            depth += 2
    return True


@kernel
def segment_hits(bvh: Bvh, a: Array, b: Array, hits: NDArray[np.int64]) -> int:
    """Triangles (in leaf order) that segment ab meets: written to `hits` while it has room; returns how many."""
    n = 0
    if len(bvh.corners) == 0:
        return n
    stack = np.empty(MAX_DEPTH, np.int64)
    stack[0] = 0
    depth = 1
    while depth > 0:
        depth -= 1
        node = stack[depth]
        if not _segment_near_box(a, b, bvh.low[node], bvh.high[node], 0.0):
            continue
        child = bvh.child[node]
        if child < 0:
            for k in range(bvh.first[node], bvh.first[node] + bvh.size[node]):
                if segment_hits_triangle(a, b, bvh.corners[k]) >= 0.0:
                    if n < len(hits):
                        hits[n] = k
                    n += 1
        else:
            stack[depth], stack[depth + 1] = child, child + 1
            depth += 2
    return n


@kernel
def segment_is_free(bvh: Bvh, a: Array, b: Array) -> bool:
    """True where segment ab meets no triangle."""
    return segment_hits(bvh, a, b, np.empty(0, np.int64)) == 0
