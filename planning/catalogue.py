"""Aircraft-and-camera profiles: facts with their sources, read from `data/profiles.toml`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from planning.errors import InputError
from planning.json_file import read_toml
from planning.plan import Aircraft, Camera

PROFILES_PATH = Path(__file__).parent / "data" / "profiles.toml"

DEFAULT_PROFILE = "m3e"


@dataclass(frozen=True, slots=True)
class Profile:
    """One aircraft with the camera it carries, and where the figures come from."""

    aircraft: Aircraft
    camera: Camera
    source: str


@cache
def profiles() -> dict[str, Profile]:
    """All profiles by identifier."""
    return read_toml(PROFILES_PATH, dict[str, Profile])


def profile(identifier: str) -> Profile:
    """One profile.

    Raises
    ------
    InputError
        There is no such profile; the message lists those there are.
    """
    try:
        return profiles()[identifier]
    except KeyError:
        known = ", ".join(sorted(profiles()))
        raise InputError(f"there is no aircraft profile '{identifier}'; known are: {known}") from None
