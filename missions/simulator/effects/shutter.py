"""Photo latency and exposure: a photo is taken a little late, and what moves while the shutter is open is blurred."""

from __future__ import annotations

import math

from missions.simulator.effects.facts import effect_facts
from missions.simulator.effects.wind import GustResponse
from missions.simulator.scene import FlightScene
from planning.base.effects import Assessment
from planning.base.messages import say


class PhotoTiming:
    """The effect: blur of the closest pane in any view."""

    name = say("photo latency and blur")
    unit = say("px of blur")
    tolerance = 0.5
    """Half a pixel is less than a lens blurs."""

    def assess(self, scene: FlightScene) -> Assessment:
        """Blur at the speed with which gusts move an aircraft that holds its place (1 sigma, all axes)."""
        conditions = scene.conditions
        speed_m_s = 0.0
        if conditions.wind_m_s > 0.0:
            spread = GustResponse(effect_facts().wind, conditions.wind_m_s, scene.height_m).spread()
            speed_m_s = math.sqrt(float(spread[:, 2, 2].sum()))
        blur = speed_m_s * conditions.exposure_s / scene.gsd_m
        reason = say(
            "photos are taken at rest, where gusts leave {:.2f} m/s; the shutter is open for {:.3g} ms, a "
            "pixel is {:.1f} mm on the glass",
            speed_m_s,
            1000.0 * conditions.exposure_s,
            1000.0 * scene.gsd_m,
        )
        return Assessment(blur, reason, 0.0)
