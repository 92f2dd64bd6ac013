"""Where rays meet a scene: bodies and panes in one mesh for Embree, met again exactly in float64.

Embree finds the triangle in float32; the distance then comes from the triangle's plane in float64, so that mirror
images lie where optics puts them.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from planning.geo.mesh import TriangleMesh, join
from planning.geo.ray_casting import RayCaster
from reconstruction.scenes.record import Panes, Scene

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Mask = NDArray[np.bool_]

LIFT_M, LIFT = 1e-3, 1e-6
"""Least height above a surface at which light that leaves it starts, and that as a share of the scene's radius: eight
steps of a float32 there."""

LONGEST_START = 50.0
"""Lifts along the ray to reach that height; rays closer to grazing are lifted sideways, by at most one."""

AGREE = 1e-4
"""Relative difference, on top of a lift, between the exact distance and Embree's. Where they differ by more the ray
lies in the plane, which then has no exact distance."""

MOST_PASSED = 64
"""Surfaces that a ray passes through at most."""


@dataclass(frozen=True, slots=True, eq=False)
class RayHits:
    """What n rays met first.

    Parameters
    ----------
    distance_m
        Shape (n,); inf where nothing is met.
    points_enu_m, normals_enu
        Shape (n, 3): where, and the flat surface's unit normal towards the ray's origin; 0 where nothing is met.
    bodies, panes, triangles
        Shape (n,): which; -1 for none.
    """

    distance_m: Array
    points_enu_m: Array
    normals_enu: Array
    bodies: Index
    panes: Index
    triangles: Index

    def at(self, rows: Index | Mask) -> RayHits:
        """Of some of the rays."""
        return RayHits(*(getattr(self, field.name)[rows] for field in fields(self)))

    def with_rows(self, rows: Index, others: RayHits) -> RayHits:
        """With other meetings of some of the rays."""
        whole = [getattr(self, field.name).copy() for field in fields(self)]
        for values, field in zip(whole, fields(self), strict=True):
            values[rows] = getattr(others, field.name)
        return RayHits(*whole)


@dataclass(frozen=True, slots=True, eq=False)
class PaneFrames:
    """Axes of flat panes, each shape (m, 3), as `Panes` describes them."""

    middles_enu_m: Array
    normals: Array
    rights: Array
    ups: Array

    @classmethod
    def of(cls, panes: Panes) -> PaneFrames:
        """From the corners."""
        c = panes.corners_enu_m
        normals = _unit(np.cross(c[:, 2] - c[:, 0], c[:, 3] - c[:, 1]))
        along = c[:, 1] - c[:, 0]
        rights = _unit(along - np.einsum("mk,mk->m", along, normals)[:, None] * normals)
        return cls(c.mean(axis=1), normals, rights, np.cross(normals, rights))


class Geometry:
    """A scene that rays can be sent into, built once."""

    def __init__(self, scene: Scene) -> None:
        quads = scene.panes.corners_enu_m
        first = 4 * np.arange(len(quads), dtype=np.int64)[:, None, None]
        pane_triangles = (first + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3)
        mesh = join([*(body.mesh for body in scene.bodies), TriangleMesh(quads.reshape(-1, 3), pane_triangles)])
        counts = [len(body.mesh.triangles) for body in scene.bodies]
        # The last entry is that of triangle -1: nothing.
        self._body = np.concatenate([np.repeat(np.arange(len(counts)), counts), np.full(2 * len(quads) + 1, -1)])
        self._pane = np.concatenate([np.full(sum(counts), -1), np.repeat(np.arange(len(quads)), 2), [-1]])
        self.pane_frames = PaneFrames.of(scene.panes)
        corners = mesh.corners_enu_m
        normals = _unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
        normals[sum(counts) :] = np.repeat(self.pane_frames.normals, 2, axis=0)
        self.corners_enu_m = corners.copy()
        """Of the triangles, shape (t, 3, 3)."""
        corners[sum(counts) :, 0] = np.repeat(self.pane_frames.middles_enu_m, 2, axis=0)
        self.normals_enu = normals
        """Of the triangles, shape (t, 3), as they are wound; 0 where one has no area."""
        self._on_plane = corners[:, 0]
        self._caster = RayCaster(mesh)
        used = mesh.vertices_enu_m if len(mesh.vertices_enu_m) else np.zeros((1, 3))
        self._middle = 0.5 * (used.min(axis=0) + used.max(axis=0))
        self._radius_m = float(np.linalg.norm(used - self._middle, axis=1).max())
        self._lift_m = max(LIFT_M, LIFT * self._radius_m)

    def above(self, points_enu_m: Array, normals_enu: Array) -> Array:
        """Where rays start that leave points on surfaces in any direction, shape (n, 3)."""
        return points_enu_m + 2.0 * self._lift_m * normals_enu

    def meet(self, origins_enu_m: Array, directions_enu: Array) -> RayHits:
        """First meetings of rays, both shape (n, 3), unit directions."""
        # From far away rays start at the sphere around everything: float32 is coarse there.
        away = origins_enu_m - self._middle
        skipped = np.maximum(np.sqrt(np.einsum("nk,nk->n", away, away)) - self._radius_m - 1.0, 0.0)
        starts = origins_enu_m + skipped[:, None] * directions_enu
        hits = self._caster.cast(starts, directions_enu)
        which = hits.triangles
        distance, points, normals = _hits(
            starts, directions_enu, hits.distance_m, which, self.normals_enu, self._on_plane, self._lift_m
        )
        bodies, panes = self._body[which], self._pane[which]
        return RayHits(distance + skipped, points, normals, bodies, panes, which)

    def beyond(self, hits: RayHits, directions_enu: Array, is_passed: Mask, is_wanted: Mask) -> RayHits:
        """What rays meet behind bodies that they pass through, where that is something wanted; else what they met.

        Parameters
        ----------
        is_passed, is_wanted
            By body, and at last by pane, shape (number of bodies + 1,).
        """
        rows = going = np.flatnonzero(is_passed[hits.bodies] & (hits.triangles >= 0))
        found = hits.at(rows)
        # Each step passes one surface; a crown of leaves has the most of them.
        for _ in range(MOST_PASSED):
            if not len(going):
                break
            at = np.searchsorted(rows, going)
            starts, ways = found.points_enu_m[at] + self._lift_m * directions_enu[going], directions_enu[going]
            then = self.meet(starts, ways)
            then = replace(then, distance_m=then.distance_m + found.distance_m[at] + self._lift_m)
            found = found.with_rows(at, then)
            going = going[is_passed[then.bodies] & (then.triangles >= 0)]
        wanted = (found.triangles >= 0) & is_wanted[found.bodies]
        return hits.with_rows(rows[wanted], found.at(np.flatnonzero(wanted)))

    def leaving(
        self, points_enu_m: Array, directions_enu: Array, normals_enu: Array, depths_m: Array | float = 0.0
    ) -> tuple[Array, Array]:
        """Starts, and lengths of the way to them, of rays that leave a surface, shapes (n, 3) and (n,).

        They move along the ray, which shifts no mirror image.

        Parameters
        ----------
        depths_m
            How far behind the triangles that were met the points lie, shape (n,) or ().
        """
        rising, lift = np.einsum("nk,nk->n", directions_enu, normals_enu), self._lift_m + depths_m
        ahead = lift * np.minimum(1.0 / np.maximum(rising, 1.0 / LONGEST_START), LONGEST_START)
        sideways = np.maximum(lift - ahead * rising, 0.0)
        return points_enu_m + ahead[:, None] * directions_enu + sideways[:, None] * normals_enu, ahead

    def is_lit(self, points_enu_m: Array, normals_enu: Array, towards_enu: Array) -> NDArray[np.bool_]:
        """Whether nothing stands between points, shape (n, 3), on surfaces and far away in one direction, (n,)."""
        starts = self.above(points_enu_m, normals_enu)
        directions = np.broadcast_to(towards_enu, starts.shape)
        return ~self._caster.cast(starts, directions).is_hit


@kernel
def _hits(
    starts: Array, directions: Array, cast: Array, triangles: Index, normals_enu: Array, on_plane: Array, agree_m: float
) -> tuple[Array, Array, Array]:
    """Distances, points and normals towards the ray, from the planes of the triangles that Embree found."""
    n = len(cast)
    distance, points, normals = cast.copy(), np.zeros((n, 3)), np.zeros((n, 3))
    for i in range(n):
        t = triangles[i]
        if t < 0:
            continue
        falling = above = 0.0
        for k in range(3):
            falling += normals_enu[t, k] * directions[i, k]
            above += normals_enu[t, k] * (on_plane[t, k] - starts[i, k])
        if abs(above - cast[i] * falling) <= (agree_m + AGREE * cast[i]) * abs(falling) and falling != 0.0:
            distance[i] = above / falling
        for k in range(3):
            points[i, k] = starts[i, k] + distance[i] * directions[i, k]
            normals[i, k] = -normals_enu[t, k] if falling > 0.0 else normals_enu[t, k]
    return distance, points, normals


def _unit(vectors: Array) -> Array:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0.0))


def texture_axes(normals_enu: Array) -> tuple[Array, Array]:
    """Unit vectors to the right and upwards on faces with unit normals, each shape (n, 3), as `Body` says."""
    level = np.hypot(normals_enu[:, 0], normals_enu[:, 1])
    is_level = level < LEVEL
    rights = np.column_stack([-normals_enu[:, 1], normals_enu[:, 0], np.zeros(len(level))])
    rights = rights / np.where(is_level, 1.0, level)[:, None]
    rights[is_level] = (1.0, 0.0, 0.0)
    ups = np.cross(normals_enu, rights)
    ups[is_level] = (0.0, 1.0, 0.0)
    return rights, ups


LEVEL = 1e-6
"""Sine of the slope below which a face counts as level."""
