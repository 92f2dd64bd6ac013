"""Trees of boxes that leave no place from which a hemisphere section is seen, in the words of `plan.proof`.

The airspace is halved again and again, as in `planning.coverage.reach_kernel`, until each box is excluded for one
of the reasons that the verifier knows. Each test here keeps more slack than its own:

- a plane has the section on one side and the box on the other: behind the panel, beside the section's wedge, outside
  its outer cone, or beyond the largest distance;
- the box lies too low above the terrain;
- the box lies in a convex cone where no place of the section is: below its ring, or out of the gimbal's reach;
- each corner is nearer than the minimum distance to one triangle, and so is then every place of the box;
- the box lies in the shadow of a patch of triangles, as seen from where lines of sight end.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import inline, kernel
from planning.coverage.reach_kernel import is_too_low
from planning.geo.bvh import Bvh, build_bvh, point_triangle_d2

Array = NDArray[np.float64]

SLACK_M = 4e-7
RATIO_SLACK = 4e-9

HEIGHT_SLACK_M = 2e-3
"""The verifier keeps 1 mm: beside steep cells the last digits of a box's border make more than of other lengths."""

PLANE, CONE, CUT_X, LOW = -1, -2, -5, -6
"""Codes of leaves and cuts (X, Y, Z: -5, -4, -3); triangle k is 2 k, patch k is 2 k + 1."""

SMALLEST_M = 0.01
"""Boxes with a smaller half diagonal are not halved."""


class Panel(NamedTuple):
    """What a section is to the search: rows as in the verifier.

    `sides` has the three vectors along which places of the section have no negative part; `outer` the sine and cosine
    of its outer cone, `cones` the axes (k, 3) and cosines (k,) of those in which it has no place.
    """

    centroid: Array
    axes: Array
    sides: Array
    outer: Array
    cone_axes: Array
    cone_cosines: Array


class Terrain(NamedTuple):
    """Upper bounds of the ground (rows, columns), without any where it is level; west, south and step; height kept."""

    z: Array
    grid: tuple[float, float, float]
    min_height: float


class Shadows(NamedTuple):
    """Patches as seen from one target.

    `faces` (f, 6) are inward normals and a corner, `edges` (e, 3) normals of the planes through the target and the
    silhouette; the starts of each patch in them have shape (p + 1,).
    """

    eye: Array
    faces: Array
    face_starts: NDArray[np.int64]
    edges: Array
    edge_starts: NDArray[np.int64]
    numbers: NDArray[np.int64]


@inline
def _most(m0: float, m1: float, m2: float, offset: Array, half: Array) -> float:
    """Largest part along m of a box with half sizes `half`, centre at `offset`."""
    return float(
        m0 * offset[0] + m1 * offset[1] + m2 * offset[2]
        + abs(m0) * half[0] + abs(m1) * half[1] + abs(m2) * half[2]
    )  # fmt: skip


@kernel
def _is_beyond_plane(offset: Array, half: Array, panel: Panel, far: float) -> bool:
    sides, axes = panel.sides, panel.axes
    for i in range(3):
        if _most(sides[i, 0], sides[i, 1], sides[i, 2], offset, half) <= -SLACK_M:
            return True
    u = offset[0] * axes[1, 0] + offset[1] * axes[1, 1] + offset[2] * axes[1, 2]
    v = offset[0] * axes[2, 0] + offset[1] * axes[2, 1] + offset[2] * axes[2, 2]
    side = np.sqrt(u * u + v * v)
    if not side > 10.0 * SLACK_M:
        return False
    sine, u, v = panel.outer[0], panel.outer[1] * (u / side), panel.outer[1] * (v / side)
    m0 = sine * axes[0, 0] - (axes[1, 0] * u + axes[2, 0] * v)
    m1 = sine * axes[0, 1] - (axes[1, 1] * u + axes[2, 1] * v)
    m2 = sine * axes[0, 2] - (axes[1, 2] * u + axes[2, 2] * v)
    if _most(m0, m1, m2, offset, half) <= -SLACK_M:
        return True
    away = np.sqrt(offset[0] ** 2 + offset[1] ** 2 + offset[2] ** 2)
    return bool(_most(-offset[0] / away, -offset[1] / away, -offset[2] / away, offset, half) <= -far - SLACK_M)


@kernel
def _is_in_cone(offset: Array, half: Array, panel: Panel) -> bool:
    for i in range(len(panel.cone_cosines)):
        inside = True
        for corner in range(8):
            along, norm = 0.0, 0.0
            for k in range(3):
                x = offset[k] + (half[k] if corner >> k & 1 else -half[k])
                along += x * panel.cone_axes[i, k]
                norm += x * x
            if not along >= panel.cone_cosines[i] * np.sqrt(norm) + SLACK_M:
                inside = False
                break
        if inside:
            return True
    return False


@kernel
def _is_near(centre: Array, half: Array, triangle: Array, near: float, corner: Array) -> bool:
    """Whether all corners of a box are nearer to a triangle, the one that looks farthest first; `corner` is room."""
    reach = near - SLACK_M
    if reach <= 0.0:
        return False
    first = 0
    for k in range(3):
        if 3.0 * centre[k] >= triangle[0, k] + triangle[1, k] + triangle[2, k]:
            first |= 1 << k
    for i in range(8):
        for k in range(3):
            corner[k] = centre[k] + (half[k] if (i ^ first) >> k & 1 else -half[k])
        if not point_triangle_d2(corner, triangle) <= reach * reach:
            return False
    return True


@kernel
def _near_triangle(centre: Array, half: Array, bvh: Bvh, near: float) -> int:
    """A triangle to which the whole box is nearer than `near`, by its number in the source; -1 for none."""
    if len(bvh.corners) == 0:
        return -1
    stack, corner = np.empty(64, np.int64), np.empty(3)
    stack[0], depth = 0, 1
    while depth > 0:
        depth -= 1
        node = stack[depth]
        d2 = 0.0
        for k in range(3):
            # As far as the farthest place of the box along each axis: no triangle of the node is nearer to that.
            gap = max(bvh.low[node, k] - centre[k], centre[k] - bvh.high[node, k])
            gap = max(gap + half[k], 0.0) if gap > 0.0 else 0.0
            d2 += gap * gap
        if d2 > near * near:
            continue
        child = bvh.child[node]
        if child < 0:
            for i in range(bvh.first[node], bvh.first[node] + bvh.size[node]):
                if _is_near(centre, half, bvh.corners[i], near, corner):
                    return int(bvh.source[i])
        else:
            stack[depth], stack[depth + 1] = child, child + 1
            depth += 2
    return -1


@kernel
def _shadow(centre: Array, half: Array, shadows: Shadows) -> int:
    """A patch whose shadow holds the box, by its number; -1 for none."""
    offset, to_corner = np.empty(3), np.empty(3)
    away2, size2 = 0.0, 0.0
    for k in range(3):
        offset[k] = centre[k] - shadows.eye[k]
        away2 += offset[k] * offset[k]
        size2 += half[k] * half[k]
    reach = np.sqrt(away2) + np.sqrt(size2)
    edges, faces = shadows.edges, shadows.faces
    for p in range(len(shadows.numbers)):
        hidden = True
        for i in range(shadows.edge_starts[p], shadows.edge_starts[p + 1]):
            if not _most(-edges[i, 0], -edges[i, 1], -edges[i, 2], offset, half) < -RATIO_SLACK * reach:
                hidden = False
                break
        if not hidden:
            continue
        for i in range(shadows.face_starts[p], shadows.face_starts[p + 1]):
            for k in range(3):
                to_corner[k] = centre[k] - faces[i, 3 + k]
            most = _most(-faces[i, 0], -faces[i, 1], -faces[i, 2], to_corner, half)
            if not most < -RATIO_SLACK * (reach + 100.0) - SLACK_M:
                hidden = False
                break
        if hidden:
            return int(shadows.numbers[p])
    return -1


@kernel
def exclude(
    panel: Panel,
    shadows: Shadows,
    terrain: Terrain,
    bvh: Bvh,
    low: Array,
    high: Array,
    near: float,
    far: float,
    codes: NDArray[np.int64],
) -> int:
    """Codes of a tree in `codes`, in the order of the text; how many, or 0 where no tree was found."""
    lows, highs = np.empty((256, 3)), np.empty((256, 3))
    lows[0], highs[0] = low, high
    waiting, n = 1, 0
    offset, half, centre = np.empty(3), np.empty(3), np.empty(3)
    while waiting > 0:
        waiting -= 1
        if n == len(codes):
            return 0
        for k in range(3):
            centre[k] = (lows[waiting, k] + highs[waiting, k]) * 0.5
            half[k] = (highs[waiting, k] - lows[waiting, k]) * 0.5
            offset[k] = centre[k] - panel.centroid[k]
        codes[n] = 0
        if _is_beyond_plane(offset, half, panel, far):
            codes[n] = PLANE
        elif _is_in_cone(offset, half, panel):
            codes[n] = CONE
        elif terrain.z.size > 0 and is_too_low(
            centre, half, terrain.z, terrain.grid, terrain.min_height - HEIGHT_SLACK_M
        ):
            codes[n] = LOW
        else:
            triangle = _near_triangle(centre, half, bvh, near)
            patch = _shadow(centre, half, shadows) if triangle < 0 and len(shadows.numbers) else -1
            if triangle >= 0:
                codes[n] = 2 * triangle
            elif patch >= 0:
                codes[n] = 2 * patch + 1
            else:
                if half[0] ** 2 + half[1] ** 2 + half[2] ** 2 < SMALLEST_M**2 or waiting + 2 > len(lows):
                    return 0
                axis = 0 if half[0] >= half[1] and half[0] >= half[2] else (1 if half[1] >= half[2] else 2)
                codes[n] = CUT_X + axis
                lows[waiting + 1], highs[waiting + 1] = lows[waiting], highs[waiting]
                highs[waiting + 1, axis] = centre[axis]
                lows[waiting, axis] = centre[axis]
                waiting += 2
        n += 1
    return n


def no_shadows(eye: Array) -> Shadows:
    """Of a scene in which nothing hides anything."""
    start = np.zeros(1, np.int64)
    return Shadows(eye, np.zeros((0, 6)), start, np.zeros((0, 3)), start, start[:0])


def compile_kernels() -> None:
    """Run every kernel on small inputs."""
    axes = np.eye(3)
    panel = Panel(np.zeros(3), axes, axes, np.array([1.0, 0.0]), axes[:1], np.array([0.5]))
    codes = np.empty(8, np.int64)
    terrain = Terrain(np.zeros((2, 2)), (0.0, 0.0, 1.0), 0.0)
    exclude(panel, no_shadows(np.zeros(3)), terrain, build_bvh(axes[None]), np.zeros(3), np.ones(3), 1.0, 10.0, codes)
