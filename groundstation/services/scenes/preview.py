"""Use case of planning: the photo that a viewpoint will take, rendered, with all that panes will mirror there.

A scene takes a second to build, so the process that renders keeps the one it rendered last: it is asked by the key of
the site alone first (`cached_photo`), and gets the site itself where it has another scene, or none (`site_photo`).
"""

from __future__ import annotations

import hashlib
import math
import time
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Decision, EffectSetting, decide
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, Trace, never
from planning.geo.mesh import join
from planning.geo.solids import Solids
from planning.plan import Camera, Viewpoint
from planning.site.file import site_sha256
from planning.site.records import SiteModel
from reconstruction.scenes.parameters import EXPOSURE, GIMBAL_ERROR, POSITION_ERROR, SKY_OCCLUSION
from reconstruction.scenes.world.look import Look

if TYPE_CHECKING:
    from reconstruction.base.cameras import PosedPhoto
    from reconstruction.scenes.photos.renderer import RenderedPhoto, Renderer

QUICK_S = 0.35
"""What a quick picture may take; half a second passes until it is seen."""

QUICK_WIDTHS_PX = (160, 480)
"""Narrower pictures show no pane, wider ones are as good as fine."""

FIRST_WIDTH_PX = 256
"""Before the first picture nobody knows how fast the machine is."""

LEAST_WIDTH_PX, MAX_WIDTH_PX = 32, 1280
"""Of fine pictures. While one is rendered it takes 140 MB."""

STRIP_PX = 1 << 17
"""Pixels rendered between two looks at whether somebody cancelled: 0.2 s."""

OF_FILES = frozenset({EXPOSURE, POSITION_ERROR, GIMBAL_ERROR})
"""Effects that change what one photo's file says, or one photo against another, and not what this one shows."""

LEFT_OUT: Mapping[str, EffectSetting] = {SKY_OCCLUSION: "off"}
"""What previews do without: 3 to 9 grey levels, mostly on walls and ground, for 1 to 10 s of a core wherever a part of
a scene is first seen."""

EXTRA_ROWS = 1
"""Beyond a strip, whose pixels are compared with their neighbours."""


@dataclass(frozen=True, slots=True)
class PhotoRequest:
    """A photo that somebody wants to see.

    Parameters
    ----------
    site_key
        As `site_key` gives it.
    look, seed
        Of the scene that is built from the site.
    view, camera
        Where it is taken and by what.
    width_px
        Of the picture, in the shape of the camera's.
    is_quick
        All effects but those `LEFT_OUT`, without asking the scene which it calls for: that takes longer than a small
        picture.
    """

    site_key: str
    look: Look
    seed: int
    view: Viewpoint
    camera: Camera
    width_px: int
    is_quick: bool = False

    @property
    def scene_key(self) -> tuple[str, Look, int]:
        """What the scene depends on."""
        return self.site_key, self.look, self.seed


@dataclass(frozen=True, slots=True, eq=False)
class PreviewPhoto:
    """A rendered photo.

    Parameters
    ----------
    picture
        Blue, green, red, shape (h, w, 3).
    panels
        Numbers of the panels that it shows, ascending, shape (k,).
    decisions
        Effects but those `OF_FILES` and those `LEFT_OUT`, and why they are on or off; none in a quick picture.
    is_walled_in
        Whether the camera stands inside something that the scene adds to the site or the site has as an obstacle.
    seconds
        Of rendering, without what was prepared for it.
    """

    request: PhotoRequest
    picture: NDArray[np.uint8]
    panels: NDArray[np.int64]
    decisions: tuple[Decision, ...]
    is_walled_in: bool
    seconds: float


def site_key(model: SiteModel) -> str:
    """Checksum of a site with its meshes, hexadecimal: one file name can have had several contents."""
    digest = hashlib.sha256(site_sha256(model.site).encode())
    for mesh in (model.building, *model.obstacles):
        digest.update(np.ascontiguousarray(mesh.vertices_enu_m).data)
        digest.update(np.ascontiguousarray(mesh.triangles).data)
    return digest.hexdigest()


def quick_width_px(fine_width_px: int, seconds_per_px: float | None) -> int:
    """Width of a picture that takes `QUICK_S`, where one pixel takes `seconds_per_px` (None: not known yet)."""
    low, high = QUICK_WIDTHS_PX
    # Pictures are about 4 : 3.
    width = FIRST_WIDTH_PX if seconds_per_px is None else math.sqrt(QUICK_S / seconds_per_px * 4.0 / 3.0)
    return min(int(min(max(width, low), high)), fine_width_px)


def cached_photo(
    request: PhotoRequest, *, stop: Stop = never, trace: Trace | None = None, monitor: Monitor = QUIET
) -> PreviewPhoto | None:
    """The photo, if this process still has its scene; None if not."""
    preview_scene = next((kept for kept in _LAST if kept.key == request.scene_key), None)
    return None if preview_scene is None else preview_scene.photo(request, monitor)


def site_photo(
    model: SiteModel, request: PhotoRequest, *, stop: Stop = never, trace: Trace | None = None, monitor: Monitor = QUIET
) -> PreviewPhoto:
    """The photo; its scene is kept in place of the last one.

    Raises
    ------
    InputError
        The site has no panels, or more than a photo can number.
    """
    monitor.report(say("building the scene"), 0, 1)
    _LAST.clear()
    _LAST.append(_PreviewScene(model, request))
    return _LAST[0].photo(request, monitor)


class _PreviewScene:
    """A scene, with renderers for quick and for fine pictures. What renders takes a second to import."""

    def __init__(self, model: SiteModel, request: PhotoRequest) -> None:
        from reconstruction.scenes.parameters import RenderSettings
        from reconstruction.scenes.photos.renderer import Renderer
        from reconstruction.scenes.world.build import build_scene

        self.key = request.scene_key
        self._scene = build_scene(model, request.look, request.seed)
        self._solids = Solids.of(join(list(self._scene.site.obstacles)).corners_enu_m)
        self._quick = Renderer(self._scene, RenderSettings(effects=LEFT_OUT))
        self._fine: tuple[frozenset[str], Renderer] | None = None
        """With the effects that it simulates."""

    def photo(self, request: PhotoRequest, monitor: Monitor) -> PreviewPhoto:
        from reconstruction.base.cameras import Pose, PosedPhoto
        from reconstruction.scenes.photos.flight_views import lens_of
        from reconstruction.scenes.photos.lens_effects import developed

        lens = lens_of(request.camera, request.width_px)
        photo = PosedPhoto(request.view.id, Path(request.view.id), lens, Pose.of(request.view), None)
        renderer, decisions = (self._quick, ()) if request.is_quick else self._decided(photo, monitor)
        started_s = time.perf_counter()
        rendered = _rendered_in_strips(renderer, photo, monitor)
        picture = developed(rendered)
        seconds = time.perf_counter() - started_s
        seen = np.unique(rendered.panel).astype(np.int64)
        clearance_m = self._solids.clearance_m(np.asarray(photo.pose.position_enu_m)[None])[0]
        return PreviewPhoto(request, picture, seen[seen > 0] - 1, decisions, bool(clearance_m < 0.0), seconds)

    def _decided(self, photo: PosedPhoto, monitor: Monitor) -> tuple[Renderer, tuple[Decision, ...]]:
        """A renderer of what the scene calls for in this photo, and why."""
        from reconstruction.scenes.effects.probe import Probe
        from reconstruction.scenes.effects.registry import EFFECTS
        from reconstruction.scenes.parameters import RenderSettings
        from reconstruction.scenes.photos.renderer import Renderer

        to_decide = [effect for effect in EFFECTS if effect.name not in OF_FILES and effect.name not in LEFT_OUT]
        monitor.report(say("choosing what to simulate"), 0, len(to_decide))
        probe = Probe(self._scene, [photo])
        decisions = [] if self._scene.terrain is None else [self._scene.terrain]
        for done, effect in enumerate(to_decide):
            monitor.report(say("choosing what to simulate"), done, len(to_decide))
            decisions.append(decide(effect, probe))
        chosen = frozenset(found.effect for found in decisions if found.on)
        if self._fine is None or self._fine[0] != chosen:
            self._fine = None  # before the next one is made: each holds the scene's geometry
            self._fine = chosen, Renderer(self._scene, RenderSettings(effects=LEFT_OUT).decided(decisions))
        return self._fine[1], tuple(decisions)


_LAST: list[_PreviewScene] = []
"""The studio of the last photo, at most one."""


def _rendered_in_strips(renderer: Renderer, photo: PosedPhoto, monitor: Monitor) -> RenderedPhoto:
    """A photograph, rendered strip by strip so that it can be cancelled; the same as in one piece."""
    height, width = photo.intrinsics.height_px, photo.intrinsics.width_px
    rows = max(1, STRIP_PX // width)
    strips = []
    for top in range(0, height, rows):
        monitor.report(say("rendering the photo"), top, height)
        strips.append(_strip(renderer, photo, top, min(top + rows, height)))
    layers: dict[str, Any] = {name: np.concatenate([getattr(s, name) for s in strips]) for name in _layers(strips[0])}
    return replace(strips[0], **layers)


def _strip(renderer: Renderer, photo: PosedPhoto, top: int, bottom: int) -> RenderedPhoto:
    """Rows of a photograph."""
    lens = photo.intrinsics
    first, last = max(top - EXTRA_ROWS, 0), min(bottom + EXTRA_ROWS, lens.height_px)
    part = replace(lens, height_px=last - first, cy_px=lens.cy_px - first)
    rendered = renderer.render(replace(photo, intrinsics=part))
    rows = slice(top - first, bottom - first)
    layers: dict[str, Any] = {name: getattr(rendered, name)[rows] for name in _layers(rendered)}
    return replace(rendered, **layers)


def _layers(rendered: RenderedPhoto) -> tuple[str, ...]:
    """Names of what has a value for each pixel."""
    return tuple(field.name for field in fields(rendered) if isinstance(getattr(rendered, field.name), np.ndarray))
