"""`coarse`: the photos of the first flight alone to poses, a coarse model and a site."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from groundstation.cli.console import counted, print_findings, print_json, print_next, run_job, show, tell, worded
from groundstation.cli.options import add_parameter, in_words_of_options, new_folder, typed_values
from planning.base.messages import say
from planning.base.parameters import declared, with_values
from reconstruction.coarse.parameters import CoarseRequest

EPILOG = """Writes coarse.ply, site.json (without panels), sparse/0 (a COLMAP text model in the frame of the site) and
coarse.json, a report. An interrupted run goes on when the command is given again. The size is that of GPS, control
points (--gcp: gcp_list.txt of OpenDroneMap or ground_control_points.json of OpenSfM) or stated distances.
What masks have black, as COLMAP names them (masks/NAME.jpg.png in the folder, or beside one that is called images),
gives no features.

examples:
  coarse photos/ -o tower
  coarse photos/ -o tower --gcp gcp_list.txt --camera camera.json
  coarse photos/ -o castle --distance IMG_1.JPG,IMG_2.JPG,12.5 --origin 48.774,2.302,90
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "coarse",
        help="make a coarse model and a site of photos alone",
        description="Match photos, find where they were taken, and make ground, walls and roofs of what they show.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    add = parser.add_argument
    add("photos", type=Path, metavar="PHOTOS", help="folder of photos, as they come from the camera's card")
    add("-o", "--out", type=new_folder, required=True, metavar="DIR", help="folder for the coarse model")
    add("--camera", type=Path, metavar="FILE", help="the camera: JSON or TOML, a COLMAP cameras.txt, or a 3 x 3 matrix")
    add("--gcp", type=Path, metavar="FILE", help="ground control points")
    add(
        "--distance",
        type=_distance,
        action="append",
        default=[],
        metavar="A,B,M",
        help="two photos, and the metres between where they were taken; may be given again",
    )
    add("--origin", type=_origin, metavar="LAT,LON,H", help="where this is, if the photos do not say so")
    for each in declared(CoarseRequest).values():
        add_parameter(parser, each)
    add("--json", action="store_true", help="print one JSON object instead of text")


def _distance(text: str) -> tuple[str, str, float]:
    parts = text.rsplit(",", 2)
    try:
        metres = float(parts[2])
        if not 0.0 < metres < 1e5:
            raise ValueError("no distance")
    except (IndexError, ValueError) as error:
        raise argparse.ArgumentTypeError(
            worded(say("expected two photos and metres such as A.JPG,B.JPG,12.5, got '{}'", text))
        ) from error
    return parts[0], parts[1], metres


def _origin(text: str) -> tuple[float, float, float]:
    try:
        lat, lon, height = map(float, text.split(","))
    except ValueError as error:
        raise argparse.ArgumentTypeError(
            worded(say("expected latitude, longitude and height such as 48.774,2.302,90, got '{}'", text))
        ) from error
    return lat, lon, height


def run(options: argparse.Namespace) -> int:
    """Make, write, print; returns the exit status."""
    from groundstation.services.photos.coarse import SPARSE, coarse_files
    from planning.geo.frames import Origin

    with in_words_of_options(CoarseRequest):
        request = CoarseRequest(
            options.photos,
            options.out,
            options.camera,
            options.gcp,
            tuple(options.distance),
            None if options.origin is None else Origin(*options.origin),
        )
        request = with_values(request, typed_values(options, CoarseRequest))
    result = run_job("coarse", lambda context: coarse_files(request, context))
    report = result.report
    if options.json:
        print_json(report)
        return 0
    tell(
        "{} of {} found their place, {} points, {} of {} pairs matched, image points off by {:.2f} px",
        report["registered"],
        counted(report["photos"], "photo"),
        report["points"],
        report["pairs"],
        report["of_pairs"],
        report["reprojection_px"],
    )
    residual = report["position_residual_m"]
    if residual is not None:
        tell("receivers are off by {:.2f} m in the middle, {:.2f} m at most", residual["median"], residual["largest"])
    control = report["control_residual_m"]
    if control is not None:
        tell(
            "control points are off by {:.2f} m in the middle, {:.2f} m at most", control["median"], control["largest"]
        )
    tell(
        "{} walls, {} roofs; {:.0f} m2 of walls, of them {:.0f} m2 holes that were closed and {:.0f} m2 guessed",
        len(report["walls"]),
        report["roofs"],
        report["walls_m2"],
        report["holes_m2"],
        report["guessed_m2"],
    )
    show(str(result.decision))
    print_findings(result.findings)
    tell("written", place=result.site)
    out = options.out
    if report["scale_guessed_within_factor"] is not None:
        print_next("coarse", options.photos, "-o", out, "--distance", "ONE.JPG,OTHER.JPG,METRES")
        return 0
    print_next("panels", options.photos, result.site, "-o", out / "panels.site.json", "--colmap", out / SPARSE)
    return 0
