"""How good a model's pictures of views are: PSNR, structural similarity, LPIPS and FLIP, of facades and of all."""

from __future__ import annotations

import statistics
from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.light.photo_set import PhotoSet
from reconstruction.light.shading import linear_from_display
from reconstruction.metrics.flip import flip_of_masks
from reconstruction.metrics.image_metrics import PictureScore, Quality, mean_quality, score_picture
from reconstruction.metrics.lpips import LpipsWeights, lpips_of_masks
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.training.model.joint_model import SceneModel
from reconstruction.training.model.record import site_record
from reconstruction.training.model.render import render_view
from reconstruction.training.model.saved import TrainedModel
from reconstruction.training.photos.exposures import HeldOutGain, fitted_gain
from reconstruction.training.photos.photo_stream import PhotoStream, Sample, StreamSettings

SAME_PANELS_M = 1e-3
"""Corners of two folders that are further apart are not those of the same panels."""


@dataclass(frozen=True, slots=True)
class ViewScores:
    """Of one view; LPIPS is None where no weights were given, and facade scores where the view shows none.

    Parameters
    ----------
    is_learned
        Whether the model learned from this photo.
    """

    name: str
    is_learned: bool
    facade: PictureScore
    whole: PictureScore
    facade_lpips: float | None = None
    whole_lpips: float | None = None
    facade_flip: float | None = None
    whole_flip: float | None = None


def score_views(
    trained: TrainedModel,
    source: PhotoSet,
    names: Collection[str],
    weights: LpipsWeights | None = None,
    gain: HeldOutGain = "none",
    threads: int = 0,
    monitor: Monitor = QUIET,
    *,
    psnr_alone: bool = False,
) -> tuple[ViewScores, ...]:
    """Score views of a folder that shows the same panels.

    Where both folders say how they were exposed, the difference is made up for.

    Parameters
    ----------
    weights
        Of LPIPS; without, that is left out.
    gain
        Of exposure: what is known of each photo, or fitted to it.
    psnr_alone
        Leave out all else, which takes most of the time.

    Raises
    ------
    InputError
        The folder shows other panels, or lacks a view.
    OperationCancelled
        From `monitor`.
    """
    mine, theirs = trained.record.site.planes.corners_enu_m, site_record(source.folder).planes.corners_enu_m
    if mine.shape != theirs.shape or not np.allclose(mine, theirs, rtol=0.0, atol=SAME_PANELS_M):
        raise InputError(say("shows other panels than the model; name photos of the same site", place=source.folder))
    missing = sorted(set(names) - {photo.name for photo in source.photos})
    if missing:
        raise InputError(
            say("has no photo '{}', which is to be scored; score --views all", missing[0], place=source.folder)
        )
    model, learned = trained.model, set(trained.record.learned)
    settings = replace(trained.record.config.raster, threads=threads)
    exposure = source.exposure / trained.record.exposure
    scores = []
    with PhotoStream(source, names, model.origin_enu_m, StreamSettings()) as photos:
        for done, photo in enumerate(photos.photos):
            monitor.report(say("scoring views"), done, len(photos.photos))
            sample = photos.frame(done)
            factor = exposure * source.own_exposures.get(photo.name, 1.0)
            if gain == "fitted":
                factor *= _fitted(model, sample, factor, settings)
            found = render_view(model, sample.view, (), factor, settings).display
            scores.append(_scored(photo.name, photo.name in learned, found, sample, weights, psnr_alone))
    return tuple(scores)


def quality_of(scores: Iterable[ViewScores]) -> Quality | None:
    """PSNR of views in one number."""
    return mean_quality((score.facade.psnr_db, score.whole.psnr_db) for score in scores)


@torch.no_grad()
def _fitted(model: SceneModel, sample: Sample, gain: float, settings: RasterSettings) -> float:
    """Factor on a gain that brings the rendered light of the facade, or of all where none is, closest to the photo's.

    A bright street beside it would outweigh it: squares of linear light are compared.
    """
    facade, shown = sample.scored_pixels()
    told = facade if facade.any() else shown
    display = torch.from_numpy(render_view(model, sample.view, (), gain, settings).display)
    truth = sample.display.float() / 255.0
    pixels = ... if told is None else torch.from_numpy(told)
    display, truth = display[pixels].reshape(-1, 3), truth[pixels].reshape(-1, 3)
    return float(fitted_gain(linear_from_display(display), linear_from_display(truth), truth))


def _scored(
    name: str,
    is_learned: bool,
    found: NDArray[np.float32],
    sample: Sample,
    weights: LpipsWeights | None,
    psnr_alone: bool,
) -> ViewScores:
    truth, (facade, shown) = sample.display.numpy(), sample.scored_pixels()
    if shown is not None:  # windows and features that reach beyond the edge find nothing wrong there
        found = np.where(shown[..., None], found, truth / np.float32(255.0))
    scores = (
        score_picture(found, truth, facade, with_ssim=not psnr_alone),
        score_picture(found, truth, shown, with_ssim=not psnr_alone),
    )
    if psnr_alone:
        return ViewScores(name, is_learned, *scores)
    flips = flip_of_masks(found, truth, (facade, shown))
    if weights is None:
        return ViewScores(name, is_learned, *scores, None, None, *flips)
    return ViewScores(name, is_learned, *scores, *lpips_of_masks(weights, found, truth, (facade, shown)), *flips)


def mean_of(values: Iterable[float | None]) -> float | None:
    """Mean of those that are known; None where none is."""
    known = [value for value in values if value is not None]
    return statistics.fmean(known) if known else None
