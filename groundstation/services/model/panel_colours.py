"""Panels in colours that say what their records say: the age of the last inspection, a defect's severity, an attribute.

Numbers and dates get a scale that stays apart in grey and to colour-blind eyes, words a colour each.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import date
from enum import StrEnum
from typing import TYPE_CHECKING

from reconstruction.records.entries import COMPUTED

if TYPE_CHECKING:
    from reconstruction.records.book import RecordBook

Rgb = tuple[int, int, int]

SCALE: tuple[Rgb, ...] = ((68, 1, 84), (59, 82, 139), (33, 145, 140), (94, 201, 98), (253, 231, 37))
"""Of viridis (Smith and van der Walt, 2015), evenly spaced, from little to much."""

WORDS: tuple[Rgb, ...] = (
    (0, 114, 178),
    (230, 159, 0),
    (0, 158, 115),
    (204, 121, 167),
    (86, 180, 233),
    (213, 94, 0),
    (240, 228, 66),
)
"""Of Okabe and Ito (2008), for categories."""

OTHER: Rgb = (150, 150, 150)
"""Of words beyond those."""

SEVERITIES: tuple[Rgb, ...] = ((254, 217, 118), (254, 178, 76), (253, 141, 60), (227, 26, 28), (128, 0, 38))
"""Of ColorBrewer's YlOrRd (Brewer, 2003), from 1 to 5."""


class Computed(StrEnum):
    """What panels can be coloured by besides their attributes."""

    INSPECTED = "inspected"
    DEFECTS = "defects"
    FACADE = "facade"


@dataclass(frozen=True, slots=True)
class LegendLine:
    """A colour, and the value that it stands for: a word, a number, or a date."""

    colour: Rgb
    value: str | float | date


@dataclass(frozen=True, slots=True)
class Colouring:
    """Colours of panels by GlobalId; those that lack a value have none.

    Parameters
    ----------
    legend
        From least to most, or from the most frequent on.
    unit
        Of numbers.
    n_without
        Panels without a value.
    """

    colours: Mapping[str, Rgb]
    legend: tuple[LegendLine, ...] = ()
    unit: str = ""
    n_without: int = 0


NO_COLOURS = Colouring({})


def by_severity(severities: Mapping[str, int], global_ids: tuple[str, ...]) -> Colouring:
    """By the worst open defect, 1 to 5."""
    found = {each: SEVERITIES[severities[each] - 1] for each in global_ids if each in severities}
    legend = tuple(LegendLine(SEVERITIES[n - 1], float(n)) for n in range(1, 6) if n in severities.values())
    return Colouring(found, legend, "", len(global_ids) - len(found))


def by_value(values: Mapping[str, str | float | bool | date], global_ids: tuple[str, ...], unit: str = "") -> Colouring:
    """By numbers or dates along a scale, by words a colour each; the kind is that of most values."""
    kinds = Counter(_kind(values[each]) for each in global_ids if each in values)
    if not kinds:
        return Colouring({}, (), unit, len(global_ids))
    kind = kinds.most_common(1)[0][0]
    usable = {each: values[each] for each in global_ids if each in values and _kind(values[each]) == kind}
    n_without = len(global_ids) - len(usable)
    if kind == "word":
        return _by_word({each: str(value) for each, value in usable.items()}, n_without)
    places = {each: _place(value) for each, value in usable.items()}
    low, high = min(places.values()), max(places.values())
    colours = {each: scale_colour(0.5 if high == low else (at - low) / (high - low)) for each, at in places.items()}
    steps = (0.5,) if high == low else (0.0, 0.25, 0.5, 0.75, 1.0)
    marks: list[float] = [low + share * (high - low) for share in steps]
    legend = tuple(
        LegendLine(scale_colour(share), date.fromordinal(round(mark)) if kind == "date" else mark)
        for share, mark in zip(steps, marks, strict=True)
    )
    return Colouring(colours, legend, unit, n_without)


def scale_colour(share: float) -> Rgb:
    """Of the scale, at 0 to 1."""
    at = min(max(share, 0.0), 1.0) * (len(SCALE) - 1)
    first = min(math.floor(at), len(SCALE) - 2)
    red, green, blue = (
        round(one + (other - one) * (at - first)) for one, other in zip(SCALE[first], SCALE[first + 1], strict=True)
    )
    return red, green, blue


def colouring(book: RecordBook | None, by: str, facades: Mapping[str, str]) -> Colouring:
    """Colours of panels by what is chosen.

    Parameters
    ----------
    book
        Of the scene; None where it has no records.
    by
        One of `Computed`, the name of an attribute, or "" for none.
    facades
        Names of the panels' facades, by GlobalId, for all panels of the scene.
    """
    global_ids = tuple(facades)
    if by == Computed.FACADE:
        return by_value(dict(facades), global_ids)
    if not by or book is None:
        return NO_COLOURS
    from reconstruction.records.queries import attribute_values, inspection_dates, open_severities

    if by == Computed.DEFECTS:
        return by_severity(open_severities(book), global_ids)
    if by == Computed.INSPECTED:
        dates = {each: date.fromisoformat(text) for each, text in inspection_dates(book).items()}
        return by_value(dates, global_ids)
    found = attribute_values(book, by)
    units = Counter(each.unit for each in found.values())
    unit = "m" if by in COMPUTED else units.most_common(1)[0][0] if units else ""
    return by_value({each: _dated(value.value) for each, value in found.items()}, global_ids, unit)


def _dated(value: str | float | bool) -> str | float | bool | date:
    """A date where a text is one."""
    if isinstance(value, str):
        try:
            return date.fromisoformat(value)
        except ValueError:
            return value
    return value


def _kind(value: str | float | bool | date) -> str:
    if isinstance(value, (str, bool)):
        return "word"
    return "date" if isinstance(value, date) else "number"


def _place(value: str | float | bool | date) -> float:
    assert not isinstance(value, str)
    return float(value.toordinal() if isinstance(value, date) else value)


def _by_word(values: Mapping[str, str], n_without: int) -> Colouring:
    words = [word for word, _ in Counter(values.values()).most_common()]
    colours = {word: WORDS[number] if number < len(WORDS) else OTHER for number, word in enumerate(words)}
    legend = tuple(LegendLine(colours[word], word) for word in words[: len(WORDS)])
    return Colouring({each: colours[word] for each, word in values.items()}, legend, "", n_without)
