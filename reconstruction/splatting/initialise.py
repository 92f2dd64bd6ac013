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

from planning.errors import InputError
from planning.progress import QUIET, Monitor
from reconstruction.cameras import PosedPhoto
from reconstruction.dataset.layers import unit_normals
from reconstruction.dataset.points import UNSEEN, ColouredPoints
from reconstruction.ray_casting import RayCaster
from reconstruction.splatting.seen_surfaces import SeenSurfaces, pixel_sizes, seen_surfaces
from reconstruction.splatting.splats import Splats
from reconstruction.splatting.start_data import KnownScene
from reconstruction.splatting.surfels import (
    Surfels,
    joined,
    n_on_panel,
    panel_surfels,
    plane_normals,
    spacings_of,
    surfels_between,
    thinned,
)

Array = NDArray[np.float64]
Pictures = Callable[[PosedPhoto], NDArray[np.uint8]]

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
        How many times further apart they are away from the panels, which are what is looked at.
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

    n_splats: int = 20_000
    finest_px: float = 1.0
    coarser_around: float = 2.0
    width: float = 0.6
    opacity: float = 0.9
    loose_opacity: float = 0.5
    reach_m: float = 1000.0
    seed: int = 0

    def __post_init__(self) -> None:
        if self.n_splats < 1:
            raise ValueError(f"n_splats: expected at least 1, got {self.n_splats}")
        for name in ("finest_px", "coarser_around", "width", "reach_m"):
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) > 0.0):
                raise ValueError(f"{name}: expected a positive number, got {getattr(self, name)}")
        for name in ("opacity", "loose_opacity"):
            if not 1.0 / 255.0 < getattr(self, name) < 1.0:
                raise ValueError(f"{name}: expected more than 1/255 and less than 1, got {getattr(self, name)}")


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
        raise InputError("there are no photos, so nobody knows how finely splats are seen; name a folder with photos")
    monitor.report("placing splats", 0, 3)
    n_rays = RAYS_PER_SPLAT * parameters.n_splats
    around, reach_m = parameters.coarser_around, parameters.reach_m
    seen = seen_surfaces(scene, photos, origin_enu_m, reach_m, n_rays, around, parameters.seed)
    monitor.report("placing splats", 1, 3)
    surfels, n_known = _placed(scene, photos, seen, parameters)
    if not len(surfels):
        raise InputError(
            f"no panel, mesh or point within {parameters.reach_m:g} m of the model's middle is seen by one of the "
            f"{len(photos)} photos; are the poses and the points in one frame?"
        )
    monitor.report("colouring splats", 2, 3)
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
    scene: KnownScene, photos: Sequence[PosedPhoto], seen: SeenSurfaces, parameters: InitialParameters
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
    is_loose = ~normals.any(axis=1)
    normals[is_loose] = plane_normals(points[is_loose], scene.points_enu_m)
    spacings = spacings_of(points, 0.7 * wanted, 1.5 * wanted)
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
            cloud.add(photos[number], pictures(photos[number])[..., ::-1], caster)
        colours[lost] = cloud.rgb
    return colours / 255.0


def _tensor(values: Array) -> torch.Tensor:
    return torch.from_numpy(np.ascontiguousarray(values, np.float32))
