"""Tours compared: routing methods on the same tour, their length against time, with a bound and a known optimum.

A tour is one of a TSPLIB file, or the closed tour through home and all viewpoints of a plan, as if one battery were
enough: its legs lead around the building, and their lengths are the seconds that flying and turning takes.
"""

from __future__ import annotations

import importlib
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import Message, say
from planning.base.progress import QUIET, Monitor, QualityPoint, TimeLimit
from planning.plan import Plan, viewpoint_arrays
from planning.routing.flights import flight_times
from planning.routing.methods import TourMethod, solve_tour, tour_curves
from planning.routing.roadmap import build_roadmap
from planning.routing.tour import tour_length
from planning.routing.tsplib import read_instance, read_tour, tour_order
from planning.site.free_space import free_space
from planning.site.records import SiteModel
from planning.tradeoff.runner import Answers, Curve, Line, Noise, Panel, answers, answers_summary, falling, seconds_text

TOUR_METHODS: tuple[TourMethod, ...] = get_args(TourMethod)

TOUR_GAPS = (0.1, 0.05, 0.03, 0.01)
"""Lengths of 10, 5, 3 and 1 % above the reference: when were they reached?"""

TOUR_NOISE = Noise(floor=1e-4)
"""Tours whose lengths differ by less than this part count as equally short."""

BOUND_LIMIT_S = 25.0
"""Of this, `solve_tour` gives a fifth to the lower bound; 724 points need 0.3 s."""


@dataclass(frozen=True, slots=True, eq=False)
class TourCase:
    """One tour to be found.

    Parameters
    ----------
    cost
        Shape (n, n).
    unit
        Of the costs: `s` for plans, nothing for TSPLIB files.
    lower_bound
        No tour is shorter.
    optimum
        Length of the shortest tour, where it is known.
    """

    name: str
    cost: NDArray[np.float64]
    unit: str
    lower_bound: float
    optimum: float | None = None

    @property
    def reference(self) -> float:
        """What lengths are compared with: the optimum where it is known, else the lower bound."""
        return self.lower_bound if self.optimum is None else self.optimum

    @property
    def is_symmetric(self) -> bool:
        """Whether both directions of every leg cost the same."""
        return bool(np.array_equal(self.cost, self.cost.T))


@dataclass(frozen=True, slots=True)
class TourRun:
    """Length of the best tour so far against time; the last point is where the run ended."""

    case: str
    method: TourMethod
    seed: int
    points: tuple[QualityPoint, ...]


def tour_methods(names: Sequence[str]) -> tuple[TourMethod, ...]:
    """Methods by name.

    Raises
    ------
    InputError
        There is no such method; the message lists those there are.
    """
    unknown = next((name for name in names if name not in TOUR_METHODS), None)
    if unknown is not None:
        raise InputError.say("there is no routing method '{}'; known are: {}", unknown, ", ".join(TOUR_METHODS))
    return tuple(method for method in TOUR_METHODS if method in names)


def tsplib_case(path: Path, monitor: Monitor = QUIET) -> TourCase:
    """Case of a TSPLIB file; an optimal tour beside it (`NAME.opt.tour`) gives the known optimum.

    Raises
    ------
    InputError
        The file is missing or wrong, or a CVRP.
    """
    instance = read_instance(path)
    if instance.kind == "CVRP":
        raise InputError.say("a CVRP needs several routes; expected a TSP or ATSP", place=path)
    tour_path = path.with_suffix(".opt.tour")
    optimum = None
    if tour_path.is_file():
        optimum = tour_length(instance.cost, tour_order(instance, read_tour(tour_path)))
    return TourCase(instance.name, instance.cost, "", _lower_bound(instance.cost, monitor), optimum)


def plan_case(plan: Plan, site_model: SiteModel, monitor: Monitor = QUIET) -> TourCase:
    """Case of a plan's viewpoints, home first.

    Raises
    ------
    InputError
        The plan has fewer than two viewpoints.
    InfeasibleError
        Home cannot be used, or a viewpoint cannot be reached from it.
    """
    if len(plan.viewpoints) < 2:
        raise InputError.say(
            "expected two viewpoints or more, got {}", len(plan.viewpoints), place=f"plan of '{plan.site}'"
        )
    roadmap = build_roadmap(
        free_space(site_model, plan.constraints.min_distance_m, plan.constraints.min_height_above_ground_m), plan.seed
    )
    times = flight_times(roadmap, viewpoint_arrays(plan.viewpoints), plan.aircraft, plan.rules, monitor)
    # Only legs from and to home differ by direction, and both directions around a tour together use each once.
    cost = (times.travel_s + times.travel_s.T) / 2.0
    np.fill_diagonal(cost, 0.0)
    return TourCase(plan.site, cost, "s", _lower_bound(cost, monitor))


def _lower_bound(cost: NDArray[np.float64], monitor: Monitor) -> float:
    return solve_tour(cost, "nearest-neighbour", TimeLimit(BOUND_LIMIT_S), monitor=monitor).lower_bound


def run_tours(
    case: TourCase,
    seconds: float,
    methods: Sequence[TourMethod] = TOUR_METHODS,
    seed: int = 0,
    monitor: Monitor = QUIET,
) -> tuple[TourRun, ...]:
    """Each method for so many seconds, one after the other; local search is left out where costs are asymmetric.

    Raises
    ------
    InputError
        No method is left.
    """
    if any(method.startswith("pyvrp") for method in methods):
        importlib.import_module("planning.routing.vrp")  # so that the first run does not pay for loading it
    possible = [method for method in methods if method != "local-search" or case.is_symmetric]
    if not possible:
        raise InputError.say(
            "local-search needs the same cost in both directions; add the method pyvrp", place=case.name
        )
    curves = tour_curves(case.cost, seconds, methods=possible, seed=seed, monitor=monitor)
    return tuple(TourRun(case.name, method, seed, tuple(trace.points)) for method, trace in curves.items())


def tour_curve(run: TourRun, reference: float) -> Curve:
    """Gap of a run above the reference length."""
    scale = reference if reference > 0.0 else 1.0
    points = (QualityPoint(p.t_s, p.value / scale - 1.0) for p in run.points if math.isfinite(p.value))
    return falling(points, run.points[-1].t_s)


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


def tour_title(report: TourReport) -> Message:
    """The winner in one line."""
    case, best = report.case, report.answers.winner
    if best is None:
        return say("no method found a tour", place=case.name)
    length = report.length_of(best)
    reached = report.curves[best].points[-1].t_s
    above = say("the optimum") if case.optimum is not None else say("the lower bound")
    long = f"{plain(length)} {case.unit}".rstrip()
    return say(
        "'{}' wins with {}, {} to {}, after {}",
        *(best, long, gap_text(report.curves[best].final_gap), above, seconds_text(reached)),
        place=case.name,
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
