"""The flights in use: nap of the object and orbit, against greedy with the same number of views."""

from __future__ import annotations

import time
from collections.abc import Iterator

from planning.parameters import GreedyParameters
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import SCENES
from tests.benchmarks.harness import Benchmark, Context, Row
from tests.benchmarks.problems import CURVED_VIEWS, PLANAR_VIEWS


def measure(context: Context) -> Iterator[Row]:
    """Coverage, views, flight time and planning time."""
    scenes = (("office", PLANAR_VIEWS),) if context.is_quick else (("office", PLANAR_VIEWS), ("library", CURVED_VIEWS))
    for scene, n_views in scenes:
        share_of_greedy = 0.0
        for method in ("greedy", "noto", "orbit"):
            started = time.perf_counter()
            request = PlanRequest(
                method=method,
                n_views=n_views,
                time_budget_s=4.0 if context.is_quick else 30.0,
                greedy=GreedyParameters(objective="sections"),
            )
            plan = plan_flight(SCENES[scene](), request).plan
            seconds = time.perf_counter() - started
            share = 100.0 * plan.coverage.covered / plan.coverage.reachable_upper_bound
            share_of_greedy = share_of_greedy or share
            what = f"{method}, {len(plan.viewpoints)} views, planned in {seconds:.1f} s"
            yield Row(scene, f"{what}: covered", share, "% of the bound", share / share_of_greedy, "greedy")
            yield Row(scene, f"{method}: in the air, {len(plan.sorties)} sorties", plan.duration_s / 60.0, "min")


BENCHMARK = Benchmark(
    "baselines",
    "Nap of the object and orbit",
    "The commercial flights that the paper compares itself with, with as many views as the paper's: nap of the object "
    "(a grid at constant distance, as DJI's slope route) and rings around the building. Flight times include turning, "
    "settling and the photo at every view.",
    measure,
)
