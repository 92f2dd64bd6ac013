"""Deferred shading of glass (paper Eqs. 19 to 21): mirrored directions, Schlick's Fresnel term, and their sum.

Nothing here is NaN or infinite, values and gradients, for any finite input: not at grazing angles, nor beyond them.
"""

from __future__ import annotations

import torch
from torch import Tensor

REFLECTIVITY, BASE_REFLECTANCE = 0.8, 0.4
"""R and F0 that glass starts from: coated panes."""

DARKEST = 0.0031308
"""Linear light below which sRGB's curve is a straight line (IEC 61966-2-1)."""


def reflected_directions(omega_o: Tensor, normals: Tensor) -> Tensor:
    """Where mirrored rays go on, omega_o - 2 (omega_o . n) n (Eq. 20), shape (n, 3); the length stays.

    Parameters
    ----------
    omega_o
        Unit directions from the camera to the surface.
    normals
        Unit, either way round.
    """
    return omega_o - 2.0 * (omega_o * normals).sum(dim=-1, keepdim=True) * normals


def incidence_cosines(omega_o: Tensor, normals: Tensor) -> Tensor:
    """Cosine n . (-omega_o) of the angle of incidence, shape (n,), 0 to 1, with normals turned to the camera.

    Parameters
    ----------
    omega_o
        Unit directions from the camera to the surface.
    normals
        Unit, either way round.
    """
    return (omega_o * normals).sum(dim=-1).abs().clamp(max=1.0)


def schlick(f0: Tensor, cosines: Tensor, share: Tensor | float = 1.0) -> Tensor:
    """Fresnel term F0 + (1 - F0) (1 - cos)^5 (C. Schlick, 1994; Eq. 21), shape (n, 3).

    Of a share R of the surface, and R F0 in the place of F0, it is R F.

    Cosines are clamped to 0..1 first: rounding leaves some outside, whose fifth power would leave 0..1 too.

    Parameters
    ----------
    f0
        Reflectance at normal incidence, shape (n, 3), 0 to 1.
    cosines
        Shape (n,).
    share
        Shape (n, 1).
    """
    grazing = (1.0 - cosines.clamp(0.0, 1.0))[:, None]
    # Products: the gradient of a power is NaN where a base is 0 and the exponent was rounded.
    square = grazing * grazing
    return f0 + (share - f0) * (square * square * grazing)


def shade(diffuse: Tensor, reflectivity: Tensor, fresnel: Tensor, reflected: Tensor) -> Tensor:
    """Light of a surface, (1 - R) c + R F L (Eq. 19), shape (n, 3).

    Parameters
    ----------
    diffuse, fresnel, reflected
        c, F, and the light L that comes from where the mirrored ray goes, each shape (n, 3).
    reflectivity
        R, shape (n, 1), 0 to 1.
    """
    return (1.0 - reflectivity) * diffuse + reflectivity * fresnel * reflected


def linear_from_display(display: Tensor) -> Tensor:
    """Linear light of sRGB values 0 to 1 (IEC 61966-2-1), shape kept."""
    display = display.clamp(0.0, 1.0)
    return torch.where(display <= 12.92 * DARKEST, display / 12.92, ((display + 0.055) / 1.055) ** 2.4)


def display_from_linear(light: Tensor) -> Tensor:
    """Values of sRGB, 0 to 1, of linear light, shape kept; above 1 they go on along the curve's last slope.

    A camera would clip it there. Here it is not clipped, so that light that is too bright still has a gradient.
    """
    light = light.clamp(min=0.0)
    within = light.clamp(DARKEST, 1.0)
    curved = 1.055 * within ** (1.0 / 2.4) - 0.055
    beyond = (light - 1.0).clamp(min=0.0) * (1.055 / 2.4)
    return torch.where(light <= DARKEST, 12.92 * light, curved + beyond)
