"""Effects of the camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from planning.base.effects import Assessment
from planning.base.messages import say
from reconstruction.scenes.effects.probe import (
    QUANTILE,
    RAYS_PER_PIXEL,
    SECONDS_PER_ANGLE,
    SECONDS_PER_RAY,
    TOLERANCE_GREY,
    TOLERANCE_PX,
    Probe,
    cost_s,
)
from reconstruction.scenes.parameters import DEPTH_OF_FIELD, DISTORTION, NOISE, VIGNETTING
from reconstruction.scenes.photos.lens_effects import MIDDLE_GREY, grey_levels
from reconstruction.scenes.photos.thin_lens import n_places

SECONDS_PER_BEND = 3e-7
"""Of one core, for a ray whose distortion is undone."""


@dataclass(frozen=True, slots=True)
class Distortion:
    """Displacement by the lens at the pictures' edges."""

    tolerance: float = TOLERANCE_PX
    name = DISTORTION
    unit = "px"

    def assess(self, probe: Probe) -> Assessment:
        """The largest one of all cameras."""
        lenses = {photo.intrinsics for photo in probe.photos}
        bent = [lens for lens in lenses if not lens.is_straight]
        if not bent:
            return Assessment(0.0, say("the pictures are straight already"), 0.0)
        size = 0.0
        for lens in bent:
            x, y = np.meshgrid(np.linspace(0, lens.width_px, 21), np.linspace(0, lens.height_px, 21))
            places = np.column_stack([x.ravel(), y.ravel()])
            straight = lens.straight().pixels(lens.rays(places))
            size = max(size, float(np.linalg.norm(straight - places, axis=1).max()))
        return Assessment(size, say("the lens bends straight lines"), cost_s(probe, 1.0, SECONDS_PER_BEND))


@dataclass(frozen=True, slots=True)
class Vignetting:
    """Light that the lens loses in the corners."""

    tolerance: float = TOLERANCE_GREY
    name = VIGNETTING
    unit = say("grey levels")

    def assess(self, probe: Probe) -> Assessment:
        """Of middle grey, in a corner."""
        lost = probe.camera_model.sensor.corner_loss
        size = float(grey_levels(np.array(MIDDLE_GREY)) - grey_levels(np.array(MIDDLE_GREY * (1.0 - lost))))
        reason = say("the lens loses {:.0f} % of the light in the corners", 100.0 * lost)
        return Assessment(size, reason, probe.n_pixels * SECONDS_PER_ANGLE)


@dataclass(frozen=True, slots=True)
class Noise:
    """Noise of the sensor."""

    tolerance: float = TOLERANCE_GREY
    name = NOISE
    unit = say("grey levels")

    def assess(self, probe: Probe) -> Assessment:
        """Of middle grey."""
        sensor, grey = probe.camera_model.sensor, np.array(MIDDLE_GREY)
        size = float(grey_levels(grey + sensor.noise(grey)) - grey_levels(grey))
        reason = say("a white pixel holds {:.0f} electrons", sensor.white_e)
        return Assessment(size, reason, 3.0 * probe.n_pixels * SECONDS_PER_ANGLE)


@dataclass(frozen=True, slots=True)
class DepthOfField:
    """Circles that points become out of focus: of what is seen directly, and of what is mirrored, behind its pane."""

    tolerance: float = TOLERANCE_PX
    name = DEPTH_OF_FIELD
    unit = "px"

    def assess(self, probe: Probe) -> Assessment:
        """By the rays of the probe; the sky counts as infinitely far, and so does what is mirrored of it."""
        lens = probe.camera_model.lens
        if lens is None:
            return Assessment(0.0, say("no aperture is stated, so all is in focus"), 0.0)
        seen_px = lens.circle_px(probe.depths_m, probe.focal_px)
        mirror = probe.mirrored
        # The image of a thing lies on the ray as far behind the pane as the thing is before it.
        mirrored_px = lens.circle_px(
            probe.depths_m[probe.is_pane] * (1.0 + mirror.path_m / mirror.sight_m), mirror.focal_px
        )
        direct, images = (float(np.quantile(part, QUANTILE)) if len(part) else 0.0 for part in (seen_px, mirrored_px))
        reason = say(
            "through a pupil of {:.1f} mm, what is seen is out of focus by {:.1f} px, what is mirrored by {:.1f} px",
            lens.pupil_mm,
            direct,
            images,
        )
        size = max(direct, images)
        rays = n_places(size) * probe.n_pixels * RAYS_PER_PIXEL * (1.0 + probe.glass_share)
        return Assessment(size, reason, rays * SECONDS_PER_RAY)


EFFECTS = (Distortion(), Vignetting(), Noise(), DepthOfField())
