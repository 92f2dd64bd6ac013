"""Things of a street as meshes: houses, trees, cars and people, of boxes and bent spheres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.geo.mesh import TriangleMesh, box_mesh, from_corners, join
from planning.site.records import panel_triangles
from reconstruction.scenes.world.streets import Street

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Part:
    """A box about a thing's middle, metres: lengths along and across, and its bottom and top."""

    along: tuple[float, float]
    across: tuple[float, float]
    up: tuple[float, float]


CAR_PAINT = (Part((-2.2, 2.2), (-0.9, 0.9), (0.35, 0.85)), Part((-1.3, 1.0), (-0.8, 0.8), (1.35, 1.45)))
CAR_DARK = (
    Part((-1.3, 1.0), (-0.78, 0.78), (0.85, 1.35)),
    *(Part((x - 0.32, x + 0.32), (y - 0.1, y + 0.1), (0.0, 0.64)) for x in (-1.4, 1.4) for y in (-0.82, 0.82)),
)
PERSON_CLOTHES = (Part((-0.23, 0.23), (-0.14, 0.14), (0.8, 1.45)),)
PERSON_DARK = (Part((-0.16, 0.16), (-0.1, 0.1), (0.0, 0.8)),)
PERSON_SKIN = (Part((-0.1, 0.1), (-0.11, 0.11), (1.45, 1.72)),)


def boxes(street: Street, along_m: float, across_m: float, parts: tuple[Part, ...], size: float = 1.0) -> TriangleMesh:
    """Closed boxes at a place of a street, normals outwards."""
    meshes = []
    for part in parts:
        low, high = (np.array([pair[i] for pair in (part.along, part.across, part.up)]) * size for i in (0, 1))
        box = box_mesh(low, high)
        placed = street.points_enu_m(box.vertices_enu_m + np.array([along_m, across_m, 0.0]))
        # Along, outwards, up is left-handed: the triangles are turned over.
        meshes.append(TriangleMesh(placed, box.triangles[:, ::-1]))
    return join(meshes)


def walls(outline_enu_m: Array, bottom_m: float, top_m: float) -> TriangleMesh:
    """Upright walls over a convex outline, shape (k, 2), counter-clockwise seen from above; normals outwards."""
    following = np.roll(outline_enu_m, -1, axis=0)
    quads = np.stack(
        [
            np.insert(outline_enu_m, 2, bottom_m, axis=1),
            np.insert(following, 2, bottom_m, axis=1),
            np.insert(following, 2, top_m, axis=1),
            np.insert(outline_enu_m, 2, top_m, axis=1),
        ],
        axis=1,
    )
    return from_corners(panel_triangles(quads))


def flat(outline_enu_m: Array, height_m: float) -> TriangleMesh:
    """Level quad over an outline, shape (4, 2), counter-clockwise seen from above; it looks upwards."""
    return from_corners(panel_triangles(np.insert(outline_enu_m, 2, height_m, axis=1)[None]))


def crown(rng: np.random.Generator, middle_enu_m: Array, radius_m: float) -> TriangleMesh:
    """Crown of a tree: four dented spheres that overlap."""
    sphere = _sphere()
    meshes = []
    for _ in range(4):
        middle = middle_enu_m + rng.uniform(-0.5, 0.5, 3) * radius_m
        dents = rng.uniform(0.75, 1.1, (len(sphere.vertices_enu_m), 1)) * rng.uniform(0.6, 0.8) * radius_m
        meshes.append(TriangleMesh(middle + sphere.vertices_enu_m * dents, sphere.triangles))
    return join(meshes)


def _sphere() -> TriangleMesh:
    """Unit sphere of 128 triangles: an octahedron whose faces are divided twice; normals outwards."""
    signs = np.array([[x, y, z] for x in (1, -1) for y in (1, -1) for z in (1, -1)], float)
    corners = signs[:, :, None] * np.eye(3)
    # Mirrored an odd number of times, a face is turned over.
    corners = np.where((signs.prod(axis=1) < 0)[:, None, None], corners[:, ::-1], corners)
    for _ in range(2):
        middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
        a, b, c = (corners[:, i] for i in range(3))
        ab, bc, ca = (middles[:, i] for i in range(3))
        corners = np.concatenate(
            [np.stack(part, axis=1) for part in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
        )
    points, triangles = np.unique(corners.reshape(-1, 3).round(9), axis=0, return_inverse=True)
    points = points / np.linalg.norm(points, axis=1, keepdims=True)
    return TriangleMesh(points, triangles.reshape(-1, 3).astype(np.int64))
