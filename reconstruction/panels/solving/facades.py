"""Facades of a building, brought together from what single photos show of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Decision, EffectSetting, decide
from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.rectify.curvature import Curvature, FittedFacade
from reconstruction.panels.rectify.fit import FitParameters, SurfaceFit, fit_cylinder, fit_plane
from reconstruction.panels.rectify.patches import FacadePatch
from reconstruction.panels.rectify.surface import FacadeSurface

Array = NDArray[np.float64]

SAME_SURFACE_M = 0.5
"""Median distance of one patch's points from another's surface up to which they may be one facade."""

SAME_SIDE = 0.9
"""Cosine between the normals of two patches of one facade where they meet."""

GAP_M = 3.0
"""Two parts of one wall further apart than this are two facades."""

SQUARE_ON = 0.4
"""Least cosine between the line of sight and the facade's normal for a photo to be searched for lines."""


@dataclass(frozen=True, slots=True, eq=False)
class Facade:
    """A facade and the photos that show it.

    Parameters
    ----------
    low_st_m, high_st_m
        Its extent on `fit.surface`, shape (2,).
    curvature
        Why that surface is a plane or a cylinder.
    photos
        Numbers of the photos that show it, the most useful first.
    """

    fit: SurfaceFit
    low_st_m: Array
    high_st_m: Array
    curvature: Decision
    photos: tuple[int, ...]


def building_facades(
    photos: Sequence[PosedPhoto],
    patches: Sequence[Sequence[FacadePatch]],
    curvature: EffectSetting = "auto",
    parameters: FitParameters | None = None,
) -> tuple[Facade, ...]:
    """Facades out of the patches of all photos, the one with the most points first.

    Parameters
    ----------
    patches
        Of each photo, as `facades_in_photo` finds them.
    """
    clusters: list[list[tuple[int, FacadePatch]]] = []
    listed = [(number, patch) for number, found in enumerate(patches) for patch in found]
    for number, patch in sorted(listed, key=lambda item: -item[1].share):
        home = next((cluster for cluster in clusters if any(_same(patch, other) for _, other in cluster)), None)
        if home is None:
            clusters.append([(number, patch)])
        else:
            home.append((number, patch))
    clusters.sort(key=lambda cluster: -sum(patch.share for _, patch in cluster))
    return tuple(_facade(photos, cluster, curvature, parameters or FitParameters()) for cluster in clusters)


def _same(one: FacadePatch, other: FacadePatch) -> bool:
    """Whether two patches lie on one surface, from both sides of the comparison, and touch or overlap."""
    return all(_lies_on(a, b) for a, b in ((one, other), (other, one)))


def _lies_on(patch: FacadePatch, other: FacadePatch) -> bool:
    surface = other.cylinder.surface
    st = surface.to_surface(patch.points_enu_m)
    inside = (st >= other.low_st_m - GAP_M) & (st <= other.high_st_m + GAP_M)
    near = np.asarray(inside.all(axis=1))
    if near.sum() < max(6, 0.02 * len(near)):
        return False
    close = float(np.median(np.abs(surface.height_m(patch.points_enu_m[near])))) < SAME_SURFACE_M
    own = patch.cylinder.surface
    facing = (own.normals_at(own.to_surface(patch.points_enu_m[near])) * surface.normals_at(st[near])).sum(axis=1)
    return close and float(np.median(facing)) > SAME_SIDE


def _facade(
    photos: Sequence[PosedPhoto], cluster: list[tuple[int, FacadePatch]], wish: EffectSetting, parameters: FitParameters
) -> Facade:
    points = np.concatenate([patch.points_enu_m for _, patch in cluster])
    camera = np.mean([photos[number].pose.position_enu_m for number, _ in cluster], axis=0)
    plane, cylinder = fit_plane(points, camera, parameters), fit_cylinder(points, camera, parameters)
    low, high = _extent(cylinder.surface, points)
    scenes = [FittedFacade(photos[number], plane, cylinder, low, high) for number, _ in cluster]
    decision = max((decide(Curvature(), scene, wish) for scene in scenes), key=lambda found: found.size)
    fit = cylinder if decision.on else plane
    low, high = _extent(fit.surface, points)
    numbers = sorted(
        {number for number, _ in cluster}, key=lambda number: -_use(photos[number], fit.surface, low, high)
    )
    useful = tuple(number for number in numbers if _use(photos[number], fit.surface, low, high) > 0.0)
    return Facade(fit, low, high, decision, useful)


def _extent(surface: FacadeSurface, points: Array) -> tuple[Array, Array]:
    st = surface.to_surface(points)
    near = np.abs(surface.height_m(points)) < SAME_SURFACE_M
    return np.asarray(np.nanmin(st[near], axis=0), float), np.asarray(np.nanmax(st[near], axis=0), float)


def _use(photo: PosedPhoto, surface: FacadeSurface, low: Array, high: Array) -> float:
    """Pixels that a photo spends on the facade: of places on it, each weighed by its area in the photo."""
    s, t = np.meshgrid(np.linspace(low[0], high[0], 12), np.linspace(low[1], high[1], 12))
    st = np.column_stack([s.ravel(), t.ravel()])
    points = surface.to_enu(st)
    towards = photo.pose.position_enu_m - points
    distance = np.linalg.norm(towards, axis=1)
    cosine = (towards * surface.normals_at(st)).sum(axis=1) / np.maximum(distance, 1e-9)
    seen = photo.sees(points) & (cosine > SQUARE_ON)
    return float((cosine[seen] / distance[seen] ** 2).sum()) * photo.intrinsics.fx_px**2
