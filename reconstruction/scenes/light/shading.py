"""What sends light: the sky, and matt bodies in sun and sky light with their textures averaged over a pixel's area."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks, inline, kernel, run_chunks
from reconstruction.scenes.light.geometry import Geometry, texture_axes
from reconstruction.scenes.record import Body, Layer, Panes, Scene, Sky, Texture

Array = NDArray[np.float64]
Index = NDArray[np.int64]


# Light that reaches matt surfaces from all directions but the sun's: what of the sky they see, and what stands
# around.
#
# It is gathered at nodes of a grid over each plane of the scene, when a ray first asks for it there, and is linear
# between them.

Gather = Callable[[Array, Array], tuple[Array, NDArray[np.bool_]]]
"""Light along rays from surfaces (starts and unit directions, shape (n, 3)), and whether it comes from a back."""

MOST_NODES = 512
"""Along a side of a plane; the grid of a longer one is wider."""

AMBIENT_BEAM_RAD = math.sqrt(math.pi / 64.0)
"""How wide each of 64 rays is that together are all light on a surface."""

INSIDE = 0.3
"""Share of rays that meet the backs of surfaces above which a node lies inside of something, and is not asked."""

ALIKE, ALIKE_M = 1e-3, 0.01
"""Triangles whose normals and distances from the origin differ by less are of one plane."""

PLACES = ((0.5, 0.5), (0.2, 0.3), (0.8, 0.7), (0.3, 0.8), (0.7, 0.2))
"""In a cell, where its light is gathered: the first of them that is not inside of something."""

ALWAYS = 1e-3
"""Weight of the furthest of four nodes, which counts where the others are inside of something."""

RIM_M = 0.05
"""Of triangles, where no light is gathered: walls and ground meet there, and edges that do not quite fit."""

MOST_IN_ALL = 1 << 24
"""Nodes; a scene that has more gets a wider grid."""

AT_ONCE = 1 << 11
"""Nodes that are gathered for together."""


@dataclass(frozen=True, slots=True)
class Spacing:
    """How densely light is gathered.

    Parameters
    ----------
    node_m
        Between nodes.
    n_rays
        From each of them, spread so that each counts alike on a matt surface.
    """

    node_m: float
    n_rays: int


FINE = Spacing(1.0, 64)
COARSE = Spacing(4.0, 16)
"""For what is seen, and for the light of what that is lit by."""


class Ambient:
    """Grids over all planes of a geometry.

    Parameters
    ----------
    geometry
        Whose triangles are asked for.
    gather
        Into the scene.
    """

    def __init__(self, geometry: Geometry, gather: Gather, spacing: Spacing = FINE) -> None:
        self._n_rays = spacing.n_rays
        self._gather, self._above = gather, geometry.above
        self._group, self._frames, self._grids, n = _grids(geometry, spacing.node_m)
        self._triangles = np.argsort(self._group, kind="stable")
        self._first = np.searchsorted(self._group[self._triangles], np.arange(len(self._grids) + 1))
        self._corners = _shrunk(geometry.corners_enu_m)
        self._middles = self._corners.mean(axis=1)
        self._reaches_m = np.linalg.norm(self._corners - self._middles[:, None], axis=2).max(axis=1)
        # Each node twice: for the side that its plane's normal points to, and for the other.
        self._light = np.zeros((2 * n, 3), np.float32)
        self._is_inside, self._is_known = np.zeros(2 * n, np.bool_), np.zeros(2 * n, np.bool_)

    @property
    def n_places(self) -> int:
        """Nodes that light was gathered for so far."""
        return int(self._is_known.sum())

    def on(self, points_enu_m: Array, normals_enu: Array, triangles: Index) -> Array:
        """Light, shape (n, 3), on points of triangles, on the side that the unit normals, shape (n, 3), point to."""
        nodes, weights = _nodes(points_enu_m, normals_enu, self._group[triangles], self._frames, self._grids)
        # Threads that ask for the same node at the same time both write the same.
        unknown = np.unique(nodes[~self._is_known[nodes]])
        for start in range(0, len(unknown), AT_ONCE):
            self._fill(unknown[start : start + AT_ONCE])
        return np.asarray(_mixed(nodes, weights, self._light, self._is_inside))

    def _fill(self, nodes: Index) -> None:
        """From the middles of the nodes' cells; where these are inside of something, from elsewhere in the cells."""
        light, is_inside = np.zeros((len(nodes), 3)), np.ones(len(nodes), np.bool_)
        for u, v in PLACES:
            left = np.flatnonzero(is_inside)
            if not len(left):
                break
            light[left], is_inside[left] = self._gathered(nodes[left], u, v)
        # Only once it is settled: another thread that fills the same nodes may be read from already.
        self._light[nodes], self._is_inside[nodes] = light, is_inside
        self._is_known[nodes] = True

    def _gathered(self, nodes: Index, u: float, v: float) -> tuple[Array, NDArray[np.bool_]]:
        """Light on nodes at a place in their cells, shape (n, 3), and whether that is inside of something, (n,)."""
        groups = np.searchsorted(self._grids[:, 7], nodes // 2, side="right") - 1
        places, normals, rights, ups = _places(nodes, u, v, groups, self._frames, self._grids)
        shapes = self._corners, self._middles, self._reaches_m
        places = _snapped(places, groups, self._first, self._triangles, *shapes)
        n_rays = self._n_rays
        k = np.arange(n_rays)
        # Evenly over the disc below the hemisphere (H. Vogel, 1979), so evenly in light that falls on the surface.
        radius, turn = np.sqrt((k + 0.5) / n_rays), k * math.pi * (3.0 - math.sqrt(5.0))
        parts = np.stack([radius * np.cos(turn), radius * np.sin(turn), np.sqrt(1.0 - radius**2)])
        directions = np.einsum("ck,cnx->nkx", parts, np.stack([rights, ups, normals]))
        starts = np.repeat(self._above(places, normals), n_rays, axis=0)
        light, is_behind = self._gather(starts, directions.reshape(-1, 3))
        return light.reshape(-1, n_rays, 3).mean(axis=1), is_behind.reshape(-1, n_rays).mean(axis=1) > INSIDE


def _grids(geometry: Geometry, node_m: float) -> tuple[Index, Array, Array, int]:
    """Plane of each triangle, shape (t,); of each plane, its normal and axes, shape (g, 3, 3); its grids; all nodes.

    A grid, shape (8,), is the distance of its plane from the origin, its lowest u and v, its steps along both, how many
    nodes there are along both, and its first node.
    """
    normals, corners = geometry.normals_enu, geometry.corners_enu_m
    offsets = np.einsum("tk,tk->t", normals, corners[:, 0])
    keys = np.column_stack([np.rint(normals / ALIKE), np.rint(offsets / ALIKE_M)]).astype(np.int64)
    _, first, group = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    group = group.ravel()
    rights, ups = texture_axes(normals[first])
    frames = np.stack([normals[first], rights, ups], axis=1)
    spans = []
    for axis in (1, 2):
        along = np.einsum("tck,tk->tc", corners, frames[group, axis])
        low, high = np.full(len(first), np.inf), np.full(len(first), -np.inf)
        np.minimum.at(low, group, along.min(axis=1))
        np.maximum.at(high, group, along.max(axis=1))
        spans.append((low, high))
    (low_u, high_u), (low_v, high_v) = spans
    while True:
        n_u, n_v = (np.clip(np.ceil((high - low) / node_m), 1, MOST_NODES) for low, high in spans)
        if (n_u * n_v).sum() <= max(MOST_IN_ALL, len(first)):
            break
        node_m *= 2.0
    ends = np.cumsum(n_u * n_v)
    grids = np.column_stack(
        [offsets[first], low_u, low_v, (high_u - low_u) / n_u, (high_v - low_v) / n_v, n_u, n_v, ends - n_u * n_v]
    )
    return group, frames, grids, int(ends[-1]) if len(ends) else 0


def _places(
    nodes: Index, at_u: float, at_v: float, groups: Index, frames: Array, grids: Array
) -> tuple[Array, Array, Array, Array]:
    """Places at shares of nodes' cells, their normals, and axes to the right and upwards, each shape (n, 3)."""
    normal, right, up = (frames[groups, k] for k in range(3))
    offset, low_u, low_v, step_u, step_v, n_u, _, first = grids[groups].T
    row, column = np.divmod(nodes // 2 - first, n_u)
    u, v = low_u + (column + at_u) * step_u, low_v + (row + at_v) * step_v
    places = offset[:, None] * normal + u[:, None] * right + v[:, None] * up
    return places, np.where(nodes % 2 == 0, 1.0, -1.0)[:, None] * normal, right, up


def _shrunk(corners: Array) -> Array:
    """Triangles, shape (t, 3, 3), without a rim of `RIM_M`, or of half their size."""
    inwards = corners.mean(axis=1, keepdims=True) - corners
    lengths = np.linalg.norm(inwards, axis=2, keepdims=True)
    return np.asarray(corners + np.minimum(0.5, RIM_M / np.maximum(lengths, RIM_M)) * inwards)


@kernel
def _snapped(
    places: Array, groups: Index, first: Index, triangles: Index, corners: Array, middles: Array, reaches: Array
) -> Array:
    """The points of their planes' triangles next to places, each shape (n, 3); C. Ericson, 2005, section 5.1.5."""
    found = np.empty_like(places)
    for i in range(len(places)):
        least = np.inf
        for t in triangles[first[groups[i]] : first[groups[i] + 1]]:
            far = 0.0
            for k in range(3):
                far += (places[i, k] - middles[t, k]) ** 2
            if far > (reaches[t] + math.sqrt(least)) ** 2:
                continue
            a, b, c = corners[t]
            ab, ac, ap, bp, cp = b - a, c - a, places[i] - a, places[i] - b, places[i] - c
            d1, d2, d3, d4 = _dot(ab, ap), _dot(ac, ap), _dot(ab, bp), _dot(ac, bp)
            d5, d6 = _dot(ab, cp), _dot(ac, cp)
            of_a, of_b, of_c = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
            if d1 <= 0.0 and d2 <= 0.0:
                v, w = 0.0, 0.0
            elif d3 >= 0.0 and d4 <= d3:
                v, w = 1.0, 0.0
            elif d6 >= 0.0 and d5 <= d6:
                v, w = 0.0, 1.0
            elif of_c <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
                v, w = d1 / (d1 - d3), 0.0
            elif of_b <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
                v, w = 0.0, d2 / (d2 - d6)
            elif of_a <= 0.0 and d4 >= d3 and d5 >= d6:
                w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
                v = 1.0 - w
            else:
                v, w = of_b / (of_a + of_b + of_c), of_c / (of_a + of_b + of_c)
            point = a + v * ab + w * ac
            away = _dot(point - places[i], point - places[i])
            if away < least:
                least = away
                found[i] = point
    return found


@inline
def _dot(a: Array, b: Array) -> float:
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@kernel
def _nodes(points: Array, normals: Array, groups: Index, frames: Array, grids: Array) -> tuple[Index, Array]:
    """The four nodes around each point, and their weights, each shape (n, 4)."""
    nodes, weights = np.empty((len(points), 4), np.int64), np.empty((len(points), 4))
    at = np.zeros(3)
    for i in range(len(points)):
        group = groups[i]
        facing = 0.0
        for axis in range(3):
            at[axis] = 0.0
            for k in range(3):
                at[axis] += points[i, k] * frames[group, axis, k]
        for k in range(3):
            facing += normals[i, k] * frames[group, 0, k]
        side = 0 if facing >= 0.0 else 1
        n_u, n_v, first = int(grids[group, 5]), int(grids[group, 6]), int(grids[group, 7])
        u = (at[1] - grids[group, 1]) / grids[group, 3] - 0.5 if n_u > 1 else 0.0
        v = (at[2] - grids[group, 2]) / grids[group, 4] - 0.5 if n_v > 1 else 0.0
        u, v = min(max(u, 0.0), n_u - 1.0), min(max(v, 0.0), n_v - 1.0)
        left, low = min(int(u), max(n_u - 2, 0)), min(int(v), max(n_v - 2, 0))
        a, b = u - left, v - low
        right, high = min(left + 1, n_u - 1), min(low + 1, n_v - 1)
        nodes[i, 0] = 2 * (first + low * n_u + left) + side
        nodes[i, 1] = 2 * (first + low * n_u + right) + side
        nodes[i, 2] = 2 * (first + high * n_u + left) + side
        nodes[i, 3] = 2 * (first + high * n_u + right) + side
        weights[i, 0], weights[i, 1] = (1.0 - a) * (1.0 - b), a * (1.0 - b)
        weights[i, 2], weights[i, 3] = (1.0 - a) * b, a * b
    return nodes, weights


@kernel
def _mixed(nodes: Index, weights: Array, light: NDArray[np.float32], is_inside: NDArray[np.bool_]) -> Array:
    """Weighted mean of the nodes that are not inside of something; of all where all are."""
    mixed = np.zeros((len(nodes), 3))
    for i in range(len(nodes)):
        outside = 0.0
        for j in range(4):
            if not is_inside[nodes[i, j]]:
                outside += weights[i, j] + ALWAYS
        for j in range(4):
            node, weight = nodes[i, j], weights[i, j]
            if outside > 0.0:
                weight += ALWAYS
                weight = 0.0 if is_inside[node] else weight / outside
            for k in range(3):
                mixed[i, k] += weight * light[node, k]
    return mixed


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

    def light_from(self, directions_enu: Array) -> Array:
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


# The surroundings as one picture of all directions: what panes mirror where near and far cannot be told apart.

"""Of the picture, unless told otherwise: 0.18 degrees a pixel, as in a wide photo of 512 pixels' width; two million
rays, once."""

ROWS_AT_ONCE = 32


def facade_middle_enu_m(scene: Scene) -> Array:
    """Where the picture is taken: the mean of all panes' corners, shape (3,)."""
    return np.asarray(scene.panes.corners_enu_m.reshape(-1, 3).mean(axis=0))


class Environment:
    """Everything but the building, seen from the facade's middle; the sky in between stays exact.

    Parameters
    ----------
    shadows
        What keeps the sun away, the building with it; None for no shadows.
    rows
        Of the picture, which is twice as wide.
    gather
        As in `Ambient`; None for light of open sky.
    """

    def __init__(
        self, scene: Scene, sky: SkyLight, shadows: Geometry | None, rows: int, gather: Gather | None = None
    ) -> None:
        self._sky = sky
        around = tuple(body for body in scene.bodies if body.layer is not Layer.BUILDING)
        self._geometry = Geometry(replace(scene, bodies=around, panes=_no_panes()))
        ambient = None if gather is None else Ambient(self._geometry, gather)
        self._matt = MattLight(around, self._geometry, sky, shadows, ambient)
        self._middle = facade_middle_enu_m(scene)
        self._rows = rows
        strips = run_chunks(self._strip, chunks(rows, ROWS_AT_ONCE))
        self._picture = np.concatenate(strips).reshape(rows, 2 * rows, 4)

    def light_from(self, directions_enu: Array) -> Array:
        """Light from unit directions, shape (n, 3)."""
        found = look_up(self._picture, directions_enu)
        return np.asarray(found[:, :3] + (1.0 - found[:, 3:]) * self._sky.light_from(directions_enu))

    def _strip(self, start: int, stop: int) -> NDArray[np.float32]:
        """Light of bodies, and the share of each pixel that they cover, shape (pixels of these rows, 4)."""
        elevation = math.pi * (0.5 - (np.arange(start, stop) + 0.5) / self._rows)
        heading = math.pi * (np.arange(2 * self._rows) + 0.5) / self._rows
        elevation, heading = (a.ravel() for a in np.meshgrid(elevation, heading, indexing="ij"))
        level = np.cos(elevation)
        directions = np.column_stack([level * np.sin(heading), level * np.cos(heading), np.sin(elevation)])
        hits = self._geometry.meet(np.broadcast_to(self._middle, directions.shape), directions)
        is_body = hits.bodies >= 0
        light = np.zeros((len(directions), 4), np.float32)
        light[:, 3] = is_body
        normals = hits.normals_enu[is_body]
        light[is_body, :3] = self._matt.light(
            hits.bodies[is_body],
            hits.triangles[is_body],
            hits.points_enu_m[is_body],
            normals,
            np.abs(np.einsum("nk,nk->n", normals, directions[is_body])),
            math.pi / self._rows * hits.distance_m[is_body],
        )
        return light


def _no_panes() -> Panes:
    none, two = np.zeros((0, 3)), np.zeros((0, 2))
    return Panes(np.zeros((0, 4, 3)), two, two, np.zeros(0, np.int64), none)
