"""What the pilot decides about a live flight, and what a decision would change on a real vehicle."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from groundstation.services.kept import read_kept
from groundstation.services.settings import settings_path
from groundstation.vehicle.orders import SortieOrders
from groundstation.vehicle.setup import needs_reboot, wanted_parameters
from missions.mavlink.autopilots import Autopilot


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


def flight_settings_path() -> Path:
    """Where they are kept for the next start: beside the settings of the program."""
    return settings_path().with_name("flight.toml")


def read_flight_settings(path: Path) -> FlightSettings:
    """What was kept; whether an upload may set parameters is asked anew, the next vehicle may be another one."""
    return replace(read_kept(path, USUAL), sets_parameters=False)


@dataclass(frozen=True, slots=True)
class SetParameter:
    """A parameter that would be set, in the autopilot's units, and whether it takes effect after a reboot only."""

    name: str
    value: float
    needs_reboot: bool


def parameters_to_set(autopilot: Autopilot, orders: SortieOrders) -> tuple[SetParameter, ...]:
    """What an upload sets where the pilot agrees, and the vehicle does not have it so already."""
    after_reboot = needs_reboot(autopilot)
    wanted = wanted_parameters(autopilot, orders.mission, orders.return_height_m)
    return tuple(SetParameter(name, value, name in after_reboot) for name, value in wanted.items())
