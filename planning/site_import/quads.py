"""Four corners for a window outline: the outline itself where it is a quad, else the best-fitting rectangle."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.site_import.polygons import area_vector, plane_axes

Array = NDArray[np.float64]

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
