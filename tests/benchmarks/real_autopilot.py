"""A real ArduCopter in its own simulation flies plans of bundled sites, and the simulated vehicle beside it."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

from groundstation.services.fly.flying import SITL_LINK, FlightRequest, Flown, fly_plan, sitl
from missions.mavlink.autopilots import Autopilot
from missions.mission.build import missions_from_plan
from planning.plan import Plan
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import SCENES
from planning.site.records import SiteModel
from tests.benchmarks.harness import Benchmark, Context, Row, Skipped
from tests.services.real_autopilots import SPEEDUP, binary, variable

CASES = (("single-panel", 8), ("office", 56), ("tower", 40))
"""Bundled site, and views."""


def measure(context: Context) -> Iterator[Row]:
    """Photos, errors at the shutter, coverage and duration of each flight."""
    program = binary()
    if program is None:
        raise Skipped(f"{variable(Autopilot.ARDUPILOT)} does not name ArduCopter's simulation")
    for scene, n_views in CASES[:1] if context.is_quick else CASES:
        model = SCENES[scene]()
        plan = plan_flight(model, PlanRequest(n_views=n_views, time_budget_s=10.0, profile_id="ardupilot")).plan
        yield from _rows(f"{scene}, {n_views} views, real", _really_flown(program, plan, model))
        yield from _rows(f"{scene}, {n_views} views, simulated vehicle", fly_plan(plan, model, FlightRequest()))


def _really_flown(program: Path, plan: Plan, model: SiteModel) -> Flown:
    home = missions_from_plan(plan, model.site.origin, model.site.home_enu_m)[0].takeoff
    with (
        tempfile.TemporaryDirectory() as folder,
        sitl(program, home, SPEEDUP, plan.aircraft.endurance_s, None) as restart,
    ):
        request = FlightRequest(link=SITL_LINK, sets_parameters=True, log_folder=Path(folder))
        return fly_plan(plan, model, request, between=restart)


def _rows(scene: str, flown: Flown) -> Iterator[Row]:
    report = flown.flight.report
    assert report is not None
    summary, views = report.summary, report.views
    n_views = len(views)
    yield Row(scene, "photos", summary.n_taken, "", target=f"{n_views}", met=summary.n_taken == n_views)
    worst = (
        ("position, worst", [view.position_error_m for view in views], "m", 0.5),
        ("heading, worst", [view.heading_error_deg for view in views], "deg", 3.0),
        ("gimbal pitch, worst", [view.gimbal_pitch_error_deg for view in views], "deg", 2.0),
    )
    for what, errors, unit, limit in worst:
        value = max((abs(error) for error in errors if error is not None), default=float("nan"))
        yield Row(scene, what, value, unit, target=f"at most {limit:g} {unit}", met=value <= limit)
    share = summary.covered / summary.covered_planned
    yield Row(scene, "coverage flown of planned", 100.0 * share, "%", target="at least 97 %", met=share >= 0.97)
    flown_s = summary.duration_flown_s or float("nan")
    predicted_s = sum(sortie.expected_s for sortie in flown.sorties)
    is_near = abs(flown_s / predicted_s - 1.0) <= 0.1
    yield Row(scene, "duration", flown_s, "s", flown_s / predicted_s, "predicted", "within 10 % of predicted", is_near)


BENCHMARK = Benchmark(
    "real-autopilot",
    "A real ArduCopter",
    "Plans flown by ArduCopter 4.7.0-dev (git 2598e9d4b2) in its own simulation, at ten times real time and without "
    "wind, and by the simulated vehicle with what the scene calls for; both by the same client over MAVLink. It needs "
    "ArduPilot's binary; [autopilots](concepts/flying.md) says how it is built.",
    measure,
)
