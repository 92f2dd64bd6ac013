"""Ref-GS: pixels shaded by a small network from features of the mirrored direction and features of the place.

Y. Zhang, A. Chen, Y. Wan, Z. Song, J. Yu, Y. Luo, W. Yang, Ref-GS: Directional Factorization for 2D Gaussian
Splatting, CVPR 2025. Splats of 2DGS carry a diffuse colour, a roughness and a few features; they are blended to I_d, M
and K, and each pixel is shaded (deferred):

    S = Sph-Mip(omega_r, M),  I = I_d + f(S, K (x) S)

Sph-Mip is a grid of features on the sphere with averages from fine to coarse, linear between texels and, by roughness,
between levels; (x) is the outer product, by which the place picks what the direction says; f is a network with one
hidden layer.

What differs from the paper. The grid is a cube instead of one by latitude and longitude: the same levels of averages,
without poles or a seam. It has 6 x 64 x 64 texels in place of 512 x 1024, and the network 64 hidden units in place of
256, for photos of 0.05 megapixels and processors. f has no activation at its end, of which the paper says nothing:
where diffuse colours begin brighter than they are, a positive f is pressed to 0 and does not come back (22 dB in place
of 33 on the bundled facade under a far environment). The loss of alpha against masks of objects is left out: sites
have none.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import torch
from torch import Tensor, nn

from reconstruction.light.cube_lookup import FACES, Levels, LinearMap, averaged, sides_from
from reconstruction.light.shading import reflected_directions
from reconstruction.splats.rasterising.raster_types import Raster
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.splats import FEATURES, Splats
from reconstruction.training.config import TrainConfig
from reconstruction.training.methods.shader import (
    Attribute,
    Shaded,
    Shader,
    Surroundings,
    covered_pixels,
    require_not_negative,
    with_colours,
)


@dataclass(frozen=True, slots=True)
class RefGsSettings:
    """Of the method.

    Parameters
    ----------
    side, coarsest
        Texels along an edge of the finest and the coarsest cube of the grid; nine levels in the paper, six here.
    directional, spatial
        Features of a direction (C) and of a place (D); the paper's.
    hidden
        Units of the network's hidden layer; 256 in the paper.
    diffuse, roughness
        That splats start from; diffuse colours of 0.14 and 0.5 end within 0.7 dB of each other.
    grid_rate, network_rate, material_rate
        Learning rates of the grid, the network, and of diffuse colour, roughness and features.
    """

    side: int = 64
    coarsest: int = 2
    directional: int = 16
    spatial: int = 4
    hidden: int = 64
    diffuse: float = 0.5
    roughness: float = 0.2
    grid_rate: float = 0.02
    network_rate: float = 0.005
    material_rate: float = 0.02

    def __post_init__(self) -> None:
        require_not_negative(self)

    def attributes(self) -> tuple[Attribute, ...]:
        """Of each splat, all blended as they are."""
        return (
            Attribute("diffuse", (3,), self.diffuse, "sigmoid"),
            Attribute("roughness", (), self.roughness, "sigmoid"),
            Attribute("feature", (self.spatial,), 0.0, spread=0.1),
        )


@lru_cache(maxsize=4)
def _grid_levels(side: int, coarsest: int) -> tuple[LinearMap, Levels]:
    return averaged(side, coarsest), Levels(sides_from(side, coarsest))


class SphMip(nn.Module):
    """Features by direction, the coarser the rougher.

    Parameters
    ----------
    side, coarsest
        Powers of 2.
    channels
        C.
    generator
        Of the values that it starts from.
    """

    SPREAD = 0.1
    """Standard deviation that features start from."""

    def __init__(self, side: int, coarsest: int, channels: int, generator: torch.Generator | None = None) -> None:
        super().__init__()
        self.side, self.coarsest = side, coarsest
        sides_from(side, coarsest)
        start = self.SPREAD * torch.randn((FACES * side * side, channels), generator=generator)
        self.texels = nn.Parameter(start)

    def forward(self, directions: Tensor, roughness: Tensor) -> Tensor:
        """S, shape (n, C), of unit directions, shape (n, 3), and roughness, shape (n,), 0 to 1, clamped."""
        averages, levels = _grid_levels(self.side, self.coarsest)
        return levels.look_up(directions, roughness * (len(levels) - 1), averages(self.texels))


class RefGsShading(nn.Module):
    """The shading of pixels, and what it learns: grid and network.

    Parameters
    ----------
    generator
        Of all random numbers.
    """

    DIM = 0.1
    """Of the usual start of the last layer: colours begin as they are, with little added."""

    def __init__(self, settings: RefGsSettings | None = None, generator: torch.Generator | None = None) -> None:
        super().__init__()
        self.settings = chosen = settings or RefGsSettings()
        self.grid = SphMip(chosen.side, chosen.coarsest, chosen.directional, generator)
        inputs = chosen.directional * (1 + chosen.spatial)
        self.hidden = _layer(inputs, chosen.hidden, generator)
        self.out = _layer(chosen.hidden, 3, generator)
        with torch.no_grad():
            self.out.weight *= self.DIM

    def forward(self, feature: Tensor, roughness: Tensor, normals: Tensor, omega_o: Tensor) -> Tensor:
        """Mirrored light f(S, K (x) S) to add to the blended diffuse light, shape (n, 3), also below 0.

        Parameters
        ----------
        feature, roughness
            K and M, blended and divided by alpha, shapes (n, D) and (n,).
        normals, omega_o
            Unit, shape (n, 3); the latter from the camera to the surface.
        """
        directional = self.grid(reflected_directions(omega_o, normals), roughness)
        product = (feature[:, :, None] * directional[:, None, :]).flatten(start_dim=1)
        hidden = torch.relu(self.hidden(torch.cat([directional, product], dim=1)))
        light: Tensor = self.out(hidden)
        return light


def _layer(inputs: int, outputs: int, generator: torch.Generator | None) -> nn.Linear:
    """Weights as K. He et al., Delving deep into rectifiers, 2015, biases 0."""
    layer = nn.Linear(inputs, outputs)
    with torch.no_grad():
        layer.weight.copy_(math.sqrt(2.0 / inputs) * torch.randn(layer.weight.shape, generator=generator))
        layer.bias.zero_()
    return layer


# Ref-GS in the joint training; see `reconstruction.training.methods.ref_gs`.


class RefGs(Shader):
    """Diffuse colour, and mirrored light by a grid on the sphere and a small network."""

    def __init__(self, seed: int, settings: RefGsSettings | None = None) -> None:
        super().__init__()
        self.seed = seed
        self.shading = RefGsShading(settings, torch.Generator().manual_seed(seed))

    def attributes(self, splats: Splats) -> dict[str, Tensor]:
        """Diffuse colour (as the splats'), roughness and features."""
        return with_colours("diffuse", self.shading.settings.attributes(), splats, self.seed)

    def attribute_rates(self) -> Mapping[str, float]:
        """One for all."""
        settings = self.shading.settings
        return {each.parameter: settings.material_rate for each in settings.attributes()}

    def colours(self, splats: Splats, position_m: Tensor, degree: int) -> Tensor:
        """Diffuse, the same from all sides."""
        return torch.sigmoid(splats.attribute("diffuse_logits"))

    def channels(self, splats: Splats, position_m: Tensor) -> Tensor:
        """Roughness and features."""
        roughness = torch.sigmoid(splats.attribute("roughness_logits"))
        return torch.cat([roughness[:, None], splats.attribute("feature")], dim=1)

    def forward(self, view: View, raster: Raster, directions: Tensor, channels: Tensor, splats: Splats) -> Shaded:
        """Diffuse light as blended, and what covered pixels mirror."""
        pixels = covered_pixels(raster, directions, channels)
        mirrored = self.shading(pixels.channels[:, 1:], pixels.channels[:, 0], pixels.normals, pixels.directions)
        own = raster.features[..., FEATURES["colour"]]
        reflection = pixels.picture(pixels.alphas * mirrored, raster.alphas)
        return Shaded(own, reflection, reflection, raster.alphas.detach())

    def parameter_groups(self) -> list[dict[str, Any]]:
        """Of the grid, and of the network."""
        settings, shading = self.shading.settings, self.shading
        network = [*shading.hidden.parameters(), *shading.out.parameters()]
        return [
            {"params": list(shading.grid.parameters()), "lr": settings.grid_rate},
            {"params": network, "lr": settings.network_rate},
        ]


def make_shader(config: TrainConfig, _surroundings: Surroundings) -> RefGs:
    """Of a training."""
    return RefGs(config.seed)
