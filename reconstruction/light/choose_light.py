"""Which model of mirrored light a scene calls for: the cheap ones are tried on some of its rays for seconds.

Parallax is what tells near from far: where a light that knows places tells unseen photos better than one that knows
directions alone, the radiance grid is worth its time; elsewhere the environment map is, and where that is no better
than light that changes slowly, harmonics are enough. The Reflection MLP is never chosen: it can be asked for.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import torch

from planning.base.effects import Assessment, Decision, Effect, decide
from planning.base.messages import say
from planning.base.progress import QUIET, Clock, Monitor
from reconstruction.light.config import ReflectionConfig
from reconstruction.light.glass_rays import GlassRays
from reconstruction.light.photo_set import PanelPlanes
from reconstruction.light.reflective_panels import ModelName
from reconstruction.light.training import TrainedReflections, mean_square_error, train_reflections
from reconstruction.metrics.image_metrics import psnr_db

TRIED: tuple[ModelName, ...] = ("harmonics", "environment-map", "radiance-grid")

SHARE = 0.03
"""Of a training's time limit, for each trial at most."""

TRIED_CELLS = 1 << 15
TRIED_STEPS, TRIED_BATCH = 240, 1024
"""Two to three seconds each: by then models are as far apart as they will be, or further."""

MOST_RAYS = 1 << 17
"""Of all photos together: more than a trial looks at."""

SCORED, UNSEEN = 8192, 0.2
"""Rays that trials are scored on, and the share of the photos that these are of."""

NEAR_TOLERANCE_DB, FAR_TOLERANCE_DB = 0.3, 0.3

GRID_TIMES = 2.0
"""Time that a grid takes to learn, against an environment map."""


@dataclass(frozen=True, slots=True)
class Trials:
    """PSNR, dB, on rays of unseen photos, of models that were tried; and the seconds that a whole training takes.

    Parameters
    ----------
    scores_db
        In the order of `TRIED`.
    seconds
        Of an environment map.
    """

    scores_db: tuple[float, float, float]
    seconds: float


@dataclass(frozen=True, slots=True)
class NearLight:
    """Whether what glass mirrors is near enough to show parallax."""

    name: str = say("near-field light")
    unit: str = "dB"
    tolerance: float = NEAR_TOLERANCE_DB

    def assess(self, scene: Trials) -> Assessment:
        """By how much a radiance grid is better than the best model without places."""
        slow, far, near = scene.scores_db
        gained = near - max(slow, far)
        what = say("show parallax") if gained > self.tolerance else say("show no parallax to speak of")
        reason = say(
            "mirror images in unseen photos {}: radiance grid {:.1f} dB, environment map {:.1f} dB", what, near, far
        )
        return Assessment(gained, reason, GRID_TIMES * scene.seconds)


@dataclass(frozen=True, slots=True)
class FarLight:
    """Whether what glass mirrors has detail by direction."""

    name: str = say("mirrored surroundings")
    unit: str = "dB"
    tolerance: float = FAR_TOLERANCE_DB

    def assess(self, scene: Trials) -> Assessment:
        """By how much the better model of mirrored light is better than harmonics, which mirror nothing."""
        slow, far, near = scene.scores_db
        gained = max(far, near) - slow
        what = say("clear mirror images") if gained > self.tolerance else say("no clear mirror images")
        return Assessment(gained, say("the panes show {}: harmonics alone {:.1f} dB", what, slow), scene.seconds)


def choose_light(
    rays: GlassRays,
    planes: PanelPlanes,
    config: ReflectionConfig,
    monitor: Monitor = QUIET,
    clock: Clock = time.process_time,
    device: str = "cpu",
) -> tuple[ModelName, tuple[Decision, ...]]:
    """Try the models on some rays, and decide which one is trained.

    Parameters
    ----------
    rays
        Of all photos that are learned from. Of fewer than two photos nothing can be held out, and an environment map is
        chosen without a decision.
    clock
        Processor time, so that what else the machine does changes no decision.
    device
        Of torch, where they learn.

    Raises
    ------
    ReconstructionError
        A trial failed.
    OperationCancelled
        From `monitor`.
    """
    seen, unseen = _split(rays, config.seed)
    if not len(seen) or not len(unseen):
        return "environment-map", ()
    found = []
    for done, model in enumerate(TRIED):
        monitor.report(say("choosing a model of mirrored light"), done, len(TRIED))
        # In a program's first run kernels are compiled here, which takes longer than a trial and tells nothing of it.
        _tried(model, seen, planes, replace(config, steps=1, time_limit_s=None), monitor, clock, device)
        found.append(_tried(model, seen, planes, config, monitor, clock, device))
    slow, far, near = (psnr_db(mean_square_error(trained.panels, unseen)) for trained in found)
    whole = config.steps_for(len(rays)) * config.batch / (found[1].n_steps * found[1].config.batch)
    return chosen(Trials((slow, far, near), found[1].seconds * whole))


def chosen(trials: Trials) -> tuple[ModelName, tuple[Decision, ...]]:
    """The model, and the decisions that lead to it."""
    effects: tuple[Effect[Trials], ...] = (FarLight(), NearLight())
    mirrors, near = (decide(effect, trials) for effect in effects)
    if near.on:
        return "radiance-grid", (mirrors, near)
    return ("environment-map" if mirrors.on else "harmonics"), (mirrors, near)


def _split(rays: GlassRays, seed: int) -> tuple[GlassRays, GlassRays]:
    """An even share of the rays to learn from, and some of other photos to be scored on."""
    generator = torch.Generator().manual_seed(seed)
    photos = torch.unique(rays.photos)
    n_unseen = max(1, round(UNSEEN * len(photos))) if len(photos) > 1 else 0
    held = photos[torch.randperm(len(photos), generator=generator)[:n_unseen]]
    order = torch.randperm(len(rays), generator=generator)
    is_unseen = torch.isin(rays.photos[order], held)
    return rays[order[~is_unseen][:MOST_RAYS]], rays[order[is_unseen][:SCORED]]


def _tried(
    model: ModelName,
    seen: GlassRays,
    planes: PanelPlanes,
    config: ReflectionConfig,
    monitor: Monitor,
    clock: Clock,
    device: str,
) -> TrainedReflections:
    limit_s = None if config.time_limit_s is None else SHARE * config.time_limit_s
    grid = replace(config.grid, most_cells=min(TRIED_CELLS, config.grid.most_cells), levels=2)
    # The same c for all, so that they differ in the light they mirror alone; of a few steps the coarse one is best.
    grid = replace(grid, places=config.places, diffuse_degree=config.diffuse_degree, batch_share=1.0)
    steps = min(TRIED_STEPS, config.steps)
    trial = replace(
        config,
        grid=grid,
        steps=steps,
        batch=min(TRIED_BATCH, config.batch),
        table_rate=max(config.table_rate, config.grid.rate),
        warm_up=min(config.warm_up, config.grid.warm_up),
        environment_rows=min(config.environment_rows, 64),
        time_limit_s=limit_s,
        high_frequency=(),
    )
    return train_reflections(seen, planes, model, trial, monitor=monitor, clock=clock, device=device)
