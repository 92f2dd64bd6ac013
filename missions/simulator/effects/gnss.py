"""GNSS noise: the receiver errs slowly, so that the aircraft holds a place that is not the one it believes to hold."""

from __future__ import annotations

import math

import numpy as np

from missions.simulator.airframe.state import Fix
from missions.simulator.effects.facts import ReceiverFacts, effect_facts
from missions.simulator.effects.noise import SmoothNoise
from missions.simulator.scene import FlightScene
from planning.base.effects import Assessment
from planning.base.messages import say
from planning.geo.frames import Vec3

COST_PER_STEP_S = 5e-6


def fix_of(facts: ReceiverFacts) -> Fix:
    """What a receiver says of itself: MAVLink's accuracies count both horizontal axes."""
    return Fix(facts.fix_type, facts.n_satellites, math.sqrt(2.0) * facts.horizontal_m, facts.vertical_m)


class AboveStart:
    """Heights count from where the aircraft started, so an error of height counts from what it was there."""

    def __init__(self) -> None:
        self._start_m = 0.0

    def __call__(self, error_m: float, *, flies: bool) -> float:
        """Error of the height above the start; on the ground the start is set anew."""
        if not flies:
            self._start_m = error_m
        return error_m - self._start_m


class NoisyReceiver:
    """The part of the aircraft: a position error, and the receiver's own view of it."""

    def __init__(self, facts: ReceiverFacts, *, gives_height: bool, rng: np.random.Generator) -> None:
        vertical_m = facts.vertical_m if gives_height else 0.0
        self._noise = SmoothNoise((facts.horizontal_m, facts.horizontal_m, vertical_m), facts.correlation_s, rng)
        self._above_start = AboveStart()
        self.fix = fix_of(facts)
        self.offset_enu_m: Vec3 = (0.0, 0.0, 0.0)
        self.step(0.0, self.offset_enu_m, flies=False)

    def step(self, duration_s: float, _position_enu_m: Vec3, *, flies: bool) -> None:
        """Let the error change for a time."""
        self._noise.step(duration_s)
        x, y, z = self._noise.value
        self.offset_enu_m = x, y, self._above_start(z, flies=flies)


class GnssNoise:
    """The effect: error of the position at the shutter."""

    name = say("GNSS noise")
    unit = say("m at the shutter")
    tolerance = 0.05
    """A tenth of the 0.5 m by which a photo may be off its viewpoint."""

    def assess(self, scene: FlightScene) -> Assessment:
        """Root mean square of the receiver's error, all three axes."""
        conditions = scene.conditions
        facts = effect_facts().receivers[conditions.fix]
        vertical_m = facts.vertical_m if conditions.height_by_gnss else 0.0
        # A height is the difference to the start: what has not changed since then cancels.
        half_s = 0.5 * scene.duration_s / facts.correlation_s
        apart = 2.0 * (1.0 - (1.0 + half_s) * math.exp(-half_s))
        size = math.sqrt(2.0 * facts.horizontal_m**2 + apart * vertical_m**2)
        names = {
            "rtk-fixed": say("an RTK fix"),
            "rtk-float": say("RTK without fixed ambiguities"),
            "single": say("no RTK"),
        }
        reason = say("{:.2g} m horizontally", math.sqrt(2.0) * facts.horizontal_m, place=names[conditions.fix])
        return Assessment(size, reason, scene.n_steps * COST_PER_STEP_S)
