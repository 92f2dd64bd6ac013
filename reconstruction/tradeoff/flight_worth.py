"""What flights are worth: models of their photos, looked at from views that no photo was taken from.

Each model learns from all photos of one flight over a synthetic scene. It is scored on the facade of unseen views of
three kinds: random oblique ones, every third view of a plan by hemisphere sections with another seed, and those of an
inspector's walk (`planning.viewpoints.unseen`).
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Literal, get_args

import numpy as np

from planning.base.progress import QUIET, Clock, Monitor, TimeLimit, Trace
from planning.geo.frames import wrap_heading_deg
from planning.plan import Viewpoint, ViewpointArrays
from planning.viewpoints.greedy import greedy
from planning.viewpoints.prepare import Prepared
from planning.viewpoints.problem import Goal, take
from planning.viewpoints.unseen import random_views, walk_views
from reconstruction.light.photo_set import PhotoSet, read_photo_set
from reconstruction.scenes.parameters import RenderSettings
from reconstruction.scenes.photos.flight_views import BETWEEN, Shot, lens_of, posed_photos
from reconstruction.scenes.record import Scene
from reconstruction.scenes.runs.photo_folder import render_photo_folder
from reconstruction.scenes.runs.photo_job import PhotoJob

UnseenKind = Literal["random", "hemisphere", "walk"]
UNSEEN_KINDS: tuple[UnseenKind, ...] = get_args(UnseenKind)

Light = Literal["radiance-grid", "mlp", "splats"]
LIGHTS: tuple[Light, ...] = get_args(Light)
"""Mirrored light learned alone, by grid or by the paper's Reflection MLP; and all of it, joint splats."""

UNSEEN_SEED = 990
"""Apart from the seeds of flights."""

EVERY, CHOICE_S = 3, 8.0
"""Hemisphere views are every third of a greedy plan, whose search ends after so many seconds."""

HELD_OUT = 1e-3
"""Share of a flight's photos, at least one, that joint splats do not learn from."""


def unseen_views(kind: UnseenKind, prepared: Prepared, n: int) -> ViewpointArrays:
    """About `n` views of a kind, the same ones each time.

    Raises
    ------
    InfeasibleError
        There is no allowed viewpoint that sees anything.
    """
    rng = np.random.default_rng([UNSEEN_SEED, UNSEEN_KINDS.index(kind)])
    if kind == "random":
        return random_views(prepared.problem, n, rng)
    if kind == "walk":
        return walk_views(prepared.problem, prepared.site_model, n, rng)
    limit = TimeLimit(CHOICE_S)
    chosen = greedy(prepared.problem, Goal(EVERY * n), seed=UNSEEN_SEED, stop=limit, trace=Trace(), monitor=QUIET)
    return take(chosen.views, np.arange(0, len(chosen.views.heading_rad), EVERY))


def shots_of(views: ViewpointArrays) -> tuple[Shot, ...]:
    """Views as shots that follow each other."""
    columns = (views.positions_enu_m.tolist(), np.degrees(views.heading_rad), np.degrees(views.pitch_rad))
    return tuple(
        Shot(Viewpoint(f"u{number:04d}", (x, y, z), wrap_heading_deg(float(heading)), float(pitch)), number * BETWEEN)
        for number, ((x, y, z), heading, pitch) in enumerate(zip(*columns, strict=True))
    )


def photograph(
    scene: Scene,
    shots: Sequence[Shot],
    prepared: Prepared,
    width_px: int,
    folder: Path,
    monitor: Monitor = QUIET,
    *,
    companions: Mapping[str, bytes] = MappingProxyType({}),
) -> Path:
    """Photos of shots, with what effects the scene calls for; those that are in the folder already stay.

    Parameters
    ----------
    companions
        Content of other files that belong into the folder, by their names: splats begin at the site's surfaces.

    Raises
    ------
    InputError
        The folder holds something else, or the disk is full.
    OperationCancelled
        From `monitor`.
    """
    photos = posed_photos(shots, lens_of(prepared.problem.model.camera, width_px), folder / "images")
    render_photo_folder(PhotoJob(scene, photos, RenderSettings(), {}, dict(companions)), folder, 1, monitor)
    return folder


def model_quality(
    light: Light,
    photos: Path,
    unseen: Mapping[UnseenKind, Path],
    seed: int,
    seconds: float,
    monitor: Monitor = QUIET,
    clock: Clock = time.process_time,
) -> dict[UnseenKind, float]:
    """PSNR, dB, of the facades of unseen views, the mean by kind.

    Parameters
    ----------
    seconds
        Of the training of splats, by `clock`; light alone takes the steps that it takes by default.

    Raises
    ------
    InputError
        A folder cannot be used.
    ReconstructionError
        The training came to nothing.
    OperationCancelled
        From `monitor`.
    """
    sources = {kind: read_photo_set(folder) for kind, folder in unseen.items()}
    if light == "splats":
        return _of_splats(photos, sources, seed, seconds, monitor, clock)
    # These load torch, which planning and photographing do without.
    from reconstruction.light.config import ReflectionConfig
    from reconstruction.light.glass_rays import glass_rays
    from reconstruction.light.training import score_views, train_reflections

    source = read_photo_set(photos)
    rays = glass_rays(source, source.photos, monitor=monitor)
    config = replace(ReflectionConfig(), seed=seed)
    learned = train_reflections(rays, source.panels, light, config, source.exposure, None, monitor, clock)
    return {
        kind: score_views(learned, each, [photo.name for photo in each.photos], monitor).mean_db
        for kind, each in sources.items()
    }


def _of_splats(
    photos: Path, sources: Mapping[UnseenKind, PhotoSet], seed: int, seconds: float, monitor: Monitor, clock: Clock
) -> dict[UnseenKind, float]:
    from reconstruction.training.callbacks import Callbacks
    from reconstruction.training.model.score import mean_of, score_views
    from reconstruction.training.presets import preset
    from reconstruction.training.timer import Timer
    from reconstruction.training.train import train_model

    # As few photos as can be are held out: the unseen views are what is scored.
    config = replace(preset("10min"), seed=seed, time_limit_s=seconds, held_out=HELD_OUT)
    trained = train_model(photos, config, Callbacks(monitor), watch=Timer(clock))
    found: dict[UnseenKind, float] = {}
    for kind, each in sources.items():
        names = [photo.name for photo in each.photos]
        scores = score_views(trained, each, names, monitor=monitor, psnr_alone=True)
        found[kind] = mean_of(score.facade.psnr_db for score in scores) or 0.0
    return found
