"""Editing a plan by hand: time of each edit against checking and counting the plan from scratch; planning again."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from planning.checks import check_plan
from planning.coverage.evaluate import coverage
from planning.geo.frames import Vec3
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.revision.edits import Revision, add, delete, lock, move, revise
from planning.site.bundled import SCENES
from planning.site.records import SiteModel
from tests.benchmarks.harness import Benchmark, Context, Row, timer
from tests.benchmarks.problems import PLANAR_VIEWS

CASES = {"office": PLANAR_VIEWS, "tower": 1000, "canyon": 300}
TARGET_MS = 100.0
N_EDITS, N_SCRATCH = 100, 5

SHORT_MOVE_M, LONG_MOVE_M = 2.0, 20.0
"""Standard deviation in each direction: a nudge, and a move that often ends behind or inside something."""

Edit = Callable[[int], Revision]


def measure(context: Context) -> Iterator[Row]:
    """Percentiles of the edits, what measuring from scratch takes in the same run, and what a prepared site saves."""
    for scene in ("office",) if context.is_quick else CASES:
        site_model, request = SCENES[scene](), PlanRequest(n_views=CASES[scene], time_budget_s=30.0)
        with timer() as first_s:
            planned = plan_flight(site_model, request)
        with timer() as again_s:
            plan_flight(site_model, request, prepared=planned.prepared)
        what = f"{CASES[scene]} views: planning again with the prepared site"
        yield Row(scene, what, again_s(), "s", again_s() / first_s(), "the first plan")
        start = revise(planned.plan, planned.prepared)
        scratch_ms = float(np.median([_scratch_ms(start, site_model) for _ in range(N_SCRATCH)]))
        n_views = len(planned.plan.viewpoints)
        yield Row(scene, f"{n_views} views: checks and coverage from scratch", scratch_ms, "ms")
        for name, edit in _edits(start).items():
            edit(0)
            times_ms = [_time_ms(edit, number) for number in range(N_EDITS // 5 if context.is_quick else N_EDITS)]
            middle, high, most = np.percentile(times_ms, [50, 95, 100])
            what = f"{n_views} views, {name}: median (95 %: {high:.1f} ms, longest: {most:.1f} ms)"
            target = f"95 % under {TARGET_MS:g} ms" if scene == "office" else ""
            met = bool(high < TARGET_MS) if target else None
            yield Row(scene, what, float(middle), "ms", float(middle) / scratch_ms, "from scratch", target, met)


def _edits(start: Revision) -> dict[str, Edit]:
    """Edits by what they are called, each of a viewpoint drawn at random."""
    rng = np.random.default_rng(0)
    viewpoints = start.plan.viewpoints
    chosen = rng.integers(0, len(viewpoints), N_EDITS)
    directions = rng.normal(size=(N_EDITS, 3))

    def beside(number: int, metres: float) -> Vec3:
        x, y, z = np.array(viewpoints[chosen[number]].position_enu_m) + metres * directions[number]
        return float(x), float(y), float(z)

    def name(number: int) -> str:
        return viewpoints[chosen[number]].id

    return {
        "nudge": lambda number: move(start, name(number), beside(number, SHORT_MOVE_M)),
        "move far": lambda number: move(start, name(number), beside(number, LONG_MOVE_M)),
        "turn": lambda number: move(start, name(number), heading_deg=90.0 * float(directions[number, 0])),
        "add": lambda number: add(start, beside(number, SHORT_MOVE_M), 0.0, -10.0),
        "delete": lambda number: delete(start, [name(number)]),
        "delete 20": lambda number: delete(start, {name((number + k) % N_EDITS) for k in range(20)}),
        "lock": lambda number: lock(start, [name(number)]),
    }


def _time_ms(edit: Edit, number: int) -> float:
    with timer() as elapsed_s:
        edit(number)
    return 1e3 * elapsed_s()


def _scratch_ms(revision: Revision, site_model: SiteModel) -> float:
    problem = revision.prepared.problem
    with timer() as elapsed_s:
        check_plan(revision.plan, site_model)
        coverage(problem.model, revision.plan.viewpoints, problem.reachability)
    return 1e3 * elapsed_s()


BENCHMARK = Benchmark(
    "revision",
    "Editing a plan by hand",
    "Time from an edit to the new coverage, route and findings, against checking and counting the same plan from "
    "scratch in the same run. Everything is counted by the definition in float64, with the same results. Planning "
    "again takes the prepared site of an earlier plan; a search that runs until the time is up spends what that saves.",
    measure,
)
