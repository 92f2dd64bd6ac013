"""What float32 costs in coverage and saves in time, over whole plans."""

from __future__ import annotations

import time
from collections.abc import Iterator

from planning.coverage.evaluate import coverage_counts
from planning.parameters import GreedyParameters, Precision
from planning.plan import viewpoint_arrays
from planning.planner import Planned, plan_flight
from planning.request import PlanRequest
from planning.site.bundled import SCENES
from tests.benchmarks.harness import Benchmark, Context, Row
from tests.benchmarks.problems import prepared

N_VIEWS = 100


def measure(context: Context) -> Iterator[Row]:
    """Time, coverage, and sections counted differently."""
    scenes = ("office",) if context.is_quick else ("office", "library", "court")
    budget_s = 4.0 if context.is_quick else 20.0
    for scene in scenes:
        plans: dict[Precision, Planned] = {}
        for precision in ("f64", "f32"):
            started = time.perf_counter()
            request = PlanRequest(
                n_views=N_VIEWS,
                precision=precision,
                time_budget_s=budget_s,
                greedy=GreedyParameters(objective="sections"),
            )
            plans[precision] = plan_flight(SCENES[scene](), request)
            seconds = time.perf_counter() - started
            coverage = plans[precision].plan.coverage
            share = 100.0 * coverage.covered / coverage.reachable_upper_bound
            yield Row(scene, f"{N_VIEWS} views, {precision}: covered", share, "% of the bound")
            yield Row(scene, f"{N_VIEWS} views, {precision}: whole plan", seconds, "s")
        problem = prepared(scene).problem
        viewpoints = plans["f32"].plan.viewpoints
        exact = coverage_counts(problem.model, viewpoints) > 0
        differing = int((problem.model.covered(viewpoint_arrays(viewpoints)) != exact.reshape(-1)).sum())
        yield Row(scene, "sections that f32 counts otherwise than float64, same plan", differing, f"of {exact.size}")


BENCHMARK = Benchmark(
    "precision",
    "float32 against float64",
    "Whole plans with the kernel in either precision, the same seed and time budget. The views differ, because the "
    "search takes other turns; the last line of each site counts one plan's sections in both.",
    measure,
)
