"""Barometer drift: the weather changes the air pressure, and with it the height that the aircraft believes to have."""

from __future__ import annotations

import numpy as np

from missions.simulator.effects.facts import BarometerFacts, effect_facts
from missions.simulator.effects.gnss import AboveStart
from missions.simulator.scene import FlightScene
from planning.base.effects import Assessment
from planning.base.messages import say
from planning.geo.frames import Vec3

COST_PER_STEP_S = 1e-6


def drift_m_s(facts: BarometerFacts) -> float:
    """1 sigma of the rate at which the height drifts."""
    return facts.drift_hpa_per_h * facts.m_per_hpa / 3600.0


class DriftingBarometer:
    """The part of the aircraft: a height error that grows evenly since the start; none where others give the height."""

    def __init__(self, facts: BarometerFacts, *, gives_height: bool, rng: np.random.Generator) -> None:
        self._rate_m_s = drift_m_s(facts) * float(rng.standard_normal()) if gives_height else 0.0
        self._error_m = 0.0
        self._above_start = AboveStart()
        self.offset_enu_m: Vec3 = (0.0, 0.0, 0.0)

    def step(self, duration_s: float, _position_enu_m: Vec3, *, flies: bool) -> None:
        """Drift on for a time."""
        self._error_m += duration_s * self._rate_m_s
        self.offset_enu_m = 0.0, 0.0, self._above_start(self._error_m, flies=flies)


class BarometerDrift:
    """The effect: error of the height at the shutter, in the middle of the flight."""

    name = say("barometer drift")
    unit = say("m at the shutter")
    tolerance = 0.05
    """A tenth of the 0.5 m by which a photo may be off its viewpoint."""

    def assess(self, scene: FlightScene) -> Assessment:
        """Drift over half the flight, 1 sigma."""
        if scene.conditions.height_by_gnss:
            return Assessment(0.0, say("the height comes from the GNSS receiver"), 0.0)
        facts = effect_facts().barometer
        reason = say(
            "the weather drifts by {:g} hPa an hour over a flight of {:.0f} s", facts.drift_hpa_per_h, scene.duration_s
        )
        size = 0.5 * scene.duration_s * drift_m_s(facts)
        return Assessment(size, reason, scene.n_steps * COST_PER_STEP_S)
