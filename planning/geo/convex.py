"""Convex groups of triangles: what can hide a whole region of space at once.

From an apex outside a convex body, the points whose line to the apex meets the body form a convex set (its shadow).
So a box lies in the shadow as soon as its eight corners do. Triangles are grouped into bodies for which that holds:
closed convex parts, flat convex patches, and single triangles for the rest.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from planning.geo.mesh import closed_parts

Array = NDArray[np.float64]

FLATNESS = 1e-6
"""Vertices this far (times the extent of the group) on the wrong side of a plane still count as on it."""


def convex_groups(corners_enu_m: Array) -> NDArray[np.int64]:
    """Number of the convex group of each triangle, shape (t,), from corners of shape (t, 3, 3)."""
    n = len(corners_enu_m)
    group = np.arange(n)
    part = closed_parts(corners_enu_m)
    grouped = np.zeros(n, np.bool_)
    for closed in range(part.max() + 1 if n else 0):
        members = np.flatnonzero(part == closed)
        if _is_convex_body(corners_enu_m[members]):
            group[members] = members[0]
            grouped[members] = True
    rest = np.flatnonzero(~grouped)
    for members in _flat_patches(corners_enu_m[rest]):
        patch = rest[members]
        if len(patch) > 1 and _is_convex_patch(corners_enu_m[patch]):
            group[patch] = patch[0]
    return group


def _plane(corners: Array) -> tuple[Array, Array]:
    """Unit normals (zero for degenerate triangles) and offsets along them, shapes (t, 3) and (t,)."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)
    return normals, np.einsum("tk,tk->t", normals, corners[:, 0])


def _is_convex_body(corners: Array) -> bool:
    """Whether all vertices lie on one side of every face."""
    vertices = np.unique(corners.reshape(-1, 3), axis=0)
    normals, offsets = _plane(corners)
    if len(vertices) * len(normals) > 4_000_000:
        return False  # so finely meshed a part is not worth the test; its patches still count
    heights = vertices @ normals.T - offsets
    slack = FLATNESS * float(np.ptp(vertices, axis=0).max())
    return bool(((heights <= slack).all(axis=0) | (heights >= -slack).all(axis=0)).all())


def _flat_patches(corners: Array) -> list[NDArray[np.int64]]:
    """Triangles that share edges and a plane, patch by patch."""
    n = len(corners)
    if n == 0:
        return []
    _, vertex = np.unique(corners.reshape(-1, 3).round(6), axis=0, return_inverse=True)
    triangles = vertex.reshape(n, 3)
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    owner = np.repeat(np.arange(n), 3)
    _, edge = np.unique(edges, axis=0, return_inverse=True)
    order = np.argsort(edge.ravel(), kind="stable")
    same = np.flatnonzero(np.diff(edge.ravel()[order]) == 0)
    a, b = owner[order[same]], owner[order[same + 1]]
    normals, offsets = _plane(corners)
    extent = float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    parallel = np.abs(np.einsum("tk,tk->t", normals[a], normals[b])) > 1.0 - 1e-10
    level = (
        np.abs(np.einsum("tck,tk->tc", corners[b], normals[a]) - offsets[a][:, None]).max(axis=1) < FLATNESS * extent
    )
    joined = parallel & level
    graph = coo_array((np.ones(joined.sum()), (a[joined], b[joined])), shape=(n, n))
    _, label = connected_components(graph, directed=False)
    order = np.argsort(label, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(label[order])) + 1)


def _is_convex_patch(corners: Array) -> bool:
    """Whether flat triangles that cover each point once fill their convex hull."""
    import shapely

    normals, _ = _plane(corners)
    normal = normals[np.argmax(np.linalg.norm(normals, axis=1))]
    first = np.cross(normal, [1.0, 0.0, 0.0] if abs(normal[0]) < 0.9 else [0.0, 1.0, 0.0])
    first /= np.linalg.norm(first)
    basis = np.stack([first, np.cross(normal, first)], axis=1)
    flat = corners @ basis
    u, v = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    area = 0.5 * np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum()
    hull = shapely.MultiPoint(flat.reshape(-1, 2)).convex_hull.area
    union = shapely.union_all(shapely.polygons(flat)).area if abs(area - hull) > 1e-9 * hull else area
    return bool(abs(union - hull) <= 1e-9 * hull)
