"""Planes and cylinders fitted to the points of a coarse model, with outliers, covariance, and which of the two it is.

The cylinder is the surface of `surface.py`: five parameters around a tangent plane, so that the fit is as well
conditioned for a wall that is flat as for a half round tower. Glass leaves dents, bulges and holes in a coarse model:
the loss grows with the logarithm of the distance (Cauchy), after a start that counts inliers only.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment, Decision, EffectSetting, decide
from planning.base.errors import InfeasibleError
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.mesh import TriangleMesh
from planning.geo.ray_casting import RayCaster
from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.rectify.surface import FacadeSurface, Rectification, polynomial_view
from reconstruction.panels.rectify.view import SurfaceView, TangentView, surface_view

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
    """

    surface: FacadeSurface
    covariance: Array
    noise_m: float
    n_points: int

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
    return SurfaceFit(surface, covariance, noise, len(points))


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


# Which rectification a facade calls for: none but a plane's, or a cylinder's; unrolled, or flattened as in the paper.
#
# Two effects, each with its size in pixels of the rectified picture.

ViewKind = Literal["auto", "exact", "tangent", "polynomial"]
"""How a photo is rectified; `auto` leaves it to the scene."""

VIEW_KINDS: tuple[ViewKind, ...] = get_args(ViewKind)

BENT_LINE_PX = 0.5
"""Tolerance of both effects: lines are found to about half a pixel."""

SIGNIFICANT = 5.0
"""Standard deviations from which on a fitted curvature is believed. The points of a mesh are not independent of each
other, so that the usual three are reached by flat walls, too."""

GRID = 25
COST_S_PER_MEGAPIXEL = 0.02
"""Extra time for a curved map, which is not a homography: measured on a 20-megapixel photo."""


@dataclass(frozen=True, slots=True, eq=False)
class FittedFacade:
    """A photo and the two surfaces fitted to the part of the coarse model that it shows.

    `low_st_m` and `high_st_m` are the facade's extent on the cylinder, shape (2,).
    """

    photo: PosedPhoto
    plane: SurfaceFit
    cylinder: SurfaceFit
    low_st_m: Array
    high_st_m: Array


@dataclass(frozen=True, slots=True)
class Curvature:
    """Take the facade for a cylinder: otherwise its straight rows or columns would be bent in the rectified view."""

    name: str = "facade curvature"
    unit: str = "px"
    tolerance: float = BENT_LINE_PX

    def assess(self, scene: FittedFacade) -> Assessment:
        """How far lines of the grid would be off a straight row or column if the facade were taken for a plane."""
        megapixels = scene.photo.intrinsics.width_px * scene.photo.intrinsics.height_px / 1e6
        cost_s = COST_S_PER_MEGAPIXEL * megapixels
        significance = scene.cylinder.curvature_significance
        if significance < SIGNIFICANT:
            return Assessment(
                0.0, say("its curvature is {:.1f} standard deviations, which is noise", significance), cost_s
            )
        size = bent_by_px(scene)
        radius = 1.0 / abs(scene.cylinder.surface.curvature_per_m)
        return Assessment(
            size, say("a radius of {:.1f} m bends lines of the grid by up to {:.1f} px", radius, size), cost_s
        )


@dataclass(frozen=True, slots=True)
class Unrolling:
    """Unroll by arc length instead of flattening onto the tangent plane, which squeezes the outer columns."""

    name: str = "unrolling by arc length"
    unit: str = "px"
    tolerance: float = BENT_LINE_PX

    def assess(self, scene: SurfaceView) -> Assessment:
        """How far the outermost column of the tangent plane is from where arc length puts it."""
        half_width_m = float(0.5 * (scene.high_st_m[0] - scene.low_st_m[0]))
        angle = abs(scene.surface.curvature_per_m) * half_width_m
        squeezed_m = half_width_m * (1.0 - float(np.sinc(min(angle, 0.5 * np.pi) / np.pi)))
        size = squeezed_m * scene.px_per_m
        return Assessment(size, say("the window spans {:.1f} degrees of the cylinder", np.degrees(2.0 * angle)), 0.0)


def decide_view(views: Sequence[SurfaceView], kind: ViewKind = "auto") -> Decision:
    """Whether photos of a facade are unrolled by arc length: the decision of the photo that it changes most."""
    setting: EffectSetting = "auto" if kind == "auto" else "on" if kind == "exact" else "off"
    return max((decide(Unrolling(), view, setting) for view in views), key=lambda found: found.size)


def drawn_view(view: SurfaceView, kind: ViewKind, unrolling: Decision) -> Rectification:
    """The view that a photo is rectified by.

    Raises
    ------
    InfeasibleError
        A polynomial is asked for, and too little of the view is seen in the photo.
    """
    if unrolling.on or (view.surface.is_flat and kind != "polynomial"):
        return view
    flattened = TangentView(view)
    return polynomial_view(flattened) if kind == "polynomial" else flattened


def bent_by_px(scene: FittedFacade) -> float:
    """Largest distance of a grid line from the straight row or column that fits it best in the plane's view, pixels.

    0 where the photo does not show the facade.
    """
    plane_view = surface_view(scene.photo, scene.plane.surface)
    s = np.linspace(scene.low_st_m[0], scene.high_st_m[0], GRID)
    t = np.linspace(scene.low_st_m[1], scene.high_st_m[1], GRID)
    st = np.stack(np.meshgrid(s, t), axis=-1)
    points = scene.cylinder.surface.to_enu(st.reshape(-1, 2))
    hits = scene.plane.surface.hits(*scene.photo.rays(scene.photo.pixels(points)))
    seen = scene.photo.sees(points) & np.isfinite(hits).all(axis=1)
    places = np.where(seen[:, None], hits, np.nan).reshape(GRID, GRID, 2) * plane_view.px_per_m
    columns = _off_straight(places[..., 0].T)
    rows = _off_straight(places[..., 1])
    return max(columns, rows)


def _off_straight(lines: Array) -> float:
    """Half the range of each line's coordinate, the largest of all lines; NaN are left out."""
    seen = lines[np.isfinite(lines).sum(axis=1) >= 2]
    return float((0.5 * (np.nanmax(seen, axis=1) - np.nanmin(seen, axis=1))).max()) if len(seen) else 0.0


# Facades that a photo shows, found in the coarse model: one surface each, with its place in the photo.
#
# The paper takes a photo that shows one facade and nothing else. Here rays through a grid of pixels are cast onto the
# coarse model, and upright planes and cylinders are found among the points they hit, the largest first: the outline
# of
# an upright surface, seen from above, is a line or a circle, and three points make one.

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
