"""Panels that mirror: what each is made of, the light it mirrors, and the colour a camera makes of both."""

from __future__ import annotations

import math
from typing import Literal

import torch
from torch import Tensor, nn

from reconstruction.light.directions.harmonics import HarmonicTexture
from reconstruction.light.glass_light import GlassLight
from reconstruction.light.glass_rays import GlassRays
from reconstruction.light.pane_colours import pane_colours
from reconstruction.light.shading import BASE_REFLECTANCE, REFLECTIVITY, display_from_linear, schlick, shade

ModelName = Literal["mlp", "environment-map", "harmonics", "radiance-grid"]

DIFFUSE_SHARE = 0.5
"""Of a panel's mean colour, what is put down to c at first."""


class ReflectivePanels(nn.Module):
    """Colours of glass rays by deferred shading (paper Eqs. 19 and 21), in linear light.

    The diffuse colour c changes slowly with place and direction, as that of splats does. Each panel has a reflectivity
    R and a base reflectance F0 of its own, kept in 0..1 by sigmoids. The camera loses light towards the corners of its
    pictures by a share that is learned, the same for all photos.

    Parameters
    ----------
    diffuse
        Model of c.
    light
        Model of mirrored light L; without one all light is c, as in splatting without reflections.
    """

    def __init__(self, diffuse: HarmonicTexture, light: GlassLight | None) -> None:
        super().__init__()
        n_panels = len(diffuse.means)
        self.diffuse = diffuse
        self.light = light
        self.reflectivity = nn.Parameter(torch.full((n_panels, 1), _logit(REFLECTIVITY)))
        self.base_reflectance = nn.Parameter(torch.full((n_panels, 3), _logit(BASE_REFLECTANCE)))
        self.corner_loss = nn.Parameter(torch.zeros(()))

    def linear(self, rays: GlassRays, generator: torch.Generator | None = None) -> Tensor:
        """Linear light of rays as it reaches the sensor, shape (n, 3).

        Parameters
        ----------
        generator
            See `GlassLight`.
        """
        panels = rays.panels.long()
        kept = 1.0 - torch.clamp(self.corner_loss * rays.off_axis, max=0.9)[:, None]
        middle = rays.middle()
        diffuse: Tensor = self.diffuse(middle.points, middle.omega_r, panels)
        if self.light is None:
            return kept * diffuse
        light, cosines = self.light(rays, generator)
        fresnel = schlick(torch.sigmoid(self.base_reflectance)[panels], cosines)
        return kept * shade(diffuse, torch.sigmoid(self.reflectivity)[panels], fresnel, light)

    def forward(self, rays: GlassRays, gain: float = 1.0, generator: torch.Generator | None = None) -> Tensor:
        """Colours of rays as photos have them, sRGB, shape (n, 3), above 1 where a photo would be overexposed.

        Parameters
        ----------
        gain
            Exposure of all the rays' photos against that of those learned from.
        generator
            See `GlassLight`.
        """
        light = self.light
        if light is None or rays.panels.device.type != "cpu":
            return display_from_linear(gain * rays.gains[:, None] * self.linear(rays, generator))
        panels, middle = rays.panels.long(), rays.middle()
        mirrored, cosines = light(rays, generator)
        diffuse = self.diffuse(middle.points, middle.omega_r, panels)
        return pane_colours(
            diffuse.float(), mirrored.float(), cosines, self.reflectivity, self.base_reflectance, self.corner_loss,
            panels, gain * rays.gains, rays.off_axis,
        )  # fmt: skip


def expected_reflection(mean: float) -> float:
    """Light L that makes panels of this mean linear light, with what they start from."""
    return min(max((1.0 - DIFFUSE_SHARE) * mean / (REFLECTIVITY * BASE_REFLECTANCE), 0.01), 0.99)


def _logit(value: float) -> float:
    return math.log(value / (1.0 - value))
