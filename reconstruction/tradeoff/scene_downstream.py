"""What effects of simulated photos are worth to who trains on them: a reflection model with and without each.

A model that learned from photos without an effect is scored on unseen views with all of them, which is what the real
facade would show; and on unseen views of its own kind, which is what a study that left the effect out would report.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from planning.base.effects import Decision, EffectSetting
from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.base.cameras import PosedPhoto
from reconstruction.light.config import ReflectionConfig
from reconstruction.light.glass_rays import glass_rays
from reconstruction.light.photo_set import held_out_names, read_photo_set
from reconstruction.light.reflective_panels import ModelName
from reconstruction.light.training import ReflectionScore, TrainedReflections, score_views, train_reflections
from reconstruction.scenes.parameters import RenderSettings
from reconstruction.scenes.record import Scene
from reconstruction.scenes.runs.photo_folder import render_photo_folder
from reconstruction.scenes.runs.photo_job import PhotoJob

HISTORY_VIEWS = 4
"""Of the training folder that are held out: their rays draw the history."""


@dataclass(frozen=True, slots=True, eq=False)
class Downstream:
    """What was learned, from how many views, and its score on those that are `held_out`."""

    trained: TrainedReflections
    score: ReflectionScore
    held_out: tuple[str, ...]
    n_views: int


def downstream_psnr(
    train_folder: Path,
    test_folder: Path,
    model: ModelName = "mlp",
    config: ReflectionConfig | None = None,
    monitor: Monitor = QUIET,
) -> Downstream:
    """Train on one folder and score on another's views that were held out, `score.mean_db` first of all.

    Which views are held out follows from the test folder's names and the seed; the same views of the training folder
    are not learned from. So photos of the same flight, simulated without an effect, tell what leaving it out loses on
    photos that have it: `downstream_psnr(with_it, with_it)` less `downstream_psnr(without, with_it)`.

    Parameters
    ----------
    train_folder, test_folder
        Data sets of the same panels; they may be the same one.
    config
        The defaults where it is None.

    Raises
    ------
    InputError
        A folder is no data set or damaged, they show different panels, or too little glass.
    ReconstructionError
        The training failed.
    OperationCancelled
        From `monitor`.
    """
    settings = config or ReflectionConfig()
    test = read_photo_set(test_folder)
    source = test if train_folder == test_folder else read_photo_set(train_folder)
    held_out = held_out_names([photo.name for photo in test.photos], settings.held_out, settings.seed)
    learned = tuple(photo for photo in source.photos if photo.name not in held_out)
    if not learned:
        raise InputError(
            say("has only views that are held out for scoring; name photos with more views", place=train_folder)
        )
    rays = glass_rays(source, learned, settings.memory_bytes, settings.seed, monitor)
    if not len(rays):
        raise InputError(
            say(
                "none of {} photos has a pixel that lies whole on a panel; take larger photos (--width) or come closer",
                len(learned),
                place=train_folder,
            )
        )
    # Of the same folder, so that the history shows the model and not what the folders differ by.
    shown = source.named(held_out[:: -(-len(held_out) // HISTORY_VIEWS)])
    unseen = glass_rays(source, shown, settings.memory_bytes, settings.seed, monitor)
    trained = train_reflections(rays, source.panels, model, settings, source.exposure, unseen, monitor)
    return Downstream(trained, score_views(trained, test, held_out, monitor), held_out, len(learned))


N_POINTS = 100
"""That a folder's records start from; rays on glass need none."""


@dataclass(frozen=True, slots=True)
class EffectWorth:
    """What leaving an effect out does to a reflection model.

    Parameters
    ----------
    effect
        Empty for the photos with everything that the scene calls for.
    photos_s
        That rendering the photos took.
    psnr_db, worst_db
        On glass of unseen views with everything: mean and worst view.
    own_db
        On glass of unseen views rendered as those that it learned from.
    """

    effect: str
    photos_s: float
    psnr_db: float
    worst_db: float
    own_db: float


def effects_worth(
    scene: Scene,
    photos: Sequence[PosedPhoto],
    decisions: Sequence[Decision],
    effects: Sequence[str],
    folder: Path,
    *,
    model: ModelName = "mlp",
    config: ReflectionConfig | None = None,
    monitor: Monitor = QUIET,
) -> tuple[EffectWorth, ...]:
    """Train with everything that was decided for, and with each effect turned off that is on.

    Parameters
    ----------
    photos
        Of one flight, dozens of them; their paths do not matter.
    effects
        That are asked about; those that are off anyway are passed over.
    folder
        For the photos, a folder for each effect.

    Raises
    ------
    InputError
        The photos show too little glass, or the disk has no room.
    OperationCancelled
        From `monitor`.
    """
    decided: dict[str, EffectSetting] = {decision.effect: ("on" if decision.on else "off") for decision in decisions}
    chosen = [decision.effect for decision in decisions if decision.on and decision.effect in effects]
    everything = folder / "everything"
    worths = []
    for number, effect in enumerate(("", *chosen)):
        settings = {**decided, effect: "off"} if effect else decided
        here = folder / f"without-{number}" if effect else everything
        seconds = _rendered_s(scene, photos, RenderSettings(effects=settings), here, monitor)
        found = downstream_psnr(here, everything, model, config, monitor)
        own = found.score if not effect else score_views(found.trained, read_photo_set(here), found.held_out, monitor)
        worths.append(EffectWorth(effect, seconds, found.score.mean_db, found.score.worst_db, own.mean_db))
    return tuple(worths)


def _rendered_s(
    scene: Scene, photos: Sequence[PosedPhoto], settings: RenderSettings, folder: Path, monitor: Monitor
) -> float:
    """Seconds that the photos of a folder took."""
    placed = tuple(replace(photo, path=folder / "images" / photo.name) for photo in photos)
    started = time.perf_counter()
    render_photo_folder(PhotoJob(scene, placed, settings, {}, n_points=N_POINTS), folder, 1, monitor)
    return time.perf_counter() - started


def worth_rows(worths: Sequence[EffectWorth]) -> list[dict[str, Any]]:
    """Rows of the table; the first is that of everything."""
    base = worths[0]
    return [
        {
            "photos": f"without {worth.effect}" if worth.effect else "with all that the scene calls for",
            "photos_s": round(worth.photos_s, 2),
            "psnr_db": round(worth.psnr_db, 2),
            "lost_db": round(base.psnr_db - worth.psnr_db, 2),
            "worst_db": round(worth.worst_db, 2),
            "own_db": round(worth.own_db, 2),
            "misjudged_db": round(worth.own_db - base.psnr_db, 2),
        }
        for worth in worths
    ]
