"""Learning what glass mirrors from random batches of its rays (paper 3.3.3, 3.3.4), without a rasteriser."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache, partial

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from planning.base.effects import Decision
from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.progress import QUIET, Clock, Monitor, QualityPoint
from reconstruction.light.config import GlassLearned, Precision, ReflectionConfig
from reconstruction.light.environment_map import EnvironmentMap
from reconstruction.light.glass_light import GlassLight, LightModel
from reconstruction.light.glass_rays import GlassRays, rays_of_photo
from reconstruction.light.harmonics import MAX_DEGREE, HarmonicTexture
from reconstruction.light.light_training import CheckpointSettings, LightTraining, on_device
from reconstruction.light.photo_set import PanelPlanes, PhotoSet
from reconstruction.light.radiance_grid import GridBox, RadianceGrid, box_of
from reconstruction.light.reflection_mlp import MlpHealth, MlpShape, ReflectionMlp
from reconstruction.light.reflective_panels import DIFFUSE_SHARE, ModelName, ReflectivePanels, expected_reflection
from reconstruction.light.shading import REFLECTIVITY, linear_from_display
from reconstruction.metrics.image_metrics import psnr_db

HISTORY_POINTS = 12
"""Times at which the quality is measured on the way."""

CHECKED = 16384
"""Rays of those given that it is measured on."""

N_MEAN_RAYS = 1 << 18
"""Rays that the mean colours to start from are taken of."""

WORTH_IT = 1.3
"""How much faster bfloat16 must be: it costs under 0.1 dB, and where a processor lacks it, it is slower."""


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
        Learned from, taken, and needed, looking at the quality left out.
    history
        PSNR, dB, on rays that were not learned from, by seconds of training; empty where none were given.
    health
        Of an MLP, on rays learned from; None for other models.
    notes
        What had to be survived on the way.
    transients
        Blocks of photos whose rays were left out, as `Blocks` numbers them; shape (0,) where none were.
    decisions
        About effects, on the way.
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
    notes: tuple[str, ...] = ()
    transients: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, np.bool_))
    decisions: tuple[Decision, ...] = ()

    @property
    def box(self) -> GridBox | None:
        """Of a radiance grid."""
        light = None if self.panels.light is None else self.panels.light.light
        return light.box if isinstance(light, RadianceGrid) else None


def train_reflections(
    rays: GlassRays,
    planes: PanelPlanes,
    model: ModelName,
    config: ReflectionConfig,
    exposure: float = 1.0,
    unseen: GlassRays | None = None,
    monitor: Monitor = QUIET,
    clock: Clock = time.perf_counter,
    keeping: CheckpointSettings | None = None,
    device: str = "cpu",
    look: Callable[[TrainedReflections], object] | None = None,
) -> TrainedReflections:
    """Train a model on rays.

    Parameters
    ----------
    unseen
        Rays of views that are not learned from, for the history; nothing is chosen by them.
    keeping
        How its state is kept, and which one it goes on from: one of the same rays, model and settings.
    device
        Of torch, where it learns; the panels come back on the processor.
    look
        Called now and then with a copy of what is learned so far.

    Raises
    ------
    ReconstructionError
        It came to nothing: the loss is not a number, or there is no memory; the message says from which step on.
    OperationCancelled
        From `monitor`.
    ValueError
        There are no rays, or the state to go on from is that of another training.
    """
    if not len(rays):
        raise ValueError("rays: expected at least one")
    precision = config.precision
    if precision == "auto" and (keeping is None or keeping.before is None):
        precision = faster_precision(config.mlp, config.batch, config.threads) if model == "mlp" else "float32"
    checked = _sample(unseen, CHECKED, config.seed) if unseen is not None and len(unseen) else None
    settings = config.for_grid if model == "radiance-grid" else config
    with torch_threads(config.threads):
        generator = torch.Generator().manual_seed(config.seed)
        initial = new_panels(rays, planes, model, config, generator)
        training = LightTraining(initial, rays, settings, precision, generator, keeping, device, clock)
        quality = None if checked is None else partial(_quality, on_device(checked, training.device))

        def so_far(panels: ReflectivePanels, health: MlpHealth | None = None) -> TrainedReflections:
            at = training.at
            return TrainedReflections(
                panels,
                model,
                config,
                planes,
                exposure,
                training.precision,
                len(rays),
                at.step,
                at.spent_s,
                tuple(QualityPoint(t_s, value) for t_s, value in at.history),
                health,
                tuple(at.notes),
                training.transients,
                training.decisions(),
            )

        show = None if look is None else lambda panels: look(so_far(panels))
        training.run(quality, max(1, training.n_steps // HISTORY_POINTS), monitor, show)
        health = None
        if training.panels.light is not None and isinstance(training.panels.light.light, ReflectionMlp):
            some = _sample(rays, CHECKED, config.seed).middle()
            health = training.panels.light.light.health(some.points, some.omega_r)
        return so_far(training.panels, health)


def _quality(rays: GlassRays, panels: ReflectivePanels) -> float:
    return psnr_db(mean_square_error(panels, rays))


def new_panels(
    rays: GlassRays, planes: PanelPlanes, model: ModelName, config: ReflectionConfig, generator: torch.Generator
) -> ReflectivePanels:
    """An untrained model that starts from the mean colours of its rays."""
    some = _sample(rays, N_MEAN_RAYS, config.seed)
    linear, numbers = linear_from_display(some.display) / some.gains[:, None], some.panels.long()
    n_panels = len(planes.corners_enu_m)
    mean = linear.mean(dim=0)
    counts = torch.zeros(n_panels).index_add(0, numbers, torch.ones(len(some)))[:, None]
    sums = torch.zeros(n_panels, 3).index_add(0, numbers, linear)
    # Panels that no ray shows are like all others on average.
    means = torch.where(counts > 0.0, sums / counts.clamp(min=1.0), mean)
    box = box_of(_sample(rays, CHECKED, config.seed), config.grid, len(rays)) if model == "radiance-grid" else None
    return untrained_panels(planes, model, config, means, generator, box, len(rays.table.gains), config.grid.levels)


def untrained_panels(
    planes: PanelPlanes,
    model: ModelName,
    config: ReflectionConfig,
    means: Tensor,
    generator: torch.Generator,
    box: GridBox | None = None,
    n_photos: int = 0,
    level: int = 0,
) -> ReflectivePanels:
    """A model that starts from mean linear colours of the panels, shape (m, 3).

    Parameters
    ----------
    box, level
        Of a radiance grid, and how often it is still to be made finer.
    n_photos
        That it will learn from.
    """
    corners = torch.from_numpy(planes.rescaled(planes.corners_enu_m))
    if model == "harmonics":
        return ReflectivePanels(HarmonicTexture(corners, config.places, means.clamp(0.01, 0.99), MAX_DEGREE), None)
    expected = expected_reflection(float(means.mean()))
    places, degree, learned = config.places, config.diffuse_degree, GlassLearned()
    light: LightModel
    if model == "mlp":
        light = ReflectionMlp(config.mlp, expected, generator)
    elif model == "environment-map":
        light = EnvironmentMap(config.environment_rows, expected)
    elif model == "radiance-grid":
        if box is None:
            raise ValueError("box: expected that of the radiance grid")
        light = RadianceGrid(box, expected, level, config.grid.far_side)
        places, degree = config.grid.places, config.grid.diffuse_degree
        learned = GlassLearned(tilts=True, bows=config.bows != "off")
    else:
        raise ValueError(f"model: expected mlp, environment-map, harmonics or radiance-grid, got {model!r}")
    diffuse = (DIFFUSE_SHARE * means / (1.0 - REFLECTIVITY)).clamp(0.01, 0.99)
    glass = GlassLight(light, planes, config.learned or learned, n_photos)
    return ReflectivePanels(HarmonicTexture(corners, places, diffuse, degree), glass)


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


def _sample(rays: GlassRays, n: int, seed: int) -> GlassRays:
    return rays.sample(n, torch.Generator().manual_seed(seed))


@contextmanager
def torch_threads(number: int) -> Iterator[None]:
    """Give torch so many threads for a block. On shared cores, threads that wait for others take most of the time."""
    before = torch.get_num_threads()
    torch.set_num_threads(number)
    try:
        yield
    finally:
        torch.set_num_threads(before)


@cache
def faster_precision(shape: MlpShape, batch: int, n_threads: int) -> Precision:
    """What trains an MLP faster here, by the best of five steps each; found out once in a process."""
    with torch_threads(n_threads):
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


# How well a model of reflections tells the colours of glass in views that it has not seen.

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
        raise InputError(
            say("shows other panels than were learned from; name photos of the same site", place=source.folder)
        )
    photos = source.named(names)
    if len(photos) < len(set(names)):
        missing = sorted(set(names) - {photo.name for photo in photos})
        raise InputError(
            say("has no photo '{}', which is to be scored; name photos of its views", missing[0], place=source.folder)
        )
    views = []
    for done, photo in enumerate(photos):
        monitor.report(say("scoring views"), done, len(photos))
        rays = rays_of_photo(source, photo)
        if len(rays) >= LEAST_RAYS:
            error = mean_square_error(trained.panels, rays, source.exposure / trained.exposure)
            views.append(ViewScore(photo.name, len(rays), psnr_db(error)))
    if not views:
        raise InputError(
            say(
                "none of the {} views to be scored has {} pixels that lie whole on a panel; take larger or more photos",
                len(photos),
                LEAST_RAYS,
                place=source.folder,
            )
        )
    return ReflectionScore(tuple(views), len(photos) - len(views))
