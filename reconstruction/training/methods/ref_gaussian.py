"""Ref-Gaussian: pixels shaded with metallic, rough surfaces under an environment map, and light between surfaces.

Y. Yao, Z. Zeng, C. Gu, X. Zhu, L. Zhang, Reflective Gaussian Splatting, ICLR 2025. Splats of 2DGS carry albedo,
metallic, roughness and harmonics of indirect light; they are blended, and each pixel is shaded (deferred):

    L = (1 - M) A + (F0 a + b) [V L_dir(omega_r, R) + (1 - V) L_ind],  F0 = 0.04 (1 - M) + A M

with a and b of the split sum (`split_sum`), L_dir of an environment cube filtered by GGX (`cube_map`), V = 0 where the
mirrored ray meets the scene, and L_ind blended from the splats' harmonics, each asked in its own mirrored direction.

What differs from the paper. Diffuse light is the albedo itself: a sunlit wall may be brighter than anything that glass
mirrors, and no albedo up to 1 makes it so from the map (`diffuse = "environment"` is the paper's). The mesh that says V
is the site's, not one fused from depths as training goes on. The first stage that shades splats one by one, before they
are blended, is this module called with splats in place of pixels. Normal propagation, which makes mirroring splats
larger every so often, is left out: panels already have theirs.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn.functional import grid_sample

from planning.geo.mesh import TriangleMesh
from planning.geo.ray_casting import RayCaster
from reconstruction.light.cube_map import CubeMap
from reconstruction.light.shading import incidence_cosines, reflected_directions
from reconstruction.splats.harmonic_colour import N_HARMONICS, display_colours, light_of_display
from reconstruction.splats.rasterising.raster_types import Raster
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.splats import Splats
from reconstruction.training.config import Rates, TrainConfig
from reconstruction.training.methods.shader import (
    Attribute,
    Pixels,
    Shaded,
    Shader,
    Surroundings,
    covered_pixels,
    directions_to,
    require_not_negative,
    with_colours,
)

Array = NDArray[np.float64]


# The part of rough mirroring that depends on the surface alone: how much of the light around a lobe comes back.
#
# Split sum (B. Karis, Real shading in Unreal Engine 4, SIGGRAPH 2013 course): light that a GGX surface mirrors is
# about
# the light that its lobe sees (`cube_map`), times the integral of its reflectance, which is F0 A + B with A and B by
# roughness and angle.

SIZE = 64
"""Rows (roughness) and columns (cosine) of the table, 0 and 1 included: linear in between it is off by 5e-3 at most for
angles up to 87.5 degrees, by 0.013 at 88.5, and by up to 0.1 at 89.5."""

SAMPLES = 1024
"""Half vectors of an integral, evenly spread: 7e-4 at most from 16 times as many."""

GRAZING = 1e-4
"""Cosine that stands for 0, where the integrals have a limit and their terms do not."""


@lru_cache(maxsize=1)
def split_sum_table() -> Array:
    """A and B of roughness 0 to 1 and cosine 0 to 1, shape (SIZE, SIZE, 2)."""
    roughness = np.linspace(0.0, 1.0, SIZE)
    columns = [split_sum(roughness, cosine, SAMPLES) for cosine in np.linspace(0.0, 1.0, SIZE)]
    return np.stack(columns, axis=1)


def split_sum(roughness: Array, cosine: float, n_samples: int) -> Array:
    """A and B, shape (m, 2), of roughness, shape (m,), at one cosine between normal and direction to the camera.

    GGX with alpha = roughness^2, Schlick's form of Smith's shadowing with k = alpha / 2, Schlick's Fresnel term.
    """
    cosine = max(cosine, GRAZING)
    turns, drawn = hammersley(n_samples)
    alpha = roughness[:, None] ** 2
    # Half vectors as likely as normals, but for 1 - xi = t^2 in place of xi: near the horizon, where each counts a
    # hundredfold, they are closer together, and count less.
    stretched = np.sqrt(1.0 + (alpha**2 - 1.0) * (1.0 - drawn**2))
    up = drawn / stretched
    aside = np.sqrt(np.maximum(1.0 - up * up, 0.0)) * np.cos(2.0 * np.pi * turns)
    half = np.maximum(aside * np.sqrt(1.0 - cosine * cosine) + up * cosine, 0.0)
    light, k = np.maximum(2.0 * half * up - cosine, 0.0), 0.5 * alpha
    lit = light > 0.0
    shadowing = light / np.where(lit, light * (1.0 - k) + k, 1.0) / (cosine * (1.0 - k) + k)
    weight = np.where(lit, shadowing * half * 2.0 * stretched, 0.0)
    fresnel = (1.0 - np.minimum(half, 1.0)) ** 5
    return np.stack([(weight * (1.0 - fresnel)).mean(axis=1), (weight * fresnel).mean(axis=1)], axis=-1)


def hammersley(n: int) -> tuple[Array, Array]:
    """Evenly spread points of the unit square: i / n, and i with its binary digits mirrored behind the point.

    Both half a step on, so that none is 0.
    """
    number, mirrored, digit = np.arange(n), np.zeros(n), 0.5
    while number.any():
        mirrored += digit * (number & 1)
        number, digit = number >> 1, 0.5 * digit
    return (np.arange(n) + 0.5) / n, mirrored + 0.5 / n


def reflectance(f0: Tensor, roughness: Tensor, cosines: Tensor) -> Tensor:
    """Share of the light around a lobe that comes back, F0 A + B, shape (n, c), by a linear lookup with gradients.

    Parameters
    ----------
    f0
        Reflectance at normal incidence, shape (n, c), 0 to 1.
    roughness, cosines
        Shape (n,), 0 to 1, clamped; cosines between normal and the direction to the camera.
    """
    places = torch.stack([2.0 * cosines - 1.0, 2.0 * roughness - 1.0], dim=-1)
    table = _table_like(f0.device, f0.dtype)
    found = grid_sample(table, places[None, None], mode="bilinear", padding_mode="border", align_corners=True)
    scale, bias = found[0, :, 0].unbind(dim=0)
    return f0 * scale[:, None] + bias[:, None]


@lru_cache(maxsize=4)
def _table_like(device: torch.device, dtype: torch.dtype) -> Tensor:
    """Shape (1, 2, SIZE, SIZE)."""
    return torch.from_numpy(split_sum_table()).permute(2, 0, 1)[None].to(device, dtype).contiguous()


# Where mirrored rays meet the scene: against a known mesh, for methods that treat that light by itself.

LIFT_M = 0.02
"""Along the normal, from which mirrored rays begin: a surface does not meet itself, and frames stand out further."""


def meets_scene(caster: RayCaster, points_enu_m: Array, normals_enu: Array, omega_o: Array) -> NDArray[np.bool_]:
    """Whether rays mirrored at points meet the mesh, shape (n,).

    Parameters
    ----------
    points_enu_m, normals_enu
        On the surface, shape (n, 3); normals unit, either way round.
    omega_o
        Unit directions from the camera to the points, ENU, shape (n, 3).
    """
    along = (omega_o * normals_enu).sum(axis=1, keepdims=True)
    lifted = points_enu_m - np.sign(along) * LIFT_M * normals_enu
    return np.asarray(caster.cast(lifted, omega_o - 2.0 * along * normals_enu).is_hit)


def points_on_mesh(caster: RayCaster, position_enu_m: Array, omega_o: Array, otherwise_enu_m: Array) -> Array:
    """Where lines of sight meet the mesh, shape (n, 3).

    Blended depths are metres off while a training begins, and mirrored rays that start behind a facade meet it from
    behind; these points are right from the start.

    Parameters
    ----------
    position_enu_m
        Of the camera, shape (3,).
    omega_o
        Unit directions away from it, ENU, shape (n, 3).
    otherwise_enu_m
        Points for those that meet nothing, shape (n, 3).
    """
    distances = caster.cast(position_enu_m, omega_o).distance_m[:, None]
    meets = np.isfinite(distances)
    return np.where(meets, position_enu_m + np.where(meets, distances, 0.0) * omega_o, otherwise_enu_m)


RefGaussianDiffuse = Literal["blended", "environment"]

DIELECTRIC = 0.04
"""F0 of what is no metal, as everywhere (Karis, 2013)."""


@dataclass(frozen=True, slots=True)
class RefGaussianSettings:
    """Of the method.

    Parameters
    ----------
    side
        Texels along an edge of the environment cube; 128 in the authors' program, whose photos have 50 times as many
        pixels.
    expected
        Light that the map starts from.
    diffuse
        Where diffuse light comes from; see above.
    metallic, roughness
        That splats start from: so rough that normals which are off still find what they mirror (see
        `GaussianShaderSettings`), and mirroring enough to have a gradient. Metallic of 0.2 to 0.8 and roughness of 0.05
        to 0.2 end within 0.5 dB of each other where normals are known.
    environment_rate, material_rate
        Learning rates of the map and of albedo, metallic and roughness; 0.01 and 0.005 in the paper, which has 50 000
        steps. In hundreds, the map needs ten times as much.
    """

    side: int = 64
    expected: float = 0.3
    diffuse: RefGaussianDiffuse = "blended"
    metallic: float = 0.5
    roughness: float = 0.2
    environment_rate: float = 0.1
    material_rate: float = 0.02

    def __post_init__(self) -> None:
        require_not_negative(self)

    def attributes(self) -> tuple[Attribute, ...]:
        """Of each splat; `indirect` is asked in its mirrored direction before it is blended (`indirect_light`)."""
        return (
            Attribute("albedo", (3,), 0.5, "sigmoid"),
            Attribute("metallic", (), self.metallic, "sigmoid"),
            Attribute("roughness", (), self.roughness, "sigmoid"),
            Attribute("indirect", (N_HARMONICS, 3), 0.0),
        )


class RefGaussianLight(NamedTuple):
    """Linear light of pixels, each shape (n, 3).

    Parameters
    ----------
    diffuse, specular
        Its two parts.
    mirrored
        What the specular one is a share of.
    """

    diffuse: Tensor
    specular: Tensor
    mirrored: Tensor


class RefGaussianShading(nn.Module):
    """The shading of pixels, or of splats, and the environment that it learns."""

    def __init__(self, settings: RefGaussianSettings | None = None) -> None:
        super().__init__()
        self.settings = settings or RefGaussianSettings()
        self.environment = CubeMap(self.settings.side, self.settings.expected)

    def forward(
        self,
        albedo: Tensor,
        metallic: Tensor,
        roughness: Tensor,
        normals: Tensor,
        omega_o: Tensor,
        indirect: Tensor | None = None,
        is_occluded: Tensor | None = None,
    ) -> RefGaussianLight:
        """Linear light of n pixels.

        Parameters
        ----------
        albedo, metallic, roughness
            Blended and divided by alpha, shapes (n, 3), (n,) and (n,), 0 to 1.
        normals
            Unit, either way round, shape (n, 3).
        omega_o
            Unit directions from the camera to the surface, shape (n, 3).
        indirect
            L_ind blended and divided by alpha, shape (n, 3).
        is_occluded
            Where the mirrored ray meets the scene (1 - V), bool, shape (n,); nowhere if there is none, or no
            `indirect`.
        """
        mirrored = self.environment(reflected_directions(omega_o, normals), roughness)
        if indirect is not None and is_occluded is not None:
            mirrored = torch.where(is_occluded[:, None], indirect, mirrored)
        share = metallic[:, None]
        f0 = DIELECTRIC * (1.0 - share) + albedo * share
        specular = reflectance(f0, roughness, incidence_cosines(omega_o, normals)) * mirrored
        diffuse = (1.0 - share) * albedo
        if self.settings.diffuse == "environment":
            facing = torch.where((omega_o * normals).sum(dim=-1, keepdim=True) > 0.0, -normals, normals)
            diffuse = diffuse * self.environment.on_matt(facing)
        return RefGaussianLight(diffuse, specular, mirrored)


def indirect_light(sh: Tensor, normals: Tensor, omega_o: Tensor, degree: int = 3) -> Tensor:
    """l_ind of splats: linear light from their own mirrored directions, shape (n, 3), 0 or more.

    Parameters
    ----------
    sh
        Display colour by direction (`harmonic_colour`), shape (n, 16, 3); grey at 0.
    normals, omega_o
        Of the splats, unit, shape (n, 3).
    """
    mirrored = reflected_directions(omega_o, normals)
    return light_of_display(display_colours(mirrored, sh, torch.zeros(3).to(mirrored), degree))


# Ref-Gaussian in the joint training; see `reconstruction.training.methods.ref_gaussian`.


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
        rays = (pixels.points_m(raster, position), pixels.normals, pixels.directions)
        blended, normals, directions = (each.double().cpu().numpy() for each in rays)
        points = points_on_mesh(self._caster, position.double().cpu().numpy(), directions, blended)
        return torch.from_numpy(meets_scene(self._caster, points, normals, directions)).to(position.device)

    def parameter_groups(self) -> list[dict[str, Any]]:
        """Of the environment."""
        settings = self.shading.settings
        return [{"params": list(self.shading.environment.parameters()), "lr": settings.environment_rate}]


def make_shader(_config: TrainConfig, surroundings: Surroundings) -> RefGaussian:
    """Of a training."""
    return RefGaussian(torch.from_numpy(surroundings.triangles_m))
