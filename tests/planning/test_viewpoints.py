"""Optimisers: exact gains, certificates that hold, goals that are met, and the paper's method kept faithful."""

import functools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.aircraft.catalogue import profile
from planning.base.errors import InfeasibleError, OperationCancelled
from planning.base.progress import QUIET, TimeLimit, Trace, never
from planning.coverage.model import CoverageModel, Elements, element_weights, exact_coverage
from planning.coverage.reachability import find_reachable
from planning.coverage.sections import SectionGrid, panel_frames
from planning.parameters import GreedyParameters
from planning.routing.roadmap import build_roadmap
from planning.site.bundled import SCENES
from planning.site.free_space import free_space
from planning.site.records import Airspace, panel_corners
from planning.viewpoints import cover_kernel as kernel
from planning.viewpoints.candidates import candidate_pool
from planning.viewpoints.greedy import choose_greedily, dual_bound, greedy
from planning.viewpoints.improve import Exchange, cover_state, refine_views
from planning.viewpoints.noto import noto
from planning.viewpoints.orbit import orbit
from planning.viewpoints.problem import Goal, ViewProblem
from planning.viewpoints.pso import PsoParameters, pso
from tests.planning.routing_cases import Counting
from tests.planning.viewpoints.exact_optimum import exact_optimum

FAST = GreedyParameters(n_candidates=3000)


@functools.cache
def problem_of(scene, **options):
    site_model = SCENES[scene]()
    space = free_space(site_model, 10.0)
    model = CoverageModel(
        panel_frames(panel_corners(site_model.site)), profile("m3e").camera, SectionGrid(30.0), **options
    )
    return ViewProblem(model, space, find_reachable(model, space, max_positions=8000), build_roadmap(space))


def run(method, problem, goal, seed=0, stop=never, monitor=QUIET, **options):
    trace = Trace()
    return method(problem, goal, seed=seed, stop=stop, trace=trace, monitor=monitor, **options), trace


def random_cover(rng, n_candidates, n_elements):
    rows = [np.flatnonzero(rng.random(n_elements) < 0.15).astype(np.int32) for _ in range(n_candidates)]
    return Elements(np.concatenate([[0], np.cumsum([len(r) for r in rows])]), np.concatenate(rows).astype(np.int32))


@given(seed=st.integers(0, 1000), depth=st.integers(1, 3))
@settings(max_examples=40)
def test_gains_stay_exact_through_any_sequence_of_additions_and_removals(seed, depth):
    rng = np.random.default_rng(seed)
    elements, weights = random_cover(rng, 20, 30), rng.integers(1, 5, 30).astype(float)
    state = cover_state(elements, weights)
    state.depth[0] = depth
    kernel.refresh_gains(state)
    chosen = []
    for _ in range(30):
        if chosen and rng.random() < 0.4:
            kernel.remove_elements(state, elements.of(chosen.pop()))
        else:
            chosen.append(int(rng.integers(20)))
            kernel.add_elements(state, elements.of(chosen[-1]))
        kept = state.gains.copy()
        kernel.refresh_gains(state)
        np.testing.assert_array_equal(kept, state.gains)
    expected = sum(w * min(sum(e in elements.of(c) for c in chosen), depth) for e, w in enumerate(weights))
    assert kernel.objective(state) == pytest.approx(expected)


@pytest.mark.slow
@given(seed=st.integers(0, 300), n_views=st.integers(1, 6))
@settings(max_examples=25)
def test_greedy_is_below_the_exact_optimum_which_is_below_the_dual_bound(seed, n_views):
    rng = np.random.default_rng(seed)
    elements, weights = random_cover(rng, 25, 40), rng.integers(1, 4, 40).astype(float)
    state = cover_state(elements, weights)
    chosen = np.zeros(n_views, np.int64)
    kernel.greedy_steps(state, chosen, 0, n_views, np.inf)
    value = kernel.objective(state)
    optimum, best, proven = exact_optimum(elements, weights, n_views)
    covered = np.unique(np.concatenate([elements.of(c) for c in best]))
    assert weights[covered].sum() == pytest.approx(optimum)
    assert proven == pytest.approx(optimum)
    assert (1.0 - 1.0 / np.e) * optimum - 1e-9 <= value <= optimum + 1e-9
    greedy_bound = value + np.sort(state.gains)[-n_views:].sum()
    assert greedy_bound >= optimum - 1e-9
    assert dual_bound(elements, weights, n_views, value) >= optimum - 1e-6


@pytest.mark.slow
def test_exchange_reaches_the_exact_optimum_of_small_problems_where_greedy_does_not():
    worse = 0
    for seed in range(20):
        rng = np.random.default_rng(seed)
        elements, weights = random_cover(rng, 30, 60), np.ones(60)
        state, chosen = cover_state(elements, weights), np.zeros(5, np.int64)
        kernel.greedy_steps(state, chosen, 0, 5, np.inf)
        optimum = round(exact_optimum(elements, weights, 5)[0])
        worse += kernel.objective(state) < optimum
        exchange = Exchange(elements, weights, chosen, seed)
        exchange.run(never)
        assert exchange.value() >= kernel.objective(state)
        assert exchange.value() >= optimum - 1
    assert worse >= 5


@pytest.mark.slow
def test_greedy_with_enough_views_covers_everything_any_candidate_covers_and_spends_the_rest_on_depth():
    problem = problem_of("office")
    chosen, trace = run(greedy, problem, Goal(n_views=400), parameters=FAST)
    counts = exact_coverage(problem.model, chosen.views)
    assert len(chosen.views.heading_rad) == 400
    assert len(np.unique(np.column_stack(chosen.views), axis=0)) == 400
    assert np.count_nonzero(counts) >= 0.99 * problem.reachability.upper_bound
    assert np.count_nonzero(counts) <= problem.reachability.upper_bound
    assert np.count_nonzero(counts >= 2) > 0.95 * np.count_nonzero(counts)
    assert problem.flyable(chosen.views.positions_enu_m).all()
    values = [point.value for point in trace.points]
    assert values == sorted(values)
    fewer, _ = run(greedy, problem, Goal(n_views=150), parameters=replace(FAST, improve=False, certify=False))
    finer = replace(problem.model, grid=SectionGrid(15.0))
    assert finer.covered_count(chosen.views) > 1.15 * finer.covered_count(fewer.views)


@pytest.mark.slow
def test_improvement_beats_plain_greedy_and_never_passes_the_reachable_bound():
    problem = problem_of("office")
    plain, _ = run(greedy, problem, Goal(n_views=30), parameters=replace(FAST, improve=False))
    better, trace = run(greedy, problem, Goal(n_views=30), stop=Counting(160), parameters=FAST)
    covered = [problem.model.covered_count(found.views) for found in (plain, better)]
    assert covered[1] > 1.01 * covered[0]
    assert covered[1] <= problem.reachability.upper_bound
    assert trace.points[-1].value == covered[1]
    assert covered[0] <= plain.bound <= problem.reachability.upper_bound


@pytest.mark.slow
def test_fewest_views_for_a_share_reach_it_with_fewer_than_greedy_alone():
    problem = problem_of("office")
    plain, _ = run(greedy, problem, Goal(share=0.9), parameters=replace(FAST, improve=False))
    better, _ = run(greedy, problem, Goal(share=0.9), stop=Counting(160), parameters=FAST)
    pool = candidate_pool(problem, 0, FAST.n_candidates)
    wanted = 0.9 * len(np.unique(pool.elements.items))
    for found in (plain, better):
        assert problem.model.covered_count(found.views) >= wanted
    assert len(better.views.heading_rad) < len(plain.views.heading_rad)


@pytest.mark.slow
def test_solid_angle_weights_prefer_the_larger_sections():
    problem = problem_of("office")
    areas = element_weights(problem.model, True)
    results = [
        problem.model.covered(
            run(
                greedy,
                problem,
                Goal(n_views=15),
                parameters=replace(FAST, improve=False, certify=False, solid_angle_weights=by_area),
            )[0].views
        )
        for by_area in (False, True)
    ]
    assert areas[results[1]].sum() > areas[results[0]].sum()
    assert results[1].sum() < results[0].sum()


def test_same_seed_gives_the_same_views_and_another_seed_others():
    problem = problem_of("roof")
    views = [
        run(greedy, problem, Goal(n_views=12), seed=seed, parameters=replace(FAST, improve=False))[0].views
        for seed in (3, 3, 4)
    ]
    np.testing.assert_array_equal(views[0].positions_enu_m, views[1].positions_enu_m)
    assert not np.array_equal(views[0].positions_enu_m, views[2].positions_enu_m)


@pytest.mark.slow
def test_refining_never_loses_and_stops_when_asked():
    problem = problem_of("office")
    pool = candidate_pool(problem, 0, 2000)
    weights = element_weights(problem.model, False)
    chosen, value = choose_greedily(pool, weights, 20, np.inf, Trace(), QUIET)
    views = type(pool.views)(*(column[chosen] for column in pool.views))
    refined = refine_views(problem, views, weights, TimeLimit(2.0))
    assert problem.model.covered_count(refined) > value
    assert problem.flyable(refined.positions_enu_m).all()
    untouched = refine_views(problem, views, weights, lambda: True)
    np.testing.assert_array_equal(untouched.positions_enu_m, views.positions_enu_m)


@pytest.mark.long
def test_particle_swarm_never_gets_worse_and_keeps_every_constraint():
    problem = problem_of("office")
    parameters = PsoParameters(population=12, iterations=25)
    found, trace = run(pso, problem, Goal(n_views=60), parameters=parameters)
    values = [point.value for point in trace.points]
    assert values == sorted(values)
    assert values[-1] > values[0]
    assert len(values) == 26
    assert len(found.views.heading_rad) == 60
    assert problem.space.is_allowed(found.views.positions_enu_m).all()
    low, high = problem.model.camera.gimbal_pitch_deg
    assert (
        (np.degrees(found.views.pitch_rad) >= low - 1e-9) & (np.degrees(found.views.pitch_rad) <= high + 1e-9)
    ).all()
    assert problem.model.covered_count(found.views) == values[-1]


@pytest.mark.long
def test_particle_swarm_attracts_along_the_shorter_way_around_the_compass():
    problem = problem_of("single-panel")
    parameters = PsoParameters(population=30, iterations=60)
    found, _ = run(pso, problem, Goal(n_views=4), parameters=parameters)
    assert problem.model.covered_count(found.views) == 4


@pytest.mark.slow
def test_grid_follows_the_facade_at_constant_distance_looking_straight_at_it():
    problem = problem_of("library")
    found, _ = run(noto, problem, Goal(n_views=200))
    assert 150 <= len(found.views.heading_rad) <= 200
    clearance = problem.space.solids.clearance_m(found.views.positions_enu_m)
    assert np.abs(clearance - 10.5).max() < 0.5
    assert np.abs(found.views.pitch_rad).max() < 0.05
    assert problem.model.covered_count(found.views) < 0.6 * problem.reachability.upper_bound


@pytest.mark.long
def test_orbits_look_inwards_from_all_around():
    problem = problem_of("office")
    found, _ = run(orbit, problem, Goal(n_views=100))
    assert len(found.views.heading_rad) == 100
    inwards = -found.views.positions_enu_m[:, :2] + [0.0, 9.0]
    forward = np.c_[np.sin(found.views.heading_rad), np.cos(found.views.heading_rad)]
    cosine = (inwards * forward).sum(1) / np.linalg.norm(inwards, axis=1)
    assert cosine.min() > 0.95


@pytest.mark.long
@pytest.mark.parametrize("method", [greedy, pso, noto, orbit])
def test_every_method_can_be_cancelled(method):
    class Cancelling:
        def report(self, stage, done, total):
            raise OperationCancelled("cancelled")

    with pytest.raises(OperationCancelled):
        run(method, problem_of("office"), Goal(n_views=50), monitor=Cancelling())


def test_site_whose_panels_face_inwards_is_infeasible_and_says_why():
    site_model = SCENES["single-panel"]()
    airspace = Airspace((-50.0, -50.0, 2.0), (50.0, -11.0, 50.0), ground_z_m=0.0)
    space = free_space(replace(site_model, site=replace(site_model.site, airspace=airspace)), 10.0)
    flipped = panel_frames(panel_corners(site_model.site)[:, ::-1])
    model = CoverageModel(flipped, profile("m3e").camera, SectionGrid(30.0))
    problem = ViewProblem(model, space, find_reachable(model, space), build_roadmap(space))
    assert problem.reachability.upper_bound == 0
    for method in (greedy, noto):
        with pytest.raises(InfeasibleError, match="clockwise"):
            run(method, problem, Goal(n_views=5))


@pytest.mark.parametrize(
    "arguments", [{}, {"n_views": 3, "share": 0.5}, {"n_views": 0}, {"share": 0.0}, {"share": 1.1}]
)
def test_senseless_goals_are_refused(arguments):
    with pytest.raises(ValueError, match="expected"):
        Goal(**arguments)
