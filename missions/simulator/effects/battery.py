"""Battery sag: power depends on airspeed and climb, and voltage on charge and current."""

from __future__ import annotations

import math

from missions.simulator.airframe.state import Battery
from missions.simulator.effects.facts import BatteryFacts, effect_facts
from missions.simulator.scene import FlightScene
from planning.base.effects import Assessment
from planning.base.messages import say
from planning.geo.frames import Vec3

GRAVITY_M_S2 = 9.80665

COST_PER_STEP_S = 5e-7


def power_ratio(airspeed_m_s: float, climb_m_s: float, facts: BatteryFacts) -> float:
    """Power against that of hovering in still air, 0.2 or more.

    Induced share by Glauert: x^2 = -h + sqrt(h^2 + 1), h = (V / v_h)^2 / 2, with x the induced speed against that of
    hovering, v_h (Leishman 2006, Principles of Helicopter Aerodynamics, section 2.14, level flight). The rest at hover
    turns the blades and is kept; drag takes m c V^2, climbing m g v, both at the efficiency of hovering. Sinking gives
    back what climbing takes, down to a fifth.
    """
    induced, efficiency = facts.hover_induced_m_s, facts.induced_share
    h = 0.5 * (airspeed_m_s / induced) ** 2
    x = math.sqrt(1.0 / (h + math.sqrt(h * h + 1.0)))
    moved = facts.drag_per_s * airspeed_m_s**2 / GRAVITY_M_S2 + climb_m_s
    return max(0.2, efficiency * x + (1.0 - efficiency) + efficiency * moved / induced)


class SaggingPack:
    """The part of the aircraft: drawn by the power that flying takes.

    Parameters
    ----------
    endurance_s
        How long a full pack lasts at the speed for which makers state it, in still air.
    """

    def __init__(self, facts: BatteryFacts, endurance_s: float) -> None:
        self._facts = facts
        self._hover_per_s = 1.0 / (endurance_s * power_ratio(facts.endurance_speed_m_s, 0.0, facts))
        self._used, self._rate_per_s = 0.0, 0.0

    @property
    def state(self) -> Battery:
        """What its monitor says."""
        facts = self._facts
        current_a = self._rate_per_s * facts.capacity_mah * 3.6
        rest_v = facts.empty_v + (facts.full_v - facts.empty_v) * (1.0 - self._used)
        voltage_v = max(0.0, rest_v - current_a * facts.resistance_ohm)
        return Battery(voltage_v, current_a, self._used * facts.capacity_mah, 1.0 - self._used)

    def step(self, duration_s: float, velocity_enu_m_s: Vec3, wind_enu_m_s: Vec3, *, motors_on: bool) -> None:
        """Draw power for a time."""
        if not motors_on:
            self._rate_per_s = 0.0
            return
        (vx, vy, vz), (wx, wy, _) = velocity_enu_m_s, wind_enu_m_s
        self._rate_per_s = self._hover_per_s * power_ratio(math.hypot(vx - wx, vy - wy), vz, self._facts)
        self._used = min(1.0, self._used + duration_s * self._rate_per_s)


class BatterySag:
    """The effect: share of the battery that a flight takes more or less than its time says."""

    name = say("battery sag")
    unit = say("of the battery")
    tolerance = 0.02
    """A tenth of the reserve."""

    def assess(self, scene: FlightScene) -> Assessment:
        """By hovering in the wind, and flying at the mean speed with and against it."""
        facts, wind_m_s = effect_facts().battery, scene.conditions.wind_m_s
        hovering = power_ratio(wind_m_s, 0.0, facts)
        flying = 0.5 * sum(power_ratio(abs(scene.cruise_m_s + s * wind_m_s), 0.0, facts) for s in (-1.0, 1.0))
        share = scene.hover_share
        ratio = (share * hovering + (1.0 - share) * flying) / power_ratio(facts.endurance_speed_m_s, 0.0, facts)
        size = abs(ratio - 1.0) * scene.duration_s / scene.aircraft.endurance_s
        reason = say(
            "{:.0%} of the flight is hovered in {:g} m/s of wind: {:.0%} of the power for which the "
            "endurance is stated",
            share,
            wind_m_s,
            ratio,
        )
        return Assessment(size, reason, scene.n_steps * COST_PER_STEP_S)
