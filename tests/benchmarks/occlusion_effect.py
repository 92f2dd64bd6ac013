"""The effect of occlusion: where it decides to be on, how large it is, and what happens when it is overruled."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from planning.coverage.model import exact_coverage
from planning.coverage.reach_kernel import UNREACHABLE
from planning.parameters import Constraints, GreedyParameters
from planning.plan import viewpoint_arrays
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import SCENES
from tests.benchmarks.harness import Benchmark, Context, Row
from tests.benchmarks.problems import prepared

EXPECTED = {"court": True, "canyon": True, "office": False, "library": False, "roof": False}
N_VIEWS = 60


def measure(context: Context) -> Iterator[Row]:
    """Decision and size, then plans with the effect on and off, both judged with it on."""
    scenes = ("court", "office") if context.is_quick else tuple(EXPECTED)
    for scene in scenes:
        decision = prepared(scene).effects[0]
        yield Row(
            scene,
            f"decides by itself: {'on' if decision.on else 'off'} ({decision.reason})",
            decision.size,
            decision.unit,
            target="on for court and canyon, off for the others",
            met=decision.on == EXPECTED[scene],
        )
        judge = prepared(scene, "on").problem
        without = prepared(scene, "off").problem.reachability.verdicts != UNREACHABLE
        changed = int(np.count_nonzero((judge.reachability.verdicts != UNREACHABLE) != without))
        share = 100.0 * changed / without.sum()
        yield Row(scene, "reachable sections that it changes", share, "%")
        for occlusion in ("on", "off"):
            started = time.perf_counter()
            request = PlanRequest(
                n_views=N_VIEWS,
                constraints=replace(Constraints(), occlusion=occlusion),
                greedy=GreedyParameters(objective="sections"),
                time_budget_s=6.0 if context.is_quick else 15.0,
            )
            plan = plan_flight(SCENES[scene](), request).plan
            seconds = time.perf_counter() - started
            truly = int((exact_coverage(judge.model, viewpoint_arrays(plan.viewpoints)) > 0).sum())
            what = f"{N_VIEWS} views planned with it {occlusion}, {seconds:.1f} s: truly covered"
            yield Row(scene, what, truly, "sections", truly / judge.reachability.upper_bound, "the bound")
            if occlusion == "off":
                missing = plan.coverage.covered - truly
                yield Row(scene, "sections such a plan believes to cover and does not", missing, "sections")


BENCHMARK = Benchmark(
    "occlusion",
    "Occlusion only where a scene calls for it",
    "On an L-shaped court and in a street canyon lines of sight are blocked, on free-standing planar, curved and roof "
    "scenes they are not: the effect looks at the scene and decides. Plans with the effect forced on and off are both "
    "counted with lines of sight tested.",
    measure,
)
