"""Whole plans: every promise of the plan file, measured by independent means; goals, limits, stopping, repetition."""

from __future__ import annotations

import functools
import itertools
import json
import math
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from planning.aircraft.catalogue import profile
from planning.base.errors import InfeasibleError, InputError, OperationCancelled
from planning.base.findings import Severity, is_flyable
from planning.base.progress import StopRequest, Trace
from planning.checks import check_plan
from planning.parameters import LARGEST_SEED, Constraints, FlightRules, GreedyParameters, Precision
from planning.plan import Plan, plan_to_json, read_plan, write_plan
from planning.planner import Planned, plan_flight, resplit_sorties
from planning.request import PlanRequest
from planning.site.bundled import SCENES
from planning.site.records import SiteModel
from planning.viewpoints.prepare import Prepared, prepare
from tests.planning.plan_cases import (
    dense_points,
    distances,
    inside_zone,
    kiosk,
    paths,
    seen_by_contract,
    solid_triangles,
)
from tests.slow import slow

FEW = GreedyParameters(n_candidates=600, improve=False, certify=False)
MANY = GreedyParameters(3000, certify=False)
PRECISIONS: tuple[Precision, ...] = ("f32", "f64")
NEAR = Constraints(min_distance_m=5.0)
LOW_BATTERY = FlightRules(battery_reserve=0.9)

REQUESTS = {
    "views": PlanRequest(n_views=8, constraints=NEAR, greedy=FEW),
    "improved views": PlanRequest(n_views=4, constraints=NEAR, greedy=replace(FEW, improve=True), time_budget_s=1.5),
    "share": PlanRequest(share=0.5, constraints=NEAR, greedy=FEW),
    "batteries": PlanRequest(n_batteries=1, constraints=NEAR, greedy=FEW, rules=LOW_BATTERY, time_budget_s=2.0),
    "fine steps in f64": PlanRequest(
        n_views=6, constraints=replace(NEAR, section_step_deg=15.0), greedy=FEW, precision="f64"
    ),
    "whole panels from near": PlanRequest(
        n_views=6, constraints=replace(NEAR, whole_panel=True, max_distance_m=25.0), greedy=FEW
    ),
    "turning in flight": PlanRequest(n_views=6, constraints=NEAR, greedy=FEW, rules=FlightRules(turn_in_flight=True)),
    "pso": PlanRequest(method="pso", n_views=4, constraints=NEAR, time_budget_s=1.5),
    "noto": PlanRequest(method="noto", n_views=12, constraints=NEAR),
    "orbit": PlanRequest(method="orbit", n_views=15, constraints=NEAR),
}


@functools.cache
def prepared(model: Callable[[], SiteModel], constraints: Constraints, precision: Precision, seed: int) -> Prepared:
    return prepare(model(), profile("m3e").camera, constraints, precision=precision, seed=seed)


def planned_again(model: Callable[[], SiteModel], request: PlanRequest) -> Planned:
    """A plan for a site that is prepared once for all that is planned on it."""
    ready = prepared(model, request.constraints, request.precision, request.seed)
    return plan_flight(model(), request, prepared=ready)


@functools.cache
def planned_kiosk(name: str) -> Planned:
    return planned_again(kiosk, REQUESTS[name])


@pytest.fixture(params=sorted(REQUESTS))
def planned(request: pytest.FixtureRequest) -> Planned:
    return planned_kiosk(request.param)


def assert_keeps_the_contract(model: SiteModel, plan: Plan, spacing_m: float = 0.25) -> None:
    """What `plan.json` promises, but for coverage."""
    site, by_id = model.site, {v.id: v for v in plan.viewpoints}
    flown = list(itertools.chain.from_iterable(sortie.viewpoint_ids for sortie in plan.sorties))
    assert sorted(flown) == sorted(by_id)
    low, high, home = (np.array(p) for p in (site.airspace.min_enu_m, site.airspace.max_enu_m, site.home_enu_m))
    triangles = solid_triangles(model)
    for sortie, path in zip(plan.sorties, paths(plan), strict=True):
        assert path[0] == pytest.approx(home, abs=1e-3)
        assert path[-1] == pytest.approx(home, abs=1e-3)
        vertices = iter(sortie.path_enu_m)
        assert all(by_id[i].position_enu_m in vertices for i in sortie.viewpoint_ids), "in order, each with its vertex"
        points = dense_points(path, spacing_m)
        assert distances(points, triangles).min() >= plan.constraints.min_distance_m
        assert not any(inside_zone(points, zone).any() for zone in site.airspace.no_fly)
        assert (points[:, :2] >= low[:2]).all()
        assert (points <= high).all()
        below = points[points[:, 2] < low[2]]
        assert np.abs(below[:, :2] - home[:2]).max() <= 1e-3
        assert below[:, 2].min() >= home[2] - 1e-9
        assert sortie.length_m == pytest.approx(np.linalg.norm(np.diff(path, axis=0), axis=1).sum(), abs=1e-2)
        assert sortie.duration_s <= plan.aircraft.endurance_s * (1.0 - plan.rules.battery_reserve) + 0.01
    lowest, highest = plan.camera.gimbal_pitch_deg
    for viewpoint in plan.viewpoints:
        assert lowest <= viewpoint.gimbal_pitch_deg <= highest
        assert -180.0 < viewpoint.heading_deg <= 180.0
        assert (np.array(viewpoint.position_enu_m) >= low).all()
        assert (np.array(viewpoint.position_enu_m) <= high).all()


@pytest.mark.long
def test_every_method_and_goal_keeps_the_contract_and_every_check(planned: Planned) -> None:
    model, plan = kiosk(), planned.plan
    assert_keeps_the_contract(model, plan)
    findings = check_plan(plan, model)
    assert is_flyable(findings)
    allowed = {"leg-spacing", "depth-of-field", "mirror-focus"}  # focused once, on what the first photo sees
    assert {f.code for f in findings if f.severity is not Severity.OK} <= allowed


@pytest.mark.long
@pytest.mark.parametrize("name", sorted(set(REQUESTS) - {"whole panels from near"}))
def test_coverage_in_the_plan_is_that_of_the_contract_s_own_words(name: str) -> None:
    planned = planned_kiosk(name)
    plan, stated = planned.plan, planned.plan.coverage
    step, occlusion = plan.constraints.section_step_deg, plan.constraints.occlusion == "on"
    seen = seen_by_contract(kiosk(), plan.camera, plan.viewpoints, step, occlusion)
    assert plan.constraints.occlusion == "on", "the tree and the corner hide panels"
    assert len(seen) == stated.covered
    assert stated.total == 15 * round(90.0 / step) * round(360.0 / step)
    assert stated.covered <= stated.reachable_upper_bound <= stated.total
    for count in planned.depth:
        assert sum(times >= count.n_views for times in seen.values()) == count.covered
    hidden = seen_by_contract(kiosk(), plan.camera, plan.viewpoints, step, not occlusion)
    assert len(hidden) >= len(seen)


@pytest.mark.long
def test_views_that_count_only_whole_and_near_are_fewer_than_the_contract_s() -> None:
    plan = planned_kiosk("whole panels from near").plan
    plain = seen_by_contract(kiosk(), plan.camera, plan.viewpoints, 30.0, occlusion=True)
    assert 0 < plan.coverage.covered < len(plain)


@pytest.mark.long
def test_history_rises_within_the_time_taken_and_ends_near_the_plan_s_coverage(planned: Planned) -> None:
    history = planned.plan.history
    assert history
    times, covered = [point.t_s for point in history], [point.covered for point in history]
    assert times == sorted(times)
    assert covered == sorted(covered)
    assert 0.0 <= times[0] <= times[-1] <= sum(planned.seconds.values())
    assert abs(covered[-1] - planned.plan.coverage.covered) <= 3, "rounding and merged places cost next to nothing"


@pytest.mark.long
def test_goals_are_met() -> None:
    assert len(planned_kiosk("views").plan.viewpoints) == 8
    assert len(planned_kiosk("batteries").plan.sorties) == 1
    share, views = planned_kiosk("share"), planned_kiosk("views")
    assert share.plan.coverage.covered >= 0.48 * share.plan.coverage.reachable_upper_bound
    assert share.plan.coverage.covered <= 0.65 * share.plan.coverage.reachable_upper_bound, "no more than was asked for"
    assert len(share.plan.viewpoints) > len(views.plan.viewpoints)


@pytest.mark.slow
def test_without_a_goal_nearly_everything_is_covered_with_few_views() -> None:
    model = SCENES["single-panel"]()
    planned = plan_flight(model, PlanRequest(greedy=FEW, time_budget_s=600.0))
    coverage = planned.plan.coverage
    assert (coverage.covered, coverage.reachable_upper_bound, coverage.total) == (34, 34, 36)
    assert planned.n_undecided == 0
    assert len(planned.plan.viewpoints) == 34, "each view shows one section of one panel"
    assert_keeps_the_contract(model, planned.plan)


@functools.cache
def glass_to_the_south() -> SiteModel:
    return kiosk(facades=kiosk().site.facades[:1])


@functools.cache
def glass_to_the_east() -> SiteModel:
    return kiosk(facades=kiosk().site.facades[1:])


def sharply_seen(model: SiteModel, plan: Plan, limit_m: float) -> set[tuple[int, int]]:
    """Panels and sections that a view from at most so far covers, by the contract's own words."""
    centroids = [np.mean(panel.corners_enu_m, axis=0) for panel in model.site.panels]
    return {
        (panel, section)
        for view in plan.viewpoints
        for panel, section in seen_by_contract(model, plan.camera, (view,), 30.0, occlusion=True)
        if np.linalg.norm(centroids[panel] - np.array(view.position_enu_m)) <= limit_m
    }


@functools.cache
def seen_from_near(limit_m: float) -> int:
    near = replace(NEAR, max_distance_m=limit_m)
    request = PlanRequest(share=1.0, constraints=near, greedy=MANY)
    return planned_again(glass_to_the_south, request).plan.coverage.covered


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.9, 0.99])
def test_a_share_is_covered_sharply_too_as_far_as_that_can_be(share: float) -> None:
    limit_m = profile("m3e").camera.distance_for_gsd_m(0.004)
    request = PlanRequest(share=share, constraints=replace(NEAR, wanted_gsd_mm=4.0), greedy=MANY)
    plan = planned_again(glass_to_the_south, request).plan
    any_pixel_wish = replace(request, constraints=replace(NEAR, wanted_gsd_mm=0.0))
    any_pixel = planned_again(glass_to_the_south, any_pixel_wish).plan
    assert plan.coverage.sharp == len(sharply_seen(glass_to_the_south(), plan, limit_m))
    # Candidates are spread over the whole air: some sections are seen sharply from none of them.
    assert plan.coverage.sharp >= 0.93 * share * seen_from_near(limit_m)
    assert plan.coverage.covered >= any_pixel.coverage.covered - 2
    assert len(sharply_seen(glass_to_the_south(), any_pixel, limit_m)) < plan.coverage.sharp
    assert any_pixel.coverage.sharp == any_pixel.coverage.covered
    assert plan.constraints.wanted_gsd_mm == 4.0


@pytest.mark.slow
def test_spare_views_are_spent_on_sharp_ones_first() -> None:
    limit_m = profile("m3e").camera.distance_for_gsd_m(0.005)
    by_sections = replace(MANY, objective="sections")
    request = PlanRequest(n_views=54, constraints=replace(NEAR, wanted_gsd_mm=5.0), greedy=by_sections)
    plan = plan_flight(glass_to_the_east(), request).plan
    any_pixel_wish = replace(request, constraints=replace(NEAR, wanted_gsd_mm=0.0))
    any_pixel = planned_again(glass_to_the_east, any_pixel_wish).plan
    assert plan.coverage.covered >= any_pixel.coverage.covered - 1
    assert plan.coverage.sharp > 1.5 * len(sharply_seen(glass_to_the_east(), any_pixel, limit_m))


def without_wall_times(plan: Plan) -> str:
    content = plan_to_json(plan)
    content["history"] = [point["covered"] for point in content["history"]]
    for effect in content["effects"]:
        del effect["cost_s"]
    return json.dumps(content)


@pytest.mark.long
@pytest.mark.parametrize(
    ("precision", "goal"), [("f32", {"n_views": 5}), slow("f32", {"share": 0.3}), slow("f64", {"share": 0.3})]
)
def test_same_seed_gives_the_same_plan_whatever_the_number_of_threads(
    goal: dict[str, float], precision: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    wanted = PlanRequest(constraints=NEAR, greedy=FEW, precision=precision, seed=5, time_budget_s=600.0)
    request = replace(wanted, **goal)  # type: ignore[arg-type]
    first = without_wall_times(plan_flight(kiosk(), request).plan)
    monkeypatch.setattr("planning.base.jit.n_threads", lambda: 1)
    assert without_wall_times(plan_flight(kiosk(), request).plan) == first
    other = plan_flight(kiosk(), replace(request, seed=6)).plan
    assert without_wall_times(other).replace('"seed": 6', '"seed": 5') != first


@pytest.mark.slow
def test_improved_plans_repeat_too_when_the_search_ends_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    greedy = GreedyParameters(objective="sections", n_candidates=300)
    request = PlanRequest(n_views=3, greedy=greedy, time_budget_s=600.0)
    model = SCENES["single-panel"]()
    first = plan_flight(model, request)
    monkeypatch.setattr("planning.base.jit.n_threads", lambda: 1)
    assert without_wall_times(plan_flight(model, request).plan) == without_wall_times(first.plan)
    assert first.plan.coverage.covered == 3


@pytest.mark.long
def test_both_precisions_plan_alike() -> None:
    plans = [
        plan_flight(kiosk(), replace(REQUESTS["share"], share=0.6, precision=precision, time_budget_s=600.0)).plan
        for precision in ("f32", "f64")
    ]
    assert abs(plans[0].coverage.covered - plans[1].coverage.covered) <= 2
    assert abs(plans[0].coverage.reachable_upper_bound - plans[1].coverage.reachable_upper_bound) <= 1
    assert abs(len(plans[0].viewpoints) - len(plans[1].viewpoints)) <= 1


class Counting:
    """Monitor that lets `n` reports pass and then calls `then`."""

    def __init__(self, n: int, then: Callable[[], None]) -> None:
        self.left, self.then, self.stages = n, then, set[str]()

    def report(self, stage: str, done: float, total: float) -> None:
        self.stages.add(stage)
        self.left -= 1
        if self.left < 0:
            self.then()


def cancel() -> None:
    raise OperationCancelled("cancelled")


@pytest.mark.slow
def test_cancelling_at_any_report_throws_the_plan_away() -> None:
    listening = Counting(10**9, cancel)
    plan_flight(kiosk(), REQUESTS["views"], monitor=listening)
    n_reports = 10**9 - listening.left
    assert len(listening.stages) >= 6
    # Stages that last for a given time report as often as they get to: another run may end some reports earlier.
    for n in np.unique(np.linspace(0, 0.8 * n_reports, 6).astype(int)):
        with pytest.raises(OperationCancelled):
            plan_flight(kiosk(), REQUESTS["views"], monitor=Counting(int(n), cancel))


@pytest.mark.long
@pytest.mark.few(2)
@pytest.mark.parametrize("name", ["improved views", "batteries", "share", "pso"])
def test_stopped_at_once_a_plan_comes_out_all_the_same(name: str) -> None:
    stop = StopRequest()
    stop.request()
    started = time.process_time()
    planned = plan_flight(kiosk(), replace(REQUESTS[name], time_budget_s=600.0), stop=stop)
    assert time.process_time() - started < 30.0
    assert_keeps_the_contract(kiosk(), planned.plan)
    assert planned.n_undecided == planned.plan.coverage.total, "nothing was proven"
    assert planned.plan.coverage.covered > 0


@pytest.mark.slow
def test_stopping_half_way_keeps_what_was_found() -> None:
    stop, trace = StopRequest(), Trace()
    trace.observer = lambda _point: stop.request() if len(trace.points) >= 8 else None
    greedy = replace(FEW, improve=True, objective="sections")
    request = PlanRequest(n_views=12, constraints=NEAR, greedy=greedy, time_budget_s=600.0)
    started = time.process_time()
    planned = plan_flight(kiosk(), request, stop=stop, trace=trace)
    assert time.process_time() - started < 40.0
    assert planned.plan.coverage.covered >= trace.points[7].value - 3
    assert [point.covered for point in planned.plan.history] == [int(point.value) for point in trace.points]


@pytest.mark.slow
@pytest.mark.parametrize(("scene", "budget_s"), [("office", 1.0), pytest.param("court", 5.0, marks=pytest.mark.slow)])
def test_a_time_budget_too_small_for_everything_still_gives_a_plan_soon_after(scene: str, budget_s: float) -> None:
    model = SCENES[scene]()
    started = time.process_time()
    planned = plan_flight(model, PlanRequest(time_budget_s=budget_s))
    # CPU time, so that other programs do not count; the search uses up to two cores.
    assert time.process_time() - started < 2.0 * budget_s + 12.0
    plan = planned.plan
    assert plan.coverage.covered > 0.5 * plan.coverage.reachable_upper_bound
    assert is_flyable(check_plan(plan, model))


@pytest.mark.long
def test_bounds_hold_for_what_they_are_stated_for() -> None:
    certified = replace(REQUESTS["views"], greedy=replace(FEW, certify=True, objective="sections"))
    planned = planned_again(kiosk, certified)
    assert planned.bound_for_views is not None
    assert planned.plan.coverage.covered <= planned.bound_for_views + 2
    assert planned.bound_for_views <= 1.3 * planned.plan.coverage.covered
    by_sections = replace(REQUESTS["batteries"], greedy=replace(FEW, objective="sections"))
    batteries = planned_again(kiosk, by_sections)
    assert batteries.bound_for_views is not None
    assert batteries.plan.coverage.covered <= batteries.bound_for_views <= batteries.plan.coverage.reachable_upper_bound


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("request_", "error", "message"),
    [
        ({"method": "magic"}, InputError, "no planning method 'magic'; known are: greedy, pso, noto, orbit"),
        ({"profile_id": "kite"}, InputError, "no aircraft profile 'kite'; known are"),
        ({"method": "pso", "share": 0.9}, InputError, "needs a number of views"),
        (
            {"method": "noto", "n_batteries": 1},
            InputError,
            "'noto' cannot plan for a number of batteries; 'greedy' can",
        ),
        ({"rules": FlightRules(battery_reserve=0.99)}, InfeasibleError, "leave nothing; lower the reserve"),
        ({"rules": FlightRules(wind_m_s=12.0)}, InfeasibleError, "wind below 12 m/s, but 12 m/s are expected"),
        (
            {"rules": FlightRules(battery_reserve=0.986), "n_batteries": 1},
            InfeasibleError,
            "can be reached and left again within 5 s of one battery",
        ),
        (
            {"rules": FlightRules(battery_reserve=0.986), "n_views": 2},
            InfeasibleError,
            "on a sortie of its own, but a battery allows 5.3 s",
        ),
        ({"constraints": Constraints(min_distance_m=35.0)}, InfeasibleError, "the take-off column above home"),
        (
            {"constraints": Constraints(min_distance_m=5.0, max_distance_m=5.001)},
            InfeasibleError,
            "no allowed viewpoint sees any panel",
        ),
    ],
)
def test_what_cannot_be_done_is_refused_with_the_reason(
    request_: dict[str, object], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        plan_flight(kiosk(), PlanRequest(**{"constraints": NEAR, "greedy": FEW, **request_}))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"n_views": 3, "share": 0.5}, "at most one of"),
        ({"n_views": 3, "n_batteries": 1}, "at most one of"),
        ({"n_views": 0}, "views: expected 1 to 20000, got 0"),
        ({"n_views": 20_001}, "views: expected 1 to 20000"),
        ({"share": 0.0}, "coverage: expected more than 0"),
        ({"share": 1.01}, "coverage: expected more than 0 and at most 1"),
        ({"share": math.nan}, "coverage: expected"),
        ({"n_batteries": 0}, "batteries: expected 1 to 100, got 0"),
        ({"n_batteries": 101}, "batteries: expected 1 to 100"),
        ({"time_budget_s": 0.0}, "time budget: expected more than 0 s"),
        ({"time_budget_s": math.nan}, "time budget: expected"),
    ],
)
def test_senseless_requests_are_refused(arguments: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        PlanRequest(**arguments)  # type: ignore[arg-type]


@pytest.mark.few(1)
@pytest.mark.parametrize("max_views", [8, 4, 3])
def test_sharing_out_anew_keeps_the_viewpoints_and_the_contract(max_views: int) -> None:
    plan = planned_kiosk("views").plan
    anew = resplit_sorties(plan, kiosk(), max_views)
    assert anew.viewpoints == plan.viewpoints
    assert max(len(sortie.viewpoint_ids) for sortie in anew.sorties) <= max_views
    assert math.ceil(8 / max_views) <= len(anew.sorties) <= math.ceil(8 / max_views) + 1
    assert replace(anew, sorties=plan.sorties) == plan
    assert_keeps_the_contract(kiosk(), anew)


@pytest.mark.slow
def test_other_aircraft_keep_their_own_waypoint_limit() -> None:
    px4 = profile("px4").aircraft
    request = PlanRequest(n_views=30, constraints=NEAR, greedy=FEW, profile_id="px4", time_budget_s=4.0)
    plan = plan_flight(kiosk(), request).plan
    assert plan.aircraft == px4
    assert max(len(sortie.path_enu_m) for sortie in plan.sorties) - 2 <= px4.max_waypoints
    assert is_flyable(check_plan(plan, kiosk()))


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["office", "library", "court", "canyon", "roof"])
@pytest.mark.parametrize("goal", [{"n_views": 60}, {}, {"n_batteries": 1}])
def test_plans_of_whole_sites_keep_the_contract(scene: str, goal: dict[str, int]) -> None:
    model = SCENES[scene]()
    plan = plan_flight(model, PlanRequest(time_budget_s=10.0, **goal)).plan  # type: ignore[arg-type]
    assert_keeps_the_contract(model, plan, spacing_m=1.0)
    seen = seen_by_contract(model, plan.camera, plan.viewpoints, 30.0, plan.constraints.occlusion == "on")
    # Lines of sight that graze an edge are decided in float32 there and in float64 here.
    assert abs(len(seen) - plan.coverage.covered) <= (3 if plan.constraints.occlusion == "on" else 0)
    assert is_flyable(check_plan(plan, model))


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize("method", ["greedy", "pso", "noto", "orbit"])
def test_every_method_takes_a_seed_of_63_bits(method: str, tmp_path: Path) -> None:
    """Generators of other libraries take 32 bits only."""
    wanted = PlanRequest(method=method, n_views=6, seed=LARGEST_SEED, time_budget_s=2.0)
    plan = planned_again(kiosk, wanted).plan
    assert plan.seed == LARGEST_SEED
    write_plan(tmp_path / "plan.json", plan)
    assert read_plan(tmp_path / "plan.json").seed == LARGEST_SEED
