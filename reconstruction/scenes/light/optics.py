"""What a pane of glass does to light: exact Fresnel reflectance of its faces, sheets, double glazing, and mirroring.

Both polarisations are followed through the pane apart and averaged at its end, since sheets filter them. Light that
went to and fro between faces is added up without interference: panes are far thicker than light is coherent.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import inline, kernel
from reconstruction.scenes.record import Glass

Array = NDArray[np.float64]

TINY = 1e-300
"""Keeps 0/0 away where light grazes and everything is reflected; the numerators vanish there faster."""


def fresnel(cosines: Array, index: float) -> Array:
    """Reflectance of one face between air and a dielectric for unpolarised light, shape (n,).

    A. Fresnel, 1823; E. Hecht, Optics, 5th ed., Eqs. 4.34 and 4.40 squared, and averaged. At a cosine of 0 it is 1.

    Parameters
    ----------
    cosines
        Of the angle of incidence in air, 0 to 1, shape (n,).
    index
        Of refraction, at least 1.
    """
    across, along = _faces(np.ascontiguousarray(cosines, np.float64), float(index))
    return np.asarray(0.5 * (across + along))


def pane_light(cosines: Array, glass: Glass) -> tuple[Array, Array, Array]:
    """What a clean pane sends back from its first sheet, from all behind that, and lets through, each shape (n, 3).

    Their sum never exceeds 1; what lacks was absorbed. With one sheet the second part is 0. The glass is tinted per
    pass along the slanted path. A coating is a loss-free mirror on the outermost face that takes the share of light
    which adds `coating` to the pane's reflectance at normal incidence.

    Parameters
    ----------
    cosines
        Of the angle of incidence, 0 to 1, shape (n,).
    """
    cosines = np.ascontiguousarray(cosines, np.float64)
    tint = np.array(glass.tint, float)
    first, behind, through = _pane(cosines, glass.index, glass.sheets, tint)
    if glass.coating > 0.0:
        first_0, behind_0, _ = _pane(np.ones(1), glass.index, glass.sheets, tint)
        share = np.minimum(glass.coating / (1.0 - first_0[0] - behind_0[0]), 1.0)
        first = first + share * (1.0 - first - behind)
        through = through * (1.0 - share)
    return first, behind, through


def mirrored(directions: Array, normals: Array) -> Array:
    """Directions after reflection, shape (n, 3); normals are unit vectors, either way round."""
    return np.asarray(_mirrored(np.ascontiguousarray(directions), np.ascontiguousarray(normals)))


@inline
def _face(cosine: float, index: float) -> tuple[float, float]:
    """Reflectance of one face, polarised across and along the plane of incidence."""
    if index == 1.0:
        return 0.0, 0.0
    # n cos(t), from n^2 - sin^2 without the difference of two numbers close to 1.
    inner = math.sqrt((index - 1.0) * (index + 1.0) + cosine * cosine)
    across = (cosine - inner) / (cosine + inner)
    along = (index * index * cosine - inner) / (index * index * cosine + inner)
    return across * across, along * along


@inline
def _sheet(face: float, inside: float) -> tuple[float, float]:
    """Reflectance and transmittance of a sheet; `inside` is what its glass lets through on one pass."""
    round_trips = max((1.0 - face * inside) * (1.0 + face * inside), TINY)
    entered = (1.0 - face) * (1.0 - face)
    return face + entered * face * inside * inside / round_trips, entered * inside / round_trips


@kernel
def _faces(cosines: Array, index: float) -> tuple[Array, Array]:
    across, along = np.empty_like(cosines), np.empty_like(cosines)
    for i in range(len(cosines)):
        across[i], along[i] = _face(cosines[i], index)
    return across, along


@kernel
def _pane(cosines: Array, index: float, sheets: int, tint: Array) -> tuple[Array, Array, Array]:
    n = len(cosines)
    first, behind, through = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((n, 3))
    for i in range(n):
        cosine = min(max(cosines[i], 0.0), 1.0)
        across, along = _face(cosine, index)
        slant = index / math.sqrt((index - 1.0) * (index + 1.0) + cosine * cosine) if index > 1.0 else 1.0
        for k in range(3):
            inside = tint[k] ** (slant / sheets)
            for face in (across, along):
                back, on = _sheet(face, inside)
                first[i, k] += 0.5 * back
                if sheets == 2:
                    # Reflected to and fro between the sheets; no more passes the first than it did not reflect.
                    gap = max(1.0 - back, on, TINY) * (1.0 + back)
                    behind[i, k] += 0.5 * on * on * back / gap
                    on = on * on / gap
                through[i, k] += 0.5 * on
    return first, behind, through


@kernel
def _mirrored(directions: Array, normals: Array) -> Array:
    out = np.empty_like(directions)
    for i in range(len(directions)):
        falling = 0.0
        for k in range(3):
            falling += directions[i, k] * normals[i, k]
        for k in range(3):
            out[i, k] = directions[i, k] - 2.0 * falling * normals[i, k]
    return out
