"""How a method makes light of what splats have, where panels and what they mirror are not known to it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Literal

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from reconstruction.splats.harmonic_colour import display_colours, light_of_display
from reconstruction.splats.rasterising.raster_types import Raster
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.splats import FEATURES, Splats, logit
from reconstruction.training.losses import unit

# What methods give each splat besides its shape: names, shapes, and where learning starts.

Activation = Literal["sigmoid", "none"]


@dataclass(frozen=True, slots=True)
class Attribute:
    """One number, or several, of each splat.

    Parameters
    ----------
    name
        Of the value; what is learned is called the same with `_logits` behind it where it passes a sigmoid.
    shape
        For one splat.
    start
        Of the value.
    activation
        From what is learned to the value.
    spread
        Standard deviation of normal noise on what is learned, at the start: features that all were alike would stay so.
    """

    name: str
    shape: tuple[int, ...]
    start: float
    activation: Activation = "none"
    spread: float = 0.0

    def __post_init__(self) -> None:
        if self.activation == "sigmoid" and not 0.0 < self.start < 1.0:
            raise ValueError(f"{self.name}: start: expected above 0 and below 1, got {self.start}")

    @property
    def parameter(self) -> str:
        """Name of what is learned."""
        return f"{self.name}_logits" if self.activation == "sigmoid" else self.name

    def learned(self, n: int, generator: torch.Generator | None = None) -> Tensor:
        """What is learned, at the start, shape (n, *shape), float32."""
        start = math.log(self.start / (1.0 - self.start)) if self.activation == "sigmoid" else self.start
        return start + self.spread * torch.randn((n, *self.shape), generator=generator)

    def value(self, learned: Tensor) -> Tensor:
        """From what is learned."""
        return torch.sigmoid(learned) if self.activation == "sigmoid" else learned


def require_not_negative(settings: Any) -> None:
    """Check a record of settings.

    Raises
    ------
    ValueError
        One of its numbers is negative, or none.
    """
    for each in fields(settings):
        value = getattr(settings, each.name)
        if isinstance(value, int | float) and not (math.isfinite(value) and value >= 0.0):
            raise ValueError(f"{each.name}: expected 0 or more, got {value}")


# Pixels that are shaded after blending: which, and what they have there.

LEAST_ALPHA = 1.0 / 255.0
"""Of a pixel that is shaded: what covers less of it is no step of an 8-bit picture."""

LEAST_COSINE = 1e-3
"""Between a pixel's ray and its plane."""

SHORTEST_NORMAL = 1e-3
"""Of a blended normal over alpha: shorter ones are of splats that face all ways."""


@dataclass(frozen=True, slots=True, eq=False)
class Pixels:
    """n pixels of a picture.

    Parameters
    ----------
    place
        Their rows and columns, each shape (n,).
    alphas
        Shape (n, 1).
    normals, directions
        Unit; normals turned to the camera, directions away from it, shape (n, 3).
    colours, channels
        Blended and divided by alpha, shapes (n, 3) and (n, k).
    """

    place: tuple[Tensor, Tensor]
    alphas: Tensor
    normals: Tensor
    directions: Tensor
    colours: Tensor
    channels: Tensor

    def picture(self, values: Tensor, like: Tensor) -> Tensor:
        """Values, shape (n, 3) or (n,), at their places; 0 elsewhere; `like` is shape (h, w)."""
        return like.new_zeros(*like.shape, *values.shape[1:]).index_put(self.place, values)

    def points_m(self, raster: Raster, position_m: Tensor) -> Tensor:
        """Where their rays meet the blended planes of the splats, in the model's frame, shape (n, 3)."""
        blended = raster.features[self.place]
        lengths = blended[:, FEATURES["normal"]].norm(dim=-1).clamp(min=SHORTEST_NORMAL)
        offsets = blended[:, FEATURES["offset"]].squeeze(-1) / lengths
        along = (self.directions * self.normals).sum(dim=-1).clamp(max=-LEAST_COSINE)
        points: Tensor = position_m + (offsets / along)[:, None] * self.directions
        return points


def covered_pixels(raster: Raster, directions: Tensor, channels: Tensor) -> Pixels:
    """Those that splats cover, and whose splats have a normal together."""
    alphas = raster.alphas
    normals = raster.features[..., FEATURES["normal"]]
    has_normal = normals.detach().norm(dim=-1) > SHORTEST_NORMAL * alphas.detach()
    place = torch.nonzero((alphas.detach() > LEAST_ALPHA) & has_normal, as_tuple=True)
    covers = alphas[place][:, None]
    colours = raster.features[..., FEATURES["colour"]][place] / covers
    return Pixels(
        (place[0], place[1]), covers, unit(normals[place]), directions[place], colours, channels[place] / covers
    )


# What splats have for a method when its training begins.


def with_colours(name: str, attributes: Sequence[Attribute], splats: Splats, seed: int = 0) -> dict[str, Tensor]:
    """All as they begin, but for one of colours, of values 0 to 1, which are those of the splats.

    Parameters
    ----------
    seed
        Of noise.
    """
    generator = torch.Generator().manual_seed(seed)
    found = {each.parameter: each.learned(len(splats), generator) for each in attributes}
    with torch.no_grad():
        means = splats.means
        seen = light_of_display(display_colours(means, splats.sh, torch.zeros(3).to(means), 0))
    return found | {f"{name}_logits": logit(seen)}


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


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """What a shading may know of the scene.

    Parameters
    ----------
    triangles_m
        Of the refined mesh, in the model's frame, shape (m, 3, 3), float32.
    """

    triangles_m: NDArray[np.float32]


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
