"""The joint training: steps of Adam on photos, kept alive, kept on disk, and told about while it runs.

How it ends, besides by itself, and as `TrainingState` says:

- the user cancels: the state is written before `OperationCancelled` goes on, so that the training can, too;
- the user stops: rates fall to their last within a twentieth of the time spent, see `cool_down`;
- time is up: the model is what it is then, for its rates are at their last.
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from planning.base.errors import OperationCancelled
from planning.base.messages import say
from reconstruction.base.out_of_memory import NotFinite, is_out_of_memory, require_finite
from reconstruction.gpu.device import DeviceFailed, open_device
from reconstruction.light.losses import no_brighter
from reconstruction.light.training import torch_threads
from reconstruction.splats.densification.adaptive import AdaptiveControl, AdaptiveParameters
from reconstruction.splats.densification.mcmc import MarkovChain, McmcParameters
from reconstruction.splats.densification.strategy import Densification, FixedNumber, Limits
from reconstruction.splats.rasterising.raster_types import Raster
from reconstruction.training.callbacks import (
    Callbacks,
    HeldOut,
    Preview,
    Progress,
    SnapshotState,
    TrainingSnapshot,
    quality_db,
)
from reconstruction.training.card_step import CardGradients, CardStep, fits_card_step
from reconstruction.training.config import LossWeights, TrainConfig
from reconstruction.training.losses import (
    colour_loss,
    normal_consistency,
    normal_prior,
    normal_smoothness,
    surface_normals,
    worst_pixels,
)
from reconstruction.training.model.joint_model import Picture, SceneModel
from reconstruction.training.photos.exposures import Exposures
from reconstruction.training.photos.photo_stream import PhotoStream, Sample
from reconstruction.training.photos.poses import PoseCorrections
from reconstruction.training.photos.transients import Transients
from reconstruction.training.ranks import ALONE, Ranks
from reconstruction.training.timer import Timer
from reconstruction.training.training_state import TrainingState, set_rates, take_step, write_checkpoint


def objective(
    picture: Picture, sample: Sample, weights: LossWeights, progress: float, with_glass: bool
) -> tuple[Tensor, dict[str, float]]:
    """The loss, and what each weighted term adds to it.

    Parameters
    ----------
    progress
        Of the training, 0 to 1.
    with_glass
        Whether the terms that the paper adds for glass count, too (Eqs. 23 and 24).
    """
    truth = display_of(sample)
    found, facade = picture.display, sample.facade
    if sample.shown is not None:
        # What a photo does not show is as it should be.
        found = torch.where(sample.shown[..., None], found, truth)
        facade = facade & sample.shown
    found = no_brighter(found, truth, weights.white)
    terms = {"colour": colour_loss(found, truth, weights.dssim)}
    raster = picture.raster
    if weights.normal_consistency > 0.0 and progress >= weights.consistent_from:
        surface, is_known = surface_normals(raster.depths, raster.alphas, sample.view)
        consistency = normal_consistency(picture.normals, raster.alphas, surface, is_known)
        terms["normal consistency"] = weights.normal_consistency * consistency
    if with_glass and weights.normal_prior > 0.0 and sample.normals is not None:
        terms["normal prior"] = weights.normal_prior * normal_prior(picture.normals, sample.normals, facade)
    stage = weights.stage(progress) if with_glass else None
    if stage is not None and stage.weight > 0.0:
        worst = worst_pixels(found, truth, facade, stage.threshold)
        terms["high frequency"] = stage.weight * worst
    if weights.normal_smoothness > 0.0:
        terms["normal smoothness"] = weights.normal_smoothness * normal_smoothness(picture.normals, truth)
    if picture.penalty is not None:
        terms["shading"] = picture.penalty
    total = torch.stack(list(terms.values())).sum()
    return total, {name: float(term.detach()) for name, term in terms.items()}


def on_device(sample: Sample, device: torch.device) -> Sample:
    """The same sample in the memory of a device."""
    if device.type == "cpu":
        return sample
    return replace(
        sample,
        display=sample.display.to(device),
        facade=sample.facade.to(device),
        panels=sample.panels.to(device),
        normals=None if sample.normals is None else sample.normals.to(device),
        shown=None if sample.shown is None else sample.shown.to(device),
    )


def display_of(sample: Sample) -> Tensor:
    """SRGB values, 0 to 1, shape (h, w, 3), float32."""
    return sample.display.float() / 255.0


# The strategy that a configuration asks for, and what it is shown.

ALWAYS = 1 << 62
"""Steps."""


def strategy_of(config: TrainConfig, n_splats: int) -> Densification:
    """Adds splats, to `max_splats` at most, whenever it is asked: the trainer asks between two shares of the training.

    Opacities are never reset: splats start on surfaces that are known, and trainings are short.
    """
    limits = Limits(n_most=max(config.max_splats, n_splats))
    if config.densification == "none":
        return FixedNumber(limits)
    if config.densification == "mcmc":
        return MarkovChain(McmcParameters(start=0, stop=ALWAYS, n_splats=config.max_splats), limits)
    return AdaptiveControl(AdaptiveParameters(start=0, stop=ALWAYS, reset_every=0), limits)


def observe_pictures(
    strategy: Densification, raster: Raster, offsets: Tensor, samples: Sequence[Sample], ranks: Ranks, weight: float
) -> None:
    """Tell a strategy about a picture, and those of other processes, in the same order everywhere.

    Parameters
    ----------
    offsets
        Of the splats' screen positions, with their gradients.
    weight
        Of the high-frequency loss: it multiplies gradients, which says nothing about how many splats are needed.
    """
    pulls = torch.zeros_like(offsets) if offsets.grad is None else offsets.grad
    seen = torch.cat([pulls / (1.0 + weight), raster.weights[:, None], raster.radii_px[:, None].to(pulls)], dim=1)
    for found, sample in zip(ranks.gathered(seen), samples, strict=True):
        strategy.observe(replace(raster, weights=found[:, 2], radii_px=found[:, 3]), found[:, :2], sample.view)


# The end of a training that was stopped: its rates fall to their last in a short time.
#
# While rates are high, parameters dance about what they are on average, and pictures are worse than they could be. A
# training that ends by itself has let its rates fall; one that is stopped goes the rest of that way quickly, adds no
# more
# splats, and keeps the losses that it has. Nothing is chosen: what is kept is where it ends.

SHARE = 0.05
"""Of the time spent, for settling: the user has just said that it is enough."""

MOST_S = 60.0


@dataclass(frozen=True, slots=True)
class CoolDown:
    """How far a stopped training has settled.

    Parameters
    ----------
    progress
        Of the training when it was stopped, 0 to 1.
    begun_s
        That it had taken then.
    """

    progress: float
    begun_s: float

    @property
    def lasts_s(self) -> float:
        """All in all."""
        return min(MOST_S, SHARE * self.begun_s)

    def share(self, spent_s: float) -> float:
        """Of settling, 0 to 1, when the training has taken `spent_s`."""
        done_s = spent_s - self.begun_s
        return 1.0 if done_s >= self.lasts_s else max(0.0, done_s / self.lasts_s)

    def progress_of_rates(self, spent_s: float) -> float:
        """Progress that the rates are to be those of: the rest of the training, gone through evenly."""
        return self.progress + (1.0 - self.progress) * self.share(spent_s)


LEAST_PROGRESS = 0.02
"""That the rest of a training is judged by."""

PAUSE_S = 0.05
"""Between looks at whether a pause is over."""

LAST_SHARE = 0.05
"""Of a time limit, at most, for scoring held-out views in full when it has ended."""

WRITTEN = 2.0
"""Time that a finished model takes to be written, as weights and for other programs, against a checkpoint's."""

FRESH_S = 1.0
"""By which what somebody sees of splats that a graphics card holds may be old."""

FRESH_STEPS = 100
"""That are lost where a graphics card fails, at most."""

SEEDS = 1_000_003
"""Between the seeds of two steps, so that trainings with neighbouring seeds share none."""


# Windows of photos are as small as leaves room for enough steps: with few, splats are far from where they would go.

ENOUGH_STEPS = 1000
"""That a time limit should leave room for. On 85 photos of 256 x 192 pixels in 60 s of processor time, windows of a
quarter gave 373 steps in the place of 130, and 1.3 dB more on facades of unseen views."""

TIMED_STEPS = 8
"""After which the time of a step is known; that of the first, which compiles, does not count in their median."""

LEAST_SHARE, LEAST_WINDOW_PX = 0.25, 96 * 72
"""Of a window: smaller ones hold too little for structural similarity, and a step's time is that of its splats."""


def fitting_window_px(window_px: int, n_steps: float) -> int:
    """Pixels of windows where so many steps with windows of `window_px` would fit into the time."""
    share = min(1.0, max(LEAST_SHARE, n_steps / ENOUGH_STEPS))
    return min(window_px, max(LEAST_WINDOW_PX, round(share * window_px)))


class Trainer(TrainingState):
    """A training of one model.

    Parameters
    ----------
    exposures, poses, transients
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
    notes, history
        What had to be survived before, and how good it was.
    ranks
        Processes that train it together; each has a trainer of its own.
    watch
        Of all that counts for the time limit, what went before included.
    last_px
        Pixels of all held-out views, which are looked at when it has ended.
    on_gpu
        Whether splats are drawn, and where their light allows it learned, by the graphics card, until it fails.
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
        *,
        shown: Sequence[HeldOut] = (),
        extent_m: float = 1.0,
        checkpoint: Path | None = None,
        record: dict[str, Any] | None = None,
        notes: Sequence[str] = (),
        history: Sequence[tuple[float, float]] = (),
        ranks: Ranks = ALONE,
        watch: Timer | None = None,
        last_px: int = 0,
        on_gpu: bool = False,
    ) -> None:
        at = Progress(window_px=photos.window_px or config.window_px, history=[*history], notes=[*notes])
        super().__init__(model, exposures, poses, transients, photos, strategy, config, extent_m, checkpoint, at)
        self.shown, self._record, self._watch = tuple(shown), record or {}, watch or Timer()
        self.at.spent_s = self.at.saved_at_s = self.at.began_s = self._watch()
        self._settings = replace(config.raster, on_gpu=on_gpu)
        self._no_more, self._ranks = FixedNumber(), ranks
        self._reserve_s = 0.0
        self._last_px = last_px
        self._with_glass = config.trained_by.knows_panels
        self._cool_down: CoolDown | None = None
        self._terms: dict[str, float] = {}
        self._by_card = on_gpu and ranks.n == 1 and fits_card_step(model, config)
        self._card: CardStep | None = None
        self._brought_s = -math.inf
        self._step_s: list[float] = []

    @property
    def is_first(self) -> bool:
        """Whether its process is the first of those that train together."""
        return self._ranks.is_first

    @property
    def progress(self) -> float:
        """Of the joint training, 0 to 1: by steps or by time, whichever is further.

        Time counts from its own beginning: what light took before is no part of what rates and losses go through.
        """
        at, limit_s = self.at, self.config.time_limit_s
        by_steps = min(1.0, at.step / self.config.iterations)
        if limit_s is None:
            return by_steps
        left_s = limit_s - at.began_s
        by_time = 1.0 if left_s <= 0.0 else (at.spent_s + self._reserve_s - at.began_s) / left_s
        return min(1.0, max(by_steps, by_time))

    def _left_s(self) -> float | None:
        """To go, by how far it has come since it began; None where it has hardly begun."""
        at, progress = self.at, self.progress
        if self._cool_down is not None:
            return max(0.0, self._cool_down.begun_s + self._cool_down.lasts_s - at.spent_s)
        if progress < LEAST_PROGRESS:
            return None
        return (at.spent_s - at.began_s) * (1.0 - progress) / progress

    def run(self, watching: Callbacks, until: float = 1.0) -> None:
        """Train to the end, until stopped and settled, or until time is up.

        Parameters
        ----------
        until
            Progress to wait at, 0 to 1: called again, it goes on.

        Raises
        ------
        ReconstructionError
            The training came to nothing: too many steps without numbers, or no memory at all.
        OperationCancelled
            From the monitor; the state is on the disk then.
        """
        with torch_threads(self.config.threads):
            try:
                self._run(watching, until)
            except OperationCancelled:
                self.save()
                raise

    def _run(self, watching: Callbacks, until: float) -> None:
        self.model.train()
        self._score(watching)
        self._visit(watching)
        while not self._is_settled(watching) and self.progress < 1.0:
            if self.progress >= until:
                self._bring(moments=True)
                return
            self._report(watching)
            self._wait(watching)
            begun_s = self._watch()
            self._survived_step()
            self._fit_window(self._watch() - begun_s)
            self._visit(watching)
            if self.at.spent_s - self.at.scored_at_s >= self.config.score_every_s:
                self._score(watching)
            if self.at.spent_s - self.at.saved_at_s >= self.config.checkpoint_every_s:
                self.save()
        self._bring(moments=True)
        self.model.finish(self.config.reflections)
        self._score(watching)
        self.at.spent_s = self._watch()
        self._visit(watching)

    def _report(self, watching: Callbacks) -> None:
        cool_down = self._cool_down
        if cool_down is None:
            watching.monitor.report(say("training"), self.progress, 1.0)
        else:
            watching.monitor.report(say("settling"), cool_down.share(self.at.spent_s), 1.0)

    def _wait(self, watching: Callbacks) -> None:
        with self._watch.paused():
            while watching.pause():
                watching.monitor.report(say("paused"), self.progress, 1.0)
                self._visit(watching, "paused")
                time.sleep(PAUSE_S)

    def _visit(self, watching: Callbacks, state: SnapshotState = "training") -> None:
        """Let somebody look at the model as it is."""
        if watching.visit is None or not self._ranks.is_first:
            return
        at, was_training = self.at, self.model.training
        if state != "training" or self._watch() - self._brought_s >= FRESH_S:
            self._bring(moments=state != "training")
        state = "settling" if self._cool_down is not None and state == "training" else state
        self.model.eval()
        watching.visit(
            TrainingSnapshot(
                self.model,
                self.exposures,
                self._record,
                state,
                at.step,
                self._watch(),
                self.progress,
                self._left_s(),
                {**self._terms},
                tuple(at.history),
                self._settings,
            )
        )
        self.model.train(was_training)

    def _is_settled(self, watching: Callbacks) -> bool:
        """Whether it was stopped, and its rates have fallen; all processes know what the first one has spent."""
        numbers = [self._watch(), self._needed_s(), float(watching.stop())]
        self.at.spent_s, self._reserve_s, is_stopped = self._ranks.agreed(numbers)
        if is_stopped and self._cool_down is None:
            self._cool_down = CoolDown(self.progress, self.at.spent_s)
        return self._cool_down is not None and self._cool_down.share(self.at.spent_s) >= 1.0

    def _fit_window(self, step_s: float) -> None:
        """Make windows smaller, once, where the time limit leaves room for too few steps, by how long a step took."""
        at, limit_s = self.at, self.config.time_limit_s
        if limit_s is None or self._ranks.n > 1 or len(self._step_s) == TIMED_STEPS:
            return
        self._step_s.append(step_s)
        if len(self._step_s) < TIMED_STEPS or at.window_px < self.config.window_px:
            return
        step_s = max(statistics.median(self._step_s), 1e-9)
        n_steps = at.step + max(0.0, limit_s - self._watch() - self._reserve_s) / step_s
        smaller = fitting_window_px(self.n_pixels, n_steps)
        if smaller < self.n_pixels:
            at.window_px = self.photos.window_px = smaller
            at.notes.append(
                say(
                    "windows of photos have {} pixels, because only {:.0f} steps with {} would fit into the time",
                    smaller,
                    n_steps,
                    self.n_pixels,
                )
            )

    def _needed_s(self) -> float:
        """For the last looks at the quality, and for writing the model."""
        look_s, save_s = (self._watch.lasted_s.get(part, 0.0) for part in ("look", "save"))
        return look_s + min(self.final_scoring_s(), self.most_final_scoring_s()) + WRITTEN * save_s

    def final_scoring_s(self) -> float:
        """That it would take to look at all held-out views in full, judged by what looks have taken."""
        seen_px = sum(held_out.sample.facade.numel() for held_out in self.shown)
        return self._watch.lasted_s.get("look", 0.0) * self._last_px / max(seen_px, 1)

    def most_final_scoring_s(self) -> float:
        """For that, at most."""
        limit_s = self.config.time_limit_s
        return math.inf if limit_s is None else LAST_SHARE * limit_s

    def _survived_step(self) -> None:
        try:
            self.step()
        except NotFinite as error:
            self.undo(str(error))
        except DeviceFailed as error:
            self._leave_card(error)
        except (MemoryError, RuntimeError) as error:
            # One process alone cannot take a step again.
            if not is_out_of_memory(error) or self._ranks.n > 1:
                raise
            self.shrink(error)

    def step(self) -> dict[str, float]:
        """One step; what each term of the loss was.

        Raises
        ------
        NotFinite
            The loss or a gradient is no number; parameters are as they were.
        """
        at, config, splats = self.at, self.config, self.model.splats
        samples = [self.photos.sample(self.generator) for _ in range(self._ranks.n)]
        sample = on_device(samples[self._ranks.rank], self.device)
        self.n_pixels = sample.facade.numel()
        cool_down = self._cool_down
        falling = self.progress if cool_down is None else cool_down.progress_of_rates(at.spent_s)
        set_rates(self.optimiser, config.rates, at.step, max(self.progress, falling), at.factor)
        self.poses.settle(config.own_poses, self.progress, at.step * self._ranks.n, config.rates.poses)
        move = self.poses(sample.number) if self.poses.is_learned(config.own_poses, sample.number) else None
        glass = self.model.light
        more = None if glass is None else glass.regulariser(config.reflections, at.step)
        self.optimiser.zero_grad(set_to_none=True)
        is_growing = cool_down is None and config.densify_from <= self.progress < config.densify_until
        strategy = self.strategy if is_growing else self._no_more
        stage = config.losses.stage(self.progress) if self._with_glass else None
        weight = 0.0 if stage is None else stage.weight
        self.transients.settle(config.transients, self.progress)
        looked_at = replace(sample, shown=self.transients.lasting(sample)) if config.transients != "off" else sample
        is_looked_at = self.transients.are_looked_for(config.transients)
        card = self._card_step()
        if card is not None:
            found, terms = card.gradients(
                looked_at, self.exposures(sample.number), move, config.degree_at(self.progress), self._settings,
                config.losses, self.progress, self._jitter(), more, is_looked_at=is_looked_at,
            )  # fmt: skip
            self._require_finite(None)
            if found.looked_at is not None:
                self.transients.see(sample, *found.looked_at, self.progress)
            self.is_editing = True
            self._learn_on(card, found, strategy, 1.0 + weight)
        else:
            offsets = torch.zeros(len(splats), 2, device=self.device, requires_grad=True)
            picture = self.picture(sample, self.exposures(sample.number), offsets, move)
            terms = self._gradients(picture, looked_at, more)
            if is_looked_at:
                self.transients.see(sample, picture.display, picture.raster.surface_depths_m, self.progress)
            self.is_editing = True
            observe_pictures(strategy, picture.raster, offsets, samples, self._ranks, weight)
            strategy.before_step(at.step, splats, self.optimiser)
            take_step(self.optimiser, splats, config.rates)
            strategy.after_step(at.step, splats, self.optimiser, self.generator)
        self.exposures.project()
        self.poses.project()
        self.optimiser.zero_grad(set_to_none=True)
        if glass is not None:
            glass.after_step(config.reflections, at.step, 1.0)
        self.is_editing = False
        at.step += 1
        self._terms = terms
        return terms

    def _gradients(self, picture: Picture, sample: Sample, more: Tensor | None) -> dict[str, float]:
        """Gradients of a picture's loss; what each term of it was."""
        loss, terms = objective(picture, sample, self.config.losses, self.progress, self._with_glass)
        loss = loss if more is None else loss + more
        loss.backward()  # type: ignore[no-untyped-call]
        self._require_finite(loss.detach())
        return terms

    def _require_finite(self, loss: Tensor | None) -> None:
        """See that a step can be taken, by all processes; without a loss, which somebody has looked at."""
        parameters = [value for group in self.optimiser.param_groups for value in group["params"]]
        known = torch.zeros((), device=self.device) if loss is None else loss
        require_finite(self._ranks.average_gradients(parameters, known), parameters)

    # Splats that a graphics card holds: what is learned lies there, and comes back when somebody asks for it.

    def _card_step(self) -> CardStep | None:
        """What takes steps on the card; None where the processor does."""
        if self._by_card and self._card is None:
            self._card = CardStep(open_device(), self.model, self.optimiser)
        return self._card

    def _learn_on(self, card: CardStep, found: CardGradients, strategy: Densification, pulled: float) -> None:
        """A step of Adam on the card, and of what else is learned here; splats are added here, too."""
        at, is_changed = self.at, strategy.changes_after(self.at.step)
        limits = strategy.limits
        card.learn(
            found, self.config.rates, strategy, limits, self.config.seed + SEEDS * (at.step + 1),
            observed=0.0 if strategy is self._no_more else pulled, jitters=not is_changed,
        )  # fmt: skip
        self.optimiser.step()
        if is_changed or card.n_since >= FRESH_STEPS:
            self._bring(moments=True)
        if is_changed:
            strategy.after_step(at.step, self.model.splats, self.optimiser, self.generator)
            self._card = None

    def _bring(self, *, moments: bool = False) -> None:
        """Bring what the card has learned of the splats; of what densification asks, too, with Adam's moments."""
        if self._card is None or not self._card.n_since:
            return
        self._brought_s = self._watch()
        try:
            self._card.bring(moments=moments)
            if moments:
                self._card.observed_by(self.strategy)
        except DeviceFailed as error:
            self._leave_card(error)

    def is_finite(self) -> bool:
        """Whether all parameters are numbers."""
        self._bring()
        return super().is_finite()

    def state(self) -> dict[str, Any]:
        """All that the training is; what comes from the clock is seconds only."""
        self._bring(moments=True)
        return super().state()

    def restore(self, state: dict[str, Any]) -> None:
        """Go on from a state, bit by bit where the processor does all the work."""
        super().restore(state)
        self._card = None

    def picture(
        self, sample: Sample, gain: Tensor | float, offsets: Tensor | None = None, move: Tensor | None = None
    ) -> Picture:
        """What the model shows where a photo was taken, or is found to be; with `offsets` as a step looks at it."""
        try:
            return self._drawn(sample, gain, offsets, move)
        except DeviceFailed as error:
            self._leave_card(error)
            return self._drawn(sample, gain, offsets, move)

    def _leave_card(self, error: DeviceFailed) -> None:
        """Go on with the processor: nothing of the step was taken yet.

        Where the card does not even answer what it has learned of the splats, they are what they were when it was last
        asked.
        """
        self._settings, self._by_card, card, self._card = replace(self._settings, on_gpu=False), False, self._card, None
        self.optimiser.zero_grad(set_to_none=True)
        self.is_editing = False
        self.at.notes.append(say("from step {} on splats were drawn by the processor: {}", self.at.step + 1, error))
        if card is None or not card.n_since:
            return
        try:
            card.bring(moments=True)
        except DeviceFailed:
            self.at.notes.append(say("what splats learned in the {} steps before was lost with it", card.n_since))

    def _drawn(self, sample: Sample, gain: Tensor | float, offsets: Tensor | None, move: Tensor | None) -> Picture:
        picture: Picture = self.model(
            sample.view,
            gain,
            self.config.degree_at(self.progress),
            settings=self._settings,
            screen_offsets=offsets,
            generator=None if offsets is None else self._jitter(),
            move=move,
        )
        return picture

    def _jitter(self) -> torch.Generator:
        """Of places within pixels: another one in each step and process, without a state of its own."""
        number = self.at.step * self._ranks.n + self._ranks.rank
        return torch.Generator().manual_seed(self.config.seed + SEEDS * (number + 1))

    def _score(self, watching: Callbacks) -> None:
        """Measure the quality where it was not measured at this step, and show it."""
        at = self.at
        at.scored_at_s = at.spent_s
        if not self._ranks.is_first or not self.shown or at.scored_step == at.step:
            return
        at.scored_step = at.step
        self._bring()

        def displayed(held_out: HeldOut) -> Tensor:
            self._report(watching)
            display = self._displayed(held_out)
            if held_out is self.shown[0] and watching.preview is not None:
                watching.preview(Preview(at.step, (255.0 * display).round().to(torch.uint8).cpu().numpy()))
            return display

        was_training = self.model.training
        self.model.eval()
        with self._watch.timing("look"):
            at.history.append((at.spent_s, quality_db(self.shown, displayed)))
        self.model.train(was_training)
        if watching.trace is not None:
            watching.trace.record(at.history[-1][1])

    def _displayed(self, held_out: HeldOut) -> Tensor:
        return self.picture(on_device(held_out.sample, self.device), held_out.gain).display.clamp(0.0, 1.0)

    def qualities_db(self, views: Sequence[HeldOut]) -> list[float]:
        """PSNR, dB, of each view by itself, as `quality_db` has it."""
        was_training = self.model.training
        self._bring()
        self.model.eval()
        found = [quality_db([view], self._displayed) for view in views]
        self.model.train(was_training)
        return found

    def save(self) -> None:
        """Write a checkpoint; of a state that is no good, none."""
        if self.path is None or not self._ranks.is_first or not self.is_finite():
            return
        self.at.saved_at_s = self.at.spent_s
        with self._watch.timing("save"):
            write_checkpoint(self.path, {"record": self._record, "training": self.state()})
