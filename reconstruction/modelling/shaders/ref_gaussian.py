"""Ref-Gaussian in the joint training; see `reconstruction.baselines.ref_gaussian`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from torch import Tensor

from planning.mesh import TriangleMesh
from reconstruction.baselines.ref_gaussian import RefGaussianSettings, RefGaussianShading, indirect_light
from reconstruction.baselines.visibility import meets_scene, points_on_mesh
from reconstruction.modelling.config import Rates
from reconstruction.modelling.shader import Shaded, Shader, directions_to
from reconstruction.modelling.shaders.pixels import Pixels, covered_pixels
from reconstruction.modelling.shaders.start_colours import with_colours
from reconstruction.ray_casting import RayCaster
from reconstruction.splatting.raster import Raster
from reconstruction.splatting.splats import Splats
from reconstruction.splatting.views import View


class RefGaussian(Shader):
    """Deferred shading by the split sum.

    Parameters
    ----------
    triangles_m
        Of the mesh that says where mirrored rays meet the scene, in the model's frame, shape (m, 3, 3).
    """

    triangles_m: Tensor

    def __init__(self, triangles_m: Tensor, settings: RefGaussianSettings | None = None) -> None:
        super().__init__()
        self.shading = RefGaussianShading(settings)
        self.register_buffer("triangles_m", triangles_m)
        self._caster: RayCaster | None = None

    def attributes(self, splats: Splats) -> dict[str, Tensor]:
        """Albedo (as the splats' colours), metallic, roughness and indirect light."""
        return with_colours("albedo", self.shading.settings.attributes(), splats)

    def attribute_rates(self) -> Mapping[str, float]:
        """The indirect light is learned as colours are; see `Rates.colours`."""
        settings = self.shading.settings
        rates = {each.parameter: settings.material_rate for each in settings.attributes()}
        return rates | {"indirect": Rates().colours}

    def colours(self, splats: Splats, position_m: Tensor, degree: int) -> Tensor:
        """Albedo, in the place of colours: it is blended, and shaded afterwards."""
        return torch.sigmoid(splats.attribute("albedo_logits"))

    def channels(self, splats: Splats, position_m: Tensor) -> Tensor:
        """Metallic, roughness, and light from the splats' own mirrored directions."""
        omega_o = directions_to(splats, position_m)
        indirect = indirect_light(splats.attribute("indirect"), splats.normals(position_m).detach(), omega_o)
        logits = [splats.attribute("metallic_logits"), splats.attribute("roughness_logits")]
        shares = torch.sigmoid(torch.stack(logits, dim=1))
        return torch.cat([shares, indirect], dim=1)

    def forward(self, view: View, raster: Raster, directions: Tensor, channels: Tensor, splats: Splats) -> Shaded:
        """Light of covered pixels."""
        pixels = covered_pixels(raster, directions, channels)
        parts = pixels.channels
        light = self.shading(
            pixels.colours,
            parts[:, 0],
            parts[:, 1],
            pixels.normals,
            pixels.directions,
            parts[:, 2:],
            self._is_occluded(pixels, raster, view),
        )
        alphas = raster.alphas
        return Shaded(
            pixels.picture(pixels.alphas * light.diffuse, alphas),
            pixels.picture(pixels.alphas * light.specular, alphas),
            pixels.picture(light.mirrored, alphas),
            pixels.picture(pixels.alphas.squeeze(-1) * parts[:, 0], alphas),
        )

    @torch.no_grad()
    def _is_occluded(self, pixels: Pixels, raster: Raster, view: View) -> Tensor:
        if self._caster is None:
            corners = self.triangles_m.double().cpu().numpy().reshape(-1, 3)
            numbers = np.arange(len(corners), dtype=np.int64).reshape(-1, 3)
            self._caster = RayCaster(TriangleMesh(corners, numbers))
        position = view.position_m.to(pixels.normals)
        given = (pixels.points_m(raster, position), pixels.normals, pixels.directions)
        blended, normals, directions = (each.double().cpu().numpy() for each in given)
        points = points_on_mesh(self._caster, position.double().cpu().numpy(), directions, blended)
        return torch.from_numpy(meets_scene(self._caster, points, normals, directions)).to(position.device)

    def parameter_groups(self) -> list[dict[str, Any]]:
        """Of the environment."""
        settings = self.shading.settings
        return [{"params": list(self.shading.environment.parameters()), "lr": settings.environment_rate}]
