"""Cameras of a planned or flown flight, as the photos that are to be rendered."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from itertools import groupby
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planning.geo.frames import Vec3
from planning.geo.mesh import join
from planning.geo.solids import Solids
from planning.plan import Camera, Plan, Viewpoint
from planning.site.ground import height_at
from planning.site.records import Facade, Site
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.photos.write import photo_name
from reconstruction.scenes.parameters import WIDTHS_PX
from reconstruction.scenes.photos.camera_model import SHUTTER_S, CameraModel, Moment, bent_lens
from reconstruction.scenes.record import Scene

Array = NDArray[np.float64]


FIRST_AT, BETWEEN = datetime(2024, 5, 1, 10, 0, 0), timedelta(seconds=5)
"""When photos of a plan, which has no clock, are said to be taken."""

BETWEEN_SORTIES = timedelta(hours=1)
"""From the start of a flown sortie's record to that of the next; records count their own time."""

SAME_PLACE_M = 0.01
"""Two places nearer to each other than this give no direction."""


@dataclass(frozen=True, slots=True)
class Shot:
    """Where a camera was and looked, and when.

    Parameters
    ----------
    at
        Counts from the first sortie's start.
    sortie
        Photos of one are told wrong alike.
    velocity_enu_m_s
        At the shutter; planned aircraft stop for every photo.
    exposure_s
        How long the shutter was open, where that is known.
    """

    view: Viewpoint
    at: timedelta
    sortie: int = 0
    velocity_enu_m_s: Vec3 = (0.0, 0.0, 0.0)
    exposure_s: float | None = None


def planned_shots(plan: Plan) -> tuple[Shot, ...]:
    """Shots of a plan in the order of flight; viewpoints that are in no sortie come last."""
    in_order = [(id_, number) for number, sortie in enumerate(plan.sorties) for id_ in sortie.viewpoint_ids]
    place = {id_: (index, number) for index, (id_, number) in enumerate(in_order)}
    last = len(in_order), len(plan.sorties)
    views = sorted(plan.viewpoints, key=lambda view: place.get(view.id, last)[0])
    return tuple(Shot(view, n * BETWEEN, place.get(view.id, last)[1]) for n, view in enumerate(views))


def lens_of(camera: Camera, width_px: int | None = None, camera_model: CameraModel | None = None) -> Intrinsics:
    """Of a planned camera whose pictures are made `width_px` wide, in the same shape; None: as the camera takes them.

    Raises
    ------
    ValueError
        The width cannot be one of a picture.
    InputError
        The distortion folds the picture.
    """
    lens = Intrinsics.of(camera)
    if camera_model is not None:
        lens = bent_lens(lens, camera_model.distortion)
    if width_px is None:
        return lens
    if not WIDTHS_PX[0] <= width_px <= WIDTHS_PX[1]:
        raise ValueError(f"width_px: expected {WIDTHS_PX[0]} to {WIDTHS_PX[1]}, got {width_px}")
    return lens.scaled(width_px, max(1, round(width_px * lens.height_px / lens.width_px)))


def posed_photos(shots: Iterable[Shot], lens: Intrinsics, folder: Path) -> tuple[PosedPhoto, ...]:
    """Photos of shots, in the order of time, named as DJI's cameras name them, to lie in `folder`."""
    photos = []
    for number, shot in enumerate(_in_order(shots), 1):
        taken_at = FIRST_AT + shot.at
        name = photo_name(number, taken_at)
        photos.append(PosedPhoto(name, folder / name, lens, Pose.of(shot.view), taken_at))
    return tuple(photos)


def moments(shots: Iterable[Shot], camera_model: CameraModel) -> tuple[Moment, ...]:
    """How the photos of shots come about, in the order of `posed_photos`."""
    found = []
    for sortie, group in groupby(_in_order(shots), key=lambda shot: shot.sortie):
        row = list(group)
        velocities: Array = np.array([shot.velocity_enu_m_s for shot in row], np.float64)
        if camera_model.speed_m_s is not None:
            velocities = camera_model.speed_m_s * _courses(row)
        for shot, (east, north, up) in zip(row, velocities.tolist(), strict=True):
            known_s = SHUTTER_S if shot.exposure_s is None else shot.exposure_s
            exposure_s = known_s if camera_model.shutter_s is None else camera_model.shutter_s
            found.append(Moment(sortie, (east, north, up), exposure_s))
    return tuple(found)


def _in_order(shots: Iterable[Shot]) -> list[Shot]:
    return sorted(shots, key=lambda shot: shot.at)


def _courses(row: Sequence[Shot]) -> Array:
    """Unit vectors along which a row of shots is passed: from the one before to the one after, shape (n, 3).

    To the right of the camera where these are in one place.
    """
    places = np.array([shot.view.position_enu_m for shot in row])
    if len(row) == 1:
        chords = np.zeros((1, 3))
    else:
        following, before = np.minimum(np.arange(len(row)) + 1, len(row) - 1), np.maximum(np.arange(len(row)) - 1, 0)
        chords = places[following] - places[before]
    lengths = np.linalg.norm(chords, axis=1, keepdims=True)
    rights = np.array([Pose.of(shot.view).cam_from_enu[0] for shot in row])
    return np.asarray(np.where(lengths > SAME_PLACE_M, chords / np.maximum(lengths, SAME_PLACE_M), rights))


def flown_shots(
    sorties: Sequence[Sequence[tuple[Viewpoint, float]]],
    motions: Sequence[Sequence[tuple[Vec3, float | None]]] | None = None,
) -> tuple[Shot, ...]:
    """Shots of a flight.

    Parameters
    ----------
    sorties
        Each one's poses with seconds since the start of its record.
    motions
        Velocity at the shutter (ENU) and exposure in seconds (None where it is not known) of each; none: all hovered.
    """
    held: tuple[Vec3, float | None] = ((0.0, 0.0, 0.0), None)
    rows = [[held] * len(sortie) for sortie in sorties] if motions is None else motions
    return tuple(
        Shot(view, number * BETWEEN_SORTIES + timedelta(seconds=time_s), number, velocity, exposure_s)
        for number, (sortie, row) in enumerate(zip(sorties, rows, strict=True))
        for (view, time_s), (velocity, exposure_s) in zip(sortie, row, strict=True)
    )


# Views of a scene's facades from before them, as a first flight takes them to look for panels.

MOST_ASIDE_DEG, MOST_ABOVE_DEG = 20.0, 8.0
"""From square on: so far pilots stray on purpose, lest they mirror in the glass themselves."""

LOWEST_M = 2.0
"""Of a camera above the ground."""

CLEARANCE_M, FARTHEST_M = 2.0, 500.0
STEP = 1.08
"""Factor by which a camera moves back until it sees the whole facade, and then nearer until nothing is in its place."""


def square_shots(scene: Scene, lens: Intrinsics, n: int, seed: int = 0) -> tuple[Shot, ...]:
    """Shots of all facades in turn, each from up to 20 degrees aside and 8 degrees above or below square on.

    Where something is in the way the camera stands before it, and shows a part of the facade.
    """
    site, rng = scene.site.site, np.random.default_rng([seed, n])
    solids = Solids.of(join([scene.site.building, *scene.site.obstacles]).corners_enu_m)
    shots = []
    for number in range(n):
        facade = site.facades[number % len(site.facades)]
        aside, above = np.radians(rng.uniform(-1.0, 1.0, 2) * (MOST_ASIDE_DEG, MOST_ABOVE_DEG))
        view = _view(f"s{number:04d}", facade, lens, float(aside), float(above), solids, site)
        shots.append(Shot(view, number * BETWEEN))
    return tuple(shots)


def square_photos(scene: Scene, lens: Intrinsics, n: int, folder: Path, seed: int = 0) -> tuple[PosedPhoto, ...]:
    """The photos of `square_shots`, to lie in `folder`."""
    return posed_photos(square_shots(scene, lens, n, seed), lens, folder)


def _view(
    name: str, facade: Facade, lens: Intrinsics, aside: float, above: float, solids: Solids, site: Site
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
        position[2] = max(position[2], height_at(site, float(position[0]), float(position[1])) + LOWEST_M)
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
