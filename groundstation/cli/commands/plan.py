"""`plan`: a site to a plan."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from planning.errors import InputError

if TYPE_CHECKING:
    from planning.planner import Planned, PlanRequest

EPILOG = """how much is wanted (one of):
  --views N         so many views
  --coverage SHARE  so much of what can be covered, with as few views as possible (default: 0.99)
  --batteries N     as much as possible within so many sorties

examples:
  plan office.site.json -o office.plan.json
  plan office.site.json -o office.plan.json --views 560 --time-budget 20
  plan tower.site.json -o tower.plan.json --batteries 2 --profile m4e --wind 6
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "plan",
        help="plan the second flight over a site",
        description="Choose viewpoints that see every panel from as many directions as the site allows, share them "
        "out among sorties, and prove how much more could be seen at all.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    add = parser.add_argument
    add("site", type=Path, metavar="SITE", help="site file")
    add("-o", "--out", type=Path, required=True, metavar="PLAN", help="plan file to write")
    add("--json", action="store_true", help="print one JSON object instead of text")
    add_request_arguments(parser)


def add_request_arguments(parser: argparse.ArgumentParser) -> None:
    """What is wanted of a plan; shared with other commands that plan."""
    goal = parser.add_argument_group("how much").add_argument
    goal("--views", type=int, metavar="N", help="number of views")
    goal("--coverage", type=float, metavar="SHARE", help="share of what can be covered, 0 to 1")
    goal("--batteries", type=int, metavar="N", help="number of sorties")
    goal("--weights", choices=("equal", "solid-angle"), default="equal", help="worth of hemisphere sections")
    search = parser.add_argument_group("how").add_argument
    search("--method", choices=("greedy", "pso", "noto", "orbit"), default="greedy", help="default: greedy")
    search("--time-budget", type=float, default=60.0, metavar="S", help="longest wall time (default 60 s)")
    search("--seed", type=int, default=0, metavar="N", help="of everything random (default 0)")
    search("--precision", choices=("f32", "f64"), default="f32", help="of the coverage kernel (default f32)")
    search("--candidates", type=int, metavar="N", help="well-spread viewpoints to choose from (default 20000)")
    rules = parser.add_argument_group("which views count").add_argument
    rules("--min-distance", type=float, default=10.0, metavar="M", help="to everything solid (default 10 m)")
    rules("--step", type=float, default=30.0, metavar="DEG", help="of the hemisphere sections (default 30)")
    rules("--occlusion", choices=("auto", "on", "off"), default="auto", help="default: as the scene calls for")
    rules("--max-distance", type=float, metavar="M", help="views from further away do not count")
    rules("--max-gsd", type=float, metavar="MM", help="views with larger pixels on the panel do not count")
    rules("--whole-panel", action="store_true", help="all four corners must be in the picture")
    flight = parser.add_argument_group("flight").add_argument
    flight("--profile", default="m3e", metavar="ID", help="aircraft and camera (default m3e); 'list' shows all")
    flight("--reserve", type=float, default=0.25, metavar="SHARE", help="battery left at landing (default 0.25)")
    flight("--settle", type=float, default=2.0, metavar="S", help="hover before each photo (default 2 s)")
    flight("--speed", type=float, metavar="M_S", help="highest speed, if lower than the aircraft's")
    flight("--wind", type=float, default=0.0, metavar="M_S", help="wind expected (default 0)")
    flight("--turn-in-flight", action="store_true", help="turn heading and gimbal on the way, not at the waypoint")


def request_of(options: argparse.Namespace) -> PlanRequest:
    """What the options ask for.

    Raises
    ------
    InputError
        A value is out of range.
    """
    from planning.catalogue import profile
    from planning.optimise.candidates import N_CANDIDATES
    from planning.optimise.greedy import GreedyParameters
    from planning.plan import Constraints, FlightRules
    from planning.planner import PlanRequest

    max_distance_m = options.max_distance
    if options.max_gsd is not None:
        by_gsd = profile(options.profile).camera.distance_for_gsd_m(options.max_gsd / 1000.0)
        max_distance_m = by_gsd if max_distance_m is None else min(max_distance_m, by_gsd)
    try:
        return PlanRequest(
            method=options.method,
            n_views=options.views,
            share=options.coverage,
            n_batteries=options.batteries,
            profile_id=options.profile,
            constraints=Constraints(
                options.min_distance, options.step, options.occlusion, options.whole_panel, max_distance_m
            ),
            rules=FlightRules(
                battery_reserve=options.reserve,
                settle_s=options.settle,
                max_speed_m_s=options.speed,
                wind_m_s=options.wind,
                turn_in_flight=options.turn_in_flight,
            ),
            greedy=GreedyParameters(
                n_candidates=N_CANDIDATES if options.candidates is None else options.candidates,
                solid_angle_weights=options.weights == "solid-angle",
            ),
            precision=options.precision,
            seed=options.seed,
            time_budget_s=options.time_budget,
        )
    except ValueError as error:
        raise InputError(str(error)) from error


def run(options: argparse.Namespace) -> int:
    """Plan and write; returns the exit status."""
    from groundstation.cli.console import print_findings, print_json, run_job
    from groundstation.services.planning import plan_site, planned_summary

    started = time.perf_counter()
    request = request_of(options)
    planned = run_job(
        "plan",
        lambda context: plan_site(
            options.site, request, options.out, stop=context.stop, trace=context.trace, monitor=context
        ),
    )
    seconds = time.perf_counter() - started
    if options.json:
        print_json(planned_summary(planned, seconds))
    else:
        print_summary(planned, options.out, seconds)
        print_findings(planned.findings)
    return 0


def print_summary(planned: Planned, out: Path, seconds: float) -> None:
    """What a pilot wants to know, in a few lines on stdout."""
    plan, coverage = planned.plan, planned.plan.coverage
    share = 100.0 * coverage.covered / max(coverage.reachable_upper_bound, 1)
    print(
        f"{out}: {len(plan.viewpoints)} views in {len(plan.sorties)} sorties, {plan.duration_s / 60:.1f} min in the air"
    )
    print(
        f"covered {coverage.covered} of {coverage.total} sections; at most {coverage.reachable_upper_bound} can be "
        f"reached by any flight, so {share:.2f} % of what is possible"
    )
    twice = next((count for count in planned.depth if count.n_views == 2), None)
    if twice is not None:
        print(f"{twice.covered} sections are seen at least twice")
    for number, sortie in enumerate(plan.sorties, 1):
        print(
            f"  sortie {number}: {len(sortie.viewpoint_ids)} views, {sortie.length_m:.0f} m, "
            f"{sortie.duration_s / 60:.1f} min"
        )
    for decision in plan.effects:
        print(decision)
    stages = ", ".join(f"{stage} {value:.1f} s" for stage, value in planned.seconds.items())
    print(f"planned in {seconds:.1f} s ({stages})", file=sys.stderr)
