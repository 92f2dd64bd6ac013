"""All that a training is, and how it goes on where a step came to nothing.

What can go wrong and what becomes of it:

- a loss or gradient that is no number: the step is not taken and all rates are halved; after `MOST_HALVINGS` of them
  the training ends with an error, and its last checkpoint is good;
- splats that are no numbers: it goes back to the last checkpoint;
- no memory: windows of photos are halved, and the step is taken again with a smaller one.
"""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import msgspec
import torch

from planning.base.errors import InputError, ReconstructionError
from planning.base.messages import say
from reconstruction.splats.densification.strategy import Densification
from reconstruction.training.callbacks import Progress
from reconstruction.training.checkpoints import read_checkpoint
from reconstruction.training.config import TrainConfig
from reconstruction.training.model.joint_model import SceneModel
from reconstruction.training.photos.exposures import Exposures
from reconstruction.training.photos.photo_stream import PhotoStream
from reconstruction.training.rates import adam_of

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
        photos: PhotoStream,
        strategy: Densification,
        config: TrainConfig,
        extent_m: float,
        path: Path | None,
        at: Progress,
    ) -> None:
        self.device = torch.device(config.device)
        self.model, self.exposures = model.to(self.device), exposures.to(self.device)
        self.photos, self.strategy, self.config = photos, strategy, config
        self.path, self.at, self._extent_m = path, at, extent_m
        self.generator = torch.Generator().manual_seed(config.seed)
        self.optimiser = adam_of(model, exposures, config, extent_m)
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
            self.optimiser = adam_of(self.model, self.exposures, self.config, self._extent_m)
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
