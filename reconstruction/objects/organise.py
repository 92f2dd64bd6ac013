"""A trained model as objects, and objects as a trained model: nothing is lost on either way (paper 3.4)."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from planning.base.errors import InputError
from planning.base.messages import say
from planning.geo.frames import Origin, Vec3
from reconstruction.objects.gs_scene import GsAuxiliary, GsComponent, GsElement, GsGaussian, GsScene
from reconstruction.records.entries import global_id_of, is_global_id
from reconstruction.splats.panel_of_splats import panels_by_place
from reconstruction.splats.splats import NO_PANEL
from reconstruction.training.model.joint_model import OF_SPLATS
from reconstruction.training.model.record import ModelRecord, PanelRecord
from reconstruction.training.model.saved import GAINS, TrainedModel, description_of, tensors_of, trained_of

BACKGROUND = "background"

NO_SITE, NO_FACADE = "site", "facade"
"""Names of those that have none."""

PANELS = "panels"
"""Of what splats have: which panel; told by the elements."""

OF_AUXILIARY = {"light.": "reflection", "sky.": "sky", "shader.": "shading", "corner_loss": "camera", GAINS: "camera"}
"""Beginnings of weights' names, and the part that has them."""


@dataclass(frozen=True, slots=True)
class PanelGlobalIds:
    """GlobalIds of what a site has: those of the building model, else ones that follow from the names.

    The same as `reconstruction.records.objects.site_objects` gives a site that has no model yet.

    Parameters
    ----------
    source_ids
        By panel, in the place of the site's own: of a site file that was imported after the photos were taken.
    """

    site: str
    source_ids: Mapping[str, str]

    @classmethod
    def of(cls, record: ModelRecord, source_ids: Mapping[str, str] | None = None) -> PanelGlobalIds:
        """Of a model's site; a GlobalId that several panels have is nobody's."""
        own = {panel.id: panel.source_id for panel in record.site.panels if panel.source_id is not None}
        found = own if source_ids is None else dict(source_ids)
        found_ids = list(found.values())
        usable = {name: each for name, each in found.items() if is_global_id(each) and found_ids.count(each) == 1}
        return cls(record.site.name, usable)

    def panel(self, name: str) -> str:
        """Of a panel."""
        return self.source_ids.get(name) or global_id_of(self.site, f"panel {name}")

    def component(self, name: str) -> str:
        """Of a facade, or the background."""
        return global_id_of(self.site, f"component {name}")

    def scene(self) -> str:
        """Of the whole."""
        return global_id_of(self.site, "scene")


def organised(trained: TrainedModel, source_ids: Mapping[str, str] | None = None) -> GsScene:
    """A model as objects: a component for each facade, an element for each panel, and the background.

    Where its method knows no panels, splats belong to those on which they lie.

    Parameters
    ----------
    source_ids
        GlobalIds of the building model by panel, in the place of those that the model's site tells.
    """
    record, tensors = _named(trained.record), tensors_of(trained)
    splats = {name.removeprefix(OF_SPLATS): _plain(tensors[name]) for name in tensors if name.startswith(OF_SPLATS)}
    panels = splats.pop(PANELS)
    if not record.config.trained_by.knows_panels:
        corners_m = np.array([panel.corners_enu_m for panel in record.site.panels]).reshape(-1, 4, 3)
        panels = panels_by_place(splats["means"], corners_m - np.array(record.origin_enu_m))
    ids = PanelGlobalIds.of(record, source_ids)
    rows = np.argsort(panels, kind="stable").astype(np.int32)
    ends = np.searchsorted(panels[rows], np.arange(len(record.site.panels) + 1))
    rows_of = [rows[ends[number] : ends[number + 1]] for number in range(len(record.site.panels))]
    facades: dict[str, list[int]] = {}
    for number, panel in enumerate(record.site.panels):
        facades.setdefault(panel.facade, []).append(number)
    components = [_facade(name, numbers, record.site.panels, rows_of, splats, ids) for name, numbers in facades.items()]
    rest = rows[: ends[0]]
    background = GsComponent(ids.component(BACKGROUND), BACKGROUND, "background", (), _chosen(splats, rest))
    # As JSON has it, so that a scene that was written and read is the same.
    training = json.loads(json.dumps(description_of(trained), allow_nan=False))
    return GsScene(
        ids.scene(),
        record.site.name,
        None if record.site.origin is None else Origin(**_fields(record.site.origin)),
        record.origin_enu_m,
        (*components, background),
        _auxiliary(tensors),
        training,
        len(panels),
    )


def put_together(scene: GsScene, path: Path) -> TrainedModel:
    """The model that a whole scene was made from, the same bits.

    Parameters
    ----------
    path
        Where the scene is from, for messages.

    Raises
    ------
    ValueError
        Components are missing.
    InputError
        Parts do not belong together.
    """
    if not scene.is_whole:
        raise ValueError("scene: expected all of its components")
    tables = [component.gaussians for component in scene.components]
    places = np.concatenate([table.places for table in tables])
    if not np.array_equal(np.sort(places), np.arange(len(places))):
        raise InputError(say("its Gaussians do not each have a place of their own; it is damaged", place=path))
    tensors: dict[str, Tensor] = {}
    for name in tables[0].values:
        values = np.concatenate([table.values[name] for table in tables])
        back = np.empty_like(values)
        back[places] = values
        tensors[f"{OF_SPLATS}{name}"] = torch.from_numpy(back)
    panels = np.empty(len(places), np.int32)
    panels[places] = np.concatenate([_panels(component) for component in scene.components])
    tensors[f"{OF_SPLATS}{PANELS}"] = torch.from_numpy(panels)
    for part in scene.auxiliary:
        # Reading gives arrays that nobody may write to, and weights are written to.
        tensors |= {name: torch.from_numpy(value.copy()) for name, value in part.tensors.items()}
    trained = trained_of(scene.training, tensors, path)
    if not trained.record.config.trained_by.knows_panels:
        trained.model.splats.panels.fill_(NO_PANEL)
    return trained


def _named(record: ModelRecord) -> ModelRecord:
    """With names for all: data sets of other programs may lack them, or have one twice."""
    used: set[str] = set()
    panels = []
    for number, panel in enumerate(record.site.panels, 1):
        name = panel.id or f"panel {number}"
        while name in used:
            name = f"{name} ({number})"
        used.add(name)
        facade = panel.facade or NO_FACADE
        panels.append(replace(panel, id=name, facade=f"{facade} (facade)" if facade == BACKGROUND else facade))
    return replace(record, site=replace(record.site, name=record.site.name or NO_SITE, panels=tuple(panels)))


def _facade(
    name: str,
    numbers: Sequence[int],
    panels: Sequence[PanelRecord],
    rows_of: Sequence[np.ndarray[Any, np.dtype[np.int32]]],
    splats: Mapping[str, np.ndarray[Any, Any]],
    ids: PanelGlobalIds,
) -> GsComponent:
    elements, start = [], 0
    for number in numbers:
        panel, stop = panels[number], start + len(rows_of[number])
        corners: tuple[Vec3, Vec3, Vec3, Vec3] = panel.corners_enu_m
        elements.append(GsElement(ids.panel(panel.id), panel.id, number, corners, start, stop))
        start = stop
    rows = np.concatenate([rows_of[number] for number in numbers])
    return GsComponent(ids.component(name), name, "facade", tuple(elements), _chosen(splats, rows))


def _chosen(splats: Mapping[str, np.ndarray[Any, Any]], rows: np.ndarray[Any, np.dtype[np.int32]]) -> GsGaussian:
    return GsGaussian({name: value[rows] for name, value in splats.items()}, rows)


def _panels(component: GsComponent) -> np.ndarray[Any, np.dtype[np.int32]]:
    found = np.full(len(component.gaussians), NO_PANEL, np.int32)
    for element in component.elements:
        found[element.start : element.stop] = element.panel
    return found


def _auxiliary(tensors: Mapping[str, Tensor]) -> tuple[GsAuxiliary, ...]:
    parts: dict[str, dict[str, np.ndarray[Any, Any]]] = {}
    for name, value in tensors.items():
        if not name.startswith(OF_SPLATS):
            part = next(part for beginning, part in OF_AUXILIARY.items() if name.startswith(beginning))
            parts.setdefault(part, {})[name] = _plain(value)
    return tuple(GsAuxiliary(name, found) for name, found in parts.items())


def _plain(value: Tensor) -> np.ndarray[Any, Any]:
    return np.asarray(value.numpy())


def _fields(record: Any) -> dict[str, float]:
    return {name: getattr(record, name) for name in ("lat_deg", "lon_deg", "ellipsoid_height_m")}
