"""`train`: a data set of photos to a model of splats and mirrored light."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli.console import counted, print_findings, print_json, print_next, print_notes, run_job, show, tell
from groundstation.cli.options import PluginNames, add_parameter, in_words_of_options, new_folder, typed_values
from planning.base.errors import InputError, OperationCancelled
from planning.base.messages import glue, say
from planning.base.parameters import declared, with_values
from planning.base.plugins import PluginGroup
from reconstruction.training.method_registry import METHODS
from reconstruction.training.parameters import PRESETS, TrainRequest

if TYPE_CHECKING:
    from groundstation.services.reconstruct.training import TrainedFiles
    from planning.base.findings import Finding
    from reconstruction.metrics.image_metrics import Quality

PRESET_LINES = "\n".join(f"  {name:<11} {each.what}" for name, each in PRESETS.items())

METHOD_LINES = "\n".join(f"  {name:<30} {method.title}" for name, method in METHODS.items())
METHOD_NAMES = PluginNames(METHODS, PluginGroup.TRAINING_METHODS)

EPILOG = f"""presets:
{PRESET_LINES}

methods:
{METHOD_LINES}

light, for methods that know panels: what glass mirrors is learned by direction alone (environment-map), by place and
direction as in the paper (mlp), as a scene that mirrored rays march through (radiance-grid), or not apart from the
splats at all (harmonics). auto looks at the photos and says why.

Part of the views is held out for 'score'. Ctrl-C keeps the state: the same command with --resume goes on. --settings
is a TOML file with any setting of reconstruction/training/config.py, such as
  max_splats = 50000
  [losses]
  normal_prior = 0.5

examples:
  train tower.dataset -o tower.model
  train tower.dataset -o tower.model --preset 1h --light mlp
  train tower.dataset -o splats.model --method 2dgs --iterations 3000 --json
  train tower.dataset -o tower.model --resume
  train later.dataset -o later.model --start tower.model/splats.ply

Several processes of one machine train together, each looking at other photos, when they are started by
  torchrun --nproc-per-node 4 -m groundstation train tower.dataset -o tower.model
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "train",
        help="train a model of splats and mirrored light",
        description="Learn splats, and the light that glass mirrors, from a data set of 'prepare' or 'scene render'.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    parser.more_help = METHOD_NAMES.help_on_plugins
    add = parser.add_argument
    add(
        "dataset",
        type=Path,
        metavar="DATASET",
        help="folder of a data set, or what becomes one: a coarse model, photos with a COLMAP or nerfstudio model",
    )
    add("-o", "--out", type=new_folder, required=True, metavar="MODEL", help="folder for the model")
    for name, each in declared(TrainRequest).items():
        if each.parameter.option:
            option = add_parameter(parser, each)
            if name == "method":
                option.choices = METHOD_NAMES
    add("--settings", type=Path, metavar="FILE", help="TOML file with settings that differ from the preset's")
    add("--start", type=Path, metavar="PLY", help="splats to start from, instead of new ones")
    add("--resume", action="store_true", help="go on with a training that was interrupted")
    add("--preview", type=Path, metavar="PNG", help="picture of a held-out view, written anew as the training goes on")
    add("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """Train and print; returns the exit status."""
    begun_s = time.perf_counter()
    from groundstation.services.photos.coarse import data_set_of
    from groundstation.services.reconstruct.training import preview_to, train_files, train_summary

    request = request_of(options)
    typed = typed_values(options, TrainRequest)
    typed_options = [each.parameter.option for each in declared(TrainRequest).values() if each.path in typed]
    typed_options += [f"--{name}" for name in ("settings", "start") if getattr(options, name) is not None]
    if options.resume and set(typed_options) - {"--method"}:
        option = next(option for option in typed_options if option != "--method")
        raise InputError(
            say("--resume goes on with the settings that the training was begun with; leave {} out", option)
        )
    found: list[Finding] = []
    preview = None if options.preview is None else preview_to(options.preview)
    try:
        result = run_job(
            "train",
            lambda context: train_files(
                data_set_of(options.dataset, context, found),
                options.out,
                request,
                resume=options.resume,
                preview=preview,
                stop=context.stop,
                trace=context.trace,
                monitor=context,
                begun_s=begun_s,
            ),
        )
    except (KeyboardInterrupt, OperationCancelled):
        if (options.out / "checkpoint.safetensors").is_file():
            tell("note: the state is kept in {}; --resume goes on with it", options.out, file=sys.stderr)
        raise
    if not result.is_written:
        return 0
    print_findings(found)
    if options.json:
        print_json(train_summary(result))
    else:
        _print(result, options)
    return 0


def request_of(options: argparse.Namespace) -> TrainRequest:
    """What the options ask for."""
    with in_words_of_options(TrainRequest):
        request = TrainRequest(settings=options.settings, start=options.start)
        return with_values(request, typed_values(options, TrainRequest))


def _print(result: TrainedFiles, options: argparse.Namespace) -> None:
    from groundstation.services.photos.coarse import data_set_of

    trained = result.trained
    record = trained.record
    tell("{} of {}", counted(trained.n_splats, "splat"), counted(len(record.learned), "photo"), place=result.folder)
    if record.config.trained_by.knows_panels:
        name = "harmonics" if record.light is None else record.light.name
        tell("  mirrored light: {}{}", name, "" if record.config.light == "auto" else say(", as you asked"))
    for decision in record.decisions:
        show(glue("  ", decision))
    told = _told_quality(trained.quality, bool(record.site.panels))
    tell("  {} in {:.0f} s{}", counted(trained.n_steps, "step"), trained.seconds, told)
    print_notes(trained.notes, sys.stderr)
    print_next("score", result.folder, data_set_of(options.dataset))


def _told_quality(quality: Quality | None, has_panels: bool) -> str:
    """What `score` says of the same views; without panels masks have all of each photo, and no facade."""
    if quality is None:
        return ""
    if quality.is_of_facades and has_panels:
        return say(", {:.2f} dB on facades of {}", quality.psnr_db, counted(quality.n_views, "unseen view"))
    return say(", {:.2f} dB on {}", quality.psnr_db, counted(quality.n_views, "unseen view"))
