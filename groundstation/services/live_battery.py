"""A simulated aircraft whose battery was flown before."""

from __future__ import annotations

from dataclasses import replace

from missions.simulator.airframe import Airframe, Battery, Fix, Pose, Target
from missions.simulator.effects.battery import BatterySag
from missions.simulator.effects.facts import effect_facts
from planning.effects import Decision
from planning.frames import Vec3


class FlownBefore:
    """An `Airframe` that starts with part of its charge gone; all else is the airframe's own.

    Parameters
    ----------
    charge
        Of its battery at the start, 1 full to 0 empty.
    sags
        Whether the voltage follows the charge, as where battery sag is on.
    """

    def __init__(self, airframe: Airframe, charge: float, *, sags: bool) -> None:
        if not 0.0 <= charge <= 1.0:
            raise ValueError(f"charge: expected 0 to 1, got {charge}")
        facts = effect_facts().battery
        self._airframe, self._used = airframe, 1.0 - charge
        self._used_mah = self._used * facts.capacity_mah
        self._lower_v = self._used * (facts.full_v - facts.empty_v) if sags else 0.0

    @property
    def truth(self) -> Pose:
        """Where it really is."""
        return self._airframe.truth

    @property
    def believed(self) -> Pose:
        """Where the autopilot's estimator says it is."""
        return self._airframe.believed

    @property
    def fix(self) -> Fix:
        """State of the GNSS receiver."""
        return self._airframe.fix

    @property
    def battery(self) -> Battery:
        """State of the battery."""
        drawn = self._airframe.battery
        return replace(
            drawn,
            voltage_v=max(0.0, drawn.voltage_v - self._lower_v),
            consumed_mah=drawn.consumed_mah + self._used_mah,
            remaining=max(0.0, drawn.remaining - self._used),
        )

    @property
    def wind_enu_m_s(self) -> Vec3:
        """Wind that blows towards this direction."""
        return self._airframe.wind_enu_m_s

    def step(self, duration_s: float, target: Target) -> None:
        """Fly on for a time."""
        self._airframe.step(duration_s, target)

    def shutter(self) -> tuple[Pose, float]:
        """True pose of the camera at the middle of an exposure, and the exposure's length."""
        return self._airframe.shutter()


def with_charge(airframe: Airframe, charge: float, decisions: tuple[Decision, ...]) -> Airframe:
    """The airframe with so much of its battery left, 1 full to 0 empty."""
    if charge >= 1.0:
        return airframe
    sags = any(decision.effect == BatterySag.name and decision.on for decision in decisions)
    return FlownBefore(airframe, charge, sags=sags)
