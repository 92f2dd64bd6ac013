"""Photographs of a scene by ray casting, with what is true of each pixel.

One ray is sent through the middle of each pixel. Where a pixel differs from its neighbours its light is the mean over
several rays through its area instead, and over the exposure where the camera moves; what is true of it stays that of
its middle, at the middle of the exposure.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.jit import chunks, run_chunks
from planning.base.messages import say
from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.light.tracing import Light, Switches, Tracer
from reconstruction.scenes.parameters import (
    CURVATURE,
    DISTORTION,
    DOUBLING,
    FRESNEL,
    INTERIOR,
    MOTION_BLUR,
    NEAR_FIELD,
    NOISE,
    OCCLUSION,
    SECOND_BOUNCE,
    SHADOW,
    SKY_OCCLUSION,
    SUN_GLARE,
    TILT,
    VIGNETTING,
    RenderSettings,
)
from reconstruction.scenes.photos.motion_blur import moved_px, n_times, times, varies, windows
from reconstruction.scenes.record import Scene

Array = NDArray[np.float64]
Picture = NDArray[np.float32]

FINE = 3
"""Rays along each side of a pixel that needs several."""

DETAIL = 0.04
"""Difference to a neighbour, of the light's square root, above which a pixel needs several rays: 10 grey levels."""

RAYS_AT_ONCE = 1 << 15

MOST_PANES = np.iinfo(np.uint16).max - 1


def switches_of(settings: RenderSettings) -> Switches:
    """Of the effects of light."""
    first = (NEAR_FIELD, FRESNEL, SECOND_BOUNCE, TILT, DOUBLING, SHADOW)
    return Switches(*map(settings.is_on, (*first, CURVATURE, INTERIOR, SUN_GLARE, OCCLUSION, SKY_OCCLUSION)))


@dataclass(frozen=True, slots=True, eq=False)
class RenderedPhoto:
    """Light that reaches the lens, and what is true of each pixel's middle. Sizes (h, w) and (h, w, 3).

    Parameters
    ----------
    linear
        Linear red, green, blue: `diffuse` plus `reflection`.
    diffuse, reflection
        The picture without mirror images, and their light alone.
    depth_m
        Along the optical axis; inf for sky.
    normal_enu
        Unit, towards the camera, with tilt and bow of panes where they are simulated; 0 for sky.
    panel
        1 + number of the panel, 0 for none.
    in_camera
        Effects that it gets when it is developed: `SUN_GLARE`, `VIGNETTING`, `NOISE`.
    seed
        Of the noise.
    """

    linear: Picture
    diffuse: Picture
    reflection: Picture
    depth_m: Picture
    normal_enu: Picture
    panel: NDArray[np.uint16]
    is_glass: NDArray[np.bool_]
    in_camera: frozenset[str] = frozenset()
    seed: int = 0


class Renderer:
    """A scene that is photographed; effects that `settings` leave open are simulated.

    Raises
    ------
    InputError
        The scene has more panes than a photograph can number.
    """

    def __init__(self, scene: Scene, settings: RenderSettings) -> None:
        n_panes = len(scene.panes.corners_enu_m)
        if n_panes > MOST_PANES:
            raise InputError(
                say("expected at most {} panels, got {}; render it in parts", MOST_PANES, n_panes, place=scene.name)
            )
        self._settings = settings
        self._tracer = Tracer(scene, switches_of(settings), environment_rows=settings.environment_rows)

    def render(self, photo: PosedPhoto, seed: int = 0, moved_enu_m: Array | None = None) -> RenderedPhoto:
        """Take a photograph; the same for any number of threads.

        Parameters
        ----------
        seed
            Of the noise that the photograph gets when it is developed.
        moved_enu_m
            How far the camera moves while its shutter is open, shape (3,); its pose is that of the middle.
        """
        if not self._settings.is_on(DISTORTION):
            photo = replace(photo, intrinsics=photo.intrinsics.straight())
        middles = self._middles(photo)
        samples = self._settings.samples
        if moved_enu_m is not None and np.any(moved_enu_m) and self._settings.is_on(MOTION_BLUR):
            self._blur(photo, middles, moved_enu_m)
        elif samples == "auto":
            rough = np.flatnonzero(_needs_detail(middles.linear, middles.panel))
            self._refine(photo, middles, rough, FINE)
        elif samples > 1:
            everywhere = np.arange(middles.panel.size)
            self._refine(photo, middles, everywhere, samples)
        in_camera = frozenset(filter(self._settings.is_on, (SUN_GLARE, VIGNETTING, NOISE)))
        return replace(middles, in_camera=in_camera, seed=seed)

    def _middles(self, photo: PosedPhoto) -> RenderedPhoto:
        """With one ray through the middle of each pixel."""
        height, width = photo.intrinsics.height_px, photo.intrinsics.width_px
        rendered = _blank(height, width)
        colours = (rendered.linear, rendered.diffuse, rendered.reflection, rendered.normal_enu)
        linear, diffuse, reflection, normal = (a.reshape(-1, 3) for a in colours)
        depth, panel, glass = rendered.depth_m.reshape(-1), rendered.panel.reshape(-1), rendered.is_glass.reshape(-1)

        def work(start: int, stop: int) -> None:
            pixel = np.arange(start, stop)
            places: Array = np.stack([pixel % width, pixel // width], axis=1) + np.float64(0.5)
            light, forward = self._light(photo, places, 1)
            diffuse[start:stop], reflection[start:stop] = light.diffuse, light.reflection
            linear[start:stop] = diffuse[start:stop] + reflection[start:stop]
            normal[start:stop] = light.normals_enu
            depth[start:stop] = light.hits.distance_m * forward
            panel[start:stop] = light.hits.panes + 1
            glass[start:stop] = light.hits.panes >= 0

        run_chunks(work, chunks(height * width, RAYS_AT_ONCE))
        return rendered

    def _blur(self, photo: PosedPhoto, rendered: RenderedPhoto, moved_enu_m: Array) -> None:
        """Put the mean over area and exposure into all pixels over which detail passes."""
        way = moved_px(photo, moved_enu_m, rendered.depth_m)
        window = windows(*way)
        samples, n = self._settings.samples, n_times(*way, window)
        rough = (
            varies(rendered.linear, rendered.panel, window, DETAIL) if samples == "auto" else np.ones(n.shape, np.bool_)
        )
        for count in np.unique(n).tolist():
            pixels = np.flatnonzero(rough & (n == count))
            self._refine(photo, rendered, pixels, FINE if samples == "auto" else samples, moved_enu_m, count)

    def _refine(
        self,
        photo: PosedPhoto,
        rendered: RenderedPhoto,
        pixels: NDArray[np.int64],
        side: int,
        moved_enu_m: Array | None = None,
        n_moments: int = 1,
    ) -> None:
        """Put the mean over `side` x `side` rays, evenly over the pixel's area, into pixels, shape (n,).

        Rays at random places within those parts scored 2 to 7 dB less against the area's average. Of a camera that
        moves, each part's rays are sent at so many moments.
        """
        width = photo.intrinsics.width_px
        linear, diffuse, reflection = (
            a.reshape(-1, 3) for a in (rendered.linear, rendered.diffuse, rendered.reflection)
        )
        parts = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(1, -1, 2)
        shifts = None
        if moved_enu_m is not None:
            parts = np.repeat(parts, n_moments, axis=1)
            shifts = times(side, n_moments).reshape(-1, 1) * moved_enu_m

        def work(start: int, stop: int) -> None:
            chosen = pixels[start:stop]
            corners: Array = np.stack([chosen % width, chosen // width], axis=1).astype(np.float64)
            places = np.asarray(corners[:, None] + (parts + 0.5) / side, np.float64)
            moved = None if shifts is None else np.tile(shifts, (len(chosen), 1))
            light, _ = self._light(photo, places.reshape(-1, 2), side, moved)
            diffuse[chosen] = light.diffuse.reshape(len(chosen), -1, 3).mean(axis=1)
            reflection[chosen] = light.reflection.reshape(len(chosen), -1, 3).mean(axis=1)
            linear[chosen] = diffuse[chosen] + reflection[chosen]

        run_chunks(work, chunks(len(pixels), max(1, RAYS_AT_ONCE // parts.shape[1])))

    def _light(
        self, photo: PosedPhoto, places_px: Array, side: int, moved_enu_m: Array | None = None
    ) -> tuple[Light, Array]:
        """Light at places in the picture, shape (n, 2), and the rays' cosines with the optical axis, shape (n,).

        `moved_enu_m`, shape (n, 3), is how far the camera is from its pose.
        """
        origins, directions = photo.rays(places_px)
        if moved_enu_m is not None:
            origins = origins + moved_enu_m
        beam_rad = 1.0 / (side * math.sqrt(photo.intrinsics.fx_px * photo.intrinsics.fy_px))
        return self._tracer.trace(origins, directions, beam_rad), directions @ photo.pose.forward_enu


def _blank(height: int, width: int) -> RenderedPhoto:
    colour = [np.zeros((height, width, 3), np.float32) for _ in range(4)]
    depth = np.full((height, width), np.inf, np.float32)
    panel, glass = np.zeros((height, width), np.uint16), np.zeros((height, width), np.bool_)
    return RenderedPhoto(colour[0], colour[1], colour[2], depth, colour[3], panel, glass)


def _needs_detail(linear: Picture, panel: NDArray[np.uint16]) -> NDArray[np.bool_]:
    """Pixels that show another panel than a neighbour or differ from it in light, shape (h, w)."""
    eye = np.sqrt(linear)
    needs = np.zeros(panel.shape, np.bool_)
    for axis in (0, 1):
        differs = (np.abs(np.diff(eye, axis=axis)) > DETAIL).any(axis=2) | (np.diff(panel, axis=axis) != 0)
        before = [slice(None), slice(None)]
        after = [slice(None), slice(None)]
        before[axis], after[axis] = slice(None, -1), slice(1, None)
        needs[tuple(before)] |= differs
        needs[tuple(after)] |= differs
    return needs
