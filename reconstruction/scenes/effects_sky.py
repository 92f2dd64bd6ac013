"""Effect of what stands around on the light that reaches a place."""

from __future__ import annotations

from dataclasses import dataclass

from planning.effects import Assessment
from reconstruction.scenes.effect_names import SKY_OCCLUSION
from reconstruction.scenes.effect_terms import TOLERANCE_GREY
from reconstruction.scenes.effects_probe import Probe

SECONDS_PER_PLACE = 1.9e-4
"""Of one core, for all rays of a place and what they meet: measured on `planar`, `curved` and `court`."""

PLACES_PER_PROBED = 5.0
"""Places that a flight's photos show for each that the probe's rays meet: on `planar`, 24 photos."""


@dataclass(frozen=True, slots=True)
class SkyOcclusion:
    """Light from around by what a place sees of sky and surroundings, against that of open sky and even ground."""

    tolerance: float = TOLERANCE_GREY
    name = SKY_OCCLUSION
    unit = "grey levels"

    def assess(self, probe: Probe) -> Assessment:
        """Both ways with the rays of the probe."""
        if not probe.scene.bodies:
            return Assessment(0.0, "there is nothing that light falls on", 0.0)
        light = probe.surroundings_light()
        reason = f"what is seen gets {100.0 * light.share:.0f} % of the light of an open sky"
        return Assessment(light.change_grey, reason, light.n_places * PLACES_PER_PROBED * SECONDS_PER_PLACE)
