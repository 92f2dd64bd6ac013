"""Quality against time: curves, winners, runs of planner and routing, and the picture."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.base.errors import InputError, OperationCancelled
from planning.base.progress import QualityPoint
from planning.coverage.evaluate import coverage_counts
from planning.parameters import Constraints, GreedyParameters
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.routing.tour import tour_length
from planning.site.bundled import SCENES
from planning.site.free_space import free_space
from planning.tradeoff.plans import (
    FailedRun,
    Variants,
    bounds_by_step,
    name_of,
    plan_panels,
    plan_report,
    plan_rows,
    plan_summary,
    plan_title,
    run_plan,
    settings,
    share_text,
    time_to_part_s,
)
from planning.tradeoff.runner import (
    COVERAGE_AXIS,
    TOUR_AXIS,
    Curve,
    Line,
    Noise,
    Panel,
    answers,
    draw,
    falling,
    mean_curve,
    seconds_text,
    winner,
)
from planning.tradeoff.tours import (
    TourCase,
    plan_case,
    run_tours,
    tour_methods,
    tour_panel,
    tour_report,
    tour_rows,
    tour_summary,
    tour_title,
    tsplib_case,
)
from planning.viewpoints.prepare import coverage_model

GREEDY = GreedyParameters(n_candidates=300, improve=False, objective="sections")
BASE = PlanRequest(n_views=12, greedy=GREEDY, time_budget_s=20.0)
NO_NOISE = Noise(0.0)


def curve(*points, end_s=None):
    return Curve(tuple(QualityPoint(t, gap) for t, gap in points), points[-1][0] if end_s is None else end_s)


@given(st.lists(st.tuples(st.floats(0.0, 100.0), st.floats(0.0, 2.0)), min_size=1, max_size=20))
def test_curve_keeps_the_best_so_far_at_every_time(points):
    points = sorted(points)
    found = falling((QualityPoint(t, gap) for t, gap in points), points[-1][0])
    gaps = [point.value for point in found.points]
    assert gaps == sorted(gaps, reverse=True)
    assert len(set(gaps)) == len(gaps)
    for t_s, _ in points:
        assert found.gap_at(t_s) == min(gap for t, gap in points if t <= t_s)
    assert found.final_gap == min(gap for _, gap in points)
    assert found.time_to(found.final_gap) == min(t for t, gap in points if gap == found.final_gap)


def test_before_anything_is_found_the_gap_is_infinite_and_a_gap_never_reached_has_no_time():
    found = curve((2.0, 0.5), (3.0, 0.1))
    assert math.isinf(found.gap_at(1.9))
    assert found.time_to(0.05) is None
    assert found.until(2.5).final_gap == 0.5
    assert math.isinf(Curve((), 1.0).final_gap)


def test_smallest_gap_wins_and_within_the_noise_the_first_to_get_there():
    curves = {"slow": curve((1.0, 0.5), (50.0, 0.010)), "quick": curve((2.0, 0.0105)), "poor": curve((0.1, 0.2))}
    assert winner(curves, NO_NOISE) == "slow"
    assert winner(curves, Noise(floor=0.0, share=0.06)) == "quick"
    assert winner(curves, Noise(floor=0.0004)) == "slow"
    assert winner({"none": Curve((), 1.0)}, NO_NOISE) is None
    assert winner({}, NO_NOISE) is None


def test_answers_name_the_best_at_each_budget_and_the_first_at_each_gap():
    curves = {"slow": curve((5.0, 0.3), (20.0, 0.01)), "quick": curve((2.0, 0.2), (4.0, 0.1))}
    found = answers(curves, (0.25, 0.1, 0.001), NO_NOISE, (1.0, 3.0, 30.0))
    assert found.winner == "slow"
    assert [(b.run, b.gap) for b in found.by_budget] == [(None, None), ("quick", 0.2), ("slow", 0.01)]
    assert [(g.run, g.t_s) for g in found.by_gap] == [("quick", 2.0), ("quick", 4.0), (None, None)]


def test_time_to_a_part_of_the_final_coverage_counts_from_nothing_covered_to_the_end():
    found = curve((1.0, 0.6), (2.0, 0.52), (5.0, 0.5))
    assert [time_to_part_s(found, part) for part in (0.8, 0.95, 0.99, 1.0)] == [1.0, 2.0, 5.0, 5.0]


def test_mean_curve_begins_when_every_seed_has_something():
    mean = mean_curve([curve((1.0, 0.4), (3.0, 0.2)), curve((2.0, 0.3), (8.0, 0.1), end_s=9.0)])
    assert [(p.t_s, round(p.value, 9)) for p in mean.points] == [(2.0, 0.35), (3.0, 0.25), (8.0, 0.15)]
    assert mean.end_s == 9.0


def test_settings_change_one_knob_at_a_time_and_none_comes_twice():
    requests = settings(BASE, Variants(n_candidates=(300, 600)), n_seeds=2)
    assert requests[0] == BASE
    assert len(set(requests)) == len(requests) == 2 * (1 + 3 + 1 + 3 + 1)
    names = [name_of(request, BASE) for request in requests[::2]]
    assert names == [
        "greedy", "pso", "noto", "orbit", "greedy f64", "greedy 15°", "greedy 10°", "greedy 5°",
        "greedy 600 candidates",
    ]  # fmt: skip
    assert {request.seed for request in requests} == {0, 1}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [({"methods": ("guess",)}, "greedy, pso"), ({"precisions": ("f16",)}, "known are: f32, f64")],
)
def test_unknown_methods_and_precisions_are_named_with_those_that_exist(arguments, message):
    with pytest.raises(InputError, match=message):
        Variants(**arguments)


@pytest.fixture(scope="module")
def runs():
    model = SCENES["roof"]()
    fine = replace(BASE, constraints=Constraints(section_step_deg=15.0))
    requests = (BASE, replace(BASE, method="orbit"), replace(BASE, method="noto"), fine)
    return tuple(run_plan(model, request, (30.0, 15.0), read_s=0.25) for request in requests)


@pytest.mark.slow
def test_run_tells_coverage_over_time_and_ends_with_the_finished_plan(runs):
    model = SCENES["roof"]()
    run = runs[0]
    plan = plan_flight(model, BASE).plan
    times = [point.t_s for point in run.points]
    counts = [point.covered for point in run.points]
    assert times == sorted(times)
    assert times[0] > 0.25
    assert counts == sorted(counts)
    assert run.points[-1].covered == plan.coverage.covered == run.counts[0].covered
    assert run.bound == plan.coverage.reachable_upper_bound
    assert run.flight_s == pytest.approx(plan.duration_s)
    space = free_space(model, 10.0)
    fine = coverage_model(model, space, plan.camera, replace(plan.constraints, section_step_deg=15.0))
    assert run.counts[1].covered == int((coverage_counts(fine, plan.viewpoints) > 0).sum())
    assert run.counts[1].total == 32 * 144


def test_run_that_cannot_be_done_says_why_and_a_cancelled_one_is_not_swallowed():
    model = SCENES["roof"]()
    failed = run_plan(model, replace(BASE, method="pso", n_views=None, share=0.5), (30.0,))
    assert isinstance(failed, FailedRun)
    assert "--views" in failed.message

    class Cancelling:
        def report(self, stage, done, total):
            raise OperationCancelled("cancelled")

    with pytest.raises(OperationCancelled):
        run_plan(model, BASE, (30.0,), monitor=Cancelling())


@pytest.mark.slow
def test_report_compares_all_runs_in_the_sections_asked_for_and_in_the_finest(runs):
    report = plan_report(runs, BASE)
    assert report.names == ("greedy", "orbit", "noto", "greedy 15°")
    assert report.steps_deg == (30.0, 15.0)
    assert report.winner in ("greedy", "greedy 15°")
    assert len(report.curves[30.0]["greedy 15°"].points) == 1
    for step, by_name in report.curves.items():
        for name, found in by_name.items():
            covered = next(c.covered for c in report.of(name)[0].counts if c.step_deg == step)
            assert found.final_gap == pytest.approx(1.0 - covered / report.bounds[step])
    rows = plan_rows(report)
    assert len(rows) == sum(len(run.points) for run in runs)
    assert sum(row["is_final"] for row in rows) == len(runs)
    assert all(0 < row["covered"] <= row["bound"] <= row["total"] for row in rows)
    summary = plan_summary(report)
    assert summary["winner"] == report.winner
    assert all(0.0 < run["share"] <= 1.0 and run["time_to_share_of_final_s"]["0.9"] for run in summary["runs"])
    assert f"roof: '{report.winner}' wins" in plan_title(report)
    panels = plan_panels(report)
    assert [panel.title for panel in panels] == [
        "roof: Which method?",
        "roof: How fine sections? (each run counts its own)",
    ]
    assert [line.name for line in panels[0].lines] == ["greedy", "orbit", "noto"]
    assert [line.name for line in panels[1].lines] == ["30°", "15°"]


@pytest.mark.long
def test_lowest_proven_bound_counts_and_never_lies_below_what_is_covered(runs):
    tighter = replace(runs[1], bound=runs[0].bound - 1)
    assert bounds_by_step([runs[0], tighter])[30.0] == max(runs[0].bound - 1, runs[0].counts[0].covered)
    impossible = replace(runs[0], bound=1)
    assert bounds_by_step([impossible])[30.0] == runs[0].counts[0].covered


def ring(n):
    angle = 2.0 * np.pi * np.arange(n) / n
    points = np.c_[np.cos(angle), np.sin(angle)]
    shuffled = points[np.random.default_rng(0).permutation(n)]
    return np.linalg.norm(shuffled[:, None] - shuffled[None], axis=2), 2.0 * n * math.sin(math.pi / n)


@pytest.mark.long
def test_methods_on_a_ring_of_points_reach_its_known_shortest_tour():
    cost, optimum = ring(40)
    case = TourCase("ring", cost, "m", 0.99 * optimum, optimum)
    report = tour_report(case, run_tours(case, 0.3))
    assert set(report.curves) == {"nearest-neighbour", "local-search", "pyvrp", "pyvrp-cold"}
    for method in ("local-search", "pyvrp"):
        assert report.curves[method].final_gap == pytest.approx(0.0, abs=1e-3)
    assert report.curves["nearest-neighbour"].final_gap >= -1e-12
    assert report.length_of("local-search") == pytest.approx(optimum)
    rows = tour_rows(report)
    assert sum(row["is_final"] for row in rows) == 4
    assert min(row["above_bound"] for row in rows) == pytest.approx(1.0 / 0.99 - 1.0, abs=1e-4)
    assert tour_summary(report)["gap_is_above"] == "optimum"
    assert "to the optimum" in tour_title(report)
    marks = dict(tour_panel(report).marks)
    assert marks["known optimum"] == pytest.approx(1.0 / 0.99 - 1.0)


def test_local_search_is_left_out_where_directions_differ():
    cost, _ = ring(12)
    case = TourCase("one-way", cost + np.triu(cost), "m", 1.0)
    runs = run_tours(case, 0.1, ("local-search", "nearest-neighbour"))
    assert [run.method for run in runs] == ["nearest-neighbour"]
    with pytest.raises(InputError, match="add the method pyvrp"):
        run_tours(case, 0.1, ("local-search",))


@pytest.mark.slow
def test_case_of_a_plan_leads_around_the_building_through_home_and_all_views():
    model = SCENES["office"]()
    plan = plan_flight(model, PlanRequest(n_views=12, time_budget_s=0.8)).plan
    case = plan_case(plan, model)
    assert case.cost.shape == (13, 13)
    assert case.is_symmetric
    assert case.unit == "s"
    length = tour_length(case.cost, np.arange(13))
    assert case.lower_bound <= min(length, run_tours(case, 0.2, ("local-search",))[0].points[-1].value)
    flown = sum(sortie.duration_s for sortie in plan.sorties) - 12 * 3.0 - 30.0
    assert case.lower_bound <= flown + 1.0
    with pytest.raises(InputError, match="two viewpoints"):
        plan_case(replace(plan, viewpoints=plan.viewpoints[:1], sorties=()), model)


def test_optimal_tour_beside_a_tsplib_file_is_the_reference(tmp_path):
    lines = ["NAME: square", "TYPE: TSP", "DIMENSION: 4", "EDGE_WEIGHT_TYPE: EUC_2D", "NODE_COORD_SECTION"]
    text = "\n".join([*lines, "1 0 0", "2 10 10", "3 10 0", "4 0 10", "EOF"])
    (tmp_path / "square.tsp").write_text(text)
    assert tsplib_case(tmp_path / "square.tsp").optimum is None
    (tmp_path / "square.opt.tour").write_text("TOUR_SECTION\n1\n3\n2\n4\n-1\nEOF")
    case = tsplib_case(tmp_path / "square.tsp")
    assert case.optimum == case.reference == 40.0
    assert case.lower_bound <= 40.0


def test_unknown_routing_method_is_named_with_those_that_exist():
    assert tour_methods(["pyvrp", "local-search"]) == ("local-search", "pyvrp")
    with pytest.raises(InputError, match="nearest-neighbour"):
        tour_methods(["ants"])


@pytest.mark.slow
def test_picture_shows_every_curve_also_with_no_gap_left_or_nothing_found(tmp_path):
    from matplotlib.image import imread

    lines = (
        Line("perfect", curve((0.5, 0.2), (2.0, 0.0))),
        Line("worse", curve((0.001, 0.9), (30.0, 0.05))),
        Line("nothing", Curve((), 1.0), "found nothing"),
    )
    for name, axis in (("plan", COVERAGE_AXIS), ("tour", TOUR_AXIS)):
        path = tmp_path / f"{name}.png"
        draw("nothing left to gain", [Panel("a", (Line("flat", curve((1.0, 0.0))),))], axis, path)
        draw("title", [Panel("a", lines, (("known optimum", 0.1),)), Panel("b", lines[:1])], axis, path)
        pixels = (imread(path)[..., :3] * 255).round().astype(int).reshape(-1, 3)
        for colour in ((0, 0x72, 0xB2), (0xD5, 0x5E, 0)):
            assert (np.abs(pixels - colour).max(axis=1) <= 2).sum() > 100


@pytest.mark.parametrize(
    ("gap", "text"), [(0.0, "100 %"), (1e-4, "99.990 %"), (1e-9, "100.000 %"), (0.041, "95.9 %"), (0.004, "99.60 %")]
)
def test_shares_are_written_so_that_nearly_all_differs_from_all(gap, text):
    assert share_text(gap) == text


def test_seconds_are_written_with_two_digits_or_more():
    assert [seconds_text(t) for t in (0.00123, 0.5, 12.34, 345.6)] == ["0.0012 s", "0.5 s", "12.3 s", "346 s"]
