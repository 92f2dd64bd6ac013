"""Learning what glass mirrors from random batches of its rays (paper 3.3.3, 3.3.4), without a rasteriser."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache

import torch
from torch import Tensor

from planning.errors import ReconstructionError
from planning.progress import QUIET, Clock, Monitor, QualityPoint
from reconstruction.reflections.config import Precision, ReflectionConfig
from reconstruction.reflections.environment_map import EnvironmentMap
from reconstruction.reflections.glass_rays import GlassRays
from reconstruction.reflections.harmonics import MAX_DEGREE, HarmonicTexture
from reconstruction.reflections.losses import ray_errors, ray_loss
from reconstruction.reflections.photo_set import PanelPlanes
from reconstruction.reflections.reflection_mlp import MlpHealth, MlpShape, ReflectionMlp
from reconstruction.reflections.reflective_panels import (
    DIFFUSE_SHARE,
    REFLECTIVITY,
    LightModel,
    ModelName,
    ReflectivePanels,
    expected_reflection,
)
from reconstruction.reflections.shading import linear_from_display

HISTORY_POINTS = 12
"""Times at which the quality is measured on the way."""

CHECKED = 16384
"""Rays of those given that it is measured on."""

MEANT = 1 << 20
"""Rays that the mean colours to start from are taken of."""

WORTH_IT = 1.3
"""How much faster bfloat16 must be: it costs under 0.1 dB, and where a processor lacks it, it is slower."""

BETAS = (0.9, 0.99)
"""Of Adam; the second is shorter than usual, as batches are large and trainings short."""


@dataclass(frozen=True, slots=True, eq=False)
class TrainedReflections:
    """Panels that learned what they mirror, and how.

    Parameters
    ----------
    panels
        In evaluation mode.
    planes
        Of the panels, with the box that places are rescaled by.
    exposure
        Of the photos learned from, as `PhotoSet` has it.
    precision
        What was used.
    n_rays, n_steps, seconds
        Learned from, taken, and needed.
    history
        PSNR, dB, on rays that were not learned from, by seconds of training; empty where none were given.
    health
        Of an MLP, on rays learned from; None for other models.
    """

    panels: ReflectivePanels
    model: ModelName
    config: ReflectionConfig
    planes: PanelPlanes
    exposure: float
    precision: Precision
    n_rays: int
    n_steps: int
    seconds: float
    history: tuple[QualityPoint, ...]
    health: MlpHealth | None


def train_reflections(
    rays: GlassRays,
    planes: PanelPlanes,
    model: ModelName,
    config: ReflectionConfig,
    exposure: float = 1.0,
    unseen: GlassRays | None = None,
    monitor: Monitor = QUIET,
    clock: Clock = time.perf_counter,
) -> TrainedReflections:
    """Train a model on rays.

    Parameters
    ----------
    unseen
        Rays of views that are not learned from, for the history; nothing is chosen by them.

    Raises
    ------
    ReconstructionError
        The loss is not a number any more; the message says from which step on.
    OperationCancelled
        From `monitor`.
    """
    if not len(rays):
        raise ValueError("rays: expected at least one")
    precision = config.precision
    if precision == "auto":
        precision = faster_precision(config.mlp, config.batch, config.threads) if model == "mlp" else "float32"
    checked = _sample(unseen, CHECKED, config.seed) if unseen is not None and len(unseen) else None
    with _threads(config.threads):
        generator = torch.Generator().manual_seed(config.seed)
        panels = new_panels(rays, planes, model, config, generator)
        started_s = clock()
        history, n_steps = _train(panels, rays, config, precision, generator, checked, monitor, clock)
        seconds = clock() - started_s
        panels.eval()
        health = None
        if isinstance(panels.light, ReflectionMlp):
            some = _sample(rays, CHECKED, config.seed)
            health = panels.light.health(some.points, some.omega_r)
    return TrainedReflections(
        panels, model, config, planes, exposure, precision, len(rays), n_steps, seconds, tuple(history), health
    )


def new_panels(
    rays: GlassRays, planes: PanelPlanes, model: ModelName, config: ReflectionConfig, generator: torch.Generator
) -> ReflectivePanels:
    """An untrained model that starts from the mean colours of its rays."""
    some = _sample(rays, MEANT, config.seed)
    linear, numbers = linear_from_display(some.display) / some.gains[:, None], some.panels.long()
    n_panels = len(planes.corners_enu_m)
    mean = linear.mean(dim=0)
    counts = torch.zeros(n_panels).index_add(0, numbers, torch.ones(len(some)))[:, None]
    sums = torch.zeros(n_panels, 3).index_add(0, numbers, linear)
    # Panels that no ray shows are like all others on average.
    means = torch.where(counts > 0.0, sums / counts.clamp(min=1.0), mean)
    return untrained_panels(planes, model, config, means, generator)


def untrained_panels(
    planes: PanelPlanes, model: ModelName, config: ReflectionConfig, means: Tensor, generator: torch.Generator
) -> ReflectivePanels:
    """A model that starts from mean linear colours of the panels, shape (m, 3)."""
    light: LightModel | None = None
    diffuse, degree = means, MAX_DEGREE
    if model != "harmonics":
        diffuse, degree = DIFFUSE_SHARE * means / (1.0 - REFLECTIVITY), config.diffuse_degree
        expected = expected_reflection(float(means.mean()))
        if model == "mlp":
            light = ReflectionMlp(config.mlp, expected, generator)
        elif model == "environment-map":
            light = EnvironmentMap(config.environment_rows, expected)
        else:
            raise ValueError(f"model: expected mlp, environment-map or harmonics, got {model!r}")
    corners = torch.from_numpy(planes.rescaled(planes.corners_enu_m))
    return ReflectivePanels(HarmonicTexture(corners, config.places, diffuse.clamp(0.01, 0.99), degree), light)


def _train(
    panels: ReflectivePanels,
    rays: GlassRays,
    config: ReflectionConfig,
    precision: Precision,
    generator: torch.Generator,
    checked: GlassRays | None,
    monitor: Monitor,
    clock: Clock,
) -> tuple[list[QualityPoint], int]:
    """History and steps taken; time spent on the history does not count."""
    groups, rates = _rated(panels, config)
    optimiser = torch.optim.Adam(groups, lr=rates[0], betas=BETAS)
    history: list[QualityPoint] = []
    n_steps = config.steps_for(len(rays))
    every, spent_s, step = max(1, n_steps // HISTORY_POINTS), 0.0, 0
    limit_s = math.inf if config.time_limit_s is None else config.time_limit_s
    while step < n_steps and spent_s < limit_s:
        monitor.report("learning reflections", step, n_steps)
        begun_s = clock()
        progress = max(step / n_steps, spent_s / limit_s)
        for group, rate in zip(optimiser.param_groups, rates, strict=True):
            group["lr"] = rate * config.rate(step, progress)
        batch = rays[torch.randint(len(rays), (config.batch,), generator=generator)]
        with torch.autocast("cpu", torch.bfloat16, enabled=precision == "bfloat16"):
            colours = panels(batch)
        loss = ray_loss(ray_errors(colours, batch.display), config.stage(progress))
        if not bool(torch.isfinite(loss)):
            raise ReconstructionError(
                f"learning reflections failed: the loss is not a number at step {step + 1} of {n_steps}; "
                "lower the learning rates"
            )
        optimiser.zero_grad(set_to_none=True)
        loss.backward()  # type: ignore[no-untyped-call]
        optimiser.step()
        step += 1
        spent_s += clock() - begun_s
        is_last = step == n_steps or spent_s >= limit_s
        if checked is not None and (step % every == 0 or is_last):
            history.append(QualityPoint(spent_s, psnr_db(mean_square_error(panels, checked))))
    return history, step


def _rated(panels: ReflectivePanels, config: ReflectionConfig) -> tuple[list[dict[str, list[Tensor]]], list[float]]:
    """Groups of parameters for the optimiser, and the learning rate of each."""
    tables: list[Tensor] = [*panels.diffuse.parameters()]
    own: list[Tensor] = []
    network: list[Tensor] = []
    for name, value in panels.named_parameters():
        if name.startswith("light."):
            (network if isinstance(panels.light, ReflectionMlp) else tables).append(value)
        elif not name.startswith("diffuse."):
            own.append(value)
    rated = [(tables, config.table_rate), (own, config.panel_rate), (network, config.mlp_rate)]
    return [{"params": values} for values, _ in rated if values], [rate for values, rate in rated if values]


@torch.no_grad()
def mean_square_error(panels: ReflectivePanels, rays: GlassRays, gain: float = 1.0) -> float:
    """Of colours 0 to 1 as photos show them, over all rays; NaN where there are none.

    Parameters
    ----------
    gain
        Exposure of the rays' photos against that of those learned from.
    """
    total = 0.0
    for start in range(0, len(rays), CHECKED):
        part = rays[start : start + CHECKED]
        total += float((panels(part, gain).clamp(0.0, 1.0) - part.display).square().sum(dtype=torch.float64))
    return total / (3 * len(rays)) if len(rays) else math.nan


def psnr_db(mean_square: float) -> float:
    """Peak signal-to-noise ratio of colours 0 to 1; at most 100 dB, where there is no error at all."""
    return -10.0 * math.log10(max(mean_square, 1e-10))


def _sample(rays: GlassRays, n: int, seed: int) -> GlassRays:
    if len(rays) <= n:
        return rays
    return rays[torch.randperm(len(rays), generator=torch.Generator().manual_seed(seed))[:n]]


@contextmanager
def _threads(n_threads: int) -> Iterator[None]:
    """Give torch so many threads for a block. On shared cores, threads that wait for others take most of the time."""
    before = torch.get_num_threads()
    torch.set_num_threads(n_threads)
    try:
        yield
    finally:
        torch.set_num_threads(before)


@cache
def faster_precision(shape: MlpShape, batch: int, n_threads: int) -> Precision:
    """What trains an MLP faster here, by the best of five steps each; found out once in a process."""
    with _threads(n_threads):
        generator = torch.Generator().manual_seed(0)
        mlp = ReflectionMlp(shape, 0.5, generator)
        points, directions = torch.rand(2, batch, 3, generator=generator)
        # In turns, so that both meet the same machine.
        times = [[_step_seconds(mlp, points, directions, is_short) for is_short in (False, True)] for _ in range(5)]
    plain, short = map(min, zip(*times, strict=True))
    return "bfloat16" if plain > WORTH_IT * short else "float32"


def _step_seconds(mlp: ReflectionMlp, points: Tensor, directions: Tensor, is_short: bool) -> float:
    """Time of this thread's processor, which what else runs does not lengthen by much."""
    started_s = time.thread_time()
    with torch.autocast("cpu", torch.bfloat16, enabled=is_short):
        light = mlp(points, directions)
    light.sum().backward()
    return time.thread_time() - started_s
