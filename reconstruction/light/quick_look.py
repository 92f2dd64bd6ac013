"""A quick look at what photos tell of mirrored surroundings, within a minute and before the next battery.

A radiance grid learns from each half of the photos, and is looked at along the rays of the other half: how far away is
what panes mirror, and how well is its colour known by who has not seen it.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.progress import QUIET, Clock, Monitor
from planning.coverage.mirrored_rays import Surroundings
from planning.coverage.sections import panel_frames
from planning.revision.seen_bodies import MirroredPlaces
from planning.site.records import SiteModel, panel_corners
from reconstruction.base.cameras import PosedPhoto
from reconstruction.light.config import GlassLearned, ReflectionConfig
from reconstruction.light.glass_rays import glass_rays, numbers_in
from reconstruction.light.photo_set import PanelPlanes, PhotoSet, rgb_picture
from reconstruction.light.radiance_grid import RadianceGrid
from reconstruction.light.training import mean_square_error, train_reflections
from reconstruction.metrics.image_metrics import psnr_db
from reconstruction.photos.decode import COLOUR_FLAGS, Scale

WIDEST_PX = 700
"""Photos are decoded at the largest part of their size that is no wider: a grid learns from 2 million rays in half a
minute, and 100 photos of 660 pixels have ten."""

LOOKED_AT = 60_000
"""Rays of each half that the other half's grid is looked at along."""

FAR_AWAY_M = 1000.0
"""Places of rays that end nowhere are so far away."""

LEAST_PHOTOS = 8
"""With glass, in both halves together."""


@dataclass(frozen=True, slots=True, eq=False)
class QuickLook:
    """What photos told.

    Parameters
    ----------
    psnr_db
        Of the glass in photos that a grid did not learn from, dB.
    seconds
        Of wall time.
    """

    places: MirroredPlaces
    n_photos: int
    psnr_db: float
    seconds: float


@dataclass(frozen=True, eq=False)
class CardPhotos(PhotoSet):
    """Photos as they come from the camera's card, decoded at a part of their size; panels are found by casting rays.

    `photos` have cameras of that size.
    """

    scales: dict[str, Scale]
    site_model: SiteModel

    @staticmethod
    def of(photos: Sequence[PosedPhoto], site_model: SiteModel, folder: Path) -> CardPhotos:
        """Of photos with poses, sorted by name."""
        ordered = sorted(photos, key=lambda photo: photo.name)
        scales = {photo.name: _scale(photo.intrinsics.width_px) for photo in ordered}
        small = tuple(
            replace(photo, intrinsics=photo.intrinsics.scaled(*_size(photo, scales[photo.name]))) for photo in ordered
        )
        return CardPhotos(folder, small, PanelPlanes(panel_corners(site_model.site)), 1.0, {}, scales, site_model)

    @cached_property
    def _surroundings(self) -> Surroundings:
        return Surroundings(self.site_model, panel_frames(self.panels.corners_enu_m))

    def picture(self, photo: PosedPhoto) -> NDArray[np.uint8]:
        """As of `PhotoSet`."""
        return rgb_picture(photo, COLOUR_FLAGS[self.scales[photo.name]])

    def panel_numbers(self, photo: PosedPhoto) -> NDArray[np.int64]:
        """As of `PhotoSet`; what the site's bodies hide is none."""
        lens = photo.intrinsics
        columns, rows = np.meshgrid(np.arange(lens.width_px) + 0.5, np.arange(lens.height_px) + 0.5)
        met, _ = self._surroundings.panes_met(*photo.rays(np.stack([columns.ravel(), rows.ravel()], axis=1)))
        return met.reshape(lens.height_px, lens.width_px)


def _scale(width_px: int) -> Scale:
    scales: tuple[Scale, ...] = (1, 2, 4)
    return next((scale for scale in scales if width_px <= scale * WIDEST_PX), 8)


def _size(photo: PosedPhoto, scale: Scale) -> tuple[int, int]:
    return -(-photo.intrinsics.width_px // scale), -(-photo.intrinsics.height_px // scale)


def quick_look(
    source: PhotoSet,
    seconds: float = 40.0,
    seed: int = 0,
    monitor: Monitor = QUIET,
    clock: Clock = time.perf_counter,
) -> QuickLook:
    """Learn from each half of the photos, and look along the rays of the other.

    Parameters
    ----------
    seconds
        By `clock`, for both trainings together; reading photos comes on top.

    Raises
    ------
    InputError
        A file is damaged, or too few photos show glass.
    ReconstructionError
        A training came to nothing.
    OperationCancelled
        From `monitor`.
    """
    begun_s = clock()
    rays = glass_rays(source, source.photos, seed=seed, monitor=monitor)
    with_glass = numbers_in(rays.photos)
    if len(with_glass) < LEAST_PHOTOS:
        raise InputError(
            say(
                "{} of {} photos show glass of the site's panels, and {} are needed; are they of this site?",
                len(with_glass),
                len(source.photos),
                LEAST_PHOTOS,
                place=source.folder,
            )
        )
    # Neighbours in time stand close together: halves of every other photo see much the same.
    rank = torch.zeros(len(source.photos), dtype=torch.long)
    rank[with_glass] = torch.arange(len(with_glass))
    halves = rank[rays.photos.long()] % 2
    config = ReflectionConfig(
        seed=seed, time_limit_s=0.5 * seconds, learned=GlassLearned(tilts=True, poses=True), transients="off"
    )
    parts, errors = [], []
    for half in (0, 1):
        trained = train_reflections(
            rays[halves == 1 - half],
            source.panels,
            "radiance-grid",
            config,
            source.exposure,
            monitor=monitor,
            clock=clock,
        )
        looked_at = rays[halves == half].sample(LOOKED_AT, torch.Generator().manual_seed(seed))
        light = trained.panels.light
        assert light is not None
        assert isinstance(light.light, RadianceGrid)
        errors.append(mean_square_error(trained.panels, looked_at))
        middle = looked_at.middle()
        away_m = light.light.distances(middle.points, middle.omega_r).double() * looked_at.table.half_side_m
        panes = looked_at.hits().points_m + looked_at.table.middle_m
        places = panes + away_m.clamp(max=FAR_AWAY_M)[:, None] * middle.omega_r.double()
        numbers = looked_at.photos.long()
        parts.append((panes, places, away_m, numbers, torch.full_like(numbers, half)))
    columns = [torch.cat(column).numpy() for column in zip(*parts, strict=True)]
    return QuickLook(
        MirroredPlaces(*columns),
        len(with_glass),
        psnr_db(sum(errors) / 2.0),
        clock() - begun_s,
    )
