"""The panes' real surfaces, tilted and bowed: where rays meet them and how they face there, exactly.

In the frame of a flat pane, u to the right and v upwards from its middle and z outwards, its glass is at

    z = bow_right (a^2 - u^2) / 2 + bow_up (b^2 - v^2) / 2 - tilt_right u - tilt_up v,

with half sides a and b: a bow holds the corners, a tilt the middle. Along a ray that is an equation of second degree,
whose solution next to the flat pane is written without differences of near numbers; no iteration, no tolerance.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import inline, kernel
from reconstruction.scenes.light.geometry import PaneFrames, RayHits
from reconstruction.scenes.record import Glass, Panes

Array = NDArray[np.float64]


# What a pane of glass does to light: exact Fresnel reflectance of its faces, sheets, double glazing, and mirroring.
#
# Both polarisations are followed through the pane apart and averaged at its end, since sheets filter them. Light that
# went to and fro between faces is added up without interference: panes are far thicker than light is coherent.

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


Index = NDArray[np.int64]

REACH = 2.0
"""In half sides: a surface goes on past the edges of its pane up to there, so that a slanting ray which meets the flat
pane close to an edge meets the bowed one, too. A ray that misses it there meets the flat pane."""


class PaneSurfaces:
    """Surfaces of panes.

    Parameters
    ----------
    tilt, bow
        Whether panes are tilted, and bowed; flat otherwise.
    """

    def __init__(self, panes: Panes, frames: PaneFrames, tilt: bool = True, bow: bool = True) -> None:
        self._middles = frames.middles_enu_m
        self._axes = np.stack([frames.rights, frames.ups, frames.normals])
        tilts, bows = tilt * panes.tilts_rad, bow * panes.bows_per_m
        self._shapes = np.stack([half_sides_m(panes, frames), tilts, bows])
        self.is_flat = not (tilts.any() or bows.any())
        self.sharpest_per_m = np.abs(bows).max(axis=1, initial=0.0)
        """The larger curvature of each pane, shape (m,)."""

    def meet(self, hits: RayHits, directions_enu: Array) -> tuple[RayHits, Array]:
        """Meetings of rays with the real panes in place of those with the flat ones; and the real unit normals.

        Both are shape (n, 3) for all rays; the normals of the meetings stay those of the flat panes. A ray that passes
        the edge of a bulge meets it where it comes closest, and goes on as it came; one that starts between a flat pane
        and its real surface meets the flat one.
        """
        rows = np.flatnonzero(hits.panes >= 0)
        if self.is_flat or not len(rows):
            return hits, hits.normals_enu
        ahead, normals = _hits(
            hits.points_enu_m[rows],
            directions_enu[rows],
            hits.distance_m[rows],
            hits.normals_enu[rows],
            hits.panes[rows],
            self._middles,
            self._axes,
            self._shapes,
        )
        distance, points, all_normals = hits.distance_m.copy(), hits.points_enu_m.copy(), hits.normals_enu.copy()
        distance[rows] += ahead
        points[rows] += ahead[:, None] * directions_enu[rows]
        all_normals[rows] = normals
        return replace(hits, distance_m=distance, points_enu_m=points), all_normals

    def heights_m(self, points_enu_m: Array, which: Index, flat: Array) -> Array:
        """How far points on panes stand before the flat ones, whose normals towards the rays are `flat`, shape (n,)."""
        if self.is_flat:
            return np.zeros(len(points_enu_m))
        return np.asarray(np.einsum("nk,nk->n", points_enu_m - self._middles[which], flat))


def half_sides_m(panes: Panes, frames: PaneFrames) -> Array:
    """How far the corners reach to the right and upwards from the middle, shape (m, 2)."""
    away = panes.corners_enu_m - frames.middles_enu_m[:, None]
    sides = [np.abs(np.einsum("mkx,mx->mk", away, axis)).max(axis=1) for axis in (frames.rights, frames.ups)]
    return np.stack(sides, axis=1)


@kernel
def _hits(
    points: Array, directions: Array, distances: Array, flat: Array, which: Index, middles: Array, axes: Array,
    shapes: Array,
) -> tuple[Array, Array]:  # fmt: skip
    """How much further rays meet the surfaces, shape (n,), and normals towards their origin, shape (n, 3).

    `axes` are rights, ups and normals, shape (3, m, 3); `shapes` half sides, tilts and bows, shape (3, m, 2).
    """
    n = len(points)
    ahead, normals = np.zeros(n), np.empty((n, 3))
    place, way, slope = np.zeros(3), np.zeros(3), np.zeros(2)
    for i in range(n):
        pane, facing = which[i], 0.0
        for axis in range(3):
            place[axis] = way[axis] = 0.0
            for k in range(3):
                place[axis] += (points[i, k] - middles[pane, k]) * axes[axis, pane, k]
                way[axis] += directions[i, k] * axes[axis, pane, k]
        for k in range(3):
            facing += flat[i, k] * axes[2, pane, k]
        side = 1.0 if facing >= 0.0 else -1.0
        # Height above the surface, t further along the ray: square t^2 + linear t + height.
        square, linear, height = 0.0, way[2], place[2]
        for axis in range(2):
            half, tilt, bow = shapes[0, pane, axis], shapes[1, pane, axis], shapes[2, pane, axis]
            square += 0.5 * bow * way[axis] * way[axis]
            linear += (tilt + bow * place[axis]) * way[axis]
            height += tilt * place[axis] + 0.5 * bow * (place[axis] - half) * (place[axis] + half)
        t = _falling_root(square, linear, height, side)
        inside = distances[i] + t > 0.0
        for axis in range(2):
            inside = inside and abs(place[axis] + t * way[axis]) <= REACH * shapes[0, pane, axis]
        ahead[i] = t if inside else 0.0
        length = 1.0
        for axis in range(2):
            at = place[axis] + ahead[i] * way[axis]
            slope[axis] = shapes[1, pane, axis] + shapes[2, pane, axis] * at
            length += slope[axis] * slope[axis]
        for k in range(3):
            along = axes[2, pane, k] + slope[0] * axes[0, pane, k] + slope[1] * axes[1, pane, k]
            normals[i, k] = side * along / math.sqrt(length)
    return ahead, normals


@kernel
def _falling_root(square: float, linear: float, height: float, side: float) -> float:
    """Where a parabola passes 0 downwards (upwards for a side of -1); where it comes closest if it never does.

    NaN where there is no such place.
    """
    inner = linear * linear - 4.0 * square * height
    if inner < 0.0:
        return -linear / (2.0 * square)
    root = side * math.sqrt(inner)
    if linear * side <= 0.0:
        below = root - linear
        return 2.0 * height / below if below != 0.0 else math.nan
    return -(linear + root) / (2.0 * square) if square != 0.0 else math.nan
