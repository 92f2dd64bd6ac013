"""GaussianShader: splats shaded one by one with normals of their own under an environment map, and then blended.

Y. Jiang, J. Tu, Y. Liu, X. Gao, X. Long, W. Wang, Y. Ma, GaussianShader: 3D Gaussian Splatting with Shading Functions
for Reflective Surfaces, CVPR 2024. Each Gaussian has the light

    c(omega_o) = c_d + s * L_s(omega_r, n, rho) + c_r(omega_o)

of a diffuse colour, a specular tint times what a GGX lobe of its roughness sees of an environment cube of 6 x 64 x 64
texels, and a residual colour of harmonics for all else. n is the shortest axis v turned to the camera, with a learned
residual for each of its sides:

    n = v + Delta n_1 where v faces the camera, else -(v + Delta n_2)

kept small by |Delta n|^2, and held to the depth map's normals by |n_blended - n_depth|^2.

What differs from the paper. Light is blended linear and gets its sRGB curve in the picture, as in all methods here; in
the paper each Gaussian's light is tone-mapped before it is blended. Flat splats have their own normal for the shortest
axis.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import torch
from torch import Tensor, nn

from reconstruction.light.cube_map import CubeMap
from reconstruction.light.harmonics import harmonics
from reconstruction.light.shading import reflected_directions
from reconstruction.splats.harmonic_colour import N_HARMONICS
from reconstruction.splats.rasterising.raster_types import Raster
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.splats import Splats, thinnest_axes
from reconstruction.training.config import Rates, TrainConfig
from reconstruction.training.losses import surface_normals
from reconstruction.training.methods.shader import (
    Attribute,
    Shaded,
    Shader,
    Surroundings,
    directions_to,
    require_not_negative,
    with_colours,
)

SHORTEST = 1e-12
"""Squared length below which a normal is none, and the axis stands for it."""

OPAQUE, CLEAR = 1.0 - 1e-4, 1e-4
"""Between which opacities count in `sparsity`, whose logarithms have no end."""


@dataclass(frozen=True, slots=True)
class GaussianShaderSettings:
    """Of the method.

    Parameters
    ----------
    side
        Texels along an edge of the environment cube; the paper's.
    expected
        Light that the map starts from.
    diffuse, tint, roughness
        That splats start from. Roughness of 0.2 costs 0.3 dB against 0.1 where normals are known; where they are off by
        9 degrees it brings 4 dB, as blurred light shows which way to turn.
    environment_rate, material_rate, residual_rate
        Learning rates of the map, of diffuse colour, tint and roughness, and of residual normals.
    normal, sparse, residual
        Weights lambda_n, lambda_s and lambda_r of the losses, the paper's.
    """

    side: int = 64
    expected: float = 0.3
    diffuse: float = 0.3
    tint: float = 0.5
    roughness: float = 0.2
    environment_rate: float = 0.1
    material_rate: float = 0.02
    residual_rate: float = 0.01
    normal: float = 0.01
    sparse: float = 0.001
    residual: float = 0.001

    def __post_init__(self) -> None:
        require_not_negative(self)

    def attributes(self) -> tuple[Attribute, ...]:
        """Of each splat; its light is made of them, and blended."""
        return (
            Attribute("diffuse", (3,), self.diffuse, "sigmoid"),
            Attribute("tint", (3,), self.tint, "sigmoid"),
            Attribute("roughness", (), self.roughness, "sigmoid"),
            Attribute("residual_normals", (2, 3), 0.0),
            Attribute("residual_sh", (N_HARMONICS, 3), 0.0),
        )


class GaussianShaderShading(nn.Module):
    """The shading of splats, and the environment that it learns."""

    def __init__(self, settings: GaussianShaderSettings | None = None) -> None:
        super().__init__()
        self.settings = settings or GaussianShaderSettings()
        self.environment = CubeMap(self.settings.side, self.settings.expected)

    def forward(
        self, diffuse: Tensor, tint: Tensor, roughness: Tensor, residual_sh: Tensor, normals: Tensor, omega_o: Tensor
    ) -> Tensor:
        """Linear light of n splats, shape (n, 3), 0 or more.

        Parameters
        ----------
        diffuse, tint, roughness
            c_d, s and rho, shapes (n, 3), (n, 3) and (n,), 0 to 1.
        residual_sh
            Coefficients of c_r, linear light by direction, shape (n, 16, 3), in the order of `harmonics`.
        normals
            Of `shading_normals`, shape (n, 3).
        omega_o
            Unit directions from the camera to the splats, shape (n, 3).
        """
        mirrored = self.environment(reflected_directions(omega_o, normals), roughness)
        residual = (harmonics(omega_o)[:, :, None] * residual_sh).sum(dim=1)
        light: Tensor = diffuse + tint * mirrored + residual
        return light.clamp(min=0.0)


def shading_normals(axes: Tensor, residual_normals: Tensor, omega_o: Tensor) -> Tensor:
    """Unit normals of splats, turned to the camera but for their residuals, shape (n, 3).

    Parameters
    ----------
    axes
        Unit shortest axes (`reconstruction.splats.splats`), either way round, shape (n, 3).
    residual_normals
        Delta n_1 and Delta n_2, shape (n, 2, 3); where one takes its axis away, the axis stands.
    omega_o
        Unit directions from the camera to the splats, shape (n, 3).
    """
    is_facing = (axes * omega_o).sum(dim=-1, keepdim=True) < 0.0
    with_first, with_second = axes + residual_normals[:, 0], axes + residual_normals[:, 1]
    found = torch.where(is_facing, with_first, -with_second)
    square = (found * found).sum(dim=-1, keepdim=True)
    has_length = square > SHORTEST
    length = torch.sqrt(torch.where(has_length, square, torch.ones_like(square)))
    return torch.where(has_length, found / length, torch.where(is_facing, axes, -axes))


def residual_loss(residual_normals: Tensor) -> Tensor:
    """Mean |Delta n|^2 of both sides' residuals, shape (n, 2, 3): normals stay near the shortest axes (L_reg)."""
    return residual_normals.square().sum(dim=-1).mean() if len(residual_normals) else residual_normals.sum()


def normal_loss(normals: Tensor, surface: Tensor, is_known: Tensor) -> Tensor:
    """Mean |n_blended - n_depth|^2 over pixels whose depths say a normal (L_normal); 0 where there are none.

    Parameters
    ----------
    normals
        Blended, shape (h, w, 3), turned to the camera.
    surface, is_known
        Of `reconstruction.training.losses.surface_normals`.
    """
    counted = is_known.to(normals.dtype)
    return ((normals - surface).square().sum(dim=-1) * counted).sum() / counted.sum().clamp(min=1.0)


def sparsity(opacities: Tensor) -> Tensor:
    """Mean log alpha + log(1 - alpha) of opacities, shape (n,): small where they are near 0 or 1 (L_sparse)."""
    within = opacities.clamp(CLEAR, OPAQUE)
    return (torch.log(within) + torch.log(1.0 - within)).mean() if len(opacities) else opacities.sum()


# GaussianShader in the joint training; see `reconstruction.training.methods.gaussian_shader`.


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


def make_shader(_config: TrainConfig, _surroundings: Surroundings) -> GaussianShader:
    """Of a training."""
    return GaussianShader()
