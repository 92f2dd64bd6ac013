"""A trained model on the disk: a folder with `model.json`, the weights that it names, and the splats for viewers.

The weights' file is named after its content and written first; `model.json` is replaced in one step. So a folder that
had a model has a whole one at every moment. The splats, which only other programs read, are never those of another
model: the old ones go before `model.json` is replaced, and the new ones come after it.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError
from safetensors.torch import load, save
from torch import Tensor

from planning.base.errors import InputError
from planning.base.files import make_folder
from planning.base.json_file import expect_format, part_files, read_json, to_record, write_atomically
from planning.base.messages import say
from planning.base.progress import QualityPoint
from reconstruction.base.tensor_files import tensor_bytes
from reconstruction.metrics.image_metrics import Quality
from reconstruction.splats.ply import Kind, render_mode, write_splats
from reconstruction.splats.splats import splats_from_tensors
from reconstruction.training.model.joint_model import SceneModel
from reconstruction.training.model.record import ModelRecord, empty_model
from reconstruction.training.parameters import CHECKPOINT, MODEL
from reconstruction.training.photos.exposures import Exposures

FORMAT = "reflight-model/1"
SPLATS = "splats.ply"

GAINS = "exposures."
"""Of weights' names, before those of the photos' gains; all others are the model's."""


@dataclass(frozen=True, slots=True, eq=False)
class TrainedModel:
    """A model and how it came about.

    Parameters
    ----------
    model
        In evaluation mode.
    exposures
        Gains of the photos learned from, in the order of `record.learned`.
    history
        PSNR, dB, of some held-out views, made smaller, over their facades, by seconds of training.
    n_steps, seconds
        Of the joint training; seconds with learning light alone.
    notes
        What had to be survived on the way.
    quality
        Of held-out views in full, when it had ended: what `score` says of them. None where that was not measured.
    """

    record: ModelRecord
    model: SceneModel
    exposures: Exposures
    history: tuple[QualityPoint, ...]
    n_steps: int
    seconds: float
    notes: tuple[str, ...] = ()
    quality: Quality | None = None

    @property
    def n_splats(self) -> int:
        """How many there are."""
        return len(self.model.splats)


@dataclass(frozen=True, slots=True)
class _Weights:
    file: str
    sha256: str


@dataclass(frozen=True, slots=True)
class _Saved(ModelRecord):
    history: tuple[QualityPoint, ...] = ()
    n_steps: int = 0
    seconds: float = 0.0
    notes: tuple[str, ...] = ()
    quality: Quality | None = None


@dataclass(frozen=True, slots=True)
class _File(_Saved):
    weights: _Weights = _Weights("", "")


def save_model(trained: TrainedModel, folder: Path) -> None:
    """Write a model; one that was there stays whole until the new one is.

    Raises
    ------
    InputError
        It cannot be written.
    """
    make_folder(folder)
    content = save(tensors_of(trained))
    digest = hashlib.sha256(content).hexdigest()
    name = f"weights-{digest[:12]}.safetensors"
    description = {**description_of(trained), "weights": {"file": name, "sha256": digest}}
    was_there = (folder / name).exists()
    try:
        write_atomically(folder / name, content)
        with part_files((folder / MODEL, folder / SPLATS)) as (described, splats):
            described.write_bytes(json.dumps(description, indent=1, allow_nan=False).encode())
            kind: Kind = "2dgs" if trained.model.splats.is_flat else "3dgs"
            write_splats(splats, trained.model.splats, kind, trained.record.origin_enu_m, _comments(trained.record))
    except BaseException as error:
        if not was_there:
            (folder / name).unlink(missing_ok=True)
        if isinstance(error, OSError):
            raise InputError(say("the model cannot be written ({})", error.strerror or error, place=folder)) from error
        raise
    for old in folder.glob("weights-*.safetensors"):
        if old.name != name:
            old.unlink(missing_ok=True)


def _comments(record: ModelRecord) -> list[str]:
    """What a PLY file says about how it is to be drawn, and about where it belongs."""
    config, origin = record.config, record.site.origin
    is_solid = config.trained_by.primitive == "ellipsoids"
    lines = [*render_mode("mip" if config.raster.antialiased and is_solid else ""), f"site: {record.site.name}"]
    if origin is None:
        return lines
    place = f"{origin.lat_deg!r} {origin.lon_deg!r} {origin.ellipsoid_height_m!r}"
    return [*lines, f"site origin, WGS 84 lat lon ellipsoid height: {place}"]


def read_model(folder: Path) -> TrainedModel:
    """Read a model; it renders the same pictures, bit by bit.

    Raises
    ------
    InputError
        A file is missing or damaged, or the weights are not those of the description.
    """
    while True:
        try:
            return _read(folder)
        except _Replaced:
            continue


class _Replaced(Exception):  # noqa: N818
    """The model was written anew while it was being read."""


def _read(folder: Path) -> TrainedModel:
    path = folder / MODEL
    if not path.is_file():
        advice = say("resume its training") if (folder / CHECKPOINT).is_file() else say("name one of `train`")
        raise InputError(say("holds no finished model; {}", advice, place=folder))
    content = read_json(path, names_files=True)
    expect_format(content, FORMAT, path)
    saved = to_record(content, _File, path)
    if Path(saved.weights.file).name != saved.weights.file or not saved.weights.file:
        raise InputError(
            say("weights.file: expected the name of a file beside it, got '{}'", saved.weights.file, place=path)
        )
    weights = folder / saved.weights.file
    try:
        tensors = _read_tensors(weights, saved.weights.sha256)
    except InputError as error:
        if read_json(path, names_files=True) != content:
            raise _Replaced from error
        raise
    return _trained(saved, tensors, weights)


def description_of(trained: TrainedModel) -> dict[str, Any]:
    """All that a model is besides its weights, as plain values."""
    return {
        "format": FORMAT,
        "method": trained.record.config.method,
        "n_splats": trained.n_splats,
        **asdict(trained.record),
        "history": [asdict(point) for point in trained.history],
        "n_steps": trained.n_steps,
        "seconds": trained.seconds,
        "notes": list(trained.notes),
        "quality": None if trained.quality is None else asdict(trained.quality),
    }


def trained_of(description: Mapping[str, Any], tensors: Mapping[str, Tensor], path: Path) -> TrainedModel:
    """The model that `description_of` and `tensors_of` told.

    Parameters
    ----------
    path
        Where they are from, for messages.

    Raises
    ------
    InputError
        They are damaged, or of different models.
    """
    expect_format(description, FORMAT, path)
    return _trained(to_record(description, _Saved, path), tensors, path)


def _trained(saved: _Saved, tensors: Mapping[str, Tensor], path: Path) -> TrainedModel:
    record = ModelRecord(*(getattr(saved, each.name) for each in fields(ModelRecord)))
    model, exposures = _filled(record, tensors, path)
    return TrainedModel(
        record, model, exposures, saved.history, saved.n_steps, saved.seconds, saved.notes, saved.quality
    )


def tensors_of(trained: TrainedModel) -> dict[str, Tensor]:
    """All of its weights by name, as `model.json` has them: copies, on the processor."""
    parts = {**trained.model.state_dict()}
    parts |= {f"{GAINS}{name}": value for name, value in trained.exposures.state_dict().items()}
    return {name: value.detach().cpu().contiguous().clone() for name, value in parts.items()}


def _read_tensors(path: Path, sha256: str) -> dict[str, Tensor]:
    content = tensor_bytes(path)
    if hashlib.sha256(content).hexdigest() != sha256:
        raise InputError(say("is not the file that {} was written with; was it changed or cut off?", MODEL, place=path))
    try:
        return load(content)
    except (SafetensorError, KeyError, ValueError, TypeError) as error:
        raise InputError(say("is no safetensors file, or damaged: {}", error, place=path)) from error


def _filled(record: ModelRecord, tensors: Mapping[str, Tensor], path: Path) -> tuple[SceneModel, Exposures]:
    """The model that a record and weights make."""
    for name, value in tensors.items():
        if value.is_floating_point() and not bool(torch.isfinite(value).all()):
            raise InputError(say("holds numbers that are not finite; train again", place=f"{path}: {name}"))
    found = {name.removeprefix("splats."): value for name, value in tensors.items() if name.startswith("splats.")}
    splats_from_tensors(found, str(path))
    if len(found["panels"]) and int(found["panels"].max()) >= len(record.site.panels):
        raise InputError(
            say("has splats on panel {} of {}", int(found["panels"].max()) + 1, len(record.site.panels), place=path)
        )
    try:
        model, exposures = empty_model(record, tensors)
        gains: dict[str, Any] = {
            name.removeprefix(GAINS): value for name, value in tensors.items() if name.startswith(GAINS)
        }
        model.load({name: value for name, value in tensors.items() if not name.startswith(GAINS)})
        exposures.load_state_dict(gains)
    except (KeyError, ValueError, RuntimeError) as error:
        raise InputError(
            say("holds the weights of another model than {} describes ({})", MODEL, error, place=path)
        ) from error
    model.eval()
    return model, exposures
