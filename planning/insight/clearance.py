"""Clearance along the route: how near a sortie comes to panels, building, obstacles and no-fly volumes, and where."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from planning.geo.bvh import point_triangle_d2
from planning.geo.solids import Solids
from planning.insight.obstructions import Obstructions, nearest_obstructions, nearest_triangles
from planning.plan import Sortie
from planning.site.free_space import FreeSpace

Array = NDArray[np.float64]

SPACING_M = 0.5
MAX_SAMPLES = 20_000
"""Of one sortie, apart from vertices and the nearest point of each leg: longer flights are sampled more coarsely."""

THIRDS = 60
"""Find the nearest point of a leg of 20 km to a micrometre."""


@dataclass(frozen=True, slots=True, eq=False)
class Clearance:
    """Clearance from one kind of solids, at q samples of a path with k vertices, k - 1 legs.

    Parameters
    ----------
    clearance_m
        Distance to the nearest skin, negative inside a solid, shape (q,).
    obstruction
        Number of the nearest thing in `Obstructions.all`, shape (q,).
    leg_minimum_m, leg_obstruction
        Least clearance of each leg and the nearest thing, shape (k - 1,). To a micrometre where the leg stays outside
        of solids; inside, the depth is that of the samples.
    """

    clearance_m: Array
    obstruction: NDArray[np.int64]
    leg_minimum_m: Array
    leg_obstruction: NDArray[np.int64]

    @property
    def smallest_m(self) -> float:
        """Of the whole path; NaN where there is none."""
        return float(self.clearance_m.min()) if len(self.clearance_m) else math.nan


@dataclass(frozen=True, slots=True, eq=False)
class RouteClearance:
    """Clearances along one sortie, at q samples: both ends of each leg, points between them, and its nearest points.

    Parameters
    ----------
    distance_m
        Along the path from its first vertex, rising, shape (q,).
    positions_enu_m
        Shape (q, 3).
    leg
        Leg that each sample lies on, from 0, shape (q,).
    solids
        From panels, building and obstacles.
    no_fly
        From no-fly volumes; None where the site has none.
    """

    distance_m: Array
    positions_enu_m: Array
    leg: NDArray[np.int64]
    solids: Clearance
    no_fly: Clearance | None


def route_clearance(
    sortie: Sortie, space: FreeSpace, obstructions: Obstructions, spacing_m: float = SPACING_M
) -> RouteClearance:
    """Clearances along a sortie's path, sampled every `spacing_m` or closer; empty where the sortie has no path."""
    if not spacing_m > 0.0:
        raise ValueError(f"spacing_m: expected more than 0, got {spacing_m}")
    path = np.array(sortie.path_enu_m, np.float64).reshape(-1, 3)
    if len(path) == 1:
        path = np.repeat(path, 2, axis=0)
    a, b = path[:-1], path[1:]
    bodies = [(space.solids, obstructions.solid_owner)]
    if len(space.no_fly.part):
        bodies.append((space.no_fly, obstructions.no_fly_owner))
    lengths_m = np.linalg.norm(b - a, axis=1)
    leg, along = _even_samples(lengths_m, spacing_m)
    triangles = [nearest_triangles(solids, owner, a, b) for solids, owner in bodies]
    for (solids, _), triangle in zip(bodies, triangles, strict=True):
        leg = np.concatenate([leg, np.arange(len(a))])
        along = np.concatenate([along, _nearest_parts(solids.bvh.corners[triangle], a, b)])
    order = np.lexsort([along, leg])
    leg, along = leg[order], along[order]
    points = a[leg] + along[:, None] * (b - a)[leg]
    distance_m = (np.cumsum(lengths_m) - lengths_m)[leg] + along * lengths_m[leg]
    found = [
        _clearance(solids, owner, points, leg, owner[triangle])
        for (solids, owner), triangle in zip(bodies, triangles, strict=True)
    ]
    return RouteClearance(distance_m, points, leg, found[0], found[1] if len(found) == 2 else None)


def _even_samples(lengths_m: Array, spacing_m: float) -> tuple[NDArray[np.int64], Array]:
    """Leg and part of the leg, 0 to 1, of evenly spaced samples on legs of these lengths, both ends included."""
    spacing_m = max(spacing_m, float(lengths_m.sum()) / MAX_SAMPLES)
    steps = np.maximum(1, np.ceil(lengths_m / spacing_m)).astype(np.int64)
    leg = np.repeat(np.arange(len(steps)), steps + 1)
    number = np.arange(len(leg)) - np.repeat(np.cumsum(steps + 1) - (steps + 1), steps + 1)
    return leg, number / steps[leg]


def _clearance(
    solids: Solids,
    owner: NDArray[np.int64],
    points: Array,
    leg: NDArray[np.int64],
    leg_obstruction: NDArray[np.int64],
) -> Clearance:
    clearance_m = solids.clearance_m(points)
    leg_minimum_m = np.full(len(leg_obstruction), np.inf)
    np.minimum.at(leg_minimum_m, leg, clearance_m)
    return Clearance(clearance_m, nearest_obstructions(solids, owner, points), leg_minimum_m, leg_obstruction)


@kernel
def _nearest_parts(corners: Array, a: Array, b: Array) -> Array:
    """Part of each leg, shape (n,), at which it comes nearest to its triangle, of shape (n, 3, 3).

    The distance to a convex set is convex along a line, so that two points tell in which third the least is not.
    """
    result = np.empty(len(a))
    for i in range(len(a)):
        low, high = 0.0, 1.0
        for _ in range(THIRDS):
            left, right = (2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0
            left_d2 = point_triangle_d2(a[i] + left * (b[i] - a[i]), corners[i])
            right_d2 = point_triangle_d2(a[i] + right * (b[i] - a[i]), corners[i])
            if left_d2 <= right_d2:
                high = right
            else:
                low = left
        result[i] = 0.5 * (low + high)
    return result
