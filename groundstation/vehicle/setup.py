"""Parameters that a vehicle needs for a plan, or by which a simulation tells itself, and messages that it shall send.

The parameters stand in `data/setup.toml`, which explains its fields.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import Address, CommandLong
from missions.mission.model import Mission
from planning.base.json_file import read_toml
from planning.base.messages import say

DATA_PATH = Path(__file__).parent / "data" / "setup.toml"

MAV_CMD_SET_MESSAGE_INTERVAL, MAV_CMD_REQUEST_MESSAGE = 511, 512
HOME_POSITION = 242

HUNDREDTHS = 100

RATES_HZ = {
    33: 10.0,  # GLOBAL_POSITION_INT
    30: 10.0,  # ATTITUDE
    285: 10.0,  # GIMBAL_DEVICE_ATTITUDE_STATUS
    1: 1.0,  # SYS_STATUS
    2: 1.0,  # SYSTEM_TIME: what the UNIX time of a photo is since power-up
    24: 2.0,  # GPS_RAW_INT
    42: 2.0,  # MISSION_CURRENT
    245: 2.0,  # EXTENDED_SYS_STATE
    242: 0.5,  # HOME_POSITION
}
OWN_RATES_HZ = {
    Autopilot.ARDUPILOT: {193: 1.0, 168: 1.0},  # EKF_STATUS_REPORT, WIND
    Autopilot.PX4: {230: 1.0, 231: 1.0},  # ESTIMATOR_STATUS, WIND_COV
}
"""Messages by number: positions and angles often enough for a photo's pose, the rest for the eye."""


@dataclass(frozen=True, slots=True)
class SlowLanding:
    """The last part of a landing: from which height on, and how fast."""

    below_m: float
    speed_m_s: float


@dataclass(frozen=True, slots=True)
class VehicleSetup:
    """What the data file holds for one autopilot; it explains the fields."""

    reboot: frozenset[str]
    off: dict[str, float]
    landing: SlowLanding
    leg_late_s: float
    simulation: dict[str, float]
    needed: dict[str, float]
    from_plan: dict[str, tuple[str, float]]


@cache
def _setups() -> dict[str, VehicleSetup]:
    return read_toml(DATA_PATH, dict[str, VehicleSetup])


@dataclass(frozen=True, slots=True)
class ParameterChange:
    """A parameter that should be set for the plan, in the autopilot's units.

    Parameters
    ----------
    needs_reboot
        It takes effect after a reboot only.
    is_off
        As it is, the autopilot commands no camera, or no gimbal.
    """

    name: str
    old: float
    new: float
    needs_reboot: bool
    is_off: bool


def needs_reboot(autopilot: Autopilot) -> frozenset[str]:
    """Parameters whose change takes effect after a reboot only."""
    return _setups()[autopilot].reboot


def change_text(change: ParameterChange) -> str:
    """What is to be set, and why, in words."""
    if change.is_off:
        return say(
            "{} is {:g}: the autopilot commands no camera, or no gimbal; set it to {:g} and restart the vehicle",
            change.name,
            change.old,
            change.new,
        )
    return say("{} is {:g}; the plan was made for {:g}", change.name, change.old, change.new)


def simulation_names(autopilot: Autopilot) -> tuple[str, ...]:
    """Parameters by which a simulated vehicle tells itself."""
    return tuple(_setups()[autopilot].simulation)


def is_simulation(autopilot: Autopilot, values: Mapping[str, float]) -> bool:
    """Whether a vehicle with these parameters says that it is simulated; those that it does not know are absent."""
    return any(values.get(name, -math.inf) >= least for name, least in _setups()[autopilot].simulation.items())


def parameter_changes(
    autopilot: Autopilot, needed: Mapping[str, float], values: Mapping[str, float]
) -> tuple[ParameterChange, ...]:
    """What differs from what a plan needs, of the parameters that the vehicle knows."""
    setup = _setups()[autopilot]
    return tuple(
        ParameterChange(name, values[name], new, name in setup.reboot, setup.off.get(name) == values[name])
        for name, new in needed.items()
        if name in values and not math.isclose(values[name], new, rel_tol=1e-3, abs_tol=1e-9)
    )


def landing(autopilot: Autopilot) -> SlowLanding:
    """How an autopilot lands when nobody says otherwise."""
    return _setups()[autopilot].landing


def leg_late_s(autopilot: Autopilot) -> float:
    """How much longer an autopilot takes for a leg than the fastest way within the limits."""
    return _setups()[autopilot].leg_late_s


def wanted_parameters(autopilot: Autopilot, mission: Mission, return_height_m: float) -> dict[str, float]:
    """Parameters with which a mission is flown as it was planned, in the autopilot's units.

    Parameters
    ----------
    return_height_m
        Above take-off, to which an aircraft climbs before it returns.
    """
    setup, aircraft = _setups()[autopilot], mission.aircraft
    low, high = mission.camera.gimbal_pitch_deg
    own = {"speed_m_s": mission.speed_m_s, "gimbal_pitch_low_deg": low, "gimbal_pitch_high_deg": high}
    own["return_height_m"] = return_height_m
    wanted = dict(setup.needed)
    for name, (field, factor) in setup.from_plan.items():
        value = own[field] if field in own else getattr(aircraft, field)
        if value is not None:
            # Hundredths are whole numbers on ArduPilot.
            wanted[name] = float(round(value * factor)) if factor == HUNDREDTHS else value * factor
    return wanted


def message_requests(autopilot: Autopilot, vehicle: Address) -> tuple[CommandLong, ...]:
    """Commands that make the vehicle send what is watched; home, which seldom changes, at once."""
    rates = RATES_HZ | OWN_RATES_HZ[autopilot]
    return (
        *(
            CommandLong(vehicle.system, vehicle.component, MAV_CMD_SET_MESSAGE_INTERVAL, float(number), 1e6 / rate_hz)
            for number, rate_hz in rates.items()
        ),
        CommandLong(vehicle.system, vehicle.component, MAV_CMD_REQUEST_MESSAGE, float(HOME_POSITION)),
    )
