"""`tradeoff train`: its arguments, and what it prints."""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from groundstation.cli.lists import above_zero, count
from groundstation.cli.options import PluginNames
from planning.base.errors import InputError
from planning.base.plugins import PluginGroup
from reconstruction.training.method_registry import DEFAULT_METHOD, METHODS
from reconstruction.training.names import PRESETS

DEFAULT_SECONDS = 60.0

DEFAULT_KNOBS = (
    "method=2dgs",
    "light=environment-map,mlp,radiance-grid",
    "n_splats=4000,24000",
    "window_px=3072,12288",
    "reduce=2",
    "reflections.precision=float32,bfloat16",
)

KNOB_LINES = "\n".join(f"  --vary {knob}" for knob in DEFAULT_KNOBS)

EPILOG = f"""Every training has the same time, and is scored on the views that were held out. Any setting of a training
(reconstruction/training/config.py) can be turned, inner ones with dots. Without --vary these are:
{KNOB_LINES}

examples:
  tradeoff train tower.dataset -o tradeoff --seconds 120
  tradeoff train tower.dataset -o tradeoff --vary method=2dgs --vary light=mlp,radiance-grid
  tradeoff train tower.dataset -o tradeoff --vary reflections.mlp.width=64,256 --vary raster.tile_px=8,32
"""


def add_arguments(parser: Any) -> None:
    """Describe what can be turned."""
    add = parser.add_argument
    add("dataset", type=Path, metavar="DATASET", help="folder of a data set")
    add("--preset", choices=tuple(PRESETS), default="10min", help="settings to start from (default 10min)")
    add(
        "--method",
        choices=PluginNames(METHODS, PluginGroup.TRAINING_METHODS),
        metavar="METHOD",
        help=f"method to start from (default {DEFAULT_METHOD})",
    )
    add("--seconds", type=above_zero, metavar="S", help=f"of each training (default {DEFAULT_SECONDS:g})")
    add("--iterations", type=count, metavar="N", help="of each training, whatever time they take, instead of --seconds")
    add("--seed", type=int, default=0, metavar="N", help="of everything random (default 0)")
    add("--settings", type=Path, metavar="FILE", help="TOML file with settings that differ from the preset's")
    add("--vary", action="append", default=[], metavar="SETTING=A,B", help="give it again for more")


def run_train(options: argparse.Namespace) -> int:
    """Compare and print; returns the exit status."""
    from groundstation.cli.console import show_tradeoff
    from groundstation.cli.options import checked_seed
    from groundstation.services.reconstruct.tradeoff import train_tradeoff
    from groundstation.services.reconstruct.training import TrainRequest
    from reconstruction.tradeoff.train_tradeoff import trial_rows

    seconds = options.seconds or (DEFAULT_SECONDS if options.iterations is None else None)
    wish = TrainRequest(
        options.preset,
        options.method,
        None,
        options.iterations,
        seconds,
        checked_seed(options.seed),
        options.settings,
    )
    knobs = dict(map(knob_of, options.vary or DEFAULT_KNOBS))
    return show_tradeoff(
        "train",
        options.json,
        lambda context: train_tradeoff(options.dataset, wish, knobs, options.out, context),
        lambda trials: {"settings": trial_rows(trials)},
        lambda trials: _print(trial_rows(trials)),
    )


def _print(rows: Sequence[Mapping[str, Any]]) -> None:
    print(f"  {'setting':<38}{'time':>9}{'facade':>11}{'':>9}{'whole':>11}{'steps':>8}{'splats':>8}")
    for row in rows:
        print(
            f"  {row['setting']:<38}{row['seconds']:>7.1f} s{row['facade_psnr_db']:>8.2f} dB"
            f"{row['change_db']:>+9.2f}{row['whole_psnr_db']:>8.2f} dB{row['steps']:>8}{row['splats']:>8}"
        )


def knob_of(text: str) -> tuple[str, list[Any]]:
    """Name of a setting and its values: numbers and true or false where they read so, else words.

    Raises
    ------
    InputError
        It is not of the form NAME=A,B.
    """
    name, equals, values = text.partition("=")
    words = [word.strip() for word in values.split(",") if word.strip()]
    if not (name.strip() and equals and words):
        raise InputError(f"--vary {text}: expected a setting and its values, such as n_splats=4000,8000")
    return name.strip(), [_value(word) for word in words]


def _value(word: str) -> Any:
    try:
        return json.loads(word)
    except json.JSONDecodeError:
        return word
