"""`plan`: a site to a plan."""

from __future__ import annotations

import argparse
import math
import sys
import time
from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli.console import counted, print_findings, print_json, print_next, run_job, show, tell
from groundstation.cli.options import (
    add_parameter,
    add_profile_argument,
    add_time,
    in_words_of_options,
    json_file,
    number,
    planned_time,
    typed_values,
)
from planning.base.errors import InputError
from planning.base.messages import glue, joined, say
from planning.base.parameters import declared, with_values
from planning.parameters import CAMERA, FLIGHT, GOAL, HOW, METHOD_NAMES, WHICH, PlanParameters

if TYPE_CHECKING:
    from planning.planner import Planned
    from planning.request import PlanRequest

EPILOG = """how much is wanted (one of):
  none              as many views as would cover 0.99 of the sections, placed for the model's pictures
  --views N         so many views
  --good-enough DB  batteries until another would make the model's pictures less than so much better
  --batteries N     as much as possible within so many sorties
  --coverage SHARE  so much of what can be covered, by the paper's sections, with as few views as possible

examples:
  plan office.site.json -o office.plan.json
  plan office.site.json -o office.plan.json --views 560 --time-budget 20
  plan tower.site.json -o tower.plan.json --batteries 2 --profile m4e --wind 6
  plan office.site.json -o new.plan.json --views 560 --keep office.plan.json
"""

STAGES = {
    "reachability": say("reachability"),
    "views": "views",
    "routing": say("routing"),
    "certificate": say("certificate"),
}
"""Of planning, by the names of their times in JSON."""

GOALS = ("n_views", "share", "n_batteries", "least_gain_db")
"""At most one of them is asked for."""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "plan",
        help="plan the second flight over a site",
        description="Choose viewpoints that see every panel from as many directions as the site allows,\n"
        "share them out among sorties, and prove how much more could be seen at all.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    add = parser.add_argument
    add("site", type=Path, metavar="SITE", help="site file")
    add("-o", "--out", type=json_file, required=True, metavar="PLAN", help="plan file to write")
    add("--json", action="store_true", help="print one JSON object instead of text")
    add("--keep", type=Path, metavar="PLAN", help="keep the locked viewpoints of this plan (method greedy only)")
    add_time(parser)
    add_request_arguments(parser)


def add_request_arguments(parser: argparse.ArgumentParser) -> None:
    """What is wanted of a plan; shared with other commands that plan."""
    groups = {title: parser.add_argument_group(title) for title in (GOAL, HOW, WHICH, FLIGHT, CAMERA)}
    one_of = groups[GOAL].add_mutually_exclusive_group()
    for name, each in declared(PlanParameters).items():
        if name == "profile_id":
            add_profile_argument(groups[FLIGHT], has_default=False)
        elif each.parameter.option:
            add_parameter(one_of if name in GOALS else groups[each.parameter.group], each)
    groups[WHICH].add_argument(
        "--max-gsd", type=number, metavar="MM", help="views with larger pixels on the panel do not count at all"
    )
    groups[HOW].add_argument(
        "--settings",
        type=Path,
        metavar="FILE",
        help="TOML file with any setting of docs/reference/settings.md",
    )


def request_of(options: argparse.Namespace) -> PlanRequest:
    """What the options ask for: what was typed, else the settings file's, else the default.

    Raises
    ------
    InputError
        A value is out of range, or the settings file cannot be used.
    """
    from planning.base.json_file import read_toml, settings_over
    from planning.request import PlanRequest

    base = PlanParameters()
    if options.settings is not None:
        base = settings_over(base, read_toml(options.settings, dict[str, Any]), options.settings)
        if base.method not in METHOD_NAMES:
            known, place = ", ".join(METHOD_NAMES), f"{options.settings}: method"
            raise InputError.say("there is no planning method '{}'; known are: {}", base.method, known, place=place)
    typed = typed_values(options, PlanParameters)
    if any((name,) in typed for name in GOALS):
        base = replace(base, n_views=None, share=None, n_batteries=None, least_gain_db=None)
    with in_words_of_options(PlanParameters):
        parameters = with_values(base, typed)
        if parameters.share is not None and typed.get(("greedy", "objective")) == "image-error":
            raise InputError.say(
                "a share of what can be covered is planned by sections; give --good-enough, --batteries or --views",
                place="--objective",
            )
        if options.max_gsd is not None:
            constraints = replace(parameters.constraints, max_distance_m=_max_distance_m(parameters, options.max_gsd))
            parameters = replace(parameters, constraints=constraints)
        return PlanRequest(**{each.name: getattr(parameters, each.name) for each in fields(PlanParameters)})


def _max_distance_m(parameters: PlanParameters, max_gsd_mm: float) -> float:
    """The nearer of the largest distance and that at which a pixel size is reached."""
    from planning.aircraft.catalogue import profile

    if not max_gsd_mm > 0.0:
        raise InputError(say("expected a positive number of millimetres, got {:g}", max_gsd_mm, place="--max-gsd"))
    by_gsd_m = profile(parameters.profile_id).camera.distance_for_gsd_m(max_gsd_mm / 1000.0)
    min_m, max_m = parameters.constraints.min_distance_m, parameters.constraints.max_distance_m
    if not by_gsd_m > min_m:
        raise InputError(
            say(
                "this camera has pixels of {:g} mm at {:.2f} m, but the minimum distance is {:g} m; allow larger "
                "pixels or lower --min-distance",
                max_gsd_mm,
                by_gsd_m,
                min_m,
                place="--max-gsd",
            )
        )
    return by_gsd_m if max_m is None else min(max_m, by_gsd_m)


def run(options: argparse.Namespace) -> int:
    """Plan and write; returns the exit status."""
    started = time.perf_counter()  # Loading what planning needs is part of the time budget.
    from groundstation.services.plan.planning import locked_viewpoints, plan_site, planned_summary
    from planning.base.json_file import is_device
    from planning.proof.make import proof_path

    request, at = request_of(options), planned_time(options)
    if options.keep is not None:
        with in_words_of_options():
            request = replace(request, locked=locked_viewpoints(options.keep))
    planned = run_job(
        "plan",
        lambda context: plan_site(
            options.site,
            request,
            options.out,
            at=at,
            started_s=started,
            stop=context.stop,
            trace=context.trace,
            monitor=context,
        ),
    )
    seconds = time.perf_counter() - started
    if options.json:
        print_json(planned_summary(planned, seconds))
    else:
        print_summary(planned, options.out, seconds)
        if not is_device(options.out):
            tell("its proof for an independent check: {}", proof_path(options.out).name)
        print_findings(planned.findings)
        print_next("check", options.out, options.site)
    return 0


def print_summary(planned: Planned, out: Path, seconds: float) -> None:
    """What a pilot wants to know, in a few lines on stdout."""
    from groundstation.services.units import minutes_text, per_cent
    from planning.coverage.sections import SectionGrid
    from planning.insight.flight_profile import LOW_M, lowest_flight
    from planning.site.ground import ground_of

    plan, coverage = planned.plan, planned.plan.coverage
    n_directions = SectionGrid(plan.constraints.section_step_deg).n_sections
    share = per_cent(coverage.covered, coverage.reachable_upper_bound, 2)
    tell(
        "{} in {}, {:.1f} min in the air",
        counted(len(plan.viewpoints), "view"),
        counted(len(plan.sorties), "sortie"),
        plan.duration_s / 60,
        place=out,
    )
    if plan.landed_s is not None:
        n_flying = len({sortie.aircraft for sortie in plan.sorties})
        tell(
            "{} aircraft at once, all landed after {:.1f} min; they keep {:g} m apart, early or late",
            n_flying,
            plan.landed_s / 60,
            plan.rules.apart_m,
        )
        if n_flying < plan.rules.at_once:
            tell("more aircraft would not land earlier, so far apart; --apart lets them fly nearer")
    tell(
        "seen: {} of {} directions of view ({} for each of {})",
        coverage.covered,
        coverage.total,
        n_directions,
        counted(coverage.total // n_directions, "panel"),
    )
    tell(
        "no flight can cover more than {}, so this is {:.2f} % of what is possible",
        coverage.reachable_upper_bound,
        share,
    )
    if plan.worth is not None:
        tell("pictures of a model of its photos from new places, expected PSNR: {}", plan.worth.text)
    if planned.most_psnr_db is not None:
        tell(
            "no choice as large from the viewpoints compared is expected to bring more than {:.1f} dB",
            planned.most_psnr_db,
        )
    wanted_mm = plan.constraints.wanted_gsd_mm
    if coverage.sharp is not None and wanted_mm:
        tell(
            "{} of these with pixels up to {:.1f} mm on the panel, the coarsest with {:.1f} mm",
            coverage.sharp,
            wanted_mm,
            coverage.coarsest_gsd_mm,
        )
    bound = planned.bound_for_views
    if bound is not None and coverage.covered < bound < coverage.reachable_upper_bound:
        tell("no choice of as many viewpoints from those compared covers more than {}", math.floor(bound))
    twice = next((count for count in planned.depth if count.n_views == 2), None)
    if twice is not None:
        tell("seen at least twice: {} sections", twice.covered)
    for position, sortie in enumerate(plan.sorties, 1):
        what = counted(len(sortie.viewpoint_ids), "view"), sortie.length_m, sortie.duration_s / 60
        if sortie.start_s is None:
            tell("  sortie {}: {}, {:.0f} m, {:.1f} min", position, *what)
            continue
        starts = sortie.aircraft, minutes_text(sortie.start_s)
        tell("  sortie {}: {}, {:.0f} m, {:.1f} min, aircraft {} starts at {}", position, *what, *starts)
    site = planned.prepared.site_model.site
    low = lowest_flight(plan, site.home_enu_m, ground_of(site))
    if low is not None:
        below = "" if low.below_s is None else say(", {:.1f} min below {:g} m", low.below_s / 60, LOW_M)
        tell("lowest flight {:.1f} m above the ground{} (take-off and landing apart)", low.lowest_m, below)
    for decision in plan.effects:
        show(str(decision))
    stages = joined(
        ", ", (glue(STAGES.get(stage, stage), f" {value:.1f} s") for stage, value in planned.seconds.items())
    )
    tell("planned in {:.1f} s ({})", seconds, stages, file=sys.stderr)
