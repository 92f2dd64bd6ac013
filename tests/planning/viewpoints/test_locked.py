"""Locked viewpoints: in every new plan as they are, whatever the goal; refused where they cannot be flown."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import cdist

from planning.base.errors import InfeasibleError, InputError
from planning.base.findings import is_flyable
from planning.base.progress import QUIET, Trace
from planning.checks import check_plan
from planning.coverage.evaluate import coverage_counts
from planning.coverage.model import element_weights
from planning.parameters import GreedyParameters
from planning.plan import Plan, Viewpoint, ViewpointArrays, viewpoint_arrays
from planning.planner import as_written, first_reusable, plan_flight
from planning.request import PlanRequest
from planning.routing.flights import Flight
from planning.routing.orienteering import solve_orienteering
from planning.viewpoints.budget import best_flights, with_fewer_views
from planning.viewpoints.candidates import Pool, candidate_pool
from planning.viewpoints.greedy import choose_greedily, necessary_views
from planning.viewpoints.improve import improve_views, refine_views
from planning.viewpoints.problem import concatenate, covered_by, locked_views, take
from planning.viewpoints.spacing import spacing_rule
from tests.planning.plan_cases import kiosk
from tests.planning.revision.cases import NEAR, QUICK, planned, prepared
from tests.planning.routing.test_legs import room
from tests.planning.routing_cases import cover_gain, distances
from tests.planning.test_planner import assert_keeps_the_contract

LOCKED = (
    Viewpoint("v0002", (0.0, -12.0, 12.0), 0.0, -20.0),
    Viewpoint("mine", (12.123456, -14.0, 10.0), 300.0, -10.0),
    Viewpoint("v0000", (0.2, -12.0, 12.0), 15.0, -30.5, locked=True),
)
GOALS = {
    "views": PlanRequest(n_views=7, constraints=NEAR, greedy=QUICK),
    "only the locked": PlanRequest(n_views=3, constraints=NEAR, greedy=GreedyParameters(400)),
    "improved": PlanRequest(n_views=5, constraints=NEAR, greedy=GreedyParameters(400), time_budget_s=1.5),
    "more than needed": PlanRequest(n_views=260, constraints=NEAR, greedy=QUICK, time_budget_s=1.5),
    "share": PlanRequest(share=0.5, constraints=NEAR, greedy=replace(QUICK, improve=True), time_budget_s=1.5),
    "little": PlanRequest(share=0.01, constraints=NEAR, greedy=QUICK),
    "batteries": PlanRequest(
        n_batteries=1,
        constraints=NEAR,
        greedy=QUICK,
        rules=replace(PlanRequest().rules, battery_reserve=0.94),
        time_budget_s=2.0,
    ),
}


def plan_with_locked(request: PlanRequest, locked: tuple[Viewpoint, ...] = LOCKED) -> Plan:
    ready = prepared("kiosk")
    return plan_flight(ready.site_model, replace(request, locked=locked), prepared=ready).plan


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize("goal", sorted(GOALS))
def test_locked_viewpoints_are_in_the_plan_as_they_are_and_nothing_else_has_their_names(goal: str) -> None:
    request = GOALS[goal]
    plan = plan_with_locked(request)
    kept = {viewpoint.id: viewpoint for viewpoint in plan.viewpoints if viewpoint.locked}
    assert kept == {viewpoint.id: replace(viewpoint, locked=True) for viewpoint in LOCKED}
    assert all(viewpoint in plan.viewpoints for viewpoint in kept.values())
    poses = {(v.position_enu_m, v.heading_deg, v.gimbal_pitch_deg) for v in plan.viewpoints}
    assert len(poses) == len(plan.viewpoints)
    problems = {f.code for f in check_plan(plan, kiosk()) if f.severity != "ok"}
    # A locked heading of 300 degrees stays as it is, and so near not all of a pane is in focus.
    assert problems <= {"leg-spacing", "heading", "depth-of-field"}
    turned = tuple(replace(v, heading_deg=-60.0) if v.heading_deg == 300.0 else v for v in plan.viewpoints)
    assert_keeps_the_contract(kiosk(), replace(plan, viewpoints=turned))
    model = prepared("kiosk").problem.model
    locked_counts, counts = coverage_counts(model, LOCKED), coverage_counts(model, plan.viewpoints)
    assert (counts >= locked_counts).all()
    assert plan.coverage.covered == np.count_nonzero(counts)
    if request.n_views is not None and goal != "more than needed":
        assert len(plan.viewpoints) == request.n_views
    if request.share is not None:
        assert plan.coverage.covered >= 0.97 * plan_with_locked(request, ()).coverage.covered
    if request.n_batteries is not None:
        assert len(plan.sorties) == request.n_batteries
    assert [point.covered for point in plan.history] == sorted(point.covered for point in plan.history)


@pytest.mark.slow
def test_the_others_are_chosen_for_what_the_locked_ones_leave() -> None:
    free = plan_with_locked(replace(GOALS["views"], n_views=4), ())
    locked = tuple(replace(viewpoint, locked=True) for viewpoint in free.viewpoints[:2])
    again = plan_with_locked(replace(GOALS["views"], n_views=4), locked)
    assert again.coverage.covered >= 0.97 * free.coverage.covered
    share = plan_with_locked(replace(GOALS["share"], share=0.5), free.viewpoints)
    alone = plan_with_locked(replace(GOALS["share"], share=0.5), ())
    assert len(share.viewpoints) <= len(alone.viewpoints) + 2
    assert len(plan_with_locked(GOALS["little"]).viewpoints) == len(LOCKED), "they are enough"


@pytest.mark.slow
def test_the_bound_holds_with_locked_views() -> None:
    ready = prepared("kiosk")
    request = replace(GOALS["improved"], locked=LOCKED)
    found = plan_flight(ready.site_model, request, prepared=ready)
    assert found.bound_for_views is not None
    assert found.plan.coverage.covered <= found.bound_for_views + 2
    only = plan_flight(ready.site_model, replace(GOALS["only the locked"], locked=LOCKED), prepared=ready)
    assert only.bound_for_views == only.plan.coverage.covered


@pytest.mark.slow
def test_improving_and_refining_return_the_others_only_and_never_lose() -> None:
    problem = prepared("kiosk").problem
    weights = element_weights(problem.model, False)
    locked = locked_views(problem, LOCKED)
    covered = covered_by(problem.model, locked)
    pool = candidate_pool(problem, 0, 300)
    chosen = np.arange(4)
    start = np.count_nonzero(covered + covered_by(problem.model, take(pool.views, chosen)))
    rounds = iter(range(3))
    views = improve_views(problem, pool, chosen, weights, 0, lambda: next(rounds, None) is None, Trace(), QUIET, locked)
    assert len(views.heading_rad) == 4
    together = problem.model.covered_count(concatenate([locked, views]))
    assert together >= start
    refined = refine_views(problem, views, weights, covered=covered)
    assert problem.model.covered_count(concatenate([locked, refined])) >= together
    elements = problem.model.elements(locked)
    assert not necessary_views(elements, weights, covered).any(), "the locked ones show all of it already"


def test_what_is_written_keeps_locked_views_unrounded_and_drops_others_like_them() -> None:
    problem = prepared("kiosk").problem
    locked = locked_views(problem, LOCKED)
    other = ViewpointArrays(locked[0] + [[5e-6, 0.0, 0.0]], locked[1], locked[2])
    written = as_written(problem, concatenate([locked, other, locked]), 3)
    np.testing.assert_array_equal(written.positions_enu_m[:3], locked.positions_enu_m)
    np.testing.assert_array_equal(written.heading_rad[:3], locked.heading_rad)
    assert len(written.heading_rad) == 3, "the others round to the same"


def test_no_view_is_chosen_too_close_to_a_locked_one() -> None:
    problem = prepared("kiosk").problem
    locked = locked_views(problem, LOCKED)
    rng = np.random.default_rng(0)
    near = np.repeat(locked.positions_enu_m, 40, axis=0) + rng.normal(size=(40 * len(LOCKED), 3)) * 0.2
    views = ViewpointArrays(near, np.repeat(locked.heading_rad, 40) + 0.3, np.repeat(locked.pitch_rad, 40))
    pool = Pool(views, problem.model.elements(views))
    weights, covered = element_weights(problem.model, False), covered_by(problem.model, locked)
    apart = spacing_rule(views, locked, 0.5)
    chosen, _ = choose_greedily(pool, weights, 60, np.inf, Trace(), QUIET, covered, apart)
    assert len(chosen) > 0
    away_m = cdist(near[chosen], np.concatenate([locked.positions_enu_m, near[chosen]]))
    assert away_m[away_m > 0.0].min() >= 0.5


@pytest.mark.long
def test_flights_with_locked_views_are_never_left_out() -> None:
    views = viewpoint_arrays((*LOCKED, *planned("kiosk").plan.viewpoints))
    model = prepared("kiosk").problem.model

    def flight(*numbers: int) -> Flight:
        return Flight(np.array(numbers), np.zeros((2, 3)), np.zeros(1, np.int64), 1.0)

    flights = (flight(0), flight(3, 4, 5), flight(6), flight(1, 2))
    assert [f.views[0] for f in best_flights(model, views, flights, 3, 3)] != [0, 3, 6]
    assert [f.views[0] for f in best_flights(model, views, flights, 1, 3)] == [0, 1]
    fewer = with_fewer_views(model, views, 3)
    assert len(fewer.heading_rad) == len(views.heading_rad) - 1
    np.testing.assert_array_equal(fewer.positions_enu_m[:3], views.positions_enu_m[:3])
    with pytest.raises(InfeasibleError, match="the 3 locked viewpoints alone need more batteries"):
        with_fewer_views(model, take(views, np.arange(3)), 3)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"position_enu_m": (0.0, -4.0, 6.0)}, r"it is 4\.000 m from the building or an obstacle, and 5\.001 m are"),
        ({"position_enu_m": (0.0, 3.0, 6.0)}, r"it is 3\.000 m inside a solid"),
        ({"position_enu_m": (0.0, -20.0, 41.5)}, r"it lies 1\.500 m outside the airspace"),
        ({"position_enu_m": (0.0, -20.0, 4.0)}, r"it lies 1\.000 m below the lowest flight allowed or on its border"),
        ({"position_enu_m": (0.0, -20.0, 40.0)}, r"outside the airspace or on its border"),
        ({"position_enu_m": (-30.0, 0.0, 12.0)}, "it is in a no-fly volume"),
        ({"gimbal_pitch_deg": 40.0}, "it looks 40 deg up, and the gimbal turns from -90 to 35 deg"),
    ],
)
def test_a_locked_viewpoint_that_cannot_be_flown_is_refused_with_its_name_and_the_reason(
    changes: dict[str, object], reason: str
) -> None:
    wrong = replace(LOCKED[1], **changes)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=f"viewpoint 'mine' is locked, but cannot be flown: .*{reason}.*; unlock it"):
        plan_with_locked(GOALS["views"], (LOCKED[0], wrong))


@pytest.mark.slow
def test_a_locked_viewpoint_that_cannot_be_reached_is_refused() -> None:
    hall = Viewpoint("hall", (35.0, 35.0, 16.0), 0.0, 0.0)
    request = PlanRequest(n_views=3, constraints=NEAR, greedy=QUICK, locked=(hall,), time_budget_s=2.0)
    with pytest.raises(InputError, match="viewpoint 'hall' is locked, but cannot be flown: no way from home"):
        plan_flight(room(), request)


@pytest.mark.parametrize("method", ["pso", "noto", "orbit"])
def test_methods_that_cannot_keep_them_say_so(method: str) -> None:
    request = replace(GOALS["views"], method=method, locked=LOCKED)
    with pytest.raises(InputError, match=f"method '{method}' cannot keep locked viewpoints; 'greedy' can"):
        plan_flight(kiosk(), request)


def test_requests_that_contradict_themselves_are_refused() -> None:
    with pytest.raises(ValueError, match="views: expected at least the 3 locked ones, got 2"):
        PlanRequest(n_views=2, locked=LOCKED)
    with pytest.raises(ValueError, match="locked: expected unique ids"):
        PlanRequest(locked=(LOCKED[0], LOCKED[0]))


@pytest.mark.slow
def test_more_locked_viewpoints_than_the_batteries_allow_are_refused() -> None:
    places = [(15.0 + 20.0 * math.cos(i), -20.0 + 15.0 * math.sin(i), 30.0) for i in range(12)]
    far = tuple(Viewpoint(f"far{i}", place, 30.0 * i - 179.0, -10.0) for i, place in enumerate(places))
    rules = replace(PlanRequest().rules, battery_reserve=0.965)
    request = replace(GOALS["batteries"], rules=rules, locked=far)
    with pytest.raises(InfeasibleError, match=r"the 12 locked viewpoints alone take .* batteries, but 1 are allowed"):
        plan_with_locked(request, far)


@pytest.mark.slow
def test_a_prepared_site_is_used_where_it_fits_and_refused_where_not() -> None:
    ready = prepared("kiosk")
    request = GOALS["views"]
    first = plan_flight(ready.site_model, request, prepared=ready)
    assert first.prepared is ready
    assert first.seconds["reachability"] < 0.1
    again = plan_flight(kiosk(), request, prepared=first.prepared)
    assert again.plan.viewpoints == first.plan.viewpoints
    saved = replace(ready.site_model, sha256="1" * 64)
    assert plan_flight(saved, request, prepared=ready).plan.site_sha256 == "1" * 64
    others = {
        "site": (kiosk(home_enu_m=(1.0, -30.0, 0.0)), request),
        "camera": (kiosk(), replace(request, profile_id="m30")),
        "constraints": (kiosk(), replace(request, constraints=replace(NEAR, section_step_deg=15.0))),
        "precision": (kiosk(), replace(request, precision="f64")),
        "seed": (kiosk(), replace(request, seed=1)),
    }
    others["occlusion"] = (kiosk(), replace(request, constraints=replace(NEAR, occlusion="on")))
    for what, (site, other) in others.items():
        assert first_reusable([ready], site, other) is None, what
    site, other = others["seed"]
    assert plan_flight(site, other, prepared=ready).prepared.seed == 1


@pytest.mark.slow
def test_preparing_that_is_stopped_says_so() -> None:
    whole = plan_flight(kiosk(), replace(GOALS["views"], time_budget_s=60.0)).prepared
    cut = plan_flight(kiosk(), replace(GOALS["views"], time_budget_s=60.0), stop=lambda: True).prepared
    assert (whole.is_cut_short, cut.is_cut_short) == (False, True)
    assert is_flyable(check_plan(plan_flight(kiosk(), GOALS["views"], prepared=cut).plan, kiosk()))


@settings(max_examples=30)
@given(st.integers(3, 9), st.integers(1, 3), st.integers(0, 2**16))
def test_required_stops_are_made_whatever_else_is_worth_more(n: int, n_required: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    travel_s = distances(rng.random((n + 1, 2)) * 100.0)
    service_s = np.full(n, 5.0)
    required = tuple((int(stop),) for stop in rng.permutation(n)[:n_required])
    budget_s = 1.3 * max(travel_s[0, stops[0] + 1] * 2.0 + 5.0 for stops in required)
    weights = rng.random(n)
    weights[[stops[0] for stops in required]] = 0.0
    gain = cover_gain(np.eye(n, dtype=bool), weights)
    found = solve_orienteering(
        travel_s, service_s, budget_s, n_required, gain, required=required, seed=seed, max_rounds=30
    )
    made = [stop for sortie in found.sorties for stop in sortie]
    assert len(set(made)) == len(made)
    assert {stops[0] for stops in required} <= set(made)
    assert max(found.durations_s) <= budget_s * (1.0 + 1e-9)
    assert found.value == pytest.approx(weights[made].sum())
    assert found.value <= found.bound + 1e-9
    with pytest.raises(ValueError, match="required: expected at most 1 sorties, got 2"):
        solve_orienteering(travel_s, service_s, budget_s, 1, gain, required=((0,), (1,)))
