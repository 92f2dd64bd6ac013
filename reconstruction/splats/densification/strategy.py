"""How the number of splats follows the detail there is: what every strategy is, and the edits that they share.

A training step is: render, `backward()`, `seen(...)`, `before_step(...)`, `optimiser.step()`, `after_step(...)`,
`optimiser.zero_grad()`. Strategies edit parameters and Adam's moments together. Where the number of splats changes, the
parameters are new objects in the splats and in the optimiser's groups: ask the splats for them in every step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import torch
from torch import Tensor, nn
from torch.optim import Optimizer

from reconstruction.splats.rasterising.projection import rotations
from reconstruction.splats.rasterising.raster_types import Raster
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.splats import Splats

# What pictures said about each splat since the number of splats changed last: how hard they pull, whether it shows.

BOX_SIGMAS = 3.3
"""Half a splat's box in standard deviations: there, an opaque one falls below the cut."""

HIDDEN_VIEWS = 30
"""Pictures a splat was drawn in without showing, after which it is taken for hidden: wrongly so for 4 % of those that
show in every tenth photo of their place only."""

HIDDEN_PIXELS = 0.01
"""Pixels' worth of weight, in all those pictures together, that count as not showing."""

SUMS = ("pulls", "views", "weights", "sigmas_px")


class SplatStatistics:
    """Sums over pictures, for n splats.

    Attributes
    ----------
    pulls
        Of gradients with respect to the screen position, of the error summed over pixels, per pixel.
    views
        Pictures that a splat was drawn in.
    weights
        What it added to them, pixels.
    sigmas_px
        Its largest standard deviation in any of them.
    eyes_m
        Positions of their cameras, shape (k, 3).
    """

    def __init__(self, pulls: Tensor, views: Tensor, weights: Tensor, sigmas_px: Tensor, eyes_m: Tensor) -> None:
        self.pulls = pulls
        self.views = views
        self.weights = weights
        self.sigmas_px = sigmas_px
        self.eyes_m = eyes_m

    @classmethod
    def nothing(cls, n: int, device: torch.device) -> SplatStatistics:
        """Before the first picture."""
        pulls, views, weights, sigmas_px = torch.zeros(len(SUMS), n, device=device)
        return cls(pulls, views, weights, sigmas_px, torch.zeros(0, 3, device=device))

    def __len__(self) -> int:
        return len(self.pulls)

    def before(self, raster: Raster) -> SplatStatistics:
        """What a picture is added to: these sums, or none yet where the number of splats has changed."""
        device = raster.weights.device
        if len(self) != len(raster.weights):
            return SplatStatistics.nothing(len(raster.weights), device)
        if self.pulls.device == device:
            return self
        return SplatStatistics(*(value.to(device) for value in self.tensors().values()))

    def add(self, raster: Raster, screen_gradients: Tensor | None, view: View) -> None:
        """Take in a picture.

        Gradients are those of the mean error over the picture's pixels; times their number they are the same for a
        window as for the whole picture.
        """
        drawn = raster.radii_px > 0
        self.views += drawn
        self.weights += raster.weights.detach()
        self.sigmas_px = torch.maximum(self.sigmas_px, raster.radii_px.to(self.sigmas_px) / BOX_SIGMAS)
        if screen_gradients is not None:
            self.pulls += screen_gradients.detach().norm(dim=1) * (view.width_px * view.height_px)
        self.eyes_m = torch.cat([self.eyes_m, view.position_m[None].to(self.eyes_m)])

    def mean_pulls(self) -> Tensor:
        """Over the pictures it was drawn in, shape (n,); 0 where there is none."""
        return self.pulls / self.views.clamp(min=1.0)

    def is_hidden(self) -> Tensor:
        """Which splats show in no picture although they are inside many, shape (n,)."""
        return (self.views >= HIDDEN_VIEWS) & (self.weights < HIDDEN_PIXELS)

    def is_at_lens(self, splats: Splats, clear_m: float) -> Tensor:
        """Which splats are nearer than `clear_m` to one of the cameras, shape (n,)."""
        if not len(self.eyes_m) or not len(splats):
            return torch.zeros(len(splats), dtype=torch.bool, device=splats.means.device)
        eyes = torch.unique(self.eyes_m, dim=0).to(splats.means)
        return torch.cdist(splats.means.detach(), eyes).min(dim=1).values < clear_m

    def joined(self, later: SplatStatistics) -> SplatStatistics:
        """With those of further pictures; those alone where the number of splats has changed since."""
        if len(self) != len(later):
            return later
        return SplatStatistics(
            self.pulls + later.pulls,
            self.views + later.views,
            self.weights + later.weights,
            torch.maximum(self.sigmas_px, later.sigmas_px),
            torch.cat([self.eyes_m, later.eyes_m]),
        )

    def tensors(self) -> dict[str, Tensor]:
        """By name."""
        return {name: getattr(self, name) for name in (*SUMS, "eyes_m")}

    @classmethod
    def of(cls, tensors: dict[str, Tensor]) -> SplatStatistics:
        """What `tensors` gave."""
        return cls(*(tensors[name].clone() for name in (*SUMS, "eyes_m")))


@dataclass(frozen=True, slots=True)
class BetweenChanges:
    """What a strategy does in each step, besides keeping sizes within limits.

    Parameters
    ----------
    opacity_pull, size_pull
        Added to the gradients of logits of opacities a, times a (1 - a), and of logarithms of sizes s, times s.
    noise
        Standard deviation of the jitter of a see-through splat, of its own.
    gate_at, gate_slope, least_gate
        Opacity at which that has half its strength, how fast it ends above, and share from which on it counts.
    """

    opacity_pull: float = 0.0
    size_pull: float = 0.0
    noise: float = 0.0
    gate_at: float = 0.0
    gate_slope: float = 1.0
    least_gate: float = 1.0


NO_CHANGES = BetweenChanges()

CUT = 1.0 / 255.0
"""Opacity up to which a splat is not drawn and has no gradient: it can only be taken away or put elsewhere."""


@dataclass(frozen=True, slots=True)
class Change:
    """What a step did to the splats.

    Parameters
    ----------
    n_dead
        Whose opacity is at most `CUT` afterwards: they cannot learn.
    is_reset
        Whether opacities were lowered.
    """

    n_cloned: int = 0
    n_split: int = 0
    n_added: int = 0
    n_relocated: int = 0
    n_pruned: int = 0
    n_dead: int = 0
    is_reset: bool = False

    @property
    def is_nothing(self) -> bool:
        """Whether the splats are the same ones as before; they may have moved."""
        return not (self.n_cloned or self.n_split or self.n_added or self.n_relocated or self.n_pruned or self.is_reset)


NOTHING = Change()


@dataclass(frozen=True, slots=True)
class Limits:
    """What no splat may be; they are brought back within after every step.

    Parameters
    ----------
    n_most
        Splats in all.
    smallest_m, largest_m
        Standard deviations.
    stretched
        The longer one is at most so many times the shorter: needles have large gradients from all sides, and adaptive
        control then fills the scene with ever more of them. A frame 6 cm wide, in pieces 1 m long, is within it.
    clear_m
        No splat is nearer to a camera than this: the aircraft was there, so nothing else is. Such splats hide what is
        behind them from one photo, fit it, and are in the way of all others.
    """

    n_most: int = 200_000
    smallest_m: float = 1e-3
    largest_m: float = 100.0
    stretched: float = 16.0
    clear_m: float = 1.0

    def __post_init__(self) -> None:
        if self.n_most < 1:
            raise ValueError(f"n_most: expected at least 1, got {self.n_most}")
        if not 0.0 < self.smallest_m < self.largest_m:
            raise ValueError(f"expected 0 < smallest_m < largest_m, got {self.smallest_m}, {self.largest_m}")
        if not self.stretched >= 1.0:
            raise ValueError(f"stretched: expected 1 or more, got {self.stretched}")
        if not self.clear_m >= 0.0:
            raise ValueError(f"clear_m: expected 0 or more, got {self.clear_m}")


class Densification(Protocol):
    """A strategy. Its own state goes through `state_dict` and `load_state_dict`, so that a training resumes exactly."""

    @property
    def limits(self) -> Limits:
        """That splats are kept within."""

    def before_step(self, step: int, splats: Splats, optimiser: Optimizer) -> None:
        """After `backward` and before the optimiser's step: gradients of what the strategy wants may be added."""

    def observe(self, raster: Raster, screen_gradients: Tensor | None, view: View) -> None:
        """Take in a picture that was rendered and its gradients of the splats' screen positions, shape (n, 2), px."""

    def take_in(self, seen: SplatStatistics) -> None:
        """Take in what somebody else added up over several pictures."""

    def between_changes(self, splats: Splats) -> BetweenChanges:
        """What `before_step` and `after_step` do in steps in which `changes_after` is not, for who does it himself."""

    def changes_after(self, step: int) -> bool:
        """Whether `after_step` may add splats, take some away, or reset some."""

    def after_step(self, step: int, splats: Splats, optimiser: Optimizer, generator: torch.Generator) -> Change:
        """After the optimiser's step, number `step` from 0: change the splats, which may become more or fewer."""

    def state_dict(self) -> dict[str, Tensor]:
        """By name; only tensors, for a safetensors file."""

    def load_state_dict(self, state: dict[str, Tensor]) -> None:
        """Go on from what `state_dict` gave."""


class FixedNumber:
    """No densification: splats are only kept within limits."""

    def __init__(self, limits: Limits | None = None) -> None:
        self.limits = limits or Limits()

    def before_step(self, step: int, splats: Splats, optimiser: Optimizer) -> None:
        """Nothing to add."""

    def observe(self, raster: Raster, screen_gradients: Tensor | None, view: View) -> None:
        """Nothing to remember."""

    def take_in(self, seen: SplatStatistics) -> None:
        """Nothing to remember."""

    def between_changes(self, splats: Splats) -> BetweenChanges:
        """Nothing."""
        return NO_CHANGES

    def changes_after(self, step: int) -> bool:
        """Never."""
        return False

    def after_step(self, step: int, splats: Splats, optimiser: Optimizer, generator: torch.Generator) -> Change:
        """Keep sizes within limits."""
        keep_within(splats, self.limits)
        return NOTHING

    def state_dict(self) -> dict[str, Tensor]:
        """Nothing."""
        return {}

    def load_state_dict(self, state: dict[str, Tensor]) -> None:
        """Nothing."""


def keep_within(splats: Splats, limits: Limits) -> None:
    """Bring sizes back within the limits, in place: the shorter side of a needle grows.

    Of ellipsoids that is the middle one: flat ones are what surfaces are made of.
    """
    sizes = splats.log_scales.data
    sizes.clamp_(math.log(limits.smallest_m), math.log(limits.largest_m))
    longest = sizes.max(dim=1, keepdim=True).values
    least = longest - math.log(limits.stretched)
    if splats.is_flat:
        torch.maximum(sizes, least, out=sizes)
        return
    is_shortest = torch.zeros_like(sizes, dtype=torch.bool).scatter_(1, sizes.argmin(dim=1, keepdim=True), True)
    sizes.copy_(torch.where(is_shortest, sizes, torch.maximum(sizes, least)))


def n_dead(splats: Splats) -> int:
    """Splats that no gradient reaches, because their opacity is at the cut or below."""
    return int((splats.opacities.detach() <= CUT).sum())


def rearrange(splats: Splats, optimiser: Optimizer, source: Tensor, is_new: Tensor) -> None:
    """Let splat i become what splat `source[i]` was, for all i at once, with Adam's moments.

    Parameters are new objects afterwards, in the splats and in the optimiser's groups.

    Parameters
    ----------
    source
        Shape (k,), int64: k may be smaller or larger than the number of splats.
    is_new
        Shape (k,): those start without moments.
    """
    n = len(splats)
    for name in splats.names:
        old = getattr(splats, name)
        # A new one: graphs that are still held know the old one by its shape.
        new = nn.Parameter(old.detach()[source])
        state = optimiser.state.pop(old, {})
        for key, value in state.items():
            if isinstance(value, Tensor) and value.ndim and len(value) == n:
                moved = value[source]
                moved[is_new] = 0.0
                state[key] = moved
        if state:
            optimiser.state[new] = state
        for group in optimiser.param_groups:
            group["params"] = [new if parameter is old else parameter for parameter in group["params"]]
        setattr(splats, name, new)
    splats.panels = splats.panels[source]


def forget(splats: Splats, optimiser: Optimizer, names: tuple[str, ...], rows: Tensor | slice = slice(None)) -> None:
    """Set Adam's moments of some parameters, by name, to 0."""
    for name in names:
        for value in optimiser.state.get(getattr(splats, name), {}).values():
            if isinstance(value, Tensor) and value.ndim:
                value[rows] = 0.0


def within(splats: Splats, rows: Tensor, steps: Tensor) -> Tensor:
    """Displacements, shape (k, 3), of steps along the axes of splats `rows`, in standard deviations, shape (k, 2 or 3).

    So what is put beside a disc of a pane is on the pane.
    """
    lengths = steps * torch.exp(splats.log_scales.data[rows])
    axes = rotations(splats.quats.data[rows])[..., : lengths.shape[1]]
    return (axes * lengths[:, None, :]).sum(dim=-1)
