"""The coarse mesh with its glass put right: what lies in a cuboid around each panel gives way to it (Figs. 8, 9).

Laying panels over the mesh leaves its bulges in front of them; taking whole facade regions away takes the frames, too.
So each panel is drawn in a little, a cuboid is raised on it to both sides, and the part of the mesh inside that cuboid,
cut exactly at its faces, is replaced by the panel.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.mesh import TriangleMesh
from planning.site.records import Facade

Array = NDArray[np.float64]


Indices = NDArray[np.int64]

LEAST_AREA_M2 = 1e-10
"""Smaller pieces of triangles, a hundredth of a millimetre wide, are dropped."""


@dataclass(frozen=True, slots=True)
class RefineParameters:
    """Sizes of the cuboids.

    Parameters
    ----------
    drawn_in_m
        How far each edge of a panel is moved inwards: frames beside it stay.
    in_front_m, behind_m
        Height of the cuboid to either side of the panel: how far a coarse mesh bulges and caves in on glass.
    """

    drawn_in_m: float = 0.02
    in_front_m: float = 0.6
    behind_m: float = 0.6

    def __post_init__(self) -> None:
        if min(self.drawn_in_m, self.in_front_m, self.behind_m) < 0.0:
            raise ValueError("expected sizes of at least zero")


@dataclass(frozen=True, slots=True, eq=False)
class RefinedMesh:
    """The refined mesh.

    Parameters
    ----------
    panel_of_triangle
        Shape (t,): position of the panel that a triangle belongs to, -1 for the rest of the mesh.
    """

    mesh: TriangleMesh
    panel_of_triangle: Indices


def refine_mesh(
    coarse: TriangleMesh, corners_enu_m: Array, parameters: RefineParameters | None = None, monitor: Monitor = QUIET
) -> RefinedMesh:
    """Replace the mesh inside each panel's cuboid by the panel.

    Parameters
    ----------
    corners_enu_m
        Shape (n, 4, 3), counter-clockwise from outside. Panels whose drawn-in shape is empty are left as they are.
    """
    parameters = parameters or RefineParameters()
    if corners_enu_m.ndim != 3 or corners_enu_m.shape[1:] != (4, 3):
        raise ValueError(f"corners_enu_m: expected shape (n, 4, 3), got {corners_enu_m.shape}")
    pieces = coarse.corners_enu_m
    quads, numbers = [], []
    for number, corners in enumerate(corners_enu_m):
        if number % 16 == 0:
            monitor.report(say("refining the mesh"), number, len(corners_enu_m))
        quad = drawn_in(corners, parameters.drawn_in_m)
        if quad is None:
            continue
        pieces = _without(pieces, quad, parameters)
        quads.append(quad)
        numbers.append(number)
    panels = np.array(quads).reshape(-1, 4, 3)
    halves = np.concatenate([panels[:, [0, 1, 2]], panels[:, [0, 2, 3]]])
    triangles = np.concatenate([pieces, halves])
    owner = np.concatenate([np.full(len(pieces), -1), np.tile(np.array(numbers, int), 2)]).astype(np.int64)
    vertices, index = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    return RefinedMesh(TriangleMesh(vertices, index.reshape(-1, 3).astype(np.int64)), owner)


def drawn_in(corners_enu_m: Array, by_m: float) -> Array | None:
    """Quadrilateral, shape (4, 3), whose edges lie that far inside; None where nothing is left of it."""
    normal = np.cross(corners_enu_m[2] - corners_enu_m[0], corners_enu_m[3] - corners_enu_m[1])
    length = float(np.linalg.norm(normal))
    if length < LEAST_AREA_M2:
        return None
    normal = normal / length
    edges = np.roll(corners_enu_m, -1, axis=0) - corners_enu_m
    lengths = np.linalg.norm(edges, axis=1)
    if lengths.min() < 1e-9:
        return None
    inwards = np.cross(normal, edges / lengths[:, None])
    moved = []
    for i in range(4):
        before, after = inwards[i - 1], inwards[i]
        system = np.stack([before, after, normal])
        if abs(float(np.linalg.det(system))) < 1e-9:
            return None
        moved.append(corners_enu_m[i] + np.linalg.solve(system, np.array([by_m, by_m, 0.0])))
    quad = np.array(moved)
    turned = ((np.roll(quad, -1, axis=0) - quad) * edges).sum(axis=1)
    return quad if turned.min() > 0.0 else None


def _without(pieces: Array, quad: Array, parameters: RefineParameters) -> Array:
    """Triangles, shape (t, 3, 3), without what lies in a panel's cuboid."""
    normal = np.cross(quad[2] - quad[0], quad[3] - quad[1])
    normal = normal / np.linalg.norm(normal)
    planes = _cuboid(quad, normal, parameters)
    box = np.concatenate([quad + parameters.in_front_m * normal, quad - parameters.behind_m * normal])
    low, high = box.min(axis=0), box.max(axis=0)
    near = (pieces.max(axis=1) >= low).all(axis=1) & (pieces.min(axis=1) <= high).all(axis=1)
    if not near.any():
        return pieces
    kept = [piece for triangle in pieces[near] for piece in _outside(triangle, planes)]
    return np.concatenate([pieces[~near], np.array(kept).reshape(-1, 3, 3)])


def _cuboid(quad: Array, normal: Array, parameters: RefineParameters) -> Array:
    """Planes (a, b, c, d), shape (6, 4), a x + b y + c z + d > 0 inside."""
    edges = np.roll(quad, -1, axis=0) - quad
    inwards = np.cross(normal, edges)
    inwards /= np.linalg.norm(inwards, axis=1, keepdims=True)
    middle = quad.mean(axis=0)
    directions = np.concatenate([inwards, [-normal, normal]])
    points = np.concatenate([quad, [middle + parameters.in_front_m * normal, middle - parameters.behind_m * normal]])
    return np.column_stack([directions, -(directions * points).sum(axis=1)])


def _outside(triangle: Array, planes: Array) -> list[Array]:
    """The triangle without its part inside all planes: at each plane what is outside is kept, the rest goes on."""
    distances = triangle @ planes[:, :3].T + planes[:, 3]
    if (distances.max(axis=0) <= 0.0).any():
        return [triangle]
    kept: list[Array] = []
    rest = triangle
    for plane in planes:
        distance = rest @ plane[:3] + plane[3]
        outside = _part(rest, -distance)
        if len(outside) >= 3:
            kept += _fan(outside)
        rest = _part(rest, distance)
        if len(rest) < 3:
            return kept
    return kept


def _part(polygon: Array, distance: Array) -> Array:
    """Part of a convex polygon where the distance of its corners to a line is positive."""
    points = []
    for i in range(len(polygon)):
        j = (i + 1) % len(polygon)
        if distance[i] > 0.0:
            points.append(polygon[i])
        if (distance[i] > 0.0) != (distance[j] > 0.0) and distance[i] != distance[j]:
            share = distance[i] / (distance[i] - distance[j])
            points.append(polygon[i] + share * (polygon[j] - polygon[i]))
    return np.array(points).reshape(-1, 3)


def _fan(polygon: Array) -> list[Array]:
    triangles = [polygon[[0, i, i + 1]] for i in range(1, len(polygon) - 1)]
    return [t for t in triangles if 0.5 * float(np.linalg.norm(np.cross(t[1] - t[0], t[2] - t[0]))) > LEAST_AREA_M2]


# How wide the frames between panels are, and panels grown to cover them: the facade as one region.

WIDEST_FRAME_M = 0.6
"""Panels further apart than this have a wall between them, not a frame."""

BARE_M = 0.05
"""Grown by where a facade's panels have no neighbours to measure a frame by."""


def grown_corners(facades: Sequence[Facade]) -> Array:
    """Corners of all panels, in the facades' order, moved outwards by half a frame, shape (n, 4, 3)."""
    grown = []
    for facade in facades:
        corners = np.array([panel.corners_enu_m for panel in facade.panels], float).reshape(-1, 4, 3)
        by = 0.5 * frame_width_m(corners)
        for panel in corners:
            moved = drawn_in(panel, -by)
            grown.append(panel if moved is None else moved)
    return np.array(grown, float).reshape(-1, 4, 3)


def frame_width_m(corners_enu_m: Array) -> float:
    """Usual width of the frames between panels, shape (n, 4, 3): from each edge's middle to the nearest other one."""
    from scipy.spatial import cKDTree

    middles = 0.5 * (corners_enu_m + np.roll(corners_enu_m, -1, axis=1)).reshape(-1, 3)
    if len(corners_enu_m) < 2:
        return BARE_M
    distances, others = cKDTree(middles).query(middles, k=min(4, len(middles)))
    foreign = others // 4 != np.arange(len(middles))[:, None] // 4
    near = np.where(foreign, distances, np.inf).min(axis=1)
    near = near[near <= WIDEST_FRAME_M]
    return float(np.percentile(near, 75.0)) if len(near) else BARE_M
