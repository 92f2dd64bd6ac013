"""What pictures said about each splat since the number of splats changed last: how hard they pull, whether it shows."""

from __future__ import annotations

import torch
from torch import Tensor

from reconstruction.splats.rasterising.raster_types import Raster
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.splats import Splats

BOX_SIGMAS = 3.3
"""Half a splat's box in standard deviations: there, an opaque one falls below the cut."""

HIDDEN_VIEWS = 30
"""Pictures a splat was drawn in without showing, after which it is taken for hidden: wrongly so for 4 % of those that
show in every tenth photo of their place only."""

HIDDEN_PIXELS = 0.01
"""Pixels' worth of weight, in all those pictures together, that count as not showing."""

SUMS = ("pulls", "views", "weights", "sigmas_px")


class SeenSplats:
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
    def nothing(cls, n: int, device: torch.device) -> SeenSplats:
        """Before the first picture."""
        pulls, views, weights, sigmas_px = torch.zeros(len(SUMS), n, device=device)
        return cls(pulls, views, weights, sigmas_px, torch.zeros(0, 3, device=device))

    def __len__(self) -> int:
        return len(self.pulls)

    def before(self, raster: Raster) -> SeenSplats:
        """What a picture is added to: these sums, or none yet where the number of splats has changed."""
        device = raster.weights.device
        if len(self) != len(raster.weights):
            return SeenSplats.nothing(len(raster.weights), device)
        if self.pulls.device == device:
            return self
        return SeenSplats(*(value.to(device) for value in self.tensors().values()))

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

    def tensors(self) -> dict[str, Tensor]:
        """By name."""
        return {name: getattr(self, name) for name in (*SUMS, "eyes_m")}

    @classmethod
    def of(cls, tensors: dict[str, Tensor]) -> SeenSplats:
        """What `tensors` gave."""
        return cls(*(tensors[name].clone() for name in (*SUMS, "eyes_m")))
