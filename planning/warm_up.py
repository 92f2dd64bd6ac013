"""Compile all kernels once and keep them on disk: `python -m planning.warm_up` (part of `make setup`)."""

from __future__ import annotations

from planning import smooth_path
from planning.checks import check_plan
from planning.optimise.greedy import GreedyParameters
from planning.plan import Constraints
from planning.planner import PlanRequest, plan_flight
from planning.routing import lower_bound, orienteering, sorties, tour
from planning.scenes import SCENES


def compile_kernels() -> None:
    """Run every kernel on small inputs: the planning methods in both precisions and both widths, and the routing."""
    few = GreedyParameters(n_candidates=200)
    occluded, fine = Constraints(occlusion="on"), Constraints(section_step_deg=15.0)
    requests = (
        PlanRequest(n_views=6, greedy=few, time_budget_s=2.0),
        PlanRequest(n_views=6, greedy=few, time_budget_s=2.0, precision="f64", constraints=fine),
        PlanRequest(share=0.5, greedy=few, time_budget_s=2.0, constraints=fine),
        PlanRequest(share=0.5, greedy=few, time_budget_s=2.0, precision="f64", constraints=occluded),
        PlanRequest(n_batteries=1, greedy=few, time_budget_s=2.0),
    )
    model = SCENES["roof"]()
    for request in requests:
        check_plan(plan_flight(model, request).plan, model)
    for module in (lower_bound, orienteering, smooth_path, sorties, tour):
        module.compile_kernels()


if __name__ == "__main__":
    compile_kernels()
