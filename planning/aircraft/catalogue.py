"""Aircraft-and-camera profiles: facts with their sources.

They are from `data/profiles.toml`, a file of the user's own, or plug-ins: an entry point of the group
`reflight.aircraft` stands for the path of a TOML file in the format of `data/profiles.toml`, each table a profile.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

from planning.base.errors import InputError
from planning.base.json_file import read_toml
from planning.base.messages import say
from planning.base.plugins import NAME, Plugin, PluginGroup, load_plugins
from planning.optics import CameraControls
from planning.plan import Aircraft, Camera

PROFILES_PATH = Path(__file__).parent / "data" / "profiles.toml"


@dataclass(frozen=True, slots=True)
class Body:
    """The aircraft as something that can hurt people, for ground risk (`planning.insight.ground_risk`).

    Parameters
    ----------
    characteristic_dimension_m
        Longest straight line between two of its points, tips of the propellers included.
    max_takeoff_mass_kg
        As the maker allows it.
    full_speed_m_s
        Fastest it can fly level through calm air in any mode, not what a mission asks for.
    braking_tilt_deg
        Tilt with which it brakes.
    """

    characteristic_dimension_m: float
    max_takeoff_mass_kg: float
    full_speed_m_s: float
    braking_tilt_deg: float
    source: str = ""

    def __post_init__(self) -> None:
        for field in ("characteristic_dimension_m", "max_takeoff_mass_kg", "full_speed_m_s", "braking_tilt_deg"):
            value = getattr(self, field)
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(say("expected a positive number, got {}", value, place=field))


@dataclass(frozen=True, slots=True)
class Profile:
    """One aircraft with the camera it carries, and where the figures come from; `id` is the name of its table.

    `body` is None where nobody has stated it; ground risk then has to be told. `controls` are what can be set on the
    camera, None likewise.
    """

    aircraft: Aircraft
    camera: Camera
    source: str = ""
    id: str = ""
    body: Body | None = None
    controls: CameraControls | None = None


@cache
def bundled_profiles() -> dict[str, Profile]:
    """Profiles of the catalogue by identifier."""
    return _read(PROFILES_PATH)


@cache
def profiles() -> dict[str, Profile]:
    """All profiles by identifier: those of the catalogue, then those of plug-ins."""
    found = dict(bundled_profiles())

    def take(_plugin: Plugin, path: object) -> None:
        if not isinstance(path, (str, Path)):
            raise InputError.say(
                "expected its entry point to stand for the path of a TOML file, got {}", type(path).__name__
            )
        own = _read(Path(path))
        wrong = next((key for key in own if not NAME.fullmatch(key)), None)
        if wrong is not None:
            raise InputError.say(
                "'{}' has other characters than a-z, 0-9, dot, hyphen and underscore", wrong, place=path
            )
        known = next((key for key in own if key in found), None)
        if known is not None:
            raise InputError.say("there is another aircraft profile '{}'", known, place=path)
        found.update(own)

    load_plugins(PluginGroup.AIRCRAFT, take, ())
    return found


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
            raise InputError.say(
                "expected one table with an aircraft and its camera, got {}", len(own), place=identifier
            )
        return next(iter(own.values()))
    if identifier in bundled_profiles():
        return bundled_profiles()[identifier]
    try:
        return profiles()[identifier]
    except KeyError:
        known = ", ".join(sorted(profiles()))
        raise InputError.say(
            "there is no aircraft profile '{}'; known are: {}; your own can be a .toml file", identifier, known
        ) from None
