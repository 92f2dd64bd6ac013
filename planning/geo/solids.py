"""Solids made of triangles: signed clearance of points and clearance of segments, on all cores.

Closed parts of a mesh are solid: their inside is as forbidden as their skin. A segment that keeps its distance from all
skins cannot change between inside and outside, so one inside test per segment is enough.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks, kernel, run_chunks
from planning.geo.bvh import Bvh, build_bvh, nearest_d2, segment_d2, segment_hits, segment_is_clear, segment_is_free
from planning.geo.mesh import closed_parts

Array = NDArray[np.float64]
Scalar = TypeVar("Scalar", bound=np.generic)

POINTS_PER_CHUNK = 4096

INSIDE_RAYS = np.array([[0.2672, 0.5346, 0.8018], [-0.7431, 0.1391, 0.6547], [0.3713, -0.8911, 0.2603]])
"""Directions of the inside test. None is special, so a ray through an edge is rare; the majority of three decides."""

OPEN_SKIN = -1
MAX_HITS = 1024


@kernel
def _is_inside(bvh: Bvh, part: NDArray[np.int64], p: Array, reach: float, rays: Array) -> bool:
    """Whether p lies inside a closed part: a ray leaves it an odd number of times."""
    votes = 0
    hits = np.empty(MAX_HITS, np.int64)
    end = np.empty(3)
    for r in range(len(rays)):
        for axis in range(3):
            end[axis] = p[axis] + reach * rays[r, axis]
        n = min(segment_hits(bvh, p, end, hits), MAX_HITS)
        for i in range(n):
            if part[hits[i]] == OPEN_SKIN:
                continue
            times = 0
            for j in range(n):
                times += 1 if part[hits[j]] == part[hits[i]] else 0
            if times % 2 == 1:
                votes += 1
                break
    return 2 * votes > len(rays)


@kernel
def _signed_clearances(
    bvh: Bvh, part: NDArray[np.int64], points: Array, upper: float, reach: float, rays: Array, result: Array
) -> None:
    upper_d2 = upper * upper
    for i in range(len(points)):
        distance = np.sqrt(nearest_d2(bvh, points[i], upper_d2))
        result[i] = -distance if _is_inside(bvh, part, points[i], reach, rays) else distance


@kernel
def _segments_clear(bvh: Bvh, a: Array, b: Array, distance: float, result: NDArray[np.bool_]) -> None:
    for i in range(len(a)):
        result[i] = segment_is_clear(bvh, a[i], b[i], distance)


@kernel
def _segment_distances(bvh: Bvh, a: Array, b: Array, upper: float, result: Array) -> None:
    for i in range(len(a)):
        result[i] = np.sqrt(segment_d2(bvh, a[i], b[i], upper * upper))


@kernel
def _lines_free(bvh: Bvh, a: Array, b: Array, result: NDArray[np.bool_]) -> None:
    for i in range(len(a)):
        result[i] = segment_is_free(bvh, a[i], b[i])


@dataclass(frozen=True, slots=True, eq=False)
class Solids:
    """Triangles to keep away from.

    Parameters
    ----------
    bvh
        Tree over all of them.
    part
        Closed part of each triangle in the tree's order, `OPEN_SKIN` for triangles that enclose nothing.
    reach_m
        Longer than any line through all of them.
    """

    bvh: Bvh
    part: NDArray[np.int64]
    reach_m: float

    @classmethod
    def of(cls, corners_enu_m: Array) -> Solids:
        """Solids from triangles of shape (t, 3, 3)."""
        bvh = build_bvh(corners_enu_m)
        part = closed_parts(corners_enu_m)[bvh.source]
        extent = 0.0 if len(corners_enu_m) == 0 else float(np.linalg.norm(np.ptp(corners_enu_m, axis=(0, 1))))
        return cls(bvh, part, 2.0 * extent + 1.0)

    def clearance_m(self, points_enu_m: Array, upper_m: float = math.inf) -> Array:
        """Distance of each point, shape (n, 3), to the nearest skin; negative inside a closed part.

        Distances above `upper_m` are returned as `upper_m`, which saves time.
        """
        points, result = _ends(points_enu_m), np.empty(len(points_enu_m))
        arguments = (upper_m, self.reach_m, INSIDE_RAYS)
        return _each(result, lambda i: _signed_clearances(self.bvh, self.part, points[i], *arguments, result[i]))

    def segments_clear(self, a_enu_m: Array, b_enu_m: Array, distance_m: float) -> NDArray[np.bool_]:
        """True for segments, ends of shape (n, 3), that keep `distance_m` from all skins on their whole length."""
        a, b, result = _ends(a_enu_m), _ends(b_enu_m), np.empty(len(a_enu_m), np.bool_)
        return _each(result, lambda i: _segments_clear(self.bvh, a[i], b[i], distance_m, result[i]))

    def lines_free(self, a_enu_m: Array, b_enu_m: Array) -> NDArray[np.bool_]:
        """True for segments, ends of shape (n, 3), that meet no triangle: line of sight in float64."""
        a, b, result = _ends(a_enu_m), _ends(b_enu_m), np.empty(len(a_enu_m), np.bool_)
        return _each(result, lambda i: _lines_free(self.bvh, a[i], b[i], result[i]))

    def segment_distances_m(self, a_enu_m: Array, b_enu_m: Array, upper_m: float = math.inf) -> Array:
        """Distance of each segment to the nearest skin, exact; 0 where it meets one; at most `upper_m`."""
        a, b, result = _ends(a_enu_m), _ends(b_enu_m), np.empty(len(a_enu_m))
        return _each(result, lambda i: _segment_distances(self.bvh, a[i], b[i], upper_m, result[i]))


def _ends(points_enu_m: Array) -> Array:
    return np.ascontiguousarray(points_enu_m, np.float64)


def _each(result: NDArray[Scalar], work: Callable[[slice], None]) -> NDArray[Scalar]:
    """Let `work` fill slices of `result` on all cores."""
    run_chunks(lambda start, stop: work(slice(start, stop)), chunks(len(result), POINTS_PER_CHUNK))
    return result
