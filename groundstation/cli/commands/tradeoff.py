"""`tradeoff`: what accuracy costs in time, as a table, a picture and answers to "I have 60 s" and "I want 99 %"."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli import tradeoff_scene, tradeoff_train
from groundstation.cli.commands.plan import add_request_arguments, request_of
from groundstation.cli.commands.score import add_set_arguments
from groundstation.cli.commands.score import request_of as score_request_of
from groundstation.cli.commands.segment import add_parameter_arguments
from groundstation.cli.lists import above_zero, count, counts, numbers, wholes, words
from groundstation.cli.options import checked_seed, new_folder
from planning.base.errors import InputError
from planning.base.messages import say

if TYPE_CHECKING:
    from groundstation.services.plan.tradeoff import PlanRuns
    from planning.tradeoff.plans import FailedRun, PlanReport, Variants
    from planning.tradeoff.runner import Answers
    from planning.tradeoff.tours import TourReport
    from reconstruction.tradeoff.search_tradeoff import SettingScores

DEFAULT_SECONDS = 30.0

PLAN_EPILOG = """what varies, one at a time, all else as the other options say:
  --methods, --precisions, --steps, --candidates
Every run gets the same number of views: 560, unless --views, --coverage or --batteries says something else.

The winner has the best final coverage of the sections asked for (--step), counted in float64. Runs that leave at most
6 % more uncovered than the best are equal, because seeds scatter by that, and the first to get there wins. The final
views of every run are also counted in the finest sections of any run: does planning with finer sections pay?

Time starts when the site is read. Runs that are timed must not disturb each other, so they follow each other
(--jobs 1). With more jobs or a cluster the coverage reached counts, not the times.

examples:
  tradeoff plan office.site.json -o tradeoff --time-budget 30
  tradeoff plan office.site.json -o tradeoff --views 56 --methods greedy,pso --precisions f32 --steps 30 --seeds 3
  tradeoff plan court.site.json canyon.site.json -o tradeoff --seeds 10 --jobs 8
"""

ROUTE_EPILOG = """examples:
  tradeoff route kroA100.tsp pcb442.tsp -o tradeoff --seconds 10
  tradeoff route office.plan.json office.site.json -o tradeoff
"""


SEGMENT_EPILOG = """Sets of photos are those of 'score segmentation'. --width should be that of your photos: sizes
above it change nothing. Rows are compared only with the paper's posterior (use_posterior), so --samples
turns it on.

examples:
  tradeoff segment -o tradeoff --seeds 5 --width 5280 --sizes 800,1600,2400,5280
  tradeoff segment -o tradeoff --set made-curved --seeds 20 --sizes 800,1600 --detectors gradient,hough
  tradeoff segment -o tradeoff --set made-curved --views 1,3,5 --rectified-by exact,tangent,polynomial
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command and what it compares."""
    parser = subparsers.add_parser(
        "tradeoff",
        help="see what accuracy costs in time",
        description="Run methods and settings side by side and write quality against time as a CSV and a picture.",
    )
    kinds = parser.add_subparsers(title="what to compare", metavar="WHAT", required=True)
    _add_plan(kinds)
    _add_route(kinds)
    _add_segment(kinds)
    _add_scene(kinds)
    _add_train(kinds)


def _add_plan(kinds: Any) -> None:
    parser = kinds.add_parser(
        "plan",
        help="coverage against time of the planner",
        description="Plan the same site with every method, precision, section step and number of candidates;\n"
        "write tradeoff-plan.csv and tradeoff-plan.png.",
        epilog=PLAN_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        conflict_handler="resolve",
    )
    parser.set_defaults(run=run_plan)
    add = parser.add_argument
    add("site", type=Path, nargs="+", metavar="SITE", help="site file")
    _add_output(parser)
    add_request_arguments(parser)
    varied = parser.add_argument_group("what varies (lists with commas)").add_argument
    varied("--methods", type=words, default="greedy,pso,noto,orbit", metavar="LIST", help="default: %(default)s")
    varied("--precisions", type=words, default="f32,f64", metavar="LIST", help="default: %(default)s")
    varied("--steps", type=numbers, default="30,15,10,5", metavar="LIST", help="degrees (default: %(default)s)")
    varied("--candidates", type=counts, default="2000,5000,20000", metavar="LIST", help="default: %(default)s")
    varied("--seeds", type=count, default=1, metavar="N", help="runs of each setting, from --seed on (default 1)")
    where = parser.add_argument_group("where").add_argument
    where("--jobs", type=count, default=1, metavar="N", help="runs at a time; 1 (default) is needed to compare times")
    where("--cluster", metavar="ADDRESS", help="run on a Dask cluster, such as tcp://10.0.0.5:8786")


def _add_route(kinds: Any) -> None:
    parser = kinds.add_parser(
        "route",
        help="tour length against time of the routing methods",
        description="Run every routing method on the tours of TSPLIB files and of plans, beside the proven lower\n"
        "bound and the known optimum; write tradeoff-route.csv and tradeoff-route.png.\n"
        "A plan needs its site: name it, or keep it beside the plan.",
        epilog=ROUTE_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run_route)
    add = parser.add_argument
    add("file", type=Path, nargs="+", metavar="FILE", help="TSPLIB file (.tsp, .atsp), plan or site")
    _add_output(parser)
    add(
        "--seconds", type=above_zero, default=DEFAULT_SECONDS, metavar="S", help="for each method (default %(default)g)"
    )
    methods = "nearest-neighbour,local-search,pyvrp,pyvrp-cold"
    add("--methods", type=words, default=methods, metavar="LIST", help="default: %(default)s")
    add("--seed", type=int, default=0, metavar="N", help="of everything random (default 0)")


def _add_segment(kinds: Any) -> None:
    parser = kinds.add_parser(
        "segment",
        help="accuracy against time of the search for glass panels",
        description="Turn the knobs of the search for glass panels one at a time on photos with truth, such as made\n"
        "facades; write tradeoff-segment.csv and tradeoff-segment.png.",
        epilog=SEGMENT_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        conflict_handler="resolve",
    )
    parser.set_defaults(run=run_segment)
    _add_output(parser)
    add_set_arguments(parser)
    add_parameter_arguments(parser)
    varied = parser.add_argument_group("what varies (lists with commas)").add_argument
    varied("--sizes", type=counts, default="400,800,1200,1600", metavar="LIST", help="default: %(default)s")
    varied(
        "--samples",
        type=wholes,
        default="32,128,512,0",
        metavar="LIST",
        help="pixels of a row that are compared, with use_posterior on; 0: all (default: %(default)s)",
    )
    varied("--detectors", type=words, default=(), metavar="LIST", help="such as gradient,hough,lsd (default: none)")
    varied(
        "--views", type=counts, default=(), metavar="LIST", help="photos searched together, such as 1,3,5; made sets"
    )
    varied(
        "--rectified-by",
        type=words,
        default=(),
        metavar="LIST",
        help="such as exact,tangent,polynomial (default: none); made sets",
    )


def _add_scene(kinds: Any) -> None:
    parser = kinds.add_parser(
        "scene",
        help="accuracy against time of rendered photos",
        description="Render photos of a scene with more and fewer rays, sizes and effects, and by a physically based\n"
        "renderer; write tradeoff-scene.csv and tradeoff-scene.png.",
        epilog=tradeoff_scene.EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=tradeoff_scene.run_scene)
    _add_output(parser)
    tradeoff_scene.add_arguments(parser)


def _add_train(kinds: Any) -> None:
    parser = kinds.add_parser(
        "train",
        help="quality against time of trained models",
        description="Train models of the same photos with settings turned one at a time; write tradeoff-train.csv\n"
        "and tradeoff-train.png.",
        epilog=tradeoff_train.EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=tradeoff_train.run_train)
    _add_output(parser)
    tradeoff_train.add_arguments(parser)


def _add_output(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("-o", "--out", type=new_folder, required=True, metavar="DIR", help="folder to write into")
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of text")


def run_plan(options: argparse.Namespace) -> int:
    """Compare planning settings and print; returns the exit status."""
    from groundstation.cli.console import show_tradeoff
    from groundstation.services.plan.tradeoff import plan_tradeoff
    from planning.tradeoff.plans import plan_summary

    variants = _variants(options)
    base = request_of(
        argparse.Namespace(**{name: value for name, value in vars(options).items() if name != "candidates"})
    )
    return show_tradeoff(
        "plan",
        options.json,
        lambda context: plan_tradeoff(
            options.site,
            base,
            variants,
            options.out,
            n_seeds=options.seeds,
            n_processes=options.jobs,
            address=options.cluster,
            monitor=context,
        ),
        lambda found: {
            "sites": [plan_summary(report) for report in found.reports],
            "failed": [{"site": run.site, "run": _failed_name(run), "reason": run.message} for run in found.failed],
        },
        lambda found: _print_plans(found, is_timed=options.jobs == 1 and not options.cluster),
    )


def _print_plans(found: PlanRuns, is_timed: bool) -> None:
    if not is_timed:
        print("note: the runs shared the machine, so their times cannot be compared", file=sys.stderr)
    for report in found.reports:
        _print_plan(report)
    for run in found.failed:
        print(f"warning: {run.site}, {_failed_name(run)}: {run.message}", file=sys.stderr)


def _variants(options: argparse.Namespace) -> Variants:
    from planning.parameters import check_section_step
    from planning.tradeoff.plans import Variants

    try:
        for step in options.steps:
            check_section_step(step)
        return Variants(options.methods, options.precisions, options.steps, options.candidates)
    except ValueError as error:
        raise InputError(str(error)) from error


def _failed_name(run: FailedRun) -> str:
    request = run.request
    return f"{request.method} {request.precision} {request.constraints.section_step_deg:g}° seed {request.seed}"


def _print_plan(report: PlanReport) -> None:
    from planning.tradeoff.plans import plan_title, share_text, time_to_part_s
    from planning.tradeoff.runner import seconds_text

    step = report.base_step_deg
    print(plan_title(report))
    print(f"  at most {report.bounds[step]} of {report.runs[0].total} sections of {step:g}° can be covered")
    finest = report.steps_deg[-1]
    in_finest = "" if finest == step else f"in {finest:g}°"
    print(f"  {'run':<24}{'views':>6}{'covered':>10}{in_finest:>9}{'first':>9}{'best':>9}{'plan ready':>12}")
    for name in report.names:
        curve, run = report.curves[step][name], report.of(name)[0]
        in_finest = "" if finest == step else share_text(report.curves[finest][name].final_gap)
        first_s, best_s = curve.points[0].t_s, curve.points[-1].t_s
        print(
            f"  {name:<24}{run.n_views:>6}{share_text(curve.final_gap):>10}{in_finest:>9}"
            f"{first_s:>7.2f} s{best_s:>7.2f} s{curve.end_s:>10.1f} s"
        )
    last_s = max(curve.end_s for curve in report.curves[step].values())
    goal = f"of what can be covered in sections of {step:g}°"
    _print_answers(report.answers[step], share_text, lambda gap: f"{100.0 * (1.0 - gap):g} % {goal}", last_s)
    gaps = [answer.gap for answer in report.answers[step].by_gap]
    parts = " / ".join(f"{100.0 * (1.0 - gap):g}" for gap in gaps)
    winner = report.curves[step][report.winner]
    times = " / ".join(seconds_text(time_to_part_s(winner, 1.0 - gap)) for gap in gaps)
    print(f"  '{report.winner}' had {parts} % of its own final coverage after {times}")
    if finest != step:
        print(f"  best in sections of {finest:g}°: '{report.answers[finest].winner}'")


def _print_answers(found: Answers, text: Callable[[float], str], goal: Callable[[float], str], last_s: float) -> None:
    """What each budget gives, up to the first at which all runs are over, and when each goal was reached."""
    from planning.tradeoff.runner import seconds_text

    for budget in found.by_budget:
        reached = "nothing yet" if budget.gap is None else f"{text(budget.gap)} with '{budget.run}'"
        print(f"  after {budget.budget_s:>2g} s: {reached}")
        if budget.budget_s >= last_s:
            break
    for wanted in found.by_gap:
        reached = say("not reached") if wanted.t_s is None else f"after {seconds_text(wanted.t_s)} with '{wanted.run}'"
        print(f"  {goal(wanted.gap)}: {reached}")


def run_route(options: argparse.Namespace) -> int:
    """Compare routing methods and print; returns the exit status."""
    from groundstation.cli.console import show_tradeoff
    from groundstation.services.plan.tradeoff import route_tradeoff
    from planning.tradeoff.tours import tour_methods, tour_summary

    methods, seed = tour_methods(options.methods), checked_seed(options.seed)
    return show_tradeoff(
        "route",
        options.json,
        lambda context: route_tradeoff(
            options.file, options.seconds, options.out, methods=methods, seed=seed, monitor=context
        ),
        lambda reports: {"tours": [tour_summary(report) for report in reports]},
        _print_tours,
    )


def _print_tours(reports: Sequence[TourReport]) -> None:
    for report in reports:
        _print_tour(report)


def _print_tour(report: TourReport) -> None:
    from planning.tradeoff.runner import seconds_text
    from planning.tradeoff.tours import gap_text, plain, tour_title

    case = report.case
    optimum = "" if case.optimum is None else f", known optimum {plain(case.optimum)}"
    print(tour_title(report))
    print(f"  {report.n_points} points, nothing is shorter than {plain(case.lower_bound)}{optimum}")
    for method, curve in report.curves.items():
        if curve.points:
            length, best_s = plain(report.length_of(method)), curve.points[-1].t_s
            print(f"  {method:<18}{length:>12}{gap_text(curve.final_gap):>10}  best after {seconds_text(best_s)}")
        else:
            print(f"  {method:<18}  found no tour")
    reference = say("lower bound") if case.optimum is None else "optimum"
    last_s = max(curve.end_s for curve in report.curves.values())
    _print_answers(report.answers, gap_text, lambda gap: f"within {100.0 * gap:g} % of the {reference}", last_s)


def run_segment(options: argparse.Namespace) -> int:
    """Compare settings of the search for panels and print; returns the exit status."""
    from groundstation.cli.console import show_tradeoff
    from groundstation.services.photos.segmentation import segment_tradeoff
    from reconstruction.tradeoff.search_tradeoff import SegmentVariants, variant_rows

    try:
        variants = SegmentVariants(
            options.sizes, options.samples, options.detectors, options.views, options.rectified_by
        )
    except ValueError as error:
        raise InputError(str(error)) from error
    request = score_request_of(
        argparse.Namespace(**{name: each for name, each in vars(options).items() if name != "samples"})
    )
    return show_tradeoff(
        "segment",
        options.json,
        lambda context: segment_tradeoff(request, variants, options.out, context),
        lambda runs: {"settings": variant_rows(runs)},
        _print_searches,
    )


def _print_searches(runs: Sequence[SettingScores]) -> None:
    from reconstruction.tradeoff.search_tradeoff import variant_rows

    rows = variant_rows(runs)
    print(f"{runs[0].scores.n_panels} panels in {rows[0]['photos']} photos")
    print(f"  {'setting':<24}{'s a photo':>10}{'mIoU':>9}{'worst':>9}{'missed':>8}")
    for row in rows:
        single, worst = row["individual_miou"], row["individual_miou_worst"]
        off = "" if row["view_error_px"] is None else f"  off by up to {row['view_error_px']:.2f} px in the photo"
        print(f"  {row['setting']:<24}{row['seconds']:>10.3f}{single:>9.4f}{worst:>9.4f}{row['missed']:>8}{off}")
