"""Splats to start from: on known panels, on the refined mesh around them, and at points where there is no mesh."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.parameters import check, parameter
from planning.base.progress import QUIET, Monitor
from planning.geo.mesh import from_corners, join
from planning.geo.ray_casting import RayCaster
from planning.site.records import panel_triangles
from reconstruction.base.cameras import PosedPhoto
from reconstruction.dataset.layers import unit_normals
from reconstruction.dataset.prepare import mask_of
from reconstruction.dataset.records import UNSEEN, ColouredPoints
from reconstruction.splats.splats import Splats
from reconstruction.splats.surfels import (
    SAME_SURFACE_M,
    KnownScene,
    Surfels,
    joined,
    n_on_panel,
    panel_proximity,
    panel_surfels,
    plane_normals,
    spacings_of,
    surfels_between,
    thinned,
)

Array = NDArray[np.float64]


# Surfaces that photos see: what their rays meet of the mesh and the ground, and points that no mesh explains.

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
class VisibleSurfaces:
    """Places of surfaces, how finely they are seen, whether a surface is known there, and what panel is beside.

    Normals of loose points are 0.
    """

    points_enu_m: Array
    normals_enu: Array
    pixel_m: Array
    is_known: NDArray[np.bool_]
    gaps_m: Array
    edges_enu: Array


def visible_surfaces(
    scene: KnownScene,
    photos: Sequence[PosedPhoto],
    origin_enu_m: Array,
    reach_m: float,
    n_rays: int,
    coarser_around: float,
    seed: int,
) -> VisibleSurfaces:
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
    beside = panel_proximity(everything, scene.corners_enu_m, SAME_SURFACE_M, BESIDE_M)
    pixel_m = np.where(np.isfinite(beside.gaps_m), 1.0, coarser_around) * pixel_m
    kept = is_near & (beside.panels < 0) & np.isfinite(pixel_m)
    is_known = np.concatenate([is_known, np.zeros(len(loose), bool)])
    return VisibleSurfaces(
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
    # Hits lie in a few planes: with nodes as tight as the hits in them, hundreds of times more of those are looked into
    # from far off. Nor is it looked for further than nearly all hits explain points.
    tree = cKDTree(hits_enu_m, compact_nodes=False, balanced_tree=False)
    explained_m = np.maximum(2.0 * np.asarray(tree.query(hits_enu_m, [2])[0])[:, 0], SAME_SURFACE_M)
    usual_m = float(np.quantile(explained_m, USUALLY_EXPLAINED))
    to_next, near = (
        np.asarray(found) for found in tree.query(points, distance_upper_bound=np.nextafter(usual_m, np.inf))
    )
    is_far = near == len(hits_enu_m)
    is_loose = is_far | (to_next > explained_m[np.where(is_far, 0, near)])
    lonely, far = np.flatnonzero(explained_m > usual_m), np.flatnonzero(is_far)
    if len(lonely) and len(far):
        to_lonely, which = (np.asarray(found) for found in cKDTree(hits_enu_m[lonely]).query(points[far]))
        unsure = far[to_lonely <= explained_m[lonely[which]]]
        to_next, near = (np.asarray(found) for found in tree.query(points[unsure]))
        is_loose[unsure] = to_next > explained_m[near]
    return np.asarray(points[is_loose])


def _in_sight(points_enu_m: Array, photos: Sequence[PosedPhoto], caster: RayCaster) -> NDArray[np.bool_]:
    """Which points a photo sees, shape (n,): none that photogrammetry puts behind glass for what it mirrors."""
    found = np.zeros(len(points_enu_m), bool)
    for photo in _some(photos):
        to_check = np.flatnonzero(~found)
        to_check = to_check[photo.sees(points_enu_m[to_check])]
        towards = points_enu_m[to_check] - photo.pose.position_enu_m
        lengths = np.linalg.norm(towards, axis=1)
        origins = np.broadcast_to(photo.pose.position_enu_m, towards.shape)
        free_m = caster.cast(origins, towards / lengths[:, None]).distance_m
        found[to_check] = free_m > lengths - SAME_SURFACE_M
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


Pictures = Callable[[PosedPhoto], NDArray[np.uint8]]

USUALLY_EXPLAINED = 0.999
"""Share of hits that explain points no further off than where one is looked for first; the others lie alone."""

RAYS_PER_SPLAT = 8
"""That look for surfaces: enough for one to come near every place where a splat belongs."""

COLOUR_PHOTOS = 24
"""That colour what no point lies near."""

SIZE_STEPS = 12
"""Halvings of the range of spacings, 1 to 1000 pixels: the budget is met to half a percent."""

COARSEST_PX = 1000.0
"""A spacing at which any scene has few splats."""


@dataclass(frozen=True, slots=True)
class InitialParameters:
    """How many splats there are to begin with, and how they look.

    Parameters
    ----------
    n_splats
        About so many, over all surfaces that photos see.
    finest_px
        They are never closer than so many pixels of the photo that sees them nearest: finer ones cannot be told apart.
    coarser_around
        How many times further apart they are away from the panels, which are what is looked at. A third less on panes,
        close together along their edges alone, scored 0.3 dB less on facades.
    width
        Standard deviation of a splat, of the distance to the next. At 0.6 an even grid of opacity 0.9 covers 93 to 97 %
        of what is behind it; wider ones smear the edges of panes.
    opacity, loose_opacity
        On surfaces that are known, and of the ground and loose points, which may be wrong. Both are far above 1/255,
        below which a splat has no gradient.
    reach_m
        What is further from the model's middle is the sky's business; float32 is good to 0.1 mm there.
    seed
        Of the rays.
    """

    n_splats: int = parameter(20_000, least=1)
    finest_px: float = parameter(1.0, above=0.0)
    coarser_around: float = parameter(2.0, above=0.0)
    width: float = parameter(0.6, above=0.0)
    opacity: float = parameter(0.9, above=1.0 / 255.0, below=1.0, expected="more than 1/255 and less than 1")
    loose_opacity: float = parameter(0.5, above=1.0 / 255.0, below=1.0, expected="more than 1/255 and less than 1")
    reach_m: float = parameter(1000.0, above=0.0)
    seed: int = 0

    def __post_init__(self) -> None:
        check(self)


def initial_splats(
    scene: KnownScene,
    photos: Sequence[PosedPhoto],
    origin_enu_m: Array,
    parameters: InitialParameters | None = None,
    pictures: Pictures | None = None,
    monitor: Monitor = QUIET,
) -> Splats:
    """Splats in the model's frame, ENU less `origin_enu_m`.

    They are as close as the photos see them finely: at a distance d the spacing is s d / f, with one s for all that
    meets the budget. Rays from the photos find the mesh's surfaces and the ground, so that none is spent on what no
    photo sees.

    Parameters
    ----------
    pictures
        Gives a photo's picture (red, green, blue) where points tell no colour; without, those are grey.

    Raises
    ------
    InputError
        Nothing to start from is near the panels or in sight of a photo.
    OperationCancelled
        From `monitor`.
    """
    parameters = parameters or InitialParameters()
    if not photos:
        raise InputError(
            say("there are no photos, so nobody knows how finely splats are seen; name a folder with photos")
        )
    monitor.report(say("placing splats"), 0, 3)
    n_rays = RAYS_PER_SPLAT * parameters.n_splats
    around, reach_m = parameters.coarser_around, parameters.reach_m
    seen = visible_surfaces(scene, photos, origin_enu_m, reach_m, n_rays, around, parameters.seed)
    monitor.report(say("placing splats"), 1, 3)
    surfels, n_known = _placed(scene, photos, seen, parameters)
    if not len(surfels):
        raise InputError(
            say(
                "no panel, mesh or point within {:g} m of the model's middle is seen by one of the {} photos; "
                "are the poses and the points in one frame?",
                parameters.reach_m,
                len(photos),
            )
        )
    monitor.report(say("colouring splats"), 2, 3)
    colours = _colours(surfels, scene, photos, pictures)
    opacities = np.where(np.arange(len(surfels)) < n_known, parameters.opacity, parameters.loose_opacity)
    across = np.cross(surfels.normals_enu, surfels.tangents_enu)
    quats_xyzw = Rotation.from_matrix(np.stack([surfels.tangents_enu, across, surfels.normals_enu], axis=2)).as_quat()
    return Splats.of(
        _tensor(surfels.points_enu_m - origin_enu_m),
        _tensor(np.roll(quats_xyzw, 1, axis=1)),
        _tensor(parameters.width * surfels.spacings_m),
        _tensor(opacities),
        _tensor(colours),
        torch.from_numpy(surfels.panels),
    )


def _placed(
    scene: KnownScene, photos: Sequence[PosedPhoto], seen: VisibleSurfaces, parameters: InitialParameters
) -> tuple[Surfels, int]:
    """Surfels, known ones first, and how many those are; one spacing in pixels for all, found by halving."""
    corners = scene.corners_enu_m
    panel_px = _panel_pixels(corners, photos)
    in_sight = np.isfinite(panel_px)
    corners, panel_px, numbers = corners[in_sight], panel_px[in_sight], np.flatnonzero(in_sight).astype(np.int32)

    def count(spacing_px: float) -> int:
        columns, rows = n_on_panel(corners, spacing_px * panel_px)
        return int((columns * rows).sum()) + len(thinned(seen.points_enu_m, spacing_px * seen.pixel_m, seen.gaps_m))

    low, high = math.log(parameters.finest_px), math.log(max(COARSEST_PX, 2.0 * parameters.finest_px))
    if count(math.exp(low)) > parameters.n_splats:
        for _ in range(SIZE_STEPS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if count(math.exp(middle)) > parameters.n_splats else (low, middle)
        low = high
    spacing_px = math.exp(low)
    on_glass = panel_surfels(corners, spacing_px * panel_px)
    glass = Surfels(
        on_glass.points_enu_m,
        on_glass.normals_enu,
        on_glass.tangents_enu,
        on_glass.spacings_m,
        numbers[on_glass.panels],
    )
    kept = thinned(seen.points_enu_m, spacing_px * seen.pixel_m, seen.gaps_m)
    kept = kept[np.argsort(~seen.is_known[kept], kind="stable")]
    points, wanted = seen.points_enu_m[kept], spacing_px * seen.pixel_m[kept]
    normals = seen.normals_enu[kept].copy()
    is_loose = np.asarray(~normals.any(axis=1))
    normals[is_loose] = plane_normals(points[is_loose], scene.points_enu_m)
    spacings = spacings_of(points, 0.7 * wanted, 1.5 * wanted, is_loose)
    around = surfels_between(points, normals, spacings, seen.gaps_m[kept], seen.edges_enu[kept])
    return joined([glass, around]), len(glass) + int(seen.is_known[kept].sum())


def _panel_pixels(corners_enu_m: Array, photos: Sequence[PosedPhoto]) -> Array:
    """Pixel size on panels, shape (m,), of the photo before them that sees their middle or a corner most finely."""
    if not len(corners_enu_m):
        return np.zeros(0)
    places = np.concatenate([corners_enu_m.mean(axis=1, keepdims=True), corners_enu_m], axis=1)
    normals = np.repeat(unit_normals(corners_enu_m), 5, axis=0)
    return np.asarray(pixel_sizes(places.reshape(-1, 3), normals, photos, from_behind=False).reshape(-1, 5).min(axis=1))


def _colours(surfels: Surfels, scene: KnownScene, photos: Sequence[PosedPhoto], pictures: Pictures | None) -> Array:
    """Display values, shape (n, 3), 0 to 1: of the next point if it is near, else of the photos, else grey."""
    colours = np.full((len(surfels), 3), float(UNSEEN))
    found = np.zeros(len(surfels), bool)
    if len(scene.points_enu_m):
        distance, near = (np.asarray(part) for part in cKDTree(scene.points_enu_m).query(surfels.points_enu_m))
        found = distance <= 2.0 * surfels.spacings_m.max(axis=1)
        colours[found] = scene.rgb[near[found]]
    if pictures is not None and not found.all():
        lost = np.flatnonzero(~found)
        cloud = ColouredPoints(surfels.points_enu_m[lost])
        caster = RayCaster(scene.mesh)
        for number in np.unique(np.linspace(0, len(photos) - 1, min(COLOUR_PHOTOS, len(photos))).astype(int)):
            photo = photos[number]
            valid = None if photo.mask is None else mask_of(photo)
            cloud.add(photo, pictures(photo)[..., ::-1], caster, valid)
        colours[lost] = cloud.rgb
    return colours / 255.0


def _tensor(values: Array) -> torch.Tensor:
    return torch.from_numpy(np.ascontiguousarray(values, np.float32))
