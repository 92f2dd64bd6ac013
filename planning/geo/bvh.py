"""A bounding volume hierarchy over triangles, and the queries that planning asks of it; compiled, float64.

The tree is a binary tree of axis-aligned boxes, split at the median of the longest side. Queries are distances and
lines of sight, exact up to float64 rounding: they skip only what cannot matter.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks, inline, kernel
from planning.geo.ray_casting import ray_types

Array = NDArray[np.float64]


# Squared distances between points, segments and triangles, robust for degenerate ones; compiled, float64.
#
# Triangles of no area are treated as the segments they are. Squared distances are never negative and never NaN for
# finite input.


@inline
def _clamp01(x: float) -> float:
    return min(max(x, 0.0), 1.0)


@kernel
def point_segment_d2(p: Array, a: Array, b: Array) -> float:
    """Squared distance of a point and a segment, points of shape (3,)."""
    abx, aby, abz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    apx, apy, apz = p[0] - a[0], p[1] - a[1], p[2] - a[2]
    length2 = abx * abx + aby * aby + abz * abz
    t = _clamp01((apx * abx + apy * aby + apz * abz) / length2) if length2 > 0.0 else 0.0
    dx, dy, dz = apx - t * abx, apy - t * aby, apz - t * abz
    return float(dx * dx + dy * dy + dz * dz)


@kernel
def segment_segment_d2(a: Array, b: Array, c: Array, d: Array) -> float:
    """Squared distance of segments ab and cd (after Ericson, Real-Time Collision Detection, 5.1.9)."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = d[0] - c[0], d[1] - c[1], d[2] - c[2]
    wx, wy, wz = a[0] - c[0], a[1] - c[1], a[2] - c[2]
    uu, vv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
    if uu <= 0.0:
        return point_segment_d2(a, c, d)
    if vv <= 0.0:
        return point_segment_d2(c, a, b)
    uv = ux * vx + uy * vy + uz * vz
    uw, vw = ux * wx + uy * wy + uz * wz, vx * wx + vy * wy + vz * wz
    determinant = uu * vv - uv * uv
    # Nearly parallel: the end points below find the distance, so any s will do.
    s = _clamp01((uv * vw - vv * uw) / determinant) if determinant > 1e-12 * uu * vv else 0.0
    t = (uv * s + vw) / vv
    if t < 0.0:
        t = 0.0
        s = _clamp01(-uw / uu)
    elif t > 1.0:
        t = 1.0
        s = _clamp01((uv - uw) / uu)
    dx, dy, dz = wx + s * ux - t * vx, wy + s * uy - t * vy, wz + s * uz - t * vz
    best = dx * dx + dy * dy + dz * dz
    if determinant <= 1e-12 * uu * vv:
        best = min(best, point_segment_d2(a, c, d), point_segment_d2(b, c, d))
        best = min(best, point_segment_d2(c, a, b), point_segment_d2(d, a, b))
    return float(best)


@kernel
def point_triangle_d2(p: Array, triangle: Array) -> float:
    """Squared distance of a point and a triangle, corners of shape (3, 3)."""
    a, b, c = triangle[0], triangle[1], triangle[2]
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    wx, wy, wz = p[0] - a[0], p[1] - a[1], p[2] - a[2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    area2 = nx * nx + ny * ny + nz * nz
    if area2 > 1e-20 * (ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz):
        # Barycentric coordinates of the foot point on the plane.
        s = ((wy * vz - wz * vy) * nx + (wz * vx - wx * vz) * ny + (wx * vy - wy * vx) * nz) / area2
        t = ((uy * wz - uz * wy) * nx + (uz * wx - ux * wz) * ny + (ux * wy - uy * wx) * nz) / area2
        if s >= 0.0 and t >= 0.0 and s + t <= 1.0:
            along = wx * nx + wy * ny + wz * nz
            return float(along * along / area2)
    return min(point_segment_d2(p, a, b), point_segment_d2(p, b, c), point_segment_d2(p, c, a))


@kernel
def segment_hits_triangle(a: Array, b: Array, triangle: Array) -> float:
    """Where segment ab meets a triangle: the parameter in [0, 1], or -1 where it does not (or lies in its plane)."""
    p = triangle[0]
    ux, uy, uz = triangle[1, 0] - p[0], triangle[1, 1] - p[1], triangle[1, 2] - p[2]
    vx, vy, vz = triangle[2, 0] - p[0], triangle[2, 1] - p[1], triangle[2, 2] - p[2]
    dx, dy, dz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    hx, hy, hz = dy * vz - dz * vy, dz * vx - dx * vz, dx * vy - dy * vx
    determinant = ux * hx + uy * hy + uz * hz
    if determinant == 0.0:
        return -1.0
    wx, wy, wz = a[0] - p[0], a[1] - p[1], a[2] - p[2]
    s = (wx * hx + wy * hy + wz * hz) / determinant
    qx, qy, qz = wy * uz - wz * uy, wz * ux - wx * uz, wx * uy - wy * ux
    t = (dx * qx + dy * qy + dz * qz) / determinant
    along = (vx * qx + vy * qy + vz * qz) / determinant
    if s >= 0.0 and t >= 0.0 and s + t <= 1.0 and 0.0 <= along <= 1.0:
        return float(along)
    return -1.0


@kernel
def segment_triangle_d2(a: Array, b: Array, triangle: Array) -> float:
    """Squared distance of segment ab and a triangle; 0 where they meet."""
    if segment_hits_triangle(a, b, triangle) >= 0.0:
        return 0.0
    best = min(point_triangle_d2(a, triangle), point_triangle_d2(b, triangle))
    best = min(best, segment_segment_d2(a, b, triangle[0], triangle[1]))
    best = min(best, segment_segment_d2(a, b, triangle[1], triangle[2]))
    return min(best, segment_segment_d2(a, b, triangle[2], triangle[0]))


# Lines of sight past triangles, with Embree (through Open3D, in float32 relative to the scene's centre).
#
# `planning.geo.solids.Solids.lines_free` is the slow float64 reference.

LineOfSight = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.bool_]]
"""(from, to), both shape (k, 3) ENU metres, to shape (k,): True where the straight line between them is free."""


OCCLUSION_OFFSET_M = 0.15
"""Lines of sight end this far in front of the centroid, so that the pane's own frame does not hide it (contract)."""


RAYS_PER_BATCH = 2_000_000
"""Bounds the memory of one batch to 50 MB."""


class _TrianglesBetween:
    """Line of sight past triangles; to another process go the triangles, which builds the scene anew."""

    def __init__(self, corners_enu_m: Array) -> None:
        self._corners_enu_m = corners_enu_m
        self._centre = corners_enu_m.reshape(-1, 3).mean(axis=0)
        self._tensor, scene = ray_types()
        self._scene = scene()
        vertices = (corners_enu_m.reshape(-1, 3) - self._centre).astype(np.float32)
        self._scene.add_triangles(
            self._tensor(vertices), self._tensor(np.arange(len(vertices), dtype=np.uint32).reshape(-1, 3))
        )

    def __reduce__(self) -> tuple[type[_TrianglesBetween], tuple[Array]]:
        return _TrianglesBetween, (self._corners_enu_m,)

    def __call__(self, a_enu_m: Array, b_enu_m: Array) -> NDArray[np.bool_]:
        free = np.empty(len(a_enu_m), np.bool_)
        for start, stop in chunks(len(a_enu_m), RAYS_PER_BATCH):
            a, b = a_enu_m[start:stop] - self._centre, b_enu_m[start:stop] - self._centre
            # From the panel outwards: the short end at the pane is where float32 must be exact.
            rays = np.concatenate([b, a - b], axis=1).astype(np.float32)
            free[start:stop] = ~self._scene.test_occlusions(self._tensor(rays), 0.0, 1.0).numpy()
        return free


def _nothing_between(a_enu_m: Array, _b_enu_m: Array) -> NDArray[np.bool_]:
    return np.ones(len(a_enu_m), np.bool_)


def line_of_sight(corners_enu_m: Array) -> LineOfSight:
    """Fast line-of-sight test against triangles of shape (t, 3, 3)."""
    return _TrianglesBetween(corners_enu_m) if len(corners_enu_m) else _nothing_between


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


@kernel
def first_hits(bvh: Bvh, origins: Array, directions: Array, reach: float, way: Array, hit: NDArray[np.int64]) -> None:
    """Where rays first meet a triangle within `reach`, in lengths of their directions, shapes (n, 3).

    Written to `way`, infinite where nothing is met, and to `hit`, the triangle in the array the tree was built from, -1
    there. The nearer of two boxes comes first, and what lies behind a hit is left out.
    """
    stack = np.empty(MAX_DEPTH, np.int64)
    end = np.empty(3)
    for i in range(len(origins)):
        a, ahead = origins[i], directions[i]
        way[i], hit[i] = np.inf, -1
        length = reach
        for axis in range(3):
            end[axis] = a[axis] + length * ahead[axis]
        stack[0] = 0
        depth = 1 if len(bvh.corners) > 0 else 0
        while depth > 0:
            depth -= 1
            node = stack[depth]
            if not _segment_near_box(a, end, bvh.low[node], bvh.high[node], 0.0):
                continue
            child = bvh.child[node]
            if child < 0:
                for k in range(bvh.first[node], bvh.first[node] + bvh.size[node]):
                    along = segment_hits_triangle(a, end, bvh.corners[k])
                    if along >= 0.0:
                        length *= along
                        way[i], hit[i] = length, bvh.source[k]
                        for axis in range(3):
                            end[axis] = a[axis] + length * ahead[axis]
            else:
                further = 0.0
                for axis in range(3):
                    middles = bvh.low[child + 1, axis] + bvh.high[child + 1, axis]
                    further += (middles - bvh.low[child, axis] - bvh.high[child, axis]) * ahead[axis]
                nearer = child if further >= 0.0 else child + 1
                stack[depth], stack[depth + 1] = 2 * child + 1 - nearer, nearer
                depth += 2
