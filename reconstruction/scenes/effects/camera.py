"""Effects of the camera."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from planning.base.effects import Assessment
from planning.base.messages import say
from reconstruction.scenes.effects.probe import SECONDS_PER_ANGLE, TOLERANCE_GREY, TOLERANCE_PX, Probe, cost_s
from reconstruction.scenes.parameters import DISTORTION, NOISE, VIGNETTING
from reconstruction.scenes.photos.lens_effects import MIDDLE_GREY, grey_levels

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


EFFECTS = (Distortion(), Vignetting(), Noise())
