"""The paper's seventh-order polynomial between a photo of a curved facade and its flattened view (Eq. 2).

Pixels are centred and scaled to [-1, 1] first: raw ones to the seventh power (5280^7, about 1e26) leave a float64 least
squares nothing to work with. The way back is a fit of its own, not an inversion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from reconstruction.panels.rectify.rectification import Rectification

Array = NDArray[np.float64]

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
        raise InfeasibleError(f"a polynomial of degree {degree} needs at least {n} points, found {len(from_px)}")
    (from_middle, from_half), (to_middle, to_half) = _range(from_px), _range(to_px)
    basis = _powers((from_px - from_middle) / from_half, degree)
    coefficients, _, rank, _ = np.linalg.lstsq(basis, (to_px - to_middle) / to_half, rcond=1e-12)
    if rank < n:
        raise InfeasibleError(f"the points do not determine a polynomial of degree {degree}: they are in line")
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
