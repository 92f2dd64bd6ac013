"""What the pilot decides about a live flight."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from groundstation.services.preferences import Tell, read_kept
from groundstation.services.settings import settings_path


@dataclass(frozen=True, slots=True)
class FlightSettings:
    """What the pilot chose.

    Parameters
    ----------
    needs_rtk
        Do not start without RTK, and warn when it is lost.
    """

    needs_rtk: bool = False


USUAL = FlightSettings()


def flight_settings_path() -> Path:
    """Where they are kept for the next start: beside the settings of the program."""
    return settings_path().with_name("flight.toml")


def read_flight_settings(path: Path, tell: Tell = lambda _: None) -> FlightSettings:
    """What was kept, as `read_kept`."""
    return read_kept(path, USUAL, tell)
