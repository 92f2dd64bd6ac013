"""The joint training: steps of Adam on photos, kept alive, kept on disk, and told about while it runs.

What can go wrong and what becomes of it:

- a loss or gradient that is no number: the step is not taken and all rates are halved; after `MOST_HALVINGS` of them
  the training ends with an error, and its last checkpoint is good;
- no memory: windows of photos are halved, and the step is taken again with a smaller one;
- the user cancels: the state is written before `OperationCancelled` goes on, so that the training can, too;
- the user stops, or time is up: the model is what it is then.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import msgspec
import torch
from torch import Tensor

from planning.errors import InputError, OperationCancelled, ReconstructionError
from reconstruction.modelling.checkpoints import read_checkpoint, write_checkpoint
from reconstruction.modelling.config import TrainConfig
from reconstruction.modelling.exposures import Exposures
from reconstruction.modelling.model import Picture, SceneModel
from reconstruction.modelling.objective import objective, on_device
from reconstruction.modelling.photo_stream import PhotoStream, Sample
from reconstruction.modelling.ranks import ALONE, Ranks
from reconstruction.modelling.rates import adam_of, set_rates, take_step
from reconstruction.modelling.stopwatch import Stopwatch
from reconstruction.modelling.strategies import show
from reconstruction.modelling.watching import HeldOut, Preview, Progress, Watching, quality_db
from reconstruction.recovery import NotFinite, is_out_of_memory, require_finite
from reconstruction.splatting.densification import Densification, FixedNumber

MOST_HALVINGS = 8
"""Of the rates, over a whole training: beyond, they are so small that nothing is learned any more."""

SMALLEST_WINDOW_PX = 32 * 32
"""Where there is no memory for that, the splats are too many."""

PAUSE_S = 0.05
"""Between looks at whether a pause is over."""

SHOWN_VIEWS = 4
"""Held-out views that the quality is measured on while training runs."""

WRITTEN = 2.0
"""Time that a finished model takes to be written, as weights and for other programs, against a checkpoint's."""

SEEDS = 1_000_003
"""Between the seeds of two steps, so that trainings with neighbouring seeds share none."""


class Trainer:
    """A training of one model.

    Parameters
    ----------
    exposures
        Of the photos.
    strategy
        Adds and takes away splats, until `densify_until` of the training.
    shown
        What the history is measured on; nothing is chosen by them.
    extent_m
        Size of the scene.
    checkpoint
        File to write; None for none.
    record
        Of the model, to be written with each checkpoint.
    notes
        What had to be survived before.
    ranks
        Processes that train it together; each has a trainer of its own.
    watch
        Of all that counts for the time limit, what went before included.
    """

    def __init__(
        self,
        model: SceneModel,
        exposures: Exposures,
        photos: PhotoStream,
        strategy: Densification,
        config: TrainConfig,
        *,
        shown: Sequence[HeldOut] = (),
        extent_m: float = 1.0,
        checkpoint: Path | None = None,
        record: dict[str, Any] | None = None,
        notes: Sequence[str] = (),
        ranks: Ranks = ALONE,
        watch: Stopwatch | None = None,
    ) -> None:
        self._device = torch.device(config.device)
        self.model, self.exposures = model.to(self._device), exposures.to(self._device)
        self.photos, self.strategy, self.config = photos, strategy, config
        self.shown, self._path, self._record, self._watch = tuple(shown), checkpoint, record or {}, watch or Stopwatch()
        self.at = Progress(window_px=photos.window_px or config.window_px, notes=[*notes])
        self.at.spent_s = self.at.saved_at_s = self._watch()
        self.generator = torch.Generator().manual_seed(config.seed)
        self.optimiser = adam_of(model, exposures, config, extent_m)
        self._settings = replace(config.raster, threads=config.threads)
        self._extent_m, self._is_editing = extent_m, False
        self._no_more = FixedNumber()
        self._n_pixels, self._ranks = 0, ranks
        self._reserve_s = 0.0
        self._with_glass = config.method != "2dgs"

    @property
    def progress(self) -> float:
        """Of the training, 0 to 1: by steps or by time, whichever is further."""
        limit_s = self.config.time_limit_s
        by_time = 0.0 if limit_s is None else (self.at.spent_s + self._reserve_s) / limit_s
        return min(1.0, max(self.at.step / self.config.iterations, by_time))

    def run(self, watching: Watching) -> None:
        """Train to the end, until stopped, or until time is up.

        Raises
        ------
        ReconstructionError
            The training came to nothing: too many steps without numbers, or no memory at all.
        OperationCancelled
            From the monitor; the state is on the disk then.
        """
        before = torch.get_num_threads()
        torch.set_num_threads(self.config.threads)
        try:
            self._run(watching)
        except OperationCancelled:
            self.save()
            raise
        finally:
            torch.set_num_threads(before)

    def _run(self, watching: Watching) -> None:
        self.model.train()
        self._score(watching)
        while not self._is_stopped(watching) and self.progress < 1.0:
            watching.monitor.report("training", self.progress, 1.0)
            self._wait(watching)
            self._survived_step()
            if self.at.spent_s - self.at.scored_at_s >= self.config.score_every_s:
                self._score(watching)
            if self.at.spent_s - self.at.saved_at_s >= self.config.checkpoint_every_s:
                self.save()
        self.model.finish(self.config.reflections)
        self._score(watching)
        self.at.spent_s = self._watch()

    def _wait(self, watching: Watching) -> None:
        with self._watch.paused():
            while watching.pause():
                watching.monitor.report("paused", self.progress, 1.0)
                time.sleep(PAUSE_S)

    def _is_stopped(self, watching: Watching) -> bool:
        """Whether the first process is to stop; all others know what it has spent and still needs, too."""
        numbers = [self._watch(), self._needed_s(), float(watching.stop())]
        self.at.spent_s, self._reserve_s, is_stopped = self._ranks.agreed(numbers)
        return bool(is_stopped)

    def _needed_s(self) -> float:
        """For the last look at the quality, and for writing the model."""
        return self._watch.lasted_s.get("look", 0.0) + WRITTEN * self._watch.lasted_s.get("save", 0.0)

    def _survived_step(self) -> None:
        try:
            self.step()
        except NotFinite as error:
            self._undo(str(error))
        except (MemoryError, RuntimeError) as error:
            # One process alone cannot take a step again.
            if not is_out_of_memory(error) or self._ranks.n > 1:
                raise
            self._shrink(error)

    def step(self) -> dict[str, float]:
        """One step; what each term of the loss was.

        Raises
        ------
        NotFinite
            The loss or a gradient is no number; parameters are as they were.
        """
        at, config, splats = self.at, self.config, self.model.splats
        samples = [self.photos.sample(self.generator) for _ in range(self._ranks.n)]
        sample = on_device(samples[self._ranks.rank], self._device)
        self._n_pixels = sample.facade.numel()
        set_rates(self.optimiser, config.rates, at.step, self.progress, at.factor)
        offsets = torch.zeros(len(splats), 2, device=self._device, requires_grad=True)
        picture = self.picture(sample, self.exposures(sample.number), offsets)
        loss, terms = objective(picture, sample, config.losses, self.progress, self._with_glass)
        glass = self.model.light
        more = None if glass is None else glass.regulariser(config.reflections, at.step)
        loss = loss if more is None else loss + more
        self.optimiser.zero_grad(set_to_none=True)
        loss.backward()  # type: ignore[no-untyped-call]
        parameters = [value for group in self.optimiser.param_groups for value in group["params"]]
        require_finite(self._ranks.average_gradients(parameters, loss.detach()), parameters)
        self._is_editing = True
        strategy = self.strategy if self.progress < config.densify_until else self._no_more
        stage = config.losses.stage(self.progress) if self._with_glass else None
        show(strategy, picture.raster, offsets, samples, self._ranks, 0.0 if stage is None else stage.weight)
        strategy.before_step(at.step, splats, self.optimiser)
        take_step(self.optimiser, splats, config.rates.colour_details)
        self.exposures.project()
        strategy.after_step(at.step, splats, self.optimiser, self.generator)
        self.optimiser.zero_grad(set_to_none=True)
        if glass is not None:
            glass.after_step(config.reflections, at.step, 1.0)
        self._is_editing = False
        at.step += 1
        return terms

    def picture(self, sample: Sample, gain: Tensor | float, offsets: Tensor | None = None) -> Picture:
        """What the model shows where a photo was taken; with `offsets` as a step looks at it."""
        picture: Picture = self.model(
            sample.view,
            gain,
            self.config.degree_at(self.progress),
            settings=self._settings,
            screen_offsets=offsets,
            generator=None if offsets is None else self._jitter(),
        )
        return picture

    def _jitter(self) -> torch.Generator:
        """Of places within pixels: another one in each step and process, without a state of its own."""
        number = self.at.step * self._ranks.n + self._ranks.rank
        return torch.Generator().manual_seed(self.config.seed + SEEDS * (number + 1))

    def _undo(self, reason: str) -> None:
        at = self.at
        at.n_undone += 1
        at.factor *= 0.5
        self.optimiser.zero_grad(set_to_none=True)
        if at.n_undone > MOST_HALVINGS:
            raise ReconstructionError(
                f"training failed at step {at.step + 1}: {reason}, and lower rates do not help"
                f"{self._left()}; train again with lower rates or fewer splats"
            )
        at.notes.append(f"step {at.step + 1} was undone ({reason}); all rates are halved from there on")
        if not self._is_finite():
            self._go_back(reason)

    def _shrink(self, error: BaseException) -> None:
        at = self.at
        self.optimiser.zero_grad(set_to_none=True)
        smaller = min(at.window_px, self._n_pixels) // 2
        if smaller < SMALLEST_WINDOW_PX:
            raise ReconstructionError(
                f"training failed at step {at.step + 1}: there is no memory for {len(self.model.splats)} splats and "
                f"windows of {2 * smaller} pixels{self._left()}; train with fewer splats"
            ) from error
        at.window_px = self.photos.window_px = smaller
        at.notes.append(f"memory ran out at step {at.step + 1}: windows of photos have {smaller} pixels from there on")
        if self._is_editing:
            self._go_back("memory ran out while splats were added")

    def _left(self) -> str:
        return f"; the last checkpoint, {self._path}, is good" if self._path is not None and self._path.exists() else ""

    def _is_finite(self) -> bool:
        values = (value for group in self.optimiser.param_groups for value in group["params"])
        return all(bool(torch.isfinite(value).all()) for value in values)

    def _go_back(self, reason: str) -> None:
        """To the last checkpoint, with the rates, windows and notes of now."""
        if self._path is None or not self._path.exists():
            raise ReconstructionError(f"training failed at step {self.at.step + 1}: {reason}; train again")
        kept = self.at
        self.restore(read_checkpoint(self._path)["training"])
        kept.notes.append(f"went back to step {self.at.step}")
        self.at.factor, self.at.n_undone, self.at.notes = kept.factor, kept.n_undone, kept.notes
        self.at.window_px = self.photos.window_px = kept.window_px
        self._is_editing = False

    def _score(self, watching: Watching) -> None:
        """Measure the quality where it was not measured at this step, and show it."""
        at = self.at
        at.scored_at_s = at.spent_s
        if not self._ranks.is_first or not self.shown or at.scored_step == at.step:
            return
        at.scored_step = at.step

        def displayed(held_out: HeldOut) -> Tensor:
            watching.monitor.report("training", self.progress, 1.0)
            display = self.picture(on_device(held_out.sample, self._device), held_out.gain).display.clamp(0.0, 1.0)
            if held_out is self.shown[0] and watching.preview is not None:
                watching.preview(Preview(at.step, (255.0 * display).round().to(torch.uint8).cpu().numpy()))
            return display

        was_training = self.model.training
        self.model.eval()
        with self._watch.timing("look"):
            at.history.append((at.spent_s, quality_db(self.shown, displayed, self._device)))
        self.model.train(was_training)
        if watching.trace is not None:
            watching.trace.record(at.history[-1][1])

    def save(self) -> None:
        """Write a checkpoint; of a state that is no good, none."""
        if self._path is None or not self._ranks.is_first or not self._is_finite():
            return
        self.at.saved_at_s = self.at.spent_s
        with self._watch.timing("save"):
            write_checkpoint(self._path, {"record": self._record, "training": self.state()})

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
                f"{self._path}: is of another model or version ({error}); train without --resume"
            ) from error
        self.photos.window_px = self.at.window_px
