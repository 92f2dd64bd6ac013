"""How well a model of reflections tells the colours of glass in views that it has not seen."""

from __future__ import annotations

import math
import statistics
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from planning.base.errors import InputError
from planning.base.progress import QUIET, Monitor
from reconstruction.light.glass_rays import rays_of_photo
from reconstruction.light.photo_set import PhotoSet
from reconstruction.light.training import TrainedReflections, mean_square_error
from reconstruction.metrics.image_metrics import psnr_db

LEAST_RAYS = 200
"""Of a view that is scored: of fewer the score says more about where they lie than about the model."""

SAME_PANELS_M = 1e-3
"""Corners of two folders that are further apart are not those of the same panels."""


@dataclass(frozen=True, slots=True)
class ViewScore:
    """PSNR, dB, over the glass pixels of a view."""

    name: str
    n_rays: int
    psnr_db: float


@dataclass(frozen=True, slots=True)
class ReflectionScore:
    """Scores of views.

    Parameters
    ----------
    views
        Those with `LEAST_RAYS` or more.
    n_left_out
        Views with fewer.
    """

    views: tuple[ViewScore, ...]
    n_left_out: int

    @property
    def mean_db(self) -> float:
        """Mean over the views."""
        return statistics.fmean(view.psnr_db for view in self.views)

    @property
    def worst_db(self) -> float:
        """Of the worst view."""
        return min(view.psnr_db for view in self.views)

    @property
    def all_rays_db(self) -> float:
        """PSNR of all rays of the views together."""
        squares = sum(view.n_rays * 10.0 ** (-view.psnr_db / 10.0) for view in self.views)
        return -10.0 * math.log10(squares / sum(view.n_rays for view in self.views))


def score_views(
    trained: TrainedReflections, source: PhotoSet, names: Collection[str], monitor: Monitor = QUIET
) -> ReflectionScore:
    """Score views of a folder that shows the same panels, one view after the other.

    Where both folders say how they were exposed, the difference is made up for.

    Raises
    ------
    InputError
        The folder shows other panels, lacks a view, or no view has enough glass.
    OperationCancelled
        From `monitor`.
    """
    mine, theirs = trained.planes.corners_enu_m, source.panels.corners_enu_m
    if mine.shape != theirs.shape or not np.allclose(mine, theirs, rtol=0.0, atol=SAME_PANELS_M):
        raise InputError(f"{source.folder}: shows other panels than were learned from; name photos of the same site")
    photos = source.named(names)
    if len(photos) < len(set(names)):
        missing = sorted(set(names) - {photo.name for photo in photos})
        raise InputError(
            f"{source.folder}: has no photo '{missing[0]}', which is to be scored; name photos of its views"
        )
    views = []
    for done, photo in enumerate(photos):
        monitor.report("scoring views", done, len(photos))
        rays = rays_of_photo(source, photo)
        if len(rays) >= LEAST_RAYS:
            error = mean_square_error(trained.panels, rays, source.exposure / trained.exposure)
            views.append(ViewScore(photo.name, len(rays), psnr_db(error)))
    if not views:
        raise InputError(
            f"{source.folder}: none of the {len(photos)} views to be scored has {LEAST_RAYS} pixels that lie whole on "
            "a panel; take larger or more photos"
        )
    return ReflectionScore(tuple(views), len(photos) - len(views))
