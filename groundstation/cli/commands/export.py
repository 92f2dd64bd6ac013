"""`export`: a plan to mission files, or a model to the formats of other programs."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from groundstation.cli.options import PluginNames, number, words
from planning.base.plugins import PluginGroup

MISSIONS = ("dji-kmz", "mavlink-plan", "mavlink-wpl", "kml", "csv")
MODELS = ("web", "gltf", "3d-tiles", "usd", "ply", "ply-2dgs", "spz", "spz-4", "sog", "mesh", "cityjson", "ifc")
ALL_MODELS = PluginNames(MODELS, PluginGroup.MODEL_FORMATS)
ALL_FORMATS = PluginNames((*MISSIONS, *MODELS), PluginGroup.MISSION_FORMATS, PluginGroup.MODEL_FORMATS)

COLOURS_HELP = "baked: what panels mirror is in their colours (default); own: without"
GAUSSIANS_HELP = (
    "of gltf (default numbers) and 3d-tiles (default spz): as numbers; compressed, as CesiumJS wants them; or coloured "
    "points in their place"
)

EPILOG = """formats of models:
  web           folder with one page that any browser shows without a network, with picking and records
  gltf          .glb: splats (KHR_gaussian_splatting), and panels to pick with their GlobalIds and attributes
  3d-tiles      folder: the same in tiles, placed on Earth
  usd           .usdc or .usda: splats and panels
  ply, ply-2dgs splats for SuperSplat and others, as ellipsoids or as discs
  spz, sog      splats, compressed
  spz-4         the same as spz in its newer version, smaller, for the newest programs
  mesh          .glb: panels with pictures of their fronts, for programs that know no splats
  cityjson, ifc the panels alone, as windows and plates of the building

examples:
  export office.plan.json --format dji-kmz -o office.kmz
  export tower.gsscene --format web -o tower.web
  export tower.gsscene --format spz --preset small -o tower.spz
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "export",
        help="write a plan as a mission for DJI or MAVLink, or a model for other programs",
        description="Write mission files of a plan, or a model in a format of other programs. Of missions the first\n"
        "sortie gets the name given, further ones NAME-2, NAME-3 and so on (KML and CSV hold all sorties).",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    parser.more_help = ALL_FORMATS.help_on_plugins
    add = parser.add_argument
    add("plan", type=Path, metavar="PLAN|MODEL", help="plan file; or folder of a model, or of its objects")
    add(
        "--format",
        required=True,
        choices=ALL_FORMATS,
        metavar="FORMAT",
        help=f"of plans {', '.join(MISSIONS)}; of models below",
    )
    add("-o", "--out", type=Path, required=True, metavar="FILE", help="file to write; web and 3d-tiles: folder")
    add("--site", type=Path, metavar="SITE", help="site file (default: the one beside the plan it was made for)")
    add(
        "--heights",
        choices=("above-takeoff", "amsl", "ellipsoid"),
        default="above-takeoff",
        help="reference of heights in the file (default above-takeoff)",
    )
    add("--autopilot", choices=("ardupilot", "px4"), help="whose rules MAVLink files follow (default: by profile)")
    add("--link-loss", choices=("continue", "go-home"), default="continue", help="DJI: what to do without radio link")
    add(
        "--return-height",
        type=number,
        metavar="M",
        help="DJI: above take-off, 20 to 1500 (default: above everything)",
    )
    model = parser.add_argument_group("models")
    model.add_argument("--colours", choices=("baked", "own"), default="baked", help=COLOURS_HELP)
    model.add_argument(
        "--degree", type=int, choices=(0, 1, 2, 3), help="of colours by direction (default: the format's)"
    )
    model.add_argument(
        "--preset",
        choices=("small", "balanced", "fine"),
        default="balanced",
        help="of spz, spz-4, sog and --gaussians spz (default balanced)",
    )
    model.add_argument("--gaussians", choices=("numbers", "spz", "points"), help=GAUSSIANS_HELP)
    model.add_argument("--components", type=words, metavar="LIST", help="such as A,background (default: all)")
    add("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """Export and print; returns the exit status."""
    return _export_model(options) if options.format in ALL_MODELS else _export_plan(options)


def _export_model(options: argparse.Namespace) -> int:
    from groundstation.cli.console import print_json, run_job
    from groundstation.services.model.export import ModelExport, export_model

    wanted = ModelExport(
        options.format,
        options.colours == "baked",
        options.degree,
        options.preset,
        options.components,
        options.gaussians,
    )
    done = run_job("export", lambda context: export_model(options.plan, options.out, wanted, context))
    if options.json:
        content = {"file": str(done.path), "format": options.format, "bytes": done.n_bytes, "notes": list(done.notes)}
        print_json(content)
        return 0
    print(f"{done.path}: {done.n_bytes / 1e6:.3g} MB")
    for note in done.notes:
        print(f"note: {note}")
    return 0


def _export_plan(options: argparse.Namespace) -> int:
    from groundstation.cli.console import print_findings, print_json
    from groundstation.services.mission.export import export_plan
    from groundstation.services.plan.planning import finding_summary
    from missions.dji.write import LinkLoss
    from missions.formats.encode import ExportOptions
    from missions.mavlink.autopilots import Autopilot
    from missions.mission.model import HeightReference
    from planning.base.findings import Severity

    export_options = ExportOptions(
        height_reference=HeightReference(options.heights),
        autopilot=None if options.autopilot is None else Autopilot(options.autopilot),
        link_loss=LinkLoss(options.link_loss),
        rth_height_m=options.return_height,
    )
    paths, findings = export_plan(options.plan, options.format, options.out, options.site, export_options)
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
