"""Folders of data sets and of models: what stands there, and which ones are meant by default."""

from __future__ import annotations

import json
import os
import re
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from planning.base.effects import Decision
from planning.base.errors import InputError
from planning.base.files import make_folder, real_path
from planning.base.json_file import expect_format, read_json, to_record, write_atomically
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, QualityPoint
from planning.site.records import Site
from reconstruction.light.photo_set import PhotoSet, read_photo_set
from reconstruction.training.parameters import CHECKPOINT, MODEL, TrainRequest

DATA_SET, NOTE = "dataset.json", "training.json"
"""Files by which folders are known."""

MODELS_FOLDER = "models"
"""Of a project."""

NOTE_FORMAT = "reflight-training/1"

SAME_PANELS_M = 1e-3
"""Corners of two folders that are further apart are not those of the same panels."""

LEAST_FREE_BYTES = 1 << 30
"""On the disk, for checkpoints and models: they are written beside the old ones."""

Corners = tuple[tuple[tuple[float, float, float], ...], ...]


@dataclass(frozen=True, slots=True, eq=False)
class DataSetCard:
    """A data set folder, as far as it is known before anything is learned from it.

    Parameters
    ----------
    normal_step
        Pixels of photos per pixel of normal maps, along each side.
    """

    source: PhotoSet
    site: str
    normal_step: int

    @property
    def folder(self) -> Path:
        """Where it is."""
        return self.source.folder

    @property
    def largest_px(self) -> int:
        """Pixels of its largest photo."""
        return max(photo.intrinsics.width_px * photo.intrinsics.height_px for photo in self.source.photos)

    def shows(self, site: Site) -> bool:
        """Whether its panels are those of a site."""
        return _is_same(self.source.panels.corners_enu_m.tolist(), tuple(panel.corners_enu_m for panel in site.panels))


@dataclass(frozen=True, slots=True)
class _Description:
    site: str = ""
    normal_step: int = 1


def read_data_set(folder: Path, monitor: Monitor = QUIET) -> DataSetCard:
    """Look at a data set folder.

    Raises
    ------
    InputError
        It is none, or damaged.
    """
    monitor.report(say("reading the data set"), 0, 0)
    source = read_photo_set(folder)
    path = folder / DATA_SET
    known = to_record(read_json(path, names_files=True), _Description, path)
    return DataSetCard(source, known.site, known.normal_step)


@dataclass(frozen=True, slots=True)
class TrainingNote:
    """What a training in a folder was begun with.

    Parameters
    ----------
    dataset
        Relative to the folder, where that can be said.
    """

    dataset: str
    preset: str
    method: str | None = None
    light: str | None = None
    time_limit_s: float | None = None


def note_training(out: Path, dataset: Path, request: TrainRequest) -> None:
    """Note what a training is begun with, for going on with it and for the next one.

    Raises
    ------
    InputError
        It cannot be written.
    """
    make_folder(out)
    note = {
        "format": NOTE_FORMAT,
        "dataset": _from(out, dataset),
        "preset": request.preset,
        "method": request.method,
        "light": request.light,
        "time_limit_s": request.time_limit_s,
    }
    write_atomically(out / NOTE, json.dumps(note, indent=1).encode())


def noted_training(out: Path) -> TrainingNote | None:
    """What the training in a folder was begun with; None where no window has begun it, or its note is damaged."""
    path = out / NOTE
    try:
        content = read_json(path, names_files=True)
        expect_format(content, NOTE_FORMAT, path)
        return to_record(content, TrainingNote, path)
    except InputError:
        return None


def noted_data_set(out: Path) -> Path | None:
    """The data set of the training in a folder, where it still is."""
    note = noted_training(out)
    if note is None:
        return None
    folder = Path(os.path.normpath(out / note.dataset))
    return folder if (folder / DATA_SET).is_file() else None


@dataclass(frozen=True, slots=True)
class ModelCard:
    """A finished model, as its description has it.

    Parameters
    ----------
    light
        "" where light is the splats' own.
    history
        PSNR, dB, of unseen views by seconds.
    """

    folder: Path
    method: str
    light: str
    n_splats: int
    n_steps: int
    seconds: float
    held_out: tuple[str, ...]
    history: tuple[QualityPoint, ...]
    decisions: tuple[Decision, ...]
    notes: tuple[str, ...]
    panels: Corners

    def is_of(self, card: DataSetCard) -> bool:
        """Whether it is a model of the panels that a data set shows."""
        return _is_same(self.panels, card.source.panels.corners_enu_m.tolist())


@dataclass(frozen=True, slots=True)
class _Panel:
    corners_enu_m: tuple[tuple[float, float, float], ...]


@dataclass(frozen=True, slots=True)
class _Site:
    panels: tuple[_Panel, ...]


@dataclass(frozen=True, slots=True)
class _Light:
    name: str


@dataclass(frozen=True, slots=True)
class _Model:
    method: str
    n_splats: int
    site: _Site
    held_out: tuple[str, ...] = ()
    light: _Light | None = None
    history: tuple[QualityPoint, ...] = ()
    decisions: tuple[Decision, ...] = ()
    n_steps: int = 0
    seconds: float = 0.0
    notes: tuple[str, ...] = ()


def read_model_card(folder: Path) -> ModelCard:
    """Look at a finished model, without its weights.

    Raises
    ------
    InputError
        There is none, or its description is damaged.
    """
    path = folder / MODEL
    if not path.is_file():
        raise InputError(say("holds no finished model", place=folder))
    content = read_json(path, names_files=True)
    found = to_record(content, _Model, path)
    panels = tuple(panel.corners_enu_m for panel in found.site.panels)
    light = "" if found.light is None else found.light.name
    return ModelCard(
        folder,
        found.method,
        light,
        found.n_splats,
        found.n_steps,
        found.seconds,
        found.held_out,
        found.history,
        found.decisions,
        found.notes,
        panels,
    )


@dataclass(frozen=True, slots=True)
class Standing:
    """What stands in a folder for a model.

    Parameters
    ----------
    is_interrupted
        There is a training that can be gone on with.
    has_model
        There is a finished model.
    is_foreign
        There is something, and neither of these.
    free_bytes
        On its disk; None where nobody knows.
    """

    is_interrupted: bool = False
    has_model: bool = False
    is_foreign: bool = False
    free_bytes: int | None = None


def standing(out: Path) -> Standing:
    """Look at a folder for a model, which need not exist yet."""
    there = next((folder for folder in (out, *out.parents) if folder.is_dir()), None)
    try:
        free_bytes = None if there is None else shutil.disk_usage(there).free
        names = {each.name for each in out.iterdir()} if out.is_dir() else set()
    except OSError:
        return Standing()
    is_interrupted, has_model = CHECKPOINT in names, MODEL in names
    is_foreign = bool(names - {NOTE}) and not (is_interrupted or has_model)
    return Standing(is_interrupted, has_model, is_foreign, free_bytes)


def proposed_folder(dataset: Path, method: str, project: Path | None) -> Path:
    """A folder for a model that nothing stands in: among the project's models, else beside the data set."""
    stem = re.sub(r"\.(photos|dataset)$", "", dataset.name)
    if project is not None:
        parent, name = project / MODELS_FOLDER, f"{stem}-{method}"
    else:
        parent, name = dataset.parent, f"{stem}.{method}.model"
    number, folder = 1, parent / name
    while folder.exists() and any((folder / file).exists() for file in (MODEL, CHECKPOINT)):
        number += 1
        folder = parent / f"{name}-{number}"
    return folder


def usual_data_set(project: Path | None) -> Path | None:
    """The data set of a project: that of the training which was begun last, else the newest folder that is one."""
    if project is None:
        return None
    for out in _newest(project / MODELS_FOLDER, NOTE):
        found = noted_data_set(out)
        if found is not None:
            return found
    return next(iter((*_newest(project, DATA_SET), *_newest(project / "photos", DATA_SET))), None)


def models_beside(out: Path, card: DataSetCard) -> tuple[ModelCard, ...]:
    """Finished models of a data set's panels, in the folders beside one, the newest first; no damaged ones."""
    found = []
    for folder in _newest(out.parent, MODEL):
        try:
            model = read_model_card(folder)
        except InputError:
            continue
        if model.is_of(card):
            found.append(model)
    return tuple(found)


def _newest(parent: Path, file: str) -> list[Path]:
    """Folders in one that have a file of that name, the newest first."""
    try:
        found = [(path.stat().st_mtime, path.parent) for path in parent.glob(f"*/{file}")]
    except OSError:
        return []
    return [folder for _, folder in sorted(found, key=lambda each: (-each[0], each[1].name))]


def _from(out: Path, dataset: Path) -> str:
    try:
        return os.path.relpath(real_path(dataset), real_path(out))
    except ValueError:  # on another drive
        return str(real_path(dataset))


def _is_same(mine: Any, others: Any) -> bool:
    import numpy as np

    one, other = np.asarray(mine, float), np.asarray(others, float)
    return one.shape == other.shape and bool(np.allclose(one, other, rtol=0.0, atol=SAME_PANELS_M))
