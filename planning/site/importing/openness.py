"""Which side of a window is outdoors, and how much of the outdoors it sees: by rays to the far away."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks
from planning.geo.line_of_sight import OCCLUSION_OFFSET_M, LineOfSight
from planning.site.importing.polygons import plane_axes, unit_normals

Array = NDArray[np.float64]

N_RAYS = 256
"""Directions per side. Against 65 536 of them the share of free ones was off by 0.5 % (69 windows of two real
buildings; 1.7 % at most), in 0.1 ms a window; 64 rays take half the time and are off by 2 % (4 %)."""

FAR_M = 1000.0
"""Length of a ray; what is not hit by then is the sky or the surroundings."""

MIN_OPEN_SHARE = 0.02
"""A window that sees less of the open is indoors: five of 256 rays may slip through the cracks of a model."""

ROOFLESS_FACTOR = 1.5
ROOFLESS_LIMIT = 0.5
"""In a model without roof or ceilings, rooms see the sky: then outdoors is what sees so many times more of it than the
inner sides of windows do (nine tenths of them), or half of everything."""

PANELS_PER_BATCH = 2000
"""Bounds the memory of one batch of rays to 50 MB."""

UNDECIDED = 0.1
"""Sides whose free shares differ by less look alike; then the one away from the building's middle is outside."""

BLIND = 0.1
"""A side that a file calls outside and that sees less is inside, if the other sees more. In 222 windows of eight real
buildings 12 were turned so, and each saw nothing at all. Everything more is believed: models without walls or roofs
leave inside as open as outside, and courts less so."""


class Sides(NamedTuple):
    """Corners turned so that their normal points outdoors, shape (m, 4, 3), and how open it is there.

    Parameters
    ----------
    corners
        On the outer face of the pane.
    open_share
        Share of the hemisphere's directions, by solid angle, in which nothing of the building is met, seen from the
        point `OCCLUSION_OFFSET_M` in front of the centroid; shape (m,), 0 to 1.
    inner_share
        The same for the other side, shape (m,).
    is_stated
        The file says which side is outside, and is believed, shape (m,).
    is_turned
        The file says so, and is not, shape (m,).
    """

    corners: Array
    open_share: Array
    inner_share: Array
    is_stated: NDArray[np.bool_]
    is_turned: NDArray[np.bool_]

    @property
    def is_decided(self) -> NDArray[np.bool_]:
        """False where both sides are equally open and the file does not say, shape (m,)."""
        return np.asarray(self.is_stated | (np.abs(self.open_share - self.inner_share) >= UNDECIDED))

    @property
    def is_outdoors(self) -> NDArray[np.bool_]:
        """Which panes face the open, shape (m,)."""
        roofless = float(np.percentile(self.inner_share, 90.0)) if len(self.inner_share) else 0.0
        least = max(MIN_OPEN_SHARE, min(ROOFLESS_FACTOR * roofless, ROOFLESS_LIMIT))
        return np.asarray(self.open_share >= np.where(self.is_stated, MIN_OPEN_SHARE, least))


def hemisphere_directions(n: int) -> Array:
    """Directions spread evenly over the hemisphere z > 0, shape (n, 3) (a Fibonacci lattice: equal solid angles)."""
    height = (np.arange(n) + 0.5) / n
    azimuth = np.arange(n) * np.pi * (3.0 - np.sqrt(5.0))
    radius = np.sqrt(1.0 - height**2)
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), height], axis=-1)


def open_shares(points: Array, normals: Array, sight: LineOfSight, reach_m: float = FAR_M) -> Array:
    """Share of the hemisphere about each normal that is free for `reach_m`, shape (m,), for points of shape (m, 3)."""
    shares = np.zeros(len(points))
    for start, stop in chunks(len(points), PANELS_PER_BATCH):
        axes = np.array([np.stack([*plane_axes(normal), normal]) for normal in normals[start:stop]])
        directions = np.einsum("rk,mkj->mrj", hemisphere_directions(N_RAYS), axes)
        starts = np.repeat(points[start:stop], N_RAYS, axis=0)
        free = sight(starts + reach_m * directions.reshape(-1, 3), starts)
        shares[start:stop] = free.reshape(-1, N_RAYS).mean(axis=1)
    return shares


def turn_outwards(
    corners: Array,
    thickness_m: Array,
    middle: Array,
    sight: LineOfSight,
    is_oriented: NDArray[np.bool_] | None = None,
) -> Sides:
    """Find the outer side of every quad.

    Parameters
    ----------
    corners
        Quads on the middle planes of their panes, shape (m, 4, 3).
    thickness_m
        Of the panes, shape (m,).
    middle
        Middle of the building, shape (3,).
    sight
        Line of sight among all triangles of the building and its panes.
    is_oriented
        Which quads turn counter-clockwise as seen from the side that the file calls outside, shape (m,); else none.
    """
    normals = unit_normals(corners)
    centres = corners.mean(axis=1)
    face = 0.5 * thickness_m[:, None] * normals
    front = open_shares(centres + face + OCCLUSION_OFFSET_M * normals, normals, sight)
    back = open_shares(centres - face - OCCLUSION_OFFSET_M * normals, -normals, sight)
    is_decided = np.abs(front - back) >= UNDECIDED
    faces_away = np.einsum("mk,mk->m", centres - middle, normals) >= 0.0
    oriented = np.zeros(len(corners), bool) if is_oriented is None else is_oriented
    is_inside = (front < BLIND) & (back >= front + UNDECIDED)
    is_front = np.where(oriented, ~is_inside, np.where(is_decided, front > back, faces_away))
    turned = np.where(is_front[:, None, None], corners + face[:, None], (corners - face[:, None])[:, ::-1])
    outer, inner = np.where(is_front, front, back), np.where(is_front, back, front)
    return Sides(turned, outer, inner, oriented & ~is_inside, oriented & is_inside)
