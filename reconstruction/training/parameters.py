"""What can be asked of a training, and names of its files; it loads nothing that trains, for lists and `-h`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from planning.base.messages import say
from planning.base.parameters import Choice, check, parameter
from planning.parameters import LARGEST_SEED
from reconstruction.training.method_registry import DEFAULT_METHOD

# Files of a training's folder

MODEL, CHECKPOINT = "model.json", "checkpoint.safetensors"


@dataclass(frozen=True, slots=True)
class PresetRow:
    """How long one can wait.

    Parameters
    ----------
    what
        What it is for.
    label
        In the window's list.
    minutes
        That a training takes at most; None where it ends by its steps, and nobody would wait for its model.
    window_px
        Pixels of the part of a photo that a step looks at, at most.
    """

    what: str
    label: str = ""
    minutes: float | None = None
    window_px: int = 256 * 192


PRESETS = {
    "10min": PresetRow(say("small photos or a first look"), "10 minutes", 10.0),
    "1h": PresetRow(
        say("for photos of some hundred pixels' width, or windows of larger ones"), "1 hour", 60.0, 384 * 288
    ),
    "overnight": PresetRow(
        say("the paper's network and number of steps, as far as they go"), "overnight, 10 hours", 600.0, 768 * 576
    ),
    "smoke": PresetRow("a minute; shows that everything works, and nothing else", window_px=96 * 72),
}

DEFAULT_PRESET = "10min"

LIGHTS = (
    Choice("auto", "as the scene calls for"),
    Choice("harmonics", "none apart from the splats (harmonics)"),
    Choice("environment-map", "far away (environment map)"),
    Choice("mlp", "network by place and direction (paper)"),
    Choice("radiance-grid", "near things (radiance grid)"),
)


@dataclass(frozen=True, slots=True)
class TrainRequest:
    """What is asked of a training; None: as the preset has it.

    Parameters
    ----------
    settings
        TOML file with settings that differ from the preset's.
    start
        PLY file of splats to start from.
    """

    preset: str = parameter(
        DEFAULT_PRESET,
        "how long one can wait",
        label="Time",
        choices=tuple(Choice(name, each.label) for name, each in PRESETS.items()),
        option="--preset",
        row="first",
    )
    method: str | None = parameter(
        None,
        "what is trained, and how",
        label="Method",
        option="--method",
        metavar="METHOD",
        unset=DEFAULT_METHOD,
        row="first",
    )
    light: str | None = parameter(
        None,
        "what mirrored light is learned with",
        label="Mirrored light is learned as",
        choices=LIGHTS,
        option="--light",
        unset="auto",
        row="first",
    )
    iterations: int | None = parameter(
        None,
        "steps of Adam, one photo or window each, whatever time they take",
        least=1,
        option="--iterations",
        metavar="N",
        unset="the preset's",
    )
    time_limit_s: float | None = parameter(
        None,
        "for all of it, from reading photos to writing the model; it ends with its rates at their last",
        unit="s",
        above=0.0,
        most=math.inf,
        expected="more than 0",
        option="--time-budget",
        metavar="S",
        unset="the preset's",
    )
    seed: int | None = parameter(
        None, "of everything random", least=0, most=LARGEST_SEED, option="--seed", metavar="N", unset="0"
    )
    settings: Path | None = None
    start: Path | None = None
    device: str | None = parameter(
        None,
        "what splats are drawn on; auto measures a step, gpu is any card, cuda needs the extra of that name",
        label="Compute on",
        choices=(
            Choice("auto", "whatever is fastest"),
            Choice("cpu", "the processor"),
            Choice("gpu", "the graphics card"),
            Choice("cuda"),
        ),
        option="--device",
        unset="auto",
        row="first",
    )
    memory_bytes: int | None = parameter(
        None, "for decoded photos, and as much for rays of glass", unit="bytes", least=1, unset="1 GiB"
    )

    def __post_init__(self) -> None:
        check(self)
