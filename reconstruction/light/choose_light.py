"""Which model of mirrored light a scene calls for: the cheap ones are tried on some of its rays for seconds.

Parallax is what tells near from far: where a light that knows places tells unseen photos better than one that knows
directions alone, the radiance grid is worth its time; elsewhere the environment map is, and where that is no better
than light that changes slowly, harmonics are enough. The Reflection MLP is never chosen: it can be asked for.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.special import stdtrit

from planning.base.effects import Assessment, Decision, Effect, EffectSetting, decide
from planning.base.messages import say
from planning.base.progress import QUIET, Clock, Monitor, PartOf
from reconstruction.base.cameras import PosedPhoto
from reconstruction.light.config import ReflectionConfig
from reconstruction.light.glass_rays import GlassRays, numbers_in
from reconstruction.light.photo_set import PanelPlanes, PhotoSet
from reconstruction.light.reflective_panels import ModelName
from reconstruction.light.training import TrainedReflections, mean_square_error, train_reflections
from reconstruction.metrics.image_metrics import psnr_db

Floats = NDArray[np.float64]

TRIED: tuple[ModelName, ...] = ("harmonics", "environment-map", "radiance-grid")

SHARE = 0.03
"""Of a training's time limit, for each trial at most."""

TRIED_CELLS = 1 << 15
TRIED_STEPS, TRIED_BATCH = 240, 1024
"""Two to three seconds each: by then models are as far apart as they will be, or further."""

MOST_RAYS = 1 << 17
"""Of all photos together: more than a trial looks at."""

DRAWN = 4 * MOST_RAYS
"""Rays of all photos that those are taken from, and those that are scored."""

SCORED, UNSEEN = 8192, 0.2
"""Rays that a trial is scored on, and the share of the photos that these are of."""

FOLDS, FEW_PHOTOS = 3, 40
"""Of fewer photos than this, others are held back again and again until they agree: a fifth would tell too little."""

MOST_WRONG = 0.05
"""Probability, at most, that trials end early with another answer than that of all photos: all looks together."""

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
    unsure_db
        Standard errors, over unseen photos, of what the better light gains on harmonics, and of what the grid gains on
        the others: a gain counts as far as it is beyond that.
    """

    scores_db: tuple[float, float, float]
    seconds: float
    unsure_db: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class LightTrials:
    """Trials, the models of the last ones, and the numbers of the photos that these have not seen."""

    trials: Trials
    found: Mapping[ModelName, TrainedReflections]
    unseen: tuple[int, ...]


def surely_more(gains_db: Floats, tolerance_db: float, n_looks: int) -> bool | None:
    """Whether a mean gain is more than a tolerance; None as long as the photos do not tell.

    A group sequential test: at each look the gain is compared with Student's interval for its mean, two-sided, whose
    error is `MOST_WRONG` shared evenly by all looks (Bonferroni), so that looking again and again misleads nobody.

    Parameters
    ----------
    gains_db
        Of photos that were not learned from, one of each, shape (n,).
    n_looks
        That there are at most.
    """
    n = len(gains_db)
    if n < 2:
        return None
    reach = float(stdtrit(n - 1, 1.0 - 0.5 * MOST_WRONG / n_looks)) * standard_error(gains_db)
    mean = float(gains_db.mean())
    if mean - reach > tolerance_db:
        return True
    return False if mean + reach < tolerance_db else None


@dataclass(frozen=True, slots=True)
class NearLight:
    """Whether what glass mirrors is near enough to show parallax."""

    name: str = say("near-field light")
    unit: str = "dB"
    tolerance: float = NEAR_TOLERANCE_DB

    def assess(self, scene: Trials) -> Assessment:
        """By how much a radiance grid is better than the best model without places."""
        slow, far, near = scene.scores_db
        gained = near - max(slow, far) - scene.unsure_db[1]
        what = say("show parallax") if gained > self.tolerance else say("show no parallax to speak of")
        reason = say(
            "mirror images in unseen photos {}: radiance grid {:.1f} dB, environment map {:.1f} dB", what, near, far
        )
        return Assessment(gained, reason, GRID_TIMES * scene.seconds)


@dataclass(frozen=True, slots=True)
class NearLightBySplats:
    """Whether views are better with near-field light, where rays of glass alone do not tell."""

    name: str = say("near-field light")
    unit: str = "dB"
    tolerance: float = 0.0

    def assess(self, scene: tuple[float, float, float]) -> Assessment:
        """By PSNR, dB, of views held back with a radiance grid and with an environment map, and seconds of the map."""
        near, far, seconds = scene
        reason = say(
            "views held back have {:.1f} dB with a radiance grid, {:.1f} dB with an environment map", near, far
        )
        return Assessment(near - far, reason, GRID_TIMES * seconds)


@dataclass(frozen=True, slots=True)
class FarLight:
    """Whether what glass mirrors has detail by direction."""

    name: str = say("mirrored surroundings")
    unit: str = "dB"
    tolerance: float = FAR_TOLERANCE_DB

    def assess(self, scene: Trials) -> Assessment:
        """By how much the better model of mirrored light is better than harmonics, which mirror nothing."""
        slow, far, near = scene.scores_db
        gained = max(far, near) - slow - scene.unsure_db[0]
        what = say("clear mirror images") if gained > self.tolerance else say("no clear mirror images")
        return Assessment(gained, say("the panes show {}: harmonics alone {:.1f} dB", what, slow), scene.seconds)


WHITE = 250.0 / 255.0
"""Values from here on are clipped, or are means of some that are: what JPEG and smaller pictures make of white."""

LOOKED_AT = 16
"""Photos, evenly chosen, that tell how much of all is overexposed."""

EVERY_PX = 4
"""Pixels of them along each side, of which one is looked at."""


@dataclass(frozen=True, slots=True)
class Overexposure:
    """Whether photos are overexposed: values next to white then say "at least so bright"."""

    name: str = say("overexposed photos")
    unit: str = say("share of the pixels")
    tolerance: float = 0.01

    def assess(self, scene: Sequence[NDArray[np.uint8]]) -> Assessment:
        """Share of pixels of pictures with a value next to white."""
        share = float(np.mean([(picture >= 255.0 * WHITE).any(axis=-1).mean() for picture in scene]))
        return Assessment(share, say("{:.1f} % of the pixels are next to white", 100.0 * share), 0.0)


def white_of(source: PhotoSet, photos: Sequence[PosedPhoto], setting: EffectSetting = "auto") -> tuple[float, Decision]:
    """From which value on photos are taken as overexposed, and the decision that leads to it.

    Raises
    ------
    InputError
        A photo is missing or damaged.
    """
    chosen = photos[:: -(-len(photos) // LOOKED_AT)]
    pictures = [source.picture(photo)[::EVERY_PX, ::EVERY_PX] for photo in chosen]
    decision = decide(Overexposure(), pictures, setting)
    return WHITE if decision.on else 1.0, decision


def try_lights(
    rays: GlassRays,
    planes: PanelPlanes,
    config: ReflectionConfig,
    monitor: Monitor = QUIET,
    clock: Clock = time.process_time,
    device: str = "cpu",
) -> LightTrials | None:
    """Try the models on some rays, and score them on photos that they have not seen; None of fewer than two photos.

    Of few photos others are held back again and again, until those that were tell which model is to be chosen.

    Parameters
    ----------
    rays
        Of all photos that are learned from.
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
    folds = _folds(rays, config.seed)
    scores: list[list[float]] = []
    found: dict[ModelName, TrainedReflections] = {}
    last: tuple[int, ...] = ()
    for number, (seen, unseen) in enumerate(folds):
        for done, model in enumerate(TRIED):
            first, n_all = number * len(TRIED) + done, len(folds) * len(TRIED)
            trial = PartOf(monitor, say("choosing a model of mirrored light"), first / n_all, (first + 1) / n_all)
            if number == 0:
                # In a program's first run kernels are compiled here, which takes longer than a trial.
                one_step, still = replace(config, steps=1, time_limit_s=None), replace(trial, end=trial.start)
                _tried(model, seen, planes, one_step, still, clock, device)
            found[model] = _tried(model, seen, planes, config, trial, clock, device)
        scores += [[psnr_db(mean_square_error(found[model].panels, photo)) for model in TRIED] for photo in unseen]
        last = tuple(int(photo.photos[0]) for photo in unseen)
        if _are_clear(np.array(scores), len(folds)):
            break
    if not scores:
        return None
    far = found["environment-map"]
    whole = config.steps_for(len(rays)) * config.batch / (far.n_steps * far.config.batch)
    trials = trials_of(np.array(scores), far.seconds * whole)
    return LightTrials(trials, found, last)


def _are_clear(scores_db: Floats, n_looks: int) -> bool:
    """Whether more photos would not change which model is chosen."""
    on_harmonics, on_others = _gains(scores_db)
    mirrors, near = (
        surely_more(gains, tolerance, n_looks)
        for gains, tolerance in ((on_harmonics, FAR_TOLERANCE_DB), (on_others, NEAR_TOLERANCE_DB))
    )
    return near is not None and (near or mirrors is not None)


def _gains(scores_db: Floats) -> tuple[Floats, Floats]:
    """What the better light gains on harmonics in each photo, and the grid on the better of the others."""
    slow, far, near = scores_db.T
    best = near if near.mean() > far.mean() else far
    return best - slow, near - (far if far.mean() > slow.mean() else slow)


def trials_of(scores_db: Floats, seconds: float) -> Trials:
    """Means of photos' scores, shape (n, 3) in the order of `TRIED`, and how far their differences may be off."""
    slow, far, near = scores_db.mean(axis=0)
    on_harmonics, on_others = _gains(scores_db)
    return Trials(
        (float(slow), float(far), float(near)), seconds, (standard_error(on_harmonics), standard_error(on_others))
    )


def standard_error(differences: Floats) -> float:
    """Of a mean; 0 of one alone, of which it is not known."""
    return float(differences.std(ddof=1) / np.sqrt(len(differences))) if len(differences) > 1 else 0.0


def choose_light(
    rays: GlassRays,
    planes: PanelPlanes,
    config: ReflectionConfig,
    monitor: Monitor = QUIET,
    clock: Clock = time.process_time,
    device: str = "cpu",
) -> tuple[ModelName, tuple[Decision, ...]]:
    """Try the models on some rays, and decide which one is trained; see `try_lights`.

    Of fewer than two photos nothing can be held out, and an environment map is chosen without a decision.

    Raises
    ------
    ReconstructionError
        A trial failed.
    OperationCancelled
        From `monitor`.
    """
    found = try_lights(rays, planes, config, monitor, clock, device)
    return ("environment-map", ()) if found is None else chosen(found.trials)


def chosen(trials: Trials) -> tuple[ModelName, tuple[Decision, ...]]:
    """The model, and the decisions that lead to it."""
    effects: tuple[Effect[Trials], ...] = (FarLight(), NearLight())
    mirrors, near = (decide(effect, trials) for effect in effects)
    if near.on:
        return "radiance-grid", (mirrors, near)
    return ("environment-map" if mirrors.on else "harmonics"), (mirrors, near)


def contenders(trials: Trials, name: ModelName) -> tuple[ModelName, ...]:
    """Models beside the one chosen that may be better, together with splats: a grid that is better, but not surely."""
    slow, far, near = trials.scores_db
    return ("radiance-grid",) if name == "environment-map" and near > max(slow, far) else ()


def with_splats(scores_db: Mapping[ModelName, float], seconds: float) -> Decision:
    """About near-field light by PSNR, dB, of models together with splats; `seconds` as `Trials` has it."""
    return decide(NearLightBySplats(), (scores_db["radiance-grid"], scores_db["environment-map"], seconds))


def _folds(rays: GlassRays, seed: int) -> list[tuple[GlassRays, list[GlassRays]]]:
    """An even share of the rays of most photos, and some of each other photo to be scored on; many times of few."""
    generator = torch.Generator().manual_seed(seed)
    n = len(rays)
    order = torch.randperm(n, generator=generator) if n <= DRAWN else torch.randint(n, (DRAWN,), generator=generator)
    of_photo = rays.photos[order]
    photos = numbers_in(of_photo)
    if len(photos) < 2:
        return []
    n_unseen = max(1, round(UNSEEN * len(photos)))
    n_folds = min(FOLDS, len(photos) // n_unseen) if len(photos) < FEW_PHOTOS else 1
    shuffled = photos[torch.randperm(len(photos), generator=generator)]
    folds = []
    for held in torch.split(shuffled[: n_folds * n_unseen], n_unseen):
        unseen = [rays[order[of_photo == photo][: -(-SCORED // n_unseen)]] for photo in held]
        folds.append((rays[order[~torch.isin(of_photo, held)][:MOST_RAYS]], unseen))
    return folds


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
        bows="off",
    )
    return train_reflections(seen, planes, model, trial, monitor=monitor, clock=clock, device=device)
