"""GaussianShader in the joint training; see `reconstruction.baselines.gaussian_shader`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import torch
from torch import Tensor

from reconstruction.baselines.gaussian_shader import (
    GaussianShaderSettings,
    GaussianShaderShading,
    normal_loss,
    residual_loss,
    shading_normals,
    sparsity,
)
from reconstruction.modelling.config import Rates
from reconstruction.modelling.losses import surface_normals
from reconstruction.modelling.shader import Shaded, Shader, directions_to
from reconstruction.modelling.shaders.start_colours import with_colours
from reconstruction.splatting.ellipsoid_axes import thinnest_axes
from reconstruction.splatting.raster import Raster
from reconstruction.splatting.splats import Splats
from reconstruction.splatting.views import View


class GaussianShader(Shader):
    """Splats shaded one by one."""

    def __init__(self, settings: GaussianShaderSettings | None = None) -> None:
        super().__init__()
        self.shading = GaussianShaderShading(settings)

    def attributes(self, splats: Splats) -> dict[str, Tensor]:
        """Diffuse colour (as the splats'), tint, roughness, residual normals and colours."""
        return with_colours("diffuse", self.shading.settings.attributes(), splats)

    def attribute_rates(self) -> Mapping[str, float]:
        """Residual normals hardly move."""
        settings = self.shading.settings
        rates = {each.parameter: settings.material_rate for each in settings.attributes()}
        return rates | {"residual_normals": settings.residual_rate, "residual_sh": Rates().colours}

    def colours(self, splats: Splats, position_m: Tensor, degree: int) -> Tensor:
        """Light of each splat."""
        omega_o = directions_to(splats, position_m)
        light: Tensor = self.shading(
            torch.sigmoid(splats.attribute("diffuse_logits")),
            torch.sigmoid(splats.attribute("tint_logits")),
            torch.sigmoid(splats.attribute("roughness_logits")),
            splats.attribute("residual_sh"),
            self._normals(splats, omega_o),
            omega_o,
        )
        return light

    def channels(self, splats: Splats, position_m: Tensor) -> Tensor:
        """Normals that are shaded with."""
        return self._normals(splats, directions_to(splats, position_m))

    def forward(self, view: View, raster: Raster, directions: Tensor, channels: Tensor, splats: Splats) -> Shaded:
        """Light as blended, and the method's own losses."""
        settings = self.shading.settings
        surface, is_known = surface_normals(raster.depths, raster.alphas, view)
        penalty = (
            settings.normal * normal_loss(channels, surface, is_known)
            + settings.residual * residual_loss(splats.attribute("residual_normals"))
            + settings.sparse * sparsity(splats.opacities)
        )
        return replace(super().forward(view, raster, directions, channels, splats), penalty=penalty)

    def parameter_groups(self) -> list[dict[str, Any]]:
        """Of the environment."""
        settings = self.shading.settings
        return [{"params": list(self.shading.environment.parameters()), "lr": settings.environment_rate}]

    @staticmethod
    def _normals(splats: Splats, omega_o: Tensor) -> Tensor:
        axes = thinnest_axes(splats.quats, splats.log_scales)
        return shading_normals(axes, splats.attribute("residual_normals"), omega_o)
