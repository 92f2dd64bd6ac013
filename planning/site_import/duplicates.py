"""Panels that show the same pane twice: a window inside a curtain wall panel, two skins of glass, a drawing doubled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from planning.site_import.polygons import plane_axes, quad_areas, unit_normals

Array = NDArray[np.float64]

SAME_ANGLE_RAD = np.radians(10.0)
SAME_DEPTH_M = 0.6
"""Panels whose planes are no further apart can be one pane; the cavity of a double-skin facade is 0.2 m and more."""

SAME_SHARE = 0.5
"""Panels are the same where at least this share of the smaller one's area lies over the other."""

SAME_PLANE_M = 0.01
"""Nearer planes are one: then the smaller panel goes, else the inner one."""


def without_duplicates(corners: Array) -> NDArray[np.int64]:
    """Indices of the panels to keep, ascending, from corners of shape (m, 4, 3), counter-clockwise from outside.

    A large panel over two or more small ones that fill it goes (the frame of a curtain wall over its panes). Of two
    that show the same pane the inner one goes, or the smaller one where they lie in one plane.
    """
    kept = np.ones(len(corners), np.bool_)
    pairs = _overlapping_pairs(corners)
    areas = quad_areas(corners)
    filled, n_inside = np.zeros(len(corners)), np.zeros(len(corners), np.int64)
    for i, j, overlap, _ in pairs:
        small, large = (i, j) if areas[i] < areas[j] else (j, i)
        filled[large] += overlap
        n_inside[large] += areas[small] < SAME_SHARE * areas[large]
    kept[(n_inside >= 2) & (filled >= SAME_SHARE * areas)] = False
    for i, j, _, j_is_outside_m in pairs:
        if kept[i] and kept[j]:
            if abs(j_is_outside_m) > SAME_PLANE_M:
                kept[i if j_is_outside_m > 0.0 else j] = False
            else:
                kept[i if areas[i] < areas[j] else j] = False
    return np.flatnonzero(kept)


def coincident_pairs(corners: Array) -> list[tuple[int, int]]:
    """Pairs of panels with the same centroid to a millimetre and areas equal to 1 %."""
    areas = quad_areas(corners)
    pairs = KDTree(corners.mean(axis=1)).query_pairs(0.001) if len(corners) else set()
    return sorted((i, j) for i, j in pairs if abs(areas[i] - areas[j]) <= 0.01 * max(areas[i], areas[j]))


def _overlapping_pairs(corners: Array) -> list[tuple[int, int, float, float]]:
    """Pairs (i, j, overlapping area, distance of j outside the plane of i) that may be the same pane."""
    import shapely

    if len(corners) < 2:
        return []
    areas, normals, centres = quad_areas(corners), unit_normals(corners), corners.mean(axis=1)
    radius = np.linalg.norm(corners - centres[:, None], axis=2).max(axis=1)
    tree = KDTree(centres)
    found = []
    for i in range(len(corners)):
        # The smaller of two is looked for around the larger, so that each pair is met once and nothing is missed.
        for j in tree.query_ball_point(centres[i], radius[i] + SAME_DEPTH_M):
            if (radius[j], j) >= (radius[i], i) or normals[i] @ normals[j] < np.cos(SAME_ANGLE_RAD):
                continue
            outside_m = float(normals[i] @ (centres[j] - centres[i]))
            if abs(outside_m) > SAME_DEPTH_M:
                continue
            axes = np.stack(plane_axes(normals[i]), axis=-1)
            a, b = (shapely.Polygon((corners[k] - centres[i]) @ axes) for k in (i, j))
            overlap = float(shapely.intersection(a, b).area)
            if overlap >= SAME_SHARE * areas[j]:
                found.append((i, j, overlap, outside_m))
    return found
