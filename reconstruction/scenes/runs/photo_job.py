"""Photos of a scene that are to be rendered, and what renders one of them in whatever process."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from planning.base.json_file import write_atomically
from reconstruction.base.cameras import PosedPhoto
from reconstruction.dataset.refined_mesh import grown_corners
from reconstruction.photos.write import Circumstances, photo_jpeg
from reconstruction.scenes.mitsuba.renderer import renderer_of
from reconstruction.scenes.parameters import DEFAULT_POINTS, DEPTH_OF_FIELD, RenderSettings
from reconstruction.scenes.photos.camera_model import USUAL_CAMERA_MODEL, CameraModel, Capture, Moment
from reconstruction.scenes.photos.lens_effects import developed
from reconstruction.scenes.photos.photo_layers import facade_mask, layer_contents, layer_file
from reconstruction.scenes.photos.renderer import RenderedPhoto
from reconstruction.scenes.photos.thin_lens import out_of_focus
from reconstruction.scenes.record import Scene

PATIENCE_S = 0.5
"""How often it is asked whether the user cancelled."""


@dataclass(frozen=True, slots=True, eq=False)
class PhotoJob:
    """Photos of a scene that are to be taken.

    Parameters
    ----------
    photos
        Where the cameras really are; each `path` is in the folder's `images`.
    made_from
        What else to tell about where scene and views are from, as plain JSON values; a run that is gone on with must
        be made from the same.
    companions
        Content of other files that belong into the folder, by their names.
    n_points
        On the building and what is near, that reconstruction starts from.
    camera_model, moments
        How photos are taken, and how each came about; without moments, all are taken hovering, in one sortie.
    captures
        Of each photo, once effects are decided; without, it is taken hovering and tells its true pose.
    """

    scene: Scene
    photos: tuple[PosedPhoto, ...]
    settings: RenderSettings
    made_from: Mapping[str, Any]
    companions: Mapping[str, bytes] = field(default_factory=dict)
    n_points: int = DEFAULT_POINTS
    camera_model: CameraModel = USUAL_CAMERA_MODEL
    moments: tuple[Moment, ...] = ()
    captures: tuple[Capture, ...] = ()

    def __post_init__(self) -> None:
        for name in ("moments", "captures"):
            n = len(getattr(self, name))
            if n not in (0, len(self.photos)):
                raise ValueError(f"{name}: expected one for each of {len(self.photos)} photos, or none, got {n}")


class RenderWorker:
    """Takes photos of a scene; made once in each process."""

    def __init__(self, job: PhotoJob, folder: Path, exposure: float) -> None:
        self._job, self._folder, self._exposure = job, folder, exposure
        self._renderer = renderer_of(job.scene, job.settings)
        self._grown = grown_corners(job.scene.site.site.facades)
        self._moments = job.moments or (Moment(),) * len(job.photos)
        self._captures = job.captures or tuple(map(Capture.still, job.photos))

    def render(self, number: int) -> dict[str, bytes]:
        """Render a photo; returns the content of its files by path in the folder."""
        job, photo, capture = self._job, self._job.photos[number], self._captures[number]
        seed = int(np.random.SeedSequence([job.scene.seed, number]).generate_state(1)[0])
        rendered = self._taken(photo, seed, capture)
        site = job.scene.site.site
        assert photo.taken_at is not None
        picture = developed(rendered, self._exposure * capture.exposure, job.camera_model.sensor)
        reported, position = replace(photo, pose=capture.reported), job.camera_model.position
        how = Circumstances(
            position.fix == "rtk", position.total_m, capture.exposure_s, self._moments[number].velocity_enu_m_s
        )
        home_up_m = site.home_enu_m[2] + capture.reported_higher_m
        jpeg = photo_jpeg(picture, reported, site.origin, photo.taken_at, home_up_m, how)
        contents = {photo.path: jpeg}
        mask = facade_mask(photo, self._grown, rendered.depth_m)
        for layer, content in layer_contents(rendered, mask).items():
            contents[layer_file(self._folder, layer, photo.name)] = content
        return {path.relative_to(self._folder).as_posix(): content for path, content in contents.items()}

    def _taken(self, photo: PosedPhoto, seed: int, capture: Capture) -> RenderedPhoto:
        """Light on the sensor: by a lens where that is out of focus somewhere, else by a pinhole."""

        def pinhole(one: PosedPhoto) -> RenderedPhoto:
            return self._renderer.render(one, seed, capture.moved_enu_m)

        lens = self._job.camera_model.lens
        if lens is None or not self._job.settings.is_on(DEPTH_OF_FIELD):
            return pinhole(photo)
        return out_of_focus(photo, lens, pinhole)


def checksums_of(folder: Path, contents: Mapping[str, bytes]) -> dict[str, str]:
    """Checksums of a photo's files by path in the folder, where they are now."""
    for path, content in contents.items():
        write_atomically(folder / path, content)
    return {path: hashlib.sha256(content).hexdigest() for path, content in contents.items()}
