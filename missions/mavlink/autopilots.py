"""The two autopilots and what each does with mission items, and their flight modes: `data/mavlink.toml`."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from pathlib import Path

from planning.base.messages import say

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
    max_fence_items: int
    position_frames: frozenset[int]
    commands: frozenset[int]
    rejected: frozenset[int]
    own_jerk_m_s3: float | None = None


@cache
def _all_facts() -> dict[str, AutopilotFacts]:
    from planning.base.json_file import read_toml  # not at the top: the command line describes itself

    return read_toml(DATA_PATH, dict[str, AutopilotFacts])


def facts(autopilot: Autopilot) -> AutopilotFacts:
    """Limits of an autopilot."""
    return _all_facts()[autopilot]


# Flight modes of the two autopilots by custom mode number and by name: `data/modes.toml`.

MODE_DATA_PATH = Path(__file__).parents[1] / "data" / "modes.toml"


def px4_custom_mode(main: int, sub: int) -> int:
    """PX4's custom mode: the main mode in bits 16 to 23, the sub mode in bits 24 to 31."""
    return main << 16 | sub << 24


def px4_main_and_sub(custom_mode: int) -> tuple[int, int]:
    """Main and sub mode of a custom mode of PX4."""
    return custom_mode >> 16 & 0xFF, custom_mode >> 24 & 0xFF


@cache
def mode_numbers(autopilot: Autopilot) -> dict[str, int]:
    """Custom mode, as HEARTBEAT tells it, by name."""
    from planning.base.json_file import read_toml

    written = read_toml(MODE_DATA_PATH, dict[str, dict[str, int]])[autopilot]
    if autopilot is Autopilot.ARDUPILOT:
        return written
    return {name: px4_custom_mode(*divmod(number, 100)) for name, number in written.items()}


@cache
def _names(autopilot: Autopilot) -> dict[int, str]:
    return {number: name for name, number in mode_numbers(autopilot).items()}


def mode_name(autopilot: Autopilot, custom_mode: int) -> str:
    """Name of the mode in a heartbeat; `mode 42` for one that is not known."""
    names = _names(autopilot)
    if autopilot is Autopilot.PX4:
        main, sub = px4_main_and_sub(custom_mode)
        return names.get(custom_mode) or names.get(px4_custom_mode(main, 0)) or say("mode {}.{}", main, sub)
    return names.get(custom_mode) or say("mode {}", custom_mode)
