"""Fields of JSON objects that others wrote: what is missing or of another kind becomes a question, no exception."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from typing import Any

from planning.base.errors import shortened
from planning.base.messages import say

MAX_SHOWN = 40
"""Characters of a value that a question quotes."""


def quoted(value: object) -> str:
    """A value as a question quotes it."""
    text = shortened(str(value))
    return text if len(text) <= MAX_SHOWN else f"{text[:MAX_SHOWN]} ..."


class Fields:
    """Fields of one object.

    Parameters
    ----------
    content
        Of the file; anything but an object has no fields, and raises a question.
    name
        Of the object, for questions.
    questions
        Where they are added.
    """

    def __init__(self, content: Any, name: str, questions: list[str]) -> None:
        self.values: Mapping[str, Any] = content if isinstance(content, dict) else {}
        self.name, self.questions = name, questions
        if not isinstance(content, dict):
            self.ask(name, content)

    def ask(self, name: str, value: object) -> None:
        """Ask what a field means."""
        self.questions.append(say("'{}' cannot be read, it is '{}'", name, quoted(value)))

    def has(self, name: str) -> bool:
        """Whether a field is there and says something."""
        return self.values.get(name) not in (None, "", [], {})

    def text(self, name: str) -> str:
        """A text, or a number as one; "" where there is none."""
        value = self.values.get(name)
        if value is None or value == [] or value == {}:
            return ""
        if isinstance(value, str):
            return value.strip()
        if isinstance(value, int | float) and not isinstance(value, bool):
            return f"{value:g}"
        self.ask(name, value)
        return ""

    def texts(self, name: str) -> tuple[str, ...]:
        """Texts of a list, or a single one; objects with a `text` in a language each give one, English if there."""
        value = self.values.get(name)
        if value in (None, "", [], {}):
            return ()
        values = value if isinstance(value, list) else [value]
        plain = tuple(each.strip() for each in values if isinstance(each, str))
        told = [each for each in values if isinstance(each, dict) and isinstance(each.get("text"), str)]
        told.sort(key=lambda each: not str(each.get("lang", "")).lower().startswith("en"))
        if len(plain) + len(told) < len(values):
            self.ask(name, value)
        return (*plain, *(each["text"].strip() for each in told[:1]))

    def number(self, name: str) -> float | None:
        """A finite number, None where there is none."""
        value = self.values.get(name)
        if value is None:
            return None
        if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value):
            return float(value)
        self.ask(name, value)
        return None

    def items(self, name: str) -> list[Any]:
        """A list, empty where there is none; a single object counts as a list of one."""
        value = self.values.get(name)
        if value is None:
            return []
        if isinstance(value, list):
            return value
        if isinstance(value, dict):
            return [value]
        self.ask(name, value)
        return []

    def ask_about_others(self, known: Collection[str]) -> bool:
        """Ask about fields that are not known; returns whether there are any."""
        others = [name for name in self.values if name not in known and self.has(name)]
        for name in others:
            self.questions.append(say("the file says '{}' of '{}', which is not known here", quoted(name), self.name))
        return bool(others)
