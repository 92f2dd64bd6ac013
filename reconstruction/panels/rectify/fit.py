"""Planes and cylinders fitted to the points of a coarse model, with outliers, covariance, and which of the two it is.

The cylinder is the surface of `surface.py`: five parameters around a tangent plane, so that the fit is as well
conditioned for a wall that is flat as for a half round tower. Glass leaves dents, bulges and holes in a coarse model:
the loss grows with the logarithm of the distance (Cauchy), after a start that counts inliers only.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.base.messages import say
from reconstruction.panels.rectify.surface import FacadeSurface

Array = NDArray[np.float64]

LEVEL_RAD = math.radians(0.1)
"""Standard deviation of a cylinder's axis about the upright (or level) line in its tangent plane: facades are built
plumb to about 1 in 1000. Only this prior says which way a plane is up, and for a facade that is nearly flat a wider one
would turn its grid by as much: 3 degrees bent rows by 3 px. Where the facade is round, the points say more."""

MIN_POINTS = 6
N_TRIALS = 200
"""Random triples tried for the first plane: with half the points outliers, one of 200 is free of them but for 2e-12."""

MAX_EVALUATIONS = 200

VERTICAL_SLOPE = 0.7
"""Planes whose normal rises more than this (sine) are roofs: up is then towards the north, not towards the sky."""


@dataclass(frozen=True, slots=True)
class FitParameters:
    """How surfaces are fitted.

    Parameters
    ----------
    noise_m
        Distance of a good point from the true surface, one standard deviation: that of a photogrammetric mesh of a
        facade flown at 10 to 30 m. The fit itself finds the real one; this is where distances begin to look large.
    max_points
        Points used, drawn evenly: more do not make the result better than its model.
    """

    noise_m: float = 0.05
    max_points: int = 4000
    seed: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceFit:
    """A fitted surface.

    Parameters
    ----------
    surface
        Its anchor lies in the middle of the points.
    covariance
        Shape (5, 5) or, for a plane, (3, 3): of the offset along the normal (m), the turns about right and up (rad)
        and, for a cylinder, the turn about the normal (rad) and the curvature (1/m).
    noise_m
        Robust standard deviation of the points about the surface (1.4826 times the median of their distances).
    n_points
        That were used.
    inliers
        Share of points within three times `noise_m`.
    """

    surface: FacadeSurface
    covariance: Array
    noise_m: float
    n_points: int
    inliers: float

    @property
    def curvature_sigma_per_m(self) -> float:
        """Standard deviation of the curvature; 0 for a plane."""
        return math.sqrt(self.covariance[4, 4]) if len(self.covariance) == 5 else 0.0

    @property
    def curvature_significance(self) -> float:
        """Curvature in standard deviations; 0 for a plane."""
        sigma = self.curvature_sigma_per_m
        return abs(self.surface.curvature_per_m) / sigma if sigma > 0.0 else 0.0


def fit_plane(points_enu_m: Array, outside_enu_m: Array, parameters: FitParameters | None = None) -> SurfaceFit:
    """Plane through points.

    Parameters
    ----------
    points_enu_m
        Shape (n, 3).
    outside_enu_m
        A place in front of the facade, shape (3,), such as a camera's.

    Raises
    ------
    InfeasibleError
        There are fewer than six points, or they lie on a line.
    """
    parameters = parameters or FitParameters()
    points = _sample(points_enu_m, parameters)
    start = _first_plane(points, np.asarray(outside_enu_m, float), parameters)
    return _refined(start, points, parameters, n_free=3)


def fit_cylinder(points_enu_m: Array, outside_enu_m: Array, parameters: FitParameters | None = None) -> SurfaceFit:
    """Cylinder through points, upright or level, whichever fits better; arguments and errors as in `fit_plane`."""
    parameters = parameters or FitParameters()
    points = _sample(points_enu_m, parameters)
    plane = _first_plane(points, np.asarray(outside_enu_m, float), parameters)
    quarter = FacadeSurface(plane.anchor_enu_m, plane.up_enu, -plane.right_enu)
    fits = [_refined(_first_curvature(start, points), points, parameters, n_free=5) for start in (plane, quarter)]
    upright, level = fits
    return level if level.noise_m < 0.8 * upright.noise_m and level.curvature_significance > 5.0 else upright


def _sample(points_enu_m: Array, parameters: FitParameters) -> Array:
    points = np.atleast_2d(np.asarray(points_enu_m, float))
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"points_enu_m: expected shape (n, 3), got {points.shape}")
    points = np.asarray(points[np.isfinite(points).all(axis=1)], float)
    if len(points) < MIN_POINTS:
        raise InfeasibleError(
            say("a surface needs at least {} points of the coarse model, found {}", MIN_POINTS, len(points))
        )
    if len(points) <= parameters.max_points:
        return points
    chosen = np.random.default_rng(parameters.seed).choice(len(points), parameters.max_points, replace=False)
    return np.asarray(points[np.sort(chosen)], float)


def _first_plane(points: Array, outside: Array, parameters: FitParameters) -> FacadeSurface:
    """Plane with the smallest median distance among random triples, then through its nearer half of the points."""
    rng = np.random.default_rng(parameters.seed)
    middle = np.median(points, axis=0)
    centred = points - middle
    triples = centred[np.stack([rng.choice(len(points), 3, replace=False) for _ in range(N_TRIALS)])]
    normals = np.cross(triples[:, 1] - triples[:, 0], triples[:, 2] - triples[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    size = float(np.abs(centred).max())
    if size == 0.0 or lengths.max() < 1e-9 * size * size:
        raise InfeasibleError(say("the points of the coarse model lie on a line: they do not make a surface"))
    good = lengths > 1e-3 * lengths.max()
    normals, offsets = normals[good] / lengths[good, None], triples[good, 0]
    distances = np.abs(centred @ normals.T - (offsets * normals).sum(axis=1))
    best = int(np.median(distances, axis=0).argmin())
    near = centred[distances[:, best] <= np.median(distances[:, best])]
    return _frame(near, middle, outside)


def _frame(near: Array, middle: Array, outside: Array) -> FacadeSurface:
    centre = near.mean(axis=0)
    _, spread, axes = np.linalg.svd(near - centre, full_matrices=False)
    if spread[1] < 1e-6 * spread[0]:
        raise InfeasibleError(say("the points of the coarse model lie on a line: they do not make a surface"))
    normal = axes[2]
    normal = normal if normal @ (outside - middle - centre) > 0.0 else -normal
    upwards = np.array([0.0, 0.0, 1.0]) if abs(normal[2]) < VERTICAL_SLOPE else np.array([0.0, 1.0, 0.0])
    right = np.cross(upwards, normal)
    right /= np.linalg.norm(right)
    return FacadeSurface(middle + centre, right, np.cross(normal, right))


def _first_curvature(plane: FacadeSurface, points: Array) -> FacadeSurface:
    """Curvature by a parabola through the points, its weight on the inner half of the distances."""
    x = (points - plane.anchor_enu_m) @ plane.right_enu
    z = (points - plane.anchor_enu_m) @ plane.normal_enu
    scale = max(float(np.abs(x).max()), 1e-9)
    basis = np.column_stack([np.ones_like(x), x / scale, (x / scale) ** 2])
    keep = np.ones(len(x), bool)
    coefficients: Array = np.zeros(3)
    for _ in range(5):
        coefficients = np.asarray(np.linalg.lstsq(basis[keep], z[keep], rcond=None)[0], float)
        distance = np.abs(z - basis @ coefficients)
        keep = distance <= max(2.0 * float(np.median(distance)), 1e-9)
    curvature = -2.0 * float(coefficients[2]) / scale**2
    return FacadeSurface(plane.anchor_enu_m, plane.right_enu, plane.up_enu, curvature)


def _refined(start: FacadeSurface, points: Array, parameters: FitParameters, n_free: int) -> SurfaceFit:
    """Least squares from a start; lengths are counted in the patch's half size, so that all parameters are alike."""
    from scipy.optimize import least_squares

    size = max(float(np.abs(points - start.anchor_enu_m).max()), 1e-9)
    unit = np.array([size, 1.0, 1.0, 1.0, 1.0 / size])[:n_free]
    noise, fitted, surface = parameters.noise_m, None, start
    for _ in range(2):

        def residuals(change: Array, base: FacadeSurface = surface, sigma: float = noise) -> Array:
            moved = changed(base, change * unit)
            prior = [] if n_free == 3 else [_lean(moved, start) / LEVEL_RAD]
            return np.concatenate([moved.height_m(points) / sigma, prior])

        fitted = least_squares(
            residuals, np.zeros(n_free), loss="cauchy", x_scale="jac", max_nfev=MAX_EVALUATIONS, xtol=1e-12
        )
        surface = _centred(changed(surface, fitted.x * unit), points)
        noise = _noise_m(surface, points)
    jacobian = _jacobian(surface, points, n_free) / noise
    inside = np.abs(surface.height_m(points)) <= 3.0 * noise
    information = jacobian[inside].T @ jacobian[inside]
    if n_free == 5:
        information[3, 3] += LEVEL_RAD**-2
    covariance = np.asarray(np.linalg.pinv(information, hermitian=True), float)
    return SurfaceFit(surface, covariance, noise, len(points), float(inside.mean()))


def _noise_m(surface: FacadeSurface, points: Array) -> float:
    return max(1.4826 * float(np.median(np.abs(surface.height_m(points)))), 1e-9)


def _lean(surface: FacadeSurface, start: FacadeSurface) -> float:
    return float(surface.up_enu @ start.right_enu)


def changed(surface: FacadeSurface, change: Array) -> FacadeSurface:
    """Moved along the normal, turned about right, up and the normal, and bent: the five parameters in this order."""
    from scipy.spatial.transform import Rotation

    right, up, normal = surface.right_enu, surface.up_enu, surface.normal_enu
    full = np.zeros(5)
    full[: len(change)] = change
    turn = Rotation.from_rotvec(full[1] * right + full[2] * up + full[3] * normal)
    axes = turn.apply(np.stack([right, up]))
    return FacadeSurface(
        surface.anchor_enu_m + full[0] * normal, axes[0], axes[1], surface.curvature_per_m + float(full[4])
    )


def _centred(surface: FacadeSurface, points: Array) -> FacadeSurface:
    """Anchor at the middle of the points, so that offset, turns and curvature are as independent as they can be."""
    st = surface.to_surface(points)
    low, high = np.nanpercentile(st, 1.0, axis=0), np.nanpercentile(st, 99.0, axis=0)
    middle = 0.5 * (low + high)
    return surface.moved(float(middle[0]), float(middle[1]))


def _jacobian(surface: FacadeSurface, points: Array, n_free: int) -> Array:
    """Of heights by the five parameters, central differences in steps of the patch's size, shape (n, n_free)."""
    size = max(float(np.abs(points - surface.anchor_enu_m).max()), 1e-9)
    steps = 1e-5 * np.array([size, 1.0, 1.0, 1.0, 1.0 / size])[:n_free]
    columns = []
    for index, step in enumerate(steps):
        change = np.zeros(n_free)
        change[index] = step
        ahead, behind = changed(surface, change).height_m(points), changed(surface, -change).height_m(points)
        columns.append((ahead - behind) / (2.0 * step))
    return np.stack(columns, axis=1)
