"""What a data set needs beyond the plain case: distortion taken away, and panels hidden behind something."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment
from planning.base.messages import say
from reconstruction.base.cameras import Intrinsics, PosedPhoto
from reconstruction.base.ray_casting import RayCaster
from reconstruction.dataset.panel_images import IN_FRONT_M, facing

Array = NDArray[np.float64]

RAY_S = 2.5e-7
"""Time per ray on two cores with a building of some ten thousand triangles."""

UNDISTORT_S_PER_MEGAPIXEL = 0.03
SAMPLED_PHOTOS = 60
GRID = 21


@dataclass(frozen=True, slots=True)
class LensDistortion:
    """Take the lens's distortion out of the photos; off, they are used as they are."""

    name: str = say("lens distortion")
    unit: str = "px"
    tolerance: float = 0.3

    def assess(self, scene: Sequence[PosedPhoto]) -> Assessment:
        """How far the distortion moves a pixel at most."""
        lenses = {photo.intrinsics for photo in scene}
        size = max((most_moved_px(lens) for lens in lenses), default=0.0)
        megapixels = sum(photo.intrinsics.width_px * photo.intrinsics.height_px for photo in scene) / 1e6
        reason = f"the lens moves pixels by up to {size:.1f} px" if size else "the photos are straight"
        return Assessment(size, reason, UNDISTORT_S_PER_MEGAPIXEL * megapixels)


def most_moved_px(lens: Intrinsics) -> float:
    """Largest distance, in the picture, between where a direction is seen and where a straight lens would show it."""
    if lens.is_straight:
        return 0.0
    x, y = np.meshgrid(np.linspace(0.0, lens.width_px, GRID), np.linspace(0.0, lens.height_px, GRID))
    pixels = np.column_stack([x.ravel(), y.ravel()])
    straight = lens.straight().pixels(lens.rays(pixels))
    return float(np.linalg.norm(straight - pixels, axis=1).max())


@dataclass(frozen=True, slots=True, eq=False)
class PanelsInPhotos:
    """What `HiddenPanels` looks at; `corners_enu_m` has shape (n, 4, 3)."""

    photos: Sequence[PosedPhoto]
    corners_enu_m: Array
    surroundings: RayCaster


@dataclass(frozen=True, slots=True)
class HiddenPanels:
    """Take panels, or parts of them, out of the index images where something stands in front of them."""

    name: str = "hidden panels"
    unit: str = "share of what is seen"
    tolerance: float = 0.001

    def assess(self, scene: PanelsInPhotos) -> Assessment:
        """Share of points on panels, in some of the photos, that are hidden by the model."""
        step = max(1, len(scene.photos) // SAMPLED_PHOTOS)
        hidden, seen, photos = 0, 0, 0
        for photo in scene.photos[::step]:
            points = _points(scene.corners_enu_m[facing(photo, scene.corners_enu_m)])
            points = points[photo.sees(points)]
            towards = points - photo.pose.position_enu_m
            distance = np.linalg.norm(towards, axis=1)
            hits = scene.surroundings.cast(
                np.broadcast_to(photo.pose.position_enu_m, points.shape), towards / np.maximum(distance, 1e-9)[:, None]
            )
            behind = int((hits.distance_m < distance - IN_FRONT_M).sum())
            hidden, seen, photos = hidden + behind, seen + len(points), photos + (behind > 0)
        size = hidden / seen if seen else 0.0
        pixels = sum(photo.intrinsics.width_px * photo.intrinsics.height_px for photo in scene.photos)
        reason = (
            f"something stands in front of panels in {photos} of {len(scene.photos[::step])} photos looked at"
            if hidden
            else "nothing stands between the photos and the panels"
        )
        return Assessment(size, reason, RAY_S * pixels)


def _points(corners: Array) -> Array:
    """Nine points on each panel, corners left out, shape (9 n, 3)."""
    places = np.stack(np.meshgrid([0.1, 0.5, 0.9], [0.1, 0.5, 0.9]), axis=-1).reshape(-1, 2)
    u, v = places[:, 0, None], places[:, 1, None]
    weights = np.concatenate([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=1)
    return np.asarray(np.einsum("pk,nkc->npc", weights, corners).reshape(-1, 3), float)
