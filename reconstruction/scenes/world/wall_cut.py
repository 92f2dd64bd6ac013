"""Openings for panes in a building's mesh: no ray from outside may meet the wall before the pane.

Coarse meshes have their wall in the plane of the panels, or a little before it. The wall is not moved, which would
tear it from its neighbours: what lies in the prism that stands on a panel, from `BEHIND_M` behind it to `BEFORE_M`
before it, is cut out of the triangles. Between panels, and where the wall stands well behind or far before them, it
stays.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planning.coverage.sections import PanelFrames
from planning.geo.mesh import TriangleMesh, from_corners

Array = NDArray[np.float64]

BEHIND_M = 0.05
"""Embree's float32 tells planes apart that are a hundredth of this apart."""

BEFORE_M = 0.30
"""Sills and frames of detailed models, and walls of coarse ones, stand before the glass by less."""

TOUCHING_M = 1e-6
"""Closer to a plane, a corner lies in it."""

LEAST_AREA_M2 = 1e-8


def without_openings(wall: TriangleMesh, panels: PanelFrames) -> TriangleMesh:
    """The wall without what lies in the prisms of the panels; the mesh itself where nothing does."""
    corners = wall.corners_enu_m
    if not len(corners) or not len(panels):
        return wall
    prisms = _Prisms(panels)
    is_near = _overlap(corners.min(axis=1), corners.max(axis=1), prisms.low.min(axis=0), prisms.high.max(axis=0))
    kept = [corners[~is_near]]
    everyone = np.arange(len(panels))
    is_cut = False
    for triangle in corners[is_near]:
        pieces = prisms.cut(triangle, everyone)
        is_cut |= len(pieces) != 1 or pieces[0] is not triangle
        kept += [_fan(piece) for piece in pieces]
    return from_corners(np.concatenate(kept)) if is_cut else wall


class _Prisms:
    """Six planes a panel, normals outwards: a point is inside where `normals @ point <= offsets` for all of them."""

    def __init__(self, panels: PanelFrames) -> None:
        corners, normals = panels.corners, panels.normals
        edges = np.roll(corners, -1, axis=1) - corners
        lengths = np.linalg.norm(edges, axis=2, keepdims=True)
        sides = np.cross(edges, normals[:, None]) / np.where(lengths > 0.0, lengths, 1.0)
        heights = np.einsum("mkx,mx->mk", corners, normals)
        self.normals = np.concatenate([normals[:, None], -normals[:, None], sides], axis=1)
        self.offsets = np.column_stack(
            [
                heights.max(axis=1) + BEFORE_M,
                BEHIND_M - heights.min(axis=1),
                np.einsum("mkx,mkx->mk", corners, sides),
            ]
        )
        before, behind = BEFORE_M * normals[:, None], BEHIND_M * normals[:, None]
        ends = np.concatenate([corners + before, corners - behind], axis=1)
        self.low, self.high = ends.min(axis=1), ends.max(axis=1)

    def cut(self, polygon: Array, panels: NDArray[np.int64]) -> list[Array]:
        """What of a convex polygon, shape (k, 3), lies outside all prisms of `panels`."""
        near = _overlap(self.low[panels], self.high[panels], polygon.min(axis=0), polygon.max(axis=0))
        panels = panels[near]
        # The middle one first, so that the pieces on both sides of it meet half of the others each.
        for i in np.argsort(np.abs(np.arange(len(panels)) - len(panels) // 2), kind="stable"):
            pieces = self._outside(polygon, int(panels[i]))
            if pieces is not None:
                others = np.delete(panels, i)
                return [part for piece in pieces for part in self.cut(piece, others)]
        return [polygon]

    def _outside(self, polygon: Array, panel: int) -> list[Array] | None:
        """Convex pieces of a polygon outside a prism; None where all of it is."""
        pieces, rest = [], polygon
        for normal, offset in zip(self.normals[panel], self.offsets[panel], strict=True):
            heights = rest @ normal - offset
            if (heights >= -TOUCHING_M).all():
                # A degenerate side's plane has no normal and lets everything pass.
                if normal.any():
                    return None
            elif (heights > TOUCHING_M).any():
                piece, rest = _split(rest, heights)
                pieces.append(piece)
        return [piece for piece in pieces if _area(piece) > LEAST_AREA_M2]


def _overlap(low_a: Array, high_a: Array, low_b: Array, high_b: Array) -> NDArray[np.bool_]:
    return np.asarray(((low_a <= high_b) & (high_a >= low_b)).all(axis=-1))


def _split(polygon: Array, heights: Array) -> tuple[Array, Array]:
    """Parts of a convex polygon above and below a plane."""
    above, below = [], []
    for i in range(len(polygon)):
        j = (i + 1) % len(polygon)
        a, b = heights[i], heights[j]
        if a >= 0.0:
            above.append(polygon[i])
        if a <= 0.0:
            below.append(polygon[i])
        if a * b < 0.0:
            crossing = polygon[i] + a / (a - b) * (polygon[j] - polygon[i])
            above.append(crossing)
            below.append(crossing)
    return np.array(above), np.array(below)


def _area(polygon: Array) -> float:
    relative = polygon - polygon[0]
    return float(0.5 * np.linalg.norm(np.cross(relative[1:-1], relative[2:]).sum(axis=0)))


def _fan(polygon: Array) -> Array:
    """Triangles of a convex polygon, shape (k - 2, 3, 3)."""
    first = np.broadcast_to(polygon[0], (len(polygon) - 2, 3))
    return np.stack([first, polygon[1:-1], polygon[2:]], axis=1)
