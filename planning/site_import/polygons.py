"""Planar polygons in space: their normal, and their triangles, holes respected."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def area_vector(ring: Array) -> Array:
    """Half the sum of the cross products around a closed ring, shape (k, 3): normal times area, shape (3,).

    Newell's method: exact for flat rings of any shape, the best plane's for rings that are a little warped.
    """
    relative = ring - ring[0]
    return np.asarray(0.5 * np.cross(relative, np.roll(relative, -1, axis=0)).sum(axis=0))


def unit_normals(quads: Array) -> Array:
    """Unit normals of quads with area, shape (m, 4, 3) to (m, 3)."""
    vectors = np.cross(quads[:, 2] - quads[:, 0], quads[:, 3] - quads[:, 1])
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def quad_areas(quads: Array) -> Array:
    """Areas of quads, shape (m, 4, 3) to (m,)."""
    vectors = np.cross(quads[:, 2] - quads[:, 0], quads[:, 3] - quads[:, 1])
    return np.asarray(0.5 * np.linalg.norm(vectors, axis=1))


def plane_axes(normal: Array) -> tuple[Array, Array]:
    """Two unit vectors, right and up as seen against the unit `normal`: right x up = normal.

    Right is horizontal; for a vertical normal it is east (x), as in the contract's hemisphere.
    """
    right = np.array([-normal[1], normal[0], 0.0])
    length = float(np.linalg.norm(right))
    right = right / length if length > 1e-6 else np.array([1.0, 0.0, 0.0])
    up = np.cross(normal, right)
    return right, up / np.linalg.norm(up)


def triangulate(rings: Sequence[Array]) -> Array:
    """Triangles of a polygon in space.

    Parameters
    ----------
    rings
        Outer ring, then holes, each of shape (k, 3), not repeating their first point, in any sense of rotation.

    Returns
    -------
    corners
        Shape (t, 3, 3), turning as the outer ring does; its own vertices wherever no edges cross. Without triangles
        where the outer ring has no area.
    """
    outer = rings[0]
    normal = area_vector(outer)
    area = float(np.linalg.norm(normal))
    if len(outer) < 3 or area < 1e-9:
        return np.zeros((0, 3, 3))
    if len(rings) == 1 and len(outer) == 3:
        return outer[None]
    right, up = plane_axes(normal / area)
    origin = outer.mean(axis=0)
    flat = [np.c_[(ring - origin) @ right, (ring - origin) @ up] for ring in rings]
    if len(rings) == 1 and _is_convex(flat[0]):
        return np.stack([np.broadcast_to(outer[0], (len(outer) - 2, 3)), outer[1:-1], outer[2:]], axis=1)
    return _lift(_triangles_2d(flat), np.concatenate(flat), np.concatenate(rings), origin, right, up)


def _is_convex(ring: Array) -> bool:
    edges = np.roll(ring, -1, axis=0) - ring
    following = np.roll(edges, -1, axis=0)
    turns = edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0]
    # All turns one way and once around: a star-shaped ring turns one way, too, but more than once.
    angles = np.arctan2(turns, (edges * following).sum(axis=1))
    return bool((turns >= 0.0).all() and abs(angles.sum() - 2.0 * np.pi) < 1e-6)


def _triangles_2d(rings: Sequence[Array]) -> Array:
    """Counter-clockwise triangles, shape (t, 3, 2), of a flat polygon whose rings may cross."""
    import shapely

    polygon = shapely.Polygon(rings[0], rings[1:])
    if not polygon.is_valid:
        # Holes that touch or leave the outline are common in real files.
        holes = shapely.union_all([shapely.make_valid(shapely.Polygon(ring)) for ring in rings[1:]])
        polygon = shapely.difference(shapely.make_valid(shapely.Polygon(rings[0])), holes)
    parts = [part for part in shapely.get_parts(polygon) if part.geom_type == "Polygon" and part.area > 1e-9]
    if not parts:
        return np.zeros((0, 3, 2))
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(np.array(parts)))
    corners = shapely.get_coordinates(shapely.orient_polygons(shapely.get_parts(triangles)))
    return np.asarray(corners.reshape(-1, 4, 2)[:, :3])


def _lift(triangles: Array, flat: Array, vertices: Array, origin: Array, right: Array, up: Array) -> Array:
    """Flat triangles back in space: on the ring's own vertices where they are such, else on its plane."""
    if len(triangles) == 0:
        return np.zeros((0, 3, 3))
    place = {point.tobytes(): vertex for point, vertex in zip(flat, vertices, strict=True)}
    lifted = [
        place.get(point.tobytes(), origin + point[0] * right + point[1] * up) for point in triangles.reshape(-1, 2)
    ]
    return np.array(lifted).reshape(-1, 3, 3)
