"""Surfaces that photos see: what their rays meet of the mesh and the ground, and points that no mesh explains."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from planning.mesh import from_corners, join
from planning.site import panel_triangles
from reconstruction.cameras import PosedPhoto
from reconstruction.ray_casting import RayCaster
from reconstruction.splatting.start_data import SAME_SURFACE_M, KnownScene
from reconstruction.splatting.surfels import beside_panels

Array = NDArray[np.float64]

LEAST_RAYS = 16
"""Of each photo, however many there are."""

MOST_VIEWS = 64
"""Photos, evenly spread over all, that tell how finely a point is seen."""

BESIDE_M = 1.0
"""A frame's surfel is nearer to glass than this."""

LEAST_SLOPE = 0.02
"""Of rays that meet the ground: below a degree, ground cannot be told from sky."""

LEAST_COSINE = 0.02
"""Of incidence: at 89 degrees a surface is seen as finely as it ever matters."""


@dataclass(frozen=True, slots=True, eq=False)
class SeenSurfaces:
    """Places of surfaces, how finely they are seen, whether a surface is known there, and what panel is beside.

    Normals of loose points are 0.
    """

    points_enu_m: Array
    normals_enu: Array
    pixel_m: Array
    is_known: NDArray[np.bool_]
    gaps_m: Array
    edges_enu: Array


def seen_surfaces(
    scene: KnownScene,
    photos: Sequence[PosedPhoto],
    origin_enu_m: Array,
    reach_m: float,
    n_rays: int,
    coarser_around: float,
    seed: int,
) -> SeenSurfaces:
    """Mesh and ground that rays meet, and points that lie off both; none where a panel is, nor out of reach.

    Parameters
    ----------
    reach_m
        From the origin.
    n_rays
        From all photos together.
    coarser_around
        By which pixels count as larger away from panels.
    """
    caster = RayCaster(join([scene.mesh, from_corners(panel_triangles(scene.corners_enu_m))]))
    points, normals, is_known = _hits(caster, scene.ground_z_m, photos, n_rays, seed)
    loose = _loose_points(scene, points)
    loose = loose[_in_sight(loose, photos, caster)]
    everything, all_normals = np.concatenate([points, loose]), np.concatenate([normals, np.zeros_like(loose)])
    pixel_m = pixel_sizes(everything, all_normals, photos)
    is_near = np.linalg.norm(everything - origin_enu_m, axis=1) <= reach_m
    beside = beside_panels(everything, scene.corners_enu_m, SAME_SURFACE_M, BESIDE_M)
    pixel_m = np.where(np.isfinite(beside.gaps_m), 1.0, coarser_around) * pixel_m
    kept = is_near & (beside.panels < 0) & np.isfinite(pixel_m)
    is_known = np.concatenate([is_known, np.zeros(len(loose), bool)])
    return SeenSurfaces(
        everything[kept],
        all_normals[kept],
        pixel_m[kept],
        is_known[kept],
        beside.gaps_m[kept],
        beside.edges_enu[kept],
    )


def _hits(
    caster: RayCaster, ground_z_m: float | None, photos: Sequence[PosedPhoto], n_rays: int, seed: int
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """What random rays of all photos meet: places, normals, and whether it is mesh or panel; else it is the ground."""
    rng = np.random.default_rng(seed)
    of_each = max(LEAST_RAYS, math.ceil(n_rays / len(photos)))
    points, normals, is_mesh = [], [], []
    for photo in photos:
        lens = photo.intrinsics
        origins, directions = photo.rays(rng.random((of_each, 2)) * (lens.width_px, lens.height_px))
        hits = caster.cast(origins, directions)
        distances, found = hits.distance_m, hits.normals_enu
        if ground_z_m is not None:
            drop, slope = origins[:, 2] - ground_z_m, np.minimum(directions[:, 2], -LEAST_SLOPE)
            on_ground = ~hits.is_hit & (directions[:, 2] < -LEAST_SLOPE) & (drop > 0.0)
            distances = np.where(on_ground, -drop / slope, distances)
            found = np.where(on_ground[:, None], (0.0, 0.0, 1.0), found)
        met = np.isfinite(distances)
        points.append(origins[met] + distances[met, None] * directions[met])
        normals.append(found[met])
        is_mesh.append(hits.is_hit[met])
    return np.concatenate(points), np.concatenate(normals), np.concatenate(is_mesh)


def _loose_points(scene: KnownScene, hits_enu_m: Array) -> Array:
    """Points that no mesh explains: further from what rays hit than those hits are from each other, twice."""
    points = scene.points_enu_m
    if not len(points) or len(hits_enu_m) < 2:
        return points
    tree = cKDTree(hits_enu_m)
    to_next, near = (np.asarray(found) for found in tree.query(points))
    between = np.asarray(tree.query(hits_enu_m[near], [2])[0])[:, 0]
    return np.asarray(points[to_next > np.maximum(2.0 * between, SAME_SURFACE_M)])


def _in_sight(points_enu_m: Array, photos: Sequence[PosedPhoto], caster: RayCaster) -> NDArray[np.bool_]:
    """Which points a photo sees, shape (n,): none that photogrammetry puts behind glass for what it mirrors."""
    found = np.zeros(len(points_enu_m), bool)
    for photo in _some(photos):
        asked = np.flatnonzero(~found)
        asked = asked[photo.sees(points_enu_m[asked])]
        towards = points_enu_m[asked] - photo.pose.position_enu_m
        lengths = np.linalg.norm(towards, axis=1)
        origins = np.broadcast_to(photo.pose.position_enu_m, towards.shape)
        free_m = caster.cast(origins, towards / lengths[:, None]).distance_m
        found[asked] = free_m > lengths - SAME_SURFACE_M
    return found


def _some(photos: Sequence[PosedPhoto]) -> list[PosedPhoto]:
    chosen = np.unique(np.linspace(0, len(photos) - 1, min(MOST_VIEWS, len(photos))).round().astype(int))
    return [photos[number] for number in chosen]


def pixel_sizes(
    points_enu_m: Array, normals_enu: Array, photos: Sequence[PosedPhoto], from_behind: bool = True
) -> Array:
    """Side of a pixel on surfaces, metres, in the photo that sees them most finely, shape (n,); inf where none does.

    Of the square that is as large as the pixel there. Where the normal is 0, the surface is taken to face the photo.

    Parameters
    ----------
    from_behind
        Whether photos behind a surface count.
    """
    finest = np.full(len(points_enu_m), np.inf)
    is_surface = np.asarray(normals_enu.any(axis=1))
    for photo in _some(photos):
        seen = np.flatnonzero(photo.sees(points_enu_m))
        towards = points_enu_m[seen] - photo.pose.position_enu_m
        depths = towards @ photo.pose.forward_enu
        cosines = -(towards * normals_enu[seen]).sum(axis=1) / np.linalg.norm(towards, axis=1)
        is_front = cosines >= 0.0
        cosines = np.where(is_surface[seen], np.maximum(np.abs(cosines), LEAST_COSINE), 1.0)
        sizes = depths / photo.intrinsics.fx_px / np.sqrt(cosines)
        finest[seen] = np.minimum(finest[seen], sizes if from_behind else np.where(is_front, sizes, np.inf))
    return finest
