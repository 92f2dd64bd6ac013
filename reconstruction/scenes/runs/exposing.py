"""How each photo of a flight is exposed, how its camera moves meanwhile, and what is told of its pose."""

from __future__ import annotations

import statistics
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from planning.base.progress import QUIET, Monitor
from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.effect_names import EXPOSURE, GIMBAL_ERROR, MOTION_BLUR, POSITION_ERROR
from reconstruction.scenes.photos.camera_model import SHUTTERS_S, Capture, in_stops
from reconstruction.scenes.photos.lens_effects import metered_exposure
from reconstruction.scenes.photos.pose_errors import told_poses
from reconstruction.scenes.photos.renderer import Renderer
from reconstruction.scenes.runs.photo_job import PhotoJob

Array = NDArray[np.float64]

N_METERED, METERED_PX = 8, 64
"""Photos that the exposure of all is measured on, and how wide photos are rendered for measuring."""


def common_exposure(job: PhotoJob) -> float:
    """One for all photos, as pilots lock it: middle grey on average over some of them, rendered small."""
    renderer = Renderer(job.scene, job.settings)
    chosen = job.photos[:: -(-len(job.photos) // N_METERED)]
    return statistics.harmonic_mean([_metered(renderer, photo) for photo in chosen])


def captures_of(job: PhotoJob, common: float, monitor: Monitor = QUIET) -> tuple[Capture, ...]:
    """Photos of a job as they are taken, its effects decided and its moments given.

    Parameters
    ----------
    common
        As `common_exposure` gives it.
    """
    is_on, seed = job.settings.is_on, job.scene.seed
    told = told_poses(
        job.photos, job.moments, job.taking, seed, positions=is_on(POSITION_ERROR), angles=is_on(GIMBAL_ERROR)
    )
    factors = _own_exposures(job, common, monitor)
    captures = []
    for moment, one, factor in zip(job.moments, told, factors.tolist(), strict=True):
        exposure_s = moment.exposure_s * factor
        way_m = np.array(moment.velocity_enu_m_s) * exposure_s * is_on(MOTION_BLUR)
        captures.append(Capture(one.pose, one.higher_m, way_m, factor, exposure_s))
    return tuple(captures)


def _own_exposures(job: PhotoJob, common: float, monitor: Monitor) -> Array:
    """Each photo's exposure against the common one, shape (n,): what the camera's shutters can do of it."""
    n = len(job.photos)
    if job.taking.exposure == "locked" or not job.settings.is_on(EXPOSURE):
        return np.ones(n)
    renderer, factors = Renderer(job.scene, job.settings), np.ones(n)
    for number, photo in enumerate(job.photos):
        monitor.report("metering", number, n)
        factors[number] = _metered(renderer, photo) / common
    shutters_s = np.array([moment.exposure_s for moment in job.moments])
    low, high = SHUTTERS_S
    # What is longer or shorter already, as the user says, is not brought back into the range.
    shortest, longest = np.minimum(shutters_s, low), np.maximum(shutters_s, high)
    is_open = shutters_s > 0.0
    base = np.where(is_open, shutters_s, 1.0)
    clipped = np.clip(base * in_stops(factors), shortest, longest) / base
    return np.asarray(np.where(is_open, clipped, in_stops(factors)))


def _metered(renderer: Renderer, photo: PosedPhoto) -> float:
    lens = photo.intrinsics
    small = lens.scaled(METERED_PX, max(1, round(METERED_PX * lens.height_px / lens.width_px)))
    return metered_exposure(renderer.render(replace(photo, intrinsics=small)))
