"""Use cases of training: a data set to a model, and which settings are worth their time."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from planning.base.errors import InputError
from planning.base.files import check_ending, make_folder
from planning.base.json_file import check_output, read_toml, write_atomically
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, Trace, never
from planning.tradeoff.runner import ComparisonFiles, Subject, compare
from reconstruction.training.method_registry import PLAIN_METHOD
from reconstruction.training.parameters import DEFAULT_PRESET, TrainRequest

if TYPE_CHECKING:
    from planning.base.effects import Decision
    from reconstruction.tradeoff.train_tradeoff import Trial
    from reconstruction.training.callbacks import Callbacks, Preview, Show, TrainingSnapshot
    from reconstruction.training.config import TrainConfig
    from reconstruction.training.model.saved import TrainedModel
    from reconstruction.training.ranks import Ranks
    from reconstruction.training.timer import Timer


__all__ = [
    "DEFAULT_PRESET",
    "TrainRequest",
    "TrainedFiles",
    "config_of_request",
    "light_of_scene",
    "preview_to",
    "train_files",
    "train_summary",
]

PAUSE_S = 0.05
"""Between looks at whether a pause is over."""


@dataclass(frozen=True, slots=True, eq=False)
class TrainedFiles:
    """A model that was trained, and written where this process is the first of several."""

    folder: Path
    trained: TrainedModel
    is_written: bool = True


def config_of_request(request: TrainRequest) -> TrainConfig:
    """Settings of a request: the preset's, then the method's, then the file's, then what was asked for by itself.

    Raises
    ------
    InputError
        There is no such preset, the file cannot be used, or a value is out of range.
    """
    from reconstruction.training.config import config_of
    from reconstruction.training.presets import preset, with_request

    config = preset(request.preset)
    if request.method is not None:
        config = config_of({"method": request.method}, config, Path("--method"))
    if request.settings is not None:
        config = config_of(read_toml(request.settings, dict[str, Any]), config, request.settings)
    return with_request(config, request)


def train_files(
    dataset: Path,
    out: Path,
    request: TrainRequest,
    *,
    resume: bool = False,
    preview: Callable[[Preview], None] | None = None,
    pause: Stop = never,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
    begun_s: float | None = None,
    visit: Callable[[TrainingSnapshot], None] | None = None,
    show_before: Show | None = None,
) -> TrainedFiles:
    """Train a model of a data set folder into a folder; or go on with the training that was interrupted there.

    A finished model that is there stays until the new one is whole. Cancelled, the training's state is kept, and
    `resume` goes on with it; stopped, its rates fall to their last, and the model is what it is then.

    Parameters
    ----------
    begun_s
        What `time.perf_counter` said when the time limit began to count; None for now.
    visit, show_before
        See `Callbacks`.

    Raises
    ------
    InputError
        The data set cannot be used, the folder cannot be written into, or holds another training that was interrupted.
    ReconstructionError
        The training came to nothing.
    OperationCancelled
        From `monitor`.
    """
    # Before the libraries are loaded, which takes seconds.
    begun_s = time.perf_counter() if begun_s is None else begun_s
    from reconstruction.training.callbacks import Callbacks, unshown
    from reconstruction.training.model.saved import save_model
    from reconstruction.training.parameters import CHECKPOINT
    from reconstruction.training.ranks import ranks_of_environment
    from reconstruction.training.timer import Timer

    watch = Timer(begun_s=begun_s)
    with ranks_of_environment() as ranks:
        waiting = _Waiting(monitor, pause, watch)
        watching = Callbacks(
            waiting, stop, pause, trace, preview if ranks.is_first else None, visit, show_before or unshown
        )
        trained = _trained(dataset, out, request, resume, watching, ranks, watch)
        if ranks.is_first:
            save_model(trained, out)
            (out / CHECKPOINT).unlink(missing_ok=True)
    return TrainedFiles(out, trained, ranks.is_first)


class _Waiting:
    """Monitor of what comes before the joint training: it waits while there is a pause. The joint one waits itself."""

    def __init__(self, monitor: Monitor, pause: Stop, watch: Timer) -> None:
        self._monitor, self._pause, self._watch = monitor, pause, watch

    def report(self, stage: str, done: float, total: float) -> None:
        """Pass progress on, and return when there is no pause."""
        self._monitor.report(stage, done, total)
        if stage in JOINT_STAGES or not self._pause():
            return
        with self._watch.paused():
            while self._pause():
                self._monitor.report(say("paused"), done, total)
                time.sleep(PAUSE_S)


JOINT_STAGES = frozenset({"training", "paused", "settling"})


def light_of_scene(dataset: Path, request: TrainRequest, monitor: Monitor = QUIET) -> tuple[str, tuple[Decision, ...]]:
    """The model of mirrored light that the photos of a data set call for, and the decisions that lead to it.

    Raises
    ------
    InputError
        The data set cannot be used, or shows no glass.
    OperationCancelled
        From `monitor`.
    """
    from reconstruction.light.choose_light import choose_light
    from reconstruction.light.glass_rays import glass_rays
    from reconstruction.light.photo_set import held_out_names, read_photo_set

    config = config_of_request(request)
    source = read_photo_set(dataset)
    held_out = held_out_names([photo.name for photo in source.photos], config.held_out, config.seed)
    learned = [photo for photo in source.photos if photo.name not in held_out]
    rays = glass_rays(source, learned, config.memory_bytes, config.seed, monitor)
    if not len(rays):
        raise InputError(
            say(
                "none of {} photos has a pixel that lies whole on a panel; take larger photos or come closer",
                len(learned),
                place=dataset,
            )
        )
    tried = replace(config.reflections, seed=config.seed, threads=config.threads, memory_bytes=config.memory_bytes)
    return choose_light(rays, source.panels, tried, monitor, device=config.tensors_on)


def _trained(
    dataset: Path, out: Path, request: TrainRequest, resume: bool, watching: Callbacks, ranks: Ranks, watch: Timer
) -> TrainedModel:
    from reconstruction.training.parameters import CHECKPOINT
    from reconstruction.training.train import resume_model, train_model

    checkpoint = out / CHECKPOINT
    if resume:
        if not checkpoint.is_file():
            raise InputError(say("holds no training that was interrupted; begin the training anew", place=out))
        return resume_model(dataset, checkpoint, watching, method=request.method, ranks=ranks, watch=watch)
    if ranks.is_first:
        _check_begin(dataset, out, checkpoint)
    config = _config_of_data_set(dataset, request)
    return train_model(dataset, config, watching, checkpoint, splats_path=request.start, ranks=ranks, watch=watch)


def _config_of_data_set(dataset: Path, request: TrainRequest) -> TrainConfig:
    """Settings of a request; of plain splats where the data set has no panels and no method is asked for."""
    from reconstruction.training.model.record import site_record

    config = config_of_request(request)
    if not config.trained_by.knows_panels or site_record(dataset).panels:
        return config
    if request.method is None:
        config = config_of_request(replace(request, method=PLAIN_METHOD))  # a method that the file names goes before
        if not config.trained_by.knows_panels:
            return config
    raise InputError(
        say(
            "has no panels, and {} learns what panels mirror; train plain splats instead (--method 2dgs), or find its "
            "panels first",
            config.method,
            place=dataset,
        )
    )


def _check_begin(dataset: Path, out: Path, checkpoint: Path) -> None:
    """See that a training can begin, and make its folder."""
    from reconstruction.light.photo_set import check_finished

    if checkpoint.is_file():
        raise InputError(
            say(
                "holds a training that was interrupted; resume it, name another folder, or delete {}",
                checkpoint,
                place=out,
            )
        )
    check_finished(dataset)
    make_folder(out)
    check_output(checkpoint)


def preview_to(path: Path) -> Callable[[Preview], None]:
    """Writes previews into a file, each in the place of the last one.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    check_output(path)
    check_ending(path, (".png",))

    def write(preview: Preview) -> None:
        from reconstruction.training.model.render import png_of

        write_atomically(path, png_of(preview.picture))

    return write


def train_summary(files: TrainedFiles) -> dict[str, Any]:
    """For `--json`."""
    trained = files.trained
    record = trained.record
    return {
        "model": str(files.folder),
        "method": record.config.method,
        "light": None if record.light is None else record.light.name,
        "effects": [asdict(decision) for decision in record.decisions],
        "photos": len(record.learned),
        "held_out": len(record.held_out),
        "iterations": trained.n_steps,
        "splats": trained.n_splats,
        "seconds": round(trained.seconds, 3),
        "psnr_db": None if trained.quality is None else round(trained.quality.psnr_db, 3),
        "scored_views": 0 if trained.quality is None else trained.quality.n_views,
        "history": [{"t_s": round(point.t_s, 3), "psnr_db": round(point.value, 3)} for point in trained.history],
        "notes": list(trained.notes),
    }


# Use case of asking which settings of a training are worth their time.

POINTS = 12
"""Of a curve at least, where the time is known."""


def train_tradeoff(
    dataset: Path, request: TrainRequest, knobs: Mapping[str, Sequence[Any]], out: Path, monitor: Monitor = QUIET
) -> ComparisonFiles[tuple[Trial, ...]]:
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
    from reconstruction.light.photo_set import check_finished, read_photo_set
    from reconstruction.tradeoff.scene_tradeoff import ERROR_AXIS
    from reconstruction.tradeoff.train_tradeoff import run_settings, settings_of, trial_panels, trial_rows

    base = config_of_request(request)
    if base.time_limit_s is not None:
        base = replace(base, score_every_s=min(base.score_every_s, base.time_limit_s / POINTS))
    settings = settings_of(base, knobs)
    check_finished(dataset)
    of_facades = read_photo_set(dataset).has_panels
    title = say("{}: facades of unseen views", dataset.name) if of_facades else say("{}: unseen views", dataset.name)
    subject: Subject[tuple[Trial, ...]] = Subject("train", ERROR_AXIS, trial_rows, lambda _: title, trial_panels)
    return compare(subject, out, lambda _: run_settings(dataset, settings, monitor))
