"""What pictures of glass show: through a few pixels of each view, which pane, and what of the surroundings it mirrors.

The surroundings are what the site has: its building, its obstacles, and level ground. Panes are those of usual double
glazing, flat and clean (`REFRACTIVE_INDEX`); beyond the site's bodies is sky.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks, run_chunks
from planning.coverage.sections import PanelFrames
from planning.geo.frames import camera_axes
from planning.geo.mesh import TriangleMesh, join
from planning.geo.ray_casting import RayCaster
from planning.plan import Camera, ViewpointArrays
from planning.site.records import SiteModel

Array = NDArray[np.float64]

REFRACTIVE_INDEX, N_SHEETS = 1.52, 2
"""Of float glass, and of double glazing."""

GROUND_M = 400.0
"""Half the side of the square of ground around the panels that mirrored rays may meet."""

BEFORE_WALL_M, OFF_PANE_M = 0.02, 0.05
"""Panes are taken so far before their places, so that a coarse wall does not hide them; mirrored rays start so far
before them."""

LEAST_COSINE = 0.02
"""Of the angle of incidence; rays that graze more say nothing."""

RAYS_AT_ONCE = 50_000
"""Of each thread: about 5 MB."""


@dataclass(frozen=True, slots=True, eq=False)
class MirroredRays:
    """Rays through pixels that show glass, k of `n_views` views with `n_pixels` each.

    Parameters
    ----------
    views, panels
        Which view looks, and at which panel, shape (k,).
    across
        Where on the panel, 0 to 1 along its lower and its left side, shape (k, 2).
    points_enu_m
        The same in ENU, shape (k, 3).
    reflectances
        Share of light that the pane mirrors there (Fresnel), shape (k,).
    incoming_enu, mirrored_enu
        Unit directions of the line of sight, and of what is mirrored (paper Eq. 20), shape (k, 3).
    distances_m
        From the pane to what is mirrored, inf where that is the sky, shape (k,).
    """

    n_views: int
    n_pixels: int
    views: NDArray[np.int64]
    panels: NDArray[np.int64]
    across: Array
    points_enu_m: Array
    reflectances: Array
    incoming_enu: Array
    mirrored_enu: Array
    distances_m: Array

    def __len__(self) -> int:
        return len(self.views)


class Surroundings:
    """A site's panes, and the bodies that they mirror; with `is_near` false all that is mirrored is far away."""

    def __init__(self, site_model: SiteModel, frames: PanelFrames, is_near: bool = True) -> None:
        self.frames, self._is_near = frames, is_near
        corners = frames.corners + BEFORE_WALL_M * frames.normals[:, None]
        triangles = np.arange(4 * len(corners)).reshape(-1, 4)[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
        east, north, _ = frames.centroids.mean(axis=0)
        ground = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * GROUND_M + (east, north)
        height = np.full((4, 1), site_model.site.airspace.ground_z_m)
        self._panes = TriangleMesh(corners.reshape(-1, 3), triangles)
        self._others = [
            site_model.building,
            *site_model.obstacles,
            TriangleMesh(np.concatenate([ground, height], axis=1), np.array([[0, 1, 2], [0, 2, 3]])),
        ]

    @cached_property
    def _caster(self) -> RayCaster:
        return RayCaster(join([self._panes, *self._others]))

    def panes_met(self, origins_enu_m: Array, directions_enu: Array) -> tuple[NDArray[np.int64], Array]:
        """Which pane each ray meets first, -1 for none, and how far away what it meets is, shape (n,)."""
        hits = self._caster.cast(origins_enu_m, directions_enu)
        is_pane = hits.is_hit & (hits.triangles < 2 * len(self.frames))
        return np.where(is_pane, hits.triangles // 2, -1).astype(np.int64), hits.distance_m

    def rays(self, views: ViewpointArrays, camera: Camera, columns: int, rows: int) -> MirroredRays:
        """Through `columns` x `rows` pixels of each view, those that show a pane from before it."""
        n = len(views.heading_rad)
        ranges = chunks(n, max(1, RAYS_AT_ONCE // (columns * rows)))
        _ = self._caster  # built before threads ask for it
        parts = run_chunks(partial(self._rays, views, camera, columns, rows), ranges)
        found = [np.concatenate(column) for column in zip(*parts, strict=True)] if parts else list(_NO_RAYS)
        return MirroredRays(n, columns * rows, *found)

    def _rays(
        self, views: ViewpointArrays, camera: Camera, columns: int, rows: int, start: int, stop: int
    ) -> tuple[NDArray[np.int64], NDArray[np.int64], Array, Array, Array, Array, Array, Array]:
        forward, right, up = camera_axes(views.heading_rad[start:stop], views.pitch_rad[start:stop])
        x = camera.half_width * ((np.arange(columns) + 0.5) / columns * 2.0 - 1.0)
        y = camera.half_height * ((np.arange(rows) + 0.5) / rows * 2.0 - 1.0)
        x, y = (axis.ravel() for axis in np.meshgrid(x, y))
        incoming = forward[:, None] + x[None, :, None] * right[:, None] + y[None, :, None] * up[:, None]
        incoming = (incoming / np.linalg.norm(incoming, axis=2, keepdims=True)).reshape(-1, 3)
        origins = np.repeat(views.positions_enu_m[start:stop], len(x), axis=0)
        met, distance_m = self.panes_met(origins, incoming)
        frames, kept = self.frames, np.flatnonzero(met >= 0)
        panels = met[kept]
        cosines = -np.einsum("nk,nk->n", incoming[kept], frames.normals[panels])
        kept, panels, cosines = (each[cosines > LEAST_COSINE] for each in (kept, panels, cosines))
        incoming, normals, corners = incoming[kept], frames.normals[panels], frames.corners[panels]
        points = origins[kept] + distance_m[kept, None] * incoming
        mirrored = incoming + 2.0 * cosines[:, None] * normals
        distances = np.full(len(kept), np.inf)
        if self._is_near:
            distances = self._caster.cast(points + OFF_PANE_M * normals, mirrored).distance_m
        sides = corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0]
        inside = points - corners[:, 0]
        across = [np.einsum("nk,nk->n", inside, side) / np.einsum("nk,nk->n", side, side) for side in sides]
        return (
            start + kept // len(x),
            panels,
            np.clip(np.stack(across, axis=1), 0.0, np.nextafter(1.0, 0.0)),
            points,
            pane_reflectance(cosines),
            incoming,
            mirrored,
            distances,
        )


_NO_RAYS = (
    *(np.zeros(0, np.int64) for _ in range(2)),
    np.zeros((0, 2)),
    np.zeros((0, 3)),
    np.zeros(0),
    np.zeros((0, 3)),
    np.zeros((0, 3)),
    np.zeros(0),
)


def pane_reflectance(cosines: Array) -> Array:
    """Share of unpolarised light that a clear pane of `N_SHEETS` sheets sends back, shape (n,).

    Faces reflect by Fresnel's equations (E. Hecht, Optics, 5th ed., Eqs. 4.34 and 4.40, squared); 2 N of them without
    interference send back 2 N r / (1 + (2 N - 1) r), both polarisations apart (G. Stokes, 1862).

    Parameters
    ----------
    cosines
        Of the angle of incidence, above 0 to 1, shape (n,).
    """
    inside = np.sqrt(1.0 - (1.0 - np.square(cosines)) / REFRACTIVE_INDEX**2)
    across = np.square((cosines - REFRACTIVE_INDEX * inside) / (cosines + REFRACTIVE_INDEX * inside))
    along = np.square((inside - REFRACTIVE_INDEX * cosines) / (inside + REFRACTIVE_INDEX * cosines))
    faces = 2 * N_SHEETS
    return np.asarray(0.5 * sum(faces * r / (1.0 + (faces - 1) * r) for r in (across, along)))
