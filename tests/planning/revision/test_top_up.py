"""Top-ups: what photos left open is closed, by flights that keep every rule and last no longer than the battery."""

from __future__ import annotations

import functools
import itertools
import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.aircraft.catalogue import profile
from planning.base.errors import InfeasibleError
from planning.base.findings import is_flyable
from planning.base.progress import Trace
from planning.checks import check_plan
from planning.coverage.evaluate import coverage_counts
from planning.coverage.positions import aimed_views
from planning.motion.timing import usable_battery_s
from planning.parameters import Constraints, FlightRules
from planning.plan import Plan, Viewpoint, ViewpointArrays, viewpoint_arrays
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.revision import closing_flights as closing_candidates
from planning.revision.closing_flights import ClosingTask, shortest_covering_flight
from planning.revision.top_up import METHOD, Target, TopUp, TopUpRequest, WhyMissing, top_up
from planning.routing.flights import draw_flights, flight_times
from planning.site.records import NoFlyZone, SiteModel
from planning.viewpoints.prepare import Prepared, prepare
from planning.viewpoints.problem import ViewProblem, take
from planning.viewpoints.spacing import merge_close_views
from tests.planning.plan_cases import kiosk, seen_by_contract
from tests.planning.revision.cases import NEAR, QUICK
from tests.planning.test_planner import assert_keeps_the_contract

SOON = TopUpRequest(time_budget_s=0.2)


@functools.cache
def prepared_kiosk() -> Prepared:
    return prepare(kiosk(), profile("m3e").camera, NEAR)


@functools.cache
def flown_plan(n_views: int = 25) -> Plan:
    """A plan over the kiosk, with a reserve that leaves 75 % of a battery."""
    request = PlanRequest(n_views=n_views, constraints=NEAR, greedy=QUICK, time_budget_s=600.0)
    return plan_flight(kiosk(), request, prepared=prepared_kiosk()).plan


def photos(plan: Plan, without: Sequence[int] = ()) -> ViewpointArrays:
    """Poses exactly as planned, but for some views, by their number."""
    return viewpoint_arrays(tuple(v for i, v in enumerate(plan.viewpoints) if i not in set(without)))


def topped_up(plan: Plan, taken: ViewpointArrays, request: TopUpRequest = SOON, **arguments: object) -> TopUp:
    return top_up(kiosk(), plan, taken, request, prepared=prepared_kiosk(), **arguments)  # type: ignore[arg-type]


def sections(plan: Plan, viewpoints: Sequence[Viewpoint]) -> set[tuple[int, int]]:
    """What viewpoints cover, in the contract's own words."""
    step, occlusion = plan.constraints.section_step_deg, plan.constraints.occlusion == "on"
    return set(seen_by_contract(kiosk(), plan.camera, tuple(viewpoints), step, occlusion))


def in_order_s(prepared: Prepared, plan: Plan, missed: Sequence[int]) -> float:
    """Duration of flying the missed views again in their order."""
    views = photos(plan, [i for i in range(len(plan.viewpoints)) if i not in set(missed)])
    times = flight_times(prepared.problem.roadmap, views, plan.aircraft, plan.rules)
    return draw_flights(times, (tuple(range(len(missed))),), views, plan.aircraft, plan.rules)[0].duration_s


@pytest.mark.slow
@settings(max_examples=5)
@given(missed=st.sets(st.integers(0, 24), min_size=1, max_size=12))
def test_all_promised_sections_are_closed_in_no_more_time_than_flying_the_missed_views_again(missed: set[int]) -> None:
    plan = flown_plan()
    found = topped_up(plan, photos(plan, sorted(missed)))
    flown = [v for i, v in enumerate(plan.viewpoints) if i not in missed]
    promised, seen = sections(plan, plan.viewpoints), sections(plan, flown)
    assert (found.promised, found.delivered, found.seen) == (len(promised), len(promised & seen), len(seen))
    assert found.wanted == len(promised - seen)
    if not found.wanted:
        assert found.plan is None
        return
    assert found.plan is not None
    assert found.missing == ()
    assert found.closed == found.wanted == found.bound
    assert promised <= seen | sections(plan, found.plan.viewpoints)
    assert found.together == len(seen | sections(plan, found.plan.viewpoints))
    assert found.plan.duration_s <= in_order_s(prepared_kiosk(), plan, sorted(missed)) + 0.1
    assert found.shortest_s is not None
    assert found.shortest_s <= found.plan.duration_s + 0.1
    assert_keeps_the_contract(kiosk(), found.plan)
    assert is_flyable(check_plan(found.plan, kiosk()))


@pytest.mark.slow
def test_the_plan_says_that_it_is_a_top_up_and_keeps_camera_aircraft_and_rules() -> None:
    plan = flown_plan()
    found = topped_up(plan, photos(plan, range(10)), replace(SOON, seed=4)).plan
    assert found is not None
    assert (found.method, found.seed) == (METHOD, 4)
    assert (found.camera, found.aircraft, found.rules, found.profile) == (
        plan.camera,
        plan.aircraft,
        plan.rules,
        plan.profile,
    )
    assert found.coverage.covered == np.count_nonzero(coverage_counts(prepared_kiosk().problem.model, found.viewpoints))


@pytest.mark.long
def test_views_of_the_plan_keep_their_names_and_new_ones_get_further_names() -> None:
    plan = flown_plan()
    found = topped_up(plan, photos(plan, range(0, 25, 2))).plan
    assert found is not None
    poses = {v.id: (v.position_enu_m, v.heading_deg, v.gimbal_pitch_deg) for v in plan.viewpoints}
    for viewpoint in found.viewpoints:
        pose = (viewpoint.position_enu_m, viewpoint.heading_deg, viewpoint.gimbal_pitch_deg)
        assert (poses.get(viewpoint.id) == pose) == (viewpoint.id in poses)
        assert (pose in poses.values()) == (viewpoint.id in poses)


@pytest.mark.slow
def test_nothing_flown_is_planned_anew_and_all_flown_needs_no_flight() -> None:
    plan = flown_plan()
    nothing = topped_up(plan, photos(plan, range(25)), replace(SOON, time_budget_s=1.0))
    assert (nothing.seen, nothing.delivered) == (0, 0)
    assert nothing.plan is not None
    assert nothing.closed == nothing.wanted == nothing.promised == plan.coverage.covered
    assert nothing.plan.duration_s <= plan.duration_s + 0.1
    everything = topped_up(plan, photos(plan))
    assert (everything.plan, everything.wanted, everything.missing) == (None, 0, ())
    assert everything.together == everything.promised == plan.coverage.covered


@pytest.mark.slow
def test_photos_taken_twice_change_nothing() -> None:
    plan = flown_plan()
    once = photos(plan, range(6))
    twice = ViewpointArrays(*(np.concatenate([part, part[::-1]]) for part in once))
    first, second = topped_up(plan, once), topped_up(plan, twice)
    assert (first.seen, first.wanted, first.closed) == (second.seen, second.wanted, second.closed)


@pytest.mark.slow
@settings(max_examples=4)
@given(seed=st.integers(0, 1000), error_m=st.floats(0.0, 1.0))
def test_sections_are_decided_by_the_poses_of_the_photos(seed: int, error_m: float) -> None:
    plan = flown_plan()
    rng = np.random.default_rng(seed)
    taken = photos(plan)
    moved = taken._replace(
        positions_enu_m=taken.positions_enu_m + rng.normal(size=(25, 3)) * error_m,
        heading_rad=taken.heading_rad + rng.normal(size=25) * 0.02,
    )
    seen = sections(plan, viewpoints_of(moved))
    found = topped_up(plan, moved)
    assert found.seen == len(seen)
    assert found.wanted == len(sections(plan, plan.viewpoints) - seen)
    assert found.closed == found.wanted


def viewpoints_of(views: ViewpointArrays) -> tuple[Viewpoint, ...]:
    angles = np.degrees(np.stack([views.heading_rad, views.pitch_rad], axis=1))
    return tuple(
        Viewpoint(f"p{i}", tuple(position), float((heading + 180.0) % 360.0 - 180.0), float(pitch))
        for i, (position, (heading, pitch)) in enumerate(zip(views.positions_enu_m.tolist(), angles, strict=True))
    )


@pytest.mark.slow
def test_everything_reachable_is_more_than_what_was_promised() -> None:
    plan = flown_plan(6)
    found = topped_up(plan, photos(plan, [0]), replace(SOON, target=Target.REACHABLE, time_budget_s=1.5))
    promised = topped_up(plan, photos(plan, [0]))
    assert found.wanted > promised.wanted
    assert found.together > plan.coverage.covered
    reachable = prepared_kiosk().problem.reachability
    assert 0.98 * reachable.n_reachable < found.together <= reachable.upper_bound


@pytest.mark.slow
def test_a_battery_limits_the_flight_and_what_it_leaves_open_is_said() -> None:
    plan = flown_plan()
    taken = photos(plan, range(25))
    everything = topped_up(plan, taken)
    assert everything.plan is not None
    charge = plan.rules.battery_reserve + 0.6 * everything.plan.duration_s / plan.aircraft.endurance_s
    found = topped_up(plan, taken, replace(SOON, battery=charge, time_budget_s=1.0))
    assert found.plan is not None
    assert found.on_board
    assert len(found.plan.sorties) == 1
    assert found.plan.duration_s <= 0.6 * everything.plan.duration_s + 1e-6
    assert 0.5 * everything.wanted < found.closed < found.wanted
    assert found.closed <= found.bound
    assert len(found.missing) == found.wanted - found.closed
    assert {section.why for section in found.missing} == {WhyMissing.BATTERY}
    assert found.shortest_s is None


@pytest.mark.long
def test_a_battery_that_suffices_changes_nothing_but_says_that_it_is_used() -> None:
    plan = flown_plan()
    found = topped_up(plan, photos(plan, range(8)), replace(SOON, battery=0.9))
    assert found.plan is not None
    assert (found.on_board, found.closed) == (True, found.wanted)


@pytest.mark.slow
def test_a_full_battery_is_taken_where_the_one_on_board_does_not_suffice() -> None:
    plan = flown_plan()
    found = topped_up(plan, photos(plan, range(20)), replace(SOON, battery=0.28, n_batteries=1, time_budget_s=1.0))
    assert found.plan is not None
    assert (found.on_board, found.closed, len(found.plan.sorties)) == (False, found.wanted, 1)


@pytest.mark.slow
def test_the_battery_on_board_is_flown_first_where_full_ones_do_not_suffice() -> None:
    plan = flown_plan()
    short = replace(plan, rules=replace(plan.rules, battery_reserve=0.97))
    taken = photos(plan, range(10))
    one = topped_up(short, taken, replace(SOON, n_batteries=1))
    both = topped_up(short, taken, replace(SOON, battery=1.0, n_batteries=1))
    assert one.plan is not None
    assert both.plan is not None
    assert (one.on_board, len(one.plan.sorties)) == (False, 1)
    assert (both.on_board, len(both.plan.sorties)) == (True, 2)
    assert one.closed < both.closed <= both.wanted
    for sortie in both.plan.sorties:
        assert sortie.duration_s <= usable_battery_s(short.aircraft, short.rules) + 30.01


@pytest.mark.slow
def test_a_battery_on_board_that_reaches_nothing_is_left_out() -> None:
    plan = flown_plan()
    short = replace(plan, rules=replace(plan.rules, battery_reserve=0.97))
    charge = 0.97 + 31.0 / plan.aircraft.endurance_s
    found = topped_up(short, photos(plan, range(10)), replace(SOON, battery=charge, n_batteries=1))
    assert found.plan is not None
    assert (found.on_board, len(found.plan.sorties)) == (False, 1)
    assert 0 < found.closed < found.wanted


@pytest.mark.slow
def test_as_many_full_batteries_as_it_takes_close_everything() -> None:
    plan = flown_plan()
    short = replace(plan, rules=replace(plan.rules, battery_reserve=0.97))
    found = topped_up(short, photos(plan, range(10)))
    assert found.plan is not None
    assert len(found.plan.sorties) > 1
    assert (found.closed, found.missing) == (found.wanted, ())
    assert_keeps_the_contract(kiosk(), found.plan)


@pytest.mark.slow
def test_what_is_only_out_of_reach_stays_in_sight_round_after_round(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the plan's own views as only candidates: after the first round only those within reach are known."""
    monkeypatch.setattr(closing_candidates, "_places", lambda *_: np.zeros((0, 3)))
    problem, plan = prepared_kiosk().problem, flown_plan()
    views = photos(plan)
    times = flight_times(problem.roadmap, views, plan.aircraft, plan.rules)
    alone_s = times.travel_s[0, 1:] + times.service_s + times.travel_s[1:, 0]
    elements = np.unique(problem.model.elements(views).items).astype(np.int64)
    task = ClosingTask(problem, plan.aircraft, plan.rules, elements, float(np.median(alone_s)))
    found = shortest_covering_flight(task, views)
    assert len(found.shown) < len(found.in_sight) == len(elements)


@pytest.mark.slow
def test_a_battery_for_one_view_flies_one_view() -> None:
    plan = flown_plan()
    model = prepared_kiosk().problem
    times = flight_times(model.roadmap, photos(plan, range(10, 25)), plan.aircraft, plan.rules)
    alone_s = times.travel_s[0, 1:] + times.service_s + times.travel_s[1:, 0]
    charge = plan.rules.battery_reserve + (alone_s.min() + 30.0 + 1.0) / plan.aircraft.endurance_s
    found = topped_up(plan, photos(plan, range(10)), replace(SOON, battery=charge))
    assert found.plan is not None
    assert 1 <= len(found.plan.viewpoints) <= 2, "a second photo from the same place may fit"
    assert 0 < found.closed < found.wanted


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("charge", "words"), [(0.25, "leave nothing to fly on; change the battery"), (0.262, "change the battery")]
)
def test_a_battery_that_closes_nothing_is_refused_in_the_pilot_s_words(charge: float, words: str) -> None:
    plan = flown_plan()
    far = replace(plan, rules=FlightRules(takeoff_landing_s=29.0))
    with pytest.raises(InfeasibleError, match=words) as refused:
        topped_up(far, photos(plan, range(25)), replace(SOON, battery=charge))
    assert f"{charge:.0%}" in str(refused.value)


def with_zone(zone: NoFlyZone) -> SiteModel:
    model = kiosk()
    airspace = model.site.airspace
    return replace(model, site=replace(model.site, airspace=replace(airspace, no_fly=(*airspace.no_fly, zone))))


@pytest.mark.slow
def test_a_view_in_a_volume_that_is_forbidden_now_is_replaced_by_others() -> None:
    plan = flown_plan()
    x, y, z = plan.viewpoints[3].position_enu_m
    zone = NoFlyZone("event", ((x - 1, y - 1), (x + 1, y - 1), (x + 1, y + 1), (x - 1, y + 1)), z - 1.0, z + 1.0)
    site_model = with_zone(zone)
    found = top_up(site_model, plan, photos(plan, [2, 3, 4]), replace(SOON, time_budget_s=1.5))
    assert found.plan is not None
    assert_keeps_the_contract(site_model, found.plan)
    assert found.closed > 0
    unreachable = found.prepared.problem.reachability
    assert all(section.why is WhyMissing.UNREACHABLE for section in found.missing)
    ids = [panel.id for panel in site_model.site.panels]
    for section in found.missing:
        assert unreachable.verdicts[ids.index(section.panel_id), section.section] != 1


@pytest.mark.slow
def test_what_no_allowed_place_sees_any_more_is_said_to_be_unreachable() -> None:
    plan = flown_plan()
    everywhere = ((5.0, -39.0), (39.0, -39.0), (39.0, 39.0), (5.0, 39.0))
    site_model = with_zone(NoFlyZone("east", everywhere, 0.0, 100.0))
    only_east = [i for i, v in enumerate(plan.viewpoints) if v.position_enu_m[0] > 8.0]
    found = top_up(site_model, plan, photos(plan, only_east), replace(SOON, time_budget_s=1.5))
    assert {section.why for section in found.missing} == {WhyMissing.UNREACHABLE}
    assert found.closed + len(found.missing) == found.wanted


def test_nothing_in_sight_is_refused() -> None:
    plan = flown_plan()
    tight = NoFlyZone("all round", ((-18.0, -18.0), (19.0, -18.0), (19.0, 19.0), (-18.0, 19.0)), 0.0, 100.0)
    near = replace(plan, constraints=replace(plan.constraints, max_distance_m=12.0))
    with pytest.raises(InfeasibleError, match=r"viewpoint sees any panel|seen from any allowed place"):
        top_up(with_zone(tight), near, photos(plan, range(25)), SOON)


def test_one_section_that_only_one_place_sees_is_closed_from_there() -> None:
    problem = prepared_kiosk().problem
    plan = flown_plan()
    rarest = rarest_view(problem)
    only = replace(plan, viewpoints=(*plan.viewpoints[:5], rarest), sorties=())
    found = topped_up(only, photos(only, [5]))
    missing = sections(plan, [rarest]) - sections(plan, plan.viewpoints[:5])
    assert found.wanted == len(missing) > 0
    assert (found.closed, found.missing) == (found.wanted, ())


def alone(n_sections: int) -> tuple[Plan, int]:
    """A plan of 60 views, and one of them that alone shows so many sections."""
    plan = flown_plan(60)
    counts = coverage_counts(prepared_kiosk().problem.model, plan.viewpoints)
    for view, viewpoint in enumerate(plan.viewpoints):
        shows = coverage_counts(prepared_kiosk().problem.model, (viewpoint,))
        if int(np.count_nonzero((shows > 0) & (counts == 1))) == n_sections:
            return plan, view
    raise AssertionError(f"no view shows {n_sections} sections alone")


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize(("n_missing", "is_few"), [(1, True), (2, False)])
def test_a_rest_is_negligible_up_to_a_two_hundredth_of_the_sections_and_its_cost_is_known(
    n_missing: int, is_few: bool
) -> None:
    plan, view = alone(n_missing)
    assert 200 <= plan.coverage.covered < 400
    found = topped_up(plan, photos(plan, [view]))
    assert (found.wanted, found.closed, found.aimed) == (n_missing, n_missing, plan.coverage.covered)
    assert found.is_negligible is is_few
    assert found.plan is not None
    assert found.plan.duration_s > 0.0
    assert not topped_up(plan, photos(plan)).is_negligible


@pytest.mark.long
def test_a_negligible_rest_that_cannot_be_shown_or_flown_for_is_no_error() -> None:
    plan, view = alone(1)
    flat = topped_up(plan, photos(plan, [view]), replace(SOON, battery=0.2))
    assert flat.plan is not None, "it says what a full battery would do"
    assert not flat.on_board
    walls = NoFlyZone("all round", ((-18.0, -18.0), (19.0, -18.0), (19.0, 19.0), (-18.0, 19.0)), 0.0, 100.0)
    near = replace(plan, constraints=replace(plan.constraints, max_distance_m=60.0))
    hidden = top_up(with_zone(walls), near, photos(plan, [view]), SOON)
    assert hidden.is_negligible
    assert len(hidden.missing) == 1 - hidden.closed


def rarest_view(problem: ViewProblem) -> Viewpoint:
    """A view at the witness of the section with the fewest witnesses around."""
    reachability = problem.reachability
    element = int(np.flatnonzero(reachability.verdicts.reshape(-1) == 1)[-1])
    place = reachability.witnesses_enu_m.reshape(-1, 3)[element][None]
    panel = element // problem.model.grid.n_sections
    view = aimed_views(place, problem.model.frames.centroids[panel][None], problem.model.camera)
    return replace(viewpoints_of(view)[0], id="rare")


@pytest.mark.slow
def test_the_trace_and_the_durations_show_what_time_bought() -> None:
    plan = flown_plan()
    trace = Trace()
    found = topped_up(plan, photos(plan, range(15)), replace(SOON, time_budget_s=1.5), trace=trace)
    values = [point.value for point in found.durations]
    assert values == sorted(values, reverse=True)
    assert values[-1] == pytest.approx(found.plan.duration_s if found.plan else 0.0, rel=0.02)
    assert trace.points[-1].value == found.closed
    assert trace.bound is not None
    assert trace.bound >= found.closed


@pytest.mark.slow
def test_a_stop_ends_the_search_with_a_whole_answer() -> None:
    plan = flown_plan()
    started = time.process_time()
    found = topped_up(plan, photos(plan, range(15)), replace(SOON, time_budget_s=600.0), stop=lambda: True)
    assert time.process_time() - started < 30.0
    assert (found.closed, found.missing) == (found.wanted, ())


def test_a_site_prepared_for_other_constraints_is_refused() -> None:
    plan = replace(flown_plan(), constraints=Constraints(min_distance_m=6.0, occlusion="on"))
    with pytest.raises(ValueError, match="prepared: is for"):
        topped_up(plan, photos(plan, [0]))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"battery": 1.5}, "battery: expected a charge from 0 to 1"),
        ({"battery": float("nan")}, "battery: expected a charge from 0 to 1"),
        ({"n_batteries": 0}, "batteries: expected 1 to 100"),
        ({"seed": -1}, "seed: expected"),
        ({"time_budget_s": 0.0}, "time budget: expected"),
    ],
)
def test_wrong_requests_are_refused(arguments: dict[str, float], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        TopUpRequest(**arguments)  # type: ignore[arg-type]


def test_elements_that_are_covered_all_the_same_do_not_hold_close_views_apart() -> None:
    problem, plan = prepared_kiosk().problem, flown_plan()
    views = photos(plan)
    pair = take(views, np.array([4, 4]))
    pair = pair._replace(positions_enu_m=pair.positions_enu_m + np.array([[0.0, 0.0, 0.0], [0.2, 0.2, 0.1]]))
    unmoved = merge_close_views(problem, pair, 0.5)
    nothing = merge_close_views(problem, pair, 0.5, covered=np.zeros(problem.model.n_elements, np.int32))
    np.testing.assert_array_equal(unmoved.positions_enu_m, nothing.positions_enu_m)
    merged = merge_close_views(problem, pair, 0.5, covered=np.ones(problem.model.n_elements, np.int32))
    assert (merged.positions_enu_m[0] == merged.positions_enu_m[1]).all()


def test_wanted_sections_are_counted_as_the_model_counts_them() -> None:
    problem, plan = prepared_kiosk().problem, flown_plan()
    elements = np.arange(0, problem.model.n_elements, 3)
    task = ClosingTask(problem, plan.aircraft, plan.rules, elements, 100.0)
    pool = task.pool(photos(plan))
    whole = problem.model.elements(photos(plan))
    for view in range(25):
        expected = [e for e in whole.of(view).tolist() if e % 3 == 0]
        assert sorted(elements[pool.elements.of(view)].tolist()) == sorted(expected)


@pytest.mark.slow
def test_the_top_up_of_a_tiny_plan_is_the_shortest_of_all_subsets_and_orders() -> None:
    """Against every order of every subset of the plan's own views; other views may make it shorter still."""
    plan = flown_plan(6)
    prepared = prepared_kiosk()
    missed = [0, 2, 3, 5]
    views = photos(plan, [1, 4])
    wanted = sections(plan, plan.viewpoints) - sections(plan, [plan.viewpoints[1], plan.viewpoints[4]])
    shows = [sections(plan, [plan.viewpoints[i]]) & wanted for i in missed]
    times = flight_times(prepared.problem.roadmap, views, plan.aircraft, plan.rules)
    shortest_s = min(
        draw_flights(times, (order,), views, plan.aircraft, plan.rules)[0].duration_s
        for size in range(1, 5)
        for order in itertools.permutations(range(4), size)
        if set().union(*(shows[i] for i in order)) == wanted
    )
    found = topped_up(plan, photos(plan, missed), replace(SOON, time_budget_s=1.0))
    assert found.plan is not None
    assert found.closed == len(wanted)
    assert found.plan.duration_s <= shortest_s + 0.1
