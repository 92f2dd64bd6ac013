"""Use case of asking which settings of a training are worth their time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.services.reconstruct.training import TrainRequest, config_of_wish
from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.tradeoff.runner import Compared, Subject, compare

if TYPE_CHECKING:
    from reconstruction.tradeoff.train_tradeoff import Trial

POINTS = 12
"""Of a curve at least, where the time is known."""


def train_tradeoff(
    dataset: Path, wish: TrainRequest, knobs: Mapping[str, Sequence[Any]], out: Path, monitor: Monitor = QUIET
) -> Compared[tuple[Trial, ...]]:
    """Turn settings of a training one at a time; write `tradeoff-train.csv` and `.png` into `out`.

    Parameters
    ----------
    knobs
        Values by the name of a setting, inner ones with dots.

    Raises
    ------
    InputError
        The data set cannot be used, a setting is not known, or the folder cannot be written into.
    ReconstructionError
        A training came to nothing.
    OperationCancelled
        From `monitor`.
    """
    from reconstruction.tradeoff.scene_tradeoff import ERROR_AXIS
    from reconstruction.tradeoff.train_tradeoff import run_settings, settings_of, trial_panels, trial_rows

    base = config_of_wish(wish)
    if base.time_limit_s is not None:
        base = replace(base, score_every_s=min(base.score_every_s, base.time_limit_s / POINTS))
    settings = settings_of(base, knobs)
    if not (dataset / "dataset.json").is_file():
        raise InputError(
            say("has no dataset.json; name a folder that `prepare` or `scene render` has finished", place=dataset)
        )
    title = f"{dataset.name}: facades of unseen views"
    subject: Subject[tuple[Trial, ...]] = Subject("train", ERROR_AXIS, trial_rows, lambda _: title, trial_panels)
    return compare(subject, out, lambda _: run_settings(dataset, settings, monitor))
