"""Planar polygons in space: their normal, and their triangles, holes respected."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

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


# Four corners for a window outline: the outline itself where it is a quad, else the best-fitting rectangle.

COLLINEAR_M = 0.003
"""A vertex this close to the line between its neighbours is no corner (export noise, split edges)."""

MAX_WARP_M = 0.01
"""A quad that is flatter keeps its own corners; a more warped outline is fitted in its mean plane."""

UPRIGHT_TOLERANCE = 1.05
"""An upright rectangle up to this many times larger than the smallest one is preferred: facades are level."""

MIN_SIDE_M = 0.05
"""Narrower slivers are frames or drawing errors, not panes."""


class Quad(NamedTuple):
    """Corners of shape (4, 3), in the outline's sense of rotation, and whether they are the outline's own."""

    corners: Array
    is_exact: bool


def fit_quad(outline: Array) -> Quad | None:
    """Quad of a window outline, shape (k, 3), metres; None where it is no pane (a sliver, or without area)."""
    ring = _without_collinear(outline)
    if len(ring) < 3:
        return None
    vector = area_vector(ring)
    area = float(np.linalg.norm(vector))
    if area < MIN_SIDE_M**2:
        return None
    normal = vector / area
    centre = ring.mean(axis=0)
    heights = (ring - centre) @ normal
    right, up = plane_axes(normal)
    flat = np.c_[(ring - centre) @ right, (ring - centre) @ up]
    if len(ring) == 4 and np.abs(heights).max() <= MAX_WARP_M and _is_convex_quad(flat):
        corners, is_exact = ring, True
    else:
        corners, is_exact = centre + _best_rectangle(flat) @ np.stack([right, up]), False
    sides = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)
    return Quad(corners, is_exact) if area / sides.max() >= MIN_SIDE_M else None


def start_lower_left(corners: Array) -> Array:
    """Same corners, (4, 3), counter-clockwise from outside, beginning at the lower left one as seen from there."""
    vector = area_vector(corners)
    right, up = plane_axes(vector / np.linalg.norm(vector))
    relative = corners - corners.mean(axis=0)
    # The corner furthest towards lower left; for a diamond the lowest one wins over the leftmost.
    first = int(np.argmin(relative @ right + 1.001 * (relative @ up)))
    return np.asarray(np.roll(corners, -first, axis=0))


def _without_collinear(outline: Array) -> Array:
    """Outline without repeated points and without vertices on the line between their neighbours."""
    ring: Array = outline[np.linalg.norm(outline - np.roll(outline, 1, axis=0), axis=1) > COLLINEAR_M]
    while len(ring) > 3:
        before, after = np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0)
        chord = after - before
        length = np.linalg.norm(chord, axis=1)
        offset = np.linalg.norm(np.cross(ring - before, chord), axis=1) / np.maximum(length, COLLINEAR_M)
        flattest = int(np.argmin(offset))
        if offset[flattest] > COLLINEAR_M:
            break
        ring = np.delete(ring, flattest, axis=0)
    return ring


def _is_convex_quad(flat: Array) -> bool:
    edges = np.roll(flat, -1, axis=0) - flat
    following = np.roll(edges, -1, axis=0)
    turns = edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0]
    lengths = np.linalg.norm(edges, axis=1)
    # A corner of nearly 180 degrees is as good as none.
    return bool((turns > 0.02 * lengths * np.roll(lengths, -1)).all())


def _best_rectangle(flat: Array) -> Array:
    """Rectangle with the centroid and the area of a counter-clockwise polygon, shape (4, 2)."""
    import shapely

    polygon = shapely.make_valid(shapely.Polygon(flat))
    smallest = shapely.oriented_envelope(polygon)
    upright = shapely.envelope(polygon)
    box = upright if upright.area <= UPRIGHT_TOLERANCE * smallest.area else smallest
    corners = shapely.get_coordinates(shapely.orient_polygons(box))[:4]
    centroid = np.array(shapely.get_coordinates(polygon.centroid))[0]
    return np.asarray(centroid + (corners - corners.mean(axis=0)) * np.sqrt(polygon.area / box.area))
