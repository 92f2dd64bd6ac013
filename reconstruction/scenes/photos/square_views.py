"""Views of a scene's facades from before them, as a first flight takes them to look for panels."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planning.geo.mesh import join
from planning.geo.solids import Solids
from planning.plan import Viewpoint
from planning.site.records import Facade
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.scenes.photos.flight_views import BETWEEN, Shot, posed_photos
from reconstruction.scenes.record import Scene

Array = NDArray[np.float64]

MOST_ASIDE_DEG, MOST_ABOVE_DEG = 20.0, 8.0
"""From square on: so far pilots stray on purpose, lest they mirror in the glass themselves."""

LOWEST_M = 2.0
"""Of a camera above the foot of the flight's airspace."""

CLEARANCE_M, FARTHEST_M = 2.0, 500.0
STEP = 1.08
"""Factor by which a camera moves back until it sees the whole facade, and then nearer until nothing is in its place."""


def square_shots(scene: Scene, lens: Intrinsics, n: int, seed: int = 0) -> tuple[Shot, ...]:
    """Shots of all facades in turn, each from up to 20 degrees aside and 8 degrees above or below square on.

    Where something is in the way the camera stands before it, and shows a part of the facade.
    """
    site, rng = scene.site.site, np.random.default_rng([seed, n])
    solids = Solids.of(join([scene.site.building, *scene.site.obstacles]).corners_enu_m)
    lowest_m = site.airspace.ground_z_m + LOWEST_M
    shots = []
    for number in range(n):
        facade = site.facades[number % len(site.facades)]
        aside, above = np.radians(rng.uniform(-1.0, 1.0, 2) * (MOST_ASIDE_DEG, MOST_ABOVE_DEG))
        view = _view(f"s{number:04d}", facade, lens, float(aside), float(above), solids, lowest_m)
        shots.append(Shot(view, number * BETWEEN))
    return tuple(shots)


def square_photos(scene: Scene, lens: Intrinsics, n: int, folder: Path, seed: int = 0) -> tuple[PosedPhoto, ...]:
    """The photos of `square_shots`, to lie in `folder`."""
    return posed_photos(square_shots(scene, lens, n, seed), lens, folder)


def _view(
    name: str, facade: Facade, lens: Intrinsics, aside: float, above: float, solids: Solids, lowest_m: float
) -> Viewpoint:
    corners = np.array([panel.corners_enu_m for panel in facade.panels], float)
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]).sum(axis=0)
    normal /= np.linalg.norm(normal)
    points = corners.reshape(-1, 3)
    right = np.cross([0.0, 0.0, 1.0], normal)
    if np.linalg.norm(right) < 1e-6:  # a roof
        right = np.array([1.0, 0.0, 0.0])
    right /= np.linalg.norm(right)
    up = np.cross(normal, right)
    extents = [(points @ axis).min() + (points @ axis).max() for axis in (right, up, normal)]
    middle = sum(0.5 * extent * axis for extent, axis in zip(extents, (right, up, normal), strict=True))
    towards = math.cos(above) * (math.cos(aside) * normal + math.sin(aside) * right) + math.sin(above) * up

    def at(distance_m: float) -> Viewpoint:
        position = middle + distance_m * towards
        position[2] = max(position[2], lowest_m)
        east, north, up_m = (middle - position).tolist()
        heading, pitch = math.atan2(east, north), math.atan2(up_m, math.hypot(east, north))
        x, y, z = position.tolist()
        return Viewpoint(name, (x, y, z), math.degrees(heading), math.degrees(pitch))

    distance = CLEARANCE_M
    while distance < FARTHEST_M and not lens.is_seen(Pose.of(at(distance)).points_cam(points)).all():
        distance *= STEP
    while distance > CLEARANCE_M and not solids.clearance_m(np.array([at(distance).position_enu_m]))[0] > CLEARANCE_M:
        distance /= STEP
    return at(distance)
