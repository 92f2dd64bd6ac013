"""Undo and redo over frozen values: a list of labelled states and the place in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

Value = TypeVar("Value")

MAX_STEPS = 200
"""Steps that can be undone; a document shares what it did not change, so a step costs kilobytes."""


@dataclass(frozen=True, slots=True, eq=False)
class _Step(Generic[Value]):
    label: str
    value: Value


class History(Generic[Value]):
    """States of one value, from the oldest that can be reached by undo to the newest that can be reached by redo."""

    def __init__(self, value: Value) -> None:
        self._steps: list[_Step[Value]] = [_Step("", value)]
        self._at = 0

    @property
    def value(self) -> Value:
        """The present state."""
        return self._steps[self._at].value

    @property
    def undo_label(self) -> str:
        """What `undo` would take back; empty where there is nothing."""
        return self._steps[self._at].label if self._at > 0 else ""

    @property
    def redo_label(self) -> str:
        """What `redo` would do again; empty where there is nothing."""
        return self._steps[self._at + 1].label if self._at + 1 < len(self._steps) else ""

    def change(self, label: str, value: Value) -> None:
        """Go on to a new state; what could have been done again is forgotten."""
        if not label:
            raise ValueError("label: expected what the user did, got an empty text")
        del self._steps[self._at + 1 :]
        self._steps.append(_Step(label, value))
        del self._steps[: max(0, len(self._steps) - 1 - MAX_STEPS)]
        self._at = len(self._steps) - 1

    def amend(self, value: Value) -> None:
        """Replace the present state without a step of its own."""
        self._steps[self._at] = _Step(self._steps[self._at].label, value)

    def undo(self) -> Value:
        """Go back one state; stays where there is none before it."""
        self._at = max(0, self._at - 1)
        return self.value

    def redo(self) -> Value:
        """Go forward one state; stays where there is none after it."""
        self._at = min(len(self._steps) - 1, self._at + 1)
        return self.value
