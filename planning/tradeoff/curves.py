"""Curves of quality against time, the winner among them, and answers to "I have 60 s" and "I want 99 %".

Quality is a gap: how far the best known is from a bound, as a part of the bound; 0 is proven to be the best there is.
For coverage the gap is 1 - covered / bound, for a tour length / bound - 1.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from planning.base.progress import QualityPoint

BUDGETS_S = (1.0, 3.0, 10.0, 30.0, 60.0)
"""Times for which the best run is named."""


@dataclass(frozen=True, slots=True)
class Curve:
    """Gap against time of one run: only the points at which it became smaller.

    Parameters
    ----------
    points
        `value` is the gap; times rise, gaps fall.
    end_s
        When the run was over.
    """

    points: tuple[QualityPoint, ...]
    end_s: float

    @property
    def final_gap(self) -> float:
        """Gap in the end; infinite for a run that found nothing."""
        return self.points[-1].value if self.points else math.inf

    def gap_at(self, t_s: float) -> float:
        """Gap after `t_s` seconds; infinite before anything was found."""
        return min((point.value for point in self.points if point.t_s <= t_s), default=math.inf)

    def time_to(self, gap: float) -> float | None:
        """Seconds until the gap was no larger than `gap`; None where it never was."""
        return next((point.t_s for point in self.points if point.value <= gap), None)

    def until(self, t_s: float) -> Curve:
        """What was known after `t_s` seconds."""
        return Curve(tuple(point for point in self.points if point.t_s <= t_s), min(self.end_s, t_s))


def falling(points: Iterable[QualityPoint], end_s: float) -> Curve:
    """Curve of the smallest gap so far."""
    kept: list[QualityPoint] = []
    for point in points:
        if not kept or point.value < kept[-1].value:
            kept.append(point)
    return Curve(tuple(kept), end_s)


def mean_curve(curves: Sequence[Curve]) -> Curve:
    """Mean gap of several runs (seeds), from when all of them had found something, to when the last was over."""
    times = sorted({point.t_s for curve in curves for point in curve.points})
    means = (QualityPoint(t_s, math.fsum(c.gap_at(t_s) for c in curves) / len(curves)) for t_s in times)
    return falling((mean for mean in means if math.isfinite(mean.value)), max(curve.end_s for curve in curves))


@dataclass(frozen=True, slots=True)
class Noise:
    """Gaps that count as equal: up to `floor` and, of the smaller one, `share` above it."""

    floor: float
    share: float = 0.0

    def equal_up_to(self, gap: float) -> float:
        """Largest gap that counts as equal to the smaller `gap`."""
        return gap + self.floor + self.share * gap


def winner(curves: Mapping[str, Curve], noise: Noise) -> str | None:
    """Name of the run with the smallest gap in the end; None where no run found anything.

    Among runs that count as equal to it, the first to get there wins.
    """
    best = min((curve.final_gap for curve in curves.values()), default=math.inf)
    if math.isinf(best):
        return None
    arrivals = {name: curve.time_to(noise.equal_up_to(best)) for name, curve in curves.items()}
    return min((t_s, name) for name, t_s in arrivals.items() if t_s is not None)[1]


@dataclass(frozen=True, slots=True)
class BudgetAnswer:
    """What so many seconds give, and which run gives it; None where nothing had been found by then."""

    budget_s: float
    run: str | None
    gap: float | None


@dataclass(frozen=True, slots=True)
class GapAnswer:
    """After how many seconds the gap was no larger than `gap`, and in which run; None where it never was."""

    gap: float
    run: str | None
    t_s: float | None


@dataclass(frozen=True, slots=True)
class Answers:
    """The winner in the end, the winner at each budget, and the first to reach each gap."""

    winner: str | None
    by_budget: tuple[BudgetAnswer, ...]
    by_gap: tuple[GapAnswer, ...]


def answers(
    curves: Mapping[str, Curve], gaps: Sequence[float], noise: Noise, budgets_s: Sequence[float] = BUDGETS_S
) -> Answers:
    """Winner overall and at each budget by the rule of `winner`, and who is first to reach each of `gaps`."""
    by_budget = []
    for budget_s in budgets_s:
        name = winner({name: curve.until(budget_s) for name, curve in curves.items()}, noise)
        by_budget.append(BudgetAnswer(budget_s, name, None if name is None else curves[name].gap_at(budget_s)))
    by_gap = []
    for gap in gaps:
        reached = [(t_s, name) for name, curve in curves.items() if (t_s := curve.time_to(gap)) is not None]
        t_s, first = min(reached) if reached else (None, None)
        by_gap.append(GapAnswer(gap, first, t_s))
    return Answers(winner(curves, noise), tuple(by_budget), tuple(by_gap))


def seconds_text(t_s: float) -> str:
    """Seconds with two digits or more."""
    return f"{t_s:.0f} s" if t_s >= 100.0 else f"{t_s:.1f} s" if t_s >= 1.0 else f"{t_s:.2g} s"


def answers_summary(found: Answers, key: str, value: Callable[[float], float]) -> dict[str, Any]:
    """Answers as JSON; `value` turns a gap into what is called `key` there."""
    return {
        "winner": found.winner,
        "by_budget": [
            {"t_s": budget.budget_s, "run": budget.run, key: None if budget.gap is None else value(budget.gap)}
            for budget in found.by_budget
        ],
        "by_quality": [{key: value(goal.gap), "run": goal.run, "t_s": goal.t_s} for goal in found.by_gap],
    }
