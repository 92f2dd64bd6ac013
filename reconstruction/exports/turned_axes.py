"""Gaussians in other axes than ours: every kind of file has its own idea of which way is up.

Places and rotations turn by a rotation, and so does what is seen from where: colours by direction are harmonics, which
a rotation mixes within each degree (Wigner's matrices).
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any, Literal

import numpy as np
import torch
from numpy.typing import NDArray

from reconstruction.exports.ellipsoids import Ellipsoids
from reconstruction.light.directions.harmonics import MAX_DEGREE, harmonics
from reconstruction.splats.ply import ODD

Axes = Literal["enu", "y-up", "y-down"]
"""`enu`: x east, y north, z up, as everywhere here. `y-up`: x east, y up, z south (right, up, back), of SPZ, glTF and
OpenGL. `y-down`: x east, y down, z north (right, down, forward), of what training programs write: viewers of PLY and
SOG files turn them over."""

QUARTER_TURNS: dict[Axes, int] = {"enu": 0, "y-up": -1, "y-down": 1}
"""About the x axis, from ENU."""


def turned(ellipsoids: Ellipsoids, axes: Axes) -> Ellipsoids:
    """Gaussians in ENU, told in other axes."""
    return _turned(ellipsoids, QUARTER_TURNS[axes])


def turned_back(ellipsoids: Ellipsoids, axes: Axes) -> Ellipsoids:
    """Gaussians in `axes`, told in ENU."""
    return _turned(ellipsoids, -QUARTER_TURNS[axes])


def rotation_about_x(quarters: int) -> NDArray[np.int64]:
    """Shape (3, 3)."""
    cos, sin = (1, 0, -1, 0)[quarters % 4], (0, 1, 0, -1)[quarters % 4]
    return np.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]])


def _turned(ellipsoids: Ellipsoids, quarters: int) -> Ellipsoids:
    if quarters == 0:
        return ellipsoids
    means = ellipsoids.means_m @ rotation_about_x(quarters).T.astype(np.float32)
    turns = harmonic_turns(quarters).astype(np.float32)
    return Ellipsoids(
        means,
        _turned_quaternions(ellipsoids.quats, quarters),
        ellipsoids.scales_m,
        ellipsoids.opacities,
        np.einsum("jk,nkc->njc", turns, ellipsoids.sh, optimize=True),
        ellipsoids.panels,
    )


def _turned_quaternions(quats: NDArray[np.float32], quarters: int) -> NDArray[np.float32]:
    """With w >= 0 again, as `Ellipsoids` has it."""
    cos, sin = math.cos(quarters * math.pi / 4.0), math.sin(quarters * math.pi / 4.0)
    w, x, y, z = quats.astype(np.float64).T
    found = np.stack([cos * w - sin * x, cos * x + sin * w, cos * y - sin * z, cos * z + sin * y], axis=1)
    return np.where(found[:, :1] < 0.0, -found, found).astype(np.float32)


@lru_cache(maxsize=4)
def harmonic_turns(quarters: int) -> NDArray[np.float64]:
    """What makes coefficients (16,) in ENU those in axes turned about x, shape (16, 16), orthogonal.

    Harmonics of a turned direction are a linear mix of those of the direction, each degree by itself; which, follows
    from more directions than there are harmonics, to 1e-14.
    """
    rng = np.random.default_rng(0)
    directions = rng.normal(size=(64, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    before, after = _standard(directions), _standard(directions @ rotation_about_x(quarters).T)
    mixed: NDArray[np.float64] = np.zeros((16, 16))
    for degree in range(MAX_DEGREE + 1):
        own = slice(degree**2, (degree + 1) ** 2)
        mixed[own, own] = np.linalg.lstsq(before[:, own], after[:, own], rcond=None)[0].T
    mixed.flags.writeable = False
    return mixed


def _standard(directions: NDArray[Any]) -> NDArray[np.float64]:
    """Harmonics with the phase (-1)^m, shape (n, 16)."""
    return np.asarray(harmonics(torch.from_numpy(directions)).numpy() * ODD)
