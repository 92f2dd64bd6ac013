"""Photographs by Mitsuba's path tracer: the physically based judge of the embedded renderer."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import EffectSetting
from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.effect_names import DISTORTION, INTERIOR, MOTION_BLUR, SUN_GLARE
from reconstruction.scenes.mitsuba.plugins import lens, mitsuba
from reconstruction.scenes.mitsuba.scene import middle_enu_m, mitsuba_scene
from reconstruction.scenes.photos.renderer import Photograph, Renderer, RenderSettings
from reconstruction.scenes.record import Scene

Array = NDArray[np.float64]

RAYS_AT_ONCE = 1 << 23
"""Half a gigabyte."""

LACKING = (INTERIOR, SUN_GLARE)
"""Effects whose light Mitsuba's scene has not: rooms in detail, and the sun's disc with its mirror images."""

SAMPLES = 4
"""Rays along a pixel's side of the embedded pictures that help."""


class MitsubaRenderer:
    """A scene that is photographed like by `Renderer`, with light by Mitsuba.

    What is true of each pixel, and the share of mirror images in its light, is the embedded renderer's. So is the light
    that Mitsuba's scene lacks (`LACKING`): what these effects change in the embedded picture is added.

    Parameters
    ----------
    n_rays
        Through each pixel, at random places of its area.
    variant
        Of Mitsuba; the fastest that works where it is None.

    Raises
    ------
    InputError
        Mitsuba is not installed, or as `Renderer` says.
    """

    def __init__(self, scene: Scene, settings: RenderSettings, n_rays: int, variant: str | None = None) -> None:
        if n_rays < 1:
            raise ValueError(f"n_rays: expected 1 or more, got {n_rays}")
        mi = mitsuba(variant)
        self._settings, self._n_rays, self._variant = settings, n_rays, mi.variant()
        self._embedded = Renderer(scene, replace(settings, samples=SAMPLES))
        self._without: Renderer | None = None
        if any(map(settings.is_on, LACKING)):
            off: dict[str, EffectSetting] = dict.fromkeys(LACKING, "off")
            self._without = Renderer(scene, replace(settings, samples=SAMPLES, wishes={**settings.wishes, **off}))
        self._middle = middle_enu_m(scene)
        self._scene = mitsuba_scene(mi, scene, settings.switches)

    def render(self, photo: PosedPhoto, seed: int = 0, moved_enu_m: Array | None = None) -> Photograph:
        """Take a photograph, as `Renderer` does; `seed` is that of Mitsuba's rays, too."""
        taken = self._embedded.render(photo, seed, moved_enu_m)
        lacking = 0.0 if self._without is None else taken.linear - self._without.render(photo, seed, moved_enu_m).linear
        if not self._settings.is_on(DISTORTION):
            photo = replace(photo, intrinsics=photo.intrinsics.straight())
        moved = moved_enu_m if self._settings.is_on(MOTION_BLUR) else None
        linear = np.maximum(self._linear(photo, seed, moved) + lacking, np.float32(0.0))
        mirrored = np.divide(taken.reflection, taken.linear, out=np.zeros_like(linear), where=taken.linear > 0.0)
        reflection = mirrored * linear
        return replace(taken, linear=linear, diffuse=linear - reflection, reflection=reflection)

    def _linear(self, photo: PosedPhoto, seed: int, moved_enu_m: Array | None) -> NDArray[np.float32]:
        mi = mitsuba(self._variant)
        sensor = lens(mi, photo, self._middle, moved_enu_m)
        height, width = photo.intrinsics.height_px, photo.intrinsics.width_px
        total = np.zeros((height, width, 3))
        passes = -(-self._n_rays * height * width // RAYS_AT_ONCE)
        for number in range(passes):
            rays = self._n_rays // passes + (number < self._n_rays % passes)
            if rays:
                of_pass = int(np.random.SeedSequence([seed, number]).generate_state(1)[0])
                total += rays * np.asarray(mi.render(self._scene, sensor=sensor, spp=rays, seed=of_pass), np.float64)
        return np.asarray(total / self._n_rays, np.float32)


def renderer_of(scene: Scene, settings: RenderSettings) -> Renderer | MitsubaRenderer:
    """The one that the settings ask for."""
    if settings.mitsuba_rays is None:
        return Renderer(scene, settings)
    return MitsubaRenderer(scene, settings, settings.mitsuba_rays)
