"""Plans compared: runs of the planner with different settings on the same sites, each with its coverage against time.

Time starts when the site is read and includes all preparation. Counts of the fast kernel while a run goes on are cut
at what its plan covers in the end by the definition in float64.

What a run covers depends on the sections it counts. To compare runs with different section steps, the final views of
each are also counted, in float64, in two kinds of sections that are the same for all: those asked for (the base step),
and the finest ones of any run. The winner is chosen by the sections asked for; whether planning with finer ones pays
shows in the finest.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, get_args

from planning.base.errors import InfeasibleError, InputError
from planning.base.messages import Message, say
from planning.base.progress import QUIET, Monitor, QualityPoint, Trace
from planning.coverage.evaluate import coverage_counts
from planning.parameters import LARGEST_SEED, Constraints, GreedyParameters, Precision
from planning.plan import HistoryPoint
from planning.planner import Planned, plan_flight
from planning.request import PlanRequest
from planning.site.bundled import SCENES
from planning.site.free_space import free_space
from planning.site.records import SiteModel
from planning.tradeoff.runner import (
    Answers,
    Curve,
    Line,
    Noise,
    Panel,
    answers,
    answers_summary,
    falling,
    mean_curve,
    seconds_text,
)
from planning.viewpoints.methods import method_named
from planning.viewpoints.prepare import coverage_model

COVERAGE_GAPS = (0.1, 0.05, 0.01, 0.001)
"""Shares of 90, 95, 99 and 99.9 % of the bound: when were they reached?"""

COVERAGE_NOISE = Noise(floor=2e-4, share=0.06)
"""One or two sections of the bundled office, and the scatter over seeds: with 56 views on the office the gap is 4.2 %
with a standard deviation of 0.17 %, with 100 on the library 5.6 and 0.12 %; two runs differ by 1.4 times as much."""


@dataclass(frozen=True, slots=True)
class Variants:
    """Values to try of each knob; the values of the base request are always tried as well.

    Raises
    ------
    InputError
        There is no such method or precision.
    """

    methods: tuple[str, ...] = ("greedy", "pso", "noto", "orbit")
    precisions: tuple[Precision, ...] = ("f32", "f64")
    steps_deg: tuple[float, ...] = (30.0, 15.0, 10.0, 5.0)
    n_candidates: tuple[int, ...] = (2000, 5000, 20_000)

    def __post_init__(self) -> None:
        for method in self.methods:
            method_named(method)
        for precision in self.precisions:
            if precision not in get_args(Precision):
                raise InputError.say(
                    "there is no precision '{}'; known are: {}", precision, ", ".join(get_args(Precision))
                )
        for n in self.n_candidates:
            if n < 1:
                raise ValueError(f"candidates: expected 1 or more, got {n}")


@dataclass(frozen=True, slots=True)
class StepCount:
    """Sections of `step_deg` that the final views of a run cover, by the definition in float64."""

    step_deg: float
    covered: int
    total: int


@dataclass(frozen=True, slots=True)
class PlanRun:
    """One run.

    Parameters
    ----------
    points
        Best coverage so far, in the sections that the run counted; the last point is the finished plan, sorties
        included.
    bound
        Upper bound that the run proved for its own sections.
    counts
        What the final views cover in sections that are the same for all runs.
    flight_s
        In the air, all sorties.
    """

    site: str
    request: PlanRequest
    points: tuple[HistoryPoint, ...]
    bound: int
    total: int
    counts: tuple[StepCount, ...]
    n_views: int
    n_sorties: int
    flight_s: float


@dataclass(frozen=True, slots=True)
class FailedRun:
    """A run that could not be done, and why."""

    site: str
    request: PlanRequest
    message: str


def settings(base: PlanRequest, variants: Variants, n_seeds: int = 1) -> tuple[PlanRequest, ...]:
    """Base request first, then one knob at a time: methods, precisions, section steps, candidates; each seed of each.

    Raises
    ------
    ValueError
        A section step does not divide 90 degrees.
    """
    requests = [base]
    requests += [replace(base, method=method) for method in variants.methods]
    requests += [replace(base, precision=precision) for precision in variants.precisions]
    requests += [
        replace(base, constraints=replace(base.constraints, section_step_deg=step)) for step in variants.steps_deg
    ]
    if base.method == "greedy":
        requests += [replace(base, greedy=replace(base.greedy, n_candidates=n)) for n in variants.n_candidates]
    different = tuple(dict.fromkeys(requests))
    seeds = [(base.seed + i) % (LARGEST_SEED + 1) for i in range(n_seeds)]
    return tuple(replace(request, seed=seed) for request in different for seed in seeds)


def common_steps(requests: Sequence[PlanRequest]) -> tuple[float, ...]:
    """Section steps in which the final views of all runs are counted: the base step, and the finest where finer."""
    base_step = requests[0].constraints.section_step_deg
    finest = min(request.constraints.section_step_deg for request in requests)
    return (base_step,) if finest == base_step else (base_step, finest)


def name_of(request: PlanRequest, base: PlanRequest) -> str:
    """Short name: the method, and what differs from the base request but for the seed."""
    words = [request.method]
    if request.precision != base.precision:
        words.append(request.precision)
    if request.constraints.section_step_deg != base.constraints.section_step_deg:
        words.append(f"{request.constraints.section_step_deg:g}°")
    if request.greedy.n_candidates != base.greedy.n_candidates:
        words.append(f"{request.greedy.n_candidates} candidates")
    return " ".join(words)


def run_plan(
    site_model: SiteModel,
    request: PlanRequest,
    steps_deg: tuple[float, ...],
    read_s: float = 0.0,
    monitor: Monitor = QUIET,
) -> PlanRun | FailedRun:
    """Plan once and count what the views cover in sections of `steps_deg`.

    `read_s`, the time it took to read the site, is added to all times.
    """
    trace = Trace()
    try:
        planned = plan_flight(site_model, request, trace=trace, monitor=monitor)
    except (InputError, InfeasibleError) as error:
        return FailedRun(site_model.site.name, request, str(error))
    ready_s = trace.elapsed_s()
    plan = planned.plan
    return PlanRun(
        site=site_model.site.name,
        request=request,
        points=_points(trace, planned, ready_s, read_s),
        bound=plan.coverage.reachable_upper_bound,
        total=plan.coverage.total,
        counts=tuple(_count(site_model, planned, step) for step in steps_deg),
        n_views=len(plan.viewpoints),
        n_sorties=len(plan.sorties),
        flight_s=plan.duration_s,
    )


def _points(trace: Trace, planned: Planned, ready_s: float, read_s: float) -> tuple[HistoryPoint, ...]:
    covered = planned.plan.coverage.covered
    points: list[HistoryPoint] = []
    for point in trace.points:
        best = min(int(point.value), covered)
        if not points or best > points[-1].covered:
            points.append(HistoryPoint(point.t_s + read_s, best))
    return (*points, HistoryPoint(ready_s + read_s, covered))


def _count(site_model: SiteModel, planned: Planned, step_deg: float) -> StepCount:
    plan = planned.plan
    constraints = replace(plan.constraints, section_step_deg=step_deg)
    space = free_space(site_model, constraints.min_distance_m, constraints.min_height_above_ground_m)
    model = coverage_model(site_model, space, plan.camera, constraints)
    covered = int((coverage_counts(model, plan.viewpoints) > 0).sum())
    return StepCount(step_deg, covered, model.n_elements)


def bounds_by_step(runs: Sequence[PlanRun]) -> dict[float, int]:
    """Lowest bound that any run on one site proved for each section step; runs that ran out of time prove less."""
    bounds: dict[float, int] = {}
    for run in runs:
        step = run.request.constraints.section_step_deg
        bounds[step] = min(run.bound, bounds.get(step, run.bound))
    for run in runs:
        for count in run.counts:
            if count.step_deg in bounds:
                bounds[count.step_deg] = max(bounds[count.step_deg], count.covered)
    return bounds


def own_curve(run: PlanRun, bounds: dict[float, int]) -> Curve:
    """Gap of a run in the sections that it counted itself."""
    bound = bounds[run.request.constraints.section_step_deg]
    points = (QualityPoint(point.t_s, 1.0 - point.covered / bound) for point in run.points)
    return falling(points, run.points[-1].t_s)


def common_curve(run: PlanRun, step_deg: float, bounds: dict[float, int]) -> Curve:
    """Gap of a run in sections of `step_deg`; where it counted others, only its finished plan is known."""
    if run.request.constraints.section_step_deg == step_deg:
        return own_curve(run, bounds)
    covered = next(count.covered for count in run.counts if count.step_deg == step_deg)
    end_s = run.points[-1].t_s
    return Curve((QualityPoint(end_s, 1.0 - covered / bounds[step_deg]),), end_s)


def common_curves(
    runs: Sequence[PlanRun], base: PlanRequest, step_deg: float, bounds: dict[float, int]
) -> dict[str, Curve]:
    """Curve of every setting by name, in sections of `step_deg`: the mean over its seeds."""
    by_name: dict[str, list[Curve]] = {}
    for run in runs:
        by_name.setdefault(name_of(run.request, base), []).append(common_curve(run, step_deg, bounds))
    return {name: mean_curve(curves) for name, curves in by_name.items()}


def load_kernels(requests: Sequence[PlanRequest]) -> None:
    """Load the compiled kernels that `requests` use, so that the first run timed does not pay for it."""
    for precision, step_deg in sorted(
        {(request.precision, request.constraints.section_step_deg) for request in requests}
    ):
        _load_kernels(precision, step_deg)


@cache
def _load_kernels(precision: Precision, step_deg: float) -> None:
    """Once in a process."""
    few = GreedyParameters(n_candidates=50, objective="sections")
    constraints = Constraints(section_step_deg=step_deg, occlusion="on")
    request = PlanRequest(n_views=2, greedy=few, precision=precision, constraints=constraints, time_budget_s=0.1)
    plan_flight(SCENES["single-panel"](), request)


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


def plan_title(report: PlanReport) -> Message:
    """The winner in one line."""
    curve = report.curves[report.base_step_deg][report.winner]
    runs = report.of(report.winner)
    return say(
        "'{}' wins with {} of what can be covered, after {} ({} views)",
        *(report.winner, share_text(curve.final_gap), seconds_text(curve.points[-1].t_s), runs[0].n_views),
        place=report.site,
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
