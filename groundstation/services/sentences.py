"""Sentences of planning, missions and services, recognised and said again in another language and other units.

Findings, errors and stages are made as English text with metric values. A `Phrasebook` knows their templates,
`home lies at {0} m, below the ground at {1} m`: it finds the template that a text was made from, takes the values out,
and fills them into the translated template. What it does not know stays as it is.

Fields of a template: `{0}` is any text, in which sentences are looked for in turn, unless it stands in quotes: names
stay. `{0:n}` is a number. `{0:m}` holds metres that no " m" follows, such as the coordinates of a place. Numbers with
" m", " m/s", " mm", " km" or " m2" behind them need no mark.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache

from groundstation.services.units import UnitSystem, area_unit, distance_unit, length_unit, sampling_unit, speed_unit

Translate = Callable[[str], str]
"""A template in the user's language; the template itself where there is no translation."""

FIELD = re.compile(r"\{(\d+)(?::([mn]))?\}")

_NUMBER = r"-?(?:inf|nan|\d+(?:\.\d+)?(?:e[+-]?\d+)?)"
_IS_NUMBER = re.compile(_NUMBER)
_QUANTITY = re.compile(
    # One number or two ("3 to 5 m"), or the bracket of coordinates that are converted already.
    rf"(?:(?<![\w.])(?P<first>{_NUMBER})(?:(?P<between> to | bis | x )(?P<second>{_NUMBER}))?|(?<=\)))"
    r" (?P<unit>m/s|mm|km|m2|m)(?![\w/])"
)

_UNIT_BEHIND = re.compile(r" (?:m/s|mm|km|m2|m|s|deg|degrees|%|MiB|GiB)(?!\w)")

JOINTS = (": ", "; ", ", ", " and ", " (")
"""What sentences are put together with: the place or file before it, advice behind it."""

MAX_JOINTS = 20
"""Texts with more are recognised as a whole or not at all: there would be too many ways to take them apart."""

_HEAD = 2
"""Characters by which templates are sorted out before they are tried."""

_HELD = 0xE000
_HELD_PLACES = re.compile(f"[{chr(_HELD)}-{chr(_HELD + 99)}]")
"""Private characters that stand for values while the units of a sentence are changed."""


@dataclass(frozen=True, slots=True)
class Template:
    """A sentence with fields.

    Parameters
    ----------
    source
        In English.
    literals
        Texts before, between and behind the fields, one more than there are fields.
    kinds
        Of each field, in the order of the text: "n", "m" or "".
    names
        Of each field: whether it stands in quotes, so that it is a name and stays.
    """

    source: str
    literals: tuple[str, ...]
    kinds: tuple[str, ...]
    names: tuple[bool, ...]

    @classmethod
    def of(cls, source: str) -> Template:
        """The template of a text; its fields count from 0, in order."""
        fields = list(FIELD.finditer(source))
        if [int(field[1]) for field in fields] != list(range(len(fields))):
            raise ValueError(f"expected fields counted from 0, in order, got {source!r}")
        cuts = [0, *(end for field in fields for end in field.span()), len(source)]
        literals = tuple(source[start:stop] for start, stop in zip(cuts[::2], cuts[1::2], strict=True))
        kinds = tuple(
            field[2] or ("n" if _UNIT_BEHIND.match(literal) else "")
            for field, literal in zip(fields, literals[1:], strict=True)
        )
        names = tuple(literals[k].endswith("'") and literals[k + 1].startswith("'") for k in range(len(fields)))
        return cls(source, literals, kinds, names)

    @property
    def weight(self) -> int:
        """Number of its own characters."""
        return sum(map(len, self.literals))

    @property
    def is_strict(self) -> bool:
        """Whether no field can hold another sentence, so that nothing else can be meant."""
        return all(kind or is_name for kind, is_name in zip(self.kinds, self.names, strict=True))

    def values(self, text: str) -> tuple[str, ...] | None:
        """What stands in the fields; None where the text is not made from this template."""
        first, last = self.literals[0], self.literals[-1]
        if not text.startswith(first) or not text.endswith(last) or any(part not in text for part in self.literals):
            return None
        found = _pattern(self).fullmatch(text)
        return None if found is None else found.groups()


@cache
def _pattern(template: Template) -> re.Pattern[str]:
    """Matches the texts made from a template; made only for those that are met."""
    first, *behind = map(re.escape, template.literals)
    fields = (f"({_NUMBER})" if kind == "n" else "(.*?)" for kind in template.kinds)
    return re.compile(first + "".join(map("".join, zip(fields, behind, strict=True))), re.DOTALL)


class Phrasebook:
    """Templates by which sentences are recognised."""

    def __init__(self, sources: Iterable[str]) -> None:
        templates = [Template.of(source) for source in sources]
        # Of several that fit a text, the one with most of its own words is meant.
        self._templates = sorted(templates, key=lambda template: -template.weight)
        self._by_head: dict[str, list[tuple[str, Template]]] = {}
        heads = {template.literals[0] for template in templates if template.literals[0].startswith(" ")}
        cuts = [*JOINTS, *sorted(head for head in heads if not head.startswith(JOINTS))]
        self.cuts = re.compile("|".join(map(re.escape, cuts)))

    def find(self, text: str) -> tuple[Template, tuple[str, ...]] | None:
        """The template that a whole text was made from, and its values."""
        for longest, template in self._beginning_like(text[:_HEAD]):
            if longest in text:
                values = template.values(text)
                if values is not None:
                    return template, values
        return None

    def _beginning_like(self, head: str) -> list[tuple[str, Template]]:
        """Templates that a text with these first characters may be made from, each behind its longest literal."""
        if head not in self._by_head:
            fits = (template for template in self._templates if head.startswith(template.literals[0][:_HEAD]))
            self._by_head[head] = [(max(template.literals, key=len), template) for template in fits]
        return self._by_head[head]

    def retold(self, text: str, translate: Translate, units: UnitSystem) -> str:
        """A text in the user's words and units; as it is where no part of it is known."""
        told = _Telling(self, translate, units).told(text)
        return told.text if told.weight else text


@dataclass(frozen=True, slots=True)
class _Told:
    """What was made of a text, and how many of its characters were recognised: 0 where it stays as it is."""

    text: str
    weight: int = 0


class _Telling:
    """One text being told; what its parts say is kept, for it is asked for again and again."""

    def __init__(self, book: Phrasebook, translate: Translate, units: UnitSystem) -> None:
        self._book, self._translate, self._units = book, translate, units
        self._known: dict[str, _Told] = {}

    def told(self, text: str) -> _Told:
        """A text in the user's words: made from one template, or put together, whichever explains more of it."""
        if text not in self._known:
            found = self._book.find(text)
            whole = self._filled(*found) if found else _Told(self._alone(text))
            is_certain = found is not None and found[0].is_strict
            self._known[text] = whole if is_certain else max(whole, self._joined(text), key=lambda told: told.weight)
        return self._known[text]

    def _joined(self, text: str) -> _Told:
        """Two sentences or more that a text is put together from."""
        cuts = [found for found in self._book.cuts.finditer(text) if found.start() > 0 and found.end() < len(text)]
        best = _Told(text)
        for cut in cuts if len(cuts) <= MAX_JOINTS else ():
            joint, (start, stop) = cut[0], cut.span()
            end = ")" if joint == " (" and text.endswith(")") else ""
            left, right, behind = (
                self.told(part) for part in (text[:start], text[stop:].removesuffix(end), text[start:])
            )
            # An "and" with anything unknown beside it may stand in the name of a file.
            between = self._translate(joint) if joint in JOINTS and left.weight and right.weight else joint
            apart = _Told(f"{left.text}{between}{right.text}{end}", left.weight + right.weight)
            best = max(best, apart, _Told(left.text + behind.text, left.weight + behind.weight), key=lambda t: t.weight)
        return best

    def _filled(self, template: Template, values: tuple[str, ...]) -> _Told:
        told = [
            _Told(value) if is_name else self.told(value) for value, is_name in zip(values, template.names, strict=True)
        ]
        held: list[str] = []

        def put(field: re.Match[str]) -> str:
            number = int(field[1])
            value = values[number]
            if template.kinds[number] == "m":
                return self._metres(value)
            if _IS_NUMBER.fullmatch(value):
                return value
            held.append(told[number].text)
            return chr(_HELD + len(held) - 1)

        text = self._in_units(FIELD.sub(put, self._translate(template.source)))
        text = _HELD_PLACES.sub(lambda place: held[ord(place[0]) - _HELD], text)
        return _Told(text, template.weight + sum(part.weight for part in told))

    def _alone(self, text: str) -> str:
        """A quantity in the user's units; anything else, such as the path of a file, as it is."""
        return self._in_units(text) if _QUANTITY.fullmatch(text) else text

    def _metres(self, value: str) -> str:
        if self._units is UnitSystem.METRIC:
            return value
        unit = length_unit(self._units)
        return re.sub(_NUMBER, lambda found: unit.text(float(found[0])).split()[0], value)

    def _in_units(self, text: str) -> str:
        return text if self._units is UnitSystem.METRIC else _QUANTITY.sub(self._quantity, text)

    def _quantity(self, found: re.Match[str]) -> str:
        unit, factor = {
            "m": (length_unit(self._units), 1.0),
            "km": (distance_unit(self._units), 1e3),
            "mm": (sampling_unit(self._units), 1e-3),
            "m/s": (speed_unit(self._units), 1.0),
            "m2": (area_unit(self._units), 1.0),
        }[found["unit"]]
        shown = [unit.text(factor * float(number)) for number in (found["first"], found["second"]) if number]
        if not shown:
            return f" {unit.symbol}"
        *before, last = shown
        return "".join(f"{text.split()[0]}{found['between']}" for text in before) + last
