"""How a method makes light of what splats have, where panels and what they mirror are not known to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor, nn

from reconstruction.splats.rasterising.raster_types import Raster
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.splats import FEATURES, Splats

NEAREST_M = 1e-6
"""Of a splat to the camera: nearer ones have no direction, and are not drawn either."""


@dataclass(frozen=True, slots=True, eq=False)
class Shaded:
    """Linear light of a picture's pixels, without the sky behind them.

    Parameters
    ----------
    own, reflection
        What surfaces have of their own, and what they mirror, each weighted by what covers the pixel, shape (h, w, 3).
    mirrored
        What would be mirrored by a perfect mirror, shape (h, w, 3); 0 where nothing mirrors.
    reflectivity
        Share of it that is, shape (h, w).
    penalty
        Added to the loss of a step; None for nothing.
    """

    own: Tensor
    reflection: Tensor
    mirrored: Tensor
    reflectivity: Tensor
    penalty: Tensor | None = None


def directions_to(splats: Splats, position_m: Tensor) -> Tensor:
    """Unit directions from a camera at `position_m` to the splats' middles, shape (n, 3); without a gradient."""
    towards = splats.means.detach() - position_m
    unit: Tensor = towards / towards.norm(dim=1, keepdim=True).clamp(min=NEAREST_M)
    return unit


class Shader(nn.Module):
    """Light by spherical harmonics alone, as in 3DGS and 2DGS; others add to it."""

    def attributes(self, splats: Splats) -> dict[str, Tensor]:
        """What splats have for it besides `SHAPES`, by name, n rows each, as it is to begin with."""
        return {}

    def attribute_rates(self) -> Mapping[str, float]:
        """Learning rates of all `attributes`."""
        return {}

    def colours(self, splats: Splats, position_m: Tensor, degree: int) -> Tensor:
        """Linear light of each splat towards a camera at `position_m`, shape (n, 3)."""
        return splats.colours(position_m, degree)

    def channels(self, splats: Splats, position_m: Tensor) -> Tensor | None:
        """What is blended besides `Splats.features`, shape (n, k); None for nothing."""
        return None

    def forward(self, view: View, raster: Raster, directions: Tensor, channels: Tensor, splats: Splats) -> Shaded:
        """Light of a picture.

        Parameters
        ----------
        raster
            Of `Splats.features`.
        directions
            Unit, from the camera, shape (h, w, 3).
        channels
            As blended, shape (h, w, k).
        """
        own = raster.features[..., FEATURES["colour"]]
        black = torch.zeros_like(own)
        return Shaded(own, black, black, black[..., 0])

    def parameter_groups(self) -> list[dict[str, Any]]:
        """For an optimiser: its own parameters, `params`, and their learning rates, `lr`."""
        return []
