"""Parameters, each declared once: beside the default of its field stand range, unit, label, help and option.

A frozen record declares its fields with `parameter(...)`. From that come the checks of its values (`check`), options of
the command line (`groundstation.cli.options`), rows of forms (`groundstation.gui.widgets.parameter_form`), settings
files (`planning.base.json_file.settings_over`) and the table in the docs (docs/reference/settings.md). Nothing is
imported here that takes time: the command line describes itself from these records.
"""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, dataclass, field, fields, is_dataclass, replace
from functools import cache
from typing import Any, Literal, TypeVar

from planning.base.messages import say

Value = TypeVar("Value")
Record = TypeVar("Record")
Function = TypeVar("Function", bound=Callable[..., Any])

Unit = Literal["", "m", "mm", "m/s", "s", "min", "deg", "px", "share", "bytes", "EV", "K"]
"""Of a value; `share` is a part of 1, which windows show in per cent."""

Row = Literal["", "first", "more"]
"""Where a form has its row: at once, under further settings, or nowhere."""

_KEY = "parameter"


def _once(function: Function) -> Function:
    """`cache`, which mypy does not let have a class for its argument."""
    return cache(function)  # type: ignore[return-value]


@dataclass(frozen=True, slots=True)
class Choice:
    """One of the values that a parameter can have.

    Parameters
    ----------
    label
        What a form calls it; "" for the value itself.
    word
        What is typed on the command line for it; "" for the value itself.
    """

    value: Any
    label: str = ""
    word: str = ""

    @property
    def typed(self) -> str:
        """What is typed for it."""
        return self.word or str(self.value)


@dataclass(frozen=True, slots=True)
class Parameter:
    """What is known of a parameter besides its default.

    Parameters
    ----------
    help
        What it is, in a clause: for `-h`, the tool tip and the docs. "" takes it from the docstring of its record.
    label
        Title of its row in a form.
    least, most, above, below
        Bounds, the first two within the range. Numbers have to be finite, but for `most` where that is infinite.
    expected
        The range in words, where bounds alone do not say it.
    name
        What messages call it; "" for the name of the field.
    choices
        All values, where they can be listed.
    option, metavar, group
        Of the command line: `--min-distance`, `M`, and the heading that it stands under.
    unset
        What None means, in words.
    row, offered, suggested, step, decimals
        Of a form: where its row is; what can be typed where the range has no end; what can be chosen from a list
        (words are all that the command line takes); how far an arrow goes, and digits behind the point.
    """

    help: str = ""
    label: str = ""
    unit: Unit = ""
    least: float | None = None
    most: float | None = None
    above: float | None = None
    below: float | None = None
    expected: str = ""
    name: str = ""
    choices: tuple[Choice, ...] = ()
    option: str = ""
    metavar: str = ""
    group: str = ""
    unset: str = ""
    row: Row = ""
    offered: tuple[float, float] | None = None
    suggested: tuple[Any, ...] = ()
    step: float = 1.0
    decimals: int = 1

    def range_text(self) -> str:
        """The values that it may have, in words; "" for any."""
        if self.expected:
            return self.expected
        if self.choices:
            *first, last = [str(choice.value) for choice in self.choices]
            return say("{} or {}", ", ".join(first), last) if first else last
        least, most = self.least, None if self.most == math.inf else self.most
        if least is not None and most is not None:
            return say("{} to {}", *(f"{each:.15g}" if not isinstance(most, int) else each for each in (least, most)))
        if least is not None:
            return say("{:g} or more", least) if self.below is None else say("{:g} to below {:g}", least, self.below)
        if self.above is not None and self.below is not None:
            return say("above {:g} and below {:g}", self.above, self.below)
        if self.above is not None:
            return (
                say("more than {:g}", self.above)
                if most is None
                else say("more than {:g} and at most {:g}", self.above, most)
            )
        return "" if most is None else say("{:g} at most", most)

    def holds(self, value: Any) -> bool:
        """Whether a value is in the range."""
        if self.choices:
            return any(value == choice.value for choice in self.choices)
        if isinstance(value, bool) or not isinstance(value, int | float):
            return True
        if not (math.isfinite(value) or value == self.most):
            return not isinstance(value, float)
        return (
            (self.least is None or value >= self.least)
            and (self.most is None or value <= self.most)
            and (self.above is None or value > self.above)
            and (self.below is None or value < self.below)
        )

    def check(self, field_name: str, value: Any) -> None:
        """Raise `ValueError`, which names the parameter and its range, unless a value is in it."""
        if not self.holds(value):
            shown = f"'{value}'" if isinstance(value, str) else f"{value}"
            raise ValueError(say("expected {}, got {}", self.range_text(), shown, place=self.name or field_name))


def parameter(default: Value, help: str = "", **facts: Any) -> Value:  # noqa: A002  (as argparse calls it)
    """A field of a frozen record with all that is known of it: see `Parameter`."""
    return field(default=default, metadata={_KEY: Parameter(help, **facts)})


def like(record: type[Any], name: str, default: Value, **changes: Any) -> Value:
    """A field that is the parameter `name` of another record, with another default or fewer facts."""
    known = declared(record)[name].parameter
    return field(default=default, metadata={_KEY: replace(known, **changes)})


@dataclass(frozen=True, slots=True)
class Declared:
    """A parameter in its record, or in a record within it.

    Parameters
    ----------
    path
        Names of fields, from the outer record inwards.
    kind
        Of its values, None apart: bool, int, float or str.
    """

    path: tuple[str, ...]
    parameter: Parameter
    default: Any
    kind: type[Any]

    @property
    def name(self) -> str:
        """As a settings file has it, with points."""
        return ".".join(self.path)

    def value_in(self, record: Any) -> Any:
        """Its value in a record."""
        for name in self.path:
            record = getattr(record, name)
        return record


@_once
def declared(record: type[Any]) -> Mapping[str, Declared]:
    """All parameters of a record and the records within it, by name, in order."""
    found: dict[str, Declared] = {}
    for each in fields(record):
        known: Parameter | None = each.metadata.get(_KEY)
        default = _default(each)
        if known is not None:
            known = known if known.help else replace(known, help=_described(record).get(each.name, ""))
            found[each.name] = Declared((each.name,), known, default, _kind(each, known, default))
        elif is_dataclass(default) and not isinstance(default, type):
            for inner in declared(type(default)).values():
                path = (each.name, *inner.path)
                found[".".join(path)] = replace(inner, path=path, default=inner.value_in(default))
    return found


def check(record: Any) -> None:
    """Raise `ValueError` unless all values of a record are in their ranges; for `__post_init__`.

    None passes where it is the default: it stands for what is decided later.
    """
    for name, known, default in _checked(type(record)):
        value = getattr(record, name)
        if not (value is None and default is None):
            known.check(name, value)


def with_values(record: Record, values: Mapping[tuple[str, ...], Any]) -> Record:
    """A record with some of its parameters changed, by their paths."""
    own = {path[0]: value for path, value in values.items() if len(path) == 1}
    for name in {path[0] for path in values if len(path) > 1}:
        inner = {path[1:]: value for path, value in values.items() if path[0] == name}
        own[name] = with_values(getattr(record, name), inner)
    return replace(record, **own)  # type: ignore[type-var]


@_once
def _checked(record: type[Any]) -> tuple[tuple[str, Parameter, Any], ...]:
    return tuple((each.name, each.metadata[_KEY], _default(each)) for each in fields(record) if _KEY in each.metadata)


def _default(each: Field[Any]) -> Any:
    if each.default_factory is not MISSING:
        return each.default_factory()
    return None if each.default is MISSING else each.default


def _kind(each: Field[Any], known: Parameter, default: Any) -> type[Any]:
    """By the choices, the default, or else the words of the annotation."""
    if known.choices:
        return type(known.choices[0].value)
    words = str(each.type).split(" | ")
    if default is None or "float" in words:
        return next(kind for name, kind in (("float", float), ("int", int), ("str", str)) if name in words)
    return type(default)


@_once
def _described(record: type[Any]) -> dict[str, str]:
    """What the docstring of a record says of its fields: numpydoc's section of parameters."""
    text = inspect.getdoc(record) or ""
    _, _, section = text.partition("Parameters\n----------\n")
    section = re.split(r"\n\n\w+\n-+\n", section)[0]
    found: dict[str, str] = {}
    for names, body in re.findall(r"^(\S[^\n]*)\n((?:[ ]{4}[^\n]*\n?|\n)+)", section, re.MULTILINE):
        for name in names.split(","):
            found[name.strip()] = " ".join(body.split())
    return found
