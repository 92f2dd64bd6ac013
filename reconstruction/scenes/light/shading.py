"""What sends light: the sky, and matt bodies in sun and sky light with their textures averaged over a pixel's area."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from reconstruction.scenes.light.geometry import Geometry, texture_axes
from reconstruction.scenes.record import Body, Sky, Texture

if TYPE_CHECKING:
    from reconstruction.scenes.light.ambient import Ambient

Array = NDArray[np.float64]
Index = NDArray[np.int64]

GROUND_ALBEDO = 0.2
"""Of all ground together, which lights what looks downwards: between asphalt (0.1) and dry concrete (0.3)."""


FLATTEST = 0.05
"""Least cosine counted for a pixel's area on a surface seen from the side."""


class SkyLight:
    """The sky, as something seen and as light on surfaces."""

    def __init__(self, sky: Sky) -> None:
        self._sky = sky
        self._zenith, self._horizon = np.array(sky.zenith), np.array(sky.horizon)
        self._panorama = None if sky.panorama is None else np.ascontiguousarray(sky.panorama, np.float32)
        self.sun_direction_enu = sky.sun_direction_enu
        self.sun = np.array(sky.sun) * (self.sun_direction_enu[2] > 0.0)
        self._above = self._from_above()
        self._below = GROUND_ALBEDO * (self.sun * max(float(self.sun_direction_enu[2]), 0.0) + self._above)

    def seen(self, directions_enu: Array) -> Array:
        """In unit directions, shape (n, 3); below the horizon the clear sky looks as it does there."""
        if self._panorama is not None:
            return look_up(self._panorama, directions_enu)
        share = np.clip(directions_enu[:, 2], 0.0, 1.0)[:, None]
        return np.asarray(self._horizon + share * (self._zenith - self._horizon))

    def on(self, normals_enu: Array) -> Array:
        """Of sky and ground together on surfaces with unit normals, shape (n, 3), without the sun.

        Each counts with the share of the hemisphere that a tilted surface sees of it, as in a radiosity's form factor
        of the unobstructed sky, (1 + cos(tilt)) / 2.
        """
        above = 0.5 * (1.0 + normals_enu[:, 2])[:, None]
        return np.asarray(above * self._above + (1.0 - above) * self._below)

    def _from_above(self) -> Array:
        """Light of the whole sky on a level surface."""
        if self._panorama is None:
            # The mean of h + (z - h) s over the hemisphere, weighted with the sine s of the elevation.
            return np.asarray(self._horizon + 2.0 / 3.0 * (self._zenith - self._horizon))
        upper = self._panorama[: max(1, len(self._panorama) // 2)]
        elevation = math.pi / 2.0 * (1.0 - (np.arange(len(upper)) + 0.5) / len(upper))
        return np.asarray(np.average(upper.mean(axis=1), axis=0, weights=np.sin(2.0 * elevation)), float)


class MattLight:
    """Light that matt bodies send into a ray.

    Parameters
    ----------
    bodies, geometry
        The bodies, and the geometry that counts their triangles.
    shadows
        What keeps the sun away; None for a sun that reaches everything.
    ambient
        Light but for the sun's; None for that of open sky and even ground.
    """

    def __init__(
        self,
        bodies: tuple[Body, ...],
        geometry: Geometry,
        sky: SkyLight,
        shadows: Geometry | None,
        ambient: Ambient | None = None,
    ) -> None:
        self._sky, self._shadows, self._ambient = sky, shadows, ambient
        self._albedo = np.array([body.albedo for body in bodies], float).reshape(-1, 3)
        self._rights, self._ups = texture_axes(geometry.normals_enu)
        textures = {id(body.texture): body.texture for body in bodies if body.texture is not None}
        numbers = {key: number for number, key in enumerate(textures)}
        self._texture = np.array([numbers.get(id(body.texture), -1) for body in bodies], np.int64)
        self._texels, self._levels, self._scales = _pyramids(list(textures.values()))

    def light(
        self, bodies: Index, triangles: Index, points_enu_m: Array, normals_enu: Array, cosines: Array, width_m: Array
    ) -> Array:
        """Light, shape (n, 3), from points on bodies.

        Parameters
        ----------
        normals_enu
            Towards the viewer, shape (n, 3).
        cosines
            Of the angle between them and the ray, shape (n,).
        width_m
            Of the pixel's beam at the points, shape (n,).
        """
        width = width_m / np.sqrt(np.maximum(cosines, FLATTEST))
        numbers = self._texture[bodies]
        albedo = self._albedo[bodies] * _textured(
            points_enu_m, numbers, self._rights[triangles], self._ups[triangles], width,
            self._texels, self._levels, self._scales,
        )  # fmt: skip
        return albedo * self.arriving(points_enu_m, normals_enu, triangles)

    def arriving(self, points_enu_m: Array, normals_enu: Array, triangles: Index) -> Array:
        """Light, shape (n, 3), on points of triangles of the geometry, from the side that unit normals point to."""
        share = np.maximum(normals_enu @ self._sky.sun_direction_enu, 0.0)
        if self._shadows is not None and self._sky.sun.any():
            faces = np.flatnonzero(share)
            lit = self._shadows.is_lit(points_enu_m[faces], normals_enu[faces], self._sky.sun_direction_enu)
            share[faces[~lit]] = 0.0
        if self._ambient is None:
            rest = self._sky.on(normals_enu)
        else:
            rest = self._ambient.on(points_enu_m, normals_enu, triangles)
        return np.asarray(share[:, None] * self._sky.sun + rest)


def look_up(panorama: NDArray[np.float32], directions_enu: Array) -> Array:
    """Values, shape (n, c), of a picture of all directions, shape (h, 2 h, c) as in `Sky`; linear between pixels."""
    return np.asarray(_looked_up(panorama, np.ascontiguousarray(directions_enu)))


@kernel
def _looked_up(panorama: NDArray[np.float32], directions: Array) -> Array:
    height, width, n_channels = panorama.shape
    found = np.empty((len(directions), n_channels))
    for i in range(len(directions)):
        x, y, z = directions[i]
        column = math.atan2(x, y) / (2.0 * math.pi) * width - 0.5
        row = (0.5 - math.atan2(z, math.hypot(x, y)) / math.pi) * height - 0.5
        row = min(max(row, 0.0), height - 1.0)
        left, top = math.floor(column), min(int(row), max(height - 2, 0))
        a, b = column - left, row - top
        c0, c1, bottom = int(left) % width, int(left + 1) % width, min(top + 1, height - 1)
        for k in range(n_channels):
            upper = (1.0 - a) * panorama[top, c0, k] + a * panorama[top, c1, k]
            lower = (1.0 - a) * panorama[bottom, c0, k] + a * panorama[bottom, c1, k]
            found[i, k] = (1.0 - b) * upper + b * lower
    return found


def _pyramids(textures: list[Texture]) -> tuple[NDArray[np.float32], Index, Array]:
    """Textures and their halved copies: texels (n, 3); first texel, height, width (texture, level, 3); px per m."""
    texels, rows, first = [np.zeros((1, 3), np.float32)], [], 1
    for texture in textures:
        picture, levels = np.ascontiguousarray(texture.picture, np.float32), []
        while True:
            height, width = picture.shape[:2]
            texels.append(picture.reshape(-1, 3))
            levels.append((first, height, width))
            first += height * width
            if height == width == 1:
                break
            smaller = (max(1, width // 2), max(1, height // 2))
            halved = cv2.resize(picture, smaller, interpolation=cv2.INTER_AREA)
            picture = np.asarray(halved, np.float32).reshape(*smaller[::-1], 3)
        rows.append(levels)
    table = np.zeros((len(rows), max(map(len, rows), default=0), 3), np.int64)
    for number, levels in enumerate(rows):
        table[number] = levels + [levels[-1]] * (table.shape[1] - len(levels))
    return np.concatenate(texels), table, np.array([texture.px_per_m for texture in textures], float)


@kernel
def _textured(
    points: Array,
    numbers: Index,
    rights: Array,
    ups: Array,
    widths: Array,
    texels: NDArray[np.float32],
    levels: Index,
    scales: Array,
) -> Array:
    """Reflectance of textures, 1 where there is none, linear between texels and between levels."""
    found = np.ones((len(points), 3))
    for i in range(len(points)):
        number = numbers[i]
        if number < 0:
            continue
        u = v = 0.0
        for k in range(3):
            u += points[i, k] * rights[i, k]
            v += points[i, k] * ups[i, k]
        u *= scales[number] / levels[number, 0, 2]
        v *= -scales[number] / levels[number, 0, 1]
        u, v = u - math.floor(u), v - math.floor(v)
        last = levels.shape[1] - 1
        level = min(max(math.log2(max(widths[i] * scales[number], 1e-9)), 0.0), float(last))
        low = min(int(level), last)
        for k in range(3):
            found[i, k] = 0.0
        for step in range(2):
            share = level - low if step else 1.0 - (level - low)
            if share <= 0.0:
                continue
            first, height, width = levels[number, min(low + step, last)]
            x, y = u * width - 0.5, v * height - 0.5
            left, top = math.floor(x), math.floor(y)
            a, b = x - left, y - top
            c0, c1 = int(left) % width, int(left + 1) % width
            r0, r1 = first + int(top) % height * width, first + int(top + 1) % height * width
            for k in range(3):
                upper = (1.0 - a) * texels[r0 + c0, k] + a * texels[r0 + c1, k]
                lower = (1.0 - a) * texels[r1 + c0, k] + a * texels[r1 + c1, k]
                found[i, k] += share * ((1.0 - b) * upper + b * lower)
    return found
