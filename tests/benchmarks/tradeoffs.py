"""Quality against time of whole plans and of tours, as `tradeoff` draws it."""

from __future__ import annotations

from collections.abc import Iterator

from planning.request import PlanRequest
from planning.site.bundled import SCENES
from planning.tradeoff.plans import (
    PlanRun,
    Variants,
    common_steps,
    load_kernels,
    plan_panels,
    plan_report,
    plan_title,
    run_plan,
    settings,
)
from planning.tradeoff.runner import COVERAGE_AXIS, TOUR_AXIS, draw, seconds_text
from planning.tradeoff.tours import run_tours, tour_panel, tour_report, tour_title, tsplib_case
from tests.benchmarks.harness import Benchmark, Context, Row
from tests.benchmarks.problems import PLANAR_VIEWS

FEW_VIEWS = 56
ALL_KNOBS = Variants()
CANDIDATES = Variants(("greedy", "pso"), ("f32", "f64"), (30.0,), (1000, 2000, 5000, 20_000, 50_000))
QUICK = Variants(("greedy", "noto"), ("f32",), (30.0,), (2000, 20_000))


def measure(context: Context) -> Iterator[Row]:
    """Every knob with the paper's number of views, the search for few views more closely, and a tour."""
    if context.is_quick:
        yield from _plans(context, FEW_VIEWS, QUICK, 4.0)
    else:
        yield from _plans(context, PLANAR_VIEWS, ALL_KNOBS, 30.0)
        yield from _plans(context, FEW_VIEWS, CANDIDATES, 20.0)
    yield from _tour(context, "pcb442", 1.0 if context.is_quick else 10.0)


def _plans(context: Context, n_views: int, variants: Variants, budget_s: float) -> Iterator[Row]:
    base = PlanRequest(n_views=n_views, time_budget_s=budget_s)
    requests = settings(base, variants)
    load_kernels(requests)
    steps = common_steps(requests)
    runs = [run_plan(SCENES["office"](), request, steps) for request in requests]
    report = plan_report([run for run in runs if isinstance(run, PlanRun)], base)
    path = context.folder / f"tradeoff-office-{n_views}.png"
    draw(plan_title(report), plan_panels(report), COVERAGE_AXIS, path)
    finest = steps[-1]
    for name in report.names:
        curve = report.curves[report.base_step_deg][name]
        first_s, best_s = (seconds_text(point.t_s) for point in (curve.points[0], curve.points[-1]))
        what = f"{n_views} views, {name}: first after {first_s}, best after {best_s}, plan {seconds_text(curve.end_s)}"
        in_finest = 100.0 * (1.0 - report.curves[finest][name].final_gap)
        beside = f"{in_finest:.1f} % of the sections of {finest:g}°" if finest < report.base_step_deg else ""
        yield Row("office", what, 100.0 * (1.0 - curve.final_gap), "% of the bound", against=beside)


def _tour(context: Context, name: str, seconds: float) -> Iterator[Row]:
    case = tsplib_case(context.data(f"routing/tsplib/{name}.tsp"))
    report = tour_report(case, run_tours(case, seconds))
    draw(tour_title(report), [tour_panel(report)], TOUR_AXIS, context.folder / f"tradeoff-{name}.png")
    for method, curve in report.curves.items():
        what = f"{method}, {seconds:g} s: best after {seconds_text(curve.points[-1].t_s)}"
        yield Row(name, what, report.length_of(method), "", 1.0 + curve.final_gap, "the optimum")


BENCHMARK = Benchmark(
    "tradeoff",
    "What accuracy costs in time",
    "Coverage against time on the office for every method, precision, section step and number of candidates, one knob "
    "at a time, with the paper's 560 views and with a tenth of them; and tour length against time. Times count from "
    "reading the site and include all preparation. `app.py tradeoff plan` and `app.py tradeoff route` draw the same "
    "for any site and tour.",
    measure,
)
