"""Facades that a photo shows, found in the coarse model: one surface each, with its place in the photo.

The paper takes a photo that shows one facade and nothing else. Here rays through a grid of pixels are cast onto the
coarse model, and upright planes and cylinders are found among the points they hit, the largest first: the outline of
an upright surface, seen from above, is a line or a circle, and three points make one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.mesh import TriangleMesh
from reconstruction.base.cameras import PosedPhoto
from reconstruction.base.ray_casting import RayCaster
from reconstruction.panels.rectify.curvature import FittedFacade
from reconstruction.panels.rectify.fit import FitParameters, SurfaceFit, fit_cylinder, fit_plane
from reconstruction.panels.rectify.surface import FacadeSurface

Array = NDArray[np.float64]
Labels = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class PatchParameters:
    """How facades are looked for.

    Parameters
    ----------
    rays
        Along the photo's longer side.
    tolerance_m
        Distance of a point from a facade it belongs to: dents of a coarse model on glass are of this size.
    least_share
        Of the rays that hit anything; smaller surfaces are no facades.
    turned_rad
        Angle between a triangle and the facade up to which it may belong to it.
    trials, judges
        Surfaces that are tried for each facade, and points that each is tried on.
    """

    rays: int = 120
    tolerance_m: float = 0.4
    least_share: float = 0.04
    turned_rad: float = math.radians(35.0)
    trials: int = 300
    judges: int = 1200
    max_facades: int = 6
    seed: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class FacadePatch:
    """One facade in a photo.

    Parameters
    ----------
    plane, cylinder
        Both fits to its points; `fitted` asks the scene which is called for.
    low_st_m, high_st_m
        Its extent on the cylinder, shape (2,), metres; what lies outside the photo is not part of it.
    outline_px
        Convex outline in the photo, shape (n, 2).
    share
        Of the rays that hit the model.
    points_enu_m
        Points of the model on it, one for each ray, shape (n, 3).
    """

    plane: SurfaceFit
    cylinder: SurfaceFit
    low_st_m: Array
    high_st_m: Array
    outline_px: Array
    share: float
    points_enu_m: Array

    def fitted(self, photo: PosedPhoto) -> FittedFacade:
        """The scene that the effect `curvature.Curvature` looks at."""
        return FittedFacade(photo, self.plane, self.cylinder, self.low_st_m, self.high_st_m)


@dataclass(frozen=True, slots=True, eq=False)
class _Hits:
    pixels: Array
    points: Array
    normals: Array
    cells: Labels
    shape: tuple[int, int]


def facades_in_photo(
    photo: PosedPhoto, model: TriangleMesh, parameters: PatchParameters | None = None, monitor: Monitor = QUIET
) -> tuple[FacadePatch, ...]:
    """Upright facades that a photo shows, the largest first; none where it shows none.

    Parameters
    ----------
    model
        The coarse model of the building, ENU.
    """
    parameters = parameters or PatchParameters()
    monitor.report(say("casting rays"), 0, 1)
    hits = _cast(photo, model, parameters.rays)
    left = np.ones(len(hits.points), bool)
    least = max(12, int(parameters.least_share * len(hits.points)))
    rng = np.random.default_rng(parameters.seed)
    found: list[FacadePatch] = []
    while len(found) < parameters.max_facades and left.sum() >= least:
        monitor.report(say("looking for facades"), len(found), parameters.max_facades)
        inside = _largest(hits, left, photo.pose.position_enu_m, parameters, rng)
        if inside.sum() < least:
            break
        found.append(_patch(hits, inside, photo, parameters))
        left &= ~inside
    return tuple(sorted(found, key=lambda patch: -patch.share))


def _cast(photo: PosedPhoto, model: TriangleMesh, rays: int) -> _Hits:
    w, h = photo.intrinsics.width_px, photo.intrinsics.height_px
    step = max(w, h) / rays
    nx, ny = max(2, round(w / step)), max(2, round(h / step))
    x, y = np.meshgrid((np.arange(nx) + 0.5) * w / nx, (np.arange(ny) + 0.5) * h / ny)
    pixels = np.column_stack([x.ravel(), y.ravel()])
    origins, directions = photo.rays(pixels)
    answer = RayCaster(model).cast(origins, directions)
    hit = answer.is_hit
    points = origins[hit] + answer.distance_m[hit, None] * directions[hit]
    return _Hits(pixels[hit], points, answer.normals_enu[hit], np.flatnonzero(hit).astype(np.int64), (ny, nx))


def _largest(
    hits: _Hits, left: NDArray[np.bool_], camera: Array, parameters: PatchParameters, rng: np.random.Generator
) -> NDArray[np.bool_]:
    """Points of the connected upright surface that most of the points left lie on."""
    upright = np.flatnonzero(left & (np.abs(hits.normals[:, 2]) < 0.7))
    best = np.zeros(len(left), bool)
    if len(upright) < 3:
        return best
    judges = np.flatnonzero(left)
    judges = judges[rng.permutation(len(judges))[: parameters.judges]]
    most, winner = 0, None
    for _ in range(parameters.trials):
        surface = _through(hits.points[_near_triple(hits, upright, rng)], camera)
        if surface is None:
            continue
        supporters = int(_belongs(surface, hits.points[judges], hits.normals[judges], parameters).sum())
        if supporters > most:
            most, winner = supporters, surface
    if winner is None:
        return best
    best = left & _belongs(winner, hits.points, hits.normals, parameters)
    for _ in range(3):
        connected = _connected(best, hits)
        if connected.sum() < 12:
            return connected
        fit = fit_cylinder(
            hits.points[connected], camera, FitParameters(noise_m=0.5 * parameters.tolerance_m, max_points=1500)
        )
        best = left & _belongs(fit.surface, hits.points, hits.normals, parameters)
    return _connected(best, hits)


def _near_triple(hits: _Hits, upright: Labels, rng: np.random.Generator) -> Labels:
    """Three points of one neighbourhood, of a random size: those of one facade are near each other in the photo."""
    first = int(rng.choice(upright))
    x, y = np.abs(hits.pixels[upright] - hits.pixels[first]).T
    distance = np.maximum(x, y)
    reach = float(rng.uniform(0.05, 1.0)) * float(distance.max())
    near = upright[distance <= reach]
    if len(near) < 3:
        near = upright
    return np.asarray(rng.choice(near, 3, replace=len(near) < 3), np.int64)


def _through(points: Array, camera: Array) -> FacadeSurface | None:
    """Upright cylinder through three points, None where they make none that could be a facade.

    Seen from above as complex numbers, the tangent in b of the circle through a, b and c is (b - a)(c - b) / (c - a),
    and its curvature is twice the sine of the turn at b over |c - a|.
    """
    plan = points[:, 0] + 1j * points[:, 1]
    chord = plan[2] - plan[0]
    a, b, c = plan[np.argsort((plan * np.conj(chord)).real, kind="stable")]
    if min(abs(b - a), abs(c - b), abs(c - a)) < 1e-6:
        return None
    tangent = (b - a) * (c - b) / (c - a)
    tangent /= abs(tangent)
    turn = (np.conj(b - a) * (c - b)).imag
    curvature = 2.0 * turn / (abs(b - a) * abs(c - b) * abs(c - a))
    right, up = np.array([tangent.real, tangent.imag, 0.0]), np.array([0.0, 0.0, 1.0])
    anchor = np.array([b.real, b.imag, points[:, 2].mean()])
    if np.cross(right, up) @ (camera - anchor) < 0.0:
        right, curvature = -right, -curvature
    return FacadeSurface(anchor, right, up, float(curvature))


def _belongs(surface: FacadeSurface, points: Array, normals: Array, parameters: PatchParameters) -> NDArray[np.bool_]:
    near = np.abs(surface.height_m(points)) <= parameters.tolerance_m
    facing = (surface.normals_at(surface.to_surface(points)) * normals).sum(axis=1) >= math.cos(parameters.turned_rad)
    return np.asarray(near & facing)


def _connected(inside: NDArray[np.bool_], hits: _Hits) -> NDArray[np.bool_]:
    """The largest part that hangs together in the photo; single missing rays do not part it."""
    picture = np.zeros(hits.shape, np.uint8)
    picture.ravel()[hits.cells[inside]] = 1
    closed = cv2.morphologyEx(picture, cv2.MORPH_CLOSE, np.ones((3, 3), np.uint8))
    count, labels, stats, _ = cv2.connectedComponentsWithStats(np.asarray(closed, np.uint8), connectivity=8)
    if count < 2:
        return np.zeros_like(inside)
    largest = 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA]))
    return np.asarray(inside & (np.asarray(labels).ravel()[hits.cells] == largest))


def _patch(hits: _Hits, inside: NDArray[np.bool_], photo: PosedPhoto, parameters: PatchParameters) -> FacadePatch:
    points, camera = hits.points[inside], photo.pose.position_enu_m
    fitting = FitParameters(noise_m=0.5 * parameters.tolerance_m, seed=parameters.seed)
    plane, cylinder = fit_plane(points, camera, fitting), fit_cylinder(points, camera, fitting)
    st = cylinder.surface.to_surface(points)
    outline = cv2.convexHull(np.asarray(hits.pixels[inside], np.float32))[:, 0]
    return FacadePatch(
        plane,
        cylinder,
        np.asarray(np.nanmin(st, axis=0), float),
        np.asarray(np.nanmax(st, axis=0), float),
        np.asarray(outline, float),
        float(inside.sum() / len(inside)),
        points,
    )
