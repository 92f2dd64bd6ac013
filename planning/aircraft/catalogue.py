"""Aircraft-and-camera profiles: facts with their sources, from `data/profiles.toml` or a file of the user's own."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

from planning.base.errors import InputError
from planning.base.json_file import read_toml
from planning.plan import Aircraft, Camera

PROFILES_PATH = Path(__file__).parent / "data" / "profiles.toml"


@dataclass(frozen=True, slots=True)
class Profile:
    """One aircraft with the camera it carries, and where the figures come from; `id` is the name of its table."""

    aircraft: Aircraft
    camera: Camera
    source: str = ""
    id: str = ""


@cache
def profiles() -> dict[str, Profile]:
    """All profiles of the catalogue by identifier."""
    return _read(PROFILES_PATH)


def _read(path: Path) -> dict[str, Profile]:
    return {key: replace(found, id=key) for key, found in read_toml(path, dict[str, Profile]).items()}


def profile(identifier: str) -> Profile:
    """One profile: by identifier, or the only one of a TOML file in the catalogue's format.

    Raises
    ------
    InputError
        There is no such profile (the message lists those there are), or the file is wrong or holds several.
    """
    if identifier.lower().endswith(".toml"):
        own = _read(Path(identifier))
        if len(own) != 1:
            raise InputError(f"{identifier}: expected one table with an aircraft and its camera, got {len(own)}")
        return next(iter(own.values()))
    try:
        return profiles()[identifier]
    except KeyError:
        known = ", ".join(sorted(profiles()))
        raise InputError(
            f"there is no aircraft profile '{identifier}'; known are: {known}; your own can be a .toml file"
        ) from None
