"""Gimbal lag: the camera slows down before it gets where it shall look, and may not be there at the shutter."""

from __future__ import annotations

import math

import numpy as np

from missions.simulator.effects.facts import effect_facts
from missions.simulator.scene import FlightScene
from planning.base.effects import Assessment
from planning.base.messages import say

COST_PER_STEP_S = 5e-7


def lagging_rad(distance_rad: float, duration_s: float, rate_rad_s: float, lag_s: float) -> float:
    """What is left of a turn after a time: x' = -x / lag, no faster than the rate. Exact; sign as given."""
    left = abs(distance_rad)
    at_full_rate_s = min(duration_s, max(0.0, left / rate_rad_s - lag_s))
    left = (left - rate_rad_s * at_full_rate_s) * math.exp(-(duration_s - at_full_rate_s) / lag_s)
    return math.copysign(left, distance_rad)


class LaggingGimbal:
    """The part of the aircraft."""

    def __init__(self, rate_rad_s: float, lag_s: float, pitch_rad: float = 0.0) -> None:
        self._rate_rad_s, self._lag_s, self.pitch_rad = rate_rad_s, lag_s, pitch_rad

    def step(self, duration_s: float, wanted_rad: float) -> None:
        """Turn towards a pitch."""
        self.pitch_rad = self.ahead_rad(duration_s, wanted_rad)

    def ahead_rad(self, duration_s: float, wanted_rad: float) -> float:
        """Pitch after some more time."""
        return wanted_rad - lagging_rad(wanted_rad - self.pitch_rad, duration_s, self._rate_rad_s, self._lag_s)


class GimbalLag:
    """The effect: how far the camera is from its pitch at the shutter."""

    name = say("gimbal lag")
    unit = say("deg at the shutter")
    tolerance = 0.2
    """A tenth of the 2 deg by which a photo's pitch may be off."""

    def assess(self, scene: FlightScene) -> Assessment:
        """The largest turn between photos, after turning at the full rate and settling as planned."""
        if len(scene.pitch_rad) == 0:
            return Assessment(0.0, say("there are no views"), 0.0)
        largest = float(np.abs(np.diff(scene.pitch_rad, prepend=0.0)).max())
        rate_rad_s = math.radians(scene.aircraft.max_gimbal_rate_deg_s)
        time_s = largest / rate_rad_s + scene.rules.settle_s
        left = lagging_rad(largest, time_s, rate_rad_s, effect_facts().gimbal.lag_s)
        reason = say("turns of up to {:.0f} deg have {:g} s to settle", math.degrees(largest), scene.rules.settle_s)
        return Assessment(math.degrees(left), reason, scene.n_steps * COST_PER_STEP_S)
