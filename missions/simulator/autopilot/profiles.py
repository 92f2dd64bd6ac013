"""What the simulated vehicle does as each autopilot: `data/simulator.toml` explains the fields and their sources."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from pathlib import Path

from missions.mavlink.autopilots import Autopilot
from planning.base.json_file import read_toml

DATA_PATH = Path(__file__).parents[2] / "data" / "simulator.toml"


class Activity(StrEnum):
    """What the vehicle does in a mode."""

    HOLD = "hold"
    TAKEOFF = "takeoff"
    MISSION = "mission"
    RETURN = "return"
    LAND = "land"


@dataclass(frozen=True, slots=True)
class Mode:
    """One flight mode: what is done in it, and whether it may be armed in it."""

    activity: Activity
    armable: bool


@dataclass(frozen=True, slots=True)
class VehicleProfile:
    """One autopilot's behaviour in numbers."""

    retry_s: float
    give_up_s: float
    estimator_ready_s: float
    pass_m: float
    max_fence_items: int
    max_rally_items: int
    boot_mode: str
    reports_reached: frozenset[int]
    keeps: dict[str, str]
    modes: dict[str, Mode]
    parameters: dict[str, int | float]

    def mode_named(self, activity: Activity) -> str:
        """Name of the mode that a vehicle in flight takes for an activity."""
        preferred = ("LOITER", "AUTO.LOITER") if activity is Activity.HOLD else ()
        names = [name for name, mode in self.modes.items() if mode.activity is activity]
        return next((name for name in names if name in preferred), names[0])


@cache
def _all_profiles() -> dict[str, VehicleProfile]:
    return read_toml(DATA_PATH, dict[str, VehicleProfile])


def vehicle_profile(autopilot: Autopilot) -> VehicleProfile:
    """Behaviour of an autopilot."""
    return _all_profiles()[autopilot]
