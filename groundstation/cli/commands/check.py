"""`check`: every pre-flight rule with its measured value."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli.console import MARKS, named_like, print_json, print_next, run_job, show, verdict_text, worded
from groundstation.cli.options import add_day, flight_day
from planning.base.messages import glue

if TYPE_CHECKING:
    from groundstation.services.mission.readiness import FlightDay
    from planning.base.findings import Finding
    from planning.base.progress import Monitor


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "check",
        help="check a plan against its site before flight",
        description="Measure every pre-flight rule. Exit status 1 where one is broken.",
    )
    parser.set_defaults(run=run)
    parser.add_argument("plan", type=Path, metavar="PLAN", help="plan file")
    parser.add_argument("site", type=Path, metavar="SITE", help="site file")
    add_day(parser)
    parser.add_argument("--proved", action="store_true", help="refuse a plan that an independent check does not prove")
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of text")


def _check(options: argparse.Namespace, day: FlightDay, monitor: Monitor) -> tuple[Finding, ...]:
    from groundstation.services.plan.planning import check_files

    return check_files(options.plan, options.site, day, monitor, is_to_be_proved=options.proved)


def run(options: argparse.Namespace) -> int:
    """Check and print; returns the exit status."""
    from groundstation.services.mission.readiness import readiness_of
    from groundstation.services.plan.planning import finding_summary
    from planning.base.findings import is_flyable

    day = flight_day(options)
    findings = run_job("check", lambda context: _check(options, day, context))
    flyable, verdict = is_flyable(findings), readiness_of(findings)
    if options.json:
        summaries = [finding_summary(finding) for finding in findings]
        print_json({"flyable": flyable, "readiness": verdict, "findings": summaries})
    else:
        for finding in findings:
            place = glue(" [", finding.place, "]") if finding.place else ""
            show(glue(f"{worded(MARKS[finding.severity]):>7}  {finding.code}", place, ": ", finding.message))
        show(verdict_text(findings))
        if flyable:
            print_next("export", options.plan, "--format", "dji-kmz", "-o", named_like(options.plan, ".kmz"))
    return 0 if flyable else 1
