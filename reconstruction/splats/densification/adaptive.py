"""Adaptive density control: splats that the photos pull at are cloned or split, those that do nothing go.

After 3-D and 2-D Gaussian splatting (Kerbl et al., 2023, 5.2; Huang et al., 2024), with changes for what their users
report: gradients count alike whatever the window or size of the picture; halves of a split splat and clones take the
place of the one, so that the picture stays; opacity is reset to well above the cut below which nothing learns;
needles and splats at a camera's lens are not tolerated (`Limits`); and the number of splats has an end.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import torch
from torch import Tensor
from torch.optim import Optimizer

from planning.base.messages import say
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

APART, CHILD, SHARE = 0.6, 0.77, 0.7
"""How far the two halves of a splat are from its middle and their size, of its standard deviation along its longer
axis, and their opacity, of its own. Chosen so that both look like the one: 5 to 10 % of its light is in another place,
and of halves put at random and 1 / 1.6 as large, as in 3DGS, 80 %.
"""

CLONE_APART = 0.3
"""How far twins are put from where the one was, standard deviations: in the same place both would learn the same."""


@dataclass(frozen=True, slots=True)
class AdaptiveParameters:
    """Settings of adaptive density control.

    Parameters
    ----------
    start, stop, every
        Steps between which, and after how many, splats are cloned, split and pruned.
    gradient
        Change of a picture's summed error per pixel that a splat is moved in it, mean over the pictures it is in, from
        which on there is too much to do for one splat. 2DGS has 0.0002 of the mean error per half picture, which is
        this in photos 500 pixels high; told that way, small pictures would be filled with splats far below a pixel.
    least_px, split_px
        Standard deviations in the picture up to which a splat is left alone, and from which on it is split; those in
        between are cloned. The smallest that is ever drawn is 0.71 pixels: more of those would show nothing more, and
        where edges pull at them they would become ever more.
    least_opacity
        Below, a splat is pruned.
    reset_every, reset_opacity
        After so many steps opacities are lowered to at most this, so that floaters, which nobody needs, can fade; 0 for
        never. It is above `least_opacity` by far: at 3DGS' 0.01 splats sink below the cut, 1/255, and are lost.
    grace
        Steps after a reset in which nothing is pruned for its opacity.
    """

    start: int = parameter(500, least=0)
    stop: int = parameter(15_000, least=0)
    every: int = parameter(100, least=1)
    gradient: float = parameter(0.2, above=0.0)
    least_px: float = parameter(0.72, least=0.0)
    split_px: float = parameter(1.5, least=0.0)
    least_opacity: float = parameter(0.02, above=CUT, below=1.0)
    reset_every: int = parameter(3000, least=0)
    reset_opacity: float = parameter(0.1, above=CUT, below=1.0)
    grace: int = parameter(300, least=0)

    def __post_init__(self) -> None:
        check(self)
        for low, high in (("start", "stop"), ("least_px", "split_px"), ("least_opacity", "reset_opacity")):
            least, most = getattr(self, low), getattr(self, high)
            if least > most:
                raise ValueError(say("expected no more than {}, {:g}, got {:g}", high, most, least, place=low))


class AdaptiveControl:
    """The strategy; see `reconstruction.splats.densification.strategy.Densification`."""

    def __init__(self, parameters: AdaptiveParameters = AdaptiveParameters(), limits: Limits | None = None) -> None:
        self.parameters = parameters
        self.limits = limits or Limits()
        self._since_reset = parameters.grace
        self._seen = SplatStatistics.nothing(0, torch.device("cpu"))

    def before_step(self, step: int, splats: Splats, optimiser: Optimizer) -> None:
        """Nothing to add."""

    def observe(self, raster: Raster, screen_gradients: Tensor | None, view: View) -> None:
        """Add up what the pictures say about each splat."""
        self._seen = self._seen.before(raster)
        self._seen.add(raster, screen_gradients, view)

    def take_in(self, seen: SplatStatistics) -> None:
        """Join it with what is known."""
        self._seen = self._seen.joined(seen)

    def between_changes(self, splats: Splats) -> BetweenChanges:
        """Nothing."""
        return NO_CHANGES

    def changes_after(self, step: int) -> bool:
        """Every so many steps, and where opacities are reset or soon were."""
        chosen = self.parameters
        is_reset = chosen.reset_every > 0 and (step + 1) % chosen.reset_every == 0
        return is_reset or (step + 1) % chosen.every == 0 or self._since_reset < chosen.grace

    def after_step(self, step: int, splats: Splats, optimiser: Optimizer, generator: torch.Generator) -> Change:
        """Every so many steps, prune and then clone and split; now and then, reset opacities."""
        chosen = self.parameters
        keep_within(splats, self.limits)
        self._since_reset += 1
        if not chosen.start <= step < chosen.stop:
            self._seen = SplatStatistics.nothing(0, splats.means.device)
            return NOTHING
        change = NOTHING
        if (step + 1) % chosen.every == 0 and len(self._seen) == len(splats):
            change = self._changed(splats, optimiser, generator)
            self._seen = SplatStatistics.nothing(len(splats), splats.means.device)
        if chosen.reset_every and (step + 1) % chosen.reset_every == 0:
            splats.opacity_logits.data.clamp_(max=math.log(chosen.reset_opacity / (1.0 - chosen.reset_opacity)))
            forget(splats, optimiser, ("opacity_logits",))
            self._since_reset = 0
            change = replace(change, is_reset=True)
        return change

    def _changed(self, splats: Splats, optimiser: Optimizer, generator: torch.Generator) -> Change:
        chosen, seen = self.parameters, self._seen
        useless = seen.is_hidden() | seen.is_at_lens(splats, self.limits.clear_m)
        if self._since_reset >= chosen.grace:
            useless |= splats.opacities.detach() < chosen.least_opacity
        n_kept = int((~useless).sum())
        if not n_kept:  # a training that has failed is not made worse
            return Change(n_dead=n_dead(splats))
        pulls = seen.mean_pulls()
        wanted = torch.nonzero((pulls > chosen.gradient) & (seen.sigmas_px > chosen.least_px) & ~useless)[:, 0]
        room = max(0, self.limits.n_most - n_kept)
        if len(wanted) > room:
            strongest = torch.argsort(pulls[wanted], descending=True, stable=True)[:room]
            wanted = wanted[strongest].sort().values
        is_large = seen.sigmas_px[wanted] > chosen.split_px
        kept = torch.nonzero(~useless)[:, 0]
        source = torch.cat([kept, wanted])
        is_new = torch.arange(len(source), device=source.device) >= len(kept)
        rearrange(splats, optimiser, source, is_new)
        new_place = torch.full((len(useless),), -1, dtype=torch.int64, device=source.device)
        new_place[kept] = torch.arange(len(kept), device=source.device)
        first, second = new_place[wanted], len(kept) + torch.arange(len(wanted), device=source.device)
        _split(splats, optimiser, first[is_large], second[is_large])
        _clone(splats, optimiser, first[~is_large], second[~is_large], generator)
        keep_within(splats, self.limits)
        n_split = int(is_large.sum())
        return Change(
            n_cloned=len(wanted) - n_split, n_split=n_split, n_pruned=int(useless.sum()), n_dead=n_dead(splats)
        )

    def state_dict(self) -> dict[str, Tensor]:
        """Sums since the last change, and when opacities were reset."""
        return {**self._seen.tensors(), "since_reset": torch.tensor(self._since_reset)}

    def load_state_dict(self, state: dict[str, Tensor]) -> None:
        """Go on from there."""
        self._since_reset = int(state["since_reset"])
        self._seen = SplatStatistics.of(state)


def _split(splats: Splats, optimiser: Optimizer, first: Tensor, second: Tensor) -> None:
    """Let two equal splats be the halves of what they were, along its longest axis."""
    if not len(first):
        return
    sizes = splats.log_scales.data[first]
    longest = sizes.argmax(dim=1)
    steps = APART * torch.nn.functional.one_hot(longest, sizes.shape[1]).to(splats.means)
    displacement = within(splats, first, steps)
    splats.means.data[first] += displacement
    splats.means.data[second] -= displacement
    opacity = logit(SHARE * splats.opacities.detach()[first])
    for rows in (first, second):
        splats.log_scales.data[rows, longest] += math.log(CHILD)
        splats.opacity_logits.data[rows] = opacity
    forget(splats, optimiser, splats.names, first)


def _clone(splats: Splats, optimiser: Optimizer, first: Tensor, second: Tensor, generator: torch.Generator) -> None:
    """Put two equal splats beside each other, along their axes; both together cover what one did.

    The integral of 1 - (1 - a G)^2 over the plane of a disc G is that of alpha G for 2 a - a^2 / 2 = alpha. (With
    1 - (1 - a)^2 = alpha only the middle keeps its opacity, and the disc becomes wider.)
    """
    if not len(first):
        return
    steps = CLONE_APART * torch.randn(len(first), splats.log_scales.shape[1], generator=generator).to(splats.means)
    displacement = within(splats, first, steps)
    splats.means.data[first] += displacement
    splats.means.data[second] -= displacement
    shared = logit(2.0 - torch.sqrt(4.0 - 2.0 * splats.opacities.detach()[first]))
    splats.opacity_logits.data[first] = shared
    splats.opacity_logits.data[second] = shared
    forget(splats, optimiser, ("means", "opacity_logits"), first)
