"""`demo`: the main job on a bundled site."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import Any

from groundstation.cli.console import print_findings, print_json, run_job, show, tell, verdict_text
from groundstation.cli.options import new_folder

SCENES = ("office", "library", "court", "canyon", "roof", "tower", "single-panel")


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "demo",
        help="plan, check, export and simulate the bundled site",
        description="Do the main job on a site that the program makes itself: plan, check, export, simulate.",
    )
    parser.set_defaults(run=run)
    parser.add_argument("--out", type=new_folder, default=Path("demo-out"), metavar="DIR", help="default: demo-out")
    parser.add_argument("--scene", default=SCENES[0], choices=SCENES, help="the site (default office)")
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """Demonstrate; returns the exit status."""
    from groundstation.cli.commands.plan import print_summary
    from groundstation.services.demo import demonstrate
    from groundstation.services.plan.planning import planned_summary
    from missions.flight.report import report_text
    from planning.base.findings import Severity, is_flyable

    started = time.perf_counter()
    result = run_job("demo", lambda context: demonstrate(options.out, options.scene, monitor=context))
    seconds = time.perf_counter() - started
    flyable = is_flyable(result.findings)
    if options.json:
        content = planned_summary(result.planned, seconds)
        content["site"], content["plan"] = str(result.site_path), str(result.plan_path)
        content["missions"] = [str(path) for path in result.mission_paths]
        content["flyable"] = flyable
        if result.flown is not None and result.flown.flight.report is not None:
            from planning.base.json_file import plain_values

            content["flight"] = str(result.flight_path)
            content["flown"] = plain_values(result.flown.flight.report.summary)
        print_json(content)
    else:
        tell("site:     {}", result.site_path)
        print_summary(result.planned, result.plan_path, seconds)
        n_kept_rules = sum(finding.severity is Severity.OK for finding in result.findings)
        of = sum(finding.severity is not Severity.NOTE for finding in result.findings)
        tell("check:    {} of {} rules kept, {}", n_kept_rules, of, verdict_text(result.findings))
        tell("missions: {}", ", ".join(map(str, result.mission_paths)))
        tell("proofs:   {}", ", ".join(map(str, result.proof_paths)))
        if result.flown is not None and result.flown.flight.report is not None:
            tell(
                "flight:   {} ({}, {:.1f} s)",
                result.flight_path,
                result.flown.flight.sorties[0].vehicle,
                result.flown.seconds,
            )
            show(report_text(result.flown.flight.report))
        print_findings(f for f in (*result.findings, *result.export_findings) if f.severity is not Severity.OK)
    return 0 if flyable else 1
