"""DJI's numbers for aircraft and cameras, which go together, and our profiles in those terms: `data/dji.toml`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from planning.base.errors import MissionError
from planning.base.json_file import read_toml
from planning.base.messages import say

DATA_PATH = Path(__file__).parents[1] / "data" / "dji.toml"


@dataclass(frozen=True, slots=True)
class Drone:
    """An aircraft: droneEnumValue and droneSubEnumValue, the payloads it may carry, and whether DJI Fly flies it."""

    numbers: tuple[int, int]
    payloads: tuple[str, ...]
    dji_fly: bool = False


@dataclass(frozen=True, slots=True)
class Payload:
    """A camera: its payloadEnumValue and the pitch range of its gimbal, degrees (None: not published)."""

    number: int
    gimbal_pitch_deg: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class DjiProfile:
    """How one of our profiles is written; `data/dji.toml` explains the fields."""

    drone: str
    payload: str
    lens: str
    focus: bool
    wide_zoom_mm: float


@dataclass(frozen=True, slots=True)
class Lenses:
    """Names that payloadLensIndex and imageFormat may hold."""

    names: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class DjiCatalogue:
    """The content of `data/dji.toml`."""

    drones: dict[str, Drone]
    payloads: dict[str, Payload]
    profiles: dict[str, DjiProfile]
    lenses: Lenses

    def drone_by_numbers(self, numbers: tuple[int, int]) -> Drone | None:
        """Aircraft with these droneEnumValue and droneSubEnumValue; None where it is not known."""
        return next((drone for drone in self.drones.values() if drone.numbers == numbers), None)

    def payload_by_number(self, number: int) -> Payload | None:
        """Camera with this payloadEnumValue; None where it is not known."""
        return next((payload for payload in self.payloads.values() if payload.number == number), None)


@cache
def dji_catalogue() -> DjiCatalogue:
    """DJI's numbers and names."""
    return read_toml(DATA_PATH, DjiCatalogue)


def dji_profile(identifier: str) -> DjiProfile:
    """How a profile is written for DJI.

    Raises
    ------
    MissionError
        The profile is none of DJI's aircraft that are known here; which numbers to write must not be guessed.
    """
    known = dji_catalogue().profiles
    if identifier not in known:
        found = say("the profile '{}'", identifier) if identifier else say("no profile")
        raise MissionError(
            say(
                "a DJI mission names its aircraft and camera, but the plan has {}; expected one of {}; plan with "
                "one of them, or export for MAVLink",
                found,
                ", ".join(sorted(known)),
            )
        )
    return known[identifier]
