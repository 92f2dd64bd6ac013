"""The pane of a window that is given by faces: its axis, outline and thickness."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.site.importing.polygons import area_vector, plane_axes, triangulate

Array = NDArray[np.float64]

MAX_UNITED_FACES = 200
"""Up to so many triangles the outline is their exact union, beyond (ornate frames) their convex hull."""


MIN_GLASS_SHARE = 0.25
"""Panes are the window where they fill this share of its outline; less is a peephole or a lamp."""

MIN_PANE_SHARE = 0.05
"""Faces with a smaller share of the outline are bars and edges, not panes."""

PARALLEL = np.cos(np.radians(10.0))
"""Faces turned less than this from the window's own direction face the same way."""


ONE_WAY = 0.5
"""Faces whose areas cancel out to less than this share look both ways."""


class Pane(NamedTuple):
    """A pane.

    Parameters
    ----------
    outline
        On the middle plane, shape (k, 3).
    thickness_m
        Across it.
    is_oriented
        The outline turns counter-clockwise as seen from the side that the file calls outside.
    """

    outline: Array
    thickness_m: float
    is_oriented: bool = False


def pane_of(triangles: Array, across: Array) -> Pane:
    """Pane made of triangles, shape (t, 3, 3), t > 0, with the unit vector across it, shape (3,)."""
    heights = triangles.reshape(-1, 3) @ across
    middle, thickness_m = 0.5 * (heights.min() + heights.max()), float(np.ptp(heights))
    right, up = plane_axes(across)
    ring = _outline(np.stack([triangles @ right, triangles @ up], axis=-1))
    return Pane(ring @ np.stack([right, up]) + middle * across, thickness_m)


def pane_of_polygons(polygons: Sequence[Sequence[Array]]) -> Pane | None:
    """Pane of a window given by polygons, each its outer ring and its holes; None where they have no area.

    A window may be one polygon or a body of hundreds: frame, bars, lining, panes. The outlines, holes filled, tell
    which way it faces (the sides of a deep lining have more area than the pane, but less outline). The panes are the
    faces that way without holes; without any, the whole body is taken.
    """
    vectors = np.array([area_vector(rings[0]) for rings in polygons])
    areas = np.linalg.norm(vectors, axis=1)
    if areas.max() < 1e-9:
        return None
    axis = _main_axis(vectors)
    faces_axis = np.abs(vectors @ axis) >= PARALLEL * areas
    has_no_hole = np.array([len(rings) == 1 for rings in polygons])
    is_pane = faces_axis & has_no_hole & (areas >= MIN_PANE_SHARE * areas.max())
    chosen = is_pane if areas[is_pane].sum() >= MIN_GLASS_SHARE * areas.max() else areas > 0.0
    triangles = [triangulate(rings) for rings, is_chosen in zip(polygons, chosen, strict=True) if is_chosen]
    pane = pane_of(np.concatenate(triangles), axis)
    # A body faces both ways: it says nothing about outside.
    along = vectors[chosen] @ axis
    if abs(float(along.sum())) < ONE_WAY * float(np.abs(along).sum()):
        return pane
    is_turned = float(area_vector(pane.outline) @ axis) * float(along.sum()) < 0.0
    return Pane(pane.outline[::-1] if is_turned else pane.outline, pane.thickness_m, is_oriented=True)


def facing_axis(triangles: Array) -> Array:
    """Axis, shape (3,), that most of the area of triangles (t, 3, 3) faces: of a thin body, the one across it."""
    return _main_axis(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]))


def _main_axis(vectors: Array) -> Array:
    """Unit axis, shape (3,), along which most of the length of vectors, shape (n, 3), lies; y where they have none."""
    lengths = np.linalg.norm(vectors, axis=1)
    used = lengths > 1e-12
    if not used.any():
        return np.array([0.0, 1.0, 0.0])
    _, axes = np.linalg.eigh((vectors[used] / lengths[used, None]).T @ vectors[used])
    return np.asarray(axes[:, -1])


def covered_area(triangles: Array, across: Array) -> float:
    """Area of the convex outline of triangles, shape (t, 3, 3), seen along `across`."""
    import shapely

    points = triangles.reshape(-1, 3) @ np.stack(plane_axes(across), axis=-1)
    return float(shapely.convex_hull(shapely.MultiPoint(points)).area)


def _outline(flat: Array) -> Array:
    """Outer ring, shape (k, 2), around triangles of shape (t, 3, 2)."""
    import shapely

    if len(flat) <= MAX_UNITED_FACES:
        faces = shapely.polygons(flat)
        united = shapely.union_all(faces[shapely.area(faces) > 1e-9])
        if united.geom_type == "Polygon" and not united.is_empty:
            return np.asarray(shapely.get_coordinates(united.exterior)[:-1])
    hull = shapely.convex_hull(shapely.MultiPoint(flat.reshape(-1, 2)))
    ring = np.asarray(shapely.get_coordinates(hull))
    return ring[:-1] if hull.geom_type == "Polygon" else ring
