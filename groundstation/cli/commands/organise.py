"""`organise`: a trained model as facades and panels."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from groundstation.cli.console import counted, print_json, run_job, show, tell
from groundstation.cli.options import new_folder
from planning.base.messages import about, first_few, joined

EPILOG = """examples:
  organise tower.model -o tower.gsscene
  organise tower.model -o tower.gsscene --site tower.json
"""

SHOWN = 8
"""Names of panels."""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "organise",
        help="organise a trained model as facades and panels",
        description="Write a trained model as objects: the scene, its facades and the background, their panels, and "
        "the\nGaussians of each. Each object has an IFC GlobalId, by which records and other formats know it.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    add = parser.add_argument
    add("model", type=Path, metavar="MODEL", help="folder of a model")
    add("-o", "--out", type=new_folder, required=True, metavar="SCENE", help="folder to write")
    add("--site", type=Path, metavar="SITE", help="site file that knows the building model's GlobalIds of panels")
    add("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """Organise and print; returns the exit status."""
    from groundstation.services.model.objects import organise_files

    done = run_job("organise", lambda context: organise_files(options.model, options.out, options.site, context))
    if options.json:
        print_json(done.summary())
        return 0
    parts = (done.n_components - 1, "facade"), (done.n_elements, "panel"), (done.n_gaussians, "Gaussian")
    show(about(done.folder, joined(", ", (counted(n, name) for n, name in parts))))
    if done.n_given_ids:
        tell("{} with the GlobalId of the building model", counted(done.n_given_ids, "panel"))
    if done.empty:
        tell(
            "{} without Gaussians of their own ({}): no photo showed them, or the method knows no panels",
            counted(len(done.empty), "panel"),
            first_few(done.empty, SHOWN),
        )
    return 0
