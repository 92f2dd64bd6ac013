"""`photos`: what the photos on a card are worth, before leaving the site."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from groundstation.cli.console import counted, named_like, print_findings, print_json, print_next, run_job, show, tell
from groundstation.cli.options import add_pose_arguments, print_refined, refine_request
from planning.base.messages import say

EPILOG = """examples:
  photos /media/card/DCIM tower.site.json --plan tower.plan.json
  photos photos/ tower.site.json --scale 4 --json
  photos photos/ tower.site.json --refine
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "photos",
        help="check photos and the coverage that they really achieve",
        description="Read all photos of a flight: poses, blur, exposure, doubles, and which sections of which panels\n"
        "they show, against the plan that was flown.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    add = parser.add_argument
    add("photos", type=Path, metavar="PHOTOS", help="folder of photos, as they come from the camera's card")
    add("site", type=Path, metavar="SITE", help="site file with its panels")
    add("--plan", type=Path, metavar="PLAN", help="plan that was flown")
    add_pose_arguments(parser)
    add(
        "--scale",
        type=int,
        choices=(1, 2, 4, 8),
        default=1,
        help="decode photos at 1/N of their size: quicker, less sure of small blur (default 1)",
    )
    add("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """Read, check, print; returns the exit status."""
    from groundstation.services.photos.intake import intake_summary, read_photo_intake
    from groundstation.services.units import per_cent
    from reconstruction.photos.quality import QualityLimits

    limits, refine = QualityLimits(scale=options.scale), refine_request(options)
    intake = run_job(
        "photos",
        lambda context: read_photo_intake(
            options.photos,
            options.site,
            options.plan,
            limits,
            heights=options.heights,
            colmap=options.colmap,
            refine=refine,
            monitor=context,
        ),
    )
    summary = intake_summary(intake)
    if options.json:
        print_json(summary)
        return 0
    print_refined(intake.better.refined)
    blur = summary["blur_px_median"]
    sharpness = "" if blur is None else say(", blur {:.2f} px in the middle", blur)
    tell("{} with a pose, {} usable{}", counted(summary["photos"], "photo"), summary["usable"], sharpness)
    if intake.coverage is None:
        print_findings(intake.findings)
        print_next("panels", options.photos, options.site, "-o", named_like(options.site, ".panels.site.json"))
        return 0
    share = per_cent(summary["covered"], summary["total"], 1)
    tell("they show {} of {} sections ({:.1f} %)", summary["covered"], summary["total"], share)
    if "planned" in summary:
        tell("the plan promised {} sections; {} of them are missing", summary["planned"], summary["missed"])
    if summary["unseen_panels"]:
        tell("{} in no photo at all", counted(summary["unseen_panels"], "panel"))
    show(str(intake.occlusion))
    print_findings(intake.findings)
    return 0
