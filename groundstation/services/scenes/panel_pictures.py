"""What photos show of each panel and of walls, each piece from the photo that shows it largest."""

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
from planning.geo.mesh import TriangleMesh, join
from planning.geo.ray_casting import RayCaster
from planning.photos.record import PhotoMetadata
from planning.site.records import SiteModel, panel_corners
from reconstruction.base.cameras import PosedPhoto

Array = NDArray[np.float64]

LEAST_FACING = 0.17
"""Cosine to a panel's normal from which a photo shows it: 80 degrees."""

ATLAS_PX2, LARGEST_PX = 4_000_000, 128
"""Pixels of the whole picture, and of one panel's side in it at most."""

TILE_M, MOST_TILES = 3.0, 3000
"""Length of the sides of pieces of walls, each of which one photo shows whole; and how many there are at most."""

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
    """Panels and walls with what photos show of them; pieces that none shows are left out.

    Parameters
    ----------
    metadata
        Of all photos, in any order.

    Raises
    ------
    InputError
        A photo cannot be read.
    """
    from reconstruction.photos.decode import colour_picture

    panes = _Atlas(panel_corners(model.site), photos, model)
    atlases = (panes, _Atlas(wall_tiles(model.building), photos, model, half=True))
    used = np.unique(np.concatenate([atlas.best for atlas in atlases]))
    by_path = {about.path: about for about in metadata}
    for done, number in enumerate(used):
        monitor.report(say("taking panels from photos"), done, len(used))
        photo = photos[number]
        about = by_path[photo.path]
        scale = next((each for each in (8, 4, 2) if about.width_px >= each * SHOWN_PX), 1)
        picture = colour_picture(about, scale)  # type: ignore[arg-type]
        for atlas in atlases:
            atlas.take(number, photo, picture, scale)
    parts = zip((Part.PANES, Part.WALLS), atlases, strict=True)
    return tuple(atlas.surface(part) for part, atlas in parts if len(atlas.best))


class _Atlas:
    """Parallelograms that photos show, each with a square of one picture.

    Parameters
    ----------
    corners_enu_m
        Of all, shape (m, 4, 3), counter-clockwise as seen from outside; those that no photo shows are left out.
    half
        Only the triangle of the first three corners is drawn.
    """

    def __init__(
        self, corners_enu_m: Array, photos: Sequence[PosedPhoto], model: SiteModel, *, half: bool = False
    ) -> None:
        best = best_photos(panel_frames(corners_enu_m), photos, model)
        self.best, self._corners = best[best >= 0], corners_enu_m[best >= 0]
        n = max(1, len(self.best))
        self._side_px = int(np.clip(math.sqrt(ATLAS_PX2 / n), 8, LARGEST_PX))
        self._n_columns = math.ceil(math.sqrt(n))
        self._n_rows = math.ceil(n / self._n_columns)
        self._order = np.array([[0, 1, 2]] if half else [[0, 1, 2], [0, 2, 3]])
        self._picture = np.zeros((self._n_rows * self._side_px, self._n_columns * self._side_px, 3), np.uint8)

    def take(self, number: int, photo: PosedPhoto, picture: NDArray[np.uint8], scale: int) -> None:
        """Fill the squares of those that this photo, decoded at a part of its size, shows best."""
        import cv2

        side_px = self._side_px
        # OpenCV counts from the middle of the first pixel, we from its corner.
        square = np.array([[0, side_px], [side_px, side_px], [side_px, 0], [0, 0]], np.float32) - 0.5
        for place in np.flatnonzero(self.best == number):
            corners_px = (photo.pixels(self._corners[place]) / scale - 0.5).astype(np.float32)
            warp = cv2.getPerspectiveTransform(corners_px, square.astype(np.float32))
            row, column = (int(part) * side_px for part in divmod(place, self._n_columns))
            seen = cv2.warpPerspective(picture, warp, (side_px, side_px), flags=cv2.INTER_LINEAR)
            self._picture[row : row + side_px, column : column + side_px] = seen[..., ::-1]

    def surface(self, part: Part) -> Surface:
        """All of them with the picture."""
        uv = _laid_out(len(self.best), self._n_rows, self._n_columns, self._side_px)
        triangles = self._corners[:, self._order].reshape(-1, 3, 3)
        places = uv[:, self._order].reshape(-1, 3, 2).astype(np.float32)
        return Surface(part, triangles, np.full((len(triangles), 3), 255, np.uint8), places, self._picture)


def wall_tiles(building: TriangleMesh) -> Array:
    """Parallelograms, shape (k, 4, 3), whose first three corners are pieces of the building's triangles.

    Each triangle is cut into equal ones of some `TILE_M`, or into larger ones where that makes more than `MOST_TILES`.
    The fourth corner lies across the longest side, so that a tile is about as wide as it is high.
    """
    corners = building.corners_enu_m
    sides_m = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    has_area = np.linalg.norm(across, axis=1) > 1e-9
    corners, sides_m = corners[has_area], sides_m[has_area]
    if not 0 < len(corners) <= MOST_TILES:
        return np.zeros((0, 4, 3))
    n_cuts = np.ceil(sides_m.max(axis=1) / TILE_M)
    n_cuts = np.maximum(1, n_cuts / max(1.0, math.sqrt((n_cuts**2).sum() / MOST_TILES))).astype(np.int64)
    # The longest side from the third corner back to the first.
    start = (sides_m.argmax(axis=1) + 1) % 3
    corners = corners[np.arange(len(corners))[:, None], (start[:, None] + np.arange(3)) % 3]
    tiles = []
    for n in np.unique(n_cuts):
        i, j = np.mgrid[:n, :n]
        low = np.stack([i, j], axis=-1)[i + j < n]
        high = np.stack([i, j], axis=-1)[i + j < n - 1] + 1
        # Places along the sides that leave the second corner; in every other piece both sides are turned round.
        pieces = np.concatenate(
            [low[:, None] + np.array([[1, 0], [0, 0], [0, 1]]), high[:, None] - np.array([[1, 0], [0, 0], [0, 1]])]
        )
        a, b, c = corners[n_cuts == n].transpose(1, 0, 2)[:, :, None, None]
        tiles.append((b + (pieces[..., :1] * (a - b) + pieces[..., 1:] * (c - b)) / n).reshape(-1, 3, 3))
    found = np.concatenate(tiles)
    return np.concatenate([found, (found[:, 0] + found[:, 2] - found[:, 1])[:, None]], axis=1)


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


def _laid_out(n: int, n_rows: int, n_columns: int, side_px: int) -> Array:
    """Places in the picture of the corners of `n` squares, shape (n, 4, 2)."""
    rows, columns = np.divmod(np.arange(n), n_columns)
    # Half a pixel inside: between its neighbours a panel would take their colours.
    edge = 0.5 / side_px
    square = np.array([[edge, edge], [1.0 - edge, edge], [1.0 - edge, 1.0 - edge], [edge, 1.0 - edge]])
    u = (columns[:, None] + square[:, 0]) / n_columns
    v = 1.0 - (rows[:, None] + 1.0 - square[:, 1]) / n_rows
    return np.stack([u, v], axis=2)
