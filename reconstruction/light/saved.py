"""Trained reflections on the disk: weights as safetensors, and beside them in JSON what they are the weights of."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from safetensors import SafetensorError
from safetensors.numpy import load, save

from planning.base.errors import InputError
from planning.base.files import make_folder
from planning.base.json_file import expect_format, read_json, to_record, write_together
from planning.base.messages import say
from planning.base.progress import QualityPoint
from reconstruction.base.tensor_files import tensor_bytes
from reconstruction.light.config import Precision, ReflectionConfig
from reconstruction.light.photo_set import PanelPlanes
from reconstruction.light.radiance_grid import GridBox, RadianceGrid
from reconstruction.light.reflection_mlp import MlpHealth
from reconstruction.light.reflective_panels import ModelName, ReflectivePanels
from reconstruction.light.training import TrainedReflections, untrained_panels

FORMAT = "reflight-reflections/2"
WEIGHTS, DESCRIPTION = "reflections.safetensors", "reflections.json"

Corner = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class _Saved:
    model: ModelName
    config: ReflectionConfig
    corners_enu_m: tuple[tuple[Corner, Corner, Corner, Corner], ...]
    exposure: float
    precision: Precision
    n_rays: int
    n_steps: int
    seconds: float
    history: tuple[QualityPoint, ...]
    health: MlpHealth | None
    box: GridBox | None = None
    notes: tuple[str, ...] = ()


def save_reflections(trained: TrainedReflections, folder: Path) -> None:
    """Write the two files into a folder, which is made where it is missing: both or none.

    Raises
    ------
    InputError
        They cannot be written.
    """
    make_folder(folder)
    weights = {name: value.detach().numpy() for name, value in trained.panels.state_dict().items()}
    content = {
        "format": FORMAT,
        "model": trained.model,
        "config": asdict(trained.config),
        "corners_enu_m": trained.planes.corners_enu_m.tolist(),
        "exposure": trained.exposure,
        "precision": trained.precision,
        "n_rays": trained.n_rays,
        "n_steps": trained.n_steps,
        "seconds": trained.seconds,
        "history": [asdict(point) for point in trained.history],
        "health": None if trained.health is None else asdict(trained.health),
        "box": None if trained.box is None else asdict(trained.box),
        "notes": list(trained.notes),
    }
    described = json.dumps(content, indent=1, allow_nan=False).encode()
    write_together({folder / DESCRIPTION: described, folder / WEIGHTS: save(weights)})


def read_reflections(folder: Path) -> TrainedReflections:
    """Read what `save_reflections` wrote; it tells the same colours, bit by bit.

    Raises
    ------
    InputError
        A file is missing or damaged, or the weights are not those of the description.
    """
    path = folder / DESCRIPTION
    content = read_json(path)
    expect_format(content, FORMAT, path)
    saved = to_record(content, _Saved, path)
    if not saved.corners_enu_m:
        raise InputError(f"{path}: corners_enu_m: expected at least one panel")
    planes = PanelPlanes(np.array(saved.corners_enu_m, float))
    weights = _weights(folder / WEIGHTS)
    cells = weights.get("light.light.cells", np.zeros((0, 0, 0, 4), np.float32))
    if saved.box is not None and cells.shape != (*reversed(saved.box.counts), 4):
        raise InputError(f"{path}: box: expected that of the grid in {WEIGHTS}")
    panels = _untrained(saved, planes, len(weights.get("light.moves", ())), path)
    expected = {name: tuple(value.shape) for name, value in panels.state_dict().items()}
    if {name: value.shape for name, value in weights.items()} != expected:
        raise InputError(f"{folder / WEIGHTS}: holds the weights of another model than {path.name} describes")
    if not all(np.isfinite(value).all() for value in weights.values()):
        raise InputError(say("holds numbers that are not finite; train again", place=folder / WEIGHTS))
    panels.load_state_dict({name: torch.from_numpy(value) for name, value in weights.items()})
    if panels.light is not None and isinstance(panels.light.light, RadianceGrid):
        panels.light.light.refresh()
    panels.eval()
    return TrainedReflections(
        panels,
        saved.model,
        saved.config,
        planes,
        saved.exposure,
        saved.precision,
        saved.n_rays,
        saved.n_steps,
        saved.seconds,
        saved.history,
        saved.health,
        saved.notes,
    )


def _untrained(saved: _Saved, planes: PanelPlanes, n_photos: int, path: Path) -> ReflectivePanels:
    if (saved.box is None) == (saved.model == "radiance-grid"):
        raise InputError(f"{path}: box: expected one where the model is 'radiance-grid', and none for others")
    means = torch.full((len(saved.corners_enu_m), 3), 0.5)
    generator = torch.Generator().manual_seed(0)
    return untrained_panels(planes, saved.model, saved.config, means, generator, saved.box, n_photos)


def _weights(path: Path) -> dict[str, NDArray[np.float32]]:
    try:
        weights = load(tensor_bytes(path))
    except (SafetensorError, KeyError, ValueError) as error:
        raise InputError(say("is no safetensors file, or damaged: {}", error, place=path)) from error
    other = [name for name, value in weights.items() if value.dtype != np.float32]
    if other:
        raise InputError(f"{path}: expected float32 numbers, found {weights[other[0]].dtype} in '{other[0]}'")
    return weights
