"""What pre-flight rules look at, and how they put what they measured."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.base.findings import Finding, Severity
from planning.base.messages import glue, say
from planning.checks.measures import Measures, TimedFlight, flight_key, measure
from planning.coverage.model import CoverageModel
from planning.plan import Plan, Sortie
from planning.site.free_space import FreeSpace, unchecked_space
from planning.site.records import SiteModel
from planning.viewpoints.prepare import coverage_model, decide_occlusion

Array = NDArray[np.float64]

ROUNDING_M = 1e-4
"""Coordinates in plan files are rounded to 0.1 mm; no rule breaks over that."""


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """A plan on its site, measured."""

    plan: Plan
    site_model: SiteModel
    space: FreeSpace
    model: CoverageModel
    measures: Measures

    @classmethod
    def of(cls, plan: Plan, site_model: SiteModel) -> Case:
        """The case of a plan; occlusion is decided here where the plan leaves it to the scene."""
        space = unchecked_space(site_model, plan.constraints.min_distance_m)
        constraints = plan.constraints
        if constraints.occlusion == "auto":
            on = decide_occlusion(site_model, space, "auto").on
            constraints = replace(constraints, occlusion="on" if on else "off")
        model = coverage_model(site_model, space, plan.camera, constraints)
        return cls(plan, site_model, space, model, measure(plan, space, model))

    def with_plan(self, plan: Plan) -> Case:
        """The case of another plan for the same site; what both have in common is not measured again."""
        mine = self.plan
        if (plan.camera, plan.constraints, plan.aircraft, plan.rules) != (
            mine.camera,
            mine.constraints,
            mine.aircraft,
            mine.rules,
        ):
            return Case.of(plan, self.site_model)
        return replace(self, plan=plan, measures=measure(plan, self.space, self.model, self.measures))

    def sorties(self) -> Iterator[tuple[str, Sortie, Array]]:
        """Name, record and path, shape (k, 3), of each sortie whose path has any leg."""
        for number, sortie in enumerate(self.plan.sorties, 1):
            if len(sortie.path_enu_m) > 1:
                yield say("sortie {}", number), sortie, np.array(sortie.path_enu_m, np.float64)

    def timed_sorties(self) -> Iterator[tuple[str, Sortie, TimedFlight]]:
        """Name, record and times of each sortie whose path passes all its viewpoints; none where nothing can fly."""
        by_id = {viewpoint.id: viewpoint for viewpoint in self.plan.viewpoints}
        for number, sortie in enumerate(self.plan.sorties, 1):
            flight = self.measures.flights.get(flight_key(sortie, by_id))
            if flight is not None:
                yield say("sortie {}", number), sortie, flight


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
    text = (
        say("{}, at least {}", _number(value, unit), _number(limit, unit), place=subject)
        if least
        else say("{}, at most {}", _number(value, unit), _number(limit, unit), place=subject)
    )
    if kept:
        return Finding(Severity.OK, code, text, place, value, limit, unit)
    return Finding(severity, code, glue(text, "; " if advice else "", advice), place, value, limit, unit)


def _number(value: float, unit: str) -> str:
    """A measured value as a pilot reads it: centimetres are enough, micrometres are noise."""
    return f"{round(value, 3):g} {unit}".rstrip()
