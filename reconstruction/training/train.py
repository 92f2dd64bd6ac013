"""A whole training: data set folder in, trained model out; begun, or gone on with from its checkpoint."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError, OperationCancelled
from planning.base.json_file import to_record
from planning.base.messages import say
from planning.base.progress import QualityPoint
from reconstruction.base.cameras import PosedPhoto
from reconstruction.light.photo_set import PhotoSet, read_photo_set
from reconstruction.light.training import torch_threads
from reconstruction.metrics.image_metrics import Quality
from reconstruction.splats.rasterising.views import View
from reconstruction.training.callbacks import Callbacks, HeldOut
from reconstruction.training.config import TrainConfig
from reconstruction.training.devices import check_device, drawn_by_card
from reconstruction.training.model.record import ModelRecord, Vec3, empty_model, light_record, site_record
from reconstruction.training.model.saved import TrainedModel
from reconstruction.training.model.score import quality_of, score_views
from reconstruction.training.photos.photo_stream import PhotoStream, StreamSettings
from reconstruction.training.photos.poses import PoseCorrections, moved, one_after_other
from reconstruction.training.photos.transients import Transients
from reconstruction.training.ranks import ALONE, Ranks
from reconstruction.training.start import (
    SHOWN_SHARE,
    Start,
    interrupted_light_stage,
    shown_views,
    start_model,
)
from reconstruction.training.timer import Timer
from reconstruction.training.trainer import Trainer, strategy_of
from reconstruction.training.training_state import read_checkpoint

TRIM_THRESHOLD, TOP_PAD, MMAP_THRESHOLD = -1, -2, -3
"""Parameters of `mallopt` (malloc.h)."""

KEPT, AHEAD, PIECE = 1 << 30, 1 << 26, 1 << 30
"""Free bytes that are kept, bytes that are asked for beyond what is needed, and size of pieces that are no part of
either."""

USUAL_KEPT, USUAL_AHEAD, USUAL_PIECE = 1 << 26, 1 << 17, 1 << 25
"""What the library comes to by itself in a process with large pieces."""


@contextmanager
def freed_memory_retained() -> Iterator[None]:
    """Keep what is freed within a block, up to `KEPT`; at its end all that is free is given back."""
    library = _gnu_library()
    if library is None:
        yield
        return
    _tell(library, KEPT, AHEAD, PIECE)
    try:
        yield
    finally:
        _tell(library, USUAL_KEPT, USUAL_AHEAD, USUAL_PIECE)
        library.malloc_trim(0)


def _tell(library: Any, kept: int, ahead: int, piece: int) -> None:
    for parameter, value in ((TRIM_THRESHOLD, kept), (TOP_PAD, ahead), (MMAP_THRESHOLD, piece)):
        library.mallopt(parameter, value)


def _gnu_library() -> Any:
    """The C library of this process, where it is GNU's."""
    if sys.platform != "linux":
        return None
    library = ctypes.CDLL(None)
    return library if hasattr(library, "gnu_get_libc_version") else None


@freed_memory_retained()
def train_model(
    folder: Path,
    config: TrainConfig,
    watching: Callbacks | None = None,
    checkpoint: Path | None = None,
    *,
    splats_path: Path | None = None,
    ranks: Ranks = ALONE,
    watch: Timer | None = None,
) -> TrainedModel:
    """Train a model of a data set folder.

    Parameters
    ----------
    checkpoint
        File that the training can go on from if it is interrupted; None for none.
    splats_path
        PLY file of splats to start from; None for new ones, on what is known of the scene.
    ranks
        Processes that train together; all but the first begin with the checkpoint that that one writes.
    watch
        Of all that counts for the time limit; None where that begins now.

    Raises
    ------
    InputError
        The folder is no data set, or too little of one.
    ReconstructionError
        The training came to nothing; see `Trainer`.
    OperationCancelled
        From the monitor.
    """
    watching, watch = watching or Callbacks(), watch or Timer()
    check_device(config)
    if not ranks.is_first:
        if checkpoint is None:
            raise ValueError("checkpoint: expected one where several processes train together")
        return _joined_later(folder, checkpoint, watching, ranks, watch)
    source = read_photo_set(folder)
    with torch_threads(config.threads):
        start = start_model(
            *(source, config, watching.monitor, watch, checkpoint),
            splats_path=splats_path,
            show=watching.show_before,
        )
    return _started(source, start, watching, checkpoint, ranks, watch)


def _started(
    source: PhotoSet,
    start: Start,
    watching: Callbacks,
    checkpoint: Path | None,
    ranks: Ranks,
    watch: Timer,
) -> TrainedModel:
    """The joint training after its start."""
    config = start.config
    view = View.of(start.learned[0], start.model.origin_enu_m)
    on_gpu, by_card = drawn_by_card(config, start.model.splats, view)
    record = ModelRecord(
        config,
        light_record(start.model, start.light_name),
        site_record(source.folder),
        tuple(start.model.origin_enu_m.tolist()),
        start.model.corner_square,
        source.exposure,
        tuple(photo.name for photo in start.learned),
        start.held_out,
        start.extent_m,
        start.decisions if by_card is None else (*start.decisions, by_card),
        start.moves,
        *_looks(moved(start.learned, start.moves)),
    )
    with ExitStack() as closing:
        photos, shown = _photos(source, record, closing)
        trainer = Trainer(
            start.model,
            start.exposures,
            _poses(source, record),
            _transients(source, record, start.transients),
            photos,
            strategy_of(config, len(start.model.splats)),
            config,
            shown=shown,
            extent_m=start.extent_m,
            checkpoint=checkpoint,
            record=asdict(record),
            notes=start.notes,
            history=start.history,
            ranks=ranks,
            watch=watch,
            last_px=_pixels(source, record.held_out),
            on_gpu=on_gpu,
        )
        trainer.save()
        ranks.wait()
        return _finished(trainer, record, source, watching)


@freed_memory_retained()
def resume_model(
    folder: Path,
    checkpoint: Path,
    watching: Callbacks | None = None,
    *,
    method: str | None = None,
    ranks: Ranks = ALONE,
    watch: Timer | None = None,
) -> TrainedModel:
    """Go on with a training, with the settings that it was begun with.

    Parameters
    ----------
    method
        That is expected; None for any.

    Raises
    ------
    InputError
        The checkpoint is missing or damaged, or of another method or other photos.
    """
    watching, watch = watching or Callbacks(), watch or Timer()
    content = read_checkpoint(checkpoint)
    # Nobody writes another one before all have read this one.
    ranks.wait()
    interrupted = interrupted_light_stage(content, checkpoint)
    if interrupted is None:
        return _resumed(folder, checkpoint, content, watching, method, ranks, watch)
    config = interrupted.stage.config
    _check_method(config, method, checkpoint)
    if not ranks.is_first:
        return _joined_later(folder, checkpoint, watching, ranks, watch)
    if site_record(folder) != interrupted.stage.site:
        raise InputError(say("shows other panels; name the data set that the training was begun with", place=folder))
    watch.before_s += interrupted.spent_s
    source = read_photo_set(folder)
    with torch_threads(config.threads):
        start = start_model(
            *(source, config, watching.monitor, watch, checkpoint, interrupted), show=watching.show_before
        )
    return _started(source, start, watching, checkpoint, ranks, watch)


def _joined_later(folder: Path, checkpoint: Path, watching: Callbacks, ranks: Ranks, watch: Timer) -> TrainedModel:
    """The part of a process that waits until the first one has learned light."""
    ranks.wait()
    return _resumed(folder, checkpoint, read_checkpoint(checkpoint), watching, None, ranks, watch)


def _resumed(
    folder: Path,
    checkpoint: Path,
    content: dict[str, Any],
    watching: Callbacks,
    method: str | None,
    ranks: Ranks,
    watch: Timer,
) -> TrainedModel:
    """A joint training that is gone on with."""
    record = to_record(content.get("record"), ModelRecord, checkpoint)
    _check_method(record.config, method, checkpoint)
    state = content.get("training")
    if not isinstance(state, dict) or not isinstance(state.get("model"), dict):
        raise InputError(say("holds no state of a training; begin the training anew", place=checkpoint))
    source = read_photo_set(folder)
    missing = {*record.learned, *record.held_out} - {photo.name for photo in source.photos}
    if missing or site_record(folder) != record.site:
        what = say("lacks the photo '{}'", min(missing)) if missing else say("shows other panels")
        raise InputError(say("{}; name the data set that the training was begun with", what, place=folder))
    try:
        model, exposures = empty_model(record, state["model"])
    except ValueError as error:
        raise InputError(say("is damaged ({}); begin the training anew", error, place=checkpoint)) from error
    view = View.of(source.named(record.learned)[0], np.array(record.origin_enu_m))
    on_gpu, _ = drawn_by_card(record.config, model.splats, view)
    with ExitStack() as closing:
        photos, shown = _photos(source, record, closing)
        trainer = Trainer(
            model,
            exposures,
            _poses(source, record),
            _transients(source, record),
            photos,
            strategy_of(record.config, len(model.splats)),
            record.config,
            shown=shown,
            extent_m=record.extent_m,
            checkpoint=checkpoint,
            record=asdict(record),
            ranks=ranks,
            watch=watch,
            last_px=_pixels(source, record.held_out),
            on_gpu=on_gpu,
        )
        trainer.restore(state)
        watch.before_s += trainer.at.spent_s
        return _finished(trainer, record, source, watching)


def _check_method(config: TrainConfig, method: str | None, checkpoint: Path) -> None:
    check_device(config)
    if method not in (None, config.method):
        raise InputError(say("is of a training of {}; resume with that method", config.method, place=checkpoint))


def _photos(source: PhotoSet, record: ModelRecord, closing: ExitStack) -> tuple[PhotoStream, tuple[HeldOut, ...]]:
    """The stream of photos to learn from, and held-out ones to show."""
    config, origin = record.config, np.array(record.origin_enu_m)
    source = _corrected(source, record)
    with_normals = config.trained_by.knows_panels and config.losses.normal_prior > 0.0
    settings = StreamSettings(
        round((1.0 - SHOWN_SHARE) * config.memory_bytes), config.window_px, config.reduce, with_normals
    )
    photos = closing.enter_context(PhotoStream(source, record.learned, origin, settings))
    return photos, shown_views(source, record.held_out, origin, config.memory_bytes)


def _poses(source: PhotoSet, record: ModelRecord) -> PoseCorrections:
    """Of the photos that are learned from, to begin with."""
    return PoseCorrections(_corrected(source, record).named(record.learned), np.array(record.origin_enu_m))


def _transients(source: PhotoSet, record: ModelRecord, known: NDArray[np.bool_] | None = None) -> Transients:
    """Of the photos that are learned from, to begin with."""
    reduce, lenses = record.config.reduce, [photo.intrinsics for photo in source.named(record.learned)]
    sizes = [(lens.width_px // reduce, lens.height_px // reduce) for lens in lenses]
    return Transients(sizes, known, record.config.losses.white)


def _pixels(source: PhotoSet, names: Sequence[str]) -> int:
    """Of all photos that are named."""
    return sum(photo.intrinsics.width_px * photo.intrinsics.height_px for photo in source.named(names))


def _corrected(source: PhotoSet, record: ModelRecord) -> PhotoSet:
    """With the photos that are learned from where learning light found them to be; held-out ones stay."""
    if not record.moves:
        return source
    learned = {photo.name: photo for photo in moved(source.named(record.learned), record.moves)}
    return replace(source, photos=tuple(learned.get(photo.name, photo) for photo in source.photos))


def _finished(trainer: Trainer, record: ModelRecord, source: PhotoSet, watching: Callbacks) -> TrainedModel:
    trainer.run(watching)
    at = trainer.at
    record = _with_findings(record, trainer, source)
    history = tuple(QualityPoint(t_s, value) for t_s, value in at.history)
    trained = TrainedModel(record, trainer.model, trainer.exposures, history, at.step, at.spent_s, tuple(at.notes))
    try:
        quality = _last_look(trainer, trained, source, watching)
    except OperationCancelled:
        trainer.save()
        raise
    trainer.model.cpu()
    trainer.exposures.cpu()
    return replace(trained, quality=quality)


def _with_findings(record: ModelRecord, trainer: Trainer, source: PhotoSet) -> ModelRecord:
    """The record of a model, with what training it found out about its photos."""
    config, spent_s = record.config, trainer.at.spent_s
    decision = trainer.poses.decision(config.own_poses, spent_s)
    record = replace(record, decisions=(*record.decisions, decision))
    if config.transients != "off":
        of_transients = trainer.transients.decision(config.transients, spent_s)
        record = replace(record, decisions=(*record.decisions, of_transients))
    if not decision.on:
        return record
    moves = one_after_other(record.moves, trainer.poses.moves())
    places, forwards = _looks(moved(source.named(record.learned), moves))
    return replace(record, moves=moves, places_enu_m=places, forwards_enu=forwards)


def _looks(photos: Sequence[PosedPhoto]) -> tuple[tuple[Vec3, ...], tuple[Vec3, ...]]:
    """Where photos were taken, and in which directions they look, ENU."""
    poses = [photo.pose for photo in photos]
    vectors = [pose.position_enu_m for pose in poses], [pose.forward_enu for pose in poses]
    places, forwards = (tuple((float(x), float(y), float(z)) for x, y, z in each) for each in vectors)
    return places, forwards


def _last_look(trainer: Trainer, trained: TrainedModel, source: PhotoSet, watching: Callbacks) -> Quality | None:
    """Score held-out views as `score` does, all of them where that fits into its share of the time limit."""
    if not trainer.is_first:
        return None
    names = trained.record.held_out
    share = trainer.most_final_scoring_s() / max(trainer.final_scoring_s(), 1e-9)
    n_views = len(names) if share >= 1.0 else max(1, int(share * len(names)))
    chosen = [names[number * len(names) // n_views] for number in range(n_views)]
    return quality_of(score_views(trained, source, chosen, monitor=watching.monitor, psnr_alone=True))
