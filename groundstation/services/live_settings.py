"""What the pilot decides about a live flight, and what a decision would change on a real vehicle."""

from __future__ import annotations

from dataclasses import dataclass

from groundstation.vehicle.setup import needs_reboot, wanted_parameters
from missions.mavlink.autopilots import Autopilot
from missions.model import Mission


@dataclass(frozen=True, slots=True)
class FlightSettings:
    """What the pilot chose.

    Parameters
    ----------
    needs_rtk
        Do not start without RTK, and warn when it is lost.
    sets_parameters
        Set the vehicle's parameters as the plan needs them; always for the embedded simulation.
    """

    needs_rtk: bool = False
    sets_parameters: bool = False


USUAL = FlightSettings()


@dataclass(frozen=True, slots=True)
class SetParameter:
    """A parameter that would be set, in the autopilot's units, and whether it takes effect after a reboot only."""

    name: str
    value: float
    needs_reboot: bool


def parameters_to_set(autopilot: Autopilot, mission: Mission) -> tuple[SetParameter, ...]:
    """What an upload sets where the pilot agrees, and the vehicle does not have it so already."""
    after_reboot = needs_reboot(autopilot)
    wanted = wanted_parameters(autopilot, mission)
    return tuple(SetParameter(name, value, name in after_reboot) for name, value in wanted.items())
