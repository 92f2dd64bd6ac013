"""Panels that mirror: what each is made of, the light it mirrors, and the colour a camera makes of both."""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from planning.base.jit import kernel
from reconstruction.light.glass_light import GlassLight
from reconstruction.light.glass_rays import GlassRays
from reconstruction.light.harmonics import HarmonicTexture
from reconstruction.light.shading import BASE_REFLECTANCE, DARKEST, REFLECTIVITY, display_from_linear, schlick, shade

# Colours of panes as photos have them, by deferred shading, forward and backward, compiled, one ray at a time.
#
# As `ReflectivePanels` has them in plain torch. Light and colours are float32, numbers of panes and photos float64.

Array = NDArray[np.float32]
Double = NDArray[np.float64]
Index = NDArray[np.int64]

DIMMEST = 0.1
"""Share of light that is left in a picture's corners at least."""

LIFT, SCALE, POWER, SLOPE = 0.055, 1.055, 1.0 / 2.4, 12.92
"""Of sRGB (IEC 61966-2-1)."""


@kernel
def display_of(light: float) -> tuple[float, float]:
    """Value of sRGB of linear light, and its slope: `display_from_linear`."""
    if light <= 0.0:
        return 0.0, 0.0
    if light <= DARKEST:
        return SLOPE * light, SLOPE
    if light <= 1.0:
        curved = SCALE * light**POWER
        return curved - LIFT, POWER * curved / light
    return 1.0 + SCALE * POWER * (light - 1.0), SCALE * POWER


@kernel
def colours(
    diffuse: Array, light: Array, cosines: Array, panels: Index, factors: Double, off_axis: Double,
    reflectivity: Double, base: Double, corner_loss: float, found: Array, slopes: Array,
) -> None:  # fmt: skip
    """Colours, shape (n, 3), written, and how they change with linear light.

    Parameters
    ----------
    diffuse, light
        c, and what is mirrored, shape (n, 3).
    cosines, panels
        Of the angles of incidence, and the panes' numbers, shape (n,).
    factors
        From linear light on a picture's axis to that which a photo shows, shape (n,).
    off_axis
        Squared distance from the principal point, 1 in a picture's corners, shape (n,).
    reflectivity, base
        R, shape (m,), and F0, shape (m, 3).
    corner_loss
        Share of light lost in a picture's corners.
    """
    for ray in range(len(panels)):
        panel = panels[ray]
        grazing = 1.0 - min(max(cosines[ray], 0.0), 1.0)
        grazing = grazing * grazing * grazing * grazing * grazing
        kept = factors[ray] * max(1.0 - corner_loss * off_axis[ray], DIMMEST)
        mirrored = reflectivity[panel]
        for k in range(3):
            fresnel = base[panel, k] + (1.0 - base[panel, k]) * grazing
            linear = kept * ((1.0 - mirrored) * diffuse[ray, k] + mirrored * fresnel * light[ray, k])
            found[ray, k], slopes[ray, k] = display_of(linear)


@kernel
def colours_back(
    diffuse: Array, light: Array, cosines: Array, panels: Index, factors: Double, off_axis: Double,
    reflectivity: Double, base: Double, corner_loss: float, slopes: Array, by_colours: Array,
    by_diffuse: Array, by_light: Array, by_cosines: Array, by_reflectivity: Double, by_base: Double,
) -> float:  # fmt: skip
    """Gradients by c, light and cosines, written, and by R and F0, added; that by the corner loss is returned."""
    by_corner_loss = 0.0
    for ray in range(len(panels)):
        panel = panels[ray]
        cosine = min(max(cosines[ray], 0.0), 1.0)
        fourth = (1.0 - cosine) * (1.0 - cosine) * (1.0 - cosine) * (1.0 - cosine)
        grazing = fourth * (1.0 - cosine)
        left = 1.0 - corner_loss * off_axis[ray]
        mirrored = reflectivity[panel]
        by_cosine, by_kept = 0.0, 0.0
        for k in range(3):
            fresnel = base[panel, k] + (1.0 - base[panel, k]) * grazing
            by_linear = by_colours[ray, k] * slopes[ray, k] * factors[ray]
            by_kept += by_linear * ((1.0 - mirrored) * diffuse[ray, k] + mirrored * fresnel * light[ray, k])
            by_linear *= max(left, DIMMEST)
            by_diffuse[ray, k] = by_linear * (1.0 - mirrored)
            by_light[ray, k] = by_linear * mirrored * fresnel
            by_reflectivity[panel] += by_linear * (fresnel * light[ray, k] - diffuse[ray, k])
            by_fresnel = by_linear * mirrored * light[ray, k]
            by_base[panel, k] += by_fresnel * (1.0 - grazing)
            by_cosine -= by_fresnel * (1.0 - base[panel, k]) * 5.0 * fourth
        by_cosines[ray] = by_cosine
        if left > DIMMEST:
            by_corner_loss -= by_kept * off_axis[ray]
    return by_corner_loss


# Colours of panes from what is behind them and what they mirror, with gradients, in one go on a processor.


def pane_colours(
    diffuse: Tensor, light: Tensor, cosines: Tensor, reflectivity: Tensor, base: Tensor, corner_loss: Tensor,
    panels: Tensor, factors: Tensor, off_axis: Tensor,
) -> Tensor:  # fmt: skip
    """Colours as photos have them, sRGB, shape (n, 3), float32, on a processor (paper Eqs. 19 and 21).

    Gradients flow through the first six.

    Parameters
    ----------
    diffuse, light, cosines
        c and the mirrored light, linear, shape (n, 3), and cosines of the angles of incidence, shape (n,), float32.
    reflectivity, base
        Logits of R and F0 of each pane, shapes (m, 1) and (m, 3).
    corner_loss
        Share of light lost in a picture's corners, shape ().
    panels, factors, off_axis
        Panes' numbers, factors of linear light, and squared distances from the principal point, 1 in a picture's
        corners, shape (n,).
    """
    found: Tensor = _Colours.apply(  # type: ignore[no-untyped-call]
        diffuse, light, cosines, reflectivity, base, corner_loss, panels, factors, off_axis
    )
    return found


class _Colours(torch.autograd.Function):
    @staticmethod
    def forward(
        ctx: Any, diffuse: Tensor, light: Tensor, cosines: Tensor, reflectivity: Tensor, base: Tensor,
        corner_loss: Tensor, panels: Tensor, factors: Tensor, off_axis: Tensor,
    ) -> Tensor:  # fmt: skip
        shares = torch.sigmoid(reflectivity.detach().double())[:, 0], torch.sigmoid(base.detach().double())
        values = (diffuse, light, cosines, panels.long(), factors.double(), off_axis.double(), *shares)
        fixed: Any = (*(np.ascontiguousarray(value.detach().numpy()) for value in values), float(corner_loss))
        found, slopes = np.empty((2, len(panels), 3), np.float32)
        run: Any = colours
        run(*fixed, found, slopes)
        ctx.fixed, ctx.slopes = fixed, slopes
        return torch.from_numpy(found)

    @staticmethod
    def backward(ctx: Any, by_colours: Tensor) -> tuple[Tensor | None, ...]:
        fixed: Any = ctx.fixed
        mirrored, base = fixed[6], fixed[7]
        written = [np.empty_like(value) for value in fixed[:3]]
        by_mirrored, by_base = np.zeros_like(mirrored), np.zeros_like(base)
        run: Any = colours_back
        by_corner_loss = run(
            *fixed, ctx.slopes, np.ascontiguousarray(by_colours.numpy()), *written, by_mirrored, by_base
        )
        by_logits = (by_mirrored * mirrored * (1.0 - mirrored))[:, None], by_base * base * (1.0 - base)
        return (
            *map(torch.from_numpy, written), *(torch.from_numpy(part).float() for part in by_logits),
            torch.tensor(by_corner_loss, dtype=torch.float32), None, None, None,
        )  # fmt: skip


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
