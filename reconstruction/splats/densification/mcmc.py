"""Densification as Markov chain Monte Carlo: dead splats go where opaque ones are, new ones too, and all jitter.

After Kheradmand et al., 3-D Gaussian splatting as Markov chain Monte Carlo, 2024: no thresholds, and the number of
splats is told. Two things differ. Splats here are discs, so sizes after a relocation keep what the disc covers (below),
and noise moves a splat within its own plane only. And noise is told in a splat's own sizes, not in scene units, so that
it means the same on every site.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor
from torch.optim import Optimizer

from planning.base.parameters import check, parameter
from reconstruction.splats.densification.strategy import (
    CUT,
    NO_CHANGES,
    NOTHING,
    BetweenChanges,
    Change,
    Limits,
    SplatStatistics,
    forget,
    keep_within,
    n_dead,
    rearrange,
    within,
)
from reconstruction.splats.rasterising.raster_types import Raster
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.splats import Splats, logit

MOST_COPIES = 50
"""Of one splat in one step, more than ever happen."""

GATE_AT, GATE_SLOPE = 0.005, 100.0
"""Opacity at which noise has half its strength, and how fast it ends above (the paper's 1 - 0.995, and 100)."""


LEAST_GATE = 1e-3
"""Share of the noise below which a splat stays where it is: opacity above 0.074."""


@dataclass(frozen=True, slots=True)
class McmcParameters:
    """Settings.

    Parameters
    ----------
    start, stop, every
        Steps between which, and after how many, splats are relocated and added.
    n_splats
        To which their number grows.
    growth
        Share that is added at a time.
    least_opacity
        At or below, a splat is dead and relocated; above the cut, so that none is stuck there.
    noise
        Standard deviation of the jitter of a see-through splat in one step, of its own; the paper's 5e5 times its
        learning rate times the variance is this for splats of a hundredth of the scene.
    opacity_weight, size_weight
        Of the mean opacity and the mean size, over the splats' median, in the loss: what nothing holds up fades. The
        paper's 0.01 cost 0.2 dB where there is no glass, on the one scene that was tried.
    """

    start: int = 500
    stop: int = 25_000
    every: int = 100
    n_splats: int = parameter(100_000, least=1)
    growth: float = parameter(0.05, least=0.0)
    least_opacity: float = parameter(0.01, above=CUT, below=1.0, expected="above 1/255 and below 1")
    noise: float = parameter(0.1, least=0.0)
    opacity_weight: float = parameter(0.002, least=0.0)
    size_weight: float = parameter(0.002, least=0.0)

    def __post_init__(self) -> None:
        check(self)
        if not (0 <= self.start <= self.stop and self.every >= 1):
            raise ValueError(f"expected 0 <= start <= stop, every >= 1, got {self.start}, {self.stop}, {self.every}")


class MarkovChain:
    """The strategy; see `reconstruction.splats.densification.strategy.Densification`."""

    def __init__(self, parameters: McmcParameters = McmcParameters(), limits: Limits | None = None) -> None:
        self.parameters = parameters
        self.limits = limits or Limits()
        self._seen = SplatStatistics.nothing(0, torch.device("cpu"))

    def before_step(self, step: int, splats: Splats, optimiser: Optimizer) -> None:
        """Add the gradients of mean opacity and mean size."""
        if not len(splats) or step >= self.parameters.stop:
            return
        between = self.between_changes(splats)
        opacities, sizes = splats.opacities.detach(), splats.scales.detach()
        _add_gradient(splats.opacity_logits, between.opacity_pull * opacities * (1.0 - opacities))
        _add_gradient(splats.log_scales, between.size_pull * sizes)

    def observe(self, raster: Raster, screen_gradients: Tensor | None, view: View) -> None:
        """Add up whether splats show."""
        self._seen = self._seen.before(raster)
        self._seen.add(raster, None, view)

    def take_in(self, seen: SplatStatistics) -> None:
        """Join it with what is known."""
        self._seen = self._seen.joined(seen)

    def between_changes(self, splats: Splats) -> BetweenChanges:
        """Mean opacity and mean size over the median pull, and all jitter."""
        chosen, sizes = self.parameters, splats.scales.detach()
        if not len(splats):
            return NO_CHANGES
        return BetweenChanges(
            chosen.opacity_weight / len(splats),
            chosen.size_weight / (sizes.numel() * float(sizes.median())),
            chosen.noise,
            GATE_AT,
            GATE_SLOPE,
            LEAST_GATE,
        )

    def changes_after(self, step: int) -> bool:
        """Every so many steps."""
        return (step + 1) % self.parameters.every == 0

    def after_step(self, step: int, splats: Splats, optimiser: Optimizer, generator: torch.Generator) -> Change:
        """Every so many steps, relocate the dead and add some; jitter all."""
        chosen = self.parameters
        keep_within(splats, self.limits)
        change = NOTHING
        if chosen.start <= step < chosen.stop and (step + 1) % chosen.every == 0 and len(self._seen) == len(splats):
            change = self._changed(splats, optimiser, generator)
            self._seen = SplatStatistics.nothing(len(splats), splats.means.device)
        if step < chosen.stop and chosen.noise > 0.0:
            self._jitter(splats, generator)
        return change

    def _changed(self, splats: Splats, optimiser: Optimizer, generator: torch.Generator) -> Change:
        chosen, n = self.parameters, len(splats)
        opacities = splats.opacities.detach()
        dead = (opacities <= chosen.least_opacity) | self._seen.is_hidden()
        dead |= self._seen.is_at_lens(splats, self.limits.clear_m)
        living = torch.nonzero(~dead)[:, 0]
        if not len(living):
            return Change(n_dead=n_dead(splats))
        most = min(chosen.n_splats, self.limits.n_most)
        n_added = max(0, min(most, math.ceil(n * (1.0 + chosen.growth))) - n)
        vacant = torch.cat([torch.nonzero(dead)[:, 0], n + torch.arange(n_added, device=dead.device)])
        if not len(vacant):
            return Change(n_dead=n_dead(splats))
        drawn = _drawn(opacities[living], len(vacant), generator)
        hosts = living[drawn]
        source = torch.arange(n + n_added, device=dead.device)
        source[vacant] = hosts
        is_new = torch.zeros(n + n_added, dtype=torch.bool, device=dead.device)
        is_new[vacant] = True
        copies = 1 + torch.bincount(hosts, minlength=n)
        rearrange(splats, optimiser, source, is_new)
        shared = torch.unique(hosts)
        opacity, size = shared_out(opacities[shared], torch.exp(splats.log_scales.data[shared]), copies[shared])
        lookup = torch.full((n,), -1, dtype=torch.int64, device=dead.device)
        lookup[shared] = torch.arange(len(shared), device=dead.device)
        for rows, which in ((shared, lookup[shared]), (vacant, lookup[hosts])):
            splats.opacity_logits.data[rows] = logit(opacity)[which]
            splats.log_scales.data[rows] = torch.log(size)[which]
        forget(splats, optimiser, splats.names, shared)
        keep_within(splats, self.limits)
        return Change(n_relocated=int(dead.sum()), n_added=n_added, n_dead=n_dead(splats))

    def _jitter(self, splats: Splats, generator: torch.Generator) -> None:
        gates = torch.sigmoid(GATE_SLOPE * (GATE_AT - splats.opacities.detach()))
        rows = torch.nonzero(gates > LEAST_GATE)[:, 0]
        steps = torch.randn(len(rows), splats.log_scales.shape[1], generator=generator).to(splats.means)
        splats.means.data[rows] += within(splats, rows, self.parameters.noise * gates[rows, None] * steps)

    def state_dict(self) -> dict[str, Tensor]:
        """Sums since the last change."""
        return self._seen.tensors()

    def load_state_dict(self, state: dict[str, Tensor]) -> None:
        """Go on from there."""
        self._seen = SplatStatistics.of(state)


def shared_out(opacities: Tensor, sizes: Tensor, copies: Tensor) -> tuple[Tensor, Tensor]:
    """Opacity and sizes of each of N equal splats in one place that together look like one.

    Opacity: 1 - (1 - a)^N = alpha (Kheradmand et al., 2024, Eq. 8). Size: what a disc covers, the integral of its
    opacity over its plane, stays. That of N discs one behind the other is 2 pi s_u s_v sum_{i=1}^N (1 - (1 - a)^i) / i:
    the paper's Eq. 9 with areas in place of lengths, its inner sum in closed form. Of an ellipsoid a camera sees a
    disc, too, whose area goes with the square of all its sizes.

    Parameters
    ----------
    opacities, sizes, copies
        alpha, shape (n,); sizes along the axes, shape (n, 2 or 3); N, shape (n,), at least 1.
    """
    copies = copies.clamp(1, MOST_COPIES)
    shared = 1.0 - (1.0 - opacities.clamp(max=1.0 - 1e-6)) ** (1.0 / copies)
    numbers = torch.arange(1, MOST_COPIES + 1, device=opacities.device)
    parts = (1.0 - (1.0 - shared[:, None]) ** numbers) / numbers
    covered = torch.where(numbers <= copies[:, None], parts, 0.0).sum(dim=1)
    return shared, sizes * torch.sqrt(opacities / covered)[:, None]


def _drawn(weights: Tensor, n: int, generator: torch.Generator) -> Tensor:
    """Shape (n,): rows with chances as weights have them, by their running sum; `multinomial` ends at 2^24 rows."""
    sums = torch.cumsum(weights.double(), dim=0)
    marks = torch.rand(n, generator=generator, dtype=torch.float64).to(sums) * sums[-1]
    return torch.searchsorted(sums, marks).clamp(max=len(weights) - 1)


def _add_gradient(parameter: Tensor, gradient: Tensor) -> None:
    parameter.grad = gradient if parameter.grad is None else parameter.grad + gradient
