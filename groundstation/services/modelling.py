"""Use cases of the modelling: a data set to a model, a model to pictures, and how good they are."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from planning.errors import InputError
from planning.folders import make_folder
from planning.json_file import check_output, write_atomically
from planning.progress import QUIET, Monitor, Stop, Trace, never

if TYPE_CHECKING:
    from reconstruction.cameras import PosedPhoto
    from reconstruction.modelling.config import TrainConfig
    from reconstruction.modelling.ranks import Ranks
    from reconstruction.modelling.saved import TrainedModel
    from reconstruction.modelling.score import ViewScores
    from reconstruction.modelling.stopwatch import Stopwatch
    from reconstruction.modelling.watching import Preview, Watching

ViewChoice = Literal["held-out", "all"]

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


@dataclass(frozen=True, slots=True)
class RenderWish:
    """What is to be rendered.

    Parameters
    ----------
    views
        Data set folder or plan: where its cameras are.
    layers
        Of `LAYERS`, beside the pictures.
    width_px
        Of the pictures; None: as the views have them.
    n_frames
        Along a path through the views, in their order; None: the views themselves.
    held_out_only
        Of a data set's views only those that the model did not learn from.
    """

    views: Path
    layers: tuple[str, ...] = ()
    width_px: int | None = None
    n_frames: int | None = None
    held_out_only: bool = False


def render_files(model: Path, wish: RenderWish, out: Path, monitor: Monitor = QUIET) -> tuple[Path, ...]:
    """Render a model's views into a folder; the pictures written.

    Raises
    ------
    InputError
        Model or views cannot be read, or a file cannot be written.
    """
    from reconstruction.modelling import render
    from reconstruction.modelling.camera_path import cameras_between
    from reconstruction.modelling.saved import read_model

    trained = read_model(model)
    photos = _cameras(wish, trained)
    if wish.n_frames is not None:
        photos = cameras_between(photos, wish.n_frames)
    return render.render_files(trained.model, photos, out, wish.layers, trained.record.config.raster, monitor)


def _cameras(wish: RenderWish, trained: TrainedModel) -> tuple[PosedPhoto, ...]:
    from groundstation.services.given_files import read_given_plan
    from reconstruction.reflections.photo_set import read_photo_set
    from reconstruction.scenes.flight_views import WIDTHS_PX, lens_of, planned_shots, posed_photos

    if wish.width_px is not None and not WIDTHS_PX[0] <= wish.width_px <= WIDTHS_PX[1]:
        raise InputError(f"--width: expected {WIDTHS_PX[0]} to {WIDTHS_PX[1]}, got {wish.width_px}")
    if not wish.views.is_dir():
        plan = read_given_plan(wish.views)
        return posed_photos(planned_shots(plan), lens_of(plan.camera, wish.width_px), Path())
    source = read_photo_set(wish.views)
    held_out = trained.record.held_out
    photos = source.named(held_out) if wish.held_out_only else source.photos
    if not photos:
        raise InputError(f"{wish.views}: has none of the views that the model did not learn from; leave --held-out out")
    return photos if wish.width_px is None else tuple(_resized(photo, wish.width_px) for photo in photos)


def _resized(photo: PosedPhoto, width_px: int) -> PosedPhoto:
    lens = photo.intrinsics
    return replace(photo, intrinsics=lens.scaled(width_px, max(1, round(width_px * lens.height_px / lens.width_px))))


@dataclass(frozen=True, slots=True)
class ScoredFiles:
    """Scores of a model's views.

    Parameters
    ----------
    lpips
        What it was scored with; "" where no weights were given.
    """

    views: tuple[ViewScores, ...]
    lpips: str


def score_files(
    model: Path,
    dataset: Path,
    choice: ViewChoice = "held-out",
    lpips_paths: Sequence[Path] = (),
    *,
    with_fitted_gain: bool = False,
    monitor: Monitor = QUIET,
) -> ScoredFiles:
    """Score a model's pictures against photos.

    Parameters
    ----------
    lpips_paths
        Weights for LPIPS, which the user supplies; without any it is left out.
    with_fitted_gain
        Fit the exposure of each view, to see what is left where it alone was wrong.

    Raises
    ------
    InputError
        Model, photos or weights cannot be read, or the photos are of another site.
    """
    from reconstruction.modelling.saved import read_model
    from reconstruction.modelling.score import score_views
    from reconstruction.reflections.photo_set import read_photo_set
    from reconstruction.scores.lpips_weights import read_lpips_weights

    trained = read_model(model)
    source = read_photo_set(dataset)
    names: Sequence[str] = trained.record.held_out
    if choice == "all":
        names = [photo.name for photo in source.photos]
    perceptual = read_lpips_weights(lpips_paths) if lpips_paths else None
    gain: Literal["none", "fitted"] = "fitted" if with_fitted_gain else "none"
    scores = score_views(trained, source, names, perceptual, gain, monitor=monitor)
    return ScoredFiles(scores, "" if perceptual is None else perceptual.description)


def score_summary(scored: ScoredFiles) -> dict[str, Any]:
    """For `--json`: means, worst views, and every view."""
    from reconstruction.modelling.score import mean_of

    scores = scored.views
    found: dict[str, Any] = {"views": len(scores), "lpips_weights": scored.lpips or None}
    for part in ("facade", "whole"):
        parts = [getattr(score, part) for score in scores]
        known = [one.psnr_db for one in parts if one.psnr_db is not None]
        found[part] = {
            "psnr_db": mean_of(one.psnr_db for one in parts),
            "worst_psnr_db": min(known, default=None),
            "ssim": mean_of(one.ssim for one in parts),
            "lpips": mean_of(getattr(score, f"{part}_lpips") for score in scores),
        }
    found["each"] = [asdict(score) for score in scores]
    return found
