"""`render`: pictures of a trained model from any place."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from groundstation.cli.console import counted, print_json, run_job, show
from groundstation.cli.options import count, new_folder, words
from planning.base.errors import InputError
from planning.base.messages import about, say
from reconstruction.training.layers import LAYERS

LAYER_LINES = "\n".join(f"  {name:<13} {text}" for name, text in LAYERS.items())

EPILOG = f"""layers:
{LAYER_LINES}

examples:
  render tower.model --views tower.dataset -o pictures
  render tower.model --views tower.plan.json -o flight --frames 300 --width 1280
  render tower.model --views tower.dataset -o parts --held-out --layers diffuse,reflection
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "render",
        help="render pictures of a trained model",
        description="Render a model where the photos of a data set were taken, at the viewpoints of a plan, or along\n"
        "the way through them; NAME.png for each view, and LAYER/NAME.png for each layer.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    add = parser.add_argument
    add("model", type=Path, metavar="MODEL", help="folder of a model")
    add("--views", type=Path, required=True, metavar="DATASET|PLAN", help="where its cameras are")
    add("-o", "--out", type=new_folder, required=True, metavar="DIR", help="folder for the pictures")
    add("--layers", type=words, default=(), metavar="LIST", help="such as diffuse,reflection (default: none)")
    add("--width", type=int, metavar="PX", help="of the pictures (default: as the views have it)")
    add("--frames", type=count, metavar="N", help="so many along the way through the views, instead of them")
    add("--held-out", action="store_true", help="only views that the model did not learn from")
    add("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """Render and print; returns the exit status."""
    from groundstation.services.model.rendering import RenderRequest, render_files

    unknown = next((name for name in options.layers if name not in LAYERS), None)
    if unknown is not None:
        raise InputError(say("there is no layer '{}'; known are {}", unknown, ", ".join(LAYERS), place="--layers"))
    if options.frames == 1:
        raise InputError(say("expected 2 or more, got 1", place="--frames"))
    request = RenderRequest(options.views, options.layers, options.width, options.frames, options.held_out)
    pictures = run_job("render", lambda context: render_files(options.model, request, options.out, context))
    if options.json:
        print_json({"folder": str(options.out), "pictures": [str(path) for path in pictures]})
    else:
        show(about(options.out, counted(len(pictures), "picture")))
    return 0
