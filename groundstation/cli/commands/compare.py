"""`compare`: two or more plans of one site side by side."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli.console import print_json, print_notes, run_job, tell, worded

if TYPE_CHECKING:
    from planning.insight.comparison import Comparison

EPILOG = """A star marks the better value. Coverage of all plans is counted in one way: under the constraints
of the first. Mission files are read as plans for its aircraft.

examples:
  compare greedy.plan.json pso.plan.json --site office.site.json
  compare greedy.plan.json flown.kmz --site office.site.json
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "compare",
        help="compare two or more plans of one site",
        description="Put plans side by side: effort, coverage, pixel sizes, clearance and findings.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    # The first on its own, so that one plan alone is wrong usage.
    parser.add_argument("first", type=Path, metavar="PLAN", help="plan file; its constraints hold for all")
    parser.add_argument("others", type=Path, nargs="+", metavar="PLAN", help="plan or mission files to compare it with")
    parser.add_argument("--site", type=Path, required=True, metavar="SITE", help="site file of all plans")
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """Compare and print; returns the exit status."""
    from groundstation.services.plan.comparison import compare_files, comparison_summary

    paths = [options.first, *options.others]
    comparison = run_job("compare", lambda context: compare_files(paths, options.site, context))
    if options.json:
        print_json(comparison_summary(comparison))
    else:
        _print_table(comparison)
    return 0


def _print_table(comparison: Comparison) -> None:
    """A column a plan."""
    from groundstation.services.plan.comparison import marked_as_best

    constraints = comparison.constraints
    lines = [["", *comparison.names]]
    for row in comparison.rows:
        texts = [_cell(value, row.unit) for value in row.values]
        stars = ("*" if is_best else " " for is_best in marked_as_best(texts, row.best))
        lines.append([worded(row.label), *(text + star for text, star in zip(texts, stars, strict=True))])
    widths = [max(len(line[column]) for line in lines) for column in range(len(lines[0]))]
    for line in lines:
        cells = (cell.rjust(width) for cell, width in zip(line[1:], widths[1:], strict=True))
        print("  ".join([line[0].ljust(widths[0]), *cells]).rstrip())
    tell(
        "coverage of all plans: {:g} degree sections, {:g} m minimum distance, occlusion {}",
        constraints.section_step_deg,
        constraints.min_distance_m,
        constraints.occlusion,
    )
    print_notes(comparison.notes)


def _cell(value: float | None, unit: str) -> str:
    if value is None:
        return "-"
    if unit == "share":
        return f"{100.0 * value:.2f} %"
    if unit == "s":
        return f"{value / 60.0:.1f} min" if value >= 60.0 else f"{value:.1f} s"
    if unit == "m/px":
        return f"{1000.0 * value:.2f} mm"
    if unit == "m":
        return f"{value:.2f} m"
    return f"{value:g}"
