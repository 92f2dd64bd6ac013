"""What runs of the routing methods on one tour say: rows for a table, a panel for a picture, winner and answers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from planning.tradeoff.curves import Answers, Curve, answers, answers_summary, seconds_text
from planning.tradeoff.picture import Line, Panel
from planning.tradeoff.tour_runs import TOUR_GAPS, TOUR_NOISE, TourCase, TourRun, tour_curve


@dataclass(frozen=True, slots=True, eq=False)
class TourReport:
    """Runs on one tour, compared.

    Parameters
    ----------
    curves
        Gap above the reference (the optimum where it is known, else the lower bound) against time, by method.
    """

    case: TourCase
    runs: tuple[TourRun, ...]
    curves: dict[str, Curve]
    answers: Answers

    @property
    def n_points(self) -> int:
        """Points of the tour, home included."""
        return len(self.case.cost)

    def length_of(self, method: str) -> float:
        """Length that a method ended with."""
        return next(run.points[-1].value for run in self.runs if run.method == method)


def tour_report(case: TourCase, runs: Sequence[TourRun]) -> TourReport:
    """Compare runs on one tour."""
    curves: dict[str, Curve] = {run.method: tour_curve(run, case.reference) for run in runs}
    return TourReport(case, tuple(runs), curves, answers(curves, TOUR_GAPS, TOUR_NOISE))


def tour_rows(report: TourReport) -> list[dict[str, Any]]:
    """One row a point of a curve."""
    case = report.case
    return [
        {
            "case": case.name,
            "method": run.method,
            "seed": run.seed,
            "n_points": report.n_points,
            "unit": case.unit,
            "t_s": round(point.t_s, 4),
            "length": plain(point.value),
            "lower_bound": plain(case.lower_bound),
            "optimum": "" if case.optimum is None else plain(case.optimum),
            "above_bound": _above(point.value, case.lower_bound),
            "above_optimum": "" if case.optimum is None else _above(point.value, case.optimum),
            "is_final": int(number == len(run.points) - 1),
        }
        for run in report.runs
        for number, point in enumerate(run.points)
    ]


def tour_panel(report: TourReport) -> Panel:
    """All methods above the lower bound, the known optimum as a line; the winner leads."""
    case, best = report.case, report.answers.winner
    runs = sorted(report.runs, key=lambda run: run.method != best)
    lines = []
    for run in runs:
        curve = tour_curve(run, case.lower_bound)
        remark = (
            f"{gap_text(curve.final_gap)} after {seconds_text(curve.points[-1].t_s)}" if curve.points else "no tour"
        )
        lines.append(Line(run.method, curve, remark))
    marks: tuple[tuple[str, float], ...] = ()
    if case.optimum is not None and case.lower_bound > 0.0:
        marks = (("known optimum", case.optimum / case.lower_bound - 1.0),)
    return Panel(f"{case.name}, {report.n_points} points", tuple(lines), marks)


def tour_title(report: TourReport) -> str:
    """The winner in one line."""
    case, best = report.case, report.answers.winner
    if best is None:
        return f"{case.name}: no method found a tour"
    length = report.length_of(best)
    reached = report.curves[best].points[-1].t_s
    above = "the optimum" if case.optimum is not None else "the lower bound"
    return (
        f"{case.name}: '{best}' wins with {plain(length)}{' ' + case.unit if case.unit else ''}, "
        f"{gap_text(report.curves[best].final_gap)} to {above}, after {seconds_text(reached)}"
    )


def gap_text(gap: float) -> str:
    """A gap in percent with sign."""
    return f"{100.0 * gap:+.2f} %"


def plain(value: float) -> float | int:
    """A whole number where it is one, else rounded to 0.001."""
    return int(value) if math.isfinite(value) and value == int(value) else round(value, 3)


def _above(length: float, reference: float) -> float | str:
    return round(length / reference - 1.0, 6) if reference > 0.0 and math.isfinite(length) else ""


def tour_summary(report: TourReport) -> dict[str, Any]:
    """The report as JSON; lengths in the case's unit."""
    case = report.case
    return {
        "case": case.name,
        "points": report.n_points,
        "unit": case.unit,
        "lower_bound": plain(case.lower_bound),
        "optimum": None if case.optimum is None else plain(case.optimum),
        "gap_is_above": "lower_bound" if case.optimum is None else "optimum",
        **answers_summary(report.answers, "gap", lambda gap: round(gap, 6)),
        "runs": [
            {
                "run": method,
                "length": plain(report.length_of(method)) if curve.points else None,
                "gap": round(curve.final_gap, 6) if curve.points else None,
                "best_s": curve.points[-1].t_s if curve.points else None,
                "seconds": curve.end_s,
            }
            for method, curve in report.curves.items()
        ],
    }
