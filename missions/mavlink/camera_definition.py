"""Camera definition files: the parameters of a camera that speaks MAVLink's camera protocol, with their options.

The file is XML (mavlink.io, "Camera Definition File"), as it stands or packed by xz. It comes from whoever is on the
link or made the camera: document types, entities, what is nested deeply or unpacks to more than `MAX_BYTES` is refused,
and so is a definition that contradicts itself. Its texts are shown, never interpreted.
"""

from __future__ import annotations

import lzma
import math
import operator
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from planning.base.errors import InputError
from planning.base.files import FileLimit, HostileXml, parse_xml, read_input_file
from planning.base.messages import say

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

MAX_BYTES = 1 << 20
"""Of the XML; those of real cameras have some 10 to 100 kB."""

MAX_PARAMETERS, MAX_OPTIONS = 500, 1000
MAX_TEXT = 100
XZ_MAGIC, XZ_MEMORY = b"\xfd7zXZ\0", 64 << 20

KINDS = {
    "uint8": 1, "int8": 2, "uint16": 3, "int16": 4, "uint32": 5, "int32": 6, "uint64": 7, "int64": 8, "float": 9,
    "double": 10, "custom": 11, "string": 11, "bool": 1,
}  # fmt: skip
"""MAV_PARAM_EXT_TYPE by the word of the file."""

CUSTOM = 11

_NAME = re.compile(r"[A-Za-z0-9_.\-]{1,16}", re.ASCII)
_TERM = re.compile(r"([A-Za-z0-9_.\-]{1,16})\s*(!=|=|<|>)\s*(\S+)", re.ASCII)


@dataclass(frozen=True, slots=True)
class CameraOption:
    """A value that a parameter can have, by its name for people."""

    name: str
    value: float

    def has(self, value: float) -> bool:
        """Whether this is the option for a value: those of type float come back rounded."""
        return _is_equal(self.value, value)


def _is_equal(one: float, other: float) -> bool:
    return math.isclose(one, other, rel_tol=1e-5, abs_tol=1e-6)


_COMPARISONS: dict[str, Callable[[float, float], bool]] = {
    "=": _is_equal,
    "!=": lambda one, other: not _is_equal(one, other),
    "<": operator.lt,
    ">": operator.gt,
}


@dataclass(frozen=True, slots=True)
class CameraParameter:
    """A parameter of a camera.

    Parameters
    ----------
    kind
        MAV_PARAM_EXT_TYPE.
    options
        All that it can have; empty where any number between `least` and `most` may be set.
    is_settable
        It is not to be read only, and a number.
    default
        What it has from the maker; None where the file does not say it.
    """

    name: str
    kind: int
    description: str = ""
    options: tuple[CameraOption, ...] = ()
    least: float = -math.inf
    most: float = math.inf
    is_settable: bool = True
    default: float | None = None


@dataclass(frozen=True, slots=True)
class CameraRule:
    """What a parameter can have while others have certain values.

    Parameters
    ----------
    parameter
        Its name.
    when
        Parameter, comparison and value, which all have to hold in one of the alternatives.
    options
        What is left of its options then; none where it has no effect.
    """

    parameter: str
    when: tuple[tuple[tuple[str, str, float], ...], ...]
    options: tuple[CameraOption, ...] = ()

    def holds(self, values: Mapping[str, float]) -> bool:
        """Whether it counts while parameters have these values; what a value is not known of does not hold."""
        return any(
            all(name in values and _COMPARISONS[sign](values[name], value) for name, sign, value in each)
            for each in self.when
        )


@dataclass(frozen=True, slots=True)
class CameraDefinition:
    """What a camera says of itself."""

    model: str
    vendor: str
    parameters: tuple[CameraParameter, ...]
    rules: tuple[CameraRule, ...] = ()

    @property
    def defaults(self) -> dict[str, float]:
        """What parameters have from the maker."""
        return {each.name: each.default for each in self.parameters if each.default is not None}

    def rulers_of(self, names: Collection[str]) -> tuple[str, ...]:
        """Parameters on whose values it depends what these can have."""
        rules = (rule for rule in self.rules if rule.parameter in names)
        return tuple(dict.fromkeys(name for rule in rules for each in rule.when for name, _, _ in each))

    def left_of(self, parameter: CameraParameter, values: Mapping[str, float]) -> CameraParameter | None:
        """A parameter with the options that these values of others leave it; None where they leave none."""
        for rule in self.rules:
            if rule.parameter != parameter.name or not rule.holds(values):
                continue
            numbers = [option.value for option in rule.options]
            left = tuple(option for option in parameter.options if any(map(option.has, numbers)))
            options = left if parameter.options else rule.options
            if not options:
                return None
            parameter = replace(parameter, options=options)
        return parameter


def parse_definition(content: bytes, place: object) -> CameraDefinition:
    """A camera's definition.

    Parameters
    ----------
    place
        File or camera that it is from, for messages.

    Raises
    ------
    InputError
        It is none, too large, hostile or contradicts itself.
    """
    try:
        root = parse_xml(_unpacked(content, place), place)
    except HostileXml as error:
        raise InputError.say("{}; no camera needs that", error, place=place) from error
    except ValueError as error:
        raise InputError.say("is no camera definition: no XML ({})", str(error), place=place) from error
    if root.tag != "mavlinkcamera":
        raise InputError.say(
            "is no camera definition: expected <mavlinkcamera>, got <{}>", _text(root.tag), place=place
        )
    elements = root.findall("parameters/parameter")
    if len(elements) > MAX_PARAMETERS:
        raise InputError.say("names {} parameters; expected at most {}", len(elements), MAX_PARAMETERS, place=place)
    parameters = tuple(_parameter(element, place) for element in elements)
    names = [parameter.name for parameter in parameters]
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise InputError.say("names the parameter '{}' twice", twice, place=place)
    rules = tuple(rule for element in elements for rule in _rules(element))
    model, vendor = (_text(root.findtext(f"definition/{name}") or "") for name in ("model", "vendor"))
    return CameraDefinition(model, vendor, parameters, rules)


def _unpacked(content: bytes, place: object) -> bytes:
    if content.startswith(XZ_MAGIC):
        try:
            unpacker = lzma.LZMADecompressor(lzma.FORMAT_XZ, memlimit=XZ_MEMORY)
            content = unpacker.decompress(content, MAX_BYTES + 1)
        except (lzma.LZMAError, EOFError) as error:
            raise InputError.say("cannot be unpacked ({})", str(error), place=place) from error
    if len(content) > MAX_BYTES:
        raise InputError.say("is larger than {} kB, which no camera definition is", MAX_BYTES >> 10, place=place)
    return content


def _parameter(element: Element, place: object) -> CameraParameter:
    name, kind = element.get("name", ""), KINDS.get(element.get("type", "").strip().lower())
    if not _NAME.fullmatch(name):
        raise InputError.say("has a parameter without a name that MAVLink can carry: '{}'", _text(name), place=place)
    if kind is None:
        found = _text(element.get("type", ""))
        raise InputError.say("'{}' has the type '{}', which MAVLink does not know", name, found, place=place)
    elements = element.findall("options/option")
    if len(elements) > MAX_OPTIONS:
        raise InputError.say("'{}' has {} options; expected at most {}", name, len(elements), MAX_OPTIONS, place=place)
    options = tuple(CameraOption(*each) for each in _options(elements, name, kind, place))
    least, most = (_number(element.get(key), unset) for key, unset in (("min", -math.inf), ("max", math.inf)))
    if math.isnan(least) or math.isnan(most) or least > most:
        raise InputError.say("'{}' has a range that is none", name, place=place)
    is_read_only = element.get("readonly", "0").strip() not in ("", "0", "false")
    description = _text(element.findtext("description") or "")
    is_settable = kind != CUSTOM and not is_read_only
    default = _number(element.get("default"), math.nan)
    return CameraParameter(
        name, kind, description, options, least, most, is_settable, None if math.isnan(default) else default
    )


def _rules(element: Element) -> Iterator[CameraRule]:
    """What the options of a parameter say about others, once the parameters themselves were read."""
    for option in element.findall("options/option"):
        value = _number(option.get("value"), math.nan)
        if math.isnan(value):
            continue
        own = (element.get("name", ""), "=", value)
        for each in option.findall("exclusions/exclude"):
            yield CameraRule((each.text or "").strip(), ((own,),))
        for each in option.findall("parameterranges/parameterrange"):
            options = ((_text(left.get("name", "")), _number(left.get("value"), math.nan)) for left in each)
            left = tuple(CameraOption(name, number) for name, number in options if not math.isnan(number))
            when = tuple((own, *terms) for terms in _alternatives(each.get("condition", "")))
            yield CameraRule(each.get("parameter", "").strip(), when, left)


def _alternatives(condition: str) -> list[tuple[tuple[str, str, float], ...]]:
    """A condition such as 'CAM_EXPMODE=1 AND CAM_ISO!=0 OR ...'; what cannot be read of it counts as held."""
    found = []
    for alternative in re.split(r"\s+OR\s+", condition.strip()):
        terms = (_TERM.fullmatch(term.strip()) for term in re.split(r"\s+AND\s+", alternative))
        read = [(term[1], term[2], _number(term[3], math.nan)) for term in terms if term is not None]
        found.append(tuple(term for term in read if not math.isnan(term[2])))
    return found


def _options(elements: Sequence[Element], name: str, kind: int, place: object) -> Iterator[tuple[str, float]]:
    for each in elements:
        value = _number(each.get("value"), math.nan)
        if kind != CUSTOM and math.isnan(value):
            raise InputError.say("'{}' has an option that is no number", name, place=place)
        if not math.isnan(value):
            yield _text(each.get("name", "")), value


def _number(text: str | None, unset: float) -> float:
    """A number, also in hexadecimal; `unset` where there is none, NaN where it is no finite number."""
    if text is None or not text.strip():
        return unset
    words = text.strip().lower()
    if words in ("true", "false"):
        return float(words == "true")
    try:
        value = float(int(words, 16)) if re.fullmatch(r"0x[0-9a-f]{1,16}", words) else float(words)
    except ValueError:
        return math.nan
    return value if math.isfinite(value) else math.nan


def _text(text: str) -> str:
    """A text of the file, for people: one line, at most `MAX_TEXT` letters."""
    return "".join(letter if letter.isprintable() else " " for letter in " ".join(text.split()))[:MAX_TEXT]


# Which of a camera's parameters means what, and which of its options a value is

SAME = 0.02
"""Of shutter times, apertures and ISO: files write 0.016666 for 1/60. Steps of a third are 12 to 26 % apart."""

SAME_EV = 0.06
"""Of compensations, which go through 0: thirds of a stop are written as 0.3."""

_FRACTION = re.compile(r"(\d+)\s*/\s*(\d+(?:\.\d+)?)")
_DECIMAL = re.compile(r"[-+]?\d+(?:\.\d+)?")


def find_parameter(definition: CameraDefinition, names: Sequence[str], words: Sequence[str]) -> CameraParameter | None:
    """The parameter of one of some names; else the only one that can be set whose description begins so or holds it.

    Parameters
    ----------
    words
        Regular expressions over descriptions, without regard to case.
    """
    by_name = {parameter.name.upper(): parameter for parameter in definition.parameters if parameter.is_settable}
    named = next((by_name[name] for name in names if name in by_name), None)
    if named is not None:
        return named
    found = [
        parameter
        for parameter in by_name.values()
        if any(re.search(word, parameter.description, re.IGNORECASE) for word in words)
    ]
    return found[0] if len(found) == 1 else None


def value_of(parameter: CameraParameter, wanted: float | str, absolute: float = 0.0) -> CameraOption | None:
    """The value that a parameter has to have for a number or a word; None where the camera has none such.

    Of options the name tells, since values may be no more than their numbers; the value itself where no name does.

    Parameters
    ----------
    absolute
        How far a number may lie from the one that is wanted; 0: `SAME` of it.
    """
    if isinstance(wanted, str):
        return next((each for each in parameter.options if _is_word(each.name, wanted)), None)

    def is_same(found: float) -> bool:
        return math.isclose(found, wanted, rel_tol=0.0 if absolute else SAME, abs_tol=absolute)

    if not parameter.options:
        return CameraOption(f"{wanted:g}", wanted) if parameter.least <= wanted <= parameter.most else None
    named = [(each, _quantity(each.name)) for each in parameter.options]
    meant = [each for each, quantity in named if quantity is not None and is_same(quantity)]
    if not meant and all(quantity is None for _, quantity in named):
        meant = [each for each in parameter.options if is_same(each.value)]
    return meant[0] if meant else None


def _quantity(name: str) -> float | None:
    """The number in the name of an option: '1/500 s', 'f/5.6', 'ISO 100', '+0.3 EV'; None for none."""
    fraction = _FRACTION.search(name)
    if fraction:
        divisor = float(fraction[2])
        return float(fraction[1]) / divisor if divisor else None
    number = _DECIMAL.search(name)
    return None if number is None else float(number[0])


WORDS = {
    "manual": ("manual", "m"),
    "auto": ("auto", "automatic", "program", "p"),
    "sunny": ("sunny", "daylight", "sun", "sunlight"),
    "cloudy": ("cloudy", "cloud", "overcast"),
}
"""How cameras name what is wanted."""


def _is_word(name: str, wanted: str) -> bool:
    return name.strip().lower().removesuffix(" mode").removesuffix(" exposure") in WORDS.get(wanted, (wanted,))


DEFINITION_FILE = FileLimit(say("a camera definition"), MAX_BYTES)


def read_definition(path: Path) -> CameraDefinition:
    """The definition in a file.

    Raises
    ------
    InputError
        As `parse_definition`, or it cannot be read.
    """
    return parse_definition(read_input_file(path, DEFINITION_FILE), path)
