"""Effects of light that reaches the scene."""

from __future__ import annotations

from dataclasses import dataclass

from planning.effects import Assessment
from reconstruction.scenes.effect_names import SHADOW
from reconstruction.scenes.effect_terms import SECONDS_PER_SHADOW, TOLERANCE_GREY, cost_s
from reconstruction.scenes.effects_probe import Probe
from reconstruction.scenes.tracing import Switches


@dataclass(frozen=True, slots=True)
class Shadow:
    """Places that the sun does not reach."""

    tolerance: float = TOLERANCE_GREY
    name = SHADOW
    unit = "grey levels"

    def assess(self, probe: Probe) -> Assessment:
        """Both ways with the rays of the probe."""
        sky = probe.scene.sky
        if sky.sun_elevation_deg <= 0.0 or not any(sky.sun):
            return Assessment(0.0, "there is no sun", 0.0)
        reason = f"the sun stands {sky.sun_elevation_deg:.0f} degrees high"
        return Assessment(probe.change_without(Switches(shadow=False)), reason, cost_s(probe, 1.0, SECONDS_PER_SHADOW))
