"""Findings: what a check measured, what it compared it with, and where."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Severity(StrEnum):
    """How bad a finding is: an `ERROR` grounds the flight, a `WARNING` wants a decision, a `NOTE` informs.

    `OK` says that a rule was looked at and kept.
    """

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"
    OK = "ok"


@dataclass(frozen=True, slots=True)
class Finding:
    """One result of one rule. Checks return all of them; they do not stop at the first.

    Parameters
    ----------
    code
        Stable name of the rule, in kebab case.
    message
        What was found, for the pilot, with what to do where something is wrong.
    place
        The viewpoint, leg, sortie, file part or field concerned; empty for the whole.
    value, limit
        Measured value and its limit, in `unit`; None where the rule measures nothing.
    """

    severity: Severity
    code: str
    message: str
    place: str = ""
    value: float | None = None
    limit: float | None = None
    unit: str = ""


def is_flyable(findings: tuple[Finding, ...]) -> bool:
    """True where no finding is an error."""
    return all(finding.severity is not Severity.ERROR for finding in findings)
