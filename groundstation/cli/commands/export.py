"""`export`: a plan to mission files."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from groundstation.cli.options import number

MAX_RETURN_HEIGHT_M = 1500.0
"""Highest that DJI's waylines allow for any height above take-off."""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "export",
        help="write a plan as a mission for DJI or MAVLink, or for a look in a map",
        description="Write mission files. The first sortie gets the name given, further ones NAME-2, NAME-3 and so "
        "on (KML and CSV hold all sorties).",
    )
    parser.set_defaults(run=run)
    add = parser.add_argument
    add("plan", type=Path, metavar="PLAN", help="plan file")
    formats = ("dji-kmz", "mavlink-plan", "mavlink-wpl", "kml", "csv")
    add("--format", required=True, choices=formats, help="kind of file")
    add("-o", "--out", type=Path, required=True, metavar="FILE", help="file to write")
    add("--site", type=Path, metavar="SITE", help="site file (default: the one beside the plan it was made for)")
    add(
        "--heights",
        choices=("above-takeoff", "amsl", "ellipsoid"),
        default="above-takeoff",
        help="reference of heights in the file (default above-takeoff)",
    )
    add("--autopilot", choices=("ardupilot", "px4"), help="whose rules MAVLink files follow (default: by profile)")
    add("--link-loss", choices=("continue", "go-home"), default="continue", help="DJI: what to do without radio link")
    add("--return-height", type=number, metavar="M", help="DJI: above take-off (default: above everything on the site)")
    add("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """Export and print; returns the exit status."""
    from groundstation.cli.console import print_findings, print_json
    from groundstation.services.missions import export_plan
    from groundstation.services.planning import finding_summary
    from missions.dji.write import LinkLoss
    from missions.encode import ExportOptions
    from missions.mavlink.autopilots import Autopilot
    from missions.model import FileFormat, HeightReference
    from planning.errors import InputError
    from planning.findings import Severity

    height_m = options.return_height
    if height_m is not None and not 0.0 < height_m <= MAX_RETURN_HEIGHT_M:
        raise InputError(f"--return-height: expected a height up to {MAX_RETURN_HEIGHT_M:g} m, got {height_m:g}")
    export_options = ExportOptions(
        height_reference=HeightReference(options.heights),
        autopilot=None if options.autopilot is None else Autopilot(options.autopilot),
        link_loss=LinkLoss(options.link_loss),
        rth_height_m=height_m,
    )
    paths, findings = export_plan(options.plan, FileFormat(options.format), options.out, options.site, export_options)
    if options.json:
        print_json(
            {
                "files": [str(path) for path in paths],
                "format": options.format,
                "heights": options.heights,
                "findings": [finding_summary(finding) for finding in findings],
            }
        )
    else:
        for path in paths:
            print(path)
        print_findings(finding for finding in findings if finding.severity is not Severity.OK)
    return 0
