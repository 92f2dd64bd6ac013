"""Simulated fly-aways against the ground-risk buffer: share inside, margin, and what narrower buffers would let out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import shapely

from missions.simulator.fly_away import Ending, simulate_fly_aways
from planning.insight.ground_risk import GroundRisk, assess_ground_risk, grown
from planning.insight.ground_risk_request import GroundRiskRequest
from planning.parameters import GreedyParameters
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import SCENES
from tests.benchmarks.harness import Benchmark, Context, Row, timer

STATED = (
    ("calm, 21 m/s", GroundRiskRequest(wind_m_s=0.0)),
    ("wind 12 m/s, 21 m/s", GroundRiskRequest(wind_m_s=12.0)),
    ("wind 8 m/s, 5 m/s, paths alone", GroundRiskRequest(wind_m_s=8.0, speed_m_s=5.0, geography="paths")),
)

N_SEEDS = 3


def measure(context: Context) -> Iterator[Row]:
    """Share inside and smallest margin, the same with a narrower buffer; area and time against arc tolerance."""
    few = GreedyParameters(n_candidates=400, improve=False, certify=False)
    n, site_model = 300 if context.is_quick else 2000, SCENES["office"]()
    plan = plan_flight(site_model, PlanRequest(n_views=40, greedy=few)).plan
    for name, request in STATED:
        risk = assess_ground_risk(plan, site_model.site, request)
        flown = [simulate_fly_aways(plan, risk, n, seed) for seed in range(N_SEEDS)]
        inside = 100.0 * sum(each.share_inside for each in flown) / N_SEEDS
        yield Row("office", f"{name}: inside", inside, "%", target="100 %", met=inside == 100.0, seeds=N_SEEDS)
        fell = [each.margins_m[[end is not Ending.BRAKED for end in each.endings]].min() for each in flown]
        width = risk.value_of("S_GRB")
        yield Row(
            "office", f"{name}: smallest margin", float(min(fell)), "m", min(fell) / width, "the buffer", seeds=N_SEEDS
        )
        tried = simulate_fly_aways(plan, risk, n, 0, buffer=_narrower(risk, 0.7))
        yield Row("office", f"{name}: inside 70 % of the buffer", 100.0 * tried.share_inside, "%")
    for tolerance in (1.0, 0.1, 0.01):
        with timer() as seconds:
            risk = assess_ground_risk(plan, site_model.site, replace(STATED[2][1], arc_tolerance_m=tolerance))
        corners = shapely.get_num_coordinates(risk.buffer)
        what = f"arcs to {tolerance:g} m, {seconds():.2f} s, {corners} corners: area"
        yield Row("office", what, risk.buffer.area, "m2")


def _narrower(risk: GroundRisk, share: float) -> shapely.Geometry:
    rest = risk.value_of("S_FG") + risk.value_of("S_CV")
    return grown(risk.core, rest + share * risk.value_of("S_GRB"), risk.request.arc_tolerance_m)


BENCHMARK = Benchmark(
    "fly-aways",
    "Fly-aways and the ground-risk buffer",
    "Aircraft leave the paths of a plan at full speed through the air, at random places and courses, and are stopped "
    "by the pilot or by the border of the contingency volume. Then accuracy against time: arcs of the areas.",
    measure,
)
