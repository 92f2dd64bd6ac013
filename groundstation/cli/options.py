"""What several commands take in the same way: numbers, aircraft profile, seed; and wrong values in the user's words."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from planning.base.errors import InputError
from planning.base.folders import PLAIN_ENDINGS, check_ending, check_folder_name

if TYPE_CHECKING:
    from groundstation.services.mission.readiness import FlightDay
    from planning.base.effects import Wish

OPTIONS = {
    "views": "--views",
    "coverage": "--coverage",
    "batteries": "--batteries",
    "time budget": "--time-budget",
    "seed": "--seed",
    "min_distance_m": "--min-distance",
    "min_height_above_ground_m": "--min-height",
    "max_distance_m": "--max-distance",
    "wanted_gsd_mm": "--wanted-gsd",
    "section_step_deg": "--step",
    "battery_reserve": "--reserve",
    "settle_s": "--settle",
    "max_speed_m_s": "--speed",
    "wind_m_s": "--wind",
    "photos_per_facade": "--photos-per-facade",
    "normal_step": "--normal-step",
    "n_points": "--points",
    "max_image_size_px": "--refine-size",
    "width_px": "--width",
    "n_square": "--square",
}
"""Options by the name that the records' own checks give a value."""


@contextmanager
def in_words_of_options() -> Iterator[None]:
    """Turn a record's refusal of a value (`ValueError`) into an `InputError` that names the option typed."""
    try:
        yield
    except ValueError as error:
        name, colon, rest = str(error).partition(":")
        raise InputError(f"{OPTIONS.get(name, name)}{colon}{rest}") from error


def number(text: str) -> float:
    """A finite number; for argparse's `type`, so that NaN and infinity are wrong usage like any other word."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"expected a number, got '{text}'")
    return value


def json_file(text: str) -> Path:
    """Where a JSON file is to be written; for argparse's `type`.

    Raises
    ------
    InputError
        The name says that something else is in the file.
    """
    path = Path(text)
    check_ending(path, (".json",), (*PLAIN_ENDINGS, ".plan"))
    return path


def new_folder(text: str) -> Path:
    """Where a folder is to be written; for argparse's `type`.

    Raises
    ------
    InputError
        The name says that it is a file.
    """
    path = Path(text)
    check_folder_name(path)
    return path


def add_profile_argument(parser: Any) -> None:
    """Add `--profile`, to a parser or a group of one."""
    parser.add_argument(
        "--profile",
        default="m3e",
        metavar="ID",
        action=_Profile,
        help="aircraft and camera (default m3e), or a .toml file with your own; '--profile list' shows all",
    )


class _Profile(argparse.Action):
    """Takes the identifier of a profile, or for `list` prints all and ends."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: str | Sequence[Any] | None,
        option_string: str | None = None,
    ) -> None:
        if values == "list":
            _print_profiles()
            parser.exit()
        setattr(namespace, self.dest, values)


def _print_profiles() -> None:
    from planning.aircraft.catalogue import profiles

    for identifier, profile in profiles().items():
        aircraft, camera = profile.aircraft, profile.camera
        low, high = camera.gimbal_pitch_deg
        print(
            f"{identifier:<10} {aircraft.name}, {aircraft.endurance_s / 60:.0f} min, {aircraft.max_speed_m_s:g} m/s, "
            f"wind up to {aircraft.max_wind_m_s:g} m/s; {camera.name}, {camera.image_width_px} x "
            f"{camera.image_height_px}, {camera.focal_length_mm:g} mm, gimbal {low:g} to {high:g} deg"
        )


def effect_wishes(texts: Sequence[str], effects: Sequence[str]) -> dict[str, Wish]:
    """Wishes of `--effects`, by the names of `effects`.

    Raises
    ------
    InputError
        A text is no wish, or names none of the effects.
    """
    names = {effect.lower().replace(" ", "-"): effect for effect in effects}
    states: dict[str, Wish] = {"auto": "auto", "on": "on", "off": "off"}
    all_at_once: dict[str, Wish] = {"auto": "auto", "none": "off", "all": "on"}
    wishes: dict[str, Wish] = {}
    for text in (part for given in texts for part in given.split(",")):
        name, equals, state = text.strip().partition("=")
        if not equals and name in all_at_once:
            wishes = dict.fromkeys(names.values(), all_at_once[name])
        elif name.lower().replace(" ", "-") in names and state in states:
            wishes[names[name.lower().replace(" ", "-")]] = states[state]
        else:
            raise InputError(
                f"--effects {text}: expected auto, none, all, or NAME=on, off or auto; names are {', '.join(names)}"
            )
    return wishes


def checked_seed(seed: int) -> int:
    """The seed, where all generators take it.

    Raises
    ------
    InputError
        It is negative or too large.
    """
    from planning.request import LARGEST_SEED  # not at the top: describing a command needs no numerics

    if not 0 <= seed <= LARGEST_SEED:
        raise InputError(f"--seed: expected 0 to {LARGEST_SEED}, got {seed}")
    return seed


def add_day(parser: argparse.ArgumentParser) -> None:
    """Options that say what is known of the day of the flight."""
    add = parser.add_argument
    add("--at", metavar="TIME", help="middle of the flight, such as 2026-06-21T10:30 or 2026-06-21T10:30+02:00")
    add("--temperature", type=number, metavar="C", help="of air and batteries, degrees Celsius")


def flight_day(options: argparse.Namespace) -> FlightDay:
    """The day as the options say it.

    Raises
    ------
    InputError
        They are no time, or no temperature.
    """
    from datetime import datetime

    from groundstation.services.mission.readiness import FlightDay

    at = None
    if options.at is not None:
        try:
            given = datetime.fromisoformat(options.at) if "T" in options.at else None
            at = given.astimezone() if given is not None and given.tzinfo is None else given
        except (ValueError, OverflowError, OSError):
            at = None
        if at is None:
            raise InputError(f"--at: expected a time such as 2026-06-21T10:30, got '{options.at}'")
    try:
        return FlightDay(at, options.temperature)
    except ValueError as error:
        raise InputError(f"--temperature: {str(error).partition(': ')[2]}") from error
