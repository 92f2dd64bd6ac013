"""Messages put into the user's language and units, where they are shown.

Everything below makes English text with metric values, as `planning.base.messages.Message`. Here its template is
translated, its values go into the translation, and quantities into the units that the user reads.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

import groundstation
from groundstation.services.units import UnitSystem, area_unit, distance_unit, length_unit, sampling_unit, speed_unit
from planning.base.messages import Message

# Messages in the words of the window: fields by their label instead of command-line options.
#
# The parts without Qt say what to do as the command line does; whoever shows it knows what its fields are called.

_OPTION = re.compile(
    r"(?P<option>--[a-z]+(?:-[a-z]+)*)"
    # What stands for, or is, its value: 'a quoted text', WORDS,IN,CAPITALS with or without a code, a number.
    r"(?P<value> '[^']*'| EPSG:CODE| [A-Z]+(?:,[A-Z]+)*\b| -?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w.]*,))?"
)


def with_window_labels(text: str, labels: Mapping[str, str], quoted: str = "“{0}”") -> str:
    """A message with the label of a field in place of each option and of the placeholder behind it.

    Parameters
    ----------
    labels
        By option, such as `--origin`; one without a label stays as it is.
    quoted
        A label as it stands in a sentence.
    """

    def replaced(found: re.Match[str]) -> str:
        label = labels.get(found["option"])
        return found[0] if label is None else quoted.format(label)

    # The three options of a grid are one step in the window.
    text = re.sub(r"--panel-grid '[^']*' --rows \w+ --columns \w+", "--panel-grid", text)
    return _OPTION.sub(replaced, text)


_OPTION_IN_BRACKETS = re.compile(rf" \({_OPTION.pattern}\)".replace("?P<option>", "?:").replace("?P<value>", "?:"))


def on_paper(text: str) -> str:
    """A message without the options in brackets that say how it is typed: nobody types on paper."""
    return _OPTION_IN_BRACKETS.sub("", text)


Translate = Callable[[str], str]
"""A template in the user's language; the template itself where there is no translation."""

LANGUAGES = ("en", "de")
"""English is in the code; the others are read from Qt's files of translations."""

FIELD = re.compile(r"\{(\d+)(?::(m))?\}")

_NUMBER = r"-?(?:inf|nan|\d+(?:\.\d+)?(?:e[+-]?\d+)?)"
_IS_NUMBER = re.compile(_NUMBER)
_QUANTITY = re.compile(
    # One number or two ("3 to 5 m"), or the bracket of coordinates that are converted already.
    rf"(?:(?<![\w.])(?P<first>{_NUMBER})(?:(?P<between> to | bis | x )(?P<second>{_NUMBER}))?|(?<=\)))"
    r" (?P<unit>m/s|mm|km|m2|m)(?![\w/])"
)

_HELD = 0xE000
_HELD_PLACES = re.compile(f"[{chr(_HELD)}-{chr(_HELD + 99)}]")
"""Private characters that stand for values while the units of a sentence are changed."""


@cache
def translation(language: str, context: str = "Sentences") -> Translate:
    """What a text of a context is in a language, without Qt: for the command line."""
    if language == LANGUAGES[0]:
        return str
    from xml.etree import ElementTree

    path = Path(groundstation.__file__).parent / "gui" / "translations" / f"reflight_{language}.ts"
    known = {
        message.findtext("source", ""): message.findtext("translation", "")
        for each in ElementTree.parse(path).getroot().iter("context")
        if each.findtext("name") == context
        for message in each.iter("message")
    }
    return lambda text: known.get(text) or text


def localized(text: str, translate: Translate, units: UnitSystem) -> str:
    """A message in the user's language and units.

    What is no message is looked up as a whole, as are names of things that stand in messages; what is not known stays.
    """
    if not isinstance(text, Message):
        return translate(text)
    if not text.template:
        return "".join(_value(part, translate, units) for part in text.values)
    body = _filled(text, translate, units)
    return f"{_value(text.place, translate, units)}: {body}" if text.place else body


def _filled(message: Message, translate: Translate, units: UnitSystem) -> str:
    template, held = message.template, list[str]()
    names = {int(field[1]) for field in FIELD.finditer(template) if _is_quoted(template, field)}

    def put(field: re.Match[str]) -> str:
        number = int(field[1])
        value = message.values[number]
        if field[2]:
            return _metres(value, units)
        if _IS_NUMBER.fullmatch(value):
            return value
        held.append(value if number in names else _value(value, translate, units))
        return chr(_HELD + len(held) - 1)

    text = _in_units(FIELD.sub(put, translate(template)), units)
    return _HELD_PLACES.sub(lambda place: held[ord(place[0]) - _HELD], text)


def _is_quoted(template: str, field: re.Match[str]) -> bool:
    return template[: field.start()].endswith("'") and template[field.end() :].startswith("'")


def _value(value: str, translate: Translate, units: UnitSystem) -> str:
    """What stands in a field: a message, a known word, or a number with its unit; a file's path stays as it is."""
    if isinstance(value, Message):
        return localized(value, translate, units)
    if _QUANTITY.fullmatch(value):
        return _in_units(value, units)
    number, _, unit = value.partition(" ")
    if unit and _IS_NUMBER.fullmatch(number):
        return translate(f"{{0}} {unit}").replace("{0}", number)
    return translate(value)


def _metres(value: str, units: UnitSystem) -> str:
    if units is UnitSystem.METRIC:
        return value
    unit = length_unit(units)
    return re.sub(_NUMBER, lambda found: unit.text(float(found[0])).split()[0], value)


def _in_units(text: str, units: UnitSystem) -> str:
    if units is UnitSystem.METRIC:
        return text

    def quantity(found: re.Match[str]) -> str:
        unit, factor = {
            "m": (length_unit(units), 1.0),
            "km": (distance_unit(units), 1e3),
            "mm": (sampling_unit(units), 1e-3),
            "m/s": (speed_unit(units), 1.0),
            "m2": (area_unit(units), 1.0),
        }[found["unit"]]
        shown = [unit.text(factor * float(number)) for number in (found["first"], found["second"]) if number]
        if not shown:
            return f" {unit.symbol}"
        *before, last = shown
        return "".join(f"{each.split()[0]}{found['between']}" for each in before) + last

    return _QUANTITY.sub(quantity, text)
