"""Coverage within batteries: against brute force on a few candidates, more with more batteries, never more sorties."""

from __future__ import annotations

import functools
import itertools
import math
from dataclasses import replace
from typing import Any, Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from groundstation.services.plan.planning import plan_document_site
from planning.aircraft.catalogue import profile
from planning.base.errors import InfeasibleError, OperationCancelled
from planning.base.findings import is_flyable
from planning.base.progress import QUIET, Monitor, Stop, TimeLimit, Trace, never
from planning.checks import check_plan
from planning.coverage.model import CoverageModel, element_weights
from planning.coverage.reachability import find_reachable
from planning.coverage.sections import SectionGrid, panel_frames
from planning.motion.timing import usable_battery_s
from planning.parameters import Constraints, FlightRules, GreedyParameters
from planning.plan import ViewpointArrays
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.routing.flights import Flight, FlightTimes, flight_times
from planning.routing.legs import LegTable, build_leg_table
from planning.routing.roadmap import Roadmap, build_roadmap
from planning.site.bundled import SCENES
from planning.site.free_space import free_space
from planning.site.records import panel_corners
from planning.viewpoints.budget import best_flights, views_within_budget
from planning.viewpoints.candidates import Pool, candidate_pool, keep
from planning.viewpoints.least_error import image_error_model
from planning.viewpoints.problem import ViewProblem, take
from tests.planning.plan_cases import StopAfter, kiosk
from tests.planning.routing_cases import Cancelling
from tests.slow import slow

M3E = profile("m3e").aircraft
FEW = GreedyParameters(n_candidates=400, improve=False)


@functools.cache
def problem() -> ViewProblem:
    space = free_space(kiosk(), 5.0)
    model = CoverageModel(panel_frames(panel_corners(kiosk().site)), profile("m3e").camera, SectionGrid(30.0))
    return ViewProblem(model, space, find_reachable(model, space, max_positions=4000), build_roadmap(space))


@functools.cache
def few_candidates(n: int, seed: int) -> Pool:
    """Some of the candidates, spread over the site."""
    pool = candidate_pool(problem(), 0, 400)
    chosen = np.zeros(len(pool.views.heading_rad), np.bool_)
    chosen[np.random.default_rng(seed).choice(len(chosen), n, replace=False)] = True
    return keep(pool, chosen)


def rules_for(usable_s: float) -> FlightRules:
    """Rules that leave `usable_s` of a battery for flying."""
    return FlightRules(battery_reserve=1.0 - (usable_s + 30.0) / M3E.endurance_s)


def choose(
    usable_s: float,
    n_batteries: int,
    *,
    stop: Stop | None = None,
    parameters: GreedyParameters = FEW,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> tuple[ViewpointArrays, float]:
    found = views_within_budget(
        problem(),
        M3E,
        rules_for(usable_s),
        n_batteries,
        parameters,
        seed=0,
        stop=TimeLimit(0.6) if stop is None else stop,
        trace=Trace() if trace is None else trace,
        monitor=monitor,
    )
    assert found.bound is not None
    return found.views, found.bound


def best_by_force(pool: Pool, usable_s: float, n_batteries: int) -> int:
    """Most sections that the candidates cover within the batteries: all orders of all subsets, then all unions."""
    n = len(pool.views.heading_rad)
    times = flight_times(problem().roadmap, pool.views, M3E, rules_for(usable_s))
    flyable = []
    for size in range(1, n + 1):
        for subset in itertools.combinations(range(n), size):
            for order in itertools.permutations(subset):
                places = [0, *(i + 1 for i in order), 0]
                seconds = sum(times.travel_s[a, b] for a, b in itertools.pairwise(places))
                if seconds + times.service_s[list(subset)].sum() <= usable_s * (1.0 + 1e-9):
                    flyable.append(frozenset(subset))
                    break
    unions = {frozenset[int]()}
    for _ in range(n_batteries):
        unions |= {known | new for known in unions for new in flyable}
    return max(len({e for view in union for e in pool.elements.of(view)}) for union in unions)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("usable_s", "n_batteries", "seed"), [slow(45.0, 1, 0), (60.0, 1, 1), (40.0, 2, 2), slow(55.0, 2, 3)]
)
def test_a_few_candidates_give_what_brute_force_finds(
    usable_s: float, n_batteries: int, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    pool = few_candidates(6, seed)
    monkeypatch.setattr("planning.viewpoints.budget.candidate_pool", lambda *_: pool)
    views, bound = choose(usable_s, n_batteries, stop=never)
    covered, optimum = problem().model.covered_count(views), best_by_force(pool, usable_s, n_batteries)
    assert 0 < optimum < len(np.unique(pool.elements.items)) or usable_s > 50.0
    assert covered == optimum
    assert covered <= bound <= len(np.unique(pool.elements.items))


@pytest.mark.slow
def test_more_batteries_and_longer_ones_cover_more() -> None:
    covered = [problem().model.covered_count(choose(60.0, n)[0]) for n in (1, 2, 4)]
    assert covered[0] * 1.2 < covered[1]
    assert covered[1] * 1.1 < covered[2]
    longer = problem().model.covered_count(choose(120.0, 1)[0])
    assert covered[0] * 1.2 < longer


@pytest.mark.slow
def test_bound_is_above_the_result_and_never_above_what_candidates_cover_at_all() -> None:
    everything = problem().reachability.upper_bound
    for usable_s, n_batteries in [(40.0, 1), (100.0, 2), (1500.0, 3)]:
        views, bound = choose(usable_s, n_batteries)
        assert problem().model.covered_count(views) <= bound <= everything


@pytest.mark.slow
def test_trace_counts_sections_whatever_they_weigh() -> None:
    for by_area in (False, True):
        trace = Trace()
        parameters = replace(FEW, solid_angle_weights=by_area)
        views, bound = choose(80.0, 1, parameters=parameters, trace=trace)
        values = [point.value for point in trace.points]
        assert values[-1] == problem().model.covered_count(views)
        weights = element_weights(problem().model, by_area)
        assert weights[problem().model.covered(views)].sum() <= bound + 1e-9


@pytest.mark.long
def test_a_battery_that_reaches_no_view_is_refused_with_its_time() -> None:
    with pytest.raises(InfeasibleError, match="reached and left again within 6 s of one battery"):
        choose(6.0, 3)


@pytest.mark.long
@pytest.mark.parametrize("objective", ["sections", "image-error"])
def test_fewer_candidates_are_compared_where_the_time_does_not_last(
    objective: Literal["sections", "image-error"], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Seconds are said, not measured."""
    compared: list[int] = []

    def counted(roadmap: Roadmap, views: ViewpointArrays, *arguments: Any, **named: Any) -> FlightTimes:
        compared.append(len(views.heading_rad))
        return flight_times(roadmap, views, *arguments, **named)

    monkeypatch.setattr("planning.viewpoints.budget.flight_times", counted)
    few_compared(monkeypatch, 40, 40)
    monkeypatch.setattr("planning.viewpoints.budget.FEWEST_EACH", 15)
    error = None if objective == "sections" else image_error_model(problem(), kiosk())[0]
    found = [
        views_within_budget(
            problem(),
            M3E,
            rules_for(45.0),
            1,
            FEW,
            seed=0,
            stop=StopAfter(30),
            trace=Trace(),
            monitor=QUIET,
            error=error,
            remaining_s=remaining_s,
        )
        for remaining_s in (lambda: 1e-9, lambda: 1e9, lambda: math.inf)
    ]
    assert compared[0] <= 15 < compared[1] == compared[2]
    assert found[0].is_cut_short
    assert problem().model.covered_count(found[0].views) > 0
    for late, ample in zip(found[1].views, found[2].views, strict=True):
        assert np.array_equal(late, ample)
    for each in found:
        assert each.legs is not None
        reused = flight_times(problem().roadmap, each.views, M3E, rules_for(45.0), known=each.legs)
        assert reused.travel_s.shape == (len(each.views.heading_rad) + 1,) * 2
        assert np.isfinite(reused.travel_s).all()


@pytest.mark.long
@pytest.mark.parametrize(("n_batteries", "n_compared"), [(1, 20), (2, 20), (3, 30), (10, 60)])
def test_more_candidates_are_compared_for_more_batteries(
    n_batteries: int, n_compared: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    few_compared(monkeypatch, 20, 10)
    monkeypatch.setattr("planning.viewpoints.budget.MOST_COMPARED", 60)
    compared: list[int] = []

    def counted(roadmap: Roadmap, views: ViewpointArrays, *arguments: Any, **named: Any) -> FlightTimes:
        compared.append(len(views.heading_rad))
        return flight_times(roadmap, views, *arguments, **named)

    monkeypatch.setattr("planning.viewpoints.budget.flight_times", counted)
    choose(45.0, n_batteries, stop=StopAfter(200))
    assert compared == [n_compared]


def few_compared(monkeypatch: pytest.MonkeyPatch, n_most: int, n_each: int) -> None:
    """Let few candidates be compared, so that the search ends by itself."""
    monkeypatch.setattr("planning.viewpoints.budget.N_COMPARED", n_most)
    monkeypatch.setattr("planning.viewpoints.budget.N_EACH", n_each)


def test_cancelling_comes_through() -> None:
    with pytest.raises(OperationCancelled):
        choose(60.0, 1, monitor=Cancelling(0, OperationCancelled))


def flights_of(groups: list[list[int]]) -> tuple[Flight, ...]:
    none = np.zeros((2, 3))
    return tuple(Flight(np.array(views, np.int64), none, np.arange(len(views)), 60.0) for views in groups)


@given(seed=st.integers(0, 500), n_flights=st.integers(1, 6), n_batteries=st.integers(1, 6))
@settings(max_examples=30)
def test_flights_that_are_left_out_cost_little_beside_the_best_choice(
    seed: int, n_flights: int, n_batteries: int
) -> None:
    rng = np.random.default_rng(seed)
    pool = few_candidates(40, 9)
    groups = np.array_split(rng.permutation(40)[: rng.integers(n_flights, 30)], n_flights)
    flights = flights_of([group.tolist() for group in groups])
    kept = best_flights(problem().model, pool.views, flights, n_batteries)
    assert len(kept) == min(n_flights, n_batteries)
    assert [flights.index(flight) for flight in kept] == sorted(flights.index(flight) for flight in kept)

    def covered(chosen: tuple[Flight, ...]) -> int:
        return problem().model.covered_count(take(pool.views, np.concatenate([flight.views for flight in chosen])))

    best = max(covered(choice) for choice in itertools.combinations(flights, len(kept)))
    assert covered(kept) >= 0.9 * best


@pytest.mark.slow
@pytest.mark.parametrize(("scene", "reserve"), [("court", 0.92), ("canyon", 0.93), ("office", 0.93)])
def test_plans_have_no_more_sorties_than_batteries_and_cover_more_with_more(
    scene: str, reserve: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Views that fitted into two batteries once needed a third, rounded and routed anew.

    Among so few candidates the search ends by itself, long before its time is up.
    """
    few_compared(monkeypatch, 60, 20)
    covered, prepared = [], None
    for n_batteries in (1, 2, 3):
        request = PlanRequest(
            n_batteries=n_batteries,
            greedy=GreedyParameters(n_candidates=1500),
            time_budget_s=600.0,
            rules=FlightRules(battery_reserve=reserve),
        )
        planned = plan_flight(SCENES[scene](), request, prepared=prepared)
        plan, prepared = planned.plan, planned.prepared
        assert len(plan.sorties) <= n_batteries
        usable_s = usable_battery_s(plan.aircraft, plan.rules) + plan.rules.takeoff_landing_s
        assert max(sortie.duration_s for sortie in plan.sorties) <= usable_s + 0.01
        covered.append(plan.coverage.covered)
    assert covered == sorted(covered)
    assert covered[2] > covered[0]


@pytest.mark.slow
@pytest.mark.parametrize("n_batteries", [1, 2, 3])
def test_a_whole_plan_keeps_the_number_of_batteries(n_batteries: int) -> None:
    request = PlanRequest(
        n_batteries=n_batteries,
        constraints=Constraints(min_distance_m=5.0),
        greedy=FEW,
        time_budget_s=2.0,
        rules=rules_for(45.0),
    )
    plan = plan_flight(kiosk(), request).plan
    assert 1 <= len(plan.sorties) <= n_batteries
    assert math.isclose(sum(sortie.duration_s for sortie in plan.sorties), plan.duration_s)


@pytest.mark.long
@pytest.mark.parametrize(("n_batteries", "time_budget_s"), [(20, 0.1), (7, 1.0), slow(3, 600.0)])
def test_what_a_plan_for_many_batteries_says_is_what_it_flies(
    n_batteries: int, time_budget_s: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Legs are looked for once, and no view is left out for lack of ways; however the clock goes."""
    few_compared(monkeypatch, 60, 20)
    tables: list[LegTable] = []

    def told(*arguments: Any, **named: Any) -> LegTable:
        tables.append(build_leg_table(*arguments, **named))
        return tables[-1]

    monkeypatch.setattr("planning.routing.flights.build_leg_table", told)
    request = PlanRequest(
        n_batteries=n_batteries,
        constraints=Constraints(min_distance_m=5.0),
        greedy=FEW,
        time_budget_s=time_budget_s,
        rules=rules_for(45.0),
    )
    planned = plan_document_site(kiosk(), request)
    plan, said = planned.plan, {finding.code: finding for finding in planned.findings}
    assert len(tables) == 1
    assert is_flyable(check_plan(plan, kiosk()))
    assert 1 <= len(plan.sorties) <= n_batteries
    assert sum(len(sortie.viewpoint_ids) for sortie in plan.sorties) == len(plan.viewpoints)
    assert planned.n_left_out == 0
    assert ("few-compared" in said) == planned.is_cut_short
    assert ("too-many-views" in said) == (planned.n_too_many > 0)
    assert ("fewer-sorties" in said) == (len(plan.sorties) < n_batteries)
    if "fewer-sorties" in said:
        assert (said["fewer-sorties"].value, said["fewer-sorties"].limit) == (len(plan.sorties), n_batteries)
        assert ("allow it more time" in said["fewer-sorties"].message) == planned.is_cut_short


@pytest.mark.slow
def test_a_plan_that_flies_all_that_were_compared_does_not_say_that_there_is_no_more(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    few_compared(monkeypatch, 12, 1)
    request = PlanRequest(
        n_batteries=9,
        constraints=Constraints(min_distance_m=5.0),
        greedy=FEW,
        time_budget_s=600.0,
        rules=rules_for(90.0),
    )
    planned = plan_document_site(kiosk(), request)
    assert len(planned.plan.viewpoints) == 12
    assert not planned.is_cut_short
    assert planned.are_all_taken
    (said,) = (finding.message for finding in planned.findings if finding.code == "fewer-sorties")
    assert said.endswith("no more viewpoints are compared for so many; ask for a number of views to fly more")


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize("n_passed", [0, 3, 10])
def test_cancelling_a_plan_for_batteries_throws_it_away(n_passed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    few_compared(monkeypatch, 60, 20)
    request = PlanRequest(n_batteries=7, greedy=FEW, time_budget_s=600.0, rules=rules_for(45.0))
    with pytest.raises(OperationCancelled):
        plan_flight(kiosk(), request, monitor=Cancelling(n_passed, OperationCancelled))
    searching = CancellingAt("orienteering", n_passed)
    with pytest.raises(OperationCancelled):
        plan_flight(kiosk(), request, monitor=searching)
    assert searching.left < 0


class CancellingAt:
    """Monitor that cancels at the n-th report of a stage."""

    def __init__(self, stage: str, n: int) -> None:
        self.stage, self.left = stage, n

    def report(self, stage: str, done: float, total: float) -> None:
        self.left -= stage == self.stage
        if self.left < 0:
            raise OperationCancelled("cancelled")
