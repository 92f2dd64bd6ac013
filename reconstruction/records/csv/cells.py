"""Cells of CSV tables: numbers, dates and texts to text and back, and nothing that a spreadsheet would compute.

A text that begins like a formula gets an apostrophe in front, on its way in it loses it again; a text that has one
there of its own gets another, so that every text reads back as it was.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from typing import Any

from planning.base.errors import InputError
from reconstruction.records.entries import AttributeType, Value
from reconstruction.records.limits import check_number

_FORMULA = re.compile("'*[=+\\-@\t\r\n＝＋－＠]")
_GUARDED = re.compile("'+[=+\\-@\t\r\n＝＋－＠]")
_NUMBER = re.compile(r"[+-]?([0-9]+([.][0-9]*)?|[.][0-9]+)([eE][+-]?[0-9]{1,3})?")

YES, NO = "yes", "no"

_PLAIN = frozenset({"date", "found_on", "repaired_on", "next_due", "key", "inspection", "status", "sha256", "currency"})
"""Fields in which blanks at the ends mean nothing."""


def guarded(text: str) -> str:
    """Text that no spreadsheet takes for a formula."""
    return f"'{text}" if _FORMULA.match(text) else text


def unguarded(text: str) -> str:
    """The text that `guarded` was given."""
    return text[1:] if _GUARDED.match(text) else text


def number_cell(value: float) -> str:
    """The shortest text that reads back as the number; one below zero is no formula, spreadsheets read it."""
    return str(int(value)) if value == int(value) and abs(value) < 1e15 else repr(value)


def read_number(text: str, field: str, comma: bool) -> float:
    """Number of a cell.

    Parameters
    ----------
    comma
        The table is parted by semicolons, so that a comma is a decimal one.

    Raises
    ------
    InputError
        It is none.
    """
    plain = text.strip()
    if comma and plain.count(",") == 1 and "." not in plain:
        plain = plain.replace(",", ".")
    if not _NUMBER.fullmatch(plain):
        hint = " with a point (commas in tables parted by semicolons only)" if "," in plain and not comma else ""
        raise InputError(f"{field}: expected a number{hint}, got '{text[:40]}'")
    value = float(plain)
    check_number(value, field)
    return value


def read_whole(text: str, field: str, comma: bool) -> int:
    """Whole number of a cell.

    Raises
    ------
    InputError
        It is none.
    """
    value = read_number(text, field, comma)
    if value != int(value):
        raise InputError(f"{field}: expected a whole number, got '{text[:40]}'")
    return int(value)


def read_truth(text: str, field: str) -> bool:
    """Truth of a cell.

    Raises
    ------
    InputError
        It is neither yes nor no.
    """
    word = text.strip().lower()
    if word in (YES, "true", "1"):
        return True
    if word in (NO, "false", "0"):
        return False
    raise InputError(f"{field}: expected yes or no, got '{text[:40]}'")


def read_outline(text: str, field: str) -> tuple[tuple[float, float], ...]:
    """Outline of a cell, `[[u, v], ...]`.

    Raises
    ------
    InputError
        It is none.
    """
    try:
        found: Any = json.loads(text)
        return tuple((float(u), float(v)) for u, v in found)
    except (ValueError, TypeError, RecursionError) as error:
        raise InputError(f"{field}: expected places such as [[0.1, 0.2], ...], got '{text[:40]}'") from error


_READERS: dict[str, Callable[[str, str, bool], Any]] = {
    "severity": read_whole,
    "u": read_number,
    "v": read_number,
    "cost": read_number,
    "outline": lambda text, field, _: read_outline(text, field),
}


def read_field(field: str, text: str, comma: bool = False) -> Any:
    """Value of an entry's field; "" where the cell is empty.

    Raises
    ------
    InputError
        It is no such value.
    """
    plain = text.strip()
    if field in _READERS:
        return _READERS[field](plain, field, comma) if plain else ""
    return plain if field in _PLAIN else text


def read_value(type_name: AttributeType, text: str, field: str, comma: bool = False) -> Value:
    """Value of an attribute of a type; texts and dates as they are.

    Raises
    ------
    InputError
        It is no such value.
    """
    if type_name == "number":
        return read_number(text, field, comma)
    return read_truth(text, field) if type_name == "yes/no" else text
