"""What several commands take in the same way: numbers, lists, profile, seed, poses, models; wrong values as typed."""

from __future__ import annotations

import argparse
import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from groundstation.cli.console import tell, worded
from planning.base.errors import InputError
from planning.base.files import PLAIN_ENDINGS, check_ending, check_folder_name
from planning.base.messages import about, say, without_place
from planning.base.parameters import Declared, declared, with_values
from planning.base.plugins import Plugin, PluginGroup, installed_plugins
from planning.parameters import DEFAULT_PROFILE, PlanParameters

if TYPE_CHECKING:
    from datetime import datetime

    from groundstation.services.mission.readiness import FlightDay
    from groundstation.services.photos.poses import RefinedOutcome, RefineRequest
    from groundstation.services.photos.segmentation import ScoreRequest
    from planning.base.effects import EffectSetting
    from planning.site.importing.options import ImportOptions
    from reconstruction.panels.search.parameters import SegmentationParameters


# Numbers, and values with commas, for argparse's `type`: wrong ones are refused in the words that were typed.


def words(text: str) -> tuple[str, ...]:
    """Words such as `a,b`, each once; at least one."""
    found = tuple(dict.fromkeys(word.strip() for word in text.split(",") if word.strip()))
    if not found:
        raise argparse.ArgumentTypeError(worded(say("expected a list such as a,b, got '{}'", text)))
    return found


def above_zero(text: str) -> float:
    """A finite number above 0."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value > 0.0):
        raise argparse.ArgumentTypeError(worded(say("expected a number above 0, got '{}'", text)))
    return value


def numbers(text: str) -> tuple[float, ...]:
    """Finite numbers above 0, such as `30,7.5`."""
    return tuple(above_zero(word) for word in words(text))


def count(text: str) -> int:
    """A whole number of 1 or more."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(worded(say("expected a whole number of 1 or more, got '{}'", text)))
    return int(text)


def counts(text: str) -> tuple[int, ...]:
    """Whole numbers of 1 or more, such as `1,2,4`."""
    return tuple(count(word) for word in words(text))


def wholes(text: str) -> tuple[int, ...]:
    """Whole numbers, such as `32,128,0`."""
    found = words(text)
    if not all(word.isdecimal() for word in found):
        raise argparse.ArgumentTypeError(worded(say("expected whole numbers such as 32,128,0, got '{}'", text)))
    return tuple(map(int, found))


OPTIONS = {
    "photos_per_facade": "--photos-per-facade",
    "normal_step": "--normal-step",
    "n_points": "--points",
    "max_image_size_px": "--refine-size",
    "width_px": "--width",
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
        refused = str(error)
        name, colon, _ = refused.partition(": ")
        own = {each.parameter.name or each.path[-1]: each.parameter.option for each in declared(record).values()}
        message = without_place(refused, name)
        raise InputError(about(own.get(name) or OPTIONS.get(name, name), message) if colon else refused) from error


def add_parameter(place: Any, each: Declared, *, unset: str = "") -> argparse.Action:
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
    help_text = f"{known.help} ({_default_text(each)})" if _default_text(each) else known.help
    facts: dict[str, Any] = {"help": help_text.replace("%", "%%"), "default": argparse.SUPPRESS}
    if each.kind is bool and not words:
        return cast("argparse.Action", place.add_argument(known.option, action="store_true", **facts))
    if known.metavar:
        facts["metavar"] = known.metavar
    elif words:
        facts["choices"] = words
    kind = {int: int, float: seconds if known.unit == "s" else number}.get(each.kind, str)
    return cast("argparse.Action", place.add_argument(known.option, type=kind, **facts))


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
        raise argparse.ArgumentTypeError(worded(say("expected a number, got '{}'", text)))
    return value


def seconds(text: str) -> float:
    """A finite time, also as shutter times are written: `1/500`."""
    whole, slash, parts = text.partition("/")
    if not slash:
        return number(text)
    try:
        return number(whole) / number(parts)
    except (ZeroDivisionError, argparse.ArgumentTypeError):
        raise argparse.ArgumentTypeError(
            worded(say("expected a time such as 1/500 or 0.002, got '{}'", text))
        ) from None


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
        self._own, self._groups = tuple(map(str, own)), groups  # what is listed is a name, no member of an enum

    def __contains__(self, name: object) -> bool:
        return name in self._own or any(plugin.name == name for plugin in self._plugins())

    def __iter__(self) -> Iterator[str]:
        return iter((*self._own, *(plugin.name for plugin in self._plugins())))

    def __len__(self) -> int:
        return len(self._own) + len(self._plugins())

    def _plugins(self) -> list[Plugin]:
        return [plugin for group in self._groups for plugin in installed_plugins(group)]

    def help_on_plugins(self) -> str:
        """Lines for the end of a help: plug-ins, each of which is tried; empty where none can be used."""
        if not self._plugins():
            return ""
        from groundstation.services.plugins import plugin_rows

        usable = [row.plugin for row in plugin_rows() if row.plugin.group in self._groups and row.problem is None]
        lines = [f"  {plugin.name:<13} {plugin.package}\n" for plugin in usable]
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
        tell(
            "{:<10} {}, {:.0f} min, {:g} m/s, wind up to {:g} m/s; {}, {} x {}, {:g} mm, gimbal {:g} to {:g} deg",
            identifier,
            aircraft.name,
            aircraft.endurance_s / 60,
            aircraft.max_speed_m_s,
            aircraft.max_wind_m_s,
            camera.name,
            camera.image_width_px,
            camera.image_height_px,
            camera.focal_length_mm,
            low,
            high,
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
    for text in (part for argument in texts for part in argument.split(",")):
        name, equals, state = text.strip().partition("=")
        if not equals and name in all_at_once:
            settings = dict.fromkeys(names.values(), all_at_once[name])
        elif name.lower().replace(" ", "-") in names and state in states:
            settings[names[name.lower().replace(" ", "-")]] = states[state]
        else:
            raise InputError(
                say(
                    "expected auto, none, all, or NAME=on, off or auto; names are {}",
                    ", ".join(names),
                    place=f"--effects {text}",
                )
            )
    return settings


def checked_seed(seed: int) -> int:
    """The seed, where all generators take it.

    Raises
    ------
    InputError
        It is negative or too large.
    """
    with in_words_of_options():
        declared(PlanParameters)["seed"].parameter.check("seed", seed)
    return seed


def add_time(parser: argparse.ArgumentParser) -> None:
    """The option that says when the flight is."""
    parser.add_argument(
        "--at",
        metavar="TIME",
        help="take-off of the first sortie, such as 2026-06-21T10:30 or 2026-06-21T10:30+02:00",
    )


def add_day(parser: argparse.ArgumentParser) -> None:
    """Options that say what is known of the day of the flight."""
    add_time(parser)
    add = parser.add_argument
    add("--temperature", type=number, metavar="C", help="of air and batteries, degrees Celsius")


def planned_time(options: argparse.Namespace) -> datetime | None:
    """The time of the flight as the options say it, None where they do not; local without a time zone.

    Raises
    ------
    InputError
        It is no time.
    """
    from datetime import datetime

    if options.at is None:
        return None
    try:
        moment = datetime.fromisoformat(options.at) if "T" in options.at else None
        at = moment.astimezone() if moment is not None and moment.tzinfo is None else moment
    except (ValueError, OverflowError, OSError):
        at = None
    if at is None:
        raise InputError(say("expected a time such as 2026-06-21T10:30, got '{}'", options.at, place="--at"))
    return at


def flight_day(options: argparse.Namespace) -> FlightDay:
    """The day as the options say it.

    Raises
    ------
    InputError
        They are no time, or no temperature.
    """
    from groundstation.services.mission.readiness import FlightDay

    at = planned_time(options)
    try:
        return FlightDay(at, options.temperature)
    except ValueError as error:
        reason = str(error)
        raise InputError(about("--temperature", without_place(reason, reason.partition(": ")[0]))) from error


# Where poses of photos come from, as several commands take it.


def add_pose_arguments(parser: Any) -> None:
    """Add `--colmap`, `--refine` and what belongs to them, and `--heights`."""
    source = parser.add_mutually_exclusive_group()
    source.add_argument(
        "--colmap",
        type=Path,
        metavar="FOLDER",
        help="COLMAP model (or transforms.json) of the photos, for better poses",
    )
    source.add_argument(
        "--refine",
        action="store_true",
        help="refine the poses with COLMAP (needs pycolmap); computed once, kept in PHOTOS.refined beside the photos",
    )
    add = parser.add_argument
    add("--refined", type=Path, metavar="FOLDER", help="keep refined poses in this folder instead (with --refine)")
    add(
        "--refine-size",
        type=int,
        metavar="PX",
        help="longer side that photos are reduced to for refining: smaller is quicker, larger better (default 1600)",
    )
    add(
        "--find-lens",
        choices=("auto", "on", "off"),
        help="with --refine, find the lens from the photos; auto: a calibration stays unless they contradict it",
    )
    add("--heights", choices=("auto", "takeoff", "absolute"), default="auto", help="which heights of photos count")


def refine_request(options: argparse.Namespace) -> RefineRequest | None:
    """What was asked for; None without `--refine`.

    Raises
    ------
    InputError
        An option that belongs to `--refine` stands without it, or its value is out of range.
    """
    from groundstation.services.photos.poses import RefineRequest

    if options.refine:
        with in_words_of_options():
            return RefineRequest(options.refined, options.refine_size, options.find_lens)
    others = {"--refined": options.refined, "--refine-size": options.refine_size, "--find-lens": options.find_lens}
    for option, value in others.items():
        if value is not None:
            raise InputError(say("belongs to --refine, which was not given", place=option))
    return None


def print_refined(outcome: RefinedOutcome | None) -> None:
    """Say where refined poses are kept."""
    if outcome is not None:
        tell("refined poses{}", say(", computed before") if outcome.was_kept else "", place=outcome.folder)


# Settings of the search for panels, as several commands take them.


def parameters_of(options: argparse.Namespace) -> SegmentationParameters:
    """Settings from a file, changed by what else was typed.

    Raises
    ------
    InputError
        The file cannot be read, or a value is out of range.
    """
    from reconstruction.panels.search.parameters import SegmentationParameters, read_parameters

    base = SegmentationParameters() if options.parameters is None else read_parameters(options.parameters)
    with in_words_of_options(SegmentationParameters):
        return with_values(base, typed_values(options, SegmentationParameters))


# Models of buildings: where they are, what of them counts, and the airspace about them.


def point(text: str) -> tuple[float, float, float]:
    """Three numbers with commas between them, for argparse."""
    parts = text.split(",")
    if len(parts) != 3:
        raise argparse.ArgumentTypeError(worded(say("expected three numbers with commas between them, got '{}'", text)))
    return number(parts[0]), number(parts[1]), number(parts[2])


def add_place_and_content(command: argparse.ArgumentParser) -> None:
    """Where a model is and what of it counts."""
    place = command.add_argument_group("where it is (instead of what the file says)").add_argument
    place("--origin", type=point, metavar="LAT,LON,H", help="place of the file's zero point (H: --height-reference)")
    place("--crs", help="coordinate reference system of the file's coordinates, such as EPSG:25832+7837")
    place("--axis-order", choices=("auto", "xy", "yx"), default="auto", help="xy: east first, yx: north first")
    place(
        "--height-reference",
        choices=("auto", "orthometric", "ellipsoid"),
        default="auto",
        help="heights are above sea level, the ellipsoid, or what the system says (auto; for --origin the ellipsoid)",
    )
    place(
        "--ground",
        type=number,
        metavar="Z",
        help="the ground's third coordinate in the file, in metres where it has no system (default: found around the "
        "building; you are asked where two heights may be it)",
    )
    content = command.add_argument_group("what is in the file").add_argument
    content("--building", metavar="ID", help="the building wanted, in a CityGML or CityJSON file with many")
    content("--units", default="m", choices=("m", "cm", "mm", "ft", "in", "us-ft"), help="of a mesh file (default m)")
    content("--up", choices=("y", "z"), help="axis that points up in a mesh file (default: y for GLB, else z)")
    content("--deflection", type=number, default=0.005, metavar="M", help="of curved IFC surfaces (default 0.005 m)")


def add_flight(command: argparse.ArgumentParser) -> None:
    """Airspace and home of a new site."""
    flight = command.add_argument_group("airspace and home (local metres east, north, up)").add_argument
    flight("--home", type=point, metavar="E,N,U", help="take-off place (default: in front of the largest facade)")
    flight("--airspace-margin", type=number, default=40.0, metavar="M", help="around the building (default 40 m)")
    flight("--floor", type=number, metavar="U", help="of the airspace (default: 2 m above ground)")
    flight("--min-height", type=number, metavar="M", help="lowest flight above the ground to be planned (default 5 m)")
    flight("--ceiling", type=number, metavar="U", help="of the airspace (default: 30 m above the building)")


def import_options(options: argparse.Namespace) -> ImportOptions:
    """What the user said about a model, but for panels.

    Raises
    ------
    InputError
        The origin is no place on earth.
    """
    from planning.geo.frames import Origin
    from planning.site.importing.options import ImportOptions

    try:
        origin = None if options.origin is None else Origin(*options.origin)
    except ValueError as error:
        raise InputError(about("--origin", error)) from error
    return ImportOptions(
        name=options.name,
        origin=origin,
        crs=options.crs,
        axis_order=options.axis_order,
        height_reference=options.height_reference,
        up=options.up,
        unit=options.units,
        building=options.building,
        ground_z=options.ground,
        home_enu_m=options.home,
        airspace_margin_m=options.airspace_margin,
        floor_m=options.floor,
        min_height_m=options.min_height,
        ceiling_m=options.ceiling,
        deflection_m=options.deflection,
    )


# Photos with truth.

SETS = ("made-planar", "made-curved", "made-irregular", "cmp", "ecp", "offices", "folder")

MIN_WIDTH_PX, MAX_WIDTH_PX = 160, 16_000


def add_set_arguments(parser: Any) -> None:
    """Photos with truth."""
    add = parser.add_argument_group("photos with truth").add_argument
    add("--set", dest="set_name", choices=SETS, default=SETS[0], help="default: %(default)s")
    add("--seeds", type=int, default=10, metavar="N", help="photos of a synthetic set (default %(default)s)")
    add("--first-seed", type=int, default=0, metavar="N", help="of a synthetic set (default %(default)s)")
    add("--width", type=int, default=1600, metavar="PX", help="of photos of a synthetic set (default %(default)s)")
    add("--extent-unknown", action="store_true", help="do not tell where the walls of a synthetic set end")
    add("--data", type=Path, metavar="DIR", help="folder of cmp, ecp or offices")
    add("--images", type=Path, metavar="DIR", help="your photos")
    add("--truth", type=Path, metavar="DIR", help="your index images")
    add("--rectified", action="store_true", help="your photos are fronto-parallel")


def score_request(options: argparse.Namespace) -> ScoreRequest:
    """The photos with truth, and how panels are looked for in them.

    Raises
    ------
    InputError
        A value is out of range, or a settings file cannot be read.
    """
    from groundstation.services.photos.segmentation import ScoreRequest

    if options.seeds < 1:
        raise InputError(say("expected 1 or more, got {}", options.seeds, place="--seeds"))
    if options.first_seed < 0:
        raise InputError(say("expected 0 or more, got {}", options.first_seed, place="--first-seed"))
    if not MIN_WIDTH_PX <= options.width <= MAX_WIDTH_PX:
        raise InputError(
            say("expected {} to {} pixels, got {}", MIN_WIDTH_PX, MAX_WIDTH_PX, options.width, place="--width")
        )
    return ScoreRequest(
        options.set_name,
        options.seeds,
        options.width,
        not options.extent_unknown,
        options.data,
        options.images,
        options.truth,
        options.rectified,
        parameters=parameters_of(options),
        first_seed=options.first_seed,
    )
