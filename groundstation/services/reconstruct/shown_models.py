"""Models that are looked at: read, kept, cut by a plane, coloured by panel, and asked what is where.

Only the process of models (`reconstruct_process`) uses this: it needs torch.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from groundstation.services.reconstruct.messages import Look, Probe, Probed, Section

if TYPE_CHECKING:
    from reconstruction.base.cameras import PosedPhoto
    from reconstruction.light.photo_set import PhotoSet
    from reconstruction.objects.picking import Quads
    from reconstruction.splats.merged_splats import SplatsOfDetail
    from reconstruction.splats.rasterising.raster_types import RasterSettings
    from reconstruction.splats.rasterising.views import View
    from reconstruction.splats.splats import Splats
    from reconstruction.training.model.joint_model import SceneModel
    from reconstruction.training.model.saved import TrainedModel

MOST_MODELS = 2
"""Finished ones that are kept: the two that are compared."""

LARGE = 150_000
"""Splats of a model whose quick pictures are of fewer: others come in time as they are."""

QUICK_PX = 1.0
"""Side of the cubes whose splats are drawn as one, in a quick picture."""

TINT_SHARE = 0.45
"""Of the colour that says something about a panel, in the picture."""


@dataclass(frozen=True, slots=True, eq=False)
class ShownModel:
    """A model, and what its pictures are made with.

    Parameters
    ----------
    quads
        Its panels; None while it is in training.
    """

    model: SceneModel
    gains: Mapping[str, Any]
    settings: RasterSettings
    version: object
    learned: tuple[str, ...]
    moves: tuple[Any, ...]
    quads: Quads | None = None

    def photos(self, source: PhotoSet) -> tuple[PosedPhoto, ...]:
        """All of a data set, those that were learned from where learning light found them to be."""
        from reconstruction.training.photos.pose_corrections import moved

        if not self.moves:
            return source.photos
        found = {photo.name: photo for photo in moved(source.named(self.learned), self.moves)}
        return tuple(found.get(photo.name, photo) for photo in source.photos)


class ShownModels:
    """Finished ones by folder, be they trained models or scenes of objects; those looked at last are kept."""

    def __init__(self) -> None:
        self._models: OrderedDict[tuple[Path, int], ShownModel] = OrderedDict()
        self._cuts: OrderedDict[SceneModel, tuple[Section, SceneModel]] = OrderedDict()
        self._of_detail: OrderedDict[SceneModel, SplatsOfDetail | None] = OrderedDict()

    def of(self, folder: Path) -> ShownModel:
        """Read, unless it is kept and its file has not changed.

        Raises
        ------
        InputError
            The folder holds no model, or a damaged one.
        """
        path = next((path for path in _descriptions(folder) if path.is_file()), None)
        key = folder, 0 if path is None else path.stat().st_mtime_ns
        if key not in self._models:
            self._models[key] = shown_of(_read(folder))
        self._models.move_to_end(key)
        while len(self._models) > MOST_MODELS:
            self._models.popitem(last=False)
        return self._models[key]

    def cut(self, shown: ShownModel, section: Section | None) -> SceneModel:
        """A model without what lies beyond a plane; the last one of each of two models is kept."""
        model = shown.model
        if section is None:
            return model
        known = self._cuts.get(model)
        if known is None or known[0] != section:
            self._cuts[model] = known = section, model.with_splats(_cut(model.splats, section, model.origin_enu_m))
        self._cuts.move_to_end(model)
        while len(self._cuts) > MOST_MODELS:
            self._cuts.popitem(last=False)
        return known[1]

    def quick(self, shown: ShownModel, section: Section | None, view: View) -> SceneModel:
        """A model for one picture: of a large finished one, splats finer than pixels as one, none out of sight."""
        model = shown.model
        detail = self._detail(model) if _is_large(shown) else None
        if detail is None:
            return self.cut(shown, section)
        splats = detail.for_view(view, QUICK_PX)
        return model.with_splats(splats if section is None else _cut(splats, section, model.origin_enu_m))

    def prepare(self) -> bool:
        """Make a large model ready for quick pictures, which takes seconds; whether there was one."""
        for shown in self._models.values():
            if _is_large(shown) and shown.model not in self._of_detail:
                self._detail(shown.model)
                return True
        return False

    def _detail(self, model: SceneModel) -> SplatsOfDetail | None:
        """None where there is no memory for it."""
        from reconstruction.base.out_of_memory import is_out_of_memory
        from reconstruction.splats.merged_splats import splats_of_detail

        if model not in self._of_detail:
            self._of_detail[model] = None
            try:
                self._of_detail[model] = splats_of_detail(model.splats)
            except (MemoryError, RuntimeError) as error:
                if not is_out_of_memory(error):
                    raise
        self._of_detail.move_to_end(model)
        while len(self._of_detail) > MOST_MODELS:
            self._of_detail.popitem(last=False)
        return self._of_detail[model]


def _is_large(shown: ShownModel) -> bool:
    """Whether its quick pictures are of fewer splats; one in training changes, and a graphics card needs none."""
    return (
        shown.quads is not None and len(shown.model.splats) >= LARGE and shown.model.splats.means.device.type == "cpu"
    )


def _cut(splats: Splats, section: Section, origin_enu_m: NDArray[np.float64]) -> Splats:
    """What a section leaves."""
    along = splats.means.detach()[:, section.axis] + float(origin_enu_m[section.axis])
    return splats.some((along <= section.at_m) if section.is_above else (along >= section.at_m))


def shown_of(trained: TrainedModel) -> ShownModel:
    """A finished model."""
    from reconstruction.objects.picking import Quads

    record = trained.record
    gains = {name: trained.exposures(number) for number, name in enumerate(record.learned)}
    settings = replace(record.config.raster, threads=0)
    quads = Quads.of(record.site.planes.corners_enu_m)
    return ShownModel(trained.model, gains, settings, trained, record.learned, record.moves, quads)


def tinted(picture: NDArray[np.uint8], quads: Quads, look: Look, depth_m: NDArray[np.float32]) -> NDArray[np.uint8]:
    """A picture with panels in colours that say something about them.

    Parameters
    ----------
    depth_m
        Of the picture, by which what stands before a panel keeps its own colour.
    """
    from reconstruction.objects.picking import panel_map

    # The last row is that of no panel: -1.
    colours = np.zeros((len(quads.normals) + 1, 3), np.float32)
    shares = np.zeros((len(quads.normals) + 1, 1), np.float32)
    for panel, colour in look.tints:
        if 0 <= panel < len(quads.normals):
            colours[panel], shares[panel] = colour, TINT_SHARE
    panels = panel_map(quads, look.camera, depth_m)
    if look.section is not None:
        # What a section has taken away has left its panels empty.
        panels[~np.isfinite(depth_m)] = -1
    mixed = picture * (1.0 - shares[panels]) + colours[panels] * shares[panels]
    return np.asarray(np.round(mixed), np.uint8)


def probed(probe: Probe, shown: ShownModel, model: SceneModel) -> Probed:
    """What is at a place in a picture.

    Parameters
    ----------
    model
        Of `shown`, or what a section leaves of it.
    """
    from reconstruction.objects.picking import picked, rays_of
    from reconstruction.splats.rasterising.views import View
    from reconstruction.training.model.render import render_view

    camera, place = probe.camera, np.array([probe.at_px])
    lens, (x, y) = camera.intrinsics, probe.at_px
    column, row = int(min(max(x, 0), lens.width_px - 1)), int(min(max(y, 0), lens.height_px - 1))
    view = View.of(camera, model.origin_enu_m).cropped(column, row, 1, 1)
    depth_m = float(render_view(model, view, ("depth",), 1.0, shown.settings).layers["depth"][0, 0])
    ray, origin = rays_of(camera, place)[0], camera.pose.position_enu_m
    if shown.quads is not None:
        panel = int(picked(shown.quads, camera, place, np.array([depth_m]))[0])
        if panel >= 0 and (probe.section is None or np.isfinite(depth_m)):
            _, distances = shown.quads.met(origin, ray[None])
            return Probed(probe, panel, _point(origin + distances[0] * ray))
    if not np.isfinite(depth_m) or depth_m <= 0.0:
        return Probed(probe, None, None)
    return Probed(probe, None, _point(origin + depth_m / float(ray @ camera.pose.forward_enu) * ray))


def _descriptions(folder: Path) -> tuple[Path, ...]:
    """Files that tell of a model in a folder, as objects or as it was trained."""
    from reconstruction.objects.store import DESCRIPTION as SCENE
    from reconstruction.training.names import MODEL

    return folder / SCENE, folder / MODEL


def _read(folder: Path) -> TrainedModel:
    """The model of a folder of either kind."""
    from reconstruction.objects.organise import put_together
    from reconstruction.objects.store import read_scene
    from reconstruction.training.model.saved import read_model

    scene = _descriptions(folder)[0]
    return put_together(read_scene(folder), scene) if scene.is_file() else read_model(folder)


def _point(at: NDArray[np.float64]) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in at)
    return x, y, z
