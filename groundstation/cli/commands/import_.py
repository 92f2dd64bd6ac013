"""`import`: mission files back to a plan, with the coverage they bring."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from groundstation.cli.console import counted, print_findings, print_json, print_next, run_job, tell
from groundstation.cli.options import add_profile_argument, in_words_of_options, json_file, number
from planning.base.messages import say


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "import",
        help="read a mission file as a plan and see what it covers",
        description="Read a DJI KMZ (or its unpacked folder), a QGroundControl .plan, a .waypoints file, or a KML or "
        "CSV that Reflight wrote; several files are the sorties of one plan.",
    )
    parser.set_defaults(run=run)
    add = parser.add_argument
    add("file", type=Path, nargs="+", metavar="FILE", help="mission file")
    add(
        "--site",
        type=Path,
        metavar="SITE",
        help="site file the mission is flown at (default: a bare site of the mission's own, written beside the plan)",
    )
    add("--strict", action="store_true", help="refuse a mission that an aircraft would refuse")
    add("-o", "--out", type=json_file, required=True, metavar="PLAN", help="plan file to write")
    add_profile_argument(parser)
    add("--min-distance", type=number, default=10.0, metavar="M", help="for the reachable bound (default 10 m)")
    add("--min-height", type=number, metavar="M", help="lowest flight above the ground (default: the site's, else 5 m)")
    add("--step", type=number, default=30.0, metavar="DEG", help="of the hemisphere sections (default 30)")
    add("--occlusion", choices=("auto", "on", "off"), default="auto", help="default: as the scene calls for")
    add("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """Import and print; returns the exit status."""
    from groundstation.services.mission.export import import_missions
    from groundstation.services.plan.planning import finding_summary
    from planning.parameters import Constraints

    with in_words_of_options():
        constraints = Constraints(
            options.min_distance,
            options.step,
            options.occlusion,
            min_height_above_ground_m=options.min_height,
        )
    plan, findings, site = run_job(
        "import",
        lambda context: import_missions(
            options.file,
            options.site,
            options.out,
            options.profile,
            constraints,
            context,
            strict=options.strict,
        ),
    )
    coverage = plan.coverage
    if options.json:
        print_json(
            {
                "plan": str(options.out),
                "site": str(site),
                "views": len(plan.viewpoints),
                "sorties": len(plan.sorties),
                "covered": coverage.covered,
                "total": coverage.total,
                "reachable_upper_bound": coverage.reachable_upper_bound,
                "occlusion": plan.constraints.occlusion,
                "findings": [finding_summary(finding) for finding in findings],
            }
        )
    else:
        views = say("{} in {}", counted(len(plan.viewpoints), "view"), counted(len(plan.sorties), "sortie"))
        if coverage.total:
            tell(
                "{} cover {} of {} sections; no flight can cover more than {}",
                views,
                coverage.covered,
                coverage.total,
                coverage.reachable_upper_bound,
                place=options.out,
            )
        else:
            tell("{}; the site has no panels that they could cover", views, place=options.out)
        if options.site is None:
            tell("a bare site around them, without building and panels", place=site)
        print_findings(findings)
        if coverage.total:
            print_next("check", options.out, site)
    return 0
