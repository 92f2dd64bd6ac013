"""The two autopilots and what each does with mission items: `data/mavlink.toml`."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from pathlib import Path

from planning.base.json_file import read_toml

DATA_PATH = Path(__file__).parents[1] / "data" / "mavlink.toml"


class Autopilot(StrEnum):
    """Whose rules a MAVLink mission follows."""

    ARDUPILOT = "ardupilot"
    PX4 = "px4"

    @property
    def product(self) -> str:
        """As its makers write it."""
        return {Autopilot.ARDUPILOT: "ArduPilot", Autopilot.PX4: "PX4"}[self]


@dataclass(frozen=True, slots=True)
class AutopilotFacts:
    """Limits of one autopilot; `data/mavlink.toml` explains the fields and says where they come from."""

    firmware_type: int
    max_items: int
    position_frames: frozenset[int]
    commands: frozenset[int]
    rejected: frozenset[int]
    own_jerk_m_s3: float | None = None


@cache
def _all_facts() -> dict[str, AutopilotFacts]:
    return read_toml(DATA_PATH, dict[str, AutopilotFacts])


def facts(autopilot: Autopilot) -> AutopilotFacts:
    """Limits of an autopilot."""
    return _all_facts()[autopilot]
