"""What simulated photos are worth: learn reflections from one folder, and score them on unseen views of another."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from planning.base.errors import InputError
from planning.base.progress import QUIET, Monitor
from reconstruction.light.config import ReflectionConfig
from reconstruction.light.glass_rays import glass_rays
from reconstruction.light.photo_set import held_out_names, read_photo_set
from reconstruction.light.reflective_panels import ModelName
from reconstruction.light.scoring import ReflectionScore, score_views
from reconstruction.light.training import TrainedReflections, train_reflections

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
        raise InputError(f"{train_folder}: has only views that are held out for scoring; name photos with more views")
    rays = glass_rays(source, learned, settings.memory_bytes, settings.seed, monitor)
    if not len(rays):
        raise InputError(
            f"{train_folder}: none of {len(learned)} photos has a pixel that lies whole on a panel; take larger photos "
            "(--width) or come closer"
        )
    # Of the same folder, so that the history shows the model and not what the folders differ by.
    shown = source.named(held_out[:: -(-len(held_out) // HISTORY_VIEWS)])
    unseen = glass_rays(source, shown, settings.memory_bytes, settings.seed, monitor)
    trained = train_reflections(rays, source.panels, model, settings, source.exposure, unseen, monitor)
    return Downstream(trained, score_views(trained, test, held_out, monitor), held_out, len(learned))
