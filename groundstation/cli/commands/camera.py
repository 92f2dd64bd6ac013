"""`camera`: the camera settings of a plan, and what photos come of them."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from groundstation.cli.console import MARKS, print_json, run_job, show, tell, worded
from groundstation.cli.options import add_parameter, in_words_of_options, json_file, typed_values
from planning.base.messages import glue
from planning.base.parameters import declared
from planning.parameters import CameraSettings

DESCRIPTION = """\
Show how a plan takes its photos: exposure, white balance, focus and shutter; what of it the mission file sets, and
what is left to be set by hand, in the order of the menus; motion blur, rolling shutter and depth of field of its
photos. With options these settings change, and -o writes the plan with them: nothing else of it changes.
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "camera",
        help="camera settings of a plan: who sets them, blur and depth of field",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    parser.add_argument("plan", type=Path, metavar="PLAN", help="plan file")
    parser.add_argument("--site", type=Path, metavar="SITE", help="site file (default: the one beside the plan)")
    parser.add_argument("-o", "--out", type=json_file, metavar="PLAN", help="plan file to write")
    group = parser.add_argument_group("settings, those of the plan where not given")
    for each in declared(CameraSettings).values():
        add_parameter(group, each)
    definition = "definition file of a MAVLink camera: what a flight would set on it"
    parser.add_argument("--definition", type=Path, metavar="FILE", help=definition)
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """Change and show; returns the exit status."""
    from groundstation.services.mission.camera import camera_files, set_by_definition
    from groundstation.services.plan.planning import finding_summary
    from planning.base.json_file import plain_values

    values = typed_values(options, CameraSettings)
    with in_words_of_options(CameraSettings):
        report = run_job(
            "camera", lambda context: camera_files(options.plan, options.site, values, options.out, context)
        )
    by_camera = () if options.definition is None else set_by_definition(report.plan, options.definition)
    if options.json:
        print_json(
            {
                "parameters": [plain_values(each) for each in by_camera],
                "file": None if options.out is None else str(options.out),
                "settings": plain_values(report.plan.camera_settings),
                "summary": report.summary,
                "cost": report.cost,
                "by_mission": list(report.steps.by_mission),
                "by_hand": list(report.steps.by_hand),
                "effects": [plain_values(effect) for effect in report.effects],
                "findings": [finding_summary(finding) for finding in report.findings],
            }
        )
        return 0
    show(report.summary)
    if report.cost:
        show(report.cost)
    for step in report.steps.by_mission:
        tell("set by the mission: {}", step)
    for each in by_camera:
        if not each.name:
            tell("the camera's definition has no parameter for this, set it by hand: {}", each.text)
        elif each.value is None:
            tell("'{}' of the camera cannot be set so: {}", each.name, each.text)
        else:
            tell("set on the camera: '{}' to {:g}, {}", each.name, each.value, each.text)
    for step in report.steps.by_hand:
        tell("set by hand: {}", step)
    for finding in report.findings:
        place = glue(" [", finding.place, "]") if finding.place else ""
        show(glue(f"{worded(MARKS[finding.severity]):>7}  {finding.code}", place, ": ", finding.message))
    for effect in report.effects:
        show(str(effect))
    if not report.findings:
        tell("what photos come of it is not known without the site: add --site SITE")
    if options.out is not None:
        print(options.out)
    return 0
