"""Top-ups: the flight that closes what a flight left open, against flying the missed views again."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from planning.base.progress import TimeLimit
from planning.parameters import GreedyParameters
from planning.plan import Plan, ViewpointArrays, viewpoint_arrays
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.revision.top_up import TopUpRequest, top_up
from planning.routing.flights import draw_flights, flight_times, plan_flights
from tests.benchmarks.harness import Benchmark, Context, Row
from tests.benchmarks.problems import prepared

CASES = (("office", 560, 56), ("office", 120, 30), ("court", 120, 30), ("library", 600, 60))
"""Scene, views of the plan, and how many of them in a row are missing."""

BUDGETS_S = (1.0, 5.0, 20.0)


def measure(context: Context) -> Iterator[Row]:
    """Durations of the missed views in their order, in the best order, and of top-ups after some time."""
    for scene, n_views, n_missed in CASES[1:2] if context.is_quick else CASES:
        plan = planned(scene, n_views, 4.0 if context.is_quick else 20.0)
        first = len(plan.viewpoints) // 3
        order = [identifier for sortie in plan.sorties for identifier in sortie.viewpoint_ids]
        missed = set(order[first : first + n_missed])
        by_id = {view.id: view for view in plan.viewpoints}
        taken = viewpoint_arrays(tuple(view for view in plan.viewpoints if view.id not in missed))
        again = viewpoint_arrays(tuple(by_id[identifier] for identifier in order if identifier in missed))
        in_order_s, best_order_s = flown_again_s(scene, plan, again)
        case = f"{scene}, {n_missed} of {n_views} views missing"
        yield Row(case, "missed views again, in their order", in_order_s, "s")
        yield Row(
            case, "missed views again, in the best order", best_order_s, "s", best_order_s / in_order_s, "in order"
        )
        for budget_s in BUDGETS_S[:1] if context.is_quick else BUDGETS_S:
            found = top_up(
                prepared(scene).site_model, plan, taken, TopUpRequest(time_budget_s=budget_s), prepared=prepared(scene)
            )
            duration_s = 0.0 if found.plan is None else found.plan.duration_s
            n = 0 if found.plan is None else len(found.plan.viewpoints)
            what = f"top-up, {budget_s:g} s allowed: {n} views close {found.closed} of {found.wanted} sections"
            met = duration_s <= best_order_s + 0.1 and found.closed == found.wanted
            yield Row(case, what, duration_s, "s", duration_s / in_order_s, "in order", "no longer, all closed", met)
            yield Row(case, f"its time to plan, {budget_s:g} s allowed", found.seconds, "s")
        yield Row(case, "proven for the views compared: no less than", found.shortest_s or 0.0, "s")


@functools.cache
def planned(scene: str, n_views: int, seconds: float) -> Plan:
    """A plan of a bundled scene."""
    request = PlanRequest(n_views=n_views, time_budget_s=seconds, greedy=GreedyParameters(objective="sections"))
    plan = plan_flight(prepared(scene).site_model, request, prepared=prepared(scene)).plan
    return replace(plan, constraints=replace(plan.constraints, occlusion="auto"))


def flown_again_s(scene: str, plan: Plan, views: ViewpointArrays) -> tuple[float, float]:
    """Durations of a flight through all views in their order, and in the best order found in 3 s."""
    times = flight_times(prepared(scene).problem.roadmap, views, plan.aircraft, plan.rules)
    order = tuple(int(view) for view in np.arange(len(views.heading_rad)))
    in_order = draw_flights(times, (order,), views, plan.aircraft, plan.rules)
    best = plan_flights(times, views, plan.aircraft, plan.rules, stop=TimeLimit(3.0))
    return in_order[0].duration_s, sum(flight.duration_s for flight in best)


BENCHMARK = Benchmark(
    "top-ups",
    "Top-ups",
    "A stretch of a plan's views is missing from the flight, and the shortest flight is wanted that shows all sections "
    "that only they were to show; take-off and landing included. The site is prepared already.",
    measure,
)
