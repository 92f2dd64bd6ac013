"""Use case of asking which settings of a training are worth their time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.services.plan.tradeoff import output_folder, write_results
from groundstation.services.reconstruct.training import TrainRequest, config_of_wish
from planning.base.errors import InputError
from planning.base.progress import QUIET, Monitor

if TYPE_CHECKING:
    from reconstruction.tradeoff.train_tradeoff import Trial

STEM = "tradeoff-train"

POINTS = 12
"""Of a curve at least, where the time is known."""


@dataclass(frozen=True, slots=True, eq=False)
class TrainTradeoff:
    """What `tradeoff train` found, and the files written."""

    trials: tuple[Trial, ...]
    csv_path: Path
    picture_path: Path


def train_tradeoff(
    dataset: Path, wish: TrainRequest, knobs: Mapping[str, Sequence[Any]], out: Path, monitor: Monitor = QUIET
) -> TrainTradeoff:
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
        raise InputError(f"{dataset}: has no dataset.json; name a folder that `prepare` or `scene render` has finished")
    with output_folder(out) as folder:
        trials = run_settings(dataset, settings, monitor)
        title = f"{dataset.name}: facades of unseen views"
        names = write_results(folder, STEM, trial_rows(trials), title, trial_panels(trials), ERROR_AXIS)
    return TrainTradeoff(trials, out / names[0], out / names[1])
