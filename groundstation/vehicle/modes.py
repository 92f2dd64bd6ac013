"""Flight modes by name, and the sensors of which autopilots tell how they are: `data/vehicle.toml`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from missions.mavlink.autopilots import Autopilot, mode_numbers, px4_main_and_sub
from missions.mavlink.messages import CommandLong
from planning.base.json_file import read_toml

DATA_PATH = Path(__file__).parent / "data" / "vehicle.toml"

MAV_CMD_DO_SET_MODE = 176
CUSTOM_MODE_ENABLED = 1.0
"""MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, param 1 of DO_SET_MODE."""

MISSION_MODE = {Autopilot.ARDUPILOT: "AUTO", Autopilot.PX4: "AUTO.MISSION"}
PAUSE_MODE = {Autopilot.ARDUPILOT: "BRAKE", Autopilot.PX4: "AUTO.LOITER"}
"""Stops on the spot. ArduPilot's LOITER would obey the throttle stick, and sink where that is at its bottom."""

RETURN_MODE = {Autopilot.ARDUPILOT: "RTL", Autopilot.PX4: "AUTO.RTL"}
LAND_MODE = {Autopilot.ARDUPILOT: "LAND", Autopilot.PX4: "AUTO.LAND"}


@dataclass(frozen=True, slots=True)
class VehicleNumbers:
    """What the data file holds; it explains the fields."""

    sensors: dict[str, int]


@cache
def numbers() -> VehicleNumbers:
    """Sensor bits by name."""
    return read_toml(DATA_PATH, VehicleNumbers)


def set_mode_command(autopilot: Autopilot, name: str, system: int, component: int) -> CommandLong:
    """Command that changes the mode.

    Raises
    ------
    ValueError
        The autopilot has no mode of that name.
    """
    known = mode_numbers(autopilot)
    if name not in known:
        raise ValueError(f"{autopilot.value} has no mode '{name}'; it has {', '.join(known)}")
    mode, sub = (known[name], 0) if autopilot is Autopilot.ARDUPILOT else px4_main_and_sub(known[name])
    return CommandLong(system, component, MAV_CMD_DO_SET_MODE, CUSTOM_MODE_ENABLED, float(mode), float(sub))


def sensor_problems(enabled: int, healthy: int) -> tuple[str, ...]:
    """Names of the sensors that are enabled but not healthy, from the bits of SYS_STATUS."""
    ill = enabled & ~healthy
    return tuple(name for name, bit in numbers().sensors.items() if ill >> bit & 1)
