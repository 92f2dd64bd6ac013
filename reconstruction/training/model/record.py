"""What a model is besides its weights: enough to build one of the same shape, and to know what it is a model of."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from planning.base.effects import Decision
from planning.base.json_file import expect_format, read_json, to_record
from reconstruction.dataset.records import DATASET_FORMAT
from reconstruction.light.config import GlassLearned, Precision
from reconstruction.light.environment_map import EnvironmentMap
from reconstruction.light.glass_light import GlassLight, LightModel
from reconstruction.light.photo_set import PanelPlanes
from reconstruction.light.radiance_grid import GridBox, RadianceGrid
from reconstruction.light.reflection_mlp import ReflectionMlp
from reconstruction.splats.sky import Sky
from reconstruction.splats.splats import Splats
from reconstruction.training.config import TrainConfig
from reconstruction.training.methods.shaders import empty_shader
from reconstruction.training.model.joint_model import OF_SPLATS, SceneModel
from reconstruction.training.photos.exposures import Exposures
from reconstruction.training.photos.poses import Move

Vec3 = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class PanelRecord:
    """A panel of the site.

    Parameters
    ----------
    source_id
        Of the object that it was imported from, as `planning.site.records.Panel` has it.
    """

    id: str
    facade: str
    corners_enu_m: tuple[Vec3, Vec3, Vec3, Vec3]
    source_id: str | None = None


@dataclass(frozen=True, slots=True)
class OriginRecord:
    """Of the site's ENU frame, WGS 84."""

    lat_deg: float
    lon_deg: float
    ellipsoid_height_m: float


@dataclass(frozen=True, slots=True)
class SiteRecord:
    """Which site was photographed."""

    name: str
    origin: OriginRecord | None
    panels: tuple[PanelRecord, ...]

    @property
    def planes(self) -> PanelPlanes:
        """Of the panels."""
        return PanelPlanes(np.array([panel.corners_enu_m for panel in self.panels], float).reshape(-1, 4, 3))


@dataclass(frozen=True, slots=True)
class LightRecord:
    """The model of mirrored light.

    Parameters
    ----------
    name
        `mlp`, `environment-map` or `radiance-grid`.
    precision
        Of its matrix products.
    box, far_side
        Of a radiance grid.
    """

    name: str
    learned: GlassLearned
    precision: Precision = "float32"
    box: GridBox | None = None
    far_side: int = 0


@dataclass(frozen=True, slots=True)
class ModelRecord:
    """A model.

    Parameters
    ----------
    light
        None where all light is the splats' own.
    origin_enu_m
        Of the model's frame.
    corner_square
        See `SceneModel`.
    exposure
        Factor from the scene's light to the photos' linear values, where the data set told one.
    learned, held_out
        Names of the photos learned from, in the order of their gains, and of those kept for scoring.
    extent_m
        Size of the scene.
    decisions
        About effects, with their reasons.
    moves
        Corrections of the poses of `learned`; none where they were not learned.
    places_enu_m
        Where `learned` were taken, with corrections; models of before do not know.
    forwards_enu
        Unit vectors in which they look; models of before do not know.
    """

    config: TrainConfig
    light: LightRecord | None
    site: SiteRecord
    origin_enu_m: Vec3
    corner_square: float
    exposure: float
    learned: tuple[str, ...]
    held_out: tuple[str, ...]
    extent_m: float
    decisions: tuple[Decision, ...] = ()
    moves: tuple[Move, ...] = ()
    places_enu_m: tuple[Vec3, ...] = ()
    forwards_enu: tuple[Vec3, ...] = ()

    def __post_init__(self) -> None:
        for name in ("corner_square", "exposure", "extent_m"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"{name}: expected more than 0, got {value}")
        if not self.learned:
            raise ValueError("learned: expected at least one photo")
        if self.moves and len(self.moves) != len(self.learned):
            raise ValueError(f"moves: expected one for each of {len(self.learned)} photos, got {len(self.moves)}")


WIDEST, DEEPEST, MOST_ROWS, MOST_VERTICES = 8192, 64, 4096, 1 << 28
"""Of networks, environment maps and grids that are read: larger ones than anybody trains, and memory for none."""


def site_record(folder: Path) -> SiteRecord:
    """Of a data set folder.

    Raises
    ------
    InputError
        Its description is damaged.
    """
    path = folder / "dataset.json"
    content = read_json(path, names_files=True)
    expect_format(content, DATASET_FORMAT, path)
    found = to_record(content, _Description, path)
    panels = tuple(PanelRecord(panel.id, panel.facade, panel.corners_enu_m, panel.source_id) for panel in found.panels)
    return SiteRecord(found.site, found.origin, panels)


@dataclass(frozen=True, slots=True)
class _Panel:
    corners_enu_m: tuple[Vec3, Vec3, Vec3, Vec3]
    id: str = ""
    facade: str = ""
    source_id: str | None = None


@dataclass(frozen=True, slots=True)
class _Description:
    panels: tuple[_Panel, ...]
    site: str = ""
    origin: OriginRecord | None = None


def light_record(model: SceneModel, name: str) -> LightRecord | None:
    """Of a model's mirrored light."""
    if model.light is None:
        return None
    learned, light = model.light.learned, model.light.light
    if isinstance(light, RadianceGrid):
        return LightRecord(name, learned, model.precision, light.box, light.far_side)
    return LightRecord(name, learned, model.precision)


def empty_model(record: ModelRecord, tensors: Mapping[str, Tensor]) -> tuple[SceneModel, Exposures]:
    """A model of the shape that a record tells, and gains of its photos; for weights to be put in.

    Parameters
    ----------
    tensors
        The weights that will be put in, by which sizes are checked before memory is asked for.

    Raises
    ------
    ValueError
        Record and weights do not belong together.
    """
    values = {
        name.removeprefix(OF_SPLATS): torch.zeros_like(value)
        for name, value in tensors.items()
        if name.startswith(OF_SPLATS) and name != f"{OF_SPLATS}panels"
    }
    splats = Splats(values, torch.full((len(values["means"]),), -1))
    planes = record.site.planes
    light, precision = None, record.light.precision if record.light is not None else "float32"
    if record.light is not None:
        light = GlassLight(
            _light_model(record, tensors), planes, record.light.learned, len(tensors.get("light.moves", ()))
        )
    origin = np.array(record.origin_enu_m)
    shader = empty_shader(record.config, tensors) if light is None else None
    model = SceneModel(
        splats, Sky(), light, planes, origin, record.corner_square, record.config.geometry, precision, shader
    )
    return model, Exposures(np.ones((len(record.learned), 3 if record.config.own_exposures == "on" else 1)))


def _light_model(record: ModelRecord, tensors: Mapping[str, Tensor]) -> LightModel:
    assert record.light is not None
    settings, box = record.config.reflections, record.light.box
    if record.light.name == "mlp":
        if settings.mlp.width > WIDEST or settings.mlp.layers > DEEPEST:
            raise ValueError(f"mlp: expected at most {DEEPEST} layers of {WIDEST} units")
        return ReflectionMlp(settings.mlp, 0.5, torch.Generator().manual_seed(0))
    if record.light.name == "environment-map":
        if settings.environment_rows > MOST_ROWS:
            raise ValueError(f"environment_rows: expected at most {MOST_ROWS}")
        return EnvironmentMap(settings.environment_rows, 0.5)
    if record.light.name == "radiance-grid" and box is not None:
        cells = tensors.get("light.light.cells")
        if cells is None or tuple(cells.shape) != (*reversed(box.counts), 4) or cells.numel() > MOST_VERTICES:
            raise ValueError("box: expected that of the grid in the weights")
        if not 4 <= record.light.far_side <= MOST_ROWS:
            raise ValueError(f"far_side: expected 4 to {MOST_ROWS}, got {record.light.far_side}")
        return RadianceGrid(box, 0.5, 0, record.light.far_side)
    raise ValueError(f"light: expected mlp, environment-map or radiance-grid, got '{record.light.name}'")
