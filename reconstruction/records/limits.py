"""What a field of a record may hold. Every refusal names the field, what was found and what was expected."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from datetime import date
from pathlib import PurePosixPath, PureWindowsPath

from planning.base.errors import InputError
from planning.base.messages import say

MAX_WORDS = 200
"""Characters of names, kinds and persons."""

MAX_TEXT = 10_000
"""Characters of notes: five pages."""

MAX_NUMBER = 1e15

MAX_OUTLINE = 1000
"""Points of a defect's outline."""

SHA256 = re.compile(r"[0-9a-f]{64}")
CURRENCY = re.compile(r"[A-Z]{3}")
_DATE = re.compile(r"[0-9]{4}-[0-9]{2}-[0-9]{2}")
# Control characters, but for tab and line ends, and halves of characters: files and spreadsheets do not bear them.
_FORBIDDEN = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\ud800-\udfff\ufffe\uffff]")


def check_text(value: object, field: str, limit: int = MAX_WORDS, required: bool = False) -> None:
    """Refuse what is no text, is too long, or has characters that no file bears.

    Raises
    ------
    InputError
        As said.
    """
    if not isinstance(value, str):
        raise InputError(say("expected text, got {}", _shown(value), place=field))
    if required and not value.strip():
        raise InputError(say("expected a text, got none", place=field))
    if len(value) > limit:
        raise InputError(say("expected at most {} characters, got {}", limit, len(value), place=field))
    found = _FORBIDDEN.search(value)
    if found is not None:
        raise InputError(
            say("character {} is a control character (U+{:04X})", found.start() + 1, ord(found[0]), place=field)
        )


def check_texts(record: object, words: Sequence[str], texts: Sequence[str] = (), required: Sequence[str] = ()) -> None:
    """`check_text` of a record's fields: `words` are short, `texts` long."""
    for field in words:
        check_text(getattr(record, field), field, MAX_WORDS, field in required)
    for field in texts:
        check_text(getattr(record, field), field, MAX_TEXT, field in required)


def check_date(value: object, field: str) -> None:
    """Refuse what is no date as ISO 8601 writes it, or none of the calendar.

    Raises
    ------
    InputError
        As said.
    """
    if isinstance(value, str) and _DATE.fullmatch(value):
        try:
            date.fromisoformat(value)
            return
        except ValueError:
            pass
    raise InputError(say("expected a date such as 2026-03-31, got {}", _shown(value), place=field))


def check_dates(record: object, fields: Sequence[str]) -> None:
    """`check_date` of those of a record's fields that are not None."""
    for field in fields:
        value = getattr(record, field)
        if value is not None:
            check_date(value, field)


def check_number(value: object, field: str, low: float = -MAX_NUMBER, high: float = MAX_NUMBER) -> None:
    """Refuse what is no number, is not finite, or lies outside `low` to `high`.

    Raises
    ------
    InputError
        As said.
    """
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not is_number or not math.isfinite(value) or not low <= value <= high:  # type: ignore[operator,arg-type]
        raise InputError(say("expected a number from {:g} to {:g}, got {}", low, high, _shown(value), place=field))


def check_choice(value: object, field: str, choices: Sequence[object]) -> None:
    """Refuse what is none of the choices.

    Raises
    ------
    InputError
        As said.
    """
    if isinstance(value, bool) or value not in choices:
        raise InputError(say("expected {}, got {}", ", ".join(map(str, choices)), _shown(value), place=field))


def is_plain_name(name: str) -> bool:
    """Whether a text names a file in a folder, on every system, and leads nowhere else."""
    return (
        0 < len(name) <= MAX_WORDS
        and name == PurePosixPath(name).name == PureWindowsPath(name).name
        and not name.startswith(".")
        and not re.search(r'[<>:"|?*\x00-\x1f]', name)
        and name[-1] not in ". "
    )


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
