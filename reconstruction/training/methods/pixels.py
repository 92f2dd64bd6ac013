"""Pixels that are shaded after blending: which, and what they have there."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from reconstruction.splats.rasterising.raster_types import Raster
from reconstruction.splats.splats import FEATURES
from reconstruction.training.losses.terms import unit

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
