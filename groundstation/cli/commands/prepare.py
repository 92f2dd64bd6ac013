"""`prepare`: the photos of the second flight and a site to the data set that is reconstructed."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from groundstation.cli.console import counted, print_findings, print_json, print_next, run_job, show, tell
from groundstation.cli.options import add_pose_arguments, in_words_of_options, new_folder, refine_request
from planning.base.messages import glue

EPILOG = """Writes images/, sparse/0 and points.ply as COLMAP and splatting programs read them, transforms.json for
nerfstudio, and panels/, masks/ and normals/ (docs/reference/file-formats.md, reflight-dataset/1).

Without SITE it is a data set for plain splats, in the frame and the units of a model of another program: PHOTOS has
images/ and sparse/0 of COLMAP, or transforms.json of nerfstudio, or --colmap names one.

examples:
  prepare photos/ tower.site.json -o tower.dataset
  prepare photos/ tower.site.json -o tower.dataset --colmap sparse/0 --normal-step 4
  prepare garden/ -o garden.dataset
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "prepare",
        help="make the data set that is reconstructed",
        description="Draw the panels into every photo, render facade masks and normals, refine the mesh on the glass.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    add = parser.add_argument
    add(
        "photos", type=Path, metavar="PHOTOS", help="folder of photos, or of them with their COLMAP or nerfstudio model"
    )
    add("site", type=Path, nargs="?", metavar="SITE", help="site file with its panels; without, plain splats")
    add("-o", "--out", type=new_folder, required=True, metavar="FOLDER", help="new folder for the data set")
    add_pose_arguments(parser)
    add("--normal-step", type=int, default=2, metavar="N", help="photo pixels per pixel of normal maps (default 2)")
    add("--points", type=int, default=100_000, metavar="N", help="points that reconstruction starts from")
    add("--hidden-panels", choices=("auto", "on", "off"), default="auto", help="take out what something hides")
    add("--lens-distortion", choices=("auto", "on", "off"), default="auto", help="straighten the photos")
    add("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """Prepare, write, print; returns the exit status."""
    from groundstation.services.photos.dataset import prepare_files, prepared_summary
    from reconstruction.dataset.prepare import PrepareParameters

    with in_words_of_options():
        parameters = PrepareParameters(
            options.normal_step, options.points, options.hidden_panels, options.lens_distortion
        )
    refine = refine_request(options)
    prepared = run_job(
        "prepare",
        lambda context: prepare_files(
            options.photos,
            options.site,
            options.out,
            parameters,
            heights=options.heights,
            colmap=options.colmap,
            refine=refine,
            monitor=context,
        ),
    )
    if options.json:
        print_json(prepared_summary(prepared))
        return 0
    tell("{} prepared", counted(len(prepared.data.photos), "photo"), place=options.out)
    for decision in prepared.data.decisions:
        show(glue("  ", decision))
    print_findings(prepared.findings)
    print_next("train", options.out, "-o", options.out.with_name(f"{options.out.name}.model"))
    return 0
