"""What photos show of each panel, as one picture on all of them: each from the photo that shows it largest."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from groundstation.services.scenes.surfaces import Part, Surface
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, Trace, never
from planning.coverage.sections import PanelFrames, panel_frames
from planning.geo.bvh import OCCLUSION_OFFSET_M
from planning.geo.mesh import join
from planning.geo.ray_casting import RayCaster
from planning.photos.record import PhotoMetadata
from planning.site.records import SiteModel, panel_corners
from reconstruction.base.cameras import PosedPhoto

Array = NDArray[np.float64]

LEAST_FACING = 0.17
"""Cosine to a panel's normal from which a photo shows it: 80 degrees."""

ATLAS_PX2, LARGEST_PX = 4_000_000, 128
"""Pixels of the whole picture, and of one panel's side in it at most."""

SHOWN_PX = 1500
"""Width to which photos are decoded at least, where they have it: panels are not drawn larger."""


def panel_pictures(
    model: SiteModel,
    photos: Sequence[PosedPhoto],
    metadata: Sequence[PhotoMetadata],
    *,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> tuple[Surface, ...]:
    """Panels with what photos show of them; those that none shows are left out.

    Parameters
    ----------
    metadata
        Of all photos, in any order.

    Raises
    ------
    InputError
        A photo cannot be read.
    """
    import cv2

    from reconstruction.photos.decode import colour_picture

    frames = panel_frames(panel_corners(model.site))
    best = best_photos(frames, photos, model)
    shown = np.flatnonzero(best >= 0)
    if not len(shown):
        return ()
    side_px = int(np.clip(math.sqrt(ATLAS_PX2 / len(shown)), 8, LARGEST_PX))
    n_columns = math.ceil(math.sqrt(len(shown)))
    n_rows = math.ceil(len(shown) / n_columns)
    atlas = np.zeros((n_rows * side_px, n_columns * side_px, 3), np.uint8)
    # OpenCV counts from the middle of the first pixel, we from its corner.
    tile = np.array([[0, side_px], [side_px, side_px], [side_px, 0], [0, 0]], np.float32) - 0.5
    used, by_path = np.unique(best[shown]), {about.path: about for about in metadata}
    for done, number in enumerate(used):
        monitor.report(say("taking panels from photos"), done, len(used))
        photo = photos[number]
        about = by_path[photo.path]
        scale = next((each for each in (8, 4, 2) if about.width_px >= each * SHOWN_PX), 1)
        picture = colour_picture(about, scale)  # type: ignore[arg-type]
        for place in np.flatnonzero(best[shown] == number):
            corners_px = (photo.pixels(frames.corners[shown[place]]) / scale - 0.5).astype(np.float32)
            warp = cv2.getPerspectiveTransform(corners_px, tile.astype(np.float32))
            row, column = (int(part) * side_px for part in divmod(place, n_columns))
            seen = cv2.warpPerspective(picture, warp, (side_px, side_px), flags=cv2.INTER_LINEAR)
            atlas[row : row + side_px, column : column + side_px] = seen[..., ::-1]
    triangles, uv = _laid_out(frames.corners[shown], n_rows, n_columns, side_px)
    return (Surface(Part.PANES, triangles, np.full((len(triangles), 3), 255, np.uint8), uv, atlas),)


def best_photos(frames: PanelFrames, photos: Sequence[PosedPhoto], model: SiteModel) -> NDArray[np.int64]:
    """Number of the photo that shows each panel largest, all of it and with nothing before it; -1 where none does."""
    solids = RayCaster(join([model.building, *model.obstacles]))
    before = frames.centroids + OCCLUSION_OFFSET_M * frames.normals
    best, largest = np.full(len(frames), -1, np.int64), np.zeros(len(frames))
    for number, photo in enumerate(photos):
        eye = np.asarray(photo.pose.position_enu_m, np.float64)
        towards = eye - frames.centroids
        facing = np.einsum("mx,mx->m", towards, frames.normals) / np.linalg.norm(towards, axis=1)
        is_seen = photo.sees(frames.corners.reshape(-1, 3)).reshape(-1, 4).all(axis=1) & (facing > LEAST_FACING)
        candidates = np.flatnonzero(is_seen)
        if not len(candidates):
            continue
        corners_px = photo.pixels(frames.corners[candidates].reshape(-1, 3)).reshape(-1, 4, 2)
        one, other = corners_px[:, 2] - corners_px[:, 0], corners_px[:, 3] - corners_px[:, 1]
        area = 0.5 * np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])
        is_larger = area > largest[candidates]
        candidates, area = candidates[is_larger], area[is_larger]
        is_free = solids.cast(np.broadcast_to(eye, (len(candidates), 3)), before[candidates] - eye).distance_m >= 1.0
        best[candidates[is_free]], largest[candidates[is_free]] = number, area[is_free]
    return best


def _laid_out(corners: Array, n_rows: int, n_columns: int, side_px: int) -> tuple[Array, NDArray[np.float32]]:
    """Two triangles for each panel, shape (2 m, 3, 3), and their places in the picture, shape (2 m, 3, 2)."""
    rows, columns = np.divmod(np.arange(len(corners)), n_columns)
    # Half a pixel inside: between its neighbours a panel would take their colours.
    edge = 0.5 / side_px
    square = np.array([[edge, edge], [1.0 - edge, edge], [1.0 - edge, 1.0 - edge], [edge, 1.0 - edge]])
    u = (columns[:, None] + square[:, 0]) / n_columns
    v = 1.0 - (rows[:, None] + 1.0 - square[:, 1]) / n_rows
    uv = np.stack([u, v], axis=2)
    order = np.array([[0, 1, 2], [0, 2, 3]])
    return corners[:, order].reshape(-1, 3, 3), uv[:, order].reshape(-1, 3, 2).astype(np.float32)
