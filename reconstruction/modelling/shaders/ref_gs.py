"""Ref-GS in the joint training; see `reconstruction.baselines.ref_gs`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import torch
from torch import Tensor

from reconstruction.baselines.ref_gs import RefGsSettings, RefGsShading
from reconstruction.modelling.shader import Shaded, Shader
from reconstruction.modelling.shaders.pixels import covered_pixels
from reconstruction.modelling.shaders.start_colours import with_colours
from reconstruction.splatting.raster import Raster
from reconstruction.splatting.splats import FEATURES, Splats
from reconstruction.splatting.views import View


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
