"""Rendering a synthetic facade by asking, for places in the photo, what is seen there.

One sample a pixel, nine where the pixel or a neighbour of it lies on an edge. The geometry is exact but for one thing:
panes on a cylinder are bent with it, while they mirror as flat ones.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime, timedelta
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.jit import chunks, run_chunks
from planning.base.json_file import write_atomically
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.frames import Origin
from reconstruction.base.cameras import Pose, PosedPhoto
from reconstruction.photos.write import photo_jpeg, photo_name
from reconstruction.scenes.facades.cases import Grid, grid_of_layout
from reconstruction.scenes.facades.record import Case, Disturbances, SyntheticFacade, TruePanel
from reconstruction.scenes.facades.scene import FACADE_KINDS, Scene, build_scene, kinds, panel_numbers

# Made photos as files, with where and how they were taken written into them as DJI's cameras do.

FIRST_AT, BETWEEN = datetime(2024, 5, 1, 10, 0, 0), timedelta(seconds=5)


def write_photos(
    folder: Path, photos: Sequence[tuple[PosedPhoto, NDArray[np.uint8]]], origin: Origin
) -> tuple[Path, ...]:
    """Write JPEG files with RTK positions, gimbal angles and a calibrated lens; returns their paths.

    Parameters
    ----------
    photos
        Cameras in the frame of `origin`, and their pictures, shape (h, w, 3), blue, green, red.

    Raises
    ------
    InputError
        The folder cannot be written.
    """
    paths = []
    for number, (photo, picture) in enumerate(photos):
        taken_at = FIRST_AT + number * BETWEEN
        path = folder / photo_name(number + 1, taken_at)
        try:
            folder.mkdir(parents=True, exist_ok=True)
            write_atomically(path, photo_jpeg(picture, photo, origin, taken_at))
        except OSError as error:
            raise InputError(say("cannot be written ({})", error.strerror or error, place=path)) from error
        paths.append(path)
    return tuple(paths)


SAMPLES_PER_CALL = 16_384
"""Keeps the arrays of intermediate results in the processor's cache."""

FINE = 3
"""Samples along each side of a pixel on an edge."""

BLUR_REACH = 4.0
"""Half size of the blur's kernel, standard deviations."""


def render_facade(case: Case, monitor: Monitor = QUIET) -> SyntheticFacade:
    """Render a case; the same case gives the same photo, bit for bit."""
    rng = np.random.default_rng(case.seed)
    grid = grid_of_layout(case.layout, rng)
    scene = build_scene(case, grid, rng)
    intrinsics = case.truth.intrinsics
    height, width = intrinsics.height_px, intrinsics.width_px
    monitor.report(say("rendering"), 0, 2)
    x, y = np.arange(width, dtype=np.float32) + np.float32(0.5), np.arange(height, dtype=np.float32) + np.float32(0.5)
    colours, keys = _sampled(scene, np.tile(x, height), np.repeat(y, width))
    picture = colours.reshape(height, width, 3)
    key_image = keys.reshape(height, width)
    monitor.report(say("rendering"), 1, 2)
    _refine(scene, picture, _on_edges(key_image))
    return SyntheticFacade(
        case=case,
        image=_developed(picture, case.disturbances, rng),
        index=panel_numbers(key_image).astype(np.uint16),
        facade=np.isin(kinds(key_image), FACADE_KINDS),
        panels=_true_panels(case, grid),
        columns_m=grid.columns_m,
        rows_m=grid.rows_m,
        missing=tuple((int(row), int(column)) for row, column in np.argwhere((grid.panel_numbers == 0).all(axis=2))),
        photo=replace(case.truth, pose=_turned(case.truth.pose, case.disturbances.yaw_error_deg)),
    )


def _sampled(
    scene: Scene, x: NDArray[np.float32], y: NDArray[np.float32]
) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    colours, keys = np.empty((len(x), 3), np.float32), np.empty(len(x), np.int32)

    def shade(start: int, stop: int) -> None:
        colours[start:stop], keys[start:stop] = scene.look(x[start:stop], y[start:stop])

    run_chunks(shade, chunks(len(x), SAMPLES_PER_CALL))
    return colours, keys


def _on_edges(keys: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Pixels beside which something else is seen, and their neighbours."""
    differs = np.zeros(keys.shape, np.uint8)
    differs[:, 1:] |= keys[:, 1:] != keys[:, :-1]
    differs[1:] |= keys[1:] != keys[:-1]
    return np.asarray(cv2.dilate(differs, np.ones((3, 3), np.uint8)), bool)


def _refine(scene: Scene, picture: NDArray[np.float32], is_fine: NDArray[np.bool_]) -> None:
    rows, columns = np.nonzero(is_fine)
    if not len(rows):
        return
    offsets = ((np.arange(FINE) + 0.5) / FINE).astype(np.float32)
    x = columns[:, None, None].astype(np.float32) + offsets[None, None, :] + np.zeros((1, FINE, 1), np.float32)
    y = rows[:, None, None].astype(np.float32) + offsets[None, :, None] + np.zeros((1, 1, FINE), np.float32)
    colours, _ = _sampled(scene, x.ravel(), y.ravel())
    picture[rows, columns] = colours.reshape(len(rows), FINE * FINE, 3).mean(axis=1)


def _developed(picture: NDArray[np.float32], disturbances: Disturbances, rng: np.random.Generator) -> NDArray[np.uint8]:
    """Blur, noise, and 8 bits."""
    if disturbances.blur_px > 0.0:
        reach = 2 * math.ceil(BLUR_REACH * disturbances.blur_px) + 1
        picture = np.asarray(cv2.GaussianBlur(picture, (reach, reach), disturbances.blur_px), np.float32)
    noise = np.zeros_like(picture)
    if disturbances.noise_grey > 0.0:
        rng.standard_normal(out=noise, dtype=np.float32)
        noise *= np.float32(disturbances.noise_grey)
    return np.asarray(cv2.add(picture, noise, dtype=cv2.CV_8U), np.uint8)


def _true_panels(case: Case, grid: Grid) -> tuple[TruePanel, ...]:
    panels = []
    for row, column, part in np.argwhere(grid.panel_numbers > 0):
        corners = grid.corners(row, column, part)
        corners_enu_m = case.wall.points_enu_m(corners[:, 0], corners[:, 1])
        panels.append(TruePanel(int(row), int(column), corners_enu_m, case.truth.pixels(corners_enu_m)))
    return tuple(panels)


def _turned(pose: Pose, clockwise_deg: float) -> Pose:
    """The pose with its heading changed."""
    angle = math.radians(clockwise_deg)
    cos, sin = math.cos(angle), math.sin(angle)
    turn = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return Pose(pose.position_enu_m, pose.cam_from_enu @ turn.T, pose.covariance)
