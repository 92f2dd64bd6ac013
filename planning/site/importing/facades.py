"""Panels to facades: by plane, or by a surface that turns a little from panel to panel; and their order in it."""

from __future__ import annotations

import string
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components, minimum_spanning_tree
from scipy.spatial import KDTree
from scipy.spatial.distance import pdist, squareform

from planning.site.importing.polygons import plane_axes, quad_areas, unit_normals

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

PLANE_ANGLE_RAD = np.radians(3.0)
PLANE_OFFSET_M = 0.3
"""Panels of one plane: normals this close, and centroids no further off each other's planes (window types differ)."""

STEP_ANGLE_RAD = np.radians(21.0)
"""Neighbours on a curved surface turn by no more (18 panels around a cylinder); bays and corners turn by 30 or more."""

STEP_REACH = 2.0
"""Neighbours on a curved surface: their centroids are no further apart than so many times the sum of their radii, so
that windows with a wall as wide as themselves between them still chain."""

N_NEIGHBOURS = 24
"""Nearest panels that are looked at."""

STEP_OFFSET = 0.1
"""Neighbours on a curved surface lie along it: their offset across the mean normal is at most this share of their
distance."""

CURVED_RAD = np.radians(5.0)
"""A facade whose normals differ by more is ordered along its surface, not along a line."""

ROW_SHARE = 0.4
"""Panels whose centroids differ in height by less than this share of the smaller one's height are in one row."""


def group_facades(corners: Array) -> list[Indices]:
    """Panels of each facade, in order: rows from below, along each row from left to right as seen from outside.

    Parameters
    ----------
    corners
        Shape (m, 4, 3), ENU metres, counter-clockwise seen from outside.

    Returns
    -------
    facades
        Arrays of panel indices, the facade with most glass first.
    """
    if len(corners) == 0:
        return []
    areas, normals, centres = quad_areas(corners), unit_normals(corners), corners.mean(axis=1)
    first, second = _links(corners, centres, normals)
    graph = coo_array((np.ones(len(first)), (first, second)), shape=(len(corners), len(corners)))
    n_facades, label = connected_components(graph, directed=False)
    members = [np.flatnonzero(label == facade) for facade in range(n_facades)]
    members.sort(key=lambda panels: (-round(float(areas[panels].sum()), 3), int(panels[0])))
    return [panels[_order(corners[panels], centres[panels], normals[panels])] for panels in members]


def facade_name(number: int) -> str:
    """A, B, ... Z, AA, AB, ... for 0, 1, ..."""
    name = ""
    number += 1
    while number:
        number, letter = divmod(number - 1, 26)
        name = string.ascii_uppercase[letter] + name
    return name


def _links(corners: Array, centres: Array, normals: Array) -> tuple[Indices, Indices]:
    """Pairs of panels that belong to one facade, enough of them to connect it."""
    plane = _plane_labels(centres, normals)
    i, j = _neighbours(corners, centres, normals)
    return np.concatenate([np.arange(len(plane)), i]), np.concatenate([plane, j])


def _plane_labels(centres: Array, normals: Array) -> Indices:
    """Number of the first panel of each one's plane, at any distance."""
    label = np.full(len(centres), -1)
    for i in range(len(centres)):
        if label[i] < 0:
            relative = centres - centres[i]
            offset = np.maximum(np.abs(relative @ normals[i]), np.abs((relative * normals).sum(axis=1)))
            same = (normals @ normals[i] >= np.cos(PLANE_ANGLE_RAD)) & (offset <= PLANE_OFFSET_M)
            label[same & (label < 0)] = i
    return label


def _neighbours(corners: Array, centres: Array, normals: Array) -> tuple[Indices, Indices]:
    """Pairs next to each other, with a small turn between them."""
    n = len(centres)
    if n < 2:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    radius = np.linalg.norm(corners - centres[:, None], axis=2).max(axis=1)
    distance, nearest = KDTree(centres).query(centres, k=min(n, N_NEIGHBOURS + 1))
    i, j, distance = np.repeat(np.arange(n), nearest.shape[1]), np.ravel(nearest), np.ravel(distance)
    mean = normals[i] + normals[j]
    turns_little = (normals[i] * normals[j]).sum(axis=1) >= np.cos(STEP_ANGLE_RAD)
    # On a smooth surface the chord is at right angles to the mean normal; across a step or a recess it is not.
    rise = np.abs((mean * (centres[j] - centres[i])).sum(axis=1))
    is_level = rise <= STEP_OFFSET * np.linalg.norm(mean, axis=1) * distance
    kept = turns_little & is_level & (distance <= STEP_REACH * (radius[i] + radius[j])) & (i < j)
    return i[kept], j[kept]


def _order(corners: Array, centres: Array, normals: Array) -> Indices:
    """Order of one facade's panels."""
    if (normals @ normals[0]).min() < np.cos(CURVED_RAD):
        along, height, extent = _along_surface(centres, normals), centres[:, 2], np.ptp(corners[:, :, 2], axis=1)
    else:
        mean = normals.sum(axis=0)
        right, up = plane_axes(mean / np.linalg.norm(mean))
        along, height, extent = centres @ right, centres @ up, np.ptp(corners @ up, axis=1)
    return np.lexsort((along, _rows(height, extent)))


def _rows(height: Array, extent: Array) -> Indices:
    """Row number of each panel, from below."""
    order = np.argsort(height, kind="stable")
    row = np.zeros(len(height), np.int64)
    start = order[0]
    for before, panel in pairwise(order):
        is_new = height[panel] - height[start] > ROW_SHARE * min(extent[panel], extent[start])
        start = panel if is_new else start
        row[panel] = row[before] + is_new
    return row


def _along_surface(centres: Array, normals: Array) -> Array:
    """Distance of each panel along a curved facade, to the right as seen from outside, from an arbitrary start.

    Seen from above, the panels stand on a curve. Distances are summed along the shortest tree through it, each step
    measured along the mean tangent of its ends.
    """
    columns, column = np.unique(centres[:, :2].round(1), axis=0, return_inverse=True)
    tangents = np.zeros((len(columns), 2))
    np.add.at(tangents, column.ravel(), np.c_[-normals[:, 1], normals[:, 0]])
    tree = minimum_spanning_tree(squareform(pdist(columns)))
    order, before = breadth_first_order(tree, 0, directed=False)
    along = np.zeros(len(columns))
    for here in order[1:]:
        mean = tangents[here] + tangents[before[here]]
        step = (columns[here] - columns[before[here]]) @ mean / max(float(np.linalg.norm(mean)), 1e-9)
        along[here] = along[before[here]] + step
    return np.asarray(along[column.ravel()])
