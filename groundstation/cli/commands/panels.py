"""`panels`: the photos of the first flight and a coarse model to a site with its panels."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli.commands.segment import add_parameter_arguments
from groundstation.cli.console import counted, print_findings, print_json, print_next, print_notes, run_job, show, tell
from groundstation.cli.options import (
    add_flight,
    add_place_and_content,
    add_pose_arguments,
    import_options,
    in_words_of_options,
    json_file,
    parameters_of,
    print_refined,
    refine_request,
)
from planning.base.messages import glue

if TYPE_CHECKING:
    from groundstation.services.photos.panels import PanelSearch

EPILOG = """The photos' own positions and angles place them; a COLMAP model of the same photos places them better:
one that is there already (--colmap), or one made of them now (--refine). A
file NAME.facades.json beside the site says how good every corner is.

examples:
  panels photos/ coarse.obj -o tower.site.json --origin 22.3372,114.2636,62
  panels photos/ tower.site.json -o found.site.json --colmap sparse/0 --photos-per-facade 8
  panels photos/ coarse.obj -o tower.site.json --origin 22.3372,114.2636,62 --grids corrected/
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
    add("-o", "--out", type=json_file, required=True, metavar="SITE", help="site file to write")
    add("--name", help="name of the site (default: the building's, else the file's)")
    add_pose_arguments(parser)
    add("--curvature", choices=("auto", "on", "off"), default="auto", help="take facades for cylinders (default auto)")
    add(
        "--view",
        choices=("auto", "exact", "tangent", "polynomial"),
        default="auto",
        help="rectify by arc length, onto the tangent plane, or by the paper's polynomial (default auto: by arc length "
        "where the tangent plane would squeeze columns)",
    )
    add(
        "--fuse",
        choices=("auto", "on", "off"),
        default="auto",
        help="search a facade's photos together (default auto: where one by one they do not agree)",
    )
    add("--grids", type=Path, metavar="DIR", help="panels files of 'segment', corrected by hand, in place of a search")
    add("--photos-per-facade", type=int, default=4, metavar="N", help="photos that are searched (default 4)")
    add("--json", action="store_true", help="print one JSON object instead of text")
    add_parameter_arguments(parser)
    add_place_and_content(parser)
    add_flight(parser)


def run(options: argparse.Namespace) -> int:
    """Find, write, print; returns the exit status."""
    from groundstation.services.photos.panels import find_panel_files, panel_search_summary
    from reconstruction.panels.solving.find import FindParameters

    with in_words_of_options():
        parameters = FindParameters(
            options.photos_per_facade,
            options.curvature,
            options.view,
            options.fuse,
            segmentation=parameters_of(options),
        )
    wanted, refine = import_options(options), refine_request(options)
    search = run_job(
        "panels",
        lambda context: find_panel_files(
            options.photos,
            options.model,
            options.out,
            wanted,
            parameters,
            heights=options.heights,
            colmap=options.colmap,
            refine=refine,
            grids=options.grids,
            monitor=context,
        ),
    )
    if options.json:
        print_json({"site": str(options.out), **panel_search_summary(search)})
        return 0
    _print_search(search, options.out)
    print_refined(search.refined)
    print_findings(search.findings)
    print_next("plan", options.out)
    return 0


def _print_search(search: PanelSearch, out: Path) -> None:
    from groundstation.services.photos.panels import panel_search_summary

    summary = panel_search_summary(search)
    tell("{} on {}", counted(summary["panels"], "panel"), counted(len(summary["facades"]), "facade"), place=out)
    for facade in summary["facades"]:
        rows, columns = counted(facade["rows"], "row"), counted(facade["columns"], "column")
        tell(
            "  facade {}: {} in {} and {}, from {}; corners good to {:.2f} m",
            facade["id"],
            counted(facade["panels"], "panel"),
            rows,
            columns,
            counted(facade["photos"], "photo"),
            facade["corner_sigma_m"],
        )
        for effect in summary["effects"][facade["id"]]:
            show(glue("    ", effect))
    print_notes(search.notes)
