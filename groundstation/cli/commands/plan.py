"""`plan`: a site to a plan."""

from __future__ import annotations

import argparse
import math
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli.options import add_profile_argument, in_words_of_options, json_file, number
from planning.base.errors import InputError

if TYPE_CHECKING:
    from planning.planner import Planned
    from planning.request import PlanRequest

EPILOG = """how much is wanted (one of):
  --views N         so many views
  --coverage SHARE  so much of what can be covered, with as few views as possible (default: 0.99)
  --batteries N     as much as possible within so many sorties

examples:
  plan office.site.json -o office.plan.json
  plan office.site.json -o office.plan.json --views 560 --time-budget 20
  plan tower.site.json -o tower.plan.json --batteries 2 --profile m4e --wind 6
  plan office.site.json -o new.plan.json --views 560 --keep office.plan.json
"""

MAX_CANDIDATES = 1_000_000
"""Takes 24 s and finds nothing that a tenth of it does not."""


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
    add_request_arguments(parser)


def add_request_arguments(parser: argparse.ArgumentParser) -> None:
    """What is wanted of a plan; shared with other commands that plan."""
    goal = parser.add_argument_group("how much (one of the first three)")
    one_of = goal.add_mutually_exclusive_group().add_argument
    one_of("--views", type=int, metavar="N", help="number of views")
    one_of("--coverage", type=number, metavar="SHARE", help="share of what can be covered, 0 to 1 (default 0.99)")
    one_of("--batteries", type=int, metavar="N", help="number of sorties")
    goal.add_argument(
        "--weights", choices=("equal", "solid-angle"), default="equal", help="worth of hemisphere sections"
    )
    search = parser.add_argument_group("how").add_argument
    search("--method", choices=("greedy", "pso", "noto", "orbit"), default="greedy", help="default: greedy")
    search("--time-budget", type=number, default=60.0, metavar="S", help="longest wall time (default 60 s)")
    search("--seed", type=int, default=0, metavar="N", help="of everything random (default 0)")
    search("--precision", choices=("f32", "f64"), default="f32", help="of the coverage kernel (default f32)")
    search("--candidates", type=int, metavar="N", help="well-spread viewpoints to choose from (default 20000)")
    rules = parser.add_argument_group("which views count").add_argument
    rules("--min-distance", type=number, default=10.0, metavar="M", help="to everything solid (default 10 m)")
    rules(
        "--min-height",
        type=number,
        metavar="M",
        help="lowest flight above the ground, but for take-off and landing (default: the site's, else 5 m)",
    )
    rules("--step", type=number, default=30.0, metavar="DEG", help="of the hemisphere sections (default 30)")
    rules("--occlusion", choices=("auto", "on", "off"), default="auto", help="default: as the scene calls for")
    rules("--max-distance", type=number, metavar="M", help="views from further away do not count")
    rules("--max-gsd", type=number, metavar="MM", help="views with larger pixels on the panel do not count at all")
    rules(
        "--wanted-gsd",
        type=number,
        metavar="MM",
        help="each direction is wanted with pixels up to this size (default: 20 mm, or the camera's at 2.5 times the "
        "minimum distance if that is more; 0: any)",
    )
    rules("--whole-panel", action="store_true", help="all four corners must be in the picture")
    flight_group = parser.add_argument_group("flight")
    add_profile_argument(flight_group)
    flight = flight_group.add_argument
    flight("--reserve", type=number, default=0.25, metavar="SHARE", help="battery left at landing (default 0.25)")
    flight("--settle", type=number, default=2.0, metavar="S", help="hover before each photo (default 2 s)")
    flight("--speed", type=number, metavar="M_S", help="highest speed, if lower than the aircraft's")
    flight("--wind", type=number, default=0.0, metavar="M_S", help="wind expected (default 0)")
    flight("--turn-in-flight", action="store_true", help="turn heading and gimbal on the way, not at the waypoint")


def request_of(options: argparse.Namespace) -> PlanRequest:
    """What the options ask for.

    Raises
    ------
    InputError
        A value is out of range.
    """
    from planning.plan import Constraints, FlightRules
    from planning.request import N_CANDIDATES, GreedyParameters, PlanRequest

    n_candidates = N_CANDIDATES if options.candidates is None else options.candidates
    if not 1 <= n_candidates <= MAX_CANDIDATES:
        raise InputError(f"--candidates: expected 1 to {MAX_CANDIDATES}, got {n_candidates}")
    with in_words_of_options():
        return PlanRequest(
            method=options.method,
            n_views=options.views,
            share=options.coverage,
            n_batteries=options.batteries,
            profile_id=options.profile,
            constraints=Constraints(
                options.min_distance,
                options.step,
                options.occlusion,
                options.whole_panel,
                _max_distance_m(options),
                options.min_height,
                options.wanted_gsd,
            ),
            rules=FlightRules(
                battery_reserve=options.reserve,
                settle_s=options.settle,
                max_speed_m_s=options.speed,
                wind_m_s=options.wind,
                turn_in_flight=options.turn_in_flight,
            ),
            greedy=GreedyParameters(n_candidates, solid_angle_weights=options.weights == "solid-angle"),
            precision=options.precision,
            seed=options.seed,
            time_budget_s=options.time_budget,
        )


def _max_distance_m(options: argparse.Namespace) -> float | None:
    """The nearer of `--max-distance` and the distance at which `--max-gsd` is reached."""
    from planning.aircraft.catalogue import profile

    if options.max_gsd is None:
        return options.max_distance  # type: ignore[no-any-return]
    if not options.max_gsd > 0.0:
        raise InputError(f"--max-gsd: expected a positive number of millimetres, got {options.max_gsd:g}")
    by_gsd_m = profile(options.profile).camera.distance_for_gsd_m(options.max_gsd / 1000.0)
    if not by_gsd_m > options.min_distance:
        raise InputError(
            f"--max-gsd: this camera has pixels of {options.max_gsd:g} mm at {by_gsd_m:.2f} m, but the minimum "
            f"distance is {options.min_distance:g} m; allow larger pixels or lower --min-distance"
        )
    return by_gsd_m if options.max_distance is None else min(options.max_distance, by_gsd_m)


def run(options: argparse.Namespace) -> int:
    """Plan and write; returns the exit status."""
    started = time.perf_counter()  # Loading what planning needs is part of the time budget.
    from groundstation.cli.console import print_findings, print_json, print_next, run_job
    from groundstation.services.plan.planning import locked_viewpoints, plan_site, planned_summary

    request = request_of(options)
    if options.keep is not None:
        with in_words_of_options():
            request = replace(request, locked=locked_viewpoints(options.keep))
    planned = run_job(
        "plan",
        lambda context: plan_site(
            options.site,
            request,
            options.out,
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
        print_findings(planned.findings)
        print_next("check", options.out, options.site)
    return 0


def print_summary(planned: Planned, out: Path, seconds: float) -> None:
    """What a pilot wants to know, in a few lines on stdout."""
    from groundstation.cli.console import counted
    from groundstation.services.units import per_cent
    from planning.coverage.sections import SectionGrid
    from planning.insight.flight_profile import LOW_M, lowest_flight

    plan, coverage = planned.plan, planned.plan.coverage
    n_directions = SectionGrid(plan.constraints.section_step_deg).n_sections
    share = per_cent(coverage.covered, coverage.reachable_upper_bound, 2)
    print(
        f"{out}: {counted(len(plan.viewpoints), 'view')} in {counted(len(plan.sorties), 'sortie')}, "
        f"{plan.duration_s / 60:.1f} min in the air"
    )
    print(
        f"covered {coverage.covered} of {coverage.total} sections ({n_directions} directions of view for each of "
        f"{counted(coverage.total // n_directions, 'panel')})"
    )
    print(
        f"no flight can cover more than {coverage.reachable_upper_bound}, so this is {share:.2f} % of what is possible"
    )
    wanted_mm = plan.constraints.wanted_gsd_mm
    if coverage.sharp is not None and wanted_mm:
        print(
            f"{coverage.sharp} of these with pixels up to {wanted_mm:.1f} mm on the panel, the coarsest with "
            f"{coverage.coarsest_gsd_mm:.1f} mm"
        )
    bound = planned.bound_for_views
    if bound is not None and coverage.covered < bound < coverage.reachable_upper_bound:
        print(f"no choice of as many viewpoints from those compared covers more than {math.floor(bound)}")
    twice = next((count for count in planned.depth if count.n_views == 2), None)
    if twice is not None:
        print(f"seen at least twice: {twice.covered} sections")
    for position, sortie in enumerate(plan.sorties, 1):
        print(
            f"  sortie {position}: {counted(len(sortie.viewpoint_ids), 'view')}, {sortie.length_m:.0f} m, "
            f"{sortie.duration_s / 60:.1f} min"
        )
    site = planned.prepared.site_model.site
    low = lowest_flight(plan, site.home_enu_m, site.airspace.ground_z_m)
    if low is not None:
        below = "" if low.below_s is None else f", {low.below_s / 60:.1f} min below {LOW_M:g} m"
        print(f"lowest flight {low.lowest_m:.1f} m above the ground{below} (take-off and landing apart)")
    for decision in plan.effects:
        print(decision)
    stages = ", ".join(f"{stage} {value:.1f} s" for stage, value in planned.seconds.items())
    print(f"planned in {seconds:.1f} s ({stages})", file=sys.stderr)
