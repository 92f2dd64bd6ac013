"""`segment`: the glass panels in one photo."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from groundstation.cli.console import counted, print_json, run_job, tell
from groundstation.cli.options import add_parameter, json_file, parameters_of
from planning.base.parameters import declared
from reconstruction.panels.search.parameters import SegmentationParameters

EPILOG = """Writes reflight-panels/1 (docs/reference/file-formats.md): corners of every panel in pixels of the photo, by
facade, row and column, and how sure each is.

examples:
  segment facade.jpg -o panels.json
  segment facade.jpg -o panels.json --long-side 3000
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "segment",
        help="find the glass panels in a photo",
        description="Find the rows and columns of glass panels in one photo of one or several facades.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    parser.add_argument("image", type=Path, metavar="IMAGE", help="photo: JPEG, PNG, TIFF or BMP")
    parser.add_argument("-o", "--out", type=json_file, required=True, metavar="FILE", help="panels file to write")
    parser.add_argument("--rectified", action="store_true", help="the photo is fronto-parallel: search it as it is")
    add_parameter_arguments(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of text")


def add_parameter_arguments(parser: Any) -> None:
    """How panels are looked for; shared with other commands that look for them."""
    how = parser.add_argument_group("how")
    how.add_argument(
        "--parameters",
        type=Path,
        metavar="FILE",
        help="TOML file with settings of the search (docs/reference/settings.md)",
    )
    for each in declared(SegmentationParameters).values():
        if each.parameter.option:
            add_parameter(how, each)


def run(options: argparse.Namespace) -> int:
    """Find, write, print; returns the exit status."""
    from groundstation.services.photos.segmentation import segment_file, segmented_summary

    parameters = parameters_of(options)
    done = run_job(
        "segment",
        lambda context: segment_file(
            options.image, options.out, parameters, is_rectified=options.rectified, monitor=context
        ),
    )
    if options.json:
        print_json({"file": str(options.out), **segmented_summary(done)})
        return 0
    for facade in done.found.facades:
        if facade.panels:
            rows, columns = counted(len(facade.rows) - 1, "row"), counted(len(facade.columns) - 1, "column")
            least = min(panel.confidence for panel in facade.panels)
            panels = counted(len(facade.panels), "panel")
            tell(
                "{} in {} and {}, confidence {:.2f} or more", panels, rows, columns, least, place=f"facade {facade.id}"
            )
    for text in dict.fromkeys(str(facade.network) for facade in done.found.facades if facade.network is not None):
        print(text)
    if not done.found.panels:
        tell("no panels found: is the facade seen from its front, and are its frames visible?")
    print(f"{options.out} ({done.seconds:.1f} s)")
    return 0
