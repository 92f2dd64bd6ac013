"""`report`: a real flight compared with its plan, from its logs or its photos."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli.console import (
    counted,
    flight_status,
    print_findings,
    print_json,
    print_next,
    run_job,
    show,
    tell,
)
from groundstation.cli.options import json_file
from planning.base.messages import say

if TYPE_CHECKING:
    from groundstation.services.fly.flying import ReportedFlight

EPILOG = """Photos are taken as the camera wrote them, with their metadata; folders in the folder are searched, too.
They say where each was taken, not how the aircraft flew between them: distances on the way need a log.

heights:
  --heights auto      logs: above take-off. Photos: above the ellipsoid where RTK was fixed in all, else above take-off
  --heights takeoff   above take-off, which is taken to be at the site's home
  --heights absolute  above sea level or the ellipsoid, as good as the receiver

examples:
  report office.plan.json office.site.json --log flight.tlog -o office.flight.json
  report office.plan.json office.site.json --log first.BIN --log second.BIN
  report office.plan.json office.site.json --photos DCIM/100MEDIA -o office.flight.json
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "report",
        help="report what a real flight covered, from its logs or photos",
        description="Compare a flight with its plan: every view with its photo or the reason why there is none,\n"
        "errors at the shutter, and the coverage that was reached.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    add = parser.add_argument
    add("plan", type=Path, metavar="PLAN", help="plan file")
    add("site", type=Path, metavar="SITE", help="site file")
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument(
        "--log",
        type=Path,
        action="append",
        default=[],
        metavar="FILE",
        help="flight log (.tlog, .BIN, .log, .ulg); once for each, in the order of flight",
    )
    source.add_argument("--photos", type=Path, metavar="DIR", help="folder of the photos that were taken")
    add("-o", "--out", type=json_file, metavar="FLIGHT", help="flight file to write (default: none)")
    add("--heights", choices=("auto", "takeoff", "absolute"), default="auto", help="what heights count from")
    add("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """Read, compare and print; returns the exit status."""
    from groundstation.services.fly.flying import report_files

    reported = run_job(
        "report",
        lambda context: report_files(
            options.plan, options.site, options.log, options.photos, options.out, options.heights, monitor=context
        ),
    )
    if options.json:
        print_json(_summary(reported, options.out))
    else:
        _print_text(reported, options)
    assert reported.flight.report is not None
    return flight_status(reported.flight.report)


def _summary(reported: ReportedFlight, out: Path | None) -> dict[str, Any]:

    from missions.flight.report import report_to_json
    from planning.base.json_file import plain_values

    report = reported.flight.report
    assert report is not None
    return {
        "flight": None if out is None else str(out),
        **report_to_json(report),
        "source_findings": plain_values(reported.findings),
        "seconds": round(reported.seconds, 3),
    }


def _print_text(reported: ReportedFlight, options: argparse.Namespace) -> None:
    from missions.flight.report import report_text

    flight = reported.flight
    assert flight.report is not None
    vehicles = ", ".join(dict.fromkeys(record.vehicle for record in flight.sorties))
    tell("flight:   {} ({}, {})", options.out or say("not written"), counted(len(flight.sorties), "record"), vehicles)
    show(report_text(flight.report))
    print_findings(reported.findings)
    if options.out is not None and flight.report.summary.covered < flight.report.summary.covered_planned:
        print_next("topup", options.out, options.plan, options.site, "-o", options.out.with_name("topup.plan.json"))
    if options.photos is not None:
        tell("to enter this flight in the log book, with the times of its photos:", file=sys.stderr)
        print_next("logbook", "add", options.plan, "--site", options.site, "--photos", options.photos)
