"""Use case of training: a data set to a model."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from planning.errors import InputError
from planning.folders import make_folder
from planning.json_file import check_output, write_atomically
from planning.progress import QUIET, Monitor, Stop, Trace, never

if TYPE_CHECKING:
    from reconstruction.modelling.config import TrainConfig
    from reconstruction.modelling.ranks import Ranks
    from reconstruction.modelling.saved import TrainedModel
    from reconstruction.modelling.stopwatch import Stopwatch
    from reconstruction.modelling.watching import Preview, Watching

DEFAULT_PRESET = "10min"


@dataclass(frozen=True, slots=True)
class TrainWish:
    """What is asked of a training; None: as the preset has it.

    Parameters
    ----------
    settings
        TOML file with settings that differ from the preset's.
    start
        PLY file of splats to start from.
    """

    preset: str = DEFAULT_PRESET
    method: str | None = None
    light: str | None = None
    iterations: int | None = None
    time_limit_s: float | None = None
    seed: int | None = None
    settings: Path | None = None
    start: Path | None = None


@dataclass(frozen=True, slots=True, eq=False)
class TrainedFiles:
    """A model that was trained, and written where this process is the first of several."""

    folder: Path
    trained: TrainedModel
    is_written: bool = True


def config_of_wish(wish: TrainWish) -> TrainConfig:
    """Settings of a wish: the preset's, then the file's, then what was asked for by itself.

    Raises
    ------
    InputError
        There is no such preset, the file cannot be used, or a value is out of range.
    """
    import tomllib

    from reconstruction.modelling.config import config_of
    from reconstruction.modelling.presets import preset, with_wishes

    config = preset(wish.preset)
    if wish.settings is not None:
        try:
            content = tomllib.loads(wish.settings.read_text("utf-8"))
        except OSError as error:
            raise InputError(f"{wish.settings}: cannot be read ({error.strerror or error})") from error
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            raise InputError(f"{wish.settings}: not valid TOML ({error})") from error
        config = config_of(content, config, wish.settings)
    return with_wishes(
        config,
        method=wish.method,
        light=wish.light,
        iterations=wish.iterations,
        time_limit_s=wish.time_limit_s,
        seed=wish.seed,
    )


def train_files(
    dataset: Path,
    out: Path,
    wish: TrainWish,
    *,
    resume: bool = False,
    preview: Callable[[Preview], None] | None = None,
    pause: Stop = never,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
    begun_s: float | None = None,
) -> TrainedFiles:
    """Train a model of a data set folder into a folder; or go on with the training that was interrupted there.

    A finished model that is there stays until the new one is whole. Cancelled, the training's state is kept, and
    `resume` goes on with it; stopped, the model is what it is then.

    Parameters
    ----------
    begun_s
        What `time.perf_counter` said when the time limit began to count; None for now.

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
    from reconstruction.modelling.ranks import ranks_of_environment
    from reconstruction.modelling.saved import CHECKPOINT, save_model
    from reconstruction.modelling.stopwatch import Stopwatch
    from reconstruction.modelling.watching import Watching

    watch = Stopwatch(begun_s=begun_s)
    with ranks_of_environment() as ranks:
        watching = Watching(monitor, stop, pause, trace, preview if ranks.is_first else None)
        trained = _trained(dataset, out, wish, resume, watching, ranks, watch)
        if ranks.is_first:
            save_model(trained, out)
            (out / CHECKPOINT).unlink(missing_ok=True)
    return TrainedFiles(out, trained, ranks.is_first)


def _trained(
    dataset: Path, out: Path, wish: TrainWish, resume: bool, watching: Watching, ranks: Ranks, watch: Stopwatch
) -> TrainedModel:
    from reconstruction.modelling.saved import CHECKPOINT
    from reconstruction.modelling.train import resume_model, train_model

    checkpoint = out / CHECKPOINT
    if resume:
        if not checkpoint.is_file():
            raise InputError(f"{out}: holds no training that was interrupted; train without --resume")
        return resume_model(dataset, checkpoint, watching, method=wish.method, ranks=ranks, watch=watch)
    config = config_of_wish(wish)
    if ranks.is_first:
        _check_begin(dataset, out, checkpoint)
    return train_model(dataset, config, watching, checkpoint, given=wish.start, ranks=ranks, watch=watch)


def _check_begin(dataset: Path, out: Path, checkpoint: Path) -> None:
    """See that a training can begin, and make its folder."""
    if checkpoint.is_file():
        raise InputError(
            f"{out}: holds a training that was interrupted; go on with it (--resume), name another folder, or delete "
            f"{checkpoint}"
        )
    if not (dataset / "dataset.json").is_file():
        raise InputError(f"{dataset}: has no dataset.json; name a folder that `prepare` or `scene render` has finished")
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

    def write(preview: Preview) -> None:
        from reconstruction.modelling.render import png_of

        write_atomically(path, png_of(preview.picture))

    return write


def train_summary(made: TrainedFiles) -> dict[str, Any]:
    """For `--json`."""
    trained = made.trained
    record = trained.record
    return {
        "model": str(made.folder),
        "method": record.config.method,
        "light": None if record.light is None else record.light.name,
        "effects": [asdict(decision) for decision in record.decisions],
        "photos": len(record.learned),
        "held_out": len(record.held_out),
        "iterations": trained.n_steps,
        "splats": trained.n_splats,
        "seconds": round(trained.seconds, 3),
        "psnr_db": round(trained.history[-1].value, 3) if trained.history else None,
        "history": [{"t_s": round(point.t_s, 3), "psnr_db": round(point.value, 3)} for point in trained.history],
        "notes": list(trained.notes),
    }
