"""All that a training is, and how it goes on where a step came to nothing.

What can go wrong and what becomes of it:

- a loss or gradient that is no number: the step is not taken and all rates are halved; after `MOST_HALVINGS` of them
  the training ends with an error, and its last checkpoint is good;
- splats that are no numbers: it goes back to the last checkpoint;
- no memory: windows of photos are halved, and the step is taken again with a smaller one.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import msgspec
import torch
from safetensors import SafetensorError
from safetensors.torch import load, save
from torch import Tensor, nn

from planning.base.errors import InputError, ReconstructionError
from planning.base.files import check_json_size
from planning.base.json_file import write_atomically
from planning.base.messages import say
from reconstruction.base.adam import Adam
from reconstruction.base.tensor_files import tensor_bytes
from reconstruction.light.radiance_grid import RadianceGrid
from reconstruction.splats.densification.strategy import Densification
from reconstruction.splats.splats import SHAPES, Splats
from reconstruction.training.callbacks import Progress
from reconstruction.training.config import Rates, TrainConfig
from reconstruction.training.model.joint_model import SceneModel
from reconstruction.training.photos.exposures import Exposures
from reconstruction.training.photos.photo_stream import PhotoStream
from reconstruction.training.photos.poses import PoseCorrections
from reconstruction.training.photos.transients import Transients

# One Adam for all that is learned, and the learning rate that each part has at each step.

EPSILON = 1e-15
"""Of Adam: gradients of splats that few pixels see are tiny, and the usual 1e-8 would stop them."""

MEANS = "means"


def adam_of(model: SceneModel, gains: nn.Module, poses: nn.Module, config: TrainConfig, extent_m: float) -> Adam:
    """Adam over model, gains and poses of photos, each group with its `name` and its full rate, `full`.

    With decoupled decay (AdamW) where a group asks for it. Fused: a quarter of the time on a processor, the same bits
    for the same input.

    Parameters
    ----------
    extent_m
        Size of the scene, which the rate of means is a share of.
    """
    rates = config.rates
    groups: list[dict[str, Any]] = [
        {"name": name, "params": params, "full": full} for name, params, full in _of_splats(model.splats, rates)
    ]
    groups[0]["full"] *= extent_m
    groups.append({"name": "sky", "params": list(model.sky.parameters()), "full": rates.sky})
    groups.append({"name": "corner loss", "params": [model.corner_loss], "full": rates.corner_loss})
    of_gains = 0.0 if config.own_exposures == "off" else rates.exposures
    groups.append({"name": "exposures", "params": list(gains.parameters()), "full": of_gains})
    groups.append({"name": "poses", "params": list(poses.parameters()), "full": rates.poses})
    of_attributes = model.shader.attribute_rates()
    groups += [
        {"name": name, "params": [getattr(model.splats, name)], "full": of_attributes[name]}
        for name in model.splats.names[len(SHAPES) :]
    ]
    groups += [
        {"name": f"shading {number}", "params": group["params"], "full": group["lr"]}
        for number, group in enumerate(model.shader.parameter_groups())
    ]
    if model.light is not None:
        learned = config.reflections.for_grid if isinstance(model.light.light, RadianceGrid) else config.reflections
        groups += [
            {**group, "name": f"light {number}", "full": rates.light * group["lr"]}
            for number, group in enumerate(model.light.parameter_groups(learned))
        ]
    groups = [group for group in groups if group["params"]]
    return Adam(groups, lr=0.0, eps=EPSILON)


def _of_splats(splats: Splats, rates: Rates) -> Sequence[tuple[str, list[Tensor], float]]:
    return (
        (MEANS, [splats.means], rates.means),
        ("quats", [splats.quats], rates.quats),
        ("scales", [splats.log_scales], rates.scales),
        ("opacities", [splats.opacity_logits], rates.opacities),
        ("colours", [splats.sh], rates.colours),
        ("reflectivity", [splats.reflectivity_logits], rates.reflectivity),
        ("f0", [splats.f0_logits], rates.f0),
    )


@torch.no_grad()
def take_step(optimiser: Adam, splats: Splats, rates: Rates) -> None:
    """A step of Adam, in which some of what splats have goes only a share of it.

    That is the bands of spherical harmonics above the first (`colour_details`), and places and rotations of splats on
    panels (`glass_geometry`). Adam's steps do not depend on the gradients' size, so it is the step that is shortened.
    """
    glass = splats.panels >= 0
    turned = (splats.means, splats.quats) if rates.glass_geometry != 1.0 else ()
    details, before = splats.sh[:, 1:].clone(), [value[glass] for value in turned]
    optimiser.step()
    splats.sh[:, 1:] = torch.lerp(details, splats.sh[:, 1:], rates.colour_details)
    for value, old in zip(turned, before, strict=True):
        value[glass] = torch.lerp(old, value[glass], rates.glass_geometry)


def set_rates(optimiser: Adam, rates: Rates, step: int, progress: float, factor: float) -> None:
    """Give each group the rate of this step.

    Parameters
    ----------
    progress
        Of the whole training, 0 to 1, by steps or by time, whichever is further.
    factor
        Of all rates: halved whenever a step gave no numbers.
    """
    share, of_means = rates.share(step, progress), rates.means_share(step, progress)
    for group in optimiser.param_groups:
        group["lr"] = factor * group["full"] * (of_means if group["name"] == MEANS else share)


# Checkpoints: all that a training is, in one file that is whole or not there, so that it goes on bit by bit.
#
# One safetensors file holds the tensors, and in its header as JSON all other state. Nothing in it is ever executed:
# files of strangers may be read.

FORMAT = "reflight-checkpoint/1"

RECORD = "record"
"""Key of the JSON text in the header."""

DEEPEST = 40
"""Nesting of state; a training's is under 10."""


def flatten(state: Any, tensors: dict[str, Tensor], place: str = "") -> Any:
    """State with each tensor replaced by a reference, and put into `tensors` under its place.

    Dictionaries with keys of text or whole numbers, lists, tuples (which come back as lists), numbers, text and None
    are kept as they are.

    Raises
    ------
    TypeError
        Something else is in it.
    """
    if isinstance(state, Tensor):
        tensors[place] = state.detach().cpu().contiguous().clone()
        return {"$tensor": place}
    if isinstance(state, dict):
        keys = list(state)
        if not all(type(key) in (str, int) for key in keys):
            raise TypeError(f"{place}: expected keys of text or whole numbers")
        return {"$items": [[key, flatten(state[key], tensors, f"{place}/{key}")] for key in keys]}
    if isinstance(state, list | tuple):
        return [flatten(value, tensors, f"{place}/{number}") for number, value in enumerate(state)]
    if state is None or isinstance(state, bool | int | float | str):
        return state
    raise TypeError(f"{place}: expected tensors, numbers, text, lists and dictionaries, got {type(state).__name__}")


def unflatten(content: Any, tensors: dict[str, Tensor], depth: int = 0) -> Any:
    """State that `flatten` took apart.

    Raises
    ------
    ValueError
        The content is not of its form.
    """
    if depth > DEEPEST:
        raise ValueError("nested too deeply")
    if isinstance(content, list):
        return [unflatten(value, tensors, depth + 1) for value in content]
    if isinstance(content, dict):
        if set(content) == {"$tensor"} and isinstance(content["$tensor"], str):
            if content["$tensor"] not in tensors:
                raise ValueError(f"there is no tensor '{content['$tensor']}'")
            return tensors[content["$tensor"]]
        items = content.get("$items")
        if set(content) != {"$items"} or not isinstance(items, list):
            raise ValueError("expected a reference to a tensor or items")
        if not all(isinstance(item, list) and len(item) == 2 and type(item[0]) in (str, int) for item in items):
            raise ValueError("expected pairs of key and value")
        return {key: unflatten(value, tensors, depth + 1) for key, value in items}
    return content


def write_checkpoint(path: Path, state: dict[str, Any]) -> None:
    """Write state whole or not at all; what was there before stays until then.

    Raises
    ------
    InputError
        It cannot be written.
    """
    tensors: dict[str, Tensor] = {}
    record = {"format": FORMAT, "state": flatten(state, tensors)}
    write_atomically(path, save(tensors, metadata={RECORD: json.dumps(record, allow_nan=True)}))


def read_checkpoint(path: Path) -> dict[str, Any]:
    """State that `write_checkpoint` wrote, bit by bit.

    Raises
    ------
    InputError
        The file is missing, damaged, or none of ours.
    """
    content = tensor_bytes(path, say("begin the training anew"))
    try:
        tensors = load(content)
        text = _header_text(content)
        check_json_size(text.encode(), path)
        record = json.loads(text)
        if not isinstance(record, dict) or record.get("format") != FORMAT:
            raise ValueError(f"expected '{FORMAT}'")
        state = unflatten(record["state"], tensors)
    except (SafetensorError, KeyError, ValueError, TypeError, RecursionError) as error:
        raise InputError(
            say("is no checkpoint, or damaged ({}); begin the training anew", error, place=path)
        ) from error
    if not isinstance(state, dict):
        raise InputError(say("is no checkpoint; begin the training anew", place=path))
    return state


def _header_text(content: bytes) -> str:
    """The text that stands in the header, whose length is the file's first eight bytes."""
    length = int.from_bytes(content[:8], "little")
    text = json.loads(content[8 : 8 + length])["__metadata__"][RECORD]
    if not isinstance(text, str):
        raise ValueError("expected text")
    return text


MOST_HALVINGS = 8
"""Of the rates, over a whole training: beyond, they are so small that nothing is learned any more."""

SMALLEST_WINDOW_PX = 32 * 32
"""Where there is no memory for that, the splats are too many."""


class TrainingState:
    """Parameters, Adam, photos, strategy, random numbers and progress of a training.

    Parameters
    ----------
    extent_m
        Size of the scene.
    path
        Of its checkpoint; None for none.

    Attributes
    ----------
    n_pixels
        Of the sample that was looked at last.
    is_editing
        Whether splats are being changed, so that a step that breaks off leaves half of it.
    """

    def __init__(
        self,
        model: SceneModel,
        exposures: Exposures,
        poses: PoseCorrections,
        transients: Transients,
        photos: PhotoStream,
        strategy: Densification,
        config: TrainConfig,
        extent_m: float,
        path: Path | None,
        at: Progress,
    ) -> None:
        self.device = torch.device(config.tensors_on)
        self.model, self.exposures = model.to(self.device), exposures.to(self.device)
        self.poses, self.transients = poses.to(self.device), transients
        self.photos, self.strategy, self.config = photos, strategy, config
        self.path, self.at, self._extent_m = path, at, extent_m
        self.generator = torch.Generator().manual_seed(config.seed)
        self.optimiser = adam_of(model, exposures, poses, config, extent_m)
        self.n_pixels, self.is_editing = 0, False

    def undo(self, reason: str) -> None:
        """After a step without numbers, which was not taken: go on with halved rates.

        Raises
        ------
        ReconstructionError
            They have been halved too often.
        """
        at = self.at
        at.n_undone += 1
        at.factor *= 0.5
        self.optimiser.zero_grad(set_to_none=True)
        if at.n_undone > MOST_HALVINGS:
            raise ReconstructionError(
                say(
                    "training failed at step {}: {}, and lower rates do not help{}; train again with lower rates or "
                    "fewer splats",
                    at.step + 1,
                    reason,
                    self._left(),
                )
            )
        at.notes.append(say("step {} was undone ({}); all rates are halved from there on", at.step + 1, reason))
        if not self.is_finite():
            self.go_back(reason)

    def shrink(self, error: BaseException) -> None:
        """After a step that there was no memory for: go on with smaller windows.

        Raises
        ------
        ReconstructionError
            They cannot become smaller.
        """
        at = self.at
        self.optimiser.zero_grad(set_to_none=True)
        smaller = min(at.window_px, self.n_pixels) // 2
        if smaller < SMALLEST_WINDOW_PX:
            raise ReconstructionError(
                say(
                    "training failed at step {}: there is no memory for {} splats and windows of {} pixels{}; train "
                    "with fewer splats",
                    at.step + 1,
                    len(self.model.splats),
                    2 * smaller,
                    self._left(),
                )
            ) from error
        at.window_px = self.photos.window_px = smaller
        at.notes.append(
            say("memory ran out at step {}: windows of photos have {} pixels from there on", at.step + 1, smaller)
        )
        if self.is_editing:
            self.go_back(say("memory ran out while splats were added"))

    def _left(self) -> str:
        return (
            say("; the last checkpoint, {}, is good", self.path) if self.path is not None and self.path.exists() else ""
        )

    def is_finite(self) -> bool:
        """Whether all parameters are numbers."""
        values = (value for group in self.optimiser.param_groups for value in group["params"])
        return all(bool(torch.isfinite(value).all()) for value in values)

    def go_back(self, reason: str) -> None:
        """To the last checkpoint, with the rates, windows and notes of now."""
        if self.path is None or not self.path.exists():
            raise ReconstructionError(say("training failed at step {}: {}; train again", self.at.step + 1, reason))
        kept = self.at
        self.restore(read_checkpoint(self.path)["training"])
        kept.notes.append(say("went back to step {}", self.at.step))
        self.at.factor, self.at.n_undone, self.at.notes = kept.factor, kept.n_undone, kept.notes
        self.at.window_px = self.photos.window_px = kept.window_px
        self.is_editing = False

    def state(self) -> dict[str, Any]:
        """All that the training is; what comes from the clock is seconds only."""
        return {
            "model": self.model.state_dict(),
            "empty places": self.model.empty_places(),
            "exposures": self.exposures.state_dict(),
            "poses": self.poses.state_dict(),
            "transients": self.transients.state_dict(),
            "adam": self.optimiser.state_dict(),
            "photos": self.photos.state_dict(),
            "strategy": self.strategy.state_dict(),
            "generator": self.generator.get_state(),
            "progress": asdict(self.at),
        }

    def restore(self, state: dict[str, Any]) -> None:
        """Go on from a state, bit by bit.

        Raises
        ------
        InputError
            It is that of another model.
        """
        try:
            self.model.load(state["model"], state["empty places"])
            self.exposures.load_state_dict(state["exposures"])
            self.poses.load_state_dict(state["poses"])
            # Where looks have no date yet, all are old: nothing is told by them.
            undated = {"seen_at": torch.zeros_like(self.transients.seen_at)}
            self.transients.load_state_dict(undated | state["transients"])
            self.optimiser = adam_of(self.model, self.exposures, self.poses, self.config, self._extent_m)
            self.optimiser.load_state_dict(state["adam"])
            self.photos.load_state_dict(state["photos"])
            self.strategy.load_state_dict(state["strategy"])
            self.generator.set_state(state["generator"])
            self.at = msgspec.convert(state["progress"], Progress)
        except (KeyError, ValueError, TypeError, RuntimeError) as error:
            raise InputError(
                say("is of another model or version ({}); begin the training anew", error, place=self.path)
            ) from error
        self.photos.window_px = self.at.window_px
