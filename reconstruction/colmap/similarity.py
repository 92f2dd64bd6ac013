"""The similarity between two sets of points: scale, rotation and translation, by least squares and against outliers.

Solved in closed form (S. Umeyama, "Least-squares estimation of transformation parameters between two point patterns",
IEEE PAMI 13(4), 1991, Eqs. 39 to 43), with weights. Points on one line leave the turn about that line open.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

COLLINEAR = 0.02
"""Points that spread across their line by less than this part of their length along it fix no turn about it: errors of
2 % of the length would turn the model by one radian."""

N_SAMPLES = 500
"""Samples of three points; with half of all points wrong, one in eight is good, and 500 miss it once in 10^29."""

ROBUST_SIGMAS = 3.0
"""Residuals beyond are outliers."""

MAX_ROUNDS = 20

MAD_TO_SIGMA = 1.0 / 1.538
"""Median length of a 3-D error is 1.538 standard deviations of one of its axes (chi distribution, 3 degrees)."""


@dataclass(frozen=True, slots=True, eq=False)
class Similarity:
    """points_b = scale * rotation @ points_a + translation; rotation shape (3, 3), translation shape (3,)."""

    scale: float
    rotation: Array
    translation: Array

    @classmethod
    def identity(cls) -> Similarity:
        """Which leaves all points where they are."""
        return cls(1.0, np.eye(3), np.zeros(3))

    def __call__(self, points: Array) -> Array:
        """Points, shape (n, 3), in the other frame."""
        return np.asarray(self.scale * points @ self.rotation.T + self.translation)

    def inverse(self) -> Similarity:
        """The way back."""
        turn = self.rotation.T
        return Similarity(1.0 / self.scale, turn, -(turn @ self.translation) / self.scale)


def spread(points: Array) -> Array:
    """Standard deviations along the three principal axes, falling, shape (3,); 0 for fewer than two points."""
    if len(points) < 2:
        return np.zeros(3)
    values = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return np.asarray(np.pad(values, (0, 3 - len(values))) / math.sqrt(len(points)))


def are_on_a_line(points: Array) -> bool:
    """Whether points, shape (n, 3), lie on one line as far as a similarity is concerned, or in one place."""
    widths = spread(points)
    return bool(widths[1] <= COLLINEAR * widths[0])


def fit(a: Array, b: Array, weights: Array | None = None, rotation: Array | None = None) -> Similarity:
    """The similarity that takes points a to points b, each shape (n, 3), with the least sum of weighted squares.

    Parameters
    ----------
    weights
        Shape (n,); all alike without.
    rotation
        Shape (3, 3), where it is known from elsewhere.

    Raises
    ------
    ValueError
        Shapes differ, or all points a are in one place.
    """
    if a.shape != b.shape or a.ndim != 2 or a.shape[1] != 3:
        raise ValueError(f"expected two arrays of one shape (n, 3), got {a.shape} and {b.shape}")
    w = np.ones(len(a)) if weights is None else weights
    w = w / w.sum()
    mean_a, mean_b = w @ a, w @ b
    from_a, from_b = a - mean_a, b - mean_b
    variance = float(w @ (from_a**2).sum(axis=1))
    if not variance > 0.0:
        raise ValueError("all points are in one place, so that they have no scale")
    covariance = (w[:, None] * from_b).T @ from_a
    if rotation is None:
        u, _, vt = np.linalg.svd(covariance)
        signs = np.array([1.0, 1.0, np.sign(np.linalg.det(u) * np.linalg.det(vt))])
        rotation = (u * signs) @ vt
    # The trace is that of D S in Eq. 42, for any rotation.
    scale = float(np.einsum("ij,ij->", rotation, covariance)) / variance
    return Similarity(scale, rotation, mean_b - scale * (rotation @ mean_a))


def fit_robustly(
    a: Array, b: Array, sigmas: Array, rotation: Array | None = None, seed: int = 0
) -> tuple[Similarity, NDArray[np.bool_]]:
    """As `fit`, with outliers among the pairs.

    Samples of three pairs, or two where the rotation is known; the sample with the least median of residuals in their
    standard deviations; then least squares over all pairs within `ROBUST_SIGMAS`, until these stay the same. Standard
    deviations are scaled up where the residuals of the better half are larger than they allow.

    Parameters
    ----------
    sigmas
        Shape (n,): standard deviation of each b along each axis.

    Returns
    -------
    similarity, is_inlier
        The second of shape (n,).
    """
    rng = np.random.default_rng(seed)
    n, size = len(a), 3 if rotation is None else 2
    best, least = fit(a, b, sigmas**-2.0, rotation), math.inf
    for _ in range(N_SAMPLES if n > size else 1):
        chosen = rng.choice(n, size, replace=False) if n > size else np.arange(n)
        if spread(a[chosen])[size - 2] <= COLLINEAR * spread(a)[0]:
            continue
        found = fit(a[chosen], b[chosen], None, rotation)
        median = float(np.median(_lengths(found, a, b) / sigmas))
        if found.scale > 0.0 and median < least:
            best, least = found, median
    inlier = np.ones(n, np.bool_)
    for _ in range(MAX_ROUNDS):
        residuals = _lengths(best, a, b) / sigmas
        unit = max(1.0, float(np.median(residuals)) * MAD_TO_SIGMA)
        now = residuals <= ROBUST_SIGMAS * math.sqrt(3.0) * unit
        if now.sum() < size or (now == inlier).all():
            break
        inlier = now
        best = fit(a[inlier], b[inlier], sigmas[inlier] ** -2.0, rotation)
    return best, inlier


def _lengths(similarity: Similarity, a: Array, b: Array) -> Array:
    return np.asarray(np.linalg.norm(similarity(a) - b, axis=1))
