"""`tradeoff`: what accuracy costs in time, as a table, a picture and answers to "I have 60 s" and "I want 99 %"."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli.commands.plan import add_request_arguments, request_of
from groundstation.cli.commands.segment import add_parameter_arguments
from groundstation.cli.console import show, show_tradeoff, table_row, tell, worded
from groundstation.cli.options import (
    PluginNames,
    above_zero,
    add_profile_argument,
    add_set_arguments,
    checked_seed,
    count,
    counts,
    effect_settings,
    in_words_of_options,
    new_folder,
    number,
    numbers,
    score_request,
    wholes,
    words,
)
from planning.base.errors import InputError
from planning.base.messages import glue, say
from planning.base.plugins import PluginGroup
from reconstruction.training.method_registry import DEFAULT_METHOD, METHODS
from reconstruction.training.parameters import PRESETS

if TYPE_CHECKING:
    from groundstation.services.plan.tradeoff import PlanRuns
    from groundstation.services.scenes.photos import SceneTrials
    from planning.tradeoff.plans import FailedRun, PlanReport, Variants
    from planning.tradeoff.runner import Answers
    from planning.tradeoff.tours import TourReport
    from reconstruction.scenes.parameters import SceneRequest
    from reconstruction.tradeoff.scene_downstream import EffectWorth
    from reconstruction.tradeoff.scene_tradeoff import SceneVariants
    from reconstruction.tradeoff.search_tradeoff import SettingScores


SCENE_EPILOG = """Every way to render is compared with the truth: the same photos by Mitsuba with every
effect and --truth-rays rays a pixel (--truth-rays 0: by the embedded renderer with 64). Rays, sizes and effects are
turned one at a time, all else as the scene decides. Panels are looked for in all of them, to see what that changes.

examples:
  tradeoff scene planar -o tradeoff
  tradeoff scene office.site.json -o tradeoff --width 1024 --widths 256,512 --rays 4,16,64 --truth-rays 1024
  tradeoff scene court -o tradeoff --truth-rays 0 --turn second-bounce,near-field-reflection
"""


LEAST_VIEWS = 8
"""That reflections are learned from, and scored on a part of."""


def _add_scene_arguments(parser: Any) -> None:
    """Describe what can be turned."""
    add = parser.add_argument
    add("scene", metavar="SITE|NAME", help="site file, or name of a bundled scene ('scene list')")
    add("--plan", type=Path, metavar="PLAN", help="take views of this plan (default: views square to each facade)")
    add("--views", type=int, metavar="N", help="number of photos (default 4)")
    add_profile_argument(parser)
    add("--look", type=Path, metavar="FILE", help="TOML file with glass, frames, surroundings and light of a site")
    add("--seed", type=int, default=0, metavar="N", help="of everything random (default 0)")
    add("--width", type=int, default=512, metavar="PX", help="of the photos (default 512)")
    add("--truth-rays", type=int, default=256, metavar="N", help="a pixel, of the truth (default 256)")
    add("--effects", action="append", default=[], metavar="SETTING", help="start: auto, none, all, NAME=on|off|auto")
    add("--tolerance", type=number, default=1.0, metavar="X", help="times each effect's own tolerance (default 1)")
    add(
        "--reflections",
        type=int,
        default=0,
        metavar="N",
        help="also learn reflections from N small photos, with all effects and without each (default 0: do not)",
    )
    varied = parser.add_argument_group("what varies (lists with commas)").add_argument
    varied(
        "--samples",
        type=counts,
        default="1,2,3,4",
        metavar="LIST",
        help="rays along a pixel's side (default: %(default)s)",
    )
    varied(
        "--widths",
        type=counts,
        default="128,256",
        metavar="LIST",
        help="rendered so wide and enlarged (default: %(default)s)",
    )
    varied(
        "--rays", type=counts, default=(), metavar="LIST", help="a pixel of Mitsuba, such as 4,16,64 (default: none)"
    )
    varied(
        "--turn",
        type=words,
        default="all",
        metavar="LIST",
        help="effects that are turned on or off (default: all; or none)",
    )


def run_scene(options: argparse.Namespace) -> int:
    """Compare and print; returns the exit status."""
    from groundstation.services.scenes.photos import scene_tradeoff

    request, variants = _scene_request(options), _scene_variants(options)
    if options.truth_rays < 0:
        raise InputError(say("expected 0 or more, got {}", options.truth_rays, place="--truth-rays"))
    if options.reflections != 0 and not options.reflections >= LEAST_VIEWS:
        raise InputError(
            say("expected {} or more photos, or 0, got {}", LEAST_VIEWS, options.reflections, place="--reflections")
        )
    return show_tradeoff(
        "scene",
        options.json,
        lambda context: scene_tradeoff(
            request, variants, options.truth_rays or None, options.out, context, n_reflection_views=options.reflections
        ),
        _scene_summary,
        _print_scene,
    )


def _scene_summary(found: SceneTrials) -> dict[str, Any]:
    from planning.base.json_file import plain_values
    from reconstruction.tradeoff.scene_downstream import worth_rows
    from reconstruction.tradeoff.scene_tradeoff import scene_rows, truth_error

    truth = found.truth
    return {
        "truth": {"name": truth.name, "seconds": truth.seconds, "error": truth_error(truth)},
        "effects": plain_values(found.decisions),
        "settings": scene_rows(truth, found.trials),
        "reflections": worth_rows(found.worths) if found.worths else [],
    }


def _scene_request(options: argparse.Namespace) -> SceneRequest:
    from reconstruction.scenes.effects.registry import effect_names
    from reconstruction.scenes.parameters import RenderSettings, SceneRequest

    settings = effect_settings(options.effects, effect_names())
    with in_words_of_options(SceneRequest):
        return SceneRequest(
            scene=options.scene,
            plan=options.plan,
            n_views=options.views,
            profile_id=options.profile,
            look=options.look,
            seed=checked_seed(options.seed),
            width_px=options.width,
            settings=RenderSettings(effects=settings, tolerance=options.tolerance),
        )


def _scene_variants(options: argparse.Namespace) -> SceneVariants:
    from reconstruction.tradeoff.scene_tradeoff import OF_A_PHOTO, SceneVariants

    turned = options.turn
    by_option = {name.lower().replace(" ", "-"): name for name in OF_A_PHOTO}
    if turned == ("all",):
        effects = OF_A_PHOTO
    elif turned == ("none",):
        effects = ()
    else:
        effects = tuple(by_option.get(word, word) for word in turned)
    return SceneVariants(options.samples, options.widths, options.rays, effects)


def _print_scene(trials: SceneTrials) -> None:
    from missions.simulator.build import effects_table
    from reconstruction.tradeoff.scene_tradeoff import scene_rows, truth_error

    own = truth_error(trials.truth)
    accuracy = say(", itself good to {:.2f} grey levels", 255.0 * own) if own else ""
    tell("truth: {}, {:.1f} s a photo{}", trials.truth.name, trials.truth.seconds, accuracy)
    tell("effects:\n{}", effects_table(trials.decisions, worded))
    heads = (say("setting"), -36), (say("ready in"), 10), (say("s a photo"), 10), ("PSNR", 10), ("mIoU", 17)
    print(table_row(*heads, (say("missed"), 17)))
    for row in scene_rows(trials.truth, trials.trials):
        ready, error = " " * 10, " " * 18
        if "psnr_db" in row:
            ready, error = f"{row['prepare_s']:>8.2f} s", f"{row['psnr_db']:>7.1f} dB{row['psnr_change_db']:>+8.2f}"
        single, change = row["individual_miou"], row["individual_miou_change"]
        found = f"{'-':>9}" if single is None else f"{single:>9.4f}{change:>+9.4f}{row['missed']:>8}"
        print(f"  {worded(row['setting']):<36}{ready}{row['seconds']:>10.3f}{error}{found}")
    if trials.worths:
        _print_worths(trials.worths)


def _print_worths(worths: Sequence[EffectWorth]) -> None:
    from reconstruction.tradeoff.scene_downstream import worth_rows

    tell("  reflections learned from photos, scored on glass of unseen views that have all that the scene calls for:")
    heads = (say("photos"), -36), (say("rendered in"), 12), ("PSNR", 10), (say("lost"), 9), (say("worst"), 10)
    print(table_row(*heads, (say("on their own kind"), 20)))
    for row in worth_rows(worths):
        print(
            f"  {worded(row['photos']):<36}{row['photos_s']:>10.1f} s{row['psnr_db']:>7.2f} dB"
            f"{row['lost_db']:>+6.2f} dB{row['worst_db']:>7.2f} dB{row['own_db']:>17.2f} dB"
        )


TRAIN_SECONDS = 60.0

DEFAULT_KNOBS = (
    "method=2dgs",
    "light=environment-map,mlp,radiance-grid",
    "n_splats=4000,24000",
    "window_px=3072,12288",
    "reduce=2",
    "reflections.precision=float32,bfloat16",
)

KNOB_LINES = "\n".join(f"  --vary {knob}" for knob in DEFAULT_KNOBS)

TRAIN_EPILOG = f"""Every training has the same time, and is scored on the views that were held out. Any setting of a
training (reconstruction/training/config.py) can be turned, inner ones with dots. Without --vary these are:
{KNOB_LINES}

examples:
  tradeoff train tower.dataset -o tradeoff --seconds 120
  tradeoff train tower.dataset -o tradeoff --vary method=2dgs --vary light=mlp,radiance-grid
  tradeoff train tower.dataset -o tradeoff --vary reflections.mlp.width=64,256 --vary raster.tile_px=8,32
"""


def _add_train_arguments(parser: Any) -> None:
    """Describe what can be turned."""
    add = parser.add_argument
    add("dataset", type=Path, metavar="DATASET", help="folder of a data set")
    add("--preset", choices=tuple(PRESETS), default="10min", help="settings to start from (default 10min)")
    add(
        "--method",
        choices=PluginNames(METHODS, PluginGroup.TRAINING_METHODS),
        metavar="METHOD",
        help=f"method to start from (default {DEFAULT_METHOD})",
    )
    add("--seconds", type=above_zero, metavar="S", help=f"of each training (default {TRAIN_SECONDS:g})")
    add("--iterations", type=count, metavar="N", help="of each training, whatever time they take, instead of --seconds")
    add("--seed", type=int, default=0, metavar="N", help="of everything random (default 0)")
    add("--settings", type=Path, metavar="FILE", help="TOML file with settings that differ from the preset's")
    add("--vary", action="append", default=[], metavar="SETTING=A,B", help="give it again for more")


def run_train(options: argparse.Namespace) -> int:
    """Compare and print; returns the exit status."""
    from groundstation.services.reconstruct.training import TrainRequest, train_tradeoff
    from reconstruction.tradeoff.train_tradeoff import trial_rows

    seconds = options.seconds or (TRAIN_SECONDS if options.iterations is None else None)
    request = TrainRequest(
        options.preset,
        options.method,
        None,
        options.iterations,
        seconds,
        checked_seed(options.seed),
        options.settings,
    )
    knobs = dict(map(knob_of, options.vary or DEFAULT_KNOBS))
    return show_tradeoff(
        "train",
        options.json,
        lambda context: train_tradeoff(options.dataset, request, knobs, options.out, context),
        lambda trials: {"settings": trial_rows(trials)},
        lambda trials: _print_trainings(trial_rows(trials)),
    )


def _print_trainings(rows: Sequence[Mapping[str, Any]]) -> None:
    heads = (say("setting"), -38), (say("time"), 9), ("facade", 11), (say("whole"), 20)
    print(table_row(*heads, (say("steps"), 8), (say("splats"), 8)))
    for row in rows:
        print(
            f"  {worded(row['setting']):<38}{row['seconds']:>7.1f} s{row['facade_psnr_db']:>8.2f} dB"
            f"{row['change_db']:>+9.2f}{row['whole_psnr_db']:>8.2f} dB{row['steps']:>8}{row['splats']:>8}"
        )


def knob_of(text: str) -> tuple[str, list[Any]]:
    """Name of a setting and its values: numbers and true or false where they read so, else words.

    Raises
    ------
    InputError
        It is not of the form NAME=A,B.
    """
    name, equals, values = text.partition("=")
    words = [word.strip() for word in values.split(",") if word.strip()]
    if not (name.strip() and equals and words):
        raise InputError(say("expected a setting and its values, such as n_splats=4000,8000", place=f"--vary {text}"))
    return name.strip(), [_value(word) for word in words]


def _value(word: str) -> Any:
    try:
        return json.loads(word)
    except json.JSONDecodeError:
        return word


WORTH_PLANNERS = "random,orbit,noto,pso,sections,image-error"

WORTH_EPILOG = """Every flight is planned, photographed over the synthetic scene, and a model is trained of its photos.
Scores are of the facades in views that no photo was taken from: random oblique ones, ones of another plan by hemisphere
sections, and those of an inspector's walk. What is finished stays in the folder, and the same call goes on with it.

examples:
  tradeoff worth planar -o tradeoff
  tradeoff worth court -o tradeoff --planners random,sections,image-error --views 100 --lights splats --seconds 300
  tradeoff worth office.site.json -o tradeoff --flown planned,rtk-fixed,single --seeds 1
"""

ROUTE_SECONDS = 30.0

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
    _add_worth(kinds)


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
    add("--seconds", type=above_zero, default=ROUTE_SECONDS, metavar="S", help="for each method (default %(default)g)")
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
        "--views",
        type=counts,
        default=(),
        metavar="LIST",
        help="photos searched together, such as 1,3,5; synthetic sets",
    )
    varied(
        "--rectified-by",
        type=words,
        default=(),
        metavar="LIST",
        help="such as exact,tangent,polynomial (default: none); synthetic sets",
    )


def _add_scene(kinds: Any) -> None:
    parser = kinds.add_parser(
        "scene",
        help="accuracy against time of rendered photos",
        description="Render photos of a scene with more and fewer rays, sizes and effects, and by a physically based\n"
        "renderer; write tradeoff-scene.csv and tradeoff-scene.png.",
        epilog=SCENE_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run_scene)
    _add_output(parser)
    _add_scene_arguments(parser)


def _add_train(kinds: Any) -> None:
    parser = kinds.add_parser(
        "train",
        help="quality against time of trained models",
        description="Train models of the same photos with settings turned one at a time; write tradeoff-train.csv\n"
        "and tradeoff-train.png.",
        epilog=TRAIN_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run_train)
    _add_output(parser)
    _add_train_arguments(parser)


def _add_output(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("-o", "--out", type=new_folder, required=True, metavar="DIR", help="folder to write into")
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of text")


def run_plan(options: argparse.Namespace) -> int:
    """Compare planning settings and print; returns the exit status."""
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
        tell("note: the runs shared the machine, so their times cannot be compared", file=sys.stderr)
    for report in found.reports:
        _print_plan(report)
    for run in found.failed:
        tell("warning: {}, {}: {}", run.site, _failed_name(run), run.message, file=sys.stderr)


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
    step_deg = request.constraints.section_step_deg
    return say("{} {} {:g}° seed {}", request.method, request.precision, step_deg, request.seed)


def _print_plan(report: PlanReport) -> None:
    from planning.tradeoff.plans import plan_title, share_text, time_to_part_s
    from planning.tradeoff.runner import seconds_text

    step = report.base_step_deg
    show(plan_title(report))
    tell("  at most {} of {} sections of {:g}° can be covered", report.bounds[step], report.runs[0].total, step)
    finest = report.steps_deg[-1]
    in_finest = "" if finest == step else say("in {:g}°", finest)
    heads = (say("run"), -24), ("views", 6), (say("covered"), 10), (in_finest, 9), (say("first"), 9)
    print(table_row(*heads, (say("best"), 9), (say("plan ready"), 12)))
    for name in report.names:
        curve, run = report.curves[step][name], report.of(name)[0]
        in_finest = "" if finest == step else share_text(report.curves[finest][name].final_gap)
        first_s, best_s = curve.points[0].t_s, curve.points[-1].t_s
        print(
            f"  {worded(name):<24}{run.n_views:>6}{share_text(curve.final_gap):>10}{in_finest:>9}"
            f"{first_s:>7.2f} s{best_s:>7.2f} s{curve.end_s:>10.1f} s"
        )
    last_s = max(curve.end_s for curve in report.curves[step].values())
    _print_answers(
        report.answers[step],
        share_text,
        lambda gap: say("{:g} % of what can be covered in sections of {:g}°", 100.0 * (1.0 - gap), step),
        last_s,
    )
    gaps = [answer.gap for answer in report.answers[step].by_gap]
    parts = " / ".join(f"{100.0 * (1.0 - gap):g}" for gap in gaps)
    winner = report.curves[step][report.winner]
    times = " / ".join(seconds_text(time_to_part_s(winner, 1.0 - gap)) for gap in gaps)
    tell("  '{}' had {} % of its own final coverage after {}", report.winner, parts, times)
    if finest != step:
        tell("  best in sections of {:g}°: '{}'", finest, report.answers[finest].winner)


def _print_answers(found: Answers, text: Callable[[float], str], goal: Callable[[float], str], last_s: float) -> None:
    """What each budget gives, up to the first at which all runs are over, and when each goal was reached."""
    from planning.tradeoff.runner import seconds_text

    for budget in found.by_budget:
        reached = say("nothing yet") if budget.gap is None else say("{} with '{}'", text(budget.gap), budget.run)
        tell("  after {:>2g} s: {}", budget.budget_s, reached)
        if budget.budget_s >= last_s:
            break
    for wanted in found.by_gap:
        t_s = wanted.t_s
        reached = say("not reached") if t_s is None else say("after {} with '{}'", seconds_text(t_s), wanted.run)
        show(glue("  ", goal(wanted.gap), ": ", reached))


def run_route(options: argparse.Namespace) -> int:
    """Compare routing methods and print; returns the exit status."""
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
    optimum = "" if case.optimum is None else say(", known optimum {}", plain(case.optimum))
    show(tour_title(report))
    tell("  {} points, nothing is shorter than {}{}", report.n_points, plain(case.lower_bound), optimum)
    for method, curve in report.curves.items():
        if curve.points:
            length, best_s = plain(report.length_of(method)), curve.points[-1].t_s
            tell("  {:<18}{:>12}{:>10}  best after {}", method, length, gap_text(curve.final_gap), seconds_text(best_s))
        else:
            tell("  {:<18}  found no tour", method)
    reference = say("lower bound") if case.optimum is None else say("optimum")
    last_s = max(curve.end_s for curve in report.curves.values())
    _print_answers(report.answers, gap_text, lambda gap: say("within {:g} % of the {}", 100.0 * gap, reference), last_s)


def run_segment(options: argparse.Namespace) -> int:
    """Compare settings of the search for panels and print; returns the exit status."""
    from groundstation.services.photos.segmentation import segment_tradeoff
    from reconstruction.tradeoff.search_tradeoff import SegmentVariants, variant_rows

    try:
        variants = SegmentVariants(
            options.sizes, options.samples, options.detectors, options.views, options.rectified_by
        )
    except ValueError as error:
        raise InputError(str(error)) from error
    request = score_request(
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
    tell("{} panels in {} photos", runs[0].scores.n_panels, rows[0]["photos"])
    heads = (say("setting"), -24), (say("s a photo"), 10), ("mIoU", 9), (say("worst"), 9), (say("missed"), 8)
    print(table_row(*heads))
    for row in rows:
        single, worst = row["individual_miou"], row["individual_miou_worst"]
        off_px = row["view_error_px"]
        off = "" if off_px is None else say("  off by up to {:.2f} px in the photo", off_px)
        numbers = f"{row['seconds']:>10.3f}{single:>9.4f}{worst:>9.4f}{row['missed']:>8}"
        show(glue(table_row((row["setting"], -24)), numbers, off))


def _add_worth(kinds: Any) -> None:
    parser = kinds.add_parser(
        "worth",
        help="quality of the model against minutes in the air",
        description="Fly plans of several planners over a synthetic scene, train a model of the photos of each, and\n"
        "score it on unseen views; write worth.csv, worth-mean.csv and worth.png.",
        epilog=WORTH_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run_worth)
    add = parser.add_argument
    add("scene", metavar="SITE|NAME", help="site file, or name of a bundled scene ('scene list')")
    _add_output(parser)
    add_profile_argument(parser)
    add("--look", type=Path, metavar="FILE", help="TOML file with glass, frames, surroundings and light of a site")
    add("--width", type=count, default=128, metavar="PX", help="of the photos (default %(default)s)")
    add("--unseen", type=count, default=40, metavar="N", help="views of each kind that models are scored on")
    add("--seconds", type=above_zero, default=120.0, metavar="S", help="of processor time for joint splats")
    add("--seeds", type=count, default=3, metavar="N", help="runs of each flight (default %(default)s)")
    varied = parser.add_argument_group("what varies (lists with commas)").add_argument
    varied("--planners", type=words, default=WORTH_PLANNERS, metavar="LIST", help="default: %(default)s")
    varied("--views", type=counts, default="50,100,200", metavar="LIST", help="numbers of them (default: %(default)s)")
    varied("--lights", type=words, default="radiance-grid,mlp", metavar="LIST", help="default: %(default)s; or splats")
    varied("--flown", type=words, default="planned", metavar="LIST", help="planned, rtk-fixed, single")
    where = parser.add_argument_group("where").add_argument
    where("--jobs", type=count, default=1, metavar="N", help="flights at a time (default 1)")
    where("--cluster", metavar="ADDRESS", help="run on a Dask cluster that shares the folder")


def run_worth(options: argparse.Namespace) -> int:
    """Compare flights and print; returns the exit status."""
    from groundstation.services.worth import WorthRequest, summary_rows, worth_tradeoff

    with in_words_of_options(WorthRequest):
        request = WorthRequest(
            options.scene,
            options.planners,
            options.views,
            options.lights,
            options.flown,
            n_seeds=options.seeds,
            n_unseen=options.unseen,
            width_px=options.width,
            seconds=options.seconds,
            look=options.look,
            profile_id=options.profile,
        )
    return show_tradeoff(
        "worth",
        options.json,
        lambda context: worth_tradeoff(
            request, options.out, n_processes=options.jobs, address=options.cluster, monitor=context
        ),
        lambda results: {"flights": summary_rows(results)},
        lambda results: _print_flights(summary_rows(results)),
    )


def _print_flights(rows: Sequence[Mapping[str, Any]]) -> None:
    heads = (say("light"), -16), (say("flown"), -11), (say("photos"), 7), ("  " + say("planned by"), -14)
    print(table_row(*heads, (say("in the air"), 11), (say("unseen views"), 14), (say("spread"), 9)))
    for row in rows:
        spread = "" if row["spread_db"] == "" else f"{row['spread_db']:>9.2f}"
        print(
            f"  {row['light']:<16}{row['flown']:<11}{row['views']:>7}  {row['planner']:<12}"
            f"{row['minutes']:>7.1f} min{row['mean_db']:>11.2f} dB{spread}"
        )
