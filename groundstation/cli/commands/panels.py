"""`panels`: the photos of the first flight and a coarse model to a site with its panels."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli.commands.segment import add_parameter_arguments
from groundstation.cli.commands.site import add_flight, add_place_and_content, import_options

if TYPE_CHECKING:
    from groundstation.services.photo_panels import PanelSearch

EPILOG = """The photos' own positions and angles place them; a COLMAP model of the same photos places them better. A
file NAME.facades.json beside the site says how good every corner is.

examples:
  panels photos/ coarse.obj -o tower.site.json --origin 22.3372,114.2636,62
  panels photos/ tower.site.json -o found.site.json --colmap sparse/0 --photos-per-facade 8
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "panels",
        help="find the panels of a building in photos",
        description="Find the facades of a coarse model in photos, the grid of panels on each, and the panels in 3-D.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    # As in `site import`: coordinates may start with a minus.
    parser._negative_number_matcher = re.compile(r"-[\d.]")
    add = parser.add_argument
    add("photos", type=Path, metavar="PHOTOS", help="folder of photos, as they come from the camera's card")
    add("model", type=Path, metavar="MODEL", help="coarse model: a mesh, a building model, or a site file")
    add("-o", "--out", type=Path, required=True, metavar="SITE", help="site file to write")
    add("--name", help="name of the site (default: the building's, else the file's)")
    add("--colmap", type=Path, metavar="FOLDER", help="COLMAP model of the photos, for better poses")
    add("--heights", choices=("auto", "takeoff", "absolute"), default="auto", help="which heights of photos count")
    add("--curvature", choices=("auto", "on", "off"), default="auto", help="take facades for cylinders (default auto)")
    add("--photos-per-facade", type=int, default=4, metavar="N", help="photos that are searched (default 4)")
    add("--json", action="store_true", help="print one JSON object instead of text")
    add_parameter_arguments(parser)
    add_place_and_content(parser)
    add_flight(parser)


def run(options: argparse.Namespace) -> int:
    """Find, write, print; returns the exit status."""
    from groundstation.cli.console import print_findings, print_json, print_next, run_job
    from groundstation.cli.options import in_words_of_options
    from groundstation.cli.segmentation_options import parameters_of
    from groundstation.services.photo_panels import find_panel_files, panel_search_summary
    from reconstruction.panels.find import FindParameters

    with in_words_of_options():
        parameters = FindParameters(options.photos_per_facade, options.curvature, segmentation=parameters_of(options))
    wishes = import_options(options)
    search = run_job(
        "panels",
        lambda context: find_panel_files(
            options.photos,
            options.model,
            options.out,
            wishes,
            parameters,
            heights=options.heights,
            colmap=options.colmap,
            monitor=context,
        ),
    )
    if options.json:
        print_json({"site": str(options.out), **panel_search_summary(search)})
        return 0
    _print_search(search, options.out)
    print_findings(search.findings)
    print_next("plan", options.out)
    return 0


def _print_search(search: PanelSearch, out: Path) -> None:
    from groundstation.cli.console import counted
    from groundstation.services.photo_panels import panel_search_summary

    summary = panel_search_summary(search)
    print(f"{out}: {counted(summary['panels'], 'panel')} on {counted(len(summary['facades']), 'facade')}")
    for facade in summary["facades"]:
        rows, columns = counted(facade["rows"], "row"), counted(facade["columns"], "column")
        print(
            f"  facade {facade['id']}: {counted(facade['panels'], 'panel')} in {rows} and {columns}, from "
            f"{counted(facade['photos'], 'photo')}; corners good to {facade['corner_sigma_m']:.2f} m"
        )
        print(f"    {summary['effects'][facade['id']]}")
    for note in search.notes:
        print(f"note: {note}")
