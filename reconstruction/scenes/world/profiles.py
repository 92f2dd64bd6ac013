"""Mullions and transoms: a ring of profile around each pane, up to the middle of the gap to its neighbours.

Where panels have a gap between them, their rings fill it and leave the glass free. Where they meet, or end, the ring
covers half a profile's width of the glass along that edge, and half of it beyond an edge where no panel follows.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planning.coverage.sections import PanelFrames
from planning.geo.mesh import TriangleMesh, empty_mesh, from_corners
from planning.site.records import panel_triangles

Array = NDArray[np.float64]

WIDEST_GAP_M = 0.4
"""Panels further apart have wall between them."""

LEAST_COSINE = 0.85
"""Of the angles between neighbours' normals and edges: around a sharper corner each panel has its own profile."""

BEHIND_M = 0.02
"""How far rings reach behind the glass, so that no ray passes between them."""

MITRE = 3.0
"""A corner moves this much further than its edges, at most: at sharp corners the ring is cut off."""

COVERED = 0.2
"""Share of a panel's shortest edge that its ring covers, at most."""

N_CANDIDATES = 12
"""Nearest edges that are looked at for an edge's neighbour."""


def profile_rings(panels: PanelFrames, width_m: float, depth_m: float) -> TriangleMesh:
    """Rings around panels, standing `depth_m` out before them.

    Parameters
    ----------
    width_m
        Of the profiles where no gap between panels says it.
    """
    if not len(panels):
        return empty_mesh()
    corners, normals = panels.corners, panels.normals[:, None]
    gaps, cosines = edge_gaps(panels)
    has_neighbour = np.isfinite(gaps)
    lengths = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    most = COVERED * np.where(lengths > 0.0, lengths, np.inf).min(axis=1, keepdims=True)
    half_gaps = np.where(has_neighbour, 0.5 * np.where(has_neighbour, gaps, 0.0), 0.5 * width_m)
    covered = np.where(has_neighbour, np.clip(0.5 * width_m - half_gaps, 0.0, None), 0.5 * width_m)
    # On convex facades rings lean apart: their fronts reach as far over as it takes to meet.
    lean = depth_m * np.sqrt((1.0 - cosines) / (1.0 + cosines))
    outer = corners + _moved_corners(panels, half_gaps + lean)
    inner = corners - _moved_corners(panels, np.minimum(covered, most))
    front, back = depth_m * normals, -BEHIND_M * normals
    faces = [
        _bands(inner + front, outer + front),
        _bands(inner + back, inner + front),
        _bands(outer + front, outer + back)[~has_neighbour.reshape(-1)],
    ]
    return from_corners(panel_triangles(np.concatenate(faces)))


def _bands(first: Array, second: Array) -> Array:
    """Quads between two closed rings of four corners, shape (m, 4, 3) each, to (4 m, 4, 3)."""
    quads = np.stack([first, second, np.roll(second, -1, axis=1), np.roll(first, -1, axis=1)], axis=2)
    return quads.reshape(-1, 4, 3)


def edge_gaps(panels: PanelFrames) -> tuple[Array, Array]:
    """Distance from each edge to the next panel and the cosine of the angle between their normals, both shape (m, 4).

    Edges are those from a corner to the next; inf and 1 where no panel follows within `WIDEST_GAP_M`.
    """
    gaps, neighbours = edge_neighbours(panels)
    cosines = np.einsum("mx,mkx->mk", panels.normals, panels.normals[neighbours])
    return gaps, np.where(neighbours >= 0, np.clip(cosines, -1.0, 1.0), 1.0)


def edge_neighbours(panels: PanelFrames) -> tuple[Array, NDArray[np.int64]]:
    """Distance from each edge to the next panel, and which panel that is, both shape (m, 4); inf and -1 for none."""
    from scipy.spatial import KDTree

    starts = panels.corners.reshape(-1, 3)
    ends = np.roll(panels.corners, -1, axis=1).reshape(-1, 3)
    middles = 0.5 * (starts + ends)
    n_edges = len(middles)
    owners = np.repeat(np.arange(len(panels)), 4)
    # The edges of the own panel are among the nearest.
    _, others = KDTree(middles).query(middles, k=min(N_CANDIDATES, n_edges))
    others = others.reshape(n_edges, -1)
    along = (ends - starts)[others]
    towards = middles[:, None] - starts[others]
    lengths2 = np.maximum((along**2).sum(axis=2), 1e-12)
    nearest = np.clip((towards * along).sum(axis=2) / lengths2, 0.0, 1.0)
    distances = np.linalg.norm(towards - nearest[..., None] * along, axis=2)
    cosines = np.einsum("ex,ekx->ek", panels.normals[owners], panels.normals[owners[others]])
    is_neighbour = (owners[others] != owners[:, None]) & (distances <= WIDEST_GAP_M) & (cosines >= LEAST_COSINE)
    # Neighbours' edges run against each other; an edge without length, as a triangle has one, meets none.
    reversed_along = -np.einsum("ex,ekx->ek", ends - starts, along)
    own_lengths = np.linalg.norm(ends - starts, axis=1)[:, None]
    is_neighbour &= (reversed_along >= LEAST_COSINE * own_lengths * np.sqrt(lengths2)) & (own_lengths > 0.0)
    distances = np.where(is_neighbour, distances, np.inf)
    best = distances.argmin(axis=1)
    rows = np.arange(n_edges)
    gaps = distances[rows, best]
    neighbours = np.where(np.isfinite(gaps), owners[others[rows, best]], -1)
    return gaps.reshape(-1, 4), neighbours.reshape(-1, 4)


def _moved_corners(panels: PanelFrames, offsets_m: Array) -> Array:
    """How corners move when each edge moves outwards by its offset, shape (m, 4, 3)."""
    edges = np.roll(panels.corners, -1, axis=1) - panels.corners
    across = np.cross(edges, panels.normals[:, None])
    lengths = np.linalg.norm(across, axis=2, keepdims=True)
    across = np.where(lengths > 0.0, across / np.where(lengths > 0.0, lengths, 1.0), 0.0)
    pairs = np.stack([np.roll(across, 1, axis=1), across], axis=2)
    wanted = np.stack([np.roll(offsets_m, 1, axis=1), offsets_m], axis=2)
    # The shortest move that suits both edges; one is enough where they lie in a line or an edge has no length.
    moved = np.einsum("mkxp,mkp->mkx", np.linalg.pinv(pairs, rcond=1e-6), wanted)
    length = np.linalg.norm(moved, axis=2, keepdims=True)
    longest = MITRE * wanted.max(axis=2, initial=0.0)[..., None]
    return np.asarray(moved * np.minimum(1.0, longest / np.maximum(length, 1e-12)))
