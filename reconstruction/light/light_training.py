"""Steps of Adam on random batches of glass rays, kept alive, and kept so that they go on bit by bit.

What can go wrong and what becomes of it:

- a loss or weights that are no numbers: back to the last good state, at most `KEPT_EVERY` steps ago, and all rates are
  halved; after `MOST_HALVINGS` of them the training ends with an error;
- no memory: batches are halved, and the step is taken again;
- the user cancels: the state is written before `OperationCancelled` goes on.
"""

from __future__ import annotations

import copy
import math
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field, fields
from typing import Any

import msgspec
import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from planning.base.effects import Decision, decide
from planning.base.errors import OperationCancelled, ReconstructionError
from planning.base.messages import say
from planning.base.progress import QUIET, Clock, Monitor
from reconstruction.base.adam import Adam
from reconstruction.base.out_of_memory import NotFinite, is_out_of_memory
from reconstruction.light.config import Precision, ReflectionConfig
from reconstruction.light.glass_light import BOWS_TRIED, UNKNOWN, BowedPanes
from reconstruction.light.glass_rays import GlassRays
from reconstruction.light.losses import no_brighter, ray_errors, ray_loss
from reconstruction.light.radiance_grid import RadianceGrid
from reconstruction.light.reflective_panels import ReflectivePanels
from reconstruction.light.transients import TRIED, UNSEEN, Blocks, LeaveTransientsOut, Seen, transient_blocks

MOST_HALVINGS = 8
"""Of the rates, over a whole training: beyond, they are so small that nothing is learned any more."""

KEPT_EVERY = 100
"""Steps from one good state in memory to the next: copying it takes about as long as a step."""

MOST_LOOKED_AT, LOOKED_AT = 1 << 18, 1 << 14
"""Rays that transients are looked for by, and those of them that are shaded at once."""

LOOK_EVERY_S, LOOK_SHARE = 10.0, 0.05
"""Seconds from one look at what is learned so far to the next, at least, and the largest share of time for it."""

LEAST_BATCH = 32
"""Rays; where there is no memory for so few, there is none for the model."""

BETAS = (0.9, 0.99)
"""Of Adam; the second is shorter than usual, as batches are large and trainings short."""


@dataclass(frozen=True, slots=True, eq=False)
class CheckpointSettings:
    """How a training's state is kept.

    Parameters
    ----------
    write
        Called with the state now and then, and when the user cancels.
    every_s
        Seconds of training from one call to the next.
    before
        State to go on from; None to begin.
    """

    write: Callable[[dict[str, Any]], None]
    every_s: float = math.inf
    before: dict[str, Any] | None = None


@dataclass(slots=True, eq=False)
class LightProgress:
    """Where a training stands; what its state has besides tensors."""

    batch: int
    step: int = 0
    spent_s: float = 0.0
    kept_at_s: float = 0.0
    factor: float = 1.0
    n_undone: int = 0
    transients: float = UNSEEN
    bowed_px: float = UNKNOWN
    history: list[tuple[float, float]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


class LightTraining:
    """A training of one model on rays.

    Parameters
    ----------
    panels
        Untrained.
    config
        As the model needs it, `for_grid` for a radiance grid.
    generator
        Of the batches and the places within pixels.
    """

    def __init__(
        self,
        panels: ReflectivePanels,
        rays: GlassRays,
        config: ReflectionConfig,
        precision: Precision,
        generator: torch.Generator,
        keeping: CheckpointSettings | None = None,
        device: str = "cpu",
        clock: Clock = time.perf_counter,
    ) -> None:
        self.device = torch.device(device)
        # A grid grows: states of coarser ones are put into copies of what it was at first.
        self._first = panels
        self.panels = copy.deepcopy(panels).to(self.device)
        self.rays = self._all = on_device(rays, self.device)
        self.config, self.transients = config, np.zeros(0, np.bool_)
        self.precision, self.generator = precision, generator
        self.at = LightProgress(config.batch)
        self.n_steps = config.steps_for(len(rays))
        self.optimiser = _optimiser(self.panels, config)
        self._keeping, self._clock, self._is_editing = keeping, clock, False
        if keeping is not None and keeping.before is not None:
            self.restore(keeping.before)
        self._good = copy.deepcopy(self.state())

    @property
    def progress(self) -> float:
        """Of the training, 0 to 1: by steps or by time, whichever is further."""
        by_time = 0.0 if self.config.time_limit_s is None else self.at.spent_s / self.config.time_limit_s
        return min(1.0, max(self.at.step / self.n_steps, by_time))

    def run(
        self,
        quality: Callable[[ReflectivePanels], float] | None,
        every: int,
        monitor: Monitor = QUIET,
        look: Callable[[ReflectivePanels], object] | None = None,
    ) -> None:
        """Train to the end, or until time is up.

        Parameters
        ----------
        quality
            For the history, asked after every so many steps, which takes no time of the training's.
        look
            Called with a finished copy now and then, `LOOK_SHARE` of the time at most.

        Raises
        ------
        ReconstructionError
            It came to nothing: too many steps without numbers, or no memory at all.
        OperationCancelled
            From `monitor`; the state is kept then.
        """
        at = self.at
        look_at_s = at.spent_s + LOOK_EVERY_S
        while self.progress < 1.0:
            try:
                monitor.report(say("learning reflections"), at.step, self.n_steps)
            except OperationCancelled:
                self._keep()
                raise
            begun_s = self._clock()
            self._survived_step()
            at.spent_s += self._clock() - begun_s
            if self._keeping is not None and at.spent_s - at.kept_at_s >= self._keeping.every_s:
                self._keep()
            if quality is not None and (at.step % every == 0 or self.progress >= 1.0):
                self.panels.eval()
                at.history.append((at.spent_s, quality(self.panels)))
                self.panels.train()
            if look is not None and at.spent_s >= look_at_s:
                begun_s = self._clock()
                look(self._finished(copy.deepcopy(self.panels)))
                look_at_s = at.spent_s + max(LOOK_EVERY_S, (self._clock() - begun_s) / LOOK_SHARE)
        begun_s = self._clock()
        self._finished(self.panels)
        at.spent_s += self._clock() - begun_s

    def _finished(self, panels: ReflectivePanels) -> ReflectivePanels:
        if panels.light is not None:
            panels.light.finish(self.config)
        return panels.cpu().eval()

    def step(self) -> None:
        """One step.

        Raises
        ------
        NotFinite
            The loss is no number, or the weights are none; the weights may be spoiled.
        """
        at, config, panels = self.at, self.config, self.panels
        progress = self.progress
        for group in self.optimiser.param_groups:
            group["lr"] = at.factor * group["rate"] * config.rate(at.step, progress)
        if progress >= TRIED:
            self._leave_out_transients()
        if progress >= BOWS_TRIED:
            self._settle_bows()
        rows = torch.randint(len(self.rays), (at.batch,), generator=self.generator)
        batch = self.rays[rows.to(self.device)]
        with torch.autocast(self.device.type, torch.bfloat16, enabled=self.precision == "bfloat16"):
            colours = panels(batch, generator=self.generator)
        truth = batch.display
        colours = no_brighter(colours, truth, config.white)
        loss = ray_loss(ray_errors(colours, truth, config.squared_to), config.stage(progress))
        more = None if panels.light is None else panels.light.regulariser(config, at.step)
        loss = loss if more is None else loss + more
        if not bool(torch.isfinite(loss)):
            raise NotFinite(say("the loss is not a number"))
        self.optimiser.zero_grad(set_to_none=True)
        loss.backward()  # type: ignore[no-untyped-call]
        self._is_editing = True
        self.optimiser.step()
        at.step += 1
        has_grown = False
        if panels.light is not None:
            has_grown = panels.light.after_step(config, at.step - 1, max(at.step / self.n_steps, progress))
        if has_grown:
            self.optimiser = _optimiser(panels, config, self.optimiser)
        self._is_editing = False
        if has_grown or at.step % KEPT_EVERY == 0 or at.step == self.n_steps:
            if not self._is_finite():
                raise NotFinite(say("a weight is not a number"))
            self._good = copy.deepcopy(self.state())

    def _settle_bows(self) -> None:
        """Decide, once, whether panes stay bowed; those of a model that was asked for by itself do."""
        at, light, config = self.at, self.panels.light, self.config
        if at.bowed_px != UNKNOWN or config.learned is not None or light is None or light.bows is None:
            return
        at.bowed_px = light.bowed_px(self.rays)
        if not decide(BowedPanes(), at.bowed_px, config.bows).on:
            light.flatten()
            self.optimiser = _optimiser(self.panels, config, self.optimiser)

    def decisions(self) -> tuple[Decision, ...]:
        """About what was tried on the way."""
        light, config = self._first.light, self.config
        if config.learned is not None or light is None or not isinstance(light.light, RadianceGrid):
            return ()
        return (decide(BowedPanes(), self.at.bowed_px, config.bows),)

    @torch.no_grad()
    def _leave_out_transients(self) -> None:
        """Look for transients, once, and go on without their rays where they are worth it."""
        at, setting = self.at, self.config.transients
        if setting == "off" or at.transients != UNSEEN:
            return
        self.panels.eval()
        chosen = self._all[:: max(1, len(self._all) // MOST_LOOKED_AT)]
        parts = [chosen[start : start + LOOKED_AT] for start in range(0, len(chosen), LOOKED_AT)]
        errors = torch.cat(
            [no_brighter(self.panels(part), part.display, self.config.white) - part.display for part in parts]
        )
        self.panels.train()
        blocks = _blocks(self._all)
        found, at.transients = transient_blocks(
            blocks,
            _blocks_of(blocks, chosen),
            errors.float().cpu().numpy(),
            torch.cat([part.middle().points for part in parts]).double().cpu().numpy(),
        )
        if decide(LeaveTransientsOut(), Seen(at.transients, 0.0), setting).on:
            self._without(found)

    def _without(self, transients: NDArray[np.bool_]) -> None:
        """Go on with the rays of other blocks; with all where no rays would be left."""
        if not len(transients):
            return
        lasting = torch.from_numpy(~transients[_blocks_of(_blocks(self._all), self._all)]).to(self.device)
        if bool(lasting.any()):
            self.rays, self.transients = self._all[lasting], transients

    def state(self) -> dict[str, Any]:
        """All that the training is; what comes from the clock is seconds only."""
        grids = _grids(self.panels)
        return {
            "panels": self.panels.state_dict(),
            "levels": [grid.level for grid in grids],
            "empty places": [torch.from_numpy(grid.skips) for grid in grids],
            "adam": self.optimiser.state_dict(),
            "generator": self.generator.get_state(),
            "precision": self.precision,
            "transients": torch.from_numpy(self.transients),
            "progress": asdict(self.at),
        }

    def restore(self, state: dict[str, Any]) -> None:
        """Go on from a state, bit by bit.

        Raises
        ------
        ValueError
            It is that of another model.
        """
        state = copy.deepcopy(state)
        panels = copy.deepcopy(self._first)
        try:
            for grid, level in zip(_grids(panels), state["levels"], strict=True):
                while grid.level > level >= 0:
                    grid.grow()
            if panels.light is not None and "light.bows" not in state["panels"]:
                panels.light.flatten()
            panels.load_state_dict(state["panels"])
            for grid, empty in zip(_grids(panels), state["empty places"], strict=True):
                if tuple(empty.shape) != grid.skips.shape or empty.dtype != torch.uint8:
                    raise ValueError("empty places of another grid")
                grid.skips = empty.numpy()
            optimiser = _optimiser(panels.to(self.device), self.config)
            optimiser.load_state_dict(state["adam"])
            self.generator.set_state(state["generator"])
            self.at = msgspec.convert(state["progress"], LightProgress)
            self.precision = msgspec.convert(state["precision"], Precision)
        except (KeyError, ValueError, TypeError, RuntimeError, AttributeError) as error:
            raise ValueError(f"the state is that of another model ({error})") from error
        self.panels, self.optimiser = panels, optimiser
        self._without(state["transients"].numpy())

    def _survived_step(self) -> None:
        try:
            self.step()
        except NotFinite as error:
            self._undo(str(error))
        except (MemoryError, RuntimeError) as error:
            if not is_out_of_memory(error):
                raise
            self._shrink(error)

    def _undo(self, reason: str) -> None:
        kept = self.at
        kept.n_undone += 1
        kept.factor *= 0.5
        if kept.n_undone > MOST_HALVINGS:
            raise ReconstructionError(
                say(
                    "learning reflections failed: {} at step {} of {}; lower the learning rates",
                    reason,
                    kept.step + 1,
                    self.n_steps,
                )
            )
        kept.notes.append(
            say("learning light: {} at step {}; all rates are halved from there on", reason, kept.step + 1)
        )
        self._go_back()

    def _shrink(self, error: BaseException) -> None:
        at = self.at
        self.optimiser.zero_grad(set_to_none=True)
        smaller = at.batch // 2
        if smaller < LEAST_BATCH:
            raise ReconstructionError(
                say(
                    "learning reflections failed: there is no memory for batches of {} rays at step {} of {}; choose "
                    "a smaller model",
                    at.batch,
                    at.step + 1,
                    self.n_steps,
                )
            ) from error
        at.batch = smaller
        at.notes.append(
            say("learning light: memory ran out at step {}; batches have {} rays from there", at.step + 1, smaller)
        )
        if self._is_editing:
            self._go_back()

    def _go_back(self) -> None:
        """To the last good state, with the rates, batches, notes, history and time of now."""
        kept = self.at
        self.restore(self._good)
        kept.step, self.at = self.at.step, kept
        self._is_editing = False

    def _keep(self) -> None:
        """Write the state; of weights that are no numbers, the last good one."""
        if self._keeping is not None:
            self.at.kept_at_s = self.at.spent_s
            self._keeping.write(self.state() if self._is_finite() else self._good)

    def _is_finite(self) -> bool:
        return all(bool(torch.isfinite(value).all()) for value in self.panels.parameters())


def on_device(rays: GlassRays, device: torch.device) -> GlassRays:
    """The same rays in the memory of a device."""
    if device.type == "cpu":
        return rays
    return GlassRays(*(getattr(rays, each.name).to(device) for each in fields(rays)))


def _grids(panels: ReflectivePanels) -> list[RadianceGrid]:
    return [module for module in panels.modules() if isinstance(module, RadianceGrid)]


def _optimiser(panels: ReflectivePanels, config: ReflectionConfig, before: Adam | None = None) -> Adam:
    """With what one `before` remembers of the parameters that are still there."""
    own: list[Tensor] = [panels.corner_loss]
    groups: list[dict[str, Any]] = [{"params": [*panels.diffuse.parameters()], "lr": config.table_rate}]
    if panels.light is not None:
        own += [panels.reflectivity, panels.base_reflectance]
        groups += panels.light.parameter_groups(config)
    groups.append({"params": own, "lr": config.panel_rate})
    groups = [{**group, "rate": group["lr"]} for group in groups]
    optimiser = Adam(groups, betas=BETAS)
    for group in optimiser.param_groups if before is not None else ():
        for value in group["params"]:
            if before is not None and value in before.state:
                optimiser.state[value] = before.state[value]
    return optimiser


def _blocks(rays: GlassRays) -> Blocks:
    """Of the photos that rays are of."""
    return Blocks([(int(width), int(height)) for width, height in rays.table.lenses[:, 4:6].cpu().numpy()])


def _blocks_of(blocks: Blocks, rays: GlassRays) -> NDArray[np.int64]:
    photos, columns, rows = (value.cpu().numpy().astype(np.int64) for value in (rays.photos, rays.columns, rays.rows))
    return blocks.at(photos, columns, rows)
