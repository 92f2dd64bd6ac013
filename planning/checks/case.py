"""What pre-flight rules look at, and how they put what they measured."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.coverage.model import CoverageModel
from planning.findings import Finding, Severity
from planning.plan import Plan
from planning.site import SiteModel
from planning.space import FreeSpace

Array = NDArray[np.float64]

ROUNDING_M = 1e-4
"""Coordinates in plan files are rounded to 0.1 mm; no rule breaks over that."""


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """A plan on its site."""

    plan: Plan
    site_model: SiteModel
    space: FreeSpace
    model: CoverageModel

    def paths(self) -> Iterator[tuple[str, Array]]:
        """Name and vertices, shape (k, 3), of each sortie's path that has any leg."""
        for number, sortie in enumerate(self.plan.sorties, 1):
            if len(sortie.path_enu_m) > 1:
                yield f"sortie {number}", np.array(sortie.path_enu_m, np.float64)


Rule = Callable[[Case], Iterator[Finding]]


def judge(
    kept: bool,
    code: str,
    subject: str,
    value: float,
    limit: float,
    unit: str,
    place: str = "",
    advice: str = "",
    severity: Severity = Severity.ERROR,
    *,
    least: bool = False,
) -> Finding:
    """A finding about one measured value: OK where `kept`. The limit is the most allowed, or else the `least`."""
    text = f"{subject}: {_number(value, unit)}, {'at least' if least else 'at most'} {_number(limit, unit)}"
    if kept:
        return Finding(Severity.OK, code, text, place, value, limit, unit)
    return Finding(severity, code, f"{text}{'; ' + advice if advice else ''}", place, value, limit, unit)


def _number(value: float, unit: str) -> str:
    """A measured value as a pilot reads it: centimetres are enough, micrometres are noise."""
    return f"{round(value, 3):g} {unit}".rstrip()
