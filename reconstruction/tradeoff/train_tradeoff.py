"""What settings of a training are worth: each turned for itself, quality of unseen views against time."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from planning.base.progress import QUIET, Clock, Monitor, QualityPoint
from planning.tradeoff.runner import Curve, Line, NumberedRuns, Panel, falling
from reconstruction.light.photo_set import read_photo_set
from reconstruction.training.callbacks import Callbacks
from reconstruction.training.config import TrainConfig, config_of
from reconstruction.training.model.saved import TrainedModel
from reconstruction.training.model.score import mean_of, score_views
from reconstruction.training.timer import Timer
from reconstruction.training.train import train_model

BASE = "as the preset has it"


@dataclass(frozen=True, slots=True)
class Setting:
    """A training: which knob is turned to what, "" for none."""

    knob: str
    value: str
    config: TrainConfig

    @property
    def name(self) -> str:
        """For tables."""
        return f"{self.knob} = {self.value}" if self.knob else BASE


@dataclass(frozen=True, slots=True)
class Trial:
    """A training that was run.

    Parameters
    ----------
    facade_db, whole_db
        PSNR of all held-out views in the end, mean.
    history
        PSNR of some of them, over their facades, by seconds of training.
    light
        What mirrored light was learned with; "" for splats alone.
    effects
        That are on, by name.
    """

    setting: Setting
    facade_db: float
    whole_db: float
    ssim: float | None
    seconds: float
    n_steps: int
    n_splats: int
    history: tuple[QualityPoint, ...]
    light: str
    effects: tuple[str, ...]


def settings_of(base: TrainConfig, knobs: Mapping[str, Sequence[Any]]) -> tuple[Setting, ...]:
    """The base, and each knob at each value, all else as the base has it.

    Parameters
    ----------
    knobs
        Values by the name of a setting, inner ones with dots: `reflections.mlp.width`.

    Raises
    ------
    InputError
        There is no such setting, or it cannot have such a value.
    """
    found = [Setting("", "", base)]
    for knob, values in knobs.items():
        for value in values:
            content: Any = value
            for key in reversed(knob.split(".")):
                content = {key: content}
            config = config_of(content, base, Path("--vary"))
            if config != base:
                found.append(Setting(knob, str(value), config))
    return tuple(found)


def run_settings(
    folder: Path, settings: Sequence[Setting], monitor: Monitor = QUIET, clock: Clock = time.perf_counter
) -> tuple[Trial, ...]:
    """Train with each, one after the other, and score.

    Parameters
    ----------
    clock
        That time limits and curves go by.

    Raises
    ------
    InputError
        The folder cannot be used.
    ReconstructionError
        A training came to nothing.
    OperationCancelled
        From `monitor`.
    """
    trials, named = [], NumberedRuns(monitor, "training")
    for number, setting in enumerate(settings):
        named.begin(number, len(settings))
        trained = train_model(folder, setting.config, Callbacks(named), watch=Timer(clock))
        trials.append(_trial(setting, trained, folder, named))
    return tuple(trials)


def _trial(setting: Setting, trained: TrainedModel, folder: Path, monitor: Monitor) -> Trial:
    source = read_photo_set(folder)
    scores = score_views(trained, source, trained.record.held_out, monitor=monitor)
    return Trial(
        setting,
        mean_of(score.facade.psnr_db for score in scores) or math.nan,
        mean_of(score.whole.psnr_db for score in scores) or math.nan,
        mean_of(score.facade.ssim for score in scores),
        trained.seconds,
        trained.n_steps,
        trained.n_splats,
        trained.history,
        "" if trained.record.light is None else trained.record.light.name,
        tuple(decision.effect for decision in trained.record.decisions if decision.on),
    )


def trial_rows(trials: Sequence[Trial]) -> list[dict[str, Any]]:
    """Rows of the table, the base first; changes are against it."""
    base = trials[0]
    return [
        {
            "setting": trial.setting.name,
            "seconds": round(trial.seconds, 2),
            "facade_psnr_db": round(trial.facade_db, 2),
            "change_db": round(trial.facade_db - base.facade_db, 2),
            "whole_psnr_db": round(trial.whole_db, 2),
            "facade_ssim": None if trial.ssim is None else round(trial.ssim, 4),
            "steps": trial.n_steps,
            "splats": trial.n_splats,
        }
        for trial in trials
    ]


def trial_panels(trials: Sequence[Trial]) -> list[Panel]:
    """A panel for each knob, with the base in each."""
    base = trials[0]
    knobs = dict.fromkeys(trial.setting.knob for trial in trials[1:])
    panels = []
    for knob in knobs or {"": None}:
        chosen = [base, *(trial for trial in trials[1:] if trial.setting.knob == knob)]
        lines = [Line(trial.setting.name, _curve(trial), f"{trial.facade_db:.1f} dB") for trial in chosen]
        panels.append(Panel(knob or BASE, tuple(lines)))
    return panels


def _curve(trial: Trial) -> Curve:
    """Root mean square error, of values 0 to 1, against time."""
    points = [QualityPoint(max(point.t_s, 1e-3), 10.0 ** (-point.value / 20.0)) for point in trial.history]
    return falling(points, trial.seconds)
