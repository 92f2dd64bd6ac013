"""What runs of the planner on one site say: rows for a table, panels for a picture, the winner and the answers."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from planning.request import PlanRequest
from planning.tradeoff.curves import Answers, Curve, answers, answers_summary, mean_curve, seconds_text
from planning.tradeoff.picture import Line, Panel
from planning.tradeoff.plan_runs import (
    COVERAGE_GAPS,
    COVERAGE_NOISE,
    PlanRun,
    bounds_by_step,
    common_curves,
    name_of,
    own_curve,
)

METHOD_KNOB, STEP_KNOB = "Which method?", "How fine sections? (each run counts its own)"

KNOBS: dict[str, Callable[[PlanRequest], str]] = {
    METHOD_KNOB: lambda request: request.method,
    "Which precision of the coverage kernel?": lambda request: request.precision,
    STEP_KNOB: lambda request: f"{request.constraints.section_step_deg:g}°",
    "How many candidate views?": lambda request: str(request.greedy.n_candidates),
}
"""What a panel asks, and the value of that knob."""

ROUNDING = 1e-12
"""Gaps are differences of shares; what is smaller is rounding."""


@dataclass(frozen=True, slots=True, eq=False)
class PlanReport:
    """Runs on one site, compared.

    Parameters
    ----------
    steps_deg
        Section steps in which all runs were counted: the base step, and the finest where it is finer.
    bounds
        What can be covered at most, by section step.
    curves
        Coverage gap against time by name, in sections of each of `steps_deg`; the mean over seeds.
    answers
        Winner and answers for each of `steps_deg`; the first counts.
    """

    site: str
    base: PlanRequest
    runs: tuple[PlanRun, ...]
    steps_deg: tuple[float, ...]
    bounds: dict[float, int]
    curves: dict[float, dict[str, Curve]]
    answers: dict[float, Answers]

    @property
    def base_step_deg(self) -> float:
        """Step of the sections asked for."""
        return self.steps_deg[0]

    @property
    def winner(self) -> str:
        """Name of the setting that wins by the sections asked for."""
        name = self.answers[self.base_step_deg].winner
        assert name is not None  # a report has a run, and every run has a point
        return name

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the settings, the base request first."""
        return tuple(self.curves[self.base_step_deg])

    def of(self, name: str) -> tuple[PlanRun, ...]:
        """Runs of one setting: its seeds."""
        return tuple(run for run in self.runs if name_of(run.request, self.base) == name)


def plan_report(runs: Sequence[PlanRun], base: PlanRequest) -> PlanReport:
    """Compare runs on one site; at least one of them counted the sections asked for.

    Section steps for which every run failed are left out.
    """
    bounds = bounds_by_step(runs)
    steps = tuple(count.step_deg for count in runs[0].counts if count.step_deg in bounds)
    curves = {step: common_curves(runs, base, step, bounds) for step in steps}
    n_seeds = max(sum(name_of(run.request, base) == name for run in runs) for name in curves[steps[0]])
    noise = replace(COVERAGE_NOISE, share=COVERAGE_NOISE.share / math.sqrt(n_seeds))
    found = {step: answers(curves[step], COVERAGE_GAPS, noise) for step in steps}
    return PlanReport(runs[0].site, base, tuple(runs), steps, bounds, curves, found)


def plan_rows(report: PlanReport) -> list[dict[str, Any]]:
    """One row a point of a curve; what only the finished plan has stands in its last row."""
    rows = []
    for run in report.runs:
        request = run.request
        step = request.constraints.section_step_deg
        bound = report.bounds[step]
        for number, point in enumerate(run.points):
            is_final = number == len(run.points) - 1
            row: dict[str, Any] = {
                "site": run.site,
                "run": name_of(request, report.base),
                "method": request.method,
                "precision": request.precision,
                "step_deg": step,
                "n_candidates": request.greedy.n_candidates if request.method == "greedy" else "",
                "seed": request.seed,
                "n_views": run.n_views,
                "t_s": round(point.t_s, 4),
                "covered": point.covered,
                "bound": bound,
                "total": run.total,
                "share_of_bound": round(point.covered / bound, 6),
                "is_final": int(is_final),
                "n_sorties": run.n_sorties if is_final else "",
                "flight_s": round(run.flight_s, 1) if is_final else "",
            }
            for label, count_step in zip(("asked", "finest"), report.steps_deg, strict=False):
                covered = next(count.covered for count in run.counts if count.step_deg == count_step)
                row[f"{label}_step_deg"] = count_step
                row[f"{label}_covered"] = covered if is_final else ""
                row[f"{label}_bound"] = report.bounds[count_step]
                row[f"{label}_share"] = round(covered / report.bounds[count_step], 6) if is_final else ""
            rows.append(row)
    return rows


def plan_panels(report: PlanReport) -> tuple[Panel, ...]:
    """One panel for each knob with more than one value; the base request leads in each."""
    base = report.base
    groups: dict[str, list[str]] = {}
    for name in report.names:
        request = report.of(name)[0].request
        knob = next((knob for knob, value in KNOBS.items() if value(request) != value(base)), None)
        if knob is not None:
            groups.setdefault(knob, []).append(name)
    leading = [name for name in (name_of(base, base),) if name in report.names]
    if not groups:
        return (Panel(report.site, tuple(_line(report, name, METHOD_KNOB) for name in leading)),)
    return tuple(
        Panel(f"{report.site}: {knob}", tuple(_line(report, name, knob) for name in (*leading, *names)))
        for knob, names in groups.items()
    )


def _line(report: PlanReport, name: str, knob: str) -> Line:
    """Curve with its end in words; where runs count sections of their own, also how they do in the finest ones."""
    runs = report.of(name)
    curve = mean_curve([own_curve(run, report.bounds) for run in runs])
    remark = f"{share_text(curve.final_gap)} after {seconds_text(curve.points[-1].t_s)}"
    if knob == STEP_KNOB:
        finest = report.steps_deg[-1]
        remark += f"; counted in {finest:g}°: {share_text(report.curves[finest][name].final_gap)}"
    return Line(KNOBS[knob](runs[0].request), curve, remark)


def share_text(gap: float) -> str:
    """Share that a gap leaves, in percent: never 100 % where something is missing."""
    percent = 100.0 * (1.0 - gap)
    decimals = 3 if 99.95 <= percent < 100.0 else 2 if percent >= 99.0 else 1
    return f"{percent:.{decimals}f} %" if gap > 0.0 else "100 %"


def plan_title(report: PlanReport) -> str:
    """The winner in one line."""
    curve = report.curves[report.base_step_deg][report.winner]
    runs = report.of(report.winner)
    return (
        f"{report.site}: '{report.winner}' wins with {share_text(curve.final_gap)} of what can be covered, "
        f"after {seconds_text(curve.points[-1].t_s)} ({runs[0].n_views} views)"
    )


def time_to_part_s(curve: Curve, part: float) -> float:
    """Seconds until a run had so much (0 to 1) of the coverage that it has in the end."""
    t_s = curve.time_to(1.0 - part * (1.0 - curve.final_gap) + ROUNDING)
    assert t_s is not None  # the end itself is enough
    return t_s


def plan_summary(report: PlanReport) -> dict[str, Any]:
    """The report as JSON: shares of the bound, seconds."""

    def share(gap: float) -> float:
        return round(1.0 - gap, 6)

    step, finest = report.base_step_deg, report.steps_deg[-1]
    runs = []
    for name in report.names:
        curve, own = report.curves[step][name], report.of(name)
        final = mean_curve([own_curve(run, report.bounds) for run in own])
        runs.append(
            {
                "run": name,
                "seeds": [run.request.seed for run in own],
                "views": own[0].n_views,
                "share": share(curve.final_gap),
                "share_in_finest": share(report.curves[finest][name].final_gap),
                "step_deg": own[0].request.constraints.section_step_deg,
                "share_in_own": share(final.final_gap),
                "first_s": curve.points[0].t_s,
                "best_s": curve.points[-1].t_s,
                "plan_ready_s": curve.end_s,
                "time_to_share_of_final_s": {
                    f"{1.0 - gap:g}": time_to_part_s(final, 1.0 - gap) for gap in COVERAGE_GAPS
                },
            }
        )
    return {
        "site": report.site,
        "step_deg": step,
        "reachable_upper_bound": report.bounds[step],
        "total": next(count.total for count in report.runs[0].counts if count.step_deg == step),
        "finest_step_deg": finest,
        "finest_reachable_upper_bound": report.bounds[finest],
        **answers_summary(report.answers[step], "share", share),
        "winner_in_finest": report.answers[finest].winner,
        "runs": runs,
    }
