"""What several commands take in the same way: numbers, aircraft profile, seed; and wrong values in the user's words."""

from __future__ import annotations

import argparse
import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from planning.base.errors import InputError
from planning.base.files import PLAIN_ENDINGS, check_ending, check_folder_name
from planning.base.parameters import Declared, declared
from planning.base.plugins import Plugin, PluginGroup, installed_plugins
from planning.parameters import DEFAULT_PROFILE, LARGEST_SEED, PlanParameters

if TYPE_CHECKING:
    from groundstation.services.mission.readiness import FlightDay
    from planning.base.effects import EffectSetting

OPTIONS = {
    "photos_per_facade": "--photos-per-facade",
    "normal_step": "--normal-step",
    "n_points": "--points",
    "max_image_size_px": "--refine-size",
    "width_px": "--width",
    "n_square": "--square",
}
"""Options by the name that the records' own checks give a value, but for parameters that declare theirs."""


@contextmanager
def in_words_of_options(record: type[Any] = PlanParameters) -> Iterator[None]:
    """Turn a record's refusal of a value (`ValueError`) into an `InputError` that names the option typed.

    Parameters
    ----------
    record
        Whose parameters were typed.
    """
    try:
        yield
    except ValueError as error:
        name, colon, rest = str(error).partition(":")
        own = {each.parameter.name or each.path[-1]: each.parameter.option for each in declared(record).values()}
        raise InputError(f"{own.get(name) or OPTIONS.get(name, name)}{colon}{rest}") from error


def add_parameter(place: Any, each: Declared, *, unset: str = "") -> None:
    """Add the option of a parameter to a parser or a group of one; only what is typed stands in the options then.

    Words that can be listed are wrong usage unless they are; with a `metavar` the record itself refuses them.

    Parameters
    ----------
    unset
        What this command does where nothing is typed, if that is not the default.
    """
    known = replace(each.parameter, unset=unset or each.parameter.unset)
    each = replace(each, parameter=known)
    words = tuple(choice.typed for choice in known.choices)
    if each.kind is str and not words:
        words = known.suggested
    told = f"{known.help} ({_default_text(each)})" if _default_text(each) else known.help
    facts: dict[str, Any] = {"help": told.replace("%", "%%"), "default": argparse.SUPPRESS}
    if each.kind is bool and not words:
        place.add_argument(known.option, action="store_true", **facts)
        return
    if known.metavar:
        facts["metavar"] = known.metavar
    elif words:
        facts["choices"] = words
    place.add_argument(known.option, type={int: int, float: number}.get(each.kind, str), **facts)


def _default_text(each: Declared) -> str:
    """What counts where nothing is typed; "" where that goes without saying."""
    known = each.parameter
    if each.default is None:
        return f"default: {known.unset}" if known.unset else ""
    if each.kind is bool and not known.choices:
        return ""
    typed = next((choice.typed for choice in known.choices if choice.value == each.default), None)
    unit = f" {known.unit}" if known.unit not in ("", "share") else ""
    return f"default {f'{each.default:g}{unit}' if each.kind is float else typed or each.default}"


def typed_values(options: argparse.Namespace, record: type[Any]) -> dict[tuple[str, ...], Any]:
    """What was typed of a record's parameters, by their paths; see `with_values`."""
    found: dict[tuple[str, ...], Any] = {}
    for each in declared(record).values():
        name = each.parameter.option.removeprefix("--").replace("-", "_")
        if name and hasattr(options, name):
            typed = getattr(options, name)
            values = {choice.typed: choice.value for choice in each.parameter.choices}
            found[each.path] = values.get(typed, typed)
    return found


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


def add_profile_argument(parser: Any, *, has_default: bool = True) -> None:
    """Add `--profile`, to a parser or a group of one."""
    each = declared(PlanParameters)["profile_id"]
    parser.add_argument(
        each.parameter.option,
        default=DEFAULT_PROFILE if has_default else argparse.SUPPRESS,
        metavar=each.parameter.metavar,
        action=_Profile,
        help=f"{each.parameter.help}; '{each.parameter.option} list' shows all (default {DEFAULT_PROFILE})",
    )


class PluginNames(Collection[str]):
    """Names that an option takes: those of this program, and those of plug-ins, which are looked for only when asked.

    Parameters
    ----------
    own
        Of this program.
    groups
        Of the plug-ins.
    """

    def __init__(self, own: Iterable[str], *groups: PluginGroup) -> None:
        self._own, self._groups = tuple(own), groups

    def __contains__(self, name: object) -> bool:
        return name in self._own or any(plugin.name == name for plugin in self._plugins())

    def __iter__(self) -> Iterator[str]:
        return iter((*self._own, *(plugin.name for plugin in self._plugins())))

    def __len__(self) -> int:
        return len(self._own) + len(self._plugins())

    def _plugins(self) -> list[Plugin]:
        return [plugin for group in self._groups for plugin in installed_plugins(group)]

    def help_on_plugins(self) -> str:
        """Lines for the end of a help; empty where there are no plug-ins."""
        lines = [f"  {plugin.name:<13} {plugin.package}\n" for plugin in self._plugins()]
        return "".join(("\nfrom plug-ins:\n", *lines)) if lines else ""


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


def effect_settings(texts: Sequence[str], effects: Sequence[str]) -> dict[str, EffectSetting]:
    """Settings of `--effects`, by the names of `effects`.

    Raises
    ------
    InputError
        A text is no setting, or names none of the effects.
    """
    names = {effect.lower().replace(" ", "-"): effect for effect in effects}
    states: dict[str, EffectSetting] = {"auto": "auto", "on": "on", "off": "off"}
    all_at_once: dict[str, EffectSetting] = {"auto": "auto", "none": "off", "all": "on"}
    settings: dict[str, EffectSetting] = {}
    for text in (part for given in texts for part in given.split(",")):
        name, equals, state = text.strip().partition("=")
        if not equals and name in all_at_once:
            settings = dict.fromkeys(names.values(), all_at_once[name])
        elif name.lower().replace(" ", "-") in names and state in states:
            settings[names[name.lower().replace(" ", "-")]] = states[state]
        else:
            raise InputError(
                f"--effects {text}: expected auto, none, all, or NAME=on, off or auto; names are {', '.join(names)}"
            )
    return settings


def checked_seed(seed: int) -> int:
    """The seed, where all generators take it.

    Raises
    ------
    InputError
        It is negative or too large.
    """
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
