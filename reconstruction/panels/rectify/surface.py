"""The surface that a facade's panels stand on: a plane, or a cylinder of any curvature, as one stable formula.

A cylinder is described by a point on it and its curvature instead of its axis and radius. A plane is then nothing
special (curvature 0), and a facade that is nearly flat has a small curvature instead of a radius that runs away.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.base.messages import say

Array = NDArray[np.float64]


# What every rectification of a photo is: a map in both directions.


class Rectification(Protocol):
    """A map between a photo and its fronto-parallel view, where grid lines run along rows and columns.

    Coordinates of both are continuous pixels as in `reconstruction.base.cameras`. Points may lie outside both pictures;
    where the map does not exist (behind the horizon of a plane, beyond the rim of a cylinder) the result is NaN.
    """

    @property
    def width_px(self) -> int:
        """Of the rectified picture."""

    @property
    def height_px(self) -> int:
        """Of the rectified picture."""

    def to_photo(self, points_px: Array) -> Array:
        """Points of the rectified picture, shape (n, 2), in the photo."""

    def to_rectified(self, points_px: Array) -> Array:
        """Points of the photo, shape (n, 2), in the rectified picture."""


# The paper's seventh-order polynomial between a photo of a curved facade and its flattened view (Eq. 2).
#
# Pixels are centred and scaled to [-1, 1] first: raw ones to the seventh power (5280^7, about 1e26) leave a float64
# least
# squares nothing to work with. The way back is a fit of its own, not an inversion.

DEGREE = 7
SAMPLES = 40
"""Points per side of the grid that a polynomial view is fitted to."""

FAR = 1.2
"""Reach of a polynomial, of half the fitted range: outside it runs away and means nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class PolynomialMap:
    """A bivariate polynomial from points to points.

    Parameters
    ----------
    coefficients
        Shape ((d + 1)(d + 2) / 2, 2): a_kl and b_kl of Eq. 2 in the order of `exponents`, for normalised points.
    from_middle, from_half, to_middle, to_half
        Normalisation of either side, shape (2,).
    residual_px
        Largest distance at the points it was fitted to.
    """

    degree: int
    coefficients: Array
    from_middle: Array
    from_half: Array
    to_middle: Array
    to_half: Array
    residual_px: float

    def __call__(self, points_px: Array) -> Array:
        """Mapped points, shape (n, 2); NaN outside the fitted range and a tenth more to each side."""
        u = (np.atleast_2d(np.asarray(points_px, float)) - self.from_middle) / self.from_half
        with np.errstate(invalid="ignore"):
            u = np.where((np.abs(u) <= FAR).all(axis=1, keepdims=True), u, np.nan)
        return _powers(u, self.degree) @ self.coefficients * self.to_half + self.to_middle


def exponents(degree: int) -> list[tuple[int, int]]:
    """All (k, l) with k + l <= degree, as in Eq. 2."""
    return [(k, el) for k in range(degree + 1) for el in range(degree + 1 - k)]


def _powers(u: Array, degree: int) -> Array:
    x = np.vander(u[:, 0], degree + 1, increasing=True)
    y = np.vander(u[:, 1], degree + 1, increasing=True)
    return np.stack([x[:, k] * y[:, el] for k, el in exponents(degree)], axis=1)


def fit_polynomial(from_px: Array, to_px: Array, degree: int = DEGREE) -> PolynomialMap:
    """Least-squares polynomial that takes points, shape (n, 2), to points, shape (n, 2).

    Raises
    ------
    InfeasibleError
        There are fewer points than coefficients, or they lie on a line.
    """
    if from_px.shape != to_px.shape or from_px.ndim != 2 or from_px.shape[1] != 2:
        raise ValueError(f"expected two arrays of shape (n, 2), got {from_px.shape} and {to_px.shape}")
    n = len(exponents(degree))
    if len(from_px) < n:
        raise InfeasibleError(
            say("a polynomial of degree {} needs at least {} points, found {}", degree, n, len(from_px))
        )
    (from_middle, from_half), (to_middle, to_half) = _range(from_px), _range(to_px)
    basis = _powers((from_px - from_middle) / from_half, degree)
    coefficients, _, rank, _ = np.linalg.lstsq(basis, (to_px - to_middle) / to_half, rcond=1e-12)
    if rank < n:
        raise InfeasibleError(say("the points do not determine a polynomial of degree {}: they are in line", degree))
    off = (basis @ coefficients * to_half + to_middle) - to_px
    residual = float(np.hypot(off[:, 0], off[:, 1]).max())
    return PolynomialMap(degree, np.asarray(coefficients, float), from_middle, from_half, to_middle, to_half, residual)


def _range(points: Array) -> tuple[Array, Array]:
    low, high = points.min(axis=0), points.max(axis=0)
    return 0.5 * (low + high), np.maximum(0.5 * (high - low), 1e-9)


@dataclass(frozen=True, slots=True, eq=False)
class PolynomialView:
    """A rectified view whose maps are polynomials."""

    width_px: int
    height_px: int
    photo_from_rectified: PolynomialMap
    rectified_from_photo: PolynomialMap

    def to_photo(self, points_px: Array) -> Array:
        """Points of the rectified picture, shape (n, 2), in the photo."""
        return self.photo_from_rectified(points_px)

    def to_rectified(self, points_px: Array) -> Array:
        """Points of the photo, shape (n, 2), in the rectified picture."""
        return self.rectified_from_photo(points_px)


def polynomial_view(view: Rectification, degree: int = DEGREE, samples: int = SAMPLES) -> PolynomialView:
    """Polynomials in place of a view's exact maps.

    The paper fits the flattened points as they appear in the photo and needs a photo taken squarely; here they are
    fitted in the rectified picture itself, so that perspective is part of the polynomial.

    Raises
    ------
    InfeasibleError
        Too little of the view is seen in the photo.
    """
    x, y = np.meshgrid(np.linspace(0.0, view.width_px, samples), np.linspace(0.0, view.height_px, samples))
    rectified = np.column_stack([x.ravel(), y.ravel()])
    photo = view.to_photo(rectified)
    seen = np.isfinite(photo).all(axis=1)
    there = fit_polynomial(rectified[seen], photo[seen], degree)
    back = fit_polynomial(photo[seen], rectified[seen], degree)
    return PolynomialView(view.width_px, view.height_px, there, back)


SMALL_ANGLE_RAD = 1e-4
"""Below it the arc tangent is taken as its series, whose next term is 1e-17 of the result."""


@dataclass(frozen=True, slots=True, eq=False)
class FacadeSurface:
    """A plane or cylinder with metres on it: s to the right as seen from outside, along the arc, and t upwards.

    Parameters
    ----------
    anchor_enu_m
        The point s = t = 0, shape (3,).
    right_enu, up_enu
        Unit vectors of s and t at the anchor, shape (3,); the outward normal is right x up. A cylinder's axis is
        parallel to `up_enu`.
    curvature_per_m
        1 / radius: positive where the facade bulges outwards, negative where it is hollow, 0 for a plane.
    """

    anchor_enu_m: Array
    right_enu: Array
    up_enu: Array
    curvature_per_m: float = 0.0

    def __post_init__(self) -> None:
        for name in ("anchor_enu_m", "right_enu", "up_enu"):
            if getattr(self, name).shape != (3,):
                raise ValueError(f"{name}: expected shape (3,), got {getattr(self, name).shape}")
        right, up = self.right_enu, self.up_enu
        if not max(abs(right @ right - 1.0), abs(up @ up - 1.0), abs(right @ up)) < 1e-6:
            raise ValueError("right_enu, up_enu: expected unit vectors at a right angle")
        if not np.isfinite(self.curvature_per_m):
            raise ValueError(f"curvature_per_m: expected a finite number, got {self.curvature_per_m}")

    @property
    def normal_enu(self) -> Array:
        """Outward unit normal at the anchor, shape (3,)."""
        (a, b, c), (u, v, w) = self.right_enu, self.up_enu
        return np.array([b * w - c * v, c * u - a * w, a * v - b * u])

    @property
    def is_flat(self) -> bool:
        """Whether it is a plane."""
        return self.curvature_per_m == 0.0

    def flat(self) -> FacadeSurface:
        """The tangent plane at the anchor."""
        return replace(self, curvature_per_m=0.0)

    def moved(self, s_m: float, t_m: float) -> FacadeSurface:
        """The same surface with its anchor at (s, t); coordinates on it shift by that much."""
        here = np.array([[s_m, t_m]])
        return replace(self, anchor_enu_m=self.to_enu(here)[0], right_enu=self.right_at(here)[0])

    def to_enu(self, st_m: Array) -> Array:
        """Points on the surface, shape (n, 3), at surface coordinates, shape (n, 2)."""
        st = np.atleast_2d(np.asarray(st_m, float))
        s, k = st[:, 0], self.curvature_per_m
        across = s * np.sinc(k * s / np.pi)
        sag = 0.5 * k * (s * np.sinc(0.5 * k * s / np.pi)) ** 2
        return (
            self.anchor_enu_m
            + across[:, None] * self.right_enu
            + st[:, 1, None] * self.up_enu
            - sag[:, None] * self.normal_enu
        )

    def to_surface(self, points_enu_m: Array) -> Array:
        """Coordinates, shape (n, 2), of the nearest points on the surface to points, shape (n, 3).

        s of a cylinder lies within half its circumference to either side. NaN on the axis, where all are nearest.
        """
        x, y, z = self._local(points_enu_m)
        k = self.curvature_per_m
        a, b = k * x, 1.0 + k * z
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = a / b
            near = (b > 0.0) & (np.abs(ratio) < SMALL_ANGLE_RAD)
            series = x / b * (1.0 - ratio * ratio / 3.0)
            arc = np.arctan2(a, b) / k if k else series
        s = np.where(near, series, arc)
        return np.column_stack([np.where((a == 0.0) & (b == 0.0), np.nan, s), y])

    def height_m(self, points_enu_m: Array) -> Array:
        """Signed distance of points, shape (n, 3), outwards positive, shape (n,)."""
        x, _, z = self._local(points_enu_m)
        m = self.curvature_per_m * (x * x + z * z) + 2.0 * z
        return m / (np.sqrt(np.maximum(0.0, 1.0 + self.curvature_per_m * m)) + 1.0)

    def right_at(self, st_m: Array) -> Array:
        """Unit tangents along s, shape (n, 3)."""
        angle = self.curvature_per_m * np.atleast_2d(np.asarray(st_m, float))[:, 0]
        return np.cos(angle)[:, None] * self.right_enu - np.sin(angle)[:, None] * self.normal_enu

    def normals_at(self, st_m: Array) -> Array:
        """Outward unit normals, shape (n, 3)."""
        angle = self.curvature_per_m * np.atleast_2d(np.asarray(st_m, float))[:, 0]
        return np.cos(angle)[:, None] * self.normal_enu + np.sin(angle)[:, None] * self.right_enu

    def hits(self, origins_enu_m: Array, directions_enu: Array) -> Array:
        """Where rays from outside first enter the surface, as surface coordinates, shape (n, 2); NaN where they miss.

        Parameters
        ----------
        origins_enu_m, directions_enu
            Shape (n, 3) each; directions of any length. Rays that start behind the surface miss.
        """
        distance = self.distances(origins_enu_m, directions_enu)
        return self.to_surface(origins_enu_m + distance[:, None] * directions_enu)

    def distances(self, origins_enu_m: Array, directions_enu: Array) -> Array:
        """Distances along rays to where they first enter the surface, in lengths of their directions, shape (n,).

        The surface is where k (x^2 + z^2) + 2 z = 0 in the anchor's frame; a ray makes that a quadratic equation
        a l^2 + 2 b l + c = 0, of which the root is wanted where the left side turns from positive to negative. It is
        written so that nothing cancels, however flat the surface is.
        """
        x, _, z = self._local(origins_enu_m)
        directions = np.atleast_2d(np.asarray(directions_enu, float))
        u, w = directions @ self.right_enu, directions @ self.normal_enu
        k = self.curvature_per_m
        a = k * (u * u + w * w)
        b = k * (x * u + z * w) + w
        c = k * (x * x + z * z) + 2.0 * z
        with np.errstate(divide="ignore", invalid="ignore"):
            root = np.sqrt(b * b - a * c)
            distance = np.where(b <= 0.0, c / (root - b), -(b + root) / a)
        return np.where((c > 0.0) & (distance > 0.0) & np.isfinite(distance), distance, np.nan)

    def _local(self, points_enu_m: Array) -> tuple[Array, Array, Array]:
        offset = np.atleast_2d(np.asarray(points_enu_m, float)) - self.anchor_enu_m
        return offset @ self.right_enu, offset @ self.up_enu, offset @ self.normal_enu
